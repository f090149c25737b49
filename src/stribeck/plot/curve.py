"""The picture of a Stribeck curve: friction, and beside it films, load shares or smooth friction; and of many states."""

import math
from collections.abc import Sequence
from functools import partial
from typing import Any, Literal, get_args

import numpy as np

from stribeck._types import Array
from stribeck.contacts.contact import input_texts
from stribeck.contacts.friction_rules import RULES, speed_words
from stribeck.contacts.geometries import LINE
from stribeck.curves.result import StribeckCurve
from stribeck.files.results import Exported
from stribeck.fits.measurements import Measurements
from stribeck.plot import style
from stribeck.plot.state import law_text
from stribeck.plot.style import CONTACT, FLUID, GREY, INK, MARK, Axes, Figure, add_legend, make_logarithmic, new_figure
from stribeck.quantities.units import DIMENSIONS, InputError, show
from stribeck.uncertainty.propagate import Band
from stribeck.uncertainty.result import Uncertainty

Abscissa = Literal["speed", "hersey"]
Panel = Literal["film", "hydrodynamic", "shares"]

DECADES_BELOW_MINIMUM = 1.3  # Decades of friction drawn below its minimum, so that both parts show
MIN_ROUGHNESS_OVER_FILM = 0.01  # Roughness over the thinnest film from which on it is drawn beside the films
MAX_MARKED_POINTS = 25  # Number of points up to which each is marked

GROUP_SYMBOLS = {
    "speed": r"$\lambda$",
    "load": r"$F_N/(\pi\beta^2 R E^*)$",
    "roughness": r"$h_\mathrm{rms}/(4\alpha\beta^2 R)$",
}


@style.picture("the panel is unknown or does not exist for this curve")
def plot_curve(
    curve: StribeckCurve,
    *,
    ax: Axes | None = None,
    title: str = "",
    notes: bool = True,
    abscissa: Abscissa = "speed",
    panel: Panel = "film",
    band: Band | None = None,
    verdict: str = "",
) -> Figure:
    """Draw a Stribeck curve: friction and its parts, and beside them films and roughness, in SI units for a contact.

    Regimes are shaded, minimum, transitions and the contact itself marked; the caption holds the inputs and the notes.

    Parameters
    ----------
    abscissa : {"speed", "hersey"}
        Lower axis of a curve over the speed; the other one stands above.
    panel : {"film", "hydrodynamic", "shares"}
        What the second panel shows: central and minimum film with the roughness, friction over that of smooth surfaces at the
        same speed (a line contact of the article, over speed or load), or the shares of the load.
    band : stribeck.uncertainty.propagate.Band, optional
        What errors of the inputs leave open along the curve, which is drawn around the friction.
    verdict : str
        Sentence that says whether the model applies, which stands before the notes.
    """
    for name, value, known in (("abscissa", abscissa, get_args(Abscissa)), ("panel", panel, get_args(Panel))):
        if value not in known:
            raise InputError(f"{name} = {show(value)}; it must be {' or '.join(map(repr, known))}.")
    has_law = curve.over != "roughness" and bool((curve.hydrodynamic_friction > 0).all())
    if panel == "hydrodynamic" and not has_law:
        raise InputError(
            "panel = 'hydrodynamic' needs a line contact of the article's model over speed or load; take 'shares'."
        )
    if ax is not None:
        figure = style.figure_of(ax)
        _draw_friction(ax, curve, curve.values, _label(curve), band)
        add_legend(figure, [ax], inside=ax)
        return figure
    caption, said = _caption(curve)
    said += [*([verdict] if verdict and notes else ()), *(curve.notes if notes else ())]
    return _draw_curve(curve, caption, said, title or "Stribeck curve", abscissa, panel, band)[0]


