"""The result of a solve: fields and observables of one state, with outcome, error estimate and notes."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from stribeck._types import Array, Indices
from stribeck.contact_laws.law import WithArea
from stribeck.contacts.contact import Contact
from stribeck.contacts.friction import Definition, sliding_part
from stribeck.contacts.groups import Groups
from stribeck.equations.gap import gap_at
from stribeck.equations.observables import Observables, drag_parts, real_area
from stribeck.numerics.panels import Mesh
from stribeck.quantities.lazy import cached_property
from stribeck.quantities.outcome import Outcome
from stribeck.quantities.outputs import ALL_NAMES, LINE_BY_CAVITATION, NAMES, OutputTable
from stribeck.quantities.units import InputError, real_array, show
from stribeck.solver.base_solution import BaseSolution
from stribeck.solver.fields import Profile

if TYPE_CHECKING:
    import xarray


@dataclass(frozen=True, eq=False, repr=False)
class Solution(BaseSolution):
    r"""One solved state of the contact.

    Lengths along the contact are in Hertz half-widths a, gaps in indentations u_Hz, pressures in p_Hz.

    Attributes
    ----------
    groups : Groups
        The state that was solved.
    contact : Contact or None
        The contact in SI units it came from.
    outcome : Outcome
        How the solve ended; its value is a sentence.
    notes : tuple of str
        What to know before using the numbers, one sentence each: where the contact law leaves its range, where rounding
        bounds the error.
    rtol : float
        The relative tolerance asked for.
    law : str
        Name of the contact law.
    observables : Observables
        The observables as one object, in Hertz units and for beta = 1.
    relative_errors : ndarray
        Estimated relative errors of the observables, by name in :attr:`errors`.
    minimum_position_error : float
        Estimated absolute error of :attr:`minimum_position` [a], not covered by :attr:`error_estimate`; 1 for the dry smooth
        contact, where the gap is zero on all of the contact.
    rounding_floor : float
        The part of the error estimate that comes from rounding, which no mesh removes.
    mesh : Mesh
        The final discretisation.
    nodal_gap : ndarray, shape (nodes,)
        The gap in the order of the mesh; :attr:`gap` gives it by position.
    nodal_pressures : callable
        Returns contact and fluid pressure in the order of the mesh.
    gap_shift : float
        Shift of :attr:`gap` against ``nodal_gap``: at speed zero the load only shifts the gap [u_Hz].
    newton_steps : int
        Steps of its Newton iteration.
    origin : tuple of float
        Position x of a mesh coordinate: the first of the two, plus the second times the coordinate.

    Notes
    -----
    Observables (``contact_load_share`` ... ``offset``) are attributes too, see the table of symbols in theory.md.
    """

    _picture = "stribeck.plot.state.plot_profile"

    groups: Groups
    contact: Contact | None
    outcome: Outcome
    notes: tuple[str, ...]
    rtol: float
    law: str
    observables: Observables
    relative_errors: Array = field(repr=False)
    minimum_position_error: float
    rounding_floor: float
    mesh: Mesh = field(repr=False)
    nodal_gap: Array = field(repr=False)
    gap_shift: float = field(repr=False)
    nodal_pressures: Callable[[], tuple[Array, Array]] = field(repr=False, compare=False)
    newton_steps: int = 0
    origin: tuple[float, float] = (0.0, 1.0)

    @property
    def nodes(self) -> int:
        """Unknown gaps in the final discretisation."""
        return self.mesh.size

    @cached_property
    def error_estimate(self) -> float:
        """Largest estimated relative error of the observables; load shares count absolutely.

        Both drags count relative to the larger of them, as that on one wall may be zero.  It says nothing about
        :attr:`minimum_position`, which has :attr:`minimum_position_error`.
        """
        return float(np.nanmax(self.counted_errors))

    @property
    def counted_errors(self) -> Array:
        """The errors as the tolerance counts them, see :func:`stribeck.equations.observables.drag_scales`."""
        parts = drag_parts(self.observables.array())
        return np.asarray(self.relative_errors * parts[: len(self.relative_errors)])

    @property
    def errors(self) -> dict[str, float]:
        """Estimated relative error of each observable; absolute for the load shares; only those that the film has."""
        found = dict(zip(ALL_NAMES, map(float, self.relative_errors), strict=False))
        return {name: error for name, error in found.items() if name in NAMES or not math.isnan(error)}

    @property
    def outputs(self) -> OutputTable:
        """The table of the observables of this film."""
        return LINE_BY_CAVITATION[self.groups.model.cavitation]

    @property
    def _sliding(self) -> float:
        return float(sliding_part(2 * self.groups.model.film.slide))

    def _walls(self, beta: float) -> tuple[float, float]:
        return beta * self.observables.viscous_balanced, beta * self.observables.viscous_upper

    def _viscous(self, beta: float, definition: Definition) -> tuple[float, float]:
        viscous = self.observables.viscous_friction(beta, definition)
        return viscous, abs(viscous) * self.errors[f"viscous_{definition}"]

    @cached_property
    def _pressures(self) -> tuple[Array, Array]:
        return self.nodal_pressures()

    @cached_property
    def _ordered(self) -> Indices:
        return np.argsort(self.mesh.nodes)

    @property
    def x(self) -> Array:
        """Positions of the nodes, ascending [a]; the outermost lie thousands of half-widths away."""
        exit, cavity_stretch = self.origin
        nodes = self.mesh.nodes[self._ordered]
        return np.asarray(nodes) if self.origin == (0.0, 1.0) else exit + cavity_stretch * nodes

    @cached_property
    def _along(self) -> Profile:
        contact, fluid = self._pressures
        at = self._ordered
        return Profile(self.x, self.nodal_gap[at] + self.gap_shift, np.asarray(contact[at]), np.asarray(fluid[at]))

    @property
    def area_fraction(self) -> Array | None:
        """Real area of contact over the apparent one at :attr:`x` [-]; None for a law without a spectrum of the surface."""
        if not isinstance(self.groups.law, WithArea) or self.groups.roughness == 0:
            return None
        return self.groups.law.area_fraction_at(self.contact_pressure * float(self.groups.pressure_scale))

    def _area(self) -> tuple[float, float]:
        return real_area(self.groups, self.mesh, self.origin[1], self._pressures[0], self.errors["contact_load_share"])

    def profile(self, x: Array) -> Profile:
        """Return the fields at any positions from the polynomial on each panel.

        Parameters
        ----------
        x : array_like, shape (n,)
            Finite positions along the contact [a].

        Returns
        -------
        Profile
            In Hertz units.

        Raises
        ------
        InputError
            If a position is not finite.

        Notes
        -----
        Between the nodes the relative error of the gap is a few ``rtol`` in the result of ``solve``
        (``test_solve.py::test_the_profile_is_the_elastic_gap_of_its_pressure``), and to about 1e-4 on the points of a
        curve, whose meshes are made for the observables.
        """
        points = np.atleast_1d(real_array("x", x))
        if points.ndim != 1 or not np.isfinite(points).all():
            raise InputError(f"x = {show(x)}; positions must be finite numbers in one dimension.")
        exit, cavity_stretch = self.origin
        on_mesh = points if self.origin == (0.0, 1.0) else (points - exit) / cavity_stretch
        contact, fluid = self.mesh.interpolate(np.stack(self._pressures), on_mesh)
        if not math.isnan(self.exit_position):
            cavity = (on_mesh > 0) & (on_mesh < self.mesh.reformation)
            fluid = np.where(cavity, self.groups.model.cavity_pressure, fluid)
        gap = gap_at(self.mesh, self.nodal_gap, on_mesh, self._far_gap)
        return Profile(points, gap + self.gap_shift, contact, fluid)

    def _far_gap(self, xi: Array) -> Array:
        """Return the far part of the gap at a mesh coordinate; the rest is smooth in the inverse coordinate."""
        exit, cavity_stretch = self.origin
        return np.asarray(self.groups.model.solid.far_gap(cavity_stretch * xi) + exit * cavity_stretch * xi)

    @property
    def hysteresis_friction(self) -> float:
        """Friction by the losses of a viscoelastic solid over the slope a/R [-], beside :meth:`friction`; else zero.

        It is what the drags of both walls lack of the moment of the pressure (theory.md, section 12), which wide panels hold
        better than the slope of the surface.  With friction factors the drags are others, and that slope is taken.
        """
        return self._hysteresis[0]

    @property
    def hysteresis_error(self) -> float:
        """Estimated absolute error of :attr:`hysteresis_friction` [-]; NaN with friction factors."""
        return self._hysteresis[1]

    @cached_property
    def _hysteresis(self) -> tuple[float, float]:
        """Hysteresis friction, and how far it may be off: its difference from that by the slope, and what the drags err."""
        solid, (exit, cavity_stretch) = self.groups.model.solid, self.origin
        if not getattr(solid, "uses_speed", False):
            return 0.0, 0.0
        from stribeck.solids.viscoelastic import hysteresis_friction

        pressure = self._pressures[0] + self._pressures[1]
        mesh = replace(self.mesh, edges=cavity_stretch * self.mesh.edges, scale=cavity_stretch * self.mesh.scale)
        by_slope = hysteresis_friction(mesh, solid, pressure)
        if self.groups.model.film.parameters.get("friction_factors") == "true":
            return by_slope, math.nan
        moment = cavity_stretch * ((exit + cavity_stretch * self.mesh.nodes) * pressure) @ self.mesh.weights
        moment = moment + np.sum(self.groups.model.profile.moment(self.mesh, exit, pressure))
        drags = [(getattr(self.observables, name), self.errors[name]) for name in ("viscous_balanced", "viscous_upper")]
        per_slope = 1 / (2 * math.sqrt(float(self.groups.load)))
        found = float((drags[1][0] - drags[0][0]) * per_slope - 2 / math.pi * moment)
        return found, abs(found - by_slope) + per_slope * sum(abs(drag) * error for drag, error in drags)

    def to_si(self, x: Array | None = None) -> Profile:
        """Return the fields in SI units: positions and gaps in m, pressures in Pa.

        Parameters
        ----------
        x : array_like, shape (n,), optional
            Positions along the contact [m]; the nodes by default.

        Returns
        -------
        Profile
            In SI units.

        Raises
        ------
        InputError
            If the solution comes from groups alone, which do not fix the scales.
        """
        scales = self._scales()
        return (self._along if x is None else self.profile(np.asarray(x, dtype=float) / scales.half_width)).in_si(scales)

    def to_dataset(self) -> xarray.Dataset:
        """Return fields and numbers of the state as an xarray Dataset, in SI units where there is a contact.

        Returns
        -------
        xarray.Dataset
            Along ``x`` of the nodes: gap, contact pressure, fluid pressure; beside them every number of the state and its
            estimated error, and the inputs as attributes; needs the extra ``data``.

        Raises
        ------
        MissingExtraError
            If xarray is not installed.
        """
        return self._with_numbers((self._along if self.contact is None else self.to_si()).to_dataset())
