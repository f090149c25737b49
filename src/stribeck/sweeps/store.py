"""The store of a sweep: a Zarr 3 group with one chunk a state, which holds at any moment what is finished and nothing else.

    values/c.I.0    the numbers of state I, little-endian float64, uncompressed
    text/c.I.0      what there is to say about it, UTF-8, only where there is something
    done/c.I        a checksum of the two, written last: the state is finished where this is there and fits
    inputs, zarr.json, sweep.toml, runs.jsonl

Chunks are written here as files, each under a temporary name and then moved: zarr does the same in more time than some states
take.  A process that is killed leaves a chunk without its flag at worst, a machine that loses its power one that does not
fit; both count as not done.
"""

from __future__ import annotations

import json
import os
import secrets
import shutil
import struct
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from stribeck._types import Array, Flags
from stribeck.files.writing import MissingExtraError, PathLike
from stribeck.quantities.units import InputError
from stribeck.sweeps.columns import OUTCOMES, columns_of, input_columns
from stribeck.sweeps.design import SweepDesign

__all__ = ["Rows", "SweepError", "Writer", "create_or_open", "describe_store", "log_run", "read_rows"]

FORMAT = 1
TEXT = 2000
"""Bytes of the text of a state."""

RUNS = "runs.jsonl"
DESIGN = "sweep.toml"


class SweepError(RuntimeError):
    """A sweep that could not go on; what it finished is in its store, and it can be resumed.

    Parameters
    ----------
    message : str
        What happened and what to do, in sentences.
    """

    def __init__(self, message: str) -> None:
        super().__init__(message)


@dataclass(frozen=True)
class Rows:
    """What a store holds of its states.

    Attributes
    ----------
    values : ndarray, shape (n, columns)
        Their numbers, nan where a state is not finished.
    done : ndarray of bool, shape (n,)
        Which are finished.
    texts : tuple of str
        What there is to say about each.
    """

    values: Array
    done: Flags
    texts: tuple[str, ...]


