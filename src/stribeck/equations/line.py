r"""The coupled mean-field equations on a mesh: residual, Jacobian and derivatives with respect to the groups.

The unknowns are the gap at the nodes, the offset and the flux gap, ``y = (h_1 ... h_N, z0, h*)``; pressures follow from
them.  With D the deflection operator, A the running integral and w the quadrature weights:

.. math::

    R_i &= h_i - z_0 - x_i^2/2 - \sum_j D_{ij} (p_c + p_f)_j, \qquad p_f = \lambda A G, \quad G = (h - h^*)/h^3 \\
    R_{N+1} &= \textstyle\sum_j w_j (p_c + p_f)_j - \pi/2 \\
    R_{N+2} &= \textstyle\sum_j w_j G_j \; s^2

s is a fixed length that makes the last row of order one.  If the gradient G depends on the pressure, the nodal fluid pressure
is an unknown too, with the rows ``p_f - lambda A G``.

With a free exit the film ends at x_c, and x is measured from there: D, A and w do not depend on x_c, which enters by the
undeformed gap alone, of a cylinder ``(x + x_c)**2/2``.  The integrals of G end at the exit, and one more row asks that G
vanish there; where the fluid thins, G at low rates, which vanishes with it: G itself may be a small power of the gap, which
no polynomial follows.
A film that ends at the pressure p_cav of the cavity and re-forms behind it has one more unknown still, the length of the
cavity, which stretches the frame (:mod:`stribeck.equations.operators`); the two integrals of G are then ``p_cav/lambda`` and
minus that.

Source: [BP] Appendix A; theory.md Eqs. (1)-(5).
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from stribeck._types import Array, Numbers
from stribeck.contact_laws.law import ContactLaw
from stribeck.contact_laws.scaled import by_group
from stribeck.equations.damping import longest_step
from stribeck.equations.film import NODAL, gradient_in_film
from stribeck.equations.operators import LOAD, Operators
from stribeck.fluids.fluid import Cavitation, Film
from stribeck.numerics.newton import LU, Inverse
from stribeck.numerics.panels import Mesh
from stribeck.numerics.trace import Matrix, Operator, Trace, act, mapped, matrix_of, pointwise
from stribeck.quantities.lazy import cached_property


class Fields(NamedTuple):
    """Unknowns, or the rows of the residual, by name: values or traces; None where the model has none."""

    gap: Any = None
    pressure: Any = None
    offset: Any = None
    flux_gap: Any = None
    exit: Any = None
    cavity_stretch: Any = None


class Layout(NamedTuple):
    """Where each unknown, and its row of the residual, lies in the vector that Newton's iteration moves."""

    # ``y[..., layout.offset]`` keeps the axis of a number, so that it is a column of stacked states.

    size: int
    gap: slice
    numbers: slice  # All that have one value
    offset: slice
    flux_gap: slice
    pressure: slice  # Empty where the fluid pressure is no unknown, as are the next two of films without such an end
    exit: slice
    cavity_stretch: slice


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

    def far_gap(self, u: Fields) -> Callable[[Array], Any]:
        """Return the far gap as a function of the coordinate, up to a smooth function of the inverse coordinate."""
        solid, d = self.operators.model.solid, u.cavity_stretch

        def far(xi: Array) -> Any:
            if u.exit is None:
                return solid.far_gap(xi)
            x = xi if d is None else d * xi
            # The derivative of x**2/2: of a logarithm in x, as of any other, the stretch changes no more than a constant.
            return pointwise(lambda x: (np.asarray(solid.far_gap(x)), x), x) + u.exit * x

        return far

    def far_gap_beyond(self, u: Fields, mesh: Mesh) -> Any:
        """Return, beyond the panels in x of a mesh, the gap of a film whose gap is zero at the nodes of the last panel."""
        far, (x, _, to_beyond) = self.far_gap(u), mesh.beyond
        return far(x) - act(Matrix(to_beyond), far(mesh.nodes[-mesh.order :]))

    def fluid_pressure(self, y: Array) -> Array:
        """Return the fluid pressure at the nodes [p_Hz]."""
        u = self.fields(y)
        return np.asarray(self.fluid_of_gradient(u, self.gradient(self.film, u)) if u.pressure is None else u.pressure)

    def pressures(self, y: Array) -> tuple[Array, Array]:
        """Return the contact and the fluid pressure at the nodes [p_Hz]."""
        return self.law.pressure(y[..., self.layout.gap]), self.fluid_pressure(y)

    @cached_property
    def is_sliding(self) -> bool:
        """Whether there is a speed; for stacked states, whether all have one."""
        return bool(np.all(self.speed != 0))

    def fields(self, y: Array) -> Fields:
        """Return the unknowns by name; numbers are columns of stacked states."""
        at = self.layout
        pressure, exit, stretch = (
            y[..., block] if block.start < block.stop else None for block in (at.pressure, at.exit, at.cavity_stretch)
        )
        return Fields(y[..., at.gap], pressure, y[..., at.offset], y[..., at.flux_gap], exit, stretch)

    def traced(self, y: Array, units: Array | None = None) -> Fields:
        """Return the unknowns with derivatives by themselves, measured in units."""
        found: dict[str, Trace] = {}
        measures = Fields() if units is None else self.fields(units)
        for name, value, unit in zip(Fields._fields, self.fields(y), measures, strict=True):
            if value is not None and name in NODAL:
                found[name] = Trace.field(name, value, unit)
            elif value is not None:
                found[name] = Trace.number(name, value, 1.0 if unit is None else unit)
        return Fields(**found)

    def rows(self, u: Fields, by: str | None = None) -> Fields:
        """Return the residual by name, of values or traces of the unknowns; also traced by the logarithm of one group."""
        g = self.gradient(self.film, u, by)
        if u.pressure is not None:
            fluid = self.fluid_of_gradient(u, g, by)
            return self.balances_of(u, u.pressure, g, by)._replace(pressure=u.pressure - fluid)
        at_rest = u.cavity_stretch is None and not self.is_sliding
        return self.balances_of(u, None if at_rest else self.fluid_of_gradient(u, g, by), g, by)

    def gradient(self, film: Film, u: Fields, by: str | None = None) -> Any:
        """Return G of a film at the nodes, zero in the cavity."""
        return gradient_in_film(film, self.operators.integral, u.gap, u.pressure, u.flux_gap, self.traced_speed(by))

    def traced_speed(self, by: str | None) -> Trace | None:
        """Return the speed, traced by its logarithm, where that is asked for and the film depends on it."""
        return self.speed_of(by) if by == "speed" and self.film.uses_speed else None

    def contact(self, gap: Any, by: str | None = None) -> Any:
        """Return the contact pressure at the nodes."""
        law = by_group(self.law, by) if by in ("load", "roughness") else self.law
        return mapped(law.pressure, gap)

    def speed_of(self, by: str | None) -> Any:
        """Return the speed group, traced by its logarithm where asked for."""
        return Trace.number("speed", np.atleast_1d(self.speed), self.speed) if by == "speed" else self.speed

    def integral_to_end(self, u: Fields, g: Any) -> tuple[Operator, Operator]:
        """Return the operators from the gradient to the pressure, and to its whole integral, over the film."""
        return self.operators.integral, self.operators.net

    def fluid_of_gradient(self, u: Fields, g: Any, by: str | None = None) -> Any:
        """Return the pressure of the fluid that follows from its gradient."""
        op, d = self.operators, u.cavity_stretch
        fluid = act(self.integral_to_end(u, g)[0], self.speed_of(by) * g)
        return fluid if d is None else d * fluid + op.in_cavity * op.model.cavity_pressure

    def balances_of(self, u: Fields, fluid: Any, g: Any, by: str | None = None) -> Fields:
        """Return the rows of shape, load and ends under a pressure of the fluid; ``g`` is the gradient in the film."""
        contact = self.contact(u.gap, by)
        smooth = u.exit is None or self.ending is self.film
        at_end = g if smooth else self.gradient(self.ending, u, by)
        return self.balances(u, contact if fluid is None else contact + fluid, g, at_end, by)

    def balances(self, u: Fields, pressure: Any, g: Any, at_end: Any, by: str | None = None) -> Fields:
        """Return the rows of shape, load and ends under a pressure; ``at_end`` is the gradient that vanishes at the exit."""
        op, d, scale = self.operators, u.cavity_stretch, self.flux_scale
        x = op.mesh.nodes if d is None else d * op.mesh.nodes
        shape = u.gap - u.offset - (op.parabola if d is None else 0.5 * x * x) - op.deflected(pressure, d)
        shape = shape - op.model.profile.departure(op.mesh, u.exit)
        load = act(op.load, pressure)
        flux, exit, stretch = act(self.integral_to_end(u, g)[1], g), None, None
        if u.exit is not None:
            shape = shape - u.exit * (x + 0.5 * u.exit)
            exit = scale * act(op.exit_value, at_end)
        if d is not None:
            in_cavity = op.model.cavity_pressure / self.speed_of(by)
            load, flux = d * load, d * flux - in_cavity
            stretch = scale * (d * act(op.net_beyond, g) + in_cavity)
        return Fields(shape, None, load - LOAD, scale * flux, exit, stretch)

    def residual(self, y: Array) -> Array:
        """Return the residual at ``y``, in its layout."""
        found = np.empty_like(y)
        for name, row in zip(Fields._fields, self.rows(self.fields(y)), strict=True):
            if row is not None:
                found[..., getattr(self.layout, name)] = row
        return found

    def units(self, y: Array) -> Array:
        """Return the scales of the unknowns: the gaps and the flux gap themselves, and one for all others."""
        # Films grow as a whole from one speed to the next: derivatives by relative changes of the gap hardly change, and an
        # inverse in these units serves many states.
        at = self.layout
        units = np.ones_like(y)
        units[..., at.gap] = y[..., at.gap]
        units[..., at.flux_gap] = self._flux_unit(y)
        return units

    def _flux_unit(self, y: Array) -> Array:
        """Return the scale of the flux gap, a column of stacked states."""
        at = self.layout
        # Where roughness carries fluid along, the flux gap may be zero.
        return np.asarray(np.maximum(np.abs(y[..., at.flux_gap]), y[..., at.gap].min(axis=-1, keepdims=True)))

    def inverse(self, y: Array) -> Inverse:
        """Return the inverse of the Jacobian in :meth:`units` of the unknowns, by LU factors."""
        return LU.of(self.jacobian(y, self.units(y)), overwrite=True)

    def jacobian(self, y: Array, units: Array | None = None) -> Array:
        """Return the derivative of the residual in Fortran order, its columns times ``units``."""
        return dense(self.rows(self.traced(y, units)))

    def parameter_derivative(self, y: Array, name: str) -> Array:
        """Return the derivative of the residual with respect to the logarithm of one group, in the layout of ``y``."""
        found = np.zeros_like(y)
        for block, row in zip(Fields._fields, self.rows(self.fields(y), name), strict=True):
            if isinstance(row, Trace):
                found[getattr(self.layout, block)] = row.columns[name]
        return found

    def admissible(self, y: Array, dy: Array) -> float:
        """Return the longest fraction of a Newton step that keeps the gap positive and the contact pressure within bounds."""
        # The exit may move by about a third of the width of contact or film.
        at = self.layout
        flux = dy[at.flux_gap.start] / self._flux_unit(y)[0]
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
        fluxes = dy[..., at.flux_gap] / self._flux_unit(y)
        blocks = (block for block in (at.pressure, at.exit, at.cavity_stretch) if block.start < block.stop)
        others = [np.abs(dy[..., block]).max() for block in blocks]
        return float(max(np.abs(gaps).max(), np.abs(fluxes).max(), *others))


def dense(rows: Fields) -> Array:
    """Return the derivatives of rows by the unknowns that they are rows of, a matrix in Fortran order."""
    named = {name: row for name, row in zip(Fields._fields, rows, strict=True) if row is not None}
    ends = np.cumsum([0, *(row.value.size for row in named.values())])
    blocks = {name: slice(*ends[k : k + 2]) for k, name in enumerate(named)}
    found = np.empty((ends[-1], ends[-1]), order="F")
    for name, row in named.items():
        for other, columns in blocks.items():
            block = found[blocks[name], columns]
            if other in NODAL:
                matrix_of(row, other, block)
            else:
                block[:, 0] = row.columns.get(other, 0.0)
    return found
