r"""The picture of one state of a ball: film and pressure on the plane, and the cut along the middle line.

Interference colours are those of white light in three bands in an optical rig.  Each band is reflected at both sides of the
film, with opposite phase where the film vanishes (a black contact):

.. math:: I = \tfrac12 \left[1 - \cos\frac{4 \pi n h}{\lambda_0} \, e^{-(2 \pi n h \, \Delta\lambda/\lambda_0^2)^2/4}\right] .

matplotlib comes with the extra ``plot`` and is imported on first use.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from stribeck._types import Array
from stribeck.files.pictures import (
    GREY,
    INK,
    MARK,
    add_legend,
    finish_figure,
    new_figure,
    picture,
)
from stribeck.files.writing import PathLike
from stribeck.quantities.units import InputError, show
from stribeck.solver.plot import axis_in_si, caption_of, draw_gap, draw_pressures, mark_failure, scales_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from stribeck.solver.point.solution import Field, PointSolution

__all__ = ["interference", "plot_field", "plot_point_solution"]

Colours = Literal["film", "interference"]

BANDS = (610e-9, 540e-9, 465e-9)  # Wavelengths of red, green and blue light in air [m]
BANDWIDTH = 40e-9  # Width of each band [m]: fringes fade after about seven
REFRACTIVE_INDEX = 1.40  # Of the fluid: water has 1.33, glycerol 1.47, oils 1.45 to 1.5
HALF_SIDE = 1.6  # Half the side of the maps [a]
SIDE_POINTS = 241  # Points along a side of the maps

SIZE = (10.0, 8.6)


def interference(gap: Any, index: float = REFRACTIVE_INDEX) -> Array:
    """Return the colours that a film shows between a coated glass and a reflecting ball."""
    path = index * np.maximum(np.asarray(gap, dtype=float), 0.0)[..., None]
    waves = np.array(BANDS)
    fading = np.exp(-np.square(2 * math.pi * path * BANDWIDTH / waves**2) / 4)
    return np.asarray(0.5 * (1 - np.cos(4 * math.pi * path / waves) * fading))


@picture("the colours are unknown or need a contact")
def plot_point_solution(
    solution: PointSolution,
    path: PathLike | None = None,
    *,
    ax: Axes | None = None,
    colours: Colours = "film",
    force: bool = False,
    title: str = "",
    notes: bool = True,
) -> Figure:
    """Draw film and pressure of a ball, in SI units where the solution has a contact.

    Parameters
    ----------
    solution : PointSolution
        The state.
    ax : matplotlib.axes.Axes, optional
        Axes to draw the film into, instead of a new figure.
    colours : {"film", "interference"}
        Colours by thickness, or those of the light reflected in an optical rig, which need a contact.
    """
    if not isinstance(colours, str) or colours not in ("film", "interference"):
        raise InputError(f"colours = {show(colours)}; it must be 'film' or 'interference'.")
    if colours == "interference" and solution.contact is None:
        raise InputError("colours = 'interference' needs a film thickness in metres; solve a PointContact instead of Groups.")
    figure, (film, *others) = new_figure(
        SIZE, *caption_of(solution, notes), rows=2, columns=2, title=title or "Film and pressure of a ball", ax=ax
    )
    if others:
        film.get_gridspec().update(right=0.91, wspace=0.42, hspace=0.18)  # type: ignore[union-attr]
    along = np.linspace(-HALF_SIDE, HALF_SIDE, SIDE_POINTS)
    field = solution.field(along, along[:, None])
    to_x, to_gap, to_pressure = _scales(solution, 3 * abs(solution.central_gap))
    edge = HALF_SIDE * to_x[0]
    extent = (-edge, edge, -edge, edge)
    if colours == "interference":
        assert solution.contact is not None
        shown = interference(field.gap * solution.contact.hertz.indentation)
        film.imshow(shown, origin="lower", extent=extent, interpolation="bilinear")
        film.set_title(f"interference colours, refractive index {REFRACTIVE_INDEX:g}", size=9.5, color=INK)
    else:
        _film_map(figure, film, field.gap * to_gap[0], extent, to_gap[1])
    if others:
        _pressure_map(figure, others[0], field.pressure * to_pressure[0], extent, to_pressure[1])
    else:
        film.set_xlabel(to_x[1])
    for axes in (film, *others[:1]):
        turn = np.linspace(0, 2 * math.pi, 181)
        axes.plot(to_x[0] * np.cos(turn), to_x[0] * np.sin(turn), color=GREY, lw=0.9, ls=(0, (2, 2)))
        axes.set_ylabel(to_x[1].replace("x", "y", 1) if axes is film else "")
        axes.set_aspect("equal")
    _mark_minimum(film, solution, to_x[0])
    if others:
        _cut(others[1], others[2], solution, to_x, to_gap, to_pressure)
    mark_failure(solution, film, *others)
    return finish_figure(figure, path, force)


@picture("the points are no grid")
def plot_field(
    field: Field, path: PathLike | None = None, *, ax: Axes | None = None, force: bool = False, title: str = ""
) -> Figure:
    """Draw film and pressure on the plane, in the units of the field.

    Parameters
    ----------
    field : Field
        The field on evenly spaced positions, as of ``solution.field(x, x[:, None])``.
    ax : matplotlib.axes.Axes, optional
        Axes to draw the film into, instead of a new figure.
    """
    if field.grid is None or not all(len(each) > 1 and np.ptp(np.diff(each)) < 1e-6 * np.ptp(each) for each in field.grid):
        raise InputError("this field is not on an evenly spaced grid; a picture needs one, as of field(x, x[:, None]).")
    figure, (film, *others) = new_figure((10.5, 4.6), [], columns=2, title=title or "Film and pressure", ax=ax)
    to_x, to_gap, to_pressure = scales_of(field, np.stack([np.abs(each).max() for each in field.grid]), "$x$")
    half = [0.5 * to_x[0] * (each[1] - each[0]) for each in field.grid]
    x, y = (each * to_x[0] for each in field.grid)
    extent = (x[0] - half[0], x[-1] + half[0], y[0] - half[1], y[-1] + half[1])
    _film_map(figure, film, field.gap * to_gap[0], extent, to_gap[1])
    if others:
        _pressure_map(figure, others[0], field.pressure * to_pressure[0], extent, to_pressure[1])
    for axes in (film, *others):
        axes.set_xlabel(f"{to_x[1]}; fluid enters from the left")
        axes.set_ylabel(to_x[1].replace("x", "y", 1) if axes is film else "")
        axes.set_aspect("equal")
    return finish_figure(figure, path, force)


def _scales(solution: PointSolution, largest: float) -> tuple[tuple[float, str], ...]:
    """Return factor and label of position, gap and pressure."""
    if solution.contact is None:
        return (1.0, "$x/a$"), (1.0, r"gap $h/u_\mathrm{Hz}$"), (1.0, r"pressure $p/p_\mathrm{Hz}$")
    scales = solution.contact.hertz
    return (
        axis_in_si(scales.half_width, "length", "$x$"),
        axis_in_si(scales.indentation, "length", "gap $h$", largest),
        axis_in_si(scales.pressure, "pressure", "pressure"),
    )


def _film_map(figure: Figure, axes: Axes, gap: Array, extent: tuple[float, float, float, float], label: str) -> None:
    """Draw the gap on a logarithmic scale with contours, so that the horseshoe shows."""
    from matplotlib.colors import LogNorm

    lowest = float(gap[gap > 0].min(initial=math.inf))
    scale: dict[str, Any] = {}
    if math.isfinite(lowest) and lowest == gap.min():
        middle = float(gap[gap.shape[0] // 2, gap.shape[1] // 2])
        scale["norm"] = LogNorm(lowest, max(20 * middle, 2 * lowest), clip=True)
        levels = np.geomspace(lowest, max(1.6 * middle, 1.5 * lowest), 12)
        axes.contour(gap, levels=levels, extent=extent, colors="white", linewidths=0.5, alpha=0.7)
    image = axes.imshow(gap, origin="lower", extent=extent, cmap="viridis", interpolation="bilinear", **scale)
    figure.colorbar(image, ax=axes, fraction=0.046, pad=0.02).set_label(label, size=9, color=INK)


def _pressure_map(figure: Figure, axes: Axes, pressure: Array, extent: tuple[float, float, float, float], label: str) -> None:
    """Draw the total pressure, suction in another colour."""
    most = float(np.abs(pressure).max()) or 1.0
    image = axes.imshow(
        pressure, origin="lower", extent=extent, cmap="RdBu_r", vmin=-most, vmax=most, interpolation="bilinear"
    )
    figure.colorbar(image, ax=axes, fraction=0.046, pad=0.02).set_label(f"total {label}", size=9, color=INK)


def _mark_minimum(axes: Axes, solution: PointSolution, unit: float) -> None:
    """Mark the minimum of the film on both sides of the middle line."""
    r, angle = solution.minimum_radius, solution.minimum_angle
    if r > 0.02:
        x, y = r * math.cos(angle) * unit, r * math.sin(angle) * unit
        axes.plot([x, x], [y, -y], ls="", marker="o", ms=4.5, mfc="none", mec=MARK, mew=1.3)


def _cut(
    gap: Axes,
    pressure: Axes,
    solution: PointSolution,
    to_x: tuple[float, str],
    to_gap: tuple[float, str],
    to_pressure: tuple[float, str],
) -> None:
    """Draw gap and pressures along the middle line."""
    x = np.linspace(-HALF_SIDE, HALF_SIDE, 801)
    cut = solution.profile(x)
    draw_gap(gap, solution, x * to_x[0], cut.gap, to_gap)
    gap.tick_params(labelbottom=True)
    draw_pressures(pressure, cut, x * to_x[0], to_pressure, np.sqrt(np.clip(1 - x**2, 0, None)))
    for axes in (gap, pressure):
        axes.set_xlabel(f"{to_x[1]} on the middle line; fluid enters from the left")
        axes.set_xlim(x[0] * to_x[0], x[-1] * to_x[0])
    add_legend(gap.figure, (gap, pressure), columns=3)  # type: ignore[arg-type]
