"""What a fit returns: values with intervals, how it ended, and what to know before using it."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum
from typing import TYPE_CHECKING, Any

import numpy as np

from stribeck._types import Array
from stribeck.cases.fit_settings import FREE_INPUTS
from stribeck.checks.check import Checks
from stribeck.contacts.contact import Contact
from stribeck.contacts.friction import Definition
from stribeck.contacts.part_inputs import all_input_rows
from stribeck.files.datasets import Column, new_dataset
from stribeck.files.results import Exported
from stribeck.fits.identifiability import Unidentifiable
from stribeck.fits.measurements import Measurements
from stribeck.fits.residuals import Quality
from stribeck.fits.states.interpolation import Between
from stribeck.quantities.inputs import LINE, InputTable
from stribeck.quantities.results import ByValue, Card, Shown
from stribeck.quantities.units import DIMENSIONS

if TYPE_CHECKING:
    import xarray

__all__ = ["Fit", "FitOutcome", "FittedInput"]


class FitOutcome(Enum):
    """How a fit ended; the value is a sentence."""

    CONVERGED = "The fit converged."
    AT_BOUND = "The fit ended at a bound of an input, whose value is therefore not an estimate; see the notes."
    IMPLAUSIBLE = "The fit ended at an implausible boundary friction, so its values are not estimates; see the notes."
    STEP_LIMIT = "The fit did not converge: least squares reached its step limit; start closer, or free fewer inputs."
    NOT_AT_OPTIMUM = "The fit did not converge: least squares stopped before the optimum; start closer, or free fewer inputs."

    @property
    def ok(self) -> bool:
        """Whether the least squares reached their optimum, be it at a bound or at an implausible value."""
        return self in (FitOutcome.CONVERGED, FitOutcome.AT_BOUND, FitOutcome.IMPLAUSIBLE)


@dataclass(frozen=True)
class FittedInput:
    """One fitted input.

    Attributes
    ----------
    name : str
        Name of the input of the contact.
    curve : str or None
        The curve that has it for itself; None where all share it.
    value : float
        Fitted value in SI units, or the fitted factor.
    unit : str
        SI unit; empty for numbers and factors.
    start : float
        Where the fit began.
    is_factor : bool
        Whether it is a common factor on values that differ between the curves.
    standard_error : float
        Standard error of its logarithm, so about its relative standard error; nan at a bound.
    interval_68, interval_95 : tuple of float
        Ends of its intervals by profile likelihood; 0 and infinity where the data leave an end open within the bounds.
    at_bound : bool
        Whether it ended at one of its bounds.
    dimension : str
        Kind of its unit, a key of :data:`stribeck.quantities.units.DIMENSIONS`.
    """

    name: str
    curve: str | None
    value: float
    unit: str
    start: float
    is_factor: bool
    standard_error: float
    interval_68: tuple[float, float]
    interval_95: tuple[float, float]
    at_bound: bool
    dimension: str = "number"

    @property
    def label(self) -> str:
        """Name for tables: the input, whether it is a factor, and its curve."""
        words = f"{self.name} factor" if self.is_factor else self.name
        return words if self.curve is None else f"{words} ({self.curve})"


@dataclass(frozen=True, eq=False, repr=False)
class Fit(Exported, Shown, ByValue):
    """Inputs of a contact fitted to measured friction, with their intervals.

    Attributes
    ----------
    inputs : tuple of FittedInput
        The fitted inputs.
    outcome : FitOutcome
        How the fit ended.
    contact : Contact
        The case with the fitted values that all curves share, else with those of the first curve.
    contacts : tuple of LineContact
        The fitted contact of each curve.
    data : Measurements
        What was fitted to.
    definition : {"balanced", "published"}
        Definition of the viscous friction.
    law : str
        Name of the contact law.
    friction : ndarray, shape (n,)
        Fitted friction coefficient at each row, solved [-].
    residuals : ndarray, shape (n,)
        Fitted less measured friction over the standard error of the row [-].
    covariance, correlation : ndarray, shape (p, p)
        Of the logarithms of the inputs.
    noise : float
        Standard error of the friction coefficient found from the residuals: relative, or absolute where ``logarithmic`` is not
        set; nan where errors were given.
    logarithmic : bool
        Whether residuals are of the logarithm of friction.
    robust : bool
        Whether outliers were kept from steering.
    quality : Quality
        What the residuals say.
    undetermined : tuple of Unidentifiable
        Combinations of inputs that the data do not determine.
    checks : Checks
        Whether the model applies to the contact of the highest pressure, as far as its inputs tell.
    notes : tuple of str
        What to know before using the values, one sentence each.
    solver_shift : float
        Largest change of a fitted logarithm, in standard errors, from the atlas to the solver; nan where only the solver took
        part.
    model_error : float
        Largest estimated relative error of the solved friction.
    evaluations : int
        Predictions of all rows that were made.
    """

    _picture = "stribeck.plot.fit.plot_fit"

    inputs: tuple[FittedInput, ...]
    outcome: FitOutcome
    contact: Contact
    contacts: tuple[Contact, ...]
    data: Measurements
    definition: Definition
    law: str
    friction: Array
    residuals: Array
    covariance: Array = field(repr=False)
    correlation: Array = field(repr=False)
    noise: float
    logarithmic: bool
    robust: bool
    quality: Quality
    undetermined: tuple[Unidentifiable, ...]
    checks: Checks
    notes: tuple[str, ...]
    solver_shift: float
    model_error: float
    evaluations: int
    _minimum: Any = field(repr=False, compare=False)
    _threshold: float = field(repr=False)

    @property
    def converged(self) -> bool:
        """Whether the values are those of the optimum; :attr:`outcome` says whether that may be used."""
        return self.outcome.ok

    @property
    def held(self) -> tuple[str, ...]:
        """Names of the inputs that were held fixed; no interval includes their uncertainty."""
        fitted = {name for each in self._minimum.objective.model.free for name in each.names}
        measured = () if self.data.abscissa == "speed" else ("viscosity",)
        there = {name for name in FREE_INPUTS for contact in self.contacts if getattr(contact, name, None) is not None}
        return tuple(name for name in FREE_INPUTS if name in there and name not in fitted and name not in measured)

    def __getitem__(self, name: str) -> FittedInput:
        """Return a fitted input by its name, or by name and curve as in its label.

        Parameters
        ----------
        name : str
            The name.

        Returns
        -------
        FittedInput
            The input.

        Raises
        ------
        KeyError
            If no or more than one input is called so.
        """
        found = [each for each in self.inputs if name in (each.name, each.label)]
        if len(found) != 1:
            raise KeyError(f"{name}; fitted are {', '.join(each.label for each in self.inputs)}")
        return found[0]

    def band(self, curve: int, values: Array) -> tuple[Array, Array, Array]:
        """Return the fitted friction along a curve with its 95 % band.

        Parameters
        ----------
        curve : int
            Number of the curve.
        values : ndarray, shape (m,)
            Places along what friction was measured against [SI].

        Returns
        -------
        ndarray, shape (m,)
            Friction coefficient [-].
        ndarray, shape (m,)
            Lower end of its band, by the covariance of the inputs [-].
        ndarray, shape (m,)
            Upper end.

        Notes
        -----
        The band is of the curve, not of single measurements, and normal in the logarithm.  Balls with other fluids and bodies
        than those of the article are solved at the measured speeds alone, and between these it is interpolated.
        """
        at = self._minimum
        values = np.asarray(values, dtype=float)
        model, parts_of = at.objective.model, at.objective.parts_of
        rows = np.nonzero(model.data.curve == curve)[0]
        places, first = np.unique(model.data.values[rows], return_index=True)
        inside = values.size > 0 and places[0] <= values.min() * (1 + 1e-12) and values.max() <= places[-1] * (1 + 1e-12)
        if isinstance(parts_of, Between) and len(places) > 1 and inside:
            # Imported here because it takes longer than the rest of the package.
            from scipy.interpolate import pchip_interpolate

            both = np.column_stack([at.prediction.friction, at.prediction.jacobian])[rows[first]]
            friction, *slopes = pchip_interpolate(np.log(places), both, np.log(values)).T
            jacobian = np.reshape(slopes, (-1, len(values))).T
        else:
            found = model.predict(at.theta, parts_of, (np.full(len(values), curve), values))
            friction, jacobian = found.friction, found.jacobian
        relative = jacobian / friction[:, None]
        variance = np.einsum("np,pq,nq->n", relative, np.nan_to_num(self.covariance), relative)
        half = np.sqrt(self._threshold * np.maximum(variance, 0.0))
        return friction, friction * np.exp(-half), friction * np.exp(half)

    def to_dict(self) -> dict[str, Any]:
        """Return values, intervals, tests, rows and outcome under their names, ready for JSON.

        Returns
        -------
        dict
            Numbers, text, lists and dictionaries of these; infinite where an interval is open.
        """
        names = ("name", "curve", "value", "unit", "start", "is_factor", "standard_error", "at_bound")
        inputs = [
            {n: getattr(each, n) for n in names}
            | {"interval_68": list(each.interval_68), "interval_95": list(each.interval_95)}
            for each in self.inputs
        ]
        quality = {name: getattr(self.quality, name) for name in self.quality.__dataclass_fields__}
        return {
            "converged": self.converged,
            "outcome": self.outcome.name,
            "message": self.outcome.value,
            "inputs": inputs,
            "held": [
                {
                    "name": name,
                    "unit": unit_of(name, False, self.contact.INPUTS),
                    "values": [getattr(each, name, None) for each in self.contacts],
                }
                for name in self.held
            ],
            "covariance": self.covariance.tolist(),
            "correlation": self.correlation.tolist(),
            "noise": self.noise,
            "logarithmic": self.logarithmic,
            "robust": self.robust,
            "quality": quality | {"messages": list(self.quality.messages)},
            "undetermined": [
                {"names": list(u.names), "exponents": list(u.exponents)}
                | {"standard_error": u.standard_error, "message": u.message}
                for u in self.undetermined
            ],
            "notes": list(self.notes),
            "definition": self.definition,
            "contact_law": self.law,
            "solver_shift": self.solver_shift,
            "model_error": self.model_error,
            "evaluations": self.evaluations,
            "curves": [
                {"name": name}
                | {key: value for key in (*FREE_INPUTS, "speed") if (value := getattr(contact, key, None)) is not None}
                for name, contact in zip(self.data.curves, self.contacts, strict=True)
            ],
            "rows": {
                "row": self.data.rows.tolist(),
                "curve": [self.data.curves[k] for k in self.data.curve],
                self.data.abscissa: self.data.values.tolist(),
                "friction": self.data.friction.tolist(),
                "fitted_friction": self.friction.tolist(),
                "residual": self.residuals.tolist(),
            },
        }

    def to_si(self) -> dict[str, float]:
        """Return the fitted values in SI units.

        Returns
        -------
        dict of str to float
            By the label of each fitted input.
        """
        return {each.label: each.value for each in self.inputs}

    def to_dataset(self) -> xarray.Dataset:
        """Return measured and fitted friction as an xarray Dataset.

        Returns
        -------
        xarray.Dataset
            Along ``row`` of the data: curve, abscissa, measured and fitted friction, residual; values and intervals of the
            inputs as attributes; needs the extra ``data``.

        Raises
        ------
        MissingExtraError
            If xarray is not installed.
        """
        columns = self.data.columns() | {
            "fitted_friction": ("row", self.friction, "1", "fitted friction coefficient"),
            "residual": ("row", self.residuals, "1", "fitted less measured friction over the standard error of the row"),
        }
        values: dict[str, Any] = {each.label: each.value for each in self.inputs}
        values |= {f"{each.label} interval_95": np.array(each.interval_95) for each in self.inputs}
        coords: dict[str, Column] = {"row": ("row", self.data.rows, "1", "row of the file")}
        return new_dataset(columns, coords, {"title": "Fit to measured friction", "message": self.outcome.value} | values)

    def _card(self) -> Card:
        rows = [
            (each.label, f"{each.value:.4g} {each.unit} (95 %: {each.interval_95[0]:.4g} to {each.interval_95[1]:.4g})")
            for each in self.inputs
        ]
        rows.append(("noise", f"{self.noise:.2g}{' of the friction' if self.logarithmic else ''}"))
        rows.append(("data", f"{len(self.data)} rows, {len(self.data.curves)} curve{'s' * (len(self.data.curves) > 1)}"))
        notes = (*self.quality.messages, *(each.message for each in self.undetermined), *self.notes)
        return Card(self.outcome.value, rows, notes)


def unit_of(name: str, is_factor: bool, table: InputTable = LINE) -> str:
    """Return the SI unit of a fitted input."""
    return "" if is_factor else DIMENSIONS[all_input_rows(table)[name].dimension].unit
