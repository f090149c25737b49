"""Fit of a self-affine spectrum to a measured one, with its uncertainty."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from stribeck._types import Array, Flags
from stribeck.contact_laws.spectrum import SelfAffine
from stribeck.quantities.units import InputError, checked_kind
from stribeck.surfaces.fit_result import FitParameters, SelfAffineFit, central_differences
from stribeck.surfaces.measured_spectrum import MIN_WAVES_IN_SCAN, MeasuredSpectrum, line_density

__all__ = ["fit_self_affine"]

# Steps of a fit, which needs up to 30; at the bound of the exponent, of a steep line, it creeps on without a change
MAX_STEPS = 60

CUT_OFF_RATIO = 0.3  # Level beyond a cut-off over the spectrum before the cut-off, below which the cut-off counts as one

# Standard error of the logarithm of a long cut-off beyond the scan, in the error of h_rms: a factor of two
LONG_CUT_OFF_ERROR = 0.7

MAX_DEVIANCE_RATIO = 2.0  # Deviance over its expectation from which the spectrum is said not to be self-affine


def fit_self_affine(measured: MeasuredSpectrum) -> SelfAffineFit:
    r"""Fit a self-affine spectrum to the reliable part of a measured one, by least deviance.

    .. math:: D = 2 \sum_b n_b \left[\frac{P_b}{M_b} - 1 - \ln\frac{P_b}{M_b}\right]

    of the spectrum M from rings P of the periodogram, each a mean of n exponentially distributed numbers.  Roll-off, sharp
    cut-offs and white noise are kept where they lower ``D + k ln(sum n)``, for k parameters.

    Parameters
    ----------
    measured : MeasuredSpectrum
        Spectrum of a map or a line.

    Returns
    -------
    SelfAffineFit
        The spectrum with standard errors.

    Raises
    ------
    InputError
        Where no fit converged, or there is nothing but white noise.

    Notes
    -----
    Standard errors come from the Fisher information of the rings, larger by the root of the deviance where that is above
    one; how often they cover is in docs/surfaces.md.  Sharp cut-offs, sought in maps only, are found to the width of a ring.

    Source: [Whittle53]; [Schwarz78] for the penalty.
    """
    rings = checked_kind(
        "measured", measured, MeasuredSpectrum, "a MeasuredSpectrum, as of power_spectrum(topography)"
    ).reliable
    data = _Data(measured.density[rings], measured.modes[rings], measured.inner[rings], measured.is_line)
    q = measured.wavenumber[rings]
    chosen = min(_candidates(data, q), key=lambda trial: trial.score, default=None)
    if chosen is None:
        raise InputError("no self-affine spectrum fits the measured one; look at it with --plot.")
    fit = _result(chosen, data, measured, q)
    if fit.noise > 0 and fit.noise > fit.at(q[:1] * (1 + 1e-9), is_line=data.is_line, noise=False)[0]:
        raise InputError(
            f"the scan shows only white noise at wavelengths from {2 * math.pi / q[-1]:.3g} m to "
            f"{2 * math.pi / q[0]:.3g} m; check that the channel holds heights, or measure a larger area."
        )
    return fit


# --- the model ---


@dataclass(frozen=True, eq=False)
class _Data:
    density: Array
    modes: Array
    inner: Array
    is_line: bool

    def part(self, flags: Flags) -> _Data:
        return replace(self, density=self.density[flags], modes=self.modes[flags], inner=self.inner[flags])


@dataclass(frozen=True, eq=False)
class _Trial:
    """A fit: logarithm of the level at the middle, Hurst exponent, and what else was asked for."""

    values: Array
    roll_off: bool
    noise: bool
    low: int
    high: int
    deviance: float
    parameters: int
    weight: float

    @property
    def score(self) -> float:
        # Roll-off and noise are the rule, and cost no more than what chance gives once in twenty; a roll-off beside a
        # cut-off is not.
        cheap = (self.roll_off and self.low == 0) + self.noise
        return self.deviance + (self.parameters - cheap) * math.log(self.weight) + 3.84 * cheap


def _candidates(data: _Data, q: Array) -> Iterator[_Trial]:
    n = q.size
    plain = [_fit_between_cut_offs(data, q, roll_off, False, 0, n) for roll_off in (False, True)]
    best = min((trial for trial in plain if trial), key=lambda trial: trial.score, default=None)
    if best is None:
        return
    # Sharp cut-offs: all places with six rings left between them, one end after the other.  The spectrum along a line
    # does not vanish beyond them, so they are looked for in maps only.
    if data.is_line:
        yield from (trial for trial in plain if trial)
        yield from (
            trial for trial in (_fit_between_cut_offs(data, q, roll_off, True, 0, n) for roll_off in (False, True)) if trial
        )
        return
    trials = list(plain)
    for first in ("low", "high"):
        # One cut-off, then the second, and the first once more with the second known.
        ends, end = (0, n), first
        for _ in range(3):
            places = (
                [(i, ends[1]) for i in range(1, ends[1] - 5)]
                if end == "low"
                else [(ends[0], j) for j in range(ends[0] + 6, n)]
            )
            found = _fit_best_cut_offs(data, q, places)
            trials.append(found)
            ends = (found.low, found.high) if found else ends
            end = "high" if end == "low" else "low"
    noisy = min((trial for trial in trials if trial), key=lambda trial: trial.score)
    if noisy.high == n:
        trials.append(_fit_between_cut_offs(data, q, noisy.roll_off, True, noisy.low, n))
        trials.append(_fit_between_cut_offs(data, q, not noisy.roll_off, True, noisy.low, n))
    yield from (trial for trial in trials if trial)


def _fit_best_cut_offs(data: _Data, q: Array, places: list[tuple[int, int]]) -> _Trial | None:
    trials = [_fit_between_cut_offs(data, q, False, False, low, high) for low, high in places]
    best = min((trial for trial in trials if trial), key=lambda trial: trial.score, default=None)
    if best is None:
        return None
    rolled = _fit_between_cut_offs(data, q, True, False, best.low, best.high)
    return min((trial for trial in (best, rolled) if trial), key=lambda trial: trial.score)


def _fit_between_cut_offs(data: _Data, q: Array, roll_off: bool, noise: bool, low: int, high: int) -> _Trial | None:
    """Return the fit with cut-offs before ring ``low`` and after ring ``high`` - 1."""
    n = q.size
    inside = np.zeros(n, dtype=bool)
    inside[low:high] = True
    part, centre = data.part(inside), math.log(q[low] * q[high - 1]) / 2
    from scipy.optimize import least_squares  # here, as it takes a fifth of a second to import

    # Beyond a cut-off only what the window leaks is left: a level of its own for each ring.
    for outside, edge in ((data.density[:low], low), (data.density[high:], high - 1)):
        if outside.size and not outside.min() < CUT_OFF_RATIO * data.density[edge]:
            return None
    levels = n - (high - low)
    slope, height = np.polyfit(np.log(q[inside]) - centre, np.log(part.density), 1, w=np.sqrt(part.modes))
    steep = 1.0 if data.is_line else 2.0
    values = [height, min(max((-slope - steep) / 2, 0.1), 0.95)]
    lower, upper = [-np.inf, 0.01], [np.inf, 0.9999]
    if roll_off:
        values.append(math.log(q[low]) + 0.3 * math.log(q[high - 1] / q[low]))
        lower.append(math.log(part.inner[0, 0]))
        upper.append(math.log(q[high - 1]) - 0.5)
        if lower[-1] >= upper[-1]:
            return None
    if noise:
        floor = math.log(part.density[-1])
        values.append(floor - 1.0)
        lower.append(floor - 12.0)
        upper.append(floor + 2.0)

    def residual(theta: Array) -> Array:
        ratio = part.density / _model(theta, part, centre, roll_off, noise)
        excess = np.maximum(ratio - 1 - np.log(ratio), 0.0)
        return np.asarray(np.sign(ratio - 1) * np.sqrt(2 * part.modes * excess))

    starts = [values]
    if roll_off:
        starts += [[height, values[1], lower[2] + share * (upper[2] - lower[2]), *values[3:]] for share in (0.1, 0.6)]
    best: Any = None
    for start in starts:
        first = np.clip(start, np.array(lower) + 1e-9, np.array(upper) - 1e-9)
        fit = least_squares(residual, first, bounds=(lower, upper), x_scale=0.1, max_nfev=MAX_STEPS)
        if fit.status >= 0 and (best is None or fit.cost < best.cost):
            best = fit
    if best is None:
        return None
    weight = float(data.modes.sum())
    return _Trial(best.x, roll_off, noise, low, high, 2 * best.cost, len(values) + levels, weight)


def _model(theta: Array, data: _Data, centre: float, roll_off: bool, noise: bool) -> Array:
    """Return the model averaged over each ring, C at its own level exp(theta_0) where ln q = centre."""
    H = float(theta[1])
    if data.is_line:
        q_r = math.exp(theta[2]) if roll_off else float(data.inner.min())
        q0 = float(data.inner.min())
        unit = SelfAffine(1.0, q0, 1e9 * q0, H, max(q_r, q0))
        shape = line_density(data.inner, unit) / float(line_density(np.array(math.exp(centre)), unit))
    else:
        corner = theta[2] if roll_off else -np.inf
        x = np.maximum(np.log(data.inner), corner)
        shape = np.exp(-2 * (1 + H) * (x - max(centre, corner)))
    mean = math.exp(theta[0]) * shape.mean(axis=-1)
    return np.asarray(mean + math.exp(theta[-1]) if noise else mean)


# --- from the parameters of the fit to those of the surface ---


def _result(trial: _Trial, data: _Data, measured: MeasuredSpectrum, q: Array) -> SelfAffineFit:
    inside = slice(trial.low, trial.high)
    part = replace(data, density=data.density[inside], modes=data.modes[inside], inner=data.inner[inside])
    centre = math.log(q[trial.low] * q[trial.high - 1]) / 2
    fundamental = measured.lowest / MIN_WAVES_IN_SCAN
    cuts = {"q0": trial.low > 0, "q1": trial.high < q.size}
    if cuts["q0"]:
        q0 = float(q[trial.low])
    else:
        # A roll-off goes on to the whole scan at least; a power law must not be prolonged to where it was not seen.
        q0 = fundamental if trial.roll_off else float(measured.lowest)
    q1 = math.sqrt(q[trial.high - 1] * q[trial.high]) if cuts["q1"] else float(measured.highest)

    def model(theta: Array) -> Array:
        return np.asarray(np.log(_model(theta, part, centre, trial.roll_off, trial.noise)))

    slopes = central_differences(model, trial.values)
    information = slopes.T @ (part.modes[:, None] * slopes)
    freedom = max(q.size - trial.parameters, 1)
    excess = trial.deviance / freedom
    covariance = np.zeros((trial.values.size + 2, trial.values.size + 2))
    covariance[:-2, :-2] = np.linalg.pinv(information) * max(1.0, excess)
    # A sharp cut-off is known to the distance between rings, which the window blurs by a fundamental.
    for place, name, ring in ((-2, "q0", trial.low), (-1, "q1", trial.high)):
        if cuts[name]:
            covariance[place, place] = (max(q[ring] - q[ring - 1], fundamental) / q[ring]) ** 2 / 3
    theta = np.concatenate((trial.values, [math.log(q0), math.log(q1)]))
    parameters = FitParameters(theta, covariance, centre, measured.is_line, trial.roll_off, cuts["q0"], cuts["q1"])
    values, turn = parameters.physical(theta), central_differences(parameters.physical, theta)
    spread = covariance.copy()
    if trial.roll_off and not cuts["q0"]:
        spread[-2, -2] = LONG_CUT_OFF_ERROR**2
    sigma = np.sqrt(np.diag(turn @ spread @ turn.T))
    surface = parameters.surface(theta)
    errors = {"h_rms": surface.h_rms * float(sigma[0]), "hurst": float(sigma[1])}
    if trial.roll_off:
        errors["roll_off"] = math.exp(values[2]) * float(sigma[2])
    errors |= {name: math.exp(values[i]) * float(sigma[i]) for i, name in ((3, "q0"), (4, "q1")) if cuts[name]}
    flags = {"roll_off": trial.roll_off, **cuts, "noise": trial.noise}
    return SelfAffineFit(
        roughness=surface,
        errors=errors,
        found=tuple(name for name, flag in flags.items() if flag),
        noise=math.exp(trial.values[-1]) if trial.noise else 0.0,
        deviance=float(excess),
        band=(float(q[trial.low]), float(q[trial.high - 1])),
        _parameters=parameters,
    )
