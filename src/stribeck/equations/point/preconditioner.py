"""A preconditioner of the Jacobian of the point contact: that itself by angular modes, cut to a band, by block LU."""

from __future__ import annotations

import numpy as np
from scipy.linalg import lapack

from stribeck._types import Array
from stribeck.equations.point.system import Linear
from stribeck.numerics.fourier_panels import PolarMesh, lobatto, radau


class BandedModes:
    """The inverse of the banded Jacobian, load row and offset bordered."""

    def __init__(self, linear: Linear, band: int, dtype: type = np.float64) -> None:
        mesh = linear.equations.operators.mesh
        self.mesh, self.band = mesh, min(band, mesh.modes - 1)
        blocks, column = banded_blocks(linear, self.band)
        self.lu = BlockLU(blocks, self.band, dtype)
        self.row = linear.equations.operators.load_row
        self.column = self.lu.solve(column)
        self.pivot = float(self.row @ self.column[0])

    def __call__(self, right: Array) -> Array:
        """Return about the change of total pressure and offset for residuals."""
        found = np.empty_like(right)
        x = self.lu.solve(right[:-1].reshape(self.mesh.modes, -1))
        offset = (self.row @ x[0] - right[-1]) / self.pivot
        found[:-1] = (x - offset * self.column).ravel()
        found[-1] = offset
        return found


def _cosine_sums(mesh: PolarMesh, values: Array) -> Array:
    """Return sums over the angles of values, shape (angles, ...), times cos(c theta), c < 2 modes - 1."""
    n = mesh.modes
    flat = values.reshape(n, -1)
    found = np.zeros((2 * n - 1, flat.shape[1]))
    found[:n] = mesh.cosines.T @ flat
    found[n + 1 :] = -found[n - 1 : 1 : -1]
    return found.reshape(-1, *values.shape[1:])


def _sine_sums(mesh: PolarMesh, values: Array) -> Array:
    """Return the same with sin(c theta)."""
    n = mesh.modes
    flat = values.reshape(n, -1)
    found = np.zeros((2 * n - 1, flat.shape[1]))
    found[:n] = mesh.sines.T @ flat
    found[n] = (-1.0) ** np.arange(n) @ flat
    found[n + 1 :] = found[n - 1 : 1 : -1]
    return found.reshape(-1, *values.shape[1:])


