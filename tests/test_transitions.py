"""Mixed lubrication by formulas: contact share, friction and its minimum, the transitions and where they merge."""

import math
from functools import cache

import numpy as np
import pytest

import stribeck as sb
from stribeck.asymptotics import OutOfRangeWarning, constants, mixed, transitions

C = constants.FILM_CONSTANT


def state(film_ratio, kappa, load):
    """Return the groups of a state by its film ratio."""
    return sb.Groups((film_ratio * kappa / C) ** (5 / 3), load, kappa * load)


@cache
def minimum(kappa, load):
    return sb.stribeck_curve(load=load, roughness=kappa * load, points=41, rtol=1e-6, definition="published").minimum


# --- contact share and friction with a film ---


def test_our_contact_share_and_friction_know_outlet_and_thickened_film(subtests):
    for load, kappa in ((2e-3, 3e-4), (2e-3, 1e-2), (0.2, 3e-4), (0.2, 1e-2)):
        for film_ratio in (3, 8):
            with subtests.test(load=load, kappa=kappa, film_ratio=film_ratio):
                groups = state(film_ratio, kappa, load)
                solved = sb.solve(groups)
                friction = solved.friction(boundary_friction=1, beta=1, definition="published").total
                ours, paper, central = (
                    mixed.contact_load_share(groups, *film) / solved.contact_load_share - 1
                    for film in ((), ("large",), ("central",))
                )
                assert abs(ours) < 0.09
                assert abs(mixed.friction(groups) / friction - 1) < 0.09
                if film_ratio == 3:
                    assert paper > 0.2 and abs(ours) < 0.2 * paper
                # The better central film alone loses what the outlet adds.
                assert central < paper


def test_the_film_with_asperities_is_the_law_of_the_paper_where_both_are_small():
    # Neither outlet nor inlet count for a thin, strong film, but both vanish slowly.
    thin = sb.Groups(1e-22, 0.5, 0.5 * C * 1e-22**0.6 / 14)
    ours = mixed.contact_load_share.function(thin)
    assert ours == pytest.approx(mixed.contact_load_share.function(thin, "large"), rel=0.02)
    assert ours == pytest.approx(4 / math.pi * 0.5**-0.5 * math.exp(-14), rel=0.02)


def test_the_contact_share_solves_its_implicit_equation():
    groups = state(4, 1e-3, 1e-2)
    share = mixed.contact_load_share(groups)
    unsaturated = (share**-mixed.SATURATION_COEFFICIENT - 1) ** (-1 / mixed.SATURATION_COEFFICIENT)
    central = mixed.contact_load_share(groups, "central")
    ratio = -math.log(central * math.pi / 4 * groups.load**0.5)
    u = groups.speed**0.4
    outlet = 1 + mixed.OUTLET_COEFFICIENTS[0] * u**1.5 + mixed.OUTLET_COEFFICIENTS[1] * u * ratio ** (8 / 3)
    assert unsaturated == pytest.approx(
        central * outlet * math.exp(-mixed.FEEDBACK_COEFFICIENT * unsaturated / groups.speed**0.2), rel=1e-9
    )


def test_the_friction_of_the_paper_is_the_printed_equation_with_its_constant():
    groups = sb.Groups(3e-5, 0.05, 0.05 * 3e-4)
    for c, printed in ((0.44, True), (C, False)):
        by_hand = 4 * 0.3 / math.pi * 0.05**-0.5 * math.exp(-c * 3e-5**0.6 / 3e-4)
        by_hand += 4 * 0.07 / (c * 3 * math.pi) * 3e-5**0.4 * 0.05**0.5
        assert mixed.friction.function(groups, 0.3, 0.07, "large", printed=printed) == pytest.approx(by_hand, rel=1e-12)
    # What is printed knows one film, whatever else is asked for.
    for law in (mixed.friction, mixed.contact_load_share):
        assert law.function(groups, printed=True) == law.function(groups, film="large", printed=True)


def test_the_lean_of_the_contact_pressure_is_what_the_two_definitions_differ_by():
    groups = state(6, 1e-3, 0.1)
    solved = sb.solve(groups, rtol=1e-8)
    published, balanced = (solved.friction(boundary_friction=1, beta=1, definition=d).fluid for d in ("published", "balanced"))
    lean = mixed.friction.function(groups, 0.0, 1.0) - mixed.friction.function(groups, 0.0, 1.0, "central")
    assert lean == pytest.approx(published - balanced, rel=0.1)


# --- the minimum ---


def test_lambert_w_gives_the_ratio_at_which_the_slope_vanishes():
    groups = sb.Groups(1.0, 0.1, np.array([1e-7, 1e-4, 3e-2]))
    k = transitions.weakening_number(groups, 0.5, 2.0)
    by_hand = 2 / (9 * C ** (5 / 3)) * 4 * groups.roughness ** (2 / 3) * 0.1 ** (1 / 3)
    np.testing.assert_allclose(k, by_hand, rtol=1e-12)
    ratio = transitions.separation_at_minimum.function(groups, 0.5, 2.0, "exact")
    np.testing.assert_allclose(ratio ** (1 / 3) * np.exp(-ratio), k, rtol=1e-12)
    assert (ratio > 1 / 3).all()
    for near in (0.999, 1.001):
        speed = (near * groups.relative_roughness * ratio / C) ** (5 / 3)
        there = mixed.friction.function(sb.Groups(speed, 0.1, groups.roughness), 0.5, 2.0, "large")
        assert (there > transitions.friction_at_minimum.function(groups, 0.5, 2.0, "exact")).all()
    speed = transitions.speed_at_minimum.function(groups, 0.5, 2.0, "exact")
    lowest = mixed.friction.function(sb.Groups(speed, 0.1, groups.roughness), 0.5, 2.0, "large")
    np.testing.assert_allclose(transitions.friction_at_minimum.function(groups, 0.5, 2.0, "exact"), lowest, rtol=1e-12)


