"""The command: what it prints and writes, its exit codes, and that Ctrl-C loses nothing."""

import json
import os
import pty
import re
import select
import shlex
import signal
import subprocess
import sys
import time
from contextlib import suppress
from importlib.metadata import version

import numpy as np
import pytest
import xarray as xr
from command_line import (
    EXAMPLES,
    FEW,
    HEAVY,
    PDMS,
    SCRIPT,
    call,
    call_outside,
    case_text,
    environment,
)
from matplotlib.figure import Figure

import stribeck as sb
from stribeck import Outcome

GROUPS = ("--groups", "1e-4", "0.1", "1e-3")
FAST = ("--groups", "0.1", "1e-3", "--range", "0.1", "1", "--points", "3")


def strict_json(text):
    """Parse JSON as other languages do, without nan and infinity."""

    def refuse(name):
        raise AssertionError(f"{name} is no JSON")

    return json.loads(text, parse_constant=refuse)


def opened(path):
    with xr.open_dataset(path, engine="netcdf4") as found:
        return found.load()


# --- solve ---


@pytest.mark.quick
def test_parts_of_the_model_are_options_too(capsys, tmp_path):
    options = ("--slide-to-roll", "-1", "--cavitation", "reform", "--cavity-pressure", "-0.01", "--rtol", "1e-4", "--json")
    answer = call(capsys, "solve", *GROUPS, *options)
    found = strict_json(answer.out)
    groups = sb.Groups(1e-4, 0.1, 1e-3)
    state = sb.solve(groups, slide_to_roll=-1.0, cavitation="reform", cavity_pressure=-0.01, rtol=1e-4)
    assert answer.code == 0
    assert found["minimum_gap"] == state.minimum_gap
    assert found["friction_balanced_fluid"] == state.friction().fluid < 0
    files = ("-o", tmp_path / "curve.nc", "--plot", tmp_path / "curve.png")
    answer = call(capsys, "curve", *FAST, "--slide-to-roll", "0.5", "--definition", "published", "--json", *files)
    curve = sb.stribeck_curve(sb.Groups(0.1, 0.1, 1e-3), speed=(0.1, 1), points=3, slide_to_roll=0.5, definition="published")
    found = strict_json(answer.out)["points"]
    assert found["friction"] == pytest.approx(list(curve.friction))
    assert found["hydrodynamic_friction"] == [None] * 3
    assert opened(tmp_path / "curve.nc").friction.values == pytest.approx(list(curve.friction))


@pytest.mark.quick
def test_impossible_parts_of_the_model_are_refused(capsys):
    for option, value, said in [
        ("--cavitation", "swift", "cavitation = 'swift' must be 'none', 'exit'"),
        ("--cavity-pressure", "-1", "needs cavitation = 'reform'"),
        ("--flow-factors", "patir", "flow_factors = 'patir'"),
    ]:
        answer = call(capsys, "solve", *GROUPS, option, value)
        assert (answer.code, answer.out) == (2, "") and said in answer.err


@pytest.mark.quick
def test_solve_prints_the_dictionary_of_the_solution_as_json_without_nan_and_infinity(subtests, capsys):
    for groups, missing in [((1e-4, 0.1, 1e-3), None), ((0.1, 0.1, 0), "lambda_ratio"), ((0, 5, 1e-3), "flux_gap")]:
        with subtests.test(groups=groups):
            answer = call(capsys, "solve", "--groups", *groups, "--json")
            assert (answer.code, answer.err) == (0, "")
            found, expected = strict_json(answer.out), sb.solve(sb.Groups(*groups)).to_dict()
            assert found == expected
            assert {name for name in ("lambda_ratio", "flux_gap") if found[name] is None} == ({missing} - {None})


