"""Films that end: states through `solve` against an independent solver, and what follows from their equations."""

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import stribeck as sb
from stribeck.contacts.model import Model
from stribeck.contacts.with_parts import with_parts
from stribeck.equations.cavities.fixed_cavity_length import FixedLengthEquations, solve_of_length
from stribeck.equations.cavities.fixed_exit import distance_to_flux_gap, solve_at_fixed_exit
from stribeck.equations.line import Coupled, Eliminated, Operators
from stribeck.equations.observables import ROW, changes, observables
from stribeck.equations.prediction import SeenFrom, extrapolate
from stribeck.equations.sensitivity import log_derivatives
from stribeck.fluids.cavitation import Cavitation
from stribeck.numerics.continuation import Steps, march
from stribeck.numerics.panels import Mesh
from stribeck.quantities.outputs import ALL_NAMES as NAMES
from stribeck.solver.cavities.cavity_length import _cavity_in_gap
from stribeck.solver.cold_start import first_path
from stribeck.solver.homotopy import _guess_at_zero_crossing, coarse_state
from stribeck.solver.neighbours import Neighbours
from stribeck.solver.path.corrector import Corrector
from stribeck.solver.refinement import RefinedState
from stribeck.solver.solve import solved_point

REFERENCE = json.loads((Path(__file__).parent / "data" / "fluids.json").read_text())
ENDING = Model(cavitation=Cavitation.EXIT)
COLUMNS = {
    "contact_load_share": "contact_share",
    "central_gap": "h0",
    "minimum_gap": "hmin",
    "flux_gap": "m",
    "exit_position": "xc",
    "viscous_balanced": "mu_traction_1",
    "viscous_upper": "mu_traction_2",
}


def differences(solution, row):
    """Return how far observables are from a row of the reference, relative but for shares and positions."""
    found = {}
    for name, column in COLUMNS.items():
        if row.get(column) is not None:
            scale = 1.0 if name == "contact_load_share" else max(abs(row[column]), name == "exit_position")
            found[name] = abs(getattr(solution, name) - row[column]) / scale
    return found


@pytest.mark.parametrize("row", REFERENCE["a_free_exit"], ids=lambda row: f"{row['speed']:g}-{row['kappa']:g}")
def test_a_film_that_ends_is_that_of_an_independent_solver(row):
    groups = sb.Groups(row["speed"], row["load"], row["kappa"] * row["load"], model=ENDING)
    solution = sb.solve(groups)
    assert max(differences(solution, row).values()) < 1e-6
    assert solution.error_estimate <= 1e-6


@pytest.mark.quick
def test_a_rigid_film_that_ends_is_that_of_the_textbook():
    solution = sb.solve(sb.Groups(1e6, 0.1, 0.0, model=ENDING))
    gap = solution.central_gap
    assert solution.exit_position / np.sqrt(2 * gap) == pytest.approx(0.47512992, rel=1e-5)
    assert solution.flux_gap / gap == pytest.approx(1.22574844, rel=1e-5)
    assert 3 * np.pi**2 / 4 * gap / 1e6 * 4 / np.pi == pytest.approx(2.44748424, rel=1e-5)


@pytest.mark.quick
def test_pressure_and_gradient_vanish_at_the_exit_and_the_cavity_is_at_ambient_pressure():
    solution = sb.solve(sb.Groups(1e-3, 0.1, 1e-4, model=ENDING))
    x_c = solution.exit_position
    behind = solution.profile(x_c + np.array([1e-6, 0.1, 1.0, 30.0])).fluid_pressure
    before = solution.profile(x_c - np.array([1e-3, 1e-4])).fluid_pressure
    assert not behind.any()
    assert 0 < before[1] < 0.015 * before[0]  # as the square of the distance
    assert solution.fluid_pressure.min() > -1e-9


