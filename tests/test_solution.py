"""The stated error of the position of the minimum gap against the true one."""

import math

import numpy as np
import pytest

import stribeck as sb
from stribeck.equations.position_error import position_errors
from stribeck.numerics.panels import Mesh

STATES = {
    "flat": (4.4e-7, 0.066, 7.3e-4),
    "mixed": (1e-5, 0.1, 1e-4),
    "hydrodynamic": (1.0, 0.1, 1e-4),
    "thin film": (3.1e-5, 2e-6, 3.4e-11),
    "heavy and rough": (1.8e-4, 1.0, 1e-2),
}


def missed(state, exact):
    """By how much the stated position is wrong."""
    return abs(state.minimum_position - exact.minimum_position)


def test_the_stated_error_of_the_position_covers_the_true_one(subtests, solved):
    for name in STATES:
        with subtests.test(name=name):
            exact = solved(*STATES[name], rtol=1e-9)
            assert exact.minimum_position_error < 1e-7
            for rtol in (1e-3, 1e-6):
                state = solved(*STATES[name], rtol=rtol)
                assert missed(state, exact) <= state.minimum_position_error + exact.minimum_position_error
                assert state.minimum_position_error < 30 * math.sqrt(rtol)


def test_the_position_along_a_curve_is_within_its_own_error():
    curve = sb.stribeck_curve(sb.Groups(1e-5, 0.1, 1e-4), speed=[1e-4, 10**-3.5, 1e-3])
    exact = [sb.solve(state.groups, rtol=1e-8) for state in curve.solutions]
    wrong = [missed(state, true) for state, true in zip(curve.solutions, exact, strict=True)]
    for w, state in zip(wrong, curve.solutions, strict=True):
        assert w <= state.minimum_position_error


def wells(mesh, shift, difference):
    """A gap with two wells at ``shift -+ 0.6``, of which the right one is higher by ``difference``."""
    x = mesh.nodes - shift
    return 0.1 + (x * x - 0.36) ** 2 / (1 + x * x) + difference * (1 + np.tanh(20 * x)) / 2


def test_a_second_minimum_of_the_same_depth_is_within_the_error():
    mesh = Mesh(np.linspace(-4, 4, 33), 12)
    unchanged = np.zeros((2, 1, mesh.size))
    for difference, depth, distance in ((1e-6, 1e-4, 1.2), (1e-2, 1e-4, 0.0)):
        gap = wells(mesh, 0.03, difference)[None]
        [error] = position_errors(mesh, gap, unchanged, np.array([-0.57]), np.array([depth]))
        assert error == pytest.approx(distance, abs=0.1)


@pytest.mark.quick
def test_a_wrong_slope_at_the_nodes_moves_the_minimum_by_slope_over_curvature():
    mesh = Mesh(np.linspace(-4, 4, 33), 12)
    gap = 1 + (mesh.nodes - 0.1) ** 2
    tilt = 1e-3 * (mesh.nodes - 0.1)
    changes = np.stack([tilt, np.zeros_like(tilt)])[:, None]
    [error] = position_errors(mesh, gap[None], changes, np.array([0.1]), np.array([1e-12]))
    assert error == pytest.approx(2 * 1e-3 / 2, rel=0.01)  # twice, for safety


def test_the_error_of_the_position_is_in_the_dictionary_and_infinitely_flat_contacts_say_a_half_width(solved):
    state = solved(*STATES["mixed"], rtol=1e-6)
    assert state.to_dict()["minimum_position_error"] == state.minimum_position_error > 0
    assert solved(0.0, 0.1, 0.0, rtol=1e-6).minimum_position_error == 1.0
