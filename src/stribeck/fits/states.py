"""The states of a fit: off the atlas, read between solved ones, or solved, with their derivatives.

What asperities rub by and the observables of the viscous friction come without their factors, which may differ from state to
state: :mod:`stribeck.contacts.friction_rules` puts them together.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from stribeck import atlas
from stribeck._types import Array, Indices
from stribeck.atlas.tables import table_for
from stribeck.contacts.contact import Contact
from stribeck.contacts.friction import Definition
from stribeck.contacts.friction_rules import RULES
from stribeck.contacts.groups import Groups
from stribeck.equations.sensitivity import Change
from stribeck.numerics.scattered import Scattered, lengths_of
from stribeck.numerics.threads import one_blas_thread
from stribeck.quantities.units import InputError
from stribeck.solver.neighbours import Neighbours, Observed

Changes = Mapping[int, Change]
"""What free inputs, by their numbers, change of the model, in Hertz units."""

Inputs = Mapping[str, float]
"""What friction takes beside the groups: where the liquid ends among it."""

FAR_DOUBT = 1e-2  # Doubt up to which curves are read between solved ones, see :mod:`stribeck.numerics.scattered`

SAFETY = 8.0  # Largest fourth derivative of a part of the friction by ln(speed), over its size (test_point_fit)


@dataclass(frozen=True)
class FrictionParts:
    """The contributions to the friction of n states, and their derivatives."""

    values: Array  # What asperities rub by, the observables that the rule of the geometry names, the contact load share [-]
    slopes: Array
    errors: Array  # Estimated absolute errors of the first and the last, and errors of the others as a solution states them


@dataclass(eq=False)
class States:
    """The states of a fit, by the quickest of the atlas, curves that were solved nearby, and Neighbours."""

    contact: Contact  # Where the liquid ends
    by: tuple[str, ...]  # Groups that move with the free inputs
    uses_atlas: bool  # Whether the search is on the atlas; else curves are read between solved ones
    definition: Definition
    rtol: float
    on_state: Callable[[], object] = lambda: None  # Called after each state that is solved
    must_solve: bool = False
    neighbours: Neighbours = field(init=False)
    known: dict[int, tuple[Scattered, list[FrictionParts]]] = field(default_factory=dict)  # Solved curves

    def __post_init__(self) -> None:
        """Take Neighbours, as yet without states."""
        self.neighbours = Neighbours(self.rtol)

    def __reduce__(self) -> tuple[type[States], tuple[Any, ...]]:
        """Return how to make it anew where it is unpickled: what it keeps of solved states stays behind."""
        return States, (self.contact, self.by, self.uses_atlas, self.definition, self.rtol)

    def solved(self) -> States:
        """Return the same with all states solved, of which these know then too."""
        found = replace(self, must_solve=True)
        found.neighbours = self.neighbours
        return found

    @one_blas_thread
    def parts(self, groups: Groups, changes: Changes, inputs: Inputs | None = None) -> FrictionParts:
        """Return the parts of states, with derivatives along changes of the model; ``inputs`` are by default the contact's."""
        if self.uses_atlas and not self.must_solve:
            try:
                parts = atlas.friction_parts(groups, self.definition)
                values, slopes = (np.concatenate([each, each[:1]]) for each in parts)  # the load share is what rubs
                return FrictionParts(values, slopes, np.full(values.shape, table_for(groups).error))
            except InputError:
                pass
        rows = np.stack(np.broadcast_arrays(groups.speed, groups.load, groups.roughness), axis=1)
        found = []
        pairs, of_row = np.unique(rows[:, 1:], axis=0, return_inverse=True)
        for i, (load, roughness) in enumerate(pairs.tolist()):
            here = np.nonzero(of_row.ravel() == i)[0]
            here = here[np.argsort(-rows[here, 0])]
            speed = places(rows[here, 0], self.rtol)
            is_read = len(speed) < len(here)
            by = ("speed", *self.by) if is_read else self.by
            rows_of = (Groups(each, load, roughness, **groups.physics) for each in speed.tolist())
            states = [self._solved(each, by, changes, inputs) for each in rows_of]
            columns = Observed(*(np.stack(column, axis=-1) for column in zip(*states, strict=True)))
            columns = _between_speeds(speed, columns, rows[here, 0], self.rtol) if is_read else columns
            found.append((here, FrictionParts(*columns)))
        return together(found)

    def _solved(self, groups: Groups, by: Sequence[str], changes: Changes, inputs: Inputs | None) -> Observed:
        rule, observable = RULES[groups.geometry], self.contact.friction_of_asperities.observable
        inputs = rule.of_contact(self.contact) if inputs is None else inputs
        names = (observable, *rule.parts(self.definition), "contact_load_share")
        found = self.neighbours.observed(groups, names, list(changes.values()), by=by, inputs=inputs)
        self.on_state()
        return found

    def curve(self, curve: int, place: Array, moving: Indices, solve: Callable[[], FrictionParts]) -> FrictionParts:
        """Return the parts of one curve, with slopes by all inputs, read between solved ones where that leaves no doubt."""
        doubt = self.known[curve][0].doubt(place) if curve in self.known else math.inf
        if doubt > (0.0 if self.must_solve else FAR_DOUBT):
            here = solve()
            size = np.ones_like(here.values)
            size[1:-1] = np.abs(here.values[1:-1]).max(axis=0)
            slopes = np.moveaxis(here.slopes[:, moving], 1, 0)
            lengths = lengths_of((slopes / size).reshape(len(moving), size.size))
            scattered, solved = self.known.setdefault(curve, (Scattered(lengths), []))
            scattered.add(place, here.values.ravel(), slopes.reshape(len(moving), size.size))
            solved.append(here)
            return here
        scattered, solved = self.known[curve]
        near = solved[scattered.nearest(place)]
        values, by = scattered.at(place)
        slopes = np.zeros_like(near.slopes)
        slopes[:, moving] = by.reshape(len(moving), *near.values.shape).swapaxes(0, 1)
        return FrictionParts(values.reshape(near.values.shape), slopes, near.errors + doubt)


