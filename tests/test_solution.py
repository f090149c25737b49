"""The stated error of the position of the minimum gap against the true one."""

import math

import stribeck as sb

STATES = {
    "flat": (4.4e-7, 0.066, 7.3e-4),
    "mixed": (1e-5, 0.1, 1e-4),
    "thin film": (3.1e-5, 2e-6, 3.4e-11),
    "heavy and rough": (1.8e-4, 1.0, 1e-2),
}


def missed(state, exact):
    """By how much the stated position is wrong."""
    return abs(state.minimum_position - exact.minimum_position)


def test_the_stated_error_of_the_position_covers_the_true_one(subtests, solved):
    for name in ("flat", "thin film", "heavy and rough"):
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


def test_the_error_of_the_position_is_in_the_dictionary_and_infinitely_flat_contacts_say_a_half_width(solved):
    state = solved(*STATES["mixed"], rtol=1e-6)
    assert state.to_dict()["minimum_position_error"] == state.minimum_position_error > 0
    assert solved(0.0, 0.1, 0.0, rtol=1e-6).minimum_position_error == 1.0
