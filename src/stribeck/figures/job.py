"""The work of a figure: states and curves that are solved and reported one by one, and the dataset made of them."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from string import Formatter
from types import SimpleNamespace
from typing import Any

import numpy as np

from stribeck._types import Array
from stribeck.contacts.groups import Groups
from stribeck.curves.result import StribeckCurve
from stribeck.curves.stribeck_curve import stribeck_curve
from stribeck.figures.style import Dataset
from stribeck.files.datasets import import_xarray
from stribeck.quantities.outcome import Outcome
from stribeck.solver.solution import Solution
from stribeck.solver.solve import solve
from stribeck.solver.solve_error import SolveError

Report = Callable[[int, int], object]
"""``report(done, steps)`` is called after each step of a figure's work; it may raise KeyboardInterrupt to end it."""

Said = Mapping[str, Any]
"""What the file of a figure says: title, claim, finding, coordinates, variables, panels."""


class Numbers(SimpleNamespace):
    """The numbers of a figure by name: its data, and what else its finding quotes."""


def furthest(differences: Array) -> Array:
    """Return the largest absolute difference of each row."""
    found: Array = np.abs(differences).max(axis=-1)
    return found


@dataclass
class FigureJob:
    """The solves of one figure: each is reported when done, and one that fails ends the figure."""

    report: Report
    said: Said
    steps: int = 1  # Number of calls of :meth:`solve` and :meth:`curve` to come
    done: int = 0  # Number of calls so far
    error_estimate: float = 0.0  # Largest estimated relative error of the states so far

    @property
    def rtol(self) -> float:
        """Relative tolerance of each state."""
        return float(self.said.get("rtol", 1e-7))

    def solve(self, speed: float, load: float, roughness: float) -> Solution:
        """Return one converged state."""
        found: Solution = solve(Groups(speed, load, roughness), rtol=self.rtol)
        self._step(found)
        return found

    def curve(self, **arguments: Any) -> StribeckCurve:
        """Return a Stribeck curve of which every point converged."""
        try:
            found: StribeckCurve = stribeck_curve(
                rtol=self.rtol,
                on_point=lambda done, points: self.report(self.done, self.steps),
                **{"definition": "published"} | arguments,
            )
        except SolveError as problem:
            if problem.outcome is Outcome.INTERRUPTED:
                raise KeyboardInterrupt from None
            raise
        if found.outcome is Outcome.INTERRUPTED:
            raise KeyboardInterrupt
        if not found.outcome.ok or len(found) < found.requested:
            raise SolveError(found.outcome, None, f"{len(found)} of {found.requested} points: {found.outcome.value}")
        self._step(*found.solutions)
        return found

    def dataset(self, data: Numbers) -> Dataset:
        """Return the numbers that the file of the figure names, with what it finds, whose text quotes any of them."""
        numbers = vars(data)
        variables, coords = (
            {
                name: (dims, np.asarray(numbers[name]), {"units": "1", "long_name": words})
                for name, (*dims, words) in self.said[kind].items()
            }
            for kind in ("variables", "coords")
        )
        about = {name: numbers[name] for name in self.said.get("attributes", ())}
        about |= {"finding": self.finding(**numbers), "rtol": self.rtol, "error_estimate": self.error_estimate}
        made: Dataset = import_xarray("the data of a figure").Dataset(variables, coords, about)
        return made

    def finding(self, **numbers: Any) -> str:
        """Return the sentences on what the figure shows, filled with numbers."""
        return _Sentences().format(" ".join(self.said["finding"].split()), **numbers)

    def _step(self, *solutions: Solution) -> None:
        self.error_estimate = max(self.error_estimate, *(solution.error_estimate for solution in solutions))
        self.done += 1
        self.report(self.done, self.steps)


class _Sentences(Formatter):
    """Formats numbers in text, and those whose format begins with % as hundredths."""

    def format_field(self, value: Any, spec: str) -> Any:
        return super().format_field(100 * value, spec[1:]) if spec.startswith("%") else super().format_field(value, spec)
