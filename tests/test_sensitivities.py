"""How friction answers to inputs: derivatives at solved states and off the atlas, against differences of solved friction."""

import math
from functools import cache

import numpy as np
import pytest
from ball_data import BALL
from command_line import EXAMPLES
from fit_data import TRUE, measured

import stribeck as sb
from stribeck.curves import sensitivities
from stribeck.curves.sensitivities import atlas_sensitivities, friction_sensitivities, sensitivities_if_known
from stribeck.regimes.advice import cheapest_levers

STEP = 1e-3


@cache
def solved(contact, rtol):
    return sb.solve(contact, rtol=rtol)


def differences(contact, name, definition="balanced", step=STEP, rtol=1e-7):
    """Return the sensitivity of friction to an input by states that are solved on both sides of it."""
    moved = [contact.replace(**{name: getattr(contact, name) * math.exp(sign * step)}) for sign in (1, -1)]
    ends = [abs(solved(each, rtol).friction(definition=definition).total) for each in moved]
    return math.log(ends[0] / ends[1]) / (2 * step)


# --- cylinders ---


def test_elasticities_agree_with_differences_of_cold_solves():
    contact, step = TRUE.replace(speed=0.03), 1e-2
    solution, found = friction_sensitivities(contact, rtol=1e-9)
    assert solution.friction() == solved(contact, 1e-9).friction()
    for name in ("speed", "roughness", "beta"):  # other tests hold load and dry friction
        f = [
            math.log(solved(contact.replace(**{name: getattr(contact, name) * math.exp(k * step)}), 1e-9).friction())
            for k in (-2, -1, 1, 2)
        ]
        assert found[name] == pytest.approx((f[0] - 8 * f[1] + 8 * f[2] - f[3]) / (12 * step), abs=1e-6)


def test_elasticities_obey_the_dimensions_and_vanish_where_an_input_does_not_count():
    # Speed and viscosity enter as their product; friction knows no unit of force and none of length.
    _, found = friction_sensitivities(TRUE)
    assert found["speed"] == found["viscosity"] and found["alpha"] == -found["roughness"]
    assert found["load"] + found["modulus"] + found["viscosity"] == pytest.approx(0, abs=1e-12)
    solution, found = friction_sensitivities(TRUE.replace(speed=0))
    assert found.pop("boundary_friction") == pytest.approx(1, abs=1e-6)
    assert set(found.values()) == {0.0} and solution.groups.speed == 0
    _, found = friction_sensitivities(TRUE.replace(roughness=0))
    assert found["roughness"] == found["alpha"] == found["boundary_friction"] == 0 and found["speed"] > 0.4
    assert abs(found["beta"]) < 1e-9  # both parts cancel but for the rounding of a solve with the Jacobian
    _, found = friction_sensitivities(TRUE.replace(speed=0, boundary_friction=0))
    assert all(math.isnan(value) for value in found.values())
    for arguments in ({"rtol": 1e-20}, {"definition": "mine"}):
        with pytest.raises(sb.InputError):
            friction_sensitivities(TRUE, **arguments)


SEPARATIONS = np.linspace(0.05, 6.0, 40)
TABLE = sb.contact_laws.TableLaw(SEPARATIONS, np.exp(-SEPARATIONS) + 0.3 * np.exp(-3 * SEPARATIONS))


def test_sensitivities_are_differences_of_solved_friction(subtests):
    moving = {"speed": "10 mm/s"}
    loose, tight = ({"rtol": 1e-7}, {}, 2e-4), ({"rtol": 1e-9}, {"step": 1e-4, "rtol": 1e-9}, 2e-5)
    for parts, names, (asked, of_differences, error) in [
        (moving | {"flow_factors": "effective-medium"}, ("roughness", "alpha"), loose),
        (moving | {"slide_to_roll": -1.0}, ("boundary_friction", "load"), loose),
        (moving | {"solid": sb.solids.Layer("1 mm")}, ("layer_thickness", "modulus"), loose),
        (moving | {"fluid": sb.fluids.Carreau("1 ms", 0.5)}, ("viscosity", "load"), loose),
        ({"law": sb.contact_laws.GreenwoodTripp(), "alpha": 1.0}, ("load", "roughness"), tight),
        ({"law": TABLE}, ("load", "roughness"), tight),
    ]:
        with subtests.test(names=names):
            contact = TRUE.replace(**parts)
            _, found = friction_sensitivities(contact, **asked)
            for name in names:
                assert found[name] == pytest.approx(differences(contact, name, **of_differences), abs=error), name


