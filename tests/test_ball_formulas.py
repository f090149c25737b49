"""The formulas of the ball against solved states, themselves, and the problems that their constants come from."""

import json
import math
import re
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import minimize_scalar
from scipy.special import k0, k1, kn

import stribeck as sb
from evidence.formulas import FIELDS, followed, relative_error
from stribeck.asymptotics import FORMULAS, OutOfRangeWarning, constants, film_layers, uniform
from stribeck.asymptotics.point import (
    boundary,
    film,
    friction,
    hertz,
    regressions,
    rest,
    rigid,
    sharing,
)

SMOOTH = {
    1e-6: (1.0481845747e-4, 2.0583163e-5, 7.8641938e-5),
    1e-4: (1.6207726668e-3, 6.2311211e-4, 1.200448735e-3),
    1e-2: (2.453378e-2, 1.51876e-2, 1.76548e-2),
    1e2: (7.486183, 7.235584, 7.235584),
}
"""Central gap, minimum gap and minimum on the middle line of smooth states, by an independent prototype."""

AT_REST = {1e-4: (-0.9996697160, 2.302726719e-4), 1e-2: (-0.966814228, 2.316927206e-2)}
"""Offset and central gap at load 1e-3, by the same."""


SOLVED = json.loads((Path(__file__).parent / "data" / "ball_states.json").read_text())
"""States of the solver that the fitted laws were made from; mixed: speed, load, kappa, contact share, central gap, J;
both: speed, load, kappa, contact share, J, J_pcx; smooth: speed, central gap, minimum, minimum on the middle line, J;
slow: speed, load, kappa, fluid share, J, J_pcx."""


def ball(speed, load=1e-3, kappa=0.0):
    return sb.Groups(speed, load, kappa * np.asarray(load) ** (2 / 3), geometry="point")


def columns(name):
    return np.array(SOLVED[name]).T


def viscous(groups, J, beta):
    far = boundary.far_integral(groups.slope(beta), film=film.film_of(groups.speed))
    return 0.75 * beta * groups.load ** (1 / 3) * (J + groups.speed * far)


def order(steps, errors):
    return np.polyfit(np.log(steps), np.log(np.abs(errors)), 1)[0]


# --- the table ---


def test_the_table_holds_formulas_of_both_geometries_and_each_refuses_the_other():
    for formula in FORMULAS:
        assert formula.name.startswith("point.") == (formula.geometry == "point")
        other = sb.Groups(1e-3, 0.1, 1e-3, geometry="line" if formula.geometry == "point" else "point")
        assert not formula.valid(other)
        with pytest.raises(sb.InputError, match=f"^{formula.name} is about .*geometry = "):
            formula(other, *([0.3] if formula.predicts in FIELDS else []))


# --- dry ---


@pytest.mark.quick
def test_the_gap_of_hertz_is_that_of_its_pressure():
    def deflection(r):
        # 2/pi**2 times the potential of the pressure, by rings, off the ring at r.
        def ring(s):
            from scipy.special import ellipk

            return math.sqrt(1 - s * s) * s * 4 * ellipk(4 * r * s / (r + s) ** 2) / (r + s)

        return 2 / math.pi**2 * quad(ring, 0, 1)[0]

    groups = ball(0.0)
    for r in (1.01, 1.2, 2.0, 5.0):
        assert math.isclose(float(hertz.gap(groups, r)), hertz.HERTZ_OFFSET + r * r / 2 + deflection(r), rel_tol=1e-6)
    assert float(hertz.gap(groups, 0.7)) == 0 and float(hertz.pressure(groups, 0.6)) == pytest.approx(0.8)


# --- at rest ---


def test_the_ball_at_rest_is_met_to_the_third_order():
    for kappa, (offset, central) in AT_REST.items():
        groups = ball(0.0, kappa=kappa)
        assert abs(rest.central_gap(groups, terms=2) - central) < 3 * kappa**3
        assert abs(rest.offset(groups, terms=2) - offset) < 3 * kappa**3 + 1e-10
        assert 1.3 < (central - rest.central_gap(groups)) / kappa**2 < 1.5


