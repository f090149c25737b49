"""The boundary layers at the edges of the contact: their own solutions, and the collapse of the solver onto them."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import minimize_scalar

import stribeck as sb
from stribeck.asymptotics import constants, edge_layer, film_layers

LAYERS = {"edge": edge_layer.layer, "inlet": film_layers.inlet, "outlet": film_layers.outlet}


def at(function, position):
    """Return one value of a function of arrays."""
    return float(function(np.array([position]))[0])


def slope(function, position, step=1e-3):
    """Return the derivative at one position, to fourth order in the step."""
    f = function(position + step * np.array([-2.0, -1.0, 1.0, 2.0]))
    return float((f[0] - 8 * f[1] + 8 * f[2] - f[3]) / (12 * step))


def minimum_gap(layer):
    """Return the minimum gap of the outlet and its position."""
    found = minimize_scalar(lambda xi: at(layer.gap, xi), bounds=(0.0, 1.0), method="bounded", options={"xatol": 1e-8})
    return found.fun, found.x


# --- constants ---


def test_the_inlet_selects_the_film_constant():
    assert abs(film_layers.inlet().constant - constants.FILM_CONSTANT) < 0.5e-9


def test_the_outlet_has_the_minimum_gap_of_the_constants():
    gap, position = minimum_gap(film_layers.outlet())
    assert abs(gap - constants.MINIMUM_CONSTANT) < 0.5e-8
    assert abs(position - constants.MINIMUM_POSITION) < 0.5e-5
    assert abs(gap / film_layers.inlet().constant - 0.75801004) < 0.5e-8


def test_the_edge_has_the_gap_and_the_pressure_of_the_constants():
    layer = edge_layer.layer()
    assert abs(at(layer.gap, 0.0) - constants.EDGE_GAP) < 0.5e-10
    assert abs(at(layer.pressure, 0.0) - constants.EDGE_PRESSURE) < 0.5e-8


def test_the_minimum_is_that_of_slow_films_of_the_solver(solved):
    fast, slow = (solved(speed, 0.1, 0.0, 1e-8) for speed in (1e-7, 1e-8))
    gaps = [state.minimum_gap / state.groups.speed**0.6 for state in (fast, slow)]
    places = [(state.minimum_position - 1) / state.groups.speed**0.4 for state in (fast, slow)]
    assert abs(gaps[1] - (gaps[0] - gaps[1]) / (10**0.4 - 1) - constants.MINIMUM_CONSTANT) < 1e-6
    assert abs(places[1] - (places[0] - places[1]) / (10**0.4 - 1) - constants.MINIMUM_POSITION) < 1e-4


# --- convergence ---


def test_constants_converge_with_the_reach(subtests):
    for name, constant, bound in (
        ("edge", lambda reach: at(edge_layer.layer(reach).gap, 0.0), 2e-11),
        ("film", lambda reach: film_layers.inlet(reach).constant, 1e-11),
    ):
        with subtests.test(name):
            errors = np.abs(np.diff([constant(reach) for reach in (1e3, 1e4, 1e5, 1e6)]))
            assert errors[1] < errors[0] / 100 and errors[2] < errors[1] / 50
            assert errors[2] < bound


# --- equations ---


def principal_value(layer, xi):
    """Return PV int P'(eta)/(xi - eta) d eta by adaptive quadrature, far field as of Hertz."""

    def gradient(eta):
        return slope(layer.pressure, eta)

    inner = -quad(gradient, xi - 3, xi + 3, weight="cauchy", wvar=xi, epsabs=1e-7)[0]
    edges = xi + 3 * 2.0 ** np.arange(11)
    outer = sum(
        quad(lambda eta: gradient(eta) / (xi - eta), *ends, epsabs=1e-7)[0]
        for a, b in zip(edges[:-1], edges[1:], strict=True)
        for ends in ((a, b), (2 * xi - b, 2 * xi - a))
    )
    far = quad(lambda v: -np.sqrt(2) / (1 + xi * v * v), 0, (edges[-1] - 2 * xi) ** -0.5, epsabs=1e-12)[0]  # s = v**-2
    return inner + outer + far


def test_the_curvature_of_the_gap_is_the_principal_value(subtests):
    for name, solve in LAYERS.items():
        with subtests.test(name):
            layer = solve()
            for xi in (-2.3, 1.7):
                curvature = slope(lambda points, gap=layer.gap: np.array([slope(gap, at, 1e-2) for at in points]), xi, 1e-2)
                assert abs(curvature + principal_value(layer, xi) / np.pi) < 1e-5 * max(1.0, abs(curvature))


def test_the_edge_obeys_the_contact_law():
    layer, xi = edge_layer.layer(), np.linspace(-40, 10, 137)
    assert np.abs(layer.pressure(xi) - np.exp(-layer.gap(xi))).max() < 1e-8


def test_the_films_obey_reynolds(subtests):
    for name, sign in [("inlet", -1), ("outlet", 1)]:
        with subtests.test(name=name, sign=sign):
            layer = LAYERS[name]()
            for xi in np.linspace(-20, 20, 43):
                gap = at(layer.gap, xi)
                assert abs(slope(layer.pressure, xi) - sign * (gap - layer.constant) / gap**3) < 1e-5


