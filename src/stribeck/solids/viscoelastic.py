r"""Viscoelastic bodies in steady sliding: the deflection remembers the pressure that has passed.

A point of the surface that moves with the speed :math:`u_1` in x sees :math:`d/dt = u_1 \, d/dx`.  With the creep compliance
over the relaxed one, :math:`J(t) = j_0 + \sum_i j_i (1 - e^{-t/\tau_i})`, :math:`j_0 + \sum_i j_i = 1`,

.. math::

    w = D \Big[ j_0 + \sum_i j_i E_i \Big] p, \qquad E_i = \Big(1 + \mathrm{De}_i \frac{d}{dx}\Big)^{-1}, \quad
    \mathrm{De}_i = \frac{u_1 \tau_i}{a}

with D the deflection of the elastic body that has the relaxed modulus.  E is solved panel by panel from upstream, as the
Volterra equation :math:`\mathrm{De} \, q' + q = p`, exact for polynomials on the panels.  The deflection lags
behind, and the pressure of a dry contact resists the motion by the hysteresis friction

.. math:: \mu_\mathrm{h} = \frac aR \, \frac2\pi \int p \, w' \, dx

Source: [Hunter 1961] for rolling on the standard linear solid; tested against Parseval's form of the same integral.
"""

import math
from typing import ClassVar

import numpy as np
from numpy.polynomial.legendre import leggauss

from stribeck._types import Array
from stribeck.numerics.panels import Mesh, reference
from stribeck.quantities.schema import Input, Series, law
from stribeck.quantities.units import InputError, checked_kind, show
from stribeck.solids.half_plane import HalfPlane, as_solid
from stribeck.solids.solid import Lengths, Solid, lengths_of

MAX_TERMS = 40  # Terms of a Prony series that are accepted.

MEMORY_DECAY = 37.0  # Retardation times after which what is left of a pressure is rounding.

AGES, SHARES = (0.5 * each for each in leggauss(24))
AGES = AGES + 0.5
"""Rule on [0, 1] for an exponential that falls to rounding, times what is smooth."""


class _Viscoelastic(Solid):
    """What bodies with a creep compliance have in common."""

    uses_speed: ClassVar[bool] = True
    base: Solid

    def _creep(self) -> tuple[float, tuple[tuple[float, float], ...]]:
        """Return j_0 and pairs of j and time."""
        raise NotImplementedError

    @property
    def lengths(self) -> Lengths:
        """Its Deborah numbers and the lengths of its base, for meshes."""
        return lengths_of(self.base).joined(Lengths(memories=tuple(time for _, time in self._creep()[1])))

    def deflection(self, mesh: Mesh) -> Array:
        """Return the matrix from nodal pressures to the deflection at the nodes [u_Hz per p_Hz].

        Panels must reach to 30 of the largest Deborah number on both sides, and resolve the pressure.
        """
        instant, terms = self._creep()
        pressure = np.eye(mesh.size)
        remembered = instant * pressure + sum(part * Memory(mesh, np.array([time]))(pressure) for part, time in terms)
        return np.asfortranarray(self.base.deflection(mesh) @ remembered.T)

    def far_gap(self, x: Array) -> Array:
        """Return that of the relaxed body."""
        return self.base.far_gap(x)


@law
class StandardLinearSolid(_Viscoelastic):
    r"""The body with one retardation time: a spring in series with a spring and a damper side by side.

    .. math:: J(t) = \frac1r + \Big(1 - \frac1r\Big) (1 - e^{-t/\tau})

    :math:`\tau` is that of creep; the relaxation time is :math:`\tau/r`.
    """

    kind: ClassVar[str] = "standard-linear-solid"
    label: ClassVar[str] = "viscoelastic, one time"

    retardation_time: Input = Input(
        label="retardation time of the body",
        symbol=r"$\tau$",
        dimension="time",
        typical="10 ms",
        source="creep of the rubber under a constant load",
    )
    modulus_ratio: Input = Input(
        label="glassy over relaxed modulus of the body",
        symbol="$r$",
        dimension="number",
        typical="3.0",
        source="storage moduli at high and low frequencies",
        lowest=1.0,
    )
    base: Solid = HalfPlane()

    def __post_init__(self) -> None:
        """Take a half-space in the place of no base."""
        object.__setattr__(self, "base", as_solid("base", self.base))

    @property
    def name(self) -> str:
        """Name that outputs print."""
        return f"standard linear solid, {self.base.name}"

    @property
    def parameters(self) -> dict[str, float | str]:
        """Time, ratio and those of the base."""
        return {"retardation_time": self.retardation_time, "modulus_ratio": self.modulus_ratio, **self.base.parameters}

    def scaled(self, length: float, speed: float = 1.0) -> Solid:
        """Return the body in Hertz units; at rest it is relaxed."""
        base = self.base.scaled(length, speed)
        return base if speed == 0 else StandardLinearSolid(self.retardation_time * speed / length, self.modulus_ratio, base)

    def _creep(self) -> tuple[float, tuple[tuple[float, float], ...]]:
        return 1 / self.modulus_ratio, ((1 - 1 / self.modulus_ratio, self.retardation_time),)


