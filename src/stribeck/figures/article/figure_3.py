"""Figure 3: a Stribeck curve from boundary to hydrodynamic lubrication, and the space of states that it crosses."""

from __future__ import annotations

import math
from typing import Any

from stribeck.contacts.groups import Groups
from stribeck.curves.result import StribeckCurve
from stribeck.figures import style
from stribeck.figures.article.state_space import draw_space
from stribeck.figures.job import FigureJob, Numbers
from stribeck.figures.style import Dataset, Panels

LOAD, ROUGHNESS = 0.1, 1e-4  # Groups of the curve.
SPEED_RANGE = 1e-8, 0.1  # Speed groups of the curves.
# Roughness groups at which panel (b) shows where the regimes end, at the same load.
MAPPED_ROUGHNESSES = (1e-6, 1e-5, 1e-4, 1e-3, 1e-2)
STEPS = len(MAPPED_ROUGHNESSES) + 2

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
    draw_space(panels["b"], data)
