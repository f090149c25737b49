"""Cold starts anywhere in the box that the package promises: none fails, and the estimates cover the errors.

The true error is measured on a mesh with more nodes on each panel and with panels much farther out, so that
it owes nothing to the choices of the solver.
"""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

import stribeck as sb
from stribeck import Outcome
from stribeck.contacts.groups import contact_law
from stribeck.equations.damping import longest_step
from stribeck.equations.gap import minimum_gap
from stribeck.equations.line import Equations
from stribeck.equations.observables import ROW, changes, observables
from stribeck.equations.operators import Operators
from stribeck.numerics.panels import Mesh
from stribeck.surfaces import SelfAffine, persson_law

SEED = 27_644_437
TYPICAL = {
    "mixed": (1e-5, 0.1, 1e-4),
    "hydrodynamic": (1.0, 0.1, 1e-4),
    "boundary": (1e-8, 0.1, 1e-2),
    "thin film": (1e-7, 0.1, 1e-6),
    "heavy": (1e-3, 3.0, 0.3),
    "smooth": (1e-6, 0.1, 0.0),
}


def box(number, seed):
    """Random groups: speed 1e-12 to 1e6, load 1e-8 to 10, relative roughness 1e-6 to 1e3, and zeros."""
    rng = np.random.default_rng(seed)
    for i in range(number):
        speed, load, kappa = 10 ** rng.uniform((-12, -8, -6), (6, 1, 3))
        if i % 12 == 5:
            speed = 0.0
        if i % 12 == 9:
            kappa = 0.0
        yield sb.Groups(speed, load, kappa * load)


@cache
def laws():
    s = np.linspace(0.05, 6.0, 40)
    return {
        "persson": persson_law(SelfAffine(h_rms=1e-6, q0=1e4, q1=1e9, hurst=0.8)),
        "narrow": persson_law(SelfAffine(h_rms=1e-6, q0=1e5, q1=1e6, hurst=0.5, roll_off=2e5), gamma=1.0),
        "greenwood-williamson": sb.contact_laws.GreenwoodWilliamson(),
        "greenwood-tripp": sb.contact_laws.GreenwoodTripp(),
        "table": sb.contact_laws.TableLaw(s, np.exp(-s) + 0.3 * np.exp(-3 * s)),
        "function": sb.contact_laws.FunctionLaw(lambda s: -s - np.log(s)),
    }


def under(name, number, seed):
    """Return random rough groups under a contact law."""
    return [replace(groups, law=laws()[name]) for groups in box(number, seed) if groups.roughness > 0]


def corners():
    """The ends of the box, where every extreme meets every other."""
    for speed in (0.0, 1e-12, 1e6):
        for load in (1e-8, 10.0):
            for kappa in (0.0, 1e-6, 1e3):
                if speed > 0 or kappa > 0:
                    yield sb.Groups(speed, load, kappa * load)


def largest_ratio(solution, errors):
    """Return the largest true over stated error; what is stated to be exact, as no asperities touch, is."""
    stated = np.array(list(solution.errors.values())[: len(errors)])
    assert not errors[stated == 0].any()
    return np.nanmax(errors[stated > 0] / stated[stated > 0])


def check(states, true_errors, rtol=1e-6):
    """Solve cold; return true over estimated errors, largest and single, and how many rounding bounds."""
    ratios, singles, bounded = [], [], 0
    for groups in states:
        s = sb.solve(groups, rtol=rtol)  # a failure raises
        assert s.outcome is Outcome.CONVERGED
        assert abs(s.contact_load_share + s.fluid_load_share - 1) < 1e-8, groups
        assert s.minimum_gap > 0 or groups.speed == 0
        assert s.error_estimate <= rtol
        errors = true_errors(s)
        ratios.append(np.nanmax(errors) / s.error_estimate)
        singles.append(largest_ratio(s, errors))
        noted = any(note.startswith("Rounding in double precision limits") for note in s.notes)
        assert noted == (s.rounding_floor > 0.1 * rtol)
        bounded += noted
        assert ratios[-1] < 10, (groups, dict(zip(s.errors, errors, strict=False)), s.error_estimate)
    return np.array(ratios), np.array(singles), bounded


