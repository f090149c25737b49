r"""A preconditioner of the Jacobian of the point contact: the Jacobian by angular modes, cut to a band, as block LU factors.

Products of fields with cosines couple modes whose difference is small, as fields vary slowly with the angle: blocks with
:math:`|m - m'|` up to ``band`` are kept, in single precision.  The row of the load and the column of the offset border them.
"""

from collections.abc import Iterator
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.linalg import lapack

from stribeck._types import Array, Indices
from stribeck.equations.point.far_field import rates
from stribeck.equations.point.system import Linear
from stribeck.numerics.fourier_panels import lobatto, radau
from stribeck.numerics.settings import MAX_BAND, MAX_BYTES

Single = npt.NDArray[np.float32]


class BandedModes:
    """An approximate inverse of a Jacobian."""

    def __init__(self, linear: Linear, band: int) -> None:
        operators = linear.equations.operators
        self.shape = (operators.mesh.modes, operators.mesh.rings)
        self.band = min(band, self.shape[0] - 1)
        coupling = Coupling(linear)
        self.factors = BlockLU(coupling.columns(self.band), self.band, self.shape)
        self.row = linear.equations.load_row
        self.column = self.factors.solve(coupling.of_offset())
        self.pivot = float(self.row @ self.column[0])

    @property
    def wider_band(self) -> int | None:
        """The band to take where this one does not serve: a wide one, then all modes, which is exact, if memory allows."""
        modes, rings = self.shape
        if self.band < min(MAX_BAND, modes - 1):
            return MAX_BAND
        fits = np.dtype(np.float32).itemsize * (modes * rings) ** 2 <= MAX_BYTES
        return modes - 1 if self.band < modes - 1 and fits else None

    def __call__(self, right: Any) -> Any:
        """Return changes of total pressure, by mode, and offset that approximately remove residuals."""
        # The system is [[B, g], [w, 0]] (dp, dz) = (r, s).
        many = right.shape[1:]
        x = self.factors.solve(right[:-1].reshape(*self.shape, *many))
        offset = (self.row @ x[0] - right[-1]) / self.pivot
        x -= np.multiply.outer(self.column.astype(x.dtype), np.asarray(offset, dtype=x.dtype))
        return np.concatenate([x.reshape(-1, *many), np.asarray(offset, dtype=x.dtype)[None]])


def _sums(waves: Array, values: Array, sign: float) -> Array:
    """Return sums over the angles of values, shape (angles, ...), times waves of c theta, c < 2 modes - 1."""
    # cos((2N - c) theta) = -cos(c theta) at the angles, and the same for sines with the other sign.
    n = values.shape[0]
    flat = values.reshape(n, -1)
    found = np.zeros((2 * n - 1, flat.shape[1]))
    found[:n] = waves.T @ flat
    found[n + 1 :] = sign * found[n - 1 : 1 : -1]
    if sign > 0:
        found[n] = (-1.0) ** np.arange(n) @ flat
    return found.reshape(-1, *values.shape[1:])


