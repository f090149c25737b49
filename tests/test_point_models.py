"""A ball with fluids and bodies beyond those of the article: flow, slopes, limits, and what is refused."""

import dataclasses
from pathlib import Path

import numpy as np
import pytest

import stribeck as sb
from stribeck import Groups
from stribeck.fluids import Barus, DowsonHigginson, PatirCheng
from stribeck.solids import Layer

EXAMPLES = Path(__file__).parents[1] / "examples"
MIXED = Groups(0.1, 1e-3, 1e-3, geometry="point")


def with_part(name, value, groups=MIXED, rtol=1e-6):
    return sb.solve(groups, rtol=rtol, **{name: value})


@pytest.mark.quick
def test_a_law_that_does_little_changes_a_state_in_proportion():
    plain = sb.solve(MIXED, rtol=1e-6).contact_load_share
    less, more = (plain - with_part("fluid", Barus(a)).contact_load_share for a in (0.01, 0.1))
    assert less == pytest.approx(5.86e-5, rel=0.02)
    assert np.log10(more / less) == pytest.approx(1.0, abs=0.01)


@pytest.mark.quick
def test_rough_flow_lifts_the_ball_and_goes_with_the_roughness():
    rough = with_part("flow_factors", PatirCheng(2.0))
    assert rough.contact_load_share == pytest.approx(0.9698562, abs=2e-6)
    assert rough.identity_error < 1e-7


@pytest.mark.quick
def test_a_thick_layer_is_a_half_space_but_for_the_third_power_of_its_thickness():
    groups = dataclasses.replace(MIXED, speed=0.01, roughness=1e-4)
    half_space = sb.solve(groups, rtol=1e-5).central_gap
    thick, thicker = (half_space - with_part("solid", Layer(d), groups, 1e-5).central_gap for d in (5.0, 10.0))
    assert np.log2(thick / thicker) == pytest.approx(3.0, abs=0.1)


@pytest.mark.slow
def test_at_rest_a_thin_layer_bears_the_load_as_springs_do():
    # p = (b**2 - r**2)/2 k with b**4 = 8 k/3.
    layer = Layer(0.3, 0.0)
    springs = 2 / np.pi * layer.layer_thickness
    found = with_part("solid", layer, Groups(0.0, 1e-3, 1e-5, geometry="point"), 1e-3).central_pressure
    assert found == pytest.approx(np.sqrt(8 * springs / 3) / (2 * springs), rel=5e-3)


def test_a_curve_over_the_load_passes_through_layers_that_need_other_panels():
    """Under less load the layer is thicker over the width of the contact: states had been read on the mesh of another one."""
    inputs = {"radius": 0.01, "modulus": 2.7e6, "load": 0.3, "viscosity": 0.05, "speed": 0.03, "roughness": 1e-6}
    contact = sb.PointContact(**inputs, alpha=2, beta=0.06, boundary_friction=0.7, solid=Layer(3e-3))
    curve = sb.stribeck_curve(contact, load=(0.1, 0.5), points=3, rtol=1e-2)
    found = [sb.solve(contact.replace(load=load), rtol=1e-3).friction().total for load in curve.values]
    assert curve.friction.total == pytest.approx(found, rel=1e-3)


def test_the_panels_lie_at_the_edge_on_the_layer():
    """The dry contact ends at 0.608 of the Hertz radius: with fine panels at that radius the equations were singular."""
    groups = Groups(1e-5, 0.1, 1e-4 * 0.1 ** (2 / 3), geometry="point")
    found = with_part("solid", Layer(0.2), groups, 1e-2)
    within, outside = (found.field(0.0, y) for y in (0.59, 0.63))
    assert within.fluid_pressure + within.contact_pressure > 0.2 > 0.01 > outside.fluid_pressure + outside.contact_pressure


@pytest.mark.slow  # a sharp rim on a thin layer: seven seconds
def test_a_lens_on_its_holder_is_solved_with_the_pressure_and_friction_that_the_page_of_balls_states():
    """The first mesh does not resolve the pressure at the rim: the equations on it had no regular solution."""
    lens = sb.load_case(EXAMPLES / "contact_lens.toml").contact
    free, held = (sb.solve(each, rtol=1e-2) for each in (lens, lens.replace(solid=Layer("0.1 mm"))))
    assert held.central_pressure / free.central_pressure == pytest.approx(2.25, abs=0.02)
    assert free.friction().total == pytest.approx(0.0027, abs=5e-5)
    assert held.friction().total == pytest.approx(0.0021, abs=5e-5)


@pytest.mark.quick
def test_what_a_ball_does_not_have_is_refused_by_name(subtests):
    for parts, sentence in [
        ({"flow_factors": PatirCheng(2.0, gamma=3)}, "flow_factors = patir-cheng: on a ball they must be those of isotropic"),
        ({"solid": Layer(0.01)}, "solid = bonded layer: its thickness is 0.01 of the Hertz radius"),
    ]:
        with subtests.test(parts=parts, sentence=sentence), pytest.raises(sb.InputError, match=sentence):
            sb.solve(MIXED, **parts)


@pytest.mark.quick
def test_a_ball_says_where_its_film_leaves_the_range_of_a_law(subtests):
    for groups, parts, said in [
        (Groups(1e-3, 0.1, 0.03, geometry="point"), {"flow_factors": PatirCheng(2.0)}, "fits above 0.5"),
        (Groups(0.1, 0.1, 1e-3, geometry="point"), {"fluid": DowsonHigginson(1.0, 1.34)}, "no liquid is stretched so far"),
    ]:
        with subtests.test(groups=groups, parts=parts, said=said):
            notes = sb.solve(groups, rtol=1e-2, **parts).notes
            assert [said in note for note in notes if note.startswith("The fluid leaves the range of its laws")] == [True]


@pytest.mark.quick
def test_a_film_that_reforms_names_the_tolerance_that_it_holds():
    found = sb.solve(MIXED, rtol=1e-3, cavitation="reform", cavity_pressure=-0.05)
    assert found.rtol == 2e-3
    assert "holds rtol = 0.002 at best" in found.notes[-1]


def test_contacts_hold_fluid_and_cavitation_and_friction_names_the_wake():
    ball = sb.PointContact(
        radius="10 mm", modulus="2 MPa", load="10 mN", viscosity="0.1 Pa*s", entrainment_speed="0.1 m/s", slide_to_roll=1.0,
        roughness="1 um", alpha=2.0, beta=0.1, boundary_friction=0.5, cavitation="exit", fluid=Barus("20 1/GPa"),
    )  # fmt: skip
    assert ball.groups.model.film.slide == 0.5
    assert ball.groups.model.film.viscosity.pressure_coefficient == pytest.approx(2e-8 * ball.hertz.pressure)
    solution = sb.solve(ball, rtol=1e-3)
    assert solution.fluid_pressure.min() >= 0.0
    assert any("streaks of liquid" in note for note in solution.notes)
    assert not any("at best" in note for note in solution.notes)
    friction = solution.friction()
    assert friction.error < 0.01 * friction
    assert ball.replace(cavitation="none", fluid="newtonian").groups.model.film.is_plain