def _draw_curve(
    curve: StribeckCurve,
    caption: list[list[str]],
    notes: list[str],
    title: str,
    abscissa: Abscissa = "speed",
    panel: Panel = "film",
    band: Band | None = None,
) -> tuple[Figure, Axes, Axes]:
    """Return a figure with the two panels of a curve, and them."""
    has_speed = curve.over == "speed"
    size, top = ((11.0, 5.0), 1.0) if has_speed else ((11.0, 4.6), 0.6)
    # An empty line leaves room for the third row of the legend.
    figure, (left, right) = new_figure(
        size, [[" " if panel == "film" else ""], *caption], notes, columns=2, top=top, title=title
    )
    hersey = curve.hersey_number, f"Hersey number ${RULES[curve.groups.geometry].hersey_symbol}$"
    own = curve.values, _label(curve)
    x, label = hersey if has_speed and abscissa == "hersey" else own
    _draw_friction(left, curve, x, label, band)
    if panel == "film":
        _draw_films(right, curve, x, label)
    elif panel == "shares":
        _draw_shares(right, curve, x, label)
    else:
        smooth = "friction coefficient of smooth surfaces at the same speed"
        _draw_friction(right, curve, curve.hydrodynamic_friction, smooth, parts=False)
        right.set_ylim(left.get_ylim())
        ends = np.array(right.get_ylim())
        right.plot(ends, ends, color=GREY, lw=1.2, ls=style.DASHED, zorder=2, label="as smooth surfaces", scalex=False)
    if has_speed:
        above, above_label = hersey if abscissa == "speed" else own
        factor = float(above[0] / x[0])
        for axes in (left, right) if panel != "hydrodynamic" else (left,):
            upper = axes.secondary_xaxis("top", functions=(partial(np.multiply, factor), partial(np.multiply, 1 / factor)))
            upper.set_xlabel(above_label, color=GREY, fontsize=9)
            upper.tick_params(colors=GREY, labelsize=8, direction="in", which="both")
    add_legend(figure, (left, right))
    return figure, left, right


def draw_report(curve: StribeckCurve, data: Measurements | None, uncertainty: Uncertainty | None) -> Figure:
    """Draw the curve of a contact for a report: with measured points and the 95 % interval of the friction."""
    contact = curve.contact
    assert contact is not None
    figure, left, _ = _draw_curve(curve, [], [], "Friction and film over the speed")
    if uncertainty is not None:
        spread = uncertainty["friction"]
        (low, high), middle = sorted(map(abs, spread.interval_95)), abs(spread.value)
        error = [[max(0.0, middle - low)], [max(0.0, high - middle)]]
        left.errorbar([contact.speed], [middle], error, color=MARK, capsize=3, fmt="o", ms=4)
        _include(left, [contact.speed], [low, high])
    if data is not None:
        # Points measured against another quantity are converted to speed.
        speed = data.values * RULES[contact.groups.geometry].speed_per(data.abscissa, contact)
        look: dict[str, Any] = {"fmt": ".", "color": GREY, "ms": 5, "lw": 0.8, "zorder": 1}
        add_curves(figure, [(speed, data.friction, {"yerr": data.error, "label": "measured", **look})])
    return figure


def add_curves(figure: Figure, added: Sequence[tuple[Any, Any, dict[str, Any]]]) -> None:
    """Draw further friction over the abscissa of a curve's picture, and name it in the legend below."""
    left, right = figure.axes[:2]
    for x, friction, look in added:
        left.errorbar(x, friction, **look)
        _include(left, x, friction)
    right.set_xlim(left.get_xlim())
    for legend in figure.legends:
        legend.remove()
    add_legend(figure, (left, right))


def _include(axes: Axes, x: Any, y: Any) -> None:
    """Widen logarithmic axes so that they show positive values."""
    for limits, change, values in ((axes.get_xlim(), axes.set_xlim, x), (axes.get_ylim(), axes.set_ylim, y)):
        positive = [*limits, *(each for each in np.asarray(values) if each > 0)]
        change(min(positive), max(positive))


def _label(curve: StribeckCurve) -> str:
    """Return the label of the coordinate."""
    if curve.contact is None:
        return f"{curve.over} group {GROUP_SYMBOLS[curve.over]}"
    if curve.over == "speed":
        return f"{speed_words(curve.contact)} $U$ (m/s)"
    row = curve.contact.INPUTS.quantities[curve.over]
    return style.with_unit(f"{curve.over} {row.symbol}", DIMENSIONS[row.dimension].unit)


