"""Fits of numbers of the fluid and the solid: derivatives, exact values from exact data, and what is said of them."""

import numpy as np
import pytest
from fit_data import TRUE, measured

import stribeck as sb
from stribeck import FitSettings
from stribeck.fits.case_file import write_fitted_case
from stribeck.fits.free_inputs import free_inputs
from stribeck.fits.model import FrictionModel
from stribeck.fits.states.solved import solved_parts
from stribeck.fits.states.sources import in_atlas

SPEEDS = np.geomspace(1e-3, 0.3, 6)
EXIT_AND_BARUS = {"fluid": sb.fluids.Barus("500 1/GPa"), "cavitation": "exit"}
LAYER = {"solid": sb.solids.Layer("1 mm")}


def friction_of(contact, speeds=SPEEDS):
    return np.asarray(sb.stribeck_curve(contact, speed=speeds, points=len(speeds), rtol=1e-5).friction)


@pytest.mark.parametrize(
    ("parts", "free"),
    [
        (EXIT_AND_BARUS, ("pressure_coefficient", "modulus", "beta")),
        pytest.param(LAYER, ("layer_thickness", "radius"), marks=pytest.mark.slow),
        ({"flow_factors": "effective-medium"}, ("roughness", "alpha")),
        ({"fluid": sb.fluids.Eyring("2 kPa")}, ("eyring_stress", "load")),
        pytest.param(
            {"fluid": sb.fluids.Cross("1 ms", 0.5, "1 mPa*s"), "cavitation": "exit"},
            ("relaxation_time", "exponent", "infinite_viscosity", "viscosity"),
            marks=pytest.mark.slow,
        ),
    ],
)
def test_the_derivatives_along_numbers_of_the_model_are_its_differences(parts, free):
    contact = TRUE.replace(**parts)
    speeds = SPEEDS[2:4]
    data = measured(speeds, np.ones(2))
    model = FrictionModel(contact, data, free_inputs(contact, data, free, FitSettings()))
    theta, solved, step = np.full(len(free), -0.1), solved_parts(model, "balanced", 1e-7), 1e-3
    found = model.predict(theta, solved)
    for k in range(len(free)):
        ends = [model.predict(theta + sign * step * np.eye(len(free))[k], solved).friction for sign in (1, -1)]
        difference = (ends[0] - ends[1]) / (2 * step)
        assert found.jacobian[:, k] == pytest.approx(difference, abs=1e-4 * float(found.friction.max()))


def test_states_from_those_before_are_those_that_are_solved_alone():
    contact = TRUE.replace(**EXIT_AND_BARUS)
    data, free = measured(SPEEDS, np.ones(6)), ("pressure_coefficient", "roughness")
    model = FrictionModel(contact, data, free_inputs(contact, data, free, FitSettings()))
    kept = solved_parts(model, "balanced", 1e-6)
    model.predict(np.array([0.3, -0.2]), kept)
    found, alone = (model.predict(np.zeros(2), parts) for parts in (kept, solved_parts(model, "balanced", 1e-6)))
    assert found.friction == pytest.approx(alone.friction, rel=2e-6)
    assert found.jacobian == pytest.approx(alone.jacobian, abs=1e-5)


def test_a_fit_of_films_that_end_reads_their_table_and_finds_what_made_the_data():
    true, free = TRUE.replace(cavitation="exit"), ("roughness", "boundary_friction")
    data = measured(SPEEDS, friction_of(true), error=1e-4)
    start = true.replace(roughness=1.5 * true.roughness, boundary_friction=0.8 * true.boundary_friction)
    model = FrictionModel(start, data, free_inputs(start, data, free, FitSettings()))
    assert in_atlas(model)
    found = sb.fit(data, start, free=free, intervals=False)
    for name in free:
        assert found[name].value == pytest.approx(getattr(true, name), rel=1e-4)


@pytest.mark.parametrize(
    ("parts", "free"),
    [
        (EXIT_AND_BARUS, ("boundary_friction", "pressure_coefficient")),
        pytest.param(LAYER, ("roughness", "layer_thickness"), marks=pytest.mark.slow),
        pytest.param({"fluid": sb.fluids.Carreau("1 ms", 0.5)}, ("relaxation_time", "exponent"), marks=pytest.mark.slow),
        pytest.param({"fluid": sb.fluids.Cross("1 ms", 0.5)}, ("relaxation_time", "exponent"), marks=pytest.mark.slow),
        pytest.param({"fluid": sb.fluids.Eyring("2 kPa")}, ("eyring_stress",), marks=pytest.mark.slow),
    ],
)
def test_a_fit_to_exact_data_finds_the_numbers_of_fluid_and_solid(parts, free):
    true = TRUE.replace(**parts)
    data = measured(SPEEDS, friction_of(true), error=1e-4)
    start = true.replace(**{name: getattr(true, name) * factor for name, factor in zip(free, (1.3, 0.8), strict=False)})
    found = sb.fit(data, start, free=free, intervals=False)
    assert found.converged
    for name in free:
        assert found[name].value == pytest.approx(getattr(true, name), rel=3e-3)
        assert getattr(found.contact, name) == found[name].value
    assert set(free).isdisjoint(found.held)


