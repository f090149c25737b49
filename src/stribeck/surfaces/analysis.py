r"""From a measured topography to the roughness of a case: rms height, spectrum, alpha, beta and the whole contact law.

    read_topography -> repaired -> detrended -> power_spectrum -> fit_self_affine -> exponential_limit, persson_law

:func:`analyse` does all of it and keeps what was found on the way.  How well is in docs/surfaces.md.
"""

from __future__ import annotations

import math
import os
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from stribeck.contact_laws.persson import GAMMA, PerssonLaw, exponential_limit, persson_law
from stribeck.contact_laws.spectrum import SelfAffine, Spectrum
from stribeck.files.writing import replacing
from stribeck.quantities.units import InputError, format_si, show, to_si
from stribeck.surfaces.detrend import Shape, Trend, detrended
from stribeck.surfaces.measured_spectrum import MeasuredSpectrum, Window, power_spectrum
from stribeck.surfaces.self_affine_fit import MISFIT, SelfAffineFit, fit_self_affine
from stribeck.surfaces.topography import Topography

__all__ = ["Surface", "analyse", "write_surface_table"]

APART = 1.3
"""Ratio of the rms heights of scan and fit from which a note says that they differ."""


@dataclass(frozen=True, eq=False)
class Surface:
    """What a scan says of a surface.

    Attributes
    ----------
    topography : Topography
        Roughness that was evaluated: filled, and without its trend.
    shape : Shape
        The trend, with the radius of the body.
    measured : MeasuredSpectrum
        Spectrum of the scan.
    fit : SelfAffineFit
        Self-affine spectrum through it.
    gamma : float
        Reduction of the elastic energy in Persson's theory [-].
    window : {"hann", "none"}
        Window of the spectrum.
    notes : tuple of str
        What must be known before the numbers are used.
    """

    topography: Topography
    shape: Shape
    measured: MeasuredSpectrum
    fit: SelfAffineFit
    gamma: float
    window: Window = "hann"
    notes: tuple[str, ...] = field(default=())

    @property
    def rms_height(self) -> float:
        """Root mean square of the heights of the scan about their trend [m]."""
        return float(np.sqrt(np.mean(self.topography.heights**2)))

    @property
    def roughness(self) -> SelfAffine:
        """The fitted spectrum."""
        return self.fit.roughness

    @cached_property
    def spectrum(self) -> Spectrum:
        """The measured spectrum of the surface, with the fit where longer waves are not reliable.

        A line gives it by the ratio of the two spectra of the fit at each wave number, which is right where the fit is.
        """
        r, line = self.roughness, self.measured.is_line
        seen = self.measured.reliable & np.asarray(self.measured.density > 0)
        q = self.measured.wavenumber[seen]
        inside = (q >= r.q0) & (q <= r.q1)
        q, density = q[inside], self.measured.density[seen][inside] - self.fit.noise
        model = self.fit.at(q, is_line=line, noise=False)
        density = np.maximum(density, 0.01 * model) * (r.spectrum.at(q) / model)
        first = r.q0 * (1 + 1e-9)
        if q[0] > first:
            longer = np.unique([r.q0, min(max(r.roll_off or r.q0, first), q[0] / (1 + 1e-9))])
            q, density = np.concatenate((longer, q)), np.concatenate((r.spectrum.at(longer), density))
        return Spectrum(q, density)

    @cached_property
    def law(self) -> PerssonLaw:
        """Persson's contact law of the fitted spectrum, tabulated on first use."""
        return persson_law(self.roughness, self.gamma)

    def to_dict(self) -> dict[str, Any]:
        """Return every number under its name, in SI units.

        Returns
        -------
        dict
            Numbers, None where nothing was found, and text.
        """
        r, errors = self.roughness, self.fit.errors
        alpha, alpha_error, beta, beta_error = self.fit.exponential_limit(self.gamma)
        band = exponential_limit(self.spectrum, self.gamma)
        spectrum = r.spectrum
        return {
            "source": self.topography.source,
            "points": list(self.topography.heights.shape),
            "spacing": list(self.topography.spacing),
            "size": list(self.topography.size),
            "trend": self.shape.trend,
            "tilt": list(self.shape.tilt),
            "body_radius": self.shape.radius,
            "body_radius_error": self.shape.radius_error(r, self.topography),
            "body_curvatures": list(self.shape.curvatures),
            "scan_rms_height": self.rms_height,
            "h_rms": r.h_rms,
            "h_rms_error": errors["h_rms"],
            "hurst": r.hurst,
            "hurst_error": errors["hurst"],
            "q0": r.q0,
            "q0_error": errors.get("q0"),
            "roll_off": r.roll_off,
            "roll_off_error": errors.get("roll_off"),
            "q1": r.q1,
            "q1_error": errors.get("q1"),
            "found": list(self.fit.found),
            "deviance": float(self.fit.deviance),
            "noise_density": self.fit.noise,
            "rms_slope": spectrum.rms_slope,
            "rms_curvature": spectrum.rms_curvature,
            "alpha": alpha,
            "alpha_error": alpha_error,
            "beta": beta,
            "beta_error": beta_error,
            "gamma": self.gamma,
            "measured_alpha": band[0],
            "measured_beta": band[1],
            "measured_rms_height": self.spectrum.rms_height,
            "reliable_wavenumbers": [self.measured.lowest, self.measured.highest],
            "reliable_reasons": [self.measured.lowest_reason, self.measured.highest_reason],
            "window": self.window,
            "notes": list(self.notes),
        }


