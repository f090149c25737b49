"""States that are solved from the last one."""

from dataclasses import replace

import numpy as np
import pytest

import stribeck as sb
from stribeck.solver.nearby import WarmStartSolver
from stribeck.solver.path.corrector import Corrector


def disagreements(near, state):
    """Return how far each observable of two states differs, over the errors that both state."""
    cold = sb.solve(state)
    solution = near(state)
    for name, error in solution.errors.items():
        one, two = getattr(solution.observables, name), getattr(cold.observables, name)
        if name != "minimum_position":  # which is flat, and not among what the page shows
            scale = 1.0 if "share" in name else max(abs(two), 1e-300)
            yield abs(one - two) / scale / (error + cold.errors[name])


def test_a_state_does_not_depend_on_what_it_was_solved_from():
    random = np.random.default_rng(771204)
    near = WarmStartSolver()
    for _ in range(4):
        speed, load, kappa = 10 ** random.uniform((-8, -4, -3.5), (1, -0.2, 0))
        logs = np.log10([speed, load, load * kappa])
        for size in (0.02, 0.1, 0.3, 0.6):
            assert max(disagreements(near, sb.Groups(*map(float, 10**logs)))) < 1
            logs = logs + random.normal(0, size, 3)


def test_rest_smooth_and_dry_contacts_are_ordinary_states_between_others():
    near = WarmStartSolver()
    for state in (
        sb.Groups(1e-4, 0.1, 1e-3),
        sb.Groups(0.0, 0.1, 1e-3),
        sb.Groups(0.0, 0.1, 0.0),
        sb.Groups(1e-4, 0.1, 0.0),
        sb.Groups(1e-4, 0.1, 1e-3),
    ):
        assert max(disagreements(near, state)) < 1


def test_a_near_state_comes_from_the_last_one(monkeypatch):
    near = WarmStartSolver()
    near(sb.Groups(1e-4, 0.1, 1e-3))
    monkeypatch.setattr("stribeck.solver.nearby.solved_point", lambda *_: pytest.fail("solved from cold"))
    assert near(sb.Groups(1.1e-4, 0.1, 1e-3)).outcome.ok
    assert near(sb.Groups(1.1e-4, 0.11, 1e-3)).outcome.ok


def test_what_does_not_converge_from_the_last_state_is_solved_from_cold(monkeypatch):
    near, state = WarmStartSolver(), sb.Groups(1.1e-4, 0.1, 1e-3)
    near(sb.Groups(1e-4, 0.1, 1e-3))
    follow = Corrector.__call__
    monkeypatch.setattr(Corrector, "__call__", lambda *a: replace(follow(*a), outcome=sb.Outcome.REFINEMENT_LIMIT))
    assert near(state).outcome.ok
    assert max(disagreements(near, state)) < 1


def test_after_a_failure_the_next_state_is_solved():
    near = WarmStartSolver(rtol=1e-9)
    near(sb.Groups(1.0, 0.1, 1e-2))
    with pytest.raises(sb.SolveError):  # rounding bounds so thin a film to 1e-7
        near(sb.Groups(1e-12, 0.9, 0.0))
    assert near(sb.Groups(1.0, 0.1, 1e-2)).outcome.ok


def test_a_tolerance_out_of_range_is_refused():
    with pytest.raises(sb.InputError, match="rtol = 1.0; it must be a number"):
        WarmStartSolver(1.0)
