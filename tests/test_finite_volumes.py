"""Films that end, against finite volumes that conserve mass and know of no exit."""

import numpy as np
import pytest
from finite_volumes import extrapolated, film

import stribeck as sb

STATES = [sb.Groups(1e-4, 0.1, 1e-4), sb.Groups(1e-3, 0.1, 1e-4)]


def compare(groups, cells, tolerance):
    """Compare a film that ends with the extrapolated one of finite volumes."""
    state = sb.solve(groups, cavitation="exit")
    central, lowest, share = extrapolated(groups, cells)
    assert state.central_gap == pytest.approx(central, rel=tolerance)
    assert state.minimum_gap == pytest.approx(lowest, rel=tolerance)
    assert state.contact_load_share == pytest.approx(share, abs=tolerance)


def test_a_film_that_ends_is_that_of_finite_volumes(subtests):
    for groups, cells in zip(STATES, (240, 480), strict=True):
        with subtests.test(groups=groups):
            compare(groups, cells, 2e-2)


@pytest.mark.slow
@pytest.mark.parametrize("groups", STATES, ids=["mixed", "film"])
def test_finer_finite_volumes_come_nearer(groups):
    compare(groups, 960, 1.25e-3)


def test_finite_volumes_conserve_mass_and_tear_the_film_where_the_exit_is():
    groups = STATES[0]
    x, h, p, void = film(groups, 240, sb.solve(groups, rtol=1e-4))
    state = sb.solve(groups, cavitation="exit")
    full = void < 1e-9
    assert (p[~full] < 1e-9).all()
    assert x[~full].min() == pytest.approx(state.exit_position, abs=2 * (x[1] - x[0]))
    torn = (1 - void[~full]) * h[~full]
    assert np.ptp(torn) < 1e-9 * torn[0]
    assert torn[0] == pytest.approx(state.flux_gap, rel=0.05)