def analyse(
    topography: Topography,
    *,
    trend: Trend = "curvature",
    window: Window = "hann",
    resolution: str | float | None = None,
    gamma: float = GAMMA,
    keep_spikes: bool = False,
) -> Surface:
    """Return what a scan says of a surface.

    Parameters
    ----------
    topography : Topography
        Measured heights, as of :func:`read_topography`.
    trend : {"none", "mean", "tilt", "curvature"}
        Shape of the body that is taken away.
    window : {"hann", "none"}
        Window of the spectrum; ``"none"`` is for periodic heights.
    resolution : str or float, optional
        Shortest wavelength that the instrument resolves [m]; that of the file, or four points, by default.
    gamma : float
        Reduction of the elastic energy in Persson's theory [-].
    keep_spikes : bool
        Whether points far off all their neighbours are kept as roughness.

    Returns
    -------
    Surface
        Numbers with errors, spectrum, fit and contact law.

    Raises
    ------
    InputError
        Where an argument is impossible or the scan too poor for a spectrum.
    """
    gamma = to_si(gamma, "number", "gamma")
    if not 0 < gamma <= 1:
        raise InputError(f"gamma = {gamma:g} must be above 0 and at most 1; 0.45 fits simulations.")
    shortest = None
    if resolution is not None:
        shortest = to_si(resolution, "length", "resolution")
        if shortest <= 0:
            raise InputError(
                f"resolution = {show(resolution)} is not above zero; give the shortest wavelength that is resolved."
            )
    whole = topography.repaired(keep_spikes=keep_spikes)
    flat, shape = detrended(whole, trend)
    measured = power_spectrum(flat, window, resolution=shortest)
    fit = fit_self_affine(measured)
    return Surface(flat, shape, measured, fit, gamma, window, (*flat.notes, *_notes(flat, shape, measured, fit)))


def write_surface_table(surface: Surface, path: str | os.PathLike[str], *, force: bool = False) -> None:
    """Write the fitted roughness as the table ``[surface]`` of a case file.

    Parameters
    ----------
    surface : Surface
        The surface.
    path : str or path-like
        File to write, ending in ``.toml``.
    force : bool
        Whether an existing file is replaced.

    Raises
    ------
    InputError
        If the file cannot be written, or exists and ``force`` is not given.
    """
    with replacing(path, (".toml",), force=force) as temporary:
        temporary.write_text(surface_table(surface), encoding="utf-8")


