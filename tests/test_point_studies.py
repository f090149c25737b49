"""Balls in sweeps, in sensitivities and regimes, in curves from the command line."""

import json
from pathlib import Path

import numpy as np
import pytest
from command_line import call

import stribeck as sb

EXAMPLES = Path(__file__).parents[1] / "examples"


def ball(**changes):
    kept = {"radius": 0.01, "modulus": 1e6, "viscosity": 0.1, "alpha": 2.0, "beta": 0.1, "boundary_friction": 0.8}
    return sb.PointContact.from_groups(sb.Groups(1e-3, 1e-2, 2e-4, geometry="point"), **(kept | changes))


def test_a_sweep_keeps_balls_with_their_own_observables(tmp_path):
    pytest.importorskip("xarray")
    path = tmp_path / "sweep.toml"
    path.write_text(
        '[groups]\ngeometry = "point"\nload = 0.01\nroughness = 2e-4\nbeta = 0.1\n[vary]\nspeed = [1e-3, 2e-3]\n'
        "[solver]\nrtol = 1e-3\n"
    )
    found = sb.sweep(path, tmp_path / "out.sqlite").to_dataset()
    assert set(found["outcome"].values.ravel()) == {"CONVERGED"}
    alone = sb.solve(sb.Groups(2e-3, 0.01, 2e-4, geometry="point"), rtol=1e-3)
    assert float(found["minimum_radius"].values.ravel()[1]) == pytest.approx(alone.minimum_radius, abs=1e-2)
    assert float(found["friction_balanced"].values.ravel()[1]) == pytest.approx(alone.friction(beta=0.1).total, rel=3e-3)


@pytest.mark.slow
def test_two_processes_find_what_one_does(tmp_path):
    pytest.importorskip("xarray")
    path = tmp_path / "sweep.toml"
    path.write_text(
        '[groups]\ngeometry = "point"\nroughness = 2e-4\nbeta = 0.1\n[vary]\nload = [0.001, 0.1]\nspeed = [1e-3, 2e-3]\n'
        "[solver]\nrtol = 1e-3\n"
    )
    one, two = (sb.sweep(path, tmp_path / f"{count}.sqlite", workers=count).to_dataset() for count in (1, 2))
    assert set(two["outcome"].values.ravel()) == {"CONVERGED"}
    for name in ("contact_load_share", "central_gap", "minimum_gap", "friction_balanced", "error_estimate"):
        np.testing.assert_array_equal(one[name].values, two[name].values, err_msg=name)


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
