r"""From a measured topography to the roughness of a case: rms height, spectrum, alpha, beta and the whole contact law.

    read_topography -> repaired -> detrended -> power_spectrum -> fit_self_affine -> exponential_limit, persson_law

:func:`analyse` does all of it and keeps what was found on the way.  How well is in docs/surfaces.md.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from stribeck.contact_laws.persson import GAMMA, PerssonLaw, check_gamma, exponential_limit, persson_law
from stribeck.contact_laws.spectrum import SelfAffine, Spectrum
from stribeck.files.results import Drawn
from stribeck.quantities.lazy import cached_property
from stribeck.quantities.results import Shown
from stribeck.quantities.units import InputError, show, to_si
from stribeck.surfaces.departures import Departures, departure_notes, departures
from stribeck.surfaces.detrend import Form, Trend, detrended
from stribeck.surfaces.fit_result import SelfAffineFit
from stribeck.surfaces.measured_spectrum import MeasuredSpectrum, Window, power_spectrum
from stribeck.surfaces.notes import fit_notes, spike_notes
from stribeck.surfaces.self_affine_fit import fit_self_affine
from stribeck.surfaces.topography import Topography

__all__ = ["Surface", "analyse"]


@dataclass(frozen=True, eq=False, repr=False)
class Surface(Drawn, Shown):
    """What a scan says of a surface.

    Attributes
    ----------
    topography : Topography
        Roughness that was evaluated: filled, and without its trend.
    shape : Form
        The trend, with the radius of the body.
    measured : MeasuredSpectrum
        Spectrum of the scan.
    fit : SelfAffineFit
        Self-affine spectrum through it.
    gamma : float
        Reduction of the elastic energy in Persson's theory [-].
    departures : Departures
        Texture and skewness, which Persson's theory takes as none.
    spikes : int
        Number of spikes that were replaced.
    height_with_spikes : float
        Rms height of the scan with its spikes [m].
    window : {"hann", "none"}
        Window of the spectrum.
    notes : tuple of str
        What must be known before the numbers are used.
    """

    _picture = "stribeck.plot.surface.plot_surface"

    topography: Topography
    shape: Form
    measured: MeasuredSpectrum
    fit: SelfAffineFit
    gamma: float
    departures: Departures
    spikes: int
    height_with_spikes: float
    window: Window = "hann"
    notes: tuple[str, ...] = field(default=())

    @property
    def rms_height(self) -> float:
        """Root mean square of the heights of the scan about their trend [m]."""
        return _rms(self.topography)

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
        alpha, beta = self.fit.exponential_limit(self.gamma)
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
            "scan_rms_height_with_spikes": self.height_with_spikes,
            "spikes": self.spikes,
            "skewness": self.departures.skewness,
            "skewness_error": self.departures.skewness_error,
            "aspect_ratio": self.departures.aspect_ratio,
            "texture_direction": self.departures.direction,
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
            "alpha": alpha.value,
            "alpha_interval": [alpha.low, alpha.high],
            "beta": beta.value,
            "beta_interval": [beta.low, beta.high],
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
        Whether spikes, single points far above or below all neighbours, are kept as roughness.

    Returns
    -------
    Surface
        Numbers with errors, spectrum, fit and contact law.

    Raises
    ------
    InputError
        Where an argument is impossible or the scan too poor for a spectrum.
    """
    if not isinstance(topography, Topography):
        raise InputError(f"topography = {show(topography)}; it must be a Topography, as of read_topography(path).")
    gamma = check_gamma(gamma)
    shortest = None
    if resolution is not None:
        shortest = to_si(resolution, "length", "resolution", "1 um")
        if shortest <= 0:
            raise InputError(
                f"resolution = {show(resolution)} is not above zero; give the shortest wavelength that is resolved."
            )
    kept = topography.repaired(keep_spikes=True)
    whole = kept if keep_spikes else topography.repaired()
    flat, shape = detrended(whole, trend)
    measured = power_spectrum(flat, window, resolution=shortest)
    fit = fit_self_affine(measured)
    spikes = int(np.sum(whole.heights != kept.heights))
    spiked = _rms(detrended(kept, trend)[0] if spikes else flat)
    found = departures(flat, measured, fit.roughness.hurst)
    notes = (
        *flat.notes,
        *spike_notes(spikes, _rms(flat), spiked),
        *departure_notes(flat, found),
        *fit_notes(flat, shape, measured, fit),
    )
    return Surface(flat, shape, measured, fit, gamma, found, spikes, spiked, window, notes)


def _rms(topography: Topography) -> float:
    return float(np.sqrt(np.mean(topography.heights**2)))
