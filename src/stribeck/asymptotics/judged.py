"""States along which the errors of formulas are followed, and positions between which fields are compared with the solver."""

from __future__ import annotations

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


def around_contact(groups: Groups) -> tuple[float, float]:
    """Return the positions over which fields of a dry contact are compared."""
    return -2.0, 2.0


def inside_contact(groups: Groups) -> tuple[float, float]:
    """Return the positions over which fields in a contact are compared, away from the layers at its edges."""
    return -0.9, 0.9