def banded_blocks(linear: Linear, band: int) -> tuple[dict[tuple[int, int], Array], Array]:
    """Return the blocks of the Jacobian by mode of residual and of pressure, within the band, and its column of the offset."""
    eq, y = linear.equations, linear.y
    mesh, op = eq.operators.mesh, eq.operators
    n, modes, rings = mesh.degree + 1, mesh.modes, mesh.rings
    derivative = np.tile(lobatto(mesh.degree).derivative, (mesh.panels, 1, 1))
    derivative[0] = radau(mesh.degree).derivative
    derivative = derivative / mesh.stretch[:, :, None]
    transposed = derivative.transpose(0, 2, 1)
    slope = linear.contact_slope
    of_pressure = np.matmul(transposed * linear.radial_of_pressure[:, :, None, :], derivative)
    of_gap = transposed * linear.radial_of_gap[:, :, None, :] - of_pressure * mesh.scattered(slope)[:, :, None, :]
    radial_p, radial_h = _cosine_sums(mesh, of_pressure), _cosine_sums(mesh, of_gap)
    wide = linear.angular_of_pressure
    ring_p = _cosine_sums(mesh, wide)  # times m m' of sin sin
    ring_hh = _cosine_sums(mesh, wide * slope)
    ring_h = _sine_sums(mesh, linear.angular_of_gap - wide * (mesh.angular_derivative @ slope))
    rim_p = _cosine_sums(mesh, linear.rim_of_pressure)
    rim_h = _cosine_sums(mesh, linear.rim_of_gap - linear.rim_of_pressure * slope[:, -1])
    diagonal = np.arange(rings)
    blocks: dict[tuple[int, int], Array] = {}
    column = np.zeros((modes, rings))
    for k in range(modes):  # pressure
        low, high = max(0, k - band), min(modes, k + band + 1)
        of_modes = range(low, high)
        minus, plus = [abs(m - k) for m in of_modes], [m + k for m in of_modes]
        local = 0.5 * (radial_h[minus] + radial_h[plus])
        if k == 0:
            ones = local.sum(axis=3)
        stack = np.zeros((len(minus), rings, rings))
        for panel in range(mesh.panels):
            at = mesh.of_panel[panel]
            block = local[:, panel].reshape(-1, n) @ op.deflection[k][at]
            stack[:, at] += block.reshape(len(minus), n, rings)
            stack[:, at[0] : at[0] + n, at[0] : at[0] + n] += 0.5 * (radial_p[minus, panel] + radial_p[plus, panel])
        for i, m in enumerate(of_modes):
            tangential = 0.5 * m * k * (ring_p[abs(m - k)] - ring_p[m + k])
            signed = np.sign(m - k) * ring_h[abs(m - k)]
            moved = -0.5 * m * (ring_h[m + k] + signed) - 0.5 * m * k * (ring_hh[abs(m - k)] - ring_hh[m + k])
            moved[-1] += 0.5 * (rim_h[abs(m - k)] + rim_h[m + k])
            stack[i] += moved[:, None] * op.deflection[k]
            stack[i][diagonal, diagonal] += tangential
            stack[i][-1, -1] += 0.5 * (rim_p[abs(m - k)] + rim_p[m + k])
            blocks[m, k] = stack[i]
            if k == 0:
                column[m] = mesh.gathered(ones[i]) + moved
    return blocks, column


class BlockLU:
    """Block LU factors of a banded block matrix, pivoted within the diagonal blocks, its rows scaled first."""

    def __init__(self, blocks: dict[tuple[int, int], Array], band: int, dtype: type) -> None:
        self.count = max(m for m, _ in blocks) + 1
        self.band, self.dtype = band, dtype
        size = blocks[0, 0].shape[0]
        self.scale = np.array([1.0 / np.abs(blocks[m, m]).max(axis=1) for m in range(self.count)])
        window = {key: (block * self.scale[key[0]][:, None]).astype(dtype) for key, block in blocks.items()}
        self.factors, self.right, self.below = [], [], []
        getrf, self.getrs = (lapack.sgetrf, lapack.sgetrs) if dtype == np.float32 else (lapack.dgetrf, lapack.dgetrs)
        for k in range(self.count):
            last = min(self.count, k + band + 1)
            lu, pivots, _ = getrf(window.pop((k, k)))
            upper = [window.pop((k, j)) for j in range(k + 1, last)]
            lower = [window.pop((j, k)) for j in range(k + 1, last)]
            self.factors.append((lu, pivots))
            if not upper:
                self.right.append(None), self.below.append(None)
                continue
            right = self.getrs(lu, pivots, np.hstack(upper))[0]
            below = np.vstack(lower)
            update = below @ right
            for i in range(k + 1, last):
                for j in range(k + 1, last):
                    part = update[(i - k - 1) * size : (i - k) * size, (j - k - 1) * size : (j - k) * size]
                    window[i, j] -= part
            self.right.append(np.ascontiguousarray(right)), self.below.append(below)

    def solve(self, right: Array) -> Array:
        """Return the solution for a right-hand side, shape (count, size)."""
        x = (right * self.scale).astype(self.dtype)
        size = x.shape[1]
        for k in range(self.count):
            x[k] = self.getrs(*self.factors[k], x[k])[0]
            if self.below[k] is not None:
                last = min(self.count, k + self.band + 1)
                x[k + 1 : last] -= (self.below[k] @ x[k]).reshape(-1, size)
        for k in range(self.count - 2, -1, -1):
            last = min(self.count, k + self.band + 1)
            x[k] -= self.right[k] @ x[k + 1 : last].ravel()
        return x.astype(np.float64)