@pytest.mark.quick
def test_the_deflection_by_a_pressure_that_ends_at_zero_is_its_integral():
    def pressure(x):
        return np.where(x < 0, x**2 / (1 + x**2) ** 2.5, 0.0)  # falls as |x|**-3 on one side alone

    edges = 2.0 ** np.arange(-4, 5)
    operators = Operators(Mesh(np.concatenate([-edges[::-1], [0.0], edges]), 12), ENDING)
    nodes = operators.mesh.nodes
    assert operators.weights @ pressure(nodes) == pytest.approx(1 / 3, abs=1e-13)
    cells = -np.concatenate([np.geomspace(1e6, 10, 50_001), np.linspace(10, 0, 100_001)[1:]])
    found = operators.deflection @ pressure(nodes)
    for k in (np.argmin(np.abs(nodes - x)) for x in (-100.0, -20.0, -1.0, 0.5, 30.0)):
        antiderivative = (cells - nodes[k]) * (np.log(np.abs(cells - nodes[k])) - 1)
        exact = -np.diff(antiderivative) @ pressure(0.5 * (cells[1:] + cells[:-1])) / np.pi
        assert found[k] == pytest.approx(exact, abs=2e-9)


@pytest.mark.parametrize("name", [name for name in NAMES if name != "minimum_gap"])
def test_gradients_of_the_observables_are_their_derivatives(name):
    groups = sb.Groups(1e-2, 0.1, 1e-3, model=ENDING)
    state = state_of(groups)
    at, rng = state.equations.layout, np.random.default_rng(71)
    change = np.empty_like(state.y)
    change[at.gap] = state.gap * np.cos(rng.uniform(1, 3) * np.arctan(state.mesh.nodes))
    change[at.numbers] = [0.3, 0.4 * state.flux_gap, 0.2]
    ahead, behind = (getattr(observables(state.equations, state.y + d * change, 0.1), name) for d in (1e-5, -1e-5))
    slope = (ahead - behind) / 2e-5
    if np.isnan(slope):
        assert name == "reformation_position"
        return
    assert changes(state.equations, state.y, 0.1, change)[ROW[name]] == pytest.approx(slope, rel=2e-4, abs=1e-9)


def state_of(groups):
    """Return the discrete state that a solve of the groups ends with."""
    return solved_point(groups, 1e-7).state


def test_a_thin_film_is_cut_where_its_pressure_falls_to_zero():
    """Cut at the next of evenly spaced places, the film ended beyond a layer that no mesh resolved, and nothing was found."""
    beyond = [sb.solve(sb.Groups(speed, 3.26e-6, 0.0, model=ENDING)).exit_position - 1 for speed in (1.2e-12, 2.2e-12)]
    assert math.log(beyond[1] / beyond[0]) / math.log(2.2 / 1.2) == pytest.approx(0.4, abs=1e-3)


def test_a_film_whose_first_mesh_is_too_fine_for_its_guess_comes_from_a_coarser_one():
    solution = sb.solve(sb.Groups(1.219360144469988, 6.268266254394199e-08, 0.0, model=ENDING), rtol=1e-8)
    assert solution.exit_position == pytest.approx(1.06349326, rel=1e-7)


@pytest.mark.slow
def test_random_cold_starts_of_films_that_end_are_solved_and_their_errors_covered():
    rng, missed, states = np.random.default_rng(20_261), 0, 200
    for _ in range(states):
        load = 10 ** rng.uniform(-8, 1)
        kappa = 0.0 if rng.random() < 0.15 else 10 ** rng.uniform(-6, 3)
        groups = sb.Groups(10 ** rng.uniform(-12, 6), load, kappa * load, model=ENDING)
        coarse, fine = sb.solve(groups), sb.solve(groups, rtol=1e-8, on_failure="return")
        values, exact = coarse.observables.array(False), fine.observables.array(False)
        scale = np.abs(exact)
        for name, least in (("contact_load_share", 1), ("fluid_load_share", 1), ("exit_position", 1), ("offset", 1e-3)):
            scale[ROW[name]] = max(least, scale[ROW[name]])
        ratio = np.abs(values - exact) / scale / (coarse.relative_errors + fine.relative_errors)
        missed += np.nanmax(ratio) > 1
        assert np.nanmax(ratio) < 30, groups
    assert missed <= 0.05 * states


