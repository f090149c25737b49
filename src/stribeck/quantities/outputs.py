"""What a solved state holds, for files and tables: the unit and the meaning of each number."""

from __future__ import annotations

GROUPS = ("speed", "load", "roughness")

OBSERVABLES = {
    "contact_load_share": ("1", "part of the load that asperities carry"),
    "fluid_load_share": ("1", "part of the load that the fluid carries"),
    "central_gap": ("1", "gap at the centre, in Hertz indentations"),
    "minimum_gap": ("1", "least gap, in Hertz indentations"),
    "minimum_position": ("1", "position of the least gap, in Hertz half-widths"),
    "minimum_position_error": ("1", "estimated absolute error of minimum_position, in Hertz half-widths"),
    "flux_gap": ("1", "flux gap: fluid flux over half the speed, in Hertz indentations"),
    "offset": (
        "1",
        "height of the undeformed cylinder over the undeformed surface, in Hertz indentations",
    ),
    "lambda_ratio": ("1", "central gap over h_rms/alpha"),
    "error_estimate": (
        "1",
        "largest estimated relative error of the observables; load shares count absolutely",
    ),
}
"""Attributes of a solution that a dataset holds: unit and name of each."""

AREA = {
    "central_area_fraction": ("1", "real area of contact over the apparent one, at the centre"),
    "central_area_fraction_error": ("1", "estimated absolute error of central_area_fraction"),
}
"""What a solution has besides, of which the contact law knows the spectrum of the surface."""
