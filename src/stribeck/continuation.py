r"""Continuation: following the solutions of F(x, p) = 0 while a coordinate or a parameter moves.

One engine, :func:`march`, chooses the steps: it knows a scalar coordinate and a function that corrects a
state there, so that states may live on meshes that change. On it stand :func:`natural` (the coordinate is the
parameter p; ends at a fold) and :func:`trace` (the coordinate is Keller's pseudo-arclength; passes folds).

The module knows no physics.

Source: [Keller 1977] Numerical solution of bifurcation and nonlinear eigenvalue problems; [Allgower & Georg
1990] Numerical Continuation Methods, chapters 2 and 6 (step control by the effort of the corrector).
"""

import math
from collections.abc import Callable, Collection, Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Generic, Protocol, TypeVar

import numpy as np
import numpy.typing as npt
from scipy.linalg import lapack

from ._types import Array
from .newton import Outcome, Root, root_find

FASTEST_GROWTH = 2.0  # of the step length, per step; also how much a hard step shrinks the next
MAX_TURN = 0.7  # cosine of the largest angle between the tangents at the ends of a step
FOLD_SLOPE = 1e-11  # |dp/ds| at which a fold counts as located; its parameter is then wrong by the square
FOLD_TRIALS = 60


class State(Protocol):
    """What :func:`march` asks of a state: how its solve ended, and how many factorisations that took."""

    @property
    def outcome(self) -> Outcome: ...  # noqa: D102

    @property
    def effort(self) -> float: ...  # noqa: D102


S = TypeVar("S", bound=State)


@dataclass(frozen=True, eq=False)
class Path(Generic[S]):
    """The points that a march accepted, in its order, and how it ended.

    Attributes
    ----------
    coordinates : tuple of float
        Where the accepted states lie, every target that was reached among them exactly.
    states : tuple
        The accepted states.
    outcome : Outcome
        CONVERGED at the end asked for, PATH_LOST, INTERRUPTED, or that of the first state if this failed.
    failures : int
        Corrections that failed on the way.
    failure : state or None
        The last state that failed; where the path was lost, its outcome says why.
    """

    coordinates: tuple[float, ...]
    states: tuple[S, ...]
    outcome: Outcome
    failures: int
    failure: S | None

    def at(self, coordinate: float) -> S:
        """Return the state recorded at exactly this coordinate.

        Parameters
        ----------
        coordinate : float
            A coordinate of the path, for example a target.

        Returns
        -------
        state
            The state there.

        Raises
        ------
        ValueError
            If the path holds no point there.
        """
        try:
            return self.states[self.coordinates.index(coordinate)]
        except ValueError:
            raise ValueError(f"the path holds no point at {coordinate!r}; {self.outcome.value}") from None


