"""What the tests of fits share: friction of a known contact with known noise."""

from functools import cache
from pathlib import Path

import numpy as np

import stribeck as sb

EXAMPLES = Path(__file__).parents[1] / "examples"
TRUE = sb.load_case(EXAMPLES / "pdms_cylinder.toml").contact


@cache
def _exact(contact, low, high, rows):
    speeds = np.geomspace(low, high, rows)
    return speeds, sb.stribeck_curve(contact, speed=speeds, rtol=1e-7).friction


def exact(contact=TRUE, low=1e-4, high=0.5, rows=15):
    """Return speeds and solved friction of a contact."""
    speeds, friction = _exact(contact, low, high, rows)
    return speeds.copy(), friction.copy()


def measured(values, friction, error=None, abscissa="speed", curve=None, curves=("data",), inputs=({},)):
    """Return measurements as if read from a file."""
    n = len(values)
    return sb.results.Measurements(
        abscissa=abscissa,
        values=np.asarray(values, dtype=float),
        friction=np.asarray(friction, dtype=float),
        error=None if error is None else np.broadcast_to(error, n),
        curve=np.zeros(n, dtype=int) if curve is None else np.asarray(curve),
        curves=curves,
        inputs=inputs,
        rows=np.arange(2, n + 2),
    )


def noisy(seed, noise=0.04, contact=TRUE, outliers=0, **places):
    """Return measurements of a contact with relative noise, and some rows twice as high as they should be."""
    speeds, friction = exact(contact, **places)
    rng = np.random.default_rng(seed)
    friction *= np.exp(noise * rng.standard_normal(len(speeds)))
    if outliers:
        friction[rng.choice(len(speeds), outliers, replace=False)] *= 2.0
    return measured(speeds, friction)