def surface_table(surface: Surface) -> str:
    """Return the text of the table ``[surface]``."""
    r, errors = surface.roughness, surface.fit.errors
    alpha, alpha_error, beta, beta_error = surface.fit.exponential_limit(surface.gamma)

    def line(name: str, value: str, error: str) -> str:
        return f"{f'{name} = {value}':<34}# {error}"

    def share(name: str) -> str:
        values = {"h_rms": r.h_rms, "q0": r.q0, "roll_off": r.roll_off or r.q0, "q1": r.q1, "hurst": r.hurst}
        return f"standard error {100 * errors[name] / values[name]:.2g} %" if name in errors else "end of the scan"

    rows = [
        f"# From {surface.topography.source or 'heights in memory'}: alpha = {alpha:.3g} +- {alpha_error:.1g}, "
        f"beta = {beta:.3g} +- {beta_error:.1g}",
        "[surface]",
        line("h_rms", f'"{r.h_rms:.6e} m"', share("h_rms")),
        line("hurst", f"{r.hurst:.5f}", share("hurst")),
        line("q0", f'"{r.q0:.6e} 1/m"', share("q0")),
        line("roll_off", f'"{r.roll_off or r.q0:.6e} 1/m"', share("roll_off") if "roll_off" in errors else "none seen: as q0"),
        line("q1", f'"{r.q1:.6e} 1/m"', share("q1")),
        f"gamma = {surface.gamma:g}",
    ]
    return "\n".join(rows) + "\n"


def _notes(topography: Topography, body: Shape, measured: MeasuredSpectrum, fit: SelfAffineFit) -> list[str]:
    notes = []
    if "roll_off" not in fit.found and "q0" not in fit.found:
        notes.append(
            "No roll-off within the scan: h_rms, alpha and beta are those of wavelengths up to "
            f"{format_si(2 * math.pi / fit.roughness.q0, 'length')}, and h_rms and beta hang on it; a larger scan would tell."
        )
    if "q1" not in fit.found:
        notes.append(
            f"The spectrum goes on beyond {format_si(2 * math.pi / measured.highest, 'length')} ({measured.highest_reason}): "
            "slope, curvature and contact area would grow with finer steps, alpha and beta hardly."
        )
    if "noise" in fit.found:
        notes.append("The spectrum flattens at short wavelengths as by noise of the instrument, which was taken away.")
    if fit.deviance > MISFIT:
        notes.append(
            f"The spectrum is not self-affine: its deviance is {fit.deviance:.1f} times that of chance, and the errors were "
            "widened by the root of it; compare alpha and beta with those of the measured spectrum."
        )
    H = fit.roughness.hurst
    if not 0.02 < H < 0.999:
        shape_of = "flatter" if H < 0.5 else "steeper"
        notes.append(
            f"The Hurst exponent is at the end of its range: the spectrum is {shape_of} than that of self-affine roughness."
        )
    scan, fitted = float(np.sqrt(np.mean(topography.heights**2))), fit.roughness.h_rms
    if not 1 / APART < fitted / scan < APART:
        notes.append(
            f"The rms height of the scan is {format_si(scan, 'length')}, that of the fit {format_si(fitted, 'length')}: "
            "noise, waves too long for the fit, or a spectrum of another shape make the difference."
        )
    if not topography.is_line:
        ratio = max(topography.spacing) / min(topography.spacing)
        if ratio > 2:
            notes.append(f"Steps along the two axes differ {ratio:.1f} times; the larger one limits the short wavelengths.")
    radius = body.radius
    if radius is not None:
        error = body.radius_error(fit.roughness, topography)
        if error is not None and error > 0.5 * radius:
            notes.append("The curvature of the body is within what the roughness makes by chance: the scan is flat.")
    return notes
