"""GMRES, preconditioned from the left: the residual that it makes small is about the error itself.

Source: [Saad 2003] Iterative Methods for Sparse Linear Systems, algorithm 9.4.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from stribeck._types import Array
from stribeck.numerics.newton import go_on

Apply = Callable[[Array], Array]


@dataclass(frozen=True, eq=False)
class Solved:
    """The solution of a linear system, how many products it took, and how much of the right-hand side is left."""

    x: Array  # The solution
    steps: int  # Products with the matrix
    left: float


def gmres(product: Apply, precondition: Apply, right: Array, tolerance: float, max_steps: int) -> Solved:
    """Return x with ``A x = right`` but for ``tolerance``, both sides preconditioned."""
    start = precondition(right)
    size = float(np.sqrt(start @ start))
    if size == 0.0 or not np.isfinite(size):
        return Solved(start, 0, 0.0 if size == 0.0 else np.inf)
    basis = np.empty((max_steps + 1, right.size))
    basis[0] = start / size
    upper = np.zeros((max_steps + 1, max_steps))
    rotations: list[tuple[float, float]] = []
    projected = np.zeros(max_steps + 1)
    projected[0] = size
    steps = 0
    while steps < max_steps and abs(projected[steps]) > tolerance * size:
        go_on()
        k = steps
        w = precondition(product(basis[k]))
        column = upper[:, k]
        for _ in range(2):  # twice is enough to make it orthogonal
            overlap = basis[: k + 1] @ w
            w = w - overlap @ basis[: k + 1]
            column[: k + 1] += overlap
        norm = float(np.sqrt(w @ w))
        for i, (c, s) in enumerate(rotations):
            column[i], column[i + 1] = c * column[i] + s * column[i + 1], c * column[i + 1] - s * column[i]
        radius = float(np.hypot(column[k], norm))
        if radius == 0.0 or not np.isfinite(radius):
            break
        c, s = column[k] / radius, norm / radius
        rotations.append((c, s))
        column[k] = radius
        projected[k], projected[k + 1] = c * projected[k], -s * projected[k]
        steps += 1
        basis[steps] = w / norm if norm > 0.0 else 0.0
    if steps == 0:
        return Solved(start, 0, np.inf)
    y = np.linalg.solve(upper[:steps, :steps], projected[:steps])
    return Solved(y @ basis[:steps], steps, float(abs(projected[steps])) / size)
