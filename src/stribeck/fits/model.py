r"""The predicted friction of all rows of measured curves as a function of the free inputs, with exact derivatives.

A free input is the common factor :math:`e^\theta` on what the case or the curve has for it.  Every row then has

.. math::

    \ln (\lambda, \bar F_N, \bar h_\mathrm{rms}, \mu_0, \beta, \ldots)_i = L_i + A_{c(i)}^T \theta, \qquad
    \frac{\partial \mu_i}{\partial \theta} = A_{c(i)} \frac{\partial \mu_i}
    {\partial \ln (\lambda, \bar F_N, \bar h_\mathrm{rms}, \mu_0, \beta, \ldots)}

with a constant matrix A of exponents for each curve c: those of the inputs of the contact in the groups, and in what the
friction of its geometry takes beside them, see :mod:`stribeck.contacts.friction_rules`.  Inputs from which the dry width under
a profile follows enter the groups as no power: these are formed anew at each place, with A the exponents there.

Numbers of fluids and solids are in the model that the groups carry, in Hertz units: there they depend on their own free inputs
and on those of the Hertz contact, and give the friction a further derivative at fixed groups.
"""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from stribeck import atlas
from stribeck._types import Array, Indices
from stribeck.contacts.contact import Contact
from stribeck.contacts.cut_off import far_film
from stribeck.contacts.friction import Definition, friction_share
from stribeck.contacts.friction_rules import RULES, FrictionRule
from stribeck.contacts.groups import Groups, Physics
from stribeck.contacts.with_parts import exponents_of, models_at_both_sides, refuse_fixed_memory, width_inputs
from stribeck.equations.sensitivity import Change
from stribeck.fits.free_inputs import FreeInput
from stribeck.fits.measurements import Measurements
from stribeck.fits.states import Changes, FrictionParts, Inputs, States, places, together
from stribeck.numerics.dual import Dual, by_logarithms
from stribeck.quantities.outputs import GROUPS
from stribeck.quantities.units import InputError

# Smallest and largest tolerance of states of balls that the noise of the data may ask for: what a rig resolves lies between
# them.  That of the case holds where it is larger.
BALL_RTOL = 1e-4, 1e-3

LOG_STEP = 1e-5  # Step of a logarithm in differences of the factor of the friction of asperities, a closed form

ERROR_SHARE = 1 / 3  # Tolerance of states over the standard error of a common factor on the friction, which it widens by 5 %


@dataclass(frozen=True)
class Prediction:
    """The friction coefficients of all rows at one set of free inputs."""

    friction: Array  # Size of the friction coefficient [-]
    jacobian: Array  # Derivatives by the logarithms of the free inputs [-]
    contact_share: Array  # Part of the friction coefficient that asperities cause [-]
    load_share: Array  # Part of the load on asperities [-]
    error: Array  # Estimated absolute error of the friction coefficient [-]


