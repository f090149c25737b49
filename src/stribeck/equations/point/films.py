r"""The film of a ball: its flow in the plane under a pressure gradient and the motion of the walls.

.. math:: \nabla \cdot \big[ M \, \nabla p_f - \lambda \, C \, \mathbf e_x \big] = 0, \qquad
    M = \frac{\rho \, \phi \, h^3}{\eta}, \quad C = \rho \, (h + s S)

in Hertz units, with viscosity, density and flow factors as functions of pressure and gap; M is the same in all directions.
A fluid that thins has an M that depends on the gradient too (:mod:`stribeck.equations.point.planes`): equations use
the fluxes and their derivatives only, whatever the law.
"""

from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol

import numpy as np

from stribeck._types import Array
from stribeck.fluids.laws import FlowFactors
from stribeck.fluids.newtonian import Newtonian, of_pressure
from stribeck.numerics.fourier_panels import PolarMesh
from stribeck.numerics.trace import Trace


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


class PlaneFilm(Protocol):
    """A film between surfaces that move along x, in the plane."""

    def outside_film(self, speed: float, mesh: PolarMesh) -> Any:
        """Return the film outside the rim of a mesh less one of constant viscosity, a `FarThinned`; None where it is that."""
        return None

    def fluxes(self, mesh: PolarMesh, speed: float, gap: Array, pressure: Array) -> Fluxes:
        """Return the fluxes."""

    def slopes(self, mesh: PolarMesh, speed: float, gap: Array, pressure: Array) -> FluxSlopes:
        """Return the derivatives of the fluxes."""

    def shear(self, mesh: PolarMesh, speed: float, gap: Array, pressure: Array) -> Array:
        """Return the drag of sliding over that of a fluid of the viscosity at ambient pressure and low rates, at the nodes."""

    def sheared(self, speed: float, gap: Array) -> Array:
        """Return the drag of sliding, over a Newtonian fluid's, where the walls alone shear the film at ambient pressure."""
        return np.ones_like(gap)

    def carried(self, gap: Array, pressure: Array) -> Array:
        """Return C, the volume that the walls carry."""

    def filled(self, gap: Array) -> Array:
        """Return the volume that the walls carry where the gap is full of liquid, over the gap: 1 + s S/h."""
        return np.ones_like(gap)


def weights_of(mesh: PolarMesh) -> tuple[Array, Array]:
    """Return the weights of ``r dr dtheta`` panel by panel and of ``dr dtheta`` on rings, for half a turn."""
    part = np.pi / mesh.modes
    return part * mesh.local_weights * mesh.local_radii, part * mesh.ring_weights


