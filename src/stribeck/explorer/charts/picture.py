"""The charts as pictures for slides and papers, drawn by the package's own plots."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING, Any

import numpy as np

from stribeck.curves.stribeck_curve import stribeck_curve
from stribeck.explorer.charts.palette import LIGHT, PIN_DASHES
from stribeck.explorer.curves import hersey_scale

if TYPE_CHECKING:
    from stribeck.explorer.downloads import View

__all__ = ["figure_of", "picture"]

POINTS, RTOL = 101, 1e-4
"""Of the curve that is solved for a picture where the page reads it off the atlas."""


def picture(shown: View, what: str, kind: str) -> bytes:
    """Return a picture of the curve, with pinned and measured ones, or of the state.

    Parameters
    ----------
    shown : View
        What is shown.
    what : {"curve", "state"}
        Which.
    kind : {"png", "svg"}
        Its format.

    Returns
    -------
    bytes
        The file.

    Raises
    ------
    InputError, SolveError
        If the curve cannot be solved.
    MissingExtraError
        If matplotlib is not installed.
    """
    figure = figure_of(shown, what)
    file = io.BytesIO()
    metadata: dict[str, Any] = {"Date": None} if kind == "svg" else {}
    figure.savefig(file, format=kind, metadata=metadata)
    return file.getvalue()


def figure_of(shown: View, what: str) -> Any:
    """Return the figure of the curve or of the state."""
    if what == "state":
        return shown.answer.solution.plot()
    inputs, curve = shown.answer.inputs, shown.answer.curve
    found = None if curve is None or curve.stale else curve.solved
    if found is None:
        found = stribeck_curve(
            inputs.contact, speed=shown.answer.speeds, points=POINTS, rtol=RTOL, definition=inputs.definition
        )
    figure = found.plot()
    axes = figure.axes[0]
    added = []
    for i, (name, pinned, hersey) in enumerate(shown.pins):
        style: Any = {"color": LIGHT.pins[i % 6], "ls": (0, PIN_DASHES[i % 6])}
        added += axes.plot(pinned.speed * hersey, np.abs(pinned.friction[inputs.definition]), lw=1.4, label=name, **style)
    for each in shown.measured:
        places = each.places(inputs.contact, "hersey") * hersey_scale(inputs.contact)
        added += axes.plot(places, each.friction, "o", ms=4, mfc="none", mec=LIGHT.ink, label=each.name)
    if added:  # the others are named below the picture
        axes.legend(handles=added, frameon=False, fontsize=8)
    return figure
