"""Notes on the validity of the numbers of a scan, a sentence each."""

from __future__ import annotations

import math

import numpy as np

from stribeck.quantities.formats import format_si
from stribeck.surfaces.detrend import Form
from stribeck.surfaces.fit_result import SelfAffineFit
from stribeck.surfaces.measured_spectrum import MeasuredSpectrum
from stribeck.surfaces.self_affine_fit import MAX_DEVIANCE_RATIO
from stribeck.surfaces.topography import Topography

__all__ = ["fit_notes", "spike_notes"]

HEIGHT_RATIO_NOTE = 1.3  # Ratio of the rms heights of scan and fit from which a note says that they differ

REPAIR_NOTE = 0.05  # Relative change of the rms height of the scan by the repair of spikes from which a note warns


def spike_notes(spikes: int, repaired: float, spiked: float) -> list[str]:
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


def fit_notes(topography: Topography, body: Form, measured: MeasuredSpectrum, fit: SelfAffineFit) -> list[str]:
    """Return sentences on what the fit does not see, or does not fit."""
    notes = []
    if "roll_off" not in fit.found and "q0" not in fit.found:
        notes.append(
            "No roll-off within the scan: h_rms, alpha and beta are for wavelengths up to "
            f"{format_si(2 * math.pi / fit.roughness.q0, 'length')}, and h_rms and beta depend on the size of the "
            "scan; measure a larger area."
        )
    if "q1" not in fit.found:
        notes.append(
            f"The spectrum goes on beyond {format_si(2 * math.pi / measured.highest, 'length')} ({measured.highest_reason}): "
            "slope, curvature and contact area would grow with finer sampling, and alpha would fall. beta would rise by up to "
            f"{100 * (fit.beta_of_shorter_waves - 1):.2g} % if the power law goes on to 1 nm; the intervals allow for that."
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
    scan, fitted = float(np.sqrt(np.mean(topography.heights**2))), fit.roughness.h_rms
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
