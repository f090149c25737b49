"""A solved state of the point contact: its observables, their errors, and the fields anywhere.

Lengths are in Hertz radii a, gaps in indentations u = a**2/R, pressures in p_Hz, the load being 2 pi/3.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np

from stribeck._types import Array
from stribeck.contact_laws.law import area_slope
from stribeck.contacts.contact import Contact
from stribeck.contacts.cut_off import far_error, far_film, friction_integral, is_far
from stribeck.contacts.friction import Definition, sliding_part
from stribeck.contacts.geometries import PointContact
from stribeck.contacts.groups import Groups
from stribeck.contacts.parts import PURE_SLIDING
from stribeck.equations.point.observables import OBSERVABLES, WITHIN, FrictionWithin, observables
from stribeck.equations.point.system import LOAD, Equations, Unknowns
from stribeck.fluids.fluid import Cavitation
from stribeck.numerics.settings import PLACES_AROUND_NODE
from stribeck.quantities.lazy import cached_property
from stribeck.quantities.outcome import Outcome
from stribeck.quantities.outputs import AREA
from stribeck.solver.point.estimate import Pair, without_tolerance

# Friction integrals whose errors are relative to themselves; J_pcx vanishes in full films, so its scale is the friction.
SELF_SCALED = ("J_couette", "J_poiseuille", "J_balanced", "J_published")


class PointFields(NamedTuple):
    """Fields of a state at given positions, each of the broadcast shape of x and y."""

    gap: Array  # Gap [u_Hz]
    contact_pressure: Array  # Part of the pressure from asperities [p_Hz]
    fluid_pressure: Array  # Part of the pressure from the fluid [p_Hz]


@dataclass(frozen=True, eq=False)
class PointState:
    """A state of the point contact."""

    groups: Groups  # The state that was solved
    rtol: float  # The relative tolerance asked for
    outcome: Outcome  # How the solve ended; where it is not `ok` the values are not to be used, and may be nan
    values: Mapping[str, float]  # The observables by :data:`OBSERVABLES`
    absolute_errors: Mapping[str, float]  # Their estimated absolute errors
    scales: Mapping[str, float]  # Scale of each error: one for the shares, else about the observable itself
    identity_error: float  # `J_balanced - J_published - J_pcx + 0.4 pi lambda`, zero but for the errors of mesh and iteration
    load_error: float  # Error of the load carried by the pressures, relative to the load
    mesh: Any = field(repr=False)
    nodal_gap: Array = field(repr=False)  # Gap at the nodes [u_Hz]
    nodal_contact_pressure: Array = field(repr=False)  # Pressure of asperities at the nodes [p_Hz]
    nodal_fluid_pressure: Array = field(repr=False)  # Pressure of the fluid at the nodes [p_Hz]
    fields: Callable[[Array, Array], PointFields] = field(repr=False)
    newton_steps: int = 0  # Newton steps
    krylov_steps: int = 0  # GMRES steps
    work: Any = field(default=None, repr=False)  # Operators and preconditioner from which neighbours start; None if dropped

    def without_factors(self) -> PointState:
        """Return the state without the factors that fill the memory, from which neighbours may still start."""
        return self if self.work is None else replace(self, work=self.work.without_operators())

    @property
    def errors(self) -> dict[str, float]:
        """Estimated errors relative to the scales: relative, but absolute for the shares."""
        return {name: error / self.scales[name] for name, error in self.absolute_errors.items()}

    @property
    def relative_errors(self) -> dict[str, float]:
        """Estimated errors as a solution states them, with shear and pressure flow relative to themselves."""
        # The scale of both is the whole friction, which may be many times the part.
        own = {name: abs(self.values[name]) for name in SELF_SCALED if self.values[name] != 0}
        return {name: error / own.get(name, self.scales[name]) for name, error in self.absolute_errors.items()}

    @property
    def error_estimate(self) -> float:
        """Largest estimated error among the observables that rtol limits."""
        apart = without_tolerance(self.groups.model.cavitation is not Cavitation.NONE)
        return max((error for name, error in self.errors.items() if name not in apart), default=math.nan)

    @cached_property
    def lowest_pressure(self) -> float:
        """Lowest film pressure, on the middle line also between the nodes [p_Hz]."""
        x = np.concatenate([-self.mesh.radii[::-1], self.mesh.radii])
        node = int(np.clip(np.argmin(self.fields(x, 0 * x).fluid_pressure), 1, len(x) - 2))
        around = np.linspace(x[node - 1], x[node + 1], PLACES_AROUND_NODE)
        return float(min(self.nodal_fluid_pressure.min(), self.fields(around, 0 * around).fluid_pressure.min()))

    @cached_property
    def within(self) -> Callable[[int, float], float] | None:
        """Friction integrals up to a radius, see :class:`FrictionWithin`; None at rest."""
        if not (isinstance(self.work, Pair) and self.groups.speed > 0):
            return None
        fine = self.work.fine
        return FrictionWithin.of(fine.equations, fine.unknowns, self.values)

    @property
    def real_contact_area(self) -> tuple[float, float]:
        """The real area of contact over pi a^2 and its absolute error, that of a law that knows it."""
        law: Any = self.groups.law
        scale, contact = float(self.groups.pressure_scale), self.nodal_contact_pressure
        value = area_integral(law, contact, self.mesh, scale)
        # The load is an integral of the same pressure on the same nodes, and no area grows faster than at small pressure.
        share = float((contact @ self.mesh.area_weights).sum()) / LOAD
        missed = abs(share - self.values["contact_load_share"]) + self.errors["contact_load_share"]
        return value, missed * LOAD / math.pi * area_slope(law) * scale

    @property
    def minimum_gap_error(self) -> float:
        """Estimated relative error of the minimum film."""
        return self.errors.get("minimum_gap", math.nan)

    @property
    def effort(self) -> float:
        """Measure by which :class:`stribeck.numerics.continuation.StepPath` chooses its steps."""
        return float(self.newton_steps)


def area_integral(law: Any, pressure: Array, mesh: Any, scale: float) -> float:
    """Return the real area of contact over pi a^2 by a contact pressure at the nodes, whose unit has that scale in the law."""
    return float((law.area_fraction_at(pressure * scale) @ mesh.area_weights).sum()) / math.pi


def measured(
    equations: Equations, y: Unknowns, law: Any = None, cut_offs: tuple[float, float] | None = None
) -> dict[str, float]:
    """Return the observables of a state, its real area by a law that knows it, and :data:`WITHIN` of cut-offs."""
    found = observables(equations, y)
    if law is not None:
        scaled: Any = equations.law
        scale = float(scaled.load**scaled.pressure_exponent)
        found[AREA] = area_integral(law, scaled.pressure(y.gap), equations.operators.mesh, scale)
    if cut_offs is not None:
        within = FrictionWithin.of(equations, y, found)
        found |= {name: within(i, float(cut_offs[min(i, 1)])) for i, name in enumerate(WITHIN)}
    return found


@dataclass(frozen=True)
class PointObservables:
    """The observables of one state of a ball in Hertz units; the friction integrals J by their finite parts."""

    contact_load_share: float
    fluid_load_share: float
    central_gap: float
    minimum_gap: float
    minimum_radius: float
    minimum_angle: float
    minimum_gap_on_axis: float
    central_pressure: float
    offset: float
    J_couette: float
    J_poiseuille: float
    J_balanced: float
    J_published: float
    J_pcx: float
    _groups: Groups = field(repr=False)
    _slide_to_roll: float = PURE_SLIDING
    _wetted_radius: float | None = None
    _within: Callable[[int, float], float] | None = field(default=None, repr=False)

    @classmethod
    def of(cls, state: PointState, contact: Contact | None) -> PointObservables:
        """Return the observables of a state for the motion and the liquid of a contact."""
        values = {name: float(state.values[name]) for name in OBSERVABLES}
        wetted, slide_to_roll = None, 2.0 * state.groups.model.film.slide
        if isinstance(contact, PointContact):
            slide_to_roll = contact.slide_to_roll
            wetted = None if contact.wetted_radius is None else contact.wetted_radius / contact.hertz.half_width
        within = None if is_far(state.groups.model, wetted or math.inf) else state.within
        return cls(**values, _groups=state.groups, _slide_to_roll=slide_to_roll, _wetted_radius=wetted, _within=within)

    def integral(self, slope: float, definition: Definition = "balanced") -> float:
        r"""Return the friction integral J up to where the liquid ends.

        .. math:: J = \frac S2 J^\mathrm{couette} + J^\mathrm{poiseuille}

        of the film up to there; where its fields are not at hand those of :func:`stribeck.contacts.cut_off.friction_integral`.
        """
        parts = {name: getattr(self, name) for name in ("J_couette", "J_poiseuille", "J_pcx")}
        wetted = math.inf if self._wetted_radius is None else self._wetted_radius
        speed, far = float(self._groups.speed), far_film(self._groups.model)
        return float(friction_integral(parts, speed, slope, self._slide_to_roll, wetted, definition, far, self._within))

    def drags_along(self, slope: float) -> bool:
        """Return whether the friction up to a wetted radius has the wrong sign, and so is unresolved."""
        # In a film much thicker than the parabola's rise up to there friction is a small difference.
        is_certain = self._wetted_radius is None or self._slide_to_roll != PURE_SLIDING or not self._groups.speed > 0
        return not is_certain and not self.integral(slope) > 0

    @property
    def sliding(self) -> float:
        """Fraction of the sliding friction of asperities that acts, with its sign."""
        return float(sliding_part(self._slide_to_roll))

    def viscous_friction(self, beta: float, definition: Definition = "balanced") -> float:
        r"""Return the viscous friction coefficient.

        .. math:: \mu_f = \tfrac34 \beta \bar F_N^{1/3} J = \frac{3}{2\pi} \frac aR J
        """
        slope = float(self._groups.slope(beta))
        return 1.5 / math.pi * slope * self.integral(slope, definition)

    def viscous_error(self, beta: float, errors: dict[str, float], definition: Definition = "balanced") -> float:
        """Return the absolute error of the viscous friction coefficient from the errors of the finite parts."""
        error = errors["J_pcx"] if definition == "published" else 0.0
        if self._slide_to_roll == PURE_SLIDING:
            error += errors["J_balanced"]
        else:
            error += 0.5 * abs(self._slide_to_roll) * errors["J_couette"] + errors["J_poiseuille"]
        if self._wetted_radius is not None and self._within is None:
            speed, far = float(self._groups.speed), far_film(self._groups.model)
            error += float(far_error({"J_couette": self.J_couette}, speed, self._slide_to_roll, self._wetted_radius, far))
        return 1.5 / math.pi * float(self._groups.slope(beta)) * error
