"""A sweep: many states, solved here, on processes or on a cluster, kept in a store one by one, and read as a dataset."""

from __future__ import annotations

import math
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np

from stribeck._types import Array
from stribeck.batches.executors import Executor, SweepError, solve_all, solve_here, solve_on_cluster, solve_on_processes
from stribeck.contacts.friction import REGIMES, friction_share, regime_numbers
from stribeck.files.datasets import Column, new_dataset
from stribeck.files.results import Exported, Record
from stribeck.files.writing import PathLike, path_of
from stribeck.quantities.keywords import answers_typos
from stribeck.quantities.outcome import Outcome
from stribeck.quantities.outputs import COLUMNS
from stribeck.quantities.results import ByValue, Card, Told
from stribeck.quantities.units import InputError, checked_callback, checked_count, show
from stribeck.sweeps.design import SweepDesign, load_sweep
from stribeck.sweeps.store import ERROR, PENDING, claimed_store, read_store, row_of

if TYPE_CHECKING:
    import xarray


@dataclass(frozen=True, eq=False, repr=False)
class Sweep(Exported, Told, ByValue):
    """The states of a store at the time it was read."""

    _picture = "stribeck.plot.curve.plot_states"

    path: Annotated[Path, "the store"]
    about: Annotated[
        dict[str, Any],
        "what it says of itself: ``title``, ``version``, ``design`` (the text of its file), ``rtol`` and more",
    ] = field(repr=False)
    columns: Annotated[
        dict[str, Array],
        "inputs, groups and numbers of each state by name, nan where a state is not finished",
    ] = field(repr=False)
    outcome: Annotated[
        tuple[str, ...],
        "how the solve of each state ended; NOT_COMPUTED where it is not finished",
    ] = field(repr=False)
    message: Annotated[tuple[str, ...], "what there is to say about each state"] = field(repr=False)
    interrupted: Annotated[bool, "whether the run that returned this was interrupted"] = False
    computed: Annotated[int, "states that this run computed; the others were in the store before"] = 0
    seconds: Annotated[float, "time that it took", "s"] = 0.0
    note: Annotated[str, "what was found when it began, such as that the sweep before it had died"] = ""

    def __len__(self) -> int:
        """Return the number of states, finished or not."""
        return len(self.outcome)

    @property
    def finished(self) -> int:
        """States that are finished, converged or failed."""
        return len(self) - self.outcome.count(PENDING)

    @property
    def failed(self) -> int:
        """States that are finished and did not converge."""
        return self.finished - self.outcome.count(Outcome.CONVERGED.name)

    @property
    def outcomes(self) -> dict[str, int]:
        """Number of finished states by outcome, the most frequent first."""
        return {name: count for name, count in Counter(self.outcome).most_common() if name != PENDING}

    def to_dict(self) -> dict[str, Any]:
        """Return how many states there are and how they ended, ready for JSON."""
        own = ("finished", "failed", "outcomes", "computed", "seconds", "interrupted")
        about = {name: self.about[name] for name in ("rtol", "definition")}
        found = {"title": self.about["title"], "store": str(self.path), "states": len(self)} | about
        return found | {name: getattr(self, name) for name in own}

    def to_dataset(self, *, grid: bool = True) -> xarray.Dataset:
        """Return all states as an xarray Dataset.

        Parameters
        ----------
        grid : bool
            Whether the states of a grid have its dimensions, the inputs that vary; else all states are along ``state``.

        Returns
        -------
        xarray.Dataset
            Inputs, groups, observables, friction by both definitions, their errors, regime, outcome and message; nan and
            outcome NOT_COMPUTED where a state is not finished.  Units and long names are attributes.

        Raises
        ------
        MissingExtraError
            If xarray is not installed.
        """
        grid, about = grid and self.about["kind"] == "grid", self.about
        shape = tuple(about["shape"]) if grid else (len(self),)
        dims = tuple(name if name in about["inputs"] and name in self.columns else f"{name}_group" for name in about["varied"])
        dims = dims if grid else ("state",)
        described = about["inputs"] | about["values"]
        columns: dict[str, tuple[Any, str, str]] = {name: (self.columns[name], *described[name]) for name in described}
        columns["regime"] = (self._regimes(), *COLUMNS["regime"])
        columns["outcome"] = (np.array(self.outcome, dtype=object), *COLUMNS["outcome"])
        columns["message"] = (np.array(self.message, dtype=object), *COLUMNS["message"])
        coords: dict[str, Column] = {"state": ("state", np.arange(len(self)), *COLUMNS["state"])}
        if grid:
            coords = {}
            for axis, name in enumerate(dims):
                values, unit, label = columns.pop(name)
                along = np.moveaxis(values.reshape(shape), axis, -1).reshape(-1, shape[axis])
                coords[name] = (name, along[0], unit, label)
        return new_dataset(
            {name: (dims, values.reshape(shape), unit, label) for name, (values, unit, label) in columns.items()},
            coords,
            {
                "title": about["title"] or "Sweep of lubricated rough contacts",
                "source": f"stribeck {about['version']}",
                "complete": int(self.finished == len(self)),
                "states": len(self),
                "finished": self.finished,
                "failed": self.failed,
                "contact_law": about["contact_law"],
                **{f"contact_law_{name}": value for name, value in about["contact_law_parameters"].items()},
                "rtol": about["rtol"],
                "definition": about["definition"],
                "kind": about["kind"],
                "shape": about["shape"],
                "varied": ", ".join(about["varied"]),
                "design": about["design"],
            },
        )

    def _card(self) -> Card:
        varied = ", ".join(self.about["varied"])
        speed = f", {self.computed / self.seconds:.3g} per second" if self.computed and self.seconds > 0 else ""
        said = [f"Computed now: {self.computed}{speed}; found in the store: {self.finished - self.computed}."]
        for name, count in self.outcomes.items():
            meaning = "An error of the program; please report it." if name == ERROR else Outcome[name].value
            said.append(f"{count} {name}: {meaning}")
        finished = f"{self.finished} of {len(self)} states are finished in {self.path}; {varied} varied, {self.about['kind']}."
        return Card(finished, sentences=said, notes=(self.note,) if self.note else ())

    def _regimes(self) -> np.ndarray[Any, np.dtype[np.object_]]:
        """Return the regime of each state by the definition of the design, empty where there is none."""
        none = np.full(len(self), np.nan)  # where no state has ended yet
        names = ("fluid_load_share", "friction_asperities", f"friction_{self.about['definition']}")
        fluid, contact, total = (self.columns.get(name, none) for name in names)
        numbers = regime_numbers(fluid, friction_share(contact, total - contact))
        return np.where(np.isfinite(total), np.array(REGIMES, dtype=object)[numbers], "")


