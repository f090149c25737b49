"""What a formula is: a function of the groups that knows its range, the order of its error, and its source.

There is no physics here.  Outside its range a formula still returns a value, with an :class:`OutOfRangeWarning`;
where it has no value it returns nan, with a warning.
"""

from __future__ import annotations

import functools
import inspect
import math
import textwrap
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from typing import Annotated, Any, Concatenate, Generic, Literal, ParamSpec

import numpy as np

from stribeck._types import Array, Flags
from stribeck.asymptotics.constants import BALL_FILM_CONSTANT, FILM_CONSTANT
from stribeck.asymptotics.documentation import VALUES, choices, completed, described
from stribeck.contact_laws.law import AsperityLaw, is_exponential
from stribeck.contacts.contact import model_words
from stribeck.contacts.groups import BASE_MODEL, Geometry, Groups
from stribeck.quantities.docstrings import Described
from stribeck.quantities.lazy import cached_property
from stribeck.quantities.units import InputError, checked_word, real_array, show

Value = float | Array
Arguments = ParamSpec("Arguments")
Plane = Literal["smooth", "rest", "mixed"]
GROUPS = ("speed", "load", "roughness")


def coefficient(name: str, value: Any) -> float:
    """Return a coefficient of the friction; refuse anything but a finite number that is zero or positive."""
    found = real_array(name, value)
    if found.ndim != 0 or not 0 <= found < math.inf:
        raise InputError(f"{name} = {show(value)}; it must be one finite number, zero or positive.")
    return float(found)


def second(terms: int) -> int:
    """Return 1 if the second term is asked for, else 0."""
    if terms not in (1, 2):
        raise InputError(f"terms = {show(terms)}; it must be 1 or 2.")
    return int(terms) - 1


class OutOfRangeWarning(UserWarning):
    """A formula was used outside its range, or has no value there."""


def checked_load(load: Value, geometry: Geometry) -> Value:
    """Return the load of phi as groups check it; warn where the contact at rest has no positive gap."""
    found = Groups(0.0, load, 0.0, geometry=geometry).load
    if np.any(np.greater_equal(found, 1)):
        message = "phi is undefined (nan) at load groups of 1 or more, where the static contact has no positive gap."
        warnings.warn(message, OutOfRangeWarning, stacklevel=3)
    return found


def _ratio(numerator: Value, denominator: Value) -> Value:
    """Return a quotient, infinite where the denominator is zero."""
    with np.errstate(all="ignore"):
        return np.where(np.equal(denominator, 0), np.inf, np.divide(numerator, denominator))


def fluid_number(groups: Groups) -> Value:
    """Return lambda/kappa**2, in an order that does not overflow: inf without roughness, nan if at rest too."""
    kappa = groups.relative_roughness
    with np.errstate(all="ignore"):
        return np.divide(np.divide(groups.speed, kappa), kappa)


def _film_ratio(groups: Groups) -> Value:
    """Return the smooth film of the geometry over the length of the contact law."""
    constant = FILM_CONSTANT if groups.geometry == "line" else BALL_FILM_CONSTANT
    return _ratio(constant * groups.speed**0.6, groups.relative_roughness)


def _slow_share(groups: Groups) -> Value:
    """Return an estimate of the load share of the fluid under a slow ball, infinite from load 1 on."""
    A = np.maximum(-np.log(groups.load), 0) / 3
    with np.errstate(all="ignore"):
        return _ratio(0.016 * np.square(fluid_number(groups)), (A * (1 + 0.73 * A)) ** 3)


def _paper_fluid_share(groups: Groups) -> Value:
    """Return the load share of the fluid as estimated in [BP], infinite from load 1 on."""
    with np.errstate(all="ignore"):
        return _ratio(0.5 * np.square(fluid_number(groups)), np.maximum(-np.log(groups.load), 0) ** 5)


