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
parabola ``(x + x_c)**2/2`` alone.  The integrals of G end at the exit, and one more row asks that G vanish there; where the
fluid thins, G at low rates, which vanishes with it: G itself may be a small power of the gap, which no polynomial follows.
A film that ends at the pressure p_cav of the cavity and re-forms behind it has one more unknown still, the length of the
cavity, which stretches the frame (:mod:`stribeck.equations.operators`); the two integrals of G are then ``p_cav/lambda`` and
minus that.

Source: [BP] Appendix A; theory.md Eqs. (1)-(5).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from stribeck._types import Array, Numbers
from stribeck.contact_laws.law import ContactLaw
from stribeck.equations.damping import longest_step
from stribeck.equations.film import by_pressure_of, gradient_in_film, slopes_in_film
from stribeck.equations.operators import LOAD, Operators
from stribeck.equations.unknowns import Layout
from stribeck.fluids.cavitation import Cavitation
from stribeck.fluids.fluid import Film, Slopes
from stribeck.numerics.newton import LU, Inverse
from stribeck.numerics.running_integral import Volterra
from stribeck.quantities.lazy import cached_property

__all__ = ["LOAD", "Coupled", "Eliminated", "Equations", "Operators"]

# Columns of a Jacobian computed at once: a product as large as the whole needs new memory, which costs more than itself.
BLOCK_COLUMNS = 48

# Logarithm of the growth of an error in the pressure from the edge of the film to its middle beyond which no integral from
# there is taken.
MAX_LOG_GROWTH = 10.0


