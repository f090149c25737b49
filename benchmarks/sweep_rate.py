"""States per second of a sweep in one process and in several, each state written to the store.

Random states over six decades of speed, 1.7 of load, two of roughness at rtol 1e-6.  The rate counts from the first to the
last state, so that the start of the processes, about a second once, does not hide in it; it is shown beside.  So is the
processor time of a state, all processes together, which other work on the machine does not change much.

    python benchmarks/sweep_rate.py --number 8192 --workers 2 4
"""

from __future__ import annotations

import argparse
import os
import platform
import resource
import tempfile
import time
from pathlib import Path

import numpy as np
import scipy

import stribeck as sb

DESIGN = """
[groups]

[design]
kind = "random"
points = {number}
seed = 10000

[vary]
speed = {{ range = [1e-6, 1.0] }}
load = {{ range = [0.01, 0.5] }}
roughness = {{ range = [1e-4, 1e-2] }}
"""


def processor_time() -> float:
    """Return the processor time of this process and of those that it started and that have ended [s]."""
    return sum(sum(resource.getrusage(who)[:2]) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))


def measure(file: Path, store: Path, workers: int) -> tuple[float, float, float, int]:
    """Return states per second while the workers work, over the whole run, processor time of a state, failed states."""
    marks: list[tuple[float, int]] = []
    begin, used = time.perf_counter(), processor_time()
    found = sb.sweep(file, store, workers=workers, on_progress=lambda state: marks.append((time.perf_counter(), state.done)))
    end = time.perf_counter()
    first = next(mark for mark in marks if mark[1] > 0)
    last = marks[-1]
    if first == last:
        raise SystemExit(f"all states came at once: {len(found)} are too few for {workers} processes; give a larger --number")
    return (
        (last[1] - first[1]) / (last[0] - first[0]),
        len(found) / (end - begin),
        (processor_time() - used) / len(found),
        found.failed,
    )


def main() -> None:
    """Print the table."""
    arguments = argparse.ArgumentParser(description="States per second of a sweep.")
    arguments.add_argument("--number", type=int, default=1000, help="states (default 1000)")
    arguments.add_argument(
        "--workers", type=int, nargs="+", default=[os.cpu_count() or 1], help="processes (default: the cores)"
    )
    arguments.add_argument("--folder", type=Path, default=None, help="where the stores go (default: a temporary folder)")
    given = arguments.parse_args()
    print(
        f"Python {platform.python_version()}, NumPy {np.__version__}, SciPy {scipy.__version__}, {platform.machine()}, ",
        end="",
    )
    print(f"{os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}, {given.number} states\n")
    print("| processes | states per second | with the start | over one process | per process | processor time [ms] | failed |")
    print("|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory(dir=given.folder) as folder:
        file = Path(folder) / "sweep.toml"
        file.write_text(DESIGN.format(number=given.number))
        alone = 0.0
        for workers in [1, *(number for number in given.workers if number > 1)]:
            rate, whole, used, failed = measure(file, Path(folder) / f"store-{workers}", workers)
            alone = alone or rate
            ratio = rate / alone
            print(
                f"| {workers} | {rate:.1f} | {whole:.1f} | {ratio:.2f} | {ratio / workers:.2f} "
                f"| {1e3 * used:.2f} | {failed} |",
                flush=True,
            )


if __name__ == "__main__":
    main()
