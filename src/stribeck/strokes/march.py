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
from stribeck.equations.drag import friction_scale
from stribeck.equations.gap import central_gap, minimum_gaps
from stribeck.equations.line import LOAD
from stribeck.equations.operators import Operators
from stribeck.equations.state import State
from stribeck.equations.unsteady import Unsteady, swallowed
from stribeck.numerics.newton import Inverse, StepControl, root_find
from stribeck.numerics.settings import MAX_STEPS, SHARE
from stribeck.numerics.trace import Matrix
from stribeck.quantities.lazy import cached_property

__all__ = ["March", "StepLost"]

MAX_HALVINGS = 8  # Times that a step which fails is halved
SLOWEST_GROWTH = 0.5  # Least ratio of gaps in the guess of a step
STEP_RTOL = 1e-7  # Error that Newton's iteration may leave


class StepLost(Exception):  # noqa: N818
    """No step from an instant on arrives."""

    def __init__(self, time: float) -> None:
        self.time = time


class Past(NamedTuple):
    """A state on the way, and the one before it."""

    time: float
    y: Array
    inverse: Inverse | None
    step: float = 0.0  # The step that led here; zero for none
    y_before: Array | None = None
    equations: Unsteady | None = None  # Those that it fulfils


@dataclass(frozen=True, eq=False)
class March:
    """Steps on one mesh; time in 2a/U_0, speeds over U_0, and all else in Hertz units."""

    operators: Operators
    law: ContactLaw
    speed: float  # Speed group of U_0
    load: float  # Load group

    @cached_property
    def volume(self) -> Matrix:
        """The integral of the rate of the gap."""
        return swallowed(self.operators.mesh)

    def over(self, start: State, times: Array, share: Callable[[float], float], on_step: Callable[[int], None]) -> Array:
        """Return a row of :meth:`numbers` for each instant, that of the start first."""
        past = Past(float(times[0]), start.y, start.root.inverse)
        rows = [self.numbers(self.at(past, float(share(past.time))), past.y)]
        for k, time in enumerate(times[1:]):
            past = self._reach(past, float(time), share, MAX_HALVINGS)
            assert past.equations is not None
            rows.append(self.numbers(past.equations, past.y))
            on_step(k + 1)
        return np.array(rows)

    def at(self, past: Past, share: float, rate: float = 0.0, before: Array | float = 0.0) -> Unsteady:
        """Return the equations at an instant."""
        scale = float(past.y[self.blocks.layout.gap].min()) ** 2
        return Unsteady(self.operators, self.speed, self.law, scale, share, rate, before, self.volume)

    @cached_property
    def blocks(self) -> Unsteady:
        """Equations that know the layout of the unknowns."""
        return Unsteady(self.operators, self.speed, self.law)

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
        step, at = time - past.time, self.blocks.layout.gap
        gap, start = past.y[at], past.y
        if past.y_before is None:
            rate, before = 1 / step, gap / step
        else:
            r = step / past.step
            rate = (1 + 2 * r) / (1 + r) / step
            before = ((1 + r) * gap - r * r / (1 + r) * past.y_before[at]) / step
            start = past.y + r * (past.y - past.y_before)
            start[at] = gap * np.clip(gap / past.y_before[at], SLOWEST_GROWTH, 1 / SLOWEST_GROWTH) ** r
        equations = self.at(past, float(share(time)), rate, before)
        # A step with a kept inverse is many times cheaper than a new inverse.
        root = root_find(equations, start, StepControl(STEP_RTOL, MAX_STEPS, SHARE), past.inverse)
        if not (root.outcome.ok or root.last_step < STEP_RTOL):
            return None
        return Past(time, root.x, root.inverse, step, past.y, equations)

    def numbers(self, equations: Unsteady, y: Array) -> Array:
        """Return the share of asperities, the viscous friction for beta = 1, central and minimum gap."""
        # The traction of the film on the moving surface is eta U/h + h p'/2.
        u, mesh = equations.fields(y), self.operators.mesh
        asperities = mesh.weights @ equations.contact(u.gap) / LOAD
        sheared = equations.share / u.gap + 3 * u.gap * equations.gradient(equations.film, u)
        viscous = friction_scale(self.load, self.speed) * (mesh.weights @ sheared)
        lowest = minimum_gaps(mesh, np.log(u.gap[None, : -mesh.order]))[1][0]
        return np.array([asperities, viscous, central_gap(mesh, u.gap), lowest])
