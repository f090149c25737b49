"""The tables of docs/numerics_tables.md: runs the benchmark that each block of the page names and writes what it prints.

Usage::

    python docs/numerics_tables.py [WORD ...]

A block stands between ``<!-- begin COMMAND -->`` and ``<!-- end COMMAND -->``.  With words only blocks whose command has
one of them are made anew; all of them take hours.
"""

from __future__ import annotations

import shlex
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

from validity import blocks_of, filled

PAGE = Path(__file__).parent / "numerics_tables.md"
BENCHMARKS = Path(__file__).parents[1] / "benchmarks"


def printed(command: str) -> str:
    """Return what a benchmark prints."""
    name, *arguments = shlex.split(command)
    run = subprocess.run([sys.executable, str(BENCHMARKS / name), *arguments], capture_output=True, text=True, check=True)
    return run.stdout.strip("\n")


def main(words: Sequence[str] = ()) -> None:
    """Write the page, or those of its blocks that have one of the words in their command."""
    for command in blocks_of(PAGE.read_text()):
        if not words or any(word in command for word in words):
            print(command, flush=True)
            text = filled(PAGE.read_text(), {command: printed(command)})
            PAGE.write_text(text)


if __name__ == "__main__":
    main(sys.argv[1:])
