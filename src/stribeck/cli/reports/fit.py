"""A fit in words and as a table: what ``stribeck fit`` prints. Nothing is computed here."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

from stribeck.cli.exits import say
from stribeck.cli.reports.printing import print_first
from stribeck.contacts.part_inputs import all_input_rows
from stribeck.fits.case_file import format_interval, format_value
from stribeck.fits.posterior import Posterior
from stribeck.fits.result import Fit, FitOutcome, FittedInput
from stribeck.quantities.formats import format_percent, format_si

if TYPE_CHECKING:
    from rich.console import Console

TABLE_WIDTH = 140  # Width that the table may take [letters].

__all__ = ["fit_json", "print_fit"]


def print_fit(console: Console, fit: Fit, title: str, files: Sequence[str] = (), posterior: Posterior | None = None) -> None:
    """Print a fit: how it ended, the inputs with their intervals, what the residuals say, and notes."""
    from rich.box import SIMPLE_HEAD
    from rich.console import Console
    from rich.table import Table

    tell = partial(say, console)
    print_first(console, fit.checks)
    if title:
        tell(title, "bold")
    data = fit.data
    curves = f", {len(data.curves)} curves" if len(data.curves) > 1 else ""
    tell(
        f"{len(data)} rows{curves} of {data.path or 'measured friction'}; contact law: {fit.law}; friction: {fit.definition}."
    )
    if data.taken:
        tell(data.taken)
    tell(fit.outcome.value, None if fit.outcome is FitOutcome.CONVERGED else "bold red")
    table = Table(box=SIMPLE_HEAD, pad_edge=False)
    for name in ["input", "fitted", "error", "68 %", "95 %", "case", *(["posterior 95 %"] if posterior else [])]:
        table.add_column(name, no_wrap=True)
    for i, each in enumerate(fit.inputs):
        row = [each.label, format_value(each), _error(each), format_interval(each, 0.68), format_interval(each, 0.95)]
        row.append(format_value(each, each.start))
        if posterior:
            low, high = posterior.interval_95[i]
            row.append(f"{format_value(each, low)} to {format_value(each, high)}")
        table.add_row(*row)
    # Wider than a narrow terminal rather than cut: an end of an interval without its digits is none.
    Console(file=console.file, width=max(TABLE_WIDTH, console.width)).print(table)
    if fit.held:
        tell(_held(fit))
    tell(_noise(fit))
    shift = (
        ""
        if math.isnan(fit.solver_shift)
        else f"; replacing the lookup table by the solver moved it by {fit.solver_shift:.1g} standard errors"
    )
    tell(f"The fitted friction comes from the solver, with relative error {fit.model_error:.1g}{shift}.")
    if posterior:
        tell(posterior.message)
    for sentence in fit.quality.messages:
        tell(f"Warning: {sentence}", "bold yellow")
    for each_weak in fit.undetermined:
        message = each_weak.message
        tell(f"Warning: {message}", "bold yellow")
    for note in fit.notes:
        if not fit.checks.covers(note):
            tell(f"Note: {note}", "yellow")
    for name in files:
        tell(f"Written: {name}")


def fit_json(fit: Fit, title: str, files: Sequence[str] = (), posterior: Posterior | None = None) -> dict[str, Any]:
    """Return a fit with its title, the files written and the posterior."""
    found: dict[str, Any] = fit.checks.to_dict() | {"title": title} | fit.to_dict() | {"files": list(files)}
    if posterior is not None:
        names = ("acceptance", "autocorrelation_time", "converged", "message")
        found["posterior"] = {name: getattr(posterior, name) for name in names} | {
            "interval_68": dict(zip([each.label for each in fit.inputs], posterior.interval_68, strict=True)),
            "interval_95": dict(zip([each.label for each in fit.inputs], posterior.interval_95, strict=True)),
            "draws": len(posterior.samples),
        }
    return found


def _error(each: FittedInput) -> str:
    if math.isnan(each.standard_error):
        return "at its bound"
    return format_percent(each.standard_error) if each.standard_error < 1 else "unknown"


def _held(fit: Fit) -> str:
    shown = []
    for name in fit.held:
        values = {getattr(contact, name, None) for contact in fit.contacts}
        [value, *others] = values
        dimension = all_input_rows(fit.contact.INPUTS)[name].dimension
        known = "of each curve" if others or value is None else format_si(value, dimension, 4)
        shown.append(f"{name} {known}")
    return (
        f"Held fixed: {', '.join(shown)}. "
        "Their uncertainty is not included in the errors above; to include it, use free or priors in the "
        "table [fit] of the case."
    )


def _noise(fit: Fit) -> str:
    quality = fit.quality
    misfit = "no systematic misfit detected" if quality.structure_probability >= 0.01 else "systematic misfit detected"
    if math.isnan(fit.noise):
        return (
            f"Residuals: chi squared {quality.chi_squared:.3g} for {quality.degrees_of_freedom:.3g} degrees of freedom "
            f"(p = {quality.chi_squared_probability:.2g}); {misfit} (p = {quality.structure_probability:.2g})."
        )
    size = format_percent(fit.noise) if fit.logarithmic else f"{fit.noise:.2g}"
    return f"Residuals: {size} of noise; {misfit} (p = {quality.structure_probability:.2g})."
