"""Balls in sweeps, in sensitivities and regimes, in curves from the command line."""

import json
from pathlib import Path

import pytest
from command_line import call

import stribeck as sb

EXAMPLES = Path(__file__).parents[1] / "examples"


def ball(**changes):
    kept = {"radius": 0.01, "modulus": 1e6, "viscosity": 0.1, "alpha": 2.0, "beta": 0.1, "boundary_friction": 0.8}
    return sb.PointContact.from_groups(sb.Groups(1e-3, 1e-2, 2e-4, geometry="point"), **(kept | changes))


def test_the_command_prints_and_draws_a_ball(capsys, tmp_path):
    pytest.importorskip("matplotlib")
    picture = tmp_path / "ball.svg"
    answer = call(capsys, "solve", EXAMPLES / "rubber_ball.toml", "--rtol", "1e-3", "-v", "--plot", picture)
    assert answer.code == 0
    for said in ("slide-to-roll ratio 1", "distance of minimum film", "central pressure", f"Written: {picture}\n"):
        assert said in answer.out, said
    drawn = picture.read_text()
    assert "<svg" in drawn
    for said in ("film", "µm", "MPa"):
        assert said in drawn, said


@pytest.mark.quick
def test_the_examples_are_balls_with_a_law_that_holds_at_their_load(subtests):
    for name in ["pdms_ball", "tongue_model", "contact_lens", "rubber_ball"]:
        with subtests.test(name=name):
            contact = sb.load_case(EXAMPLES / f"{name}.toml").contact
            assert isinstance(contact, sb.PointContact)
            assert contact.groups.load > 1
            assert contact.law.name == "persson"
            assert contact.slope < 0.35


def test_the_command_solves_a_ball(capsys):
    answer = call(capsys, "solve", EXAMPLES / "rubber_ball.toml", "--rtol", "1e-3", "--json")
    assert answer.code == 0
    found = json.loads(answer.out)
    assert found["geometry"] == "point"
    assert found["units"]["load"] == "N"
    assert found["inputs"]["slide_to_roll"] == 1.0
    assert "wetted_radius" not in found["inputs"]
    assert found["central_film_thickness"] == pytest.approx(found["central_gap"] * found["hertz_indentation"], rel=1e-12)
