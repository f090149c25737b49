r"""Graded Gauss-Legendre panels on the whole real line.

The line is closed at infinity: panels in ``x`` cover ``[-X, X]`` and one last panel in ``t = 1/x`` covers
everything beyond, from ``t = -1/X`` (``x = -X``) through infinity to ``t = 1/X`` (``x = X``).  Pressures fall as
:math:`|x|^{-3}` and gaps grow as :math:`x^2/2`, so that both are smooth in ``t`` after division by a power of it and no
truncation error is left: the tail is integrated to the same order as the contact.

Here are nodes, weights, interpolation, the running integral and the choice of panels.  Here is no physics.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import pairwise

import numpy as np
from numpy.polynomial import legendre

from stribeck._types import Array, Indices
from stribeck.numerics.settings import MAX_PANELS, SAME_PLACE, SPLIT_MARGIN, STEP_GROWTH
from stribeck.numerics.trace import Matrix
from stribeck.quantities.lazy import cached_property

NO_PLACES = np.empty(0)


class MeshTooLargeError(Exception):
    """The fields need more panels than a mesh may have."""


@dataclass(frozen=True)
class Rule:
    """A rule on ``[-1, 1]`` and what follows from it, for one number of nodes."""

    nodes: Array
    weights: Array
    to_legendre: Array
    """Nodal values -> Legendre coefficients."""
    integral: Array
    """Nodal values -> integral from -1 to each node."""
    left_half: Array
    """Nodal values -> integral from -1 to 0."""
    left_end: Array
    """Nodal values -> value at -1."""
    derivative: Array
    """Nodal values -> nodal values of the derivative."""
    barycentric: Array
    """Weights of the nodes in the barycentric formula, the largest of which is one."""

    @classmethod
    def of(cls, nodes: Array, weights: Array) -> Rule:
        """Return the rule with these nodes and weights."""
        to_legendre = np.asarray(np.linalg.inv(legendre.legvander(nodes, nodes.size - 1)), dtype=np.float64)
        antiderivatives = legendre.legint(np.eye(nodes.size), lbnd=-1)
        barycentric = 1.0 / np.prod(np.subtract.outer(nodes, nodes) + np.eye(nodes.size), axis=1)
        return cls(
            nodes=nodes,
            weights=weights,
            to_legendre=to_legendre,
            integral=legendre.legval(nodes, antiderivatives).T @ to_legendre,
            left_half=legendre.legval(0.0, antiderivatives) @ to_legendre,
            left_end=legendre.legval(-1.0, np.eye(nodes.size)) @ to_legendre,
            derivative=legendre.legval(nodes, legendre.legder(np.eye(nodes.size))).T @ to_legendre,
            barycentric=barycentric / np.abs(barycentric).max(),
        )

    def interpolation(self, points: Array) -> Array:
        """Return the matrix from nodal values to those at ``points`` of the interpolating polynomial, shape (..., nodes)."""
        away = np.subtract.outer(points, self.nodes)
        away[away == 0.0] = np.finfo(float).tiny  # at a node all others have no weight
        found = self.barycentric / away
        found /= found.sum(axis=-1, keepdims=True)
        return found


@lru_cache(maxsize=32)
def reference(order: int) -> Rule:
    """Return the Gauss-Legendre rule with ``order`` nodes."""
    return Rule.of(*legendre.leggauss(order))


@lru_cache(maxsize=32)
def highest_degree(order: int) -> Array:
    """Return the Legendre polynomial of the highest degree that the nodes of a panel hold, at these."""
    return np.asarray(legendre.legval(reference(order).nodes, np.eye(order)[-1]))


@lru_cache(maxsize=32)
def between_orders(order: int, other: int) -> Array:
    """Return the matrix from nodal values (as a row) of one rule to those of another with more nodes."""
    return reference(order).interpolation(reference(other).nodes).T


@lru_cache(maxsize=32)
def clustered(count: int, power: int) -> tuple[Array, Array]:
    """Return nodes and weights on [0, 1] for what holds a logarithm at zero or just beyond: they crowd there with a power."""
    nodes, weights = legendre.leggauss(count)
    root = 0.5 * (1 + nodes)
    return root**power, 0.5 * power * root ** (power - 1) * weights


@lru_cache(maxsize=32)
def towards_infinity(order: int) -> tuple[Array, Array, Array]:
    """Nodes and weights on [-1, 1] on panels that halve towards zero, and the interpolation to them."""
    edges = np.append(0.0, 2.0 ** -np.arange(order, -1, -1.0))
    half = 0.5 * np.diff(edges)
    rule = reference(order)
    t = (0.5 * (edges[1:] + edges[:-1])[:, None] + half[:, None] * rule.nodes).ravel()
    weights = np.outer(half, rule.weights).ravel()
    t = np.concatenate([-t, t])
    return t, np.concatenate([weights, weights]), rule.interpolation(t)


@dataclass(frozen=True, eq=False)
class Mesh:
    """Panels on the real line, closed at infinity."""

    edges: Array  # Edges of the panels in `x`, ascending, from `-X` to `X` [half-width of the Hertz contact]
    order: int  # Nodes on each panel, even (so that no node lies at infinity)
    scale: float = 1.0  # Length on which the fields vary in the middle; gaps are interpolated over `scale**2 + x**2`
    reformation: float = math.inf  # Edge beyond zero where a field that ends at zero re-forms; infinite where it does not
    coarse_edges: Array | None = None  # Edges before panels were halved towards places; None where they were not
    origin: float = 0.0  # Where its zero lay as it was made, among the places that are edges of panels

    @property
    def panels(self) -> int:
        """Number of panels, the one through infinity included."""
        return len(self.edges)

    @property
    def size(self) -> int:
        """Number of nodes."""
        return self.panels * self.order

    @cached_property
    def centres(self) -> Array:
        """Centres of the panels, each in its own coordinate."""
        return np.append(0.5 * (self.edges[1:] + self.edges[:-1]), 0.0)

    @property
    def middles(self) -> Array:
        """Positions in ``x`` inside each panel."""
        return np.append(self.centres[:-1], 2 * self.edges[-1])

    @cached_property
    def half_widths(self) -> Array:
        """Half-widths of the panels, each in its own coordinate."""
        return np.append(0.5 * (self.edges[1:] - self.edges[:-1]), 1.0 / self.edges[-1])

    @cached_property
    def local(self) -> Array:
        """Nodes in the coordinate of their panel (``x``, or ``1/x`` on the last), shape (panels, order)."""
        return self.centres[:, None] + self.half_widths[:, None] * reference(self.order).nodes

    @cached_property
    def nodes(self) -> Array:
        """Nodes in ``x``, shape (size,)."""
        x = self.local.copy()
        x[-1] = 1.0 / x[-1]
        return x.ravel()

    @cached_property
    def far(self) -> Array:
        """``scale**2 + x**2`` at the nodes: how gaps grow."""
        return self.scale**2 + self.nodes**2

    @cached_property
    def stretch(self) -> Array:
        """``dx/d(local coordinate)`` at the nodes: 1, or ``x**2`` on the last panel."""
        stretch = np.ones((self.panels, self.order))
        stretch[-1] = self.local[-1] ** -2
        return stretch.ravel()

    @cached_property
    def weights(self) -> Array:
        """Weights of the integral over the whole line, shape (size,)."""
        return np.outer(self.half_widths, reference(self.order).weights).ravel() * self.stretch

    @cached_property
    def beyond(self) -> tuple[Array, Array, Array]:
        """Nodes beyond the panels in ``x``, negative ones first, weights of integrals, and interpolation there."""
        t, weights, to_tail = towards_infinity(self.order)
        x = 1 / (t * self.half_widths[-1])
        return x, weights * self.half_widths[-1] * x**2, to_tail

    @cached_property
    def to_beyond(self) -> Matrix:
        """Nodal values -> their polynomial in 1/x at the nodes beyond the panels in ``x``."""
        return self._beyond_by(self.beyond[2])

    @cached_property
    def density_beyond(self) -> Matrix:
        """Nodal values -> what they are there, where their integral has that polynomial as its density in 1/x."""
        x, _, to_beyond = self.beyond
        return self._beyond_by(to_beyond * self.stretch[-self.order :] / x[:, None] ** 2)

    def _beyond_by(self, block: Array) -> Matrix:
        """Return the operator of all nodes that takes those of the last panel by a block."""
        found = np.zeros((len(block), self.size))
        found[:, -self.order :] = block
        return Matrix(found)

    @cached_property
    def inner_weights(self) -> Matrix:
        """Nodal values -> their integral over the panels in ``x``."""
        row = self.weights.copy()
        row[-self.order :] = 0.0
        return Matrix(row[None])

    @cached_property
    def arm(self) -> Matrix:
        """Nodal values -> their first moment over the panels in ``x``."""
        return Matrix(self.inner_weights.matrix * self.nodes)

    def locate(self, x: Array) -> tuple[Indices, Array]:
        """Return the panel of each point and its coordinate in ``[-1, 1]`` there."""
        panel = np.searchsorted(self.edges, x, side="right") - 1
        outside = (panel < 0) | (panel >= self.panels - 1)
        panel = np.where(outside, self.panels - 1, panel)
        with np.errstate(divide="ignore"):
            local = np.where(outside, 1.0 / np.where(outside, x, 1.0), x)
        return panel, (local - self.centres[panel]) / self.half_widths[panel]

    def interpolate(self, values: Array, x: Array) -> Array:
        """Return the panels' polynomials through nodal ``values`` (..., size) at the points ``x``, shape (..., len(x))."""
        panel, s = self.locate(np.asarray(x, dtype=float))
        basis = reference(self.order).interpolation(s)
        nodal = values.reshape(*values.shape[:-1], self.panels, self.order)
        return np.asarray(np.einsum("...pn,pn->...p", nodal[..., panel, :], basis))

    def refined(self, order: int) -> Mesh:
        """Return the same panels with ``order`` nodes each."""
        return Mesh(self.edges, order, self.scale, self.reformation, origin=self.origin)

    def to_order(self, values: Array, order: int) -> Array:
        """Return nodal values on :meth:`refined` from nodal ``values`` of this mesh."""
        nodal = values.reshape(*values.shape[:-1], self.panels, self.order)
        fine = nodal @ between_orders(self.order, order)
        return np.asarray(fine.reshape(*values.shape[:-1], self.panels * order))


