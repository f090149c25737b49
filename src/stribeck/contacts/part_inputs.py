"""The laws that the parts of a contact may be, by kind, and the numbers that these declare.

Nothing is listed here but the kinds: laws are found in the package of their kind and among entry points, see
:mod:`stribeck.quantities.registry`, and their numbers in the laws.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields, is_dataclass, replace
from typing import Any, NamedTuple

from stribeck.contacts.inputs import InputTable
from stribeck.contacts.parts import Parts
from stribeck.fluids.laws import DensityLaw, FlowFactors, RateLaw, ViscosityLaw
from stribeck.quantities.registry import laws_of
from stribeck.quantities.schema import Input, numbers_of
from stribeck.quantities.units import InputError, show
from stribeck.solids.solid import Solid

__all__ = [
    "KINDS",
    "LAW_NUMBERS",
    "PART_INPUTS",
    "PART_LETTERS",
    "Kind",
    "all_input_rows",
    "part_names",
    "part_value",
    "with_part_value",
]


class Kind(NamedTuple):
    """A kind of law that is a part of a contact, or of its fluid."""

    table: str  # Table of a case file
    key: str  # Key in this table that names the law
    label: str  # What is chosen
    nothing: str  # Name of what does nothing
    package: str  # Where the laws are
    base: type  # Class of which the laws are

    @property
    def laws(self) -> dict[str, Any]:
        """The laws by name; None for the one that does nothing."""
        return {self.nothing: None, **laws_of(self.package, self.base)}


# Name of the argument of the fluid, or of the contact -> its kind.
KINDS = {
    "rheology": Kind("fluid", "model", "Fluid", "newtonian", "stribeck.fluids.rheology", RateLaw),
    "viscosity": Kind(
        "fluid", "viscosity_law", "Viscosity under pressure", "constant", "stribeck.fluids.rheology", ViscosityLaw
    ),
    "density": Kind("fluid", "density", "Density", "incompressible", "stribeck.fluids.rheology", DensityLaw),
    "flow_factors": Kind("flow_factors", "model", "Flow factors", "none", "stribeck.fluids", FlowFactors),
    "solid": Kind("solid", "model", "Soft body", "half-space", "stribeck.solids", Solid),
}


def _numbers() -> Iterator[Input]:
    """Yield the numbers of laws, each with the table and the laws that have it, and those of motion."""
    for kind in KINDS.values():
        found: dict[str, tuple[Input, list[str]]] = {}
        for name, law in kind.laws.items():
            for row in numbers_of(law).values():
                found.setdefault(row.name, (row, []))[1].append(name)
        for row, names in found.values():
            *most, last = map(repr, names)
            of = f"[{kind.table}] with {kind.key} = {' or '.join(filter(None, [', '.join(most), last]))}"
            yield replace(row, table=kind.table, of=of)
    yield from numbers_of(Parts).values()


LAW_NUMBERS = {row.name: row for row in _numbers()}  # All numbers of laws and of motion by name

PART_INPUTS = {name: row for name, row in LAW_NUMBERS.items() if row.table and row.is_free}  # Those that a fit may free

PART_LETTERS = {letter: row.name for row in PART_INPUTS.values() for letter in row.letters}  # Other names of numbers of laws


def all_input_rows(table: InputTable) -> dict[str, Input]:
    """Return all inputs of a geometry by name, numbers of laws among them."""
    return {**table.quantities, **PART_INPUTS}


def part_names(contact: Any) -> tuple[str, ...]:
    """Return the names of the numbers of laws that a contact has and that are not zero."""
    return tuple(name for name in PART_INPUTS if getattr(contact, name, None))


def part_value(parts: Any, name: str) -> float | None:
    """Return a number of the parts of a contact in SI units; None where they have none of this name."""
    if not is_dataclass(parts):
        return None
    if name in numbers_of(type(parts)):
        return float(getattr(parts, name))
    return next((value for each in fields(parts) if (value := part_value(getattr(parts, each.name), name)) is not None), None)


def with_part_value(parts: Any, name: str, value: str | float) -> Any:
    """Return the parts with another number of one of their laws."""
    if part_value(parts, name) is None:
        of = PART_INPUTS[name].of
        raise InputError(f"{name} = {show(value)}, but this contact has none: it belongs to {of}; give it to the contact.")
    return _replace_number(parts, name, value)


def _replace_number(part: Any, name: str, value: str | float) -> Any:
    """Return a frozen dataclass with another number of its own, or of one of its fields."""
    if name in numbers_of(type(part)):
        return replace(part, **{name: value})
    inner = next(each.name for each in fields(part) if part_value(getattr(part, each.name), name) is not None)
    return replace(part, **{inner: _replace_number(getattr(part, inner), name, value)})
