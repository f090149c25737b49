"""The note on suction that no film in the open bears: there where it is true, and nowhere else."""

import numpy as np
import pytest
from command_line import EXAMPLES, PDMS, call

import stribeck as sb

pytestmark = pytest.mark.quick

ATMOSPHERE = 101_325.0

SEAL = EXAMPLES / "rod_seal.toml"


def noted(solution):
    return [note for note in solution.notes if "cavitate" in note]


def suction(solution):
    """Return how far the fluid pressure falls below the ambient, between the nodes too [Pa]."""
    found = solution.profile(np.linspace(-3.0, 3.0, 20_001)).fluid_pressure.min()
    return -float(found) * solution.contact.hertz.pressure


def test_suction_above_an_atmosphere_is_noted_with_its_value(subtests):
    """All pressures are multiplied by one factor, so that the groups stay and the suction in Pa alone changes."""
    for atmospheres, notes in [(0.95, 0), (1.05, 1), (30.0, 1)]:
        with subtests.test(atmospheres=atmospheres, notes=notes):
            contact = sb.load_case(PDMS).contact.replace(speed="0.1 m/s")
            factor = atmospheres * ATMOSPHERE / suction(sb.solve(contact))
            names = ("modulus", "load", "viscosity")
            scaled = contact.replace(**{name: factor * getattr(contact, name) for name in names})
            assert scaled.groups.speed == pytest.approx(contact.groups.speed)
            for solution in (sb.solve(scaled), sb.solve(scaled, rtol=1e-5)):
                found = noted(solution)
                assert len(found) == notes
                assert all(f"falls {atmospheres * ATMOSPHERE / 1e6:.3g} MPa below the ambient" in note for note in found)
            assert noted(sb.solve(scaled.replace(speed=0.0))) == []
            assert noted(sb.solve(scaled.groups)) == []


def test_a_curve_tells_once_from_where_on():
    contact = sb.load_case(SEAL).contact.replace(cavitation="none")
    curve = sb.stribeck_curve(contact, speed=("1 mm/s", "1 m/s"), points=9, rtol=1e-4)
    [note] = [note for note in curve.notes if "cavitate" in note]
    count = sum(suction(solution) > ATMOSPHERE for solution in curve.solutions)
    assert 0 < count < 9 and f"({count} of 9 points, speed" in note


def test_the_command_prints_it(capsys, tmp_path):
    full = tmp_path / "full.toml"
    full.write_text(SEAL.read_text().replace('model = "exit"', 'model = "none"'))
    assert "Note: Behind the contact the fluid pressure falls 0.14" in call(capsys, "solve", full, "-v").out
    assert "cavitate" not in call(capsys, "solve", SEAL).out
    assert "cavitate" not in call(capsys, "solve", PDMS).out
