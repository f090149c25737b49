"""The table of facts: what is known about a contact and used by no equation, only to check whether the model applies.

The table ``[check]`` of case files and :func:`stribeck.check` read it: one row is one fact everywhere.
"""

from __future__ import annotations

import difflib
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from stribeck.quantities.units import InputError, show, to_si

__all__ = ["FACTS", "ROWS", "Fact", "fact_values"]


@dataclass(frozen=True)
class Fact:
    """One fact that checks ask for."""

    name: str  # Name in Python and in the table `[check]`
    label: str  # Name in sentences
    dimension: str  # A key of :data:`stribeck.quantities.units.DIMENSIONS`
    typical: str  # A value, and of what it is
    source: str  # A value, and of what it is
    models: tuple[str, ...] = ()  # Where a contact may hold it already, such as `"solid.layer_thickness"`


# The facts. A new one is a row here, and is used by a row of :data:`stribeck.checks.table.ROWS`.
ROWS = (
    Fact(
        "pressure_viscosity",
        "pressure-viscosity coefficient",
        "compliance",
        "20 1/GPa",
        "mineral oil 15 to 25, water below 1",
        ("fluid.viscosity.pressure_coefficient",),
    ),
    Fact("layer_thickness", "thickness of the soft layer", "length", "2 mm", "rubber of a seal", ("solid.layer_thickness",)),
    Fact("loss_tangent", "loss tangent at the frequency U/a", "number", "0.1", "filled rubber", ("solid.loss_tangent",)),
    Fact("supply_film", "film that arrives at the inlet", "length", "10 um", "a wiped rod"),
    Fact("thinning_rate", "shear rate at which the fluid begins to thin", "rate", "1e6 1/s", "multigrade oil"),
    Fact("molecular_size", "size of the fluid's molecules", "length", "1 nm", "oil; water 0.3 nm, polymer coils 10 to 100 nm"),
    Fact("thermal_conductivity", "thermal conductivity of the fluid", "conductivity", "0.15 W/m/K", "oil; water 0.6"),
    Fact("thermal_thinning", "relative change of viscosity per kelvin", "per kelvin", "0.04 1/K", "oil; water 0.02"),
    Fact("density", "density of the fluid", "density", "870 kg/m^3", "oil; water 1000"),
    Fact(
        "work_of_adhesion",
        "work of adhesion in the liquid",
        "surface energy",
        "5 mJ/m^2",
        "gels 0.1 to 10; dry rubber 50",
    ),
    Fact("diffusivity", "poroelastic diffusivity of the soft body", "diffusivity", "1e-9 m^2/s", "gels 1e-10 to 1e-8"),
    Fact("permeability", "permeability of the soft body", "permeability", "1e-18 m^2", "cartilage; gels 1e-18 to 1e-15"),
    Fact("rms_slope", "rms slope of the roughness", "number", "0.1", "polished 0.01 to 0.1, ground or blasted 0.1 to 0.5"),
)

FACTS = {row.name: row for row in ROWS}  # The facts by name


def fact_values(given: Mapping[str, Any]) -> dict[str, float]:
    """Return facts in SI units."""
    found = {}
    for name, value in given.items():
        if value is None:
            continue
        if name not in FACTS:
            near = difflib.get_close_matches(name, FACTS, n=1)
            hint = f"did you mean {near[0]}?" if near else f"known are {', '.join(FACTS)}."
            raise InputError(f"{name} = {show(value)} is not a fact that the checks use; {hint}")
        number = to_si(value, FACTS[name].dimension, name, FACTS[name].typical)
        if not 0 <= number < math.inf:
            raise InputError(f"{name} = {show(value)} must be zero or positive.")
        found[name] = number
    if "diffusivity" in found and "permeability" in found:
        raise InputError("diffusivity follows from permeability, D = k E*/eta; give one of them.")
    return found
