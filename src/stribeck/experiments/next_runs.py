r"""What to measure next: the runs that shrink the intervals of a fit most, by D-optimality.

.. math:: \Delta = \tfrac12 \ln \frac{\det(I + j j^\mathsf{T}/\sigma^2)}{\det I} = \tfrac12 \ln(1 + j^\mathsf{T} C j/\sigma^2)

with the information I of the data so far, C its inverse, and j the exact derivatives of ln(friction) with respect to the
logarithms of the fitted inputs at the state to be measured.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Annotated, Any

import numpy as np

from stribeck import atlas
from stribeck._types import Array
from stribeck.atlas.lookup import has_friction
from stribeck.contacts.contact import Contact
from stribeck.contacts.friction_rules import RULES
from stribeck.curves.sensitivities import atlas_sensitivities, friction_sensitivities
from stribeck.files.datasets import Column
from stribeck.files.results import Exported, Labelled, Record, columns_of_records, json_of
from stribeck.fits.intervals import information_of
from stribeck.fits.result import Fit
from stribeck.numerics.threads import one_blas_thread
from stribeck.quantities.formats import format_percent, format_si
from stribeck.quantities.results import Card, Told
from stribeck.quantities.units import InputError, checked_callback, checked_count, checked_kind, show
from stribeck.solver.solve_error import SolveError

CANDIDATE_SPEEDS = 17  # Speeds from the slowest measured to the fastest, and a factor of SPEED_MARGIN to both sides
SPEED_MARGIN = 3.0  # Ratio of speeds

LOAD_RATIOS = (1 / 3, 1.0, 3.0)  # Candidate loads, over the load of the first curve

DEFAULT_COST = {"point": 1.0, "load": 2.0, "viscosity": 3.0}  # Cost of a run at another speed, and of another load or fluid

PRIOR_LOG_ERROR = math.log(10)  # Standard error of the logarithm of an input that the data do not constrain: a factor of ten

STATE_RTOL = 1e-4  # Tolerance of candidate states outside the atlas
MAX_RUNS = 50  # Runs that are chosen in one call


@dataclass(frozen=True)
class NextRun(Record):
    """One run worth measuring."""

    curve: Annotated[str, "curve whose contact it is, perhaps at another load or viscosity", "1"]
    speed: Annotated[float, "sum of the surface speeds", "m/s"]
    load: Annotated[float, "load", ""]
    viscosity: Annotated[float, "viscosity", "Pa s"]
    friction: Annotated[float, "friction coefficient to expect", "1"]
    gain: Annotated[float, "growth of half the logarithm of the determinant of the information", "1"]
    cost: Annotated[float, "cost", "1"]
    errors: Annotated[
        dict[str, float],
        "standard errors of the logarithms of the fitted inputs after this run and those before it",
    ]
    unit: Annotated[str, "SI unit of the load"] = "N/m"


@dataclass(frozen=True, repr=False)
class Plan(Exported, Told):
    """Runs worth measuring, the best first; its dataset has them along ``run``."""

    _picture = "stribeck.plot.experiments.plot_plan"

    runs: Annotated[tuple[NextRun, ...], "the runs"]
    before: Annotated[dict[str, float], "standard errors of the logarithms of the fitted inputs from the data so far"]
    noise: Annotated[float, "relative standard error of a run that was supposed"]
    scanned: Annotated[tuple[NextRun, ...], "all runs that were tried, with the gain of each as the first"] = field(repr=False)
    load_dimension: Annotated[str, "kind of the load, of a cylinder or a ball"] = "load"

    def _card(self) -> Card:
        curves = len({each.curve for each in self.scanned}) > 1
        setting = *["curve"] * curves, "speed", "load", "viscosity"
        table: list[tuple[str, ...]] = [("run", *setting, "friction", "gain", "cost", "standard errors after it")]
        for i, each in enumerate(self.runs, 1):
            fluid = format_si(each.viscosity, "viscosity")
            place = *[each.curve] * curves, format_si(each.speed, "speed"), format_si(each.load, self.load_dimension), fluid
            numbers = f"{each.friction:.3g}", f"{each.gain:.2g}", f"{each.cost:.3g}"
            table.append((str(i), *place, *numbers, _percents(each.errors)))
        noise = f"a run is assumed to be accurate to {format_percent(self.noise)}"
        now = "now", f"standard errors {_percents(self.before)}; {noise}"
        several = len(self.runs) > 1
        headline = f"{len(self.runs)} runs worth measuring, the best first" if several else "The run most worth measuring"
        return Card(headline, [now], (), table)

    def to_dict(self) -> dict[str, Any]:
        """Return the runs and the errors before and after them, ready for JSON."""
        runs = [each.to_dict() | {"errors": each.errors} for each in self.runs]
        units = {name: unit or self.runs[0].unit for name, (unit, _) in NextRun._labels.items()}
        return json_of(self, "noise", runs=runs, errors_before=self.before, units=units)

    def _labelled(self) -> Labelled:
        columns = columns_of_records("run", self.runs, NextRun._labels)
        for name in self.before:
            after = np.array([each.errors[name] for each in self.runs])
            columns[f"error_{name}"] = ("run", after, "1", f"standard error of the logarithm of {name} after the run")
        number: dict[str, Column] = {"run": ("run", np.arange(1, len(self.runs) + 1), "1", "number of the run")}
        before = {f"error_before_{name}": error for name, error in self.before.items()}
        return columns, number, {"title": "What to measure next", "noise": self.noise, **before}


@one_blas_thread
def next_runs(
    fit: Fit,
    count: int = 3,
    *,
    speeds: Sequence[Any] | None = None,
    loads: Sequence[Any] | None = None,
    viscosities: Sequence[Any] | None = None,
    cost: Mapping[str, float] | None = None,
    on_step: Callable[[int, int], object] | None = None,
) -> Plan:
    """Return the runs that would shrink the intervals of a fit most for their cost.

    Parameters
    ----------
    fit : Fit
        The fit to the data so far.
    count : int
        How many runs, 1 to 50; each is chosen as if those before it had been measured.
    speeds, loads, viscosities : sequence, optional
        What can be set, text with units or SI numbers; by default speeds from a third of the slowest to three times the
        fastest, loads of a third to three times that of the first curve, and the viscosities of the curves.
    cost : mapping, optional
        Cost of a run (``"point"``), added cost of a load (``"load"``) or a fluid (``"viscosity"``) that no curve has; 1, 2
        and 3 by default.
    on_step : callable, optional
        ``on_step(done, total)`` is called as the work goes on.

    Returns
    -------
    Plan
        The runs, and the standard errors to expect after each.

    Raises
    ------
    InputError
        If the fit did not converge, or an argument cannot be used.

    Notes
    -----
    Derivatives are exact, at the fitted values: what is chosen is right as far as these are.  It shrinks the intervals within
    the model, and does not test the model: a run where the model has never been tested does.
    """
    checked_kind("fit", fit, Fit, "a Fit, as sb.fit returns it")
    checked_callback("on_step", on_step)
    if not fit.converged:
        raise InputError(f"the fit did not converge, so that no run can be advised. {fit.outcome.value}")
    checked_count("count", count, 1, MAX_RUNS)
    prices = DEFAULT_COST | dict(cost or {})
    if set(prices) != set(DEFAULT_COST) or min(prices.values()) < 0 or prices["point"] <= 0:
        raise InputError(f"cost = {show(cost)}; it may hold {', '.join(DEFAULT_COST)}, each zero or positive, point positive.")
    information, inflation, _ = information_of(fit._minimum)
    information = information / inflation + np.eye(len(fit.inputs)) / PRIOR_LOG_ERROR**2
    noise = float(np.median(fit._minimum.relative_noise)) * math.sqrt(inflation)  # of a row, as the fit judges it
    places = _places(fit, speeds, loads, viscosities)
    rows: list[tuple[str, Contact, Array, float]] = []
    for i, (curve, contact) in enumerate(places):
        if on_step is not None:
            on_step(i + 1, len(places))
        made = _row(fit, curve, contact)
        if made is not None:
            rows.append((curve, contact, *made))
    if not rows:
        raise InputError("none of the states to be measured can be solved; give other speeds and loads.")
    set_loads, set_fluids = ({getattr(each, name) for each in fit.contacts} for name in ("load", "viscosity"))
    known: set[tuple[float, float]] = set()  # Where runs are chosen: the next one there needs no other load or fluid

    def price(contact: Contact) -> float:
        if (contact.load, contact.viscosity) in known:
            return prices["point"]
        other_load, other_fluid = contact.load not in set_loads, contact.viscosity not in set_fluids
        return prices["point"] + prices["load"] * other_load + prices["viscosity"] * other_fluid

    covariance = np.asarray(np.linalg.inv(information), dtype=np.float64)
    before = _errors(fit, covariance)
    scanned = tuple(_run(each, price(each[1]), _gain(each[2], covariance, noise), before) for each in rows)
    chosen = []
    for _ in range(count):
        gains = [_gain(j, covariance, noise) / price(contact) for _, contact, j, _ in rows]
        best = rows[int(np.argmax(gains))]
        gain = _gain(best[2], covariance, noise)
        shift = covariance @ best[2]
        covariance = covariance - np.outer(shift, shift) / (noise**2 + best[2] @ shift)
        run = _run(best, price(best[1]), gain, _errors(fit, covariance))
        chosen.append(run)
        known.add((run.load, run.viscosity))
    dimension = fit.contacts[0].INPUTS.quantities["load"].dimension
    return Plan(tuple(chosen), before, noise, scanned, dimension)


def _places(
    fit: Fit, speeds: Sequence[Any] | None, loads: Sequence[Any] | None, viscosities: Sequence[Any] | None
) -> list[tuple[str, Contact]]:
    """Return the states that may be measured, each with the curve that it belongs to."""
    table = fit.contacts[0].INPUTS
    given = {
        name: None if values is None else [table.quantities[name].checked(value) for value in values]
        for name, values in (("speed", speeds), ("load", loads), ("viscosity", viscosities))
    }
    tried = given["speed"]
    if tried is None:
        factors = np.array([RULES[each.groups.geometry].speed_per(fit.data.abscissa, each) for each in fit.contacts])
        measured = fit.data.values * factors[fit.data.curve]
        low, high = float(measured.min()), float(measured.max())
        tried = np.geomspace(low / SPEED_MARGIN, high * SPEED_MARGIN, CANDIDATE_SPEEDS).tolist()
    if any(not values for values in given.values() if values is not None) or min(tried) <= 0:
        raise InputError("speeds, loads and viscosities must hold at least one value, and speeds be positive.")
    states: dict[tuple[Contact, tuple[bool, ...]], tuple[str, Contact]] = {}  # Curves alike in all that is fitted are one
    for i, (name, contact) in enumerate(zip(fit.data.curves, fit.contacts, strict=True)):
        own = tuple(each.acts_on(i) for each in fit._minimum.objective.model.free)
        first = contact is fit.contacts[0]
        own_loads = given["load"] or ([contact.load * f for f in LOAD_RATIOS] if first else [contact.load])
        for load in own_loads:
            for viscosity in given["viscosity"] or [contact.viscosity]:
                there = contact.replace(load=load, viscosity=viscosity)
                states.setdefault((there, own), (name, there))
    return [(name, contact.replace(speed=speed)) for name, contact in states.values() for speed in tried]


def _row(fit: Fit, curve: str, contact: Contact) -> tuple[Array, float] | None:
    """Return the derivatives of ln(friction) with respect to the fitted inputs, and the friction; None if unsolvable."""
    try:
        if has_friction(contact, contact.groups):
            slopes, motion = atlas_sensitivities(contact, fit.definition), RULES[contact.groups.geometry].motion(contact)
            friction = float(atlas.friction(contact.groups, contact.boundary_friction, contact.beta, fit.definition, **motion))
        else:
            solution, slopes = friction_sensitivities(contact, rtol=STATE_RTOL, definition=fit.definition)
            friction = solution.friction(definition=fit.definition).total
    except (SolveError, InputError):
        return None
    at = fit.data.curves.index(curve)
    free = fit._minimum.objective.model.free
    row = [sum(slopes.get(name, 0.0) for name in each.names) if each.acts_on(at) else 0.0 for each in free]
    return (np.array(row), friction) if np.isfinite(row).all() else None


def _percents(errors: Mapping[str, float]) -> str:
    """Return standard errors as text."""
    return ", ".join(f"{name} {format_percent(error)}" for name, error in errors.items())


def _gain(j: Array, covariance: Array, noise: float) -> float:
    return 0.5 * math.log1p(float(j @ covariance @ j) / noise**2)


def _errors(fit: Fit, covariance: Array) -> dict[str, float]:
    return {each.label: math.sqrt(max(0.0, float(v))) for each, v in zip(fit.inputs, np.diag(covariance), strict=True)}


def _run(row: tuple[str, Contact, Array, float], price: float, gain: float, errors: dict[str, float]) -> NextRun:
    curve, contact, _, friction = row
    place = contact.speed, contact.load, contact.viscosity
    return NextRun(curve, *place, friction, gain, price, errors, contact.INPUTS.quantities["load"].unit)
