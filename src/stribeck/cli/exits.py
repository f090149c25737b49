"""Exit codes, tables on stdout, sentences on stderr, and streams that take no more."""

from __future__ import annotations

import io
import os
import signal
import sys
from collections.abc import Callable, Mapping
from contextlib import suppress
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING, Any, TextIO

from stribeck.files.writing import reason_of
from stribeck.quantities.units import InputError

if TYPE_CHECKING:
    from rich.console import Console

EXIT_FAILED = 1  # Exit code where a state was not found.
EXIT_BAD_INPUT = 2  # Exit code where an input is refused.
EXIT_INTERRUPTED = 130  # Exit code that a shell gives to a process that ends by SIGINT.
EXIT_BROKEN_PIPE = 141  # Exit code that a shell gives to a process that ends by SIGPIPE.


def complain(text: str, code: int) -> int:
    """Print sentences on stderr, if anybody hears them, and return the exit code."""
    if sys.stderr is None:
        return code
    try:
        for line in text.splitlines():
            print(f"stribeck: {line}", file=sys.stderr)
        sys.stderr.flush()
    except OSError:
        redirect_to_null(sys.stderr)
    return code


def write_each(actions: Mapping[Path, Callable[[], object]]) -> tuple[list[str], list[str]]:
    """Write files; return the names of those that were written, and a sentence about each that was not."""
    written, problems = [], []
    for path, action in actions.items():
        try:
            action()
        except InputError as problem:
            problems.append(str(problem))
        else:
            written.append(str(path))
    return written, problems


def redirect_to_null(stream: TextIO) -> None:
    """Let a stream that takes no more lead nowhere, so that the interpreter does not stumble over it at its end."""
    with suppress(OSError, ValueError):
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, stream.fileno())
        os.close(nowhere)


class OutputError(Exception):
    """What was to be printed could not be."""


class _Stdout(io.FileIO):
    """Stdout that distinguishes its own errors from those of files."""

    def write(self, content: Any, /) -> int:
        """Write bytes."""
        try:
            return super().write(content)
        except BrokenPipeError:
            raise
        except OSError as problem:
            raise OutputError(reason_of(problem)) from None


def prepare_streams() -> None:
    """Give a process of our own streams that are open, take any letter, and say what is wrong with stdout."""
    # Text for a closed stdout then fails as on a full disk; else the first opened file would take its number and its text.
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDONLY if number < 2 else os.O_WRONLY)  # takes the lowest number that is free
    if sys.stderr is None:
        sys.stderr = open(2, "w", closefd=False)
    if sys.stdout is None or not sys.stdout.isatty():
        encoding = None if sys.stdout is None else sys.stdout.encoding
        sys.stdout = io.TextIOWrapper(io.BufferedWriter(_Stdout(1, "w", closefd=False)), encoding)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")


def stdout_console() -> Console:
    """Return the console that tables go to."""
    from rich.console import Console

    class Table(Console):
        def on_broken_pipe(self) -> None:
            """Let the command know, instead of ending the process as rich does."""
            raise BrokenPipeError

    return Table(file=sys.stdout)


def say(console: Console, text: str, style: str | None = None) -> None:
    """Print a sentence as it stands, in one line however narrow the terminal is."""
    console.print(text, style=style, markup=False, highlight=False, soft_wrap=True)


class Interrupted:
    """Whether Ctrl-C was pressed: libraries that are loaded just then make another error of it."""

    def __init__(self) -> None:
        self.pressed = False

    def __call__(self, number: int, frame: FrameType | None) -> None:
        """Handle Ctrl-C."""
        self.pressed = True
        signal.default_int_handler(number, frame)
