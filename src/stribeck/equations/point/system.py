r"""The coupled equations of the point contact on a polar mesh: residual and the products of its Jacobian.

Unknowns are the gap and the fluid pressure at the nodes and the offset.  With K Boussinesq's operator,

.. math::

    R_1 &= h - z_0 - r^2/2 - K (p_c + p_f), \\
    R_2 &= \int \nabla v \cdot (h^3 \nabla p_f - \lambda h \, \mathbf e_x)
           - \oint v \, (h^3 \partial_r p_f - \lambda h \cos\theta), \\
    R_3 &= \int (p_c + p_f) - 2 \pi/3

for every v of the mesh.  At the rim the slope of the pressure is that of the far field beyond.

Newton's step is reduced to the total pressure: :math:`dh = K \, dp + dz - R_1`, :math:`dp_f = dp - p_c' dh`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from stribeck._types import Array
from stribeck.contact_laws.law import ContactLaw
from stribeck.contacts.cut_off import FULL_FAR_FILM, FarFilm
from stribeck.equations.point.far_field import DEFLECTION_COEFFICIENT, particular, rates
from stribeck.equations.point.films import ISOVISCOUS_PLANE, PlaneFilm
from stribeck.numerics.dual import with_slope
from stribeck.numerics.fourier_panels import PolarMesh
from stribeck.numerics.trace import Matrix, Trace, Value, act
from stribeck.quantities.lazy import cached_property
from stribeck.solids.half_plane import HalfPlane
from stribeck.solids.half_space import deflections_from_beyond, tilt_from_beyond
from stribeck.solids.plane import BODIES
from stribeck.solids.solid import Solid

LOAD = 2.0 * np.pi / 3.0  # Load in Hertz units: the integral of the pressure


@dataclass(frozen=True, eq=False)
class Operators:
    """Operators of a mesh; computed once and kept for all states that share it."""

    mesh: PolarMesh
    solid: Solid = HalfPlane()

    @property
    def bulge(self) -> float:
        """The deflection under the load, far away, times the distance."""
        return DEFLECTION_COEFFICIENT * BODIES[type(self.solid)].reaches

    @cached_property
    def deflection(self) -> Array:
        """K: pressures by mode -> deflections by mode, shape (modes, rings, rings)."""
        # Outside the rim the film pressure falls as r**-3, in the first mode: that tilts the surface within.
        body = BODIES[type(self.solid)]
        found = body.deflection(self.mesh, self.solid)
        if self.mesh.modes > 1:
            found[1, :, -1] += body.reaches * tilt_from_beyond(self.mesh, -3.0)
        return found

    @cached_property
    def deflection_from_beyond(self) -> Array:
        """Deflection by mode under a pressure that falls as r**-3 beyond the rim, shape (modes, rings)."""
        return BODIES[type(self.solid)].reaches * deflections_from_beyond(self.mesh, -3.0, self.mesh.modes)

    @cached_property
    def parabola(self) -> Array:
        """The undeformed gap at the nodes, shape (rings,)."""
        return 0.5 * self.mesh.radii**2

    @cached_property
    def rim_rates(self) -> Matrix:
        """Film pressure without a source at the rim -> its radial derivative."""
        mesh = self.mesh
        return Matrix((mesh.cosines * rates(mesh.modes)) @ mesh.to_modes / mesh.rim)

    @cached_property
    def load_row(self) -> Array:
        """Weights of the load on the axisymmetric mode, shape (rings,)."""
        return self.mesh.area_weights * self.mesh.modes

    def deflect(self, by_mode: Array) -> Array:
        """Return the deflection by mode under a pressure by mode, shape (modes, rings)."""
        return np.asarray(np.matmul(self.deflection, by_mode[:, :, None])[:, :, 0])


@dataclass(frozen=True, eq=False)
class Unknowns:
    """Gap and fluid pressure at the nodes, shape (modes, rings), and the offset."""

    gap: Array
    fluid: Array
    offset: float

    def moved(self, step: Unknowns, part: float) -> Unknowns:
        """Return the unknowns after a part of a step."""
        return Unknowns(self.gap + part * step.gap, self.fluid + part * step.fluid, self.offset + part * step.offset)


@dataclass(frozen=True, eq=False)
class Equations:
    """The discretised problem for one speed, one contact law and one film."""

    operators: Operators
    speed: float
    law: ContactLaw
    film: PlaneFilm = ISOVISCOUS_PLANE
    least: float = -np.inf
    """The lowest film pressure."""

    far: ClassVar[FarFilm] = FULL_FAR_FILM
    finest: ClassVar[float] = 0.0
    """Smallest tolerance that is aimed at."""
    order: ClassVar[float] = np.inf
    """Power of the number of angles with which errors fall."""

    @property
    def load_row(self) -> Array:
        """Weights of the load on the axisymmetric mode, shape (rings,)."""
        return self.operators.load_row

    @cached_property
    def outside_film(self) -> Any:
        """The film outside the rim less a film of constant viscosity; None where there is no such difference."""
        return self.film.outside_film(self.speed, self.operators.mesh) if self.speed > 0 else None

    def friction_error_outside(self, y: Unknowns) -> float:
        """Return an estimate of the error of the friction integrals by a film that still thins beyond the rim."""
        return 0.0 if self.outside_film is None else self.outside_film.friction_error(y.offset)

    def shear_error(self, y: Unknowns) -> float:
        """Return an estimate of the error of the total shear over h that no mesh tells: none in a full film."""
        del y
        return 0.0

    @cached_property
    def more_at_rim(self) -> Array:
        """Pressure, radial derivative and flux at the angles of the rim more than of a film of constant viscosity."""
        mesh = self.operators.mesh
        return np.zeros((3, mesh.modes)) if self.outside_film is None else self.outside_film.at_rim(mesh.angles, mesh.modes)

    def deflect(self, by_mode: Array) -> Array:
        """Return the deflection by mode under a pressure by mode, shape (modes, rings)."""
        return self.operators.deflect(by_mode)

    def shear_missing(self, y: Unknowns) -> Array:
        """Return by how much the shear over h on each ring is less where the gap is not full of liquid, shape (rings,)."""
        return np.zeros(self.operators.mesh.rings)

    def linear(self, y: Unknowns) -> Linear:
        """Return the Jacobian at a solution."""
        return Linear(self, y)

    def with_same_active_set(self, y: Unknowns, like: Unknowns) -> Unknowns:
        """Return unknowns that break where a solution of neighbouring equations does."""
        del like
        return y

    def residual(self, y: Unknowns) -> tuple[Array, Array, float]:
        """Return R_1 at the nodes, R_2 by node, both of shape (modes, rings), and R_3."""
        op, mesh = self.operators, self.operators.mesh
        total = self.law.pressure(y.gap) + y.fluid
        by_mode = mesh.to_modes @ total
        shape = y.gap - y.offset - op.parabola - mesh.cosines @ self.deflect(by_mode)
        return shape, self.flow(y.gap, y.fluid, y.offset), float(self.load_row @ by_mode[0]) - LOAD

    def flow(self, h: Array, p: Array, offset: float) -> Array:
        """Return the weak residual of Reynolds' equation, R_2."""
        mesh = self.operators.mesh
        radial, angular, (wide, carried) = self.film.fluxes(mesh, self.speed, h, p)
        found = mesh.radial_transpose(radial) + mesh.angular_derivative.T @ angular
        cos, x, part = np.cos(mesh.angles), mesh.rim, np.pi / mesh.modes
        own = wide * self.rim_slope(p[:, -1], offset) + self.more_at_rim[2]
        found[:, -1] += part * x * (self.speed * cos * carried - own)
        return found

    def rim_slope(self, p: Array, offset: Value) -> Any:
        """Return the radial derivative of the film pressure at the rim, p being that pressure."""
        mesh = self.operators.mesh
        first, slope = particular(np.array([mesh.rim]), offset, self.speed, bulge=self.operators.bulge)
        cos, (more, more_slope, _) = np.cos(mesh.angles), self.more_at_rim
        return act(self.operators.rim_rates, p - first * cos - more) + slope * cos + more_slope

    def rim_rates(self, offset: float) -> Array:
        """Return the derivative of :meth:`rim_slope` by the pressure, shape (angles, angles)."""
        return self.operators.rim_rates.matrix

    def rim_slope_by_offset(self, p: Array, offset: float) -> Array:
        """Return the derivative of :meth:`rim_slope` by the offset."""
        traced = self.rim_slope(p, Trace.number("offset", np.array([offset])))
        return np.asarray(traced.columns["offset"])


