"""Raw files of rigs become Stribeck curves: what is kept, what is left out, and intervals that hold the truth."""

import datetime
import json
import re
from pathlib import Path

import numpy as np
import pytest
from command_line import call, case_text
from scipy.signal import lfilter
from scipy.stats import binom, chi2, t

import stribeck as sb

DATA = Path(__file__).parent / "data"
EXAMPLE = Path(__file__).parents[1] / "examples" / "rig_raw.csv"
SPEEDS = np.array([0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0, 300.0])  # [mm/s]


def curve(speed):
    """Return the friction of the files at a speed in mm/s."""
    return 0.55 / (1 + (speed / 8) ** 0.9) + 0.02 + 0.0006 * speed**0.6


def noise(rng, n, memory=0.9):
    found = rng.normal(size=n) * (1 - memory**2) ** 0.5
    found[0] = rng.normal()
    return lfilter([1.0], [1.0, -memory], found)


def stepped(rng, n=120, *, speeds=SPEEDS, ways=(1, -1), start=0.2, zero=0.04, drift=0.05, load=2.0, amplitude=0.02):
    """Return rows of time [s], speed [mm/s], load [N] and force [N] of steps forth and back."""
    rows = []
    for speed in speeds:
        for way in ways:
            mu = curve(speed) * (1 + amplitude * noise(rng, n)) * (1 + start * np.exp(-np.arange(n) / 8))
            there = way * speed * np.minimum(1, (np.arange(n) + 1) / 4) * (1 + 0.002 * rng.normal(size=n))
            rows += [(u, load, way * load * each + zero) for u, each in zip(there, mu, strict=True)]
    found = np.column_stack([0.1 * np.arange(len(rows)), np.array(rows)])
    found[:, 3] += drift * np.linspace(0, 1, len(rows))
    return found


def text_of(rows, header="Time [s];Speed [mm/s];Fz [N];Fx [N]"):
    return "\n".join([header, *(";".join(f"{each:.6g}" for each in row) for row in rows)]) + "\n"


@pytest.fixture
def written(tmp_path):
    """Return a function that writes a file and returns its path."""

    def write(content, name="run.csv"):
        path = tmp_path / name
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return path

    return write


def refusal(path, *arguments, **options):
    with pytest.raises(sb.InputError) as caught:
        sb.bench.read(path, *arguments, **options)
    return str(caught.value)


def assert_holds(found, share=0.8):
    inside = np.abs(found.friction - curve(1e3 * found.speed)) < found.half_width
    assert np.mean(inside) >= share


def note_of(found, words):
    """Return whether a note has these words."""
    return any(words in each for each in found.notes)


@pytest.mark.parametrize("files", [12, pytest.param(40, marks=pytest.mark.slow)])
def test_of_95_per_cent_intervals_about_so_many_hold_the_truth_and_errors_are_the_scatter(written, files):
    """Counts and mean squares are those of chance within 999 of 1000 each way."""
    missed = []
    for seed in range(files):
        rows = stepped(np.random.default_rng(seed), 80, speeds=SPEEDS[1::2])
        found = sb.bench.read(written(text_of(rows)))
        assert len(found) == 4
        missed += ((found.friction - curve(1e3 * found.speed)) / found.half_width).tolist()
    chance, size = [1e-3, 1 - 1e-3], len(missed)
    low, high = binom.ppf(chance, size, 0.95)
    assert low <= np.sum(np.abs(missed) < 1) <= high
    low, high = chi2.ppf(chance, size)
    assert low < 1.96**2 * np.sum(np.square(missed)) < high
    assert np.median(found.half_width / curve(SPEEDS[1::2])) < 0.06


@pytest.mark.quick
def test_noise_of_the_force_that_is_alike_at_all_speeds_is_no_share_of_friction(written):
    rng, off = np.random.default_rng(8), []
    for _ in range(12):
        rows = stepped(rng, n=30, speeds=np.geomspace(0.3, 300, 8), start=0, amplitude=0)
        for step in rows.reshape(-1, 30, 4):
            step[:, 3] += 0.01 * noise(rng, 30)
        found = sb.bench.read(written(text_of(rows)))
        off.append((found.friction - curve(1e3 * found.speed)) / found.half_width * 1.96)
    sizes = np.sqrt(np.mean(np.square(off), axis=0))  # at each speed, one where the error is right
    assert np.all((sizes > 0.4) & (sizes < 1.4))


def test_the_zero_of_the_force_and_its_drift_are_found_and_taken_off(written):
    found = sb.bench.read(written(text_of(stepped(np.random.default_rng(1), amplitude=0.005))))
    assert_holds(found)
    [sentence] = [each for each in found.notes if each.startswith("Both directions")]
    assert (
        "the zero of the force is off by 6" in sentence and "drifts by 4" in sentence
    )  # 65 mN in the middle, 47 mN between passes
    assert (found.difference_error < 0.03).all()
    # Two forces of 0.04 to 0.09 N each way over 2 N.
    assert found.difference[0] == pytest.approx(0.043, abs=0.01) and found.difference[-1] == pytest.approx(0.087, abs=0.003)


@pytest.mark.quick
def test_what_a_file_shows_of_its_zero_and_its_errors_does_not_depend_on_the_others(written):
    """The zeros of other files were no part of what drifts were sought beside: one of 13 mN +- 1.3 was found where none is."""
    several = {"oil": [], "water": []}
    for fluid, load, runs in (("oil", 5.0, 2), ("water", 1.0, 4)):
        for run in range(runs):
            rows = stepped(np.random.default_rng(run), 40, start=0, drift=0, load=load, amplitude=0.005)
            rows[:, 3] *= 1 + 0.01 * np.random.default_rng(run).normal()
            several[fluid].append(written(text_of(rows), f"{fluid}_{run}.csv"))
    both = sb.bench.read([*several["oil"], *several["water"]], name="{fluid}_{run}")
    assert not note_of(both, "drifts") and note_of(both, "the zero of the force is off by 4")
    for k, fluid in enumerate(both.curves):
        alone = sb.bench.read(several[fluid], name="{fluid}_{run}")
        mine = both.curve == k
        assert both.friction[mine] == pytest.approx(alone.friction, rel=1e-6)
        assert both.half_width[mine] == pytest.approx(alone.half_width, rel=1e-6)


