r"""What roughness does to the flow through a narrow gap: flow factors and friction factors, as functions of the mean gap.

The package's gap is the mean width of the space between the surfaces, :math:`h_T`.  Patir and Cheng's factors are fits in the
nominal separation, the distance d of the mean planes, which goes on falling where asperities overlap.  For Gaussian heights

.. math:: \frac{h_T}{\sigma} = H \Phi(H) + \varphi(H), \qquad H = \frac d\sigma, \qquad \frac{dh_T}{dd} = \Phi(H)

with the normal distribution :math:`\Phi` and its density :math:`\varphi`.  Their flow, :math:`\phi_x d^3`, has the third power
of the separation too: at :math:`h_T = 1.083 \sigma` the separation is :math:`\sigma`, and the flow is 0.486 of :math:`d^3` but
0.382 of :math:`h_T^3`.

Source: [Patir & Cheng 1978] and [Patir & Cheng 1979] for the fits.
"""

import math
from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import Any, ClassVar, Literal, Self

import numpy as np
import scipy

from stribeck._types import Array
from stribeck.fluids.laws import FilmUnits, FlowFactors
from stribeck.numerics.dual import with_slope
from stribeck.numerics.trace import pointwise
from stribeck.quantities.units import InputError, show, to_si

MIN_FLOW_FACTOR = 1e-4  # Least pressure flow factor: without any flow the pressure gradient would have no bound.

# Fraction of the way from the end of the fits to their zero on which they go over into an exponential.
BLEND_FRACTION = 0.5
# Continuous derivatives of that blend; with one, the series of a curve converge on a twentieth of their length there.
BLEND_DERIVATIVES = 4

SEPARATION_RANGE = -37.0, 9.0  # H below which mean widths underflow, and above which the mean width is H in double precision.

SHEAR_FIT_END = 5.0  # H from which Patir and Cheng's shear flow factor is an exponential.

FRICTION_FIT_END = 7.0  # H from which Patir and Cheng's phi_fs is zero.

# Peklenik number -> H to which the fits go, C, r of phi_x and A1, a1, a2, a3, A2 of phi_s.
FIT_COEFFICIENTS = {
    9: (0.5, 0.870, 1.5, 1.011, 0.54, 1.07, 0.08, 0.295),
    6: (0.5, 0.520, 1.5, 1.290, 0.62, 1.09, 0.08, 0.388),
    3: (0.5, 0.225, 1.5, 1.560, 0.85, 1.13, 0.08, 0.556),
    1: (0.5, 0.90, 0.56, 1.899, 0.98, 0.92, 0.05, 1.126),
    1 / 3: (0.75, 1.18, 0.42, 1.858, 1.01, 0.76, 0.03, 1.561),
    1 / 6: (1.0, 1.38, 0.42, 1.962, 1.08, 0.77, 0.03, 1.754),
    1 / 9: (1.0, 1.48, 0.42, 2.046, 1.12, 0.78, 0.03, 1.856),
}


@dataclass(frozen=True)
class OfGaussianSurfaces(FlowFactors):
    """Flow factors of Gaussian surfaces, whose roughness follows from alpha of the contact law."""

    alpha: float | None = None
    sigma: float | None = field(default=None, init=False, repr=False)  # Roughness in Hertz units; None in SI units

    def __post_init__(self) -> None:
        """Check alpha."""
        if self.alpha is not None:
            value = to_si(self.alpha, "number", "alpha", "2.0")
            if value <= 0:
                raise InputError(f"alpha = {show(self.alpha)} must be above zero; it is that of the contact law, about 2.")
            object.__setattr__(self, "alpha", value)

    def scaled(self, units: FilmUnits) -> Self:
        """Return the factors in Hertz units."""
        alpha = units.alpha if self.alpha is None else self.alpha
        if alpha is None:
            raise InputError(
                "flow factors of groups need alpha, the coefficient of the contact law: about 2, as PatirCheng(2.0)."
            )
        found = replace(self)
        object.__setattr__(found, "sigma", alpha * units.decay_length / units.gap)
        return found

    @property
    def roughness(self) -> float:
        """The roughness in Hertz units."""
        if self.sigma is None:
            raise InputError("flow factors in SI units are no film yet; give them to a contact or to groups.")
        return self.sigma


