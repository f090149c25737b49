"""Regimes, the way to the next ones, and what moves friction: judged by cold solves beside them."""

import json
import math
import re

import pytest
from command_line import call, case_text
from fit_data import TRUE as CONTACT

import stribeck as sb
from stribeck.regimes.margins import regime_margins

REACH = 1e6  # Of a search for other regimes


def test_a_regime_is_named_by_the_shares_of_load_and_friction():
    shares = (0.0, 1.0), (0.05, 0.99), (0.051, 0.99), (0.99, 0.11), (0.99, 0.1), (0.04, 0.1)
    named = ["boundary", "boundary", "mixed", "mixed", "hydrodynamic", "hydrodynamic"]
    assert [sb.regime_of(fluid, contact) for fluid, contact in shares] == named


def test_a_substrate_that_is_overtaken_has_regimes_too():
    """Both parts of its friction are negative: its states had all counted as hydrodynamic, its errors had no bound."""
    overtaken = CONTACT.replace(slide_to_roll=-1.0)
    friction = sb.solve(overtaken).friction()
    assert friction.asperities < 0 and 0.9 < friction.contact_share < 1
    curve = sb.stribeck_curve(overtaken, points=5, rtol=1e-3)
    assert (curve.regimes[0], curve.regimes[-1]) == ("boundary", "hydrodynamic")
    begins = curve.landmark("asperities cause 10 % of the friction")
    assert begins.solution.friction().contact_share == pytest.approx(0.1, rel=1e-2)
    found = sb.propagate(overtaken, {"load": 0.3}, transitions=False)
    assert found.regimes["mixed"] > 0.9
    low, high = next(each for each in found.spreads if each.name == "friction").interval_95
    assert -1 < low < friction.total < high < 0


# --- the way to the next regime ---


def shares(contact, definition="balanced", rtol=1e-8):
    """Return regime, the fluid's share of the load and the asperities' share of the friction."""
    solution = sb.solve(contact, rtol=rtol)
    friction = solution.friction(definition=definition)
    part = friction.asperities / friction.total
    return sb.regime_of(solution.fluid_load_share, part), solution.fluid_load_share, part


def crossings(found):
    """Yield input, its present margin and each crossing."""
    for margin in found.margins:
        for mark in (margin.less, margin.more):
            if mark is not None:
                yield margin.name, mark


@pytest.fixture(scope="module")
def mixed():
    return regime_margins(CONTACT)


def test_a_curve_of_another_definition_gives_no_margins(mixed):
    curve = sb.stribeck_curve(CONTACT, points=2, rtol=1e-6, definition="published")
    speed, alone = (found.margins[0] for found in (regime_margins(CONTACT, curve=curve), mixed))
    assert speed.more.value == pytest.approx(alone.more.value, rel=1e-6)


def test_at_a_crossing_the_named_regime_begins(subtests):
    for changes, definition in [({}, "published"), ({"load": 2.0, "speed": 1e-2}, "balanced")]:
        with subtests.test(changes=changes, definition=definition):
            contact = CONTACT.replace(**changes)
            found = regime_margins(contact, definition=definition)
            assert found.regime == shares(contact, definition)[0]
            seen = list(crossings(found))
            assert len(seen) >= 3
            for name, mark in seen[::2]:
                value = getattr(contact, name)
                assert mark.factor == pytest.approx(mark.value / value, rel=1e-12)
                regime, fluid, part = shares(contact.replace(**{name: mark.value}), definition)
                bound = abs(part - 0.1) if "hydrodynamic" in (found.regime, mark.regime) else abs(fluid - 0.05)
                assert bound < 1e-7
                beyond = math.copysign(1e-4, mark.factor - 1)
                names = [shares(contact.replace(**{name: mark.value * math.exp(s)}), definition)[0] for s in (-beyond, beyond)]
                assert names == [found.regime, mark.regime]


def test_a_crossing_is_the_nearest(mixed):
    found = list(crossings(mixed))
    assert len(found) > 4
    for name, mark in found:
        for part in (0.4, 0.95):
            nearer = CONTACT.replace(**{name: getattr(CONTACT, name) * mark.factor**part})
            assert shares(nearer, rtol=1e-4)[0] == "mixed"


