"""The atlas of balls: what is read off it against solved states, in curves, diagrams, fits, uncertainties and on the page."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import stribeck as sb
from evidence.atlas_build import ROWS
from evidence.atlas_certificate import compare, quantities, random_states, solved
from evidence.atlas_states import groups_of

BALL, PERSSON, EXIT = (ROWS[name] for name in ("ball-exponential", "ball-persson", "ball-exit"))


def ball(speed=2e-2, load=0.05, kappa=2e-2, beta=0.05, **changes):
    """Return a contact with given groups: of a rubber on glass in water-like liquid."""
    radius, modulus, viscosity, alpha = 5e-3, 2e6, 0.02, 2.0
    name = "entrainment_speed" if "slide_to_roll" in changes else "speed"
    force = load * math.pi**3 * beta**3 * radius**2 * modulus / 6
    a = (0.75 * force * radius / modulus) ** (1 / 3)
    return sb.PointContact(
        radius=radius,
        modulus=modulus,
        load=force,
        viscosity=viscosity,
        roughness=kappa * alpha * a**2 / radius,
        alpha=alpha,
        beta=beta,
        boundary_friction=0.7,
        **{name: speed * modulus * a**4 / (3 * math.pi * viscosity * radius**3) / (2 if changes.get("slide_to_roll") else 1)},
        **changes,
    )


PERSSON_LIKE = groups_of(PERSSON, 1e-3, 1.0, 1e-2)
"""A state under the law of Persson's table."""


def of_ball(speed, load, kappa):
    return sb.Groups(speed, load, kappa * np.asarray(load) ** (2 / 3), geometry="point")


# --- where it holds ---


@pytest.mark.quick
def test_other_models_of_balls_are_refused_and_so_are_thin_smooth_films():
    groups = of_ball(1e-3, 0.1, 0.01)
    assert sb.atlas.for_groups(groups).name == "ball-exponential"
    assert sb.atlas.covers(groups)
    reforming = replace(groups, model=ball(cavitation="reform", cavity_pressure="-1 kPa").groups.model)
    assert not sb.atlas.covers(reforming)
    with pytest.raises(sb.InputError, match="Newtonian fluid"):
        sb.atlas.friction(reforming)
    low, high = BALL.grid.films
    smooth = replace(groups, roughness=0.0)
    assert sb.atlas.covers(replace(smooth, speed=np.array([0.0, 0.9 * low, 1.1 * low]))).tolist() == [True, False, True]
    assert BALL.speeds(smooth) == (low, min(high, BALL.box["speed"][1]))
    with pytest.raises(sb.InputError, match="speed of a smooth contact has the value"):
        sb.atlas.central_gap(replace(smooth, speed=0.9 * low))


@pytest.mark.quick
def test_what_balls_do_not_have_is_refused_by_name():
    ball, line = of_ball(1e-3, 0.1, 0.01), sb.Groups(1e-3, 0.1, 1e-3)
    for said, ask in (
        ("has no flux_gap", lambda: sb.atlas.flux_gap(ball)),
        ("wetted_radius = 50 belongs to a ball", lambda: sb.atlas.friction(line, wetted_radius=50)),
        ("must be above 1", lambda: sb.atlas.friction(ball, wetted_radius=0.5)),
        # A film that is far from the contact has 10 % more friction up to there, 38 % more up to 1.3.
        ("holds no fields to integrate", lambda: sb.atlas.friction(ball, wetted_radius=2.0)),
    ):
        with pytest.raises(sb.InputError, match=said):
            ask()


@pytest.mark.quick
def test_at_rest_asperities_carry_all_and_the_film_is_the_solved_one():
    groups = of_ball(0.0, 0.05, 0.03)
    state = sb.solve(groups, rtol=1e-6)
    assert sb.atlas.friction(groups, 0.7) == 0.7
    assert sb.atlas.central_gap(groups) == pytest.approx(state.central_gap, rel=1e-3)
    assert sb.atlas.offset(groups) == pytest.approx(state.offset, abs=1e-3)
    assert sb.atlas.offset(of_ball(0.0, 0.05, 0.0)) == -1.0


# --- against the solver ---


@pytest.mark.parametrize("row", [BALL, pytest.param(EXIT, marks=pytest.mark.slow)], ids=lambda row: row.name)
def test_it_is_within_its_stated_error_of_states_it_was_not_made_from(row):
    speed, load, kappa = random_states(row, 3, 20, mixed=True)
    observed = np.array([solved(row.name, state) for state in zip(speed, load, kappa, strict=True)])
    found = compare(speed, load, kappa, observed, row)
    assert found.errors.shape == (3, len(quantities(row)))
    assert found.friction.max() < row.error


