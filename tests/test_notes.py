"""Notes: said where the model leaves its range and it matters, and nowhere else."""

import json
import math
import re

import numpy as np
import pytest
from command_line import EXAMPLES, FEW, PDMS, call, case_text
from fit_data import TRUE, exact

import stribeck as sb
from stribeck.regimes.margins import RegimeMargins, regime_margins

SEAL = sb.load_case(EXAMPLES / "rod_seal.toml").contact.replace(cavitation="none")
"""A contact in a full film under Persson's law at load group 5.5."""

STIFF = {"modulus": '"5.4 GPa"', "load": '"60 kN/m"', "viscosity": '"100 Pa*s"'}
"""The PDMS cylinder with all pressures 2000 times as high, so that the groups stay."""


HARD_PREFIX = "Hard elastohydrodynamics:"
LAW_RANGE, MAX_HERTZ_PRESSURE = (0.4, 2.0), 50e6  # As docs/checks.md says them


def gap(solution):
    """Return the central gap in roughness heights."""
    contact = solution.contact
    return solution.central_gap * contact.hertz.indentation / contact.roughness


def matters(solution):
    """Tell whether asperities have more than 1 % of load or friction."""
    friction = solution.friction(definition="balanced")
    return max(solution.contact_load_share, friction.asperities / friction.total) > 0.01


@pytest.fixture(scope="module")
def pdms():
    return sb.stribeck_curve(TRUE, speed=("1 mm/s", "1 m/s"), points=21, rtol=1e-5)


@pytest.fixture
def no_scans(monkeypatch):
    """Leave out the search for the next regimes, which is no matter here and slow."""
    monkeypatch.setattr("stribeck.regimes.overview.regime_margins", lambda *_, **__: RegimeMargins("mixed", (), ()))


# --- the contact law ---


def test_a_gap_is_noted_above_the_range_while_asperities_matter_and_neither_inside_nor_beyond(pdms):
    said = [any("beyond the range of the exponential" in note for note in s.notes) for s in pdms.solutions]
    wanted = [gap(s) > LAW_RANGE[1] and matters(s) for s in pdms.solutions]
    assert said == wanted and any(said) and not said[0] and not said[-1]
    state = pdms.solutions[said.index(True)]
    [note] = [note for note in state.notes if "beyond" in note]
    assert f"{gap(state):.3g} h_rms" in note
    assert f"carry {100 * state.contact_load_share:.2g} % of the load" in note
    inside = sb.solve(TRUE)
    assert LAW_RANGE[0] < gap(inside) < 1 and inside.notes == ()


def test_the_minimum_of_the_demo_says_that_its_gap_is_beyond_the_range(pdms, capsys, no_scans):
    solution = pdms.minimum.solution
    friction = solution.friction()
    assert gap(solution) == pytest.approx(3.55, abs=0.01)
    assert friction.asperities / friction.total == pytest.approx(0.146, abs=0.001)
    [note] = pdms.minimum_notes
    assert pdms.notes[-1] == note
    assert "At the minimum of friction, speed 27.6 mm/s, the central gap is 3.5 h_rms, beyond the range" in note
    assert "asperities cause 15 % of the friction" in note
    assert note.endswith("the minimum is lower and at a lower speed (stribeck check says by how much).")
    assert note in call(capsys, "curve", PDMS, *FEW, "-v").out
    assert note in call(capsys, "regimes", PDMS, "-v").out


