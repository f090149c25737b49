"""The coordinate of a curve: speed, load or roughness, one group or one SI quantity on a logarithmic scale."""

import copy
import math
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from stribeck._types import Array
from stribeck.contacts.contact import Contact
from stribeck.contacts.groups import Geometry, Groups
from stribeck.contacts.inputs import InputTable
from stribeck.equations.sensitivity import GROUPS
from stribeck.quantities.formats import format_si
from stribeck.quantities.lazy import cached_property
from stribeck.quantities.units import InputError, show, to_si
from stribeck.solver.solve import as_groups

Over = Literal["speed", "load", "roughness"]

POINTS_RANGE = (2, 100_000)  # Fewest and most points of a curve
END_ROUNDING = 1e-12  # Relative rounding of the ends of a curve: a value given as the end is inside


@dataclass(frozen=True)
class Coordinate:
    """The coordinate of a curve: the logarithm of one group, or of one SI quantity of a contact."""

    over: Over
    base: Groups | Contact

    def contact_at(self, s: float) -> Contact | None:
        """Return the contact at coordinate s."""
        return self.base.replace(**{self.over: math.exp(s)}) if isinstance(self.base, Contact) else None

    @cached_property
    def _formed(self) -> dict[float, Groups]:
        """Groups that were asked for, as a path asks for those of a place many times."""
        return {}

    def groups_at(self, s: float) -> Groups:
        """Return the groups at coordinate s."""
        if s not in self._formed:
            varied: dict[str, Any] = {self.over: math.exp(s)}
            if isinstance(self.base, Contact):
                varying = copy.copy(
                    self.base
                )  # nothing is checked again: of a model that varies, each series takes ten groups
                vars(varying).update(varied)
                self._formed[s] = varying.groups
            else:
                self._formed[s] = replace(self.base, **varied)
        return self._formed[s]

    def groups_along(self, values: Array) -> Groups:
        """Return the groups at many values of the coordinate, as arrays."""
        first = self.groups_at(math.log(values[0])) if len(values) else self.groups_at(0.0)
        ratios = values / values[0] if len(values) else values
        numbers = (float(getattr(first, name)) * ratios**n for name, n in zip(GROUPS, self.direction.tolist(), strict=True))
        return Groups(*numbers, **first.physics)

    @property
    def geometry(self) -> Geometry:
        """A cylinder or a ball."""
        return self.groups_at(0.0).geometry if isinstance(self.base, Contact) else self.base.geometry

    def inside(self, values: Array, ends: tuple[float, float]) -> Array:
        """Return those values that lie between two places, but for rounding."""
        low, high = ends
        return values[(values >= math.exp(low) * (1 - END_ROUNDING)) & (values <= math.exp(high) * (1 + END_ROUNDING))]

    @property
    def contact(self) -> Contact | None:
        """The contact at its own values, None for groups."""
        return self.base if isinstance(self.base, Contact) else None

    @property
    def unit(self) -> str:
        """SI unit of what varies; ``"1"`` of groups."""
        return self.base.INPUTS.quantities[self.over].unit if isinstance(self.base, Contact) else "1"

    def text(self, value: float, digits: int = 3) -> str:
        """Return a value with its unit."""
        if isinstance(self.base, Groups):
            return f"{value:.{digits}g}"
        return format_si(value, self.base.INPUTS.quantities[self.over].dimension, digits)

    def where(self, *values: float) -> str:
        """Return values in words, such as ``"speed 1 mm/s to 1 m/s"``."""
        what = f"{self.over} group" if isinstance(self.base, Groups) else self.over
        return f"{what} {' to '.join(map(self.text, values))}"

    @property
    def direction(self) -> Array:
        """Derivatives of ln(speed), ln(load), ln(roughness) of the groups along s."""
        if isinstance(self.base, Contact):
            return np.array(self.base.INPUTS.exponents[self.over], dtype=float)
        return np.array([1.0 if name == self.over else 0.0 for name in GROUPS])


