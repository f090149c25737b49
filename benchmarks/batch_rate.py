"""States per second of `solve_batch`, a sweep in one process and single solves, on the same states; table of docs/batch.md.

Three sets of random states at rtol 1e-6: one contact whose inputs scatter by a tenth, a study over six decades of speed,
1.7 of load and two of roughness, and the whole box.  Processor time is counted, of one thread: other work on the machine
changes it less than the time on the clock.

    python benchmarks/batch_rate.py --number 4000
"""

from __future__ import annotations

import argparse
import os
import platform
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

import stribeck as sb

SINGLE = 60
"""States that are solved one by one: a sample, as all would take long."""


def sets(number: int) -> dict[str, sb.Groups]:
    """Return the sets of states by name."""
    rng = np.random.default_rng(60_013)
    contact = np.array([1e-5, 0.1, 1e-4]) * np.exp(0.1 * rng.normal(size=(number, 3)))
    study = 10 ** rng.uniform((-6, -2, -4), (0, np.log10(0.5), -2), size=(number, 3))
    box = 10 ** rng.uniform((-12, -6, -6), (6, 0, 2), size=(max(1, number // 4), 3))
    box[:, 2] *= box[:, 1]
    return {name: sb.Groups(*states.T) for name, states in (("one contact", contact), ("study", study), ("box", box))}


def timed(work: Callable[[], object]) -> tuple[float, object]:
    """Return the processor time of this process [s] and what came out."""
    begin = time.process_time()
    found = work()
    return time.process_time() - begin, found


def sweep_of(groups: sb.Groups) -> sb.results.Sweep:
    """Return the states swept in this process."""
    lists = {name: np.asarray(getattr(groups, name)).tolist() for name in ("speed", "load", "roughness")}
    vary = "\n".join(f"{name} = {values}" for name, values in lists.items())
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "sweep.toml"
        file.write_text(f'[groups]\n[design]\nkind = "list"\n[vary]\n{vary}\n')
        return sb.sweep(file, Path(folder) / "store", workers=1)


def main() -> None:
    """Print the table."""
    arguments = argparse.ArgumentParser(description="States per second of arrays of states.")
    arguments.add_argument("--number", type=int, default=1000, help="states (default 1000; of the box a quarter)")
    number = arguments.parse_args().number
    print(f"Python {platform.python_version()}, NumPy {np.__version__}, {platform.machine()}, ", end="")
    print(f"{os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}; one thread, processor time\n")
    print("| states | how | not converged | ms a state | states per second | over single solves |")
    print("|---|---|---|---|---|---|")
    for name, groups in sets(number).items():
        total = groups.shape[0]
        rows = range(0, total, max(1, total // SINGLE))
        states = [sb.Groups(*(float(getattr(groups, part)[i]) for part in ("speed", "load", "roughness"))) for i in rows]
        single, _ = timed(lambda states=states: [sb.solve(state) for state in states])
        single /= len(states)
        line(f"{name}, {total}", f"`solve`, {len(states)} of them", 0, single, single)
        used, swept = timed(lambda groups=groups: sweep_of(groups))
        line(f"{name}, {total}", "`sweep`, one process", swept.failed, used / total, single)
        used, found = timed(lambda groups=groups: sb.solve_batch(groups))
        line(f"{name}, {total}", "`solve_batch`", int((~found.ok).sum()), used / total, single)


def line(states: str, how: str, failed: int, used: float, single: float) -> None:
    """Print one line of the table."""
    print(f"| {states} | {how} | {failed} | {1e3 * used:.1f} | {1 / used:.0f} | {single / used:.1f} |", flush=True)


if __name__ == "__main__":
    main()
