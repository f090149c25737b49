"""The making of figures: which are meant, what is written, kept, solved again and refused, and that each can be read."""

import dataclasses
import json
import os
import re
import shutil
import sys
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from command_line import call
from matplotlib.figure import Figure

import stribeck as sb
from stribeck.figures import FIGURES, PaperFigure, build, figure_names, load_figure, make_figures, style
from stribeck.figures.job import FigureJob, Numbers

PANELS = {
    "3": "ab",
    "4": "abcd",
    "5": "ab",
    "6": "abcd",
    "7": "ab",
    "8": "abcd",
    "9": "abc",
    "10": "ab",
    "11": "",
    "S1": "abc",
}
"""Panels of the paper that hold results of its own model."""


FINDINGS = json.loads((Path(__file__).parent / "data" / "findings.json").read_text(encoding="utf-8"))
NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?!\w)")


@cache
def data_of(name):
    """Return the dataset of a figure."""
    return load_figure(name).data()


@cache
def picture_of(name):
    """Return the picture of a figure, laid out."""
    figure = load_figure(name).picture(data_of(name))
    figure.canvas.draw()
    return figure


def opened(path):
    with xr.open_dataset(path, engine="netcdf4", decode_times=False) as found:
        return found.load()


# --- names ---


def test_figures_are_named_as_people_name_them_and_come_in_the_order_of_the_paper(subtests):
    for texts, names in [
        (["3"], ("3",)),
        (["3a", "3(b)", "3"], ("3",)),
        (["s1", "S1c"], ("S1",)),
        (["figure_4", "Fig. 5(b)", "fig6", "FIGURE 10"], ("4", "5", "6", "10")),
        (["S1", "11", "3"], ("3", "11", "S1")),
        ([], FIGURES),
    ]:
        with subtests.test(texts=texts, names=names):
            assert figure_names(texts) == names


def test_an_unknown_figure_is_refused_with_those_that_are_known(subtests):
    for text in ["2", "12", "3g", "", "S", "s2", "figure", "3 4", "../3", "-3"]:
        with subtests.test(text=text):
            with pytest.raises(
                sb.InputError, match=re.escape(f"figure {text!r} is not one of 3, 4, 5, 6, 7, 8, 9, 10, 11, S1;")
            ):
                figure_names(["3", text])


# --- every figure ---

QUICKLY_SOLVED = {"5", "6"}
each_figure = pytest.mark.parametrize(
    "name", [pytest.param(name, marks=[pytest.mark.slow] * (name not in QUICKLY_SOLVED)) for name in FIGURES]
)


@each_figure
def test_the_data_of_each_figure_are_described_and_converged(name):
    data = data_of(name)
    assert data.attrs["figure"] == name
    assert data.attrs["source"] == f"stribeck {sb.__version__}"
    assert data.attrs["finding"].endswith(".") and any(letter.isdigit() for letter in data.attrs["finding"])
    assert 0 < data.attrs["error_estimate"] <= data.attrs["rtol"] <= 1e-6
    for variable in data.variables.values():
        assert variable.attrs["units"] and len(variable.attrs["long_name"]) > 5
        assert variable.size > 0
        if variable.dtype.kind == "f":
            assert not np.isinf(variable.values).any()
            assert np.isfinite(variable.values).any()


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=[pytest.mark.slow] * (name in {"3", "7", "9", "10", "11"})) for name in FIGURES]
)
def test_the_numbers_in_what_a_figure_finds_are_those_that_were_read_and_checked(name):
    wanted, found = (NUMBER.findall(text) for text in (FINDINGS[name], data_of(name).attrs["finding"]))
    assert len(found) == len(wanted)
    # A number on the edge of two roundings may take either.
    for here, there in zip(found, wanted, strict=True):
        assert abs(float(here) - float(there)) <= 1.01 * max(unit_of(here), unit_of(there)), (here, there)


