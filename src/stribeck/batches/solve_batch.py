"""Arrays of states in one call."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, fields
from functools import partial
from typing import Any

import numpy as np

from stribeck._types import Array, Flags, Indices
from stribeck.batches.chain import Ended, solve_in_order
from stribeck.batches.order import chains_of
from stribeck.contacts.friction import Definition, check_definition
from stribeck.contacts.groups import Groups
from stribeck.contacts.model import ARTICLE
from stribeck.equations.observables import Observables
from stribeck.quantities.inputs import quantity
from stribeck.quantities.outcome import Outcome
from stribeck.quantities.outputs import ALL_NAMES, NAMES
from stribeck.quantities.units import InputError, show
from stribeck.solver.solve import check_rtol

__all__ = ["BatchSolution", "solve_batch"]

Progress = Callable[[int, int], object]


@dataclass(frozen=True, eq=False)
class BatchSolution:
    """Observables of many states, in arrays of the shape of the groups; gaps in u_Hz, nan if there is no state.

    Attributes
    ----------
    groups : Groups
        The states.
    rtol : float
        The relative tolerance asked for.
    outcome : ndarray of Outcome
        How the solve of each state ended.
    contact_load_share, fluid_load_share : ndarray
        Parts of the load on asperities and fluid [-].
    central_gap, minimum_gap, flux_gap : ndarray
        Gap at x = 0, minimum gap and flux gap [u_Hz].
    minimum_position : ndarray
        Where the gap is at its minimum [a].
    offset : ndarray
        Height of the apex of the undeformed cylinder [u_Hz].
    viscous_published, viscous_balanced : ndarray
        Viscous friction for beta = 1 in its two definitions [-].
    viscous_upper : ndarray
        Viscous friction on the cylinder, for beta = 1 [-].
    exit_position, reformation_position : ndarray
        Where the film ends and begins anew [a]; nan where it does not.
    relative_errors : ndarray, shape (observables, ...)
        Estimated relative errors of the observables, absolute for the load shares; by name in :attr:`errors`.
    """

    groups: Groups
    rtol: float
    outcome: np.ndarray[Any, np.dtype[np.object_]]
    contact_load_share: Array = field(repr=False)
    fluid_load_share: Array = field(repr=False)
    central_gap: Array = field(repr=False)
    minimum_gap: Array = field(repr=False)
    minimum_position: Array = field(repr=False)
    flux_gap: Array = field(repr=False)
    offset: Array = field(repr=False)
    viscous_published: Array = field(repr=False)
    viscous_balanced: Array = field(repr=False)
    viscous_upper: Array = field(repr=False)
    exit_position: Array = field(repr=False)
    reformation_position: Array = field(repr=False)
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
        return dict(zip(ALL_NAMES, self.relative_errors, strict=False))

    def friction(self, boundary_friction: float = 1.0, beta: float = 1.0, definition: Definition = "balanced") -> Array:
        r"""Return the friction coefficients.

        .. math:: \mu = \mu_0 \frac{F_c}{F_N} + \beta \, \mu_f(\beta = 1)

        Parameters
        ----------
        boundary_friction : float
            Friction coefficient of the dry contact [-], >= 0.
        beta : float
            Coefficient of the contact law [-], > 0.
        definition : {"balanced", "published"}
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
        boundary_friction, beta = quantity("boundary_friction", boundary_friction), quantity("beta", beta)
        viscous: Array = getattr(self, f"viscous_{check_definition(definition)}")
        return boundary_friction * self.contact_load_share + beta * viscous


def solve_batch(groups: Groups, *, rtol: float = 1e-6, on_progress: Progress | None = None) -> BatchSolution:
    r"""Solve many states, each from its neighbour.

    Parameters
    ----------
    groups : Groups
        The states; arrays broadcast. Their contact law may be any.
    rtol : float
        Relative error allowed in every observable, absolute for the load shares; from 1e-11 to 1e-2.
    on_progress : callable, optional
        ``on_progress(done, total)`` is called after every state. It may raise KeyboardInterrupt.

    Returns
    -------
    BatchSolution
        Observables, outcomes and error estimates. A state that failed, or that an interruption left undone, has its outcome.

    Raises
    ------
    InputError
        If an argument is outside its range.

    Notes
    -----
    Each state meets ``rtol`` by the error estimate of :func:`stribeck.solve`; the two results differ by less than the two
    estimates together (``test_batch.py``). The states are put in chains of neighbours, as :func:`stribeck.sweep` does; a
    sweep also keeps them on disk and solves chains in parallel.

    Source: [BP] Appendix A; numerics.md, "Many states".
    """
    if not isinstance(groups, Groups):
        raise InputError(f"groups = {show(groups)}; they must be Groups(speed, load, roughness) of arrays.")
    check_rtol(rtol)
    shape = groups.shape
    parts = (groups.speed, groups.load, groups.roughness)
    states = np.stack([np.broadcast_to(part, shape).ravel() for part in parts], axis=1)
    total = len(states)
    is_grid = all(np.size(part) < total for part in parts)
    values = np.full((len(fields(Observables)), total), np.nan)
    errors = np.full((len(NAMES if groups.model == ARTICLE else ALL_NAMES), total), np.nan)
    outcome = np.full(total, Outcome.INTERRUPTED, dtype=object)
    done = 0

    def keep(rows: Indices, i: int, ended: Ended) -> None:
        nonlocal done
        row = rows[i]
        if ended.fault is not None:
            raise ended.fault
        outcome[row], done = ended.outcome, done + 1
        if ended.solution is not None:
            values[:, row] = [getattr(ended.solution.observables, f.name) for f in fields(Observables)]
            errors[: len(ended.solution.relative_errors), row] = ended.solution.relative_errors
        if on_progress is not None:
            on_progress(done, total)

    try:
        for chain in chains_of(states, shape if is_grid else ()):
            solve_in_order(states[chain], groups.physics, rtol, partial(keep, chain))
    except KeyboardInterrupt:
        pass
    found = {f.name: value.reshape(shape) for f, value in zip(fields(Observables), values, strict=True)}
    return BatchSolution(groups, rtol, outcome.reshape(shape), relative_errors=errors.reshape(len(errors), *shape), **found)
