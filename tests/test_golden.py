"""Golden values: states, curves, fits, diagrams, margins and a sweep are within the stated errors of what they were.

``tests/golden/make.py`` made the file; it says when to make it anew.  A part takes about three seconds, as it solves
some twenty states, a curve and more.  Cases of more than a second and a half are those of ``make slow``.
"""

import json
from pathlib import Path

import pytest
from golden.observed import GROWTH, PLACES, faults, observed

ROWS = json.loads((Path(__file__).parent / "data" / "golden.json").read_text())
QUICK, SLOW = ([row for row in ROWS if row.get("slow", False) is slow] for slow in (False, True))
CHUNKS = 48
"""Parts that run apart from each other; every one holds some of each kind."""


def check(rows):
    found = [fault for row in rows for fault in faults(row["case"], row, observed(row["case"]))]
    assert not found, "\n".join([f"{len(found)} differences", *found])


@pytest.mark.parametrize("chunk", range(CHUNKS))
def test_everything_observed_is_within_its_stated_errors_of_what_it_was(chunk):
    check(QUICK[chunk::CHUNKS])


@pytest.mark.slow
@pytest.mark.parametrize("row", range(len(SLOW)))
def test_what_takes_longer_is_within_its_stated_errors_of_what_it_was(row):
    check(SLOW[row : row + 1])


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (lambda value, error: [value + 3 * error, error], "the errors allow"),
        (lambda value, error: [value - 3 * error, error], "the errors allow"),
        (lambda value, error: [value, 1.1 * GROWTH * error], "the stated error"),
        (lambda value, error: [None, error], "the errors allow"),
    ],
    ids=("above", "below", "unsure", "nan"),
)
def test_a_value_off_by_three_errors_and_an_error_that_grew_are_faults(change, told):
    row = next(row for row in ROWS if row["words"] == {"outcome": "CONVERGED"})
    assert faults(row["case"], row, row) == []
    for name, old in row["values"].items():
        if name in PLACES and told == "the stated error":
            continue
        [fault] = faults(row["case"], row, {**row, "values": {**row["values"], name: change(*old)}})
        assert told in fault and name in fault and str(row["case"]["speed"]) in fault


def test_an_outcome_that_changes_is_a_fault():
    row = next(row for row in ROWS if row["words"] == {"outcome": "CONVERGED"})
    assert len(faults(row["case"], row, {"words": {"outcome": "PATH_LOST"}, "values": {}})) == 1 + len(row["values"])
