"""The coupled equations and what is observed of a state: derivatives against differences, steps, stacked states."""

import math

import numpy as np
import pytest
from scipy.optimize import minimize_scalar
from scipy.sparse.linalg import spsolve

import stribeck as sb
from stribeck import Groups
from stribeck.contacts.groups import contact_law
from stribeck.contacts.model import Model
from stribeck.equations.cavities.reformation import outflow
from stribeck.equations.drag import friction_scale
from stribeck.equations.error_estimate import FineOperators, gap_is_resolved, perturbations
from stribeck.equations.gap import gap_at, minimum_gap
from stribeck.equations.line import Equations, Operators
from stribeck.equations.observables import DRAG_ROWS, ROW, changes, observables, observables_of_stacked
from stribeck.equations.state import StackedStates
from stribeck.fluids.cavitation import Cavitation
from stribeck.numerics.fourier_panels import PolarMesh
from stribeck.numerics.panels import Mesh, base_edges
from stribeck.numerics.running_integral import RunningIntegral
from stribeck.quantities.outputs import NAMES
from stribeck.solver.cold_start import cold_start
from stribeck.solver.point.solve import solve_cold
from stribeck.solver.refinement import converge, verify

pytestmark = pytest.mark.quick

SEED = 64_217

STATES = {
    "fluid": (1e-2, 0.1, 3e-4),
    "smooth": (1e-2, 0.1, 0.0),
    "contact": (1e-6, 0.1, 1e-2),
    "mixed": (1e-4, 0.1, 2e-4),
    "quasistatic": (0.0, 0.1, 1e-2),
}
FLUX_SCALE = 0.37**2


def equations_of(speed, load, roughness, mesh):
    return Equations(Operators(mesh), speed, contact_law(Groups(speed, load, roughness)), FLUX_SCALE)


def unknowns(solution):
    """The unknowns of a solution in the order of the nodes of its mesh."""
    rank = np.argsort(np.argsort(solution.mesh.nodes))
    return np.concatenate([solution.gap[rank], [solution.offset, solution.flux_gap]])


@pytest.fixture(scope="module", params=STATES)
def case(request, solved):
    """Groups, and a state near the solution for them: Newton's path, where nothing cancels."""
    groups = STATES[request.param]
    solution = solved(*groups, rtol=1e-2)
    mesh = Mesh(solution.mesh.edges, solution.mesh.order)
    y = unknowns(solution)
    rng = np.random.default_rng(SEED)
    y[:-2] *= 1 + 0.02 * rng.normal(size=mesh.size)
    y[-2:] *= 1.01, 0.98
    return groups, mesh, y


def test_the_cases_are_what_their_names_say(solved):
    share = {name: solved(*groups, rtol=1e-2).contact_load_share for name, groups in STATES.items()}
    assert share["smooth"] == 0
    assert 1e-9 < share["fluid"] < 1e-3
    assert 0.2 < share["mixed"] < 0.8
    assert 1 - 1e-3 < share["contact"] < 1
    assert share["quasistatic"] == pytest.approx(1, abs=1e-6)


# Jacobian


def complex_jacobian(equations, y):
    """Derivative by steps along the imaginary axis, which cost no digits."""
    columns = []
    for j in range(len(y)):
        z = y.astype(complex)
        z[j] += 1e-30j
        columns.append(equations.residual(z).imag / 1e-30)
    return np.stack(columns, axis=1)


BLOCKS = {
    "gap of gap": (slice(None, -2), slice(None, -2)),
    "gap of offset": (slice(None, -2), -2),
    "gap of flux gap": (slice(None, -2), -1),
    "load of gap": (-2, slice(None, -2)),
    "load of offset": (-2, -2),
    "load of flux gap": (-2, -1),
    "flux of gap": (-1, slice(None, -2)),
    "flux of offset": (-1, -2),
    "flux of flux gap": (-1, -1),
}


