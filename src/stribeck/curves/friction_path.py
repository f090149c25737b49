"""Friction as a function along a path, and its events: the transitions between regimes, and its minima."""

from __future__ import annotations

import math
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from stribeck._types import Array
from stribeck.asperity_friction.coulomb import as_asperity_friction
from stribeck.contacts.friction import (
    BOUNDARY_FLUID_SHARE,
    HYDRODYNAMIC_CONTACT_SHARE,
    Definition,
    Friction,
    FrictionArray,
    check_definition,
    coefficients,
    friction_of,
    friction_share,
)
from stribeck.curves.regime import Landmark, Transition
from stribeck.curves.source import Coefficients, CurveValues, Parts, Readings, Source
from stribeck.numerics.dual import Dual, slope_of
from stribeck.numerics.events import Event, first_zero, least_by_slope
from stribeck.numerics.threads import one_blas_thread
from stribeck.quantities.lazy import cached_property
from stribeck.solver.solve_error import SolveError

LOCATION_LOG_TOLERANCE = 1e-9  # Change of ln(value) to which a landmark is located; errors of its state are added
LOG_STEP = 1e-3  # Step of ln(value) in derivatives by real differences
MAX_POLISH_STATES = 4  # Most states solved for one landmark: each squares the error


def vanishing(mark: Transition, fluid: Any, contact: Any, viscous: Any) -> Any:
    """Return what vanishes at a transition, from the fluid's load share and both parts of the friction."""
    if mark is Transition.MINIMUM:  # where friction changes its sign its size is least
        return contact + viscous
    if mark is Transition.HYDRODYNAMIC_START:
        return friction_share(contact, viscous) - HYDRODYNAMIC_CONTACT_SHARE
    return fluid - (BOUNDARY_FLUID_SHARE if mark is Transition.BOUNDARY_END else 0.5)


