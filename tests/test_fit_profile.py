"""Fits that free numbers of a profile, and inputs from which the dry width under it follows."""

import json
import math

import numpy as np
import pytest
from command_line import call, toml_of
from fit_data import measured

import stribeck as sb

CONTACT = {
    "modulus": "10 MPa",
    "load": "500 N/m",
    "viscosity": "0.1 Pa*s",
    "speed": "0.1 m/s",
    "roughness": "1 um",
    "alpha": 2.0,
    "beta": 0.06,
    "boundary_friction": 0.5,
}
LAND = {"land_width": "0.2 mm", "edge_radius": "10 mm"}
LIP = {"angle_oil": "15 deg", "angle_air": "8 deg", "tip_radius": "0.5 mm"}
SPEEDS = np.geomspace(1e-3, 1.0, 7)
NOISE = np.exp(0.01 * np.random.default_rng(4).standard_normal(7))


def friction_of(contact, speeds=SPEEDS):
    """Return the solved friction of a contact."""
    return np.abs(sb.solve_batch(contact, speed=speeds, rtol=1e-5).friction.total)


@pytest.mark.slow
def test_the_width_of_a_land_is_found_and_the_case_is_written_with_it(tmp_path, capsys):
    land = sb.LineContact(profile=sb.profiles.Land(**LAND), **CONTACT)
    rows = zip(SPEEDS.tolist(), (friction_of(land) * NOISE).tolist(), strict=True)
    (tmp_path / "land.csv").write_text("speed [m/s];friction\n" + "\n".join(f"{u};{mu}" for u, mu in rows))
    case, out = tmp_path / "case.toml", tmp_path / "fitted.toml"
    profile = {"shape": "land", **LAND, "land_width": "0.3 mm"}
    case.write_text(toml_of(contact=CONTACT, profile=profile, fit={"free": ["boundary_friction", "land_width"]}))
    answer = call(capsys, "fit", tmp_path / "land.csv", case, "--out", out, "--json")
    assert answer.code == 0, answer.err
    found = json.loads(answer.out)
    width = next(each for each in found["inputs"] if each["name"] == "land_width")
    assert math.log(width["value"] / 2e-4) == pytest.approx(0.0, abs=4 * width["standard_error"])
    assert width["standard_error"] < 0.3 and "radius" not in {each["name"] for each in found["held"]}
    assert sb.load_case(out).contact.land_width == pytest.approx(width["value"], rel=1e-8)


@pytest.mark.slow
def test_the_fitted_friction_is_that_of_the_fitted_contact_and_its_slopes_are_those_of_solved_friction():
    lip = sb.LineContact(profile=sb.profiles.Lip(**LIP), **CONTACT)
    speeds = SPEEDS[::2]
    data = measured(speeds, friction_of(lip, speeds) * NOISE[::2])
    start = lip.replace(tip_radius=6.5e-4, load=600.0)
    found = sb.fit(data, start, free=["tip_radius", "load"], intervals=False)
    assert found.converged
    np.testing.assert_allclose(found.friction, friction_of(found.contact, speeds), rtol=1e-4)
    # At the optimum the sum of squares rises beside each input by as much as the covariance says.
    least, inverse = float(found.residuals @ found.residuals), np.linalg.inv(found.covariance)
    for i, name in enumerate(("load", "tip_radius")):
        assert found.inputs[i].name == name
        step = 0.02
        moved = found.contact.replace(**{name: getattr(found.contact, name) * math.exp(step)})
        r = np.log(friction_of(moved, speeds) / data.friction) / found.noise
        assert float(r @ r) - least == pytest.approx(step**2 * inverse[i, i], rel=0.2)


def test_the_radius_of_a_profile_is_no_input():
    lip = sb.LineContact(profile=sb.profiles.Lip(**LIP), **CONTACT)
    with pytest.raises(sb.InputError, match="radius is free, but the profile is the whole shape"):
        sb.fit(measured(SPEEDS, np.linspace(0.5, 0.1, 7)), lip, free=["radius"])
