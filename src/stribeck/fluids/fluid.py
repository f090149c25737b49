r"""What the equations ask of a film: the pressure gradient of a column of fluid that carries a given flux.

Steady flow keeps the mass flux m, the flux gap h*, the same at every x.  The law of flow, inverted once at each node, gives

.. math:: p_f' = \lambda \, G(h, p_f, m)

A new fluid is a new file with one frozen class that has the members of :class:`Film`.
"""

from __future__ import annotations

from typing import NamedTuple, Protocol

from stribeck._types import Array, Numbers


class Slopes(NamedTuple):
    """The derivatives of a nodal quantity with respect to gap, pressure and flux gap."""

    by_gap: Array
    by_pressure: Array | None
    by_flux: Array


class Film(Protocol):
    """A column of fluid between the surfaces: frozen, hashable, in Hertz units."""

    @property
    def name(self) -> str:
        """Name that outputs print."""

    @property
    def parameters(self) -> dict[str, float | str]:
        """What distinguishes this fluid from others of its name, for outputs."""

    @property
    def uses_pressure(self) -> bool:
        """Whether the gradient depends on the pressure, which then is an unknown of its own."""

    def gradient(self, gap: Array, pressure: Array | None, flux_gap: Numbers) -> Array:
        """Return G, the pressure gradient over lambda [u_Hz**-2]."""

    def slopes(self, gap: Array, pressure: Array | None, flux_gap: Numbers) -> Slopes:
        """Return the derivatives of G."""
