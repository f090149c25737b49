"""Published experiments: inputs with sources and errors, predicted without a fit, measured over predicted."""

import json
import math
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from command_line import call

import stribeck as sb
from stribeck.experiments.experiment import load_experiment, predict_experiment

SHIPPED = Path(__file__).parent / "data" / "experiments"

FILE = """title = "A cylinder"
source = "made for this test"
licence = "CC0-1.0"
data = "friction.csv"
unknown = ["nothing"]

[contact]
radius = { value = "10 mm", error = "5 %", source = "calliper" }
modulus = { value = "2.7 MPa", error = "20 %", source = "indentation" }
load = { value = "30 N/m", error = "10 %", source = "weight" }
viscosity = { value = "50 mPa*s", error = "unknown", source = "label" }
roughness = { value = "1 um", error = "0 %", source = "profilometer" }
alpha = { value = 2.0, error = "0 %", source = "theory" }
beta = { value = 0.06, error = "0 %", source = "theory" }

[models.low.contact]
boundary_friction = { value = 0.5, error = "10 %", source = "dry run" }

[models.still.contact]
boundary_friction = { value = 0.5, error = "0 %", source = "dry run" }
speed = { value = "0 m/s", error = "0 %", source = "at rest" }
"""
ROWS = "row;speed [mm/s];friction;error\nslow;1;{:.17g};0.001\nfast;4;{:.17g};0.002\n"
KNOWN = {"viscosity": "50 mPa*s", "roughness": "1 um", "alpha": 2.0, "beta": 0.06, "boundary_friction": 0.5}


def contact(speed, radius=1e-2, modulus=2.7e6, load=30.0, **others):
    return sb.LineContact(speed=speed, radius=radius, modulus=modulus, load=load, **KNOWN | others)


@cache
def frictions():
    """Return what is predicted for the rows."""
    return [float(sb.solve(contact(speed)).friction) for speed in (1e-3, 4e-3)]


def filled(folder):
    """Write an experiment whose friction is a quarter more than predicted."""
    (folder / "experiment.toml").write_text(FILE)
    (folder / "friction.csv").write_text(ROWS.format(*(1.25 * each for each in frictions())))
    return folder


@pytest.fixture
def folder(tmp_path):
    return filled(tmp_path)


def replace_in(path, old, new):
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))


def test_measured_over_predicted_is_what_was_put_in_and_the_error_that_of_the_inputs(folder):
    experiment = load_experiment(folder)
    found = predict_experiment(experiment, "low")
    assert found.ratio == pytest.approx([1.25, 1.25], rel=1e-6)
    moved = ({"radius": 1.05e-2}, {"modulus": 1.2 * 2.7e6}, {"load": 33.0}, {"boundary_friction": 0.55})
    apart = [math.log(float(sb.solve(contact(1e-3, **each)).friction) / frictions()[0]) for each in moved]
    assert found.predicted_error[0] == pytest.approx(math.hypot(*apart), rel=1e-4)
    assert found.measured_error == pytest.approx(
        0.001 / found.measured[0] * np.array([1, 2 * found.measured[0] / found.measured[1]])
    )
    assert found.ratio_error == pytest.approx(np.hypot(found.predicted_error, found.measured_error))
    dataset = found.to_dataset()
    assert dataset.attrs["licence"] == "CC0-1.0" and dataset["ratio"].values == pytest.approx(found.ratio)


def test_a_model_may_set_an_input_of_every_row(folder):
    found = predict_experiment(load_experiment(folder), "still")
    assert found.predicted == pytest.approx([0.5, 0.5])


def test_ratios_are_over_the_row_that_is_named(folder):
    replace_in(folder / "experiment.toml", 'data = "friction.csv"', 'data = "friction.csv"\nrelative_to = 1')
    found = predict_experiment(load_experiment(folder), "low")
    assert found.predicted == pytest.approx([1.0, frictions()[1] / frictions()[0]], rel=1e-6)
    assert found.ratio == pytest.approx([1.0, 1.0], rel=1e-6)
    assert found.predicted_error[0] == pytest.approx(0.0, abs=1e-5)
    assert found.measured_error[0] == 0
    assert found.measured_error[1] == pytest.approx(math.hypot(0.001 / frictions()[0], 0.002 / frictions()[1]) / 1.25)


def test_friction_in_percent_is_a_hundredth(folder):
    measured = load_experiment(folder).measured
    replace_in(folder / "friction.csv", "friction;error", "friction [%];error [%]")
    percent = load_experiment(folder)
    assert percent.measured == pytest.approx(measured / 100)
    assert percent.measured_error == pytest.approx(load_experiment(filled(folder)).measured_error)


