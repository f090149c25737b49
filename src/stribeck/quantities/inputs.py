"""What the quantities of a line contact may be: the dimension and the bounds of each, and its value in SI units, checked.

A contact, a case file, the columns of a sweep and the settings of a fit all read their quantities here.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from stribeck._types import LawShape
from stribeck.quantities.units import InputError, show, to_si

__all__ = ["INPUTS", "QUANTITIES", "Quantity", "check_law", "check_modulus_choice", "quantity"]


@dataclass(frozen=True)
class Quantity:
    """Dimension and lower bound of one input; ``zero`` tells whether the bound zero itself is allowed."""

    dimension: str
    zero: bool = False
    highest: float = math.inf


QUANTITIES = {
    "radius": Quantity("length"),
    "load": Quantity("load"),
    "viscosity": Quantity("viscosity"),
    "speed": Quantity("speed", zero=True),
    "roughness": Quantity("length", zero=True),
    "alpha": Quantity("number"),
    "beta": Quantity("number"),
    "friction_coefficient": Quantity("number", zero=True),
    "modulus": Quantity("pressure"),
    "youngs_modulus": Quantity("pressure"),
    "poisson_ratio": Quantity("number", zero=True, highest=0.5),
}

INPUTS = ("radius", "load", "viscosity", "speed", "roughness", "alpha", "beta", "friction_coefficient", "modulus")
"""The quantities of :class:`stribeck.LineContact`, in its order."""


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


def check_law(law: Any) -> LawShape | None:
    """Return a contact law, or None for the exponential one; refuse what has not the methods of one."""
    if law is None or (isinstance(law, LawShape) and not isinstance(law, type)):
        return law
    advice = f"write {law.__name__}()" if isinstance(law, type) else "give an object such as GreenwoodWilliamson(), or None"
    raise InputError(f"law = {show(law)} is no contact law; {advice}.")


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
