"""Claims of the figures of the paper of which each takes many curves, measured on the numbers that our figures draw."""

import math

import numpy as np
import pytest
from figure_data import data_of, picture_of
from test_figures_claims import orders

import stribeck as sb

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def curve():
    return data_of("3")


@pytest.fixture(scope="module")
def curves():
    return data_of("7")


@pytest.fixture(scope="module")
def mixed():
    return data_of("9")


@pytest.fixture(scope="module")
def slow():
    return data_of("10")


@pytest.fixture(scope="module")
def regimes():
    return data_of("11")


@pytest.fixture(scope="module")
def expansion():
    return data_of("S1")


def case(data, load, roughness):
    """Return the number of a case."""
    (found,) = np.flatnonzero((data["load"].values == load) & (data["roughness"].values == roughness))
    return int(found)


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


# --- Figure 7 ---


def test_hydrodynamic_branches_collapse_over_the_friction_of_smooth_surfaces_as_far_as_its_law_is_right(curves):
    assert -0.013 < np.nanmin(curves.distance.values) < -0.011
    assert 0.075 < np.nanmax(curves.distance.values) < 0.079
    assert np.nanmax(np.abs(curves.uniform_distance.values)) < 0.003
    assert np.isfinite(curves.distance.values).sum() > 150


def test_smoother_and_heavier_contacts_have_less_friction_at_slower_speed(curves):
    for load in (0.1, 0.01):
        rows = [case(curves, load, roughness) for roughness in (1e-5, 1e-4, 1e-3)]
        assert (np.diff(curves.minimum_friction.values[rows]) > 0).all()
        assert (np.diff(curves.minimum_hersey.values[rows]) > 0).all()
        assert (np.diff(curves.separation_at_minimum.values[rows]) < 0).all()
    for roughness in (1e-5, 1e-4, 1e-3):
        heavy, light = (case(curves, load, roughness) for load in (0.1, 0.01))
        assert curves.minimum_friction.values[heavy] < 0.6 * curves.minimum_friction.values[light]
        assert curves.minimum_hersey.values[heavy] < 0.3 * curves.minimum_hersey.values[light]


def test_the_reported_ranges_are_those_that_the_paper_quotes_and_ours_lies_in_the_widest_of_them(curves, mixed):
    for data in (curves, mixed):
        quoted = zip(data.attrs["reports"].split("; "), data.reported_low.values, data.reported_high.values, strict=True)
        assert {name: (low, high) for name, low, high in quoted} == {
            "Bongaerts 2007": (0.7, 11.0),
            "Petrova 2019": (0.7, 1.2),
            "Sadowski 2019": (0.9, 2.3),
            "Dong 2023": (16.0, 2736.0),
        }
        assert float(data.textbook) == 3.0
    found = curves.separation_at_minimum.values[np.isfinite(curves.separation_at_minimum.values)]
    assert 0.7 < found.min() and found.max() < 11.0
    law = curves.predicted_separation.sel(predicted_load=0.1).interp(predicted_roughness=1e-4)
    assert abs(float(law) / curves.separation_at_minimum.values[case(curves, 0.1, 1e-4)] - 1) < 0.01


def test_panels_without_the_data_of_the_paper_say_so(subtests):
    for name, letter in [("7", "c"), ("9", "d")]:
        with subtests.test(name=name, letter=letter):
            (axes,) = [axes for axes in picture_of(name).axes if axes.get_title(loc="left").startswith(f"({letter})")]
            words = " ".join(" ".join(text.get_text() for text in axes.texts).split())
            assert "Bongaerts 2007 here," in words and "not public to us" in words and "Dong 2023" in words


# --- Figure 9 ---


def test_the_friction_of_the_paper_fits_near_the_minimum_of_smooth_contacts_and_ours_everywhere(mixed):
    kappa = (mixed["roughness"] / mixed["load"]).values
    near = (mixed.film_ratio.values > 7) & (mixed.film_ratio.values < 14)
    worst = {k: np.abs(mixed.large_error.values[(kappa == k)[:, None] & near]).max() for k in (1e-4, 1e-2, 1e-1)}
    assert worst[1e-4] < 0.11 and 0.4 < worst[1e-2] < 0.6 and worst[1e-1] > 0.7
    fit = (mixed.film_ratio.values > 3) & (kappa <= 0.1)[:, None]
    assert np.abs(mixed.uniform_error.values[fit]).max() < 0.03
    assert fit.sum() > 100


def test_lambda_grows_as_roughness_falls_and_no_constant_will_do(mixed):
    assert (np.diff(mixed.separation.values, axis=1) < 0).all()
    assert mixed.separation.values.min() < 3.1 and mixed.separation.values.max() > 13.3
    per_decade = np.diff(mixed.separation.values[:, ::2], axis=1)[:, 0]
    # -ln k grows by 2/3 ln 10 in each decade of roughness.
    np.testing.assert_allclose(per_decade, -2 / 3 * math.log(10), atol=0.08)


