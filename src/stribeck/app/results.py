"""The answer to a tab's inputs: the solved state, the curve through it, the phase diagram around it, the next transitions.

The state is solved anew for each change, from the last one. Curve and diagram are read off the atlas, and kept until something
other than the speed changes; outside the atlas the curve is solved.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeVar

import numpy as np

from .. import atlas
from .._types import Array
from ..asymptotics import FORMULAS
from ..atlas_curve import ERROR
from ..atlas_phase import transition_speeds
from ..curve import stribeck_curve
from ..near import NearSolver
from ..parameters import Groups, LineContact
from ..regimes import BOUNDARY_FLUID_SHARE, HYDRODYNAMIC_CONTACT_SHARE, Regime, regime_of
from ..solution import DEFINITIONS, Definition, Profile, Solution
from ..solve import SolveError
from ..units import InputError
from .inputs import FIELDS, Inputs

__all__ = ["Answer", "Curve", "Diagram", "Model", "Thin", "Transition"]

RTOL = 1e-6
POINTS = 121
SOLVED_POINTS = 41
ROWS = 31
"""Points of a curve, of one that is solved, and roughnesses of a diagram."""

MOST_KEPT = 64
ABSENT = 0.01
"""Share of the load below which asperities, or the fluid, count as absent for the formulas without them."""

FIELDS_DRAWN = ("gap", "pressure", "contact_pressure", "fluid_pressure")

STEPS = (1.0, 1.5, 2.0, 3.0, 5.0, 7.0, 10.0)
"""Numbers at which axes end, times powers of ten: few, so that axes rest while a slider moves."""

T = TypeVar("T")


@dataclass(frozen=True)
class Transition:
    """Where along the speed a regime ends.

    Attributes
    ----------
    name : str
        ``"boundary"``, ``"hydrodynamic"`` or ``"minimum"``.
    speed : float
        Speed there [m/s].
    error : float
        Relative error of the speed; nan where it is not known [-].
    """

    name: str
    speed: float
    error: float


@dataclass(frozen=True, eq=False)
class Curve:
    """Friction along the speed.

    Attributes
    ----------
    speed : ndarray, shape (n,)
        Speeds [m/s].
    friction : mapping of str to ndarray
        Friction coefficient by definition [-].
    contact : ndarray, shape (n,)
        Part of it from asperities [-].
    transitions : tuple of Transition
        Those on it, and those beyond its ends.
    source : str
        Where it comes from, with its error.
    stale : bool
        Whether it belongs to inputs before the present ones.
    """

    speed: Array
    friction: Mapping[Definition, Array]
    contact: Array
    transitions: tuple[Transition, ...]
    source: str
    stale: bool = False

    def transition(self, name: str) -> Transition | None:
        """Return the transition of a name, or None."""
        return next((mark for mark in self.transitions if mark.name == name), None)


@dataclass(frozen=True, eq=False)
class Diagram:
    """Regimes over speed and roughness at the load of the contact.

    Attributes
    ----------
    roughness : ndarray, shape (n,)
        Roughnesses [m].
    boundary, hydrodynamic, minimum : ndarray, shape (n,)
        Speeds at which boundary lubrication ends, hydrodynamic lubrication begins and friction is least; zero, infinite or nan
        where there are none [m/s].
    message : str
        Why there is no diagram, or empty.
    """

    roughness: Array
    boundary: Array
    hydrodynamic: Array
    minimum: Array
    message: str = ""


@dataclass(frozen=True, eq=False)
class Thin:
    """An asymptotic field where it is in its range.

    Attributes
    ----------
    name : str
        The formula.
    worst : float
        Its largest relative error in its range.
    predicts : str
        The field.
    x, value : ndarray
        In Hertz units.
    """

    name: str
    worst: float
    predicts: str
    x: Array
    value: Array


@dataclass(frozen=True, eq=False)
class Answer:
    """All that a tab shows.

    Attributes
    ----------
    inputs : Inputs
        What was asked.
    solution : Solution
        The state.
    regime : str
        Its regime.
    curve : Curve or None
        The curve through it, None where it cannot be solved.
    diagram : Diagram
        The phase diagram around it.
    reach : float
        How far the profile is drawn to both sides [a].
    profile : Profile
        The fields, in Hertz units.
    thin : tuple of Thin
        Asymptotic fields.
    speeds : tuple of float
        Ends of the axis of speeds [m/s].
    """

    inputs: Inputs
    solution: Solution
    regime: Regime
    curve: Curve | None
    diagram: Diagram
    reach: float
    profile: Profile
    thin: tuple[Thin, ...]
    speeds: tuple[float, float]


class Model:
    """Answers the inputs of one tab, one after another."""

    def __init__(self) -> None:
        self._solve = NearSolver(RTOL)
        self._kept: dict[Any, Any] = {}
        self._last_solved: Curve | None = None

    def __call__(self, inputs: Inputs) -> Answer:
        """Return the answer at once; outside the atlas with the last curve, marked stale, until :meth:`settle` solved its own.

        Parameters
        ----------
        inputs : Inputs
            What is asked.

        Returns
        -------
        Answer
            The answer.

        Raises
        ------
        InputError, SolveError
            Where the state cannot be solved.
        """
        contact, definition = inputs.contact, inputs.definition
        solution = self._solve(contact)
        friction = solution.friction(definition=definition)
        part = friction.contact / friction.total if friction.total > 0 else 0.0
        curve, speeds = self._curve_now(contact, definition)
        decade = _decade_of_roughness(contact)
        key = ("diagram", _key(contact.replace(roughness=1.0)), definition, speeds, decade)
        diagram = self._keep(key, lambda: _diagram(contact, definition, speeds, decade))
        reach = profile_reach(solution)
        x = np.linspace(-reach, reach, 241)
        nodes = solution.x[np.abs(solution.x) < reach]
        x = np.unique(np.concatenate([x, nodes[:: 1 + len(nodes) // 150]]))
        return Answer(
            inputs=inputs,
            solution=solution,
            regime=regime_of(solution.fluid_load_share, part),
            curve=curve,
            diagram=diagram,
            reach=reach,
            profile=solution.profile(x),
            thin=tuple(thin_lines(solution, reach)),
            speeds=speeds,
        )

    def settle(self, inputs: Inputs) -> bool:
        """Solve the curve of inputs outside the atlas; tell whether there is something new to show."""
        contact, definition = inputs.contact, inputs.definition
        key = ("solved", _key(contact), definition)
        if in_atlas(contact) or key in self._kept:
            return False
        try:
            self._last_solved = self._keep(key, lambda: _solved_curve(contact, definition))
        except (InputError, SolveError):
            return False
        return True

    def curve(self, contact: LineContact, definition: Definition, speeds: tuple[float, float]) -> Curve | None:
        """Return the curve of a contact between two speeds; outside the atlas the solved one, None until it is solved."""
        if not in_atlas(contact):
            found: Curve | None = self._kept.get(("solved", _key(contact), definition))
            return found
        marks = self._marks(contact, definition)
        return self._keep(("curve", _key(contact), definition, speeds), lambda: _curve(contact, speeds, marks))

    def _marks(self, contact: LineContact, definition: Definition) -> tuple[Transition, ...]:
        return self._keep(("marks", _key(contact), definition), lambda: _marks(contact, definition))

    def _curve_now(self, contact: LineContact, definition: Definition) -> tuple[Curve | None, tuple[float, float]]:
        """Return the curve and the ends of its axis."""
        if in_atlas(contact):
            speeds = axis_speeds(contact, self._marks(contact, definition))
            return self.curve(contact, definition, speeds), speeds
        curve = self.curve(contact, definition, (0.0, 0.0))
        if curve is None and self._last_solved is not None:
            curve = replace(self._last_solved, stale=True, transitions=())
        if curve is None:
            speed = contact.speed or 1e-3
            return None, (1e-4 * speed, 1e4 * speed)
        ends = [float(curve.speed[0]), float(curve.speed[-1]), *([contact.speed] if contact.speed > 0 else [])]
        return curve, (10.0 ** math.floor(math.log10(min(ends))), 10.0 ** math.ceil(math.log10(max(ends))))

    def _keep(self, key: Any, make: Callable[[], T]) -> T:
        if key not in self._kept:
            while len(self._kept) >= MOST_KEPT:
                del self._kept[next(iter(self._kept))]
            self._kept[key] = make()
        found: T = self._kept[key]
        return found


def _key(contact: LineContact) -> tuple[float, ...]:
    """Return all inputs but the speed."""
    return tuple(getattr(contact, name) for name in FIELDS if name != "speed")


def _speed_group(contact: LineContact) -> float:
    """Return the speed group at 1 m/s."""
    return float(contact.replace(speed=1.0).groups.speed)


def in_atlas(contact: LineContact) -> bool:
    """Tell whether the atlas holds the load and the roughness of a contact."""
    load, kappa = float(contact.groups.load), float(contact.groups.relative_roughness)
    low, high = atlas.BOX["relative_roughness"]
    return atlas.BOX["load"][0] <= load <= atlas.BOX["load"][1] and (kappa == 0 or low <= kappa <= high)


def _marks(contact: LineContact, definition: Definition) -> tuple[Transition, ...]:
    """Return the transitions along the speed, ascending, from the atlas."""
    if contact.roughness == 0 or contact.friction_coefficient == 0:
        return ()
    groups, unit = contact.groups, _speed_group(contact)
    mu0, beta = contact.friction_coefficient, contact.beta
    found = transition_speeds(float(groups.load), np.array([float(groups.roughness)]), mu0, beta, definition)
    marks = [
        Transition(name, float(getattr(found, name)[0]) / unit, float(found.error[i, 0]))
        for i, name in enumerate(("boundary", "hydrodynamic", "minimum"))
    ]
    return tuple(sorted((mark for mark in marks if 0 < mark.speed < math.inf), key=lambda mark: mark.speed))


def axis_speeds(contact: LineContact, marks: Sequence[Transition]) -> tuple[float, float]:
    """Return whole decades of speed that hold the contact and its transitions, with room on both sides [m/s]."""
    unit = _speed_group(contact)
    places = [mark.speed for mark in marks] or [1e-8 / unit, 1.0 / unit]
    places += [contact.speed] if contact.speed > 0 else []
    low, high = 10.0 ** math.floor(math.log10(min(places)) - 0.7), 10.0 ** math.ceil(math.log10(max(places)) + 0.7)
    least, most = (end / unit for end in atlas.BOX["speed"])
    return max(low, least), min(high, most)


def _curve(contact: LineContact, speeds: tuple[float, float], marks: tuple[Transition, ...]) -> Curve:
    """Return a curve read off the atlas."""
    groups, unit = contact.groups, _speed_group(contact)
    mu0, beta = contact.friction_coefficient, contact.beta
    speed = np.geomspace(*speeds, POINTS)
    along = Groups(np.clip(speed * unit, *atlas.BOX["speed"]), groups.load, groups.roughness)
    solid = mu0 * np.asarray(atlas.contact_load_share(along))
    friction = {kind: solid + np.asarray(atlas.viscous_friction(along, beta, kind)) for kind in DEFINITIONS}
    return Curve(speed, friction, solid, marks, f"read off the atlas, within {_power(ERROR)}")


def _solved_curve(contact: LineContact, definition: Definition) -> Curve:
    """Return a curve of solved states, with the transitions located on them."""
    found = stribeck_curve(contact, points=SOLVED_POINTS, rtol=1e-4, definition=definition)
    if len(found) < 2:
        raise SolveError(found.outcome, None, found.outcome.value)
    friction = {kind: np.array([s.friction(definition=kind).total for s in found.solutions]) for kind in DEFINITIONS}
    names = {
        f"{BOUNDARY_FLUID_SHARE:.0%} of the load": "boundary",
        f"{HYDRODYNAMIC_CONTACT_SHARE:.0%} of the friction": "hydrodynamic",
    }
    marks = []
    for mark in found.transitions:
        known = next((name for end, name in names.items() if mark.name.endswith(end)), "")
        name = "minimum" if mark is found.minimum else known
        if name and (name != "boundary" or " 5%" in mark.name):
            marks.append(Transition(name, mark.value, math.nan))
    source = f"solved, beyond the atlas; estimated error {_power(found.error_estimate)}"
    return Curve(found.values, friction, found.friction_contact, tuple(marks), source)


def _power(error: float) -> str:
    """Return an error with one digit."""
    mantissa, _, exponent = f"{error:.0e}".partition("e")
    return f"{mantissa}e{int(exponent)}"


def _decade_of_roughness(contact: LineContact) -> int:
    """Return the power of ten at which the diagram's axis of roughness begins; it covers three decades."""
    if contact.roughness == 0:
        return -8
    return math.floor(math.log10(contact.roughness) - 1.0 + 1e-9)


