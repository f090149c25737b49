"""The picture of a Stribeck curve, in both representations of the paper; beside it that of one state.

matplotlib comes with the extra ``plot`` and is imported on first use.
"""

from __future__ import annotations

import math
from importlib.metadata import version
from typing import TYPE_CHECKING, Any, Literal, Protocol

import numpy as np

from stribeck._types import Array
from stribeck.contacts.contact import input_texts
from stribeck.contacts.friction_rules import RULES, speed_words
from stribeck.files.pictures import (
    CONTACT,
    FLUID,
    GREY,
    INK,
    MARK,
    TINTS,
    add_legend,
    figure_of,
    finish_figure,
    make_logarithmic,
    new_figure,
    picture,
)
from stribeck.files.writing import PathLike
from stribeck.quantities.inputs import si_text
from stribeck.quantities.units import DIMENSIONS, InputError, show
from stribeck.solver.plot import law_text

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from stribeck.curves.atlas_curve import AtlasCurve
    from stribeck.curves.result import StribeckCurve

__all__ = ["hatch_law_in_doubt", "plot_atlas_curve", "plot_curve"]

Abscissa = Literal["hersey", "speed"]

DECADES_BELOW = 1.3
"""How far the axis extends below the minimum friction, so that both parts of the friction show."""

SYMBOLS_OF_GROUPS = {
    "speed": r"$\lambda$",
    "load": r"$F_N/(\pi\beta^2 R E^*)$",
    "roughness": r"$h_\mathrm{rms}/(4\alpha\beta^2 R)$",
}

FEW = 25
"""Number of points up to which each is marked."""


class Interval(Protocol):
    """An interval of the friction along a curve."""

    def along(self, values: Array, friction: Array) -> tuple[Array, Array]:
        """Return its ends at values of what varies, around the friction there."""


@picture()
def plot_curve(
    curve: StribeckCurve,
    path: PathLike | None = None,
    *,
    ax: Axes | None = None,
    force: bool = False,
    title: str = "",
    notes: bool = True,
    abscissa: Abscissa = "hersey",
    band: Interval | None = None,
    verdict: str = "",
) -> Figure:
    """Draw a Stribeck curve.

    The first panel shows friction and its parts against the Hersey number, or, over load or roughness, against that
    quantity; the second shows friction against the law of the hydrodynamic branch, or the shares of the load where
    that law does not hold. Regimes are shaded, minimum, transitions and the contact itself marked; the caption holds
    the inputs and the notes.

    Parameters
    ----------
    curve : StribeckCurve
        The curve.
    ax : matplotlib.axes.Axes, optional
        Axes to draw friction into, over the coordinate of the curve, instead of a new figure.
    abscissa : {"hersey", "speed"}
        Lower axis of a curve over the speed of a contact; the other one stands above.
    band : stribeck.uncertainty.band.Band, optional
        What errors of the inputs leave open along the curve, which is drawn around the friction.
    verdict : str
        Sentence that says whether the model applies, which stands before the notes.
    """
    if abscissa not in ("hersey", "speed"):
        raise InputError(f"abscissa = {show(abscissa)}; it must be 'hersey' or 'speed'.")
    if ax is not None:
        figure = figure_of(ax)
        label = _abscissa_of_values(curve)
        _draw_friction(ax, curve, curve.values)
        _draw_band(ax, curve, curve.values, band)
        hatch_law_in_doubt(ax, curve, curve.values)
        ax.set(xlabel=label, ylabel=_ordinate(curve))
        ax.legend(frameon=False, fontsize=8.5)
        return finish_figure(figure, path, force)
    by_speed = curve.over == "speed" and curve.contact is not None
    figure, (left, right) = new_figure(
        (11.0, 5.0 if by_speed else 4.6),
        *_caption(curve, notes, verdict),
        columns=2,
        top=1.0 if by_speed else 0.6,
        title=title or "Stribeck curve",
    )
    x, label = _abscissa(curve, abscissa)
    _draw_friction(left, curve, x)
    _draw_band(left, curve, x, band)
    hatch_law_in_doubt(left, curve, x)
    left.set_xlabel(label)
    for axes in (left, right):
        axes.set_ylabel(_ordinate(curve))
    if by_speed and curve.contact is not None:
        above, above_label = _abscissa(curve, "speed" if abscissa == "hersey" else "hersey")
        factor = float(above[0] / x[0])

        def up(values: Any) -> Any:
            return values * factor

        def down(values: Any) -> Any:
            return values / factor

        top = left.secondary_xaxis("top", functions=(up, down))
        top.set_xlabel(above_label, color=GREY, fontsize=9)
        top.tick_params(colors=GREY, labelsize=8, direction="in", which="both")
    law = curve.hydrodynamic_friction
    if (law > 0).all() and curve.over != "roughness":
        _draw_friction(right, curve, law, parts=False)
        hatch_law_in_doubt(right, curve, law)
        right.set_xlabel("friction coefficient of smooth surfaces at the same speed")
        right.set_ylim(left.get_ylim())
        ends = np.array(right.get_ylim())
        right.plot(
            ends,
            ends,
            color=GREY,
            lw=1.2,
            ls=(0, (5, 3)),
            zorder=2,
            label="as smooth surfaces",
            scalex=False,
        )
    else:
        _draw_shares(right, curve, x)
        right.set_xlabel(label)
        right.set_ylabel("share of the load")
    add_legend(figure, (left, right))
    return finish_figure(figure, path, force)


