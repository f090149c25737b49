r"""Power spectra of isotropic rough surfaces: self-affine ones in closed form, measured ones as tables.

The spectrum :math:`C(q)` is that of the surface in two dimensions, with the wave number :math:`q = 2\pi/\text{wavelength}`:

.. math::

    h_\mathrm{rms}^2 = 2\pi \int_{q_0}^{q_1} q\, C(q)\, \mathrm{d}q

Both kinds are straight between their points on double logarithmic axes, so all their moments are closed forms.  Lengths
are in metres at the border; any other unit serves as long as all lengths share it.

Source: [Persson05] for the convention and the self-affine form.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np
import scipy

from stribeck._types import Array
from stribeck.quantities.docstrings import Described, told
from stribeck.quantities.formats import format_si
from stribeck.quantities.lazy import cached_property
from stribeck.quantities.results import ByValue
from stribeck.quantities.schema import Input, law
from stribeck.quantities.units import InputError, RowError, show

# What methods say that scale roughness.
OF_HEIGHT = "Spectrum, SelfAffine or PerssonLaw\n    The same kind, of the other height."
SCALED = {"rms_height": "float\n    Root mean square of the height [m]."}
TOO_HIGH = (
    "InputError\n    Where ``rms_height`` is not a positive number, or more than the longest wavelength, as a factor would be."
)


@dataclass(frozen=True, eq=False)
class Spectrum(ByValue, Described, title="Parameters"):
    r"""Isotropic power spectrum as a table, a power law between neighbouring points and zero outside.

    Raises
    ------
    InputError
        Where the table is too short, unsorted, or has a value that is no positive number; the row is named.

    Notes
    -----
    Moments are exact for the table; how well the table represents a surface is not checked here.
    Source: [Persson05], with its normalisation of C.

    Examples
    --------
    >>> import numpy as np
    >>> round(Spectrum([1.0, np.e], [1.0, np.exp(-2.0)]).rms_height ** 2 / (2 * np.pi), 12)
    1.0
    """

    wavenumber: Annotated[Array, "wave numbers :math:`q` of the points, rising", "1/m"]
    density: Annotated[Array, "spectrum :math:`C` of the surface in two dimensions there, positive", "m^4"]

    def __post_init__(self) -> None:
        """Check the table and keep read-only copies."""
        for name in ("wavenumber", "density"):
            object.__setattr__(self, name, _column(name, getattr(self, name)))
        if self.wavenumber.shape != self.density.shape:
            raise InputError(
                f"the spectrum has {self.wavenumber.size} wave numbers and {self.density.size} densities; "
                "give one density for each wave number."
            )
        if self.wavenumber.size < 2:
            raise InputError("the spectrum has fewer than two points; give at least two, of different wave numbers.")
        if not np.all(np.diff(self.wavenumber) > 0):
            i = int(np.argmin(np.diff(self.wavenumber) > 0)) + 1
            text = (
                f"wavenumber in {{row}} = {self.wavenumber[i]:g} is not above the one before it, {self.wavenumber[i - 1]:g}; "
                "sort the rows by wave number and keep one for each."
            )
            raise RowError(text, i, f"row {i + 1}")

    @property
    def lowest(self) -> float:
        """Wave number of the longest roughness, the long cut-off q_0 [1/m]."""
        return float(self.wavenumber[0])

    @property
    def highest(self) -> float:
        """Wave number of the shortest roughness, the short cut-off q_1 [1/m]."""
        return float(self.wavenumber[-1])

    @cached_property
    def exponent(self) -> Array:
        """Power -d ln C/d ln q of each stretch between two points."""
        return np.asarray(-np.diff(np.log(self.density)) / np.diff(np.log(self.wavenumber)))

    def at(self, wavenumber: Array) -> Array:
        """Return the spectrum at wave numbers.

        Parameters
        ----------
        wavenumber : array_like
            Wave numbers [1/m].

        Returns
        -------
        ndarray
            C(q) [m^4], zero outside the table.
        """
        q = np.asarray(wavenumber, dtype=float)
        inside = (q >= self.lowest) & (q <= self.highest)
        logs = np.interp(np.log(np.where(inside, q, self.lowest)), np.log(self.wavenumber), np.log(self.density))
        return np.where(inside, np.exp(logs), 0.0)

    def stretches(self, order: float) -> Array:
        r"""Return the integral of each stretch of the table.

        .. math:: \int_{q_i}^{q_{i+1}} q^n C(q)\, \mathrm{d}q

        Parameters
        ----------
        order : float
            Power n.

        Returns
        -------
        ndarray
            One integral for each stretch [m^(3-n)].
        """
        q, n = self.wavenumber, order + 1
        return q[:-1] ** n * self.density[:-1] * _growth(n - self.exponent, np.diff(np.log(q)))

    def moment(self, order: float) -> float:
        r"""Return a moment of the spectrum.

        .. math:: m_n = 2\pi \int_{q_0}^{q_1} q^{n+1} C(q)\, \mathrm{d}q

        Parameters
        ----------
        order : float
            Order n: 0 is the mean square of height, 2 that of the slope, 4 that of the Laplacian.

        Returns
        -------
        float
            The moment [m^(2-n)].
        """
        return 2 * math.pi * math.fsum(self.stretches(order + 1))

    @property
    def rms_height(self) -> float:
        """Root mean square of the height [m]."""
        return math.sqrt(self.moment(0))

    @property
    def rms_slope(self) -> float:
        """Root mean square of the gradient of the height [1]; that along a line is smaller by the root of 2."""
        return math.sqrt(self.moment(2))

    @property
    def rms_curvature(self) -> float:
        """Root mean square of the mean curvature, half the Laplacian of the height [1/m]."""
        return 0.5 * math.sqrt(self.moment(4))

    @told(SCALED, OF_HEIGHT, TOO_HIGH)
    def scaled(self, rms_height: float) -> Spectrum:
        """Return the spectrum of the same shape with another rms height."""
        return self._with_height(height_of_roughness(rms_height, 2 * math.pi / self.lowest))

    def _with_height(self, rms_height: float) -> Spectrum:
        return Spectrum(self.wavenumber, self.density * (rms_height / self.rms_height) ** 2)

    def between(self, lowest: float, highest: float) -> Spectrum:
        """Return the part of the spectrum between two wave numbers.

        Parameters
        ----------
        lowest, highest : float
            Wave numbers [1/m]; those outside the table are moved to its ends.

        Returns
        -------
        Spectrum
            The part, with points at its ends.

        Raises
        ------
        InputError
            Where nothing of the table lies between them.
        """
        lowest, highest = positive("lowest", lowest), positive("highest", highest)
        low, high = max(lowest, self.lowest), min(highest, self.highest)
        if not low < high:
            raise InputError(
                f"no part of the spectrum lies between {lowest:g} and {highest:g} 1/m; "
                f"it reaches from {self.lowest:g} to {self.highest:g} 1/m."
            )
        q = self.wavenumber
        inner = q[(q > low * (1 + 1e-12)) & (q < high * (1 - 1e-12))]
        nodes = np.concatenate(([low], inner, [high]))
        return Spectrum(nodes, self.at(nodes))


@law
class SelfAffine:
    r"""Self-affine roughness: a flat roll-off, then a power law; without ``roll_off`` the power law alone, from q_0.

    .. math::

        C(q) = C_r \begin{cases} 1 & q_0 \le q \le q_r \\ (q/q_r)^{-2(1+H)} & q_r \le q \le q_1 \end{cases}

    Raises
    ------
    InputError
        Where a value is no number in its range, or the wave numbers are not in this order.

    Notes
    -----
    Source: [Persson05]; q_0 is called q_L there where a roll-off follows it, and q_r then q_0.

    Examples
    --------
    >>> surface = SelfAffine(h_rms="1 um", q0="1e5 1/m", q1="1e8 1/m", hurst=0.8)
    >>> round(surface.spectrum.rms_height, 18)
    1e-06
    """

    h_rms: Input = Input(label="rms height", symbol=r"$h_\mathrm{rms}$", dimension="length", typical="1 um")
    q0: Input = Input(label="wave number q₀", symbol="$q_0$", dimension="wavenumber", typical="6e4 1/m")
    q1: Input = Input(label="wave number q₁", symbol="$q_1$", dimension="wavenumber", typical="6e7 1/m")
    hurst: Input = Input(
        label="Hurst exponent", symbol="$H$", dimension="number", typical="0.8", highest=1.0, reason="it is often near 0.8"
    )
    roll_off: Input = Input(
        label="roll-off wave number",
        symbol="$q_r$",
        dimension="wavenumber",
        typical="3e5 1/m",
        zero=True,
        optional=True,
        default=0.0,
        without="q0",
    )

    def __post_init__(self) -> None:
        """Check the values together."""
        roll_off = self.roll_off or self.q0
        object.__setattr__(self, "roll_off", roll_off)
        if not self.q0 < self.q1:
            raise InputError(
                f"q1 = {self.q1:g} is not above q0 = {self.q0:g}; q0 belongs to the longest roughness, q1 to the shortest."
            )
        if not self.q0 <= roll_off < self.q1:
            raise InputError(f"roll_off = {roll_off:g} lies outside q0 = {self.q0:g} to q1 = {self.q1:g}, q1 excluded.")

    @cached_property
    def spectrum(self) -> Spectrum:
        """The spectrum as a table of two or three points."""
        falling = (self.q1 / self.roll_off) ** (-2 * (1 + self.hurst))
        if self.roll_off > self.q0:
            table = Spectrum(np.array([self.q0, self.roll_off, self.q1]), np.array([1.0, 1.0, falling]))
        else:
            table = Spectrum(np.array([self.q0, self.q1]), np.array([1.0, falling]))
        return table._with_height(self.h_rms)

    @told(SCALED, OF_HEIGHT, TOO_HIGH)
    def scaled(self, rms_height: float) -> SelfAffine:
        """Return the surface of the same shape of the spectrum with another rms height."""
        return replace(self, h_rms=height_of_roughness(rms_height, 2 * math.pi / self.q0))


def _growth(power: Array, width: Array) -> Array:
    """Return the integral of exp(power t) over t from 0 to ``width``, also where the power vanishes."""
    return np.asarray(width * scipy.special.exprel(power * width))


def table_of(roughness: object) -> Spectrum:
    """Return a spectrum as its table; refuse what is none."""
    table = roughness.spectrum if isinstance(roughness, SelfAffine) else roughness
    if not isinstance(table, Spectrum):
        raise InputError(f"{show(roughness)} is no power spectrum; give a SelfAffine or a Spectrum.")
    return table


def positive(name: str, value: object) -> float:
    """Return a positive number as a float, or raise an error that names it."""
    try:
        number = float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError, OverflowError):
        number = math.nan
    if isinstance(value, bool | str | bytes | np.ndarray) or not (math.isfinite(number) and number > 0):
        raise InputError(f"{name} = {show(value)} is not a positive number; give one above zero, in SI units.")
    return number


def height_of_roughness(value: object, longest_wavelength: float) -> float:
    """Return an rms height, or raise an error if no roughness can have it."""
    height = positive("rms_height", value)
    if height > longest_wavelength:
        raise InputError(
            f"rms_height = {show(value)} would be {format_si(height, 'length')}, more than the longest wavelength of the "
            f"roughness, {format_si(longest_wavelength, 'length')}; give the new rms height in m, such as 1e-6, not a factor."
        )
    return height


def _column(name: str, values: object) -> Array:
    try:
        array = np.array(values, dtype=float)
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"{name} of the spectrum is not a column of numbers.") from None
    if array.ndim != 1:
        raise InputError(f"{name} of the spectrum has the shape {array.shape}; give a column of numbers.")
    good = np.isfinite(array) & (array > 0)
    if not good.all():
        i = int(np.argmin(good))
        advice = "remove the rows where the spectrum has gaps, or fill them"
        text = f"{name} in {{row}} = {array[i]:g} is not a positive number; {advice}."
        raise RowError(text, i, f"row {i + 1} of the spectrum")
    array.setflags(write=False)
    return array
