"""Claims of Figures 3 to 6 of the paper, measured on the numbers that our figures draw."""

import numpy as np
import pytest
from figure_data import data_of


@pytest.fixture(scope="module")
def curve():
    return data_of("3")


@pytest.fixture(scope="module")
def smooth():
    return data_of("4")


@pytest.fixture(scope="module")
def laws():
    return data_of("5")


@pytest.fixture(scope="module")
def rest():
    return data_of("6")


def orders(x, y):
    """Return the local powers of x with which y goes."""
    return np.diff(np.log(np.asarray(y))) / np.diff(np.log(np.asarray(x)))


# --- Figure 3 ---


def test_friction_falls_between_the_boundary_plateau_and_its_minimum_and_rises_after_it(curve):
    x, friction = curve.hersey_number.values, curve.friction_balanced.values
    lowest = float(curve.minimum_hersey)
    assert 4.68e-5 < lowest < 4.70e-5
    assert round(float(curve.minimum_friction), 5) == 0.02682
    assert 1 <= curve.friction_published.values.min() / float(curve.minimum_friction) < 1.001
    assert (np.diff(friction[x < 0.9 * lowest]) < 1e-6).all()
    assert (np.diff(friction[x > 1.1 * lowest]) > 0).all()


def test_lubrication_is_boundary_below_the_hersey_number_that_the_paper_names(curve):
    share = curve.contact_load_share.values[curve.hersey_number.values < 1e-7]
    assert 0.97 < share.min() < 0.98
    assert 1.5e-7 < float(curve.boundary_end_hersey) < 1.7e-7


def test_friction_still_falls_where_the_paper_lets_hydrodynamic_lubrication_begin(curve):
    at_3e_5 = np.exp(np.interp(np.log(3e-5), np.log(curve.hersey_number), np.log(curve.friction_published)))
    assert 1.2 < at_3e_5 / float(curve.minimum_friction) < 1.3
    assert 4.4e-5 < float(curve.hydrodynamic_begin_hersey) < 4.6e-5


def test_only_the_printed_friction_exceeds_that_of_the_dry_contact(curve):
    assert 0.0031 < curve.friction_published.values.max() - 1 < 0.0033
    assert abs(curve.friction_balanced.values.max() - 1) < 1e-6


def test_the_printed_friction_of_the_fluid_is_seventy_times_that_of_the_force_balance_until_the_fluid_carries_the_load(curve):
    ratio = (curve.viscous_published / curve.viscous_balanced).values
    assert abs(ratio[0] - 70.55) < 0.01
    assert (np.diff(ratio) < 1e-6 * ratio[:-1]).all()
    assert abs(ratio[-1] - 1) < 1e-6


def test_the_regimes_end_at_speeds_that_grow_with_the_roughness(curve):
    ends, begins = (orders(curve.roughness, curve[f"{name}_speed"]) for name in ("boundary_end", "hydrodynamic_begin"))
    assert abs(ends[0] - 2) < 0.002 and (ends > 1.9).all()  # lambda/kappa**2 alone counts
    assert (begins > 1.3).all() and (begins < 5 / 3).all()  # c lambda**(3/5)/kappa, and logarithms
    assert (curve.boundary_end_speed < curve.hydrodynamic_begin_speed).all()


# --- Figure 4 ---


def test_slow_outlets_tend_to_the_similarity_solution_as_speed_to_two_fifths(smooth):
    found = orders(smooth.slow_speed, smooth.outlet_distance)
    assert (np.diff(found) < 0).all() and abs(found[0] - 0.4) < 0.02
    assert smooth.outlet_distance.values[0] < 0.003
    inside = smooth.slow_gap.sel(x_slow=0.9, method="nearest").values
    assert inside[-1] / inside[0] > 900 and smooth.outlet_distance.values[-1] < 0.21


def test_the_minimum_film_of_the_outlet_is_three_quarters_of_the_central_film(smooth):
    assert abs(float(smooth.outlet_limit.min()) - 0.75801) < 1e-5
    assert 0.37 < float(smooth.xi[int(smooth.outlet_limit.values.argmin())]) < 0.43


def test_slow_gaps_tend_to_that_of_hertz_as_speed_to_three_fifths(smooth):
    distance = np.abs(smooth.slow_gap - smooth.hertz_gap).max("x_slow")
    assert (np.abs(orders(smooth.slow_speed, distance) - 0.6) < 0.025).all()
    assert float(distance[0]) < 1e-4


