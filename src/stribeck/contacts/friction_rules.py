r"""What friction is made of, by geometry: arrays of states and of the inputs that it takes beside them.

.. math::

    \mu = \mu_0 \, f(S) \frac{F_c}{F_N} + \mu_f, \qquad
    \mu_f = \beta \, \mu_f(\beta = 1) \text{ on the line}, \qquad
    \mu_f = \frac{3}{2\pi} \frac aR J \text{ on the ball}

where the integral J of a ball is that of :mod:`stribeck.contacts.cut_off`.  Its arguments may bring derivatives, see
:mod:`stribeck.numerics.dual`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from stribeck._types import Array
from stribeck.contacts.contact import Contact
from stribeck.contacts.cut_off import FULL_FAR_FILM, far_error, friction_integral, is_far
from stribeck.contacts.friction import Definition, sliding_part
from stribeck.contacts.groups import Geometry, Groups
from stribeck.contacts.model import Model
from stribeck.contacts.parts import PURE_SLIDING
from stribeck.contacts.scaling import SCALINGS
from stribeck.numerics.dual import value_of

__all__ = ["RULES", "FrictionRule"]

Values = Mapping[str, Any]  # Arrays by name


class FrictionRule(NamedTuple):
    """Observables, inputs and scales of the friction of one geometry."""

    inputs: Mapping[str, Callable[[Contact | None], float]]
    exponents: Mapping[str, Mapping[str, float]]  # Exponents of inputs of the contact in those of them that are ratios
    parts: Callable[[Definition], tuple[str, ...]]  # `parts(definition)` names the observables that the viscous friction takes
    is_enough: Callable[[Model, Sequence[Values]], bool]
    viscous: Callable[[Values, Any, Any, Values, Definition], Any]
    far_error: Callable[[Values, Any, Any, Values], Any]
    scale: Callable[[Values, Any], dict[str, Any]]
    sliding_factor: Callable[
        [Groups, Values], Any
    ]  # `sliding_factor(groups, inputs)` is the part of boundary_friction that acts
    hersey: Callable[[Contact], float]  # `hersey(contact)` is the speed at the Hersey number one [m/s]
    hersey_exponents: Mapping[str, float]  # Exponents of the inputs in the Hersey number
    hersey_symbol: str  # The Hersey number in symbols
    hersey_name: str  # The Hersey number in words, for files

    def speed_per(self, abscissa: str, contact: Contact) -> float:
        """Return the speed [m/s] at the value one [SI] of what friction may be measured against."""
        of = {
            "speed": 1.0,
            "speed_viscosity": 1 / contact.viscosity,
            "hersey_number": self.hersey(contact),
            "hersey_per_length": contact.load / contact.viscosity,
        }
        return of[abscissa]

    def exponents_at(self, abscissa: str) -> Mapping[str, float]:
        """Return the exponents of inputs in the speed at a Hersey number, empty for other abscissas."""
        if abscissa == "hersey_per_length":
            return {name: power for name, power in self.hersey_exponents.items() if name != "radius"}
        return self.hersey_exponents if abscissa == "hersey_number" else {}

    def of_contact(self, contact: Contact | None) -> dict[str, float]:
        """Return the inputs of a contact, or of groups alone if the contact is None."""
        return {name: value(contact) for name, value in self.inputs.items()}

    def motion(self, contact: Contact | None) -> dict[str, Any]:
        """Return motion and liquid as keywords of the functions of :mod:`stribeck.atlas`."""
        return {name: value for name, value in self.of_contact(contact).items() if name != "beta"}

    def viscous_error(
        self, parts: Values, errors: Values, speed: Any, load: Any, inputs: Values, definition: Definition
    ) -> Any:
        """Return the absolute error of the viscous friction by the stated errors of its observables."""
        scales = self.scale(parts, speed)
        here = self.viscous(parts, speed, load, inputs, definition)
        total = self.far_error(parts, speed, load, inputs)
        for name in self.parts(definition):
            moved = {**parts, name: parts[name] + errors[name] * scales[name]}
            total = total + np.abs(self.viscous(moved, speed, load, inputs, definition) - here)
        return total


def _line_viscous(parts: Values, speed: Any, load: Any, inputs: Values, definition: Definition) -> Any:
    return inputs["beta"] * parts[f"viscous_{definition}"]


def _line_scale(parts: Values, speed: Any) -> dict[str, Any]:
    return {name: np.abs(value) for name, value in parts.items()}


def _slope(load: Any, inputs: Values) -> Any:
    scaling = SCALINGS["point"]
    return scaling.slope_factor * inputs["beta"] * load**scaling.pressure_exponent


def _ball_viscous(parts: Values, speed: Any, load: Any, inputs: Values, definition: Definition) -> Any:
    slope = _slope(load, inputs)
    J = friction_integral(
        parts, speed, slope, inputs["slide_to_roll"], inputs["wetted_radius"], definition, inputs.get("far", FULL_FAR_FILM)
    )
    return 1.5 / math.pi * slope * J


def _ball_far_error(parts: Values, speed: Any, load: Any, inputs: Values) -> Any:
    J = far_error(parts, speed, inputs["slide_to_roll"], inputs["wetted_radius"], inputs.get("far", FULL_FAR_FILM))
    return 1.5 / math.pi * _slope(load, inputs) * J


def _ball_scale(parts: Values, speed: Any) -> dict[str, Any]:
    """Return the scales of the stated errors of the friction integrals: themselves, but for J_pcx the whole friction."""
    balanced = parts["J_couette"] + parts["J_poiseuille"]
    published = balanced - parts["J_pcx"] + 0.4 * math.pi * speed
    largest = np.maximum(np.maximum(np.abs(balanced), np.abs(published)), speed)
    own = {name: np.abs(parts[name]) for name in ("J_couette", "J_poiseuille")}
    return dict.fromkeys(parts, largest) | {name: np.where(size > 0, size, largest) for name, size in own.items()}


def _liquid_radius(contact: Contact | None) -> float:
    """Return the radius of the liquid [a], infinite for a whole ball."""
    radius = getattr(contact, "wetted_radius", None)
    return math.inf if contact is None or radius is None else float(radius) / contact.hertz.half_width


def _beta(contact: Contact | None) -> float:
    return 1.0 if contact is None else contact.beta


def slide_to_roll(contact: Contact | None) -> float:
    """Return the slide-to-roll ratio of a contact, 2 without one."""
    return PURE_SLIDING if contact is None else float(contact.slide_to_roll)


def speed_words(contact: Contact) -> str:
    """Return what the speed U of a contact is: the sliding speed only if one surface is at rest."""
    return "sliding speed" if slide_to_roll(contact) == PURE_SLIDING else "sum of the surface speeds"


def _line_parts(definition: Definition) -> tuple[str, ...]:
    return (f"viscous_{definition}",)


def _ball_parts(definition: Definition) -> tuple[str, ...]:
    return ("J_couette", "J_poiseuille", "J_pcx")


_sliding: Callable[[Any], Array] = np.vectorize(sliding_part, otypes=[float])

# The rules by geometry.
RULES: dict[Geometry, FrictionRule] = {
    "line": FrictionRule(
        inputs={"beta": _beta},
        exponents={},
        parts=_line_parts,
        is_enough=lambda model, inputs: True,
        viscous=_line_viscous,
        far_error=lambda parts, speed, load, inputs: 0.0,
        scale=_line_scale,
        sliding_factor=lambda groups, inputs: sliding_part(2 * groups.model.film.slide),
        hersey=lambda each: each.load / each.viscosity,
        hersey_exponents={"load": 1.0, "viscosity": -1.0},
        hersey_symbol="ηU/F_N",
        hersey_name="Hersey number eta U/F_N: viscosity times sum of the surface speeds over load per length",
    ),
    "point": FrictionRule(
        inputs={
            "beta": _beta,
            "slide_to_roll": slide_to_roll,
            "wetted_radius": _liquid_radius,
        },
        exponents={"wetted_radius": {"radius": -1 / 3, "modulus": 1 / 3, "load": -1 / 3}},
        parts=_ball_parts,
        is_enough=lambda model, inputs: (
            all(is_far(model, each["wetted_radius"]) for each in inputs) and is_far(model, math.inf)
        ),
        viscous=_ball_viscous,
        far_error=_ball_far_error,
        scale=_ball_scale,
        sliding_factor=lambda groups, inputs: _sliding(value_of(inputs["slide_to_roll"])),
        hersey=lambda each: each.load / each.viscosity / each.radius,
        hersey_exponents={"load": 1.0, "viscosity": -1.0, "radius": -1.0},
        hersey_symbol="ηUR/F_N",
        hersey_name="Hersey number eta U R/F_N: viscosity times sum of the surface speeds times radius over load",
    ),
}
