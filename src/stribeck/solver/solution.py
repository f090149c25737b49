"""What a solve returns: fields and observables of one state, with outcome, error estimate and what to know about them."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, fields
from functools import cached_property
from typing import Literal

import numpy as np

from stribeck._types import Array, Indices
from stribeck.contact_laws.law import WithArea
from stribeck.contacts.contact import Contact
from stribeck.contacts.friction import DEFINITIONS, Definition, Friction, check_definition, coefficients
from stribeck.contacts.groups import Groups
from stribeck.equations.gap import gap_at
from stribeck.equations.observables import Observables
from stribeck.numerics.panels import Mesh
from stribeck.quantities.inputs import refuse_former
from stribeck.quantities.outcome import Outcome
from stribeck.quantities.outputs import FILMS, HERTZ, NAMES
from stribeck.quantities.outputs import ROWS as OUTPUTS
from stribeck.quantities.units import InputError, real_array, show

_OWN = frozenset(field.name for field in fields(Observables))

__all__ = ["Friction", "Profile", "Solution"]


@dataclass(frozen=True)
class Profile:
    """Fields along the contact.

    Attributes
    ----------
    x : ndarray, shape (n,)
        Positions [a or m].
    gap : ndarray, shape (n,)
        Gap [u_Hz or m].
    contact_pressure, fluid_pressure : ndarray, shape (n,)
        The two parts of the pressure [p_Hz or Pa].
    unit : {"Hertz", "SI"}
        Which of the two units hold.
    """

    x: Array
    gap: Array
    contact_pressure: Array
    fluid_pressure: Array
    unit: Literal["Hertz", "SI"] = "Hertz"

    @property
    def pressure(self) -> Array:
        """Total pressure, contact and fluid."""
        return self.contact_pressure + self.fluid_pressure


@dataclass(frozen=True, eq=False)
class Solution:
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
        The part of the error estimate that double precision causes and no mesh removes.
    mesh : Mesh
        The final discretisation.
    nodal_gap : ndarray, shape (nodes,)
        The gap in the order of the mesh; :attr:`gap` gives it by position.
    nodal_pressures : callable
        Returns contact and fluid pressure in the order of the mesh.
    gap_shift : float
        What :attr:`gap` adds to ``nodal_gap``: at speed zero the load only shifts the gap [u_Hz].
    newton_steps : int
        Steps of its Newton iteration.

    Notes
    -----
    Observables (``contact_load_share`` ... ``offset``) are attributes too, see the table of symbols in theory.md.
    """

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
    nodal_pressures: Callable[[], tuple[Array, Array]] = field(repr=False)
    newton_steps: int = 0

    @property
    def nodes(self) -> int:
        """Unknown gaps in the final discretisation."""
        return self.mesh.size

    @cached_property
    def error_estimate(self) -> float:
        """Largest estimated relative error of the observables; load shares count absolutely.

        It says nothing about :attr:`minimum_position`, which has :attr:`minimum_position_error`.
        """
        return float(np.nanmax(self.relative_errors))

    @property
    def errors(self) -> dict[str, float]:
        """Estimated relative error of each observable; absolute for the load shares."""
        return dict(zip(NAMES, map(float, self.relative_errors), strict=True))

    @cached_property
    def _pressures(self) -> tuple[Array, Array]:
        return self.nodal_pressures()

    @cached_property
    def _ordered(self) -> Indices:
        return np.argsort(self.mesh.nodes)

    @property
    def x(self) -> Array:
        """Positions of the nodes, ascending [a]; the outermost lie thousands of half-widths away."""
        return np.asarray(self.mesh.nodes[self._ordered])

    @property
    def gap(self) -> Array:
        """Gap at :attr:`x` [u_Hz]."""
        return np.asarray(self.nodal_gap[self._ordered]) + self.gap_shift

    @property
    def contact_pressure(self) -> Array:
        """Contact pressure at :attr:`x` [p_Hz]."""
        return np.asarray(self._pressures[0][self._ordered])

    @property
    def fluid_pressure(self) -> Array:
        """Fluid pressure at :attr:`x` [p_Hz]; negative behind the contact, as the fluid does not cavitate."""
        return np.asarray(self._pressures[1][self._ordered])

    @property
    def pressure(self) -> Array:
        """Total pressure at :attr:`x` [p_Hz]."""
        return self.contact_pressure + self.fluid_pressure

    def __getattr__(self, name: str) -> float:
        """Return an observable under its own name."""
        if name in _OWN:
            return float(getattr(self.observables, name))
        raise AttributeError(f"{type(self).__name__} has no attribute {name!r}")

    def __dir__(self) -> list[str]:
        """Return the names of attributes, observables among them."""
        return [*super().__dir__(), *_OWN]

    @property
    def rigid_separation(self) -> float:
        """Another name of :attr:`offset` [u_Hz]: positive if the undeformed bodies are apart, negative if they overlap."""
        return self.offset

    @property
    def central_separation(self) -> float:
        """Central gap over h_rms/alpha [-], the Lambda of [BP]; infinite for smooth surfaces."""
        kappa = float(self.groups.relative_roughness)
        return self.central_gap / kappa if kappa > 0 else math.inf

    @property
    def lambda_ratio(self) -> float:
        """Minimum film thickness over h_rms [-]; infinite for smooth surfaces.

        Groups alone do not hold alpha: without a contact it is taken as one, and this is the minimum gap over h_rms/alpha.
        """
        kappa = float(self.groups.relative_roughness)
        alpha = 1.0 if self.contact is None else self.contact.alpha
        return self.minimum_gap / (alpha * kappa) if kappa > 0 else math.inf

    @property
    def separation(self) -> Array:
        """Separation ``s = alpha h/h_rms`` at :attr:`x` [-], in which contact laws are given; infinite for smooth surfaces."""
        kappa = float(self.groups.relative_roughness)
        return self.gap / kappa if kappa > 0 else np.full_like(self.x, np.inf)

    @property
    def area_fraction(self) -> Array | None:
        """Real area of contact over the apparent one at :attr:`x` [-]; None where the law knows no spectrum of the surface."""
        if not isinstance(self.groups.law, WithArea) or self.groups.roughness == 0:
            return None
        return self.groups.law.area_fraction_at(self.contact_pressure * float(self.groups.pressure_scale))

    @property
    def central_area_fraction(self) -> float:
        """Real area of contact over the apparent one at x = 0 [-]; nan where the law knows no spectrum of the surface."""
        return self._central_area()[0]

    @property
    def central_area_fraction_error(self) -> float:
        """Estimated absolute error of :attr:`central_area_fraction` [-], by that of the central gap."""
        return self._central_area()[1]

    def _central_area(self) -> tuple[float, float]:
        law = self.groups.law
        if not isinstance(law, WithArea) or self.groups.roughness == 0:
            return math.nan, math.nan
        error = abs(self.central_gap) * self.errors["central_gap"]
        gaps = np.array([self.central_gap, self.central_gap - error, self.central_gap + error])
        found = law.area_fraction_at(np.exp(law.log_pressure(gaps / float(self.groups.relative_roughness))))
        return float(found[0]), float(np.abs(found[1:] - found[0]).max())

    @property
    def law_parameters(self) -> dict[str, float | str]:
        """Parameters of the contact law beside alpha, beta and h_rms; none of the exponential one."""
        return {} if self.groups.law is None else self.groups.law.parameters

    @property
    def hersey_number(self) -> float:
        """Hersey number eta U/F_N [-], U the sum of the surface speeds; for beta = 1 where only groups are known."""
        return float(self.groups.hersey_number() if self.contact is None else self.contact.hersey_number)

    @refuse_former
    def friction(
        self, boundary_friction: float | None = None, beta: float | None = None, definition: Definition = "balanced"
    ) -> Friction:
        r"""Return the friction coefficient.

        .. math:: \mu = \mu_0 \frac{F_c}{F_N} + \beta \, \mu_f(\beta = 1)

        Parameters
        ----------
        boundary_friction : float, optional
            Friction coefficient of the dry contact [-], >= 0; that of the contact, or 1, if omitted.
        beta : float, optional
            Coefficient of the contact law [-], > 0; that of the contact, or 1, if omitted.
        definition : {"balanced", "published"}
            Viscous part as the force on the substrate, which balances all forces on the cylinder, or as published.
            They agree where asperities carry nothing; in boundary lubrication the published one is larger.

        Returns
        -------
        Friction
            Contact, viscous and total friction [-].

        Raises
        ------
        InputError
            If an argument is outside its range.

        Notes
        -----
        Source: [BP] Eq. (friction); theory.md, section 6, for the balanced form.
        """
        boundary_friction, beta = coefficients(self.contact, boundary_friction, beta)
        name = f"viscous_{check_definition(definition)}"
        contact = boundary_friction * self.contact_load_share
        viscous = beta * float(getattr(self.observables, name))
        share, relative = self.relative_errors[0], self.relative_errors[NAMES.index(name)]
        return Friction(contact, viscous, contact + viscous, float(boundary_friction * share + abs(viscous) * relative))

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
        Between the nodes the gap is good to a few ``rtol``, relatively, in what ``solve`` returns
        (``test_solve.py::test_the_profile_is_the_elastic_gap_of_its_pressure``), and to about 1e-4 on the points of a
        curve, whose meshes are made for the observables.
        """
        points = np.atleast_1d(real_array("x", x))
        if points.ndim != 1 or not np.isfinite(points).all():
            raise InputError(f"x = {show(x)}; positions must be finite numbers in one dimension.")
        pressures = np.stack(self._pressures)
        contact, fluid = self.mesh.interpolate(pressures, points)
        return Profile(points, gap_at(self.mesh, self.nodal_gap, points) + self.gap_shift, contact, fluid)

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
        if self.contact is None:
            raise InputError(
                "to_si needs the Hertz scales of a contact; solve a LineContact or PointContact instead of Groups."
            )
        scales = self.contact.hertz
        if x is None:
            p = Profile(self.x, self.gap, self.contact_pressure, self.fluid_pressure)
        else:
            p = self.profile(np.asarray(x, dtype=float) / scales.half_width)
        return Profile(
            p.x * scales.half_width,
            p.gap * scales.indentation,
            p.contact_pressure * scales.pressure,
            p.fluid_pressure * scales.pressure,
            "SI",
        )

    @refuse_former
    def to_dict(self, boundary_friction: float | None = None, beta: float | None = None) -> dict[str, object]:
        """Return inputs, observables, both frictions, errors and outcome under their names, ready for JSON.

        Parameters
        ----------
        boundary_friction, beta : float, optional
            As in :meth:`friction`.

        Returns
        -------
        dict
            Numbers, text, lists and dictionaries of these; nan or infinity where a quantity does not exist.
        """
        result: dict[str, object] = {
            "speed": float(self.groups.speed),
            "load": float(self.groups.load),
            "roughness": float(self.groups.roughness),
            "contact_law": self.law,
            "contact_law_parameters": self.law_parameters,
        }
        result |= {row.name: getattr(self, row.name) for row in OUTPUTS if row.listed}
        result["hersey_number"] = self.hersey_number
        if isinstance(self.groups.law, WithArea):
            result["central_area_fraction"] = self.central_area_fraction
            result["central_area_fraction_error"] = self.central_area_fraction_error
        for definition in DEFINITIONS:
            f = self.friction(boundary_friction, beta, definition)
            parts = {"contact": f.contact, "viscous": f.viscous, "total": f.total, "error": f.error}
            result[f"friction_{definition}"] = parts
        result["errors"] = self.errors
        result |= {"error_estimate": self.error_estimate, "rtol": self.rtol, "nodes": self.nodes}
        result |= {"outcome": self.outcome.name, "message": self.outcome.value, "notes": list(self.notes)}
        return result


def si_films(solution: Solution) -> dict[str, tuple[float, str, str]]:
    """Return films and Hertz scales of a solution in SI units: value, unit and long name of each.

    Parameters
    ----------
    solution : Solution
        A state; one that comes from groups alone has no scales.

    Returns
    -------
    dict
        By name; empty where there is no contact.
    """
    if solution.contact is None:
        return {}
    hertz = solution.contact.hertz
    scales = {"gap": hertz.indentation, "width": hertz.half_width}
    values = {row.film: getattr(solution, row.name) * scales[row.scale] for row in OUTPUTS if row.film}
    values |= zip(HERTZ, (hertz.half_width, hertz.indentation, hertz.pressure), strict=True)
    return {name: (values[name], *about) for name, about in FILMS.items()}
