"""Fits of balls: exact on exact data, joint over loads and fluids, with intervals that cover, in files and commands."""

import numpy as np
import pytest
from ball_data import BALL as TRUE
from command_line import call

import stribeck as sb
from stribeck import FitSettings
from stribeck.fits.free_inputs import free_inputs
from stribeck.fits.model import FrictionModel
from stribeck.fits.states.parts import FrictionParts
from stribeck.fits.states.solved import solved_parts
from stribeck.fits.states.sources import Ways, between

SPEEDS = TRUE.speed * np.geomspace(0.3, 6.0, 5)
FREE = ("boundary_friction", "roughness", "modulus", "load", "beta", "radius", "viscosity", "alpha")


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
    return np.asarray(sb.stribeck_curve(contact, speed=values, rtol=1e-4).friction)


def made_up(definition):
    """Return parts of friction that are smooth formulas of the groups, in place of solved ones."""

    def parts(groups, changes):
        s, F, h = (np.broadcast_to(np.log(g), groups.shape) for g in (groups.speed, groups.load, groups.roughness))
        exponents = np.array([[-0.2, 0.1, 0.3], [0.6, 0.0, -0.1], [0.7, 0.05, 0.0], [0.3, 0.2, 0.1]])
        sizes = np.array([0.05, 0.3, 0.1, 0.02])
        values = sizes[:, None] * np.exp(exponents @ np.stack([s, F, h]))
        return FrictionParts(values, exponents[:, :, None] * values[:, None], np.zeros(values.shape), definition)

    return parts


def test_the_derivatives_of_the_friction_of_a_ball_are_its_differences(subtests):
    for abscissa in ["speed", "hersey_number"]:
        for edge in [None, "3 mm"]:
            for definition in ["balanced", "published"]:
                with subtests.test(abscissa=abscissa, edge=edge, definition=definition):
                    contact = TRUE.replace(wetted_radius=edge)
                    names = [name for name in FREE if name != "viscosity" or abscissa == "speed"]
                    data = measured(
                        np.ones(5), SPEEDS if abscissa == "speed" else SPEEDS * TRUE.hersey_number / TRUE.speed, abscissa
                    )
                    model = FrictionModel(contact, data, free_inputs(contact, data, names, FitSettings(geometry="point")))
                    parts, step = made_up(definition), 1e-4
                    found = model.predict(np.zeros(len(names)), parts)
                    for i, name in enumerate(names):
                        move = step * np.eye(len(names))[i]
                        slope = (model.predict(move, parts).friction - model.predict(-move, parts).friction) / (2 * step)
                        np.testing.assert_allclose(found.jacobian[:, i], slope, atol=1e-7, err_msg=name)


def test_free_inputs_of_a_ball_act_as_those_of_its_contact(subtests):
    for abscissa in ["speed", "hersey_number"]:
        with subtests.test(abscissa=abscissa):
            contact = TRUE.replace(wetted_radius="3 mm")
            data = measured(np.ones(5), SPEEDS if abscissa == "speed" else SPEEDS * TRUE.hersey_number / TRUE.speed, abscissa)
            names = [name for name in FREE if name != "viscosity" or abscissa == "speed"]
            model = FrictionModel(contact, data, free_inputs(contact, data, names, FitSettings(geometry="point")))
            theta, parts = np.linspace(-0.2, 0.3, len(names)), made_up("published")
            moved = FrictionModel(model.contact_of(0, theta), data, ())
            np.testing.assert_allclose(
                model.predict(theta, parts).friction, moved.predict(np.zeros(0), parts).friction, rtol=1e-12
            )


def test_a_prediction_from_solved_curves_is_the_friction_of_the_contacts():
    data = measured(np.ones(2), SPEEDS[1:2], inputs=({}, {"load": 1.5 * TRUE.load, "slide_to_roll": 1.0}))
    model = FrictionModel(TRUE, data, free_inputs(TRUE, data, ("boundary_friction",), FitSettings(geometry="point")))
    found = model.predict(np.array([0.1]), solved_parts(model, "published", 1e-3))
    for i in range(2):
        contact = model.contact_of(i, np.array([0.1])).replace(speed=SPEEDS[1])
        alone = sb.solve(contact, rtol=1e-3).friction(definition="published").total
        assert found.friction[i] == pytest.approx(alone, rel=2e-3)
    assert data.inputs[1]["slide_to_roll"] == model.contacts[1].slide_to_roll


