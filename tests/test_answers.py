"""What `solve`, `regimes` and `curve` print first fits a screen: verdict, sentence, main numbers; `-v` has the rest."""

import math
import re

import numpy as np
import pytest
from command_line import EXAMPLES, HEAVY, SWEEP, call, case_text

import stribeck as sb

LINES, COLUMNS = 25, 80

CASES = sorted({*EXAMPLES.glob("*.toml"), HEAVY} - {SWEEP})

FAST = ("pdms_cylinder",)  # The states, regimes and curves of the others take minutes together


def unless(path, *names):
    """Return the mark of a slow test, none for cases of these names."""
    return [pytest.mark.slow] * (path.stem not in names)


def height(text):
    """Return how many lines of a terminal a text takes."""
    return sum(max(1, math.ceil(len(line) / COLUMNS)) for line in text.splitlines())


SOLVED = [pytest.param(path, marks=unless(path, *FAST, "heavy", "pdms_ball", "wiper_blade")) for path in CASES]


@pytest.mark.parametrize("path", SOLVED)
def test_the_answer_of_a_state_fits_a_screen(capsys, monkeypatch, path):
    monkeypatch.setattr("stribeck.cli.progress.LINE_INTERVAL", math.inf)  # on a slow machine too
    solve, states = sb.solve, []
    monkeypatch.setattr(sb, "solve", lambda *given, **options: states.append(solve(*given, **options)) or states[-1])
    answer = call(capsys, "solve", path)
    first, *_, last = answer.out.splitlines()
    assert (answer.code, answer.err) == (0, "")
    assert height(answer.out) <= LINES, answer.out
    assert re.match("The model applies|Outside the range of the model", first)
    assert re.search(r"^(Boundary|Mixed|Hydrodynamic) lubrication at .*: friction .* The minimum film is ", answer.out, re.M)
    assert last.startswith("-v shows ")
    [state] = states
    files, units = state.to_dict(), sb.load_case(EXAMPLES / "pdms_cylinder.toml").contact
    for label, name in (("central film", "central_film_thickness"), ("minimum film", "minimum_film_thickness")):
        film, stated = files[name], files[f"{name}_error"]
        [shown, error] = re.findall(rf"^ {label} +(\S+ \S+m) +± (\S+ \S+m)$", answer.out, re.M)[0]
        assert units.replace(radius=shown).radius == pytest.approx(film, rel=1e-2)
        assert units.replace(radius=error).radius == pytest.approx(stated, rel=0.06)  # two digits
        assert stated < 0.2 * film


COMMANDS = [
    pytest.param(command, path, id=f"{command}-{path.stem}", marks=unless(path, *FAST))
    for command in ("regimes", "curve")
    for path in CASES
]


@pytest.mark.parametrize(("command", "path"), COMMANDS)
def test_the_answer_of_a_command_fits_a_screen(capsys, monkeypatch, command, path):
    monkeypatch.setattr("stribeck.cli.progress.LINE_INTERVAL", math.inf)  # on a slow machine too
    answer = call(capsys, command, path)
    assert (answer.code, answer.err) == (0, "")
    assert height(answer.out) <= LINES, answer.out
    assert answer.out.splitlines()[-1].startswith("-v shows ")


def test_a_note_that_repeats_a_doubt_is_not_said_twice(capsys, tmp_path):
    path = tmp_path / "case.toml"
    path.write_text(case_text({"speed": '"20 mm/s"', "alpha": "2.8"}))
    doubted = [line for line in call(capsys, "solve", path).out.splitlines() if "the central gap is" in line.lower()]
    assert len(doubted) == 1 and doubted[0].startswith("Doubtful: ")


# --- progress without a terminal ---


@pytest.mark.slow
def test_a_fit_and_a_comparison_say_how_far_they_are(capsys, monkeypatch, tmp_path):
    monkeypatch.setattr("stribeck.cli.progress.LINE_INTERVAL", 0.0)
    data, case = tmp_path / "data.csv", tmp_path / "case.toml"
    case.write_text(case_text({}, fit={"free": '["boundary_friction"]'}))
    data.write_text("speed (mm/s),friction\n0.1,0.6\n0.3,0.55\n1,0.5\n3,0.4\n10,0.2\n")
    for command, last in (("fit", "intervals"), ("compare", r"greenwood-tripp: \w+")):
        answer = call(capsys, command, data, case)
        lines = [line for line in answer.err.splitlines() if line.startswith("stribeck: ")]
        form = r"stribeck: (?:.*: )?[a-z]+, state (\d+) of (\d+), (?:time left unknown|\d+:\d\d:\d\d left)"
        done, totals = np.array([[int(each) for each in re.fullmatch(form, line).groups()] for line in lines]).T
        assert answer.code == 0 and (np.diff(done) >= 0).all() and done[-1] > 0 and (done <= totals).all()
        assert re.match(f"stribeck: {last},", lines[-1])
