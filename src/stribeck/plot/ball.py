r"""The picture of one state of a ball: film and pressure on the plane, and the cut along the middle line.

Interference colours are those of white light in three bands in an optical rig.  Each band is reflected at both sides of the
film, with opposite phase where the film vanishes (a black contact):

.. math:: I = \tfrac12 \left[1 - \cos\frac{4 \pi n h}{\lambda_0} \, e^{-(2 \pi n h \, \Delta\lambda/\lambda_0^2)^2/4}\right] .
"""

from __future__ import annotations

import math
from typing import Any, Literal

import numpy as np

from stribeck._types import Array
from stribeck.plot import state, style
from stribeck.plot.state import Scale
from stribeck.plot.style import GREY, INK, MARK, Axes, Figure, add_legend, new_figure
from stribeck.quantities.units import InputError, show
from stribeck.solver.fields import Field
from stribeck.solver.point.solution import PointSolution

Colours = Literal["film", "interference"]

BANDS = (610e-9, 540e-9, 465e-9)  # Wavelengths of red, green and blue light in air [m]
BANDWIDTH = 40e-9  # Width of each band [m]: fringes fade after about seven
REFRACTIVE_INDEX = 1.40  # Of the fluid: water has 1.33, glycerol 1.47, oils 1.45 to 1.5
HALF_SIDE = 1.6  # Half the side of the maps [a]
SIDE_POINTS = 241  # Points along a side of the maps


def interference(gap: Any, index: float = REFRACTIVE_INDEX) -> Array:
    """Return the colours that a film shows between a coated glass and a reflecting ball."""
    path = index * np.maximum(np.asarray(gap, dtype=float), 0.0)[..., None]
    waves = np.array(BANDS)
    fading = np.exp(-np.square(2 * math.pi * path * BANDWIDTH / waves**2) / 4)
    return np.asarray(0.5 * (1 - np.cos(4 * math.pi * path / waves) * fading))


@style.picture("the colours are unknown or need a contact")
def plot_point_solution(
    solution: PointSolution, *, ax: Axes | None = None, colours: Colours = "film", title: str = "", notes: bool = True
) -> Figure:
    """Draw film and pressure of a ball, in SI units where the solution has a contact.

    Parameters
    ----------
    colours : {"film", "interference"}
        Colours by thickness, or those of the light reflected in an optical rig, which need a contact.
    """
    if not isinstance(colours, str) or colours not in ("film", "interference"):
        raise InputError(f"colours = {show(colours)}; it must be 'film' or 'interference'.")
    if colours == "interference" and solution.contact is None:
        raise InputError("colours = 'interference' needs a film thickness in metres; solve a PointContact instead of Groups.")
    caption, headline = state.caption_of(solution, notes), title or "Film and pressure of a ball"
    figure, drawn = new_figure((10.0, 8.6), *caption, rows=2, columns=2, title=headline, ax=ax)
    if drawn[1:]:
        drawn[0].get_gridspec().update(right=0.91, wspace=0.42, hspace=0.18)  # type: ignore[union-attr]
    along = np.linspace(-HALF_SIDE, HALF_SIDE, SIDE_POINTS)
    field = solution.field(along, along[:, None])
    scales = state.scales_of_state(solution, 3 * abs(solution.central_gap), "$x$")
    light = None
    if colours == "interference" and solution.contact is not None:
        light = interference(field.gap * solution.contact.hertz.indentation)
    _draw_maps(figure, drawn[:2], field, (along, along), scales, light)
    unit = scales[0][0]
    turn = np.linspace(0, 2 * math.pi, 181)
    for axes in drawn[:2]:
        axes.plot(unit * np.cos(turn), unit * np.sin(turn), color=GREY, lw=0.9, ls=(0, (2, 2)))
        axes.set_xlabel("" if drawn[1:] else scales[0][1])
    r, angle = solution.minimum_radius, solution.minimum_angle
    if r > 0.02:
        x, y = r * math.cos(angle) * unit, r * math.sin(angle) * unit
        drawn[0].plot([x, x], [y, -y], ls="", marker="o", ms=4.5, mfc="none", mec=MARK, mew=1.3)
    if drawn[1:]:
        _draw_cut(figure, drawn[2:], solution, scales)
    state.mark_failure(solution, drawn)
    return figure


@style.picture("the points are no grid")
def plot_field(field: Field, *, ax: Axes | None = None, title: str = "") -> Figure:
    """Draw film and pressure on the plane, in the units of the field."""
    if field.grid is None or not all(len(each) > 1 and np.ptp(np.diff(each)) < 1e-6 * np.ptp(each) for each in field.grid):
        raise InputError("this field is not on an evenly spaced grid; a picture needs one, as of field(x, x[:, None]).")
    figure, drawn = new_figure((10.5, 4.6), [], columns=2, title=title or "Film and pressure", ax=ax)
    scales = state.scales_of_fields(field, np.stack([np.abs(each).max() for each in field.grid]), "$x$")
    _draw_maps(figure, drawn, field, field.grid, scales)
    for axes in drawn:
        axes.set_xlabel(f"{scales[0][1]}; fluid enters from the left")
    return figure


def _draw_maps(
    figure: Figure, drawn: list[Axes], field: Field, grid: Any, scales: tuple[Scale, Scale, Scale], light: Array | None = None
) -> None:
    """Draw the film, by its thickness or by colours of light, and the pressure if there are axes for it."""
    to_x, to_gap, to_pressure = scales
    # Pixels lie around the points.
    x, y = ((to_x[0] * (e[0] - 0.5 * (e[1] - e[0])), to_x[0] * (e[-1] + 0.5 * (e[1] - e[0]))) for e in grid)
    extent = (*x, *y)
    if light is None:
        _film_map(figure, drawn[0], field.gap * to_gap[0], extent, to_gap[1])
    else:
        drawn[0].imshow(light, origin="lower", extent=extent, interpolation="bilinear")
        drawn[0].set_title(f"interference colours, refractive index {REFRACTIVE_INDEX:g}", size=9.5, color=INK)
    for axes in drawn[1:]:
        pressure = field.pressure * to_pressure[0]
        most = float(np.abs(pressure).max()) or 1.0
        # Suction has another colour.
        image = axes.imshow(
            pressure, origin="lower", extent=extent, cmap="RdBu_r", vmin=-most, vmax=most, interpolation="bilinear"
        )
        figure.colorbar(image, ax=axes, fraction=0.046, pad=0.02).set_label(f"total {to_pressure[1]}", size=9, color=INK)
    for axes in drawn:
        axes.set_aspect("equal")
    drawn[0].set_ylabel(to_x[1].replace("x", "y", 1))


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


def _draw_cut(figure: Figure, drawn: list[Axes], solution: PointSolution, scales: tuple[Scale, Scale, Scale]) -> None:
    """Draw gap and pressures along the middle line."""
    to_x, to_gap, to_pressure = scales
    x = np.linspace(-HALF_SIDE, HALF_SIDE, 801)
    cut = solution.profile(x)
    state.draw_gap(drawn[0], solution, x * to_x[0], cut.gap, to_gap)
    state.draw_pressures(drawn[1], cut, x * to_x[0], to_pressure, np.sqrt(np.clip(1 - x**2, 0, None)))
    for axes in drawn:
        axes.set_xlabel(f"{to_x[1]} on the middle line; fluid enters from the left")
        axes.set_xlim(x[0] * to_x[0], x[-1] * to_x[0])
    add_legend(figure, drawn, columns=3)