def march(
    correct: Callable[[float, Sequence[tuple[float, S]]], S | None],
    start: float,
    stop: float,
    *,
    first_step: float,
    max_step: float,
    min_step: float,
    order: int = 3,
    targets: Iterable[float] | None = None,
    history: Sequence[tuple[float, S]] = (),
    accept: Collection[Outcome] = (Outcome.CONVERGED,),
    aim: int = 4,
    stop_when: Callable[[S], bool] | None = None,
    on_point: Callable[[float, S], object] | None = None,
) -> Path[S]:
    """Follow states from one coordinate to another in steps that adapt to the effort of the corrector.

    Parameters
    ----------
    correct : callable
        ``correct(s, history)`` returns the state at s, with attributes ``outcome`` and ``effort``, or None.
        It does its own prediction from ``history``, the last accepted (coordinate, state) pairs, latest
        last, empty at the start (see :func:`extrapolation_weights`).
    start, stop : float
        Ends of the path, in either direction. ``stop`` may be infinite with ``stop_when``.
    first_step, max_step, min_step : float
        Lengths of the first, the longest and the shortest step, all > 0.
    order : int, optional
        Degree of the prediction: ``history`` holds at most ``order + 1`` pairs.
    targets : iterable of float, optional
        Coordinates between the ends to be met exactly, besides the ends.
    history : sequence of (float, state), optional
        Points already known, the last of them at ``start``, which is then not solved again.
    accept : collection of Outcome, optional
        Outcomes with which a state counts as a point of the path.
    aim : int, optional
        Effort at which the step length is kept; two less doubles it, two more halves it.
    stop_when : callable, optional
        ``stop_when(state)`` ends the path after a point for which it is true.
    on_point : callable, optional
        ``on_point(s, state)`` is called after each accepted point, for progress.

    Returns
    -------
    Path
        All accepted points, also where the path was lost or the user interrupted it.

    Raises
    ------
    ValueError
        If the step lengths, the targets or the history do not fit together.

    Notes
    -----
    A step that fails is tried again at half its length, from the same point, until it is shorter than
    ``min_step``; the next step after a failure does not grow. Before a target the step is halved rather than
    leave a remnant.
    """
    if not 0 < min_step <= first_step <= max_step < math.inf:
        raise ValueError(
            f"min_step = {min_step!r}, first_step = {first_step!r}, max_step = {max_step!r}; "
            "they must be positive and in this order"
        )
    if not math.isfinite(start) or math.isnan(stop) or (math.isinf(stop) and stop_when is None):
        raise ValueError(f"start = {start!r}, stop = {stop!r}; both must be finite, or stop_when given")
    if history and history[-1][0] != start:
        raise ValueError(f"history ends at {history[-1][0]!r}; its last point must lie at start = {start!r}")
    sign = 1.0 if stop >= start else -1.0
    ahead = sorted({*map(float, targets or ()), stop} - {start}, key=lambda s: sign * s)
    if ahead and not sign * start < sign * ahead[0] <= sign * ahead[-1] <= sign * stop:
        raise ValueError(
            f"targets reach from {ahead[0]!r} to {ahead[-1]!r}; they must lie in {start!r}..{stop!r}"
        )

    points = list(history)
    failures, failure = 0, None
    length, may_grow = first_step, True

    def path(outcome: Outcome) -> Path[S]:
        return Path(
            tuple(s for s, _ in points), tuple(state for _, state in points), outcome, failures, failure
        )

    try:
        if not points:
            state = correct(start, [])
            if state is None or state.outcome not in accept:
                failures, failure = 1, state
                return path(Outcome.PATH_LOST if state is None else state.outcome)
            points.append((start, state))
            if on_point is not None:
                on_point(start, state)
        while ahead and not (stop_when is not None and stop_when(points[-1][1])):
            here = points[-1][0]
            left = abs(ahead[0] - here)
            step = left if left <= length else min(length, 0.5 * left)
            s = ahead[0] if step == left else here + sign * step
            state = correct(s, points[-order - 1 :]) if s != here else None
            if state is None or state.outcome not in accept:
                failures, failure = failures + 1, failure if state is None else state
                length, may_grow = 0.5 * step, False
                if length < min_step:
                    return path(Outcome.PATH_LOST)
                continue
            points.append((s, state))
            if s == ahead[0]:
                del ahead[0]
            if on_point is not None:
                on_point(s, state)
            factor = min(FASTEST_GROWTH, max(1.0 / FASTEST_GROWTH, 2.0 ** (0.5 * (aim - state.effort))))
            if factor < 1.0:
                length = max(min_step, factor * step)
            elif may_grow:  # a step cut short by a target does not shorten the next one
                length = min(max_step, max(length, factor * step))
            may_grow = True
    except KeyboardInterrupt:
        return path(Outcome.INTERRUPTED)
    return path(Outcome.CONVERGED)