def together(found: list[tuple[Indices, FrictionParts]]) -> FrictionParts:
    """Return the parts of all rows by those of some of them each."""
    order = np.argsort(np.concatenate([rows for rows, _ in found]))
    values, slopes, errors = (
        np.concatenate([getattr(each, name) for _, each in found], axis=-1)[..., order]
        for name in ("values", "slopes", "errors")
    )
    return FrictionParts(values, slopes, errors)


def places(speeds: Array, rtol: float) -> Array:
    """Return the falling speeds themselves, or fewer ones between which cubics with their slopes miss less than ``rtol``."""
    # A cubic misses by the fourth power of the step over 384 times the fourth derivative.
    step = (384 * rtol / SAFETY) ** 0.25
    count = math.ceil(math.log(speeds[0] / speeds[-1]) / step) + 1
    return speeds if len(speeds) <= count else np.geomspace(speeds[0], speeds[-1], count)


def _between_speeds(speed: Array, found: Observed, wanted: Array, rtol: float) -> Observed:
    """Return what is wanted between falling speeds: values by cubics with slopes, slopes by cubic splines."""
    from scipy.interpolate import CubicHermiteSpline, make_interp_spline

    values, slopes, errors = (each[..., ::-1] for each in found)
    at, to = np.log(speed[::-1]), np.log(wanted).clip(*np.log(speed[[-1, 0]]))
    read = CubicHermiteSpline(at, values, slopes[:, 0], axis=1)(to)
    degree = min(3, len(at) - 1)
    return Observed(
        read,
        make_interp_spline(at, slopes, degree, axis=2)(to),
        np.stack([np.interp(to, at, row) for row in errors]) + rtol,
    )
