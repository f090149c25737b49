r"""Pseudo-arclength continuation: following a branch of F(x, p) = 0 by its own length, through folds.

The curve of the solutions z = (x, p) is cut by a plane across its tangent t, a distance ds from the last
point. The next point is the root of F and of the equation of the plane, regular also where dF/dx is singular:

.. math:: F(x, p) = 0, \qquad \langle t, z - z_0 \rangle = ds

The steps are those of :func:`stribeck.numerics.continuation.march`. The module knows no physics.

Source: [Keller 1977] Numerical solution of bifurcation and nonlinear eigenvalue problems.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
from scipy.linalg import lapack

from stribeck._types import Array
from stribeck.numerics.continuation import march
from stribeck.numerics.newton import Outcome, Root, relative_size, root_find

MAX_TURN = 0.7  # cosine of the largest angle between the tangents at the ends of a step
FOLD_SLOPE = 1e-11  # |dp/ds| at which a fold counts as located; its parameter is then wrong by the square
FOLD_TRIALS = 60


@dataclass(frozen=True, eq=False)
class Fold:
    """A point where the branch turns back: dp/ds = 0 and dF/dx is singular.

    Attributes
    ----------
    parameter : float
        The parameter p there.
    x : ndarray, shape (n,)
        The state there.
    index : int
        The first point of the branch past the fold.
    """

    parameter: float
    x: Array
    index: int


@dataclass(frozen=True, eq=False)
class Point:
    """A point of a branch, its unit tangent (dx/ds, dp/ds), and the fold on the step to it, if any."""

    x: Array
    parameter: float
    tangent: Array
    outcome: Outcome
    effort: int
    fold: Fold | None = None


@dataclass(frozen=True, eq=False)
class Branch:
    """A branch of solutions of F(x, p) = 0.

    Attributes
    ----------
    points : ndarray, shape (m, n)
        The states x.
    parameters : ndarray, shape (m,)
        The parameter p of each.
    tangents : ndarray, shape (m, n + 1)
        Unit tangents (dx/ds, dp/ds) in the norm of :func:`trace`.
    folds : tuple of Fold
        The folds passed, in order.
    outcome : Outcome
        CONVERGED where a bound, ``max_points`` or ``stop_when`` ended the branch; otherwise what stopped it.
    failures : int
        Steps that failed on the way and were tried again shorter.
    record : ndarray or None, shape (m, ...)
        What ``record`` returned for each point.
    """

    points: Array
    parameters: Array
    tangents: Array
    folds: tuple[Fold, ...]
    outcome: Outcome
    failures: int
    record: Array | None


def trace(
    residual: Callable[[Array, float], Array],
    jacobian: Callable[[Array, float], Array],
    parameter_derivative: Callable[[Array, float], Array],
    start: npt.ArrayLike,
    parameter: float,
    *,
    direction: int = 1,
    step: float = 0.1,
    min_step: float = 1e-6,
    max_step: float = 1.0,
    max_points: int = 200,
    bounds: tuple[float, float] = (-math.inf, math.inf),
    weight: Callable[[Array], npt.ArrayLike] | None = None,
    record: Callable[[Array, float], object] | None = None,
    stop_when: Callable[[Array, float], bool] | None = None,
    fraction: Callable[[Array, Array], float] | None = None,
    size: Callable[[Array, Array], float] = relative_size,
    tolerance: float = 1e-10,
    max_steps: int = 12,
    singular_below: float = 2.0**-52,
    on_point: Callable[[float, Point], object] | None = None,
) -> Branch:
    r"""Follow a branch of F(x, p) = 0 by its arclength s, through folds, and locate these.

    .. math:: ds^2 = \sum_i w_i(x) \, dx_i^2 + dp^2

    Parameters
    ----------
    residual, jacobian, parameter_derivative : callable
        F(x, p), shape (n,); dF/dx, shape (n, n); dF/dp, shape (n,).
    start : array_like, shape (n,)
        Guess of the state at ``parameter``.
    parameter : float
        Where the branch begins, within ``bounds``.
    direction : int, optional
        The sign of the first change of p, +1 or -1.
    step, min_step, max_step : float
        Arclength of the first, the shortest and the longest step.
    max_points : int, optional
        Number of points after which the branch ends.
    bounds : (float, float), optional
        The branch ends exactly where p meets one of these.
    weight : callable, optional
        ``weight(x)`` returns w in the arclength, > 0, one for all unknowns or shape (n,); 1/n if None, which
        makes it the mean square of x, whatever the mesh. Unknowns of different size, or whose size changes
        along the branch, count alike with 1/(n x**2).
    record : callable, optional
        ``record(x, p)`` is kept for every point.
    stop_when : callable, optional
        ``stop_when(x, p)`` ends the branch after a point for which it is true.
    fraction, size, tolerance, max_steps, singular_below : optional
        As in :func:`stribeck.newton.root_find`; ``fraction`` and ``size`` see x only. ``fraction`` also
        limits how far the prediction may leave the last point.
    on_point : callable, optional
        ``on_point(s, point)`` after each accepted point.

    Returns
    -------
    Branch
        With every point found, whatever its outcome.

    Raises
    ------
    ValueError
        If ``direction``, ``parameter`` or ``weight`` lies outside its range.

    Notes
    -----
    A step whose ends differ in direction by more than 45 degrees is tried again at half its length. A fold is
    where dp/ds changes sign; it is located by a bracketed secant on dp/ds along the step, each trial
    being corrected, so that its parameter is as exact as the residual
    (``test_arclength.py::test_the_bratu_fold_is_located_to_1e_8``). Two folds within one step cancel:
    choose ``max_step`` below their distance.
    """
    if direction not in (1, -1):
        raise ValueError(f"direction = {direction!r}; it must be 1 or -1")
    if not bounds[0] <= parameter <= bounds[1] or parameter == bounds[(1 + direction) // 2]:
        raise ValueError(f"parameter = {parameter!r}; it must lie within bounds = {bounds!r}, not at the end faced")
    x0 = np.array(start, dtype=np.float64)
    n = x0.size

    def metric(x: Array) -> Array:
        w = np.asarray(1.0 / n if weight is None else weight(x), dtype=np.float64)
        if w.shape not in ((), (n,)) or not ((w > 0.0) & (w < math.inf)).all():
            raise ValueError(f"weight(x) = {w!r}; it must be positive and finite, one number or {n} of them")
        return np.append(np.broadcast_to(w, n), 1.0)

    curve = _Curve(
        residual,
        jacobian,
        parameter_derivative,
        metric,
        fraction,
        size,
        tolerance,
        max_steps,
        singular_below,
    )
    count = 0

    def correct(s: float, history: Sequence[tuple[float, Point]]) -> Point:
        if not history:
            return curve.at(parameter, x0, np.append(np.zeros(n), direction))
        before, last = history[-1]
        return curve.step(last, s - before, bounds)

    def counted(s: float, point: Point) -> None:
        nonlocal count
        count += 1
        if on_point is not None:
            on_point(s, point)

    def at_end(point: Point) -> bool:
        asked = stop_when is not None and stop_when(point.x, point.parameter)
        return asked or count >= max_points or (count > 1 and point.parameter in bounds)

    path = march(
        correct,
        0.0,
        math.inf,
        first_step=step,
        min_step=min_step,
        max_step=max_step,
        order=0,
        stop_when=at_end,
        on_point=counted,
    )
    points = path.states
    return Branch(
        points=np.array([point.x for point in points]).reshape(-1, n),
        parameters=np.array([point.parameter for point in points]),
        tangents=np.array([point.tangent for point in points]).reshape(-1, n + 1),
        folds=tuple(replace(point.fold, index=i) for i, point in enumerate(points) if point.fold is not None),
        outcome=path.outcome,
        failures=path.failures,
        record=None if record is None else np.array([record(point.x, point.parameter) for point in points]),
    )


@dataclass(frozen=True)
class _Curve:
    """The curve F(x, p) = 0 in the space of z = (x, p), with the inner product z' diag(metric(x)) z at x."""

    residual: Callable[[Array, float], Array]
    jacobian: Callable[[Array, float], Array]
    derivative: Callable[[Array, float], Array]
    metric: Callable[[Array], Array]
    fraction: Callable[[Array, Array], float] | None
    size: Callable[[Array, Array], float]
    tolerance: float
    max_steps: int
    singular_below: float

    def at(self, p: float, x: Array, along: Array) -> Point:
        """Solve F(x, p) = 0 at fixed p from the guess x."""
        root = root_find(
            lambda x: self.residual(x, p),
            lambda x: self.jacobian(x, p),
            x,
            fraction=self.fraction,
            size=self.size,
            tolerance=self.tolerance,
            max_steps=self.max_steps,
            singular_below=self.singular_below,
        )
        return self._point(np.append(root.x, p), root, along)

    def ahead(self, point: Point, ds: float) -> Point:
        """Predict along the tangent t, z0 + ds t, and correct in the plane across it.

        The plane is (z - z0) . t = ds, so Newton solves, with dz = (dx, dp),

            [ dF/dx     dF/dp ] [ dx ]     [ F(x, p)            ]
            [ w tx'      tp   ] [ dp ] = - [ (z - z0) . t  - ds ]
        """
        z0, t = np.append(point.x, point.parameter), point.tangent
        row = self.metric(point.x) * t

        def fraction(z: Array, dz: Array) -> float:
            return 1.0 if self.fraction is None else self.fraction(z[:-1], dz[:-1])

        def size(z: Array, dz: Array) -> float:
            return max(self.size(z[:-1], dz[:-1]), relative_size(z[-1:], dz[-1:]))

        root = root_find(
            lambda z: np.append(self.residual(z[:-1], float(z[-1])), row @ (z - z0) - ds),
            lambda z: self._bordered(z, row),
            z0 + fraction(z0, ds * t) * ds * t,
            fraction=fraction,
            size=size,
            tolerance=self.tolerance,
            max_steps=self.max_steps,
            overwrite_jacobian=True,
            singular_below=self.singular_below,
        )
        return self._point(root.x, root, t)

    def step(self, last: Point, ds: float, bounds: tuple[float, float]) -> Point:
        """One step of the branch: ahead by ds, but no further than the bounds, with the fold on the way."""
        new = self.ahead(last, ds)
        if not new.outcome.ok:
            return new
        both = np.sqrt(self.metric(last.x) * self.metric(new.x))  # each tangent has length one in its own
        if (both * last.tangent) @ new.tangent < MAX_TURN:
            return replace(new, outcome=Outcome.PATH_LOST)
        inner, fold = last, None
        if last.tangent[-1] * new.tangent[-1] < 0.0 or new.tangent[-1] == 0.0:
            turn = self._turn(last, ds, new)
            if not turn.outcome.ok:
                return turn
            if bounds[0] <= turn.parameter <= bounds[1]:
                inner, fold = turn, Fold(turn.parameter, turn.x, index=-1)
            else:
                new = turn
        bound = min(max(new.parameter, bounds[0]), bounds[1])
        if bound != new.parameter:
            part = (bound - inner.parameter) / (new.parameter - inner.parameter)
            new = self.at(bound, inner.x + part * (new.x - inner.x), new.tangent)
        return replace(new, fold=fold)

    def _turn(self, last: Point, ds: float, new: Point) -> Point:
        """Find dp/ds = 0 between two points by the Illinois secant, which keeps the bracket."""
        exact = replace(self, tolerance=min(self.tolerance, 1e-12))
        d0, f0, d1, f1 = 0.0, float(last.tangent[-1]), ds, float(new.tangent[-1])
        for _ in range(FOLD_TRIALS):
            d = d1 - f1 * (d1 - d0) / (f1 - f0)
            new = exact.ahead(last, d)
            if not new.outcome.ok:
                break
            f = float(new.tangent[-1])
            if abs(f) <= FOLD_SLOPE or abs(d - d1) <= FOLD_SLOPE * ds:
                break
            d0, f0 = (d1, f1) if f * f1 < 0.0 else (d0, 0.5 * f0)
            d1, f1 = d, f
        return new

    def _point(self, z: Array, root: Root, along: Array) -> Point:
        """Make a point with the tangent t of the curve there, which keeps the sense of ``along``.

        [ dF/dx     dF/dp ] [ tx ]   [ 0 ]
        [ w ax'      ap   ] [ tp ] = [ 1 ]    then scaled to length one
        """
        outcome, tangent = root.outcome, along
        if outcome.ok:
            metric = self.metric(z[:-1])
            right = np.zeros(z.size)
            right[-1] = 1.0
            _, _, t, info = lapack.dgesv(self._bordered(z, metric * along), right, overwrite_a=True)
            if info > 0 or not np.isfinite(t).all():
                outcome = Outcome.SINGULAR
            else:
                tangent = t / math.sqrt(metric @ (t * t))
        return Point(z[:-1], float(z[-1]), tangent, outcome, root.effort)

    def _bordered(self, z: Array, row: Array) -> Array:
        matrix = np.empty((z.size, z.size), order="F")
        matrix[:-1, :-1] = self.jacobian(z[:-1], float(z[-1]))
        matrix[:-1, -1] = self.derivative(z[:-1], float(z[-1]))
        matrix[-1] = row
        return matrix
