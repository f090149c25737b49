"""No result has a sign that physics forbids: friction, load shares, films, whatever the model, and however one asks for it.

Where one surface rests, friction acts against the motion.  Where both move the part of the fluid may have either sign.
"""

import math

import numpy as np
import pytest
from scipy.integrate import trapezoid

import stribeck as sb

THICK = {
    "radius": "10 mm",
    "modulus": "2.7 MPa",
    "load": "1 mN",
    "viscosity": "0.5 Pa s",
    "speed": "1 m/s",
    "roughness": "1 um",
    "alpha": 2.0,
    "beta": 0.05,
    "boundary_friction": 0.5,
}
"""A film of 151 indentations: the parabola has risen as much at 17 Hertz radii."""


def within(h0, radius):
    """Return the friction integral of a rigid parabola in a full film up to a radius, over the speed group."""
    r = np.geomspace(1e-4 * radius, radius, 20_001)
    h = h0 + 0.5 * r**2
    mean = 1 / (6 * h) - 0.1 * (1 / h - r**2 / h**2)
    return 2 * math.pi * float(trapezoid(mean * r, r))


@pytest.fixture(scope="module")
def thick():
    return sb.solve(sb.PointContact(**THICK), rtol=1e-3)


def test_a_drop_in_a_thick_film_drags_as_the_film_up_to_its_edge(subtests, thick):
    for radii in [1.5, 7.0, 200.0]:
        with subtests.test(radii=radii):
            contact = sb.PointContact(**THICK)
            drop = sb.solve(contact.replace(wetted_radius=radii * contact.hertz.half_width), rtol=1e-3)
            wanted = 1.5 / math.pi * contact.slope * contact.groups.speed * within(thick.central_gap, radii)
            found = drop.friction()
            assert found.fluid == pytest.approx(wanted, rel=0.02)
            assert 0 < found.fluid < thick.friction().fluid


def test_a_drop_has_one_friction_however_one_asks():
    contact = sb.PointContact(**THICK, wetted_radius="1 mm")
    speeds = np.array([0.3, 1.0])
    batch = sb.solve_batch(contact, speed=speeds, rtol=1e-3)
    curve = sb.stribeck_curve(contact, speed=speeds, rtol=1e-3)
    for i, speed in enumerate(speeds):
        one = sb.solve(contact.replace(speed=speed), rtol=1e-3).friction
        assert one.total > 0
        for other, error in ((batch.friction[i], batch.friction.error[i]), (curve.friction[i], curve.friction.error[i])):
            assert abs(other - one.total) <= error + one.error


def test_friction_of_the_atlas_is_positive_and_grows_with_the_drop(subtests):
    for speed in [1e-3, 100.0]:
        for radii in [5.0, 6.0, 12.0, 30.0]:
            with subtests.test(speed=speed, radii=radii):
                groups = sb.Groups(speed, 0.1, 1e-3, geometry="point")
                smaller, larger = (sb.atlas.viscous_friction(groups, 0.1, wetted_radius=each * radii) for each in (1.0, 1.1))
                assert 0 < smaller < larger


def test_far_films_and_integrated_ones_meet_within_the_stated_error():
    contact = sb.PointContact(**THICK).replace(speed="3 mm/s")
    below, above = (
        sb.solve(contact.replace(wetted_radius=each * contact.hertz.half_width), rtol=1e-4).friction()
        for each in (4.999, 5.001)
    )
    assert abs(below.fluid - above.fluid) < above.error + 1e-3 * below.fluid


def drawn(rng):
    """Return a random contact: any geometry, fluid, body, cavitation, law, motion and liquid."""

    def log(low, high):
        return math.exp(rng.uniform(math.log(low), math.log(high)))

    is_ball = rng.random() < 0.6
    groups = {"geometry": "point"} if is_ball else {}
    load, kappa = log(1e-4, 0.3), log(1e-3, 0.1)
    roughness = kappa * load ** (2 / 3) if is_ball else kappa * load
    kind, given = (sb.PointContact if is_ball else sb.LineContact), {}
    contact = kind.from_groups(
        sb.Groups(log(1e-4, 1e2), load, roughness, **groups),
        radius=0.01,
        modulus=2e6,
        viscosity=0.1,
        alpha=2.0,
        beta=0.1,
        boundary_friction=0.7,
    )
    given["cavitation"] = str(rng.choice(["none", "none", "exit"]))
    body = rng.integers(3)
    if body == 0:
        given["solid"] = sb.solids.Layer(log(0.5, 10) * contact.hertz.half_width, 0.45)
    thins = rng.integers(4)
    if thins == 0:
        rate = contact.speed / contact.hertz.indentation
        given["fluid"] = sb.fluids.Carreau(log(1e-2, 1e2) / rate, rng.uniform(0.4, 0.9))
    elif thins == 1:
        given["fluid"] = sb.fluids.Barus(log(0.01, 0.5) / contact.hertz.pressure)
    if rng.random() < 0.3:
        given["slide_to_roll"] = rng.choice([0.1, 0.5, 1.5])
    if is_ball and rng.random() < 0.7:
        given["wetted_radius"] = log(1.05, 30) * contact.hertz.half_width
    if thins != 0 and "slide_to_roll" in given and not is_ball:
        del given["slide_to_roll"]
    return contact, given


def broken(found, contact):
    """Return what physics forbids in a state."""
    friction = found.friction()
    said = {
        "contact share": -1e-9 <= found.contact_load_share <= 1 + 1e-6,
        "shares": abs(found.contact_load_share + found.fluid_load_share - 1) < max(1e-3, 10 * found.rtol),
        "film": 0 < found.minimum_gap <= found.central_gap * (1 + 0.01),
        "contact friction": friction.asperities >= 0,
        "finite": math.isfinite(friction.total) and friction.error >= 0,
    }
    if getattr(contact, "slide_to_roll", 2.0) == 2.0:
        said["viscous"] = friction.fluid > 0
        said["published"] = found.friction(definition="published").fluid > 0
    if str(contact.cavitation) in ("exit", "Cavitation.EXIT"):
        said["suction"] = float(np.min(found.fluid_pressure)) >= -1e-6
    return [name for name, holds in said.items() if not holds]


def test_no_random_contact_has_a_sign_that_physics_forbids(subtests):
    for seed in range(8):
        with subtests.test(seed=seed):
            contact, given = drawn(np.random.default_rng(seed))
            contact = contact.replace(**given)
            assert broken(sb.solve(contact, rtol=1e-2), contact) == []


def test_a_drop_whose_friction_is_lost_in_a_thick_film_that_breaks_is_refused():
    groups = sb.Groups(1e4, 0.1, 1e-4, geometry="point")
    contact = sb.PointContact.from_groups(
        groups, radius=0.01, modulus=2e6, viscosity=0.1, alpha=2.0, beta=0.05, boundary_friction=0.7
    )
    for radii in (1.05, 20.0):
        try:
            found = sb.solve(contact.replace(cavitation="exit", wetted_radius=radii * contact.hertz.half_width), rtol=1e-2)
        except sb.SolveError as failure:
            assert "larger wetted_radius" in str(failure)
        else:
            assert found.friction().fluid > 0
