"""The solver along speed, load or roughness: the states of a Stribeck curve, by continuation or off the atlas."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Literal, overload

import numpy as np
from numpy.typing import ArrayLike

from stribeck._types import Array
from stribeck.contact_laws.law import AsperityLaw
from stribeck.contacts.contact import Contact
from stribeck.contacts.friction import Definition, check_definition, coefficients
from stribeck.contacts.groups import Groups
from stribeck.contacts.with_parts import check_solid, with_parts
from stribeck.curves.atlas_curve import AtlasCurve
from stribeck.curves.coordinate import Coordinate, Over, check_inside, read_problem
from stribeck.curves.landmarks import Landmark
from stribeck.curves.regime import Method, check_method
from stribeck.curves.result import StribeckCurve
from stribeck.curves.speed_range import automatic_speed_range
from stribeck.numerics.threads import one_blas_thread
from stribeck.quantities.inputs import refuse_former
from stribeck.quantities.outcome import Outcome
from stribeck.quantities.units import InputError, show
from stribeck.solver.path import solve_along
from stribeck.solver.refinement import RefinedState
from stribeck.solver.solve import SolveError, check_rtol, describe, finish, solution_of, with_law

__all__ = ["Landmark", "StribeckCurve", "stribeck_curve"]

POINTS_RANGE = (2, 100_000)


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


@refuse_former
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
        Whether each state is solved, or read off :mod:`stribeck.atlas`: within 1e-4, thousands of times as fast, without
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
    States follow one another by continuation; each meets ``rtol`` by its own error estimate.
    """
    check_rtol(rtol)
    definition = check_definition(definition)
    given: dict[Over, Any] = {"speed": speed, "load": load, "roughness": roughness}
    base, over, ends = read_problem(problem, given)
    base = with_law(base, law)
    base = with_parts(base, **parts) if parts else base
    check_solid(base)
    contact = base if isinstance(base, Contact) else None
    boundary_friction, beta = coefficients(contact, boundary_friction, beta)
    if isinstance(points, bool) or not isinstance(points, int) or not POINTS_RANGE[0] <= points <= POINTS_RANGE[1]:
        raise InputError(f"points = {show(points)}; it must be a whole number from {POINTS_RANGE[0]} to {POINTS_RANGE[1]}.")
    coordinate = Coordinate(over, base)
    if ends is None:
        values = _automatic(coordinate, boundary_friction, beta, definition, points)
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
    descending = values[::-1]
    done = 0
    targets = np.log(descending)
    wanted = set(targets.tolist())

    def report(s: float, point: RefinedState) -> None:
        nonlocal done
        if s in wanted and on_point is not None:
            done += 1
            on_point(done, len(values))

    path = solve_along(coordinate.groups_at, targets.tolist(), rtol, report)
    found = {s: p for s, p in zip(path.coordinates, path.states, strict=True) if s in wanted}
    if not found:
        if path.failure is not None:
            finish(path.failure, coordinate.groups_at(float(targets[0])), contact, rtol)
        raise SolveError(path.outcome, None, f"{describe(coordinate.groups_at(float(targets[0])))}: {path.outcome.value}")
    solutions, kept, where = [], [], []
    for value, s in zip(values, targets[::-1].tolist(), strict=True):
        if s in found:
            solution = solution_of(found[s], coordinate.contact_at(s), rtol)
            assert solution is not None
            solutions.append(solution)
            kept.append(found[s])
            where.append(value)
    return StribeckCurve(
        over=over,
        values=np.array(where),
        solutions=tuple(solutions),
        contact=contact,
        boundary_friction=boundary_friction,
        beta=beta,
        definition=definition,
        rtol=rtol,
        outcome=path.outcome if path.failure is None or path.outcome is not Outcome.PATH_LOST else path.failure.outcome,
        requested=len(values),
        _points=tuple(kept),
        _path=coordinate,
    )


def _of_ball() -> tuple[Callable[..., StribeckCurve], Callable[..., tuple[float, float]]]:
    from stribeck.curves.point_curve import point_curve, point_speeds

    return point_curve, point_speeds


CURVES = {"point": _of_ball}
"""How curves are traced and where they begin and end, by geometry, beside the line."""


def _automatic(coordinate: Coordinate, boundary_friction: float, beta: float, definition: Definition, points: int) -> Array:
    """Return speeds from the boundary plateau to the hydrodynamic branch, evenly in the logarithm."""
    groups = coordinate.groups_at(0.0)
    ends = CURVES[coordinate.geometry]()[1] if coordinate.geometry in CURVES else automatic_speed_range
    low, high = ends(groups, boundary_friction, beta, definition)
    return np.geomspace(low / float(groups.speed), high / float(groups.speed), points)
