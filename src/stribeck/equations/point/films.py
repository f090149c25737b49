r"""The film of a ball: its flow in the plane under a pressure gradient and the motion of the walls.

.. math:: \nabla \cdot \big[ M \, \nabla p_f - \lambda \, C \, \mathbf e_x \big] = 0, \qquad
    M = \frac{\rho \, \phi \, h^3}{\eta}, \quad C = \rho \, (h + s S)

in Hertz units, with viscosity, density and flow factors as functions of pressure and gap; M is the same in all directions.
A fluid that thins has an M that depends on the gradient too (:mod:`stribeck.equations.thinning`): equations use
the fluxes and their derivatives only, whatever the law.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, NamedTuple, Protocol

import numpy as np

from stribeck._types import Array
from stribeck.fluids.laws import FlowFactors
from stribeck.fluids.newtonian import Newtonian
from stribeck.numerics.fourier_panels import PolarMesh


class Flow(NamedTuple):
    """Mobility M and carried amount C, with their derivatives; None as the one by pressure stands for zero."""

    mobility: Array
    carried: Array
    mobility_by_gap: Array
    carried_by_gap: Array
    mobility_by_pressure: Array | None = None
    carried_by_pressure: Array | None = None


class Fluxes(NamedTuple):
    """Fluxes times the weights of the weak form; mobility and carried amount at the rim."""

    radial: Array  # Along the radius, panel by panel, as gradients differ on both sides of an edge
    angular: Array  # Across the radius
    rim: tuple[Array, Array]  # Mobility and carried amount there


class FluxSlopes(NamedTuple):
    """The derivatives of :class:`Fluxes`, with the same weights."""

    radial_of_pressure: Array  # Along the radius, by the radial derivative of the pressure and by the gap
    angular_of_pressure: Array  # Across the radius, by the derivative of the pressure in the angle and by the gap
    radial_of_gap: Array  # Along the radius, by the radial derivative of the pressure and by the gap
    angular_of_gap: Array  # Across the radius, by the derivative of the pressure in the angle and by the gap
    of_value: tuple[Array, Array] | None  # By the pressure itself, along the radius and across it; None for nothing
    crossed: Array | None
    rim: tuple[Array, Array, Array]  # Mobility at the rim, and the derivatives of mobility and carried amount by the gap there


class OutsideFilm(Protocol):
    """The film outside the rim, less a film of constant viscosity."""

    is_all: ClassVar[bool]
    """Whether it is the whole film, but for the logarithms of friction."""

    @property
    def drag(self) -> float:
        """Estimate of the drag of the film outside the rim."""

    def friction_error(self, offset: float) -> float:
        """Return an estimate of the error of its friction integrals, with an offset."""

    def first(self, offset: float) -> float:
        """Return the factor of cos(theta) in the pressure at the rim."""

    def tails(self, offset: float) -> tuple[float, float, float]:
        """Return the parts of shear, pressure flow and moment."""

    def at_radius(self, radius: float) -> OutsideFilm:
        """Return the film outside another radius."""

    def at_rim(self, angles: Array, modes: int) -> tuple[Array, Array]:
        """Return pressure, its radial derivative and lost radial flux at angles of the rim, and their offset derivatives."""


class PlaneFilm(Protocol):
    """A film between surfaces that move along x, in the plane."""

    def outside_film(self, speed: float, rim: float) -> OutsideFilm | None:
        """Return the film outside a rim less a film of constant viscosity; None where it is that film."""

    def fluxes(self, mesh: PolarMesh, speed: float, gap: Array, pressure: Array) -> Fluxes:
        """Return the fluxes."""

    def slopes(self, mesh: PolarMesh, speed: float, gap: Array, pressure: Array) -> FluxSlopes:
        """Return the derivatives of the fluxes."""

    def shear(self, mesh: PolarMesh, speed: float, gap: Array, pressure: Array) -> Array:
        """Return the drag of sliding over that of a fluid of the viscosity at ambient pressure and low rates, at the nodes."""

    def sheared(self, speed: float, gap: Array) -> Array:
        """Return the drag of sliding, over a Newtonian fluid's, where the walls alone shear the film at ambient pressure."""

    def carried(self, gap: Array, pressure: Array) -> Array:
        """Return C, the volume that the walls carry."""

    def filled(self, gap: Array) -> Array:
        """Return the volume that the walls carry where the gap is full of liquid, over the gap: 1 + s S/h."""


def weights_of(mesh: PolarMesh) -> tuple[Array, Array]:
    """Return the weights of ``r dr dtheta`` panel by panel and of ``dr dtheta`` on rings, for half a turn."""
    part = np.pi / mesh.modes
    return part * mesh.local_weights * mesh.local_radii, part * mesh.ring_weights


