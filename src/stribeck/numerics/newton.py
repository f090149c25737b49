r"""Damped Newton iteration for F(x) = 0.

.. math:: J(x_k) \, \Delta x_k = -F(x_k), \qquad x_{k+1} = x_k + t_k \, \Delta x_k, \quad 0 < t_k \le 1

The module knows no physics. A :class:`Problem` brings its residual, the inverse of its Jacobian, how much of a step is
admissible (for example so that a gap stays positive) and what a small step is; :class:`Dense` makes one of plain
functions. How the linear systems are solved is the problem's own affair: an :class:`Inverse` is all that is seen here.

To make an inverse costs much more than to apply it: n^3 against n^2 for a dense Jacobian. So each Newton step is
followed by the trial of a chord step, one with the same inverse: its size measures the error left, and if that is below
the tolerance the last factorisation is spared. With ``chord`` such steps are also taken while they contract well.

Source: [Deuflhard 2011] Newton Methods for Nonlinear Problems (affine-covariant Newton: the step, not the
residual, measures the error; simplified Newton).

Work that is no longer wanted ends between the steps of iterations, by what the caller of the work raises there: see
:func:`ended_by`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from typing import Protocol

import numpy as np
import numpy.typing as npt
from scipy.linalg import lapack

from stribeck._types import Array
from stribeck.numerics.settings import COARSE_STEP, HALF_DIGITS, MAX_STEPS, NEGLIGIBLE, STEP_GROWTH
from stribeck.quantities.outcome import Outcome

_WATCH: ContextVar[Callable[[], object] | None] = ContextVar("watch", default=None)


@contextmanager
def ended_by(watch: Callable[[], object]) -> Iterator[None]:
    """Let all iterations of this thread call ``watch`` at each step."""
    before = _WATCH.set(watch)
    try:
        yield
    finally:
        _WATCH.reset(before)


def go_on() -> None:
    """Call the watch of this thread, if there is one."""
    watch = _WATCH.get()
    if watch is not None:
        watch()


class Inverse(Protocol):
    """A function that removes residuals to first order; made at one state, good near it."""

    @property
    def is_finite(self) -> bool:
        """Whether the Jacobian was finite: then steps that are not mean that it is singular."""

    def __call__(self, residuals: Array) -> Array:
        """Return ``-J^-1 r`` of each residual, shape (..., n), in the units of the unknowns."""


class Problem(Protocol):
    """A nonlinear system as :func:`root_find` sees it."""

    def residual(self, x: Array) -> Array:
        """Return F(x), shape (n,)."""

    def inverse(self, x: Array) -> Inverse:
        """Return the inverse of the Jacobian at ``x``, its unknowns measured in :meth:`units`."""

    def units(self, x: Array) -> Array:
        """Return the units of the unknowns, shape (n,), in which a kept inverse takes the derivative as constant."""

    def admissible(self, x: Array, dx: Array) -> float:
        """Return the longest admissible fraction of the step, in (0, 1]."""

    def size(self, x: Array, dx: Array) -> float:
        """Return the size of a step relative to the length over which F bends, >= 0."""


@dataclass(frozen=True)
class StepControl:
    """When the iteration ends, and when it keeps an inverse."""

    tolerance: float = 1e-10  # Size of the error at which the iteration ends, > 0
    max_steps: int = 50  # Largest number of steps, >= 1
    chord: float | None = None
    monotone: bool = False


@dataclass(frozen=True, eq=False)
class LU:
    """The inverse that the LU factors of a dense Jacobian are."""

    factors: tuple[Array, npt.NDArray[np.int32]]

    @classmethod
    def of(cls, matrix: Array, overwrite: bool = False) -> LU:
        """Return the factors of a matrix; with ``overwrite`` in its own memory if it is in Fortran order."""
        # A pivot that is exactly zero needs no check here: it shows in the step.
        lu, pivots, _ = lapack.dgetrf(matrix, overwrite_a=overwrite)
        return cls((lu, pivots))

    @property
    def is_finite(self) -> bool:
        """Whether all factors are finite."""
        return bool(np.isfinite(self.factors[0]).all())

    def __call__(self, residuals: Array) -> Array:
        """Return ``-J^-1 r`` of each residual, shape (..., n)."""
        if residuals.ndim == 1:
            dx: Array = lapack.dgetrs(*self.factors, residuals)[0]
            return np.negative(dx, out=dx)
        columns = residuals.reshape(-1, residuals.shape[-1]).T
        return np.asarray(-lapack.dgetrs(*self.factors, columns)[0].T.reshape(residuals.shape))


def relative_size(x: Array, dx: Array) -> float:
    r"""Size of a step relative to the state, :math:`\max|\Delta x| / (1 + \max|x|)`."""
    return float(np.abs(dx).max() / (1.0 + np.abs(x).max()))


@dataclass(frozen=True, eq=False)
class Dense:
    """The problem of plain functions, its Jacobian a dense matrix."""

    function: Callable[[Array], Array]  # `function(x)` returns F, shape (n,)
    jacobian: Callable[[Array], Array]  # `jacobian(x)` returns dF/dx, shape (n, n)
    fraction: Callable[[Array, Array], float] | None = None
    step_size: Callable[[Array, Array], float] = relative_size  # `step_size(x, dx)` returns the size of a step

    def residual(self, x: Array) -> Array:
        """Return F(x)."""
        return self.function(x)

    def inverse(self, x: Array) -> LU:
        """Return the LU factors of the Jacobian."""
        return LU.of(self.jacobian(x))

    def units(self, x: Array) -> Array:
        """Return ones."""
        return np.ones_like(x)

    def admissible(self, x: Array, dx: Array) -> float:
        """Return the fraction that the function allows."""
        return 1.0 if self.fraction is None else self.fraction(x, dx)

    def size(self, x: Array, dx: Array) -> float:
        """Return the size that the function gives."""
        return self.step_size(x, dx)


@dataclass(frozen=True, eq=False)
class Root:
    """The result of :func:`root_find`."""

    x: Array  # The root, or the last iterate with a finite residual if the outcome is a failure
    outcome: Outcome  # How the iteration ended
    steps: int  # Steps taken, Newton and chord steps together
    factorisations: int  # Inverses made: the cost of the root
    last_step: float  # Size of the last undamped step; nan before the first
    residual: Array | None  # The residual at `x`; None if it was not evaluated there
    inverse: Inverse | None  # The last one; None if none could be made

    @property
    def effort(self) -> int:
        """The factorisations, under the name that :class:`stribeck.numerics.continuation.StepPath` asks for."""
        return self.factorisations


def root_find(problem: Problem, start: npt.ArrayLike, control: StepControl | None = None, kept: Inverse | None = None) -> Root:
    r"""Find x with F(x) = 0 by damped Newton steps."""
    x = np.array(start, dtype=np.float64)
    control = StepControl() if control is None else control
    tolerance, chord = control.tolerance, control.chord

    inverse = kept
    steps = factorisations = 0
    s = math.nan  # size of the last step
    smallest = math.inf
    longest = 1.0
    reusable = chord is not None and inverse is not None

    def root(outcome: Outcome) -> Root:
        return Root(x, outcome, steps, factorisations, s, r, inverse)

    def step(inverse: Inverse, r: Array) -> Array:
        dx = inverse(r)
        return np.multiply(problem.units(x), dx, out=dx)

    with np.errstate(all="ignore"):
        r = problem.residual(x)
        if not np.isfinite(r).all():
            return root(Outcome.NOT_FINITE)

        while steps < control.max_steps:
            go_on()
            chord_step = False
            if reusable and inverse is not None:
                dx, t = step(inverse, r), 1.0
                s_new = problem.size(x, dx)
                # The first step with the caller's inverse is measured as if one had led here that counts.
                rate = s_new / (s if steps else NEGLIGIBLE)
                # Of a series of steps that fall at this rate the rest is within the tolerance.
                contracts = rate <= (chord or 0.0) or (s_new <= tolerance and rate * s_new <= (1 - rate) * tolerance)
                chord_step = contracts and (steps > 0 or problem.admissible(x, dx) >= 1.0)
            if not chord_step:
                inverse = None  # frees its memory for the next one
                inverse = problem.inverse(x)
                factorisations += 1
                dx = step(inverse, r)
                if not np.isfinite(dx).all():
                    return root(Outcome.SINGULAR if inverse.is_finite else Outcome.NOT_FINITE)
                s_new = problem.size(x, dx)
                t = problem.admissible(x, dx)
            if not math.isfinite(s_new):
                return root(Outcome.NOT_FINITE)

            if not t >= HALF_DIGITS:
                return root(Outcome.STALLED)
            trial = _finite_trial(problem.residual, x, dx, min(t, longest, 1.0))
            if control.monotone and inverse is not None and not chord_step and s_new > COARSE_STEP:
                units = problem.units(x)
                wanted = _mean(dx / units)
                while trial is not None and not _mean(inverse(trial[1])) <= (1 - NEGLIGIBLE * trial[2]) * wanted:
                    if not trial[2] >= 2 * HALF_DIGITS:
                        return root(Outcome.STALLED)
                    trial = _finite_trial(problem.residual, x, dx, 0.5 * trial[2])
                longest = 1.0 if trial is None else STEP_GROWTH * trial[2]
            if trial is None:
                return root(Outcome.NOT_FINITE)
            x, r, t = trial
            s = s_new
            steps += 1
            reusable = t == 1.0

            if t == 1.0:
                unmeasured = chord_step and steps == 1  # an inverse that the caller brought may be far off
                if s == 0.0 or (s <= tolerance and not unmeasured):
                    return root(Outcome.CONVERGED)
                if not chord_step:
                    if s > 0.5 * smallest and smallest <= COARSE_STEP:
                        return root(Outcome.ROUNDING)
                    smallest = min(smallest, s)
        return root(Outcome.STEP_LIMIT)


def _mean(step: Array) -> float:
    """Return the root of the mean square."""
    return float(np.sqrt(np.mean(step * step)))


def _finite_trial(residual: Callable[[Array], Array], x: Array, dx: Array, t: float) -> tuple[Array, Array, float] | None:
    """Return x + t dx, its residual and t, this halved until the residual is finite; None if it never is."""
    while t >= HALF_DIGITS:
        x_new = x + dx if t == 1.0 else x + t * dx
        r_new = residual(x_new)
        if np.isfinite(r_new).all():
            return x_new, r_new, t
        t = 0.5 * t
    return None


def root_between(function: Callable[[float], float], low: float, high: float, tolerance: float) -> float | None:
    """Return a zero between two places of unlike sign, by inverse interpolation and bisection."""
    places, values = [low, high], [function(low), function(high)]
    if 0.0 in values:
        return places[values.index(0.0)]
    if not values[0] * values[1] < 0:
        return None
    falls = True
    while high - low > tolerance and len(places) < MAX_STEPS:
        c = _where_zero(places, values) if falls else math.nan
        if abs(c - places[-1]) <= tolerance:
            return min(max(c, low), high)
        c = c if low < c < high else 0.5 * (low + high)
        value = function(c)
        if value == 0.0:
            return c
        falls = abs(value) <= 0.5 * abs(values[-1])
        if value * values[0] > 0:
            low = c
        else:
            high = c
        places.append(c)
        values.append(value)
    return 0.5 * (low + high)


def _where_zero(places: list[float], values: list[float]) -> float:
    """Return the place for the value zero, on the polynomial of the value through all; nan if two values are equal."""
    found = places
    for k in range(1, len(places)):
        if any(a == b for a, b in zip(values, values[k:], strict=False)):
            return math.nan
        found = [(b * x - a * y) / (b - a) for a, b, x, y in zip(values, values[k:], found, found[1:], strict=False)]
    return found[0]