def test_many_speeds_of_one_load_are_read_between_fewer_that_are_solved():
    contact = TRUE.replace(fluid=sb.fluids.Barus("2e-6 1/Pa"))
    speeds = TRUE.speed * np.geomspace(0.5, 4.0, 25)
    data, solved = measured(np.ones(25), speeds), []
    model = FrictionModel(contact, data, free_inputs(contact, data, ("viscosity", "roughness"), FitSettings(geometry="point")))
    found = model.predict(np.zeros(2), solved_parts(model, "balanced", 1e-3, lambda: solved.append(1)))
    assert len(solved) < 10
    fine = model.predict(np.zeros(2), solved_parts(model, "balanced", 2e-5))
    assert (np.abs(found.friction - fine.friction) < found.error).all()
    assert found.friction == pytest.approx(fine.friction, rel=1e-3)
    assert found.jacobian == pytest.approx(fine.jacobian, abs=0.01 * np.abs(fine.jacobian).max())


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
    assert {"searching", "solving"} <= {what for what, _, _ in steps}
    assert all(0 <= done <= total for _, done, total in steps) and steps[-1][1] > 0
    assert found["roughness"].unit == "m" and found.contact.roughness == found["roughness"].value


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


@pytest.mark.slow
def test_intervals_of_a_ball_cover_in_40_experiments(monkeypatch):
    from scipy.stats import binom

    data = measured(np.ones(5))
    model = FrictionModel(TRUE, data, free_inputs(TRUE, data, ("boundary_friction", "roughness"), FitSettings()))
    ways = between(solved_parts(model, "balanced", 1e-4))  # kept for all experiments
    monkeypatch.setattr("stribeck.fits.fit.ways_of", lambda *_: ways)
    exact = model.predict(np.zeros(2), ways.solved).friction
    held, experiments = np.zeros((2, 2), dtype=int), 40
    for seed in range(experiments):
        noise = np.exp(0.03 * np.random.default_rng(seed).standard_normal((4, 5)))
        rows = measured((exact * noise).ravel(), inputs=({},) * 4)
        found = sb.fit(rows, TRUE, free=["boundary_friction", "roughness"])
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


def test_the_command_fits_a_ball_and_writes_its_case(tmp_path, capsys, monkeypatch):
    parts = made_up("balanced")
    monkeypatch.setattr("stribeck.fits.fit.ways_of", lambda *_: Ways(parts, parts))
    case = tmp_path / "ball.toml"
    case.write_text(CASE.format(load="10 mN", roughness="0.1 um", fit=""))
    contact = sb.load_case(case).contact.replace(boundary_friction=0.7, roughness=0.12e-6)
    speeds = np.geomspace(1e-3, 1e-1, 9)
    data = measured(np.ones(9), speeds)
    mu = FrictionModel(contact, data, ()).predict(np.zeros(0), parts).friction
    mu = mu * np.exp(1e-3 * np.random.default_rng(3).standard_normal(9))
    file = tmp_path / "data.csv"
    file.write_text("sum of speeds [m/s],friction\n" + "".join(f"{v:.8g},{m:.8g}\n" for v, m in zip(speeds, mu, strict=True)))
    out = call(capsys, "fit", file, case, "--out", tmp_path / "fitted.toml").out
    assert "boundary_friction" in out and "mN" in out
    back = sb.load_case(tmp_path / "fitted.toml").contact
    assert back.boundary_friction != 0.5
    # These formulas tell the product alone, as the note says.
    assert back.boundary_friction * back.roughness**0.3 == pytest.approx(0.7 * 0.12e-6**0.3, rel=1e-2)
    assert "determine boundary_friction x roughness^0.29 best" in " ".join(out.split())
