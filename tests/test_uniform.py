"""The laws for every speed: load sharing and friction against solved states, and their limits."""

import warnings

import numpy as np
import pytest

import stribeck as sb
from stribeck.asymptotics import OutOfRangeWarning, hydrodynamic, load_sharing, perturbation, uniform, wedge

STATES = 60
SPEEDS = np.geomspace(1e-9, 1e2, 12)


@pytest.fixture(scope="module")
def solved():
    """Groups and solutions over the box of the laws, on states they were not fitted to."""
    rng = np.random.default_rng(70321)
    solutions = []
    for _ in range(STATES // len(SPEEDS)):
        load, kappa = np.exp(rng.uniform(np.log([1e-4, 1e-4]), np.log([0.7, 1e-1])))
        speeds = SPEEDS * np.exp(rng.uniform(0, 2, len(SPEEDS)))
        speeds = np.sort(np.minimum(speeds, 99.0))
        curve = sb.stribeck_curve(load=load, roughness=kappa * load, speed=speeds, rtol=1e-6)
        solutions += curve.solutions
    groups = sb.Groups(*(np.array([getattr(s.groups, name) for s in solutions]) for name in ("speed", "load", "roughness")))
    return groups, solutions


def test_friction_is_within_three_percent_in_the_median_and_the_stated_worst(subtests, solved):
    for definition in ["published", "balanced"]:
        for beta in [1.0, 0.03]:
            with subtests.test(definition=definition, beta=beta):
                groups, solutions = solved
                right = np.array([s.friction(1.0, beta, definition).total for s in solutions])
                error = np.abs(uniform.friction(groups, 1.0, beta, definition) / right - 1)
                assert np.median(error) < 0.003
                assert np.quantile(error, 0.9) < 0.02
                assert np.mean(error < 0.03) > 0.94 and np.mean(error < 0.01) > 0.85  # as validity.md says
                assert error.max() < uniform.friction.worst


def test_the_contact_share_is_good_to_the_stated_error_down_to_a_millionth(solved):
    groups, solutions = solved
    share = np.array([s.contact_load_share for s in solutions])
    counts = share > 1e-6
    assert counts.sum() > 30
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", OutOfRangeWarning)  # where nothing is left of the share
        found = load_sharing.contact_load_share(groups)
    assert np.abs(found[counts] / share[counts] - 1).max() < load_sharing.contact_load_share.worst
    assert (found[~counts] < 2e-6).all()


@pytest.mark.quick
def test_speed_and_share_are_inverse_to_each_other():
    shares = np.array([1e-9, 1e-3, 0.05, 0.5, 0.95, 0.9999])
    base = sb.Groups(np.ones(6), 0.03, 0.03 * 2e-3)
    speeds = load_sharing.speed_at_fluid_share(base, shares)
    assert (np.diff(speeds) > 0).all()
    contact = load_sharing.contact_load_share(sb.Groups(speeds, 0.03, 0.03 * 2e-3))
    assert contact == pytest.approx(1 - shares, rel=1e-9)


@pytest.mark.quick
def test_slow_contacts_share_the_load_as_the_perturbation_says(subtests):
    for load in [1e-4, 0.1, 0.69]:
        with subtests.test(load=load):
            # The law has phi in closed form, good to 0.33 %, and a correction of order kappa**(2/3).
            kappa, errors = np.array([1e-6, 1e-9, 1e-12]), []
            for k in kappa:
                speed = 1e-3 * k**2 * perturbation.phi(load) ** -0.5
                odds = load_sharing.log_odds(sb.Groups(speed, load, k * load))
                errors.append(np.exp(odds) / 1e-6 - 1)
            assert abs(errors[-1]) < 0.01
            assert abs(errors[0] - errors[-1]) < 0.02


@pytest.mark.quick
def test_fast_contacts_have_the_friction_of_the_smooth_film():
    groups = sb.Groups([1.0, 10.0, 100.0], 0.1, 1e-4)
    for definition in ("published", "balanced"):
        assert uniform.friction(groups, definition=definition) == pytest.approx(
            hydrodynamic.friction_uniform(groups), rel=1e-9
        )


@pytest.mark.quick
def test_contacts_at_rest_and_without_roughness_are_exact():
    groups = sb.Groups([0.0, 1e-3, 1e-3], [0.1, 0.1, 0.1], [1e-4, 0.0, 1e-4])
    with pytest.warns(OutOfRangeWarning):
        share = load_sharing.contact_load_share(groups)
    assert share[0] == 1.0 and share[1] == 0.0 and 0 < share[2] < 1
    with pytest.warns(OutOfRangeWarning):
        friction = uniform.friction(groups, boundary_friction=0.7)
    assert friction[0] == 0.7
    assert friction[1] == hydrodynamic.friction_uniform(sb.Groups(1e-3, 0.1, 0.0))


# --- the limit of small roughness at a fixed fluid number ---


@pytest.mark.quick
def test_the_wedge_obeys_its_equations(subtests):
    for load, number in [(1e-4, 300.0), (0.1, 10.0), (0.7, 1.0)]:
        with subtests.test(load=load, number=number):
            state = wedge.wedge(load, number)
            x, h = state.x, state.gap
            contact = load**-0.5 * np.exp(-h)
            assert contact + state.fluid_pressure == pytest.approx(np.sqrt((1 - x) * (1 + x)), abs=1e-7)
            inside = np.abs(x) < 0.9
            slope = np.gradient(state.fluid_pressure[inside], x[inside], edge_order=2)[1:-1]
            right = (number * (h - state.flux_gap) / h**3)[inside][1:-1]
            assert np.abs(slope - right).max() < 0.01 * np.abs(right).max()
            assert np.abs(state.fluid_pressure[[0, -1]]).max() < 1e-9


@pytest.mark.quick
def test_a_slow_wedge_carries_what_the_perturbation_says(subtests):
    for load in [1e-4, 0.1, 0.7]:
        with subtests.test(load=load):
            share = np.array([1e-4, 1e-5])
            numbers = np.sqrt(share / perturbation.phi(load))
            found = np.array([1 - wedge.wedge(load, float(n)).contact_load_share for n in numbers])
            error = np.abs(found / share - 1)
            assert error[1] < 0.2 * error[0] + 1e-6
            assert error[0] < 0.01


def test_the_law_of_load_sharing_follows_the_wedge_where_roughness_is_small():
    for load in (1e-4, 1e-2, 0.1, 0.6):
        for share in (0.9, 0.5, 0.2):
            speed = load_sharing.speed_at_fluid_share.function(sb.Groups(1.0, load, 1e-12 * load), 1 - share)
            assert abs(wedge.wedge(load, float(speed) / 1e-24).contact_load_share / share - 1) < 0.06


def test_a_wedge_that_does_not_exist_is_refused(subtests):
    for load, number, name in [
        (1.0, 1.0, "load"),
        (0.0, 1.0, "load"),
        (0.1, -1.0, "fluid_number"),
        (0.1, np.inf, "fluid_number"),
    ]:
        with subtests.test(load=load, number=number, name=name), pytest.raises(sb.InputError, match=f"{name} = "):
            wedge.wedge(load, number)
