"""A curve as a function: within its stated errors anywhere, whatever points it was sampled at."""

import math
from dataclasses import replace

import numpy as np
import pytest
from fit_data import TRUE as CONTACT

import stribeck as sb

SEED = 61_441
NAMES = (
    *("contact_load_share", "fluid_load_share", "central_gap", "minimum_gap", "flux_gap", "offset"),
    *("viscous_published", "viscous_balanced"),
)


def worst(curve, value, groups, rtol=1e-9, **parts):
    """Return the largest error of a curve at a value, over what it states and what a cold solve leaves."""
    here, exact = curve.at(value), sb.solve(groups, rtol=rtol, **parts)
    ratios = []
    for name in NAMES:
        true = getattr(exact.observables, name)
        scale = 1.0 if name.endswith("share") else max(abs(true), 5e-3 if name == "offset" else 0.0)
        ratios.append(abs(here.values[name] - true) / scale / (here.errors[name] + rtol))
    return max(ratios)


@pytest.fixture(scope="module")
def curve():
    return sb.stribeck_curve(CONTACT, points=5)


def test_a_curve_is_within_its_stated_errors_between_the_solved_states(subtests):
    for load, roughness in [(0.1, 1e-4), (1e-4, 0.0)]:
        with subtests.test(load=load, roughness=roughness):
            curve = sb.stribeck_curve(load=load, roughness=roughness, speed=(1e-6, 1e-1), points=2)
            rng = np.random.default_rng(SEED)
            assert curve.outcome.ok
            ratios = [
                worst(curve, v, sb.Groups(v, load, roughness)) for v in np.exp(rng.uniform(*np.log([1e-6, 1e-1]), 3)).tolist()
            ]
            assert max(ratios) < 2 and np.median(ratios) < 1


def test_it_is_a_function_of_load_and_roughness_too(subtests):
    for over, ends in [("load", (0.01, 0.8)), ("roughness", (1e-5, 1e-2))]:
        with subtests.test(over=over, ends=ends):
            fixed = {"speed": 1e-3, "load": 0.1, "roughness": 1e-3} | {over: ends}
            curve = sb.stribeck_curve(**fixed, points=2)
            for value in np.exp(np.random.default_rng(SEED).uniform(*np.log(ends), 2)).tolist():
                assert worst(curve, value, sb.Groups(**(fixed | {over: value}))) < 2


def test_contacts_at_rest_are_functions_as_well(subtests):
    for over in ["load", "roughness"]:
        with subtests.test(over=over):
            ends = {"load": (1e-3, 0.9), "roughness": (1e-5, 1e-2)}[over]
            fixed = {"speed": 0.0, "load": 0.1, "roughness": 1e-3} | {over: ends}
            curve = sb.stribeck_curve(**fixed, points=2)
            for value in (0.3, 0.05, 4e-3) if over == "load" else (3e-4, 4e-3):
                exact = sb.solve(sb.Groups(**(fixed | {over: value})), rtol=1e-9)
                here = curve.at(value)
                kappa = exact.groups.relative_roughness
                assert here.central_gap == pytest.approx(exact.central_gap, rel=2e-6, abs=2e-9 * kappa)
                assert here.offset == pytest.approx(exact.offset, rel=2e-6, abs=2e-9)
                assert here.flux_gap == pytest.approx(exact.flux_gap, rel=2e-6, nan_ok=True)


@pytest.mark.quick
def test_numbers_give_numbers_and_arrays_arrays(curve):
    one, many = curve.at("5 mm/s"), curve.at([0.005, "8 mm/s"])
    assert isinstance(one.friction, float) and isinstance(one.central_gap, float) and one.value == 0.005
    assert many.friction.shape == many.errors["central_gap"].shape == (2,)
    assert many.friction[0] == pytest.approx(one.friction, rel=1e-13)
    assert one.friction == one.friction.asperities + one.friction.fluid
    assert set(dir(one)) >= {"flux_gap", "friction"}
    with pytest.raises(AttributeError, match="no attribute 'film'"):
        _ = one.film


def test_marks_are_read_off_a_coarse_curve_within_their_errors_and_polished_on_states_by_default(curve):
    coarse = sb.stribeck_curve(CONTACT, points=200, rtol=1e-4)
    read = {name: coarse.landmark(name, coarse.rtol) for name in (mark.name for mark in curve.transitions)}
    for name, mark in read.items():
        exact = curve.landmark(name)
        assert abs(np.log(mark.value / exact.value)) <= mark.error + exact.error < 1e-2
    least_known = max(read, key=lambda name: read[name].error)
    assert coarse.landmark(least_known).error < 0.2 * read[least_known].error


