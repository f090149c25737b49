"""How friction answers to inputs where the fluid, the solid or the flow depends on them too."""

import math

import numpy as np
import pytest
from fit_data import TRUE, measured

import stribeck as sb
from stribeck.curves.sensitivities import friction_sensitivities

STEP = 1e-3


@pytest.mark.parametrize(
    ("parts", "names"),
    [
        ({"fluid": sb.fluids.Barus("500 1/GPa"), "cavitation": "exit"}, ("pressure_coefficient", "modulus", "beta")),
        ({"cavitation": "reform", "cavity_pressure": "-2 kPa"}, ("viscosity", "load")),
        ({"flow_factors": "effective-medium"}, ("roughness", "alpha")),
        ({"slide_to_roll": -1.0}, ("boundary_friction", "load")),
        ({"solid": sb.solids.Layer("1 mm")}, ("layer_thickness", "radius")),
    ],
)
def test_sensitivities_are_differences_of_solved_friction(parts, names):
    contact = TRUE.replace(speed="10 mm/s", **parts)
    state, found = friction_sensitivities(contact, rtol=1e-7)
    for name in names:
        moved = [contact.replace(**{name: getattr(contact, name) * math.exp(sign * STEP)}) for sign in (1, -1)]
        ends = [math.log(abs(sb.solve(each, rtol=1e-7).friction())) for each in moved]
        assert found[name] == pytest.approx((ends[0] - ends[1]) / (2 * STEP), abs=2e-4), name


def test_the_next_run_of_a_fit_of_the_fluid_is_found():
    contact = TRUE.replace(fluid=sb.fluids.Barus("500 1/GPa"), cavitation="exit")
    speeds = np.geomspace(1e-3, 0.3, 5)
    friction = np.asarray(sb.stribeck_curve(contact, speed=speeds, rtol=1e-4).friction)
    fit = sb.fit(measured(speeds, friction, error=0.01 * friction), contact, free=["pressure_coefficient"], intervals=False)
    plan = sb.next_runs(fit, 1, speeds=[1e-3, 0.3], loads=[contact.load])
    assert plan.runs[0].speed == pytest.approx(0.3)
    assert plan.runs[0].errors["pressure_coefficient"] < plan.before["pressure_coefficient"]


def test_a_film_whose_suction_opens_no_cavity_has_the_sensitivities_of_the_full_film():
    contact = TRUE.replace(speed="10 mm/s")
    full = friction_sensitivities(contact)[1]
    found = friction_sensitivities(contact.replace(cavitation="reform", cavity_pressure="-10 bar"))[1]
    assert {name: found[name] for name in full} == pytest.approx(full, rel=1e-5, abs=1e-7)