@dataclass(frozen=True, eq=False)
class Equations:
    """The discretised problem for one speed and one contact law."""

    operators: Operators  # Of the mesh and the model
    speed: Numbers  # Speed group lambda [-]
    law: ContactLaw  # Contact pressure from the gap
    flux_scale: Numbers = 1.0  # Factor of the rows of the gradient

    @cached_property
    def layout(self) -> Layout:
        """The unknowns by name; the fluid pressure and the ends of the film are among them if the model has them."""
        n, model = self.operators.mesh.nodes.size, self.operators.model
        fields = 2 * n if model.film.uses_pressure else n
        exit = fields + 2 + (model.cavitation is not Cavitation.NONE)
        size = exit + (model.cavitation is Cavitation.REFORM)
        return Layout(
            size,
            gap=slice(0, n),
            numbers=slice(fields, size),
            offset=slice(fields, fields + 1),
            flux_gap=slice(fields + 1, fields + 2),
            pressure=slice(n, fields),
            exit=slice(fields + 2, exit),
            cavity_stretch=slice(exit, size),
        )

    @cached_property
    def film(self) -> Film:
        """The film at this speed."""
        film = self.operators.model.film
        return film.at(self.speed) if film.uses_speed else film

    @cached_property
    def ending(self) -> Film:
        """The film whose gradient vanishes at the exit: that of low rates, which does so with G, but smoothly."""
        return getattr(self.film, "at_low_rates", self.film)

    def slopes_of_ends(self, y: Array, slopes: Slopes) -> tuple[Slopes, ...]:
        """Return the derivatives of the gradients that the rows of the ends take, ``slopes`` being those of G."""
        if self.ending is self.film or not self.operators.has_exit:
            return (slopes,) * len(self.operators.ends)
        at = self.layout
        p_f = y[..., at.pressure] if self.film.uses_pressure else None
        at_exit = slopes_in_film(self.ending, self.operators.integral, y[..., at.gap], p_f, y[..., at.flux_gap])
        return (slopes, at_exit, slopes)[: len(self.operators.ends)]

    def cavity_stretch(self, y: Array) -> Array | None:
        """Return stretch of the cavity, a column of stacked states; None where the film does not re-form."""
        return y[..., self.layout.cavity_stretch] if self.operators.has_reformation else None

    def positions(self, y: Array) -> Array:
        """Return x at the nodes [a]."""
        nodes, d = self.operators.mesh.nodes, self.cavity_stretch(y)
        if not self.operators.has_exit:
            return nodes
        return np.asarray(y[..., self.layout.exit] + (nodes if d is None else d * nodes))

    def far_gap(self, y: Array) -> Callable[[Array], Array]:
        """Return the far gap as a function of the coordinate, up to a smooth function of the inverse coordinate."""
        solid, d = self.operators.model.solid, self.cavity_stretch(y)
        if not self.operators.has_exit:
            return solid.far_gap
        x_c = y[..., self.layout.exit]

        def far(xi: Array) -> Array:
            x = xi if d is None else d * xi
            return np.asarray(solid.far_gap(x) + x_c * x)

        return far

    def fluid_pressure(self, y: Array) -> Array:
        """Return the fluid pressure at the nodes [p_Hz]."""
        at, op, film, d = self.layout, self.operators, self.film, self.cavity_stretch(y)
        if film.uses_pressure:
            return y[..., at.pressure]
        fluid = np.asarray(
            self.speed * op.integral(gradient_in_film(film, op.integral, y[..., at.gap], None, y[..., at.flux_gap]))
        )
        return fluid if d is None else d * fluid + op.in_cavity * self.cavity_pressure(y)

    def cavity_pressure(self, y: Array) -> Array:
        """Return the pressure of the cavity [p_Hz], a column of stacked states."""
        return np.full_like(y[..., self.layout.cavity_stretch], self.operators.model.cavity_pressure)

    def pressures(self, y: Array) -> tuple[Array, Array]:
        """Return the contact and the fluid pressure at the nodes [p_Hz]."""
        return self.law.pressure(y[..., self.layout.gap]), self.fluid_pressure(y)

    @cached_property
    def is_sliding(self) -> bool:
        """Whether the speed is positive; for stacked states, whether all are."""
        return bool(np.all(self.speed > 0))

    def residual(self, y: Array) -> Array:
        """Return the residual at ``y``, in its layout."""
        op, at, film, d = self.operators, self.layout, self.film, self.cavity_stretch(y)
        h, z0, h_star = y[..., at.gap], y[..., at.offset], y[..., at.flux_gap]
        p_f = y[..., at.pressure] if film.uses_pressure else None
        g = gradient_in_film(film, op.integral, h, p_f, h_star)
        pressure, r = self.law.pressure(h), np.empty_like(y)
        if p_f is not None or d is not None or self.is_sliding:
            fluid = self.speed * op.integral(g)
            if d is not None:
                fluid = d * fluid + op.in_cavity * self.cavity_pressure(y)
            if p_f is not None:
                r[..., at.pressure] = p_f - fluid
            pressure = pressure + (fluid if p_f is None else p_f)
        parabola = op.parabola if d is None else 0.5 * (d * op.mesh.nodes) ** 2
        r[..., at.gap] = h - z0 - parabola - op.deflected(pressure, d)
        r[..., at.offset.start] = pressure @ op.weights - LOAD
        r[..., at.flux_gap] = self.flux_scale * (g @ op.integral.weights)[..., None]
        if op.has_exit:
            x_c = y[..., at.exit]
            r[..., at.gap] -= x_c * ((op.mesh.nodes if d is None else d * op.mesh.nodes) + 0.5 * x_c)
            ends = g if self.ending is film else gradient_in_film(self.ending, op.integral, h, p_f, h_star)
            r[..., at.exit] = self.flux_scale * (ends @ op.at_exit)[..., None]
        if d is not None:
            in_cavity = self.cavity_pressure(y) / self.speed
            r[..., at.flux_gap] = d * r[..., at.flux_gap] - self.flux_scale * in_cavity
            r[..., at.cavity_stretch] = self.flux_scale * (d * (g @ op.integral.weights_beyond)[..., None] + in_cavity)
            r[..., at.offset] += (d - 1) * (r[..., at.offset] + LOAD)
        return r

    def units(self, y: Array) -> Array:
        """Return the scales of the unknowns: the gaps and the flux gap themselves, and one for all others."""
        # Films grow as a whole from one speed to the next: derivatives by relative changes of the gap hardly change, and an
        # inverse in these units serves many states.
        at = self.layout
        units = np.ones_like(y)
        units[..., at.gap] = y[..., at.gap]
        units[..., at.flux_gap] = y[..., at.flux_gap] if self.operators.is_base_model else self._flux_unit(y)
        return units

    def _flux_unit(self, y: Array) -> Array:
        """Return the scale of the flux gap, a column of stacked states."""
        at = self.layout
        # Where roughness carries fluid along, the flux gap may be zero.
        return np.asarray(np.maximum(np.abs(y[..., at.flux_gap]), y[..., at.gap].min(axis=-1, keepdims=True)))

    def inverse(self, y: Array) -> Inverse:
        """Return the inverse of the Jacobian in :meth:`units` of the unknowns, by LU factors."""
        if self.film.uses_pressure:
            return Coupled(self, y) if self.is_stiff(y) else Eliminated(self, y)
        return LU.of(self.jacobian(y, self.units(y)), overwrite=True)

    def is_stiff(self, y: Array) -> bool:
        """Return whether a pressure that is integrated from one end grows too much, as in a thin compressible film."""
        # There the flux and the density fix the gap, and the gap the pressure.
        at, integral = self.layout, self.operators.integral
        if not self.film.uses_pressure:
            return False
        slopes = slopes_in_film(self.film, integral, y[..., at.gap], y[..., at.pressure], y[..., at.flux_gap])
        return bool(np.max(np.abs(self.speed * integral(by_pressure_of(slopes)))) > MAX_LOG_GROWTH)

    def jacobian(self, y: Array, units: Array | None = None, volterra: Volterra | None = None) -> Array:
        """Return the derivative of the residual, dense, in Fortran order; its columns times ``units``."""
        # [ I - D diag(p_c') - lambda D A diag(dG/dh)    -1    -lambda D A dG/dh*   -(x + x_c) ]
        # [   w diag(p_c') + lambda w A diag(dG/dh)       0     lambda w A dG/dh*       0      ]
        # [   s**2 w diag(dG/dh)                          0     s**2 w dG/dh*           0      ]
        # [   s**2 e diag(dG/dh)                          0     s**2 e dG/dh*           0      ]
        # The last row and column are those of a free exit, with e the value there; a film that re-forms has one more of each.
        # A fluid pressure among the unknowns is eliminated: A is then (I - lambda A diag(dG/dp))**-1 A.
        op, at, film = self.operators, self.layout, self.film
        n, cavity_stretch = op.mesh.size, self.cavity_stretch(y)
        h = y[at.gap]
        numbers = at.size - at.numbers.start
        u, v = (np.ones(n), np.ones(numbers)) if units is None else (units[at.gap], units[at.numbers])
        p_slope = self.law.slope(h, self.law.pressure(h)) * u
        p_f = y[at.pressure] if film.uses_pressure else None
        slopes = slopes_in_film(film, op.integral, h, p_f, y[at.flux_gap])
        of_ends = self.slopes_of_ends(y, slopes)
        by_h, by_p, by_flux, _ = slopes
        g_h, g_flux = by_h * u, by_flux * v[1]
        d = None if cavity_stretch is None else float(cavity_stretch[0])
        speed = self.speed if d is None else self.speed * d
        scaled = op.stretched(d, self.is_sliding and by_p is None)
        matrix = np.empty((n + numbers, n + numbers), order="F")
        matrix[n:], matrix[:, n:] = 0.0, 0.0
        block, offset, flux = matrix[:n, :n], n, n + 1
        matrix[offset, :n] = scaled.weights * p_slope
        of_pressure = None
        if by_p is not None:
            ends = (end[None] * by_pressure_of(of) for end, of in zip(scaled.ends, of_ends, strict=True))
            rows = [scaled.deflection, scaled.weights[None], *ends]
            volterra = Volterra(op.integral, speed * by_p) if volterra is None else volterra
            of_pressure = volterra.after(np.concatenate(rows))
        if self.is_sliding:
            deflection = scaled.deflection_of_gradient if of_pressure is None else of_pressure[:n]
            load = scaled.load_of_gradient if of_pressure is None else of_pressure[n]
            assert deflection is not None
            _combined(block, scaled.deflection, -p_slope, deflection, speed * g_h)
            matrix[:n, flux] = deflection @ (-speed * g_flux)
            matrix[offset, :n] += load * (speed * g_h)
            matrix[offset, flux] = speed * (load @ g_flux)
        else:
            np.multiply(scaled.deflection, -p_slope, out=block)
        np.einsum("ii->i", block)[...] += u
        matrix[:n, offset] = -v[0]
        for k, (end, of) in enumerate(zip(scaled.ends, of_ends, strict=True)):
            row, by_flux = end * (of.by_gap * u), end @ (of.by_flux * v[1])
            if of_pressure is not None:
                through = speed * of_pressure[n + 1 + k]
                row, by_flux = row + through * g_h, by_flux + through @ g_flux
            matrix[n + 1 + k, :n] = row * self.flux_scale
            matrix[n + 1 + k, flux] = self.flux_scale * by_flux
        if op.has_exit:
            matrix[:n, n + 2] = -v[2] * self.positions(y)
        if d is not None:
            matrix[:, n + 3] = v[3] * self.by_cavity_stretch(y, d, by_p)
        return matrix

    def by_cavity_stretch(self, y: Array, d: float, by_pressure: Array | None) -> Array:
        """Return the derivative of the residual with respect to the cavity stretch, the fluid pressure eliminated."""
        op, at = self.operators, self.layout
        p_f = y[at.pressure] if by_pressure is not None else None
        g = gradient_in_film(self.film, op.integral, y[at.gap], p_f, y[at.flux_gap])
        scaled = op.stretched(d, of_gradient=False)
        of_fluid = self.fluid_by_cavity_stretch(g, d, by_pressure)
        of_ends = self.slopes_of_ends(y, slopes_in_film(self.film, op.integral, y[at.gap], p_f, y[at.flux_gap]))
        found, n = self.by_cavity_stretch_alone(y, d, g), op.mesh.size
        found[:n] -= scaled.deflection @ of_fluid
        found[n] += scaled.weights @ of_fluid
        for k, (end, of) in enumerate(zip(scaled.ends, of_ends, strict=True)):
            if of.by_pressure is not None:
                found[n + 1 + k] += self.flux_scale * (end @ (of.by_pressure * of_fluid))
        return found

    def by_cavity_stretch_alone(self, y: Array, d: float, g: Array) -> Array:
        """Return the derivative of the residual by the cavity stretch at fixed fluid pressure; g is the gradient."""
        op, n = self.operators, self.operators.mesh.size
        contact, fluid = self.pressures(y)
        pressure = contact + fluid
        first, _, second = op.ends
        found = np.empty(n + 4)
        by_kernel = op.by_kernel(pressure, d) + op.kernel(d, derivative=True) @ pressure
        found[:n] = -self.positions(y) * op.mesh.nodes - by_kernel
        found[:n] += (np.log(d) + 1) / np.pi * (op.weights @ pressure)
        found[n] = op.weights @ pressure
        found[n + 1 :] = self.flux_scale * (first @ g), 0.0, self.flux_scale * (second @ g)
        return found

    def fluid_by_cavity_stretch(self, g: Array, d: float, by_pressure: Array | None) -> Array:
        """Return the derivative of the fluid pressure with respect to the cavity stretch, at fixed gap and flux gap."""
        integral = self.operators.integral
        if by_pressure is None:
            return np.asarray(self.speed * integral(g))
        return np.asarray(Volterra(integral, self.speed * d * by_pressure)(self.speed * g))

    def parameter_derivative(self, y: Array, name: str) -> Array:
        """Return the derivative of the residual with respect to the logarithm of one group, in the layout of ``y``."""
        op, at, film, cavity_stretch = self.operators, self.layout, self.film, self.cavity_stretch(y)
        h, found = y[at.gap], np.zeros_like(y)
        d = None if cavity_stretch is None else float(cavity_stretch[0])
        scaled = op.stretched(d, of_gradient=name == "speed")
        if name == "speed":
            p_f = y[at.pressure] if film.uses_pressure else None
            speed = self.speed if d is None else self.speed * d
            g = speed * gradient_in_film(film, op.integral, h, p_f, y[at.flux_gap])
            slopes = slopes_in_film(film, op.integral, h, p_f, y[at.flux_gap])
            blocks = (at.flux_gap, at.exit, at.cavity_stretch)
            if slopes.by_speed is not None:
                g = g + speed * slopes.by_speed
                for block, end, of in zip(blocks, scaled.ends, self.slopes_of_ends(y, slopes), strict=False):
                    found[block] = 0.0 if of.by_speed is None else self.flux_scale * (of.by_speed @ end)
            if d is not None:
                in_cavity = self.flux_scale * op.model.cavity_pressure / self.speed
                found[at.flux_gap] += in_cavity
                found[at.cavity_stretch] -= in_cavity
            if p_f is not None:
                found[at.pressure] = -op.integral(g)
            else:
                assert scaled.deflection_of_gradient is not None
                found[at.gap] = -(scaled.deflection_of_gradient @ g)
                found[at.offset] = scaled.load_of_gradient @ g
            return found
        derivative = self.law.load_derivative if name == "load" else self.law.roughness_derivative
        change = derivative(h, self.law.pressure(h))
        found[at.gap] = -(scaled.deflection @ change)
        found[at.offset] = scaled.weights @ change
        return found

    def admissible(self, y: Array, dy: Array) -> float:
        """Return the longest fraction of a Newton step that keeps the gap positive and the contact pressure within bounds."""
        # The exit may move by about a third of the width of contact or film.
        at = self.layout
        flux = dy[at.flux_gap.start] / (y[at.flux_gap.start] if self.operators.is_base_model else self._flux_unit(y)[0])
        part = 0.7 / max(0.7, abs(flux))
        if self.operators.has_exit:
            far = 0.3 * np.sqrt(1.0 + y[at.gap].min())
            part = min(part, far / max(far, abs(dy[at.exit.start])))
        if self.operators.has_reformation:
            part = min(part, 0.3 / max(0.3, abs(dy[at.cavity_stretch.start] / y[at.cavity_stretch.start])))
        return longest_step(self.law, y[at.gap], dy[at.gap], float(part))

    def size(self, y: Array, dy: Array) -> float:
        """Return the largest change by a step: relative of gaps and flux gap, absolute of the other unknowns."""
        at = self.layout
        gaps = dy[..., at.gap] / y[..., at.gap]
        unit = y[..., at.flux_gap] if self.operators.is_base_model else self._flux_unit(y)
        fluxes = dy[..., at.flux_gap] / unit
        blocks = (block for block in (at.pressure, at.exit, at.cavity_stretch) if block.start < block.stop)
        others = [np.abs(dy[..., block]).max() for block in blocks]
        return float(max(np.abs(gaps).max(), np.abs(fluxes).max(), *others))