class Coupling:
    """Action of the modes of the pressure on those of the residual: sums over the angles of the local parts of a Jacobian."""

    def __init__(self, linear: Linear) -> None:
        self.mesh, self.deflection = linear.equations.operators.mesh, linear.equations.operators.deflection
        mesh = self.mesh
        derivative = np.tile(lobatto(mesh.degree).derivative, (mesh.panels, 1, 1))
        derivative[0] = radau(mesh.degree).derivative
        derivative = derivative / mesh.stretch[:, :, None]
        transposed = derivative.transpose(0, 2, 1)
        film, slope, wide = linear.film, linear.contact_slope, linear.film.angular_of_pressure
        of_pressure = np.matmul(transposed * film.radial_of_pressure[:, :, None, :], derivative)
        of_gap = transposed * film.radial_of_gap[:, :, None, :] - of_pressure * mesh.scattered(slope)[:, :, None, :]
        tangential = film.angular_of_gap - wide * (mesh.angular_derivative @ slope)
        value = np.zeros_like(wide)
        if film.of_value is not None:
            by_value, value = film.of_value
            of_pressure = of_pressure + transposed * by_value[:, :, None, :]
            of_gap = of_gap - transposed * (by_value * mesh.scattered(slope))[:, :, None, :]
            tangential = tangential - value * slope
        self.crossed: tuple[Array, Array] | None = None
        """Sums of what waves of the pressure, and of the gap, across the radius do along it, and the other way round."""
        if film.crossed is not None:
            across = film.crossed[:, :, None, :] * transposed
            of_gap = of_gap - across * mesh.scattered(mesh.angular_derivative @ slope)[:, :, None, :]
            at_gap = mesh.scattered(slope)[:, :, None, :]
            back = across.swapaxes(2, 3)
            self.crossed = (
                _sums(mesh.sines, np.stack([across, back], axis=1), 1.0),
                _sums(mesh.sines, np.stack([across * at_gap, back * at_gap], axis=1), 1.0),
            )
        self.rates = rates(mesh.modes) / mesh.rim
        # The contact pressure at the rim is zero but for the softest laws; its mode is taken for the first.
        rim_of_gap = linear.rim_of_gap - linear.rim_of_pressure * slope[:, -1] * self.rates[0]
        cosines, sines = mesh.cosines, mesh.sines
        self.radial_p, self.radial_h = _sums(cosines, of_pressure, -1.0), _sums(cosines, of_gap, -1.0)
        self.ring_p, self.ring_s = _sums(cosines, wide, -1.0), _sums(cosines, wide * slope, -1.0)
        self.ring_h, self.ring_v = _sums(sines, tangential, 1.0), _sums(sines, value, 1.0)
        self.rim_p, self.rim_h = _sums(cosines, linear.rim_of_pressure, -1.0), _sums(cosines, rim_of_gap, -1.0)

    def _of_gap(self, m: int, k: int) -> Array:
        """Return the effect of mode k of the gap on mode m of the residual at each ring, without radial derivatives."""
        d, s = abs(m - k), m + k
        found = -0.5 * m * (self.ring_h[s] + np.sign(m - k) * self.ring_h[d]) - 0.5 * m * k * (self.ring_s[d] - self.ring_s[s])
        found[-1] += 0.5 * (self.rim_h[d] + self.rim_h[s])
        return np.asarray(found)

    def _crossed(self, which: int, m: Indices, k: int) -> Array | float:
        """Return the effect of mode k on modes m through derivatives in radius and angle, panel by panel."""
        if self.crossed is None:
            return 0.0
        sums = self.crossed[which]
        d, s, sign = abs(m - k), m + k, np.sign(m - k)[:, None, None, None]
        along = k * (sums[s, 0] - sign * sums[d, 0])
        return np.asarray(-0.5 * (along + m[:, None, None, None] * (sums[s, 1] + sign * sums[d, 1])))

    def columns(self, band: int) -> Iterator[tuple[range, Array]]:
        """Yield for each mode of the pressure the modes of the residual that it reaches, and the blocks."""
        mesh = self.mesh
        radial_p, radial_h = (each.astype(np.float32) for each in (self.radial_p, self.radial_h))
        n, rings, diagonal = mesh.degree + 1, mesh.rings, np.arange(mesh.rings)
        for k in range(mesh.modes):
            reached = range(max(0, k - band), min(mesh.modes, k + band + 1))
            d, s = [abs(m - k) for m in reached], [m + k for m in reached]
            local_h = 0.5 * (radial_h[d] + radial_h[s]) - self._crossed(1, np.array(reached), k)
            local_p = 0.5 * (radial_p[d] + radial_p[s]) + self._crossed(0, np.array(reached), k)
            deflection = self.deflection[k].astype(np.float32)
            blocks = np.stack([self._of_gap(m, k) for m in reached]).astype(np.float32)[:, :, None] * deflection
            for panel, at in enumerate(mesh.of_panel):
                own = slice(at[0], at[-1] + 1)
                blocks[:, own] += (local_h[:, panel].reshape(-1, n) @ deflection[own]).reshape(-1, n, rings)
                blocks[:, own, own] += local_p[:, panel]
            orders = 0.5 * k * np.array(reached)[:, None]
            blocks[:, diagonal, diagonal] += orders * (self.ring_p[d] - self.ring_p[s])
            m = np.array(reached)[:, None]
            blocks[:, diagonal, diagonal] -= 0.5 * m * (self.ring_v[s] + np.sign(m - k) * self.ring_v[d])
            blocks[:, -1, -1] += 0.5 * self.rates[k] * (self.rim_p[d] + self.rim_p[s])
            yield reached, blocks

    def of_offset(self) -> Array:
        """Return the column of the offset, shape (modes, rings)."""
        modes = range(self.mesh.modes)
        local = self.radial_h[: len(modes)] - self._crossed(1, np.arange(len(modes)), 0)
        radial = self.mesh.gathered(local.sum(axis=3))
        return np.asarray(radial + np.stack([self._of_gap(m, 0) for m in modes]))


