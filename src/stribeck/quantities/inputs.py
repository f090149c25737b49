"""The table of inputs: name, label, symbol, unit, bounds and group exponents of each, and its value in SI units, checked.

Contacts, case files, the command line, sweeps, fits, pictures and the explorer read it: one row is one input everywhere.
"""

from __future__ import annotations

import difflib
import functools
import inspect
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ParamSpec, TypeVar

from stribeck.quantities.units import DIMENSIONS, InputError, format_si, show, to_si

__all__ = [
    "ALTERNATIVES",
    "GROUP_EXPONENTS",
    "FORMER",
    "INPUTS",
    "LETTERS",
    "QUANTITIES",
    "SYMBOLS",
    "ROWS",
    "Alternative",
    "Input",
    "check_alternatives",
    "contact_values",
    "quantity",
    "refuse_former",
    "replaced",
    "si_text",
    "signature_of",
    "unit_of",
]

P = ParamSpec("P")
R = TypeVar("R")


@dataclass(frozen=True)
class Input:
    """One input of a contact: all that any part of the package needs to know of it.

    Attributes
    ----------
    name : str
        Its name, in Python, case files, on the command line, in fits, sweeps and files.
    label : str
        What people call it.
    symbol : str
        TeX.
    dimension : str
        A key of :data:`stribeck.quantities.units.DIMENSIONS`.
    typical, source : str
        A value of a laboratory's contact, and where that is from.
    exponents : tuple of float
        Exponents with which it enters the groups of speed, load and roughness.
    usual : tuple of float
        Range that contacts have, in SI units: the ends of its slider.
    units : tuple of str
        Units to choose from; empty for a bare number.
    letters : tuple of str
        Symbols and names that users type for it.
    headers : tuple of str
        Words at the head of a column of measurements that mean it, in lower case.
    zero : bool
        Whether zero is allowed.
    highest : float
        Largest value allowed.
    follows_surface : bool
        Whether it follows from the roughness of the surface, and no hand can turn it alone.
    derived : bool
        Whether a contact keeps another input in its place, see :data:`ALTERNATIVES`.
    """

    name: str
    label: str
    symbol: str
    dimension: str
    typical: str
    source: str
    exponents: tuple[float, float, float] = (0, 0, 0)
    usual: tuple[float, float] = (0.0, math.inf)
    units: tuple[str, ...] = ()
    letters: tuple[str, ...] = ()
    headers: tuple[str, ...] = ()
    zero: bool = False
    highest: float = math.inf
    follows_surface: bool = False
    derived: bool = False


_PDMS = "as in examples/pdms_cylinder.toml"

