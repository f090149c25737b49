r"""The plane in polar coordinates: panels in the radius times a cosine series in the angle.

Fields are even in the angle.  A field is a polynomial of one degree on each panel, continuous from panel to panel, times
:math:`\cos m\theta`, m < ``modes``.  The first panel has Gauss-Radau nodes, none of which lies at the centre; the others have
Gauss-Lobatto nodes.  Far out the polynomials are in :math:`\ln r`.  Angles are :math:`(j + 1/2) \pi/N`.

Here are nodes, weights, derivatives, transforms, interpolation and the choice of panels.  Here is no physics.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.polynomial import legendre

from stribeck._types import Array, Indices
from stribeck.numerics.panels import Rule
from stribeck.quantities.lazy import cached_property


@lru_cache(maxsize=32)
def lobatto(degree: int) -> Rule:
    """Return the Gauss-Lobatto rule with ``degree + 1`` nodes."""
    highest = np.eye(degree + 1)[degree]
    inner = legendre.legroots(legendre.legder(highest))
    nodes = np.concatenate([[-1.0], np.sort(inner.real), [1.0]])
    weights = 2.0 / (degree * (degree + 1) * legendre.legval(nodes, highest) ** 2)
    return Rule.of(nodes, weights)


@lru_cache(maxsize=32)
def radau(degree: int) -> Rule:
    """Return the Gauss-Radau rule with ``degree + 1`` nodes, of which the last is 1 and none is -1."""
    # Nodes are minus the zeros of (P_n + P_(n+1))/(1 + x), those of the rule that holds -1.
    sums = np.zeros(degree + 2)
    sums[degree] = sums[degree + 1] = 1.0
    nodes = np.sort(legendre.legroots(sums).real)
    nodes[0] = -1.0
    for _ in range(2):
        inner = nodes[1:]
        nodes[1:] = inner - legendre.legval(inner, sums) / legendre.legval(inner, legendre.legder(sums))
    weights = (1.0 - nodes) / ((degree + 1) * legendre.legval(nodes, np.eye(degree + 1)[degree])) ** 2
    return Rule.of(-nodes[::-1], weights[::-1])


@dataclass(frozen=True, eq=False)
class PolarMesh:
    """Panels in the radius times cosines of the angle."""

    edges: Array  # Radii at which panels begin and end, from 0 to the rim
    log_from: int  # Index of the first panel whose polynomials are in the logarithm of the radius, >= 1
    degree: int  # Degree of the polynomials
    modes: int  # Number of angles, and of cosines

    @property
    def panels(self) -> int:
        """Number of panels."""
        return self.edges.size - 1

    @property
    def rings(self) -> int:
        """Number of radii."""
        return self.panels * self.degree + 1

    @property
    def size(self) -> int:
        """Number of nodes."""
        return self.rings * self.modes

    @property
    def rim(self) -> float:
        """Radius of the rim."""
        return float(self.edges[-1])

    @cached_property
    def of_panel(self) -> Indices:
        """Which radii belong to each panel, shape (panels, degree + 1)."""
        return np.arange(self.panels)[:, None] * self.degree + np.arange(self.degree + 1)

    def rule(self, panel: int) -> Rule:
        """Return the rule of a panel."""
        return radau(self.degree) if panel == 0 else lobatto(self.degree)

    @cached_property
    def spans(self) -> tuple[Array, Array]:
        """Centre and half-width of each panel, in r or ln r."""
        low, high = self.edges[:-1].copy(), self.edges[1:].copy()
        far = slice(self.log_from, None)
        low[far], high[far] = np.log(low[far]), np.log(high[far])
        return 0.5 * (low + high), 0.5 * (high - low)

    @cached_property
    def local_radii(self) -> Array:
        """Radii of the nodes of each panel, shape (panels, degree + 1)."""
        centre, half = self.spans
        nodes = np.tile(lobatto(self.degree).nodes, (self.panels, 1))
        nodes[0] = radau(self.degree).nodes
        r = centre[:, None] + half[:, None] * nodes
        r[self.log_from :] = np.exp(r[self.log_from :])
        r[1:, 0], r[:, -1] = self.edges[1:-1], self.edges[1:]
        return r

    @cached_property
    def stretch(self) -> Array:
        """``dr/dt`` at the nodes of each panel, t in [-1, 1]."""
        stretch = np.tile(self.spans[1][:, None], (1, self.degree + 1))
        stretch[self.log_from :] *= self.local_radii[self.log_from :]
        return stretch

    @cached_property
    def local_weights(self) -> Array:
        """Weights of an integral over r at the nodes of each panel."""
        weights = np.tile(lobatto(self.degree).weights, (self.panels, 1))
        weights[0] = radau(self.degree).weights
        return np.asarray(weights * self.stretch)

    @cached_property
    def radii(self) -> Array:
        """Radii, ascending, shape (rings,)."""
        return np.append(self.local_radii[:, :-1].ravel(), self.rim)

    @cached_property
    def angles(self) -> Array:
        """Angles, ascending, shape (modes,)."""
        return np.asarray((np.arange(self.modes) + 0.5) * (np.pi / self.modes))

    @cached_property
    def ring_weights(self) -> Array:
        """Weights of ``int_0^rim dr``, shape (rings,)."""
        return np.asarray(self.gathered(self.local_weights[None])[0])

    @cached_property
    def area_weights(self) -> Array:
        """Weights of an integral over the disc, all angles, shape (rings,); the same at every angle."""
        return np.asarray(2.0 * np.pi / self.modes * self.ring_weights * self.radii)

    def scattered(self, field: Array) -> Array:
        """Return a field of shape (..., rings) panel by panel, shape (..., panels, degree + 1)."""
        return np.asarray(field[..., self.of_panel])

    def gathered(self, local: Array) -> Array:
        """Return the sums over panels of what they hold at shared nodes: the transpose of :meth:`scattered`."""
        n = self.degree
        found = np.empty((*local.shape[:-2], self.rings))
        found[..., :-1] = local[..., :n].reshape(*local.shape[:-2], -1)
        found[..., -1] = 0.0
        found[..., n::n] += local[..., n]
        return found

    def radial_derivative(self, field: Array) -> Array:
        """Return the derivative in r panel by panel, of a field of shape (..., rings)."""
        local = self.scattered(field)
        found = local @ lobatto(self.degree).derivative.T
        found[..., 0, :] = local[..., 0, :] @ radau(self.degree).derivative.T
        found /= self.stretch
        return found

    def radial_transpose(self, local: Array) -> Array:
        """Return the transpose of :meth:`radial_derivative`."""
        scaled = local / self.stretch
        found = scaled @ lobatto(self.degree).derivative
        found[..., 0, :] = scaled[..., 0, :] @ radau(self.degree).derivative
        return self.gathered(found)

    @cached_property
    def cosines(self) -> Array:
        """cos(m theta_j), shape (angles, modes)."""
        return np.asarray(np.cos(np.outer(self.angles, np.arange(self.modes))))

    @cached_property
    def sines(self) -> Array:
        """sin(m theta_j), shape (angles, modes)."""
        return np.asarray(np.sin(np.outer(self.angles, np.arange(self.modes))))

    @cached_property
    def to_modes(self) -> Array:
        """Values at the angles -> coefficients of the cosines, shape (modes, angles)."""
        found = self.cosines.T * (2.0 / self.modes)
        found[0] *= 0.5
        return found

    @cached_property
    def angular_derivative(self) -> Array:
        """Values at the angles -> those of the derivative, shape (angles, angles)."""
        return np.asarray((self.sines * -np.arange(self.modes)) @ self.to_modes)

    def interpolate(self, field: Array, x: Array, y: Array) -> Array:
        """Return nodal fields, shape (..., modes, rings), at points x, y of one shape within the rim."""
        r, angle = np.hypot(x, y).ravel(), np.arctan2(np.abs(y), x).ravel()
        coefficients = self.to_modes @ field
        waves = np.cos(np.outer(np.arange(self.modes), angle))
        return np.asarray((self.at_radii(coefficients, r) * waves).sum(axis=-2).reshape(*field.shape[:-2], *np.shape(x)))

    def at_radii(self, field: Array, r: Array) -> Array:
        """Return fields of shape (..., rings) at radii, shape (..., n)."""
        panel, matrix = self.radial_interpolation(r)
        found = np.empty((*field.shape[:-1], len(r)))
        for number in np.unique(panel):
            here = np.nonzero(panel == number)[0]
            found[..., here] = field[..., self.of_panel[number]] @ matrix[here].T
        return found

    def radial_interpolation(self, r: Array) -> tuple[Indices, Array]:
        """Return the panel of each radius, and the row from its nodal values to the value there, shape (n, degree + 1)."""
        panel = np.clip(np.searchsorted(self.edges, r, side="right") - 1, 0, self.panels - 1)
        centre, half = self.spans
        with np.errstate(divide="ignore"):
            t = (np.where(panel >= self.log_from, np.log(r), r) - centre[panel]) / half[panel]
        matrix = lobatto(self.degree).interpolation(t)
        inner = panel == 0
        matrix[inner] = radau(self.degree).interpolation(t[inner])
        return panel, matrix

    def transfer(self, other: PolarMesh, field: Array) -> Array:
        """Return nodal fields, shape (..., modes, rings), at the nodes of another mesh; beyond the rim those at the rim."""
        coefficients = self.to_modes @ self.at_radii(field, np.minimum(other.radii, self.rim))
        waves = np.cos(np.outer(other.angles, np.arange(self.modes)))
        return np.asarray(waves @ coefficients)

    def legendre(self, field: Array) -> Array:
        """Return the Legendre coefficients on each panel of a field of shape (..., rings), shape (..., panels, degree + 1)."""
        local = self.scattered(field)
        found = local @ lobatto(self.degree).to_legendre.T
        found[..., 0, :] = local[..., 0, :] @ radau(self.degree).to_legendre.T
        return np.asarray(found)