def test_a_mixed_contact_has_two_neighbours(mixed):
    assert (mixed.regime, mixed.targets) == ("mixed", ("boundary", "hydrodynamic"))
    speed, load, roughness, viscosity = mixed.margins
    assert [margin.name for margin in mixed.margins] == ["speed", "load", "roughness", "viscosity"]
    assert (speed.less.regime, speed.more.regime) == ("boundary", "hydrodynamic")
    assert (roughness.less.regime, roughness.more.regime) == ("hydrodynamic", "boundary")
    assert speed.crossing_into("boundary") is speed.less
    assert viscosity.more.factor == speed.more.factor
    assert viscosity.less.value == pytest.approx(speed.less.factor * CONTACT.viscosity)
    # Where no load leads on the range searched ends at load group one.
    assert load.crossing_into("boundary") is load.more is None
    assert CONTACT.replace(load=load.searched[1]).groups.load == pytest.approx(1.0)
    assert load.searched[0] == pytest.approx(load.less.value)


def test_a_hydrodynamic_contact_stays_so_however_fast():
    contact = CONTACT.replace(speed=1.0)
    speed, load, _, viscosity = regime_margins(contact).margins
    assert (speed.less.regime, speed.more) == ("mixed", None)
    assert load.less is None
    # Where asperities cause no friction that a number holds, and the film only grows, no more is searched.
    assert speed.searched[1] < 1e3 and contact.replace(load=load.searched[0]).groups.speed < 1e6  # where searches end
    for name, place, way in (("speed", speed.searched[1], 30.0), ("load", load.searched[0], 1 / 30)):
        found = [sb.solve(contact.replace(**{name: value})).friction().contact_share for value in (place, place * way)]
        assert 1e-16 > found[0] >= found[1]
    assert viscosity.searched[1] / contact.viscosity == pytest.approx(speed.searched[1])


def test_a_contact_on_the_threshold_is_said_to_stand_there(mixed):
    there = CONTACT.replace(speed=mixed.margins[0].more.value)
    found = regime_margins(there)
    other = {"mixed": "hydrodynamic", "hydrodynamic": "mixed"}[found.regime]
    assert found.notes == (f"The contact is at the threshold to {other} lubrication.",)
    assert found.margins[0].crossing_into(other).factor == pytest.approx(1, abs=1e-6)
    assert mixed.notes == ()


def test_at_rest_and_between_smooth_surfaces_margins_begin_where_a_regime_does():
    rest, smooth, both = (
        regime_margins(CONTACT.replace(**changes))
        for changes in ({"speed": 0}, {"roughness": 0}, {"speed": 0, "roughness": 0})
    )
    speed, *others = rest.margins
    assert (rest.regime, speed.less, speed.more.regime, speed.more.factor) == ("boundary", None, "mixed", math.inf)
    assert shares(CONTACT.replace(speed=speed.more.value))[1] == pytest.approx(0.05, abs=1e-7)
    assert all(margin.less is margin.more is None for margin in others)
    assert any("At zero speed" in note for note in rest.notes)
    assert repr(rest).splitlines()[0] == "RegimeMargins: boundary lubrication"
    assert repr(rest).splitlines()[1].startswith("To reach mixed lubrication: speed from zero to 3")
    assert "<p>To reach mixed lubrication" in rest._repr_html_()
    speed, load, roughness, _ = smooth.margins
    assert smooth.regime == "hydrodynamic"
    assert speed.less is speed.more is load.less is load.more is None
    assert roughness.more.regime == "mixed"
    assert shares(CONTACT.replace(roughness=roughness.more.value))[2] == pytest.approx(0.1, abs=1e-7)
    assert any("no boundary" in note for note in smooth.notes)
    assert (both.margins[0].more.regime, both.margins[0].more.value) == ("hydrodynamic", 0.0)
    assert shares(CONTACT.replace(speed=1e-9, roughness=0))[0] == "hydrodynamic"


def test_a_saturated_contact_at_rest_leaves_boundary_lubrication_as_soon_as_it_moves():
    # From load group 1 on asperities cannot carry the load at a positive gap.
    contact = CONTACT.replace(load=1200.0, speed=0, roughness=1e-5)
    found = regime_margins(contact)
    assert (found.margins[0].more.regime, found.margins[0].more.value) == ("mixed", 0.0)
    assert any("load groups of 1 or more" in note for note in found.notes)
    assert shares(contact.replace(speed=1e-5))[0] == "mixed"


def test_without_dry_friction_nothing_leads_on():
    found = regime_margins(CONTACT.replace(boundary_friction=0))
    assert found.regime == "hydrodynamic" and list(crossings(found)) == []
    assert any("Without dry friction" in note for note in found.notes)


def test_an_interruption_of_the_search_is_passed_on_and_bad_input_refused():
    def stop(done, scans):
        if done == 1:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        regime_margins(CONTACT, on_point=stop)
    for contact, settings in [(CONTACT.groups, {}), (CONTACT, {"rtol": 1.0}), (CONTACT, {"definition": "mine"})]:
        with pytest.raises(sb.InputError):
            regime_margins(contact, **settings)


