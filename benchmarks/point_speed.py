"""Cost of states of the point contact: cold, from a neighbour, and along a curve, in units of one LU(1000).

Usage::

    python benchmarks/point_speed.py [--runs 3] [--speeds 25] [--memory-rtol 1e-6] [--states 24]

Times are CPU seconds of one thread, each over that of an LU factorisation of a 1000 x 1000 matrix before and after it;
memory is the largest resident set of a process (Linux).  Other solvers were measured at 7 to 28 s a state, good to 1.4 %
(slippy), and at 10 to 33 s, good to 2 % (EHL-FBNS).
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

import numpy as np
from scipy.linalg import lapack

import stribeck as sb
from stribeck.equations.point.mesh_choice import resolution
from stribeck.equations.point.preconditioner import BandedModes
from stribeck.equations.point.system import Linear, Operators
from stribeck.numerics.threads import one_blas_thread
from stribeck.solver.point.solve import solve_cold, solve_from
from stribeck.solver.point.state import PointState

LOAD, KAPPA = 1e-3, 1e-3
SIZE = 1000


def unit(size: int = SIZE) -> float:
    """Return the CPU seconds of one factorisation, the best of three."""
    matrix = np.random.default_rng(1).normal(size=(size, size))
    return min(timed(lambda: lapack.dgetrf(matrix))[0] for _ in range(3))


def timed(work: Callable[[], PointState | object]) -> tuple[float, object]:
    """Return CPU seconds and result."""
    start = time.process_time()
    found = work()
    return time.process_time() - start, found


def relative(work: Callable[[], PointState], runs: int) -> tuple[float, PointState]:
    """Return the least cost of some runs in units of the factorisations around it, and the state."""
    ratios = []
    for _ in range(runs):
        before = unit()
        seconds, state = timed(work)
        ratios.append(2.0 * seconds / (before + unit()))
    assert isinstance(state, PointState)
    return min(ratios), state


def ball(speed: float, kappa: float = KAPPA) -> sb.Groups:
    """Return the groups of a ball."""
    return sb.Groups(speed, LOAD, kappa * LOAD ** (2 / 3), geometry="point")


def single_states(runs: int) -> None:
    """Print cold states and steps from a neighbour."""
    print("| state | rtol | cost | rings x angles | Newton | GMRES | estimate | minimum film |")
    print("|---|---|---|---|---|---|---|---|")
    for name, groups, rtol in (
        ("cold, mixed, speed 1e-4", ball(1e-4), 1e-6),
        ("cold, mixed, speed 1e-2, 1e-2", ball(1e-2, 1e-2), 1e-6),
        ("cold, smooth, speed 1e-2", ball(1e-2, 0.0), 1e-6),
        ("cold, smooth, speed 1e-3", ball(1e-3, 0.0), 1e-6),
    ):
        report(name, rtol, *relative(lambda g=groups, r=rtol: solve_cold(g, r), runs))
    near = solve_cold(ball(1e-4), 1e-6)
    report("neighbour, mixed, speed 1.2e-4", 1e-6, *relative(lambda: solve_from(near, ball(1.2e-4), 1e-6), runs))


def report(name: str, rtol: float, cost: float, state: PointState) -> None:
    """Print a row."""
    nodes, errors = f"{state.mesh.rings} x {state.mesh.modes}", f"{state.error_estimate:.0e} | {state.minimum_gap_error:.0e}"
    print(f"| {name} | {rtol:.0e} | {cost:.1f} | {nodes} | {state.newton_steps} | {state.krylov_steps} | {errors} |")


def curve(count: int) -> None:
    """Print the cost of curves from full film to boundary lubrication, and the largest errors of their points."""
    print("\n| curve | rtol | states | cost | with transitions | largest estimate | of the minimum film |")
    print("|---|---|---|---|---|---|---|")
    for points, rtol in ((count, 1e-5), (101, 1e-5), (101, 1e-6)):

        def trace(points: int = points, rtol: float = rtol) -> sb.results.StribeckCurve:
            return sb.stribeck_curve(ball(1.0), speed=(1e-7, 10.0), points=points, rtol=rtol)

        before = unit()
        seconds, found = timed(trace)
        assert isinstance(found, sb.results.StribeckCurve)
        marks, _ = timed(lambda found=found: found.transitions)
        one = 0.5 * (before + unit())
        film = max(solution.minimum_gap_error for solution in found.solutions)
        told = f"{found.states} | {seconds / one:.0f} | {(seconds + marks) / one:.0f} | {found.error_estimate:.0e}"
        print(f"| {points} speeds from 10 to 1e-7 | {rtol:.0e} | {told} | {film:.0e} |")


def breakdown(runs: int) -> None:
    """Print what the parts of a step cost on the mesh of a mixed state."""
    state = solve_cold(ball(1e-4), 1e-6)
    fine = state.work.fine
    linear = Linear(fine.equations, fine.unknowns)
    found = resolution(1e-4, fine.equations.law, state.mesh.degree, state.mesh.modes)
    preconditioner = BandedModes(linear, 5)
    right = linear.right(fine.equations.residual(fine.unknowns))
    parts = {
        "operators of the half-space": lambda: Operators(found.mesh).deflection,
        "preconditioner": lambda: BandedModes(linear, 5),
        "its application": lambda: preconditioner(right),
        "product with the Jacobian": lambda: linear.product(right),
        "residual": lambda: fine.equations.residual(fine.unknowns),
    }
    print(f"\n| part, on {state.mesh.rings} x {state.mesh.modes} nodes | cost |\n|---|---|")
    for name, work in parts.items():
        print(f"| {name} | {min(timed(work)[0] for _ in range(2 * runs + 1)) / unit():.3f} |")


@one_blas_thread
def peak(groups: sb.Groups, rtol: float) -> float:
    """Return the largest memory that a process had after one cold state [MB]; in a fresh process it is that state's."""
    solve_cold(groups, rtol)
    # Not ru_maxrss, which a process inherits from the one that started it.
    status = dict(line.split(":", 1) for line in Path("/proc/self/status").read_text().splitlines())
    return 1e-3 * float(status["VmHWM"].split()[0])


