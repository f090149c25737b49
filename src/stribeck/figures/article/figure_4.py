"""Figure 4: gaps of smooth contacts, slow and fast, as they are and on the scales that make them one curve."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from stribeck._types import Array
from stribeck.asymptotics.constants import FILM_CONSTANT
from stribeck.asymptotics.smooth import film_layers
from stribeck.figures import style
from stribeck.figures.build import FigureJob, column, dataset
from stribeck.figures.paper_figure import PaperFigure, Report
from stribeck.solids import hertz

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SLOW_SPEEDS = (1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2)  # Speed groups of panel (a).
FAST_SPEEDS = (1.0, 10.0, 1e2, 1e3, 1e4, 1e5)  # Speed groups of panel (b).
LOAD = 0.1  # Load group, on which smooth contacts do not depend.


def _compute(report: Report) -> xarray.Dataset:
    work = FigureJob(report, steps=len(SLOW_SPEEDS) + len(FAST_SPEEDS))
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
        "fast films within "
        f"{rest} of the parabola at speed {FAST_SPEEDS[-1]:g}, but {100 * rigid_distance[1]:.0f} % off at "
        f"{FAST_SPEEDS[1]:g}. The distances "
        f"go as speed to the powers {orders[0]:.2f} and {orders[1]:.2f}: the collapse is that of a limit, not exact."
    )
    variables = {
        "slow_gap": column(("slow_speed", "x_slow"), [s.profile(x_slow).gap for s in slow], "gap over u_Hz, slow"),
        "hertz_gap": column("x_slow", hertz.gap(x_slow), "gap of the dry smooth contact over u_Hz"),
        "fast_gap": column(("fast_speed", "x_fast"), [s.profile(x_fast).gap for s in fast], "gap over u_Hz, fast"),
        "outlet_gap": column(("slow_speed", "xi"), outlet, "gap at the outlet over c lambda^(3/5) u_Hz"),
        "outlet_limit": column(
            "xi", outlet_limit, "the same as speed tends to zero, from the similarity problem of the outlet"
        ),
        "rigid_gap": column(("fast_speed", "ratio"), rigid, "gap over the film h0 of the rigid cylinder"),
        "parabola": column("ratio", parabola, "rigid cylinder, 1 + x^2/(2 R h0)"),
        "outlet_distance": column(
            "slow_speed", outlet_distance, "largest distance of outlet_gap from outlet_limit, relative, |xi| < 3"
        ),
        "rigid_distance": column("fast_speed", rigid_distance, "largest distance of rigid_gap from parabola, relative"),
    }
    coords = {
        "slow_speed": column("slow_speed", SLOW_SPEEDS, "speed group lambda, slow"),
        "fast_speed": column("fast_speed", FAST_SPEEDS, "speed group lambda, fast"),
        "x_slow": column("x_slow", x_slow, "position over a"),
        "x_fast": column("x_fast", x_fast, "position over a"),
        "xi": column("xi", xi, "(x/a - 1)/lambda^(2/5)"),
        "ratio": column("ratio", ratio, "x/(R h0)^(1/2)"),
    }
    return dataset(variables, coords, finding=finding, film_constant=FILM_CONSTANT, **work.attributes)


def _draw(data: xarray.Dataset) -> Figure:
    figure = style.new_figure(data, 12.0, 6.6)
    a, c, e, b, d, f = style.panels(figure, 2, 3, width_ratios=[1.1, 1, 0.9])
    slow, fast = data.slow_speed.values, data.fast_speed.values
    for axes, x, name, speeds in (
        (a, "x_slow", "slow_gap", slow),
        (c, "xi", "outlet_gap", slow),
        (b, "x_fast", "fast_gap", fast),
        (d, "ratio", "rigid_gap", fast),
    ):
        for colour, speed, gap in zip(style.sequence(len(speeds)), speeds, data[name].values, strict=True):
            axes.plot(data[x], gap, color=colour, lw=1.4, label=style.power(speed))
        axes.set_xlim(float(data[x][0]), float(data[x][-1]))
    a.plot(data.x_slow, data.hertz_gap, color=style.INK, lw=1.2, ls=style.DASHED, label="Hertz")
    a.set(xlabel="$x/a$", ylabel=r"$h/u_\mathrm{Hz}$", ylim=(-0.03, 1.25))
    style.letter(a, "a", r"slow, $\lambda \ll 1$")
    style.legend(a, loc="upper center", title=r"speed $\lambda$", ncols=2)
    _zoom(a, data)
    c.plot(data.xi, data.outlet_limit, color=style.INK, lw=1.2, ls=style.DASHED, label="similarity solution")
    c.set(xlabel=r"$(x/a - 1)/\lambda^{2/5}$", ylabel=r"$h/(c \lambda^{3/5} u_\mathrm{Hz})$", ylim=(0, 5))
    style.letter(c, "c", "outlets on their own scales")
    style.legend(c, loc="upper left", title=r"speed $\lambda$")
    b.set(xlabel="$x/a$", ylabel=r"$h/u_\mathrm{Hz}$", yscale="log")
    style.letter(b, "b", r"fast, $\lambda \gg 1$")
    style.legend(b, loc="lower left", title=r"speed $\lambda$", ncols=3)
    b.set_ylim(0.03, 2e3)
    d.plot(data.ratio, data.parabola, color=style.INK, lw=1.2, ls=style.DASHED, label=r"$1 + x^2/2Rh_0$")
    d.set(xlabel=r"$x/\sqrt{R h_0}$", ylabel=r"$h/h_0$", ylim=(0, 9))
    style.letter(d, "d", "over the film of the rigid cylinder")
    style.legend(d, loc="upper center", title=r"speed $\lambda$", ncols=2)
    _draw_distance(e, slow, data.outlet_distance.values, 0.4, "2/5")
    style.letter(e, "+", "distance of (c) from the limit")
    _draw_distance(f, fast, data.rigid_distance.values, -1 / 3, "−1/3")
    style.letter(f, "+", "distance of (d) from the parabola")
    return figure


def _zoom(axes: Axes, data: xarray.Dataset) -> None:
    """Draw the outlet of panel (a) on a logarithmic scale in its middle."""
    inset = axes.inset_axes((0.3, 0.12, 0.42, 0.4))
    style.house_style(inset)
    inside = (data.x_slow > 0.6) & (data.x_slow < 1.2)
    for colour, gap in zip(style.sequence(len(data.slow_speed)), data.slow_gap.values, strict=True):
        inset.semilogy(data.x_slow[inside], gap[inside], color=colour, lw=1.0)
    inset.set_title("outlet", size=8, color=style.GREY, pad=2)
    inset.tick_params(labelsize=7)
    inset.set_xlim(0.6, 1.2)


def _draw_distance(axes: Axes, speeds: Array, distance: Array, exponent: float, text: str) -> None:
    axes.loglog(speeds, distance, color=style.GREY, lw=0.8)
    for colour, speed, value in zip(style.sequence(len(speeds)), speeds, distance, strict=True):
        axes.plot(speed, value, "o", color=colour, ms=6)
    ends = 10 ** np.floor(np.log10(distance.min())), 10 ** np.ceil(np.log10(distance.max()))
    axes.set(xlabel=r"speed $\lambda$", ylabel="largest relative distance", ylim=ends)
    style.slope(axes, speeds[-3], 0.35 * min(distance[-3:]) if exponent > 0 else 1.6 * distance[-3], exponent, text)


FIGURE = PaperFigure(
    name="4",
    title="Gaps in the smooth limit",
    claim="rescaling by the film and the width of the boundary layer yields an almost perfect collapse of the outlets at slow "
    "speed; rescaling by the film of the rigid cylinder a perfect collapse onto a parabola at fast speed.",
    compute=_compute,
    draw=_draw,
)