def test_the_start_of_each_step_is_left_out_with_a_sentence(written):
    found = sb.bench.read(written(text_of(stepped(np.random.default_rng(2), amplitude=0.005))))
    starts = [each for each in found.notes if "running mean still drifted" in each]
    assert len(starts) >= 12 and "of the step at 300 µm/s (rows " in starts[2]
    assert np.sum(found.status == 3) > 12 * 5
    assert note_of(found, "Left out: 48 rows in which the speed changes")
    assert found.rows.sum() == np.sum(found.status == 0)
    twice = stepped(np.random.default_rng(2), speeds=[5.0, 5.0, 50.0], ways=(1,), zero=0, drift=0, amplitude=0.002)
    twice[120:123, 1] = 5.0  # without a change of speed between them
    numbered = np.column_stack([twice, np.repeat([1, 2, 3], 120)])
    again = sb.bench.read(written(text_of(numbered, "Time [s];Speed [mm/s];Fz [N];Fx [N];Run")))
    assert (again.status[125:130] == 3).all()  # a step of the same speed has a start of its own


def test_a_torque_a_rotation_and_a_load_that_is_off_make_the_same_curve(written):
    rows = stepped(np.random.default_rng(3), speeds=SPEEDS[::2], amplitude=0.005)
    one = sb.bench.read(written(text_of(rows)))
    turning = rows * [1, 60 / (2 * np.pi * 20), 1, 20]  # 20 mm of track and arm
    settings = sb.FitSettings(track_radius=0.02, arm=0.02)
    other = sb.bench.read(written(text_of(turning, "Time [s];Speed [rpm];Fz [N];Torque [mN m]")), settings)
    assert other.speed == pytest.approx(one.speed, rel=1e-4) and other.friction == pytest.approx(one.friction, rel=1e-3)


def test_a_rotation_beside_forces_and_a_friction_coefficient_is_a_speed(written):
    rows = stepped(np.random.default_rng(3), speeds=SPEEDS[::2], n=40)
    turning = np.column_stack([rows * [1, 60 / (2 * np.pi * 20), 1, 1], np.abs(rows[:, 3] / rows[:, 2])])
    path = written(text_of(turning, "T [s];Rotary Speed [rpm];Fz [N];Fx [N];COF"))
    assert "'Rotary Speed [rpm]' is a rotation; the radius of its track" in refusal(path)
    found = sb.bench.read(path, track_radius="20 mm")
    assert found.speed == pytest.approx(sb.bench.read(written(text_of(rows))).speed, rel=1e-4)
    assert "'Fx [N]' / 'Fz [N]'" in found.taken[0]


def test_the_scatter_of_single_means_is_their_error(written):
    """Three runs of one mean for each speed; with 16 degrees of freedom the 95 % interval is that of Student."""
    runs = 1 + 0.02 * np.random.default_rng(5).normal(size=(3, len(SPEEDS)))
    texts = [
        "\n".join(["speed [mm/s];COF", *(f"{u};{each:.6f}" for u, each in zip(SPEEDS, run, strict=True))]) for run in runs
    ]
    scatter = np.sqrt(np.sum((runs - runs.mean(axis=0)) ** 2) / 16 / 3)
    several = [written(text, f"{i}.csv") for i, text in enumerate(texts)]
    for found in (sb.bench.read(several), sb.bench.read(written("\n".join(texts)))):
        assert found.half_width / found.friction == pytest.approx(np.full(len(SPEEDS), t.ppf(0.975, 16) * scatter), rel=0.02)
        assert not note_of(found, "Nothing shows") and not note_of(found, "no error can be made")


def test_a_column_of_the_load_may_be_empty(written):
    rows = stepped(np.random.default_rng(3), 30)
    without, empty = (
        sb.bench.read(written("\n".join([header, *(f"{t:.6g};{u:.6g};{end}{abs(f) / n:.6g}" for t, u, n, f in rows)]) + "\n"))
        for header, end in (("Time [s];Speed [mm/s];COF", ""), ("Time [s];Speed [mm/s];Fz [N];COF", ";"))
    )
    np.testing.assert_array_equal(empty.half_width, without.half_width)


def test_the_force_without_load_is_its_zero(written):
    rows = stepped(np.random.default_rng(4), ways=(1,), start=0, drift=0, amplitude=0.005)
    apart = np.zeros((60, 4))
    apart[:, 3] = 1e-3 * np.random.default_rng(5).normal(size=60)
    everything = np.vstack([apart + [0, 0, 0, 0.04], rows, apart + [0, 0, 0.01, 0.04]])
    everything[:, 3] += np.linspace(0, 0.05, len(everything))
    everything[:, 0] = 0.1 * np.arange(len(everything))
    found = sb.bench.read(written(text_of(everything)))
    assert_holds(found)
    assert note_of(found, "Zero of the force by 120 rows without load: 41")


def test_the_curve_is_read_by_fit_as_it_is(tmp_path, capsys):
    answer = call(capsys, "bench", EXAMPLE, "-o", tmp_path / "curve.csv", "--plot", tmp_path / "kept.png")
    assert answer.code == 0 and "7 points from 1260 rows" in answer.out and (tmp_path / "kept.png").stat().st_size > 20_000
    found, data = sb.bench.read(EXAMPLE), sb.read_measurements(tmp_path / "curve.csv")
    assert data.values == pytest.approx(found.speed) and data.friction == pytest.approx(found.friction)
    assert data.error == pytest.approx(found.error, rel=1e-3)
    case = tmp_path / "ball.toml"
    contact = {"geometry": '"point"', "load": '"2 N"', "modulus": '"1.6 MPa"', "radius": '"9.5 mm"'}
    case.write_text(case_text(contact, fit={"free": '["boundary_friction"]'}))
    assert sb.read_measurements(tmp_path / "curve.csv", sb.load_case(case).fit).inputs == ({"load": 2.0},)
    assert call(capsys, "bench", EXAMPLE, "-o", tmp_path / "curve.csv").code == 2  # kept
    answer = call(capsys, "bench", EXAMPLE, "--json")
    said = json.loads(answer.out)
    of_python = json.loads(json.dumps(found.to_dict(), allow_nan=False))
    assert said["friction"] == of_python["friction"] == pytest.approx(found.friction.tolist())
    numbers = {
        name for name, each in said.items() if isinstance(each, list) and isinstance(each[0:1] and each[0], float | int)
    }
    assert numbers <= set(said["units"]) and (said["units"]["load"], said["units"]["speed"]) == ("N", "m/s")
    assert said["paths"] == [str(EXAMPLE)] and said["files"] == []


