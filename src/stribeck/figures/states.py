"""What the figures solve, converged or not at all, and the datasets they make of it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from stribeck.contacts.line import Groups
from stribeck.curves.result import StribeckCurve
from stribeck.curves.stribeck_curve import stribeck_curve
from stribeck.figures.paper_figure import Report
from stribeck.files.writing import MissingExtraError
from stribeck.quantities.outcome import Outcome
from stribeck.solver.solution import Solution
from stribeck.solver.solve import SolveError, solve

if TYPE_CHECKING:
    import xarray

Column = tuple[str | Sequence[str], Any, dict[str, str]]


@dataclass
class Work:
    """The solves of one figure: each is reported when done, and one that fails ends the figure.

    Attributes
    ----------
    report : callable
        As in :class:`PaperFigure`.
    steps : int
        Number of calls of :meth:`solve` and :meth:`curve` to come.
    rtol : float
        Relative tolerance of each state.
    done : int
        Number of calls so far.
    error_estimate : float
        Largest estimated relative error of the states so far.
    """

    report: Report
    steps: int
    rtol: float = 1e-7
    done: int = 0
    error_estimate: float = 0.0

    def solve(self, speed: float, load: float, roughness: float) -> Solution:
        """Return one converged state.

        Parameters
        ----------
        speed, load, roughness : float
            The groups [-].

        Returns
        -------
        Solution
            The state.

        Raises
        ------
        SolveError
            If it did not converge.
        """
        found = solve(Groups(speed, load, roughness), rtol=self.rtol)
        self._step(found)
        return found

    def curve(self, **arguments: Any) -> StribeckCurve:
        """Return a Stribeck curve of which every point converged.

        Parameters
        ----------
        **arguments
            Those of :func:`stribeck.stribeck_curve`, without ``rtol`` and ``on_point``.

        Returns
        -------
        StribeckCurve
            The curve.

        Raises
        ------
        SolveError
            If points are missing.
        """
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
            found: StribeckCurve = stribeck_curve(rtol=self.rtol, on_point=report, **arguments)
        except SolveError:
            if interrupted:
                raise KeyboardInterrupt from None
            raise
        if interrupted or found.outcome is Outcome.INTERRUPTED:
            raise KeyboardInterrupt
        if not found.outcome.ok or len(found) < found.requested:
            raise SolveError(found.outcome, None, f"{len(found)} of {found.requested} points: {found.outcome.value}")
        self._step(*found.solutions)
        return found

    @property
    def attributes(self) -> dict[str, float]:
        """Tolerance and largest estimated error, as attributes of the dataset."""
        return {"rtol": self.rtol, "error_estimate": self.error_estimate}

    def _step(self, *solutions: Solution) -> None:
        self.error_estimate = max(self.error_estimate, *(solution.error_estimate for solution in solutions))
        self.done += 1
        self.report(self.done, self.steps)


def column(dims: str | Sequence[str], values: Any, long_name: str, units: str = "1") -> Column:
    """Return a variable of a dataset.

    Parameters
    ----------
    dims : str or sequence of str
        Names of its dimensions; empty for one number.
    values : array_like
        Its values.
    long_name : str
        What it is, in words with its scale.
    units : str
        Its unit; ``"1"`` for numbers in Hertz scales.

    Returns
    -------
    tuple
        As xarray takes it.
    """
    return dims, np.asarray(values), {"units": units, "long_name": long_name}


def dataset(variables: Mapping[str, Column], coords: Mapping[str, Column], **attributes: Any) -> xarray.Dataset:
    """Return a dataset.

    Parameters
    ----------
    variables, coords : mapping of str to tuple
        What :func:`column` returns, by name.
    **attributes
        Of the whole: ``finding``, and what :attr:`Work.attributes` gives.

    Returns
    -------
    xarray.Dataset
        The dataset.

    Raises
    ------
    MissingExtraError
        If xarray is not installed.
    """
    try:
        import xarray
    except ImportError:
        raise MissingExtraError("the data of a figure", "data", "xarray") from None
    return xarray.Dataset(dict(variables), dict(coords), attributes)
