"""The picture of a batch or a sweep: friction over what varies along the longest dimension.

matplotlib comes with the extra ``plot`` and is imported on first use.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from stribeck.files.pictures import INK, finish_figure, make_logarithmic, new_figure
from stribeck.files.results import Exported
from stribeck.files.writing import PathLike
from stribeck.quantities.units import InputError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["plot_states"]


def plot_states(found: Exported, path: PathLike | None = None, *, ax: Any = None, force: bool = False) -> Figure:
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
    figure, (ax,) = new_figure((7.0, 4.6), [], title="Friction", ax=ax)
    for line, (at, values) in enumerate(zip(x, friction.values.reshape(x.shape), strict=True)):
        ax.plot(at, values, "." if scattered else "-", color=INK, alpha=1.0 if line == 0 else 0.6, lw=1.5, ms=4)
    if name in data.variables and (x > 0).all():
        make_logarithmic(ax, "x", x)
    make_logarithmic(ax, "y", friction.values[np.isfinite(friction.values)])
    unit = place.attrs.get("units", "1")
    ax.set_xlabel(f"{name.replace('_', ' ')}{'' if unit == '1' else f' ({unit})'}")
    ax.set_ylabel(r"friction coefficient $\mu$")
    return finish_figure(figure, path, force)
