"""Arrays of states in one call, of inputs that broadcast as NumPy does, or by the names of their dimensions."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from stribeck._types import Flags
from stribeck.batches.executors import solve_all, solve_here
from stribeck.batches.result import BatchSolution, without_fields
from stribeck.batches.states import Ended, Objects, States, contacts_at
from stribeck.contacts.contact import Contact
from stribeck.contacts.groups import Groups
from stribeck.quantities.outcome import Outcome
from stribeck.quantities.outputs import GROUPS
from stribeck.quantities.units import InputError, checked_callback, show, to_si
from stribeck.solver.solve import check_rtol

Progress = Callable[[int, int], object]


def solve_batch(
    problem: Groups | Contact,
    *,
    rtol: float = 1e-6,
    dims: Sequence[str] | None = None,
    on_progress: Progress | None = None,
    **inputs: Any,
) -> BatchSolution:
    r"""Solve many states, each from its neighbour.

    Parameters
    ----------
    problem : Groups or LineContact or PointContact
        The states, groups of arrays that broadcast, or the contact of which inputs vary. Their contact law may be any.
    rtol : float
        Relative error allowed in every observable, absolute for the load shares; from 1e-11 to 1e-2.
    dims : sequence of str, optional
        Names of the dimensions of plain arrays; by default that of the only input that varies along each.
    on_progress : callable, optional
        ``on_progress(done, total)`` is called after every state. It may raise KeyboardInterrupt.
    **inputs : number, str, pint.Quantity, array_like of these, or xarray.DataArray
        Inputs of the contact, or groups, that vary: arrays broadcast as those of NumPy do, those of xarray by the names of
        their dimensions.

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
    if not isinstance(problem, Groups | Contact):
        raise InputError(f"problem = {show(problem)}; it must be a contact or Groups(speed, load, roughness) of arrays.")
    rtol = check_rtol(rtol)
    checked_callback("on_progress", on_progress)
    groups, contacts, names = varied(problem, inputs, dims)
    if isinstance(problem, Contact):
        given = tuple(dict.fromkeys(problem.INPUTS.stands_for.get(name, name) for name in inputs))
    else:
        given = tuple(name for name in GROUPS if name in inputs or np.ndim(getattr(problem, name)))
    states = States(rtol=rtol, **States.flat(groups, contacts))
    kept = _InMemory(len(states.groups))

    def report_progress() -> None:
        if on_progress is not None:
            on_progress(int(kept.done().sum()), len(states.groups))

    solve_all(states, kept, solve_here, _without_fields, report_progress)
    outcome, solutions = kept.outcome.reshape(groups.shape), kept.solutions.reshape(groups.shape)
    return BatchSolution(groups, contacts, names, given, rtol, outcome, solutions)


class _InMemory:
    """States that are kept in memory."""

    def __init__(self, total: int) -> None:
        self.outcome = np.full(total, Outcome.INTERRUPTED, dtype=object)
        self.solutions = np.full(total, None, dtype=object)
        self._done = np.zeros(total, dtype=bool)

    def done(self) -> Flags:
        """Return whether each state has ended."""
        return self._done

    def keep(self, rows: Sequence[tuple[int, Ended]]) -> None:
        """Keep states that have ended; a fault of the program ends the batch."""
        for number, ended in rows:
            if ended.fault is not None:
                raise ended.fault
            self.outcome[number], self.solutions[number], self._done[number] = ended.outcome, ended.solution, True


def _without_fields(ended: Ended, states: States, i: int) -> Ended:
    return ended if ended.solution is None else replace(ended, solution=without_fields(ended.solution))


def varied(
    problem: Groups | Contact, inputs: Mapping[str, Any], dims: Sequence[str] | None
) -> tuple[Groups, Objects | None, tuple[str, ...]]:
    """Return the groups of all states, their contacts if they have any, and the names of the dimensions."""
    if isinstance(problem, Groups):
        table = {name: getattr(problem, name) for name in GROUPS} | dict(inputs)
        unknown = [name for name in table if name not in GROUPS]
        if unknown:
            raise InputError(f"{unknown[0]} is no group; Groups have {', '.join(GROUPS)}, a contact has more inputs.")
        columns, names = broadcast_inputs(table, dims)
        return replace(problem, **{name: _numbers(name, column) for name, column in columns.items()}), None, names
    columns, names = broadcast_inputs(inputs, dims)
    contacts, groups = contacts_at(problem, columns)
    return groups, contacts, names


