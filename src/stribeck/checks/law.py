"""Checks of the contact law: its range at the centre and at the minimum of friction, and the influence of its tail."""

import math
from dataclasses import replace

import numpy as np

from stribeck._types import Array
from stribeck.checks.check import MIN_STATED_CHANGE, Check, Checks, Verdict, check_against_limits, verdict_of
from stribeck.checks.subject import Subject
from stribeck.contact_laws.finite_surface import has_endless_tail
from stribeck.contact_laws.law import is_exponential
from stribeck.contacts.contact import Contact
from stribeck.contacts.notes import LAW_RANGE, TAIL_ADVICE, USUAL_ALPHA, law_notes, matters, minimum_note
from stribeck.curves.regime import Transition
from stribeck.quantities.formats import format_si
from stribeck.quantities.units import InputError
from stribeck.solver.solution import Solution

# Change of minimum and transitions by the tail of the law up to which the change is stated as their error: without a scan
# beta, which moves them too, is known no better than by a factor of 1.3.
TAIL_CHANGE_FINE = 0.3

# Rms slope up to which linear elasticity and Reynolds' equation err by a tenth or two: :func:`roughness_slope`
RMS_SLOPE_FINE = 0.3
RMS_SLOPE_OUTSIDE = 1.0  # Rms slope from which linear elasticity and Reynolds' equation do not apply


def roughness_slope(subject: Subject) -> Check | None:
    r"""Return the check of the rms slope of the roughness; None where it is not known.

    .. math:: \frac{\bar p}{E^*} = 0.63 \, h'_\mathrm{rms}, \qquad
        \frac{dp/dx}{(dp/dx)_\mathrm{Reynolds}} = 1 + 0.6 \, \tan^2 x

    Source: [YP08] for the area in contact; Hamel's flow without inertia in a wedge of slope tan x, derived for docs/checks.md.
    """
    contact = subject.contact
    name = "rms slope of the roughness"
    if contact.roughness == 0:
        return Check(name, 0.0, RMS_SLOPE_FINE, "fine", "Smooth surfaces have no slope.")
    slope = subject.fact("rms_slope")
    if slope is None:
        area_slope = getattr(contact.law, "area_slope", None)
        if not area_slope:
            return None
        slope = contact.beta * math.sqrt(2) / area_slope
    pressure = f"asperities touch at {0.5 * math.sqrt(math.pi / 2) * slope:.2g} of E*"
    meanings: dict[Verdict, str] = {
        "fine": f"{pressure}, and the film is thin everywhere.",
        "doubtful": f"{pressure}, where rubber stiffens and plastics yield, and the pressure of the film between them is a "
        "few per cent to a half wrong.",
        "outside": f"{pressure}, which no solid bears elastically, and the film between does not follow Reynolds' equation. "
        "Most of it may come from the shortest wavelengths: check where the spectrum ends.",
    }
    begin = f"The rms slope of the roughness is {slope:.2g}: "
    return check_against_limits(name, slope, RMS_SLOPE_FINE, RMS_SLOPE_OUTSIDE, begin, meanings)


def range_at_centre(subject: Subject) -> Check | None:
    """Return the check of the central gap against the range of the contact law; None for smooth surfaces."""
    contact = subject.contact
    if contact.roughness == 0:
        return None
    state = subject.solution
    ratio = _ratio(subject, state)
    low, high = _range(subject)
    notes = law_notes(state.groups, contact, state.observables, definition=subject.definition)
    verdict: Verdict = "fine"
    if notes:
        verdict = "doubtful" if ratio >= low else "outside"
    limit, common = (high if ratio > low else low), ""
    if notes:
        sentence = " ".join(notes)
    elif matters(state.groups, contact, state.observables, subject.definition):
        common = _in_common(contact, ratio)
        sentence = f"The central gap is {ratio:.3g} h_rms, inside the range of the contact law.{common}"
    else:
        limit = math.inf
        sentence = f"The central gap is {ratio:.3g} h_rms; asperities carry too little for the law to matter."
    return Check(
        "contact law at the centre", ratio, limit, verdict, sentence, "h_rms", at_least=limit == low, notable=bool(common)
    )


