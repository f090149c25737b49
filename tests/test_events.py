"""Zeros and minima along a path."""

import math

import numpy as np
import pytest

import stribeck as sb
from stribeck.numerics.events import first_zero, least_by_slope, rising_zeros

PLACES = np.linspace(0.0, 9.0, 10)


@pytest.mark.quick
def test_the_first_of_several_zeros_is_located():
    found = first_zero(math.sin, PLACES + 1, np.sin(PLACES + 1), 1e-12)
    assert found.place == pytest.approx(math.pi, abs=1e-11) and (found.low, found.high) == (3.0, 4.0)
    back = PLACES[::-1] + 1
    last = first_zero(math.sin, back, np.sin(back), 1e-12)
    assert last.place == pytest.approx(3 * math.pi, abs=1e-11) and (last.low, last.high) == (9.0, 10.0)
    assert first_zero(lambda s: 1 + s * s, PLACES, 1 + PLACES**2, 1e-12) is None


@pytest.mark.quick
def test_a_minimum_inside_is_located_by_its_slope():
    found = least_by_slope(lambda s: 2 * (s - 4.3), PLACES, (PLACES - 4.3) ** 2, 1e-12)
    assert found.place == pytest.approx(4.3, abs=1e-11)
    assert least_by_slope(lambda s: 1.0, PLACES, PLACES, 1e-12) is None  # the least value is at the end


@pytest.mark.quick
def test_a_minimum_is_as_deep_as_the_lower_of_its_sides():
    places, sizes = np.arange(4.0), np.array([3.0, 1.0, 2.0, 1.5])  # the least is 1 below the lower side
    assert least_by_slope(lambda s: s - 1.2, places, sizes, 1e-12, shallowest=0.99).place == pytest.approx(1.2)
    assert least_by_slope(lambda s: s - 1.2, places, sizes, 1e-12, shallowest=1.0) is None
    assert least_by_slope(lambda s: s, np.array([]), np.array([]), 1e-12) is None


def test_a_curve_that_is_flat_to_rounding_has_no_minimum():
    flat_to_rounding = sb.stribeck_curve(sb.Groups(1e-4, 0.1, 1e-4), roughness=[3e-8, 1e-5, 1e-4, 1e-2])
    assert flat_to_rounding.minimum is None


@pytest.mark.quick
def test_many_zeros_are_located_at_once_between_their_last_ends(subtests):
    for rounds in [1, 6]:
        with subtests.test(rounds=rounds):
            zeros = np.linspace(-0.9, 2.5, 40)
            ends = np.array([np.full(40, -1.0), np.full(40, 3.0)])
            values_at = lambda s: np.expm1(s - zeros)  # noqa: E731
            found, slopes, apart = rising_zeros(values_at, ends, values_at(ends), rounds, 1e-9)
            assert (np.abs(found - zeros) <= apart).all() and apart.max() <= 4 / 3**rounds * (1 + 1e-12)
            assert slopes == pytest.approx(1.0, abs=2 * apart.max()) if rounds > 1 else (slopes > 0).all()
            assert rounds == 1 or np.abs(found - zeros).max() < 1e-9
