"""Who solves the chains of a sweep: this process, processes of this machine, or the workers of a Dask cluster.

Each way calls ``finished(states, failed)`` when states are in the store, and ``pause()`` at least twice a second, which may
raise KeyboardInterrupt to stop.  Then, as at any end, no worker goes on.
"""

from __future__ import annotations

import multiprocessing
import os
import queue
import secrets
import signal
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, ProcessPoolExecutor, wait
from contextlib import contextmanager
from functools import partial
from importlib.metadata import version
from itertools import islice
from multiprocessing.synchronize import Event
from pathlib import Path
from typing import Any

import numpy as np

from stribeck._types import Array
from stribeck.files.writing import MissingExtraError
from stribeck.quantities.outcome import Outcome
from stribeck.quantities.units import InputError
from stribeck.sweeps.chain import Chain, solve_chain
from stribeck.sweeps.columns import OUTCOMES
from stribeck.sweeps.rows import Writer
from stribeck.sweeps.store import SweepError

__all__ = ["solve_in_process", "solve_on_cluster", "solve_on_processes"]

POLL_INTERVAL = 0.25  # Time between two looks at whether the user wants to stop [s]

QUEUED_CHAINS_PER_WORKER = 4  # Enough that no process is idle, and not all of a large sweep at once

CONNECTION_TIMEOUT = 10.0  # Time that a scheduler has to answer [s]

Finished = Callable[[int, int], object]
Pause = Callable[[], object]
Chains = Sequence[Chain]
Row = tuple[int, list[float], str]


def _is_failure(values: Array) -> int:
    return int(OUTCOMES[int(values[-1])] != Outcome.CONVERGED.name)


def solve_in_process(path: Path, chains: Chains, finished: Finished, pause: Pause) -> None:
    """Solve the chains in turn, and write each state as it is finished."""
    write = Writer(path)

    def on_row(row: int, values: Array, text: str) -> None:
        write(row, values, text)
        finished(1, _is_failure(values))
        pause()

    for chain in chains:
        solve_chain(chain, on_row)


# --- processes ---


class _Process:
    """State that a worker process keeps between chains."""

    write: Writer
    stop: Event


class _StopWorkError(Exception):
    """Raised in a worker between two states when the sweep ends."""


def solve_on_processes(path: Path, chains: Chains, workers: int, finished: Finished, pause: Pause) -> None:
    """Solve the chains on processes of this machine, which write each state as it is finished."""
    context = multiprocessing.get_context("spawn")  # a fork would copy locks that threads of this process hold
    stop = context.Event()
    ahead = iter(chains)
    with ProcessPoolExecutor(workers, context, _begin, (path, stop)) as pool:
        try:
            with _no_interrupts():
                running = {pool.submit(_solve_here, chain) for chain in islice(ahead, QUEUED_CHAINS_PER_WORKER * workers)}
            while running:
                ended, running = wait(running, POLL_INTERVAL, FIRST_COMPLETED)
                for future in ended:
                    finished(*future.result())
                running |= {pool.submit(_solve_here, chain) for chain in islice(ahead, len(ended))}
                pause()
        finally:
            stop.set()
            pool.shutdown(wait=True, cancel_futures=True)


@contextmanager
def _no_interrupts() -> Iterator[None]:
    """Let processes that start now never see Ctrl-C, which a terminal sends to all: this process tells them."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _begin(path: Path, stop: Event) -> None:
    """Prepare a worker process; it ends with the process that started it, however that ends."""
    _Process.write, _Process.stop = Writer(path), stop
    parent = multiprocessing.parent_process()

    def watch() -> None:
        if parent is not None:
            parent.join()
            os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


def _solve_here(chain: Chain) -> tuple[int, int]:
    """Solve a chain in a worker process; return how many states are done and how many of them failed."""
    done = failed = 0

    def on_row(row: int, values: Array, text: str) -> None:
        nonlocal done, failed
        _Process.write(row, values, text)
        done, failed = done + 1, failed + _is_failure(values)
        if _Process.stop.is_set():
            raise _StopWorkError

    if not _Process.stop.is_set():
        try:
            solve_chain(chain, on_row)
        except _StopWorkError:
            pass
    return done, failed


# --- a cluster ---


def solve_on_cluster(path: Path, chains: Chains, scheduler: str, finished: Finished, pause: Pause) -> None:
    """Solve the chains on a Dask cluster; its workers send each state as it is finished, and this process writes it."""
    try:
        from distributed import Client
    except ImportError:
        raise MissingExtraError("a sweep on a cluster", "cluster", "distributed") from None
    connect: Any = Client
    try:
        client = connect(scheduler, timeout=CONNECTION_TIMEOUT, set_as_default=False)
    except (OSError, ValueError) as problem:
        reason = " ".join(str(problem).split()) or type(problem).__name__
        raise InputError(f"no scheduler answers at {scheduler} ({reason}); start one with: dask scheduler.") from None
    with client:
        _gather(client, Writer(path), chains, finished, pause)


def _gather(client: Any, write: Writer, chains: Chains, finished: Finished, pause: Pause) -> None:
    """Send all chains and write what comes back, in whatever order that is."""
    arrived: queue.Queue[Any] = queue.Queue()
    written: set[int] = set()
    topic = f"stribeck-sweep-{secrets.token_hex(8)}"

    def keep(rows: Sequence[Row]) -> None:
        for row, values, text in rows:
            if row not in written:
                written.add(row)
                numbers = np.asarray(values)
                write(row, numbers, text)
                finished(1, _is_failure(numbers))

    client.subscribe_topic(topic, lambda event: arrived.put([event[1]]))
    waiting = set(client.map(partial(_solve_there, topic=topic), list(chains), pure=False, key=topic))
    for future in waiting:
        future.add_done_callback(arrived.put)
    died = 0
    try:
        while waiting:
            pause()
            try:
                news = arrived.get(timeout=POLL_INTERVAL)
            except queue.Empty:
                continue
            if isinstance(news, list):
                keep(news)
                continue
            waiting.discard(news)
            if news.status == "finished":  # once more, as what was sent on the way may have been lost
                keep(_rows(news.result()))
            elif news.status == "error" and type(news.exception()).__name__ == "KilledWorker":
                died += 1
            else:
                raise SweepError(f"The cluster failed ({_reason(news)}); run the same sweep again to resume it.")
        pause()
    finally:
        client.cancel(list(waiting))
        client.unsubscribe_topic(topic)
    if died:
        raise SweepError(
            f"{died} chains of states were given up, as the workers that solved them died again and again; "
            "is their memory large enough? Run the same sweep again to try once more."
        )


def _solve_there(chain: Chain, topic: str) -> tuple[str, list[Row]]:
    """Solve a chain on a worker of a cluster; return the version of the package there and the rows."""
    from distributed import get_worker

    find: Any = get_worker
    worker, rows = find(), []

    def on_row(row: int, values: Array, text: str) -> None:
        rows.append((row, values.tolist(), text))
        worker.log_event(topic, rows[-1])

    solve_chain(chain, on_row)
    return version("stribeck"), rows


def _rows(result: tuple[str, list[Row]]) -> list[Row]:
    there, rows = result
    if there != version("stribeck"):
        raise InputError(f"a worker has stribeck {there}, this is {version('stribeck')}; install the same version on both.")
    return rows


def _reason(future: Any) -> str:
    problem = future.exception() if future.status == "error" else None
    text = " ".join(str(problem).split()) if problem is not None else "the connection to its scheduler was lost"
    return text if len(text) <= 200 else text[:197] + "..."
