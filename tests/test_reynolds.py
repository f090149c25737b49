"""Reynolds' equation: derivatives against differences, the flux gap of films in closed form."""

import numpy as np
import pytest

from stribeck.fluids import newtonian as reynolds
from stribeck.numerics.panels import Mesh, base_edges
from stribeck.numerics.running_integral import RunningIntegral

pytestmark = pytest.mark.quick

SEED = 80_021


def gradient(gap, flux_gap):
    """Return that of an isoviscous film between smooth walls, over the speed group."""
    return reynolds.Newtonian().gradient(gap, None, flux_gap)


@pytest.fixture
def film():
    """Gaps of all sizes, and a flux gap."""
    return 10.0 ** np.random.default_rng(SEED).uniform(-8, 6, 60), 3e-3


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