# --- far fields ---


def test_the_layer_carries_its_load_beside_that_of_hertz(subtests):
    for name, load in [("edge", np.pi / 2), ("inlet", 0.0), ("outlet", 0.0)]:
        with subtests.test(name=name, load=load):
            # Beyond the box P - P_H is of order |xi|**(-3/2) ln|xi|.
            line, layer = LAYERS[name]().line, LAYERS[name]()
            assert abs(line.weights @ layer.excess - load) < 0.02
            narrow = LAYERS[name](1e4)
            assert abs(line.weights @ layer.excess - load) < 0.2 * abs(narrow.line.weights @ narrow.excess - load)


def test_the_edge_joins_the_logarithmic_gap_and_that_of_hertz():
    layer = edge_layer.layer()
    assert abs(at(layer.gap, -1e3) + 0.5 * np.log(2e3)) < 1e-9
    outside = 2 * np.sqrt(2) / 3 * 1e4**1.5 - 0.5 * np.log(2e4)
    assert abs(at(layer.gap, 1e4) - outside) < 1e-3
    beyond = -np.array([3e5, 3e7])
    assert np.abs(layer.gap(beyond) + 0.5 * np.log(-2 * beyond)).max() < 1e-8


def test_the_pressure_at_the_edge_departs_from_that_of_hertz_as_stated():
    s = np.array([1e2, 1e3])
    found = (np.exp(-edge_layer.layer().gap(-s)) - np.sqrt(2 * s)) * s**2.5
    assert np.abs(found / (5 / (8 * np.sqrt(2))) - 1).max() < 1e-4


def test_the_films_join_the_uniform_film_and_the_gap_of_hertz(subtests):
    for name, sign in [("inlet", 1), ("outlet", -1)]:
        with subtests.test(name=name, sign=sign):
            layer, c = LAYERS[name](), film_layers.inlet().constant
            s = 1e5
            assert abs((at(layer.gap, -s) - c) * np.sqrt(2 * s) / (sign * c**3) - 1) < 3e-3
            beyond = 10 * layer.line.reach
            assert abs((at(layer.gap, -beyond) - c) * np.sqrt(2 * beyond) / (sign * c**3) - 1) < 1e-2
            assert abs(at(layer.gap, s) / (2 * np.sqrt(2) / 3 * s**1.5) - 1) < 1e-6
            assert abs(at(layer.pressure, 1e4) * 1e8 / (sign * 9 / 16) - 1) < 1e-3


def test_the_pressure_inside_has_the_logarithm_that_the_film_asks_for(subtests):
    for name, sign in [("inlet", 1), ("outlet", -1)]:
        with subtests.test(name=name, sign=sign):
            # P - P_H = (q0 + q1 ln s) s**(-3/2) + O(s**-2) with q1 = -+ c**3/(2 sqrt2 pi): slopes over decades, extrapolated.
            layer = LAYERS[name](1e8)
            s = np.array([1e3, 1e4, 1e5])
            slopes = np.diff((layer.pressure(-s) - np.sqrt(2 * s)) * s**1.5) / np.log(10)
            found = slopes[1] + (slopes[1] - slopes[0]) / (np.sqrt(10) - 1)
            assert abs(found / (-sign * layer.constant**3 / (2 * np.sqrt(2) * np.pi)) - 1) < 0.04


def test_an_outlet_takes_any_film(subtests):
    for film in [0.35, 0.55]:
        with subtests.test(film=film):
            errors = []
            for reach in (1e3, 1e5):
                layer = film_layers.outlet(reach, film=film)
                errors.append(abs(layer.excess[0]) + abs(at(layer.gap, -0.1 * reach) - film))
            assert errors[1] < 0.2 * errors[0] < 0.02


# --- collapse of the solver ---


def test_the_edges_of_a_contact_at_rest_are_mirror_images():
    groups, x = sb.Groups(0.0, 0.2, 2e-5), np.linspace(0.97, 1.05, 17)
    assert np.array_equal(edge_layer.gap(groups, x), edge_layer.gap(groups, -x))
    assert np.array_equal(edge_layer.contact_pressure(groups, x), edge_layer.contact_pressure(groups, -x))


def test_gap_and_contact_pressure_at_the_edge_obey_the_law_in_any_shape():
    load, kappa = np.array([[0.03], [0.3]]), np.array([1e-5, 1e-4, 1e-3])
    groups, x = sb.Groups(0.0, load, kappa * load), 0.995
    law = load**-0.5 * np.exp(-edge_layer.gap(groups, x) / kappa)
    assert law.shape == (2, 3)
    assert np.allclose(edge_layer.contact_pressure(groups, x) * np.ones((2, 1)), law, rtol=1e-10)


def test_the_drag_of_rolling_on_a_layer_feels_it_beyond_its_thickness():
    """Panels that ended at the thickness left it wrong by 1.3e-5 at a stated 2e-7."""
    solution = sb.solve(sb.Groups(1e-4, 1e-7, 0.0), slide_to_roll=0.0, solid=sb.solids.Layer(5.0, 0.5))
    assert solution.viscous_published == pytest.approx(4.92389246e-07, rel=2e-7)