# --- in words and as JSON ---


def command(capsys, tmp_path, *options, **changes):
    """Return what ``stribeck regimes`` prints for the contact above with some inputs changed."""
    path = tmp_path / "case.toml"
    path.write_text(case_text({name: repr(value) for name, value in CONTACT.replace(**changes).inputs()}))
    answer = call(capsys, "regimes", path, *options)
    assert answer.code == 0
    return answer.out


def test_the_command_says_what_it_takes_to_reach_each_neighbour(capsys, tmp_path, monkeypatch):
    monkeypatch.setenv("COLUMNS", "200")
    text = command(capsys, tmp_path, "-v")
    assert (
        "To reach boundary lubrication: speed / 2.72 (to 367.9 µm/s), or roughness x 1.68 (to 1.679 µm), or "
        "viscosity / 2.72 (to 18.39 mPa*s); "
        "not reachable by changing load (range searched 7.99 mN/m to 305 N/m)." in text
    )
    assert (
        "To reach hydrodynamic lubrication: speed x 30.5 (to 30.46 mm/s), or load / 3750 (to 7.994 mN/m), or roughness" in text
    )
    assert "Only the product of speed and viscosity matters" in text
    assert "95 %:" not in text  # no input has an error
    rows = {line.split("  ")[0].strip() for line in text.splitlines()}
    assert {"speed", "load", "viscosity", "effective modulus", "radius", "roughness", "dry friction coefficient"} <= rows
    assert {"contact-law alpha", "contact-law beta"} <= rows


def test_all_outputs_judge_the_regime_by_the_definition_of_the_case(subtests, capsys, tmp_path):
    """``solve -v`` and JSON took the balanced one, and a surface that nearly rolls had two regimes."""
    path = tmp_path / "case.toml"
    for definition, regime in (("balanced", "mixed"), ("published", "hydrodynamic")):
        with subtests.test(definition=definition):
            path.write_text(case_text({"slide_to_roll": "2.5e-6"}, solver={"definition": f'"{definition}"'}))
            found = json.loads(call(capsys, "solve", path, "--json").out)
            assert (found["definition"], found["regime"]) == (definition, regime)
            assert f"{regime.capitalize()} lubrication at" in call(capsys, "solve", path).out
            assert f"\nRegime: {regime}.\n" in call(capsys, "solve", path, "-v").out


def test_the_command_has_words_for_the_corners(subtests, capsys, tmp_path):
    only_speed = "speed from zero to 367.9 µm/s; not reachable by changing load, roughness, viscosity."
    for changes, sentence in [
        ({"speed": 0.0}, f"To reach mixed lubrication: {only_speed}"),
        ({"speed": 0.0, "roughness": 0.0}, "To reach hydrodynamic lubrication: speed to any value above zero"),
    ]:
        with subtests.test(changes=changes):
            text = command(capsys, tmp_path, "-v", **changes)
            assert sentence in text
            assert ("Speed and viscosity" in text) == bool(re.search("viscosity [x/]", text))


def moved_by(capsys, tmp_path, error=0.01):
    """Return by which power the speeds of other regimes move with the roughness, from their intervals."""
    path = tmp_path / "case.toml"
    values = {name: repr(value) for name, value in CONTACT.replace(speed="5 mm/s").inputs()}
    path.write_text(case_text(values | {"roughness": f'"{CONTACT.roughness!r} m +- {100 * error} %"'}))
    found = json.loads(call(capsys, "regimes", path, "--json").out)["margins"]
    width = 2 * 1.959964 * math.sqrt(math.log1p(error**2))
    marks = {(name, mark["regime"]): mark for name, each in found.items() for mark in (each["less"], each["more"]) if mark}
    return {key: math.log(mark["interval_95"][1] / mark["interval_95"][0]) / width for key, mark in marks.items()}


@pytest.mark.slow
def test_the_interval_of_a_margin_is_that_of_transitions_solved_again(capsys, tmp_path):
    found = moved_by(capsys, tmp_path)
    curves = [
        sb.stribeck_curve(
            CONTACT.replace(roughness=CONTACT.roughness * math.exp(step)), speed=("0.1 mm/s", "0.1 m/s"), points=3, rtol=1e-5
        )
        for step in (-0.02, 0.02)
    ]
    for mark, regime in (("hydrodynamic_start", "hydrodynamic"), ("boundary_end", "boundary")):
        low, high = (curve.landmark(mark).value for curve in curves)
        expected = abs(math.log(high / low)) / 0.04
        assert found["speed", regime] == pytest.approx(expected, rel=1e-2, abs=1e-3)


