"""The store of a sweep: one SQLite file with a row for each state that has ended, which one sweep at a time may fill.

    about     what the store says of itself: a name and a value in JSON
    inputs    inputs and groups of every state of the design
    states    numbers, outcome and message of the states that have ended; NULL is nan

The sweep that fills a store holds its write lock but for the moment of each commit, and its name stands in ``about`` under
``writer``.  Another that gets the lock in such a moment sees the name and tries again; if it gets the lock each time, the
first is dead.  So no two of them write, also where a file system does not lock.
"""

import json
import os
import random
import secrets
import socket
import sqlite3
import time
from collections.abc import Iterator, Sequence
from contextlib import closing, contextmanager, suppress
from importlib.metadata import version
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from stribeck._types import Array, Flags
from stribeck.batches.executors import SweepError
from stribeck.batches.states import Ended, States
from stribeck.files.writing import PathLike, path_of, reason_of
from stribeck.quantities.outcome import Outcome
from stribeck.quantities.outputs import COLUMNS
from stribeck.quantities.units import InputError
from stribeck.solver.numbers import numbers_of
from stribeck.sweeps.design import SweepDesign

FORMAT = 4  # SQLite's user_version of a store
APPLICATION_ID = 0x53545242  # SQLite's mark of what a file is for: STRB

CLAIM_ATTEMPTS = 5  # Times that a lock must be free for its holder to count as dead
CLAIM_PAUSE = 0.1  # Longest time between two of them [s]
BUSY_TIMEOUT = 60.0  # Time that a commit waits for readers of a file system without a write-ahead log [s]
ROWS_AT_ONCE = 10_000  # Rows read into memory as objects of Python

ERROR = "ERROR"  # Outcome of a state whose solve ended in an error of the program instead of an :class:`Outcome`
PENDING = "NOT_COMPUTED"  # Outcome, in a dataset, of a state that is not finished

NO_STORE_ADVICE = "give the file of a store, or the name of a new one"
REPAIR_ADVICE = "restore it from a copy, or run the sweep again into a new store"


class Row(NamedTuple):
    """What a sweep keeps of a state."""

    numbers: dict[str, tuple[float, str, str]]  # Value, unit and meaning of each by its name; empty if there is no state
    outcome: str  # Name of the outcome
    message: str


def row_of(ended: Ended, states: States, i: int) -> Row:
    """Return what a sweep keeps of the i-th state."""
    solution = ended.solution
    if solution is None:
        return Row({}, ERROR if ended.fault else ended.outcome.name, ended.message)
    boundary_friction, beta = (None, None) if states.coefficients is None else states.coefficients[i].tolist()
    stated = (each.stated for each in numbers_of(solution, boundary_friction, beta, with_fields=False))
    numbers = {name: number for each in stated for name, number in each.items()}
    numbers |= {name: (float(getattr(solution, name)), *COLUMNS[name]) for name in ("nodes", "newton_steps")}
    notes = solution.notes_for(boundary_friction, beta, states.definition)
    return Row(numbers, ended.outcome.name, "\n".join(filter(None, [ended.message, *notes])))


class Store:
    """A store that this process fills."""

    def __init__(self, path: Path, db: sqlite3.Connection, note: str, values: dict[str, list[str]]) -> None:
        self.path, self.note = path, note  # What was found on opening, such as the name of a sweep that had died
        self._db = db
        self._name = {"pid": os.getpid(), "host": socket.gethostname(), "key": secrets.token_hex(8)}
        self._values = values  # Unit and meaning of the numbers of states
        done = self.done()
        self.total, self.found = len(done), int(done.sum())  # States of the design, and those that earlier runs have finished
        self.computed = self.failed = 0  # States of this run, and those of them that did not converge
        self._set("writer", self._name)
        self._commit()

    def done(self) -> Flags:
        """Return whether each state of the design has ended."""
        (total,) = self._db.execute("SELECT count(*) FROM inputs").fetchone()
        found = np.zeros(total, dtype=bool)
        found[[state for (state,) in self._db.execute("SELECT state FROM states")]] = True
        return found

    def keep(self, rows: Sequence[tuple[int, Row]]) -> None:
        """Keep states that have ended, in one transaction."""
        if not rows:
            return
        for state, row in rows:
            self._add_columns(row)
            named = {"state": state, "outcome": row.outcome, "message": row.message}
            named |= {name: value for name, (value, _, _) in row.numbers.items()}
            names, places = ", ".join(f'"{name}"' for name in named), ", ".join("?" * len(named))
            self._db.execute(f"INSERT INTO states ({names}) VALUES ({places})", list(named.values()))
            self.failed += row.outcome != Outcome.CONVERGED.name
        self.computed += len(rows)
        self._commit()

    def _add_columns(self, row: Row) -> None:
        """Make columns for the numbers that no state before had, as where a film begins to end."""
        new = {name: words for name, (_, *words) in row.numbers.items() if name not in self._values}
        if new:
            self._values |= new
            for name in new:
                self._db.execute(f'ALTER TABLE states ADD COLUMN "{name}" REAL')
            self._set("values", self._values)

    def release(self) -> None:
        """Let others write, and leave nothing beside the file where nobody reads it."""
        with suppress(sqlite3.OperationalError):  # a full disk, of which the caller tells
            if self._db.in_transaction:
                self._set("writer", None)
                self._db.execute("COMMIT")
                self._db.execute("PRAGMA busy_timeout = 0")
                self._db.execute("PRAGMA journal_mode = DELETE")

    def _set(self, name: str, value: Any) -> None:
        self._db.execute("INSERT OR REPLACE INTO about VALUES (?, ?)", (name, json.dumps(value)))

    def _commit(self) -> None:
        """Commit and take the lock again."""
        self._db.execute("COMMIT")
        self._db.execute("BEGIN IMMEDIATE")
        writer = _writer(self._db)
        if writer != self._name:
            self._db.execute("ROLLBACK")
            raise SweepError(f"{self.path} was taken over by {_called(writer)}; this sweep ends.")