@pytest.mark.parametrize(
    "keywords",
    [
        {"cavitation": "reform", "cavity_pressure": -0.01},
        {"fluid": sb.fluids.Barus(1.0)},
        {"fluid": sb.fluids.Carreau(0.02, 0.5)},
    ],
    ids=("cavity", "stiffening", "thinning"),
)
def test_derivatives_with_respect_to_the_groups_are_those_of_neighbouring_states(keywords):
    groups = sb.Groups(1e-4, 0.1, 1e-4)
    model = sb.solve(groups, **keywords).groups.model
    found = log_derivatives(solved_point(replace(groups, model=model), 1e-8).state)
    for column, name in enumerate(("speed", "load", "roughness")):
        pair = [
            sb.solve(replace(groups, model=model, **{name: getattr(groups, name) * factor}), rtol=1e-9, on_failure="return")
            for factor in (1.01, 1 / 1.01)
        ]
        for observable, slopes in found.items():
            slope = np.diff([getattr(s, observable) for s in pair[::-1]])[0] / (2 * np.log(1.01))
            assert slopes[column] == pytest.approx(slope, rel=2e-3, abs=1e-6)


def test_the_minimum_of_friction_of_a_film_that_ends_is_that_of_an_independent_solver():
    curve = sb.stribeck_curve(sb.Groups(1e-3, 0.1, 1e-4), speed=np.geomspace(3e-4, 3e-3, 5), cavitation="exit")
    speed, friction = REFERENCE["friction_minimum"]["0.1,0.001"]["free_exit"]
    assert curve.minimum.friction == pytest.approx(friction, rel=1e-6)
    assert curve.minimum.value == pytest.approx(speed, rel=1e-3)  # the minimum is flat


def test_a_cavity_closes_as_the_root_of_the_suction_that_is_too_large():
    """Close to the speed at which the film ceases to rupture, where no path from a film that ends leads."""
    parts = {"cavitation": "reform", "cavity_pressure": -0.0864869}
    lengths = []
    for speed in (4.895e-4, 4.925e-4, 5.0e-4):
        s = sb.solve(sb.Groups(speed, 0.21052, 3.4722e-3), **parts)
        lengths.append(s.reformation_position - s.exit_position)
    assert 0 < lengths[0] < 0.012
    squares = np.diff(np.square(lengths)) / np.diff([4.895e-4, 4.925e-4, 5.0e-4])
    assert squares[0] == pytest.approx(squares[1], rel=0.15)
    assert np.isnan(sb.solve(sb.Groups(4.87e-4, 0.21052, 3.4722e-3), **parts).exit_position)


def marched(speeds: np.ndarray) -> list[RefinedState]:
    """Return states with a free exit, each solved from those before it."""
    groups = with_parts(sb.Groups(1e-3, 0.1, 1e-4), cavitation="exit")
    neighbours = Neighbours(1e-6)
    return [neighbours.solved(replace(groups, speed=speed)) for speed in speeds.tolist()]


def test_an_exit_that_moves_through_the_contact_is_predicted_with_the_contact_where_it_is():
    """In the frame of the exit the edge of the contact moves: gaps were predicted wrong by 0.2 to 1.7 of themselves."""
    states = marched(np.geomspace(5e-5, 1e-5, 8))
    assert abs(states[-1].state.exit - states[0].state.exit) > 0.1
    assert max(point.state.prediction_error for point in states[4:]) < 0.05


def test_an_exit_that_crosses_a_sharp_edge_of_the_contact_is_followed():
    """The edge is narrower than what counted as near: 25 states where 7 serve; a fluid that thins was lost."""
    groups = with_parts(sb.Groups(1e-7, 0.1, 1e-6), cavitation="exit")

    def correct(s, history):
        return coarse_state(replace(groups, speed=math.exp(s)), extrapolate(history, s))

    begin, end = math.log(1e-7), math.log(1e-8)
    path = march(correct, begin, end, Steps(0.7, 2.0, 1e-3), history=[(begin, first_path(groups).states[-1])])
    assert path.outcome.ok
    assert len(path.states) < 12


def test_neighbours_with_an_exit_share_meshes_where_the_contact_is_resolved():
    """The panel behind the exit was asked, where nothing is read off: six meshes where two serve."""
    states = marched(np.geomspace(1e-1, 3e-3, 16))
    assert len({id(point.state.mesh) for point in states}) <= 4


@pytest.mark.parametrize("fluid", [None, sb.fluids.Barus(1.0)], ids=("plain", "stiffens"))
def test_a_cavity_of_given_length_has_the_pressure_at_which_that_length_is_found(fluid):
    parts = {} if fluid is None else {"fluid": fluid}
    groups = with_parts(sb.Groups(1e-2, 0.1, 1e-3), cavitation="reform", cavity_pressure=-0.05, **parts)
    state = solved_point(groups, 1e-9).state
    other = replace(groups, model=replace(groups.model, cavity_pressure=-0.04))
    found = solve_of_length(other, Operators(state.mesh, other.model), state, 1e-10, 8)
    assert found.outcome.ok
    assert found.groups.model.cavity_pressure == pytest.approx(-0.05, rel=1e-8)
    assert found.root.contraction < 0.05


