"""Pictures of phase diagrams: the plane of speed and roughness at one load, and the space of several loads.

Regions and solid lines come from solved states, dashed lines from our formulas, dash-dotted and dotted ones
from those of [BP], corrected and as printed.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from stribeck._types import Array
from stribeck.contacts.geometries import LINE
from stribeck.plot import style
from stribeck.plot.style import Axes, Figure
from stribeck.quantities.formats import format_si
from stribeck.quantities.units import InputError

if TYPE_CHECKING:
    import xarray

GROUP_SYMBOLS = {"speed": r"$\lambda$", "load": r"$\bar F_N$", "roughness": r"$\bar h_\mathrm{rms}$"}

# Solved lines: label, colour and width.
SOLVED = {
    "speed_at_5_percent_fluid": ("fluid carries 5 % of the load", style.CONTACT, 1.8),
    "speed_at_half_fluid": ("fluid carries half the load", style.GREY, 1.2),
    "speed_at_10_percent_contact_friction": ("asperities cause 10 % of the friction", style.FLUID, 1.8),
    "speed_at_minimum": ("minimum of friction", style.MARK, 1.8),
}
OURS = "our formulas"

# Lines of formulas: label, colour and dashes.
FORMULAS = {
    "formula_speed_at_5_percent_fluid": (OURS, style.INK, style.DASHED),
    "formula_speed_at_half_fluid": (OURS, style.INK, style.DASHED),
    "formula_speed_at_minimum": (OURS, style.INK, style.DASHED),
    "formula_speed_boundary_to_mixed": ("end of boundary [BP], corrected", style.CONTACT, (0, (4, 1.5, 1, 1.5))),
    "printed_speed_boundary_to_mixed": ("end of boundary [BP], as printed", style.CONTACT, (0, (1, 1.6))),
    "printed_speed_at_minimum": ("minimum [BP], as printed", style.MARK, (0, (1, 1.6))),
}

SPEED_FACTOR_BEYOND = 1e30  # Factor beyond the speeds of the grid at which a region ends that has no end

# Lines of the planes in space: label, colour, dashes and width.
IN_SPACE = {
    **{name: (*look[:2], "-", look[2]) for name, look in SOLVED.items() if name != "speed_at_half_fluid"},
    **{name: (*FORMULAS[name], 1.4) for name in ("formula_speed_at_5_percent_fluid", "formula_speed_at_minimum")},
}

SURFACE_POINTS = 201  # Along each side of a surface

# The two surfaces between the three regimes.
SURFACES = ("speed_at_5_percent_fluid", "speed_at_10_percent_contact_friction")


@style.picture("the diagram has fewer than two speeds or roughnesses that a logarithmic axis shows")
def plot_phase_diagram(
    dataset: xarray.Dataset, *, ax: Axes | None = None, load: float | None = None, title: str = ""
) -> Figure:
    """Draw the regimes over speed and roughness at one load.

    Parameters
    ----------
    dataset : xarray.Dataset
        From :func:`stribeck.regimes.phase_diagram`, in groups or in SI units.
    load : float, optional
        The load, of which the nearest in the dataset is drawn; the first if not given.
    """
    inputs, said = _caption(dataset, [float(_plane(dataset, load)["load"])])
    # An empty line leaves room for the third row of the legend.
    figure, (axes,) = style.new_figure((9.0, 5.6), [[" "], *inputs], said, title=title or "Phase diagram", ax=ax)
    draw_phase_diagram(axes, dataset, load)
    if ax is None:
        style.add_legend(figure, [axes], columns=3)
    return figure


@style.picture("the diagram has fewer than two loads, speeds or roughnesses")
def plot_phase_space(dataset: xarray.Dataset, *, title: str = "") -> Figure:
    """Draw the regimes over speed, load and roughness: planes at the first and last load, and the surfaces between.

    Parameters
    ----------
    dataset : xarray.Dataset
        From :func:`stribeck.regimes.phase_diagram` with two or more loads.
    """
    _plane(dataset, None)
    loads = dataset["load"].values
    figure, (flat,) = style.new_figure((9.0, 6.4), *_caption(dataset, [loads[0], loads[-1]]), title=title or "Phase diagram")
    bottom = flat.get_position().y0 + (style.LEGEND_INCH - 0.72) / figure.get_figheight()
    flat.remove()
    axes = figure.add_axes((0.0, bottom, 0.97, 0.97 - bottom), projection="3d")
    draw_phase_space(axes, dataset)
    style.add_legend(figure, [axes], columns=3)
    return figure


def draw_phase_diagram(axes: Axes, dataset: xarray.Dataset, load: float | None = None) -> None:
    """Draw the plane of one load onto axes, without legend."""
    plane = _plane(dataset, load)
    ends, y = plane.speed.values[[0, -1]], plane.roughness.values
    for regime, (left, right) in _regions(plane).items():
        axes.fill_betweenx(y, left, right, color=style.TINTS[regime], lw=0, zorder=0)
        shown = np.clip([left, right], *ends)
        _name_region(axes, regime, shown[0], shown[1], y)
    for name, (label, colour, width) in SOLVED.items():
        axes.plot(plane[name].values, y, color=colour, lw=width, label=label, zorder=4)
    for name, (label, colour, dashes) in FORMULAS.items():
        axes.plot(plane[name].values, y, color=colour, lw=1.2, ls=dashes, label=label, zorder=4.5)
    merging = plane.get("roughness_without_minimum")
    if merging is not None and y[0] <= (height := float(merging.values)) <= y[-1]:
        axes.axhline(height, color=style.INK, lw=0.9, ls=(0, (7, 3, 1, 3)), label="above: no minimum of friction", zorder=2)
    x_label, y_label = _label(plane, "speed"), _label(plane, "roughness")
    axes.set(xscale="log", yscale="log", xlabel=x_label, ylabel=y_label, xlim=ends, ylim=(y[0], y[-1]))


def draw_phase_space(axes: Any, dataset: xarray.Dataset) -> None:
    """Draw planes and surfaces onto three-dimensional axes, whose coordinates are decimal logarithms, without legend."""
    from matplotlib.ticker import FuncFormatter, MaxNLocator

    loads = dataset["load"].values
    if len(loads) < 2:
        raise InputError(f"the diagram has {len(loads)} load; the space of a phase diagram needs two or more.")
    planes = [_plane(dataset, load) for load in loads]
    depth = np.log10(loads)
    for surface in SURFACES:
        _draw_surface(axes, planes, depth, surface)
    # Far things first: the axes know no depth for regions that lie in a plane.
    for layer, (plane, y) in enumerate([(planes[0], depth[0]), (planes[-1], depth[-1])]):
        _draw_layer(axes, plane, y, far=layer == 0)
    axes.computed_zorder = False
    for axis, name in (("x", "speed"), ("y", "load"), ("z", "roughness")):
        ends = np.log10(planes[0][name].values[[0, -1]]) if axis != "y" else depth[[-1, 0]]  # The heavier load in front
        axes.set(**{f"{axis}label": _label(planes[0], name), f"{axis}lim": ends})
    for axis in (axes.xaxis, axes.zaxis):
        axis.set_major_locator(MaxNLocator(6, integer=True))
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"$10^{{{value:.0f}}}$"))
    shown = depth[[0, -1]] if len(depth) > 5 else depth
    axes.set_yticks(shown, [f"{value:.3g}" for value in 10**shown])
    axes.view_init(elev=18, azim=-62)
    axes.set_box_aspect((1.5, 1.1, 0.95), zoom=1.12)
    axes.tick_params(labelsize=9, colors=style.INK)
    axes.tick_params(axis="y", pad=8)
    for axis in (axes.xaxis, axes.yaxis, axes.zaxis):
        axis.label.set(color=style.INK, size=10.5)
        axis.pane.set(facecolor="white", edgecolor=style.GREY)


def _draw_layer(axes: Any, plane: xarray.Dataset, y: float, far: bool) -> None:
    """Draw regions and lines of one load at depth y."""
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    z, (low, high) = np.log10(plane.roughness.values), np.log10(plane.speed.values[[0, -1]])
    order = 1 if far else 20
    for regime, edges in _regions(plane).items():
        left, right = (np.clip(np.log10(edge), low, high) for edge in edges)
        known = np.isfinite(left)
        x = np.concatenate([left[known], right[known][::-1]])
        corners = np.column_stack([x, np.full(len(x), y), np.concatenate([z[known], z[known][::-1]])])
        tint = {"facecolor": style.TINTS[regime], "alpha": 0.95 if far else 0.6, "lw": 0}
        axes.add_collection3d(Poly3DCollection([corners], zorder=order, **tint))
        room = right - left
        if not far and known.any() and np.nanmax(room) > 0:
            i = int(np.nanargmax(np.where((z > z[0]) & (z < z[-1]), room, -1.0)))
            axes.text(0.5 * (left[i] + right[i]), y, z[i], regime, ha="center", color=style.GREY, style="italic", zorder=30)
    for name, (label, colour, dashes, width) in IN_SPACE.items():
        fine = np.linspace(z[0], z[-1], SURFACE_POINTS)
        line = np.interp(fine, z, np.log10(plane[name].values))
        line = np.where((low <= line) & (line <= high), line, np.nan)
        look = {"color": colour, "ls": dashes, "lw": width, "alpha": 0.7 if far else 1.0, "label": "" if far else label}
        axes.plot(line, np.full(SURFACE_POINTS, y), fine, zorder=order + 1, **look)


def _draw_surface(axes: Any, planes: list[xarray.Dataset], depth: Array, name: str) -> None:
    """Draw the surface of one transition over load and roughness, straight in the logarithms between solved rows."""
    rough, (low, high) = np.log10(planes[0].roughness.values), np.log10(planes[0].speed.values[[0, -1]])
    fine = np.linspace(rough[0], rough[-1], SURFACE_POINTS)
    by_row = np.array([np.interp(fine, rough, np.log10(plane[name].values)) for plane in planes])
    deep = np.linspace(depth[0], depth[-1], SURFACE_POINTS)
    x = np.array([np.interp(deep, depth, column) for column in by_row.T]).T
    x = np.where((low <= x) & (x <= high), x, np.nan)
    y, z = np.meshgrid(deep, fine, indexing="ij")
    steps = {"rstride": 4, "cstride": 4}
    axes.plot_surface(x, y, z, color=SOLVED[name][1], alpha=0.3, lw=0, shade=False, zorder=10, **steps)


def _plane(dataset: xarray.Dataset, load: float | None) -> xarray.Dataset:
    """Return the diagram at one load as drawn: roughness in µm, and without zeros, which logarithmic axes do not show."""
    plane = dataset.isel(load=0) if load is None else dataset.sel(load=load, method="nearest")
    plane = plane.isel(speed=np.flatnonzero(plane.speed.values > 0), roughness=np.flatnonzero(plane.roughness.values > 0))
    if plane.sizes["speed"] < 2 or plane.sizes["roughness"] < 2:
        raise InputError(
            f"the diagram has {plane.sizes['speed']} positive speed and {plane.sizes['roughness']} positive roughness; "
            "a picture needs two or more of each."
        )
    if plane.roughness.attrs["units"] == "m":
        heights = {name: plane[name] * 1e6 for name in ("roughness", "roughness_without_minimum") if name in plane.variables}
        plane = plane.assign_coords(roughness=heights.pop("roughness").assign_attrs(units="µm")).assign(heights)
    return plane


def _regions(plane: xarray.Dataset) -> dict[str, tuple[Array, Array]]:
    """Return the speeds between which each regime holds, by roughness; nan where a row has no states."""
    low, high = plane.speed.values[[0, -1]]
    codes = plane.regime.values
    known = (codes >= 0).any(axis=-1)
    fluid = plane.speed_at_5_percent_fluid.values
    # A row that never passes a line lies on one side of it, which its states tell.
    fluid = np.where(np.isnan(fluid), np.where((codes == 0).any(axis=-1), np.inf, 0.0), fluid)
    contact = plane.speed_at_10_percent_contact_friction.values
    contact = np.where(np.isnan(contact), np.where((codes == 2).any(axis=-1), 0.0, np.inf), contact)
    # Lines beyond the grid stay where they are, so that they leave the picture at the right place.
    beyond = low / SPEED_FACTOR_BEYOND, high * SPEED_FACTOR_BEYOND
    first, last = (np.where(known, np.clip(line, *beyond), np.nan) for line in (np.minimum(fluid, contact), contact))
    ends = np.where(known, beyond[0], np.nan), np.where(known, beyond[1], np.nan)
    return {"boundary": (ends[0], first), "mixed": (first, last), "hydrodynamic": (last, ends[1])}


def _name_region(axes: Axes, regime: str, left: Array, right: Array, y: Array) -> None:
    """Write the name of a regime where it is widest in the lower part of the picture."""
    with np.errstate(invalid="ignore", divide="ignore"):
        room = np.where(np.isfinite(left * right), np.log(right / left), 0.0)
    part = np.linspace(0, 1, len(y))
    room = np.where((part > 0.06) & (part < 0.94), room, 0.0)
    if room.max(initial=0.0) <= 0:
        return
    i = int(np.argmax(room))
    place = math.sqrt(left[i] * right[i]), y[i]
    box = {"facecolor": style.TINTS[regime], "lw": 0, "pad": 1.5}
    axes.text(*place, regime, ha="center", va="center", size=10, style="italic", color=style.GREY, bbox=box, zorder=5)


def _label(dataset: xarray.Dataset, name: str) -> str:
    """Return the label of an axis."""
    unit = dataset[name].attrs["units"]
    return f"{name} group {GROUP_SYMBOLS[name]}" if unit == "1" else f"{name} {LINE.kept[name].symbol} ({unit})"


def _caption(dataset: xarray.Dataset, loads: list[float]) -> tuple[list[list[str]], list[str]]:
    """Return what the diagram was made with, and how it ended where it is not whole."""
    attributes, is_si = dataset.attrs, dataset["load"].attrs["units"] != "1"
    values = dict.fromkeys(format_si(load, LINE.quantities["load"].dimension, 4) if is_si else f"{load:.4g}" for load in loads)
    first = [f"{'load' if is_si else 'load group'} {' and '.join(values)}"]
    for key, row in LINE.kept.items():
        if f"input_{key}" in attributes:
            first.append(f"{row.symbol} = {format_si(attributes[f'input_{key}'], row.dimension, 4)}")
    if "input_radius" not in attributes:
        first += [rf"$\mu_0$ = {attributes['boundary_friction']:.4g}", rf"$\beta$ = {attributes['beta']:.4g}"]
    solved, all_states = int((dataset.regime.values >= 0).sum()), dataset.regime.size
    count = f"{solved} states" if solved == all_states else f"{solved} of {all_states} states"
    error = f"estimated error {float(np.nanmax(dataset.error_estimate.values, initial=0.0)):.1e}"
    second = [f"viscous friction: {attributes['definition']}", f"rtol {attributes['rtol']:g}", error, count, style.program()]
    return [first, second], [] if attributes["complete"] else [attributes["outcome"]]
