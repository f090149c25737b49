"""The inputs of contacts, a row each.

Contacts, case files, the command line, sweeps, fits, pictures and the explorer read them: one row is one input everywhere.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from stribeck.quantities.schema import Input

__all__ = ["OTHER_BODY", "POINT_ROWS", "ROWS"]


_PDMS = "as in examples/pdms_cylinder.toml"

# The inputs of a line contact. A new one is a row here and, if a contact keeps it, a field of :class:`LineContact`.
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
        usual=(1e4, 3e8),
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
        usual=(3e-4, 10.0),
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
        usual=(1e-7, 10.0),
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
        usual=(1.0, 4.0),
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


# Inputs of the other body of any contact, where it is curved or soft too.
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

_BALL = "as in examples/pdms_ball.toml"

# Rows that differ for a ball.
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

# The inputs of a ball. A new one is a row here and, if a contact keeps it, a field of :class:`PointContact`.
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
