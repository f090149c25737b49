"""Friction of asperities as a shear stress times their real area of contact."""

import math
from abc import abstractmethod
from typing import Any, ClassVar

import numpy as np

from stribeck._types import Array
from stribeck.asperity_friction.law import AsperityFriction
from stribeck.contact_laws.law import WithArea, area_slope
from stribeck.quantities.docstrings import told
from stribeck.quantities.outputs import AREA
from stribeck.quantities.schema import Input, law
from stribeck.quantities.units import InputError, show

# What the methods say that return a stress.
OF_STRESS = {"sliding_speed": "float\n    Sliding speed v, zero or positive [m/s]."}, "float\n    Shear stress [Pa]."


class OverArea(AsperityFriction):
    r"""A stress over the real area of contact, whatever it depends on.

    .. math:: \mu_c = \frac{\tau(v)}{\bar p} \frac{A}{A_\mathrm{Hz}}, \qquad \bar p = \frac{F_N}{A_\mathrm{Hz}}

    with the area of the dry smooth contact, 2a per length of a cylinder and pi a^2 of a ball.
    """

    observable: ClassVar[str] = AREA

    @abstractmethod
    def stress(self, sliding_speed: float) -> float:
        """Return the shear stress [Pa] at a sliding speed [m/s]."""

    def amount(self, state: Any) -> tuple[float, float]:
        """Return the real area of contact over that of the dry smooth contact, and its absolute error."""
        return state.real_contact_area, state.real_contact_area_error

    def factor(self, contact: Any) -> float:
        """Return the stress over the mean pressure of the dry smooth contact."""
        if contact is None:
            raise InputError(
                f"asperity_friction = {show(self)} needs a contact in SI units: groups alone hold no pressure and no speed. "
                "Give a LineContact or PointContact, or boundary_friction with groups."
            )
        return self.stress(_sliding_speed(contact)) / _mean_pressure(contact)

    def factors(self, contact: Any, speeds: Array) -> Array:
        """Return the stress at other speeds over the mean pressure of the dry smooth contact."""
        sliding = abs(0.5 * contact.slide_to_roll) * np.asarray(speeds)
        return np.array([self.stress(each) for each in sliding.tolist()]) / _mean_pressure(contact)

    def coefficient_at_small_area(self, contact: Any) -> float:
        """Return the stress over the mean pressure in the real contacts."""
        if contact is None or contact.roughness == 0:
            return self.factor(contact)
        slope = area_slope(contact.law) / (contact.beta * contact.modulus)
        return float(self.stress(_sliding_speed(contact)) * slope)

    def check(self, contact: Any) -> None:
        """Refuse a contact law that does not know its real area of contact."""
        if isinstance(contact.law, WithArea) or contact.roughness == 0:
            self.stress(_sliding_speed(contact))
            return
        name = "exponential" if contact.law is None else contact.law.name
        raise InputError(
            f"asperity_friction = {self.name!r} needs the real area of contact, which law = {name!r} does not know: give the "
            "spectrum of the surface, as a table [surface] of a case or law = sb.contact_laws.persson_law(...); or give "
            "boundary_friction in its place."
        )


@law
class ShearStress(OverArea):
    r"""A shear stress of the real contacts, constant or a power of the sliding speed.

    .. math:: \tau(v) = \tau_0 \left(\frac{v}{v_0}\right)^n, \qquad F_c = \tau(v) A

    with the real area of contact A, which the contact law knows; contact laws without a spectrum of the surface are refused.
    It takes the place of ``boundary_friction``.

    Notes
    -----
    Where asperities touch on a small part of the surface A is proportional to their load, and the friction is that of
    ``boundary_friction`` = tau over the mean pressure in the real contacts.  Near full contact A saturates and the coefficient
    falls with load.  Rubber and gels at low speed have stresses of 0.1 to 1 MPa and exponents of 0 to 0.3.

    Source: F. P. Bowden and D. Tabor, The Friction and Lubrication of Solids (1950), for a stress over the real area.

    Examples
    --------
    >>> ShearStress("0.2 MPa", speed_exponent=0.5, reference_speed="1 mm/s").stress(4e-3)
    400000.0
    """

    name: ClassVar[str] = "shear-stress"
    size: ClassVar[str] = "shear_stress"
    label: ClassVar[str] = "shear stress times real area of contact"

    shear_stress: Input = Input(
        label="shear stress of the real contacts",
        symbol=r"$\tau_0$",
        dimension="pressure",
        typical="0.2 MPa",
        source="rubber on smooth hard surfaces, 0.1 to 1 MPa",
        usual=(1e3, 1e7),
        units=("kPa", "MPa"),
        letters=("tau", "tau0", "interfacial_shear_strength"),
        zero=True,
        known=0,
        typical_error=0.3,
    )
    speed_exponent: Input = Input(
        label="exponent of the sliding speed in the shear stress",
        symbol="$n$",
        dimension="number",
        typical="0.1",
        source="rubber at low speed, 0 to 0.3",
        lowest=-1.0,
        zero=True,
        highest=1.0,
        reason="it is a slow function of the speed",
        optional=True,
        default=0.0,
    )
    reference_speed: Input = Input(
        label="sliding speed at which the shear stress is given",
        symbol="$v_0$",
        dimension="speed",
        typical="1 mm/s",
        optional=True,
        default=1e-3,
        is_free=False,
    )

    @property
    def uses_speed(self) -> bool:
        """Whether the exponent is not zero."""
        return self.speed_exponent != 0

    @told(*OF_STRESS, "InputError\n    At rest with a negative exponent, where the stress would be infinite.")
    def stress(self, sliding_speed: float) -> float:
        """Return the shear stress at a sliding speed."""
        if self.speed_exponent == 0:
            return self.shear_stress
        if sliding_speed == 0 and self.speed_exponent < 0:
            raise InputError(
                f"speed_exponent = {self.speed_exponent:g} makes the shear stress infinite at rest; give a sliding speed, or "
                "an exponent of zero or more."
            )
        return float(self.shear_stress * (sliding_speed / self.reference_speed) ** self.speed_exponent)


def _sliding_speed(contact: Any) -> float:
    """Return the size of the difference of the surface speeds [m/s]."""
    return float(abs(0.5 * contact.slide_to_roll) * contact.speed)


def _mean_pressure(contact: Any) -> float:
    """Return the load over the area of the dry smooth contact [Pa]."""
    a = contact.hertz.half_width
    return float(contact.load / (2 * a if contact.scaling().dimensions == 1 else math.pi * a * a))
