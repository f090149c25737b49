"""Transitions of many contacts at once on the atlas."""

import numpy as np
import pytest

import stribeck as sb
from stribeck.regimes.transition_speeds import transition_speeds

NAMES = {
    "boundary": "fluid carries 5 % of the load",
    "hydrodynamic": "asperities cause 10 % of the friction",
    "minimum": "minimum of friction",
}


@pytest.mark.parametrize("definition", ["published", "balanced"])
@pytest.mark.parametrize(("load", "boundary_friction", "beta"), [(0.098, 0.7, 0.06), (0.003, 1.0, 0.01)])
def test_they_are_those_of_solved_curves_within_the_stated_error(load, boundary_friction, beta, definition):
    roughness = load * np.array([1e-3, 0.03, 0.2])
    found = transition_speeds(sb.Groups(1.0, load, roughness), boundary_friction, beta, definition)
    for i, h in enumerate(roughness):
        curve = sb.stribeck_curve(
            load=load,
            roughness=h,
            speed=(1e-8, 1e3),
            points=45,
            boundary_friction=boundary_friction,
            beta=beta,
            definition=definition,
            rtol=1e-7,
        )
        marks = {mark.name: mark.value for mark in curve.transitions}
        for row, (name, words) in enumerate(NAMES.items()):
            value = getattr(found, name)[i]
            assert np.isnan(value) if words not in marks else abs(np.log(value / marks[words])) < found.error[row, i]


def test_the_stated_error_is_small():
    found = transition_speeds(sb.Groups(1.0, 0.1, np.array([1e-3, 1e-2])), 0.7, 0.06)
    assert found.error.max() < 1e-3


def test_fewer_narrowings_state_a_larger_error_and_keep_it():
    fine = transition_speeds(sb.Groups(1.0, 0.1, np.array([1e-3])), 0.7, 0.06)
    coarse = transition_speeds(sb.Groups(1.0, 0.1, np.array([1e-3])), 0.7, 0.06, narrowings=1)
    for row, name in enumerate(NAMES):
        gap = abs(np.log(getattr(coarse, name)[0] / getattr(fine, name)[0]))
        assert gap <= coarse.error[row, 0]
    assert (coarse.error > fine.error).all()


def test_what_holds_at_all_speeds_asked_for_is_at_zero_and_what_never_does_at_infinity():
    found = transition_speeds(sb.Groups(1.0, 0.1, np.array([1e-3])), 0.7, 0.06, speeds=(1.0, 1e3))
    assert found.boundary[0] == found.hydrodynamic[0] == 0
    found = transition_speeds(sb.Groups(1.0, 0.1, np.array([1e-3])), 0.7, 0.06, speeds=(1e-12, 1e-10))
    assert found.boundary[0] == found.hydrodynamic[0] == np.inf
    assert np.isnan(found.minimum[0])
