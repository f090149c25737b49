"""Viscoelastic and combined solids: memory, hysteresis friction, dry contacts against an independent solver."""

import math
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from fit_data import TRUE
from scipy.integrate import quad, trapezoid
from test_model_parts import REFERENCE, observed

import stribeck as sb
from stribeck.contacts.groups import contact_law
from stribeck.contacts.model import Model
from stribeck.equations.line import LOAD
from stribeck.equations.operators import Operators, OperatorsOfRows
from stribeck.equations.state import mesh_for, solve_state
from stribeck.numerics.panels import Mesh
from stribeck.solids import HalfPlane, Layer, Prony, StandardLinearSolid, TwoBodies, hysteresis_friction
from stribeck.solids import layer as bonded
from stribeck.solids.layer import KERNEL_RADIUS, smooth_kernel
from stribeck.solids.viscoelastic import Memory, creep_of_relaxation
from stribeck.solver.cold_start import cold_start

FINE = Mesh(np.concatenate([[-256, -128, -64, -32, -16, -8], np.arange(-4, 4.01, 0.125), [8, 16, 32, 64, 128, 256.0]]), 12)
PDMS = Path(__file__).parents[1] / "examples" / "pdms_cylinder.toml"
DRY = REFERENCE["g_standard_linear_solid_dry"]["rows"]


def bump(x, width=0.3):
    return np.exp(-((x / width) ** 2))


def remembered(pressure, deborah):
    return Memory(FINE, np.array([deborah]))(pressure[None])[0]


@pytest.mark.quick
def test_the_memory_is_the_exponential_mean_of_what_has_passed(subtests):
    for deborah in [0.03, 0.3, 3.0]:
        with subtests.test(deborah=deborah):
            found = remembered(bump(FINE.nodes), deborah)
            x = np.array([-0.5, 0.0, 0.3, 1.0, 6.0])
            age, weights = np.polynomial.legendre.leggauss(2000)
            age, weights = 20 * (1 + age) * deborah, 20 * weights
            expected = [np.sum(weights * np.exp(-age / deborah) * bump(each - age)) for each in x]
            np.testing.assert_allclose(FINE.interpolate(found, x), expected, atol=1e-9)
            assert FINE.weights @ found == pytest.approx(FINE.weights @ bump(FINE.nodes), rel=1e-9)  # the load is kept


SINGULAR_BY_COLLOCATION = 256 / 16.868016151387604
"""Deborah number at which collocation of ``De q' + q = p`` beyond 256 half-widths is singular on twelve nodes."""


@pytest.mark.quick
def test_memory_of_a_pressure_that_reaches_to_infinity(subtests):
    for deborah in [1.0, SINGULAR_BY_COLLOCATION]:
        with subtests.test(deborah=deborah):
            found = remembered(1 / (1 + FINE.nodes**2), deborah)
            nodes, weights = np.polynomial.legendre.leggauss(10)
            age = np.add.outer(np.arange(400), 0.5 * (1 + nodes)).ravel() / 10  # 400 panels up to 40 times
            past = 1 / (1 + (FINE.nodes[:, None] - deborah * age) ** 2)
            expected = past @ (np.tile(weights / 20, 400) * np.exp(-age))
            np.testing.assert_allclose(found * (1 + FINE.nodes**2), expected * (1 + FINE.nodes**2), rtol=0, atol=1e-6)


@pytest.mark.quick
def test_the_hysteresis_friction_is_parsevals_integral():
    deborah, ratio, width = 0.5, 3.0, 0.4
    found = hysteresis_friction(FINE, StandardLinearSolid(deborah, ratio), bump(FINE.nodes, width))
    # w^ = J(k) p^/|k|, so that int p w' = int_0^inf Im(J) |p^|^2 dk/pi, with |p^|^2 of the bump.
    k = np.linspace(1e-6, 60, 400_001)
    loss = (1 - 1 / ratio) * k * deborah / (1 + (k * deborah) ** 2)
    power = np.pi * width**2 * np.exp(-((k * width) ** 2) / 2)
    assert found == pytest.approx(2 / np.pi * trapezoid(loss * power, k) / np.pi, rel=1e-8)
    assert abs(hysteresis_friction(FINE, HalfPlane(), bump(FINE.nodes))) < 1e-12


@pytest.mark.quick
def test_a_prony_series_of_one_term_is_the_standard_linear_solid():
    instant, [(part, time)] = creep_of_relaxation((0.2,), (1.5,))
    assert (instant, part, time) == (pytest.approx(1 / 2.5), pytest.approx(0.6), pytest.approx(0.5))
    one, other = Prony([0.2], [1.5]), StandardLinearSolid(0.5, 2.5)
    np.testing.assert_allclose(one.deflection(FINE), other.deflection(FINE), atol=1e-12)


