"""Checksums of what a store is made with: its description and the inputs of its states.

They are in a file that ``sha256sum --check`` reads too.  The states, which come later, have checksums of their own.
"""

from __future__ import annotations

import hashlib
import re
from pathlib import Path

from stribeck.files.reading import read_bounded
from stribeck.files.writing import reason_of
from stribeck.quantities.units import InputError

__all__ = ["MAX_FILE_BYTES", "SEALED_FILES", "SUMS_FILE", "read_sealed", "seal"]

SUMS_FILE = "SHA256SUMS"

# Files with a checksum
SEALED_FILES = ("zarr.json", "inputs/zarr.json", "inputs/c/0/0", "values/zarr.json", "text/zarr.json", "done/zarr.json")

MAX_FILE_BYTES = 10_000_000  # A larger file of a store, but of its inputs, is none that a sweep wrote
MAX_INPUTS_BYTES = 2**40

REPAIR_ADVICE = "restore it from a copy, or run the sweep again into a new store"


def seal(store: Path) -> None:
    """Write the checksums of a store that has been made."""
    lines = [f"{_sum((store / name).read_bytes())}  {name}\n" for name in SEALED_FILES]
    (store / SUMS_FILE).write_bytes("".join(lines).encode())


def read_sealed(store: Path, name: str) -> bytes:
    """Return the content of a file of a store, verified."""
    sums = _read(store, SUMS_FILE, MAX_FILE_BYTES)
    found = re.search(rf"^([0-9a-f]{{64}})  {re.escape(name)}$", sums.decode("ascii", errors="replace"), re.MULTILINE)
    content = _read(store, name, MAX_INPUTS_BYTES)
    if found is None or found[1] != _sum(content):
        raise InputError(f"{store} is damaged: {name} in it has changed since it was written; {REPAIR_ADVICE}.")
    return content


def _read(store: Path, name: str, largest: int) -> bytes:
    try:
        return read_bounded(store / name, largest)
    except (FileNotFoundError, NotADirectoryError):
        raise InputError(f"{store} is damaged: {name} in it is missing; {REPAIR_ADVICE}.") from None
    except OSError as problem:
        raise InputError(f"{store} cannot be read: {name} in it: {reason_of(problem)}; {REPAIR_ADVICE}.") from None


def _sum(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()
