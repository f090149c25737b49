"""A ball whose film ends at ambient pressure: independent states, limits, and what fills the wake."""

import math

import numpy as np
import pytest

import stribeck as sb
from stribeck import Groups

# Speed, kappa; central and minimum gap, contact share, each with its uncertainty: finite volumes on three grids.
FINITE_VOLUMES = [
    (0.1, 0.1, (0.256338, 4e-6), (0.255425, 5e-6), (0.83863, 3e-5)),
    pytest.param(0.1, 0.0, (0.096783, 2e-6), (0.0708, 1e-4), (0.0, 1e-9), marks=pytest.mark.slow),
    pytest.param(1.0, 0.0, (0.42996, 2e-5), (0.3601, 1e-4), (0.0, 1e-9), marks=pytest.mark.slow),
    pytest.param(0.01, 0.0, (0.024598, 1e-6), (0.0160, 3e-4), (0.0, 1e-9), marks=pytest.mark.slow),
    pytest.param(0.01, 0.01, (0.030522, 1e-6), (0.027614, 5e-6), (0.58045, 5e-5), marks=pytest.mark.slow),
]


def ball(speed, kappa, rtol, load=1e-3):
    """Return the state of a ball whose film ends."""
    groups = Groups(speed, load, kappa * load ** (2 / 3), geometry="point")
    return sb.solve(groups, cavitation="exit", rtol=rtol).state


@pytest.mark.parametrize(("speed", "kappa", "central", "minimum", "share"), FINITE_VOLUMES)
def test_states_agree_with_finite_volumes(speed, kappa, central, minimum, share):
    state = ball(speed, kappa, 1e-4)
    assert state.outcome.ok
    assert state.error_estimate <= 1e-4
    for name, (value, uncertainty) in zip(
        ("central_gap", "minimum_gap", "contact_load_share"), (central, minimum, share), strict=True
    ):
        assert abs(state.values[name] - value) <= uncertainty + state.absolute_errors[name], name
    assert abs(state.load_error) < 1e-6
    assert abs(state.identity_error) <= 1e-6 * state.scales["J_balanced"]
    assert state.nodal_fluid_pressure.min() == 0.0


@pytest.mark.slow
def test_in_boundary_lubrication_the_share_of_the_fluid_grows_with_the_speed_itself():
    slow, slower = (ball(speed, 0.1, 1e-3).values["fluid_load_share"] for speed in (1e-4, 1e-5))
    assert slow / 1e-4 == pytest.approx(1.664, rel=5e-4)
    assert math.log10(slow / slower) == pytest.approx(1.0, abs=1e-3)


@pytest.mark.slow
def test_in_boundary_lubrication_of_smoother_surfaces_the_share_is_that_of_finite_volumes():
    assert ball(1e-6, 0.01, 1e-3).values["fluid_load_share"] / 1e-6 == pytest.approx(35.470, rel=5e-4)


@pytest.mark.slow
def test_a_fast_ball_is_rigid():
    state = ball(30.0, 0.0, 1e-4)
    assert 4 * math.pi * math.sqrt(state.values["central_gap"]) / 30.0 == pytest.approx(5.9597, rel=1e-4)


@pytest.mark.quick
def test_a_heavy_ball_whose_torn_nodes_settle_slowly_is_solved_from_cold():
    assert ball(1.29283e-4, 8.91201e-3, 1e-4, 0.360854).outcome.ok


def test_a_line_of_rupture_that_begins_far_upstream_heals(subtests):
    """One node a step would take more steps than Newton's iteration may."""
    for groups, fluid in (
        ((0.0002111655536204129, 0.000301314928992415, 2.2621139902298936e-05), sb.fluids.Carreau(3.3704, 0.47137, 0.01)),
        ((2.5070113458342553e-05, 0.00027129780258489317, 4.119031803444864e-06), sb.fluids.Barus(2.0)),
    ):
        with subtests.test(fluid=fluid):
            assert sb.solve(Groups(*groups, geometry="point"), fluid=fluid, cavitation="exit", rtol=1e-3).outcome.ok


