"""Stribeck curves: each point is a solved state, and landmarks lie where independent solves put them."""

import math
from pathlib import Path

import numpy as np
import pytest
from command_line import run_python
from fit_data import TRUE as CONTACT

import stribeck as sb

HEAVY = CONTACT.replace(beta=0.01)  # load group 3.5


@pytest.fixture(scope="module")
def curve():
    return sb.stribeck_curve(CONTACT, points=25)


@pytest.fixture(scope="module")
def published():
    return sb.stribeck_curve(CONTACT, speed=("5 mm/s", "0.2 m/s"), points=9, definition="published")


def friction(speed, definition="balanced", rtol=1e-9):
    """Friction of one state solved from cold."""
    return sb.solve(CONTACT.replace(speed=speed), rtol=rtol).friction(definition=definition).total


# --- the points ---


@pytest.mark.quick
def test_points_lie_exactly_where_they_are_asked_for():
    wanted = [3e-4, 1e-3, 1.5e-3, 7e-3, 0.05]
    curve = sb.stribeck_curve(CONTACT, speed=wanted, points=2)
    assert curve.values.tolist() == wanted
    for value, solution in zip(wanted, curve.solutions, strict=True):
        assert solution.contact.speed == pytest.approx(value, rel=1e-14)
        assert solution.groups.speed == pytest.approx(CONTACT.replace(speed=value).groups.speed, rel=1e-14)


@pytest.mark.quick
def test_a_quasistatic_curve_over_the_load_is_the_dry_friction():
    curve = sb.stribeck_curve(CONTACT.replace(speed=0), load=("5 N/m", "200 N/m"), points=3)
    np.testing.assert_allclose(curve.friction, 0.7, rtol=1e-6)
    assert set(curve.regimes) == {"boundary"}
    assert curve.transitions == ()


# --- the automatic range ---


def test_the_automatic_range_reaches_from_the_plateau_to_the_hydrodynamic_branch(subtests):
    for definition in ["published", "balanced"]:
        with subtests.test(definition=definition):
            curve = sb.stribeck_curve(CONTACT, points=2, definition=definition)
            assert curve.friction[0] == pytest.approx(0.7, rel=1e-3)
            assert curve.friction.asperities[-1] < 1e-3 * curve.friction[-1]
            assert curve.friction[-1] > 3 * curve.minimum.friction


def test_beyond_the_range_of_the_law_the_plateau_is_lower_and_found_too():
    curve = sb.stribeck_curve(HEAVY, points=9)
    slope = np.diff(np.log(curve.friction[:2])) / np.diff(np.log(curve.values[:2]))
    assert abs(slope[0]) < 1e-2
    assert curve.friction[0] < 0.7
    assert curve.friction.asperities[-1] < 1e-3 * curve.friction[-1]


def test_a_smooth_contact_has_no_plateau_and_covers_ten_decades():
    curve = sb.stribeck_curve(load=0.1, roughness=0, points=3)
    np.testing.assert_allclose(curve.values, [1e-9, 1e-4, 10], rtol=1e-12)
    assert (curve.friction.asperities == 0).all()


# --- minimum and transitions ---


def test_the_minimum_lies_where_the_slope_of_cold_solves_vanishes(subtests, curve, published):
    for definition in ["published", "balanced"]:
        with subtests.test(definition=definition):
            found = {"published": published, "balanced": curve}[definition].minimum
            step = 0.02

            def slope(s):
                f = [math.log(friction(math.exp(s + k * step), definition, 1e-10)) for k in (-2, -1, 1, 2)]
                return (f[0] - 8 * f[1] + 8 * f[2] - f[3]) / (12 * step)

            s = math.log(found.value)
            # The straight line through two slopes at a small distance: its zero is that of the slope to second order in it.
            low, high = slope(s - 1e-4), slope(s + 1e-4)
            assert low < 0 < high
            root = s - 1e-4 + 2e-4 * low / (low - high)
            assert root == pytest.approx(s, abs=1e-6)


@pytest.mark.quick
def test_the_minimum_does_not_depend_on_the_points_of_the_curve(curve):
    for ends, points in ((("20 mm/s", "40 mm/s"), 2), (("27.53 mm/s", "27.68 mm/s"), 101)):
        other = sb.stribeck_curve(CONTACT, speed=ends, points=points)
        assert other.minimum.value == pytest.approx(curve.minimum.value, rel=1e-6)
        assert other.minimum.friction == pytest.approx(curve.minimum.friction, rel=1e-7)


