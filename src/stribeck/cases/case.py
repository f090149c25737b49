"""A case: one contact with what is asked of it, in SI units."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np

from stribeck.cases.fit_settings import FitSettings
from stribeck.cases.law import Law
from stribeck.cases.tables import AS_GIVEN, Key, Keys, one_of, rising_pair, whole
from stribeck.contacts.contact import Contact
from stribeck.contacts.friction import Definition
from stribeck.contacts.geometries import LINE
from stribeck.contacts.inputs import InputTable
from stribeck.contacts.parts import LAW_NUMBERS
from stribeck.motions.motion import Motion
from stribeck.quantities.docstrings import Described
from stribeck.quantities.keywords import known_names
from stribeck.quantities.registry import laws_of
from stribeck.quantities.schema import Input, arguments_of, made_of
from stribeck.quantities.standard_errors import StandardErrors
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


MOTIONS = laws_of("stribeck.motions", Motion)  # Those that a case may name

# Keys beside those of the motion; that both go together is seen when the stroke is solved.
SOLVING: Keys = {
    "cycles": Key(whole(1, 100_000)),
    "steps": Key(whole(1, 100_000)),
    "inlet": Key(one_of("flooded", "own-wake")),
}

KEYS: Keys = {
    "motion": AS_GIVEN,
    **{key: AS_GIVEN for motion in MOTIONS.values() for key in arguments_of(motion)},
    **SOLVING,
}


@dataclass(frozen=True)
class StrokeSettings:
    """The ``[stroke]`` table of a case."""

    motion: Motion  # Sliding speed over time
    cycles: int | None = None  # Times that it is done; None is the default of :func:`stribeck.stroke`
    steps: int | None = None  # Steps of a cycle; None is the default of :func:`stribeck.stroke`
    inlet: str | None = None  # What is before the contact; None is the default of :func:`stribeck.stroke`

    @property
    def arguments(self) -> dict[str, Any]:
        """What :func:`stribeck.stroke` is given."""
        return {name: value for name, value in vars(self).items() if value is not None}

    @property
    def facts(self) -> dict[str, float]:
        """What checks know of it, in SI units: the length from end to end."""
        return {"stroke": float(np.ptp(self.motion.position(self.motion.times(self.steps or 400))))}


def stroke_settings(table: dict[str, Any]) -> StrokeSettings:
    """Return the settings of a table that was read."""
    if "motion" not in table:
        raise InputError(f"motion is missing; add motion = {' or '.join(map(json.dumps, MOTIONS))}.")
    name = one_of(*MOTIONS)("motion", table["motion"])
    solving = {key: value for key, value in table.items() if key in SOLVING}
    given = {key: value for key, value in table.items() if key not in (*SOLVING, "motion")}
    return StrokeSettings(made_of(MOTIONS[name], f"motion = {name!r}", given), **solving)


Axis = Literal["speed", "load", "roughness"]


# By geometry: a state of a ball takes a tenth of a second or more.
DEFAULT_POINTS_AND_RTOL: dict[str, tuple[int, float]] = {"line": (101, 1e-6), "point": (31, 1e-4)}


@dataclass(frozen=True)
class CurveSettings:
    """The ``[curve]`` table of a case."""

    over: Axis = "speed"  # Quantity that varies along the curve
    range: tuple[float, float] | None = None  # Its lowest and highest value in SI units; None is the automatic range
    points: int = 101  # States on the curve


@dataclass(frozen=True)
class Case(Described):
    """One case file, checked, with its quantities in SI units."""

    path: Annotated[Path, "the file"]
    contact: Annotated[Contact, "the quantities of the ``[contact]`` table"]
    law: Annotated[
        Law,
        "name of the contact law of the ``[contact]`` table; the law itself is ``contact.law``",
    ] = "exponential"
    curve: Annotated[CurveSettings, "the ``[curve]`` table"] = field(default_factory=CurveSettings)
    stroke: Annotated[StrokeSettings | None, "the ``[stroke]`` table, None without one"] = None
    rtol: Annotated[float, "relative tolerance asked of the solver, from the ``[solver]`` table"] = 1e-6
    definition: Annotated[Definition, "which friction force the outputs show, from the ``[solver]`` table"] = "balanced"
    title: Annotated[str, "headline for outputs; empty if the file has none"] = ""
    notes: Annotated[str, "free text; empty if the file has none"] = ""
    fit: Annotated[FitSettings, "the ``[fit]`` table, for :func:`stribeck.fit`"] = field(default_factory=FitSettings)
    bench: Annotated[
        FitSettings, "the ``[fit]`` table with what the ``[bench]`` table has in its place, for :func:`stribeck.bench.read`"
    ] = field(default_factory=FitSettings)
    facts: Annotated[
        dict[str, float],
        "the ``[check]`` table, for :func:`stribeck.check`, in SI units",
    ] = field(default_factory=dict)
    errors: Annotated[
        StandardErrors,
        "relative standard errors of the inputs that have one, numbers of the fluid and the solid among them",
    ] = field(default_factory=StandardErrors)
    conversions: Annotated[tuple[str, ...], "conversions of data-sheet inputs, one sentence each"] = ()
    tables: Annotated[
        dict[str, Any],
        "all tables and keys of the file as written",
    ] = field(default_factory=dict, repr=False, compare=False)


def curve_range(value: Any, over: str, inputs: InputTable = LINE) -> tuple[float, float]:
    """Return the ends of a curve in SI units."""

    def end(value: Any) -> float:
        try:
            found = inputs.quantities[over].checked(value)
        except InputError as problem:
            raise InputError(f"in range, {problem}") from None
        if found == 0:
            raise InputError(f"in range, {over} = {show(value)} must be positive, because the curve is logarithmic.")
        return found

    return rising_pair("range", value, end, over)
