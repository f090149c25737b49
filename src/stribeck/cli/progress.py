"""Progress, as a bar on a terminal and else as a line now and then, and when Ctrl-C takes effect."""

from __future__ import annotations

import _thread
import math
import signal
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from datetime import timedelta
from types import FrameType
from typing import Any

import stribeck as sb
from stribeck.cli.exits import Interrupted, complain
from stribeck.quantities.units import InputError

LINE_INTERVAL = 10.0  # Time between two lines of progress without a terminal, as in the log of a batch job [s].


class Progress:
    """A bar on stderr where this is a terminal, lines elsewhere, and the place where Ctrl-C takes effect."""

    # Ctrl-C ends work of one process at once, and a second one changes nothing, as it might come between solving and writing;
    # work of several processes ends after the present point, and at once with the second.  Nothing stops the writing.

    def __init__(self, after_point: bool = False, writes: bool = False) -> None:
        self.after_point, self.writes = after_point, writes
        self.started = self.wanted = self.timed_out = False
        self.bar: Any = None
        self.task: Any = None
        self.began = self.said = time.monotonic()

    def __call__(self, done: int, total: int, what: str = "solving", left: float | None = None) -> None:
        """Take note of a finished point, and of the time that is left [s] where it is known."""
        self.started = True
        now = time.monotonic()
        if self.bar is None and now - self.said >= LINE_INTERVAL:
            self.said = now
            if left is None:  # what is left takes as long as what is done
                left = (now - self.began) * (total - done) / done if done else math.inf
            complain(f"{what} {done} of {total}, {_time_text(left)}", 0)
        if self.bar is not None:
            self.bar.update(self.task, completed=done, total=total, description=what)
        if self.wanted and done < total:
            raise KeyboardInterrupt

    def of_fit(self, what: str, done: int, total: int) -> None:
        """Take note of a state of a fit."""
        self(done, total, f"{what}, state")

    def interrupt(self, number: int, frame: FrameType | None) -> None:
        """Handle Ctrl-C."""
        again, self.wanted = self.wanted, True
        waits = self.after_point and self.started
        if not self.writes and again == waits:
            raise KeyboardInterrupt

    def time_out(self) -> None:
        """Stop as Ctrl-C does, also in a background job of a shell, which ignores Ctrl-C."""
        self.timed_out = True
        _thread.interrupt_main(signal.SIGTERM)


@contextmanager
def interruptible(
    after_point: bool = False, sigterm: bool = False, time_limit: float | None = None, writes: bool = False
) -> Iterator[Progress]:
    """Show progress and let Ctrl-C and a limit of time [s] stop the work, and SIGTERM too where that is wanted; no writing."""
    progress = Progress(after_point, writes)
    main = threading.current_thread() is threading.main_thread()
    # A shell makes background jobs ignore Ctrl-C; that stays so.
    before_int = signal.getsignal(signal.SIGINT)
    if isinstance(before_int, Interrupted) and before_int.pressed:
        raise KeyboardInterrupt  # which was lost where Python ignores exceptions, as while libraries are loaded
    handles = main and (before_int is signal.default_int_handler or isinstance(before_int, Interrupted))
    if handles:
        signal.signal(signal.SIGINT, progress.interrupt)
    before = signal.signal(signal.SIGTERM, progress.interrupt) if sigterm and main else None
    timer = threading.Timer(math.inf if time_limit is None else time_limit, progress.time_out)
    timer.daemon = True
    try:
        if time_limit is not None:
            timer.start()
        with nullcontext() if writes else _bar(progress):
            yield progress
    except (sb.SolveError, KeyboardInterrupt) as problem:
        if progress.timed_out:
            raise InputError(
                "--time-limit ended before the first point was solved; nothing was written; give more time."
            ) from None
        # Also a path that was lost because it was interrupted.
        if progress.wanted and isinstance(problem, sb.SolveError):
            raise KeyboardInterrupt from None
        raise
    finally:
        timer.cancel()
        if handles:
            signal.signal(signal.SIGINT, before_int)
        if before is not None:
            signal.signal(signal.SIGTERM, before)


def _time_text(seconds: float) -> str:
    return f"{timedelta(seconds=round(seconds))} left" if math.isfinite(seconds) else "time left unknown"


@contextmanager
def _bar(progress: Progress) -> Iterator[None]:
    if not sys.stderr.isatty():
        yield
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    columns = TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn()
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        progress.bar, progress.task = bar, bar.add_task("starting", total=None)
        yield
