"""Viscoelastic and combined solids: memory, hysteresis friction, dry contacts against an independent solver."""

import json
import math
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from fit_data import TRUE
from scipy.integrate import quad, trapezoid
from scipy.special import j0, jv

import stribeck as sb
from stribeck.numerics.fourier_panels import PolarMesh
from stribeck.numerics.panels import Mesh
from stribeck.solids import HalfPlane, Layer, Prony, StandardLinearSolid, TwoBodies, hysteresis_friction
from stribeck.solids.layer import KERNEL_RADIUS, smooth_kernel, transfer
from stribeck.solids.layer_plane import layer_by_mode
from stribeck.solids.viscoelastic import Memory, creep_of_relaxation

FINE = Mesh(np.concatenate([[-256, -128, -64, -32, -16, -8], np.arange(-4, 4.01, 0.125), [8, 16, 32, 64, 128, 256.0]]), 12)
PDMS = Path(__file__).parents[1] / "examples" / "pdms_cylinder.toml"
DRY = json.loads((Path(__file__).parent / "data" / "fluids.json").read_text())["g_standard_linear_solid_dry"]["rows"]


def bump(x, width=0.3):
    return np.exp(-((x / width) ** 2))


@pytest.mark.quick
def test_the_hysteresis_friction_is_parsevals_integral(subtests):
    # w^ = J(k) p^/|k|, so that int p w' = int_0^inf -Im(J) |p^|^2 dk/pi, with |p^|^2 of the bump and J one over the modulus.
    k, width = np.linspace(1e-6, 60, 400_001), 0.4
    power = np.pi * width**2 * np.exp(-((k * width) ** 2) / 2)
    for times, moduli in [((0.5 / 3,), (2.0,)), ((1.0, 0.1), (1.5, 1.0)), ((1e-3, 0.1, 2.0), (3.0, 0.5, 2.0))]:
        with subtests.test(times=times, moduli=moduli):
            modulus = 1 + sum(g * 1j * k * t / (1 + 1j * k * t) for t, g in zip(times, moduli, strict=True))
            expected = 2 / np.pi * trapezoid(-(1 / modulus).imag * power, k) / np.pi
            assert hysteresis_friction(FINE, Prony(times, moduli), bump(FINE.nodes, width)) == pytest.approx(
                expected, rel=1e-6
            )
    one, other = Prony([0.2], [1.5]), StandardLinearSolid(0.5, 2.5)
    np.testing.assert_allclose(one.deflection(FINE), other.deflection(FINE), atol=1e-12)
    assert abs(hysteresis_friction(FINE, HalfPlane(), bump(FINE.nodes))) < 1e-12


def test_a_dry_contact_on_a_standard_linear_solid_is_that_of_an_independent_solver(subtests):
    for row in DRY[:3]:
        with subtests.test(row=row):
            state = sb.solve(sb.Groups(0.0, 0.1, 1e-4), solid=StandardLinearSolid(row["De"], row["r"]), rtol=1e-7)
            tolerance = max(1e-6, 10 * row["change"])
            assert state.hysteresis_friction == pytest.approx(row["mu_over_aR"], rel=max(2e-5, tolerance))
            assert state.pressure.max() == pytest.approx(row["pmax"], rel=1e-3)


def test_slow_sliding_has_the_friction_of_a_small_lag():
    friction = []
    for deborah in (0.02, 0.01):
        state = sb.solve(sb.Groups(0.0, 0.1, 1e-4), solid=StandardLinearSolid(deborah, 2.0), rtol=1e-7)
        friction.append(state.hysteresis_friction / (0.5 * deborah))
    assert abs(friction[1] - 1) < abs(friction[0] - 1) < 0.031


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


