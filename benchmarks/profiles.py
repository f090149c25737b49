"""Random bodies that are no cylinder: how many states are solved, whether errors are covered, and the time over a cylinder's.

Usage::

    python benchmarks/profiles.py [--states 200] [--first 0]

A shape is a lip of random slopes with a rounded tip, to which up to three parabolas are added that begin at kinks of the
curvature.  Each state is solved at ``rtol=1e-6`` and compared with ``rtol=1e-9``; its time is that over the state of the
cylinder with the same groups.
"""

from __future__ import annotations

import argparse
import math
import time
from dataclasses import dataclass
from typing import Any

import numpy as np

import stribeck as sb

RTOL, FINE_RTOL = 1e-6, 1e-9
OBSERVED = ("contact_load_share", "fluid_load_share", "central_gap", "minimum_gap", "flux_gap", "viscous_balanced")


@dataclass(frozen=True)
class Random:
    """A lip with slopes to both sides, a rounding and parabolas that begin at kinks."""

    left: float
    right: float
    rounding: float
    kinks: tuple[tuple[float, float, float], ...]  # Place, side and curvature of each
    reversed: bool

    @property
    def places(self) -> tuple[float, ...]:
        """The kinks."""
        return tuple(place for place, _, _ in self.kinks)

    @property
    def parameters(self) -> dict[str, float | str]:
        """Slopes and rounding."""
        return {"left": self.left, "right": self.right, "rounding": self.rounding}

    def gap(self, x: np.ndarray) -> np.ndarray:
        """Return the gap."""
        tilt, mean = 0.5 * (self.right - self.left), 0.5 * (self.right + self.left)
        found = tilt * x + mean * (np.hypot(x, self.rounding) - self.rounding)
        for place, side, curvature in self.kinks:
            found = found + 0.5 * curvature * np.maximum(side * (x - place), 0.0) ** 2
        return found

    def slope(self, x: np.ndarray) -> np.ndarray:
        """Return its slope."""
        tilt, mean = 0.5 * (self.right - self.left), 0.5 * (self.right + self.left)
        found = tilt + mean * x / np.hypot(x, self.rounding)
        for place, side, curvature in self.kinks:
            found = found + side * curvature * np.maximum(side * (x - place), 0.0)
        return found


def contact_of(random: np.random.Generator) -> dict[str, Any]:
    """Return a random contact with unit scales of load and modulus."""
    kinks = [
        (random.uniform(-0.9, 0.9), random.choice([-1.0, 1.0]), 10 ** random.uniform(-1, 0.7))
        for _ in range(random.integers(0, 4))
    ]
    slopes, rounding = 10 ** random.uniform(-1, 0.3, 2), 10 ** random.uniform(-1.3, 0.3)
    shape = Random(*map(float, slopes), float(rounding), tuple(kinks), bool(random.integers(2)))
    return {
        "profile": shape,
        "modulus": 2.0,
        "load": 0.5 * math.pi,
        "viscosity": 10 ** random.uniform(-6, 0) / 6,
        "speed": 1.0,
        "roughness": 10 ** random.uniform(-4, -1.5),
        "alpha": 1.0,
        "beta": 10 ** random.uniform(-0.3, 1.0),
        "boundary_friction": 0.5,
        "cavitation": str(random.choice(["exit", "exit", "none"])),
    }


def solved(problem: Any, rtol: float, **parts: Any) -> tuple[Any, float]:
    """Return a state and its time; None where there is none."""
    start = time.process_time()
    try:
        found = sb.solve(problem, rtol=rtol, **parts)
    except sb.SolveError as problem_of:
        return problem_of, time.process_time() - start
    return found, time.process_time() - start


def covered(state: Any, fine: Any) -> bool:
    """Return whether all observables are within their stated errors and those of the finer state."""
    for name in OBSERVED:
        exact = getattr(fine, name)
        scale = 1.0 if name.endswith("share") else abs(exact)
        if abs(getattr(state, name) - exact) > (state.errors[name] + fine.errors[name]) * scale:
            return False
    return True


def main() -> None:
    """Print a line for each failure, and the counts."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--states", type=int, default=200)
    parser.add_argument("--first", type=int, default=0)
    given = parser.parse_args()
    count = good = compared = within = 0
    ratios = []
    for number in range(given.first, given.first + given.states):
        contact = sb.LineContact(**contact_of(np.random.default_rng([2036, number])))
        count += 1
        about = f"{contact.cavitation} {contact.groups.speed:.2g} {contact.profile}"
        state, seconds = solved(contact, RTOL)
        if isinstance(state, sb.SolveError):
            print(f"{number}: {about} {str(state)[-140:]}", flush=True)
            continue
        good += 1
        groups = contact.groups
        cylinder = sb.Groups(groups.speed, groups.load, groups.roughness)
        of_cylinder, least = solved(cylinder, RTOL, cavitation=str(contact.cavitation))
        if not isinstance(of_cylinder, sb.SolveError):
            ratios.append(seconds / least)
        fine, _ = solved(contact, FINE_RTOL)
        if not isinstance(fine, sb.SolveError):
            compared += 1
            within += covered(state, fine)
            if not covered(state, fine):
                print(f"{number}: error exceeded, {about}", flush=True)
    print(f"{good} of {count} solved, errors cover {within} of {compared}")
    print(f"time over that of the cylinder: median {np.median(ratios):.2g}, largest {np.max(ratios):.2g}")


if __name__ == "__main__":
    main()
