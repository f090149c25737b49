r"""From a measured viscosity over shear rate to the law of a fluid.

Each law is fitted to the logarithm of the viscosity by least squares, from many first values.  Bayes' criterion of a law is

.. math:: \mathrm{BIC} = N \ln \frac{S}{N} + k \ln N

with S the sum of the squares, N the number of values and k that of the parameters.  Of the laws whose criterion is within 6
of the least, beyond which the evidence against a law is strong (Kass and Raftery 1995), the one with the fewest parameters is
taken.  Its standard errors count the fits of the same law with and without a plateau at high rates, the probability of each
as exp(-BIC/2): a plateau that the rates hardly show moves the other numbers.
"""

from __future__ import annotations

import itertools
import math
import os
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Annotated, Any

import numpy as np

from stribeck._types import Array
from stribeck.files.datasets import Column
from stribeck.files.results import Labelled, Tabled
from stribeck.fluids.description import MAX_RELAXATION_TIME, Fluid
from stribeck.fluids.laws import RateLaw
from stribeck.fluids.rheology.rate_laws import Carreau, Cross, PowerLaw
from stribeck.numerics.settings import EPSILON
from stribeck.quantities.docstrings import told
from stribeck.quantities.formats import format_percent, format_si
from stribeck.quantities.lazy import cached_property
from stribeck.quantities.results import Card, Told
from stribeck.quantities.schema import numbers_of
from stribeck.quantities.units import InputError, positive_columns, show

MIN_VALUES = 5  # Values from which a law is fitted: with fewer, two parameters and the scatter leave nothing to judge
LAWS: Mapping[str, type[Any] | None] = {"newtonian": None, "power-law": PowerLaw, "cross": Cross, "carreau": Carreau}
STARTS = 6  # First values of the relaxation time, between one over the largest and one over the smallest rate
STRONG_EVIDENCE = 6.0  # Difference of the criteria from which the values speak against a law
MAX_RISE = 3.0  # Standard errors of a rise of the viscosity with the rate from which no law of thinning applies
NO_SCATTER = 1e-6  # Relative scatter below which values are as good as computed: no law wins by rounding
UNIT_RATIO = 5.0  # Ratio of a stress to viscosity times rate that only a wrong unit makes; the next one is 10
POOR_FIT = 0.1  # Rms deviation of the viscosity above which a note says that no law follows it
UNKNOWN = 0.5  # Standard error of the logarithm of a number above which a note says that the rates do not show it

# What the functions say that fit a law.
OF_LAW = {"law": f"{{{', '.join(map(repr, LAWS))}}}, optional\n    The law; by default the one that the values speak for."}
FITTED = "FlowCurve\n    The law with the errors of its numbers, how far the values lie from it, and what must be known of it."


@dataclass(frozen=True)
class _Fit:
    """One law through the values."""

    name: str  # The law
    viscosity: float  # Of the contact [Pa s]
    law: RateLaw | None  # In SI units
    errors: dict[str, float]  # Standard errors
    misfit: float  # Rms of the logarithms
    parameters: int  # How many were fitted
    criterion: float  # BIC


