"""States that are solved from others that are known: in batches, and one by one."""

import numpy as np
import pytest
from ball_data import BALL

import stribeck as sb
from stribeck.solver.neighbours import Neighbours


def disagreements(one, other):
    """Return how far each observable of two solutions differs, over the errors that both state."""
    for name, error in one.errors.items():
        a, b = getattr(one.observables, name), getattr(other.observables, name)
        if name != "minimum_position":  # which is flat
            scale = 1.0 if "share" in name else max(abs(b), 1e-300)
            yield abs(a - b) / scale / (error + other.errors[name])


def walk(random, sizes):
    """Return groups of cylinders, each by a random step from the one before."""
    speed, load, kappa = 10 ** random.uniform((-8, -4, -3.5), (1, -0.2, 0))
    logs = np.log10([speed, load, load * kappa])
    for size in sizes:
        yield sb.Groups(*map(float, 10**logs))
        logs = logs + random.normal(0, size, 3)


def test_a_state_does_not_depend_on_what_it_was_solved_from():
    random, neighbours = np.random.default_rng(771204), Neighbours(1e-6)
    for _ in range(4):
        for groups in walk(random, (0.02, 0.1, 0.3, 0.6)):
            assert max(disagreements(neighbours.solution(groups), sb.solve(groups))) < 1


def test_rest_smooth_and_dry_contacts_are_ordinary_states_between_others():
    neighbours = Neighbours(1e-6)
    for speed, roughness in ((1e-4, 1e-3), (0.0, 1e-3), (0.0, 0.0), (1e-4, 0.0), (1e-4, 1e-3)):
        groups = sb.Groups(speed, 0.1, roughness)
        assert max(disagreements(neighbours.solution(groups), sb.solve(groups))) < 1


def test_after_a_failure_the_next_state_is_solved():
    neighbours = Neighbours(1e-9)
    assert neighbours.solution(sb.Groups(1.0, 0.1, 1e-2)).outcome.ok
    with pytest.raises(sb.SolveError, match="speed 1e-12"):  # rounding bounds so thin a film to 1e-7
        neighbours.solution(sb.Groups(1e-12, 0.9, 0.0))
    assert neighbours.solution(sb.Groups(1.1, 0.1, 1e-2)).outcome.ok


@pytest.mark.parametrize("fluid", [None, sb.fluids.Carreau("2 ms", 0.5)])
def test_a_ball_takes_fewer_steps_from_others_on_a_line_with_it(fluid):
    neighbours, contact = Neighbours(1e-4), BALL.replace(fluid=fluid)
    states = [neighbours.at(contact.replace(speed=factor * BALL.speed).groups) for factor in (1.0, 1.1, 1.21, 1.331)]
    cold = sb.solve(contact.replace(speed=1.331 * BALL.speed), rtol=1e-4)
    assert states[-1].newton_steps < states[1].newton_steps
    assert states[-1].values["central_gap"] == pytest.approx(cold.central_gap, rel=2e-4)


def test_a_state_that_was_solved_is_not_solved_again_and_only_the_last_keeps_its_factors():
    neighbours = Neighbours(1e-3)
    first = neighbours.at(BALL.groups)
    assert first.work.fine.iterated.preconditioner is not None
    again = neighbours.at(BALL.replace(boundary_friction=0.1).groups)
    assert again.work.fine.iterated.preconditioner is None
    assert again.nodal_gap is first.nodal_gap


def test_the_kind_of_a_fluid_and_zeros_part_neighbours():
    neighbours = Neighbours(1e-4)
    for contact in (BALL, BALL.replace(speed=0.0), BALL.replace(fluid=sb.fluids.Carreau("2 ms", 0.5)), BALL):
        solved = neighbours.solution(contact.groups, contact)
        assert solved.friction().total == pytest.approx(sb.solve(contact, rtol=1e-4).friction().total, rel=1e-3)