def _diagram(contact: LineContact, definition: Definition, speeds: tuple[float, float], decade: int) -> Diagram:
    roughness = np.geomspace(10.0**decade, 10.0 ** (decade + 3), ROWS)
    none = np.full(ROWS, math.nan)
    load, unit = float(contact.groups.load), _speed_group(contact)
    least, most = atlas.BOX["load"]
    if not least <= load <= most:
        message = f"No phase diagram: the atlas, off which it is read, ends at load group {most:g}; here it is {load:.3g}."
        return Diagram(roughness, none, none, none, message)
    h = roughness * float(contact.replace(roughness=1.0).groups.roughness)
    low, high = atlas.BOX["relative_roughness"]
    inside = np.clip(h, low * load, high * load)
    ends = (max(speeds[0] * unit, atlas.BOX["speed"][0]), min(speeds[1] * unit, atlas.BOX["speed"][1]))
    found = transition_speeds(load, inside, contact.friction_coefficient, contact.beta, definition, ends, narrowings=1)
    boundary, hydrodynamic, minimum = (
        np.where(inside == h, line / unit, math.nan) for line in (found.boundary, found.hydrodynamic, found.minimum)
    )
    return Diagram(roughness, boundary, hydrodynamic, minimum)


def round_up(value: float) -> float:
    """Return the next larger of the numbers at which axes end."""
    power = 10.0 ** math.floor(math.log10(value))
    return float(f"{next(step for step in STEPS if step * power >= value * (1 - 1e-9)) * power:.6g}")


