"""Friction along speed, load or roughness: the Stribeck curve, its minimum and its transitions."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal, overload

import numpy as np
from numpy.typing import ArrayLike

from ._types import Array, LawShape
from .asymptotics import hydrodynamic
from .atlas_curve import AtlasCurve
from .follow import Follower, follow
from .newton import Outcome
from .parameters import QUANTITIES, Groups, LineContact
from .refine import Point
from .regimes import BOUNDARY_FLUID_SHARE, HYDRODYNAMIC_CONTACT_SHARE, Method, Regime, check_method, regime_of
from .sensitivity import GROUPS, friction_slopes
from .solution import Definition, Solution, check_definition, coefficients
from .solve import SolveError, as_groups, check_rtol, describe, finish, solution_of, with_law
from .span import automatic_speeds
from .threads import one_blas_thread
from .units import InputError, format_si, show, to_si

if TYPE_CHECKING:
    import xarray

Over = Literal["speed", "load", "roughness"]

LOCATION_TOLERANCE = 1e-9
"""Relative tolerance to which a minimum or a transition is located; its own error is that of the solved states."""

WIDENINGS = (0, 2, 8, 32, 128)
"""Points by which the search for a landmark widens on both sides."""

POINTS_RANGE = (2, 100_000)


@dataclass(frozen=True)
class Landmark:
    """A state of note on a curve: where it lies and the solution there.

    Attributes
    ----------
    name : str
        What it is, in words.
    value : float
        Where along the curve: group [-], or SI where the curve has a contact.
    friction : float
        Total friction coefficient there [-].
    solution : Solution
        The state.
    """

    name: str
    value: float
    friction: float
    solution: Solution = field(repr=False)


@dataclass(frozen=True, eq=False)
class StribeckCurve:
    """Converged states along one coordinate, and the friction on them.

    Attributes
    ----------
    over : {"speed", "load", "roughness"}
        What varies.
    values : ndarray, shape (n,)
        Where the points lie, ascending: the group [-], or SI units where the curve has a contact.
    solutions : tuple of Solution
        The state of each point.
    contact : LineContact or None
        The contact, at its own speed, load and roughness.
    mu0, beta : float
        Friction coefficient of the dry contact and coefficient of the contact law [-].
    definition : {"paper", "balanced"}
        Definition of the viscous friction.
    rtol : float
        Relative tolerance of each state.
    outcome : Outcome
        CONVERGED, or why points are missing.
    requested : int
        Points asked for.
    """

    over: Over
    values: Array
    solutions: tuple[Solution, ...]
    contact: LineContact | None
    mu0: float
    beta: float
    definition: Definition
    rtol: float
    outcome: Outcome
    requested: int
    _points: tuple[Point, ...] = field(repr=False)
    _path: _Coordinate = field(repr=False)

    def __len__(self) -> int:
        """Return the number of points."""
        return len(self.solutions)

    @property
    def groups(self) -> Groups:
        """Groups of the points, as arrays."""
        columns = (np.array([float(getattr(s.groups, name)) for s in self.solutions]) for name in GROUPS)
        return Groups(*columns, law=self.law)

    @property
    def law(self) -> LawShape | None:
        """Contact law of all points; None is the exponential one."""
        return self._path.base.law

    def observable(self, name: str) -> Array:
        """Return an attribute of every solution as an array.

        Parameters
        ----------
        name : str
            Name of a number that :class:`Solution` has, such as ``"central_gap"``.

        Returns
        -------
        ndarray, shape (n,)
            Its values, in the order of :attr:`values`.
        """
        return np.array([getattr(s, name) for s in self.solutions])

    @cached_property
    def _friction(self) -> Array:
        found = [s.friction(self.mu0, self.beta, self.definition) for s in self.solutions]
        return np.array([[f.contact, f.viscous, f.total, f.error] for f in found]).reshape(-1, 4)

    @property
    def friction_contact(self) -> Array:
        """Contact part of the friction coefficient [-]."""
        return np.asarray(self._friction[:, 0])

    @property
    def friction_viscous(self) -> Array:
        """Viscous part of the friction coefficient [-]."""
        return np.asarray(self._friction[:, 1])

    @property
    def friction(self) -> Array:
        """Friction coefficient [-]."""
        return np.asarray(self._friction[:, 2])

    @property
    def friction_error(self) -> Array:
        """Estimated absolute error of the friction coefficient [-]."""
        return np.asarray(self._friction[:, 3])

    @property
    def hersey_number(self) -> Array:
        """Hersey number eta U/F_N of the points [-]."""
        return np.asarray(self.groups.hersey_number(self.beta))

    @property
    def hydrodynamic_friction(self) -> Array:
        """Friction of smooth surfaces by the paper's law, the abscissa of its second representation [-]."""
        return np.asarray(hydrodynamic.friction(self.groups, self.beta))

    @property
    def regimes(self) -> tuple[Regime, ...]:
        """Lubrication regime of each point."""
        shares = zip(self.observable("fluid_load_share"), self.friction_contact, self.friction, strict=True)
        return tuple(regime_of(fluid, contact / total if total > 0 else 0.0) for fluid, contact, total in shares)

    @cached_property
    def regime_ranges(self) -> tuple[tuple[Regime, float, float], ...]:
        """Regimes along the curve, ascending: name, and the values between which it holds.

        They meet at a located transition where there is one, else in the middle between two points.
        """
        regimes = self.regimes
        edges = [float(self.values[0])]
        names = [regimes[0]]
        marks = [mark.value for mark in self.transitions if mark is not self.minimum]
        for i in range(1, len(self)):
            if regimes[i] != names[-1]:
                low, high = float(self.values[i - 1]), float(self.values[i])
                edges.append(next((value for value in marks if low <= value <= high), math.sqrt(low * high)))
                names.append(regimes[i])
        return tuple(zip(names, edges, [*edges[1:], float(self.values[-1])], strict=True))

    @property
    def error_estimate(self) -> float:
        """Largest estimated relative error over all points."""
        return max((s.error_estimate for s in self.solutions), default=math.nan)

    @property
    def notes(self) -> tuple[str, ...]:
        """What to know before using the numbers; each sentence says which points it concerns."""
        found: dict[str, list[tuple[float, str]]] = {}
        for value, solution in zip(self.values.tolist(), self.solutions, strict=True):
            for note in solution.notes:
                # The numbers in it, which differ from point to point, are those of the first point.
                kind = re.sub(r"[-+]?[0-9][-+.0-9e]*", "", note)
                found.setdefault(kind, []).append((value, note))
        return tuple(self._note(points) for points in found.values())

    def _note(self, points: list[tuple[float, str]]) -> str:
        first, last = points[0][0], points[-1][0]
        if self.contact is None:
            where = f"{self.over} group {first:.3g} to {last:.3g}"
        else:
            ends = (format_si(value, QUANTITIES[self.over].dimension) for value in (first, last))
            where = f"{self.over} {' to '.join(ends)}"
        return f"{points[0][1]} ({len(points)} of {len(self)} points, {where}.)"

    @cached_property
    def minimum(self) -> Landmark | None:
        """The friction minimum, located on solved states where the slope vanishes; None where the curve has none inside."""
        moves = bool(np.all(np.asarray(self.groups.speed) > 0))  # at rest friction is that of the dry contact throughout
        i = int(np.argmin(self.friction)) if moves and len(self) > 2 else 0
        if not 0 < i < len(self) - 1:
            return None

        def slope(point: Point) -> float:
            assert point.state is not None
            slopes = friction_slopes(point.state, self.mu0, self.beta, self.definition)
            return float(slopes @ self._path.direction)

        return self._locate("minimum of friction", i - 1, i + 1, slope)

    @cached_property
    def transitions(self) -> tuple[Landmark, ...]:
        """The boundaries between regimes, where the load is shared in halves, and the friction minimum.

        As far as the curve holds them, ascending: where the fluid carries 5 % and 50 % of the load, where asperities cause
        10 % of the friction, and where friction is least.
        """
        fluid = self.observable("fluid_load_share")
        contact = self.friction_contact / np.maximum(self.friction, 1e-300)
        found = [self.minimum]

        def cross(name: str, line: float, values: Array, of: Callable[[Point], float]) -> None:
            crossings = np.nonzero(np.diff(np.sign(values - line)))[0]
            if len(crossings):
                i = int(crossings[0])
                found.append(self._locate(name.format(line), i, i + 1, lambda point: of(point) - line))

        cross("fluid carries {:.0%} of the load", BOUNDARY_FLUID_SHARE, fluid, _fluid)
        cross("fluid carries {:.0%} of the load", 0.5, fluid, _fluid)
        cross("asperities cause {:.0%} of the friction", HYDRODYNAMIC_CONTACT_SHARE, contact, self._contact_part)
        return tuple(sorted((mark for mark in found if mark is not None), key=lambda mark: mark.value))

    def _contact_part(self, point: Point) -> float:
        assert point.values is not None
        contact = self.mu0 * point.values.contact_load_share
        return contact / (contact + self.beta * float(getattr(point.values, f"viscous_{self.definition}")))

    @one_blas_thread
    def _locate(self, name: str, first: int, last: int, function: Callable[[Point], float]) -> Landmark | None:
        """Return the landmark where ``function`` of the solved state vanishes between two points, or None.

        Where points are dense their own errors hide between which two it is: the search then widens.
        """
        follower = Follower(self._path.groups_at, min(self.rtol, 1e-8))
        solved: dict[float, Point] = {}
        found: dict[float, float] = {}

        def at(s: float) -> float:
            # The search asks for its ends twice, where another prediction would round otherwise and may turn a sign.
            if s in found:
                return found[s]
            nearest = sorted(known, key=lambda pair: -abs(pair[0] - s))
            point = follower(s, nearest[-3:])
            if point is None or point.state is None:
                raise SolveError(Outcome.PATH_LOST, None, f"{describe(self._path.groups_at(s))}: {Outcome.PATH_LOST.value}")
            solved[s] = point
            found[s] = function(point)
            return found[s]

        for wider in WIDENINGS:
            ends = max(0, first - wider), min(len(self) - 1, last + wider)
            known = [(float(np.log(self.values[i])), self._points[i]) for i in range(ends[0], ends[1] + 1)]
            low, high = known[0][0], known[-1][0]
            if at(low) * at(high) <= 0:
                break
        else:
            return None
        # Imported here because it takes longer than the rest of the package, and few uses get here.
        from scipy.optimize import brentq

        s = float(brentq(at, low, high, xtol=LOCATION_TOLERANCE, rtol=1e-14))
        if s not in solved:
            at(s)
        solution = solution_of(solved[s], self._path.contact_at(s), self.rtol)
        assert solution is not None
        friction = solution.friction(self.mu0, self.beta, self.definition).total
        return Landmark(name, math.exp(s), friction, solution)

    def to_dataset(self) -> xarray.Dataset:
        """Return the curve as an xarray Dataset.

        Returns
        -------
        xarray.Dataset
            Observables, friction, regimes and inputs of each point, with units and long names as attributes;
            needs the extra ``data``.
        """
        from .store import curve_dataset

        return curve_dataset(self)

    def to_netcdf(self, path: Any, *, force: bool = False) -> None:
        """Write the curve as NetCDF.

        Parameters
        ----------
        path : str or path-like
            The file.
        force : bool
            Whether an existing file is replaced; else it is kept and the call refused.

        Raises
        ------
        InputError
            If the file cannot be written, or exists and ``force`` is not given.
        """
        from .store import write_netcdf

        write_netcdf(self.to_dataset(), path, force=force)

    def to_csv(self, path: Any, *, force: bool = False) -> None:
        """Write the curve as CSV.

        Parameters
        ----------
        path : str or path-like
            The file.
        force : bool
            Whether an existing file is replaced; else it is kept and the call refused.

        Raises
        ------
        InputError
            If the file cannot be written, or exists and ``force`` is not given.
        """
        from .store import write_csv

        write_csv(self.to_dataset(), path, force=force)

    def plot(self, path: Any = None, *, force: bool = False) -> Any:
        """Draw the curve.

        Parameters
        ----------
        path : str or path-like, optional
            Image file to write as well, its format by its ending.
        force : bool
            Whether an existing file is replaced; else it is kept and the call refused.

        Returns
        -------
        matplotlib.figure.Figure
            The figure; needs the extra ``plot``.

        Raises
        ------
        InputError
            If the file cannot be written, or exists and ``force`` is not given.
        """
        from .plotting import plot_curve

        return plot_curve(self, path, force=force)