def test_a_curve_is_sampled_anew_without_a_state(curve):
    finer = curve.sampled(23)
    assert len(finer) == finer.requested == 23 and finer.states == curve.states
    assert finer.values[[0, -1]] == pytest.approx(curve.values[[0, -1]], rel=1e-12)
    there = curve.at(finer.values[1:-1])
    assert (np.abs(finer.friction[1:-1] - there.friction) <= there.friction.error).all()
    with pytest.raises(sb.InputError, match="a whole number from 2"):
        curve.sampled(1)


def test_fields_are_solved_where_they_are_asked_for(curve):
    solution = curve.solve_at("7 mm/s")
    alone = sb.solve(CONTACT.replace(speed=0.007), rtol=1e-9)
    assert solution.error_estimate <= curve.rtol
    x = np.linspace(-2, 2, 41)
    for name in ("gap", "fluid_pressure", "contact_pressure"):
        found, exact = (getattr(s.profile(x), name) for s in (solution, alone))
        np.testing.assert_allclose(found, exact, atol=1e-3 * np.abs(exact[10:31]).max())


@pytest.mark.slow
def test_a_state_that_rounding_limits_hands_its_mesh_on_with_its_inverse():
    """The next state had been begun on the mesh before, whose inverse has another size."""
    curve = sb.stribeck_curve(sb.Groups(1.0, 0.1, 1e-6), speed=(1e-7, 2e-6), rtol=1e-10, points=3)
    # Whether rounding leaves the slowest state its tolerance, too, is chance.
    assert curve.outcome in (sb.Outcome.CONVERGED, sb.Outcome.ROUNDING) and any("Rounding" in note for note in curve.notes)
    assert len(curve) > 1
    for speed, friction in zip(curve.values, curve.friction.total, strict=True):
        alone = sb.solve(sb.Groups(float(speed), 0.1, 1e-6), rtol=1e-10, on_failure="return")
        assert friction == pytest.approx(float(alone.friction()), rel=1e-9)


def test_films_as_thin_as_rounding_take_few_states():
    curve = sb.stribeck_curve(load=0.1, roughness=0.0, speed=(1e-11, 3e-11), points=2, rtol=1e-7)
    assert curve.states <= 6 and curve.error_estimate <= 1e-7


@pytest.mark.quick
def test_values_that_the_curve_does_not_hold_are_refused(subtests, curve):
    for value, words in [
        (10.0, "speed = 10.0 is outside the curve, which runs from speed .* compute a curve that contains it"),
        ([0.005, 1e-12], "is outside the curve"),
        (-1.0, "speed = -1.0 must be finite and positive"),
        ("5 mm", "speed = '5 mm' is a length"),
        ("fast", "speed = 'fast'"),
    ]:
        with subtests.test(value=value, words=words):
            with pytest.raises(sb.InputError, match=words):
                curve.at(value)
    with pytest.raises(sb.InputError, match="give one value"):
        curve.solve_at([0.005, 0.006])


GROUPS, THINS, ROUGH = sb.Groups(1e-3, 0.1, 1e-4), sb.fluids.Carreau(0.02, 0.5), sb.fluids.PatirCheng(2.0)
FEW_STATES = {
    "a kept mesh resolves the gap on the way too": (GROUPS, {"speed": (1e-9, 10.0)}, 15),
    "a film that ends": (GROUPS, {"speed": (1e-5, 1e-1), "cavitation": "exit"}, 40),
    "a film that stiffens": (GROUPS, {"speed": (1e-5, 1e-1), "fluid": sb.fluids.Barus(1.0)}, 8),
    "a film that thins": (GROUPS, {"speed": (5e-3, 5e-2), "fluid": THINS}, 19),
    "the end of the fits of the flow": (sb.Groups(1.0, 0.1, 0.02), {"speed": (1e-3, 1.0), "flow_factors": ROUGH}, 18),
    "thicker than the asperities": (sb.Groups(1e-3, 0.1, 3e-5), {"roughness": (1e-6, 1e-4), "slide_to_roll": 1.0}, 19),
    "a vanishing difference": (sb.Groups(1.0, 0.1, 0.0), {"speed": (1e2, 1e8)}, 59),
}
"""Curves, and how many states they may take: the first mesh, which is chance, makes it up to three more or fewer."""


def test_curves_take_few_states_and_are_right_between_them(subtests):
    for name, (groups, given, most) in FEW_STATES.items():
        with subtests.test(name=name):
            curve = sb.stribeck_curve(groups, points=2, rtol=1e-4 if "roughness" in given else 1e-6, **given)
            assert curve.outcome.ok and curve.states <= most
            middle = math.sqrt(curve.values[0] * curve.values[-1])
            assert worst(curve, middle, curve.solve_at(middle).groups, 1e-8) < 2


