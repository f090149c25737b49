"""Many states through an executor into a store: what arrays in one call and sweeps have in common."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Protocol

from stribeck._types import Flags
from stribeck.batches.executors import Executor, Row, SweepError, WorkerDiedError
from stribeck.batches.order import chains_of
from stribeck.batches.states import Chain, Ended, States

MAX_REPLACEMENTS = 3  # Times that a killed worker process is replaced in one run


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
