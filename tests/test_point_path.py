"""States of a ball along a curve: what they take over from their neighbours, and that they are those of a cold start."""

import pytest

from stribeck import Groups, Outcome
from stribeck.contacts.groups import contact_law
from stribeck.solver.point import start
from stribeck.solver.point.solve import solve_cold, solve_from
from stribeck.surfaces import SelfAffine, persson_law

RTOL = 1e-4


def ball(speed, load=1e-3, kappa=1e-2):
    return Groups(speed, load, kappa * load ** (2 / 3), geometry="point")


@pytest.fixture(scope="module")
def state():
    return solve_cold(ball(1e-2), RTOL)


def agree(one, other):
    for name, value in other.values.items():
        assert abs(one.values[name] - value) <= 2 * (one.absolute_errors[name] + other.absolute_errors[name]), name


def test_where_panels_no_longer_fit_the_state_of_a_neighbour_is_carried_to_new_ones(monkeypatch):
    state, there = solve_cold(ball(1.4e-2), RTOL), ball(7e-3)
    monkeypatch.setattr("stribeck.solver.point.solve.first_state", None)  # no cold start
    found = solve_from(state, there, RTOL)
    assert found.outcome.ok
    assert found.mesh.edges.size != state.mesh.edges.size
    monkeypatch.undo()
    agree(found, solve_cold(there, RTOL))


def test_from_a_neighbour_that_is_far_a_state_costs_no_more_than_a_cold_one(state, monkeypatch):
    # That of a smooth ball at a tenth of the speed took ten times as long from there.
    there = ball(1e-3)
    cold, warm = solve_cold(there, RTOL), solve_from(state, there, RTOL)
    assert (warm.newton_steps, warm.krylov_steps) == (cold.newton_steps, cold.krylov_steps)
    # If the cold start fails the neighbour is still asked.
    monkeypatch.setattr("stribeck.solver.point.solve.first_state", lambda *_: Outcome.STALLED)
    agree(solve_from(state, there, RTOL), cold)


def test_a_mesh_far_finer_than_a_tolerance_needs_is_left(state):
    fine = solve_cold(ball(9e-3), 1e-7)
    left, kept = solve_from(fine, ball(1e-2), 1e-3), solve_from(state, ball(1.01e-2), RTOL)
    assert left.outcome.ok
    assert left.mesh.size < 0.7 * fine.mesh.size
    assert (kept.mesh.size, kept.mesh.degree) == (state.mesh.size, state.mesh.degree)


def test_a_state_that_misses_its_tolerance_goes_to_finer_meshes_than_its_neighbour(state):
    finer = solve_from(state, ball(1e-2), 1e-2 * state.error_estimate)
    assert finer.outcome.ok
    assert finer.error_estimate <= 1e-2 * state.error_estimate
    assert finer.mesh.degree > state.mesh.degree
    agree(finer, state)


def test_where_an_edge_in_the_contact_moves_panels_are_halved_and_meshes_do_not_grow():
    # A contact nearly full in its middle, on rougher and rougher surfaces: more angles and higher degrees went to 54 and 13.
    law = persson_law(SelfAffine(h_rms=21e-9, q0=6.3e5, q1=6.3e7, hurst=0.8), 0.45)
    load, speed, rtol = 1531.0, 1.126e-6, 1.5e-3

    def lens(kappa):
        return Groups(speed, load, kappa * load ** (2 / 3), law=law, geometry="point")

    first = found = solve_cold(lens(0.0441), rtol)
    for kappa in (0.0577, 0.0716, 0.0798, 0.0889, 0.108):
        found = solve_from(found, lens(kappa), rtol)
        assert found.outcome.ok
    assert (found.mesh.degree, found.mesh.modes) == (first.mesh.degree, first.mesh.modes)
    agree(found, solve_cold(lens(0.108), rtol))


def test_a_cold_start_of_a_sharp_rim_is_found_on_few_angles_at_once(monkeypatch):
    law = persson_law(SelfAffine(h_rms=21e-9, q0=6.3e5, q1=6.3e7, hurst=0.8), 0.45)
    solve_level, tried = start.solve_level, []
    monkeypatch.setattr(start, "solve_level", lambda on, *rest, **more: tried.append(on) or solve_level(on, *rest, **more))
    groups = Groups(1.126e-6, 1531.0, 0.0118027, law=law, geometry="point")
    speed, law = float(groups.speed), contact_law(groups)
    assert start.first_state(speed, law, groups.model).outcome.ok
    assert [each.modes for each in tried] == [start.MODES]
