r"""What the equations ask of a film: the pressure gradient of a column of fluid that carries a given flux, and its drag.

Steady flow keeps the mass flux m, the flux gap h*, the same at every x.  The law of flow, inverted once at each node, gives

.. math:: p_f' = \lambda \, G(h, p_f, m)

Gaps and m are in u_Hz, pressures in p_Hz, tractions in :math:`\eta_0 U/u_\mathrm{Hz}` with U the sum of the surface speeds.
A new fluid is a new law of viscosity, density or rate (:mod:`stribeck.fluids.laws`), or one frozen class that has the members
of :class:`Film`, and ``decay(speed)`` if its pressure does not fall off as an even power.  Its functions take values or
traces of them (:mod:`stribeck.numerics.trace`), so that their derivatives follow.
"""

from enum import StrEnum
from typing import Any, NamedTuple, Protocol, Self

from stribeck._types import Array, Numbers

MAX_CACHED_SHAPES = 16  # Numbers of nodes for which a film caches what it was last.


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

    def at(self, speed: Any) -> Self:
        """Return the film at a speed group, or a column of them: what all below are asked of."""

    def moving(self, share: float) -> Self:
        """Return the film between walls at a share of their speeds, of either sign; that of the whole is the film itself."""

    def held(self, gap: Any, pressure: Any) -> Any:
        """Return the mass across the film: what it gains in time, the flux loses."""

    def gradient(self, gap: Any, pressure: Any, flux_gap: Any) -> Any:
        """Return G, the pressure gradient over lambda [u_Hz**-2]."""

    def tractions(self, gap: Any, pressure: Any, flux_gap: Any) -> tuple[Any, Any]:
        """Return the drag of the fluid on the substrate and on the cylinder, against their sliding.

        Newtonian: ``s/h + 3 h G`` and ``s/h - 3 h G``.  Over x they differ by the pull of the pressure on the curved surface.
        """

    def cavity_traction(self, gap: Any, pressure: Any, flux_gap: Any) -> Any:
        """Return the drag on either wall where the film is cavitated.

        The liquid fills the part ``m/h`` of the width (over the density ratio), from wall to wall, and is sheared at the rate
        ``s/h`` without a pressure gradient.
        """

    def notes(self, gap: Array, pressure: Array | None, flux_gap: Numbers) -> tuple[str, ...]:
        """Return sentences on where this state leaves the range of the fluid's laws; mostly none."""


class Cavitation(StrEnum):
    """How the film ends behind the contact."""

    NONE = "none"
    """The gap is full of liquid on both sides, whatever the suction."""

    EXIT = "exit"
    """The film ruptures at ambient pressure, at the exit, where pressure and pressure gradient are zero."""

    REFORM = "reform"
    """The film ruptures at the pressure of the cavity and re-forms where it must."""
