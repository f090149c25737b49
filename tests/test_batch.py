"""Many states in one call: the same results as one by one, for every contact law, and nothing lost."""

import math

import numpy as np
import pytest

import stribeck as sb
from stribeck import Outcome

SHARES = ("contact_load_share", "fluid_load_share")
GROUPS = ("speed", "load", "roughness")
LAWS = {
    "exponential": None,
    "greenwood-williamson": sb.contact_laws.GreenwoodWilliamson(),
    "greenwood-tripp": sb.contact_laws.GreenwoodTripp(),
}


def crowd(number=12, seed=7_919, law=None):
    """States within a factor two in each group, on both sides of the mixed regime."""
    rng = np.random.default_rng(seed)
    speed, load, kappa = (centre * 1.4 ** rng.uniform(-1, 1, number) for centre in (3e-6, 0.1, 4e-3))
    return sb.Groups(speed, load, kappa * load, law=law)


def scattered(number=10, seed=104_729):
    """States decades apart in speed and load."""
    rng = np.random.default_rng(seed)
    kappa, load, speed = (10 ** rng.uniform(low, high, number) for low, high in ((-2, -1.5), (-6, -0.5), (-10, -6)))
    return sb.Groups(speed, load, kappa * load)


def joined(*parts):
    return sb.Groups(*(np.concatenate([np.broadcast_to(getattr(g, name), g.shape) for g in parts]) for name in GROUPS))


def one(groups, *i):
    return sb.Groups(*(float(np.broadcast_to(getattr(groups, name), groups.shape)[i]) for name in GROUPS), law=groups.law)


def assert_states_its_errors(found, exact, *i):
    """Assert that a state agrees with another within the errors that both state."""
    for name, errors in found.errors.items():
        value = getattr(exact, name)
        allowed = (errors[i] + exact.errors[name]) * (1.0 if name in SHARES else abs(value))
        assert math.isnan(value) or abs(getattr(found, name)[i] - value) <= allowed, name


@pytest.fixture(scope="module")
def found():
    return sb.solve_batch(joined(crowd(), scattered()))


def test_each_state_has_the_error_it_states(found):
    assert found.ok.all()
    assert (found.error_estimate <= 1e-6).all()
    for i in (0, 9, 12, 21):
        exact = sb.solve(one(found.groups, i), rtol=1e-9)
        assert_states_its_errors(found, exact, i)
        assert found.minimum_position[i] == pytest.approx(exact.minimum_position, abs=1e-3)
        for definition in ("published", "balanced"):
            expected = exact.friction(0.5, 0.03, definition).total
            assert found.friction(0.5, 0.03, definition)[i] == pytest.approx(expected, rel=1e-6)


def test_every_contact_law_can_be_solved(subtests):
    for law in LAWS:
        with subtests.test(law=law):
            groups = crowd(4, law=LAWS[law])
            found = sb.solve_batch(groups)
            assert found.ok.all()
            assert found.groups.law is LAWS[law]
            assert_states_its_errors(found, sb.solve(one(groups, 2)), 2)


def test_arrays_broadcast_and_every_state_comes_out_in_its_place():
    speed, roughness = np.array([[1e-3], [0.0]]), np.array([0.0, 1e-2, 1e-3])
    groups = sb.Groups(speed, 0.8, roughness)
    found = sb.solve_batch(groups)
    assert found.ok.all()
    assert found.central_gap.shape == (2, 3)
    assert found.relative_errors.shape[1:] == (2, 3)
    for i, j in [(0, 0), (0, 1), (1, 1), (1, 2)]:
        assert_states_its_errors(found, sb.solve(one(groups, i, j)), i, j)
    dry = sb.solve(one(groups, 1, 0))
    assert found.central_gap[1, 0] == dry.central_gap == 0.0
    assert found.offset[1, 0] == dry.offset


def test_an_error_of_the_program_is_no_outcome_of_a_state():
    broken = []

    def log_pressure(s):
        return 1 / 0 if broken else -s

    law = sb.contact_laws.FunctionLaw(log_pressure, lambda s: -np.ones_like(s))
    groups = crowd(law=law)
    broken.append(True)
    with pytest.raises(ZeroDivisionError):
        sb.solve_batch(groups)


def test_an_interrupted_run_keeps_what_is_done():
    seen = []

    def stop(done, total):
        seen.append((done, total))
        if done == 5:
            raise KeyboardInterrupt

    found = sb.solve_batch(crowd(), on_progress=stop)
    assert seen == [(done, 12) for done in (1, 2, 3, 4, 5)]
    assert found.ok.sum() == 5
    assert set(found.outcome[~found.ok]) == {Outcome.INTERRUPTED}
    assert np.isnan(found.central_gap[~found.ok]).all()


def test_one_state_is_an_array_without_axes_and_no_states_are_no_work():
    one, none = sb.solve_batch(sb.Groups(1e-5, 0.1, 1e-4)), sb.solve_batch(sb.Groups(np.zeros(0), 0.1, 1e-3))
    assert one.central_gap.shape == one.outcome.shape == () and one.ok
    assert none.central_gap.shape == none.error_estimate.shape == (0,)


def test_groups_made_of_others_share_their_physics():
    law = sb.contact_laws.GreenwoodTripp()
    ball = sb.Groups(1e-2, 1e-3, 1e-4, law=law, geometry="point")
    curve = sb.stribeck_curve(ball, load=np.array([1e-3, 2e-3]), rtol=1e-2)
    batch = sb.solve_batch(ball, load=[1e-3], rtol=1e-2)
    for groups in (curve.groups, curve.solutions[1].groups, batch.groups):
        assert (groups.law, groups.geometry, groups.model) == (law, "point", ball.model)
    line = sb.Groups(1e-3, 0.1, 1e-4, law=law)
    diagram = sb.phase_diagram(line, load=[0.1], roughness=[1e-4], speed=[1e-3], rtol=1e-4)
    assert diagram.attrs["contact_law"] == "greenwood-tripp"
    assert diagram.central_gap.item() == pytest.approx(sb.solve(line, rtol=1e-4).central_gap, rel=2e-4)
