r"""States of a ball on a lattice of the groups, solved when first asked for, and smooth functions of the groups between them.

The lattice is regular in :math:`\ln\lambda`, :math:`\ln\bar F_N` and :math:`\ln\kappa`.  Each state comes with its exact
derivatives, and a cell takes values and slopes at its eight corners: cubics along its edges, blended linearly across it.  That
reproduces all cubics, so that the error falls as the fourth power of the steps.  Kept are the log odds of the load share, the
logarithm of the Couette integral up to 25 a, and both other integrals over it, which are smooth from rest to full films.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field
from itertools import product
from typing import Any

import numpy as np

from stribeck._types import Array
from stribeck.contacts.cut_off import COUETTE, POISEUILLE
from stribeck.contacts.friction_rules import COMPLEX_STEP
from stribeck.contacts.groups import Groups, Physics
from stribeck.numerics.threads import one_blas_thread
from stribeck.solver.point.path import next_state, without_factors
from stribeck.solver.point.sensitivity import state_derivatives
from stribeck.solver.point.solution import finish_point
from stribeck.solver.point.state import PointState

__all__ = ["PARTS", "STEPS", "Lattice"]

PARTS = ("contact_load_share", "J_couette", "J_poiseuille", "J_pcx")  # What is interpolated

STEPS = (0.5, 0.8, 0.4)  # Steps of ln(speed), ln(load) and ln(relative roughness)

REACH = math.log(25.0)  # Logarithm of the radius up to which integrals are positive [ln a]

TINY, FAINT = 1e-250, 1e-13  # What stands for shares of asperities and of the fluid that underflow

STARTS = 16  # Solved states that are kept to start from

ON_NODE = 1e-9  # Distance in steps below which a place is a node of the lattice

Index = tuple[int, int, int]


@dataclass(eq=False)
class Lattice:
    """States around an anchor."""

    anchor: tuple[float, float, float]
    physics: Physics  # Contact law, geometry and model of all states
    rtol: float  # Relative tolerance of each
    is_smooth: bool = False  # Whether the roughness is zero
    steps: tuple[float, float, float] = STEPS  # Steps of the three
    nodes: dict[Index, tuple[Array, Array]] = field(default_factory=dict)
    _starts: dict[Index, PointState] = field(default_factory=dict)
    _last: tuple[Index, PointState] | None = None

    def at(self, logs: Array) -> tuple[Array, Array]:
        """Return :data:`PARTS` and their derivatives at places."""
        place = (logs - np.array(self.anchor)) / np.array(self.steps)
        if self.is_smooth:
            place[:, 2] = 0.0
        low = np.floor(place + ON_NODE)
        part = np.where(np.abs(place - low) < ON_NODE, 0.0, place - low)
        first = low.astype(int)
        self._solve({index for row, at in zip(first, part, strict=True) for index in _corners(row, at)})
        y, slopes = self._blended(first, part)
        return self._parts(y, slopes, logs[:, 0])

    def _blended(self, first: Array, part: Array) -> tuple[Array, Array]:
        """Return the smooth functions and their derivatives, shapes (4, n) and (4, 3, n)."""
        n = len(part)
        y, slopes = np.zeros((4, n)), np.zeros((4, 3, n))
        steps = np.array(self.steps)
        for corner in product((0, 1), repeat=3):
            chosen = [self.nodes.get(tuple(np.add(row, corner)), _NOTHING) for row in first]
            f = np.array([each[0] for each in chosen]).T
            g = np.array([each[1] for each in chosen]).transpose(1, 2, 0) * steps[:, None]
            # Linear weight of the corner along each direction, and what turns a linear edge into a cubic one.
            line = [part[:, d] if corner[d] else 1 - part[:, d] for d in range(3)]
            sign = [1.0 if corner[d] else -1.0 for d in range(3)]
            for d in range(3):
                a, b = (d + 1) % 3, (d + 2) % 3
                t, side = line[d], line[a] * line[b]
                # The cubics of value one and of slope one at this end, the first less the straight line.
                bend, tilt = t * t * (3 - 2 * t) - t, -sign[d] * t * t * (1 - t)
                y += side * (bend * f + tilt * g[:, d])
                by_t, tilt_by_t = 6 * t * (1 - t) - 1, -sign[d] * (2 * t - 3 * t * t)
                slopes[:, d] += side * sign[d] * (by_t * f + tilt_by_t * g[:, d])
                for e, other in ((a, b), (b, a)):
                    slopes[:, e] += sign[e] * line[other] * (bend * f + tilt * g[:, d])
            y += line[0] * line[1] * line[2] * f
            for d in range(3):
                slopes[:, d] += sign[d] * line[(d + 1) % 3] * line[(d + 2) % 3] * f
        slopes /= steps[:, None]
        self._slopes_on_nodes(first, part, slopes)
        return y, slopes

    def _slopes_on_nodes(self, first: Array, part: Array, slopes: Array) -> None:
        """Put the derivatives along directions in which a place is on a node in place of differences to what is not solved."""
        for d in range(1, 3):
            for i in np.nonzero(part[:, d] == 0)[0]:
                total = np.zeros(4)
                for index in _corners(first[i], part[i]):
                    weight = math.prod(p if index[e] > first[i][e] else 1 - p for e, p in enumerate(part[i]))
                    total += weight * self.nodes[index][1][:, d]
                slopes[:, d, i] = total

    def _parts(self, y: Array, slopes: Array, ln_speed: Array) -> tuple[Array, Array]:
        values = np.real(_from_smooth(y, ln_speed))
        found = np.empty_like(slopes)
        for d in range(3):
            moved = _from_smooth(y + 1j * COMPLEX_STEP * slopes[:, d], ln_speed + 1j * COMPLEX_STEP * (d == 0))
            found[:, d] = moved.imag / COMPLEX_STEP
        return values, found

    def _solve(self, wanted: Iterable[Index]) -> None:
        """Solve the nodes that are not known yet, each from its nearest neighbour, from fast to slow."""
        missing = sorted((index for index in wanted if index not in self.nodes), key=lambda i: (i[1], i[2], -i[0]))
        if missing:
            one_blas_thread(self._solve_all)(missing)

    def _solve_all(self, missing: list[Index]) -> None:
        for index in missing:
            s, ln_load, ln_kappa = (a + i * step for a, i, step in zip(self.anchor, index, self.steps, strict=True))
            load = math.exp(ln_load)
            scale = Groups(1.0, load, 1.0, **self.physics)
            roughness = 0.0 if self.is_smooth else math.exp(ln_kappa) / float(scale.relative_roughness)
            groups = Groups(math.exp(s), load, roughness, **self.physics)
            state = next_state(self._nearest(index), groups, self.rtol)
            finish_point(state, None)
            self.nodes[index] = self._smooth(state)
            self._last = index, state
            self._starts[index] = without_factors(state)
            while len(self._starts) > STARTS:
                self._starts.pop(next(iter(self._starts)))

    def _nearest(self, index: Index) -> PointState | None:
        def distance(other: Index) -> float:
            return sum(step * abs(i - j) for i, j, step in zip(index, other, self.steps, strict=True))

        if self._last is not None and distance(self._last[0]) <= 1.01 * max(self.steps):
            return self._last[1]
        near = min(self._starts, key=distance, default=None)
        return None if near is None or distance(near) > 4 * max(self.steps) else self._starts[near]

    def _smooth(self, state: PointState) -> tuple[Array, Array]:
        """Return the smooth functions of a state and their derivatives, shapes (4,) and (4, 3)."""
        slopes = state_derivatives(state)
        names = ("contact_load_share", "fluid_load_share", *PARTS[1:])
        values = np.array([state.values[name] for name in names])
        by = np.array([slopes[name] for name in names])
        by[:, 1] += state.groups.scaling.roughness_exponent * by[:, 2]  # at fixed relative roughness
        by[values == 0] = 0.0
        values[0], values[1] = max(values[0], TINY), max(values[1], FAINT)
        s = math.log(float(state.groups.speed))
        y = _to_smooth(values, s)
        columns = [
            _to_smooth(values + 1j * COMPLEX_STEP * by[:, d], s + 1j * COMPLEX_STEP * (d == 0)).imag / COMPLEX_STEP
            for d in range(3)
        ]
        return y.real, np.stack(columns, axis=1)


_NOTHING = np.zeros(4), np.zeros((4, 3))


def _corners(first: Array, part: Array) -> list[Index]:
    """Return the corners of a cell that count at a place in it."""
    found = []
    for corner in product(*((0, 1) if p > 0 else (0,) for p in part.tolist())):
        i, j, k = (int(f) + c for f, c in zip(first, corner, strict=True))
        found.append((i, j, k))
    return found


def _to_smooth(values: Any, ln_speed: complex) -> Any:
    """Return log odds, logarithm of the Couette integral up to 25 a over the speed, and both other integrals over it."""
    contact, fluid, couette, poiseuille, of_contact = values
    speed = np.exp(ln_speed)
    whole = couette + COUETTE * speed * REACH
    flow = (poiseuille + POISEUILLE * speed * REACH) / whole
    return np.array([np.log(contact / fluid), np.log(whole / speed), flow, of_contact / whole])


def _from_smooth(y: Any, ln_speed: Any) -> Any:
    """Return :data:`PARTS` by the smooth functions."""
    speed = np.exp(ln_speed)
    whole = np.exp(y[1]) * speed
    share = 1 / (1 + np.exp(-y[0]))
    return np.array([share, whole - COUETTE * speed * REACH, y[2] * whole - POISEUILLE * speed * REACH, y[3] * whole])