@pytest.mark.slow
def test_a_surface_with_fewer_high_asperities_has_its_minimum_a_fifth_lower():
    """Loads 0.1 and 1 at relative roughness 0.01, with the gaps of contact_laws.md: the numbers that page states."""
    law = sb.surfaces.persson_law(sb.surfaces.SelfAffine(h_rms=6e-6, q0=1e4, q1=1e6, hurst=0.8))
    rows = sb.contact_laws.TableLaw.read(EXAMPLES / "gfmd_mean_gap.csv")
    table = sb.contact_laws.TableLaw(law.alpha * np.array(rows.separation), np.array(rows.pressure) / law.beta)
    settings = {"speed": (0.01, 0.2), "points": 7, "boundary_friction": 0.7, "beta": law.beta, "rtol": 1e-5}

    def minimum(load, shape):
        found = sb.stribeck_curve(sb.Groups(0.0, load, 0.01 * load, law=shape), **settings).minimum
        return np.array([found.value, found.friction])

    for load, changes in ((0.1, (-0.207, -0.172)), (1.0, (-0.104, -0.063))):
        assert minimum(load, table) / minimum(load, None) - 1 == pytest.approx(changes, abs=1e-3)
    assert minimum(0.1, law) / minimum(0.1, None) == pytest.approx(1, abs=3e-3)  # the same tail


def test_the_minimum_of_groups_is_judged_by_the_friction_of_the_curve():
    def minimum(beta):
        return sb.stribeck_curve(
            load=0.1, roughness=1e-3, speed=(1e-3, 1.0), points=13, boundary_friction=0.7, beta=beta, rtol=1e-4
        )

    [note] = minimum(0.06).minimum_notes
    assert "h_rms at alpha = 2" in note
    assert minimum(10.0).minimum_notes == ()  # the fluid makes all of the friction there


def test_the_law_of_persson_has_the_same_tail_and_no_lower_end():
    fast = sb.solve(SEAL.replace(speed="1 m/s"), rtol=1e-4)
    assert gap(fast) > LAW_RANGE[1] and matters(fast)
    assert any("beyond the range of Persson's contact law (up to 2 h_rms)" in note for note in fast.notes)
    assert not any("beyond" in note for note in sb.solve(SEAL, rtol=1e-4).notes)
    gaussian = sb.solve(TRUE.replace(speed="30 mm/s", alpha=1.0, law=sb.contact_laws.GreenwoodTripp()), rtol=1e-4)
    assert gap(gaussian) > LAW_RANGE[1] and gaussian.notes == ()  # its tail is its own


def test_a_heavy_load_is_not_noted_where_the_fluid_carries_it():
    heavy = TRUE.replace(load=600.0)
    assert heavy.groups.load > 1
    touching, free = (sb.solve(heavy.replace(speed=speed), rtol=1e-4) for speed in (0.01, 30.0))
    assert matters(touching) and any("The load group is" in note for note in touching.notes)
    assert not matters(free) and not any("law" in note for note in free.notes)


# --- hard elastohydrodynamics ---


def test_a_hertz_pressure_that_makes_oil_stiff_is_noted_first_unless_the_fluid_stiffens():
    def notes(part, **changes):
        factor = part * MAX_HERTZ_PRESSURE / TRUE.hertz.pressure
        stiff = TRUE.replace(**{name: factor * getattr(TRUE, name) for name in ("modulus", "load", "viscosity")})
        return sb.solve(stiff.replace(speed="20 mm/s", **changes), rtol=1e-3).notes

    below, above, modelled = notes(0.99), notes(1.01), notes(1.01, fluid=sb.fluids.Barus("1 1/GPa"))
    assert len(above) > 1 and above[0].startswith(HARD_PREFIX)
    assert not any(note.startswith(HARD_PREFIX) for note in (*below, *modelled))


def test_steel_in_oil_reads_it_in_the_first_line_of_every_command(tmp_path, capsys, no_scans):
    path, data = tmp_path / "stiff.toml", tmp_path / "lab.csv"
    path.write_text(case_text(STIFF))
    rows = np.transpose(exact()).tolist()
    data.write_text("speed [m/s],friction\n" + "\n".join(f"{u!r},{f!r}" for u, f in rows))
    commands = (("solve", path), ("curve", path, *FEW), ("regimes", path), ("fit", data, path, "--free", "boundary_friction"))
    for tokens in commands:
        answer = call(capsys, *tokens)
        assert answer.code == 0
        assert answer.out.startswith(
            "Outside the range of the model: Hard elastohydrodynamics: the Hertz pressure is 102 MPa"
        ), tokens[0]
        assert answer.out.count(HARD_PREFIX) == 1
    assert json.loads(call(capsys, "solve", path, "--json").out)["notes"][0].startswith(HARD_PREFIX)


