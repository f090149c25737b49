"""Films that end: states through `solve` against an independent solver, and what follows from their equations."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

import stribeck as sb

REFERENCE = json.loads((Path(__file__).parent / "data" / "fluids.json").read_text())


@pytest.mark.quick
def test_a_rigid_film_that_ends_is_that_of_the_textbook():
    solution = sb.solve(sb.Groups(1e6, 0.1, 0.0), cavitation="exit")
    gap = solution.central_gap
    assert solution.exit_position / np.sqrt(2 * gap) == pytest.approx(0.47512992, rel=1e-5)
    assert solution.flux_gap / gap == pytest.approx(1.22574844, rel=1e-5)
    assert 3 * np.pi**2 / 4 * gap / 1e6 * 4 / np.pi == pytest.approx(2.44748424, rel=1e-5)


@pytest.mark.quick
def test_pressure_and_gradient_vanish_at_the_exit_and_the_cavity_is_at_ambient_pressure():
    solution = sb.solve(sb.Groups(1e-3, 0.1, 1e-4), cavitation="exit")
    x_c = solution.exit_position
    behind = solution.profile(x_c + np.array([1e-6, 0.1, 1.0, 30.0])).fluid_pressure
    before = solution.profile(x_c - np.array([1e-3, 1e-4])).fluid_pressure
    assert not behind.any()
    assert 0 < before[1] < 0.015 * before[0]  # as the square of the distance
    assert solution.fluid_pressure.min() > -1e-9


def test_a_thin_film_is_cut_where_its_pressure_falls_to_zero():
    """Cut at the next of evenly spaced places, the film ended beyond a layer that no mesh resolved, and nothing was found."""
    beyond = [sb.solve(sb.Groups(speed, 3.26e-6, 0.0), cavitation="exit").exit_position - 1 for speed in (1.2e-12, 2.2e-12)]
    assert math.log(beyond[1] / beyond[0]) / math.log(2.2 / 1.2) == pytest.approx(0.4, abs=1e-3)


@pytest.mark.slow
def test_random_cold_starts_of_films_that_end_are_solved_and_their_errors_covered():
    rng, missed, states = np.random.default_rng(20_261), 0, 200
    for _ in range(states):
        load = 10 ** rng.uniform(-8, 1)
        kappa = 0.0 if rng.random() < 0.15 else 10 ** rng.uniform(-6, 3)
        groups = sb.Groups(10 ** rng.uniform(-12, 6), load, kappa * load)
        coarse, fine = (sb.solve(groups, cavitation="exit", rtol=rtol, on_failure="return") for rtol in (1e-6, 1e-8))
        ratios = []
        for name, error in coarse.errors.items():
            value, exact = getattr(coarse, name), getattr(fine, name)
            least = 1.0 if "share" in name or name == "exit_position" else 1e-3 if name == "offset" else 0.0
            if value != exact:  # the share of smooth surfaces is zero, without an error
                ratios.append(abs(value - exact) / max(least, abs(exact)) / (error + fine.errors[name]))
        missed += np.nanmax(ratios) > 1
        assert np.nanmax(ratios) < 30, groups
    assert missed <= 0.05 * states


def test_the_minimum_of_friction_of_a_film_that_ends_is_that_of_an_independent_solver():
    curve = sb.stribeck_curve(sb.Groups(1e-3, 0.1, 1e-4), speed=np.geomspace(3e-4, 3e-3, 5), cavitation="exit")
    speed, friction = REFERENCE["friction_minimum"]["0.1,0.001"]["free_exit"]
    assert curve.minimum.friction == pytest.approx(friction, rel=1e-6)
    assert curve.minimum.value == pytest.approx(speed, rel=1e-3)  # the minimum is flat


def test_a_cavity_closes_as_the_root_of_the_suction_that_is_too_large():
    """Close to the speed at which the film ceases to rupture, where no path from a film that ends leads."""
    parts = {"cavitation": "reform", "cavity_pressure": -0.0864869}
    lengths = []
    for speed in (4.895e-4, 4.925e-4, 5.0e-4):
        s = sb.solve(sb.Groups(speed, 0.21052, 3.4722e-3), **parts, rtol=1e-5)
        lengths.append(s.reformation_position - s.exit_position)
    assert 0 < lengths[0] < 0.012
    squares = np.diff(np.square(lengths)) / np.diff([4.895e-4, 4.925e-4, 5.0e-4])
    assert squares[0] == pytest.approx(squares[1], rel=0.15)
    assert np.isnan(sb.solve(sb.Groups(4.87e-4, 0.21052, 3.4722e-3), **parts).exit_position)


def test_a_cavity_under_a_rigid_film_goes_with_the_square_root_of_the_speed():
    """Both its ends over the root of the gap; lost as long as steps moved the exit by a third of the contact at most."""
    found = []
    for speed, pressure in ((1e5, -1e-3 * np.sqrt(10)), (1e6, -1e-3)):
        state = sb.solve(sb.Groups(speed, 0.1, 0.0), cavitation="reform", cavity_pressure=pressure)
        ends = np.array([state.exit_position, state.reformation_position])
        found.append([*ends / np.sqrt(state.central_gap), state.flux_gap / state.central_gap])
    assert found[0] == pytest.approx(found[1], rel=3e-4)


@pytest.mark.slow
def test_the_exit_of_a_thin_film_is_sought_where_a_free_one_goes_to_and_fro():
    """Steps of an exit by a hundred times the width of the inlet: Newton's iteration took 100 and did not arrive."""
    groups = sb.Groups(3.7224e-9, 2.32711e-8, 2.96201e-14)
    fluid = sb.fluids.Fluid(sb.fluids.Carreau(0.00252452, 0.6052987, 0.00015806), sb.fluids.Barus(0.0693958))
    plain = sb.solve(groups, cavitation="exit")
    solution = sb.solve(groups, fluid=fluid, cavitation="exit", slide_to_roll=-2.34927)
    assert solution.error_estimate <= 1e-6
    assert solution.exit_position < plain.exit_position - 0.2