def test_minimum_friction_goes_with_roughness_to_two_thirds_and_logarithms(mixed):
    steps = orders(mixed.minimum_roughness.values[1], mixed.minimum_friction.values[1])
    # 2/3 (1 - 2/(3 Lambda)) = 0.633 at the smoothest, without what the asperities add to the film.
    assert 0.63 < steps[0] < 0.66 and (np.diff(steps) > 0).all()


# --- Figure 10 ---


def test_friction_follows_the_formula_only_as_far_as_its_viscous_part_is_small(slow):
    i = case(slow, 0.1, 1e-4)
    assert 0.0030 < float(slow.excess[i]) < 0.0034
    few = (slow.share_law.values > 1e-5) & (slow.share_law.values < 1e-2)
    assert (slow.fall_published.values[few] < slow.share_law.values[few]).all()
    assert slow.fall_published.values[few].min() < -0.002
    np.testing.assert_allclose(slow.fall_balanced.values[few][2:], slow.share_law.values[few][2:], rtol=0.25)


def test_friction_of_the_figure_tends_to_the_formula_as_speed_falls(slow):
    for i in range(slow.sizes["case"]):
        if slow["roughness"].values[i] / slow["load"].values[i] <= 0.01:
            plateau = slow.contact_load_share.values[i] > 0.95
            assert plateau.sum() > 3
            off = slow.boundary_friction.values[i] - slow.contact_load_share.values[i]
            assert np.abs(off[plateau]).max() < 0.045
            assert abs(off[0]) < 1e-3


# --- Figure 11 ---


def test_speed_leads_from_boundary_over_mixed_to_hydrodynamic_lubrication(regimes):
    codes = regimes.regime.values
    assert set(np.unique(codes)) == {0, 1, 2}
    assert (np.diff(codes, axis=-1) >= 0).all()


def test_the_speed_axis_is_cut_by_the_solved_lines_where_the_regime_changes(regimes):
    for i in range(regimes.sizes["load"]):
        for j in range(4):
            row = regimes.isel(load=i, roughness=j)
            first, last = float(row.speed_at_5_percent_fluid), float(row.speed_at_10_percent_contact_friction)
            expected = (row.speed.values > first).astype(int) + (row.speed.values > last)
            np.testing.assert_array_equal(row.regime.values, expected)


def test_the_printed_end_of_boundary_lubrication_lies_deep_inside_it(regimes):
    smooth = regimes.sel(roughness=slice(None, 1e-3))
    assert float((smooth.printed_speed_boundary_to_mixed / smooth.speed_at_5_percent_fluid).max()) < 0.06
    corrected = (smooth.formula_speed_boundary_to_mixed / smooth.speed_at_5_percent_fluid).values
    assert 3.8 < corrected.min() and corrected.max() < 8.1
    ours = (smooth.formula_speed_at_5_percent_fluid / smooth.speed_at_5_percent_fluid).values
    assert np.abs(ours - 1).max() < 0.05


def test_the_line_of_minimum_friction_is_right_for_smooth_contacts_and_ends_where_friction_no_longer_falls(regimes):
    smooth = regimes.sel(roughness=1e-6)
    printed = (smooth.printed_speed_at_minimum / smooth.speed_at_minimum).values
    assert 0.88 < printed.min() and printed.max() < 0.92
    np.testing.assert_allclose(regimes.roughness_without_minimum, [0.00343, 0.01599], rtol=2e-3)
    for i in range(regimes.sizes["load"]):
        falls = np.isfinite(regimes.speed_at_minimum.values[i])
        np.testing.assert_array_equal(falls, regimes["roughness"].values < float(regimes.roughness_without_minimum[i]))


# --- Figure S1 ---

PARTS = ("first_pressure", "first_gap", "second_pressure")


def test_what_vanishes_with_the_speed_goes_as_its_first_and_second_power(expansion):
    for name, order in zip(PARTS, (1, 2, 2), strict=True):
        for change in expansion[f"{name}_change"].values:
            assert abs(orders(expansion.number.values[2:5], change[2:5]) - order).max() < 0.1


def test_what_stays_at_slow_speed_vanishes_with_the_relative_roughness(expansion):
    for name, worst in zip(PARTS, (0.05, 0.09, 0.035), strict=True):
        left = expansion[f"{name}_distance"].values[:, 0]
        assert left[0] < worst
        assert 4.6 < left[0] / left[1] < 6.2


def test_the_pressure_of_first_order_carries_no_load_and_that_of_second_order_phi(expansion):
    slow, x = expansion.isel(number=0), expansion.x.values
    first = slow.first_pressure.values
    # What is left is twice the part of second order.
    assert np.abs(first + first[::-1]).max() < 0.01 * first.max()
    kappa = float(expansion.kappa[0])
    load = 2 / np.pi * np.trapezoid(slow.second_pressure.values, x) * kappa**4
    # The solver's share over phi is 1.03 at kappa = 1e-3.
    assert 1.02 < load / float(sb.asymptotics.perturbation.phi(0.1)) < 1.04