def test_the_json_of_a_state_has_exactly_these_keys(capsys):
    found = strict_json(call(capsys, "solve", PDMS, "--json").out)
    table = sb.solve(sb.load_case(PDMS).contact).to_dataset()
    numbers = {name for name in table.data_vars if not table[name].dims}
    others = ("applies checks definition geometry contact_law contact_law_parameters model inputs units speed_group "
              "load_group roughness_group rtol nodes outcome message notes")  # fmt: skip
    assert set(found) == {*others.split(), *numbers}
    for name in ("friction_balanced", "friction_published", "minimum_film_thickness", "lambda_ratio"):
        assert 0 < found[f"{name}_error"] < 1e-5 * found[name]
    assert found["units"].keys() == {*found["inputs"], *(name for name in numbers - {"regime"} if not name.endswith("_error"))}
    assert found["inputs"]["radius"] == 0.01
    assert found["central_film_thickness"] == pytest.approx(found["central_gap"] * found["hertz_indentation"], rel=1e-14)
    assert (found["units"]["central_film_thickness"], found["units"]["load"]) == ("m", "N/m")


@pytest.mark.quick
def test_coefficients_given_with_groups_scale_friction_and_hersey_number_and_are_said(capsys):
    coefficients = ("--boundary-friction", "0.5", "--beta", "0.1")
    assert "boundary_friction = 1 and beta = 1:" in call(capsys, "solve", *GROUPS).out
    assert "boundary_friction = 0.5 and beta = 0.1:" in call(capsys, "solve", *GROUPS, *coefficients).out
    plain = strict_json(call(capsys, "solve", *GROUPS, "--json").out)
    scaled = strict_json(call(capsys, "solve", *GROUPS, *coefficients, "--json").out)
    assert scaled["friction_asperities"] == pytest.approx(0.5 * plain["friction_asperities"], rel=1e-14)
    for fluid in ("friction_published_fluid", "friction_balanced_fluid"):
        assert scaled[fluid] == pytest.approx(0.1 * plain[fluid], rel=1e-14)
    assert scaled["hersey_number"] == pytest.approx(0.01 * plain["hersey_number"], rel=1e-14)


def test_friction_on_the_other_body_and_losses_of_a_body_that_remembers_stand_apart(capsys, tmp_path):
    path = tmp_path / "case.toml"
    path.write_text(case_text({"slide_to_roll": "0.5"}, solid={"retardation_time": '"10 ms"', "modulus_ratio": "5"}))
    solution = sb.solve(sb.load_case(path).contact)
    lost = solution.hysteresis_friction * solution.contact.hertz.half_width / solution.contact.radius
    rows = {line[:36].strip(): line[36:].split() for line in call(capsys, "solve", path, "-v").out.splitlines()}
    told = solution.to_dict()
    assert float(rows["friction on the cylinder"][0]) == pytest.approx(told["friction_upper"], rel=1e-3)
    assert float(rows["hysteresis friction, apart"][0]) == pytest.approx(lost, rel=1e-3)
    assert told["friction_upper"] == solution.friction().upper
    assert told["friction_hysteresis"] == pytest.approx(lost, rel=1e-14)
    assert solution.to_dict(beta=0.12)["friction_hysteresis"] == pytest.approx(2 * lost, rel=1e-14)  # the contact has 0.06
    assert not re.search("on the cylinder|hysteresis", call(capsys, "solve", PDMS, "-v").out)


