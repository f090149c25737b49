"""From groups to a state of the point contact that holds its tolerance: cold, or from a neighbour."""

from __future__ import annotations

from stribeck.contacts.groups import Groups
from stribeck.solver.point.state import PointState


def solve_cold(groups: Groups, rtol: float = 1e-6) -> PointState:
    """Return the state of ``groups``, from the dry contact or the rigid ball.

    Parameters
    ----------
    groups : Groups
        One state of the point geometry; speed, roughness or both may be zero.
    rtol : float
        Largest estimated error of shares, central gap, central pressure, offset and friction; 1e-8 to 1e-2.

    Returns
    -------
    PointState
        A failure is returned in its outcome, not raised.
    """
    raise NotImplementedError


def solve_from(neighbour: PointState, groups: Groups, rtol: float = 1e-6) -> PointState:
    """Return the state of ``groups`` from that of a neighbour, on its mesh as long as this serves.

    Parameters
    ----------
    neighbour : PointState
        A solved state; its operators and its preconditioner are used again.  Only the contact law must be the same; the nearer
        it is the cheaper.
    groups : Groups
        One state of the point geometry.
    rtol : float
        As for :func:`solve_cold`.

    Returns
    -------
    PointState
        A failure is returned in its outcome, not raised; a path from the neighbour that is lost is tried cold first.
    """
    raise NotImplementedError