@pytest.mark.quick
def test_the_creep_of_a_prony_series_inverts_its_relaxation():
    times, moduli = (1e-3, 0.1, 2.0, 50.0), (3.0, 0.5, 2.0, 0.1)
    instant, rest = creep_of_relaxation(times, moduli)
    for s in (1e-4, 0.03, 1.0, 40.0, 1e5):
        stiffness = 1 + sum(g * s * t / (1 + s * t) for t, g in zip(times, moduli, strict=True))
        compliance = instant + sum(part / (1 + s * time) for part, time in rest)
        assert stiffness * compliance == pytest.approx(1.0, rel=1e-10)


def dry(model, kappa=1e-3, load=0.1, guess=None):
    """Return a dry state and its mesh."""
    groups = sb.Groups(0.0, load, kappa * load)
    guess = cold_start(groups).states[-1] if guess is None else guess
    for tolerance in (1e-3, 1e-5, 1e-7):
        mesh = mesh_for(guess, groups, contact_law(groups), 12, tolerance, 0.01 * tolerance)
        far = mesh.edges[-1] * 2.0 ** np.arange(1, 6)
        mesh = Mesh(np.unique(np.concatenate([mesh.edges, far, -far])), 12, mesh.scale)
        guess = solve_state(groups, Operators(mesh, model), guess, 1e-11, max_steps=100)
        assert guess.outcome.ok, guess.outcome
    return guess


def test_a_dry_contact_on_a_standard_linear_solid_is_that_of_an_independent_solver(subtests):
    for row in DRY[:3]:
        with subtests.test(row=row):
            solid = StandardLinearSolid(row["De"], row["r"])
            state = dry(Model(solid=solid))
            pressure = state.equations.pressures(state.y)[0]
            tolerance = max(1e-6, 10 * row["change"])
            assert hysteresis_friction(state.mesh, solid, pressure) == pytest.approx(
                row["mu_over_aR"], rel=max(2e-5, tolerance)
            )
            assert pressure.max() == pytest.approx(row["pmax"], rel=1e-3)
            # The friction is the moment of the pressure on the punch, too.
            moment = -(state.mesh.weights[:-12] * state.mesh.nodes[:-12]) @ pressure[:-12] / LOAD
            assert moment == pytest.approx(row["mu_over_aR"], rel=max(2e-5, tolerance))


def test_slow_sliding_has_the_friction_of_a_small_lag():
    friction = []
    for deborah in (0.02, 0.01):
        solid = StandardLinearSolid(deborah, 2.0)
        state = dry(Model(solid=solid))
        friction.append(hysteresis_friction(state.mesh, solid, state.equations.pressures(state.y)[0]) / (0.5 * deborah))
    assert abs(friction[1] - 1) < abs(friction[0] - 1) < 0.031


def test_a_dry_contact_on_a_layer_is_that_of_an_independent_solver(subtests):
    for row in REFERENCE["f_layer_dry"]:
        with subtests.test(row=row):
            guess = None
            for d in [each for each in (1.0, 0.7) if each > row["d"]] + [row["d"]]:
                guess = dry(Model(solid=Layer(d, row["nu"])), guess=guess)
            found = observed(guess)
            tolerance = max(1e-6, 10 * row["change"])
            for name in ("h0", "hmin", "m"):
                assert found[name] == pytest.approx(row[name], rel=tolerance)


@pytest.mark.quick
def test_two_half_spaces_are_one_and_a_body_of_no_share_does_nothing():
    p = bump(FINE.nodes)
    both = TwoBodies(first_share=0.3)
    np.testing.assert_allclose(both.deflection(FINE) @ p, HalfPlane().deflection(FINE) @ p, atol=1e-13)
    np.testing.assert_allclose(both.far_gap(FINE.nodes), HalfPlane().far_gap(FINE.nodes))
    layered = TwoBodies(Layer(1.0), None, 1.0)
    np.testing.assert_allclose(layered.deflection(FINE) @ p, Layer(1.0).deflection(FINE) @ p)