@dataclass(frozen=True, repr=False)
class FlowCurve(Told, Tabled):
    """A viscosity measured over the shear rate, and the law through it."""

    rate: Annotated[Array, "shear rates", "1/s"]
    measured: Annotated[Array, "viscosities there", "Pa s"]
    viscosity: Annotated[float, "viscosity of the law, that at low rates; of a power law that at one over its time", "Pa s"]
    law: Annotated[RateLaw | None, "the law of :mod:`stribeck.fluids`, in SI units; None where the liquid does not thin"]
    errors: Annotated[dict[str, float], "standard errors of ``viscosity`` and of the numbers of the law"]
    misfit: Annotated[float, "root mean square of the relative deviation of the values from the law", "1"]
    misfits: Annotated[dict[str, float], "that of each law that was tried"]
    notes: Annotated[tuple[str, ...], "what must be known before the law is used"] = ()

    @cached_property
    def fluid(self) -> Fluid:
        """The fluid of a contact."""
        return Fluid(self.law)

    @property
    def inputs(self) -> dict[str, Any]:
        """The arguments ``viscosity`` and ``fluid`` of a contact."""
        return {"viscosity": self.viscosity, "fluid": self.fluid}

    def at(self, rate: Any) -> Array:
        """Return the viscosity of the law at shear rates.

        Parameters
        ----------
        rate : array_like
            Shear rates [1/s].

        Returns
        -------
        ndarray
            Viscosities [Pa s].
        """
        x = np.asarray(rate, dtype=float)
        if self.law is None:
            return np.full(x.shape, self.viscosity)
        given = {name: getattr(self.law, name) for name in numbers_of(type(self.law))}
        if "infinite_viscosity" in given:
            given["infinite_viscosity"] /= self.viscosity
        x = x * self.law.time
        return np.asarray(self.viscosity * type(self.law)(**given).stress(x) / x)

    def _labelled(self) -> Labelled:
        columns: dict[str, Column] = {
            "measured": ("rate", self.measured, "Pa s", "measured viscosity"),
            "fitted": ("rate", self.at(self.rate), "Pa s", "viscosity of the law"),
            "viscosity": ((), self.viscosity, "Pa s", "viscosity of the contact"),
            "viscosity_error": ((), self.errors["viscosity"], "Pa s", "estimated absolute error of viscosity"),
            "misfit": ((), self.misfit, "1", "rms relative deviation of the measured values"),
        }
        about = {"title": "A measured viscosity and the law through it", "law": self.fluid.name, **self.fluid.parameters}
        return columns, {"rate": ("rate", self.rate, "s-1", "shear rate")}, about

    @property
    def headline(self) -> str:
        """What was fitted to what, and how well."""
        low, high = (format_si(value, "rate") for value in (self.rate.min(), self.rate.max()))
        name = "Newtonian" if self.law is None else self.law.name.capitalize()
        return f"{name} through {self.rate.size} values from {low} to {high}, {format_percent(self.misfit)} off in the mean."

    def _card(self) -> Card:
        rows = [("viscosity", format_si(self.viscosity, "viscosity"), format_si(self.errors["viscosity"], "viscosity"))]
        for each, row in ({} if self.law is None else numbers_of(type(self.law))).items():
            texts = [format_si(value, row.dimension) for value in (getattr(self.law, each), self.errors.get(each, 0.0))]
            rows.append((row.label, texts[0], texts[1] if each in self.errors else ""))
        others = ", ".join(f"{law} {format_percent(misfit)}" for law, misfit in self.misfits.items())
        return Card(
            self.headline,
            table=[("quantity", "value", "standard error"), *rows],
            sentences=[f"Mean deviation of all laws: {others}.", *self.notes],
        )


@told(OF_LAW, FITTED)
def flow_curve(rate: Any, viscosity: Any, *, law: str | None = None) -> FlowCurve:
    """Fit a law of shear thinning to a viscosity measured over the shear rate.

    Parameters
    ----------
    rate : array_like, shape (n,)
        Shear rates, positive, at least five that differ [1/s].
    viscosity : array_like, shape (n,)
        Viscosities there, positive [Pa s].

    Raises
    ------
    InputError
        Where values are impossible, too few, or the liquid thickens with the rate.

    Examples
    --------
    >>> import numpy as np
    >>> import stribeck as sb
    >>> rate = np.geomspace(0.1, 1000, 13)
    >>> found = sb.fluids.flow_curve(rate, 2.0 * (1 + (5 * rate) ** 2) ** -0.3)
    >>> found.law.name, round(found.law.exponent, 3)
    ('carreau', 0.4)
    """
    rates, values = _checked(rate, viscosity)
    if law is not None and law not in LAWS:
        raise InputError(f"law = {show(law)} is not known; there are {', '.join(LAWS)}.")
    fits = [fit for name, kind in LAWS.items() if law in (None, name) for fit in _fits(name, kind, rates, values)]
    if not fits:
        raise InputError(f"{rates.size} values are too few for law = {show(law)}; measure at more rates.")
    least = min(fit.criterion for fit in fits)
    likely = [fit for fit in fits if fit.criterion <= least + STRONG_EVIDENCE]
    best = min(likely, key=lambda fit: (fit.parameters, fit.criterion))
    misfits = {name: min(each.misfit for each in fits if each.name == name) for name in dict.fromkeys(f.name for f in fits)}
    misfits[best.name] = best.misfit
    best = replace(best, errors=_errors(best, [fit for fit in likely if fit.name == best.name]))
    notes = tuple(_notes(best, rates))
    return FlowCurve(rates, values, best.viscosity, best.law, best.errors, best.misfit, misfits, notes)


