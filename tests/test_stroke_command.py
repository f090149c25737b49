"""The command ``stribeck stroke`` and the table ``[stroke]``: the answer first, every motion, and what is refused."""

import json
import re

import numpy as np
import pytest
from command_line import PDMS, call, case_text

import stribeck as sb

RAMP = {"motion": '"ramp"', "start": '"1 mm/s"', "end": '"3 mm/s"', "duration": '"0.5 s"', "steps": "16"}


@pytest.fixture
def write(tmp_path):
    def write(stroke, contact=None, **tables):
        path = tmp_path / "case.toml"
        path.write_text(case_text(contact, **({} if stroke is None else {"stroke": stroke}), **tables))
        return path

    return write


def test_the_answer_is_friction_beside_steady_sliding_and_files_hold_the_rest(capsys, write, tmp_path):
    files = tmp_path / "stroke.nc", tmp_path / "loop.png"
    answer = call(capsys, "stroke", write(RAMP))
    lines = answer.out.splitlines()
    assert (answer.code, answer.err) == (0, "")
    assert lines[0].startswith("Mean friction over the path out is 0.") and "steady sliding" in lines[0]
    assert len(lines) <= 25 and "-v shows" in answer.out
    found = json.loads(call(capsys, "stroke", write(RAMP), "-o", files[0], "--plot", files[1], "--json").out)
    state = sb.solve(sb.load_case(PDMS).contact.replace(speed=3e-3))
    assert found["steady_friction"] == pytest.approx(state.friction.total, rel=1e-3)
    assert found["friction"][-1] == found["friction_at_largest_speed"]
    # Numbers have the names and units of those of a state.
    assert found["definition"] == "balanced" and "friction on the way out, balanced" in answer.out
    assert found["central_film_thickness"][-1] == pytest.approx(state.to_dict()["central_film_thickness"], rel=0.15)  # it lags
    assert found["units"]["central_film_thickness"] == "m" and "central_gap" not in found
    assert (found["units"]["largest_speed"], found["units"]["mean_friction"]) == ("m/s", "1")
    # The film of a ramp of three half-widths lags behind the speed, so that there is more friction than in steady sliding.
    path, friction = np.array(found["position"]), np.array(found["friction"])
    mean = np.trapezoid(friction, path) / np.ptp(path)
    assert found["mean_friction"] == pytest.approx(mean, rel=0.005)
    assert found["work"] == pytest.approx(30.0 * mean * np.ptp(path), rel=0.02)
    assert found["mean_friction"] > 1.01 * found["steady_mean_friction"]
    # Rounded to one digit an error stood a third too small.
    for name, line in (("mean_friction", lines[0]), ("work", next(line for line in lines if line.startswith("work of")))):
        value, error = (float(each) for each in re.search(r"([0-9.]+) ± ([-0-9.e]+)", line).groups())
        assert error == pytest.approx(found[f"{name}_error"], rel=0.05), name
        assert value == pytest.approx(found[name], rel=5e-4)
    import xarray

    with xarray.open_dataset(files[0]) as data:
        assert np.array_equal(data.friction, found["friction"]) and data.attrs["definition"] == "balanced"
        assert data.friction_fluid_error.long_name == "estimated absolute error of friction_fluid"
    assert files[1].stat().st_size > 10_000


def test_all_commands_judge_the_stroke_of_the_motion_alike(subtests, capsys, write):
    """``check`` had the case outside the model for its stroke, where state, curve and regimes had it applied."""
    case = write({"motion": '"sine"', "stroke": '"20 mm"', "frequency": "0.1"})
    assert sb.load_case(case).facts == {"stroke": pytest.approx(0.02)}
    for command in ("check", "solve"):
        with subtests.test(command=command):
            found = json.loads(call(capsys, command, case, "--json").out)
            assert not found["applies"] and "stroke over a" in [each["name"] for each in found["checks"]]
    assert sb.load_case(write(None, check={"stroke": '"20 mm"'})).facts == {"stroke": 0.02}


def test_every_motion_is_read_from_its_table(subtests, write):
    for table, motion in [
        (RAMP, sb.motions.Ramp(1e-3, 3e-3, 0.5)),
        ({"motion": '"sine"', "stroke": '"5 cm"', "frequency": "2.0"}, sb.motions.Sine(0.05, 2.0)),
        ({"motion": '"stop"', "start": "0.1", "braking_time": '"10 ms"', "rest": "1.0"}, sb.motions.Stop(0.1, 0.01, 1.0)),
        (
            {"motion": '"table"', "time": '[0, "0.5 s", 1]', "velocity": "[0.1, 0.2, 0.1]", "repeats": "true", "cycles": "3"}
            | {"inlet": '"own-wake"'},
            sb.motions.Table([0, 0.5, 1], [0.1, 0.2, 0.1], repeats=True),
        ),
    ]:
        with subtests.test(table=table, motion=motion):
            found = sb.load_case(write(table)).stroke
            assert found.motion == motion
            given = {key: json.loads(table[key]) for key in ("cycles", "steps", "inlet") if key in table}
            assert found.arguments == {"motion": motion} | given