@pytest.mark.quick
def test_solids_of_a_contact_are_scaled_from_si_units():
    contact = sb.LineContact(
        radius="10 mm",
        modulus="2.1 MPa",
        load="50 N/m",
        viscosity="1 Pa*s",
        speed="0.1 m/s",
        roughness="1 um",
        alpha=2.0,
        beta=0.05,
        boundary_friction=0.8,
        slide_to_roll=1.0,
        solid=sb.solids.TwoBodies(sb.solids.StandardLinearSolid("10 ms", 2.0, sb.solids.Layer("2 mm"))),
    )
    a, solid = contact.hertz.half_width, contact.groups.model.solid.first
    assert solid.retardation_time == pytest.approx(0.75 * 0.1 * 0.01 / a)  # the substrate moves with u1 = (1 + s) U/2
    assert solid.base.layer_thickness == pytest.approx(2e-3 / a)
    assert contact.replace(speed=0.0).groups.model.solid.first == Layer(solid.base.layer_thickness)


@pytest.mark.quick
def test_groups_that_hold_a_memory_at_one_speed_have_no_curve_over_it():
    with pytest.raises(sb.InputError, match="give a contact, or vary load or roughness"):
        sb.stribeck_curve(sb.Groups(1e-3, 0.1, 1e-4), solid=StandardLinearSolid(0.3, 2.0), points=3)


def test_along_a_curve_the_memory_of_a_body_moves_with_the_speed(subtests):
    for solid in [StandardLinearSolid("1 ms", 2.0), Prony(["1 ms", "30 ms"], [0.7, 0.5])]:
        with subtests.test(solid=solid):
            contact = TRUE.replace(solid=solid)
            curve = sb.stribeck_curve(contact, speed=(0.01, 0.1), points=3)
            for speed in (0.02, 0.07):
                state = sb.solve(contact.replace(speed=speed))
                assert float(curve.at(speed).friction) == pytest.approx(state.friction().total, rel=1e-6)
                assert curve.at(speed).central_gap == pytest.approx(state.central_gap, rel=1e-6)


def test_a_curve_along_which_a_body_remembers_more_and_more_of_the_panel_at_infinity_is_solved():
    contact = sb.load_case(PDMS).contact.replace(solid=StandardLinearSolid("10 ms", 5.0))
    curve = sb.stribeck_curve(contact, speed=("0.1 mm/s", "1 m/s"), points=21)
    assert len(curve) == 21
    assert curve.error_estimate <= 1e-6


@pytest.mark.quick
def test_rows_of_states_are_deflected_each_by_its_own_solid(subtests):
    for cavitation in ["none", "exit"]:
        with subtests.test(cavitation=cavitation):
            groups = sb.solve(sb.Groups(1e-3, 0.1, 1e-2), cavitation=cavitation, solid=StandardLinearSolid(0.3, 2.0)).groups
            mesh = replace(FINE, reformation=math.inf)
            solids = tuple(TwoBodies(StandardLinearSolid(time, 3.0), Layer(2.0), 0.4) for time in (0.1, 0.3, 2.0))
            together = OperatorsOfRows(mesh, groups.model, solids)
            pressure = bump(mesh.nodes + np.array([[0.1], [0.3], [0.0]]))
            each = [Operators(mesh, replace(groups.model, solid=solid)) for solid in solids]
            expected = [one.deflected(row, None) for one, row in zip(each, pressure, strict=True)]
            np.testing.assert_allclose(together.deflected(pressure, None), expected, rtol=1e-12, atol=1e-12)


@pytest.mark.quick
def test_impossible_solids_are_refused_by_name(subtests):
    for make, said in [
        (lambda: StandardLinearSolid(0, 2.0), "time"),
        (lambda: StandardLinearSolid("10 ms", 1.0), "ratio"),
        (lambda: Prony("1 s", [1.0]), "must be a list"),
        (lambda: Prony([1.0], [1.0, 2.0]), "as many"),
        (lambda: Prony([1.0, 1.0], [1.0, 2.0]), "differ"),
        (lambda: TwoBodies(first_share=1.2), "first_share"),
        (lambda: TwoBodies(None, 3), "second = 3; give one of sb.solids"),
        (lambda: StandardLinearSolid("10 ms", 2.0, Layer), "base = .*Layer.*; give one of sb.solids"),
    ]:
        with subtests.test(make=make, said=said):
            with pytest.raises(sb.InputError, match=said):
                make()


