"""Means of time series and repeats: their errors hold for correlated samples, and what is left out is named."""

from pathlib import Path

import numpy as np
import pytest

import stribeck as sb

SPEEDS = np.array([0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0, 300.0])  # [mm/s]
FILE = Path(__file__).parent / "data" / "03_time_series_steps_with_startup.csv"


def curve(speed):
    return 0.55 / (1 + (speed / 8) ** 0.9) + 0.02 + 0.0006 * speed**0.6


@pytest.fixture
def read(tmp_path):
    def reader(rows, header="step,speed [mm/s],COF", **settings):
        path = tmp_path / "series.csv"
        path.write_text("\n".join([header, *(",".join(f"{each:.7g}" for each in row) for row in rows)]))
        return sb.read_measurements(path, sb.FitSettings(**settings))

    return reader


def noise(rng, n, memory):
    found = [rng.normal()]
    for _ in range(n - 1):
        found.append(memory * found[-1] + (1 - memory**2) ** 0.5 * rng.normal())
    return np.array(found)


def series(rng, memory, n=40, starting=2, speeds=SPEEDS, in_speed=0.002):
    """Return rows of steps that begin below their speed."""
    rows = []
    for step, speed in enumerate(speeds, 1):
        for i, each in enumerate(noise(rng, n, memory)):
            there = speed * (0.55 + 0.2 * i) if i < starting else speed * (1 + in_speed * rng.normal())
            rows.append((step, there, curve(speed) * (1 + 0.02 * each)))
    return rows


@pytest.mark.quick
def test_a_series_of_steps_becomes_means_without_its_rows_of_starting(subtests):
    for settings in [{}, {"repeats": True}]:
        with subtests.test(settings=settings):
            found = sb.read_measurements(FILE, sb.FitSettings(**settings))
            assert 1e3 * found.values == pytest.approx(np.geomspace(0.1, 300, 8), rel=3e-3)
            assert any("16 rows" in note and "left out: 2, 3, 42, 43" in note for note in found.notes)
            assert np.all((0.01 < found.error / found.friction) & (found.error / found.friction < 0.03))


def test_errors_of_means_are_those_that_the_memory_of_samples_leaves(read):
    rng = np.random.default_rng(7)
    misses = []
    for _ in range(25):  # of 8 steps each
        found = read(series(rng, 0.9))
        assert len(found) == 8
        misses += ((found.friction - curve(1e3 * found.values)) / found.error).tolist()
    # The rms of 200 normal numbers is within 0.85 and 1.15 by three of its standard deviations; errors that are
    # estimated from 38 samples of memory 0.9 widen that by a third.
    assert 0.7 < np.sqrt(np.mean(np.square(misses))) < 1.25


def test_noise_alike_at_all_speeds_is_no_share_of_friction(read):
    rng, misses = np.random.default_rng(8), []
    for _ in range(40):
        rows = [(step, u, curve(u) + 0.004 * each) for step, u in enumerate(SPEEDS) for each in noise(rng, 20, 0.5)]
        found = read(rows)
        misses.append((found.friction - curve(1e3 * found.values)) / found.error)
    sizes = np.sqrt(np.mean(np.square(misses), axis=0))  # at each speed, one where the error is right
    assert np.all((sizes > 0.5) & (sizes < 1.5))


def test_steps_shorter_than_the_memory_of_their_noise_share_what_they_show_of_it(read):
    rng, misses = np.random.default_rng(11), []
    speeds = np.geomspace(0.1, 300, 15)
    for _ in range(25):
        each = noise(rng, 150, 0.9)
        frictions = np.repeat(curve(speeds), 10) * (1 + 0.02 * each)
        found = read(zip(np.repeat(np.arange(15), 10), np.repeat(speeds, 10), frictions, strict=True))
        misses += ((found.friction - curve(1e3 * found.values)) / found.error).tolist()
    # Ten rows show little of a memory of nineteen: the errors are still about a fifth too small (1.6 if each step is
    # taken to forget within itself).
    assert 0.7 < np.sqrt(np.mean(np.square(misses))) < 1.35


@pytest.mark.quick
def test_friction_that_drifts_in_a_step_has_no_narrow_error(read):
    rows = series(np.random.default_rng(1), 0.0)
    drifting = np.linspace(0.168, 0.209, 40)
    rows[160:200] = [(step, speed, mu) for (step, speed, _), mu in zip(rows[160:200], drifting, strict=True)]
    found = read(rows)
    assert 0.006 < found.error[4] < 0.03
    assert np.all(found.error[:4] / found.friction[:4] < 0.01)


