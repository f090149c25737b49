"""The atlas: its error on states it was not made from, its derivatives, its limits, and what it refuses."""

import math
import re

import numpy as np
import pytest
from command_line import EXAMPLES
from fit_data import TRUE

import stribeck as sb
from evidence import atlas_build
from evidence.atlas_certificate import FRICTION_COUNT, certify, compare, quantities, solved
from evidence.atlas_states import groups_of, speed_range
from stribeck.atlas import table as atlas_table
from stribeck.surfaces import SelfAffine, persson_law

TABLES = list(atlas_build.ROWS.values())
REFERENCE_SPECTRUM = {"h_rms": 1e-06, "q0": 10000.0, "q1": 1000000.0, "hurst": 0.8}
DEFINITIONS = ("published", "balanced")
FUNCTIONS = (
    sb.atlas.contact_load_share,
    sb.atlas.fluid_load_share,
    sb.atlas.central_gap,
    sb.atlas.minimum_gap,
    sb.atlas.flux_gap,
    sb.atlas.offset,
    sb.atlas.viscous_friction,
    sb.atlas.friction,
)
NAMES = ("contact_load_share", "fluid_load_share", "central_gap", "minimum_gap", "flux_gap", "offset")


def model_of(**parts):
    return TRUE.replace(**parts).groups.model


def random_groups(number, seed, margin=1e-3):
    """Return random states well inside the box: their numbers, and the groups."""
    rng = np.random.default_rng(seed)
    ends = [np.log(side) + [margin, -margin] for side in sb.atlas.BOX.values()]
    speed, load, kappa = (np.exp(rng.uniform(*side, number)) for side in ends)
    return speed, load, kappa, sb.Groups(speed, load, kappa * load)


def transition_groups(number, seed):
    """Return random states near the speeds at which fluid and asperities share the load."""
    rng = np.random.default_rng(seed)
    load, kappa = (np.exp(rng.uniform(*np.log(ends), number)) for ends in ((1e-5, 0.98), (2e-6, 50.0)))
    half = np.array([speed_range(TABLES[0], -math.log(F), k)[0] + math.log(60) for F, k in zip(load, kappa, strict=True)])
    speed = np.clip(np.exp(half + rng.uniform(-4, 3, number)), 2e-12, 5e5)
    return sb.Groups(speed, load, kappa * load)


# --- what it covers ---


@pytest.mark.quick
def test_other_models_are_refused_and_not_covered():
    cavitated = sb.Groups(1e-3, 0.1, 1e-3, model=model_of(cavitation="reform", cavity_pressure="-1 kPa"))
    assert not sb.atlas.covers(cavitated)
    with pytest.raises(sb.InputError, match="Newtonian fluid"):
        sb.atlas.friction(cavitated)


# --- against the solver ---


def test_friction_and_film_are_within_their_stated_error_of_states_it_was_not_made_from():
    found = certify(8, seed=60221)
    assert found.errors.shape == (8, len(quantities(TABLES[0])))
    for errors in (found.friction, found.film):
        assert np.median(errors) < 1e-5 and errors.max() < 1e-4
    assert found.errors[:, FRICTION_COUNT : FRICTION_COUNT + 2].max() < 1e-4  # viscous and balanced
    mixed = certify(4, seed=141421, mixed=True)  # where fluid and asperities share the load
    assert ((mixed.contact_share > 0.009) & (mixed.contact_share < 0.991)).all() and mixed.speed.size == 4
    assert np.median(mixed.errors) < 1e-6 and np.nanmax(mixed.errors) < 3e-5


def test_heavy_loads_on_nearly_smooth_surfaces_are_as_good():
    rng = np.random.default_rng(23606)
    load = np.array([1.0, *np.exp(-np.exp(rng.uniform(np.log(1e-6), np.log(0.01), 3)))])
    kappa, speed = np.exp(rng.uniform(np.log(2e-6), np.log(1e-3), 4)), np.exp(rng.uniform(np.log(1e-12), np.log(1e-3), 4))
    found = compare(
        speed, load, kappa, np.array([solved(TABLES[0].name, state) for state in zip(speed, load, kappa, strict=True)])
    )
    assert np.nanmax(found.errors) < 1e-5


@pytest.mark.slow
@pytest.mark.parametrize("mixed", [False, True])
def test_the_certificate_holds_on_five_thousand_states(mixed):
    found = certify(5000, seed=271828 + mixed, mixed=mixed)
    for errors in (found.friction, found.film):
        assert np.median(errors) < 1e-5
        assert errors.max() < 1e-4