@pytest.mark.slow
def test_nearly_smooth_balls_are_as_good():
    speed, load, kappa = np.array([[1e-5, 1e-3, 2e-4], [2e-6, 1e-2, 1e-4], [3e-7, 0.2, 6e-5]]).T
    observed = np.array([solved(BALL.name, state) for state in zip(speed, load, kappa, strict=True)])
    assert compare(speed, load, kappa, observed, BALL).friction.max() < BALL.error


@pytest.mark.quick
def test_regions_of_balls_meet_within_the_stated_error():
    rng = np.random.default_rng(5)
    ends = [np.log(BALL.box[name]) for name in ("speed", "load")]
    speed, load = (np.exp(rng.uniform(*each, 1000)) for each in ends)
    below, above = (sb.atlas.friction(of_ball(speed, load, 1e-3 * (1 + side * 1e-9)), beta=0.1) for side in (-1, 1))
    assert np.abs(below / above - 1).max() < 0.2 * BALL.error


def test_friction_of_a_contact_is_the_solved_one_whatever_its_liquid_and_motion(subtests):
    for changes in [{"wetted_radius": 2e-3}, {"slide_to_roll": 0.5}]:
        with subtests.test(changes=changes):
            contact = ball(**changes)
            state = sb.solve(contact, rtol=1e-5)
            motion = {"slide_to_roll": contact.slide_to_roll}
            if contact.wetted_radius is not None:
                motion["wetted_radius"] = contact.wetted_radius / contact.hertz.half_width
            for definition in ("balanced", "published"):
                right = state.friction(definition=definition)
                settings = {"boundary_friction": 0.7, "beta": contact.beta, "definition": definition}
                found = sb.atlas.friction(contact.groups, **settings, **motion)
                assert found == pytest.approx(right.total, rel=BALL.error)


def test_curves_read_off_it_are_the_solved_ones_also_of_films_that_break(subtests):
    for row, cavitation, places in ((BALL, "none", (1e-3, 1e-2, 0.1)), (EXIT, "exit", (5e-3, 6e-3, 7e-3))):
        with subtests.test(cavitation):
            contact, speeds = ball(wetted_radius=3e-3, cavitation=cavitation), [ball(s).speed for s in places]
            read, exact = (sb.stribeck_curve(contact, speed=speeds, rtol=1e-4, method=each) for each in ("atlas", "solver"))
            assert sb.atlas.for_groups(read.groups) is row and read.rtol == row.error
            assert (np.abs(read.friction - exact.friction) < read.friction.error + exact.friction.error).all()
            assert np.allclose(read.friction.fluid, exact.friction.fluid, rtol=3e-3)
            assert np.allclose(read.observable("central_gap"), exact.observable("central_gap"), rtol=3e-3)
            assert read.regimes == exact.regimes
    with pytest.raises(sb.InputError, match="flux_gap"):
        read.observable("flux_gap")


# --- films that break ---


@pytest.mark.quick
def test_slow_balls_whose_film_breaks_have_a_share_of_first_order_in_the_speed():
    groups = replace(of_ball(np.array([0.0, 1e-8, 1e-7]), 1e-3, 0.1), model=EXIT.model)
    rest, slow, faster = sb.atlas.fluid_load_share(groups)
    assert rest == 0
    assert slow == pytest.approx(1.664e-8, rel=3e-3)  # theory.md, section 11
    assert faster / slow == pytest.approx(10, rel=1e-3)
    at_rest = sb.solve(of_ball(0.0, 1e-3, 0.1), rtol=1e-5)
    assert sb.atlas.central_gap(groups)[0] == pytest.approx(at_rest.central_gap, rel=EXIT.error)


# --- under the law of Persson ---


@pytest.fixture(scope="module")
def rubber():
    """Return a shipped ball, as a film that never breaks: load group 2.2, and the spectrum of the table."""
    return sb.load_case(Path(__file__).parents[1] / "examples" / "rubber_ball.toml").contact.replace(
        cavitation="none", cavity_pressure=0.0
    )


@pytest.mark.slow
def test_a_real_ball_with_the_law_of_persson_is_read_off_its_table(rubber):
    ends = {"speed": (1e-3, 0.1), "points": 4, "rtol": 1e-4}
    read, exact = (sb.stribeck_curve(rubber, **ends, method=method) for method in ("atlas", "solver"))
    assert sb.atlas.for_groups(read.groups) is PERSSON
    assert read.rtol == PERSSON.error
    assert (np.abs(read.friction - exact.friction) < read.friction.error).all()
    assert np.allclose(read.observable("central_gap"), exact.observable("central_gap"), rtol=2e-3)
    assert read.transitions