def read_problem(problem: Contact | Groups | None, given: dict[Over, Any]) -> tuple[Contact | Groups, Over, Array | None]:
    """Return the fixed inputs, the name of the one that varies, and its ends or points; None if these are not given."""
    ranges = [name for name, value in given.items() if value is not None and _dimensions(name, value) > 0]
    if len(ranges) > 1:
        raise InputError(f"{' and '.join(ranges)} are both ranges; a curve varies one of speed, load and roughness.")
    over: Over = ranges[0] if ranges else "speed"
    fixed = {name: value for name, value in given.items() if value is not None and name not in ranges}
    if problem is None:
        missing = [name for name in GROUPS if name != over and name not in fixed]
        if missing:
            raise InputError(
                f"{' and '.join(missing)} missing; give a LineContact or PointContact, or the groups that do not vary."
            )
        low = 1.0 if not ranges else float(_ends(over, given[over], None)[0])
        base: Contact | Groups = Groups(**{over: low, **fixed})
    elif isinstance(problem, Contact):
        base = problem.replace(**fixed) if fixed else problem
    else:
        as_groups(problem)
        base = replace(problem, **fixed)
    if over == "load" and isinstance(base, Contact) and base.profile is not None:
        raise InputError(
            f"a curve over the load with profile = {show(base.profile)}: its contact grows with the load in its own way, and "
            "no series of the groups follows; take solve_batch over loads, or a curve over the speed."
        )
    if not ranges:
        return base, over, None
    return base, over, _ends(over, given[over], base.INPUTS if isinstance(base, Contact) else None)


def _dimensions(name: str, value: Any) -> int:
    """Return 0 for a number and 1 for a range; refuse ragged and nested lists, and anything that is not a number."""
    try:
        # Magnitudes of quantities of pint, which NumPy does not take one by one.
        numbers: Any = [getattr(each, "magnitude", each) for each in value] if isinstance(value, list | tuple) else value
        found = np.ndim(numbers)
    except ValueError:  # ragged lists
        found = 2
    if found > 1 or isinstance(value, dict | set):
        raise InputError(f"{name} = {show(value)}; give a number, a range (low, high), or a list of increasing numbers.")
    return found


def _ends(over: Over, value: Any, table: InputTable | None) -> Array:
    """Return the ends or points of a range as ascending positive numbers."""
    items = [value] if isinstance(value, str) else list(value)
    found = plain_numbers(over, value, items, table, "a range of groups is made of plain numbers.")
    if len(found) < 2 or not np.isfinite(found).all() or not (found > 0).all() or not (np.diff(found) > 0).all():
        raise InputError(
            f"{over} = {show(value)}; a range is two or more finite positive increasing numbers, such as (1e-9, 10)."
        )
    return found


def plain_numbers(name: str, value: Any, items: list[Any], table: InputTable | None, advice: str) -> Array:
    """Return the items of an argument in SI units where a table has its quantity, else as the plain numbers of groups."""
    if table is not None:
        row = table.quantities[name]
        return np.array([to_si(item, row.dimension, name, row.typical) for item in items], dtype=float)
    try:
        return np.array([float(item) for item in items])
    except (TypeError, ValueError):
        raise InputError(f"{name} = {show(value)}; {advice}") from None


def given_values(over: Over, value: Any, contact: Contact | None) -> Array:
    """Return one or many values of the coordinate as positive numbers."""
    many = _dimensions(over, value) > 0
    table = None if contact is None else contact.INPUTS
    found = plain_numbers(over, value, list(value) if many else [value], table, "groups are plain numbers.")
    if not (np.isfinite(found) & (found > 0)).all():
        raise InputError(f"{over} = {show(value)} must be finite and positive.")
    return found if many else found[0]


def check_inside(coordinate: Coordinate, values: Array) -> None:
    """Refuse a range whose groups cannot be formed."""
    for value in (values[0], values[-1]):
        if coordinate.groups_at(math.log(value)).is_hertzian:
            raise InputError("speed and roughness are both zero; the dry smooth contact has no curve; use solve.")