@pytest.mark.parametrize(
    ("example", "fluid", "rtol"),
    [
        ("pdms_cylinder", sb.fluids.Carreau("10 ms", 1.0), 1e-7),
        pytest.param("pdms_ball", sb.fluids.Carreau("10 ms", 1.0), 1e-4, marks=pytest.mark.slow),  # four balls
    ],
)
def test_at_the_end_of_what_an_input_may_be_its_sensitivity_is_that_to_the_other_side(example, fluid, rtol):
    """There was none: one of the two models beside it is refused."""
    contact = sb.load_case(EXAMPLES / f"{example}.toml").contact.replace(fluid=fluid)
    if example == "pdms_cylinder":
        contact = contact.replace(speed="30 mm/s")
    _, found, why = sensitivities_if_known(contact, rtol=rtol)
    step, ends = -5e-3, []
    for k in range(3):
        ends.append(math.log(sb.solve(contact.replace(exponent=fluid.exponent * math.exp(k * step)), rtol=rtol).friction()))
    assert not why
    assert found["exponent"] == pytest.approx(
        (-3 * ends[0] + 4 * ends[1] - ends[2]) / (2 * step), rel=2e-2 if fluid.exponent == 1 else 2e-3, abs=1e-4
    )


def contact_in_hertz_units(groups, barus=0.0, cavity=0.0, **parts):
    """Return a contact without dry friction whose fluid and cavity have these numbers over its Hertz pressure."""
    scales = {"radius": 1.0, "modulus": 1e6, "viscosity": 1.0, "alpha": 2.0, "beta": 0.1, "boundary_friction": 0.0}
    contact = sb.LineContact.from_groups(groups, **scales)
    if barus:
        parts["fluid"] = sb.fluids.Barus(barus / contact.hertz.pressure)
    if cavity:
        parts |= {"cavitation": "reform", "cavity_pressure": cavity * contact.hertz.pressure}
    return contact.replace(**parts)


@pytest.mark.slow
def test_sensitivities_of_both_frictions_are_differences_of_solved_states(subtests):
    """Without the moment of the pressure beyond the panels in x, those of the printed one were off by up to 8e-4."""
    for parts in [{"cavity": -0.02}, {"cavitation": "exit", "barus": 2.0}]:
        with subtests.test(parts=parts):
            contact = contact_in_hertz_units(sb.Groups(1e-2, 0.1, 1e-3), **parts)
            of_part = "speed" if "cavity" in parts else "pressure_coefficient"
            for definition, names in (("published", ("load",)), ("balanced", ("load", of_part))):
                _, found = friction_sensitivities(contact, rtol=1e-8, definition=definition)
                for name in names:
                    expected = differences(contact, name, definition, rtol=1e-9)
                    assert found[name] == pytest.approx(expected, abs=1e-5), (definition, name)


@pytest.mark.slow
def test_the_printed_friction_of_a_thin_film_has_the_slopes_of_solved_states():
    # Asperities carry all; the closed form of the printed friction was wrong by 3e-4 here.
    contact = contact_in_hertz_units(sb.Groups(5.39e-11, 9.87, 0.0369))
    _, found = friction_sensitivities(contact, rtol=1e-7, definition="published")
    assert found["load"] == pytest.approx(differences(contact, "load", "published", step=1e-2), abs=5e-5)


