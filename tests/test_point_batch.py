"""Batches of balls: the states that are solved one by one, for arrays of any input, with the friction of each."""

import pickle

import numpy as np
import pytest
from ball_data import BALL

import stribeck as sb

RTOL = 1e-3
ROUGHNESS = [BALL.roughness, 1.3 * BALL.roughness]


@pytest.fixture(scope="module")
def found():
    return sb.solve_batch(BALL, roughness=ROUGHNESS, wetted_radius=[["2 mm"], ["4 mm"]], rtol=RTOL)


def test_a_batch_of_balls_has_the_states_of_its_contacts(found):
    assert found.groups.shape == (2, 2) and found.dims == ("wetted_radius", "roughness") and found.ok.all()
    assert (found.error_estimate <= RTOL).all()
    contact = BALL.replace(roughness=ROUGHNESS[1], wetted_radius="4 mm")
    assert found.contacts[1, 1] == contact
    alone = sb.solve(contact, rtol=RTOL)
    for name in ("contact_load_share", "central_gap", "J_balanced", "minimum_radius"):
        assert getattr(found, name)[1, 1] == pytest.approx(getattr(alone, name), abs=2 * RTOL, rel=2 * RTOL)
    film = alone.minimum_gap * contact.hertz.indentation
    assert found.to_si()["minimum_film_thickness"][1, 1] == pytest.approx(film, rel=0.1)
    assert found.to_si()["central_total_pressure"][1, 1] == pytest.approx(
        alone.central_pressure * contact.hertz.pressure, rel=2 * RTOL
    )


def test_the_friction_of_a_batch_of_balls_is_that_of_the_states(subtests, found):
    for arguments in [{}, {"definition": "published"}, {"boundary_friction": 0.1, "beta": 0.05}]:
        with subtests.test(arguments=arguments):
            many = found.friction(**arguments)
            one = sb.solve(found.contacts[0, 0], rtol=RTOL).friction(**arguments)
            for part in ("asperities", "fluid"):
                assert getattr(many, part)[0, 0] == pytest.approx(getattr(one, part), rel=2 * RTOL), part
            # Stated errors depend a little on the state that a solve begins at.
            assert many.error[0, 0] == pytest.approx(one.error, rel=0.1)
            # A smaller disc of liquid drags less; asperities do not know it.
            assert (many.fluid[0] < many.fluid[1]).all()
            np.testing.assert_allclose(many.asperities[0], many.asperities[1], rtol=RTOL)


def test_a_batch_of_balls_becomes_a_dataset_and_a_pickle(found):
    pytest.importorskip("xarray")
    data = found.to_dataset()
    assert dict(data.sizes) == {"wetted_radius": 2, "roughness": 2}
    np.testing.assert_array_equal(data.central_pressure, found.central_pressure)
    np.testing.assert_array_equal(data.friction_balanced, np.asarray(found.friction))
    assert pickle.loads(pickle.dumps(found)) == found


@pytest.mark.slow
def test_a_batch_of_balls_in_a_fluid_that_thins_has_the_friction_of_its_contacts():
    contact = BALL.replace(fluid=sb.fluids.Carreau("1 ms", 0.5))
    found = sb.solve_batch(contact, speed=[0.01], rtol=1e-2)
    one = sb.solve(contact.replace(speed=0.01), rtol=1e-2)
    for arguments in ({}, {"definition": "published"}, {"boundary_friction": 0.1}, {"beta": 0.1}):
        many = found.friction(**arguments)
        for part in ("asperities", "fluid", "error"):
            assert getattr(many, part)[0] == pytest.approx(getattr(one.friction(**arguments), part), rel=1e-6), part
    assert "friction:" in repr(found)


def test_groups_of_balls_may_be_arrays_and_rest_is_one_of_them():
    found = sb.solve_batch(sb.Groups([0.0, 1e-3], 1e-2, 2e-4, geometry="point"), rtol=RTOL)
    assert found.ok.all()
    assert found.contact_load_share[0] == pytest.approx(1.0, abs=RTOL)
    assert found.friction.fluid[0] == 0.0
    alone = sb.solve(sb.Groups(1e-3, 1e-2, 2e-4, geometry="point"), rtol=RTOL)
    assert found.friction(1.0, 0.1)[1] == pytest.approx(alone.friction(1.0, 0.1).total, rel=2 * RTOL)