@pytest.mark.quick
def test_the_correction_of_the_pressure_has_catalans_constant_in_the_middle_and_a_shift_of_the_edge():
    assert math.isclose(float(rest.pressure_correction(0.0)), -0.5 - rest.CATALAN, rel_tol=1e-12)
    near = 1 - 1e-8
    assert math.isclose(float(rest.pressure_correction(near)) * math.sqrt(1 - near**2), -1, rel_tol=2e-4)
    inside = float(rest.gap(ball(0.0, kappa=1e-3), 0.0, terms=2))
    assert inside == pytest.approx(float(rest.central_gap(ball(0.0, kappa=1e-3), terms=2)), rel=1e-12)


def test_the_correction_carries_the_load_that_the_ring_at_the_edge_takes_back():
    r, w = np.polynomial.legendre.leggauss(200)
    theta, w = math.pi / 4 * (r + 1), math.pi / 4 * w  # r = sin(theta): the root at the edge is smooth
    load = 2 * math.pi * (w * np.cos(theta) * np.sin(theta)) @ rest.pressure_correction(np.sin(theta))
    assert math.isclose(load, -(math.pi**3) / 4, rel_tol=1e-8)


# --- smooth ---


def test_the_central_film_is_met_to_the_order_after_the_leakage():
    speeds = (1e-6, 1e-4, 1e-2)
    errors = [float(film.central_gap_slow(ball(speed))) / SMOOTH[speed][0] - 1 for speed in speeds]
    assert np.abs(errors).max() < 0.014 and np.abs(errors[:2]).max() < 6e-4
    without = [float(film.central_gap_slow(ball(speed), leakage=False)) / SMOOTH[speed][0] - 1 for speed in speeds[:2]]
    assert abs(order(speeds[:2], without) - 0.2) < 0.05
    assert math.isclose(constants.BALL_FILM_CONSTANT, 0.42480, abs_tol=5e-6)


def test_the_minimum_on_the_middle_line_is_that_of_the_outlet_for_the_film_that_reaches_it():
    errors = [float(film.minimum_gap_on_axis(ball(speed))) / SMOOTH[speed][2] - 1 for speed in (1e-6, 1e-4, 1e-2)]
    assert np.all(np.abs(errors) < (7e-4, 3.5e-3, 0.017))
    assert abs(order((1e-6, 1e-4, 1e-2), errors) - 0.38) < 0.08


def test_the_minimum_of_the_outlet_over_the_film_that_comes_is_the_stated_power():
    def lowest(share):
        layer = film_layers.outlet(film=constants.FILM_CONSTANT * share)
        return minimize_scalar(lambda xi: float(layer.gap(np.array([xi]))[0]), bounds=(0.0, 1.0), method="bounded").fun

    one, two = film.OUTLET_COEFFICIENTS
    for share in (0.85, 0.95):
        log = math.log(share)
        assert math.isclose(lowest(share) / constants.MINIMUM_CONSTANT, math.exp(log * (one + two * log)), rel_tol=3e-4)


# --- fast ---


@pytest.mark.quick
def test_the_lift_is_the_integral_over_the_bessel_functions():
    def integrand(k):
        t = math.sqrt(2) * k
        return k * k0(t) * (-0.8 * k**2 * k1(t) / math.sqrt(2) + 0.4 * k**3 * kn(2, t))

    assert math.isclose(0.8 * quad(integrand, 0, 60)[0], rigid.LIFT_COEFFICIENT, rel_tol=1e-9)
    assert math.isclose(18 * math.pi * rigid.LIFT_COEFFICIENT / 4, 0.416, abs_tol=5e-4)