def unit_of(number):
    """Return the unit of the last digit of a number in a text."""
    digits, _, exponent = number.partition("e")
    return 10.0 ** (int(exponent or 0) - len(digits.partition(".")[2]))


@each_figure
def test_each_figure_shows_the_panels_of_the_paper_and_its_provenance_and_nothing_is_cut_off(name):
    figure = picture_of(name)
    titles = [axes.get_title(loc="left") for axes in figure.axes]
    letters = {title[1] for title in titles if title.startswith("(")}
    assert set(PANELS[name]) <= letters
    words = "".join(text.get_text() for text in figure.texts).replace("\N{NO-BREAK SPACE}", "").replace(" ", "")
    for part in (f"Figure {name}: ", load_figure(name).said["title"], f"stribeck {sb.__version__}, rtol 1e-"):
        assert part.replace(" ", "") in words
    box, (width, height) = figure.get_tightbbox(figure.canvas.get_renderer()), figure.get_size_inches()
    assert box.x0 > 0 and box.x1 < width
    assert box.y0 > 0 and box.y1 < height


# --- files and memory ---


class Fakes:
    """Figures that are made in a moment, and count how often they are computed."""

    def __init__(self):
        self.computed = []
        self.problems = {}

    def figure(self, name):
        def compute(work):
            self.computed.append(name)
            work.report(1, 2)
            if name in self.problems:
                raise self.problems[name]
            work.report(2, 2)
            numbers = Numbers(x=[0.1, 0.2, 0.3], y=[1.0, np.nan, 3.0], words=["a", "bc", "d"], part=0.03)
            return work.dataset(numbers)

        def draw(panels, data):
            panels["a"].plot(data.x, data.y)

        return PaperFigure(name, SAID, compute, draw)


SAID = {
    "title": "Fake",
    "claim": "it is 4.",
    "finding": "It is\n{y[2]:.0f}, {part:%.0f} %.",
    "size": (4.0, 2.0),
    "grid": {"mosaic": [["a"]]},
    "coords": {"x": ["x", "where"]},
    "variables": {"y": ["x", "what is drawn"], "words": ["x", "names"]},
    "panels": {"a": {"text": "panel"}},
}


def test_the_same_data_give_the_same_bytes(tmp_path, monkeypatch):
    """The solver of the layout starts from what lies where in memory: its last digits differ from picture to picture."""
    figure, lay_out = Fakes().figure("3"), Figure.draw_without_rendering
    for i in range(2):

        def drawn(self, off=1e-12 * i):
            lay_out(self)
            for axes in self.axes:
                axes.set_position([each + off for each in axes.get_position().bounds])

        monkeypatch.setattr(Figure, "draw_without_rendering", drawn)
        style.save(figure.picture(figure.data()), tmp_path / f"{i}.svg")
    assert len({path.read_bytes() for path in tmp_path.iterdir()}) == 1


DRAW = style.save


@pytest.fixture
def fakes(monkeypatch):
    """Return figures that are made in a moment, as their pictures are empty."""
    found = Fakes()
    monkeypatch.setattr(build, "load_figure", found.figure)
    monkeypatch.setattr(style, "save", lambda figure, path: path.touch())
    return found


def outcomes(made):
    return [(each.name, each.outcome) for each in made]


def test_a_figure_is_a_png_an_svg_and_its_data(fakes, tmp_path, monkeypatch):
    monkeypatch.setattr(style, "save", DRAW)
    seen = []
    (made,) = make_figures(["s1"], tmp_path / "new", on_progress=lambda *step: seen.append(step))
    assert made.outcome == "solved" and seen == [("S1", 0, 1), ("S1", 1, 2), ("S1", 2, 2)]
    assert [path.name for path in made.files] == ["figure_s1.png", "figure_s1.svg", "figure_s1.nc"]
    assert sorted(os.listdir(tmp_path / "new")) == sorted(path.name for path in made.files)
    assert made.files[0].read_bytes().startswith(b"\x89PNG") and made.files[1].read_bytes().startswith(b"<?xml")
    data = opened(made.files[2])
    assert (data.attrs["claim"], data.attrs["finding"]) == ("it is 4.", "It is 3, 3 %.")
    assert data.x.attrs == {"units": "1", "long_name": "where"}
    np.testing.assert_array_equal(data.y, [1.0, np.nan, 3.0])
    assert data.words.values.tolist() == ["a", "bc", "d"]


