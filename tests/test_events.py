"""Zeros and minima along a path."""

import math

import numpy as np
import pytest

import stribeck as sb
from stribeck.numerics.events import first_zero, least_by_slope

PLACES = np.linspace(0.0, 9.0, 10)


@pytest.mark.quick
def test_the_first_of_several_zeros_is_located():
    found = first_zero(math.sin, PLACES + 1, np.sin(PLACES + 1), 1e-12)
    assert found.place == pytest.approx(math.pi, abs=1e-11) and (found.low, found.high) == (3.0, 4.0)
    assert first_zero(lambda s: 1 + s * s, PLACES, 1 + PLACES**2, 1e-12) is None


@pytest.mark.quick
def test_a_minimum_inside_is_located_by_its_slope():
    found = least_by_slope(lambda s: 2 * (s - 4.3), PLACES, (PLACES - 4.3) ** 2, 1e-12)
    assert found.place == pytest.approx(4.3, abs=1e-11)
    assert least_by_slope(lambda s: 1.0, PLACES, PLACES, 1e-12) is None  # the least value is at the end


def test_a_curve_off_the_atlas_offers_what_a_solved_one_does():
    contact = sb.load_case("examples/pdms_cylinder.toml").contact
    read, solved = (sb.stribeck_curve(contact, speed=("0.1 mm/s", "0.1 m/s"), method=each) for each in ("atlas", "solver"))
    for mark, other in zip(read.transitions, solved.transitions, strict=True):
        assert mark.name == other.name and abs(math.log(mark.value / other.value)) <= mark.error + other.error < 1e-3
    speeds = np.geomspace(2e-4, 5e-2, 5)
    one, two = read.at(speeds), solved.at(speeds)
    assert (np.abs(one.friction - two.friction) <= one.friction_error + two.friction_error).all()
    assert read.at("1 mm/s").central_gap == pytest.approx(solved.at("1 mm/s").central_gap, rel=read.error_estimate)
    assert read.sampled(7).transitions[0].value == pytest.approx(read.transitions[0].value, rel=1e-6)
    assert read.friction(boundary_friction=0.35).contact == pytest.approx(0.5 * read.friction_contact)
    dataset = read.to_dataset()
    assert dataset["friction"].values == pytest.approx(solved.to_dataset()["friction"].values, rel=1e-4)
    with pytest.raises(sb.InputError, match="outside the curve"):
        read.at("1 m/s")
