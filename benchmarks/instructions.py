"""Instructions of three cases, counted by valgrind: they repeat where times do not.

Usage::

    python benchmarks/instructions.py [--points 101]

Each case runs once and twice in a process of its own; the difference is what one run costs once the tables that are made at
first use exist.  Takes a few minutes; needs valgrind, and says so
without it.
"""

from __future__ import annotations

import argparse
import os
import re
import shutil
import subprocess
import sys

CURVE = "sb.stribeck_curve(load=0.1, roughness=1e-4, speed=(1e-9, 10.0), points={}, rtol={})"
POINTS = 101
PREPARATION = """
import numpy as np
import stribeck as sb
from scipy.linalg import lapack
matrix = np.asfortranarray(np.random.default_rng(300).random((300, 300)))
"""


def cases(points: int) -> dict[str, str]:
    """Return the statement of each case."""
    return {
        f"curve of {points} speeds, rtol 1e-6": CURVE.format(points, 1e-6),
        f"curve of {points} speeds, rtol 1e-9": CURVE.format(points, 1e-9),
        "cold start (speed 1e-5, load 0.1, roughness 1e-4), rtol 1e-6": "sb.solve(sb.Groups(1e-5, 0.1, 1e-4), rtol=1e-6)",
        "LU factorisation of a 300 x 300 matrix": "lapack.dgetrf(matrix)",
    }


def instructions(statement: str, runs: int) -> int:
    """Return the instructions of a process that executes a statement some times."""
    program = f"{PREPARATION}\nfor _ in range({runs}):\n    {statement}\n"
    tool = ["valgrind", "--tool=cachegrind", "--cache-sim=no", "--cachegrind-out-file=/dev/null"]
    environment = os.environ | {"OPENBLAS_NUM_THREADS": "1", "PYTHONHASHSEED": "0"}
    run = subprocess.run([*tool, sys.executable, "-c", program], capture_output=True, text=True, check=True, env=environment)
    found = re.search(r"I\s+refs:\s+([0-9,]+)", run.stderr)
    assert found is not None, run.stderr
    return int(found[1].replace(",", ""))


def main() -> None:
    """Print the table."""
    arguments = argparse.ArgumentParser(description="Instructions of three cases, counted by valgrind.")
    arguments.add_argument("--points", type=int, default=POINTS, help=f"points of the curves (default {POINTS})")
    points = arguments.parse_args().points
    if shutil.which("valgrind") is None:
        print("not run: there is no valgrind; apt-get install valgrind")
        return
    print("| case | instructions [millions] |")
    print("|---|---:|")
    for name, statement in cases(points).items():
        print(f"| {name} | {(instructions(statement, 2) - instructions(statement, 1)) / 1e6:.0f} |", flush=True)


if __name__ == "__main__":
    main()
