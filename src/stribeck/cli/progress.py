"""Progress on a terminal, and when Ctrl-C takes effect."""

from __future__ import annotations

import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any

import stribeck as sb
from stribeck.cli.exits import Interrupted


class Progress:
    """A bar on stderr where this is a terminal, and the place where Ctrl-C takes effect.

    Ctrl-C is a wish to stop after the present point: then nothing that was finished can be lost. Before the
    first point, and when it comes a second time, it takes effect at once.
    """

    def __init__(self) -> None:
        self.started = self.wanted = False
        self.bar: Any = None
        self.task: Any = None

    def __call__(self, done: int, total: int, what: str = "solving") -> None:
        """Take note of a finished point."""
        self.started = True
        if self.bar is not None:
            self.bar.update(self.task, completed=done, total=total, description=what)
        if self.wanted and done < total:
            raise KeyboardInterrupt

    def interrupt(self, number: int, frame: FrameType | None) -> None:
        """Handle Ctrl-C."""
        again, self.wanted = self.wanted, True
        if again or not self.started:
            raise KeyboardInterrupt


@contextmanager
def interruptible(sigterm: bool = False) -> Iterator[Progress]:
    """Show progress and let Ctrl-C stop the work between two points, and SIGTERM too where that is wanted."""
    progress = Progress()
    main = threading.current_thread() is threading.main_thread()
    # A shell makes background jobs ignore Ctrl-C; that stays so.
    before_int = signal.getsignal(signal.SIGINT)
    handles = main and (before_int is signal.default_int_handler or isinstance(before_int, Interrupted))
    if handles:
        signal.signal(signal.SIGINT, progress.interrupt)
    before = signal.signal(signal.SIGTERM, progress.interrupt) if sigterm and main else None
    try:
        with _bar(progress):
            yield progress
    except sb.SolveError:
        # Also a path that was lost because it was interrupted.
        if progress.wanted:
            raise KeyboardInterrupt from None
        raise
    finally:
        if handles:
            signal.signal(signal.SIGINT, before_int)
        if before is not None:
            signal.signal(signal.SIGTERM, before)


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
