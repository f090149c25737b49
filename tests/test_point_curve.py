"""The Stribeck curve of a ball: its states, minimum and transitions, and what it becomes in files and pictures."""

import json
import pickle
from pathlib import Path

import numpy as np
import pytest

import stribeck as sb
from stribeck import Outcome

LOAD, ROUGHNESS, RTOL = 1e-3, 1e-5, 1e-3
SMOOTH = ("contact_load_share", "fluid_load_share", "central_gap", "central_pressure", "offset", "J_balanced", "J_published")
MU0, BETA = 1.0, 0.05


def groups(speed=1.0):
    return sb.Groups(speed, LOAD, ROUGHNESS, geometry="point")


@pytest.fixture(scope="module")
def curve():
    return sb.stribeck_curve(groups(), speed=(1e-5, 1e-1), points=9, rtol=RTOL, boundary_friction=MU0, beta=BETA)


def test_each_point_of_a_curve_is_the_state_solved_from_cold(curve):
    assert curve.outcome is Outcome.CONVERGED
    assert len(curve) == 9
    assert curve.error_estimate <= RTOL
    cold = sb.solve(groups(float(curve.values[4])), rtol=RTOL)
    assert curve.observable("contact_load_share")[4] == pytest.approx(cold.contact_load_share, abs=2 * RTOL)
    assert curve.friction[4] == pytest.approx(cold.friction(MU0, BETA).total, rel=2 * RTOL)


@pytest.mark.slow
def test_an_interval_much_longer_than_the_next_does_not_magnify_errors_of_its_states():
    like = sb.Groups(1.0, 0.0239862, 0.00588111, geometry="point")
    curve = sb.stribeck_curve(like, speed=(0.4, 3.018), points=9, rtol=RTOL, cavitation="exit")
    assert curve.outcome is Outcome.CONVERGED and curve.error_estimate <= 2 * RTOL
    cold = sb.solve(curve.solutions[5].groups, rtol=RTOL)
    for name in SMOOTH[:4]:
        assert curve.observable(name)[5] == pytest.approx(getattr(cold, name), rel=4 * RTOL)


def test_the_minimum_of_a_ball_lies_where_no_state_beside_it_has_less_friction(curve):
    found = curve.minimum
    assert found.value == pytest.approx(0.0038564, rel=2e-3)
    assert found.friction < curve.friction.min()


def test_the_transitions_of_a_ball_are_where_their_names_say(curve):
    marks = {mark.name: mark for mark in curve.transitions}
    assert len(marks) == 4 and list(marks)[-1] == curve.landmark("minimum").name
    assert curve.landmark("boundary_end").solution.fluid_load_share == pytest.approx(0.05, abs=1e-6)
    assert curve.landmark("equal_shares").solution.fluid_load_share == pytest.approx(0.5, abs=1e-6)
    assert [name for name, _, _ in curve.regime_ranges] == ["boundary", "mixed", "hydrodynamic"]


def test_a_curve_of_a_ball_becomes_files_and_a_picture(curve, tmp_path):
    xarray = pytest.importorskip("xarray")
    pytest.importorskip("matplotlib")
    curve.to_netcdf(tmp_path / "curve.nc")
    curve.to_csv(tmp_path / "curve.csv")
    with xarray.open_dataset(tmp_path / "curve.nc") as found:
        assert found.attrs["geometry"] == "point"
        np.testing.assert_allclose(found["minimum_radius"], curve.observable("minimum_radius"))
    assert curve.plot(tmp_path / "curve.png") is not None


@pytest.fixture(scope="module")
def persson():
    spectrum = sb.surfaces.SelfAffine(h_rms=1e-6, q0=3e4, q1=3e6, hurst=0.8)
    start = sb.Groups(1.0, 3.375, 1e-2 * 3.375 ** (2 / 3), geometry="point")
    return sb.stribeck_curve(start, speed=(1e-3, 1e-1), points=5, rtol=RTOL, law=sb.surfaces.persson_law(spectrum, 0.45))


@pytest.mark.parametrize(
    ("name", "value"), [("curve", 2.3e-4), ("curve", 6e-3), pytest.param("persson", 7e-3, marks=pytest.mark.slow)]
)
def test_a_curve_of_a_ball_is_known_between_its_states_within_the_error_that_it_states(name, value, request):
    found = request.getfixturevalue(name)
    at, state = found.at(value), found.solve_at(value)
    tight = sb.solve(state.groups, rtol=RTOL / 100)
    assert found.states < 25
    for each in (*SMOOTH, "minimum_gap", "minimum_gap_on_axis"):
        wanted = tight.state.values[each]
        scale = at.errors[each] and abs(wanted) if each.startswith("minimum_gap") else tight.state.scales[each]
        assert abs(getattr(at, each) - wanted) <= (at.errors[each] + tight.state.errors[each]) * scale, each
    assert state.errors["central_gap"] <= RTOL


def test_many_values_of_a_curve_of_a_ball_are_those_of_each(curve):
    many, one = curve.at([1e-4, 1e-3]), curve.at(1e-3)
    assert many.friction.shape == (2,)
    assert many.friction[1] == one.friction
    assert many.errors["minimum_gap"][1] == one.errors["minimum_gap"]
    with pytest.raises(sb.InputError, match="outside the curve"):
        curve.at(1.0)