def _fluid(point: Point) -> float:
    assert point.values is not None
    return point.values.fluid_load_share


@dataclass(frozen=True)
class _Coordinate:
    """What a curve runs along: the logarithm of one group, or of one SI quantity of a contact."""

    over: Over
    base: Groups | LineContact

    def contact_at(self, s: float) -> LineContact | None:
        """Return the contact at coordinate s."""
        return self.base.replace(**{self.over: math.exp(s)}) if isinstance(self.base, LineContact) else None

    def groups_at(self, s: float) -> Groups:
        """Return the groups at coordinate s."""
        contact = self.contact_at(s)
        if contact is not None:
            return contact.groups
        assert isinstance(self.base, Groups)
        varied: dict[str, Any] = {self.over: math.exp(s)}
        return replace(self.base, **varied)

    def groups_along(self, values: Array) -> Groups:
        """Return the groups at many values of what varies, as arrays."""
        groups = [self.groups_at(s) for s in np.log(values).tolist()]
        return Groups(*(np.array([float(getattr(g, name)) for g in groups]) for name in GROUPS), law=self.base.law)

    @property
    def direction(self) -> Array:
        """Derivatives of ln(speed), ln(load), ln(roughness) of the groups along s."""
        if isinstance(self.base, LineContact) and self.over == "load":
            return np.array([-2.0, 1.0, 0.0])
        return np.array([1.0 if name == self.over else 0.0 for name in GROUPS])


