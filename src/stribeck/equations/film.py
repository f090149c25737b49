"""The film at the nodes of a mesh: functions of the gap where it is full, zero in the cavity; and what kind of film it is."""

from collections.abc import Callable, Sequence
from typing import Any, TypeAlias

import numpy as np

from stribeck._types import Array, Flags, Indices
from stribeck.fluids.fluid import Decay, Film
from stribeck.numerics.dual import value_of
from stribeck.numerics.running_integral import RunningIntegral
from stribeck.numerics.series import Jet
from stribeck.numerics.trace import Trace, pointwise

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


def decay_of(film: Film, speed: float) -> Decay:
    """Return how the pressure of a film falls off at a speed group: as an even power unless the film says otherwise."""
    told = getattr(film, "decay", None)
    return Decay() if told is None else told(speed)


def is_thinning(film: Film) -> bool:
    """Return whether the viscosity falls with the rate: the pressure gradient may then turn sharply where the flow does."""
    return hasattr(film, "decay")


def is_rough(film: Film) -> bool:
    """Return whether roughness hinders the flow: the pressure gradient then turns where the last paths of the flow close."""
    return not getattr(film, "is_smooth", True)


def closed_gap(film: Film) -> float | None:
    """Return the mean gap at which roughness closes the last path of the flow; None if it never does."""
    return None if getattr(film, "is_plain", False) else getattr(film, "closed_at", None)


def jump_of(film: Film) -> Callable[[Array, Array | None], Array | None] | None:
    """Return the function of the jump of the pressure gradient between each node and the next; None for smooth films."""
    return None if getattr(film, "is_plain", False) else getattr(film, "jump", None)
