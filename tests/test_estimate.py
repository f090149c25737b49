"""The error estimate against the true error: what mesh, rounding and Newton's iteration leave."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import stribeck as sb
from stribeck import Outcome
from stribeck.equations.error_estimate import FineOperators, error_estimates
from stribeck.equations.line import Operators
from stribeck.equations.mesh_choice import mesh_for
from stribeck.equations.state import solve_state
from stribeck.numerics.panels import Mesh
from stribeck.quantities.outputs import NAMES
from stribeck.solver import refinement
from stribeck.solver.cold_start import cold_start
from stribeck.solver.refinement import converge, verify

SEED = 17_903

STATES = {
    "mixed": (1e-5, 0.1, 1e-4),
    "hydrodynamic": (1.0, 0.1, 1e-4),
    "boundary": (1e-8, 0.1, 1e-2),
    "thin film": (1e-7, 0.1, 1e-6),
    "heavy": (1e-3, 3.0, 0.3),
    "smooth": (1e-6, 0.1, 0.0),
}
UNRESOLVED = [(6, 3e-2), (8, 1e-2), (10, 1e-1), (10, 3e-3), (10, 1e-3), (14, 1e-3)]


@cache
def rough_state(groups):
    """Return the end of the cold start."""
    return cold_start(groups).states[-1]


def state_on(groups, order, tolerance, newton=1e-11, halved=False):
    """A state on a mesh that was chosen for the end of the cold start, or on halves of its panels."""
    guess = rough_state(groups)
    mesh = mesh_for(guess, groups, guess.equations.law, order, tolerance, tolerance)
    if halved:
        mesh = replace(mesh, edges=np.sort(np.append(mesh.edges, mesh.centres[:-1])))
    return solve_state(groups, Operators(mesh), guess, newton)


def judged(state):
    """Observables of any film and their estimated relative errors, by part."""
    point = verify(state, state.groups, FineOperators(state.mesh), 1e-6)
    values = np.array([getattr(point.values, name) for name in NAMES])
    names = ("discretisation", "interpolation", "rounding", "scales")
    estimate = replace(point.estimate, **{part: getattr(point.estimate, part)[: len(NAMES)] for part in names})
    parts = {part: getattr(estimate, part) / estimate.scales for part in names[:3]}
    return values, parts, estimate


@pytest.fixture(scope="module", params=STATES)
def case(request, solved):
    """Groups and the exact observables, with what their errors are relative to."""
    solution = solved(*STATES[request.param], rtol=1e-9)
    exact = np.array([getattr(solution.observables, name) for name in NAMES])
    return sb.Groups(*STATES[request.param]), exact


def test_the_estimate_follows_the_true_error_on_coarse_meshes(case):
    groups, exact = case
    ratios = []
    for order, tolerance in UNRESOLVED:
        values, _, estimate = judged(state_on(groups, order, tolerance))
        error = (np.abs(values - exact) / estimate.scales).max()
        if 1e-8 < error < 1e-2:  # above, a first-order estimate knows nothing; below, the exact values do not
            ratios.append(estimate.total / error)
    assert len(ratios) >= 2
    assert min(ratios) > 0.9
    assert 1 < np.exp(np.log(ratios).mean()) < 300


def test_the_defect_measures_the_error_at_the_nodes(case):
    """Offset and flux gap owe nothing to interpolation: the defect is their error, within ten."""
    groups, exact = case
    names = [NAMES.index(name) for name in ("flux_gap", "offset")]
    ratios = []
    for order, tolerance in UNRESOLVED:
        values, parts, estimate = judged(state_on(groups, order, tolerance))
        error = (np.abs(values - exact) / estimate.scales)[names].max()
        if 1e-9 < error < 1e-2:
            ratios.append(parts["discretisation"][names].max() / error)
    assert len(ratios) >= 2
    assert 0.1 < np.median(ratios) < 10
    assert min(ratios) > 0.03


def test_the_defect_sees_a_contact_pressure_that_dies_away_on_wide_panels(subtests):
    """That of a Gaussian surface falls to nothing at a few roughnesses: finer nodes must resolve it where panels do not."""
    for load, kappa in [(0.001835, 0.5123), (0.007547, 0.4913)]:
        with subtests.test(load=load, kappa=kappa):
            groups = sb.Groups(3e-3, load, kappa * load, law=sb.contact_laws.GreenwoodTripp())
            solution = sb.solve(groups, rtol=1e-9)
            edges = np.array([-8.0, -2.0, -1.0, -0.5, 0.0, 0.5, 1.0, 2.0, 8.0])
            guess = rough_state(groups)
            values, parts, estimate = judged(solve_state(groups, Operators(Mesh(edges, 12)), guess, 1e-9))
            offset = NAMES.index("offset")
            error = abs(values[offset] - solution.offset) / estimate.scales[offset]
            assert error > 3e-8
            assert 1 < parts["discretisation"][offset] / error < 10


def test_rounding_is_not_below_the_scatter_of_equivalent_meshes():
    groups = sb.Groups(1e-11, 0.1, 0.0)
    # Tails of halved panels are far below the tolerance: what is left is rounding.
    found = [judged(state_on(groups, order, 1e-7, halved=True)) for order in (12, 14, 16)]
    values = np.array([values for values, _, _ in found])
    rounding = np.max([parts["rounding"] for _, parts, _ in found], axis=0)
    scatter = 0.5 * np.ptp(values, axis=0) / found[0][2].scales
    # Shares and offset are known better than the film, the central gap is interpolated: they tell of meshes.
    films = [NAMES.index(name) for name in ("minimum_gap", "flux_gap", "viscous_published", "viscous_balanced")]
    assert (scatter <= rounding)[films].all()
    assert scatter[films].max() > 0.01 * rounding.max()
    assert rounding.max() > 1e-9
    assert found[0][2].floor == pytest.approx(found[0][1]["rounding"].max(), rel=1e-12)


@pytest.mark.quick
def test_an_iteration_that_stopped_early_is_seen(case):
    """The defect holds the residual at the nodes too: a state beside the solution is found to be so."""
    groups, _ = case
    state = state_on(groups, 14, 1e-4)
    exact, _, _ = judged(state)
    rng = np.random.default_rng(SEED)
    step = state.root.last_step
    assert step < 1e-3
    scale = min(state.gap.min(), state.equations.law.decay_length or np.inf)
    x = state.mesh.nodes
    gap = 1e-4 * scale / (1 + ((x - 0.2) / 0.7) ** 2)
    change = np.append(gap, [1e-5 * rng.normal(), 1e-4 * state.flux_gap])
    values, parts, estimate = judged(replace(state, y=state.y + change))
    error = np.abs(values - exact) / estimate.scales
    large = (error > 0.03 * error.max()) & (parts["interpolation"] < error)  # what lies between the nodes is no defect
    ratio = (parts["discretisation"] / np.maximum(error, 1e-300))[large]
    assert error.max() > 1e-6
    assert (ratio > 1).all()
    assert (ratio < 4).all()


@pytest.mark.quick
def test_a_difference_of_meshes_bounds_the_defect():
    groups = sb.Groups(*STATES["mixed"])
    _, _, estimate = judged(state_on(groups, 10, 3e-3))
    difference = 1e-3 * estimate.discretisation
    assert (estimate.at_most(difference).discretisation <= estimate.discretisation).all()
    # The coarser of two meshes may be wrong by more than their difference.
    assert (estimate.at_most(difference).discretisation > 1.5 * difference)[difference > 0].all()
    assert estimate.at_most(difference).total < estimate.total
    assert estimate.at_most(1e3 * estimate.discretisation).total == estimate.total


@pytest.mark.quick
def test_errors_of_load_shares_are_absolute_and_others_relative(solved):
    s = solved(*STATES["boundary"])
    assert set(s.errors) == {*NAMES, "viscous_upper"}
    assert s.errors["fluid_load_share"] < 1e-6  # of a share that is itself far smaller
    assert s.fluid_load_share < 1e-6
    values, _, estimate = judged(state_on(s.groups, 10, 1e-3))
    assert np.array_equal(estimate.scales[:2], [1.0, 1.0])
    assert np.array_equal(estimate.scales[2:], np.abs(values[2:]))
    assert s.error_estimate == max(s.errors[name] for name in NAMES)  # drag counts relative to the larger of both walls


def test_the_stated_errors_of_typical_states_cover_the_true_ones(solved, true_errors):
    ratios, singles = {}, {}
    for name, groups in STATES.items():
        for rtol in (1e-3, 1e-6, 1e-9):
            s = solved(*groups, rtol=rtol)
            error = true_errors(s)
            assert s.error_estimate <= rtol
            assert error.max() <= rtol
            ratios[name, rtol] = error.max() / s.error_estimate
            singles[name, rtol] = (error / [s.errors[each] for each in NAMES]).max()
    assert np.mean([ratio <= 1 for ratio in ratios.values()]) >= 0.85, ratios
    assert max(ratios.values()) < 10, ratios
    assert max(singles.values()) < 30, singles


def test_more_nodes_a_panel_lower_the_error_exponentially_until_1e_10(subtests, solved):
    for name in ["hydrodynamic", "boundary"]:
        with subtests.test(name=name):
            groups = sb.Groups(*STATES[name])
            exact = np.array([getattr(solved(*STATES[name], rtol=1e-11).observables, n) for n in NAMES])
            guess = rough_state(groups)
            panels = mesh_for(guess, groups, guess.equations.law, 10, 1e-6).edges
            far = panels[-1] * 2.0 ** np.arange(1, 4)  # the logarithm in the far gap is not what is measured here
            edges = np.concatenate([-far[::-1], panels, far])
            orders = np.arange(6, 13, 2)
            errors = []
            for order in orders:
                mesh = Mesh(edges, int(order), guess.mesh.scale)
                values, _, estimate = judged(solve_state(groups, Operators(mesh), guess, 1e-11))
                errors.append((np.abs(values - exact) / estimate.scales).max())
            rate, _ = -np.polyfit(orders, np.log(errors), 1)
            assert rate > 1.5
            assert np.diff(np.log(errors)).max() < -1.0
            assert errors[-1] < 1e-10


@pytest.mark.quick
def test_a_state_that_holds_its_own_inverse_is_as_exact_and_that_is_the_inverse_of_its_jacobian():
    groups = sb.Groups(*STATES["mixed"])
    start = rough_state(groups)
    own, other = (converge(start, groups, 1e-6, own_inverse=each) for each in (True, False))
    state, units = own.state, own.state.equations.units(own.state.y)
    assert own.outcome.ok
    assert own.estimate.total < 2 * other.estimate.total
    np.testing.assert_allclose(own.values.array(), other.values.array(), rtol=1e-8)
    column = state.equations.jacobian(state.y, units) @ np.ones_like(units)
    np.testing.assert_allclose(state.root.inverse(column), -1.0, atol=1e-7)


@pytest.mark.quick
def test_a_second_step_begins_with_the_residual_where_the_first_one_ended():
    near = state_on(sb.Groups(*STATES["mixed"]), 14, 1e-4)
    groups = replace(near.groups, speed=1.05 * near.groups.speed)
    rough, exact = (solve_state(groups, near.equations.operators, near, newton) for newton in (0.3, 1e-11))
    first = rough.corrected()
    np.testing.assert_allclose(first.corrected().y[exact.equations.layout.gap], exact.gap, rtol=1e-9)
    assert np.abs(first.gap / rough.gap - 1).max() > 1e-6


def test_meshes_grow_no_more_where_only_noise_of_the_gaps_is_left(monkeypatch):
    sizes = []

    def noisy(states, observed, fine):
        sizes.append(fine.mesh.size)
        found = error_estimates(states, observed, fine)
        return [replace(one, interpolation=one.interpolation + 2e-6 * one.scales) for one in found]

    groups = sb.Groups(*STATES["mixed"])
    start = rough_state(groups)
    monkeypatch.setattr(refinement, "error_estimates", noisy)
    monkeypatch.setattr(refinement, "ROUNDING", 1e-6 * start.gap.min())
    assert converge(start, groups, 1e-6).outcome is Outcome.ROUNDING
    assert len(sizes) <= 3
