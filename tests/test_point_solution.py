"""What a solve of a ball gives: observables, friction with its cut-off, fields, files."""

import json
import math

import numpy as np
import pytest
from scipy.integrate import trapezoid

import stribeck as sb
from stribeck import Groups, Outcome
from stribeck.contacts.cut_off import log_cut_offs
from stribeck.equations.point.observables import OBSERVABLES
from stribeck.solver.point.solution import finish_point, solution_of
from stribeck.solver.point.state import PointFields, PointObservables, PointState

SPEED, H0 = 0.02, 0.01
"""Speed group and central gap of a rigid ball, whose pressures and friction integrals are known in closed form."""


class Rings:
    radii = np.array([0.5, 1.0, 2.0])
    angles = np.array([0.5, 1.5, 2.5])
    size = 9


def rigid_fields(x, y):
    gap = H0 + 0.5 * (x * x + y * y)
    return PointFields(gap, 0.1 * np.exp(-gap), -SPEED / 5 * x / gap**2)


def rigid(groups, outcome=Outcome.CONVERGED, **changed):
    """Return a state of a rigid ball with an invented contact pressure that is even in x."""
    couette = 2 / 3 * math.pi * SPEED * 0.5 * -math.log(2 * H0)
    poiseuille = 0.2 * math.pi * SPEED * (-math.log(2 * H0) - 2)
    values = {
        "contact_load_share": 0.25,
        "fluid_load_share": 0.75,
        "central_gap": H0,
        "minimum_gap": H0,
        "minimum_radius": 0.0,
        "minimum_angle": 0.0,
        "minimum_gap_on_axis": H0,
        "central_pressure": 0.1,
        "offset": H0,
        "J_couette": couette,
        "J_poiseuille": poiseuille,
        "J_balanced": couette + poiseuille,
        "J_published": couette + poiseuille + 0.4 * math.pi * SPEED,
        "J_pcx": 0.0,
    } | changed
    errors = dict.fromkeys(OBSERVABLES, 1e-8)
    x, y = Rings.radii * np.cos(Rings.angles)[:, None], Rings.radii * np.sin(Rings.angles)[:, None]
    nodal = rigid_fields(x, y)
    one = dict.fromkeys(OBSERVABLES, 1.0)
    return PointState(groups, 1e-6, outcome, values, errors, one, 0.0, 0.0, Rings(), *nodal, rigid_fields, 3, 9)


def ball(**changes):
    kept = {"radius": 0.01, "modulus": 1e6, "viscosity": 0.1, "alpha": 2.0, "beta": 0.05, "boundary_friction": 0.8}
    groups = Groups(SPEED, 1.5, 1e-3, geometry="point")
    return sb.PointContact.from_groups(groups, **(kept | changes))


def solved(**changes):
    contact = ball(**changes)
    return solution_of(rigid(contact.groups), contact)


@pytest.mark.quick
def test_a_solution_of_a_ball_has_its_observables_under_the_names_of_the_line():
    s = solved()
    shared = ("contact_load_share", "fluid_load_share", "central_gap", "minimum_gap", "offset")
    assert [getattr(s, name) for name in shared] == [0.25, 0.75, H0, H0, H0]
    assert s.lambda_ratio == pytest.approx(H0 / (2.0 * float(s.groups.relative_roughness)))
    assert s.central_separation == pytest.approx(2 * s.lambda_ratio)
    assert (s.errors["central_gap"], s.error_estimate, s.minimum_gap_error) == (1e-8, 1e-8, 1e-8)
    assert set(OBSERVABLES) <= set(dir(s))
    with pytest.raises(AttributeError, match="no attribute 'flux_gap'"):
        _ = s.flux_gap


@pytest.mark.quick
def test_a_whole_ball_at_a_small_gap_has_the_friction_of_stokes_flow():
    # 6 pi eta R U (8/15 ln(R/h) + 0.954293) over the load: Goldman, Cox and Brenner, Chaoui and Feuillebois.
    s = solved()
    c = s.contact
    drag = 8 / 15 * math.log(c.radius / (H0 * c.hertz.indentation)) + 0.954293
    wanted = 6 * math.pi * c.viscosity * c.radius * c.speed * drag / c.load
    assert s.friction(0.0).total == pytest.approx(wanted, rel=1e-5)  # up to the gap over the radius
    assert s.friction(0.0, definition="published").total == pytest.approx(wanted, rel=1e-5)


@pytest.mark.quick
def test_a_ball_that_rolls_has_the_force_of_its_two_motions(subtests):
    for ratio in [0.0, 0.5, 1.3]:
        with subtests.test(ratio=ratio):
            s = solved(slide_to_roll=ratio)
            c = s.contact
            log = math.log(c.radius / (H0 * c.hertz.indentation))
            first, second = 0.5 * c.speed + 0.5 * c.sliding_speed, 0.5 * c.speed - 0.5 * c.sliding_speed
            drag = first * (8 / 15 * log + 0.954293) - second * (2 / 15 * log - 0.257268)
            assert s.friction(0.0).total == pytest.approx(6 * math.pi * c.viscosity * c.radius * drag / c.load, rel=1e-5)


