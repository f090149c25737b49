"""A curve as a function: observables, friction and their errors at any of its values, and fields on request."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from numbers import Real
from typing import Any

import numpy as np

from stribeck._types import Array, Flags
from stribeck.contacts.contact import Contact
from stribeck.contacts.friction import Definition
from stribeck.contacts.groups import contact_law
from stribeck.curves.coordinate import Coordinate
from stribeck.equations.observables import ROW, Observables, drag_parts
from stribeck.numerics.threads import one_blas_thread
from stribeck.quantities.lazy import cached_property
from stribeck.quantities.outcome import Outcome
from stribeck.quantities.outputs import ALL_NAMES, OUTPUT_TABLES
from stribeck.quantities.results import ByValue, Card, Shown, brief_text
from stribeck.quantities.units import InputError, show
from stribeck.solver.at_rest import with_positive_gap
from stribeck.solver.path.line_path import POSITION, LineProblem
from stribeck.solver.path.path import SolvedPath
from stribeck.solver.refinement import RefinedState
from stribeck.solver.solution import Solution
from stribeck.solver.solve import minimum_estimate, solution_of, state_notes

__all__ = ["CurvePoint", "CurveValues", "Progress", "rows_of", "solved_at", "within"]

COLUMNS = (*ALL_NAMES, "minimum_position")
"""Columns of a path by name."""


def _beside(path: SolvedPath, s: float) -> tuple[LineProblem, Any, Any]:
    interval = path.intervals[int(path.interval_of(np.array([s]))[0])]
    assert isinstance(interval.problem, LineProblem)
    return interval.problem, interval.left, interval.right


@one_blas_thread
def solved_at(path: SolvedPath, s: float, rtol: float | None = None, near: RefinedState | None = None) -> RefinedState:
    """Return the verified state at a coordinate of a path; without ``rtol`` the tolerance is that of the path.

    The mesh of ``near``, a state solved close by, is tried first.
    """
    problem, left, right = _beside(path, s)
    return problem.point_at(left, right, s, rtol, near)


def within(path: SolvedPath, found: Array, errors: Array, rtol: float) -> Flags:
    """Return which rows of a path have no estimated error above the tolerance."""
    exists = path.problem.controlled & np.isfinite(found).any(axis=0)
    return np.asarray((errors[:, exists] <= rtol).all(axis=1))


def rows_of(path: SolvedPath, s: Array, rtol: float) -> tuple[Array, Array]:
    """Return observables and position of the minimum at coordinates of a path, and their errors, shape (len(s), columns).

    Where the estimated error exceeds the tolerance, or there is none, the state is solved.
    """
    found, errors = path.at(s)
    for i in np.nonzero(~within(path, found, errors, rtol))[0].tolist():
        point = solved_at(path, float(s[i]), rtol)
        if point.values is not None and point.estimate is not None and point.outcome.ok:
            found[i] = *point.values.array(in_article=False), point.values.minimum_position
            errors[i, : len(point.estimate.relative)] = point.estimate.relative
            errors[i, POSITION] = point.estimate.minimum_position
    return found, errors


class Progress:
    """Counts and reports the finished points of a curve as its path grows from fast to slow."""

    def __init__(self, places: Array, on_point: Callable[[int, int], object] | None) -> None:
        self.places, self.on_point, self.done = places, on_point, 0

    def __call__(self, low: float, high: float) -> None:
        """Count those between two coordinates."""
        while self.done < len(self.places) and self.places[-1 - self.done] >= low:
            self.done += 1
            if self.on_point is not None:
                self.on_point(self.done, len(self.places))


def observed(solutions: Sequence[Any], name: str) -> Array:
    """Return a number of each of several solutions by its name, or refuse a name of none."""
    numbers = [getattr(each, name, None) if isinstance(name, str) else None for each in solutions]
    if not all(isinstance(number, Real) for number in numbers):
        known = ", ".join(OUTPUT_TABLES[solutions[0].groups.geometry].names)
        raise InputError(f"name = {show(name)}; it must be the name of a number of every solution, such as {known}.")
    return np.array(numbers)


class CurvePoint(Solution):
    """A point of a curve: its numbers come from the curve, its fields and notes from a state that is solved on first use."""

    _place: tuple[SolvedPath, float]
    _coordinate: Coordinate

    def __init__(self, coordinate: Coordinate, path: SolvedPath, s: float, row: Array, errors: Array, rtol: float) -> None:
        groups = coordinate.groups_at(s)
        values = dict(zip(COLUMNS, row.tolist(), strict=True))
        known: dict[str, Any] = {
            "groups": groups,
            "outcome": Outcome.CONVERGED,
            "rtol": rtol,
            "observables": Observables(**values),
            "relative_errors": np.maximum(errors[:POSITION], minimum_estimate(rtol, groups.model))
            / drag_parts(row[:POSITION]),
            "minimum_position_error": float(errors[POSITION]),
        }
        vars(self).update(known | {"_place": (path, s), "_coordinate": coordinate})

    @cached_property
    def contact(self) -> Contact | None:  # checking its inputs takes longer than all else here
        """The contact at this point."""
        return self._coordinate.contact_at(self._place[1])

    @cached_property
    def _solved(self) -> Solution:
        path, s = self._place
        found = solution_of(solved_at(path, s, self.rtol), self.contact, self.rtol)
        assert found is not None
        return found

    @cached_property
    def notes(self) -> tuple[str, ...]:
        """What to know before using the numbers, one sentence each."""
        path, s = self._place
        problem, left, right = _beside(path, s)
        floor = max(left.point.refined.estimate.floor, right.point.refined.estimate.floor)
        return state_notes(
            self.groups, self.contact, self.observables, lambda: problem.guess_at(left, right, s), floor, self.rtol
        )

    @property
    def law(self) -> str:  # type: ignore[override]
        """Name of the contact law."""
        return contact_law(with_positive_gap(self.groups)[0]).name

    rounding_floor = property(lambda self: self._solved.rounding_floor)
    mesh = property(lambda self: self._solved.mesh)
    nodal_gap = property(lambda self: self._solved.nodal_gap)
    gap_shift = property(lambda self: self._solved.gap_shift)
    nodal_pressures = property(lambda self: self._solved.nodal_pressures)
    newton_steps = property(lambda self: self._solved.newton_steps)
    origin = property(lambda self: self._solved.origin)


@dataclass(frozen=True, eq=False, repr=False)
class CurveValues(Shown, ByValue):
    """Observables and friction of a curve at one value, or at many."""

    value: Any  # What the curve runs over: the group [-], or SI units where the curve has a contact
    values: dict[str, Any]
    relative_errors: Array = field(repr=False)  # Estimated relative errors of the observables, by name in :attr:`errors`
    minimum_position_error: Any = field(repr=False)  # Estimated absolute error of the position of the minimum gap [a]
    friction_contact: Any  # Friction coefficient and its two parts [-]
    friction_viscous: Any  # Friction coefficient and its two parts [-]
    friction: Any  # Friction coefficient and its two parts [-]
    friction_error: Any  # Estimated absolute error of the friction coefficient [-]
    _sliding: float = field(repr=False, default=1.0)
    names: tuple[str, ...] = field(repr=False, default=ALL_NAMES)  # Of the observables that have errors, in their order

    @classmethod
    def of(cls, value: Array, found: Array, errors: Array, sliding: float, least: float) -> CurveValues:
        """Return the values held in rows of a path, without friction; numbers if ``value`` is a number."""
        relative = np.maximum(errors[:, :POSITION], least) / drag_parts(found[:, :POSITION])
        shown = (lambda column: column) if np.ndim(value) else (lambda column: float(column[0]))
        values = dict(zip(COLUMNS, found.T if np.ndim(value) else found[0].tolist(), strict=True))
        nothing = np.nan
        return cls(
            value if np.ndim(value) else float(value),
            values,
            relative if np.ndim(value) else relative[0],
            shown(errors[:, POSITION]),
            *(nothing, nothing, nothing, nothing),
            sliding,
        )

    def with_friction(self, boundary_friction: float, beta: float, definition: Definition) -> CurveValues:
        """Return the values with friction for other coefficients."""
        name = f"viscous_{definition}"
        rubbing = self._sliding * boundary_friction
        contact, viscous = rubbing * self.values["contact_load_share"], beta * self.values[name]
        of_share, of_viscous = (self.relative_errors[..., ROW[each]] for each in ("contact_load_share", name))
        error = abs(rubbing) * of_share + abs(viscous) * of_viscous
        if not np.ndim(self.value):
            error = float(error)
        return replace(
            self, friction_contact=contact, friction_viscous=viscous, friction=contact + viscous, friction_error=error
        )

    @property
    def errors(self) -> dict[str, Any]:
        """Estimated relative error of each observable; absolute for the load shares."""
        return {name: self.relative_errors[..., i] for i, name in enumerate(self.names)}

    def _card(self) -> Card:
        known = {"friction": (self.friction, self.friction_error)}
        known |= {name: (self.values[name], error) for name, error in self.errors.items() if np.isfinite(error).all()}
        rows = [(name, f"{brief_text(value)}, error {np.max(error):.1e}") for name, (value, error) in known.items()]
        return Card(f"at {brief_text(self.value)}", rows, ("Hertz units; errors of friction and load shares are absolute.",))

    def __getattr__(self, name: str) -> Any:
        """Return an observable under its own name."""
        if name != "values" and name in self.values:
            return self.values[name]
        # Of a property that fails Python asks here, and would show none of what failed.
        return object.__getattribute__(self, name)

    def __dir__(self) -> list[str]:
        """Return the names of attributes, observables among them."""
        return [*super().__dir__(), *self.values]
