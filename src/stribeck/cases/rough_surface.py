r"""The roughness of a case file: a self-affine spectrum given by numbers with units, and the contact law that it implies.

Source: [Persson05] for the spectrum, [YP08] for the law.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from stribeck.contact_laws.persson import GAMMA, PerssonLaw, check_gamma, persson_law
from stribeck.contact_laws.spectrum import SelfAffine
from stribeck.quantities.lazy import cached_property
from stribeck.quantities.units import InputError, show, to_si

__all__ = ["RoughSurface"]


@dataclass(frozen=True, init=False)
class RoughSurface:
    r"""Self-affine roughness of both surfaces together, in SI units, as the table ``[surface]`` of a case gives it.

    Each cut-off is given once, as a wave number :math:`q` (``"1e5 1/m"``) or as a wavelength :math:`2\pi/q` (``"60 um"``).

    Parameters
    ----------
    h_rms : str or float
        Root mean square of the height [m].
    hurst : float
        Hurst exponent, above 0 and at most 1 [-].
    q0 : str or float, optional
        Wave number of the longest roughness [1/m]; or give ``longest_wavelength``.
    q1 : str or float, optional
        Wave number of the shortest roughness [1/m]; or give ``shortest_wavelength``.
    roll_off : str or float, optional
        Wave number from which the spectrum falls [1/m]; or give ``roll_off_wavelength``; without both there is no roll-off.
    longest_wavelength : str or float, optional
        Longest roughness [m].
    shortest_wavelength : str or float, optional
        Shortest roughness [m].
    roll_off_wavelength : str or float, optional
        Wavelength from which on the spectrum is flat [m].
    gamma : float
        Reduction of the elastic energy in Persson's theory, from 0.01 to 1 [-].

    Attributes
    ----------
    roughness : SelfAffine
        The spectrum as four or five numbers.

    Raises
    ------
    InputError
        Where a value is impossible, a unit is wrong, a cut-off is missing or given twice, or they are not in order.

    Examples
    --------
    >>> surface = RoughSurface(h_rms="1 um", hurst=0.8, longest_wavelength="100 um", shortest_wavelength="100 nm")
    >>> round(surface.law.alpha, 2), round(surface.law.beta, 3)
    (2.09, 0.089)
    """

    h_rms: float
    hurst: float
    q0: float
    q1: float
    roll_off: float
    gamma: float

    def __init__(
        self,
        *,
        h_rms: str | float,
        hurst: float,
        q0: str | float | None = None,
        q1: str | float | None = None,
        roll_off: str | float | None = None,
        longest_wavelength: str | float | None = None,
        shortest_wavelength: str | float | None = None,
        roll_off_wavelength: str | float | None = None,
        gamma: float = GAMMA,
    ) -> None:
        """Check the values and bring them to SI units."""
        first = _cut_off("q0", q0, "longest_wavelength", longest_wavelength)
        last = _cut_off("q1", q1, "shortest_wavelength", shortest_wavelength)
        if first is None:
            raise InputError("q0 is missing; give it as in '6e4 1/m', or longest_wavelength as in '100 um'.")
        if last is None:
            raise InputError("q1 is missing; give it as in '6e7 1/m', or shortest_wavelength as in '100 nm'.")
        bend = _cut_off("roll_off", roll_off, "roll_off_wavelength", roll_off_wavelength)
        gamma = check_gamma(gamma)
        height = _length("h_rms", h_rms)
        checked = SelfAffine(height, first, last, to_si(hurst, "number", "hurst", "0.8"), bend)
        fields = {"h_rms": height, "hurst": checked.hurst, "q0": first, "q1": last, "roll_off": bend or first, "gamma": gamma}
        for name, value in fields.items():
            object.__setattr__(self, name, value)

    @cached_property
    def roughness(self) -> SelfAffine:
        """The spectrum as numbers."""
        return SelfAffine(self.h_rms, self.q0, self.q1, self.hurst, self.roll_off)

    @cached_property
    def law(self) -> PerssonLaw:
        """Persson's contact law of this roughness, tabulated on first use."""
        return persson_law(self.roughness, self.gamma)


def _cut_off(name: str, wavenumber: str | float | None, other: str, wavelength: str | float | None) -> float | None:
    """Return a wave number that may be given as a wavelength, None where neither is given."""
    if wavenumber is not None and wavelength is not None:
        raise InputError(f"{name} = {show(wavenumber)} and {other} = {show(wavelength)} mean the same; give one of them.")
    if wavelength is not None:
        return 2 * math.pi / _length(other, wavelength)
    if wavenumber is None:
        return None
    value = to_si(wavenumber, "wavenumber", name)
    if value <= 0:
        raise InputError(f"{name} = {show(wavenumber)} is not above zero; give the wave number 2 pi/wavelength.")
    return value


def _length(name: str, value: str | float) -> float:
    length = to_si(value, "length", name, "1 um")
    if length <= 0:
        raise InputError(f"{name} = {show(value)} is not above zero; give a length such as '1 um'.")
    return length
