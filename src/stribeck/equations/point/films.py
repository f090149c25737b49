r"""What the equations of a ball ask of a film: the flow in the plane under a pressure gradient and the motion of the walls.

.. math:: \nabla \cdot \big[ M \, \nabla p_f - \lambda \, C \, \mathbf e_x \big] = 0, \qquad
    M = \frac{\rho \, \phi \, h^3}{\eta}, \quad C = \rho \, (h + s S)

in Hertz units, with viscosity, density and flow factors as functions of pressure and gap; M is the same in all directions.
:data:`PLANES` holds the flow in the plane of each kind of film of the line.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol

import numpy as np

from stribeck._types import Array
from stribeck.fluids.fluid import Film
from stribeck.fluids.laws import FlowFactors
from stribeck.fluids.newtonian import Newtonian


class Flow(NamedTuple):
    """Mobility M and what is carried, C, with their derivatives; None by pressure stands for zero everywhere."""

    mobility: Array
    carried: Array
    mobility_by_gap: Array
    carried_by_gap: Array
    mobility_by_pressure: Array | None = None
    carried_by_pressure: Array | None = None


class PlaneFilm(Protocol):
    """A film between surfaces that move along x, in the plane."""

    def flow(self, gap: Array, pressure: Array) -> Flow:
        """Return the flow at nodes."""

    def shear(self, gap: Array, pressure: Array) -> Array:
        """Return the drag of sliding over that of a fluid of the viscosity at ambient pressure, times the gap."""


@dataclass(frozen=True)
class PlainPlane:
    """A Newtonian fluid of constant viscosity between smooth walls."""

    def flow(self, gap: Array, pressure: Array) -> Flow:
        """Return the flow at nodes."""
        return Flow(gap**3, gap, 3 * gap**2, np.ones_like(gap))

    def shear(self, gap: Array, pressure: Array) -> Array:
        """Return one."""
        return np.ones_like(gap)


@dataclass(frozen=True)
class NewtonianPlane:
    """A Newtonian fluid with laws of viscosity, density and rough flow.

    Parameters
    ----------
    film : Newtonian
        That of the line.
    """

    film: Newtonian

    def flow(self, gap: Array, pressure: Array) -> Flow:
        """Return the flow at nodes."""
        film, s = self.film, self.film.slide
        phi, phi_slope = film.flow.pressure(gap)
        extra, extra_slope = film.flow.shear(gap)
        width, wide = gap + s * extra, phi * gap**3
        wider = phi_slope * gap**3 + 3 * phi * gap**2
        if not film.uses_pressure:
            return Flow(wide, width, wider, 1 + s * extra_slope)
        log, log_slope = film.viscosity.log(pressure)
        rho, rho_slope = film.density.ratio(pressure)
        ease = rho * np.exp(-log)
        return Flow(
            ease * wide,
            rho * width,
            ease * wider,
            rho * (1 + s * extra_slope),
            ease * wide * (rho_slope / rho - log_slope),
            rho_slope * width,
        )

    def shear(self, gap: Array, pressure: Array) -> Array:
        """Return the viscosity over that at ambient pressure."""
        if not self.film.uses_pressure:
            return np.ones_like(gap)
        return np.exp(self.film.viscosity.log(pressure)[0])


def is_isotropic(factors: FlowFactors) -> bool:
    """Return whether flow factors are the same in all directions, and leave the drag as it is."""
    return getattr(factors, "gamma", 1.0) == 1.0 and not getattr(factors, "friction_factors", False)


PLAIN = PlainPlane()
"""The fluid of the article."""


def plane_of(film: Film) -> PlaneFilm:
    """Return the flow in the plane of a film; a KeyError for one that has none."""
    return PLAIN if isinstance(film, Newtonian) and film.is_plain else PLANES[type(film)](film)


PLANES: dict[type, Callable[[Any], PlaneFilm]] = {Newtonian: NewtonianPlane}
"""The flow in the plane, by the kind of film."""
