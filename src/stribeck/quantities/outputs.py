"""The tables of observables: name, label, meaning, scale and kind of error of each number that a solved state has.

Results, files, sweeps, reports and the explorer read them.  The names of this module are about the line.
"""

from dataclasses import dataclass
from typing import Literal

from stribeck.quantities.lazy import cached_property

GROUPS = ("speed", "load", "roughness")

Scale = Literal["number", "gap", "width", "pressure", "friction"]

UNIT_SUFFIXES = {
    "number": "",
    "gap": ", in Hertz indentations",
    "width": ", in Hertz half-widths",
    "pressure": ", in Hertz pressures",
    "friction": ", for beta = 1",
}


@dataclass(frozen=True)
class Observable:
    """One number that a solved state has."""

    name: str  # Name in Python, files, sweeps and JSON
    label: str  # Name in reports
    meaning: str  # Meaning, for files
    scale: Scale = "number"  # Unit of the number: none, the Hertz indentation, half-width or pressure, or beta
    film: str = ""  # Name in SI units; empty if files hold Hertz units alone
    error: Literal["relative", "absolute", ""] = "relative"
    listed: bool = True  # Whether files and reports show it; the two viscous frictions enter friction


# The observables of a state. A new one is a row here and its value in :mod:`stribeck.equations.observables`.
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
    Observable(
        "offset", "offset z0", "height of the undeformed cylinder over the undeformed surface", "gap", "undeformed_height"
    ),
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

# Scales of a contact in SI units.
HERTZ = {
    "hertz_half_width": ("m", "half-width a of the dry smooth contact"),
    "hertz_indentation": ("m", "indentation u_Hz of the dry smooth contact"),
    "hertz_pressure": ("Pa", "largest pressure p_Hz of the dry smooth contact"),
}

UNITS = {"gap": "m", "width": "m", "pressure": "Pa"}


