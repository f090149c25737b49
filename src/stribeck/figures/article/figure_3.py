"""Figure 3: a Stribeck curve from boundary to hydrodynamic lubrication, and the space of states that it crosses."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from stribeck.contacts.groups import Groups
from stribeck.curves.regime import Transition
from stribeck.curves.result import StribeckCurve
from stribeck.figures import style
from stribeck.figures.job import FigureJob
from stribeck.figures.style import Axes, Dataset, Figure

TITLE = "Stribeck curve and the space of states"
CLAIM = (
    "boundary lubrication for Hersey numbers below 1e-7, mixed from 1e-7 to 3e-5, hydrodynamic above; "
    "the smooth and the quasistatic limit are planes that meet in the line of Hertz."
)
SIZE = 11.5, 6.0

LOAD, ROUGHNESS = 0.1, 1e-4  # Groups of the curve.
SPEED_RANGE = 1e-8, 0.1  # Speed groups of the curves.
# Roughness groups at which panel (b) shows where the regimes end, at the same load.
MAPPED_ROUGHNESSES = (1e-6, 1e-5, 1e-4, 1e-3, 1e-2)
STEPS = len(MAPPED_ROUGHNESSES) + 2

MARK_NAMES: dict[str, str] = {
    Transition.BOUNDARY_END: "boundary_end",
    Transition.HYDRODYNAMIC_START: "hydrodynamic_begin",
    Transition.MINIMUM: "minimum",
}

# Ends of the box of panel (b): logarithms of speed, load and roughness; the planes of speed and roughness zero stand at its
# lower ends, as zero has no logarithm.
BOX_LOW, BOX_HIGH = (-10.0, -3.0, -8.0), (1.5, 0.0, -1.0)


def compute(work: FigureJob) -> Dataset:
    """Solve the curve by both definitions of friction, and where the regimes end."""
    curve = work.curve(load=LOAD, roughness=ROUGHNESS, speed=SPEED_RANGE, points=141)
    balanced = work.curve(load=LOAD, roughness=ROUGHNESS, speed=SPEED_RANGE, points=141, definition="balanced")
    found = [_marks(work.curve(load=LOAD, roughness=roughness, points=61)) for roughness in MAPPED_ROUGHNESSES]
    marks, fair = _marks(curve), _marks(balanced)
    hersey = float(Groups(1.0, LOAD, ROUGHNESS).hersey_number())
    work.along(speed=(curve.values, "speed group lambda"), roughness=(MAPPED_ROUGHNESSES, "roughness group h_rms"))
    work.give(
        "speed",
        hersey_number=(curve.hersey_number, "Hersey number eta U/F_N for beta = 1"),
        friction_published=(curve.friction, "friction coefficient, definition published"),
        friction_balanced=(balanced.friction, "friction coefficient, definition balanced"),
        friction_asperities=(curve.friction.asperities, "contribution of asperities to the friction coefficient"),
        viscous_published=(curve.friction.fluid, "part from the fluid, definition published"),
        viscous_balanced=(balanced.friction.fluid, "part from the fluid, definition balanced"),
        contact_load_share=(curve.observable("contact_load_share"), "part of the load on asperities"),
    )
    for label, name in MARK_NAMES.items():
        speeds = [each.get(name, (math.nan, math.nan))[0] for each in found]
        work.give("roughness", **{f"{name}_speed": (speeds, f"speed group where {label}, load {LOAD}")})
    for name, (value, friction) in marks.items():
        words = name.replace("_", " ")
        number, coefficient = f"Hersey number of the {words}", f"friction coefficient at the {words}"
        work.give((), **{f"{name}_hersey": (hersey * value, number), f"{name}_friction": (friction, coefficient)})
    excess = float(curve.friction.max()) - 1
    finding = (
        f"boundary up to a Hersey number of {hersey * marks['boundary_end'][0]:.2g}, mixed up to "
        f"{hersey * marks['hydrodynamic_begin'][0]:.2g}; minimum friction {marks['minimum'][1]:.5f} at "
        f"{hersey * marks['minimum'][0]:.3g} (force balance: {fair['minimum'][1]:.5f} at {hersey * fair['minimum'][0]:.3g}). "
        f"The printed friction exceeds mu_0 by {100 * excess:.1f} % before it falls, since its fluid part is up to "
        f"{float((curve.friction.fluid / balanced.friction.fluid).max()):.0f} times that of the force balance."
    )
    return work.dataset(finding, load_group=LOAD, roughness_group=ROUGHNESS)


def _marks(curve: StribeckCurve) -> dict[str, tuple[float, float]]:
    """Return value and friction of the landmarks that the figure shows."""
    return {MARK_NAMES[mark.name]: (mark.value, mark.friction) for mark in curve.transitions if mark.name in MARK_NAMES}


def draw(figure: Figure, data: Dataset) -> None:
    """Draw the curve, its fluid part, and the space of states."""
    grid = figure.add_gridspec(2, 2, height_ratios=[1.35, 1], width_ratios=[1, 1.05])
    above, below = figure.add_subplot(grid[0, 0]), figure.add_subplot(grid[1, 0])
    _draw_curve(above, data)
    _draw_viscous(below, data)
    _draw_space(figure.add_subplot(grid[:, 1], projection="3d", computed_zorder=False), data)


def _draw_curve(axes: Axes, data: Dataset) -> None:
    style.house_style(axes)
    x = data.hersey_number
    axes.loglog(x, data.friction_published, color=style.INK, lw=2.2, label="as published")
    axes.plot(x, data.friction_balanced, color=style.MARK, lw=1.4, ls=style.DASHED, label="by the balance of forces")
    axes.plot(x, data.friction_asperities, color=style.CONTACT, lw=1.2, ls=style.DOTTED, label="part from asperities")
    axes.plot(data.minimum_hersey, data.minimum_friction, "o", color=style.INK, ms=7, mec="white", label="minimum friction")
    axes.tick_params(labelbottom=False)
    load, roughness = (style.power(data.attrs[f"{name}_group"]) for name in ("load", "roughness"))
    text = rf"Stribeck curve, $\bar F_N$ = {load}, $\bar h_\mathrm{{rms}}$ = {roughness}, $\beta = \mu_0 = 1$"
    style.panel(axes, "a", text, {"loc": "lower left"}, ylim=(8e-3, 4), ylabel=r"friction coefficient $\mu$")
    _shade(axes, data, named=True)


def _draw_viscous(axes: Axes, data: Dataset) -> None:
    style.house_style(axes)
    x = data.hersey_number
    axes.loglog(x, data.viscous_published, color=style.INK, lw=2.0, label="as published: without the contact pressure")
    axes.plot(x, data.viscous_balanced, color=style.MARK, lw=1.4, ls=style.DASHED, label="by the balance of forces")
    settings = {"xlabel": r"Hersey number $\eta U/F_N$", "ylabel": r"fluid part $\mu_f$", "ylim": (1e-7, 1)}
    style.panel(axes, "+", "the friction of the fluid by both definitions", {"loc": "lower right"}, **settings)
    _shade(axes, data, named=False)


def _shade(axes: Axes, data: Dataset, named: bool) -> None:
    x = data.hersey_number.values
    edges = [x[0], float(data.boundary_end_hersey), float(data.hydrodynamic_begin_hersey), x[-1]]
    axes.set_xlim(x[0], x[-1])
    for regime, low, high in zip(style.TINTS, edges[:-1], edges[1:], strict=True):
        axes.axvspan(low, high, color=style.TINTS[regime], lw=0, zorder=0)
        if named:
            place = math.sqrt(low * high), 0.97
            axes.text(
                *place, regime, transform=axes.get_xaxis_transform(), ha="center", va="top", size=8.5,
                color=style.GREY, style="italic",
            )  # fmt: skip


def _draw_space(axes: Any, data: Dataset) -> None:
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
    axes.set_xlabel(r"speed $\lambda$", color=style.INK)
    axes.set_ylabel(r"load $\bar F_N$", color=style.INK)
    axes.set_zlabel(r"roughness $\bar h_\mathrm{rms}$", color=style.INK)
    axes.tick_params(labelsize=8, colors=style.INK)
    axes.view_init(elev=22, azim=-57)
    axes.set_box_aspect((1.25, 1, 0.95), zoom=0.87)
    style.panel(axes, "b", "space of states, with the regimes solved at the load of (a)")
