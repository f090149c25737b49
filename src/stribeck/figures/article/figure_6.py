"""Figure 6: gaps of contacts at rest, nearly smooth and very rough, and the scales on which they are one curve."""

from __future__ import annotations

import numpy as np

from stribeck._types import Array
from stribeck.asymptotics import boundary, edge_layer
from stribeck.contacts.groups import Groups
from stribeck.figures import style
from stribeck.figures.job import FigureJob
from stribeck.figures.style import Axes, Dataset, Figure
from stribeck.solids import hertz
from stribeck.solver.solution import Solution

TITLE = "Gaps in the quasistatic limit"
CLAIM = (
    "the rough-contact solution perfectly describes the contact region, its edges collapse onto one universal boundary "
    "layer, and very rough contacts are rescaled by (a h0)^(1/2) (caption) or (R h0)^(1/2) (text) to a perfect collapse."
)

SMALL_KAPPAS = (1e-5, 1e-4, 1e-3, 1e-2, 1e-1)  # Relative roughness h_rms/F of large indentation.
LARGE_KAPPAS = (1.0, 3.0, 10.0, 30.0, 100.0)  # Relative roughness h_rms/F of small indentation.

LOADS = (0.1, 0.01, 0.001)  # Load groups: that of the figure, and others at which a scale of its caption is seen to be wrong.
STEPS = len(SMALL_KAPPAS) + len(LARGE_KAPPAS) + len(LOADS)


def compute(work: FigureJob) -> Dataset:
    """Solve contacts at rest and scale their gaps."""
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
        f"at kappa = {SMALL_KAPPAS[at]:g} the rough-contact gap is within {core_distance[at]:.2g} h_rms/alpha of the solver "
        f"inside 0.9 a, and the edge within {edge_distance[at]:.2g} of the similarity solution, {shifted_distance[at]:.2g} if "
        f"it is taken at a (1 - kappa); very rough contacts are within {rigid_at[-1]} of the parabola at kappa = "
        f"{LARGE_KAPPAS[-1]:g} and {rigid_at[0]} off at {LARGE_KAPPAS[0]:g}. The caption's scale (a h0)^(1/2) gives no common "
        f"curve: at its value 4 the gap of loads {', '.join(map(str, LOADS))} is {ends} h0; with the text's (R h0)^(1/2) it "
        "is 9 h0."
    )
    work.along(
        kappa_small=(SMALL_KAPPAS, "relative roughness kappa, large indentation"),
        kappa_large=(LARGE_KAPPAS, "relative roughness kappa, small indentation"),
        load=(LOADS, "load group"),
        x=(x, "position over a"),
        inside=(inside, "position over a, inside the contact"),
        x_rough=(x_rough, "position over a"),
        xi=(xi, "(x/a - 1)/kappa^(2/3)"),
        ratio=(ratio, "x/(R h0)^(1/2)"),
    )
    work.give(("kappa_small", "x"), large_gap=([s.profile(x).gap for s in large], "gap over u_Hz, large indentation"))
    work.give("x", hertz_gap=(hertz.gap(x), "gap of the dry smooth contact over u_Hz"))
    work.give(("kappa_small", "inside"), core_gap=(core, "gap over h_rms/alpha inside the contact"))
    work.give("inside", rough_contact=(rough_contact, "rough-contact gap over h_rms/alpha"))
    work.give(("kappa_large", "x_rough"), small_gap=([s.profile(x_rough).gap for s in small], "gap over u_Hz"))
    work.give(("kappa_small", "xi"), edge_gap=(edge, "gap over h_rms/alpha + ln(F)/2 + ln(kappa)/3"))
    work.give("xi", edge_limit=(edge_limit, "the same as kappa tends to zero, from the similarity problem of the edge"))
    work.give(("kappa_large", "ratio"), rigid_gap=(rigid, "gap over the film h0 of small indentation"))
    work.give("ratio", parabola=(parabola, "rigid cylinder, 1 + x^2/(2 R h0)"))
    work.give(("load", "ratio"), printed_gap=(printed, "gap over h0 where ratio means x/(a h0)^(1/2), as printed"))
    work.give(
        "kappa_small",
        core_distance=(core_distance, "largest distance from rough_contact for |x| < 0.9 a"),
        edge_distance=(edge_distance, "largest distance of edge_gap from edge_limit for |xi| < 3"),
        shifted_distance=(shifted_distance, "the same where xi is counted from the edge at 1 - kappa"),
    )
    work.give("kappa_large", rigid_distance=(rigid_distance, "largest distance of rigid_gap from parabola, relative"))
    return work.dataset(finding, load_group=load)


