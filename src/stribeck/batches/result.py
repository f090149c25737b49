"""What :func:`stribeck.solve_batch` returns: observables, friction and outcomes of many states in arrays."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from stribeck._types import Array, Flags
from stribeck.batches.inputs import Contacts
from stribeck.contacts.contact import Contact
from stribeck.contacts.cut_off import far_film
from stribeck.contacts.friction import DEFINITIONS, Definition, FrictionArray, check_definition
from stribeck.contacts.friction_rules import RULES
from stribeck.contacts.geometries import LINE
from stribeck.contacts.groups import Groups
from stribeck.contacts.regime import REGIMES, friction_share, regime_numbers
from stribeck.files.datasets import Column
from stribeck.files.results import Exported, Labelled
from stribeck.quantities.keywords import answers_typos
from stribeck.quantities.outcome import Outcome
from stribeck.quantities.outputs import COLUMNS, OUTPUT_TABLES, OutputTable, friction_rows
from stribeck.quantities.results import ByValue, Card, Shown
from stribeck.quantities.units import InputError, show
from stribeck.solver.numbers import absolute_error

__all__ = ["BatchSolution"]


@dataclass(frozen=True, eq=False, repr=False)
class BatchSolution(Exported, Shown, ByValue):
    """Observables of many states, in arrays of the shape of the groups; gaps in u_Hz, nan if there is no state.

    Its dataset has along :attr:`dims` the inputs that were given, observables, friction by both definitions, films in SI units
    where there are contacts, errors and outcomes.

    Attributes
    ----------
    groups : Groups
        The states.
    contacts : ndarray of LineContact or PointContact, or None
        The contacts they came from.
    dims : tuple of str
        Name of each dimension of the arrays.
    varied : tuple of str
        Inputs that were given for the batch.
    rtol : float
        The relative tolerance asked for.
    outcome : ndarray of Outcome
        How the solve of each state ended.
    values : dict of str to ndarray
        The observables of the geometry by name; they are attributes too, such as ``contact_load_share`` or ``central_gap``.
    errors : dict of str to ndarray
        Estimated errors of the observables as a solution states them: relative, but absolute for the load shares.
    error_estimate : ndarray
        The largest of these of each state, as a solution states it.
    own_viscous : dict of str to ndarray
        By definition, viscous friction of each contact and its absolute error [-], where the observables do not give it: of
        balls in a fluid that thins or in liquid that ends near the contact; else empty.
    """

    _picture = "stribeck.plot.batch.plot_states"

    groups: Groups
    contacts: Contacts | None
    dims: tuple[str, ...]
    varied: tuple[str, ...]
    rtol: float
    outcome: np.ndarray[Any, np.dtype[np.object_]]
    values: dict[str, Array] = field(repr=False)
    errors: dict[str, Array] = field(repr=False)
    error_estimate: Array = field(repr=False)
    own_viscous: dict[Definition, Array] = field(default_factory=dict, repr=False)

    def __getattr__(self, name: str) -> Array:
        """Return an observable under its own name."""
        if not name.startswith("_") and name != "values" and name in self.values:
            return self.values[name]
        # Of a property that fails Python asks here, and would show none of what failed.
        return object.__getattribute__(self, name)  # type: ignore[no-any-return]

    def __dir__(self) -> list[str]:
        """Return the names of attributes, observables among them."""
        return [*super().__dir__(), *self.values]

    @property
    def outputs(self) -> OutputTable:
        """The table of the observables of this geometry."""
        return OUTPUT_TABLES[self.groups.geometry]

    @property
    def ok(self) -> Flags:
        """Whether each state converged."""
        return np.array([one.ok for one in self.outcome.ravel()], dtype=bool).reshape(self.outcome.shape)

    @property
    def relative_errors(self) -> Array:
        """All of :attr:`errors` in one array, shape (observables, ...)."""
        return np.stack(list(self.errors.values()))

    @property
    def friction(self) -> FrictionArray:
        r"""The friction coefficients [-], balanced: an array with its parts ``asperities``, ``fluid`` and its ``error``.

        .. math:: \mu = \mu_0 \frac{F_c}{F_N} + \beta \, \mu_f(\beta = 1)

        The coefficients are those of the contacts, or 1 where only groups are known.  ``friction(boundary_friction, beta,
        definition)`` is the same for other coefficients, each of which may be left out, as on a solution.
        """
        return self._friction()

    @answers_typos
    def _friction(
        self, boundary_friction: float | None = None, beta: float | None = None, definition: Definition = "balanced"
    ) -> FrictionArray:
        rule, groups, definition = RULES[self.groups.geometry], self.groups, check_definition(definition)
        if beta is not None and self.own_viscous:
            film = groups.model.film
            liquid = f"a fluid that thins ({film.name})" if film.uses_speed else "a disc of liquid"
            raise InputError(
                f"beta = {show(beta)}: the friction of a ball in {liquid} needs the flow "
                "up to where the liquid ends, which batches keep for the beta of their contacts alone; leave it out, or solve "
                "the states one by one."
            )
        inputs = {"beta": self._coefficient("beta", beta), "far": far_film(groups.model)}
        for name, of in rule.inputs.items():
            inputs.setdefault(name, self._each(of))
        mu0 = rule.sliding_factor(groups, inputs) * self._coefficient("boundary_friction", boundary_friction)
        if self.own_viscous:
            viscous, error = self.own_viscous[definition]
        else:
            parts = {name: self.values[name] for name in rule.parts("published") + rule.parts(definition)}
            viscous = rule.viscous(parts, groups.speed, groups.load, inputs, definition)
            error = rule.viscous_error(parts, self.errors, groups.speed, groups.load, inputs, definition)
        error = np.abs(mu0) * self.errors["contact_load_share"] + error
        contact = mu0 * self.contact_load_share
        return FrictionArray(contact, viscous, contact + viscous, error, self._friction)

    @property
    def regime(self) -> np.ndarray[Any, np.dtype[np.str_]]:
        """Lubrication regime of each state, as :func:`stribeck.regime_of` tells it; empty text if there is no state."""
        friction = self.friction
        part = friction_share(friction.asperities, friction.fluid)
        return np.where(self.ok, np.array(REGIMES)[regime_numbers(self.fluid_load_share, part)], "")

    def _each(self, of: Callable[[Any], float]) -> float | Array:
        """Return an input of each contact; of groups alone, that of a contact that has none of its own."""
        if self.contacts is None:
            return float(of(None))
        return np.array([of(contact) for contact in self.contacts.ravel()]).reshape(self.contacts.shape)

    def _coefficient(self, name: str, given: float | None) -> float | Array:
        if given is not None or self.contacts is None:
            return LINE.checked(name, 1.0 if given is None else given)
        return self._each(lambda contact: getattr(contact, name))

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
        hertz = [contact.hertz for contact in self.contacts.ravel()]
        scales = {
            "gap": np.reshape([each.indentation for each in hertz], self.contacts.shape),
            "width": np.reshape([each.half_width for each in hertz], self.contacts.shape),
        }
        scales["pressure"] = np.reshape([each.pressure for each in hertz], self.contacts.shape)
        rows = [row for row in self.outputs.rows if row.film and row.name in self.values]
        return {row.film: self.values[row.name] * scales[row.scale] for row in rows}

    def _labelled(self) -> Labelled:
        columns: dict[str, Column] = {}
        for name, about in self.outputs.listed.items():
            if name in self.values or name == "error_estimate":
                columns[name] = (self.dims, getattr(self, name), *about)
        for row in self.outputs.rows:
            if row.listed and row.error and row.name in self.errors:
                error = absolute_error(row, self.values[row.name], self.errors[row.name])
                columns[f"{row.name}_error"] = (self.dims, error, "1", f"estimated absolute error of {row.name}")
        for definition in DEFINITIONS:
            found = self.friction(definition=definition)
            rows = zip(friction_rows(definition).items(), (found.total, found.fluid, found.error), strict=True)
            columns |= {name: (self.dims, values, *about) for (name, about), values in rows}
        if self.contacts is not None:
            for name, values in self.to_si().items():
                columns[name] = (self.dims, values, *self.outputs.films[name])
        columns["regime"] = (self.dims, self.regime.astype(object), *COLUMNS["regime"])
        columns["outcome"] = (self.dims, np.vectorize(_name, otypes=[object])(self.outcome), *COLUMNS["outcome"])
        coords = {}
        for name in self.varied:
            dims, values = _along(self.dims, self.input(name))
            coords[name] = (dims, values, self.unit(name), name.replace("_", " "))
        return columns, coords, {"title": "States of a lubricated rough contact", "rtol": self.rtol}

    def input(self, name: str) -> Array:
        """Return an input of each state.

        Parameters
        ----------
        name : str
            Its name; groups for a batch of groups.

        Returns
        -------
        ndarray
            Values in SI units, of the shape of the batch.
        """
        if self.contacts is None:
            return np.broadcast_to(getattr(self.groups, name), self.groups.shape)
        kept = [getattr(contact, name) for contact in self.contacts.ravel()]
        return np.array(kept, dtype=float).reshape(self.contacts.shape)

    def unit(self, name: str) -> str:
        """Return the SI unit of an input; ``"1"`` of a bare number.

        Parameters
        ----------
        name : str
            Its name.

        Returns
        -------
        str
            The unit.
        """
        if self.contacts is None:
            return "1"
        first: Contact = self.contacts.ravel()[0]
        return first.INPUTS.unit(name)

    def _card(self) -> Card:
        shape = ", ".join(f"{name} {size}" for name, size in zip(self.dims, self.groups.shape, strict=True)) or "one state"
        rows = [("given", ", ".join(self.varied) or "nothing"), ("converged", f"{int(self.ok.sum())} of {self.ok.size}")]
        if self.ok.any():
            friction = np.asarray(self.friction)[self.ok]
            rows.append(("regimes", ", ".join(dict.fromkeys(filter(None, self.regime.ravel())))))
            rows.append(("friction", f"{friction.min():.4g} to {friction.max():.4g} (balanced)"))
            rows.append(("estimated error", f"{self.error_estimate[self.ok].max():.1e} (rtol {self.rtol:g})"))
        return Card(shape, rows)


def _name(outcome: Outcome) -> str:
    return outcome.name


def _along(dims: tuple[str, ...], values: Array) -> tuple[tuple[str, ...], Array]:
    """Return an array along those dimensions only on which it depends."""
    for axis in reversed(range(values.ndim)):
        first = values.take([0], axis)
        if len(dims) > 1 and np.array_equal(values, np.broadcast_to(first, values.shape)):
            values, dims = np.asarray(values.take(0, axis)), (*dims[:axis], *dims[axis + 1 :])
    return dims, values