@pytest.mark.quick
def test_the_pressure_of_the_fast_ball_obeys_reynolds():
    groups = ball(1e3)
    h0 = float(rigid.minimum_gap(groups))

    def flux(r):
        # h**3 times gradient of p, the angular mode 1, at r and the next points.
        step = 1e-4 * r
        p = [float(rigid.fluid_pressure(groups, r + k * step)) for k in (-1, 0, 1)]
        return (h0 + r * r / 2) ** 3 * r * (p[2] - p[0]) / (2 * step), p[1]

    r = 1.3 * math.sqrt(h0)
    d = 1e-3 * r
    outward = (flux(r + d)[0] - flux(r - d)[0]) / (2 * d) / r
    assert math.isclose(outward - (h0 + r * r / 2) ** 3 * flux(r)[1] / r**2, 1e3 * r, rel_tol=1e-4)


# --- slow ---


@pytest.mark.quick
def test_the_fluids_share_has_its_limits_and_its_closed_form():
    loads = np.exp(-3 * np.geomspace(2e-3, 220, 12))
    np.testing.assert_allclose(boundary.phi(loads, "closed"), boundary.phi(loads), rtol=2.6e-3)
    heavy = math.exp(-3e-4)
    assert math.isclose(float(boundary.phi(heavy)) * 1e-12, boundary.HEAVY_LIMIT, rel_tol=5e-3)
    assert 0.95 < float(boundary.phi(1e-300)) * (math.log(1e300) / 3) ** 6 / boundary.LIGHT_LIMIT < 1
    with pytest.warns(OutOfRangeWarning):
        assert np.isnan(boundary.phi(1.0))


@pytest.mark.quick
def test_the_pressure_of_slow_fluid_obeys_its_equation_and_is_found_by_other_elements(monkeypatch):
    contact = boundary.slow_contact(2.3)
    r, H, P, slope = (getattr(contact, name)[4] for name in ("r", "H", "P", "slope"))
    flux = r * H**3 * slope
    found = np.gradient(flux, r, edge_order=2)[4:-4] / r[4:-4] - (H**3 * P / r**2)[4:-4]
    np.testing.assert_allclose(found, (r / (1 - r**2))[4:-4], rtol=0.03)
    monkeypatch.setattr(boundary, "ELEMENTS", 17)
    boundary.slow_contact.cache_clear()
    finer = boundary.slow_contact(2.3)
    boundary.slow_contact.cache_clear()
    for name in ("share", "shear", "moment"):
        assert math.isclose(getattr(finer, name)(), getattr(contact, name)(), rel_tol=1e-11)


# --- the trade ---


@pytest.mark.quick
def test_the_groups_of_the_trade_are_those_of_a_contact_in_si():
    R, E, F, eta, mean = 9.5e-3, 1.6e6, 1.3, 0.01, 0.05
    a = (3 * F * R / (4 * E)) ** (1 / 3)
    groups = ball(3 * math.pi * eta * 2 * mean * R**3 / (E * a**4))
    U, W = eta * mean / (2 * E * R), F / (2 * E * R**2)
    M = F / (2 * E * R**2) * (eta * 2 * mean / (2 * E * R)) ** -0.75
    scale = a**2 / R
    found = float(regressions.hamrock_dowson_soft(groups, a / R)) * scale
    assert math.isclose(found, R * 7.32 * (1 - 0.72 * math.exp(-0.28)) * U**0.64 * W**-0.22, rel_tol=1e-12)
    assert math.isclose(float(regressions.de_vicente(groups, a / R)) * scale, R * 3.3 * U**0.6 * W**-0.14, rel_tol=1e-12)
    H = 3.18 * 1.63 ** (-14 / 25) * M ** (-2 / 15)
    height = R * math.sqrt(eta * 2 * mean / (2 * E * R))
    assert math.isclose(float(regressions.nijenbanning_venner_moes(groups)) * scale, H * height, rel_tol=0.02)


def test_the_regressions_are_off_by_what_is_stated():
    errors = {
        law.name: [float(law(ball(speed))) / SMOOTH[speed][0] - 1 for speed in (1e-4, 1e-2)]
        for law in (regressions.hamrock_dowson_soft, regressions.de_vicente, regressions.nijenbanning_venner_moes)
    }
    np.testing.assert_allclose(errors["point.regressions.hamrock_dowson_soft"], [-0.235, -0.037], atol=2e-3)
    np.testing.assert_allclose(errors["point.regressions.de_vicente"], [0.018, 0.066], atol=2e-3)
    np.testing.assert_allclose(errors["point.regressions.nijenbanning_venner_moes"], [0.069, 0.078], atol=2e-3)


