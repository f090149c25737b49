"""The film of a dry pressure: both laws, their errors and those of the table, both directions, and what is refused."""

import itertools
import math
import re

import numpy as np
import pytest

import stribeck as sb
from stribeck.asymptotics import OutOfRangeWarning, film_of_pressure

pytestmark = pytest.mark.quick

E, ETA, U = 10e6, 0.05, 0.1
"""A seal: modulus, viscosity and speed."""

NODES = np.cos((np.arange(4000) + 0.5) * np.pi / 4000)


def pressure(slope, x):
    """Return the pressure of a smooth dry contact of half-width 1 and modulus 2 under a profile of this slope."""
    inside = np.abs(x) < 1
    found = np.zeros_like(x)
    q = slope(NODES)
    found[inside] = [-math.sqrt(1 - v * v) * np.mean((q - slope(v)) / (v - NODES)) for v in x[inside]]
    return found


def edge_coefficient(slope, side):
    """Return the coefficient of the root at the left (-1) or right (1) edge by the quadrature of its limit."""
    return math.sqrt(2) * abs(np.mean((slope(NODES) - slope(side)) / (1 - side * NODES)))


def land(half_width):
    """Return the slope of a flat punch whose edges are parabolas, of load pi/2."""

    def slope(x):
        return np.sign(x) * np.maximum(np.abs(x) - half_width, 0)

    scale = 0.5 / np.mean(NODES * slope(NODES))
    return lambda x: scale * slope(x)


def lip(ratio, rounding):
    """Return the slope of a lip, steep to the left, of load pi/2."""

    def of(place, m):
        return lambda x: m * ((1 - ratio) / 2 + (1 + ratio) / 2 * (x - place) / np.hypot(x - place, rounding))

    low, high = -1.0, 1.0
    for _ in range(80):  # the mean of the slope is zero
        place = (low + high) / 2
        low, high = (place, high) if np.mean(of(place, 1.0)(NODES)) > 0 else (low, place)
    return of(place, 0.5 / np.mean(NODES * of(place, 1.0)(NODES)))


def film_in_units(x, p, speed):
    """Return the films of a pressure in units where the modulus is 2 and the speed is the speed group."""
    return film_of_pressure(x, p, modulus=2.0, viscosity=1 / 6, speed=speed)


SHAPES = {
    "parabola": lambda x: 1.0 * np.asarray(x),
    "land": land(0.5),
    "narrow edge": land(0.8),
    "lip": lip(3.0, 0.3),
}


def test_a_parabola_has_the_film_of_its_inlet_law():
    contact = sb.LineContact(
        radius=0.01, modulus=E, load=3000.0, viscosity=ETA, speed=U, roughness=0.0, alpha=2.0, beta=0.1, boundary_friction=0.5
    )
    a, p_max = contact.hertz.half_width, contact.hertz.pressure
    x = np.linspace(-1.2, 1.2, 161) * a
    p = p_max * np.sqrt(np.maximum(1 - (x / a) ** 2, 0))
    found = film_of_pressure(x, p, modulus=E, viscosity=ETA, speed=U)
    law = sb.asymptotics.hydrodynamic.central_gap_large(contact.groups)
    assert found.forward / contact.hertz.indentation == pytest.approx(0.44583045 * contact.groups.speed**0.6, rel=1e-6)
    assert found.forward == pytest.approx(law * contact.hertz.indentation, rel=0.02)
    assert found.backward == pytest.approx(found.forward, rel=1e-9)
    assert abs(found.net) < 1e-9 * found.forward < found.error.net
    state = sb.solve(contact, cavitation="exit")
    true = state.flux_gap * contact.hertz.indentation
    assert 0 < true - found.forward < found.error.forward < 0.05 * found.forward
    assert found.inlets[0].law == "edge" and found.valid
    assert found.inlets[0].edge == pytest.approx(-a, rel=1e-5) and found.inlets[1].edge == pytest.approx(a, rel=1e-5)


def test_the_error_of_the_edge_law_bounds_that_of_a_parabola_at_any_speed_in_range(subtests):
    x = np.linspace(-1.1, 1.1, 221)
    p = np.sqrt(np.maximum(1 - x**2, 0))
    for speed in (1e-6, 1e-4, 1e-2):
        with subtests.test(speed=speed):
            found = film_in_units(x, p, speed)
            true = sb.solve(sb.Groups(speed, 0.1, 0.0), cavitation="exit").flux_gap
            assert 0.2 * found.error.forward < true - found.forward < found.error.forward
            assert found.valid
    with pytest.warns(OutOfRangeWarning, match="inlet length up to 0.35 of the way"):
        assert not film_in_units(x, p, 0.03).valid


