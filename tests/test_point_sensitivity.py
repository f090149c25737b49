"""Derivatives of a ball's observables with respect to its groups, by implicit differentiation, against states beside it."""

import math
from dataclasses import replace

import numpy as np
import pytest

import stribeck as sb
from stribeck.contact_laws.persson import persson_law
from stribeck.contact_laws.spectrum import SelfAffine
from stribeck.equations.point.sensitivity import GROUPS
from stribeck.solver.point.sensitivity import state_derivatives
from stribeck.solver.point.solve import solve_cold, solve_from

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
