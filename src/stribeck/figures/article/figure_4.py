"""Figure 4: gaps of smooth contacts, slow and fast, as they are and on the scales that make them one curve."""

from __future__ import annotations

import numpy as np

from stribeck.asymptotics import film_layers
from stribeck.asymptotics.constants import FILM_CONSTANT
from stribeck.figures import style
from stribeck.figures.job import FigureJob
from stribeck.figures.style import Axes, DataArray, Dataset, Figure
from stribeck.solids import hertz

TITLE = "Gaps in the smooth limit"
CLAIM = (
    "rescaling by the film and the width of the boundary layer yields an almost perfect collapse of the outlets at slow "
    "speed; rescaling by the film of the rigid cylinder a perfect collapse onto a parabola at fast speed."
)

SLOW_SPEEDS = (1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2)  # Speed groups of panel (a).
FAST_SPEEDS = (1.0, 10.0, 1e2, 1e3, 1e4, 1e5)  # Speed groups of panel (b).
STEPS = len(SLOW_SPEEDS) + len(FAST_SPEEDS)
LOAD = 0.1  # Load group, on which smooth contacts do not depend.


def compute(work: FigureJob) -> Dataset:
    """Solve slow and fast contacts and scale their gaps."""
    x_slow, xi = np.linspace(-2, 2, 801), np.linspace(-6, 4, 401)
    x_fast, ratio = np.linspace(-8, 8, 401), np.linspace(-4, 4, 321)
    slow = [work.solve(speed, LOAD, 0.0) for speed in SLOW_SPEEDS]
    fast = [work.solve(speed, LOAD, 0.0) for speed in FAST_SPEEDS]
    layer = film_layers.outlet()
    outlet = [
        s.profile(1 + xi * speed**0.4).gap / (FILM_CONSTANT * speed**0.6) for s, speed in zip(slow, SLOW_SPEEDS, strict=True)
    ]
    outlet_limit = layer.gap(xi) / layer.constant
    films = np.array(FAST_SPEEDS) ** (2 / 3) / 24 ** (1 / 3)
    rigid = np.array([s.profile(ratio * film**0.5).gap / film for s, film in zip(fast, films, strict=True)])
    parabola = 1 + 0.5 * ratio**2
    outlet_distance = np.abs(np.array(outlet) / outlet_limit - 1)[:, np.abs(xi) <= 3].max(axis=1)
    rigid_distance = np.abs(rigid / parabola - 1).max(axis=1)
    orders = [
        np.polyfit(np.log(a), np.log(b), 1)[0]
        for a, b in ((SLOW_SPEEDS[:3], outlet_distance[:3]), (FAST_SPEEDS[3:], rigid_distance[3:]))
    ]
    near, far, rest = (f"{100 * value:.2g} %" for value in (outlet_distance[0], outlet_distance[-1], rigid_distance[-1]))
    finding = (
        f"the outlets lie within {near} of their limit at speed {SLOW_SPEEDS[0]:g} and {far} at {SLOW_SPEEDS[-1]:g}; "
        f"fast films within {rest} of the parabola at speed {FAST_SPEEDS[-1]:g}, but {100 * rigid_distance[1]:.0f} % off at "
        f"{FAST_SPEEDS[1]:g}. The distances "
        f"go as speed to the powers {orders[0]:.2f} and {orders[1]:.2f}: the collapse is that of a limit, not exact."
    )
    work.along(
        slow_speed=(SLOW_SPEEDS, "speed group lambda, slow"),
        fast_speed=(FAST_SPEEDS, "speed group lambda, fast"),
        x_slow=(x_slow, "position over a"),
        x_fast=(x_fast, "position over a"),
        xi=(xi, "(x/a - 1)/lambda^(2/5)"),
        ratio=(ratio, "x/(R h0)^(1/2)"),
    )
    work.give(("slow_speed", "x_slow"), slow_gap=([s.profile(x_slow).gap for s in slow], "gap over u_Hz, slow"))
    work.give("x_slow", hertz_gap=(hertz.gap(x_slow), "gap of the dry smooth contact over u_Hz"))
    work.give(("fast_speed", "x_fast"), fast_gap=([s.profile(x_fast).gap for s in fast], "gap over u_Hz, fast"))
    work.give(("slow_speed", "xi"), outlet_gap=(outlet, "gap at the outlet over c lambda^(3/5) u_Hz"))
    work.give("xi", outlet_limit=(outlet_limit, "the same as speed tends to zero, from the similarity problem of the outlet"))
    work.give(("fast_speed", "ratio"), rigid_gap=(rigid, "gap over the film h0 of the rigid cylinder"))
    work.give("ratio", parabola=(parabola, "rigid cylinder, 1 + x^2/(2 R h0)"))
    near_words = "largest distance of outlet_gap from outlet_limit, relative, |xi| < 3"
    work.give("slow_speed", outlet_distance=(outlet_distance, near_words))
    work.give("fast_speed", rigid_distance=(rigid_distance, "largest distance of rigid_gap from parabola, relative"))
    return work.dataset(finding, film_constant=FILM_CONSTANT)


