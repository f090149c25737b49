"""Figure 7: Stribeck curves over the Hersey number, and over the friction that their speed causes between smooth surfaces."""

import math

import numpy as np

from stribeck.asymptotics import hydrodynamic, transitions
from stribeck.contacts.groups import Groups
from stribeck.curves.result import StribeckCurve
from stribeck.figures import style
from stribeck.figures.article import stribeck_cases as shared
from stribeck.figures.job import FigureJob
from stribeck.figures.style import Dataset, Panels

STEPS = len(shared.CASES)
MAX_SOLID_FRICTION_SHARE = 1e-3  # Share of friction from asperities below which a state counts as hydrodynamic here.
CURVES_MISSING = (
    "The paper draws curves of Bongaerts 2007 here, whose data\n"
    "are not public to us: bars show the ranges of $\\Lambda$ that\nthe paper quotes, at no roughness in particular."
)


def compute(work: FigureJob) -> Dataset:
    """Solve the curves and find their minima."""
    curves, data = shared.solve_cases(work, (1e-8, 1e3), points=67)
    vars(data).update(shared.REPORTED)
    data.hersey_number = shared.over(curves, "hersey_number")
    data.uniform_friction = np.array([hydrodynamic.friction_uniform.function(curve.groups) for curve in curves])
    fluid_film = shared.over(curves, "friction.asperities") < MAX_SOLID_FRICTION_SHARE * data.friction
    data.distance = np.where(fluid_film, data.friction / data.hydrodynamic_friction - 1, np.nan)
    data.uniform_distance = np.where(fluid_film, data.friction / data.uniform_friction - 1, np.nan)
    data.minimum_hersey, data.minimum_friction, data.minimum_law, data.separation_at_minimum = np.array(
        [_minimum(curve) for curve in curves]
    ).T
    # Smoothest case of each load, where both are hydrodynamic.
    hersey, friction = np.log(data.hersey_number), np.log(data.friction)
    heavy, light = ((hersey[i][fluid_film[i]], friction[i][fluid_film[i]]) for i in (0, len(shared.ROUGHNESSES)))
    apart = np.interp(heavy[0], *light, left=np.nan, right=np.nan) - heavy[1]
    data.hersey_spread = np.exp(np.nanmax(np.abs(apart)))
    data.slope = np.where(fluid_film[0], np.gradient(friction[0], hersey[0]), np.nan)
    data.predicted_load, data.predicted_roughness = shared.LOADS, np.geomspace(1e-8, 1e-2, 61)
    groups = Groups(1.0, np.array(shared.LOADS)[:, None], data.predicted_roughness)
    data.predicted_separation = transitions.separation_at_minimum.function(groups)
    data.least_distance, data.largest_distance = np.nanmin(data.distance), np.nanmax(data.distance)
    data.ours = np.nanmax(np.abs(data.uniform_distance))
    data.least_slope, data.largest_slope = np.nanmin(data.slope), np.nanmax(data.slope)
    data.least_lambda, data.largest_lambda = np.nanmin(data.separation_at_minimum), np.nanmax(data.separation_at_minimum)
    return work.dataset(data)


def _minimum(curve: StribeckCurve) -> tuple[float, float, float, float]:
    """Return Hersey number, friction, friction of smooth surfaces and Lambda at the minimum of a curve."""
    if curve.minimum is None:
        return (math.nan,) * 4
    lowest = curve.minimum.solution
    smooth = float(hydrodynamic.friction.function(lowest.groups))
    return lowest.hersey_number, curve.minimum.friction, smooth, lowest.central_separation


def draw(panels: Panels, data: Dataset) -> None:
    """Draw the curves over the Hersey number and over the friction of smooth surfaces, and Lambda at their minima."""
    a, b, c = panels.values()
    style.slope(a, 3e-5, 5e-3, 0.4, "2/5")
    style.slope(a, 0.3, 2.2, 2 / 3, "2/3")
    b.plot([1e-3, 200], [1e-3, 200], color=style.INK, lw=1.1, ls=style.DASHED, label="$y = x$")
    for load, dashes in zip(data.predicted_load.values, (style.DASHED, style.DOTTED), strict=True):
        style.limit(c, data.predicted_separation.sel(predicted_load=load), label=f"formula, load {load:g}", ls=dashes, lw=1.4)
    for row, look in shared.drawn_cases(data):
        unnamed = look | {"label": None}
        a.plot(row.hersey_number, row.friction, markevery=2, **look)
        b.plot(row.hydrodynamic_friction, row.friction, markevery=2, **unnamed)
        for axes, lowest in ((a, row.minimum_hersey), (b, row.minimum_law)):
            axes.plot(lowest, row.minimum_friction, "v", color=style.MARK, ms=5, zorder=5)
        c.plot(row["roughness"], row.separation_at_minimum, **unnamed | {"ms": 7})
    b.lines[2].set_label("minimum friction")
    shared.draw_reports(c, data, data.predicted_roughness, CURVES_MISSING)