@told(OF_LAW, FITTED)
def read_flow_curve(path: str | os.PathLike[str], *, law: str | None = None) -> FlowCurve:
    """Read a viscosity over shear rate from a table and fit a law of shear thinning.

    Parameters
    ----------
    path : str or path-like
        A text file or spreadsheet with a column of shear rates and one of viscosities, with units, such as
        ``shear rate [1/s]; viscosity [mPa*s]``, or one of shear stresses in their place; other columns are left out.

    Raises
    ------
    InputError
        Where the file cannot be read or has no such columns, or its values allow no fit.
    """
    from stribeck.files.columns import Column, read_columns  # slow to import, and most fluids have no file

    advice = "name the columns 'shear rate [1/s]' and 'viscosity [mPa*s]' or 'shear stress [Pa]', with the units of the file"
    rate = Column(
        "(shear |strain )?rate( of shear)?|shearrate|gamma ?dot|gp|[ɣγ][\u0307˙]|ý|d|"
        "scher(rate|geschwindigkeit|gefälle)|geschwindigkeitsgefälle",
        "rate",
    )
    viscosity = Column("(shear |dynamic |apparent )?viscosity|eta|η|(dynamische |scheinbare )?(scher)?viskosität", "viscosity")
    kinematic = Column(rf"{viscosity.pattern}|kinematic viscosity|kinematische viskosität|nu|ν", "kinematic")
    stress = Column("(shear ?)?stress|tau|τ|(schub|scher)spannung", "pressure")
    measured = (("viscosity", viscosity), ("shear stress", stress), ("kinematic viscosity", kinematic))
    choices = [{"shear rate": rate, name: each} for name, each in measured]
    columns = read_columns(path, advice, *choices, gaps=True)
    notes, (rates, values) = columns.notes, columns.in_si.values()
    if "shear stress" in columns.in_si:
        values = np.divide(values, rates, out=np.full(rates.shape, np.nan), where=rates != 0)
        notes += ("Viscosity is shear stress over shear rate.",)
    elif "viscosity" in columns.in_si and stress.is_in(columns.table):
        stresses, _ = stress.numbers(columns.table, stress.names_in(columns.table)[0], gaps=True)
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = np.abs(stresses[np.isin(columns.table.numbers, columns.rows)] / (rates * values))
        apart = float(np.median(ratio[np.isfinite(ratio)])) if np.isfinite(ratio).any() else 1.0
        if not 1 / UNIT_RATIO < apart < UNIT_RATIO:
            raise InputError(
                f"{path}: shear stress is {apart:.3g} times viscosity times shear rate; one of the three has another unit "
                "than its header says."
            )
    with columns.named():
        if "kinematic viscosity" in columns.in_si:
            raise InputError("its viscosity is a kinematic one; multiply the column by the density, and write mPa*s above it.")
        found = flow_curve(rates, values, law=law)
    return replace(found, notes=(*notes, *found.notes))


def _checked(rate: Any, viscosity: Any) -> tuple[Array, Array]:
    """Return rates, rising, and viscosities."""
    advice = {"rate": " Leave out rest, and the sign of the direction."}
    x, y = positive_columns({"rate": rate, "viscosity": viscosity}, advice)
    if np.unique(x).size < MIN_VALUES:
        raise InputError(f"viscosity at {np.unique(x).size} different rates; a law needs {MIN_VALUES} or more.")
    (slope, _), covariance = np.polyfit(np.log(x), np.log(y), 1, cov=True)
    if slope > MAX_RISE * math.sqrt(covariance[0, 0]) and slope > NO_SCATTER:
        raise InputError(
            f"viscosity rises with the rate, from {y[0]:.3g} to {y[-1]:.3g} Pa s; fluids that thicken under shear are not "
            "modelled. Leave out rates at which the flow in the rheometer is no longer laminar."
        )
    return x, y


def _fits(name: str, kind: type[Any] | None, x: Array, y: Array) -> list[_Fit]:
    """Return the fits of a law, of one with two plateaus also with the second at zero."""
    log_y = np.log(y)
    if kind is None:
        mean = float(log_y.mean())
        error = float(log_y.std(ddof=1)) / math.sqrt(x.size)
        return [_judged(name, None, mean, {}, np.array([error]), log_y - mean)]
    if kind is PowerLaw:
        slope = float(np.polyfit(np.log(x), log_y, 1)[0])
        time = {"relaxation_time": 1 / float(np.exp(np.log(x).mean()))}
        return _searched(name, kind, x, log_y, log_y.mean(), {"exponent": [1 + slope]}, time)
    starts = {"relaxation_time": [math.log(t) for t in np.geomspace(1 / x[-1], 1 / x[0], STARTS)], "exponent": [0.3, 0.7]}
    plateau = {"infinite_viscosity": [0.5 * y.min() / y.max()]}
    return [fit for each in (starts, starts | plateau) for fit in _searched(name, kind, x, log_y, log_y.max(), each, {})]


