"""Asymptotic laws of the model, each with range and source; the solver imports none, so that the two can be compared.

:data:`FORMULAS` is the one list of those of the article's model: tests, documentation and figures loop over it.  Films that
end have theirs in :mod:`stribeck.asymptotics.free_exit`.
"""

from typing import Any

from stribeck.asymptotics import (
    boundary,
    edge_layer,
    film_layers,
    free_exit,
    hertz,
    hydrodynamic,
    load_sharing,
    mixed,
    perturbation,
    point,
    rest,
    transitions,
    uniform,
    wedge,
)
from stribeck.asymptotics.formula import Formula, Limit, OutOfRangeWarning
from stribeck.asymptotics.pressure_film import film_of_pressure

__all__ = [
    "FORMULAS",
    "Formula",
    "Limit",
    "OutOfRangeWarning",
    "boundary",
    "edge_layer",
    "film_layers",
    "film_of_pressure",
    "free_exit",
    "hertz",
    "hydrodynamic",
    "large_deformation",
    "load_sharing",
    "mixed",
    "perturbation",
    "point",
    "rest",
    "small_deformation",
    "transitions",
    "uniform",
    "wedge",
]

large_deformation = small_deformation = hydrodynamic  # both limits of the smooth contact, by their names

_SMOOTH, _AT_REST, _SLOW = (hertz, hydrodynamic, film_layers), (rest, edge_layer), (perturbation, boundary, wedge)
_ANY_SPEED = (mixed, transitions, load_sharing, uniform)
_OF_BALL = tuple(getattr(point, name) for name in point.__all__)

FORMULAS: tuple[Formula[Any], ...] = tuple(
    each
    for module in (*_SMOOTH, *_AT_REST, *_SLOW, *_ANY_SPEED, *_OF_BALL)
    for each in vars(module).values()
    if isinstance(each, Formula) and each.function.__module__ == module.__name__
)
"""All formulas: for the cylinder the smooth contact, the contact at rest, mixed lubrication; then those of the ball.

:meta hide-value:
"""