@pytest.mark.quick
def test_errors_of_load_shares_are_absolute_and_others_relative(solved):
    s = solved(*TYPICAL["boundary"])
    assert s.errors["fluid_load_share"] < 1e-6  # of a share that is itself far smaller
    assert s.fluid_load_share < 1e-6
    # Drag counts relative to the larger of both walls.
    assert s.error_estimate == max(error for name, error in s.errors.items() if name != "viscous_upper")


@pytest.mark.quick
def test_what_a_small_change_of_a_state_does_to_its_observables_is_their_difference(subtests, solved):
    """Errors at the nodes become those of the observables in this way."""
    for name in ["mixed", "hydrodynamic", "boundary"]:
        with subtests.test(name=name):
            speed, load, roughness = TYPICAL[name]
            s = solved(speed, load, roughness)
            equations = Equations(Operators(s.mesh), speed, contact_law(sb.Groups(speed, load, roughness)), s.flux_gap**2)
            y = np.concatenate([s.nodal_gap, [s.offset, s.flux_gap]])
            size, x, rng = min(s.nodal_gap.min(), roughness / load), s.mesh.nodes, np.random.default_rng(45_389)
            for _ in range(4):
                centre, width = rng.uniform(-1, 1), rng.uniform(0.5, 1.5)
                gap = size * rng.normal() / (1 + ((x - centre) / width) ** 2)
                change = np.concatenate([gap, [rng.normal(), s.flux_gap * rng.normal()]])
                up, down = (observables(equations, y + step * change, load) for step in (1e-5, -1e-5))
                found = changes(equations, y, load, s.minimum_position, change)
                for each in s.errors:
                    difference = (getattr(up, each) - getattr(down, each)) / 2e-5
                    scale = np.abs(changes(equations, y, load, s.minimum_position, np.diag(change))[:, ROW[each]]).sum()
                    # The minimum gap answers at the node next to it.
                    allowed = 2e-2 if each == "minimum_gap" else 1e-5
                    assert abs(found[ROW[each]] - difference) <= allowed * scale + 1e-13, each


def dipped(x, lowest):
    """A positive gap with one narrow dip."""
    return (1 + x * x / 20) * (1 - 0.3 / (1 + ((x - lowest) / 0.05) ** 2))


@pytest.mark.quick
def test_the_minimum_gap_lies_between_the_nodes_and_on_whichever_panel_it_is(subtests):
    fine = Mesh(np.concatenate([-np.array([8.0, 4, 2]), np.linspace(-1.25, 1.25, 51), [2.0, 4, 8]]), 20)
    for lowest in [0.0, 0.013, 0.4999, 0.5, -0.77, 1.0]:
        with subtests.test(lowest=lowest):
            position, gap = minimum_gap(fine, dipped(fine.nodes, lowest))
            bounds = (lowest - 0.02, lowest + 0.02)
            exact = minimize_scalar(dipped, bounds=bounds, args=(lowest,), method="bounded", options={"xatol": 1e-10})
            assert (position, gap) == (pytest.approx(exact.x, abs=1e-6), pytest.approx(exact.fun, rel=1e-9))
    narrow = Mesh(np.array([-8.0, -4.0, -2.0, -1.0, 0.0, 0.25, 0.45, 0.5, 0.75, 1.0, 2.0, 4.0, 8.0]), 20)
    for lowest in [0.5001, 0.4499]:
        with subtests.test(lowest=lowest):
            gap = 1 + np.log1p((narrow.nodes - lowest) ** 2)
            assert 0.45 < narrow.nodes[np.argmin(gap)] < 0.5  # the neighbour has the minimum
            assert minimum_gap(narrow, gap) == (pytest.approx(lowest, abs=1e-7), pytest.approx(1.0, abs=1e-12))


@pytest.mark.quick
def test_a_part_of_any_step_keeps_the_gap_positive_and_the_contact_pressure_sane():
    law, rng, parts = contact_law(sb.Groups(1e-4, 0.1, 2e-4)), np.random.default_rng(SEED), []
    gap = 2e-3 * np.geomspace(1, 1e4, 60)
    before = law.log_pressure(gap)
    for size in 10.0 ** rng.uniform(-6, 4, 200):
        change = size * gap * rng.normal(size=gap.size)
        parts.append(longest_step(law, gap, change))
        after = law.log_pressure(moved := gap + parts[-1] * change)
        assert 0 < parts[-1] <= 1 and (moved >= 0.3 * gap * (1 - 1e-9)).all()
        assert (after <= np.maximum(before + 3, 2) + 1e-9).all() and (after >= before - 3 - 1e-9)[before > -7].all()
    assert min(parts) < 1e-2 and max(parts) == 1 == longest_step(law, gap, -1e-3 * gap)


