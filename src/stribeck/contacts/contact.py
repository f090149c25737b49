"""The part common to contacts of every geometry: inputs in SI units, checked, kept and replaced."""

import inspect
import math
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, fields, replace
from functools import lru_cache
from typing import Any, ClassVar, Self, TypeVar

import numpy as np

from stribeck._types import Array
from stribeck.asperity_friction.coulomb import Coulomb
from stribeck.asperity_friction.law import AsperityFriction, refuse_coefficient
from stribeck.asperity_friction.shear_stress import ShearStress
from stribeck.contact_laws.law import AsperityLaw, check_alpha, own_inputs
from stribeck.contact_laws.scaled import law_of
from stribeck.contacts.forms import FORMS
from stribeck.contacts.groups import BASE_MODEL, BETA, SCALINGS, Geometry, Groups, Scaling
from stribeck.contacts.inputs import InputTable, check_motion, read_inputs
from stribeck.contacts.parts import (
    KINDS,
    LAW_NUMBERS,
    PART_INPUTS,
    PART_KEYWORDS,
    PURE_SLIDING,
    WITHOUT_MODEL,
    Parts,
    part_parameters,
    part_value,
    with_part_value,
)
from stribeck.files.results import Record
from stribeck.fluids.fluid import Cavitation
from stribeck.fluids.laws import HERTZ_UNITS, FilmUnits
from stribeck.profiles.dry import DryContact, dry_contact
from stribeck.quantities.docstrings import complete_docstring
from stribeck.quantities.formats import format_si
from stribeck.quantities.lazy import cached_property
from stribeck.quantities.outputs import HERTZ
from stribeck.quantities.results import Card, card_html
from stribeck.quantities.schema import Input, numbers_of
from stribeck.quantities.units import InputError, show

Kind = TypeVar("Kind", bound="Contact")


class RadiusOfProfile(float):
    """The radius of the cylinder with the dry width of a profile: it follows from the profile, the load and the modulus."""


@dataclass(frozen=True)
class HertzScales(Record):
    r"""Scales of the dry contact of a smooth cylinder or ball, in SI units.

    .. math::

        a = \left(\frac{4 F_N R}{\pi E^*}\right)^{1/2}, \quad p_\mathrm{Hz} = \frac{2 F_N}{\pi a} \text{ on the line}, \qquad
        a = \left(\frac{3 F_N R}{4 E^*}\right)^{1/3}, \quad p_\mathrm{Hz} = \frac{3 F_N}{2 \pi a^2} \text{ on the ball}, \qquad
        u_\mathrm{Hz} = \frac{a^2}{R}

    Notes
    -----
    Source: [Bertin & Pouliquen] Eq. (Hertz_scales) for the line; K. L. Johnson, Contact Mechanics (1985), for the ball.
    """

    _labels = {name.removeprefix("hertz_"): about for name, about in HERTZ.items()}

    half_width: float
    indentation: float
    pressure: float


HertzScales.__doc__ = complete_docstring(
    HertzScales, {name: f"float\n    The {meaning} [{unit}]." for name, (unit, meaning) in HertzScales._labels.items()}
)


@dataclass(frozen=True, kw_only=True)
class Coefficient(Input):
    """The friction coefficient of asperities, which a contact has no more where their friction is another."""

    def __get__(self, law: Any, owner: type) -> float:
        """Return the number of a contact, or refuse it where another friction stands in its place."""
        if law is not None and law.__dict__[self.name] is None:
            raise refuse_coefficient(law.asperity_friction)
        return super().__get__(law, owner)