def test_a_cavity_under_a_rigid_film_goes_with_the_square_root_of_the_speed():
    """Both its ends over the root of the gap; lost as long as steps moved the exit by a third of the contact at most."""
    found = []
    for speed, pressure in ((1e5, -1e-3 * np.sqrt(10)), (1e6, -1e-3)):
        state = sb.solve(sb.Groups(speed, 0.1, 0.0), cavitation="reform", cavity_pressure=pressure)
        ends = np.array([state.exit_position, state.reformation_position])
        found.append([*ends / np.sqrt(state.central_gap), state.flux_gap / state.central_gap])
    assert found[0] == pytest.approx(found[1], rel=3e-4)


def test_a_cavity_in_a_contact_of_asperities_lies_where_it_does_in_the_gap_of_the_full_film():
    """Begun at the largest suction, its ends were wrong by many times the width of the contact's edge: it was not found."""
    groups = sb.Groups(9.516133145241108e-11, 4.052e-06, 7.752547346308160e-12)
    full = solved_point(groups, 1e-6).state
    assert full.lowest_pressure < -2.7e-4
    guess, slope = _cavity_in_gap(with_parts(groups, cavitation="reform", cavity_pressure=-2.5e-4), full)
    assert slope < 0
    state = sb.solve(groups, cavitation="reform", cavity_pressure=-2.5e-4)
    # The gap of the full film puts them 0.004 to 0.01 behind, by its mesh, which hangs on rounding.
    assert guess.exit == pytest.approx(state.exit_position, abs=0.02)
    assert guess.exit + guess.reformation == pytest.approx(state.reformation_position, abs=0.02)
    assert guess.flux_gap == pytest.approx(state.flux_gap, rel=1e-3)
    assert _cavity_in_gap(with_parts(groups, cavitation="reform", cavity_pressure=-2.0), full) is None


@pytest.mark.parametrize("fluid", [None, sb.fluids.Barus(1.0)], ids=("plain", "stiffens"))
def test_a_film_of_given_exit_holds_all_but_the_end_and_points_to_the_free_exit(fluid):
    point = solved_point(with_parts(sb.Groups(1e-5, 0.1, 1e-3), cavitation="exit", fluid=fluid), 1e-6)
    free = point.state
    assert free is not None
    for moved in (-0.02, 0.02):
        held, step = solve_at_fixed_exit(point.groups, free.equations.operators, SeenFrom(free, free.exit + moved), 1e-9, 30)
        at, residual = held.equations.layout, held.equations.residual(held.y)
        assert held.root.outcome.ok
        assert held.exit == free.exit + moved
        assert np.abs(residual[: at.exit.start]).max() < 1e-8 < 1e-4 < abs(residual[at.exit.start])
        assert abs(step[at.exit.start] + moved) < 0.2 * abs(moved)


def test_the_exit_of_a_thin_film_is_sought_where_a_free_one_goes_to_and_fro():
    """Steps of an exit by a hundred times the width of the inlet: Newton's iteration took 100 and did not arrive."""
    groups = sb.Groups(3.7224e-9, 2.32711e-8, 2.96201e-14)
    path = first_path(groups)
    ending = replace(groups, model=ENDING)
    guess = _guess_at_zero_crossing(path.states[-1])
    state = coarse_state(ending, guess)
    assert state is not None
    assert state.outcome.ok
    assert abs(state.exit - guess.exit) > 0.05
    assert state.root.steps < 50
    fluid = sb.fluids.Fluid(sb.fluids.Carreau(0.00252452, 0.6052987, 0.00015806), sb.fluids.Barus(0.0693958))
    solution = sb.solve(groups, fluid=fluid, cavitation="exit", slide_to_roll=-2.34927)
    assert solution.error_estimate <= 1e-6
    assert solution.exit_position < state.exit - 0.2