class Linear:
    """The Jacobian at a state, reduced to the total pressure by mode and the offset."""

    def __init__(self, equations: Equations, y: Unknowns) -> None:
        self.equations, self.y = equations, y
        mesh, speed, h = equations.operators.mesh, equations.speed, y.gap
        self.contact_slope = with_slope(equations.law.pressure, h)[1]
        self.film = equations.film.slopes(mesh, speed, h, y.fluid)
        # At the rim the film is that at ambient pressure.
        mobility, by_gap, carried_by_gap = self.film.rim
        x, part = mesh.rim, np.pi / mesh.modes
        slope = equations.rim_slope(y.fluid[:, -1], y.offset)
        self.rates_at_rim = equations.rim_rates(y.offset)
        self.rim_of_pressure = -part * x * mobility
        self.rim_of_gap = part * x * (speed * np.cos(mesh.angles) * carried_by_gap - by_gap * slope)
        self.rim_of_offset = self.rim_of_pressure * equations.rim_slope_by_offset(y.fluid[:, -1], y.offset)

    def flow(self, dp: Array, dh: Array) -> Array:
        """Return the change of R_2 under changes of fluid pressure and gap at the nodes."""
        mesh = self.equations.operators.mesh
        film, in_radius, in_angle = self.film, mesh.radial_derivative(dp), mesh.angular_derivative @ dp
        radial = film.radial_of_pressure * in_radius + film.radial_of_gap * mesh.scattered(dh)
        angular = film.angular_of_pressure * in_angle + film.angular_of_gap * dh
        if film.of_value is not None:
            radial += film.of_value[0] * mesh.scattered(dp)
            angular += film.of_value[1] * dp
        if film.crossed is not None:
            radial += film.crossed * mesh.scattered(in_angle)
            angular += mesh.gathered(film.crossed * in_radius)
        found = mesh.radial_transpose(radial) + mesh.angular_derivative.T @ angular
        found[:, -1] += self.rim_of_pressure * (self.rates_at_rim @ dp[:, -1]) + self.rim_of_gap * dh[:, -1]
        return found

    def changes(self, x: Array, shape: Array | float = 0.0) -> Unknowns:
        """Return the changes of the unknowns for a change of total pressure and offset, R_1 being ``shape``."""
        mesh = self.equations.operators.mesh
        by_mode = x[:-1].reshape(mesh.modes, mesh.rings)
        dh = mesh.cosines @ self.equations.deflect(by_mode) + x[-1] - shape
        return Unknowns(dh, mesh.cosines @ by_mode - self.contact_slope * dh, float(x[-1]))

    def product(self, x: Array) -> Array:
        """Return the change of R_2 by mode and of R_3."""
        mesh = self.equations.operators.mesh
        change = self.changes(x)
        flow = self.flow(change.fluid, change.gap)
        flow[:, -1] += self.rim_of_offset * x[-1]
        found = np.empty_like(x)
        found[:-1] = (mesh.cosines.T @ flow).ravel()
        found[-1] = self.equations.load_row @ x[: mesh.rings]
        return found

    def right(self, residual: tuple[Array, Array, float]) -> Array:
        """Return the right-hand side of Newton's step."""
        mesh = self.equations.operators.mesh
        shape, flow, load = residual
        # What R_1 moves, the gap and with it the contact pressure, is taken off the flow.
        moved = self.flow(self.contact_slope * shape, -shape)
        return np.append(-(mesh.cosines.T @ (flow + moved)).ravel(), -load)

    def sources(self, change: tuple[Array, Array, float], least: float) -> Array:
        """Return the right-hand side for the change of the unknowns with that of the residual and of the least pressure."""
        del least
        return self.right(change)
