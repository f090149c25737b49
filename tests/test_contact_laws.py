"""Contact laws: each derivative against differences, logarithms where the pressure underflows."""

import math

import numpy as np
import pytest

from stribeck import Groups
from stribeck.contact_laws.exponential import ExponentialLaw, NoContact
from stribeck.contacts.groups import contact_law

pytestmark = pytest.mark.quick

SEED = 52_901
LOADS = [1e-8, 0.1, 7.0]


def of(load, roughness):
    return contact_law(Groups(0.0, load, roughness))


@pytest.fixture(params=LOADS)
def case(request):
    """Groups and a law at relative roughness 1e-3, gaps of 0 to 20 decays."""
    load, kappa = request.param, 1e-3
    return load, load * kappa, kappa * np.random.default_rng(SEED).uniform(0, 20, 50)


def test_the_law_of_the_paper_falls_by_e_over_kappa():
    law = of(0.25, 0.005)
    assert law.name == "exponential"
    assert math.isclose(law.decay_length, 0.02)
    assert law.pressure(np.zeros(1))[0] == pytest.approx(2.0, rel=1e-14)
    assert law.pressure(np.array([0.06]))[0] == pytest.approx(2.0 * math.exp(-3), rel=1e-14)


def test_smooth_surfaces_have_no_contact_pressure():
    law, gap = of(0.1, 0.0), np.array([0.0, 1e-8, 3.0])
    p = law.pressure(gap)
    assert isinstance(law, NoContact)
    assert law.decay_length == 0
    for values in (p, law.slope(gap, p), law.load_derivative(gap, p), law.roughness_derivative(gap, p)):
        assert np.array_equal(values, np.zeros(3))
    assert np.array_equal(law.log_pressure(gap), np.full(3, -np.inf))


def test_the_slope_is_the_derivative_with_respect_to_the_gap(case):
    load, roughness, gap = case
    law = of(load, roughness)
    step = 1e-4 * law.decay_length
    difference = (law.pressure(gap + step) - law.pressure(gap - step)) / (2 * step)
    assert np.abs(law.slope(gap, law.pressure(gap)) / difference - 1).max() < 1e-8


def test_the_load_derivative_holds_the_roughness_group(case):
    load, roughness, gap = case
    law, step = of(load, roughness), 1e-5
    up, down = (of(load * math.exp(d), roughness).pressure(gap) for d in (step, -step))
    p = law.pressure(gap)
    assert np.abs(law.load_derivative(gap, p) - (up - down) / (2 * step)).max() < 1e-8 * p.max()
    assert np.abs(law.load_derivative(gap, p) * (2 * step) / (up - down) - 1).max() < 1e-7


def test_the_roughness_derivative_holds_the_load_group(case):
    load, roughness, gap = case
    law, step = of(load, roughness), 1e-5
    up, down = (of(load, roughness * math.exp(d)).pressure(gap) for d in (step, -step))
    p = law.pressure(gap)
    assert np.abs(law.roughness_derivative(gap, p) - (up - down) / (2 * step)).max() < 1e-8 * p.max()


def test_the_logarithm_is_finite_where_the_pressure_underflows():
    law = of(1e-8, 1e-14)
    gap = np.array([0.1, 1.0, 50.0])
    assert np.array_equal(law.pressure(gap), np.zeros(3))
    assert np.abs(law.log_pressure(gap) / (-gap / law.decay_length - 0.5 * math.log(1e-8)) - 1).max() < 1e-15
    assert law.log_pressure(gap)[-1] < -4e7
    for derivative in (law.slope, law.load_derivative, law.roughness_derivative):
        assert np.isfinite(derivative(gap, law.pressure(gap))).all()


def test_the_logarithm_is_that_of_the_pressure(case):
    load, roughness, gap = case
    law = of(load, roughness)
    assert np.abs(np.log(law.pressure(gap)) - law.log_pressure(gap)).max() < 1e-13


def test_a_law_does_not_change_the_gaps_it_is_given():
    law, gap = ExponentialLaw(0.1, 1e-2), np.linspace(0, 1, 7)
    gap.setflags(write=False)
    p = law.pressure(gap)
    p.setflags(write=False)
    assert law.slope(gap, p).shape == law.load_derivative(gap, p).shape == (7,)
    assert law.roughness_derivative(gap, p).shape == (7,)
