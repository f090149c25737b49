"""States along which the errors of formulas are followed, and positions between which fields are compared with the solver."""

from __future__ import annotations

from collections.abc import Callable

from stribeck.asymptotics.formula import Value
from stribeck.contacts.groups import Groups


def smooth_line(speed: float) -> Groups:
    """Return a smooth cylinder, along whose speed errors are followed."""
    return Groups(speed, 0.1, 0.0)


def line_at_rest(relative_roughness: float) -> Groups:
    """Return a cylinder at rest, along whose roughness errors are followed."""
    return Groups(0.0, 0.1, 0.1 * relative_roughness)


def ball_at_rest(relative_roughness: float) -> Groups:
    """Return a ball at rest, along whose roughness errors are followed."""
    load = 1e-3
    return Groups(0.0, load, load ** (2 / 3) * relative_roughness, geometry="point")


def around(place: float, half_width: Callable[[Groups], Value]) -> Callable[[Groups], tuple[float, float]]:
    """Return the function that gives the positions about a place between which a field is compared."""

    def interval(groups: Groups) -> tuple[float, float]:
        width = float(half_width(groups))
        return place - width, place + width

    return interval


# Of a dry contact, and inside a contact, away from the layers at its edges.
AROUND_CONTACT = around(0.0, lambda groups: 2.0)
INSIDE_CONTACT = around(0.0, lambda groups: 0.9)
