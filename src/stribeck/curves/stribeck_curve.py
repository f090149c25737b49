"""The solver along speed, load or roughness: the states of a Stribeck curve, by continuation or off the atlas."""

import math
from collections.abc import Callable, Sequence
from typing import Any, NoReturn, get_args

import numpy as np
from numpy.typing import ArrayLike

from stribeck._types import Array
from stribeck.asperity_friction.coulomb import as_asperity_friction, needs_area
from stribeck.atlas.tables import table_for
from stribeck.contact_laws.law import AsperityLaw
from stribeck.contacts.contact import Contact
from stribeck.contacts.friction import Definition, check_definition, coefficients
from stribeck.contacts.groups import Groups
from stribeck.contacts.with_parts import known_speeds, refuse_fixed_memory, with_parts
from stribeck.curves.atlas_source import AtlasSource
from stribeck.curves.ball_source import ball_source
from stribeck.curves.coordinate import POINTS_RANGE, Coordinate, Over, check_inside, read_problem
from stribeck.curves.friction_path import FrictionPath
from stribeck.curves.line_source import LineSource
from stribeck.curves.regime import Method
from stribeck.curves.result import StribeckCurve
from stribeck.curves.source import Coefficients, Progress
from stribeck.curves.speed_range import SPEEDS, automatic_speed_range, fastest, grown, no_range, part_of_contact
from stribeck.fluids.fluid import Cavitation
from stribeck.numerics.continuation import follow
from stribeck.numerics.threads import one_blas_thread
from stribeck.quantities.keywords import answers_typos
from stribeck.quantities.outcome import Outcome
from stribeck.quantities.units import InputError, checked_count, checked_word
from stribeck.solver.path.line_knots import LineKnots
from stribeck.solver.path.line_path import LineProblem, line_problem
from stribeck.solver.refinement import RefinedState
from stribeck.solver.solve import check_rtol, finish, with_law
from stribeck.solver.solve_error import SolveError, describe


@answers_typos
@one_blas_thread
def stribeck_curve(
    problem: Contact | Groups | None = None,
    *,
    speed: ArrayLike | Sequence[str] | None = None,
    load: ArrayLike | Sequence[str] | None = None,
    roughness: ArrayLike | Sequence[str] | None = None,
    points: int = 101,
    rtol: float = 1e-6,
    boundary_friction: float | None = None,
    beta: float | None = None,
    definition: Definition = "balanced",
    on_point: Callable[[int, int], object] | None = None,
    law: str | AsperityLaw | None = None,
    method: Method = "solver",
    **parts: Any,
) -> StribeckCurve:
    """Solve the contact along speed, load or roughness.

    Parameters
    ----------
    problem : Contact or Groups, optional
        The contact; what varies in it is replaced.  Without it the other two groups are given as keywords.
    speed, load, roughness : float, or (low, high), or array_like, optional
        A pair is the range of what varies, with ``points`` in between, evenly in the logarithm; a longer array gives the
        points themselves.  Groups [-], or SI numbers or text with units where ``problem`` is a LineContact.  Without any
        pair the speed varies, from the boundary plateau to the hydrodynamic branch, as far as the solver reaches.
    points : int
        Number of points, 2 to 100000.
    rtol : float
        Relative tolerance of each state.
    boundary_friction, beta : float, optional
        Friction coefficient of the dry contact and coefficient of the contact law [-]; those of the contact, or 1.
    definition : {"balanced", "published"}
        Definition of the viscous friction, see :meth:`stribeck.results.Solution.friction`.
    on_point : callable, optional
        ``on_point(done, points)`` is called after each point, for progress.
    law : str or AsperityLaw, optional
        Contact law as in :func:`stribeck.solve`; that of the problem if omitted.
    method : {"solver", "atlas"}
        Whether each state is solved, or read off :mod:`stribeck.atlas`: within the stated error of its
        table, thousands of times as fast, without
        fields; ``rtol`` and ``on_point`` then have no effect.
    **parts
        ``fluid``, ``cavitation``, ``cavity_pressure``, ``flow_factors``, ``solid`` and ``slide_to_roll`` as in
        :func:`stribeck.solve`.  What depends on the speed moves along the curve; of groups, numbers of the fluid are in the
        Hertz units of the speed that the groups have.

    Returns
    -------
    StribeckCurve
        All points, ascending; after Ctrl-C those that were finished, with outcome INTERRUPTED.  Off the atlas it has no
        solutions.

    Raises
    ------
    InputError
        If an argument is outside its range, or a point outside that of the atlas.
    SolveError
        If the first state cannot be solved.

    Notes
    -----
    A few states are solved and expanded into Taylor series; the points are read off these, each within ``rtol`` by its
    estimated error.  More points cost next to nothing.

    Examples
    --------
    >>> import stribeck as sb
    >>> contact = sb.LineContact(radius=0.01, modulus=2.7e6, load=30, viscosity=0.05, speed=0.02, roughness=1e-6, alpha=2,
    ...                          beta=0.06, boundary_friction=0.7)
    >>> minimum = sb.stribeck_curve(contact).minimum
    >>> print(f"{minimum.friction:.4f} at {1e3 * minimum.speed:.1f} mm/s")
    0.0347 at 27.6 mm/s
    """
    rtol = check_rtol(rtol)
    definition = check_definition(definition)
    given: dict[Over, Any] = {"speed": speed, "load": load, "roughness": roughness}
    base, over, ends = read_problem(problem, given)
    base = with_law(base, law)
    base = with_parts(base, **parts) if parts else base
    contact = base if isinstance(base, Contact) else None
    if isinstance(base, Groups) and over == "speed":
        refuse_fixed_memory(base, "and groups hold it fixed; give a contact, or vary load or roughness.")
    boundary_friction, beta = coefficients(contact, boundary_friction, beta)
    checked_count("points", points, *POINTS_RANGE)
    given_friction: Coefficients = boundary_friction, beta, definition
    # Curves end where asperities no longer matter, which their friction at small area tells.
    at_small_area: Coefficients = as_asperity_friction(boundary_friction).coefficient_at_small_area(contact), beta, definition
    coordinate = Coordinate(over, base)
    is_solved, is_line = checked_word("method", method, get_args(Method)) == "solver", coordinate.geometry == "line"
    known = (0.0, math.inf) if contact is None else known_speeds(contact)
    if not is_solved:
        if needs_area(boundary_friction):
            raise InputError(
                "method = 'atlas' takes a friction coefficient: the atlas holds the load on asperities, not their real area "
                "of contact, on which a shear stress acts. Leave method out, which solves the curve."
            )
        if ends is None:
            groups = coordinate.groups_at(0.0)
            low, high = table_for(groups).speeds(groups)
            known = max(known[0], low / float(groups.speed)), min(known[1], high / float(groups.speed))
    grows = ends is None and is_solved and is_line and known[1] == math.inf and bool(coordinate.groups_at(0.0).roughness > 0)
    if ends is None:
        values = _automatic(coordinate, at_small_area, points, grows, known)
    elif len(ends) == 2:
        values = np.geomspace(ends[0], ends[1], points)
    else:
        values = ends
    check_inside(coordinate, values)
    if not is_solved:
        source = AtlasSource(coordinate, *values[[0, -1]].tolist())
        return StribeckCurve(values, len(values), FrictionPath(source, *given_friction))
    if not is_line:
        of_ball, reached, read = ball_source(coordinate, values, rtol, beta, on_point, has_area=needs_area(boundary_friction))
        curve = StribeckCurve(reached, len(values), FrictionPath(of_ball, *given_friction))
        vars(curve)["_points"] = read
        return curve
    places = np.log(values)
    progress = Progress(places, on_point)
    line = _line(coordinate, values, rtol)
    if grows:
        contact_part = part_of_contact(*at_small_area)
        path, lowest = grown(line, float(places[-1]), float(places[0]), contact_part, progress)
        if path.expansions:
            done = progress.done
            slowest, high = math.exp(lowest), math.exp(float(path.coordinates[-1]))
            values = np.geomspace(slowest, high, points if path.outcome.ok else max(done, 2))
            progress.places, progress.done = np.log(values), min(done, points - 1) if path.outcome.ok else len(values)
            progress(math.log(slowest), math.log(high))
    else:
        path = follow(line, float(places[-1]), float(places[0]), rtol, progress)
        if path.outcome is not Outcome.INTERRUPTED and path.expansions:
            progress.done = int((places >= path.coordinates[0]).sum())
    done = progress.done
    if not done:
        if path.outcome is Outcome.INTERRUPTED and grows:
            raise KeyboardInterrupt
        if grows:
            raise no_range(path.outcome, coordinate.groups_at(float(places[-1])))
        _refuse(line, path, coordinate.groups_at(float(places[-1])), contact)
    along = FrictionPath(LineSource(coordinate, rtol, path), *given_friction)
    return StribeckCurve(values[len(values) - done :], points if grows else len(values), along)


