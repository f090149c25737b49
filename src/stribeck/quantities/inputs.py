"""The tables of inputs of a cylinder and of a ball, and the value of each input in SI units, checked.

The table of a cylinder is the one that the names of this module are about; that of a ball has the same rows but for what
differs.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from stribeck.quantities.formats import format_si
from stribeck.quantities.input_rows import OTHER_BODY, POINT_ROWS, ROWS
from stribeck.quantities.lazy import cached_property
from stribeck.quantities.schema import Input
from stribeck.quantities.units import DIMENSIONS

__all__ = [
    "ALTERNATIVES",
    "INPUT_TABLES",
    "LETTERS",
    "Alternative",
    "InputTable",
    "quantity",
    "si_text",
    "unit_of",
]


@dataclass(frozen=True)
class Alternative:
    """Inputs that may be given in place of another."""

    of: str  # The input that a contact keeps
    inputs: tuple[str, ...]  # Inputs that may be given instead, all together
    value: Callable[..., float]  # Value of the kept input from those given, in SI units
    meaning: str  # Meaning of the kept input, for sentences
    hint: str = ""  # Advice if one of several inputs is missing
    other: tuple[str, ...] = ()  # Inputs of a second body, which may be given besides, all together


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
    """The inputs of the contacts of one geometry."""

    geometry: str  # The geometry
    contact: str  # Name of its contact in Python
    rows: tuple[Input, ...]  # All inputs
    alternatives: tuple[Alternative, ...]  # Inputs that may be given in place of some rows

    @cached_property
    def quantities(self) -> dict[str, Input]:
        """The inputs by name."""
        return {row.name: row for row in self.rows}

    @cached_property
    def names(self) -> tuple[str, ...]:
        """The inputs that a contact keeps, in the order in which outputs name them."""
        return tuple(row.name for row in self.rows if not row.derived)

    @cached_property
    def symbols(self) -> dict[str, str]:
        """Symbols for pictures."""
        return {row.name: row.symbol for row in self.rows if not row.derived}

    @cached_property
    def exponents(self) -> dict[str, tuple[float, float, float]]:
        """Exponents with which each input enters the groups of speed, load and roughness."""
        return {row.name: row.exponents for row in self.rows if not row.derived}

    @cached_property
    def choices(self) -> frozenset[str]:
        """Inputs with a default or an alternative, which need not be given."""
        optional = {row.name for row in self.rows if row.optional}
        return frozenset(optional.union(*((other.of, *other.inputs, *other.other) for other in self.alternatives)))


LINE = InputTable("line", "LineContact", (*ROWS, *OTHER_BODY), ALTERNATIVES)  # The inputs of a cylinder

POINT = InputTable("point", "PointContact", POINT_ROWS, ALTERNATIVES)  # The inputs of a ball

INPUT_TABLES = {"line": LINE, "point": POINT}  # The inputs by geometry

# Symbols of the article and of the field, and the inputs that they stand for.
LETTERS = {letter: row.name for table in (POINT, LINE) for row in table.rows for letter in row.letters}


def quantity(name: str, value: Any, table: InputTable = LINE) -> float:
    """Return one input of a contact in SI units, checked."""
    return table.quantities[name].checked(value)


def unit_of(name: str, table: InputTable = LINE) -> str:
    """Return the SI unit of an input in the spelling of UDUNITS, which files use."""
    return DIMENSIONS[table.quantities[name].dimension].unit.replace("*", " ") or "1"


def si_text(value: float, name: str, digits: int, table: InputTable = LINE) -> str:
    """Return an input of a contact with its unit."""
    return format_si(value, table.quantities[name].dimension, digits).replace("*", "·")
