"""A phase diagram read off the atlas: all points at once, transitions located on it."""

from __future__ import annotations

import numpy as np

from . import atlas
from ._types import Array
from .atlas_curve import ERROR, AtlasCurve
from .newton import Outcome
from .parameters import Groups
from .phase_grid import MARKS, REGIMES, Diagram
from .regimes import BOUNDARY_FLUID_SHARE, HYDRODYNAMIC_CONTACT_SHARE

DENSITY = 20
"""Points per decade of speed on which the transitions of a row are seen."""


def fill(diagram: Diagram) -> None:
    """Enter all points and lines of a diagram; raise InputError where it reaches out of the box."""
    speeds = diagram.axes["speed"]
    for i in range(len(diagram.axes["load"])):
        for j in range(len(diagram.axes["roughness"])):
            _, groups, unit = diagram.problem(i, j)
            _enter(diagram, (i, j), Groups(unit * speeds, groups.load, groups.roughness, law=groups.law))
            diagram.velocity_weakening[i, j] = 0
            if float(groups.roughness) > 0:
                _enter_lines(diagram, (i, j), groups, unit)
            diagram.messages[i, j] = ""


def _enter(diagram: Diagram, row: tuple[int, int], groups: Groups) -> None:
    mu0, beta, definition = diagram.mu0, diagram.beta, diagram.definition
    friction = np.asarray(atlas.friction(groups, mu0, beta, definition))
    fluid, central = np.asarray(atlas.fluid_load_share(groups)), np.asarray(atlas.central_gap(groups))
    contact = mu0 * np.asarray(atlas.contact_load_share(groups)) / np.where(friction > 0, friction, 1.0)
    kappa = float(groups.relative_roughness)
    values = {
        "friction": friction,
        "friction_error": ERROR * friction,
        "fluid_load_share": fluid,
        "contact_friction_share": contact,
        "central_gap": central,
        "lambda_ratio": central / kappa if kappa > 0 else np.full_like(central, np.inf),
        "error_estimate": np.full_like(central, ERROR),
    }
    for name, found in values.items():
        diagram.fields[name][row] = found
    hydrodynamic, boundary = contact <= HYDRODYNAMIC_CONTACT_SHARE, fluid <= BOUNDARY_FLUID_SHARE
    names = np.where(hydrodynamic, REGIMES.index("hydrodynamic"), REGIMES.index("mixed"))
    diagram.regime[row] = np.where(boundary & ~hydrodynamic, REGIMES.index("boundary"), names)
    diagram.outcomes[row] = Outcome.CONVERGED.name


def _enter_lines(diagram: Diagram, row: tuple[int, int], groups: Groups, unit: float) -> None:
    """Locate the transitions of a row between the least and the largest speed of the atlas."""
    low, high = atlas.BOX["speed"]

    def groups_at(speed: Array) -> Groups:
        return Groups(speed, groups.load, groups.roughness, law=groups.law)

    speeds = np.geomspace(low, high, 1 + DENSITY * round(np.log10(high / low)))
    curve = AtlasCurve("speed", speeds, groups_at, None, diagram.mu0, diagram.beta, diagram.definition)
    marks = {mark.name: mark.value for mark in curve.transitions}
    for variable, name in MARKS.items():
        if name in marks:
            diagram.lines[variable][row] = marks[name] / unit
    minima = sorted(curve.local_minima(), key=lambda mark: mark.friction) if diagram.mu0 > 0 else []
    if minima:
        diagram.lines["speed_at_minimum"][row] = minima[0].value / unit
        diagram.lines["friction_at_minimum"][row] = minima[0].friction
    diagram.velocity_weakening[row] = int(bool(minima))
