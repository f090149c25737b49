"""What any part of the package needs to know of one number stands once, where the number is declared.

A field of a law is, for example::

    @law
    class Carreau(RateLaw):
        relaxation_time: Input = Input(label="relaxation time", symbol="$t$", dimension="time", typical="1 ms", ...)

The field takes text with a unit or a number in SI units and holds a number within its range; the docstring says so.
Where errors count, a value may carry its own: ``"1.0 +- 0.2 um"``, ``"46 cSt +- 5 %"`` or a table of value and error.
"""

import functools
import inspect
import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, TypeVar, cast, dataclass_transform

import numpy as np

from stribeck.quantities.docstrings import complete_docstring
from stribeck.quantities.formats import format_percent, format_si
from stribeck.quantities.units import DIMENSIONS, InputError, show, to_si

MAX_RELATIVE_ERROR = 3.0  # Relative error beyond which a value has no information

_PLUS_MINUS = r"(?:\+\s*/?\s*-|±)"
_VALUE_WITH_ERROR = re.compile(rf"\s*(\S+)\s*(.*?)\s*{_PLUS_MINUS}\s*([0-9.eE+-]+)\s*(.*?)\s*", re.DOTALL)


def has_error(value: Any) -> bool:
    """Return whether a value is written with its error."""
    return isinstance(value, Mapping) or (isinstance(value, str) and re.search(_PLUS_MINUS, value) is not None)


def split_error(name: str, value: Any, dimension: str, example: str = "") -> tuple[Any, float | None]:
    """Return a value without its error, and that error relative to it."""
    if not has_error(value):
        return value, None
    if isinstance(value, Mapping):
        if set(value) != {"value", "error"}:
            raise InputError(f"{name} = {show(dict(value))} must be a table of value and error, such as "
                             f"{{ value = {show(example or DIMENSIONS[dimension].example)}, error = '20 %' }}.")  # fmt: skip
        center, error = value["value"], value["error"]
        if not (isinstance(error, str) and error.strip().endswith("%")):
            error = _number(f"the error of {name}", error, dimension)
    else:
        parts = _VALUE_WITH_ERROR.fullmatch(value)
        if parts is None:
            raise InputError(f"{name} = {show(value)} cannot be read; write it as '1.0 +- 0.2 um' or '1.0 um +- 20 %'.")
        number, unit, size, last = parts.groups()
        if last == "%":
            center, error = f"{number} {unit}", f"{size} %"
        else:
            center = f"{number} {unit or last}"
            error = _number(f"the error of {name}", f"{size} {last or unit}", dimension)
    known = _number(name, center, dimension, example)
    relative = _percent(name, error) if isinstance(error, str) else float(error) / known if known else math.inf
    if not 0 < relative <= MAX_RELATIVE_ERROR:
        raise InputError(
            f"{name} = {show(value)} has an error of {format_percent(relative, 3)}; it must be positive and below "
            f"{100 * MAX_RELATIVE_ERROR:.0f} % of a positive value."
        )
    return known, relative


def relative_error(name: str, value: float, error: Any, dimension: str) -> float:
    """Return the error of a value over it, given as text (``"20 %"``, ``"0.2 um"``) or as a number in SI units."""
    return float(split_error(name, {"value": value, "error": error}, dimension)[1] or 0.0)


def _number(name: str, value: Any, dimension: str, example: str = "") -> float:
    """Return a value in SI units; a bare number as text counts where there is no unit."""
    if isinstance(value, str) and not DIMENSIONS[dimension].unit:
        try:
            return float(value)
        except ValueError:
            raise InputError(f"{name} = {show(value)} must be a bare number.") from None
    return to_si(value, dimension, name, example)


def _percent(name: str, text: str) -> float:
    try:
        return float(text.strip().removesuffix("%")) / 100
    except ValueError:
        raise InputError(f"the error of {name} = {show(text)} is not a number of per cent.") from None


