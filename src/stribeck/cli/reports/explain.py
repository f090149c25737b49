"""The text of ``stribeck regimes``, for Python."""

from __future__ import annotations

import html
import io
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import stribeck as sb
from stribeck.checks.check import Checks
from stribeck.checks.table import checks_of_curve
from stribeck.cli.exits import say
from stribeck.cli.reports.printing import print_conversions
from stribeck.cli.reports.regimes import print_regimes, print_uncertainty
from stribeck.contacts.contact import Contact
from stribeck.contacts.friction import Definition
from stribeck.curves.result import StribeckCurve
from stribeck.curves.sensitivities import sensitivities_if_known
from stribeck.quantities.keywords import answers_typos
from stribeck.quantities.units import InputError, show
from stribeck.regimes.margin_intervals import with_intervals
from stribeck.regimes.margin_limits import scanned_rtol
from stribeck.regimes.margins import RegimeMargins, regime_margins
from stribeck.solver.solution import Solution

if TYPE_CHECKING:
    from rich.console import Console

__all__ = ["Explanation", "Regimes", "explain", "print_explanation", "regimes_of"]

CURVE_POINTS = 41  # Points of the curve on which transitions are looked for, which are then located exactly.


@dataclass(frozen=True)
class Regimes:
    """Everything about the regime of a contact."""

    solution: Solution  # Its state
    sensitivities: dict[str, float]  # Those of its friction
    curve: StribeckCurve  # The curve over the speed through it
    margins: RegimeMargins  # The way to the next regimes
    checks: Checks | None  # Whether the model applies
    errors: sb.Uncertainty | None  # Uncertainty of the results, if inputs have errors
    reason: str = ""  # Why there are no sensitivities; empty where there are some


class Explanation(str):
    """Text whose representation is the text itself."""

    def __repr__(self) -> str:
        """Return the text itself."""
        return str(self)

    def _repr_html_(self) -> str:
        return f"<pre style='white-space: pre-wrap'>{html.escape(self)}</pre>"


def regimes_of(case: sb.Case, on_point: Callable[[int, int], object] | None = None) -> Regimes:
    """Solve everything about the regime of a case."""
    contact, rtol, definition = case.contact, case.rtol, case.definition
    solution, sensitivities, reason = sensitivities_if_known(contact, rtol=rtol, definition=definition)
    coarse = scanned_rtol(contact, rtol)
    curve = sb.stribeck_curve(contact, points=CURVE_POINTS, rtol=coarse, definition=definition, on_point=on_point)
    _ = curve.transitions
    if curve.outcome is sb.Outcome.INTERRUPTED:
        raise KeyboardInterrupt
    margins = regime_margins(contact, rtol=rtol, definition=definition, on_point=on_point, curve=curve)
    margins = with_intervals(contact, margins, case.errors, definition)
    errors = sb.propagate(contact, case.errors, definition=definition) if case.errors else None
    checks = checks_of_curve(curve, case.facts, solution)
    return Regimes(solution, sensitivities, curve, margins, checks, errors, reason)


def print_explanation(console: Console, found: Regimes, case: sb.Case) -> None:
    """Print everything about the regime of a case."""
    print_regimes(console, found.solution, found.sensitivities, found.curve, found.margins, case.title, found.checks)
    if found.reason:
        say(console, f"No sensitivities: {found.reason}")
    if found.errors is not None:
        print_uncertainty(console, found.errors)
    print_conversions(console, case)


@answers_typos
def explain(problem: Contact | sb.Case, *, rtol: float = 1e-6, definition: Definition = "balanced") -> Explanation:
    """Explain the regime of a contact: what carries the load, how far the next regimes are, what moves its friction.

    Parameters
    ----------
    problem : LineContact or Case
        The contact, or a case from :func:`stribeck.load_case`, whose tolerance, definition and facts then hold.
    rtol : float
        Relative tolerance of the states.
    definition : {"balanced", "published"}
        Definition of the viscous friction.

    Returns
    -------
    Explanation
        The words of ``stribeck regimes``, a string that shows itself as printed.

    Raises
    ------
    InputError
        If ``problem`` is no contact and no case, or an argument is out of range.
    """
    from rich.console import Console

    if isinstance(problem, Contact):
        problem = sb.Case(path=Path(), contact=problem, rtol=rtol, definition=definition)
    if not isinstance(problem, sb.Case):
        raise InputError(f"problem = {show(problem)}; give a contact, or a case from load_case.")
    stream = io.StringIO()
    console = Console(file=stream, width=100, color_system=None)
    print_explanation(console, regimes_of(problem), problem)
    return Explanation(stream.getvalue().rstrip())
