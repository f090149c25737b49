r"""The coupled mean-field equations on a mesh: residual, Jacobian and parameter derivatives.

The unknowns are the gap at the nodes, the offset and the flux gap, ``y = (h_1 ... h_N, z0, h*)``; pressures follow from
them.  With D the deflection operator, A the running integral and w the quadrature weights:

.. math::

    R_i &= h_i - z_0 - x_i^2/2 - \sum_j D_{ij} (p_c + p_f)_j, \qquad p_f = \lambda A g, \quad g = (h - h^*)/h^3 \\
    R_{N+1} &= \textstyle\sum_j w_j (p_c + p_f)_j - \pi/2 \\
    R_{N+2} &= \textstyle\sum_j w_j g_j \; s^2

s is a fixed length that makes the last row of order one.  Source: [BP] Appendix A; theory.md Eqs. (1)-(5).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from stribeck._types import Array, Numbers
from stribeck.contact_laws.law import ContactLaw
from stribeck.fluids import newtonian as reynolds
from stribeck.numerics.panels import Mesh
from stribeck.solids.half_plane import nodal_deflection

MOST_HALVINGS = 20

LOAD = 0.5 * np.pi
"""Load in Hertz units: the integral of the pressure."""


@dataclass(frozen=True, eq=False)
class Operators:
    """What the equations need of a mesh; made once and kept for all states that share it."""

    mesh: Mesh

    @cached_property
    def deflection(self) -> Array:
        """D: nodal pressures -> deflection."""
        return nodal_deflection(self.mesh)

    @cached_property
    def deflection_of_gradient(self) -> Array:
        """D A: nodal pressure gradients -> deflection."""
        return np.asfortranarray(self.mesh.after_integral(self.deflection))

    @cached_property
    def load_of_gradient(self) -> Array:
        """Row w A: nodal pressure gradients -> load."""
        return np.asarray(self.mesh.after_integral(self.mesh.weights[None, :])[0])

    @cached_property
    def moment_of_gradient(self) -> Array:
        """Row w x A on the panels in x: nodal pressure gradients -> first moment of the pressure."""
        row = self.mesh.weights * self.mesh.nodes
        row[-self.mesh.order :] = 0.0
        return np.asarray(self.mesh.after_integral(row[None, :])[0])

    @cached_property
    def parabola(self) -> Array:
        """The undeformed gap x**2/2 at the nodes."""
        return 0.5 * self.mesh.nodes**2


@dataclass(frozen=True, eq=False)
class Equations:
    """The discretised problem for one speed and one contact law.

    Parameters
    ----------
    operators : Operators
        Of the mesh.
    speed : float or ndarray
        Speed group lambda [-].
    law : ContactLaw
        Contact pressure from the gap.
    flux_scale : float
        What the last row is multiplied by.

    Notes
    -----
    All but the Jacobian also takes many states at once, the unknowns of each in a row; speed and law then hold columns.
    """

    operators: Operators
    speed: Numbers
    law: ContactLaw
    flux_scale: Numbers = 1.0

    def pressures(self, y: Array) -> tuple[Array, Array]:
        """Return the contact and the fluid pressure at the nodes [p_Hz]."""
        h, h_star = y[..., :-2], y[..., -1:]
        fluid = np.asarray(self.speed * self.operators.mesh.integral_from_infinity(reynolds.gradient(h, h_star)))
        return self.law.pressure(h), fluid

    @cached_property
    def moves(self) -> bool:
        """Whether the speed is positive; of states in rows, that of all."""
        return bool(np.all(self.speed > 0))

    def residual(self, y: Array) -> Array:
        """Return the residual at ``y``, shape (..., N + 2)."""
        op = self.operators
        h = y[..., :-2]
        g = reynolds.gradient(h, y[..., -1:])
        p_c = self.law.pressure(h)
        r = np.empty_like(y)
        r[..., :-2] = h - y[..., -2:-1] - op.parabola - p_c @ op.deflection.T
        r[..., -2] = p_c @ op.mesh.weights - LOAD
        r[..., -1:] = self.flux_scale * (g @ op.mesh.weights)[..., None]
        if self.moves:
            g *= self.speed
            r[..., :-2] -= g @ op.deflection_of_gradient.T
            r[..., -2] += g @ op.load_of_gradient
        return r

    @staticmethod
    def units(y: Array) -> Array:
        """Return the gaps and the flux gap themselves, and one for the offset: what unknowns change relative to.

        From one speed to the next films grow as a whole: the derivatives with respect to relative changes of the gap hardly
        change, and factors of a Jacobian in these units serve many states.
        """
        units = np.array(y)
        units[..., -2] = 1.0
        return units

    def relative_jacobian(self, y: Array) -> Array:
        """Return the derivative of the residual in :meth:`units` of the unknowns, :meth:`jacobian` times their diagonal."""
        return self.jacobian(y, self.units(y))

    def jacobian(self, y: Array, units: Array | None = None) -> Array:
        """Return the derivative of the residual, shape (N + 2, N + 2), in Fortran order; its columns times ``units``.

        ::

            [ I - D diag(p_c') - lambda D A diag(dg/dh)    -1    -lambda D A dg/dh* ]
            [   w diag(p_c') + lambda w A diag(dg/dh)       0     lambda w A dg/dh* ]
            [   s**2 w diag(dg/dh)                          0     s**2 w dg/dh*     ]
        """
        op = self.operators
        n = len(y) - 2
        h, h_star = y[:-2], y[-1]
        u, u_offset, u_flux = (np.ones(n), 1.0, 1.0) if units is None else (units[:n], units[n], units[n + 1])
        p_slope = self.law.slope(h, self.law.pressure(h)) * u
        g_h = reynolds.gap_derivative(h, h_star) * u
        g_flux = reynolds.flux_derivative(h) * u_flux
        matrix = np.zeros((n + 2, n + 2), order="F")
        block = matrix[:n, :n]
        np.multiply(op.deflection, -p_slope, out=block)
        matrix[n, :n] = op.mesh.weights * p_slope
        if self.moves:
            block -= op.deflection_of_gradient * (self.speed * g_h)
            matrix[:n, n + 1] = op.deflection_of_gradient @ (-self.speed * g_flux)
            matrix[n, :n] += op.load_of_gradient * (self.speed * g_h)
            matrix[n, n + 1] = self.speed * (op.load_of_gradient @ g_flux)
        block[np.diag_indices(n)] += u
        matrix[:n, n] = -u_offset
        matrix[n + 1, :n] = op.mesh.weights * g_h * self.flux_scale
        matrix[n + 1, n + 1] = self.flux_scale * (op.mesh.weights @ g_flux)
        return matrix

    def parameter_derivative(self, y: Array, name: str) -> Array:
        """Return the derivative of the residual with respect to the logarithm of one group, shape (N + 2,).

        Parameters
        ----------
        y : ndarray, shape (N + 2,)
            Unknowns.
        name : {"speed", "load", "roughness"}
            The group; the other two are held.
        """
        op = self.operators
        h = y[:-2]
        if name == "speed":
            g = self.speed * reynolds.gradient(h, y[-1])
            return np.concatenate([-(op.deflection_of_gradient @ g), [op.load_of_gradient @ g, 0.0]])
        derivative = self.law.load_derivative if name == "load" else self.law.roughness_derivative
        change = derivative(h, self.law.pressure(h))
        return np.concatenate([-(op.deflection @ change), [op.mesh.weights @ change, 0.0]])

    def admissible(self, y: Array, dy: Array) -> float:
        """Return the longest part of a Newton step that keeps the gap positive and the contact pressure sane.

        The gap may lose 70 % at most; where contact matters, its pressure may grow or fall by e**3 at most.
        """
        ratio = dy[:-2] / y[:-2]
        part = 0.7 / max(0.7, -float(ratio.min()))
        flux = dy[-1] / y[-1]
        part = min(part, 0.7 / max(0.7, abs(flux)))
        if np.all(self.law.decay > 0):
            log_p = self.law.log_pressure(y[:-2])
            decays = dy[:-2] / self.law.local_decay(y[:-2])
            allowed = 3.0 + np.maximum(0.0, -1.0 - log_p)
            closing = float((-decays / allowed).max())
            opening = float((decays * (log_p > -7.0)).max()) / 3.0
            part = min(part, 1.0 / max(1.0, closing, opening))
            if not self.law.uniform:
                part = self._held_by_law(y, dy, float(part), log_p, allowed)
        return float(part)

    def _held_by_law(self, y: Array, dy: Array, part: float, log_p: Array, allowed: Array) -> float:
        """Return the part halved until the pressure of a law that stiffens grows by no more than half as much again."""
        for _ in range(MOST_HALVINGS):
            with np.errstate(all="ignore"):
                growth = self.law.log_pressure(y[:-2] + part * dy[:-2]) - log_p
            if (growth <= 1.5 * allowed).all():
                break
            part *= 0.5
        return part

    @staticmethod
    def size(y: Array, dy: Array) -> float:
        """Return the relative size of a step: the largest relative change of the gap and of the flux gap, in any row."""
        gaps, fluxes = dy[..., :-2] / y[..., :-2], dy[..., -1] / y[..., -1]
        return float(max(np.abs(gaps).max(), np.abs(fluxes).max()))
