"""The moments of asperity heights against quadrature, closed forms and limits, and what a surface gives the contact."""

import math

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import gamma

import stribeck as sb
from stribeck.numerics.dual import with_slope

pytestmark = pytest.mark.quick

GreenwoodTripp, GreenwoodWilliamson = sb.contact_laws.GreenwoodTripp, sb.contact_laws.GreenwoodWilliamson

LAWS = {1.5: GreenwoodWilliamson(), 2.5: GreenwoodTripp()}
"""The law whose pressure is the moment of each order."""


def by_quadrature(order, s):
    """Return the moment F_n(s) over exp(-s**2/2) for s > 0, over 1 below."""
    held = 0.5 * s * s if s > 0 else 0.0
    ends = [0, 3 / (1 + s), 10 / (1 + s), 60 / (1 + s)] if s > 0 else [0, -s, 1 - s, 40 - s]
    parts = [
        quad(lambda w: w**order * math.exp(held - 0.5 * (w + s) ** 2), a, b, epsabs=0, epsrel=1e-13, limit=200)[0]
        for a, b in zip(ends[:-1], ends[1:], strict=True)
        if b > a
    ]
    return math.fsum(parts) / math.sqrt(2 * math.pi)


def test_the_moments_are_their_integrals(subtests):
    for order, law in LAWS.items():
        with subtests.test(order=order):
            for s in (-12.0, -5.3, -1.0, -0.21, 0.0, 0.37, 1.0, 3.0, 8.1, 20.0, 30.0):
                held = 0.5 * s * s if s > 0 else 0.0
                found = float(law.log_pressure(np.array([s]))[0])
                assert math.exp(found + held) == pytest.approx(by_quadrature(order, s), rel=1e-12), s


def test_the_slope_of_a_moment_is_the_lower_moment():
    # F_n' = -n F_(n-1): the splines of two orders know nothing of each other.
    s = np.concatenate([np.linspace(-11.9, 10, 300), np.geomspace(10, 100, 50)])
    lower = LAWS[1.5].log_pressure(s)
    assert (
        np.abs(with_slope(LAWS[2.5].log_pressure, s)[1] / (-2.5 * np.exp(lower - LAWS[2.5].log_pressure(s))) - 1).max() < 1e-9
    )


def test_far_apart_a_moment_falls_as_a_gaussian_over_a_power():
    s = np.array([1e3, 1e5, 1e6])
    limit = math.log(gamma(2.5) / math.sqrt(2 * math.pi)) - 2.5 * np.log(s) - 0.5 * s * s
    assert LAWS[1.5].log_pressure(s) == pytest.approx(limit, rel=1e-15, abs=1e-5)
    assert np.isfinite(with_slope(LAWS[1.5].log_pressure, s)[1]).all()


def test_deep_below_the_mean_plane_a_moment_goes_on_straight_and_falls():
    s = np.array([-14.0, -13.0, -12.0 - 1e-9, -12.0 + 1e-9, -12.0, 1e4, 1e4 * (1 + 1e-9)])
    values, slopes = with_slope(LAWS[2.5].log_pressure, s)
    assert slopes[0] == slopes[1] == pytest.approx(slopes[3], rel=1e-8)
    assert slopes[4] == pytest.approx(slopes[3], rel=1e-8) and slopes[5] == pytest.approx(slopes[6], rel=1e-6)
    assert slopes[0] < 0
    assert values[0] - values[1] == pytest.approx(-slopes[0], rel=1e-9)
    assert values[2] == pytest.approx(values[3], abs=1e-8)


def test_the_popular_fit_of_greenwood_and_tripp_is_wrong_where_contact_begins():
    fit = 4.4086e-5 * (4 - np.array([0.5, 1.0, 2.0, 3.0])) ** 6.804
    excess = fit / np.exp(LAWS[2.5].log_pressure(np.array([0.5, 1.0, 2.0, 3.0]))) - 1
    assert excess[-1] == pytest.approx(-0.74, abs=0.005)
    assert np.abs(excess[:3]).max() < 0.1
    assert float(LAWS[2.5].log_pressure(np.array([4.0]))[0]) > math.log(1e-6)  # where the fit is zero


def test_summits_give_a_contact_its_beta():
    one = GreenwoodWilliamson.coefficients(density="1e10 1/m^2", radius="10 um", deviation="0.5 um")
    two = GreenwoodTripp.coefficients(density=1e10, radius=1e-5, deviation=5e-7)
    assert one["roughness"] == two["roughness"] == 5e-7
    assert one["alpha"] == two["alpha"] == 1.0
    assert one["beta"] == pytest.approx(4 / 3 * 0.05 * math.sqrt(0.05), rel=1e-12)
    assert two["beta"] == pytest.approx(16 * math.sqrt(2) * math.pi / 15 * 0.05**2 * math.sqrt(0.05), rel=1e-12)


def test_the_load_of_a_summit_is_that_of_hertz():
    # Ten thousand summits drawn at random, each a Hertz contact of its own: the model behind the law.
    eta, R, sigma, E, gap = 1e10, 1e-5, 5e-7, 2e6, 4e-7
    z = sigma * np.random.default_rng(7).standard_normal(1_000_000)
    pressure = eta * np.mean(4 / 3 * E * math.sqrt(R) * np.maximum(z - gap, 0) ** 1.5)
    beta = GreenwoodWilliamson.coefficients(density=eta, radius=R, deviation=sigma)["beta"]
    law = beta * E * math.exp(float(GreenwoodWilliamson().log_pressure(np.array([gap / sigma]))[0]))
    assert pressure == pytest.approx(law, rel=5e-3)


def test_two_rough_surfaces_carry_what_their_misaligned_asperities_do():
    # Hertz contacts of paraboloids whose axes lie a distance r apart: they meet r**2/(4 R) lower, with half the radius.
    eta, R, sigma, E, gap = 1e10, 1e-5, 5e-7, 2e6, 4e-7
    rng = np.random.default_rng(8)
    z = sigma * rng.standard_normal(1_000_000)
    largest = math.sqrt(4 * R * 6 * sigma)
    r2 = largest**2 * rng.random(1_000_000)  # evenly over a disc
    force = 4 / 3 * E * math.sqrt(R / 2) * np.maximum(z - gap - r2 / (4 * R), 0) ** 1.5
    pressure = eta * eta * math.pi * largest**2 * force.mean()
    beta = GreenwoodTripp.coefficients(density=eta, radius=R, deviation=sigma)["beta"]
    law = beta * E * math.exp(float(GreenwoodTripp().log_pressure(np.array([gap / sigma]))[0]))
    assert pressure == pytest.approx(law, rel=2e-2)


def test_a_state_below_the_mean_plane_says_that_the_model_is_left():
    heavy = sb.solve(sb.Groups(speed=0.0, load=1.0, roughness=0.01), law=GreenwoodWilliamson())
    assert heavy.central_gap < 0
    assert any("below their mean plane" in note for note in heavy.notes)
    assert any(note.startswith("The gap is negative: asperities") for note in heavy.notes)
    light = sb.solve(sb.Groups(speed=0.0, load=0.01, roughness=1e-4), law=GreenwoodWilliamson())
    assert light.notes == ()
