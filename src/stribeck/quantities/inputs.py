"""The tables of inputs: name, label, symbol, unit, bounds and group exponents of each, and its value in SI units, checked.

Contacts, case files, the command line, sweeps, fits, pictures and the explorer read them: one row is one input everywhere.
The table of a cylinder is the one that the names of this module are about; that of a ball has the same rows but for what
differs.
"""

from __future__ import annotations

import difflib
import functools
import inspect
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any, ParamSpec, TypeVar

from stribeck.quantities.keywords import answers_typos
from stribeck.quantities.units import DIMENSIONS, InputError, format_si, show, to_si

__all__ = [
    "ALTERNATIVES",
    "GROUP_EXPONENTS",
    "FORMER",
    "INPUTS",
    "INPUT_TABLES",
    "LETTERS",
    "QUANTITIES",
    "SYMBOLS",
    "ROWS",
    "Alternative",
    "Input",
    "InputTable",
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
    implausible : float
        Value beyond which something is wrong, as no known contact has it: a dry friction of 3 is that of smooth rubber on
        clean glass, the largest of all.
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
    optional : bool
        Whether a contact does without it.
    default : float or None
        What it then has, None if nothing.
    known : int
        Rank from what a fit is mostly after to what is mostly known: the order in which fits name their inputs.
    """

    name: str
    label: str
    symbol: str
    dimension: str
    typical: str
    source: str
    exponents: tuple[float, float, float] = (0, 0, 0)
    usual: tuple[float, float] = (0.0, math.inf)
    implausible: float = math.inf
    units: tuple[str, ...] = ()
    letters: tuple[str, ...] = ()
    headers: tuple[str, ...] = ()
    zero: bool = False
    highest: float = math.inf
    follows_surface: bool = False
    derived: bool = False
    optional: bool = False
    default: float | None = None
    known: int = 9


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
        known=7,
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
        known=4,
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
        known=6,
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
        known=5,
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
        known=1,
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
        known=3,
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
        known=2,
    ),
    Input(
        name="boundary_friction",
        label="dry friction coefficient",
        symbol=r"$\mu_0$",
        dimension="number",
        typical="0.7",
        source="dry PDMS, 0.5 to 1",
        usual=(0.01, 2.0),
        implausible=3.0,
        letters=("mu0", "mu_0"),
        zero=True,
        known=0,
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
    other : tuple of str
        The same of a second body, which may be given besides, all together.
    """

    of: str
    inputs: tuple[str, ...]
    value: Callable[..., float]
    meaning: str
    hint: str = ""
    other: tuple[str, ...] = ()


def _in_series(*bodies: float) -> float:
    """Return the modulus E* of one or two bodies from Young's modulus and Poisson ratio of each."""
    return 1 / sum((1 - nu**2) / E for E, nu in zip(bodies[::2], bodies[1::2], strict=True))


ALTERNATIVES = (
    Alternative(
        "modulus",
        ("youngs_modulus", "poisson_ratio"),
        _in_series,
        "which is E*",
        "The Poisson ratio of rubber and gels is close to 0.5.",
        ("youngs_modulus_2", "poisson_ratio_2"),
    ),
    Alternative("speed", ("entrainment_speed",), lambda mean: 2 * mean, "the sum of the surface speeds, twice their mean"),
)


@dataclass(frozen=True)
class InputTable:
    """The inputs of the contacts of one geometry.

    Attributes
    ----------
    geometry : {"line", "point"}
        The geometry.
    contact : str
        Name of its contact in Python.
    rows : tuple of Input
        All inputs.
    alternatives : tuple of Alternative
        What may be given in place of some.
    """

    geometry: str
    contact: str
    rows: tuple[Input, ...]
    alternatives: tuple[Alternative, ...]

    @functools.cached_property
    def quantities(self) -> dict[str, Input]:
        """The inputs by name."""
        return {row.name: row for row in self.rows}

    @functools.cached_property
    def names(self) -> tuple[str, ...]:
        """The inputs that a contact keeps, in the order in which outputs name them."""
        return tuple(row.name for row in self.rows if not row.derived)

    @functools.cached_property
    def symbols(self) -> dict[str, str]:
        """Symbols for pictures."""
        return {row.name: row.symbol for row in self.rows if not row.derived}

    @functools.cached_property
    def exponents(self) -> dict[str, tuple[float, float, float]]:
        """Exponents with which each input enters the groups of speed, load and roughness."""
        return {row.name: row.exponents for row in self.rows if not row.derived}

    @functools.cached_property
    def choices(self) -> frozenset[str]:
        """Those that need not be given: they have a default, or others may take their place."""
        optional = {row.name for row in self.rows if row.optional}
        return frozenset(optional.union(*((other.of, *other.inputs, *other.other) for other in self.alternatives)))


OTHER_BODY = (
    Input(
        name="radius_2",
        label="radius of the other body",
        symbol="$R_2$",
        dimension="length",
        typical="50 mm",
        source="a second curved body; without it the other is flat",
        derived=True,
        optional=True,
    ),
    Input(
        name="youngs_modulus_2",
        label="Young's modulus of the other body",
        symbol="$E_2$",
        dimension="pressure",
        typical="2.0 MPa",
        source="PDMS Sylgard 184; without it the other body is rigid",
        derived=True,
        optional=True,
    ),
    Input(
        name="poisson_ratio_2",
        label="Poisson's ratio of the other body",
        symbol=r"$\nu_2$",
        dimension="number",
        typical="0.5",
        source="rubber and gels",
        zero=True,
        highest=0.5,
        derived=True,
        optional=True,
    ),
)
"""Inputs of the other body of any contact, where it is curved or soft too."""

LINE = InputTable("line", "LineContact", (*ROWS, *OTHER_BODY), ALTERNATIVES)
"""The inputs of a cylinder."""

_BALL = "as in examples/pdms_ball.toml"

_OF_A_BALL: dict[str, dict[str, Any]] = {
    "radius": {"typical": "9.5 mm", "source": _BALL, "exponents": (5 / 3, -2, -1)},
    "modulus": {"exponents": (1 / 3, -1, 0)},
    "load": {
        "dimension": "force",
        "typical": "1.3 N",
        "source": _BALL,
        "exponents": (-4 / 3, 1, 0),
        "usual": (1e-6, 1e3),
        "units": ("mN", "N"),
    },
    "speed": {"source": _BALL},
    "beta": {"exponents": (0, -3, -2)},
}
"""Rows that differ for a ball."""

POINT_ROWS = (
    *(replace(row, **_OF_A_BALL.get(row.name, {})) for row in ROWS),
    Input(
        name="slide_to_roll",
        label="slide-to-roll ratio",
        symbol="$S$",
        dimension="number",
        typical="2.0",
        source="one surface at rest; 2 (u1 - u2)/(u1 + u2) in general",
        usual=(0.01, 2.0),
        letters=("srr", "SRR", "slide_roll_ratio"),
        zero=True,
        highest=2.0,
        optional=True,
        default=2.0,
    ),
    Input(
        name="wetted_radius",
        label="radius of the wetted disc",
        symbol="$X_c$",
        dimension="length",
        typical="3 mm",
        source="where the liquid around the contact ends; without it the whole ball is immersed",
        usual=(1e-4, 1.0),
        units=("mm", "cm"),
        optional=True,
    ),
    *OTHER_BODY,
)
"""The inputs of a ball. A new one is a row here and, if a contact keeps it, a field of :class:`PointContact`."""


POINT = InputTable("point", "PointContact", POINT_ROWS, ALTERNATIVES)
"""The inputs of a ball."""

INPUT_TABLES = {"line": LINE, "point": POINT}
"""The inputs by geometry."""

QUANTITIES, INPUTS, SYMBOLS, GROUP_EXPONENTS = LINE.quantities, LINE.names, LINE.symbols, LINE.exponents
"""For a cylinder: its inputs by name, those that it keeps, symbols for pictures, exponents in the groups."""

LETTERS = {letter: row.name for table in (POINT, LINE) for row in table.rows for letter in row.letters}
"""Symbols of the article and of the field, and the inputs that they stand for."""

FORMER = {"friction_coefficient": "boundary_friction", "mu0": "boundary_friction"}
"""Former names of inputs, and their present names."""


def quantity(name: str, value: Any, table: InputTable = LINE) -> float:
    """Return one input of a contact in SI units, checked.

    Parameters
    ----------
    name : str
        One of the inputs of the table.
    value : str or float
        Text with a unit, or a bare number in SI units.
    table : InputTable
        The inputs of the geometry; those of a cylinder by default.

    Returns
    -------
    float
        The value in SI units.

    Raises
    ------
    InputError
        Where the value is impossible or its unit is wrong.
    """
    wanted = table.quantities[name]
    result = to_si(value, wanted.dimension, name)
    if wanted.highest < math.inf and not 0 <= result <= wanted.highest:
        raise InputError(f"{name} = {show(value)} must be between 0 and {wanted.highest:g}.")
    if result < 0 or (result == 0 and not wanted.zero):
        allowed = "zero or positive" if wanted.zero else "positive"
        raise InputError(f"{name} = {show(value)} must be {allowed}.")
    return result


def refuse_former(function: Callable[P, R]) -> Callable[P, R]:
    """Return the function such that an argument under one of the :data:`FORMER` names is refused with the present name."""
    answered = answers_typos(function)

    @functools.wraps(function)
    def checked(*args: P.args, **kwargs: P.kwargs) -> R:
        for old in FORMER.keys() & kwargs.keys():
            raise InputError(f"{old} = {show(kwargs[old])}: this input is called {FORMER[old]}; write {FORMER[old]} = ...")
        return answered(*args, **kwargs)

    return checked


def contact_values(given: Mapping[str, Any], table: InputTable = LINE) -> dict[str, float | None]:
    """Return the inputs that a contact keeps, in SI units, from those that were given.

    Parameters
    ----------
    given : mapping
        Inputs of :data:`ROWS` by name, text with a unit or numbers in SI units; None counts as not given if
        another may take its place.
    table : InputTable
        The inputs of the geometry.

    Returns
    -------
    dict of str to float
        A value for each input that a contact keeps; None for one that it does without.

    Raises
    ------
    InputError
        If one is unknown, missing, given twice or impossible.
    """
    values = {name: value for name, value in given.items() if value is not None or name not in table.choices}
    for name in values:
        if name not in table.quantities:
            near = difflib.get_close_matches(name, table.quantities, n=1)
            known = f"did you mean {near[0]}?" if near else f"known are {', '.join(table.quantities)}."
            raise InputError(f"{name} = {show(values[name])} is not an input of {table.contact}; {known}")
    check_alternatives(values, table)
    for other in table.alternatives:
        if other.of not in values:
            used = (*other.inputs, *(name for name in other.other if name in values))
            values[other.of] = other.value(*(quantity(name, values.pop(name), table) for name in used))
    if "radius_2" in values and "radius" in values:
        R, R_2 = (quantity(name, values.pop(name), table) for name in ("radius", "radius_2"))
        values["radius"] = 1 / (1 / R + 1 / R_2)
    found: dict[str, float | None] = {row.name: row.default for row in table.rows if row.optional and not row.derived}
    missing = [name for name in table.names if name not in values and name not in found]
    if missing:
        needed = (name for name in table.names if name not in found)
        raise InputError(f"{', '.join(missing)} missing; a contact needs {', '.join(needed)}.")
    return {name: quantity(name, values[name], table) if name in values else found[name] for name in table.names}


def signature_of(table: InputTable) -> inspect.Signature:
    """Return the signature of a contact that takes the inputs of a table, and a contact law."""
    keyword = inspect.Parameter.KEYWORD_ONLY
    default = {row.name: row.default for row in table.rows if row.name in table.choices}
    inputs = [
        inspect.Parameter(row.name, keyword, default=default.get(row.name, inspect.Parameter.empty)) for row in table.rows
    ]
    return inspect.Signature([*inputs, inspect.Parameter("law", keyword, default=None)])


def check_alternatives(given: Mapping[str, Any], table: InputTable = LINE) -> None:
    """Check that an input with alternatives is given once: by itself, or by all of those that stand for it.

    Parameters
    ----------
    given : mapping
        Inputs by name; None counts as not given.
    table : InputTable
        The inputs of the geometry.

    Raises
    ------
    InputError
        If it is given twice, in part or not at all.
    """
    for other in table.alternatives:
        values = {name: given.get(name) for name in other.inputs}
        second = {name: given[name] for name in other.other if given.get(name) is not None}
        there = [f"{name} = {show(value)}" for name, value in (values | second).items() if value is not None]
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
        if kept is None and not missing and 0 < len(second) < len(other.other):
            raise InputError(
                f"of the other body {' and '.join(second)} alone is given; give {' and '.join(other.other)}, or none."
            )
        if kept is None and missing:
            typical = f" {other.hint}" if missing == [other.inputs[-1]] else ""
            raise InputError(
                f"{missing[0]} is missing beside {there[0]}; give both, or {other.of} ({other.meaning}) alone.{typical}"
            )


def replaced(kept: Mapping[str, Any], changes: Mapping[str, Any], table: InputTable = LINE) -> dict[str, Any]:
    """Return inputs with some changed; an alternative among the changes takes the place of what it stands for."""
    found = dict(kept)
    if "radius_2" in changes and "radius" not in changes:
        raise InputError("radius_2 is given without radius; give both radii, as a contact keeps only their combination.")
    for other in table.alternatives:
        if any(name in changes for name in other.inputs):
            del found[other.of]
    return found | dict(changes)


def unit_of(name: str, table: InputTable = LINE) -> str:
    """Return the SI unit of an input in the spelling of UDUNITS, which files use."""
    return DIMENSIONS[table.quantities[name].dimension].unit.replace("*", " ") or "1"


def si_text(value: float, name: str, digits: int, table: InputTable = LINE) -> str:
    """Return an input of a contact with its unit."""
    return format_si(value, table.quantities[name].dimension, digits).replace("*", "·")
