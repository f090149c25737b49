"""The solver along speed, load or roughness: the states of a Stribeck curve, by continuation or off the atlas."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any, Literal, overload

import numpy as np
from numpy.typing import ArrayLike

from stribeck._types import Array
from stribeck.contact_laws.law import AsperityLaw
from stribeck.contacts.contact import Contact
from stribeck.contacts.friction import Definition, check_definition, coefficients
from stribeck.contacts.groups import Groups
from stribeck.contacts.with_parts import refuse_fixed_memory, with_parts
from stribeck.curves.atlas_curve import AtlasCurve
from stribeck.curves.base_curve import END_ROUNDING
from stribeck.curves.coordinate import Coordinate, Over, check_inside, check_points, read_problem
from stribeck.curves.function import Progress
from stribeck.curves.landmarks import Landmark
from stribeck.curves.regime import Method, check_method
from stribeck.curves.result import StribeckCurve
from stribeck.curves.speed_range import SPEEDS, automatic_speed_range, fastest, grown, no_range, part_of_contact
from stribeck.numerics.threads import one_blas_thread
from stribeck.quantities.keywords import answers_typos
from stribeck.quantities.outcome import Outcome
from stribeck.solver.cavities.reforming_line import line_problem
from stribeck.solver.path.path import follow
from stribeck.solver.solve import check_rtol, finish, with_law
from stribeck.solver.solve_error import SolveError, describe

__all__ = ["Landmark", "StribeckCurve", "stribeck_curve"]


@overload
def stribeck_curve(
    problem: Contact | Groups | None = ...,
    *,
    speed: ArrayLike | Sequence[str] | None = ...,
    load: ArrayLike | Sequence[str] | None = ...,
    roughness: ArrayLike | Sequence[str] | None = ...,
    points: int = ...,
    rtol: float = ...,
    boundary_friction: float | None = ...,
    beta: float | None = ...,
    definition: Definition = ...,
    on_point: Callable[[int, int], object] | None = ...,
    law: str | AsperityLaw | None = ...,
    method: Literal["solver"] = ...,
    **parts: Any,
) -> StribeckCurve: ...


@overload
def stribeck_curve(
    problem: Contact | Groups | None = ...,
    *,
    speed: ArrayLike | Sequence[str] | None = ...,
    load: ArrayLike | Sequence[str] | None = ...,
    roughness: ArrayLike | Sequence[str] | None = ...,
    points: int = ...,
    rtol: float = ...,
    boundary_friction: float | None = ...,
    beta: float | None = ...,
    definition: Definition = ...,
    on_point: Callable[[int, int], object] | None = ...,
    law: str | AsperityLaw | None = ...,
    method: Literal["atlas"],
    **parts: Any,
) -> AtlasCurve: ...


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
) -> StribeckCurve | AtlasCurve:
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
        Definition of the viscous friction, see :meth:`Solution.friction`.
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
        All points, ascending; after Ctrl-C those that were finished, with outcome INTERRUPTED. From the atlas an
        :class:`stribeck.curves.atlas_curve.AtlasCurve`, with the same values, friction, observables, minimum and transitions.

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
    check_points(points)
    coordinate = Coordinate(over, base)
    grows = ends is None and check_method(method) == "solver" and coordinate.geometry not in CURVES
    grows = grows and bool(coordinate.groups_at(0.0).roughness > 0)
    if ends is None:
        values = _automatic(coordinate, boundary_friction, beta, definition, points, grows)
    elif len(ends) == 2:
        values = np.geomspace(ends[0], ends[1], points)
    else:
        values = ends
    check_inside(coordinate, values)
    if check_method(method) == "atlas":
        return AtlasCurve(over, values, coordinate.groups_along, contact, boundary_friction, beta, definition)
    if coordinate.geometry in CURVES:
        trace, _ = CURVES[coordinate.geometry]()
        settings = {"boundary_friction": boundary_friction, "beta": beta, "definition": definition}
        found_curve: StribeckCurve = trace(coordinate, values, rtol, on_point, **settings)
        return found_curve
    places = np.log(values)
    progress = Progress(places, on_point)
    direction: tuple[float, float, float] = tuple(coordinate.direction.tolist())
    line = line_problem(coordinate.groups_at, direction, rtol, coordinate.is_uniform(values))
    if grows:
        contact_part = part_of_contact(boundary_friction, beta, definition)
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
        groups = coordinate.groups_at(float(places[-1]))
        if grows:
            raise no_range(path.outcome, groups)
        if line.failure is not None:
            finish(line.failure, groups, contact, rtol)
        raise SolveError(path.outcome, None, f"{describe(groups)}: {path.outcome.value}")
    return StribeckCurve(
        over=over,
        values=values[len(values) - done :],
        contact=contact,
        boundary_friction=boundary_friction,
        beta=beta,
        definition=definition,
        rtol=rtol,
        outcome=path.outcome,
        requested=points if grows else len(values),
        _path=coordinate,
        _function=path,
    )


@one_blas_thread
def continued(
    curve: StribeckCurve,
    end: float,
    points: int,
    on_point: Callable[[int, int], object] | None = None,
    span: float = math.inf,
) -> StribeckCurve:
    """Continue a curve from its nearer end towards ``end``, without a cold start."""

    def report(low: float, high: float) -> None:
        if on_point is not None:
            on_point(0, points)

    path = curve._function.continued(math.log(end), curve.rtol, report, math.log(span))
    begin = math.exp(path.coordinates[0 if end > curve.values[0] else -1])
    low, high = np.exp(path.coordinates[[0, -1]]) if path.outcome.ok else sorted((begin, end))
    values = np.geomspace(low, high, points)
    reached = np.exp(path.coordinates[[0, -1]]) * (1 - END_ROUNDING, 1 + END_ROUNDING)
    inside = values[(values >= reached[0]) & (values <= reached[1])]
    return curve._along(path, inside, points)


def _of_ball() -> tuple[Callable[..., StribeckCurve], Callable[..., tuple[float, float]]]:
    from stribeck.curves.point_curve import point_curve, point_speeds

    return point_curve, point_speeds


CURVES = {"point": _of_ball}
"""How curves are traced, and where they begin and end, for geometries other than the line."""


def _automatic(
    coordinate: Coordinate, boundary_friction: float, beta: float, definition: Definition, points: int, grows: bool
) -> Array:
    """Return speeds from the boundary plateau to the hydrodynamic branch, evenly in the logarithm.

    If the curve ``grows`` until it finds its ends, the first speed is the lowest that it may reach.
    """
    groups = coordinate.groups_at(0.0)
    if grows:
        low, high = SPEEDS[0], fastest(groups, boundary_friction, beta)
    else:
        ends = CURVES[coordinate.geometry]()[1] if coordinate.geometry in CURVES else automatic_speed_range
        low, high = ends(groups, boundary_friction, beta, definition)
    return np.geomspace(low / float(groups.speed), high / float(groups.speed), points)