def test_a_film_whose_suction_opens_no_cavity_has_the_sensitivities_of_the_full_film():
    contact = TRUE.replace(speed="10 mm/s")
    full = friction_sensitivities(contact)[1]
    found = friction_sensitivities(contact.replace(cavitation="reform", cavity_pressure="-10 bar"))[1]
    assert {name: found[name] for name in full} == pytest.approx(full, rel=1e-5, abs=1e-7)


@pytest.mark.quick
def test_a_part_without_derivatives_leaves_the_sensitivities_out_and_says_so(monkeypatch):
    def refuse(contact, **asked):
        raise sb.InputError("this solid has no derivatives.")

    assert sensitivities_if_known(TRUE, rtol=1e-3)[2] == ""
    monkeypatch.setattr(sensitivities, "friction_sensitivities", refuse)
    solution, slopes, reason = sensitivities_if_known(TRUE, rtol=1e-3)
    assert solution.outcome.ok and slopes == {} and reason == "this solid has no derivatives."


def test_the_next_run_of_a_fit_of_the_fluid_is_found():
    contact = TRUE.replace(fluid=sb.fluids.Barus("500 1/GPa"), cavitation="exit")
    speeds = np.geomspace(1e-3, 0.3, 5)
    friction = np.asarray(sb.stribeck_curve(contact, speed=speeds, rtol=1e-4).friction)
    fit = sb.fit(measured(speeds, friction, error=0.01 * friction), contact, free=["pressure_coefficient"], intervals=False)
    plan = sb.next_runs(fit, 1, speeds=[1e-3, 0.3], loads=[contact.load])
    assert plan.runs[0].speed == pytest.approx(0.3)
    assert plan.runs[0].errors["pressure_coefficient"] < plan.before["pressure_coefficient"]


# --- balls ---


SURFACE = sb.surfaces.persson_law(sb.surfaces.SelfAffine(h_rms=1e-6, q0=3e4, q1=3e6, hurst=0.8))


def ball_of(groups, **parts):
    given = {"radius": 0.01, "modulus": 1e6, "viscosity": 0.1, "alpha": 2.0, "beta": 0.1, "boundary_friction": 0.8}
    return sb.PointContact.from_groups(groups, **given, slide_to_roll=0.6).replace(**parts)


MODELS = {
    "barus": {"fluid": sb.fluids.Barus("2e-7 1/Pa")},
    "flow": {"flow_factors": sb.fluids.PatirCheng()},
    "layer": {"solid": sb.solids.Layer("1 mm", 0.45)},
    "carreau": {"fluid": sb.fluids.Carreau("1 ms", 0.5), "wetted_radius": "2 mm"},
}


def ball_with(name):
    return ball_of(sb.Groups(1e-2, 1e-2, 5e-4, geometry="point"), **MODELS[name])


BALLS = {
    "mixed": (ball_of(sb.Groups(1e-3, 1e-2, 2e-4, geometry="point")), ("load", "roughness")),
    "persson": (ball_of(sb.Groups(1e-3, 10.0, 5e-2, geometry="point", law=SURFACE)), ("load",)),
    "smooth": (ball_of(sb.Groups(1e-1, 1e-2, 0.0, geometry="point")), ("speed",)),
    "barus": (ball_with("barus"), ("pressure_coefficient",)),
    "flow": (ball_with("flow"), ("roughness",)),
}


@pytest.mark.parametrize(
    "name", ["mixed", "barus", *(pytest.param(each, marks=pytest.mark.slow) for each in ("persson", "smooth", "flow"))]
)
def test_sensitivities_of_balls_are_the_differences_of_states_beside(name):
    contact, keys = BALLS[name]
    _, found = friction_sensitivities(contact, rtol=1e-4)
    for key in keys:
        allowed = 3e-4 if name in MODELS else 1e-3
        assert found[key] == pytest.approx(differences(contact, key, step=0.01, rtol=1e-5), abs=allowed), key


