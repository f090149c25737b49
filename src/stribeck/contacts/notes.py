"""Notes for the user on where the model leaves its range: pressure, width, contact law, suction."""

import math
from typing import Any

from stribeck._types import Array
from stribeck.contact_laws.finite_surface import has_endless_tail
from stribeck.contact_laws.law import is_exponential, largest_load
from stribeck.contacts.contact import Contact
from stribeck.contacts.friction import Definition, friction_share
from stribeck.contacts.friction_rules import RULES
from stribeck.contacts.groups import Groups
from stribeck.fluids.fluid import Film
from stribeck.quantities.formats import format_percent, format_si
from stribeck.solids.solid import lengths_of

# Beginnings of notes, by which outputs order them and checks find them
HARD_PREFIX = "Hard elastohydrodynamics:"
FLUID_PREFIX = "The fluid leaves the range of its laws:"
POCKET_PREFIX = "Inside the contact the fluid pressure falls"
SUCTION_PREFIX = "Behind the contact the fluid pressure falls"
THICK_PREFIX = "The film is"
WETTED_PREFIX = "The liquid ends at"

OIL_COEFFICIENT = 2e-8  # Pressure-viscosity coefficient of mineral oil [1/Pa], amid the usual 15 to 25 1/GPa
# Pressure coefficient times Hertz pressure where films are 12 %, friction 88 % off (when_not_to_use.md).
MAX_PRESSURE_EXPONENT = 1.0
MAX_HERTZ_PRESSURE = MAX_PRESSURE_EXPONENT / OIL_COEFFICIENT  # Hertz pressure up to which an oil may count as isoviscous [Pa]
MAX_CONTACT_SLOPE = 0.3  # Hertz half-width over the radius above which the model is coarse
MAX_FILM_SLOPE = 0.1  # Film over the ball's radius above which lubrication theory does not hold
LAW_RANGE = (0.4, 2.0)  # Gaps over h_rms in which the exponential law follows a rough surface (contact_laws.md)
WIDER_LAW = "Persson's law, from a table [surface], covers that range."
USUAL_ALPHA = 2.0  # Decay coefficient of self-affine surfaces, by which groups alone are judged
USUAL_BETA = 0.05  # Slope coefficient of self-affine surfaces, by which groups alone are judged
NEGLIGIBLE_SHARE = 0.01  # Share of load and of friction of the asperities up to which their contact law does not matter
TAIL_ADVICE = " (stribeck check says by how much)."  # Ends the note on a minimum that the law's tail decides
ATMOSPHERE = 1.01325e5  # Ambient pressure [Pa], the largest suction of a contact in the open


# The observables of a state of any geometry: contact_load_share, central_gap, minimum_gap, and viscous_friction by beta
Values = Any


def pressure_notes(contact: Contact | None) -> tuple[str, ...]:
    """Return the sentence on hard elastohydrodynamics, if the Hertz pressure is outside the model."""
    if contact is None or contact.groups.model.film.uses_pressure or not contact.hertz.pressure > MAX_HERTZ_PRESSURE:
        return ()
    pressure = contact.hertz.pressure
    return (
        f"{HARD_PREFIX} the Hertz pressure is {format_si(pressure, 'pressure')}, but this model applies up to "
        f"{format_si(MAX_HERTZ_PRESSURE, 'pressure')}. "
        f"At that pressure an oil with {OIL_COEFFICIENT * 1e9:g} 1/GPa is exp({OIL_COEFFICIENT * pressure:.2g}) times as "
        f"viscous as at ambient pressure, which is "
        "not modelled: with such a fluid film, friction and regimes are not those given here.",
    )


def fluid_notes(film: Film, gap: Array, pressure: Array, flux_gap: float) -> tuple[str, ...]:
    """Return the sentences that say where a film leaves the range of its laws."""
    said = film.notes(gap, pressure if film.uses_pressure else None, flux_gap)
    return tuple(f"{FLUID_PREFIX} {each.rstrip('.')}." for each in said)


def shape_notes(contact: Contact | None) -> tuple[str, ...]:
    """Return the notes on the dry contact: its pressure, and its width if that is too large for a parabola."""
    if contact is None:
        return ()
    return (*pressure_notes(contact), *width_notes(contact))


def width_notes(contact: Contact) -> tuple[str, ...]:
    """Return the sentence on a contact that is too wide for a parabola on a half-space, if it is."""
    slope = contact.slope
    if not slope > MAX_CONTACT_SLOPE:
        return ()
    if contact.profile is not None:
        return (
            f"The body is steep: the dry contact is {slope:.2g} of its half-width deep. The half-space is accurate up to "
            f"about 0.1 and coarse at {MAX_CONTACT_SLOPE}; check modulus, load and profile.",
        )
    layered = math.isfinite(lengths_of(contact.solid).thickness)
    advice = "" if layered else " If the soft body is a thin layer on a stiff base, give its layer_thickness in [solid]."
    return (
        f"The contact is wide: the {contact.WIDTH} is {slope:.2g} of the radius. The parabola on a half-space is accurate up "
        f"to about 0.1 and coarse at {MAX_CONTACT_SLOPE}; check modulus, load and radius.{advice}",
    )


