"""Bad input to the command: one sentence with the key, the value and what is allowed, exit code 2, nothing written."""

import re

import pytest
from command_line import EXAMPLES, call, case_text
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

import stribeck as sb


@pytest.fixture(autouse=True)
def nothing_is_solved(monkeypatch):
    """Bad input must be refused before any work; what gets through shows by this sentence."""

    def solve(*arguments, **options):
        raise sb.SolveError(sb.Outcome.STEP_LIMIT, None, "this was not refused")

    monkeypatch.setattr(sb, "solve", solve)
    monkeypatch.setattr("stribeck.curves.sensitivities.Neighbours", solve)
    checked = sb.stribeck_curve

    def curve(*arguments, **options):
        # Its own checks stay; the first point would be solved after them.
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr("stribeck.curves.stribeck_curve.follow", solve)
            patch.setattr("stribeck.curves.stribeck_curve.automatic_speed_range", solve)
            patch.setattr("stribeck.curves.stribeck_curve.grown", solve)
            return checked(*arguments, **options)

    monkeypatch.setattr(sb, "stribeck_curve", curve)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder with a good case, and things that are none."""
    (tmp_path / "case.toml").write_text(case_text())
    (tmp_path / "empty.toml").touch()
    (tmp_path / "binary.toml").write_bytes(bytes(range(128, 256)))
    (tmp_path / "null.toml").write_bytes(b"\0\0\0")
    (tmp_path / "folder.toml").mkdir()
    (tmp_path / "folder.nc").mkdir()
    (tmp_path / "old.nc").write_text("precious")
    (tmp_path / "old.png").write_text("precious")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def contents(folder):
    return {path.name: path.read_bytes() if path.is_file() else None for path in folder.iterdir()}


def assert_refused(capsys, folder, tokens, *parts):
    """Check exit code, the one sentence with its parts, and that the folder is as it was."""
    before = contents(folder)
    answer = call(capsys, *tokens)
    assert answer.code == 2, (tokens, answer)
    assert answer.out == "", tokens
    assert re.fullmatch(r"stribeck: [^\n]*[^\n.][.]\n", answer.err), (tokens, answer.err)
    assert "Traceback" not in answer.err
    for part in parts:
        assert part in answer.err, tokens
    assert contents(folder) == before, tokens


# --- case files ---

# What test_case.py says of files and test_schema.py of numbers, each command says too, before it writes.
BAD_CASES = [
    ({"contact": {"radios": '"10 mm"'}}, "[contact] radios = '10 mm' is not a known key; did you mean radius"),
    ({"contact": {"viscosity": '"50 mPaxs"'}}, "viscosity = '50 mPaxs' has the unknown unit"),
    ({"contact": {"beta": "1e-200"}}, "leave the range of double precision"),
    ({"contact": {"speed": '"1e-323 m/s"'}}, "leave the range of double precision"),  # its group is zero, which would be rest
    ({"curve": {"range": '["1 m/s", "1 mm/s"]'}}, "range = ['1 m/s', '1 mm/s'] must increase; write the lowest speed first"),
    ({"solver": {"rtol": "1e-20"}}, "rtol = 1e-20 must be a number from 1e-11 to 1e-2"),
]


@pytest.mark.quick
@pytest.mark.parametrize("tokens", [("solve",), ("regimes",), ("curve", "-o", "new.nc")])
def test_a_case_that_cannot_be_is_refused_by_key_value_and_what_is_allowed(capsys, folder, tokens):
    for tables, sentence in BAD_CASES:
        (folder / "bad.toml").write_text(case_text(**tables))
        assert_refused(capsys, folder, [tokens[0], "bad.toml", *tokens[1:]], "bad.toml", sentence)


@pytest.mark.quick
def test_all_problems_of_a_file_are_told_at_once_each_on_its_line(capsys, folder):
    (folder / "bad.toml").write_text(case_text({"radius": "-1", "alpha": '"x"', "speed": None}))
    answer = call(capsys, "solve", "bad.toml")
    lines = answer.err.splitlines()
    assert answer.code == 2
    assert all(re.fullmatch(r"stribeck: bad\.toml: \[contact\] .*\.", line) for line in lines)
    assert {line.split()[3] for line in lines} == {"radius", "alpha", "speed"}


# --- arguments ---

CURVE = ["curve", "case.toml"]
COMPARE = ["compare", EXAMPLES / "pdms_measured.csv", EXAMPLES / "pdms_fit.toml"]
OF_GROUPS = ["curve", "--groups", "0.1", "1e-3"]
BAD_ARGUMENTS = [
    (["solve"], "CASE is missing; give a case file, or dimensionless groups with --groups"),
    (["curve"], "CASE is missing"),
    (["regimes"], "CASE is missing"),
    (["solve", "case.toml", "other.toml"], "unexpected argument 'other.toml'"),
    (["solve", "case.toml", "--groups", "1", "1", "1"], "case.toml and --groups are both given"),
    (["solve", "case.toml", "--boundary-friction", "0.5"], "--boundary-friction = 0.5 goes with --groups only"),
    (["solve", "--groups", "1", "1"], "--groups needs 3 values, but 2 given"),
    (["solve", "--groups", "1", "1", "1", "1"], "--groups has more than 3 numbers: 1 1 1 1"),
    (["solve", "--groups", "-1", "0.1", "1e-3"], "speed = -1.0 must be finite and zero or positive"),
    (["solve", "--groups", "1 m/s", "0.1", "1e-3"], "speed = '1 m/s' is not a number; write it as 0.001 or 1e-3"),
    (["solve", "--groups", "1", "1", "1", "--boundary-friction", "-1"], "boundary_friction = -1.0 must be zero or positive"),
    (["solve", "case.toml", "--slide-to-roll", "fast"], "slide_to_roll"),
    (["new", "-o", "case.toml"], "Unknown option: -o. The file is given without an option, as in stribeck new case.toml."),
    (["solve", "case.toml", "--rtol", "small"], "rtol = 'small' is not a number"),
    (["solve", "case.toml", "--rtol"], "--rtol needs a value"),
    ([*CURVE, "--points", "0"], "points = 0; it must be a whole number from 2 to 100000"),
    ([*CURVE, "--points", "10.5"], "points = '10.5' is not a whole number"),
    ([*CURVE, "--rtol", "0"], "rtol = 0.0; it must be a number from 1e-11, the limit of double precision, to 0.01"),
    ([*CURVE, "--range", "1 m/s", "1 mm/s"], "range = ['1 m/s', '1 mm/s'] must increase"),
    ([*CURVE, "--range", "1 mm", "1 m"], "in range, speed = '1 mm' is a length"),
    ([*CURVE, "--range", "-1", "1"], "in range, speed = -1.0 must be zero or positive"),
    ([*CURVE, "--range", "1 mm/s"], "--range needs 2 values, but 1 given"),
    ([*CURVE, "--over", "load"], "range is missing; a curve over load needs --range"),
    ([*CURVE, "--over", "time"], "over = 'time' must be 'speed', 'load' or 'roughness'"),
    ([*OF_GROUPS, "--range", "1", "1e-3"], "speed = (1.0, 0.001); a range is two or more finite"),
    ([*OF_GROUPS, "--range", "1", "x"], "speed = 'x' is not a number"),
    (["curve", "--groups", "1", "2", "3"], "--groups has more than 2 numbers: 1 2 3"),
    (["curve", "--groups", "0", "0", "--over", "load", "--range", "1e-3", "1"], "speed and roughness are both zero"),
    ([*CURVE, "--jsno"], "--jsno"),
    (["sovle", "case.toml"], 'Unknown command "sovle". Did you mean "solve"?'),
    ([*CURVE, "-o", "old.nc"], "old.nc exists already and is kept; add --force"),
    ([*CURVE, "--plot", "old.png"], "old.png exists already and is kept; add --force"),
    ([*CURVE, "-o", "new.nc", "-o", "old.nc"], "old.nc exists already"),
    ([*CURVE, "-o", "folder.nc", "--force"], "folder.nc is a directory; give the name of a file"),
    ([*CURVE, "-o", "nowhere/new.nc"], "nowhere/new.nc cannot be written because the folder nowhere does not exist"),
    ([*CURVE, "-o", "/proc/new.nc"], "/proc/new.nc cannot be written"),
    ([*CURVE, "-o", "case.toml", "--force"], "case.toml has the ending '.toml'"),
    ([*CURVE, "-o", "new.xlsx"], "new.xlsx has the ending '.xlsx'; the name of this file must end in .nc, .csv, .zarr"),
    ([*CURVE, "--plot", "new.bmp"], "new.bmp has the ending '.bmp'; the name of this file must end in .png, .svg"),
    ([*CURVE, "-o", "new.nc", "-o", "./new.nc"], "new.nc is given twice as an output"),
    ([*COMPARE, "--out", "new.xlsx"], "must end in .nc, .csv, .zarr, .parquet or .toml"),
    ([*CURVE, "-o"], "needs a value, but 0 given"),
]


@pytest.mark.quick
def test_arguments_that_cannot_be_are_refused_in_one_sentence(capsys, folder):
    for tokens, sentence in BAD_ARGUMENTS:
        assert_refused(capsys, folder, tokens, sentence)


@pytest.mark.quick
def test_good_input_gets_past_the_checks(capsys, folder):
    for tokens in (["solve", "case.toml"], ["regimes", "case.toml"], [*CURVE, "-o", "new.nc"], [*OF_GROUPS]):
        answer = call(capsys, *tokens)
        assert answer.code == 1
        assert answer.err == "stribeck: this was not refused\n"


# --- nonsense ---

WORDS = st.one_of(
    st.sampled_from(
        [
            *("solve", "curve", "regimes", "case.toml", "empty.toml", "old.nc", "new.nc", "--groups", "--rtol"),
            *("--points", "--range", "--over", "speed", "load", "-o"),
            *("--plot", "--json", "--boundary-friction", "--beta", "--", "-"),
            *("1", "-1", "1e-3", "1 mm/s", "1e999", "nan", "", " ", "=", "--json=5", "--help", "[", "\0", "ä"),
        ]
    ),
    st.text(max_size=8),
)


@pytest.mark.quick
@example(tokens=["--help", "--help"])  # a NameError in cyclopts 4.0
@given(tokens=st.lists(WORDS, max_size=7))
@settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_nonsense_gets_a_sentence_and_never_a_traceback(capsys, folder, tokens):
    before = contents(folder)
    answer = call(capsys, *tokens)
    assert answer.code in (0, 1, 2), tokens
    if answer.code:
        assert answer.err.startswith("stribeck: ")
        assert answer.err.count("\n") <= 2
    if answer.code == 1:
        assert answer.err == "stribeck: this was not refused\n"
    assert contents(folder) == before
