"""The store of a sweep: a Zarr 3 group with one chunk a state, which holds at any moment what is finished and nothing else.

    values/c.I.0    the numbers of state I, little-endian float64, uncompressed
    text/c.I.0      what there is to say about it, UTF-8, only where there is something
    done/c.I        a checksum of I and the two, written last: the state is finished if this is there and fits
    inputs, zarr.json; SHA256SUMS with their checksums; sweep.toml, runs.jsonl

The states are written and read by :mod:`stribeck.sweeps.rows`.
"""

from __future__ import annotations

import json
import os
import secrets
import shutil
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from stribeck._types import Array
from stribeck.files.reading import read_bounded
from stribeck.files.writing import MissingExtraError, PathLike, path_of, reason_of, sync_folder
from stribeck.quantities.inputs import INPUT_TABLES
from stribeck.quantities.outputs import GROUPS
from stribeck.quantities.units import InputError
from stribeck.sweeps.columns import OUTCOMES, columns_of, input_columns
from stribeck.sweeps.design import SweepDesign
from stribeck.sweeps.seal import MAX_FILE_BYTES, REPAIR_ADVICE, SEALED_FILES, SUMS_FILE, read_sealed, seal

__all__ = ["SweepError", "create_or_open", "describe_store", "read_inputs"]

FORMAT = 2
TEXT_BYTES = 2000  # Length of the text of a state

DESIGN_FILE = "sweep.toml"


class SweepError(RuntimeError):
    """A sweep failed; the finished states are in its store, and it can be resumed.

    Parameters
    ----------
    message : str
        What happened and what to do, in sentences.
    """

    def __init__(self, message: str) -> None:
        super().__init__(message)


def create_or_open(path: PathLike, design: SweepDesign) -> Path:
    """Make the store of a design, or open the one that is there if it is of the same design and version."""
    store = path_of(path)
    zarr = _zarr()
    if store.exists():
        if store.is_dir() and not any(store.iterdir()):
            store.rmdir()
        else:
            _check_same(store, design)
            return store
    if not store.absolute().parent.is_dir():
        raise InputError(f"{store} cannot be created because the folder {store.parent} does not exist; create it first.")
    temporary = store.with_name(f".stribeck-{secrets.token_hex(6)}")
    try:
        try:
            _make(zarr, temporary, design)
            os.rename(temporary, store)
            sync_folder(store.absolute().parent)
        finally:
            shutil.rmtree(temporary, ignore_errors=True)
    except OSError as problem:
        if store.exists():  # somebody else was faster
            return create_or_open(store, design)
        raise InputError(f"{store} cannot be created ({reason_of(problem)}); choose another place.") from None
    return store


def _make(zarr: Any, path: Path, design: SweepDesign) -> None:
    """Write everything but the states."""
    n, columns = len(design), columns_of(design.si, design.physics)
    inputs = {
        **design.inputs,
        **{f"{name}_group": design.groups[:, k] for k, name in enumerate(GROUPS)},
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
        "geometry": design.physics["geometry"],
        "rtol": design.rtol,
        "contact_law": design.law,
        "contact_law_parameters": {} if design.contact_law is None else design.contact_law.parameters,
        "outcomes": list(OUTCOMES),
    }
    group = zarr.create_group(str(path), zarr_format=3, attributes=attributes)
    flat = {"name": "default", "separator": "."}
    plain = {"compressors": None, "filters": None}
    described = input_columns(tuple(inputs), INPUT_TABLES[design.physics["geometry"]])
    array = group.create_array(
        "inputs", shape=(n, len(inputs)), chunks=(n, len(inputs)), dtype="<f8", attributes=_about(described), **plain
    )
    array[:] = np.stack(list(inputs.values()), axis=1)
    shape = {"shape": (n, len(columns)), "chunks": (1, len(columns))}
    group.create_array(
        "values", **shape, dtype="<f8", fill_value=np.nan, chunk_key_encoding=flat, attributes=_about(columns), **plain
    )
    group.create_array(
        "text", shape=(n, TEXT_BYTES), chunks=(1, TEXT_BYTES), dtype="u1", fill_value=0, chunk_key_encoding=flat, **plain
    )
    group.create_array("done", shape=(n,), chunks=(1,), dtype="<u4", fill_value=0, chunk_key_encoding=flat, **plain)
    (path / DESIGN_FILE).write_text(design.text, encoding="utf-8")
    seal(path)


def _about(columns: dict[str, tuple[str, str]]) -> dict[str, list[str]]:
    units, meanings = zip(*columns.values(), strict=True)
    return {"columns": list(columns), "units": list(units), "long_names": list(meanings)}


def describe_store(path: PathLike) -> dict[str, Any]:
    """Return what a store says of itself: its attributes, and under ``"inputs"`` and ``"values"`` those of its columns."""
    store = path_of(path)
    try:
        # Whether this is a store at all, before what is in it is compared with its checksums.
        known = json.loads(read_bounded(store / "zarr.json", MAX_FILE_BYTES))["attributes"]["stribeck_sweep"]
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        if (store / SUMS_FILE).exists():
            raise InputError(
                f"{store} is damaged: zarr.json in it has changed since it was written; {REPAIR_ADVICE}."
            ) from None
        kind = "is a file" if store.is_file() else "does not contain a sweep" if store.exists() else "does not exist"
        raise InputError(f"{store} {kind}; give the folder of a store, or the name of a new one.") from None
    if known != FORMAT:
        raise InputError(
            f"{store} has the format {known!r}, of another version of stribeck; this version reads format {FORMAT}."
        )
    found = {name: json.loads(read_sealed(store, name)) for name in SEALED_FILES if name.endswith(".json")}
    read_inputs(store, found["inputs/zarr.json"]["shape"])
    about: dict[str, Any] = found["zarr.json"]["attributes"]
    columns = {name: found[f"{name}/zarr.json"]["attributes"] for name in ("inputs", "values")}
    return about | columns | {"states": found["done/zarr.json"]["shape"][0]}


def read_inputs(store: Path, shape: tuple[int, int]) -> Array:
    """Return the inputs and groups of all states, verified."""
    return np.frombuffer(read_sealed(store, "inputs/c/0/0"), dtype="<f8").reshape(shape)


def _check_same(store: Path, design: SweepDesign) -> None:
    """Refuse a store of another design or version: its states would not belong together."""
    about, running = describe_store(store), version("stribeck")
    if about["fingerprint"] != design.fingerprint:
        raise InputError(
            f"{store} contains a different sweep from {design.path}: the states or the tolerance differ. "
            f"Choose another store; "
            f"{store / DESIGN_FILE} is the file it was made from."
        )
    if about["version"] != running:
        raise InputError(
            f"{store} was started with stribeck {about['version']}, this is {running}: their numbers may differ. "
            "Continue with that version, or choose another store."
        )


def _zarr() -> Any:
    try:
        import zarr
    except ImportError:
        raise MissingExtraError("a sweep", "data", "zarr") from None
    return zarr