def extrapolation_weights(coordinates: npt.ArrayLike, s: float) -> Array:
    r"""Give the weights of the polynomial through given points, evaluated at s.

    .. math:: w_i = \prod_{j \ne i} \frac{s - s_j}{s_i - s_j}, \qquad x(s) \approx \sum_i w_i \, x(s_i)

    Parameters
    ----------
    coordinates : array_like, shape (m,)
        Distinct coordinates of the points.
    s : float
        Where to evaluate.

    Returns
    -------
    ndarray, shape (m,)
        The weights; their sum is one.
    """
    c = np.asarray(coordinates, dtype=np.float64)
    others = ~np.eye(c.size, dtype=bool)
    top = np.where(others, s - c[None, :], 1.0)
    bottom = np.where(others, c[:, None] - c[None, :], 1.0)
    weights: Array = np.prod(top / bottom, axis=1)
    return weights


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
    record : ndarray or None, shape (m, ...)
        What ``record`` returned for each point.
    """

    points: Array
    parameters: Array
    tangents: Array
    folds: tuple[Fold, ...]
    outcome: Outcome
    record: Array | None


def natural(
    residual: Callable[[Array, float], Array],
    jacobian: Callable[[Array, float], Array],
    start: npt.ArrayLike,
    parameters: Sequence[float],
    *,
    min_step: float | None = None,
    order: int = 1,
    fraction: Callable[[Array, Array], float] | None = None,
    tolerance: float = 1e-10,
    max_steps: int = 12,
    on_point: Callable[[float, Root], object] | None = None,
) -> Path[Root]:
    """Solve F(x, p) = 0 for a row of parameters, each from the extrapolation of those before it.

    Parameters
    ----------
    residual, jacobian : callable
        ``residual(x, p)`` returns F, shape (n,); ``jacobian(x, p)`` returns dF/dx, shape (n, n).
    start : array_like, shape (n,)
        Guess of the state at ``parameters[0]``.
    parameters : sequence of float
        Rising or falling; between them, further points are taken where the corrector needs them.
    min_step : float, optional
        Shortest step of p; 1e-6 of the whole range if None.
    order : int, optional
        Degree of the extrapolation; 1 is the secant.
    fraction, tolerance, max_steps : optional
        As in :func:`stribeck.newton.root_find`.
    on_point : callable, optional
        ``on_point(p, root)`` after each accepted point.

    Returns
    -------
    Path
        Its coordinates are parameters, its states :class:`stribeck.newton.Root`. Before a fold it ends as
        PATH_LOST.

    Raises
    ------
    ValueError
        If fewer than two parameters are given, or they neither rise nor fall.
    """
    p = [float(value) for value in parameters]
    if len(p) < 2 or p not in (sorted(set(p)), sorted(set(p), reverse=True)):
        raise ValueError(f"parameters = {parameters!r}; they must be two or more and rise or fall strictly")
    guess = np.array(start, dtype=np.float64)
    whole = abs(p[-1] - p[0])

    def correct(s: float, history: Sequence[tuple[float, Root]]) -> Root:
        x = guess
        if history:
            coordinates, roots = zip(*history, strict=True)
            x = extrapolation_weights(coordinates, s) @ np.array([root.x for root in roots])
        return root_find(
            lambda x: residual(x, s),
            lambda x: jacobian(x, s),
            x,
            fraction=fraction,
            tolerance=tolerance,
            max_steps=max_steps,
        )

    return march(
        correct,
        p[0],
        p[-1],
        first_step=abs(p[1] - p[0]),
        max_step=whole,
        order=order,
        targets=p,
        min_step=min(1e-6 * whole if min_step is None else min_step, abs(p[1] - p[0])),
        on_point=on_point,
    )


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
    weight: float | None = None,
    record: Callable[[Array, float], object] | None = None,
    stop_when: Callable[[Array, float], bool] | None = None,
    fraction: Callable[[Array, Array], float] | None = None,
    tolerance: float = 1e-10,
    max_steps: int = 12,
    on_point: Callable[[float, Point], object] | None = None,
) -> Branch:
    r"""Follow a branch of F(x, p) = 0 by its arclength s, through folds, and locate these.

    .. math:: ds^2 = w \, |dx|^2 + dp^2

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
    weight : float, optional
        w in the arclength; 1/n if None, which makes it the mean square of x, whatever the mesh.
    record : callable, optional
        ``record(x, p)`` is kept for every point.
    stop_when : callable, optional
        ``stop_when(x, p)`` ends the branch after a point for which it is true.
    fraction, tolerance, max_steps : optional
        As in :func:`stribeck.newton.root_find`; ``fraction`` sees x only.
    on_point : callable, optional
        ``on_point(s, point)`` after each accepted point.

    Returns
    -------
    Branch
        With every point found, whatever its outcome.

    Raises
    ------
    ValueError
        If ``direction`` or ``parameter`` lies outside its range.

    Notes
    -----
    A step whose ends differ in direction by more than 45 degrees is tried again at half its length. A fold is
    where dp/ds changes sign; it is located by a bracketed secant on dp/ds along the step, each trial
    being corrected, so that its parameter is as exact as the residual
    (``test_continuation.py::test_the_bratu_fold_is_located_to_1e_8``). Two folds within one step cancel:
    choose ``max_step`` below their distance.

    Source: [Keller 1977] sections 4 and 5.
    """
    if direction not in (1, -1):
        raise ValueError(f"direction = {direction!r}; it must be 1 or -1")
    if not bounds[0] <= parameter <= bounds[1] or parameter == bounds[(1 + direction) // 2]:
        raise ValueError(
            f"parameter = {parameter!r}; it must lie within bounds = {bounds!r}, not at the end faced"
        )
    x0 = np.array(start, dtype=np.float64)
    n = x0.size
    metric = np.append(np.full(n, 1.0 / n if weight is None else weight), 1.0)
    curve = _Curve(residual, jacobian, parameter_derivative, metric, fraction, tolerance, max_steps)
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
        record=None if record is None else np.array([record(point.x, point.parameter) for point in points]),
    )


@dataclass(frozen=True)
class _Curve:
    """The curve F(x, p) = 0 in the space of z = (x, p), with the inner product z' diag(metric) z."""

    residual: Callable[[Array, float], Array]
    jacobian: Callable[[Array, float], Array]
    derivative: Callable[[Array, float], Array]
    metric: Array
    fraction: Callable[[Array, Array], float] | None
    tolerance: float
    max_steps: int

    def at(self, p: float, x: Array, along: Array) -> Point:
        """Solve F(x, p) = 0 at fixed p from the guess x."""
        root = root_find(
            lambda x: self.residual(x, p),
            lambda x: self.jacobian(x, p),
            x,
            fraction=self.fraction,
            tolerance=self.tolerance,
            max_steps=self.max_steps,
        )
        return self._point(np.append(root.x, p), root, along)

    def ahead(self, point: Point, ds: float) -> Point:
        """Predict along the tangent t, z0 + ds t, and correct in the plane across it.

        The plane is (z - z0) . t = ds, so Newton solves, with dz = (dx, dp),

            [ dF/dx     dF/dp ] [ dx ]     [ F(x, p)            ]
            [ w tx'      tp   ] [ dp ] = - [ (z - z0) . t  - ds ]
        """
        z0, t = np.append(point.x, point.parameter), point.tangent
        row = self.metric * t
        fraction = self.fraction
        root = root_find(
            lambda z: np.append(self.residual(z[:-1], float(z[-1])), row @ (z - z0) - ds),
            lambda z: self._bordered(z, row),
            z0 + ds * t,
            fraction=None if fraction is None else lambda z, dz: fraction(z[:-1], dz[:-1]),
            tolerance=self.tolerance,
            max_steps=self.max_steps,
            overwrite_jacobian=True,
        )
        return self._point(root.x, root, t)

    def step(self, last: Point, ds: float, bounds: tuple[float, float]) -> Point:
        """One step of the branch: ahead by ds, but no further than the bounds, with the fold on the way."""
        new = self.ahead(last, ds)
        if not new.outcome.ok:
            return new
        if (self.metric * last.tangent) @ new.tangent < MAX_TURN:
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
            right = np.zeros(z.size)
            right[-1] = 1.0
            _, _, t, info = lapack.dgesv(self._bordered(z, self.metric * along), right, overwrite_a=True)
            if info > 0 or not np.isfinite(t).all():
                outcome = Outcome.SINGULAR
            else:
                tangent = t / math.sqrt(self.metric @ (t * t))
        return Point(z[:-1], float(z[-1]), tangent, outcome, root.effort)

    def _bordered(self, z: Array, row: Array) -> Array:
        matrix = np.empty((z.size, z.size), order="F")
        matrix[:-1, :-1] = self.jacobian(z[:-1], float(z[-1]))
        matrix[:-1, -1] = self.derivative(z[:-1], float(z[-1]))
        matrix[-1] = row
        return matrix
