"""Observables: gradients against differences, friction integrals in closed form, minimum and central gap."""

import math

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from stribeck import Groups
from stribeck.contacts.groups import contact_law
from stribeck.equations.drag import friction_scale
from stribeck.equations.gap import gap_at, minimum_gap
from stribeck.equations.line import Equations, Operators
from stribeck.equations.observables import ROW, changes, observables
from stribeck.numerics.panels import Mesh, base_edges
from stribeck.quantities.outputs import NAMES

pytestmark = pytest.mark.quick

SEED = 45_389
STATES = {
    "mixed": (1e-4, 0.1, 2e-4),
    "fluid": (1.0, 0.1, 1e-4),
    "contact": (1e-6, 0.1, 1e-2),
    "slow": (0.0, 5e-3, 1e-4),
}


@pytest.fixture(scope="module", params=STATES)
def case(request, solved):
    """Equations, unknowns and load of a solved state."""
    groups = Groups(*STATES[request.param])
    s = solved(*STATES[request.param], rtol=1e-9)
    equations = Equations(Operators(s.mesh), groups.speed, contact_law(groups), s.flux_gap**2)
    rank = np.argsort(np.argsort(s.mesh.nodes))
    return equations, np.concatenate([s.gap[rank], [s.offset, s.flux_gap]]), groups.load


def values(equations, y, load):
    found = observables(equations, y, load)
    return np.array([getattr(found, name) for name in NAMES])


# Friction


def test_the_scale_of_friction_is_that_of_the_groups():
    """eta U a/(F_N u_Hz) = 2 F**(1/2) lambda/(3 pi) for beta = 1, from SI numbers."""
    radius, modulus, load, stress = 0.02, 3e6, 40.0, 0.05 * 0.3
    a = math.sqrt(4 * load * radius / (math.pi * modulus))
    speed = 3 * math.pi**2 / 4 * stress * radius * modulus / load**2
    group = load / (math.pi * radius * modulus)
    assert friction_scale(group, speed) == pytest.approx(stress * a / (load * a * a / radius), rel=1e-13)


def test_the_drag_of_a_known_gap_is_the_integral_of_its_shear_up_to_infinity():
    """With h = x**2/2 - ln(x**2 + 1)/4 + 1: shear 1/h + 3 h G on the substrate and 1/h - 3 h G on the cylinder."""

    def gap(x):
        return 1 + x * x / 2 - 0.25 * np.log1p(x * x)

    narrow, flux = Mesh(base_edges(0.25, 4.0), 10), 1.2
    y = np.concatenate([gap(narrow.nodes), [0.0, flux]])
    found = observables(Equations(Operators(narrow), 1.0, contact_law(Groups(1.0, 0.1, 1e-4))), y, 0.1)
    wide = Mesh(base_edges(0.25, 4096.0), 24)
    u = 1 / gap(wide.nodes)
    lower, upper = (friction_scale(0.1, 1.0) * (wide.weights @ (u * (1 + sign * 3 * (1 - flux * u)))) for sign in (1, -1))
    assert found.viscous_balanced == pytest.approx(lower, rel=1e-11)
    assert found.viscous_upper == pytest.approx(upper, rel=1e-11)


# Gradients


def smooth_changes(equations, y):
    """Changes of gap, offset and flux gap without noise from node to node."""
    x, rng = equations.operators.mesh.nodes, np.random.default_rng(SEED)
    size = min(y[:-2].min(), equations.law.decay_length)
    for _ in range(4):
        centre, width = rng.uniform(-1, 1), rng.uniform(0.5, 1.5)
        gap = size * rng.normal() / (1 + ((x - centre) / width) ** 2)
        yield np.concatenate([gap, [rng.normal(), y[-1] * rng.normal()]])