@pytest.mark.quick
def test_rest_is_that_of_the_solver():
    for kappa in (1e-5, 30.0):
        for load in (0.3, 1.0):
            groups = sb.Groups(0.0, load, kappa * load)
            state = sb.solve(groups, rtol=1e-8)
            assert sb.atlas.friction(groups, boundary_friction=0.7) == 0.7
            assert (sb.atlas.contact_load_share(groups), sb.atlas.fluid_load_share(groups)) == (1, 0)
            for function in (sb.atlas.central_gap, sb.atlas.minimum_gap):
                right = getattr(state, function.__name__)
                assert abs(function(groups) - right) < 1e-5 * max(right, 1e-3 * kappa)
            assert abs(sb.atlas.offset(groups) - state.offset) < 1e-5 * max(1, abs(state.offset))


def test_smooth_contacts_are_those_of_the_solver_and_the_dry_one_is_that_of_hertz():
    for speed in (1e-9, 3.0):
        groups = sb.Groups(speed, 0.4, 0.0)
        state = sb.solve(groups, rtol=1e-7, on_failure="return")
        for name, function in zip(NAMES, FUNCTIONS, strict=False):
            assert function(groups) == pytest.approx(getattr(state, name), rel=2e-6)
        for definition in DEFINITIONS:
            right = state.friction(1.0, 0.2, definition).total
            assert sb.atlas.friction(groups, 1.0, 0.2, definition) == pytest.approx(right, rel=2e-6)
    groups = sb.Groups(0.0, 0.4, 0.0)
    state = sb.solve(groups)
    assert [function(groups) for function in FUNCTIONS[:6]] == [getattr(state, name) for name in NAMES]
    assert sb.atlas.friction(groups, boundary_friction=0.3) == 0.3


# --- other tables ---


def of_law(row, speed, load, kappa):
    """Return the groups of states of a table."""
    like = groups_of(row, 1.0, 1.0, 1.0)
    return sb.Groups(speed, load, kappa * load**like.scaling.roughness_exponent, **like.physics)


def test_another_table_is_within_its_stated_error_of_states_it_was_not_made_from(subtests):
    for row in (row for row in TABLES[1:] if row.geometry == "line"):
        with subtests.test(row.name):
            found = certify(4, seed=77, mixed=True, row=row)
            assert found.speed.size == 4
            assert found.friction.max() < row.error and np.median(found.friction) < 1e-4
            assert found.film.max() < 3 * row.error


def test_a_table_is_within_its_stated_error_where_it_errs_most(subtests):
    """Random states alone had shown half of this error."""
    for name, state in (("line-persson", (0.381, 0.0237, 0.0401)), ("line-exit", (0.3684, 5.0256e-6, 0.019289))):
        with subtests.test(name):
            row = next(row for row in TABLES if row.name == name)
            groups = of_law(row, *state)
            solved = sb.solve(groups, rtol=1e-6).friction(1.0, 0.01).total
            assert 0.002 < abs(sb.atlas.friction(groups, 1.0, 0.01) / solved - 1) < row.error


@pytest.mark.quick
def test_a_table_of_persson_serves_its_spectrum_and_refuses_others():
    law = persson_law(SelfAffine(**REFERENCE_SPECTRUM))
    groups, higher = (sb.Groups(1e-4, 5.0, 0.05, law=each) for each in (law, law.scaled(3e-6)))
    assert sb.atlas.for_groups(higher).name == "line-persson"
    assert sb.atlas.friction(higher) == pytest.approx(sb.atlas.friction(groups), rel=1e-9)
    other = sb.Groups(1e-4, 5.0, 0.05, law=persson_law(SelfAffine(**(REFERENCE_SPECTRUM | {"q1": 1.02e6}))))
    assert sb.atlas.for_groups(other) is None
    with pytest.raises(sb.InputError, match="one shape of the spectrum"):
        sb.atlas.friction(other)


def test_seals_and_films_that_end_are_read_off_tables_of_their_own(subtests):
    seal = sb.load_case(EXAMPLES / "rod_seal.toml").contact.replace(cavitation="none")
    ends = {"speed": (1e-3, 1.0), "points": 5}
    for name, contact in (("line-persson", seal), ("line-exit", TRUE.replace(cavitation="exit"))):
        with subtests.test(name):
            read, solved = (sb.stribeck_curve(contact, **ends, rtol=1e-5, method=method) for method in ("atlas", "solver"))
            row = sb.atlas.for_groups(read.groups)
            assert (row.name, row.error) == (name, read.rtol)
            assert (np.abs(read.friction - solved.friction) < read.friction.error).all()
            assert read.regimes == solved.regimes
    assert read.minimum.friction < 0.99 * sb.stribeck_curve(TRUE, **ends, method="atlas").minimum.friction


