"""Film and friction of the smooth contact: what the laws for every speed are at their ends, and what their limits say."""

import math

import numpy as np
import pytest

import stribeck as sb
from stribeck.asymptotics import hydrodynamic

SPEEDS = np.geomspace(1e-10, 1e8, 55)


@pytest.fixture(scope="module")
def films():
    """Central gap, flux gap and friction over speeds of 18 decades, three in each."""
    found = sb.solve_batch(sb.Groups(SPEEDS, 0.1, 0.0), rtol=1e-6)
    return np.array([found.central_gap, found.flux_gap, found.friction.fluid])


def test_our_laws_hold_at_every_speed(subtests, films):
    for name, column, within in [("central_gap", 0, 0.0028), ("flux_gap", 1, 0.0004), ("friction_uniform", 2, 0.00225)]:
        with subtests.test(name=name, column=column, within=within):
            law = getattr(hydrodynamic, name)
            error = np.abs(law(sb.Groups(SPEEDS, 0.1, 0.0)) / films[column] - 1)
            assert 0.8 * within < error.max() <= within
            # At both ends they are exact, not merely fitted.
            assert error[SPEEDS < 2e-9].max() < 1e-5 and error[SPEEDS > 1e7].max() < 3e-5


def test_our_laws_are_better_than_those_of_the_paper(films):
    groups = sb.Groups(SPEEDS, 0.1, 0.0)
    error = np.abs(hydrodynamic.friction(groups) / films[2] - 1)
    assert 0.06 < error.max() < 0.072
    film = np.hypot(hydrodynamic.central_gap_large.function(groups), hydrodynamic.central_gap_small.function(groups))
    assert np.abs(film / films[0] - 1).max() > 0.1


def test_the_next_term_of_slow_speed_is_in_our_laws(subtests):
    for law, slope in [
        (hydrodynamic.central_gap, 0.245),
        (hydrodynamic.flux_gap, 0.245),
        (hydrodynamic.friction_uniform, 4.0),
    ]:
        with subtests.test(law=law, slope=slope):

            def over_leading(speed):
                groups = sb.Groups(speed, 0.3, 0.0)
                return law(groups) / (
                    hydrodynamic.friction_large.function(groups)
                    if law is hydrodynamic.friction_uniform
                    else hydrodynamic.central_gap_large.function(groups)
                )

            # The difference of two speeds, so that the leading term drops out; the friction goes on with lambda**(3/5).
            u = np.array([1e-5, 4e-5])
            found = np.diff([over_leading(value**2.5) for value in u]) / np.diff(u)
            assert found == pytest.approx(slope, rel=0.02)


def test_the_fields_of_fast_speed_solve_reynolds_equation():
    groups = sb.Groups(1e6, 0.1, 0.0)
    x, dx = np.linspace(-300, 300, 20_001, retstep=True)
    h, p = hydrodynamic.gap_small(groups, x), hydrodynamic.pressure_small(groups, x)
    slope = groups.speed * (h - hydrodynamic.flux_gap_small(groups)) / h**3
    np.testing.assert_allclose(np.gradient(p, dx)[1:-1], slope[1:-1], atol=1e-5 * np.abs(slope).max())
    assert p[0] > 0 > p[-1]


def test_the_friction_of_fast_speed_is_that_of_its_fields():
    groups = sb.Groups(1e6, 0.1, 0.0)
    # On x = h0**(1/2) tan(v) the integral of the balanced shear, [BP] Eq. (friction) without contact, is finite.
    v, dv = np.linspace(-math.pi / 2, math.pi / 2, 100_001, retstep=True)
    x = 100 * np.tan(v[1:-1])
    h, flux = hydrodynamic.gap_small(groups, x), hydrodynamic.flux_gap_small(groups)
    shear = (1 + 3 * (h - flux) / h) / h * 100 / np.cos(v[1:-1]) ** 2
    friction = 2 * math.sqrt(groups.load) * groups.speed / (3 * math.pi) * shear.sum() * dv
    assert hydrodynamic.friction_small(groups) == pytest.approx(friction, rel=1e-4)


def test_without_speed_there_is_no_film_and_no_friction():
    still = sb.Groups(0.0, 0.1, 0.0)
    assert hydrodynamic.central_gap(still) == hydrodynamic.flux_gap(still) == hydrodynamic.friction_uniform(still) == 0
