"""The charts as pictures for slides and papers, drawn by the package's own plots."""

from __future__ import annotations

import io
from typing import Any

import numpy as np

from stribeck.explorer.charts.palette import LIGHT, PIN_DASHES
from stribeck.explorer.curves import PRINTED_POINTS, SOLVED_RTOL, Report, hersey_scale, solve_curve
from stribeck.explorer.view import View

__all__ = ["figure_of", "picture"]


def picture(shown: View, what: str, kind: str, go_on: Report) -> bytes:
    """Return a picture of the curve, with pinned and measured ones, or of the state."""
    figure = figure_of(shown, what, go_on)
    file = io.BytesIO()
    metadata: dict[str, Any] = {"Date": None} if kind == "svg" else {}
    figure.savefig(file, format=kind, metadata=metadata)
    return file.getvalue()


def figure_of(shown: View, what: str, go_on: Report) -> Any:
    """Return the figure of the curve, over what the page shows it, or of the state."""
    inputs, curve = shown.answer.inputs, shown.answer.curve
    if what == "state":
        return shown.answer.solution.plot(title=inputs.title)
    found = None if curve is None or curve.stale else curve.solved
    if found is None:
        points = PRINTED_POINTS[inputs.table.geometry]
        found = solve_curve(inputs.contact, inputs.definition, go_on, points, SOLVED_RTOL, shown.answer.speeds)
    band = None if curve is None or curve.stale else curve.band
    verdict = shown.answer.checks_with_curve.headline
    figure = found.plot(title=inputs.title, abscissa=inputs.abscissa, band=band, verdict=verdict)
    axes = figure.axes[0]
    added, heights = [], [np.array(axes.get_ylim())]
    for i, (name, pinned, hersey) in enumerate(shown.pins):
        style: Any = {"color": LIGHT.pins[i % 6], "ls": (0, PIN_DASHES[i % 6])}
        places = pinned.speed * (hersey if inputs.abscissa == "hersey" else 1.0)
        friction = np.abs(pinned.friction[inputs.definition])
        added += axes.plot(places, friction, lw=1.4, label=name, **style)
        heights.append(friction[friction > 0])
    for each in shown.measured:
        places = each.places(inputs.contact, inputs.abscissa)
        places = places * (hersey_scale(inputs.contact) if inputs.abscissa == "hersey" else 1.0)
        added += axes.plot(places, each.friction, "o", ms=4, mfc="none", mec=LIGHT.ink, label=each.name)
        heights.append(each.friction[each.friction > 0])
    if added:  # the others are named below the picture
        all_heights = np.concatenate(heights)
        axes.set_ylim(all_heights.min(), all_heights.max())
        axes.legend(handles=added, frameon=False, fontsize=8)
    return figure
