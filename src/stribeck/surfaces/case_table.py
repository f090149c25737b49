"""The table ``[surface]`` of a case file that holds the fitted roughness of a scan."""

from __future__ import annotations

import os

from stribeck.files.writing import atomic_write
from stribeck.quantities.units import InputError, show
from stribeck.surfaces.analysis import Surface
from stribeck.surfaces.several_scans import CombinedSurface

__all__ = ["surface_table", "write_surface_table"]


def write_surface_table(surface: Surface | CombinedSurface, path: str | os.PathLike[str], *, force: bool = False) -> None:
    """Write the fitted roughness as the table ``[surface]`` of a case file.

    Parameters
    ----------
    surface : Surface or CombinedSurface
        The surface, of one scan or of several.
    path : str or path-like
        File to write, ending in ``.toml``.
    force : bool
        Whether an existing file is replaced.

    Raises
    ------
    InputError
        If the file cannot be written, or exists and ``force`` is not given.
    """
    if not hasattr(surface, "fit"):
        raise InputError(f"surface = {show(surface)}; it must be a Surface, as of analyse(topography) or combine(surfaces).")
    with atomic_write(path, (".toml",), force=force) as temporary:
        temporary.write_text(surface_table(surface), encoding="utf-8")


def surface_table(surface: Surface | CombinedSurface, *, has_errors: bool = True) -> str:
    """Return the text of the table ``[surface]``, with or without errors that are propagated."""
    r, errors = surface.roughness, surface.fit.errors
    alpha, beta = surface.limits

    def line(name: str, value: str, error: str) -> str:
        return f"{f'{name} = {value}':<34}# {error}"

    def share(name: str) -> str:
        values = {"h_rms": r.h_rms, "q0": r.q0, "roll_off": r.roll_off or r.q0, "q1": r.q1, "hurst": r.hurst}
        return f"standard error {100 * errors[name] / values[name]:.2g} %" if name in errors else "end of the scan"

    height_error = f" +- {100 * errors['h_rms'] / r.h_rms:.2g} %" if has_errors else ""
    named = [(name, each.relative_error) for name, each in (("alpha", alpha), ("beta", beta))]
    rows = [
        f"# From {surface.source}: "
        f"alpha = {alpha.value:.3g} ({alpha.interval}), beta = {beta.value:.3g} ({beta.interval}), at 95 %",
        "[surface]",
        line("h_rms", f'"{r.h_rms:.6e} m{height_error}"', share("h_rms")),
        line("hurst", f"{r.hurst:.5f}", share("hurst")),
        line("q0", f'"{r.q0:.6e} 1/m"', share("q0")),
        line("roll_off", f'"{r.roll_off or r.q0:.6e} 1/m"', share("roll_off") if "roll_off" in errors else "none seen: as q0"),
        line("q1", f'"{r.q1:.6e} 1/m"', share("q1")),
        f"gamma = {surface.gamma:g}",
        *(f'{name}_error = "{100 * error:.2g} %"' for name, error in named if has_errors and error is not None),
    ]
    return "\n".join(rows) + "\n"
