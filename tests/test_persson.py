"""Persson's contact law: closed forms, the integral itself, its two limits, and a table that keeps its promise."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad
from scipy.special import erf, exp1

import stribeck as sb
from stribeck.numerics.dual import with_slope
from stribeck.surfaces import PerssonLaw, SelfAffine, Spectrum, persson_law

ROLLED = SelfAffine(h_rms=1.0, q0=1.0, q1=1e3, hurst=0.8, roll_off=5.0)
EVERYWHERE = np.concatenate((np.geomspace(1e-300, 1e-3, 500), np.geomspace(1.1e-3, 60, 1500)))


@pytest.fixture(scope="module")
def law():
    return persson_law(ROLLED)


def test_gamma_one_and_hurst_one_give_the_exponential_integral():
    # u = h_rms E_1(2 p/(E* q0 h_rms)) for the endless spectrum q^-4; with q1/q0 = 1e14 the rest is 1e-28.
    law = persson_law(SelfAffine(h_rms=2e-6, q0=1e5, q1=1e19, hurst=1.0), gamma=1.0)
    assert law.alpha == pytest.approx(1.0, rel=1e-13, abs=0)
    assert law.beta == pytest.approx(0.2 * math.exp(-np.euler_gamma) / 2, rel=1e-12, abs=0)
    z = np.geomspace(1e-12, 6, 400)
    assert np.abs(law.log_pressure(exp1(z)) - np.log(z) - np.euler_gamma).max() < 2e-11


def test_published_numbers_of_the_exponential_limit():
    law = persson_law(SelfAffine(h_rms=1.0, q0=1.0, q1=1e6, hurst=0.8), gamma=0.45)
    assert (round(law.alpha, 2), round(law.beta, 2)) == (2.09, 1.43)
    rolled = [persson_law(SelfAffine(h_rms=1.0, q0=1.0, q1=1e3, hurst=0.8, roll_off=q_r)).alpha for q_r in (4.0, 10.0)]
    assert all(1.8 < alpha < 1.91 for alpha in rolled)


def direct_separation(spectrum, gamma, pressure):
    """Return u of the integral as published, over q and p' and with w(q), by adaptive quadrature."""

    def inner(t):
        def integrand(v):
            return (gamma + 3 * (1 - gamma) * erf(math.exp(v)) ** 2) * math.exp(-math.exp(2 * v))

        return quad(integrand, math.log(t), math.log(max(12.0, t + 4)), epsabs=0, epsrel=1e-11, limit=300)[0]

    def outer(v):
        q = math.exp(v * v)
        w = (math.pi * math.fsum(spectrum.between(spectrum.lowest, q).stretches(3))) ** -0.5
        return math.sqrt(math.pi) * q**3 * float(spectrum.at(q)) * w * inner(w * pressure) * 2 * v

    nodes = np.sqrt(np.log(spectrum.wavenumber))
    nodes[-1] *= 1 - 1e-13
    return sum(quad(outer, a, b, epsabs=0, epsrel=1e-9)[0] for a, b in zip(nodes[:-1], nodes[1:], strict=True))


def test_the_table_is_the_published_integral(subtests, law):
    assert 0 < law.error <= 1e-11
    for pressure in [0.05, 2.0, 20.0]:
        with subtests.test(pressure=pressure):
            separation = direct_separation(ROLLED.spectrum, 0.45, pressure)
            assert law.log_pressure(law.alpha * separation) == pytest.approx(math.log(pressure / law.beta), abs=3e-10)


def test_the_law_becomes_the_exponential_one_at_small_pressure(law):
    s = np.array([5.0, 10.0, 15.0, 20.0])
    excess = np.abs(law.log_pressure(s) + s)
    assert -np.polyfit(s, np.log(excess), 1)[0] == pytest.approx(1.0, abs=0.02)
    assert law.log_pressure(np.array([45.0, 1e5])).tolist() == [-45.0, -1e5]
    assert with_slope(law.log_pressure, [45.0])[1] == -1.0


def test_full_contact_is_reached_as_the_integral_says(law):
    # u -> (3 - 2 gamma) G^5/(2 pi^(1/2) q1 P^4) exp(-P^2/G^2), with corrections of order G^2/P^2.
    G = law.rms_slope / math.sqrt(2)
    misses = []
    for s in (1e-30, 1e-60, 1e-120, 1e-240):
        P = law.beta * math.exp(law.log_pressure(s))
        limit = math.log(law.alpha * (3 - 2 * 0.45) * G**5 / (2 * math.sqrt(math.pi) * 1e3 * P**4)) - (P / G) ** 2
        misses.append((abs(limit - math.log(s)), (G / P) ** 2))
    miss, small = np.array(misses).T
    assert np.polyfit(np.log(small), np.log(miss), 1)[0] == pytest.approx(1.0, abs=0.1)
    assert miss[-1] < 0.02


def test_shape_does_not_depend_on_height_or_unit_of_length():
    small = persson_law(SelfAffine(h_rms=3e-7, q0=1e4, q1=1e7, hurst=0.8, roll_off=5e4))
    unit = persson_law(ROLLED)
    s = np.geomspace(1e-20, 30, 50)
    assert np.abs(small.log_pressure(s) - unit.log_pressure(s)).max() < 1e-10
    assert small.alpha == pytest.approx(unit.alpha, rel=1e-12, abs=0)
    assert small.beta == pytest.approx(unit.beta * 1e4 * 3e-7, rel=1e-12, abs=0)
    assert small.scaled(1e-6).beta == pytest.approx(unit.beta * 1e4 * 1e-6, rel=1e-12, abs=0)
    assert np.abs(small.scaled(1e-6).area_fraction(s) - small.area_fraction(s)).max() < 1e-12


def test_real_area_is_that_of_persson_at_both_ends(law):
    far, near = np.array([12.0]), np.array([1e-200])
    pressure = law.beta * np.exp(-far)
    assert law.area_fraction(far) == pytest.approx(math.sqrt(8 / math.pi) * pressure / law.rms_slope, rel=1e-4, abs=0)
    assert law.area_fraction(near) == 1.0
    pressure = np.array([0.3, 2.0])
    assert law.area_fraction_at(pressure) == pytest.approx(
        erf(pressure * law.beta * math.sqrt(2) / law.rms_slope), rel=1e-13, abs=0
    )


def test_touching_or_overlapping_planes_have_no_finite_pressure(law):
    s = np.array([-1.0, 0.0, 1.0])
    assert law.log_pressure(s)[:2].tolist() == [np.inf, np.inf]
    assert np.isfinite(law.log_pressure(s)[2])


@settings(max_examples=4, deadline=None)
@given(st.lists(st.floats(-3, 3), min_size=3, max_size=8), st.floats(0.3, 1.0), st.integers(0, 2**32 - 1))
def test_rugged_measured_spectra_give_a_monotone_law(noise, gamma, seed):
    q = np.geomspace(1.0, 1e3, len(noise)) * 10 ** np.random.default_rng(seed).uniform(-0.1, 0.1, len(noise))
    law = persson_law(Spectrum(q, q**-3.6 * np.exp(noise)), gamma)
    assert isinstance(law, PerssonLaw)
    assert np.all(np.diff(law.log_pressure(EVERYWHERE)) < 0)
    assert np.all(with_slope(law.log_pressure, EVERYWHERE)[1] < 0)


def test_an_impossible_gamma_is_refused(subtests):
    for gamma in [0, -1, 1.5, float("nan"), True, "0.45"]:
        with subtests.test(gamma=gamma), pytest.raises(sb.InputError, match="gamma = "):
            persson_law(ROLLED, gamma)
