r"""The march in time: implicit steps of second order of the film (BDF2, first a step of implicit Euler).

.. math:: \tau \partial_t h \approx \frac{1 + 2r}{1 + r} h_n - (1 + r) h_{n-1} + \frac{r^2}{1 + r} h_{n-2}

with the step :math:`\tau` and r its ratio to the step before.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from stribeck._types import Array
from stribeck.contact_laws.law import ContactLaw
from stribeck.contacts.groups import Groups, contact_law
from stribeck.equations.drag import friction_scale
from stribeck.equations.film import is_thinning
from stribeck.equations.gap import gap_beside, minimum_gap
from stribeck.equations.observables import area_by_pressure
from stribeck.equations.operators import LOAD, Operators
from stribeck.equations.state import State, unknowns_of
from stribeck.equations.unsteady import Unsteady, swallowed, swallowed_up_to
from stribeck.numerics.newton import Inverse, Root, StepControl, root_between, root_find
from stribeck.numerics.settings import (
    COARSE_STEP,
    HALF_DIGITS,
    MAX_REFINEMENTS,
    MAX_STEPS,
    NEGLIGIBLE,
    SHARE,
)
from stribeck.numerics.trace import Matrix
from stribeck.quantities.lazy import cached_property


# What has passed a trailing edge lies on the surface where it passed; a leading edge that comes back draws it in, and pushes
# ahead what it does not. On either side the liquid is no less than the part of it that the contact has not reached.
@dataclass(frozen=True, eq=False)
class Wake:
    """The liquid on one side of the contact; lengths in half-widths, volumes in u_Hz a."""

    way: float  # Direction in which the surface comes from there: 1 from the left, -1 from the right
    places: Array  # Positions on the surface, towards it, the first at the contact
    lying: Array  # Liquid that lies beyond each
    held: float = 0.0  # All of the liquid

    @classmethod
    def at(cls, way: float, place: float) -> Wake:
        """Return the wake of a contact that has not moved yet."""
        return cls(way, np.array([way * place]), np.zeros(1))

    def is_reached(self, place: float) -> bool:
        """Return whether the surface comes from there on the way to a position."""
        return self.way * place > float(self.places[0])

    def lies_beyond(self, place: float) -> float:
        """Return the liquid that a contact at a position has not reached; minus infinity where it is flooded."""
        return float(np.interp(self.way * place, self.places, self.lying, right=-math.inf))

    def moved(self, place: float, drawn: float) -> Wake:
        """Return the wake after a step, in which the contact has drawn in some liquid, or left some if that is negative."""
        held = self.held - drawn
        here, lying = self.way * place, held
        if self.is_reached(place) and self.lies_beyond(place) > -math.inf:
            lying = self.lies_beyond(place)
        ahead = self.places > here
        places, lies = (np.append(first, rest[ahead]) for first, rest in ((here, self.places), (lying, self.lying)))
        return replace(self, places=places, lying=lies, held=held)


Begins: TypeAlias = tuple[int, float] | None
"""Of a starved film, the side of its inlet and where it begins."""

Moving: TypeAlias = Callable[[float], tuple[float, float]]
"""Time -> the speed over U_0, and the position of the moving surface [a]."""


class StepLost(Exception):  # noqa: N818
    """No step from an instant on arrives."""

    def __init__(self, time: float) -> None:
        self.time = time


class Film(NamedTuple):
    """A state at the end of a step."""

    equations: Unsteady
    root: Root
    flows: list[float]  # Flux at both edges of the dry contact


Solve: TypeAlias = Callable[[Begins, Array, Inverse | None], Film | None]


class Past(NamedTuple):
    """A state on the way, and what a step from it takes of the state before."""

    time: float
    film: Film
    wakes: tuple[Wake, ...]  # Left and right of the contact; none where the inlet is always flooded
    step: float  # The step that led here; infinite for none
    y_before: Array
    held_before: Array


@dataclass(frozen=True, eq=False)
class March:
    """Steps on one mesh; time in 2a/U_0, speeds over U_0, and all else in Hertz units."""

    operators: Operators
    groups: Groups  # At the speed U_0
    ends: bool  # Whether the film ends where its pressure would fall below the ambient one
    by_area: bool  # Whether asperities rub by their real area, not by their load
    own_wake: bool  # Whether the inlet has what the contact has left

    @cached_property
    def law(self) -> ContactLaw:
        """The contact law."""
        return contact_law(self.groups)

    @cached_property
    def to_edges(self) -> tuple[Matrix, Matrix]:
        """The integrals of the rate of the mass up to the edges of the dry contact."""
        left, right = (swallowed_up_to(self.operators.integral, edge) for edge in (-1.0, 1.0))
        return left, right

    @cached_property
    def volume(self) -> Matrix:
        """The integral of the rate of the mass."""
        return swallowed(self.operators.mesh)

    def over(self, guess: State, times: Array, moving: Moving, on_step: Callable[[int], None]) -> Array:
        """Return a row of :meth:`numbers` for each instant, the first one of the steady state near a guess."""
        past = self._start(guess, float(times[0]), *moving(times[0]))
        rows = [self.numbers(past.film)]
        for k, time in enumerate(times[1:]):
            past = self._reach(past, float(time), moving, MAX_REFINEMENTS)
            rows.append(self.numbers(past.film))
            on_step(k + 1)
        return np.array(rows)

    def equations(
        self,
        share: float,
        scale: float,
        rate: float = 0.0,
        before: Array | float = 0.0,
        begins: Begins = None,
    ) -> Unsteady:
        """Return the equations at an instant; the rows of the gradient have the factor ``scale``."""
        speed = float(self.groups.speed)
        return Unsteady(self.operators, speed, self.law, scale, share, rate, before, self.volume, self.ends, begins)

    def _start(self, guess: State, time: float, share: float, place: float) -> Past:
        """Return the steady state at a share of the speed, by Newton's iteration from a state on another mesh."""
        equations = self.equations(share, guess.flux_gap**2)
        y, at = unknowns_of(equations, guess), equations.layout
        x = self.operators.mesh.nodes - guess.exit
        logs, pressure = guess.fields(x)
        y[at.gap], y[at.flux_gap] = np.exp(logs), share * guess.flux_gap
        if at.pressure.start < at.pressure.stop:
            y[at.pressure] = np.where(share * x < 0, pressure, 0.0) if self.ends else pressure
        root = root_find(equations, y, self._control(equations))
        if not self._arrived(root):
            raise StepLost(time)
        wakes = (Wake.at(1.0, place), Wake.at(-1.0, place)) if self.own_wake else ()
        film = Film(equations, root, self._flows(equations, root.x))
        return Past(time, film, wakes, math.inf, root.x, held(film))

    def _control(self, equations: Unsteady) -> StepControl:
        return StepControl(HALF_DIGITS, MAX_STEPS, SHARE, monotone=is_thinning(equations.film))

    def _arrived(self, root: Root) -> bool:
        """Return whether an iteration left an error that does not count."""
        return root.outcome.ok or root.last_step < NEGLIGIBLE * COARSE_STEP

    def _reach(self, past: Past, time: float, moving: Moving, halvings: int) -> Past:
        """Return the state at an instant; a step that fails is halved."""
        found = self._step(past, time, moving)
        if found is not None:
            return found
        if halvings == 0:
            raise StepLost(past.time)
        middle = self._reach(past, 0.5 * (past.time + time), moving, halvings - 1)
        return self._reach(middle, time, moving, halvings - 1)

    def _step(self, past: Past, time: float, moving: Moving) -> Past | None:
        last, step, (share, place) = past.film, time - past.time, moving(time)
        r = step / past.step
        rate = (1 + 2 * r) / (1 + r) / step

        def before(now: Any, earlier: Any) -> Any:
            return ((1 + r) * now - r * r / (1 + r) * earlier) / step

        y, at, mass = last.root.x, last.equations.layout.gap, held(last)
        gap, start = y[at], y + r * (y - past.y_before)
        start[at] = gap * (gap / past.y_before[at]) ** r

        def film(begins: Begins, guess: Array, kept: Inverse | None) -> Film | None:
            equations = self.equations(share, float(gap.min()) ** 2, rate, before(mass, past.held_before), begins)
            # A step with a kept inverse is many times cheaper than a new inverse.
            root = root_find(equations, guess, self._control(equations), kept)
            return Film(equations, root, self._flows(equations, root.x)) if self._arrived(root) else None

        found = film(None, start, last.root.inverse)
        for side, wake in enumerate(past.wakes):
            if found is not None and share and wake.is_reached(place):
                arriving = (wake.held - wake.lies_beyond(place)) / step
                if wake.way * found.flows[side] > arriving:
                    found = self._starved(film, found, side, arriving / abs(share))
        if found is None:
            return None
        wakes = tuple(
            wake.moved(place, step * wake.way * (flow if wake.is_reached(place) else 0.5 * (flow + earlier)))
            for wake, flow, earlier in zip(past.wakes, found.flows, last.flows, strict=False)
        )
        return Past(time, found, wakes, step, y, mass)

    def _flows(self, equations: Unsteady, y: Array) -> list[float]:
        """Return the flux at both edges of the dry contact."""
        u = equations.fields(y)
        return [equations.carried_at(edge, u).item() for edge in self.to_edges]

    def _starved(self, film: Solve, flooded: Film, side: int, arriving: float) -> Film | None:
        """Return the film that begins where it draws in no more than what arrives, as a gap that it would fill."""
        order = self.operators.mesh.order
        x, gap = self.operators.mesh.nodes[:-order], flooded.root.x[flooded.equations.layout.gap][:-order]
        middle = int(np.argmin(gap))
        outwards = slice(middle, None) if side else slice(middle, None, -1)
        widest = np.maximum.accumulate(gap[outwards])
        found, flux = [flooded], flooded.equations.share * arriving

        def excess(part: float) -> float:
            """Return what a film draws in beyond what arrives, where it begins at a gap of the liquid over a part."""
            # A gap that the liquid just fills draws in nothing; in one that is infinite the film is flooded.
            if part == 1.0:
                return -flux
            if part:
                place = float(np.interp(arriving / part, widest, x[outwards]))
                each = film((side, place), found[-1].root.x, found[-1].root.inverse)
                if each is None:
                    return -flux
                found.append(each)
            return found[-1].flows[side] - flux

        root_between(excess, 0.0, 1.0, COARSE_STEP)
        return found[-1] if len(found) > 1 else None

    def numbers(self, film: Film) -> Array:
        """Return share of asperities, by what they rub, viscous friction for beta = 1, both gaps, flux at both edges."""
        equations, mesh = film.equations, self.operators.mesh
        u = equations.fields(film.root.x)
        g = equations.gradient(equations.film, u)
        between, share = equations.between(u, g), equations.share
        sheared = equations.film.tractions(u.gap, u.pressure, equations.carried(u))[0]
        if between is not None and share:
            # Behind an edge the liquid that has passed it goes on with the speed of the walls, half of it; before that of a
            # starved film there is what arrives.
            passed = share * mesh.interpolate(u.gap, np.array(between.edges))
            if equations.begins is not None:
                passed[equations.begins[0]] = film.flows[equations.begins[0]]
            for flux, outside in zip(passed, (mesh.nodes < between.edges[0], mesh.nodes > between.edges[1]), strict=True):
                sheared = np.where(outside, equations.film.cavity_traction(u.gap, u.pressure, flux), sheared)
        contact = equations.contact(u.gap)
        asperities = mesh.weights @ contact / LOAD
        rubbing = area_by_pressure(self.groups, mesh, 1.0, contact) if self.by_area else asperities
        viscous = friction_scale(self.groups.load, self.groups.speed) * (mesh.weights @ sheared)
        gaps = gap_beside(mesh, u.gap, 0.0)[0], minimum_gap(mesh, u.gap)[1]
        return np.array([asperities, rubbing, viscous, *gaps, *film.flows])


def held(film: Film) -> Array:
    """Return the mass across the film at the nodes."""
    u = film.equations.fields(film.root.x)
    return np.asarray(film.equations.film.held(u.gap, u.pressure))
