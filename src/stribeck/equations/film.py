"""The film at the nodes of a mesh: functions of the gap where it is full, zero in the cavity."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, TypeAlias

import numpy as np

from stribeck._types import Flags, Indices
from stribeck.fluids.fluid import Film
from stribeck.numerics.jets import Jet
from stribeck.numerics.running_integral import RunningIntegral
from stribeck.numerics.trace import Trace, pointwise, value_of

__all__ = ["NODAL", "Nodes", "at_nodes", "gradient_in_film"]

NODAL = ("gap", "pressure")  # Unknowns that have a value at every node

Nodes: TypeAlias = Indices | Flags | slice
"""Some of the nodes of a mesh."""


def at_nodes(
    film: Film,
    functions: Callable[[Film, Any, Any, Any], Sequence[Any]],
    nodes: Nodes | None,
    gap: Any,
    pressure: Any,
    flux_gap: Any,
    speed: Any = None,
) -> list[Any]:
    """Return functions of a film at some nodes, zero at the others, of values or of traces; of a traced speed too."""
    given = {"gap": gap, "pressure": pressure, "flux_gap": flux_gap, "speed": speed}
    if nodes is None and not any(isinstance(one, Trace) and one.terms for one in given.values()):
        return list(functions(film if speed is None else film.at(speed), gap, pressure, flux_gap))
    column = {}
    for name, one in given.items():
        value = value_of(one)
        if nodes is not None and value is not None and name in NODAL:
            value = value[..., nodes]
        column[name] = Trace.number(name, value) if isinstance(one, Trace) else value
    found: list[Any] = []
    traced = column.pop("speed")
    for each in functions(film if traced is None else film.at(traced), *column.values()):
        value, slopes = value_of(each), each.columns if isinstance(each, Trace) else {}
        if nodes is not None:
            value = scattered(value, nodes, value_of(gap))
            slopes = {name: scattered(slope, nodes, value_of(gap)) for name, slope in slopes.items()}
        known = tuple(slopes.values())
        found.append(pointwise(lambda *_: (value, *known), *(given[name] for name in slopes)) if slopes else value)  # noqa: B023
    return found


def gradient_in_film(film: Film, integral: RunningIntegral, h: Any, p: Any, flux_gap: Any, speed: Any = None) -> Any:
    """Return G at the nodes where the film is full, zero in the cavity, of values or of traces."""
    nodes = None if integral.reformation == 0.0 else integral.filled
    return at_nodes(film, lambda film, *at: (film.gradient(*at),), nodes, h, p, flux_gap, speed)[0]


def scattered(values: Any, where: Nodes, like: Any) -> Any:
    """Return nodal values that are ``values`` at some nodes and zero at the others."""
    if isinstance(values, Jet):
        return values.mapped(lambda each: scattered(each, where, like.value))
    found = np.zeros((*values.shape[:-1], like.shape[-1]), values.dtype)
    found[..., where] = values
    return found
