"""Stated errors of balls against much finer states, as a reader takes them: relative to the observable itself."""

import numpy as np
import pytest

import stribeck as sb

OWN = ("J_couette", "J_poiseuille", "J_balanced", "J_published", "central_gap", "offset")


def states(number):
    rng = np.random.default_rng(3)
    for _ in range(number):
        speed, load, kappa = 10 ** rng.uniform((-4, -5, -2.5), (0.5, 0, -0.5))
        yield sb.Groups(speed, load, kappa * load ** (2 / 3), geometry="point")


@pytest.mark.parametrize(
    "groups", list(states(12)), ids=lambda groups: f"{groups.speed:.1e}-{groups.load:.1e}-{groups.roughness:.1e}"
)
def test_full_films_are_as_near_as_they_state(groups):
    coarse, fine = sb.solve(groups, rtol=1e-3), sb.solve(groups, rtol=1e-5)
    for name in OWN:
        here, there = getattr(coarse, name), getattr(fine, name)
        assert abs(here - there) <= coarse.errors[name] * abs(here) + fine.errors[name] * abs(there), name


@pytest.mark.parametrize(
    ("speed", "load", "roughness", "time", "exponent"),
    [
        (3.42099e-4, 1.37079e-3, 4.73279e-5, 0.2528, 0.3232),
        (4.9686e-4, 1.3832e-3, 1.29492e-5, 0.3907, 0.4259),
    ],
)
def test_the_moment_of_the_contact_pressure_is_as_near_as_it_states_where_a_fluid_thins(
    speed, load, roughness, time, exponent
):
    groups, fluid = sb.Groups(speed, load, roughness, geometry="point"), sb.fluids.Carreau(time, exponent)
    coarse, fine = (sb.solve(groups, fluid=fluid, rtol=rtol) for rtol in (1e-3, 1e-5))
    scale = max(abs(coarse.J_balanced), abs(coarse.J_published))
    assert abs(coarse.J_pcx - fine.J_pcx) <= (coarse.errors["J_pcx"] + fine.errors["J_pcx"]) * scale
