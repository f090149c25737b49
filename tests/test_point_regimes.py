"""Regimes of balls: margins, phase diagrams and checks, judged by states that are solved beside them."""

import math

import ball_data
import numpy as np
import pytest

import stribeck as sb
from stribeck.regimes.margins import regime_margins

BALL = ball_data.BALL.replace(slide_to_roll=2.0)
LAW = sb.surfaces.persson_law(sb.surfaces.SelfAffine(h_rms=1e-6, q0=3e4, q1=3e6, hurst=0.8))


# Deep in boundary lubrication the fluid's share is smaller than errors of slopes were: other regimes stood 1 % away.
LIGHT = sb.PointContact(
    radius=8e-3,
    modulus=2.8e6,
    load=3.5e-3,
    viscosity=0.013,
    speed=1.1e-3,
    roughness=4.6e-6,
    alpha=2,
    beta=0.06,
    boundary_friction=0.4,
)


@pytest.mark.slow
@pytest.mark.parametrize("ball", [BALL, LIGHT], ids=["mixed", "boundary"])
def test_margins_of_a_ball_lead_to_the_regimes_that_they_name(ball):
    found = regime_margins(ball, rtol=1e-3)
    assert found.regime == sb.solve(ball, rtol=1e-3).regime and found.geometry == "point"
    for margin in found.margins:
        for mark in (margin.less, margin.more):
            if mark is not None:
                values = (mark.value * factor for factor in (0.98, 1.02))
                ends = {sb.solve(ball.replace(**{margin.name: value}), rtol=1e-4).regime for value in values}
                assert ends == {found.regime, mark.regime}, margin.name
    speed, viscosity = found.margins[0], found.margins[3]
    assert viscosity.more.factor == pytest.approx(speed.more.factor)


@pytest.mark.slow
def test_a_phase_diagram_of_balls_holds_states_and_their_transitions():
    pytest.importorskip("xarray")
    speeds = [1e-4, 1e-3, 1e-2]
    found = sb.phase_diagram(BALL.groups, speed=speeds, load=[1e-2], roughness=[2e-4], boundary_friction=0.8, beta=0.1)
    assert set(found.outcome.values.ravel()) == {"CONVERGED"}
    assert float(found.error_estimate.max()) <= 1e-3
    alone = sb.solve(sb.Groups(1e-3, 1e-2, 2e-4, geometry="point"), rtol=1e-3)
    assert float(found.fluid_load_share[0, 0, 1]) == pytest.approx(alone.fluid_load_share, abs=2e-3)
    assert float(found.friction[0, 0, 1]) == pytest.approx(alone.friction(0.8, 0.1).total, rel=3e-3)
    half = float(found.speed_at_half_fluid[0, 0])
    assert sb.solve(sb.Groups(half, 1e-2, 2e-4, geometry="point"), rtol=1e-3).fluid_load_share == pytest.approx(0.5, abs=2e-3)
    assert float(found.speed_at_5_percent_fluid[0, 0]) < half < float(found.speed_at_minimum[0, 0])
    assert np.isnan(found.formula_speed_at_minimum).all() and found.attrs["title"].endswith("rough point contact")
    with pytest.raises(sb.InputError, match="merging"):
        sb.phase_diagram(BALL, merging=True)


@pytest.mark.slow
def test_checks_of_a_ball_trace_its_curve_around_the_minimum():
    curve = sb.stribeck_curve(BALL, rtol=1e-3)
    found = sb.check(BALL)
    state = curve.minimum.solution
    film = state.central_gap * BALL.hertz.indentation / BALL.roughness
    assert found["contact law at the minimum"].value == pytest.approx(film, rel=2e-2)
    assert not [each for each in found.unchecked if "minute" in each]
    tail = found["tail of the contact law"]
    assert 0.02 < tail.value < 0.6
    assert "minimum of friction" in tail.sentence


@pytest.mark.slow
def test_errors_of_the_inputs_of_a_ball_become_those_of_friction_and_regime():
    found = sb.propagate(BALL, {"roughness": 0.02, "boundary_friction": 0.05})
    assert sum(found.regimes.values()) == pytest.approx(1.0)
    assert found.regimes["mixed"] == pytest.approx(1.0, abs=1e-6)

    def slope(name):
        ends = [sb.solve(BALL.replace(**{name: getattr(BALL, name) * factor}), rtol=1e-5) for factor in (1.01, 1 / 1.01)]
        return math.log(ends[0].friction().total / ends[1].friction().total) / (2 * math.log(1.01))

    parts = {"roughness": slope("roughness") * 0.02, "boundary_friction": slope("boundary_friction") * 0.05}
    wanted = math.hypot(*parts.values())
    low, high = next(each for each in found.spreads if each.name == "friction").interval_68
    assert 0.5 * math.log(high / low) == pytest.approx(wanted, rel=0.05)
    assert (parts["boundary_friction"] / wanted) ** 2 == pytest.approx(found.contributions["boundary_friction"], rel=0.02)


def test_the_interval_of_friction_of_a_ball_in_a_drop_lies_around_its_friction():
    """Friction up to the rim was that of a far film: the interval of this state began above its value."""
    given = dict(radius=0.01, modulus=2e6, load=0.9, viscosity=0.1, speed=1.1, alpha=2, beta=0.1, boundary_friction=0.5)
    drop = sb.PointContact(**given, roughness=4.5e-7, wetted_radius=2.25e-3)
    found = sb.propagate(drop, {"viscosity": 0.1})["friction"]
    for k, end in zip((-1.96, 1.96), found.interval_95, strict=True):
        there = drop.replace(viscosity=0.1 * math.exp(k * math.sqrt(math.log1p(0.01))))
        assert end == pytest.approx(sb.solve(there, rtol=1e-3).friction().total, rel=5e-3)


@pytest.mark.slow
def test_marks_of_a_coarse_curve_are_those_of_a_fine_one():
    near = tuple(BALL.speed * factor for factor in (0.3, 300.0))
    found, fine = (sb.stribeck_curve(BALL, speed=near, points=5, rtol=rtol).transitions for rtol in (3e-3, 1e-3))
    assert len(found) >= 2 and [mark.name for mark in found] == [mark.name for mark in fine]
    for mark, exact in zip(found, fine, strict=True):
        assert mark.value == pytest.approx(exact.value, rel=6e-3)
        assert mark.friction == pytest.approx(exact.friction, rel=3e-3)
