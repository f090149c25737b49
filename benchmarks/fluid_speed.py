"""Cost of a state along a curve with another fluid, cavity or solid, over that of the article's model in the same run.

Usage::

    python benchmarks/fluid_speed.py [--runs 7] [--only NAME]

Speed group 1e-5 to 1e-1 at load 0.1 and roughness 1e-4, rtol 1e-6, in the time of one processor.  A state along a curve is one
of 41, all models at the same speeds, solved from those before it on their mesh for as long as that serves, and verified: the
first is not counted.  Each is timed beside that of the article's model at the same speed, in runs that begin at other speeds.
A whole curve takes as many states as its series need, and has its cold start in it.
"""

from __future__ import annotations

import argparse
import math
import statistics
import time
from dataclasses import replace
from typing import Any

import numpy as np

import stribeck as sb
from stribeck.contacts.with_parts import with_parts
from stribeck.numerics.threads import one_blas_thread
from stribeck.solver.neighbours import Neighbours

GROUPS = sb.Groups(1e-3, 0.1, 1e-4)
POINTS = 41

MODELS: dict[str, dict[str, Any]] = {
    "free exit": {"cavitation": "exit"},
    "Barus": {"fluid": sb.fluids.Barus(1.0)},
    "layer": {"solid": sb.solids.Layer(1.0)},
    "effective medium": {"flow_factors": sb.fluids.EffectiveMedium(2.0)},
    "Eyring": {"fluid": sb.fluids.Eyring(50.0)},
    "Carreau": {"fluid": sb.fluids.Carreau(0.02, 0.5)},
}
"""Parts of each model."""


class Chain:
    """States one after another, each solved from those before it."""

    def __init__(self, parts: dict[str, Any]) -> None:
        self.groups, self.neighbours = with_parts(GROUPS, **parts), Neighbours(1e-6)

    def seconds(self, s: float) -> float:
        """Return the time of the state at ``s``."""
        start = time.process_time()
        point = self.neighbours.at(replace(self.groups, speed=math.exp(s)))
        taken = time.process_time() - start
        assert point.outcome.ok
        return taken


@one_blas_thread
def ratio_of_states(parts: dict[str, Any], shift: float) -> float:
    """Return the time of the states of a model over that of the article's, each beside its twin: what else runs slows both.

    All are shifted by a part of the distance between two: whether a mesh serves one more of them is chance.
    """
    chains = Chain(parts), Chain({})
    places = np.linspace(0.0, -4 * math.log(10.0), POINTS)
    places += math.log(1e-1) + shift * (places[1] - places[0])
    taken = np.array([[chain.seconds(s) for chain in chains] for s in places.tolist()])
    own, plain = taken[1:].sum(axis=0)
    return float(own / plain)


@one_blas_thread
def seconds(parts: dict[str, Any]) -> float:
    """Return the time of a curve, its cold start included."""
    start = time.process_time()
    curve = sb.stribeck_curve(GROUPS, speed=np.geomspace(1e-5, 1e-1, POINTS), points=POINTS, **parts)
    curve.friction  # noqa: B018
    assert curve.outcome.ok, curve.outcome
    return time.process_time() - start


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=7)
    parser.add_argument("--only", choices=sorted(MODELS))
    arguments = parser.parse_args()
    print("| model | a state | whole curve |")
    print("|---|---|---|")
    seconds({})
    for name, parts in MODELS.items():
        if arguments.only in (None, name):
            ratios = [ratio_of_states(parts, k / arguments.runs) for k in range(arguments.runs)]
            curve = statistics.median(seconds(parts) / seconds({}) for _ in range(3))
            print(f"| {name} | {statistics.median(ratios):.2f} | {curve:.1f} |", flush=True)


if __name__ == "__main__":
    main()
