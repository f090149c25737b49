"""Fits of balls: exact on exact data, joint over loads and fluids, with intervals that cover, in files and commands."""

from functools import cache

import numpy as np
import pytest
from ball_data import BALL as TRUE
from command_line import call, case_text, toml_of

import stribeck as sb

DROP = sb.PointContact(
    radius=0.01,
    modulus=2e6,
    load=0.9,
    viscosity=0.1,
    speed=1.0,
    roughness=4.5e-7,
    alpha=2,
    beta=0.1,
    boundary_friction=0.5,
    wetted_radius=3e-3,
)
SPEEDS = TRUE.speed * np.geomspace(0.3, 6.0, 5)


def measured(friction, values=SPEEDS, abscissa="speed", inputs=({},), error=None):
    """Return measurements of one curve for each entry of ``inputs``, all at the same places."""
    n, curves = len(friction), len(inputs)
    return sb.results.Measurements(
        abscissa=abscissa,
        values=np.tile(values, curves),
        friction=np.asarray(friction, dtype=float),
        error=error,
        curve=np.repeat(np.arange(curves), n // curves),
        curves=tuple("abcdef"[:curves]),
        inputs=inputs,
        rows=np.arange(2, n + 2),
    )


def frictions(contact, values=SPEEDS):
    return solved(contact, tuple(values.tolist())).copy()


@cache
def solved(contact, speeds):
    return np.asarray(sb.stribeck_curve(contact, speed=np.array(speeds), rtol=1e-4).friction)


@pytest.mark.slow
def test_exact_friction_of_a_ball_gives_its_inputs():
    start = TRUE.replace(boundary_friction=0.5, roughness=1.15 * TRUE.roughness)
    steps = []
    found = sb.fit(
        measured(frictions(TRUE)),
        start,
        free=["boundary_friction", "roughness"],
        intervals=False,
        on_step=lambda *step: steps.append(step),
    )
    assert found.converged
    assert found["boundary_friction"].value == pytest.approx(0.8, rel=2e-3)
    assert found["roughness"].value == pytest.approx(TRUE.roughness, rel=2e-3)
    assert found.friction == pytest.approx(frictions(TRUE), rel=1e-5)
    assert {"searching", "solving"} <= {what for what, _, _ in steps}
    assert all(0 <= done <= total for _, done, total in steps) and steps[-1][1] > 0
    assert found["roughness"].unit == "m" and found.contact.roughness == found["roughness"].value


@pytest.mark.slow
def test_states_are_solved_as_well_as_the_data_are_measured():
    exact = frictions(TRUE)
    noisy = measured(exact * np.exp(0.03 * np.random.default_rng(3).standard_normal(5)))
    good = measured(exact, error=2e-4 * exact)
    errors = [sb.fit(data, TRUE, free=["boundary_friction"], intervals=False).model_error for data in (noisy, good)]
    assert errors[1] < 1e-4 < errors[0] < 1e-3


@pytest.mark.slow
def test_a_joint_fit_over_loads_and_fluids_shares_its_inputs():
    inputs = ({}, {"load": 2 * TRUE.load}, {"viscosity": 3 * TRUE.viscosity})
    friction = np.concatenate([frictions(TRUE.replace(**each)) for each in inputs])
    start = TRUE.replace(boundary_friction=0.6, roughness=0.85 * TRUE.roughness, modulus=1.2 * TRUE.modulus)
    names = ["boundary_friction", "roughness", "modulus"]
    found = sb.fit(measured(friction, inputs=inputs), start, free=names, intervals=False)
    assert found.converged
    for name in names:
        assert found[name].value == pytest.approx(getattr(TRUE, name), rel=5e-3), name


def experiment(seed, exact):
    """Return four curves of friction with noise of 3 %."""
    noise = np.exp(0.03 * np.random.default_rng(seed).standard_normal((4, 5)))
    return measured((exact * noise).ravel(), inputs=({},) * 4)


@pytest.mark.slow
def test_a_fit_reaches_its_optimum_where_errors_of_the_states_hide_it():
    # The first states are solved from others than the next ones, and their friction jumps by a hundredth of their errors.
    exact = frictions(TRUE)
    found = sb.fit(experiment(6, exact), TRUE, free=["boundary_friction", "roughness"], intervals=False)
    assert found.converged


@pytest.mark.slow
def test_intervals_of_a_ball_cover_in_40_experiments():
    from scipy.stats import binom

    exact = frictions(TRUE)
    held, experiments = np.zeros((2, 2), dtype=int), 40
    for seed in range(experiments):
        found = sb.fit(experiment(seed, exact), TRUE, free=["boundary_friction", "roughness"])
        assert found.converged
        for i, each in enumerate(found.inputs):
            for k, (low, high) in enumerate((each.interval_68, each.interval_95)):
                held[i, k] += low < getattr(TRUE, each.name) < high
    for k, level in enumerate((0.6827, 0.95)):
        low, high = binom.ppf([1e-4, 1 - 1e-4], experiments, level)
        assert np.all(held[:, k] >= low) and np.all(held[:, k] <= high), held


CASE = """[contact]
geometry = "point"
radius = "10 mm"
modulus = "1 MPa"
load = "{load}"
viscosity = "0.1 Pa*s"
entrainment_speed = "1 mm/s"
slide_to_roll = 0.5
roughness = "{roughness}"
alpha = 2.0
beta = 0.1
boundary_friction = 0.5

[fit]
free = ["boundary_friction", "roughness"]
{fit}
"""


def test_units_of_a_fit_are_those_of_the_geometry(tmp_path):
    path = tmp_path / "ball.toml"
    text = CASE.format(load="10 mN", roughness="0.1 um", fit='bounds = { load = ["5 mN", "20 mN"] }')
    path.write_text(text + '[fit.curves.heavy]\nload = "20 mN"\nslide_to_roll = 1.0\n')
    settings = sb.load_case(path).fit
    assert settings.bounds["load"] == (5e-3, 20e-3)
    assert settings.curves["heavy"] == {"load": 20e-3, "slide_to_roll": 1.0}
    path.write_text(text)
    settings, data = sb.load_case(path).fit, tmp_path / "data.csv"
    data.write_text(
        "mean speed [mm/s],load [mN],friction\n" + "".join(f"{v},{n},{0.5 / v}\n" for n in (10, 20) for v in (1, 2, 3))
    )
    found = sb.read_measurements(data, settings)
    assert [each["load"] for each in found.inputs] == pytest.approx([0.01, 0.02])
    path.write_text(text.replace('["5 mN", "20 mN"]', '["5 N/m", "20 N/m"]'))
    with pytest.raises(sb.InputError, match="load"):
        sb.load_case(path)


def test_curves_at_two_loads_and_motions_have_the_friction_of_their_contacts():
    inputs = ({}, {"load": 1.5 * TRUE.load, "slide_to_roll": 1.0})
    friction = np.concatenate([frictions(TRUE.replace(**each), SPEEDS[1:4]) for each in inputs])
    data = measured(friction, SPEEDS[1:4], inputs=inputs)
    found = sb.fit(data, TRUE.replace(boundary_friction=0.7), free=["boundary_friction"], intervals=False)
    assert found.friction == pytest.approx(friction, rel=1e-3)
    assert found["boundary_friction"].value == pytest.approx(0.8, rel=1e-3)
    assert found.contacts[1].slide_to_roll == 1.0


def test_the_command_fits_a_ball_and_writes_its_case(tmp_path, capsys):
    case, file = tmp_path / "ball.toml", tmp_path / "data.csv"
    given = TRUE.to_si() | {"geometry": "point", "boundary_friction": 0.6, "entrainment_speed": TRUE.speed / 2}
    given.pop("speed")
    case.write_text(toml_of(contact=given))
    noise = np.exp(1e-3 * np.random.default_rng(3).standard_normal(5))
    rows = zip(SPEEDS / 2, frictions(TRUE) * noise, strict=True)
    file.write_text("mean speed [m/s],friction\n" + "".join(f"{v:.8g},{m:.8g}\n" for v, m in rows))
    answer = call(capsys, "fit", file, case, "--out", tmp_path / "fitted.toml", "--free", "boundary_friction", "roughness")
    assert answer.code == 0, answer.err
    out = answer.out
    assert "boundary_friction" in out
    back = sb.load_case(tmp_path / "fitted.toml").contact
    assert back.boundary_friction == pytest.approx(0.8, rel=1e-2)
    assert back.roughness == pytest.approx(TRUE.roughness, rel=1e-2)


FLUIDS = {
    "barus": ({"fluid": sb.fluids.Barus("2e-6 1/Pa")}, ("viscosity", "pressure_coefficient")),
    "carreau": ({"fluid": sb.fluids.Carreau("2 ms", 0.5)}, ("boundary_friction", "relaxation_time")),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", FLUIDS)
def test_fits_of_balls_find_the_numbers_of_their_fluid(name):
    parts, free = FLUIDS[name]
    contact, speeds = TRUE.replace(**parts), TRUE.speed * np.geomspace(0.5, 4.0, 4)
    start = contact.replace(**{each: 1.2 * getattr(contact, each) for each in free})
    found = sb.fit(measured(frictions(contact, speeds), speeds), start, free=list(free))
    for each in free:
        assert getattr(found.contact, each) == pytest.approx(getattr(contact, each), rel=0.02), each


@pytest.mark.slow
def test_the_stated_error_of_friction_of_a_fluid_that_thins_covers_the_solved_one_and_is_near_the_tolerance(tmp_path):
    ball = {"geometry": '"point"', "load": '"1 N"', "speed": '"10 mm/s"', "roughness": '"0.3 um"', "viscosity": '"0.5 Pa*s"'}
    path = tmp_path / "ball.toml"
    fluid = {"model": '"carreau"', "relaxation_time": '"1 ms"', "exponent": "0.6"}
    path.write_text(case_text(ball, fluid=fluid, solver={"rtol": "1e-3"}))
    case = sb.load_case(path)
    speeds = np.array([0.01, 0.05, 0.2])
    data = tmp_path / "data.csv"
    data.write_text("speed [m/s],friction\n" + "\n".join(f"{u},{0.02 * (u / 0.01) ** 0.6}" for u in speeds))
    found = sb.fit(data, case, free=["viscosity"], intervals=False)
    solved = sb.solve(found.contact.replace(speed=speeds[1]), rtol=1e-4).friction().total
    assert abs(found.friction[1] / solved - 1) <= found.model_error + 1e-4 <= 3e-2


def test_a_fit_of_a_ball_in_a_drop_counts_the_friction_up_to_its_rim():
    """With the friction of a far film exact data gave 86 mPa s for 100."""
    speeds = np.array([1.0, 1.5, 2.0])
    data = measured(frictions(DROP, speeds), speeds)
    found = sb.fit(data, DROP.replace(viscosity=0.12), free=["viscosity"], intervals=False)
    assert found.contact.viscosity == pytest.approx(0.1, rel=2e-3)
    # That of a far film in closed form, of which this friction is not, was 0.17.
    solved = frictions(found.contact, speeds)
    assert np.abs(found.friction / solved - 1).max() <= found.model_error + 1e-4 <= 1e-3


@pytest.mark.slow
def test_a_drop_ends_at_as_many_contact_radii_as_it_does_at_each_load():
    """With those at the load of the case for all curves exact data gave 106 mPa s for 100."""
    loads, speeds = (0.3, 0.9), np.array([1.0, 1.5, 2.0])
    friction = np.concatenate([frictions(DROP.replace(load=each), speeds) for each in loads])
    data = measured(friction, speeds, inputs=tuple({"load": each} for each in loads))
    found = sb.fit(data, DROP.replace(viscosity=0.12), free=["viscosity"], intervals=False)
    assert found.contact.viscosity == pytest.approx(0.1, rel=2e-3)