def test_beyond_the_branch_of_lambert_w_there_is_no_minimum():
    limit = transitions.MAX_WEAKENING
    assert limit == pytest.approx(0.4968, abs=5e-5)
    edge = transitions.roughness_without_minimum(0.1, criterion="weakening")
    for factor, present in ((0.999, True), (1.001, False)):
        groups = sb.Groups(1.0, 0.1, factor * edge)
        assert transitions.has_minimum(groups, form="exact") == present
        ratio = transitions.separation_at_minimum.function(groups, form="exact")
        assert np.isreal(ratio) and (ratio > 1 / 3 if present else math.isnan(ratio))
        speeds = np.geomspace(1e-3, 1e5, 4001)
        friction = mixed.friction.function(sb.Groups(speeds, 0.1, factor * edge), film="large")
        assert (np.diff(friction) < 0).any() == present
    with pytest.warns(OutOfRangeWarning, match="is undefined"):
        assert math.isnan(transitions.speed_at_minimum(sb.Groups(1.0, 0.1, 1.001 * edge), form="exact"))


def test_our_minimum_is_stationary():
    groups = sb.Groups(1.0, 0.05, np.array([[1e-6], [1e-4]]))
    speed = transitions.speed_at_minimum(groups, 0.7, 0.4)
    assert np.shape(speed) == (2, 1)
    beside = [mixed.friction.function(sb.Groups(f * speed, 0.05, groups.roughness), 0.7, 0.4) for f in (1 / 1.001, 1, 1.001)]
    assert (beside[0] > beside[1]).all() and (beside[2] > beside[1]).all()


# --- where the transitions merge ---


def test_the_plateau_is_reached_where_merging_says():
    load = np.array([1e-3, 0.1, 0.5])
    edge = transitions.roughness_without_minimum(load, 0.3, 0.2, "plateau")
    lowest = transitions.friction_at_minimum.function(sb.Groups(1.0, load, edge), 0.3, 0.2, "exact")
    np.testing.assert_allclose(lowest, 0.3, rtol=1e-10)


def test_the_lines_meet_where_merging_says():
    load = np.array([1e-3, 0.1, 0.5])
    edge = transitions.roughness_without_minimum(load, 0.3, 0.2, "lines")
    groups = sb.Groups(1.0, load, edge)
    np.testing.assert_allclose(
        transitions.speed_at_minimum.function(groups, 0.3, 0.2, "exact"),
        transitions.speed_boundary_to_mixed.function(groups),
        rtol=1e-10,
    )


def test_our_minimum_disappears_where_merging_says():
    for load in (1e-2, 0.1):
        edge = transitions.roughness_without_minimum(load)
        assert transitions.has_minimum(sb.Groups(1.0, load, 0.999 * edge))
        assert not transitions.has_minimum(sb.Groups(1.0, load, 1.001 * edge))


def test_which_criterion_of_merging_is_near_the_solver():
    # Relative roughness at which the solved curve loses its minimum, and what the formulas say of it.
    grid = {"load": [1e-2, 0.1], "roughness": 1e-3, "speed": 1e-3, "merging": True}
    diagram = sb.phase_diagram(**grid, boundary_friction=1.0, beta=1.0, rtol=1e-5, definition="published")
    solved = diagram.roughness_without_minimum.values
    np.testing.assert_allclose(solved / [1e-2, 0.1], [0.343, 0.160], atol=1e-3)
    over = {
        name: transitions.roughness_without_minimum(np.array([1e-2, 0.1]), criterion=name) / solved
        for name in ("uniform", "plateau", "lines", "weakening")
    }
    np.testing.assert_allclose(over["uniform"], [0.87, 0.72], atol=0.01)
    np.testing.assert_allclose(over["plateau"], [7.84, 4.03], atol=0.03)
    np.testing.assert_allclose(over["lines"], [1.96, 9.95], atol=0.05)
    np.testing.assert_allclose(over["weakening"], [1294, 87.7], rtol=0.01)


def test_friction_without_a_viscous_part_falls_for_ever_and_has_no_minimum():
    groups = sb.Groups(1.0, 0.1, 1e-4)
    assert transitions.has_minimum(groups) and not transitions.has_minimum(groups, beta=0.0)
    with pytest.warns(OutOfRangeWarning, match="is undefined"):
        assert np.isnan(transitions.speed_at_minimum(groups, beta=0.0))


def test_an_unknown_criterion_is_refused_by_name_and_what_is_never_met_is_nan():
    with pytest.raises(sb.InputError, match="'uniform', 'plateau', 'lines', 'weakening'"):
        transitions.roughness_without_minimum(0.1, criterion="slope")
    assert np.isnan(transitions.roughness_without_minimum(np.array([2.0, 3.0]), criterion="lines")).all()
    assert math.isnan(transitions.roughness_without_minimum(5.0, criterion="plateau"))
