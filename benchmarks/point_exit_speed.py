"""Cost of a state of a ball whose film ends at ambient pressure along a curve, over that of the full film.

Usage::

    python benchmarks/point_exit_speed.py [--points 25] [--kappa 0.1] [--rtol 1e-4] [--loads 1e-3 ...] [--speeds 1 ...]

Each curve goes down from a speed by a factor of 1.19 from state to state.  States are solved from those before them, each
beside its twin of the full film at the same speed, in the time of one processor; all changes of mesh count, the first state of
either does not.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import replace

import numpy as np

import stribeck as sb
from stribeck.contacts.with_parts import with_parts
from stribeck.numerics.threads import one_blas_thread
from stribeck.solver.neighbours import Neighbours

FACTOR = 1.19


def ratio(groups: sb.Groups, fastest: float, points: int, rtol: float) -> tuple[float, float, int, int]:
    """Return the cost of a curve over that of the full film, the median cost of a state so, meshes, and states that failed."""
    chains, taken, meshes, failed = (
        [(each, Neighbours(rtol)) for each in (with_parts(groups, cavitation="exit"), groups)],
        [],
        0,
        0,
    )
    last = None
    for k in range(points):
        seconds = []
        for which, (one, neighbours) in enumerate(chains):
            start = time.process_time()
            state = neighbours.at(replace(one, speed=fastest * FACTOR**-k))
            seconds.append(time.process_time() - start)
            if which == 0:
                failed += not state.outcome.ok
                meshes += state.mesh is not last
                last = state.mesh
        taken.append(seconds)
    own, full = np.array(taken)[1:].T
    return float(own.sum() / full.sum()), float(np.median(own) / np.median(full)), meshes, failed


@one_blas_thread
def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--points", type=int, default=25)
    parser.add_argument("--kappa", type=float, default=0.1)
    parser.add_argument("--rtol", type=float, default=1e-4)
    parser.add_argument("--loads", type=float, nargs="+", default=[1e-3, 1e-2, 0.1, 1.0])
    parser.add_argument("--speeds", type=float, nargs="+", default=[1.0, 0.1, 0.01])
    arguments = parser.parse_args()
    print("| load | from speed | cost over the full film's | median state | meshes | not solved |\n|---|---|---|---|---|---|")
    for load in arguments.loads:
        for speed in arguments.speeds:
            groups = sb.Groups(speed, load, arguments.kappa * load ** (2 / 3), geometry="point")
            whole, state, meshes, failed = ratio(groups, speed, arguments.points, arguments.rtol)
            print(f"| {load:g} | {speed:g} | {whole:.1f} | {state:.1f} | {meshes} | {failed} |", flush=True)


if __name__ == "__main__":
    main()
