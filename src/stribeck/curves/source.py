"""Where the numbers of a curve come from: what a path of solved states, or the atlas, tells at any place along it."""

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Self

import numpy as np

from stribeck._types import Array
from stribeck.contacts.friction import Definition, Friction, FrictionArray
from stribeck.curves.coordinate import Coordinate
from stribeck.quantities.lazy import cached_property
from stribeck.quantities.outcome import Outcome
from stribeck.quantities.results import ByValue, Card, Shown, brief_text
from stribeck.solver.path.hermite_path import HermitePath
from stribeck.solver.path.path import SolvedPath

Coefficients = tuple[Any, float, Definition]
"""boundary_friction or another friction of asperities, beta, and the definition of the viscous friction."""

Parts = tuple[Array, Array, Array]
"""The load share of the fluid and both parts of the friction, of asperities and of the fluid."""

INTERVAL_FRACTIONS = 0.5 - 0.5 * np.cos(np.pi * np.arange(9) / 9)  # Places of an interval between which events are looked for


@dataclass(frozen=True, eq=False)
class Readings:
    """Observables at several places of a curve, with their errors, friction and solutions."""

    names: tuple[str, ...]  # Of the observables that have errors
    values: Mapping[str, Array]
    relative_errors: Array  # Estimated, absolute for the load shares, shape (n, names)
    position_error: Array  # Estimated absolute error of the position of the minimum gap
    error_estimate: float  # The largest error, as a solution states it
    terms: Callable[..., Array]  # Gives what :meth:`friction_terms` does, of these readings
    made: Callable[[], Iterable[Any]] = tuple  # Gives a solution for each place; none where no states are solved

    def friction_terms(self, boundary_friction: Any, beta: float, definition: Definition) -> Array:
        """Return the friction of asperities and fluid, their sum and its error, shape (n, 4), for other coefficients."""
        return self.terms(self, boundary_friction, beta, definition)

    @cached_property
    def solutions(self) -> tuple[Any, ...]:
        """A solution for each place; empty where no states are solved."""
        return tuple(self.made())


class Source(ABC):
    """The numbers along a coordinate, off a path of solved states if nothing else; places are logarithms of what varies."""

    coordinate: Coordinate
    rtol: float  # Relative tolerance of the observables
    path: SolvedPath | HermitePath  # A path of Taylor series, or of solved states with their slopes
    has_state_slopes = False  # Whether states that are solved tell the slope of the friction better than :meth:`slopes`

    @property
    def outcome(self) -> Outcome:
        """CONVERGED, or why the path ends early."""
        return self.path.outcome

    @property
    def ends(self) -> tuple[float, float]:
        """Places between which it is a function: of a path those of the first and the last state."""
        low, high = self.path.coordinates[[0, -1]].tolist()
        return low, high

    @property
    def places(self) -> Array:
        """Places between which events are looked for, ascending: of a path those of all intervals."""
        return self.path.places(INTERVAL_FRACTIONS)

    @property
    def states(self) -> int:
        """How many states were solved."""
        return len(self.path.expansions)

    def length_at(self, s: float) -> float:
        """Return the length over which errors change: of a path that of the interval of a place."""
        places = self.path.coordinates
        k = int(np.clip(np.searchsorted(places, s, side="right") - 1, 0, max(len(places) - 2, 0)))
        return float(places[k + 1] - places[k]) if len(places) > 1 else 0.0

    def along(self, path: Any) -> Self:
        """Return the numbers off another path."""
        return replace(self, path=path)  # type: ignore[type-var]

    @abstractmethod
    def read(self, s: Array, rtol: float | None = None) -> Readings:
        """Return what is known at places; with a tolerance, states are solved where it is exceeded."""

    @abstractmethod
    def parts(self, s: Array, coefficients: Coefficients) -> Parts:
        """Return what decides on regimes, without errors."""

    @abstractmethod
    def slopes(self, s: Array, coefficients: Coefficients) -> Array:
        """Return the derivatives of the friction by the coordinate."""

    def accepted(self, rtol: float | None) -> float:
        """Return the error of the observables up to which a landmark is read off."""
        return self.rtol if rtol is None else rtol

    def holds(self, s: float, accepted: float) -> bool:
        """Return whether no error at a place exceeds what is accepted."""
        return accepted >= self.rtol

    def solution_at(self, s: float) -> Any:
        """Return the solution at a place to the tolerance of the numbers, or raise the error of its outcome."""
        return self.solved(s, self.rtol)

    @abstractmethod
    def solved(self, s: float, rtol: float) -> Any:
        """Return the solution at a place, solved to a tolerance."""

    def state_slope(self, s: float, rtol: float, coefficients: Coefficients) -> float:
        """Return the derivative of the friction at a state that was solved."""
        return math.nan


class Progress:
    """Counts and reports the finished points of a curve as its path grows from fast to slow."""

    def __init__(self, places: Array, on_point: Callable[[int, int], object] | None) -> None:
        self.places, self.on_point, self.done = places, on_point, 0

    def __call__(self, low: float, high: float) -> None:
        """Count those between two coordinates."""
        while self.done < len(self.places) and self.places[-1 - self.done] >= low:
            self.done += 1
            if self.on_point is not None:
                self.on_point(self.done, len(self.places))


@dataclass(frozen=True, eq=False, repr=False)
class CurveValues(Shown, ByValue):
    """Observables and friction of a curve at one value, or at many."""

    value: Any  # What the curve runs over: the group [-], or SI units where the curve has a contact
    values: dict[str, Any]
    relative_errors: Array = field(repr=False)  # Estimated relative errors of the observables, by name in :attr:`errors`
    minimum_position_error: Any = field(repr=False)  # Estimated absolute error of the position of the minimum gap [a]
    friction: Friction | FrictionArray  # Friction coefficient with its parts and its error [-]
    names: tuple[str, ...] = field(repr=False)  # Of the observables that have errors, in their order

    @classmethod
    def of(cls, value: Any, found: Readings, friction: Friction | FrictionArray) -> Self:
        """Return the values of readings; numbers if ``value`` is a number."""
        if np.ndim(value):
            return cls(value, dict(found.values), found.relative_errors, found.position_error, friction, found.names)
        values = {name: column.tolist()[0] for name, column in found.values.items()}
        return cls(float(value), values, found.relative_errors[0], float(found.position_error[0]), friction, found.names)

    @property
    def errors(self) -> dict[str, Any]:
        """Estimated relative error of each observable; absolute for the load shares."""
        return {name: self.relative_errors[..., i] for i, name in enumerate(self.names)}

    def _card(self) -> Card:
        known = {"friction": (self.friction.total, self.friction.error)}
        known |= {name: (self.values[name], error) for name, error in self.errors.items() if np.isfinite(error).all()}
        rows = [(name, f"{brief_text(value)}, error {np.max(error):.1e}") for name, (value, error) in known.items()]
        return Card(f"at {brief_text(self.value)}", rows, ("Hertz units; errors of friction and load shares are absolute.",))

    def __getattr__(self, name: str) -> Any:
        """Return an observable under its own name."""
        if name != "values" and name in self.values:
            return self.values[name]
        # Of a property that fails Python asks here, and would show none of what failed.
        return object.__getattribute__(self, name)

    def __dir__(self) -> list[str]:
        """Return the names of attributes, observables among them."""
        return [*super().__dir__(), *self.values]
