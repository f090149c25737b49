r"""The pictures of one state: gap and pressures along a line, and film and pressure of a ball on the plane.

Interference colours are those of white light in three bands in an optical rig.  Each band is reflected at both sides of the
film, with opposite phase where the film vanishes (a black contact):

.. math:: I = \tfrac12 \left[1 - \cos\frac{4 \pi n h}{\lambda_0} \, e^{-(2 \pi n h \, \Delta\lambda/\lambda_0^2)^2/4}\right] .
"""

import math
from typing import Any, Literal

import numpy as np

from stribeck._types import Array
from stribeck.contacts.contact import in_words, input_texts
from stribeck.contacts.geometries import LINE
from stribeck.plot import style
from stribeck.plot.style import Axes, Figure
from stribeck.quantities.units import InputError, show
from stribeck.solver.base_solution import BaseSolution
from stribeck.solver.fields import Field, Profile
from stribeck.solver.point.solution import PointSolution
from stribeck.solver.solution import Solution

Scale = tuple[float, str]  # Factor to the drawn unit, and the label with that unit

SIZE = (7.5, 6.0)

Colours = Literal["film", "interference"]

BANDS = (610e-9, 540e-9, 465e-9)  # Wavelengths of red, green and blue light in air [m]
BANDWIDTH = 40e-9  # Width of each band [m]: fringes fade after about seven
REFRACTIVE_INDEX = 1.40  # Of the fluid: water has 1.33, glycerol 1.47, oils 1.45 to 1.5
HALF_SIDE = 1.6  # Half the side of the maps [a]
SIDE_POINTS = 241  # Points along a side of the maps


@style.picture()
def plot_profile(solution: Solution, *, ax: Axes | None = None, title: str = "", notes: bool = True) -> Figure:
    """Draw gap and pressures along the contact, in SI units where the solution has a contact."""
    figure, drawn = style.new_figure(SIZE, *caption_of(solution, notes), rows=2, title=title or "Gap and pressure", ax=ax)
    x = _positions(solution)
    fields = solution.profile(x)
    scales = scales_of_state(solution, float(np.abs(fields.gap).max()), "position $x$")
    _draw_along(figure, drawn, fields, scales, solution, np.sqrt(np.clip(1 - x**2, 0, None)))
    drawn[-1].set_xlim(x[0] * scales[0][0], x[-1] * scales[0][0])
    mark_failure(solution, drawn)
    return figure


@style.picture("there are fewer than two positions")
def plot_fields(fields: Profile, *, ax: Axes | None = None, title: str = "") -> Figure:
    """Draw gap and pressures of a profile, in its units, as far as the pressures reach."""
    if len(fields.x) < 2:
        raise InputError(f"the profile has {len(fields.x)} positions; a picture needs two at least.")
    figure, drawn = style.new_figure(SIZE, [], rows=2, title=title or "Gap and pressure", ax=ax)
    size = np.abs(fields.contact_pressure) + np.abs(fields.fluid_pressure)
    reach = 1.6 * float(np.abs(fields.x[size > 0.02 * size.max()]).max(initial=0.0)) or math.inf
    near = np.abs(fields.x) <= reach
    shown = Profile(fields.x[near], fields.gap[near], fields.contact_pressure[near], fields.fluid_pressure[near], fields.unit)
    _draw_along(figure, drawn, shown, scales_of_fields(shown, shown.x, "position $x$"))
    return figure


def _draw_along(
    figure: Figure,
    drawn: list[Axes],
    fields: Profile,
    scales: tuple[Scale, Scale, Scale],
    solution: BaseSolution | None = None,
    hertz: Array | None = None,
) -> None:
    """Draw the gap into the axes above, if there are any, and the pressures into the last."""
    to_x, to_gap, to_pressure = scales
    x, (*above, below) = fields.x * to_x[0], drawn
    draw_pressures(below, fields, x, to_pressure, hertz)
    below.set_xlabel(f"{to_x[1]}; fluid enters from the left")
    for axes in above:
        draw_gap(axes, solution, x, fields.gap, to_gap)
        axes.tick_params(labelbottom=False)
        axes.sharex(below)
    style.add_legend(figure, drawn, columns=3, inside=not above)


def scales_of_fields(fields: Any, x: Array, name: str) -> tuple[Scale, Scale, Scale]:
    """Return the scales of position, gap and pressure of a profile or a field, in units with readable numbers."""
    largest = [float(np.abs(values).max()) or 1.0 for values in (x, fields.gap, fields.pressure)]
    return _scales(None if fields.unit == "Hertz" else (1.0, 1.0, 1.0), largest, name)