@picture()
def plot_atlas_curve(
    curve: AtlasCurve, path: PathLike | None = None, *, ax: Axes | None = None, force: bool = False, title: str = ""
) -> Figure:
    """Draw the friction of a curve that is read off the atlas, its parts, regimes and minimum, over what varies.

    Parameters
    ----------
    curve : AtlasCurve
        The curve.
    ax : matplotlib.axes.Axes, optional
        Axes to draw into, in place of a new figure.
    """
    read = f"read off the atlas, within {curve.table.error:.1g}"
    lines = [[*_given(curve), read, f"stribeck {version('stribeck')}"]]
    figure, (axes,) = new_figure((6.8, 4.6), lines, title=title or "Stribeck curve", ax=ax)
    _draw_friction(axes, curve, curve.values)
    hatch_law_in_doubt(axes, curve, curve.values)
    axes.set(xlabel=_abscissa_of_values(curve), ylabel=_ordinate(curve))
    if ax is None:
        add_legend(figure, (axes,))
    else:
        axes.legend(frameon=False, fontsize=8.5)
    return finish_figure(figure, path, force)


def _abscissa(curve: StribeckCurve, wanted: Abscissa) -> tuple[Array, str]:
    """Return the first panel's abscissa and its label."""
    if curve.over == "speed" and curve.contact is not None and wanted == "speed":
        return curve.values, f"{speed_words(curve.contact)} $U$ (m/s)"
    if curve.over == "speed":
        return curve.hersey_number, f"Hersey number ${RULES[curve.groups.geometry].hersey_symbol}$"
    return curve.values, _abscissa_of_values(curve)


def _ordinate(curve: StribeckCurve | AtlasCurve) -> str:
    """Return the label of the friction: below zero the substrate is dragged along, and the axis shows sizes."""
    return r"size of friction coefficient $|\mu|$" if (np.asarray(curve.friction) < 0).any() else r"friction coefficient $\mu$"


def _abscissa_of_values(curve: StribeckCurve | AtlasCurve) -> str:
    """Return the label of the coordinate."""
    if curve.contact is None:
        symbol = SYMBOLS_OF_GROUPS[curve.over]
        return f"{curve.over} group {symbol}"
    row = curve.contact.INPUTS.quantities[curve.over]
    return f"{curve.over} {row.symbol} ({DIMENSIONS[row.dimension].unit})"


