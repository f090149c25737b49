"""The table of facts: what is known about a contact and used by no equation, only to check whether the model applies.

The table ``[check]`` of case files and :func:`stribeck.check` read it: one row is one fact everywhere.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from stribeck.contacts.geometries import LINE
from stribeck.contacts.parts import LAW_NUMBERS
from stribeck.quantities.keywords import known_names
from stribeck.quantities.schema import Input
from stribeck.quantities.units import InputError, show


@dataclass(frozen=True, kw_only=True)
class Fact(Input):
    """One fact that checks ask for and that is no number of a law."""

    zero: bool = True


# The facts that are numbers of nothing else. A new one is a row here, used by a row of :data:`stribeck.checks.table.ROWS`.
ROWS = (
    Fact(
        name="loss_tangent",
        label="loss tangent at the frequency U/a",
        dimension="number",
        typical="0.1",
        source="filled rubber",
    ),
    Fact(
        name="supply_film",
        label="film that arrives at the inlet",
        dimension="length",
        typical="10 um",
        source="a wiped rod",
    ),
    Fact(
        name="thinning_rate",
        label="shear rate at which the fluid begins to thin",
        dimension="rate",
        typical="1e6 1/s",
        source="multigrade oil",
    ),
    Fact(
        name="molecular_size",
        label="size of the fluid's molecules",
        dimension="length",
        typical="1 nm",
        source="oil; water 0.3 nm, polymer coils 10 to 100 nm",
    ),
    Fact(
        name="thermal_conductivity",
        label="thermal conductivity of the fluid",
        dimension="conductivity",
        typical="0.15 W/m/K",
        source="oil; water 0.6",
    ),
    Fact(
        name="thermal_thinning",
        label="relative change of viscosity per kelvin",
        dimension="per kelvin",
        typical="0.04 1/K",
        source="oil; water 0.02",
    ),
    Fact(
        name="work_of_adhesion",
        label="work of adhesion in the liquid",
        dimension="surface energy",
        typical="5 mJ/m^2",
        source="gels 0.1 to 10; dry rubber 50",
    ),
    Fact(
        name="diffusivity",
        label="poroelastic diffusivity of the soft body",
        dimension="diffusivity",
        typical="1e-9 m^2/s",
        source="gels 1e-10 to 1e-8",
    ),
    Fact(
        name="permeability",
        label="permeability of the soft body",
        dimension="permeability",
        typical="1e-18 m^2",
        source="cartilage; gels 1e-18 to 1e-15",
    ),
    Fact(
        name="rms_slope",
        label="rms slope of the roughness",
        dimension="number",
        typical="0.1",
        source="polished 0.01 to 0.1, ground or blasted 0.1 to 0.5",
    ),
)

# The facts by name, those first that a law of the contact may hold already, or a data sheet.
FACTS = {
    **{name: LAW_NUMBERS[name] for name in ("pressure_coefficient", "layer_thickness")},
    **{row.name: row for row in (*ROWS, LINE.quantities["density"])},
}


def fact_values(given: Mapping[str, Any]) -> dict[str, float]:
    """Return facts in SI units."""
    found = {}
    for name, value in given.items():
        if value is None:
            continue
        if name not in FACTS:
            raise InputError(f"{name} = {show(value)} is not a fact that the checks use; {known_names(name, FACTS)}")
        found[name] = FACTS[name].checked(value)
    if "diffusivity" in found and "permeability" in found:
        raise InputError("diffusivity follows from permeability, D = k E*/eta; give one of them.")
    return found
