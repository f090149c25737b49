"""Where the model leaves its range, in sentences for the user: the contact law, and the shape of the contact."""

from __future__ import annotations

from stribeck._types import Array
from stribeck.contact_laws.law import is_exponential, largest_load
from stribeck.contacts.line import Groups, LineContact
from stribeck.equations.observables import Observables

__all__ = ["cavitation_notes", "law_notes", "shape_notes"]

WIDEST_CONTACT = 0.3
"""Hertz half-width over the radius from which a note says that the model is coarse."""

LAW_LEAST_GAP = 0.4
"""Gap over h_rms down to which the exponential law follows Persson's full relation; facts in theory.md, section 8."""


ATMOSPHERE = 1.01325e5
"""Ambient pressure of a contact in the open [Pa], by which the fluid pressure may fall before nothing is left."""


def shape_notes(contact: LineContact | None) -> tuple[str, ...]:
    """Return the sentence that says where the contact is too wide for a parabola on a half-space."""
    if contact is None:
        return ()
    slope = contact.hertz.half_width / contact.radius
    if not slope > WIDEST_CONTACT:
        return ()
    return (
        f"The contact is wide: the Hertz half-width is {slope:.2g} of the radius. A parabola on a half-space is right up to "
        f"about 0.1 and coarse at {WIDEST_CONTACT}; check modulus, load and radius.",
    )


def law_notes(groups: Groups, contact: LineContact | None, values: Observables) -> tuple[str, ...]:
    """Return the sentences that say where the contact law leaves its range."""
    if groups.roughness == 0:
        return ()
    if groups.law is not None and not is_exponential(groups.law):
        said = groups.law.notes(values.minimum_gap / float(groups.relative_roughness))
        return ("The gap is negative: asperities alone cannot carry this load at a positive gap.", *said)[
            values.minimum_gap > 0 :
        ]
    notes = []
    if groups.load >= largest_load(groups.law):
        notes.append(
            f"The load group is {float(groups.load):.3g}, not below 1: the exponential contact law is outside its range, "
            "as asperities cannot carry this load at a positive gap. "
            "Persson's law, of a table [surface], goes on from there."
        )
    alpha = 1.0 if contact is None else contact.alpha
    ratio = values.central_gap / float(groups.relative_roughness) / alpha
    measured = "h_rms" if contact is not None else "h_rms/alpha"
    if ratio < 0:
        notes.append("The gap is negative: the exponential contact law is outside its range.")
    elif ratio < LAW_LEAST_GAP:
        notes.append(
            f"The central gap is {ratio:.2g} {measured}: the exponential contact law is outside its range, "
            f"which ends at about {LAW_LEAST_GAP} h_rms; the true law stiffens."
        )
    elif ratio < 1:
        notes.append(
            f"The central gap is {ratio:.2g} {measured}: the exponential contact law is at the end of its range "
            f"({LAW_LEAST_GAP} to 2 h_rms)."
        )
    return tuple(notes)


def cavitation_notes(contact: LineContact | None, fluid_pressure: Array) -> tuple[str, ...]:
    """Return the sentence that says where the suction behind a contact is more than an atmosphere.

    Parameters
    ----------
    contact : LineContact or None
        The contact; without one nothing is known of pressures in Pa.
    fluid_pressure : ndarray
        Fluid pressure above the ambient [p_Hz].

    Returns
    -------
    tuple of str
        The sentence, or nothing.

    Notes
    -----
    How much cavitation would change is a matter of the speed group; when_not_to_use.md.
    """
    if contact is None:
        return ()
    suction = -float(fluid_pressure.min()) * contact.hertz.pressure
    if not suction > ATMOSPHERE:
        return ()
    # In MPa throughout, so that the notes of a curve differ by their numbers alone.
    return (
        f"Behind the contact the fluid pressure falls {suction / 1e6:.3g} MPa below the ambient, more than one atmosphere: "
        "in the open the film may cavitate there, which is not modelled.",
    )
