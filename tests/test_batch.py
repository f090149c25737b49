"""Many states at once: the same equations on any array library, the same results as one by one, and nothing lost."""

import builtins
import sys

import array_api_strict
import numpy as np
import pytest

import stribeck as sb
from stribeck.batches.device import Device
from stribeck.batches.equations import DeviceEquations, DeviceOperators, newton
from stribeck.batches.guess import Batch, Combined, column_groups, rigid_rows, spread
from stribeck.batches.path import ended, judged, refined
from stribeck.batches.plan import planned
from stribeck.contacts.groups import contact_law
from stribeck.equations.error_estimate import ErrorEstimate, FineOperators, error_estimates
from stribeck.equations.line import Equations
from stribeck.equations.observables import NAMES, observables
from stribeck.equations.state import Extrapolation, Rows, mesh_for
from stribeck.numerics.newton import Outcome
from stribeck.solver.cold_start import cold_start, rigid_guess

SHARES = ("contact_load_share", "fluid_load_share")


def crowd(number=12, seed=7_919):
    """States within a factor two in each group, on both sides of the mixed regime."""
    rng = np.random.default_rng(seed)
    speed, load, kappa = (centre * 1.4 ** rng.uniform(-1, 1, number) for centre in (3e-6, 0.1, 4e-3))
    return sb.Groups(speed, load, kappa * load)


def scattered(number=10, seed=104_729):
    """States decades apart in speed and load, whose edge layers are about as wide."""
    rng = np.random.default_rng(seed)
    kappa, load, speed = (10 ** rng.uniform(low, high, number) for low, high in ((-2, -1.5), (-6, -0.5), (-10, -6)))
    return sb.Groups(speed, load, kappa * load)


def joined(*parts):
    return sb.Groups(*(np.concatenate([np.broadcast_to(getattr(g, name), g.shape) for g in parts]) for name in GROUPS))


GROUPS = ("speed", "load", "roughness")


def one(groups, i):
    return sb.Groups(*(float(np.broadcast_to(getattr(groups, name), groups.shape)[i]) for name in GROUPS))


def differences(first, second):
    """Return the relative differences of the observables, absolute for the load shares, shape (8, ...)."""
    pairs = [(name, getattr(first, name), getattr(second, name)) for name in NAMES]
    return np.array([np.abs(a - b) / (1.0 if name in SHARES else np.abs(b)) for name, a, b in pairs])


@pytest.fixture(scope="module")
def by_numpy():
    return sb.solve_batch(joined(crowd(), scattered()))


@pytest.fixture(scope="module")
def discrete():
    """Return a coarse state, its equations, and rows of disturbed unknowns of states near it, rough or smooth."""

    def make(roughness):
        state = cold_start(sb.Groups(1e-4, 0.1, roughness)).states[-1]
        rng = np.random.default_rng(31_337)
        factors = np.linspace(0.7, 1.5, 3)[:, None]
        groups = sb.Groups(1e-4 * factors, 0.1 / factors, roughness * factors)
        y = state.y * (1 + 0.05 * rng.uniform(-1, 1, (3, len(state.y))))
        return state, groups, y

    return make


@pytest.mark.parametrize("xp", [np, array_api_strict], ids=["numpy", "strict"])
@pytest.mark.parametrize("roughness", [0.0, 1e-3])
def test_the_equations_in_rows_are_those_of_each_state(discrete, xp, roughness):
    state, groups, y = discrete(roughness)
    device = Device(xp, None, 1e9)
    rows = DeviceEquations.of(DeviceOperators.of(state.equations.operators, device), groups, y[:, -1:])
    steps = np.random.default_rng(5).normal(size=y.shape) * np.array([[0.1], [0.1], [10.0]])
    steps[1, -1] = -5.0  # the flux gap limits this one, the gap or the contact pressure the last
    residuals = device.get(rows.residual(device.put(y)))[:, :, 0]
    jacobians = device.get(rows.jacobian(device.put(y)))
    parts = device.get(rows.admissible(device.put(y), device.put(steps)))
    for i in range(3):
        own = column_groups(groups, slice(i, i + 1))
        own = sb.Groups(*(float(getattr(own, name)[0, 0]) for name in GROUPS))
        single = Equations(state.equations.operators, own.speed, contact_law(own), y[i, -1] ** 2)
        assert np.abs(residuals[i] - single.residual(y[i])).max() < 1e-12
        expected = single.relative_jacobian(y[i])
        assert np.abs(jacobians[i] - expected).max() < 1e-12 * np.abs(expected).max()
        assert parts[i] == pytest.approx(single.admissible(y[i], steps[i] * single.units(y[i])), rel=1e-12)
    assert parts[1] == pytest.approx(0.14, rel=1e-12)
    assert parts[2] < 1.0


