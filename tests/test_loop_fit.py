"""Fits of friction loops: inputs of a contact from friction over the position or time of a stroke."""

import json
import re

import numpy as np
import pytest
from command_line import EXAMPLES, call, case_text

import stribeck as sb

STROKE = {"motion": '"sine"', "stroke": '"5 mm"', "frequency": '"2 1/s"', "steps": "24"}
MOTION = sb.motions.Sine(5e-3, 2.0)
NOISE = 2e-3


@pytest.fixture
def case(tmp_path):
    path = tmp_path / "case.toml"
    path.write_text(case_text(stroke=STROKE))
    return path


def loop_of(path, contact, over="position [mm]", count=120, seed=1, motion=MOTION):
    """Write the loop of a contact with noise; positions count from one end."""
    found = sb.stroke(contact, motion, steps=48)
    last = found.last_cycle
    time = np.linspace(0, motion.duration, count + 1)[:-1]
    friction = np.interp(time, found.time[last] - found.time[last][0], found.friction[last])
    friction += NOISE * np.random.default_rng(seed).normal(size=count)
    x = time if over.startswith("time") else 10 + 1e3 * motion.position(time)
    path.write_text(f"{over},friction\n" + "".join(f"{a:.7g},{b:.7g}\n" for a, b in zip(x, friction, strict=True)))
    return path


def test_boundary_friction_comes_out_of_a_loop_over_position(case, tmp_path):
    contact = sb.load_case(case).contact
    path = loop_of(tmp_path / "loop.csv", contact.replace(boundary_friction=0.5))
    path.write_text(path.read_text() + "End of data\n")
    found = sb.bench.fit_loop(path, case, free=["boundary_friction"])
    assert found.notes[0] == "1 row below the numbers left out: 122."
    low, high = found["boundary_friction"].interval_95
    assert low < 0.5 < high and high / low < 1.6
    assert 0.7 * NOISE < found.noise < 4 * NOISE  # with what 24 steps leave
    assert re.search(r"neighbours correlated by 0\.\d\d$", str(found), re.MULTILINE)
    data, rows = found.to_dataset(), json.loads(json.dumps(found.to_dict()))["rows"]
    assert data.input_high_95.sel(input="boundary_friction") == high
    assert "friction: balanced" in str(found) and data.attrs["definition"] == "balanced"
    assert list(rows) == ["position", "friction", "fitted_friction", "fitted_friction_error"]
    assert rows["friction"] == data.friction.values.tolist() == found.measured.tolist()
    (axes,) = found.plot(tmp_path / "loop.png").axes
    assert axes.get_xlabel() == "position (mm)"


@pytest.mark.slow
def test_an_input_that_ends_at_its_bound_is_named_and_neighbours_without_correlation_are_called_so(case, tmp_path):
    path = loop_of(tmp_path / "loop.csv", sb.load_case(case).contact.replace(boundary_friction=0.5), "time [s]", 24, seed=3)
    case.write_text(case.read_text() + '\n[fit]\nfree = ["boundary_friction"]\nbounds.boundary_friction = [0.55, 0.9]\n')
    found = sb.bench.fit_loop(path, case)
    assert "ended at a bound" in str(found) and "neighbours uncorrelated" in str(found)
    assert "boundary_friction ended at its bound 0.55: the data would move it further" in found.notes[0]


@pytest.mark.slow
def test_positions_count_from_either_end_however_far_the_zero_of_the_force_is_off(case, tmp_path):
    path = loop_of(tmp_path / "loop.csv", sb.load_case(case).contact.replace(boundary_friction=0.5))
    rows = np.loadtxt(path, delimiter=",", skiprows=1)
    assert np.any(rows[:, 1] * (rows[:, 1] + 0.06) < -1e-4)  # fast rows of the way back seem to be of the way out
    path.write_text("position [mm],friction\n" + "".join(f"{25 - x:.7g},{y + 0.06:.7g}\n" for x, y in rows))
    found = sb.bench.fit_loop(path, case, free=["boundary_friction"])
    low, high = found["boundary_friction"].interval_95
    assert low < 0.5 < high < 1.6 * low and found.noise < 4 * NOISE
    (off,) = filter(None, (re.search(r"force is off by ([0-9.]+) ± 0\.000", note) for note in found.notes))
    assert float(off[1]) == pytest.approx(0.06, abs=2e-3)
    assert any("counted from the other end" in note for note in found.notes)
    assert not any("the other way" in note for note in found.notes)


@pytest.mark.slow
def test_a_drift_of_the_force_is_found_and_taken_off(case, tmp_path):
    path = loop_of(tmp_path / "loop.csv", sb.load_case(case).contact.replace(boundary_friction=0.5))
    x, steady = np.loadtxt(path, delimiter=",", skiprows=1, unpack=True)
    drifted = steady - 0.05 * np.arange(len(x)) / len(x)
    path.write_text("position [mm],friction\n" + "".join(f"{a:.7g},{b:.7g}\n" for a, b in zip(x, drifted, strict=True)))
    found = sb.bench.fit_loop(path, case, free=["boundary_friction"])
    low, high = found["boundary_friction"].interval_95
    assert low < 0.5 < high < 1.5 * low and found.noise < 4 * NOISE
    (drift,) = filter(None, (re.search(r"drifts by (-[0-9.]+) ± (0\.00[0-9]*) from the first", note) for note in found.notes))
    assert abs(float(drift[1]) + 0.05) < 3 * float(drift[2])
    assert np.abs(found.measured - steady[np.isin(1e-3 * x, found.values)]).max() < 0.005


