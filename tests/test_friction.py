"""The friction of a state: its two parts, and the two definitions of its viscous part."""

import inspect

import pytest

import stribeck as sb
from stribeck import Case
from stribeck.regimes.margins import regime_margins

MIXED = (1e-5, 0.1, 1e-4)
DEFINITIONS = ("balanced", "published")


def test_the_definitions_agree_where_asperities_carry_nothing_and_not_in_the_boundary_regime(solved):
    smooth, rough = solved(1e-4, 0.1, 0.0), solved(1e-8, 0.1, 1e-4)
    balanced, published = (smooth.friction(definition=d) for d in DEFINITIONS)
    assert published.fluid == pytest.approx(balanced.fluid, rel=1e-6)
    balanced, published = (rough.friction(definition=d) for d in DEFINITIONS)
    assert published.fluid == pytest.approx(70.55 * balanced.fluid, rel=1e-4)


def test_friction_is_balanced_unless_the_published_one_is_asked_for(solved):
    state = solved(*MIXED)
    assert state.friction() == state.friction(definition="balanced") != state.friction(definition="published")
    assert sb.atlas.friction(state.groups) == sb.atlas.friction(state.groups, definition="balanced")
    batch = sb.solve_batch(sb.Groups([1e-5], 0.1, 1e-4))
    assert batch.friction() == batch.friction(definition="balanced")
    defaults = {
        function.__name__: inspect.signature(function).parameters["definition"].default
        for function in (sb.stribeck_curve, sb.phase_diagram, sb.check, sb.explain, sb.propagate, regime_margins)
    }
    assert set(defaults.values()) == {"balanced"} == {Case.definition}, defaults


def test_smooth_surfaces_leave_no_error_to_the_share_of_asperities():
    """An error of it, times a dry friction of which nothing acts, was 4e-6 of the friction of a state at rtol 1e-6."""
    contact = sb.LineContact(
        radius=0.01, modulus=2e6, load=100.0, viscosity=1e-3, speed=0.01, roughness=0, alpha=2, beta=0.1, boundary_friction=0.7
    )
    curve = sb.stribeck_curve(contact, speed=(0.01, 0.02), points=2)
    for state in (sb.solve(contact), curve.solutions[0]):
        assert state.errors["contact_load_share"] == state.contact_load_share == 0.0
        assert 0 < state.friction.relative_error <= 1e-6
    assert curve.friction.relative_error.max() <= 1e-6
    assert sb.solve(contact).to_dict()["contact_load_share_error"] == 0.0
    assert sb.solve(contact.replace(speed=0)).errors["contact_load_share"] > 0