def test_an_exit_is_sought_where_the_gap_grows_through_that_of_the_flux_not_at_infinity():
    """Behind that gap the gradient falls to zero at infinity too: Newton's step pointed there, away from the film."""
    groups = sb.Groups(2.710267970250662e-09, 1.0889806625813665, 0.029095843970784)
    guess = _guess_at_zero_crossing(first_path(groups).states[-1])
    state = coarse_state(replace(groups, model=ENDING), guess)
    assert state is not None
    assert state.outcome.ok
    assert state.exit < guess.exit - 0.2
    held, step = solve_at_fixed_exit(state.groups, state.equations.operators, SeenFrom(state, guess.exit), 1e-5, 30)
    assert held.root.outcome.ok
    assert step[held.equations.layout.exit.start] > 0 > distance_to_flux_gap(held) > 2 * (state.exit - guess.exit)
    held, _ = solve_at_fixed_exit(state.groups, state.equations.operators, SeenFrom(state, state.exit - 1e-3), 1e-5, 30)
    assert held.root.outcome.ok
    assert 0 < distance_to_flux_gap(held) < 0.01


def test_an_exit_on_which_coarse_meshes_disagree_is_that_of_finer_ones():
    """The mesh for the second state moved the exit by 2.5e-3.  Most of three seconds: the path."""
    groups = sb.Groups(3.2864459231650893e-12, 6.0577509390298845, 0.0010272258570624502, model=ENDING)
    assert sb.solve(groups, rtol=1e-4).exit_position == pytest.approx(0.913199, abs=2e-5)  # that of rtol = 1e-6


@pytest.mark.quick
@pytest.mark.parametrize("rtol", [1e-2, 1e-3])
def test_what_the_gap_misses_at_the_exit_is_in_the_error_of_its_place(rtol):
    """The nodes hold the exit to a 38th of what it is wrong by: most of it lies between them."""
    groups = with_parts(sb.Groups(1e-5, 0.1, 1e-4), cavitation="exit")
    coarse, exact = solved_point(groups, rtol), solved_point(groups, 1e-8)
    at_exit = NAMES.index("exit_position")
    wrong = abs(coarse.values.array()[at_exit] - exact.values.array()[at_exit])
    assert 1e-6 < wrong < coarse.estimate.discretisation[at_exit] < 100 * wrong


def test_an_exit_that_moves_through_a_contact_leaves_the_edge_of_its_asperities_in_the_prediction():
    states = []
    for speed in (1.2e-9, 1.1e-9, 1.0e-9):
        groups = with_parts(sb.Groups(speed, 0.02, 3.2e-7), cavitation="exit")
        states.append(solved_point(groups, 1e-4).state)
    *before, last = states
    predicted = extrapolate([(np.log(state.groups.speed), state) for state in before], np.log(last.groups.speed))
    assert before[0].exit - last.exit > 5e-3
    assert np.abs(predicted.log_gap(last.mesh) - np.log(last.gap)).max() < 0.3  # 1.2 in the frame of the exit


def test_a_film_that_ends_is_found_from_full_ones_before_suction_cut_their_path():
    """The path of the full film was lost at 1.05 of the speed asked for, where it had no use any more."""
    groups = sb.Groups(1.026949284796445e-12, 1.6285676358360341, 0.03818644482)
    path = first_path(with_parts(groups, cavitation="exit", solid=sb.solids.Layer(4.978420382416584, 0.5)))
    assert path.states[-1].exit == pytest.approx(0.56367, abs=1e-4)