@pytest.mark.parametrize(
    "free", [("boundary_friction",), pytest.param(("boundary_friction", "roughness"), marks=pytest.mark.slow)]
)
def test_a_loop_that_does_not_determine_its_inputs_says_so(capsys, case, tmp_path, free):
    path = loop_of(tmp_path / "loop.csv", sb.load_case(case).contact, "time")
    head, *rows = path.read_text().splitlines()
    later = [f"{float(time) + 0.125:.7g},{friction}" for time, friction in (row.split(",") for row in rows)]
    path.write_text("\n".join([head, *later]))  # a quarter of a cycle
    answer = call(capsys, "loop", path, case, "--free", *free, "--json")
    found = json.loads(answer.out)
    assert {name for each in found["undetermined"] for name in each["names"]} == set(free)
    for each in found["inputs"]:
        assert each["interval_95"] == [0, None]  # open
    assert set(found["rows"]) == set(found["units"]) and found["units"]["time"] == "s"
    assert any("'time' was read in seconds, as its header has no unit" in note for note in found["notes"])
    assert any("rows friction has the sign of the other way" in note for note in found["notes"])


@pytest.mark.slow
def test_boundary_friction_and_roughness_come_out_of_a_loop_over_time(capsys, case, tmp_path):
    contact = sb.load_case(case).contact
    path = loop_of(
        tmp_path / "loop.csv", contact.replace(boundary_friction=0.5, roughness=1.3 * contact.roughness), "time [s]"
    )
    found = json.loads(call(capsys, "loop", path, case, "--json").out)
    assert found["outcome"] == "CONVERGED"
    for each, value in zip(found["inputs"], (0.5, 1.3 * contact.roughness), strict=True):
        assert each["interval_95"][0] < value < each["interval_95"][1]
        assert each["value"] == pytest.approx(value, rel=0.06)


@pytest.mark.slow
def test_intervals_of_loops_cover_the_truth(case, tmp_path):
    """Of loops over position and time, of two speeds, and of a film that ends: at least five of six 95 % intervals."""
    contact = sb.load_case(case).contact
    inside = []
    for seed, (over, speed, ends) in enumerate(
        [("position [mm]", 0.3, "none"), ("time [s]", 0.2, "none"), ("position [mm]", 0.3, "exit")]
    ):
        start, motion = contact.replace(cavitation=ends), sb.motions.Sine(20e-3, 0.5 * speed)
        truth = start.replace(boundary_friction=0.5, roughness=1.2 * contact.roughness)
        path = loop_of(tmp_path / f"{seed}.csv", truth, over, seed=seed, motion=motion)
        for each in sb.bench.fit_loop(path, start, motion, steps=24).inputs:
            low, high = each.interval_95
            inside.append(low < getattr(truth, each.name) < high < 2 * low)
    assert sum(inside) >= 5, inside


@pytest.mark.slow
def test_a_shear_stress_comes_out_of_a_loop_in_the_place_of_a_coefficient(tmp_path):
    seal = sb.load_case(EXAMPLES / "rod_seal.toml").contact.replace(shear_stress="0.2 MPa")
    motion = sb.motions.Sine(20e-3, 0.5)
    path = loop_of(tmp_path / "loop.csv", seal, motion=motion)
    found = sb.bench.fit_loop(path, seal.replace(shear_stress="0.3 MPa"), motion, free=["shear_stress"], steps=24)
    low, high = found["shear_stress"].interval_95
    assert low < 0.2e6 < high < 1.3 * low


def test_what_is_no_loop_is_refused(subtests, capsys, case, tmp_path):
    for text, said in [
        ("position [mm],friction\n0,0.1\n1,0.2\n", "friction has one sign"),
        ("speed,friction\n0,0.1\n1,-0.2\n", "a loop has a column 'friction'"),
        ("position [cm],friction\n0,0.1\n20,-0.2\n", "positions span 0.2 m and the motion 0.005 m"),
        ("time [s],friction\n0,0.1\n1,-0.2\n", "too few"),
        ("time [mm],friction\n0,0.1\n1,-0.2\n", "time"),
    ]:
        with subtests.test(text=text, said=said):
            path = tmp_path / "loop.csv"
            path.write_text(text)
            answer = call(capsys, "loop", path, case)
            assert answer.code == 2 and said in answer.err and answer.out == ""


def test_a_loop_needs_a_motion_that_repeats(tmp_path):
    path = tmp_path / "loop.csv"
    path.write_text("time [s],friction\n0,0.1\n1,-0.2\n")
    contact = sb.load_case(EXAMPLES / "pdms_cylinder.toml").contact
    with pytest.raises(sb.InputError, match="the motion is missing"):
        sb.bench.fit_loop(path, contact)
    with pytest.raises(sb.InputError, match="does not repeat"):
        sb.bench.fit_loop(path, contact, sb.motions.Ramp(1e-3, 2e-3, 1.0))
