"""What people open first: shipped cases are in no doubt but on the minimum of friction, whose error is a number."""

import math
import re
import tomllib

import numpy as np
import pytest
from command_line import EXAMPLES, PDMS, call

import stribeck as sb

CASES = sorted(path for path in EXAMPLES.glob("*.toml") if "vary" not in tomllib.loads(path.read_text()))

CONDITIONAL = {
    "contact_lens": "The model applies if adhesion is small and no liquid flows in pores.",
    "reciprocating_cylinder": "Outside the range of the model: stroke over a. Doubtful: contact law at the minimum.",
}
"""The lens is a hydrogel: what adheres and flows in its pores is not known, and its measured friction is ten times larger.
The stroke of the cylinder is short, for which there is ``stribeck stroke``."""

# Where the minimum lies above the range of the contact law, the check of the tail states by how much that moves it.
FINE = re.compile(
    r"The model applies(?:: all \d+ checks are fine\.|, with doubts about contact law at the minimum\.)"
    r" Largest error stated: \d+ % \(tail of the contact law\)\."
)


def first_line(capsys, path):
    """Return the first line of ``stribeck check``."""
    return call(capsys, "check", str(path)).out.split("\n")[0].rstrip()


DEAR = (
    *("contact_lens", "nitrile_seal", "pdms_ball", "pdms_fit", "rod_seal", "rubber_ball", "tongue_model"),
    *("wiper_blade", "wiper_edge", "worn_rod_seal"),
)
"""Balls, and contacts whose curves take seconds and whose shape, law or film another one has."""

CHECKED = [pytest.param(path, marks=[pytest.mark.slow] if path.stem in DEAR else [], id=path.stem) for path in CASES]


@pytest.mark.parametrize("path", CHECKED)
def test_check_of_a_shipped_case_doubts_at_most_the_minimum_and_states_its_error(capsys, monkeypatch, path):
    monkeypatch.setenv("COLUMNS", "200")
    line = first_line(capsys, path)
    expected = CONDITIONAL.get(path.stem)
    assert line.startswith(expected) and "Doubtful" not in line[len(expected) :] if expected else FINE.fullmatch(line), line


@pytest.mark.parametrize("geometry", ["line", pytest.param("point", marks=pytest.mark.slow)])
def test_check_of_a_template_doubts_at_most_the_minimum_and_states_its_error(capsys, monkeypatch, geometry, tmp_path):
    monkeypatch.setenv("COLUMNS", "200")
    path = tmp_path / "case.toml"
    path.write_text(sb.new_case(geometry))
    assert FINE.fullmatch(first_line(capsys, path))


def test_the_error_of_the_first_line_is_that_of_the_check_that_it_names():
    found = sb.check(sb.load_case(PDMS).contact)
    tail = found["tail of the contact law"]
    assert found.headline.endswith(f"Largest error stated: {100 * tail.error:.0f} % (tail of the contact law).")
    assert tail.error == max(each.error for each in found) == tail.value
    assert tail.sentence in str(found)


def test_a_wide_contact_says_what_its_parabola_costs(subtests):
    """The load of a rigid circle over that of the parabola at the same half-width, by quadrature of its slope."""
    for contact, factor in [(sb.LineContact, 3 / 8), (sb.PointContact, 2 / 5)]:
        with subtests.test(contact=contact, factor=factor):
            given = {
                "radius": 1e-2,
                "modulus": 1e6,
                "viscosity": 0.01,
                "speed": 0.0,
                "roughness": 0.0,
                "alpha": 2.0,
                "beta": 0.05,
            }
            wide = contact(**given, load=500.0 if contact is sb.LineContact else 1.0, boundary_friction=0.5)
            found = sb.check(wide)["contact width a/R"]
            power, steps = (1 if contact is sb.LineContact else 2), 4000
            slope = [found.value * (i + 0.5) / steps for i in range(steps)]
            weights = [x**power / (found.value**2 - x**2) ** 0.5 for x in slope]
            circle = sum(w * x / (1 - x**2) ** 0.5 for w, x in zip(weights, slope, strict=True))
            parabola = sum(w * x for w, x in zip(weights, slope, strict=True))
            assert found.verdict == "fine" and 0.1 < found.value < 0.3
            assert found.error == pytest.approx(factor * found.value**2, rel=1e-12)
            assert circle / parabola - 1 == pytest.approx(found.error, rel=0.1)


def test_a_shipped_law_that_is_the_articles_says_why_and_the_amount_that_check_gives():
    texts = [(EXAMPLES / "pdms_cylinder.toml").read_text(), sb.new_case("line")]
    case, template = (" ".join(line.lstrip("# ") for line in text.splitlines()) for text in texts)
    for words in (case, template):
        assert "article" in words and "The minimum of friction lies beyond" in words and "stribeck check" in words
    moved = re.search(r"minimum of friction, (speed \S+ % and friction \S+ %)", str(sb.check(sb.load_case(PDMS).contact)))
    assert moved and moved[1] in case


def test_check_prints_what_a_law_of_greenwood_has_in_common_with_the_exponential_one(capsys, tmp_path):
    path = tmp_path / "case.toml"
    old, new = 'law = "exponential"', 'law = "greenwood-williamson"'
    text = sb.new_case("line").replace("alpha = 2.0", "alpha = 1.0")
    assert old in text
    path.write_text(text.replace(old, new))
    said = " ".join(call(capsys, "check", str(path)).out.split())
    contact = sb.load_case(path).contact
    assert found_beta(said) == pytest.approx(beta_of_same_pressure(contact), rel=0.01)
    assert found_beta(" ".join(str(sb.check(contact)).split())) == found_beta(said)


def found_beta(text):
    """Return the beta of the exponential law that a text names."""
    return float(re.search(r"presses as the exponential law with alpha = 2 and beta = ([0-9.e-]+) does", text)[1])


def beta_of_same_pressure(contact):
    """Return the beta of the exponential law with alpha = 2 that presses as much at the central gap."""
    gap = sb.solve(contact, rtol=1e-4).central_gap * contact.hertz.indentation / contact.roughness
    [log] = contact.law.log_pressure(np.array([gap]))
    return contact.beta * math.exp(log + 2 * gap)