def broadcast_inputs(inputs: Mapping[str, Any], dims: Sequence[str] | None) -> tuple[dict[str, Any], tuple[str, ...]]:
    """Return the inputs as arrays of objects of one shape, and the name of each dimension."""
    named = {name: tuple(map(str, value.dims)) for name, value in inputs.items() if hasattr(value, "dims")}
    arrays = {name: _array(getattr(value, "values", value) if name in named else value) for name, value in inputs.items()}
    if any(named.values()):
        return _by_name(arrays, named)
    try:
        shape = np.broadcast_shapes(*(array.shape for array in arrays.values()))
    except ValueError:
        shapes = ", ".join(f"{name} {array.shape}" for name, array in arrays.items() if array.ndim)
        raise InputError(f"the shapes of the inputs do not broadcast: {shapes}.") from None
    if dims is not None and (not isinstance(dims, list | tuple) or len(dims) != len(shape)):
        raise InputError(f"dims = {show(dims)} must be {len(shape)} names, one for each dimension of {shape}.")
    names = tuple(map(str, dims)) if dims is not None else tuple(_name(arrays, shape, axis) for axis in range(len(shape)))
    if len(set(names)) < len(names):
        raise InputError(f"dims = {show(names)} must be different names.")
    return {name: np.broadcast_to(array, shape) for name, array in arrays.items()}, names


def _numbers(name: str, column: Any) -> Any:
    """Return the numbers of a group, which have no units."""
    made = np.array([to_si(each, "number", name) for each in column.ravel()])
    return made.reshape(column.shape)


def _array(value: Any) -> Any:
    """Return numbers, text or quantities as an array of objects."""
    if hasattr(value, "magnitude") and hasattr(value, "units"):
        made = np.empty(np.shape(value.magnitude), dtype=object)
        for index in np.ndindex(made.shape):
            made[index] = type(value)(np.asarray(value.magnitude)[index].item(), value.units)
        return made
    if isinstance(value, list | tuple) and any(hasattr(each, "units") for each in value):
        made = np.empty(len(value), dtype=object)
        made[:] = value
        return made
    try:
        return np.asarray(value).astype(object)
    except ValueError:  # ragged lists
        raise InputError(f"{show(value)} is no array of numbers or text: its rows have different lengths.") from None


def _name(arrays: Mapping[str, Any], shape: tuple[int, ...], axis: int) -> str:
    from_end = axis - len(shape)
    along = [name for name, array in arrays.items() if array.ndim >= -from_end and array.shape[from_end] > 1]
    only = [name for name in along if sum(size > 1 for size in arrays[name].shape) == 1]
    return only[0] if len(along) == 1 and only else f"dim_{axis}"


def _by_name(arrays: Mapping[str, Any], named: Mapping[str, tuple[str, ...]]) -> tuple[dict[str, Any], tuple[str, ...]]:
    """Return arrays of which some have names of dimensions, spread over all of these."""
    sizes: dict[str, int] = {}
    for name, array in arrays.items():
        if array.ndim and name not in named:
            raise InputError(f"{name} is an array without names of dimensions beside others that have them; name its too.")
        for dim, size in zip(named.get(name, ()), array.shape, strict=True):
            if sizes.setdefault(dim, size) != size:
                raise InputError(f"the dimension {dim} has {sizes[dim]} places in one input and {size} in {name}.")
    names, found = tuple(sizes), {}
    for name, array in arrays.items():
        own = named.get(name, ())
        order = [own.index(dim) for dim in names if dim in own]
        spread = array.transpose(order).reshape([sizes[dim] if dim in own else 1 for dim in names])
        found[name] = np.broadcast_to(spread, tuple(sizes.values()))
    return found, names
