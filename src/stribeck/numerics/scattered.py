r"""Functions of several variables by their values and gradients at scattered places: exact there and smooth in between.

.. math:: f(x) = m + k(x)^T K^{-1} (d - m), \qquad \sigma(x)^2 = 1 - k(x)^T K^{-1} k(x)

with the data d, values and gradients, the covariance :math:`e^{-|x - y|^2/2}` of values and its derivatives, and m the mean of
the values.  The doubt :math:`\sigma` is the standard deviation of what lies between, in units of that of the function.  It
grows as the square of the distance from a lone place, and is 0.013 in the middle between two places at distance one.
Source: [Rasmussen 2006] Gaussian Processes for Machine Learning, sections 2.2 and 9.4.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from stribeck._types import Array
from stribeck.numerics.settings import HALF_DIGITS

__all__ = ["Scattered"]


@dataclass(eq=False)
class Scattered:
    """Several functions of the same m variables, known at some places."""

    lengths: Array  # Distances over which they change by about their own size
    _places: list[Array] = field(default_factory=list)
    _data: list[Array] = field(default_factory=list)
    _inverse: Array = field(default_factory=lambda: np.zeros((0, 0)))

    def add(self, place: Array, values: Array, slopes: Array) -> None:
        """Add a place, shape (m,), with the values there, shape (n,), and their gradients, shape (m, n)."""
        self._places.append(place / self.lengths)
        self._data.append(np.concatenate([values[None], slopes * self.lengths[:, None]]))
        K = np.concatenate([self._rows(each) for each in self._places])
        # What the data err by is smoothed between places that are close.
        self._inverse = np.asarray(np.linalg.inv(K + HALF_DIGITS * np.eye(len(K))))

    def doubt(self, place: Array) -> float:
        """Return how uncertain the functions are at a place: 0 at a known one, 1 far from all."""
        if not self._places:
            return 1.0
        k = self._rows(place / self.lengths)[0]
        return float(np.sqrt(max(0.0, 1.0 - k @ self._inverse @ k)))

    def nearest(self, place: Array) -> int:
        """Return the number of the place that is nearest to another."""
        return int(np.argmin([np.sum((each - place / self.lengths) ** 2) for each in self._places]))

    def at(self, place: Array) -> tuple[Array, Array]:
        """Return the values at a place and their gradients, shapes (n,) and (m, n)."""
        data = np.concatenate(self._data)
        mean = np.mean([each[0] for each in self._data], axis=0)
        data[:: 1 + len(self.lengths)] -= mean
        found = self._rows(place / self.lengths) @ self._inverse @ data
        return mean + found[0], found[1:] / self.lengths[:, None]

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
