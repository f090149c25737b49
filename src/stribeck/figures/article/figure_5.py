"""Figure 5: film and friction of smooth contacts over all speeds, with the laws of both limits and what lies between."""

from __future__ import annotations

from typing import Any

import numpy as np

from stribeck.asymptotics import hydrodynamic
from stribeck.contacts.groups import Groups
from stribeck.figures import style
from stribeck.figures.job import FigureJob
from stribeck.figures.style import Axes, Dataset, Figure

TITLE = "Film and friction in the smooth limit"
CLAIM = (
    "the film is well described by the laws of both limits, and the root of the sum of squares of both laws of friction "
    "provides an excellent description, including in the transition region."
)
SIZE = 11.0, 6.4

SPEED_RANGE = 1e-8, 1e4  # Speed groups of the curves.
LOAD = 0.1  # Load group, on which neither films nor friction over beta F**(1/2) depend.

# Label, colour and dashes of each law.
FILM_LAWS = {
    "film_large": ("slow: $c \\lambda^{3/5}$, $c$ = 0.44583", style.FLUID, style.DASHED),
    "film_small": (r"fast: $\lambda^{2/3}/24^{1/3}$", style.GREEN, style.DASHED),
    "film_uniform": ("ours, for all speeds", style.MARK, "-"),
}
FRICTION_LAWS = {
    "friction_large": (r"slow: $\propto \lambda^{2/5}$", style.FLUID, style.DASHED),
    "friction_small": (r"fast: $\propto \lambda^{2/3}$", style.GREEN, style.DASHED),
    "friction_squares": ("the paper's root of squares", style.INK, style.DOTTED),
    "friction_uniform": ("ours, for all speeds", style.MARK, "-"),
}


def compute(work: FigureJob) -> Dataset:
    """Solve the curve and compare it with the laws."""
    curve = work.curve(load=LOAD, roughness=0.0, speed=SPEED_RANGE, points=121)
    film = curve.observable("central_gap")
    friction = curve.friction.fluid / LOAD**0.5
    groups = Groups(curve.values, LOAD, 0.0)
    laws = {
        "film_large": hydrodynamic.central_gap_large.function(groups),
        "film_large_printed": hydrodynamic.central_gap_large.function(groups, printed=True),
        "film_small": hydrodynamic.central_gap_small.function(groups),
        "film_uniform": hydrodynamic.central_gap.function(groups),
        "friction_large": hydrodynamic.friction_large.function(groups) / LOAD**0.5,
        "friction_small": hydrodynamic.friction_small.function(groups) / LOAD**0.5,
        "friction_squares": hydrodynamic.friction.function(groups) / LOAD**0.5,
        "friction_uniform": hydrodynamic.friction_uniform.function(groups) / LOAD**0.5,
    }
    errors = {name: law / (film if name.startswith("film") else friction) - 1 for name, law in laws.items()}
    squares, place = errors["friction_squares"], int(np.argmin(errors["friction_squares"]))
    early = float(np.interp(np.log(1e-4), np.log(curve.values), errors["friction_large"]))
    printed = float(errors["film_large_printed"][0])
    between = float(np.maximum(errors["film_large"], errors["film_small"]).min())
    ours = max(float(np.abs(errors[name]).max()) for name in ("film_uniform", "friction_uniform"))
    finding = (
        f"the better of both laws of the film is up to {-100 * between:.0f} % low between them, and the film by the printed "
        f"constant 0.44 {-100 * printed:.1f} % low at {SPEED_RANGE[0]:g}. The slow law of friction is {-100 * early:.0f} % "
        f"low already at 1e-4, the root of squares up to {-100 * squares[place]:.1f} % low (at {curve.values[place]:.1g}) and "
        f"{100 * squares.max():.1f} % high. Our uniform formulas are within {100 * ours:.2g} %."
    )
    work.along(speed=(curve.values, "speed group lambda"))
    friction_words = "friction coefficient over beta F^(1/2), all from the fluid"
    work.give("speed", central_gap=(film, "central gap over u_Hz"), friction=(friction, friction_words))
    for name, law in laws.items():
        words = f"the law {name.replace('_', ' ')}, in the scale of what it predicts"
        error = errors[name], f"relative error of {name} against the solver"
        work.give("speed", **{name: (law, words), f"{name}_error": error})
    return work.dataset(finding, load_group=LOAD)


def draw(figure: Figure, data: Dataset) -> None:
    """Draw film and friction over the speed, and the errors of their laws."""
    a, b, of_film, of_friction = style.panels(figure, 2, 2, height_ratios=[1.7, 1])
    _draw_laws(a, of_film, data, "central_gap", FILM_LAWS)
    _draw_laws(b, of_friction, data, "friction", FRICTION_LAWS)
    style.panel(a, "a", "central film", {"loc": "upper left"}, ylabel=r"$h(0)/u_\mathrm{Hz}$")
    style.panel(b, "b", "friction", {"loc": "upper left"}, ylabel=r"$\mu_f / (\beta \bar F_N^{1/2})$")
    printed = 100 * data.film_large_printed_error
    of_film.plot(data.speed, printed, color=style.CONTACT, lw=1.2, ls=style.DOTTED, label="printed 0.44")
    style.panel(of_film, "+", "error of the laws of the film", {"loc": "lower left"})
    style.panel(of_friction, "+", "error of the laws of friction")


def _draw_laws(axes: Axes, below: Axes, data: Dataset, solved: str, laws: dict[str, tuple[str, str, Any]]) -> None:
    every, ends = slice(None, None, 5), (float(data.speed[0]), float(data.speed[-1]))
    axes.loglog(data.speed[every], data[solved][every], "o", color=style.INK, ms=4, mfc="white", label="solved", zorder=4)
    style.lines(axes, data, laws)
    axes.tick_params(labelbottom=False)
    axes.set_xlim(*ends)
    below.axhline(0.0, color=style.GREY, lw=0.8)
    for name, (_, colour, dashes) in laws.items():
        below.plot(data.speed, 100 * data[f"{name}_error"], color=colour, ls=dashes, lw=1.5)
    below.set(xscale="log", xlabel=r"speed $\lambda$", ylabel="law over solver − 1 (%)", ylim=(-28, 6), xlim=ends)