class Writer:
    """Writes states into a store; needs neither its design nor zarr, so that any worker can do it."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def __call__(self, row: int, values: Array, text: str) -> None:
        """Write one state: text and numbers first, then the flag that it is done.

        Raises
        ------
        SweepError
            If the disk does not take it.
        """
        said = _text(text)
        numbers = values.astype("<f8").tobytes()
        try:
            if said:
                self._put("text", f"c.{row}.0", said)
            self._put("values", f"c.{row}.0", numbers)
            self._put("done", f"c.{row}", struct.pack("<I", _checksum(numbers, said)))
        except OSError as problem:
            raise SweepError(
                f"{self.path} could not be written ({problem.strerror or problem}); the states finished until then are kept. "
                "Make room and run the same sweep again: it goes on where it stopped."
            ) from None

    def _put(self, array: str, chunk: str, content: bytes) -> None:
        target = self.path / array / chunk
        temporary = target.with_name(f".{chunk}-{secrets.token_hex(4)}")
        try:
            with temporary.open("wb", buffering=0) as file:
                if file.write(content) != len(content):
                    raise OSError(28, "No space left on device")
            os.replace(temporary, target)
        except OSError:
            temporary.unlink(missing_ok=True)
            raise


def create_or_open(path: PathLike, design: SweepDesign) -> Path:
    """Make the store of a design, or open the one that is there if it is of the same design and version.

    Parameters
    ----------
    path : str or path-like
        The store, a folder.
    design : SweepDesign
        What is swept.

    Returns
    -------
    pathlib.Path
        The store.

    Raises
    ------
    InputError
        If the place is taken, cannot be written, or holds another sweep.
    MissingExtraError
        If zarr is not installed.
    """
    store = Path(path)
    zarr = _zarr()
    if store.exists():
        if store.is_dir() and not any(store.iterdir()):
            store.rmdir()
        else:
            _check_same(store, design)
            return store
    if not store.absolute().parent.is_dir():
        raise InputError(f"{store} cannot be made, as there is no folder {store.parent}; make it first.")
    temporary = store.with_name(f".stribeck-{secrets.token_hex(6)}")
    try:
        try:
            _make(zarr, temporary, design)
            os.rename(temporary, store)
        finally:
            shutil.rmtree(temporary, ignore_errors=True)
    except OSError as problem:
        if store.exists():  # somebody else was faster
            return create_or_open(store, design)
        raise InputError(f"{store} cannot be made ({problem.strerror or problem}); choose another place.") from None
    return store


def _make(zarr: Any, path: Path, design: SweepDesign) -> None:
    """Write everything but the states."""
    n, columns = len(design), columns_of(design.si, design.contact_law)
    inputs = {
        **design.inputs,
        **{f"{name}_group": design.groups[:, k] for k, name in enumerate(("speed", "load", "roughness"))},
    }
    attributes = {
        "stribeck_sweep": FORMAT,
        "version": version("stribeck"),
        "title": design.title,
        "fingerprint": design.fingerprint,
        "design": design.text,
        "kind": design.kind,
        "shape": list(design.shape),
        "varied": list(design.varied),
        "si": design.si,
        "rtol": design.rtol,
        "contact_law": design.law,
        "contact_law_parameters": {} if design.contact_law is None else design.contact_law.parameters,
        "outcomes": list(OUTCOMES),
    }
    group = zarr.create_group(str(path), zarr_format=3, attributes=attributes)
    flat = {"name": "default", "separator": "."}
    plain = {"compressors": None, "filters": None}
    described = input_columns(tuple(inputs))
    array = group.create_array(
        "inputs", shape=(n, len(inputs)), chunks=(n, len(inputs)), dtype="<f8", attributes=_about(described), **plain
    )
    array[:] = np.stack(list(inputs.values()), axis=1)
    shape = {"shape": (n, len(columns)), "chunks": (1, len(columns))}
    group.create_array(
        "values", **shape, dtype="<f8", fill_value=np.nan, chunk_key_encoding=flat, attributes=_about(columns), **plain
    )
    group.create_array("text", shape=(n, TEXT), chunks=(1, TEXT), dtype="u1", fill_value=0, chunk_key_encoding=flat, **plain)
    group.create_array("done", shape=(n,), chunks=(1,), dtype="<u4", fill_value=0, chunk_key_encoding=flat, **plain)
    (path / DESIGN).write_text(design.text, encoding="utf-8")


def _about(columns: dict[str, tuple[str, str]]) -> dict[str, list[str]]:
    units, meanings = zip(*columns.values(), strict=True)
    return {"columns": list(columns), "units": list(units), "long_names": list(meanings)}


def describe_store(path: PathLike) -> dict[str, Any]:
    """Return what a store says of itself: its attributes, and under ``"inputs"`` and ``"values"`` those of its columns.

    Parameters
    ----------
    path : str or path-like
        The store.

    Returns
    -------
    dict
        From its ``zarr.json`` files.

    Raises
    ------
    InputError
        If this is no store of a sweep.
    """
    store = Path(path)
    try:
        found: dict[str, Any] = _attributes(store)
        known = found["stribeck_sweep"]
    except (OSError, ValueError, KeyError, TypeError):
        kind = "is a file" if store.is_file() else "holds no sweep" if store.exists() else "does not exist"
        raise InputError(f"{store} {kind}; give the folder of a store, or the name of a new one.") from None
    if known != FORMAT:
        raise InputError(f"{store} has the format {known}, of another version of stribeck; this one reads format {FORMAT}.")
    return found | {name: _attributes(store / name) for name in ("inputs", "values")}


def _attributes(path: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads((path / "zarr.json").read_text(encoding="utf-8"))["attributes"]
    return found


def _check_same(store: Path, design: SweepDesign) -> None:
    """Refuse a store of another design or version: its states would not belong together."""
    about, running = describe_store(store), version("stribeck")
    if about["fingerprint"] != design.fingerprint:
        raise InputError(
            f"{store} holds another sweep than {design.path}: the states or the tolerance differ. Choose another store; "
            f"{store / DESIGN} is the file it was made from."
        )
    if about["version"] != running:
        raise InputError(
            f"{store} was begun with stribeck {about['version']}, this is {running}: their numbers may differ. "
            "Go on with that version, or choose another store."
        )


def read_rows(path: Path) -> Rows:
    """Return the finished states of a store; what does not fit its flag counts as not done."""
    about = describe_store(path)
    n = json.loads((path / "done" / "zarr.json").read_text(encoding="utf-8"))["shape"][0]
    values = np.full((n, len(about["values"]["columns"])), np.nan)
    done, texts = np.zeros(n, dtype=bool), [""] * n
    flags = {int(name[2:]) for name in os.listdir(path / "done") if name.startswith("c.")}
    for row in flags:
        found = _finished(path, row, values.shape[1])
        if found is not None:
            done[row] = True
            values[row], texts[row] = found
    return Rows(values, done, tuple(texts))


def _finished(path: Path, row: int, columns: int) -> tuple[Array, str] | None:
    """Return numbers and text of a state, or None where they are not whole."""
    try:
        numbers = (path / "values" / f"c.{row}.0").read_bytes()
        flag = (path / "done" / f"c.{row}").read_bytes()
        try:
            said = (path / "text" / f"c.{row}.0").read_bytes()
        except FileNotFoundError:
            said = b""
    except FileNotFoundError:
        return None
    if len(flag) != 4 or len(numbers) != 8 * columns or struct.unpack("<I", flag)[0] != _checksum(numbers, said):
        return None
    return np.frombuffer(numbers, dtype="<f8"), said.rstrip(b"\0").decode("utf-8", errors="replace")


def clean(path: Path, rows: Rows) -> None:
    """Remove what killed processes left: temporary files, and chunks of states that do not count as done."""
    for array in ("values", "text", "done"):
        for name in os.listdir(path / array):
            row = name[2:].partition(".")[0]
            if name.startswith(".c.") or (name.startswith("c.") and not rows.done[int(row)]):
                (path / array / name).unlink(missing_ok=True)


def _text(text: str) -> bytes:
    """Return text as the chunk that holds it; empty for none."""
    content = text.encode("utf-8")
    if len(content) > TEXT:
        content = content[: TEXT - 3].decode("utf-8", errors="ignore").encode("utf-8") + b"..."
    return content.ljust(TEXT, b"\0") if content else b""


def _checksum(numbers: bytes, said: bytes) -> int:
    """Return what the flag of a state holds, which zero must not be."""
    return zlib.crc32(said, zlib.crc32(numbers)) or 1


@contextmanager
def log_run(path: Path, **facts: Any) -> Iterator[dict[str, Any]]:
    """Note in the store when a run begins and ends; what is put into the dictionary is noted at the end."""
    number = sum(1 for line in _lines(path / RUNS) if "began" in line) + 1
    _note(path, {"run": number, "began": _now(), **facts})
    ending: dict[str, Any] = {}
    try:
        yield ending
    finally:
        _note(path, {"run": number, "ended": _now(), **ending})


def _lines(path: Path) -> Iterator[dict[str, Any]]:
    try:
        text = path.read_text(encoding="utf-8")
    except FileNotFoundError:
        return
    for line in text.splitlines():
        try:
            yield json.loads(line)
        except ValueError:  # torn by the end of its run
            continue


def _note(path: Path, facts: dict[str, Any]) -> None:
    try:
        with (path / RUNS).open("a", encoding="utf-8") as file:
            file.write(json.dumps(facts) + "\n")
    except OSError:  # a full disk, which the states tell of; the log is no result
        pass


def _now() -> str:
    return datetime.now(UTC).isoformat(timespec="seconds")


def _zarr() -> Any:
    try:
        import zarr
    except ImportError:
        raise MissingExtraError("a sweep", "data", "zarr") from None
    return zarr