def test_solve_prints_values_with_units_errors_and_outcome_draws_and_notes_where_there_is_something(capsys, tmp_path):
    answer = call(capsys, "solve", PDMS, "-v", "--plot", tmp_path / "profile.svg")
    solution = sb.solve(sb.load_case(PDMS).contact)
    assert answer.code == 0 and "…" not in answer.out  # nothing is cut off
    assert answer.out.startswith("PDMS cylinder in glycerol-water\n")
    assert "modulus 2.7 MPa" in answer.out and f"Written: {tmp_path / 'profile.svg'}\n" in answer.out
    assert b"<svg" in (tmp_path / "profile.svg").read_bytes()
    row = next(line for line in answer.out.splitlines() if line.startswith(" central film"))
    film, error = re.fullmatch(r" central film +([0-9.]+) nm +± ([0-9.]+) pm", row).groups()
    # Four digits: the model is good to per cent, and files and JSON have them all.
    assert float(error) * 1e-12 == pytest.approx(solution.errors["central_gap"] * solution.central_film_thickness, rel=5e-2)
    assert float(film) * 1e-9 == pytest.approx(float(solution.to_si([0.0]).gap[0]), rel=5e-4)
    assert "Converged. Largest estimated relative error:" in answer.out
    assert not solution.notes and "Note:" not in answer.out
    other = tmp_path / "other.toml"
    other.write_text(case_text({"speed": '"20 mm/s"'}))
    [note] = sb.solve(sb.load_case(other).contact).notes
    assert f"Note: {note}\n" in call(capsys, "solve", other, "-v").out
    other.write_text(case_text({"speed": '"0 m/s"'}))  # whose film is symmetric
    assert re.search(r"position of minimum film +0 m ", call(capsys, "solve", other, "-v").out)


# --- curve ---


@pytest.mark.quick
def test_curve_writes_what_it_was_asked_for_and_says_so(capsys, tmp_path):
    files = [tmp_path / name for name in ("curve.nc", "curve.csv", "curve.png")]
    answer = call(capsys, "curve", PDMS, *FEW, "-o", files[0], "--output", files[1], "--plot", files[2])
    assert (answer.code, answer.err) == (0, "")
    for path in files:
        assert f"Written: {path}\n" in answer.out
        assert path.stat().st_size > 1000
    curve = sb.stribeck_curve(sb.load_case(PDMS).contact, speed=("0.3 mm/s", "0.1 m/s"), points=6)
    found = opened(files[0])
    np.testing.assert_allclose(found.friction, curve.friction, rtol=1e-12)
    assert found.attrs["title"] == "PDMS cylinder in glycerol-water"
    assert sorted(os.listdir(tmp_path)) == ["curve.csv", "curve.nc", "curve.png"]


def test_curve_prints_inputs_regimes_minimum_error_and_notes(capsys):
    out = call(capsys, "curve", PDMS, *FEW, "-v").out
    assert "6 points, speed 300 µm/s to 100 mm/s." in out and "Note: The central gap is" in out
    assert re.search(r"boundary +300 µm/s +368 µm/s\n +mixed +368 µm/s +30.5 mm/s", out)
    assert re.search(r"minimum of friction +27\.6 mm/s +0\.03469", out) and "Largest estimated relative error" in out


def test_the_settings_of_the_case_hold_and_options_override_them(capsys, tmp_path):
    case = tmp_path / "case.toml"
    curve = {"over": '"load"', "range": '["10 N/m", "40 N/m"]', "points": "3"}
    case.write_text(case_text(curve=curve, solver={"rtol": "1e-4", "definition": '"balanced"'}))
    assert strict_json(call(capsys, "solve", case, "--json").out)["rtol"] == 1e-4
    assert strict_json(call(capsys, "solve", case, "--rtol", "1e-5", "--json").out)["rtol"] == 1e-5
    assert strict_json(call(capsys, "solve", *GROUPS, "--json").out)["rtol"] == sb.Case.rtol
    found = strict_json(call(capsys, "curve", case, "--json").out)
    assert (found["over"], found["unit"], found["definition"], found["rtol"]) == ("load", "N/m", "balanced", 1e-4)
    assert found["points"]["value"] == pytest.approx([10, 20, 40])
    options = ("--points", "2", "--rtol", "1e-5", "--range", "15", "0.03 N/mm")
    found = strict_json(call(capsys, "curve", case, *options, "--json").out)
    assert found["points"]["value"] == pytest.approx([15, 30]) and found["rtol"] == 1e-5
    # Another coordinate does not take over the range of the first.
    found = strict_json(call(capsys, "curve", case, "--over", "speed", "--points", "2", "--json").out)
    assert found["over"] == "speed" and found["points"]["value"][0] < 1e-4 < 0.1 < found["points"]["value"][1]


