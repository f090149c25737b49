"""Groups that a curve, chain, sweep, diagram or fit makes of others keep their contact law, geometry and model."""

import numpy as np
import pytest

import stribeck as sb
from stribeck.batches.states import Chain, States
from stribeck.curves.coordinate import Coordinate
from stribeck.regimes.phase_grid import Diagram
from stribeck.sweeps.columns import row_of

BALL = sb.Groups(1e-2, 1e-3, 1e-4, law=sb.contact_laws.GreenwoodTripp(), geometry="point")


def groups_of_a_curve():
    return Coordinate("load", BALL).groups_along(np.array([1e-3, 1e-2]))


def groups_of_a_diagram():
    axes = {"load": np.array([1e-3]), "roughness": np.array([1e-4]), "speed": np.array([1.0])}
    return Diagram(None, axes, 1.0, 1.0, "balanced", 1e-6, BALL.physics).problem(0, 0)[1]


@pytest.mark.quick
def test_groups_made_of_others_share_their_physics(subtests):
    for made in [groups_of_a_curve, groups_of_a_diagram]:
        with subtests.test(made=made):
            assert made().physics == BALL.physics


@pytest.mark.quick
def test_a_chain_of_a_sweep_travels_with_the_physics_of_its_states():
    import pickle

    states = States(groups=np.array([[1e-2, 1e-3, 1e-4]]), physics=BALL.physics, rtol=1e-6)
    chain = pickle.loads(pickle.dumps(Chain(np.zeros(1, dtype=int), states, row_of)))
    assert chain.states.problem(0)[0].physics == BALL.physics
