"""Curves of cylinders: observables off Taylor series, and states that are solved where they are asked for."""

from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

import numpy as np

from stribeck._types import Array, Flags
from stribeck.asperity_friction.coulomb import as_asperity_friction
from stribeck.asperity_friction.law import AsperityFriction
from stribeck.contacts.contact import Contact
from stribeck.contacts.friction import Definition, sliding_part
from stribeck.contacts.groups import contact_law
from stribeck.curves.coordinate import Coordinate
from stribeck.curves.source import Coefficients, Parts, Readings, Source
from stribeck.equations.observables import ROW, Observables, drag_parts
from stribeck.equations.sensitivity import derivatives_along
from stribeck.numerics.dual import Dual, slope_of, value_of
from stribeck.quantities.lazy import cached_property
from stribeck.quantities.outcome import Outcome
from stribeck.quantities.outputs import ALL_NAMES
from stribeck.solver.at_rest import with_positive_gap
from stribeck.solver.path.line_knots import COLUMNS, POSITION
from stribeck.solver.refinement import RefinedState
from stribeck.solver.solution import Solution
from stribeck.solver.solve import check_rtol, finish, solution_of, state_notes, stated_errors
from stribeck.solver.solve_error import SolveError, describe

MAX_STATE_RTOL = 1e-6  # Largest rtol of a landmark's state unless another is asked for: landmarks are a curve's headline
FIELD_LOG_STEP = 1e-3  # Step of ln(value) in differences of what follows from fields between states