@dataclass(frozen=True, init=False, repr=False, eq=False, kw_only=True)
class Contact(Parts):
    """The inputs that contacts of all geometries keep, in SI units, and their parts; see the contact of a geometry."""

    radius: Input = Input(
        label="radius",
        symbol="$R$",
        dimension="length",
        typical="10 mm",
        source="as in the examples of PDMS",
        usual=(1e-4, 1.0),
        units=("mm", "cm", "m"),
        letters=("R",),
        known=7,
        typical_error=0.02,
    )
    modulus: Input = Input(
        label="effective modulus",
        symbol="$E^*$",
        dimension="pressure",
        typical="2.7 MPa",
        source="E* of PDMS Sylgard 184",
        usual=(1e4, 3e8),
        units=("kPa", "MPa", "GPa"),
        letters=("E_star",),
        known=4,
        typical_error=0.2,
    )
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
        typical_error=0.05,
    )
    viscosity: Input = Input(
        label="viscosity",
        symbol=r"$\eta$",
        dimension="viscosity",
        typical="50 mPa*s",
        source="81 % glycerol in water at 25 degrees Celsius",
        usual=(3e-4, 10.0),
        units=("mPa*s", "Pa*s", "cP"),
        letters=("eta",),
        or_else='or that of a liquid by its name, preset = "water" in the table [fluid] of a case',
        known=5,
        typical_error=0.1,
    )
    speed: Input = Input(
        label="speed",
        symbol="$U$",
        dimension="speed",
        typical="1 mm/s",
        source="as in the examples of PDMS",
        usual=(1e-7, 10.0),
        units=("µm/s", "mm/s", "m/s"),
        letters=("U",),
        zero=True,
    )
    roughness: Input = Input(
        label="roughness",
        symbol=r"$h_\mathrm{rms}$",
        dimension="length",
        typical="1 um",
        source="rms height of a lightly sandblasted or ground surface",
        usual=(1e-9, 1e-4),
        units=("nm", "µm", "mm"),
        letters=("h_rms",),
        zero=True,
        known=1,
        typical_error=0.2,
    )
    alpha: Input = Input(
        label="contact-law alpha",
        symbol=r"$\alpha$",
        dimension="number",
        typical="2.0",
        source="Persson's theory gives 1.8 to 2.1",
        usual=(1.0, 4.0),
        follows_surface=True,
        known=3,
        typical_error=0.05,
    )
    beta: Input = BETA
    boundary_friction: Input = Coefficient(
        label="dry friction coefficient",
        symbol=r"$\mu_0$",
        dimension="number",
        typical="0.7",
        source="dry PDMS, 0.5 to 1",
        usual=(0.01, 2.0),
        implausible=3.0,
        letters=("mu0", "mu_0"),
        zero=True,
        known=0,
        typical_error=0.2,
    )
    law: AsperityLaw | None

    INPUTS: ClassVar[InputTable]
    WIDTH: ClassVar[str]

    def __init__(self, *, law: str | AsperityLaw | None = None, **inputs: Any) -> None:
        check_motion(inputs, self.INPUTS)
        self._keep(law, inputs)

    def _keep(self, law: str | AsperityLaw | None, inputs: Mapping[str, Any]) -> None:
        inputs = _with_shear_stress(inputs)
        for name in inputs.keys() & PART_INPUTS.keys():
            row = PART_INPUTS[name]
            raise InputError(
                f"{name} = {show(inputs[name])} is a number of {row.of}; give it to that law of {PACKAGE_OF[row.table]}, and "
                f"the law to the contact as {row.table}."
            )
        parts = {name: each for name, each in inputs.items() if name in PART_KEYWORDS and name not in self.INPUTS.names}
        asperities = law_of(law)
        given = own_inputs(asperities) | {name: each for name, each in inputs.items() if name not in parts}
        if isinstance(given.get("radius"), RadiusOfProfile):  # of another contact, which dataclasses.replace hands over
            del given["radius"]
        elsewhere = [own for part, own in IN_PLACE_OF.items() if parts.get(part) is not None]
        values = read_inputs(given, self.INPUTS, elsewhere).checked()
        super().__init__(**parts)
        if self.profile is not None:
            values = values | {"radius": self._radius_of_profile(values)}
        if self.asperity_friction is not None and "boundary_friction" in values:
            raise InputError(
                f"boundary_friction = {show(values['boundary_friction'])} and asperity_friction = "
                f"{show(self.asperity_friction)} are both given; give one of them: both are the friction of asperities."
            )
        for name in self.INPUTS.names:
            if name in values or name not in elsewhere:
                object.__setattr__(self, name, values.get(name))
            else:
                self.__dict__[name] = None
        if self.profile is not None:
            self.__dict__["radius"] = RadiusOfProfile(self.radius)
        object.__setattr__(self, "law", asperities)
        check_alpha(self.law, self.alpha)
        self._check_scales()
        _ = self.groups.model
        if self.asperity_friction is not None:
            self.asperity_friction.check(self)

    def __eq__(self, other: object) -> bool:
        """Return whether all inputs and parts are equal."""
        return self._kept == other._kept if isinstance(other, Contact) and type(other) is type(self) else NotImplemented

    def __hash__(self) -> int:
        """Return the same for equal contacts."""
        return hash(tuple(self._kept.values()))

    @property
    def _kept(self) -> dict[str, Any]:
        """All inputs and parts by name, None for those in whose place others stand."""
        return {field.name: self.__dict__[field.name] for field in fields(self)}

    def _radius_of_profile(self, values: Mapping[str, float]) -> float:
        """Return the radius of the cylinder with the same dry width under this load."""
        if self.scaling().dimensions != 1:
            raise InputError(f"profile = {show(self.profile)}: profiles are those of a line contact; a ball is round.")
        if "radius" in values:
            raise InputError(
                f"radius = {show(values['radius'])} and profile = {show(self.profile)} are both given; give one of them: a "
                "profile is the whole shape of the body."
            )
        own, load, modulus = getattr(self.profile, "radius_of_contact", None), values["load"], values["modulus"]
        return own if own is not None else math.pi * modulus * _dry(self.profile, load, modulus).half_width ** 2 / (4 * load)

    @classmethod
    def of_kept(cls, inputs: Mapping[str, Any], law: str | AsperityLaw | None) -> Self:
        """Return the contact that keeps these inputs, in SI units; others by their default."""
        contact = object.__new__(cls)
        contact._keep(law, inputs)
        return contact

    @classmethod
    def from_groups(cls, groups: Groups, **kept: Any) -> Self:
        """Return the contact whose :attr:`groups` are ``groups``; load, speed and roughness follow from their definitions.

        Parameters
        ----------
        groups : Groups
            Groups of one state of this geometry.
        **kept : str or float
            The other inputs of the contact: all but load, speed and roughness.

        Returns
        -------
        LineContact or PointContact
            The contact, with load, speed and roughness in SI.

        Raises
        ------
        InputError
            Where the groups hold more than one state or are those of another geometry, or a value is impossible or missing.
        """
        if groups.shape != ():
            raise InputError(f"groups of shape {groups.shape} hold many states; from_groups takes one, without arrays.")
        scaling = cls.scaling()
        if groups.geometry != scaling.name:
            raise InputError(f"groups.geometry = {groups.geometry!r}; a {scaling.body} has {scaling.name!r}.")
        own = {name: value for name, value in kept.items() if name in cls.INPUTS.quantities and value is not None}
        replaced = () if kept.get("asperity_friction") is None else (IN_PLACE_OF["asperity_friction"],)
        given = read_inputs(own, cls.INPUTS, elsewhere=("load", "speed", "roughness", *replaced)).checked()
        R, E_star, alpha, beta = given["radius"], given["modulus"], given["alpha"], given["beta"]
        scale, r = scaling.slope_factor * beta, scaling.dimensions
        F_N = scale ** (1 + r) * R**r * E_star * float(groups.load) / scaling.hertz_factor
        U = float(groups.hersey_number(beta)) * (F_N / given["viscosity"]) / R ** (r - 1)
        moved = {"load": F_N, "speed": U, "roughness": alpha * scale * scale * R * float(groups.roughness)}
        return cls.of_kept({name: each for name, each in kept.items() if name not in own} | given | moved, groups.law)

    @classmethod
    def scaling(cls) -> Scaling:
        """How its groups scale."""
        return SCALINGS[cls.INPUTS.geometry]

    @property
    def groups(self) -> Groups:
        """The dimensionless groups, see :class:`Groups`."""
        if not self.own_parts.keys() - WITHOUT_MODEL:
            return self._base_groups
        # Made anew each time: a fluid holds what is computed of it.
        origin = 0.0 if self.profile is None else _dry(self.profile, self.load, self.modulus).centre
        return replace(self._base_groups, model=self.model_in(self.film_units, self.hertz.half_width, self.speed, origin))

    def __copy__(self) -> Self:
        """Return a copy that keeps no groups: who makes it sets other inputs."""
        found = object.__new__(type(self))
        vars(found).update({name: value for name, value in vars(self).items() if name != "_base_groups"})
        return found

    @cached_property
    def _base_groups(self) -> Groups:
        """The groups with the article's model."""
        scaling, slope, scale = self.scaling(), self.slope, self.scaling().slope_factor * self.beta
        # Quotients one by one: a product of small numbers may underflow where the group itself does not.
        return Groups(
            speed=scaling.hersey_divisor * self.hersey_number / slope**scaling.hersey_power,
            load=self._compression / scale ** (1 + scaling.dimensions),
            roughness=self.roughness / self.radius / self.alpha / scale / scale,
            law=self.law,
            geometry=scaling.name,
        )

    @cached_property
    def own_parts(self) -> dict[str, Any]:
        """The parts that are neither the article's nor among the inputs."""
        return {name: value for name, value in super().own_parts.items() if name not in self.INPUTS.names}

    @property
    def _replaced(self) -> tuple[str, ...]:
        """The inputs in whose place a part stands: under a profile the radius is none."""
        return tuple(own for part, own in IN_PLACE_OF.items() if getattr(self, part) is not None)

    @property
    def friction_of_asperities(self) -> AsperityFriction:
        """What turns the load of its asperities, or their area, into friction: ``boundary_friction`` or what replaces it."""
        return self.asperity_friction or Coulomb(self.boundary_friction)

    @property
    def _compression(self) -> float:
        """Load over the stiffness of the contact, whose power e is the slope a/R."""
        scaling = self.scaling()
        return scaling.hertz_factor * (self.load / self.radius**scaling.dimensions / self.modulus)

    @property
    def hertz(self) -> HertzScales:
        """The scales with which results return to SI, see :class:`~stribeck.results.HertzScales`."""
        scaling, slope = self.scaling(), self.slope
        a = self.radius * slope
        mean = self.load / (2 if scaling.dimensions == 1 else math.pi * a) / a
        return HertzScales(half_width=a, indentation=a * slope, pressure=scaling.hertz_pressure * mean)

    @property
    def hersey_number(self) -> float:
        r"""The Hersey number [-]: :math:`\eta U/F_N` of a line, :math:`\eta U R/F_N` of a ball.

        :math:`U` is the sum of the surface speeds: the number is twice the one that is made with their mean.
        """
        return self.viscosity * self.speed / self.load * self.radius ** (self.scaling().dimensions - 1)

    @property
    def slope(self) -> float:
        """Half-width or radius of the Hertz contact over the radius of curvature, a/R [-]."""
        return float(self._compression ** self.scaling().pressure_exponent)

    def inputs(self) -> Iterator[tuple[str, float]]:
        """Return name and SI value of each input that the contact has, in the order in which outputs name them."""
        pairs = ((name, getattr(self, name)) for name in self.INPUTS.names if name not in self._replaced)
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
        names = [name for name in (*self.INPUTS.names, "law") if name not in self._replaced]
        shown = {name: getattr(self, name) for name in names} | self.own_parts
        shown |= {"cavitation": self.cavitation.value} if "cavitation" in shown else {}
        return f"{type(self).__name__}({', '.join(f'{name}={value!r}' for name, value in shown.items())})"

    def __getattr__(self, name: str) -> Any:
        """Return a number of the fluid or the solid by its name, in SI units."""
        found = part_value(self, name) if name in PART_INPUTS else None
        # Of a property that fails Python asks here, and would show none of what failed.
        return object.__getattribute__(self, name) if found is None else found

    def _repr_html_(self) -> str:
        rows = [(self.INPUTS.quantities[name].label, self.INPUTS.text(name, value)) for name, value in self.inputs()]
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
        if self.asperity_friction is None:
            changes = dict(_with_shear_stress(changes))
        numbers = {name: changes.pop(name) for name in PART_INPUTS if name in changes}
        if numbers:
            parts = Parts(**{**self.part_values(), **{name: changes[name] for name in PART_KEYWORDS if name in changes}})
            for name, value in numbers.items():
                parts = with_part_value(parts, name, value)
            changes |= parts.part_values()
        kept, changed = self._kept, set(changes)
        if "boundary_friction" in changes and "asperity_friction" not in changes:
            changed.add("asperity_friction")
        there = {part: None if part in changed - set(changes) else changes.get(part, kept[part]) for part in IN_PLACE_OF}
        changed.update(own for part, own in IN_PLACE_OF.items() if there[part] is not None)
        if "profile" in changes:  # a film ends by default as suits the shape
            changed.add("cavitation")
        for form in self.INPUTS.forms:  # what is changed in another form is not kept beside it
            if not changed.isdisjoint(form.names):
                changed.add(form.of)
        inputs = {name: value for name, value in kept.items() if name not in changed} | changes
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

    def _check_scales(self) -> None:
        """Refuse values, each possible alone, whose groups leave the range of double precision."""
        try:
            scales, groups = self.hertz, self._base_groups
            lost = any(getattr(self, name) > 0 and getattr(groups, name) == 0 for name in ("speed", "roughness"))
            in_range = math.isfinite(scales.indentation * scales.pressure) and not lost
        except (InputError, ZeroDivisionError, OverflowError):
            in_range = False
        if not in_range:
            values = ", ".join(f"{name} = {value:g}" for name, value in self.inputs())
            raise InputError(
                f"the dimensionless groups of this contact leave the range of double precision; check {values} (all in SI)."
            )


