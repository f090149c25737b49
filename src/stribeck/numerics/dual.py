r"""First derivatives of functions that are written with those of numpy, exact, as the function is evaluated.

What has a value and first derivatives goes through sums, products, powers, exponentials and the like as an array does, so that
a law that is written once brings its slope.  A :class:`Dual` has that by one number, or by several in the first axis,
:class:`stribeck.numerics.trace.Trace` those by fields.  The module knows no physics.

Source: [Griewank & Walther 2008] Evaluating Derivatives, chapter 3 (forward mode).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from functools import partial
from typing import Any, Self

import numpy as np

from stribeck._types import Array


class FirstOrder:
    """A value with first derivatives, in whatever form: what arithmetic and the functions of numpy make of it."""

    __slots__ = ("value",)

    value: Any

    def scaled(self, factor: Any, value: Any) -> Self:
        """Return another value, whose derivatives are these times a factor."""
        raise NotImplementedError

    def joined(self, other: Self | None, value: Any) -> Self:
        """Return another value, whose derivatives are these, plus those of another one."""
        raise NotImplementedError

    def __add__(self, other: Any) -> Self:
        """Return the sum."""
        if isinstance(other, FirstOrder):
            return self.joined(other, self.value + other.value)  # type: ignore[arg-type]
        return self.joined(None, self.value + other)

    __radd__ = __add__

    def __neg__(self) -> Self:
        """Return the negative."""
        return self.scaled(-1.0, -self.value)

    def __sub__(self, other: Any) -> Self:
        """Return the difference."""
        return self.__add__(-other)

    def __rsub__(self, other: Any) -> Self:
        """Return the difference."""
        return self.__neg__().__add__(other)

    def __mul__(self, other: Any) -> Self:
        """Return the product."""
        if isinstance(other, FirstOrder):
            value = self.value * other.value
            return self.scaled(other.value, value).joined(other.scaled(self.value, value), value)  # type: ignore[arg-type]
        return self.scaled(other, self.value * other)

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> Self:
        """Return the quotient."""
        if isinstance(other, FirstOrder):
            value, factor = self.value / other.value, 1.0 / other.value
            return self.scaled(factor, value).joined(other.scaled(-value * factor, value), value)  # type: ignore[arg-type]
        return self.scaled(1.0 / np.asarray(other), self.value / other)

    def __rtruediv__(self, other: Any) -> Self:
        """Return the quotient."""
        value = other / self.value
        return self.scaled(-value / self.value, value)

    def __pow__(self, exponent: Any) -> Self:
        """Return the power; an exponent without a derivative."""
        return np.power(self, exponent)  # type: ignore[no-any-return, call-overload]

    def __abs__(self) -> Self:
        """Return the absolute value."""
        return self.scaled(np.sign(self.value), np.abs(self.value))

    def __array_ufunc__(self, function: Any, method: str, *given: Any, **options: Any) -> Any:
        """Return what a function of numpy makes of it: a plain value where its derivative is zero."""
        if method != "__call__" or options:
            return NotImplemented
        operator = OPERATORS.get(function)
        if operator is not None:
            first, second = given
            return operator[0](first, second) if isinstance(first, FirstOrder) else operator[1](second, first)
        values = [value_of(each) for each in given]
        if function in FLAT:
            return function(*values)
        partials = PARTIALS.get(function) or SPECIAL.get(function.__name__)
        if partials is None:
            return NotImplemented
        value = function(*values)
        return chained(value, given, [partial(one, value, *values) for one in partials])


def chained(value: Any, given: Sequence[Any], slopes: Sequence[Any]) -> Any:
    """Return a value with the derivatives of what it follows from, each times a slope, or what gives it; None is one."""
    found: Any = None
    for each, slope in zip(given, slopes, strict=True):
        if isinstance(each, FirstOrder):
            factor = slope() if callable(slope) else slope
            part = each.joined(None, value) if factor is None else each.scaled(factor, value)
            found = part if found is None else found.joined(part, value)
    return value if found is None else found


class Dual(FirstOrder):
    """A value and its derivative."""

    __slots__ = ("slope",)

    def __init__(self, value: Any, slope: Any) -> None:
        self.value, self.slope = value, slope

    @property
    def shape(self) -> tuple[int, ...]:
        """The shape of the value."""
        return np.shape(self.value)

    def scaled(self, factor: Any, value: Any) -> Dual:
        """Return another value, whose derivative is this one times a factor."""
        return Dual(value, factor * self.slope)

    def joined(self, other: Dual | None, value: Any) -> Dual:
        """Return another value, whose derivative is this one, plus that of another dual."""
        return Dual(value, self.slope if other is None else self.slope + other.slope)

    def __getitem__(self, places: Any) -> Dual:
        """Return some places; the derivative has the axes of the value, perhaps after one of its own."""
        slope = np.broadcast_to(self.slope, np.shape(self.value)) if np.ndim(self.slope) == 0 else self.slope
        own = (slice(None),) * (np.ndim(slope) - np.ndim(self.value))
        return Dual(self.value[places], slope[*own, *(places if isinstance(places, tuple) else (places,))])

    def __matmul__(self, matrix: Array) -> Dual:
        """Return the product with a matrix of numbers; the derivative has the axes of the value."""
        return Dual(self.value @ matrix, self.slope @ matrix)

    def __lt__(self, other: Any) -> Any:
        """Return whether the value is less."""
        return self.value < value_of(other)

    def __le__(self, other: Any) -> Any:
        """Return whether the value is less or equal."""
        return self.value <= value_of(other)

    def __gt__(self, other: Any) -> Any:
        """Return whether the value is greater."""
        return self.value > value_of(other)

    def __ge__(self, other: Any) -> Any:
        """Return whether the value is greater or equal."""
        return self.value >= value_of(other)

    def __array_function__(self, function: Any, types: Any, given: Any, options: Any) -> Any:
        """Return a choice or a clipped value, constants of its shape, or the real part."""
        if function is np.where and len(given) == 3:
            chosen, first, second = given
            value = np.where(value_of(chosen), value_of(first), value_of(second))
            return Dual(value, np.where(value_of(chosen), slope_of(first), slope_of(second)))
        if function is np.clip:
            found, low, high = given
            return np.minimum(np.maximum(found, low), high)
        if function in (np.zeros_like, np.ones_like, np.full_like, np.shape, np.ndim):
            return function(given[0].value, *given[1:], **options)
        return NotImplemented


def by_logarithms(values: Iterable[Any], count: int, first: int = 0) -> list[Dual]:
    """Return positive numbers with derivatives by their own logarithms, among so many from a place on; infinity has none."""
    sizes = ((each, np.where(np.isfinite(each), each, 0.0)) for each in values)
    return [Dual(each, np.multiply.outer(row, size)) for (each, size), row in zip(sizes, np.eye(count)[first:], strict=False)]


def value_of(given: Any) -> Any:
    """Return the value of what has derivatives; what has none, as it is."""
    return given.value if isinstance(given, FirstOrder) else given


def slope_of(given: Any) -> Any:
    """Return the derivative of a dual; zero of what is none."""
    return given.slope if isinstance(given, Dual) else 0.0


def with_slope(function: Callable[[Any], Any], at: Array) -> tuple[Array, Array]:
    """Return a function of one number at places, and its derivative there."""
    at = np.asarray(at, dtype=float)
    found = function(Dual(at, 1.0))
    value, slope = value_of(found), slope_of(found)
    return _at_all_places(value, at), _at_all_places(slope, at)


def _at_all_places(values: Any, at: Array) -> Array:
    """Return values at all places."""
    if np.shape(values) == at.shape:
        return values  # type: ignore[no-any-return]
    return np.broadcast_to(np.asarray(values, dtype=float), at.shape)


# Functions that are constant but for jumps.
FLAT = {
    np.sign,
    np.isfinite,
    np.isnan,
    np.greater,
    np.greater_equal,
    np.less,
    np.less_equal,
    np.equal,
    np.not_equal,
    np.logical_and,
    np.logical_or,
    np.logical_not,
}

# Arithmetic with an array to the left, which asks numpy first: of what has derivatives to the left, and to the right.
OPERATORS: dict[Any, tuple[Callable[[Any, Any], Any], Callable[[Any, Any], Any]]] = {
    np.add: (FirstOrder.__add__, FirstOrder.__add__),
    np.subtract: (FirstOrder.__sub__, FirstOrder.__rsub__),
    np.multiply: (FirstOrder.__mul__, FirstOrder.__mul__),
    np.divide: (FirstOrder.__truediv__, FirstOrder.__rtruediv__),
}

Partial = Callable[..., Any]

# Derivatives of each function by what it takes, from its value and that.
PARTIALS: dict[Any, tuple[Partial, ...]] = {
    np.power: (lambda v, a, b: b * a ** (b - 1.0), lambda v, a, b: v * np.log(a)),
    np.negative: (lambda v, a: -1.0,),
    np.positive: (lambda v, a: 1.0,),
    np.square: (lambda v, a: 2.0 * a,),
    np.sqrt: (lambda v, a: 0.5 / v,),
    np.absolute: (lambda v, a: np.sign(a),),
    np.reciprocal: (lambda v, a: -v * v,),
    np.exp: (lambda v, a: v,),
    np.expm1: (lambda v, a: v + 1.0,),
    np.log: (lambda v, a: 1.0 / a,),
    np.log1p: (lambda v, a: 1.0 / (1.0 + a),),
    np.log10: (lambda v, a: 1.0 / (math.log(10.0) * a),),
    np.logaddexp: (lambda v, a, b: np.exp(a - v), lambda v, a, b: np.exp(b - v)),
    np.sin: (lambda v, a: np.cos(a),),
    np.cos: (lambda v, a: -np.sin(a),),
    np.sinh: (lambda v, a: np.cosh(a),),
    np.cosh: (lambda v, a: np.sinh(a),),
    np.tanh: (lambda v, a: 1.0 - v * v,),
    np.arctan: (lambda v, a: 1.0 / (1.0 + a * a),),
    np.arcsinh: (lambda v, a: 1.0 / np.hypot(1.0, a),),
    np.hypot: (lambda v, a, b: a / v, lambda v, a, b: b / v),
    np.copysign: (lambda v, a, b: np.copysign(1.0, b) * np.sign(a), lambda v, a, b: 0.0),
    np.maximum: (lambda v, a, b: 1.0 * (a >= b), lambda v, a, b: 1.0 * (a < b)),
    np.minimum: (lambda v, a, b: 1.0 * (a <= b), lambda v, a, b: 1.0 * (a > b)),
}

# Those of scipy.special, by their names: most laws need none of them, and to load them takes time.
SPECIAL: dict[str, tuple[Partial, ...]] = {
    "ndtr": (lambda v, a: np.exp(-0.5 * a * a) / math.sqrt(2 * math.pi),),
    "erf": (lambda v, a: 2.0 / math.sqrt(math.pi) * np.exp(-a * a),),
    "erfc": (lambda v, a: -2.0 / math.sqrt(math.pi) * np.exp(-a * a),),
    "expit": (lambda v, a: v * (1.0 - v),),
}
