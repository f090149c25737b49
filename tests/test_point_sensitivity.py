"""Derivatives of a ball's observables with respect to its groups, by implicit differentiation, against states beside it."""

import math
from dataclasses import replace

import numpy as np
import pytest

import stribeck as sb
from stribeck.contacts.model import Model
from stribeck.curves.sensitivities import friction_sensitivities
from stribeck.fluids.cavitation import Cavitation
from stribeck.solver.point.sensitivity import GROUPS, state_derivatives
from stribeck.solver.point.solve import solve_cold, solve_from
from stribeck.surfaces import SelfAffine, persson_law

SURFACE = persson_law(SelfAffine(h_rms=1e-6, q0=3e4, q1=3e6, hurst=0.8))
STATES = {
    "mixed": sb.Groups(1e-3, 1e-2, 2e-4, geometry="point"),
    "persson": sb.Groups(1e-3, 10.0, 5e-2, geometry="point", law=SURFACE),
    "smooth": sb.Groups(1e-1, 1e-2, 0.0, geometry="point"),
}
STEP, RTOL = 0.01, 1e-4


@pytest.mark.parametrize("name", STATES)
def test_derivatives_of_the_observables_are_the_differences_of_states_beside(name):
    groups = STATES[name]
    state = solve_cold(groups, RTOL)
    found = state_derivatives(state)
    for column, group in enumerate(GROUPS):
        here = getattr(groups, group)
        if here == 0:
            assert all(change[column] == 0 for change in found.values())
            continue
        ends = [solve_from(state, replace(groups, **{group: here * math.exp(sign * STEP)}), RTOL) for sign in (1, -1)]
        for each in ("contact_load_share", "central_gap", "offset", "J_couette", "J_poiseuille", "J_pcx"):
            slope = (ends[0].values[each] - ends[1].values[each]) / (2 * STEP)
            allowed = 3e-4 * max(abs(slope), max(abs(c) for c in found[each])) + 1e-9
            assert found[each][column] == pytest.approx(slope, abs=allowed), (group, each)


def test_derivatives_need_no_kept_preconditioner():
    state = solve_cold(STATES["mixed"], 1e-3)
    fine = state.work.fine
    bare = replace(state, work=replace(state.work, fine=replace(fine, iterated=replace(fine.iterated, preconditioner=None))))
    kept, made = state_derivatives(state), state_derivatives(bare)
    for name in kept:
        np.testing.assert_allclose(made[name], kept[name], atol=1e-5 * np.abs(kept[name]).max())


def test_more_load_moves_shares_in_opposite_ways():
    found = state_derivatives(solve_cold(STATES["mixed"], 1e-3))
    np.testing.assert_allclose(found["contact_load_share"] + found["fluid_load_share"], 0, atol=1e-6)


MODELS = {
    "barus": {"fluid": sb.fluids.Barus("2e-7 1/Pa")},
    "flow": {"flow_factors": sb.fluids.PatirCheng()},
    "layer": {"solid": sb.solids.Layer("1 mm", 0.45)},
}


def ball_with(name):
    groups = sb.Groups(1e-2, 1e-2, 5e-4, geometry="point")
    contact = sb.PointContact.from_groups(
        groups, radius=0.01, modulus=1e6, viscosity=0.1, alpha=2.0, beta=0.1, boundary_friction=0.8, slide_to_roll=0.6
    )
    return contact.replace(**MODELS[name])


def slope_of_solved(contact, name):
    ends = [contact.replace(**{name: getattr(contact, name) * math.exp(step)}) for step in (STEP, -STEP)]
    more, less = (sb.solve(end, rtol=1e-6).friction().total for end in ends)
    return math.log(more / less) / (2 * STEP)


@pytest.mark.parametrize(
    ("model", "inputs"),
    [("barus", ("load", "modulus", "pressure_coefficient")), ("flow", ("roughness",))],
    ids=["barus", "flow factors"],
)
def test_what_moves_the_numbers_of_fluid_and_solid_moves_the_friction_through_them(model, inputs):
    contact = ball_with(model)
    _, found = friction_sensitivities(contact, rtol=1e-6)
    for name in inputs:
        assert found[name] == pytest.approx(slope_of_solved(contact, name), abs=3e-4), name


def test_at_fixed_groups_beta_moves_the_viscous_friction_by_its_closed_form():
    groups, step = sb.Groups(1e-2, 1e-2, 5e-4, geometry="point"), STEP
    given = {"radius": 0.01, "modulus": 1e6, "viscosity": 0.1, "alpha": 2.0, "boundary_friction": 0.8, "slide_to_roll": 0.6}
    here, more, less = (sb.PointContact.from_groups(groups, beta=0.1 * math.exp(sign * step), **given) for sign in (0, 1, -1))
    _, found = friction_sensitivities(here, rtol=1e-3)
    along = found["beta"] + 3 * found["load"] + 4 * found["speed"] + 2 * found["roughness"]  # as from_groups moves them
    ends = [sb.solve(each, rtol=1e-3).friction().total for each in (more, less)]
    slope = math.log(ends[0] / ends[1]) / (2 * step)
    assert slope > 1e-3 and along == pytest.approx(slope, rel=1e-2)


@pytest.mark.slow
@pytest.mark.parametrize("model", MODELS)
def test_sensitivities_of_balls_with_other_fluids_and_solids_are_those_of_solved_states(model):
    contact = ball_with(model)
    _, found = friction_sensitivities(contact, rtol=1e-6)
    for name in ("speed", "load", "modulus", "radius", "viscosity", "roughness", "alpha", "beta", "slide_to_roll"):
        assert found[name] == pytest.approx(slope_of_solved(contact, name), abs=5e-4), name


@pytest.mark.parametrize("cavity", [0.0, -0.01])
def test_where_the_film_breaks_derivatives_hold_the_torn_nodes(cavity):
    kind = Cavitation.REFORM if cavity else Cavitation.EXIT
    groups = sb.Groups(0.1, 1e-3, 1e-3, geometry="point", model=Model(cavitation=kind, cavity_pressure=cavity))
    state = solve_cold(groups, 1e-4)
    found = state_derivatives(state)
    for column, group in enumerate(GROUPS):
        here = getattr(groups, group)
        ends = [solve_from(state, replace(groups, **{group: here * math.exp(sign * 0.05)}), 1e-4) for sign in (1, -1)]
        for each in ("contact_load_share", "central_gap", "J_couette", "J_poiseuille", "J_pcx"):
            slope = (ends[0].values[each] - ends[1].values[each]) / 0.1
            allowed = (0.06 if cavity else 4e-3) * max(abs(c) for c in found[each])
            assert found[each][column] == pytest.approx(slope, abs=allowed), (group, each)
