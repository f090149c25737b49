"""The contacts by geometry in SI units: a cylinder, ``geometry = "line"``, or a ball, ``"point"``."""

from dataclasses import dataclass, replace
from typing import ClassVar

from stribeck.contacts.contact import Contact, described
from stribeck.contacts.groups import Geometry
from stribeck.contacts.inputs import InputTable
from stribeck.contacts.parts import Parts
from stribeck.quantities.formats import format_si
from stribeck.quantities.schema import Input, numbers_of
from stribeck.quantities.units import InputError


@described("line")
@dataclass(frozen=True, init=False, repr=False, eq=False, kw_only=True)
class LineContact(Contact):
    r"""A rigid rough cylinder sliding on a lubricated elastic half-space, in SI units.

    Every quantity is text with a unit (``"10 mm"``) or a bare number in SI units; floats in SI are kept.

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

    WIDTH: ClassVar[str] = "Hertz half-width"


@described("point")
@dataclass(frozen=True, init=False, repr=False, eq=False, kw_only=True)
class PointContact(Contact):
    r"""A rough ball on a lubricated elastic half-space, in SI units: what a ball-on-disc tribometer has.

    Every quantity is text with a unit (``"9.5 mm"``) or a bare number in SI units; floats in SI are kept.

    Raises
    ------
    InputError
        Where a value is impossible, a unit is wrong, the modulus is given twice or not at all, ``speed`` is given with a
        slide-to-roll ratio other than 2, or the wetted radius lies inside the contact.

    Notes
    -----
    Films and load shares are those of :math:`U`, whatever the slide-to-roll ratio; friction takes the sliding speed
    :math:`u_1 - u_2 = S U/2`, for the shear of the fluid.  ``modulus``, ``radius`` and ``speed`` always hold :math:`E^*`,
    :math:`R` and :math:`U` afterwards, and :meth:`replace` takes them as such.

    Friction depends on where the liquid ends, by a logarithm: see ``wetted_radius`` and theory.md, section 11.

    Source: theory.md, section 11.

    Examples
    --------
    >>> ball = PointContact(radius="9.5 mm", modulus="1.6 MPa", load="1.3 N", viscosity="10 mPa*s",
    ...                     entrainment_speed="50 mm/s", slide_to_roll=0.5, roughness="0.4 um", alpha=2.0, beta=0.05,
    ...                     boundary_friction=0.9)
    >>> round(ball.slope, 3), round(ball.groups.load, 1)
    (0.189, 13.9)
    """

    load: Input = replace(
        numbers_of(Contact)["load"],
        dimension="force",
        typical="1.3 N",
        source="as in examples/pdms_ball.toml",
        usual=(1e-6, 1e3),
        units=("mN", "N"),
    )
    slide_to_roll: Input = replace(numbers_of(Parts)["slide_to_roll"], typical="2.0", lowest=0.0, highest=2.0)
    wetted_radius: Input = Input(
        label="radius of the wetted disc",
        symbol="$X_c$",
        dimension="length",
        typical="3 mm",
        source="where the liquid around the contact ends; without it the whole ball is immersed",
        usual=(1e-4, 1.0),
        units=("mm", "cm"),
        optional=True,
        without="a whole ball is immersed",
    )

    WIDTH: ClassVar[str] = "Hertz radius"

    @property
    def sliding_speed(self) -> float:
        """Difference of the surface speeds, :math:`u_1 - u_2` [m/s]."""
        return float(0.5 * self.slide_to_roll * self.speed)

    def _check_scales(self) -> None:
        """Refuse what leaves double precision, and a wetted radius inside the contact."""
        super()._check_scales()
        a = self.hertz.half_width
        if self.wetted_radius is not None and self.wetted_radius <= a:
            wetted, radius = (format_si(value, "length") for value in (self.wetted_radius, a))
            raise InputError(
                f"wetted_radius = {wetted} lies inside the contact, whose Hertz radius is {radius}; give the radius at "
                "which the liquid around the contact ends, or leave it out if the ball is immersed."
            )


# The contact of each geometry, by name.
CONTACTS: dict[Geometry, type[Contact]] = {"line": LineContact, "point": PointContact}

# The inputs by geometry.
INPUT_TABLES: dict[str, InputTable] = {name: contact.INPUTS for name, contact in CONTACTS.items()}

LINE, POINT = LineContact.INPUTS, PointContact.INPUTS

# Symbols of the article and of the field, and the inputs that they stand for.
LETTERS = {letter: name for table in (POINT, LINE) for name, row in table.quantities.items() for letter in row.letters}
