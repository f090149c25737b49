"""States verified many at once: as each alone, and solved anew where the mesh that they share proves too coarse."""

import numpy as np
import pytest

import stribeck as sb
from stribeck.equations.error_estimate import FineOperators, gap_is_resolved
from stribeck.equations.line import Operators
from stribeck.equations.state import solve_state
from stribeck.numerics.panels import Mesh, base_edges
from stribeck.solver import corrector as follower_module
from stribeck.solver.cold_start import cold_start
from stribeck.solver.corrector import Corrector
from stribeck.solver.judgement import verify_together
from stribeck.solver.path import solve_along
from stribeck.solver.refinement import converge, verify

RTOL = 1e-6
SPEEDS = np.geomspace(1.0, 1e-5, 51)


def groups_at(s):
    return sb.Groups(float(np.exp(s)), 0.1, 1e-4)


@pytest.fixture(scope="module")
def neighbours():
    """States on one mesh: two that share factors, and one with its own."""
    first = converge(cold_start(groups_at(-3.0)).states[-1], groups_at(-3.0), RTOL)
    operators = Operators(first.state.mesh)
    kept = solve_state(groups_at(-3.1), operators, first.state, 1e-8, kept=first.state.root.inverse)
    own = solve_state(groups_at(-3.4), operators, kept, 1e-8)
    assert kept.root.inverse is first.state.root.inverse
    return [first.state, kept, own], FineOperators(operators.mesh)


@pytest.mark.quick
def test_states_are_judged_together_as_each_is_alone(neighbours):
    states, fine = neighbours
    points = verify_together(states, [state.root.inverse for state in states], fine, RTOL)
    for state, point in zip(states, points, strict=True):
        alone = verify(state, state.groups, fine, RTOL)
        assert point.outcome is alone.outcome and point.groups == state.groups
        np.testing.assert_allclose(point.values.array(), alone.values.array(), rtol=1e-11)
        for part in ("discretisation", "interpolation", "rounding"):
            np.testing.assert_allclose(getattr(point.estimate, part), getattr(alone.estimate, part), rtol=1e-4, atol=1e-15)


def test_a_mesh_reads_off_the_gaps_where_its_estimate_says_so(neighbours):
    states, fine = neighbours
    error = verify(states[0], states[0].groups, fine, RTOL).estimate.between_nodes
    assert gap_is_resolved(states[0].mesh, states[0].gap, 2 * error)
    assert not gap_is_resolved(states[0].mesh, states[0].gap, 0.1 * error)


def test_fewer_points_wait_where_a_mesh_resolves_them_worse_or_is_large(neighbours):
    corrector = Corrector(groups_at, RTOL, postpone=True)
    assert corrector.patience == 1  # nothing is known yet
    corrector.at_nodes = 1e-6
    assert corrector.patience == follower_module.MOST_WAITING
    corrector.at_nodes = 0.02
    assert 1 < corrector.patience < follower_module.MOST_WAITING
    corrector.at_nodes = 0.9
    assert corrector.patience == 1
    corrector.at_nodes = 1e-6
    corrector.operators = Operators(neighbours[1].coarse.refined(120))
    assert corrector.patience * corrector.operators.mesh.size <= follower_module.WAITING_NODES


@pytest.mark.parametrize("rtol", [1e-6, 1e-9])
def test_points_whose_mesh_proves_too_coarse_are_solved_anew(monkeypatch, rtol):
    whole = sb.stribeck_curve(load=0.1, roughness=1e-4, speed=SPEEDS[::-1], rtol=rtol)
    again = []
    solve_again = Corrector._again
    monkeypatch.setattr(Corrector, "_again", lambda self, point: again.append(point) or solve_again(self, point))
    monkeypatch.setattr(follower_module, "PATIENCE", 1e9)  # so that all wait, however large the errors of their mesh
    patient = sb.stribeck_curve(load=0.1, roughness=1e-4, speed=SPEEDS[::-1], rtol=rtol)
    assert again
    assert patient.outcome.ok and len(patient) == len(SPEEDS)
    assert patient.error_estimate <= rtol
    np.testing.assert_allclose(patient.friction, whole.friction, rtol=2 * rtol)


def test_a_point_that_cannot_be_resolved_ends_the_path_before_it(monkeypatch):
    monkeypatch.setattr(follower_module, "PATIENCE", 1e9)
    lost = []

    def fail(self, point):
        lost.append(point)
        return point

    monkeypatch.setattr(Corrector, "_again", fail)
    path = solve_along(groups_at, np.log(SPEEDS).tolist(), RTOL)
    assert not path.outcome.ok
    assert path.failure is lost[0]
    assert len(path.states) >= 3
    assert all(point.outcome.ok and point.estimate.total <= RTOL for point in path.states)
    assert min(path.coordinates) > np.log(lost[0].groups.speed)


def test_an_interrupted_path_keeps_the_points_that_were_reported():
    reported = []

    def report(s, point):
        reported.append(s)
        if len(reported) == 4:
            raise KeyboardInterrupt

    path = solve_along(groups_at, np.log(SPEEDS).tolist(), RTOL, report)
    assert path.outcome is sb.Outcome.INTERRUPTED
    assert len(reported) == 4
    assert path.coordinates == tuple(reported)
    assert all(point.estimate.total <= RTOL for point in path.states)


def test_fine_panels_hold_the_far_gap_without_its_logarithm():
    # x**2/2 - ln|x|/2 + c is exact there: a change of friction on finer nodes would be an error of the estimate alone.
    from stribeck.contacts.groups import contact_law
    from stribeck.equations.error_estimate import perturbations
    from stribeck.equations.line import Equations
    from stribeck.equations.observables import observables
    from stribeck.equations.state import StackedStates

    mesh = Mesh(base_edges(1.0, 8.0), 12, 1.0)
    x = mesh.nodes
    gap = 0.5 * (x * x + 1.0) - 0.25 * np.log(x * x + 1.0) + 1.0
    y = np.append(gap, [1.0, 4 / 3])
    groups = sb.Groups(1.0, 0.1, 1e-4)
    equations = Equations(Operators(mesh), 1.0, contact_law(groups))
    observed = observables(equations, y, 0.1).array()
    rows = StackedStates(equations, y[None], 0.1, lambda r: r)
    found = perturbations(rows, observed[None], FineOperators(mesh)).friction[:, 0]
    assert (found <= 1e-9 * observed[-2:]).all()