# --- the fitted laws, on the states of the solver ---


def test_the_laws_of_the_smooth_ball_are_within_their_stated_errors_at_every_speed():
    speed, central, minimum, _, J = columns("smooth")
    groups = ball(speed)
    assert np.abs(film.central_gap(groups) / central - 1).max() <= film.central_gap.worst
    slow = film.minimum_gap.valid(groups)
    assert slow.sum() > 10
    assert np.abs(film.minimum_gap.function(groups) / minimum - 1)[slow].max() <= film.minimum_gap.worst
    right = viscous(groups, J, 0.5)
    assert np.abs(friction.viscous_friction_smooth.function(groups, 0.5) / right - 1).max() <= 1e-3


def test_friction_of_thick_films_is_that_of_solved_states_where_the_film_is_as_thick_as_the_gap_at_the_rim():
    """Logarithms alone gave a negative friction."""
    wide = friction.viscous_friction_smooth.worst
    for speed, load, beta, error in ((1e3, 0.1, 1.0, wide), (1e4, 1e-3, 1.0, 1e-3), (8.0, 2e-3, 1.0, 1.5e-3)):
        groups = ball(speed, load)
        for definition in ("balanced", "published"):
            solved = sb.solve(groups, rtol=1e-4).friction(boundary_friction=0.0, beta=beta, definition=definition).total
            found = float(friction.viscous_friction_smooth.function(groups, beta, definition))
            assert found == pytest.approx(solved, rel=error)
    groups, thick = ball(1e2, 0.5, 1e-3), {"boundary_friction": 1.0, "beta": 1.0}
    solved = sb.solve(groups, rtol=1e-4).friction(**thick).total
    assert float(friction.friction(groups, **thick)) == pytest.approx(solved, rel=friction.friction.worst)


def test_the_laws_of_the_smooth_ball_have_their_limits():
    fast, slow = ball(1e12), ball(1e-12)
    assert math.isclose(float(film.central_gap(fast)), float(rigid.minimum_gap(fast)), rel_tol=1e-4)
    assert math.isclose(float(film.central_gap(slow)), float(film.central_gap_slow(slow)), rel_tol=1e-4)
    J = float(friction.smooth_integral(1e12))
    h0 = float(rigid.minimum_gap(fast))
    assert math.isclose(J, -math.pi * 1e12 * (8 / 15 * math.log(2 * h0) + 0.4), rel_tol=1e-4)
    theta = np.linspace(0, math.pi / 2, 20001)
    shear = 2 * np.trapezoid(np.cos(theta) ** 1.4, theta) / (3 * constants.BALL_FILM_CONSTANT)
    assert math.isclose(friction.SLOW_INTEGRAL, shear, rel_tol=1e-7)
    assert math.isclose(float(friction.smooth_integral(1e-15)) / 1e-15**0.4, shear, rel_tol=2e-3)


def test_the_boundary_regime_with_its_edges_is_within_its_stated_error():
    speed, load, kappa, share, J, pcx = columns("slow")
    groups = ball(speed, load, kappa)
    inside = boundary.fluid_load_share.valid(groups)
    assert inside.sum() > 30
    found = boundary.fluid_load_share.function(groups)
    assert np.abs(found / share - 1)[inside].max() <= boundary.fluid_load_share.worst
    found = boundary.viscous_friction.function(groups, 0.1)
    assert np.abs(found / viscous(groups, J, 0.1) - 1)[inside].max() <= boundary.viscous_friction.worst
    found = boundary.viscous_friction.function(groups, 0.1, "published")
    right = viscous(groups, J - pcx, 0.1)
    assert np.abs(found / right - 1)[inside].max() <= boundary.viscous_friction.worst


