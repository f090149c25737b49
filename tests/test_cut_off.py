"""Where the logarithm in the friction of a ball ends: the constant of the whole sphere is that of Stokes flow."""

import math

import pytest

import stribeck as sb
from stribeck.contacts import cut_off
from stribeck.evidence import sphere_along_wall


def test_a_sphere_along_a_wall_has_the_constant_of_stokes_flow():
    # Dean and O'Neill, Goldman, Cox and Brenner: 1.5675 at arcosh(1 + gap) = 1, 2.6475 at 0.3.
    assert abs(sphere_along_wall.force(math.cosh(1) - 1) - 1.5675) < 5e-5
    assert abs(sphere_along_wall.force(math.cosh(0.3) - 1) - 2.6475) < 5e-5
    found = sphere_along_wall.wall_constant()
    assert abs(found - cut_off.WALL) < 2e-6
    assert abs(found - 0.9588) > 4e-3  # as printed in 1967


@pytest.mark.quick
def test_the_cut_off_joins_the_lubrication_film_to_the_whole_sphere():
    h, slope, speed = 1e-6, 1e-3, 1.0  # a rigid ball: h in R, a/R; the gap over u is h/slope**2
    finite = {
        "balanced": -math.pi * speed * (8 / 15 * math.log(2 * h / slope**2) + 0.4),
        "published": -math.pi * speed * 8 / 15 * math.log(2 * h / slope**2),
    }
    whole = math.pi * speed * (8 / 15 * math.log(1 / h) + cut_off.WALL)
    for definition, part in finite.items():
        X = float(cut_off.cut_off(slope, definition=definition))
        assert math.isclose(part + cut_off.LOGARITHM * speed * math.log(X), whole, rel_tol=1e-12)
    assert float(cut_off.cut_off(0.1)) == pytest.approx(50.340, abs=1e-3)
    assert float(cut_off.cut_off(0.1, 30.0)) == 30.0


@pytest.mark.quick
def test_a_wetted_radius_in_the_contact_and_an_unknown_definition_are_refused():
    with pytest.raises(sb.InputError, match="wetted_radius = 0.9; .*exceed 1"):
        cut_off.cut_off(0.1, 0.9)
    with pytest.raises(sb.InputError, match="definition = 'paper'; it must be 'balanced' or 'published'"):
        cut_off.cut_off(0.1, definition="paper")