def open_sweep(path: PathLike) -> Sweep:
    """Open the store of a sweep to read it, also while it is being filled.

    Parameters
    ----------
    path : str or path-like
        The store.

    Returns
    -------
    Sweep
        What is finished.

    Raises
    ------
    InputError
        If this is no store of a sweep, or it is damaged.
    """
    about, columns, outcomes, messages = read_store(path)
    return Sweep(path_of(path), about, columns, tuple(outcomes), tuple(messages))


MAX_WORKERS = 1024


@dataclass(frozen=True)
class SweepProgress(Record):
    """The progress of a sweep."""

    done: Annotated[int, "states finished, those of earlier runs included", "1"]
    total: Annotated[int, "states of the design", "1"]
    failed: Annotated[int, "states of this run that did not converge", "1"]
    rate: Annotated[float, "states per second of this run, 0 before the first", "s-1"]
    seconds_left: Annotated[float, "time left at this rate, infinite before the first", "s"]

    @property
    def text(self) -> str:
        """Rate and failures in words."""
        failed = f", {self.failed} failed" if self.failed else ""
        return f"{self.rate:.3g} states/s{failed}, state"


@answers_typos
def sweep(
    design: SweepDesign | PathLike,
    out: PathLike,
    *,
    workers: int = 1,
    scheduler: str | None = None,
    on_progress: Callable[[SweepProgress], object] | None = None,
) -> Sweep:
    """Solve all states of a design and store each as it finishes; resume an interrupted run.

    Parameters
    ----------
    design : SweepDesign or str or path-like
        What to solve: what :func:`load_sweep` returns, or the file.
    out : str or path-like
        The store, one SQLite file; made where there is none.
    workers : int
        Processes of this machine; with 1 the states are solved in this process.
    scheduler : str, optional
        Address of a Dask scheduler, such as ``"tcp://node1:8786"``, whose workers solve the states instead.
    on_progress : callable, optional
        ``on_progress(progress)`` is called with a ``SweepProgress`` as states are finished, and at least twice a second
        where others solve them.  It may raise KeyboardInterrupt.

    Returns
    -------
    Sweep
        All states, those that failed with their outcome; after Ctrl-C those that were finished, ``interrupted``.

    Raises
    ------
    InputError
        If an argument is outside its range, the store holds another sweep, or another run is at it.
    MissingExtraError
        If dask is asked for and not installed.
    SweepError
        If the run could not go on, as on a full disk; what is finished is in the store.

    Notes
    -----
    The numbers do not depend on the number of workers.  With ``workers`` above 1 a script needs the usual
    ``if __name__ == "__main__":``, because its processes import it.
    """
    checked_count("workers", workers, 1, MAX_WORKERS)
    if scheduler is not None and workers != 1:
        raise InputError(
            f"workers = {workers} and scheduler = {show(scheduler)} are both given; a cluster has its own workers."
        )
    checked_callback("on_progress", on_progress)
    plan = design if isinstance(design, SweepDesign) else load_sweep(design)
    began = time.monotonic()
    with claimed_store(out, plan) as store:

        def report_progress() -> None:
            if on_progress is not None:
                seconds, done = time.monotonic() - began, store.found + store.computed
                rate = store.computed / seconds if seconds > 0 else 0.0
                left = (store.total - done) / rate if rate > 0 else math.inf
                on_progress(SweepProgress(done, store.total, store.failed, rate, left))

        execute: Executor = partial(solve_on_processes, workers) if workers > 1 else solve_here
        execute = execute if scheduler is None else partial(solve_on_cluster, scheduler)
        interrupted = solve_all(plan, store, execute, row_of, report_progress)
    if store.found + store.computed < store.total and not interrupted:
        raise SweepError("The run ended without an error, but states are missing; please report it.")
    seconds, found = time.monotonic() - began, open_sweep(store.path)
    return replace(found, interrupted=interrupted, computed=store.computed, seconds=seconds, note=store.note)
