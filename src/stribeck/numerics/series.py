"""Taylor series: of solutions of equations order by order, and of what follows from unknowns.

A solution of :math:`R(w(t), t) = 0` is expanded about t = 0.  The coefficient of order k of the residual is linear in that of
the solution,

.. math:: J w_k = -R_k|_{w_k = 0},

with the Jacobian at the solution: one factorisation serves all orders.

A :class:`Jet` is a series made of others, exact: its coefficient of order k is a linear function of theirs of order k, plus
what lower orders give.  Functions that are written with sums, products, quotients, powers, exponentials, logarithms and
constant linear maps make jets of jets, so that a residual that is written once has its own series.

Coefficients are in the first axis, order by order.  The module knows no physics.
Source: [Griewank & Walther 2008] Evaluating Derivatives, chapter 13.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin
from numpy.polynomial.polynomial import polyval

from stribeck._types import Array, Flags
from stribeck.numerics.settings import COEFFICIENT_NOISE, HALF_DIGITS, MAX_LOG_STEP


def along(rate: float, order: int) -> Array:
    """Return the series of ``exp(rate t)``."""
    found = np.ones(order + 1)
    np.cumprod(rate / np.arange(1.0, order + 1), out=found[1:])
    return found


def implicit_series(found: Array, coefficient: Callable[[int], Array], inverse: Callable[[Array], Array]) -> None:
    """Write the Taylor coefficients of the solution of an equation below the first one.

    ``coefficient(k)`` is that of the residual with the coefficients that are written so far.
    """
    is_old = False
    for k in range(1, len(found)):
        found[k] = inverse(coefficient(k))
        if k == 1 or is_old:
            change = inverse(coefficient(k))
            # Factors that change the first order too much are too old: every order is refined.
            is_old = is_old or bool(np.abs(change).max() > HALF_DIGITS * np.abs(found[1]).max())
            found[k] += change
        if not np.isfinite(found[k]).all():  # every later order is made of this one
            found[k:] = np.nan
            return


def radius(coefficients: Array, rounding: float = COEFFICIENT_NOISE) -> float:
    """Return about the radius of convergence of series: that by which their coefficients fall."""
    order = len(coefficients) - 1
    size = np.abs(coefficients[1:]).reshape(order, -1).max(axis=1)
    k = np.arange(order // 2 + 1, order + 1)
    told = k[size[k - 1] > rounding]
    return float(np.min((max(size[0], rounding) / size[told - 1]) ** (1.0 / np.maximum(told - 1, 1)), initial=MAX_LOG_STEP))


def beyond(series: Array, t: float) -> tuple[Array, float]:
    """Return series at a place outside, and the largest difference between two of their rational forms."""
    # The denominators, of two degrees, make the highest coefficients vanish.
    order = len(series) - 1
    scaled = series * (t ** np.arange(order + 1.0))[:, None]
    degree = order // 3
    if degree < 2:
        return np.asarray(scaled.sum(axis=0)), 0.0
    best, other = _rational(scaled, degree, products := scaled @ scaled.T), _rational(scaled, degree - 1, products)
    return best, float(np.abs(best - other).max())


def _rational(scaled: Array, degree: int, products: Array) -> Array:
    """Return the sum of a series as a rational function whose denominator has a degree, from the products of its orders."""
    order = len(scaled) - 1
    high = order - degree + 1 + np.arange(degree) - np.arange(degree + 1)[:, None]
    gram = products[high[:, None], high].sum(axis=2)
    rest = gram[1:, 1:] + (1e-14 * np.trace(gram) + 1e-200) * np.eye(degree)
    q = np.append(1.0, np.linalg.solve(rest, -gram[1:, 0]))
    parts = np.append(np.ones(order - 2 * degree), np.cumsum(q)[::-1] / q.sum())
    return np.asarray(parts @ scaled[: len(parts)])


Term = Callable[[int, Array], Any]  # Order and the jet's own coefficients -> the coefficient of that order


class Tape:
    """The jets of a function in the order of their making."""

    def __init__(self, order: int) -> None:
        self.order = order
        self.made: list[Jet] = []
        self.reached = 0  # Order that was filled last
        self.known = 0  # Order up to which a jet that is made now has its coefficients

    def given(self, coefficients: Array) -> Jet:
        """Return a jet with coefficients that are known, or that the caller will write."""
        return Jet(self, coefficients)

    def growth(self, rate: float) -> Jet:
        """Return the exponential of the coordinate times a rate."""
        return self.given(along(rate, self.order)[:, None])

    def keep(self, ends: Iterable[Jet]) -> None:
        """Forget the jets that others do not follow from."""
        used, left = set[int](), list(ends)
        while left:
            jet = left.pop()
            if id(jet) not in used:
                used.add(id(jet))
                left += jet.parents
        self.made = [jet for jet in self.made if id(jet) in used]

    def fill(self, k: int) -> None:
        """Find the coefficients of order k from lower ones and from those of the given jets."""
        if k > self.reached:
            self.settle()
        self.reached = k
        for jet in self.made:
            jet.coefficients[k] = jet.term(k, jet.coefficients)

    def settle(self) -> None:
        """Find those of the last order again that others follow from, as the caller has written to the given jets."""
        k = self.reached
        if k > 0:
            for jet in self.made:
                if jet.is_needed:
                    jet.coefficients[k] = jet.term(k, jet.coefficients)
        self.known = k


class Jet(NDArrayOperatorsMixin):
    """A series of nodal values, a number being one node: its coefficients are in the first axis."""

    def __init__(self, tape: Tape, coefficients: Array, *parents: Jet) -> None:
        self.tape, self.coefficients, self.parents = tape, coefficients, parents
        self.term: Term = _no_term
        self.is_needed = False  # Whether other orders follow from its coefficients
        self.log: Jet | None = None  # What it is the exponential of

    @property
    def value(self) -> Array:
        """The coefficient of order zero."""
        value: Array = self.coefficients[0]
        return value

    def need(self) -> None:
        """Note that other orders follow from it, and from what it was made of."""
        if not self.is_needed:
            self.is_needed = True
            for parent in self.parents:
                parent.need()

    def __array_ufunc__(self, function: Any, method: str, *given: Any, **options: Any) -> Any:
        """Return what a function of numpy makes of it."""
        rule = RULES.get(function)
        return NotImplemented if rule is None or method != "__call__" or options else rule(*given)

    def __array_function__(self, function: Any, types: Any, given: Any, options: Any) -> Any:
        """Return constants of its shape."""
        if function not in (np.zeros_like, np.ones_like, np.full_like):
            return NotImplemented
        return function(given[0].value, *given[1:], **options)

    def __getitem__(self, nodes: Any) -> Jet:
        """Return the series at some nodes, ``jet[..., nodes]``."""
        found = self.mapped(lambda values: values[nodes])
        found.log = None if self.log is None else self.log[nodes]
        return found

    def __matmul__(self, weights: Array) -> Jet:
        """Return the series of weighted sums over the nodes."""
        columns = weights.reshape(len(weights), -1)
        return self.mapped(lambda values: values @ columns)

    def mapped(self, operator: Callable[[Array], Array]) -> Jet:
        """Return the series of what a linear map makes of nodal values, of rows of them too."""
        a = self.coefficients
        return _made(operator(a[0]), lambda k, _: operator(a[k]), self)


def _no_term(k: int, own: Array) -> float:
    """Return the coefficients of a jet that is given."""
    return 0.0


def _made(value: Any, term: Term, *parents: Jet, needs: Iterable[Jet] = (), needs_own: bool = False) -> Jet:
    """Return a new jet of a tape, with its coefficients as far as those of its parents are known.

    Its terms may follow from lower orders of some parents, and from its own.
    """
    tape = parents[0].tape
    found = Jet(tape, np.empty((tape.order + 1, *np.shape(value))), *parents)
    found.term, found.coefficients[0] = term, value
    tape.made.append(found)
    for each in (*needs, *([found] if needs_own else [])):
        each.need()
    for k in range(1, tape.known + 1):
        found.coefficients[k] = term(k, found.coefficients)
    return found


def _convolved(first: Array, second: Array) -> Any:
    """Return the sum of products of orders of two factors, the second in descending order."""
    if first.shape[1:] == (1,):
        return first[::-1, 0] @ second[::-1]  # numpy would copy rows in descending order
    if second.shape[1:] == (1,):
        return second[:, 0] @ first
    return np.einsum("jn,jn->n", first, second)


def _add(a: Any, b: Any) -> Jet:
    if not isinstance(a, Jet):
        a, b = b, a
    of_a = a.coefficients
    if not isinstance(b, Jet):
        return _made(of_a[0] + b, lambda k, _: of_a[k], a)
    of_b = b.coefficients
    return _made(of_a[0] + of_b[0], lambda k, _: of_a[k] + of_b[k], a, b)


def _subtract(a: Any, b: Any) -> Jet:
    if not isinstance(b, Jet):
        return _add(a, -np.asarray(b))
    of_b = b.coefficients
    if not isinstance(a, Jet):
        return _made(a - of_b[0], lambda k, _: -of_b[k], b)
    of_a = a.coefficients
    return _made(of_a[0] - of_b[0], lambda k, _: of_a[k] - of_b[k], a, b)


def _multiply(a: Any, b: Any) -> Any:
    if not isinstance(a, Jet):
        a, b = b, a
    if not isinstance(b, Jet):
        return a.mapped(lambda values: values * b)
    of_a, of_b = a.coefficients, b.coefficients
    return _made(of_a[0] * of_b[0], lambda k, _: _convolved(of_a[: k + 1], of_b[k::-1]), a, b, needs=(a, b))


def _divide(a: Any, b: Any) -> Any:
    # A product with one over the value would err by more: in thin films the numerator cancels.
    if not isinstance(b, Jet):
        return a.mapped(lambda values: values / b)
    of_b, below = b.coefficients, b.value
    if not isinstance(a, Jet):
        return _made(a / below, lambda k, own: -_convolved(own[:k], of_b[k:0:-1]) / below, b, needs_own=True)
    of_a = a.coefficients
    return _made(a.value / below, lambda k, own: (of_a[k] - _convolved(own[:k], of_b[k:0:-1])) / below, a, b, needs_own=True)


def _exponential(a: Jet) -> Jet:
    of_a, slopes = a.coefficients, np.zeros_like(a.coefficients)

    def term(k: int, own: Array) -> Any:
        slopes[k] = k * of_a[k]
        return _convolved(slopes[1 : k + 1], own[k - 1 :: -1]) / k

    found = _made(np.exp(a.value), term, a, needs_own=True)
    found.log = a
    return found


def _logarithm(a: Jet) -> Jet:
    if a.log is not None:
        return a.log
    of_a, slopes = a.coefficients, np.zeros_like(a.coefficients)

    def term(k: int, own: Array) -> Any:
        slopes[k - 1] = (k - 1) * own[k - 1]
        return (of_a[k] - _convolved(slopes[1:k], of_a[k - 1 : 0 : -1]) / k) / of_a[0]

    return _made(np.log(a.value), term, a, needs_own=True)


def _power(a: Jet, exponent: float) -> Any:
    if exponent in (2, 3):
        return a * a if exponent == 2 else a * a * a
    return _exponential(exponent * _logarithm(a))


def _chosen(first: Any, second: Any, is_first: Flags) -> Jet:
    """Return the series of one jet or number at some nodes, of another at the others."""

    def of(each: Any, k: Any) -> Any:
        return each.coefficients[k] if isinstance(each, Jet) else 0.0

    parents = [each for each in (first, second) if isinstance(each, Jet)]
    value = np.where(is_first, _value(first), _value(second))
    return _made(value, lambda k, _: np.where(is_first, of(first, k), of(second, k)), *parents)


def _value(given: Any) -> Any:
    return given.value if isinstance(given, Jet) else given


RULES: dict[Any, Callable[..., Any]] = {
    np.add: _add,
    np.subtract: _subtract,
    np.multiply: _multiply,
    np.divide: _divide,
    np.negative: lambda a: a.mapped(np.negative),
    np.square: lambda a: a * a,
    np.sqrt: lambda a: _power(a, 0.5),
    np.power: _power,
    np.exp: _exponential,
    np.expm1: lambda a: _exponential(a) - 1.0,
    np.log: _logarithm,
    np.log1p: lambda a: _logarithm(1.0 + a),
    np.maximum: lambda a, b: _chosen(a, b, _value(a) >= _value(b)),
    np.minimum: lambda a, b: _chosen(a, b, _value(a) <= _value(b)),
    np.not_equal: lambda a, b: _value(a) != _value(b),
}


def polynomial(coefficients: Array, a: Any) -> Any:
    """Return a polynomial at each node, its coefficients ascending in the first axis, of a jet or of values in rows."""
    if not isinstance(a, Jet):
        return polyval(a, coefficients, tensor=False)
    # Each derivative grows by the next one, the last is constant.
    degree, of_a = len(coefficients) - 1, a.coefficients
    tower = np.empty((degree + 1, a.value.size))
    for m in range(degree + 1):
        falling = np.prod(np.arange(m)[:, None] * -1.0 + np.arange(m, degree + 1), axis=0)
        tower[m] = polyval(a.value, coefficients[m:] * falling[:, None], tensor=False)
    slopes, next_one = np.zeros_like(of_a), np.vstack([tower[1:], np.zeros_like(tower[:1])])

    def term(k: int, own: Array) -> Any:
        slopes[k - 1] = (k - 1) * of_a[k - 1]
        found = next_one * of_a[k]
        if k > 1:
            found[:-1] += np.einsum("jn,jmn->mn", slopes[1:k], own[k - 1 : 0 : -1, 1:]) / k
        return found

    return _made(tower, term, a, needs_own=True).mapped(lambda values: values[..., 0, :])
