"""What is said beside numbers: notes with the coefficients that were given, what an interval counts, and what was searched."""

import re

import pytest
from command_line import EXAMPLES, call

import stribeck as sb

FAR = ("3e-2", "0.1", "1e-3")
"""Groups of a film beyond the range of the exponential law, while asperities still cause friction."""


def test_notes_of_groups_take_the_coefficients_that_were_given(subtests, capsys):
    for mu, beta in [(0.05, 1.0), (1.0, 0.02)]:
        with subtests.test(mu=mu, beta=beta):
            answer = call(capsys, "solve", "--groups", *FAR, "--boundary-friction", str(mu), "--beta", str(beta), "-v")
            text = " ".join(answer.out.split())
            solution = sb.solve(sb.Groups(*map(float, FAR)))
            share = 100 * solution.friction(mu, beta).contact_share
            said = float(re.search(r"cause ([0-9.e-]+) % of the friction", text)[1])
            assert said == pytest.approx(share, rel=0.02) and "at boundary friction 1" not in text
            curve = sb.stribeck_curve(
                load=0.1, roughness=1e-3, speed=(3e-2, 3.1e-2), points=2, boundary_friction=mu, beta=beta
            )
            [told] = [float(each) for note in curve.notes for each in re.findall(r"cause ([0-9.e-]+) % of the friction", note)]
            assert told == pytest.approx(share, rel=0.02)


def test_an_interval_says_which_inputs_count_as_exact(capsys):
    contact = sb.load_case(EXAMPLES / "pdms_cylinder.toml").contact
    found = sb.propagate(contact, {"roughness": 0.1, "modulus": 0.1}, transitions=False)
    said = str(found)
    assert "Intervals count the errors of effective modulus and roughness as independent; " in said
    for label in ("radius", "load", "contact-law beta", "dry friction coefficient", "viscosity"):
        assert label in said.split("; ")[-1].split("count as exact")[0], label
    others = {name: 0.1 for name, _ in contact.inputs() if name != "speed"}
    assert "; speed counts as exact." in str(sb.propagate(contact, others, transitions=False))
    surface = sb.load_case(EXAMPLES / "rod_seal.toml").contact
    assert "beta" not in str(sb.propagate(surface, {"roughness": 0.1}, transitions=False)).split("count as exact")[0]


@pytest.mark.slow
def test_transitions_beyond_the_speeds_that_were_searched_are_not_told():
    contact = sb.load_case(EXAMPLES / "pdms_cylinder.toml").contact
    curve = sb.stribeck_curve(contact, points=5, rtol=1e-3)
    names = {mark.name for mark in curve.transitions}
    sure = {each.name for each in sb.propagate(contact, {"roughness": 0.05}).spreads}
    assert names <= sure
    spread = sb.propagate(contact, {"roughness": 2.0, "beta": 2.0}).spreads
    told = [each for each in spread if each.name in names]
    assert len(told) < len(names)
    assert all(curve.values[0] <= each.interval_95[0] and each.interval_95[1] <= curve.values[-1] for each in told)


CURVED = {
    "layer": ({"solid": sb.solids.Layer("2 mm")}, {"roughness": 0.3, "modulus": 0.2, "beta": 0.3}, (0.030398, 0.104879)),
    "Carreau that ends": (
        {"fluid": sb.fluids.Carreau("1 ms", 0.5), "cavitation": "exit"},
        {"relaxation_time": 0.5, "roughness": 0.2, "viscosity": 0.2, "load": 0.1},
        (0.035525, 0.356099),
    ),
}
"""Contacts near the minimum of friction, where it is curved, with errors, and the ends by 3000 solved states."""


@pytest.mark.parametrize("name", ["layer", pytest.param("Carreau that ends", marks=pytest.mark.slow)])
def test_the_interval_of_a_curved_friction_ends_where_thousands_of_solved_states_have_it(name):
    parts, errors, (low, high) = CURVED[name]
    contact = sb.load_case(EXAMPLES / "pdms_cylinder.toml").contact.replace(speed="30 mm/s", **parts)
    found = sb.propagate(contact, errors, transitions=False)["friction"].interval_95
    # The ends of 3000 draws scatter by 2 % of the width themselves.
    assert abs(found[0] - low) <= 0.07 * (high - low) and abs(found[1] - high) <= 0.07 * (high - low)


@pytest.mark.slow
def test_an_interval_that_solved_states_do_not_settle_says_so():
    contact = sb.load_case(EXAMPLES / "pdms_cylinder.toml").contact.replace(speed="30 mm/s")
    found = sb.propagate(contact, {"speed": 2.9, "load": 2.9, "roughness": 2.9, "viscosity": 2.9}, transitions=False)
    (note,) = found.notes
    assert "is not settled" in note and note in str(found) and note in found._repr_html_()
    assert found.to_dict()["notes"] == [note]
    assert sb.propagate(contact, {"load": 0.05}, transitions=False).notes == ()


def test_samples_that_cannot_be_solved_are_counted_and_end_nothing():
    fluid = sb.fluids.Carreau("1 ms", 0.55)
    contact = sb.load_case(EXAMPLES / "pdms_cylinder.toml").contact.replace(speed="30 mm/s", fluid=fluid)
    found = sb.propagate(contact, {"exponent": 0.3, "load": 0.1}, transitions=False)  # two in a hundred lie above 1
    assert any("cannot be solved" in note for note in found.notes)
    low, high = found["friction"].interval_95
    assert 0 < low < high < 1


def test_what_is_free_is_a_list_of_inputs(subtests):
    for free in [True, "roughness"]:
        with subtests.test(free=free):
            data, case = EXAMPLES / "pdms_measured.csv", EXAMPLES / "pdms_fit.toml"
            with pytest.raises(sb.InputError, match="free = .* must be a list of inputs"):
                sb.fit(data, case, free=free, intervals=False)