def table_law():
    s = np.linspace(0.05, 6.0, 40)
    return sb.contact_laws.TableLaw(s, np.exp(-s) + 0.3 * np.exp(-3 * s))


def test_a_curve_under_the_law_of_persson_takes_few_states_to_a_small_tolerance():
    law = sb.surfaces.persson_law(sb.surfaces.SelfAffine(h_rms=1e-6, q0=1e4, q1=1e9, hurst=0.8))
    groups = sb.Groups(1.0, 0.01, 1e-4, law=law)
    curve = sb.stribeck_curve(groups, speed=(4e-3, 1e-2), points=2, rtol=1e-9)
    assert curve.states <= 12
    assert worst(curve, 6e-3, replace(groups, speed=6e-3), 1e-10) < 2


@pytest.mark.slow
@pytest.mark.parametrize(
    ("law", "load", "kappa", "rtol"),
    [
        (None, 0.025, 4e-4, 1e-6),
        (table_law(), 0.03, 9e-3, 1e-6),
        (None, 5e-4, 0.3, 1e-9),
        (sb.contact_laws.GreenwoodTripp(), 0.3, 2e-3, 1e-6),
    ],
)
def test_a_whole_curve_is_within_three_times_its_stated_errors_and_nearly_everywhere_within_them(law, load, kappa, rtol):
    groups = sb.Groups(1.0, load, kappa * load, law=law)
    curve = sb.stribeck_curve(groups, points=2, rtol=rtol)
    speeds = np.exp(np.random.default_rng(SEED).uniform(*np.log(curve.values[[0, -1]]), 25)).tolist()
    ratios = [worst(curve, speed, replace(groups, speed=speed), max(1e-10, min(1e-9, 0.1 * rtol))) for speed in speeds]
    assert max(ratios) < 3 and np.mean(np.array(ratios) < 1) > 0.9


@pytest.mark.slow
def test_a_curve_goes_through_the_speed_at_which_a_cavity_opens():
    """At 159 um/s: the curve ended there, and took hundreds of states to come so far."""
    inputs = {"radius": 0.01, "modulus": 2.1e6, "load": 50.0, "viscosity": 0.05, "speed": 0.02, "roughness": 1e-6}
    contact = sb.LineContact(**inputs, alpha=2.0, beta=0.06, boundary_friction=0.8, cavitation="reform", cavity_pressure=-5e3)
    curve = sb.stribeck_curve(contact, speed=(1.5e-4, 1.8e-4))
    assert curve.outcome.ok and curve.states < 15
    for speed in (1.52e-4, 1.65e-4):
        solved, read = sb.solve(contact.replace(speed=speed)), curve.at(speed)
        assert math.isnan(read.reformation_position) == math.isnan(solved.reformation_position) == (speed < 1.58e-4)
        for name in ("contact_load_share", "minimum_gap", "flux_gap", "viscous_balanced"):
            true = abs(read.values[name] - getattr(solved.observables, name))
            scale = 1.0 if "share" in name else getattr(solved.observables, name)
            stated = read.errors[name] + solved.errors[name]
            # Where the cavity opens the minimum film moves to its end, and between states its error is a few percent.
            assert true / scale < 3 * stated < (0.2 if name == "minimum_gap" else 1e-3)


def test_a_landmark_is_asked_for_by_a_short_name_and_another_is_refused(curve):
    mark = curve.landmark("equal_shares")
    assert mark is not None
    assert mark == curve.landmark("fluid carries 50 % of the load")
    with pytest.raises(sb.InputError, match="boundary_end"):
        curve.landmark("half")


def test_a_curve_with_a_cavity_at_ambient_pressure_is_that_of_a_film_that_ends():
    contact = CONTACT.replace(cavitation="reform")
    curve = sb.stribeck_curve(contact, points=5, rtol=1e-4)
    ends = sb.stribeck_curve(CONTACT.replace(cavitation="exit"), points=5, rtol=1e-4)
    assert curve.states == ends.states
    np.testing.assert_allclose(curve.friction(), ends.friction(), rtol=1e-12)
    speed = float(curve.values[2])
    assert math.isnan(curve.at(speed).reformation_position)
    states = [curve.solve_at(speed), curve.solutions[2], *(mark.solution for mark in curve.transitions)]
    assert len(states) > 3 and {state.groups.model.cavitation for state in states} == {"reform"}


def test_a_dataset_of_a_curve_holds_what_is_read_off_it_and_nothing_for_which_each_point_were_solved():
    pytest.importorskip("xarray")
    curve = sb.stribeck_curve(CONTACT, points=5, rtol=1e-4)
    found = set(curve.to_dataset())
    assert {"central_film_thickness", "central_film_thickness_error", "lambda_ratio"} <= found
    assert not found & {"maximum_pressure", "friction_hysteresis"}