def test_data_in_the_folder_are_used_again_and_lost_pictures_drawn_from_them(fakes, tmp_path, monkeypatch):
    monkeypatch.setattr(style, "save", DRAW)
    (first,) = make_figures(["3"], tmp_path)
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    (tmp_path / "figure_3.svg").unlink()
    (second,) = make_figures(["3"], tmp_path)
    assert fakes.computed == ["3"]
    assert (first.outcome, second.outcome) == ("solved", "reused")
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before


def test_data_from_other_sources_are_solved_again(fakes, tmp_path, monkeypatch):
    make_figures(["3"], tmp_path)
    monkeypatch.setattr(build, "fingerprint", lambda figure: "another")
    (made,) = make_figures(["3"], tmp_path)
    assert (made.outcome, fakes.computed) == ("solved", ["3", "3"])
    assert opened(tmp_path / "figure_3.nc").attrs["fingerprint"] == "another"


def test_the_fingerprint_changes_with_every_source_of_the_numbers(tmp_path, monkeypatch):
    package = Path(build.__file__).parents[1]
    shutil.copytree(package, tmp_path / "stribeck", ignore=shutil.ignore_patterns("__pycache__"))
    monkeypatch.setattr(build, "__file__", str(tmp_path / "stribeck" / "figures" / "build.py"))
    figures = [Fakes().figure(name) for name in ("3", "4")]
    before = [build.fingerprint(figure) for figure in figures]
    assert before[0] != before[1]
    for changed, expected in (
        ("numerics/newton.py", [True, True]),
        ("figures/article/figure_3.py", [True, False]),
        ("figures/article/figure_4.toml", [False, True]),
        ("figures/style.py", [False, False]),
        ("plot/curve.py", [False, False]),
    ):
        with (tmp_path / "stribeck" / changed).open("r+") as file:  # of a source that exists
            file.seek(0, os.SEEK_END)
            file.write("\n# another word\n")
        after = [build.fingerprint(figure) for figure in figures]
        assert [a != b for a, b in zip(after, before, strict=True)] == expected
        before = after


def test_ctrl_c_keeps_what_is_finished(fakes, tmp_path):
    fakes.problems["4"] = KeyboardInterrupt()
    made = make_figures(["3", "4", "5"], tmp_path)
    assert outcomes(made) == [("3", "solved"), ("4", "interrupted")]
    assert made[1].message == "Interrupted at figure 4." and made[1].files == ()
    assert sorted(os.listdir(tmp_path)) == ["figure_3.nc", "figure_3.png", "figure_3.svg"]
    del fakes.problems["4"]
    assert outcomes(make_figures(["3", "4"], tmp_path)) == [("3", "reused"), ("4", "solved")]


def test_a_figure_that_cannot_be_solved_leaves_no_file_and_does_not_stop_the_others(fakes, tmp_path):
    fakes.problems["4"] = sb.SolveError(sb.Outcome.STEP_LIMIT, None, "speed 1: too far.")
    made = make_figures(["3", "4", "5"], tmp_path)
    assert outcomes(made) == [("3", "solved"), ("4", "failed"), ("5", "solved")]
    assert made[1].message == "Figure 4 was not made: speed 1: too far."
    assert not [path for path in tmp_path.iterdir() if "4" in path.stem]


