"""The unknowns of a state by name: where each lies in the vector that Newton's iteration moves.

Fields have a value at every node, numbers have one.  The residual has the same layout: the row of the gap is that of the
elastic shape, the row of the pressure that of Reynolds' equation, the row of the offset the load balance, the row of the flux
gap the pressure that the film must end with, the row of the exit the gradient there, and the row of the cavity stretch the
pressure with which the film re-forms.
"""

from __future__ import annotations

from typing import NamedTuple


class Layout(NamedTuple):
    """Where each unknown lies in the vector."""

    # ``y[..., layout.offset]`` keeps the axis of a number, so that it is a column of stacked states.

    size: int  # Number of all unknowns
    gap: slice  # Fields: the gap, and the fluid pressure if it is an unknown of its own
    numbers: slice  # All numbers
    offset: slice
    flux_gap: slice
    pressure: slice  # Fields: the gap, and the fluid pressure if it is an unknown of its own
    exit: slice
    cavity_stretch: slice