def test_curves_with_different_fluids_are_fitted_together():
    thick = TRUE.replace(viscosity="0.5 Pa*s", fluid=sb.fluids.Barus("500 1/GPa"))
    friction = np.append(friction_of(TRUE, SPEEDS[:5]), friction_of(thick, SPEEDS[:5]))
    inputs = ({}, {"viscosity": 0.5, "fluid": sb.fluids.Barus("400 1/GPa")})
    data = measured(np.tile(SPEEDS[:5], 2), friction, error=1e-4, curve=np.repeat([0, 1], 5), curves=("a", "b"), inputs=inputs)
    found = sb.fit(data, TRUE, free=["roughness", "pressure_coefficient"], intervals=False)
    assert found.converged
    assert found["pressure_coefficient"].value == pytest.approx(5e-7, rel=3e-3)
    assert found["roughness"].value == pytest.approx(TRUE.roughness, rel=1e-4)
    assert found.contacts[0].fluid == TRUE.fluid
    assert found.contacts[1].pressure_coefficient == found["pressure_coefficient"].value


def test_each_curve_keeps_its_own_fluid_where_no_number_of_it_is_free():
    barus = {"fluid": sb.fluids.Barus("500 1/GPa")}
    speeds = SPEEDS[2:4]
    data = measured(np.tile(speeds, 2), np.ones(4), curve=np.repeat([0, 1], 2), curves=("a", "b"), inputs=({}, barus))
    model = FrictionModel(TRUE, data, free_inputs(TRUE, data, ("roughness",), FitSettings()))
    found = model.predict(np.zeros(1), solved_parts(model, "balanced", 1e-6)).friction
    assert found[:2] != pytest.approx(found[2:], rel=1e-3)
    alone = [
        sb.solve(each.replace(speed=speed)).friction().total for each in (TRUE, TRUE.replace(**barus)) for speed in speeds
    ]
    assert found == pytest.approx(alone, rel=1e-5)


def test_what_the_contact_does_not_have_cannot_be_free():
    data = measured(SPEEDS, np.ones(6))
    with pytest.raises(sb.InputError, match=r"relaxation_time is free, but no curve has one.*carreau"):
        sb.fit(data, TRUE, free=["relaxation_time"])
    with pytest.raises(sb.InputError, match="layer_thickness = 1, but this contact has none"):
        TRUE.replace(layer_thickness=1)


REMEMBERS = TRUE.replace(solid=sb.solids.StandardLinearSolid("10 ms", 3.0))


def test_the_deborah_number_of_a_row_is_that_of_its_speed():
    """And moves with what is free: the modulus widens the contact, which a point of the body takes longer to pass."""
    free, speeds = ("modulus", "boundary_friction"), SPEEDS[2:4]
    data = measured(speeds, np.ones(2))
    model = FrictionModel(REMEMBERS, data, free_inputs(REMEMBERS, data, free, FitSettings()))
    kept, theta = solved_parts(model, "balanced", 1e-6), np.array([0.1, 0.0])
    found = model.predict(theta, kept)
    moved = REMEMBERS.replace(modulus=REMEMBERS.modulus * np.exp(0.1))
    solved = [sb.solve(moved.replace(speed=float(speed))).friction for speed in speeds]
    assert found.friction == pytest.approx(solved, rel=1e-5)
    ends = [model.predict(theta + [step, 0.0], kept).friction for step in (1e-3, -1e-3)]
    assert found.jacobian[:, 0] == pytest.approx((ends[0] - ends[1]) / 2e-3, abs=1e-4)


@pytest.mark.slow
def test_a_fit_on_a_body_that_remembers_finds_what_made_the_data():
    speeds = SPEEDS[1:5]
    data = measured(speeds, [sb.solve(REMEMBERS.replace(speed=float(speed))).friction for speed in speeds], error=1e-4)
    free = ("retardation_time", "modulus_ratio")
    start = REMEMBERS.replace(retardation_time=0.012, modulus_ratio=2.5)
    found = sb.fit(data, start, free=free, intervals=False)
    assert found.converged
    assert [found[name].value for name in free] == pytest.approx([0.01, 3.0], rel=1e-2)


def test_an_exponent_stays_in_the_range_of_its_law():
    contact = TRUE.replace(fluid=sb.fluids.Carreau("1 ms", 0.5))
    data = measured(SPEEDS, np.ones(6))
    [free] = free_inputs(contact, data, ("exponent",), FitSettings())
    assert (free.value(free.low), free.value(free.high)) == pytest.approx((0.05, 1.0))


