r"""Contact laws of any shape: scaled to a load and a roughness, shifted, found by name.

A law is a small frozen object with a name and the pressure, of which derivatives follow.  Everything is in Hertz units
(gap in u_Hz, pressure in p_Hz).  A *shape* is the law without dimensions, :class:`stribeck.contact_laws.law.AsperityLaw`,
which the groups of a state carry; :class:`ScaledLaw` makes the contact law of it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from stribeck.contact_laws.exponential import ExponentialLaw, NoContact
from stribeck.contact_laws.law import AsperityLaw, ContactLaw, as_asperity_law
from stribeck.numerics.trace import Trace, mapped
from stribeck.quantities.registry import laws_of
from stribeck.quantities.schema import made_of
from stribeck.quantities.units import InputError, show

# Laws by their names; None is the exponential law.
NAMED_LAWS: dict[str, Any] = {"exponential": None, **laws_of("stribeck.contact_laws", AsperityLaw)}


@dataclass(frozen=True)
class ScaledLaw:
    r"""Contact law of any shape.

    .. math:: p_c = \bar F_N^{-e} \, \Phi(h/\kappa), \qquad \kappa = \bar h_\mathrm{rms}/\bar F_N^{2e}

    with e = 1/2 on the line and 1/3 on the ball.
    """

    shape: AsperityLaw  # Phi of the separation `s = h/kappa`, which is alpha h/h_rms
    load: Any  # Load group [-]; for stacked states a column of them
    decay_length: Any  # Relative roughness kappa, the unit of separations [u_Hz], likewise
    pressure_exponent: float = 0.5  # e
    constant_decay: bool = False

    @property
    def name(self) -> str:
        """Name of the shape."""
        return self.shape.name

    def pressure(self, gap: Any) -> Any:
        """Return the contact pressure [p_Hz]."""
        return np.exp(self.log_pressure(gap))

    def log_pressure(self, gap: Any) -> Any:
        """Return ``ln Phi(h/kappa) - e ln(F)``."""
        return mapped(self.shape.log_pressure, gap / self.decay_length) - self.pressure_exponent * np.log(self.load)


def by_group(law: ContactLaw, name: str) -> ContactLaw:
    """Return a law whose pressures are traced by the logarithm of the load or the roughness group, the other one held."""
    if isinstance(law, NoContact):
        return law
    assert isinstance(law, ExponentialLaw | ScaledLaw)
    load, kappa = np.asarray(law.load), np.asarray(law.decay_length)
    if name == "roughness":
        return replace(law, decay_length=Trace.number(name, kappa, kappa))
    by_load = -2 * law.pressure_exponent * kappa
    return replace(law, load=Trace.number(name, load, load), decay_length=Trace.number(name, kappa, by_load))


@dataclass(frozen=True)
class ShiftedLaw:
    """A shape at separations that are all larger by ``shift``: at speed zero that only shifts the gap."""

    shape: AsperityLaw
    shift: float

    @property
    def name(self) -> str:
        """Name of the shape."""
        return self.shape.name

    @property
    def parameters(self) -> dict[str, float | str]:
        """Parameters of the shape."""
        return self.shape.parameters

    @property
    def lowest(self) -> float:
        """Lowest separation of the shape, shifted."""
        return self.shape.lowest + self.shift

    def log_pressure(self, separation: Any) -> Any:
        """Return ln(Phi) at ``s - shift``."""
        return self.shape.log_pressure(separation - self.shift)

    def notes(self, separation: float) -> tuple[str, ...]:
        """Return the notes of the shape at ``s - shift``."""
        return self.shape.notes(separation - self.shift)


def law_of(law: Any) -> AsperityLaw | None:
    """Return a contact law, given itself or by its name; None is the exponential one."""
    return named_law(law) if isinstance(law, str) else as_asperity_law(law)


def named_law(name: str, **numbers: str | float) -> AsperityLaw | None:
    """Return the law of a name and of its numbers; refuse unknown names, and laws that need more than that."""
    if name not in NAMED_LAWS:
        known = ", ".join(map(repr, NAMED_LAWS))
        raise InputError(f"law = {show(name)}; names are {known}. A law of a surface or table needs a case file or an object.")
    law = made_of(NAMED_LAWS[name], f"law = {name!r}", numbers)
    return None if law is None else as_asperity_law(law)
