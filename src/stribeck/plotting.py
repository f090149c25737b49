"""Pictures of results: a Stribeck curve in both representations of the paper, and the fields of one state.

matplotlib comes with the extra ``plot`` and is imported on first use. Figures are made without pyplot, so
that they need no display and change no settings of the caller.
"""

from __future__ import annotations

import math
import re
import textwrap
from collections.abc import Sequence
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

import numpy as np

from ._types import Array
from .output import MissingExtraError, PathLike, replacing
from .parameters import QUANTITIES, LineContact
from .solution import Solution
from .units import DIMENSIONS, format_si

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from .curve_result import StribeckCurve

__all__ = ["PICTURES", "plot_curve", "plot_profile"]

PICTURES = (".png", ".svg", ".pdf")
"""Endings of the pictures."""

# Okabe and Ito's colours, which most colour-blind readers tell apart; dashes differ as well.
INK = "#1f2328"
GREY = "#6e7781"
CONTACT = "#d55e00"
FLUID = "#0072b2"
MARK = "#cc79a7"
TINTS = {"boundary": "#fbe9dd", "mixed": "#f6f3e3", "hydrodynamic": "#e2eff8"}

SYMBOLS = {
    "radius": "$R$",
    "modulus": "$E^*$",
    "load": "$F_N$",
    "viscosity": r"$\eta$",
    "speed": "$U$",
    "roughness": r"$h_\mathrm{rms}$",
    "alpha": r"$\alpha$",
    "beta": r"$\beta$",
    "friction_coefficient": r"$\mu_0$",
}

DECADES_BELOW = 1.3
"""How far below the least friction the axis goes on, so that both parts of the friction show."""

FEW = 25
"""Number of points up to which each is marked."""

LINE = 0.19
LEGEND = 0.55
"""Heights of a line of the footer and of the legend [inch]."""


def plot_curve(curve: StribeckCurve, path: PathLike | None = None, *, force: bool = False, title: str = "") -> Figure:
    """Draw a Stribeck curve.

    The first panel shows friction and its parts against the Hersey number, or against what varies where that
    is not the speed; the second shows friction against the law of the hydrodynamic branch, or the shares of
    the load where that law says nothing. Regimes are shaded, minimum and transitions marked; the footer holds
    the inputs.

    Parameters
    ----------
    curve : StribeckCurve
        The curve.
    path : str or path-like, optional
        Image to write as well, ending in ``.png``, ``.svg`` or ``.pdf``.
    force : bool
        Whether an existing file is replaced; otherwise it is kept.
    title : str
        Headline.

    Returns
    -------
    matplotlib.figure.Figure
        The figure.

    Raises
    ------
    InputError
        If the file cannot be written, or exists and ``force`` is not given.
    MissingExtraError
        If matplotlib is not installed.
    """
    by_speed = curve.over == "speed" and curve.contact is not None
    figure, (left, right) = _figure(
        (11.0, 5.0 if by_speed else 4.6),
        _curve_footer(curve),
        columns=2,
        top=1.0 if by_speed else 0.6,
        title=title or "Stribeck curve",
    )
    x, label = _abscissa(curve)
    _draw_friction(left, curve, x)
    left.set_xlabel(label)
    for axes in (left, right):
        axes.set_ylabel(r"friction coefficient $\mu$")
    if by_speed and curve.contact is not None:
        per_hersey = curve.contact.load / curve.contact.viscosity

        def speed(hersey: Any) -> Any:
            return hersey * per_hersey

        def hersey(speed: Any) -> Any:
            return speed / per_hersey

        top = left.secondary_xaxis("top", functions=(speed, hersey))
        top.set_xlabel("sliding speed $U$ (m/s)", color=GREY, fontsize=9)
        top.tick_params(colors=GREY, labelsize=8, direction="in", which="both")
    law = curve.hydrodynamic_friction
    if (law > 0).all() and curve.over != "roughness":
        _draw_friction(right, curve, law, parts=False)
        right.set_xlabel("friction coefficient by the hydrodynamic law")
        right.set_ylim(left.get_ylim())
        ends = np.array(right.get_ylim())
        right.plot(
            ends,
            ends,
            color=GREY,
            lw=1.2,
            ls=(0, (5, 3)),
            zorder=2,
            label="the law itself, $y = x$",
            scalex=False,
        )
    else:
        _draw_shares(right, curve, x)
        right.set_xlabel(label)
        right.set_ylabel("share of the load")
    _legend(figure, (left, right))
    return _finish(figure, path, force)


