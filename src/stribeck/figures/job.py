"""The work of a figure: states and curves that are solved and reported one by one, and the dataset made of them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

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

Column = tuple[str | Sequence[str], Any, dict[str, str]]
Described = tuple[Any, str]
"""Values and what they are."""


@dataclass
class FigureJob:
    """The solves of one figure: each is reported when done, and one that fails ends the figure."""

    report: Report
    steps: int  # Number of calls of :meth:`solve` and :meth:`curve` to come
    rtol: float = 1e-7  # Relative tolerance of each state
    done: int = 0  # Number of calls so far
    error_estimate: float = 0.0  # Largest estimated relative error of the states so far
    variables: dict[str, Column] = field(default_factory=dict)
    coords: dict[str, Column] = field(default_factory=dict)

    def solve(self, speed: float, load: float, roughness: float) -> Solution:
        """Return one converged state."""
        found: Solution = solve(Groups(speed, load, roughness), rtol=self.rtol)
        self._step(found)
        return found

    def curve(self, **arguments: Any) -> StribeckCurve:
        """Return a Stribeck curve of which every point converged."""
        interrupted = False

        def report(done: int, points: int) -> None:
            nonlocal interrupted
            try:
                self.report(self.done, self.steps)
            except KeyboardInterrupt:
                # The curve takes it as the wish to stop there, and returns or raises something else.
                interrupted = True
                raise

        try:
            found: StribeckCurve = stribeck_curve(rtol=self.rtol, on_point=report, **{"definition": "published"} | arguments)
        except SolveError as problem:
            if interrupted or problem.outcome is Outcome.INTERRUPTED:
                raise KeyboardInterrupt from None
            raise
        if interrupted or found.outcome is Outcome.INTERRUPTED:
            raise KeyboardInterrupt
        if not found.outcome.ok or len(found) < found.requested:
            raise SolveError(found.outcome, None, f"{len(found)} of {found.requested} points: {found.outcome.value}")
        self._step(*found.solutions)
        return found

    def along(self, dims: str = "", /, **axes: Described) -> None:
        """Take coordinates, each along the dimension of its name unless another is said."""
        self.coords |= {name: _column(dims or name, *each) for name, each in axes.items()}

    def give(self, dims: str | Sequence[str], /, **variables: Described) -> None:
        """Take variables along dimensions."""
        self.variables |= {name: _column(dims, *each) for name, each in variables.items()}

    def dataset(self, finding: str, **attributes: Any) -> Dataset:
        """Return what was taken, with the tolerance and the largest estimated error."""
        about = {"finding": finding} | attributes | {"rtol": self.rtol, "error_estimate": self.error_estimate}
        made: Dataset = import_xarray("the data of a figure").Dataset(self.variables, self.coords, about)
        return made

    def _step(self, *solutions: Solution) -> None:
        self.error_estimate = max(self.error_estimate, *(solution.error_estimate for solution in solutions))
        self.done += 1
        self.report(self.done, self.steps)


def _column(dims: str | Sequence[str], values: Any, long_name: str) -> Column:
    return dims, np.asarray(values), {"units": "1", "long_name": long_name}