@law
class Prony(_Viscoelastic):
    r"""The body with a Prony series of its relaxation.

    .. math:: E(t) = E_\infty \Big[1 + \sum_i g_i e^{-t/\tau_i}\Big]

    Notes
    -----
    Poisson's ratio does not relax.  The series is turned into that of creep by the roots of a polynomial, to 1e-12.
    """

    kind: ClassVar[str] = "prony"
    label: ClassVar[str] = "viscoelastic, Prony series"

    relaxation_times: Series = Series(
        label="relaxation times of the body",
        symbol=r"$\tau_i$",
        dimension="time",
        typical='["1 ms", "10 ms"]',
        source="a master curve of the relaxation",
    )
    moduli: Series = Series(
        label="moduli that relax, over the relaxed one",
        symbol="$g_i$",
        dimension="number",
        typical="[1.0, 0.5]",
        source="a master curve of the relaxation",
    )
    base: Solid = HalfPlane()

    def __post_init__(self) -> None:
        """Refuse lists of other lengths, and take a half-space in the place of no base."""
        times, moduli = self.relaxation_times, self.moduli
        if not len(times) == len(moduli) <= MAX_TERMS:
            raise InputError(
                f"relaxation_times has {len(times)} and moduli {len(moduli)}; give as many of both, 1 to {MAX_TERMS}."
            )
        if len(set(times)) < len(times):
            raise InputError(f"relaxation_times = {show(list(times))} must differ from each other.")
        object.__setattr__(self, "base", as_solid("base", self.base))

    @property
    def name(self) -> str:
        """Name that outputs print."""
        return f"Prony series, {self.base.name}"

    @property
    def parameters(self) -> dict[str, float | str]:
        """Times and moduli as text, and those of the base."""
        texts = (" ".join(f"{each:g}" for each in values) for values in (self.relaxation_times, self.moduli))
        return {**dict(zip(("relaxation_times", "moduli"), texts, strict=True)), **self.base.parameters}

    def scaled(self, length: float, speed: float = 1.0) -> Solid:
        """Return the body in Hertz units; at rest it is relaxed."""
        base = self.base.scaled(length, speed)
        return base if speed == 0 else Prony([each * speed / length for each in self.relaxation_times], self.moduli, base)

    def _creep(self) -> tuple[float, tuple[tuple[float, float], ...]]:
        return creep_of_relaxation(self.relaxation_times, self.moduli)


def creep_of_relaxation(times: tuple[float, ...], moduli: tuple[float, ...]) -> tuple[float, tuple[tuple[float, float], ...]]:
    r"""Return the creep compliance over the relaxed one: :math:`j_0`, and :math:`j_i` with its time, of a Prony series.

    With :math:`m(s) = 1 + \sum g_i s\tau_i/(1 + s\tau_i)` the compliance is :math:`1/m(s)`, with poles :math:`-1/\tau` of the
    creep, one between each two of the relaxation.
    """
    tau, g = (np.array(each) for each in zip(*sorted(zip(times, moduli, strict=True)), strict=True))

    def m(s: float) -> float:
        return float(1 + (g * s * tau / (1 + s * tau)).sum())

    # Between two poles of m, and left of the last of the slow ones, m has one zero each.
    poles = np.append(-1 / tau, 0.0)
    found = []
    for left, right in zip(poles[:-1], poles[1:], strict=True):
        low, high = left * (1 - 1e-15), right
        for _ in range(200):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if m(middle) < 0 else (low, middle)
        s = 0.5 * (low + high)
        slope = float((g * tau / (1 + s * tau) ** 2).sum())
        found.append((-1 / (s * slope), -1 / s))
    instant = 1 / (1 + float(g.sum()))
    return instant, tuple(found)


