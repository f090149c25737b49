"""Where the logarithm in the friction of a ball ends: the constants of the whole ball are those of Stokes flow."""

import math

import numpy as np
import pytest
from scipy.integrate import trapezoid

import stribeck as sb
from evidence import sphere_along_wall
from stribeck.asymptotics.point.logarithm import LOGARITHM_COEFFICIENT, far_integral
from stribeck.contacts import cut_off
from stribeck.equations.point.observables import FrictionWithin
from stribeck.solver.point.solve import solve_cold


def test_a_sphere_along_a_wall_has_the_constants_of_stokes_flow():
    # Dean and O'Neill, Goldman, Cox and Brenner: 1.5675 at arcosh(1 + gap) = 1, 2.6475 at 0.3.
    assert abs(sphere_along_wall.force(math.cosh(1) - 1) - 1.5675) < 5e-5
    assert abs(sphere_along_wall.force(math.cosh(0.3) - 1) - 2.6475) < 5e-5
    found = sphere_along_wall.wall_constant()
    assert abs(found - cut_off.CUT_OFF_SLIDING) < 2e-6
    assert abs(found - 0.9588) > 4e-3  # as printed in 1967
    assert abs(sphere_along_wall.wall_constant(turning=True) - cut_off.CUT_OFF_ROTATION) < 2e-6


@pytest.mark.quick
def test_the_logarithm_joins_the_lubrication_film_to_the_whole_ball():
    h, slope = 1e-6, 1e-3  # a rigid ball: h in R, a/R; the gap over u is h/slope**2
    finite = -math.pi * (8 / 15 * math.log(2 * h / slope**2) + 0.4)
    whole = math.pi * (8 / 15 * math.log(1 / h) + cut_off.CUT_OFF_SLIDING)
    assert math.isclose(finite + float(far_integral(slope)), whole, rel_tol=1e-12)
    assert math.isclose(math.exp(float(far_integral(0.1)) / LOGARITHM_COEFFICIENT), 50.340, rel_tol=1e-5)
    assert math.isclose(float(far_integral(0.1, 30.0)), LOGARITHM_COEFFICIENT * math.log(30), rel_tol=1e-12)


@pytest.mark.quick
def test_a_wetted_radius_in_the_contact_is_refused():
    with pytest.raises(sb.InputError, match="wetted_radius = 0.9; .*exceed 1"):
        far_integral(0.1, 0.9)


def test_the_shear_within_a_radius_is_its_integral():
    state = solve_cold(sb.Groups(1e-2, 1e-3, 1e-4, geometry="point"), 1e-5)
    fine = state.work.fine
    within = FrictionWithin.of(fine.equations, fine.unknowns, state.values)
    r, of_r = np.polynomial.legendre.leggauss(200)
    angle = np.linspace(0.0, np.pi, 201)
    for radius in (1.5, 6.0):
        x, y = (0.5 * radius * (1 + r) * function(angle)[:, None] for function in (np.cos, np.sin))
        inverse = trapezoid(1 / state.fields(x, y).gap, angle, axis=0)  # of half the disc
        found = 2 * 1e-2 / 6 * float(inverse * (0.5 * radius) ** 2 * (1 + r) @ of_r)
        stated = state.values["J_couette"] + within.far.couette * 1e-2 * np.log(radius) + within(0, np.log(radius))
        assert stated == pytest.approx(found, rel=1e-4)