def round_down(value: float) -> float:
    """Return the next smaller of the numbers at which axes end."""
    power = 10.0 ** math.floor(math.log10(value))
    return float(f"{next(step for step in STEPS[::-1] if step * power <= value * (1 + 1e-9)) * power:.6g}")


def profile_reach(solution: Solution) -> float:
    """Return how far the profile is drawn to both sides: as far as the pressures reach, to a round number of metres [a]."""
    pressure = np.abs(solution.contact_pressure) + np.abs(solution.fluid_pressure)
    reach = max(1.6, 1.25 * float(np.abs(solution.x[pressure > 0.02 * pressure.max()]).max(initial=0.0)))
    a = 1.0 if solution.contact is None else solution.contact.hertz.half_width
    return round_up(a * reach) / a


def thin_lines(solution: Solution, reach: float) -> list[Thin]:
    """Return the asymptotic fields whose range holds the state.

    Parameters
    ----------
    solution : Solution
        The state.
    reach : float
        How far the profile is drawn [a].

    Returns
    -------
    list of Thin
        Those of rough contacts, and those of smooth ones, or of contacts at rest, where asperities, or the fluid, carry less
        than :data:`ABSENT` of the load.
    """
    groups = solution.groups
    absent = {"smooth": solution.contact_load_share, "rest": solution.fluid_load_share, "mixed": 0.0}
    found = []
    for formula in FORMULAS:
        if formula.predicts not in FIELDS_DRAWN or formula.interval is None or absent[formula.plane] >= ABSENT:
            continue
        if not bool(formula.valid(groups)):
            continue
        low, high = formula.interval(groups)
        x = np.linspace(max(low, -reach), min(high, reach), 121)
        if formula.predicts == "gap" and formula.plane == "rest" and low < 0 < high:
            x = x[1:-1]
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            value = np.asarray(formula(groups, x))
        if np.isfinite(value).all():
            found.append(Thin(formula.name, formula.worst, formula.predicts, x, value))
    return found
