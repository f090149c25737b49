"""Groups, Hertz scales and the line contact in SI units."""

import copy
import dataclasses
import inspect
import math
import pickle

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stribeck import Groups, InputError, LineContact, PointContact

PARTS = {field.name for field in dataclasses.fields(LineContact)} - {*LineContact.INPUTS.names, "law"}

INPUTS = {
    "radius": "10 mm",
    "modulus": "2.1 MPa",
    "load": "50 N/m",
    "viscosity": "1 mPa*s",
    "speed": "0.1 m/s",
    "roughness": "1 um",
    "alpha": 2.0,
    "beta": 0.05,
    "boundary_friction": 0.8,
}
reproducible = settings(derandomize=True, deadline=None, max_examples=150)
NUMBERS = {
    "radius": st.floats(1e-6, 1.0),
    "modulus": st.floats(1e3, 1e12),
    "load": st.floats(1e-3, 1e7),
    "viscosity": st.floats(1e-6, 1e3),
    "speed": st.floats(1e-9, 1e2),
    "roughness": st.floats(1e-10, 1e-3),
    "alpha": st.floats(0.5, 5.0),
    "beta": st.floats(1e-4, 10.0),
    "boundary_friction": st.floats(0.0, 2.0),
}
contacts = st.builds(LineContact, **NUMBERS)
balls = st.builds(PointContact, **NUMBERS, slide_to_roll=st.just(2.0))


def contact(**changes):
    return LineContact(**(INPUTS | changes))


def numbers(groups):
    return groups.speed, groups.load, groups.roughness


# --- the formulas, each by a second route ---


@reproducible
@given(contacts, balls)
def test_hertz_scales_satisfy_the_elliptic_load_and_the_parabola(c, ball):
    for contact, carried, slope in ((c, math.pi / 2, 0.5), (ball, 2 * math.pi / 3 * ball.hertz.half_width, 2 / math.pi)):
        hertz = contact.hertz
        assert carried * hertz.pressure * hertz.half_width == pytest.approx(contact.load, rel=1e-13)
        assert hertz.half_width**2 / contact.radius == pytest.approx(hertz.indentation, rel=1e-13)
        assert hertz.pressure == pytest.approx(slope * contact.modulus * hertz.half_width / contact.radius, rel=1e-13)


@reproducible
@given(contacts, balls)
def test_groups_follow_from_the_hertz_scales(c, ball):
    for contact, power in ((c, 2), (ball, 3)):
        groups, hertz = contact.groups, contact.hertz
        wedge = 6 * contact.viscosity * contact.speed * hertz.half_width / (hertz.indentation**2 * hertz.pressure)
        assert groups.speed == pytest.approx(wedge, rel=1e-12)
        assert groups.load == pytest.approx((hertz.pressure / (contact.beta * contact.modulus)) ** power, rel=1e-12)
        assert groups.relative_roughness == pytest.approx(contact.roughness / (contact.alpha * hertz.indentation), rel=1e-12)
        assert groups.slope(contact.beta) == pytest.approx(hertz.half_width / contact.radius, rel=1e-12)
        assert groups.hersey_number(contact.beta) == pytest.approx(contact.hersey_number, rel=1e-12)


# --- both ways ---


@reproducible
@given(contacts, balls)
def test_a_contact_survives_the_way_through_groups(line, ball):
    names = ("radius", "modulus", "viscosity", "alpha", "beta", "boundary_friction")
    for c in (line, ball):
        back = type(c).from_groups(c.groups, **{name: getattr(c, name) for name in names})
        assert [getattr(back, name) for name in INPUTS] == pytest.approx([getattr(c, name) for name in INPUTS], rel=1e-13)
    kept = {name: INPUTS[name] for name in names}  # with units
    assert LineContact.from_groups(contact().groups, **kept).load == pytest.approx(50.0, rel=1e-13)
    with pytest.raises(InputError, match=r"shape \(2,\)"):
        LineContact.from_groups(Groups([1.0, 2.0], 0.1, 0.0), **kept)


# --- unit neutrality ---


# --- elasticity ---


def test_elasticity_is_given_once_and_possible():
    pair = {"modulus": None, "youngs_modulus": "1.5 MPa", "poisson_ratio": 0.5}
    assert contact(**pair).modulus == pytest.approx(2e6, rel=1e-15)
    assert contact().replace(youngs_modulus="3 MPa", poisson_ratio=0.0).modulus == 3e6
    for changes, words in [
        ({"youngs_modulus": 1e6, "poisson_ratio": 0.5}, "give either modulus, or"),
        ({"poisson_ratio": 0.5}, "give either modulus, or"),
        ({"modulus": None}, r"modulus \(which is E\*\) is missing"),
        ({"modulus": None, "youngs_modulus": 1e6}, r"poisson_ratio is missing beside .*poisson_ratio = 0.5 \(rubber and gels"),
        ({"modulus": None, "poisson_ratio": 0.5}, "youngs_modulus is missing beside poisson_ratio"),
    ]:
        with pytest.raises(InputError, match=words):
            contact(**changes)