def test_the_mesh_of_rows_that_are_one_state_is_that_of_the_state(discrete):
    state, _, _ = discrete(1e-3)
    row = sb.Groups(*(np.array([[float(getattr(state.groups, name))]]) for name in GROUPS))
    batch = Batch(row, state.equations.operators, state.y[None])
    law, laws = contact_law(state.groups), contact_law(row)
    single = mesh_for(Extrapolation(np.ones(1), [state]), state.groups, law, 12, 1e-4, 1e-6)
    shared = mesh_for(Combined(np.ones(1), [batch]), row, laws, 12, 1e-4, 1e-6)
    assert np.array_equal(shared.edges, single.edges)
    assert shared.scale == single.scale


def test_rigid_rows_are_the_rigid_guesses_of_each(discrete):
    groups = sb.Groups(np.array([[1e3], [5.0]]), np.array([[1e-4], [1e-6]]), np.array([[1e-5], [4e-5]]))
    rows = rigid_rows(groups)
    for i in range(2):
        single = rigid_guess(sb.Groups(*(float(getattr(groups, name)[i, 0]) for name in GROUPS)))
        assert rows.height[i, 0] == pytest.approx(single.height, rel=1e-3)


def test_a_spread_guess_misses_by_the_square_of_the_distance(discrete):
    state, _, _ = discrete(1e-3)
    errors = []
    for distance in (0.02, 0.01):
        near = sb.Groups(*(np.array([[float(getattr(state.groups, name)) * np.exp(distance)]]) for name in GROUPS))
        guess = spread(state, near)
        operators = state.equations.operators
        equations = DeviceEquations.of(DeviceOperators.of(operators, Device(np, None, 1e9)), near, guess.flux_gap)
        y, done, _ = newton(equations, guess.y, 1e-10)
        assert done.all()
        errors.append(np.abs(guess.y[0, :-2] / y[0, :-2] - 1).max())
    assert abs(np.log2(errors[0] / errors[1]) - 2) < 0.1


def test_a_batch_is_judged_as_each_state_is(discrete):
    for roughness in (0.0, 1e-3):
        state, groups, _ = discrete(roughness)
        op = state.equations.operators
        device = Device(np, None, 1.0)
        equations = DeviceEquations.of(DeviceOperators.of(op, device), groups, np.full((3, 1), state.flux_gap))
        y, done, _ = newton(equations, np.tile(state.y, (3, 1)), 1e-12)
        assert done.all()
        answers = judged(Batch(groups, op, y), 1e-3, device)
        for i, answer in enumerate(answers):
            own = sb.Groups(*(float(getattr(groups, name)[i, 0]) for name in GROUPS))
            single = Equations(op, own.speed, contact_law(own), y[i, -1] ** 2)
            inverse = np.linalg.inv(single.jacobian(y[i]))
            rows = Rows(single, y[i : i + 1], own.load, lambda r, inverse=inverse: -r @ inverse.T)
            values = observables(single, y[i], own.load)
            [estimate] = error_estimates(rows, [values], FineOperators(op.mesh))
            assert answer.estimate.relative == pytest.approx(estimate.relative, rel=1e-4)
            assert answer.values.array() == pytest.approx(values.array(), rel=1e-12)
            assert answer.outcome.ok == (estimate.total <= 1e-3)


def test_states_solved_together_have_the_errors_they_state(by_numpy):
    groups = by_numpy.groups
    assert by_numpy.ok.all()
    assert by_numpy.batched.all()
    assert (by_numpy.error_estimate <= 1e-6).all()
    checked = [0, 3, 6, 9, 12, 15, 18, 21]
    for i in checked:
        exact = sb.solve(one(groups, i), rtol=1e-9)
        values = exact.observables.array()
        found = np.array([getattr(by_numpy, name)[i] for name in NAMES])
        scales = np.where(np.isin(NAMES, SHARES), 1.0, np.abs(values))
        assert (np.abs(found - values) / scales <= by_numpy.relative_errors[:, i] + 1e-9).all()
        assert by_numpy.minimum_position[i] == pytest.approx(exact.minimum_position, abs=1e-3)
        for definition in ("paper", "balanced"):
            expected = exact.friction(0.5, 0.03, definition).total
            assert by_numpy.friction(0.5, 0.03, definition)[i] == pytest.approx(expected, rel=1e-6)


