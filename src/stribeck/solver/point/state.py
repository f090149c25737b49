"""A solved state of the point contact: its observables, their errors, and the fields anywhere.

Lengths are in Hertz radii a, gaps in indentations u = a**2/R, pressures in p_Hz, the load being 2 pi/3.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from stribeck._types import Array
from stribeck.contacts.groups import Groups
from stribeck.fluids.cavitation import Cavitation
from stribeck.quantities.outcome import Outcome

OBSERVABLES = (
    "contact_load_share",
    "fluid_load_share",
    "central_gap",
    "minimum_gap",
    "minimum_radius",
    "minimum_angle",
    "minimum_gap_on_axis",
    "central_pressure",
    "offset",
    "J_couette",
    "J_poiseuille",
    "J_balanced",
    "J_published",
    "J_pcx",
)
"""Names of the observables.

``minimum_radius`` [a] and ``minimum_angle`` [radian, 0 downstream on the middle line, at most pi by symmetry] place
the minimum of the gap; ``minimum_gap_on_axis`` is that of the middle line.  The J are the finite parts of the friction
integrals, ``lim J(r < X) - (16/15) pi lambda ln X``; J_balanced is the force on the flat, J_published that on the ball
without the contact pressure along x, which is J_pcx.
"""

WITHOUT_TOLERANCE = ("minimum_gap", "minimum_radius", "minimum_angle", "minimum_gap_on_axis")
"""Observables that have their errors stated but do not count in :attr:`PointState.error_estimate`: rtol does not hold them."""

LOOSE_WHERE_TORN = ("J_couette", "J_balanced", "J_published", "central_pressure")
"""Those that do not either where the film breaks: the streaks of the wake are known less well than the film is."""


class PointFields(NamedTuple):
    """Fields of a state where they were asked for, each of the broadcast shape of x and y.

    Attributes
    ----------
    gap : ndarray
        Gap [u_Hz].
    contact_pressure, fluid_pressure : ndarray
        The two parts of the pressure [p_Hz].
    """

    gap: Array
    contact_pressure: Array
    fluid_pressure: Array


@dataclass(frozen=True, eq=False)
class PointState:
    """A state of the point contact.

    Attributes
    ----------
    groups : Groups
        The state that was solved.
    rtol : float
        The relative tolerance asked for.
    outcome : Outcome
        How the solve ended; where it is not ``ok`` the values are not to be used, and may be nan.
    values : mapping of str to float
        The observables by :data:`OBSERVABLES`.
    absolute_errors : mapping of str to float
        Their estimated absolute errors.
    scales : mapping of str to float
        What each error is relative to: one for the shares, else about the observable itself.
    identity_error : float
        ``J_balanced - J_published - J_pcx + 0.4 pi lambda``, zero but for what mesh and iteration leave.
    load_error : float
        By how much the pressures miss the load, relative to it.
    mesh : object
        Discretisation: ``mesh.radii`` (Nr,) [a] and ``mesh.angles`` (Nt,) [radian] of the nodes, ``mesh.size`` their number.
    nodal_gap, nodal_contact_pressure, nodal_fluid_pressure : ndarray, shape (Nt, Nr)
        Fields at the nodes.
    fields : callable
        ``fields(x, y)`` gives :class:`PointFields` anywhere: interpolated on the mesh, the rigid far field beyond it.
    newton_steps, krylov_steps : int
        Steps of Newton's iteration, and of GMRES in them.
    work : object
        What neighbours start from (operators, preconditioner); None if it was dropped.
    """

    groups: Groups
    rtol: float
    outcome: Outcome
    values: Mapping[str, float]
    absolute_errors: Mapping[str, float]
    scales: Mapping[str, float]
    identity_error: float
    load_error: float
    mesh: Any = field(repr=False)
    nodal_gap: Array = field(repr=False)
    nodal_contact_pressure: Array = field(repr=False)
    nodal_fluid_pressure: Array = field(repr=False)
    fields: Callable[[Array, Array], PointFields] = field(repr=False)
    newton_steps: int = 0
    krylov_steps: int = 0
    work: Any = field(default=None, repr=False)

    @property
    def errors(self) -> dict[str, float]:
        """Estimated errors relative to the scales: relative, but absolute for the shares."""
        return {name: error / self.scales[name] for name, error in self.absolute_errors.items()}

    @property
    def error_estimate(self) -> float:
        """Largest of these, but for those that :data:`WITHOUT_TOLERANCE` and :data:`LOOSE_WHERE_TORN` name."""
        is_full = self.groups.model.cavitation is Cavitation.NONE
        apart = WITHOUT_TOLERANCE if is_full else (*WITHOUT_TOLERANCE, *LOOSE_WHERE_TORN)
        return max((error for name, error in self.errors.items() if name not in apart), default=math.nan)

    @property
    def lowest_pressure(self) -> float:
        """The lowest film pressure at the nodes [p_Hz]."""
        return float(self.nodal_fluid_pressure.min())

    @property
    def minimum_gap_error(self) -> float:
        """Estimated relative error of the minimum film."""
        return self.errors.get("minimum_gap", math.nan)

    @property
    def effort(self) -> float:
        """What :func:`stribeck.numerics.continuation.march` steers by."""
        return float(self.newton_steps)