def plot_profile(solution: Solution, path: PathLike | None = None, *, force: bool = False, title: str = "") -> Figure:
    """Draw gap and pressures along the contact, in SI units where the solution has a contact.

    Parameters
    ----------
    solution : Solution
        The state.
    path : str or path-like, optional
        Image to write as well, ending in ``.png``, ``.svg`` or ``.pdf``.
    force : bool
        Whether an existing file is replaced; otherwise it is kept.
    title : str
        Headline.

    Returns
    -------
    matplotlib.figure.Figure
        The figure.

    Raises
    ------
    InputError
        If the file cannot be written, or exists and ``force`` is not given.
    MissingExtraError
        If matplotlib is not installed.
    """
    figure, (above, below) = _figure((7.5, 6.0), _profile_footer(solution), rows=2, title=title or "Gap and pressure")
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
        to_x = _axis(scales.half_width, "length", "position $x$")
        to_gap = _axis(scales.indentation, "length", "gap $h$", float(np.abs(fields.gap).max()))
        to_pressure = _axis(scales.pressure, "pressure", "pressure")
    above.plot(x * to_x[0], fields.gap * to_gap[0], color=INK, lw=1.8, label="gap")
    drawn = fields.gap
    alpha = 1.0 if solution.contact is None else solution.contact.alpha
    rms = alpha * float(solution.groups.relative_roughness)
    if rms > 0 and rms > 0.03 * fields.gap.min():
        drawn = np.append(drawn, rms)
        name = r"$h_\mathrm{rms}/\alpha$" if solution.contact is None else SYMBOLS["roughness"]
        above.axhline(rms * to_gap[0], color=GREY, lw=1.0, ls=(0, (5, 3)), label=f"roughness {name}")
    if fields.gap.min() > 0:
        _logarithmic(above, "y", drawn * to_gap[0])
    above.set_ylabel(to_gap[1])
    above.tick_params(labelbottom=False)
    hertz = np.sqrt(np.clip(1 - x**2, 0, None))
    curves: list[tuple[Array, dict[str, Any]]] = [
        (hertz, {"color": GREY, "lw": 1.0, "ls": (0, (2, 2)), "label": "dry smooth contact (Hertz)"}),
        (fields.pressure, {"color": INK, "lw": 1.8, "label": "total pressure"}),
        (
            fields.contact_pressure,
            {"color": CONTACT, "lw": 1.6, "ls": (0, (6, 2)), "label": "from asperities"},
        ),
        (fields.fluid_pressure, {"color": FLUID, "lw": 1.6, "ls": "-.", "label": "from the fluid"}),
    ]
    for values, style in curves:
        below.plot(x * to_x[0], values * to_pressure[0], **style)
    below.axhline(0.0, color=GREY, lw=0.6, zorder=1)
    below.set_xlabel(f"{to_x[1]}; fluid enters from the left")
    below.set_ylabel(to_pressure[1])
    for axes in (above, below):
        axes.set_xlim(x[0] * to_x[0], x[-1] * to_x[0])
    _legend(figure, (above, below), columns=3)
    return _finish(figure, path, force)


