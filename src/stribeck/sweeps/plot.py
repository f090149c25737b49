"""The picture of a sweep."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from stribeck.files import pictures
from stribeck.files.writing import PathLike

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from stribeck.sweeps.dataset import Sweep

__all__ = ["plot_sweep"]


def plot_sweep(sweep: Sweep, path: PathLike | None = None, *, ax: Any = None, force: bool = False) -> Figure:
    """Draw friction over the first input that varies, a point for each finished state."""
    data, name = sweep.to_dataset(), sweep.about["varied"][0]
    name = name if name in data else f"{name}_group"
    x, y = np.asarray(data[name].values, dtype=float), data.friction_balanced.values
    figure, (ax,) = pictures.new_figure((7.0, 4.6), [], title=sweep.about["title"] or "Sweep", ax=ax)
    ax.plot(x, y, ".", color=pictures.INK, ms=4)
    for which, values in (("x", x), ("y", y)):
        if np.nanmin(values, initial=np.inf) > 0:
            pictures.make_logarithmic(ax, which, values[np.isfinite(values)])
    unit = data[name].attrs["units"]
    ax.set_xlabel(f"{name.replace('_', ' ')}{'' if unit == '1' else f' ({unit})'}")
    ax.set_ylabel(r"friction coefficient $\mu$")
    return pictures.finish_figure(figure, path, force)
