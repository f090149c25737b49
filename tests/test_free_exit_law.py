"""Laws of films that end: the first order of boundary lubrication, and smooth films as the speed falls."""

import json
from pathlib import Path

import numpy as np
import pytest

import stribeck as sb

REFERENCE = json.loads((Path(__file__).parent / "data" / "fluids.json").read_text())


@pytest.mark.quick
def test_the_first_order_of_boundary_lubrication_is_its_quadrature(subtests):
    for row in REFERENCE["boundary_first_order_free_exit"]["rows"]:
        with subtests.test(row=row):
            load, x_c, flux_gap, share = row
            assert tuple(sb.asymptotics.free_exit.boundary_film_with_free_exit(load)) == pytest.approx(
                (x_c, flux_gap, share), rel=1e-8
            )


@pytest.mark.quick
def test_the_first_order_exceeds_the_second_of_a_full_film_up_to_a_fluid_number(subtests):
    for load, equal in [(1e-3, 63.365), (0.01, 22.016), (0.1, 3.8192)]:
        with subtests.test(load=load, equal=equal):
            n = 1e-4
            full = float(sb.asymptotics.boundary.fluid_load_share(sb.Groups(n * 1e-10, load, 1e-5 * load))) / n**2
            assert sb.asymptotics.free_exit.boundary_film_with_free_exit(load).share / full == pytest.approx(equal, rel=1e-4)


def test_states_approach_the_first_order_as_the_roughness_falls():
    law = sb.asymptotics.free_exit.boundary_film_with_free_exit(0.1)
    excess = []
    for kappa in (1e-2, 1e-3, 1e-4):
        state = sb.solve(sb.Groups(1e-2 * kappa**2, 0.1, 0.1 * kappa), cavitation="exit")
        excess.append(state.fluid_load_share / 1e-2 / law.share - 1)
    assert excess == pytest.approx([0.241, 0.0414, 0.0077], rel=0.02)
    slopes = np.diff(np.log(excess)) / np.log(0.1)
    assert (np.abs(slopes - 0.75) < 0.05).all()


def test_a_load_without_boundary_lubrication_is_refused(subtests):
    for load in [1.0, 0.0, "0.1", True, np.nan]:
        with subtests.test(load=load):
            with pytest.raises(sb.InputError, match="load ="):
                sb.asymptotics.free_exit.boundary_film_with_free_exit(load)


def test_smooth_films_that_end_have_their_own_outlet():
    columns = REFERENCE["smooth_limit_lambda_to_0_free_exit"]["rows"]
    for speed, central, ratio, exit in columns:
        state = sb.solve(sb.Groups(speed, 0.1, 0.0), cavitation="exit")
        assert state.central_gap / speed**0.6 == pytest.approx(central, rel=1e-6)
        assert state.minimum_gap / state.central_gap == pytest.approx(ratio, rel=1e-6)
        assert (state.exit_position - 1) / speed**0.4 == pytest.approx(exit, rel=1e-5)


def departures(law, speeds):
    """Return by how much states differ from a law of smooth films that end: of central and minimum gap, and of the exit."""
    found = [sb.solve(sb.Groups(speed, 0.1, 0.0), cavitation="exit") for speed in speeds]
    films = [law(speed) for speed in speeds]
    pairs = list(zip(found, films, strict=True))
    gaps = [(s.central_gap / film.central_gap - 1, s.minimum_gap / film.minimum_gap - 1) for s, film in pairs]
    return np.array(gaps), np.array([s.exit_position for s, _ in pairs]), np.array([film.exit for _, film in pairs])


def test_slow_smooth_films_approach_their_law():
    speeds = np.array([1e-7, 1e-5, 1e-3])
    gaps, exits, law = departures(sb.asymptotics.free_exit.slow_film_with_free_exit, speeds)
    assert gaps[:, 0] == pytest.approx([3.89e-4, 2.45e-3, 1.56e-2], rel=0.01)
    assert (np.abs(np.diff(np.log(gaps), axis=0) / np.log(100) - 0.4) < 0.01).all()
    assert (exits - 1) / (law - 1) - 1 == pytest.approx([-3.7e-3, -2.05e-2, -0.103], rel=0.02)


def test_fast_smooth_films_approach_that_of_a_rigid_parabola():
    speeds = np.array([1e2, 1e3, 1e4])
    gaps, exits, law = departures(sb.asymptotics.free_exit.rigid_film_with_free_exit, speeds)
    assert gaps[:, 0] == pytest.approx([1.117e-2, 1.105e-3, 1.104e-4], rel=0.01)
    assert exits / law - 1 == pytest.approx([3.33e-2, 3.36e-3, 3.36e-4], rel=0.01)
    arrays = sb.asymptotics.free_exit.rigid_film_with_free_exit(speeds)
    assert arrays.central_gap.shape == (3,)


def test_an_impossible_speed_of_a_film_that_ends_is_refused(subtests):
    for speed in [-1.0, np.inf, "fast"]:
        with subtests.test(speed=speed):
            for law in (sb.asymptotics.free_exit.slow_film_with_free_exit, sb.asymptotics.free_exit.rigid_film_with_free_exit):
                with pytest.raises(sb.InputError, match="speed ="):
                    law(speed)


def test_the_film_is_that_of_a_finite_volume_solver_that_conserves_mass():
    """An upwind p-theta scheme with the Fischer-Burmeister function, extrapolated from 300 and 600 cells."""
    for row in REFERENCE["fbns_independent"]["rows"]:
        state = sb.solve(sb.Groups(row["speed"], 0.1, 0.1 * row["kappa"]), cavitation="exit")
        assert state.central_gap == pytest.approx(row["h0"], rel=2e-3)
        assert state.minimum_gap == pytest.approx(row["hmin"], rel=2e-3)
        if "contact_share" in row:
            assert state.contact_load_share == pytest.approx(row["contact_share"], abs=2e-3)