def _without_tiny(blocks: Single, size: Single | float = 1.0) -> Single:
    """Return blocks without what is too small, beside their size, to be multiplied by its like in single precision."""
    # High modes act on far rings by less than the smallest normal number, and products with such take ten times as long.
    blocks[np.abs(blocks) < np.sqrt(np.finfo(np.float32).tiny) * size] = 0.0
    return blocks


class BlockLU:
    """Block LU factors of a banded block matrix in single precision, pivoted within the diagonal blocks."""

    def __init__(self, columns: Iterator[tuple[range, Array]], band: int, shape: tuple[int, int]) -> None:
        self.count, size = shape
        self.band = band
        self.scale = np.ones(shape)
        self.inverses: list[Single] = []
        self.right: list[Single] = []
        self.below: list[Single] = []
        window: dict[tuple[int, int], Single] = {}
        waiting: list[tuple[int, int]] = []
        loaded = 0
        for k in range(self.count):
            last = min(self.count, k + band + 1)
            while loaded < last:
                rows, blocks = next(columns)
                self.scale[loaded] = 1.0 / np.abs(blocks[rows.index(loaded)]).max(axis=1)
                window.update({(m, loaded): block.astype(np.float32) for m, block in zip(rows, blocks, strict=True)})
                waiting += [(m, loaded) for m in rows]
                loaded += 1
                # Rows are scaled when the scale of theirs is known, and when the column has arrived.
                for m, j in waiting:
                    if m < loaded:
                        window[m, j] *= self.scale[m].astype(np.float32)[:, None]
                waiting = [(m, j) for m, j in waiting if m >= loaded]
            self._eliminate(window, k, last, size)

    def _eliminate(self, window: dict[tuple[int, int], Single], k: int, last: int, size: int) -> None:
        lu, pivots, _ = lapack.sgetrf(_without_tiny(window.pop((k, k))))
        # Products with an inverse are several times as fast as solutions by the factors, and in single precision as good.
        inverse = _without_tiny(lapack.sgetri(lu, pivots)[0])
        self.inverses.append(inverse)
        if last == k + 1:
            return
        beyond = _without_tiny(np.hstack([window.pop((k, j)) for j in range(k + 1, last)]))
        right = _without_tiny(inverse @ beyond)
        below = _without_tiny(np.vstack([window.pop((i, k)) for i in range(k + 1, last)]))
        for i in range(k + 1, last):  # row by row: all at once would need as much memory as the window
            update = below[(i - k - 1) * size : (i - k) * size] @ right
            for j in range(k + 1, last):
                window[i, j] -= update[:, (j - k - 1) * size : (j - k) * size]
        self.right.append(right)
        self.below.append(below)

    def solve(self, right: Any) -> Any:
        """Return the solution, to single precision, for right-hand sides of the shape (count, size) or (count, size, many)."""
        scale = self.scale.reshape(*self.scale.shape, *(1 for _ in right.shape[2:])).astype(right.dtype)
        x = (right * scale).astype(np.float32, copy=False)
        one, size = x.shape[1:], np.abs(x).max(axis=(0, 1))
        for k in range(self.count):
            x[k] = _without_tiny(self.inverses[k] @ x[k], size)
            if k < len(self.below):
                last = min(self.count, k + self.band + 1)
                x[k + 1 : last] -= (self.below[k] @ x[k]).reshape(-1, *one)
        for k in range(self.count - 2, -1, -1):
            last = min(self.count, k + self.band + 1)
            x[k] -= self.right[k] @ x[k + 1 : last].reshape(-1, *one[1:])
        return x.astype(right.dtype, copy=False)