def test_a_force_is_that_of_the_load_over_the_length(folder):
    forces = [0.1 * 30 * each for each in frictions()]
    text = ROWS.format(*forces).replace("friction;error", "friction_force [N];error [N]")
    (folder / "friction.csv").write_text(text)
    replace_in(folder / "experiment.toml", 'data = "friction.csv"', 'data = "friction.csv"\nlength = "100 mm"')
    assert predict_experiment(load_experiment(folder), "low").ratio == pytest.approx([1.0, 1.0], rel=1e-6)


def test_the_command_gives_the_models_error_first(folder, capsys):
    answer = call(capsys, "experiment", folder, "--model", "low", "-v")
    lines = answer.out.splitlines()
    assert answer.code == 0
    assert lines[0].startswith("low: the errors of its inputs are") and "measured over predicted is 1.25 to 1.25" in lines[0]
    assert "Not counted, as their errors are not known: [contact] viscosity." in lines
    assert "Not known: nothing" in lines
    assert "[contact] load = 30 N/m ± 10 %: weight" in answer.out
    found = json.loads(call(capsys, "experiment", folder, "--model", "low", "--json").out)
    assert found["models"]["low"]["ratio"] == pytest.approx([1.25, 1.25], rel=1e-6)


def test_what_is_not_stated_is_refused(subtests, folder):
    for file, old, new, words in [
        (
            "experiment.toml",
            '"10 mm", error = "5 %", source = "calliper"',
            '"10 mm", error = "5 %"',
            "a value, an error and a source",
        ),
        ("experiment.toml", '{ value = "10 mm", error = "5 %", source = "calliper" }', '"10 mm"', r"\[contact\] radius"),
        ("experiment.toml", 'error = "5 %"', 'error = "small"', "a part of the value"),
        ("experiment.toml", 'licence = "CC0-1.0"', "", "licence is missing"),
        ("experiment.toml", 'value = "10 mm"', 'value = "wide"', "must be a number"),
        ("experiment.toml", 'data = "friction.csv"', 'data = "friction.csv"\nrelative_to = 3', "number of a row, 1 to 2"),
        ("experiment.toml", 'value = "10 mm"', 'value = "10 Pa"', "radius"),
        ("friction.csv", "friction;error", "friction;scatter", "one column error"),
        ("friction.csv", "friction;error", "mu;error", r"friction or friction_force \[N\]"),
        ("friction.csv", ";0.001", ";0", "must be positive"),
        ("friction.csv", "friction;error", "friction [N];error", "friction = 'N'"),
        ("friction.csv", "friction;error", "friction;error [%]", "must have the same unit"),
        ("friction.csv", "speed [mm/s]", "temperature [K]", "temperature"),
    ]:
        with subtests.test(file=file, old=old, new=new, words=words):
            replace_in(filled(folder) / file, old, new)
            with pytest.raises(sb.InputError, match=words):
                predict_experiment(load_experiment(folder), "low")


def test_a_folder_without_the_file_or_an_unknown_model_is_refused(folder, capsys):
    for path in (folder / "none", folder / "experiment.toml"):
        answer = call(capsys, "experiment", path)
        assert answer.code == 2 and "give the one that holds experiment.toml" in answer.err
    answer = call(capsys, "experiment", folder, "--model", "hihg")
    assert answer.code == 2 and "hihg" in answer.err


def test_what_ships_says_what_is_not_known_and_where_each_input_is_from():
    for path in SHIPPED.glob("*/experiment.toml"):
        experiment = load_experiment(path.parent)
        assert experiment.unknown and experiment.licence
        assert set(experiment.reasons) == set(experiment.models)
    assert load_experiment(SHIPPED / "oring").licence == "CC0-1.0"


@pytest.mark.slow
def test_an_o_ring_without_lubricant_would_have_a_stress_and_no_coefficient():
    """What docs/experiments.md shows."""
    experiment = load_experiment(SHIPPED / "oring")
    stress, coefficient = (predict_experiment(experiment, name) for name in ("stress", "coefficient"))
    assert stress.ratio[1:] == pytest.approx([0.884, 0.893, 0.841], abs=0.002)
    assert coefficient.ratio[1:] == pytest.approx([0.764, 0.685, 0.584], abs=0.002)
    assert stress.agrees.all() and not coefficient.agrees[1:].any()


@pytest.mark.slow
def test_the_contact_lens_is_missed_by_an_order():
    found = predict_experiment(load_experiment(SHIPPED / "contact_lens"), "model")
    assert found.ratio == pytest.approx([10.7, 18.8, 16.6], rel=0.02)
    assert not found.agrees.any()
