"""The friction of a state: its two parts, and the two definitions of its viscous part."""

import inspect

import pytest

import stribeck as sb
from stribeck import Case
from stribeck.contacts.friction import DEFINITIONS
from stribeck.curves.sensitivities import friction_sensitivities
from stribeck.explorer.inputs.inputs import Inputs
from stribeck.regimes.margins import regime_margins

MIXED = (1e-5, 0.1, 1e-4)


@pytest.mark.parametrize("definition", DEFINITIONS)
def test_friction_is_boundary_friction_times_load_share_and_beta_times_the_viscous_part(solved, definition):
    state = solved(*MIXED)
    unit, scaled = (state.friction(*coefficients, definition) for coefficients in ((1.0, 1.0), (0.5, 0.02)))
    assert scaled.contact == pytest.approx(0.5 * state.contact_load_share, rel=1e-15)
    assert scaled.viscous == pytest.approx(0.02 * unit.viscous, rel=1e-15)
    assert scaled.total == scaled.contact + scaled.viscous


def test_the_definitions_agree_where_asperities_carry_nothing_and_not_in_the_boundary_regime(solved):
    smooth, rough = solved(1e-4, 0.1, 0.0), solved(1e-8, 0.1, 1e-4)
    balanced, published = (smooth.friction(definition=d) for d in DEFINITIONS)
    assert published.viscous == pytest.approx(balanced.viscous, rel=1e-6)
    balanced, published = (rough.friction(definition=d) for d in DEFINITIONS)
    assert published.viscous == pytest.approx(70.55 * balanced.viscous, rel=1e-4)


OLD = {
    "a contact": lambda: sb.LineContact(radius="1 mm", friction_coefficient=0.7),
    "a contact from groups": lambda: sb.LineContact.from_groups(sb.Groups(1, 1, 1), friction_coefficient=0.7),
    "a curve": lambda: sb.stribeck_curve(load=0.1, roughness=1e-3, mu0=0.7),
    "the atlas": lambda: sb.atlas.friction(sb.Groups(1e-5, 0.1, 1e-4), mu0=0.7),
    "a diagram": lambda: sb.phase_diagram(mu0=0.7),
}


@pytest.mark.parametrize("call", OLD.values(), ids=OLD)
def test_a_former_name_of_the_boundary_friction_is_refused_with_the_present_one(call):
    with pytest.raises(sb.InputError, match=r"= 0\.7: this input is called boundary_friction; write boundary_friction = "):
        call()


def test_a_state_refuses_the_former_name_too(solved):
    with pytest.raises(sb.InputError, match="write boundary_friction"):
        solved(*MIXED).friction(mu0=0.5)


def test_friction_is_balanced_unless_the_published_one_is_asked_for(solved):
    state = solved(*MIXED)
    assert state.friction() == state.friction(definition="balanced") != state.friction(definition="published")
    assert sb.atlas.friction(state.groups) == sb.atlas.friction(state.groups, definition="balanced")
    batch = sb.solve_batch(sb.Groups([1e-5], 0.1, 1e-4))
    assert batch.friction() == batch.friction(definition="balanced")
    defaults = {
        function.__name__: inspect.signature(function).parameters["definition"].default
        for function in (sb.stribeck_curve, sb.phase_diagram, regime_margins, friction_sensitivities)
    }
    assert set(defaults.values()) == {"balanced"} == {Case.definition, Inputs.definition}, defaults


def test_the_former_name_of_the_published_friction_is_refused_with_the_present_one(solved):
    with pytest.raises(sb.InputError, match="The friction of the paper is called 'published'"):
        solved(*MIXED).friction(definition="paper")