def test_every_block_of_the_jacobian_is_the_derivative_of_the_residual(case):
    (speed, load, roughness), mesh, y = case
    equations = equations_of(speed, load, roughness, mesh)
    jacobian, differences = equations.jacobian(y), complex_jacobian(equations, y)
    for name, block in BLOCKS.items():
        exact = np.atleast_1d(differences[block])
        error = np.abs(np.atleast_1d(jacobian[block]) - exact)
        columns = np.abs(exact).max(axis=0)  # columns of far nodes are tiny beside those of the contact
        assert (error <= 1e-12 * columns + 1e-300).all(), name
        assert (columns.max() > 0) == (name not in expected_zero(speed)), name


def expected_zero(speed):
    always = {"load of offset", "flux of offset"}
    return always if speed > 0 else always | {"gap of flux gap", "load of flux gap"}


def test_the_jacobian_predicts_central_differences_along_any_direction(case):
    (speed, load, roughness), mesh, y = case
    equations = equations_of(speed, load, roughness, mesh)
    rng = np.random.default_rng(SEED + 1)
    decay = equations.law.decay_length or np.inf
    for _ in range(3):
        direction = np.append(np.minimum(y[:-2], decay), [1.0, y[-1]]) * rng.normal(size=len(y))
        step = 1e-5
        up, down = (equations.residual(y + d * direction) for d in (step, -step))
        exact = equations.jacobian(y) @ direction
        inside = np.append(np.abs(mesh.nodes) < 4, [True, True])
        error = np.abs((up - down) / (2 * step) - exact)[inside]
        assert error.max() < 1e-6 * np.abs(exact[inside]).max()


# Residual


def test_the_residual_vanishes_at_the_solution(solved):
    for groups in STATES.values():
        solution = solved(*groups)
        law = contact_law(Groups(*groups))
        equations = Equations(Operators(solution.mesh), groups[0], law, solution.flux_gap**2)
        residual = np.abs(equations.residual(unknowns(solution)))
        near = np.append(np.abs(solution.mesh.nodes) < 16, [True, True])
        assert residual[near].max() < 1e-11


def test_the_residual_is_gap_equation_load_and_flux(case):
    """Written once more, from the pressures."""
    (speed, load, roughness), mesh, y = case
    equations = equations_of(speed, load, roughness, mesh)
    contact, fluid = equations.pressures(y)
    operators = equations.operators
    residual = equations.residual(y)
    gap = y[-2] + mesh.nodes**2 / 2 + operators.deflection @ (contact + fluid)
    assert np.abs(residual[:-2] - (y[:-2] - gap)).max() < 1e-12 * np.abs(gap).max()
    assert abs(residual[-2] - (mesh.weights @ (contact + fluid) - math.pi / 2)) < 1e-11
    flux = mesh.weights @ ((y[:-2] - y[-1]) / y[:-2] ** 3)
    assert residual[-1] == pytest.approx(FLUX_SCALE * flux, rel=1e-12)
    assert np.allclose(contact, equations.law.pressure(y[:-2]), rtol=0, atol=0)


def test_at_speed_zero_there_is_no_fluid_pressure(solved):
    solution = solved(*STATES["quasistatic"], rtol=1e-2)
    assert np.array_equal(solution.fluid_pressure, np.zeros(solution.nodes))


# Parameter derivatives


@pytest.mark.parametrize("name", ["speed", "load", "roughness"])
def test_the_parameter_derivative_is_that_of_the_residual(case, name):
    groups, mesh, y = case
    step = 1e-4
    names = ("speed", "load", "roughness")
    residuals = []
    for d in (step, -step):
        moved = (value * math.exp(d) if n == name else value for n, value in zip(names, groups, strict=True))
        residuals.append(equations_of(*moved, mesh).residual(y))
    difference = (residuals[0] - residuals[1]) / (2 * step)
    derivative = equations_of(*groups, mesh).parameter_derivative(y, name)
    near = np.append(np.abs(mesh.nodes) < 2, [True, True])
    matters = groups[0] > 0 if name == "speed" else groups[2] > 0
    size = np.abs(derivative).max()
    assert size > 1e-7 if matters else size == 0
    assert np.abs(derivative - difference)[near].max() <= 1e-6 * size + 1e-11


# Steps


