"""Stacked states are what each is alone; meshes from known blocks, and where they resolve a gap."""

import numpy as np
import pytest

import stribeck as sb
from stribeck.contacts.groups import contact_law
from stribeck.equations.error_estimate import FineOperators, gap_is_resolved, perturbations
from stribeck.equations.line import Equations, Operators
from stribeck.equations.observables import DRAG_ROWS, changes, observables, observables_of_stacked
from stribeck.equations.state import StackedStates
from stribeck.numerics.panels import Mesh, base_edges
from stribeck.solids.half_plane import (
    deflection_operator,
    nodal_deflection,
)
from stribeck.solver.cold_start import cold_start
from stribeck.solver.refinement import converge, verify

SEED = 61_441
RTOL = 1e-6


def rows(size, load=0.1, roughness=1e-3):
    """Equations of three stacked states, each state's own, and unknowns."""
    mesh = Mesh(base_edges(0.5, 8.0), size, 0.5)
    speeds = np.array([[1e-3], [2e-3], [5e-3]])
    groups = sb.Groups(speeds, np.full((3, 1), load), np.full((3, 1), roughness))
    scales = np.array([[0.01], [0.02], [0.03]])
    together = Equations(Operators(mesh), groups.speed, contact_law(groups), scales)
    alone = [
        Equations(together.operators, float(s), contact_law(sb.Groups(float(s), load, roughness)), float(scale))
        for s, scale in zip(speeds.ravel(), scales.ravel(), strict=True)
    ]
    gap = np.random.default_rng(SEED).uniform(0.05, 0.1, (3, 1)) * (1 + mesh.nodes**2 * 6)
    return together, alone, np.hstack([gap, [[-0.1], [0.2], [0.3]], [[0.06], [0.07], [0.08]]])


def test_rows_are_what_each_state_is_alone():
    together, alone, y = rows(12)
    residuals, found = together.residual(y), observables_of_stacked(together, y, 0.1)
    times = np.arange(1.0, 4.0)[:, None]
    moved = changes(together, y, 0.1, times[:, None] * y)
    for i, equations in enumerate(alone):
        np.testing.assert_allclose(residuals[i], equations.residual(y[i]), rtol=1e-12, atol=1e-13)
        np.testing.assert_allclose(found[i].array(), observables(equations, y[i], 0.1).array(), rtol=1e-12, atol=1e-17)
        np.testing.assert_allclose(moved[:, i], changes(equations, y[i], 0.1, times * y[i]), rtol=1e-11, atol=1e-15)


def test_the_jacobian_in_units_of_the_unknowns_has_its_columns_scaled_by_them():
    _, alone, y = rows(12)
    units = alone[0].units(y[0])
    found, scaled = alone[0].jacobian(y[0], units), alone[0].jacobian(y[0]) * units
    # Elements are differences, and what they lose to rounding depends on the processor.
    assert (np.abs(found - scaled) <= 1e-12 * np.abs(scaled).max(axis=0)).all()


@pytest.mark.parametrize("order", [10, 12, 16])
def test_the_deflection_from_known_blocks_is_that_of_the_points(order):
    edges = np.unique(np.concatenate([base_edges(0.25, 8.0), [-1.0625, -1.125, 0.875, 0.9375, 7.0, 7.5]]))
    mesh = Mesh(edges, order, 0.25)
    exact = deflection_operator(mesh, mesh.nodes)
    assert np.abs(nodal_deflection(mesh) - exact).max() < 1e-14 * np.abs(exact).max()


def test_a_mesh_reads_off_the_gaps_where_its_estimate_says_so():
    groups = sb.Groups(0.05, 0.1, 1e-4)
    state = converge(cold_start(groups).states[-1], groups, RTOL).state
    fine = FineOperators(state.mesh)
    error = verify(state, groups, fine, RTOL).estimate.between_nodes
    assert gap_is_resolved(state.mesh, state.gap, 2 * error)
    assert not gap_is_resolved(state.mesh, state.gap, 0.1 * error)


def test_fine_panels_hold_the_far_gap_without_its_logarithm():
    # x**2/2 - ln|x|/2 + c is exact there: a change of friction on finer nodes would be an error of the estimate alone.
    mesh = Mesh(base_edges(1.0, 8.0), 12, 1.0)
    x = mesh.nodes
    gap = 0.5 * (x * x + 1.0) - 0.25 * np.log(x * x + 1.0) + 1.0
    y = np.append(gap, [1.0, 4 / 3])
    groups = sb.Groups(1.0, 0.1, 1e-4)
    equations = Equations(Operators(mesh), 1.0, contact_law(groups))
    observed = observables(equations, y, 0.1).array()
    rows = StackedStates(equations, y[None], 0.1, lambda r: r)
    found = perturbations(rows, observed[None], FineOperators(mesh)).friction[:, 0]
    assert (found[1:] <= 1e-9 * np.abs(observed[DRAG_ROWS[1:]])).all()  # the pressure of this gap is no polynomial
