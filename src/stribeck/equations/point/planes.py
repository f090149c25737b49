r"""The flow in the plane of each kind of film, among them one that thins.

With :math:`\mathbf Q = 6 h t \nabla p_f`, :math:`\mathbf r_0 = -\lambda t \eta s \mathbf e_x/h`, the relaxation time t and
:math:`\mathbf r_1, \mathbf T` by :mod:`stribeck.equations.point.column`, the flux is

.. math:: \mathbf F = \rho \left[\frac{2 h^2}{\eta t} \mathbf r_1 - \lambda h \, \mathbf e_x\right],

:math:`\rho [h^3 \nabla p_f/\eta - \lambda h \mathbf e_x]` for a Newtonian fluid.  The walls feel the stresses
:math:`-(\mathbf T \mp \mathbf Q/2)/6t`, whose difference is the pull of the pressure gradient, whatever the fluid:
thinning changes the drag through T alone.  The pressure divides the rate at a given stress by :math:`\eta(p)`, as on the line.

At the rim and beyond it thins to first order (:mod:`stribeck.equations.point.thinning_far_field`).
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from stribeck._types import Array
from stribeck.equations.point.column import Column, column, mean_wall_stress, times
from stribeck.equations.point.films import BlendedPlane, Fluxes, FluxSlopes, NewtonianPlane, PlaneFilm, weights_of
from stribeck.equations.point.thinning_far_field import FarThinned
from stribeck.fluids.fluid import Film
from stribeck.fluids.newtonian import Blend, Newtonian
from stribeck.fluids.shear_thinning import ShearThinning
from stribeck.numerics.dual import with_slope
from stribeck.numerics.fourier_panels import PolarMesh
from stribeck.numerics.settings import HALF_DIGITS


class _Local(NamedTuple):
    """The flow across the film at the nodes of each panel, and the film that it is of; vectors along and across the radius."""

    key: tuple[Array, Array]
    gap: Array
    along: Array
    """The direction of the motion."""
    slope: Array
    slip: Array
    flow: Column
    eta: Array
    eta_slope: Array
    rho: Array
    rho_slope: Array


@dataclass(frozen=True)
class ThinningPlane(PlaneFilm):
    """A shear-thinning fluid between smooth walls."""

    film: ShearThinning  # That of the line, at a speed
    _last: list[_Local] = field(init=False, repr=False, compare=False, default_factory=list)

    def outside_film(self, speed: float, mesh: PolarMesh) -> Any:
        """Return the film outside the rim less one of constant viscosity; None where the fluid is Newtonian there."""
        found = FarThinned(self.film.law, self.film.slide, speed, mesh.rim, mesh.modes)
        return found if found.lost > HALF_DIGITS else None

    def fluxes(self, mesh: PolarMesh, speed: float, gap: Array, pressure: Array) -> Fluxes:
        """Return the fluxes."""
        at = self._local(mesh, speed, gap, pressure)
        radial, angular = _local_weights(mesh)
        flux = self._flux(at, speed)
        shape = radial.shape
        return Fluxes(
            radial * flux[0].reshape(-1, *shape),
            mesh.gathered(angular * flux[1].reshape(-1, *shape)),
            (gap[:, -1] ** 3, gap[:, -1]),
        )

    def slopes(self, mesh: PolarMesh, speed: float, gap: Array, pressure: Array) -> FluxSlopes:
        """Return its derivatives."""
        at = self._local(mesh, speed, gap, pressure)
        radial, angular = _local_weights(mesh)
        shape = radial.shape
        h, flow = at.gap, at.flow
        unit = self._unit(at)

        def local(values: Array) -> Array:
            return values.reshape(-1, *shape)

        def both(values: Array) -> tuple[Array, Array]:
            return radial * local(values[0]), mesh.gathered(angular * local(values[1]))

        # A change of the gap by its relative part: r_0 falls with it and Q grows with it.
        by_gap = unit / h * (2 * flow.carried - _by(flow.by_slip, at.slip) + times(flow.by_slope, at.slope))
        by_gap -= at.rho * speed * at.along
        of_value = None
        if self.film.uses_pressure:
            by_viscosity = unit * at.eta_slope * (_by(flow.by_slip, at.slip) - flow.carried)
            of_value = both(by_viscosity + at.rho_slope / at.rho * self._flux(at, speed))
        rr, rt, tt = 6 * self.film.law.time * h * unit * flow.by_slope
        rim = gap[:, -1]
        return FluxSlopes(
            radial * local(rr),
            mesh.gathered(angular / mesh.local_radii * local(tt)),
            *both(by_gap),
            of_value,
            angular * local(rt),
            (rim**3, 3 * rim**2, np.ones_like(rim)),
        )

    def shear(self, mesh: PolarMesh, speed: float, gap: Array, pressure: Array) -> Array:
        """Return the mean of the stresses at both walls over that of a fluid that does not thin."""
        at = self._local(mesh, speed, gap, pressure)
        unit = at.gap / (self.film.law.time * speed) if self.film.slide else at.eta
        found = unit * mean_wall_stress(at.flow, at.along, self.film.slide)
        weights = mesh.local_weights
        return mesh.gathered(weights * found.reshape(-1, *weights.shape)) / mesh.ring_weights

    def sheared(self, speed: float, gap: Array) -> Array:
        """Return the stress over that of a fluid that does not thin, where the walls alone shear the film."""
        rate = speed * self.film.law.time * abs(self.film.slide) / gap
        return self.film.law.stress(rate) / rate if self.film.slide else np.ones_like(gap)

    def carried(self, gap: Array, pressure: Array) -> Array:
        """Return the amount that the walls carry, which is the same for all laws."""
        return np.asarray(_laws_of_pressure(self.film, pressure)[2] * gap)

    def _unit(self, at: _Local) -> Array:
        return at.rho * 2 * at.gap**2 / (at.eta * self.film.law.time)

    def _flux(self, at: _Local, speed: float) -> Array:
        return np.asarray(self._unit(at) * at.flow.carried - at.rho * speed * at.gap * at.along)

    def _local(self, mesh: PolarMesh, speed: float, gap: Array, pressure: Array) -> _Local:
        """Return the local solutions, kept from the last call if it was for the same film."""
        last = self._last[0] if self._last else None
        if last is not None and np.array_equal(last.key[0], gap) and np.array_equal(last.key[1], pressure):
            return last
        h, ones = mesh.scattered(gap).ravel(), np.ones((1, *mesh.local_radii.shape))
        cos, sin = (each[:, None, None] * ones for each in (np.cos(mesh.angles), np.sin(mesh.angles)))
        along = np.stack([cos.ravel(), -sin.ravel()])
        in_angle = mesh.scattered((mesh.angular_derivative @ pressure) / mesh.radii)
        gradient = np.stack([mesh.radial_derivative(pressure).ravel(), in_angle.ravel()])
        of_pressure = _laws_of_pressure(self.film, mesh.scattered(pressure).ravel())
        time = self.film.law.time
        slope = 6 * time * h * gradient
        slip = -(speed * time * self.film.slide) * of_pressure[0] / h * along
        start = None
        if last is not None and last.slope.shape == slope.shape:
            start = _moved(last, slope, slip)
        flow = column(self.film.law, slope, slip, start)
        found = _Local((gap.copy(), pressure.copy()), h, along, slope, slip, flow, *of_pressure)
        self._last[:] = [found]
        return found


def _local_weights(mesh: PolarMesh) -> tuple[Array, Array]:
    """Return the weights of ``r dr dtheta`` and of ``dr dtheta`` panel by panel, for half a turn."""
    radial = weights_of(mesh)[0]
    return radial, radial / mesh.local_radii


def _laws_of_pressure(film: ShearThinning, pressure: Array) -> tuple[Array, Array, Array, Array]:
    """Return viscosity, slope of its logarithm, density and its slope."""
    if not film.uses_pressure:
        one, zero = np.ones_like(pressure), np.zeros_like(pressure)
        return one, zero, one, zero
    log, log_slope = with_slope(film.viscosity.log, pressure)
    return np.exp(log), log_slope, *with_slope(film.density.ratio, pressure)


def _by(matrix: Array, vector: Array) -> Array:
    """Return the products of matrices with vectors."""
    return np.stack([(row * vector).sum(axis=0) for row in matrix])


def _moved(last: _Local, slope: Array, slip: Array) -> Array | None:
    """Return mean stresses to start from: those of the last film, to first order; None if one is far from it."""
    change = slope - last.slope
    step = times(last.flow.compliance, slip - last.slip) - _by(last.flow.by_slip.swapaxes(0, 1), change)
    largest = np.maximum(*(np.hypot(*(last.flow.mean + side * last.slope)) for side in (-0.5, 0.5)))
    far = ~(np.hypot(*step) + np.hypot(*change) < largest)
    return None if far.any() else last.flow.mean + step


# The flow in the plane, by the kind of film.
PLANES: dict[type, Callable[[Any], PlaneFilm]] = {
    Newtonian: NewtonianPlane,
    ShearThinning: ThinningPlane,
    Blend: lambda film: BlendedPlane(plane_of(film.film), film.newtonian),
}


def plane_of(film: Film) -> PlaneFilm:
    """Return the flow in the plane of a film; a KeyError for one that has none."""
    return PLANES[type(film)](film)
