"""The picture of one state: gap and pressures along the contact.

matplotlib comes with the extra ``plot`` and is imported on first use.
"""

from __future__ import annotations

import math
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

import numpy as np

from stribeck._types import Array
from stribeck.contacts.contact import input_texts
from stribeck.files.pictures import (
    CONTACT,
    FLUID,
    GREY,
    INK,
    MARK,
    add_legend,
    finish_figure,
    make_logarithmic,
    new_figure,
    picture,
)
from stribeck.files.writing import PathLike
from stribeck.quantities.formats import format_si
from stribeck.quantities.inputs import LINE
from stribeck.quantities.units import DIMENSIONS, InputError
from stribeck.solver.base_solution import BaseSolution, Profile
from stribeck.solver.solution import Solution

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


__all__ = [
    "axis_in_si",
    "draw_gap",
    "draw_pressures",
    "caption_of",
    "law_text",
    "mark_failure",
    "plot_fields",
    "plot_profile",
    "scales_of",
]


@picture()
def plot_profile(
    solution: Solution,
    path: PathLike | None = None,
    *,
    ax: Axes | None = None,
    force: bool = False,
    title: str = "",
    notes: bool = True,
) -> Figure:
    """Draw gap and pressures along the contact, in SI units where the solution has a contact.

    Parameters
    ----------
    solution : Solution
        The state.
    ax : matplotlib.axes.Axes, optional
        Axes to draw the pressures into, instead of a new figure.
    """
    caption = caption_of(solution, notes)
    figure, (*above, below) = new_figure((7.5, 6.0), *caption, rows=2, title=title or "Gap and pressure", ax=ax)
    x = _positions(solution)
    fields = solution.profile(x)
    if solution.contact is None:
        to_x, to_gap, to_pressure = (
            (1.0, "position $x/a$"),
            (1.0, r"gap $h/u_\mathrm{Hz}$"),
            (1.0, r"pressure $p/p_\mathrm{Hz}$"),
        )
    else:
        scales = solution.contact.hertz
        to_x = axis_in_si(scales.half_width, "length", "position $x$")
        to_gap = axis_in_si(scales.indentation, "length", "gap $h$", float(np.abs(fields.gap).max()))
        to_pressure = axis_in_si(scales.pressure, "pressure", "pressure")
    for axes in above:
        draw_gap(axes, solution, x * to_x[0], fields.gap, to_gap)
    draw_pressures(below, fields, x * to_x[0], to_pressure, np.sqrt(np.clip(1 - x**2, 0, None)))
    below.set_xlim(x[0] * to_x[0], x[-1] * to_x[0])
    _name(figure, above, below, to_x[1])
    mark_failure(solution, below, *above)
    return finish_figure(figure, path, force)


@picture("there are fewer than two positions")
def plot_fields(
    fields: Profile, path: PathLike | None = None, *, ax: Axes | None = None, force: bool = False, title: str = ""
) -> Figure:
    """Draw gap and pressures of a profile, in its units, as far as the pressures reach.

    Parameters
    ----------
    fields : Profile
        The profile.
    ax : matplotlib.axes.Axes, optional
        Axes to draw the pressures into, instead of a new figure.
    """
    if len(fields.x) < 2:
        raise InputError(f"the profile has {len(fields.x)} positions; a picture needs two at least.")
    figure, (*above, below) = new_figure((7.5, 6.0), [], rows=2, title=title or "Gap and pressure", ax=ax)
    size = np.abs(fields.contact_pressure) + np.abs(fields.fluid_pressure)
    reach = 1.6 * float(np.abs(fields.x[size > 0.02 * size.max()]).max(initial=0.0)) or math.inf
    near = np.abs(fields.x) <= reach
    drawn = Profile(fields.x[near], fields.gap[near], fields.contact_pressure[near], fields.fluid_pressure[near], fields.unit)
    to_x, to_gap, to_pressure = scales_of(drawn, drawn.x, "position $x$")
    for axes in above:
        draw_gap(axes, None, drawn.x * to_x[0], drawn.gap, to_gap)
    draw_pressures(below, drawn, drawn.x * to_x[0], to_pressure)
    _name(figure, above, below, to_x[1])
    return finish_figure(figure, path, force)


def _name(figure: Figure, above: list[Axes], below: Axes, position: str) -> None:
    """Label positions and curves."""
    # The legend lies within the axes of the pressures if these are alone.
    below.set_xlabel(f"{position}; fluid enters from the left")
    if not above:
        below.legend(frameon=False, fontsize=8.5)
        return
    above[0].set_xlim(below.get_xlim())
    add_legend(figure, (*above, below), columns=3)


