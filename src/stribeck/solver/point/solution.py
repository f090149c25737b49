"""The result of a solve of a ball: fields and observables of one state, with outcome, error estimate and notes."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from stribeck._types import Array
from stribeck.contacts.contact import Contact
from stribeck.contacts.cut_off import FAR_FILM_MIN_RADIUS
from stribeck.contacts.friction import Definition
from stribeck.contacts.groups import Groups, contact_law
from stribeck.contacts.notes import (
    MAX_FILM_SLOPE,
    THICK_PREFIX,
    WETTED_PREFIX,
    cavitation_notes,
    fluid_notes,
    law_notes,
    shape_notes,
)
from stribeck.equations.point.observables import OBSERVABLES
from stribeck.fluids.fluid import Cavitation
from stribeck.numerics.settings import MAX_BYTES
from stribeck.quantities.lazy import cached_property
from stribeck.quantities.outcome import Outcome
from stribeck.quantities.units import InputError, checked_count, real_array, show
from stribeck.solver.at_rest import effective_model
from stribeck.solver.base_solution import BaseSolution
from stribeck.solver.fields import Field, Profile
from stribeck.solver.point.level import PROBLEMS
from stribeck.solver.point.state import PointObservables, PointState
from stribeck.solver.solve_error import SolveError, describe

if TYPE_CHECKING:
    import xarray

MAX_POINTS = math.isqrt(MAX_BYTES // (3 * 8))  # Points along a side of a dataset, whose fields take as much memory as a mesh
WAKE_NOTE = (
    "The film ends at ambient pressure; streaks of liquid that touch both walls fill the part h_e/h of the wake. A dry wake "
    "takes 0.35 lambda ln(X/a) from the friction integral, a full one adds 0.48 lambda ln(X/a), X being where the liquid "
    "ends; without wetted_radius that is the X of a ball whose film does not break."
)
CAVITY_NOTE = (
    "The film ruptures at the pressure of the cavity and re-forms behind it; there friction counts the liquid, as streaks "
    "that touch both walls, and no drag of the gas."
)


@dataclass(frozen=True, eq=False, repr=False)
class PointSolution(BaseSolution):
    r"""One solved state of a ball.

    Lengths along the contact are in Hertz radii a, gaps in indentations u_Hz, pressures in p_Hz.

    Attributes
    ----------
    groups : Groups
        The state that was solved.
    contact : PointContact or None
        The contact in SI units it came from.
    outcome : Outcome
        How the solve ended; its value is a sentence.
    notes : tuple of str
        What to know before using the numbers, one sentence each.
    rtol : float
        The relative tolerance asked for, or the smallest that a film that breaks can hold.
    law : str
        Name of the contact law.
    observables : PointObservables
        The observables as one object.
    state : PointState
        The state as the solver has it: mesh, nodal fields, steps.

    Notes
    -----
    Observables (``contact_load_share`` ... ``offset``) are attributes too, see the table of symbols in theory.md.
    """

    _picture = "stribeck.plot.state.plot_point_solution"

    groups: Groups
    contact: Contact | None
    outcome: Outcome
    notes: tuple[str, ...]
    rtol: float
    law: str
    observables: PointObservables
    state: PointState = field(repr=False)

    @property
    def nodes(self) -> int:
        """Unknown gaps in the final discretisation."""
        return int(self.state.mesh.size)

    @property
    def newton_steps(self) -> int:
        """Steps of its Newton iteration."""
        return self.state.newton_steps

    @property
    def error_estimate(self) -> float:
        """Largest estimated relative error of the observables; load shares count absolutely.

        It says nothing about the minimum film, whose estimates are :attr:`minimum_gap_error`, :attr:`minimum_radius_error` and
        :attr:`minimum_angle_error`.
        """
        return self.state.error_estimate

    @cached_property
    def errors(self) -> dict[str, float]:
        """Estimated relative error of each observable; absolute for load shares, that of J_pcx relative to the friction."""
        found = self.state.relative_errors
        return {name: float(found[name]) for name in self.outputs.names}

    @property
    def minimum_gap_error(self) -> float:
        """Estimated relative error of the minimum film [-], which ``rtol`` does not limit: side lobes are sharp."""
        return self.state.minimum_gap_error

    @property
    def minimum_radius_error(self) -> float:
        """Estimated absolute error of :attr:`minimum_radius` [a]."""
        return float(self.state.absolute_errors["minimum_radius"])

    @property
    def minimum_angle_error(self) -> float:
        """Estimated absolute error of :attr:`minimum_angle` [radian]."""
        return float(self.state.absolute_errors["minimum_angle"])

    @property
    def identity_error(self) -> float:
        r"""Residual of the identity of the friction integrals, over the largest of them [-].

        .. math:: J^\mathrm{balanced} - J^\mathrm{published} - J^{p_c x} + c \lambda = 0, \quad
            c = \tfrac25 \pi, \text{ or } 0.63702 \text{ where the film breaks}
        """
        values = self.state.values
        largest = max(abs(values["J_balanced"]), abs(values["J_published"]), abs(values["J_pcx"]))
        return abs(self.state.identity_error) / largest if largest > 0 else 0.0

    @property
    def friction_integral(self) -> float:
        """The balanced friction integral J up to where the liquid ends [-]; of a whole ball for beta = 1 without a contact."""
        slope = float(self.groups.slope() if self.contact is None else self.contact.slope)
        return self.observables.integral(slope)

    @property
    def _sliding(self) -> float:
        return self.observables.sliding

    def _viscous(self, beta: float, definition: Definition) -> tuple[float, float]:
        errors = {name: float(error) for name, error in self.state.absolute_errors.items()}
        return self.observables.viscous_friction(beta, definition), self.observables.viscous_error(beta, errors, definition)

    @cached_property
    def x(self) -> Array:
        """Positions of the nodes along the middle line, ascending [a]."""
        radii = np.asarray(self.state.mesh.radii)
        return np.concatenate([-radii[::-1], radii])

    def _area(self) -> tuple[float, float]:
        return self.state.real_contact_area

    @cached_property
    def _along(self) -> Profile:
        return self.profile(self.x)

    @property
    def largest_suction(self) -> float:
        """Largest pressure of the fluid below the ambient in SI units [Pa]; zero where it is nowhere below."""
        return max(0.0, -self.state.lowest_pressure) * self._hertz("largest_suction").pressure

    def profile(self, x: Array) -> Profile:
        """Return the fields along the middle line.

        Parameters
        ----------
        x : array_like, shape (n,)
            Finite positions along the motion, the inlet at x < 0 [a].

        Returns
        -------
        Profile
            In Hertz units.

        Raises
        ------
        InputError
            If a position is not finite.
        """
        points = np.atleast_1d(real_array("x", x))
        if points.ndim != 1:
            raise InputError(f"x = {show(x)}; positions along the middle line have one dimension, see field for a plane.")
        found = self.field(points, 0.0)
        return Profile(points, found.gap, found.contact_pressure, found.fluid_pressure)

    def field(self, x: Any, y: Any) -> Field:
        """Return the fields anywhere on the plane.

        Parameters
        ----------
        x, y : array_like
            Finite positions along and across the motion, of shapes that broadcast; the inlet is at x < 0 [a].

        Returns
        -------
        Field
            In Hertz units.

        Raises
        ------
        InputError
            If a position is not finite, or the shapes do not broadcast.
        """
        along, across = real_array("x", x), real_array("y", y)
        for name, given, found in (("x", x, along), ("y", y, across)):
            if not np.isfinite(found).all():
                raise InputError(f"{name} = {show(given)}; positions must be finite numbers.")
        try:
            along, across = (np.array(each) for each in np.broadcast_arrays(along, across))
        except ValueError:
            raise InputError(f"x of shape {along.shape} and y of shape {across.shape} do not broadcast.") from None
        at = self.state.fields(along, across)
        return Field(along, across, at.gap, at.contact_pressure, at.fluid_pressure)

    def to_si(self, x: Any = None, y: Any = None) -> Profile | Field:
        """Return the fields in SI units: positions and gaps in m, pressures in Pa.

        Parameters
        ----------
        x : array_like, optional
            Positions along the motion [m]; the nodes of the middle line by default.
        y : array_like, optional
            Positions across it [m]; the middle line by default.

        Returns
        -------
        Profile or Field
            In SI units; a field where ``y`` is given.

        Raises
        ------
        InputError
            If the solution comes from groups alone, which do not fix the scales.
        """
        scales = self._scales()
        a = scales.half_width
        if y is not None:
            return self.field(real_array("x", 0.0 if x is None else x) / a, real_array("y", y) / a).in_si(scales)
        return (self._along if x is None else self.profile(real_array("x", x) / a)).in_si(scales)

    def to_dataset(self, *, points: int = 161, reach: float = 2.0) -> xarray.Dataset:
        """Return the fields on a square around the contact as an xarray Dataset.

        Parameters
        ----------
        points : int
            Points along each side, 2 to some thousands.
        reach : float
            Half the side of the square [a], positive.

        Returns
        -------
        xarray.Dataset
            Gap and pressures over y and x, in SI units where there is a contact and in Hertz units else; beside
            them every number of the state and its estimated error, and the inputs as attributes. Needs the extra ``data``.

        Raises
        ------
        InputError
            If an argument is outside its range.
        """
        checked_count("points", points, 2, MAX_POINTS)
        if isinstance(reach, bool) or not isinstance(reach, int | float) or not (reach > 0 and math.isfinite(reach)):
            raise InputError(f"reach = {show(reach)}; it must be a positive number of Hertz radii.")
        found, scale = (self.field, 1.0) if self.contact is None else (self.to_si, self.contact.hertz.half_width)
        along = np.linspace(-reach, reach, points) * scale
        return self._with_numbers(found(along, along[:, None]).to_dataset())


def solution_of(state: PointState, contact: Contact | None) -> PointSolution:
    """Return a state of the solver as a solution."""
    groups, values = state.groups, PointObservables.of(state, contact)
    outcome = state.outcome
    if outcome.ok and values.drags_along(float(groups.slope())):
        outcome = Outcome.REFINEMENT_LIMIT
    return PointSolution(
        groups=groups,
        contact=contact,
        outcome=outcome,
        notes=_notes(state, contact, values),
        rtol=state.rtol,
        law="dry contact" if groups.is_hertzian else contact_law(groups).name,
        observables=values,
        state=state,
    )


def finish_point(state: PointState, contact: Contact | None, on_failure: str = "raise") -> PointSolution:
    """Return a state as a solution, or raise the error of its outcome."""
    is_there = all(math.isfinite(state.values.get(name, math.nan)) for name in OBSERVABLES)
    solution = solution_of(state, contact) if is_there else None
    if solution is not None and (solution.outcome.ok or on_failure == "return"):
        return solution
    if solution is not None and state.outcome.ok:
        raise SolveError(
            solution.outcome,
            solution,
            f"{describe(state.groups)}, of a ball: the film is too thick for the friction up to wetted_radius to be told; it "
            f"is known to {solution.friction().error:.1g}. Give a larger wetted_radius, or none, or a smaller rtol.",
        )
    reached = "" if solution is None else f" Achieved: {solution.error_estimate:.1e}, requested: {state.rtol:.1e}."
    raise SolveError(state.outcome, solution, f"{describe(state.groups)}, of a ball: {state.outcome.value}{reached}")


def _notes(state: PointState, contact: Contact | None, values: PointObservables) -> tuple[str, ...]:
    """Return what to know before using the numbers of a state."""
    groups = state.groups
    if groups.is_hertzian:
        return ("Speed and roughness are zero: dry Hertz contact, in closed form.",)
    if not state.outcome.ok:
        return shape_notes(contact)
    notes = [*shape_notes(contact), *law_notes(groups, contact, values)]
    model = groups.model
    if model.cavitation is not Cavitation.NONE and groups.speed > 0:
        if model.cavity_pressure == 0.0:
            notes.append(WAKE_NOTE)
        elif state.lowest_pressure <= model.cavity_pressure:
            notes.append(CAVITY_NOTE)
        finest = PROBLEMS[effective_model(model).cavitation][0].finest
        if state.rtol == finest:
            notes.append(f"Under a ball such a film holds rtol = {finest:g} at best: a smaller one counts as that.")
    elif contact is not None and groups.speed > 0:
        notes += cavitation_notes(
            contact,
            state.lowest_pressure,
            "Where it breaks at ambient pressure asperities carry 7 to 15 % of the load less in mixed lubrication.",
        )
    if groups.speed > 0:
        film = model.film.at(groups.speed)
        notes += fluid_notes(film, np.array([values.minimum_gap]), np.array([state.lowest_pressure]), math.nan)
    thickness = 0.0 if contact is None else values.central_gap * contact.slope**2
    if thickness > MAX_FILM_SLOPE:
        notes.append(
            f"{THICK_PREFIX} {thickness:.2g} radii thick: lubrication theory is the limit of thin films, and the friction of "
            "a ball is known to the first order in that ratio only."
        )
    wetted = values._wetted_radius
    if wetted is not None and wetted < FAR_FILM_MIN_RADIUS:
        notes.append(
            f"{WETTED_PREFIX} {wetted:.2g} Hertz radii: friction is counted up to that edge, and films, pressures and load "
            "shares are those of a ball in liquid, which one that ends below about "
            f"{FAR_FILM_MIN_RADIUS:g} Hertz radii changes."
        )
    return tuple(notes)
