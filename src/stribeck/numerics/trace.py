r"""Derivatives of functions of nodal fields, exact, as the function is evaluated.

A :class:`Trace` is a value with its derivatives: by each field a sum of terms ``diag(left) A diag(right)``, by each number
a column.  Pointwise functions bring their partial derivatives, see :func:`pointwise`; a constant linear map is an
:class:`Operator`, and the product of two is made once.  So that a function of fields that is written once gives its
value for plain arrays, also for many states in rows, and its Jacobian for traces.  The module knows no physics.

Source: [Griewank & Walther 2008] Evaluating Derivatives, chapter 3 (forward mode).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple, Protocol, TypeAlias
from weakref import WeakKeyDictionary

import numpy as np

from stribeck._types import Array, Numbers
from stribeck.numerics.dual import Dual, FirstOrder, chained, value_of
from stribeck.numerics.series import Jet


class Operator(Protocol):
    """A constant linear map of nodal values."""

    @property
    def matrix(self) -> Array:
        """The matrix, shape (rows, nodes)."""

    def __call__(self, values: Array) -> Array:
        """Return what it makes of nodal values, shape (..., nodes) -> (..., rows)."""

    def after(self, operator: Array) -> Array:
        """Return ``operator @ self``."""


class Matrix:
    """An operator that is known as a matrix, and keeps its products with others as long as these live."""

    def __init__(self, matrix: Array) -> None:
        self.matrix = matrix
        self._products: WeakKeyDictionary[Operator, Matrix] = WeakKeyDictionary()

    def __reduce__(self) -> tuple[Any, ...]:
        """Leave the products out of a pickle."""
        return Matrix, (self.matrix,)

    def __call__(self, values: Array) -> Array:
        """Return what it makes of nodal values."""
        return np.asarray(values @ self.matrix.T)

    def after(self, operator: Array) -> Array:
        """Return ``operator @ self``."""
        return np.asarray(operator @ self.matrix)

    def of(self, inner: Operator) -> Matrix:
        """Return the operator after another."""
        found = self._products.get(inner)
        if found is None:
            found = self._products[inner] = Matrix(inner.after(self.matrix))
        return found


class Term(NamedTuple):
    """One term ``diag(left) A diag(right)`` of a derivative; None stands for the identity."""

    left: Numbers | None
    operator: Operator | None
    right: Numbers | None


class Trace(FirstOrder):
    """A value and its derivatives."""

    __slots__ = ("columns", "terms")

    def __init__(
        self, value: Array, terms: Mapping[str, Sequence[Term]] | None = None, columns: Mapping[str, Array] | None = None
    ) -> None:
        self.value = value
        self.terms = terms or {}  # By field
        self.columns = columns or {}  # By number

    @classmethod
    def field(cls, name: str, value: Array, unit: Numbers | None = None) -> Trace:
        """Return a field of unknowns, measured in units."""
        return cls(value, {name: (Term(None, None, unit),)})

    @classmethod
    def number(cls, name: str, value: Array, unit: Numbers = 1.0) -> Trace:
        """Return a number among the unknowns, or any other, measured in a unit."""
        return cls(value, None, {name: np.full(np.shape(value), unit, dtype=float)})

    def scaled(self, factor: Any, value: Any) -> Trace:
        """Return another value, whose derivatives are these times a factor at each node."""
        terms = {
            name: [Term(_product(factor, left), operator, right) for left, operator, right in each]
            for name, each in self.terms.items()
        }
        return Trace(value, terms, {name: factor * column for name, column in self.columns.items()})

    def joined(self, other: Trace | None, value: Any) -> Trace:
        """Return another value, whose derivatives are these, plus those of another trace."""
        if other is None or not (other.terms or other.columns):
            return Trace(value, self.terms, self.columns)
        terms, columns = dict(self.terms), dict(self.columns)
        for name, each in other.terms.items():
            terms[name] = [*terms[name], *each] if name in terms else each
        for name, column in other.columns.items():
            columns[name] = columns[name] + column if name in columns else column
        return Trace(value, terms, columns)


Value: TypeAlias = Trace | Array | float


def mapped(function: Callable[[Any], Any], given: Any) -> Any:
    """Return a function of the value at the same node, which is written with those of numpy, of values or of their trace.

    It may give several values, and no derivatives are taken of what is none of them.
    """
    if not isinstance(given, Trace):
        return function(given)
    found = function(Dual(given.value, 1.0))
    several = found if isinstance(found, tuple) else (found,)
    traces = tuple(given.scaled(each.slope, each.value) if isinstance(each, Dual) else each for each in several)
    return traces if isinstance(found, tuple) else traces[0]


def pointwise(function: Callable[..., tuple[Any, ...]], *given: Any) -> Any:
    """Return a function of values at the same node, which returns its value and its derivative by each of them.

    A derivative None stands for one.  Of plain values the function gives its plain value.
    """
    value, *slopes = function(*(value_of(each) for each in given))
    return chained(value, given, slopes)


def act(operator: Operator, given: Any) -> Any:
    """Return what an operator makes of nodal values or of their trace; its rows, where they are one, keep their axis."""
    if isinstance(given, Jet):
        return given.mapped(operator)
    if not isinstance(given, Trace):
        return operator(given)
    terms = {name: [_after(operator, each) for each in own] for name, own in given.terms.items()}
    nodes = np.shape(given.value)[-1]
    columns = {
        name: operator(column if column.shape[-1] == nodes else np.broadcast_to(column, (*column.shape[:-1], nodes)))
        for name, column in given.columns.items()
    }
    return Trace(operator(given.value), terms, columns)


def _after(operator: Operator, term: Term) -> Term:
    """Return the term of an operator after another one."""
    left, inner, right = term
    if inner is None:
        return Term(None, operator, _product(left, right))
    if left is None or np.ndim(left) == 0 or np.shape(left)[-1] == 1:
        outer = operator if isinstance(operator, Matrix) else Matrix(operator.matrix)
        return Term(None, outer.of(inner), _product(left, right))
    return Term(None, Matrix(inner.after(operator.matrix * left)), right)


def _product(first: Numbers | None, second: Numbers | None) -> Any:
    """Return the product of two factors; None stands for one."""
    return second if first is None else first if second is None else first * second


def matrix_of(trace: Trace, name: str, out: Array) -> None:
    """Write the derivative by a field, whose factors on the left are numbers, into a matrix."""
    diagonal: Any = 0.0
    factors: dict[Operator, Any] = {}
    for left, operator, right in trace.terms.get(name, ()):
        factor = _product(left, right)
        factor = 1.0 if factor is None else factor
        if operator is None:
            diagonal = diagonal + factor
        else:
            factors[operator] = factors[operator] + factor if operator in factors else factor
    if not factors:
        out[...] = 0.0
    width = -(-out.shape[1] // 4)
    for start in range(0, out.shape[1], width):  # parts of the columns stay in the cache, and need no other matrix
        columns = slice(start, start + width)
        part = out[:, columns]
        for k, (operator, factor) in enumerate(factors.items()):
            own = factor[columns] if np.ndim(factor) else factor
            if k:
                part += operator.matrix[:, columns] * own
            else:
                np.multiply(operator.matrix[:, columns], own, out=part)
    if np.any(diagonal):
        np.einsum("ii->i", out)[...] += diagonal