def test_an_array_library_that_has_nothing_but_the_standard_gives_the_same(by_numpy):
    strict = sb.solve_batch(by_numpy.groups, backend=array_api_strict)
    assert strict.backend == "array_api_strict"
    assert strict.batched.all()
    assert differences(strict, by_numpy).max() < 1e-8


@pytest.mark.torch
def test_pytorch_on_the_processor_gives_the_same(by_numpy):
    import torch

    threads = torch.get_num_threads()
    found = sb.solve_batch(by_numpy.groups, backend="torch", device="cpu")
    assert torch.get_num_threads() == threads
    assert found.batched.all()
    assert differences(found, by_numpy).max() < 1e-8


@pytest.mark.torch
def test_pytorch_without_a_gpu_says_so():
    with pytest.raises(sb.InputError, match="device = 'nowhere'; torch cannot compute on it in double precision: "):
        sb.solve_batch(crowd(), backend="torch", device="nowhere")


def test_what_does_not_fit_a_batch_is_solved_alone_and_in_its_place():
    speed, roughness = np.array([[1e-3], [0.0]]), np.array([0.0, 1e-2, 1e-3])
    found = sb.solve_batch(sb.Groups(speed, 0.8, roughness))
    assert found.ok.all()
    assert found.central_gap.shape == (2, 3)
    assert found.relative_errors.shape == (8, 2, 3)
    assert not found.batched.any()
    for i in range(2):
        for j in range(3):
            single = sb.solve(sb.Groups(float(speed[i, 0]), 0.8, float(roughness[j])))
            assert found.central_gap[i, j] == single.central_gap
            assert found.errors["offset"][i, j] == single.errors["offset"]


def test_what_a_batch_misses_is_solved_alone(by_numpy, monkeypatch):
    monkeypatch.setattr(
        "stribeck.batches.solve_batch.refined", lambda *given: {k: v for k, v in refined(*given).items() if k != 3}
    )
    found = sb.solve_batch(crowd())
    assert np.flatnonzero(~found.batched).tolist() == [3]
    assert found.ok.all()
    assert found.central_gap[3] == sb.solve(one(crowd(), 3)).central_gap
    assert (found.central_gap[4:] == by_numpy.central_gap[4:12]).all()


def test_smooth_and_rough_states_never_share_a_batch():
    rough = crowd()
    both = joined(rough, sb.Groups(rough.speed, rough.load, np.zeros(12)))
    found = sb.solve_batch(both)
    assert found.ok.all()
    assert found.batched.sum() >= 20
    assert (found.contact_load_share[12:] == 0).all()
    assert (found.contact_load_share[:12] > 0.01).all()
    single = sb.solve(one(both, 14))
    assert found.central_gap[14] == pytest.approx(single.central_gap, rel=1e-6)


def test_a_state_that_rounding_bounds_is_kept_with_its_outcome():
    found = sb.solve_batch(sb.Groups(np.array([1e-6, 1e6]), 0.1, 0.0), rtol=1e-11)
    assert found.outcome.tolist() == [Outcome.ROUNDING, Outcome.CONVERGED]
    assert found.ok.tolist() == [False, True]
    assert found.error_estimate[0] > 1e-11 >= found.error_estimate[1]
    assert np.isfinite(found.central_gap).all()


@pytest.mark.parametrize(
    ("defect", "rounding", "outcome"),
    [
        (8e-7, 1e-7, Outcome.CONVERGED),
        (2e-6, 1e-7, Outcome.REFINEMENT_LIMIT),
        (1e-6, 9e-7, Outcome.ROUNDING),
    ],
)
def test_a_batch_tells_what_is_in_the_way_of_a_tolerance(defect, rounding, outcome):
    parts = (np.full(8, size) for size in (defect, 0.0, rounding, 1.0))
    assert ended(ErrorEstimate(*parts), 1e-6) is outcome


def test_an_interrupted_run_keeps_what_is_done():
    seen = []

    def stop(done, total):
        seen.append((done, total))
        raise KeyboardInterrupt

    found = sb.solve_batch(joined(crowd(), scattered()), on_progress=stop)
    assert seen == [(12, 22)]
    assert found.ok[:12].all()
    assert set(found.outcome[12:]) == {Outcome.INTERRUPTED}
    assert np.isnan(found.central_gap[12:]).all()
    assert not found.batched[12:].any()


