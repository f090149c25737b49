"""Figure 6: gaps of contacts at rest, nearly smooth and very rough, and the scales on which they are one curve."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from stribeck._types import Array
from stribeck.asymptotics.rough import boundary
from stribeck.asymptotics.smooth import edge_layer
from stribeck.contacts.groups import Groups
from stribeck.figures import style
from stribeck.figures.build import FigureJob, column, dataset
from stribeck.figures.paper_figure import PaperFigure, Report
from stribeck.solids import hertz
from stribeck.solver.solution import Solution

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SMALL_KAPPAS = (1e-5, 1e-4, 1e-3, 1e-2, 1e-1)  # Relative roughness h_rms/F of large indentation.
LARGE_KAPPAS = (1.0, 3.0, 10.0, 30.0, 100.0)  # Relative roughness h_rms/F of small indentation.

LOADS = (0.1, 0.01, 0.001)  # Load groups: that of the figure, and others at which a scale of its caption is seen to be wrong.


def _compute(report: Report) -> xarray.Dataset:
    work = FigureJob(report, steps=len(SMALL_KAPPAS) + len(LARGE_KAPPAS) + len(LOADS))
    load = LOADS[0]
    x, inside, x_rough = np.linspace(-1.6, 1.6, 641), np.linspace(-0.999, 0.999, 401), np.linspace(-8, 8, 401)
    xi, ratio = np.linspace(-6, 4, 401), np.linspace(-4, 4, 321)
    large = [work.solve(0.0, load, load * kappa) for kappa in SMALL_KAPPAS]
    small = [work.solve(0.0, load, load * kappa) for kappa in LARGE_KAPPAS]
    others = [work.solve(0.0, other, other * LARGE_KAPPAS[-1]) for other in LOADS]

    def at_edge(solution: Solution, shift: float = 0.0) -> Array:
        kappa = float(solution.groups.relative_roughness)
        gap = solution.profile(1 - shift * kappa + xi * kappa ** (2 / 3)).gap
        return np.asarray(gap / kappa + 0.5 * np.log(load) + np.log(kappa) / 3)

    def on_film(solution: Solution, positions: Array) -> Array:
        film = float(boundary.central_gap_small_indentation.function(solution.groups))
        return np.asarray(solution.profile(positions * film**0.5).gap / film)

    edge, edge_limit, near = np.array([at_edge(s) for s in large]), edge_layer.layer().gap(xi), np.abs(xi) <= 3
    rigid = np.array([on_film(s, ratio) for s in small])
    # sqrt(a h0), which the caption prints, over sqrt(R h0), for beta = 1.
    printed = [on_film(s, ratio * float(s.groups.slope()) ** 0.5) for s in others]
    core = np.array([s.profile(inside).gap / k for s, k in zip(large, SMALL_KAPPAS, strict=True)])
    rough_contact = boundary.gap.function(Groups(0.0, load, load), inside)
    parabola = 1 + 0.5 * ratio**2
    edge_distance = np.abs(edge - edge_limit)[:, near].max(axis=1)
    shifted_distance = [np.abs(at_edge(s, 1.0) - edge_limit)[near].max() for s in large]
    rigid_distance = np.abs(rigid / parabola - 1).max(axis=1)
    core_distance = np.abs(core - rough_contact)[:, np.abs(inside) <= 0.9].max(axis=1)
    at = 2
    rigid_at = [f"{100 * distance:.2g} %" for distance in rigid_distance]
    ends = ", ".join(f"{gap[-1]:.1f}" for gap in printed)
    finding = (
        f"at kappa = {SMALL_KAPPAS[at]:g} the rough-contact gap is within {core_distance[at]:.2g} h_rms/alpha of the "
        "solver inside "
        f"0.9 a, and the edge within {edge_distance[at]:.2g} of the similarity solution, {shifted_distance[at]:.2g} if it is "
        f"taken at a (1 - kappa); very rough contacts are within {rigid_at[-1]} of the parabola at kappa = "
        f"{LARGE_KAPPAS[-1]:g} and "
        f"{rigid_at[0]} off at {LARGE_KAPPAS[0]:g}. The caption's scale (a h0)^(1/2) gives no common curve: at its "
        "value 4 the gap "
        f"of loads {', '.join(map(str, LOADS))} is {ends} h0; with the text's (R h0)^(1/2) it is 9 h0."
    )
    variables = {
        "large_gap": column(("kappa_small", "x"), [s.profile(x).gap for s in large], "gap over u_Hz, large indentation"),
        "hertz_gap": column("x", hertz.gap(x), "gap of the dry smooth contact over u_Hz"),
        "core_gap": column(("kappa_small", "inside"), core, "gap over h_rms/alpha inside the contact"),
        "rough_contact": column("inside", rough_contact, "rough-contact gap over h_rms/alpha"),
        "small_gap": column(("kappa_large", "x_rough"), [s.profile(x_rough).gap for s in small], "gap over u_Hz"),
        "edge_gap": column(("kappa_small", "xi"), edge, "gap over h_rms/alpha + ln(F)/2 + ln(kappa)/3"),
        "edge_limit": column("xi", edge_limit, "the same as kappa tends to zero, from the similarity problem of the edge"),
        "rigid_gap": column(("kappa_large", "ratio"), rigid, "gap over the film h0 of small indentation"),
        "parabola": column("ratio", parabola, "rigid cylinder, 1 + x^2/(2 R h0)"),
        "printed_gap": column(("load", "ratio"), printed, "gap over h0 where ratio means x/(a h0)^(1/2), as printed"),
        "core_distance": column("kappa_small", core_distance, "largest distance from rough_contact for |x| < 0.9 a"),
        "edge_distance": column("kappa_small", edge_distance, "largest distance of edge_gap from edge_limit for |xi| < 3"),
        "shifted_distance": column("kappa_small", shifted_distance, "the same where xi is counted from the edge at 1 - kappa"),
        "rigid_distance": column("kappa_large", rigid_distance, "largest distance of rigid_gap from parabola, relative"),
    }
    coords = {
        "kappa_small": column("kappa_small", SMALL_KAPPAS, "relative roughness kappa, large indentation"),
        "kappa_large": column("kappa_large", LARGE_KAPPAS, "relative roughness kappa, small indentation"),
        "load": column("load", LOADS, "load group"),
        "x": column("x", x, "position over a"),
        "inside": column("inside", inside, "position over a, inside the contact"),
        "x_rough": column("x_rough", x_rough, "position over a"),
        "xi": column("xi", xi, "(x/a - 1)/kappa^(2/3)"),
        "ratio": column("ratio", ratio, "x/(R h0)^(1/2)"),
    }
    return dataset(variables, coords, finding=finding, load_group=load, **work.attributes)


def _draw(data: xarray.Dataset) -> Figure:
    figure = style.new_figure(data, 12.0, 6.6)
    a, c, e, b, d, f = style.panels(figure, 2, 3, width_ratios=[1.1, 1, 0.95])
    large, small = data.kappa_small.values, data.kappa_large.values
    for axes, x, name, values in (
        (a, "x", "large_gap", large),
        (c, "xi", "edge_gap", large),
        (b, "x_rough", "small_gap", small),
        (d, "ratio", "rigid_gap", small),
    ):
        for colour, kappa, gap in zip(style.sequence(len(values)), values, data[name].values, strict=True):
            axes.plot(data[x], gap, color=colour, lw=1.4, label=style.power(kappa))
        axes.set_xlim(float(data[x][0]), float(data[x][-1]))
    a.plot(data.x, data.hertz_gap, color=style.INK, lw=1.2, ls=style.DASHED, label="Hertz")
    a.set(xlabel="$x/a$", ylabel=r"$h/u_\mathrm{Hz}$", ylim=(-0.02, 0.9))
    style.letter(a, "a", r"large indentation, $\kappa \ll 1$")
    style.legend(a, loc="upper center", title=r"$\kappa$", ncols=2)
    _draw_core(a, data)
    c.plot(data.xi, data.edge_limit, color=style.INK, lw=1.2, ls=style.DASHED, label="similarity solution")
    c.set(xlabel=r"$(x/a - 1)/\kappa^{2/3}$", ylim=(-2, 8))
    c.set_ylabel(r"$\alpha h/h_\mathrm{rms} + \frac{1}{2} \ln \bar F_N + \frac{1}{3} \ln \kappa$")
    style.letter(c, "c", "edges on their own scales")
    style.legend(c, loc="upper left", title=r"$\kappa$")
    b.set(xlabel="$x/a$", ylabel=r"$h/u_\mathrm{Hz}$", yscale="log", ylim=(0.15, 1e3))
    style.letter(b, "b", r"small indentation, $\kappa \gg 1$")
    style.legend(b, loc="lower left", title=r"$\kappa$", ncols=3)
    d.plot(data.ratio, data.parabola, color=style.INK, lw=1.2, ls=style.DASHED, label=r"$1 + x^2/2R\tilde h_0$")
    d.set(xlabel=r"$x/\sqrt{R \tilde h_0}$", ylabel=r"$h/\tilde h_0$", ylim=(0, 9))
    style.letter(d, "d", "over the film of small indentation")
    style.legend(d, loc="upper center", title=r"$\kappa$", ncols=2)
    _draw_distances(e, data)
    _draw_printed(f, data)
    return figure


def _draw_core(axes: Axes, data: xarray.Dataset) -> None:
    """Draw the contact in units of the roughness inside panel (a)."""
    inset = axes.inset_axes((0.3, 0.13, 0.4, 0.4))
    style.house_style(inset)
    for colour, gap in zip(style.sequence(len(data.kappa_small)), data.core_gap.values, strict=True):
        inset.plot(data.inside, gap, color=colour, lw=1.0)
    inset.plot(data.inside, data.rough_contact, color="#56b4e9", lw=1.6, ls=style.DASHED, label="rough contact")
    inset.set(ylim=(0.8, 4.2), xlim=(-1, 1))
    inset.set_title(r"$\alpha h/h_\mathrm{rms}$", size=8, color=style.GREY, pad=2)
    inset.tick_params(labelsize=7)
    style.legend(inset, loc="upper center", fontsize=7)


def _draw_distances(axes: Axes, data: xarray.Dataset) -> None:
    for x, name, colour, label in (
        ("kappa_small", "edge_distance", style.FLUID, r"(c) from its limit"),
        ("kappa_small", "shifted_distance", style.MARK, r"edge taken at $x = a(1 - \kappa)$"),
        ("kappa_small", "core_distance", style.CONTACT, r"rough contact, $|x| < 0.9 a$"),
        ("kappa_large", "rigid_distance", style.GREEN, "(d) from the parabola"),
    ):
        axes.loglog(data[x], data[name], "o-", color=colour, ms=5, lw=0.9, label=label)
    axes.set(
        xlabel=r"relative roughness $\kappa$",
        ylabel=r"largest distance [$h_\mathrm{rms}/\alpha$; (d) relative]",
        ylim=(1e-5, 3e4),
    )
    style.letter(axes, "+", "distances from the limits")
    style.legend(axes, loc="upper center")


def _draw_printed(axes: Axes, data: xarray.Dataset) -> None:
    for colour, load, gap in zip(
        (style.INK, style.CONTACT, style.FLUID), data["load"].values, data.printed_gap.values, strict=True
    ):
        axes.plot(data.ratio, gap, color=colour, lw=1.4, label=style.power(load))
    axes.plot(data.ratio, data.parabola, color=style.INK, lw=1.2, ls=style.DASHED, label="$1 + X^2/2$")
    axes.set(xlabel=r"$X = x/\sqrt{a \tilde h_0}$, as printed", ylabel=r"$h/\tilde h_0$", ylim=(0, 9))
    axes.set_xlim(float(data.ratio[0]), float(data.ratio[-1]))
    style.letter(axes, "+", rf"the caption's scale, $\kappa$ = {float(data.kappa_large[-1]):g}")
    style.legend(axes, loc="upper center", title=r"load $\bar F_N$", ncols=2)


FIGURE = PaperFigure(
    name="6",
    title="Gaps in the quasistatic limit",
    claim="the rough-contact solution perfectly describes the contact region, its edges collapse onto one universal boundary "
    "layer, and very rough contacts are rescaled by (a h0)^(1/2) (caption) or (R h0)^(1/2) (text) to a perfect collapse.",
    compute=_compute,
    draw=_draw,
)
