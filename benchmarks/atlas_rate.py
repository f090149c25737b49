"""States per second of the atlas, one core: friction, its derivatives, a film; random states over the whole box.

The table that docs/atlas.md shows.
"""

from __future__ import annotations

import argparse
import platform
import time
from collections.abc import Callable

import numpy as np

import stribeck as sb
from stribeck.numerics.threads import one_blas_thread

STATES = 1_000_000
RUNS = 5


def states(number: int) -> sb.Groups:
    """Return random states in the box, evenly distributed in the logarithms."""
    rng = np.random.default_rng(31415)
    speed, load, kappa = (np.exp(rng.uniform(*np.log(ends), number)) for ends in sb.atlas.BOX.values())
    return sb.Groups(speed, load, kappa * load)


def best(function: Callable[[sb.Groups], object], groups: sb.Groups) -> float:
    """Return the smallest processor time of some runs."""
    times = []
    for _ in range(RUNS):
        start = time.process_time()
        function(groups)
        times.append(time.process_time() - start)
    return min(times)


@one_blas_thread
def main() -> None:
    """Print the table."""
    arguments = argparse.ArgumentParser(description="States per second of the atlas.")
    arguments.add_argument("--number", type=int, default=STATES, help=f"states (default {STATES})")
    number = arguments.parse_args().number
    print(f"Python {platform.python_version()}, NumPy {np.__version__}, {platform.machine()}\n")
    groups = states(number)
    sb.atlas.friction(sb.Groups(1e-3, 0.1, 1e-4))
    print("| function | states per second | us per state |")
    print("|---|---|---|")
    for function in (sb.atlas.friction, sb.atlas.friction_derivatives, sb.atlas.minimum_gap):
        seconds = best(function, groups)
        print(f"| `{function.__name__}` | {number / seconds:.3g} | {seconds / number * 1e6:.2f} |")


if __name__ == "__main__":
    main()
