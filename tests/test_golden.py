"""Golden values: states, curves, fits, diagrams, margins and a sweep are within the stated errors of what they were.

``tests/golden/make.py`` made the file; it says when to make it anew.  Here are so many rows that any two parts of a
model, or a part and an outcome or a regime, that stand together in some row do so in one of them; the others, and those
that take longer, are those of ``make slow``.
"""

import itertools
import json
from pathlib import Path

import pytest
from golden.observed import GROWTH, PARTS, PLACES, faults, observed

ROWS = json.loads((Path(__file__).parent / "data" / "golden.json").read_text())
CHUNKS = 16
"""Parts that run apart from each other; every one holds some of each kind."""


def classes_in(part):
    """Return the names of the classes of a part and of what it is made of."""
    if isinstance(part, list):
        return {name for each in part for name in classes_in(each)}
    return {part} if isinstance(part, str) else set()


def features(row):
    """Return what is special about a row: parts of its model, what is free or varied, outcome and regime."""
    case = row["case"]
    found = {name for name in (*PARTS, "over", "free", "robust", "axes") if name in case}
    found |= {name for part in PARTS for name in classes_in(case.get(part))} | {case.get("over")}
    share = row["values"].get("fluid_load_share", [None])[0]
    regime = None if share is None else "boundary" if share < 0.05 else "mixed" if share < 0.95 else "hydrodynamic"
    return {str(each) for each in (*found, row["words"].get("outcome"), regime)}


def sample(rows):
    """Return few rows that show all that goes together in their kind: again and again the one that shows most that is new."""
    shown = []
    for row in rows:
        head = row["case"]["kind"], row["case"].get("geometry")
        shown.append({(head,), *((head, *pair) for pair in itertools.combinations(sorted(features(row)), 2))})
    missing = set().union(*shown)
    while missing:
        best = max(range(len(rows)), key=lambda i: len(shown[i] & missing))
        missing -= shown[best]
        yield rows[best]


QUICK = [*sample([row for row in ROWS if not row.get("slow")])]
SLOW = [row for row in ROWS if not any(row is one for one in QUICK)]


def check(rows):
    found = [fault for row in rows for fault in faults(row["case"], row, observed(row["case"]))]
    assert not found, "\n".join([f"{len(found)} differences", *found])


@pytest.mark.parametrize("chunk", range(CHUNKS))
def test_everything_observed_is_within_its_stated_errors_of_what_it_was(chunk):
    check(QUICK[chunk::CHUNKS])


@pytest.mark.slow
@pytest.mark.parametrize("chunk", range(6 * CHUNKS))
def test_what_takes_longer_is_within_its_stated_errors_of_what_it_was(chunk):
    check(SLOW[chunk :: 6 * CHUNKS])


def test_a_value_off_by_three_errors_an_error_that_grew_and_an_outcome_that_changes_are_faults():
    row = next(row for row in ROWS if row["words"] == {"outcome": "CONVERGED"})
    assert faults(row["case"], row, row) == []
    for change, told in (
        (lambda value, error: [value + 3 * error, error], "the errors allow"),
        (lambda value, error: [value - 3 * error, error], "the errors allow"),
        (lambda value, error: [value, 1.1 * GROWTH * error], "the stated error"),
        (lambda value, error: [None, error], "the errors allow"),
    ):
        for name, old in row["values"].items():
            if name in PLACES and told == "the stated error":
                continue
            [fault] = faults(row["case"], row, {**row, "values": {**row["values"], name: change(*old)}})
            assert told in fault and name in fault and str(row["case"]["speed"]) in fault
    assert len(faults(row["case"], row, {"words": {"outcome": "PATH_LOST"}, "values": {}})) == 1 + len(row["values"])
