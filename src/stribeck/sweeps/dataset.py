"""A sweep that was made, finished or not: how its states ended, and all of them as an xarray dataset or a NetCDF file."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from stribeck._types import Array
from stribeck.contacts.regime import friction_share, regime_of
from stribeck.files.datasets import new_dataset
from stribeck.files.results import Exported
from stribeck.files.writing import PathLike, path_of
from stribeck.quantities.outcome import Outcome
from stribeck.quantities.results import ByValue, Card, Shown
from stribeck.sweeps.rows import Rows, read_rows
from stribeck.sweeps.store import describe_store, read_inputs

if TYPE_CHECKING:
    import xarray

__all__ = ["Sweep", "open_sweep"]

PENDING = "NOT_COMPUTED"  # Outcome, in a dataset, of a state that is not finished


@dataclass(frozen=True, eq=False, repr=False)
class Sweep(Exported, Shown, ByValue):
    """The states of a store at the time it was read.

    Attributes
    ----------
    path : pathlib.Path
        The store.
    about : dict
        What it says of itself: ``title``, ``version``, ``design`` (the text of its file), ``rtol`` and more.
    rows : Rows
        Numbers and texts of the states, and which of them are finished.
    interrupted : bool
        Whether the run that returned this was interrupted.
    computed : int
        States that this run computed; the others were in the store before.
    seconds : float
        Time that it took [s].
    note : str
        What was found when it began, such as the lock of a sweep that had died.
    """

    _picture = "stribeck.sweeps.plot.plot_sweep"

    path: Path
    about: dict[str, Any] = field(repr=False)
    rows: Rows = field(repr=False)
    interrupted: bool = False
    computed: int = 0
    seconds: float = 0.0
    note: str = ""

    def __len__(self) -> int:
        """Return the number of states, finished or not."""
        return len(self.rows.done)

    @property
    def finished(self) -> int:
        """States that are finished, converged or failed."""
        return int(self.rows.done.sum())

    @property
    def failed(self) -> int:
        """States that are finished and did not converge."""
        return self.finished - self.outcomes.get(Outcome.CONVERGED.name, 0)

    @property
    def outcomes(self) -> dict[str, int]:
        """Number of finished states by outcome, the most frequent first."""
        names = (self.about["outcomes"][int(code)] for code in self.rows.values[self.rows.done, -1])
        return dict(Counter(names).most_common())

    def to_dataset(self) -> xarray.Dataset:
        """Return all states as an xarray Dataset.

        Returns
        -------
        xarray.Dataset
            Along ``state``: inputs, groups, observables, friction by both definitions, their errors, regime, outcome and
            message; nan and outcome NOT_COMPUTED where a state is not finished.  Units and long names are attributes.

        Raises
        ------
        InputError
            If the store is not what was written.
        MissingExtraError
            If xarray is not installed.
        """
        names = self.about["inputs"]["columns"]
        inputs = read_inputs(self.path, (len(self), len(names)))
        columns = {**_columns(self.about["inputs"], inputs), **_columns(self.about["values"], self.rows.values)}
        codes, unit, label = columns.pop("outcome")
        outcomes = self.about["outcomes"]
        ends = [outcomes[int(code)] if done else PENDING for code, done in zip(codes, self.rows.done, strict=True)]
        columns["regime"] = (self._regimes(columns), "1", "lubrication regime, by the balanced friction")
        columns["outcome"] = (np.array(ends, dtype=object), unit, label)
        columns["message"] = (np.array(self.rows.texts, dtype=object), "1", "notes on the validity of the state")
        return new_dataset(
            {name: ("state", *column) for name, column in columns.items()},
            {"state": ("state", np.arange(len(self)), "1", "number of the state")},
            {
                "title": self.about["title"] or "Sweep of lubricated rough contacts",
                "source": f"stribeck {self.about['version']}",
                "complete": int(self.finished == len(self)),
                "states": len(self),
                "finished": self.finished,
                "failed": self.failed,
                "contact_law": self.about["contact_law"],
                **{f"contact_law_{name}": value for name, value in self.about.get("contact_law_parameters", {}).items()},
                "rtol": self.about["rtol"],
                "kind": self.about["kind"],
                "shape": self.about["shape"],
                "varied": ", ".join(self.about["varied"]),
                "design": self.about["design"],
            },
        )

    def _card(self) -> Card:
        rows = [
            ("store", str(self.path)),
            ("finished", f"{self.finished} of {len(self)}"),
            *((name, str(count)) for name, count in self.outcomes.items()),
            ("varied", ", ".join(self.about["varied"])),
            ("rtol", f"{self.about['rtol']:g}"),
        ]
        return Card(self.about["title"] or "sweep", rows, (self.note,) if self.note else ())

    def _regimes(self, columns: dict[str, tuple[Any, str, str]]) -> Any:
        """Return the regime of each state, empty where there is none."""
        found = np.full(len(self), "", dtype=object)
        numbers = [columns[name][0] for name in ("fluid_load_share", "friction_contact", "friction_balanced")]
        for i, (fluid, contact, total) in enumerate(zip(*numbers, strict=True)):
            if np.isfinite(total):
                found[i] = regime_of(float(fluid), float(friction_share(contact, total - contact)))
        return found


def _columns(about: dict[str, Any], table: Array) -> dict[str, tuple[Any, str, str]]:
    """Return values, unit and long name of each column of an array."""
    described = zip(about["columns"], about["units"], about["long_names"], strict=True)
    return {name: (table[:, k], unit, label) for k, (name, unit, label) in enumerate(described)}


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
    store = path_of(path)
    return Sweep(store, describe_store(store), read_rows(store))
