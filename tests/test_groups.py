"""Groups carry geometry and model; each geometry scales its own way."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from stribeck import Groups, InputError, LineContact

pytestmark = pytest.mark.quick


def test_groups_of_a_ball_follow_from_its_si_numbers():
    """The definitions, against a ball worked out by hand: a, u, p_Hz from Hertz, then kappa, a/R and the Hersey number."""
    R, E_star, F_N, eta, U, h_rms, alpha, beta = 9.5e-3, 1.6e6, 1.3, 0.01, 0.1, 4e-7, 2.0, 0.05
    a = (3 * F_N * R / (4 * E_star)) ** (1 / 3)
    u, p_Hz = a * a / R, 2 * a * E_star / (math.pi * R)
    groups = Groups(
        6 * eta * U * a / (u * u * p_Hz),
        6 * F_N / (math.pi**3 * beta**3 * R**2 * E_star),
        4 * h_rms / (math.pi**2 * alpha * beta**2 * R),
        geometry="point",
    )
    assert groups.relative_roughness == pytest.approx(h_rms / (alpha * u), rel=1e-12)
    assert groups.pressure_scale == pytest.approx(p_Hz / (beta * E_star), rel=1e-12)
    assert groups.slope(beta) == pytest.approx(a / R, rel=1e-12)
    assert groups.hersey_number(beta) == pytest.approx(eta * U * R / F_N, rel=1e-12)


def test_groups_that_differ_in_geometry_or_model_are_not_equal():
    """Nothing that is kept by groups may be taken for that of another contact."""
    line, point = Groups(1.0, 0.1, 0.0), Groups(1.0, 0.1, 0.0, geometry="point")
    plain, ends = (
        LineContact.from_groups(line, radius=1, modulus=1, viscosity=1, alpha=1, beta=1, boundary_friction=1, cavitation=each)
        for each in ("none", "exit")
    )
    assert plain.groups.model == line.model
    with_exit = replace(line, model=ends.groups.model)
    assert line != point and line != with_exit and hash(line) != hash(point)
    assert "point" in repr(point) and repr(line) == "Groups(speed=1.0, load=0.1, roughness=0.0)"


def test_a_geometry_that_there_is_not_is_refused(subtests):
    """With those that there are."""
    for geometry in ["ball", None, 3]:
        with subtests.test(geometry=geometry):
            with pytest.raises(InputError, match="'line' or 'point'"):
                Groups(1.0, 0.1, 0.0, geometry=geometry)