PARAMETERS: dict[str, Callable[[Groups], Value]] = {
    "speed": lambda g: g.speed,
    "load": lambda g: g.load,
    "relative_roughness": lambda g: g.relative_roughness,
    "1/speed": lambda g: _ratio(1.0, g.speed),
    "1/relative_roughness": lambda g: _ratio(1.0, g.relative_roughness),
    "fluid_number": fluid_number,
    "paper_fluid_share": _paper_fluid_share,
    "film_ratio": _film_ratio,
    "slow_share": _slow_share,
}
r"""Parameters in which ranges and errors are stated: the groups, kappa, the fluid number lambda/kappa**2 (lubrication pressure
on the scale of the roughness over Hertz pressure), the fluid's load share at slow speed as [BP] estimate it,
(lambda**2/kappa**4)/(2 (-ln F)**5), and the film ratio c lambda**(3/5)/kappa (smooth film over h_rms/alpha, with the
constant c of the geometry), and roughly the fluid's load share under a slow ball."""

# Parameter of a range that is not of the groups: coefficients enter the relative error of friction as this ratio.
COEFFICIENT_RATIO = "beta/mu0"


@dataclass(frozen=True)
class Limit(Described):
    """Closed interval of one parameter."""

    parameter: Annotated[str, "key of :data:`PARAMETERS`, or :data:`COEFFICIENT_RATIO`"]
    low: Annotated[float, "lower end"] = 0.0
    high: Annotated[float, "upper end"] = math.inf

    def holds(self, groups: Groups, ratio: Value = 1.0) -> Flags:
        """Return where the parameter lies in the interval, for groups and for coefficients of this ratio beta/mu0."""
        value = ratio if self.parameter == COEFFICIENT_RATIO else PARAMETERS[self.parameter](groups)
        return np.asarray((self.low <= value) & (value <= self.high))

    def __str__(self) -> str:
        """Return the interval in words."""
        name = self.parameter.replace("_", " ")
        if math.isinf(self.high):
            return f"{name} from {self.low:g}"
        return f"{name} {self.low:g} to {self.high:g}"