@overload
def stribeck_curve(
    problem: LineContact | Groups | None = ...,
    *,
    speed: ArrayLike | Sequence[str] | None = ...,
    load: ArrayLike | Sequence[str] | None = ...,
    roughness: ArrayLike | Sequence[str] | None = ...,
    points: int = ...,
    rtol: float = ...,
    mu0: float | None = ...,
    beta: float | None = ...,
    definition: Definition = ...,
    on_point: Callable[[int, int], object] | None = ...,
    law: str | LawShape | None = ...,
    method: Literal["solver"] = ...,
) -> StribeckCurve: ...


@overload
def stribeck_curve(
    problem: LineContact | Groups | None = ...,
    *,
    speed: ArrayLike | Sequence[str] | None = ...,
    load: ArrayLike | Sequence[str] | None = ...,
    roughness: ArrayLike | Sequence[str] | None = ...,
    points: int = ...,
    rtol: float = ...,
    mu0: float | None = ...,
    beta: float | None = ...,
    definition: Definition = ...,
    on_point: Callable[[int, int], object] | None = ...,
    law: str | LawShape | None = ...,
    method: Literal["atlas"],
) -> AtlasCurve: ...


@one_blas_thread
def stribeck_curve(
    problem: LineContact | Groups | None = None,
    *,
    speed: ArrayLike | Sequence[str] | None = None,
    load: ArrayLike | Sequence[str] | None = None,
    roughness: ArrayLike | Sequence[str] | None = None,
    points: int = 101,
    rtol: float = 1e-6,
    mu0: float | None = None,
    beta: float | None = None,
    definition: Definition = "paper",
    on_point: Callable[[int, int], object] | None = None,
    law: str | LawShape | None = None,
    method: Method = "solver",
) -> StribeckCurve | AtlasCurve:
    """Solve the contact along speed, load or roughness.

    Parameters
    ----------
    problem : LineContact or Groups, optional
        The contact; what varies in it is replaced.  Without it the other two groups are given as keywords.
    speed, load, roughness : float, or (low, high), or array_like, optional
        A pair is the range of what varies, with ``points`` in between, evenly in the logarithm; a longer array gives the
        points themselves.  Groups [-], or SI numbers or text with units where ``problem`` is a LineContact.  Without any
        pair the speed varies, from the boundary plateau to the hydrodynamic branch, as far as the solver reaches.
    points : int
        Number of points, 2 to 100000.
    rtol : float
        Relative tolerance of each state.
    mu0, beta : float, optional
        Friction coefficient of the dry contact and coefficient of the contact law [-]; those of the contact, or 1.
    definition : {"paper", "balanced"}
        Definition of the viscous friction, see :meth:`Solution.friction`.
    on_point : callable, optional
        ``on_point(done, points)`` is called after each point, for progress.
    law : str or LawShape, optional
        Contact law as in :func:`stribeck.solve`; that of the problem if omitted.
    method : {"solver", "atlas"}
        Whether each state is solved, or read off :mod:`stribeck.atlas`: within 1e-4, thousands of times as fast, without
        fields; ``rtol`` and ``on_point`` then have no effect.

    Returns
    -------
    StribeckCurve
        All points, ascending; after Ctrl-C those that were finished, with outcome INTERRUPTED. From the atlas an
        :class:`stribeck.atlas_curve.AtlasCurve`, with the same values, friction, observables, minimum and transitions.

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
    base, over, ends = _problem(problem, given)
    base = with_law(base, law)
    contact = base if isinstance(base, LineContact) else None
    mu0, beta = coefficients(contact, mu0, beta)
    if isinstance(points, bool) or not isinstance(points, int) or not POINTS_RANGE[0] <= points <= POINTS_RANGE[1]:
        raise InputError(f"points = {show(points)}; it must be a whole number from {POINTS_RANGE[0]} to {POINTS_RANGE[1]}.")
    coordinate = _Coordinate(over, base)
    if ends is None:
        values = _automatic(coordinate, mu0, beta, definition, points)
    elif len(ends) == 2:
        values = np.geomspace(ends[0], ends[1], points)
    else:
        values = ends
    _check_inside(coordinate, values)
    if check_method(method) == "atlas":
        return AtlasCurve(over, values, coordinate.groups_along, contact, mu0, beta, definition)
    descending = values[::-1]
    done = 0
    targets = np.log(descending)
    wanted = set(targets.tolist())

    def report(s: float, point: Point) -> None:
        nonlocal done
        if s in wanted and on_point is not None:
            done += 1
            on_point(done, len(values))

    path = follow(coordinate.groups_at, targets.tolist(), rtol, report)
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
        mu0=mu0,
        beta=beta,
        definition=definition,
        rtol=rtol,
        outcome=path.outcome if path.failure is None or path.outcome is not Outcome.PATH_LOST else path.failure.outcome,
        requested=len(values),
        _points=tuple(kept),
        _path=coordinate,
    )


def _problem(problem: LineContact | Groups | None, given: dict[Over, Any]) -> tuple[LineContact | Groups, Over, Array | None]:
    """Return what stays fixed, what varies, and its ends or points; None where they are to be found."""
    ranges = [name for name, value in given.items() if value is not None and np.ndim(value) > 0]
    if len(ranges) > 1:
        raise InputError(f"{' and '.join(ranges)} are both ranges; a curve varies one of speed, load and roughness.")
    over: Over = ranges[0] if ranges else "speed"
    fixed = {name: value for name, value in given.items() if value is not None and name not in ranges}
    if problem is None:
        missing = [name for name in GROUPS if name != over and name not in fixed]
        if missing:
            raise InputError(f"{' and '.join(missing)} missing; give a LineContact, or the groups that do not vary.")
        low = 1.0 if not ranges else float(np.asarray(given[over], dtype=float).ravel()[0])
        base: LineContact | Groups = Groups(**{**fixed, over: low})
    elif isinstance(problem, LineContact):
        base = problem.replace(**fixed) if fixed else problem
    else:
        as_groups(problem)
        base = replace(problem, **fixed)
    if not ranges:
        return base, over, None
    return base, over, _ends(over, given[over], isinstance(base, LineContact))


def _ends(over: Over, value: Any, si: bool) -> Array:
    """Return the ends or points of a range as ascending positive numbers."""
    items = [value] if isinstance(value, str) else list(value)
    if si:
        numbers = [to_si(item, QUANTITIES[over].dimension, over) for item in items]
    else:
        try:
            numbers = [float(item) for item in items]
        except (TypeError, ValueError):
            raise InputError(f"{over} = {show(value)}; a range of groups is made of plain numbers.") from None
    found = np.asarray(numbers)
    if len(found) < 2 or not np.isfinite(found).all() or not (found > 0).all() or not (np.diff(found) > 0).all():
        raise InputError(
            f"{over} = {show(value)}; a range is two or more finite positive numbers that ascend, such as (1e-9, 10)."
        )
    return found


def _automatic(coordinate: _Coordinate, mu0: float, beta: float, definition: Definition, points: int) -> Array:
    """Return speeds from the boundary plateau to the hydrodynamic branch, evenly in the logarithm."""
    groups = coordinate.groups_at(0.0)
    low, high = automatic_speeds(groups, mu0, beta, definition)
    return np.geomspace(low / float(groups.speed), high / float(groups.speed), points)


def _check_inside(coordinate: _Coordinate, values: Array) -> None:
    """Refuse a range whose groups cannot be formed."""
    for value in (values[0], values[-1]):
        groups = coordinate.groups_at(math.log(value))
        if groups.speed == 0 and groups.roughness == 0:
            raise InputError("speed and roughness are both zero; the dry smooth contact has no curve, use solve.")
