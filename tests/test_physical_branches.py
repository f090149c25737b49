"""The lubrication problem followed along each of its groups, on one mesh, by both continuations.

In the state they start from asperities carry four fifths of the load; the branches reach from where these
carry all of it to where they carry none. Gaps run from 1e-3 in the contact to 6e3 at the ends of the mesh.
"""

import math

import numpy as np
import pytest

from stribeck.contacts.groups import contact_law
from stribeck.contacts.line import Groups
from stribeck.equations.line import Equations
from stribeck.numerics.arclength import trace
from stribeck.numerics.continuation import natural
from stribeck.solver.cold_start import cold_start

GROUPS = {"speed": 1e-5, "load": 0.1, "roughness": 1e-4}
SPAN = 1.5 * math.log(10.0)
"""A decade and a half, in the logarithm of a group."""

EACH_GROUP = pytest.mark.parametrize("name", list(GROUPS))
EACH_WAY = pytest.mark.parametrize("direction", [1, -1], ids=["up", "down"])


class Problem:
    """The discrete equations as functions of the unknowns y and p, the logarithm of one group."""

    def __init__(self, state, name):
        self.operators = state.equations.operators
        self.flux_scale = state.flux_gap**2
        self.name = name
        self.start = state.y
        self.parameter = math.log(GROUPS[name])

    def equations(self, p):
        groups = Groups(**(GROUPS | {self.name: math.exp(p)}))
        return Equations(self.operators, float(groups.speed), contact_law(groups), self.flux_scale)

    def residual(self, y, p):
        return self.equations(p).residual(y)

    def jacobian(self, y, p):
        return self.equations(p).jacobian(y)

    def derivative(self, y, p):
        return self.equations(p).parameter_derivative(y, self.name)

    def weight(self, y):
        """Relative change of the gaps and of the flux gap; the offset is of order one."""
        return 1.0 / (y.size * np.concatenate([y[:-2], [1.0], y[-1:]]) ** 2)

    def newton(self):
        """What Newton needs to know of gaps."""
        here = self.equations(self.parameter)
        return {"fraction": here.admissible, "size": here.size, "singular_below": 0.0}

    def trace(self, direction, **arguments):
        """Follow the branch from the state for a decade and a half by its arclength."""
        end = self.parameter + direction * SPAN
        return trace(
            self.residual,
            self.jacobian,
            self.derivative,
            self.start,
            self.parameter,
            direction=direction,
            bounds=(min(self.parameter, end), max(self.parameter, end)),
            weight=self.weight,
            **({"step": 0.2, "max_step": 0.5} | self.newton() | arguments),
        )

    def natural(self, parameters, **arguments):
        """Solve for the states at these parameters, each from those before it."""
        return natural(self.residual, self.jacobian, self.start, parameters, **(self.newton() | arguments))


@pytest.fixture(scope="module")
def state():
    path = cold_start(Groups(**GROUPS))
    assert path.outcome.ok
    return path.states[-1]


@pytest.fixture
def problem(state, name):
    return Problem(state, name)


def logarithms(y):
    """The unknowns in which weights of relative change are those of equal lengths."""
    return np.concatenate([np.log(y[..., :-2]), y[..., -2:-1], np.log(y[..., -1:])], axis=-1)


def furthest(points, others):
    """Largest difference of states: relative in the gaps and the flux gap, absolute in the offset."""
    return np.abs(logarithms(points) - logarithms(others)).max()


@EACH_GROUP
def test_the_derivative_by_a_group_is_the_limit_of_central_differences(problem):
    y, p = problem.start, problem.parameter
    exact = problem.derivative(y, p)

    def error(step):
        difference = (problem.residual(y, p + step) - problem.residual(y, p - step)) / (2.0 * step)
        return np.abs(difference - exact).max() / np.abs(exact).max()

    assert math.log10(error(1e-2) / error(1e-3)) == pytest.approx(2.0, abs=0.1)
    assert error(1e-4) < 1e-8