def test_an_admissible_step_keeps_the_gap_positive_and_the_contact_pressure_sane(case):
    (speed, load, roughness), mesh, y = case
    equations = equations_of(speed, load, roughness, mesh)
    rng = np.random.default_rng(SEED + 2)
    parts = []
    for size in 10.0 ** rng.uniform(-6, 4, 200):
        dy = size * y * rng.normal(size=len(y))
        part = equations.admissible(y, dy)
        moved = y + part * dy
        parts.append(part)
        assert 0 < part <= 1
        assert (moved[:-2] >= 0.3 * y[:-2] * (1 - 1e-9)).all()
        assert 0.3 * (1 - 1e-9) <= moved[-1] / y[-1] <= 1.7 * (1 + 1e-9)
        if roughness > 0:
            before, after = (equations.law.log_pressure(h[:-2]) for h in (y, moved))
            assert (after <= np.maximum(before + 3.0, 2.0) + 1e-9).all()
            assert (after >= before - 3.0 - 1e-9)[before > -7].all()
    assert max(parts) == 1.0
    assert min(parts) < 1e-2


def test_a_small_step_is_admissible_whole(case):
    (speed, load, roughness), mesh, y = case
    equations = equations_of(speed, load, roughness, mesh)
    assert equations.admissible(y, -1e-3 * y * np.append(np.ones(mesh.size), [0, 1])) == 1.0


# Operators


def test_the_operators_follow_from_deflection_and_running_integral():
    mesh = Mesh(np.array([-8.0, -2.0, -0.5, 0.0, 0.5, 1.0, 2.0, 8.0]), 8)
    operators = Operators(mesh)
    values = np.random.default_rng(SEED).normal(size=mesh.size) / (1 + mesh.nodes**4)
    pressure = RunningIntegral(mesh)(values)
    inside = np.arange(mesh.size) < mesh.size - mesh.order
    expected = [
        (operators.deflection_of_gradient @ values, operators.deflection @ pressure),
        (operators.load.of(operators.integral)(values), mesh.weights @ pressure),
        (mesh.arm.of(operators.integral)(values), (mesh.weights * mesh.nodes * pressure)[inside].sum()),
    ]
    for found, exact in expected:
        assert np.abs(found - exact).max() < 1e-12 * (1 + np.abs(exact).max())
    assert np.array_equal(operators.parabola, mesh.nodes**2 / 2)


# --- observables ---


OBSERVED_SEED = 45_389
OBSERVED = {
    "mixed": (1e-4, 0.1, 2e-4),
    "fluid": (1.0, 0.1, 1e-4),
    "contact": (1e-6, 0.1, 1e-2),
    "slow": (0.0, 5e-3, 1e-4),
}


@pytest.fixture(scope="module", params=OBSERVED)
def observed(request, solved):
    """Equations, unknowns and load of a solved state."""
    groups = Groups(*OBSERVED[request.param])
    s = solved(*OBSERVED[request.param], rtol=1e-9)
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
    x, rng = equations.operators.mesh.nodes, np.random.default_rng(OBSERVED_SEED)
    size = min(y[:-2].min(), equations.law.decay_length)
    for _ in range(4):
        centre, width = rng.uniform(-1, 1), rng.uniform(0.5, 1.5)
        gap = size * rng.normal() / (1 + ((x - centre) / width) ** 2)
        yield np.concatenate([gap, [rng.normal(), y[-1] * rng.normal()]])


@pytest.mark.parametrize("name", NAMES)
def test_the_gradient_of_each_observable_is_its_derivative(observed, name):
    equations, y, load = observed
    row = changes(equations, y, load, np.eye(y.size))[:, ROW[name]]
    for change in smooth_changes(equations, y):
        step = 1e-5
        up, down = (values(equations, y + d * change, load)[NAMES.index(name)] for d in (step, -step))
        difference = (up - down) / (2 * step)
        # The minimum gap answers at the node next to it.
        allowed = {"minimum_gap": 2e-2}.get(name, 1e-5)
        scale = np.abs(row) @ np.abs(change)
        assert abs(row @ change - difference) <= allowed * scale + 1e-13, name


# Central and minimum gap


