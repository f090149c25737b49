r"""Flow through the gap of Gaussian surfaces by Bruggeman's effective medium, with its percolation threshold.

The local conductance is :math:`u^3` with the width :math:`u = \max(d + z, 0)`, z the height.  That of the medium,
:math:`e^3`, is that for which inclusions of the others do nothing on average:

.. math:: \left\langle \frac{u^3 - e^3}{u^3 + e^3} \right\rangle = 0, \qquad \phi_x = \frac{e^3}{\langle u \rangle^3}

It is zero where half of the surfaces touch, at the mean gap :math:`\sigma/\sqrt{2\pi}`, and :math:`1 - 1.5/H^2` for wide gaps.

Source: [Kirkpatrick 1973] for the medium, [Tripp 1983] for the limit of wide gaps.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, ClassVar

import numpy as np
import scipy
from numpy.polynomial import chebyshev, legendre

from stribeck._types import Array
from stribeck.fluids.flow_factors import MIN_FLOW_FACTOR, OfGaussianSurfaces, add_floor, nominal_separation
from stribeck.numerics.cells import Cells

__all__ = ["PERCOLATION", "EffectiveMedium"]

# Mean gap over the roughness at which half of the surfaces touch and the last path of the fluid closes.
PERCOLATION = 1 / math.sqrt(2 * math.pi)

# Separations over the roughness between which the width of the medium is tabulated.
TABLE_EDGES = (0.0, 0.05, 0.15, 0.4, 1.0, 2.0, 3.5, 6.0)

TABLE_COEFFICIENTS = 16  # Chebyshev coefficients of the width between two edges.

MAX_HEIGHT = 9.0  # Height over the roughness above which a Gaussian surface has nothing in double precision.

MIN_GAP_ABOVE_PERCOLATION = 1e-5  # Least tabulated gap above the threshold over the roughness; the flow is at its floor there.
MAX_GAP_ABOVE_PERCOLATION = 1e9  # Largest tabulated gap above the threshold over the roughness; the walls are smooth there.

FACTOR_CELLS = 8192  # Cells of the table of the flow factor in the logarithm of the gap; the table errs by 4e-12.
FACTOR_TERMS = 4  # Coefficients of the polynomial on each cell of that table.


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
    """Return the width e of the medium at the separation d of the mean planes, both over the roughness."""
    inner, outer = _tables()
    found = np.zeros_like(d)
    for left, right, coefficients in zip(TABLE_EDGES[:-1], TABLE_EDGES[1:], inner, strict=True):
        here = (d > left) & (d <= right)
        found[here] = chebyshev.chebval((2 * d[here] - left - right) / (right - left), coefficients)
    far = d > TABLE_EDGES[-1]
    found[far] = d[far] * chebyshev.chebval(2 * (TABLE_EDGES[-1] / d[far]) ** 2 - 1, outer)
    return found


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


@lru_cache(maxsize=1)
def _tables() -> tuple[list[Array], Array]:
    """Chebyshev coefficients of e between :data:`TABLE_EDGES`, and of e/d in 1/d**2 beyond."""
    points = chebyshev.chebpts1(TABLE_COEFFICIENTS)[::-1]
    inner = [
        _fitted(points, _widths(0.5 * (left + right) + 0.5 * (right - left) * points))
        for left, right in zip(TABLE_EDGES[:-1], TABLE_EDGES[1:], strict=True)
    ]
    far = TABLE_EDGES[-1] * (0.5 * (1 + points)) ** -0.5
    return inner, _fitted(points, _widths(far) / far)


def _fitted(points: Array, values: Array) -> Array:
    """Return the Chebyshev coefficients of a polynomial through values."""
    return np.asarray(chebyshev.chebfit(points, values, TABLE_COEFFICIENTS - 1), dtype=np.float64)


def _widths(separations: Array) -> Array:
    """Return the widths of the medium at falling or rising separations, each found from the last."""
    found, start = [], 1.0
    for d in separations.tolist():
        start = _width(d, start * d)
        found.append(start)
        start /= d
    return np.array(found)


def _width(d: float, start: float) -> float:
    """Return the width of the medium at one separation > 0, by Newton's method in its logarithm."""
    nodes, weights = legendre.leggauss(20)
    log_e = math.log(start)
    for _ in range(100):
        e = math.exp(log_e)
        low, high = max(d - MAX_HEIGHT, 0.0), d + MAX_HEIGHT
        edges = np.unique(np.clip(np.append(e * 2.0 ** np.arange(-6, 7), [low, high, d, d - 3, d + 3]), low, high))
        half = 0.5 * np.diff(edges)
        u = (0.5 * (edges[1:] + edges[:-1]))[:, None] + half[:, None] * nodes
        mass = half[:, None] * weights * np.exp(-0.5 * (u - d) ** 2) / math.sqrt(2 * math.pi)
        part = e**3 / (u**3 + e**3)
        # Widths of zero have the part one.
        excess = 1 - 2 * (float(scipy.special.ndtr(-d)) + float((mass * part).sum()))
        slope = -2 * float((mass * 3 * part * (1 - part)).sum())
        step = max(-1.0, min(1.0, -excess / slope))
        log_e += step
        if abs(step) < 1e-14:
            break
    return math.exp(log_e)
