"""Curves over speed, load or roughness read off the atlas, with minimum and transitions located on it."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np

from stribeck import atlas
from stribeck._types import Array
from stribeck.atlas.tables import TableRow, table_for
from stribeck.contact_laws.law import AsperityLaw
from stribeck.contacts.contact import Contact
from stribeck.contacts.friction import Definition
from stribeck.contacts.friction_rules import COMPLEX_STEP, RULES, FrictionRule
from stribeck.contacts.groups import Groups
from stribeck.curves.base_curve import BaseCurve
from stribeck.curves.coordinate import Over
from stribeck.curves.function import CurveValues
from stribeck.curves.landmarks import Landmark, vanishing
from stribeck.curves.regime import HYDRODYNAMIC_CONTACT_SHARE, Transition
from stribeck.numerics.events import Event, first_zero, least_by_slope
from stribeck.quantities.inputs import si_text
from stribeck.quantities.lazy import cached_property
from stribeck.quantities.outcome import Outcome
from stribeck.quantities.results import Card
from stribeck.quantities.units import InputError, show
from stribeck.solver.notes import law_notes

OBSERVABLES = ("contact_load_share", "fluid_load_share", "central_gap", "minimum_gap", "flux_gap", "offset")


LOCATION_LOG_TOLERANCE = 1e-9  # Change of ln(value) to which a landmark is located on the table
LOG_STEP = 1e-4  # Step of ln(value) in the slope from which a landmark's error follows


@dataclass(frozen=True, eq=False, repr=False)
class AtlasCurve(BaseCurve):
    """Friction along one coordinate, read off the atlas: a :class:`StribeckCurve` without solved fields."""

    _picture = "stribeck.plot.curve.plot_curve"

    over: Over  # What varies
    values: Array  # Where the points lie, ascending: the group [-], or SI units where the curve has a contact
    groups_at: Callable[[Array], Groups]  # The groups at an array of such values
    contact: Contact | None  # The contact
    boundary_friction: float  # Friction coefficient of the dry contact and coefficient of the contact law [-]
    beta: float  # Friction coefficient of the dry contact and coefficient of the contact law [-]
    definition: Definition  # Definition of the viscous friction

    def __post_init__(self) -> None:
        """Refuse a geometry, model or law that the atlas does not hold."""
        _ = self.table

    @cached_property
    def table(self) -> TableRow:
        """The table of the atlas that holds for the curve."""
        return table_for(self.groups_at(self.values[:1]))

    @cached_property
    def groups(self) -> Groups:
        """Groups of the points, as arrays."""
        return self.groups_at(self.values)

    def observable(self, name: str) -> Array:
        """Return a load share, a gap or the offset of every point."""
        return self._observable(name, self.groups)

    @property
    def observables(self) -> tuple[str, ...]:
        """Names of the observables that the table holds."""
        return tuple(each for each in OBSERVABLES if each != "flux_gap" or each in self.table.functions)

    def _observable(self, name: str, groups: Groups) -> Array:
        if name not in self.observables:
            raise InputError(f"name = {show(name)}; the atlas has {', '.join(self.observables)}.")
        return np.asarray(getattr(atlas, name)(groups))

    def local_minima(self) -> tuple[Landmark, ...]:
        """Return all minima of the size of the friction inside the curve, those above the boundary plateau too."""
        slope = self._slope_at(self.values)
        places = np.log(self.values)
        inside = [slice(i, i + 2) for i in np.flatnonzero((slope[:-1] < 0) & (slope[1:] >= 0))]
        events = [first_zero(self._along(self._slope_at), places[i], slope[i], LOCATION_LOG_TOLERANCE) for i in inside]
        return tuple(self._landmark(Transition.MINIMUM, event) for event in events if event is not None)

    @property
    def solutions(self) -> tuple[Any, ...]:
        """No states."""
        return ()

    @property
    def notes(self) -> tuple[str, ...]:
        """No notes: those on the contact law are in :attr:`law_in_doubt`."""
        return ()

    @property
    def outcome(self) -> Outcome:
        """Always CONVERGED."""
        return Outcome.CONVERGED

    @property
    def requested(self) -> int:
        """Number of points."""
        return len(self)

    @property
    def rtol(self) -> float:
        """Stated relative error of the table."""
        return self.table.error

    @property
    def law(self) -> AsperityLaw | None:
        """Contact law of all points; None is the exponential one."""
        return self.groups.law

    @property
    def error_estimate(self) -> float:
        """Stated relative error of the table."""
        return self.table.error

    @cached_property
    def law_in_doubt(self) -> Array:
        """Whether the contact law is outside its range at each point while asperities matter there."""
        viscous = atlas.friction_terms(self.groups, self._inputs(self.groups), "balanced")[1]
        return where_law_is_in_doubt(self.groups, self.contact, viscous, (self.boundary_friction, self.beta))

    def _card(self) -> Card:
        low, high = (self._where(value) for value in (self.values[0], self.values[-1]))
        rows = [
            ("friction", f"{self.friction.min():.4g} to {self.friction.max():.4g} ({self.definition})"),
            *((mark.name, f"{mark.friction:.4g} at {self._where(mark.value)}") for mark in self.transitions),
            ("regimes", ", ".join(dict.fromkeys(self.regimes))),
            ("dry friction, beta", f"{self.boundary_friction:g}, {self.beta:g}"),
            ("stated error", f"{self.table.error:.1g}, of the table"),
        ]
        return Card(f"{len(self)} points off the atlas, {self.over} {low} to {high}", rows, ())

    def _where(self, value: float) -> str:
        return f"{value:.4g}" if self.contact is None else si_text(float(value), self.over, 4, self.contact.INPUTS)

    @property
    def _ends(self) -> tuple[float, float]:
        return float(self.values[0]), float(self.values[-1])

    def _sampled(self, values: Array) -> Self:
        return replace(self, values=values)

    def _values(self, value: Any, s: Array) -> CurveValues:
        groups = self.groups_at(self._inside(s))
        contact, viscous, total, error = self._friction_terms(groups, self.boundary_friction, self.beta, self.definition).T
        values = {name: self._observable(name, groups) for name in self.observables}
        shown = (lambda column: column) if np.ndim(value) else (lambda column: float(column[0]))
        return CurveValues(
            value=value,
            values={name: shown(column) for name, column in values.items()},
            relative_errors=np.full((*np.shape(value), len(values)), self.table.error),
            minimum_position_error=math.nan,
            friction_contact=shown(contact),
            friction_viscous=shown(viscous),
            friction=shown(total),
            friction_error=shown(error),
            names=self.observables,
        )

    def _friction_of(self, boundary_friction: float, beta: float, definition: Definition) -> Array:
        return self._friction_terms(self.groups, boundary_friction, beta, definition)

    def _friction_terms(self, groups: Groups, boundary_friction: float, beta: float, definition: Definition) -> Array:
        """Return contact and viscous friction, their sum and its error at groups, shape (n, 4)."""
        share, viscous = atlas.friction_terms(groups, {**self._inputs(groups), "beta": beta}, definition)
        contact = boundary_friction * self._sliding * share
        total = contact + viscous
        return np.stack([contact, viscous, total, self.table.error * np.abs(total)], axis=1)

    def _accepted(self, rtol: float | None) -> float:
        return self.table.error

    def _find(self, mark: Transition, accepted: float) -> Landmark | None:
        places = np.log(self.values)

        def function(values: Array) -> Array:
            groups = self.groups_at(values)
            fluid = self._observable("fluid_load_share", groups)
            return vanishing(mark, fluid, *self._friction_terms(groups, *self._coefficients)[:, :2].T)

        known = function(self.values)
        event = first_zero(self._along(function), places, known, LOCATION_LOG_TOLERANCE)
        if event is None and mark is Transition.MINIMUM:
            event = least_by_slope(self._along(self._slope_at), places, np.abs(known), LOCATION_LOG_TOLERANCE)
        return None if event is None else self._landmark(mark, event)

    def _landmark(self, mark: Transition, event: Event) -> Landmark:
        """Return the landmark at an event, with the error that the table's own error leaves."""
        found = self._values(math.exp(event.place), np.array([event.place]))
        before, after = (event.function(event.place + step) for step in (-LOG_STEP, LOG_STEP))
        scale = {
            Transition.MINIMUM: abs(found.friction),
            Transition.HYDRODYNAMIC_START: HYDRODYNAMIC_CONTACT_SHARE,
        }.get(mark, found.fluid_load_share)
        steepness = abs(after - before) / (2 * LOG_STEP)
        error = self.table.error * scale / steepness if steepness else math.inf
        return Landmark(mark, found.value, found.friction, error=error, over=self.over)

    def _inside(self, s: Array) -> Array:
        """Return values of coordinates, inside the curve but for rounding."""
        return np.clip(np.exp(s), *self._ends)

    def _along(self, function: Callable[[Array], Array]) -> Callable[[float], float]:
        """Return a function of many values as one of a coordinate."""
        return lambda s: float(function(self._inside(np.array([s])))[0])

    @property
    def _coefficients(self) -> tuple[float, float, Definition]:
        return self.boundary_friction, self.beta, self.definition

    @property
    def _rule(self) -> FrictionRule:
        return RULES[self.table.geometry]

    @cached_property
    def _sliding(self) -> float:
        """Fraction of the sliding friction of asperities that acts, with its sign."""
        inputs = self._rule.of_contact(self.contact)
        return float(self._rule.sliding_factor(self.groups_at(self.values[:1]), inputs))

    def _inputs(self, groups: Groups) -> dict[str, Any]:
        """Return the arguments of the friction other than the groups; a length in Hertz radii changes with the load."""
        found: dict[str, Any] = {**self._rule.of_contact(self.contact), "beta": self.beta}
        for name in self._moving:
            assert self.contact is not None
            found[name] = found[name] * (groups.load / self.contact.groups.load) ** self._moving[name]
        return found

    @property
    def _moving(self) -> dict[str, float]:
        """Exponents of the load in those of these arguments that change with it along the curve."""
        if self.contact is None or self.over != "load":
            return {}
        return {name: powers["load"] for name, powers in self._rule.exponents.items()}

    def _slope_at(self, values: Array) -> Array:
        """Return the derivative of the size of the friction along the curve."""
        groups = self.groups_at(values)
        inputs = self._inputs(groups)
        motion = {name: value for name, value in inputs.items() if name != "beta"}
        slopes = atlas.friction_derivatives(groups, self.boundary_friction, self.beta, self.definition, **motion)
        direction = [float(name == self.over) for name in ("speed", "load", "roughness")]
        if self.contact is not None:
            direction = list(self.contact.INPUTS.exponents[self.over])
        found = np.tensordot(direction, slopes, 1)
        for name, power in self._moving.items():
            moved = {**inputs, name: inputs[name] * (1 + 1j * COMPLEX_STEP)}
            found = found + power * np.imag(atlas.friction_terms(groups, moved, self.definition)[1]) / COMPLEX_STEP
        return np.asarray(found * np.sign(self._friction_terms(groups, *self._coefficients)[:, 2]))


@dataclass(frozen=True)
class _Read:
    """The values of a state off the atlas on which notes on the contact law depend."""

    contact_load_share: float
    central_gap: float
    minimum_gap: float
    viscous: float

    def viscous_friction(self, beta: float) -> float:
        """Return the viscous friction, which is known for the contact's own beta alone."""
        return self.viscous


def where_law_is_in_doubt(
    along: Groups, contact: Contact | None, viscous: Array, given: tuple[float, float] | None = None
) -> Array:
    """Return where the contact law is outside its range along groups off the atlas, as notes of states say it."""
    axes = np.broadcast_arrays(along.speed, along.load, along.roughness)
    read = [atlas.contact_load_share(along), atlas.central_gap(along), atlas.minimum_gap(along), viscous]
    found = []
    for speed, load, roughness, *values in np.stack([*axes, *read]).T.tolist():
        groups = replace(along, speed=speed, load=load, roughness=roughness)
        found.append(bool(law_notes(groups, contact, _Read(*values), given)))
    return np.array(found, bool)