def test_the_json_of_a_curve_holds_its_points_and_landmarks(capsys, tmp_path):
    found = strict_json(call(capsys, "curve", PDMS, *FEW, "--json", "-o", tmp_path / "curve.csv").out)
    keys = ("applies checks title geometry over unit definition rtol boundary_friction beta inputs units minimum transitions "
            "regimes points requested_points complete error_estimate outcome message notes files contact_law "
            "contact_law_parameters model")  # fmt: skip
    assert set(found) == set(keys.split())
    table = sb.stribeck_curve(sb.load_case(PDMS).contact, speed=(3e-4, 0.1), points=6).to_dataset()
    assert set(found["points"]) == {*table.data_vars, "value"}
    assert found["points"]["minimum_film_thickness"] == pytest.approx(table.minimum_film_thickness.values, rel=1e-9)
    assert {len(values) for values in found["points"].values()} == {6}
    assert found["minimum"]["value"] == pytest.approx(0.0276042, rel=1e-5)
    assert [mark["name"] for mark in found["transitions"]][0] == "fluid carries 5 % of the load"
    assert [part["regime"] for part in found["regimes"]] == ["boundary", "mixed", "hydrodynamic"]
    assert found["complete"] is True
    assert found["files"] == [str(tmp_path / "curve.csv")]


def test_a_curve_of_groups_takes_the_two_that_stay_fixed_and_finds_a_range_of_speeds(subtests, capsys):
    for over, fixed, ends, constant in [
        ("speed", ("0.1", "1e-3"), ("1e-3", "1"), {"load_group": 0.1, "roughness_group": 1e-3}),
        ("load", ("1e-3", "1e-3"), ("0.01", "0.1"), {"speed_group": 1e-3, "roughness_group": 1e-3}),
        ("roughness", ("1e-3", "0.1"), ("1e-4", "1e-3"), {"speed_group": 1e-3, "load_group": 0.1}),
    ]:
        with subtests.test(over=over):
            tokens = ("--over", over, "--range", *ends, "--points", "2", "--boundary-friction", "0.5", "--json")
            found = strict_json(call(capsys, "curve", "--groups", *fixed, *tokens).out)
            assert found["points"]["value"] == pytest.approx([float(end) for end in ends])
            assert found["boundary_friction"] == 0.5
            for name, value in constant.items():
                assert found["points"][name] == pytest.approx([value, value])
    points = strict_json(call(capsys, "curve", "--groups", "0.1", "1e-3", "--points", "3", "--json").out)["points"]
    assert points["value"][0] < 1e-5 and points["fluid_load_share"][0] < 1e-5 and points["value"][-1] > 1e-2


def test_where_the_law_is_beyond_its_range_every_output_says_so(capsys, tmp_path):
    sentence = "The load group is 1.59, not below 1: the exponential contact law is outside its range"
    curve = ("curve", HEAVY, "--range", "1 m/s", "2 m/s", "--points", "2", "--rtol", "1e-2")
    files = ("-o", tmp_path / "curve.nc", "-o", tmp_path / "curve.csv", "--plot", tmp_path / "curve.svg")
    for tokens in (("solve", HEAVY), ("solve", HEAVY, "--json"), (*curve, *files), (*curve, "--json")):
        assert sentence in call(capsys, *tokens).out, tokens
    regimes = call(capsys, "regimes", HEAVY).out
    assert sentence in regimes and "Persson's law, from a table [surface], covers that range." in regimes
    assert sentence in opened(tmp_path / "curve.nc").attrs["notes"]
    assert sentence in (tmp_path / "curve.csv").read_text()
    assert b"outside its range" in (tmp_path / "curve.svg").read_bytes()


def test_a_failure_to_write_one_file_does_not_lose_the_other(capsys, tmp_path, monkeypatch):
    def fail(*arguments, **options):
        raise sb.InputError("curve.nc could not be written (No space left on device); it is unchanged.")

    monkeypatch.setattr("stribeck.files.datasets.write_netcdf", fail)
    answer = call(capsys, "curve", *FAST, "-o", tmp_path / "curve.nc", "-o", tmp_path / "curve.csv")
    assert answer.code == 2
    assert answer.err == "stribeck: curve.nc could not be written (No space left on device); it is unchanged.\n"
    assert os.listdir(tmp_path) == ["curve.csv"]


