"""Figure 3: a Stribeck curve from boundary to hydrodynamic lubrication, and the space of states that it crosses."""

import math
from typing import Any

import numpy as np

from stribeck.contacts.groups import Groups
from stribeck.curves.result import StribeckCurve
from stribeck.figures import style
from stribeck.figures.job import FigureJob, Numbers
from stribeck.figures.style import Dataset, Panels

LOAD, ROUGHNESS = 0.1, 1e-4  # Groups of the curve.
SPEED_RANGE = 1e-8, 0.1  # Speed groups of the curves.
# Roughness groups at which panel (b) shows where the regimes end, at the same load.
MAPPED_ROUGHNESSES = (1e-6, 1e-5, 1e-4, 1e-3, 1e-2)
STEPS = len(MAPPED_ROUGHNESSES) + 2

# Ends of the box of panel (b): logarithms of speed, load and roughness; the planes of speed and roughness zero stand at its
# lower ends, as zero has no logarithm.
BOX_LOW, BOX_HIGH = (-10.0, -3.0, -8.0), (1.5, 0.0, -1.0)

# The landmarks of a curve by the names that they have in the data.
LANDMARKS = {"boundary_end": "boundary_end", "hydrodynamic_begin": "hydrodynamic_start", "minimum": "minimum"}


def compute(work: FigureJob) -> Dataset:
    """Solve the curve by both definitions of friction, and where the regimes end."""
    data = Numbers(roughness=MAPPED_ROUGHNESSES, load_group=LOAD, roughness_group=ROUGHNESS)
    curve, balanced = (
        work.curve(load=LOAD, roughness=ROUGHNESS, speed=(1e-8, 0.1), points=141, definition=definition)
        for definition in ("published", "balanced")
    )
    mapped = [work.curve(load=LOAD, roughness=roughness, points=61) for roughness in MAPPED_ROUGHNESSES]
    data.speed, data.hersey_number = curve.values, curve.hersey_number
    data.friction_published, data.friction_balanced = curve.friction, balanced.friction
    data.friction_asperities = curve.friction.asperities
    data.viscous_published, data.viscous_balanced = curve.friction.fluid, balanced.friction.fluid
    data.contact_load_share = curve.observable("contact_load_share")
    hersey = float(Groups(1.0, LOAD, ROUGHNESS).hersey_number())
    for name, landmark in LANDMARKS.items():
        speed, friction = _place(curve, landmark)
        speeds = [_place(each, landmark)[0] for each in mapped]
        vars(data).update({f"{name}_hersey": hersey * speed, f"{name}_friction": friction, f"{name}_speed": speeds})
    lowest_at, data.lowest_balanced = _place(balanced, "minimum")
    data.lowest_hersey = hersey * lowest_at
    data.excess = float(curve.friction.max()) - 1
    data.fluid_ratio = (data.viscous_published / data.viscous_balanced).max()
    return work.dataset(data)


def _place(curve: StribeckCurve, landmark: str) -> tuple[float, float]:
    """Return speed and friction at a landmark, nan where the curve has none."""
    found = curve.landmark(landmark)
    return (found.value, found.friction) if found else (math.nan, math.nan)


def draw(panels: Panels, data: Dataset) -> None:
    """Draw the curve, its fluid part, and the space of states."""
    x, a, fluid = data.hersey_number, panels["a"], panels["fluid"]
    balanced: dict[str, Any] = {"color": style.MARK, "lw": 1.4, "ls": style.DASHED, "label": "by the balance of forces"}
    a.loglog(x, data.friction_published, color=style.INK, lw=2.2, label="as published")
    a.plot(x, data.friction_balanced, **balanced)
    a.plot(x, data.friction_asperities, color=style.CONTACT, lw=1.2, ls=style.DOTTED, label="part from asperities")
    a.plot(data.minimum_hersey, data.minimum_friction, "o", color=style.INK, ms=7, mec="white", label="minimum friction")
    a.tick_params(labelbottom=False)
    fluid.loglog(x, data.viscous_published, color=style.INK, lw=2.0, label="as published: without the contact pressure")
    fluid.plot(x, data.viscous_balanced, **balanced)
    edges = [float(each) for each in (x[0], data.boundary_end_hersey, data.hydrodynamic_begin_hersey, x[-1])]
    for regime, low, high in zip(style.TINTS, edges[:-1], edges[1:], strict=True):
        for axes in (a, fluid):
            axes.axvspan(low, high, color=style.TINTS[regime], lw=0, zorder=0)
            axes.set_xlim(edges[0], edges[-1])
        named = a.text(
            math.sqrt(low * high), 0.97, regime, transform=a.get_xaxis_transform(), style="italic", color=style.GREY
        )
        named.set(size=8.5, ha="center", va="top")
    _draw_space(panels["b"], data)


def _draw_space(axes: Any, data: Dataset) -> None:
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