@dataclass(frozen=True, kw_only=True)
class Input:
    """A number that users give: an input of a contact, or a field of a law."""

    name: str = ""  # Name in Python, case files, on the command line, in fits, sweeps and files
    label: str  # Name in sentences
    symbol: str = ""  # TeX
    dimension: str  # A key of :data:`stribeck.quantities.units.DIMENSIONS`
    typical: str  # A value of a laboratory's contact
    source: str = ""  # Where that value is from
    usual: tuple[float, float] = (0.0, math.inf)  # Range that contacts have, in SI units: the ends of its slider
    implausible: float = math.inf
    units: tuple[str, ...] = ()  # Units to choose from; empty for a bare number
    typical_error: float = (
        0.0  # Standard error over the value, of one that was not measured on the contact itself; 0 if unknown
    )
    letters: tuple[str, ...] = ()  # Symbols and names that users type for it
    lowest: float = 0.0  # Lower bound, in SI units
    zero: bool = False  # Whether the lower bound itself is allowed
    highest: float = math.inf  # Largest value allowed, in SI units
    reason: str = ""  # What to say of a value out of bounds
    follows_surface: bool = False  # Whether it follows from the roughness of the surface, and no hand can turn it alone
    optional: bool = False  # Whether a contact does without it
    default: float | None = None  # Value that stands for one that is not given
    without: str = ""  # What a contact or law is without it, where no value stands for it
    or_else: str = ""  # Where else it may be from, as the end of the advice to add it
    is_free: bool = True  # Whether a fit may free it
    table: str = ""  # Table of a case file that has it, where it is a number of laws
    of: str = ""  # Laws that have such a number, for sentences
    known: int = 9  # Rank from what a fit is mostly after to what is mostly known: the order in which fits name their inputs

    def __set_name__(self, owner: type, name: str) -> None:
        """Take the name of the field."""
        object.__setattr__(self, "name", name)

    def __get__(self, law: object | None, owner: type) -> float:
        """Return the number of a law, or the default of the class."""
        if law is not None:
            found: float = law.__dict__[self.name]
            return found
        if self.default is None and not self.optional:
            raise AttributeError(f"{owner.__name__}.{self.name} has no default")
        return cast("float", self.default)

    def __set__(self, law: object, value: Any) -> None:
        """Set the number of a law that is made; None stands for an optional one that is not given."""
        law.__dict__[self.name] = self.default if value is None and self.optional else self.checked(value)

    @property
    def range(self) -> tuple[float, float]:
        """Lower and upper bound, in SI units."""
        return self.lowest, self.highest

    @property
    def example(self) -> str:
        """A value as a case file has it."""
        return f'"{self.typical}"' if DIMENSIONS[self.dimension].unit else self.typical

    @property
    def unit(self) -> str:
        """Its SI unit in the spelling of UDUNITS, which files use."""
        return DIMENSIONS[self.dimension].unit.replace("*", " ") or "1"

    @property
    def kind(self) -> str:
        """What a docstring says of its type."""
        kind = "str or float" if DIMENSIONS[self.dimension].unit else "float"
        return f"{kind}, optional" if self.optional or self.default is not None else kind

    @property
    def description(self) -> str:
        """What a docstring says of it."""
        symbol = f", :math:`{self.symbol.strip('$')}`" if self.symbol else ""
        unit, bounds = DIMENSIONS[self.dimension].unit or "-", self._bounds.removeprefix("be ")
        default = "" if self.default is None else f"; {self.default:g} by default"
        source = f" ({self.source})" if self.source else ""
        return (
            f"{self.label[0].upper()}{self.label[1:]}{symbol}, {bounds} [{unit}]{default}; for example {self.example}{source}."
        )

    @property
    def advice(self) -> str:
        """The advice to add it, with a typical value and where that is from."""
        source = f" ({self.source})" if self.source else ""
        other = f", {self.or_else}" if self.or_else else ""
        return f"add {DIMENSIONS[self.dimension].noun}, for example {self.name} = {self.example}{source}{other}"

    @property
    def without_it(self) -> str:
        """What stands where it is not given."""
        return self.without or ("" if self.default is None else format_si(self.default, self.dimension))

    @property
    def typical_value(self) -> float:
        """The typical value in SI units."""
        return to_si(self.typical if DIMENSIONS[self.dimension].unit else float(self.typical), self.dimension, self.name)

    def checked(self, value: Any) -> float:
        """Return a value in SI units, or refuse one out of bounds."""
        found = to_si(value, self.dimension, self.name, self.typical)
        if found > self.highest or found < self.lowest or (found == self.lowest and not self.zero):
            raise InputError(f"{self.name} = {show(value)} must {self._bounds}{f'; {self.reason}' if self.reason else ''}.")
        return found

    @property
    def _bounds(self) -> str:
        """What a value must be."""
        if self.lowest == -math.inf:
            return "be zero or below" if self.highest == 0 else f"be {self.highest:g} or less"
        if self.highest < math.inf:
            return f"be between {self.lowest:g} and {self.highest:g}"
        if self.lowest != 0:
            return f"be {self.lowest:g} or more" if self.zero else f"be above {self.lowest:g}"
        return "be zero or positive" if self.zero else "be positive"


