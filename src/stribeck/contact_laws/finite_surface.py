r"""Contact laws with the tail of a finite surface, which has fewer high asperities than the laws of infinite ones.

.. math:: \ln\Phi_\mathrm{finite}(s) = \ln\Phi(s) - c \, (u/h_\mathrm{rms})^3, \qquad u/h_\mathrm{rms} = s/\alpha > 0
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np

from stribeck._types import Array
from stribeck.contact_laws.law import AsperityLaw, WithArea, as_asperity_law, is_exponential
from stribeck.contact_laws.persson import PerssonLaw
from stribeck.quantities.docstrings import Described
from stribeck.quantities.units import InputError, show, to_si

# c, through the two mean gaps above 1.5 h_rms of examples/gfmd_mean_gap.csv, over Persson's law of the same spectrum.
TAIL_COEFFICIENT = 0.065


def has_endless_tail(law: AsperityLaw | None) -> bool:
    """Return whether a law falls as exp(-s) however far the surfaces are apart, as the exponential one and Persson's do."""
    return is_exponential(law) or isinstance(law, PerssonLaw)


@dataclass(frozen=True)
class FiniteSurface(Described, title="Parameters"):
    r"""The exponential law or Persson's, ending as that of a finite surface does.

    .. math:: \ln\Phi(s) = \ln\Phi_0(s) - 0.065 \, (s/\alpha)^3 \quad (s > 0)

    Raises
    ------
    InputError
        If alpha is not a positive number, or the base has a tail of its own.

    Notes
    -----
    The correction follows a calculation of one surface (Hurst exponent 0.8, two decades of wave numbers) by Green's function
    molecular dynamics: at mean gaps of 1.88 and 2.63 h_rms its pressure is 1.5 and 3.2 times below Persson's; the formula
    gives 1.54 and 3.26.  Another surface of finite size ends elsewhere, so that the difference of results between the two
    tails is an estimate of what is not known, and no correction.  Beyond 2.63 h_rms it is extrapolated.
    Source: docs/contact_laws.md.
    """

    alpha: Annotated[float, "coefficient alpha of the law, which turns separations into gaps over h_rms", "1"]
    base: Annotated[AsperityLaw | None, "the law whose tail is cut: Persson's, or the exponential one by default"] = None

    def __post_init__(self) -> None:
        """Refuse what cannot be."""
        if not to_si(self.alpha, "number", "alpha", "2.0") > 0:
            raise InputError(f"alpha = {show(self.alpha)} must be a positive number, that of the contact law.")
        base = as_asperity_law(self.base)
        if base is not None and not has_endless_tail(base):
            raise InputError(f"base = {base.name}: this law has a tail of its own; give Persson's law, or None.")

    @property
    def name(self) -> str:
        """Name of the law, with ``"-finite"``."""
        return f"{'exponential' if self.base is None else self.base.name}-finite"

    @property
    def parameters(self) -> dict[str, float | str]:
        """Parameters of the base law, and alpha."""
        return {"alpha": float(self.alpha)} | ({} if self.base is None else self.base.parameters)

    @property
    def lowest(self) -> float:
        """Lowest separation of the base law."""
        return -math.inf if self.base is None else self.base.lowest

    def log_pressure(self, separation: Any) -> Any:
        """Return ln(Phi) at the separation s."""
        base = -separation if self.base is None else self.base.log_pressure(separation)
        return base - TAIL_COEFFICIENT * np.maximum(separation / self.alpha, 0.0) ** 3

    def notes(self, separation: float) -> tuple[str, ...]:
        """Return what the law says of a state."""
        return () if self.base is None else self.base.notes(separation)

    def area_fraction_at(self, pressure: Array) -> Array:
        """Return the real area of contact over the apparent one."""
        if isinstance(self.base, WithArea):
            return self.base.area_fraction_at(pressure)
        return np.full_like(np.asarray(pressure, dtype=float), np.nan)
