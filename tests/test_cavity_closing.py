"""A cavity behind a cylinder that is about to close: the film beside it is nearly full, and known on both sides."""

import numpy as np
import pytest

import stribeck as sb

GROUPS = sb.Groups(1e-4, 0.1, 1e-4)
NAMES = ("contact_load_share", "central_gap", "minimum_gap", "offset", "viscous_balanced")


def deepest(full):
    """Return the largest suction of a full film, by the parabola through its lowest nodes."""
    i = int(np.argmin(full.fluid_pressure))
    x, p = (each[i - 1 : i + 2] for each in (full.x, full.fluid_pressure))
    bend, slope, lowest = np.polyfit(x - x[1], p, 2)
    return lowest - slope**2 / (4 * bend)


@pytest.fixture(scope="module")
def full():
    return sb.solve(GROUPS)


@pytest.mark.parametrize(
    "parts",
    [(2e-2, 1e-3, 1e-5), pytest.param((2e-2, 6e-3, 1e-3, 6e-4, 3e-4, 1e-4, 3e-5, 1e-5), marks=pytest.mark.slow)],
    ids=len,
)
def test_a_film_whose_cavity_is_about_to_close_is_nearly_the_full_one(full, parts):
    least, changes = deepest(full), []
    for taken in parts:
        found = sb.solve(GROUPS, cavitation="reform", cavity_pressure=(1 - taken) * least)
        assert found.error_estimate <= 1e-6
        changes.append(found.minimum_gap / full.minimum_gap - 1)
    assert all(later < before + 1e-6 for before, later in zip(changes, changes[1:], strict=False))
    # In proportion to the suction that is taken, about.
    assert changes[parts.index(1e-3)] == pytest.approx(1e-3 * changes[0] / 2e-2, rel=0.5) and changes[-1] < 2e-6


def test_both_sides_of_the_closing_agree_within_their_errors(full):
    low, high = ((1 - each) * deepest(full) for each in (3e-6, -1e-3))
    cavity, closed = (sb.solve(GROUPS, cavitation="reform", cavity_pressure=each) for each in (low, high))
    for name in NAMES:
        here, there = getattr(cavity, name), getattr(closed, name)
        assert abs(here - there) <= (cavity.errors[name] + closed.errors[name]) * max(abs(there), 1e-3) + 3e-7 * abs(there), (
            name
        )
