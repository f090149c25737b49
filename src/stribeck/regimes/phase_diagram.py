"""The phase diagram: regimes and friction over speed, load and roughness, and the transitions between regimes."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import replace
from functools import cache, partial
from itertools import pairwise, product
from typing import TYPE_CHECKING, Any, get_args

import numpy as np

from stribeck._types import Array
from stribeck.asperity_friction.coulomb import as_asperity_friction
from stribeck.atlas.tables import table_for
from stribeck.contact_laws.law import AsperityLaw
from stribeck.contacts.contact import Contact
from stribeck.contacts.friction import Definition, coefficients, friction_share, regime_numbers
from stribeck.contacts.groups import Groups
from stribeck.curves.friction_path import FrictionPath
from stribeck.curves.regime import Landmark, Method
from stribeck.curves.result import StribeckCurve, path_of
from stribeck.curves.stribeck_curve import stribeck_curve
from stribeck.numerics.events import first_zero, least_by_slope, zero_of_growing
from stribeck.numerics.threads import one_blas_thread
from stribeck.quantities.keywords import answers_typos
from stribeck.quantities.outcome import Outcome
from stribeck.quantities.units import InputError, checked_word
from stribeck.regimes.phase_grid import MARKS, Diagram, diagram_dataset, empty_diagram
from stribeck.solver.solve import as_groups, check_rtol, solve
from stribeck.solver.solve_error import SolveError, describe

if TYPE_CHECKING:
    import xarray

# Tolerance of ln(speed) at the minimum slope, on which the slope itself depends in second order; also its step there.
SPEED_TOLERANCE = 1e-3

MINIMUM_TOLERANCE = 1e-9  # Tolerance of ln(speed) at the minimum, and of ln(roughness) where it disappears

# Relative roughness between which the merging is looked for, and where that begins, in steps of a factor.
KAPPA_RANGE = (1e-5, 1e3)
KAPPA_START = 0.3
KAPPA_STEP = 3.0


def minimum_behind(path: FrictionPath) -> tuple[float, tuple[float, float] | None]:
    """Return the least slope along a path over the speed, and where friction falls, speed and friction of its minimum there.

    The slope over the published viscous friction is 1 far down on the plateau, and 0.4 to 0.7 on the hydrodynamic branch.
    """
    published = replace(path, definition="published")

    def slopes(places: Array) -> Array:
        # Friction of the substrate that is the slower one is negative; its size counts.
        _, contact, viscous = path.parts(places)
        return np.asarray(np.sign(contact + viscous) * path.slopes(places) / np.abs(published.parts(places)[2]))

    def slope(s: float) -> float:
        return float(slopes(np.array([s]))[0])

    def bend(s: float) -> float:
        return slope(s + SPEED_TOLERANCE) - slope(s - SPEED_TOLERANCE)

    places = path.source.places
    values = slopes(places)
    event = least_by_slope(bend, places, values, SPEED_TOLERANCE)
    lowest = float(places[np.argmin(values)]) if event is None else event.place
    least, behind = slope(lowest), places > lowest
    minimum = first_zero(slope, np.append(lowest, places[behind]), np.append(least, values[behind]), MINIMUM_TOLERANCE)
    if least >= 0 or minimum is None:
        return least, None
    _, contact, viscous = path.parts(np.array([minimum.place]))
    return least, (math.exp(minimum.place), float((contact + viscous)[0]))


@one_blas_thread
def roughness_without_minimum(
    problem: Groups | Contact,
    boundary_friction: Any = None,
    beta: float | None = None,
    definition: Definition = "balanced",
    rtol: float = 1e-6,
) -> float:
    r"""Return the roughness, or its group, at which the curves over the speed lose their minimum.

    .. math:: \min_\lambda \frac{1}{\mu_f} \frac{d\mu}{d\ln\lambda} = 0

    Source: [BP] Conclusion, which names a minimum that exceeds boundary_friction and a branch that disappears as one: they
    are two, this the second.
    """
    contact = problem if isinstance(problem, Contact) else None
    boundary_friction, beta = coefficients(contact, boundary_friction, beta)
    if as_asperity_friction(boundary_friction).is_frictionless:
        return 0.0

    def with_roughness(value: float) -> Any:
        """Return the problem with another roughness."""
        return problem.replace(roughness=value) if isinstance(problem, Contact) else replace(problem, roughness=value)

    kappa_of_unit = float(as_groups(with_roughness(1.0))[0].relative_roughness)

    def least_slope(log_kappa: float) -> float:
        rough = with_roughness(math.exp(log_kappa) / kappa_of_unit)
        given: Any = {"boundary_friction": boundary_friction, "beta": beta, "definition": definition}
        curve = stribeck_curve(rough, points=2, rtol=rtol, **given)
        if curve.outcome is Outcome.INTERRUPTED:
            raise KeyboardInterrupt
        if not curve.outcome.ok:
            raise SolveError(curve.outcome, None, f"{describe(as_groups(rough)[0])}: {curve.outcome.value}")
        return minimum_behind(path_of(curve))[0]

    ends = math.log(KAPPA_RANGE[0]), math.log(KAPPA_RANGE[1])
    tolerance = max(rtol, MINIMUM_TOLERANCE)
    event = zero_of_growing(cache(least_slope), math.log(KAPPA_START), math.log(KAPPA_STEP), ends, tolerance)
    return math.nan if event is None else math.exp(event.place) / kappa_of_unit


@answers_typos
@one_blas_thread
def phase_diagram(
    problem: Contact | Groups | None = None,
    *,
    load: Any = None,
    speed: Any = None,
    roughness: Any = None,
    points: int | Mapping[str, int] | None = None,
    boundary_friction: float | None = None,
    beta: float | None = None,
    definition: Definition = "balanced",
    rtol: float | None = None,
    merging: bool = False,
    on_point: Callable[[int, int], object] | None = None,
    law: str | AsperityLaw | None = None,
    method: Method = "solver",
) -> xarray.Dataset:
    """Solve a grid of speeds, loads and roughnesses, and locate the transitions between its regimes.

    Parameters
    ----------
    problem : Contact or Groups, optional
        The contact, of which the three are replaced as far as they are given.  With a LineContact the axes are in SI units.
    load, speed, roughness : float or str, or (low, high), or array_like, optional
        Each a number, a range with ``points`` between, evenly in the logarithm, or three and more ascending points.
        Groups [-], or SI numbers or text with units for a LineContact.  Speed and roughness may be zero.  Without a speed
        the grid reaches from the boundary plateau to the hydrodynamic branch of all its rows.
    points : int or dict of str to int, optional
        Points of the ranges, for all or by name; 2 loads, 25 roughnesses and 61 speeds where not given, of a ball 2, 5 and 13.
    boundary_friction, beta : float, optional
        Friction coefficient of the dry contact and coefficient of the contact law [-]; those of the contact, or 1.
    definition : {"balanced", "published"}
        Definition of the viscous friction.
    rtol : float, optional
        Relative tolerance of the states of the grid, 1e-4 and of a ball 1e-3 where not given; transitions are located on finer
        ones, of a ball on such states too.  ``error_estimate`` has what was reached.
    merging : bool
        Whether to look, at each load, for the roughness at which the minimum disappears, see
        :func:`stribeck.regimes.phase_diagram.roughness_without_minimum`; about a second each, of cylinders alone.
    on_point : callable, optional
        ``on_point(done, points)`` is called as points are finished, for progress.
    law : str or AsperityLaw, optional
        Contact law as in :func:`stribeck.solve`; that of the problem if omitted.  What formulas give is nan for another law
        than the exponential one.
    method : {"solver", "atlas"}
        Whether points and transitions are solved, or read off :mod:`stribeck.atlas`, within the stated error of
        its table and a hundred times as fast.

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
        If an argument is outside its range, or a point outside that of the atlas.
    MissingExtraError
        If xarray is not installed.

    Notes
    -----
    About 0.4 s for each pair of load and roughness; more above load 1.  Of a ball 5 to 30 s; formulas are left out.

    Source: [BP] Fig. 11, which shows the printed formulas alone.
    """
    if rtol is not None:
        rtol = check_rtol(rtol)
    diagram = empty_diagram(
        problem, {"load": load, "roughness": roughness, "speed": speed}, points, boundary_friction, beta, definition, rtol, law
    )
    if merging and not diagram.kind.has_formulas:
        raise InputError("merging = True is for cylinders, geometry 'line'; leave it out for a ball.")
    from stribeck.files.datasets import import_xarray

    import_xarray()
    checked_word("method", method, get_args(Method))
    total = diagram.table["regime"].size
    columns = len(diagram.axes["speed"])
    rows = list(product(range(len(diagram.axes["load"])), range(len(diagram.axes["roughness"]))))
    try:
        for number, (i, j) in enumerate(rows):

            def report(part: float, number: int = number) -> None:
                if on_point is not None:
                    on_point(number * columns + int(part * columns), total)

            _fill_row(diagram, (i, j), method, report)
        if merging:
            diagram.merging = np.full(len(diagram.axes["load"]), np.nan)
            given = diagram.boundary_friction, diagram.beta, diagram.definition
            for i in range(len(diagram.merging)):
                with suppress(SolveError):
                    diagram.merging[i] = roughness_without_minimum(diagram.problem(i, 0)[0], *given)
    except KeyboardInterrupt:
        diagram.outcome = Outcome.INTERRUPTED
    return diagram_dataset(diagram)


def _fill_row(diagram: Diagram, row: tuple[int, int], method: Method, report: Callable[[float], None]) -> None:
    """Enter the curve over the speed at one load and roughness; raise KeyboardInterrupt where that was interrupted."""
    problem, _, _ = diagram.problem(*row)
    table, speeds = diagram.table, diagram.axes["speed"]
    for k in np.flatnonzero(speeds == 0).tolist():
        _enter_rest(diagram, problem, (*row, k))
    moving = np.flatnonzero(speeds > 0)
    settings: dict[str, Any] = {
        "boundary_friction": diagram.boundary_friction,
        "beta": diagram.beta,
        "definition": diagram.definition,
        "rtol": diagram.rtol,
        "on_point": lambda done, points: report(done / points),
    }
    try:
        curve = stribeck_curve(
            problem, speed=_filled(speeds[moving], diagram, row, method), points=2, method=method, **settings
        )
    except SolveError as failure:
        table["outcome"][row][moving] = failure.outcome.name
        table["message"][row] = str(failure)
        return
    is_there = np.isin(speeds, curve.values)
    table["outcome"][row][moving] = curve.outcome.name
    table["outcome"][row][is_there] = Outcome.CONVERGED.name
    kappa = float(np.max(curve.groups.relative_roughness))
    alpha = 1.0 if curve.contact is None else curve.contact.alpha
    found = _numbers_of(curve.friction, curve.observable) | {
        "lambda_ratio": curve.observable("minimum_gap") / (alpha * kappa) if kappa > 0 else np.full(len(curve), math.inf),
        "error_estimate": np.array([each.error_estimate for each in curve.solutions] or [curve.error_estimate] * len(curve)),
    }
    points = np.searchsorted(curve.values, speeds[is_there])
    for name, values in found.items():
        table[name][row][is_there] = values[points]
    table["message"][row] = "" if curve.outcome.ok else curve.outcome.value
    if curve.outcome is Outcome.INTERRUPTED:
        raise KeyboardInterrupt
    try:
        _enter_lines(diagram, row, curve)
    except SolveError as failure:
        table["message"][row] = str(failure)


def _numbers_of(friction: Any, number_of: Callable[[str], Any]) -> dict[str, Any]:
    """Return what a diagram has of a state, or of all states of a curve."""
    fluid, by_asperities = number_of("fluid_load_share"), friction_share(friction.asperities, friction.fluid)
    return {
        "regime": regime_numbers(fluid, by_asperities),
        "friction": friction.total,
        "friction_error": friction.error,
        "fluid_load_share": fluid,
        "contact_friction_share": by_asperities,
        "central_gap": number_of("central_gap"),
    }


def _enter_rest(diagram: Diagram, problem: Contact | Groups, place: tuple[int, int, int]) -> None:
    resting = problem.replace(speed=0.0) if isinstance(problem, Contact) else replace(problem, speed=0.0)
    try:
        solution = solve(resting, rtol=diagram.rtol)
    except SolveError as failure:
        diagram.table["outcome"][place] = failure.outcome.name
        return
    friction = solution.friction(diagram.boundary_friction, diagram.beta, diagram.definition)
    found = _numbers_of(friction, partial(getattr, solution)) | {"outcome": solution.outcome.name}
    found |= {name: getattr(solution, name) for name in ("lambda_ratio", "error_estimate")}
    for name, value in found.items():
        diagram.table[name][place] = value


def _enter_lines(diagram: Diagram, row: tuple[int, int], curve: StribeckCurve) -> None:
    """Locate the transitions of a row; a minimum above the boundary plateau is not the minimum friction, yet one."""
    marks: dict[str, Landmark] = {mark.name: mark for mark in curve.transitions}
    found: dict[str, Any] = {variable: marks[name].value for variable, name in MARKS.items() if name in marks}
    minimum = None if curve.minimum is None else (curve.minimum.value, curve.minimum.friction)
    is_followed = curve.method == "atlas" or diagram.kind.has_formulas
    if minimum is None and is_followed and np.max(curve.groups.roughness) > 0 and diagram.coefficient > 0:
        _, minimum = minimum_behind(path_of(curve))
    found["velocity_weakening"] = int(minimum is not None)
    if minimum is not None:
        found["speed_at_minimum"], found["friction_at_minimum"] = minimum
    for name, value in found.items():
        diagram.table[name][row] = value


def _filled(speeds: Array, diagram: Diagram, row: tuple[int, int], method: Method) -> Array:
    """Return the speeds of a row: those of the grid, what lies in wide gaps, and as far out as its transitions may lie."""
    _, groups, unit = diagram.problem(*row)
    if method == "atlas":
        return np.union1d(speeds, np.array(table_for(groups).speeds(groups)) / unit)
    if len(speeds) > 1 and groups.roughness == 0:  # smooth surfaces have no transitions
        return speeds
    low, high = diagram.ends(*row)
    ends = sorted({*speeds.tolist(), low, high} if len(speeds) else {low, high})
    pieces = [
        np.geomspace(*pair, 1 + max(1, round(diagram.kind.density * math.log10(pair[1] / pair[0]))))[:-1]
        for pair in pairwise(ends)
    ]
    return np.concatenate([*pieces, ends[-1:]])