def test_a_temperature_gives_the_viscosity_of_an_oil(tmp_path):
    found = sb.bench.read(EXAMPLE, fluid="iso-vg grade=46")
    oil = [sb.fluids.iso_vg(46, temperature=each).viscosity for each in found.temperature]
    assert found.viscosity == pytest.approx(oil) and np.ptp(found.temperature) > 1
    for text, make in (
        ("iso-vg grade=46 viscosity_index=120", lambda T: sb.fluids.iso_vg(46, T, 120)),
        ("glycerol-water weight_fraction=0.8", lambda T: sb.fluids.glycerol_water(0.8, T)),
    ):
        of_text = sb.bench.read(EXAMPLE, fluid=text)
        assert of_text.viscosity == pytest.approx([make(each).viscosity for each in of_text.temperature])
    found.to_csv(tmp_path / "warm.csv")
    data = sb.read_measurements(tmp_path / "warm.csv")
    assert data.abscissa == "speed_viscosity" and data.values == pytest.approx(found.speed * found.viscosity)
    assert "no condition" in refusal(EXAMPLE, fluid="iso-vg colour=46")
    assert "each once" in refusal(EXAMPLE, fluid="iso-vg grade=46 grade=32") and "one of 'water'" in refusal(EXAMPLE, fluid="")
    assert note_of(sb.bench.read(EXAMPLE, fluid="iso-vg"), "ISO VG (grade = 46")  # which nobody has said
    assert "one temperature only" in refusal(EXAMPLE, fluid="xanthan")


def test_files_are_told_apart_by_their_names_and_repeats_put_together(written):
    rows = [stepped(np.random.default_rng(k), 40, speeds=SPEEDS[::3], amplitude=0.005) for k in range(3)]
    names = ("water_2N_1.csv", "water_2N_2.csv", "oil_2N_1.csv")
    paths = [written(text_of(each), name) for each, name in zip(rows, names, strict=True)]
    found = sb.bench.read(paths, name="{fluid}_{load}N_{run}.csv")
    assert found.curves == ("water", "oil") and found.inputs == ({"load": 2.0}, {"load": 2.0})
    assert len(found) == 6 and np.all(found.rows[:3] > 1.3 * found.rows[3:])
    assert "does not follow" in refusal(paths[0], name="{fluid}-{load}N.csv")
    case = sb.FitSettings(files={"water_*": {"viscosity": "1 mPa*s"}, "oil_*": {"viscosity": "40 mPa*s"}})
    found = sb.bench.read([path.parent / "*_2N_?.csv" for path in paths[:1]], case)
    assert found.viscosity.tolist() == [0.04] * 3 + [0.001] * 3
    assert "given twice" in refusal([paths[0], paths[0]])


FROM_THE_FIELD = {
    "01_rtec_preamble_trailing_comma.csv": 8,
    "02_umt_units_row_steps_grams.csv": 8,
    "03_time_series_steps_with_startup.csv": 8,
    "04_ball_on_disc_duplicate_and_blank_headers.txt": 8,
    "05_rheometer_utf16_intervals.csv": 8,
    "06_pin_on_disc_max_linear_speed_nominal_load.txt": 8,
    "07_reciprocating_stops_and_reversals.txt": 28,
    "10_header_in_comment.txt": 8,
    "12_three_header_rows.txt": 8,
    "13_plus_minus_cells.csv": 8,
    "15_merged_header.xlsx": 16,
    "16_pure_rolling_and_half_sliding.csv": 8,
}


def test_files_that_differ_more_than_noise_are_to_be_named(written):
    rows = stepped(np.random.default_rng(812), 60)
    thinner = rows * [1, 1, 1, 2]
    files = [written(text_of(each), name) for name, each in (("water_1.csv", rows), ("oil_1.csv", thinner))]
    assert any("need names: --name '{fluid}'" in note for note in sb.bench.read(files).notes)
    assert not any("--name" in note for note in sb.bench.read(files, name="{fluid}_{run}").notes)


def test_files_from_the_field_are_read(subtests):
    for name, points in FROM_THE_FIELD.items():
        with subtests.test(name=name):
            found = sb.bench.read(DATA / name)
            assert len(found) == points
            doubled = 2 if name.startswith(("04", "16")) else 1
            known = found.friction / curve(1e3 * found.speed / doubled)
            if name.startswith("16"):  # another curve
                continue
            factor = np.where(found.curve == 1, 0.9, 1.0) if name.startswith("15") else 1.0
            assert known / factor == pytest.approx(np.ones(points), rel=0.03 if name.startswith("03") else 0.011)


def test_errors_that_a_file_gives_are_those_of_its_points(written):
    found = sb.bench.read(DATA / "13_plus_minus_cells.csv")
    assert found.half_width / 1.959964 == pytest.approx(0.05 * found.friction, rel=1e-3)
    assert not note_of(found, "no error") and note_of(found, "Each row is a point")
    rows = stepped(np.random.default_rng(3), speeds=SPEEDS[::2], amplitude=0.005)
    plain = sb.bench.read(written(text_of(rows)))
    head, *lines = text_of(rows).strip().split("\n")
    wide = sb.bench.read(written("\n".join([f"{head};friction error", *(f"{line};0.5" for line in lines)]), "wide.csv"))
    assert (wide.half_width > 3 * plain.half_width).all()  # 300 rows of 0.5 each: 0.03


REFUSED = {
    "08_torque_instead_of_force.csv": "arm = '20 mm' in [bench]",
    "09_hersey_number_ball.csv": "a series needs a column of speed",
    "11_digitizer_pairs_of_columns.csv": "as in speed = 'X' and friction = 'Y'",
    "14_log_speed.csv": "is a logarithm, which is no speed",
}