def _logarithmic(axes: Axes, which: str, values: Array) -> None:
    """Make an axis logarithmic, with plain numbers and some between the decades where these are few."""
    from matplotlib.ticker import LogLocator, MaxNLocator, NullLocator

    axes.set(**{f"{which}scale": "log"})
    axis = axes.xaxis if which == "x" else axes.yaxis
    positive = values[values > 0]
    if not positive.size or positive.max() > 300 * positive.min():
        return
    axis.set_major_formatter("{x:g}")
    axis.set_minor_formatter("{x:g}")
    if positive.max() > 10 * positive.min():
        axis.set_minor_locator(LogLocator(subs=(2.0, 5.0)))
    else:
        axis.set_major_locator(MaxNLocator(4))
        axis.set_minor_locator(NullLocator())


def _figure(
    size: tuple[float, float],
    footer: Sequence[tuple[str, str]],
    *,
    title: str,
    columns: int = 1,
    rows: int = 1,
    top: float = 0.6,
) -> tuple[Figure, list[Axes]]:
    """Return an empty figure in house style, with title and footer, and its axes."""
    try:
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure
    except ImportError:
        raise MissingExtraError("a picture", "plot", "matplotlib") from None
    width, height = size
    height += LINE * len(footer) + LEGEND
    figure = Figure(figsize=(width, height), dpi=150, facecolor="white")
    FigureCanvasAgg(figure)
    low = (LINE * len(footer) + LEGEND + 0.72) / height
    high = 1 - top / height
    grid = figure.add_gridspec(
        rows, columns, left=0.8 / width, right=1 - 0.25 / width, bottom=low, top=high, wspace=0.2, hspace=0.08
    )
    axes = [figure.add_subplot(grid[i, j]) for i in range(rows) for j in range(columns)]
    for ax in axes:
        for side in ax.spines.values():
            side.set(color=GREY, linewidth=0.8)
        ax.tick_params(which="both", direction="in", top=True, right=True, colors=INK, labelsize=9)
        ax.xaxis.label.set(color=INK, size=10.5)
        ax.yaxis.label.set(color=INK, size=10.5)
    headline = textwrap.shorten(title, int(7.3 * width), placeholder=" …")
    place = 0.8 / width, 1 - 0.16 / height
    figure.text(*place, headline, size=14, weight="bold", color=INK, va="top", parse_math=False)
    for i, (line, colour) in enumerate(reversed(footer)):
        figure.text(0.8 / width, (0.14 + LINE * i) / height, line, size=8, color=colour, va="bottom")
    return figure, axes


def _legend(figure: Figure, axes: Sequence[Axes], columns: int = 4) -> None:
    """Put one legend for all axes under them, where it covers nothing."""
    found: dict[str, Any] = {}
    for ax in axes:
        for handle, label in zip(*ax.get_legend_handles_labels(), strict=True):
            found.setdefault(label, handle)
    bottom = axes[-1].get_position().y0 - 0.52 / figure.get_figheight()
    figure.legend(
        list(found.values()),
        list(found),
        loc="upper left",
        bbox_to_anchor=(0.7 / figure.get_figwidth(), bottom),
        ncols=columns,
        frameon=False,
        fontsize=8.5,
        labelcolor=INK,
        handlelength=2.6,
        columnspacing=2.0,
    )


def _finish(figure: Figure, path: PathLike | None, force: bool) -> Figure:
    """Write the figure where wanted, and return it."""
    if path is not None:
        with replacing(path, PICTURES, force=force) as temporary:
            figure.savefig(temporary)
    return figure


def _abscissa(curve: StribeckCurve) -> tuple[Array, str]:
    """Return the first panel's abscissa and its label."""
    if curve.over == "speed":
        return curve.hersey_number, r"Hersey number $\eta U/F_N$"
    if curve.contact is None:
        symbol = {"load": r"$F_N/(\pi\beta^2 R E^*)$", "roughness": r"$h_\mathrm{rms}/(4\alpha\beta^2 R)$"}[curve.over]
        return curve.values, f"{curve.over} group {symbol}"
    unit = DIMENSIONS[QUANTITIES[curve.over].dimension].unit
    return curve.values, f"{curve.over} {SYMBOLS[curve.over]} ({unit})"