def draw(figure: Figure, data: Dataset) -> None:
    """Draw the gaps, their collapse, how far they are from it, and the scale of the caption."""
    a, c, e, b, d, f = style.panels(figure, 2, 3, width_ratios=[1.1, 1, 0.95])
    style.steps(a, data.large_gap)
    style.steps(c, data.edge_gap)
    style.steps(b, data.small_gap)
    style.steps(d, data.rigid_gap)
    style.limit(a, data.hertz_gap, "Hertz")
    style.limit(c, data.edge_limit, "similarity solution")
    style.limit(d, data.parabola, r"$1 + x^2/2R\tilde h_0$")
    shown, gap = {"title": r"$\kappa$", "ncols": 2}, r"$h/u_\mathrm{Hz}$"
    centred = shown | {"loc": "upper center"}
    style.panel(a, "a", r"large indentation, $\kappa \ll 1$", centred, xlabel="$x/a$", ylabel=gap, ylim=(-0.02, 0.9))
    x = r"$(x/a - 1)/\kappa^{2/3}$"
    y = r"$\alpha h/h_\mathrm{rms} + \frac{1}{2} \ln \bar F_N + \frac{1}{3} \ln \kappa$"
    of_edges = shown | {"loc": "upper left", "ncols": 1}
    style.panel(c, "c", "edges on their own scales", of_edges, xlabel=x, ylabel=y, ylim=(-2, 8))
    below = shown | {"loc": "lower left", "ncols": 3}
    of_small = {"xlabel": "$x/a$", "ylabel": gap, "yscale": "log", "ylim": (0.15, 1e3)}
    style.panel(b, "b", r"small indentation, $\kappa \gg 1$", below, **of_small)
    over_film = {"xlabel": r"$x/\sqrt{R \tilde h_0}$", "ylabel": r"$h/\tilde h_0$", "ylim": (0, 9)}
    style.panel(d, "d", "over the film of small indentation", centred, **over_film)
    _draw_distances(e, data)
    for colour, load, of_load in zip(
        (style.INK, style.CONTACT, style.FLUID), data["load"].values, data.printed_gap.values, strict=True
    ):
        f.plot(data.ratio, of_load, color=colour, lw=1.4, label=style.power(load))
    style.limit(f, data.parabola, "$1 + X^2/2$")
    as_printed = over_film | {"xlabel": r"$X = x/\sqrt{a \tilde h_0}$, as printed", "xlim": (-4, 4)}
    text = rf"the caption's scale, $\kappa$ = {float(data.kappa_large[-1]):g}"
    style.panel(f, "+", text, centred | {"title": r"load $\bar F_N$"}, **as_printed)
    inset = style.inset(a, (0.3, 0.13, 0.4, 0.4), r"$\alpha h/h_\mathrm{rms}$")  # the contact in units of the roughness
    style.steps(inset, data.core_gap, lw=1.0)
    style.limit(inset, data.rough_contact, "rough contact", color=style.CYAN, lw=1.6)
    inset.set(ylim=(0.8, 4.2), xlim=(-1, 1))
    style.small_legend(inset, handles=inset.lines[-1:], loc="upper center", fontsize=7)


def _draw_distances(axes: Axes, data: Dataset) -> None:
    for x, name, colour, label in (
        ("kappa_small", "edge_distance", style.FLUID, r"(c) from its limit"),
        ("kappa_small", "shifted_distance", style.MARK, r"edge taken at $x = a(1 - \kappa)$"),
        ("kappa_small", "core_distance", style.CONTACT, r"rough contact, $|x| < 0.9 a$"),
        ("kappa_large", "rigid_distance", style.GREEN, "(d) from the parabola"),
    ):
        axes.loglog(data[x], data[name], "o-", color=colour, ms=5, lw=0.9, label=label)
    y = r"largest distance [$h_\mathrm{rms}/\alpha$; (d) relative]"
    settings = {"xlabel": r"relative roughness $\kappa$", "ylabel": y, "ylim": (1e-5, 3e4)}
    style.panel(axes, "+", "distances from the limits", {"loc": "upper center"}, **settings)
