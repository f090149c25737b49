"""Figure S1: fluid pressure and gap of slow rough contacts against their expansion in the speed, to second order."""

from __future__ import annotations

import numpy as np

from stribeck._types import Array, Flags
from stribeck.asymptotics import perturbation
from stribeck.contacts.groups import Groups
from stribeck.figures import style
from stribeck.figures.job import FigureJob
from stribeck.figures.style import Axes, Dataset, Figure
from stribeck.solver.solution import Solution

TITLE = "Expansion of slow rough contacts in the speed"
CLAIM = (
    "p_f over lambda, the odd part of h over lambda and the even part of p_f over lambda^2 show excellent agreement "
    "with the expansion to second order."
)
SIZE = 11.0, 7.0

LOAD = 0.1  # Load group of the profiles.
KAPPAS = (1e-3, 1e-4)  # Relative roughness: that of the panels, and one that shows what is left of the distance at slow speed.

# Fluid numbers lambda/kappa**2 of the profiles: 0.01 to 32, where the fluid carries most of the load.
FLUID_NUMBERS = tuple(10.0 ** (exponent / 2) for exponent in range(-4, 4))

STEPS = len(KAPPAS) * len(FLUID_NUMBERS)
RTOL = 1e-8  # Relative tolerance: at the slowest speed the part of second order is 1e-3 of the pressure.

CORE_HALF_WIDTH = 0.9  # Half-width [a] in which profiles are compared with the expansion.
# Panels: what they show in words, on their axis, and in which power of ten.
PANEL_PARTS = {
    "first_pressure": ("p_f / lambda, in p_Hz over the speed group", r"$p_f/\lambda$", 3),
    "first_gap": ("odd part of the gap / lambda, in u_Hz over the speed group", r"$\mathrm{Asym}[h]/\lambda$", 0),
    "second_pressure": ("even part of p_f / lambda^2, in p_Hz over its square", r"$\mathrm{Sym}[p_f]/\lambda^2$", 9),
}

PANEL_LABELS = (
    r"fluid pressure over $\lambda$",
    r"odd part of the gap over $\lambda$",
    r"even part of $p_f$ over $\lambda^2$",
)


def compute(work: FigureJob) -> Dataset:
    """Solve slow contacts and compare them with their expansion."""
    x = np.linspace(-1.2, 1.2, 481)
    near = np.abs(x) < 0.999
    core = np.abs(x) <= CORE_HALF_WIDTH
    speeds = np.array(KAPPAS)[:, None] ** 2 * np.array(FLUID_NUMBERS)
    solved, laws = (np.empty((len(PANEL_PARTS), len(KAPPAS), *shape)) for shape in ((len(FLUID_NUMBERS), len(x)), (len(x),)))
    for i, kappa in enumerate(KAPPAS):
        for j, speed in enumerate(speeds[i]):
            solved[:, i, j] = _parts(work.solve(float(speed), LOAD, LOAD * kappa), x)
        slow = Groups(float(speeds[i, 0]), LOAD, LOAD * kappa)
        laws[:, i] = _laws(slow, x, near)
    largest = np.abs(laws[..., core]).max(axis=-1)
    distance = np.abs(solved - laws[:, :, None])[..., core].max(axis=-1) / largest[..., None]
    change = np.abs(solved - solved[:, :, :1])[..., core].max(axis=-1) / largest[..., None]
    rates = [
        np.log(change[k, 1, 4] / change[k, 1, 3]) / np.log(FLUID_NUMBERS[4] / FLUID_NUMBERS[3])
        for k in range(len(PANEL_PARTS))
    ]
    left = [", ".join(f"{100 * value:.1f}" for value in distance[:, i, 0]) for i in range(len(KAPPAS))]
    finding = (
        f"inside {CORE_HALF_WIDTH} a the quantities of panels a, b, c come within {left[0]} % of the formulas as the "
        "speed falls, at "
        f"kappa = {KAPPAS[0]:g}, and within {left[1]} % at {KAPPAS[1]:g}: that rest is the price of small kappa and stays at "
        f"any speed. What vanishes with the speed goes as its powers {rates[0]:.2f}, {rates[1]:.2f} and {rates[2]:.2f}. At "
        f"lambda = kappa^2, kappa = {KAPPAS[1]:g}, the formula of a is {100 * distance[0, 1, 4]:.0f} % off and that of c, "
        f"which gives the load, {100 * distance[2, 1, 4]:.0f} %."
    )
    work.along(
        kappa=(KAPPAS, "relative roughness kappa"),
        number=(FLUID_NUMBERS, "fluid number lambda/kappa^2"),
        x=(x, "position over a"),
    )
    work.give(("kappa", "number"), speed=(speeds, "speed group lambda"))
    for k, (name, (words, *_)) in enumerate(PANEL_PARTS.items()):
        apart = f"largest distance of {name} from its formula for |x| < {CORE_HALF_WIDTH} a, over its largest value"
        work.give(("number", "x"), **{name: (solved[k, 0], f"{words}, kappa = {KAPPAS[0]:g}")})
        work.give("x", **{f"{name}_law": (laws[k, 0], f"its formula; nan outside the contact ({words})")})
        changed = f"the same from {name} at the slowest speed"
        of_speed = {f"{name}_distance": (distance[k], apart), f"{name}_change": (change[k], changed)}
        work.give(("kappa", "number"), **of_speed)
    return work.dataset(finding, load_group=LOAD)


