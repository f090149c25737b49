"""One sweep at a time on a store: a lock file with the host and the process that holds it.

It works where several machines share a folder, which locks of the operating system do not do everywhere.  The lock of a
process that has died on this host is taken over; that of another host cannot be judged from here.
"""

from __future__ import annotations

import json
import os
import secrets
import socket
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from stribeck.quantities.units import InputError

__all__ = ["LOCK", "locked"]

LOCK = "sweep.lock"
"""Name of the file in the store."""


@contextmanager
def locked(folder: Path) -> Iterator[str]:
    """Hold the lock of a store.

    Parameters
    ----------
    folder : pathlib.Path
        The store.

    Yields
    ------
    str
        A note on what was found, such as the lock of a sweep that has died; else empty.

    Raises
    ------
    InputError
        If another sweep holds it, or the folder cannot be written.
    """
    lock = folder / LOCK
    mine = json.dumps(
        {"host": socket.gethostname(), "pid": os.getpid(), "born": _born(os.getpid()), "token": secrets.token_hex(8)}
    )
    own = folder / f".{LOCK}-{secrets.token_hex(6)}"
    note = ""
    try:
        try:
            own.write_text(mine, encoding="utf-8")
            while not _taken(own, lock):
                note = _clear(lock) or note
        finally:
            own.unlink(missing_ok=True)
    except OSError as problem:
        raise InputError(
            f"{folder} cannot be written ({problem.strerror or problem}); choose another place or free it."
        ) from None
    try:
        yield note
    finally:
        if _read(lock) == mine:
            lock.unlink(missing_ok=True)


def _taken(own: Path, lock: Path) -> bool:
    """Try to make ``own`` the lock, whole and only if there is none."""
    try:
        os.link(own, lock)
    except FileExistsError:
        return False
    except OSError:  # some file systems have no links
        try:
            with lock.open("x", encoding="utf-8") as file:
                file.write(own.read_text(encoding="utf-8"))
        except FileExistsError:
            return False
    return True


def _clear(lock: Path) -> str:
    """Move the lock of a dead process out of the way and say so; refuse that of a living one."""
    found = _read(lock)
    if found is None:
        return ""
    _refuse_living(lock, found)
    # By its name a newer lock could be meant meanwhile: what was moved is looked at again.
    moved = lock.with_name(f".{LOCK}-{secrets.token_hex(6)}")
    try:
        os.rename(lock, moved)
    except FileNotFoundError:
        return ""
    try:
        if _read(moved) != found:
            os.link(moved, lock)
            return ""
    finally:
        moved.unlink(missing_ok=True)
    pid = _holder(found).get("pid", "unknown")
    return f"An earlier sweep on this store (process {pid}) ended without a word; its lock was taken over."


def _refuse_living(lock: Path, found: str) -> None:
    holder = _holder(found)
    host, pid = holder.get("host"), holder.get("pid")
    if host == socket.gethostname() and isinstance(pid, int):
        if not _lives(pid, holder.get("born")):
            return
        raise InputError(
            f"{lock.parent} is in use: process {pid} on this machine sweeps on it; wait for it, stop it with Ctrl-C, "
            "or choose another store."
        )
    raise InputError(
        f"{lock.parent} is in use by {f'process {pid} on {host}' if host else 'somebody'}, as {lock} says, and whether that "
        f"still runs cannot be seen from {socket.gethostname()}; if it does not, delete that file and run again."
    )


def _holder(found: str) -> dict[str, object]:
    try:
        holder = json.loads(found)
    except ValueError:
        return {}
    return holder if isinstance(holder, dict) else {}


def _read(lock: Path) -> str | None:
    try:
        return lock.read_text(encoding="utf-8")
    except FileNotFoundError:
        return None


def _lives(pid: int, born: object) -> bool:
    """Tell whether a process of this host runs, as far as that can be seen."""
    if os.name == "nt":
        return True  # there, the signal that only asks would end the process
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    except PermissionError:
        pass
    return not born or _born(pid) in ("", born)


def _born(pid: int) -> str:
    """Return when a process began, in the words of the system, or nothing: numbers of processes are used again."""
    try:
        stat = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8", errors="replace")
        boot = Path("/proc/sys/kernel/random/boot_id").read_text(encoding="utf-8").strip()
    except OSError:
        return ""
    state, *fields = stat.rpartition(")")[2].split()
    return "dead" if state in "ZX" else f"{boot} {fields[18]}"