class FrictionModel:
    """Friction of the rows of measured curves, by free inputs."""

    def __init__(self, contact: Contact, data: Measurements, free: Sequence[FreeInput]) -> None:
        self.contact, self.data, self.free = contact, data, tuple(free)
        names = {name for each in free for name in each.names}
        if contact.profile is not None and "radius" in names:
            raise InputError("radius is free, but the profile is the whole shape of the body; free numbers of the profile.")
        # Logarithms are then no sums: the dry width under a profile, or a stress at each speed, is found from these inputs.
        friction = contact.friction_of_asperities
        self.is_constant = friction.is_constant  # Whether asperities rub by the same factor at all speeds
        self.unit = (contact.speed or 1.0) if friction.uses_speed else 1.0  # Speed of the contacts of the curves [m/s]
        of_width = contact.profile is not None and bool(names & set(width_inputs(contact)))
        self.bends = of_width or not self.is_constant
        self.contacts = tuple(contact.replace(speed=self.unit, **inputs) for inputs in data.inputs)
        if any(each.friction_of_asperities.observable != friction.observable for each in self.contacts):
            raise InputError(
                "some curves have a dry friction coefficient, and others a shear stress in its place; fit them apart."
            )
        groups = [each.groups for each in self.contacts]
        self.physics, self.model = [each.physics for each in groups], contact.groups.model
        self.remembers = [getattr(each.model.solid, "uses_speed", False) for each in groups]
        if data.abscissa != "speed":
            for each in groups:
                refuse_fixed_memory(each, "which a fit must know; give a column of speeds, or fit with an elastic solid.")
        # Whether friction is that of a far film wherever the liquid of a curve ends.
        self.is_far = all(self.rule.is_enough(each.groups.model, [self.rule.of_contact(each)]) for each in self.contacts)
        self.exponents = self._exponents_at(self.contacts)
        self.logs = self._logs_at(self.contacts, data.curve, data.values)
        # Of each curve: a faster cylinder drags the substrate along.  What is measured is a size.
        self.signs = np.array([math.copysign(1.0, self._rubbing(each)) for each in self.contacts])
        still = np.zeros(len(self.free))
        # Of each curve: the free inputs on which its model depends at fixed groups.
        self.moving = tuple(tuple(self._changes(curve, still, range(len(self.free)))) for curve in range(len(data.curves)))

    def states(self, definition: Definition, rtol: float, on_state: Callable[[], object]) -> States:
        """Return what gives the states, to a tolerance."""
        moves = np.abs(self.exponents[:, :, :3]).max(axis=(0, 1)) > 0
        by = tuple(name for name, is_moved in zip(GROUPS, moves, strict=True) if is_moved)
        # Whether a table holds for all contacts, wherever in its box their states lie.
        is_one = len({each.groups.model for each in self.contacts}) == 1 and self.is_constant and not any(self.moving)
        in_atlas = is_one and self.is_far and atlas.for_groups(self.contact.groups) is not None
        return States(self.contact, by, in_atlas, definition, rtol, on_state)

    def count_states(self, rtol: float) -> int:
        """Return how many states are solved for all rows at one place."""
        speeds = [np.unique(self.data.values[self.data.curve == curve])[::-1] for curve in np.unique(self.data.curve)]
        return sum(map(len, speeds)) if any(self.remembers) else sum(len(places(each, rtol)) for each in speeds)

    def rtol_of_states(self, rtol: float, relative_noise: Array | float = math.inf) -> float:
        """Return the tolerance of solved states, given that of the case and the relative noise of each row if it is known."""
        if self.contact.groups.geometry == "line":  # which takes milliseconds at any tolerance
            return rtol
        low, high = BALL_RTOL
        with np.errstate(divide="ignore"):
            standard_error = np.sum(np.broadcast_to(relative_noise, len(self.data)) ** -2.0) ** -0.5
        return max(rtol, min(max(low, ERROR_SHARE * float(standard_error)), high))

    @property
    def rule(self) -> FrictionRule:
        """What friction is made of, found by name, so that fits can be pickled."""
        return RULES[self.contact.groups.geometry]

    def _changes(self, curve: int, theta: Array, of: Iterable[int], speed: float | None = None) -> Changes:
        """Return what each of some free inputs changes of the model of a curve, those that change nothing left out."""
        contact, found = self.contact_of(curve, theta, speed), dict[int, Change]()
        for k in of:
            free = self.free[k]
            if not free.acts_on(curve) or getattr(contact, free.name, None) is None:
                continue
            beside = models_at_both_sides(contact, free.name)
            if beside is not None:
                found[k] = beside
        return found

    def _parts(self, theta: Array, x: Array, curve: Indices, values: Array, states: States) -> FrictionParts:
        """Return the parts of the friction of all rows, those with different models on their own."""
        groups: list[tuple[Physics, Changes, Inputs | None, list[Indices]]] = []
        for c in np.unique(curve).tolist():
            own, moving, remembers = np.nonzero(curve == c)[0], self.moving[c], self.remembers[c]
            for rows in own[:, None] if remembers else own[None]:
                speed = float(values[rows[0]]) if remembers else None
                moved = moving or remembers
                here = self.contact_of(c, theta, speed) if moved or not self.is_far else self.contacts[c]
                physics = here.groups.physics if moved else self.physics[c]
                inputs: Inputs | None = None if self.is_far else self.rule.of_contact(here)
                changes = self._changes(c, theta, moving, speed) if moved else {}
                same = next((each[3] for each in groups if each[:3] == (physics, changes, inputs)), None)
                if same is None:
                    groups.append((physics, changes, inputs, same := []))
                same.append(rows)
        found = []
        for physics, changes, inputs, several in groups:
            rows = np.concatenate(several)
            rows_of, at = np.unique(x[rows, :3], axis=0, return_inverse=True)  # repeats of a row are one state
            each, at = states.parts(Groups(*rows_of.T, **physics), changes, inputs), at.ravel()
            slopes = np.zeros((len(each.values), 3 + len(self.free), len(rows)))
            slopes[:, :3] = each.slopes[:, :3, at]
            slopes[:, [3 + k for k in changes]] = each.slopes[:, 3:, at]
            found.append((rows, FrictionParts(each.values[:, at], slopes, each.errors[:, at])))
        return together(found)

    def _read(self, theta: Array, x: Array, states: States) -> FrictionParts:
        """Return the parts of all measured rows, with slopes along the inputs alone, read between curves that are solved."""
        found = []
        for c, A in enumerate(self._exponents_of_curves(theta)[..., :3]):
            rows = np.nonzero(self.data.curve == c)[0]
            moves = np.abs(A).max(axis=1, initial=0.0) > 0
            moves[list(self.moving[c])] = True

            def solved(A: Array = A, rows: Indices = rows) -> FrictionParts:
                each = self._parts(theta, x[rows], self.data.curve[rows], self.data.values[rows], states)
                return replace(each, slopes=np.einsum("kd,pdn->pkn", A, each.slopes[:, :3]) + each.slopes[:, 3:])

            each = states.curve(c, theta[moves], np.nonzero(moves)[0], solved)
            none = np.zeros((len(each.values), 3, len(rows)))
            found.append((rows, replace(each, slopes=np.concatenate([none, each.slopes], axis=1))))
        return together(found)

    def _exponents_of_curves(self, theta: Array) -> Array:
        """Return the exponents of each curve near a set of free inputs."""
        return self._exponents_at(self._contacts_at(theta)) if self.bends else self.exponents

    def _contacts_at(self, theta: Array) -> list[Contact]:
        """Return the contacts of all curves at a set of free inputs, at the unit of speed."""
        return [self.contact_of(curve, theta, self.unit) for curve in range(len(self.contacts))]

    def _exponents_at(self, contacts: Sequence[Contact]) -> Array:
        """Return the exponents with which each free input enters the groups, boundary_friction and what else there is."""
        found = np.zeros((len(contacts), len(self.free), 4 + len(self.rule.inputs)))
        for curve, contact in enumerate(contacts):
            known = exponents_of(contact) if self.bends else contact.INPUTS.exponents
            for k, free in enumerate(self.free):
                if free.acts_on(curve):
                    found[curve, k] = np.sum([self._exponents_of(name, known) for name in free.names], axis=0)
        return found

    def _exponents_of(self, free: str, known: Mapping[str, tuple[float, float, float]]) -> list[float]:
        """Return the exponents with which one input enters them, given those of the groups."""
        speed, load, roughness = known.get(free, (0.0, 0.0, 0.0))
        if free != "viscosity":
            speed += self.rule.exponents_at(self.data.abscissa).get(free, 0.0)
        row = [speed, load, roughness, free == "boundary_friction"]
        return [*row, *((free == name) + self.rule.exponents.get(name, {}).get(free, 0.0) for name in self.rule.inputs)]

    def _logs_at(self, contacts: Sequence[Contact], curve: Indices, values: Array) -> Array:
        """Return the logarithms of groups, boundary_friction and beta of contacts at any places of the abscissa."""
        rows = np.empty((len(contacts), 4 + len(self.rule.inputs)))
        for i, contact in enumerate(contacts):
            g, others = contact.groups, self.rule.of_contact(contact)
            speed = float(g.speed) / self.unit * self.rule.speed_per(self.data.abscissa, contact)
            rows[i] = (speed, float(g.load), float(g.roughness), 1.0, *others.values())
        with np.errstate(divide="ignore"):
            found = np.log(rows)[curve]
        found[:, 0] += np.log(values)
        found[:, 3] = self._log_rubbing(contacts, curve, values)
        return np.asarray(found)

    def _log_rubbing(self, contacts: Sequence[Contact], curve: Indices, values: Array) -> Array:
        """Return the logarithms of the factor of the friction of asperities at places of the abscissa."""
        found = np.empty(len(values))
        for c in np.unique(curve).tolist():
            contact, own = contacts[c], curve == c
            speeds = values[own] * self.rule.speed_per(self.data.abscissa, contact)
            found[own] = abs(self._rubbing(contact)) * contact.friction_of_asperities.factors(contact, speeds)
        with np.errstate(divide="ignore"):
            return np.asarray(np.log(found))

    def _rubbing_exponents(self, theta: Array, curve: Indices, values: Array) -> Array:
        """Return the exponents with which the free inputs enter the factor of the friction of asperities at each row."""
        found = np.zeros((len(values), len(self.free)))
        for k, free in enumerate(self.free):
            ends = np.clip(theta[k] + LOG_STEP * np.array([-1.0, 1.0]), free.low, free.high)
            moved = [theta + (end - theta[k]) * (np.arange(len(theta)) == k) for end in ends]
            less, more = (self._log_rubbing(self._contacts_at(each), curve, values) for each in moved)
            found[:, k] = (more - less) / (ends[1] - ends[0])
        return found

    def _rubbing(self, contact: Contact) -> float:
        return float(self.rule.sliding_factor(contact.groups, self.rule.of_contact(contact)))

    def contact_of(self, curve: int, theta: Array, speed: float | None = None) -> Contact:
        """Return the contact of a curve at a set of free inputs, at a speed, by default that of the case."""
        factors: dict[str, float] = {}
        for free, t in zip(self.free, theta.tolist(), strict=True):
            if free.acts_on(curve):
                factors |= dict.fromkeys(free.names, math.exp(t))
        contact = self.contacts[curve]
        values = {name: getattr(contact, name, None) for name in factors}
        return contact.replace(
            speed=self.contact.speed if speed is None else speed,
            **{name: value * factors[name] for name, value in values.items() if value is not None},
        )

    def read(self, theta: Array, definition: Definition) -> Array:
        """Return the friction of all rows at many places at once, off the atlas."""
        x = np.exp(self.logs + np.einsum("mp,npk->mnk", theta, self.exponents[self.data.curve]))
        physics = self.contact.groups.physics
        inside = atlas.covers(Groups(x[..., 0], x[..., 1], x[..., 2], **physics)).all(axis=1)
        found = np.full(x.shape[:2], np.nan)
        if inside.any():
            x = x[inside]
            groups = Groups(x[..., 0], x[..., 1], x[..., 2], **physics)
            inputs = dict(zip(self.rule.inputs, np.moveaxis(x[..., 4:], -1, 0), strict=True))
            contact, viscous = (term.reshape(groups.shape) for term in atlas.friction_terms(groups, inputs, definition))
            found[inside] = np.abs(self.signs[self.data.curve] * x[..., 3] * contact + viscous)
        return found

    def predict(self, theta: Array, states: States, at: tuple[Indices, Array] | None = None) -> Prediction:
        """Return the friction at logarithms of factors."""
        curve, values = (self.data.curve, self.data.values) if at is None else at
        A = self._exponents_of_curves(theta)[curve]
        if self.bends:
            x = np.exp(self._logs_at(self._contacts_at(theta), curve, values))
            if not self.is_constant:
                A[..., 3] = self._rubbing_exponents(theta, curve, values)
        else:
            logs = self.logs if at is None else self._logs_at(self.contacts, curve, values)
            x = np.exp(logs + np.einsum("p,npk->nk", theta, A))
        is_read = at is None and not states.uses_atlas
        found = self._read(theta, x, states) if is_read else self._parts(theta, x, curve, values, states)
        names = self.rule.parts(states.definition)
        parts, inputs = dict(zip(names, found.values[1:-1], strict=True)), dict(zip(self.rule.inputs, x[:, 4:].T, strict=True))
        fixed = {"far": far_film(self.model), "model": self.model}
        # By the logarithms of the groups, by the numbers of the model, and by the logarithms of the inputs.
        known = len(found.slopes[0])
        of_inputs = np.zeros((len(inputs), len(x)))
        by_part = (np.vstack([each, of_inputs]) for each in found.slopes[1:-1])
        moved = {name: Dual(part, slopes) for (name, part), slopes in zip(parts.items(), by_part, strict=True)}
        speed, load = by_logarithms(x[:, :2].T, known + len(inputs))
        taken = dict(zip(inputs, by_logarithms(inputs.values(), known + len(inputs), known), strict=True))
        viscous = self.rule.viscous(moved, speed, load, {**taken, **fixed}, states.definition)
        rubbing = self.signs[curve] * x[:, 3]
        contact, fluid = rubbing * found.values[0], viscous.value
        slopes = np.vstack([rubbing * found.slopes[0], of_inputs]) + viscous.slope
        by_model = np.zeros((len(x), len(self.free)))
        by_model[:, : known - 3] = slopes[3:known].T
        jacobian = np.einsum("kn,npk->np", np.array([*slopes[:3], contact, *slopes[known:]]), A) + by_model
        errors = dict(zip(names, found.errors[1:-1], strict=True))
        return Prediction(
            friction=np.abs(contact + fluid),
            jacobian=np.copysign(1.0, contact + fluid)[:, None] * jacobian,
            contact_share=friction_share(contact, fluid),
            load_share=found.values[-1],
            error=x[:, 3] * found.errors[0]
            + self.rule.viscous_error(parts, errors, x[:, 0], x[:, 1], {**inputs, **fixed}, states.definition),
        )
