"""The states of a store: written one by one, and read back if they are whole.

Chunks are written here as files, each under a temporary name and then moved: zarr does the same in more time than some states
take.  A process that is killed leaves a chunk without its flag at worst, a machine that loses its power one that does not
fit; both count as not done.
"""

from __future__ import annotations

import errno
import os
import re
import secrets
import struct
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from stribeck._types import Array, Flags
from stribeck.files.reading import read_bounded
from stribeck.files.writing import FULL_DISK_ERRORS, reason_of
from stribeck.quantities.units import InputError
from stribeck.sweeps.seal import MAX_FILE_BYTES
from stribeck.sweeps.store import TEXT_BYTES, SweepError, describe_store

__all__ = ["Rows", "Writer", "remove_unfinished", "read_rows"]


@dataclass(frozen=True)
class Rows:
    """Values, flags and texts of the states of a store."""

    values: Array  # Numbers of each state, nan where a state is not finished
    done: Flags  # Whether each state is finished
    texts: tuple[str, ...]  # Message on each state


class Writer:
    """Writes states into a store; needs neither its design nor zarr, so that any worker can do it."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def __call__(self, row: int, values: Array, text: str) -> None:
        """Write one state: text and numbers first, then the flag that it is done."""
        message = _text(text)
        numbers = values.astype("<f8").tobytes()
        try:
            if message:
                self._put("text", f"c.{row}.0", message)
            self._put("values", f"c.{row}.0", numbers)
            self._put("done", f"c.{row}", struct.pack("<I", _checksum(row, numbers, message)))
        except OSError as problem:
            remedy = "Make room" if problem.errno in FULL_DISK_ERRORS else "Mend that"
            raise SweepError(
                f"{self.path} could not be written ({reason_of(problem)}); the states finished until then are kept. "
                f"{remedy} and run the same sweep again to resume it."
            ) from None

    def _put(self, array: str, chunk: str, content: bytes) -> None:
        target = self.path / array / chunk
        temporary = target.with_name(f".{chunk}-{secrets.token_hex(4)}")
        try:
            with temporary.open("wb", buffering=0) as file:
                if file.write(content) != len(content):
                    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
            os.replace(temporary, target)
        except OSError:
            temporary.unlink(missing_ok=True)
            raise


def read_rows(path: Path) -> Rows:
    """Return the finished states of a store; what does not fit its checksum counts as not done."""
    about = describe_store(path)
    n = about["states"]
    values = np.full((n, len(about["values"]["columns"])), np.nan)
    done, texts = np.zeros(n, dtype=bool), [""] * n
    with _store_problem(path, "read"):
        for row in _chunks(path, "done", n):
            found = _finished(path, row, values.shape[1])
            if found is not None:
                done[row] = True
                values[row], texts[row] = found
    return Rows(values, done, tuple(texts))


def _finished(path: Path, row: int, columns: int) -> tuple[Array, str] | None:
    """Return numbers and text of a state, or None if they are not whole."""
    try:
        numbers = read_bounded(path / "values" / f"c.{row}.0", MAX_FILE_BYTES)
        flag = read_bounded(path / "done" / f"c.{row}", MAX_FILE_BYTES)
        try:
            message = read_bounded(path / "text" / f"c.{row}.0", MAX_FILE_BYTES)
        except FileNotFoundError:
            message = b""
    except FileNotFoundError:
        return None
    if len(flag) != 4 or len(numbers) != 8 * columns or struct.unpack("<I", flag)[0] != _checksum(row, numbers, message):
        return None
    return np.frombuffer(numbers, dtype="<f8"), message.rstrip(b"\0").decode("utf-8", errors="replace")


def remove_unfinished(path: Path, rows: Rows) -> None:
    """Remove what killed processes left: temporary files, and chunks of states that do not count as done."""
    with _store_problem(path, "cleared"):
        for array in ("values", "text", "done"):
            for row, name in _chunks(path, array, len(rows.done)).items():
                if not rows.done[row]:
                    (path / array / name).unlink(missing_ok=True)
            for name in os.listdir(path / array):
                if name.startswith(".c."):
                    (path / array / name).unlink(missing_ok=True)


def _chunks(path: Path, array: str, n: int) -> dict[int, str]:
    """Return the names of the chunks of an array by the number of their state."""
    found = {}
    pattern = re.compile(r"c\.(0|[1-9][0-9]{0,9})" + ("" if array == "done" else r"\.0"))
    for name in os.listdir(path / array):
        if name.startswith("c."):  # other names are left by systems and programs that look at folders
            match = pattern.fullmatch(name)
            if match is None or int(match[1]) >= n:
                raise InputError(f"{path / array / name} belongs to no state of this sweep, which has {n}; move it elsewhere.")
            found[int(match[1])] = name
    return found


@contextmanager
def _store_problem(path: Path, what: str) -> Iterator[None]:
    """Return an error of the system on a file of a store as a sentence."""
    try:
        yield
    except OSError as problem:
        place = problem.filename or path
        raise InputError(
            f"{path} cannot be {what}: {place}: {reason_of(problem)}; correct that, or choose a new store."
        ) from None


def _text(text: str) -> bytes:
    """Return text as the chunk that holds it; empty for none."""
    content = text.encode("utf-8")
    if len(content) > TEXT_BYTES:
        content = content[: TEXT_BYTES - 3].decode("utf-8", errors="ignore").encode("utf-8") + b"..."
    return content.ljust(TEXT_BYTES, b"\0") if content else b""


def _checksum(row: int, numbers: bytes, message: bytes) -> int:
    """Return what the flag of a state holds, which zero must not be."""
    return zlib.crc32(message, zlib.crc32(numbers, zlib.crc32(struct.pack("<Q", row)))) or 1
