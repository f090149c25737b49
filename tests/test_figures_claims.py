"""Claims of the figures of the paper, measured on the numbers that our figures draw."""

import numpy as np
import pytest
from figure_data import data_of


@pytest.fixture(scope="module")
def laws():
    return data_of("5")


@pytest.fixture(scope="module")
def rest():
    return data_of("6")


@pytest.fixture(scope="module")
def profiles():
    return data_of("8")


def orders(x, y):
    """Return the local powers of x with which y goes."""
    return np.diff(np.log(np.asarray(y))) / np.diff(np.log(np.asarray(x)))


# --- Figure 5 ---


def test_film_and_friction_have_the_powers_of_both_limits(laws):
    film, friction = (orders(laws.speed, laws[name]) for name in ("central_gap", "friction"))
    assert abs(film[0] - 3 / 5) < 2e-4 and abs(film[-1] - 2 / 3) < 4e-3
    assert abs(friction[0] - 2 / 5) < 2e-3 and abs(friction[-1] - 2 / 3) < 1e-4


def test_the_excellent_description_of_friction_is_seven_per_cent_low_where_the_limits_meet(laws):
    error = laws.friction_squares_error.values
    assert -0.072 < error.min() < -0.071 and 0.011 < error.max() < 0.012
    assert 2e-3 < float(laws.speed[int(error.argmin())]) < 5e-3


# --- Figure 6 ---


def test_the_edges_tend_to_the_similarity_solution_slowly_on_the_scales_of_the_paper(rest):
    found = orders(rest.kappa_small, rest.edge_distance)
    assert abs(found[0] - 1 / 3) < 0.01 and (np.diff(found) > 0).all()
    assert 0.2 < rest.edge_distance.values[2] < 0.25  # of h_rms/alpha, at kappa = 1e-3


def test_the_edges_tend_to_it_as_fast_again_where_the_edge_is_taken_at_one_minus_kappa(rest):
    found = orders(rest.kappa_small, rest.shifted_distance)
    assert abs(found[0] - 2 / 3) < 0.02
    assert (rest.shifted_distance < rest.edge_distance / 4).all()
    assert rest.shifted_distance.values[0] < 7e-4


def test_the_scale_of_the_caption_makes_another_curve_of_each_load(rest):
    slope = 2 * np.sqrt(rest["load"])  # a/R for beta = 1
    right = 1 + slope * rest.ratio**2 / 2
    assert np.abs(rest.printed_gap / right - 1).max() < 1e-3
    ends = rest.printed_gap.values[:, -1]
    assert ends[0] > 2 * ends[1] > 3 * ends[2]


# --- Figure 8 ---


def test_profiles_are_those_of_the_speeds_and_the_contact_of_the_paper(profiles):
    np.testing.assert_allclose(profiles.speed.values[[0, -1]], [3.16e-6, 1e-3], rtol=2e-3)
    assert (profiles.attrs["load_group"], profiles.attrs["roughness_group"]) == (0.1, 1e-4)
    on_curve = np.interp(np.log(profiles.profile_hersey), np.log(profiles.hersey_number), np.log(profiles.friction))
    np.testing.assert_allclose(np.exp(on_curve), profiles.profile_friction, rtol=0.02)


def test_slow_profiles_are_the_rough_contact_under_hertz_pressure(profiles):
    assert 0.09 < profiles.gap_distance.values[0] < 0.11
    assert 0.10 < profiles.contact_distance.values[0] < 0.12
    for name in ("gap_distance", "contact_distance"):
        assert (np.diff(profiles[name].values) > 0).all()
        assert orders(profiles.speed.values[:2], profiles[name].values[:2]) > 0.8


def test_fast_profiles_carry_hertz_pressure_in_the_fluid_over_the_smooth_film(profiles):
    assert 0.028 < profiles.fluid_distance.values[-1] < 0.032
    assert profiles.film_distance.values[-1] < 1e-3
    assert (np.diff(profiles.fluid_distance.values) < 0).all()


def test_with_speed_the_load_moves_from_asperities_to_the_fluid_and_the_gap_rises(profiles):
    for name in ("central_gap", "fluid_load_share"):
        assert (np.diff(profiles[name].values) > 0).all()
    assert profiles.fluid_load_share.values[0] < 0.04 and profiles.fluid_load_share.values[-1] > 0.996
    areas = [2 / np.pi * np.trapezoid(profiles[f"{kind}_pressure"], profiles.x, axis=1) for kind in ("fluid", "contact")]
    np.testing.assert_allclose(areas[0] + areas[1], 1.0, atol=2e-3)
    np.testing.assert_allclose(areas[0], profiles.fluid_load_share, atol=2e-3)


def test_near_the_outlet_the_contact_pressure_grows_for_a_while(profiles):
    middle, outlet = (profiles.contact_pressure.sel(x=x, method="nearest").values for x in (0.0, 1.0))
    assert (np.diff(middle) < 0).all()
    assert np.diff(outlet).max() > 0.04
