"""The notebooks run from top to bottom, and read as notebooks; the numbers that they show are asserted in their cells."""

import re
from pathlib import Path

import pytest

FOLDER = Path(__file__).parents[1] / "docs" / "notebooks"
NOTEBOOKS = sorted(FOLDER.glob("*.py"))

CELL = re.compile(r"^# %%(?: \[(\w+)\])?\n", re.MULTILINE)


def test_each_notebook_begins_with_its_title_and_explains_its_code(subtests):
    assert {path.stem for path in NOTEBOOKS} == {"fitting", "paper_in_one_hour", "topography_to_stribeck_curve"}
    for path in NOTEBOOKS:
        with subtests.test(path.stem):
            _, *parts = CELL.split(path.read_text())
            kinds, texts = parts[::2], parts[1::2]
            assert kinds[0] == "markdown" and texts[0].startswith("# # ")
            words = [line for kind, text in zip(kinds, texts, strict=True) if kind for line in text.split("\n") if line]
            assert all(line.startswith("#") for line in words)
            assert kinds.count("markdown") >= kinds.count(None) - 1


@pytest.mark.slow  # each build of the site runs them cell by cell
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs_and_its_claims_hold(path, monkeypatch):
    pyplot = pytest.importorskip("matplotlib.pyplot")
    pyplot.switch_backend("agg")
    monkeypatch.chdir(FOLDER)
    before = {*FOLDER.iterdir()}
    code = path.read_text()
    assert "assert " in code
    try:
        exec(compile(code, str(path), "exec"), {"__name__": "__main__"})
        assert pyplot.get_fignums()
    finally:
        pyplot.close("all")
    assert {*FOLDER.iterdir()} == before
