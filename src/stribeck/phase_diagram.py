"""The phase diagram: regimes and friction over speed, load and roughness, and the transitions between regimes.

Each pair of load and roughness is one curve over the speed, independent of the others.  The transitions are located on states
solved there, also where they lie outside the speeds of the grid.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np

from ._types import Array
from .curve import Landmark, StribeckCurve, stribeck_curve
from .merging import weakening
from .newton import Outcome
from .parameters import QUANTITIES, Groups, LineContact
from .regimes import BOUNDARY_FLUID_SHARE, HYDRODYNAMIC_CONTACT_SHARE, Regime, regime_of
from .solution import Definition, Solution, check_definition, coefficients
from .solve import SolveError, as_groups, check_rtol, solve
from .span import automatic_speeds
from .threads import one_blas_thread
from .units import InputError, show, to_si

if TYPE_CHECKING:
    import xarray

__all__ = ["AXES", "REGIMES", "Diagram", "phase_diagram"]

AXES = ("load", "roughness", "speed")
"""The dimensions of a diagram, in their order."""

REGIMES: tuple[Regime, ...] = ("boundary", "mixed", "hydrodynamic")
"""Names of the regimes; their places are the codes in a diagram, where -1 stands for a point without a state."""

POINTS = {"load": 2, "roughness": 25, "speed": 61}
"""Points between the ends of a range, unless asked for otherwise."""

MOST_POINTS = 10_000

FIELDS = (
    "friction",
    "friction_error",
    "fluid_load_share",
    "contact_friction_share",
    "central_gap",
    "lambda_ratio",
    "error_estimate",
)

MARKS = {
    "speed_at_5_percent_fluid": f"fluid carries {BOUNDARY_FLUID_SHARE:.0%} of the load",
    "speed_at_half_fluid": f"fluid carries {0.5:.0%} of the load",
    "speed_at_10_percent_contact_friction": f"asperities cause {HYDRODYNAMIC_CONTACT_SHARE:.0%} of the friction",
}
"""Variables of a diagram, by the names that curves give to the same transitions."""

LINES = (*MARKS, "speed_at_minimum", "friction_at_minimum")

EXTENSION = 4
"""Points per decade by which a row goes on beyond the grid, to plateau and hydrodynamic branch."""


@dataclass(eq=False)
class Diagram:
    """What is being filled in: a diagram's axes, settings and results.

    Attributes
    ----------
    contact : LineContact or None
        The contact, where the axes are in SI units.
    axes : dict of str to ndarray
        Values of load, roughness and speed, ascending.
    mu0, beta : float
        Friction coefficient of the dry contact and coefficient of the contact law [-].
    definition : {"paper", "balanced"}
        Definition of the viscous friction.
    rtol : float
        Relative tolerance of the states.
    outcome : Outcome
        CONVERGED, or INTERRUPTED.
    """

    contact: LineContact | None
    axes: dict[str, Array]
    mu0: float
    beta: float
    definition: Definition
    rtol: float
    outcome: Outcome = Outcome.CONVERGED
    fields: dict[str, Array] = field(init=False)
    regime: Any = field(init=False)
    outcomes: Any = field(init=False)
    lines: dict[str, Array] = field(init=False)
    velocity_weakening: Any = field(init=False)
    messages: Any = field(init=False)
    merging: Array | None = None

    def __post_init__(self) -> None:
        """Make the empty tables: all that is not reached was interrupted."""
        shape = tuple(len(self.axes[name]) for name in AXES)
        self.fields = {name: np.full(shape, np.nan) for name in FIELDS}
        self.regime = np.full(shape, -1, dtype=np.int8)
        self.outcomes = np.full(shape, Outcome.INTERRUPTED.name, dtype=object)
        self.lines = {name: np.full(shape[:2], np.nan) for name in LINES}
        self.velocity_weakening = np.full(shape[:2], -1, dtype=np.int8)
        self.messages = np.full(shape[:2], Outcome.INTERRUPTED.value, dtype=object)

    def problem(self, i: int, j: int) -> tuple[LineContact | Groups, Groups, float]:
        """Return contact or groups of a row at speed 1 of its axis, the groups, and the speed group for that speed."""
        load, roughness = float(self.axes["load"][i]), float(self.axes["roughness"][j])
        if self.contact is None:
            groups = Groups(1.0, load, roughness)
            return groups, groups, 1.0
        row = self.contact.replace(load=load, roughness=roughness, speed=1.0)
        return row, row.groups, float(row.groups.speed)


@one_blas_thread
def phase_diagram(
    problem: LineContact | Groups | None = None,
    *,
    load: Any = None,
    speed: Any = None,
    roughness: Any = None,
    points: int | Mapping[str, int] | None = None,
    mu0: float | None = None,
    beta: float | None = None,
    definition: Definition = "paper",
    rtol: float = 1e-4,
    merging: bool = False,
    on_point: Callable[[int, int], object] | None = None,
) -> xarray.Dataset:
    """Solve a grid of speeds, loads and roughnesses, and locate the transitions between its regimes.

    Parameters
    ----------
    problem : LineContact or Groups, optional
        The contact, of which the three are replaced as far as they are given.  With a LineContact the axes are in SI units.
    load, speed, roughness : float or str, or (low, high), or array_like, optional
        Each a number, a range with ``points`` between, evenly in the logarithm, or three and more ascending points.
        Groups [-], or SI numbers or text with units for a LineContact.  Speed and roughness may be zero.  Without a speed
        the grid reaches from the boundary plateau to the hydrodynamic branch of all its rows.
    points : int or dict of str to int, optional
        Points of the ranges, for all or by name; 2 loads, 25 roughnesses and 61 speeds where not given.
    mu0, beta : float, optional
        Friction coefficient of the dry contact and coefficient of the contact law [-]; those of the contact, or 1.
    definition : {"paper", "balanced"}
        Definition of the viscous friction.
    rtol : float
        Relative tolerance of the states of the grid; transitions are located on finer ones.
    merging : bool
        Whether to look, at each load, for the roughness at which the minimum disappears, see
        :func:`stribeck.merging.merging_roughness`; about a second each.
    on_point : callable, optional
        ``on_point(done, points)`` is called as points are finished, for progress.

    Returns
    -------
    xarray.Dataset
        Along load, roughness and speed: regime, friction, shares, films, error and outcome of each point; along load and
        roughness: the speeds of the transitions, solved, by our formulas and by those that the paper prints.  After Ctrl-C
        what is missing has outcome INTERRUPTED; what could not be solved has its outcome, nan, and the reason in
        ``message``.

    Raises
    ------
    InputError
        If an argument is outside its range.
    MissingExtraError
        If xarray is not installed.

    Notes
    -----
    About 0.4 s for each pair of load and roughness; more above load 1.

    Source: [BP] Fig. 11, which shows the printed formulas alone.
    """
    check_rtol(rtol)
    diagram = _diagram(problem, {"load": load, "roughness": roughness, "speed": speed}, points, mu0, beta, definition, rtol)
    from .phase_dataset import diagram_dataset, import_xarray

    import_xarray()
    total = diagram.regime.size
    columns = len(diagram.axes["speed"])
    rows = list(product(range(len(diagram.axes["load"])), range(len(diagram.axes["roughness"]))))
    try:
        for number, (i, j) in enumerate(rows):

            def report(part: float, number: int = number) -> None:
                if on_point is not None:
                    on_point(number * columns + int(part * columns), total)

            _fill_row(diagram, i, j, report)
        if merging:
            diagram.merging = _merging_line(diagram)
    except KeyboardInterrupt:
        diagram.outcome = Outcome.INTERRUPTED
    return diagram_dataset(diagram)


def _fill_row(diagram: Diagram, i: int, j: int, report: Callable[[float], None]) -> None:
    """Solve one load and roughness over the speed, and enter it; raise KeyboardInterrupt where that was interrupted."""
    problem, groups, unit = diagram.problem(i, j)
    speeds = diagram.axes["speed"]
    wanted = {float(value): k for k, value in enumerate(speeds)}
    if 0.0 in wanted:
        _fill_rest(diagram, problem, (i, j, wanted.pop(0.0)))
    values = _extended(np.array(list(wanted)), groups, unit, diagram)
    settings: dict[str, Any] = {
        "mu0": diagram.mu0,
        "beta": diagram.beta,
        "definition": diagram.definition,
        "rtol": diagram.rtol,
        "on_point": lambda done, points: report(done / points),
    }
    try:
        curve = stribeck_curve(problem, speed=values, points=2, **settings)
    except SolveError as failure:
        for k in wanted.values():
            diagram.outcomes[i, j, k] = failure.outcome.name
        diagram.messages[i, j] = str(failure)
        return
    reached = dict(zip(curve.values.tolist(), curve.solutions, strict=True))
    for value, k in wanted.items():
        if value in reached:
            _enter(diagram, (i, j, k), reached[value])
        else:
            diagram.outcomes[i, j, k] = curve.outcome.name
    diagram.messages[i, j] = "" if curve.outcome.ok else curve.outcome.value
    if curve.outcome is Outcome.INTERRUPTED:
        raise KeyboardInterrupt
    try:
        _enter_lines(diagram, (i, j), curve, groups, unit)
    except SolveError as failure:
        diagram.messages[i, j] = str(failure)


def _fill_rest(diagram: Diagram, problem: LineContact | Groups, place: tuple[int, int, int]) -> None:
    resting = problem.replace(speed=0.0) if isinstance(problem, LineContact) else replace(problem, speed=0.0)
    try:
        _enter(diagram, place, solve(resting, rtol=diagram.rtol))
    except SolveError as failure:
        diagram.outcomes[place] = failure.outcome.name


def _enter(diagram: Diagram, place: tuple[int, int, int], solution: Solution) -> None:
    friction = solution.friction(diagram.mu0, diagram.beta, diagram.definition)
    contact = friction.contact / friction.total if friction.total > 0 else 0.0
    shares = solution.fluid_load_share, contact
    films = solution.central_gap, solution.lambda_ratio
    for name, value in zip(FIELDS, (friction.total, friction.error, *shares, *films, solution.error_estimate), strict=True):
        diagram.fields[name][place] = value
    diagram.regime[place] = REGIMES.index(regime_of(solution.fluid_load_share, contact))
    diagram.outcomes[place] = solution.outcome.name


def _enter_lines(diagram: Diagram, place: tuple[int, int], curve: StribeckCurve, groups: Groups, unit: float) -> None:
    """Locate the transitions of a row; a minimum above the boundary plateau is not the least friction, yet one."""
    marks: dict[str, Landmark] = {mark.name: mark for mark in curve.transitions}
    for variable, name in MARKS.items():
        if name in marks:
            diagram.lines[variable][place] = marks[name].value
    found = math.nan, math.nan
    if curve.minimum is not None:
        found = curve.minimum.value, curve.minimum.friction
    elif groups.roughness > 0 and diagram.mu0 > 0:
        branch = weakening(groups, diagram.mu0, diagram.beta, diagram.definition)
        found = branch.minimum_speed / unit, branch.minimum_friction
    diagram.lines["speed_at_minimum"][place], diagram.lines["friction_at_minimum"][place] = found
    diagram.velocity_weakening[place] = int(math.isfinite(found[0]))


def _extended(speeds: Array, groups: Groups, unit: float, diagram: Diagram) -> Array:
    """Return the speeds of a row: those of the grid, and beyond them as far as its transitions may lie."""
    if len(speeds) > 1 and groups.roughness == 0:  # smooth surfaces have no transitions
        return speeds
    low, high = (end / unit for end in automatic_speeds(groups, diagram.mu0, diagram.beta, diagram.definition))
    if not len(speeds):
        return np.geomspace(low, high, _count(high / low))
    parts = [speeds]
    if low < speeds[0]:
        parts.insert(0, np.geomspace(low, speeds[0], _count(speeds[0] / low))[:-1])
    if high > speeds[-1]:
        parts.append(np.geomspace(speeds[-1], high, _count(high / speeds[-1]))[1:])
    values = np.concatenate(parts)
    return values if len(values) > 1 else np.append(values, 10 * values)


def _count(ratio: float) -> int:
    return 2 + math.ceil(EXTENSION * math.log10(ratio))


def _merging_line(diagram: Diagram) -> Array:
    """Return the roughness at which each load loses the minimum, on the axis of the diagram."""
    from .merging import merging_roughness

    line = np.full(len(diagram.axes["load"]), np.nan)
    for i in range(len(line)):
        _, groups, _ = diagram.problem(i, 0)
        try:
            group = merging_roughness(float(groups.load), diagram.mu0, diagram.beta, diagram.definition)
        except SolveError:
            continue
        line[i] = group if diagram.contact is None else _in_metres(diagram.contact, group)
    return line


def _in_metres(contact: LineContact, roughness_group: float) -> float:
    return roughness_group / float(contact.replace(roughness=1.0).groups.roughness)


# --- arguments ---


def _diagram(
    problem: LineContact | Groups | None,
    given: dict[str, Any],
    points: int | Mapping[str, int] | None,
    mu0: float | None,
    beta: float | None,
    definition: Definition,
    rtol: float,
) -> Diagram:
    """Return the empty diagram that the arguments ask for."""
    contact = problem if isinstance(problem, LineContact) else None
    mu0, beta = coefficients(contact, mu0, beta)
    definition = check_definition(definition)
    if problem is not None:
        as_groups(problem)
        given = {name: getattr(problem, name) if value is None and name != "speed" else value for name, value in given.items()}
    missing = [name for name in ("load", "roughness") if given[name] is None]
    if missing:
        raise InputError(f"{' and '.join(missing)} missing; give numbers or ranges, or a LineContact.")
    counts = _points(points)
    axes = {name: _axis(name, given[name], contact is not None, counts[name]) for name in ("load", "roughness")}
    corners = Diagram(contact, axes | {"speed": np.ones(1)}, mu0, beta, definition, rtol)
    if given["speed"] is None:
        axes["speed"] = _automatic_axis(corners, counts["speed"])
    else:
        axes["speed"] = _axis("speed", given["speed"], contact is not None, counts["speed"])
    return Diagram(contact, axes, mu0, beta, definition, rtol)


def _points(points: int | Mapping[str, int] | None) -> dict[str, int]:
    wanted = {} if points is None else points if isinstance(points, Mapping) else dict.fromkeys(AXES, points)
    unknown = [name for name in wanted if name not in AXES]
    if unknown:
        raise InputError(f"points has the unknown name {show(unknown[0])}; it may have load, roughness and speed.")
    for name, count in wanted.items():
        if isinstance(count, bool) or not isinstance(count, int) or not 2 <= count <= MOST_POINTS:
            raise InputError(f"points of {name} = {show(count)}; they must be a whole number from 2 to {MOST_POINTS}.")
    return POINTS | dict(wanted)


def _axis(name: str, value: Any, si: bool, points: int) -> Array:
    """Return the values of one axis, ascending."""
    items = [value] if isinstance(value, str) or np.ndim(value) == 0 else list(value)
    if si:
        numbers = [to_si(item, QUANTITIES[name].dimension, name) for item in items]
    else:
        try:
            numbers = [float(item) for item in items]
        except (TypeError, ValueError):
            raise InputError(f"{name} = {show(value)}; groups are plain numbers, for units give a LineContact.") from None
    found = np.array(numbers, dtype=float)
    least = "positive" if name == "load" or len(found) == 2 else "zero or positive"
    too_low = (found <= 0).any() if least == "positive" else (found < 0).any()
    if not len(found) or found.ndim != 1 or not np.isfinite(found).all() or too_low or (np.diff(found) <= 0).any():
        raise InputError(
            f"{name} = {show(value)}; give one number, a range (low, high), or ascending points, all finite and {least}."
        )
    return np.geomspace(found[0], found[1], points) if len(found) == 2 else found


def _automatic_axis(diagram: Diagram, points: int) -> Array:
    """Return speeds that reach from the lowest plateau to the highest branch of the outermost rows."""
    ends = []
    for i, j in product((0, -1), repeat=2):
        _, groups, unit = diagram.problem(i, j)
        ends += [end / unit for end in automatic_speeds(groups, diagram.mu0, diagram.beta, diagram.definition)]
    return np.geomspace(min(ends), max(ends), points)
