"""Asymptotic laws of the model, each with range and source; the solver imports none, so that the two can be compared.

:data:`FORMULAS` is the one list of those of the article's model: tests, documentation and figures loop over it.  Films that
end have theirs in :mod:`stribeck.asymptotics.free_exit`.
"""

from typing import Any

from stribeck.asymptotics import point
from stribeck.asymptotics.dry import hertz, rest
from stribeck.asymptotics.formula import Formula, Limit, OutOfRangeWarning
from stribeck.asymptotics.rough import boundary, free_exit, load_sharing, mixed, perturbation, transitions, uniform
from stribeck.asymptotics.smooth import edge_layer, film_layers, hydrodynamic, large_deformation, small_deformation, wedge
from stribeck.asymptotics.smooth.film_of_pressure import film_of_pressure

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

_IN_READING_ORDER = (
    hertz,
    large_deformation,
    small_deformation,
    hydrodynamic,
    film_layers,
    rest,
    edge_layer,
    perturbation,
    boundary,
    wedge,
    mixed,
    transitions,
    load_sharing,
    uniform,
    point.hertz,
    point.rest,
    point.film,
    point.rigid,
    point.regressions,
    point.boundary,
    point.sharing,
    point.friction,
)

FORMULAS: tuple[Formula[Any], ...] = tuple(
    each
    for module in _IN_READING_ORDER
    for each in vars(module).values()
    if isinstance(each, Formula) and each.function.__module__ == module.__name__
)
"""All formulas, in the order in which a reader meets them: for the cylinder the smooth contact, the contact at rest, mixed
lubrication; then those of the ball likewise."""
