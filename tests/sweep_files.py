"""What the tests of sweeps share: sweep files to write, and stores to compare."""

import re
import sqlite3
from contextlib import closing

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


def kept(store):
    """Return what a store holds of each finished state, by the number of the state; no part of the package reads it."""
    if not store.exists():
        return {}
    with closing(sqlite3.connect(f"{store.as_uri()}?mode=ro", uri=True, timeout=30)) as db:
        made = db.execute("SELECT count(*) FROM sqlite_schema WHERE name = 'states'").fetchone()[0]
        return {row[0]: row[1:] for row in db.execute("SELECT * FROM states")} if made else {}


def lose(store, *states):
    """Take states out of a store, as if they had not been solved."""
    with closing(sqlite3.connect(store)) as db, db:
        db.executemany("DELETE FROM states WHERE state = ?", [(state,) for state in states])


def same_states(one, other):
    """Tell whether two sweeps hold the same numbers and texts, bit by bit."""
    numbers = all(np.array_equal(one.columns[name], other.columns[name], equal_nan=True) for name in one.columns)
    return numbers and (one.outcome, one.message) == (other.outcome, other.message)


def finish(process, seconds):
    """Wait for a sweep; return what it wrote to stdout, and to stderr but for the lines of progress of a slow machine."""
    out, err = process.communicate(timeout=seconds)
    return out, re.sub(r"^stribeck: .* states/s.*\n", "", err, flags=re.MULTILINE)
