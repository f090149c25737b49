"""Cost of a state along a curve with another fluid, cavity or solid, over that of the article's model in the same run.

Usage::

    python benchmarks/fluid_speed.py [--runs 3] [--only NAME]

Curves over the speed group, 1e-5 to 1e-1 at load 0.1 and roughness 1e-4, rtol 1e-6, in the time of one processor.  A curve
solves as many states as it needs, so that the time of the whole curve and that over the states solved are both given.
"""

from __future__ import annotations

import argparse
import time
from typing import Any

import numpy as np

import stribeck as sb
from stribeck.numerics.threads import one_blas_thread

GROUPS = sb.Groups(1e-3, 0.1, 1e-4)
POINTS = 41
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
def seconds(parts: dict[str, Any]) -> tuple[float, int]:
    """Return the time of a curve, its cold start included, and the states that it solved."""
    start = time.process_time()
    curve = sb.stribeck_curve(GROUPS, speed=np.geomspace(1e-5, 1e-1, POINTS), points=POINTS, **parts)
    curve.friction  # noqa: B018
    assert curve.outcome.ok, curve.outcome
    return time.process_time() - start, len(curve._function.expansions)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--only", choices=sorted(MODELS))
    arguments = parser.parse_args()
    print("| model | states | time of a curve over that of the article's | of a state, best of runs | allowed |")
    print("|---|---|---|---|---|")
    seconds({})
    for name, (parts, allowed) in MODELS.items():
        if arguments.only in (None, name):
            runs = [(seconds(parts), seconds({})) for _ in range(arguments.runs)]
            (own, states), (plain, known) = min(runs, key=lambda run: run[0][0] / run[1][0])
            ratio = own / plain
            print(f"| {name} | {states} ({known}) | {ratio:.1f} | {ratio * known / states:.1f} | {allowed:g} |", flush=True)


if __name__ == "__main__":
    main()
