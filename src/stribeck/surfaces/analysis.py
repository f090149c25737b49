"""From a measured topography to the roughness of a case: rms height, spectrum, alpha, beta and the whole contact law.

Each step is a function of its own: read, repair, detrend, spectrum, fit, contact law.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field
from typing import Annotated, Any

import numpy as np

from stribeck._types import Array
from stribeck.contact_laws.persson import GAMMA, GAMMA_INPUT, PerssonLaw, exponential_limit, persson_law
from stribeck.contact_laws.spectrum import SelfAffine, Spectrum
from stribeck.files.datasets import number_columns, units_of
from stribeck.files.results import Exported, Labelled
from stribeck.quantities.formats import Number, format_percent, format_si, plain_numbers
from stribeck.quantities.lazy import cached_property
from stribeck.quantities.results import Card, Told
from stribeck.quantities.units import InputError, show, to_si
from stribeck.surfaces.departures import Departures, departure_notes, departures, height_numbers
from stribeck.surfaces.detrend import Form, Trend, detrended
from stribeck.surfaces.measured_spectrum import MeasuredSpectrum, Window, power_spectrum
from stribeck.surfaces.self_affine_fit import MAX_DEVIANCE_RATIO, Estimate, SelfAffineFit, fit_self_affine
from stribeck.surfaces.topography import Topography

# Ends of a self-affine spectrum, as lengths of waves.
WAVES = {"q0": "longest wavelength", "roll_off": "roll-off wavelength", "q1": "shortest wavelength"}

HEIGHT_RATIO_NOTE = 1.3  # Ratio of the rms heights of scan and fit from which a note says that they differ

REPAIR_NOTE = 0.05  # Relative change of the rms height of the scan by the repair of spikes from which a note warns


class FittedSurface(Exported, Told):
    """What one scan says of a surface, or several together."""

    _picture = "stribeck.plot.surface.plot_surface"

    fit: SelfAffineFit
    gamma: float
    limits: Any  # The numbers alpha and beta of the contact law with their 95 % intervals

    @property
    def roughness(self) -> SelfAffine:
        """The fitted spectrum."""
        return self.fit.roughness

    @cached_property
    def law(self) -> PerssonLaw:
        """Persson's contact law of the fitted spectrum, tabulated on first use."""
        return persson_law(self.roughness, self.gamma)

    @property
    def _of_law(self) -> tuple[Number, Number, Number]:
        """The numbers of the contact law."""
        words = {"alpha": "decay of the contact law, alpha", "beta": "scale of the contact law, beta"}
        alpha, beta = (
            Number(name, f"{name} by Persson's theory", meaning, found.value, interval=(found.low, found.high))
            for (name, meaning), found in zip(words.items(), self.limits, strict=True)
        )
        gamma = "reduction of the elastic energy in Persson's theory"
        return alpha, beta, Number("gamma", "gamma of that theory", gamma, self.gamma, 0.0)


