"""What people open first: shipped cases and templates are in no doubt that their own notes tell how to mend."""

import re
import tomllib

import pytest
from command_line import EXAMPLES, PDMS

import stribeck as sb

DOUBTS = ("cavitates", "range of the exponential", "range of Persson")
"""Words of the notes on suction, and on a contact law outside its range."""

THICK = "pdms_ball"
"""The ball in the middle of its range of speeds, where its film is thicker than its law reaches; no law reaches further."""

CAVITATING = "rubber_ball"
"""The ball of an optical rig: a film that breaks would need the length of its wake, which the source does not give."""

CASES = sorted(path for path in EXAMPLES.glob("*.toml") if "vary" not in tomllib.loads(path.read_text()))


def doubts(case):
    """Return the notes that doubt cavitation or contact law at the speed of a case."""
    return [note for note in sb.solve(case.contact, rtol=1e-3).notes if any(words in note for words in DOUBTS)]


@pytest.mark.parametrize("path", CASES, ids=lambda path: path.stem)
def test_a_shipped_case_opens_without_a_doubt_that_another_model_would_mend(path):
    found = doubts(sb.load_case(path))
    if path.stem in (THICK, CAVITATING):
        [note] = found  # a case that has no doubt any more leaves the exceptions
        assert ("beyond the range" if path.stem == THICK else "cavitates") in note
    else:
        assert found == []


@pytest.mark.parametrize("geometry", ["line", "point"])
def test_a_template_opens_without_one(geometry, tmp_path):
    path = tmp_path / "case.toml"
    path.write_text(sb.new_case(geometry))
    assert doubts(sb.load_case(path)) == []


def test_the_law_of_the_article_is_kept_with_a_reason_and_the_amount_that_check_gives():
    texts = [(EXAMPLES / "pdms_cylinder.toml").read_text(), sb.new_case("line")]
    case, template = (" ".join(line.lstrip("# ") for line in text.splitlines()) for text in texts)
    for words in (case, template):
        assert "article" in words and "The minimum of friction lies beyond" in words and "stribeck check" in words
    moved = re.search(r"minimum of friction, (speed \S+ % and friction \S+ %)", str(sb.check(sb.load_case(PDMS).contact)))
    assert moved and moved[1] in case