@pytest.mark.parametrize("name", NAMES)
def test_the_gradient_of_each_observable_is_its_derivative(case, name):
    equations, y, load = case
    row = changes(equations, y, load, np.eye(y.size))[:, ROW[name]]
    for change in smooth_changes(equations, y):
        step = 1e-5
        up, down = (values(equations, y + d * change, load)[NAMES.index(name)] for d in (step, -step))
        difference = (up - down) / (2 * step)
        # The minimum gap answers at the node next to it.
        allowed = {"minimum_gap": 2e-2}.get(name, 1e-5)
        scale = np.abs(row) @ np.abs(change)
        assert abs(row @ change - difference) <= allowed * scale + 1e-13, name


def test_at_speed_zero_only_contact_has_gradients(solved):
    s = solved(*STATES["slow"], rtol=1e-9)
    groups = Groups(*STATES["slow"])
    equations = Equations(Operators(s.mesh), 0.0, contact_law(groups), s.flux_gap**2)
    y = np.concatenate([s.nodal_gap, [s.offset, s.flux_gap]])
    rows = changes(equations, y, groups.load, np.eye(y.size)).T
    for name in ("fluid_load_share", "viscous_published", "viscous_balanced"):
        assert not rows[ROW[name]].any()


# Central and minimum gap


def dipped(x, lowest):
    """A positive gap with one narrow dip."""
    return (1 + x * x / 20) * (1 - 0.3 / (1 + ((x - lowest) / 0.05) ** 2))


@pytest.mark.parametrize("lowest", [0.0, 0.013, 0.4999, 0.5, -0.77, 1.0])
def test_the_minimum_gap_is_that_between_the_nodes(lowest):
    edges = np.concatenate([-np.array([8.0, 4, 2]), np.linspace(-1.25, 1.25, 51), [2.0, 4, 8]])
    mesh = Mesh(edges, 20)
    position, gap = minimum_gap(mesh, dipped(mesh.nodes, lowest))
    bounds = (lowest - 0.02, lowest + 0.02)
    exact = minimize_scalar(dipped, bounds=bounds, args=(lowest,), method="bounded", options={"xatol": 1e-10})
    assert gap == pytest.approx(exact.fun, rel=1e-9)
    assert position == pytest.approx(exact.x, abs=1e-6)
    assert gap <= dipped(mesh.nodes, lowest).min()


@pytest.mark.parametrize("lowest", [0.5001, 0.4499])
def test_a_minimum_gap_beyond_the_panel_of_the_minimum_node_is_found(lowest):
    edges = np.array([-8.0, -4.0, -2.0, -1.0, 0.0, 0.25, 0.45, 0.5, 0.75, 1.0, 2.0, 4.0, 8.0])
    mesh = Mesh(edges, 20)
    gap = 1 + np.log1p((mesh.nodes - lowest) ** 2)
    assert 0.45 < mesh.nodes[np.argmin(gap)] < 0.5  # the narrow panel has the nearest node, its neighbour the minimum
    position, found = minimum_gap(mesh, gap)
    assert position == pytest.approx(lowest, abs=1e-7)
    assert found == pytest.approx(1.0, abs=1e-12)


def test_the_gap_between_the_nodes_is_interpolated_in_its_logarithm():
    mesh = Mesh(base_edges(0.25, 16.0), 16, 0.5)
    x = np.concatenate([np.random.default_rng(SEED).uniform(-15, 15, 200), mesh.edges])

    def gap(x):
        return np.exp(8 * x / (1 + x * x) - 20 / (1 + x * x)) * (0.25 + x * x) / 2

    assert np.abs(gap_at(mesh, gap(mesh.nodes), x) / gap(x) - 1).max() < 1e-10


def test_a_gap_that_touches_zero_is_interpolated_itself():
    mesh = Mesh(np.array([-8.0, -4.0, -2.0, -1.0, 0.0, 1.0, 2.0, 4.0, 8.0]), 20)
    gap = np.where(np.abs(mesh.nodes) < 1, 0.0, (np.abs(mesh.nodes) - 1) ** 2)
    found = gap_at(mesh, gap, np.array([-0.3, 0.9, 1.5, -5.0]))
    assert np.abs(found - [0.0, 0.0, 0.25, 16.0]).max() < 1e-8
