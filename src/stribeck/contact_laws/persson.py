r"""Persson's contact law: the pressure that holds two rough surfaces apart, from the power spectrum, to full contact.

With :math:`G(q) = (\pi \int_{q_0}^q q'^3 C\, \mathrm{d}q')^{1/2}`, the mean separation :math:`u` at the mean pressure
:math:`p = P E^*` is

.. math::

    u(P) = \frac{2}{\sqrt\pi} \int_0^{G(q_1)} J(P/G) \frac{\mathrm{d}G}{q}, \qquad
    J(t) = \int_t^\infty \left[\gamma + 3 (1 - \gamma) \operatorname{erf}^2 t'\right] e^{-t'^2} \frac{\mathrm{d}t'}{t'}

which is the published integral with :math:`G` as variable (docs/surfaces.md), so that nothing is singular.  It is taken for
unit rms height and unit :math:`q_0`, on which the shape of the law does not depend.

At small pressure :math:`p = \beta E^* \exp(-\alpha u/h_\mathrm{rms})`.
The law is tabulated once as :math:`\ln\Phi + s` over :math:`\ln s`,
where :math:`s = \alpha u/h_\mathrm{rms}` and :math:`\Phi = p/(\beta E^*)`.

Source: [YP08] for the integral, [Persson07] for the limit of small pressure.
"""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass, field, replace
from typing import Annotated, Any

import numpy as np
import scipy

from stribeck._types import Array, Indices
from stribeck.contact_laws.spectrum import OF_HEIGHT, SCALED, TOO_HIGH, SelfAffine, Spectrum, height_of_roughness, table_of
from stribeck.numerics.dual import value_of
from stribeck.quantities.docstrings import Described, told
from stribeck.quantities.results import ByValue
from stribeck.quantities.schema import Input
from stribeck.quantities.units import InputError

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

TABLE_TOLERANCE = 1e-11  # Largest error of ln(pressure) between the points of the table (test_persson.py).

EXCESS_DECAY = 37.0  # Separation above which the excess over the exponential, exp(-s), is below double precision.

MAX_PRESSURE = 26.3  # Pressure over G(q_1) E* at the end of the table; the separation is near 1e-306 there.

MAX_TABLE_POINTS = 20_000  # Points at which the table is given up as not converging.

ERF_SATURATION = 36.0  # Square of the argument above which erf is one in double precision.


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


@dataclass(frozen=True)
class Integral:
    """Nodes G and weights (2/pi^(1/2)) dG/q of the integral over the spectrum, for unit rms height."""

    gamma: float
    G: Array
    weight: Array
    stiffness: float
    alpha: float
    beta: float

    @classmethod
    def of(cls, spectrum: Spectrum, gamma: float) -> Integral:
        """Return the integral over a spectrum, with the exponential limit of the law."""
        G, weight = _nodes(spectrum)
        total = math.fsum(weight)
        mean_log = math.fsum(weight * np.log(G)) / total
        jump = 3 * (1 - gamma) / gamma * _erf_part()[1]
        return cls(
            gamma=gamma,
            G=G,
            weight=weight,
            stiffness=math.sqrt(spectrum.moment(2) / 2),
            alpha=1 / (gamma * total),
            beta=math.exp(mean_log - 0.5 * np.euler_gamma + jump),
        )

    def separation(self, y: Array) -> Array:
        """Return ln s and its first two derivatives with respect to y = ln Phi, a row each."""
        # The factor exp(-t_1^2), t_1 = P/G(q_1), is taken out of all three sums, so that they do not underflow.
        P = self.beta * np.exp(y)[:, None]
        lowest = (P[:, 0] / self.stiffness) ** 2
        t = P / self.G
        fade = np.exp(np.minimum(lowest[:, None] - t * t, 0.0)) * self.weight
        erf, share = scipy.special.erf(t), 3 * (1 - self.gamma)
        rate = self.gamma + share * erf * erf
        bend = 4 / math.sqrt(math.pi) * share * erf * t * np.exp(-t * t) - 2 * t * t * rate
        scaled, counts = np.zeros_like(t), fade > 0  # Most nodes lie where the pressure has faded to nothing.
        scaled[counts] = _scaled_J(t[counts], self.gamma)
        s = np.sum(scaled * fade, axis=1)
        first, second = -np.sum(rate * fade, axis=1) / s, -np.sum(bend * fade, axis=1) / s
        return np.stack((np.log(self.alpha * s) - lowest, first, second - first * first))


