"""A solved Stribeck curve: its points, friction and regimes along them, its minimum and its transitions."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from stribeck._types import Array
from stribeck.asymptotics.smooth import hydrodynamic
from stribeck.contact_laws.law import AsperityLaw
from stribeck.contacts.contact import Contact, model_words
from stribeck.contacts.friction import Definition, FrictionArray, check_definition, coefficients, sliding_part
from stribeck.contacts.groups import Groups
from stribeck.contacts.model import BASE_MODEL
from stribeck.curves.coordinate import Coordinate, Over, check_points, given_values
from stribeck.curves.function import COLUMNS, CurvePoint, CurveValues, observed, rows_of, solved_at
from stribeck.curves.landmarks import STATES_RTOL, Landmark, Landmarks, Place, friction_at
from stribeck.curves.regime import Regime, Transition, check_transition, ranges_of, regimes_along
from stribeck.files.results import Exported
from stribeck.quantities.lazy import cached_property
from stribeck.quantities.outcome import Outcome
from stribeck.quantities.results import ByValue, Card, Shown
from stribeck.quantities.units import InputError, show
from stribeck.solver.base_solution import si_films
from stribeck.solver.notes import HARD_PREFIX, law_notes, minimum_note
from stribeck.solver.path.path import SolvedPath
from stribeck.solver.solution import Solution
from stribeck.solver.solve import check_rtol, finish, minimum_estimate

if TYPE_CHECKING:
    import xarray

__all__ = ["StribeckCurve"]

SLACK = 1e-12
"""Rounding of the ends of a curve."""


@dataclass(frozen=True, eq=False, repr=False)
class StribeckCurve(Exported, Shown, ByValue):
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

    _picture = "stribeck.curves.plot.plot_curve"

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

    def __len__(self) -> int:
        """Return the number of points."""
        return len(self.values)

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

    def at(self, value: Any) -> CurveValues:
        """Return all observables and the friction anywhere on the curve, with their errors.

        Parameters
        ----------
        value : float, str or array_like
            What the curve runs over, inside its range: groups [-], or SI numbers or text with units where the curve has a
            contact.

        Returns
        -------
        CurveValues
            Numbers for one value, arrays for many.

        Raises
        ------
        InputError
            If a value is outside the curve.
        SolveError
            If no states can be solved along the curve.

        Notes
        -----
        A curve is about a dozen solved states, expanded into Taylor series.  Between them observables are polynomials in the
        logarithm of ``value``; their difference from polynomials of lower order is part of the error
        (``test_curve_function.py``).
        """
        values = given_values(self.over, value, self.contact)
        path = self._function
        low, high = (float(end) for end in np.exp(path.coordinates[[0, -1]]))
        if not ((values >= low * (1 - SLACK)) & (values <= high * (1 + SLACK))).all():
            raise InputError(
                f"{self.over} = {show(value)} is outside the curve, which runs from {self._path.where(low)} to "
                f"{self._path.where(high).removeprefix(self.over + ' ')}; compute a curve that contains it."
            )
        return self._values(values if np.ndim(values) else float(values), np.log(np.atleast_1d(values)))

    def _values(self, value: Any, s: Array) -> CurveValues:
        """Return the values of the curve at coordinates."""
        plain = CurveValues.of(value, *self._function.at(s), self._sliding, self._least_error)
        return plain.with_friction(self.boundary_friction, self.beta, self.definition)

    def sampled(self, points: int) -> StribeckCurve:
        """Return the same curve with other points, evenly in the logarithm; they are read off it.

        Parameters
        ----------
        points : int
            Their number, at least 2.

        Returns
        -------
        StribeckCurve
            Between the same ends.

        Raises
        ------
        InputError
            For a number that is none.
        """
        check_points(points)
        return self._along(self._function, np.geomspace(self.values[0], self.values[-1], points), points)

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

    def _along(self, path: SolvedPath, values: Array, requested: int) -> StribeckCurve:
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

    @cached_property
    def _friction(self) -> Array:
        return self._friction_of(self.boundary_friction, self.beta, self.definition)

    def _friction_of(self, boundary_friction: float, beta: float, definition: Definition) -> Array:
        found = CurveValues.of(self.values, *self._rows, self._sliding, self._least_error)
        found = found.with_friction(boundary_friction, beta, definition)
        return np.stack([found.friction_contact, found.friction_viscous, found.friction, found.friction_error], axis=1)

    @property
    def friction_contact(self) -> Array:
        """Contact part of the friction coefficient [-]."""
        return np.asarray(self._friction[:, 0])

    @property
    def friction_viscous(self) -> Array:
        """Viscous part of the friction coefficient [-]."""
        return np.asarray(self._friction[:, 1])

    @property
    def friction(self) -> FrictionArray:
        """Friction coefficients [-]: an array with its parts ``contact``, ``viscous`` and its ``error``.

        For the coefficients and the definition of the curve; ``friction(boundary_friction, beta, definition)`` returns it for
        others, each optional.
        """
        return self._friction_for()

    def _friction_for(
        self, boundary_friction: float | None = None, beta: float | None = None, definition: Definition | None = None
    ) -> FrictionArray:
        if boundary_friction is None and beta is None and definition is None:
            found = self._friction
        else:
            given = coefficients(
                None,
                self.boundary_friction if boundary_friction is None else boundary_friction,
                self.beta if beta is None else beta,
            )
            found = self._friction_of(*given, self.definition if definition is None else check_definition(definition))
        return FrictionArray(found[:, 0], found[:, 1], found[:, 2], found[:, 3], self._friction_for)

    @property
    def friction_error(self) -> Array:
        """Estimated absolute error of the friction coefficient [-]."""
        return np.asarray(self._friction[:, 3])

    @property
    def hersey_number(self) -> Array:
        """Hersey number of the points [-], eta U/F_N of a line and eta U R/F_N of a ball."""
        return np.asarray(self.groups.hersey_number(self.beta))

    @property
    def hydrodynamic_friction(self) -> Array:
        """Friction of smooth surfaces by the article's law, the abscissa of its second plot; nan for other models."""
        if self.groups.model != BASE_MODEL:
            return np.full(len(self), np.nan)
        return np.asarray(hydrodynamic.friction(self.groups, self.beta))

    @property
    def regimes(self) -> tuple[Regime, ...]:
        """Lubrication regime of each point."""
        return regimes_along(self.observable("fluid_load_share"), self.friction_contact, self.friction)

    @cached_property
    def regime_ranges(self) -> tuple[tuple[Regime, float, float], ...]:
        """Regimes along the curve, ascending: name, and the values between which it holds.

        They meet at a located transition where there is one, else in the middle between two points.
        """
        return ranges_of(self.values, self.regimes, self.transitions)

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

    @property
    def minimum(self) -> Landmark | None:
        """The minimum of the size of the friction, where it or its slope vanishes; None where the curve has none inside."""
        return self.landmark(Transition.MINIMUM)

    def landmark(self, name: str, rtol: float | None = None) -> Landmark | None:
        """Return one transition, or the minimum.

        Parameters
        ----------
        name : str
            ``"boundary_end"``, ``"equal_shares"``, ``"hydrodynamic_start"`` or ``"minimum"``, or the name in outputs.
        rtol : float, optional
            Error of the observables up to which it is read off the curve: the tolerance of the curve costs no further
            state.  Beyond, a state is solved there.  1e-6 if omitted, or the tolerance of the curve if that is smaller.

        Returns
        -------
        Landmark or None
            None where the curve does not hold it.

        Raises
        ------
        InputError
            For another name, or a tolerance that is none.
        """
        mark = check_transition(name)
        accepted = min(self.rtol, STATES_RTOL) if rtol is None else rtol
        accepted = check_rtol(accepted)
        if (mark, accepted) not in self._found:
            rubbing = self._sliding * self.boundary_friction
            place = self._landmarks.place(mark, rubbing, self.beta, self.definition, accepted)
            self._found[mark, accepted] = None if place is None else self._landmark(mark, place)
        return self._found[mark, accepted]

    @cached_property
    def _found(self) -> dict[tuple[Transition, float], Landmark | None]:
        return {}

    def _landmark(self, name: Transition, place: Place) -> Landmark:
        friction = friction_at(place.solution.friction(self.boundary_friction, self.beta, self.definition))
        return Landmark(name, math.exp(place.coordinate), friction, place.solution, place.error)

    @cached_property
    def transitions(self) -> tuple[Landmark, ...]:
        """The boundaries between regimes, where the load is shared in halves, and the friction minimum.

        As far as the curve holds them, ascending: where the fluid carries 5 % and 50 % of the load, where asperities cause
        10 % of the friction, and where friction is at its minimum.
        """
        found = [self.landmark(name) for name in Transition]
        return tuple(sorted((mark for mark in found if mark is not None), key=lambda mark: mark.value))

    def to_dataset(self) -> xarray.Dataset:
        """Return the curve as an xarray Dataset.

        Returns
        -------
        xarray.Dataset
            Observables, friction, regimes and inputs of each point, with units and long names as attributes;
            needs the extra ``data``.
        """
        from stribeck.curves.table import curve_dataset

        return curve_dataset(self)

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
