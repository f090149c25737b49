"""Numbers of the fluid and of the solid that a contact may have: one row is one of them in Python, case files and fits.

They belong to a law of the contact's parts, which a row finds by its path: ``("fluid", "rheology", "relaxation_time")`` is the
attribute of that name of the law of shear of the fluid.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

from stribeck.quantities.input_rows import Input
from stribeck.quantities.inputs import InputTable
from stribeck.quantities.units import InputError, show, to_si

__all__ = ["PART_INPUTS", "PART_LETTERS", "PartInput", "all_input_rows", "part_names", "part_value", "with_part_value"]


@dataclass(frozen=True, kw_only=True)
class PartInput(Input):
    """A number of a law, see :class:`stribeck.quantities.input_rows.Input`."""

    path: tuple[str, ...]  # Attributes that lead from the parts of a contact to the number
    table: str  # Where a case file has it
    key: str  # Where a case file has it
    range: tuple[float, float] = (0.0, float("inf"))  # Bounds of a fit
    of: str  # Laws that have such a number, for sentences


_ROWS = (
    PartInput(
        name="relaxation_time",
        label="relaxation time",
        symbol="$t$",
        dimension="time",
        typical="1 ms",
        source="one over the rate at which the fluid begins to thin",
        path=("fluid", "rheology", "relaxation_time"),
        table="fluid",
        key="relaxation_time",
        of="a fluid that thins (carreau, cross, power-law)",
    ),
    PartInput(
        name="exponent",
        label="exponent of shear thinning",
        symbol="$n$",
        dimension="number",
        typical="0.5",
        source="polymer solutions, 0.3 to 0.8",
        path=("fluid", "rheology", "exponent"),
        table="fluid",
        key="exponent",
        range=(0.05, 1.0),
        of="a fluid that thins (carreau, cross, power-law)",
    ),
    PartInput(
        name="infinite_viscosity",
        label="viscosity at high rates",
        symbol=r"$\eta_\infty$",
        dimension="viscosity",
        typical="1 mPa*s",
        source="the solvent of a polymer solution",
        path=("fluid", "rheology", "infinite_viscosity"),
        table="fluid",
        key="infinite_viscosity",
        of="a fluid that thins to a second plateau (carreau, cross)",
    ),
    PartInput(
        name="eyring_stress",
        label="Eyring's stress",
        symbol=r"$\tau_0$",
        dimension="pressure",
        typical="5 MPa",
        source="oils",
        letters=("stress",),
        path=("fluid", "rheology", "eyring_stress"),
        table="fluid",
        key="stress",
        of="an Eyring fluid",
    ),
    PartInput(
        name="pressure_coefficient",
        label="pressure coefficient of the viscosity",
        symbol=r"$\alpha_p$",
        dimension="pressure coefficient",
        typical="15 1/GPa",
        source="mineral oils, 10 to 30 1/GPa",
        letters=("pressure_viscosity", "alpha_p"),
        path=("fluid", "viscosity", "pressure_coefficient"),
        table="fluid",
        key="pressure_viscosity",
        of="a fluid that stiffens under pressure (barus, roelands)",
    ),
    PartInput(
        name="layer_thickness",
        label="thickness of the layer",
        symbol="$d$",
        dimension="length",
        typical="2 mm",
        source="a pad of rubber",
        letters=("thickness",),
        path=("solid", "thickness"),
        table="solid",
        key="layer_thickness",
        of="a layer on a rigid base",
    ),
    PartInput(
        name="retardation_time",
        label="retardation time of the body",
        symbol=r"$\tau$",
        dimension="time",
        typical="10 ms",
        source="creep of the rubber under a constant load",
        path=("solid", "time"),
        table="solid",
        key="retardation_time",
        of="a standard linear solid",
    ),
    PartInput(
        name="modulus_ratio",
        label="glassy over relaxed modulus of the body",
        symbol="$r$",
        dimension="number",
        typical="3",
        source="storage moduli at high and low frequencies",
        path=("solid", "ratio"),
        table="solid",
        key="modulus_ratio",
        range=(1.0, float("inf")),
        of="a standard linear solid",
    ),
)

# Numbers of laws that a fit may free, by name, from what it is mostly after to what is mostly known.
PART_INPUTS = {row.name: row for row in _ROWS}

PART_LETTERS = {letter: row.name for row in _ROWS for letter in row.letters}  # Other names of numbers of laws


def all_input_rows(table: InputTable) -> dict[str, Input]:
    """Return all inputs of a geometry by name, numbers of laws among them."""
    return {**table.quantities, **PART_INPUTS}


def part_names(contact: Any) -> tuple[str, ...]:
    """Return the names of the numbers of laws that a contact has and that are not zero."""
    return tuple(name for name in PART_INPUTS if getattr(contact, name, None))


def part_value(parts: Any, name: str) -> float | None:
    """Return a number of the parts of a contact in SI units; None where they have none of this name."""
    found = parts
    for step in PART_INPUTS[name].path:
        found = getattr(found, step, None)
    return None if found is None else float(found)


def with_part_value(parts: Any, name: str, value: str | float) -> Any:
    """Return the parts with another number of one of their laws."""
    row = PART_INPUTS[name]
    if part_value(parts, name) is None:
        raise InputError(f"{name} = {show(value)}, but this contact has none: it belongs to {row.of}; give it to the contact.")
    return _replace_at_path(parts, row.path, to_si(value, row.dimension, name, row.typical))


def _replace_at_path(thing: Any, path: tuple[str, ...], value: float) -> Any:
    """Return a frozen dataclass with another value at the end of a path of attributes."""
    first, *rest = path
    new = _replace_at_path(getattr(thing, first), tuple(rest), value) if rest else value
    # The arguments are the fields in their order, whatever they are called.
    return type(thing)(*(new if each.name == first else getattr(thing, each.name) for each in fields(thing)))
