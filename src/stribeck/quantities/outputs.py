"""The table of observables: name, label, meaning, scale and kind of error of each number that a solved state has.

Results, files, sweeps, reports and the explorer read it: one row is one observable everywhere.  How it is computed stands in
:mod:`stribeck.equations.observables`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

__all__ = ["AREA", "FILMS", "GROUPS", "HERTZ", "OBSERVABLES", "ROWS", "Observable"]

GROUPS = ("speed", "load", "roughness")

Scale = Literal["number", "gap", "width", "friction"]

IN_UNITS = {"number": "", "gap": ", in Hertz indentations", "width": ", in Hertz half-widths", "friction": ", for beta = 1"}


@dataclass(frozen=True)
class Observable:
    """One number that a solved state has.

    Attributes
    ----------
    name : str
        Its name, in Python, files, sweeps and JSON.
    label : str
        What reports call it.
    meaning : str
        What it is, in a file.
    scale : {"number", "gap", "width", "friction"}
        What returns it to SI: nothing, the Hertz indentation, the Hertz half-width, or beta.
    film : str
        Its name in SI units; empty if files hold it in Hertz units alone.
    error : {"relative", "absolute", ""}
        What the estimated error of a state is for it; nothing if it has none, or one of its own.
    listed : bool
        Whether files and reports show it; the two viscous frictions enter friction.
    """

    name: str
    label: str
    meaning: str
    scale: Scale = "number"
    film: str = ""
    error: Literal["relative", "absolute", ""] = "relative"
    listed: bool = True


ROWS = (
    Observable("contact_load_share", "load on asperities", "fraction of the load that asperities carry", error="absolute"),
    Observable("fluid_load_share", "load on the fluid", "fraction of the load that the fluid carries", error="absolute"),
    Observable("central_gap", "central film", "gap at the centre", "gap", "central_film_thickness"),
    Observable("minimum_gap", "minimum film", "minimum gap", "gap", "minimum_film_thickness"),
    Observable(
        "minimum_position", "position of minimum film", "position of the minimum gap", "width", "minimum_film_position", ""
    ),
    Observable(
        "minimum_position_error",
        "error of that position",
        "estimated absolute error of the position of the minimum gap",
        "width",
        "minimum_film_position_error",
        "",
    ),
    Observable("flux_gap", "flux film h*", "film thickness at the pressure extremum, h*", "gap", "flux_film_thickness"),
    Observable("offset", "offset z0", "height of the undeformed cylinder over the undeformed surface", "gap"),
    Observable(
        "lambda_ratio",
        "Lambda (minimum film over h_rms)",
        "minimum gap over h_rms; over h_rms/alpha if alpha is unknown",
        error="",
    ),
    Observable("viscous_published", "viscous friction, published", "viscous friction as published", "friction", listed=False),
    Observable("viscous_balanced", "viscous friction, balanced", "viscous friction, balanced", "friction", listed=False),
    Observable(
        "error_estimate",
        "estimated error",
        "largest estimated relative error of the observables; load shares count absolutely",
        error="",
    ),
)
"""The observables of a state. A new one is a row here and its value in :mod:`stribeck.equations.observables`."""

NAMES = tuple(row.name for row in ROWS if row.error)
"""Those with an estimated error, in the order of every array of them."""

ABSOLUTE = tuple(row.name for row in ROWS if row.error == "absolute")
"""Those whose estimated error is absolute."""

OBSERVABLES = {row.name: ("1", row.meaning + IN_UNITS[row.scale]) for row in ROWS if row.listed}
"""Attributes of a solution that a dataset holds: unit and meaning of each."""

HERTZ = {
    "hertz_half_width": ("m", "half-width a of the dry smooth contact"),
    "hertz_indentation": ("m", "indentation u_Hz of the dry smooth contact"),
    "hertz_pressure": ("Pa", "largest pressure p_Hz of the dry smooth contact"),
}
"""Scales of a contact in SI units."""

FILMS = {row.film: ("m", row.meaning) for row in ROWS if row.film} | HERTZ
"""What a file of a contact holds in SI units besides: unit and meaning of each."""

AREA = {
    "central_area_fraction": ("1", "real over apparent contact area at the centre"),
    "central_area_fraction_error": ("1", "estimated absolute error of central_area_fraction"),
}
"""What a solution has besides if the contact law knows the spectrum of the surface."""
