r"""Functions of several variables by their values and gradients at scattered places: exact there and smooth in between.

.. math:: f(x) = m(x) + k(x)^T K^{-1} (d - m), \qquad \sigma(x)^2 = 1 - k(x)^T K^{-1} k(x)

with the data d, values and gradients, the covariance :math:`e^{-|x - y|^2/2}` of values and its derivatives, and m the plane
through the means of values and gradients.  The doubt :math:`\sigma` is the standard deviation of what lies between, in units
of that of the function.  It grows as the square of the distance from a lone place, and is 0.013 in the middle between two
places at distance one.
Source: [Rasmussen 2006] Gaussian Processes for Machine Learning, sections 2.2, 2.7 and 9.4.
"""

from dataclasses import dataclass, field

import numpy as np

from stribeck._types import Array
from stribeck.numerics.settings import HALF_DIGITS


@dataclass(eq=False)
class Scattered:
    """Several functions of the same m variables, known at some places."""

    lengths: Array  # Distances over which they change by about their own size
    _places: list[Array] = field(default_factory=list)
    _data: list[Array] = field(default_factory=list)
    _inverse: Array | None = None

    def add(self, place: Array, values: Array, slopes: Array) -> None:
        """Add a place, shape (m,), with the values there, shape (n,), and their gradients, shape (m, n)."""
        self._places.append(place / self.lengths)
        self._data.append(np.concatenate([values[None], slopes * self.lengths[:, None]]))
        self._inverse = None

    def doubt(self, place: Array) -> float:
        """Return how uncertain the functions are at a place: 0 at a known one, 1 far from all."""
        if not self._places:
            return 1.0
        k = self._rows(place / self.lengths)[0]
        return float(np.sqrt(max(0.0, 1.0 - k @ self._inverted() @ k)))

    def nearest(self, place: Array) -> int:
        """Return the number of the place that is nearest to another."""
        return int(np.argmin([np.sum((each - place / self.lengths) ** 2) for each in self._places]))

    def at(self, place: Array) -> tuple[Array, Array]:
        """Return the values at a place and their gradients, shapes (n,) and (m, n)."""
        x, slopes = place / self.lengths, self._plane[1:].copy()
        for y, weight in zip(self._places, self._weights, strict=True):
            d = x - y
            slopes += np.exp(-0.5 * float(d @ d)) * (weight[1:] - np.outer(d, weight[0] + d @ weight[1:]))
        return self.values(place[None])[0], slopes / self.lengths[:, None]

    def values(self, places: Array) -> Array:
        """Return the values at many places, shape (k, n)."""
        x = places / self.lengths
        found = self._plane[0] + (x - np.mean(self._places, axis=0)) @ self._plane[1:]
        for y, weight in zip(self._places, self._weights, strict=True):
            d = x - y
            found += np.exp(-0.5 * np.sum(d**2, axis=1))[:, None] * (weight[0] + d @ weight[1:])
        return np.asarray(found)

    @property
    def _plane(self) -> Array:
        """Means of the values and the gradients, in lengths."""
        return np.asarray(np.mean(self._data, axis=0))

    @property
    def _weights(self) -> Array:
        """Weights of the covariances with values and gradients at each place."""
        rest = np.array(self._data) - self._plane
        rest[:, 0] -= (np.array(self._places) - np.mean(self._places, axis=0)) @ self._plane[1:]
        return np.asarray((self._inverted() @ rest.reshape(-1, rest.shape[2])).reshape(rest.shape))

    def _inverted(self) -> Array:
        """Return the inverse of the covariances of all data."""
        if self._inverse is None:
            K = np.concatenate([self._rows(each) for each in self._places])
            # What the data err by is smoothed between places that are close.
            self._inverse = np.asarray(np.linalg.inv(K + HALF_DIGITS * np.eye(len(K))))
        return self._inverse

    def _rows(self, x: Array) -> Array:
        """Return the covariances of value and gradient at x, in lengths, with all data, shape (1 + m, places * (1 + m))."""
        columns = []
        for y in self._places:
            d = np.append(1.0, x - y)
            block = -np.outer(d, d)
            block[0] = d
            block[1:, 1:] += np.eye(len(x))
            columns.append(np.exp(-0.5 * float(d[1:] @ d[1:])) * block)
        return np.concatenate(columns, axis=1)


def lengths_of(slopes: Array) -> Array:
    """Return how far variables move until functions change by their own size, at most one; slopes over sizes, shape (m, n)."""
    return np.asarray(1.0 / np.maximum(1.0, np.abs(slopes).max(axis=1, initial=0.0)))
