"""Files that the browser sends, read in a process of their own, which may fail or take too long without harm to the page.

Run as a program it reads one file from its standard input; :func:`read_file` starts that program.
"""

from __future__ import annotations

import os
import pickle
import signal
import subprocess
import sys
import threading
from collections.abc import Mapping
from typing import Any, Literal

from stribeck.contacts.contact import Contact
from stribeck.explorer.downloads import read_case
from stribeck.explorer.inputs.inputs import from_case
from stribeck.explorer.inputs.url import check_length
from stribeck.explorer.measured import headers_of, read_measured
from stribeck.explorer.scans import read_scan
from stribeck.quantities.units import InputError

Kind = Literal["case", "measured", "scan", "headers"]

MAX_READ_SECONDS = 20.0  # Time after which a file is given up [s].

MAX_READ_BYTES = 4_000_000_000  # Bytes that the reader of a file may address, where the system can limit it.


def read_file(
    kind: Kind,
    name: str,
    content: bytes,
    contact: Contact,
    asked: Mapping[str, Any] | None = None,
    seconds: float = MAX_READ_SECONDS,
) -> Any:
    """Return what a file holds; of measured curves a table ``[fit]`` may say what the columns are."""
    # Of the contact only what measured curves need: not every law can be sent.
    task = pickle.dumps((kind, name, content, contact.replace(law=None), asked, seconds))
    environment = os.environ | {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
    command = [sys.executable, "-m", "stribeck.explorer.reading"]
    try:
        # The program keeps its time itself, so that it can remove what it wrote; the limit here is for one that hangs.
        done = subprocess.run(command, input=task, capture_output=True, timeout=seconds + 20, env=environment, check=False)
        if done.returncode == 0:
            good, found = pickle.loads(done.stdout)  # noqa: S301 - from our own program
            if good:
                return found
            raise InputError(found)
    except subprocess.TimeoutExpired:
        pass
    raise InputError(f"{name} could not be read within {seconds:g} s; it should be a short TOML file, or columns of numbers.")


def main() -> None:
    """Read a task from the standard input and write what was found, or the sentence about it, to the standard output."""
    kind, name, content, contact, asked, seconds = pickle.load(sys.stdin.buffer)  # noqa: S301 - from our own program
    signal.signal(signal.SIGTERM, _stop)
    _limit_memory()
    # A signal, so that temporary folders are removed on the way out.
    watch = threading.Timer(seconds, lambda: os.kill(os.getpid(), signal.SIGTERM))
    watch.daemon = True
    watch.start()
    found: Any
    try:
        if kind == "case":
            found = from_case(read_case(name, content))
            check_length(found)
        elif kind == "scan":
            found = read_scan(name, content)
        else:
            found = headers_of(name, content) if kind == "headers" else _of_text(name, content, contact, asked)
        answer = True, found
    except InputError as problem:
        answer = False, str(problem)
    except (MemoryError, RecursionError):
        answer = False, f"{name} needs too much memory; send a smaller file."
    sys.stdout.buffer.write(pickle.dumps(answer))


def _of_text(name: str, content: bytes, contact: Contact, asked: Mapping[str, Any] | None) -> Any:
    """Return the measured curves of a text file, or else the surface whose heights it holds."""
    try:
        return read_measured(name, content, contact, asked)
    except InputError as problem:
        if asked:
            raise
        try:
            return read_scan(name, content)
        except InputError as other:
            raise InputError(f"{problem} As a file of heights: {other}") from None


def _stop(*_: Any) -> None:
    raise SystemExit(3)


def _limit_memory() -> None:
    try:
        import resource
    except ImportError:  # Windows
        return
    _, most = resource.getrlimit(resource.RLIMIT_AS)
    limit = MAX_READ_BYTES if most == resource.RLIM_INFINITY else min(MAX_READ_BYTES, most)
    try:
        resource.setrlimit(resource.RLIMIT_AS, (limit, most))
    except (OSError, ValueError):  # macOS has the name and not the limit
        return


if __name__ == "__main__":
    main()