# --- regimes ---


def test_regimes_tells_the_regime_the_transitions_and_what_moves_friction_also_in_a_narrow_terminal(capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "60")
    answer = call(capsys, "regimes", PDMS, "-v")
    assert (answer.code, answer.err) == (0, "") and "…" not in answer.out
    assert (
        "Mixed lubrication at 1 mm/s: friction 0.5607 (99.5 % from asperities); the fluid carries 20.3 % of the load."
        in answer.out
    )
    for row in (
        r"transition +speed +change +friction, balanced",
        r"fluid carries 5 % of the load +367\.9 µm/s +2\.72x slower",
        r"fluid carries 50 % of the load +2\.795 mm/s +2\.79x faster",
        r"minimum of friction +27\.6 mm/s +27\.6x faster +0\.03469",
        r"roughness +1 µm +\+0\.529 +\+5\.2 % friction",
        r"Strongest lever: dry friction coefficient; 10 % less lowers friction by 10 %\.",
    ):
        assert re.search(row, answer.out), row


def test_a_load_that_lowers_the_coefficient_is_said_to_raise_the_force(tmp_path, capsys):
    fast = tmp_path / "fast.toml"
    fast.write_text(case_text({"speed": '"1 m/s"'}))
    said = call(capsys, "regimes", str(fast)).out
    lever = r"load; 10 % more lowers friction by 7\.\d+ % \(the coefficient; the force changes by \+1\.7 %\)\."
    assert re.search(lever, said)


def test_regimes_as_json_gives_transitions_as_factors_of_the_speed(capsys):
    found = strict_json(call(capsys, "regimes", PDMS, "--json").out)
    assert (found["regime"], found["inputs"]["speed"], found["units"]["speed"]) == ("mixed", 0.001, "m/s")
    factors = [mark["factor"] for mark in found["transitions"]]
    assert len(factors) == 4 and factors == pytest.approx([mark["value"] / 0.001 for mark in found["transitions"]])
    assert set(found["sensitivities"]) == {*sb.LineContact.INPUTS.names}
    assert found["moves_friction_most"] == "boundary_friction"
    state = strict_json(call(capsys, "solve", PDMS, "--json").out)
    assert {name for name in state if found[name] != state[name]} <= {"checks", "notes"}  # those of the curve come with them


# --- exit codes and errors ---


def raising(error):
    def solve(*arguments, **options):
        raise error

    return solve


def failing(outcome):
    return raising(sb.SolveError(outcome, None, f"speed 1, load 1, roughness 1: {outcome.value}"))


def test_a_solve_that_fails_exits_with_1_and_its_outcome(capsys, tmp_path, monkeypatch):
    monkeypatch.setattr(sb, "solve", failing(Outcome.STEP_LIMIT))
    monkeypatch.setattr(sb, "stribeck_curve", failing(Outcome.PATH_LOST))
    answer = call(capsys, "solve", *GROUPS)
    assert (answer.code, answer.err) == (1, f"stribeck: speed 1, load 1, roughness 1: {Outcome.STEP_LIMIT.value}\n")
    answer = call(capsys, "curve", *FAST, "-o", tmp_path / "curve.nc")
    assert answer.code == 1 and Outcome.PATH_LOST.value in answer.err and os.listdir(tmp_path) == []


def ending_in(monkeypatch, outcome):
    """Let curves end with an outcome, after three of nine points."""
    whole = sb.stribeck_curve

    def ended(*arguments, **options):
        curve = whole(*arguments, **options)
        monkeypatch.setattr(type(curve), "outcome", property(lambda self: outcome))
        object.__setattr__(curve, "requested", 9)
        return curve

    monkeypatch.setattr(sb, "stribeck_curve", ended)


