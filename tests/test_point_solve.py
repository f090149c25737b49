"""The point contact against states of an independent grid, and what holds for every state."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from stribeck import Groups, InputError, Outcome, SolveError, solve, surfaces

DATA = json.loads((Path(__file__).parent / "data" / "point_states.json").read_text())
MINIMUM = ("minimum_gap", "minimum_gap_on_axis")


def ball(speed, load, kappa, law=None):
    return Groups(speed, load, kappa * load ** (2 / 3), law=law, geometry="point")


def solve_cold(groups, rtol=1e-6):
    """Return the state behind a solution."""
    return solve(groups, rtol=rtol, on_failure="return").state


def groups_of(row, law=None):
    return ball(row["speed"], row["load"] or 1e-3, row["relative_roughness"], law)


def departures(state, row, rtol):
    """Return by how much each observable misses its reference over what is allowed."""
    found = {}
    for name in ("contact_load_share", "central_gap", "central_pressure", "offset", "J_balanced", "J_published", *MINIMUM):
        if name not in row["values"]:
            continue
        allowed = (100 if name in MINIMUM else 2) * rtol * state.scales[name] + row["uncertainty"][name]
        found[name] = abs(state.values[name] - row["values"][name]) / allowed
    return found


CHEAP = [row for row in DATA["states"] if row["relative_roughness"] >= 1e-3 or row["speed"] >= 1]


def some_slow(rows, fast):
    """Return rows as parameters, of which only some are not slow."""
    return [pytest.param(row, marks=[] if i in fast else pytest.mark.slow, id=str(i)) for i, row in enumerate(rows)]


@pytest.mark.parametrize("row", some_slow(CHEAP, (1, 5, 9, 12, 13)))
def test_a_cold_state_agrees_with_the_reference(row):
    state = solve_cold(groups_of(row), 1e-6)
    assert state.outcome.ok
    assert max(departures(state, row, 1e-6).values()) <= 1.0
    assert state.error_estimate <= 1e-6
    assert abs(state.load_error) < 1e-8
    assert abs(state.identity_error) <= 1e-7 * state.scales["J_balanced"]


@pytest.mark.parametrize("row", some_slow(DATA["states"][1:], (9, 19)))
def test_at_the_finest_tolerance_a_state_is_within_1e_7_of_the_reference(row):
    state = solve_cold(groups_of(row), 1e-8)
    assert state.outcome.ok
    assert state.error_estimate <= 1e-8
    for name, value in row["values"].items():
        if name not in (*MINIMUM, "minimum_radius", "minimum_angle"):
            allowed = 2e-8 * state.scales[name] + row["uncertainty"][name]
            assert state.values[name] == pytest.approx(value, rel=0, abs=allowed), name
    missed = abs(state.values["minimum_gap"] - row["values"]["minimum_gap"])
    assert missed <= 1e-6 * state.scales["minimum_gap"] + row["uncertainty"]["minimum_gap"]


@pytest.mark.parametrize("row", some_slow(DATA["persson"]["states"], (4,)))
def test_a_state_under_perssons_law_agrees_with_the_reference(row):
    spectrum = surfaces.SelfAffine(h_rms=1e-6, q0=3e4, q1=3e7, hurst=0.8)
    state = solve_cold(groups_of(row, surfaces.persson_law(spectrum, 0.45)), 1e-6)
    assert state.outcome.ok
    assert state.error_estimate <= 1e-6
    found = departures(state, row, 1e-6)
    # Their minimum was read off at points: where it is off, it is too high.
    lowest = row["values"]["minimum_gap"] + 4e-4 * state.scales["minimum_gap"]
    assert state.values["minimum_gap"] <= lowest
    assert found.pop("minimum_gap") <= 1.0 or state.values["minimum_gap"] < row["values"]["minimum_gap"]
    assert max(found.values()) <= 1.0


@pytest.mark.quick
def test_the_dry_smooth_contact_is_that_of_hertz():
    state = solve_cold(ball(0.0, 1.0, 0.0))
    assert (state.values["offset"], state.values["central_pressure"], state.values["contact_load_share"]) == (-1.0, 1.0, 1.0)
    fields = state.fields(np.array([0.0, 0.6, 2.0]), 0.0)
    assert fields.contact_pressure == pytest.approx([1.0, 0.8, 0.0])
    assert fields.gap == pytest.approx([0.0, 0.0, (2 * math.acos(0.5) + math.sqrt(3)) / math.pi])


@pytest.mark.quick
def test_at_rest_a_heavier_load_of_the_exponential_law_only_shifts_the_gap():
    light, heavy = solve_cold(ball(0.0, 1e-3, 0.01)), solve_cold(ball(0.0, 5.0, 0.01))
    shift = 0.01 * math.log(5000) / 3
    assert heavy.values["central_gap"] == pytest.approx(light.values["central_gap"] - shift, abs=1e-9)
    assert heavy.values["minimum_gap"] < 0


@pytest.mark.quick
def test_fields_agree_with_the_nodes_and_go_on_beyond_the_rim():
    state = solve_cold(ball(0.1, 1e-3, 0.1), 1e-4)
    r, angle = state.mesh.radii, state.mesh.angles[2]
    fields = state.fields(r * np.cos(angle), r * np.sin(angle))
    assert fields.gap == pytest.approx(state.nodal_gap[2], rel=1e-9)
    assert fields.fluid_pressure == pytest.approx(state.nodal_fluid_pressure[2], abs=1e-12)
    x = state.mesh.rim * np.array([0.999, 1.001, 4.0])
    far = state.fields(x, 0.0)
    assert far.gap == pytest.approx(x * x / 2, rel=1e-2)
    assert far.fluid_pressure == pytest.approx(-0.8 * 0.1 / x**3, rel=1e-2)


@pytest.mark.quick
def test_a_tolerance_out_of_range_is_refused():
    with pytest.raises(InputError, match="1e-08 to 0.01"):
        solve_cold(ball(1.0, 1.0, 1.0), 1e-9)


@pytest.mark.slow
def test_the_minimum_film_of_a_very_thin_smooth_film_states_what_its_slow_series_leaves_out():
    row = next(row for row in DATA["states"] if row["speed"] == 1e-6 and row["relative_roughness"] == 0)
    state = solve_cold(groups_of(row), 1e-4)
    assert state.outcome.ok
    missed = abs(state.values["minimum_gap"] - row["values"]["minimum_gap"])
    assert missed <= state.absolute_errors["minimum_gap"] + row["uncertainty"]["minimum_gap"]
    assert abs(state.values["central_gap"] / row["values"]["central_gap"] - 1) < 1e-6


@pytest.mark.quick
def test_a_film_too_thin_for_any_mesh_is_refused_at_once_and_says_what_to_ask_for():
    said = "takes more memory than a solve may use; ask for a larger speed, roughness or rtol"
    with pytest.raises(SolveError, match=said) as e:
        solve(ball(1e-20, 1e-3, 0.0), rtol=1e-3)
    assert e.value.outcome is Outcome.MESH_LIMIT
    assert solve_cold(ball(1e-20, 1e-3, 1e-4), 1e-2).outcome.ok


@pytest.mark.slow
def test_a_speed_so_slow_that_friction_is_lost_to_rounding_is_said_to_be():
    state = solve_cold(ball(1e-18, 1e-3, 1e-2), 1e-3)
    assert state.outcome is Outcome.ROUNDING
    assert state.values["contact_load_share"] == pytest.approx(1.0, abs=1e-9)
    assert solve_cold(ball(1e-13, 1e-3, 1e-2), 1e-3).outcome.ok


def test_a_roughness_lost_to_rounding_is_said_to_be():
    with pytest.raises(SolveError) as lost:
        solve_cold(ball(0.0, 1e-3, 1e-12), 1e-3)
    assert lost.value.outcome is Outcome.ROUNDING
    assert solve_cold(ball(0.0, 1e-3, 1e-9), 1e-3).outcome.ok
