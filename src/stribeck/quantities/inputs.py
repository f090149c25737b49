"""What the quantities of a line contact may be: the dimension and the bounds of each, and its value in SI units, checked.

A contact, a case file, the columns of a sweep and the settings of a fit all read their quantities here.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ParamSpec, TypeVar

from stribeck.quantities.units import DIMENSIONS, InputError, format_si, show, to_si

__all__ = [
    "FORMER",
    "INPUTS",
    "QUANTITIES",
    "SYMBOLS",
    "Quantity",
    "check_modulus_choice",
    "quantity",
    "refuse_former",
    "si_text",
    "unit_of",
]

P = ParamSpec("P")
R = TypeVar("R")


@dataclass(frozen=True)
class Quantity:
    """Dimension and lower bound of one input; ``zero`` tells whether the bound zero itself is allowed.

    ``typical`` is a value of a laboratory's contact, and ``source`` says where that is from.
    """

    dimension: str
    typical: str
    source: str
    zero: bool = False
    highest: float = math.inf


_PDMS = "as in examples/pdms_cylinder.toml"

QUANTITIES = {
    "radius": Quantity("length", "10 mm", _PDMS),
    "load": Quantity("load", "30 N/m", _PDMS),
    "viscosity": Quantity("viscosity", "50 mPa*s", "81 % glycerol in water at 25 degrees Celsius"),
    "speed": Quantity("speed", "1 mm/s", _PDMS, zero=True),
    "roughness": Quantity("length", "1 um", "rms height of a lightly sandblasted or ground surface", zero=True),
    "alpha": Quantity("number", "2.0", "Persson's theory gives 1.8 to 2.1"),
    "beta": Quantity("number", "0.06", "about 1.4 q0 h_rms by Persson's theory: 1 um and 150 um for the longest wave"),
    "boundary_friction": Quantity("number", "0.7", "dry PDMS, 0.5 to 1", zero=True),
    "modulus": Quantity("pressure", "2.7 MPa", "E* of PDMS Sylgard 184"),
    "youngs_modulus": Quantity("pressure", "2.0 MPa", "PDMS Sylgard 184"),
    "poisson_ratio": Quantity("number", "0.5", "rubber and gels", zero=True, highest=0.5),
}

FORMER = {"friction_coefficient": "boundary_friction", "mu0": "boundary_friction"}
"""What inputs were once called, and the names that took their place."""

INPUTS = ("radius", "load", "viscosity", "speed", "roughness", "alpha", "beta", "boundary_friction", "modulus")
"""The quantities of :class:`stribeck.LineContact`, in its order."""


SYMBOLS = {
    "radius": "$R$",
    "modulus": "$E^*$",
    "load": "$F_N$",
    "viscosity": r"$\eta$",
    "speed": "$U$",
    "roughness": r"$h_\mathrm{rms}$",
    "alpha": r"$\alpha$",
    "beta": r"$\beta$",
    "boundary_friction": r"$\mu_0$",
}
"""Symbols for pictures."""


def quantity(name: str, value: Any) -> float:
    """Return one input of :class:`stribeck.LineContact` in SI units, checked.

    Parameters
    ----------
    name : str
        One of the keys of :data:`QUANTITIES`.
    value : str or float
        Text with a unit, or a bare number in SI units.

    Returns
    -------
    float
        The value in SI units.

    Raises
    ------
    InputError
        Where the value is impossible or its unit is wrong.
    """
    wanted = QUANTITIES[name]
    result = to_si(value, wanted.dimension, name)
    if wanted.highest < math.inf and not 0 <= result <= wanted.highest:
        raise InputError(f"{name} = {show(value)} must be between 0 and {wanted.highest:g}.")
    if result < 0 or (result == 0 and not wanted.zero):
        allowed = "zero or positive" if wanted.zero else "positive"
        raise InputError(f"{name} = {show(value)} must be {allowed}.")
    return result


def refuse_former(function: Callable[P, R]) -> Callable[P, R]:
    """Return the function such that an argument under one of the :data:`FORMER` names is refused with the present name."""

    @functools.wraps(function)
    def checked(*args: P.args, **kwargs: P.kwargs) -> R:
        for old in FORMER.keys() & kwargs.keys():
            raise InputError(f"{old} = {show(kwargs[old])}: this input is called {FORMER[old]}; write {FORMER[old]} = ...")
        return function(*args, **kwargs)

    return checked


def check_modulus_choice(modulus: Any, youngs_modulus: Any, poisson_ratio: Any) -> None:
    """Check that the elasticity is given once: E* alone, or E and nu together.

    Parameters
    ----------
    modulus, youngs_modulus, poisson_ratio : object
        The inputs, None where not given.

    Raises
    ------
    InputError
        Where it is given twice, in part or not at all.
    """
    pair = {"youngs_modulus": youngs_modulus, "poisson_ratio": poisson_ratio}
    given = [f"{name} = {show(value)}" for name, value in pair.items() if value is not None]
    missing = [name for name, value in pair.items() if value is None]
    if modulus is not None and given:
        raise InputError(
            f"modulus = {show(modulus)} (which is E*) and {' and '.join(given)} are given; "
            "give either modulus, or youngs_modulus and poisson_ratio."
        )
    if modulus is None and not given:
        raise InputError("modulus (which is E*) is missing; give it, or youngs_modulus and poisson_ratio together.")
    if modulus is None and missing:
        typical = " The Poisson ratio of rubber and gels is close to 0.5." if missing == ["poisson_ratio"] else ""
        raise InputError(f"{missing[0]} is missing beside {given[0]}; give both, or modulus (which is E*) alone.{typical}")


def unit_of(name: str) -> str:
    """Return the SI unit of an input in the spelling of UDUNITS, which files use."""
    return DIMENSIONS[QUANTITIES[name].dimension].unit.replace("*", " ") or "1"


def si_text(value: float, name: str, digits: int) -> str:
    """Return an input of a contact with its unit."""
    return format_si(value, QUANTITIES[name].dimension, digits).replace("*", "·")
