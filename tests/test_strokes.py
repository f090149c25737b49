"""Strokes, starts and stops of a line contact in time."""

import dataclasses
import functools
import math

import numpy as np
import pytest
from command_line import EXAMPLES

import stribeck as sb

RADIUS, MODULUS, SPEED = 10e-3, 1e6, 0.1
HALF_WIDTH = (
    0.1 * RADIUS
)  # u/a = 0.1, F = 0.1, kappa = 1e-3, lambda = 1e-3 at the largest speed: shapes of the table in strokes.md
LOAD = math.pi / 4 * MODULUS * HALF_WIDTH**2 / RADIUS
CONTACT = sb.LineContact(
    radius=RADIUS,
    modulus=MODULUS,
    load=LOAD,
    viscosity=1e-3 * 4 / (3 * math.pi**2) * LOAD**2 / (SPEED * RADIUS * MODULUS),
    speed=SPEED,
    roughness=1e-3 * HALF_WIDTH**2 / RADIUS,
    alpha=1.0,
    beta=0.05 / 0.1**0.5,
    boundary_friction=0.5,
)
THINS_AND_STIFFENS = sb.fluids.Fluid(sb.fluids.Carreau("1 ms", 0.5), sb.fluids.Barus("2e-7 1/Pa"), sb.fluids.DowsonHigginson())


def with_profile(profile):
    given = {name: getattr(CONTACT, name) for name in ("modulus", "load", "viscosity", "speed", "roughness", "alpha", "beta")}
    return sb.LineContact(profile=profile, boundary_friction=0.5, **given)


def sine(half_widths, speed=SPEED):
    stroke = half_widths * HALF_WIDTH
    return sb.motions.Sine(stroke=stroke, frequency=speed / (math.pi * stroke))


@functools.cache
def stroke(half_widths, steps=400):
    return sb.stroke(CONTACT, sine(half_widths), steps=steps)


def at_parts(found, parts=(0.05, 0.2, 0.5)):
    """Return friction at parts of the largest speed, speeding up and slowing down, in the last cycle."""
    last = found.last_cycle
    speed, friction = np.abs(found.speed[last]) / SPEED, np.abs(found.friction[last])
    rising = np.gradient(speed) > 0
    answer = []
    for way in (rising, ~rising):
        order = np.argsort(speed[way])
        answer += list(np.interp(parts, speed[way][order], friction[way][order]))
    return np.array(answer)


def test_a_short_stroke_keeps_its_film():
    """Of 8 half-widths friction is less than a tenth of that of steady sliding, .2374 and .0872, near the ends."""
    found = stroke(8, 160)
    assert np.allclose(at_parts(found), [0.0077, 0.0091, 0.0108, 0.0068, 0.0059, 0.0049], rtol=0.03)
    assert 0.018 < found.largest_contact_load_share < 0.020
    assert found.half_widths == pytest.approx(8, rel=1e-6)
    assert (found.errors["friction"] < 0.15 * np.abs(found.friction).max()).all()


@pytest.mark.slow
def test_a_stroke_of_forty_half_widths_has_the_friction_of_an_independent_scheme():
    found = stroke(40)
    assert np.allclose(at_parts(found), [0.0406, 0.0447, 0.0470, 0.0347, 0.0244, 0.0106], rtol=0.01)
    assert found.largest_contact_load_share == pytest.approx(0.090, rel=0.01)


@pytest.mark.slow
def test_a_stroke_of_a_thousand_half_widths_has_the_friction_of_the_page():
    """Of docs/when_not_to_use.md, there over steady sliding, with a quarter of its steps: the stated error covers the rest."""
    found = stroke(1000)
    assert np.allclose(at_parts(found), [0.2393, 0.0989, 0.0205, 0.1679, 0.0787, 0.0190], rtol=0.01)
    last = found.last_cycle
    missed = abs(found.largest_contact_load_share - 0.480)
    assert missed < found.errors["contact_load_share"][last][np.argmax(found.contact_load_share[last])]


