"""Panel (b) of figure 3: the space of states between its limits, with the regimes at one load."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from stribeck.figures import style
from stribeck.figures.style import Dataset

# Ends of the box of panel (b): logarithms of speed, load and roughness; the planes of speed and roughness zero stand at its
# lower ends, as zero has no logarithm.
BOX_LOW, BOX_HIGH = (-10.0, -3.0, -8.0), (1.5, 0.0, -1.0)


def draw_space(axes: Any, data: Dataset) -> None:
    """Draw the planes of both limits, the regimes between them, and the curve of panel (a)."""
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    (s0, f0, r0), (s1, f1, r1) = BOX_LOW, BOX_HIGH
    load, roughness = (math.log10(data.attrs[f"{name}_group"]) for name in ("load", "roughness"))
    smooth = [(s0, f0, r0), (s1, f0, r0), (s1, f1, r0), (s0, f1, r0)]
    rest = [(s0, f0, r0), (s0, f1, r0), (s0, f1, r1), (s0, f0, r1)]
    for corners, colour in ((smooth, style.FLUID), (rest, style.MARK)):
        axes.add_collection3d(Poly3DCollection([corners], facecolor=colour, edgecolor=colour, alpha=0.2, zorder=1))
    axes.plot([s0, s0], [f0, f1], [r0, r0], color=style.GREEN, lw=4, zorder=2)
    rough = np.log10(data.roughness.values)
    ends = [np.log10(data[f"{name}_speed"].values) for name in ("boundary_end", "hydrodynamic_begin")]
    ends = [np.full_like(rough, s0), *ends, np.full_like(rough, s1)]
    for regime, left, right, row in zip(style.TINTS, ends[:-1], ends[1:], (3, 1, 1), strict=True):
        around = np.concatenate([left, right[::-1]]), np.concatenate([rough, rough[::-1]])
        cut = Poly3DCollection([[(s, load, r) for s, r in zip(*around, strict=True)]], facecolor=style.TINTS[regime], zorder=3)
        cut.set_edgecolor(style.GREY)
        axes.add_collection3d(cut)
        place = 0.5 * (left[row] + right[row]), load, rough[row]
        axes.text(*place, regime, zdir="x", size=8.5, color=style.GREY, style="italic", ha="center", va="center", zorder=5)
    speed = np.log10(data.speed.values)
    axes.plot(speed, load, roughness, color=style.INK, lw=2.6, zorder=4)
    axes.text(speed[-1] + 0.2, load, roughness, "(a)", color=style.INK, size=9, va="center", zorder=5)
    axes.text(-3.6, -2.3, r0, "smooth limit:\nelastohydrodynamic", color=style.FLUID, size=9, ha="center", zorder=5)
    axes.text(s0, -2.0, -5.6, "quasistatic limit:\ndry friction", color=style.MARK, size=8.5, ha="center", zdir="y", zorder=5)
    axes.text(s0 - 0.7, -2.0, r0 - 1.3, "Hertz", color=style.GREEN, size=10, weight="bold", zdir="y", zorder=5)
    axes.set(xlim=(s0, s1), ylim=(f0, f1), zlim=(r0, r1))
    axes.set_xticks([-10, -8, -6, -4, -2, 0], ["0", *(f"$10^{{{n}}}$" for n in (-8, -6, -4, -2)), "1"])
    axes.set_yticks([-3, -2, -1, 0], [*(f"$10^{{{n}}}$" for n in (-3, -2, -1)), "1"])
    axes.set_zticks([-8, -6, -4, -2], ["0", *(f"$10^{{{n}}}$" for n in (-6, -4, -2))])
    axes.tick_params(labelsize=8, colors=style.INK)
    axes.view_init(elev=22, azim=-57)
    axes.set_box_aspect((1.25, 1, 0.95), zoom=0.87)
