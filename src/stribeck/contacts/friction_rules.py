r"""What friction is made of, by geometry: arrays of states and of the inputs that it takes beside them.

.. math::

    \mu = \mu_0 \, f(S) \frac{F_c}{F_N} + \mu_f, \qquad
    \mu_f = \beta \, \mu_f(\beta = 1) \text{ on the line}, \qquad
    \mu_f = \frac{3}{2\pi} \frac aR J \text{ on the ball}

where the integral J of a ball is that of :mod:`stribeck.contacts.cut_off`.  Its arguments may bring derivatives, see
:mod:`stribeck.numerics.dual`.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from stribeck.contacts.contact import Contact
from stribeck.contacts.cut_off import FULL_FAR_FILM, far_error, friction_integral, is_far
from stribeck.contacts.friction import Definition, sliding_part
from stribeck.contacts.groups import SCALINGS, Geometry, Groups, Model
from stribeck.contacts.parts import PURE_SLIDING

Values = Mapping[str, Any]  # Arrays by name


def _beta(contact: Contact | None) -> float:
    return 1.0 if contact is None else contact.beta


def slide_to_roll(contact: Contact | None) -> float:
    """Return the slide-to-roll ratio of a contact, 2 without one."""
    return PURE_SLIDING if contact is None else float(contact.slide_to_roll)


def _liquid_radius(contact: Contact | None) -> float:
    """Return the radius of the liquid [a], infinite for a whole ball."""
    radius = getattr(contact, "wetted_radius", None)
    return math.inf if contact is None or radius is None else float(radius) / contact.hertz.half_width


def speed_words(contact: Contact) -> str:
    """Return what the speed U of a contact is: the sliding speed only if one surface is at rest."""
    return "sliding speed" if slide_to_roll(contact) == PURE_SLIDING else "sum of the surface speeds"


class FrictionRule:
    """Observables, inputs and scales of the friction of a geometry: of cylinders, where a subclass does not differ."""

    inputs: Mapping[str, Callable[[Contact | None], float]] = {"beta": _beta}
    exponents: Mapping[str, Mapping[str, float]] = {}  # Exponents of inputs of the contact in those of them that are ratios
    hersey_exponents: Mapping[str, float] = {"load": 1.0, "viscosity": -1.0}  # Of the inputs in the speed at one Hersey number
    hersey_symbol = "ηU/F_N"
    hersey_name = "Hersey number eta U/F_N: viscosity times sum of the surface speeds over load per length"

    def parts(self, definition: Definition) -> tuple[str, ...]:
        """Return the names of the observables that the viscous friction takes."""
        return (f"viscous_{definition}",)

    def is_enough(self, model: Model, inputs: Sequence[Values]) -> bool:
        """Return whether these observables alone give the friction, wherever the liquid ends."""
        return True

    def viscous(self, parts: Values, speed: Any, load: Any, inputs: Values, definition: Definition) -> Any:
        """Return the viscous friction coefficient."""
        return inputs["beta"] * parts[f"viscous_{definition}"]

    def far_error(self, parts: Values, speed: Any, load: Any, inputs: Values) -> Any:
        """Return its error by the end of the liquid."""
        return 0.0

    def scale(self, parts: Values, speed: Any) -> dict[str, Any]:
        """Return the scales of the stated errors of the observables."""
        return {name: np.abs(value) for name, value in parts.items()}

    def sliding_factor(self, groups: Groups, inputs: Values) -> Any:
        """Return the part of boundary_friction that acts."""
        return sliding_part(2 * groups.model.film.slide)

    def speed_per(self, abscissa: str, contact: Contact) -> float:
        """Return the speed [m/s] at the value one [SI] of what friction may be measured against."""
        of = {
            "speed": 1.0,
            "speed_viscosity": 1 / contact.viscosity,
            "hersey_number": contact.load / contact.viscosity / contact.radius ** (contact.scaling().dimensions - 1),
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


class BallRule(FrictionRule):
    """The friction of balls: integrals up to where the liquid ends."""

    inputs = {"beta": _beta, "slide_to_roll": slide_to_roll, "wetted_radius": _liquid_radius}
    exponents = {"wetted_radius": {"radius": -1 / 3, "modulus": 1 / 3, "load": -1 / 3}}
    hersey_exponents = {"load": 1.0, "viscosity": -1.0, "radius": -1.0}
    hersey_symbol = "ηUR/F_N"
    hersey_name = "Hersey number eta U R/F_N: viscosity times sum of the surface speeds times radius over load"

    def parts(self, definition: Definition) -> tuple[str, ...]:
        """Return the names of the friction integrals."""
        return ("J_couette", "J_poiseuille", "J_pcx")

    def is_enough(self, model: Model, inputs: Sequence[Values]) -> bool:
        """Return whether a far film in closed form holds from where the liquid ends."""
        return all(is_far(model, each["wetted_radius"]) for each in inputs) and is_far(model, math.inf)

    def viscous(self, parts: Values, speed: Any, load: Any, inputs: Values, definition: Definition) -> Any:
        """Return the viscous friction coefficient."""
        slope, far = self._slope(load, inputs), inputs.get("far", FULL_FAR_FILM)
        motion, within = (inputs["slide_to_roll"], inputs["wetted_radius"]), inputs.get("within")
        return 1.5 / math.pi * slope * friction_integral(parts, speed, slope, *motion, definition, far, within)

    def far_error(self, parts: Values, speed: Any, load: Any, inputs: Values) -> Any:
        """Return its error by the end of the liquid."""
        J = far_error(parts, speed, inputs["slide_to_roll"], inputs["wetted_radius"], inputs.get("far", FULL_FAR_FILM))
        # Where no far film in closed form holds, the film itself is integrated to where the liquid ends.
        J = np.where(is_far(inputs["model"], inputs["wetted_radius"]), J, 0.0)
        return 1.5 / math.pi * self._slope(load, inputs) * J

    def scale(self, parts: Values, speed: Any) -> dict[str, Any]:
        """Return the scales of the stated errors of the integrals: themselves, but for J_pcx the whole friction."""
        balanced = parts["J_couette"] + parts["J_poiseuille"]
        published = balanced - parts["J_pcx"] + 0.4 * math.pi * speed
        largest = np.maximum(np.maximum(np.abs(balanced), np.abs(published)), speed)
        own = {name: np.abs(parts[name]) for name in ("J_couette", "J_poiseuille")}
        return dict.fromkeys(parts, largest) | {name: np.where(size > 0, size, largest) for name, size in own.items()}

    def sliding_factor(self, groups: Groups, inputs: Values) -> Any:
        """Return the part of boundary_friction that acts."""
        return sliding_part(inputs["slide_to_roll"])

    @staticmethod
    def _slope(load: Any, inputs: Values) -> Any:
        scaling = SCALINGS["point"]
        return scaling.slope_factor * inputs["beta"] * load**scaling.pressure_exponent


RULES: dict[Geometry, FrictionRule] = {"line": FrictionRule(), "point": BallRule()}  # The rules by geometry