def law_notes(
    groups: Groups,
    contact: Contact | None,
    values: Values,
    given: tuple[float, float] | None = None,
    definition: Definition = "balanced",
) -> tuple[str, ...]:
    """Return the sentences that say where the contact law leaves its range while asperities still matter."""
    if groups.roughness == 0:
        return ()
    shares = _shares(groups, contact, values, given, definition)
    if not max(shares) > NEGLIGIBLE_SHARE:
        return ()
    ratio, measured = _gap_ratio(groups, contact, values)
    far = _far_note(groups, ratio, measured, shares, contact is not None or given is not None)
    if groups.law is not None and not is_exponential(groups.law):
        said = groups.law.notes(values.minimum_gap / float(groups.relative_roughness))
        negative = ("The gap is negative: asperities alone cannot carry this load at a positive gap.",)
        return (*(negative if values.minimum_gap <= 0 else ()), *said, *far)
    notes = []
    if groups.load >= largest_load(groups.law):
        notes.append(
            f"The load group is {float(groups.load):.3g}, not below 1: the exponential contact law is outside its range, "
            f"as asperities cannot carry this load at a positive gap. {WIDER_LAW}"
        )
    if ratio < 0:
        notes.append("The gap is negative: the exponential contact law is outside its range.")
    elif ratio < LAW_RANGE[0]:
        notes.append(
            f"The central gap is {ratio:.2g} {measured}: the exponential contact law is outside its range, "
            f"which ends at about {LAW_RANGE[0]} h_rms; real contact is stiffer there.{'' if notes else f' {WIDER_LAW}'}"
        )
    return (*notes, *far)


def matters(groups: Groups, contact: Contact | None, values: Values, definition: Definition) -> bool:
    """Return whether asperities have more than 1 % of load or friction, so that their contact law matters."""
    return max(_shares(groups, contact, values, None, definition)) > NEGLIGIBLE_SHARE


def minimum_note(groups: Groups, contact: Contact | None, values: Values, friction: float, where: str) -> str:
    """Return the note on a friction minimum whose gap is outside the range of the contact law, or an empty string."""
    if not (groups.roughness > 0 and friction > NEGLIGIBLE_SHARE and has_endless_tail(groups.law)):
        return ""
    ratio, measured = _gap_ratio(groups, contact, values)
    if ratio <= LAW_RANGE[1]:
        return ""
    return (
        f"At the minimum of friction, {where}, the central gap is {ratio:.2g} {measured}, beyond the range of "
        f"{_range(groups)}, while asperities cause {format_percent(friction)} of the friction: on a surface with "
        f"fewer high asperities the minimum is lower and at a lower speed{TAIL_ADVICE}"
    )


def _gap_ratio(groups: Groups, contact: Contact | None, values: Values) -> tuple[float, str]:
    """Return the central gap over h_rms, and the unit in words."""
    known = contact.alpha if contact is not None else (groups.law.parameters.get("alpha") if groups.law is not None else None)
    alpha = USUAL_ALPHA if known is None else float(known)
    measured = "h_rms" if known is not None else f"h_rms at alpha = {USUAL_ALPHA:g}"
    return values.central_gap / float(groups.relative_roughness) / alpha, measured


def _shares(
    groups: Groups, contact: Contact | None, values: Values, given: tuple[float, float] | None, definition: Definition
) -> tuple[float, float]:
    """Return the asperities' shares of load and friction."""
    boundary, beta = (1.0, USUAL_BETA) if given is None else given
    if contact is not None:
        boundary, beta = contact.friction_of_asperities.coefficient_at_small_area(contact), contact.beta
    rule = RULES[groups.geometry]
    dry = boundary * values.contact_load_share * rule.sliding_factor(groups, rule.of_contact(contact))
    return values.contact_load_share, float(friction_share(dry, values.viscous_friction(beta, definition)))


def _range(groups: Groups) -> str:
    """Return the law of a state and where it holds, in words."""
    if is_exponential(groups.law):
        return f"the exponential contact law ({LAW_RANGE[0]} to {LAW_RANGE[1]:g} h_rms)"
    return f"Persson's contact law (up to {LAW_RANGE[1]:g} h_rms)"


def _far_note(groups: Groups, ratio: float, measured: str, shares: tuple[float, float], known: bool) -> tuple[str, ...]:
    """Return the note on a gap above the range of the contact law."""
    # Groups alone do not fix the friction: the note states what it assumes.
    if ratio <= LAW_RANGE[1] or not has_endless_tail(groups.law):
        return ()
    load, friction = shares
    supposed = "" if known else f", at boundary friction 1 and beta = {USUAL_BETA:g}"
    return (
        f"The central gap is {ratio:.3g} {measured}, beyond the range of {_range(groups)}, while asperities carry "
        f"{format_percent(load)} of the load and cause {format_percent(friction)} of the friction{supposed}: few asperities "
        "are so high, and a real surface may have fewer than the law assumes.",
    )


def pocket_notes(lowest_pressure: float) -> tuple[str, ...]:
    """Return the note on suction inside a contact whose film ends behind it."""
    if not -lowest_pressure > NEGLIGIBLE_SHARE:
        return ()
    return (
        f"{POCKET_PREFIX} {-lowest_pressure:.2g} p_Hz below the ambient, before its exit: a film that breaks there too is not "
        "modelled, and would leave less load and friction to the asperities.",
    )


# What cavitation at ambient pressure changes in a line contact.
LINE_CAVITATION_NOTE = (
    "Where it breaks at ambient pressure the minimum of friction is 9 to 20 % lower, and in boundary lubrication the fluid "
    "carries more (when_not_to_use.md)."
)


def cavitation_notes(contact: Contact, lowest_pressure: float, consequence: str = LINE_CAVITATION_NOTE) -> tuple[str, ...]:
    """Return the note on a suction of more than an atmosphere behind the contact."""
    suction = -lowest_pressure * contact.hertz.pressure
    if not suction > ATMOSPHERE:
        return ()
    # In MPa throughout, so that the notes of a curve differ by their numbers alone.
    return (
        f"{SUCTION_PREFIX} {suction / 1e6:.3g} MPa below the ambient, more than one atmosphere: "
        f"at atmospheric pressure the film cavitates there; cavitation = 'exit' or 'reform' models that. {consequence}",
    )
