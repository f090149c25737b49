"""The part common to contacts of every geometry: inputs in SI units, checked, kept and replaced.

A geometry adds its table of inputs, its groups and its Hertz scales.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields
from typing import Any, ClassVar, Self

from stribeck.contact_laws.law import AsperityLaw, check_alpha
from stribeck.contact_laws.scaled import law_of
from stribeck.contacts.groups import Groups
from stribeck.quantities.contact_values import contact_values, replace_inputs
from stribeck.quantities.conversions import convert_inputs
from stribeck.quantities.inputs import InputTable, si_text
from stribeck.quantities.keywords import answers_typos
from stribeck.quantities.results import Card, card_html
from stribeck.quantities.units import InputError

__all__ = ["Contact", "HertzScales", "input_texts"]


@dataclass(frozen=True)
class HertzScales:
    r"""Scales of the dry contact of a smooth cylinder or ball, in SI units.

    .. math::

        a = \left(\frac{4 F_N R}{\pi E^*}\right)^{1/2}, \quad p_\mathrm{Hz} = \frac{2 F_N}{\pi a} \text{ on the line}, \qquad
        a = \left(\frac{3 F_N R}{4 E^*}\right)^{1/3}, \quad p_\mathrm{Hz} = \frac{3 F_N}{2 \pi a^2} \text{ on the ball}, \qquad
        u_\mathrm{Hz} = \frac{a^2}{R}

    Parameters
    ----------
    half_width : float
        :math:`a`, half-width of the contact or its radius, the scale of lengths along it [m].
    indentation : float
        :math:`u_\mathrm{Hz}`, the scale of gaps [m].
    pressure : float
        :math:`p_\mathrm{Hz}`, the largest pressure of the dry contact and the scale of pressures [Pa].

    Notes
    -----
    Source: [Bertin & Pouliquen] Eq. (Hertz_scales) for the line; K. L. Johnson, Contact Mechanics (1985), for the ball.
    """

    half_width: float
    indentation: float
    pressure: float


@dataclass(frozen=True, init=False)
class Contact(ABC):
    """The inputs that contacts of all geometries keep, in SI units; see the contact of a geometry for what they are."""

    radius: float
    load: float
    viscosity: float
    speed: float
    roughness: float
    alpha: float
    beta: float
    boundary_friction: float
    modulus: float
    law: AsperityLaw | None

    INPUTS: ClassVar[InputTable]
    WIDTH: ClassVar[str] = "Hertz half-width"

    @answers_typos
    def __init__(self, *, law: str | AsperityLaw | None = None, **inputs: Any) -> None:
        self._keep(law, inputs)

    def _keep(self, law: str | AsperityLaw | None, inputs: Mapping[str, Any]) -> None:
        for name, value in contact_values(convert_inputs(inputs, self.INPUTS), self.INPUTS).items():
            object.__setattr__(self, name, value)
        object.__setattr__(self, "law", law_of(law))
        check_alpha(self.law, self.alpha)
        self._check_scales()

    @classmethod
    def of_kept(cls, inputs: Mapping[str, Any], law: str | AsperityLaw | None) -> Self:
        """Return the contact that keeps these inputs, in SI units.

        Parameters
        ----------
        inputs : mapping of str to float
            What :meth:`inputs` gives; others by their default.
        law : str or AsperityLaw or None
            The contact law, or its name.

        Returns
        -------
        LineContact or PointContact
            The contact.
        """
        contact = object.__new__(cls)
        contact._keep(law, inputs)
        return contact

    @property
    @abstractmethod
    def groups(self) -> Groups:
        """The dimensionless groups, see :class:`Groups`."""

    @property
    @abstractmethod
    def hertz(self) -> HertzScales:
        """The Hertz scales, see :class:`HertzScales`."""

    @property
    @abstractmethod
    def hersey_number(self) -> float:
        """The Hersey number [-]: eta U/F_N of a line, eta U R/F_N of a ball."""

    @property
    def slope(self) -> float:
        """Half-width or radius of the Hertz contact over the radius of curvature, a/R [-]."""
        return self.hertz.half_width / self.radius

    def inputs(self) -> Iterator[tuple[str, float]]:
        """Return name and value of each input that the contact has, in the order in which outputs name them.

        Returns
        -------
        iterator of tuple
            Name, and value in SI units.
        """
        pairs = ((name, getattr(self, name)) for name in self.INPUTS.names)
        return ((name, value) for name, value in pairs if value is not None)

    def to_si(self) -> dict[str, float]:
        """Return the inputs in SI units.

        Returns
        -------
        dict of str to float
            By name, in the order in which outputs name them.
        """
        return dict(self.inputs())

    def _repr_html_(self) -> str:
        from stribeck.contacts.with_parts import model_words

        rows = [(self.INPUTS.quantities[name].label, si_text(value, name, 4, self.INPUTS)) for name, value in self.inputs()]
        law = "exponential" if self.law is None else self.law.name
        model = [("model", words)] if (words := model_words(self.groups, self)) else []
        return card_html(type(self).__name__, Card("inputs", [*rows, ("contact law", law), *model]))

    def replace(self, **changes: Any) -> Self:
        """Return a copy with some of the inputs changed.

        Parameters
        ----------
        **changes : str or float
            Arguments of the contact; ``youngs_modulus`` and ``poisson_ratio`` together replace the
            modulus, ``entrainment_speed`` the speed.

        Returns
        -------
        LineContact or PointContact
            The changed contact, of the same kind.

        Raises
        ------
        InputError
            Where a value is impossible, as in the contact itself.
        """
        kept = {field.name: getattr(self, field.name) for field in fields(self)}
        inputs = replace_inputs(kept, changes, self.INPUTS)
        return self.of_kept(inputs, inputs.pop("law"))

    def _check_scales(self) -> None:
        """Refuse values, each possible alone, whose groups leave the range of double precision."""
        try:
            scales = self.hertz
            in_range = math.isfinite(scales.indentation * scales.pressure) and self.groups is not None
        except (InputError, ZeroDivisionError, OverflowError):
            in_range = False
        if not in_range:
            values = ", ".join(f"{name} = {value:g}" for name, value in self.inputs())
            raise InputError(
                f"the dimensionless groups of this contact leave the range of double precision; check {values} (all in SI)."
            )


def input_texts(contact: Contact | None, *without: str | None) -> list[str]:
    """Return the inputs of a contact in words, but for those that vary."""
    if contact is None:
        return []
    table = contact.INPUTS
    return [
        f"{table.symbols[name]} = {si_text(value, name, 4, table)}" for name, value in contact.inputs() if name not in without
    ]