@pytest.mark.slow
def test_the_sensitivity_of_a_ball_whose_film_ends_is_the_difference_of_states_beside():
    contact = ball_of(sb.Groups(0.1, 1e-3, 1e-3, geometry="point"), cavitation="exit")
    _, found = friction_sensitivities(contact, rtol=1e-4)
    assert found["speed"] == pytest.approx(differences(contact, "speed", step=0.05, rtol=1e-4), abs=4e-3)


def test_at_fixed_groups_beta_moves_the_viscous_friction_by_its_closed_form():
    groups, step = sb.Groups(1e-2, 1e-2, 5e-4, geometry="point"), 0.01
    given = {"radius": 0.01, "modulus": 1e6, "viscosity": 0.1, "alpha": 2.0, "boundary_friction": 0.8, "slide_to_roll": 0.6}
    here, more, less = (sb.PointContact.from_groups(groups, beta=0.1 * math.exp(sign * step), **given) for sign in (0, 1, -1))
    _, found = friction_sensitivities(here, rtol=1e-3)
    along = found["beta"] + 3 * found["load"] + 4 * found["speed"] + 2 * found["roughness"]  # as from_groups moves them
    ends = [sb.solve(each, rtol=1e-3).friction().total for each in (more, less)]
    slope = math.log(ends[0] / ends[1]) / (2 * step)
    assert slope > 1e-3 and along == pytest.approx(slope, rel=1e-2)


@pytest.mark.slow
@pytest.mark.parametrize("model", MODELS)
def test_sensitivities_of_balls_with_other_fluids_and_solids_are_those_of_solved_states(model):
    contact = ball_with(model)
    _, found = friction_sensitivities(contact, rtol=1e-6)
    assert {name for name, _ in contact.inputs()} <= set(found)
    of_edge = ["wetted_radius"] if contact.wetted_radius is not None else []
    for name in ("speed", "load", "modulus", "radius", "viscosity", "roughness", "alpha", "beta", "slide_to_roll", *of_edge):
        assert found[name] == pytest.approx(differences(contact, name, step=0.01, rtol=1e-6), abs=5e-4), name


def test_asperities_of_a_ball_that_hardly_slides_stick_as_on_a_curve():
    ball = BALL.replace(slide_to_roll=0.004)
    solution, found = friction_sensitivities(ball, rtol=1e-3)
    part = 0.5 * 0.4 * (3 - 0.4**2)
    sticking = part * ball.boundary_friction * solution.contact_load_share
    assert solution.friction().asperities == pytest.approx(sticking, rel=1e-12)
    ends = [sb.solve(ball.replace(slide_to_roll=0.004 * math.exp(step)), rtol=1e-3).friction().total for step in (1e-3, -1e-3)]
    assert found["slide_to_roll"] == pytest.approx(math.log(ends[0] / ends[1]) / 2e-3, rel=1e-4)


# --- the atlas ---


def test_sensitivities_read_off_the_atlas_are_the_solved_ones():
    contact = sb.load_case(EXAMPLES / "pdms_cylinder.toml").contact
    assert atlas_sensitivities(contact) == pytest.approx(friction_sensitivities(contact)[1], abs=2e-4)
    ball = BALL.replace(wetted_radius="3 mm")
    assert atlas_sensitivities(ball) == pytest.approx(friction_sensitivities(ball, rtol=1e-5)[1], abs=5e-3)


def test_a_lever_of_a_surface_takes_beta_along():
    """With beta kept in the step and not in the solve, roughness was to fall by a fifth, and friction fell by 31 %."""
    seal = sb.load_case(EXAMPLES / "rod_seal.toml").contact
    state, slopes = friction_sensitivities(seal)
    levers = {each.name: each for each in cheapest_levers(seal, state.friction().total, slopes, "balanced", 1e-6)}
    roughness = levers["roughness"]
    changes = {"roughness": roughness.value, "beta": roughness.factor * seal.beta}
    assert sb.solve(seal.replace(**changes)).friction().total == pytest.approx(0.8 * state.friction().total, rel=0.02)