def _draw_friction(axes: Axes, curve: StribeckCurve, x: Array, *, parts: bool = True) -> None:
    """Draw friction, its parts, the regimes and the landmarks against x."""
    total, error = curve.friction, curve.friction_error
    style: dict[str, Any] = {"marker": "o", "ms": 3.0} if len(curve) <= FEW else {}
    _logarithmic(axes, "x", x)
    if (total > 0).any():
        axes.set_yscale("log")
    axes.plot(x, total, color=INK, lw=2.2, zorder=4, label=r"friction $\mu$", **style)
    if parts:
        axes.plot(
            x,
            curve.friction_contact,
            color=CONTACT,
            lw=1.5,
            ls=(0, (6, 2)),
            zorder=5,
            label="from asperities",
        )
        axes.plot(x, curve.friction_viscous, color=FLUID, lw=1.5, ls="-.", zorder=5, label="from the fluid")
    if (error > 0.01 * total).any():
        axes.fill_between(x, total - error, total + error, color=INK, alpha=0.2, lw=0, zorder=3, label="its error")
    if (total > 0).any():
        low, high = total[total > 0].min(), total.max()
        seen = [part.max() for part in (curve.friction_contact, curve.friction_viscous) if part.max() > 1e-4 * high]
        axes.set_ylim(min([low / 10**DECADES_BELOW, *(part / 5 for part in seen)]), high * 3)
    if len(curve) > 1:
        axes.set_xlim(x.min(), x.max())
    _shade(axes, curve, x)
    for mark in curve.transitions:
        at = np.exp(np.interp(math.log(mark.value), np.log(curve.values), np.log(x)))
        if mark is curve.minimum:
            label = rf"minimum, $\mu$ = {mark.friction:.3g} at {_place(curve, mark.value)}"
            axes.plot(at, mark.friction, "o", ms=8, color=MARK, mec="white", mew=1.2, zorder=6, label=label)
        elif "50%" in mark.name:
            label = f"fluid carries half the load, at {_place(curve, mark.value)}"
            axes.plot(at, mark.friction, "D", ms=6, color=FLUID, mec="white", mew=1.0, zorder=5, label=label)
    _strip(axes, curve, x)


def _draw_shares(axes: Axes, curve: StribeckCurve, x: Array) -> None:
    """Draw the shares of the load against x."""
    _logarithmic(axes, "x", x)
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
    if len(curve) > 1:
        axes.set_xlim(x.min(), x.max())
    _shade(axes, curve, x)


def _shade(axes: Axes, curve: StribeckCurve, x: Array) -> None:
    """Shade the regimes and name those that have room for it."""
    whole = math.log(x.max() / x.min()) if len(x) > 1 else 0.0
    for regime, low, high in curve.regime_ranges:
        if whole == 0:
            continue
        first, last = np.exp(np.interp(np.log([low, high]), np.log(curve.values), np.log(x)))
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


def _strip(axes: Axes, curve: StribeckCurve, x: Array) -> None:
    """Hatch a strip along the axis where the contact law is outside its range."""
    outside = np.array([any("outside its range" in note for note in s.notes) for s in curve.solutions])
    if outside.any():
        axes.fill_between(
            x,
            0.0,
            0.035,
            where=outside.tolist(),
            transform=axes.get_xaxis_transform(),
            facecolor="none",
            edgecolor=CONTACT,
            hatch="//////",
            lw=0.0,
            zorder=2,
            label="contact law outside its range",
        )


def _place(curve: StribeckCurve, value: float) -> str:
    if curve.contact is None:
        return f"{curve.over} group {value:.3g}"
    return _si(value, curve.over, 3)


def _si(value: float, name: str, digits: int) -> str:
    return format_si(value, QUANTITIES[name].dimension, digits).replace("*", "·")


