"""Fluid, cavitation and solid as parts of a model: states with each against an independent solver.

The reference values of tests/data/fluids.json were computed with another program of the same equations; its "change" is how
much they moved when every panel was halved.
"""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.sparse.linalg import gmres

import stribeck as sb
from stribeck.contacts.groups import contact_law
from stribeck.contacts.model import Model
from stribeck.contacts.with_parts import with_parts
from stribeck.equations import line
from stribeck.equations.gap import gap_at, minimum_gap
from stribeck.equations.line import LOAD, Equations, Operators
from stribeck.equations.prediction import SeenFrom
from stribeck.equations.state import mesh_for, solve_state
from stribeck.fluids import Barus, DowsonHigginson
from stribeck.fluids.cavitation import Cavitation
from stribeck.fluids.newtonian import Newtonian
from stribeck.fluids.rheology.viscosity import check_range
from stribeck.numerics.newton import StepControl, root_find
from stribeck.numerics.panels import Mesh
from stribeck.numerics.running_integral import RunningIntegral, Volterra
from stribeck.solids import HalfPlane, Layer
from stribeck.solids.layer import transfer
from stribeck.solver.cold_start import cold_start
from stribeck.solver.solve import spike_note

REFERENCE = json.loads((Path(__file__).parent / "data" / "fluids.json").read_text())
BARUS = [row for row in REFERENCE["b_d_e"] if row["case"] == "barus"]
EXIT = [row for row in REFERENCE["a_free_exit"] if row["speed"] in (1e-5, 1e-3, 3e-5, 1e-2, 1.0)]


def solved(model, speed, load, kappa, guess=None):
    """Return a state of a model on a mesh that resolves it to about 1e-7, from the state of the article or from ``guess``."""
    groups = sb.Groups(speed, load, kappa * load)
    if guess is None:
        guess = cold_start(groups).states[-1]
        if model.cavitation is Cavitation.EXIT:
            guess = SeenFrom(guess, where_pressure_ends(guess))
    for step in towards(model):
        for tolerance in (1e-3, 1e-4, 1e-6, 1e-8) if step is model else (1e-3,):
            mesh = mesh_for(guess, groups, contact_law(groups), 12, tolerance, 0.01 * tolerance, anew=False)
            if model.cavitation is Cavitation.EXIT:
                mesh = graded(mesh)
            guess = solve_state(groups, Operators(mesh, step), guess, 1e-10, max_steps=100)
            assert guess.outcome.ok, guess.outcome
    return guess


def where_pressure_ends(state):
    """Return where the fluid pressure of a full film falls to zero behind its maximum."""
    x = np.linspace(-1.5, 1.5, 3001)
    pressure = state.fields(x)[1]
    behind = np.flatnonzero(pressure[np.argmax(pressure) :] <= 0)
    return x[np.argmax(pressure) + behind[0]]


def towards(model):
    """Yield models on the way: a thin layer by thicker ones."""
    if isinstance(model.solid, Layer):
        for thickness in (1.0, 0.7):
            if model.solid.layer_thickness < thickness:
                yield replace(model, solid=replace(model.solid, layer_thickness=thickness))
    yield model


def graded(mesh):
    """Return the mesh with panels that halve towards the exit and reach far out."""
    near = 2.0 ** -np.arange(2.0, 9.0)
    far = mesh.edges[-1] * 2.0 ** np.arange(1, 6)
    return Mesh(np.unique(np.concatenate([mesh.edges, near, -near, far, -far])), mesh.order, mesh.scale)


def observed(state):
    """Return central gap, minimum gap, flux gap, contact share and exit."""
    mesh, gap = state.mesh, state.gap
    share = state.equations.pressures(state.y)[0] @ mesh.weights / LOAD
    central = gap_at(mesh, gap, np.array([-state.exit]))[0]
    return {"h0": central, "hmin": minimum_gap(mesh, gap)[1], "m": state.flux_gap, "contact_share": share, "xc": state.exit}


@pytest.mark.parametrize("row", EXIT, ids=lambda row: f"{row['speed']:g}")
def test_a_film_with_a_free_exit_is_that_of_an_independent_solver(row):
    found = observed(solved(Model(cavitation=Cavitation.EXIT), row["speed"], row["load"], row["kappa"]))
    tolerance = max(1e-6, 20 * row["refinement_change"])
    assert found == pytest.approx({name: row[name] for name in found}, rel=tolerance, abs=1e-9)


@pytest.mark.parametrize("row", BARUS, ids=lambda row: f"{row['a_bar']:g}-{row['kappa']:g}")
def test_a_film_that_stiffens_under_pressure_is_that_of_an_independent_solver(row):
    model = Model(film=Newtonian(Barus(row["a_bar"])), cavitation=Cavitation.EXIT)
    found = observed(solved(model, row["speed"], row["load"], row["kappa"]))
    assert found == pytest.approx({name: row[name] for name in found}, rel=1e-6, abs=1e-9)