def draw(figure: Figure, data: Dataset) -> None:
    """Draw the gaps, their collapse, and how far they are from it."""
    a, c, e, b, d, f = style.panels(figure, 2, 3, width_ratios=[1.1, 1, 0.9])
    style.steps(a, data.slow_gap)
    style.steps(c, data.outlet_gap)
    style.steps(b, data.fast_gap)
    style.steps(d, data.rigid_gap)
    style.limit(a, data.hertz_gap, "Hertz")
    style.limit(c, data.outlet_limit, "similarity solution")
    style.limit(d, data.parabola, r"$1 + x^2/2Rh_0$")
    shown = {"title": r"speed $\lambda$", "ncols": 2}
    gap = r"$h/u_\mathrm{Hz}$"
    style.panel(
        a, "a", r"slow, $\lambda \ll 1$", shown | {"loc": "upper center"}, xlabel="$x/a$", ylabel=gap, ylim=(-0.03, 1.25)
    )
    x, y = r"$(x/a - 1)/\lambda^{2/5}$", r"$h/(c \lambda^{3/5} u_\mathrm{Hz})$"
    of_outlets = shown | {"loc": "upper left", "ncols": 1}
    style.panel(c, "c", "outlets on their own scales", of_outlets, xlabel=x, ylabel=y, ylim=(0, 5))
    of_fast = shown | {"loc": "lower left", "ncols": 3}
    style.panel(b, "b", r"fast, $\lambda \gg 1$", of_fast, xlabel="$x/a$", ylabel=gap, yscale="log", ylim=(0.03, 2e3))
    x, of_rigid = r"$x/\sqrt{R h_0}$", shown | {"loc": "upper center"}
    style.panel(d, "d", "over the film of the rigid cylinder", of_rigid, xlabel=x, ylabel=r"$h/h_0$", ylim=(0, 9))
    _draw_distance(e, data.outlet_distance, 0.4, "2/5")
    style.panel(e, "+", "distance of (c) from the limit")
    _draw_distance(f, data.rigid_distance, -1 / 3, "−1/3")
    style.panel(f, "+", "distance of (d) from the parabola")
    inset = style.inset(a, (0.3, 0.12, 0.42, 0.4), "outlet")
    style.steps(inset, data.slow_gap[:, (data.x_slow.values > 0.6) & (data.x_slow.values < 1.2)], lw=1.0)
    inset.set(yscale="log", xlim=(0.6, 1.2))


def _draw_distance(axes: Axes, distances: DataArray, exponent: float, text: str) -> None:
    speeds, distance = distances[distances.dims[0]].values, distances.values
    axes.loglog(speeds, distance, color=style.GREY, lw=0.8)
    for colour, speed, value in zip(style.sequence(len(speeds)), speeds, distance, strict=True):
        axes.plot(speed, value, "o", color=colour, ms=6)
    ends = 10 ** np.floor(np.log10(distance.min())), 10 ** np.ceil(np.log10(distance.max()))
    axes.set(xlabel=r"speed $\lambda$", ylabel="largest relative distance", ylim=ends)
    style.slope(axes, speeds[-3], 0.35 * min(distance[-3:]) if exponent > 0 else 1.6 * distance[-3], exponent, text)
