"""Everything about the regime of a case: its state, the curve through it, margins, sensitivities, checks and errors.

A curve alone has its checks, and what errors of the inputs leave open along it.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
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
from stribeck.quantities.units import InputError
from stribeck.regimes.advice import strongest_lever
from stribeck.regimes.margin_intervals import with_intervals
from stribeck.regimes.margins import RegimeMargins, regime_margins, scanned_rtol
from stribeck.solver.solution import Solution
from stribeck.solver.solve_error import SolveError
from stribeck.uncertainty.propagate import Band, friction_band, propagate
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
    checks: Checks  # Whether the model applies
    errors: Uncertainty | None  # Uncertainty of the results, if inputs have errors

    @property
    def friction(self) -> Friction:
        """Friction of the state, by the definition of the case."""
        return self.solution.friction(definition=self.curve.definition)

    @property
    def notes(self) -> list[str]:
        """What to know of the state, of the minimum of friction and of the margins."""
        return [*self.solution.notes_for(definition=self.curve.definition), *self.curve.minimum_notes, *self.margins.notes]

    @property
    def error_estimate(self) -> float:
        """The larger of the errors of state and curve."""
        return max(self.solution.error_estimate, self.curve.error_estimate)

    def to_dict(self) -> dict[str, Any]:
        """Return the state with the transitions around it and what moves its friction, ready for JSON."""
        return {
            **self.solution.to_dict(definition=self.curve.definition),
            "definition": self.curve.definition,
            "contact_friction_share": self.friction.contact_share,
            "contact_friction_share_error": self.friction.relative_error,
            **marks_of(self.curve),
            "margins": self.margins.to_dict(),
            "sensitivities": self.sensitivities,
            "moves_friction_most": strongest_lever(self.sensitivities),
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
    checks = checks_of(whole, "tail" if is_whole else "curve")
    return Overview(case, solution, sensitivities, reason, curve, margins, checks, errors)


@dataclass(frozen=True)
class CurveVerdict:
    """What is known of a curve beside its points."""

    checks: Checks | None  # Whether the model applies; None of groups alone
    headline: str = ""  # The same in a sentence, where all checks were made
    errors: Uncertainty | None = None  # Uncertainty of the state of the contact itself, if inputs have errors
    band: Band | None = None  # Interval of the friction along the curve
    problem: str = ""  # Why errors are not propagated

    @property
    def drawn(self) -> dict[str, Any]:
        """What a picture of the curve shows of it."""
        return {"band": self.band, "verdict": self.headline}


def first_verdict(curve: StribeckCurve, case: Case | None) -> CurveVerdict:
    """Judge a curve by what its points show."""
    return CurveVerdict(checks_of_curve(curve, case.facts if case else None))


def whole_verdict(
    curve: StribeckCurve, case: Case | None, *, is_drawn: bool, on_point: Callable[[int, int], object] | None = None
) -> CurveVerdict:
    """Judge a curve with errors of its inputs; for a picture by all checks too, as ``stribeck check``, and with a band."""
    found = first_verdict(curve, case)
    if case is None or curve.contact is None or not curve.outcome.ok:
        return found
    try:
        if is_drawn:
            checks = checks_of_curve(curve, case.facts, is_whole=True, on_point=on_point)
            found = replace(found, checks=checks, headline=checks.headline if checks else "")
        if case.errors:
            spread = propagate(curve.contact, case.errors, definition=curve.definition, transitions=curve.over == "speed")
            found = replace(found, errors=spread)
        if case.errors and is_drawn:
            ends = curve.values[[0, -1]]
            band = friction_band(curve.contact, case.errors, ends, curve.definition, curve.over, on_point=on_point)
            found = replace(found, band=band)
    except (InputError, SolveError) as problem:
        return replace(found, problem=f"The errors of the inputs are not propagated: {problem}")
    return found