@pytest.mark.slow
def test_slow_strokes_tend_to_steady_states_as_the_inverse_of_their_length():
    steady = [sb.solve(CONTACT.replace(speed=part * SPEED)).friction.total for part in (0.2, 0.5)]
    away = [at_parts(stroke(length), (0.2, 0.5)) / np.array(steady * 2) - 1 for length in (4000, 8000)]
    assert (np.abs(away[1]) < 0.03).all()
    assert np.allclose(away[0] / away[1], 2.0, atol=0.3)


def test_time_steps_are_of_second_order():
    ends = [sb.stroke(CONTACT, sb.motions.Ramp(SPEED, 0.2 * SPEED, 0.1), steps=n).friction[-1] for n in (32, 64, 128)]
    assert math.log2((ends[0] - ends[1]) / (ends[1] - ends[2])) == pytest.approx(2.0, abs=0.3)


def test_the_mesh_serves_the_fastest_and_the_slowest_of_a_motion():
    """At a ten-thousandth of the largest speed friction and films are at last those of steady sliding."""
    contact, slow = CONTACT.replace(roughness=0.03 * CONTACT.roughness), 1e-4 * SPEED
    found = sb.stroke(contact, sb.motions.Table([0, 0.02, 1000.0], [SPEED, slow, slow]), steps=40)
    state = sb.solve(contact.replace(speed=slow))
    assert found.friction[-1] == pytest.approx(state.friction.total, rel=1e-4)
    assert found.minimum_film_thickness[-1] == pytest.approx(state.minimum_gap * contact.hertz.indentation, rel=1e-4)


@pytest.mark.parametrize("inlet", ["flooded", "own-wake"])
@pytest.mark.slow
def test_the_stated_error_covers_that_of_four_times_the_steps(inlet):
    contact, cycles = (CONTACT, 1) if inlet == "flooded" else (CONTACT.replace(cavitation="exit"), 2)
    coarse, fine = (sb.stroke(contact, sine(20), cycles=cycles, steps=n, inlet=inlet) for n in (80, 320))
    for name, error in coarse.errors.items():
        missed = np.abs(getattr(coarse, name) - getattr(fine, name)[::4]) > error + 1e-6 * np.abs(getattr(fine, name)).max()
        assert missed.mean() < 0.05, name


@pytest.mark.parametrize(
    "change",
    [
        {},
        {"cavitation": "exit", "fluid": THINS_AND_STIFFENS},
        pytest.param({"fluid": sb.fluids.Eyring("1 kPa"), "cavitation": "none"}, marks=pytest.mark.slow),
        pytest.param({"flow_factors": sb.fluids.PatirCheng(), "cavitation": "exit"}, marks=pytest.mark.slow),
        pytest.param({"profile": sb.profiles.Land(land_width=HALF_WIDTH, edge_radius=RADIUS / 2)}, marks=pytest.mark.slow),
    ],
)
def test_a_motion_that_stays_at_one_speed_stays_in_its_steady_state(change):
    """Whose flow is that of the equations of steady sliding, and whose exit is an unknown there."""
    contact = CONTACT.replace(**change) if "profile" not in change else with_profile(**change)
    found = sb.stroke(contact, sb.motions.Table([0, 0.1], [SPEED, SPEED]), steps=16)
    state = sb.solve(contact)
    rtol = 2e-4 if "flow_factors" in change else 2e-5  # the film has kinks where no panel of a stroke ends
    assert np.allclose(found.friction, state.friction.total, rtol=rtol)
    assert np.allclose(found.minimum_film_thickness, state.minimum_gap * contact.hertz.indentation, rtol=rtol)
    assert found.work == pytest.approx(state.friction.total * LOAD * SPEED * 0.1, rel=rtol)


