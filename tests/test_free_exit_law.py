"""Laws of films that end: the first order of boundary lubrication, and smooth films as the speed falls."""

import json
from pathlib import Path

import numpy as np
import pytest

import stribeck as sb
from stribeck.asymptotics.rough.free_exit import boundary_film_with_free_exit

REFERENCE = json.loads((Path(__file__).parent / "data" / "fluids.json").read_text())


@pytest.mark.quick
@pytest.mark.parametrize("row", REFERENCE["boundary_first_order_free_exit"]["rows"], ids=lambda row: f"{row[0]:g}")
def test_the_first_order_of_boundary_lubrication_is_its_quadrature(row):
    load, x_c, flux_gap, share = row
    assert tuple(boundary_film_with_free_exit(load)) == pytest.approx((x_c, flux_gap, share), rel=1e-8)


def test_states_approach_the_first_order_as_the_roughness_falls():
    law = boundary_film_with_free_exit(0.1)
    excess = []
    for kappa in (1e-2, 1e-3, 1e-4):
        state = sb.solve(sb.Groups(1e-2 * kappa**2, 0.1, 0.1 * kappa), cavitation="exit")
        excess.append(state.fluid_load_share / 1e-2 / law.share - 1)
    assert excess == pytest.approx([0.241, 0.0414, 0.0077], rel=0.02)
    slopes = np.diff(np.log(excess)) / np.log(0.1)
    assert (np.abs(slopes - 0.75) < 0.05).all()


@pytest.mark.parametrize("load", [1.0, 0.0, "0.1", True, np.nan])
def test_a_load_without_boundary_lubrication_is_refused(load):
    with pytest.raises(sb.InputError, match="load ="):
        boundary_film_with_free_exit(load)


def test_smooth_films_that_end_have_their_own_outlet():
    columns = REFERENCE["smooth_limit_lambda_to_0_free_exit"]["rows"]
    for speed, central, ratio, exit in columns:
        state = sb.solve(sb.Groups(speed, 0.1, 0.0), cavitation="exit")
        assert state.central_gap / speed**0.6 == pytest.approx(central, rel=1e-6)
        assert state.minimum_gap / state.central_gap == pytest.approx(ratio, rel=1e-6)
        assert (state.exit_position - 1) / speed**0.4 == pytest.approx(exit, rel=1e-5)


def test_the_film_is_that_of_a_finite_volume_solver_that_conserves_mass():
    """An upwind p-theta scheme with the Fischer-Burmeister function, extrapolated from 300 and 600 cells."""
    for row in REFERENCE["fbns_independent"]["rows"]:
        state = sb.solve(sb.Groups(row["speed"], 0.1, 0.1 * row["kappa"]), cavitation="exit")
        assert state.central_gap == pytest.approx(row["h0"], rel=2e-3)
        assert state.minimum_gap == pytest.approx(row["hmin"], rel=2e-3)
        if "contact_share" in row:
            assert state.contact_load_share == pytest.approx(row["contact_share"], abs=2e-3)
