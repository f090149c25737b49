r"""The film of a ball that ends at ambient pressure.

The film ruptures along one line and does not re-form, so that :math:`\min(p_f, R/d) = 0` conserves mass.

Far from the contact the pressure is :math:`g(\theta) \, r/h^2` and ruptures along :math:`x = |y|/3`; load and deflection by
the pressure beyond the rim follow from it.
"""

import math
from dataclasses import dataclass
from functools import partial
from typing import Any, ClassVar

import numpy as np

from stribeck._types import Array
from stribeck.contacts.cut_off import CAVITATED_FAR_FILM, FarFilm
from stribeck.equations.cavities.system import CavitatedSystem
from stribeck.equations.cavities.wake import shear_missing
from stribeck.equations.point.far_field import particular
from stribeck.equations.point.system import Unknowns
from stribeck.numerics.settings import NEGLIGIBLE, SAFETY
from stribeck.numerics.trace import Value
from stribeck.quantities.lazy import cached_property


@dataclass(frozen=True, eq=False)
class CavitatedEquations(CavitatedSystem):
    """The discretised problem of a film that ends at ambient pressure."""

    far: ClassVar[FarFilm] = CAVITATED_FAR_FILM
    finest: ClassVar[float] = 1e-4

    @cached_property
    def outside_film(self) -> None:
        """Nothing: a film that is cavitated and thins beyond the rim is taken for one that does not thin."""
        return

    def friction_error_outside(self, y: Unknowns) -> float:
        """Return an estimate of the friction that is lost there."""
        del y
        lost = self.film.outside_film(self.speed, self.operators.mesh)
        return 0.0 if lost is None else lost.drag

    @property
    def load_row(self) -> Array:
        """Weights of the load on the axisymmetric mode, with the load beyond the rim, shape (rings,)."""
        row = self.operators.load_row.copy()
        row[-1] += 2.0 * math.pi * self.operators.mesh.rim**2
        return row

    def deflect(self, by_mode: Array) -> Array:
        """Return the deflection by mode; beyond the rim all modes fall as r**-3."""
        found = self.operators.deflect(by_mode)
        beyond = self.operators.deflection_from_beyond * by_mode[:, -1:]
        beyond[1] = 0.0  # the operator holds that of mode one
        return np.asarray(found + beyond)

    def rim_slope(self, p: Array, offset: Value) -> Any:
        """Return the radial derivative of the film pressure at the rim: it falls as that of the full film."""
        first, slope = particular(np.array([self.operators.mesh.rim]), offset, 1.0, bulge=self.operators.bulge)
        return p * (slope / first)

    def rim_rates(self, offset: float) -> Array:
        """Return the derivative of :meth:`rim_slope` by the pressure, shape (angles, angles)."""
        return np.diag(self.rim_slope(np.ones(self.operators.mesh.modes), offset))

    def shear_missing(self, y: Unknowns) -> Array:
        """Return the shear over h that is missing on each ring in the dry streaks of the wake, shape (rings,)."""
        film = self.film
        return shear_missing(self.operators.mesh, y.gap, y.fluid, film.filled, partial(film.sheared, self.speed))

    def shear_error(self, y: Unknowns) -> float:
        """Return an estimate of the error of the total shear over h: streaks begin at a line known to a part of a spacing."""
        mesh = self.operators.mesh
        return SAFETY * NEGLIGIBLE / mesh.modes * abs(float(mesh.ring_weights @ self.shear_missing(y)))