def test_the_films_of_data_that_do_not_reach_them_say_nothing_of_the_fluid():
    contact = TRUE.replace(**EXIT_AND_BARUS)
    speeds = np.geomspace(1e-8, 1e-7, 4)
    found = sb.fit(
        measured(speeds, friction_of(contact, speeds), error=0.01),
        contact,
        free=["boundary_friction", "pressure_coefficient"],
        intervals=False,
    )
    [weak] = found.undetermined
    assert weak.names == ("pressure_coefficient",)
    assert found["pressure_coefficient"].value == pytest.approx(5e-7)


CASE = """
[contact]
radius = "10 mm"
modulus = "2.7 MPa"
load = "30 N/m"
viscosity = "50 mPa*s"
speed = "1 mm/s"
roughness = "1 um"
alpha = 2.0
beta = 0.06
boundary_friction = 0.7

[fluid]
pressure_viscosity = "600 1/GPa"

[fit]
free = ["boundary_friction", "pressure_viscosity"]

[fit.bounds]
pressure_coefficient = ["10 1/GPa", "1000 1/GPa"]

[fit.curves.second]
viscosity = "20 mPa*s"

[fit.curves.second.fluid]
model = "eyring"
stress = "1 kPa"
"""


def test_a_case_file_names_numbers_of_its_fluid_and_gets_them_back(tmp_path):
    path = tmp_path / "case.toml"
    path.write_text(CASE)
    case = sb.load_case(path)
    assert case.fit.free == ("boundary_friction", "pressure_coefficient")
    assert case.fit.bounds == {"pressure_coefficient": pytest.approx((1e-8, 1e-6))}
    second = case.fit.curves["second"]
    assert (second["viscosity"], second["fluid"].rheology.eyring_stress) == pytest.approx((0.02, 1000.0))
    true = case.contact.replace(pressure_coefficient="500 1/GPa")
    found = sb.fit(measured(SPEEDS, friction_of(true), error=1e-4), case, intervals=False)
    write_fitted_case(found, case, tmp_path / "fitted.toml")
    text = (tmp_path / "fitted.toml").read_text()
    assert '# before the fit: pressure_viscosity = "600 1/GPa"' in text
    assert sb.load_case(tmp_path / "fitted.toml").contact.pressure_coefficient == pytest.approx(5e-7, rel=3e-3)


def test_what_is_wrong_with_numbers_of_the_fluid_is_said(subtests, tmp_path):
    for before, after, said in [
        ('["10 1/GPa", "1000 1/GPa"]', '["0 1/GPa", "1 1/GPa"]', "pressure_coefficient = '0 1/GPa' must be positive"),
        ('model = "eyring"', 'model = "eyrin"', r"second: \[fluid\] model = 'eyrin' must be one of"),
        ('viscosity = "20 mPa*s"', 'speedy = "20 mm/s"', "second: speedy = '20 mm/s' is not a known key"),
        ('"pressure_viscosity"]', '"relaxation_tim"]', "did you mean relaxation_time"),
    ]:
        with subtests.test(before=before, after=after, said=said):
            path = tmp_path / "case.toml"
            path.write_text(CASE.replace(before, after))
            with pytest.raises(sb.InputError, match=said):
                sb.load_case(path)


@pytest.mark.slow
@pytest.mark.parametrize("seed", [700, 715])
def test_intervals_of_what_the_data_do_not_determine_stay_with_the_fit(seed):
    """One ended in an error, as its guesses left what the law holds for; one was moved by the way to another minimum."""
    true, speeds = TRUE.replace(fluid=sb.fluids.Barus("500 1/GPa"), cavitation="exit"), np.geomspace(1e-3, 0.5, 12)
    noise = np.exp(0.04 * np.random.default_rng(seed).standard_normal(len(speeds)))
    data = measured(speeds, friction_of(true, speeds) * noise)
    found = sb.fit(data, true, free=["boundary_friction", "pressure_coefficient"])
    low, high = found["boundary_friction"].interval_95
    assert 0.85 < low / true.boundary_friction < 1 < high / true.boundary_friction < 1.15
    low, high = found["pressure_coefficient"].interval_95
    assert low == 0 and 5e-7 < high < 1e-5


@pytest.mark.slow
def test_intervals_of_a_relaxation_time_cover_in_6_experiments():
    true, speeds = TRUE.replace(fluid=sb.fluids.Carreau("1 ms", 0.5)), np.geomspace(1e-3, 0.5, 12)
    exact, held = friction_of(true, speeds), 0
    for seed in range(6):  # 30 covered in 28, and in 29 for the other
        noise = np.exp(0.04 * np.random.default_rng(700 + seed).standard_normal(len(speeds)))
        found = sb.fit(measured(speeds, exact * noise), true, free=["boundary_friction", "relaxation_time"])
        for name in ("boundary_friction", "relaxation_time"):
            low, high = found[name].interval_95
            held += low < getattr(true, name) < high
    assert held >= 8  # chance leaves less in one of ten thousand runs
