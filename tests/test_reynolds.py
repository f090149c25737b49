"""Reynolds' equation: derivatives against differences, the flux gap of films in closed form."""

import numpy as np
import pytest

from stribeck.fluids import newtonian as reynolds
from stribeck.numerics.panels import Mesh, base_edges
from stribeck.numerics.running_integral import RunningIntegral
from stribeck.numerics.trace import Trace

pytestmark = pytest.mark.quick

SEED = 80_021


def gradient(gap, flux_gap):
    """Return that of an isoviscous film between smooth walls, over the speed group."""
    return reynolds.Newtonian().gradient(gap, None, flux_gap)


@pytest.fixture
def film():
    """Gaps of all sizes, and a flux gap."""
    return 10.0 ** np.random.default_rng(SEED).uniform(-8, 6, 60), 3e-3


def test_the_gradient_vanishes_where_the_gap_is_the_flux_gap():
    gap = np.array([0.1, 0.2, 0.4])
    values = gradient(gap, 0.2)
    assert values[1] == 0
    assert values[0] == pytest.approx(-100.0, rel=1e-14)
    assert values[2] == pytest.approx(3.125, rel=1e-14)


def test_the_gap_derivative_is_that_of_the_gradient(film):
    gap, flux_gap = film
    step = 1e-4 * gap
    up, down = (gradient(gap + d, flux_gap) for d in (step, -step))
    difference = (up - down) / (2 * step)
    scale = (gap + flux_gap) / gap**4
    traced = gradient(Trace.number("gap", gap), flux_gap).columns["gap"]
    assert (np.abs(traced - difference) / scale).max() < 1e-6


def test_the_flux_derivative_is_that_of_the_gradient(film):
    gap, flux_gap = film
    difference = (gradient(gap, flux_gap + 1) - gradient(gap, flux_gap - 1)) / 2
    scale = (1 + gap) / gap**3
    traced = gradient(gap, Trace.number("flux_gap", np.array(flux_gap))).columns["flux_gap"]
    assert (np.abs(traced - difference) / scale).max() < 1e-14


def test_the_flux_gap_of_a_parabola_is_four_thirds_of_its_height(subtests):
    for height in [1e-9, 1e-3, 1.0, 1e5]:
        with subtests.test(height=height):
            width = np.sqrt(height)
            mesh = Mesh(base_edges(0.5, 16.0) * width, 24)
            gap = height + mesh.nodes**2 / 2
            assert reynolds.flux_gap(gap, mesh.weights) == pytest.approx(4 * height / 3, rel=1e-13)


def test_the_flux_gap_makes_the_pressure_vanish_at_both_ends(subtests):
    """For any film, here a lopsided one: the pressure gradient has no integral."""
    for height in [1e-3, 1.0]:
        with subtests.test(height=height):
            mesh = Mesh(base_edges(0.5, 16.0) * np.sqrt(height), 24)
            gap = (height + mesh.nodes**2 / 2) * (1 + 0.5 * np.tanh(mesh.nodes) / (1 + mesh.nodes**2))
            flux_gap = reynolds.flux_gap(gap, mesh.weights)
            g = gradient(gap, flux_gap)
            assert abs(mesh.weights @ g) < 1e-13 * (mesh.weights @ np.abs(g))


def test_the_pressure_of_a_rigid_parabola_is_its_closed_form():
    """p_f/lambda = -x/(3 h**2) for h = h0 + x**2/2, h* = 4 h0/3."""
    mesh = Mesh(base_edges(0.25, 16.0), 24)
    x, gap = mesh.nodes, 0.5 + mesh.nodes**2 / 2
    pressure = RunningIntegral(mesh)(gradient(gap, 2 / 3))
    assert np.abs(pressure + x / (3 * gap * gap)).max() < 1e-12