def test_asperities_that_rub_by_a_shear_stress_do_so_over_their_area_at_each_instant():
    """At one speed as in steady sliding; and with it the friction is a factor on that of a stress of one size."""
    seal = sb.load_case(EXAMPLES / "rod_seal.toml").contact.replace(cavitation="none")
    one, fast = (seal.replace(shear_stress="0.2 MPa", speed_exponent=n, reference_speed=seal.speed) for n in (0.0, 0.5))
    slow = 0.2 * seal.speed
    found = sb.stroke(fast, sb.motions.Table([0, 1e-3], [slow, slow]), steps=16)
    assert np.allclose(found.friction, sb.solve(fast.replace(speed=slow)).friction.total, rtol=5e-5)
    motion = sb.motions.Sine(stroke=10 * seal.hertz.half_width, frequency=1.0)
    found, plain = (sb.stroke(each, motion, cycles=1, steps=16) for each in (fast, one))
    factor = (np.abs(found.speed) / seal.speed) ** 0.5
    assert np.allclose(found.friction_asperities, factor * plain.friction_asperities, rtol=1e-9)
    # Of all the load on a small area it would be the stress over the pressure there; the area falls behind the load.
    most = one.asperity_friction.coefficient_at_small_area(one) * plain.contact_load_share
    part = np.abs(plain.friction_asperities)[plain.speed != 0] / most[plain.speed != 0]
    assert 0.95 < part.min() and part.max() < 0.999


@pytest.mark.parametrize(
    ("cavitation", "wanted"),
    [("none", [0.00731, 0.03443, 0.0611, 0.00574]), ("exit", [0.00704, 0.03429, 0.0598, 0.00530])],
)
@pytest.mark.slow
def test_a_speed_that_rises_and_falls_has_the_friction_of_an_independent_scheme(cavitation, wanted):
    """Finite volumes that conserve the liquid of the cavity, extrapolated from two time steps of implicit Euler."""
    unit = 2 * HALF_WIDTH / SPEED
    t = np.linspace(0, 20, 401)
    motion = sb.motions.Table(list(t * unit), list(SPEED * (0.55 + 0.45 * np.cos(0.1 * np.pi * t))))
    found = sb.stroke(CONTACT.replace(cavitation=cavitation), motion)
    assert np.allclose(np.interp([5, 10, 15, 20], found.time / unit, found.friction), wanted, rtol=0.01)


@pytest.mark.slow
def test_a_film_that_thins_and_ends_turns_with_the_motion():
    """The way back is the mirror image of the way out; that of a Newtonian film is so below."""
    contact = CONTACT.replace(cavitation="exit", fluid=sb.fluids.Carreau("1 ms", 0.8))
    found = sb.stroke(contact, sine(8), steps=32, cycles=2)
    for name in ("contact_load_share", "friction_fluid", "minimum_film_thickness"):
        out, back = np.abs(getattr(found, name)[16:33]), np.abs(getattr(found, name)[32:49])
        assert np.allclose(out, back, atol=0.01 * back.max()), name


def out_and_back(out, back, half_widths=10.0, part=0.9):
    """Return a motion out at one speed and a part of the way back at another one."""
    length = half_widths * HALF_WIDTH
    turn = 0.02 * length / out
    times = np.cumsum([0.0, length / out, turn, part * length / back])
    return sb.motions.Table(list(times), [out, out, -back, -back])


def test_a_contact_that_runs_into_a_thick_wake_is_flooded():
    """The wake of the fast way out is more than the slow way back can draw in."""
    contact, motion = CONTACT.replace(cavitation="exit"), out_and_back(SPEED, 0.1 * SPEED)
    flooded, own = (sb.stroke(contact, motion, steps=16, inlet=inlet) for inlet in ("flooded", "own-wake"))
    for name in flooded.errors:
        assert np.allclose(getattr(own, name), getattr(flooded, name), rtol=1e-6, atol=0), name
    assert "has what the contact has left behind itself" in own.notes[0] and "is flooded" in flooded.notes[0]


