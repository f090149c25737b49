"""Thousands of states at once: which are solved together, and what comes out.

States that are close are reached from one of them, along its derivatives; scattered ones come down together from the rigid
contact.  What neither brings to its tolerance is left to :func:`stribeck.solve`, and the result says so.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, fields
from typing import Any

import numpy as np

from ._types import Array, Flags, Indices
from .batch_equations import Device
from .batch_path import Answer, column_groups, descend, refined, spread
from .newton import Outcome
from .observables import NAMES, Observables
from .output import MissingExtraError
from .parameters import Groups, quantity
from .solution import Definition, check_definition
from .solve import SolveError, check_rtol, least_estimate, solve
from .start import SATURATED_LOAD, cold_start
from .threads import one_blas_thread
from .units import InputError, show

BACKENDS = ("numpy", "torch", "cupy")
"""Array libraries by name; any other that keeps to the standard may be given as its namespace."""

CPU_MEMORY, DEVICE_MEMORY = 4e6, 1e9
"""Bytes that the Jacobians of a batch may fill: on a processor what its cache holds is fastest, elsewhere many at once."""

CLOSE = 1.0
"""Extent of states that are reached from one of them, in units of :data:`STRETCH`."""

STRETCH = np.array([0.6, 1.0, 1.0])
"""How much a decade of speed, relative roughness and load changes the gap: films grow as speed**0.6."""

LEAST_CLOSE, LEAST_DESCENT = 6, 8
"""States that a batch of each kind must have: for fewer, single solves are faster."""

MOST_CLOSE, MOST_DESCENT = 256, 64
"""States that it may have."""

ALIKE = 10.0
"""Ratio of the widths of the layers at the edge of the contact that a descent spans: one mesh has to resolve both."""

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
    check_rtol(rtol)
    target, name = device_for(backend, device, memory)
    shape = groups.shape
    columns = Groups(
        *(np.broadcast_to(getattr(groups, part), shape).reshape(-1, 1) for part in ("speed", "load", "roughness"))
    )
    work = _Work(columns, rtol, target, on_progress)
    with one_torch_thread(target.xp), np.errstate(all="ignore"):
        work.run()
    values = dict(zip((f.name for f in fields(Observables)), work.values.T.reshape(-1, *shape), strict=True))
    errors = work.errors.T.reshape(-1, *shape)
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
        self.outcome[row], self.batched[row] = Outcome.CONVERGED, True

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


def coordinates(groups: Groups) -> Array:
    """Return where states lie, such that neighbours have like gaps, shape (rows, 3)."""
    kappa = np.asarray(groups.relative_roughness)
    speed, load = np.asarray(groups.speed), np.asarray(groups.load)
    return np.log(np.concatenate([speed, np.where(kappa > 0, kappa, 1.0), load], axis=1)) * STRETCH


def middle(groups: Groups) -> int:
    """Return the row of the state nearest to the middle of all."""
    points = coordinates(groups)
    return int(np.argmin(((points - 0.5 * (points.min(axis=0) + points.max(axis=0))) ** 2).sum(axis=1)))


def planned(groups: Groups) -> tuple[list[Indices], list[Indices], Indices]:
    """Return the rows of states that are close, of scattered ones that are alike, and of those to be solved one by one."""
    speed, load, kappa = (np.asarray(a)[:, 0] for a in (groups.speed, groups.load, groups.relative_roughness))
    moving, smooth = speed > 0, kappa == 0
    layer = np.maximum(kappa ** (2 / 3), speed**0.4)
    close: list[Indices] = []
    scattered: list[Indices] = []
    single = [np.flatnonzero(~moving)]
    for kind in (smooth, ~smooth):
        rows = np.flatnonzero(moving & kind)
        if not len(rows):
            continue
        loose = []
        for part in _bisected(coordinates(column_groups(groups, rows)), np.arange(len(rows))):
            (close if len(part) >= LEAST_CLOSE else loose).append(rows[part])
        rest = np.concatenate(loose) if loose else rows[:0]
        single.append(rest[load[rest] > SATURATED_LOAD])  # whose paths from the rigid contact are of another kind
        rest = rest[load[rest] <= SATURATED_LOAD]
        rest = rest[np.argsort(layer[rest])]
        while len(rest):
            alike = int((layer[rest[:MOST_DESCENT]] <= ALIKE * layer[rest[0]]).sum())
            batch, rest = rest[:alike], rest[alike:]
            (scattered if alike >= LEAST_DESCENT else single).append(batch)
    return close, scattered, np.concatenate(single)


def _bisected(points: Array, rows: Indices) -> Iterator[Indices]:
    """Yield parts of the rows whose points are close, halved in the middle of their longest extent until they are."""
    waiting = [rows]
    while waiting:
        rows = waiting.pop()
        here = points[rows]
        extent = here.max(axis=0) - here.min(axis=0)
        axis = int(np.argmax(extent))
        if extent[axis] <= CLOSE and len(rows) <= MOST_CLOSE:
            yield rows
        elif extent[axis] == 0.0:  # one state many times over
            waiting += np.array_split(rows, 2)
        else:
            above = here[:, axis] > here[:, axis].min() + 0.5 * extent[axis]
            waiting += [rows[above], rows[~above]]


def device_for(backend: Any, device: Any, memory: float | None) -> tuple[Device, str]:
    """Return where the linear algebra runs, and the name of the library; refuse what is not there."""
    if memory is not None and (isinstance(memory, bool) or not isinstance(memory, int | float) or not 0 < memory < np.inf):
        raise InputError(f"memory = {show(memory)}; it must be a positive number of bytes, for example 1e9.")
    if isinstance(backend, str) and backend not in BACKENDS:
        known = ", ".join(repr(name) for name in BACKENDS)
        raise InputError(f"backend = {show(backend)}; it must be {known}, or a namespace of the array API standard.")
    xp: Any = _namespace(backend) if isinstance(backend, str) else backend
    if not hasattr(xp, "linalg") or not hasattr(xp, "asarray"):
        raise InputError(f"backend = {show(backend)}; it has no asarray or linalg, and is no namespace of the standard.")
    name = backend if isinstance(backend, str) else str(getattr(backend, "__name__", backend))
    try:
        one = xp.asarray(np.ones((1, 1, 1)), dtype=xp.float64, device=device)
        xp.linalg.solve(one, one)
    except Exception as error:  # each library has errors of its own for a device that is not there
        reason = str(error).strip().split("\n")[0]
        raise InputError(f"device = {show(device)}; {name} cannot compute on it in double precision: {reason}") from None
    elsewhere = name == "cupy" or (device is not None and "cpu" not in str(device).lower())
    return Device(xp, device, memory or (DEVICE_MEMORY if elsewhere else CPU_MEMORY)), name


def _namespace(backend: str) -> Any:
    """Return the namespace of a library that is known by name."""
    if backend == "numpy" and hasattr(np, "__array_api_version__"):
        return np
    from importlib import import_module  # noqa: PLC0415

    try:
        return import_module(f"array_api_compat.{backend}")
    except ImportError:
        libraries = "array-api-compat" if backend == "numpy" else f"array-api-compat and {backend}"
        if backend == "cupy":
            raise InputError(
                "the backend 'cupy' needs array-api-compat and a CuPy for your CUDA; "
                "install them with: pip install array-api-compat cupy-cuda12x"
            ) from None
        raise MissingExtraError(f"the backend {backend!r}", "gpu", libraries) from None


@contextmanager
def one_torch_thread(xp: Any) -> Iterator[None]:
    """Keep PyTorch to one thread on the processor: with two, its batched LU was seen to fail from 150 unknowns on."""
    if "torch" not in getattr(xp, "__name__", ""):
        yield
        return
    import torch  # noqa: PLC0415

    before = torch.get_num_threads()
    torch.set_num_threads(1)
    try:
        yield
    finally:
        torch.set_num_threads(before)
