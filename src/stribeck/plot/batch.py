"""Pictures of many states, of a batch and of a sweep: friction over what varies along the longest dimension."""

from __future__ import annotations

import numpy as np

from stribeck.files.results import Exported
from stribeck.plot import style
from stribeck.plot.style import Axes, Figure
from stribeck.quantities.units import InputError


@style.picture("nothing varies")
def plot_states(found: Exported, *, ax: Axes | None = None, title: str = "") -> Figure:
    """Draw a line for each state of the other dimensions; points where the states are no grid."""
    data = found.to_dataset()
    over = str(max(data.sizes, key=lambda name: data.sizes[name], default=""))
    if data.sizes.get(over, 0) < 2:
        raise InputError("nothing varies in this batch, so there is no curve to draw; give an input as an array.")
    scattered = over == "state" and "varied" in data.attrs
    name = data.attrs["varied"].partition(", ")[0] if scattered else over
    place = data[name if name in data.variables or not scattered else f"{name}_group"]  # the number of the state if unnamed
    friction = data.friction_balanced.transpose(..., over)
    x = place.broadcast_like(friction).transpose(*friction.dims).values.reshape(-1, data.sizes[over]).astype(float)
    y = friction.values.reshape(x.shape)
    figure, (ax,) = style.new_figure((7.0, 4.6), [], title=title or "Friction", ax=ax)
    for line, (at, values) in enumerate(zip(x, y, strict=True)):
        ax.plot(at, values, "." if scattered else "-", color=style.INK, alpha=1.0 if line == 0 else 0.6, lw=1.5, ms=4)
    if name in data.variables and (x > 0).all():
        style.make_logarithmic(ax, "x", x)
    style.make_logarithmic(ax, "y", y[np.isfinite(y)])
    ax.set(xlabel=style.with_unit(name.replace("_", " "), place.attrs.get("units", "1")), ylabel=style.FRICTION)
    return figure
