"""Functions read between scattered places by values and gradients."""

import numpy as np
import pytest

from stribeck.numerics.scattered import Scattered

PLACES = np.array([[0.0, 0.0], [0.5, 0.0], [0.2, 0.4]])
LENGTHS = np.array([1.0, 0.5])


def values(x):
    return np.array([np.exp(-x[0]) + np.sin(x[1]), x[0] * x[1]])


def slopes(x):
    return np.array([[-np.exp(-x[0]), x[1]], [np.cos(x[1]), x[0]]])


@pytest.fixture
def known():
    found = Scattered(LENGTHS)
    for place in PLACES:
        found.add(place, values(place), slopes(place))
    return found


@pytest.mark.quick
def test_at_known_places_values_and_gradients_are_theirs_without_doubt(known):
    for i, place in enumerate(PLACES):
        found = known.at(place)
        np.testing.assert_allclose(found[0], values(place), atol=1e-5)
        np.testing.assert_allclose(found[1], slopes(place), atol=1e-4)
        assert known.doubt(place) < 2e-4
        assert known.nearest(place + 0.01) == i


@pytest.mark.quick
def test_between_them_values_err_by_less_than_the_doubt_and_gradients_are_those_of_the_values(known):
    for place in np.random.default_rng(3).uniform(0, 0.5, (20, 2)):
        found, by = known.at(place)
        assert np.abs(found - values(place)).max() < known.doubt(place)
        step = 1e-5 * np.eye(2)
        differences = [(known.at(place + each)[0] - known.at(place - each)[0]) / 2e-5 for each in step]
        np.testing.assert_allclose(by, differences, atol=1e-4)


@pytest.mark.quick
def test_doubt_grows_as_the_square_of_the_distance_from_a_lone_place_and_is_small_between_two():
    known = Scattered(np.ones(1))
    assert known.doubt(np.zeros(1)) == 1.0
    known.add(np.zeros(1), np.ones(1), np.zeros((1, 1)))
    near, twice = (known.doubt(np.array([d])) for d in (0.05, 0.1))
    assert twice / near == pytest.approx(4, rel=0.02)
    assert known.doubt(np.array([9.0])) == pytest.approx(1.0, abs=1e-6)
    known.add(np.ones(1), np.ones(1), np.zeros((1, 1)))
    assert known.doubt(np.array([0.5])) == pytest.approx(0.0127, rel=0.01)


@pytest.mark.quick
def test_functions_of_no_variable_are_constants():
    known = Scattered(np.zeros(0))
    known.add(np.zeros(0), np.array([1.0, 2.0]), np.zeros((0, 2)))
    assert known.doubt(np.zeros(0)) < 2e-4
    np.testing.assert_allclose(known.at(np.zeros(0))[0], [1.0, 2.0], rtol=1e-7)
