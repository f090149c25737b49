"""One sweep at a time on a store: a lock file that names the host and the process of the sweep that holds it.

The library filelock makes it.  The existence of the file is the lock, which works where several machines share a folder;
locks of the operating system do not do so everywhere.
"""

from __future__ import annotations

import os
import socket
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from stribeck.files.writing import MissingExtraError, reason_of
from stribeck.quantities.units import InputError

__all__ = ["LOCK_FILE", "hold_lock"]

LOCK_FILE = "sweep.lock"

MAX_RECORD_BYTES = 1024  # Length of a lock's record that is read


@contextmanager
def hold_lock(folder: Path) -> Iterator[str]:
    """Hold the lock of a store."""
    try:
        from filelock import SoftFileLock, Timeout
    except ImportError:
        raise MissingExtraError("a sweep", "data", "filelock") from None
    file = folder / LOCK_FILE
    lock = SoftFileLock(str(file))
    try:
        before = _holder(file)
        try:
            lock.acquire(timeout=0)
        except Timeout:
            lock.acquire(timeout=0)  # the first attempt may have cleared away the lock of a dead process, no more
    except Timeout:
        raise InputError(_in_use(file)) from None
    except OSError as problem:
        raise InputError(f"{folder} cannot be written ({reason_of(problem)}); choose another place.") from None
    note = ""
    if before is not None:
        note = (
            f"An earlier sweep on this store (process {before[0]}) ended without releasing its lock; the lock was taken over."
        )
    try:
        yield note
    finally:
        lock.release()


def _in_use(file: Path) -> str:
    """Return the sentence for a store whose lock cannot be had."""
    holder = _holder(file)
    if holder is None:
        return f"{file.parent} was in use a moment ago; run the same sweep again."
    pid, host = holder
    if host.partition("?")[0] == socket.gethostname() and _is_running(pid):  # the library adds a mark in containers
        return (
            f"{file.parent} is in use by process {pid} on this machine; wait for it, stop it with Ctrl-C, "
            "or choose another store."
        )
    return (
        f"{file.parent} is in use by process {pid} on {host}, as {file} says, and whether that still runs cannot be seen "
        f"from {socket.gethostname()}; if it does not, delete that file and run again."
    )


def _holder(file: Path) -> tuple[int, str] | None:
    """Return process and host that a lock file names, None if there is no file."""
    try:
        odd = not stat.S_ISREG(file.lstat().st_mode)  # a pipe would be waited for
        with open(os.devnull if odd else file, encoding="utf-8") as stream:
            pid, host, *_ = stream.read(MAX_RECORD_BYTES).splitlines()
        return int(pid), host
    except FileNotFoundError:
        return None
    except ValueError:
        raise InputError(
            f"{file} is not what a sweep writes there, so that {file.parent} may be in use by somebody; if it is not, "
            "delete that file and run again."
        ) from None


def _is_running(pid: int) -> bool:
    """Return whether a process of this host runs, as far as that can be seen."""
    if os.name == "nt":
        return True  # there, the signal that only asks would end the process
    try:
        os.kill(pid, 0)
    except (ProcessLookupError, OverflowError):
        return False
    except PermissionError:
        pass
    return True