def _draw_friction(axes: Axes, curve: StribeckCurve | AtlasCurve, x: Array, *, parts: bool = True) -> None:
    """Draw the sizes of friction and its parts, the regimes and the landmarks against x."""
    total, contact, viscous = map(np.abs, (np.asarray(curve.friction), curve.friction_contact, curve.friction_viscous))
    error = curve.friction_error
    make_logarithmic(axes, "x", x)
    if (total > 0).any():
        axes.set_yscale("log")
    # Through the marks too, which lie beside straight lines between few points.
    order = np.argsort(places := np.concatenate([curve.values, [mark.value for mark in curve.transitions]]), kind="stable")
    heights = np.concatenate([total, [abs(mark.friction) for mark in curve.transitions]])[order]
    axes.plot(_along(curve, x, places[order]), heights, color=INK, lw=2.2, zorder=4, label=r"friction $\mu$")
    if parts:
        axes.plot(
            x,
            contact,
            color=CONTACT,
            lw=1.5,
            ls=(0, (6, 2)),
            zorder=5,
            label="from asperities",
        )
        axes.plot(x, viscous, color=FLUID, lw=1.5, ls="-.", zorder=5, label="from the fluid")
    if len(curve) <= FEW:
        axes.plot(x, total, color=INK, ls="", marker="o", ms=3.0, zorder=4)
    if (error > 0.01 * total).any():
        axes.fill_between(x, total - error, total + error, color=INK, alpha=0.2, lw=0, zorder=3, label="estimated error")
    if (total > 0).any():
        low, high = total[total > 0].min(), total.max()
        seen = [part.max() for part in (contact, viscous) if part.max() > 1e-4 * high]
        axes.set_ylim(min([low / 10**DECADES_BELOW, *(part / 5 for part in seen)]), high * 3)
    if len(curve) > 1:
        axes.set_xlim(x.min(), x.max())
    _shade(axes, curve, x)
    for mark in curve.transitions:
        at = _along(curve, x, mark.value)
        if mark is curve.minimum:
            label = rf"minimum, $\mu$ = {mark.friction:.3g} at {_place(curve, mark.value)}"
            axes.plot(at, abs(mark.friction), "o", ms=8, color=MARK, mec="white", mew=1.2, zorder=6, label=label)
        elif "50 %" in mark.name:
            label = f"fluid carries half the load, at {_place(curve, mark.value)}"
            axes.plot(at, abs(mark.friction), "D", ms=6, color=FLUID, mec="white", mew=1.0, zorder=5, label=label)
    own = None if curve.contact is None else getattr(curve.contact, curve.over)
    if own is not None and len(curve) > 1 and curve.values.min() <= own <= curve.values.max():
        axes.axvline(
            _along(curve, x, own), color=GREY, lw=1.2, ls=(0, (1, 2)), zorder=2, label=f"this contact, at {_place(curve, own)}"
        )


def _draw_band(axes: Axes, curve: StribeckCurve, x: Array, band: Interval | None) -> None:
    """Draw what errors of the inputs leave open around the friction, and make room for it."""
    if band is not None:
        low, high = band.along(curve.values, np.abs(np.asarray(curve.friction)))
        axes.fill_between(x, low, high, color=INK, alpha=0.14, lw=0, zorder=1, label="95 % by errors of the inputs")
        axes.set_ylim(top=max(axes.get_ylim()[1], 1.2 * float(np.nanmax(high))))


def _along(curve: StribeckCurve | AtlasCurve, x: Array, values: Any) -> Any:
    """Return where values of what varies lie along an abscissa that the points of a curve have; its points exactly."""
    found = np.exp(np.interp(np.log(values), np.log(curve.values), np.log(x)))
    known = dict(zip(curve.values.tolist(), x.tolist(), strict=True))
    return np.array([known.get(float(value), at) for value, at in np.broadcast(values, found)]).reshape(np.shape(values))