def scales_of(fields: Any, x: Array, name: str) -> tuple[tuple[float, str], ...]:
    """Return factor and label of position, gap and pressure of a profile or a field, in units with readable numbers."""
    if fields.unit == "Hertz":
        return (1.0, f"{name[:-1]}/a$"), (1.0, r"gap $h/u_\mathrm{Hz}$"), (1.0, r"pressure $p/p_\mathrm{Hz}$")
    largest = [float(np.abs(values).max()) or 1.0 for values in (x, fields.gap, fields.pressure)]
    return (
        axis_in_si(1.0, "length", name, largest[0]),
        axis_in_si(1.0, "length", "gap $h$", largest[1]),
        axis_in_si(1.0, "pressure", "pressure", largest[2]),
    )


def draw_pressures(axes: Axes, fields: Profile, x: Array, to_pressure: tuple[float, str], hertz: Array | None = None) -> None:
    """Draw the pressures along the contact, and that of Hertz if given."""
    curves: list[tuple[Array, dict[str, Any]]] = [
        (fields.pressure, {"color": INK, "lw": 1.8, "label": "total pressure"}),
        (fields.contact_pressure, {"color": CONTACT, "lw": 1.6, "ls": (0, (6, 2)), "label": "from asperities"}),
        (fields.fluid_pressure, {"color": FLUID, "lw": 1.6, "ls": "-.", "label": "from the fluid"}),
    ]
    if hertz is not None:
        curves.insert(0, (hertz, {"color": GREY, "lw": 1.0, "ls": (0, (2, 2)), "label": "dry smooth contact (Hertz)"}))
    for values, style in curves:
        axes.plot(x, values * to_pressure[0], **style)
    axes.axhline(0.0, color=GREY, lw=0.6, zorder=1)
    axes.set_ylabel(to_pressure[1])


def mark_failure(solution: BaseSolution, *drawn: Axes) -> None:
    """Write across the picture of a failed state that the state is no result."""
    if solution.outcome.ok:
        return
    for axes in drawn:
        style: dict[str, Any] = {"ha": "center", "va": "center", "rotation": 20, "zorder": 10, "size": 22, "color": MARK}
        axes.text(0.5, 0.5, "not converged", transform=axes.transAxes, **style)


def draw_gap(axes: Axes, solution: BaseSolution | None, x: Array, gap: Array, to_gap: tuple[float, str]) -> None:
    """Draw the gap, and the roughness of a solution if it is visible beside it."""
    axes.plot(x, gap * to_gap[0], color=INK, lw=1.8, label="gap")
    drawn = gap
    contact = None if solution is None else solution.contact
    rms = 0.0 if solution is None else (1.0 if contact is None else contact.alpha) * float(solution.groups.relative_roughness)
    if rms > 0 and rms > 0.03 * gap.min():
        drawn = np.append(drawn, rms)
        name = r"$h_\mathrm{rms}/\alpha$" if contact is None else LINE.symbols["roughness"]
        axes.axhline(rms * to_gap[0], color=GREY, lw=1.0, ls=(0, (5, 3)), label=f"roughness {name}")
    if gap.min() > 0:
        make_logarithmic(axes, "y", drawn * to_gap[0])
    axes.set_ylabel(to_gap[1])
    axes.tick_params(labelbottom=False)


def caption_of(solution: BaseSolution, notes: bool) -> tuple[list[list[str]], list[str]]:
    """Return the caption of a state's picture: inputs, groups, law and error, and its notes if wanted."""
    groups = [f"{name} group {float(getattr(solution.groups, name)):.4g}" for name in ("speed", "load", "roughness")]
    second = [
        law_text(solution),
        f"rtol {solution.rtol:g}",
        f"estimated error {solution.error_estimate:.1e}",
        f"stribeck {version('stribeck')}",
    ]
    said = [] if solution.outcome.ok else [solution.outcome.value]
    return [[*input_texts(solution.contact), *groups], second], [*said, *(solution.notes if notes else ())]


def _positions(solution: Solution) -> Array:
    """Return positions to draw at [a], denser where the nodes are, as far as the pressure reaches."""
    pressure = np.abs(solution.contact_pressure) + np.abs(solution.fluid_pressure)
    reach = 1.25 * float(np.abs(solution.x[pressure > 0.02 * pressure.max()]).max(initial=0.0))
    reach = max(1.6, reach)
    nodes = solution.x[np.abs(solution.x) < reach]
    return np.unique(np.concatenate([np.linspace(-reach, reach, 801), nodes]))


def axis_in_si(scale: float, dimension: str, name: str, largest: float = 1.0) -> tuple[float, str]:
    """Return the factor from Hertz units to a unit with readable numbers, and the label with that unit."""
    unit = format_si(scale * largest, dimension).rpartition(" ")[2]
    power = next(power for power, known in DIMENSIONS[dimension].steps.items() if known == unit)
    return scale / 10.0**power, f"{name} ({unit})"


def law_text(solution: BaseSolution) -> str:
    """Return name and parameters of the contact law."""
    if solution.law in ("dry contact", "smooth"):
        return solution.law
    numbers = ", ".join(
        f"{name.replace('_', ' ')} {value if isinstance(value, str) else f'{value:.4g}'}"
        for name, value in solution.law_parameters.items()
    )
    return f"{solution.law} contact law" + (f" ({numbers})" if numbers else "")