@dataclass(frozen=True)
class PatirCheng(OfGaussianSurfaces):
    r"""Flow factors of Gaussian surfaces from simulated flows.

    .. math::

        \phi_x = \begin{cases} 1 - C e^{-rH} & \gamma \le 1 \\ 1 + C H^{-r} & \gamma > 1 \end{cases} \qquad
        \phi_s = (2 v - 1) \begin{cases} A_1 H^{a_1} e^{-a_2 H + a_3 H^2} & H \le 5 \\ A_2 e^{-H/4} & H > 5 \end{cases}

    with H the nominal separation over the roughness :math:`\sigma`, found from the mean gap.  The flow under a pressure
    gradient goes as :math:`\phi_x (\sigma H)^3`: over that between smooth surfaces at the mean gap it is
    :math:`\phi = \phi_x (\sigma H/h_T)^3`.  The fits go down to :math:`H_0` = 0.5 for :math:`\gamma \ge 1`, 0.75 for 1/3 and 1
    below.  Nearer than that the pressure flow factor goes over, with four derivatives, into an exponential of the same slope,
    before the fit falls to zero at :math:`H_z`, and the shear flow factor is proportional to the mean gap:

    .. math:: \phi = \phi(H_0 + y) \, e^{k (H - H_0 - y)}, \quad k = \frac{\phi'(H_0)}{\phi(H_0)}, \quad
              y = \frac{H - H_0}{[1 + ((H - H_0)/w)^4]^{1/4}}, \quad w = \frac{H_0 - H_z}{2}, \qquad
              \phi_s = \phi_s(H_0) \, \frac{h_T(H)}{h_T(H_0)}

    Parameters
    ----------
    alpha : float, optional
        :math:`\alpha` of the contact law, so that :math:`\sigma = \alpha` times the decay length of the contact pressure
        [-]; left out, that of the contact.  Groups, which do not hold it, need it.
    gamma : float
        Peklenik number: length over width of asperities, along the flow above 1 [-]; 1/9, 1/6, 1/3, 1, 3, 6 or 9.
    substrate_share : float
        :math:`v`, the share of the moving substrate in the variance of the heights [-].  At 1/2, both surfaces equally
        rough, sliding carries nothing; 0 is the rough cylinder, 1 the rough substrate.
    friction_factors : bool
        Whether the drag has its factors too, fitted for isotropic surfaces (gamma = 1) only.
    argument : {"nominal", "mean"}
        What :math:`\sigma H` is: the nominal separation, as in the simulations, or the mean gap itself, as in many programs.

    Raises
    ------
    InputError
        Where a value is impossible.

    Notes
    -----
    Below :math:`H_0` a note is written, and 1e-4 of the flow between smooth surfaces is left at least.  The fits themselves,
    taken further, give a negative flow across :math:`\gamma < 1`, and past a rough cylinder at rest sliding would carry less
    through a wider gap: such a film has several states, or none.  The factor of the shear, :math:`\phi_f`, is the mean of
    1/h, which the authors cut off at widths of :math:`\sigma/100`: where asperities touch, it holds no more than that choice.

    Source: [Patir & Cheng 1978] Eq. (15), [Patir & Cheng 1979].
    """

    name: ClassVar[str] = "patir-cheng"
    label: ClassVar[str] = "Patir and Cheng"

    gamma: float = 1.0
    substrate_share: float = 0.5
    friction_factors: bool = False
    argument: Literal["nominal", "mean"] = "nominal"

    def __post_init__(self) -> None:
        """Check the numbers, and take the Peklenik number of the table that is meant."""
        super().__post_init__()
        gamma, share = to_si(self.gamma, "number", "gamma", "1"), to_si(self.substrate_share, "number", "substrate_share")
        known = min(FIT_COEFFICIENTS, key=lambda each: abs(math.log(max(gamma, 1e-9) / each)))
        if not abs(gamma / known - 1) < 0.01:
            raise InputError(
                f"gamma = {show(self.gamma)}; Patir and Cheng give factors for 1/9, 1/6, 1/3, 1, 3, 6 and 9 only."
            )
        if not 0 <= share <= 1:
            raise InputError(
                f"substrate_share = {show(self.substrate_share)} must lie between 0 and 1: its share in the variance."
            )
        if not isinstance(self.friction_factors, bool):
            raise InputError(f"friction_factors = {show(self.friction_factors)} must be true or false.")
        if self.friction_factors and known != 1:
            raise InputError(f"friction_factors are those of isotropic roughness: give gamma = 1, not {show(self.gamma)}.")
        if self.argument not in ("nominal", "mean"):
            raise InputError(
                f"argument = {show(self.argument)} must be 'nominal' or 'mean': the gap that the fits are taken at."
            )
        object.__setattr__(self, "gamma", known)
        object.__setattr__(self, "substrate_share", share)

    @property
    def parameters(self) -> dict[str, float | str]:
        """Peklenik number, share and the roughness in Hertz units."""
        found: dict[str, float | str] = {"gamma": self.gamma, "substrate_share": self.substrate_share}
        found |= {"friction_factors": str(self.friction_factors).lower(), "argument": self.argument}
        return found if self.sigma is None else {**found, "sigma": self.sigma}

    def pressure(self, gap: Any) -> Any:
        """Return the flow over that between smooth surfaces at the mean gap."""
        H = self._separation(gap)
        least, C, r = FIT_COEFFICIENTS[self.gamma][:3]
        x = np.minimum(H - least, 0.0)
        zero = 0.0 if self.gamma > 1 else max(0.0, math.log(C) / r)
        short = 1 + (x / (BLEND_FRACTION * (least - zero))) ** BLEND_DERIVATIVES
        y = x * short ** (-1 / BLEND_DERIVATIVES)
        _, [k] = with_slope(lambda at: np.log(self._fit(at)), np.array([least]))
        return add_floor(self._fit(np.maximum(H, least) + y) * np.exp(k * (x - y)))

    def _fit(self, H: Any) -> Any:
        """Return the flow over that between smooth surfaces as fitted."""
        _, C, r = FIT_COEFFICIENTS[self.gamma][:3]
        phi_x = 1 + C * H**-r if self.gamma > 1 else 1 - C * np.exp(-r * H)
        return phi_x * (H / self._width(H)) ** 3

    def shear(self, gap: Any) -> Any:
        """Return sigma phi_s."""
        v = 2 * self.substrate_share - 1
        if v == 0:
            return np.zeros_like(gap)
        H = self._separation(gap)
        least = FIT_COEFFICIENTS[self.gamma][0]
        share = self._near(least) / (self.roughness * self._width(least))
        near = self._near(np.clip(H, least, SHEAR_FIT_END))
        return v * self.roughness * np.where(H > SHEAR_FIT_END, self._far(H), np.where(H > least, near, share * gap))

    def _near(self, H: Any) -> Any:
        """Return the fit of phi_s up to :data:`SHEAR_FIT_END`, for v = 1."""
        _, _, _, A_1, a_1, a_2, a_3, _ = FIT_COEFFICIENTS[self.gamma]
        return A_1 * H**a_1 * np.exp(-a_2 * H + a_3 * H * H)

    def _far(self, H: Any) -> Any:
        """Return the fit of phi_s beyond, for v = 1."""
        return FIT_COEFFICIENTS[self.gamma][-1] * np.exp(-0.25 * H)

    def jump(self, gap: Array, slide: float) -> Array | None:
        """Return by how much h + s sigma phi_s, over phi_x, jumps between each node and the next one: two fits do not meet."""
        # Slopes do not meet either, nor where the fits end: a kink k between nodes w apart errs by k w^2/12 at most in a
        # quadrature, as a jump k w/6 does.
        v = abs(slide * (2 * self.substrate_share - 1)) * (self.sigma or 0.0)
        if v == 0:
            return None
        H = self._separation(gap)
        apart = np.abs(np.diff(H)) / 6
        least = FIT_COEFFICIENTS[self.gamma][0]
        (last, near), (falls, steep) = with_slope(self._near, np.array([least, SHEAR_FIT_END]))
        far, ([width], [by_H]) = self._far(SHEAR_FIT_END), with_slope(self._width, np.array([least]))
        linked, ends = ((H[..., 1:] > at) != (H[..., :-1] > at) for at in (SHEAR_FIT_END, least))
        found = np.zeros_like(gap)
        found[..., :-1] += linked * v * (np.abs(far - near) + np.abs(steep + 0.25 * far) * apart)
        found[..., :-1] += ends * v * np.abs(falls - last * by_H / width) * apart
        return found

    def friction(self, gap: Any) -> tuple[Any, Any, Any] | None:
        """Return phi_f (of eta s over the mean gap), phi_fs and phi_fp."""
        if not self.friction_factors:
            return None
        H = self._separation(gap)
        width = gap / self.roughness
        v = 2 * self.substrate_share - 1
        inside = np.clip(H, 0.0, FRICTION_FIT_END)
        fs = v * 11.1 * inside**2.31 * np.exp(-2.38 * inside + 0.11 * inside**2) * (H < FRICTION_FIT_END)
        # Both are of eta s over the nominal separation.
        fitted = np.maximum(H, FIT_COEFFICIENTS[self.gamma][0])
        ratio = width / fitted
        return width * pointwise(mean_inverse_width, H), fs * ratio, (1 - 1.4 * np.exp(-0.66 * fitted)) / ratio

    def notes(self, gap: Array, pressure: Array | None) -> tuple[str, ...]:
        """Return whether surfaces are closer than the fits go."""
        H, least = self._separation(np.atleast_1d(gap.min()))[0], FIT_COEFFICIENTS[self.gamma][0]
        if H >= least:
            return ()
        return (
            f"the surfaces come as near as {H:.2g} rms roughnesses; Patir and Cheng's flow factors are fits above {least:g}",
        )

    def _width(self, H: Any) -> Any:
        """Return the mean gap over the roughness at H."""
        return H if self.argument == "mean" else mean_width(H)

    def _separation(self, gap: Any) -> Any:
        """Return H."""
        if self.argument == "mean":
            return gap / self.roughness
        return pointwise(lambda width: (H := nominal_separation(width), 1 / scipy.special.ndtr(H)), gap / self.roughness)