def dipped(x, lowest):
    """A positive gap with one narrow dip."""
    return (1 + x * x / 20) * (1 - 0.3 / (1 + ((x - lowest) / 0.05) ** 2))


def test_the_minimum_gap_is_that_between_the_nodes(subtests):
    for lowest in [0.0, 0.013, 0.4999, 0.5, -0.77, 1.0]:
        with subtests.test(lowest=lowest):
            edges = np.concatenate([-np.array([8.0, 4, 2]), np.linspace(-1.25, 1.25, 51), [2.0, 4, 8]])
            mesh = Mesh(edges, 20)
            position, gap = minimum_gap(mesh, dipped(mesh.nodes, lowest))
            bounds = (lowest - 0.02, lowest + 0.02)
            exact = minimize_scalar(dipped, bounds=bounds, args=(lowest,), method="bounded", options={"xatol": 1e-10})
            assert gap == pytest.approx(exact.fun, rel=1e-9)
            assert position == pytest.approx(exact.x, abs=1e-6)
            assert gap <= dipped(mesh.nodes, lowest).min()


def test_a_minimum_gap_beyond_the_panel_of_the_minimum_node_is_found(subtests):
    for lowest in [0.5001, 0.4499]:
        with subtests.test(lowest=lowest):
            edges = np.array([-8.0, -4.0, -2.0, -1.0, 0.0, 0.25, 0.45, 0.5, 0.75, 1.0, 2.0, 4.0, 8.0])
            mesh = Mesh(edges, 20)
            gap = 1 + np.log1p((mesh.nodes - lowest) ** 2)
            assert 0.45 < mesh.nodes[np.argmin(gap)] < 0.5  # the narrow panel has the nearest node, its neighbour the minimum
            position, found = minimum_gap(mesh, gap)
            assert position == pytest.approx(lowest, abs=1e-7)
            assert found == pytest.approx(1.0, abs=1e-12)


def test_the_gap_between_the_nodes_is_interpolated_in_its_logarithm():
    mesh = Mesh(base_edges(0.25, 16.0), 16, 0.5)
    x = np.concatenate([np.random.default_rng(OBSERVED_SEED).uniform(-15, 15, 200), mesh.edges])

    def gap(x):
        return np.exp(8 * x / (1 + x * x) - 20 / (1 + x * x)) * (0.25 + x * x) / 2

    assert np.abs(gap_at(mesh, gap(mesh.nodes), x) / gap(x) - 1).max() < 1e-10


# --- stacked states ---

STACKED_SEED = 61_441
STACKED_RTOL = 1e-6


def stacked_rows(size, load=0.1, roughness=1e-3):
    """Equations of three stacked states, each state's own, and unknowns."""
    mesh = Mesh(base_edges(0.5, 8.0), size, 0.5)
    speeds = np.array([[1e-3], [2e-3], [5e-3]])
    groups = sb.Groups(speeds, np.full((3, 1), load), np.full((3, 1), roughness))
    scales = np.array([[0.01], [0.02], [0.03]])
    together = Equations(Operators(mesh), groups.speed, contact_law(groups), scales)
    alone = [
        Equations(together.operators, float(s), contact_law(sb.Groups(float(s), load, roughness)), float(scale))
        for s, scale in zip(speeds.ravel(), scales.ravel(), strict=True)
    ]
    gap = np.random.default_rng(STACKED_SEED).uniform(0.05, 0.1, (3, 1)) * (1 + mesh.nodes**2 * 6)
    return together, alone, np.hstack([gap, [[-0.1], [0.2], [0.3]], [[0.06], [0.07], [0.08]]])


def test_rows_are_what_each_state_is_alone():
    together, alone, y = stacked_rows(12)
    residuals, found = together.residual(y), observables_of_stacked(together, y, 0.1)
    times = np.arange(1.0, 4.0)[:, None]
    moved = changes(together, y, 0.1, times[:, None] * y)
    for i, equations in enumerate(alone):
        np.testing.assert_allclose(residuals[i], equations.residual(y[i]), rtol=1e-12, atol=1e-13)
        np.testing.assert_allclose(found[i].array(), observables(equations, y[i], 0.1).array(), rtol=1e-12, atol=1e-17)
        np.testing.assert_allclose(moved[:, i], changes(equations, y[i], 0.1, times * y[i]), rtol=1e-11, atol=1e-15)