@dataclass(frozen=True, eq=False)
class HalfTail:
    """The half ``-1/X < t < 0`` of the panel through infinity, as a panel of its own."""

    # A film that ends at zero has a kink at infinity, which the nodes of the whole panel do not resolve.

    mesh: Mesh

    @property
    def half_width(self) -> float:
        """Its half-width in t, minus which is its centre."""
        return 0.5 * float(self.mesh.half_widths[-1])

    @cached_property
    def nodes(self) -> Array:
        """Its nodes in t."""
        return self.half_width * (reference(self.mesh.order).nodes - 1)

    @cached_property
    def weights(self) -> Array:
        """Weights of the integral over t."""
        return self.half_width * reference(self.mesh.order).weights

    def interpolation(self, order: int) -> Array:
        """Return the matrix from values on the whole panel to the nodes of the half, for what vanishes at infinity."""
        return _to_half(self.mesh.order, order)


@lru_cache(maxsize=32)
def _to_half(half: int, order: int) -> Array:
    """Return the matrix from a panel to the nodes of its left half, ``half`` of them, for what vanishes in its middle."""
    own, nodes = reference(half).nodes / 2 - 0.5, reference(order).nodes
    left = np.append(nodes[nodes < 0], 0.0)
    found = np.zeros((len(own), order))
    for j in range(len(left) - 1):
        others = np.delete(left, j)
        found[:, j] = np.prod((own[:, None] - others) / (left[j] - others), axis=1)
    return found