@pytest.mark.quick
def test_asperities_do_not_rub_in_pure_rolling():
    assert solved(slide_to_roll=0.0).friction().asperities == 0
    assert solved(slide_to_roll=0.01).friction().asperities == pytest.approx(0.8 * 0.25)


@pytest.mark.quick
def test_a_disc_of_liquid_has_the_friction_integrated_up_to_its_edge():
    s = solved(wetted_radius="5 mm")
    edge = 5e-3 / s.contact.hertz.half_width
    r = np.geomspace(1e-6, edge, 200_001)
    gap = H0 + 0.5 * r * r
    mean = SPEED / 6 / gap + 0.5 * gap * (-SPEED / 5) * (1 / gap**2 - r * r / gap**3)  # over the angle
    wanted = 2 * math.pi * trapezoid(mean * r, r)
    assert s.friction_integral == pytest.approx(wanted, rel=2e-3)
    assert s.friction_integral < solved().friction_integral


@pytest.mark.quick
def test_one_surface_at_rest_has_one_cut_off():
    couette, poiseuille = log_cut_offs(0.1)
    assert math.exp((couette / 1.5 + poiseuille / 2.5) / (16 / 15)) == pytest.approx(50.340, rel=1e-4)
    assert log_cut_offs(0.1, 7.0) == (math.log(7), math.log(7))


@pytest.mark.quick
def test_beta_enters_the_friction_of_a_ball_by_its_slope_and_the_logarithm():
    s = solved()
    one, other = (s.friction(0.0, beta).total / beta for beta in (0.05, 0.1))
    speed, load = SPEED, float(s.groups.load)
    assert one - other == pytest.approx(0.75 * load ** (1 / 3) * 16 / 15 * math.pi * speed * math.log(2), rel=1e-4)


@pytest.mark.quick
def test_the_error_of_friction_covers_its_parts():
    f = solved().friction(boundary_friction=0.5)
    assert f.error == pytest.approx(0.5e-8 + 1.5 / math.pi * float(solved().contact.slope) * 1e-8)
    assert f.total == f.asperities + f.fluid


@pytest.mark.quick
def test_fields_are_given_anywhere_and_in_si():
    s = solved()
    x, y = np.linspace(-2, 2, 7), np.linspace(-1, 1, 5)[:, None]
    found = s.field(x, y)
    np.testing.assert_allclose(found.gap, H0 + 0.5 * (x**2 + y**2))
    np.testing.assert_allclose(found.pressure, found.contact_pressure + found.fluid_pressure)
    np.testing.assert_array_equal(s.profile(x).gap, s.field(x, 0.0).gap)
    h = s.contact.hertz
    si = s.to_si(x * h.half_width, y * h.half_width)
    np.testing.assert_allclose(si.gap, found.gap * h.indentation)
    np.testing.assert_allclose(s.to_si(x * h.half_width).fluid_pressure, s.profile(x).fluid_pressure * h.pressure)
    assert (np.diff(s.x) > 0).all()
    assert len(s.gap) == len(s.separation) == len(s.pressure) == len(s.to_si().x) == 6


@pytest.mark.quick
def test_what_cannot_be_asked_of_a_solution_is_refused_with_a_sentence(subtests):
    for call, sentence in [
        (lambda s: s.field(np.nan, 0.0), "x = nan; positions must be finite"),
        (lambda s: s.field(np.zeros(2), np.zeros(3)), "do not broadcast"),
        (lambda s: s.profile(np.zeros((2, 2))), "one dimension"),
        (lambda s: s.friction(definition="ball"), "definition = 'ball'"),
        (lambda s: s.to_dataset(points=1), "points = 1; it must be a whole number from 2"),
        (lambda s: s.to_dataset(reach=-1.0), "reach = -1.0; it must be a positive number"),
        (lambda s: solution_of(s.state, None).to_si(), "solve a PointContact instead of Groups"),
    ]:
        with subtests.test(call=call, sentence=sentence):
            with pytest.raises(sb.InputError, match=sentence):
                call(solved())


@pytest.mark.quick
def test_a_solution_of_a_ball_is_ready_for_json():
    found = json.loads(json.dumps(solved().to_dict()))
    assert found["geometry"] == "point"
    assert found["minimum_radius"] == 0.0
    assert found["friction_asperities"] == pytest.approx(0.2)


def test_a_dataset_of_a_ball_has_its_fields_in_si(tmp_path):
    xarray = pytest.importorskip("xarray")
    s = solved()
    s.to_netcdf(tmp_path / "ball.nc", points=11)
    with xarray.open_dataset(tmp_path / "ball.nc") as found:
        h = s.contact.hertz
        assert found["gap"].attrs["units"] == "m"
        assert float(found["gap"].sel(x=0, y=0)) == pytest.approx(H0 * h.indentation)
        assert float(found["x"].max()) == pytest.approx(2 * h.half_width)
        assert found.attrs["geometry"] == "point"
        assert found.attrs["input_load"] == s.contact.load
        assert "input_wetted_radius" not in found.attrs