@pytest.mark.quick
def test_what_is_no_series_is_refused_with_what_to_do(subtests, written):
    for name, sentence in REFUSED.items():
        with subtests.test(name=name):
            assert sentence in refusal(DATA / name)
    bad = {
        "no speed": ("time [s];COF\n1;0.2\n2;0.3\n", "known as speed"),
        "one line": ("time [s];speed [mm/s];COF\n", "no rows of numbers"),
        "nothing": ("", "holds no data"),
        "binary": (b"\x89PNG\0\0\1\2", "is not text"),
        "only NaN": ("time [s];speed [mm/s];COF\n1;2;nan\n2;3;nan\n", "no row holds both speed and friction"),
        "backwards": (
            "time [s];speed [mm/s];COF\n1;2;.1\n2;2;.1\n3;2;.1\n2.5;2;.1\n3.5;2;.1\n",
            "row 5, column 'time [s]': time runs back",
        ),
        "at rest": ("speed [mm/s];COF\n0;.1\n0;.2\n0;.1\n", "no row is in motion"),
        "no friction": ("speed [mm/s];COF\n1;0\n1;0\n1;0\n", "friction is zero in all rows"),
        "per cent": ("speed [mm/s];COF\n1;20\n2;30\n", "if it is in percent"),
        "force in mN": ("speed [mm/s];Fx [N];Fz [N]\n1;60;2\n2;50;2\n", "check the units of the forces"),
    }
    for name, (content, sentence) in bad.items():
        with subtests.test(name=name):
            assert sentence in refusal(written(content))
    assert "none called 'Kraft', which [bench.columns] has as friction_force" in refusal(
        EXAMPLE, sb.FitSettings(columns={"friction_force": "Kraft"})
    )
    assert "cannot be read" in refusal("there_is_none.csv")
    assert "per_decade" in refusal(EXAMPLE, per_decade=0)


def test_overflows_and_codes_of_missing_values_are_no_friction(written, subtests):
    rows = stepped(np.random.default_rng(4), speeds=SPEEDS[::3], n=40, ways=(1,), zero=0, drift=0)
    for column, code in ((3, 9.99e37), (3, 99999), (3, 25), (3, -9999), (2, 9.99e37), (2, 99999)):
        with subtests.test(column=column, code=code):
            coded = rows.copy()
            coded[::13, column] = code
            found = sb.bench.read(written(text_of(coded)))
            assert_holds(found)
            assert note_of(found, "10 rows with ") and note_of(found, "left out: 2, 15, 28,") and len(found.row) == 110
    coded = rows.copy()
    coded[13, 1] = 9.99e37
    for code in (0, -1):
        single = [f"{u};{curve(u) if u != 3 else code:.3f}" for u in SPEEDS]
        assert note_of(sb.bench.read(written("\n".join(["speed [mm/s];COF", *single]))), "Friction is not positive at 3 mm/s")
    assert "has '9.99e+37' in row 15, which programs write where a value is missing" in refusal(written(text_of(coded)))


def ball_on_disc(rng):
    """Return the text of a rig with two drives: a header above each step, rolling speed and slide-to-roll ratio."""
    lines = ["Test data file", "Disc track radius:\t20.7", ""]
    for step, rolling in enumerate(SPEEDS[1:], 1):
        lines += ["", f'Step {step} "Stribeck" started at 12:0{step}', "Step type\tSTRIBECK"]
        lines.append("Step Time (s)\tRolling Speed (mm/s)\tSRR (%)\tBall Load (N)\tLube Temp (°C)\tTraction Force (N)")
        mu = curve(2 * rolling) * (1 + 0.01 * noise(rng, 80, 0.7)) * (1 + 0.2 * np.exp(-np.arange(80) / 4))
        speeds = rolling * np.minimum(1, (np.arange(80) + 1) / 3) * (1 + 0.002 * rng.normal(size=80))
        lines += [
            f"{k}\t{u:.5g}\t50\t2.0{k % 3}\t40.0{k % 2}\t{(2 + 0.01 * (k % 3)) * each:.5g}"
            for k, (u, each) in enumerate(zip(speeds, mu, strict=True))
        ]
    return "\n".join(lines)


def test_a_speed_beside_a_slide_to_roll_ratio_is_asked_whether_it_is_the_mean(written, subtests):
    rows = "".join(f"{t};{1 + t // 4};{0.5 - 0.01 * t:.2f};50\n" for t in range(12))
    column = "Time [s];Speed [mm/s];COF;SRR [%]\n" + rows
    line = "SRR: 50 %\n" + column.replace(";SRR [%]", "").replace(";50\n", "\n")
    name = line.partition("\n")[2]
    for place, text, options in (("column", column, {}), ("line", line, {}), ("name", name, {"name": "rig_{slide_to_roll}"})):
        with subtests.test(place=place):
            path = written(text, "rig_0.5.csv")
            with pytest.raises(sb.InputError, match="'Speed .mm/s.' may be the mean of both surface speeds or their sum"):
                sb.bench.read(path, **options)
            path = written(text.replace("Speed", "Mean speed"), "rig_0.5.csv")
            found = sb.bench.read(path, **options)
            assert found.speed == pytest.approx([2e-3, 4e-3, 6e-3]) and found.inputs == ({"slide_to_roll": 0.5},)


def pin_on_disc(rng):
    """Return the text of a rig that writes laps, the size of the speed and the friction coefficient."""
    lines = ["Sample\tPDMS", "Normal load: 2 N", "", "Time [s]\tDistance [m]\tLaps\tLinear Speed [cm/s]\tµ"]
    time = 0.0
    for speed in SPEEDS[2:]:
        # Run-out of the disc: the friction of a lap of 25 rows goes up and down.
        mu = curve(speed) * (1 + 0.01 * noise(rng, 150, 0.5) + 0.03 * np.sin(2 * np.pi * np.arange(150) / 25))
        for k, each in enumerate(mu):
            lines.append(f"{time:.1f}\t0\t{k // 25}\t{speed / 10:.4g}\t{each:.5f}")
            time += 0.2
    return "\n".join(lines)


def strokes(rng, *, sine):
    """Return the text of a reciprocating rig whose force has the sign of the motion, and stops between the strokes."""
    rows, time = [], 0.0
    for top in SPEEDS[2::2]:
        for k in range(40):
            way = 1 if k % 2 == 0 else -1
            place = (np.arange(30) + 0.5) / 30
            speed = top * (np.sin(np.pi * place) if sine else np.minimum(1, np.minimum(place, 1 - place) * 10))
            mu = curve(speed) * (1 + 0.01 * noise(rng, 30)) * (1 + (0.15 * np.exp(-k / 2) if not sine else 0.0))
            rows += [
                (time + 0.05 * i, way * u, 2.0, way * 2 * each + 0.03)
                for i, (u, each) in enumerate(zip(speed, mu, strict=True))
            ]
            rows += [(time + 1.5 + 0.05 * i, 0.0, 2.0, 0.03) for i in range(2)]
            time += 1.6
    return text_of(rows, "Time [s]\tSpeed [mm/s]\tNormal Force [N]\tFriction Force [N]").replace(";", "\t")


