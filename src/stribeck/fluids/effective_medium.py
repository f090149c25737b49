r"""Flow through the gap of Gaussian surfaces by Bruggeman's effective medium, with its percolation threshold.

The local conductance is :math:`u^3` with the width :math:`u = \max(d + z, 0)`, z the height.  That of the medium,
:math:`e^3`, is that for which inclusions of the others do nothing on average:

.. math:: \left\langle \frac{u^3 - e^3}{u^3 + e^3} \right\rangle = 0, \qquad \phi_x = \frac{e^3}{\langle u \rangle^3}

It is zero where half of the surfaces touch, at the mean gap :math:`\sigma/\sqrt{2\pi}`, and :math:`1 - 1.5/H^2` for wide gaps.

Source: [Kirkpatrick 1973] for the medium, [Tripp 1983] for the limit of wide gaps.
"""

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, ClassVar

import numpy as np
import scipy
from numpy.polynomial import legendre

from stribeck._types import Array
from stribeck.fluids.flow_factors import MIN_FLOW_FACTOR, OfGaussianSurfaces, add_floor, nominal_separation
from stribeck.numerics.cells import Cells

# Mean gap over the roughness at which half of the surfaces touch and the last path of the fluid closes.
PERCOLATION = 1 / math.sqrt(2 * math.pi)

MAX_HEIGHT = 9.0  # Height over the roughness above which a Gaussian surface has nothing in double precision.

MIN_GAP_ABOVE_PERCOLATION = 1e-5  # Least tabulated gap above the threshold over the roughness; the flow is at its floor there.
MAX_GAP_ABOVE_PERCOLATION = 1e9  # Largest tabulated gap above the threshold over the roughness; the walls are smooth there.

NODES_PER_PANEL = 12  # Gauss points of a panel of the widths.
MAX_STEPS, STEP_TOLERANCE = 60, 1e-12  # Steps of the width of the medium, and the last one in its logarithm.

FACTOR_CELLS, FACTOR_TERMS = 256, 9  # Cells of the flow factor in the logarithm of the gap, and coefficients on each.


@dataclass(frozen=True)
class EffectiveMedium(OfGaussianSurfaces):
    r"""Flow factor of isotropic Gaussian surfaces by the theory of an effective medium.

    Parameters
    ----------
    alpha : float, optional
        :math:`\alpha` of the contact law, so that :math:`\sigma = \alpha` times the decay length of the contact pressure
        [-]; left out, that of the contact.  Groups, which do not hold it, need it.

    Raises
    ------
    InputError
        Where the value is impossible.

    Notes
    -----
    Asperities are cut off where they overlap, not displaced, and the heights are Gaussian: of a spectrum only the roughness
    enters.  Near the threshold a real surface conducts by few channels, and the theory is coarse; below it the flow is 1e-4 of
    that between smooth surfaces.  Sliding carries nothing, and the drag has no factors.
    """

    name: ClassVar[str] = "effective-medium"
    label: ClassVar[str] = "effective medium"

    @property
    def parameters(self) -> dict[str, float | str]:
        """The roughness in Hertz units."""
        return {} if self.sigma is None else {"sigma": self.sigma}

    @property
    def closed_at(self) -> float | None:
        """The threshold."""
        return None if self.sigma is None else PERCOLATION * self.sigma

    def pressure(self, gap: Any) -> Any:
        """Return phi_x."""
        beyond = np.clip(gap / self.roughness - PERCOLATION, MIN_GAP_ABOVE_PERCOLATION, MAX_GAP_ABOVE_PERCOLATION)
        return _factor_table()(np.log(beyond))

    def shear(self, gap: Any) -> Any:
        """Return zero."""
        return np.zeros_like(gap)

    def notes(self, gap: Array, pressure: Array | None) -> tuple[str, ...]:
        """Return whether the film falls below the threshold."""
        if self.sigma is None or float(gap.min()) > PERCOLATION * self.sigma:
            return ()
        return (
            f"the mean gap falls below {PERCOLATION:.3f} of the roughness, where no path for the fluid is left: "
            f"{MIN_FLOW_FACTOR:g} of the flow is kept there",
        )


def medium_width(d: Array) -> Array:
    """Return the width e of the medium at separations d > 0 of the mean planes, both over the roughness."""
    # By Newton's method in the logarithm of e, which is near d, on panels of the heights that are densest where widths are e.
    nodes, weights = legendre.leggauss(NODES_PER_PANEL)
    log_e, lowest = np.log(d), np.maximum(-d, -MAX_HEIGHT)[:, None]
    for _ in range(MAX_STEPS):
        e = np.exp(log_e)[:, None]
        near = e * 2.0 ** np.arange(-6, 10) - d[:, None]
        edges = np.hstack([near, np.tile((-MAX_HEIGHT, -3.0, 0.0, 3.0, MAX_HEIGHT), (d.size, 1))])
        edges = np.sort(np.clip(edges, lowest, MAX_HEIGHT), axis=1)
        half, middle = 0.5 * np.diff(edges)[..., None], 0.5 * (edges[:, 1:] + edges[:, :-1])[..., None]
        z = middle + half * nodes
        mass = half * weights * np.exp(-0.5 * z**2) / math.sqrt(2 * math.pi)
        part = 1 / (1 + ((d[:, None, None] + z) / e[..., None]) ** 3)
        # Widths of zero have the part one.
        excess = 1 - 2 * (scipy.special.ndtr(-d) + (mass * part).sum(axis=(1, 2)))
        step = excess / (6 * (mass * part * (1 - part)).sum(axis=(1, 2)))
        log_e += np.clip(step, -1.0, 1.0)
        if np.abs(step).max() < STEP_TOLERANCE:
            break
    return np.asarray(np.exp(log_e))


@lru_cache(maxsize=1)
def _factor_table() -> Cells:
    """Return phi_x, kept above zero, a function of ln(mean gap over the roughness - threshold)."""

    def factor(logarithm: Array) -> Array:
        width = PERCOLATION + np.exp(logarithm)
        phi = (medium_width(nominal_separation(width)) / width) ** 3
        return np.asarray(add_floor(phi))

    return Cells.of(
        factor, math.log(MIN_GAP_ABOVE_PERCOLATION), math.log(MAX_GAP_ABOVE_PERCOLATION), FACTOR_CELLS, FACTOR_TERMS
    )
