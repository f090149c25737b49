"""What helps where a check is not fine: what this package has for it, or a public tool for what the model leaves out."""

from __future__ import annotations

from dataclasses import dataclass, replace

from stribeck.checks.check import Check
from stribeck.contacts.groups import Geometry

__all__ = ["INSTEAD", "with_what_helps"]


@dataclass(frozen=True)
class Instead:
    """What helps against one check."""

    sentence: str
    here: bool = False  # Whether this package solves it, so that a doubtful check says so too
    geometry: Geometry | None = None  # The geometry for which it helps; None for both


FINITE_ELEMENTS = Instead("FEBio (finite elements) solves contact at large strain, without a film.")

# By the name of a check in :data:`stribeck.checks.table.ROWS`. A check that says by itself what to do has no row.
INSTEAD = {
    "Hertz pressure": (
        Instead(
            "Up to five times the limit a law of pressure in [fluid] (Barus, Roelands) solves it; beyond, slippy computes "
            "such films of hard bodies."
        ),
    ),
    "stiffness": (
        Instead(
            "Tamaas solves dry contact of rough bodies that yield; slippy adds a film whose viscosity grows with pressure."
        ),
    ),
    "contact width": (FINITE_ELEMENTS,),
    "shape": (FINITE_ELEMENTS,),
    "adhesion": (
        Instead("Tamaas and Adhesion (of ContactEngineering) solve adhesive contact of rough bodies, without a film."),
    ),
    "pores": (Instead("FEBio solves the contact of porous bodies with the liquid in them (biphasic materials)."),),
    "layer": (Instead("Give layer_thickness in [solid]: the layer is then solved.", here=True),),
    "loss tangent": (
        Instead("Give E' and E'' over the frequency as [solid] master_curve: it is then solved.", here=True, geometry="line"),
        Instead("FEBio (finite elements) solves contact of viscoelastic bodies, without a film.", geometry="point"),
    ),
    "rms slope": (
        Instead("FEBio (finite elements) follows single steep asperities; OpenFOAM solves the flow in the gap between them."),
    ),
    "stroke": (
        Instead("stribeck stroke solves the film over the stroke.", here=True, geometry="line"),
        Instead("GaPFlow solves films between smooth elastic bodies in time.", geometry="point"),
    ),
    "viscous heating": (Instead("OpenFOAM solves flow and temperature together in a given gap."),),
    "supply": (Instead("OpenFOAM (interFoam) solves the surface of the liquid in front of the contact, in a given gap."),),
    "film against molecules": (Instead("LAMMPS moves the molecules; GaPFlow puts its results into films."),),
    "inertia": (
        Instead("GaPFlow keeps inertia in flow averaged over the gap; OpenFOAM solves all of the flow, turbulence too."),
    ),
}


def with_what_helps(check: Check, row: str, geometry: Geometry) -> Check:
    """Return the check of a row, whose sentence ends with what helps if it is outside, or doubtful and solved here."""
    said = [
        each.sentence
        for each in INSTEAD.get(row, ())
        if each.geometry in (None, geometry) and (check.verdict == "outside" or each.here and check.verdict == "doubtful")
    ]
    return replace(check, sentence=" ".join([check.sentence, *said]))