@pytest.mark.quick
def test_pressures_on_a_panel_much_wider_than_a_layer_is_thick_deflect_it_by_its_kernel(subtests):
    for d in [0.9, 0.1, 0.004]:
        with subtests.test(d=d):
            mesh = Mesh(np.array([-6.1, -6.0, 6.0, 6.1]), 12)
            at = np.flatnonzero(np.abs(mesh.nodes) < 6.1)[8:-8]

            def pressure(y):
                return (1 + 0.3 * y) * (1 - (y / 8) ** 2) ** 3 * (np.abs(y) < 6)

            def exact(x):
                def pushed(y):
                    xi = np.array([abs(x - y) / d])
                    return float((smooth_kernel(xi, 0.45) - np.log(xi) / math.pi)[0]) * pressure(y)

                first, last = max(-6, x - KERNEL_RADIUS * d), min(6, x + KERNEL_RADIUS * d)
                places = sorted({first, last} | {y for y in (x - 0.3 * d, x, x + 0.3 * d) if first < y < last})
                return sum(quad(pushed, *part, epsabs=1e-11, epsrel=0)[0] for part in pairwise(places))

            found = (Layer(d, 0.45).deflection(mesh) @ pressure(mesh.nodes))[at]
            np.testing.assert_allclose(found, [exact(x) for x in mesh.nodes[at]], rtol=0, atol=1e-9 * d)


@pytest.mark.parametrize("poisson_ratio", [0.0, 0.5])
def test_what_a_wide_panel_does_far_away_is_what_it_does_at_each_place(monkeypatch, poisson_ratio):
    mesh = Mesh(np.concatenate([[-64.0, -32.0, -6.6, -2.0], np.linspace(-1.1, 1.1, 12), [2.0, 6.6, 32.0, 64.0]]), 12)
    told = Layer(1.0, poisson_ratio).deflection(mesh)
    monkeypatch.setattr(bonded, "FAR_TARGETS", 10**6)
    np.testing.assert_allclose(told, Layer(1.0, poisson_ratio).deflection(mesh), rtol=0, atol=1e-12)


@pytest.mark.quick
def test_a_wide_panel_acts_on_near_and_far_nodes_as_by_a_finer_rule(subtests):
    for d in [0.5, 1.3, 3.0]:
        with subtests.test(d=d):
            mesh, layer = Mesh(np.array([-12.0, -6.0, -1.0, -0.5, 0.0, 0.5, 1.0, 6.0, 12.0]), 12), Layer(d, 0.4)
            x, pressed = mesh.nodes, (mesh.nodes > 1) & (mesh.nodes < 6)
            near = np.abs(x) < 12

            def pressure(y):
                return 0.01 * (y - 1) * (6 - y) ** 3

            beside = (layer.deflection(mesh) - HalfPlane().deflection(mesh))[np.ix_(near, pressed)] @ pressure(x[pressed])
            t, weights = np.polynomial.legendre.leggauss(120)
            y, weights = 3.5 + 2.5 * t, 2.5 * weights
            distance = np.abs(x[near][:, None] - y) / d
            beyond = np.log(np.maximum(distance, KERNEL_RADIUS)) / math.pi  # where the whole kernel is zero
            smooth = (
                np.where(distance < KERNEL_RADIUS, smooth_kernel(np.minimum(distance, KERNEL_RADIUS), 0.4), beyond)
                + math.log(d) / math.pi
            )
            np.testing.assert_allclose(beside, smooth @ (weights * pressure(y)), rtol=0, atol=1e-9)


def test_a_smooth_film_on_a_body_that_remembers_is_found_however_thin_it_is():
    """Its outlet moves with the film; predicted at fixed places it took six times the steps, and the path was given up."""
    solid = Prony((0.4, 0.04), (3.5, 3.5))
    path = cold_start(sb.Groups(1.7e-12, 0.14, 0.0, model=Model(solid=solid)))
    assert path.outcome.ok
    assert len(path.states) < 50
    thinner, thin = path.states[-1], next(state for state in path.states if state.groups.speed < 1e-8)
    speeds = math.log(thin.groups.speed / thinner.groups.speed)
    assert math.log(thin.gap.min() / thinner.gap.min()) / speeds == pytest.approx(0.6, abs=0.01)


@pytest.mark.quick
def test_series_that_shrink_a_cavity_to_nothing_find_no_number_and_no_exception():
    """The dilation of a sample of a cavity on a layer can be negative; a curve had ended in a domain error of math."""
    operators = Operators(Mesh(np.array([-4.0, -1.0, 0.0, 1.0, 4.0]), 4), Model(solid=Layer(1.0, 0.5)))
    pressure = np.ones((4, operators.mesh.size))
    with np.errstate(invalid="ignore"):
        found = operators.deflected(pressure, np.array([[0.5], [-0.1], [math.nan], [math.inf]]))
    np.testing.assert_allclose(found[:1], operators.deflected(pressure[:1], np.array([[0.5]])), rtol=1e-12)
    assert np.isnan(found[1:]).all()
