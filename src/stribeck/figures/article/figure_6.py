"""Figure 6: gaps of contacts at rest, nearly smooth and very rough, and the scales on which they are one curve."""

import numpy as np

from stribeck._types import Array
from stribeck.asymptotics import boundary, edge_layer
from stribeck.contacts.groups import Groups
from stribeck.figures import style
from stribeck.figures.job import FigureJob, Numbers, furthest
from stribeck.figures.style import Dataset, Panels
from stribeck.solids import hertz
from stribeck.solver.solution import Solution

SMALL_KAPPAS = (1e-5, 1e-4, 1e-3, 1e-2, 1e-1)  # Relative roughness h_rms/F of large indentation.
LARGE_KAPPAS = (1.0, 3.0, 10.0, 30.0, 100.0)  # Relative roughness h_rms/F of small indentation.
LOADS = (0.1, 0.01, 0.001)  # Load groups: that of the figure, and others at which a scale of its caption is seen to be wrong.
STEPS = len(SMALL_KAPPAS) + len(LARGE_KAPPAS) + len(LOADS)


def compute(work: FigureJob) -> Dataset:
    """Solve contacts at rest and scale their gaps."""
    data = Numbers(kappa_small=SMALL_KAPPAS, kappa_large=LARGE_KAPPAS, load=LOADS, load_group=LOADS[0])
    load, kappas = LOADS[0], np.array(SMALL_KAPPAS)[:, None]
    large, small = ([work.solve(0.0, load, load * kappa) for kappa in kappas] for kappas in (SMALL_KAPPAS, LARGE_KAPPAS))
    others = [work.solve(0.0, other, other * LARGE_KAPPAS[-1]) for other in LOADS]
    data.x, data.x_rough = np.linspace(-1.6, 1.6, 641), np.linspace(-8, 8, 401)
    data.xi, data.ratio, data.inside = np.linspace(-6, 4, 401), np.linspace(-4, 4, 321), np.linspace(-0.999, 0.999, 401)
    data.large_gap, data.hertz_gap = [state.profile(data.x).gap for state in large], hertz.gap(data.x)
    data.small_gap = [state.profile(data.x_rough).gap for state in small]
    data.core_gap = np.array([state.profile(data.inside).gap for state in large]) / kappas
    data.rough_contact = boundary.gap.function(Groups(0.0, load, load), data.inside)
    data.core_distance = furthest((data.core_gap - data.rough_contact)[:, np.abs(data.inside) <= 0.9])
    data.edge_limit, near = edge_layer.layer().gap(data.xi), np.abs(data.xi) <= 3

    def at_edge(shift: float) -> Array:
        places = 1 - shift * kappas + data.xi * kappas ** (2 / 3)
        gaps = [state.profile(row).gap for state, row in zip(large, places, strict=True)]
        return np.asarray(np.array(gaps) / kappas + 0.5 * np.log(load) + np.log(kappas) / 3)

    data.edge_gap = at_edge(0.0)
    data.edge_distance = furthest((data.edge_gap - data.edge_limit)[:, near])
    data.shifted_distance = furthest((at_edge(1.0) - data.edge_limit)[:, near])
    data.rigid_gap = np.array([_on_film(state, data.ratio) for state in small])
    data.parabola = 1 + 0.5 * data.ratio**2
    data.rigid_distance = furthest(data.rigid_gap / data.parabola - 1)
    # sqrt(a h0), which the caption prints, over sqrt(R h0), for beta = 1.
    data.printed_gap = np.array([_on_film(state, data.ratio * float(state.groups.slope()) ** 0.5) for state in others])
    data.ends = data.printed_gap[:, -1]
    return work.dataset(data)


def _on_film(solution: Solution, positions: Array) -> Array:
    """Return the gap over the film of small indentation, at positions over the root of film and radius."""
    film = float(boundary.central_gap_small_indentation.function(solution.groups))
    return np.asarray(solution.profile(positions * film**0.5).gap / film)


def draw(panels: Panels, data: Dataset) -> None:
    """Draw the gaps, their collapse, how far they are from it, and the scale of the caption."""
    for colour, gap in zip((style.INK, style.CONTACT, style.FLUID), data.printed_gap, strict=True):
        style.limit(panels["caption"], gap, label=style.power(float(gap["load"])), color=colour, ls="-", lw=1.4)
    inset = style.inset(panels["a"], (0.3, 0.13, 0.4, 0.4), r"$\alpha h/h_\mathrm{rms}$")  # in units of the roughness
    style.steps(inset, data.core_gap, lw=1.0)
    style.limit(inset, data.rough_contact, label="rough contact", color="cyan", lw=1.6)
    inset.set(ylim=(0.8, 4.2), xlim=(-1, 1))
    style.small_legend(inset, handles=inset.lines[-1:], loc="upper center", fontsize=7)
