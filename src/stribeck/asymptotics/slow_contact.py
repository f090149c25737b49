r"""Integrals from any position to the edge of a slow rough contact, for the expansion in the speed.

All of it depends on the load alone: :math:`H_0 = A + g`, :math:`A = -\tfrac12 \ln F`, :math:`g = -\tfrac12 \ln(1 - x^2)`.
The integrals are taken in :math:`v`, :math:`x = \tanh(\delta \sinh v)` with :math:`\delta = \arccos F^{1/2}`: there the zeros
of :math:`H_0` lie at :math:`v = \pm i \pi/2` whatever the load, so that one set of panels serves them all.

Source: [BP] Appendix D; the quadrature is ours.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from stribeck._types import Array
from stribeck.asymptotics.formula import Value
from stribeck.numerics.panels import reference

NODES_PER_PANEL = 16  # Gauss points of a panel: phi errs by 1e-13 for loads up to 1 - 1e-6.
PANELS = 14  # Panels of the integrals.

DOMAIN_LENGTH = 19.0  # Length of the integrals in artanh(x): 1e-16 of the whole is left out.

LOADS_PER_BLOCK = 256  # Loads that are integrated in one block, to bound the memory.


@dataclass(frozen=True)
class Outward:
    """The contact from positions x >= 0 to its edge, on Gauss nodes in two axes behind those of load and position.

    ``A`` is -1/2 ln F, ``g`` the gap over it, ``g_star`` the flux gap over it, ``weights`` those of dx.
    """

    A: Array
    x: Array
    p_0: Array
    g: Array
    weights: Array
    g_star: Array

    @property
    def H(self) -> Array:
        """The gap H_0 at rest."""
        return self.A + self.g

    def integral(self, integrand: Array) -> Array:
        """Return the integral over x to the edge."""
        return np.asarray((self.weights * integrand).sum((-1, -2)))

    def first(self, power: int = 3) -> Array:
        """Return (H_0 - H_0*)/H_0**power, the slope of P_f1."""
        return np.asarray((self.g - self.g_star) / self.H**power)

    def second(self) -> Array:
        """Return (3 H_0* - 2 H_0) H_1/H_0**4, the slope of P_f2."""
        rule = reference(NODES_PER_PANEL)
        slope = self.first() * self.weights / rule.weights
        panels = slope @ rule.weights
        from_here = panels[..., ::-1].cumsum(-1)[..., ::-1]
        P_1 = slope @ rule.integral.T - from_here[..., None]
        return np.asarray((self.A + 3 * self.g_star - 2 * self.g) * P_1 / (self.p_0 * self.H**4))


def outward(A: Value, x: Value | None = None) -> Outward:
    """Return the contact from |x| < 1, or from its centre, to its edge at -1/2 ln F = A."""
    whole = _panels(np.asarray(A, dtype=float)[..., None, None], np.zeros((1, 1)))
    H_cubed = whole.H**3
    g_star = whole.integral(whole.g / H_cubed) / whole.integral(1 / H_cubed)
    if x is None:
        return replace(whole, g_star=g_star[..., None, None])
    start = np.arctanh(np.abs(np.asarray(x, dtype=float)))[..., None, None]
    return replace(_panels(whole.A, start), g_star=g_star[..., None, None])


def _panels(A: Array, start: Array) -> Outward:
    rule = reference(NODES_PER_PANEL)
    delta = np.arcsin(np.sqrt(-np.expm1(-2 * A)))
    v, end = np.arcsinh(start / delta), np.arcsinh((start + DOMAIN_LENGTH) / delta)
    half = (end - v) / (2 * PANELS)
    v = v + half * (2 * np.arange(PANELS)[:, None] + 1 + rule.nodes)
    u = delta * np.sinh(v)
    p_0 = 1 / np.cosh(u)
    # ln cosh u, exact also where u is small.
    g = np.log1p(2 * np.sinh(u / 2) ** 2)
    return Outward(A, np.tanh(u), p_0, g, rule.weights * half * delta * np.cosh(v) * p_0**2, np.zeros(()))


def half_logarithm(load: Value) -> Array:
    """Return -1/2 ln F, nan where there is no positive gap."""
    A = -0.5 * np.log(load)
    return np.where(A > 0, A, np.nan)


def of_load(load: Value, function: Callable[[Outward], Array]) -> Value:
    """Return a number for each load from its contact; equal loads are computed once."""
    A = half_logarithm(load)
    different, where = np.unique(A, return_inverse=True)
    parts = [different[i : i + LOADS_PER_BLOCK] for i in range(0, different.size, LOADS_PER_BLOCK)]
    found = np.concatenate([function(outward(part)) for part in parts] or [different])
    values: Value = found[where.reshape(A.shape)][()]
    return values
