r"""The coupled mean-field equations on a mesh: residual, Jacobian and derivatives with respect to the groups.

The unknowns are the gap at the nodes, the offset and the flux gap, ``y = (h_1 ... h_N, z0, h*)``; pressures follow from
them.  With D the deflection operator, A the running integral and w the quadrature weights:

.. math::

    R_i &= h_i - z_0 - x_i^2/2 - \sum_j D_{ij} (p_c + p_f)_j, \qquad p_f = \lambda A G, \quad G = (h - h^*)/h^3 \\
    R_{N+1} &= \textstyle\sum_j w_j (p_c + p_f)_j - \pi/2 \\
    R_{N+2} &= \textstyle\sum_j w_j G_j \; s^2

s is a fixed length that makes the last row of order one.  If the gradient G depends on the pressure, the nodal fluid pressure
is an unknown too, with the rows ``p_f - lambda A G``; Newton's step eliminates it.

With a free exit the film ends at x_c, and x is measured from there: D, A and w do not depend on x_c, which enters by the
parabola ``(x + x_c)**2/2`` alone.  The integrals of G end at the exit, and one more row asks that G vanish there.

Source: [BP] Appendix A; theory.md Eqs. (1)-(5).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from stribeck._types import Array, Numbers
from stribeck.contact_laws.law import ContactLaw
from stribeck.contacts.model import ARTICLE, Model
from stribeck.equations.unknowns import Layout
from stribeck.fluids.cavitation import Cavitation
from stribeck.fluids.fluid import Film
from stribeck.numerics.newton import LU, Inverse
from stribeck.numerics.panels import Mesh, reference
from stribeck.numerics.running_integral import RunningIntegral, Volterra
from stribeck.quantities.outcome import Outcome

MOST_HALVINGS = 20

LOAD = 0.5 * np.pi
"""Load in Hertz units: the integral of the pressure."""


@dataclass(frozen=True, eq=False)
class Operators:
    """What the equations need of a mesh; made once and kept for all states that share it."""

    mesh: Mesh
    model: Model = ARTICLE

    @cached_property
    def layout(self) -> Layout:
        """The unknowns by name; the fluid pressure and the exit are among them if the model has them."""
        n = self.mesh.size
        fields = 2 * n if self.model.film.uses_pressure else n
        size = fields + 2 + self.has_exit
        return Layout(
            size,
            gap=slice(0, n),
            numbers=slice(fields, size),
            offset=slice(fields, fields + 1),
            flux_gap=slice(fields + 1, fields + 2),
            pressure=slice(n, fields),
            exit=slice(fields + 2, size),
        )

    @property
    def has_exit(self) -> bool:
        """Whether the film ends at a free exit, from which x is measured."""
        return self.model.cavitation is Cavitation.EXIT

    @cached_property
    def integral(self) -> RunningIntegral:
        """A: nodal pressure gradients -> pressure."""
        return RunningIntegral(self.mesh, one_sided=self.has_exit)

    @cached_property
    def deflection(self) -> Array:
        """D: nodal pressures -> deflection."""
        return self.model.solid.deflection(self.mesh)

    @cached_property
    def deflection_of_gradient(self) -> Array:
        """D A: nodal pressure gradients -> deflection."""
        return np.asfortranarray(self.integral.after(self.deflection))

    @cached_property
    def load_of_gradient(self) -> Array:
        """Row w A: nodal pressure gradients -> load."""
        return np.asarray(self.integral.after(self.mesh.weights[None, :])[0])

    @cached_property
    def moment_of_gradient(self) -> Array:
        """Row w x A on the panels in x: nodal pressure gradients -> first moment of the pressure."""
        row = self.mesh.weights * self.mesh.nodes
        row[-self.mesh.order :] = 0.0
        return np.asarray(self.integral.after(row[None, :])[0])

    @cached_property
    def parabola(self) -> Array:
        """The undeformed gap x**2/2 at the nodes."""
        return 0.5 * self.mesh.nodes**2

    @cached_property
    def at_exit(self) -> Array:
        """Row: nodal values -> the value at zero, from the left."""
        row = np.zeros(self.mesh.size)
        last = slice((self.integral.middle - 1) * self.mesh.order, self.integral.middle * self.mesh.order)
        row[last] = reference(self.mesh.order).left_end[::-1]
        return row


@dataclass(frozen=True, eq=False)
class Equations:
    """The discretised problem for one speed and one contact law.

    Parameters
    ----------
    operators : Operators
        Of the mesh and the model.
    speed : float or ndarray
        Speed group lambda [-].
    law : ContactLaw
        Contact pressure from the gap.
    flux_scale : float
        What the rows of the gradient are multiplied by.

    Notes
    -----
    All but the Jacobian also takes many stacked states at once, the unknowns of each in a row; speed and law then hold
    columns.
    """

    operators: Operators
    speed: Numbers
    law: ContactLaw
    flux_scale: Numbers = 1.0

    @property
    def layout(self) -> Layout:
        """The unknowns by name."""
        return self.operators.layout

    @cached_property
    def film(self) -> Film:
        """The film at this speed."""
        film = self.operators.model.film
        return film.at(self.speed) if film.uses_speed else film

    def pressures(self, y: Array) -> tuple[Array, Array]:
        """Return the contact and the fluid pressure at the nodes [p_Hz]."""
        at, film = self.layout, self.film
        h = y[..., at.gap]
        if film.uses_pressure:
            return self.law.pressure(h), y[..., at.pressure]
        fluid = np.asarray(self.speed * self.operators.integral(film.gradient(h, None, y[..., at.flux_gap])))
        return self.law.pressure(h), fluid

    @cached_property
    def is_sliding(self) -> bool:
        """Whether the speed is positive; of stacked states, that of all."""
        return bool(np.all(self.speed > 0))

    def residual(self, y: Array) -> Array:
        """Return the residual at ``y``, in its layout."""
        op, at, film = self.operators, self.layout, self.film
        h, z0, h_star = y[..., at.gap], y[..., at.offset], y[..., at.flux_gap]
        p_f = y[..., at.pressure] if film.uses_pressure else None
        g = film.gradient(h, p_f, h_star)
        p_c = self.law.pressure(h)
        r = np.empty_like(y)
        r[..., at.gap] = h - z0 - op.parabola - p_c @ op.deflection.T
        r[..., at.offset.start] = p_c @ op.mesh.weights - LOAD
        r[..., at.flux_gap] = self.flux_scale * (g @ op.integral.weights)[..., None]
        if op.has_exit:
            x_c = y[..., at.exit]
            r[..., at.gap] -= x_c * (op.mesh.nodes + 0.5 * x_c)
            r[..., at.exit] = self.flux_scale * (g @ op.at_exit)[..., None]
        if p_f is not None:
            r[..., at.pressure] = p_f - self.speed * op.integral(g)
            r[..., at.gap] -= p_f @ op.deflection.T
            r[..., at.offset.start] += p_f @ op.mesh.weights
        elif self.is_sliding:
            g *= self.speed
            r[..., at.gap] -= g @ op.deflection_of_gradient.T
            r[..., at.offset.start] += g @ op.load_of_gradient
        return r

    def units(self, y: Array) -> Array:
        """Return the gaps and the flux gap themselves, and one for all else: what unknowns change relative to.

        From one speed to the next films grow as a whole: the derivatives with respect to relative changes of the gap hardly
        change, and an inverse in these units serves many states.
        """
        at = self.layout
        units = np.ones_like(y)
        units[..., at.gap] = y[..., at.gap]
        units[..., at.flux_gap] = y[..., at.flux_gap]
        return units

    def inverse(self, y: Array) -> Inverse:
        """Return the inverse of the Jacobian in :meth:`units` of the unknowns, by LU factors."""
        if self.film.uses_pressure:
            return _Eliminated(self, y)
        return LU.of(self.jacobian(y, self.units(y)), overwrite=True)

    def jacobian(self, y: Array, units: Array | None = None) -> Array:
        """Return the derivative of the residual, dense, in Fortran order; its columns times ``units``.

        ::

            [ I - D diag(p_c') - lambda D A diag(dG/dh)    -1    -lambda D A dG/dh*   -(x + x_c) ]
            [   w diag(p_c') + lambda w A diag(dG/dh)       0     lambda w A dG/dh*       0      ]
            [   s**2 w diag(dG/dh)                          0     s**2 w dG/dh*           0      ]
            [   s**2 e diag(dG/dh)                          0     s**2 e dG/dh*           0      ]

        The last row and column are those of a free exit, with e the value there.  A fluid pressure among the unknowns is
        eliminated: A is then ``(I - lambda A diag(dG/dp))**-1 A``.
        """
        op, at, film = self.operators, self.layout, self.film
        n = op.mesh.size
        h = y[at.gap]
        u, v = (np.ones(n), np.ones(3)) if units is None else (units[at.gap], units[at.numbers])
        p_slope = self.law.slope(h, self.law.pressure(h)) * u
        p_f = y[at.pressure] if film.uses_pressure else None
        by_h, by_p, by_flux, _ = film.slopes(h, p_f, y[at.flux_gap])
        g_h, g_flux = by_h * u, by_flux * v[1]
        ends = [op.integral.weights, op.at_exit] if op.has_exit else [op.integral.weights]
        size = n + 2 + op.has_exit
        matrix = np.zeros((size, size), order="F")
        block, offset, flux = matrix[:n, :n], n, n + 1
        np.multiply(op.deflection, -p_slope, out=block)
        matrix[offset, :n] = op.mesh.weights * p_slope
        of_pressure = None
        if by_p is not None:
            rows = [op.deflection, op.mesh.weights[None], *(end[None] * by_p for end in ends)]
            of_pressure = Volterra(op.integral, self.speed * by_p).after(np.concatenate(rows))
        if self.is_sliding:
            deflection = op.deflection_of_gradient if of_pressure is None else of_pressure[:n]
            load = op.load_of_gradient if of_pressure is None else of_pressure[n]
            block -= deflection * (self.speed * g_h)
            matrix[:n, flux] = deflection @ (-self.speed * g_flux)
            matrix[offset, :n] += load * (self.speed * g_h)
            matrix[offset, flux] = self.speed * (load @ g_flux)
        block[np.diag_indices(n)] += u
        matrix[:n, offset] = -v[0]
        for k, end in enumerate(ends):
            row = end if of_pressure is None else end + self.speed * of_pressure[n + 1 + k]
            matrix[n + 1 + k, :n] = row * g_h * self.flux_scale
            matrix[n + 1 + k, flux] = self.flux_scale * (row @ g_flux)
        if op.has_exit:
            matrix[:n, n + 2] = -v[2] * (op.mesh.nodes + y[at.exit.start])
        return matrix

    def parameter_derivative(self, y: Array, name: str) -> Array:
        """Return the derivative of the residual with respect to the logarithm of one group, in the layout of ``y``.

        Parameters
        ----------
        y : ndarray
            Unknowns.
        name : {"speed", "load", "roughness"}
            The group; the other two are held.
        """
        op, at, film = self.operators, self.layout, self.film
        h, found = y[at.gap], np.zeros_like(y)
        if name == "speed":
            p_f = y[at.pressure] if film.uses_pressure else None
            g = self.speed * film.gradient(h, p_f, y[at.flux_gap])
            by_speed = film.slopes(h, p_f, y[at.flux_gap]).by_speed
            if by_speed is not None:
                g = g + self.speed * by_speed
                found[at.flux_gap] = self.flux_scale * (by_speed @ op.integral.weights)
                if op.has_exit:
                    found[at.exit] = self.flux_scale * (by_speed @ op.at_exit)
            if p_f is not None:
                found[at.pressure] = -op.integral(g)
            else:
                found[at.gap] = -(op.deflection_of_gradient @ g)
                found[at.offset] = op.load_of_gradient @ g
            return found
        derivative = self.law.load_derivative if name == "load" else self.law.roughness_derivative
        change = derivative(h, self.law.pressure(h))
        found[at.gap] = -(op.deflection @ change)
        found[at.offset] = op.mesh.weights @ change
        return found

    def admissible(self, y: Array, dy: Array) -> float:
        """Return the longest fraction of a Newton step that keeps the gap positive and the contact pressure sane.

        The gap may lose 70 % at most; if contact matters, its pressure may grow or fall by e**3 at most.
        """
        at = self.layout
        h, dh = y[at.gap], dy[at.gap]
        part = 0.7 / max(0.7, -float((dh / h).min()))
        flux = dy[at.flux_gap.start] / y[at.flux_gap.start]
        part = min(part, 0.7 / max(0.7, abs(flux)))
        if self.operators.has_exit:
            part = min(part, 0.3 / max(0.3, abs(dy[at.exit.start])))
        if np.all(self.law.decay_length > 0):
            log_p = self.law.log_pressure(h)
            decays = dh / self.law.local_decay_length(h)
            allowed = 3.0 + np.maximum(0.0, -1.0 - log_p)
            closing = float((-decays / allowed).max())
            opening = float((decays * (log_p > -7.0)).max()) / 3.0
            part = min(part, 1.0 / max(1.0, closing, opening))
            if not self.law.constant_decay:
                part = self._held_by_law(h, dh, float(part), log_p, allowed)
        return float(part)

    def _held_by_law(self, h: Array, dh: Array, part: float, log_p: Array, allowed: Array) -> float:
        """Return the part halved until the pressure of a law that stiffens grows by no more than half as much again."""
        for _ in range(MOST_HALVINGS):
            with np.errstate(all="ignore"):
                growth = self.law.log_pressure(h + part * dh) - log_p
            if (growth <= 1.5 * allowed).all():
                break
            part *= 0.5
        return part

    def size(self, y: Array, dy: Array) -> float:
        """Return the relative size of a step: the largest relative change of gap and flux gap, in any row.

        Exit and pressure change in their own units, a and p_Hz.
        """
        at = self.layout
        gaps = dy[..., at.gap] / y[..., at.gap]
        fluxes = dy[..., at.flux_gap.start] / y[..., at.flux_gap.start]
        others = (np.abs(dy[..., block]).max(initial=0.0) for block in (at.pressure, at.exit))
        return float(max(np.abs(gaps).max(), np.abs(fluxes).max(), *others))


class _Eliminated:
    """The inverse of the Jacobian with the fluid pressure among the unknowns, whose step it eliminates.

    The rows of the pressure give ``dp = V (G_h dh + G_m dm) lambda - q`` with the Volterra operator V and ``q = (I - lambda A
    G_p)**-1 r_p``; what is left is the system of :meth:`Equations.jacobian`.
    """

    def __init__(self, equations: Equations, y: Array) -> None:
        self.equations = equations
        op, at, film = equations.operators, equations.layout, equations.film
        self.units = equations.units(y)
        self.slopes = film.slopes(y[at.gap], y[at.pressure], y[at.flux_gap])
        assert self.slopes.by_pressure is not None
        self.by_pressure = self.slopes.by_pressure
        self.factor = np.asarray(equations.speed * self.by_pressure)
        self.volterra = Volterra(op.integral, self.factor)
        self.reduced = LU.of(equations.jacobian(y, self.units), overwrite=True)

    @property
    def failure(self) -> Outcome | None:
        """That of the reduced system."""
        return self.reduced.failure

    @property
    def is_finite(self) -> bool:
        """Whether the reduced system is finite."""
        return self.reduced.is_finite

    def __call__(self, residuals: Array) -> Array:
        """Return ``-J^-1 r`` in units of the unknowns."""
        equations, op, at = self.equations, self.equations.operators, self.equations.layout
        n = op.mesh.size
        r_p = residuals[..., at.pressure]
        q = r_p + self.volterra(self.factor * r_p)
        reduced = np.concatenate([residuals[..., at.gap], residuals[..., at.numbers]], axis=-1)
        reduced[..., :n] += q @ op.deflection.T
        reduced[..., n] -= q @ op.mesh.weights
        scaled = equations.flux_scale * self.by_pressure * q
        reduced[..., n + 1] -= scaled @ op.integral.weights
        if op.has_exit:
            reduced[..., n + 2] -= scaled @ op.at_exit
        step = self.reduced(reduced)
        found = np.empty_like(residuals)
        found[..., at.gap], found[..., at.numbers] = step[..., :n], step[..., n:]
        by_gap = self.slopes.by_gap * self.units[at.gap]
        by_flux = self.slopes.by_flux * self.units[at.flux_gap]
        gradients = equations.speed * (by_gap * step[..., :n] + by_flux * step[..., n + 1 : n + 2])
        found[..., at.pressure] = self.volterra(gradients) - q
        return found