def _curve_footer(curve: StribeckCurve) -> list[tuple[str, str]]:
    count = f"{len(curve)} points" if len(curve) == curve.requested else f"{len(curve)} of {curve.requested} points"
    law = _law(curve.solutions[0]) if len(curve) else ""
    first = [*_inputs(curve.contact, None if curve.over != "speed" else "speed", curve.over)]
    if curve.contact is None:
        first += [rf"$\mu_0$ = {curve.mu0:.4g}", rf"$\beta$ = {curve.beta:.4g}"]
    groups = curve.groups
    for name in ("speed", "load", "roughness"):
        values = np.asarray(getattr(groups, name))
        if np.ptp(values) <= 1e-12 * values[0]:
            first.append(f"{name} group {values[0]:.4g}")
    second = [
        law,
        f"viscous friction: definition {curve.definition}",
        f"rtol {curve.rtol:g}",
        f"estimated error {curve.error_estimate:.1e}",
        count,
        f"stribeck {version('stribeck')}",
    ]
    notes = list(curve.notes) if curve.outcome.ok else [curve.outcome.value, *curve.notes]
    return _lines([first, second], notes, 172)


def _profile_footer(solution: Solution) -> list[tuple[str, str]]:
    groups = [f"{name} group {float(getattr(solution.groups, name)):.4g}" for name in ("speed", "load", "roughness")]
    second = [
        _law(solution),
        f"rtol {solution.rtol:g}",
        f"estimated error {solution.error_estimate:.1e}",
        f"stribeck {version('stribeck')}",
    ]
    notes = list(solution.notes) if solution.outcome.ok else [solution.outcome.value, *solution.notes]
    return _lines([[*_inputs(solution.contact), *groups], second], notes, 112)


def _law(solution: Solution) -> str:
    """Return name and parameters of the contact law."""
    if solution.law in ("dry contact", "smooth"):
        return solution.law
    numbers = ", ".join(
        f"{name.replace('_', ' ')} {value if isinstance(value, str) else f'{value:.4g}'}"
        for name, value in solution.law_parameters.items()
    )
    return f"{solution.law} contact law" + (f" ({numbers})" if numbers else "")


def _inputs(contact: LineContact | None, *without: str | None) -> list[str]:
    """Return the inputs of a contact in words, but for those that vary."""
    if contact is None:
        return []
    return [f"{symbol} = {_si(getattr(contact, name), name, 4)}" for name, symbol in SYMBOLS.items() if name not in without]


def _lines(parts: Sequence[Sequence[str]], notes: Sequence[str], width: int) -> list[tuple[str, str]]:
    """Return lines of text with their colours, none longer than ``width``."""
    lines: list[tuple[str, str]] = []
    for part in parts:
        line = ""
        for item in filter(None, part):
            if line and len(_plain(line)) + len(_plain(item)) + 2 > width:
                lines.append((line + ",", GREY))
                line = ""
            line += f", {item}" if line else item
        if line:
            lines.append((line, GREY))
    return lines + [(line, CONTACT) for note in notes for line in textwrap.wrap(note, width)]


def _plain(text: str) -> str:
    """Return text without the signs of mathematical typesetting, to count its letters."""
    return re.sub(r"\\mathrm|\\(alpha|beta|eta|mu|pi)|[$_{}^\\]", "x", text).replace("xx", "x")


def _positions(solution: Solution) -> Array:
    """Return positions to draw at [a], denser where the nodes are, as far as the pressure reaches."""
    pressure = np.abs(solution.contact_pressure) + np.abs(solution.fluid_pressure)
    reach = 1.25 * float(np.abs(solution.x[pressure > 0.02 * pressure.max()]).max(initial=0.0))
    reach = max(1.6, reach)
    nodes = solution.x[np.abs(solution.x) < reach]
    return np.unique(np.concatenate([np.linspace(-reach, reach, 801), nodes]))


def _axis(scale: float, dimension: str, name: str, largest: float = 1.0) -> tuple[float, str]:
    """Return the factor from Hertz units to a unit with readable numbers, and the label with that unit."""
    unit = format_si(scale * largest, dimension).rpartition(" ")[2]
    power = next(power for power, known in DIMENSIONS[dimension].steps.items() if known == unit)
    return scale / 10.0**power, f"{name} ({unit})"
