"""Picture of a surface: its heights, its spectrum with the fit, and the contact law that follows."""

import math
from typing import Any

import numpy as np

from stribeck.plot import style
from stribeck.plot.style import CONTACT, FLUID, GREY, INK, MARK, Axes, Figure, new_figure, readable_unit
from stribeck.quantities.formats import format_error, format_si
from stribeck.surfaces.analysis import Surface
from stribeck.surfaces.several_scans import CombinedSurface

MAX_PIXELS = 1024  # Most points along a side of the map that is drawn


@style.picture()
def plot_surface(surface: Surface | CombinedSurface, *, ax: Axes | None = None, title: str = "", notes: bool = True) -> Figure:
    """Draw the heights of a scan, or the spectra of several, the spectrum with the fit, and the contact law.

    Parameters
    ----------
    title : str
        Headline; the name of the file, or the number of scans, by default.
    """
    if isinstance(surface, Surface):
        width, panels, headline = 14.0, [_draw_heights, _draw_spectrum, _draw_law], surface.source
    else:
        width, panels, headline = 10.0, [_draw_spectra, _draw_law], f"{len(surface.surfaces)} scans of one surface"
    footer, said, columns = [_caption(surface)], surface.notes if notes else (), len(panels)
    size = (width, 4.4)
    figure, axes = new_figure(size, footer, said, title=title or headline, columns=columns, right=0.7, between=0.42, ax=ax)
    for place, draw in zip(axes, panels, strict=False):
        draw(place, surface)
    named = [each for each in axes if each.get_legend_handles_labels()[1]]  # heights are not
    if named:
        style.add_legend(figure, named, columns=2 * columns, inside=ax)
    return figure


def _draw_heights(axes: Axes, surface: Any) -> None:
    z = surface.topography.heights
    factor, unit = readable_unit("length", max(surface.topography.size))
    height, height_unit = readable_unit("length", float(np.abs(z).max()))
    axes.set_xlabel(f"$x$ ({unit})")
    if surface.topography.is_line:
        x = np.arange(z.size) * surface.topography.spacing[0]
        axes.plot(x * factor, z * height, color=INK, lw=0.7)
        axes.set_ylabel(f"height, form removed ({height_unit})")
        axes.set_xlim(0, x[-1] * factor)
        axes.set_title("Profile", size=10, color=GREY, loc="left")
        return
    coarse = [math.ceil(n / MAX_PIXELS) for n in z.shape]
    limit = 3 * surface.rms_height * height
    image = axes.imshow(
        z[:: coarse[0], :: coarse[1]].T * height,
        extent=(0, surface.topography.size[0] * factor, 0, surface.topography.size[1] * factor),
        origin="lower",
        cmap="cividis",
        vmin=-limit,
        vmax=limit,
        interpolation="nearest",
    )
    axes.set_ylabel(f"$y$ ({unit})")
    axes.set_title(f"Height, form removed ({height_unit})", size=10, color=GREY, loc="left")
    style.figure_of(axes).colorbar(image, ax=axes, fraction=0.046, pad=0.03)


def _draw_spectra(axes: Axes, surface: Any) -> None:
    for k, measured in enumerate(each.measured for each in surface.surfaces):
        good = measured.reliable
        label = "" if k else "each scan"
        axes.plot(measured.wavenumber[good], measured.density[good], color=GREY, lw=0.6, label=label)
    _draw_spectrum(axes, surface)


