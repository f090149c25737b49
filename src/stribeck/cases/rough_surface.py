r"""The roughness of a case file: a self-affine spectrum given by numbers with units, and the contact law that it implies.

Source: [Persson05] for the spectrum, [YP08] for the law.
"""

from __future__ import annotations

import inspect
import math
from dataclasses import dataclass
from typing import ClassVar

from stribeck.contact_laws.persson import GAMMA, MIN_GAMMA, PerssonLaw, persson_law
from stribeck.contact_laws.spectrum import SelfAffine
from stribeck.contacts.forms import Form
from stribeck.contacts.inputs import InputTable, read_inputs
from stribeck.quantities.docstrings import complete_docstring
from stribeck.quantities.lazy import cached_property
from stribeck.quantities.schema import Input

__all__ = ["RoughSurface"]


@dataclass(frozen=True, init=False)
class RoughSurface:
    r"""Self-affine roughness of both surfaces together, in SI units, as the table ``[surface]`` of a case gives it.

    Each cut-off is given once, as a wave number :math:`q` (``"1e5 1/m"``) or as a wavelength :math:`2\pi/q` (``"60 um"``).

    Attributes
    ----------
    roughness : SelfAffine
        The spectrum as four or five numbers.

    Raises
    ------
    InputError
        Where a value is impossible, a unit is wrong, a cut-off is missing or given twice, or they are not in order.

    Examples
    --------
    >>> surface = RoughSurface(h_rms="1 um", hurst=0.8, longest_wavelength="100 um", shortest_wavelength="100 nm")
    >>> round(surface.law.alpha, 2), round(surface.law.beta, 3)
    (2.09, 0.089)
    """

    h_rms: Input = Input(label="rms height", dimension="length", typical="1 um")
    hurst: Input = Input(label="Hurst exponent", dimension="number", typical="0.8", highest=1.0, reason="it is often near 0.8")
    q0: Input = Input(label="wave number q₀", dimension="wavenumber", typical="6e4 1/m")
    q1: Input = Input(label="wave number q₁", dimension="wavenumber", typical="6e7 1/m")
    roll_off: Input = Input(label="roll-off wave number", dimension="wavenumber", typical="3e5 1/m", optional=True)
    gamma: Input = Input(
        label="coefficient γ",
        dimension="number",
        typical="0.45",
        lowest=MIN_GAMMA,
        zero=True,
        highest=1.0,
        reason="0.45 fits simulations",
        optional=True,
        default=GAMMA,
    )

    INPUTS: ClassVar[InputTable]

    def __init__(self, **given: str | float | None) -> None:
        """Check the values and bring them to SI units."""
        values = read_inputs({name: value for name, value in given.items() if value is not None}, self.INPUTS).checked()
        for name in self.INPUTS.names:
            object.__setattr__(self, name, values.get(name, values["q0"] if name == "roll_off" else None))
        _ = self.roughness

    @cached_property
    def roughness(self) -> SelfAffine:
        """The spectrum as numbers."""
        return SelfAffine(self.h_rms, self.q0, self.q1, self.hurst, self.roll_off)

    @cached_property
    def law(self) -> PerssonLaw:
        """Persson's contact law of this roughness, tabulated on first use."""
        return persson_law(self.roughness, self.gamma)


def _of_wavelength(of: str, which: str, typical: str, without: str = "") -> Form:
    """Return how a wave number follows from a wavelength."""
    name, label = f"{which.replace('-', '_')}_wavelength", f"{which} wavelength"
    length = Input(name=name, label=label, dimension="length", typical=typical, without=without)
    meaning = "" if without else f"the wave number of the {which} roughness"
    return Form(of=of, inputs=(length,), value=lambda wavelength: 2 * math.pi / wavelength, meaning=meaning)


RoughSurface.INPUTS = InputTable(
    RoughSurface,
    (
        _of_wavelength("q0", "longest", "150 um"),
        _of_wavelength("q1", "shortest", "1.5 um"),
        _of_wavelength("roll_off", "roll-off", "20 um", without="no roll-off"),
    ),
)
RoughSurface.__signature__ = inspect.Signature(RoughSurface.INPUTS.parameters())  # type: ignore[attr-defined]
RoughSurface.__doc__ = complete_docstring(RoughSurface, RoughSurface.INPUTS.arguments())