ROWS = (
    Input(
        name="radius",
        label="radius",
        symbol="$R$",
        dimension="length",
        typical="10 mm",
        source=_PDMS,
        exponents=(1, -1, -1),
        usual=(1e-4, 1.0),
        units=("mm", "cm", "m"),
        letters=("R",),
    ),
    Input(
        name="modulus",
        label="effective modulus",
        symbol="$E^*$",
        dimension="pressure",
        typical="2.7 MPa",
        source="E* of PDMS Sylgard 184",
        exponents=(1, -1, 0),
        usual=(1e4, 1e12),
        units=("kPa", "MPa", "GPa"),
        letters=("E_star",),
        headers=("e star",),
    ),
    Input(
        name="load",
        label="load",
        symbol="$F_N$",
        dimension="load",
        typical="30 N/m",
        source=_PDMS,
        exponents=(-2, 1, 0),
        usual=(0.1, 1e5),
        units=("N/m", "kN/m", "N/mm"),
        letters=("F_N",),
        headers=("f n",),
    ),
    Input(
        name="viscosity",
        label="viscosity",
        symbol=r"$\eta$",
        dimension="viscosity",
        typical="50 mPa*s",
        source="81 % glycerol in water at 25 degrees Celsius",
        exponents=(1, 0, 0),
        usual=(1e-4, 1e3),
        units=("mPa*s", "Pa*s", "cP"),
        letters=("eta",),
        headers=("eta",),
    ),
    Input(
        name="speed",
        label="speed",
        symbol="$U$",
        dimension="speed",
        typical="1 mm/s",
        source=_PDMS,
        exponents=(1, 0, 0),
        usual=(1e-8, 10.0),
        units=("µm/s", "mm/s", "m/s"),
        letters=("U",),
        zero=True,
    ),
    Input(
        name="roughness",
        label="roughness",
        symbol=r"$h_\mathrm{rms}$",
        dimension="length",
        typical="1 um",
        source="rms height of a lightly sandblasted or ground surface",
        exponents=(0, 0, 1),
        usual=(1e-9, 1e-4),
        units=("nm", "µm", "mm"),
        letters=("h_rms",),
        headers=("h rms",),
        zero=True,
    ),
    Input(
        name="alpha",
        label="contact-law alpha",
        symbol=r"$\alpha$",
        dimension="number",
        typical="2.0",
        source="Persson's theory gives 1.8 to 2.1",
        exponents=(0, 0, -1),
        usual=(0.5, 5.0),
        follows_surface=True,
    ),
    Input(
        name="beta",
        label="contact-law beta",
        symbol=r"$\beta$",
        dimension="number",
        typical="0.06",
        source="about 1.4 q0 h_rms by Persson's theory: 1 um and 150 um for the longest wave",
        exponents=(0, -2, -2),
        usual=(1e-3, 2.0),
        follows_surface=True,
    ),
    Input(
        name="boundary_friction",
        label="dry friction coefficient",
        symbol=r"$\mu_0$",
        dimension="number",
        typical="0.7",
        source="dry PDMS, 0.5 to 1",
        usual=(0.01, 2.0),
        letters=("mu0", "mu_0"),
        zero=True,
    ),
    Input(
        name="youngs_modulus",
        label="Young's modulus",
        symbol="$E$",
        dimension="pressure",
        typical="2.0 MPa",
        source="PDMS Sylgard 184",
        letters=("E",),
        derived=True,
    ),
    Input(
        name="poisson_ratio",
        label="Poisson's ratio",
        symbol=r"$\nu$",
        dimension="number",
        typical="0.5",
        source="rubber and gels",
        letters=("nu",),
        zero=True,
        highest=0.5,
        derived=True,
    ),
    Input(
        name="entrainment_speed",
        label="entrainment speed",
        symbol=r"$\bar U$",
        dimension="speed",
        typical="1 mm/s",
        source="the mean of both surface speeds, which tribometers report",
        zero=True,
        derived=True,
    ),
)
"""The inputs of a line contact. A new one is a row here and, if a contact keeps it, a field of :class:`LineContact`."""


@dataclass(frozen=True)
class Alternative:
    """Inputs that may be given in place of another.

    Attributes
    ----------
    of : str
        The input that a contact keeps.
    inputs : tuple of str
        What may be given instead, all together.
    value : callable
        Its value from theirs, in SI units.
    meaning : str
        What the kept input is, for sentences.
    hint : str
        What to know if one of several is missing.
    """

    of: str
    inputs: tuple[str, ...]
    value: Callable[..., float]
    meaning: str
    hint: str = ""


ALTERNATIVES = (
    Alternative(
        "modulus",
        ("youngs_modulus", "poisson_ratio"),
        lambda E, nu: E / (1 - nu**2),
        "which is E*",
        "The Poisson ratio of rubber and gels is close to 0.5.",
    ),
    Alternative("speed", ("entrainment_speed",), lambda mean: 2 * mean, "the sum of the surface speeds, twice their mean"),
)

QUANTITIES = {row.name: row for row in ROWS}
"""The inputs by name."""

INPUTS = tuple(row.name for row in ROWS if not row.derived)
"""The inputs that a contact keeps, in the order in which outputs name them."""

SYMBOLS = {row.name: row.symbol for row in ROWS if not row.derived}
"""Symbols for pictures."""

LETTERS = {letter: row.name for row in ROWS for letter in row.letters}
"""Letters of the article and of the trade, and the inputs that they stand for."""

GROUP_EXPONENTS = {row.name: row.exponents for row in ROWS if not row.derived}
"""Exponents with which each input enters the groups of speed, load and roughness."""

