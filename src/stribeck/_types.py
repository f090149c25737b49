"""The array types that annotations use, and the shape of a contact law, which a state carries with its groups."""

from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Indices = NDArray[np.intp]
Flags = NDArray[np.bool_]

Numbers = float | Array
"""One number, or a column of them where states lie in rows."""


@runtime_checkable
class LawShape(Protocol):
    r"""A contact law without dimensions: a small frozen object that can be hashed.

    .. math:: p_c = \beta E^* \Phi(s), \qquad s = \alpha h/h_\mathrm{rms}
    """

    @property
    def name(self) -> str:
        """Name that outputs print."""

    @property
    def parameters(self) -> dict[str, float | str]:
        """What tells this law from others of its name, for outputs."""

    @property
    def lowest(self) -> float:
        """Separation s below which the law has no value: 0 where it diverges towards full contact, else minus infinity."""

    def log_pressure(self, separation: Array) -> Array:
        """Return ln(Phi) at the separation s, finite where Phi itself underflows."""

    def log_slope(self, separation: Array) -> Array:
        """Return d ln(Phi)/ds at the separation s, negative."""

    def notes(self, separation: float) -> tuple[str, ...]:
        """Return what to know about a state of which this is the least separation, one sentence each."""


@runtime_checkable
class WithArea(LawShape, Protocol):
    """What a law has besides that knows the spectrum of its surface."""

    def area_fraction_at(self, pressure: Array) -> Array:
        """Return the real area of contact over the apparent one at the pressure Phi."""


def is_exponential(law: LawShape | None) -> bool:
    """Tell whether a law is that of the paper, for which formulas and atlas hold."""
    return law is None or law.name == "exponential"
