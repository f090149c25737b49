"""The walk of a reader: the files that a call runs through before the first residual of the equations.

That an attribute is made on its first use, as :mod:`stribeck.quantities.lazy` does, is no step of it.

Each function counts once, when it is first called; a file is entered again if the walk comes back to it for another function.
"""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from types import FrameType
from typing import Any

import stribeck as sb
from stribeck.cli import main as command

PACKAGE = Path(sb.__file__).parent
END = ("equations/line.py", "residual")


class Arrived(BaseException):
    """The first residual is reached."""


def walk(call: Callable[[], Any]) -> list[str]:
    """Return the files of the package in the order in which their functions are first called, repetitions left out."""
    for name in sb.__all__:  # loaded on first use, which is no walk
        getattr(sb, name)
    files: list[str] = []
    known: set[Any] = set()

    def look(frame: FrameType, event: str, _: Any) -> None:
        code = frame.f_code
        path = Path(code.co_filename)
        if (
            event != "call"
            or code in known
            or path.name == "lazy.py"
            or PACKAGE not in path.parents
            or code.co_name == "<module>"
        ):
            return
        known.add(code)
        name = path.relative_to(PACKAGE).as_posix()
        if not files or files[-1] != name:
            files.append(name)
        if (name, code.co_name) == END:
            raise Arrived

    sys.setprofile(look)
    try:
        call()
    except Arrived:
        return files
    finally:
        sys.setprofile(None)
    raise RuntimeError("the call never asked for a residual")


def in_python() -> list[str]:
    """Return the walk of ``sb.solve(Groups(...))``."""
    return walk(lambda: sb.solve(sb.Groups(speed=1e-5, load=0.1, roughness=1e-4)))


def on_the_command_line() -> list[str]:
    """Return the walk of ``stribeck solve --groups``."""
    before, sys.argv = sys.argv, ["stribeck", "solve", "--groups", "1e-5", "0.1", "1e-4"]
    try:
        return walk(command)
    finally:
        sys.argv = before


if __name__ == "__main__":
    for title, files in (("sb.solve(Groups(...))", in_python()), ("stribeck solve --groups", on_the_command_line())):
        print(f"{title}: {len(set(files))} files, the most frequent entered {max(Counter(files).values())} times")
        print("    " + " -> ".join(files))
