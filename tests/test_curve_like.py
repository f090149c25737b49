"""A curve that begins from that of another contact: every pair of models, and the same curve as alone."""

import numpy as np
import pytest

import stribeck as sb

CONTACT = sb.LineContact(
    radius="10 mm",
    modulus="2.7 MPa",
    load="30 N/m",
    viscosity="50 mPa*s",
    speed="1 mm/s",
    roughness="1 um",
    alpha=2.0,
    beta=0.06,
    boundary_friction=0.7,
)

MODELS = {
    "article": {},
    "Barus": {"fluid": sb.fluids.Barus("20 1/GPa")},
    "Roelands": {"fluid": sb.fluids.Roelands("20 1/GPa")},
    "Dowson-Higginson": {"fluid": sb.fluids.Fluid(density=sb.fluids.DowsonHigginson())},
    "Carreau": {"fluid": sb.fluids.Carreau("0.1 ms", 0.6)},
    "Eyring": {"fluid": sb.fluids.Eyring("10 kPa")},
    "flow factors": {"flow_factors": sb.fluids.PatirCheng()},
    "both move": {"slide_to_roll": 0.5},
    "layer": {"solid": sb.solids.Layer("1 mm")},
    "viscoelastic": {"solid": sb.solids.StandardLinearSolid("1 ms", 2.0)},
    "finite surface": {"law": sb.FiniteSurface(2.0)},
    "exit": {"cavitation": "exit"},
    "exit, Barus": {"cavitation": "exit", "fluid": sb.fluids.Barus("20 1/GPa")},
    "reform": {"cavitation": "reform", "cavity_pressure": "-1 kPa"},
}
SETTINGS = {"speed": ("5 mm/s", "10 mm/s"), "points": 3, "rtol": 1e-3}


@pytest.fixture(scope="module")
def alone():
    return {name: sb.stribeck_curve(CONTACT, **SETTINGS, **parts) for name, parts in MODELS.items()}


@pytest.mark.parametrize("other", MODELS)
def test_a_curve_is_the_same_whatever_model_it_begins_from(alone, other):
    for name, parts in MODELS.items():
        curve = sb.stribeck_curve(CONTACT, **SETTINGS, **parts, like=alone[other])
        allowed = curve.friction_error + alone[name].friction_error
        assert (np.abs(curve.friction - alone[name].friction) <= allowed).all(), (other, name)