def test_the_coefficient_of_the_edge_is_that_of_the_quadrature(subtests):
    x = np.linspace(-1.05, 1.05, 400)
    for name in ("land", "narrow edge", "lip"):
        with subtests.test(name=name):
            slope = SHAPES[name]
            found = film_in_units(x, pressure(slope, x), 1e-4)
            for side, inlet in zip((-1, 1), found.inlets, strict=True):
                k = edge_coefficient(slope, side)
                assert inlet.edge_coefficient == pytest.approx(k, rel=1e-3)
                assert abs(inlet.edge_coefficient - k) <= inlet.edge_coefficient_error + 1e-6 * k


SOLVED = {  # by independent finite volumes with an exit, asperities carrying less than 1e-4 of the load
    (3.0, 0.3, 1e-3, 1): 4.2579e-3,
    (3.0, 0.3, 1e-3, -1): 9.8502e-3,
    (3.0, 0.3, 3.1623e-3, 1): 8.388e-3,
    (3.0, 0.3, 3.1623e-4, -1): 5.4765e-3,
    (3.0, 0.1, 1e-3, 1): 4.2411e-3,
    (3.0, 0.1, 1e-3, -1): 5.4861e-3,
    (6.0, 0.1, 3.1623e-3, 1): 3.8074e-3,
    (6.0, 0.1, 1e-3, -1): 4.8442e-3,
}
"""Ratio of the slopes, rounding, speed group, direction: film in units of the load and half-width."""


@pytest.mark.filterwarnings("ignore::stribeck.asymptotics.OutOfRangeWarning")  # the other direction may be out of range
def test_films_of_lips_lie_within_their_errors(subtests):
    x = np.linspace(-1.05, 1.05, 800)
    for case, film in SOLVED.items():
        with subtests.test(case=case):
            ratio, rounding, speed, direction = case
            inlet = film_in_units(x, pressure(lip(ratio, rounding), x), speed).inlets[0 if direction > 0 else 1]
            assert abs(inlet.film - film) < inlet.error * film
            assert inlet.law_error <= 0.07


def test_the_law_that_governs_is_named():
    x = np.linspace(-1.05, 1.05, 800)
    forward, backward = film_in_units(x, pressure(lip(3.0, 0.1), x), 1e-3).inlets
    assert forward.law == "edge and interior" and forward.law_error == pytest.approx(0.05, abs=1e-9)
    assert backward.law == "interior"


def test_noise_changes_the_film_within_the_stated_error(subtests):
    for name, slope in SHAPES.items():
        with subtests.test(name=name):
            generator = np.random.default_rng(20240611)
            x = np.sort(np.linspace(-1.05, 1.05, 240) + 1e-3 * generator.standard_normal(240))
            p = pressure(slope, x)
            clean = film_in_units(x, p, 1e-3).inlets
            outside = []
            for k in range(12):
                kicks = 0.01 * generator.standard_normal(x.size)
                noisy = p * (1 + kicks) if k % 2 else np.maximum(p + kicks * p.max() * (p > 0), 0)
                for inlet, true in zip(film_in_units(x, noisy, 1e-3).inlets, clean, strict=True):
                    outside.append(abs(inlet.film / true.film - 1) > inlet.resolution_error)
                    assert abs(inlet.film / true.film - 1) < 1.5 * inlet.resolution_error < 0.4
            assert np.mean(outside) <= 0.1


def test_a_pressure_that_waves_has_the_film_of_its_edge_within_the_stated_error():
    generator = np.random.default_rng(20261130)
    ratios = []
    tables = itertools.product((0.2, 0.5), ((1, 100), (1, 300), (2, 300)), (0.0, 0.002, 0.004), (1.0, 2.0))
    for wave, (waves, rows), noise, start in tables:
        x = np.linspace(-1.1, 1.1, rows)
        p = np.sqrt(np.maximum(1 - x**2, 0)) * (1 + wave * np.cos(waves * math.pi * x + start))
        kicks = 1 + noise * generator.standard_normal(rows)
        for inlet, side in zip(film_in_units(x, p * kicks, 1e-9).inlets, (-1, 1), strict=True):
            k = math.sqrt(2) * (1 + wave * math.cos(start + side * waves * math.pi))
            assert inlet.law == "edge"
            ratios.append(abs((inlet.edge_coefficient / k) ** 0.8 - 1) / inlet.resolution_error)
    assert max(ratios) < 2 and np.mean(np.greater(ratios, 1)) < 0.1


