"""What reports print: digits that the errors allow, and no share that is smaller than its error."""

import json
import re

import pytest
from command_line import call, case_text

import stribeck as sb
from stribeck.cli.reports.text import head_lines
from stribeck.contacts.contact import part_attributes
from stribeck.quantities.formats import format_share

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
    assert re.search(r"load on asperities +< \de-08\n", rows)


def test_a_part_known_to_more_is_printed_with_four_digits(capsys, tmp_path):
    case = tmp_path / "quick.toml"
    case.write_text(case_text({"speed": '"40 mm/s"'}))
    solution = sb.solve(sb.load_case(case).contact)
    assert solution.errors["contact_load_share"] < 1e-4 * solution.contact_load_share
    [shown] = re.findall(r"load on asperities +([\d.e-]+)", call(capsys, "solve", case, "-v").out)
    digits = len(shown.replace("0.", "").lstrip("0"))
    assert digits <= 4
    assert float(shown) == pytest.approx(solution.contact_load_share, rel=5e-4)


def test_a_contact_area_that_vanishes_is_zero(capsys, tmp_path):
    case = tmp_path / "faster.toml"
    case.write_text(case_text(OF_SURFACE | {"speed": '"1 km/s"'}, surface=LAW))
    answer = call(capsys, "solve", case, "-v")
    assert (answer.code, answer.err) == (0, "")
    assert re.search(r"real contact area at x = 0 +0 *\n", answer.out)


def test_shares_are_bounded_by_their_errors(subtests):
    for part, error, text in [
        (0.2034, 1e-7, "20.3 %"),
        (0.0, 1e-7, "0 %"),
        (9.75e-155, 1e-9, "< 0.01 %"),
        (3e-8, 3.14e-8, "< 0.01 %"),
        (3e-4, 3.14e-4, "< 0.04 %"),
        (1.0, 0.0, "100 %"),
    ]:
        with subtests.test(part=part, error=error, text=text):
            assert format_share(part, error) == text


def test_the_model_line_names_what_differs_from_the_article_in_si_units():
    inputs = {"radius": 0.01, "modulus": 2e6, "load": 1.0, "viscosity": 0.02, "entrainment_speed": 0.03, "roughness": 1e-6}
    ball = sb.PointContact(
        **inputs, alpha=2.0, beta=0.05, boundary_friction=0.8, slide_to_roll=0.5, fluid=sb.fluids.Carreau("10 ms", 0.6)
    )
    assert part_attributes(ball.groups, ball)["slide_to_roll"] == 0.5
    said = "\n".join([*head_lines("", ball, ball.groups), ""])
    assert "Model: fluid carreau, relaxation time 10 ms, exponent 0.6, infinite viscosity 0 Pa*s.\n" in said
    assert said.count("slide-to-roll ratio 0.5") == 1 and "slide to roll" not in said