@lru_cache(maxsize=256)  # a contact asks each time its groups are made
def _dry(profile: Any, load: float, modulus: float) -> DryContact:
    return dry_contact(profile, load, modulus)


PACKAGE_OF = {kind.table: f"sb.{kind.package.split('.')[1]}" for kind in KINDS.values()}  # By table of a case

IN_PLACE_OF = {"profile": "radius", "asperity_friction": "boundary_friction"}  # Part -> input in whose place it stands


def _with_shear_stress(inputs: Mapping[str, Any]) -> Mapping[str, Any]:
    """Return inputs with the friction of asperities that numbers of a shear stress among them stand for."""
    numbers = {name: inputs[name] for name in numbers_of(ShearStress) if inputs.get(name) is not None}
    if "shear_stress" not in numbers:
        return inputs
    if inputs.get("asperity_friction") is not None:
        raise InputError("shear_stress and asperity_friction are both given; give one of them.")
    others = {name: value for name, value in inputs.items() if name not in numbers}
    return others | {"asperity_friction": ShearStress(**numbers)}


# What docstrings say of the arguments of all contacts that are no numbers.
OTHER_ARGUMENTS = {
    "law": r"""str or AsperityLaw, optional
    Contact law, or the name of one that needs no surface,
    :math:`p_c = \beta E^* \Phi(\alpha h/h_\mathrm{rms})`; :math:`\Phi(s) = \exp(-s)` by default.""",
    "fluid": """Fluid or law of sb.fluids, optional
    The fluid, whose viscosity at ambient pressure and low rate is ``viscosity``; Newtonian without it.""",
    "cavitation": """{"none", "exit", "reform"}
    How the film ends behind the contact.""",
    "flow_factors": """{"none", "effective-medium", "patir-cheng"} or law of sb.fluids, optional
    What roughness does to the flow.""",
    "solid": """solid of sb.solids, optional
    The soft body; a half-space without it.""",
    "profile": """profile of sb.profiles, optional
    The shape of the rigid body in the place of ``radius``, of a line contact alone; its film ends at the exit, unless
    ``cavitation`` says otherwise.""",
    "asperity_friction": """friction of stribeck.asperity_friction, optional
    The friction of asperities in the place of ``boundary_friction``; ``shear_stress`` = ..., with ``speed_exponent`` and
    ``reference_speed``, is short for ``ShearStress``.""",
    **{name: f"str or float, optional\n    {row.description}" for name, row in numbers_of(Parts).items()},
}