def test_units_order_and_many_rows_change_nothing():
    x = np.linspace(-1.2e-3, 1.2e-3, 101)
    p = 2e6 * np.sqrt(np.maximum(1 - (x / 1e-3) ** 2, 0))
    plain = film_of_pressure(x, p, modulus=E, viscosity=ETA, speed=U)
    texts = [f"{each!r} mm" for each in (1e3 * x).tolist()], [f"{each!r} kPa" for each in (p / 1e3).tolist()]
    with_units = film_of_pressure(*texts, modulus="10 MPa", viscosity="50 mPa*s", speed="100 mm/s")
    turned = film_of_pressure(x[::-1], list(p[::-1]), modulus=E, viscosity=ETA, speed=(U, U))
    fine = np.linspace(-1.2e-3, 1.2e-3, 5001)
    averaged = film_of_pressure(fine, 2e6 * np.sqrt(np.maximum(1 - (fine / 1e-3) ** 2, 0)), modulus=E, viscosity=ETA, speed=U)
    for other, rtol in ((with_units, 1e-9), (turned, 1e-12), (averaged, 1e-3)):
        assert other.forward == pytest.approx(plain.forward, rel=rtol)
    assert turned == plain


def test_a_steep_inlet_on_the_left_leaves_less_than_it_takes_back():
    x = np.linspace(-1.05, 1.05, 400)
    p = pressure(lip(3.0, 0.3), x)
    steep_left, steep_right = film_in_units(x, p, 1e-3), film_in_units(-x, p, 1e-3)
    assert steep_left.net < -steep_left.error.net < 0 < steep_right.net
    assert steep_right.net == pytest.approx(-steep_left.net, rel=1e-9)
    assert steep_right.net == (steep_right.forward - steep_right.backward) / 2
    assert steep_left.forward == steep_right.backward


def test_each_direction_has_its_own_speed():
    x = np.linspace(-1.05, 1.05, 200)
    p = np.sqrt(np.maximum(1 - x**2, 0))
    found = film_in_units(x, p, (1e-3, 2e-3))
    assert found.backward / found.forward == pytest.approx(2**0.6, rel=1e-9)
    assert found.net < 0


X = np.linspace(-1.2, 1.2, 61)
P = np.sqrt(np.maximum(1 - X**2, 0))


def test_a_table_that_cannot_tell_is_refused_in_a_sentence(subtests):
    for x, p, said in [
        (X, P[:-1], "x has 61 rows and p has 60"),
        (X, -P, "no pressure above zero"),
        (X, P - 0.1, "negative at x = -1.2 m"),
        (X, 0 * P, "no pressure above zero"),
        ([], [], "no pressure above zero"),
        (X, np.where(P > 0.9, np.nan, P), "p in row"),
        (np.round(X, 1), P, "Two rows have x = -1.2 m"),
        (X[P > 0.6], P[P > 0.6], "no left edge: it begins at"),
        (X[X > -0.5], P[X > -0.5], "no left edge"),
        (X[::8], P[::8], "rows between the left edge of the contact and its peak"),
        (X, np.where(np.abs(X) < 1, 1 / np.sqrt(np.maximum(1 - X**2, 1e-9)), 0), "a sharp edge has no film"),
        (np.r_[X, X + 3], np.r_[P, P], "several contacts"),
        (X, P + 0.3 * np.where((P > 0) & (np.arange(61) % 3 == 0), P, 0), "too few or too noisy"),
        ("x.csv", P, "it must be a column of numbers"),
        (3.0, P, "it must be a column of numbers"),
        (X, [f"{each} MPa" for each in P[:-1]] + ["1 mm"], "p in row 61"),
    ]:
        with subtests.test(said):
            with pytest.raises(sb.InputError, match="^[^\n]+$") as refused:
                film_in_units(x, p, 1e-3)
            assert said in str(refused.value)


def test_impossible_inputs_are_refused(subtests):
    for changed, said in [
        ({"speed": 0.0}, "speed = 0.0; it must be above zero"),
        ({"speed": (1.0, 2.0, 3.0)}, "give one speed, or two"),
        ({"modulus": "10 mm"}, "modulus = '10 mm' is a length"),
        ({"viscosity": -1.0}, "viscosity = -1.0; it must be above zero"),
    ]:
        with subtests.test(said), pytest.raises(sb.InputError, match=re.escape(said)):
            film_of_pressure(X, P, **({"modulus": 2.0, "viscosity": 1.0, "speed": 1e-3} | changed))
