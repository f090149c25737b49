"""A Stribeck curve: its points, friction and regimes along them, its minimum and its transitions."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field, replace
from numbers import Real
from types import SimpleNamespace
from typing import Annotated, Any, Self

import numpy as np

from stribeck._types import Array
from stribeck.asperity_friction.coulomb import as_asperity_friction
from stribeck.asymptotics import hydrodynamic
from stribeck.contact_laws.law import AsperityLaw
from stribeck.contacts.contact import Contact, model_words
from stribeck.contacts.friction import REGIMES, Definition, FrictionArray, Regime, friction_share, regime_numbers
from stribeck.contacts.groups import BASE_MODEL, Groups
from stribeck.contacts.notes import HARD_PREFIX, law_notes, minimum_note
from stribeck.curves.coordinate import POINTS_RANGE, Over, given_values
from stribeck.curves.friction_path import FrictionPath
from stribeck.curves.regime import Landmark, Method, Transition, check_transition, ranges_of
from stribeck.curves.simulator_model import StribeckModel, simulator_model
from stribeck.curves.source import CurveValues, Readings
from stribeck.curves.table import curve_dict, curve_table
from stribeck.files.results import Exported, Labelled
from stribeck.quantities.lazy import cached_property
from stribeck.quantities.outcome import Outcome
from stribeck.quantities.outputs import OUTPUT_TABLES
from stribeck.quantities.results import ByValue, Card, Shown
from stribeck.quantities.units import InputError, checked_count, show
from stribeck.solver.numbers import si_films


@dataclass(frozen=True, eq=False, repr=False)
class StribeckCurve(Exported, Shown, ByValue):
    """Friction along one coordinate, off solved states or off the atlas.

    Its dataset has observables, friction, regimes and inputs of each point, with their errors.
    """

    _picture = "stribeck.plot.curve.plot_curve"

    values: Annotated[Array, "where the points lie, ascending: groups [-], or SI units of a contact"]
    requested: Annotated[int, "points asked for"]
    _path: FrictionPath = field(repr=False)

    @property
    def over(self) -> Over:
        """What varies: ``"speed"``, ``"load"`` or ``"roughness"``."""
        return self._path.source.coordinate.over

    @property
    def contact(self) -> Contact | None:
        """The contact, at its own speed, load and roughness; None where groups were given."""
        return self._path.source.coordinate.contact

    @property
    def boundary_friction(self) -> Any:
        """Friction coefficient of the dry contact [-], or another friction of asperities that the contact has."""
        return self._path.boundary_friction

    @property
    def beta(self) -> float:
        """Coefficient of the contact law [-]."""
        return self._path.beta

    @property
    def definition(self) -> Definition:
        """Definition of the viscous friction, ``"balanced"`` or ``"published"``."""
        return self._path.definition

    @property
    def method(self) -> Method:
        """Where the numbers come from: ``"solver"`` or ``"atlas"``."""
        return "solver" if self.states else "atlas"

    @property
    def rtol(self) -> float:
        """Relative tolerance of each state; off the atlas the stated error of the table."""
        return self._path.source.rtol

    @property
    def outcome(self) -> Outcome:
        """CONVERGED, or why points are missing."""
        return self._path.source.outcome

    @property
    def states(self) -> int:
        """How many states were solved for the curve; none off the atlas."""
        return self._path.source.states

    @cached_property
    def groups(self) -> Groups:
        """Groups of the points, as arrays."""
        return self._path.source.coordinate.groups_along(self.values)

    @property
    def law(self) -> AsperityLaw | None:
        """Contact law of all points; None is the exponential one."""
        return self._path.source.coordinate.base.law

    @property
    def unit(self) -> str:
        """SI unit of what the curve runs over; ``"1"`` of groups."""
        return self._path.source.coordinate.unit

    @property
    def speed(self) -> Array:
        """Speed of each point [m/s], or its group where the curve has no contact [-]."""
        return self._input("speed")

    @property
    def load(self) -> Array:
        """Load of each point [N/m], of a ball [N], or its group where the curve has no contact [-]."""
        return self._input("load")

    @property
    def roughness(self) -> Array:
        """Roughness of each point [m], or its group where the curve has no contact [-]."""
        return self._input("roughness")

    def _input(self, name: str) -> Array:
        if name == self.over:
            return self.values
        return np.full(len(self.values), getattr(self.groups if self.contact is None else self.contact, name))

    def __len__(self) -> int:
        """Return the number of points."""
        return len(self.values)

    @cached_property
    def _points(self) -> Readings:
        """What is known at the points."""
        return self._path.source.read(np.log(self.values), self.rtol)

    @property
    def solutions(self) -> tuple[Any, ...]:
        """The state of each point: its numbers come from the curve, its fields are solved on first use; none off the atlas."""
        return self._points.solutions

    @property
    def observables(self) -> tuple[str, ...]:
        """Names of the observables that the curve has."""
        return tuple(OUTPUT_TABLES[self.groups.geometry].listed) if self.states else self._points.names

    def observable(self, name: str) -> Array:
        """Return an attribute of every solution as an array.

        Parameters
        ----------
        name : str
            Name of a number that :class:`~stribeck.results.Solution` has, such as ``"central_gap"``.

        Returns
        -------
        ndarray, shape (n,)
            Its values, in the order of :attr:`values`.

        Raises
        ------
        InputError
            If a solution has no number of this name.
        """
        if isinstance(name, str) and name in self._points.values:
            return np.array(self._points.values[name])
        numbers = [getattr(each, name, None) if isinstance(name, str) else None for each in self.solutions]
        if not (numbers and all(isinstance(number, Real) for number in numbers)):
            known = OUTPUT_TABLES[self.groups.geometry].names if self.states else self.observables
            what = "it must be the name of a number of every solution, such as" if self.states else "the atlas has"
            raise InputError(f"name = {show(name)}; {what} {', '.join(known)}.")
        return np.array(numbers)

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
        source = self._path.source
        if source.coordinate.inside(np.atleast_1d(values), source.ends).size < np.size(values):
            low, high = np.exp(source.ends).tolist()
            raise InputError(
                f"{self.over} = {show(value)} is outside the curve, which runs from {source.coordinate.where(low)} to "
                f"{source.coordinate.where(high).removeprefix(self.over + ' ')}; compute a curve that contains it."
            )
        return self._path.values(values if np.ndim(values) else float(values))

    def solve_at(self, value: Any) -> Any:
        """Return the solution anywhere on the curve, with its fields: from the states beside it, off the atlas from cold.

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
        return self._path.source.solution_at(math.log(found.value))

    def sampled(self, points: int) -> Self:
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
        checked_count("points", points, *POINTS_RANGE)
        return replace(self, values=np.geomspace(self.values[0], self.values[-1], points), requested=points)

    @cached_property
    def friction(self) -> FrictionArray:
        """Friction coefficients [-]: an array with its parts ``asperities``, ``fluid`` and its ``error``.

        ``friction(boundary_friction, beta, definition)`` returns it for others than those of the curve, each optional.
        """
        found = self._path.friction(self._points)
        assert isinstance(found, FrictionArray)
        return found

    @property
    def hersey_number(self) -> Array:
        """Hersey number of the points [-], eta U/F_N of a line and eta U R/F_N of a ball."""
        return np.asarray(self.groups.hersey_number(self.beta))

    @property
    def hydrodynamic_friction(self) -> Array:
        """Friction of smooth surfaces by the article's law, the abscissa of its second plot; nan for other models."""
        if self.groups.geometry != "line" or self.groups.model != BASE_MODEL:
            return np.full(len(self), np.nan)
        return np.asarray(hydrodynamic.friction(self.groups, self.beta))

    @property
    def regimes(self) -> tuple[Regime, ...]:
        """Lubrication regime of each point."""
        friction = self.friction
        by_asperities = friction_share(friction.asperities, np.asarray(friction) - friction.asperities)
        return tuple(REGIMES[number] for number in regime_numbers(self.observable("fluid_load_share"), by_asperities).tolist())

    @cached_property
    def regime_ranges(self) -> tuple[tuple[Regime, float, float], ...]:
        """Regimes along the curve, ascending: name, and the values between which it holds."""
        return ranges_of(self.values, self.regimes, self.transitions)

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
        return self._path.landmark(check_transition(name), rtol)

    @cached_property
    def transitions(self) -> tuple[Landmark, ...]:
        """The transitions that the curve holds, ascending, its minimum among them.

        They are where the fluid carries 5 % and 50 % of the load, and where asperities cause 10 % of the friction.
        """
        found = [self.landmark(name) for name in Transition]
        return tuple(sorted((mark for mark in found if mark is not None), key=lambda mark: mark.value))

    @cached_property
    def law_in_doubt(self) -> Array:
        """Whether the contact law is outside its range at each point while asperities matter there."""
        return np.array([bool(each) for each in self._law_notes], bool)

    @cached_property
    def _law_notes(self) -> list[tuple[str, ...]]:
        """What is to be said of the contact law at each point."""
        read = [self.observable(name) for name in ("contact_load_share", "central_gap", "minimum_gap")]
        rows = zip(np.log(self.values).tolist(), *(each.tolist() for each in (*read, self.friction.fluid)), strict=True)
        given, groups_at = (self.boundary_friction, self.beta), self._path.source.coordinate.groups_at

        def state(share: float, central: float, least: float, fluid: float) -> SimpleNamespace:
            gaps = {"central_gap": central, "minimum_gap": least}
            return SimpleNamespace(contact_load_share=share, **gaps, viscous_friction=lambda beta, definition: fluid)

        return [law_notes(groups_at(s), self.contact, state(*each), given, self.definition) for s, *each in rows]

    @property
    def error_estimate(self) -> float:
        """Largest estimated relative error over all points."""
        return self._points.error_estimate

    @property
    def notes(self) -> tuple[str, ...]:
        """What to know before using the numbers; each sentence names the points, or the minimum, that it concerns."""
        found: dict[str, list[tuple[float, str]]] = {}
        given = self.boundary_friction, self.beta, self.definition
        # Off the atlas there are no states, whose pressures would say more.
        told_of = [each.notes_for(*given) for each in self.solutions] if self.states else self._law_notes
        for value, notes in zip(self.values.tolist(), told_of, strict=True):
            for note in notes:
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
        found, coordinate = self.at(self.minimum.value), self._path.source.coordinate
        groups, where = coordinate.groups_at(math.log(self.minimum.value)), coordinate.where(self.minimum.value)
        share = float(friction_share(found.friction.asperities, found.friction.fluid))
        note = minimum_note(groups, self.contact, found, share, where)
        return (note,) if note else ()

    def _note(self, points: list[tuple[float, str]]) -> str:
        where = self._path.source.coordinate.where(*dict.fromkeys((points[0][0], points[-1][0])))
        return f"{points[0][1]} ({len(points)} of {len(self)} points, {where}.)"

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

    def to_stribeck_model(self) -> StribeckModel:
        """Return the formula of Stribeck friction that simulators of motion take, through this curve.

        Returns
        -------
        StribeckModel
            Its five parameters over the sliding speed v, with its largest deviations from the curve.

        Raises
        ------
        InputError
            If the curve is not one of a contact over its speed, or nothing slides.
        """
        return simulator_model(self)

    def to_dict(self) -> dict[str, Any]:
        """Return settings, minimum, transitions, regimes and the columns of :meth:`to_dataset`, ready for JSON."""
        return curve_dict(self)

    def _labelled(self) -> Labelled:
        return curve_table(self)

    def _card(self) -> Card:
        if not len(self):
            return Card(f"no points over {self.over}", (), (self.outcome.value,))
        where, is_solved = self._path.source.coordinate.where, bool(self.states)
        points = f"{len(self)} points" if len(self) == self.requested else f"{len(self)} of {self.requested} points"
        model = model_words(self.groups, self.contact)
        error = f"{self.error_estimate:.1e} (rtol {self.rtol:g})" if is_solved else f"{self.rtol:.1g}, of the table"
        rows = [
            ("friction", f"{self.friction.min():.4g} to {self.friction.max():.4g} ({self.definition})"),
            *((mark.name, f"{mark.friction:.4g} at {where(mark.value)}") for mark in self.transitions),
            ("regimes", ", ".join(dict.fromkeys(self.regimes))),
            ("dry friction, beta", f"{as_asperity_friction(self.boundary_friction).text}, {self.beta:g}"),
            *([("contact law", self.solutions[0].law)] if is_solved else []),
            *([("model", model)] if model else []),
            ("estimated error" if is_solved else "stated error", error),
        ]
        ends = where(float(self.values[0]), float(self.values[-1]))
        outcome = "" if self.outcome.ok else f"; {self.outcome.value}"
        return Card(f"{points}{'' if is_solved else ' off the atlas'}, {ends}{outcome}", rows, self.notes)


def path_of(curve: StribeckCurve) -> FrictionPath:
    """Return the friction of a curve as a function along its path."""
    return curve._path


def with_contact(curve: StribeckCurve, contact: Contact) -> StribeckCurve:
    """Return the curve with a contact of it at another place."""
    source: Any = curve._path.source
    moved = replace(source, coordinate=replace(source.coordinate, base=contact))
    return replace(curve, _path=replace(curve._path, source=moved))
