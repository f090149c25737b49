"""Figure 8: gap and pressures on the way from boundary to hydrodynamic lubrication, between the two limits."""

import numpy as np

from stribeck.asymptotics import boundary
from stribeck.contacts.groups import Groups
from stribeck.figures import style
from stribeck.figures.job import FigureJob, Numbers, furthest
from stribeck.figures.style import Dataset, Panels
from stribeck.solids import hertz

LOAD, ROUGHNESS = 0.1, 1e-4  # Groups of the profiles.
# Speed groups of the profiles, 3.16e-6 to 1e-3 as in the paper, in steps of half a decade.
SPEEDS = tuple(10.0 ** (exponent / 2) for exponent in range(-11, -5))
STEPS = len(SPEEDS) + 2


def compute(work: FigureJob) -> Dataset:
    """Solve the curve and the profiles, and compare these with both limits."""
    data = Numbers(speed=SPEEDS, load_group=LOAD, roughness_group=ROUGHNESS)
    curve = work.curve(load=LOAD, roughness=ROUGHNESS, speed=(1e-8, 0.1), points=71)
    data.curve_speed, data.hersey_number, data.friction = curve.values, curve.hersey_number, curve.friction
    states = [work.solve(speed, LOAD, ROUGHNESS) for speed in SPEEDS]
    data.profile_hersey = [state.groups.hersey_number() for state in states]
    data.profile_friction = [state.friction(definition="published").total for state in states]
    data.fluid_load_share = [state.fluid_load_share for state in states]
    data.central_gap = [state.central_gap for state in states]
    data.x, data.inside = np.linspace(-1.6, 1.6, 641), np.linspace(-0.998, 0.998, 499)
    for name in ("gap", "fluid_pressure", "contact_pressure"):
        setattr(data, name, np.array([getattr(state.profile(data.x), name) for state in states]))
    at_rest, data.hertz_pressure = Groups(0.0, LOAD, ROUGHNESS), hertz.pressure(data.x)
    data.rough_contact = boundary.gap.function(at_rest, data.inside)
    core = np.abs(data.x) <= 0.9  # The layers at the edges lie outside.
    film = work.solve(SPEEDS[-1], LOAD, 0.0).profile(data.x[core]).gap
    data.gap_distance = furthest(data.gap[:, core] / boundary.gap.function(at_rest, data.x[core]) - 1)
    data.film_distance = furthest(data.gap[:, core] / film - 1)
    data.contact_distance = furthest((data.contact_pressure - data.hertz_pressure)[:, core])
    data.fluid_distance = furthest((data.fluid_pressure - data.hertz_pressure)[:, core])
    data.slow_fluid = data.fluid_pressure[0].max()
    rise = np.diff(data.contact_pressure, axis=0).max(axis=0)
    data.rise, data.rise_at = rise.max(), data.x[rise.argmax()]
    return work.dataset(data)


def draw(panels: Panels, data: Dataset) -> None:
    """Draw the curve, and gap and pressures of the profiles."""
    a, every = panels["a"], slice(None, None, 3)
    a.loglog(data.hersey_number, data.friction, color=style.INK, lw=1.2)
    a.plot(data.hersey_number[every], data.friction[every], "o", color=style.INK, ms=3, mfc="white")
    for colour, place, value in zip(style.sequence(len(data.speed)), data.profile_hersey, data.profile_friction, strict=True):
        a.axvline(float(place), color=colour, lw=1.6, zorder=0)
        a.plot(place, value, "o", color=colour, ms=7, mec="white", zorder=5)
    a.set_xlim(float(data.hersey_number[0]), float(data.hersey_number[-1]))
    for name in ("c", "d"):
        panels[name].axhline(0.0, color=style.GREY, lw=0.6)
    panels["c"].annotate(
        "negative:\nno cavitation", (1.05, float(data.fluid_pressure.min())), (1.56, 0.3), size=8, color=style.GREY,
        ha="right", arrowprops={"arrowstyle": "->", "color": style.GREY, "lw": 0.8},
    )  # fmt: skip
