"""Cost of single states by part, against accuracy and against 1/kappa, in units of one LU factorisation of a 300 x 300 matrix.

Usage::

    python benchmarks/cost.py [--runs 5]

Prints the tables that docs/numerics_tables.md shows.  Times are the best of several runs, one thread.
"""

from __future__ import annotations

import argparse
import math
import time
from collections.abc import Callable

from curve_speed import factorisation
from scipy.linalg import lapack

import stribeck as sb
from stribeck.equations.error_estimate import FineOperators
from stribeck.equations.line import Operators
from stribeck.equations.mesh_choice import mesh_for
from stribeck.equations.state import solve_state
from stribeck.numerics.threads import one_blas_thread
from stribeck.solver.cold_start import cold_start
from stribeck.solver.refinement import mesh_tolerances_for, order_for, values_of, verify

RUNS = 5
TOLERANCES = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9)
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


def best(part: Callable[[], object], runs: int) -> float:
    """Return the shortest time of many runs."""
    times = []
    for _ in range(10 * runs):
        start = time.perf_counter()
        part()
        times.append(time.perf_counter() - start)
    return min(times)


@one_blas_thread
def parts(groups: sb.Groups, rtol: float, runs: int) -> list[str]:
    """Return the rows of the table of what the parts of a state cost."""
    guess = cold_start(groups).states[-1]
    law, order, tolerances = guess.equations.law, order_for(rtol), mesh_tolerances_for(rtol)
    mesh = mesh_for(guess, groups, law, order, *tolerances)
    operators, fine = Operators(mesh), FineOperators(mesh)
    state = solve_state(groups, operators, guess, 1e-2 * rtol)
    equations, y = state.equations, state.y
    jacobian = equations.jacobian(y, equations.units(y))
    factors = lapack.dgetrf(jacobian)[:2]
    residual = equations.residual(y)
    made = {
        "residual": lambda: equations.residual(y),
        "Jacobian": lambda: equations.jacobian(y, equations.units(y)),
        "its factorisation": lambda: lapack.dgetrf(jacobian),
        "solve with its factors": lambda: lapack.dgetrs(*factors, residual),
        "observables": lambda: values_of(state, groups),
        "observables and error estimate": lambda: verify(state, groups, fine, rtol),
        "choice of a mesh": lambda: mesh_for(state, groups, law, order, *tolerances),
        "operators of a mesh": lambda: Operators(mesh).deflection_of_gradient,
    }
    unit = factorisation()
    times = {name: best(part, runs) for name, part in made.items()}
    return [f"| {name} | {mesh.size} | {1e6 * s:.0f} | {s / unit:.2f} |" for name, s in times.items()]


def main() -> None:
    """Print the tables."""
    arguments = argparse.ArgumentParser(description="Cost of single states by part.")
    arguments.add_argument("--runs", type=int, default=RUNS, help=f"runs of which the best counts (default {RUNS})")
    runs = arguments.parse_args().runs
    print("| part | unknowns | us | LU(300) |")
    print("|---|---:|---:|---:|")
    for rtol in (1e-6, 1e-9):
        for row in parts(sb.Groups(*STATES["mixed"]), rtol, runs):
            print(row, flush=True)
    print()
    print("| state | rtol | unknowns | estimate | cost [LU(300)] |")
    print("|---|---:|---:|---:|---:|")
    for name, numbers in STATES.items():
        for rtol in TOLERANCES:
            ratio, solution = cost(sb.Groups(*numbers), rtol, runs)
            print(f"| {name} | {rtol:.0e} | {solution.nodes} | {solution.error_estimate:.1e} | {ratio:.0f} |", flush=True)
    print()
    print("| kappa | log2(1/kappa) | unknowns | cost [LU(300)] |")
    print("|---:|---:|---:|---:|")
    for exponent in range(7):
        kappa = 10.0**-exponent
        ratio, solution = cost(sb.Groups(0.0, 0.01, 0.01 * kappa), 1e-6, runs)
        print(f"| {kappa:.0e} | {math.log2(1 / kappa):.1f} | {solution.nodes} | {ratio:.0f} |", flush=True)


if __name__ == "__main__":
    main()