def scales_of_state(solution: BaseSolution, gap: float, name: str) -> tuple[Scale, Scale, Scale]:
    """Return the scales of position, gap and pressure of a solution whose largest drawn gap is given."""
    hertz = None if solution.contact is None else solution.contact.hertz
    units = None if hertz is None else (hertz.half_width, hertz.indentation, hertz.pressure)
    return _scales(units, [1.0, gap, 1.0], name)


def _scales(units: tuple[float, float, float] | None, largest: list[float], name: str) -> tuple[Scale, Scale, Scale]:
    """Return scales of fields in given SI units, or in those of Hertz."""
    if units is None:
        return (1.0, f"{name[:-1]}/a$"), (1.0, r"gap $h/u_\mathrm{Hz}$"), (1.0, r"pressure $p/p_\mathrm{Hz}$")
    rows = zip(units, largest, ("length", "length", "pressure"), (name, "gap $h$", "pressure"), strict=True)
    found = [(unit, text, *style.readable_unit(dimension, unit * most)) for unit, most, dimension, text in rows]
    x, gap, pressure = ((unit * factor, style.with_unit(text, shown)) for unit, text, factor, shown in found)
    return x, gap, pressure


def draw_pressures(axes: Axes, fields: Profile, x: Array, to_pressure: Scale, hertz: Array | None = None) -> None:
    """Draw the pressures along the contact, and that of Hertz if given."""
    factor, label = to_pressure
    if hertz is not None:
        axes.plot(x, factor * hertz, color=style.GREY, lw=1.0, ls=(0, (2, 2)), label="dry smooth contact (Hertz)")
    axes.plot(x, factor * fields.pressure, color=style.INK, lw=1.8, label="total pressure")
    axes.plot(x, factor * fields.contact_pressure, lw=1.6, **style.CONTACT_LINE)
    axes.plot(x, factor * fields.fluid_pressure, lw=1.6, **style.FLUID_LINE)
    axes.axhline(0.0, color=style.GREY, lw=0.6, zorder=1)
    axes.set_ylabel(label)


def draw_gap(axes: Axes, solution: BaseSolution | None, x: Array, gap: Array, to_gap: Scale) -> None:
    """Draw the gap, and the roughness of a solution if it is visible beside it."""
    factor, label = to_gap
    axes.plot(x, factor * gap, color=style.INK, lw=1.8, label="gap")
    contact, shown = None if solution is None else solution.contact, gap
    rms = 0.0 if solution is None else float(solution.groups.relative_roughness) * (1.0 if contact is None else contact.alpha)
    if rms > max(0.0, 0.03 * gap.min()):
        shown = np.append(gap, rms)
        symbol = r"$h_\mathrm{rms}/\alpha$" if contact is None else LINE.kept["roughness"].symbol
        axes.axhline(factor * rms, label=f"roughness {symbol}", **style.ROUGHNESS_LINE)
    if gap.min() > 0:
        style.make_logarithmic(axes, "y", factor * shown)
    axes.set_ylabel(label)


def mark_failure(solution: BaseSolution, drawn: list[Axes]) -> None:
    """Write across the picture of a failed state that the state is no result."""
    words: dict[str, Any] = {"ha": "center", "va": "center", "rotation": 20, "zorder": 10, "size": 22, "color": style.MARK}
    for axes in () if solution.outcome.ok else drawn:
        axes.text(0.5, 0.5, "not converged", transform=axes.transAxes, **words)


def caption_of(solution: BaseSolution, notes: bool) -> tuple[list[list[str]], list[str]]:
    """Return the caption of a state's picture: inputs, groups, law and error, and its notes if wanted."""
    groups = [f"{name} group {float(getattr(solution.groups, name)):.4g}" for name in ("speed", "load", "roughness")]
    error = f"estimated error {solution.error_estimate:.1e}"
    second = [law_text(solution), f"rtol {solution.rtol:g}", error, style.program()]
    said = [] if solution.outcome.ok else [solution.outcome.value]
    return [[*input_texts(solution.contact), *groups], second], [*said, *(solution.notes if notes else ())]


def _positions(solution: Solution) -> Array:
    """Return positions to draw at [a], denser where the nodes are, as far as the pressure reaches."""
    pressure = np.abs(solution.contact_pressure) + np.abs(solution.fluid_pressure)
    reach = max(1.6, 1.25 * float(np.abs(solution.x[pressure > 0.02 * pressure.max()]).max(initial=0.0)))
    return np.unique(np.concatenate([np.linspace(-reach, reach, 801), solution.x[np.abs(solution.x) < reach]]))