def test_a_full_disk_stops_one_figure_with_a_sentence(fakes, tmp_path, monkeypatch):
    def full(figure, path):
        path.touch()
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(style, "save", full)
    (made,) = make_figures(["3"], tmp_path)
    assert made.outcome == "unwritten"
    assert "figure_3.png could not be written (No space left on device)" in made.message
    assert os.listdir(tmp_path) == ["figure_3.nc"]


def test_a_file_of_somebody_else_is_kept_unless_forced(fakes, tmp_path):
    for ending in (".png", ".svg", ".nc"):
        theirs = tmp_path / ending[1:] / f"figure_4{ending}"
        theirs.parent.mkdir()
        theirs.write_text("precious")
        with pytest.raises(sb.InputError, match=re.escape(f"figure_4{ending} exists already and is kept; add --force")):
            make_figures(["3", "4"], theirs.parent)
        assert fakes.computed == [] and os.listdir(theirs.parent) == [theirs.name]
        assert theirs.read_text() == "precious"
    assert outcomes(make_figures(["4"], theirs.parent, force=True)) == [("4", "solved")]
    assert b"precious" not in theirs.read_bytes()


def test_the_data_of_another_figure_are_nobody_s_licence(fakes, tmp_path):
    make_figures(["3"], tmp_path)
    shutil.copy(tmp_path / "figure_3.nc", tmp_path / "figure_4.nc")
    with pytest.raises(sb.InputError, match="figure_4.nc exists already"):
        make_figures(["4"], tmp_path)


def test_a_folder_is_made_but_not_the_folders_above_it(fakes, tmp_path):
    with pytest.raises(sb.InputError, match="the folder .*/a does not exist; create it first"):
        make_figures(["3"], tmp_path / "a" / "b")
    assert os.listdir(tmp_path) == []
    (tmp_path / "file").touch()
    with pytest.raises(sb.InputError, match="file is a file; give the name of a folder"):
        make_figures(["3"], tmp_path / "file")
    with pytest.raises(sb.InputError, match="cannot be created"):
        make_figures(["3"], tmp_path / "file" / "below")
    with pytest.raises(sb.InputError, match="File name too long"):
        make_figures(["3"], tmp_path / ("n" * 300))
    assert fakes.computed == []


def test_a_protected_folder_is_refused_before_any_work(fakes, tmp_path, monkeypatch):
    monkeypatch.setattr("os.access", lambda path, mode: False)
    with pytest.raises(sb.InputError, match="is write-protected; choose another folder"):
        make_figures(["3"], tmp_path)
    assert fakes.computed == []


def test_a_missing_library_is_named_with_the_extra_that_brings_it(fakes, tmp_path, monkeypatch):
    for library, extra in (("matplotlib", "plot"), ("xarray", "data"), ("netCDF4", "data")):
        said = re.escape(f"needs {library}; install it with: pip install 'stribeck[{extra}]'.")
        with monkeypatch.context() as patch:
            patch.setitem(sys.modules, library, None)
            with pytest.raises(ImportError, match=said):
                make_figures(["3"], tmp_path / "new")
    assert os.listdir(tmp_path) == []


# --- the work of a figure ---


def test_no_state_is_given_that_did_not_converge(monkeypatch):
    work = FigureJob(lambda *step: None, {"rtol": 1e-11})
    with pytest.raises(sb.SolveError):
        work.solve(1e-8, 0.1, 1e-7)
    whole = sb.stribeck_curve(load=0.1, roughness=0.01, speed=(0.1, 1.0), points=3)
    few = dataclasses.replace(whole, values=whole.values[1:])
    for curve, outcome in ((whole, sb.Outcome.PATH_LOST), (few, whole.outcome)):
        with monkeypatch.context() as patch:
            patch.setattr(type(curve), "outcome", property(lambda self, outcome=outcome: outcome))
            patch.setattr("stribeck.figures.job.stribeck_curve", lambda curve=curve, **arguments: curve)
            with pytest.raises(sb.SolveError, match="of 3 points"):
                work.curve(load=0.1, roughness=0.01)
    assert (work.done, work.error_estimate) == (0, 0.0)