def test_along_a_curve_the_memory_of_a_body_moves_with_the_speed():
    contact = TRUE.replace(solid=Prony(["1 ms", "30 ms"], [0.7, 0.5]))
    curve = sb.stribeck_curve(contact, speed=(0.01, 0.1), points=3)
    state, found = sb.solve(contact.replace(speed=0.03)), curve.at(0.03)
    assert float(found.friction) == pytest.approx(state.friction().total, rel=1e-6)
    assert found.central_gap == pytest.approx(state.central_gap, rel=1e-6)


def test_a_curve_along_which_a_body_remembers_more_and_more_of_the_panel_at_infinity_is_solved():
    contact = sb.load_case(PDMS).contact.replace(solid=StandardLinearSolid("10 ms", 5.0))
    curve = sb.stribeck_curve(contact, speed=("0.1 mm/s", "1 m/s"), points=21)
    assert len(curve) == 21
    assert curve.error_estimate <= 1e-6


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
def test_a_wide_panel_acts_on_near_and_far_nodes_as_by_its_parts(subtests):
    edges = np.array([-12.0, -6.0, -1.0, -0.5, 0.0, 0.5, 1.0, 6.0, 12.0])
    parts = np.unique(np.concatenate([np.linspace(a, b, 33) for a, b in zip(edges[:-1], edges[1:], strict=True)]))
    wide, fine = Mesh(edges, 12), Mesh(parts, 12)
    for d, poisson_ratio in [(0.1, 0.45), (3.0, 0.5)]:
        with subtests.test(d=d, poisson_ratio=poisson_ratio):

            def pressure(y):
                return np.where((y > 1) & (y < 6), 0.01 * (y - 1) * (6 - y) ** 3, 0.0)

            layer, near = Layer(d, poisson_ratio), np.abs(wide.nodes) < 12
            found = (layer.deflection(wide) @ pressure(wide.nodes))[near]
            exact = fine.interpolate(layer.deflection(fine) @ pressure(fine.nodes), wide.nodes[near])
            np.testing.assert_allclose(
                found, exact, rtol=0, atol=2e-8
            )  # the kink of the pressure costs the interpolation this


def test_a_smooth_film_on_a_body_that_remembers_is_found_however_thin_it_is():
    """Its outlet moves with the film; predicted at fixed places it took six times the steps, and the path was given up."""
    thin, thinner = (
        sb.solve(sb.Groups(speed, 0.14, 0.0), solid=Prony((0.4, 0.04), (3.5, 3.5)), rtol=1e-4) for speed in (1e-9, 1.7e-12)
    )
    power = math.log(thin.minimum_gap / thinner.minimum_gap) / math.log(1e-9 / 1.7e-12)
    assert power == pytest.approx(0.6, abs=0.01)


# --- the bodies themselves ---


SINGULAR_BY_COLLOCATION = 256 / 16.868016151387604


def composite(length, panels=400):
    """Return nodes and weights on equal panels from zero."""
    nodes, weights = np.polynomial.legendre.leggauss(10)
    at = np.add.outer(np.arange(panels), 0.5 * (1 + nodes)).ravel() / panels
    return length * at, length * np.tile(weights / (2 * panels), panels)


def remembered(pressure, deborah):
    return Memory(FINE, np.array([deborah]))(pressure[None])[0]


@pytest.mark.quick
@pytest.mark.parametrize("deborah", [0.03, 3.0])
def test_the_memory_is_the_exponential_mean_of_what_has_passed(deborah):
    found = remembered(bump(FINE.nodes), deborah)
    x = np.array([-0.5, 0.0, 0.3, 1.0, 6.0])
    age, weights = composite(40.0)
    expected = [np.sum(weights * np.exp(-age) * bump(each - deborah * age)) for each in x]
    np.testing.assert_allclose(FINE.interpolate(found, x), expected, atol=1e-9)
    assert FINE.weights @ found == pytest.approx(FINE.weights @ bump(FINE.nodes), rel=1e-9)  # the load is kept