@dataclass(frozen=True)
class NewtonianPlane(PlaneFilm):
    """A fluid whose flow is linear in the pressure gradient, with laws of viscosity, density and rough flow."""

    film: Newtonian = Newtonian()  # That of the line

    def flow(self, gap: Any, pressure: Any) -> tuple[Any, Any]:
        """Return mobility and carried amount at nodes, of values or of traces."""
        film, wide, width = self.film, gap * gap * gap, gap
        if not film.is_smooth:
            phi, extra = film.roughness(gap)
            wide, width = phi * wide, width + film.slide * extra
        if not film.uses_pressure:
            return wide, width
        eta, rho = of_pressure(film.viscosity, film.density, pressure)
        return rho / eta * wide, rho * width

    def carried(self, gap: Array, pressure: Array) -> Array:
        """Return C, the volume that the walls carry."""
        return np.asarray(self.flow(gap, pressure)[1])

    def filled(self, gap: Array) -> Array:
        """Return the volume that the walls carry where the gap is full of liquid, over the gap."""
        return np.asarray(1 + self.film.slide * self.film.flow.shear(gap) / gap)

    def shear(self, mesh: PolarMesh, speed: float, gap: Array, pressure: Array) -> Array:
        """Return the viscosity over that at ambient pressure."""
        return np.exp(self.film.viscosity.log(pressure)) if self.film.uses_pressure else np.ones_like(gap)

    def fluxes(self, mesh: PolarMesh, speed: float, gap: Array, pressure: Array) -> Fluxes:
        """Return the fluxes."""
        wide, carried = self.flow(gap, pressure)
        radial, angular = _moved(mesh, speed, pressure, wide, carried)
        return Fluxes(radial, angular, (wide[:, -1], carried[:, -1]))

    def slopes(self, mesh: PolarMesh, speed: float, gap: Array, pressure: Array) -> FluxSlopes:
        """Return its derivatives."""
        weight, angle = weights_of(mesh)
        mobility, carried = self.flow(Trace.number("gap", gap), Trace.number("pressure", pressure))
        by_gap, by_pressure = (
            [np.broadcast_to(each.columns.get(name, 0.0), gap.shape) for each in (mobility, carried)]
            for name in ("gap", "pressure")
        )
        return FluxSlopes(
            weight * mesh.scattered(mobility.value),
            (angle / mesh.radii) * mobility.value,
            *_moved(mesh, speed, pressure, *by_gap),
            _moved(mesh, speed, pressure, *by_pressure) if self.film.uses_pressure else None,
            None,
            (mobility.value[:, -1], *(each[:, -1] for each in by_gap)),
        )


def _moved(mesh: PolarMesh, speed: float, pressure: Array, mobility: Array, carried: Array) -> tuple[Array, Array]:
    """Return the weighted flow along and across the radius by a mobility and what the walls carry."""
    weight, angle = weights_of(mesh)
    cos, sin = np.cos(mesh.angles)[:, None], np.sin(mesh.angles)[:, None]
    along = mesh.scattered(mobility) * mesh.radial_derivative(pressure) - speed * cos[..., None] * mesh.scattered(carried)
    across = mobility * ((mesh.angular_derivative @ pressure) / mesh.radii) + speed * sin * carried
    return weight * along, angle * across


@dataclass(frozen=True)
class BlendedPlane:
    """A film whose flow lies between that of a Newtonian fluid and its own; in all else it is its own."""

    film: PlaneFilm
    newtonian: float  # Part of the Newtonian fluid

    def outside_film(self, speed: float, mesh: PolarMesh) -> None:
        """Return nothing: states on the way to a film are coarse."""

    def fluxes(self, mesh: PolarMesh, speed: float, gap: Array, pressure: Array) -> Fluxes:
        """Return the weighted mean of both fluxes."""
        both = (film.fluxes(mesh, speed, gap, pressure) for film in (ISOVISCOUS_PLANE, self.film))
        return Fluxes(*(self._mean(*each) for each in zip(*both, strict=True)))

    def slopes(self, mesh: PolarMesh, speed: float, gap: Array, pressure: Array) -> FluxSlopes:
        """Return the weighted mean of both derivatives."""
        both = (film.slopes(mesh, speed, gap, pressure) for film in (ISOVISCOUS_PLANE, self.film))
        return FluxSlopes(*(self._mean(*each) for each in zip(*both, strict=True)))

    def _mean(self, plain: Any, own: Any) -> Any:
        if isinstance(own, tuple):
            return tuple(self._mean(None if plain is None else plain[k], each) for k, each in enumerate(own))
        return own if own is None else (1 - self.newtonian) * own + (0.0 if plain is None else self.newtonian * plain)

    def __getattr__(self, name: str) -> Any:
        """Return any other attribute of the film."""
        return getattr(self.film, name)


def is_isotropic(factors: FlowFactors) -> bool:
    """Return whether flow factors are the same in all directions, and leave the drag as it is."""
    return getattr(factors, "gamma", 1.0) == 1.0 and not getattr(factors, "friction_factors", False)


ISOVISCOUS_PLANE = NewtonianPlane()  # The fluid of the article