def test_a_curve_whose_path_is_lost_keeps_its_points_and_one_that_rounding_ends_is_refused(capsys, tmp_path, monkeypatch):
    with monkeypatch.context() as patch:
        ending_in(patch, Outcome.PATH_LOST)
        answer = call(capsys, "curve", *FAST, "-o", tmp_path / "lost.nc")
    assert (answer.code, answer.err) == (1, f"stribeck: 3 of 9 points: {Outcome.PATH_LOST.value}\n")
    assert opened(tmp_path / "lost.nc").attrs["complete"] == 0
    ending_in(monkeypatch, Outcome.ROUNDING)
    answer = call(capsys, "curve", PDMS, *FEW, "-o", tmp_path / "curve.nc")
    assert (answer.code, answer.out) == (2, "")
    said = r"stribeck: rtol = 1e-06 cannot be reached: .* speed is below 300 µm/s .*ask for a larger rtol\.\n"
    assert re.fullmatch(said, answer.err)
    assert os.listdir(tmp_path) == ["lost.nc"]


def test_a_tolerance_that_rounding_forbids_is_refused_with_that_sentence(capsys, tmp_path):
    # Known only after the solve, so that this one is not stopped before it.
    answer = call(capsys, "solve", "--groups", "1e-12", "1", "0", "--rtol", "1e-9", "--plot", tmp_path / "new.png")
    assert (answer.code, answer.out, answer.err.count("\n")) == (2, "", 1)
    assert re.search(r"rtol = 1e-09 cannot be reached at .*Double precision keeps the error", answer.err)
    assert os.listdir(tmp_path) == []


@pytest.mark.quick
def test_an_unexpected_error_is_one_sentence_unless_debugging(capsys, monkeypatch):
    monkeypatch.delenv("STRIBECK_DEBUG", raising=False)
    for error, said in [
        (MemoryError(), r"Out of memory; .*\."),
        (ZeroDivisionError("division\nby zero"), r".*\(ZeroDivisionError: division by zero\.\) .*STRIBECK_DEBUG=1.*"),
    ]:
        monkeypatch.setattr(sb, "solve", raising(error))
        answer = call(capsys, "solve", *GROUPS)
        assert answer.code == 1 and re.fullmatch(f"stribeck: {said}\n", answer.err)
    monkeypatch.setenv("STRIBECK_DEBUG", "1")
    with pytest.raises(ZeroDivisionError):
        call(capsys, "solve", *GROUPS)


def test_a_missing_extra_is_told_before_anything_is_solved(capsys, tmp_path, monkeypatch):
    monkeypatch.setattr(sb, "stribeck_curve", failing(Outcome.STEP_LIMIT))
    for library, *file in (("xarray", "-o", "curve.nc"), ("netCDF4", "-o", "curve.nc"), ("matplotlib", "--plot", "curve.png")):
        monkeypatch.setattr("importlib.util.find_spec", lambda name, missing=library: None if name == missing else True)
        answer = call(capsys, "curve", *FAST, file[0], tmp_path / file[1])
        assert answer.code == 2
        assert f"needs {library}; install it with: pip install 'stribeck[" in answer.err


def test_a_reader_that_has_gone_causes_no_traceback():
    ours, theirs = os.pipe()
    os.close(ours)
    command = (sys.executable, "-m", "stribeck", "--version")
    run = subprocess.run(command, stdout=theirs, stderr=subprocess.PIPE, env=environment(), timeout=60)
    os.close(theirs)
    assert (run.returncode, run.stderr) == (141, b"")  # 1 would say that the solve failed


def test_a_terminal_without_greek_and_micro_is_served(tmp_path):
    answer = call_outside("solve", PDMS, "-v", PYTHONIOENCODING="ascii")
    assert answer.code == 0
    assert "roughness 1 ?m" in answer.out
    assert answer.err == ""


# --- help ---