class Coupled:
    """The inverse of the Jacobian with the fluid pressure among the unknowns, by LU factors of all of it."""

    def __init__(self, equations: Equations, y: Array) -> None:
        op, at, film, cavity_stretch = equations.operators, equations.layout, equations.film, equations.cavity_stretch(y)
        d = None if cavity_stretch is None else float(cavity_stretch[0])
        h, n, units = y[at.gap], op.mesh.size, equations.units(y)
        scaled, speed = op.stretched(d, of_gradient=False), equations.speed if d is None else equations.speed * d
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
            g, column = gradient_in_film(film, op.integral, h, y[at.pressure], y[at.flux_gap]), at.cavity_stretch.start
            explicit = equations.by_cavity_stretch_alone(y, d, g)
            matrix[gap, column], matrix[offset:, column] = explicit[:n], explicit[n:]
            matrix[pressure, column] = -equations.fluid_by_cavity_stretch(g, d, None)
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
    """The inverse of the Jacobian with the fluid pressure among the unknowns, whose step it eliminates."""

    # The rows of the pressure give dp = V (G_h dh + G_m dm) lambda - q with the Volterra operator V and q = (I - lambda A
    # G_p)**-1 r_p; what is left is the system of Equations.jacobian.

    def __init__(self, equations: Equations, y: Array) -> None:
        self.equations = equations
        op, at, film = equations.operators, equations.layout, equations.film
        cavity_stretch = equations.cavity_stretch(y)
        d = None if cavity_stretch is None else float(cavity_stretch[0])
        self.units = equations.units(y)
        self.slopes = slopes_in_film(film, op.integral, y[at.gap], y[at.pressure], y[at.flux_gap])
        self.by_pressure = by_pressure_of(self.slopes)
        self.of_ends = equations.slopes_of_ends(y, self.slopes)
        self.speed = equations.speed if d is None else equations.speed * d
        self.scaled = op.stretched(d, of_gradient=False)
        self.volterra = Volterra(op.integral, np.asarray(self.speed * self.by_pressure))
        self.by_cavity_stretch = None
        if d is not None:
            g = gradient_in_film(film, op.integral, y[at.gap], y[at.pressure], y[at.flux_gap])
            self.by_cavity_stretch = equations.fluid_by_cavity_stretch(g, d, self.by_pressure)
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
        if self.by_cavity_stretch is not None:
            found[..., at.pressure] += self.by_cavity_stretch * step[..., n + 3 :]
        return found


def _combined(out: Array, first: Array, by_first: Array, second: Array, by_second: Array) -> None:
    """Write ``first * by_first - second * by_second``, column by column, into ``out`` in Fortran order."""
    # A few columns at a time are computed side by side in memory; in ``out``, whose columns are longer, steps cost more.
    scratch = np.empty((2, BLOCK_COLUMNS, len(out)))
    for start in range(0, len(out), BLOCK_COLUMNS):
        part = slice(start, start + BLOCK_COLUMNS)
        found, taken = (each[: len(out) - start].T for each in scratch)
        np.multiply(first[:, part], by_first[part], out=found)
        np.multiply(second[:, part], by_second[part], out=taken)
        found -= taken
        out[:, part] = found