@dataclass(frozen=True, kw_only=True)
class Series(Input):
    """Several numbers of one kind, as a list in a case file."""

    is_free: bool = False

    def __get__(self, law: object | None, owner: type) -> tuple[float, ...]:  # type: ignore[override]
        """Return the numbers of a law."""
        if law is None:
            raise AttributeError(f"{owner.__name__}.{self.name} has no default")
        found: tuple[float, ...] = law.__dict__[self.name]
        return found

    def __set__(self, law: object, value: Sequence[str | float]) -> None:
        """Set the numbers of a law that is made."""
        if isinstance(value, str | bytes) or not np.shape(value):
            raise InputError(f"{self.name} = {show(value)} must be a list, such as {self.typical}.")
        law.__dict__[self.name] = tuple(map(self.checked, value))

    @property
    def kind(self) -> str:
        """What a docstring says of its type."""
        return f"sequence of {super().kind}"

    @property
    def example(self) -> str:
        """A value as a case file has it."""
        return self.typical


Kind = TypeVar("Kind", bound=type)

RAISES = "InputError\n    Where a value is impossible or its unit is wrong."  # Section of the docstring of every law


# What some take beside their numbers.
OTHERS = {
    "base": "solid of sb.solids, optional\n    The shape of the body; a half-space without it.",
    "body": "profile of sb.profiles, optional\n    The shape that has the grooves; a cylinder without it.",
    "reversed": "bool\n    Whether the fluid enters from the other side.",
}


@dataclass_transform(frozen_default=True)
def law(kind: Kind) -> Kind:
    """Return a frozen dataclass; its docstring says of its numbers what their declarations say."""
    made: Any = dataclass(frozen=True)(kind)
    words = {name: f"{row.kind}\n    {row.description}" for name, row in numbers_of(made).items()}
    made.__doc__ = complete_docstring(made, OTHERS | words, raises=RAISES)
    return cast("Kind", made)


def _numbers_of(law: type | None) -> MappingProxyType[str, Input]:
    """Return the numbers that a class declares, by name, in the order of its arguments; none of no law."""
    kinds = () if law is None else reversed(law.__mro__)
    found = {name: each for kind in kinds for name, each in vars(kind).items() if isinstance(each, Input)}
    return MappingProxyType({name: found[name] for name in getattr(law, "__dataclass_fields__", {}) if name in found})


numbers_of: Callable[[type | None], MappingProxyType[str, Input]] = functools.cache(_numbers_of)


def needed_of(law: type | None) -> tuple[str, ...]:
    """Return the numbers that a law cannot do without."""
    return tuple(name for name, row in numbers_of(law).items() if row.default is None)


def arguments_of(law: type | None) -> tuple[str, ...]:
    """Return what a table that names a law may hold beside its name: its numbers, and its other arguments."""
    return () if law is None else tuple(name for name in inspect.signature(law).parameters if name != "base")


def made_of(law: Any, named: str, given: Mapping[str, Any], **others: Any) -> Any:
    """Return a law with its arguments, as the sentence ``named`` has it, and others; None of what does nothing."""
    own = arguments_of(law)
    for key in given:
        if key not in own:
            instead = f"it has {', '.join(own)}" if own else "remove it"
            raise InputError(f"{key} = {show(given[key])} is given, but {named} has no such key; {instead}.")
    for key in needed_of(law):
        if key not in given:
            raise InputError(f"{key} is missing, which {named} needs; add {key} = {numbers_of(law)[key].example}.")
    return None if law is None else law(**given, **others)