def _in_common(contact: Contact, ratio: float) -> str:
    """Return what a law with an alpha of its own has in common with the exponential one; nothing for others."""
    law = contact.law
    if law is None or not hasattr(law, "fixed_alpha") or ratio <= 0:
        return ""
    excess = float(law.log_pressure(np.array([contact.alpha * ratio]))[0]) + USUAL_ALPHA * ratio
    beta = contact.beta * math.exp(excess)
    return (
        f" There the {law.name} law with beta = {contact.beta:.3g} presses as the exponential law with alpha = "
        f"{USUAL_ALPHA:g} and beta = {beta:.3g} does: their coefficients are not those of each other."
    )


def range_at_minimum(subject: Subject) -> Check | None:
    """Return the check of the central gap at the minimum of friction; None where there is none, or surfaces are smooth."""
    contact = subject.contact
    if contact.roughness == 0 or subject.minimum is None:
        return None
    state = subject.minimum.solution
    share = state.friction(definition=subject.definition).contact_share
    ratio = _ratio(subject, state)
    where = f"speed {format_si(subject.minimum.value, 'speed')}"
    note = minimum_note(state.groups, state.contact, state.observables, share, where)
    sentence = note.replace(TAIL_ADVICE, ".") or f"At the minimum of friction, {where}, the central gap is {ratio:.3g} h_rms."
    if not note and not has_endless_tail(contact.law):
        sentence += " The law has a tail of its own."
    limit = LAW_RANGE[1] if has_endless_tail(contact.law) else math.inf
    return Check("contact law at the minimum", ratio, limit, "doubtful" if note else "fine", sentence, "h_rms")


def add_range_along_curve(checks: Checks, in_doubt: Array) -> Checks:
    """Return the checks and, if none of them doubts the contact law but some points of a curve do, a check that does."""
    count = int(np.count_nonzero(in_doubt))
    if not count or any(each.of_law and each.verdict != "fine" for each in checks):
        return checks
    sentence = f"The contact law is outside its range at {count} of {len(in_doubt)} points of the curve."
    added = Check("contact law along the curve", count / len(in_doubt), 0.0, "doubtful", sentence)
    return replace(checks, checks=(*checks.checks, added))


def tail(subject: Subject) -> Check | None:
    """Return the check of how far minimum and transitions move if the law ends as that of a finite surface does."""
    contact = subject.contact
    if contact.roughness == 0 or not has_endless_tail(contact.law):
        return None
    before = {mark.name: mark for mark in subject.curve.transitions}
    after = {mark.name: mark for mark in subject.cut_curve.transitions}
    moves = {
        name: (after[name].value / mark.value - 1, after[name].friction / mark.friction - 1)
        for name, mark in before.items()
        if name in after
    }
    if not moves:
        low, high = (format_si(float(subject.curve.values[end]), "speed") for end in (0, -1))
        raise InputError(f"friction has no minimum and no transition from {low} to {high}, where it was looked for.")
    largest = max(abs(change) for pair in moves.values() for change in pair)
    changes = "; ".join(
        f"{_place(name)}, speed {round(100 * speed, 0) + 0.0:+.0f} % and friction {round(100 * friction, 0) + 0.0:+.0f} %"
        for name, (speed, friction) in moves.items()
        if max(abs(speed), abs(friction)) >= MIN_STATED_CHANGE
    )
    moved = f"the results then change: {changes}" if changes else "no result then changes by 1 % or more"
    sentence = f"A finite surface has fewer of the highest asperities; {moved}. A spectrum does not determine their height."
    verdict = verdict_of(largest, TAIL_CHANGE_FINE)
    is_notable = largest >= MIN_STATED_CHANGE
    return Check("tail of the contact law", largest, TAIL_CHANGE_FINE, verdict, sentence, error=largest, notable=is_notable)


def _place(name: str) -> str:
    """Return the name of a landmark as the beginning of a sentence."""
    return f"at the {name}" if name == Transition.MINIMUM else f"where {name}"


def _ratio(subject: Subject, state: Solution) -> float:
    """Return the central gap over h_rms."""
    return subject.film(state.central_gap) / subject.contact.roughness


def _range(subject: Subject) -> tuple[float, float]:
    """Return the range of the contact's law, in gaps over h_rms."""
    law = subject.contact.law
    high = LAW_RANGE[1] if has_endless_tail(law) else math.inf
    return (LAW_RANGE[0] if is_exponential(law) else 0.0), high
