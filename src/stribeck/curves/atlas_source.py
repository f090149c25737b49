"""Curves off the atlas: observables and friction of its tables, with their exact slopes."""

import math
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np

from stribeck import atlas
from stribeck._types import Array
from stribeck.atlas.lookup import read_friction, viscous_of
from stribeck.atlas.tables import TableRow, table_for
from stribeck.contacts.cut_off import far_film
from stribeck.contacts.friction_rules import RULES
from stribeck.contacts.groups import Groups
from stribeck.curves.coordinate import Coordinate
from stribeck.curves.source import Coefficients, Parts, Readings, Source
from stribeck.numerics.dual import Dual, slope_of
from stribeck.quantities.lazy import cached_property
from stribeck.quantities.outcome import Outcome
from stribeck.quantities.outputs import ABSOLUTE
from stribeck.solver.solve import solve

OBSERVABLES = ("contact_load_share", "fluid_load_share", "central_gap", "minimum_gap", "flux_gap", "offset")
PLACES_PER_DECADE = 20  # Places between which events are looked for
ERROR_LENGTH = 2.0  # Change of ln(value) over which the error of a table may turn, in that of a slope


@dataclass(frozen=True, eq=False)
class AtlasSource(Source):
    """Numbers off the atlas between two values of the coordinate."""

    coordinate: Coordinate
    low: float
    high: float
    rtol: float = field(init=False)  # Stated relative error of the table

    outcome = Outcome.CONVERGED
    states = 0

    def __post_init__(self) -> None:
        """Refuse a geometry, model or law that the atlas does not hold, and ends outside its box."""
        object.__setattr__(self, "rtol", self.table.error)
        atlas.contact_load_share(self._groups(np.array(self.ends)))

    @cached_property
    def table(self) -> TableRow:
        """The table of the atlas that holds for the curve."""
        return table_for(self._groups(np.log([self.low])))

    @property
    def ends(self) -> tuple[float, float]:
        """Logarithms of both values."""
        return math.log(self.low), math.log(self.high)

    @property
    def places(self) -> Array:
        """Places evenly along the curve."""
        low, high = self.ends
        return np.linspace(low, high, 2 + round(PLACES_PER_DECADE * (high - low) / math.log(10)))

    def _groups(self, s: Array) -> Groups:
        """Return the groups at places, which are inside but for rounding."""
        return self.coordinate.groups_along(np.clip(np.exp(s), self.low, self.high))

    def read(self, s: Array, rtol: float | None = None) -> Readings:
        """Return what the table has at places, with its stated error, which is relative, of load shares too."""
        groups = self._groups(s)
        names = tuple(each for each in OBSERVABLES if each != "flux_gap" or each in self.table.functions)
        values = {name: np.asarray(getattr(atlas, name)(groups)) for name in names}
        scales = [values[name] if name in ABSOLUTE else np.ones(groups.shape) for name in names]

        unknown = np.full(groups.shape, np.nan)
        return Readings(names, values, self.rtol * np.stack(scales, axis=-1), unknown, self.rtol, partial(self._terms, groups))

    def _terms(self, groups: Groups, read: Readings, *coefficients: Any) -> Array:
        """Return both parts of the friction of groups, their sum and its error, shape (n, 4)."""
        boundary_friction, beta, definition = coefficients
        reading, inputs = read_friction(groups, definition), self.inputs(groups.load, beta)
        contact = boundary_friction * self.sliding * reading.contact
        viscous = viscous_of(groups, reading, inputs, definition)
        total, model = contact + viscous, {"model": groups.model, "far": far_film(groups.model)}
        far = RULES[self.table.geometry].far_error(reading.parts, groups.speed, groups.load, inputs | model)
        return np.stack([contact, viscous, total, self.rtol * np.abs(total) + far], axis=1)

    def _friction(self, groups: Groups, coefficients: Any, slopes: int = 0) -> tuple[Any, Any]:
        """Return both parts of the friction, with derivatives by the groups if wanted."""
        boundary_friction, beta, definition = coefficients
        load = Dual(groups.load, np.eye(3)[1][:, None] * groups.load) if slopes else groups.load
        share, viscous = atlas.friction_terms(groups, self.inputs(load, beta), definition, slopes)
        return boundary_friction * self.sliding * share, viscous

    def parts(self, s: Array, coefficients: Coefficients) -> Parts:
        """Return the load share of the fluid and both parts of the friction."""
        groups = self._groups(s)
        return np.asarray(atlas.fluid_load_share(groups)), *self._friction(groups, coefficients)

    def slopes(self, s: Array, coefficients: Coefficients) -> Array:
        """Return the derivatives of the friction by the coordinate."""
        contact, viscous = self._friction(self._groups(s), coefficients, slopes=3)
        return np.asarray(self.coordinate.direction @ slope_of(contact + viscous))

    def length_at(self, s: float) -> float:
        """Return the length over which the error of a table may turn."""
        return ERROR_LENGTH

    def holds(self, s: float, accepted: float) -> bool:
        """Return that nothing is solved."""
        return True

    def solved(self, s: float, rtol: float) -> Any:
        """Return the solution at a place, solved from cold."""
        return solve(self.coordinate.contact_at(s) or self.coordinate.groups_at(s), rtol=rtol)

    @cached_property
    def sliding(self) -> float:
        """Fraction of the sliding friction of asperities that acts, with its sign."""
        rule = RULES[self.table.geometry]
        return float(rule.sliding_factor(self._groups(np.log([self.low])), rule.of_contact(self.coordinate.contact)))

    def inputs(self, load: Any, beta: float) -> dict[str, Any]:
        """Return the arguments of the friction other than the groups, at the load group, which may have derivatives."""
        contact, rule = self.coordinate.contact, RULES[self.table.geometry]
        found: dict[str, Any] = {**rule.of_contact(contact), "beta": beta}
        if contact is not None and self.coordinate.over == "load":  # a length in Hertz radii changes with it
            found |= {name: found[name] * (load / contact.groups.load) ** by["load"] for name, by in rule.exponents.items()}
        return found
