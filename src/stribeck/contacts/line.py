"""The line contact in SI units, and the dimensionless groups that the model makes of it.

:class:`LineContact` is what a tribologist knows; it turns into :class:`Groups` and back, and gives the Hertz scales with
which results return to SI. No equation is solved here.

Source: [Bertin & Pouliquen] Eq. (Hertz_scales).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from stribeck.contacts.contact import Contact, HertzScales, described
from stribeck.contacts.groups import Groups
from stribeck.quantities.schema import Input
from stribeck.quantities.units import InputError

__all__ = ["Groups", "HertzScales", "InputError", "LineContact"]


@described("line")
@dataclass(frozen=True, init=False, repr=False, kw_only=True)
class LineContact(Contact):
    r"""A rigid rough cylinder sliding on a lubricated elastic half-space, in SI units.

    Every quantity is text with a unit (``"10 mm"``) or a bare number in SI units; floats in SI are kept.

    Attributes
    ----------
    groups : Groups
        The dimensionless groups.
    hertz : HertzScales
        The scales with which dimensionless results return to SI.
    hersey_number : float
        :math:`\eta U/F_N` [-], with that sum :math:`U`: twice the number that is made with a mean speed.

    Raises
    ------
    InputError
        Where a value is impossible, a unit is wrong, or the modulus is given twice or not at all.

    Notes
    -----
    Where both surfaces move, films of Newtonian fluids and load shares are those of :math:`U = u_1 + u_2`, and friction is
    that of the sliding speed :math:`u_1 - u_2`, by ``slide_to_roll``.

    ``modulus`` always holds :math:`E^*` afterwards; ``youngs_modulus`` and ``poisson_ratio`` are not kept.

    Source: [Bertin & Pouliquen] Eq. (contact_pressure) for the contact law, Section "Dimensional analysis"
    for the groups. The paper calls :math:`\beta` a number of order unity; for real surfaces it is small.

    Examples
    --------
    >>> contact = LineContact(radius="10 mm", modulus="2.1 MPa", load="50 N/m", viscosity="1 mPa*s",
    ...                       speed="0.1 m/s", roughness="1 um", alpha=2.0, beta=0.05,
    ...                       boundary_friction=0.8)
    >>> round(contact.groups.load, 3)
    0.303
    """

    load: Input = Input(
        label="load",
        symbol="$F_N$",
        dimension="load",
        typical="30 N/m",
        source="as in examples/pdms_cylinder.toml",
        usual=(0.1, 1e5),
        units=("N/m", "kN/m", "N/mm"),
        letters=("F_N",),
        known=6,
    )

    WIDTH: ClassVar[str] = "Hertz half-width"