@pytest.mark.slow
def test_margins_and_transitions_move_alike_with_correlated_errors(capsys, tmp_path):
    path = tmp_path / "case.toml"
    values = {name: repr(value) for name, value in CONTACT.replace(speed="5 mm/s").inputs()}
    errors = {name: f'"{getattr(CONTACT, name)!r} +- 5 %"' for name in ("alpha", "beta")}
    path.write_text(case_text(values | errors, correlations={"alpha": "{ beta = 0.9 }"}))
    found = json.loads(call(capsys, "regimes", path, "--json").out)
    low, high = found["margins"]["speed"]["more"]["interval_95"]
    [mark] = [each for each in found["uncertainty"]["spreads"] if "10 %" in each["name"]]
    assert math.log(high / low) == pytest.approx(math.log(mark["interval_95"][1] / mark["interval_95"][0]), rel=0.03)


@pytest.mark.quick
def test_margins_with_errors_say_their_interval_in_the_sentence(capsys, tmp_path):
    path = tmp_path / "case.toml"
    path.write_text(case_text({"speed": '"1 mm/s +- 10 %"'}))
    said = " ".join(call(capsys, "regimes", path, "-v").out.split())
    reached = said[said.index("To reach hydrodynamic") :]
    assert re.match(
        r"To reach hydrodynamic lubrication: speed x 30\.\d+ \(to 30\.\d+ mm/s; 95 %: 2\d\.?\d* to 3\d", reached[:90]
    )
    assert "Intervals count the errors of speed; radius, effective modulus, " in said


@pytest.mark.slow
def test_viscosity_has_no_margin_where_speed_does_not_stand_for_it(subtests):
    """Those of a viscoelastic body had been taken from the speed, although its Deborah number does not follow viscosity."""
    for part in ({"fluid": sb.fluids.Carreau("1 ms", 0.5)}, {"solid": sb.solids.StandardLinearSolid("10 ms", 3.0)}):
        with subtests.test(**part):
            found = regime_margins(CONTACT.replace(speed="20 mm/s", **part), rtol=1e-2)
            assert [margin.name for margin in found.margins] == ["speed", "load", "roughness"]
            assert any("Viscosity has no margins" in note for note in found.notes)


@pytest.mark.slow
def test_load_has_no_margin_where_the_contact_grows_in_its_own_way():
    """That of a lip had followed the series of a parabola, to where asperities cause 14 % of the friction, not 10 %."""
    lip = CONTACT.replace(profile=sb.profiles.Lip(0.35, 0.7, "50 um"), cavitation="exit")
    found = regime_margins(lip, rtol=1e-2)
    assert [margin.name for margin in found.margins] == ["speed", "roughness", "viscosity"]
    assert any("Load has no margins" in note for note in found.notes)


def test_a_margin_of_the_roughness_of_a_spectrum_says_that_it_keeps_beta(mixed):
    law = sb.surfaces.persson_law(sb.surfaces.SelfAffine(h_rms=1e-6, q0=4e4, q1=4e6, hurst=0.8))
    found = regime_margins(CONTACT.replace(law=law, **law.coefficients), rtol=1e-2)
    assert any("roughness keep beta" in note for note in found.notes)
    assert not any("beta" in note for note in mixed.notes)


@pytest.mark.slow
def test_slow_speeds_at_which_the_fluid_keeps_its_share_are_not_searched():
    heavy = CONTACT.replace(load="600 N/m")
    assert heavy.groups.load > 1
    speed = regime_margins(heavy, rtol=1e-3).margins[0]
    slowest = speed.searched[0]
    assert speed.less is None and heavy.speed / 10 > slowest > 10 * heavy.speed / REACH
    beyond = [sb.solve(heavy.replace(speed=slowest / factor), rtol=1e-3).fluid_load_share for factor in (1, 10, 1000)]
    assert beyond[0] > beyond[1] > beyond[2] > 1.5 * 0.05


def test_margins_are_a_dataset(mixed):
    pytest.importorskip("xarray")
    data = mixed.to_dataset()
    rows = zip(*(data[name].values.tolist() for name in ("input", "next_regime", "value")), strict=True)
    assert {(name, regime): value for name, regime, value in rows} == {
        (name, mark.regime): mark.value for name, mark in crossings(mixed)
    }
    units = {*zip(data.input.values.tolist(), data.unit.values.tolist(), strict=True)}
    assert units <= {("speed", "m/s"), ("load", "N/m"), ("roughness", "m"), ("viscosity", "Pa s")}
    assert data.attrs["regime"] == mixed.regime