@pytest.mark.parametrize("row", REFERENCE["f_layer_lubricated"], ids=lambda row: f"{row['d']:g}-{row['kappa']:g}")
def test_a_film_on_a_bonded_layer_is_that_of_an_independent_solver(row):
    model = Model(cavitation=Cavitation.EXIT, solid=Layer(row["d"], row["nu"]))
    found = observed(solved(model, row["speed"], row["load"], row["kappa"]))
    assert found == pytest.approx({name: row[name] for name in found}, rel=1e-6, abs=1e-9)


# The parts by themselves


@pytest.fixture(scope="module")
def stiffening():
    """Return a state with all that the article has not: a stiffening fluid that ends at an exit, on a layer."""
    return solved(Model(Newtonian(Barus(1.0)), Cavitation.EXIT, Layer(3.0)), 1e-3, 0.1, 1e-2)


def stacked(layout, gap, pressure, offset, flux_gap, leaving, cavity_stretch):
    """Return the vector of these unknowns, as far as the layout has them."""
    y = np.empty(layout.size)
    y[layout.gap], y[layout.offset], y[layout.flux_gap], y[layout.exit] = gap, offset, flux_gap, leaving
    y[layout.cavity_stretch] = cavity_stretch
    if layout.pressure.start < layout.pressure.stop:
        y[layout.pressure] = pressure
    return y


@pytest.mark.parametrize("cavitation", list(Cavitation))
@pytest.mark.parametrize(
    ("film", "growth"), [(Newtonian(), 10.0), (Newtonian(Barus(1.5)), 10.0), (Newtonian(Barus(1.5)), 0.0)]
)
def test_the_inverse_undoes_the_derivative_of_the_residual(film, growth, cavitation, stiffening, monkeypatch):
    """The last by LU factors of all unknowns, as where a thin film is compressed."""
    monkeypatch.setattr(line, "MAX_LOG_GROWTH", growth)
    mesh = replace(stiffening.mesh, reformation=0.25)
    operators = Operators(mesh, Model(film, cavitation, cavity_pressure=-0.02))
    equations = Equations(operators, 1e-3, stiffening.equations.law, stiffening.flux_gap**2)
    layout, rng = equations.layout, np.random.default_rng(83)
    pressure = stiffening.equations.pressures(stiffening.y)[1]
    y = stacked(layout, stiffening.gap, pressure, -0.3, 1.1 * stiffening.flux_gap, 0.9, 1.2)
    units = equations.units(y)
    smooth = np.cos(rng.uniform(1, 3) * np.arctan(operators.mesh.nodes))
    step = stacked(layout, smooth, smooth, 0.7, -0.4, 0.2, 0.3)
    size = 1e-6

    def slope(along):
        ahead, behind = (equations.residual(y + sign * size * units * along) for sign in (1, -1))
        return (behind - ahead) / (2 * size)

    # Through the residual again: the step itself is known to a condition number times the rounding only.
    wanted = slope(step)
    np.testing.assert_allclose(slope(equations.inverse(y)(wanted)), wanted, rtol=0, atol=1e-7 * np.abs(wanted).max())


def test_equations_are_solved_by_an_iterative_inverse_too(stiffening):
    class Iterative:
        failure, is_finite = None, True

        def __init__(self, matrix):
            self.matrix = matrix

        def __call__(self, residuals):
            rows = np.abs(self.matrix).max(axis=1)
            solution, failed = gmres(self.matrix / rows[:, None], -residuals / rows, rtol=1e-13, restart=len(residuals))
            assert not failed
            return solution

    class ByIteration(Equations):
        def inverse(self, y):
            return Iterative(self.jacobian(y, self.units(y)))

    groups = sb.Groups(1e-2, 0.1, 1e-2)
    state = cold_start(groups).states[-1]
    dense = state.equations
    iterative = ByIteration(dense.operators, dense.speed, dense.law, dense.flux_scale)
    start = state.y * np.where(np.arange(len(state.y)) < state.mesh.size, 1.02, 1.0)
    found = [root_find(each, start, StepControl(1e-10)) for each in (dense, iterative)]
    assert [root.outcome.ok for root in found] == [True, True]
    np.testing.assert_allclose(found[1].x, found[0].x, rtol=1e-9)


@pytest.mark.parametrize("reformation", [0.0, 1.0, np.inf])
def test_a_volterra_equation_is_solved_as_by_its_matrix(reformation):
    mesh = Mesh(np.array([-4.0, -2, -1, -0.5, 0, 0.5, 1, 2, 4]), 8)
    integral = RunningIntegral(mesh, reformation)
    rng = np.random.default_rng(11)
    matrix = np.stack([integral(column) for column in np.eye(mesh.size)], axis=1)
    factor = rng.uniform(-1, 1, mesh.size) / (1 + mesh.nodes**4)
    exact = np.linalg.solve(np.eye(mesh.size) - matrix * factor, matrix)
    volterra, values, rows = Volterra(integral, factor), rng.normal(size=(2, mesh.size)), rng.normal(size=(3, mesh.size))
    np.testing.assert_allclose(volterra(values), values @ exact.T, atol=1e-11 * np.abs(exact).max())
    np.testing.assert_allclose(volterra.after(rows), rows @ exact, atol=1e-11 * np.abs(exact).max())


