"""The coupled equations: the Jacobian and the parameter derivatives against differences, admissible steps."""

import math

import numpy as np
import pytest

from stribeck import Groups
from stribeck.contacts.groups import contact_law
from stribeck.equations.line import Equations, Operators
from stribeck.numerics.panels import Mesh
from stribeck.numerics.running_integral import RunningIntegral

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


def test_the_jacobian_is_laid_out_for_lapack(case):
    (speed, load, roughness), mesh, y = case
    assert equations_of(speed, load, roughness, mesh).jacobian(y).flags.f_contiguous


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


def test_the_size_of_a_step_is_its_largest_relative_change_of_a_gap(case):
    (speed, load, roughness), mesh, y = case
    equations = equations_of(speed, load, roughness, mesh)
    step = np.zeros_like(y)
    step[[3, -2]] = 0.1 * y[3], 50.0
    assert equations.size(y, step) == pytest.approx(0.1)
    step[5] = -0.3 * y[5]
    assert equations.size(y, step) == pytest.approx(0.3)
    step[-1] = -0.8 * y[-1]
    assert equations.size(y, step) == pytest.approx(0.8)


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
