r"""Damped Newton iteration for F(x) = 0 with a dense Jacobian, and the outcomes a solve can have.

.. math:: J(x_k) \, \Delta x_k = -F(x_k), \qquad x_{k+1} = x_k + t_k \, \Delta x_k, \quad 0 < t_k \le 1

The module knows no physics. What is special to a problem comes in as functions: ``fraction`` (how much of a
step is admissible, for example so that a gap stays positive) and ``size`` (what a small step is).

A factorisation costs n^3, a solve with its factors n^2. So each Newton step is followed by the trial of a
chord step, one with the same factors: its size measures the error left, and where that is below the tolerance
the last factorisation is spared. With ``chord`` such steps are also taken while they contract well.

Source: [Deuflhard 2011] Newton Methods for Nonlinear Problems (affine-covariant Newton: the step, not the
residual, measures the error; simplified Newton).
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum

import numpy as np
import numpy.typing as npt
from scipy.linalg import lapack

from stribeck._types import Array

Factors = tuple[Array, npt.NDArray[np.int32]]

SMALLEST_FRACTION = 1e-8  # a step damped below this part of Newton's makes no progress
HALVINGS = 12  # trials to get back to where the residual is finite
LAST_CHORD = 0.5  # a chord step within the tolerance is trusted if it contracted at least so much
ROUNDING_SIZE = 1e-5  # steps that stop contracting below this size are rounding, above it they wander
STALE_STEPS = 3  # so many Newton steps without a halving mean that steps have stopped contracting


class Outcome(Enum):
    """How a solve ended: a sentence for people; :attr:`ok` says whether the result can be trusted."""

    CONVERGED = "Converged."
    STEP_LIMIT = "Newton reached its largest number of steps; try a nearer guess or smaller parameter steps."
    SINGULAR = "The Jacobian is singular here; near a fold use pseudo-arclength continuation."
    NOT_FINITE = "The residual or its Jacobian is not finite here; try a nearer guess."
    STALLED = "The damped Newton step became too small to make progress; try a nearer guess."
    REFINEMENT_LIMIT = "Refining the mesh came to its end before the tolerance held; ask for a larger rtol."
    ROUNDING = (
        "Double precision bounds the error of this state above the asked rtol; "
        "ask for a larger rtol or use the value with its error estimate."
    )
    PATH_LOST = (
        "The continuation path to this state was lost; "
        "the points before it are kept, and smaller steps or another start may pass."
    )
    INTERRUPTED = "Interrupted before the end; the points finished until then are kept."

    @property
    def ok(self) -> bool:
        """True for :attr:`CONVERGED` only."""
        return self is Outcome.CONVERGED


@dataclass(frozen=True, eq=False)
class Root:
    """What :func:`root_find` returns.

    Attributes
    ----------
    x : ndarray, shape (n,)
        The root, or the last iterate with a finite residual where the outcome is a failure.
    outcome : Outcome
        How the iteration ended.
    steps : int
        Steps taken, Newton and chord steps together.
    factorisations : int
        Jacobians factorised: the cost of the root.
    last_step : float
        Size of the last undamped step, as ``size`` measures it; nan before the first.
    contraction : float
        Size of the last step over that of the one before it; nan with fewer than two.
    residual_norm : float
        Largest absolute value of the residual at ``x``.
    factors : tuple of ndarray or None
        The last LU factors, as for :func:`scipy.linalg.lu_solve`; None if none could be made.
    """

    x: Array
    outcome: Outcome
    steps: int
    factorisations: int
    last_step: float
    contraction: float
    residual_norm: float
    factors: Factors | None

    @property
    def effort(self) -> int:
        """The factorisations, under the name that :func:`stribeck.numerics.continuation.march` asks for."""
        return self.factorisations


def relative_size(x: Array, dx: Array) -> float:
    r"""Size of a step relative to the state, :math:`\max|\Delta x| / (1 + \max|x|)`.

    Parameters
    ----------
    x, dx : ndarray, shape (n,)
        State and step.

    Returns
    -------
    float
        The default ``size`` of :func:`root_find`.
    """
    return float(np.abs(dx).max() / (1.0 + np.abs(x).max()))


def root_find(
    residual: Callable[[Array], Array],
    jacobian: Callable[[Array], Array],
    start: npt.ArrayLike,
    *,
    fraction: Callable[[Array, Array], float] | None = None,
    size: Callable[[Array, Array], float] = relative_size,
    tolerance: float = 1e-10,
    max_steps: int = 50,
    chord: float | None = None,
    factors: Factors | None = None,
    units: Callable[[Array], Array] | None = None,
    overwrite_jacobian: bool = False,
    singular_below: float = 2.0**-52,
) -> Root:
    r"""Find x with F(x) = 0 by damped Newton steps.

    Parameters
    ----------
    residual : callable
        ``residual(x)`` returns F, shape (n,).
    jacobian : callable
        ``jacobian(x)`` returns dF/dx, dense, shape (n, n); Fortran order saves a copy.
    start : array_like, shape (n,)
        First iterate; not written to.
    fraction : callable, optional
        ``fraction(x, dx)`` returns the longest admissible part of the step, in (0, 1].
    size : callable, optional
        ``size(x, dx)`` returns the size of a step relative to the length over which F bends, >= 0.
    tolerance : float, optional
        Size of the error at which the iteration ends, > 0.
    max_steps : int, optional
        Largest number of steps, >= 1.
    chord : float, optional
        Take a step with the last factors where it is at most this part of the step before it, in (0, 1);
        0.1 is a good value. None takes such a step only to end the iteration.
    factors : tuple of ndarray, optional
        LU factors of a nearby Jacobian (``Root.factors`` of a neighbour) for the first step; needs ``chord``.
    units : callable, optional
        ``units(x)``, shape (n,), are lengths in which unknowns are measured: ``jacobian`` then returns dF/dx times
        ``diag(units(x))``. That matters to steps with kept factors, of which the derivative in units of the unknowns
        is taken to be constant.
    overwrite_jacobian : bool, optional
        Let LAPACK factorise in the array that ``jacobian`` returns, which must fill it anew at each call.
    singular_below : float, optional
        Reciprocal condition number, once rows and columns are scaled to one, at which the Jacobian counts as
        singular. 0 leaves that to steps that are not finite, and spares a second factorisation where the
        pivots alone look doubtful.

    Returns
    -------
    Root
        With its :class:`Outcome`; a failure is returned, not raised.

    Raises
    ------
    ValueError
        If an argument lies outside its range, or the shapes of F and J do not fit.

    Notes
    -----
    The iteration ends when an undamped step is at most ``tolerance``, that step being taken: a Newton step,
    or a chord step at most half as long as the step before it. So the error left is below ``tolerance``
    (``test_newton.py::test_the_error_left_is_below_the_tolerance``).

    A trial point where F is not finite is approached by halving the step. Newton steps that are small but no
    longer contract end the iteration as ROUNDING, with the best state that double precision gives.

    Floating-point warnings are silenced during the call: a value that is not finite shows in the outcome.
    """
    x = np.array(start, dtype=np.float64)
    if x.ndim != 1 or x.size == 0:
        raise ValueError(f"start has shape {x.shape}; it must be one-dimensional and not empty")
    if not tolerance > 0:
        raise ValueError(f"tolerance = {tolerance!r}; it must be positive, for example 1e-10")
    if max_steps < 1:
        raise ValueError(f"max_steps = {max_steps!r}; it must be at least 1")
    if chord is not None and not 0 < chord < 1:
        raise ValueError(f"chord = {chord!r}; it must lie between 0 and 1, or be None for Newton steps only")
    square = (x.size, x.size)
    if factors is not None and factors[0].shape != square:
        raise ValueError(f"factors have shape {factors[0].shape}; a state of {x.size} needs {square}")

    steps = factorisations = stale = 0
    s = before = math.nan  # sizes of this step and of the step before it
    smallest = math.inf
    reusable = chord is not None and factors is not None

    def root(outcome: Outcome) -> Root:
        norm = float(np.abs(r).max())
        return Root(x, outcome, steps, factorisations, s, s / before if before else math.nan, norm, factors)

    def step(factors: Factors, r: Array) -> Array:
        dx = _solve(factors, r)
        return dx if units is None else np.multiply(units(x), dx, out=dx)

    with np.errstate(all="ignore"):
        r = residual(x)
        if r.shape != x.shape:
            raise ValueError(f"residual returned shape {r.shape}; it must have the shape of x, {x.shape}")
        if not np.isfinite(r).all():
            return root(Outcome.NOT_FINITE)

        while steps < max_steps:
            chord_step = False
            if reusable and factors is not None:
                dx, t = step(factors, r), 1.0
                s_new = size(x, dx)
                rate = s_new / s if steps else 0.0  # the caller's factors are taken to be good
                contracts = rate <= (chord or 0.0) or (s_new <= tolerance and rate <= LAST_CHORD)
                chord_step = contracts and (steps > 0 or fraction is None or fraction(x, dx) >= 1.0)
            if not chord_step:
                factors = None  # frees their memory for the next ones
                factors = _factorise(jacobian(x), overwrite_jacobian)
                factorisations += 1
                if factors[0].shape != square:
                    raise ValueError(f"jacobian returned shape {factors[0].shape}; it must be {square}")
                dx = step(factors, r)
                if not np.isfinite(dx).all():
                    return root(Outcome.SINGULAR if np.isfinite(factors[0]).all() else Outcome.NOT_FINITE)
                if singular_below > 0.0 and _has_small_pivot(factors[0]):
                    if _is_singular(jacobian(x), singular_below):
                        return root(Outcome.SINGULAR)
                    if overwrite_jacobian:  # that call may have reused their memory
                        factors = _factorise(jacobian(x), overwrite_jacobian)
                        factorisations += 1
                s_new = size(x, dx)
                t = 1.0 if fraction is None else fraction(x, dx)
            if not math.isfinite(s_new):
                return root(Outcome.NOT_FINITE)

            if not t >= SMALLEST_FRACTION:
                return root(Outcome.STALLED)
            trial = _finite_trial(residual, x, dx, min(t, 1.0))
            if trial is None:
                return root(Outcome.NOT_FINITE)
            x, r, t = trial
            before, s = s, s_new
            steps += 1
            reusable = t == 1.0

            if t == 1.0:
                unmeasured = chord_step and steps == 1  # factors that the caller brought may be far off
                if s == 0.0 or (s <= tolerance and not unmeasured):
                    return root(Outcome.CONVERGED)
                if not chord_step:
                    stale = 0 if s <= 0.5 * smallest else stale + 1
                    smallest = min(smallest, s)
                    if stale >= STALE_STEPS and smallest <= ROUNDING_SIZE:
                        return root(Outcome.ROUNDING)
        return root(Outcome.STEP_LIMIT)


def _finite_trial(residual: Callable[[Array], Array], x: Array, dx: Array, t: float) -> tuple[Array, Array, float] | None:
    """Return x + t dx, its residual and t, this halved until the residual is finite; None if it never is."""
    for _ in range(HALVINGS + 1):
        x_new = x + dx if t == 1.0 else x + t * dx
        r_new = residual(x_new)
        if np.isfinite(r_new).all():
            return x_new, r_new, t
        t = 0.5 * t
    return None


def _factorise(matrix: Array, overwrite: bool) -> Factors:
    # A pivot that is exactly zero needs no check here: it shows in the solution or among the small pivots.
    lu, pivots, _ = lapack.dgetrf(matrix, overwrite_a=overwrite)
    return lu, pivots


def _solve(factors: Factors, r: Array) -> Array:
    dx: Array = lapack.dgetrs(*factors, r)[0]
    return np.negative(dx, out=dx)


def _has_small_pivot(lu: Array) -> bool:
    """Whether a pivot is small against the largest: cheap, but true also of rows that are badly scaled."""
    pivots = np.abs(lu.diagonal())
    return bool(pivots.min() <= lu.shape[0] * np.finfo(float).eps * pivots.max())


def _is_singular(matrix: Array, singular_below: float) -> bool:
    """Whether the matrix, its rows and columns scaled to one, is worse conditioned than that."""
    for axis in (1, 0):
        scale = np.abs(matrix).max(axis=axis, keepdims=True)
        if scale.min() == 0.0:
            return True
        matrix = matrix / scale
    lu, _, _ = lapack.dgetrf(matrix)
    reciprocal_condition, _ = lapack.dgecon(lu, np.abs(matrix).sum(axis=0).max())  # 0 for a zero pivot
    return bool(reciprocal_condition <= singular_below)
