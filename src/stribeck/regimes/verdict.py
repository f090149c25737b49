"""Whether the model applies to a solved curve, and what errors of the inputs leave open along it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

from stribeck.cases.case import Case
from stribeck.checks.check import Checks
from stribeck.checks.table import checks_of_curve
from stribeck.curves.result import StribeckCurve
from stribeck.quantities.units import InputError
from stribeck.solver.solve_error import SolveError
from stribeck.uncertainty.band import Band, friction_band
from stribeck.uncertainty.propagate import propagate
from stribeck.uncertainty.result import Uncertainty


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