@dataclass(frozen=True)
class OutputTable:
    """The observables of the states of one geometry."""

    rows: tuple[Observable, ...]  # All of them

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Observables with an estimated error, in the order of every array of them."""
        return tuple(row.name for row in self.rows if row.error)

    @cached_property
    def absolute(self) -> tuple[str, ...]:
        """Observables whose estimated error is absolute."""
        return tuple(row.name for row in self.rows if row.error == "absolute")

    @cached_property
    def listed(self) -> dict[str, tuple[str, str]]:
        """Attributes of a solution that a dataset holds: unit and meaning of each."""
        return {row.name: ("1", row.meaning + UNIT_SUFFIXES[row.scale]) for row in self.rows if row.listed}

    @cached_property
    def films(self) -> dict[str, tuple[str, str]]:
        """Further SI quantities in the file of a contact: unit and meaning of each."""
        return {row.film: (UNITS[row.scale], row.meaning) for row in self.rows if row.film} | HERTZ


LINE = OutputTable(ROWS)  # The observables of the line

# Drag on the other wall, whose error is estimated for films that are not of the base model.
UPPER_DRAG = Observable(
    "viscous_upper", "viscous friction, upper", "viscous friction on the cylinder", "friction", listed=False
)

# Positions of rupture and reformation; the error is relative to the larger of the position and the half-width.
RUPTURE_ROWS = (
    Observable("exit_position", "end of the film", "position where the film ends", "width", "film_exit_position"),
    Observable(
        "reformation_position",
        "film reforms",
        "position where the film reforms behind the cavity",
        "width",
        "film_reformation_position",
    ),
)

# The observables of the line by cavitation.
LINE_BY_CAVITATION = {
    "none": LINE,
    "exit": OutputTable((*ROWS, RUPTURE_ROWS[0])),
    "reform": OutputTable((*ROWS, *RUPTURE_ROWS)),
}

_SHARED = {row.name: row for row in ROWS}

# The friction integrals of the ball, which enter friction: name, end of the label, and meaning.
INTEGRALS = (
    ("J_couette", ", Couette part", "finite part of the friction integral of the shear flow"),
    ("J_poiseuille", ", Poiseuille part", "finite part of the friction integral of the pressure flow"),
    ("J_balanced", ", balanced", "finite part of the balanced friction integral"),
    ("J_published", ", published", "finite part of the published friction integral"),
    ("J_pcx", " of asperities", "integral of the contact pressure along x, with its sign"),
)

# The observables of the ball.
POINT = OutputTable(
    (
        *(_SHARED[name] for name in ("contact_load_share", "fluid_load_share", "central_gap", "minimum_gap")),
        Observable(
            "minimum_radius",
            "distance of minimum film",
            "distance of the minimum gap from the centre",
            "width",
            "minimum_film_radius",
            "",
        ),
        Observable(
            "minimum_angle",
            "angle of minimum film",
            "angle of the minimum gap from the middle line behind the contact, in radian",
            error="",
        ),
        Observable(
            "minimum_gap_on_axis",
            "minimum film on the middle line",
            "minimum gap on the middle line",
            "gap",
            "minimum_film_thickness_on_axis",
        ),
        Observable(
            "central_pressure", "central pressure", "total pressure at the centre", "pressure", "central_total_pressure"
        ),
        Observable(
            "offset", "offset z0", "height of the undeformed ball over the undeformed surface", "gap", "undeformed_height"
        ),
        _SHARED["lambda_ratio"],
        *(Observable(name, f"friction integral{label}", meaning, listed=False) for name, label, meaning in INTEGRALS),
        Observable(
            "identity_error",
            "error of the identity",
            "residual of the identity of the friction integrals, over the largest of them",
            error="",
        ),
        _SHARED["error_estimate"],
    )
)

OUTPUT_TABLES = {"line": LINE, "point": POINT}  # The observables by geometry

NAMES, ABSOLUTE = LINE.names, LINE.absolute  # Of the line

# Observables of the line with an estimated error for any model, in the order of every array of them.
ALL_NAMES = (*NAMES, UPPER_DRAG.name, *(row.name for row in RUPTURE_ROWS))

AREA = "real_contact_area"  # What a shear stress of the asperities acts on

# Further observables if the contact law knows the spectrum of the surface.
AREA_ROWS = {
    "central_area_fraction": ("1", "real over apparent contact area at the centre"),
    "central_area_fraction_error": ("1", "estimated absolute error of central_area_fraction"),
    "real_contact_area": ("1", "real area of contact over that of the dry smooth contact"),
    "real_contact_area_error": ("1", "estimated absolute error of real_contact_area"),
}

# Further columns of states, curves, batches, sweeps and diagrams.
COLUMNS = {
    "regime": ("1", "lubrication regime"),
    "outcome": ("1", "how the solve of the state ended"),
    "message": ("1", "notes on the validity of the state"),
    "hydrodynamic_friction": ("1", "friction coefficient of smooth surfaces by the law of the hydrodynamic branch"),
    "friction": ("1", "friction coefficient"),
    "friction_asperities": ("1", "contribution of asperities to the friction coefficient"),
    "friction_fluid": ("1", "contribution of the fluid to the friction coefficient"),
    "friction_error": ("1", "estimated absolute error of the friction coefficient"),
    "contact_friction_share": ("1", "fraction of the friction that asperities cause"),
    "state": ("1", "number of the state"),
    "nodes": ("1", "unknown gaps in the discretisation"),
    "newton_steps": ("1", "steps of the Newton iteration"),
}


def friction_rows(definition: str) -> dict[str, tuple[str, str]]:
    """Return unit and meaning of friction by one definition, of the fluid's part in it, and of its error."""
    label = f"friction coefficient, definition {definition}"
    return {
        f"friction_{definition}": ("1", label),
        f"friction_{definition}_fluid": ("1", f"{label}: contribution of the fluid"),
        f"friction_{definition}_error": ("1", f"{label}: estimated absolute error"),
    }
