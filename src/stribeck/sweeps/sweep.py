"""Many states: solved in this process, on several, or on a cluster, and kept in a store one by one as they finish."""

from __future__ import annotations

import os
import socket
import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from stribeck.batches.order import chains_of
from stribeck.files.writing import PathLike
from stribeck.quantities.keywords import answers_typos
from stribeck.quantities.units import InputError, checked_callback, show
from stribeck.sweeps.chain import Chain
from stribeck.sweeps.dataset import Sweep
from stribeck.sweeps.design import SweepDesign, load_sweep
from stribeck.sweeps.lock import hold_lock
from stribeck.sweeps.rows import read_rows, remove_unfinished
from stribeck.sweeps.runs import log_run
from stribeck.sweeps.store import SweepError, create_or_open, describe_store

__all__ = ["SweepProgress", "sweep"]

MAX_WORKERS = 1024

MAX_REPLACEMENTS = 3  # Times that a killed worker process is replaced in one run

RATE_WINDOW = 60.0  # Time over which the rate is measured [s]


@dataclass(frozen=True)
class SweepProgress:
    """The progress of a sweep.

    Attributes
    ----------
    done : int
        States finished, those of earlier runs included.
    total : int
        States of the design.
    failed : int
        States of this run that did not converge.
    rate : float
        States per second over the last minute; 0 before the first.
    seconds_left : float
        Time left at this rate [s]; infinite before the first.
    """

    done: int
    total: int
    failed: int
    rate: float
    seconds_left: float


@answers_typos
def sweep(
    design: SweepDesign | PathLike,
    out: PathLike,
    *,
    workers: int = 1,
    scheduler: str | None = None,
    on_progress: Callable[[SweepProgress], object] | None = None,
) -> Sweep:
    """Solve all states of a design and store each as it finishes; resume an interrupted run.

    Parameters
    ----------
    design : SweepDesign or str or path-like
        What to solve: what :func:`load_sweep` returns, or the file.
    out : str or path-like
        The store, a folder; made where there is none.
    workers : int
        Processes of this machine; with 1 the states are solved in this process.
    scheduler : str, optional
        Address of a Dask scheduler, such as ``"tcp://node1:8786"``, whose workers solve the states instead.
    on_progress : callable, optional
        ``on_progress(progress)`` is called with a :class:`SweepProgress` as states are finished, and at least twice a second
        where others solve them.  It may raise KeyboardInterrupt.

    Returns
    -------
    Sweep
        All states, those that failed with their outcome; after Ctrl-C those that were finished, ``interrupted``.

    Raises
    ------
    InputError
        If an argument is outside its range, the store holds another sweep, or another run is at it.
    MissingExtraError
        If zarr, or dask where it is asked for, is not installed.
    SweepError
        If the run could not go on, as on a full disk; what is finished is in the store.

    Notes
    -----
    The numbers do not depend on the number of workers.  With ``workers`` above 1 a script needs the usual
    ``if __name__ == "__main__":``, because its processes import it.
    """
    if isinstance(workers, bool) or not isinstance(workers, int) or not 1 <= workers <= MAX_WORKERS:
        raise InputError(f"workers = {show(workers)}; it must be a whole number from 1 to {MAX_WORKERS}.")
    if scheduler is not None and workers != 1:
        raise InputError(
            f"workers = {workers} and scheduler = {show(scheduler)} are both given; a cluster has its own workers."
        )
    checked_callback("on_progress", on_progress)
    plan = design if isinstance(design, SweepDesign) else load_sweep(design)
    store = create_or_open(out, plan)
    began = time.monotonic()
    with hold_lock(store) as note:
        run = _Run(plan, store, workers, scheduler, on_progress)
        interrupted = run.to_the_end()
    if not interrupted and not run.rows.done.all():
        raise SweepError("The run ended without an error, but states are missing; please report it.")
    return Sweep(store, describe_store(store), run.rows, interrupted, run.computed, time.monotonic() - began, note)


