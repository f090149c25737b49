"""The laws of dry contact, of the rough contact at rest, and of slow speed, against the solver and against themselves."""

import itertools
import math

import numpy as np
import pytest
from scipy.integrate import quad

import stribeck as sb
from evidence.formulas import followed, relative_error
from stribeck import InputError
from stribeck.asymptotics import OutOfRangeWarning, boundary, perturbation, rest

POSITIONS = np.linspace(-0.9, 0.9, 181)


def orders(steps, errors):
    return np.diff(np.log(np.abs(errors))) / np.diff(np.log(steps))


def slow(load, kappa, share):
    """Return the state in which the fluid should carry ``share`` of the load."""
    return sb.Groups(float(kappa**2 * np.sqrt(share / perturbation.phi(load))), load, kappa * load)


# --- at rest ---


def test_the_second_terms_at_rest_are_right(subtests):
    for formula, order in [(rest.gap, 2.0), (rest.central_gap, 3.0), (rest.offset, 4.0)]:
        with subtests.test(formula=formula, order=order):
            kappas = (4e-3, 2e-3, 1e-3)
            x = POSITIONS[20:-20]
            field = (x,) if formula.predicts == "gap" else ()
            errors = []
            for kappa in kappas:
                state = sb.solve(sb.Groups(0.0, 0.1, 0.1 * kappa), rtol=1e-10)
                right = state.profile(x).gap if field else getattr(state, formula.predicts)
                found = [formula.function(state.groups, *field, terms=terms) for terms in (1, 2)]
                first, second = (np.abs(value - right).max() for value in found)
                assert second < 0.1 * first
                errors.append(second / np.abs(right).max())
            assert orders(kappas, errors) == pytest.approx(order, abs=0.1)


def test_the_second_term_of_small_indentation_is_right():
    law = rest.central_gap_small_indentation
    states = followed(law)
    errors = [relative_error(law, groups, terms=2) for groups in states.values()]
    assert orders(list(states), errors) == pytest.approx(2, abs=0.05)
    assert abs(errors[0]) < 1e-4


# --- phi ---


def nested_phi(load):
    """Return phi by two nested adaptive integrals in artanh(x)."""
    A = -0.5 * math.log(load)
    # Beyond, ln cosh u is u - ln 2 and all decays with exp(-u).
    points = [min(1.0, math.sqrt(2 * A)), 4.0]

    def g(u):
        return math.log1p(2 * math.sinh(u / 2) ** 2)

    def integral(f, low):
        edges = [low, *(point for point in points if point > low), max(low, 4.0) + 18]
        return sum(quad(f, a, b, epsabs=0, epsrel=3e-13, limit=200)[0] for a, b in itertools.pairwise(edges))

    first, second = (integral(lambda u, k=k: g(u) ** k / (A + g(u)) ** 3 / math.cosh(u) ** 2, 0.0) for k in (0, 1))
    excess = second / first

    def pressure(u):
        return -integral(lambda v: (g(v) - excess) / (A + g(v)) ** 3 / math.cosh(v) ** 2, u)

    def integrand(u):
        return math.tanh(u) / math.cosh(u) * (A + 3 * excess - 2 * g(u)) / (A + g(u)) ** 4 * pressure(u)

    edges = [0.0, *points, 22.0]
    found = sum(quad(integrand, a, b, epsabs=0, epsrel=1e-11, limit=100)[0] for a, b in itertools.pairwise(edges))
    return -4 / math.pi * found


@pytest.mark.filterwarnings("ignore::scipy.integrate.IntegrationWarning")
def test_phi_has_ten_digits(subtests):
    for load in [1e-300, 1e-8, 0.1, 0.7, 0.99]:
        with subtests.test(load=load):
            assert perturbation.phi(load) == pytest.approx(nested_phi(load), rel=2e-11)


# --- slow speed ---


def test_the_slope_of_the_pressure_of_first_order_is_that_of_the_thin_film_equation():
    groups = sb.Groups(1e-3, 0.2, 0.02)
    x, step = np.array([-0.95, -0.4, 0.1, 0.7]), 1e-5
    h, h_star = rest.gap.function(groups, x), perturbation.flux_gap.function(groups)
    for printed, power in ((False, 3), (True, 1)):
        right, left = (perturbation.fluid_pressure_first.function(groups, x + s, printed=printed) for s in (step, -step))
        assert (right - left) / (2 * step) == pytest.approx(groups.speed * (h - h_star) / h**power, rel=1e-6)