class CurvePoint(Solution):
    """A point of a curve: its numbers come from the curve, its fields and notes from a state that is solved on first use."""

    _place: tuple[Any, float]
    _coordinate: Coordinate

    def __init__(self, coordinate: Coordinate, path: Any, s: float, row: Array, errors: Array, rtol: float) -> None:
        groups = coordinate.groups_at(s)
        values = dict(zip(COLUMNS, row.tolist(), strict=True))
        known: dict[str, Any] = {
            "groups": groups,
            "outcome": Outcome.CONVERGED,
            "rtol": rtol,
            "observables": Observables(**values),
            "relative_errors": stated_errors(errors[:POSITION], row[:POSITION], groups, rtol),
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
        found = solution_of(path.problem.point_at(path, s, self.rtol), self.contact, self.rtol)
        assert found is not None
        return found

    @cached_property
    def notes(self) -> tuple[str, ...]:
        """What to know before using the numbers, one sentence each."""
        path, s = self._place
        floor = max(each.state.estimate.floor for each in path.around(s))
        return state_notes(
            self.groups, self.contact, self.observables, lambda: path.problem.guess_at(path, s), floor, self.rtol
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


@dataclass(frozen=True, eq=False)
class LineSource(Source):
    """Numbers of a cylinder along a path of Taylor series."""

    coordinate: Coordinate
    rtol: float
    path: Any = field(compare=False)  # Of Taylor series, or of solved states with their slopes

    has_state_slopes = True

    @cached_property
    def sliding(self) -> float:
        """Fraction of the sliding friction of asperities that acts, with its sign."""
        return float(sliding_part(2 * self.coordinate.groups_at(0.0).model.film.slide))

    @cached_property
    def _states(self) -> dict[tuple[float, float], RefinedState]:
        return {}

    def _within(self, found: Array, errors: Array, rtol: float) -> Flags:
        """Return which rows have no estimated error above the tolerance."""
        exists = self.path.problem.controlled & np.isfinite(found).any(axis=0)
        return np.asarray((errors[:, exists] <= rtol).all(axis=1))

    def read(self, s: Array, rtol: float | None = None) -> Readings:
        """Return rows at places; with a tolerance, a state is solved where no error is known within it."""
        found, errors = self.path.at(s)
        for i in [] if rtol is None else np.nonzero(~self._within(found, errors, rtol))[0].tolist():
            point = self.path.problem.point_at(self.path, float(s[i]), rtol)
            if point.values is not None and point.estimate is not None and point.outcome.ok:
                found[i] = *point.values.array(), point.values.minimum_position
                errors[i, : len(point.estimate.relative)] = point.estimate.relative
                errors[i, POSITION] = point.estimate.minimum_position
        return self._readings(s, found, errors, self.rtol if rtol is None else rtol)

    def _readings(self, s: Array, found: Array, errors: Array, rtol: float) -> Readings:
        """Return rows of the path, shape (n, columns), and their errors, with the friction that follows from both."""
        values = found[:, :POSITION]
        relative = stated_errors(errors[:, :POSITION], values, self.coordinate.groups_at(0.0), self.rtol)
        return Readings(
            names=ALL_NAMES,
            values=dict(zip(COLUMNS, found.T, strict=True)),
            relative_errors=relative,
            position_error=errors[:, POSITION],
            error_estimate=float(np.nanmax(relative * drag_parts(values), initial=0.0)) if len(s) else np.nan,
            terms=partial(self._terms, s),
            made=partial(self._points, s, found, errors, rtol),
        )

    def _points(self, s: Array, found: Array, errors: Array, rtol: float) -> list[CurvePoint]:
        """Return the solutions at places."""
        rows = zip(s.tolist(), found, errors, strict=True)
        return [CurvePoint(self.coordinate, self.path, at, row, error, rtol) for at, row, error in rows]

    def _terms(self, s: Array, read: Readings, boundary_friction: Any, beta: float, definition: Definition) -> Array:
        """Return both parts of the friction at places, their sum and its error, shape (n, 4)."""
        friction, viscous = as_asperity_friction(boundary_friction), f"viscous_{definition}"
        rubbing, of = self.sliding * self.factors(friction, s), read.relative_errors[:, ROW[viscous]]
        if friction.observable in ROW:
            amount, of_amount = read.values[friction.observable], read.relative_errors[:, ROW[friction.observable]]
        else:  # off solved states
            amount, of_amount = np.array([friction.amount(each) for each in read.solutions]).reshape(-1, 2).T
        contact, fluid = rubbing * amount, beta * read.values[viscous]
        return np.stack([contact, fluid, contact + fluid, abs(rubbing) * of_amount + np.abs(fluid) * of], axis=1)

    def parts(self, s: Any, coefficients: Coefficients) -> Parts:
        """Return the load share of the fluid and both parts of the friction, at places that may bring their derivatives."""
        boundary_friction, beta, definition = coefficients
        friction, found = as_asperity_friction(boundary_friction), self.path.smooth(s)
        fluid, viscous = (found[:, ROW[name]] for name in ("fluid_load_share", f"viscous_{definition}"))
        if friction.observable in ROW:
            contact = self.sliding * self.factors(friction, s) * found[:, ROW[friction.observable]]
        else:
            contact = self._of_fields(friction, s)
        return fluid, contact, beta * viscous

    def factors(self, friction: AsperityFriction, s: Any) -> Any:
        """Return the factors of a friction at places: one number where it is the same everywhere."""
        if friction.is_constant:
            return friction.factor(None)
        return np.array([friction.factor(self.coordinate.contact_at(each)) for each in value_of(s).tolist()])

    def _of_fields(self, friction: AsperityFriction, s: Any) -> Any:
        """Return the friction of asperities by the fields between the states of the path, with its derivative if s has one."""
        if isinstance(s, Dual):
            # A difference at an end is taken on the one side where there are states.
            after, before = (np.clip(s.value + step, *self.ends) for step in (FIELD_LOG_STEP, -FIELD_LOG_STEP))
            ahead, behind = (self._of_fields(friction, each) for each in (after, before))
            return Dual(self._of_fields(friction, s.value), (ahead - behind) / (after - before) * s.slope)
        amounts = [friction.amount(self._between_states(each))[0] for each in s.tolist()]
        return self.sliding * self.factors(friction, s) * np.array(amounts)

    def _between_states(self, s: float) -> Solution:
        """Return the state that the path predicts at a place: its fields hold, its errors are not estimated."""
        guess = self.path.problem.guess_at(self.path, s)
        refined = replace(self.path.nearest(s).state, groups=self.coordinate.groups_at(s), state=guess)
        found = solution_of(refined, None, self.rtol)
        assert found is not None
        return found

    def slopes(self, s: Array, coefficients: Coefficients) -> Array:
        """Return the derivatives of the friction by the coordinate."""
        _, contact, viscous = self.parts(Dual(s, np.ones_like(s)), coefficients)
        return np.asarray(slope_of(contact + viscous))

    def accepted(self, rtol: float | None) -> float:
        """Return the error of the observables up to which a landmark is read off."""
        return check_rtol(min(self.rtol, MAX_STATE_RTOL) if rtol is None else rtol)

    def holds(self, s: float, accepted: float) -> bool:
        """Return whether no error at a place exceeds what is accepted."""
        found, errors = self.path.at(np.array([s]))
        return bool(self._within(found, errors, accepted)[0])

    def solution_at(self, s: float) -> Solution:
        """Return the solution at a place, or raise the error of its outcome."""
        return finish(self.state_at(s), self.coordinate.groups_at(s), self.coordinate.contact_at(s), self.rtol)

    def state_at(self, s: float) -> RefinedState:
        """Return the state at a place, as the solver has it."""
        known = next((each.state for each in self.path.expansions if each.coordinate == s), None)
        if known is None and (s, self.rtol) not in self._states:
            self._states[s, self.rtol] = self.path.problem.point_at(self.path, s)
        return self._states[s, self.rtol] if known is None else known

    def solved(self, s: float, rtol: float) -> Solution:
        """Return the solution at a place."""
        point = self._states[s, rtol] = self.path.problem.point_at(self.path, s, rtol)
        if point.state is None or point.values is None:
            raise SolveError(point.outcome, None, f"{describe(self.coordinate.groups_at(s))}: {point.outcome.value}")
        found = solution_of(point, self.coordinate.contact_at(s), rtol)
        assert found is not None
        return found

    def state_slope(self, s: float, rtol: float, coefficients: Coefficients) -> float:
        """Return the derivative of the friction by the coordinate at a state that was solved."""
        boundary_friction, beta, definition = coefficients
        friction = as_asperity_friction(boundary_friction)
        if not friction.is_constant:
            return float(self.slopes(np.array([s]), coefficients)[0])
        state = self._states[s, rtol].state
        assert state is not None
        rubbing = self.sliding * friction.factor(None)
        slopes, _ = derivatives_along(state, self.coordinate.groups_at, s)
        return float(rubbing * slopes[ROW[friction.observable]] + beta * slopes[ROW[f"viscous_{definition}"]])
