"""What figures 7, 9 and 10 share: the Stribeck curves of several loads and roughnesses, and the reported values of Lambda."""

from collections.abc import Iterator
from operator import attrgetter
from typing import Any

import numpy as np

from stribeck._types import Array
from stribeck.curves.result import StribeckCurve
from stribeck.figures import style
from stribeck.figures.job import FigureJob, Numbers
from stribeck.figures.style import Axes, DataArray, Dataset

LOADS = (0.1, 0.01)  # Load groups of the curves.
ROUGHNESSES = (1e-5, 1e-4, 1e-3, 1e-2)  # Roughness groups of the curves.
# Load and roughness group of each curve.  [BP] name one pair only, load 0.1 with roughness 1e-4 in blue; relative roughness
# reaches from 1e-4 to the 1 of which they say that the minimum lies near speed 1.
CASES = tuple((load, roughness) for load in LOADS for roughness in ROUGHNESSES)

# Ranges of Lambda at the transition in experiments, as the text of [BP] quotes them; the data themselves are not public.
# And what textbooks take for all contacts, after Spikes 1997.
REPORTED: dict[str, Any] = {
    "reports": "Bongaerts 2007; Petrova 2019; Sadowski 2019; Dong 2023",
    "reported_low": (0.7, 0.7, 0.9, 16.0),
    "reported_high": (11.0, 1.2, 2.3, 2736.0),
    "textbook": 3.0,
}
REPORT_COLOURS = ("#cc79a7", "#e69f00", "#56b4e9", "#8c6d46")
REPORTS_FROM = 0.66  # Part of the width of a panel of Lambda from which on the bars of reports stand.


def solve_cases(work: FigureJob, speed: tuple[float, float], points: int) -> tuple[list[StribeckCurve], Numbers]:
    """Solve the curve of each of :data:`CASES`; return them, and what the data say of each."""
    curves = [work.curve(load=load, roughness=rough, speed=speed, points=points) for load, rough in CASES]
    loads, roughnesses = zip(*CASES, strict=True)
    data = Numbers(load=loads, roughness=roughnesses, speed=curves[0].values)
    data.friction, data.hydrodynamic_friction = over(curves, "friction"), over(curves, "hydrodynamic_friction")
    return curves, data


def over(curves: list[StribeckCurve], name: str) -> Array:
    """Return an array of each curve, such as ``"friction"``, as rows."""
    return np.array([attrgetter(name)(curve) for curve in curves])


def drawn_cases(data: Dataset) -> Iterator[tuple[Dataset, dict[str, Any]]]:
    """Yield the data and the style of each case: colours for roughness; circles for the heavy, squares for the light load."""
    roughnesses, heaviest = np.unique(data["roughness"]), data["load"].max()
    colours = dict(zip(roughnesses, style.sequence(len(roughnesses)), strict=True))
    for i in range(data.sizes["case"]):
        row = data.isel(case=i)
        load, roughness = float(row["load"]), float(row["roughness"])
        heavy, colour = load == heaviest, colours[roughness]
        marks = {"marker": "o" if heavy else "s", "ms": 3.6, "mfc": colour if heavy else "white", "lw": 1.1}
        yield row, marks | {"color": colour, "label": f"{load:g},  {style.power(roughness)}"}


def draw_reports(axes: Axes, data: Dataset, x: DataArray, missing: str) -> None:
    """Draw the reported ranges as bars at the right of a panel of Lambda over x, and say what the paper draws there."""
    axes.fill_between([REPORTS_FROM, 1.0], 0.0, 1.0, transform=axes.transAxes, color="#f4f4f2", lw=0, zorder=0)
    across, names = axes.get_yaxis_transform(), data.attrs["reports"].split("; ")
    places = REPORTS_FROM + (1 - REPORTS_FROM) * (np.arange(len(names)) + 0.5) / len(names)
    bars = zip(places, names, REPORT_COLOURS, data.reported_low.values, data.reported_high.values, strict=True)
    for place, name, colour, low, high in bars:
        axes.plot([place, place], [low, high], color=colour, lw=6, solid_capstyle="butt", transform=across)
        axes.text(place, 1.25 * high, name, transform=across, rotation=90, size=7.5, color=style.INK, ha="center", va="bottom")
    axes.axhline(float(data.textbook), color=style.GREY, lw=1.1, ls=style.DASHED, label="textbook, Spikes 1997")
    first, last = float(x[0]), float(x[-1])
    axes.set(xscale="log", xlim=(first, first * (last / first) ** (1 / REPORTS_FROM)))
    axes.set_xticks([1e-8, 1e-6, 1e-4, 1e-2])
    axes.minorticks_off()
    axes.text(0.03, 0.97, missing, transform=axes.transAxes, size=7.5, color=style.GREY, va="top")