@dataclass(frozen=True, eq=False, repr=False)
class Surface(FittedSurface):
    """What a scan says of a surface; its dataset has its numbers in SI units, each with its error or interval."""

    topography: Annotated[Topography, "roughness that was evaluated: filled, and without its trend"]
    shape: Annotated[Form, "the trend, with the radius of the body"]
    measured: Annotated[MeasuredSpectrum, "spectrum of the scan"]
    fit: Annotated[SelfAffineFit, "self-affine spectrum through it"]
    gamma: Annotated[float, "reduction of the elastic energy in Persson's theory", "1"]
    departures: Annotated[Departures, "texture and skewness, which Persson's theory takes as none"]
    spikes: Annotated[int, "number of spikes that were replaced"]
    height_with_spikes: Annotated[float, "rms height of the scan with its spikes", "m"]
    window: Annotated[Window, "window of the spectrum"] = "hann"
    notes: Annotated[tuple[str, ...], "what must be known before the numbers are used"] = field(default=())

    @property
    def rms_height(self) -> float:
        """Root mean square of the heights of the scan about their trend, and about their mean where none is taken away [m]."""
        return _rms(self.topography)

    @property
    def source(self) -> str:
        """Where the heights come from."""
        return self.topography.source

    @cached_property
    def limits(self) -> tuple[Estimate, Estimate]:
        """The numbers alpha and beta of the contact law with their 95 % intervals."""
        return self.fit.exponential_limit(self.gamma)

    @cached_property
    def spectrum(self) -> Spectrum:
        """The measured spectrum of the surface; where longer waves are not reliable, and of a line, by that of the fit."""
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
    def numbers(self) -> tuple[Number, ...]:
        """Every number of the surface with its unit, meaning and error, in the order of reports."""
        r, fitted, spectrum = self.roughness, self.fit.errors, self.roughness.spectrum
        texture, spikes, letter = self.departures, self.spikes, "R" if self.topography.is_line else "S"
        radius, radius_error = self.shape.radius, self.shape.radius_error(r, self.topography)
        convex = "convex" if self.shape.curvatures and self.shape.curvatures[0] < 0 else "concave"
        alpha, beta, gamma = self._of_law
        measured = exponential_limit(self.spectrum, self.gamma)
        with_spikes = f"rms height with {spikes} spike{'s' * (spikes > 1)}" if spikes else ""
        seen = [name for name in WAVES if name != "roll_off" or name in self.fit.found]
        lengths = [(name, getattr(r, name) if name in seen else None, fitted.get(name)) for name in WAVES]
        body = f"radius of the {convex} body" if radius else ""
        density = "m3" if self.measured.is_line else "m4"
        wider = "angle to the first axis of the direction in which features are longer"
        return (
            _length("body_radius", body, "radius of the body", radius, radius_error),
            _length("scan_rms_height", f"rms height {letter}q of the scan", "rms height of the scan about its trend",
                    self.rms_height),
            _length("scan_rms_height_with_spikes", with_spikes, "the same with its spikes", self.height_with_spikes),
            Number("skewness", f"skewness {letter}sk of the heights", "skewness of the heights; 0 if Gaussian",
                   texture.skewness, texture.skewness_error),
            *height_numbers(self.topography),
            Number("aspect_ratio", _if_there("aspect ratio of features", texture.aspect_ratio), "aspect ratio of features",
                   _number(texture.aspect_ratio)),
            Number("texture_direction", _if_there("their direction", texture.direction),
                   wider, _number(texture.direction), unit="rad", sign="°", factor=180 / math.pi),
            _length("h_rms", "rms height h_rms", "rms height of the fitted spectrum", r.h_rms, fitted["h_rms"]),
            Number("hurst", "Hurst exponent", "Hurst exponent of the fitted spectrum", r.hurst, fitted["hurst"]),
            *(Number(name, "", f"wave number of the {WAVES[name]}", _number(q), _number(error), unit="m-1")
              for name, q, error in lengths),
            *(wavelength(name, q, error) for name, q, error in lengths if q is not None),
            Number("rms_slope", "rms slope, grows with finer sampling", "rms slope", spectrum.rms_slope),
            Number("rms_curvature", "rms curvature, grows too", "rms curvature", spectrum.rms_curvature, unit="m-1",
                   dimension="wavenumber"),
            alpha,
            Number("measured_alpha", "  from the measured spectrum", "alpha from the measured spectrum", measured[0]),
            beta,
            Number("measured_beta", "  from that spectrum", "beta from the measured spectrum", measured[1]),
            _length("measured_rms_height", "", "rms height of the measured spectrum", self.spectrum.rms_height),
            gamma,
            Number("noise_density", "", "density of the noise in the spectrum", self.fit.noise, unit=density),
            Number("deviance", "", "deviance of the fit", float(self.fit.deviance)),
        )  # fmt: skip

    @property
    def _about(self) -> dict[str, Any]:
        """What was analysed, and how."""
        return {
            "file": self.topography.source,
            "points": list(self.topography.heights.shape),
            "spacing": list(self.topography.spacing),
            "size": list(self.topography.size),
            "trend": self.shape.trend,
            "tilt": list(self.shape.tilt),
            "body_curvatures": list(self.shape.curvatures),
            "spikes": self.spikes,
            "found": list(self.fit.found),
            "reliable_wavenumbers": [self.measured.lowest, self.measured.highest],
            "reliable_reasons": [self.measured.lowest_reason, self.measured.highest_reason],
            "window": self.window,
        }

    def _card(self) -> Card:
        scan = self.topography
        points, kind = " x ".join(map(str, scan.heights.shape)), "line" if scan.is_line else "map"
        size = " x ".join(format_si(length, "length") for length in scan.size)
        tilt = ", ".join(f"{1e3 * slope:.3g} mrad" for slope in self.shape.tilt) or "none"
        bounds = {"q0": "the longest wave is that of the scan", "q1": "the shortest is that of its reliable range"}
        limited = ", ".join(words for name, words in bounds.items() if name not in self.fit.errors)
        return Card(
            f"{scan.source}: {kind} of {points} points, {size}; tilt removed: {tilt}.",
            table=[("quantity", "value", "error"), *((each.label, *each.texts) for each in self.numbers if each.label)],
            sentences=[*([f"Not of the surface: {limited}."] if limited else []), *self.notes],
        )

    def to_dict(self) -> dict[str, Any]:
        """Return the numbers of :meth:`to_dataset` in SI units, ready for JSON."""
        units = dict.fromkeys(("spacing", "size"), "m") | dict.fromkeys(("body_curvatures", "reliable_wavenumbers"), "m-1")
        units |= units_of(number_columns(self.numbers))
        return self._about | plain_numbers(self.numbers) | {"units": units, "notes": self.notes}

    def _labelled(self) -> Labelled:
        about = {"title": "What a scan says of a surface"} | self._about | {"notes": "\n".join(self.notes)}
        return number_columns(self.numbers), {}, about