@pytest.mark.quick
def test_transitions_lie_where_cold_solves_have_these_shares(curve):
    marks = {mark.name: mark for mark in curve.transitions}
    assert list(marks) == [
        "fluid carries 5 % of the load",
        "fluid carries 50 % of the load",
        "minimum of friction",
        "asperities cause 10 % of the friction",
    ]
    assert [mark.value for mark in curve.transitions] == sorted(mark.value for mark in curve.transitions)
    for name, share in (("fluid carries 5 % of the load", 0.05), ("fluid carries 50 % of the load", 0.5)):
        alone = sb.solve(CONTACT.replace(speed=marks[name].value), rtol=1e-9)
        assert alone.fluid_load_share == pytest.approx(share, abs=1e-7)
        assert marks[name].friction == pytest.approx(alone.friction().total, rel=1e-7)
    alone = sb.solve(CONTACT.replace(speed=marks["asperities cause 10 % of the friction"].value), rtol=1e-9).friction()
    assert alone.asperities / alone.total == pytest.approx(0.1, abs=1e-7)


@pytest.mark.quick
def test_regimes_follow_one_another_and_meet_at_the_transitions(curve):
    ranges = curve.regime_ranges
    assert [name for name, _, _ in ranges] == ["boundary", "mixed", "hydrodynamic"]
    assert (ranges[0][1], ranges[-1][2]) == (curve.values[0], curve.values[-1])
    assert [low for _, low, _ in ranges[1:]] == [high for _, _, high in ranges[:-1]]
    marks = {mark.name: mark.value for mark in curve.transitions}
    assert ranges[0][2] == marks["fluid carries 5 % of the load"]
    assert ranges[1][2] == marks["asperities cause 10 % of the friction"]
    for value, regime in zip(curve.values, curve.regimes, strict=True):
        assert [name for name, low, high in ranges if low <= value <= high] == [regime]


def test_regimes_of_few_points_meet_at_the_same_places(subtests, curve):
    """Where the load is shared in halves no regime ends; and between two points a whole regime may lie."""
    for points in [2, 5]:
        with subtests.test(points=points):
            for (name, low, high), (other, from_, to) in zip(
                curve.sampled(points).regime_ranges, curve.regime_ranges, strict=True
            ):
                assert (name, low, high) == (other, pytest.approx(from_, rel=1e-5), pytest.approx(to, rel=1e-5))


def test_where_asperities_hardly_rub_no_mixed_regime_is_put_between_two_points():
    groups = sb.Groups(1e-3, 0.1, 1e-2)
    curve = sb.stribeck_curve(groups, speed=np.geomspace(1e-5, 1, 5), boundary_friction=1e-3, beta=1.0).sampled(2)
    (boundary, _, end), (film, start, _) = curve.regime_ranges
    assert (boundary, film, end) == ("boundary", "hydrodynamic", start)
    assert start == curve.landmark("hydrodynamic_start").value


def test_regimes_of_a_curve_over_the_roughness_run_the_other_way():
    curve = sb.stribeck_curve(CONTACT, roughness=("0.02 um", "10 um"), points=7)
    assert [name for name, _, _ in curve.regime_ranges] == ["hydrodynamic", "mixed", "boundary"]


# --- notes ---


def test_notes_say_which_points_they_concern():
    curve = sb.stribeck_curve(HEAVY, speed=("1 um/s", "10 m/s"), points=6)
    load = [note for note in curve.notes if note.startswith("The load group is")]
    assert len(load) == 1
    # At 10 m/s and 0.4 m/s the fluid carries all.
    assert load[0].endswith("(4 of 6 points, speed 1 µm/s to 15.8 mm/s.)")
    outside = next(note for note in curve.notes if "which ends at about" in note)
    concerned = [s for s in curve.solutions if any("which ends at about" in note for note in s.notes)]
    assert 0 < len(concerned) < 6
    assert f"({len(concerned)} of 6 points, speed 1 µm/s to " in outside


# --- refused ---


