"""The ball in SI units: its inputs, its groups and scales, and what it refuses."""

import numpy as np
import pytest

import stribeck as sb

BALL = {
    "radius": "9.5 mm",
    "modulus": "1.6 MPa",
    "load": "1.3 N",
    "viscosity": "10 mPa*s",
    "entrainment_speed": "50 mm/s",
    "slide_to_roll": 0.5,
    "roughness": "0.4 um",
    "alpha": 2.0,
    "beta": 0.05,
    "boundary_friction": 0.9,
}


def ball(contact=sb.PointContact, **changes):
    inputs = BALL | changes
    return contact(**{name: value for name, value in inputs.items() if value is not None})


@pytest.mark.quick
def test_two_bodies_are_soft_in_series_and_curved_in_parallel(subtests):
    for contact in [sb.PointContact, sb.LineContact]:
        with subtests.test(contact=contact):
            moduli = {"youngs_modulus": "2 MPa", "poisson_ratio": 0.5, "youngs_modulus_2": "6 MPa", "poisson_ratio_2": 0.4}
            both = ball(contact, load=1.3, modulus=None, radius_2="20 mm", **moduli)
            assert 1 / both.modulus == pytest.approx(0.75 / 2e6 + 0.84 / 6e6, rel=1e-13)
            assert 1 / both.radius == pytest.approx(1 / 9.5e-3 + 1 / 20e-3, rel=1e-13)
            assert ball(contact, load=1.3, modulus=None, youngs_modulus="2 MPa", poisson_ratio=0.5).modulus == pytest.approx(
                2e6 / 0.75, rel=1e-13
            )


@pytest.mark.quick
def test_the_slide_to_roll_ratio_changes_the_sliding_speed_alone():
    rolling, sliding = ball(), ball(slide_to_roll=2.0)
    assert rolling.groups == sliding.groups
    assert (rolling.sliding_speed, sliding.sliding_speed) == pytest.approx((0.025, 0.1), rel=1e-13)
    assert rolling.replace(speed=0.2).slide_to_roll == 0.5  # replace takes what a ball keeps: the sum of both speeds


REFUSED = {
    "a load per length": ({"load": "30 N/m"}, "'30 N/m' is a load per unit length; .* that of a cylinder, LineContact"),
    "speed beside a ratio": (
        {"speed": "1 mm/s", "entrainment_speed": None},
        "give the mean of both surface",
    ),
    "a dry contact": ({"wetted_radius": "1 mm"}, "wetted_radius = 1 mm lies inside the contact, whose Hertz radius is 1.8 mm"),
    "half a second body": (
        {"modulus": None, "youngs_modulus": 1e6, "poisson_ratio": 0.5, "poisson_ratio_2": 0.3},
        "youngs_modulus_2 is missing beside .* poisson_ratio_2 = 0.3",
    ),
    "a second body beside the modulus": ({"youngs_modulus_2": 1e6}, "give either modulus, or youngs_modulus"),
    "a slip": ({"wetted_radios": 1}, "is not an input of PointContact; did you mean wetted_radius"),
    "no load": ({"load": None}, 'load is missing; add a force, for example load = "1.3 N"'),
    "groups beyond double precision": ({"beta": 1e-200}, "leave the range of double precision"),
}


@pytest.mark.quick
def test_what_cannot_be_a_ball_is_refused_with_a_sentence(subtests):
    for changes, sentence in REFUSED.values():
        with subtests.test(changes=changes, sentence=sentence), pytest.raises(sb.InputError, match=sentence):
            ball(**changes)


@pytest.mark.quick
def test_a_force_on_a_cylinder_is_said_to_belong_to_a_ball():
    inputs = {name: value for name, value in BALL.items() if name != "slide_to_roll"}
    with pytest.raises(sb.InputError, match="a force is the load of a ball, PointContact or geometry = 'point'"):
        sb.LineContact(**inputs)


@pytest.mark.quick
def test_replaced_values_are_checked_too():
    with pytest.raises(sb.InputError, match="radius_2 is given without radius"):
        ball().replace(radius_2="1 cm")
    with pytest.raises(sb.InputError, match="lies inside the contact"):
        ball(wetted_radius="2 mm").replace(load="10 N")
    with pytest.raises(sb.InputError, match="groups.geometry = 'line'; a ball has 'point'"):
        kept = {"radius": 1, "modulus": 1, "viscosity": 1, "alpha": 1, "beta": 1, "boundary_friction": 1}
        sb.PointContact.from_groups(sb.Groups(1, 1, 1), **kept)


@pytest.mark.quick
def test_a_ball_takes_no_profile():
    with pytest.raises(sb.InputError, match="profiles are those of a line contact; a ball is round"):
        ball(profile=sb.profiles.Land("0.1 mm", "1 mm"))


CASE = """
[contact]
geometry = "point"
radius = "9.5 mm"
modulus = "1.6 MPa"
load = "{load}"
viscosity = "10 mPa*s"
entrainment_speed = "50 mm/s"
slide_to_roll = 0.5
roughness = "0.4 um"
alpha = 2.0
beta = 0.05
boundary_friction = 0.9
"""


def test_a_case_file_holds_a_ball(tmp_path):
    path = tmp_path / "ball.toml"
    path.write_text(CASE.format(load="1.3 N"))
    assert sb.load_case(path).contact == ball()


def test_a_case_file_that_is_no_ball_is_refused_with_a_sentence(subtests, tmp_path):
    for text, sentence in [
        (CASE.format(load="30 N/m"), r"\[contact\] load = '30 N/m' is a load per unit length; .* that of a cylinder"),
        (CASE.format(load="1.3 N").replace('"point"', '"line"'), "load = '1.3 N' is a force; expected a load per unit length"),
        (CASE.format(load="1.3 N").replace('"point"', '"ball"'), "geometry = 'ball' must be 'line' or 'point'"),
    ]:
        with subtests.test(text=text, sentence=sentence):
            path = tmp_path / "ball.toml"
            path.write_text(text)
            with pytest.raises(sb.InputError, match=sentence):
                sb.load_case(path)


def test_a_sweep_file_holds_balls(tmp_path):
    path = tmp_path / "sweep.toml"
    path.write_text(CASE.format(load="1.3 N").replace('load = "1.3 N"', "") + '[vary]\nload = ["0.5 N", "1 N"]\n')
    design = sb.load_sweep(path)
    assert design.physics["geometry"] == "point"
    np.testing.assert_allclose(
        design.groups[1], [ball(load=1).groups.speed, ball(load=1).groups.load, ball(load=1).groups.roughness]
    )
    assert set(design.inputs) == {*sb.PointContact.INPUTS.names, "entrainment_speed"} - {"wetted_radius"}
