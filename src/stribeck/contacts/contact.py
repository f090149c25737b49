"""The part common to contacts of every geometry: inputs in SI units, checked, kept and replaced.

A geometry adds its table of inputs, its groups and its Hertz scales.
"""

from __future__ import annotations

import math
import re
from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, fields, replace
from typing import Any, ClassVar, Self

import numpy as np

from stribeck._types import Array
from stribeck.contact_laws.law import AsperityLaw, check_alpha
from stribeck.contact_laws.scaled import law_of
from stribeck.contacts.groups import Groups
from stribeck.contacts.model import BASE_MODEL
from stribeck.contacts.part_inputs import LAW_NUMBERS, PART_INPUTS, PART_LETTERS, part_value, with_part_value
from stribeck.contacts.parts import BASE_PARTS, PART_KEYWORDS, PURE_SLIDING, Parts
from stribeck.fluids.cavitation import Cavitation
from stribeck.fluids.description import Fluid
from stribeck.fluids.laws import HERTZ_UNITS, FilmUnits, FlowFactors
from stribeck.quantities.contact_values import contact_values, replace_inputs
from stribeck.quantities.conversions import convert_inputs
from stribeck.quantities.formats import format_si
from stribeck.quantities.inputs import InputTable, si_text
from stribeck.quantities.keywords import answers_typos
from stribeck.quantities.results import Card, card_html
from stribeck.quantities.units import InputError, show
from stribeck.solids.solid import Solid

__all__ = ["Contact", "HertzScales", "in_words", "input_texts", "model_words", "part_attributes"]


# Dimensions of what outputs say of the parts of a contact beside the numbers of laws.
PART_DIMENSIONS = {"cavity_pressure": "pressure"}


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


@dataclass(frozen=True, init=False, repr=False)
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
    parts: Parts = field(repr=False)

    INPUTS: ClassVar[InputTable]
    WIDTH: ClassVar[str] = "Hertz half-width"

    @answers_typos
    def __init__(self, *, law: str | AsperityLaw | None = None, **inputs: Any) -> None:
        self._keep(law, inputs)

    def _keep(self, law: str | AsperityLaw | None, inputs: Mapping[str, Any]) -> None:
        names = self._part_names
        for name in inputs.keys() & {*PART_INPUTS, *PART_LETTERS}:
            row = PART_INPUTS[PART_LETTERS.get(name, name)]
            raise InputError(
                f"{name} = {show(inputs[name])} is a number of {row.of}; give it to that law of sb.{row.table}s, and the law "
                f"to the contact as {row.table}."
            )
        # The numbers are checked with the parts of the article's model first, so that what is wrong with them is said of them.
        object.__setattr__(self, "parts", BASE_PARTS)
        numbers = {name: value for name, value in inputs.items() if name not in names and name != "parts"}
        for name, value in contact_values(convert_inputs(numbers, self.INPUTS), self.INPUTS).items():
            object.__setattr__(self, name, value)
        object.__setattr__(self, "law", law_of(law))
        check_alpha(self.law, self.alpha)
        self._check_scales()
        parts: Parts = inputs.get("parts", BASE_PARTS)
        given = {name: inputs[name] for name in names & inputs.keys()}
        object.__setattr__(self, "parts", Parts(**{**parts.items(), **given}) if given else parts)
        _ = self.groups.model

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

    def __repr__(self) -> str:
        """Return the inputs, and those parts that are not the article's, as keywords that make it again."""
        shown = {each.name: getattr(self, each.name) for each in fields(self) if each.repr}
        shown |= {name: value for name, value in self.parts.items().items() if value != getattr(BASE_PARTS, name)}
        shown |= {"cavitation": self.cavitation.value} if "cavitation" in shown else {}
        return f"{type(self).__name__}({', '.join(f'{name}={value!r}' for name, value in shown.items())})"

    @property
    def _part_names(self) -> frozenset[str]:
        """The parts that are no inputs of its geometry."""
        return PART_KEYWORDS - set(self.INPUTS.names)

    def __getattr__(self, name: str) -> Any:
        """Return a number of the fluid or the solid by its name, in SI units."""
        found = part_value(self.parts, name) if name in PART_INPUTS else None
        # Of a property that fails Python asks here, and would show none of what failed.
        return object.__getattribute__(self, name) if found is None else found

    def _repr_html_(self) -> str:
        rows = [(self.INPUTS.quantities[name].label, si_text(value, name, 4, self.INPUTS)) for name, value in self.inputs()]
        law = "exponential" if self.law is None else self.law.name
        model = [("model", words)] if (words := model_words(self.groups, self)) else []
        return card_html(type(self).__name__, Card("inputs", [*rows, ("contact law", law), *model]))

    def replace(self, **changes: Any) -> Self:
        """Return a copy with some of the inputs changed.

        Parameters
        ----------
        **changes : str or float
            Arguments of the contact, and numbers of its fluid and solid by name, such as ``relaxation_time`` or
            ``layer_thickness``; ``youngs_modulus`` and ``poisson_ratio`` together replace the modulus, ``entrainment_speed``
            the speed.

        Returns
        -------
        LineContact or PointContact
            The changed contact, of the same kind.

        Raises
        ------
        InputError
            Where a value is impossible, or the fluid or solid has no such number.
        """
        numbers = {name: changes.pop(name) for name in PART_INPUTS if name in changes}
        if numbers:
            parts = Parts(**{**self.parts.items(), **{name: changes.pop(name) for name in self._part_names & changes.keys()}})
            for name, value in numbers.items():
                parts = with_part_value(parts, name, value)
            changes["parts"] = parts
        kept = {field.name: getattr(self, field.name) for field in fields(self)}
        inputs = replace_inputs(kept, changes, self.INPUTS)
        return self.of_kept(inputs, inputs.pop("law"))

    @property
    def film_units(self) -> FilmUnits:
        """Scales of the numbers of its fluid."""
        hertz = self.hertz
        return FilmUnits(
            pressure=hertz.pressure,
            time=6 * self.viscosity / hertz.pressure * (hertz.half_width / hertz.indentation),
            gap=hertz.indentation,
            viscosity=self.viscosity,
            decay_length=self.roughness / self.alpha,
            alpha=self.alpha,
        )

    @property
    def fluid(self) -> Fluid:
        """The fluid."""
        return self.parts.fluid

    @property
    def cavitation(self) -> Cavitation:
        """How the film ends behind the contact."""
        return self.parts.cavitation

    @property
    def cavity_pressure(self) -> float:
        """Rupture pressure of a film that reforms, above the ambient one [Pa]."""
        return self.parts.cavity_pressure

    @property
    def flow_factors(self) -> FlowFactors | None:
        """What roughness does to the flow."""
        return self.parts.flow_factors

    @property
    def solid(self) -> Solid | None:
        """The soft body; None is a half-space."""
        return self.parts.solid

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


