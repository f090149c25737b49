r"""Contact laws of independent asperities with Gaussian heights: Greenwood and Williamson, Greenwood and Tripp.

Both are moments of the Gaussian distribution over the asperities that reach the other surface,

.. math:: F_n(s) = \frac{1}{\sqrt{2\pi}} \int_s^\infty (z - s)^n e^{-z^2/2} dz ,

of order 3/2 where a rough surface meets a plane one and 5/2 where two rough surfaces meet.  With the groups of the package
:math:`\Phi = F_n`, :math:`\alpha = 1`, and h_rms is the standard deviation of the heights; the factor before the integral is
:math:`\beta`.

The moments are kept as a spline of order 7 through values of their integral, made on first use.

Source: [GW] Greenwood and Williamson, Proc. R. Soc. A 295 (1966) 300; [GT] Greenwood and Tripp, Proc. Inst. Mech. Eng. 185
(1970) 625; both derived again in docs/contact_laws.md.
"""

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, ClassVar

import numpy as np

from stribeck.contact_laws.law import AsperityLaw
from stribeck.numerics.trace import pointwise
from stribeck.quantities.schema import Input

MIN_KNOT = -12.0  # Separation below which a moment is continued by its tangent; the pressure there is above 40 beta E*.

MAX_KNOT = 1e4  # Separation above which the spline goes on straight in arsinh(s), as the moment does to 1e-7.

KNOT_STEP = 0.02  # Distance of the knots of the spline in arsinh(s); halved, no value changes by more than rounding.

QUADRATURE_STEP = 0.02  # Step of the trapezoidal rule in the logarithm of the height.
QUADRATURE_RANGE = 45.0  # Range of that rule below its middle, times the order of the moment plus one.


@lru_cache(maxsize=8)
def _spline(order: float) -> tuple[Any, Any]:
    """Return the spline of ``ln F_n + s**2/2`` over arsinh(s), and its derivative."""
    from scipy.interpolate import make_interp_spline  # slow to import, and most uses do not get here

    knots = np.arange(math.asinh(MIN_KNOT), math.asinh(MAX_KNOT) + KNOT_STEP, KNOT_STEP)
    s = np.sinh(knots)
    # The integrand in y = ln(z - s), shifted to where it is largest, falls at least exponentially on both sides.
    centre = np.log(np.where(s < 1, 0.5 * (np.sqrt(s * s + 4 * order + 4) - s), (order + 1) / np.maximum(s, 1)))
    y = centre[:, None] + np.arange(-QUADRATURE_RANGE / (order + 1), 5.0, QUADRATURE_STEP)
    w = np.exp(y)
    exponent = (order + 1) * y - s[:, None] * w - 0.5 * w * w
    largest = exponent.max(axis=1)
    logs = largest + np.log(QUADRATURE_STEP * np.exp(exponent - largest[:, None]).sum(axis=1)) - 0.5 * math.log(2 * math.pi)
    spline = make_interp_spline(knots, logs, k=7)
    return spline, spline.derivative()


def _ends() -> tuple[float, float]:
    return math.asinh(MIN_KNOT), math.asinh(MAX_KNOT)


def log_moment(order: float, separation: Any) -> Any:
    r"""Return :math:`\ln F_n(s)`."""
    spline, slope = _spline(order)
    inside = np.maximum(separation, MIN_KNOT)
    low, high = _ends()
    t = np.arcsinh(inside)
    known = np.minimum(t, high)
    found = pointwise(lambda t: (np.asarray(spline(t)), slope(t)), known)
    # Differences from what was cut off: at the ends themselves only one of both parts has a slope.
    found = found - 0.5 * inside * inside - (order + 1) * (t - known)
    tangent = float(slope(low)) / math.hypot(1.0, MIN_KNOT) - MIN_KNOT
    return found + tangent * (separation - inside)


