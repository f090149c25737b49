"""A lattice of solved balls: its cells reproduce cubics, and its values are those of states solved between its nodes."""

import itertools
import math

import numpy as np
import pytest

import stribeck as sb
from stribeck.batches import lattice
from stribeck.batches.lattice import PARTS, Lattice, _from_smooth, _to_smooth
from stribeck.solver.point.sensitivity import state_derivatives
from stribeck.solver.point.solve import solve_cold

PHYSICS = sb.Groups(1.0, 1.0, 1.0, geometry="point").physics
MIDDLE = np.array([math.log(2e-3), math.log(1e-2), math.log(4e-3)])


def cubic(x, y, z):
    """Return four cubics and their gradients."""
    f = np.array([1 + x - 2 * y + x * y * z + x**3, x**2 * y - z**3, 0.1 * (y**2 * z + x * z), y**3 + x * y**2])
    by_x = np.array([1 + y * z + 3 * x**2, 2 * x * y, 0.1 * z, y**2])
    by_y = np.array([-2 + x * z, x**2, 0.2 * y * z, 3 * y**2 + 2 * x * y])
    by_z = np.array([x * y, -3 * z**2, 0.1 * (y**2 + x), 0 * x])
    return f, np.stack([by_x, by_y, by_z], axis=1)


def test_a_cell_reproduces_cubics_and_their_gradients(monkeypatch):
    made = Lattice((0.0, 0.0, 0.0), PHYSICS, 1e-3, steps=(0.5, 0.8, 0.4))
    for index in itertools.product(range(-2, 3), repeat=3):
        made.nodes[index] = cubic(*(i * step for i, step in zip(index, made.steps, strict=True)))
    places = np.random.default_rng(11).uniform(-0.6, 0.6, (20, 3))
    seen = {}
    monkeypatch.setattr(Lattice, "_parts", lambda self, y, slopes, s: seen.update(y=y, slopes=slopes) or (y, slopes))
    made.at(places)
    f, by = cubic(*places.T)
    np.testing.assert_allclose(seen["y"], f, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(seen["slopes"], by, rtol=1e-11, atol=1e-11)


def test_the_smooth_functions_and_their_inverse_agree():
    values = np.array([[0.3, 1.0], [0.7, 1e-12], [0.02, 0.4], [1e-3, 0.1], [2e-3, -0.1]])
    s = np.log([1e-3, 0.1])
    y = np.stack([_to_smooth(v, x) for v, x in zip(values.T, s, strict=True)], axis=1)
    np.testing.assert_allclose(_from_smooth(y, s), values[[0, 2, 3, 4]], rtol=1e-11)


@pytest.fixture(scope="module")
def made():
    return Lattice(tuple(MIDDLE - 0.5 * np.array(lattice.STEPS)), PHYSICS, 1e-4)


@pytest.mark.slow
def test_the_middle_of_a_cell_is_the_state_solved_there(made):
    values, slopes = made.at(MIDDLE[None])
    assert len(made.nodes) == 8
    scale = math.exp(MIDDLE[1]) ** (2 / 3)
    groups = sb.Groups(math.exp(MIDDLE[0]), math.exp(MIDDLE[1]), math.exp(MIDDLE[2]) * scale, geometry="point")
    state = solve_cold(groups, 1e-5)
    by = state_derivatives(state)
    friction = max(abs(state.values["J_balanced"]), abs(state.values["J_published"]))
    for k, name in enumerate(PARTS):
        size = 1.0 if k == 0 else friction
        assert values[k, 0] == pytest.approx(state.values[name], abs=3e-3 * size), name
        wanted = by[name] + np.array([0.0, 2 / 3 * by[name][2], 0.0])
        np.testing.assert_allclose(slopes[k, :, 0], wanted, atol=0.03 * size)


def test_along_what_does_not_vary_no_states_are_solved(monkeypatch):
    asked = []
    monkeypatch.setattr(
        Lattice,
        "_solve_all",
        lambda self, missing: (
            asked.extend(missing) or self.nodes.update(dict.fromkeys(missing, (np.ones(4), np.ones((4, 3)))))
        ),
    )
    made = Lattice(tuple(MIDDLE), PHYSICS, 1e-3)
    made.at(MIDDLE + np.array([[0.2, 0.0, 0.0], [0.3, 0.0, 0.0], [0.7, 0.0, 0.1]]))
    assert sorted(asked) == [(0, 0, 0), (1, 0, 0), (1, 0, 1), (2, 0, 0), (2, 0, 1)]
    made.at(MIDDLE + np.array([[0.25, 0.0, 0.0]]))
    assert len(asked) == 5