def test_the_edges_widen_the_fluids_share_as_the_power_two_thirds():
    speed, load, kappa, share, _, _ = columns("slow")
    narrow = np.isclose(load, 1e-2) & (kappa < 2e-3)
    found = boundary.fluid_load_share.function(ball(speed, load, kappa), with_edges=False)
    assert abs(order(kappa[narrow], (1 - found / share)[narrow]) - 2 / 3) < 0.06


def test_share_and_friction_at_any_speed_are_within_their_stated_errors():
    speed, load, kappa, share, _, J = columns("mixed")
    groups = ball(speed, load, kappa)
    inside = sharing.contact_load_share.valid(groups)
    assert inside.sum() > 20
    found = sharing.contact_load_share.function(groups)
    assert np.abs(found / share - 1)[inside].max() <= sharing.contact_load_share.worst
    worst = []
    for beta in (1.0, 0.3, 0.1):
        right = share + viscous(groups, J, beta)
        worst.append(np.abs(friction.friction.function(groups, 1.0, beta) / right - 1).max())
    assert 0.03 < max(worst) <= friction.friction.worst
    inside = friction.viscous_friction.valid(groups)
    found = friction.viscous_friction.function(groups, 0.1)
    assert np.abs(found / viscous(groups, J, 0.1) - 1)[inside].max() <= friction.viscous_friction.worst


def test_the_share_under_the_thickest_film_and_the_largest_load_is_within_its_stated_error():
    groups = ball(0.0207, 0.7, 6.92e-3)
    error = float(sharing.contact_load_share(groups)) / sb.solve(groups, rtol=1e-4).contact_load_share - 1
    assert 0.09 < error <= sharing.contact_load_share.worst


def test_friction_by_both_definitions_is_within_its_stated_error_over_the_whole_box(subtests):
    for definition in ["balanced", "published"]:
        with subtests.test(definition=definition):
            speed, load, kappa, share, J, pcx = columns("both")
            groups = ball(speed, load, kappa)
            J = J if definition == "balanced" else J - pcx
            worst = []
            for beta in (1.0, 0.3, 0.1):
                found = friction.friction.function(groups, 1.0, beta, definition)
                worst.append(np.abs(found / (share + viscous(groups, J, beta)) - 1).max())
            assert 0.12 < max(worst) <= friction.friction.worst
            inside = friction.viscous_friction.valid(groups)
            found = friction.viscous_friction.function(groups, 0.1, definition)
            error = np.abs(found / viscous(groups, J, 0.1) - 1)[inside]
            assert error.max() <= (friction.viscous_friction.worst if definition == "balanced" else 0.08)


def test_the_moment_of_slow_contact_pressure_is_that_of_its_quadrature_and_vanishes_with_the_contact():
    for A in (0.1, 1.0, 10.0):
        assert float(uniform.first_moment(A, friction.FIRST_MOMENT_COEFFICIENTS)) == pytest.approx(
            -boundary.slow_contact(A).moment(), rel=3e-3
        )
    thick = ball(10.0, 1e-3, 3e-4)
    assert friction.viscous_friction.function(thick, 0.1, "published") == friction.viscous_friction.function(thick, 0.1)


@pytest.mark.quick
def test_a_disc_of_liquid_ends_with_a_pressure_that_the_published_definition_has():
    for groups in (ball(1e-2), ball(1e-2, 0.1, 1e-9)):
        balanced, published = (
            float(friction.viscous_friction.function(groups, 0.2, definition, 5.0)) for definition in ("balanced", "published")
        )
        added = 0.75 * 0.2 * groups.load ** (1 / 3) * 0.4 * math.pi * groups.speed / (1 + 2 * film.film_of(1e-2) / 5.0**2)
        assert published - balanced == pytest.approx(added, rel=1e-9)


def test_the_speed_of_a_share_and_the_smooth_integral_are_as_near_as_they_were_fitted():
    speed, load, kappa, share, _, _ = columns("mixed")
    shared = (share > 0.05) & (share < 0.95)
    found = sharing.speed_of_share(ball(1.0, load[shared], kappa[shared]), 1 - share[shared])
    off = np.abs(np.log(found / speed[shared]))
    assert off.max() < 0.15 and np.median(off) < 0.085
    speed, _, _, _, J = columns("smooth")
    far = speed * float(boundary.far_integral(1.0, 15.0))
    assert np.abs((friction.smooth_integral(speed) - J) / (J + far)).max() < 8e-4


