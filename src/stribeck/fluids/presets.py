r"""Liquids with their numbers: viscosity, laws and where these are from.

.. math::

    \eta = \eta_w^{w} \, \eta_g^{1 - w}, \quad w = 1 - C + \frac{a b \, C (1 - C)}{a C + b (1 - C)}, \quad
    a = 0.705 - 0.0017 T, \quad b = (4.9 + 0.036 T) \, a^{2.5}

for glycerol in water, C the part of glycerol in the weight and T the temperature in degrees Celsius, with

.. math::

    \eta_w = 1.790 \exp\frac{(-1230 - T) T}{36100 + 360 T} \text{ mPa s}, \qquad
    \eta_g = 12100 \exp\frac{(-1233 + T) T}{9900 + 70 T} \text{ mPa s}

Source: [Cheng 2008], within 3.5 % of the 80 viscosities from 0 to 40 degrees in Dow's table (``test_presets.py``).

Small molecules turn too fast for the flow to order them until the stress is an energy kT for each, :math:`\varrho R T/M`: the
shear rate at which a liquid of them thins is that over its viscosity (rotation time of Debye, within a factor of some).
"""

from __future__ import annotations

import difflib
import inspect
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Annotated, Any

from stribeck.fluids.description import IMPOSSIBLE, LIQUID, TEMPERATURE, Fluid, Liquid, celsius, check_temperature
from stribeck.fluids.oils import OIL_EYRING_STRESS, SOURCE, centistokes, iso_vg, oil
from stribeck.fluids.rheology.rate_laws import Carreau, Cross
from stribeck.fluids.rheology.viscosity import Roelands
from stribeck.quantities.docstrings import Described, told
from stribeck.quantities.units import InputError, show, to_si

WATER_EYRING_STRESS = 1e8  # Stress kT per molecule of water, rounded down [Pa].
GLYCEROL_EYRING_STRESS = 3e7  # Stress kT per molecule of glycerol, rounded down [Pa].


@dataclass(frozen=True)
class Preset(Described):
    """A row of the table of liquids: call it with its conditions."""

    label: Annotated[str, "what it is"]
    make: Annotated[Callable[..., Liquid], "from conditions to a :class:`Liquid`"]
    source: Annotated[str, "where the numbers are from"]
    range: Annotated[str, "where they hold"]

    @property
    def conditions(self) -> dict[str, Any]:
        """Conditions with their usual values."""
        return {name: each.default for name, each in inspect.signature(self.make).parameters.items()}

    def __call__(self, **conditions: Any) -> Liquid:
        """Return the liquid under these conditions."""
        unknown = [name for name in conditions if name not in self.conditions]
        if unknown:
            has = (
                f"it has {' and '.join(self.conditions)}"
                if self.conditions
                else f"its numbers hold at {self.range}; remove it"
            )
            raise InputError(f"{unknown[0]} is no condition of {self.label}; {has}.")
        return self.make(**conditions)


@told({"temperature": f"{TEMPERATURE}."}, LIQUID, IMPOSSIBLE)
def water(temperature: str | float = 25.0) -> Liquid:
    """Return water at a temperature between 0 and 100 degrees Celsius."""
    T = check_temperature(celsius(temperature), 0, 100)
    viscosity = _water(T)
    return Liquid(f"water at {T:g} degC", viscosity, Fluid(), "Cheng 2008", WATER_EYRING_STRESS / viscosity)


@told(
    {"weight_fraction": "float\n    Glycerol in the weight, 0 to 1 [-].", "temperature": f"{TEMPERATURE}, 0 to 100."},
    LIQUID,
    IMPOSSIBLE,
)
def glycerol_water(weight_fraction: float = 0.5, temperature: str | float = 25.0) -> Liquid:
    """Return a mixture of glycerol and water."""
    C, T = to_si(weight_fraction, "number", "weight_fraction"), check_temperature(celsius(temperature), 0, 100)
    if not 0 <= C <= 1:
        raise InputError(f"weight_fraction = {show(weight_fraction)} must lie between 0 and 1: the glycerol in the weight.")
    eta_g = 12.1 * math.exp((-1233 + T) * T / (9900 + 70 * T))
    a = 0.705 - 0.0017 * T
    b = (4.9 + 0.036 * T) * a**2.5
    w = 1 - C + a * b * C * (1 - C) / (a * C + b * (1 - C))
    viscosity, name = _water(T) ** w * eta_g ** (1 - w), f"{100 * C:g} % glycerol in water at {T:g} degC"
    return Liquid(name, viscosity, Fluid(), "Cheng 2008", GLYCEROL_EYRING_STRESS / viscosity)