@pytest.mark.parametrize(
    ("load", "speeds"),
    [(20.0, [1e-3]), *(pytest.param(load, [1e-5, 1e-3, 1e-2], marks=pytest.mark.slow) for load in (300.0, 5e3))],
)
def test_heavy_balls_are_as_good(load, speeds):
    groups = replace(PERSSON_LIKE, load=load, roughness=5e-3 * load ** (2 / 3))
    solved = [sb.solve(replace(groups, speed=speed), rtol=1e-4).friction(beta=0.02).total for speed in speeds]
    read = sb.atlas.friction(replace(groups, speed=np.array(speeds)), beta=0.02)
    assert read == pytest.approx(solved, rel=PERSSON.error)


@pytest.mark.quick
def test_at_rest_heavy_balls_have_their_friction_and_no_films():
    at_rest = replace(PERSSON_LIKE, speed=0.0, load=100.0, roughness=1e-2 * 100.0 ** (2 / 3))
    assert sb.atlas.covers(at_rest)
    assert sb.atlas.contact_load_share(at_rest) == 1.0
    assert sb.atlas.friction(at_rest, 0.7, 0.02) == 0.7
    with pytest.raises(sb.InputError, match="central_gap for loads up to 30"):
        sb.atlas.central_gap(at_rest)
    lighter = replace(at_rest, load=1.0, roughness=1e-2)
    assert sb.atlas.central_gap(lighter) == pytest.approx(sb.solve(lighter, rtol=1e-4).central_gap, rel=2e-3)


# --- what reads it ---


@pytest.mark.parametrize("cavitation", ["none", pytest.param("exit", marks=pytest.mark.slow)])
def test_fits_begin_on_it_where_it_holds(cavitation):
    ends = {} if cavitation == "exit" else {"wetted_radius": 3e-3}  # no table has the end of the liquid behind a rupture
    contact = ball(cavitation=cavitation, **ends)
    speeds = (contact.speed / 3, contact.speed * 3)
    curve = sb.stribeck_curve(contact, speed=speeds, points=5, method="atlas")
    ones = np.zeros(5, dtype=int), ("a",), ({},), np.arange(2, 7)
    data = sb.results.Measurements("speed", curve.values, np.asarray(curve.friction), None, *ones)
    found = sb.fit(data, contact.replace(boundary_friction=0.6), free=["boundary_friction"], intervals=False)
    assert found["boundary_friction"].value == pytest.approx(0.7, rel=5e-3)
    assert found.solver_shift < np.inf  # the solver has replaced the table at the end


@pytest.mark.quick
def test_the_error_of_a_curve_off_it_counts_what_the_end_of_the_liquid_leaves_out():
    """Of the table alone it was a sixteenth of that, and an eighth of how far the friction is off."""
    contact = ball(speed=1.0)
    drop = contact.replace(wetted_radius=5.0 * contact.hertz.half_width)
    speeds = [contact.speed, 2 * contact.speed]
    whole, read = (sb.stribeck_curve(each, speed=speeds, method="atlas") for each in (contact, drop))
    assert read.friction.error[0] > 0.03 * read.friction[0]
    assert np.allclose(whole.friction.error, BALL.error * np.abs(whole.friction))


def test_the_next_runs_of_a_ball_that_rolls_have_its_friction():
    """They had that of pure sliding."""
    contact = ball(slide_to_roll=0.2)
    speeds = contact.speed * np.array([0.3, 0.5, 1.0, 2.0])
    curve = sb.stribeck_curve(contact, speed=speeds, method="atlas")
    ones = np.zeros(4, dtype=int), ("a",), ({},), np.arange(2, 6)
    data = sb.results.Measurements("speed", speeds, np.asarray(curve.friction), None, *ones)
    found = sb.fit(data, contact.replace(boundary_friction=0.69), free=["boundary_friction"], intervals=False)
    [run] = sb.next_runs(found, 1, speeds=speeds[2:3], loads=[contact.load]).runs
    assert run.friction == pytest.approx(float(curve.friction[2]), rel=1e-2)


def test_uncertainties_are_sampled_on_it():
    contact = ball(wetted_radius=3e-3)
    found = sb.propagate(contact, {"load": 0.1, "boundary_friction": 0.02}, transitions=False)
    low, high = found["friction"].interval_95
    assert low < sb.solve(contact, rtol=1e-4).friction().total < high