FORMER = {"friction_coefficient": "boundary_friction", "mu0": "boundary_friction"}
"""What inputs were once called, and the names that took their place."""


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


def contact_values(given: Mapping[str, Any]) -> dict[str, float]:
    """Return the inputs that a contact keeps, in SI units, from those that were given.

    Parameters
    ----------
    given : mapping
        Inputs of :data:`ROWS` by name, text with a unit or numbers in SI units; None counts as not given if
        another may take its place.

    Returns
    -------
    dict of str to float
        A value for each of :data:`INPUTS`.

    Raises
    ------
    InputError
        If one is unknown, missing, given twice or impossible.
    """
    choices = {name for other in ALTERNATIVES for name in (other.of, *other.inputs)}
    values = {name: value for name, value in given.items() if value is not None or name not in choices}
    for name in values:
        if name not in QUANTITIES:
            near = difflib.get_close_matches(name, QUANTITIES, n=1)
            known = f"did you mean {near[0]}?" if near else f"known are {', '.join(QUANTITIES)}."
            raise InputError(f"{name} = {show(values[name])} is not an input of a contact; {known}")
    check_alternatives(values)
    for other in ALTERNATIVES:
        if other.of not in values:
            values[other.of] = other.value(*(quantity(name, values.pop(name)) for name in other.inputs))
    missing = [name for name in INPUTS if name not in values]
    if missing:
        raise InputError(f"{', '.join(missing)} missing; a contact needs {', '.join(INPUTS)}.")
    return {name: quantity(name, values[name]) for name in INPUTS}


def signature_of(table: Sequence[Input]) -> inspect.Signature:
    """Return the signature of a contact that takes the inputs of a table, and a contact law."""
    others = {name for other in ALTERNATIVES for name in (other.of, *other.inputs)}
    keyword = inspect.Parameter.KEYWORD_ONLY
    default = {name: None for name in others}
    inputs = [inspect.Parameter(row.name, keyword, default=default.get(row.name, inspect.Parameter.empty)) for row in table]
    return inspect.Signature([*inputs, inspect.Parameter("law", keyword, default=None)])


def check_alternatives(given: Mapping[str, Any]) -> None:
    """Check that an input with alternatives is given once: by itself, or by all of those that stand for it.

    Parameters
    ----------
    given : mapping
        Inputs by name; None counts as not given.

    Raises
    ------
    InputError
        If it is given twice, in part or not at all.
    """
    for other in ALTERNATIVES:
        values = {name: given.get(name) for name in other.inputs}
        there = [f"{name} = {show(value)}" for name, value in values.items() if value is not None]
        missing = [name for name, value in values.items() if value is None]
        kept, instead = given.get(other.of), " and ".join(other.inputs)
        if kept is not None and there:
            raise InputError(
                f"{other.of} = {show(kept)} ({other.meaning}) and {' and '.join(there)} are given; "
                f"give either {other.of}, or {instead}."
            )
        if kept is None and not there:
            together = " together" if len(other.inputs) > 1 else ""
            raise InputError(f"{other.of} ({other.meaning}) is missing; give it, or {instead}{together}.")
        if kept is None and missing:
            typical = f" {other.hint}" if missing == [other.inputs[-1]] else ""
            raise InputError(
                f"{missing[0]} is missing beside {there[0]}; give both, or {other.of} ({other.meaning}) alone.{typical}"
            )


def replaced(kept: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """Return inputs with some changed; an alternative among the changes takes the place of what it stands for."""
    found = dict(kept)
    for other in ALTERNATIVES:
        if any(name in changes for name in other.inputs):
            del found[other.of]
    return found | dict(changes)


def unit_of(name: str) -> str:
    """Return the SI unit of an input in the spelling of UDUNITS, which files use."""
    return DIMENSIONS[QUANTITIES[name].dimension].unit.replace("*", " ") or "1"


def si_text(value: float, name: str, digits: int) -> str:
    """Return an input of a contact with its unit."""
    return format_si(value, QUANTITIES[name].dimension, digits).replace("*", "·")