@dataclass(frozen=True, eq=False)
class Formula(Described, Generic[Arguments]):
    """A formula: call it with :class:`~stribeck.Groups`, of floats or of arrays that broadcast."""

    function: Annotated[Callable[Concatenate[Groups, Arguments], Value], "the formula without any check of its range"]
    predicts: Annotated[str, "the quantity of a solved state that it predicts, a key of :data:`evidence.formulas.MEASURED`"]
    plane: Annotated[Plane, "smooth contact (roughness 0, whatever the groups say), contact at rest (speed 0), or both"]
    limits: Annotated[tuple[Limit, ...], "its range"]
    worst: Annotated[float, "largest relative error in this range, measured"]
    source: Annotated[str, "its source"]
    small: Annotated[str, "parameter with which the error vanishes, a key of :data:`PARAMETERS`; empty for a fit"] = ""
    error_order: Annotated[float, "the relative error goes as ``small**error_order``"] = 0.0
    geometry: Annotated[Geometry, "whether it is about the cylinder or about the ball"] = "line"
    uses: Annotated[tuple[str, ...], "the groups on which its value depends"] = GROUPS

    @property
    def module(self) -> str:
        """The module, as an attribute of ``stribeck.asymptotics``: ``hydrodynamic``, or ``point.film`` of the ball."""
        module = self.function.__module__.rpartition(".")[2]
        return module if self.geometry == "line" else f"point.{module}"

    @property
    def name(self) -> str:
        """Module and name, such as ``hydrodynamic.friction``."""
        return f"{self.module}.{self.function.__name__}"

    @property
    def range(self) -> str:
        """The range in words."""
        return ", ".join(map(str, self.limits)) or "everywhere"

    @property
    def evidence(self) -> str:
        """Where it holds, how far it errs there, and where it is from, in words."""
        power = f" as ({self.small.replace('_', ' ')})**({Fraction(self.error_order).limit_denominator(12)})"
        falls = f", and falls{power.removesuffix('**(1)')}" if self.small else ""
        where = f"Range: {self.range}; the error there is at most {100 * self.worst:g} %{falls}."
        return "\n\n".join(textwrap.fill(each, 100, break_on_hyphens=False) for each in (where, f"Source: {self.source}."))

    @described("Of the shape of the groups.", kind="ndarray of bool", groups="States.")
    def valid(self, groups: Groups, boundary_friction: float = 1.0, beta: float = 1.0) -> Flags:
        """Return where all limits hold: nowhere for groups of the other geometry or of another model."""
        found = np.full(groups.shape, groups.geometry == self.geometry and groups.model == BASE_MODEL)
        for limit in self.limits:
            found = found & limit.holds(groups, _ratio(beta, boundary_friction))
        return found

    def __call__(self, groups: Groups, *args: Arguments.args, **kwargs: Arguments.kwargs) -> Value:
        """Return the value, and warn where it is outside the range or missing; refuse another law than the exponential one."""
        if not isinstance(groups, Groups):
            raise InputError(f"groups = {show(groups)}; give Groups(speed, load, roughness), or contact.groups.")
        self._check_groups(groups)
        call = self._signature.bind(groups, *args, **kwargs)
        for name, value in call.arguments.items():
            if name in ("boundary_friction", "beta"):
                call.arguments[name] = coefficient(name, value)
            elif name in ("x", "share"):
                call.arguments[name] = real_array(name, value)[()]
            else:
                self._check_option(name, value)
        with np.errstate(divide="ignore", invalid="ignore", over="ignore", under="ignore"):
            value = self.function(*call.args, **call.kwargs)
        given = {name: call.arguments[name] for name in ("boundary_friction", "beta") if name in call.arguments}
        if np.isnan(value).any():
            self._warn("is undefined (nan)")
        elif not np.all(self.valid(groups, **given)):
            self._warn("is used")
        return value

    @cached_property
    def _signature(self) -> inspect.Signature:
        return inspect.signature(self.function)

    def _check_option(self, name: str, value: Any) -> None:
        """Refuse a switch that is neither on nor off, several options at once, and an unknown word."""
        argument = self._signature.parameters[name]
        if isinstance(argument.default, bool) and not isinstance(value, bool | np.bool_):
            raise InputError(f"{name} = {show(value)}; it must be True or False.")
        if isinstance(argument.default, int | str) and isinstance(value, np.ndarray):
            raise InputError(f"{name} = {show(value)}; it must be one value for all states.")
        words = choices(self.function, argument)
        if words:
            checked_word(name, value, words)

    def _check_groups(self, groups: Groups) -> None:
        """Refuse groups of the other geometry or another model, and of a law for which the formula was not derived."""
        if groups.geometry != self.geometry:
            bodies = {"line": "a cylinder", "point": "a ball"}
            raise InputError(
                f"{self.name} is about {bodies[self.geometry]}, and geometry = {groups.geometry!r} is "
                f"{bodies[groups.geometry]}; stribeck.asymptotics.point holds the formulas of the ball."
            )
        if groups.model != BASE_MODEL:
            raise InputError(
                f"{self.name} holds for a Newtonian fluid that does not cavitate, on a half-space, and these groups have "
                f"another model ({model_words(groups, None)}); use solve."
            )
        if groups.law is not None and not self.holds_for(groups.law):
            raise InputError(f"{self.name} holds for the exponential contact law, not for {groups.law.name}; use solve.")

    @described("Whether it holds.", kind="bool", law="The law; None is the exponential one.")
    def holds_for(self, law: AsperityLaw | None) -> bool:
        """Return whether the formula was derived for a contact law; one of smooth contacts holds for every law."""
        return self.plane == "smooth" or is_exponential(law)

    def _warn(self, what: str) -> None:
        # One text for all values, so that Python's default filter shows it once.
        warnings.warn(f"{self.name} {what} outside its range: {self.range}.", OutOfRangeWarning, stacklevel=3)


def formula(
    *, predicts: str = "", undefined: str = "", **entry: Any
) -> Callable[[Callable[Concatenate[Groups, Arguments], Value]], Formula[Arguments]]:
    """Return the decorator that makes a function a :class:`Formula`, of which ``entry`` are the other attributes.

    ``predicts`` is by default the quantity with which the name of the function begins; ``undefined`` states where the value
    is nan.  What the docstring leaves out is filled in, see :mod:`stribeck.asymptotics.documentation`.
    """

    def decorate(function: Callable[Concatenate[Groups, Arguments], Value]) -> Formula[Arguments]:
        quantity = predicts or max((each for each in VALUES if function.__name__.startswith(each)), key=len)
        made = Formula(function, quantity, **entry)
        if function.__doc__ is not None:  # as it is under `python -OO`
            function.__doc__ = completed(function, quantity, made.uses, made.geometry, undefined, made.evidence)
        kept: dict[str, object] = {name: getattr(function, name) for name in functools.WRAPPER_ASSIGNMENTS}
        vars(made).update(kept, __wrapped__=function)
        return made

    return decorate
