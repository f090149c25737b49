"""A self-affine spectrum fitted to a measured one: the spectrum, its standard errors, and intervals of alpha and beta.

Waves longer than a scan or shorter than a few of its points are not seen: an interval holds the values for all of them.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace
from typing import Annotated, Any

import numpy as np

from stribeck._types import Array, Flags
from stribeck.contact_laws.persson import GAMMA, exponential_limit
from stribeck.contact_laws.spectrum import SelfAffine
from stribeck.quantities.docstrings import Described
from stribeck.quantities.standard_errors import INTERVAL_95
from stribeck.quantities.units import InputError, checked_kind
from stribeck.surfaces.measured_spectrum import MIN_WAVES_IN_SCAN, MeasuredSpectrum, line_density, line_shape

# Wave numbers of the longest wave of the surface, over that of the scan; the last is as good as none at all
LONGEST_WAVE_RATIOS = (1.0, 0.3, 0.1, 1e-3)

CHANCE = 3.84  # Decrease of the deviance by one more parameter that chance gives once in twenty

SHORTEST_WAVE = 1e-9  # Shortest wave of any surface: a few atoms [m]


@dataclass(frozen=True)
class Estimate(Described):
    """A number with its 95 % interval."""

    value: Annotated[float, "the number, for a surface without waves longer or shorter than those seen"]
    low: Annotated[float, "lower end; 0 for a positive number that is only bounded from above"]
    high: Annotated[float, "upper end"]

    @property
    def interval(self) -> str:
        """The interval in words, such as ``"1.76 to 1.83"``."""
        return f"at most {self.high:.3g}" if self.low == 0 else f"{self.low:.3g} to {self.high:.3g}"

    @property
    def relative_error(self) -> float | None:
        """Standard error over the value, of which 1.96 reach to the farther end of the interval; None without a lower end."""
        if self.low == 0:
            return None
        return math.log(max(self.high / self.value, self.value / self.low)) / INTERVAL_95


@dataclass(frozen=True, eq=False)
class FitParameters:
    """Parameters of a fit with their covariance, and the surface that belongs to them."""

    # Logarithm of the spectrum at `centre`, Hurst exponent, logarithms of the roll-off and of the noise, if there are such,
    # and of q0 and q1
    theta: Array
    covariance: Array  # Of `theta`; zero for a longest wave that was not seen
    centre: float  # Logarithm of the wave number in the middle of the fit
    is_line: bool  # Whether the spectrum is that along a line
    roll_off: bool  # Whether the spectrum shows a roll-off
    q0_found: bool  # Whether it shows its longest wave
    q1_found: bool  # Whether it shows its shortest wave

    def physical(self, theta: Array, corner: float = 1.0, lowest: float = 1.0) -> Array:
        """Return ln h_rms, H, ln q_r, ln q_0 and ln q_1, with roll-off and q_0 moved by factors to longer waves."""
        H, q1 = float(theta[1]), float(theta[-1])
        q_r = (max(theta[2], theta[-2]) if self.roll_off else theta[-2]) + math.log(corner)
        q0 = min((theta[-2] if self.roll_off else q_r) + math.log(lowest), q_r)
        shape = SelfAffine(1.0, math.exp(q0), math.exp(q1), H, math.exp(q_r))
        if self.is_line:
            level = float(line_density(np.array(math.exp(self.centre)), shape))
        else:
            level = float(shape.spectrum.density[0]) * math.exp(-2 * (1 + H) * max(self.centre - q_r, 0.0))
        return np.array([0.5 * (theta[0] - math.log(level)), H, q_r, q0, q1])

    def surface(self, theta: Array, corner: float = 1.0, lowest: float = 1.0, finest: bool = False) -> SelfAffine:
        """Return the surface of the parameters, optionally with longer waves and all shorter ones."""
        if finest:
            theta = np.array([*theta[:-1], max(theta[-1], math.log(2 * math.pi / SHORTEST_WAVE))])
        log_h, H, q_r, q0, q1 = map(float, self.physical(theta, corner, lowest))
        return SelfAffine(math.exp(log_h), math.exp(q0), math.exp(q1), H, math.exp(max(q_r, q0)))

    @property
    def admissible_extensions(self) -> list[tuple[float, float, bool]]:
        """Factors on roll-off and q_0, and whether shorter waves go on, of surfaces that the scan does not exclude."""
        shorter = (False,) if self.q1_found else (False, True)
        if self.q0_found:
            longer = [(1.0, 1.0)]
        else:
            # A power law that is not seen to end may end, or become a plateau, anywhere beyond the scan.
            longer = (
                [(1.0, factor) for factor in (MIN_WAVES_IN_SCAN, *LONGEST_WAVE_RATIOS)]
                if self.roll_off
                else list(itertools.product(LONGEST_WAVE_RATIOS, LONGEST_WAVE_RATIOS))
            )
        return [(*factors, finest) for factors in longer for finest in shorter]


@dataclass(frozen=True, eq=False)
class SelfAffineFit(Described):
    """Self-affine spectrum that fits a measured one."""

    roughness: Annotated[SelfAffine, "the spectrum; its ends are cut-offs of the surface if found, else those of the scan"]
    errors: Annotated[dict[str, float], "standard errors of h_rms [m], q0, roll_off, q1 [1/m] and hurst [-], if found"]
    found: Annotated[tuple[str, ...], "which of roll_off, q0, q1 and noise the spectrum shows"]
    noise: Annotated[float, "spectrum of the white noise, as that of the measurement; 0 where none was found"]
    deviance: Annotated[float, "deviance over its expectation: near one where the model holds", "1"]
    band: Annotated[tuple[float, float], "wave numbers that were fitted", "1/m"]
    _admissible_fits: tuple[FitParameters, ...] = field(
        repr=False
    )  # first those of the fit, then of others with a longest wave

    def exponential_limit(self, gamma: float = GAMMA) -> tuple[Estimate, Estimate]:
        """Return alpha and beta of the contact law, each with its 95 % interval.

        Parameters
        ----------
        gamma : float
            Reduction of the elastic energy [-].

        Returns
        -------
        tuple of Estimate
            alpha and beta [-].

        Notes
        -----
        The interval is that of a profile over what both ends of the spectrum hide: from the smallest of ``value - 1.96
        standard errors`` to the largest of ``value + 1.96 standard errors``, over all longest waves that the spectrum does
        not exclude, and with the power law to its end at the shortest wave seen or at 1 nm.  If neither a roll-off nor the
        longest wave was seen, ``beta`` has no lower bound, and its interval begins at 0.  How often the intervals hold the
        truth is in docs/surfaces.md, from ``benchmarks/surface_errors.py``.
        """
        known = self._admissible_fits[0]
        best = np.log(exponential_limit(known.surface(known.theta), gamma))
        hidden = [(each, ends) for each in self._admissible_fits for ends in each.admissible_extensions]
        profile = np.array([np.log(exponential_limit(each.surface(each.theta, *ends), gamma)) for each, ends in hidden])
        low, high = np.empty(2), np.empty(2)
        for i in (0, 1):
            for bound, at, sign in ((low, profile[:, i].argmin(), -1), (high, profile[:, i].argmax(), 1)):
                each, ends = hidden[at]

                def limit(theta: Array, of: FitParameters = each, ends: tuple[float, float, bool] = ends) -> Array:
                    return np.log(exponential_limit(of.surface(theta, *ends), gamma))

                turn = central_differences(limit, each.theta)[i]
                bound[i] = math.exp(profile[at, i] + sign * INTERVAL_95 * math.sqrt(float(turn @ each.covariance @ turn)))
        if not (known.q0_found or known.roll_off):
            low[1] = 0.0
        alpha, beta = (Estimate(*map(float, row)) for row in zip(np.exp(best), low, high, strict=True))
        return alpha, beta

    @property
    def rise_by_shorter_waves(self) -> tuple[float, float]:
        """Largest h_rms and beta over their values, if the power law goes on to shorter waves than were seen."""
        known = self._admissible_fits[0]
        seen, all_waves = (known.surface(known.theta, finest=finest) for finest in (False, not known.q1_found))
        return all_waves.h_rms / seen.h_rms, exponential_limit(all_waves)[1] / exponential_limit(seen)[1]

    def at(self, wavenumber: Array, *, is_line: bool = False, noise: bool = True) -> Array:
        """Return the fitted spectrum, as a map or a line shows it.

        Parameters
        ----------
        wavenumber : ndarray
            Wave numbers [1/m].
        is_line : bool
            Whether the spectrum along a line is wanted.
        noise : bool
            Whether the noise is part of it.

        Returns
        -------
        ndarray
            Spectrum [m^4; m^3 along a line].
        """
        q = np.asarray(wavenumber, dtype=float)
        clean = line_density(q, self.roughness) if is_line else self.roughness.spectrum.at(q)
        return clean + (self.noise if noise else 0.0)


def central_differences(function: Callable[[Array], Array], x: Array) -> Array:
    """Return central differences of a smooth function of parameters of order one."""
    columns = []
    for i in range(x.size):
        step = np.zeros(x.size)
        step[i] = 1e-5
        columns.append((function(x + step) - function(x - step)) / 2e-5)
    return np.stack(columns, axis=1)


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
    checked_kind("measured", measured, MeasuredSpectrum, "a MeasuredSpectrum, as of power_spectrum(topography)")
    data = _rings(measured, measured.reliable)
    q = data.wavenumber
    chosen = _best(_candidates(data))
    if chosen is None:
        raise InputError("no self-affine spectrum fits the measured one; look at it with --plot.")
    fit = _result(chosen, data)
    if fit.noise > 0 and fit.noise > fit.at(q[:1] * (1 + 1e-9), is_line=data.is_line, noise=False)[0]:
        raise InputError(
            f"the scan shows only white noise at wavelengths from {2 * math.pi / q[-1]:.3g} m to "
            f"{2 * math.pi / q[0]:.3g} m; check that the channel holds heights, or measure a larger area."
        )
    return fit


# --- the model ---


def _rings(measured: MeasuredSpectrum, chosen: Flags | slice) -> MeasuredSpectrum:
    """Return a spectrum of some of its rings."""
    kept = {name: getattr(measured, name)[chosen] for name in ("wavenumber", "density", "modes", "inner")}
    return replace(measured, **kept)


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
        return self.deviance + (self.parameters - cheap) * math.log(self.weight) + CHANCE * cheap


def _best(trials: Iterable[_Trial | None]) -> _Trial | None:
    return min(filter(None, trials), key=lambda trial: trial.score, default=None)


def _candidates(data: MeasuredSpectrum) -> list[_Trial | None]:
    n = data.wavenumber.size
    trials = [_fit_between_cut_offs(data, roll_off, False, 0, n) for roll_off in (False, True)]
    if not any(trials):
        return []
    # Sharp cut-offs: all places with six rings left between them, one end after the other.  The spectrum along a line
    # does not vanish beyond them, so they are looked for in maps only.
    if data.is_line:
        return [*trials, *(_fit_between_cut_offs(data, roll_off, True, 0, n) for roll_off in (False, True))]
    for first in ("low", "high"):
        # One cut-off, then the second, and the first once more with the second known.
        ends, end = (0, n), first
        for _ in range(3):
            places = (
                [(i, ends[1]) for i in range(1, ends[1] - 5)]
                if end == "low"
                else [(ends[0], j) for j in range(ends[0] + 6, n)]
            )
            found = _fit_best_cut_offs(data, places)
            trials.append(found)
            ends = (found.low, found.high) if found else ends
            end = "high" if end == "low" else "low"
    # A power law is cut off where it goes over into a plateau; that plateau has a cut-off of its own.
    cut = _best(trials)
    if cut is not None:
        lows = range(1, min(max(trial.low for trial in trials if trial is not None), cut.high - 5))
        trials += [_fit_between_cut_offs(data, True, False, low, cut.high) for low in lows]
    noisy = _best(trials)
    if noisy is not None and noisy.high == n:
        trials += [_fit_between_cut_offs(data, roll_off, True, noisy.low, n) for roll_off in (False, True)]
    return trials


def _fit_best_cut_offs(data: MeasuredSpectrum, places: list[tuple[int, int]]) -> _Trial | None:
    best = _best(_fit_between_cut_offs(data, False, False, low, high) for low, high in places)
    return None if best is None else _best((best, _fit_between_cut_offs(data, True, False, best.low, best.high)))


def _fit_between_cut_offs(
    data: MeasuredSpectrum, roll_off: bool, noise: bool, low: int, high: int, near: _Trial | None = None
) -> _Trial | None:
    """Return the fit with cut-offs before ring ``low`` and after ring ``high`` - 1, sought near another one if given."""
    q, n, part = data.wavenumber, data.wavenumber.size, _fitted_rings(data, low, high)
    centre, longest = _centre(data, low, high), _longest(data, low)
    from scipy.optimize import least_squares  # here, as it takes a fifth of a second to import

    # Beyond a cut-off only what the window leaks is left: a level of its own for each ring.
    for outside, edge in ((data.density[:low], low), (data.density[high:], high - 1)):
        if not data.is_line and outside.size and not outside.min() < CUT_OFF_RATIO * data.density[edge]:
            return None
    levels = n - part.wavenumber.size
    slope, height = np.polyfit(np.log(part.wavenumber) - centre, np.log(part.density), 1, w=np.sqrt(part.modes))
    steep = 1.0 if data.is_line else 2.0
    values = [height, min(max((-slope - steep) / 2, 0.1), 0.95)]
    lower, upper = [-np.inf, 0.01], [np.inf, 0.9999]
    if roll_off:
        values.append(math.log(q[low]) + 0.3 * math.log(q[high - 1] / q[low]))
        lower.append(math.log(longest))
        upper.append(math.log(q[high - 1]) - 0.5)
        if lower[-1] >= upper[-1]:
            return None
    if noise:
        floor = math.log(part.density[-1])
        values.append(floor - 1.0)
        lower.append(floor - 12.0)
        upper.append(floor + 2.0)

    def residual(theta: Array) -> Array:
        ratio = part.density / _model(theta, part, centre, longest, roll_off, noise)
        excess = np.maximum(ratio - 1 - np.log(ratio), 0.0)
        return np.asarray(np.sign(ratio - 1) * np.sqrt(2 * part.modes * excess))

    starts = [values]
    if near is not None and near.roll_off == roll_off:
        starts = [list(near.values)]
    elif roll_off:
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


def _fitted_rings(data: MeasuredSpectrum, low: int, high: int) -> MeasuredSpectrum:
    """Return the rings between cut-offs; along a line all, as waves at an angle show beyond its longest wave."""
    return data if data.is_line else _rings(data, slice(low, high))


def _centre(data: MeasuredSpectrum, low: int, high: int) -> float:
    """Return the logarithm of the wave number in the middle of a fit."""
    q = _fitted_rings(data, low, high).wavenumber
    return math.log(q[0] * q[-1]) / 2


def _longest(data: MeasuredSpectrum, low: int) -> float:
    """Return the wave number of the longest wave of a fit with a cut-off before ring ``low``, or of those in its rings."""
    return float(data.wavenumber[low] if data.is_line and low > 0 else data.inner[low:].min())


def _model(theta: Array, data: MeasuredSpectrum, centre: float, longest: float, roll_off: bool, noise: bool) -> Array:
    """Return the model averaged over each ring, C at its own level exp(theta_0) where ln q = centre."""
    H = float(theta[1])
    if data.is_line:
        q_r = math.exp(theta[2]) if roll_off else longest
        ends = longest, max(q_r, longest), H
        shape = line_shape(data.inner, *ends) / line_shape(np.array(math.exp(centre)), *ends)
    else:
        corner = theta[2] if roll_off else -np.inf
        x = np.maximum(np.log(data.inner), corner)
        shape = np.exp(-2 * (1 + H) * (x - max(centre, corner)))
    mean = math.exp(theta[0]) * shape.mean(axis=-1)
    return np.asarray(mean + math.exp(theta[-1]) if noise else mean)


# --- from the parameters of the fit to those of the surface ---


def _admissible_fits(chosen: _Trial, data: MeasuredSpectrum) -> tuple[FitParameters, ...]:
    """Return the parameters of a fit, and of those with a longest wave in the scan that fit no worse than by chance."""
    scale = max(1.0, _excess(chosen, data))

    def score(trial: _Trial) -> float:
        return trial.deviance / scale + CHANCE * trial.parameters

    found, least = [chosen], score(chosen)
    for i in range(1, chosen.high - 5 if chosen.low == 0 else 0):
        if chosen.roll_off and data.wavenumber[i] > math.exp(chosen.values[2]):
            break
        shapes = (_fit_between_cut_offs(data, each, chosen.noise, i, chosen.high, chosen) for each in (False, True))
        best = min(filter(None, shapes), key=score, default=None)
        if best is not None:
            if score(best) > least + CHANCE:
                break
            found, least = [*found, best], min(least, score(best))
    return tuple(_parameters(each, data) for each in found if each is chosen or score(each) <= least + CHANCE)


def _parameters(trial: _Trial, data: MeasuredSpectrum) -> FitParameters:
    """Return the parameters of a fit with their covariance."""
    q, part, centre = data.wavenumber, _fitted_rings(data, trial.low, trial.high), _centre(data, trial.low, trial.high)
    fundamental = data.lowest / MIN_WAVES_IN_SCAN
    cuts = {"q0": trial.low > 0, "q1": trial.high < q.size}
    if cuts["q0"]:
        q0 = float(q[trial.low])
    else:
        # A roll-off goes on to the whole scan at least; a power law must not be prolonged to where it was not seen.
        q0 = fundamental if trial.roll_off else float(data.lowest)
    q1 = math.sqrt(q[trial.high - 1] * q[trial.high]) if cuts["q1"] else float(data.highest)
    longest = _longest(data, trial.low)

    def model(theta: Array) -> Array:
        return np.asarray(np.log(_model(theta, part, centre, longest, trial.roll_off, trial.noise)))

    slopes = central_differences(model, trial.values)
    information = slopes.T @ (part.modes[:, None] * slopes)
    covariance = np.zeros((trial.values.size + 2, trial.values.size + 2))
    covariance[:-2, :-2] = np.linalg.pinv(information) * max(1.0, _excess(trial, data))
    # A sharp cut-off is known to the distance between rings, which the window blurs by a fundamental.
    for place, name, ring in ((-2, "q0", trial.low), (-1, "q1", trial.high)):
        if cuts[name]:
            covariance[place, place] = (max(q[ring] - q[ring - 1], fundamental) / q[ring]) ** 2 / 3
    theta = np.concatenate((trial.values, [math.log(q0), math.log(q1)]))
    return FitParameters(theta, covariance, centre, data.is_line, trial.roll_off, cuts["q0"], cuts["q1"])


def _excess(trial: _Trial, data: MeasuredSpectrum) -> float:
    """Return the deviance of a fit over its expectation."""
    return trial.deviance / max(data.wavenumber.size - trial.parameters, 1)


def _result(trial: _Trial, data: MeasuredSpectrum) -> SelfAffineFit:
    admissible = _admissible_fits(trial, data)
    parameters, q = admissible[0], data.wavenumber
    theta = parameters.theta
    values, turn = parameters.physical(theta), central_differences(parameters.physical, theta)
    spread = parameters.covariance.copy()
    if trial.roll_off and not parameters.q0_found:
        spread[-2, -2] = LONG_CUT_OFF_ERROR**2
    sigma = np.sqrt(np.diag(turn @ spread @ turn.T))
    surface = parameters.surface(theta)
    errors = {"h_rms": surface.h_rms * float(sigma[0]), "hurst": float(sigma[1])}
    if trial.roll_off:
        errors["roll_off"] = math.exp(values[2]) * float(sigma[2])
    cuts = {"q0": parameters.q0_found, "q1": parameters.q1_found}
    errors |= {name: math.exp(values[i]) * float(sigma[i]) for i, name in ((3, "q0"), (4, "q1")) if cuts[name]}
    flags = {"roll_off": trial.roll_off, **cuts, "noise": trial.noise}
    return SelfAffineFit(
        roughness=surface,
        errors=errors,
        found=tuple(name for name, flag in flags.items() if flag),
        noise=math.exp(trial.values[-1]) if trial.noise else 0.0,
        deviance=float(_excess(trial, data)),
        band=(float(q[trial.low]), float(q[trial.high - 1])),
        _admissible_fits=admissible,
    )