@pytest.mark.parametrize(
    "parts",
    [
        {"cavitation": "exit"},
        {"cavitation": "exit", "viscosity": sb.fluids.Barus(0.8), "density": sb.fluids.DowsonHigginson(2.0)},
        {"cavitation": "reform", "cavity_pressure": -1e-3, "viscosity": sb.fluids.Barus(0.8)},
    ],
)
def test_steps_of_films_that_thin_and_end_remove_a_defect_in_every_row(parts):
    """The row of the exit takes the gradient at low rates, whose derivatives are others than those of G."""
    rest = dict(parts)
    fluid = sb.fluids.Fluid(sb.fluids.Carreau(0.5, 0.4), rest.pop("viscosity", None), rest.pop("density", None))
    state = first_path(with_parts(sb.Groups(1e-3, 0.1, 1e-3), fluid=fluid, slide_to_roll=0.5, **rest)).states[-1]
    equations, at = state.equations, state.equations.layout
    inverse, units = equations.inverse(state.y), equations.units(state.y)
    defect = np.zeros_like(state.y)
    defect[at.numbers] = 1e-3 * np.arange(1, 1 + at.size - at.numbers.start)
    step = 1e-6 * units * inverse(defect)
    change = (equations.residual(state.y + step) - equations.residual(state.y - step)) / 2e-6
    assert change[at.numbers] == pytest.approx(-defect[at.numbers], rel=1e-3)
    by_speed = (
        replace(equations, speed=state.groups.speed * np.exp(1e-5)).residual(state.y)
        - replace(equations, speed=state.groups.speed * np.exp(-1e-5)).residual(state.y)
    ) / 2e-5
    assert equations.parameter_derivative(state.y, "speed")[at.numbers] == pytest.approx(
        by_speed[at.numbers], rel=1e-5, abs=1e-8
    )


def test_a_rolling_film_whose_gradient_is_a_small_power_of_the_gap_is_solved():
    """With the condition G = 0 at the exit Newton's iteration went to and fro on the last panels; values are those of 1e-9."""
    fluid = sb.fluids.Carreau(0.3, 0.25)
    state = sb.solve(sb.Groups(1e-3, 1e-3, 0.0), fluid=fluid, slide_to_roll=0.0, cavitation="exit")
    assert state.exit_position == pytest.approx(1.0018496419, rel=1e-6)
    assert state.minimum_gap == pytest.approx(4.9363116961e-4, rel=1e-6)
    assert state.flux_gap == pytest.approx(6.6325771484e-4, rel=1e-6)


@pytest.mark.parametrize("length_is_given", [False, True])
def test_a_newton_step_is_the_same_with_the_pressure_eliminated_or_not(length_is_given):
    fluid = sb.fluids.Fluid(viscosity=sb.fluids.Barus(0.4), density=sb.fluids.DowsonHigginson(1.9))
    parts = {"cavitation": "reform", "cavity_pressure": -0.05, "fluid": fluid}
    state = solved_point(with_parts(sb.Groups(1e-2, 0.1, 1e-3), **parts), 1e-6).state
    equations = state.equations
    assert equations.operators.has_reformation
    if length_is_given:
        known = equations.operators, equations.speed, equations.law, equations.flux_scale
        equations = FixedLengthEquations(*known, state.cavity_stretch)
    residuals = np.random.default_rng(1).standard_normal(state.y.size)
    whole, eliminated = (inverse(equations, state.y)(residuals) for inverse in (Coupled, Eliminated))
    np.testing.assert_allclose(whole, eliminated, rtol=0, atol=1e-6 * np.abs(eliminated).max())


def test_a_compressible_liquid_forms_anew_behind_a_thin_film_too():
    fluid = sb.fluids.Fluid(viscosity=sb.fluids.Barus(0.4), density=sb.fluids.DowsonHigginson(1.9))
    groups, parts = sb.Groups(1.5e-7, 4e-4, 0.0), {"cavitation": "reform", "cavity_pressure": -1e-3, "fluid": fluid}
    state, closer = (sb.solve(groups, **parts, rtol=rtol) for rtol in (1e-5, 1e-6))
    exit_only = sb.solve(groups, cavitation="exit", fluid=fluid)
    assert state.exit_position > exit_only.exit_position
    assert state.minimum_gap == pytest.approx(exit_only.minimum_gap, rel=0.01)
    assert state.reformation_position == pytest.approx(closer.reformation_position, rel=1e-5)


@pytest.mark.parametrize(("entries", "kept"), [(0, False), (2e7, True)])
def test_a_mesh_that_is_left_gives_up_its_operators_beyond_the_memory_for_them(monkeypatch, entries, kept):
    monkeypatch.setattr("stribeck.solver.path.corrector.CACHED_ENTRIES", entries)
    first, second = (solved_point(sb.Groups(speed, 0.1, 1e-3), 1e-5) for speed in (1e-4, 1e-2))
    follower, operators = Corrector(1e-5), first.state.equations.operators
    before = operators.deflection
    follower._change_to(operators, first.fine)
    follower._change_to(second.state.equations.operators, second.fine)
    assert ("deflection" in vars(operators)) is kept
    np.testing.assert_array_equal(operators.deflection, before)
