r"""The operators of the equations on a mesh: the undeformed gap, the integral of the pressure gradient, deflection and load.

A film that ends is described from its exit: ``x = x_c + d xi``, with xi the coordinate of the mesh.  Without a second end
the cavity stretch d is one.  A film re-forms at the edge :attr:`Mesh.reformation` of the mesh, so that d is the length of the
cavity in units of that edge.  All operators are those in xi; the deflection of the half-plane changes with d by

.. math:: w(x) = d \, (D p)(\xi) - \frac{d \ln d}{\pi} \int p \, d\xi

For a solid with lengths of its own, such as a layer, D itself changes with d.
"""

import math
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np

from stribeck._types import Array
from stribeck.contacts.groups import BASE_MODEL, Model
from stribeck.fluids.fluid import Cavitation
from stribeck.fluids.newtonian import Newtonian
from stribeck.numerics.dual import value_of
from stribeck.numerics.panels import HalfTail, Mesh, reference
from stribeck.numerics.running_integral import RunningIntegral
from stribeck.numerics.settings import HALF_DIGITS
from stribeck.numerics.trace import Matrix, Trace, act, pointwise
from stribeck.quantities.lazy import cached_property
from stribeck.solids.half_plane import HalfPlane, deflection_by_half_tail
from stribeck.solids.solid import Solid

LOAD = 0.5 * np.pi  # Load in Hertz units: the integral of the pressure


@dataclass(frozen=True, eq=False)
class Operators:
    """Operators of a mesh; computed once and kept for all states that share it."""

    mesh: Mesh
    model: Model = BASE_MODEL

    @property
    def has_exit(self) -> bool:
        """Whether the film ends at a free exit, from which x is measured."""
        return self.model.cavitation is not Cavitation.NONE

    @property
    def has_reformation(self) -> bool:
        """Whether it re-forms behind the cavity."""
        return self.model.cavitation is Cavitation.REFORM

    @cached_property
    def is_base_model(self) -> bool:
        """Whether film and friction are those of the article, whose integrals have a closed form in the gap."""
        film = self.model.film
        return not self.has_exit and isinstance(film, Newtonian) and film.is_plain and film.slide == 1.0

    @cached_property
    def integral(self) -> RunningIntegral:
        """A: nodal pressure gradients -> pressure."""
        return RunningIntegral(self.mesh, self.reformation)

    @property
    def reformation(self) -> float:
        """Where the integral from plus infinity ends."""
        return self.mesh.reformation if self.has_reformation else math.inf if self.has_exit else 0.0

    @cached_property
    def in_cavity(self) -> Array:
        """One at the nodes of the cavity, zero at others."""
        return np.where(self.integral.outside_gap, 0.0, 1.0)

    @cached_property
    def tail(self) -> HalfTail | None:
        """Half of the panel through infinity, if the film does not reach infinity on the other side."""
        return HalfTail(self.mesh) if self.integral.one_sided else None

    @cached_property
    def deflection_by_tail(self) -> Array | None:
        """Densities on that half -> deflection; None if the solid is not deflected from so far away."""
        known = self.tail is not None and isinstance(self.model.solid, HalfPlane)
        return deflection_by_half_tail(self.tail) if known and self.tail is not None else None

    @property
    def pressed(self) -> Mesh:
        """Where pressures are known."""
        return self.mesh

    @cached_property
    def weights(self) -> Array:
        """Weights of the integral of a pressure over the whole line."""
        mesh = self.pressed
        if self.tail is None:
            return mesh.weights
        found, own = mesh.weights.copy(), slice(-mesh.order, None)
        found[own] = (self.tail.weights @ self.tail.interpolation(mesh.order)) * mesh.stretch[own]
        return found

    @cached_property
    def deflection(self) -> Array:
        """D: nodal pressures -> deflection."""
        found = self.model.solid.deflection(self.mesh)
        if self.tail is not None and self.deflection_by_tail is not None:
            order = self.mesh.order
            of_density = self.deflection_by_tail @ self.tail.interpolation(order)
            found[:, -order:] = of_density * self.mesh.stretch[-order:]
        return found

    @cached_property
    def parabola(self) -> Array:
        """The undeformed gap xi**2/2 at the nodes."""
        return 0.5 * self.mesh.nodes**2

    @cached_property
    def at_exit(self) -> Array:
        """Row: nodal values -> the value at zero, from the left."""
        mesh, middle = self.integral.mesh, self.integral.middle
        row = np.zeros(mesh.size)
        row[(middle - 1) * mesh.order : middle * mesh.order] = reference(mesh.order).left_end[::-1]
        return row

    @cached_property
    def deflecting(self) -> Matrix:
        """D as an operator, which keeps its product with A."""
        return Matrix(self.deflection)

    @cached_property
    def load(self) -> Matrix:
        """Nodal pressures -> load."""
        return Matrix(self.weights[None])

    @cached_property
    def panel_load(self) -> Matrix:
        """Nodal pressures of asperities -> load."""
        return Matrix(self.mesh.weights[None])

    @cached_property
    def net(self) -> Matrix:
        """Nodal gradients -> their whole integral."""
        return Matrix(self.integral.weights[None])

    @cached_property
    def net_beyond(self) -> Matrix:
        """Nodal gradients -> their integral beyond the cavity."""
        return Matrix(self.integral.weights_beyond[None])

    @cached_property
    def exit_value(self) -> Matrix:
        """Nodal values -> the value at the exit, from the left."""
        return Matrix(self.at_exit[None])

    def deflected(self, pressure: Any, d: Any) -> Any:
        """Return the deflection under rows of nodal pressure, or under a traced one, at a cavity stretch."""
        if d is None:
            return self.by_kernel(pressure, None)
        d_log_d = pointwise(lambda d: (d * np.log(d) / math.pi, (np.log(d) + 1) / math.pi), d)
        return d * self.by_kernel(pressure, d) - d_log_d * act(self.load, pressure)

    def by_kernel(self, pressure: Any, d: Any) -> Any:
        """Return D p for each row of pressure and its cavity stretch d; nan where d is not positive."""
        if d is None or isinstance(self.model.solid, HalfPlane):
            return act(self.deflecting, pressure)
        if isinstance(pressure, Trace):
            here = float(value_of(d)[0])
            kernel = self.kernel(here)
            # Newton's iteration and small changes need a slope, no more exact than half of the digits.
            slope = (self.kernel(here * (1 + HALF_DIGITS)) - kernel) @ pressure.value / (here * HALF_DIGITS)
            fixed = act(Matrix(kernel), pressure)
            return pointwise(lambda value, _: (value, None, slope), fixed, d)
        stretches = np.broadcast_to(d, (*pressure.shape[:-1], 1))[..., 0]
        found = np.full((*pressure.shape[:-1], self.mesh.size), np.nan)
        for row in np.argwhere((stretches > 0) & (stretches < np.inf)):
            found[*row] = self.kernel(float(stretches[*row])) @ pressure[*row]
        return found

    def kernel(self, d: float) -> Array:
        """Return D at a cavity stretch: the deflection in x over d, without its logarithm."""
        return self.deflection if isinstance(self.model.solid, HalfPlane) else _kernel(self.mesh, self.model.solid, d)


@lru_cache(maxsize=2)  # of a Jacobian and what it is the slope of; they fill more memory than the rest of a mesh
def _kernel(mesh: Mesh, solid: Solid, d: float) -> Array:
    stretched = replace(mesh, edges=d * mesh.edges, reformation=d * mesh.reformation)
    return np.asarray(solid.deflection(stretched) / d + math.log(d) / math.pi * mesh.weights)
