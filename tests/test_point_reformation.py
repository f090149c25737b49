"""A ball whose film re-forms behind a cavity: known states, conservation of mass, limits in the pressure of the cavity."""

import math

import numpy as np
import pytest

import stribeck as sb
from stribeck import Groups

# Speed, kappa, pressure of the cavity; what is known with its uncertainty, from an independent program of the same method.
KNOWN = [
    (0.1, 0.0, -0.1, {"central_gap": (0.0954903, 4e-7), "minimum_gap": (0.06763, 2e-5)}),
    (0.1, 0.1, -0.03, {"contact_load_share": (0.9401, 5e-5)}),
]


def ball(speed, kappa, cavity, rtol, load=1e-3):
    """Return the state of a ball whose cavity has this pressure."""
    groups = Groups(speed, load, kappa * load ** (2 / 3), geometry="point")
    return sb.solve(groups, cavitation="reform", cavity_pressure=cavity, rtol=rtol).state


def test_states_are_the_known_ones(subtests):
    for speed, kappa, cavity, known in KNOWN:
        with subtests.test(speed=speed, kappa=kappa, cavity=cavity, known=known):
            state = ball(speed, kappa, cavity, 1e-3)
            assert state.outcome.ok
            for name, (value, uncertainty) in known.items():
                assert abs(state.values[name] - value) <= uncertainty + state.absolute_errors[name], name
            assert abs(state.load_error) < 1e-6
            assert abs(state.identity_error) <= 1e-5 * state.scales["J_balanced"]
            assert state.nodal_fluid_pressure.min() == cavity


@pytest.mark.quick
def test_a_cavity_whose_pressure_the_suction_never_reaches_leaves_the_film_full():
    full = sb.solve(Groups(0.1, 1e-3, 1e-3, geometry="point"), rtol=1e-5).state
    state = ball(0.1, 0.1, -0.2, 1e-5)
    assert state.rtol == 1e-5
    for name, value in full.values.items():
        rounding = 1e-6 if name in ("minimum_radius", "minimum_angle") else 1e-9  # a minimum is flat
        assert abs(state.values[name] - value) <= rounding * full.scales[name], name


@pytest.mark.quick
def test_along_a_curve_the_film_breaks_where_its_suction_does():
    curve = sb.stribeck_curve(
        Groups(0.1, 1e-3, 1e-3, geometry="point"),
        speed=np.geomspace(0.02, 0.2, 5),
        cavitation="reform",
        cavity_pressure=-0.1,
        rtol=1e-3,
    )
    full = sb.stribeck_curve(Groups(0.1, 1e-3, 1e-3, geometry="point"), speed=np.geomspace(0.02, 0.2, 5), rtol=1e-3)
    assert curve.outcome.ok
    less = full.observable("contact_load_share") - curve.observable("contact_load_share")
    breaks = [any("re-forms" in note for note in s.notes) for s in curve.solutions]
    assert breaks == sorted(breaks)
    assert 0 < sum(breaks) < 5
    assert (less[np.array(breaks)] > 0).all()
    assert np.abs(less[~np.array(breaks)]).max() < 2e-3


@pytest.mark.slow
def test_towards_ambient_pressure_the_film_is_that_of_a_free_exit():
    free = sb.solve(Groups(0.1, 1e-3, 1e-3, geometry="point"), cavitation="exit", rtol=1e-3).state
    same = ball(0.1, 0.1, 0.0, 1e-3)
    iteration = 1e-4 * free.absolute_errors["contact_load_share"]  # Each iteration ends at a part of the tolerance
    assert same.values["contact_load_share"] == pytest.approx(free.values["contact_load_share"], abs=iteration)
    off = [
        ball(0.1, 0.1, cavity, 1e-3).values["contact_load_share"] - free.values["contact_load_share"]
        for cavity in (-1e-2, -1e-3)
    ]
    assert 0 < off[1] < off[0]
    assert math.log10(off[0] / off[1]) == pytest.approx(1 / 3, abs=0.05)