def _nodes(spectrum: Spectrum) -> tuple[Array, Array]:
    """Return nodes G(q) and weights of the integral over dG/q, fine towards both ends of the spectrum."""
    # Towards q_0 panels shrink with G down to where J is negligible at any pressure of the table, towards q_1 down to the
    # width of the layer that counts near full contact.
    t, w = np.polynomial.legendre.leggauss(16)
    q, C, power = spectrum.wavenumber, spectrum.density, 4 - spectrum.exponent
    below = np.concatenate(([0.0], np.cumsum(math.pi * spectrum.stretches(3))))
    nodes, weights = [], []
    for i, width in enumerate(np.diff(np.log(q))):
        edges = np.linspace(0.0, 1.0, 2 + int(width / 0.5))
        if i == q.size - 2:
            edges = np.concatenate((edges[:-1], 1 - (1 - edges[-2]) * 0.5 ** np.arange(1, 14), [1.0]))
        if i == 0:
            # In tau, with q = q_0 exp(width tau^2), the root of G at q_0 is gone.
            edges = np.sqrt(edges)
            edges = np.concatenate(([0.0], edges[1] * 0.5 ** np.arange(50, 0, -1), edges[1:]))
        tau = (0.5 * np.diff(edges)[:, None] * (t + 1) + edges[:-1, None]).ravel()
        step = (0.5 * np.diff(edges)[:, None] * w).ravel()
        log_q, rate = (width * tau**2, 2 * width * tau) if i == 0 else (width * tau, np.full_like(tau, width))
        rise = log_q * scipy.special.exprel(power[i] * log_q)
        G = np.sqrt(below[i] + math.pi * C[i] * q[i] ** 4 * rise)
        density = C[i] * np.exp(-spectrum.exponent[i] * log_q)
        wavenumber = q[i] * np.exp(log_q)
        # dG/q = pi q^3 C dq/(2 G q) and dq = q dln q.
        nodes.append(G)
        weights.append(math.pi * wavenumber**3 * density / (2 * G) * rate * step)
    return np.concatenate(nodes), 2 / math.sqrt(math.pi) * np.concatenate(weights)


def _scaled_J(t: Array, gamma: float) -> Array:  # noqa: N802
    """Return exp(t^2) J(t)."""
    # Each branch only where it holds: the sums of many terms are most of what a table costs.
    large = t * t > ERF_SATURATION
    near, square = t[~large], t[large] ** 2
    exponential, erf_part = np.empty_like(t), np.empty_like(t)
    exponential[~large], exponential[large] = np.exp(near * near) * scipy.special.exp1(near * near), _laguerre(square)
    erf_part[~large], erf_part[large] = _erf_part()[0](near), 0.5 * exponential[large]
    return np.asarray(0.5 * gamma * exponential + 3 * (1 - gamma) * erf_part)


def _laguerre(x: Array) -> Array:
    """Return exp(x) E_1(x) for ``x`` of 36 and more."""
    nodes, weights = np.polynomial.laguerre.laggauss(16)
    total = np.zeros_like(x)
    for node, weight in zip(nodes, weights, strict=True):
        total += weight / (x + node)
    return total


