"""The log of a store: when its runs began and ended.  It is no result, so that nothing depends on what it holds."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from stribeck.files.reading import read_bounded
from stribeck.sweeps.seal import MAX_FILE_BYTES

__all__ = ["RUNS_FILE", "log_run"]

RUNS_FILE = "runs.jsonl"


@contextmanager
def log_run(path: Path, **facts: Any) -> Iterator[dict[str, Any]]:
    """Note in the store when a run begins and ends; what is put into the dictionary is noted at the end."""
    number = 1 + sum("began" in line for line in _lines(path / RUNS_FILE))
    _note(path, {"run": number, "began": _now(), **facts})
    ending: dict[str, Any] = {}
    try:
        yield ending
    finally:
        _note(path, {"run": number, "ended": _now(), **ending})


def _lines(path: Path) -> Iterator[dict[str, Any]]:
    try:
        text = read_bounded(path, MAX_FILE_BYTES).decode("utf-8", errors="replace")
    except OSError:
        return
    for line in text.splitlines():
        try:
            found = json.loads(line)
        except (ValueError, RecursionError):  # cut off by the end of its run
            continue
        if isinstance(found, dict):
            yield found


def _note(path: Path, facts: dict[str, Any]) -> None:
    file = path / RUNS_FILE
    if file.exists() and not file.is_file():  # a pipe would be waited for
        return
    try:
        with file.open("a", encoding="utf-8") as stream:
            stream.write(json.dumps(facts) + "\n")
    except OSError:  # a full disk, which the states tell of
        pass


def _now() -> str:
    return datetime.now(UTC).isoformat(timespec="seconds")