def described(geometry: Geometry) -> Callable[[type[Kind]], type[Kind]]:
    """Return a decorator that gives a contact its table of inputs, and a signature and a docstring that name them."""

    def complete(kind: type[Kind]) -> type[Kind]:
        kind.INPUTS = InputTable(kind, tuple(form for form in FORMS if form.geometry in ("", geometry)), geometry)
        inputs = kind.INPUTS.parameters()
        law = inspect.Parameter("law", inspect.Parameter.KEYWORD_ONLY, default=None)
        parts = part_parameters(without=kind.INPUTS.names)
        kind.__signature__ = inspect.Signature([*inputs, law, *parts])  # type: ignore[attr-defined]
        kind.__doc__ = complete_docstring(kind, OTHER_ARGUMENTS | kind.INPUTS.arguments())
        return kind

    return complete


def input_texts(contact: Contact | None, *without: str | None) -> list[str]:
    """Return the inputs of a contact in words, but for those that vary."""
    if contact is None:
        return []
    table = contact.INPUTS
    return [
        f"{table.kept[name].symbol} = {table.text(name, value)}" for name, value in contact.inputs() if name not in without
    ]


def part_attributes(groups: Groups, contact: Contact | None = None) -> dict[str, float | str]:
    """Return fluid, cavitation, solid, profile and motion with their numbers, for outputs; nothing of the article's."""
    model = groups.model
    if model == BASE_MODEL and getattr(contact, "asperity_friction", None) is None:
        return {}
    if contact is None:
        laws: dict[str, Any] = {"fluid": _at_speed(model.film, np.unique(np.asarray(groups.speed))), "solid": model.solid}
        slide_to_roll, cavity_pressure = 2 * model.film.slide, model.cavity_pressure
    else:
        laws = {name: getattr(contact, name) for name in ("fluid", "flow_factors", "solid", "asperity_friction")}
        slide_to_roll, cavity_pressure = contact.slide_to_roll, contact.cavity_pressure
    laws["profile"] = None if model.profile.is_parabola else model.profile
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
        owner = next((f"{what}_" for what in PACKAGE_OF if name.startswith(f"{what}_")), "")
        found[name.removeprefix(owner)] = value
    return in_words(found, contact is not None) + (" (Hertz units)" if found and contact is None else "")


NUMBERS_IN_WORDS = LAW_NUMBERS | {"rms_height": numbers_of(Contact)["roughness"]}


def in_words(parameters: Mapping[str, float | str], si: bool = False) -> str:
    """Return names and values in words, in SI units with these."""
    said = []
    for name, value in parameters.items():
        row = NUMBERS_IN_WORDS.get(re.sub("^(first|second)_", "", name))
        kind = row.dimension if si and row is not None else None
        text = value if isinstance(value, str) else format_si(value, kind) if kind else f"{value:.4g}"
        said.append(f"{name.replace('_', ' ')} {text}")
    return ", ".join(said)


def _at_speed(film: Any, speeds: Array) -> Any:
    """Return a film with the numbers of its rate law as groups are given them at their speed, where they have a single one."""
    if not film.uses_speed or len(speeds) != 1 or not speeds[0] > 0:
        return film
    return replace(film, law=film.law.scaled(HERTZ_UNITS._replace(time=1 / float(speeds[0]))))