def test_a_ball_on_disc_with_two_drives(written):
    found = sb.bench.read(written(ball_on_disc(np.random.default_rng(11)), "ball.txt"))
    assert len(found) == 7 and found.rolls and found.inputs == ({"load": 2.0, "slide_to_roll": 0.5},)
    assert found.temperature == pytest.approx(40, abs=0.1)
    assert found.time == pytest.approx(np.arange(len(found.time)))  # which begins anew with each step
    assert_holds(found)


def test_fit_reads_a_curve_of_two_drives_that_warmed(written, tmp_path):
    rows = "".join(f"{t};{1 + t // 4};{0.5 - 0.01 * t:.2f};50;{25 + t // 4}\n" for t in range(12))
    path = written("Time [s];Mean speed [mm/s];COF;SRR [%];Temperature [°C]\n" + rows)
    found = sb.bench.read(path, fluid="iso-vg grade=46")
    found.to_csv(tmp_path / "curve.csv")
    read = sb.read_measurements(tmp_path / "curve.csv")
    assert read.abscissa == "speed_viscosity" and read.values == pytest.approx(found.viscosity * found.speed)


def test_a_pin_on_disc_whose_friction_goes_up_and_down_with_each_lap(written):
    found = sb.bench.read(written(pin_on_disc(np.random.default_rng(12)), "pin.txt"))
    assert len(found) == 6 and found.inputs == ({"load": 2.0},)
    assert_holds(found)
    assert np.all(found.half_width < 0.05 * found.friction)


def test_strokes_are_values_of_both_directions(written):
    found = sb.bench.read(written(strokes(np.random.default_rng(101), sine=False), "strokes.txt"))
    assert len(found) == 3 and found.difference == pytest.approx(0.03, abs=0.01)
    assert_holds(found)
    assert any("first" in each and "strokes of the step" in each for each in found.notes)


def test_a_sine_is_put_together_in_bins_of_the_speed(written):
    found = sb.bench.read(written(strokes(np.random.default_rng(14), sine=True), "sine.txt"))
    assert len(found) > 20 and note_of(found, "The speed never rests")
    assert_holds(found)


RIG = """
[bench]
arm = "20 mm"
track_radius = "20 mm"
per_decade = 4
fluid = "iso-vg grade=46"
temperature = "40 degC"
name = "{fluid}_{run}.csv"
columns = {speed = "Drehzahl", friction_force = "Kraft"}
units = {speed = "mm/s", friction_force = "N"}
run_in = "keep"
"""


def test_the_table_bench_has_what_the_command_takes_as_options(written, tmp_path, capsys):
    rows = stepped(np.random.default_rng(3), 40, speeds=SPEEDS[::2], amplitude=0.005) * [1, 60 / (2 * np.pi * 20), 1, 20]
    path = written(text_of(rows, "Time [s];Speed [rpm];Fz [N];Torque [mN m]"), "oil_1.csv")
    rig = written('[bench]\narm = "20 mm"\ntrack_radius = "20 mm"\n', "rig.toml")
    expected = sb.bench.read(path, arm="20 mm", track_radius=0.02)
    assert sb.bench.read(path, rig) == expected
    assert sb.bench.read(path, sb.FitSettings(track_radius=0.02, arm=0.02)) == expected
    assert sb.bench.read(path, rig, arm="40 mm").friction == pytest.approx(expected.friction / 2, rel=1e-3)  # a call wins
    case = written(case_text(fit={"arm": '"40 mm"', "track_radius": '"10 mm"'}) + "\n" + rig.read_text(), "case.toml")
    assert sb.bench.read(path, sb.load_case(case)).friction == pytest.approx(expected.friction)  # and [bench] more than [fit]
    assert sb.bench.read(path, sb.load_case(case).fit).speed == pytest.approx(expected.speed / 2)
    assert call(capsys, "bench", path, "--case", rig, "-o", tmp_path / "a.csv").code == 0
    options = ("--arm", "20 mm", "--track-radius", "20 mm", "-o", tmp_path / "b.csv")
    assert call(capsys, "bench", path, *options).code == 0
    assert (tmp_path / "a.csv").read_text() == (tmp_path / "b.csv").read_text()
    plain = written(
        text_of(rows / [1, 60 / (2 * np.pi * 20), 1, 20], "Zeit;Drehzahl;Fz [N];Kraft").replace(".", ","), "x_1.csv"
    )
    found = sb.bench.read(plain, written(RIG, "all.toml"))
    assert found.curves == ("x",) and np.all(found.viscosity == sb.fluids.iso_vg(46, temperature=40).viscosity)


def test_loads_per_length_separate_the_curves_of_a_cylinder(written, tmp_path):
    rng = np.random.default_rng(6)
    rows = [
        f"{speed};{load / speed**0.3 * (1 + 0.01 * rng.normal()):.5f};{1e-3 * load * (1 + 0.002 * rng.normal()):.5f}"
        for load, speed in np.repeat([(30, 1), (30, 10), (60, 1), (60, 10)], 20, axis=0)
    ]
    found = sb.bench.read(written("\n".join(["Speed [mm/s];COF [%];Load [N/mm]", *rows]).replace(";", "\t")))
    assert [each["load_per_length"] for each in found.inputs] == [30.0, 60.0] and len(found) == 4
    found.to_csv(tmp_path / "curve.csv")
    read = sb.read_measurements(tmp_path / "curve.csv", sb.load_case(EXAMPLE.with_name("pdms_fit.toml")).fit)
    assert [each["load"] for each in read.inputs] == [30.0, 60.0] and read.friction == pytest.approx(found.friction)


def test_a_column_of_words_that_is_not_used_is_noted(written):
    rows = "".join(f"{t};{1 + t // 4 % 3};{0.5 - 0.01 * t:.2f};{'water' if t < 12 else 'oil'};a\n" for t in range(24))
    path = written("Time [s];Speed [mm/s];COF;Lubricant;Operator\n" + rows)
    words = "'Lubricant' was not used, though its rows differ, as 'water' and 'oil'; curve = 'Lubricant' in [bench.columns]"
    assert note_of(sb.bench.read(path), words)
    curves = sb.bench.read(path, written("[bench.columns]\ncurve = 'Lubricant'\n", "rig.toml"))
    assert curves.curves == ("water", "oil") and not any("Lubricant" in note for note in curves.notes)


