"""Inputs that are arrays: broadcast as NumPy does, or by the names of their dimensions, into one contact for each state."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from stribeck.batches.states import Objects
from stribeck.contacts.contact import Contact
from stribeck.contacts.groups import Groups
from stribeck.quantities.outputs import GROUPS
from stribeck.quantities.units import InputError, show, to_si


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


def contacts_at(base: Contact, columns: Mapping[str, Any]) -> tuple[Objects, Groups]:
    """Return a contact for each state, changed by columns of objects, and their groups, with the parts of the first."""
    contacts: Objects = np.empty(next(iter(columns.values())).shape if columns else (), dtype=object)
    for i, index in enumerate(np.ndindex(contacts.shape)):
        try:
            contacts[index] = base.replace(**{name: column[index] for name, column in columns.items()})
        except InputError as problem:
            raise InputError(f"state {i}: {problem}" if contacts.size > 1 else str(problem)) from None
    flat = [contact.groups for contact in contacts.ravel()]
    arrays = {name: np.reshape([float(getattr(each, name)) for each in flat], contacts.shape) for name in GROUPS}
    return contacts, replace(flat[0] if flat else base.groups, **arrays)


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
