"""Cost of a curve of 101 states, as a ratio to one LU factorisation of a 300 x 300 matrix in the same run.

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


def curve(rtol: float) -> tuple[float, sb.StribeckCurve]:
    """Return the time of the curve and the curve."""
    start = time.perf_counter()
    result = sb.stribeck_curve(load=0.1, roughness=1e-4, speed=(1e-9, 10.0), points=101, rtol=rtol)
    return time.perf_counter() - start, result


def main() -> None:
    """Print the table."""
    print(f"Python {platform.python_version()}, NumPy {np.__version__}, SciPy {scipy.__version__}, {platform.machine()}\n")
    print("| rtol | curve [ms] | LU(300) [ms] | ratio (best of runs) | ratio (median) | largest N | largest error estimate |")
    print("|---|---|---|---|---|---|---|")
    for rtol in (1e-6, 1e-9):
        ratios, times, lus = [], [], []
        for _ in range(RUNS):
            lu = factorisation()
            seconds, result = curve(rtol)
            assert result.outcome.ok, result.outcome
            ratios.append(seconds / lu)
            times.append(seconds)
            lus.append(lu)
        nodes = max(s.nodes for s in result.solutions)
        print(
            f"| {rtol:.0e} | {1e3 * min(times):.0f} | {1e3 * statistics.median(lus):.2f} | {min(ratios):.0f} "
            f"| {statistics.median(ratios):.0f} | {nodes} | {result.error_estimate:.1e} |"
        )
    sys.stdout.flush()


if __name__ == "__main__":
    main()