def test_an_arm_without_a_unit_is_shown_with_the_one_it_was_read_in(written, capsys):
    rows = stepped(np.random.default_rng(3), 40, speeds=SPEEDS[::2], amplitude=0.005)
    path = written(text_of(rows, "Time [s];Speed [mm/s];Fz [N];Torque [mN m]"))
    assert "arm 20 m of the case" in call(capsys, "bench", path, "--arm", "20").out
    [taken] = json.loads(call(capsys, "bench", path, "--arm", "20", "--json").out)["taken"]
    assert "arm 20 m of the case" in taken
    assert "arm 20 mm of the case" in str(sb.bench.read(path, arm=0.02))


def test_a_wrong_entry_of_the_table_bench_is_refused_with_its_place(written, subtests):
    for text, words in (
        ('arm = "20 N"', "[bench] arm = '20 N' is a force"),
        ("arm = 0", "[bench] arm = 0 must be positive"),
        ("per_decade = 0", "[bench] per_decade = 0 must be between 1 and 1000"),
        ('fluid = "iso-vg grad=46"', "[bench] grad is no condition"),
        ('name = "{lode}N.csv"', "[bench] lode"),
        ('columns = {sped = "v"}', "[bench.columns] sped"),
        ("free = []", "[bench] free = [] is not a known key"),
    ):
        with subtests.test(words=words):
            path = written(f"[bench]\n{text}\n", "rig.toml")
            assert f"{path}: {words}" in refusal(EXAMPLE, path)
            with pytest.raises(sb.InputError, match=re.escape(words)):
                sb.load_case(written(case_text() + "\n" + path.read_text(), "case.toml"))


def test_the_time_of_day_is_a_time_over_midnight_too(written, subtests):
    rows = stepped(np.random.default_rng(3), 40, speeds=SPEEDS[::2], amplitude=0.005)
    rows = np.delete(rows, slice(295, 310), axis=0)  # nothing was written at midnight
    expected = sb.bench.read(written(text_of(rows)))

    def text(stamp, header):
        lines = [f"{stamp(row[0])};{row[1]:.6g};{row[2]:.6g};{row[3]:.6g}" for row in rows]
        return "\n".join([f"{header};Speed [mm/s];Fz [N];Fx [N]", *lines]) + "\n"

    start = datetime.datetime(2026, 11, 28, 23, 59, 30)

    def at(seconds):
        return start + datetime.timedelta(seconds=round(float(seconds), 1))

    for header, stamp in (
        ("Time", lambda s: at(s).strftime("%H:%M:%S.%f")),
        ("Date Time", lambda s: at(s).isoformat()),
        ("Clock", lambda s: at(s).strftime("%I:%M:%S.%f %p")),
        ("Zeit [hh:mm:ss]", lambda s: at(s).strftime("%H:%M:%S,%f")),
        ("Datum/Uhrzeit", lambda s: at(s).strftime("%d.%m.%Y %H:%M:%S.%f")),
        ("Zeitstempel", lambda s: at(s).strftime("%H:%M:%S.%f")),
        ("Timestamp", lambda s: at(s).strftime("%Y-%m-%d %H:%M:%S.%f").replace(".", ",")),
    ):
        with subtests.test(header=header):
            found = sb.bench.read(written(text(stamp, header)))
            assert found.time == pytest.approx(expected.time, rel=0, abs=1e-6)
            assert found.friction == pytest.approx(expected.friction, rel=1e-9)
            assert any("time of day" in note for note in found.notes)


@pytest.mark.quick
def test_short_stretches_of_one_direction_are_noise_where_the_motion_turns_and_long_ones_strokes(written):
    """``TURNING``: a stretch that is shorter than a tenth of the usual stroke is noise around rest."""
    rows, noise = [], []
    for k in range(12):
        way, n = (1 if k % 2 == 0 else -1), 60 if k % 3 else 20  # some strokes are a third as long as others
        rows += [way * 20 * np.sin(np.pi * (i + 0.5) / n) for i in range(n)]
        noise += range(len(rows), len(rows) + 4)
        rows += [-0.5 * way, 0.5 * way, -0.5 * way, 0.5 * way]
    friction = curve(np.abs(rows)) * np.sign(rows)
    found = sb.bench.read(written(text_of(np.column_stack([rows, friction]), "Speed [mm/s];COF")))
    assert (found.status[noise] != 0).all()
    assert (np.delete(found.status, noise) == 0).all()


@pytest.mark.quick
def test_surfaces_are_apart_below_a_twentieth_of_the_usual_load(written, subtests):
    """``UNLOADED``."""
    rows = stepped(np.random.default_rng(4), ways=(1,), zero=0.0, drift=0.0)
    for share, apart in ((0.04, True), (0.06, False)):
        with subtests.test(share=share):
            lifted = rows[:40] * [1, 1, share, 0] + [0, 0, 0, 0.04]
            found = sb.bench.read(written(text_of(np.vstack([lifted, rows + [4, 0, 0, 0]]))))
            assert note_of(found, "40 rows without load: 40 mN") is apart


@pytest.mark.quick
def test_forces_are_taken_for_a_friction_coefficient_that_agrees_within_two_per_cent(written, subtests):
    """``SAME_FRICTION``: a coefficient that is the quotient of the forces beside it has lost their sign."""
    rows = stepped(np.random.default_rng(4), speeds=SPEEDS[::3], n=40)
    for factor, words in ((1.01, "'Fx [N]' / 'Fz [N]'"), (0.97, "'COF' as friction")):
        with subtests.test(factor=factor):
            beside = np.column_stack([rows, factor * np.abs(rows[:, 3] / rows[:, 2])])
            [taken] = sb.bench.read(written(text_of(beside, "Time [s];Speed [mm/s];Fz [N];Fx [N];COF"))).taken
            assert words in taken


