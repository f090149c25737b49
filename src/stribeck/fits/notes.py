"""What a fit says of itself: how it ended, and the sentences on what is at a bound, implausible, tied or far off."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from stribeck._types import Array, Indices
from stribeck.contact_laws.law import largest_load
from stribeck.contacts.contact import Contact
from stribeck.contacts.geometries import LINE
from stribeck.fits.identifiability import Unidentifiable
from stribeck.fits.least_squares import Minimum
from stribeck.fits.measurements import Measurements
from stribeck.fits.result import FitOutcome, FittedInput
from stribeck.quantities.formats import format_si

__all__ = ["notes_of", "outcome_of"]

TIED = 0.95  # Correlation from which a pair of inputs is named


def outcome_of(at: Minimum, inputs: Sequence[FittedInput]) -> FitOutcome:
    """Return how a fit ended."""
    if not at.converged:
        return FitOutcome.NOT_AT_OPTIMUM if at.ended else FitOutcome.STEP_LIMIT
    if any(_implausible(each) for each in inputs):
        return FitOutcome.IMPLAUSIBLE
    return FitOutcome.AT_BOUND if any(each.at_bound for each in inputs) else FitOutcome.CONVERGED


def notes_of(
    at: Minimum,
    inputs: Sequence[FittedInput],
    correlation: Array,
    covariance: Array,
    weak: Sequence[Unidentifiable],
    contacts: Sequence[Contact],
) -> list[str]:
    """Return the sentences on a fit."""
    notes = []
    for each in inputs:
        if each.at_bound:
            value = f"{each.value:.4g}" if each.is_factor else format_si(each.value, each.dimension, 4)
            notes.append(
                f"{each.label} ended at its bound {value}: the data would move it further, and it has no standard error. "
                "Widen the bound, or free fewer inputs."
            )
        if _implausible(each):
            notes.append(
                f"{each.label} {each.value:.2g} is larger than that of any known contact: the data do not reach the boundary "
                "plateau, or other inputs are wrong. Give it a bound or a prior in [fit], or do not free it."
            )
    named = {name for each in weak for name in each.names}
    for i in range(len(inputs)):
        for j in range(i):
            pair = inputs[j].label, inputs[i].label
            if abs(correlation[i, j]) > TIED and not named & set(pair):
                notes.append(_combination(pair, correlation[i, j], covariance[np.ix_([j, i], [j, i])]))
    for name, contact in zip(at.objective.model.data.curves, contacts, strict=True):
        load = float(contact.groups.load)
        if load >= largest_load(contact.law):
            where = f" of curve {name}" if len(contacts) > 1 else ""
            notes.append(
                f"The fitted load group{where} is {load:.3g}, not below 1: the exponential contact law is outside its range."
            )
    if at.objective.robust:
        far = np.abs(at.residuals) > 4
        if far.any():
            notes.append(
                "Rows beyond four standard errors, which have little weight in the fit: "
                f"{_rows(at.objective.model.data, np.nonzero(far)[0])}."
            )
    return notes


def _rows(data: Measurements, which: Indices) -> str:
    """Return the rows of files, with the names of the files where there are several."""
    rows_of: dict[str, list[int]] = {}
    for i in which.tolist():
        rows_of.setdefault(data.files[data.curve[i]] if data.files else "", []).append(int(data.rows[i]))
    texts = {name: ", ".join(map(str, sorted(rows)[:10])) for name, rows in rows_of.items()}
    return ", ".join(f"{rows} of {name}" if name else rows for name, rows in texts.items())


def _implausible(each: FittedInput) -> bool:
    return not each.is_factor and each.name in LINE.quantities and each.value > LINE.quantities[each.name].implausible


def _combination(pair: tuple[str, str], correlation: float, covariance: Array) -> str:
    """Return the sentence that names the combination of two inputs that the data determine best."""
    values, vectors = np.linalg.eigh(covariance)
    a, b = vectors[:, 0]
    first, second = pair if abs(a) >= abs(b) else pair[::-1]
    power = float(min(a, b, key=abs) / max(a, b, key=abs))
    size = float(math.sqrt(max(values[0], 0.0)) / max(abs(a), abs(b)))
    shown = "" if abs(abs(power) - 1) < 0.02 else f"^{abs(power):.2g}"
    return (
        f"{pair[0]} and {pair[1]} have correlation {correlation:.3f}: the data determine "
        f"{first} {'x' if power > 0 else '/'} {second}{shown} best, within {100 * size:.2g} %."
    )
