"""Text that the docstrings of formulas share: the descriptions of their arguments and values, written once.

The docstring of a formula states its equation; below stand the arguments that it describes itself, ``name : words``, and then
its notes.  Headings, other arguments, value, exceptions, range, error and source are filled in from its signature, its table
entry, and the tables here.
"""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable
from typing import Any, Literal, TypeVar, get_args, get_origin

from stribeck.quantities import docstrings

F = TypeVar("F", bound=Callable[..., Any])

_EQUATION = re.compile(r"^\.\. math::.*\n(?:\s*\n| {4}.*\n)*", re.MULTILINE)
_ARGUMENT = re.compile(r"(\w+) :(?: (.*))?\n((?: {4}.*\n)*)")

ARGUMENTS: dict[str, str] = {
    "x": "Positions [a]; broadcast with the groups.",
    "terms": "1, or 2 for the term in brackets too.",
    "beta": "Coefficient of the contact law [-].",
    "boundary_friction": "Friction coefficient of the dry contact [-].",
    "groups": "Uses ``load`` and ``roughness`` [-]; arrays broadcast.",
    "load": "Load group [-], between 0 and 1.",
    "speed": "Speed group, zero or positive [-].",
    "slope": "a/R [-].",
    "reach": "Half-width of the box, in units of the layer.",
    "width": "Width of the panels near the edge.",
    "order": "Nodes on each panel.",
    "share": "Part of the load on the fluid [-], between 0 and 1.",
    "form": "Form of :func:`phi`.",
    "printed": "Whether with the constant 0.44 as printed.",
    "definition": "The force on the flat; or with the moment of the fluid pressure, by the definition of the article.",
    "viscous": "The same definitions, or without viscous friction.",
    "wetted_radius": "Where the liquid ends [a]; by default that of a whole sphere, :mod:`stribeck.contacts.cut_off`.",
    "with_edges": "Whether with the terms of the edges.",
}
"""Description of the arguments that several formulas have."""

KINDS: dict[str, str] = {
    "Value": "float or array_like",
    "float | Array": "float or array_like",
    "float | None": "float, optional",
    "Value | None": "float or array_like, optional",
}
"""What annotations are called; a choice of words is listed, and the others stand as they are."""

VALUES: dict[str, str] = {
    "pressure": "Pressure [p_Hz]; zero outside the contact",
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

OFFSETS = {
    "line": ", in the gauge ln(abs(x-y)/a)",
    "point": ": height of the apex over the undeformed surface",
}
"""What the offset of each geometry is counted from."""

ERRORS: dict[str, str] = {
    "terms": "If ``terms`` is neither 1 nor 2.",
    "form": "If the form is unknown.",
    "film": "If the film is unknown.",
    "definition": "If the definition is unknown.",
    "viscous": "If the definition is unknown.",
    "slope": "If the slope is not positive.",
    "share": "If the share is not between 0 and 1.",
    "wetted_radius": "If the wetted radius is below 5 Hertz radii.",
}
"""When a formula refuses an argument."""


def completed(
    function: Callable[..., Any], predicts: str, uses: tuple[str, ...], geometry: str, undefined: str, evidence: str
) -> str:
    """Return the docstring of a formula with all that its table entry and the tables here say of it."""
    groups = "all three groups" if len(uses) == 3 else " and ".join(f"``{name}``" for name in uses)
    words = {"groups": f"Uses {groups} [-]; arrays broadcast." if uses else "Any; the answer takes their shape."}
    if geometry == "point":
        words["x"] = f"Positions, or distances from the middle{ARGUMENTS['x'].removeprefix('Positions')}"
    offset = OFFSETS[geometry] if predicts == "offset" else ""
    value = f"{VALUES[predicts]}{offset}; nan {undefined}." if undefined else f"{VALUES[predicts]}{offset}."
    return _filled(function, words, f"float or ndarray\n    {value}", "", evidence)


def described(
    returns: str,
    *,
    kind: str = "float or ndarray",
    raises: str = "",
    error: str = "InputError",
    source: str = "",
    **words: str,
) -> Callable[[F], F]:
    """Return the decorator that completes the docstring of a function that is no formula; ``words`` describe its arguments."""

    def decorate(function: F) -> F:
        if function.__doc__ is not None:  # as it is under `python -OO`
            refused = f"{error}\n    {raises}" if raises else ""
            function.__doc__ = _filled(
                function, words, f"{kind}\n    {returns}", refused, f"Source: {source}." if source else ""
            )
        return function

    return decorate


def _filled(function: Callable[..., Any], words: dict[str, str], returns: str, refused: str, notes: str) -> str:
    """Return the docstring of a function with the sections that it leaves out, its arguments as in the signature."""
    names = inspect.signature(function).parameters
    common = {
        name: f"{_kind(function, argument)}\n    {words.get(name) or ARGUMENTS.get(name, '')}"
        for name, argument in names.items()
    }
    refused = refused or "\n".join(f"InputError\n    {ERRORS[name]}" for name in names if name in ERRORS)
    function.__doc__ = _with_headings(function)
    return docstrings.complete_docstring(function, common, returns, refused, notes)


def _with_headings(function: Callable[..., Any]) -> str:
    """Return a docstring in which what stands below the equation has headings, unless it has some."""
    text = f"{inspect.getdoc(function)}\n"
    equation = _EQUATION.search(text)
    if equation is None or re.search(r"^--+$", text, re.MULTILINE):
        return text
    arguments, below = "", text[equation.end() :]
    while own := _ARGUMENT.match(below):
        kind = _kind(function, inspect.signature(function).parameters[own[1]])
        words = f"    {own[2]}\n" if own[2] else own[3]
        arguments, below = f"{arguments}{own[1]} : {kind}\n{words}", below[own.end() :]
    sections = {"Parameters": arguments, "Notes": below.strip()}
    headed = [f"{title}\n{'-' * len(title)}\n{each}" for title, each in sections.items() if each]
    return "\n".join([text[: equation.end()], *headed])


def _kind(function: Callable[..., Any], argument: inspect.Parameter) -> str:
    """Return the type of an argument in the words of a docstring."""
    quoted = ", ".join(f'"{choice}"' for choice in choices(function, argument))
    return f"{{{quoted}}}" if quoted else KINDS.get(str(argument.annotation), str(argument.annotation))


def choices(function: Callable[..., Any], argument: inspect.Parameter) -> tuple[str, ...]:
    """Return the words of which an argument is one, or none where it is something else."""
    kind = function.__globals__.get(str(argument.annotation))
    return get_args(kind) if get_origin(kind) is Literal else ()
