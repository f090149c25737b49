"""Deflection of the half-space: exact pairs of pressure and deflection, spectral rates."""

import numpy as np
import pytest

from stribeck.numerics.panels import Mesh, base_edges
from stribeck.solids import HalfPlane, hertz

pytestmark = pytest.mark.quick


def deflection(mesh, pressure):
    return HalfPlane().deflection(mesh) @ pressure


# Exact pairs


def lorentz(x):
    return 1 / (1 + x * x)


def lorentz_deflection(x):
    return -0.5 * np.log1p(x * x)


def hertz_pressure(x, e):
    """The Hertz pressure seen from the height e: smooth, with edges of width e."""
    z = x + 1j * e
    return (np.sqrt(z - 1) * np.sqrt(z + 1) - z).imag


def hertz_deflection(x, e):
    """Its deflection, but for a constant."""
    z = x + 1j * e
    s = np.sqrt(z - 1) * np.sqrt(z + 1)
    return -(z * z / 2 - (z * s - np.log(z + s)) / 2).real


def graded_to_both_edges(width, order):
    """Panels that halve towards x = -1 and x = 1 down to ``width``."""
    steps = 0.5 ** np.arange(1, 2 + int(np.ceil(-np.log2(width))))
    positive = np.concatenate([1 - steps, [1.0], 1 + steps[::-1], 2.0 ** np.arange(1, 5)])
    return Mesh(np.concatenate([-positive[::-1], [0.0], positive]), order)


def test_the_lorentz_pressure_bends_the_surface_as_a_logarithm():
    mesh = Mesh(base_edges(0.5, 8.0), 20)
    w = deflection(mesh, lorentz(mesh.nodes))
    exact = lorentz_deflection(mesh.nodes)
    assert np.abs(w - exact).max() < 1e-13


def test_the_smoothed_hertz_pressure_flattens_the_parabola(subtests):
    for e in [1e-2, 1e-3, 1e-4, 1e-5]:
        with subtests.test(e=e):
            mesh = graded_to_both_edges(e, 20)
            near = np.abs(mesh.nodes) < 3
            difference = (deflection(mesh, hertz_pressure(mesh.nodes, e)) - hertz_deflection(mesh.nodes, e))[near]
            assert np.ptp(difference) < 1e-14
            assert abs(difference[0] - (1 + np.log(4)) / 4) < 1e-14


def test_the_hertz_pressure_leaves_no_gap_inside_and_its_closed_form_outside():
    mesh = graded_to_both_edges(1e-13, 16)
    x = mesh.nodes
    gap = hertz.HERTZ_OFFSET + 0.5 * x**2 + deflection(mesh, hertz.pressure(x))
    near = np.abs(x) < 4
    assert np.abs(gap - hertz.gap(x))[near].max() < 1e-14
    assert np.abs(gap[np.abs(x) < 0.999]).max() < 1e-14


def test_pressure_on_the_panel_through_infinity_counts():
    mesh = Mesh(base_edges(0.5, 2.0), 24)
    beyond = np.where(np.abs(mesh.nodes) > 2, lorentz(mesh.nodes), 0.0)
    inside, outside = (deflection(mesh, p) for p in (lorentz(mesh.nodes) - beyond, beyond))
    assert (np.abs(outside) > 0.1).all()
    assert np.abs(inside + outside - lorentz_deflection(mesh.nodes)).max() < 1e-13


def test_the_deflection_converges_at_the_rate_of_the_nearest_pole():
    r"""Coefficients fall as :math:`\rho^{-n}`, log moments inside a panel as :math:`n^{-3/2}`."""
    edges = base_edges(1.0, 8.0)
    orders = np.arange(6, 19, 2)
    errors = []
    for order in orders:
        mesh = Mesh(edges, int(order))
        w = deflection(mesh, lorentz(mesh.nodes))
        errors.append(np.abs(w - lorentz_deflection(mesh.nodes))[np.abs(mesh.nodes) < 3].max())
    pole = (1j - 0.5) / 0.5  # of the pressure, seen from the panel [0, 1]
    stated = np.log(abs(pole - np.sqrt(pole * pole - 1)))
    rate = -np.polyfit(orders, np.log(errors * orders**1.5), 1)[0]
    assert abs(rate - stated) < 0.1
    assert errors[-1] < 1e-13
