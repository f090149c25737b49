"""States of the line along a path whose film and law are formulas: solved from a prediction, verified, and expanded.

The unknowns of a series are those of the equations, with the logarithm of the gap.  The residual is evaluated on jets, see
:mod:`stribeck.numerics.series`; a contact law is a polynomial around each separation.  One factorisation serves all orders,
and the observables are jets of the same unknowns.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from stribeck._types import Array, Numbers
from stribeck.contact_laws.exponential import ExponentialLaw
from stribeck.contact_laws.law import is_exponential
from stribeck.contact_laws.scaled import ContinuedLaw, ScaledLaw, misfit
from stribeck.contacts.groups import Groups, Model, contact_law
from stribeck.equations.enriched import FineOperators
from stribeck.equations.gap import gap_beside, minimum_gaps
from stribeck.equations.line import Equations, Fields
from stribeck.equations.observables import ROW, measured
from stribeck.equations.state import State
from stribeck.fluids.fluid import Cavitation
from stribeck.fluids.newtonian import Newtonian
from stribeck.fluids.rheology.viscosity import Barus, Constant, DowsonHigginson, Incompressible, Roelands
from stribeck.numerics.hermite import hermite_weights, missed_by
from stribeck.numerics.newton import Inverse, Root
from stribeck.numerics.panels import interpolation_error
from stribeck.numerics.series import Jet, Tape, beyond, implicit_series, radius
from stribeck.numerics.settings import COEFFICIENT_NOISE, MAX_DEGREE, NEGLIGIBLE, SAFETY
from stribeck.numerics.threads import one_blas_thread
from stribeck.quantities.outcome import Outcome
from stribeck.quantities.outputs import ALL_NAMES, NAMES
from stribeck.solver.at_rest import shift_along, with_positive_gap
from stribeck.solver.path.line_knots import POSITION, LineKnots, LineStates, numbers_of
from stribeck.solver.path.line_steps import LineSteps
from stribeck.solver.path.path import Expansion, SolvedPath, change_ratio
from stribeck.solver.refinement import RefinedState

Direction = tuple[float, float, float]  # Derivatives of ln(speed), ln(load), ln(roughness) along a curve


class Expanded(NamedTuple):
    """Taylor coefficients about a state, order by order in the first axis."""

    unknowns: Array  # Coefficients of the unknowns, with the logarithm of the gap
    observables: Array
    logs: Array  # Of logarithms of observables; nan where there are none


def from_logs(equations: Equations, w: Array) -> Array:
    """Return the unknowns from a row that holds the logarithm of the gap."""
    found = w.copy()
    with np.errstate(over="ignore"):  # a prediction out of bounds shows in its gap
        found[..., equations.layout.gap] = np.exp(w[..., equations.layout.gap])
    return found


class _Known(NamedTuple):
    """A contact law by its pressure at the gaps where it is asked for."""

    values: Any

    def pressure(self, gap: Any) -> Any:
        """Return the contact pressure."""
        return self.values


def expand(
    equations: Equations, y: Array, inverse: Inverse, groups: Groups, direction: Direction, shifts: Array, order: int
) -> Expanded:
    """Return the series of a state and of its observables; at rest ``shifts`` is the series of the shift of its gap."""
    at, law = equations.layout, contact_law(groups)
    w, units = np.zeros((order + 1, at.size)), equations.units(y)
    w[0], units[at.gap] = y, 1.0
    w[0, at.gap] = np.log(y[at.gap])
    if isinstance(law, ScaledLaw):
        near: Any = ContinuedLaw.of(law.shape, y[at.gap] / law.decay_length)
        law = replace(law, shape=near)
    tape = Tape(order)
    here, load = _along(equations, law, groups, direction, tape)
    u = Fields(*(None if part is None else tape.given(part) for part in equations.fields(w)))
    u = u._replace(gap=np.exp(u.gap))
    known: Any = _Known(here.contact(u.gap))
    here = replace(here, law=known)
    _write_series(w, tape, here, u, lambda r: units * inverse(r))
    values, logs = np.full((2, order + 1, len(ALL_NAMES)), np.nan)
    found = _observed(here, u, load, None if equations.is_sliding else tape.given(shifts[:, None]))
    for name, value in found.items():
        values[:, ROW[name]] = value.coefficients[:, 0] if isinstance(value, Jet) else 0.0  # without a film there is no drag
    share = found["contact_load_share"]
    if share.value > 0:
        logs[:, ROW["contact_load_share"]] = np.log(share).coefficients[:, 0]
    tape.made.clear()  # a jet holds its tape: both would wait for the collector
    return Expanded(w, values, logs)


def _write_series(w: Array, tape: Tape, equations: Equations, u: Fields, inverse: Callable[[Array], Array]) -> None:
    """Write the series of the unknowns, whose jets are ``u``."""
    at, rows = equations.layout, equations.rows(u)
    blocks = [(getattr(at, name), row) for name, row in zip(Fields._fields, rows, strict=True) if row is not None]
    tape.keep(row for _, row in blocks)
    found = np.empty(at.size)

    def coefficient(k: int) -> Array:
        tape.fill(k)
        for block, row in blocks:
            found[block] = row.coefficients[k]
        return found

    implicit_series(w, coefficient, inverse)
    tape.settle()
    tape.made.clear()  # what is made of these jets from now on has its coefficients at once


def _observed(equations: Equations, u: Fields, load: Any, shift: Jet | None) -> dict[str, Any]:
    """Return the jets of the observables but for the minimum gap, whose place moves; at rest all gaps have a shift."""
    found = measured(equations, u, load)
    found["central_gap"] = gap_beside(equations.operators.mesh, u.gap, 0.0)[0]
    if shift is None:
        return found
    found |= {name: found[name] + shift for name in ("central_gap", "offset")}
    found["minimum_gap"] = found["central_gap"]
    gap, weights = u.gap + shift, equations.operators.mesh.weights
    if np.all(gap.value > 0):
        found["flux_gap"] = (gap**-2.0 @ weights) / (gap**-3.0 @ weights)
    else:
        del found["flux_gap"]
    return found


def _along(equations: Equations, law: Any, groups: Groups, direction: Direction, tape: Tape) -> tuple[Equations, Any]:
    """Return the equations along a path, and the load."""

    def moved(value: Numbers, rate: float) -> Any:
        return value * tape.growth(rate) if rate else value

    by_speed, by_load, by_roughness = direction
    load = moved(groups.load, by_load)
    if isinstance(law, ExponentialLaw | ScaledLaw):
        rate = by_roughness - groups.scaling.roughness_exponent * by_load
        law = replace(law, load=load, decay_length=moved(groups.relative_roughness, rate))
    return replace(equations, speed=moved(groups.speed, by_speed), law=law), load


class LinePoint(NamedTuple):
    """A solved state, the coefficients of its unknowns, and the operators of its mesh."""

    refined: RefinedState
    state: State
    unknowns: Array
    fine: FineOperators


def minimum_between(left: Expansion, right: Expansion, of: LinePoint, parts: Array) -> tuple[Array, Array]:
    """Return minimum gap and position between two expansions on the mesh of one, and the error of the gap."""
    order, mesh, ends = min(left.order, right.order), of.state.mesh, (left, right)
    weights, scaled = hermite_weights(order, parts), _scaled(left, right, order)
    a, b = (_gaps_on(end.point, each, of)[:, : -mesh.order] for end, each in zip(ends, scaled, strict=True))
    with np.errstate(over="ignore"):  # a gap beyond all numbers is no minimum: its interval is halved
        place, lowest, error, panel = minimum_gaps(mesh, weights[0] @ a + weights[1] @ b)
    on_panels = missed_by(order, np.vstack([a, b]), change_ratio(left, right)).reshape(-1, mesh.order).max(axis=1)
    error = error + on_panels[panel] * (parts * (1 - parts)) ** order
    for end, each, w in zip(ends, scaled, weights, strict=True):
        if end.point.state.mesh is not mesh:  # values from another mesh were interpolated
            error = error + 2 * _unresolved(end.point, each, w, place)
    return np.stack([lowest, place]), error


def _unresolved(point: LinePoint, coefficients: Array, weights: Array, places: Array) -> Array:
    """Return the interpolation error of logarithms of gaps at places on the mesh of a point."""
    mesh = point.state.mesh
    shapes = coefficients[:, point.state.equations.layout.gap].copy()
    shapes[0] -= np.log(mesh.far)
    own = shapes.reshape(len(shapes), mesh.panels, mesh.order)[:, mesh.locate(places)[0]]
    return interpolation_error(np.einsum("rj,jrn->rn", weights, own))


def between(left: Expansion, right: Expansion, of: LinePoint, parts: Array) -> Array:
    """Return the unknowns between two expansions on the mesh of one of them, with the logarithms of gaps."""
    order = min(left.order, right.order)
    a, b = (_on_mesh(end.point, each, of) for end, each in zip((left, right), _scaled(left, right, order), strict=True))
    of_left, of_right = hermite_weights(order, parts)
    return np.asarray(of_left @ a + of_right @ b)


def _scaled(left: Expansion, right: Expansion, order: int) -> list[Array]:
    """Return the coefficients of the unknowns at both ends, scaled to an interval of length one."""
    scale = (right.coordinate - left.coordinate) ** np.arange(order + 1.0)[:, None]
    return [end.point.unknowns[: order + 1] * scale for end in (left, right)]


def _on_mesh(point: LinePoint, coefficients: Array, of: LinePoint) -> Array:
    """Return coefficients of the unknowns of a point on the mesh of another."""
    mesh, other = point.state.mesh, of.state.mesh
    if mesh is other:
        return coefficients
    at, there = point.state.equations.layout, of.state.equations.layout
    found = np.empty((len(coefficients), there.size))
    found[:, there.numbers] = coefficients[:, at.numbers]
    found[:, there.gap] = _gaps_on(point, coefficients, of)
    if there.pressure.stop > there.pressure.start:
        found[:, there.pressure] = mesh.interpolate(coefficients[:, at.pressure], other.nodes)
    return found


def _gaps_on(point: LinePoint, coefficients: Array, of: LinePoint) -> Array:
    """Return the coefficients of the log gap on another point's mesh."""
    mesh, nodes, at = point.state.mesh, of.state.mesh.nodes, point.state.equations.layout
    if mesh is of.state.mesh:
        return coefficients[:, at.gap]
    shapes = coefficients[:, at.gap].copy()
    shapes[0] -= np.log(mesh.far)
    found = mesh.interpolate(shapes, nodes)
    found[0] += np.log(mesh.scale**2 + nodes**2)
    return found