def test_a_contact_that_runs_into_a_thin_wake_draws_in_no_more_than_that():
    """On the fast way back the film is about that of the slow way out, a third of that of a flooded inlet."""
    contact, motion = CONTACT.replace(cavitation="exit"), out_and_back(0.1 * SPEED, SPEED)
    own, few = (sb.stroke(contact, motion, steps=steps, inlet="own-wake") for steps in (140, 40))
    slow, flooded = (sb.solve(contact.replace(speed=part * SPEED)) for part in (0.1, 1.0))
    film = slow.flux_gap * contact.hertz.indentation
    passed = 2 * np.abs(own.right_flow[-1]) / SPEED
    assert passed == pytest.approx(film, rel=1e-3)
    # Of so many steps it goes to and fro by two per cent.
    assert 0.97 < own.central_film_thickness[-1] / own.central_film_thickness[0] < 1.03
    assert flooded.central_gap > 2.5 * slow.central_gap
    assert own.friction[-1] < -10 * flooded.friction.total < 0
    # The difference is within the error of the fewest steps that a motion may have.
    assert abs(few.central_film_thickness[-1] - own.central_film_thickness[-1]) < few.errors["central_film_thickness"][-1]


@pytest.mark.slow
def test_no_liquid_comes_out_of_a_wake_that_has_not_gone_into_it():
    """On no position of the way back has it drawn in more than it has left from there on: a flooded inlet has."""
    contact = CONTACT.replace(cavitation="exit")
    own, flooded = (sb.stroke(contact, sine(8), steps=40, cycles=2, inlet=inlet) for inlet in ("own-wake", "flooded"))
    for found, holds in ((own, True), (flooded, False)):
        for flow, turn in ((found.right_flow, 50), (-found.left_flow, 30)):
            gone = np.concatenate([[0.0], np.cumsum(0.5 * (flow[1:] + flow[:-1]) * np.diff(found.time))])
            drawn, left = gone[turn] - gone[turn : turn + 21], gone[turn] - gone[turn - 20 : turn + 1][::-1]
            assert bool((drawn < left + 0.01 * np.ptp(gone)).all()) is holds
    for name in ("friction_fluid", "minimum_film_thickness"):  # a film that ends turns with the motion
        out, back = np.abs(getattr(flooded, name)[20:41]), np.abs(getattr(flooded, name)[40:61])
        assert np.allclose(out, back, atol=0.01 * back.max()), name
    last = own.last_cycle
    assert np.abs(own.friction[last]).max() > 1.2 * np.abs(flooded.friction[last]).max()
    assert own.work > 1.2 * flooded.work


def test_a_thick_film_is_squeezed_out_as_under_a_rigid_cylinder():
    """F = 3 2**(1/2) pi eta V (R/h)**(3/2), so that h**(-1/2) grows evenly; but for the elastic indentation over the film."""
    thick = CONTACT.replace(viscosity=CONTACT.viscosity * 1e10)
    found = sb.stroke(thick, sb.motions.Table([0, 1, 1000], [SPEED, 0, 0]), steps=100)
    rate = LOAD / (6 * 2**0.5 * math.pi * thick.viscosity * RADIUS**1.5)
    time, root = found.time[20:], found.central_film_thickness[20:] ** -0.5
    assert np.allclose((root[-1] - root[:-1]) / (rate * (time[-1] - time[:-1])), 1, atol=1e-4)


