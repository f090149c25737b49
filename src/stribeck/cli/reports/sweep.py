"""Text of a sweep: its progress and outcome."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING, Any, TextIO

from stribeck.cli.exits import say
from stribeck.quantities.outcome import Outcome
from stribeck.sweeps.columns import ERROR
from stribeck.sweeps.dataset import Sweep
from stribeck.sweeps.sweep import SweepProgress

if TYPE_CHECKING:
    from rich.console import Console

__all__ = ["ProgressLines", "print_sweep", "progress_text", "sweep_json"]

PROGRESS_INTERVAL = 30.0  # Time between two lines of progress without a terminal, as in the log of a batch job [s].


class ProgressLines:
    """Writes a line of progress now and then."""

    def __init__(self, stream: TextIO | None) -> None:
        self.stream = stream
        self.last = time.monotonic()

    def __call__(self, progress: SweepProgress) -> None:
        """Write the line if it is time for it."""
        now = time.monotonic()
        if self.stream is None or now - self.last < PROGRESS_INTERVAL:
            return
        self.last = now
        text = f"stribeck: {progress.done} of {progress.total} states, {progress_text(progress)}, {_time_left(progress)}"
        print(text, file=self.stream, flush=True)


def progress_text(progress: SweepProgress) -> str:
    """Return rate and failures."""
    failed = f", {progress.failed} failed" if progress.failed else ""
    return f"{progress.rate:.3g} states/s{failed}"


def _time_left(progress: SweepProgress) -> str:
    if not math.isfinite(progress.seconds_left):
        return "time left unknown"
    minutes, seconds = divmod(round(progress.seconds_left), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02}:{seconds:02} left"


def sweep_json(sweep: Sweep, files: Sequence[str]) -> dict[str, Any]:
    """Return a sweep as a dictionary ready for JSON."""
    return {
        "title": sweep.about["title"],
        "store": str(sweep.path),
        "states": len(sweep),
        "finished": sweep.finished,
        "failed": sweep.failed,
        "outcomes": sweep.outcomes,
        "computed": sweep.computed,
        "seconds": sweep.seconds,
        "interrupted": sweep.interrupted,
        "rtol": sweep.about["rtol"],
        "files": list(files),
    }


def print_sweep(console: Console, sweep: Sweep, files: Sequence[str]) -> None:
    """Print how many states there are, how they ended, and where they are."""
    tell = partial(say, console)
    if sweep.about["title"]:
        tell(sweep.about["title"])
    varied = ", ".join(sweep.about["varied"])
    tell(f"{sweep.finished} of {len(sweep)} states are finished in {sweep.path}; {varied} varied, {sweep.about['kind']}.")
    speed = f", {sweep.computed / sweep.seconds:.3g} per second" if sweep.computed and sweep.seconds > 0 else ""
    tell(f"Computed now: {sweep.computed}{speed}; found in the store: {sweep.finished - sweep.computed}.")
    for name, count in sweep.outcomes.items():
        meaning = "An error of the program; please report it." if name == ERROR else Outcome[name].value
        tell(f"{count} {name}: {meaning}")
    for file in files:
        tell(f"Written: {file}")
