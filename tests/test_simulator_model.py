"""The formula of friction that simulators take lies as near to the curve as it says."""

from dataclasses import replace

import numpy as np
import pytest
from fit_data import TRUE

import stribeck as sb


@pytest.mark.quick
def test_the_formula_is_as_near_to_the_curve_as_it_says():
    curve = sb.stribeck_curve(TRUE, speed=("1 um/s", "1 m/s"), points=31, rtol=1e-4)
    model = curve.to_stribeck_model()
    off = np.abs(model.at(curve.speed) / curve.friction.total - 1)
    assert off.max() <= 1.001 * model.relative_error and 0.3 * model.relative_error < off.max() < 0.5
    assert model.static_friction == pytest.approx(0.7, rel=0.05)
    # The formula goes on evenly to other speeds of the same range, and is even in the speed.
    assert model.at([-1e-3, 1e-3]) == pytest.approx(model.at(1e-3).item() * np.ones(2))
    assert "k v" in str(model) and model.to_dict()["exponent"] == model.exponent


def test_no_parameter_can_be_bettered():
    curve = sb.stribeck_curve(TRUE, speed=("1 um/s", "1 m/s"), points=121, rtol=1e-4)
    model = curve.to_stribeck_model()

    def distance(model):
        return float(np.mean(np.log(model.at(curve.speed) / curve.friction.total) ** 2))

    for name in ("static_friction", "coulomb_friction", "stribeck_speed", "exponent", "viscous_coefficient"):
        for factor in (0.98, 1.02):
            assert distance(replace(model, **{name: factor * getattr(model, name)})) > distance(model)


@pytest.mark.quick
def test_a_curve_without_sliding_speeds_is_refused():
    over_load = sb.stribeck_curve(TRUE, load=("10 N/m", "100 N/m"), points=3, rtol=1e-3)
    groups = sb.stribeck_curve(load=0.1, roughness=1e-4, speed=(1e-5, 1e-3), points=3, rtol=1e-3)
    rolling = sb.stribeck_curve(TRUE.replace(slide_to_roll=0.0), speed=("1 mm/s", "10 mm/s"), points=3, rtol=1e-3)
    for curve, words in ((over_load, "runs over the load"), (groups, "speed group"), (rolling, "do not slide")):
        with pytest.raises(sb.InputError, match=words):
            curve.to_stribeck_model()