def legendre_tail(values: Array, order: int) -> Array:
    """Return the largest of the last three Legendre coefficients on each panel, shape (..., panels), of nodal values."""
    nodal = values.reshape(*values.shape[:-1], -1, order)
    last = nodal @ reference(order).to_legendre[-3:].T
    return np.asarray(np.abs(last).max(axis=-1))


def interpolation_error(values: Array) -> Array:
    """Return the estimated error between the nodes of the polynomial through nodal ``values`` (..., order) of one panel."""
    # Twice the last Legendre coefficients, for truncation and aliasing, as if further ones fell as slowly as the last four, in
    # pairs.
    c = np.abs(values @ reference(values.shape[-1]).to_legendre[-4:].T)
    before, last = c[..., :2].max(axis=-1), c[..., 2:].max(axis=-1)
    rate = np.minimum(0.7, np.sqrt(last / np.maximum(before, 1e-300)))
    return np.asarray(2 * last / (1 - rate))


def base_edges(scale: float, reach: float) -> Array:
    """Return the coarsest panels: dyadic edges ``0, +-scale, +-2 scale, ...`` up to at least ``reach``."""
    doublings = max(1, int(np.ceil(np.log2(reach / scale))))
    positive = scale * 2.0 ** np.arange(doublings + 1)
    return np.concatenate([-positive[::-1], [0.0], positive])


