"""The contributions to the friction of many states, with derivatives, for fits: off the atlas, solved, or interpolated.

The load share and the observables of the viscous friction come without boundary_friction and beta, which may differ from
state to state: :mod:`stribeck.contacts.friction_rules` puts them together.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from stribeck import atlas
from stribeck._types import Array, Indices
from stribeck.atlas.tables import table_for
from stribeck.batches.chain import CHAIN_STEPS
from stribeck.batches.kept import KeptStates
from stribeck.batches.lattice import PARTS, STEPS, Lattice
from stribeck.contacts.friction import Definition
from stribeck.contacts.friction_rules import RULES
from stribeck.contacts.groups import Groups, Physics
from stribeck.contacts.model import ARTICLE, Model
from stribeck.equations.observables import ROW
from stribeck.equations.sensitivity import log_derivatives
from stribeck.numerics.continuation import march
from stribeck.numerics.scattered import Scattered
from stribeck.numerics.threads import one_blas_thread
from stribeck.quantities.outcome import Outcome
from stribeck.quantities.outputs import NAMES
from stribeck.quantities.units import InputError
from stribeck.solver.corrector import Corrector
from stribeck.solver.nearby import WarmStartSolver
from stribeck.solver.point.sensitivity import GROUPS
from stribeck.solver.solve import SolveError, minimum_estimate

if TYPE_CHECKING:
    from stribeck.fits.model import FrictionModel

__all__ = [
    "Between",
    "FrictionParts",
    "ModelChange",
    "PartsOf",
    "Ways",
    "atlas_parts",
    "atlas_or",
    "in_atlas",
    "solved_parts",
    "ways_of",
]


MOST_KEPT = 60
"""Rows up to which each state is solved from one before, with a mesh of its own in memory; more are solved as a curve."""

NEAR = 0.3
"""Largest change of a logarithm over which a single state is solved from another, if one more can be kept."""

LATTICE_RTOL, BALL_RTOL = 3e-4, 1e-4
"""Tolerances of solved balls in the search, and the smallest in the values that a fit returns: far below what rigs resolve."""

KEPT_RTOL = 1e-4
"""Smallest tolerance of solved balls with other fluids and bodies."""

LATTICE_ERROR = 3e-3
"""Largest relative error of the parts read off a lattice of balls; 2e-3 was found in the middle of a cell."""

FINE_STEPS = (0.3, 1.0, 1.0)
"""Steps of solved curves of balls: of ln(speed), and none that count of ln(load) and ln(relative roughness)."""

FAR_DOUBT = 1e-2
"""Doubt up to which curves are read between solved ones, see :mod:`stribeck.numerics.scattered`."""

CLOSE = 0.01
"""Logarithm of a load or a roughness up to which a solved curve of a ball serves, to first order."""


@dataclass(frozen=True)
class FrictionParts:
    """The contributions to the friction of n states, and their derivatives.

    Parameters
    ----------
    values : ndarray, shape (1 + parts, n)
        Contact load share, and the observables that the rule of the geometry names [-].
    slopes : ndarray, shape (1 + parts, 3 + changes, n)
        Derivatives of each by the logarithms of the groups of speed, load and roughness, and along changes of the model [-].
    errors : ndarray, shape (1 + parts, n)
        Estimated absolute error of the contact load share, and errors of the others as a solution states them.
    definition : {"balanced", "published"}
        Definition of the viscous friction.
    """

    values: Array
    slopes: Array
    errors: Array
    definition: Definition


class ModelChange(NamedTuple):
    """What a free input changes of the model, in Hertz units.

    Attributes
    ----------
    input : int
        Number of the input.
    below, above : Model
        The model at two values of its logarithm.
    width : float
        Their distance.
    """

    input: int
    below: Model
    above: Model
    width: float


PartsOf = Callable[[Groups, Sequence[ModelChange]], FrictionParts]
"""What gives the parts of the friction of states in a row, with their derivatives along changes of the model."""


OnState = Callable[[int], object]


def atlas_parts(definition: Definition) -> PartsOf:
    """Return the function that reads states off the atlas; it raises InputError outside."""

    def parts(groups: Groups, changes: Sequence[ModelChange]) -> FrictionParts:
        values, slopes = atlas.friction_parts(groups, definition)
        error = np.full(values.shape, table_for(groups).error)
        return FrictionParts(values, slopes, error, definition)

    return parts


def solved_parts(definition: Definition, rtol: float) -> PartsOf:
    """Return the function that solves states, those that differ in speed alone as one curve.

    Parameters
    ----------
    definition : {"balanced", "published"}
        Definition of the viscous friction.
    rtol : float
        Relative tolerance of each state.

    Returns
    -------
    callable
        Groups of many states -> their :class:`FrictionParts`; raises SolveError where a state cannot be solved.
    """

    def parts(groups: Groups, changes: Sequence[ModelChange]) -> FrictionParts:
        speed, load, roughness = (np.broadcast_to(g, groups.shape) for g in (groups.speed, groups.load, groups.roughness))
        n = groups.shape[0]
        values, slopes, errors = np.empty((2, n)), np.empty((2, 3 + len(changes), n)), np.empty((2, n))
        pairs, pair_of = np.unique(np.stack([load, roughness], axis=1), axis=0, return_inverse=True)
        for k, (F, h_rms) in enumerate(pairs):
            rows = np.nonzero(pair_of.ravel() == k)[0]
            speeds, at = np.unique(speed[rows], return_inverse=True)
            found = _along(speeds, float(F), float(h_rms), definition, rtol, groups.physics, changes)
            values[:, rows], slopes[:, :, rows], errors[:, rows] = (array[..., at.ravel()] for array in found)
        return FrictionParts(values, slopes, errors, definition)

    return parts


def kept_parts(definition: Definition, rtol: float) -> PartsOf:
    """Return the function that solves states each from the nearest one of those before, for searches that come near again.

    Parameters
    ----------
    definition : {"balanced", "published"}
        Definition of the viscous friction.
    rtol : float
        Relative tolerance of each state.

    Returns
    -------
    callable
        Groups of many states -> their :class:`FrictionParts`; raises SolveError where a state cannot be solved.
    """
    pools: dict[Any, list[_Kept]] = {}
    along, row = solved_parts(definition, rtol), NAMES.index(f"viscous_{definition}")

    @one_blas_thread
    def parts(groups: Groups, changes: Sequence[ModelChange]) -> FrictionParts:
        if groups.shape[0] > MOST_KEPT:
            return along(groups, changes)
        states = np.stack(np.broadcast_arrays(groups.speed, groups.load, groups.roughness), axis=1)
        n, model, places = len(states), groups.model, np.log(np.maximum(states, 1e-300))
        values, slopes, errors = np.empty((2, n)), np.empty((2, 3 + len(changes), n)), np.empty((2, n))
        pool = pools.setdefault((model.film.name, model.cavitation, model.solid.name), [])
        unused = list(pool)
        for i in np.argsort(-places[:, 0]).tolist():
            kept = min(unused, key=lambda each: each.distance(places[i]), default=None)
            if kept is not None and (n > 1 or len(pool) > MOST_KEPT or kept.distance(places[i]) < NEAR):
                unused.remove(kept)
            else:
                near = min(pool, key=lambda each: each.distance(places[i]), default=None)
                kept = _Kept(places[i], near.solver.beside() if near else WarmStartSolver(rtol))
                pool.append(kept)
            kept.place = places[i]
            solution = kept.solver(Groups(*states[i].tolist(), **groups.physics))
            found = solution.observables.array()
            values[:, i], errors[:, i] = found[[0, row]], solution.relative_errors[[0, row]]
            derivatives = log_derivatives(kept.solver.state, [each[1:] for each in changes])
            slopes[:, :, i] = derivatives["contact_load_share"], derivatives[f"viscous_{definition}"]
        return FrictionParts(values, slopes, errors, definition)

    return parts


@dataclass(eq=False)
class _Kept:
    """A solver, and the logarithms of the groups that it last solved."""

    place: Array
    solver: WarmStartSolver

    def distance(self, place: Array) -> float:
        """Return the largest change of a logarithm from there to another place."""
        return float(np.abs(self.place - place).max())


def atlas_or(slow: PartsOf, definition: Definition) -> PartsOf:
    """Return the function that reads the states off the atlas where it holds all of them, and else takes the ``slow`` way."""
    quick = atlas_parts(definition)

    def parts(groups: Groups, changes: Sequence[ModelChange]) -> FrictionParts:
        try:
            return quick(groups, changes)
        except InputError:
            return slow(groups, changes)

    return parts


def _along(
    speeds: Array,
    load: float,
    roughness: float,
    definition: Definition,
    rtol: float,
    physics: Physics,
    changes: Sequence[ModelChange],
) -> tuple[Array, Array, Array]:
    """Return values, slopes and errors of states at ascending speeds, each solved from those before it."""

    def groups_at(s: float) -> Groups:
        return Groups(math.exp(s), load, roughness, **physics)

    places, n = np.log(speeds).tolist(), len(speeds)
    chain = march(Corrector(groups_at, rtol), places[-1], places[0], CHAIN_STEPS, targets=places)
    if chain.outcome is Outcome.INTERRUPTED:
        raise KeyboardInterrupt
    if not chain.outcome.ok:
        raise SolveError(chain.outcome, None, f"load {load:.6g}, roughness {roughness:.6g}: {chain.outcome.value}")
    columns = [ROW["contact_load_share"], ROW[f"viscous_{definition}"]]
    values, slopes, errors = np.empty((2, n)), np.empty((2, 3 + len(changes), n)), np.empty((2, n))
    for i, s in enumerate(places):
        point = chain.at(s)
        assert point.state is not None and point.values is not None and point.estimate is not None
        derivatives = log_derivatives(point.state, [each[1:] for each in changes])
        values[:, i] = point.values.array(in_article=False)[columns]
        slopes[:, :, i] = derivatives["contact_load_share"], derivatives[f"viscous_{definition}"]
        errors[:, i] = np.maximum(point.estimate.relative[columns], minimum_estimate(rtol, point.groups.model))
    return values, slopes, errors


@dataclass(eq=False)
class Between:
    """Reads curves between the inputs at which they were solved, and solves them where that leaves doubt.

    Parameters
    ----------
    solve : callable
        What solves the states.
    doubt : float
        Largest doubt with which a curve is read; at 0 all are solved.
    known : dict
        What was solved of each curve; may be shared.
    """

    solve: PartsOf
    doubt: float
    known: dict[int, tuple[Scattered, list[FrictionParts]]] = field(default_factory=dict)

    def at(self, curve: int, place: Array, solved: Callable[[], FrictionParts], moving: Indices) -> FrictionParts:
        """Return the parts of one curve.

        Parameters
        ----------
        curve : int
            Number of the curve.
        place : ndarray, shape (m,)
            The inputs that move its states.
        solved : callable
            Solves the curve there; its slopes are along all free inputs.
        moving : ndarray of int, shape (m,)
            Rows of those inputs in the slopes.

        Returns
        -------
        FrictionParts
            With the slopes along the free inputs.
        """
        doubt = self.known[curve][0].doubt(place) if curve in self.known else math.inf
        if doubt > self.doubt:
            here = solved()
            scattered, all_solved = self.known.setdefault(curve, (Scattered(_lengths(here, moving)), []))
            scattered.add(place, here.values.ravel(), _rows(here, moving))
            all_solved.append(here)
            return here
        scattered, all_solved = self.known[curve]
        near = all_solved[scattered.nearest(place)]
        values, by = scattered.at(place)
        slopes = np.zeros_like(near.slopes)
        slopes[:, moving] = by.reshape(len(moving), *near.values.shape).swapaxes(0, 1)
        return FrictionParts(values.reshape(near.values.shape), slopes, near.errors + doubt, near.definition)


def _rows(parts: FrictionParts, moving: Indices) -> Array:
    """Return the slopes along moving inputs, shape (m, parts * rows)."""
    return np.asarray(parts.slopes[:, moving].swapaxes(0, 1).reshape(len(moving), parts.values.size))


def _lengths(parts: FrictionParts, moving: Indices) -> Array:
    """Return how far the logarithms of inputs move until a state changes by its own size, at most one."""
    size = np.ones_like(parts.values)
    size[1:] = np.abs(parts.values[1:]).max(axis=0)
    largest = (np.abs(parts.slopes[:, moving]) / size[:, None]).max(axis=(0, 2), initial=0.0)
    return np.asarray(1.0 / np.maximum(1.0, largest))


class Ways(NamedTuple):
    """How the states of a fit are obtained.

    Attributes
    ----------
    quick, solved : callable or Between
        For the search, and for the values that the fit returns.
    """

    quick: PartsOf | Between
    solved: PartsOf | Between


def between(solve: PartsOf) -> Ways:
    """Return how to search on curves that are read between solved ones, and end on solved ones."""
    quick = Between(solve, FAR_DOUBT)
    return Ways(quick, replace(quick, doubt=0.0))


def ways_of(model: FrictionModel, definition: Definition, rtol: float, on_state: OnState) -> Ways:
    """Return how the states of a fit are obtained: from atlas and solver, or for a ball from a lattice of solved states.

    Parameters
    ----------
    model : FrictionModel
        What is fitted.
    definition : {"balanced", "published"}
        Definition of the viscous friction.
    rtol : float
        Relative tolerance of solved states.
    on_state : callable
        Called with the number of states so far after each one that takes long to solve.

    Returns
    -------
    Ways
        The functions.
    """
    return WAYS[model.contact.groups.geometry](model, definition, rtol, on_state)


def in_atlas(model: FrictionModel) -> bool:
    """Return whether a table holds for all contacts of a fit, wherever in its box their states lie."""
    kinds = {each.groups.model for each in model.contacts}
    return len(kinds) == 1 and not any(model.moving) and atlas.for_groups(model.contact.groups) is not None


def _of_cylinder(model: FrictionModel, definition: Definition, rtol: float, on_state: OnState) -> Ways:
    if in_atlas(model):
        solved = solved_parts(definition, rtol)
        return Ways(atlas_or(solved, definition), solved)
    return between(kept_parts(definition, rtol))


def _of_ball(model: FrictionModel, definition: Definition, rtol: float, on_state: OnState) -> Ways:
    if any(each.groups.model != ARTICLE for each in model.contacts):  # lattices know one model
        kept = kept_balls(model, definition, max(rtol, KEPT_RTOL), on_state)
        if in_atlas(model):
            return Ways(atlas_or(kept, definition), kept)
        return between(kept)
    logs, varies = model.start()
    lattice, solved = lattice_parts(logs, varies, definition), curve_parts(definition, max(rtol, BALL_RTOL))
    return Ways(atlas_or(lattice, definition) if in_atlas(model) else lattice, solved)


def kept_balls(model: FrictionModel, definition: Definition, rtol: float, on_state: OnState = lambda n: None) -> PartsOf:
    """Return the function that solves balls with other fluids and bodies, each from the nearest state of those before.

    A fluid that thins far out counts up to the edge of the liquid of the contact as the fit begins.
    """
    states, count = KeptStates(rtol), itertools.count(1)
    others = model.rule.of_contact(model.contact)
    by = [name for name, moves in zip(GROUPS, np.abs(model.exponents[:, :, :3]).max(axis=(0, 1)) > 0, strict=True) if moves]

    def parts(groups: Groups, changes: Sequence[ModelChange]) -> FrictionParts:
        rows = np.stack(np.broadcast_arrays(groups.speed, groups.load, groups.roughness), axis=1)
        n, names = len(rows), [0, *(PARTS.index(name) for name in model.rule.parts(definition))]
        values, slopes, errors = np.empty((4, n)), np.empty((4, 3 + len(changes), n)), np.empty((4, n))
        ends = {str(change.input): change[1:] for change in changes}
        for i in np.lexsort((-rows[:, 0], rows[:, 2], rows[:, 1])).tolist():
            here = Groups(*rows[i].tolist(), **groups.physics)
            slope = float(here.slope(others["beta"]))
            values[:, i], slopes[:, :, i], errors[:, i] = states.at(here, ends, slope, others["wetted_radius"], by)
            on_state(next(count))
        return FrictionParts(values[names], slopes[names], errors[names], definition)

    return one_blas_thread(parts)


WAYS: dict[str, Callable[[FrictionModel, Definition, float, OnState], Ways]] = {"line": _of_cylinder, "point": _of_ball}
"""The ways by geometry."""


def lattice_parts(starts: Array, varies: Array, definition: Definition) -> PartsOf:
    """Return the function that reads states of balls off lattices of solved states, made where they are asked for.

    Parameters
    ----------
    starts : ndarray, shape (m, 3)
        ln of speed, load and relative roughness of a state of each curve.
    varies : ndarray of bool, shape (3,)
        Which of these the fit changes.  A start is in the middle of a cell along those, on a node along the others.
    definition : {"balanced", "published"}
        Definition of the viscous friction.

    Returns
    -------
    callable
        Groups of many states -> their :class:`FrictionParts`; raises SolveError where a state cannot be solved.
    """
    lattices: list[Lattice] = []

    def parts(groups: Groups, changes: Sequence[ModelChange]) -> FrictionParts:
        logs = _coordinates(groups)
        is_smooth = not np.any(groups.roughness)
        if not lattices:
            for start in starts:
                anchor = tuple(start + 0.5 * np.array(STEPS) * varies)
                if not any(np.allclose(anchor[1:], each.anchor[1:], rtol=0, atol=1e-9) for each in lattices):
                    lattices.append(Lattice(anchor, groups.physics, LATTICE_RTOL, is_smooth))
        away = np.array([np.abs((logs - each.anchor) / each.steps)[:, 1:].max(axis=1) for each in lattices])
        values, slopes = np.empty((4, len(logs))), np.empty((4, 3, len(logs)))
        for k in np.unique(nearest := np.argmin(away, axis=0)):
            rows = nearest == k
            values[:, rows], slopes[:, :, rows] = lattices[k].at(logs[rows])
        return _of_values(values, slopes, LATTICE_ERROR, groups, definition)

    return parts


def curve_parts(definition: Definition, rtol: float) -> PartsOf:
    """Return the function that solves curves of balls at the loads and roughnesses asked for.

    Between solved speeds a curve is interpolated with its derivatives; loads and roughnesses within a hundredth of a curve are
    reached from there to first order.

    Parameters
    ----------
    definition : {"balanced", "published"}
        Definition of the viscous friction.
    rtol : float
        Relative tolerance of each state.

    Returns
    -------
    callable
        Groups of many states -> their :class:`FrictionParts`; raises SolveError where a state cannot be solved.
    """
    curves: list[Lattice] = []

    def parts(groups: Groups, changes: Sequence[ModelChange]) -> FrictionParts:
        logs = _coordinates(groups)
        values, slopes = np.empty((4, len(logs))), np.empty((4, 3, len(logs)))
        pairs, of_row = np.unique(logs[:, 1:], axis=0, return_inverse=True)
        for k, pair in enumerate(pairs):
            rows = np.nonzero(of_row.ravel() == k)[0]
            near = [each for each in curves if np.abs(pair - each.anchor[1:]).max() < CLOSE]
            if not near:
                anchor = (float(logs[rows[0], 0]), float(pair[0]), float(pair[1]))
                near = [Lattice(anchor, groups.physics, rtol, not np.any(groups.roughness), FINE_STEPS)]
                curves.append(near[0])
            on_curve = np.column_stack([logs[rows, 0], np.tile(near[0].anchor[1:], (len(rows), 1))])
            found, by = near[0].at(on_curve)
            offset = pair - near[0].anchor[1:]
            values[:, rows] = found + np.einsum("pdn,d->pn", by[:, 1:], offset)
            slopes[:, :, rows] = by
        return _of_values(values, slopes, rtol, groups, definition)

    return parts


def _coordinates(groups: Groups) -> Array:
    """Return ln of speed, load and relative roughness, zero for the last of smooth surfaces, shape (n, 3)."""
    kappa = np.asarray(groups.relative_roughness, dtype=float)
    kappa = np.where(kappa > 0, kappa, 1.0)
    return np.asarray(np.log(np.stack(np.broadcast_arrays(groups.speed, groups.load, kappa), axis=1)))


def _of_values(values: Array, slopes: Array, error: float, groups: Groups, definition: Definition) -> FrictionParts:
    """Return the parts by those of a lattice, whose derivatives are at fixed relative roughness."""
    rows = [0, *(PARTS.index(name) for name in RULES[groups.geometry].parts(definition))]
    by = slopes[rows].copy()
    by[:, 1] -= groups.scaling.roughness_exponent * by[:, 2]
    errors = np.full((len(rows), values.shape[1]), error)
    errors[0] *= values[0]  # interpolated are its log odds
    return FrictionParts(values[rows], by, errors, definition)
