"""The answer to a tab's inputs: the solved state with its fields, the curve through it and the phase diagram around it.

The state is solved anew for each change, from the last one. Curve and diagram are kept until something other than the speed
changes.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, TypeVar

import numpy as np

from stribeck._types import Array
from stribeck.asymptotics import FORMULAS
from stribeck.contacts.friction import Definition
from stribeck.contacts.line import LineContact
from stribeck.curves.regime import Regime, regime_of
from stribeck.explorer.curves import (
    Curve,
    Diagram,
    Transition,
    axis_speeds,
    curve_from_atlas,
    decade_of_roughness,
    diagram_from_atlas,
    in_atlas,
    solved_curve,
    transition_marks,
)
from stribeck.explorer.inputs import FIELDS, Inputs
from stribeck.quantities.units import InputError
from stribeck.solver.nearby import WarmStartSolver
from stribeck.solver.solution import Profile, Solution
from stribeck.solver.solve import SolveError

__all__ = ["Answer", "Answerer", "AsymptoticField", "profile_reach", "round_down", "round_up", "asymptotic_fields"]

RTOL = 1e-6
MOST_KEPT = 64
ABSENT = 0.01
"""Share of the load below which asperities, or the fluid, count as absent for the formulas without them."""

FIELDS_DRAWN = ("gap", "pressure", "contact_pressure", "fluid_pressure")

STEPS = (1.0, 1.5, 2.0, 3.0, 5.0, 7.0, 10.0)
"""Numbers at which axes end, times powers of ten: few, so that axes rest while a slider moves."""

T = TypeVar("T")


@dataclass(frozen=True, eq=False)
class AsymptoticField:
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
    thin : tuple of AsymptoticField
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
    thin: tuple[AsymptoticField, ...]
    speeds: tuple[float, float]


class Answerer:
    """Answers the inputs of one tab, one after another."""

    def __init__(self) -> None:
        self._solve = WarmStartSolver(RTOL)
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
        if self._solve.rtol != inputs.rtol:
            self._solve = WarmStartSolver(inputs.rtol)
        solution = self._solve(contact)
        friction = solution.friction(definition=definition)
        part = friction.contact / friction.total if friction.total > 0 else 0.0
        curve, speeds = self._curve_now(contact, definition)
        decade = decade_of_roughness(contact)
        key = ("diagram", _key(contact.replace(roughness=1.0)), definition, speeds, decade)
        diagram = self._keep(key, lambda: diagram_from_atlas(contact, definition, speeds, decade))
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
            thin=tuple(asymptotic_fields(solution, reach)),
            speeds=speeds,
        )

    def settle(self, inputs: Inputs) -> bool:
        """Solve the curve of inputs outside the atlas; tell whether there is something new to show."""
        contact, definition = inputs.contact, inputs.definition
        key = ("solved", _key(contact), definition)
        if in_atlas(contact) or key in self._kept:
            return False
        try:
            self._last_solved = self._keep(key, lambda: solved_curve(contact, definition))
        except (InputError, SolveError):
            return False
        return True

    def curve(self, contact: LineContact, definition: Definition, speeds: tuple[float, float]) -> Curve | None:
        """Return the curve of a contact between two speeds; outside the atlas the solved one, None until it is solved."""
        if not in_atlas(contact):
            found: Curve | None = self._kept.get(("solved", _key(contact), definition))
            return found
        marks = self._marks(contact, definition)
        return self._keep(("curve", _key(contact), definition, speeds), lambda: curve_from_atlas(contact, speeds, marks))

    def _marks(self, contact: LineContact, definition: Definition) -> tuple[Transition, ...]:
        return self._keep(("marks", _key(contact), definition), lambda: transition_marks(contact, definition))

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


def _key(contact: LineContact) -> tuple[Any, ...]:
    """Return all inputs but the speed."""
    return (contact.law, *(getattr(contact, name) for name in FIELDS if name != "speed"))


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


def asymptotic_fields(solution: Solution, reach: float) -> list[AsymptoticField]:
    """Return the asymptotic fields whose range holds the state.

    Parameters
    ----------
    solution : Solution
        The state.
    reach : float
        How far the profile is drawn [a].

    Returns
    -------
    list of AsymptoticField
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
            found.append(AsymptoticField(formula.name, formula.worst, formula.predicts, x, value))
    return found