def test_a_film_that_ends_is_found_from_full_ones_before_suction_cut_their_path():
    """The path of the full film was lost at 1.05 of the speed asked for, where it had no use any more."""
    groups = sb.Groups(1.026949284796445e-12, 1.6285676358360341, 0.03818644482)
    state = sb.solve(groups, cavitation="exit", solid=sb.solids.Layer(4.978420382416584, 0.5), rtol=1e-4)
    assert state.exit_position == pytest.approx(0.56367, abs=1e-4)


def test_a_rolling_film_whose_gradient_is_a_small_power_of_the_gap_is_solved():
    """With the condition G = 0 at the exit Newton's iteration went to and fro on the last panels; values are those of 1e-9."""
    fluid = sb.fluids.Carreau(0.3, 0.25)
    state = sb.solve(sb.Groups(1e-3, 1e-3, 0.0), fluid=fluid, slide_to_roll=0.0, cavitation="exit")
    assert state.exit_position == pytest.approx(1.0018496419, rel=1e-6)
    assert state.minimum_gap == pytest.approx(4.9363116961e-4, rel=1e-6)
    assert state.flux_gap == pytest.approx(6.6325771484e-4, rel=1e-6)


@pytest.mark.slow
def test_a_compressible_liquid_forms_anew_behind_a_thin_film_too():
    fluid = sb.fluids.Fluid(viscosity=sb.fluids.Barus(0.4), density=sb.fluids.DowsonHigginson(1.9))
    groups, parts = sb.Groups(1.5e-7, 4e-4, 0.0), {"cavitation": "reform", "cavity_pressure": -1e-3, "fluid": fluid}
    state, closer = (sb.solve(groups, **parts, rtol=rtol) for rtol in (1e-5, 1e-6))
    exit_only = sb.solve(groups, cavitation="exit", fluid=fluid)
    assert state.exit_position > exit_only.exit_position
    assert state.minimum_gap == pytest.approx(exit_only.minimum_gap, rel=0.01)
    assert state.reformation_position == pytest.approx(closer.reformation_position, rel=1e-5)


# --- a cavity that is about to close: the film beside it is nearly full, and known on both sides ---

CLOSING = sb.Groups(1e-4, 0.1, 1e-4)
ON_BOTH_SIDES = ("contact_load_share", "central_gap", "minimum_gap", "offset", "viscous_balanced")


def deepest(full):
    """Return the largest suction of a full film, by the parabola through its lowest nodes."""
    i = int(np.argmin(full.fluid_pressure))
    x, p = (each[i - 1 : i + 2] for each in (full.x, full.fluid_pressure))
    bend, slope, lowest = np.polyfit(x - x[1], p, 2)
    return lowest - slope**2 / (4 * bend)


@pytest.fixture(scope="module")
def full():
    return sb.solve(CLOSING)


@pytest.mark.parametrize(
    "parts",
    [(2e-2, 1e-3, 1e-5), pytest.param((2e-2, 6e-3, 1e-3, 6e-4, 3e-4, 1e-4, 3e-5, 1e-5), marks=pytest.mark.slow)],
    ids=len,
)
def test_a_film_whose_cavity_is_about_to_close_is_nearly_the_full_one(full, parts):
    least, changes = deepest(full), []
    for taken in parts:
        found = sb.solve(CLOSING, cavitation="reform", cavity_pressure=(1 - taken) * least)
        assert found.error_estimate <= 1e-6
        changes.append(found.minimum_gap / full.minimum_gap - 1)
    assert all(later < before + 1e-6 for before, later in zip(changes, changes[1:], strict=False))
    # In proportion to the suction that is taken, about.
    assert changes[parts.index(1e-3)] == pytest.approx(1e-3 * changes[0] / 2e-2, rel=0.5) and changes[-1] < 2e-6


def test_both_sides_of_the_closing_agree_within_their_errors(full):
    low, high = ((1 - each) * deepest(full) for each in (3e-6, -1e-3))
    cavity, closed = (sb.solve(CLOSING, cavitation="reform", cavity_pressure=each) for each in (low, high))
    for name in ON_BOTH_SIDES:
        here, there = getattr(cavity, name), getattr(closed, name)
        assert abs(here - there) <= (cavity.errors[name] + closed.errors[name]) * max(abs(there), 1e-3) + 3e-7 * abs(there), (
            name
        )
