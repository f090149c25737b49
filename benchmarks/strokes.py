"""Strokes: the time of a cycle beside that of as many states along a curve, and how often stated errors cover.

``python benchmarks/strokes.py [strokes]`` prints both; lengths, loads, roughness and speeds of the strokes are drawn anew by
the day, so that no setting is made for them.
"""

import datetime
import math
import sys
import time

import numpy as np

import stribeck as sb
from stribeck.numerics.settings import COARSE_RTOL

STEPS = 400  # Steps of a cycle whose time is measured
COARSE, FINE = 80, 320  # Steps of a march whose errors are judged, and of that which judges


def contact(load=0.1, roughness=1e-3, speed=1e-3):
    """Return a contact with given groups, at its largest speed."""
    radius, modulus, width, top = 10e-3, 1e6, 1e-3, 0.1
    force = math.pi / 4 * modulus * width**2 / radius
    viscosity = speed * 4 / (3 * math.pi**2) * force**2 / (top * radius * modulus)
    return sb.LineContact(
        radius=radius,
        modulus=modulus,
        load=force,
        viscosity=viscosity,
        speed=top,
        roughness=roughness * width**2 / radius,
        alpha=1.0,
        beta=0.05 / load**0.5,
        boundary_friction=0.5,
    )


def sine(half_widths):
    """Return a stroke of so many half-widths at the largest speed."""
    return sb.motions.Sine(stroke=half_widths * 1e-3, frequency=0.1 / (math.pi * half_widths * 1e-3))


def cycle_over_states():
    """Return the time of a cycle over that of states along a curve, each solved from its neighbour."""
    one = contact()
    sb.solve(one)
    start = time.process_time()
    sb.stroke(one, sine(40), steps=STEPS, cycles=1)
    cycle = time.process_time() - start
    start = time.process_time()
    speeds = np.geomspace(1e-3, 0.1, STEPS)
    sb.solve_batch(one, speed=speeds, rtol=COARSE_RTOL)
    return cycle, time.process_time() - start


def covered(strokes, seed):
    """Return the share of instants whose stated error covers the difference from a march with more steps, for each number."""
    rng = np.random.default_rng(seed)
    found = []
    for _ in range(strokes):
        ends = ("none", "exit")[rng.integers(2)]
        one = contact(roughness=10 ** rng.uniform(-3, -2), speed=10 ** rng.uniform(-4, -2)).replace(cavitation=ends)
        motion = sine(10 ** rng.uniform(0.9, 2.5))
        coarse, fine = (sb.stroke(one, motion, steps=steps, cycles=1) for steps in (COARSE, FINE))
        row = {}
        for name, error in coarse.errors.items():
            values = getattr(fine, name)[:: FINE // COARSE]
            missed = np.abs(getattr(coarse, name) - values) > error + 1e-6 * np.abs(values).max()
            row[name] = 1 - missed.mean()
        found.append(row)
        print(
            f"{ends:5} {coarse.half_widths:7.1f} half-widths  " + "  ".join(f"{n} {v:.3f}" for n, v in row.items()), flush=True
        )
    return {name: float(np.mean([row[name] for row in found])) for name in found[0]}


if __name__ == "__main__":
    cycle, states = cycle_over_states()
    print(
        f"a cycle of {STEPS} steps: {cycle:.2f} s of CPU; {STEPS} states along a curve: {states:.2f} s; "
        f"ratio {cycle / states:.2f}"
    )
    seed = int(datetime.date.today().strftime("%Y%m%d"))
    print({name: round(value, 3) for name, value in covered(int(sys.argv[1]) if len(sys.argv) > 1 else 10, seed).items()})