@dataclass(frozen=True, eq=False)
class FrictionPath:
    """The friction along a source of numbers, for given coefficients."""

    source: Source
    boundary_friction: Any  # A coefficient, or another friction of asperities
    beta: float
    definition: Definition

    @property
    def coefficients(self) -> Coefficients:
        """Those of the friction."""
        return self.boundary_friction, self.beta, self.definition

    def friction(
        self,
        found: Readings,
        is_number: bool = False,
        boundary_friction: Any = None,
        beta: float | None = None,
        definition: Definition | None = None,
    ) -> Friction | FrictionArray:
        """Return the friction of readings, which may be called for other coefficients."""
        given = coefficients(
            None,
            self.boundary_friction if boundary_friction is None else boundary_friction,
            self.beta if beta is None else beta,
        )
        of = self.definition if definition is None else check_definition(definition)
        return friction_of(found.friction_terms(*given, of), partial(self.friction, found, is_number), is_number)

    def values(self, value: float | Array) -> CurveValues:
        """Return all that is known at one value, or at many."""
        found = self.source.read(np.log(np.atleast_1d(value)))
        return CurveValues.of(value, found, self.friction(found, not np.ndim(value)))

    def parts(self, s: Array) -> Parts:
        """Return the load share of the fluid and both parts of the friction."""
        return self.source.parts(s, self.coefficients)

    def fluid_shares(self, s: Array) -> Array:
        """Return the load share of the fluid, whatever the friction."""
        return np.asarray(self.source.parts(s, (1.0, self.beta, self.definition))[0])

    def slopes(self, s: Array) -> Array:
        """Return the derivatives of the friction by the coordinate."""
        return self.source.slopes(s, self.coefficients)

    def slope(self, s: float) -> float:
        """Return the derivative of the friction at a place."""
        return float(self.slopes(np.array([s]))[0])

    def known(self, places: Array) -> tuple[Array, Array, Array, Array]:
        """Return those places at which there are numbers, the fluid's load share and both parts of the friction."""
        parts = np.stack(self.parts(places))
        known = np.isfinite(parts).all(axis=0)  # no series holds close to where a cavity opens
        return places[known], *parts[:, known]

    @cached_property
    def _searched(self) -> tuple[Array, Array, Array, Array]:
        return self.known(self.source.places)

    def first(self, mark: Transition, places: Array, fluid: Array, contact: Array, viscous: Array) -> Event | None:
        """Return where first on the way along places what vanishes at a transition does, or None."""

        def at(s: float) -> float:
            return float(vanishing(mark, *self.parts(np.array([s])))[0])

        return first_zero(at, places, vanishing(mark, fluid, contact, viscous), LOCATION_LOG_TOLERANCE)

    def event(self, mark: Transition) -> Event | None:
        """Return where a transition or the minimum lies, or None where there is none."""
        if mark is Transition.MINIMUM and self.source.coordinate.groups_at(self.source.ends[0]).speed == 0:
            return None  # at rest the friction is that of the dry contact everywhere
        places, *parts = self._searched
        event, sizes = self.first(mark, places, *parts), np.abs(vanishing(mark, *parts))
        if event is None and mark is Transition.MINIMUM and len(sizes):
            noise = self.source.accepted(None) * float(sizes.min())
            event = least_by_slope(self.slope, places, sizes, LOCATION_LOG_TOLERANCE, shallowest=noise)
        return event

    @cached_property
    def _found(self) -> dict[tuple[Transition, float], Landmark | None]:
        return {}

    def landmark(self, mark: Transition, rtol: float | None = None) -> Landmark | None:
        """Return a transition or the minimum, None where there is none."""
        accepted = self.source.accepted(rtol)
        if (mark, accepted) not in self._found:
            event = self.event(mark)
            self._found[mark, accepted] = None if event is None else self.located(mark, event, accepted)
        return self._found[mark, accepted]

    @one_blas_thread
    def located(self, mark: Transition, event: Event, accepted: float) -> Landmark:
        """Return the landmark at an event: read off, or where errors exceed what is accepted on states solved there."""
        source, place = self.source, event.place
        rtol, holds = min(source.rtol, accepted), source.holds(place, accepted)
        at: Any = None
        if not holds and (source.has_state_slopes or not event.is_least):
            with suppress(SolveError):  # the curve is known there too, only less well
                place, at = self._polished(mark, event, rtol)
        if at is None:
            found = source.read(np.array([place]), rtol if holds else None)
            at = found.solutions[0] if found.solutions else self.values(math.exp(place))
        error = LOCATION_LOG_TOLERANCE + self._doubt(mark, event, at) / abs(event.slope)
        friction = at.friction(*self.coefficients)
        total = friction.total if abs(friction.total) > friction.error else 0.0
        solution = None if isinstance(at, CurveValues) else at
        return Landmark(mark, math.exp(place), total, solution, error, source.coordinate.over, source.coordinate.unit)

    def _polished(self, mark: Transition, event: Event, rtol: float) -> tuple[float, Any]:
        """Return the place of an event by solved states, and the last of these."""
        s = event.place
        for _ in range(MAX_POLISH_STATES):
            solution = self.source.solved(s, rtol)
            if event.is_least:
                value = self.source.state_slope(s, rtol, self.coefficients)
            else:
                friction = solution.friction(*self.coefficients)
                value = float(vanishing(mark, solution.fluid_load_share, friction.asperities, friction.fluid))
            step = -value / event.slope
            if not abs(step) < event.high - event.low:
                break
            s += step
            if abs(step) <= LOCATION_LOG_TOLERANCE or abs(value) <= self._doubt(mark, event, solution):
                break
        return s, solution

    def _doubt(self, mark: Transition, event: Event, at: Any) -> float:
        """Return the error of what vanishes at an event, from those of a state there."""
        friction = at.friction(*self.coefficients)
        if event.is_least:
            # Errors change along an interval as its polynomials do.
            length = max(self.source.length_at(event.place), LOG_STEP)
            near = self.source.read(event.place + LOG_STEP * np.array([-1.0, 1.0]))
            before, after = near.friction_terms(*self.coefficients)[:, 3].tolist()
            return float(2 * friction.error / length + abs(after - before) / (2 * LOG_STEP))
        # What is read off a curve knows no contact, but the friction of its asperities.
        amount, error = as_asperity_friction(self.boundary_friction).amount(at)
        of_contact = abs(friction.asperities / amount) * error if amount else 0.0
        errors = np.array([at.errors["fluid_load_share"], of_contact, friction.error - of_contact])
        values = at.fluid_load_share, friction.asperities, friction.fluid
        parts = (Dual(value, row) for value, row in zip(values, np.eye(3), strict=True))
        return float(np.abs(slope_of(vanishing(mark, *parts))) @ errors)

    @one_blas_thread
    def continued(
        self,
        end: float,
        until: Callable[[FrictionPath], bool] | None = None,
        on_interval: Callable[[float, float], object] | None = None,
    ) -> FrictionPath:
        """Return the path from its nearer end to a place, or as far as ``until`` holds of it, without a cold start."""

        def on(path: Any) -> FrictionPath:
            return replace(self, source=self.source.along(path))

        is_enough = None if until is None else lambda path: until(on(path))
        return on(self.source.path.continued(end, self.source.rtol, on_interval, is_enough))
