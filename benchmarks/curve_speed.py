"""Cost of a curve of 101 points, alone and with all its transitions, in units of an LU factorisation of a 300 x 300 matrix.

Speed group 10 to 1e-9 at load 0.1 and roughness 1e-4, one thread; the table that docs/numerics.md shows.
"""

from __future__ import annotations

import platform
import statistics
import sys
import time

import numpy as np
import scipy
from scipy.linalg import lapack

import stribeck as sb
from stribeck.numerics.threads import one_blas_thread

RUNS = 5


@one_blas_thread
def factorisation() -> float:
    """Return the median time of one LU factorisation of a 300 x 300 float64 matrix."""
    matrix = np.asfortranarray(np.random.default_rng(300).random((300, 300)))
    times = []
    for _ in range(60):
        copy = matrix.copy(order="F")
        start = time.perf_counter()
        lapack.dgetrf(copy, overwrite_a=True)
        times.append(time.perf_counter() - start)
    return statistics.median(times)


def curve(rtol: float) -> tuple[float, float, sb.StribeckCurve]:
    """Return the time of the curve, that of its minimum and transitions, and the curve."""
    start = time.perf_counter()
    result = sb.stribeck_curve(load=0.1, roughness=1e-4, speed=(1e-9, 10.0), points=101, rtol=rtol)
    assert len(result.friction) == len(result.observable("central_gap")) == 101
    middle = time.perf_counter()
    assert len(result.transitions) == 4
    return middle - start, time.perf_counter() - middle, result


def main() -> None:
    """Print the table."""
    print(f"Python {platform.python_version()}, NumPy {np.__version__}, SciPy {scipy.__version__}, {platform.machine()}\n")
    print("| rtol | curve [ms] | LU(300) [ms] | ratio (best) | with transitions | states | largest N | error estimate |")
    print("|---|---|---|---|---|---|---|---|")
    for rtol in (1e-6, 1e-9):
        ratios, wholes, times, lus = [], [], [], []
        for _ in range(RUNS):
            lu = factorisation()
            seconds, more, result = curve(rtol)
            assert result.outcome.ok, result.outcome
            ratios.append(seconds / lu)
            wholes.append((seconds + more) / lu)
            times.append(seconds)
            lus.append(lu)
        nodes = max(s.nodes for s in result.solutions[::10])
        print(
            f"| {rtol:.0e} | {1e3 * min(times):.0f} | {1e3 * statistics.median(lus):.2f} | {min(ratios):.0f} "
            f"| {min(wholes):.0f} | {result.states} | {nodes} | {result.error_estimate:.1e} |"
        )
    sys.stdout.flush()


if __name__ == "__main__":
    main()
