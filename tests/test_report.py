"""What reports print: digits that the errors allow, and no share that is smaller than its error."""

import json
import re

import pytest
from command_line import call, case_text

LAW = {"h_rms": '"1 um"', "hurst": "0.8", "longest_wavelength": '"150 um"', "shortest_wavelength": '"1.5 um"'}
OF_SURFACE = {"roughness": None, "alpha": None, "beta": None, "law": '"persson"'}


def test_a_share_below_its_error_is_printed_as_that(capsys, tmp_path):
    case = tmp_path / "fast.toml"
    case.write_text(case_text({"speed": '"10 m/s"'}))
    found = json.loads(call(capsys, "regimes", case, "--json").out)
    assert 0 < found["contact_friction_share"] < found["contact_friction_share_error"] < 1e-6
    assert found["fluid_load_share"] == pytest.approx(1, abs=found["fluid_load_share_error"])
    said = "(< 0.01 % from asperities); the fluid carries 100 % of the load."
    assert said in call(capsys, "regimes", case).out
    rows = call(capsys, "solve", case, "-v").out
    assert len(re.findall(r"friction from asperities +< \de-0[78]\n", rows)) == 1
    assert re.search(r"load on asperities +< \de-07\n", rows)


def test_a_contact_area_that_vanishes_is_zero(capsys, tmp_path):
    case = tmp_path / "faster.toml"
    case.write_text(case_text(OF_SURFACE | {"speed": '"1 km/s"'}, surface=LAW))
    answer = call(capsys, "solve", case, "-v")
    assert (answer.code, answer.err) == (0, "")
    assert re.search(r"real contact area at x = 0 +0 *\n", answer.out)


def test_the_model_line_names_what_differs_from_the_article_in_si_units(capsys, tmp_path):
    case = tmp_path / "ball.toml"
    fluid = {"model": '"carreau"', "relaxation_time": '"10 ms"', "exponent": "0.6"}
    ball = {"geometry": '"point"', "load": '"1 N"', "speed": None, "entrainment_speed": '"30 mm/s"', "slide_to_roll": "0.5"}
    case.write_text(case_text(ball, fluid=fluid, solver={"rtol": "1e-2"}))
    said = call(capsys, "solve", case, "-v").out
    assert "Model: fluid carreau, relaxation time 10 ms, exponent 0.6, infinite viscosity 0 Pa*s.\n" in said
    assert said.count("slide-to-roll ratio 0.5") == 1 and "slide to roll" not in said