def test_what_is_not_solved_in_time_is_refused_by_its_name(subtests):
    for contact, motion, options, word in [
        (CONTACT.replace(cavitation="reform"), sine(40), {}, "would have an edge more"),
        (CONTACT.replace(solid=sb.solids.StandardLinearSolid("10 ms", 3.0)), sine(40), {}, "the body remembers"),
        (CONTACT.replace(slide_to_roll=1.0), sine(40), {}, "pure sliding"),
        (CONTACT.replace(roughness=0.0), sine(40), {}, "roughness is zero"),
        (CONTACT, sine(40), {"inlet": "own-wake"}, "needs a film that ends"),
        (CONTACT, sine(40), {"inlet": "dry"}, "'flooded' or 'own-wake'"),
        (CONTACT, sine(40), {"steps": 41}, "even"),
        (CONTACT, sine(40), {"cycles": 0}, "cycles = 0"),
        (CONTACT, sb.motions.Ramp(SPEED, 2 * SPEED, 1.0), {"cycles": 2}, "does not end as it begins"),
        (CONTACT, sb.motions.Ramp(0.0, SPEED, 1.0), {}, "begins with the speed"),
        (CONTACT, sb.motions.Table([0, 1], [0.0, 0.0]), {}, "at rest"),
        (CONTACT, "to and fro", {}, "must be a motion"),
        (sb.Groups(1e-3, 0.1, 1e-4), sine(40), {}, "not of balls"),
    ]:
        with subtests.test(word), pytest.raises(sb.InputError, match=word):
            sb.stroke(contact, motion, **options)


def test_a_table_of_the_same_speeds_is_the_same_motion():
    table = sb.motions.Table(["0 s", "100 ms", "0.2 s"], ["0.1 m/s", "0.2 m/s", 0.1], repeats=True)
    t = np.linspace(0, 0.2, 401)
    assert np.allclose(np.gradient(table.position(t), t)[1:-1], table.speed(t)[1:-1], atol=1e-3)
    assert len(table.times(50)) == 51
    with pytest.raises(sb.InputError, match="must begin at 0 and rise"):
        sb.motions.Table([0, 0], [1, 1])


def test_a_stroke_is_a_dataset_and_a_picture(tmp_path):
    found = stroke(8, 160)
    data = found.to_dataset()
    assert data.friction.attrs["long_name"] and set(data.friction.dims) == {"time"}
    assert float(data.work) == found.work
    assert "of the last cycle, 160 steps" in str(found)
    loop, films = found.plot(tmp_path / "stroke.png").axes
    assert loop.get_xlabel() == "position (mm)" and 4 < loop.get_xlim()[1] < 5  # of 8 mm
    assert films.get_ylabel() == "film (nm)" and films.get_ylim()[1] > 100
    assert found == dataclasses.replace(found)


def test_each_motion_moves_at_its_speed_and_has_its_instants_where_the_film_changes_fastest(subtests):
    for motion, distance in (
        (sb.motions.Stop(start=0.1, braking_time=0.01, rest=1.0), 0.5e-3),
        (sb.motions.Ramp(start=0.1, end=0.3, duration=0.05), 0.01),
        (sb.motions.Sine(stroke=0.02, frequency=2.0), 0.0),
        (sb.motions.Table([0.0, 0.01, 0.03], [0.0, 0.1, 0.05]), 2e-3),
    ):
        with subtests.test(motion=type(motion).__name__):
            times = motion.times(200)
            assert times[0] == 0 and times[-1] == motion.duration and np.all(np.diff(times) > 0) and times.size == 201
            moved = np.concatenate(
                [[0.0], np.cumsum(0.5 * np.diff(times) * (motion.speed(times[1:]) + motion.speed(times[:-1])))]
            )
            path = motion.position(times) - motion.position(times[:1])
            assert np.allclose(path, moved, rtol=0, atol=2e-4 * np.abs(path).max())
            assert path[-1] == pytest.approx(distance, rel=1e-3, abs=1e-6)
    stop = sb.motions.Stop(start=0.1, braking_time=0.01, rest=1.0)
    assert stop.duration == 1.01 and not stop.repeats
    assert stop.speed(np.array([0.0, 0.0025, 0.01, 0.5])) == pytest.approx([0.1, 0.075, 0.0, 0.0], abs=1e-15)
    steps = np.diff(stop.times(200))
    assert np.sum(stop.times(200) <= 0.01 * (1 + 1e-12)) == 101 and np.all(np.diff(steps[101:]) > 0)
    assert steps[100] < 0.1 * steps[99]