class _Run:
    """One run of a sweep on its store, which is locked."""

    def __init__(
        self,
        plan: SweepDesign,
        store: Path,
        workers: int,
        scheduler: str | None,
        on_progress: Callable[[SweepProgress], object] | None,
    ) -> None:
        self.plan, self.store, self.workers, self.scheduler = plan, store, workers, scheduler
        self.on_progress = on_progress
        self.before = self.computed = self.failed = 0
        self.marks: deque[tuple[float, int]] = deque()
        self.rows = read_rows(store)

    def to_the_end(self) -> bool:
        """Solve what is not done; return whether that was interrupted."""
        remove_unfinished(self.store, self.rows)
        self.before = int(self.rows.done.sum())
        facts = {"host": socket.gethostname(), "pid": os.getpid(), "workers": self.workers, "scheduler": self.scheduler}
        with log_run(self.store, **facts, done=self.before) as ending:
            ending["outcome"] = "STOPPED"
            self.marks.append((time.monotonic(), 0))
            try:
                self._solve()
                ending["outcome"] = "FINISHED"
            except KeyboardInterrupt:
                ending["outcome"] = "INTERRUPTED"
            finally:
                # Workers may have written more than they reported before they were stopped.
                self.rows = read_rows(self.store)
                ending["reported"] = self.computed
                ending["computed"] = self.computed = int(self.rows.done.sum()) - self.before
        return bool(ending["outcome"] == "INTERRUPTED")

    def _solve(self) -> None:
        # Imported here because most uses of the package start no processes.
        from concurrent.futures.process import BrokenProcessPool

        from stribeck.sweeps.workers import solve_in_process, solve_on_cluster, solve_on_processes

        for deaths in range(1, MAX_REPLACEMENTS + 2):
            chains = self._chains()
            try:
                if not chains:
                    pass
                elif self.scheduler is not None:
                    solve_on_cluster(self.store, chains, self.scheduler, self._finished, self._report_progress)
                elif self.workers > 1:
                    solve_on_processes(
                        self.store, chains, min(self.workers, len(chains)), self._finished, self._report_progress
                    )
                else:
                    solve_in_process(self.store, chains, self._finished, self._report_progress)
            except BrokenProcessPool:
                if deaths > MAX_REPLACEMENTS:
                    raise SweepError(
                        f"Worker processes died {deaths} times; is the memory of this machine large enough, and does a "
                        'script that sweeps with workers do so under `if __name__ == "__main__":`? '
                        "What is finished is kept: run the same sweep again, with fewer workers."
                    ) from None
                self.rows = read_rows(self.store)
                remove_unfinished(self.store, self.rows)
            else:
                return

    def _chains(self) -> list[Chain]:
        """Return what is left to solve; a chain that is done in part goes on with the rest."""
        found = []
        for states in chains_of(self.plan.groups, self.plan.shape):
            left = states[~self.rows.done[states]]
            if len(left):
                groups = tuple((speed, load, roughness) for speed, load, roughness in self.plan.groups[left].tolist())
                inputs = {name: tuple(column[left].tolist()) for name, column in self.plan.inputs.items()}
                plan = self.plan
                found.append(Chain(tuple(left.tolist()), groups, inputs, plan.si, plan.rtol, plan.physics, plan.parts))
        return found

    def _finished(self, states: int, failed: int) -> None:
        self.computed += states
        self.failed += failed
        now = time.monotonic()
        self.marks.append((now, self.computed))
        while len(self.marks) > 2 and now - self.marks[1][0] > RATE_WINDOW:
            self.marks.popleft()

    def _report_progress(self) -> None:
        if self.on_progress is None:
            return
        (began, first), now = self.marks[0], time.monotonic()
        rate = (self.computed - first) / (now - began) if self.computed > first and now > began else 0.0
        done, total = self.before + self.computed, len(self.plan)
        left = (total - done) / rate if rate > 0 else np.inf
        self.on_progress(SweepProgress(done, total, self.failed, rate, left))