def _length(name: str, label: str, meaning: str, value: float | None, error: float | None = None) -> Number:
    return Number(name, label, meaning, _number(value), _number(error), unit="m", dimension="length")


def wavelength(name: str, q: float, error: float | None = None) -> Number:
    """Return an end of the fitted spectrum as the length of its wave, by the name that it has in a case."""
    wave, length = WAVES[name], 2 * math.pi / q
    return _length(
        re.sub(r"\W", "_", wave), wave, f"{wave} of the fitted spectrum", length, None if error is None else length * error / q
    )


def _number(value: float | None) -> float:
    return math.nan if value is None else float(value)


def _if_there(label: str, value: float | None) -> str:
    return "" if value is None else label


def analyse(
    topography: Topography | Array,
    *,
    spacing: str | float | tuple[str | float, ...] | None = None,
    trend: Trend = "curvature",
    window: Window = "hann",
    resolution: str | float | None = None,
    gamma: float = GAMMA,
    keep_spikes: bool = False,
) -> Surface:
    """Return what a scan says of a surface.

    Parameters
    ----------
    topography : Topography or ndarray
        Measured heights, as of :func:`read_topography`; or an array of them, of shape (n,) or (nx, ny) [m].
    spacing : str, float or tuple, optional
        Of an array, the distance between neighbouring points, one for all axes or one for each [m].
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
        topography = _of_array(topography, spacing)
    elif spacing is not None:
        raise InputError(f"spacing = {show(spacing)}, but the topography has its own; leave spacing out.")
    gamma = GAMMA_INPUT.checked(gamma)
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
        *_spike_notes(spikes, _rms(flat), spiked),
        *departure_notes(flat, found),
        *_fit_notes(flat, shape, measured, fit),
    )
    return Surface(flat, shape, measured, fit, gamma, found, spikes, spiked, window, notes)


def _spike_notes(spikes: int, repaired: float, spiked: float) -> list[str]:
    """Return sentences on the repair of spikes."""
    if spikes == 0:
        return []
    change = f"{format_si(spiked, 'length')} with its spikes and {format_si(repaired, 'length')} without"
    notes = [f"The rms height of the scan is {change}."]
    if abs(repaired - spiked) > REPAIR_NOTE * repaired:
        notes.append(
            f"The repair of spikes changed the rms height by {100 * (spiked - repaired) / repaired:.0f} %: look at the scan, "
            "and keep them (--keep-spikes, keep_spikes=True) if they are asperities or dust that touches."
        )
    return notes


def _fit_notes(topography: Topography, body: Form, measured: MeasuredSpectrum, fit: SelfAffineFit) -> list[str]:
    """Return sentences on what the fit does not see, or does not fit."""
    notes = []
    if "roll_off" not in fit.found and "q0" not in fit.found:
        notes.append(
            "No roll-off within the scan: h_rms, alpha and beta are for wavelengths up to "
            f"{format_si(2 * math.pi / fit.roughness.q0, 'length')}, and h_rms and beta depend on the size of the "
            "scan; measure a larger area."
        )
    if "q1" not in fit.found:
        height, beta = (format_percent(rise - 1) for rise in fit.rise_by_shorter_waves)
        notes.append(
            f"The spectrum goes on beyond {format_si(2 * math.pi / measured.highest, 'length')} ({measured.highest_reason}): "
            "slope, curvature and contact area would grow with finer sampling, and alpha would fall. If the power law goes on "
            f"to 1 nm, h_rms rises by {height}, which its error leaves out, and beta by {beta}, which its interval holds."
        )
    if "noise" in fit.found:
        notes.append("The spectrum flattens at short wavelengths as instrument noise does; the noise was subtracted.")
    if fit.deviance > MAX_DEVIANCE_RATIO:
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
    scan, fitted = _rms(topography), fit.roughness.h_rms
    if not 1 / HEIGHT_RATIO_NOTE < fitted / scan < HEIGHT_RATIO_NOTE:
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
            notes.append("The fitted curvature is no larger than roughness alone produces by chance: the surface is flat.")
    return notes


def _of_array(heights: Any, spacing: Any) -> Topography:
    """Return the topography of an array."""
    if not isinstance(heights, np.ndarray | list):
        raise InputError(
            f"topography = {show(heights)}; it must be a Topography, as of read_topography(path), or an array of heights in m "
            "with spacing = ..."
        )
    if spacing is None:
        raise InputError("spacing is missing; give the distance between neighbouring points of the array, such as '0.5 um'.")
    steps = spacing if isinstance(spacing, tuple | list) else (spacing,) * np.ndim(heights)
    return Topography(np.asarray(heights), tuple(to_si(step, "length", "spacing", "0.5 um") for step in steps))


def _rms(topography: Topography) -> float:
    return float(topography.heights.std())
