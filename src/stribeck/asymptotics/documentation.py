"""Text that the docstrings of formulas share: the descriptions of their arguments and values, written once.

The docstring of a formula states its value, equation and error.  Arguments, value and exceptions that many share are filled
in from the tables here; a section or an argument that a formula describes itself is left as it is.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import Any

from stribeck.quantities import docstrings

ARGUMENTS: dict[str, tuple[str, str]] = {
    "x": ("float or array_like", "Positions [a]; broadcast with the groups."),
    "terms": ("int", "1, or 2 for the term in brackets too."),
    "beta": ("float", "Coefficient of the contact law [-]."),
    "boundary_friction": ("float", "Friction coefficient of the dry contact [-]."),
    "slope": ("float or array_like", "a/R [-]."),
}
"""Type and description of the arguments that several formulas have."""

VALUES: dict[str, str] = {
    "pressure": "Pressure [p_Hz]",
    "fluid_pressure": "Fluid pressure [p_Hz]",
    "contact_pressure": "Contact pressure [p_Hz]",
    "gap": "Gap [u_Hz]",
    "central_gap": "Gap [u_Hz]",
    "minimum_gap": "Gap [u_Hz]",
    "minimum_gap_on_axis": "Gap [u_Hz]",
    "flux_gap": "Flux gap [u_Hz]",
    "offset": "Offset [u_Hz]",
    "fluid_load_share": "Load share of the fluid [-]",
    "contact_load_share": "Load share of the asperities [-]",
    "friction": "Friction coefficient [-]",
    "viscous_friction": "Friction coefficient [-]",
    "friction_at_minimum": "Friction coefficient [-]",
    "speed_at_half_fluid": "Speed group [-]",
    "speed_at_minimum": "Speed group [-]",
    "separation_at_minimum": "Lambda [-]",
}
"""Value and scale of what formulas predict."""

ERRORS: dict[str, str] = {
    "terms": "If ``terms`` is neither 1 nor 2.",
    "form": "If the form is unknown.",
    "film": "If the film is unknown.",
    "definition": "If the definition is unknown.",
    "viscous": "If the definition is unknown.",
    "slope": "If the slope is not positive.",
    "share": "If the share is not between 0 and 1.",
    "wetted_radius": "If the wetted radius lies in the contact.",
}
"""When a formula refuses an argument."""


def completed(function: Callable[..., Any], predicts: str, uses: tuple[str, ...], undefined: str) -> str:
    """Return the docstring of a formula with the sections that it leaves to the tables here."""
    names = list(inspect.signature(function).parameters)
    groups = "all three groups" if len(uses) == 3 else " and ".join(f"``{name}``" for name in uses)
    states = "Groups\n    " + (f"Uses {groups} [-]; arrays broadcast." if uses else "Any; the answer takes their shape.")
    common = {"groups": states} | {name: f"{kind}\n    {words}" for name, (kind, words) in ARGUMENTS.items()}
    refused = [f"InputError\n    {ERRORS[name]}" for name in names if name in ERRORS]
    value = f"float or ndarray\n    {VALUES[predicts]}" + (f"; nan {undefined}." if undefined else ".")
    return docstrings.complete_docstring(function, common, value, "\n".join(refused))
