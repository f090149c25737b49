"""Figure 8: gap and pressures on the way from boundary to hydrodynamic lubrication, between the two limits."""

from __future__ import annotations

import numpy as np

from stribeck.asymptotics import boundary
from stribeck.contacts.groups import Groups
from stribeck.figures import style
from stribeck.figures.job import FigureJob
from stribeck.figures.style import Axes, Dataset, Figure
from stribeck.solids import hertz

TITLE = "Profiles in the mixed-lubrication regime"
CLAIM = (
    "with speed, gap and fluid pressure gradually rise and the contact pressure falls, from the rough-contact gap "
    "under Hertz pressure on the asperities to Hertz pressure in the fluid."
)
SIZE = 11.0, 7.0

LOAD, ROUGHNESS = 0.1, 1e-4  # Groups of the profiles.
# Speed groups of the profiles, 3.16e-6 to 1e-3 as in the paper, in steps of half a decade.
SPEEDS = tuple(10.0 ** (exponent / 2) for exponent in range(-11, -5))
STEPS = len(SPEEDS) + 2

CURVE_SPEED_RANGE = 1e-8, 0.1  # Speed groups of the curve.
CORE_HALF_WIDTH = 0.9  # Half-width [a] in which profiles are compared with the limits; the layers at the edges lie outside.


def compute(work: FigureJob) -> Dataset:
    """Solve the curve and the profiles, and compare these with both limits."""
    curve = work.curve(load=LOAD, roughness=ROUGHNESS, speed=CURVE_SPEED_RANGE, points=71)
    states = [work.solve(speed, LOAD, ROUGHNESS) for speed in SPEEDS]
    smooth = work.solve(SPEEDS[-1], LOAD, 0.0)
    x, inside = np.linspace(-1.6, 1.6, 641), np.linspace(-0.998, 0.998, 499)
    profiles = [state.profile(x) for state in states]
    gaps, fluid, contact = (
        np.array([getattr(profile, name) for profile in profiles]) for name in ("gap", "fluid_pressure", "contact_pressure")
    )
    dry = hertz.pressure(x)
    rough_contact = boundary.gap.function(Groups(0.0, LOAD, ROUGHNESS), inside)
    core = np.abs(x) <= CORE_HALF_WIDTH
    at_core = np.array([profile.gap[core] for profile in profiles])
    distances = {
        "gap_distance": (at_core / boundary.gap.function(Groups(0.0, LOAD, ROUGHNESS), x[core]) - 1, "rough contact"),
        "film_distance": (at_core / smooth.profile(x[core]).gap - 1, "film of the smooth contact at the largest speed"),
        "contact_distance": (contact[:, core] - dry[core], "Hertz pressure, in p_Hz"),
        "fluid_distance": (fluid[:, core] - dry[core], "Hertz pressure, in p_Hz"),
    }
    furthest = {name: np.abs(values).max(axis=1) for name, (values, _) in distances.items()}
    shares = np.array([state.fluid_load_share for state in states])
    rise = np.diff(contact, axis=0)
    step, place = np.unravel_index(np.argmax(rise), rise.shape)
    finding = (
        f"inside {CORE_HALF_WIDTH} a, gap and contact pressure of the slowest profile are within "
        f"{100 * furthest['gap_distance'][0]:.0f} "
        f"% and {furthest['contact_distance'][0]:.2f} p_Hz of the limit at rest, as the fluid pressure, still almost odd in "
        f"x, reaches {fluid[0].max():.2f} p_Hz where it carries {100 * shares[0]:.1f} % of the load; the fluid pressure of "
        f"the fastest is within {furthest['fluid_distance'][-1]:.2f} p_Hz of Hertz, carries {100 * shares[-1]:.1f} % and "
        f"holds the gap within {100 * furthest['film_distance'][-1]:.1g} % of the smooth film. The contact pressure falls as "
        f"a whole, not everywhere: at x = {x[place]:.2f} a it grows by {rise[step, place]:.2f} p_Hz between two of the speeds."
    )
    work.along(
        curve_speed=(curve.values, "speed group lambda of the curve"),
        speed=(SPEEDS, "speed group lambda of the profiles"),
        x=(x, "position over a"),
        inside=(inside, "position over a, inside the contact"),
    )
    work.give(
        "curve_speed",
        hersey_number=(curve.hersey_number, "Hersey number eta U/F_N of the curve for beta = 1"),
        friction=(curve.friction, "friction coefficient, definition published"),
    )
    friction = [state.friction(definition="published").total for state in states]
    work.give(
        "speed",
        profile_hersey=([state.groups.hersey_number() for state in states], "Hersey number of the profiles"),
        profile_friction=(friction, "friction coefficient there"),
        fluid_load_share=(shares, "part of the load on the fluid"),
        central_gap=([state.central_gap for state in states], "gap at x = 0 over u_Hz"),
    )
    work.give(
        ("speed", "x"),
        gap=(gaps, "gap over u_Hz"),
        fluid_pressure=(fluid, "fluid pressure over p_Hz"),
        contact_pressure=(contact, "contact pressure over p_Hz"),
    )
    work.give("inside", rough_contact=(rough_contact, "rough-contact gap over u_Hz"))
    work.give("x", hertz_pressure=(dry, "Hertz pressure over p_Hz"))
    for name, (_, what) in distances.items():
        words = f"largest distance from the {what}, for |x| < {CORE_HALF_WIDTH} a"
        work.give("speed", **{name: (furthest[name], words)})
    return work.dataset(finding, load_group=LOAD, roughness_group=ROUGHNESS)