@contextmanager
def claimed_store(path: PathLike, design: SweepDesign) -> Iterator[Store]:
    """Hold the store of a design, which is made where there is none, and which nobody else fills meanwhile."""
    place = _checked_place(path)
    if not place.absolute().parent.is_dir():
        raise InputError(f"{place} cannot be created because the folder {place.parent} does not exist; create it first.")
    store, is_ours = None, not place.exists()
    try:
        with closing(sqlite3.connect(place.absolute(), isolation_level=None)) as db:
            _is_new(place, db)
            db.execute("PRAGMA busy_timeout = 0")
            with suppress(sqlite3.OperationalError):  # a store that is in use, and file systems without shared memory
                db.execute("PRAGMA journal_mode = WAL")
            db.execute("PRAGMA synchronous = NORMAL")
            note = _claim(place, db)
            if _is_new(place, db):
                _make(db, design)
            with _read_whole(place, db) as about:
                _check_same(place, about, design)
            db.execute(f"PRAGMA busy_timeout = {round(1e3 * BUSY_TIMEOUT)}")
            store = Store(place, db, note, about["values"])
            try:
                yield store
            finally:
                store.release()
    except sqlite3.Error as problem:
        if store is not None:
            raise SweepError(
                f"{place} could not be written ({reason_of(problem, place)}); the states finished until then are kept. "
                "Correct that and run the same sweep again to resume it."
            ) from None
        if isinstance(problem, sqlite3.OperationalError):
            for beside in ("", "-wal", "-shm") if is_ours else ():
                Path(f"{place}{beside}").unlink(missing_ok=True)
            raise InputError(f"{place} cannot be written ({reason_of(problem, place)}); choose another place.") from None
        raise InputError(_unreadable(place, problem)) from None


def read_store(path: PathLike) -> tuple[dict[str, Any], dict[str, Array], list[str], list[str]]:
    """Return what a store says of itself, its numbers by name, and outcome and message of each state."""
    place = _checked_place(path)
    if not place.exists():
        raise InputError(f"{place} does not exist; {NO_STORE_ADVICE}.")
    try:
        with closing(sqlite3.connect(f"{place.absolute().as_uri()}?mode=ro", uri=True)) as db:
            if _is_new(place, db):
                raise InputError(f"{place} does not contain a sweep; {NO_STORE_ADVICE}.")
            db.execute("BEGIN")  # so that all is read as it was at one moment
            with _read_whole(place, db) as about:
                inputs = _table(db, "inputs", list(about["inputs"]), about["states"])
                values = _table(db, "states", list(about["values"]), about["states"])
                outcomes, messages = [PENDING] * about["states"], [""] * about["states"]
                for state, outcome, message in db.execute("SELECT state, outcome, message FROM states"):
                    outcomes[state], messages[state] = outcome, message
    except sqlite3.Error as problem:
        raise InputError(_unreadable(place, problem)) from None
    return about, {**inputs, **values}, outcomes, messages


def _checked_place(path: PathLike) -> Path:
    """Return the path of a store; refuse what cannot be one."""
    place = path_of(path)
    if place.exists() and not place.is_file():
        raise InputError(f"{place} is {'a folder' if place.is_dir() else 'no ordinary file'}; {NO_STORE_ADVICE}.")
    return place


def _is_new(place: Path, db: sqlite3.Connection) -> bool:
    """Return whether nothing is in the file; refuse what is no store of this version."""
    (tables,) = db.execute("SELECT count(*) FROM sqlite_schema").fetchone()  # first: another sweep may just make the store
    (mark,), (form,) = (db.execute(f"PRAGMA {name}").fetchone() for name in ("application_id", "user_version"))
    if mark == APPLICATION_ID and form != FORMAT:
        raise InputError(f"{place} has the format {form}, of another version of stribeck; this version reads format {FORMAT}.")
    if mark != APPLICATION_ID and tables:
        raise InputError(f"{place} is a database of something else; {NO_STORE_ADVICE}.")
    return bool(mark != APPLICATION_ID)


