"""The inverse of the Jacobian where the fluid pressure is an unknown: with it, or with its step eliminated."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from stribeck._types import Array
from stribeck.equations.film import by_pressure_of, gradient_in_film, slopes_in_film
from stribeck.numerics.newton import LU
from stribeck.numerics.running_integral import Volterra

if TYPE_CHECKING:
    from stribeck.equations.line import Equations

__all__ = ["Coupled", "Eliminated"]


class Coupled:
    """The inverse of the Jacobian with the fluid pressure among the unknowns, by LU factors of all of it."""

    def __init__(self, equations: Equations, y: Array) -> None:
        op, at, film, dilation = equations.operators, equations.layout, equations.film, equations.dilation(y)
        d = None if dilation is None else float(dilation[0])
        h, n, units = y[at.gap], op.mesh.size, equations.units(y)
        scaled, speed = op.dilated(d, of_gradient=False), equations.speed if d is None else equations.speed * d
        slopes = slopes_in_film(film, op.integral, h, y[at.pressure], y[at.flux_gap])
        by_gap, by_pressure, by_flux = slopes.by_gap, by_pressure_of(slopes), slopes.by_flux
        matrix = np.zeros((at.size, at.size), order="F")
        gap, pressure, offset, flux = at.gap, at.pressure, at.offset.start, at.flux_gap.start
        contact = equations.law.slope(h, equations.law.pressure(h))
        running = op.integral.after(np.eye(n))
        matrix[gap, gap] = np.eye(n) - scaled.deflection * contact
        matrix[gap, pressure] = -scaled.deflection
        matrix[gap, offset] = -1.0
        matrix[pressure, gap] = -speed * running * by_gap
        matrix[pressure, pressure] = np.eye(n) - speed * running * by_pressure
        matrix[pressure, flux] = -speed * (running @ by_flux)
        matrix[offset, gap], matrix[offset, pressure] = scaled.weights * contact, scaled.weights
        for k, (end, of) in enumerate(zip(scaled.ends, equations.slopes_of_ends(y, slopes), strict=True)):
            row = equations.flux_scale * end
            matrix[flux + k, gap], matrix[flux + k, pressure] = row * of.by_gap, row * by_pressure_of(of)
            matrix[flux + k, flux] = row @ of.by_flux
        if op.has_exit:
            matrix[gap, at.exit.start] = -equations.positions(y)
        if d is not None:
            g, column = gradient_in_film(film, op.integral, h, y[at.pressure], y[at.flux_gap]), at.dilation.start
            explicit = equations.by_dilation_alone(y, d, g)
            matrix[gap, column], matrix[offset:, column] = explicit[:n], explicit[n:]
            matrix[pressure, column] = -equations.fluid_by_dilation(g, d, None)
        matrix *= units
        self.factors = LU.of(matrix, overwrite=True)

    @property
    def is_finite(self) -> bool:
        """Whether the factors are finite."""
        return self.factors.is_finite

    def __call__(self, residuals: Array) -> Array:
        """Return ``-J^-1 r`` in units of the unknowns."""
        return self.factors(residuals)


class Eliminated:
    """The inverse of the Jacobian with the fluid pressure among the unknowns, whose step it eliminates.

    The rows of the pressure give ``dp = V (G_h dh + G_m dm) lambda - q`` with the Volterra operator V and ``q = (I - lambda A
    G_p)**-1 r_p``; what is left is the system of :meth:`Equations.jacobian`.
    """

    def __init__(self, equations: Equations, y: Array) -> None:
        self.equations = equations
        op, at, film = equations.operators, equations.layout, equations.film
        dilation = equations.dilation(y)
        d = None if dilation is None else float(dilation[0])
        self.units = equations.units(y)
        self.slopes = slopes_in_film(film, op.integral, y[at.gap], y[at.pressure], y[at.flux_gap])
        self.by_pressure = by_pressure_of(self.slopes)
        self.of_ends = equations.slopes_of_ends(y, self.slopes)
        self.speed = equations.speed if d is None else equations.speed * d
        self.scaled = op.dilated(d, of_gradient=False)
        self.volterra = Volterra(op.integral, np.asarray(self.speed * self.by_pressure))
        self.by_dilation = None
        if d is not None:
            g = gradient_in_film(film, op.integral, y[at.gap], y[at.pressure], y[at.flux_gap])
            self.by_dilation = equations.fluid_by_dilation(g, d, self.by_pressure)
        self.reduced = LU.of(equations.jacobian(y, self.units, self.volterra), overwrite=True)

    @property
    def is_finite(self) -> bool:
        """Whether the reduced system is finite."""
        return self.reduced.is_finite

    def __call__(self, residuals: Array) -> Array:
        """Return ``-J^-1 r`` in units of the unknowns."""
        equations, at = self.equations, self.equations.layout
        n = equations.operators.mesh.size
        r_p = residuals[..., at.pressure]
        q = r_p + self.volterra(self.speed * self.by_pressure * r_p)
        reduced = np.concatenate([residuals[..., at.gap], residuals[..., at.numbers]], axis=-1)
        reduced[..., :n] += q @ self.scaled.deflection.T
        reduced[..., n] -= q @ self.scaled.weights
        for k, (end, of) in enumerate(zip(self.scaled.ends, self.of_ends, strict=True)):
            reduced[..., n + 1 + k] -= (equations.flux_scale * by_pressure_of(of) * q) @ end
        step = self.reduced(reduced)
        found = np.empty_like(residuals)
        found[..., at.gap], found[..., at.numbers] = step[..., :n], step[..., n:]
        by_gap = self.slopes.by_gap * self.units[at.gap]
        by_flux = self.slopes.by_flux * self.units[at.flux_gap]
        gradients = self.speed * (by_gap * step[..., :n] + by_flux * step[..., n + 1 : n + 2])
        found[..., at.pressure] = self.volterra(gradients) - q
        if self.by_dilation is not None:
            found[..., at.pressure] += self.by_dilation * step[..., n + 3 :]
        return found
