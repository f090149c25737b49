"""Cost of single states against accuracy and against 1/kappa, in units of one LU factorisation of a 300 x 300 matrix.

Usage::

    python benchmarks/cost.py [--runs 5]

Prints two tables.  Times are the best of several runs, one thread.
"""

from __future__ import annotations

import argparse
import time

from curve_speed import factorisation

import stribeck as sb

RUNS = 5
TOLERANCES = (1e-4, 1e-6, 1e-9)
STATES = {"hydrodynamic": (1.0, 0.1, 1e-4), "mixed": (1e-5, 0.1, 1e-4), "boundary": (1e-8, 0.1, 1e-2)}


def cost(groups: sb.Groups, rtol: float, runs: int) -> tuple[float, sb.results.Solution]:
    """Return the cost of a cold solve in units of the factorisation, and its solution."""
    ratios = []
    for _ in range(runs):
        unit = factorisation()
        start = time.perf_counter()
        solution = sb.solve(groups, rtol=rtol, on_failure="return")
        ratios.append((time.perf_counter() - start) / unit)
    return min(ratios), solution


def main() -> None:
    """Print the tables."""
    arguments = argparse.ArgumentParser(description="Cost of single states.")
    arguments.add_argument("--runs", type=int, default=RUNS, help=f"runs of which the best counts (default {RUNS})")
    runs = arguments.parse_args().runs
    print("| state | rtol | unknowns | estimate | cost [LU(300)] |")
    print("|---|---:|---:|---:|---:|")
    for name, numbers in STATES.items():
        for rtol in TOLERANCES:
            ratio, solution = cost(sb.Groups(*numbers), rtol, runs)
            print(f"| {name} | {rtol:.0e} | {solution.nodes} | {solution.error_estimate:.1e} | {ratio:.0f} |", flush=True)
    print()
    print("| kappa | unknowns | cost [LU(300)] |")
    print("|---:|---:|---:|")
    for exponent in range(0, 7, 2):
        kappa = 10.0**-exponent
        ratio, solution = cost(sb.Groups(0.0, 0.01, 0.01 * kappa), 1e-6, runs)
        print(f"| {kappa:.0e} | {solution.nodes} | {ratio:.0f} |", flush=True)


if __name__ == "__main__":
    main()