@pytest.mark.quick
def test_noise_of_a_speed_splits_no_step(subtests, read):
    for in_speed in [0.0, 0.002, 0.01]:
        with subtests.test(in_speed=in_speed):
            assert len(read(series(np.random.default_rng(3), 0.5, in_speed=in_speed))) == 8


@pytest.mark.quick
def test_a_ramp_has_no_steps_and_near_speeds_stay_apart(read):
    ramp = [(1, 0.1 * 1.005**i, curve(0.1 * 1.005**i)) for i in range(800)]
    found = read(ramp)
    assert len(found) == 800 and found.error is None
    assert any("changes steadily" in note for note in found.notes)
    speeds = np.geomspace(1, 3, 24)  # 5 % apart, four times
    passes = [(k, u, curve(u) * (1 + 0.01 * np.sin(7 * k + u))) for k in range(4) for u in speeds]
    assert len(read(passes)) == 24


@pytest.mark.quick
def test_what_differs_between_passes_is_in_the_error(read):
    rng, rows = np.random.default_rng(5), []
    for k, speeds in enumerate((SPEEDS, SPEEDS[::-1])):
        for step, speed, mu in series(rng, 0.0, n=20, starting=0, speeds=speeds):
            rows.append((step + 8 * k, speed, mu * (1 + 0.1 * k)))
    found = read(rows)
    assert len(found) == 8
    assert found.error / found.friction == pytest.approx(np.full(8, 0.05), rel=0.3)


def test_errors_that_are_too_small_do_not_make_intervals_narrow(read):
    contact = sb.load_case(Path(__file__).parents[1] / "examples" / "pdms_cylinder.toml").contact
    solved = sb.stribeck_curve(contact, speed=contact.speed * np.geomspace(1e-3, 10, 10), rtol=1e-3)
    scatter = 1 + 0.03 * np.random.default_rng(2).normal(size=10)

    def width(error):
        data = sb.results.Measurements(
            abscissa="speed",
            values=solved.values,
            friction=solved.friction * scatter,
            error=None if error is None else error * solved.friction,
            curve=np.zeros(10, dtype=int),
            curves=("data",),
            inputs=({},),
            rows=np.arange(10),
        )
        low, high = sb.fit(data, contact, free=["boundary_friction"], intervals=False)["boundary_friction"].interval_95
        return high / low - 1

    assert width(0.001) == pytest.approx(width(None), rel=0.2)


@pytest.mark.slow
def test_intervals_of_two_inputs_hold_the_truth_in_19_of_20_files_of_a_rig(subtests, read):
    for memory in [0.5, 0.9]:
        with subtests.test(memory=memory):
            contact = sb.load_case(Path(__file__).parents[1] / "examples" / "pdms_cylinder.toml").contact
            speeds = np.geomspace(1e-3, 0.3, 5)

            def friction(**factors):
                scaled = {name: factor * getattr(contact, name) for name, factor in factors.items()}
                states = [contact.replace(speed=speed, **scaled) for speed in speeds]
                return np.array([sb.atlas.friction(each.groups, each.boundary_friction, each.beta) for each in states])

            truth = friction()
            pairs = [(friction(**{name: 1.01}), friction(**{name: 1 / 1.01})) for name in ("boundary_friction", "roughness")]
            slopes = np.array([np.log(up / down) / np.log(1.01**2) for up, down in pairs]).T
            rng, inside = np.random.default_rng(13), np.zeros(2)
            for _ in range(60):
                frictions = [mu * (1 + 0.02 * noise(rng, 40, memory)) for mu in truth]
                rows = [(k, speeds[k], mu) for k, step in enumerate(frictions) for mu in step]
                data = read(rows, header="step,speed [m/s],COF")
                # Errors of two per cent: the first step of least squares from the truth is the fit of the logarithms.
                weights = truth / data.error
                covariance = np.linalg.inv((slopes * weights[:, None] ** 2).T @ slopes)
                misses = covariance @ slopes.T @ (weights**2 * np.log(data.friction / truth))
                inside += np.abs(misses) < 1.96 * np.sqrt(np.diag(covariance))
            assert np.all((0.88 <= inside / 60) & (inside / 60 <= 1.0)), inside