@pytest.mark.parametrize(
    ("speed", "load", "parts"),
    [
        (1e-4, 0.3, {"flow_factors": sb.fluids.PatirCheng(2.0)}),
        pytest.param(1e-3, 2.0, {"flow_factors": sb.fluids.EffectiveMedium(2.0)}, marks=pytest.mark.slow),
        pytest.param(
            1e-3, 2.0, {"flow_factors": sb.fluids.PatirCheng(2.0), "fluid": sb.fluids.Barus(1.0)}, marks=pytest.mark.slow
        ),
    ],
)
def test_a_film_that_flow_factors_lift_breaks_from_a_full_film_with_these(speed, load, parts):
    """From one between smooth surfaces, half as thick, it was lost; cavities of little suction are solved another way."""
    groups = sb.Groups(speed, load, 0.017 * load ** (2 / 3), geometry="point")
    torn = sb.solve(groups, rtol=1e-3, cavitation="exit", **parts)
    limit = sb.solve(groups, rtol=2e-3, cavitation="reform", cavity_pressure=-1e-4, **parts)
    assert abs(torn.contact_load_share - limit.contact_load_share) < 1e-3
    assert abs(torn.central_gap / limit.central_gap - 1) < 1e-3
    assert torn.central_gap > 1.3 * sb.solve(groups, rtol=1e-3, cavitation="exit").central_gap


@pytest.mark.slow
def test_panels_that_the_line_of_rupture_crosses_are_halved_where_more_angles_do_not_help():
    # Known from degree 14 on panels four times as narrow there, to 1e-6; degree 12 on wide panels misses 1.3e-5.
    load, kappa = 0.35704, 0.011197
    state = ball(3.0635e-4, kappa, 1e-4, load)
    assert state.outcome.ok
    for name, known, unsure in (("J_pcx", -0.0582097, 1e-6), ("contact_load_share", 0.858973, 1e-5)):
        assert abs(state.values[name] - known) <= state.absolute_errors[name] + unsure, name


def test_ten_angles_serve_a_loose_tolerance_and_state_their_errors():
    rough, sharp = (ball(0.0272, 0.024, rtol, 0.05) for rtol in (3e-3, 1e-4))
    assert rough.mesh.modes == 10 < sharp.mesh.modes
    assert rough.error_estimate <= 3e-3
    for name, value in sharp.values.items():
        assert abs(rough.values[name] - value) <= rough.absolute_errors[name] + sharp.absolute_errors[name], name


@pytest.mark.slow
def test_errors_of_thin_films_are_stated():
    """The central gap of a film that thins erred by 3.3 times what was stated."""
    rough, sharp = (ball(2e-3, 0.0, rtol, 1.4e-4) for rtol in (1e-3, 1e-4))
    assert rough.outcome.ok
    error = abs(rough.values["central_gap"] - sharp.values["central_gap"])
    assert error <= rough.absolute_errors["central_gap"] + sharp.absolute_errors["central_gap"]


@pytest.mark.slow
def test_errors_are_stated_where_two_meshes_agree_by_chance():
    """Both meshes of a pair erred by the same: 1.8 times what was stated."""
    state = ball(0.146, 0.0, 1e-4, 2.4e-3)
    assert state.error_estimate <= 1e-4
    # On 65 angles, degree 12; in doubt is what their number to the power -2 leaves.
    assert abs(state.values["offset"] - -0.771579) <= state.absolute_errors["offset"] + 1e-5


def test_streaks_behind_a_slow_ball_are_as_thick_as_the_film_that_leaves_the_contact():
    """The line of rupture follows the edge of the contact, between two rings: its gap was taken from the sides."""
    state = ball(3.4e-4, 0.0, 1e-3)
    # The shear missing in the streaks, integrated along straight lines over the film of 40 angles: 2.4 % of the drag.
    assert abs(state.values["J_couette"] - 0.060170) <= state.absolute_errors["J_couette"] + 3e-5


def test_slow_films_along_a_curve_hold_their_tolerance_and_are_the_states_of_cold_starts():
    """The pressure of the mesh for comparison had not settled: a state went to 45 angles, and the next one back."""
    groups = Groups(1e-2, 1.0, 0.1, geometry="point")
    speeds = np.array([4.99e-3, 7.06e-3, 1e-2])
    curve = sb.stribeck_curve(groups, speed=speeds, rtol=1e-3, cavitation="exit")
    assert curve.outcome.ok and curve.error_estimate <= 1e-3
    cold = ball(7.06e-3, 0.1, 1e-3, 1.0)
    share = curve.observable("contact_load_share")[1]
    assert share == pytest.approx(cold.values["contact_load_share"], abs=2e-3)
