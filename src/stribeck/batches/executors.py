"""One map over many states: solved by this process, by processes of this machine, or by the workers of a Dask cluster.

An executor calls, in this process alone, ``keep(rows)`` for states that have ended, in any order, and ``pause()`` at least
twice a second, which may raise KeyboardInterrupt.  No worker outlives the call.
"""

import multiprocessing
import os
import pickle
import queue
import secrets
import signal
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from functools import partial
from importlib.metadata import version
from multiprocessing.connection import wait
from typing import Any, Protocol

from stribeck._types import Flags
from stribeck.batches.states import Chain, Ended, States, chains_of
from stribeck.files.writing import MissingExtraError
from stribeck.quantities.units import InputError

MAX_REPLACEMENTS = 3  # Times that a killed worker process is replaced in one run

POLL_INTERVAL = 0.25  # Time between two looks at whether the user wants to stop [s]

CONNECTION_TIMEOUT = 10.0  # Time that a scheduler has to answer [s]

Row = tuple[int, Any]
"""Number of a state and what is kept of it."""

Keep = Callable[[Sequence[Row]], object]
Pause = Callable[[], object]
Executor = Callable[[Sequence[Chain], Keep, Pause], None]


class SweepError(RuntimeError):
    """A sweep failed; the finished states are in its store, and it can be resumed.

    Parameters
    ----------
    message : str
        What happened and what to do, in sentences.
    """

    def __init__(self, message: str) -> None:
        super().__init__(message)


class WorkerDiedError(Exception):
    """A worker process ended before its chain did."""


class Kept(Protocol):
    """Where states are kept as they end."""

    def done(self) -> Flags:
        """Return whether each state of the design has ended."""

    def keep(self, rows: Sequence[Row]) -> None:
        """Keep states that have ended."""


def solve_all(
    states: States,
    kept: Kept,
    execute: Executor,
    row_of: Callable[[Ended, States, int], Any],
    pause: Callable[[], object],
) -> bool:
    """Solve those states that are not kept yet; return whether ``pause``, or Ctrl-C, interrupted that."""
    for _ in range(1 + MAX_REPLACEMENTS):
        done = kept.done()
        # A chain that is done in part goes on with the rest.
        left = filter(len, (numbers[~done[numbers]] for numbers in chains_of(states.groups)))
        chains = [Chain(numbers, states.part(numbers), row_of) for numbers in left]
        try:
            execute(chains, kept.keep, pause)
        except KeyboardInterrupt:
            return True
        except WorkerDiedError:
            continue
        return False
    raise SweepError(
        f"Worker processes died {1 + MAX_REPLACEMENTS} times; is the memory of this machine large enough, and does a "
        'script that sweeps with workers do so under `if __name__ == "__main__":`? '
        "What is finished is kept: run the same sweep again, with fewer workers."
    )


def solve_here(chains: Sequence[Chain], keep: Keep, pause: Pause) -> None:
    """Solve the chains in this process."""

    def kept(number: int, row: Any) -> None:
        keep([(number, row)])
        pause()

    for chain in chains:
        chain.solve(kept)


def solve_on_processes(workers: int, chains: Sequence[Chain], keep: Keep, pause: Pause) -> None:
    """Solve the chains on processes of this machine, which send each state as it ends."""
    context = multiprocessing.get_context("spawn")  # a fork would copy locks that threads of this process hold
    ahead, pairs = iter(chains), [context.Pipe() for _ in chains[:workers]]
    pipes: list[Any] = [here for here, _ in pairs]
    started = [context.Process(target=_work, args=(there,), daemon=True) for _, there in pairs]
    try:
        with _no_interrupts():
            for process in started:
                process.start()
        for here, there in pairs:
            there.close()  # so that the death of a worker is the end of its pipe
            here.send(next(ahead))
        while pipes:
            ready: list[Any] = wait(pipes, POLL_INTERVAL)
            for pipe in ready:
                sent = _received(pipe)
                if not sent:
                    raise WorkerDiedError
                keep([row for row in sent if row is not None])
                if None not in sent:
                    continue
                following = next(ahead, None)  # the worker has solved its chain
                if following is None:
                    pipes.remove(pipe)
                    pipe.close()
                else:
                    pipe.send(following)
            pause()
    except ConnectionError:
        raise WorkerDiedError from None
    finally:
        for process in (each for each in started if each.pid is not None):
            process.terminate()
            process.join()
        keep([row for pipe in pipes for row in _received(pipe) if row is not None])
        for pipe, _ in pairs:
            pipe.close()


def _received(pipe: Any) -> list[Row | None]:
    """Return what a worker has sent: rows, and None at the end of a chain; nothing where the worker has ended."""
    sent = []
    with suppress(EOFError, OSError):
        while pipe.poll():
            sent.append(pipe.recv())
    return sent


@contextmanager
def _no_interrupts() -> Iterator[None]:
    """Let processes that start now never see Ctrl-C, which a terminal sends to all: this process ends them."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    from multiprocessing import resource_tracker

    resource_tracker.ensure_running()  # the first process starts it, and it would let interrupts through again
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _work(pipe: Any) -> None:
    """Solve the chains that come through a pipe, until it is closed or the process at its other end has ended."""
    parent = multiprocessing.parent_process()

    def watch() -> None:  # a state may take minutes
        if parent is not None:
            parent.join()
            os._exit(1)

    threading.Thread(target=watch, daemon=True).start()
    with suppress(EOFError, ConnectionError, MemoryError):
        while True:
            pipe.recv().solve(lambda number, row: pipe.send((number, row)))
            pipe.send(None)


def solve_on_cluster(scheduler: str, chains: Sequence[Chain], keep: Keep, pause: Pause) -> None:
    """Solve the chains on a Dask cluster, whose workers send each state as it ends."""
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
        _gather(client, chains, keep, pause)


def _gather(client: Any, chains: Sequence[Chain], keep: Keep, pause: Pause) -> None:
    """Send all chains and keep what comes back."""
    arrived: queue.Queue[Any] = queue.Queue()
    kept: set[int] = set()
    topic = f"stribeck-sweep-{secrets.token_hex(8)}"

    def keep_new(rows: Sequence[Row]) -> None:
        keep([row for row in rows if row[0] not in kept])
        kept.update(number for number, _ in rows)

    client.subscribe_topic(topic, lambda event: arrived.put([pickle.loads(event[1])]))
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
                keep_new(news)
                continue
            waiting.discard(news)
            if news.status == "finished":  # once more, as what was sent on the way may have been lost
                there, rows = news.result()
                if there != version("stribeck"):
                    raise InputError(
                        f"a worker has stribeck {there}, this is {version('stribeck')}; install the same version on both."
                    )
                keep_new(rows)
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

    def kept(number: int, row: Any) -> None:
        rows.append((number, row))
        worker.log_event(topic, pickle.dumps(rows[-1]))  # Dask makes plain tuples of named ones

    chain.solve(kept)
    return version("stribeck"), rows


def _reason(future: Any) -> str:
    problem = future.exception() if future.status == "error" else None
    text = " ".join(str(problem).split()) if problem is not None else "the connection to its scheduler was lost"
    return text if len(text) <= 200 else text[:197] + "..."
