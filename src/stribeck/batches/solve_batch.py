"""Thousands of states at once: which are solved together, and what comes out.

States that are close are reached from one of them, along its derivatives; scattered ones come down together from the rigid
contact.  What neither brings to its tolerance is left to :func:`stribeck.solve`, and the result says so.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, fields
from typing import Any

import numpy as np

from stribeck._types import Array, Flags, Indices
from stribeck.batches.device import Device, device_for, one_torch_thread
from stribeck.batches.guess import column_groups, spread
from stribeck.batches.path import Answer, descend, refined
from stribeck.batches.plan import middle, planned
from stribeck.contact_laws.law import is_exponential
from stribeck.contacts.friction import Definition, check_definition
from stribeck.contacts.line import Groups
from stribeck.equations.observables import NAMES, Observables
from stribeck.numerics.newton import Outcome
from stribeck.numerics.threads import one_blas_thread
from stribeck.quantities.inputs import quantity
from stribeck.quantities.units import InputError, show
from stribeck.solver.cold_start import cold_start
from stribeck.solver.solve import SolveError, check_rtol, least_estimate, solve

Progress = Callable[[int, int], object]


@dataclass(frozen=True, eq=False)
class BatchSolution:
    """Observables of many states, in arrays of the shape of the groups; gaps in u_Hz, nan where the outcome says why.

    Attributes
    ----------
    groups : Groups
        The states.
    rtol : float
        The relative tolerance asked for.
    backend : str
        The array library that did the linear algebra.
    outcome : ndarray of Outcome
        How the solve of each state ended.
    batched : ndarray of bool
        Whether a state was solved in a batch; the others by :func:`stribeck.solve`, or not at all.
    contact_load_share, fluid_load_share : ndarray
        Parts of the load on asperities and fluid [-].
    central_gap, minimum_gap, flux_gap : ndarray
        Gap at x = 0, least gap and flux gap [u_Hz].
    minimum_position : ndarray
        Where the gap is least [a].
    offset : ndarray
        Height of the apex of the undeformed cylinder [u_Hz].
    viscous_paper, viscous_balanced : ndarray
        Viscous friction for beta = 1 in its two definitions [-].
    relative_errors : ndarray, shape (8, ...)
        Estimated relative errors of the observables, absolute for the load shares; by name in :attr:`errors`.
    """

    groups: Groups
    rtol: float
    backend: str
    outcome: np.ndarray[Any, np.dtype[np.object_]]
    batched: Flags
    contact_load_share: Array = field(repr=False)
    fluid_load_share: Array = field(repr=False)
    central_gap: Array = field(repr=False)
    minimum_gap: Array = field(repr=False)
    minimum_position: Array = field(repr=False)
    flux_gap: Array = field(repr=False)
    offset: Array = field(repr=False)
    viscous_paper: Array = field(repr=False)
    viscous_balanced: Array = field(repr=False)
    relative_errors: Array = field(repr=False)

    @property
    def ok(self) -> Flags:
        """Whether each state converged."""
        return np.array([one.ok for one in self.outcome.ravel()], dtype=bool).reshape(self.outcome.shape)

    @property
    def error_estimate(self) -> Array:
        """Largest estimated relative error of the observables of each state; load shares count absolutely."""
        return np.asarray(np.fmax.reduce(self.relative_errors))

    @property
    def errors(self) -> dict[str, Array]:
        """Estimated relative error of each observable; absolute for the load shares."""
        return dict(zip(NAMES, self.relative_errors, strict=True))

    def friction(self, mu0: float = 1.0, beta: float = 1.0, definition: Definition = "paper") -> Array:
        r"""Return the friction coefficients.

        .. math:: \mu = \mu_0 \frac{F_c}{F_N} + \beta \, \mu_f(\beta = 1)

        Parameters
        ----------
        mu0 : float
            Friction coefficient of the dry contact [-], >= 0.
        beta : float
            Coefficient of the contact law [-], > 0.
        definition : {"paper", "balanced"}
            Definition of the viscous part, theory.md, section 6.

        Returns
        -------
        ndarray
            Friction coefficients [-].

        Raises
        ------
        InputError
            If an argument is outside its range.
        """
        mu0, beta = quantity("friction_coefficient", mu0), quantity("beta", beta)
        viscous: Array = getattr(self, f"viscous_{check_definition(definition)}")
        return mu0 * self.contact_load_share + beta * viscous


@one_blas_thread
def solve_batch(
    groups: Groups,
    *,
    rtol: float = 1e-6,
    backend: Any = "numpy",
    device: Any = None,
    memory: float | None = None,
    on_progress: Progress | None = None,
) -> BatchSolution:
    r"""Solve many states at once, by batched Newton iterations on meshes that they share.

    Parameters
    ----------
    groups : Groups
        The states; arrays broadcast.
    rtol : float
        Relative error allowed in every observable, absolute for the load shares; from 1e-11 to 1e-2.
    backend : {"numpy", "torch", "cupy"} or module
        Array library for the linear algebra, or any other namespace of the array API standard.
    device : object, optional
        Device as the library names it, for example ``"cuda"``; its default if omitted.
    memory : float, optional
        Bytes that the Jacobians of a batch may fill, > 0; what is fast on such a device if omitted.
    on_progress : callable, optional
        ``on_progress(done, total)`` is called after every batch.

    Returns
    -------
    BatchSolution
        Observables, outcomes and error estimates. A failure, or a state that an interruption left undone, is kept with
        its outcome.

    Raises
    ------
    InputError
        If an argument is outside its range, or a library or device is missing.

    Notes
    -----
    Equations, meshes, tolerances and error estimates are those of :func:`stribeck.solve`; results differ by less than the
    two estimates together, and between array libraries by less than 1e-8 (``test_batch.py``). Made for states that crowd:
    some ten thousand in a study, not a hundred all over the box. States at rest are solved one by one. No run on a GPU has
    been measured.

    Source: [BP] Appendix A; numerics.md, "Many states at once".
    """
    if not isinstance(groups, Groups):
        raise InputError(f"groups = {show(groups)}; they must be Groups(speed, load, roughness) of arrays.")
    if groups.law is not None and not is_exponential(groups.law):
        raise InputError(f"batches hold the exponential contact law, not {groups.law.name}; use solve, or a sweep.")
    check_rtol(rtol)
    target, name = device_for(backend, device, memory)
    shape = groups.shape
    columns = Groups(
        *(np.broadcast_to(getattr(groups, part), shape).reshape(-1, 1) for part in ("speed", "load", "roughness"))
    )
    work = _Work(columns, rtol, target, on_progress)
    with one_torch_thread(target.xp), np.errstate(all="ignore"):
        work.run()
    values = dict(
        zip((f.name for f in fields(Observables)), work.values.T.reshape(len(fields(Observables)), *shape), strict=True)
    )
    errors = work.errors.T.reshape(len(NAMES), *shape)
    outcome, batched = work.outcome.reshape(shape), work.batched.reshape(shape)
    return BatchSolution(groups, rtol, name, outcome, batched, relative_errors=errors, **values)


class _Work:
    """The states of a run in rows, and what is known of them so far."""

    def __init__(self, groups: Groups, rtol: float, device: Device, on_progress: Progress | None) -> None:
        self.groups, self.rtol, self.device, self.on_progress = groups, rtol, device, on_progress
        total = len(np.asarray(groups.speed))
        self.values = np.full((total, len(fields(Observables))), np.nan)
        self.errors = np.full((total, len(NAMES)), np.nan)
        self.outcome = np.full(total, Outcome.INTERRUPTED, dtype=object)
        self.batched = np.zeros(total, dtype=bool)

    def run(self) -> None:
        """Solve batch by batch, then what is left one by one; end early on Ctrl-C."""
        close, scattered, single = planned(self.groups)
        try:
            for attempt, batches in ((self._close, close), (self._scattered, scattered)):
                for rows in batches:
                    found = attempt(rows)
                    for row, answer in found.items():
                        self._keep(int(rows[row]), answer)
                    left = np.setdiff1d(np.arange(len(rows)), list(found))
                    single = np.concatenate([single, rows[left]])
                    self._tell()
            for row in single:
                self._alone(int(row))
                self._tell()
        except KeyboardInterrupt:
            return

    def _close(self, rows: Indices) -> dict[int, Answer]:
        groups = column_groups(self.groups, rows)
        pilot = cold_start(_one(groups, middle(groups)))
        return refined(spread(pilot.states[-1], groups), self.rtol, self.device) if pilot.outcome.ok else {}

    def _scattered(self, rows: Indices) -> dict[int, Answer]:
        coarse, kept = descend(column_groups(self.groups, rows), self.device)
        found = {} if coarse is None else refined(coarse, self.rtol, self.device)
        return {int(kept[row]): answer for row, answer in found.items()}

    def _keep(self, row: int, answer: Answer) -> None:
        self.values[row] = [getattr(answer.values, f.name) for f in fields(Observables)]
        self.errors[row] = np.maximum(answer.estimate.relative, least_estimate(self.rtol))
        self.outcome[row], self.batched[row] = answer.outcome, True

    def _alone(self, row: int) -> None:
        try:
            solution = solve(_one(self.groups, row), rtol=self.rtol, on_failure="return")
        except SolveError as error:
            self.outcome[row] = error.outcome
            return
        self.values[row] = [getattr(solution.observables, f.name) for f in fields(Observables)]
        self.errors[row], self.outcome[row] = solution.relative_errors, solution.outcome

    def _tell(self) -> None:
        if self.on_progress is not None:
            done = sum(one is not Outcome.INTERRUPTED for one in self.outcome)
            self.on_progress(done, len(self.outcome))


def _one(groups: Groups, row: int) -> Groups:
    """Return one state of groups that are columns."""
    return Groups(*(float(np.asarray(getattr(groups, name))[row, 0]) for name in ("speed", "load", "roughness")))
