"""Where the logarithm in the friction of a ball ends: the constants of the whole ball are those of Stokes flow."""

import math

import pytest

import stribeck as sb
from evidence import sphere_along_wall

SLIDING, TURNING = 0.954293, 0.257268
"""Of Chaoui and Feuillebois, as test_point_solution.py finds them in the friction of a ball."""


def test_a_sphere_along_a_wall_has_the_constants_of_stokes_flow():
    # Dean and O'Neill, Goldman, Cox and Brenner: 1.5675 at arcosh(1 + gap) = 1, 2.6475 at 0.3.
    assert abs(sphere_along_wall.force(math.cosh(1) - 1) - 1.5675) < 5e-5
    assert abs(sphere_along_wall.force(math.cosh(0.3) - 1) - 2.6475) < 5e-5
    found = sphere_along_wall.wall_constant()
    assert abs(found - SLIDING) < 2e-6
    assert abs(found - 0.9588) > 4e-3  # as printed in 1967
    assert abs(abs(sphere_along_wall.wall_constant(turning=True)) - TURNING) < 2e-6


@pytest.mark.quick
def test_a_wetted_radius_in_the_contact_is_refused():
    with pytest.raises(sb.InputError, match="wetted_radius = 0.9; .*exceed|must be above 1"):
        sb.atlas.friction(sb.Groups(1e-3, 0.1, 1e-3, geometry="point"), wetted_radius=0.9)