@pytest.mark.quick
def test_a_time_is_known_by_its_usual_names(written, subtests):
    rows = stepped(np.random.default_rng(4), speeds=SPEEDS[::3], n=40)[:, [0, 1, 2, 3]]
    for name, unit in (
        ("Zeit", "s"),
        ("Messzeit", "min"),
        ("Test time", "min"),
        ("Measuring time", "s"),
        ("Relative time", "s"),
        ("t", "h"),
    ):
        with subtests.test(name=name):
            found = sb.bench.read(written(text_of(rows, f"{name} [{unit}];Speed [mm/s];Fz [N];Fx [N]")))
            assert found.time == pytest.approx(rows[:, 0] * {"s": 1, "min": 60, "h": 3600}[unit])
    for name, cell, why in (
        ("Time", "noon", "'Time' was not read as time, as 'noon' is neither a number nor a clock that goes on"),
        ("Time [N]", "1", "'Time [N]' was not read as time, as 'N' is no unit of time"),
        ("Dwell time [s]", "1", "'Dwell time [s]' was not read as time, as its name is not known as one"),
        ("Time [s]", "12", "'Time [s]' is the same in all rows"),
    ):
        with subtests.test(name=name):
            head, *lines = text_of(rows[:, 1:], "Speed [mm/s];Fz [N];Fx [N]").splitlines()
            found = sb.bench.read(written("\n".join([f"{name};{head}", *(f"{cell};{line}" for line in lines)])))
            assert found.notes[0] == f"{why}; rows count as evenly spaced."
    same = text_of(np.column_stack([np.full(len(rows), 12.0), rows]), "Time [s];Test time [s];Speed [mm/s];Fz [N];Fx [N]")
    assert sb.bench.read(written(same)).time == pytest.approx(rows[:, 0])  # the length of a step, alike in all rows


@pytest.mark.quick
def test_an_error_is_at_least_that_of_the_last_digit_and_of_a_drift(written):
    speeds = np.repeat([1.0, 10.0], 60)
    digits = "Time [s];Speed [mm/s];COF\n" + "\n".join(f"{i};{u};{0.6 - u / 50:.2f}" for i, u in enumerate(speeds))
    assert sb.bench.read(written(digits)).error == pytest.approx([0.01 / np.sqrt(12)] * 2, rel=0.05)
    speeds, place = np.repeat([1.0, 3.0, 10.0, 30.0], 120), np.arange(480.0)
    friction = np.where(speeds == 1, 0.4 + 0.2 * place / 120, 0.3) * (1 + 1e-3 * np.random.default_rng(3).normal(size=480))
    found = sb.bench.read(written(text_of(np.column_stack([place, speeds, friction]), "Time [s];Speed [mm/s];COF")))
    assert note_of(found, "of the step at 1 mm/s (rows 2 to 61), as the running mean still drifted")
    assert 0.1 / np.sqrt(12) < found.error[0] < 0.2 / np.sqrt(12)  # half of its drift is left
    assert (found.error[1:] < 0.3 * found.error[0]).all()


@pytest.mark.quick
def test_the_slope_of_friction_within_a_bin_is_no_scatter(written):
    speed = np.geomspace(1, 100, 400)
    rows = np.column_stack([np.arange(400.0), speed, 0.5 - 0.1 * np.log10(speed)])
    found = sb.bench.read(written(text_of(rows, "Time [s];Speed [mm/s];COF")), per_decade=3)
    assert found.friction == pytest.approx(0.5 - 0.1 * np.log10(1e3 * found.speed), abs=1e-4)
    assert len(found) == 6 and (found.half_width < 1e-3).all()


def test_a_slow_ramp_is_no_series_of_steps(written, subtests):
    for rate in (0.002, 0.005, 0.01):  # of the speed from row to row
        with subtests.test(rate=rate):
            speed = 0.1 * (1 + rate) ** np.arange(800)
            friction = curve(speed) * (1 + 0.01 * np.random.default_rng(2).normal(size=speed.size))
            found = sb.bench.read(written(series_of(speed, friction)))
            assert note_of(found, "The speed never rests") and not note_of(found, "Left out")
            assert_holds(found)


@pytest.mark.quick
def test_the_scatter_of_passes_is_the_error_where_it_is_more_than_that_within_them(written):
    rng = np.random.default_rng(8)

    def read(shifts, run_in="keep"):
        runs = [
            stepped(rng, 60, speeds=[1.0, 10.0, 100.0], ways=(1,), start=0, zero=0, drift=0, amplitude=0.002) for _ in shifts
        ]
        rows = np.vstack([run * [1, 1, 1, 1 + shift] for run, shift in zip(runs, shifts, strict=True)])
        rows[:, 0] = 0.1 * np.arange(len(rows))
        return sb.bench.read(written(text_of(rows)), sb.FitSettings(run_in=run_in))

    wide, *quiet = read([-0.1, 0.1, -0.08, 0.06, 0.0, 0.02]), *(read([0.0] * 6) for _ in range(4))
    assert note_of(wide, "Passes at the same speed differ by")
    assert not any(note_of(each, "Passes at the same speed") for each in quiet)
    narrow = quiet[0]
    after = read([0.3, 0.0, 0.0, 0.0], "leave")  # a first run that differs from those that agree is run-in
    assert note_of(after, "Left out as run-in") and np.sum(after.status == 4) > 80
    assert after.friction == pytest.approx(curve(np.array([1.0, 10.0, 100.0])), rel=0.01)
    assert (wide.half_width > 8 * narrow.half_width).all()


@pytest.mark.quick
def test_two_loads_tell_a_misaligned_load_from_a_zero_of_the_force(written):
    rng = np.random.default_rng(6)
    several = [
        stepped(rng, 60, speeds=SPEEDS[::3], start=0, zero=0.04, drift=0, load=load, amplitude=0.002) for load in (2, 6)
    ]
    rows = np.vstack(several)
    rows[:, 0] = 0.1 * np.arange(len(rows))
    rows[:, 3] += np.tan(np.radians(1.5)) * rows[:, 2]
    found = sb.bench.read(written(text_of(rows)))
    [sentence] = [each for each in found.notes if each.startswith("Both directions")]
    assert "misaligned by 1.5 ±" in sentence and "drifts" not in sentence
    assert float(re.search(r"off by ([\d.]+) mN", sentence)[1]) == pytest.approx(40, abs=1)
    one = sb.bench.read(written(text_of(several[0])))
    assert note_of(one, "two loads would tell") and not note_of(one, "it drifts")
    assert found.inputs == ({"load": 2.0}, {"load": 6.0})
    assert found.friction == pytest.approx(curve(1e3 * found.speed), rel=0.01)
    noisy = np.vstack([stepped(np.random.default_rng(load), 40, zero=0.03, drift=0, load=load) for load in (2, 8)])
    noisy[:, 0] = 0.1 * np.arange(len(noisy))
    noisy[:, 3] += 0.02 * noisy[:, 2]
    [sentence] = [each for each in sb.bench.read(written(text_of(noisy))).notes if each.startswith("Both directions")]
    assert "misaligned by 1." in sentence and "drifts" not in sentence  # which alone explains part of a misalignment