def test_ctrl_c_inside_a_curve_ends_the_figure():
    def report(done, steps):
        raise KeyboardInterrupt

    for points in (2, 5):
        with pytest.raises(KeyboardInterrupt):
            FigureJob(report, {"rtol": 1e-5}).curve(load=0.1, roughness=0.01, speed=(0.1, 1.0), points=points)


# --- the command ---


def test_the_command_names_what_it_wrote_and_what_it_kept(fakes, tmp_path, capsys):
    answer = call(capsys, "figures", "3b", "S1", "--out", tmp_path)
    files = [", ".join(str(tmp_path / f"figure_{name}{end}") for end in (".png", ".svg", ".nc")) for name in ("3", "s1")]
    assert answer.code == 0 and answer.err == ""
    assert answer.out.splitlines() == [f"Figure 3: {files[0]}", f"Figure S1: {files[1]}"]
    answer = call(capsys, "figures", "3", "--out", tmp_path)
    assert answer.out == f"Figure 3, kept data: {files[0]}\n"
    assert call(capsys, "figures", "3", "--out", tmp_path, "--force").out == f"Figure 3: {files[0]}\n"


def test_the_command_makes_all_figures_into_the_folder_figures(fakes, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert call(capsys, "figures").code == 0
    assert fakes.computed == list(FIGURES)
    assert len(os.listdir(tmp_path / "figures")) == 3 * len(FIGURES)


def test_the_exit_code_of_the_command_says_what_went_wrong(fakes, tmp_path, capsys, monkeypatch):
    fakes.problems["4"] = sb.SolveError(sb.Outcome.STEP_LIMIT, None, "speed 1: too far.")
    answer = call(capsys, "figures", "3", "4", "--out", tmp_path)
    assert (answer.code, answer.err) == (1, "stribeck: Figure 4 was not made: speed 1: too far.\n")
    assert answer.out.startswith("Figure 3: ")
    fakes.problems["4"] = sb.InputError("the disk is full.")
    answer = call(capsys, "figures", "3", "4", "--out", tmp_path)
    assert (answer.code, answer.err) == (2, "stribeck: Figure 4 was not made: the disk is full.\n")
    fakes.problems["4"] = KeyboardInterrupt()
    answer = call(capsys, "figures", "3", "4", "5", "--out", tmp_path)
    assert answer.code == 130
    assert answer.err == f"stribeck: Interrupted at figure 4; finished and kept in {tmp_path}: 3.\n"
    answer = call(capsys, "figures", "4", "--out", tmp_path)
    assert (answer.code, answer.err) == (130, "stribeck: Interrupted at figure 4; none was finished.\n")


def test_a_phase_diagram_with_gaps_ends_the_figure_with_its_reasons(monkeypatch):
    def incomplete(**arguments):
        found = sb.phase_diagram(load=0.1, roughness=1e-3, speed=1e-5, rtol=1e-4)
        found.message.values[:] = "Speed 1: too far."
        return found.assign_attrs(complete=0)

    monkeypatch.setattr("stribeck.figures.article.figure_11.phase_diagram", incomplete)
    with pytest.raises(sb.SolveError, match="Speed 1: too far"):
        load_figure("11").data()


def test_a_minimum_that_is_not_found_ends_the_figure_with_a_sentence(monkeypatch):
    for module in ("article.figure_9", "article.stribeck_cases"):
        monkeypatch.setattr(f"stribeck.figures.{module}.CASES", ((0.1, 1e-3),))
    monkeypatch.setattr("stribeck.figures.article.figure_9.SPEED_WINDOW", (2.0, 4.0))
    with pytest.raises(sb.SolveError, match="No minimum of friction was found at load 0.1, relative roughness 1e-05"):
        load_figure("9").data()