def test_a_curve_of_a_ball_over_the_load_moves_all_groups(curve):
    ball = sb.PointContact(
        radius=0.01, modulus=2e6, load=0.01, viscosity=1.0, speed=0.01, roughness=5e-8, alpha=2, beta=0.1, boundary_friction=1
    )
    found = sb.stribeck_curve(ball.replace(wetted_radius=3e-3), load=(0.005, 0.02), points=3, rtol=RTOL)
    solved = sb.solve(ball.replace(wetted_radius=3e-3, load=0.013), rtol=RTOL)
    assert found.at(0.013).friction == pytest.approx(solved.friction.total, rel=2 * RTOL)
    assert found.at([0.012, 0.013]).friction[1] == pytest.approx(found.at(0.013).friction, rel=1e-9)


def test_a_curve_over_the_load_of_a_ball_in_a_drop_has_its_viscous_friction():
    """The drop ends at more or fewer contact radii as the load changes: its viscous part was off by up to 117 %."""
    given = dict(radius=0.01, modulus=2e6, load=0.01, viscosity=1.0, speed=0.1, roughness=5e-8, alpha=2, beta=0.1)
    drop = sb.PointContact(**given, boundary_friction=1, wetted_radius=6e-4)
    found = sb.stribeck_curve(drop, load=(0.005, 0.02), points=3, rtol=RTOL)
    for load in (0.007, 0.017):
        solved = sb.solve(drop.replace(load=load), rtol=RTOL).friction()
        assert found.at(load).friction.fluid == pytest.approx(solved.fluid, rel=1e-4)


def test_a_film_that_does_not_feel_the_roughness_takes_a_few_states():
    found = sb.stribeck_curve(groups(1.0), roughness=(1e-6, 1e-4), points=3, rtol=RTOL)
    assert found.states <= 6
    assert found.minimum is None


def test_a_curve_of_a_ball_stays_itself_after_pickling_and_fits_a_screen(curve):
    other = pickle.loads(pickle.dumps(curve))
    assert other == curve
    assert other.at(1e-3).friction == curve.at(1e-3).friction
    assert len(repr(curve)) < 3000


@pytest.mark.parametrize(
    "physics",
    [
        pytest.param({"cavitation": "exit"}, marks=pytest.mark.slow),
        pytest.param({"cavitation": "reform", "cavity_pressure": -0.02}, marks=pytest.mark.slow),
        pytest.param({"fluid": sb.fluids.Carreau(1e4, 0.5)}, marks=pytest.mark.slow),
        {"flow_factors": sb.fluids.PatirCheng(1)},
    ],
    ids=lambda each: next(iter(each)),
)
def test_a_curve_of_any_film_is_right_between_its_states_within_its_stated_error(physics):
    found = sb.stribeck_curve(groups(0.1), speed=(3e-4, 1e-2), points=4, rtol=2e-3, **physics)
    for speed in (5e-4, 4e-3):
        there, solved = found.at(speed), found.solve_at(speed)
        for name in ("contact_load_share", "central_gap", "J_balanced"):
            scale = 1.0 if name.endswith("share") else abs(getattr(solved, name))
            error = (there.errors[name] + solved.errors[name]) * scale
            assert abs(getattr(there, name) - getattr(solved, name)) <= error, name
        friction = solved.friction()
        assert abs(there.friction - friction.total) <= there.friction.error + friction.error


def test_a_curve_over_the_load_of_a_ball_at_rest_is_a_function():
    found = sb.stribeck_curve(groups(0.0), load=(1e-3, 2e-3), points=2, rtol=1e-3)
    there, solved = found.at(1.4e-3), sb.solve(sb.Groups(0.0, 1.4e-3, ROUGHNESS, geometry="point"), rtol=1e-3)
    assert there.central_gap == pytest.approx(solved.central_gap, rel=2e-3)
    assert there.minimum_gap == pytest.approx(solved.minimum_gap, rel=2e-3)


@pytest.mark.slow
def test_the_curve_of_a_ball_agrees_with_an_independent_solver():
    reference = json.loads((Path(__file__).parent / "data" / "point_curve.json").read_text())
    speeds = [point["speed"] for point in reference["points"]]
    start = sb.Groups(1.0, reference["load"], reference["roughness"], geometry="point")
    found = sb.stribeck_curve(start, speed=speeds, rtol=1e-6)
    for name in ("contact_load_share", "central_gap", "J_balanced"):
        wanted = np.array([point["values"][name] for point in reference["points"]])
        allowed = np.array([point["uncertainty"][name] for point in reference["points"]])
        scale = 1.0 if name == "contact_load_share" else np.abs(wanted)
        assert (np.abs(found.observable(name) - wanted) <= 2e-6 * scale + allowed).all(), name


def test_a_curve_of_a_ball_chooses_its_speeds_from_plateau_to_branch():
    rough = sb.Groups(1.0, 0.1, 3e-3, geometry="point")
    found = sb.stribeck_curve(rough, points=4, rtol=1e-2, boundary_friction=1.0, beta=1.0)
    assert found.regimes[0] == "boundary"
    assert found.regimes[-1] == "hydrodynamic"
    assert found.observable("fluid_load_share")[0] < 1e-3


@pytest.mark.slow
def test_errors_between_states_hold_where_two_meshes_agree_by_chance_in_the_middle():
    """The central gap erred by 1.3 times what was stated: that of both meshes beside it was the same."""
    groups = sb.Groups(1e-2, 0.1, 3e-4, geometry="point")
    curve = sb.stribeck_curve(groups, speed=np.array([1e-5, 1.06e-3, 1.12e-3, 1e-1]), rtol=1e-3)
    for read in curve.solutions[1:3]:
        exact = sb.solve(read.groups, rtol=1e-5)
        error = abs(read.central_gap / exact.central_gap - 1)
        assert error <= read.errors["central_gap"] + exact.errors["central_gap"]