def _draw_friction(
    axes: Axes, curve: StribeckCurve, x: Array, label: str, band: Band | None = None, *, parts: bool = True
) -> None:
    """Draw the sizes of friction and of its parts, the landmarks, and what errors of the inputs leave open."""
    total, contact, viscous = map(np.abs, (curve.friction.total, curve.friction.asperities, curve.friction.fluid))
    error, positive = curve.friction.error, total[total > 0]
    if positive.size:
        axes.set_yscale("log")
    # Through the marks too, which lie beside straight lines between few points.
    places = np.concatenate([curve.values, [mark.value for mark in curve.transitions]])
    order = np.argsort(places, kind="stable")
    heights = np.concatenate([total, [abs(mark.friction) for mark in curve.transitions]])[order]
    axes.plot(_along(curve, x, places[order]), heights, color=INK, lw=2.2, zorder=4, label=r"friction $\mu$")
    if parts:
        axes.plot(x, contact, lw=1.5, zorder=5, **style.CONTACT_LINE)
        axes.plot(x, viscous, lw=1.5, zorder=5, **style.FLUID_LINE)
    if len(curve) <= MAX_MARKED_POINTS:
        axes.plot(x, total, color=INK, ls="", marker="o", ms=3.0, zorder=4)
    if (error > 0.01 * total).any():
        axes.fill_between(x, total - error, total + error, color=INK, alpha=0.2, lw=0, zorder=3, label="estimated error")
    if positive.size:
        seen = [part.max() / 5 for part in (contact, viscous) if part.max() > 1e-4 * total.max()]
        axes.set_ylim(min([positive.min() / 10**DECADES_BELOW_MINIMUM, *seen]), 3 * total.max())
    _draw_ground(axes, curve, x, label)
    for mark in curve.transitions:
        at = _along(curve, x, mark.value), abs(mark.friction)
        if mark is curve.minimum:
            name = rf"minimum, $\mu$ = {mark.friction:.3g} at {_place(curve, mark.value)}"
            axes.plot(*at, "o", ms=8, color=MARK, mec="white", mew=1.2, zorder=6, label=name)
        elif "50 %" in mark.name:
            name = f"fluid carries half the load, at {_place(curve, mark.value)}"
            axes.plot(*at, "D", ms=6, color=FLUID, mec="white", mew=1.0, zorder=5, label=name)
    if band is not None:
        low, high = band.along(curve.values, total)
        axes.fill_between(x, low, high, color=INK, alpha=0.14, lw=0, zorder=1, label="95 % by errors of the inputs")
        axes.set_ylim(top=max(axes.get_ylim()[1], 1.2 * float(np.nanmax(high))))
    # Below zero the substrate is dragged along, and the axis shows sizes.
    axes.set_ylabel(r"size of friction coefficient $|\mu|$" if (curve.friction.total < 0).any() else style.FRICTION)


def _draw_films(axes: Axes, curve: StribeckCurve, x: Array, label: str) -> None:
    """Draw central and minimum film and the roughness: lengths for a contact, in units of the indentation for groups."""
    central, minimum = curve.observable("central_gap"), curve.observable("minimum_gap")
    roughness = np.broadcast_to(np.asarray(curve.groups.relative_roughness), len(curve)).astype(float)
    symbol, unit = r"$h_\mathrm{rms}/\alpha$", r"$u_\mathrm{Hz}$"
    if curve.contact is not None:
        contacts = [curve.contact.replace(load=load) for load in curve.values] if curve.over == "load" else [curve.contact]
        indentation = np.array([each.hertz.indentation for each in contacts])
        factor, unit = style.readable_unit("length", float((indentation * central).max()))
        central, minimum, roughness = (factor * indentation * each for each in (central, minimum, roughness))
        roughness, symbol = roughness * curve.contact.alpha, LINE.kept["roughness"].symbol
    axes.plot(x, central, color=INK, lw=2.0, label="central film")
    axes.plot(x, minimum, color=FLUID, lw=1.5, ls=(0, (3, 1.5)), label="minimum film")
    films = np.concatenate([central, minimum])
    if roughness.max(initial=0.0) > MIN_ROUGHNESS_OVER_FILM * films.min():
        axes.plot(x, roughness, label=f"roughness {symbol}", **style.ROUGHNESS_LINE)
        films = np.concatenate([films, roughness])
    if films.min() > 0:
        make_logarithmic(axes, "y", films)
        axes.set_ylim(0.6 * films.min(), films.max() * (films.max() / films.min()) ** 0.15 * 1.2)  # Room for the regimes
    axes.set_ylabel(style.with_unit("film thickness", unit))
    _draw_ground(axes, curve, x, label)


def _draw_shares(axes: Axes, curve: StribeckCurve, x: Array, label: str) -> None:
    """Draw the shares of the load."""
    axes.plot(x, curve.observable("contact_load_share"), lw=1.8, **style.CONTACT_LINE)
    axes.plot(x, curve.observable("fluid_load_share"), lw=1.8, **style.FLUID_LINE)
    axes.set(ylim=(-0.04, 1.12), ylabel="share of the load")
    _draw_ground(axes, curve, x, label)


