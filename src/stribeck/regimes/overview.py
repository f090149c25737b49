"""Everything about the regime of a case: its state, the curve through it, margins, sensitivities, checks and errors."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from stribeck.cases.case import Case
from stribeck.checks.check import Checks
from stribeck.checks.subject import Subject
from stribeck.checks.table import checks_of, checks_of_curve
from stribeck.contacts.friction import Friction
from stribeck.curves.result import StribeckCurve
from stribeck.curves.sensitivities import sensitivities_if_known
from stribeck.curves.stribeck_curve import stribeck_curve
from stribeck.curves.table import marks_of
from stribeck.quantities.outcome import Outcome
from stribeck.regimes.levers import strongest_lever
from stribeck.regimes.margin_intervals import with_intervals
from stribeck.regimes.margin_scan import scanned_rtol
from stribeck.regimes.margins import RegimeMargins, regime_margins
from stribeck.solver.base_solution import regime_of_state
from stribeck.solver.solution import Solution
from stribeck.uncertainty.propagate import propagate
from stribeck.uncertainty.result import Uncertainty

CURVE_POINTS = 41  # Points of the curve on which transitions are looked for, which are then located exactly.


@dataclass(frozen=True)
class Overview:
    """Everything about the regime of a contact: its state, margins, marks of its curve, and what moves its friction."""

    case: Case  # The case
    solution: Solution  # Its state
    sensitivities: dict[str, float]  # Those of its friction
    no_sensitivities: str  # Why there are none; empty where there are some
    curve: StribeckCurve  # The curve over the speed through it
    margins: RegimeMargins  # The way to the next regimes
    checks: Checks | None  # Whether the model applies
    errors: Uncertainty | None  # Uncertainty of the results, if inputs have errors

    @property
    def friction(self) -> Friction:
        """Friction of the state, by the definition of the case."""
        return self.solution.friction(definition=self.curve.definition)

    @property
    def notes(self) -> list[str]:
        """What to know of the state, of the minimum of friction and of the margins."""
        return [*self.solution.notes, *self.curve.minimum_notes, *self.margins.notes]

    @property
    def error_estimate(self) -> float:
        """The larger of the errors of state and curve."""
        return max(self.solution.error_estimate, self.curve.error_estimate)

    def to_dict(self) -> dict[str, Any]:
        """Return the state with the transitions around it and what moves its friction, ready for JSON."""
        return {
            **self.solution.to_dict(),
            "definition": self.curve.definition,
            "regime": regime_of_state(self.solution, self.curve.definition),
            "contact_friction_share": self.friction.contact_share,
            "contact_friction_share_error": self.friction.relative_error,
            **marks_of(self.curve),
            "margins": self.margins.to_dict(),
            "sensitivities": self.sensitivities,
            "moves_friction_most": strongest_lever(self.sensitivities),
            "error_estimate": self.error_estimate,
            "outcome": self.curve.outcome.name,
            "message": self.curve.outcome.value,
            "notes": self.notes,
            **({} if self.errors is None else {"uncertainty": self.errors.to_dict()}),
        }


def overview_of(case: Case, on_point: Callable[[int, int], object] | None = None, *, is_whole: bool = False) -> Overview:
    """Solve everything about the regime of a case; ``is_whole`` makes all checks, as ``stribeck check`` does."""
    contact, rtol, definition = case.contact, case.rtol, case.definition
    solution, sensitivities, reason = sensitivities_if_known(contact, rtol=rtol, definition=definition)
    coarse = scanned_rtol(contact, rtol)
    curve = stribeck_curve(contact, points=CURVE_POINTS, rtol=coarse, definition=definition, on_point=on_point)
    _ = curve.transitions
    if curve.outcome is Outcome.INTERRUPTED:
        raise KeyboardInterrupt
    margins = regime_margins(contact, rtol=rtol, definition=definition, on_point=on_point, curve=curve)
    margins = with_intervals(contact, margins, case.errors, definition)
    errors = propagate(contact, case.errors, definition=definition) if case.errors else None
    whole = Subject(contact, case.facts, definition, solution, curve)
    checks = checks_of(whole) if is_whole else checks_of_curve(curve, case.facts, solution)
    return Overview(case, solution, sensitivities, reason, curve, margins, checks, errors)