READ_COLUMNS = [ROW["minimum_gap"], POSITION]
SERIES_COLUMNS = [ROW[name] for name in NAMES if name != "minimum_gap"]


def line_problem(
    groups_at: Callable[[float], Groups], direction: Direction, rtol: float, is_uniform: bool = True
) -> LineProblem | LineKnots:
    """Return the states of the line along a path: with series where one model of formulas holds, else with slopes."""
    start = groups_at(0.0)
    # A law that is no polynomial around a separation has no series there.
    law = start.law
    has_series = law is None or is_exponential(law) or not start.speed > 0 or misfit(law) <= NEGLIGIBLE * rtol
    if is_uniform and has_series and has_formulas(with_positive_gap(start)[0].model):
        return LineProblem(groups_at, direction, rtol)
    return LineKnots(groups_at, rtol)


class LineProblem(LineStates):
    """The states of the line at the groups ``groups_at(s)``, whose logarithms change along ``direction``."""

    path = SolvedPath

    def __init__(self, groups_at: Callable[[float], Groups], direction: Direction, rtol: float) -> None:
        super().__init__(groups_at, rtol)
        self.direction = direction
        self.steps = LineSteps(self.rtol)
        self._sharper: dict[float, LineSteps] = {}  # Of states between those of the path, by their tolerance

    @property
    def negligible(self) -> float:
        """Error that the polynomial of the minimum gap may add."""
        return NEGLIGIBLE * self.tolerance

    def read_scales(self, values: Array) -> Array:
        """Return the lowest minimum gap, and the half-width for its position."""
        return np.append(values[:, :1].min(axis=0), np.ones(values.shape[1] - 1)) if values.size else np.empty(0)

    def solve(self, s: float, near: Sequence[Expansion]) -> Expansion | Outcome:
        """Return the expanded state at ``s``, from no, one or two neighbours ``near``, or the outcome of the failure."""
        found = self._solve(s, near)
        if isinstance(found, Outcome) and len(near) > 1 and found is not Outcome.ROUNDING:
            found = self._solve(s, [max(near, key=lambda end: end.radius)])  # a series may be good on one side alone
        return found

    def _solve(self, s: float, near: Sequence[Expansion]) -> Expansion | Outcome:
        """Return the expanded state at ``s`` from all neighbours, or the outcome of the failure."""
        groups = self.groups_at(s)
        if near:
            guess, doubt = self._guess(s, groups, near)
            if not doubt < 1:
                return Outcome.PATH_LOST
            gap = guess.y[guess.equations.layout.gap]
            if not (np.isfinite(gap).all() and gap.min() > 0):
                return Outcome.NOT_FINITE
            spread = max(abs(guess.minimum_position - one.values[POSITION]) for one in near)
            refined = self.steps.solve(guess, groups, spread)
        else:
            refined = self.steps.start(groups)
        return self._expanded(s, refined)

    def begin(self, s: float, refined: RefinedState) -> Expansion | Outcome:
        """Return the expansion of a state that is known already, with a full film, or the outcome of the failure."""
        self.steps.move_to(refined)
        groups = self.groups_at(s)
        if refined.state is not None:  # series need the groups of the path to the last digit, and the state's own Jacobian
            state = replace(refined.state.without_inverse(), groups=with_positive_gap(groups)[0])
            refined = replace(refined, groups=groups, state=state)
        return self._expanded(s, refined)

    def _expanded(self, s: float, found: RefinedState) -> Expansion | Outcome:
        """Return the expansion of a state whose error is within the tolerance, else its outcome."""
        refined = self.accepted(found)
        if isinstance(refined, Outcome):
            return refined
        state = refined.state
        assert state is not None and refined.fine is not None
        state = state.corrected()
        y, inverse, state = state.y, state.root.inverse, state.without_inverse()
        assert inverse is not None
        self.steps.move_to(refined)  # one that rounding limits has a mesh of its own
        self.steps.inverse = inverse  # that of the next state, too
        with np.errstate(all="ignore"):  # values that are not finite are cut off below
            direction, shifts = shift_along(self.groups_at(s), state.groups, self.direction, MAX_DEGREE)
            of_state = expand(state.equations, y, inverse, state.groups, direction, shifts, MAX_DEGREE)
            known = self._radius(s, state, of_state)
        numbers, errors = numbers_of(refined)
        exists = [column for column in (SERIES_COLUMNS if self.moves else []) if np.isfinite(numbers[column])]
        finite = np.isfinite(np.hstack([of_state.unknowns, of_state.observables[:, exists]])).all(axis=1)
        order = MAX_DEGREE if finite.all() else max(1, int(np.argmin(finite)) - 1)
        unknowns, observables, logs = (part[: order + 1] for part in of_state)
        nothing = np.full((order + 1, 1), np.nan)
        series, logs = np.hstack([observables, nothing]), np.hstack([logs, nothing])
        series[0] = numbers
        positive = np.isfinite(logs[0]) & (series[0] > 0)
        logs[0, positive] = np.log(series[0, positive])
        point = LinePoint(replace(refined, state=state), state, unknowns, refined.fine)
        return Expansion(s, point, series, logs, errors, known)

    def _radius(self, s: float, state: State, found: Expanded) -> float:
        """Return an estimate of the radius of convergence of gap and observables."""
        of_values = found.observables[:, SERIES_COLUMNS] / self.scales(found.observables[:1], np.array([s]))[:, SERIES_COLUMNS]
        rounding = max(COEFFICIENT_NOISE, NEGLIGIBLE * self.tolerance)
        return min(radius(each, rounding) for each in (found.unknowns[:, : state.mesh.size], of_values))

    def _guess(self, s: float, groups: Groups, near: Sequence[Expansion]) -> tuple[State, float]:
        """Return a guess of the state at ``s``, and the uncertainty of the logarithms of its unknowns."""
        base, doubt = with_positive_gap(groups)[0], 0.0
        nearest = min(near, key=lambda each: abs(s - each.coordinate))
        mesh_of = nearest.point
        if len(near) == 1:
            w, doubt = beyond(mesh_of.unknowns, s - nearest.coordinate)
        else:
            left, right = near
            part = (s - left.coordinate) / ((right.coordinate - left.coordinate) or 1.0)
            w = between(left, right, mesh_of, np.array([part]))[0]
            # No gap follows a group by more than its first power: such a polynomial is made of series that do not converge.
            gap = mesh_of.state.equations.layout.gap
            if not np.abs((w - mesh_of.unknowns[0])[gap]).max() < 1 + abs(s - nearest.coordinate):
                w = mesh_of.unknowns[0]
        return self.state(base, mesh_of, w), doubt

    def guess_at(self, path: SolvedPath, s: float) -> State:
        """Return the state at a coordinate by the series around it, on the mesh of the nearer one."""
        ends = path.around(s)
        for end in ends:
            if s == end.coordinate:
                found: State = end.point.state
                return found
        return self._guess(s, self.groups_at(s), ends)[0]

    @one_blas_thread
    def point_at(self, path: SolvedPath, s: float, rtol: float | None = None) -> RefinedState:
        """Return the verified state at a coordinate; without ``rtol`` the tolerance is that of the path."""
        rtol = self.tolerance if rtol is None else rtol
        steps, known = self._sharper.setdefault(rtol, LineSteps(rtol)), path.nearest(s).state
        if known.estimate.total <= rtol:
            steps.move_to(known)
        return steps.solve(self.guess_at(path, s), self.groups_at(s))

    def state(self, groups: Groups, of: LinePoint, w: Array) -> State:
        """Return the state with unknowns ``w``, which hold logarithms of gaps, on the mesh of a point."""
        operators = of.state.equations.operators
        y = from_logs(of.state.equations, w)
        scale = float(y[of.state.equations.layout.flux_gap.start]) ** 2
        equations = Equations(operators, float(groups.speed), contact_law(groups), scale)
        return State(groups, equations, y, Root(y, Outcome.CONVERGED, 0, 0, 0.0, None, None), 0.0)

    def checked_error(self, left: Expansion, right: Expansion) -> Array:
        """Return half the difference of both ends' series in the middle, less what truncation explains, on two meshes."""
        if left.point.state.mesh is right.point.state.mesh:
            return np.zeros(POSITION + 1)
        if not self.moves:
            return np.full(POSITION + 1, NEGLIGIBLE * self.tolerance)
        order = min(left.order, right.order)
        steps = (0.5 * (right.coordinate - left.coordinate) * np.array([1.0, -1.0])[:, None]) ** np.arange(order + 1)
        terms = np.stack([left.series[: order + 1], right.series[: order + 1]]) * steps[:, :, None]
        values = terms.sum(axis=1)
        with np.errstate(all="ignore"):  # a series may lead to no number
            apart = np.abs(values[1] - values[0]) - SAFETY * np.abs(terms[:, -2:]).max(axis=1).sum(axis=0)
        scales = self.scales(values.mean(axis=0)[None], np.array([0.5 * (left.coordinate + right.coordinate)]))[0]
        found = 0.5 * np.maximum(np.nan_to_num(apart), 0.0) / scales
        found[READ_COLUMNS] = found[ROW["central_gap"]], 0.0  # the minimum has no series
        return NEGLIGIBLE * self.tolerance + np.asarray(found)

    def read(self, left: Expansion, right: Expansion, parts: Array) -> tuple[Array, Array, Sequence[int]]:
        """Return the minimum gap and its position, on the mesh of the two that resolves each better."""
        if not self.moves:
            return np.empty((len(parts), 0)), np.empty((len(parts), 0)), []
        at_ends = np.maximum(left.errors[READ_COLUMNS], right.errors[READ_COLUMNS])
        finer, coarser = sorted((left.point, right.point), key=lambda point: -point.state.mesh.size)
        values, error = minimum_between(left, right, finer, parts)
        if finer.state.mesh is not coarser.state.mesh:
            others, of_others = minimum_between(left, right, coarser, parts)
            better = of_others < error
            values, error = np.where(better, others, values), np.where(better, of_others, error)
        return values.T, np.stack([np.maximum(at_ends[0], error), np.full(len(parts), at_ends[1])], axis=1), READ_COLUMNS


def has_formulas(model: Model) -> bool:
    """Return whether the gradient of a film and its drag are smooth functions that jets pass through."""
    film = model.film
    return (
        model.cavitation is Cavitation.NONE
        and isinstance(film, Newtonian)
        and film.is_smooth
        and isinstance(film.viscosity, Constant | Barus | Roelands)
        and isinstance(film.density, Incompressible | DowsonHigginson)
    )
