"""Exit codes, text or JSON on stdout, sentences on stderr, and streams that take no more."""

from __future__ import annotations

import io
import json
import os
import re
import signal
import sys
from collections.abc import Callable, Iterable
from contextlib import suppress
from types import FrameType
from typing import TYPE_CHECKING, Any, TextIO

from stribeck.files.writing import reason_of

if TYPE_CHECKING:
    from stribeck.cases.case import Case
    from stribeck.checks.check import Checks

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


# Colour on a terminal of lines by their first word.
COLOURS = {"Outside": "1;31", "Doubtful": "33", "Note": "33", "Warning": "1;33"}


def show(lines: Iterable[str]) -> None:
    """Print lines as they stand, however narrow the terminal is, with warnings in colour."""
    coloured = sys.stdout.isatty() and not os.environ.get("NO_COLOR") and os.environ.get("TERM") != "dumb"
    for line in lines:
        colour = COLOURS.get(re.split(r"\W", line, maxsplit=1)[0]) if coloured else None
        print(f"\x1b[{colour}m{line}\x1b[m" if colour else line)


class Interrupted:
    """Whether Ctrl-C was pressed: libraries that are loaded just then make another error of it."""

    def __init__(self) -> None:
        self.pressed = False

    def __call__(self, number: int, frame: FrameType | None) -> None:
        """Handle Ctrl-C."""
        self.pressed = True
        signal.default_int_handler(number, frame)


def answer(
    as_json: bool,
    content: Callable[[], dict[str, Any]],
    lines: Callable[[], Iterable[str]],
    checks: Checks | None = None,
    case: Case | None = None,
    written: Iterable[str] = (),
) -> None:
    """Print what a command found, as JSON with checks and conversions, or as text with the files that were written."""
    if not as_json:
        show([*lines(), *(f"Written: {path}" for path in written)])
        return
    from stribeck.files.results import ready_for_json  # which loads numpy

    found = (checks.to_dict() if checks is not None else {}) | content()
    found |= {"conversions": list(case.conversions)} if case is not None and case.conversions else {}
    print(json.dumps(ready_for_json(found), indent=2, ensure_ascii=False, allow_nan=False))
