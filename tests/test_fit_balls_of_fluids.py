"""Fits of balls with other fluids: derivatives by the numbers of the fluid, and fits that find these."""

import numpy as np
import pytest
from ball_data import BALL
from test_point_fit import made_up, measured

import stribeck as sb
from stribeck import FitSettings
from stribeck.fits.free_inputs import free_inputs
from stribeck.fits.model import FrictionModel
from stribeck.fits.states import sources
from stribeck.fits.states.interpolation import Between
from stribeck.fits.states.solved import solved_parts
from stribeck.fits.states.sources import Ways

SPEEDS = BALL.speed * np.geomspace(0.5, 4.0, 4)
FLUIDS = {
    "barus": ({"fluid": sb.fluids.Barus("2e-6 1/Pa")}, ("viscosity", "pressure_coefficient", "modulus")),
    "carreau": ({"fluid": sb.fluids.Carreau("2 ms", 0.5)}, ("boundary_friction", "relaxation_time", "load")),
}


@pytest.mark.parametrize("name", ["barus", pytest.param("carreau", marks=pytest.mark.slow)])
def test_predictions_are_the_friction_of_solved_balls_and_their_slopes_its_differences(name):
    parts, free = FLUIDS[name]
    contact, data = BALL.replace(**parts), measured(np.ones(1), SPEEDS[1:2])
    model = FrictionModel(contact, data, free_inputs(contact, data, free, FitSettings(geometry="point")))
    of, theta, step = solved_parts(model, "balanced", 1e-5), 0.1 * np.ones(len(free)), 1e-2
    found = model.predict(theta, of)
    moved = model.contact_of(0, theta)
    for i, speed in enumerate(SPEEDS[1:2]):
        alone = sb.solve(moved.replace(speed=speed), rtol=1e-5).friction().total
        assert found.friction[i] == pytest.approx(alone, rel=3e-5)
    for i in range(len(free)):
        move = step * np.eye(len(free))[i]
        slope = (model.predict(theta + move, of).friction - model.predict(theta - move, of).friction) / (2 * step)
        np.testing.assert_allclose(found.jacobian[:, i], slope, atol=1e-3 * np.abs(found.friction).max(), err_msg=free[i])


@pytest.mark.quick
def test_curves_are_read_between_the_inputs_at_which_they_were_solved_and_fits_solve_few(monkeypatch):
    free, inputs = ("boundary_friction", "roughness", "viscosity"), ({}, {"load": 2 * BALL.load})
    data, solve, solved = measured(np.ones(8), SPEEDS, inputs=inputs), made_up("balanced"), []

    def counted(*of):
        solved.append(len(of[0].speed))
        return solve(*of)

    model = FrictionModel(BALL, data, free_inputs(BALL, data, free, FitSettings(geometry="point")))
    exact = model.predict(np.array([0.2, 0.05, -0.1]), solve)
    read = Between(counted, 0.03)
    for theta in np.array([[0.3, 0.0, 0.0], [0.2, 0.2, -0.2], [0.2, 0.05, -0.1]]):
        found = model.predict(theta, read)
    assert solved == [4] * 4  # two places of each curve
    np.testing.assert_allclose(found.friction, exact.friction, rtol=1e-2)
    np.testing.assert_allclose(found.jacobian, exact.jacobian, atol=0.03 * exact.friction.max())
    assert (found.error > exact.error).all()

    solved.clear()
    monkeypatch.setattr("stribeck.fits.fit.ways_of", lambda *_: sources.between(counted))
    noise = np.exp(0.02 * np.random.default_rng(1).standard_normal(8))
    rows = measured(exact.friction * noise, SPEEDS, inputs=inputs)
    fit = sb.fit(rows, BALL, free=["boundary_friction", "viscosity"])
    drawn = fit.band(1, np.geomspace(SPEEDS[0], SPEEDS[-1], 30))  # between the measured speeds, without a state more
    assert len(solved) <= 2 * 12
    monkeypatch.setattr("stribeck.fits.fit.ways_of", lambda *_: Ways(solve, solve))
    alone = sb.fit(rows, BALL, free=["boundary_friction", "viscosity"])
    assert fit.converged
    for one, other in zip(fit.inputs, alone.inputs, strict=True):
        assert one.value == pytest.approx(other.value, rel=0.02 * other.standard_error)
        np.testing.assert_allclose(np.log(one.interval_95), np.log(other.interval_95), atol=0.05 * other.standard_error)
    for one, other in zip(drawn, alone.band(1, np.geomspace(SPEEDS[0], SPEEDS[-1], 30)), strict=True):
        np.testing.assert_allclose(one, other, rtol=0.01)


@pytest.mark.slow
@pytest.mark.parametrize("name", FLUIDS)
def test_fits_of_balls_find_the_numbers_of_their_fluid(name):
    parts, free = FLUIDS[name]
    contact, free = BALL.replace(**parts), free[:2]
    friction = np.asarray(sb.stribeck_curve(contact, speed=SPEEDS, rtol=1e-4).friction)
    start = contact.replace(**{each: 1.2 * getattr(contact, each) for each in free})
    found = sb.fit(measured(friction, SPEEDS), start, free=list(free))
    for each in free:
        assert getattr(found.contact, each) == pytest.approx(getattr(contact, each), rel=0.02), each