class LinearPlane:
    """A film whose flow is linear in the pressure gradient."""

    def outside_film(self, speed: float, rim: float) -> None:
        """Return nothing: the film is that at ambient pressure."""

    def flow(self, gap: Array, pressure: Array) -> Flow:
        """Return the flow at nodes."""
        raise NotImplementedError

    def carried(self, gap: Array, pressure: Array) -> Array:
        """Return C, the volume that the walls carry."""
        return self.flow(gap, pressure).carried

    def filled(self, gap: Array) -> Array:
        """Return one."""
        return np.ones_like(gap)

    def viscosity(self, gap: Array, pressure: Array) -> Array:
        """Return the viscosity over that at ambient pressure."""
        return np.ones_like(gap)

    def shear(self, mesh: PolarMesh, speed: float, gap: Array, pressure: Array) -> Array:
        """Return the viscosity over that at ambient pressure."""
        return self.viscosity(gap, pressure)

    def sheared(self, speed: float, gap: Array) -> Array:
        """Return one."""
        return np.ones_like(gap)

    def fluxes(self, mesh: PolarMesh, speed: float, gap: Array, pressure: Array) -> Fluxes:
        """Return the fluxes."""
        cos, sin = np.cos(mesh.angles)[:, None], np.sin(mesh.angles)[:, None]
        wide, carried = self.flow(gap, pressure)[:2]
        weight, angle = weights_of(mesh)
        gradient = mesh.radial_derivative(pressure)
        radial = weight * (mesh.scattered(wide) * gradient - speed * cos[..., None] * mesh.scattered(carried))
        angular = (angle / mesh.radii) * wide * (mesh.angular_derivative @ pressure) + speed * angle * sin * carried
        return Fluxes(radial, angular, (wide[:, -1], carried[:, -1]))

    def slopes(self, mesh: PolarMesh, speed: float, gap: Array, pressure: Array) -> FluxSlopes:
        """Return its derivatives."""
        cos, sin = np.cos(mesh.angles)[:, None], np.sin(mesh.angles)[:, None]
        weight, angle = weights_of(mesh)
        flow = self.flow(gap, pressure)
        in_radius, in_angle = mesh.radial_derivative(pressure), (mesh.angular_derivative @ pressure) / mesh.radii

        def moves(mobility: Array, carried: Array) -> tuple[Array, Array]:
            """Return the changes of the flow along and across the radius by those of mobility and carried amount."""
            along = mesh.scattered(mobility) * in_radius - speed * cos[..., None] * mesh.scattered(carried)
            return weight * along, angle * (mobility * in_angle + speed * sin * carried)

        of_value = None
        if flow.mobility_by_pressure is not None and flow.carried_by_pressure is not None:
            of_value = moves(flow.mobility_by_pressure, flow.carried_by_pressure)
        return FluxSlopes(
            weight * mesh.scattered(flow.mobility),
            (angle / mesh.radii) * flow.mobility,
            *moves(flow.mobility_by_gap, flow.carried_by_gap),
            of_value,
            None,
            (flow.mobility[:, -1], flow.mobility_by_gap[:, -1], flow.carried_by_gap[:, -1]),
        )


@dataclass(frozen=True)
class PlainPlane(LinearPlane):
    """A Newtonian fluid of constant viscosity between smooth walls."""

    def flow(self, gap: Array, pressure: Array) -> Flow:
        """Return the flow at nodes."""
        return Flow(gap**3, gap, 3 * gap**2, np.ones_like(gap))


@dataclass(frozen=True)
class NewtonianPlane(LinearPlane):
    """A Newtonian fluid with laws of viscosity, density and rough flow."""

    film: Newtonian  # That of the line

    def flow(self, gap: Array, pressure: Array) -> Flow:
        """Return the flow at nodes."""
        film, s = self.film, self.film.slide
        phi, phi_slope = film.flow.pressure(gap)
        extra, extra_slope = (np.broadcast_to(each, gap.shape) for each in film.flow.shear(gap))  # a law may give one number
        width, wide = gap + s * extra, phi * gap**3
        wider = phi_slope * gap**3 + 3 * phi * gap**2
        if not film.uses_pressure:
            return Flow(wide, width, wider, 1 + s * extra_slope)
        log, log_slope = film.viscosity.log(pressure)
        rho, rho_slope = film.density.ratio(pressure)
        fluidity = rho * np.exp(-log)
        return Flow(
            fluidity * wide,
            rho * width,
            fluidity * wider,
            rho * (1 + s * extra_slope),
            fluidity * wide * (rho_slope / rho - log_slope),
            rho_slope * width,
        )

    def filled(self, gap: Array) -> Array:
        """Return the volume that the walls carry where the gap is full of liquid, over the gap."""
        return np.asarray(1 + self.film.slide * self.film.flow.shear(gap)[0] / gap)

    def viscosity(self, gap: Array, pressure: Array) -> Array:
        """Return the viscosity over that at ambient pressure."""
        if not self.film.uses_pressure:
            return np.ones_like(gap)
        return np.exp(self.film.viscosity.log(pressure)[0])


def is_isotropic(factors: FlowFactors) -> bool:
    """Return whether flow factors are the same in all directions, and leave the drag as it is."""
    return getattr(factors, "gamma", 1.0) == 1.0 and not getattr(factors, "friction_factors", False)


ISOVISCOUS_PLANE = PlainPlane()  # The fluid of the article
