"""A solved Stribeck curve: its points, friction and regimes along them, its minimum and its transitions."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from stribeck._types import Array
from stribeck.contact_laws.law import AsperityLaw
from stribeck.contacts.contact import Contact, model_words
from stribeck.contacts.friction import Definition, sliding_part
from stribeck.contacts.groups import Groups
from stribeck.curves.base_curve import BaseCurve
from stribeck.curves.coordinate import Coordinate, Over
from stribeck.curves.function import COLUMNS, CurvePoint, CurveValues, observed, rows_of, solved_at
from stribeck.curves.landmarks import MAX_STATE_RTOL, Landmark, Landmarks, friction_at
from stribeck.curves.regime import Transition
from stribeck.quantities.lazy import cached_property
from stribeck.quantities.outcome import Outcome
from stribeck.quantities.results import ByValue, Card
from stribeck.quantities.units import InputError, show
from stribeck.solver.base_solution import si_films
from stribeck.solver.notes import HARD_PREFIX, law_notes, minimum_note
from stribeck.solver.path.path import SolvedPath
from stribeck.solver.solution import Solution
from stribeck.solver.solve import check_rtol, finish, minimum_estimate

if TYPE_CHECKING:
    pass

__all__ = ["StribeckCurve"]


@dataclass(frozen=True, eq=False, repr=False)
class StribeckCurve(BaseCurve, ByValue):
    """Converged states along one coordinate, and the friction on them.

    Attributes
    ----------
    over : {"speed", "load", "roughness"}
        What varies.
    values : ndarray, shape (n,)
        Where the points lie, ascending: the group [-], or SI units where the curve has a contact.
    contact : Contact or None
        The contact, at its own speed, load and roughness.
    boundary_friction, beta : float
        Friction coefficient of the dry contact and coefficient of the contact law [-].
    definition : {"balanced", "published"}
        Definition of the viscous friction.
    rtol : float
        Relative tolerance of each state.
    outcome : Outcome
        CONVERGED, or why points are missing.
    requested : int
        Points asked for.
    """

    _picture = "stribeck.plot.curve.plot_curve"

    over: Over
    values: Array
    contact: Contact | None
    boundary_friction: float
    beta: float
    definition: Definition
    rtol: float
    outcome: Outcome
    requested: int
    _path: Coordinate = field(repr=False, compare=False)
    _function: SolvedPath = field(repr=False, compare=False)

    @cached_property
    def _rows(self) -> tuple[Array, Array]:
        """Observables of the points and their errors."""
        return rows_of(self._function, np.log(self.values), self.rtol)

    @cached_property
    def solutions(self) -> tuple[Solution, ...]:
        """The state of each point: its numbers come from the curve, its fields are solved on first use."""
        path = self._function
        rows = zip(np.log(self.values).tolist(), *self._rows, strict=True)
        return tuple(CurvePoint(self._path, path, s, row, errors, self.rtol) for s, row, errors in rows)

    @property
    def states(self) -> int:
        """How many states were solved and expanded for the curve."""
        return len(self._function.expansions)

    @property
    def groups(self) -> Groups:
        """Groups of the points, as arrays."""
        return self._path.groups_along(self.values)

    @property
    def law(self) -> AsperityLaw | None:
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

        Raises
        ------
        InputError
            If a solution has no number of this name.
        """
        if name in COLUMNS:
            return np.array(self._rows[0][:, COLUMNS.index(name)])
        return observed(self.solutions, name)

    def _values(self, value: Any, s: Array) -> CurveValues:
        """Return the values of the curve at coordinates."""
        plain = CurveValues.of(value, *self._function.at(s), self._sliding, self._least_error)
        return plain.with_friction(self.boundary_friction, self.beta, self.definition)

    @property
    def _ends(self) -> tuple[float, float]:
        low, high = np.exp(self._function.coordinates[[0, -1]]).tolist()
        return low, high

    def _where(self, value: float) -> str:
        return self._path.where(value)

    def _sampled(self, values: Array) -> Self:
        return self._along(self._function, values, len(values))

    def solve_at(self, value: Any) -> Solution:
        """Return the solution anywhere on the curve, with its fields: solved from the states beside it.

        Parameters
        ----------
        value : float or str
            One value, as for :meth:`at`.

        Returns
        -------
        Solution
            With its own error estimate.

        Raises
        ------
        InputError
            If the value is outside the curve, or more than one.
        SolveError
            If the state does not reach the tolerance.
        """
        found = self.at(value)
        if np.ndim(found.value):
            raise InputError(f"{self.over} = {show(value)}; give one value: a solution is one state.")
        return self._solution_at(math.log(found.value))

    def _solution_at(self, s: float) -> Solution:
        point = solved_at(self._function, s)
        return finish(point, self._path.groups_at(s), self._path.contact_at(s), self.rtol)

    def _along(self, path: SolvedPath, values: Array, requested: int) -> Self:
        """Return the curve on another path, with points at ``values``."""
        return replace(self, values=values, outcome=path.outcome, requested=requested, _function=path)

    @cached_property
    def _sliding(self) -> float:
        """Fraction of the sliding friction of asperities that acts, with its sign."""
        return sliding_part(2 * self._path.groups_at(0.0).model.film.slide)

    @cached_property
    def _least_error(self) -> float:
        """Smallest error that is stated."""
        return minimum_estimate(self.rtol, self._path.groups_at(0.0).model)

    def _friction_of(self, boundary_friction: float, beta: float, definition: Definition) -> Array:
        found = CurveValues.of(self.values, *self._rows, self._sliding, self._least_error)
        found = found.with_friction(boundary_friction, beta, definition)
        return np.stack([found.friction_contact, found.friction_viscous, found.friction, found.friction_error], axis=1)

    @property
    def law_in_doubt(self) -> Array:
        """Whether the contact law is outside its range at each point while asperities matter there."""
        given = self.boundary_friction, self.beta
        # alpha, beta and dry friction, all that the notes take from a contact, are the same at all points
        return np.array([bool(law_notes(each.groups, self.contact, each.observables, given)) for each in self.solutions], bool)

    @property
    def error_estimate(self) -> float:
        """Largest estimated relative error over all points."""
        stated = self._rows[1][:, : COLUMNS.index("minimum_position")]
        return float(np.nanmax(np.maximum(stated, self._least_error), initial=0.0)) if len(stated) else math.nan

    @property
    def notes(self) -> tuple[str, ...]:
        """What to know before using the numbers; each sentence names the points, or the minimum, that it concerns."""
        found: dict[str, list[tuple[float, str]]] = {}
        for value, solution in zip(self.values.tolist(), self.solutions, strict=True):
            for note in solution.notes_for(self.boundary_friction, self.beta):
                # A note holds numbers that differ from point to point; those of the first point are kept.
                kind = re.sub(r"[-+]?[0-9][-+.0-9e]*", "", note)
                found.setdefault(kind, []).append((value, note))
        told = [self._note(points) for points in found.values()]
        return (*sorted(told, key=lambda note: not note.startswith(HARD_PREFIX)), *self.minimum_notes)

    @property
    def minimum_notes(self) -> tuple[str, ...]:
        """The note on a minimum outside the range of the contact law, one of :attr:`notes`; empty if there is none."""
        if self.minimum is None:
            return ()
        state = self.minimum.solution
        share = state.friction(self.boundary_friction, self.beta, self.definition).contact_share
        note = minimum_note(state.groups, state.contact, state.observables, share, self._path.where(self.minimum.value))
        return (note,) if note else ()

    def _note(self, points: list[tuple[float, str]]) -> str:
        where = self._path.where(points[0][0], points[-1][0])
        return f"{points[0][1]} ({len(points)} of {len(self)} points, {where}.)"

    @cached_property
    def _landmarks(self) -> Landmarks:
        return Landmarks(self._function, self._path, self.rtol)

    def _accepted(self, rtol: float | None) -> float:
        return check_rtol(min(self.rtol, MAX_STATE_RTOL) if rtol is None else rtol)

    def _find(self, mark: Transition, accepted: float) -> Landmark | None:
        rubbing = self._sliding * self.boundary_friction
        place = self._landmarks.place(mark, rubbing, self.beta, self.definition, accepted)
        if place is None:
            return None
        friction = friction_at(place.solution.friction(self.boundary_friction, self.beta, self.definition))
        return Landmark(mark, math.exp(place.coordinate), friction, place.solution, place.error, self.over)

    def to_si(self) -> dict[str, Array]:
        """Return films and Hertz scales of the points in SI units.

        Returns
        -------
        dict of str to ndarray
            By name, such as ``central_film_thickness`` [m] and ``hertz_pressure`` [Pa].

        Raises
        ------
        InputError
            If the curve comes from groups alone, which do not fix the scales.
        """
        if self.contact is None:
            raise InputError("to_si needs the Hertz scales of a contact; solve a LineContact instead of Groups.")
        films = [si_films(solution) for solution in self.solutions]
        return {name: np.array([film[name][0] for film in films]) for name in (films[0] if films else ())}

    def _card(self) -> Card:
        if not len(self):
            return Card(f"no points over {self.over}", (), (self.outcome.value,))
        points = f"{len(self)} points" if len(self) == self.requested else f"{len(self)} of {self.requested} points"
        model = model_words(self.groups, self.contact)
        rows = [
            ("friction", f"{self.friction.min():.4g} to {self.friction.max():.4g} ({self.definition})"),
            *((mark.name, f"{mark.friction:.4g} at {self._path.where(mark.value)}") for mark in self.transitions),
            ("regimes", ", ".join(dict.fromkeys(self.regimes))),
            ("dry friction, beta", f"{self.boundary_friction:g}, {self.beta:g}"),
            ("contact law", self.solutions[0].law),
            *([("model", model)] if model else []),
            ("estimated error", f"{self.error_estimate:.1e} (rtol {self.rtol:g})"),
        ]
        ends = self._path.where(float(self.values[0]), float(self.values[-1]))
        outcome = "" if self.outcome.ok else f"; {self.outcome.value}"
        return Card(f"{points}, {ends}{outcome}", rows, self.notes)
