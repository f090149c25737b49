"""Studies of contacts whose asperities rub by a shear stress: fits, regimes, sensitivities, errors of inputs, diagrams."""

import math
from pathlib import Path
from urllib.parse import parse_qsl

import numpy as np
import pytest
from command_line import call

import stribeck as sb
from stribeck.asperity_friction import ShearStressTable
from stribeck.cases.fit_settings import settings_of
from stribeck.curves.sensitivities import friction_sensitivities
from stribeck.explorer.answer import Answerer
from stribeck.explorer.inputs import choices, inputs, url
from stribeck.fits.free_inputs import free_inputs
from stribeck.fits.measurements import read_measurements
from stribeck.fits.model import FrictionModel
from stribeck.regimes.margins import regime_margins

EXAMPLES = Path(__file__).parents[1] / "examples"
TAU, EXPONENT = 2e5, 0.1
NOISE = 0.03


@pytest.fixture(scope="module")
def seal():
    return sb.load_case(EXAMPLES / "rod_seal.toml").contact


@pytest.fixture(scope="module")
def contact(seal):
    return seal.replace(shear_stress=TAU, speed_exponent=EXPONENT, cavitation="none")


@pytest.fixture(scope="module")
def measured(contact, tmp_path_factory):
    """Return a file of the friction of the contact with noise."""
    speeds = np.geomspace(1e-3, 1.0, 12)
    friction = sb.solve_batch(contact, speed=speeds, rtol=1e-5).friction.total
    noisy = friction * np.exp(NOISE * np.random.default_rng(5).standard_normal(len(speeds)))
    path = tmp_path_factory.mktemp("measured") / "friction.csv"
    rows = "\n".join(f"{speed:.9g},{mu:.9g}" for speed, mu in zip(speeds, noisy, strict=True))
    path.write_text(f"speed [m/s],friction\n{rows}\n")
    return path


def slopes_by_differences(contact, names, rtol, step=1e-3):
    """Return the derivatives of ln(friction) by the logarithms of inputs."""

    def log_friction(name, sign):
        moved = contact.replace(**{name: getattr(contact, name) * math.exp(sign * step)})
        return math.log(sb.solve(moved, rtol=rtol).friction.total)

    return {name: (log_friction(name, 1) - log_friction(name, -1)) / (2 * step) for name in names}


@pytest.mark.parametrize("speed", [0.1, 0.0], ids=("sliding", "at rest"))
def test_sensitivities_are_those_of_differences(seal, speed):
    moving = seal.replace(shear_stress=TAU, speed=speed, **({"speed_exponent": EXPONENT} if speed else {}))
    found = friction_sensitivities(moving)[1]
    names = ["load", "modulus", *(["speed", "speed_exponent"] if speed else [])]
    expected = slopes_by_differences(moving, names, 1e-8)
    for name in names:
        assert found[name] == pytest.approx(expected[name], abs=1e-5)
    assert found["shear_stress"] == pytest.approx(sb.solve(moving).friction.contact_share, rel=1e-6)
    assert "boundary_friction" not in found


@pytest.mark.slow
def test_sensitivities_of_a_ball_are_those_of_differences():
    ball = sb.load_case(EXAMPLES / "pdms_ball.toml").contact.replace(shear_stress=TAU, speed_exponent=EXPONENT)
    names = ["load", "speed"]
    expected = slopes_by_differences(ball, names, 1e-5, step=1e-2)
    found = friction_sensitivities(ball, rtol=1e-5)[1]
    for name in names:
        assert found[name] == pytest.approx(expected[name], abs=1e-3)


def test_a_fit_finds_the_stress_and_its_exponent_within_their_intervals(contact, measured):
    start = contact.replace(shear_stress=1e5, speed_exponent=0.05)
    found = sb.fit(measured, start, free=["shear_stress", "speed_exponent"])
    values = {each.name: each for each in found.inputs}
    for name, truth in (("shear_stress", TAU), ("speed_exponent", EXPONENT)):
        low, high = values[name].interval_95
        assert low < truth < high < 1.6 * low
    assert values["shear_stress"].texts[0].endswith("kPa")


@pytest.mark.slow
def test_slopes_of_a_fit_are_those_of_differences(contact, measured):
    case = contact.replace(shear_stress=1.5e5)
    settings = settings_of(case)
    data = read_measurements(measured, settings)
    names = ("shear_stress", "roughness", "modulus", "speed_exponent")
    model = FrictionModel(case, data, free_inputs(case, data, names, settings))
    states = model.states("balanced", 1e-7, lambda: None).solved()
    theta, step = np.array([0.1, -0.05, 0.02, 0.2]), 1e-3
    jacobian = model.predict(theta, states).jacobian
    for k, move in enumerate(step * np.eye(4)):
        ahead, behind = (model.predict(theta + sign * move, states).friction for sign in (1, -1))
        assert jacobian[:, k] == pytest.approx((ahead - behind) / (2 * step), rel=1e-4, abs=1e-7)


def test_the_command_fits_the_stress_where_a_coefficient_is_fitted_by_default(measured, tmp_path, capsys):
    text = (EXAMPLES / "rod_seal.toml").read_text().replace("boundary_friction = 0.3", "").replace('"exit"', '"none"')
    path, out = tmp_path / "case.toml", tmp_path / "fitted.toml"
    path.write_text(text + '\n[asperity_friction]\nmodel = "shear-stress"\nshear_stress = "0.1 MPa"\nspeed_exponent = 0.1\n')
    found = call(capsys, "fit", measured, path, "--out", out).out
    assert "shear_stress  " in found
    assert "boundary_friction" not in found
    fitted = sb.load_case(out).contact
    assert fitted.asperity_friction.shear_stress == pytest.approx(TAU, rel=0.1)
    assert fitted.roughness == pytest.approx(1e-6, rel=0.1)


