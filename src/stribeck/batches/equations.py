r"""The equations of many states that share a mesh, and Newton's iteration for all of them, on any array library.

What is in :mod:`stribeck.equations.line` for one state stands here once more for states in rows, in functions of the array API
standard alone, so that NumPy, PyTorch or CuPy can run it, on whatever device they know.  Of each state

.. math:: J(y_b) \, \Delta y_b = -R(y_b), \qquad b = 1 \dots B,

is solved by one batched LU factorisation.  The standard keeps no factors, so that each step factorises anew.

Source: [BP] Appendix A; theory.md Eqs. (1)-(5).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from stribeck._types import Array, Flags
from stribeck.batches.device import Device
from stribeck.contacts.line import Groups
from stribeck.equations.line import LOAD, Operators

MOST_STEPS = 30

QUADRATIC = 1e-2
"""Size of a step from which on Newton's iteration is taken to converge quadratically, if two steps say so."""


@dataclass(frozen=True, eq=False)
class DeviceOperators:
    """The operators of a mesh on a device."""

    device: Device
    deflection: Any
    deflection_of_gradient: Any
    weights: Any
    load_of_gradient: Any
    parabola: Any

    @classmethod
    def of(cls, operators: Operators, device: Device) -> DeviceOperators:
        """Return those that NumPy made."""
        arrays = (
            operators.deflection,
            operators.deflection_of_gradient,
            operators.mesh.weights,
            operators.load_of_gradient,
            operators.parabola,
        )
        return cls(device, *(device.put(a) for a in arrays))


@dataclass(frozen=True, eq=False)
class DeviceEquations:
    """The discretised problem of states in rows; all but the operators are columns, shape (rows, 1).

    Attributes
    ----------
    operators : DeviceOperators
        Of the shared mesh.
    speed : array
        Speed groups.
    rate : array
        Of the decay of the contact pressure, 1/kappa; zero for smooth contacts.
    log_top : array
        Logarithm of the contact pressure at zero gap, ``-ln(F)/2``; minus infinity for smooth contacts.
    flux_scale : array
        What the last row of each residual is multiplied by.
    """

    operators: DeviceOperators
    speed: Any
    rate: Any
    log_top: Any
    flux_scale: Any

    @classmethod
    def of(cls, operators: DeviceOperators, groups: Groups, flux_gap: Array) -> DeviceEquations:
        """Return the equations of groups, columns each, with the flux gaps that scale their last rows."""
        put = operators.device.put
        kappa = np.asarray(groups.relative_roughness)
        rough = kappa > 0
        rate = np.where(rough, 1 / np.where(rough, kappa, 1.0), 0.0)
        log_top = np.where(rough, -0.5 * np.log(groups.load), -np.inf)
        return cls(operators, put(np.asarray(groups.speed)), put(rate), put(log_top), put(flux_gap**2))

    def rows(self, indices: Any) -> DeviceEquations:
        """Return the equations of some of the states."""
        take = self.operators.device.xp.take
        columns = (self.speed, self.rate, self.log_top, self.flux_scale)
        return DeviceEquations(self.operators, *(take(c, indices, axis=0) for c in columns))

    def residual(self, y: Any) -> Any:
        """Return the residuals at ``y``, shape (rows, N + 2, 1)."""
        op, xp = self.operators, self.operators.device.xp
        h, z0, h_star = y[:, :-2], y[:, -2:-1], y[:, -1:]
        g = (h - h_star) / h**3
        p_c = xp.exp(self.log_top - h * self.rate)
        slopes = self.speed * g
        gap = h - z0 - op.parabola - p_c @ op.deflection.T - slopes @ op.deflection_of_gradient.T
        load = p_c @ op.weights + slopes @ op.load_of_gradient - LOAD
        flux = g @ op.weights
        return xp.concat([gap, load[:, None], self.flux_scale * flux[:, None]], axis=1)[:, :, None]

    def jacobian(self, y: Any) -> Any:
        """Return the derivatives with respect to relative changes of gaps and flux gap, see ``Equations.jacobian``."""
        op, xp = self.operators, self.operators.device.xp
        n = y.shape[1] - 2
        h, h_star = y[:, :-2], y[:, -1:]
        p_slope = -self.rate * xp.exp(self.log_top - h * self.rate) * h
        g_h = (3 * h_star - 2 * h) / h**3
        g_flux = -h_star / h**3
        slopes, by_flux = self.speed * g_h, self.speed * g_flux
        rows, m = y.shape[0], n + 2
        matrix = xp.empty((rows, m, m), dtype=xp.float64, device=op.device.device)
        matrix[:, :n, :n] = op.deflection * -p_slope[:, None, :]
        matrix[:, :n, :n] -= op.deflection_of_gradient * slopes[:, None, :]
        matrix[:, :n, n] = -1.0
        matrix[:, :n, n + 1] = -(by_flux @ op.deflection_of_gradient.T)
        matrix[:, n, :n] = op.weights * p_slope + op.load_of_gradient * slopes
        matrix[:, n, n] = 0.0
        matrix[:, n, n + 1] = by_flux @ op.load_of_gradient
        matrix[:, n + 1, :n] = self.flux_scale * op.weights * g_h
        matrix[:, n + 1, n] = 0.0
        matrix[:, n + 1, n + 1] = self.flux_scale[:, 0] * (g_flux @ op.weights)
        flat = xp.reshape(matrix, (rows, m * m))  # whose diagonal is a slice
        flat[:, : n * (m + 1) : m + 1] += h
        return xp.reshape(flat, (rows, m, m))

    def correction(self, y: Any, residuals: Any) -> Any:
        """Return relative changes that remove residuals, shape (rows, N + 2, columns), to first order."""
        return -self.operators.device.solved(self.jacobian(y), residuals)

    def admissible(self, y: Any, relative: Any) -> Any:
        """Return the longest admissible part of each step, see ``Equations.admissible``."""
        xp = self.operators.device.xp
        h, change = y[:, :-2], relative[:, :-2]
        closing = -xp.min(change, axis=1) / 0.7
        flux = xp.abs(relative[:, -1]) / 0.7
        decays = change * h * self.rate
        log_p = self.log_top - h * self.rate
        excess = -1.0 - log_p
        room = 3.0 + xp.where(excess > 0, xp.where(excess < 1e300, excess, 1e300), 0.0)
        falling = xp.max(-decays / room, axis=1)
        opening = xp.max(xp.where(log_p > -7.0, decays, 0.0), axis=1) / 3.0
        longest = xp.max(xp.stack([closing, flux, falling, opening], axis=0), axis=0)
        return 1.0 / xp.where(longest > 1.0, longest, 1.0)