class Memory:
    """The nodal q with ``De q' + q = p``, zero far upstream, of rows of nodal p."""

    def __init__(self, mesh: Mesh, deborah: Array) -> None:
        n, rule = mesh.order, reference(mesh.order)
        ratio = mesh.half_widths[:-1] / deborah[:, None]
        forgotten = np.linalg.inv(np.eye(n) + ratio[..., None, None] * rule.integral)
        self.own = ratio[..., None, None] * (forgotten @ rule.integral)  # of a panel's own pressure
        self.arrived = forgotten.sum(axis=-1)  # what is left of q at the left edge of a panel
        self.passed = 1 - ratio * (self.arrived @ rule.weights)  # and at its right edge
        self.gained = ratio[..., None] * (rule.weights - rule.weights @ self.own)
        self.at_left, self.far = _beyond_panels(mesh, deborah)
        x = mesh.nodes[-n:]
        self.behind = np.where(x > 0, np.exp(-np.maximum(x - mesh.edges[-1], 0.0) / deborah[:, None]), 0.0)

    def __call__(self, pressure: Array) -> Array:
        """Return q of rows of p, shape (rows, size)."""
        p = pressure.reshape(len(pressure), -1, self.own.shape[-1])
        inner, beyond = p[:, :-1], p[:, -1]
        gained = (self.gained * inner).sum(axis=-1)
        at_edges = np.empty((p.shape[0], p.shape[1]))
        at_edges[:, 0] = (self.at_left * beyond).sum(axis=-1)
        for k in range(p.shape[1] - 1):
            at_edges[:, k + 1] = self.passed[:, k] * at_edges[:, k] + gained[:, k]
        q = np.empty_like(p)
        q[:, :-1] = _each(self.own, inner) + self.arrived * at_edges[:, :-1, None]
        q[:, -1] = _each(self.far[:, None], beyond[:, None])[:, 0] + self.behind * at_edges[:, -1:]
        return q.reshape(pressure.shape)


def _each(blocks: Array, values: Array) -> Array:
    """Return the products of the block of each panel, shape (rows, panels, n, n), with values, shape (rows, panels, n)."""
    if len(blocks) == 1:  # for all rows at once
        return np.asarray(np.matmul(values.swapaxes(0, 1), blocks[0].swapaxes(1, 2)).swapaxes(0, 1))
    return np.asarray(np.matmul(blocks, values[..., None])[..., 0])


def _beyond_panels(mesh: Mesh, deborah: Array) -> tuple[Array, Array]:
    r"""Return what the pressure beyond the panels in x leaves of q at their left edge, and at the nodes there, in rows.

    .. math:: q(x) = \int_0^{v} e^{-v} \, p(x - \mathrm{De} \, v) \, dv

    By quadrature, from infinity or, behind the panels, from their right edge.  Collocation of the differential equation on the
    panel through infinity would be singular at some De.
    """
    n, edge, de = mesh.order, float(mesh.edges[-1]), deborah[:, None]
    x = np.append(-edge, mesh.nodes[-n:])
    ages = np.where(x > 0, np.minimum((x - edge) / de, MEMORY_DECAY), MEMORY_DECAY)[..., None] * AGES
    t = 1 / (x[:, None] - de[..., None] * ages)
    basis = reference(n).interpolation((t / mesh.half_widths[-1]).ravel()).reshape(*t.shape, n)
    weights = ages[..., -1:] / AGES[-1] * SHARES * np.exp(-ages) * t**2
    q = np.matmul(weights[..., None, :], basis)[..., 0, :] * mesh.nodes[-n:] ** 2
    return q[:, 0], q[:, 1:]


def hysteresis_friction(mesh: Mesh, solid: Solid, pressure: Array) -> float:
    r"""Return the hysteresis friction over the slope a/R: :math:`\tfrac2\pi \int p \, w' dx`.

    Parameters
    ----------
    mesh : Mesh
        Panels that carry the pressure.
    solid : Solid
        The body, in Hertz units.
    pressure : ndarray, shape (mesh.size,)
        All that presses on it at the nodes [p_Hz].

    Returns
    -------
    float
        Friction coefficient over a/R [-]; zero for elastic bodies.
    """
    n = checked_kind("mesh", mesh, Mesh, "a Mesh of panels").order
    w = (solid.deflection(mesh) @ pressure)[:-n].reshape(-1, n)
    slope = w @ reference(n).derivative.T / mesh.half_widths[:-1, None]
    return float(2 / math.pi * (mesh.weights[:-n] * pressure[:-n]) @ slope.ravel())
