"""What a scan says of a surface, in words; the JSON is :meth:`Surface.to_dict`."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from stribeck.cli.exits import say
from stribeck.plot.surface import error_text
from stribeck.quantities.formats import format_si
from stribeck.surfaces.analysis import Surface

if TYPE_CHECKING:
    from rich.console import Console

__all__ = ["print_surface"]


def print_surface(console: Console, surface: Surface, written: Sequence[str] = ()) -> None:
    """Print the numbers of a surface with their errors, and what must be known about them."""
    for line in [*surface_lines(surface), *(f"Written: {name}" for name in written)]:
        say(console, line)


def surface_lines(surface: Surface) -> list[str]:
    """Return the lines that are printed."""
    found, scan = surface.to_dict(), surface.topography
    kind = "line" if scan.is_line else "map"
    points = " x ".join(map(str, scan.heights.shape))
    size = " x ".join(format_si(length, "length") for length in scan.size)
    lines = [
        f"{scan.source or 'Heights'}: {kind} of {points} points, {size}",
        "",
        _row("tilt removed", ", ".join(f"{1e3 * slope:.3g} mrad" for slope in surface.shape.tilt) or "none", ""),
    ]
    if found["body_radius"] is not None:
        bulge = "convex" if surface.shape.curvatures[0] < 0 else "concave"
        lines.append(_length("radius of the body", found["body_radius"], found["body_radius_error"], bulge))
    lines.append(_length("rms height of the scan", found["scan_rms_height"], None, "about that form"))
    if surface.spikes:
        number = f"{surface.spikes} spike{'s' * (surface.spikes > 1)}"
        lines.append(_length(f"  with its {number}", found["scan_rms_height_with_spikes"], None, "replaced above"))
    lines.append(
        _row("skewness of the heights", f"{found['skewness']:.2f}", f"+- {found['skewness_error']:.2g}, 0 if Gaussian")
    )
    ratio, direction = found["aspect_ratio"], found["texture_direction"]
    if ratio is not None:
        at = (
            "no preferred direction"
            if direction is None
            else f"longer at {math.degrees(direction):.0f} degrees to the first axis"
        )
        lines.append(_row("aspect ratio of features", f"{ratio:.3g}", at))
    lines += ["", "Self-affine spectrum through it"]
    r = surface.roughness
    lines.append(_length("rms height h_rms", r.h_rms, found["h_rms_error"], ""))
    lines.append(_row("Hurst exponent", f"{r.hurst:.3f}", f"+- {found['hurst_error']:.2g}"))
    for name, label, end in (
        ("q0", "longest wavelength 2 pi/q0", "limited by the scan, not the surface"),
        ("roll_off", "roll-off wavelength", "none seen"),
        ("q1", "shortest wavelength 2 pi/q1", "limited by the reliable range, not the surface"),
    ):
        q, error = found[name], found[f"{name}_error"]
        if name == "roll_off" and error is None:
            lines.append(_row(label, "none seen", ""))
            continue
        lines.append(
            _length(
                label, 2 * math.pi / q, None if error is None else 2 * math.pi / q * error / q, end if error is None else ""
            )
        )
    alpha, beta = surface.fit.exponential_limit(surface.gamma)
    lines += [
        _row("rms slope", f"{found['rms_slope']:.3g}", "grows with q1"),
        _row("rms curvature", format_si(found["rms_curvature"], "wavenumber"), "grows with q1"),
        "",
        f"Contact law by Persson's theory, gamma = {surface.gamma:g}",
        _row(
            "alpha",
            f"{alpha.value:.3f}",
            f"{alpha.interval} (95 %); {found['measured_alpha']:.3f} from the measured spectrum",
        ),
        _row(
            "beta",
            f"{beta.value:.4g}",
            f"{beta.interval} (95 %); {found['measured_beta']:.4g} from the measured spectrum",
        ),
    ]
    return [*lines, *([""] if surface.notes else []), *surface.notes]


def _row(label: str, value: str, remark: str) -> str:
    return f"  {label:<30}{value:<14}{remark}".rstrip()


def _length(label: str, value: float, error: float | None, remark: str) -> str:
    parts = [f"+- {error_text(error)}" if error is not None else "", remark]
    return _row(label, format_si(value, "length"), ", ".join(filter(None, parts)))
