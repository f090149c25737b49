"""Traces: the derivatives of functions of fields against differences, and their values against plain ones."""

import numpy as np
import pytest

from stribeck.numerics.dual import value_of
from stribeck.numerics.trace import Matrix, Trace, act, matrix_of, pointwise

pytestmark = pytest.mark.quick

N = 7
RNG = np.random.default_rng(11)
FIRST, SECOND = Matrix(RNG.normal(size=(N, N))), Matrix(RNG.normal(size=(N, N)))
SUM = Matrix(RNG.uniform(size=(1, N)))
UNITS = {"gap": RNG.uniform(1, 2, N), "pressure": RNG.uniform(1, 2, N), "offset": 0.7, "speed": 1.3}
PLAIN = {
    "gap": RNG.uniform(1, 2, N),
    "pressure": RNG.uniform(size=N),
    "offset": np.array([0.4]),
    "speed": np.array([1.7]),
}


def cube(a):
    return pointwise(lambda a: (a**3, 3 * a**2), a)


FUNCTIONS = {
    "sum": lambda gap, pressure, offset, speed: gap + 2.0 * pressure - offset + 3.0 - gap,
    "product": lambda gap, pressure, offset, speed: gap * pressure * offset,
    "quotient": lambda gap, pressure, offset, speed: (1.0 - gap) / (2.0 + pressure) + 1 / offset - pressure / 3.0,
    "pointwise": lambda gap, pressure, offset, speed: cube(gap) * offset,
    "operator": lambda gap, pressure, offset, speed: act(FIRST, cube(gap) - offset * pressure),
    "operator of an operator": lambda gap, pressure, offset, speed: act(SECOND, speed * act(FIRST, gap / speed) + pressure),
    "functional": lambda gap, pressure, offset, speed: act(SUM, act(FIRST, gap * pressure)) * offset,
    "functional over nodes": lambda gap, pressure, offset, speed: gap - act(SUM, act(FIRST, cube(gap))) * speed,
    "functional of a weighted operator": lambda gap, pressure, offset, speed: act(SUM, pressure * act(FIRST, cube(gap))),
}


def traced():
    return {
        name: (Trace.field if value.size == N else Trace.number)(name, value, UNITS[name]) for name, value in PLAIN.items()
    }


def test_a_trace_has_the_value_and_the_derivatives_of_its_function(subtests):
    for name in FUNCTIONS:
        with subtests.test(name=name):
            function = FUNCTIONS[name]
            found, plain = function(**traced()), function(**PLAIN)
            np.testing.assert_allclose(value_of(found), plain, rtol=1e-14)
            for field, value in PLAIN.items():
                step = 1e-6 * RNG.normal(size=value.size) * UNITS[field]
                ahead, behind = (function(**PLAIN | {field: value + sign * step}) for sign in (1, -1))
                change = step / UNITS[field]
                if value.size == N:
                    matrix = np.empty((plain.size, N), order="F")
                    matrix_of(found, field, matrix)
                    along = matrix @ change
                else:
                    along = np.broadcast_to(found.columns.get(field, 0.0) * change, plain.shape)
                np.testing.assert_allclose(along, 0.5 * (ahead - behind), rtol=1e-7, atol=1e-13)


def test_of_plain_values_a_function_of_traces_is_the_plain_function():
    rows = {name: np.stack([value, 1.1 * value]) for name, value in PLAIN.items()}
    for function in FUNCTIONS.values():
        together, each = function(**rows), [function(**{name: value[k] for name, value in rows.items()}) for k in range(2)]
        np.testing.assert_allclose(together, each, rtol=1e-13)