def test_a_table_that_is_wrong_is_refused_in_a_sentence(subtests, capsys, write):
    for table, said in [
        ({"stroke": '"5 cm"'}, '[stroke] motion is missing; add motion = "ramp" or "sine" or "stop" or "table".'),
        (RAMP | {"motion": '"saw"'}, "[stroke] motion = 'saw' must be one of 'ramp', 'sine', 'stop', 'table'."),
        (RAMP | {"end": None}, "[stroke] end is missing, which motion = 'ramp' needs"),
        (RAMP | {"end": '"3 mm"'}, "[stroke] end = '3 mm' is a length"),
        (RAMP | {"frequency": "1.0"}, "[stroke] frequency = 1.0 is given, but motion = 'ramp' has no such key"),
        (RAMP | {"inlet": '"dry"'}, "[stroke] inlet = 'dry' must be 'flooded' or 'own-wake'"),
        (RAMP | {"cycles": "0.5"}, "[stroke] cycles = 0.5 must be a whole number"),
        (
            {"motion": '"table"', "time": "[0, 1]", "velocity": "[1, 1]", "repeats": '"yes"'},
            "[stroke] repeats = 'yes' must be",
        ),
        (None, "the table [stroke] is missing; add"),
    ]:
        with subtests.test(table=table, said=said):
            answer = call(capsys, "stroke", write(table))
            assert answer.code == 2 and said in answer.err and answer.out == ""


def test_a_table_of_shear_stresses_goes_on_below_its_first_speed_and_not_above_its_last(capsys, write):
    stress = {
        "model": '"shear-stress-table"',
        "sliding_speeds": '["2 mm/s", "3 mm/s"]',
        "shear_stresses": '["0.2 MPa", "0.2 MPa"]',
    }
    rough = {"h_rms": '"1 um"', "hurst": "0.8", "longest_wavelength": '"150 um"', "shortest_wavelength": '"1.5 um"'}
    by_surface = dict.fromkeys(("boundary_friction", "roughness", "alpha", "beta"))
    by_surface |= {"law": '"persson"', "speed": '"3 mm/s"'}
    answer = call(capsys, "stroke", write(RAMP, by_surface, surface=rough, asperity_friction=stress), "--json")
    found = json.loads(answer.out)
    assert any("Slower than 2 mm/s" in each for each in found["notes"])
    assert found["friction_asperities"][0] > found["friction_asperities"][-1] > 0
    faster = RAMP | {"end": '"4 mm/s"'}
    answer = call(capsys, "stroke", write(faster, by_surface, surface=rough, asperity_friction=stress))
    assert answer.code == 2 and "outside the table of shear stresses" in answer.err


def test_a_contact_runs_into_its_own_wake_where_the_case_or_the_command_says_so(capsys, write):
    motion = {"motion": '"table"', "time": "[0, 0.1, 0.2]", "velocity": "[1e-2, 1e-2, -1e-2]", "steps": "16"}
    known = []
    for inlet, words in (('"own-wake"', ["--inlet", "flooded"]), ('"flooded"', ["--inlet", "own-wake"])):
        case = write(motion | {"inlet": inlet}, cavitation={"model": '"exit"'})
        known.append(json.loads(call(capsys, "stroke", case, "--json", *words).out))
    assert ["what the contact has left" in each["notes"][0] for each in known] == [False, True]


def test_check_takes_the_length_of_the_stroke_from_the_case(capsys, write):
    """What [check] says of it goes first."""
    motion = {"motion": '"sine"', "stroke": '"3 cm"', "frequency": "2.0"}
    half_width = sb.load_case(PDMS).contact.hertz.half_width
    for stroke, tables, length in ((motion, {}, 0.03), (motion, {"check": {"stroke": '"6 cm"'}}, 0.06)):
        checks = json.loads(call(capsys, "check", write(stroke, **tables), "--json").out)["checks"]
        found = [each["value"] for each in checks if each["name"] == "stroke over a"]
        assert found == [pytest.approx(length / half_width, rel=1e-3)]


def test_a_film_that_ends_does_so_unless_it_is_asked_to_be_full(capsys, write):
    ends = write(RAMP, cavitation={"model": '"exit"'})
    known = [json.loads(call(capsys, "stroke", ends, "--json", *words).out) for words in ([], ["--cavitation", "none"])]
    assert ["The film ends" in each["notes"][0] for each in known] == [True, False]
    assert known[0]["friction"][-1] < known[1]["friction"][-1]


def test_friction_at_the_largest_speed_is_that_of_the_end_of_a_plateau(capsys, write):
    # At its first instant the film lags behind the speed.
    times, speeds = '["0 s", "0.2 s", "2 s", "2.2 s"]', '["0.5 mm/s", "5 mm/s", "5 mm/s", "2 mm/s"]'
    motion = {"motion": '"table"', "time": times, "velocity": speeds, "steps": "24"}
    found = json.loads(call(capsys, "stroke", write(motion), "--json").out)
    assert found["friction_at_largest_speed"] == pytest.approx(found["steady_friction"], rel=0.02)
