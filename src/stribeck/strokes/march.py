r"""The march in time: implicit steps of second order of the film, and what is read off each.

.. math:: \tau \partial_t h \approx \frac{1 + 2r}{1 + r} h_n - (1 + r) h_{n-1} + \frac{r^2}{1 + r} h_{n-2}

with the step :math:`\tau` and r its ratio to the step before (BDF2); the first step is one of implicit Euler.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from stribeck._types import Array
from stribeck.contact_laws.law import ContactLaw
from stribeck.contacts.groups import Groups, contact_law
from stribeck.equations.drag import friction_scale
from stribeck.equations.film import is_thinning
from stribeck.equations.gap import gap_beside, minimum_gap
from stribeck.equations.line import LOAD
from stribeck.equations.operators import Operators
from stribeck.equations.real_area import area_by_pressure
from stribeck.equations.state import State, unknowns_of
from stribeck.equations.unsteady import Unsteady, swallowed
from stribeck.numerics.newton import Inverse, Root, StepControl, root_find
from stribeck.numerics.settings import COARSE_STEP, HALF_DIGITS, MAX_REFINEMENTS, MAX_STEPS, NEGLIGIBLE, SHARE, STEP_GROWTH
from stribeck.numerics.trace import Matrix
from stribeck.quantities.lazy import cached_property

__all__ = ["March", "StepLost"]


class StepLost(Exception):  # noqa: N818
    """No step from an instant on arrives."""

    def __init__(self, time: float) -> None:
        self.time = time


class Past(NamedTuple):
    """A state on the way, the equations that it fulfils, and what a step from it takes of the state before."""

    time: float
    y: Array
    equations: Unsteady
    inverse: Inverse | None
    step: float = 0.0  # The step that led here; zero for none
    y_before: Array | None = None
    held_before: Array | None = None

    @property
    def held(self) -> Array:
        """The mass across the film at the nodes."""
        u = self.equations.fields(self.y)
        return np.asarray(self.equations.film.held(u.gap, u.pressure))


@dataclass(frozen=True, eq=False)
class March:
    """Steps on one mesh; time in 2a/U_0, speeds over U_0, and all else in Hertz units."""

    operators: Operators
    groups: Groups  # At the speed U_0
    ends: bool  # Whether the film ends where its pressure would fall below the ambient one
    by_area: bool  # Whether asperities rub by their real area, not by their load

    @cached_property
    def law(self) -> ContactLaw:
        """The contact law."""
        return contact_law(self.groups)

    @cached_property
    def volume(self) -> Matrix:
        """The integral of the rate of the mass."""
        return swallowed(self.operators.mesh)

    def over(self, guess: State, times: Array, share: Callable[[float], float], on_step: Callable[[int], None]) -> Array:
        """Return a row of :meth:`numbers` for each instant, the first one of the steady state near a guess."""
        past = self._start(guess, float(times[0]), float(share(times[0])))
        rows = [self.numbers(past)]
        for k, time in enumerate(times[1:]):
            past = self._reach(past, float(time), share, MAX_REFINEMENTS)
            rows.append(self.numbers(past))
            on_step(k + 1)
        return np.array(rows)

    def equations(self, share: float, scale: float = 1.0, rate: float = 0.0, before: Array | float = 0.0) -> Unsteady:
        """Return the equations at an instant; the rows of the gradient have the factor ``scale``."""
        return Unsteady(self.operators, float(self.groups.speed), self.law, scale, share, rate, before, self.volume, self.ends)

    def _start(self, guess: State, time: float, share: float) -> Past:
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
        return Past(time, root.x, equations, root.inverse)

    def _control(self, equations: Unsteady) -> StepControl:
        return StepControl(HALF_DIGITS, MAX_STEPS, SHARE, monotone=is_thinning(equations.film))

    def _arrived(self, root: Root) -> bool:
        """Return whether an iteration left an error that does not count."""
        return root.outcome.ok or root.last_step < NEGLIGIBLE * COARSE_STEP

    def _reach(self, past: Past, time: float, share: Callable[[float], float], halvings: int) -> Past:
        """Return the state at an instant; a step that fails is halved."""
        found = self._step(past, time, share)
        if found is not None:
            return found
        if halvings == 0:
            raise StepLost(past.time)
        middle = self._reach(past, 0.5 * (past.time + time), share, halvings - 1)
        return self._reach(middle, time, share, halvings - 1)

    def _step(self, past: Past, time: float, share: Callable[[float], float]) -> Past | None:
        step, at = time - past.time, past.equations.layout.gap
        gap, held, start = past.y[at], past.held, past.y
        if past.y_before is None or past.held_before is None:
            rate, before = 1 / step, held / step
        else:
            r = step / past.step
            rate = (1 + 2 * r) / (1 + r) / step
            before = ((1 + r) * held - r * r / (1 + r) * past.held_before) / step
            start = past.y + r * (past.y - past.y_before)
            start[at] = gap * np.clip(gap / past.y_before[at], 1 / STEP_GROWTH, STEP_GROWTH) ** r
        equations = self.equations(float(share(time)), float(gap.min()) ** 2, rate, before)
        # A step with a kept inverse is many times cheaper than a new inverse.
        root = root_find(equations, start, self._control(equations), past.inverse)
        return Past(time, root.x, equations, root.inverse, step, past.y, held) if self._arrived(root) else None

    def numbers(self, past: Past) -> Array:
        """Return the share of asperities, by what they rub, viscous friction for beta = 1, central and minimum gap."""
        equations, mesh = past.equations, self.operators.mesh
        u = equations.fields(past.y)
        g = equations.gradient(equations.film, u)
        between, share = equations.between(u, g), equations.share
        sheared = equations.film.tractions(u.gap, u.pressure, equations.carried(u))[0]
        if between is not None and share:
            # Behind an edge the liquid that has passed it goes on with the speed of the walls, half of it.
            for edge, outside in zip(
                between.edges, (mesh.nodes < between.edges[0], mesh.nodes > between.edges[1]), strict=True
            ):
                passed = share * mesh.interpolate(u.gap, np.array([edge]))
                sheared = np.where(outside, equations.film.cavity_traction(u.gap, u.pressure, passed), sheared)
        contact = equations.contact(u.gap)
        asperities = mesh.weights @ contact / LOAD
        rubbing = area_by_pressure(self.groups, mesh, 1.0, contact) if self.by_area else asperities
        viscous = friction_scale(self.groups.load, self.groups.speed) * (mesh.weights @ sheared)
        return np.array([asperities, rubbing, viscous, gap_beside(mesh, u.gap, 0.0)[0], minimum_gap(mesh, u.gap)[1]])