def _claim(place: Path, db: sqlite3.Connection) -> str:
    """Take the write lock from nobody or from a dead process; return the note on that."""
    for attempt in range(CLAIM_ATTEMPTS):
        if attempt:
            db.execute("ROLLBACK")
            time.sleep(random.uniform(0.5, 1.0) * CLAIM_PAUSE)
        try:
            db.execute("BEGIN IMMEDIATE")
        except sqlite3.OperationalError as problem:
            if problem.sqlite_errorcode & 0xFF != sqlite3.SQLITE_BUSY:
                raise
            by = _called(_writer(db))
            raise InputError(
                f"{place} is in use by {by}; wait for it, stop it with Ctrl-C, or choose another store."
            ) from None
        writer = _writer(db)
        if writer is None:
            return ""
    return f"An earlier sweep on this store ({_called(writer)}) ended without releasing it; it was taken over."


def _writer(db: sqlite3.Connection) -> dict[str, Any] | None:
    """Return the name of the sweep that fills a store, None if there is none or the store is not made yet."""
    with suppress(sqlite3.OperationalError):
        for (name,) in db.execute("SELECT value FROM about WHERE name = 'writer'"):
            found: dict[str, Any] | None = json.loads(name)
            return found
    return None


def _called(writer: dict[str, Any] | None) -> str:
    """Return the words for a sweep that fills a store."""
    if writer is None:
        return "another process"
    here = writer["host"] == socket.gethostname()
    return f"process {writer['pid']} on {'this machine' if here else writer['host']}"


def _make(db: sqlite3.Connection, design: SweepDesign) -> None:
    """Write everything but the states."""
    columns = design.input_columns
    about = {
        "version": version("stribeck"),
        "title": design.title,
        "fingerprint": design.fingerprint,
        "design": design.text,
        "kind": design.kind,
        "shape": design.shape,
        "varied": design.varied,
        "states": len(design),
        "geometry": design.physics["geometry"],
        "rtol": design.rtol,
        "definition": design.definition,
        "contact_law": design.law,
        "contact_law_parameters": {} if design.contact_law is None else design.contact_law.parameters,
        "inputs": {name: words for name, (_, *words) in columns.items()},
        "values": {},
    }
    inputs = ", ".join(f'"{name}" REAL' for name in columns)
    db.execute(f"PRAGMA application_id = {APPLICATION_ID}")
    db.execute(f"PRAGMA user_version = {FORMAT}")
    db.execute("CREATE TABLE about (name TEXT PRIMARY KEY, value TEXT)")
    db.execute(f"CREATE TABLE inputs (state INTEGER PRIMARY KEY, {inputs})")
    db.execute("CREATE TABLE states (state INTEGER PRIMARY KEY, outcome TEXT NOT NULL, message TEXT NOT NULL)")
    db.executemany("INSERT INTO about VALUES (?, ?)", [(name, json.dumps(value)) for name, value in about.items()])
    rows = zip(range(len(design)), *(values.tolist() for values, _, _ in columns.values()), strict=True)
    db.executemany(f"INSERT INTO inputs VALUES ({', '.join('?' * (1 + len(columns)))})", rows)


def _table(db: sqlite3.Connection, name: str, columns: list[str], total: int) -> dict[str, Array]:
    """Return the numbers of a table by column, nan where there is none."""
    found = np.full((len(columns), total), np.nan)
    listed = ", ".join(f'"{column}"' for column in ("state", *columns))
    rows = db.execute(f"SELECT {listed} FROM {name}")
    while some := rows.fetchmany(ROWS_AT_ONCE):
        table = np.array(some, dtype=float)
        found[:, table[:, 0].astype(int)] = table[:, 1:].T
    return dict(zip(columns, found, strict=True))


@contextmanager
def _read_whole(place: Path, db: sqlite3.Connection) -> Iterator[dict[str, Any]]:
    """Read what a store says of itself, and more; refuse what is damaged."""
    (message,) = db.execute("PRAGMA quick_check(1)").fetchone()
    try:
        if message != "ok":
            raise ValueError(message)
        yield {name: json.loads(value) for name, value in db.execute("SELECT name, value FROM about")}
    except (ArithmeticError, LookupError, TypeError, ValueError) as problem:
        if isinstance(problem, InputError):
            raise
        raise InputError(f"{place} is damaged ({' '.join(str(problem).split())}); {REPAIR_ADVICE}.") from None


def _check_same(place: Path, about: dict[str, Any], design: SweepDesign) -> None:
    """Refuse a store of another design or version: its states would not belong together."""
    if about["fingerprint"] != design.fingerprint:
        raise InputError(
            f"{place} contains a different sweep from {design.path}: the states or [solver] differ. "
            "Choose another store; open_sweep(...).about['design'] is the file that this one was made from."
        )
    if about["version"] != version("stribeck"):
        raise InputError(
            f"{place} was started with stribeck {about['version']}, this is {version('stribeck')}: their numbers may differ. "
            "Continue with that version, or choose another store."
        )


def _unreadable(place: Path, problem: sqlite3.Error) -> str:
    if getattr(problem, "sqlite_errorcode", None) == sqlite3.SQLITE_NOTADB:
        return f"{place} is a file of something else; {NO_STORE_ADVICE}."
    return f"{place} cannot be read ({reason_of(problem)}); {REPAIR_ADVICE}."
