"""The explorer beyond the atlas: CPU time from a moved slider to the data of the solved curve, and of the map of regimes.

Line contacts that no atlas holds, each moved by arrow keys of load, roughness and viscosity; the speed moves along the curve
and costs no other one.  All that the server does for a key is counted: the state with its fields, the curve with its
transitions, and both charts.  LU is the time of factorising a 300 x 300 matrix meanwhile: on a busy machine it grows as the
others do.  The finer curve that comes at rest is not counted.
"""

from __future__ import annotations

import argparse
import platform
import statistics
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from curve_speed import factorisation

from stribeck.cases.reading import load_case
from stribeck.curves.result import StribeckCurve
from stribeck.explorer.answer import Answerer
from stribeck.explorer.charts import all_charts
from stribeck.explorer.inputs import inputs
from stribeck.explorer.inputs.choices import choose
from stribeck.explorer.inputs.inputs import Inputs
from stribeck.explorer.server import example
from stribeck.numerics.threads import one_blas_thread

MOVES = 4
STEP = 0.01
SLIDERS = ("load", "roughness", "viscosity")

NITRILE = Path(__file__).parents[1] / "examples" / "nitrile_seal.toml"
CHOSEN = {
    "Greenwood and Williamson": ("law", "greenwood-williamson"),
    "Greenwood and Tripp": ("law", "greenwood-tripp"),
    "both surfaces move": ("motion", "rolling"),
    "Barus": ("viscosity_law", "barus"),
    "Roelands": ("viscosity_law", "roelands"),
    "Eyring": ("fluid", "eyring"),
    "Carreau": ("fluid", "carreau"),
    "Patir and Cheng": ("flow_factors", "patir-cheng"),
    "film re-forms": ("cavitation", "reform"),
    "bonded layer": ("solid", "layer"),
    "viscoelastic": ("solid", "standard-linear-solid"),
}
"""What is chosen on the page for the cylinder with which it begins."""


def contacts() -> dict[str, Inputs]:
    """Return the contacts by name."""
    found = {name: choose(example(), *chosen) for name, chosen in CHOSEN.items()}
    return found | {"nitrile seal, Persson": inputs.from_case(load_case(NITRILE))}


def go_on(*_: object) -> None:
    """Report nothing."""


def shown(model: Answerer, now: Inputs) -> None:
    """Do all that the server does for new inputs, up to the charts of the solved curve."""
    all_charts(model(now))
    list(model.at_rest(now)[0](go_on))
    all_charts(model(now))


def spent(work: Callable[..., object], *arguments: object) -> float:
    """Return the CPU time of a call."""
    start = time.process_time()
    work(*arguments)
    return time.process_time() - start


@one_blas_thread
def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--number", type=int, default=MOVES, help=f"moves of each slider (default {MOVES})")
    parser.add_argument("--contacts", type=int, default=None, help="how many of the contacts (default all)")
    arguments = parser.parse_args()
    print(f"Python {platform.python_version()}, NumPy {np.__version__}, {platform.machine()}\n")
    heads = ("contact", "median, ms", "90 % within, ms", "states", "map: first row, ms", "whole, ms", "LU, ms")
    print(f"| {' | '.join(heads)} |\n{'|---' * len(heads)}|")
    medians, maps = [], []
    for name, now in list(contacts().items())[: arguments.contacts]:
        model, times, units = Answerer(), [], []
        shown(model, now)
        for slider in SLIDERS:
            for _ in range(arguments.number):
                now = inputs.with_slider(now, slider, inputs.position(now, slider) + STEP)
                units.append(factorisation())
                times.append(spent(shown, model, now))
        curve = model(now).curve
        assert curve is not None and isinstance(curve.found, StribeckCurve)
        rows = model.at_rest(now)[2](go_on)
        first = spent(next, rows)
        whole = first + spent(list, rows)
        median, most = statistics.median(times), sorted(times)[int(0.9 * len(times))]
        cells = [f"{1e3 * each:.0f}" for each in (median, most)] + [str(curve.found.states)]
        cells += [f"{1e3 * each:.0f}" for each in (first, whole)] + [f"{1e3 * statistics.median(units):.2f}"]
        print(f"| {name} | {' | '.join(cells)} |", flush=True)
        medians.append(median)
        maps.append(whole)
    print(
        f"\nMedian over contacts: curve {1e3 * statistics.median(medians):.0f} ms, map {1e3 * statistics.median(maps):.0f} ms."
    )


if __name__ == "__main__":
    main()