@EACH_WAY
@EACH_GROUP
def test_arclength_and_natural_continuation_pass_through_the_same_states(problem, direction):
    branch = problem.trace(direction)
    path = problem.natural(branch.parameters)
    assert branch.outcome.ok
    assert path.outcome.ok
    assert len(branch.points) > 6
    assert furthest(branch.points, np.array([path.at(p).x for p in branch.parameters])) < 1e-8
    for y, p in zip(branch.points, branch.parameters, strict=True):
        assert np.abs(problem.residual(y, p)).max() < 1e-9


@EACH_WAY
@EACH_GROUP
def test_a_branch_has_no_fold_over_a_decade_and_a_half(problem, direction):
    branch = problem.trace(direction)
    assert branch.outcome.ok
    assert branch.folds == ()
    assert branch.parameters[0] == problem.parameter
    assert branch.parameters[-1] == problem.parameter + direction * SPAN
    assert (direction * np.diff(branch.parameters) > 0.0).all()
    assert (direction * branch.tangents[:, -1] > 0.5).all()
    signs = [np.linalg.slogdet(problem.jacobian(y, p))[0] for y, p in zip(branch.points, branch.parameters, strict=True)]
    assert len(set(signs)) == 1
    # The gap that carries the flux grows with speed and roughness, and in Hertz units falls with the load.
    thickens = direction * (-1 if problem.name == "load" else 1)
    assert (thickens * np.diff(branch.points[:, -1]) > 0.0).all()


@EACH_GROUP
def test_the_arclength_measures_relative_changes(problem):
    # Neither the gaps of 1e-3 nor those of 6e3 swamp the others: each counts by its logarithm.
    lengths = []
    branch = problem.trace(1, max_step=0.2, on_point=lambda s, _: lengths.append(s))
    changes = np.diff(logarithms(branch.points), axis=0)
    chords = np.sqrt((changes**2).mean(axis=1) + np.diff(branch.parameters) ** 2)
    assert len(chords) > 15
    np.testing.assert_allclose(chords[:-1], np.diff(lengths)[:-1], rtol=0.05)  # a bound cuts the last
    assert chords.max() < 0.21


@EACH_WAY
@EACH_GROUP
def test_a_first_step_too_long_is_retried_shorter(problem, direction):
    lengths = []
    branch = problem.trace(direction, step=100.0, max_step=100.0, on_point=lambda s, _: lengths.append(s))
    assert branch.outcome.ok
    assert branch.failures > 0
    assert lengths[1] in {100.0 / 2.0**halvings for halvings in range(1, branch.failures + 1)}
    end = problem.parameter + direction * SPAN
    path = problem.natural([problem.parameter, end], max_steps=4)
    assert path.outcome.ok
    assert path.failures > 0
    assert branch.parameters[-1] == path.coordinates[-1] == end
    assert furthest(branch.points[-1], path.states[-1].x) < 1e-8


@pytest.mark.parametrize(("name", "direction"), [("speed", 1), ("load", 1), ("roughness", -1)])
def test_nothing_behind_a_step_that_failed_is_lost(problem, direction):
    # Steps grow until Newton does not converge in four, again and again along the branch.
    told = []
    branch = problem.trace(direction, step=0.1, max_step=100.0, max_steps=4, on_point=lambda s, point: told.append((s, point)))
    assert branch.outcome.ok
    assert branch.failures > 1
    assert told[1][0] == 0.1  # so every failure had points behind it
    np.testing.assert_array_equal(branch.points, [point.x for _, point in told])
    np.testing.assert_array_equal(branch.parameters, [point.parameter for _, point in told])
    assert (direction * np.diff(branch.parameters) > 0.0).all()
    path = problem.natural(branch.parameters)
    assert furthest(branch.points, np.array([path.at(p).x for p in branch.parameters])) < 1e-8
