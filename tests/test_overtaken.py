"""Where the cylinder or the ball is the faster body friction has the other sign; what is found on it goes by its size."""

import math

import numpy as np
import pytest
from fit_data import TRUE, measured

import stribeck as sb
from stribeck.atlas import friction, friction_derivatives

GROUPS, BALL = sb.Groups(1e-3, 0.1, 1e-3), sb.Groups(1e-2, 1e-3, 1e-4, geometry="point")
DRY, BETA = 0.5, 0.05


def curve(groups, ratio, rtol, **others):
    settings = {"boundary_friction": DRY, "beta": BETA, "rtol": rtol, **others}
    return sb.stribeck_curve(groups, speed=(1e-4, 3.0), points=11, slide_to_roll=ratio, **settings)


def sizes(found, wall):
    """Return the size of the friction on a wall at all points, whose minimum no two walls and motions share."""
    return np.abs([getattr(one.friction(DRY, BETA), wall) for one in found.solutions])


@pytest.mark.slow
def test_the_minimum_of_an_overtaken_substrate_is_that_of_the_cylinder_that_overtakes_in_its_place(subtests):
    for ratio, cavitation in [(0.5, "none"), (4.0, "exit")]:
        with subtests.test(ratio=ratio, cavitation=cavitation):
            there = curve(GROUPS, ratio, 1e-5, cavitation=cavitation)
            back = curve(GROUPS, -ratio, 1e-5, cavitation=cavitation)
            assert sizes(back, "lower") == pytest.approx(sizes(there, "upper"), rel=1e-4, abs=1e-6)
            minimum, size = back.minimum, sizes(there, "upper")
            i = int(np.argmin(size))
            assert there.values[i - 1] < minimum.value < there.values[i + 1]
            mirrored = sb.solve(minimum.solution.groups, slide_to_roll=ratio, cavitation=cavitation).friction(DRY, BETA).upper
            assert -minimum.friction == pytest.approx(mirrored, abs=1e-7)
            assert abs(minimum.friction) <= size.min()
            if ratio == 0.5:  # the pull of the film outweighs the sliding: friction changes its sign
                assert minimum.friction == 0
            for name in ("boundary_end", "equal_shares"):
                marks = there.landmark(name), back.landmark(name)
                assert marks[1].value == pytest.approx(marks[0].value, rel=marks[0].error + marks[1].error)
                assert marks[1].friction < 0 < marks[0].friction


def test_the_minimum_of_a_ball_goes_by_the_size_too():
    ratio = -0.5
    found = curve(BALL, ratio, 1e-3)
    size, minimum = np.abs(found.friction.total), found.minimum
    i = int(np.argmin(size))
    assert 0 < i < len(found) - 1 and found.values[i - 1] < minimum.value < found.values[i + 1]
    assert abs(minimum.friction) <= 1.001 * size.min()
    assert minimum.friction == 0
    dry = found.friction.asperities
    assert dry == pytest.approx(-DRY * found.observable("contact_load_share"), rel=1e-12)
    read = friction(BALL, DRY, BETA, slide_to_roll=ratio)
    assert read == pytest.approx(sb.solve(BALL, slide_to_roll=ratio, rtol=1e-4).friction(DRY, BETA).total, rel=2e-3)


def test_derivatives_off_the_atlas_are_those_of_the_friction_with_its_sign():
    step = 1e-5
    ends = [
        friction(sb.Groups(1e-2 * math.exp(each), 1e-3, 1e-4, geometry="point"), DRY, BETA, slide_to_roll=-1.0)
        for each in (step, -step)
    ]
    found = friction_derivatives(BALL, DRY, BETA, slide_to_roll=-1.0)[0]
    assert ends[0] < 0 and found == pytest.approx((ends[0] - ends[1]) / (2 * step), rel=1e-5)


def test_a_fit_predicts_the_size_of_friction_which_is_what_a_rig_measures():
    true = TRUE.replace(slide_to_roll=-1.0)
    speeds = np.geomspace(1e-3, 0.3, 7)
    size = np.abs(sb.stribeck_curve(true, speed=speeds, rtol=1e-5).friction.total)
    start = true.replace(boundary_friction=0.8 * true.boundary_friction, roughness=1.2 * true.roughness)
    found = sb.fit(measured(speeds, size, error=1e-4), start, free=["boundary_friction", "roughness"], intervals=False)
    assert found.friction == pytest.approx(size, abs=1e-5)
    assert found["boundary_friction"].value == pytest.approx(true.boundary_friction, rel=1e-4)
    assert found["roughness"].value == pytest.approx(true.roughness, rel=1e-4)


def test_pictures_show_sizes():
    contact = TRUE.replace(slide_to_roll=-1.0)
    drawn = sb.stribeck_curve(contact, points=9, rtol=1e-3).plot()
    axes = drawn.axes[0]
    assert axes.get_ylabel().startswith("size") and axes.get_yscale() == "log"
    assert all((np.asarray(line.get_ydata()) >= 0).all() for line in axes.lines)
