"""Where a real film would rupture: the model has none of it, and a note says where its suction passes the ambient pressure."""

from __future__ import annotations

from ._types import Array
from .parameters import LineContact

ATMOSPHERE = 1.01325e5
"""Ambient pressure of a contact in the open [Pa], by which the fluid pressure may fall before nothing is left."""


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