@dataclass(frozen=True)
class _GaussianHeights(AsperityLaw):
    """What the two laws share."""

    order: ClassVar[float]
    name: ClassVar[str]
    fixed_alpha: ClassVar[float] = 1.0
    """The only alpha: separations are in standard deviations of the summit heights, which is the h_rms of the contact."""
    beta_formula: ClassVar[str]

    def log_pressure(self, separation: Any) -> Any:
        """Return ln(Phi) at the separation ``s = alpha h/h_rms``."""
        return log_moment(self.order, separation)

    @classmethod
    def coefficients(cls, *, density: str | float, radius: str | float, deviation: str | float) -> dict[str, float]:
        r"""Return :math:`\alpha = 1`, :math:`\beta` and :math:`h_\mathrm{rms} = \sigma`, which a line contact needs.

        Parameters
        ----------
        density : str or float
            Summits per area :math:`\eta_s > 0`, of two rough surfaces that of each [1/m**2].
        radius : str or float
            Radius of the summits :math:`R_s > 0` [m].
        deviation : str or float
            Standard deviation of their heights :math:`\sigma > 0`, of two rough surfaces the composite one [m].

        Returns
        -------
        dict of str to float
            ``alpha``, ``beta`` and ``roughness``, ready for :class:`stribeck.LineContact`.

        Raises
        ------
        InputError
            If a value is not positive or its unit is wrong.
        """
        eta, R, sigma = (row.checked(value) for row, value in zip(SUMMITS.values(), (density, radius, deviation), strict=True))
        return {"alpha": 1.0, "beta": cls._beta(eta, R, sigma), "roughness": sigma}

    @staticmethod
    def _beta(eta: float, R: float, sigma: float) -> float:
        raise NotImplementedError

    def notes(self, separation: float) -> tuple[str, ...]:
        """Return notes on a state with this minimum separation."""
        if separation >= 0:
            return ()
        return (
            f"The minimum separation is {separation:.2g} standard deviations of the asperity heights, below their mean plane: "
            f"most asperities touch, and the {self.name} law, which treats asperities as independent, is outside its range.",
        )


@dataclass(frozen=True)
class GreenwoodWilliamson(_GaussianHeights):
    r"""Contact law of a rough and a plane surface, asperities being spheres of one radius with Gaussian heights.

    .. math:: \Phi(s) = F_{3/2}(s), \qquad p_c = \beta E^* F_{3/2}(h/\sigma), \qquad
        \beta = \frac43 \, \eta_s R_s \sigma \sqrt{\sigma/R_s}

    Notes
    -----
    With alpha = 1 the h_rms of the contact is the standard deviation :math:`\sigma` of the summit heights, and the gap is
    measured from their mean plane.  The law is exact for its model from -12 on, also below zero, where the model
    itself (asperities that know nothing of each other) no longer holds; notes of a solution say so.  Below -12, where the
    pressure is above 40 beta E*, it goes on by its tangent.

    Source: [GW]; docs/contact_laws.md.
    """

    order: ClassVar[float] = 1.5
    name: ClassVar[str] = "greenwood-williamson"
    beta_formula: ClassVar[str] = "4/3 density radius deviation (deviation/radius)^(1/2)"

    @staticmethod
    def _beta(eta: float, R: float, sigma: float) -> float:
        return 4 / 3 * eta * R * sigma * math.sqrt(sigma / R)


@dataclass(frozen=True)
class GreenwoodTripp(_GaussianHeights):
    r"""Contact law of two similar rough surfaces whose asperities are paraboloids of one radius with Gaussian heights.

    .. math:: \Phi(s) = F_{5/2}(s), \qquad p_c = \beta E^* F_{5/2}(h/\sigma), \qquad
        \beta = \frac{16 \sqrt2 \pi}{15} (\eta_s R_s \sigma)^2 \sqrt{\sigma/R_s}

    Notes
    -----
    With alpha = 1 the h_rms of the contact is the composite standard deviation of the summit heights,
    :math:`\sigma = (\sigma_1^2 + \sigma_2^2)^{1/2}`.  E* is the modulus of both surfaces together.
    The integral is exact: the fit
    :math:`4.4086 \cdot 10^{-5} (4 - s)^{6.804}` that is often used for it is 74 % too small at three standard deviations, and
    zero from four on (``test_asperity_laws.py::test_the_popular_fit_of_greenwood_and_tripp_is_wrong_where_contact_begins``).

    Source: [GT]; docs/contact_laws.md.
    """

    order: ClassVar[float] = 2.5
    name: ClassVar[str] = "greenwood-tripp"
    beta_formula: ClassVar[str] = "4.739 (density radius deviation)^2 (deviation/radius)^(1/2)"

    @staticmethod
    def _beta(eta: float, R: float, sigma: float) -> float:
        return 16 * math.sqrt(2) * math.pi / 15 * (eta * R * sigma) ** 2 * math.sqrt(sigma / R)


# The numbers of a surface of summits, from which a law makes the coefficients of a contact.
SUMMITS = {
    row.name: row
    for row in (
        Input(name="density", label="summits per area", dimension="per area", typical="1e10 m^-2"),
        Input(name="radius", label="radius of the summits", dimension="length", typical="10 um"),
        Input(name="deviation", label="standard deviation of their heights", dimension="length", typical="1 um"),
    )
}
