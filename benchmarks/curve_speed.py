"""Cost of a curve of 101 points, alone and with all its transitions, in units of an LU factorisation of a 300 x 300 matrix.

Speed group 10 to 1e-9 at load 0.1 and roughness 1e-4, one thread; see docs/numerics_tables.md.  CPU time: of five
rounds, each a few factorisations and then a curve, the best curve over the best factorisation.  Both are what the processor
does undisturbed; medians differ by what else runs on it.
"""

from __future__ import annotations

import sys
import time

import numpy as np
from scipy.linalg import lapack

import stribeck as sb
from stribeck.numerics.threads import one_blas_thread

RUNS = 5


@one_blas_thread
def factorisation() -> float:
    """Return the best time of one LU factorisation of a 300 x 300 float64 matrix, of twenty."""
    matrix = np.asfortranarray(np.random.default_rng(300).random((300, 300)))
    times = []
    for _ in range(20):
        copy = matrix.copy(order="F")
        start = time.process_time()
        lapack.dgetrf(copy, overwrite_a=True)
        times.append(time.process_time() - start)
    return min(times)


def curve(rtol: float) -> tuple[float, float, sb.results.StribeckCurve]:
    """Return the time of the curve, that of its minimum and transitions, and the curve."""
    start = time.process_time()
    result = sb.stribeck_curve(load=0.1, roughness=1e-4, speed=(1e-9, 10.0), points=101, rtol=rtol)
    assert len(result.friction) == len(result.observable("central_gap")) == 101
    middle = time.process_time()
    assert len(result.transitions) == 4
    return middle - start, time.process_time() - middle, result


def main() -> None:
    """Print the table."""
    print("| rtol | curve [ms] | cost [LU(300)] | with transitions | states | error estimate |")
    print("|---|---|---|---|---|---|")
    for rtol in (1e-6, 1e-9):
        rounds = [(factorisation(), curve(rtol)) for _ in range(RUNS)]
        result = rounds[0][1][2]
        assert result.outcome.ok, result.outcome
        lu = min(each for each, _ in rounds)
        alone = min(seconds for _, (seconds, _, _) in rounds)
        whole = min(seconds + more for _, (seconds, more, _) in rounds)
        print(
            f"| {rtol:.0e} | {1e3 * alone:.0f} | {alone / lu:.0f} | {whole / lu:.0f} "
            f"| {result.states} | {result.error_estimate:.1e} |"
        )
    sys.stdout.flush()


if __name__ == "__main__":
    main()
