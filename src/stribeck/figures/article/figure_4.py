"""Figure 4: gaps of smooth contacts, slow and fast, as they are and on the scales that make them one curve."""

import math

import numpy as np

from stribeck.asymptotics import film_layers
from stribeck.asymptotics.constants import FILM_CONSTANT
from stribeck.figures import style
from stribeck.figures.job import FigureJob, Numbers, furthest
from stribeck.figures.style import Axes, DataArray, Dataset, Panels
from stribeck.solids import hertz

SLOW_SPEEDS = (1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2)  # Speed groups of panel (a).
FAST_SPEEDS = (1.0, 10.0, 1e2, 1e3, 1e4, 1e5)  # Speed groups of panel (b).
STEPS = len(SLOW_SPEEDS) + len(FAST_SPEEDS)
LOAD = 0.1  # Load group, on which smooth contacts do not depend.


def compute(work: FigureJob) -> Dataset:
    """Solve slow and fast contacts and scale their gaps."""
    data = Numbers(slow_speed=SLOW_SPEEDS, fast_speed=FAST_SPEEDS, film_constant=FILM_CONSTANT)
    slow, fast = ([work.solve(speed, LOAD, 0.0) for speed in speeds] for speeds in (SLOW_SPEEDS, FAST_SPEEDS))
    data.x_slow, data.x_fast = np.linspace(-2, 2, 801), np.linspace(-8, 8, 401)
    data.xi, data.ratio = np.linspace(-6, 4, 401), np.linspace(-4, 4, 321)
    data.slow_gap, data.hertz_gap = [state.profile(data.x_slow).gap for state in slow], hertz.gap(data.x_slow)
    data.fast_gap = [state.profile(data.x_fast).gap for state in fast]
    layer = film_layers.outlet()
    outlets = [state.profile(1 + data.xi * speed**0.4).gap for state, speed in zip(slow, SLOW_SPEEDS, strict=True)]
    data.outlet_gap = np.array(outlets) / (FILM_CONSTANT * np.array(SLOW_SPEEDS)[:, None] ** 0.6)
    data.outlet_limit = layer.gap(data.xi) / layer.constant
    data.outlet_distance = furthest((data.outlet_gap / data.outlet_limit - 1)[:, np.abs(data.xi) <= 3])
    films = np.array(FAST_SPEEDS) ** (2 / 3) / 24 ** (1 / 3)
    data.rigid_gap = [state.profile(data.ratio * film**0.5).gap / film for state, film in zip(fast, films, strict=True)]
    data.parabola = 1 + 0.5 * data.ratio**2
    data.rigid_distance = furthest(data.rigid_gap / data.parabola - 1)
    data.slow_order = np.polyfit(np.log(SLOW_SPEEDS[:3]), np.log(data.outlet_distance[:3]), 1)[0]
    data.fast_order = np.polyfit(np.log(FAST_SPEEDS[3:]), np.log(data.rigid_distance[3:]), 1)[0]
    return work.dataset(data)


def draw(panels: Panels, data: Dataset) -> None:
    """Draw the gaps, their collapse, and how far they are from it."""
    _draw_distance(panels["outlets"], data.outlet_distance, 0.35 * float(data.outlet_distance[-3:].min()), 0.4, "2/5")
    _draw_distance(panels["films"], data.rigid_distance, 1.6 * float(data.rigid_distance[-3]), -1 / 3, "−1/3")
    inset = style.inset(panels["a"], (0.3, 0.12, 0.42, 0.4), "outlet")
    style.steps(inset, data.slow_gap[:, (data.x_slow.values > 0.6) & (data.x_slow.values < 1.2)], lw=1.0)
    inset.set(yscale="log", xlim=(0.6, 1.2))


def _draw_distance(axes: Axes, distances: DataArray, place: float, exponent: float, text: str) -> None:
    speeds = distances[distances.dims[0]].values
    axes.loglog(speeds, distances, color=style.GREY, lw=0.8)
    axes.scatter(speeds, distances, c=style.sequence(len(speeds)), s=36, lw=1.0, zorder=2)
    low, high = np.log10(distances.min()), np.log10(distances.max())
    axes.set_ylim(10.0 ** math.floor(low), 10.0 ** math.ceil(high))
    style.slope(axes, speeds[-3], place, exponent, text)