def test_every_help_has_an_example_that_runs(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "examples").symlink_to(EXAMPLES)
    monkeypatch.setenv("COLUMNS", "300")
    said = call(capsys, "--help").out
    commands = re.findall(r"^│ (\w+)  ", said, re.MULTILINE)
    assert "Example: stribeck" in said and len(commands) == 19
    examples = {name: re.findall(r"Example: stribeck (.+)", call(capsys, name, "--help").out) for name in commands}
    assert all(example.startswith(name) for name, listed in examples.items() for example in listed) and all(examples.values())
    for command, options in {"solve": [], "curve": ["--points", "3"]}.items():
        answer = call(capsys, *shlex.split(examples[command][0]), *options)
        assert (answer.code, answer.err) == (0, "")


@pytest.mark.quick
def test_the_version_is_that_of_the_package_and_without_arguments_the_help_is_shown(capsys):
    assert call(capsys, "--version").out == f"{version('stribeck')}\n"
    answer = call(capsys)
    assert answer.code == 0 and "Usage: stribeck COMMAND" in answer.out and "Example: stribeck" in answer.out


@pytest.mark.quick
def test_shell_completion_can_be_installed(tmp_path):
    home = {"HOME": str(tmp_path), "SHELL": "/bin/bash", "XDG_DATA_HOME": str(tmp_path / "share")}
    answer = call_outside("--install-completion", "--shell", "bash", **home)
    assert answer.code == 0, answer.err
    scripts = [path for path in tmp_path.rglob("*") if path.is_file() and "stribeck" in path.name]
    assert scripts and "regimes" in scripts[0].read_text()


# --- Ctrl-C and progress ---


def start(*tokens, **pipes):
    """Start the command as a shell's foreground job, in which Ctrl-C is not ignored."""

    def heed():
        signal.signal(signal.SIGINT, signal.default_int_handler)

    return subprocess.Popen([SCRIPT, *map(str, tokens)], env=environment(TERM="xterm"), preexec_fn=heed, **pipes)


def read_until(terminal, pattern, seconds=60):
    """Read what a terminal shows until a pattern appears."""
    shown, end = "", time.monotonic() + seconds
    while not re.search(pattern, shown):
        assert time.monotonic() < end, shown
        if select.select([terminal], [], [], 0.2)[0]:
            shown += os.read(terminal, 10_000).decode(errors="replace")
    return shown


def interrupted(pattern, times, *arguments):
    """Run a command on a terminal and press Ctrl-C when a pattern appears; return what it showed and printed."""
    ours, theirs = pty.openpty()
    process = start("curve", *arguments, stdout=subprocess.PIPE, stderr=theirs, stdin=subprocess.DEVNULL, text=True)
    os.close(theirs)
    try:
        shown = read_until(ours, pattern)
        for _ in range(times):
            process.send_signal(signal.SIGINT)
            time.sleep(0.05)
        shown += read_until(ours, r"marked as incomplete\.\r\n")
        out = process.communicate(timeout=60)[0]
    finally:
        process.kill()
        os.close(ours)
    assert process.returncode == 130 and "Traceback" not in shown
    return shown, out


def test_ctrl_c_keeps_the_finished_points_marked_incomplete(tmp_path):
    files = [tmp_path / "curve.nc", tmp_path / "curve.csv"]
    many = ("--points", "400", "--cavitation", "exit", "--rtol", "1e-8")
    shown, out = interrupted(r"[1-9]\d+/400", 1, PDMS, *many, "-o", files[0], "-o", files[1])
    found = opened(files[0])
    points = found.sizes["speed"]
    assert 1 < points < 400
    assert f"Interrupted after {points} of 400 points" in shown
    assert (found.attrs["complete"], found.attrs["requested_points"]) == (0, 400)
    assert np.isfinite(found.friction).all()
    assert f"\n# points: {points}\n" in files[1].read_text()
    assert f"{points} points, speed" in out
    assert sorted(os.listdir(tmp_path)) == ["curve.csv", "curve.nc"]


