"""Many states: solved in this process, on several, or on a cluster, and kept in a store one by one as they finish."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Annotated

from stribeck.batches.executors import Executor, SweepError, solve_all, solve_here, solve_on_cluster, solve_on_processes
from stribeck.files.results import Record
from stribeck.files.writing import PathLike
from stribeck.quantities.keywords import answers_typos
from stribeck.quantities.units import InputError, checked_callback, show
from stribeck.sweeps.dataset import Sweep, open_sweep
from stribeck.sweeps.design import SweepDesign, load_sweep
from stribeck.sweeps.store import Store, claimed_store, row_of

MAX_WORKERS = 1024


@dataclass(frozen=True)
class SweepProgress(Record):
    """The progress of a sweep."""

    done: Annotated[int, "states finished, those of earlier runs included", "1"]
    total: Annotated[int, "states of the design", "1"]
    failed: Annotated[int, "states of this run that did not converge", "1"]
    rate: Annotated[float, "states per second of this run, 0 before the first", "s-1"]
    seconds_left: Annotated[float, "time left at this rate, infinite before the first", "s"]

    @property
    def text(self) -> str:
        """Rate and failures in words."""
        failed = f", {self.failed} failed" if self.failed else ""
        return f"{self.rate:.3g} states/s{failed}, state"


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
        The store, one SQLite file; made where there is none.
    workers : int
        Processes of this machine; with 1 the states are solved in this process.
    scheduler : str, optional
        Address of a Dask scheduler, such as ``"tcp://node1:8786"``, whose workers solve the states instead.
    on_progress : callable, optional
        ``on_progress(progress)`` is called with a ``SweepProgress`` as states are finished, and at least twice a second
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
        If dask is asked for and not installed.
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
    began = time.monotonic()
    with claimed_store(out, plan) as store:

        def report_progress() -> None:
            if on_progress is not None:
                on_progress(_progress_of(store, time.monotonic() - began))

        interrupted = solve_all(plan, store, _executor(workers, scheduler), row_of, report_progress)
    if store.found + store.computed < store.total and not interrupted:
        raise SweepError("The run ended without an error, but states are missing; please report it.")
    seconds, found = time.monotonic() - began, open_sweep(store.path)
    return replace(found, interrupted=interrupted, computed=store.computed, seconds=seconds, note=store.note)


def _executor(workers: int, scheduler: str | None) -> Executor:
    if scheduler is not None:
        return partial(solve_on_cluster, scheduler)
    return partial(solve_on_processes, workers) if workers > 1 else solve_here


def _progress_of(store: Store, seconds: float) -> SweepProgress:
    done, rate = store.found + store.computed, store.computed / seconds if seconds > 0 else 0.0
    return SweepProgress(done, store.total, store.failed, rate, (store.total - done) / rate if rate > 0 else math.inf)
