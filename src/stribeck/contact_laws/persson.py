r"""Persson's contact law: the pressure that holds two rough surfaces apart, from the power spectrum, to full contact.

:mod:`stribeck.contact_laws.persson_integral` gives the mean separation :math:`u` at each mean pressure :math:`p`.
At small pressure :math:`p = \beta E^* \exp(-\alpha u/h_\mathrm{rms})`.
The law is tabulated once as :math:`\ln\Phi + s` over :math:`\ln s`,
where :math:`s = \alpha u/h_\mathrm{rms}` and :math:`\Phi = p/(\beta E^*)`.

Source: [YP08] for the integral, [Persson07] for the limit of small pressure.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Annotated, Any

import numpy as np
import scipy

from stribeck._types import Array, Indices
from stribeck.contact_laws.persson_integral import Integral, tabulate
from stribeck.contact_laws.spectrum import OF_HEIGHT, SCALED, TOO_HIGH, SelfAffine, Spectrum, height_of_roughness, table_of
from stribeck.numerics.trace import value_of
from stribeck.quantities.docstrings import Described, told
from stribeck.quantities.results import ByValue
from stribeck.quantities.schema import Input

__all__ = ["GAMMA", "GAMMA_INPUT", "PerssonLaw", "exponential_limit", "persson_law"]

GAMMA = 0.45  # Reduction of the elastic energy; 0.42 to 0.45 fit simulations [YP08].

MIN_GAMMA = 0.01  # Least gamma: far below simulations, and beta, which grows as exp(1.2/gamma), stays finite.

GAMMA_INPUT = Input(
    name="gamma",
    label="coefficient γ",
    dimension="number",
    typical="0.45",
    lowest=MIN_GAMMA,
    zero=True,
    highest=1.0,
    reason="0.45 fits simulations",
    optional=True,
    default=GAMMA,
)

# What functions say of the surface.
ROUGHNESS = {
    "spectrum": "Spectrum or SelfAffine\n    Power spectrum of the roughness of both surfaces together.",
    "gamma": "float\n    Reduction of the elastic energy, from 0.01 to 1 [-].",
}

SEALING_CONTACT_FRACTION = 0.42  # Fraction of the surface in contact above which no path of the fluid is left [Dapp 2012].


@dataclass(frozen=True, eq=False)
class PerssonLaw(ByValue, Described):
    r"""Pressure against separation, from first touch to full contact, in the units of the exponential law.

    .. math:: \Phi = \frac{p}{\beta E^*} \text{ at } s = \frac{\alpha u}{h_\mathrm{rms}}, \qquad
              \Phi \to e^{-s} \text{ as } s \to \infty

    Made by :func:`persson_law`.

    Notes
    -----
    Valid for every positive separation.  ``log_pressure`` is twice continuously differentiable and falls strictly; it
    grows as half of ln ln(1/s) towards full contact.  Its shape does not depend on the rms height, only beta does.
    Source: [YP08]; docs/surfaces.md, "The law of Persson".
    """

    alpha: Annotated[float, "decay of the exponential limit, alpha", "1"]
    beta: Annotated[float, "strength of the exponential limit, beta", "1"]
    rms_height: Annotated[float, "root mean square of the roughness", "m"]
    rms_slope: Annotated[float, "root mean square of its gradient", "1"]
    longest_wavelength: Annotated[float, "wavelength of the longest roughness, 2 pi/q0", "m"]
    gamma: Annotated[float, "reduction of the elastic energy", "1"]
    error: Annotated[float, "largest error of ln Phi between the points of the table, measured when it was made", "1"]
    _knots: Array = field(repr=False)
    _coefficients: Array = field(repr=False)
    name: Annotated[str, "name that outputs print"] = "persson"

    @property
    def parameters(self) -> dict[str, float | str]:
        """Numbers of the surface behind the law, for outputs."""
        names = ("alpha", "beta", "rms_height", "rms_slope", "gamma")
        return {name: float(getattr(self, name)) for name in names}

    @property
    def lowest(self) -> float:
        """Zero: the pressure diverges towards full contact."""
        return 0.0

    @property
    def area_slope(self) -> float:
        """Factor of the pressure Phi in the error function that is the share of the area in contact."""
        return self.beta * math.sqrt(2) / self.rms_slope

    @property
    def coefficients(self) -> dict[str, float]:
        """Inputs of a contact that follow from the surface: ``alpha``, ``beta`` and ``roughness`` [1, 1, m]."""
        return {"alpha": self.alpha, "beta": self.beta, "roughness": self.rms_height}

    def notes(self, separation: float) -> tuple[str, ...]:
        """Return notes on a state with this minimum separation."""
        share = float(self.area_fraction(np.array([separation]))[0]) if separation > 0 else 1.0
        if share < SEALING_CONTACT_FRACTION:
            return ()
        return (
            f"Up to {share:.3g} of the surface is in real contact: fluid passes hardly or not at all there, and Reynolds' "
            "equation with the mean gap is outside its range.",
        )

    def log_pressure(self, separation: Any) -> Any:
        r"""Return :math:`\ln\Phi(s)`."""
        s = separation
        position = np.log(np.maximum(s, np.finfo(float).tiny))
        index, t = self._locate(position)
        c = self._coefficients[:, index]
        excess = ((((c[5] * t + c[4]) * t + c[3]) * t + c[2]) * t + c[1]) * t + c[0]
        return np.where(s > 0, np.where(position < self._knots[-1], excess, 0.0) - s, -np.inf * (s - np.finfo(float).tiny))

    def area_fraction(self, separation: Array) -> Array:
        r"""Return the real area of contact over the apparent one.

        .. math:: A/A_0 = \operatorname{erf}\frac{p}{E^* G(q_1)}, \qquad G(q_1) = h'_\mathrm{rms}/\sqrt 2

        Parameters
        ----------
        separation : ndarray
            Mean separation s = alpha u/h_rms, of any shape [-].

        Returns
        -------
        ndarray
            Share of the area in contact, with all roughness of the spectrum [-].

        Notes
        -----
        At small pressure it is (8/pi)^(1/2) p/(E* h'_rms): the factor is 1.60, where simulations find about 2.
        Gamma does not enter.
        Source: [Persson01].
        """
        return self.area_fraction_at(np.exp(self.log_pressure(separation)))

    def area_fraction_at(self, pressure: Array) -> Array:
        """Return the real area of contact over the apparent one at a pressure."""
        return np.asarray(scipy.special.erf(self.area_slope * np.asarray(pressure, dtype=float)))

    @told(SCALED, OF_HEIGHT, TOO_HIGH)
    def scaled(self, rms_height: float) -> PerssonLaw:
        """Return the law of the same shape of the spectrum with another rms height, without a new table.

        Notes
        -----
        beta and the slope are proportional to the height, alpha stays.
        """
        factor = height_of_roughness(rms_height, self.longest_wavelength) / self.rms_height
        return replace(
            self,
            beta=self.beta * factor,
            rms_height=self.rms_height * factor,
            rms_slope=self.rms_slope * factor,
        )

    def _locate(self, position: Any) -> tuple[Indices, Any]:
        """Return the interval of the table that holds each ln s, and the distance from its left end."""
        knots = self._knots
        index = np.clip(np.searchsorted(knots, value_of(position), side="right") - 1, 0, knots.size - 2)
        return index, position - knots[index]


@told(ROUGHNESS)
def persson_law(spectrum: Spectrum | SelfAffine, gamma: float = GAMMA) -> PerssonLaw:
    r"""Tabulate Persson's contact law of a power spectrum.

    Returns
    -------
    PerssonLaw
        The law; between the points of its table ln Phi errs by less than 1e-11, which was measured.

    Raises
    ------
    InputError
        Where gamma is out of range, or the spectrum so strange that the table does not converge.

    Notes
    -----
    The intervals are halved until the interpolation of fifth order, through values and two derivatives, agrees with the
    integral between the points.  The integral itself is good to 1e-12 (``test_persson.py``).

    Examples
    --------
    >>> law = persson_law(SelfAffine(h_rms=1e-6, q0=1e4, q1=1e9, hurst=0.8))
    >>> round(law.alpha, 2), round(law.beta / (1e4 * 1e-6), 2)
    (2.09, 1.43)
    """
    integral, table = _unit_integral(spectrum, gamma)
    knots, coefficients, error = tabulate(integral)
    return PerssonLaw(
        alpha=integral.alpha,
        beta=integral.beta * table.lowest * table.rms_height,
        rms_height=table.rms_height,
        rms_slope=table.rms_slope,
        longest_wavelength=2 * math.pi / table.lowest,
        gamma=integral.gamma,
        error=error,
        _knots=knots,
        _coefficients=coefficients,
    )


@told(ROUGHNESS)
def exponential_limit(spectrum: Spectrum | SelfAffine, gamma: float = GAMMA) -> tuple[float, float]:
    r"""Return alpha and beta of the exponential law, without the table of the whole law.

    .. math::

        \alpha = \frac{h_\mathrm{rms}}{\gamma \pi^{1/2} \int q^2 C w\, \mathrm{d}q}, \quad
        \beta = 0.7493 \exp\left[-\langle\ln w\rangle + 3\, \tfrac{1 - \gamma}{\gamma}\, 0.40713\right]

    Returns
    -------
    tuple of float
        alpha and beta [-].

    Raises
    ------
    InputError
        Where gamma is out of range.

    Notes
    -----
    With w = 1/G and the mean weighted by q^2 C w.
    Source: [Persson07].
    """
    integral, table = _unit_integral(spectrum, gamma)
    return integral.alpha, integral.beta * table.lowest * table.rms_height


def _unit_integral(spectrum: Spectrum | SelfAffine, gamma: float) -> tuple[Integral, Spectrum]:
    """Return the integral for unit rms height and unit q_0, on which the shape does not depend, and the spectrum."""
    table, gamma = table_of(spectrum), GAMMA_INPUT.checked(gamma)
    unit = Spectrum(table.wavenumber / table.lowest, table.density / table.density.max()).scaled(1.0)
    return Integral.of(unit, gamma), table