def test_over_the_load_the_first_note_is_that_of_the_pressure_too():
    """At light loads, where a curve begins, other notes come first."""
    stiff = TRUE.replace(modulus="5.4 GPa", viscosity="100 Pa*s", speed="20 mm/s")
    curve = sb.stribeck_curve(stiff, load=("4 kN/m", "60 kN/m"), points=5, rtol=1e-4)
    assert not any(note.startswith(HARD_PREFIX) for note in curve.solutions[0].notes) and curve.solutions[0].notes
    assert curve.notes[0].startswith(HARD_PREFIX)


# --- what can be reached ---


def test_no_advice_leaves_what_an_input_can_be():
    """A contact that would be hydrodynamic at speeds and a roughness that there are not."""
    steel = {"youngs_modulus": "210 GPa", "poisson_ratio": 0.3, "load": "202 N/mm", "viscosity": "1 mPa*s"}
    contact = TRUE.replace(**steel, radius="20 mm", beta=0.02, boundary_friction=0.12)
    highest = {"speed": 1e3, "roughness": contact.hertz.half_width}  # that of sound; not 866 mm, 43 times the radius
    for margin in regime_margins(contact, rtol=1e-4).margins:
        high = highest.get(margin.name, math.inf)
        assert margin.searched[1] <= high * (1 + 1e-9)
        assert all(mark is None or mark.value <= high for mark in (margin.less, margin.more))


def test_speed_and_viscosity_end_each_where_they_must():
    """One scan serves both: a speed that there is not may belong to a viscosity that there is."""
    thin = TRUE.replace(viscosity="1e-8 Pa*s", speed="1 m/s")
    speed, _, _, viscosity = regime_margins(thin, rtol=1e-4).margins
    assert speed.more is None and speed.searched[1] == pytest.approx(1e3)
    assert viscosity.more is not None and viscosity.more.value > 1e-5


# --- cavitation ---


def test_the_note_on_suction_says_what_cavitation_changes():
    [note] = [note for note in sb.solve(SEAL, rtol=1e-4).notes if "cavitates" in note]
    assert "9 to 20 % lower" in note and "boundary lubrication" in note


def test_weights_of_groups_alone_are_said():
    solution = sb.solve(sb.Groups(0.03, 0.1, 1e-3), rtol=1e-4)
    [note] = solution.notes
    dry, viscous = solution.contact_load_share, 0.05 * solution.observables.viscous_balanced
    assert (
        "h_rms at alpha = 2" in note and f"{100 * dry / (dry + viscous):.2g} % of the friction, at boundary friction 1" in note
    )
    assert math.isfinite(solution.central_gap) and np.isfinite(dry)


def test_notes_say_the_share_of_friction_that_asperities_have_in_rolling(subtests):
    cylinder = sb.load_case(PDMS).contact.replace(speed=0.015)
    same = {
        name: getattr(cylinder, name) for name in ("modulus", "viscosity", "roughness", "alpha", "beta", "boundary_friction")
    }
    for contact in (cylinder, sb.PointContact(radius="10 mm", load="1 N", speed="60 mm/s", **same)):
        for slide_to_roll in (2.0, 0.0):
            with subtests.test(kind=type(contact).__name__, slide_to_roll=slide_to_roll):
                state = sb.solve(contact.replace(slide_to_roll=slide_to_roll), rtol=1e-4)
                [note] = [note for note in state.notes if "cause" in note]
                assert float(re.findall(r"cause (\S+) %", note)[0]) == pytest.approx(
                    100 * state.friction.contact_share, rel=0.06
                )