@pytest.mark.slow
def test_a_second_ctrl_c_throws_no_point_of_a_ball_away(tmp_path):
    file = tmp_path / "curve.csv"
    few = ("--points", "41", "--rtol", "1e-3", "-o", file)
    shown, _ = interrupted(r"[1-9]\d*/41", 3, EXAMPLES / "pdms_ball.toml", *few)
    assert re.search(r"Interrupted after \d+ of 41 points", shown)
    assert "\n# complete: 0\n" in file.read_text()


@pytest.fixture
def interrupts():
    """Return a function that sets the handler of Ctrl-C for a test."""
    before = signal.getsignal(signal.SIGINT)
    yield lambda handler: signal.signal(signal.SIGINT, handler)
    signal.signal(signal.SIGINT, before)


def test_a_limit_of_time_keeps_the_finished_points_also_in_a_background_job_that_ignores_ctrl_c(capsys, tmp_path, interrupts):
    interrupts(signal.SIG_IGN)
    file = tmp_path / "curve.csv"
    many = "--points", "400", "--rtol", "1e-8", "--cavitation", "exit"
    answer = call(capsys, "curve", PDMS, *many, "--time-limit", "0.5 s", "-o", file)
    if answer.code == 130:
        assert "Stopped by --time-limit after" in answer.err and file.exists()
    else:  # on a machine too busy for a first point
        assert answer.code == 2 and "before the first point" in answer.err and not file.exists()
    for wrong in ("0", "1 m", "nan"):
        refused = call(capsys, "curve", PDMS, "--time-limit", wrong)
        assert refused.code == 2 and "--time-limit" in refused.err


@pytest.mark.parametrize(("name", "ignored"), [("stribeck_curve", ()), ("load_case", KeyboardInterrupt)])
def test_ctrl_c_before_the_first_point_writes_nothing(name, ignored, capsys, tmp_path, monkeypatch, interrupts):
    """Python ignores it in a callback of a weak reference, as of the locks of modules."""
    interrupts(signal.default_int_handler)
    whole = getattr(sb, name)

    def pressed(*arguments, **options):
        with suppress(ignored):
            signal.raise_signal(signal.SIGINT)
        return whole(*arguments, **options)

    monkeypatch.setattr(sb, name, pressed)
    answer = call(capsys, "curve", PDMS, "-o", tmp_path / "curve.nc")
    assert answer.code == 130
    assert answer.err == "stribeck: Interrupted; nothing was written.\n"
    assert answer.out == ""
    assert os.listdir(tmp_path) == []


def test_ctrl_c_while_the_first_of_two_files_is_written_leaves_no_half_of_the_results(
    capsys, tmp_path, monkeypatch, interrupts
):
    interrupts(signal.default_int_handler)
    save, picture, table = Figure.savefig, tmp_path / "surface.png", tmp_path / "surface.toml"

    def interrupted(figure, *args, **kwargs):
        save(figure, *args, **kwargs)
        signal.raise_signal(signal.SIGINT)

    monkeypatch.setattr(Figure, "savefig", interrupted)
    answer = call(capsys, "surface", EXAMPLES / "cylinder_profile.csv", "--plot", picture, "--out", table)
    assert answer.code == 0 and f"Written: {picture}" in answer.out and picture.exists() and table.exists()


def test_the_handler_of_ctrl_c_is_put_back_and_a_shell_that_ignores_it_respected(capsys, interrupts):
    for handler in [signal.default_int_handler, signal.SIG_IGN]:
        interrupts(handler)
        assert call(capsys, "curve", *FAST).code == 0
        assert signal.getsignal(signal.SIGINT) is handler


def test_progress_is_shown_on_a_terminal_only(capsys):
    assert call(capsys, "curve", *FAST).err == ""
    ours, theirs = pty.openpty()
    process = start("curve", *FAST, stdout=subprocess.DEVNULL, stderr=theirs)
    os.close(theirs)
    try:
        assert "solving" in read_until(ours, r"3/3")
        process.wait(timeout=60)
    finally:
        process.kill()
        os.close(ours)
    assert process.returncode == 0
