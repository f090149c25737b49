"""What several test modules share: solved states, kept for the session."""

from functools import cache

import pytest

import stribeck as sb


@cache
def _solved(speed, load, roughness, rtol):
    return sb.solve(sb.Groups(speed, load, roughness), rtol=rtol)


@pytest.fixture(scope="session")
def solved():
    """Return a function that solves ``(speed, load, roughness)`` once for all tests."""

    def solve(speed, load, roughness, rtol=1e-6):
        return _solved(float(speed), float(load), float(roughness), rtol)

    return solve