def test_the_stated_errors_of_typical_states_cover_the_true_ones(solved, true_errors):
    ratios, singles = {}, {}
    for name, groups in TYPICAL.items():
        for rtol in (1e-3, 1e-9):
            s = solved(*groups, rtol=rtol)
            error = true_errors(s)
            assert s.error_estimate <= rtol
            assert error.max() <= rtol
            ratios[name, rtol] = error.max() / s.error_estimate
            singles[name, rtol] = largest_ratio(s, error)
    assert np.mean([ratio <= 1 for ratio in ratios.values()]) >= 0.85, ratios
    assert max(ratios.values()) < 10, ratios
    assert max(singles.values()) < 30, singles


def test_a_dozen_random_states_are_solved_and_their_errors_covered(true_errors):
    ratios, singles, _ = check(box(12, SEED), true_errors)
    assert len(ratios) == 12
    assert (ratios <= 1).mean() >= 0.95
    assert (singles <= 1).mean() >= 0.85
    assert singles.max() < 10


def test_the_corners_of_the_box_are_solved_and_their_errors_covered(true_errors):
    ratios, _, bounded = check(corners(), true_errors)
    assert len(ratios) == 16
    assert (ratios <= 1).mean() >= 0.9
    assert bounded <= 2  # the thinnest smooth films


def check_small_tolerance(states, true_errors):
    """Return whether errors are covered, for each state that reaches 1e-9 or says that rounding bounds it, and how many do."""
    covered, bounded = [], 0
    for groups in states:
        s = sb.solve(groups, rtol=1e-9, on_failure="return")
        error, stated = np.nanmax(true_errors(s)), max(s.error_estimate, 1e-11)
        assert s.outcome in (Outcome.CONVERGED, Outcome.ROUNDING)
        assert s.error_estimate <= 1e-9 or s.outcome is Outcome.ROUNDING
        bounded += s.outcome is Outcome.ROUNDING
        if error > stated:  # what it is compared with has the error that double precision leaves
            stated += sb.solve(groups, rtol=1e-11, on_failure="return").error_estimate
        covered.append(error <= stated)
        assert error <= 10 * stated, groups
    assert np.mean(covered) >= 0.95
    return bounded


@pytest.mark.parametrize(("number", "most"), [(12, 4), pytest.param(200, 67, marks=pytest.mark.slow)])
def test_random_states_reach_a_small_tolerance_or_say_that_rounding_bounds_it(true_errors, number, most):
    assert check_small_tolerance(box(number, SEED + 1), true_errors) <= most


@pytest.mark.slow
def test_five_hundred_random_states_are_solved_and_their_errors_covered(true_errors):
    ratios, singles, bounded = check(box(500, SEED + 2), true_errors)
    assert (ratios <= 1).mean() >= 0.95
    assert (singles <= 1).mean() >= 0.85
    assert bounded < 25


# --- under every contact law ---


def test_random_states_under_every_law_are_solved_and_their_errors_covered(subtests, true_errors):
    for number, name in enumerate(laws()):
        with subtests.test(name=name):
            assert (check(under(name, 2, SEED + 10 + number), true_errors)[0] <= 1).all()


@pytest.mark.slow
@pytest.mark.parametrize("name", list(laws()))
def test_a_hundred_random_states_under_every_law_are_solved_and_their_errors_covered(name, true_errors):
    assert (check(under(name, 100, SEED + 1), true_errors)[0] <= 1).mean() >= 0.95


@pytest.mark.slow
@pytest.mark.parametrize("name", list(laws()))
def test_random_states_under_every_law_reach_a_small_tolerance_or_say_that_rounding_bounds_it(name, true_errors):
    check_small_tolerance(under(name, 24, SEED + 2), true_errors)
