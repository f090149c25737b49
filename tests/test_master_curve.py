"""Friction of several fluids and loads over one abscissa: whether it is one curve, and what breaks it."""

import json

import numpy as np
import pytest
from command_line import EXAMPLES, call
from fit_data import TRUE, measured

import stribeck as sb

JOINT = EXAMPLES / "joint"
FILES = [JOINT / "oil_30.csv", JOINT / "oil_60.csv", JOINT / "thin_oil_30.csv"]
NOISE = 0.03


def shape(eta_u):
    """Return friction that is one curve over viscosity times speed."""
    x = np.log(eta_u)
    return 0.6 / (1 + np.exp(0.8 * (x + 5.0))) + 0.01 * np.exp(0.5 * (x + 5.0)) + 0.02


def curves(seed, factors=(1, 1, 1), wrong_viscosity=1.0, error=None, rows=12, loads=(30.0, 30.0, 30.0)):
    """Return noisy measurements of three fluids, with factors on friction, one with a viscosity that is said wrongly."""
    rng = np.random.default_rng(seed)
    values, friction = [], []
    viscosities = (0.05, 0.02, 0.005)
    for i, (viscosity, factor) in enumerate(zip(viscosities, factors, strict=True)):
        eta_u = np.geomspace(1e-5, 0.1, rows) * (1 + 0.2 * i)
        values.append(eta_u / viscosity)
        true = shape(eta_u / (wrong_viscosity if i == 1 else 1.0))
        friction.append(factor * true * np.exp(NOISE * rng.standard_normal(rows)))
    return measured(
        np.concatenate(values),
        np.concatenate(friction),
        error=None if error is None else error * np.concatenate(friction),
        curve=np.repeat(range(3), rows),
        curves=("oil", "mix", "water"),
        inputs=tuple({"viscosity": eta, "load": load} for eta, load in zip(viscosities, loads, strict=True)),
    )


def test_curves_that_are_one_are_said_to_be_and_lie_beside_each_other_within_their_errors():
    found = [sb.master_curve(curves(seed, error=NOISE if seed % 2 else None), TRUE)["speed_viscosity"] for seed in range(8)]
    assert sum(each.is_one for each in found) >= 7
    assert np.mean([each.ratio for each in found]) == pytest.approx(1.0, abs=0.15)
    offsets = [offset for each in found for offset in each.offsets]
    inside = [abs(np.log1p(each.offset)) < 2.1 * each.offset_error for each in offsets]
    assert len(inside) == 24 and sum(inside) >= 21
    assert sum(offset.is_far for offset in offsets) <= 2
    assert np.mean([each.noise for each in found[::2]]) == pytest.approx(NOISE, rel=0.15)


def test_what_breaks_the_curve_is_named_with_its_direction_and_size():
    for seed, error in ((1, None), (2, NOISE)):
        broken = sb.master_curve(curves(seed, factors=(1, 0.8, 1), error=error), TRUE)["speed_viscosity"]
        far = broken.offsets[0]
        assert not broken.is_one and broken.ratio > 2
        assert (
            far.curve == "mix" and far.is_far and not far.is_shift and "mix lies" in far.sentence and "below" in far.sentence
        )
        assert np.log1p(far.offset) == pytest.approx(np.log(0.8), abs=4 * far.offset_error)
        shifted = sb.master_curve(curves(seed, wrong_viscosity=1.7, error=error), TRUE)["speed_viscosity"]
        mix = next(each for each in shifted.offsets if each.curve == "mix")
        assert not shifted.is_one and mix.is_shift and mix.is_far
        assert f"; a factor {mix.shift:.3g} ± " in mix.sentence and "a factor" not in far.sentence
        assert np.log(mix.shift) == pytest.approx(-np.log(1.7), abs=4 * mix.shift_error)


def test_curves_that_are_one_are_not_named_for_a_third_that_lies_apart():
    for seed in range(4):
        broken = sb.master_curve(curves(seed, factors=(1, 1, 0.6)), TRUE)["speed_viscosity"]
        assert [each.curve for each in broken.offsets if each.is_far] == ["water"]
        assert broken.offsets[0].offset == pytest.approx(-0.4, abs=0.03)


def test_a_power_of_an_input_is_found_where_friction_goes_with_it():
    loads = (10.0, 40.0, 160.0)
    data = curves(5, factors=[load**-0.2 for load in loads], loads=loads)
    found = sb.master_curve(data, TRUE)["speed_viscosity"]
    power = next(each for each in found.powers if each.name == "load")
    assert power.power == pytest.approx(-0.2, abs=4 * power.power_error) and power.power_error < 0.05


def test_the_abscissas_are_those_of_a_cylinder_and_of_a_ball():
    data = curves(1)
    line = sb.master_curve(data, TRUE)
    viscosity = np.array([each["viscosity"] for each in data.inputs])[data.curve]
    np.testing.assert_allclose(line["speed_viscosity"].values, data.values * viscosity, rtol=1e-12)
    np.testing.assert_allclose(line["hersey_number"].values, data.values * viscosity / 30.0, rtol=1e-12)
    ball = sb.load_case(EXAMPLES / "pdms_ball.toml").contact
    point = sb.master_curve(data, ball)
    np.testing.assert_allclose(point["hersey_number"].values, data.values * viscosity * ball.radius / 30.0, rtol=1e-12)


def test_the_command_prints_draws_and_exports_what_python_has(capsys, tmp_path):
    picture = tmp_path / "master.png"
    answer = call(capsys, "master", JOINT / "*.csv", JOINT / "case.toml", "--json", "--plot", picture)
    assert answer.code == 0 and picture.stat().st_size > 10_000
    found = json.loads(answer.out)["collapses"]
    assert {each["over"] for each in found} == {"speed_viscosity", "hersey_number"}
    curve = sb.master_curve(FILES, sb.load_case(JOINT / "case.toml"))
    assert [each.ratio for each in curve.collapses] == [each["ratio"] for each in found]
    assert curve["speed_viscosity"].ratio > 4  # for the noise of steep curves, shifted by their load, is found
    text = str(curve)
    assert "The 3 curves are not one" in text and "oil_60 lies" in text and "below the others" in text
    data = curve.to_dataset()
    assert data["common_friction_hersey_number"].dims == ("row",) and data["speed_viscosity"].attrs["units"] == "Pa m"
    assert float(data["ratio_speed_viscosity"]) == curve["speed_viscosity"].ratio


def test_what_cannot_be_compared_is_refused():
    one = measured(np.geomspace(1e-3, 1.0, 6), np.geomspace(0.5, 0.1, 6))
    with pytest.raises(sb.InputError, match="1 curve with at least 6 rows"):
        sb.master_curve(one, TRUE)
    apart = measured(
        np.geomspace(1e-4, 1e4, 12), np.geomspace(0.5, 0.1, 12), curve=[0] * 6 + [1] * 6, curves=("a", "b"), inputs=({}, {})
    )
    with pytest.raises(sb.InputError, match="do not lie beside each other"):
        sb.master_curve(apart, TRUE)
    with pytest.raises(KeyError, match="there are"):
        sb.master_curve(curves(1), TRUE)["speed"]