def test_share_and_speed_of_a_share_are_inverse():
    groups = ball(1.0, 0.03, 3e-3)
    for wanted in (0.05, 0.5, 0.99):
        speed = float(sharing.speed_of_share(groups, wanted))
        found = float(sharing.contact_load_share.function(ball(speed, 0.03, 3e-3)))
        assert math.isclose(1 - found, wanted, rel_tol=1e-9)
    assert np.isnan(sharing.speed_of_share(ball(1.0, 2.0, 1e-3)))
    with pytest.raises(sb.InputError, match="share = 1; a fraction of the load"):
        sharing.speed_of_share(groups, 1)


# --- judged by the solver ---

QUICKLY = [each for each in FORMULAS if each.geometry == "point" and each.plane == "rest"]


def test_the_error_of_a_formula_at_rest_vanishes_with_the_stated_order_and_is_within_the_stated_one(subtests):
    for formula in QUICKLY:
        with subtests.test(formula=formula):
            states = followed(formula)
            errors = np.abs([relative_error(formula, groups) for groups in states.values()])
            assert abs(order(list(states), errors) - formula.error_order) < 0.1
            for groups, error in zip(states.values(), errors, strict=True):
                if formula.valid(groups):
                    assert error <= 1.02 * formula.worst


@pytest.mark.slow
@pytest.mark.parametrize(
    "formula",
    [each for each in FORMULAS if each.geometry == "point" and each.small and each not in QUICKLY],
    ids=lambda formula: formula.name,
)
def test_the_error_of_another_formula_of_the_ball_vanishes_with_the_stated_order(formula):
    states = followed(formula)
    errors = np.abs([relative_error(formula, groups) for groups in states.values()])
    assert abs(order(list(states), errors) - formula.error_order) < 0.1


def test_the_states_of_the_fitted_laws_are_those_of_the_solver_of_today():
    speed, load, kappa, share, central, J = columns("mixed")
    for i in range(3, len(speed), 24):
        found = sb.solve(ball(float(speed[i]), float(load[i]), float(kappa[i])), rtol=1e-3)
        assert abs(found.contact_load_share - share[i]) < 1e-3
        assert math.isclose(found.central_gap, central[i], rel_tol=2e-3)
        assert math.isclose(found.J_balanced, J[i], rel_tol=4e-3)
    for speed, load, kappa, share, _, pcx in columns("both").T[8::32]:
        found = sb.solve(ball(speed, load, kappa), rtol=1e-3)
        assert abs(found.contact_load_share - share) < 1e-3
        assert math.isclose(found.J_pcx, pcx, rel_tol=4e-3)


def test_the_film_in_si_units_on_the_page_of_balls_is_the_formula():
    text = (Path(__file__).parents[1] / "docs" / "for_ball_on_disc.md").read_text()
    printed = next(line for line in text.splitlines() if line.startswith(r"$$h(0) = "))
    numbers = [float(Fraction(each)) for each in re.findall(r"\d+\.\d+|-?\d+/\d+", printed)]
    factor, speed_power, load_power, leakage, group_power, power = numbers
    for speed in np.geomspace(1e-4, 1.0, 5):
        ball = sb.PointContact(
            radius=0.01, modulus=1e6, load=1, viscosity=0.01, speed=speed, roughness=0, alpha=2, beta=0.1, boundary_friction=0
        )
        film_scale = ball.radius * (ball.viscosity * speed / (ball.modulus * ball.radius)) ** speed_power
        uniform_film = factor * film_scale * (ball.load / (ball.modulus * ball.radius**2)) ** load_power
        page = uniform_film * (1 + leakage * ball.groups.speed**group_power) ** power
        expected = film.central_gap_slow.function(ball.groups) * ball.hertz.indentation
        assert page == pytest.approx(expected, rel=5e-4)