def cause(notes):
    """Return the share of the friction that notes say asperities cause [-]."""
    [percent] = [share for note in notes for share in re.findall(r"cause (\S+) % of the friction", note)]
    return float(percent) / 100


def test_notes_say_the_share_of_the_friction_that_the_case_asks_for(capsys, tmp_path, no_scans):
    contact = sb.load_case(PDMS).contact.replace(slide_to_roll=0.01, boundary_friction=0.03, speed="15 mm/s")
    state = sb.solve(contact, rtol=1e-4)
    balanced, published = (state.friction(definition=each).contact_share for each in ("balanced", "published"))
    assert published < 0.91 * balanced and cause(state.notes) == pytest.approx(balanced, rel=0.04)
    path = tmp_path / "case.toml"
    text = PDMS.read_text().replace("[contact]", "[contact]\nslide_to_roll = 0.01")
    for name, value in (("boundary_friction", "0.03"), ("speed", '"15 mm/s"')):
        text = re.sub(f"(?m)^{name} .*$", f"{name} = {value}", text)
    path.write_text(text.replace('"balanced"', '"published"'))
    for command in ("solve", "regimes"):
        said = json.loads(call(capsys, command, path, "--json").out)
        assert cause(said["notes"][:1]) == pytest.approx(published, rel=0.04)
        [check] = [each for each in said["checks"] if each["name"] == "contact law at the centre"]
        assert cause([check["sentence"]]) == pytest.approx(published, rel=0.04)
    curve = sb.stribeck_curve(contact, speed=(0.015, 0.016), points=2, definition="published", rtol=1e-4)
    assert cause(curve.notes) == pytest.approx(published, rel=0.04)


def test_notes_of_groups_are_for_the_coefficients_given_in_json_too(capsys):
    words = ("solve", "--groups", "0.1", "0.1", "3e-3", "--boundary-friction", "0.01")
    said = json.loads(call(capsys, *words, "--json").out)
    assert cause(said["notes"]) == pytest.approx(said["friction_asperities"] / said["friction_balanced"], rel=0.06)
    assert f"cause {100 * cause(said['notes']):.2g} %" in call(capsys, *words, "-v").out


# --- suction that no film in the open bears ---

ATMOSPHERE = 101_325.0


def noted_suction(solution):
    return [note for note in solution.notes if "cavitate" in note]


def suction(solution):
    """Return how far the fluid pressure falls below the ambient, between the nodes too [Pa]."""
    found = solution.profile(np.linspace(-3.0, 3.0, 20_001)).fluid_pressure.min()
    return -float(found) * solution.contact.hertz.pressure


@pytest.mark.quick
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
                found = noted_suction(solution)
                assert len(found) == notes
                assert all(f"falls {atmospheres * ATMOSPHERE / 1e6:.3g} MPa below the ambient" in note for note in found)
            assert noted_suction(sb.solve(scaled.replace(speed=0.0))) == []
            assert noted_suction(sb.solve(scaled.groups)) == []


def test_a_ball_has_one_suction_in_note_and_check():
    """The note had that of the nodes, up to 1 % less than the check beside it."""
    contact = sb.load_case(EXAMPLES / "pdms_ball.toml").contact.replace(modulus="27 MPa", load="10 N", speed="1 m/s")
    state = sb.solve(contact, rtol=1e-3)
    [note] = noted_suction(state)
    assert state.largest_suction == pytest.approx(suction(state), rel=1e-4)
    assert f"falls {state.largest_suction / 1e6:.3g} MPa below the ambient" in note


@pytest.mark.quick
def test_a_curve_tells_once_from_where_on_the_suction_is_too_much():
    curve = sb.stribeck_curve(SEAL, speed=("1 mm/s", "1 m/s"), points=9, rtol=1e-4)
    [note] = [note for note in curve.notes if "cavitate" in note]
    count = sum(suction(solution) > ATMOSPHERE for solution in curve.solutions)
    assert 0 < count < 9 and f"({count} of 9 points, speed" in note
