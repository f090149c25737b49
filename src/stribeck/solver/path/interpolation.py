"""Unknowns and minimum gap between two expanded states of the line, which may lie on different meshes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from stribeck._types import Array
from stribeck.equations.error_estimate import FineOperators
from stribeck.equations.gap import minimum_gaps
from stribeck.equations.state import State
from stribeck.numerics.hermite import hermite_weights, missed_by
from stribeck.numerics.panels import Mesh, interpolation_error
from stribeck.solver.path.path import Expansion, change_ratio
from stribeck.solver.refinement import RefinedState


class LinePoint(NamedTuple):
    """A solved state, the coefficients of its unknowns, and the operators of its mesh."""

    refined: RefinedState
    state: State
    unknowns: Array
    fine: FineOperators


def minimum_between(left: Expansion, right: Expansion, of: LinePoint, parts: Array) -> tuple[Array, Array]:
    """Return minimum gap and position between two expansions on the mesh of one, and the error of the gap."""
    order, mesh, ends = min(left.order, right.order), of.state.mesh, (left, right)
    weights, scaled = hermite_weights(order, parts), _scaled(left, right, order)
    a, b = (_gaps_on(end.point, each, of)[:, : -mesh.order] for end, each in zip(ends, scaled, strict=True))
    with np.errstate(over="ignore"):  # a gap beyond all numbers is no minimum: its interval is halved
        place, lowest, error, panel = minimum_gaps(mesh, weights[0] @ a + weights[1] @ b)
    on_panels = missed_by(order, np.vstack([a, b]), change_ratio(left, right)).reshape(-1, mesh.order).max(axis=1)
    error = error + on_panels[panel] * (parts * (1 - parts)) ** order
    for end, each, w in zip(ends, scaled, weights, strict=True):
        if end.point.state.mesh is not mesh:  # values from another mesh were interpolated
            error = error + 2 * _unresolved(end.point, each, w, place)
    return np.stack([lowest, place]), error


def _unresolved(point: LinePoint, coefficients: Array, weights: Array, places: Array) -> Array:
    """Return the interpolation error of logarithms of gaps at places on the mesh of a point."""
    mesh = point.state.mesh
    shapes = coefficients[:, point.state.equations.layout.gap].copy()
    shapes[0] -= np.log(mesh.far)
    own = shapes.reshape(len(shapes), mesh.panels, mesh.order)[:, mesh.locate(places)[0]]
    return interpolation_error(np.einsum("rj,jrn->rn", weights, own))


def on(mesh: Mesh, near: Sequence[Expansion]) -> LinePoint | None:
    """Return the first point whose state lies on a mesh."""
    return next((one.point for one in near if one.point.state.mesh is mesh), None)


def between(left: Expansion, right: Expansion, of: LinePoint, parts: Array) -> Array:
    """Return the unknowns between two expansions on the mesh of one of them, with the logarithms of gaps."""
    order = min(left.order, right.order)
    a, b = (_on_mesh(end.point, each, of) for end, each in zip((left, right), _scaled(left, right, order), strict=True))
    of_left, of_right = hermite_weights(order, parts)
    return np.asarray(of_left @ a + of_right @ b)


def _scaled(left: Expansion, right: Expansion, order: int) -> list[Array]:
    """Return the coefficients of the unknowns at both ends, scaled to an interval of length one."""
    scale = (right.coordinate - left.coordinate) ** np.arange(order + 1.0)[:, None]
    return [end.point.unknowns[: order + 1] * scale for end in (left, right)]


def _on_mesh(point: LinePoint, coefficients: Array, of: LinePoint) -> Array:
    """Return coefficients of the unknowns of a point on the mesh of another."""
    mesh, other = point.state.mesh, of.state.mesh
    if mesh is other:
        return coefficients
    at, there = point.state.equations.layout, of.state.equations.layout
    found = np.empty((len(coefficients), there.size))
    found[:, there.numbers] = coefficients[:, at.numbers]
    found[:, there.gap] = _gaps_on(point, coefficients, of)
    if there.pressure.stop > there.pressure.start:
        found[:, there.pressure] = mesh.interpolate(coefficients[:, at.pressure], other.nodes)
    return found


def _gaps_on(point: LinePoint, coefficients: Array, of: LinePoint) -> Array:
    """Return the coefficients of the log gap on another point's mesh."""
    mesh, nodes, at = point.state.mesh, of.state.mesh.nodes, point.state.equations.layout
    if mesh is of.state.mesh:
        return coefficients[:, at.gap]
    shapes = coefficients[:, at.gap].copy()
    shapes[0] -= np.log(mesh.far)
    found = mesh.interpolate(shapes, nodes)
    found[0] += np.log(mesh.scale**2 + nodes**2)
    return found