@pytest.mark.quick
def test_arguments_that_cannot_be_are_refused(subtests):
    for arguments, words in [
        ({"points": 1}, "points = 1; it must be a whole number"),
        ({"points": 2.5}, r"points = 2\.5; it must be a whole number"),
        ({"speed": (1, 0.1)}, r"speed = \(1, 0\.1\); a range is two or more finite positive increasing numbers"),
        ({"speed": (-1, 1)}, "finite positive increasing numbers"),
        ({"speed": (1, math.nan)}, "speed = nan is not a finite number"),
        ({"speed": ("1 mm", "1 m")}, "speed = '1 mm' is a length"),
        ({"load": ("1 N", "2 N")}, "load = '1 N' is a force"),
        ({"speed": (1, 2), "load": (1, 2)}, "speed and load are both ranges"),
        ({"rtol": 1e-20}, "rtol = 1e-20; it must be a number from 1e-11"),
        ({"definition": "mine"}, "definition = 'mine' must be 'balanced' or 'published'"),
        ({"boundary_friction": -1}, "boundary_friction = -1 must be zero or positive"),
    ]:
        with subtests.test(arguments=arguments, words=words):
            with pytest.raises(sb.InputError, match=words):
                sb.stribeck_curve(CONTACT, **arguments)


def test_a_number_that_no_solution_has_is_refused_with_those_that_there_are(curve):
    with pytest.raises(
        sb.InputError, match="name = 'height'; it must be the name of a number of every solution, such as .*viscous_balanced"
    ):
        curve.observable("height")
    of_atlas = sb.stribeck_curve(CONTACT, points=5, method="atlas")
    with pytest.raises(sb.InputError, match="name = 'height'; the atlas has (?!.*viscous).*central_gap"):
        of_atlas.observable("height")
    assert set(of_atlas.observables) < set(curve.observables)


def test_groups_that_are_missing_or_both_zero_are_named():
    with pytest.raises(sb.InputError, match="roughness missing; give a LineContact or PointContact, or the groups"):
        sb.stribeck_curve(load=0.1)
    with pytest.raises(sb.InputError, match="speed and roughness are both zero"):
        sb.stribeck_curve(sb.Groups(0, 0.1, 0), load=(0.1, 1))


# --- interrupted, lost ---


@pytest.mark.quick
def test_an_interrupted_curve_keeps_the_points_it_has():
    def stop(done, total):
        if done == 3:
            raise KeyboardInterrupt

    whole = sb.stribeck_curve(load=0.1, roughness=1e-3, speed=(1e-4, 1), points=7)
    part = sb.stribeck_curve(load=0.1, roughness=1e-3, speed=(1e-4, 1), points=7, on_point=stop)
    assert part.outcome is sb.Outcome.INTERRUPTED
    assert (len(part), part.requested) == (3, 7)
    assert part.values.tolist() == whole.values[-3:].tolist()
    # As many points of an interval as are asked for are one matrix product, which rounds by its shape.
    np.testing.assert_allclose(part.friction, whole.friction[-3:], rtol=1e-14)


# --- resources ---

MEMORY = """
import sys
import stribeck as sb
curve = sb.stribeck_curve(load=0.1, roughness=1e-4, speed=(1e-9, 10), points=101)
assert len(curve) == 101
curve.to_dataset()
curve.plot(sys.argv[1])
# Not ru_maxrss, in which the process that started this one may count.
with open("/proc/self/status") as status:
    [peak] = [line.split()[1] for line in status if line.startswith("VmHWM:")]
print(int(peak) / 1024)
"""


@pytest.mark.slow
@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="needs Linux to measure memory")
def test_a_curve_with_dataset_and_picture_stays_below_300_megabytes(tmp_path):
    answer = run_python(MEMORY, tmp_path / "curve.png")
    assert answer.code == 0, answer.err
    assert float(answer.out) < 300


def test_a_curve_does_not_end_where_the_central_gap_bends_most():
    # There the panel at zero alone is too wide for the gap in its middle.
    curve = sb.stribeck_curve(load=0.4, roughness=4e-5, speed=np.logspace(-9, 2, 34), rtol=1e-7)
    assert curve.outcome.ok and len(curve) == 34
    assert curve.error_estimate <= 1e-7


@pytest.mark.slow
def test_nodes_that_rounding_makes_one_divide_nothing_by_zero():
    # Warnings are errors here; the film is thinnest at a kink, around which panels are as narrow as rounding lets them.
    groups = sb.Groups(3.688212788240314e-06, 0.0858, 0.4741578500804608)
    curve = sb.stribeck_curve(groups, load=(0.00040470158148482306, 18.19043658207579), points=3, rtol=0.0050714071597535194)
    assert 1 <= len(curve) <= 3