@pytest.mark.quick
def test_a_load_of_a_cylinder_is_per_length_and_the_curve_says_so(written, tmp_path):
    rows = stepped(np.random.default_rng(4), speeds=SPEEDS[::3], n=40)
    found = sb.bench.read(written(text_of(rows), "line.csv"), sb.FitSettings(files={"line.csv": {"load": "30 N/m"}}))
    assert found.inputs == ({"load": 2.0, "load_per_length": 30.0},)
    found.to_csv(tmp_path / "curve.csv")
    assert sb.read_measurements(tmp_path / "curve.csv").inputs == ({"load": 30.0},)


@pytest.mark.quick
def test_a_step_may_have_a_noisy_speed(written):
    set_speed = np.repeat([10.0, 100.0], 100)
    speed = set_speed * np.exp(0.15 * np.random.default_rng(17).normal(size=200))
    rows = np.column_stack([np.arange(200.0), speed, curve(set_speed)])
    found = sb.bench.read(written(text_of(rows, "Time [s];Speed [mm/s];COF")))
    assert (found.status == 0).all() and found.speed == pytest.approx([0.01, 0.1], rel=0.05)


@pytest.mark.quick
def test_the_force_tells_the_direction_where_the_speed_is_a_size_and_its_sign_does_not_matter(written):
    rows = stepped(np.random.default_rng(1), amplitude=0.005, drift=0)
    found = [sb.bench.read(written(text_of(rows * factors))) for factors in ([1, 1, 1, 1], [1, 1, 1, -1])]
    sizes = sb.bench.read(written(text_of(np.column_stack([rows[:, 0], np.abs(rows[:, 1]), rows[:, 2:]]))))
    for other in (found[1], sizes):
        assert other.friction == pytest.approx(found[0].friction, rel=1e-6)
        assert np.abs(other.difference) == pytest.approx(np.abs(found[0].difference), rel=1e-6)


def series_of(speed, friction):
    return text_of(np.column_stack([np.arange(len(speed)), speed, friction]), "Time [s];Speed [mm/s];COF")


@pytest.mark.quick
def test_passes_differ_by_more_than_noise_where_chance_does_so_less_than_once_in_twenty_files(written, subtests):
    """``UNLIKELY``: of 15 degrees of freedom 5 % exceed 1.67 times the variance that the file states."""
    speeds = np.tile([1.0, 3.0, 10.0, 30.0, 100.0], 4)
    sweeps = np.repeat([1, -1, 1, -1], 5)
    for ratio, is_more in ((1.62, False), (1.72, True)):
        with subtests.test(ratio=ratio):
            shift = 0.001 * np.sqrt(ratio * 15 / 20) * sweeps
            rows = np.column_stack([speeds, curve(speeds) + shift, np.full(20, 0.001)])
            found = sb.bench.read(written(text_of(rows, "Speed [mm/s];COF;COF error")), sb.FitSettings(run_in="keep"))
            assert note_of(found, "Passes at the same speed differ by") is is_more
            assert len(found) == 5 and found.error[0] > 0


@pytest.mark.quick
def test_a_start_is_left_out_from_three_standard_errors_on(written, subtests):
    """``CLEAR``: of rows that alternate by 1 %, the mean of four is known to 0.51 % beside that of 96."""
    speed, alternating = np.repeat([10.0, 100.0], 100), 0.01 * (-1.0) ** np.arange(200)
    for share, is_start in ((1.3, False), (1.8, True)):
        with subtests.test(share=share):
            start = np.where(np.arange(200) < 4, 0.01 * share, 0.0)
            found = sb.bench.read(written(series_of(speed, curve(speed) * (1 + alternating + start))))
            assert (found.status[:10] == 3).any() == is_start and (found.status[10:] == 0).all()


@pytest.mark.quick
def test_the_speed_of_a_point_is_the_mean_of_its_rows(written):
    speed = np.concatenate([np.full(60, 10.0), np.full(60, 100.0), np.full(180, 10.08), np.full(60, 100.0)])
    found = sb.bench.read(written(series_of(speed, curve(speed))))
    assert found.speed == pytest.approx([0.01 * 1.008**0.75, 0.1], rel=1e-4)


@pytest.mark.quick
def test_a_drive_may_wander_by_two_per_cent_within_a_step(written, subtests):
    """``LARGEST_NOISE``."""
    for ratio, points in ((1.015, 2), (1.025, 3)):
        with subtests.test(ratio=ratio):
            speed = np.concatenate([np.full(60, 10.0), np.full(60, 10.0 * ratio), np.full(120, 100.0)])
            assert len(sb.bench.read(written(series_of(speed, curve(speed))))) == points


@pytest.mark.quick
def test_a_force_zero_beyond_the_friction_leaves_repeats_readable(written):
    """One way the measured friction is below zero then, of which no logarithm tells run-in."""
    rows = stepped(np.random.default_rng(5), 40, speeds=np.tile([10.0, 100.0, 300.0], 3), zero=0.4, drift=0, amplitude=0.005)
    found = sb.bench.read(written(text_of(rows)))
    assert (found.difference > 2 * found.friction)[1:].all()
    assert_holds(found)


@pytest.mark.quick
def test_strokes_of_one_speed_are_those_of_their_load(written):
    way = np.tile(np.repeat([1.0, -1.0], 20), 20)
    load = np.repeat([2.0, 6.0], 400)
    force = way * load * np.where(load == 2, 0.3, 0.2) * (1 + 0.01 * np.random.default_rng(1).normal(size=800))
    found = sb.bench.read(written(text_of(np.column_stack([np.arange(800), 10 * way, load, force]))))
    assert found.inputs == ({"load": 2.0}, {"load": 6.0})
    assert found.friction == pytest.approx([0.3, 0.2], rel=0.01) and found.rows.tolist() == [400, 400]
