"""The table ``[check]`` of facts that no equation uses, only :func:`stribeck.check`: one row is one fact everywhere."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from stribeck.contacts.geometries import LINE
from stribeck.contacts.parts import LAW_NUMBERS
from stribeck.quantities.keywords import known_names
from stribeck.quantities.schema import Input
from stribeck.quantities.units import InputError, show

# The facts that are numbers of nothing else: name, label, dimension, a typical value, and where that is from. A new one is a
# row here, used by a row of :data:`stribeck.checks.table.ROWS`.
ROWS = (
    ("loss_tangent", "loss tangent at the frequency U/a", "number", "0.1", "filled rubber"),
    ("supply_film", "film that arrives at the inlet", "length", "10 um", "a wiped rod"),
    ("stroke", "length of the stroke, from stop to stop", "length", "50 mm", "a seal or a tribometer that moves to and fro"),
    ("thinning_rate", "shear rate at which the fluid begins to thin", "rate", "1e6 1/s", "multigrade oil"),
    ("molecular_size", "size of the fluid's molecules", "length", "1 nm", "oil; water 0.3 nm, polymer coils 10 to 100 nm"),
    ("thermal_conductivity", "thermal conductivity of the fluid", "conductivity", "0.15 W/m/K", "oil; water 0.6"),
    ("thermal_thinning", "relative change of viscosity per kelvin", "per kelvin", "0.04 1/K", "oil; water 0.02"),
    ("work_of_adhesion", "work of adhesion in the liquid", "surface energy", "5 mJ/m^2", "gels 0.1 to 10; dry rubber 50"),
    ("diffusivity", "poroelastic diffusivity of the soft body", "diffusivity", "1e-9 m^2/s", "gels 1e-10 to 1e-8"),
    ("permeability", "permeability of the soft body", "permeability", "1e-18 m^2", "cartilage; gels 1e-18 to 1e-15"),
    ("rms_slope", "rms slope of the roughness", "number", "0.1", "polished 0.01 to 0.1, ground or blasted 0.1 to 0.5"),
)

# The facts by name, those first that a law of the contact may hold already, or a data sheet.
FACTS = {
    **{name: LAW_NUMBERS[name] for name in ("pressure_coefficient", "layer_thickness")},
    **{
        name: Input(name=name, label=label, dimension=dimension, typical=typical, source=source, zero=True)
        for name, label, dimension, typical, source in ROWS
    },
    "density": LINE.quantities["density"],
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