# --- the table of inputs ---


def test_the_entrainment_speed_is_half_the_speed_and_stands_in_its_place():
    assert contact(speed=None, entrainment_speed="5 mm/s").speed == 0.01
    assert contact().replace(entrainment_speed=0.002).speed == 0.004
    with pytest.raises(InputError, match=r"speed = .*twice their mean.*entrainment_speed = .*give either speed, or"):
        contact(entrainment_speed="5 mm/s")


def test_an_unknown_input_is_answered_with_the_nearest_name():
    with pytest.raises(InputError, match="viscosty = 1.0 is not an input of LineContact; did you mean viscosity"):
        contact(viscosty=1.0)
    said = r"pressure_coefficient = '20 1/GPa' is a number of .*'barus' or 'roelands'.* sb\.fluids"
    with pytest.raises(InputError, match=said):
        contact(pressure_coefficient="20 1/GPa")


def test_the_signature_of_a_contact_names_every_input():
    names = list(inspect.signature(LineContact).parameters)
    known = [*LineContact.INPUTS.quantities, "law"]
    assert names[: len(known)] == known and set(names[len(known) :]) == PARTS
    parts = [name for name in names[len(known) :] if name not in PointContact.INPUTS.quantities]
    assert list(inspect.signature(PointContact).parameters) == [*PointContact.INPUTS.quantities, "law", *parts]
    assert set(INPUTS) == {field.name for field in dataclasses.fields(LineContact)} - {"law", *PARTS}


def test_the_exponents_of_an_input_are_those_of_the_groups():
    for base in (contact(), PointContact(**INPUTS | {"load": "1 N"})):
        for name, exponents in base.INPUTS.exponents.items():
            if name == "wetted_radius":
                continue
            halved = base.replace(**{name: 0.5 * getattr(base, name)})
            for group, exponent in zip(("speed", "load", "roughness"), exponents, strict=True):
                ratio = getattr(halved.groups, group) / getattr(base.groups, group)
                assert ratio == pytest.approx(0.5**exponent, rel=1e-12), (base, name)


# --- the objects ---


def test_parameters_are_frozen_and_survive_copies():
    for frozen in (contact(), contact().groups, contact().hertz):
        with pytest.raises(dataclasses.FrozenInstanceError):
            setattr(frozen, dataclasses.fields(frozen)[0].name, 1.0)
        for twin in (copy.deepcopy(frozen), pickle.loads(pickle.dumps(frozen))):
            assert twin == frozen and hash(twin) == hash(frozen)


# --- groups ---


def test_the_contact_of_hertz_is_dry_and_smooth():
    states = [(0.0, 0.0), (np.zeros(2), 0.0), (1e-9, 0.0), (0.0, 1e-9), (np.array([0.0, 1e-9]), 0.0)]
    assert [Groups(speed, 0.1, rough).is_hertzian for speed, rough in states] == [True, True, False, False, False]


def test_groups_keep_read_only_copies_of_arrays_and_plain_floats():
    speeds = np.array([1e-3, 1.0])
    groups = Groups(speeds, 0.1, [[0.0], [1e-4]])
    speeds[0] = 7.0
    assert groups.speed[0] == 1e-3 and groups.shape == (2, 2)
    assert groups.speed.dtype == groups.roughness.dtype == np.float64
    with pytest.raises(ValueError, match="read-only"):
        groups.speed[0] = 7.0
    with pytest.raises(InputError, match=r"speed \(2,\), load \(3,\)"):
        Groups([1.0, 2.0], [1.0, 2.0, 3.0], 0.0)
    for value in (1, np.float32(0.5), np.array(0.5), np.int64(2)):
        groups = Groups(value, value, value)
        assert {*map(type, numbers(groups))} == {float} and groups.shape == ()


def test_only_the_load_must_not_be_zero():
    assert Groups(0, 1e-8, 0) == Groups(-0.0, 1e-8, 0.0)
    assert hash(Groups(0, 1e-8, 0)) == hash(Groups(-0.0, 1e-8, 0.0))
    with pytest.raises(InputError, match="^load = 0 must be finite and positive"):
        Groups(1.0, 0, 1.0)
    with pytest.raises(InputError, match="^load has the value 0 and must be finite and positive"):
        Groups(1.0, [1.0, 0], 1.0)


def test_groups_that_differ_in_geometry_or_model_are_not_equal():
    """Nothing that is kept by groups may be taken for that of another contact."""
    line, point = Groups(1.0, 0.1, 0.0), Groups(1.0, 0.1, 0.0, geometry="point")
    with_exit = dataclasses.replace(line, model=contact(cavitation="exit").groups.model)
    assert contact(cavitation="none").groups.model == line.model
    assert line != point and line != with_exit and hash(line) != hash(point)
    assert "point" in repr(point) and repr(line) == "Groups(speed=1.0, load=0.1, roughness=0.0)"
    for geometry in ("ball", None, 3):
        with pytest.raises(InputError, match="'line' or 'point'"):
            Groups(1.0, 0.1, 0.0, geometry=geometry)
