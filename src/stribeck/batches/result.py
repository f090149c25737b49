"""What :func:`stribeck.solve_batch` returns: many states, whose numbers are read off them as arrays."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Annotated, Any

import numpy as np

from stribeck._types import Array, Flags
from stribeck.batches.states import Objects
from stribeck.contact_laws.law import law_attributes
from stribeck.contacts.contact import Contact, part_attributes
from stribeck.contacts.friction import Definition, FrictionArray
from stribeck.contacts.groups import Groups
from stribeck.files.datasets import Column
from stribeck.files.results import Exported, Labelled
from stribeck.quantities.keywords import answers_typos
from stribeck.quantities.outputs import COLUMNS, OUTPUT_TABLES, OutputTable
from stribeck.quantities.results import ByValue, Card, Shown
from stribeck.quantities.units import InputError, listed
from stribeck.solver.base_solution import BaseSolution
from stribeck.solver.numbers import columns_of_states, constant_groups, input_attributes, si_films
from stribeck.solver.point.solution import PointSolution


def without_fields(solution: Any) -> Any:
    """Return a state with its numbers alone: the fields of thousands would fill the memory."""
    # Its fluid holds what was computed of it, and those of a contact are made anew.
    groups = solution.groups if solution.contact is None else solution.contact.groups
    if getattr(solution.contact, "asperity_friction", None) is not None:
        _ = solution.real_contact_area  # of the fields, by which asperities rub
    area = {name: value for name, value in vars(solution).items() if name == "_real_area"}
    if isinstance(solution, PointSolution):
        names = "mesh", "nodal_gap", "nodal_contact_pressure", "nodal_fluid_pressure", "fields", "work"
        fields: dict[str, Any] = {"groups": groups, **dict.fromkeys(names)}
        observables = replace(solution.observables, _groups=groups)
        found = replace(solution, groups=groups, observables=observables, state=replace(solution.state, **fields))
    else:
        found = replace(solution, groups=groups, mesh=None, nodal_gap=None, nodal_pressures=None)
    vars(found).update(area)
    return found


@dataclass(frozen=True, eq=False, repr=False)
class BatchSolution(Exported, Shown, ByValue):
    """Observables of many states, in arrays of the shape of the groups; gaps in u_Hz, nan if there is no state.

    The observables of the geometry are attributes, such as ``contact_load_share`` or ``central_gap``.  Its dataset has along
    :attr:`dims` the inputs that were given, observables, friction by both definitions, films in SI units where there are
    contacts, errors and outcomes.
    """

    _picture = "stribeck.plot.curve.plot_states"

    groups: Annotated[Groups, "the states; where a fluid or solid varies, with that of the first"]
    contacts: Annotated[Objects | None, "the contacts they came from"]
    dims: Annotated[tuple[str, ...], "name of each dimension of the arrays"]
    varied: Annotated[tuple[str, ...], "inputs that were given for the batch"]
    rtol: Annotated[float, "the relative tolerance asked for"]
    outcome: Annotated[Objects, "how the solve of each state ended"]
    solutions: Annotated[
        Objects,
        "the states with their numbers, but without their fields; None if there is no state",
    ] = field(repr=False)

    def __getattr__(self, name: str) -> Array:
        """Return an observable under its own name."""
        if not name.startswith("_") and name != "solutions" and name in self._observables:
            return self._each(lambda state: getattr(state, name))
        # Of a property that fails Python asks here, and would show none of what failed.
        return object.__getattribute__(self, name)  # type: ignore[no-any-return]

    def __dir__(self) -> list[str]:
        """Return the names of attributes, observables among them."""
        return [*super().__dir__(), *self._observables]

    @property
    def _observables(self) -> list[str]:
        return [row.name for row in self.outputs.rows]

    def _each(self, number_of: Callable[[Any], Any]) -> Array:
        """Return a number of each state, nan where there is none."""
        numbers = [math.nan if each is None else number_of(each) for each in self.solutions.ravel()]
        return np.array(numbers, dtype=float).reshape(self.solutions.shape)

    @property
    def outputs(self) -> OutputTable:
        """The table of the observables of these states."""
        solved: list[BaseSolution] = [each for each in self.solutions.ravel() if each is not None]
        return solved[0].outputs if solved else OUTPUT_TABLES[self.groups.geometry]

    @property
    def ok(self) -> Flags:
        """Whether each state converged."""
        return np.array([one.ok for one in self.outcome.ravel()], dtype=bool).reshape(self.outcome.shape)

    @property
    def values(self) -> dict[str, Array]:
        """The observables by name."""
        return {name: getattr(self, name) for name in self._observables}

    @property
    def errors(self) -> dict[str, Array]:
        """Estimated errors of the observables as a solution states them: relative, but absolute for the load shares."""

        def errors_of(name: str) -> Array:
            return self._each(lambda state: state.errors.get(name, math.nan))

        return {name: errors_of(name) for name in self.outputs.names}

    @property
    def relative_errors(self) -> Array:
        """All of :attr:`errors` in one array, shape (observables, ...)."""
        return np.stack(list(self.errors.values()))

    @property
    def friction(self) -> FrictionArray:
        """The friction coefficients [-], balanced: an array with its parts ``asperities``, ``fluid`` and its ``error``.

        ``friction(boundary_friction, beta, definition)`` returns it for others than those of the contacts, or 1 of groups.
        """
        return self._friction()

    @answers_typos
    def _friction(
        self, boundary_friction: float | None = None, beta: float | None = None, definition: Definition = "balanced"
    ) -> FrictionArray:
        given = boundary_friction, beta, definition
        found = [None if each is None else each.friction(*given) for each in self.solutions.ravel()]
        none = (math.nan,) * 4
        terms = [none if each is None else (each.asperities, each.fluid, each.total, each.error) for each in found]
        asperities, fluid, total, error = np.reshape(np.array(terms, dtype=float).T, (4, *self.solutions.shape))
        return FrictionArray(asperities, fluid, total, error, self._friction)

    @property
    def regime(self) -> np.ndarray[Any, np.dtype[np.str_]]:
        """Lubrication regime of each state, as :func:`stribeck.regime_of` tells it; empty text if there is no state."""
        found = ["" if each is None else each.regime for each in self.solutions.ravel()]
        return np.where(self.ok, np.array(found, dtype=str).reshape(self.solutions.shape), "")

    def to_si(self) -> dict[str, Array]:
        """Return films and other observables that have a scale in SI units.

        Returns
        -------
        dict of str to ndarray
            By name, such as ``central_film_thickness`` [m].

        Raises
        ------
        InputError
            If the states come from groups alone, which do not fix the scales.
        """
        if self.contacts is None:
            raise InputError("to_si needs the Hertz scales of a contact; give solve_batch a contact instead of Groups.")

        def films(name: str) -> Array:
            return self._each(lambda state: si_films(state)[name][0])

        return {name: films(name) for name in self.outputs.films}

    def _labelled(self) -> Labelled:
        flat = self.solutions.ravel()
        if not flat.size:
            raise InputError(f"There are no states, as an array of {listed(self.varied)} is empty; give at least one value.")
        solved = np.array([each is not None for each in flat], dtype=bool)
        columns: dict[str, Column] = {}
        for name, (values, unit, label) in columns_of_states(flat[solved].tolist()).items():
            every = np.full(len(flat), math.nan)
            every[solved] = values
            columns[name] = (self.dims, every.reshape(self.solutions.shape), unit, label)
        columns["regime"] = (self.dims, self.regime.astype(object), *COLUMNS["regime"])
        columns["outcome"] = (self.dims, _names(self.outcome), *COLUMNS["outcome"])
        coords = {}
        for name in self.varied:
            values, unit = self._input(name)
            coords[name] = (*_along(self.dims, values), unit, name.replace("_", " "))
        about = {"title": "States of a lubricated rough contact", "rtol": self.rtol, "definition": "balanced"}
        return columns, coords, about | self._shared_attributes

    @property
    def _shared_attributes(self) -> dict[str, Any]:
        """What is the same in all states."""
        contacts = [] if self.contacts is None else self.contacts.ravel().tolist()
        first, groups = contacts[0] if contacts else None, constant_groups(self.groups)
        law, others = law_attributes(self.groups.law), [law_attributes(each.law) for each in contacts]
        found = {name: value for name, value in law.items() if all(each.get(name) == value for each in others)}
        found |= {"geometry": self.groups.geometry, **part_attributes(self.groups, first)}
        kept = {name: value for name, value in found.items() if not name.endswith(tuple(f"_{each}" for each in self.varied))}
        return kept | {f"{name}_group": each for name, each in groups.items()} | input_attributes(first, *self.varied)

    def _input(self, name: str) -> tuple[Array, str]:
        """Return an input of each state and its SI unit."""
        if self.contacts is None:
            return np.broadcast_to(getattr(self.groups, name), self.groups.shape), "1"
        kept = [getattr(contact, name) for contact in self.contacts.ravel()]
        first: Contact = self.contacts.ravel()[0]
        return np.array(kept, dtype=float).reshape(self.contacts.shape), first.INPUTS.rows[name].unit

    def _card(self) -> Card:
        shape = ", ".join(f"{name} {size}" for name, size in zip(self.dims, self.groups.shape, strict=True)) or "one state"
        rows = [("given", ", ".join(self.varied) or "nothing"), ("converged", f"{int(self.ok.sum())} of {self.ok.size}")]
        if self.ok.any():
            friction = np.asarray(self.friction)[self.ok]
            rows.append(("regimes", ", ".join(dict.fromkeys(filter(None, self.regime.ravel())))))
            rows.append(("friction", f"{friction.min():.4g} to {friction.max():.4g} (balanced)"))
            rows.append(("estimated error", f"{self.error_estimate[self.ok].max():.1e} (rtol {self.rtol:g})"))
        return Card(shape, rows)


_names = np.vectorize(lambda outcome: outcome.name, otypes=[object])


def _along(dims: tuple[str, ...], values: Array) -> tuple[tuple[str, ...], Array]:
    """Return an array along those dimensions only on which it depends."""
    for axis in reversed(range(values.ndim)):
        first = values.take([0], axis)
        if len(dims) > 1 and np.array_equal(values, np.broadcast_to(first, values.shape)):
            values, dims = np.asarray(values.take(0, axis)), (*dims[:axis], *dims[axis + 1 :])
    return dims, values
