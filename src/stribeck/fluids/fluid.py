r"""What the equations ask of a film: the pressure gradient of a column of fluid that carries a given flux, and its drag.

Steady flow keeps the mass flux m, the flux gap h*, the same at every x.  The law of flow, inverted once at each node, gives

.. math:: p_f' = \lambda \, G(h, p_f, m)

Gaps and m are in u_Hz, pressures in p_Hz, tractions in :math:`\eta_0 U/u_\mathrm{Hz}` with U the sum of the surface speeds.
A new fluid is a new law of viscosity, density or rate (:mod:`stribeck.fluids.laws`), or one frozen class that has the members
of :class:`Film`, and ``decay(speed)`` if its pressure does not fall off as an even power.
"""

from __future__ import annotations

from typing import NamedTuple, Protocol, Self

import numpy as np

from stribeck._types import Array, Numbers

MAX_CACHED_SHAPES = 16  # Shapes of node arrays for which a film caches its last gradient and slopes.

Key = tuple[object, ...]  # Exact arguments of a film's last evaluation.


def key_of(*asked: Array | Numbers | None) -> Key:
    """Return a key of the exact arguments of a film; arguments that mostly differ go first."""
    return tuple((each.shape, each.tobytes()) if isinstance(each, np.ndarray) else each for each in asked)


class Slopes(NamedTuple):
    """The derivatives of a nodal quantity by gap, pressure, flux gap and ln U; None stands for zero everywhere.

    ``by_speed`` holds gap, pressure and flux gap: it is what relaxation times and yield stresses do, as their ratio to the
    time and the stress of the film changes with U.  The factor lambda before G is not in it.
    """

    by_gap: Array
    by_pressure: Array | None
    by_flux: Array
    by_speed: Array | None = None


class Decay(NamedTuple):
    """How the pressure of a film falls off far away, for meshes."""

    plateau: float = 0.0  # Distance beyond which the viscosity is constant [a]
    fractional: bool = False  # Whether it falls with a non-integer power of the distance


class Film(Protocol):
    r"""A column of fluid between the surfaces: frozen, hashable, in Hertz units, for all speeds.

    Times are in units of :math:`6 \eta_0 a/(p_\mathrm{Hz} u_\mathrm{Hz})` and shear stresses in
    :math:`p_\mathrm{Hz} u_\mathrm{Hz}/(6 a)`, which do not depend on the speed: at the speed group lambda a relaxation time t
    is the Weissenberg number ``lambda t``, and a stress tau0 is ``tau0/lambda`` times that of the film.
    """

    @property
    def name(self) -> str:
        """Name that outputs print."""

    @property
    def parameters(self) -> dict[str, float | str]:
        """What distinguishes this fluid from others of its name, for outputs."""

    @property
    def uses_pressure(self) -> bool:
        """Whether the gradient depends on the pressure, which then is an unknown of its own."""

    @property
    def uses_speed(self) -> bool:
        """Whether the gradient depends on the speed beyond the factor lambda; then :meth:`at` is asked for the film at one."""

    @property
    def slide(self) -> float:
        """Sliding over the sum of the speeds, ``s = (u1 - u2)/(u1 + u2)``, half the slide-to-roll ratio."""

    def at(self, speed: Numbers) -> Self:
        """Return the film at a speed group, or a column of them: what all below are asked of."""

    def milder(self, part: float) -> Self:
        """Return the film with a part of what its laws do, 0 to 1, nearly Newtonian at 0: a way to a state."""

    def gradient(self, gap: Array, pressure: Array | None, flux_gap: Numbers) -> Array:
        """Return G, the pressure gradient over lambda [u_Hz**-2]."""

    def slopes(self, gap: Array, pressure: Array | None, flux_gap: Numbers) -> Slopes:
        """Return the derivatives of G."""

    def tractions(self, gap: Array, pressure: Array | None, flux_gap: Numbers) -> tuple[Array, Array]:
        """Return the drag of the fluid on the substrate and on the cylinder, against their sliding.

        Newtonian: ``s/h + 3 h G`` and ``s/h - 3 h G``.  Over x they differ by the pull of the pressure on the curved surface.
        """

    def traction_slopes(self, gap: Array, pressure: Array | None, flux_gap: Numbers) -> tuple[Slopes, Slopes]:
        """Return the derivatives of both tractions, those through G included."""

    def cavity_traction(self, gap: Array, pressure: Array | None, flux_gap: Numbers) -> Array:
        """Return the drag on either wall where the film is cavitated.

        The liquid fills the part ``m/h`` of the width (over the density ratio), from wall to wall, and is sheared at the rate
        ``s/h`` without a pressure gradient.
        """

    def cavity_traction_slopes(self, gap: Array, pressure: Array | None, flux_gap: Numbers) -> Slopes:
        """Return the derivatives of :meth:`cavity_traction`."""

    def notes(self, gap: Array, pressure: Array | None, flux_gap: Numbers) -> tuple[str, ...]:
        """Return sentences on where this state leaves the range of the fluid's laws; mostly none."""
