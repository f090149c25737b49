r"""Continuation: following the solutions of F(x, p) = 0 while a coordinate or a parameter moves.

One engine, :func:`march`, chooses the steps: it knows a scalar coordinate and a function that corrects a
state there, so that states may live on meshes that change. On it stand :func:`natural`, whose coordinate is
the parameter p and which ends at a fold, and :mod:`stribeck.numerics.arclength`, which passes folds.

The module knows no physics.

Source: [Allgower & Georg 1990] Numerical Continuation Methods, chapter 6 (step length from the effort of the
corrector).
"""

import bisect
import math
from collections.abc import Callable, Collection, Iterable, Sequence
from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar

import numpy as np
import numpy.typing as npt

from stribeck._types import Array
from stribeck.numerics.newton import Outcome, Root, relative_size, root_find

FASTEST_GROWTH = 2.0  # of the step length, per step; also how much a hard step shrinks the next

FASTEST_BEYOND_TARGETS = 4.0  # the same where targets, which cut steps short, may be passed over


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
    skip: int | None = None,
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
    skip : int, optional
        Least number of targets for a step to pass over: where it reaches beyond so many it ends at the farthest target
        that it reaches, and those before are left out. None leaves out none.
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
        raise ValueError(f"targets reach from {ahead[0]!r} to {ahead[-1]!r}; they must lie in {start!r}..{stop!r}")

    points = list(history)
    failures, failure = 0, None
    length, may_grow = first_step, True

    def path(outcome: Outcome) -> Path[S]:
        return Path(tuple(s for s, _ in points), tuple(state for _, state in points), outcome, failures, failure)

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
            within = 1 if skip is None else bisect.bisect_right(ahead, length, key=lambda s: abs(s - here))
            passed = within - 1 if skip is not None and within > skip else 0
            target = ahead[passed]
            left = abs(target - here)
            step = left if left <= length else min(length, 0.5 * left)
            s = target if step == left else here + sign * step
            state = correct(s, points[-order - 1 :]) if s != here else None
            if state is None or state.outcome not in accept:
                failures, failure = failures + 1, failure if state is None else state
                length, may_grow = 0.5 * step, False
                if length < min_step:
                    return path(Outcome.PATH_LOST)
                continue
            points.append((s, state))
            if s == target:
                del ahead[: passed + 1]
            if on_point is not None:
                on_point(s, state)
            fastest = FASTEST_GROWTH if skip is None else FASTEST_BEYOND_TARGETS
            factor = min(fastest, max(1.0 / FASTEST_GROWTH, 2.0 ** (0.5 * (aim - state.effort))))
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


def natural(
    residual: Callable[[Array, float], Array],
    jacobian: Callable[[Array, float], Array],
    start: npt.ArrayLike,
    parameters: Sequence[float],
    *,
    min_step: float | None = None,
    order: int = 1,
    fraction: Callable[[Array, Array], float] | None = None,
    size: Callable[[Array, Array], float] = relative_size,
    tolerance: float = 1e-10,
    max_steps: int = 12,
    singular_below: float = 2.0**-52,
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
    fraction, size, tolerance, max_steps, singular_below : optional
        As in :func:`stribeck.newton.root_find`; ``fraction`` also limits how far the guess may leave the last
        state.
    on_point : callable, optional
        ``on_point(p, root)`` after each accepted point.

    Returns
    -------
    Path
        Its coordinates are parameters, its states :class:`stribeck.numerics.newton.Root`. Before a fold it ends as
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
            last = roots[-1].x
            dx = extrapolation_weights(coordinates, s) @ np.array([root.x for root in roots]) - last
            x = last + (1.0 if fraction is None else fraction(last, dx)) * dx
        return root_find(
            lambda x: residual(x, s),
            lambda x: jacobian(x, s),
            x,
            fraction=fraction,
            size=size,
            tolerance=tolerance,
            max_steps=max_steps,
            singular_below=singular_below,
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
