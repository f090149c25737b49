"""The comparison with peers: the textbook solver, which shares no code with ours, and the tables that are shown."""

import re
import sys
from pathlib import Path

import numpy as np
import pytest

import stribeck as sb

ROOT = Path(__file__).parents[1]
BENCHMARKS = ROOT / "benchmarks"


@pytest.fixture
def textbook(load_benchmark):
    """Return the textbook solver."""
    return load_benchmark("textbook")


def central_gap(textbook, x, speed):
    h, _, reached = textbook.solve(x, speed)
    assert reached == speed
    return float(np.interp(0, x, h))


def test_it_tends_to_our_film_at_second_order(textbook, solved):
    truth = solved(1e-4, 0.1, 0.0, 1e-9).central_gap
    errors = [abs(central_gap(textbook, textbook.grid(n), 1e-4) / truth - 1) for n in (201, 401)]
    assert abs(np.log2(errors[0] / errors[1]) - 2) < 0.2
    assert errors[1] < 1e-2


def test_it_finds_our_mixed_state(textbook, load_benchmark, solved):
    peers = load_benchmark("peers")
    found = peers.textbook_mixed("graded grid", 201, runs=1)
    truth = solved(1e-4, 0.1, 1e-4)
    assert abs(found.contact_share / truth.contact_load_share - 1) < 2e-3
    assert abs(found.viscous / truth.friction(definition=peers.DEFINITION).fluid - 1) < 5e-3


def test_a_peer_that_is_missing_is_named_with_the_way_to_install_it(load_benchmark, monkeypatch):
    peers = load_benchmark("peers")
    for name in ("tamaas", "ContactMechanics"):
        monkeypatch.setitem(sys.modules, name, None)
        assert f"pip install {name}" in peers.peer_states(name)


def test_our_dry_contact_is_that_of_hertz_but_for_its_roughness(load_benchmark):
    rough, smooth = load_benchmark("peers").our_dry()
    kappa = sb.Groups(0.0, 0.01, 1e-8).relative_roughness
    assert rough.pressure - 1 == pytest.approx(-kappa, rel=1e-2)
    assert rough.half_width - 1 == pytest.approx(2 * kappa, rel=1e-2)
    assert (smooth.pressure, smooth.half_width) == (1.0, 1.0)


def per_cent(part):
    return f"{100 * float(part):.9f}".rstrip("0").rstrip(".") + " %"


def rows_of(text, first):
    table = re.search(rf"^\| {first}.*?\n\n", text, re.M | re.S)[0]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in table.splitlines()[2:] if line]


def test_the_readme_shows_the_numbers_of_the_page_in_per_cent():
    readme = (ROOT / "README.md").read_text()
    ours, uniform, graded, *others = rows_of((BENCHMARKS / "peers.md").read_text(), "relative error of")
    shown = rows_of(readme, r"\| film thickness wrong by")
    for row, found in zip((ours, uniform, graded), shown, strict=True):
        assert found[1].split(";")[0] == per_cent(row[1].split(",")[0])
        assert [float(cell) for cell in found[3:]] == [float(cell) for cell in row[4:]]
    assert shown[0][2] == "below 1e-8 %" and ours[2] == "< 1e-10"
    assert [found[2] for found in shown[1:]] == [per_cent(row[2]) for row in (uniform, graded)]
    assert {row[3] for row in others} == {"2e-5"} and ours[3] == "2e-6"
    assert "within 0.002 %, stribeck within 0.0002 %" in " ".join(readme.split())