def _draw_spectrum(axes: Axes, surface: Surface | CombinedSurface) -> None:
    measured, fit = surface.measured, surface.fit
    q, density = measured.wavenumber, measured.density
    good = measured.reliable
    error = density / np.sqrt(measured.modes)
    if isinstance(surface, CombinedSurface):  # what the places scatter, where several show it
        error = np.where(np.isfinite(surface.scatter), surface.scatter, error)
    shown = density > 0
    if not good.all():
        axes.plot(q[shown & ~good], density[shown & ~good], "o", ms=3, mfc="white", mec=GREY, label="not reliable")
    axes.errorbar(
        q[good],
        density[good],
        yerr=np.minimum(np.stack((error, error))[:, good], np.stack((0.95 * density, np.full_like(density, np.inf)))[:, good]),
        fmt="o",
        ms=3,
        color=INK,
        elinewidth=0.7,
        label="mean, standard error" if isinstance(surface, CombinedSurface) else "measured, standard error",
    )
    smooth = np.geomspace(surface.roughness.q0 * 1.0001, surface.roughness.q1 * 0.9999, 200)
    name = f"fit, $H$ = {surface.roughness.hurst:.2f}"
    axes.plot(smooth, fit.at(smooth, is_line=measured.is_line), color=CONTACT, lw=1.8, label=name)
    if "roll_off" in fit.found and surface.roughness.roll_off is not None:
        axes.axvline(surface.roughness.roll_off, color=MARK, lw=1.0, ls=(0, (4, 3)), label="roll-off $q_r$")
    low = 0.3 * max(float(density[shown].min()), float(density[good].min()) * 1e-3)
    axes.set(xscale="log", yscale="log", ylim=(low, 10 * float(density[good].max())), xlabel="wave number $q$ (1/m)")
    axes.set_ylabel("spectrum along the line $C_1$ (m$^3$)" if measured.is_line else "spectrum $C$ (m$^4$)")
    axes.set_title("Power spectrum", size=10, color=GREY, loc="left")


def _draw_law(axes: Axes, surface: Surface | CombinedSurface) -> None:
    law = surface.law
    height = np.linspace(0.005, 4.0, 500)
    s = law.alpha * height
    axes.plot(height, law.beta * np.exp(law.log_pressure(s)), color=CONTACT, lw=2.0, label="Persson, fitted spectrum")
    name = rf"exponential, $\alpha$ = {law.alpha:.2f}, $\beta$ = {law.beta:.3g}"
    axes.plot(height, law.beta * np.exp(-s), color=FLUID, lw=1.3, ls=style.DASHED, label=name)
    axes.set_yscale("log")
    axes.set_xlabel(r"mean separation $u/h_\mathrm{rms}$")
    axes.set_ylabel(r"contact pressure $p/E^*$")
    axes.set_xlim(0, 4)
    top = float(law.beta * np.exp(law.log_pressure(np.array([s[0]])))[0])
    axes.set_ylim(law.beta * math.exp(-4 * law.alpha) * 0.02, 4 * top)
    area = axes.twinx()
    area.plot(height, law.area_fraction(s), color=GREY, lw=1.2, ls=":", label="contact area")
    area.set_ylim(0, 1.02)
    area.set_ylabel("real / apparent contact area (dotted)", color=GREY, size=8)
    area.tick_params(colors=GREY, labelsize=8)
    axes.set_title("Contact law", size=10, color=GREY, loc="left")


def _caption(surface: Surface | CombinedSurface) -> list[str]:
    """Return what was found, for the caption."""
    r, errors, (alpha, beta) = surface.roughness, surface.fit.errors, surface.limits
    height = rf"$h_\mathrm{{rms}}$ = {format_si(r.h_rms, 'length')} $\pm$ {format_error(errors['h_rms'], 'length')}"
    law = [rf"$\alpha$ = {alpha.value:.3f} ({alpha.interval})", rf"$\beta$ = {beta.value:.3g} ({beta.interval})"]
    if not isinstance(surface, Surface):
        return [height, *law, style.program()]
    radius = surface.shape.radius
    body = "" if radius is None else f"radius of the body {format_si(radius, 'length')}"
    of_scan = [f"rms slope {r.spectrum.rms_slope:.3g}", f"window {surface.window}", f"trend {surface.shape.trend}"]
    return [height, rf"$H$ = {r.hurst:.3f} $\pm$ {errors['hurst']:.2g}", *law, body, *of_scan, style.program()]
