"""A sweep that was made, finished or not: how its states ended, and all of them as an xarray dataset or a NetCDF file."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np

from stribeck._types import Array
from stribeck.contacts.regime import REGIMES, friction_share, regime_numbers
from stribeck.files.datasets import Column, new_dataset
from stribeck.files.results import Exported
from stribeck.files.writing import PathLike, path_of
from stribeck.quantities.outcome import Outcome
from stribeck.quantities.outputs import COLUMNS
from stribeck.quantities.results import ByValue, Card, Told
from stribeck.sweeps.store import ERROR, PENDING, read_store

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
        found = {"title": self.about["title"], "store": str(self.path), "states": len(self), "rtol": self.about["rtol"]}
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
        """Return the regime of each state, empty where there is none."""
        none = np.full(len(self), np.nan)  # where no state has ended yet
        fluid, contact, total = (
            self.columns.get(name, none) for name in ("fluid_load_share", "friction_asperities", "friction_balanced")
        )
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