def _searched(
    name: str,
    kind: type[Any],
    x: Array,
    log_y: Array,
    log_viscosity: float,
    starts: dict[str, list[float]],
    fixed: dict[str, float],
) -> list[_Fit]:
    """Return the best fit from several first values; none where there are no more values than parameters and two."""
    from scipy.optimize import least_squares  # slow to import

    size = 1 + len(starts)
    if x.size < size + 3:
        return []
    exponent = numbers_of(kind)["exponent"]
    longest = math.log(MAX_RELAXATION_TIME)  # a power law is one of any time that is long enough
    ranges = {
        "exponent": exponent.range,
        "relaxation_time": (-longest, longest),
        "infinite_viscosity": (0.0, 1 - 1e-9),
    }
    low, high = np.array([(-np.inf, np.inf), *(ranges.get(each, (-np.inf, np.inf)) for each in starts)]).T

    def numbers(p: Array) -> dict[str, float]:
        free = zip(starts, p[1:].tolist(), strict=True)
        return fixed | {each: math.exp(value) if each == "relaxation_time" else value for each, value in free}

    def deviation(p: Array) -> Array:
        law = kind(**numbers(p))
        rate = x * law.time
        return np.asarray(p[0] + np.log(law.stress(rate) / rate) - log_y)

    first = (np.clip([log_viscosity, *each], low, high) for each in itertools.product(*starts.values()))
    found = min(
        (least_squares(deviation, each, bounds=(low, high), x_scale="jac") for each in first), key=lambda each: each.cost
    )
    _, singular, rows = np.linalg.svd(np.asarray(found.jac), full_matrices=False)
    scatter = math.sqrt(2 * found.cost / (x.size - size))
    if singular[-1] > EPSILON * singular[0]:
        errors = scatter * np.sqrt(((rows.T / singular) ** 2).sum(axis=1))
    else:
        errors = np.full(size, np.inf)
    return [_judged(name, kind, float(found.x[0]), numbers(found.x), errors, found.fun)]


def _judged(
    name: str, kind: type[Any] | None, log_viscosity: float, given: dict[str, float], log_errors: Array, deviation: Array
) -> _Fit:
    """Return a fit with its numbers in SI units, their errors and its criterion."""
    n, k = deviation.size, log_errors.size
    viscosity, squares = math.exp(log_viscosity), float(deviation @ deviation)
    errors = {"viscosity": viscosity * float(log_errors[0])}
    fitted = [each for each in given if kind is not PowerLaw or each != "relaxation_time"]
    for each, error in zip(fitted, log_errors[1:], strict=True):
        errors[each] = float(error) * (given[each] if each == "relaxation_time" else 1.0)
    if "infinite_viscosity" in given:
        given = given | {"infinite_viscosity": viscosity * given["infinite_viscosity"]}
        errors["infinite_viscosity"] *= viscosity
    law = None if kind is None else kind(**given)
    criterion = n * math.log(max(squares / n, NO_SCATTER**2)) + k * math.log(n)
    return _Fit(name, viscosity, law, errors, math.sqrt(squares / n), k, criterion)


def _errors(best: _Fit, likely: list[_Fit]) -> dict[str, float]:
    """Return standard errors about the numbers of a fit: over its likely fits, as probable as their criteria say."""
    found: dict[str, float] = {}
    for name, error in best.errors.items():
        known = [fit for fit in likely if math.isfinite(fit.errors.get(name, math.inf))]
        weights = np.exp([0.5 * (best.criterion - fit.criterion) for fit in known])
        squares = [fit.errors[name] ** 2 + (_value(fit, name) - _value(best, name)) ** 2 for fit in known]
        found[name] = math.sqrt(np.average(squares, weights=weights)) if known else error
    return found


def _notes(fit: _Fit, x: Array) -> list[str]:
    """Return what must be known of a law before it is used."""
    low, high = (format_si(value, "rate") for value in (x[0], x[-1]))
    notes = [f"Films of shear rates beyond {low} to {high} take what the law continues."]
    if fit.misfit > POOR_FIT:
        notes.append(f"No law follows these values within {format_percent(POOR_FIT)}; look at them before you use one.")
    unknown = [name for name, error in fit.errors.items() if name != "exponent" and not error < UNKNOWN * _value(fit, name)]
    if unknown:
        words = " and ".join(name.replace("_", " ") for name in unknown)
        notes.append(f"These rates do not show the {words} within a factor of two; measure at lower and at higher rates.")
    return notes


def _value(fit: _Fit, name: str) -> float:
    return fit.viscosity if name == "viscosity" else float(getattr(fit.law, name))