def adapt(
    fields: Callable[[Array, Array, Array], Array],
    scale: float,
    reach: float,
    order: int,
    tolerance: float,
    start: Mesh | None = None,
    anew: bool = True,
    places: Array = NO_PLACES,
) -> Mesh:
    """Return a mesh of few panels that resolves the given fields."""
    nodes = reference(order).nodes

    def tails(edges: Array) -> Array:
        half = 0.5 * (edges[:, 1] - edges[:, 0])
        x = edges.mean(axis=1)[:, None] + half[:, None] * nodes
        found = legendre_tail(fields(x, half, np.ones_like(x)).reshape(-1, x.size), order)
        return np.asarray(found.max(axis=0) / tolerance)

    before, known = math.inf, math.inf if start is None else float(start.edges[-1])
    while reach < scale / SAME_PLACE:
        x = reach / nodes[None, :]
        tail = legendre_tail(fields(x, np.array([reach]), nodes[None, :] ** -2.0).reshape(-1, order), order).max()
        # Beyond its own panels a guess may tell no more: then one that is solved on the wider mesh does.
        if not tail > tolerance or (reach > known and tail >= before):
            break
        before = float(tail)
        reach *= 2.0
    edges = base_edges(scale, reach)
    if start is not None:
        reach = float(edges[-1])
        inside = start.edges[np.abs(start.edges) < reach]
        edges = np.unique(np.concatenate([inside, [-reach, reach], edges[np.abs(edges) > np.abs(inside).max()]]))
    near = SAME_PLACE * scale
    places = np.sort(places[(np.abs(places) > near) & (np.abs(places) < edges[-1] - near)])
    places = places[np.diff(places, prepend=-np.inf) > near]
    apart = (np.abs(edges[:, None] - places) > near).all(axis=1)
    edges = np.unique(np.append(edges[apart], places))
    open_panels = np.column_stack([edges[:-1], edges[1:]])
    done, sizes = [], []
    count = 0
    while len(open_panels):
        size = tails(open_panels)
        split = (size > 1) & (open_panels[:, 1] - open_panels[:, 0] > near)
        done.append(open_panels[~split])
        sizes.append(size[~split])
        count += int((~split).sum())
        if count + 2 * int(split.sum()) > MAX_PANELS:
            raise MeshTooLargeError
        left, right = open_panels[split].T
        middle = 0.5 * (left + right)
        open_panels = np.concatenate([np.column_stack([left, middle]), np.column_stack([middle, right])])
    panels, size = np.concatenate(done), np.concatenate(sizes)
    ascending = np.argsort(panels[:, 0])
    edges = np.append(panels[ascending, 0], panels[:, 1].max())
    # The fields are not evaluated on the evened panels: they are often polynomials on other panels, with kinks between these.
    return Mesh(_evened(edges, size[ascending], order, places) if anew else edges, order, scale)


def _evened(edges: Array, tails: Array, order: int, places: Array) -> Array:
    """Return edges of as few panels as have tails of about one, with zero and ``places`` among them."""
    # A tail goes with the power ``order - 1`` of the length.
    counts = np.fmin(1.0, np.fmax(1 / STEP_GROWTH**2, SPLIT_MARGIN * tails ** (1 / (order - 1))))
    fixed = [0, *(np.flatnonzero(np.isin(edges[1:-1], np.append(places, 0.0))) + 1), len(edges) - 1]
    found = []
    for first, last in pairwise(fixed):
        total = np.append(0.0, np.cumsum(counts[first:last]))
        found.append(np.interp(np.linspace(0.0, total[-1], math.ceil(total[-1]) + 1), total, edges[first : last + 1])[:-1])
    return np.append(np.concatenate(found), edges[-1])


def graded(mesh: Mesh, places: Sequence[float], levels: int) -> Mesh:
    """Return a mesh whose panels halve ``levels`` times towards each of ``places``, on both sides."""
    # Edges that only rounding keeps apart from a place go: nodes between the two would be the same.
    apart = [np.abs(mesh.edges - place) > SAME_PLACE * abs(place) for place in places]
    edges = np.unique(np.concatenate([mesh.edges[np.all(apart, axis=0)], places]))
    halvings = 0.5 ** np.arange(1, levels + 1)
    added = [edges]
    for place in places:
        at = int(np.searchsorted(edges, place))
        for side in (-1, 1):
            steps = (edges[at + side] - place) * halvings
            added.append(place + steps[np.abs(steps) > SAME_PLACE * abs(place)])
    return replace(mesh, edges=np.unique(np.concatenate(added)), coarse_edges=edges)