def _draw_ground(axes: Axes, curve: StribeckCurve, x: Array, label: str) -> None:
    """Shade and name regimes, mark the contact, hatch where the check of the contact law is not fine, and set the abscissa."""
    make_logarithmic(axes, "x", x)
    axes.tick_params(axis="x", which="both", pad=6.5)  # Apart from the number at the lower end of the other axis
    axes.set_xlabel(label)
    if len(curve) < 2:
        return
    axes.set_xlim(x.min(), x.max())
    for regime, low, high in curve.regime_ranges:
        first, last = _along(curve, x, np.array([low, high]))
        axes.axvspan(first, last, color=style.TINTS[regime], lw=0, zorder=0)
        if abs(math.log(last / first)) > 0.0165 * len(regime) * math.log(x.max() / x.min()):
            place, form = (math.sqrt(first * last), 0.965), axes.get_xaxis_transform()
            axes.text(*place, regime, transform=form, ha="center", va="top", size=9, color=GREY, style="italic")
    own = None if curve.contact is None else getattr(curve.contact, curve.over)
    if own is not None and curve.values.min() <= own <= curve.values.max():
        name, dots = f"this contact, at {_place(curve, own)}", (0, (1, 2))
        axes.axvline(_along(curve, x, own), color=GREY, lw=1.2, ls=dots, zorder=2, label=name)
    if curve.law_in_doubt.any():
        middles = np.sqrt(x[:-1] * x[1:])
        ends = np.column_stack([np.append(x[0], middles), np.append(middles, x[-1])]).ravel()
        strip: dict[str, Any] = {"facecolor": "none", "edgecolor": CONTACT, "hatch": "//////", "lw": 0.0, "zorder": 2}
        strip |= {"transform": axes.get_xaxis_transform(), "label": "contact law outside its range"}
        axes.fill_between(ends, 0.0, 0.035, where=np.repeat(curve.law_in_doubt, 2).tolist(), **strip)


def _along(curve: StribeckCurve, x: Array, values: Any) -> Any:
    """Return where values of what varies lie along an abscissa that the points of a curve have; its points exactly."""
    found = np.exp(np.interp(np.log(values), np.log(curve.values), np.log(x)))
    known = dict(zip(curve.values.tolist(), x.tolist(), strict=True))
    return np.array([known.get(float(value), at) for value, at in np.broadcast(values, found)]).reshape(np.shape(values))


def _place(curve: StribeckCurve, value: float) -> str:
    if curve.contact is None:
        return f"{curve.over} group {value:.3g}"
    return curve.contact.INPUTS.text(curve.over, value, 3)


def _caption(curve: StribeckCurve) -> tuple[list[list[str]], list[str]]:
    """Return inputs and how they were solved, and how the curve ended where it is not whole."""
    first = input_texts(curve.contact, curve.over)
    if curve.contact is None:
        first += [rf"$\mu_0$ = {curve.boundary_friction:.4g}", rf"$\beta$ = {curve.beta:.4g}"]
    if not curve.states:
        return [[*first, f"read off the atlas, within {curve.rtol:.1g}", style.program()]], []
    for name in ("speed", "load", "roughness"):
        values = np.asarray(getattr(curve.groups, name))
        if np.ptp(values) <= 1e-12 * values[0]:
            first.append(f"{name} group {values[0]:.4g}")
    second = [
        law_text(curve.solutions[0]) if len(curve) else "",
        f"viscous friction: {curve.definition}",
        f"rtol {curve.rtol:g}",
        f"estimated error {curve.error_estimate:.1e}",
        f"{len(curve)} points" if len(curve) == curve.requested else f"{len(curve)} of {curve.requested} points",
        style.program(),
    ]
    return [first, second], [] if curve.outcome.ok else [curve.outcome.value]


@style.picture("nothing varies")
def plot_states(found: Exported, *, ax: Axes | None = None, title: str = "") -> Figure:
    """Draw a line for each state of the other dimensions; points where the states are no grid."""
    data = found.to_dataset()
    over = str(max(data.sizes, key=lambda name: data.sizes[name], default=""))
    if data.sizes.get(over, 0) < 2:
        raise InputError("nothing varies in this batch, so there is no curve to draw; give an input as an array.")
    scattered = over == "state" and "varied" in data.attrs
    name = data.attrs["varied"].partition(", ")[0] if scattered else over
    place = data[name if name in data.variables or not scattered else f"{name}_group"]  # the number of the state if unnamed
    friction = data[f"friction_{data.attrs['definition']}"].transpose(..., over)
    x = place.broadcast_like(friction).transpose(*friction.dims).values.reshape(-1, data.sizes[over]).astype(float)
    y = friction.values.reshape(x.shape)
    figure, (ax,) = style.new_figure((7.0, 4.6), [], title=title or "Friction", ax=ax)
    for line, (at, values) in enumerate(zip(x, y, strict=True)):
        ax.plot(at, values, "." if scattered else "-", color=style.INK, alpha=1.0 if line == 0 else 0.6, lw=1.5, ms=4)
    if name in data.variables and (x > 0).all():
        style.make_logarithmic(ax, "x", x)
    style.make_logarithmic(ax, "y", y[np.isfinite(y)])
    ax.set(xlabel=style.with_unit(name.replace("_", " "), place.attrs.get("units", "1")), ylabel=style.FRICTION)
    return figure