def _water(T: float) -> float:
    return 1.790e-3 * math.exp((-1230 - T) * T / (36100 + 360 * T))


def _silicone(grade: str | float = 100.0, temperature: str | float = 25.0) -> Liquid:
    """Return a silicone oil (PDMS) of a grade in cSt."""
    given, grade = grade, centistokes(grade, "grade")
    if not 5 <= grade <= 1000:
        raise InputError(f"grade = {show(given)} must lie between 5 and 1000 cSt; thicker silicone oils thin under shear.")
    T = check_temperature(celsius(temperature), -25, 150)
    if T != 25 and grade < 50:
        raise InputError(
            f"temperature = {show(temperature)} and grade = {show(given)}: below 50 cSt the viscosity is "
            "not known within 10 % at other temperatures than 25 degC; give the viscosity."
        )
    density = (917 + 56 * (1 - math.exp(-math.log(grade / 5) / 1.6))) * (1 - 9.6e-4 * (T - 25))
    kinematic = grade * 10 ** (763.1 * (1 / (T + 273.15) - 1 / 298.15))
    return Liquid(f"silicone oil {grade:g} cSt at {T:g} degC", 1e-6 * kinematic * density, Fluid(), _SILICONE)


def _fixed(label: str, viscosity: float, fluid: Fluid, source: str, range: str, stress: float | None = None) -> Preset:
    """Return a liquid without conditions."""
    liquid = Liquid(label, viscosity, fluid, source, None if stress is None else stress / viscosity)
    return Preset(label, lambda: liquid, source, range)


_SILICONE = (
    "the grade is the kinematic viscosity at 25 degC, which changes as 10^(763.1 K/T); density of makers' data sheets within "
    "1 %, 964 kg/m3 at 100 cSt"
)
_OIL = (
    "61.0 cSt at 40 degC and 9.64 cSt at 100 degC by the data sheet of Synfluid PAO 10 cSt (Chevron Phillips, 2022); density "
    "821 kg/m3 within 2 %; pressure coefficient about 15 % uncertain"
)
_XANTHAN = "round numbers: 0.7 Pa s at 1/s and 35 mPa s at 100/s; varies by half with salt and supplier: measure yours"
_SALIVA = (
    "round numbers: 10 mPa s at 10/s, near water at high rates as by Stokes & Davies 2007; varies several times with "
    "donor and stimulation: measure yours"
)


class _Presets(dict[str, Preset]):
    def __missing__(self, name: str) -> Preset:
        near = difflib.get_close_matches(str(name), self, n=1, cutoff=0.5)
        raise KeyError(f"{name}; did you mean {near[0]}?" if near else f"{name}; there are {', '.join(self)}")


PRESETS: Mapping[str, Preset] = MappingProxyType(
    _Presets(
        {
            "water": Preset("water", water, "Cheng 2008", "0 to 100 degC"),
            "glycerol-water": Preset("glycerol in water", glycerol_water, "Cheng 2008", "0 to 100 degC, all fractions"),
            "silicone-oil": Preset("silicone oil", _silicone, _SILICONE, "5 to 1000 cSt; at -25 to 150 degC from 50 cSt"),
            "iso-vg": Preset("mineral oil, ISO VG", iso_vg, SOURCE, "5 to 3200 cSt at 40 degC, -20 to 150 degC"),
            "oil": Preset("oil of two viscosities", oil, SOURCE, "-20 to 150 degC"),
            "pao-10": _fixed(
                "PAO 10 at 40 degC",
                61.0e-6 * 821,
                Fluid(viscosity=Roelands(1.7e-8)),
                _OIL,
                "40 degC, to 0.5 GPa",
                OIL_EYRING_STRESS,
            ),
            "xanthan": _fixed(
                "0.25 % xanthan in water", 2.0, Fluid(Carreau(5.0, 0.35, 1.5e-3)), _XANTHAN, "25 degC, 0.1 to 1000 1/s"
            ),
            "saliva": _fixed("saliva (a model)", 0.02, Fluid(Cross(0.1, 0.6, 1.2e-3)), _SALIVA, "37 degC, 10 to 1e4 1/s"),
        }
    )
)
"""Liquids by name; ``PRESETS["glycerol-water"](weight_fraction=0.8, temperature="20 degC")`` is a :class:`Liquid`.

:meta hide-value:
"""