@pytest.mark.quick
def test_slow_films_that_end_have_a_share_of_first_order_in_the_speed():
    groups = sb.Groups(np.array([0.0, 1e-12, 1e-10]), 0.1, 1e-3, model=model_of(cavitation="exit"))
    rest, slow, faster = sb.atlas.fluid_load_share(groups)
    assert rest == 0
    assert faster / slow == pytest.approx(100, rel=1e-3)


# --- derivatives ---


def inside(row, number=300, margin=0.1):
    """Return random states of a table."""
    rng = np.random.default_rng(31)
    ends = [(math.log(low) + margin, math.log(high) - margin) for low, high in row.box.values()]
    return of_law(row, *(np.exp(rng.uniform(*each, number)) for each in ends))


@pytest.mark.quick
def test_derivatives_of_every_table_agree_with_differences(subtests):
    for name, states in [("mixed", transition_groups(400, 16180)), *((row.name, inside(row)) for row in TABLES)]:
        for definition in DEFINITIONS:
            with subtests.test(name=name, definition=definition):
                settings = {"boundary_friction": 0.9, "beta": 0.3, "definition": definition}
                at, physics = np.log([states.speed, states.load, states.roughness]), states.physics
                exact, friction = sb.atlas.friction_derivatives(states, **settings), sb.atlas.friction(states, **settings)
                for row, step in enumerate(np.eye(3) * 1e-5):
                    ahead, behind = (
                        sb.atlas.friction(sb.Groups(*np.exp(at + sign * step[:, None]), **physics), **settings)
                        for sign in (1, -1)
                    )
                    error = np.abs((ahead - behind) / 2e-5 - exact[row]) / (friction + np.abs(exact[row]))
                    # Blocks meet within their errors: the few states next to an edge see their jump.
                    assert np.quantile(error, 0.98) < 1e-6


def test_at_rest_and_for_smooth_contacts_derivatives_are_exact():
    assert (sb.atlas.friction_derivatives(sb.Groups(0.0, 0.2, 0.01)) == 0).all()
    slopes = sb.atlas.friction_derivatives(sb.Groups(1e-3, 0.2, 0.0), beta=0.1)
    friction = sb.atlas.friction(sb.Groups(1e-3, 0.2, 0.0), beta=0.1)
    assert slopes[1] == pytest.approx(0.5 * friction, rel=1e-12)
    assert slopes[2] == 0


# --- what is asked ---


def test_arrays_broadcast_and_order_does_not_matter():
    speed, load, kappa, groups = random_groups(300, 30103)
    wide = sb.Groups(speed[:, None], load[:20], 1e-4 * load[:20])
    mixed = np.random.default_rng(1).permutation(300)
    shuffled = sb.Groups(speed[mixed], load[mixed], (kappa * load)[mixed])
    for function in FUNCTIONS:
        values = function(groups)
        assert np.allclose(function(shuffled), values[mixed], rtol=1e-13)
        assert function(wide).shape == (300, 20)
        one = function(sb.Groups(speed[7], load[7], kappa[7] * load[7]))
        assert type(one) is float
        assert one == pytest.approx(values[7], rel=1e-13)
    assert sb.atlas.friction_derivatives(wide).shape == (3, 300, 20)
    assert sb.atlas.friction(sb.Groups(np.empty(0), 0.1, 1e-3)).shape == (0,)


OUTSIDE = [
    (1e-13, 0.1, 1e-3, "speed has the value 1e-13; the atlas covers 1e-12 to 1e+06 and 0"),
    (2e6, 0.1, 1e-3, "speed has the value 2e+06"),
    (1e-3, 2.0, 1e-3, "load has the value 2; the atlas covers 1e-06 to 1. Use solve"),
    (1e-3, 1e-7, 1e-3, "load has the value 1e-07"),
    (1e-3, 0.1, 1e-7, "relative_roughness has the value 1e-07; the atlas covers 1e-06 to 100 and 0"),
    (1e-3, 0.1, 200.0, "relative_roughness has the value 200"),
]