def test_the_memory_of_the_jacobians_is_bounded_and_changes_no_result(by_numpy):
    rows = list(Device(np, None, 3 * 8 * 100**2 * 5).chunks(12, 100))
    assert rows == [slice(0, 5), slice(5, 10), slice(10, 12)]
    assert list(Device(np, None, 1.0).chunks(2, 100)) == [slice(0, 1), slice(1, 2)]
    frugal = sb.solve_batch(crowd(), memory=1.0)
    assert np.abs(frugal.central_gap / by_numpy.central_gap[:12] - 1).max() < 1e-12


def test_a_singular_matrix_spoils_only_its_own_state():
    matrices = np.stack([np.eye(3), np.zeros((3, 3)), 2 * np.eye(3)])
    found = Device(np, None, 1e9).solved(matrices, np.ones((3, 3, 1)))[:, :, 0]
    assert (found[0] == 1).all()
    assert np.isnan(found[1]).all()
    assert (found[2] == 0.5).all()


def test_a_row_that_does_not_converge_is_not_called_so_and_spoils_no_other(discrete, monkeypatch):
    state, groups, y = discrete(1e-3)
    y[1, 0] = np.nan
    equations = DeviceEquations.of(DeviceOperators.of(state.equations.operators, Device(np, None, 1e9)), groups, y[:, -1:])
    with np.errstate(all="ignore"):
        _, done, factorisations = newton(equations, y, 1e-10)
        assert done.tolist() == [True, False, True]
        assert factorisations < 25
        monkeypatch.setattr("stribeck.batches.equations.MOST_STEPS", 2)
        _, done, fewer = newton(equations, y, 1e-10)
    assert not done.any()
    assert fewer < factorisations


def test_every_state_is_planned_once():
    rng = np.random.default_rng(65_537)
    speed, load, kappa = (10 ** rng.uniform(low, high, (300, 1)) for low, high in ((-9, -1), (-3, 1), (-4, 0)))
    speed[:7], kappa[7:20] = 0.0, 0.0
    speed[20:60], load[20:60], kappa[20:60] = 1e-5, 0.1, 1e-3
    close, alike, single = planned(sb.Groups(speed, load, kappa * load))
    assert sorted(np.concatenate([*close, *alike, single]).tolist()) == list(range(300))
    assert any(set(range(20, 60)) <= set(rows.tolist()) for rows in close)
    assert all(len(rows) >= 6 for rows in close)
    assert all(len(rows) >= 8 and (load[rows] <= 0.5).all() for rows in alike)
    assert set(range(7)) <= set(single.tolist())
    assert all(len(set((kappa[rows] == 0).ravel().tolist())) == 1 for rows in [*close, *alike])


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ({"backend": "jax"}, "backend = 'jax'; it must be 'numpy', 'torch', 'cupy', or a namespace"),
        ({"backend": builtins}, "it has no asarray or linalg"),
        ({"device": "cuda"}, "device = 'cuda'; numpy cannot compute on it in double precision"),
        ({"memory": -1}, "memory = -1; it must be a positive number of bytes"),
        ({"memory": True}, "memory = True; it must be a positive number of bytes"),
        ({"rtol": 1.0}, "rtol = 1.0; it must be a number from 1e-11"),
    ],
)
def test_what_cannot_be_is_refused(arguments, sentence):
    with pytest.raises(sb.InputError) as refusal:
        sb.solve_batch(crowd(), **arguments)
    assert sentence in str(refusal.value)


def test_groups_are_asked_for():
    with pytest.raises(sb.InputError, match="they must be Groups"):
        sb.solve_batch([1.0, 2.0, 3.0])


@pytest.mark.parametrize(
    ("backend", "sentence"),
    [
        ("torch", "the backend 'torch' needs array-api-compat and torch; install it with: pip install 'stribeck[gpu]'."),
        ("cupy", "the backend 'cupy' needs array-api-compat and a CuPy for your CUDA; install with: pip install "),
        ("numpy", "the backend 'numpy' needs array-api-compat, as this NumPy is older than the standard; install with: "),
    ],
)
def test_a_missing_library_is_named(backend, sentence, monkeypatch):
    monkeypatch.setitem(sys.modules, f"array_api_compat.{backend}", None)
    monkeypatch.delattr(np, "__array_api_version__")
    with pytest.raises(sb.InputError) as refusal:
        sb.solve_batch(crowd(), backend=backend)
    assert sentence in str(refusal.value)


def test_no_states_are_no_work():
    found = sb.solve_batch(sb.Groups(np.zeros(0), 0.1, 1e-3))
    assert found.central_gap.shape == (0,)
    assert found.error_estimate.shape == (0,)
