"""The picture of a batch: friction over what varies along its longest dimension.

matplotlib comes with the extra ``plot`` and is imported on first use.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from stribeck.files.pictures import INK, finish_figure, make_logarithmic, new_figure
from stribeck.files.writing import PathLike
from stribeck.quantities.units import InputError

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from stribeck.batches.result import BatchSolution

__all__ = ["plot_batch"]


def plot_batch(batch: BatchSolution, path: PathLike | None = None, *, ax: Axes | None = None, force: bool = False) -> Figure:
    """Draw friction over the input that varies along the longest dimension, a line for each other state."""
    shape = batch.groups.shape
    if not shape or max(shape) < 2:
        raise InputError("nothing varies in this batch, so there is no curve to draw; give an input as an array.")
    axis = int(np.argmax(shape))
    name = next((each for each in batch.varied if each == batch.dims[axis]), None)
    friction = np.moveaxis(np.asarray(batch.friction), axis, -1).reshape(-1, shape[axis])
    places = np.broadcast_to(np.arange(shape[axis]), shape) if name is None else batch.input(name)
    x = np.moveaxis(np.asarray(places, dtype=float), axis, -1).reshape(-1, shape[axis])
    figure, (ax,) = new_figure((7.0, 4.6), [], title="Friction", ax=ax)
    for line, (at, values) in enumerate(zip(x, friction, strict=True)):
        ax.plot(at, values, color=INK, alpha=1.0 if line == 0 else 0.6, lw=1.5)
    if name is not None and (x > 0).all():
        make_logarithmic(ax, "x", x)
    make_logarithmic(ax, "y", friction[np.isfinite(friction)])
    unit = "" if name is None else batch.unit(name)
    ax.set_xlabel(f"{(name or batch.dims[axis]).replace('_', ' ')}{f' ({unit})' if unit not in ('', '1') else ''}")
    ax.set_ylabel(r"friction coefficient $\mu$")
    return finish_figure(figure, path, force)