def test_a_curve_that_leaves_the_box_is_refused_when_it_is_made_and_one_without_speeds_ends_at_it(subtests):
    """It was made, and none of its numbers could be read."""
    given = {"method": "atlas", "boundary_friction": 0.5, "beta": 0.1}
    for speed, load, kappa, said in OUTSIDE:
        ends = sorted((1e-4, speed))
        with subtests.test(said), pytest.raises(sb.InputError, match=re.escape(said)):
            sb.stribeck_curve(speed=ends, load=load, roughness=kappa * load, points=3, **given)
    for groups in (sb.Groups(1.0, 1e-3, 0.1), sb.Groups(1.0, 0.1, 0.1 ** (2 / 3), geometry="point")):
        with subtests.test(groups.geometry):
            curve = sb.stribeck_curve(groups, points=5, **given)
            assert np.isfinite(curve.friction.total).all()
            assert sb.atlas.covers(curve.groups).all()


def test_outside_the_box_and_wrong_arguments_it_refuses():
    for function in (*FUNCTIONS, sb.atlas.friction_derivatives):
        for speed, load, kappa, words in OUTSIDE:
            many = sb.Groups(np.array([1e-3, speed]), np.array([0.1, load]), np.array([1e-4, kappa * load]))
            for groups in (sb.Groups(speed, load, kappa * load), many):
                with pytest.raises(sb.InputError, match=re.escape(words)):
                    function(groups)
    with pytest.raises(sb.InputError, match="load has the value 0.995 at speed 0"):
        sb.atlas.flux_gap(sb.Groups(0.0, 0.995, 1e-5))
    for wrong in ({"definition": "total"}, {"beta": 0.0}, {"boundary_friction": -1.0}):
        with pytest.raises(sb.InputError):
            sb.atlas.friction(sb.Groups(1e-3, 0.1, 1e-4), **wrong)


# --- the table ---


def test_a_table_is_small_and_says_where_it_comes_from():
    for row in TABLES:
        assert atlas_table.files("stribeck.atlas").joinpath(row.file).stat().st_size < 5e6
        about = sb.atlas.info(row.name)
        assert about["states"] > 1_000 and len(about["solver_hash"]) == 64
        assert (about["geometry"], about["law"], about["box"]) == (row.geometry, row.law, row.box)


def test_a_table_is_made_where_it_is_read(monkeypatch):
    made = []
    monkeypatch.setattr(atlas_build, "build", lambda row, target, *rest: made.append(target))
    monkeypatch.setattr("sys.argv", ["atlas_build", *(row.name for row in TABLES)])
    atlas_build.main()
    assert len(made) == len(TABLES) and all(target.exists() for target in made)


def test_the_hash_of_the_solver_holds_all_modules_that_make_numbers():
    found = set(atlas_build.solver_sources())
    assert {"equations.state", "equations.line", "solver.at_rest", "numerics.newton", "solids.half_plane"} <= found
    assert {"solver.point.refinement", "equations.point.system", "equations.cavities.wake"} <= found
    assert {"contact_laws.exponential", "fluids.newtonian", "contacts.groups", "equations.error_estimate"} <= found
    assert not any(name.startswith(("quantities", "asymptotics", "curves", "files")) for name in found)


def test_blocks_meet_within_the_stated_error():
    rng = np.random.default_rng(66260)
    load, speed = np.exp(rng.uniform(np.log(1e-6), -0.02, 300)), np.exp(rng.uniform(np.log(1e-9), np.log(1e3), 300))
    for edge in (1e-3, 1e-2, 1e-1):
        below, above = (sb.atlas.friction(sb.Groups(speed, load, load * edge * (1 + side * 1e-9))) for side in (-1, 1))
        assert np.abs(below / above - 1).max() < 5e-5
    kappa = np.exp(rng.uniform(np.log(1e-6), np.log(1e-3), 300))
    below, above = (sb.atlas.friction(sb.Groups(speed, 0.99 * (1 + side), kappa * 0.99)) for side in (-1e-9, 1e-9))
    assert np.abs(below / above - 1).max() < 5e-5


# --- curves, diagrams and sensitivities read off it ---