@functools.cache
def _erf_part() -> tuple[np.polynomial.Chebyshev, float]:
    r"""Return polynomial for exp(t^2) K(t) up to t = 6, K(t) the integral of erf^2 exp(-t'^2)/t' from t, and K(0)."""
    # With z = t'^2 - t^2 the first is half the integral of exp(-z) erf^2(r)/r^2 over z, r^2 = t^2 + z, which is smooth.
    x, w = np.polynomial.legendre.leggauss(16)
    edges = np.linspace(0.0, 40.0, 17)
    z = (0.5 * np.diff(edges)[:, None] * (x + 1) + edges[:-1, None]).ravel()
    weight = (0.5 * np.diff(edges)[:, None] * w).ravel() * np.exp(-z) / 2

    def scaled(t: Array) -> Array:
        square = np.asarray(t)[..., None] ** 2 + z
        return np.asarray(np.sum(weight * scipy.special.erf(np.sqrt(square)) ** 2 / square, axis=-1))

    fit = np.polynomial.Chebyshev.interpolate(scaled, 72, domain=[0.0, math.sqrt(ERF_SATURATION)])
    return fit, float(scaled(np.array(0.0)))


def tabulate(integral: Integral) -> tuple[Array, Array, float]:
    """Return the knots ln s, the coefficients of the excess ln Phi + s between them, and its largest error."""
    delay = math.log(max(1.0, integral.beta * integral.alpha))
    y = _start(integral, -EXCESS_DECAY - delay)
    jets = integral.separation(y)
    checked, error = np.zeros(y.size - 1, dtype=bool), 0.0
    while not checked.all():
        if y.size > MAX_TABLE_POINTS:
            raise InputError("Persson's law of this spectrum could not be tabulated; give a smoother spectrum.")
        open_intervals = np.flatnonzero(~checked)
        middle = 0.5 * (y[open_intervals] + y[open_intervals + 1])
        jet = integral.separation(middle)
        knots, coefficients = _quintics(y, jets)
        # Knots run from small to large separation, against y.
        c = coefficients[:, y.size - 2 - open_intervals]
        t = jet[0] - knots[y.size - 2 - open_intervals]
        value = ((((c[5] * t + c[4]) * t + c[3]) * t + c[2]) * t + c[1]) * t + c[0]
        miss = np.abs(value - (middle + np.exp(jet[0])))
        good = miss <= TABLE_TOLERANCE
        error = max(error, float(np.max(miss[good], initial=0.0)))
        checked[open_intervals[good]] = True
        split = open_intervals[~good]
        y = np.insert(y, split + 1, middle[~good])
        jets = np.insert(jets, split + 1, jet[:, ~good], axis=1)
        checked = np.insert(checked, split + 1, False)
    knots, coefficients = _quintics(y, jets)
    return knots, coefficients, error


def _start(integral: Integral, lowest: float) -> Array:
    """Return first points ln Phi, from ``lowest`` to the stiffest, finer in the pressure where it moves little."""
    turn = math.log(integral.stiffness / integral.beta)
    above = np.log(np.linspace(1.0, MAX_PRESSURE, 40)) + turn
    return np.concatenate((np.linspace(lowest, turn, 60)[:-1], above))


def _quintics(y: Array, jets: Array) -> tuple[Array, Array]:
    """Return knots and polynomials of the excess through its values and two derivatives with respect to ln s."""
    x, x_y, x_yy = jets[:, ::-1]
    s, slope = np.exp(x), 1 / x_y
    f = np.stack((y[::-1] + s, slope + s, -x_yy * slope**3 + s))
    h = np.diff(x)
    c0, c1, c2 = f[0, :-1], f[1, :-1], f[2, :-1] / 2
    a = (f[0, 1:] - c0) - h * (c1 + h * c2)
    b = h * (f[1, 1:] - c1 - 2 * h * c2)
    c = h * h * (f[2, 1:] - 2 * c2)
    c3 = (10 * a - 4 * b + 0.5 * c) / h**3
    c4 = (-15 * a + 7 * b - c) / h**4
    c5 = (6 * a - 3 * b + 0.5 * c) / h**5
    return x, np.stack((c0, c1, c2, c3, c4, c5))