def mean_width(H: Any) -> Any:
    """Return the mean width between Gaussian surfaces at a separation of their mean planes, both over the roughness."""
    return H * scipy.special.ndtr(H) + np.exp(-0.5 * H * H) / math.sqrt(2 * math.pi)


@lru_cache(maxsize=1)
def _separations() -> tuple[Array, Array]:
    """Logarithms of mean widths, ascending, and their separations."""
    H = np.linspace(*SEPARATION_RANGE, 4001)
    return np.log(mean_width(H)), H


def nominal_separation(width: Array) -> Array:
    """Return the separation of the mean planes at a mean width > 0, both over the roughness of Gaussian surfaces."""
    logs, separations = _separations()
    log = np.clip(np.log(width), logs[0], logs[-1])
    H = np.interp(log, logs, separations)
    for _ in range(2):  # in the logarithms Newton's steps square an error of 1e-5 twice
        known = mean_width(H)
        H = H - (np.log(known) - log) * known / scipy.special.ndtr(H)
    return np.where(width > SEPARATION_RANGE[1], width, H)


def mean_inverse_width(H: Array) -> tuple[Array, Array]:
    r"""Return the mean of ``1/width`` where that exceeds 1/100, over ``1/sigma``, and its slope: phi_f/H.

    For heights with the density :math:`\tfrac{35}{96} (1 - z^2/9)^3` on :math:`|z| < 3`, as [Patir & Cheng 1979] take it.
    """
    # Gauss's rule of 1/u against a polynomial over u = 1/100 ... H + 3, in ln(u).
    nodes, weights = np.polynomial.legendre.leggauss(24)
    low, high = np.maximum(H - 3, 0.01), np.maximum(H + 3, 0.02)
    span = np.log(high / low)
    at = np.log(low) + 0.5 * span * (1 + nodes[:, None])
    z = np.clip((np.exp(at) - H) / 3, -1.0, 1.0)
    density = 35 / 96 * (1 - z * z) ** 3
    density_slope = 35 / 96 * 2 * z * (1 - z * z) ** 2  # by H
    value = 0.5 * span * (weights @ density)
    return value, 0.5 * span * (weights @ density_slope)


def add_floor(phi: Any) -> Any:
    """Return a flow factor that stays above zero: itself far above :data:`MIN_FLOW_FACTOR`."""
    return 0.5 * (phi + np.sqrt(phi * phi + 4 * MIN_FLOW_FACTOR**2))