def draw(figure: Figure, data: Dataset) -> None:
    """Draw the curve, and gap and pressures of the profiles."""
    a, b, c, d = style.panels(figure, 2, 2)
    _draw_curve(a, data)
    for axes, name in ((b, "gap"), (c, "fluid_pressure"), (d, "contact_pressure")):
        style.steps(axes, data[name], lw=1.5)
        axes.set_xlabel("$x/a$")
    style.limit(b, data.rough_contact, "rough contact", color=style.CYAN, lw=1.8)
    legend = {"loc": "upper center", "title": r"speed $\lambda$", "ncols": 2}
    style.panel(b, "b", "gap", legend, yscale="log", ylabel=r"$h/u_\mathrm{Hz}$", ylim=(8e-4, 0.8))
    for axes, which, text, kind in ((c, "c", "fluid pressure", "f"), (d, "d", "contact pressure", "c")):
        style.limit(axes, data.hertz_pressure, "Hertz")
        axes.axhline(0.0, color=style.GREY, lw=0.6)
        legend = {"loc": "upper left", "handles": axes.lines[-2:-1]}
        style.panel(axes, which, text, legend, ylabel=rf"$p_{kind}/p_\mathrm{{Hz}}$", ylim=(-0.24, 1.1))
    low = float(data.fluid_pressure.min())
    c.annotate(
        "negative:\nno cavitation", (1.05, low), (1.56, 0.3), size=8, color=style.GREY, ha="right",
        arrowprops={"arrowstyle": "->", "color": style.GREY, "lw": 0.8},
    )  # fmt: skip


def _draw_curve(axes: Axes, data: Dataset) -> None:
    axes.loglog(data.hersey_number, data.friction, color=style.INK, lw=1.2)
    every = slice(None, None, 3)
    axes.plot(data.hersey_number[every], data.friction[every], "o", color=style.INK, ms=3, mfc="white")
    colours = style.sequence(len(data.speed))
    for colour, place, value in zip(colours, data.profile_hersey.values, data.profile_friction.values, strict=True):
        axes.axvline(place, color=colour, lw=1.6, zorder=0)
        axes.plot(place, value, "o", color=colour, ms=7, mec="white", zorder=5)
    axes.set_xlim(float(data.hersey_number[0]), float(data.hersey_number[-1]))
    load, roughness = (style.power(data.attrs[f"{name}_group"]) for name in ("load", "roughness"))
    text = rf"Stribeck curve, $\bar F_N$ = {load}, $\bar h_\mathrm{{rms}}$ = {roughness}"
    y = r"friction coefficient $\mu$"
    style.panel(axes, "a", text, xlabel=r"Hersey number $\eta U/F_N$", ylabel=y, ylim=(1e-2, 3))