def _line(coordinate: Coordinate, values: Array, rtol: float) -> LineProblem | LineKnots:
    """Return the states of a line along a coordinate, between values of it."""
    direction: tuple[float, float, float] = tuple(coordinate.direction.tolist())
    # In Hertz units the model may vary with the load.
    first, last = (coordinate.groups_at(math.log(value)).model for value in (values[0], values[-1]))
    return line_problem(coordinate.groups_at, direction, rtol, first == last)


def _refuse(line: LineProblem | LineKnots, path: Any, groups: Groups, contact: Contact | None) -> NoReturn:
    """Raise the error of a path that has no state where it begins."""
    if line.failure is not None:
        finish(line.failure, groups, contact, line.tolerance)
    raise SolveError(path.outcome, None, f"{describe(groups)}: {path.outcome.value}")


@one_blas_thread
def begun(
    contact: Contact,
    over: Over,
    ends: tuple[float, float],
    rtol: float,
    definition: Definition,
    state: RefinedState | None = None,
) -> FrictionPath:
    """Return the path of a contact's own state alone, which may be continued to ``ends``; of a cylinder it may be known."""
    coordinate, value = Coordinate(over, contact), float(getattr(contact, over))
    given: Coefficients = *coefficients(contact, None, None), definition
    if coordinate.geometry != "line":
        return FrictionPath(ball_source(coordinate, np.array([value]), rtol, contact.beta, ends=np.array(ends))[0], *given)
    line, here = _line(coordinate, np.array(ends), rtol), math.log(value)
    known = None if state is None or contact.groups.model.cavitation is not Cavitation.NONE else line.begin(here, state)
    path = follow(line, here if known is None or isinstance(known, Outcome) else known, here, rtol)
    if not path.expansions:
        _refuse(line, path, coordinate.groups_at(here), contact)
    return FrictionPath(LineSource(coordinate, rtol, path), *given)


def _automatic(coordinate: Coordinate, given: Coefficients, points: int, grows: bool, known: tuple[float, float]) -> Array:
    """Return speeds from plateau to hydrodynamic branch; of a curve that ``grows`` the first is the lowest it may reach."""
    groups = coordinate.groups_at(0.0)
    if grows:
        low, high = SPEEDS[0], fastest(groups, *given[:2])
    else:
        low, high = automatic_speed_range(groups, *given)
    return np.geomspace(max(low / float(groups.speed), known[0]), min(high / float(groups.speed), known[1]), points)