def processes(count: int) -> ProcessPoolExecutor:
    """Return fresh processes."""
    return ProcessPoolExecutor(count, mp_context=get_context("spawn"))


def memory(rtol: float) -> None:
    """Print the memory of fresh processes, one a state."""
    print("\n| state, in a process of its own | rtol | most memory [MB] |\n|---|---|---|")
    for name, groups in (
        ("the package alone", ball(0.0, 0.1)),
        ("mixed, speed 1e-4", ball(1e-4)),
        ("mixed, speed 1e-6, kappa 1e-5", ball(1e-6, 1e-5)),
        ("smooth, speed 1e-3", ball(1e-3, 0.0)),
        ("smooth, speed 1e-5", ball(1e-5, 0.0)),
    ):
        with processes(1) as pool:
            print(f"| {name} | {rtol:.0e} | {pool.submit(peak, groups, rtol).result():.0f} |")


def side_by_side(states: int) -> None:
    """Print how much sooner two processes solve states than one."""
    groups = [ball(speed) for speed in np.geomspace(1e-4, 1e-2, states).tolist()]
    seconds = []
    for count in (1, 2):
        with processes(count) as pool:
            list(pool.map(peak, [groups[0]] * count, [1e-2] * count))  # both have started
            start = time.perf_counter()
            list(pool.map(peak, groups, [1e-6] * states))
            seconds.append(time.perf_counter() - start)
    print("\n| cold mixed states | one process [s] | two [s] | gain |\n|---|---|---|---|")
    print(f"| {states} | {seconds[0]:.2f} | {seconds[1]:.2f} | {seconds[0] / seconds[1]:.2f} |")


@one_blas_thread
def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--speeds", type=int, default=25)
    parser.add_argument("--memory-rtol", type=float, default=1e-6)
    parser.add_argument("--states", type=int, default=24)
    arguments = parser.parse_args()
    print(f"unit: LU({SIZE}), {1e3 * unit():.0f} ms of CPU time\n")
    single_states(arguments.runs)
    breakdown(arguments.runs)
    curve(arguments.speeds)
    memory(arguments.memory_rtol)
    side_by_side(arguments.states)


if __name__ == "__main__":
    main()
