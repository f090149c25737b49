"""Figure 5: film and friction of smooth contacts over all speeds, with the laws of both limits and what lies between."""

import numpy as np

from stribeck.asymptotics import hydrodynamic
from stribeck.contacts.groups import Groups
from stribeck.figures import style
from stribeck.figures.job import FigureJob, Numbers, furthest
from stribeck.figures.style import Dataset, Panels

SPEED_RANGE = 1e-8, 1e4  # Speed groups of the curves.
LOAD = 0.1  # Load group, on which neither films nor friction over beta F**(1/2) depend.


def compute(work: FigureJob) -> Dataset:
    """Solve the curve and compare it with the laws."""
    curve = work.curve(load=LOAD, roughness=0.0, speed=(1e-8, 1e4), points=121)
    data = Numbers(speed=curve.values, central_gap=curve.observable("central_gap"), load_group=LOAD)
    data.friction = curve.friction.fluid / LOAD**0.5
    groups = Groups(curve.values, LOAD, 0.0)
    data.film_large = hydrodynamic.central_gap_large.function(groups)
    data.film_large_printed = hydrodynamic.central_gap_large.function(groups, printed=True)
    data.film_small = hydrodynamic.central_gap_small.function(groups)
    data.film_uniform = hydrodynamic.central_gap.function(groups)
    data.friction_large = hydrodynamic.friction_large.function(groups) / LOAD**0.5
    data.friction_small = hydrodynamic.friction_small.function(groups) / LOAD**0.5
    data.friction_squares = hydrodynamic.friction.function(groups) / LOAD**0.5
    data.friction_uniform = hydrodynamic.friction_uniform.function(groups) / LOAD**0.5
    for name, law in dict(vars(data)).items():
        if "_" in name:
            solved = data.central_gap if name.startswith("film") else data.friction
            setattr(data, f"{name}_error", law / solved - 1)
    squares = data.friction_squares_error
    data.low, data.place, data.high = -squares.min(), curve.values[squares.argmin()], squares.max()
    data.between = -np.maximum(data.film_large_error, data.film_small_error).min()
    data.printed = -data.film_large_printed_error[0]
    data.early = -np.interp(np.log(1e-4), np.log(curve.values), data.friction_large_error)
    data.ours = max(furthest(data.film_uniform_error), furthest(data.friction_uniform_error))
    return work.dataset(data)


def draw(panels: Panels, data: Dataset) -> None:
    """Draw what was solved; the laws and their errors are in the file of the figure."""
    every = slice(None, None, 5)
    for name, solved in (("a", data.central_gap), ("b", data.friction)):
        axes = panels[name]
        axes.loglog(data.speed[every], solved[every], "o", color=style.INK, ms=4, mfc="white", label="solved", zorder=4)
        axes.tick_params(labelbottom=False)
    for name in ("film", "friction"):
        panels[name].axhline(0.0, color=style.GREY, lw=0.8)
    for axes in panels.values():
        axes.set_xlim(float(data.speed[0]), float(data.speed[-1]))