def law_text(solution: BaseSolution) -> str:
    """Return name and parameters of the contact law."""
    if solution.law in ("dry contact", "smooth"):
        return solution.law
    numbers = in_words(solution.law_parameters, si=True)
    return f"{solution.law} contact law" + (f" ({numbers})" if numbers else "")


def interference(gap: Any) -> Array:
    """Return the colours that a film shows between a coated glass and a reflecting ball."""
    path = REFRACTIVE_INDEX * np.maximum(np.asarray(gap, dtype=float), 0.0)[..., None]
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
    caption, headline = caption_of(solution, notes), title or "Film and pressure of a ball"
    figure, drawn = style.new_figure((10.0, 8.6), *caption, rows=2, columns=2, title=headline, ax=ax)
    if drawn[1:]:
        drawn[0].get_gridspec().update(right=0.91, wspace=0.42, hspace=0.18)  # type: ignore[union-attr]
    along = np.linspace(-HALF_SIDE, HALF_SIDE, SIDE_POINTS)
    field = solution.field(along, along[:, None])
    scales = scales_of_state(solution, 3 * abs(solution.central_gap), "$x$")
    light = None
    if colours == "interference" and solution.contact is not None:
        light = interference(field.gap * solution.contact.hertz.indentation)
    _draw_maps(figure, drawn[:2], field, (along, along), scales, light)
    unit = scales[0][0]
    turn = np.linspace(0, 2 * math.pi, 181)
    for axes in drawn[:2]:
        axes.plot(unit * np.cos(turn), unit * np.sin(turn), color=style.GREY, lw=0.9, ls=(0, (2, 2)))
        axes.set_xlabel("" if drawn[1:] else scales[0][1])
    r, angle = solution.minimum_radius, solution.minimum_angle
    if r > 0.02:
        x, y = r * math.cos(angle) * unit, r * math.sin(angle) * unit
        drawn[0].plot([x, x], [y, -y], ls="", marker="o", ms=4.5, mfc="none", mec=style.MARK, mew=1.3)
    if drawn[1:]:
        _draw_cut(figure, drawn[2:], solution, scales)
    mark_failure(solution, drawn)
    return figure


@style.picture("the points are no grid")
def plot_field(field: Field, *, ax: Axes | None = None, title: str = "") -> Figure:
    """Draw film and pressure on the plane, in the units of the field."""
    if field.grid is None or not all(len(each) > 1 and np.ptp(np.diff(each)) < 1e-6 * np.ptp(each) for each in field.grid):
        raise InputError("this field is not on an evenly spaced grid; a picture needs one, as of field(x, x[:, None]).")
    figure, drawn = style.new_figure((10.5, 4.6), [], columns=2, title=title or "Film and pressure", ax=ax)
    scales = scales_of_fields(field, np.stack([np.abs(each).max() for each in field.grid]), "$x$")
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
        drawn[0].set_title(f"interference colours, refractive index {REFRACTIVE_INDEX:g}", size=9.5, color=style.INK)
    for axes in drawn[1:]:
        pressure = field.pressure * to_pressure[0]
        most = float(np.abs(pressure).max()) or 1.0
        # Suction has another colour.
        image = axes.imshow(
            pressure, origin="lower", extent=extent, cmap="RdBu_r", vmin=-most, vmax=most, interpolation="bilinear"
        )
        figure.colorbar(image, ax=axes, fraction=0.046, pad=0.02).set_label(f"total {to_pressure[1]}", size=9, color=style.INK)
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
    figure.colorbar(image, ax=axes, fraction=0.046, pad=0.02).set_label(label, size=9, color=style.INK)


def _draw_cut(figure: Figure, drawn: list[Axes], solution: PointSolution, scales: tuple[Scale, Scale, Scale]) -> None:
    """Draw gap and pressures along the middle line."""
    to_x, to_gap, to_pressure = scales
    x = np.linspace(-HALF_SIDE, HALF_SIDE, 801)
    cut = solution.profile(x)
    draw_gap(drawn[0], solution, x * to_x[0], cut.gap, to_gap)
    draw_pressures(drawn[1], cut, x * to_x[0], to_pressure, np.sqrt(np.clip(1 - x**2, 0, None)))
    for axes in drawn:
        axes.set_xlabel(f"{to_x[1]} on the middle line; fluid enters from the left")
        axes.set_xlim(x[0] * to_x[0], x[-1] * to_x[0])
    style.add_legend(figure, drawn, columns=3)