@pytest.mark.quick
@pytest.mark.parametrize("deborah", [1.0, SINGULAR_BY_COLLOCATION])
def test_memory_of_a_pressure_that_reaches_to_infinity(deborah):
    found = remembered(1 / (1 + FINE.nodes**2), deborah)
    age, weights = composite(40.0)
    past = 1 / (1 + (FINE.nodes[:, None] - deborah * age) ** 2)
    expected = past @ (weights * np.exp(-age))
    np.testing.assert_allclose(found * (1 + FINE.nodes**2), expected * (1 + FINE.nodes**2), rtol=0, atol=1e-6)


@pytest.mark.quick
def test_the_creep_of_a_prony_series_inverts_its_relaxation():
    times, moduli = (1e-3, 0.1, 2.0, 50.0), (3.0, 0.5, 2.0, 0.1)
    instant, rest = creep_of_relaxation(times, moduli)
    for s in (1e-4, 0.03, 1.0, 40.0, 1e5):
        stiffness = 1 + sum(g * s * t / (1 + s * t) for t, g in zip(times, moduli, strict=True))
        compliance = instant + sum(part / (1 + s * time) for part, time in rest)
        assert stiffness * compliance == pytest.approx(1.0, rel=1e-10)


@pytest.mark.quick
@pytest.mark.parametrize("d", [0.9, 0.1, 0.004])
def test_pressures_on_a_panel_much_wider_than_a_layer_is_thick_deflect_it_by_its_kernel(d):
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


@pytest.mark.parametrize(("thickness", "ratio"), [(3.0, 0.5), (0.5, 0.3)])
def test_the_layer_deflects_as_hankels_transform_says(thickness, ratio):
    mesh = PolarMesh(np.array([0, 0.25, 0.5, 0.75, 1, 1.25, 1.5, 2.0, 10.0, 50.0]), 7, 12, 3)
    by_mode = layer_by_mode(mesh, Layer(thickness, ratio))
    s, r = 0.3, mesh.radii
    q, w = composite(50.0)
    spectrum = 4 / np.pi * transfer(q * thickness, ratio) * s**2 * np.exp(-((q * s) ** 2) / 2)
    bump = np.exp(-(r**2) / (2 * s**2))
    assert by_mode[0] @ bump == pytest.approx(j0(np.outer(r, q)) @ (w * spectrum), abs=1e-9)
    assert by_mode[1] @ (r * bump) == pytest.approx(s**2 * jv(1, np.outer(r, q)) @ (w * spectrum * q), abs=1e-9)


@pytest.mark.quick
@pytest.mark.parametrize("ratio", [0.3, 0.5])
def test_a_thin_layer_gives_way_as_springs_and_an_incompressible_one_as_the_bend_of_the_pressure(ratio):
    # w = (2/pi) d (1 - 2 nu)/(1 - nu)**2 p, and -(8/3 pi) d**3 times the Laplacian of p, but for (d/s)**2.
    left = {0: [], 1: []}
    for d in (0.2, 0.1):
        edges = np.concatenate([np.arange(0.0, 4.6, 2 * d), [8.0, 12.0]])
        mesh = PolarMesh(edges, edges.size - 3, 6, 2)
        r, by_mode = mesh.radii, layer_by_mode(mesh, Layer(d, ratio))
        bump = np.exp(-(r**2) / 2)
        for mode, pressure, bend in ((0, bump, (r**2 - 2) * bump), (1, r * bump, r * (r**2 - 4) * bump)):
            springs = 2 / np.pi * d * (1 - 2 * ratio) / (1 - ratio) ** 2 * pressure
            limit = -8 / (3 * np.pi) * d**3 * bend if ratio == 0.5 else springs
            left[mode].append(np.abs(by_mode[mode] @ pressure - limit)[r < 2].max() / np.abs(limit).max())
    for thick, thin in left.values():
        assert thin < (0.1 if ratio == 0.5 else 3e-3)
        assert 1.6 < np.log2(thick / thin) < 2.1