def test_the_slope_of_the_pressure_of_second_order_is_that_of_the_thin_film_equation():
    # The exact slope for the gap to first order, of which the even part is of second order.
    x, step, change = np.array([0.2, 0.5, 0.9]), 1e-5, 1e-3
    groups = sb.Groups(change, 0.2, 0.2)  # kappa = 1

    def even_slope(law):
        # Of an even function; the odd part of its slope.
        return sum(sign * (law(sign * x + step) - law(sign * x - step)) for sign in (1, -1)) / (4 * step)

    found = even_slope(lambda y: perturbation.fluid_pressure_second.function(groups, y))
    h_star = perturbation.flux_gap.function(groups)
    h = np.array([perturbation.gap_first.function(groups, y) for y in (x, -x)])
    slope = change * (h - h_star) / h**3
    assert found == pytest.approx((slope[0] - slope[1]) / 2, rel=1e-3, abs=0)


def test_phi_is_the_load_of_the_pressure_of_second_order():
    groups = sb.Groups(1.0, 0.3, 0.3)
    t, w = np.polynomial.legendre.leggauss(60)
    x = np.sin(t * math.pi / 2)
    dx = w * math.pi / 2 * np.cos(t * math.pi / 2)
    load = 2 / math.pi * dx @ perturbation.fluid_pressure_second.function(groups, x)
    assert load == pytest.approx(perturbation.phi(0.3), rel=1e-7)
    first = perturbation.fluid_pressure_first.function(groups, x)
    assert -(dx * x) @ first == pytest.approx(perturbation.pressure_moment(0.3), rel=1e-7)
    H = rest.gap.function(groups, x)
    shear = dx @ (1 / H + 3 * (H - perturbation.flux_gap.function(groups)) / H**2)
    assert shear == pytest.approx(perturbation.shear(0.3), rel=1e-5)


def test_the_printed_fluid_share_is_far_off():
    groups = slow(0.1, 1e-4, 1e-4)
    law = boundary.fluid_load_share
    true = law(groups)
    assert true == pytest.approx(1e-4, rel=1e-9)
    # pi**2 from 6 pi eta U a, pi/2 from the phi without 2/pi, and the power of the wrong sign.
    assert law(groups, printed=True) / true == pytest.approx(math.pi**3 / 2, rel=1e-12)
    assert law(groups, form="printed") / true == pytest.approx(6946, abs=1)
    assert law(groups, form="printed", printed=True) / true == pytest.approx(6946 * math.pi**2, rel=2e-4)
    assert law(groups, form="closed") / true == pytest.approx(1, abs=4e-3)
    assert boundary.contact_load_share(groups) == 1 - true


def test_the_viscous_friction_is_that_of_each_definition(subtests):
    for definition in ["published", "balanced"]:
        with subtests.test(definition=definition):
            kappas, errors = (1e-3, 1e-4, 1e-5), []
            for kappa in kappas:
                groups = slow(1e-3, kappa, 1e-6)
                right = sb.solve(groups, rtol=1e-8).friction(beta=1.0, definition=definition).fluid
                errors.append(boundary.viscous_friction.function(groups, 1.0, definition) / right - 1)
            assert np.polyfit(np.log(kappas), np.log(np.abs(errors)), 1)[0] == pytest.approx(2 / 3, abs=0.06)
            assert abs(errors[-1]) < 0.011


def test_the_viscous_part_makes_the_friction_right_to_the_next_order():
    groups = slow(0.1, 1e-4, 1e-2)
    error = {name: abs(relative_error(boundary.friction, groups, viscous=name)) for name in ("published", "neglected")}
    assert error["neglected"] > 0.01
    assert error["published"] < 2e-4
    share = boundary.fluid_load_share.function(groups)
    assert boundary.friction.function(groups, 0.2, 5.0, viscous="neglected") == pytest.approx(0.2 * (1 - share), rel=1e-14)
    printed = boundary.friction.function(groups, 0.2, 5.0, printed=True)
    assert printed == pytest.approx(0.2 * (1 - math.pi**3 / 2 * share), rel=1e-12)


# --- out of range ---


def test_from_the_edge_outwards_the_contact_has_no_gap():
    groups = sb.Groups(1e-14, 0.1, 1e-6)
    for law in (rest.gap, perturbation.gap_first):
        with pytest.warns(OutOfRangeWarning, match="is undefined"):
            assert np.isnan(law(groups, np.array([-1.5, -1.0, 0.0, 1.0]))).tolist() == [True, True, False, True]


# --- out of range ---


def test_phi_refuses_what_is_no_load(subtests):
    for load in [0.0, -0.1, math.nan, math.inf, "0.1", None, [0.1, -1.0]]:
        with subtests.test(load=load):
            with pytest.raises(InputError, match="load"):
                perturbation.phi(load)
    with pytest.raises(InputError, match="'quadrature', 'closed'"):
        perturbation.phi(0.1, "best")
