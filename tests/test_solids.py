"""Viscoelastic and combined solids: memory, hysteresis friction, dry contacts against an independent solver."""

import json
import math
from pathlib import Path

import numpy as np
import pytest
from fit_data import TRUE
from scipy.integrate import trapezoid

import stribeck as sb
from stribeck.numerics.panels import Mesh
from stribeck.solids import HalfPlane, Layer, Prony, StandardLinearSolid, TwoBodies, hysteresis_friction

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
    body = sb.solids.TwoBodies(sb.solids.StandardLinearSolid("10 ms", 2.0, sb.solids.Layer("2 mm")))
    contact = TRUE.replace(speed="0.1 m/s", slide_to_roll=1.0, solid=body)
    a, solid = contact.hertz.half_width, contact.groups.model.solid.first
    assert solid.retardation_time == pytest.approx(0.75 * 0.1 * 0.01 / a)  # the substrate moves with u1 = (1 + s) U/2
    assert solid.base.layer_thickness == pytest.approx(2e-3 / a)
    # At rest, and where the substrate stands still under a cylinder that slides, nothing is remembered.
    for change in ({"speed": 0.0}, {"slide_to_roll": -2.0}):
        assert contact.replace(**change).groups.model.solid.first == Layer(solid.base.layer_thickness)


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


def test_the_minimum_on_a_body_that_remembers_does_not_depend_on_the_tolerance():
    """It was located on solved states by slopes at a constant memory, 11 % off in speed."""
    contact = TRUE.replace(solid=StandardLinearSolid("10 ms", 3.0))
    loose, fine = (sb.stribeck_curve(contact, speed=(0.01, 0.2), points=3, rtol=rtol).minimum for rtol in (1e-4, 1e-6))
    assert abs(math.log(loose.value / fine.value)) < loose.error + fine.error


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
        with subtests.test(make=make, said=said), pytest.raises(sb.InputError, match=said):
            make()


@pytest.mark.quick
def test_a_wide_panel_acts_on_near_and_far_nodes_as_by_its_parts(subtests):
    edges = np.array([-12.0, -6.0, -1.0, -0.5, 0.0, 0.5, 1.0, 6.0, 12.0])
    kink = 0.5 * np.array([0.0, *2.0 ** -np.arange(6)])  # Panels shrink towards the ends of the pressure
    parts = [np.linspace(a, b, 5) for a, b in zip(edges[:-1], edges[1:], strict=True)]
    parts = np.unique(np.concatenate([*parts, *(end + sign * kink for end in (1, 6) for sign in (-1, 1))]))
    wide, fine = Mesh(edges, 12), Mesh(parts, 12)
    for d, poisson_ratio in [(0.1, 0.45), (3.0, 0.5)]:
        with subtests.test(d=d, poisson_ratio=poisson_ratio):

            def pressure(y):
                return np.where((y > 1) & (y < 6), 0.01 * (y - 1) * (6 - y) ** 3, 0.0)

            layer, near = Layer(d, poisson_ratio), np.abs(wide.nodes) < 12
            found = (layer.deflection(wide) @ pressure(wide.nodes))[near]
            exact = fine.interpolate(layer.deflection(fine) @ pressure(fine.nodes), wide.nodes[near])
            np.testing.assert_allclose(found, exact, rtol=0, atol=1e-9)


@pytest.mark.slow
def test_a_smooth_film_on_a_body_that_remembers_is_found_however_thin_it_is():
    """Its outlet moves with the film; predicted at fixed places it took six times the steps, and the path was given up."""
    thinner = sb.solve(sb.Groups(1.7e-12, 0.14, 0.0), solid=Prony((0.4, 0.04), (3.5, 3.5)), rtol=1e-4)
    at_1e_9 = 4.81675e-7  # found at rtol 1e-3 and 1e-4
    power = math.log(at_1e_9 / thinner.minimum_gap) / math.log(1e-9 / 1.7e-12)
    assert power == pytest.approx(0.6, abs=0.01)


# --- the bodies themselves ---


SINGULAR_BY_COLLOCATION = 256 / 16.868016151387604
"""A Deborah number at which collocation has no memory on the panels to infinity."""


@pytest.mark.quick
def test_the_memory_is_the_exponential_mean_of_what_has_passed(subtests):
    """The compliance of the solid is half there at once and half with the memory, as of a pressure that is their mean."""
    for deborah, pressure in [
        (0.03, bump),
        (3.0, bump),
        (1.0, lambda x: 1 / (1 + x**2)),
        (SINGULAR_BY_COLLOCATION, lambda x: 1 / (1 + x**2)),
    ]:
        with subtests.test(deborah=deborah, pressure=pressure):
            nodes, weights = np.polynomial.legendre.leggauss(10)
            age = np.add.outer(np.arange(400), 0.5 * (1 + nodes)).ravel() / 10  # 400 panels up to 40 times
            past = pressure(FINE.nodes[:, None] - deborah * age) @ (np.tile(weights / 20, 400) * np.exp(-age))
            found = StandardLinearSolid(deborah, 2.0).deflection(FINE) @ pressure(FINE.nodes)
            expected = HalfPlane().deflection(FINE) @ (0.5 * pressure(FINE.nodes) + 0.5 * past)
            np.testing.assert_allclose(found, expected, rtol=0, atol=1e-9)


@pytest.mark.quick
def test_a_layer_yields_to_the_pressure_far_beyond_the_contact():
    """A film of a fast contact reaches hundreds of half-widths; with no deflection beyond the panels both differed by 5e-7."""
    fast, solid = sb.Groups(301717.1384863469, 0.42855914340436113, 0.0), Layer(0.8795634762570477, 0.15557086584745672)
    found, reference = (sb.solve(fast, solid=solid, rtol=rtol) for rtol in (1e-6, 1e-9))
    for name in ("central_gap", "minimum_gap", "flux_gap", "offset", "viscous_balanced"):
        assert abs(getattr(found, name) / getattr(reference, name) - 1) <= found.errors[name], name


def test_a_layer_much_thinner_than_panels_are_wide_gives_way_as_springs():
    """Kernels of panels that hold all of their own width; what is left goes with the bend of the pressure, as d**3."""
    mesh = Mesh(np.array([-6.1, -6.0, 6.0, 6.1]), 12)
    pressure = np.where(np.abs(mesh.nodes) < 6, (1 + 0.3 * mesh.nodes) * (1 - (mesh.nodes / 8) ** 2) ** 3, 0.0)
    inside, left = np.abs(mesh.nodes) < 5, []
    for d in (0.008, 0.004):
        springs = 0.5 * d * (1 - 2 * 0.45) / (1 - 0.45) ** 2 * pressure
        found = Layer(d, 0.45).deflection(mesh) @ pressure
        left.append(np.abs(found - springs)[inside].max() / springs[inside].max())
    assert left[1] < 1e-5
    assert math.log2(left[0] / left[1]) == pytest.approx(2.0, abs=0.1)