def newton(equations: DeviceEquations, y: Array, tolerance: float) -> tuple[Array, Flags, int]:
    """Return the unknowns after Newton's iteration of each row, which rows converged, and the factorisations of all.

    A row ends where its undamped step is at most ``tolerance``, or where the next one will be by what the last two tell:
    in quadratic convergence it is as much smaller than this one as the square of their ratio.
    """
    device = equations.operators.device
    xp = device.xp
    y = np.array(y)
    done = np.zeros(len(y), dtype=bool)
    active = np.arange(len(y))
    before = np.full(len(y), np.inf)
    factorisations = 0
    for _ in range(MOST_STEPS):
        sizes, parts = np.empty(len(active)), np.empty(len(active))
        for chunk in device.chunks(len(active), y.shape[1]):
            rows = active[chunk]
            own = equations.rows(xp.asarray(rows, device=device.device))
            here = device.put(y[rows])
            relative = own.correction(here, own.residual(here))[:, :, 0]
            part = own.admissible(here, relative)
            step = part[:, None] * relative
            moved = xp.concat(
                [here[:, :-2] * (1 + step[:, :-2]), (here + step)[:, -2:-1], (here * (1 + step))[:, -1:]], axis=1
            )
            of_gap = xp.max(xp.abs(relative[:, :-2]), axis=1)
            of_flux = xp.abs(relative[:, -1])
            sizes[chunk] = device.get(xp.where(of_flux > of_gap, of_flux, of_gap))
            parts[chunk] = device.get(part)
            y[rows] = device.get(moved)
        factorisations += len(active)
        undamped = parts >= 1.0
        coming = sizes * (sizes / before[active]) ** 2
        small = (sizes <= tolerance) | ((sizes <= QUADRATIC) & (coming <= 0.1 * tolerance))
        done[active[undamped & small]] = True
        before[active] = np.where(undamped, sizes, np.inf)
        going = ~(undamped & small) & np.isfinite(y[active]).all(axis=1)
        active = active[going]
        if not len(active):
            break
    return y, done, factorisations