def test_fast_gaps_tend_to_the_rigid_parabola_as_one_over_the_cube_root_of_speed(smooth):
    found = orders(smooth.fast_speed, smooth.rigid_distance)
    assert abs(found[-1] + 1 / 3) < 0.001 and (np.diff(found) < 0).all()
    assert smooth.rigid_distance.values[-1] < 0.02
    assert smooth.rigid_distance.values[1] > 0.3  # "perfect" is for much faster films


# --- Figure 5 ---


def test_film_and_friction_have_the_powers_of_both_limits(laws):
    film, friction = (orders(laws.speed, laws[name]) for name in ("central_gap", "friction"))
    assert abs(film[0] - 3 / 5) < 2e-4 and abs(film[-1] - 2 / 3) < 4e-3
    assert abs(friction[0] - 2 / 5) < 2e-3 and abs(friction[-1] - 2 / 3) < 1e-4


def test_the_laws_of_both_limits_hold_there_and_leave_a_gap_between_them(laws):
    assert abs(laws.film_large_error.values[0]) < 2e-4 and abs(laws.film_small_error.values[-1]) < 5e-3
    assert abs(laws.friction_large_error.values[0]) < 3e-3 and abs(laws.friction_small_error.values[-1]) < 5e-5
    assert 0.16 < -np.maximum(laws.film_large_error, laws.film_small_error).values.min() < 0.18


def test_the_printed_constant_of_the_film_is_low_by_more_than_a_per_cent(laws):
    assert abs(laws.film_large_printed_error.values[0] + 0.0132) < 1e-4


def test_the_excellent_description_of_friction_is_seven_per_cent_low_where_the_limits_meet(laws):
    error = laws.friction_squares_error.values
    assert -0.072 < error.min() < -0.071 and 0.011 < error.max() < 0.012
    assert 2e-3 < float(laws.speed[int(error.argmin())]) < 5e-3


def test_our_uniform_formulas_are_within_a_third_of_a_per_cent(laws):
    for name in ("film_uniform", "friction_uniform"):
        assert 1e-4 < np.abs(laws[f"{name}_error"]).values.max() < 3e-3


# --- Figure 6 ---


def test_the_rough_contact_gap_holds_inside_to_first_order_in_the_relative_roughness(rest):
    found = orders(rest.kappa_small, rest.core_distance)
    assert abs(found[0] - 1) < 0.01
    assert rest.core_distance.values[2] < 0.005


def test_the_edges_tend_to_the_similarity_solution_slowly_on_the_scales_of_the_paper(rest):
    found = orders(rest.kappa_small, rest.edge_distance)
    assert abs(found[0] - 1 / 3) < 0.01 and (np.diff(found) > 0).all()
    assert 0.2 < rest.edge_distance.values[2] < 0.25  # of h_rms/alpha, at kappa = 1e-3


def test_the_edges_tend_to_it_as_fast_again_where_the_edge_is_taken_at_one_minus_kappa(rest):
    found = orders(rest.kappa_small, rest.shifted_distance)
    assert abs(found[0] - 2 / 3) < 0.02
    assert (rest.shifted_distance < rest.edge_distance / 4).all()
    assert rest.shifted_distance.values[0] < 7e-4


def test_very_rough_contacts_tend_to_the_rigid_parabola_on_the_film_of_small_indentation(rest):
    found = orders(rest.kappa_large, rest.rigid_distance)
    assert ((found < -1) & (found > -1.1)).all()
    assert rest.rigid_distance.values[-1] < 8e-4


def test_the_scale_of_the_caption_makes_another_curve_of_each_load(rest):
    slope = 2 * np.sqrt(rest["load"])  # a/R for beta = 1
    right = 1 + slope * rest.ratio**2 / 2
    assert np.abs(rest.printed_gap / right - 1).max() < 1e-3
    ends = rest.printed_gap.values[:, -1]
    assert ends[0] > 2 * ends[1] > 3 * ends[2]


def test_gaps_at_rest_tend_to_that_of_hertz(rest):
    distance = np.abs(rest.large_gap - rest.hertz_gap).max("x")
    assert (orders(rest.kappa_small, distance) > 0.89).all()
    assert float(distance[0]) < 6e-5