@pytest.mark.quick
def test_a_curve_read_off_it_is_the_solved_one():
    solved = sb.stribeck_curve(TRUE, points=11)
    read = sb.stribeck_curve(TRUE, points=11, method="atlas")
    assert len(read) == 11 and np.allclose(read.values, solved.values, rtol=1e-5)
    solved = sb.stribeck_curve(TRUE, speed=read.values)
    for part in ("total", "fluid", "asperities"):
        assert np.allclose(getattr(read.friction, part), getattr(solved.friction, part), rtol=1e-4)
    assert np.allclose(read.observable("minimum_gap"), solved.observable("minimum_gap"), rtol=1e-4)
    assert (np.abs(read.friction - solved.friction) <= read.friction.error).all()
    assert read.regimes == solved.regimes
    assert read.notes == solved.notes and len(read.notes) == 2  # it had none, nor then the files of the page
    assert [mark.name for mark in read.transitions] == [mark.name for mark in solved.transitions]
    for mine, theirs in zip(read.transitions, solved.transitions, strict=True):
        assert mine.value == pytest.approx(theirs.value, rel=1e-3)
        assert abs(math.log(mine.value / theirs.value)) <= mine.error + theirs.error
        assert mine.friction == pytest.approx(theirs.friction, rel=1e-4)
    between = np.sqrt(read.values[1:] * read.values[:-1])
    one, two = read.at(between), solved.at(between)
    assert (np.abs(one.friction - two.friction) <= one.friction.error + two.friction.error).all()
    place = float(between[5])
    assert read.at(place).central_gap == pytest.approx(solved.at(place).central_gap, rel=read.error_estimate)
    assert read.sampled(7).transitions[0].value == pytest.approx(read.transitions[0].value, rel=1e-6)
    assert read.friction(boundary_friction=0.35).asperities == pytest.approx(0.5 * read.friction.asperities)
    assert read.to_dataset()["friction"].values == pytest.approx(solved.to_dataset()["friction"].values, rel=1e-4)
    over_load, solved = (sb.stribeck_curve(TRUE, load=(5, 100), points=4, method=each) for each in ("atlas", "solver"))
    assert np.allclose(over_load.friction, solved.friction, rtol=1e-4)
    with pytest.raises(sb.InputError, match="outside the curve"):
        read.at(2 * read.values[-1])
    with pytest.raises(sb.InputError, match="the atlas has contact_load_share"):
        read.observable("error_estimate")
    with pytest.raises(sb.InputError, match="must be 'solver' or 'atlas'"):
        sb.stribeck_curve(TRUE, points=3, method="table")


@pytest.mark.slow
def test_a_phase_diagram_read_off_it_is_the_solved_one():
    pytest.importorskip("xarray")
    grid = {"load": 0.1, "roughness": [0.0, 1e-5, 1e-4], "speed": (1e-6, 1.0), "points": {"speed": 5}}
    solved, read = (sb.phase_diagram(**grid, rtol=1e-6, method=method) for method in ("solver", "atlas"))
    assert set(read.variables) == set(solved.variables)
    assert (read.outcome == "CONVERGED").all()
    assert (read.regime == solved.regime).all()
    assert (read.velocity_weakening == solved.velocity_weakening).all()
    for name in ("friction", "central_gap", "fluid_load_share", "contact_friction_share", "lambda_ratio"):
        assert np.allclose(read[name], solved[name], rtol=1e-4, atol=1e-7), name
    for name in read:
        if name.startswith("speed_at"):
            assert np.allclose(read[name], solved[name], rtol=1e-3, equal_nan=True), name
    with pytest.raises(sb.InputError, match="speed has the value"):
        sb.phase_diagram(load=0.1, roughness=1e-3, speed=(1e-9, 1e8), method="atlas")


def test_the_atlas_says_which_states_it_covers():
    speed, load = np.array([0.0, 1e-6, 1e9]), np.array([[1e-3], [2.0]])
    assert sb.atlas.covers(sb.Groups(speed, load, 1e-4)).tolist() == [[True, True, False], [False, False, False]]
    assert sb.atlas.covers(sb.Groups(1e-6, 0.1, np.array([0.0, 1e-4, 1e3]))).tolist() == [True, True, False]
    other = sb.Groups(1e-6, 0.1, np.array([0.0, 1e-4]), law=sb.contact_laws.GreenwoodTripp())
    assert sb.atlas.covers(other).tolist() == [True, False]
    for groups in (sb.Groups(1e-6, 0.1, 1e-4), sb.Groups(1e-6, 2.0, 1e-4)):
        if sb.atlas.covers(groups):
            assert sb.atlas.friction(groups) > 0
        else:
            with pytest.raises(sb.InputError):
                sb.atlas.friction(groups)


def test_shares_and_friction_are_those_of_the_single_functions():
    groups = sb.Groups(np.geomspace(1e-9, 1e2, 23), 0.05, 0.002)
    for definition in ("published", "balanced"):
        found = sb.atlas.shares_and_friction(groups, 0.8, 0.05, definition)
        expected = [
            sb.atlas.fluid_load_share(groups),
            sb.atlas.contact_load_share(groups),
            sb.atlas.viscous_friction(groups, 0.05, definition),
            sb.atlas.friction_derivatives(groups, 0.8, 0.05, definition)[0],
        ]
        assert np.allclose(found, expected, rtol=1e-12, atol=0)
    assert sb.atlas.shares_and_friction(sb.Groups(0.0, 0.05, 0.002))[3] == 0