def test_a_mesh_reads_off_the_gaps_where_its_estimate_says_so():
    groups = sb.Groups(0.05, 0.1, 1e-4)
    state = converge(cold_start(groups).states[-1], groups, STACKED_RTOL).state
    fine = FineOperators(state.mesh)
    error = verify(state, groups, fine, STACKED_RTOL).estimate.between_nodes
    assert gap_is_resolved(state.mesh, state.gap, 2 * error)
    assert not gap_is_resolved(state.mesh, state.gap, 0.1 * error)


def test_fine_panels_hold_the_far_gap_without_its_logarithm():
    # x**2/2 - ln|x|/2 + c is exact there: a change of friction on finer nodes would be an error of the estimate alone.
    mesh = Mesh(base_edges(1.0, 8.0), 12, 1.0)
    x = mesh.nodes
    gap = 0.5 * (x * x + 1.0) - 0.25 * np.log(x * x + 1.0) + 1.0
    y = np.append(gap, [1.0, 4 / 3])
    groups = sb.Groups(1.0, 0.1, 1e-4)
    equations = Equations(Operators(mesh), 1.0, contact_law(groups))
    observed = observables(equations, y, 0.1).array()
    rows = StackedStates(equations, y[None], 0.1, lambda r: r)
    found = perturbations(rows, observed[None], FineOperators(mesh)).friction[:, 0]
    assert (found[1:] <= 1e-9 * np.abs(observed[DRAG_ROWS[1:]])).all()  # the pressure of this gap is no polynomial


def reforming_ball(speed, kappa, cavity, load=1e-3):
    model = Model(cavitation=Cavitation.REFORM, cavity_pressure=cavity)
    return Groups(speed, load, kappa * load ** (2 / 3), geometry="point", model=model)


@pytest.mark.quick
def test_gas_goes_with_the_motion_and_gathers_what_is_released_on_its_way():
    errors = []
    for degree, modes in ((8, 40), (16, 80)):
        mesh = PolarMesh(np.array([0.0, 0.5, 1.0, 2.0, 6.0]), 3, degree, modes)
        x, y = (mesh.radii * turned(mesh.angles)[:, None] for turned in (np.cos, np.sin))
        leaves, area = outflow(mesh), np.pi / mesh.modes * mesh.ring_weights * mesh.radii
        assert np.abs((leaves @ np.ones(mesh.size)).reshape(x.shape)[:, :-1]).max() < 1e-12
        bump = np.exp(-((x - 0.3) ** 2 + y**2) / 0.3)
        assert abs((leaves @ bump.ravel()).sum()) < 1e-12
        found = spsolve(leaves, (-2 * (x - 0.3) / 0.3 * bump * area).ravel()).reshape(x.shape)
        errors.append(np.abs((found - bump) * area).sum() / (bump * area).sum())
    # First order; a bump as narrow as a panel is smeared much on the way.
    assert errors[1] < 0.3
    assert errors[0] / errors[1] > 1.5


@pytest.mark.quick
def test_liquid_is_conserved_on_its_way_through_the_cavity():
    state = solve_cold(reforming_ball(0.1, 0.1, -0.03), 1e-2)
    fine = state.work.fine
    equations, y = fine.equations, fine.unknowns
    gas, cavitated = equations.gas(y), y.fluid <= -0.03
    assert (gas[~cavitated] == 0).all()
    assert gas[cavitated].min() > -1e-12
    assert 0.1 < gas.max() < 1
    # What cavitated nodes lack goes on downstream, and nodes with a film that take it have nothing left over.
    flow = equations.flow(y.gap, y.fluid, y.offset)
    taken = np.abs(flow[~cavitated]).max()
    assert taken > 0.01 * np.abs(flow[cavitated]).max()
    assert np.abs(equations.passing(cavitated).rows(flow)).max() < 1e-3 * taken
