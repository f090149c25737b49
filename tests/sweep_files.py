"""What the tests of sweeps share: sweep files to write, and stores to compare."""

import os
import re

import numpy as np

CONTACT = """
[contact]
radius = "10 mm"
modulus = "2.7 MPa"
viscosity = "50 mPa*s"
alpha = 2.0
beta = 0.06
boundary_friction = 0.7
"""

GRID = """
[groups]
boundary_friction = 0.8
beta = 0.05

[vary]
load = [0.1, 0.2]
roughness = [1e-4, 1e-3]
speed = { range = [1e-5, 1e-1], points = 17 }
"""

RANDOM = """
[groups]

[design]
kind = "{kind}"
points = {points}
seed = 20261

[vary]
speed = {{ range = [1e-6, 1.0] }}
load = {{ range = [0.01, 0.5] }}
roughness = {{ range = [1e-4, 1e-2] }}
"""


def write(folder, text, name="sweep.toml"):
    """Write a sweep file and return its path."""
    path = folder / name
    path.write_text(text)
    return path


def chunks(store):
    """Return the chunks of the states of a store: by their path, when they were written, and what they hold."""
    found = {}
    for array in ("values", "text", "done"):
        for name in os.listdir(store / array):
            if name.startswith("c."):
                path = store / array / name
                found[f"{array}/{name}"] = path.stat().st_mtime_ns, path.read_bytes()
    return found


def done_rows(store):
    """Return the numbers of the states that have their flag."""
    return {int(name[2:]) for name in os.listdir(store / "done") if name.startswith("c.")}


def same_rows(one, other):
    """Tell whether two sweeps hold the same numbers and texts, bit by bit."""
    return np.array_equal(one.rows.values, other.rows.values, equal_nan=True) and one.rows.texts == other.rows.texts


def finish(process, seconds):
    """Wait for a sweep; return what it wrote to stdout, and to stderr but for the lines of progress of a slow machine."""
    out, err = process.communicate(timeout=seconds)
    return out, re.sub(r"^stribeck: [0-9]+ of [0-9]+ states, .* states/s.*\n", "", err, flags=re.MULTILINE)