def _draw_shares(axes: Axes, curve: StribeckCurve, x: Array) -> None:
    """Draw the shares of the load against x."""
    make_logarithmic(axes, "x", x)
    axes.plot(
        x,
        curve.observable("contact_load_share"),
        color=CONTACT,
        lw=1.8,
        ls=(0, (6, 2)),
        label="from asperities",
    )
    axes.plot(x, curve.observable("fluid_load_share"), color=FLUID, lw=1.8, ls="-.", label="from the fluid")
    axes.set_ylim(-0.04, 1.12)
    hatch_law_in_doubt(axes, curve, x)
    if len(curve) > 1:
        axes.set_xlim(x.min(), x.max())
    _shade(axes, curve, x)


def _shade(axes: Axes, curve: StribeckCurve | AtlasCurve, x: Array) -> None:
    """Shade the regimes and name those that have room for it."""
    whole = math.log(x.max() / x.min()) if len(x) > 1 else 0.0
    for regime, low, high in curve.regime_ranges:
        if whole == 0:
            continue
        first, last = _along(curve, x, np.array([low, high]))
        axes.axvspan(first, last, color=TINTS[regime], lw=0, zorder=0)
        share = abs(math.log(last / first)) / whole
        if share > 0.0165 * len(regime):
            axes.text(
                math.sqrt(first * last),
                0.965,
                regime,
                transform=axes.get_xaxis_transform(),
                ha="center",
                va="top",
                size=9,
                color=GREY,
                style="italic",
            )


def hatch_law_in_doubt(axes: Axes, curve: StribeckCurve | AtlasCurve, x: Array) -> None:
    """Hatch a strip along the axis where the contact law is outside its range: there the check of it is not fine."""
    outside = curve.law_in_doubt
    if outside.any():
        middles = np.sqrt(x[:-1] * x[1:])
        axes.fill_between(
            np.column_stack([np.append(x[0], middles), np.append(middles, x[-1])]).ravel(),
            0.0,
            0.035,
            where=np.repeat(outside, 2).tolist(),
            transform=axes.get_xaxis_transform(),
            facecolor="none",
            edgecolor=CONTACT,
            hatch="//////",
            lw=0.0,
            zorder=2,
            label="contact law outside its range",
        )


def _place(curve: StribeckCurve | AtlasCurve, value: float) -> str:
    if curve.contact is None:
        return f"{curve.over} group {value:.3g}"
    return si_text(value, curve.over, 3, curve.contact.INPUTS)


def _given(curve: StribeckCurve | AtlasCurve) -> list[str]:
    """Return the inputs that stay along the curve."""
    first = [*input_texts(curve.contact, None if curve.over != "speed" else "speed", curve.over)]
    if curve.contact is None:
        first += [rf"$\mu_0$ = {curve.boundary_friction:.4g}", rf"$\beta$ = {curve.beta:.4g}"]
    return first


def _caption(curve: StribeckCurve, notes: bool, verdict: str) -> tuple[list[list[str]], list[str]]:
    """Return what stands below the picture: inputs and how they were solved, and verdict and notes where they are wanted."""
    count = f"{len(curve)} points" if len(curve) == curve.requested else f"{len(curve)} of {curve.requested} points"
    law = law_text(curve.solutions[0]) if len(curve) else ""
    first = _given(curve)
    groups = curve.groups
    for name in ("speed", "load", "roughness"):
        values = np.asarray(getattr(groups, name))
        if np.ptp(values) <= 1e-12 * values[0]:
            first.append(f"{name} group {values[0]:.4g}")
    second = [
        law,
        f"viscous friction: {curve.definition}",
        f"rtol {curve.rtol:g}",
        f"estimated error {curve.error_estimate:.1e}",
        count,
        f"stribeck {version('stribeck')}",
    ]
    said = [] if curve.outcome.ok else [curve.outcome.value]
    return [first, second], [*said, *([verdict] if verdict and notes else ()), *(curve.notes if notes else ())]