def part_attributes(groups: Groups, contact: Contact | None = None) -> dict[str, float | str]:
    """Return fluid, cavitation, flow factors, solid and motion with their numbers, for outputs; nothing of the article's."""
    model = groups.model
    if model == BASE_MODEL:
        return {}
    if contact is None:
        laws: dict[str, Any] = {"fluid": _at_speed(model.film, np.unique(np.asarray(groups.speed))), "solid": model.solid}
        slide_to_roll, cavity_pressure = 2 * model.film.slide, model.cavity_pressure
    else:
        laws = {"fluid": contact.fluid, "flow_factors": contact.flow_factors, "solid": contact.solid}
        slide_to_roll, cavity_pressure = contact.slide_to_roll, contact.cavity_pressure
    found: dict[str, float | str] = {}
    for what, law in laws.items():
        if law is not None:
            found |= {what: law.name, **{f"{what}_{name}": value for name, value in law.parameters.items()}}
    found["cavitation"] = model.cavitation.value
    if model.cavitation is Cavitation.REFORM:
        found["cavity_pressure"] = cavity_pressure
    return found | {"slide_to_roll": slide_to_roll}


def model_words(groups: Groups, contact: Contact | None) -> str:
    """Return those parts of a model that are neither the article's nor among the inputs; empty if there are none."""
    inputs = () if contact is None else contact.INPUTS.names
    found: dict[str, float | str] = {}
    for name, value in part_attributes(groups, contact).items():
        if name in inputs or (name, value) in (("cavitation", "none"), ("slide_to_roll", PURE_SLIDING)):
            continue
        owner = next((f"{what}_" for what in ("fluid", "flow_factors", "solid") if name.startswith(f"{what}_")), "")
        found[name.removeprefix(owner)] = value
    return in_words(found, contact is not None) + (" (Hertz units)" if found and contact is None else "")


def in_words(parameters: Mapping[str, float | str], si: bool = False) -> str:
    """Return names and values in words, in SI units with these."""
    said = []
    for name, value in parameters.items():
        row = LAW_NUMBERS.get(re.sub("^(first|second)_", "", name))
        kind = (PART_DIMENSIONS.get(name) if row is None else row.dimension) if si else None
        text = value if isinstance(value, str) else format_si(value, kind) if kind else f"{value:.4g}"
        said.append(f"{name.replace('_', ' ')} {text}")
    return ", ".join(said)


def _at_speed(film: Any, speeds: Array) -> Any:
    """Return a film with the numbers of its rate law as groups are given them at their speed, where they have a single one."""
    if not film.uses_speed or len(speeds) != 1 or not speeds[0] > 0:
        return film
    return replace(film, law=film.law.scaled(HERTZ_UNITS._replace(time=1 / float(speeds[0]))))