@pytest.mark.quick
def test_notes_of_a_ball_say_where_the_model_ends():
    wide = solved(beta=0.3).notes
    assert any("the Hertz radius is 0.54 of the radius" in note for note in wide)
    assert any("load group is 1.5, not below 1" in note for note in wide)
    assert any("The liquid ends at" in note for note in solved(wetted_radius="2 mm").notes)
    sucking = solved(modulus=1e9, beta=0.05).notes
    assert any("the film cavitates there" in note and "7 to 15 %" in note for note in sucking)


@pytest.mark.quick
def test_a_state_that_failed_is_raised_with_its_sentence_or_returned():
    groups = Groups(SPEED, 1e-3, 1e-5, geometry="point")
    failed = rigid(groups, Outcome.REFINEMENT_LIMIT)
    with pytest.raises(sb.SolveError, match="of a ball: .*Achieved: 1.0e-08") as caught:
        finish_point(failed, None)
    assert caught.value.solution.outcome is Outcome.REFINEMENT_LIMIT
    assert finish_point(failed, None, "return").outcome is Outcome.REFINEMENT_LIMIT
    with pytest.raises(sb.SolveError, match="of a ball"):
        finish_point(rigid(groups, Outcome.PATH_LOST, central_gap=math.nan), None, "return")


def test_a_picture_says_across_it_that_a_state_is_no_result(subtests):
    for outcome in [Outcome.CONVERGED, Outcome.REFINEMENT_LIMIT]:
        with subtests.test(outcome=outcome):
            pyplot = pytest.importorskip("matplotlib.pyplot")
            state = finish_point(rigid(Groups(SPEED, 1e-3, 1e-5, geometry="point"), outcome), None, "return")
            _, own = pyplot.subplots()
            for figure in (state.plot(), state.plot(ax=own)):
                written = [text.get_text() for axes in figure.axes for text in axes.texts]
                assert ("not converged" in written) == (not outcome.ok)
                pyplot.close(figure)


@pytest.mark.quick
def test_a_ball_at_rest_has_the_friction_of_its_asperities():
    groups = Groups(0.0, 1e-3, 1e-5, geometry="point")
    values = PointObservables.of(rigid(groups), None)
    assert values.viscous_friction(0.05) == values.viscous_friction(0.05, "published") == 0


def test_solve_takes_a_ball_in_si_and_keeps_its_tolerance(tmp_path):
    contact = ball(beta=0.1)
    s = sb.solve(contact, rtol=1e-4)
    assert isinstance(s, sb.results.PointSolution)
    assert s.outcome.ok
    assert s.error_estimate <= 1e-4
    assert s.identity_error < 1e-6
    assert s.contact_load_share + s.fluid_load_share == pytest.approx(1, abs=1e-7)
    assert s.friction().total > s.friction(0.0).total
    pytest.importorskip("matplotlib")
    for colours in ("film", "interference"):
        assert s.plot(tmp_path / f"{colours}.png", colours=colours) is not None
    with pytest.raises(sb.InputError, match="colours = 'rainbow'; it must be 'film' or 'interference'"):
        s.plot(colours="rainbow")
    with pytest.raises(sb.InputError, match="needs a film thickness in metres"):
        solution_of(s.state, None).plot(colours="interference")


@pytest.mark.quick
def test_a_ball_refuses_models_that_it_is_not_solved_for():
    with pytest.raises(sb.InputError, match="isotropic roughness, gamma = 1"):
        sb.solve(sb.Groups(1e-2, 1e-3, 1e-4, geometry="point"), flow_factors=sb.fluids.PatirCheng(2.0, gamma=3.0))
    with pytest.raises(sb.InputError, match="fluid = 'oil'; give a law of sb.fluids"):
        sb.solve(ball(), fluid="oil")


@pytest.mark.quick
def test_interference_is_black_without_a_film_and_fades_far_apart():
    from stribeck.plot.ball import interference

    np.testing.assert_array_equal(interference(0.0), [0, 0, 0])
    np.testing.assert_allclose(interference(1e-4), 0.5, atol=1e-6)
    assert interference(540e-9 / (4 * 1.4))[1] > 0.9  # a quarter of the wave in the fluid: green is bright


@pytest.mark.quick
def test_the_angle_of_a_minimum_near_the_centre_is_as_unsure_as_its_place():
    rest, slow, fast = (sb.solve(sb.Groups(speed, 1e-3, 1e-3, geometry="point"), rtol=1e-4) for speed in (0.0, 1e-6, 1e-3))
    for solution in (rest, slow):
        assert solution.minimum_radius < solution.minimum_radius_error
        assert solution.minimum_angle_error == pytest.approx(math.pi)
    across = fast.minimum_radius * fast.minimum_angle_error
    assert fast.minimum_radius_error <= across * (1 + 1e-9)
    assert across <= 1.01 * fast.minimum_radius_error
