"""Curves over speed, load or roughness read off the atlas, with minimum and transitions located on it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from stribeck import atlas
from stribeck._types import Array
from stribeck.atlas.tables import TableRow, table_for
from stribeck.contacts.contact import Contact
from stribeck.contacts.friction import Definition
from stribeck.contacts.friction_rules import COMPLEX_STEP, RULES, FrictionRule
from stribeck.contacts.groups import Groups
from stribeck.contacts.regime import friction_share
from stribeck.curves.regime import (
    BOUNDARY_FLUID_SHARE,
    HYDRODYNAMIC_CONTACT_SHARE,
    Regime,
    Transition,
    ranges_of,
    regimes_along,
)
from stribeck.files.results import Drawn
from stribeck.quantities.inputs import si_text
from stribeck.quantities.lazy import cached_property
from stribeck.quantities.results import Card, Shown
from stribeck.quantities.units import InputError, show
from stribeck.solver.notes import law_notes

OBSERVABLES = ("contact_load_share", "fluid_load_share", "central_gap", "minimum_gap", "flux_gap", "offset")


SUBDIVISION = 33
ROUNDS = 4
"""Points and rounds of the search for a crossing between two points."""


@dataclass(frozen=True)
class Mark:
    """Where a curve on the atlas has its minimum or a transition."""

    name: str  # Its name, as on a solved curve
    value: float  # Where along the curve: group [-], or SI where the curve has a contact
    friction: float  # Friction coefficient there [-]


@dataclass(frozen=True, eq=False, repr=False)
class AtlasCurve(Drawn, Shown):
    """Friction along one coordinate, read off the atlas: a :class:`StribeckCurve` without solved fields."""

    _picture = "stribeck.curves.plot.plot_atlas_curve"

    over: str  # What varies
    values: Array  # Where the points lie, ascending: the group [-], or SI units where the curve has a contact
    groups_at: Callable[[Array], Groups]  # The groups at an array of such values
    contact: Contact | None  # The contact
    boundary_friction: float  # Friction coefficient of the dry contact and coefficient of the contact law [-]
    beta: float  # Friction coefficient of the dry contact and coefficient of the contact law [-]
    definition: Definition  # Definition of the viscous friction

    def __post_init__(self) -> None:
        """Refuse a geometry, model or law that the atlas does not hold."""
        _ = self.table

    def __len__(self) -> int:
        """Return the number of points."""
        return len(self.values)

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
        known = [each for each in OBSERVABLES if each != "flux_gap" or each in self.table.functions]
        if name not in known:
            raise InputError(f"name = {show(name)}; the atlas has {', '.join(known)}.")
        return np.asarray(getattr(atlas, name)(self.groups))

    @cached_property
    def friction(self) -> Array:
        """Friction coefficient [-]."""
        return self._friction_at(self.values)

    @property
    def friction_viscous(self) -> Array:
        """Viscous part of the friction coefficient [-]."""
        return atlas.friction_terms(self.groups, self._inputs(self.groups), self.definition)[1]

    @property
    def friction_contact(self) -> Array:
        """Contact part of the friction coefficient [-]."""
        return np.asarray(self._rubbing * self.observable("contact_load_share"))

    @property
    def friction_error(self) -> Array:
        """Stated absolute error of the friction coefficient [-]."""
        return self.table.error * np.abs(self.friction)

    @property
    def regimes(self) -> tuple[Regime, ...]:
        """Lubrication regime of each point."""
        return regimes_along(self.observable("fluid_load_share"), self.friction_contact, self.friction)

    @cached_property
    def regime_ranges(self) -> tuple[tuple[Regime, float, float], ...]:
        """Regimes along the curve, ascending: name, and the values between which it holds."""
        return ranges_of(self.values, self.regimes, self.transitions)

    @cached_property
    def minimum(self) -> Mark | None:
        """The minimum of the size of the friction; None where the curve has none inside."""
        i = int(np.argmin(np.abs(self.friction)))
        if not 0 < i < len(self) - 1:
            return None
        return self._mark(Transition.MINIMUM, i - 1, i + 1, self._slope_at)

    @cached_property
    def transitions(self) -> tuple[Mark, ...]:
        """The boundaries between regimes, where the load is shared in halves, and the friction minimum, ascending."""
        found = [] if self.minimum is None else [self.minimum]
        for name, line, function in (
            (Transition.BOUNDARY_END, BOUNDARY_FLUID_SHARE, self._fluid_at),
            (Transition.EQUAL_SHARES, 0.5, self._fluid_at),
            (Transition.HYDRODYNAMIC_START, HYDRODYNAMIC_CONTACT_SHARE, self._contact_part_at),
        ):
            crossings = np.nonzero(np.diff(np.sign(function(self.values) - line)))[0]
            if len(crossings):
                i = int(crossings[0])

                def above(values: Array, function: Callable[[Array], Array] = function, line: float = line) -> Array:
                    return function(values) - line

                found.append(self._mark(name, i, i + 1, above))
        return tuple(sorted(found, key=lambda mark: mark.value))

    def local_minima(self) -> tuple[Mark, ...]:
        """Return all minima of the size of the friction inside the curve, those above the boundary plateau too."""
        slope = self._slope_at(self.values)
        crossings = np.nonzero((slope[:-1] < 0) & (slope[1:] >= 0))[0]
        return tuple(self._mark(Transition.MINIMUM, int(i), int(i) + 1, self._slope_at) for i in crossings)

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

    def _mark(self, name: str, first: int, last: int, function: Callable[[Array], Array]) -> Mark:
        value = crossing(function, float(self.values[first]), float(self.values[last]))
        return Mark(name, value, float(self._friction_at(np.array([value]))[0]))

    @property
    def _rule(self) -> FrictionRule:
        return RULES[self.table.geometry]

    @cached_property
    def _rubbing(self) -> float:
        """``boundary_friction`` as far as it acts, with the sign of the sliding."""
        inputs = self._rule.of_contact(self.contact)
        return self.boundary_friction * float(self._rule.sliding_factor(self.groups_at(self.values[:1]), inputs))

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

    def _friction_at(self, values: Array) -> Array:
        groups = self.groups_at(values)
        contact, viscous = atlas.friction_terms(groups, self._inputs(groups), self.definition)
        return np.asarray(self._rubbing * contact + viscous)

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
        return np.asarray(found * np.sign(self._friction_at(values)))

    def _fluid_at(self, values: Array) -> Array:
        return np.asarray(atlas.fluid_load_share(self.groups_at(values)))

    def _contact_part_at(self, values: Array) -> Array:
        contact = self._rubbing * np.asarray(atlas.contact_load_share(self.groups_at(values)))
        return friction_share(contact, self._friction_at(values) - contact)


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


def crossing(function: Callable[[Array], Array], low: float, high: float) -> float:
    """Return where a function of an array changes its sign, the first such place between two positive numbers."""
    for _ in range(ROUNDS):
        points = np.geomspace(low, high, SUBDIVISION)
        values = function(points)
        changes = np.nonzero(np.diff(np.sign(values)))[0]
        i = int(changes[0]) if len(changes) else int(np.argmin(np.abs(values[:-1])))
        low, high = float(points[i]), float(points[i + 1])
    first, last = function(np.array([low, high]))
    part = 0.5 if first == last else float(np.clip(first / (first - last), 0.0, 1.0))
    return float(low * (high / low) ** part)