def _parts(solution: Solution, x: Array) -> Array:
    """Return p_f over the speed, the odd part of the gap over it, and the even part of p_f over its square."""
    speed = float(solution.groups.speed)
    ahead, behind = solution.profile(x), solution.profile(-x)
    return np.array(
        [
            ahead.fluid_pressure / speed,
            (ahead.gap - behind.gap) / (2 * speed),
            (ahead.fluid_pressure + behind.fluid_pressure) / (2 * speed**2),
        ]
    )


def _laws(groups: Groups, x: Array, near: Flags) -> Array:
    """Return the formulas of the same, taken apart into odd and even parts, nan at the edge and beyond."""
    speed = float(groups.speed)
    inside = x[near]
    gap = perturbation.gap_first.function(groups, inside)
    first = perturbation.fluid_pressure_first.function(groups, inside)
    both = perturbation.fluid_pressure_second.function(groups, inside)
    found = np.full((len(PANEL_PARTS), len(x)), np.nan)
    found[0, near] = first / speed
    found[1, near] = (gap - perturbation.gap_first.function(groups, -inside)) / (2 * speed)
    found[2, near] = (both - first) / speed**2
    return found


def draw(figure: Figure, data: Dataset) -> None:
    """Draw each part of the expansion, and how far it is from the solver."""
    *fields, d = style.panels(figure, 2, 2)
    for axes, which, text, (name, (_, label, power)) in zip(fields, "abc", PANEL_LABELS, PANEL_PARTS.items(), strict=True):
        style.steps(axes, data[name] / 10**power, lw=1.3, by=data.speed[0])
        law = data[f"{name}_law"] / 10**power
        style.limit(axes, law, "formula", lw=1.6)
        low, high = float(law.min()), float(law.max())
        ends = low - 0.25 * (high - low), high + 0.2 * (high - low)
        legend = {"loc": "upper left", "title": r"speed $\lambda$", "fontsize": 7.5} if which == "c" else None
        title = rf"{text}, $\kappa$ = {style.power(float(data.kappa[0]))}"
        style.panel(axes, which, title, legend, xlabel="$x/a$", ylabel=label + f"  $[10^{power}]$" * bool(power), ylim=ends)
    _draw_distances(d, data)


def _draw_distances(axes: Axes, data: Dataset) -> None:
    for (name, (_, label, _)), colour in zip(PANEL_PARTS.items(), (style.FLUID, style.GREEN, style.MARK), strict=True):
        for values, kappa, dashes, face in zip(
            data[f"{name}_distance"].values, data.kappa.values, ("-", style.DOTTED), (colour, "white"), strict=True
        ):
            axes.loglog(
                data.number, values, "o", ls=dashes, color=colour, mfc=face, ms=5, lw=1.0,
                label=rf"{label}, $\kappa$ = {style.power(kappa)}",
            )  # fmt: skip
    style.slope(axes, 0.35, 8e-4, 2.0, "2", decades=0.5)
    style.slope(axes, 0.014, 0.0012, 1.0, "1", decades=0.5)
    text = rf"distance of a, b, c from the formulas, $|x| < {CORE_HALF_WIDTH}\,a$"
    legend = {"loc": "upper left", "fontsize": 7.5, "ncols": 2}
    x, y = r"fluid number $\lambda/\kappa^2$", "largest relative distance"
    style.panel(axes, "+", text, legend, xlabel=x, ylabel=y, ylim=(5e-4, 20))