def test_a_fit_needs_a_first_value_of_the_exponent(seal, measured):
    for exponent, words in ((0.0, "speed_exponent is 0 in the case"), (-0.1, "it must be positive")):
        case = seal.replace(shear_stress=TAU, speed_exponent=exponent)
        with pytest.raises(sb.InputError, match=words):
            sb.fit(measured, case, free=["shear_stress", "speed_exponent"])
    with pytest.raises(sb.InputError, match="no curve has one"):
        sb.fit(measured, seal, free=["shear_stress"])


@pytest.mark.slow
def test_the_regime_changes_where_the_margins_say(contact):
    margins = {each.name: each for each in regime_margins(contact, rtol=1e-4).margins}
    assert "viscosity" not in margins  # the stress follows the speed
    for name, mark in (
        ("speed", margins["speed"].more),
        ("load", margins["load"].less),
        ("roughness", margins["roughness"].less),
    ):
        assert mark.regime == "hydrodynamic"
        away = 1.001 if mark.factor > 1 else 1 / 1.001
        before, after = (sb.solve(contact.replace(**{name: mark.value * each})).regime for each in (1 / away, away))
        assert (before, after) == ("mixed", "hydrodynamic")


@pytest.mark.slow
def test_margins_stay_within_the_speeds_of_a_table(seal):
    table = seal.replace(asperity_friction=ShearStressTable([1e-2, 1e-1, 0.3], [1e5, 2e5, 3e5]))
    [speed, *_] = regime_margins(table, rtol=1e-4).margins
    assert speed.less is None
    assert speed.more is None
    assert speed.searched == pytest.approx((1e-2, 0.3))
    assert sb.stribeck_curve(table, points=3, rtol=1e-3).values[[0, -1]] == pytest.approx((1e-2, 0.3))


def test_where_little_of_the_surface_touches_studies_are_those_of_a_coefficient(seal):
    law = seal.law.scaled(20e-6)
    rough = seal.replace(law=law, **law.coefficients, load=10.0, speed=1e-3, cavitation="none", shear_stress=TAU)
    mu0 = rough.asperity_friction.coefficient_at_small_area(rough)
    by_stress, by_coefficient = (
        sb.propagate(each, {"load": 0.1}, transitions=False) for each in (rough, rough.replace(boundary_friction=mu0))
    )
    for one, other in zip(by_stress.spreads, by_coefficient.spreads, strict=True):
        assert one.interval_95 == pytest.approx(other.interval_95, rel=2e-3)


def test_the_interval_of_friction_holds_the_states_at_its_ends(contact):
    found = sb.propagate(contact, {"shear_stress": 0.1, "roughness": 1e-4}, transitions=False)
    sigma = math.sqrt(math.log1p(0.1**2))
    ends = [sb.solve(contact.replace(shear_stress=TAU * math.exp(sign * 1.96 * sigma))).friction.total for sign in (-1, 1)]
    assert found.spreads[0].interval_95 == pytest.approx(ends, rel=0.01)
    assert found.contributions["shear_stress"] > 0.999
    by_load = sb.propagate(contact, {"load": 0.1}, transitions=False)
    falling = [sb.solve(contact.replace(load=contact.load * math.exp(sign * 1.96 * sigma))).friction.total for sign in (1, -1)]
    assert by_load.spreads[0].interval_95 == pytest.approx(falling, rel=0.01)


@pytest.mark.slow
def test_a_diagram_has_the_friction_of_its_states_and_says_which_it_is(contact):
    diagram = sb.phase_diagram(contact, speed=[0.05, 0.1, 0.2], load=770.0, roughness=1e-6)
    state = sb.solve(contact.replace(speed=0.1))
    assert float(diagram.friction[0, 0, 1]) == pytest.approx(state.friction.total, rel=1e-3)
    assert math.isnan(diagram.attrs["boundary_friction"])
    assert diagram.attrs["asperity_friction"] == "shear-stress"
    mark = float(diagram.speed_at_10_percent_contact_friction[0, 0])
    assert sb.solve(contact.replace(speed=mark)).friction.contact_share == pytest.approx(0.1, abs=1e-4)


def test_the_atlas_is_refused_which_holds_no_area(contact):
    with pytest.raises(sb.InputError, match="not their real area of contact"):
        sb.stribeck_curve(contact, method="atlas")


def test_the_page_takes_a_stress_in_the_place_of_the_coefficient(seal):
    start = inputs.from_case(sb.load_case(EXAMPLES / "rod_seal.toml"))
    chosen = choices.choose(start, "asperity_friction", "shear-stress")
    stressed = choices.with_detail(chosen, "asperity_friction", "shear_stress", "0.3 MPa")
    assert stressed.contact == seal.replace(shear_stress="0.3 MPa")
    assert inputs.row_of(stressed, "boundary_friction")["text"] == ""
    query = url.encode(stressed)
    assert url.decode(parse_qsl(query, keep_blank_values=True), start).inputs.contact == stressed.contact
    assert choices.choose(stressed, "asperity_friction", "coulomb").contact.boundary_friction == 0.7
    model = Answerer()
    shown = model(stressed)
    assert float(shown.solution.friction) == pytest.approx(float(sb.solve(stressed.contact).friction), rel=1e-6)
    moved = inputs.with_text(stressed, "load_group", "5")
    assert moved.contact.groups.load == pytest.approx(5.0, rel=1e-6)
    assert moved.contact.asperity_friction == stressed.contact.asperity_friction
    with pytest.raises(sb.InputError, match="needs the real area of contact"):
        choices.choose(choices.typical("line"), "asperity_friction", "shear-stress")
    assert "shear-stress" in choices.available_values("asperity_friction", "point")
