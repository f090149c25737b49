"""What a fit returns: values with intervals, how it ended, and what to know before using it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from enum import Enum
from typing import Annotated, Any

import numpy as np

from stribeck._types import Array, Indices
from stribeck.cases.fit_settings import FREE_INPUTS
from stribeck.checks.check import Checks
from stribeck.contact_laws.law import largest_load
from stribeck.contacts.contact import Contact
from stribeck.contacts.friction import Definition
from stribeck.contacts.geometries import LINE
from stribeck.contacts.inputs import InputTable, follows_surface
from stribeck.files.datasets import Column, listed, units_of
from stribeck.files.results import Exported, Labelled, Record, columns_of_records, json_of
from stribeck.fits.diagnosis import Quality, Unidentifiable, product_text
from stribeck.fits.free_inputs import FreeInput
from stribeck.fits.least_squares import Minimum
from stribeck.fits.measurements import Measurements
from stribeck.quantities.formats import format_percent, format_si
from stribeck.quantities.results import ByValue, Card, Told
from stribeck.quantities.schema import MAX_RELATIVE_ERROR
from stribeck.quantities.standard_errors import INTERVAL_95, StandardErrors, with_proportional
from stribeck.quantities.units import DIMENSIONS
from stribeck.solver.numbers import units_of_inputs


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
class FittedInput(Record):
    """One fitted input."""

    name: Annotated[str, "input of the contact", "1"]
    curve: Annotated[str | None, "curve or file that has it for itself; None where all share it", "1"]
    value: Annotated[float, "fitted value, or fitted factor", ""]
    start: Annotated[float, "where the fit began", ""]
    is_factor: Annotated[bool, "whether it is a common factor on values that differ between the curves", "1"]
    standard_error: Annotated[float, "standard error of its logarithm; nan at a bound", "1"]
    interval_68: Annotated[tuple[float, float], "68 % interval; 0 and infinity where an end is open within the bounds", ""]
    interval_95: Annotated[tuple[float, float], "95 % interval, likewise", ""]
    at_bound: Annotated[bool, "whether it ended at one of its bounds", "1"]
    dimension: Annotated[str, "kind of its unit, a key of :data:`stribeck.quantities.units.DIMENSIONS`"] = "number"

    _properties = {"unit": ("1", "SI unit; empty for numbers and factors")}

    @property
    def unit(self) -> str:
        """SI unit; empty for numbers and factors."""
        return DIMENSIONS[self.dimension].unit.replace("*", " ")

    @property
    def label(self) -> str:
        """Name for tables: the input, whether it is a factor, and its curve."""
        words = f"{self.name} factor" if self.is_factor else self.name
        return words if self.curve is None else f"{words} ({self.curve})"

    @property
    def texts(self) -> tuple[str, str, str, str]:
        """Value, error, and intervals of 68 and 95 %, for tables."""
        error = "at its bound"
        if not math.isnan(self.standard_error):
            error = format_percent(self.standard_error) if self.standard_error < 1 else "unknown"
        narrow, wide = (_interval_text(self, *each) for each in (self.interval_68, self.interval_95))
        return format_value(self), error, narrow, wide


def fitted_input(
    table: InputTable, free: FreeInput, theta: float, error: float, ends: Sequence[tuple[float, float]], at_bound: bool
) -> FittedInput:
    """Return a free input as it was fitted, by the logarithm of its factor, the error and the intervals of that."""
    narrow, wide = (free.interval(*each) for each in ends)
    dimension = "number" if free.is_factor else table.rows[free.name].dimension
    value = free.value(theta)
    return FittedInput(free.name, free.owner, value, free.start, free.is_factor, error, narrow, wide, at_bound, dimension)


def columns_of_inputs(inputs: Sequence[FittedInput]) -> tuple[dict[str, Column], dict[str, Column]]:
    """Return what fitted inputs have as columns along ``input``, and this coordinate."""
    found = columns_of_records("input", inputs, FittedInput._labels)
    labels: Column = ("input", listed([each.label for each in inputs]), "1", "fitted input")
    return {f"input_{name}": each for name, each in found.items()}, {"input": labels}


class WithFittedInputs:
    """A result that gives its fitted inputs by name."""

    inputs: tuple[FittedInput, ...]

    def __getitem__(self, name: str) -> FittedInput:
        """Return a fitted input by its name, or by name and curve as in its label."""
        found = [each for each in self.inputs if name in (each.name, each.label)]
        if len(found) != 1:
            raise KeyError(f"{name}; fitted are {', '.join(each.label for each in self.inputs)}")
        return found[0]


@dataclass(frozen=True, eq=False, repr=False)
class Fit(WithFittedInputs, Exported, Told, ByValue):
    """Inputs of a contact fitted to measured friction, with their intervals.

    Its dataset has along ``row`` of the data curve, abscissa, measured and fitted friction and residual; along ``input`` what
    each :class:`FittedInput` has.
    """

    _picture = "stribeck.plot.fit.plot_fit"

    inputs: Annotated[tuple[FittedInput, ...], "the fitted inputs"]
    outcome: Annotated[FitOutcome, "how the fit ended"]
    contact: Annotated[Contact, "the case with the fitted values that all curves share, else with those of the first curve"]
    contacts: Annotated[tuple[Contact, ...], "the fitted contact of each curve"]
    data: Annotated[Measurements, "what was fitted to"]
    definition: Annotated[Definition, "definition of the viscous friction"]
    law: Annotated[str, "name of the contact law"]
    friction: Annotated[Array, "fitted friction coefficient at each row, solved [-], shape (n,)"]
    residuals: Annotated[Array, "fitted less measured friction over the standard error of the row [-], shape (n,)"]
    covariance: Annotated[Array, "of the logarithms of the inputs, shape (p, p)"] = field(repr=False)
    correlation: Annotated[Array, "of the logarithms of the inputs, shape (p, p)"] = field(repr=False)
    noise: Annotated[
        float,
        "standard error of the friction coefficient found from the residuals: relative, or absolute where "
        "``logarithmic`` is not set; nan where errors were given",
    ]
    logarithmic: Annotated[bool, "whether residuals are of the logarithm of friction"]
    robust: Annotated[bool, "whether outliers were kept from steering"]
    quality: Annotated[Quality, "what the residuals say"]
    undetermined: Annotated[tuple[Unidentifiable, ...], "combinations of inputs that the data do not determine"]
    checks: Annotated[Checks, "whether the model applies to the contact of the highest pressure, as far as its inputs tell"]
    notes: Annotated[tuple[str, ...], "what to know before using the values, one sentence each"]
    solver_shift: Annotated[
        float,
        "largest change of a fitted logarithm, in standard errors, from the atlas to the solver; nan where only the "
        "solver took part",
    ]
    model_error: Annotated[float, "largest estimated relative error of the solved friction"]
    evaluations: Annotated[int, "predictions of all rows that were made"]
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
        # What was measured with the speed, and what follows from the profile
        known = {"viscosity": self.data.abscissa != "speed", "radius": self.contact.profile is not None}
        there = {name for name in FREE_INPUTS for contact in self.contacts if getattr(contact, name, None) is not None}
        return tuple(name for name in FREE_INPUTS if name in there and name not in fitted and not known.get(name, False))

    @property
    def errors(self) -> StandardErrors:
        """Errors of the inputs of ``contact``, with correlations, for :func:`stribeck.propagate`.

        1.96 times each is half of its 95 % interval by the covariance.  What the data leave open within a factor of
        four or more, or what ended at a bound, has none.
        """
        width = math.sqrt(self._threshold) / INTERVAL_95 * np.sqrt(np.diag(self.covariance))
        relative = np.sqrt(np.expm1(width**2))
        free = self._minimum.objective.model.free
        own = {each.name: k for k, each in enumerate(free) if each.acts_on(0) and relative[k] <= MAX_RELATIVE_ERROR}
        found: dict[str, dict[str, float]] = {
            first: {second: float(self.correlation[own[first], own[second]]) for second in list(own)[k + 1 :]}
            for k, first in enumerate(own)
        }
        errors = StandardErrors({name: float(relative[k]) for name, k in own.items()}, found)
        for each in free:
            if each.also and each.name in errors and not follows_surface(self.contact, errors):
                for name in each.also:
                    errors = with_proportional(errors, name, each.name)
        return errors

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
        model, states = at.objective.model, at.objective.states
        rows = np.nonzero(model.data.curve == curve)[0]
        places, first = np.unique(model.data.values[rows], return_index=True)
        inside = values.size > 0 and places[0] <= values.min() * (1 + 1e-12) and values.max() <= places[-1] * (1 + 1e-12)
        if not states.uses_atlas and len(places) > 1 and inside:
            # Imported here because it takes longer than the rest of the package.
            from scipy.interpolate import pchip_interpolate

            both = np.column_stack([at.prediction.friction, at.prediction.jacobian])[rows[first]]
            friction, *slopes = pchip_interpolate(np.log(places), both, np.log(values)).T
            jacobian = np.reshape(slopes, (-1, len(values))).T
        else:
            found = model.predict(at.theta, states, (np.full(len(values), curve), values))
            friction, jacobian = found.friction, found.jacobian
        relative = jacobian / friction[:, None]
        variance = np.einsum("np,pq,nq->n", relative, np.nan_to_num(self.covariance), relative)
        half = np.sqrt(self._threshold * np.maximum(variance, 0.0))
        return friction, friction * np.exp(-half), friction * np.exp(half)

    def to_dict(self) -> dict[str, Any]:
        """Return values, intervals (None where open), tests, rows and outcome, ready for JSON."""
        names = "converged inputs covariance correlation noise logarithmic robust quality undetermined notes definition"
        return json_of(
            self,
            f"{names} solver_shift model_error evaluations",
            outcome=self.outcome.name,
            message=self.outcome.value,
            contact_law=self.law,
            held=[
                {
                    "name": name,
                    "unit": DIMENSIONS[self.contact.INPUTS.rows[name].dimension].unit.replace("*", " "),
                    "values": [getattr(each, name, None) for each in self.contacts],
                }
                for name in self.held
            ],
            curves=[
                {"name": name}
                | {key: value for key in (*FREE_INPUTS, "speed") if (value := getattr(contact, key, None)) is not None}
                for name, contact in zip(self.data.curves, self.contacts, strict=True)
            ],
            rows={name: values for name, (_, values, _, _) in self._rows.items()},
            units=units_of_inputs(self.contact) | units_of(self._rows),
        )

    @property
    def _rows(self) -> dict[str, Column]:
        """What stands along the rows of the data."""
        rows: dict[str, Column] = {"row": ("row", self.data.rows, "1", "row of the file"), **self.data._columns}
        rows["fitted_friction"] = ("row", self.friction, "1", "fitted friction coefficient")
        label = "fitted less measured friction over the standard error of the row"
        return rows | {"residual": ("row", self.residuals, "1", label)}

    def to_si(self) -> dict[str, float]:
        """Return the fitted values in SI units, by the label of each fitted input."""
        return {each.label: each.value for each in self.inputs}

    def _labelled(self) -> Labelled:
        rows, (columns, coords) = self._rows, columns_of_inputs(self.inputs)
        about = {"definition": self.definition, "contact_law": self.law, "notes": "\n".join(self.notes)}
        coords["row"] = rows.pop("row")
        return rows | columns, coords, {"title": "Fit to measured friction", "outcome": self.outcome.value, **about}

    def _card(self) -> Card:
        table = [("input", "fitted", "error", "68 %", "95 %", "case")]
        table += [(each.label, *each.texts, format_value(each, each.start)) for each in self.inputs]
        warnings = (*self.quality.messages, *(each.message for each in self.undetermined))
        sentences = [self._source, self.data.taken, self._held_sentence, self._noise_sentence, self._error_sentence]
        return Card(
            self.outcome.value,
            table=table,
            sentences=[*filter(None, sentences), *(f"Warning: {each}" for each in warnings)],
            notes=[note for note in self.notes if not self.checks.covers(note)],
        )

    @property
    def _source(self) -> str:
        data = self.data
        curves = f", {len(data.curves)} curves" if len(data.curves) > 1 else ""
        source = data.path or "measured friction"
        return f"{len(data)} rows{curves} of {source}; contact law: {self.law}; friction: {self.definition}."

    @property
    def _held_sentence(self) -> str:
        shown = []
        for name in self.held:
            values = {getattr(contact, name, None) for contact in self.contacts}
            [value, *others] = values
            dimension = self.contact.INPUTS.rows[name].dimension
            known = "of each curve" if others or value is None else format_si(value, dimension, 4)
            shown.append(f"{name} {known}")
        if not shown:
            return ""
        return (
            f"Held fixed: {', '.join(shown)}. "
            "Their uncertainty is not included in the errors above; to include it, use free or priors in the "
            "table [fit] of the case."
        )

    @property
    def _noise_sentence(self) -> str:
        quality = self.quality
        misfit = "no systematic misfit detected" if quality.structure_probability >= 0.01 else "systematic misfit detected"
        size = format_percent(self.noise) if self.logarithmic else f"{self.noise:.2g}"
        noise = f"{size} of noise; {misfit}"
        if math.isnan(self.noise):
            noise = (
                f"chi squared {quality.chi_squared:.3g} for {quality.degrees_of_freedom:.3g} degrees of freedom "
                f"(p = {quality.chi_squared_probability:.2g}); {misfit}"
            )
        return f"Residuals: {noise} (p = {quality.structure_probability:.2g})."

    @property
    def _error_sentence(self) -> str:
        shift = f"; replacing the lookup table by the solver moved it by {self.solver_shift:.1g} standard errors"
        shift = "" if math.isnan(self.solver_shift) else shift
        return f"The fitted friction comes from the solver, with relative error {self.model_error:.1g}{shift}."


def format_value(each: FittedInput, value: float | None = None) -> str:
    """Return a value of a fitted input as short text with its unit."""
    value = each.value if value is None else value
    return f"{value:.4g}" if each.is_factor else format_si(value, each.dimension, 4)


def _interval_text(each: FittedInput, low: float, high: float) -> str:
    """Return an interval of a fitted input in words."""
    if low == 0 and math.isinf(high):
        return "open"
    if low == 0:
        return f"below {format_value(each, high)}"
    if math.isinf(high):
        return f"above {format_value(each, low)}"
    return f"{format_value(each, low)} to {format_value(each, high)}"


TIED = 0.95  # Correlation from which a pair of inputs is named


def outcome_of(at: Minimum, inputs: Sequence[FittedInput]) -> FitOutcome:
    """Return how a fit ended."""
    if not at.converged:
        return FitOutcome.NOT_AT_OPTIMUM if at.ended else FitOutcome.STEP_LIMIT
    return outcome_of_inputs(inputs)


def outcome_of_inputs(inputs: Sequence[FittedInput]) -> FitOutcome:
    """Return how a fit ended whose minimum was found."""
    if any(_implausible(each) for each in inputs):
        return FitOutcome.IMPLAUSIBLE
    return FitOutcome.AT_BOUND if any(each.at_bound for each in inputs) else FitOutcome.CONVERGED


def notes_of_inputs(inputs: Sequence[FittedInput]) -> list[str]:
    """Return the sentences on inputs whose values are not estimates."""
    notes = []
    for each in inputs:
        if each.at_bound:
            notes.append(
                f"{each.label} ended at its bound {format_value(each)}: the data would move it further, and it has no "
                "standard error. Widen the bound, or free fewer inputs."
            )
        if _implausible(each):
            notes.append(
                f"{each.label} {each.value:.2g} is larger than that of any known contact: the data do not reach the boundary "
                "plateau, or other inputs are wrong. Give it a bound or a prior in [fit], or do not free it."
            )
    return notes


def notes_of(
    at: Minimum,
    inputs: Sequence[FittedInput],
    correlation: Array,
    covariance: Array,
    weak: Sequence[Unidentifiable],
    contacts: Sequence[Contact],
) -> list[str]:
    """Return the sentences on a fit."""
    notes = notes_of_inputs(inputs)
    named = {name for each in weak for name in each.names}
    for i in range(len(inputs)):
        for j in range(i):
            pair = inputs[j].label, inputs[i].label
            if abs(correlation[i, j]) > TIED and not named & set(pair):
                notes.append(_combination(pair, correlation[i, j], covariance[np.ix_([j, i], [j, i])]))
    for name, contact in zip(at.objective.model.data.curves, contacts, strict=True):
        load = float(contact.groups.load)
        if load >= largest_load(contact.law):
            where = f" of curve {name}" if len(contacts) > 1 else ""
            notes.append(
                f"The fitted load group{where} is {load:.3g}, not below 1: the exponential contact law is outside its range."
            )
    if at.objective.robust:
        far = np.abs(at.residuals) > 4
        if far.any():
            notes.append(
                "Rows beyond four standard errors, which have little weight in the fit: "
                f"{_rows(at.objective.model.data, np.nonzero(far)[0])}."
            )
    return notes


def _rows(data: Measurements, which: Indices) -> str:
    """Return the rows of files, with the names of the files where there are several."""
    rows_of: dict[str, list[int]] = {}
    for i in which.tolist():
        rows_of.setdefault(data.files[data.curve[i]] if data.files else "", []).append(int(data.rows[i]))
    texts = {name: ", ".join(map(str, sorted(rows)[:10])) for name, rows in rows_of.items()}
    return ", ".join(f"{rows} of {name}" if name else rows for name, rows in texts.items())


def _implausible(each: FittedInput) -> bool:
    return not each.is_factor and each.name in LINE.quantities and each.value > LINE.quantities[each.name].implausible


def _combination(pair: tuple[str, str], correlation: float, covariance: Array) -> str:
    """Return the sentence that names the combination of two inputs that the data determine best."""
    values, vectors = np.linalg.eigh(covariance)
    a, b = vectors[:, 0]
    first, second = pair if abs(a) >= abs(b) else pair[::-1]
    power = float(min(a, b, key=abs) / max(a, b, key=abs))
    size = float(math.sqrt(max(values[0], 0.0)) / max(abs(a), abs(b)))
    return (
        f"{pair[0]} and {pair[1]} have correlation {correlation:.3f}: the data determine "
        f"{product_text(first, second, power)} best, within {100 * size:.2g} %."
    )
