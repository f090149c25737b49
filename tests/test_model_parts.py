"""Fluid, cavitation and solid as parts of a model, by themselves and through `solve`.

The reference values of tests/data/fluids.json were computed with another program of the same equations; its "change" is how
much they moved when every panel was halved.
"""

import json
from pathlib import Path

import numpy as np
import pytest

import stribeck as sb
from stribeck.fluids import Barus, DowsonHigginson
from stribeck.numerics.panels import Mesh
from stribeck.numerics.running_integral import RunningIntegral
from stribeck.solids import Layer

REFERENCE = json.loads((Path(__file__).parent / "data" / "fluids.json").read_text())


def test_a_running_integral_after_an_operator_is_their_product():
    mesh = Mesh(np.array([-4.0, -2, -1, -0.5, 0, 0.5, 1, 2, 4]), 8)
    rows = np.random.default_rng(11).normal(size=(3, mesh.size))
    for reformation in (0.0, 1.0, np.inf):
        integral = RunningIntegral(mesh, reformation)
        matrix = np.stack([integral(column) for column in np.eye(mesh.size)], axis=1)
        np.testing.assert_allclose(integral.after(rows), rows @ matrix, rtol=1e-12, atol=1e-9)


def test_a_thin_film_that_is_compressed_is_found():
    """Its flux and density fix the gap: a pressure integrated from the inlet grew without bound."""
    fluid = sb.fluids.Fluid(None, Barus(0.3), DowsonHigginson(0.8))
    groups = sb.Groups(2e-7, 5e-3, 0.0)
    solution = sb.solve(groups, fluid=fluid, cavitation="exit", rtol=1e-5)
    assert solution.error_estimate <= 1e-5
    middle = solution.profile(np.array([0.0, 0.5, -0.5]))
    density = DowsonHigginson(0.8).ratio(middle.fluid_pressure)
    np.testing.assert_allclose(middle.gap * density, solution.flux_gap, rtol=5e-3)
    np.testing.assert_allclose(middle.fluid_pressure, np.sqrt(1 - np.array([0.0, 0.25, 0.25])), rtol=2e-3)


def test_the_spike_of_a_thick_film_rises_as_in_finite_differences(subtests):
    """In a full film by 500 of them that double towards the spike; the film that ends was not found."""
    for coefficient, cavitation, highest in [(4.74106, "none", 1.545), (4.96020, "none", 1.745), (5.0, "exit", 1.365)]:
        with subtests.test(coefficient=coefficient, cavitation=cavitation, highest=highest):
            found = sb.solve(sb.Groups(0.27, 0.01, 0.0), fluid=Barus(coefficient), cavitation=cavitation, rtol=1e-4)
            assert found.fluid_pressure.max() == pytest.approx(highest, rel=1e-2)


def test_the_deflection_of_a_layer_under_a_gaussian_is_its_fourier_integral(subtests):
    for key in REFERENCE["f_layer_operator_gaussian"]["w"]:
        with subtests.test(key=key):
            reference = REFERENCE["f_layer_operator_gaussian"]
            thickness, poisson_ratio = map(float, key.split(","))
            edges = np.arange(-4, 4.01, 0.125)
            mesh = Mesh(np.concatenate([[-64, -32, -16, -8], edges, [8, 16, 32, 64]]), 12)
            pressure = np.exp(-(mesh.nodes**2) / (2 * reference["s"] ** 2))
            deflection = Layer(thickness, poisson_ratio).deflection(mesh) @ pressure
            np.testing.assert_allclose(mesh.interpolate(deflection, np.array(reference["x"])), reference["w"][key], atol=1e-9)


def test_a_thick_film_on_a_thin_layer_has_its_offset():
    """The pressure where the panels in x ended was still felt: the offset was wrong by 2.4e-6."""
    groups, layer = sb.Groups(39e3, 1e-3, 0.0), sb.solids.Layer(1.8)
    coarse, fine = (sb.solve(groups, solid=layer, rtol=rtol) for rtol in (1e-6, 1e-8))
    assert coarse.offset == pytest.approx(fine.offset, rel=2e-7)


def test_a_curve_of_a_film_that_ends_finds_its_range_and_its_minimum():
    """Minimum of friction at load 0.1 and kappa 1e-3 with a free exit: 0.02410 at speed 1.095e-3; full film 0.02635."""
    curve = sb.stribeck_curve(sb.Groups(1e-4, 0.1, 1e-4), cavitation="exit", points=7, rtol=1e-5)
    assert curve.solutions[0].fluid_load_share < 1e-3 and curve.solutions[-1].contact_load_share < 1e-3
    assert curve.minimum.value == pytest.approx(1.095e-3, abs=2e-6)
    assert curve.minimum.friction == pytest.approx(0.02410, abs=1e-5)
