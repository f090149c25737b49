"""Cost of a state along a curve with another fluid, cavity or solid, over that of the article's model in the same run.

Usage::

    python benchmarks/fluid_speed.py [--runs 3] [--only NAME]

Curves over the speed group, 1e-5 to 1e-1 at load 0.1 and roughness 1e-4, rtol 1e-6, in the time of one processor: what 80
states more cost, so that cold starts are left out.
"""

from __future__ import annotations

import argparse
import time
from typing import Any

import numpy as np

import stribeck as sb
from stribeck.numerics.threads import one_blas_thread

GROUPS = sb.Groups(1e-3, 0.1, 1e-4)
FEW, MANY = 41, 121
MODELS: dict[str, tuple[dict[str, Any], float]] = {
    "free exit": ({"cavitation": "exit"}, 1.6),
    "Barus": ({"fluid": sb.fluids.Barus(1.0)}, 2.0),
    "layer": ({"solid": sb.solids.Layer(1.0)}, 1.3),
    "effective medium": ({"flow_factors": sb.fluids.EffectiveMedium(2.0)}, 1.3),
    "Eyring": ({"fluid": sb.fluids.Eyring(50.0)}, 3.0),
    "Carreau": ({"fluid": sb.fluids.Carreau(0.02, 0.5)}, 4.0),
}
"""Parts of each model, and the ratio that it may have."""


@one_blas_thread
def seconds(parts: dict[str, Any]) -> float:
    """Return the time of a state along a curve, without that of the cold start."""
    times = []
    for points in (FEW, MANY):
        start = time.process_time()
        curve = sb.stribeck_curve(GROUPS, speed=np.geomspace(1e-5, 1e-1, points), **parts)
        times.append(time.process_time() - start)
        assert curve.outcome.ok, curve.outcome
    return (times[1] - times[0]) / (MANY - FEW)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--only", choices=sorted(MODELS))
    arguments = parser.parse_args()
    print("| model | time of a state over that of the article's, best of runs | allowed |")
    print("|---|---|---|")
    for name, (parts, allowed) in MODELS.items():
        if arguments.only in (None, name):
            ratio = min(seconds(parts) / seconds({}) for _ in range(arguments.runs))
            print(f"| {name} | {ratio:.2f} | {allowed:g} |", flush=True)


if __name__ == "__main__":
    main()