def test_without_a_factor_volterras_equation_is_the_integral():
    mesh = Mesh(np.array([-4.0, -2, -1, 0, 1, 2, 4]), 6)
    integral = RunningIntegral(mesh)
    rows = np.random.default_rng(3).normal(size=(2, mesh.size))
    np.testing.assert_allclose(
        Volterra(integral, np.zeros(mesh.size)).after(rows), integral.after(rows), rtol=1e-12, atol=1e-9
    )


def test_a_fluid_that_hardly_stiffens_is_newtonian():
    exit_film = Model(cavitation=Cavitation.EXIT)
    plain = observed(solved(exit_film, 1e-2, 0.1, 1e-2))
    changes = []
    for coefficient in (0.0, 1e-3, 2e-3):
        found = observed(solved(replace(exit_film, film=Newtonian(Barus(coefficient))), 1e-2, 0.1, 1e-2))
        changes.append(found["h0"] / plain["h0"] - 1)
    assert abs(changes[0]) < 1e-9
    assert changes[2] / changes[1] == pytest.approx(2.0, abs=0.01)


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


@pytest.mark.parametrize(
    ("coefficient", "cavitation", "highest"), [(4.74106, "none", 1.545), (4.96020, "none", 1.745), (5.0, "exit", 1.365)]
)
def test_the_spike_of_a_thick_film_rises_as_in_finite_differences(coefficient, cavitation, highest):
    """In a full film by 500 of them that double towards the spike; the film that ends was not found."""
    found = sb.solve(sb.Groups(0.27, 0.01, 0.0), fluid=Barus(coefficient), cavitation=cavitation, rtol=1e-4)
    assert found.fluid_pressure.max() == pytest.approx(highest, rel=1e-2)


@pytest.mark.parametrize(("fluid", "said"), [(sb.fluids.Roelands(4.5, 9.6, 2.7e-4), "spike"), (Barus(1.0), "")])
def test_a_failure_of_a_stiff_fluid_names_the_spike(fluid, said):
    told = spike_note(with_parts(sb.Groups(0.27, 1.5e-4, 2e-7), fluid=fluid))
    assert said in told if said else told == ""


def test_a_pressure_coefficient_out_of_range_is_refused_and_names_who_solves_it():
    with pytest.raises(sb.InputError, match=r"pressure_coefficient times .*hard elastohydrodynamics"):
        check_range(Barus(5.5))


@pytest.mark.parametrize(
    "arguments", [{"layer_thickness": 0.0}, {"layer_thickness": np.inf}, {"layer_thickness": 1.0, "poisson_ratio": 0.6}]
)
def test_a_layer_out_of_range_is_refused(arguments):
    with pytest.raises(sb.InputError, match="must|finite"):
        Layer(**arguments)


def test_the_layers_transfer_function_has_its_known_values_and_limits():
    np.testing.assert_allclose(transfer(np.array([0.5, 1.0, 2.0]), 0.5), [0.0575736, 0.2405817, 0.6414500], rtol=2e-6)
    assert transfer(np.array([0.1]), 0.3)[0] == pytest.approx(0.0408450, rel=2e-6)
    x = np.array([1e-4, 1e-3])
    np.testing.assert_allclose(transfer(x, 0.5) / (2 * x**3 / 3), 1.0, rtol=1e-5)
    np.testing.assert_allclose(transfer(x, 0.3) / (x * 0.4 / (2 * 0.7**2)), 1.0, rtol=1e-2)
    assert transfer(np.array([30.0]), 0.4)[0] == pytest.approx(1.0, abs=1e-12)


@pytest.mark.parametrize("key", REFERENCE["f_layer_operator_gaussian"]["w"])
def test_the_deflection_of_a_layer_under_a_gaussian_is_its_fourier_integral(key):
    reference = REFERENCE["f_layer_operator_gaussian"]
    thickness, poisson_ratio = map(float, key.split(","))
    edges = np.arange(-4, 4.01, 0.0625)
    mesh = Mesh(np.concatenate([[-64, -32, -16, -8], edges, [8, 16, 32, 64]]), 12)
    pressure = np.exp(-(mesh.nodes**2) / (2 * reference["s"] ** 2))
    deflection = Layer(thickness, poisson_ratio).deflection(mesh) @ pressure
    np.testing.assert_allclose(mesh.interpolate(deflection, np.array(reference["x"])), reference["w"][key], atol=1e-9)


def test_a_thick_layer_is_the_half_plane_but_for_its_offset():
    mesh = Mesh(np.array([-4.0, -2, -1, -0.5, 0, 0.5, 1, 2, 4]), 12)
    pressure = np.sqrt(np.maximum(0.0, 1 - mesh.nodes**2))
    inside = np.abs(mesh.nodes) < 2
    plane = HalfPlane().deflection(mesh) @ pressure
    differences = []
    for thickness in (100.0, 200.0):
        layer = Layer(thickness).deflection(mesh) @ pressure
        differences.append(np.ptp((layer - plane)[inside]))
    assert differences[0] < 1e-3
    assert differences[0] / differences[1] == pytest.approx(4.0, rel=0.05)


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
