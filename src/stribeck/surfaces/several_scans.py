"""Several scans of one surface: their mean spectrum, the law of it, and intervals from their scatter."""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Annotated, Any

import numpy as np

from stribeck._types import Array
from stribeck.contact_laws.persson import exponential_limit
from stribeck.files.datasets import number_columns, units_of
from stribeck.files.results import Labelled
from stribeck.files.writing import atomic_write
from stribeck.quantities.formats import Number, format_percent, format_si, plain_numbers
from stribeck.quantities.lazy import cached_property
from stribeck.quantities.results import Card
from stribeck.quantities.standard_errors import INTERVAL_95
from stribeck.quantities.units import InputError, show
from stribeck.surfaces.analysis import FittedSurface, Surface, wavelength
from stribeck.surfaces.measured_spectrum import MeasuredSpectrum
from stribeck.surfaces.self_affine_fit import Estimate, SelfAffineFit, fit_self_affine

# Numbers of the heights of each scan, whose mean is printed.
HEIGHTS = ("scan_rms_height", "mean_deviation", "skewness", "kurtosis", "scan_rms_slope")

SAME_RING = 1e-9  # Relative difference of two wave numbers that are the same ring of two grids, which is rounding


@dataclass(frozen=True, eq=False, repr=False)
class CombinedSurface(FittedSurface):
    """What several scans say of one surface; its dataset has its numbers in SI units, each with its interval."""

    surfaces: Annotated[tuple[Surface, ...], "the scans, each by itself"]
    measured: Annotated[MeasuredSpectrum, "mean spectrum of all scans"]
    scatter: Annotated[Array, "standard error of each mean by the scatter; nan where one scan shows it", "m^4; m^3 of lines"]
    fit: Annotated[SelfAffineFit, "self-affine spectrum through all rings; its errors include the scatter"]
    alpha: Annotated[Estimate, "decay of the contact law [-], with its 95 % interval"]
    beta: Annotated[Estimate, "scale of the contact law [-], with its 95 % interval"]
    gamma: Annotated[float, "reduction of the elastic energy in Persson's theory", "1"]
    notes: Annotated[tuple[str, ...], "what must be known before the numbers are used"] = field(default=())

    @property
    def limits(self) -> tuple[Estimate, Estimate]:
        """The numbers alpha and beta of the contact law."""
        return self.alpha, self.beta

    @property
    def source(self) -> str:
        """The scans in words."""
        return f"{len(self.surfaces)} scans ({', '.join(each.source for each in self.surfaces)})"

    @property
    def inputs(self) -> dict[str, float]:
        """The arguments ``roughness`` [m], ``alpha`` and ``beta`` [-] of a contact."""
        return {"roughness": self.roughness.h_rms, "alpha": self.alpha.value, "beta": self.beta.value}

    @property
    def errors(self) -> dict[str, float]:
        """Standard errors of :attr:`inputs` over their values, as :func:`stribeck.propagate` takes them [-].

        ``beta`` is left out where the scans bound it from above only.
        """
        found = {"roughness": self.fit.errors["h_rms"] / self.roughness.h_rms}
        return found | {name: error for name in ("alpha", "beta") if (error := getattr(self, name).relative_error)}

    @cached_property
    def numbers(self) -> tuple[Number, ...]:
        """Every number of the surface with its unit, meaning and 95 % interval, in the order of reports."""
        each = [{number.name: number for number in surface.numbers} for surface in self.surfaces]
        heights = []
        for name in HEIGHTS:
            values = np.array([numbers[name].value for numbers in each])
            mean, half = float(values.mean()), _half_width(values)
            first = each[0][name]
            heights.append(replace(first, meaning=f"mean of the {first.meaning}", value=mean, error=math.nan,
                                   interval=(mean - half, mean + half)))  # fmt: skip
        fitted = []
        for name, error in {"h_rms": 0.0, "hurst": 0.0, **self.fit.errors}.items():
            value = float(getattr(self.roughness, name))
            low, high = _ends(name, value, error)
            shown = each[0][name]
            if shown.unit == "m-1":  # reports have the wavelength
                shown = wavelength(name, value)
                value, low, high = (2 * math.pi / end for end in (value, high, low))
            fitted.append(replace(shown, value=value, error=math.nan, interval=(low, high)))
        return (*heights, *fitted, *self._of_law)

    def _card(self) -> Card:
        each = [{number.name: number for number in surface.numbers} for surface in self.surfaces]
        rows = []
        for number in self.numbers:
            values = [float(found[number.name].value) for found in each if number.name in found]
            ends = [replace(number, value=end, interval=None).texts[0] for end in (min(values), max(values))] if values else []
            value, interval = number.texts
            rows.append((number.label, value, interval.removesuffix(" (95 %)"), " to ".join(ends) if number.interval else ""))
        return Card(
            f"{len(self.surfaces)} scans of one surface: {', '.join(each.source for each in self.surfaces)}.",
            table=[("quantity", "value", "95 % interval", "scans"), *rows],
            sentences=list(self.notes),
        )

    def to_dict(self) -> dict[str, Any]:
        """Return the numbers of :meth:`to_dataset` in SI units, and what each scan says by itself, ready for JSON."""
        about = {"scans": [each.to_dict() for each in self.surfaces], "found": self.fit.found}
        told = {"relative_errors": self.errors, "units": units_of(number_columns(self.numbers)), "notes": self.notes}
        return about | plain_numbers(self.numbers) | told

    def _labelled(self) -> Labelled:
        density = "m3" if self.measured.is_line else "m4"
        rings = "wavenumber"
        columns = number_columns(self.numbers) | {
            "spectrum": (rings, self.measured.density, density, "mean spectrum of the scans"),
            "spectrum_error": (rings, self.scatter, density, "standard error of spectrum by the scatter of the scans"),
        }
        about = {"title": "What several scans say of one surface", "files": [each.source for each in self.surfaces]}
        coordinates = {rings: (rings, self.measured.wavenumber, "m-1", "wave number")}
        return columns, coordinates, about | {"notes": "\n".join(self.notes)}


def combine(surfaces: Sequence[Surface]) -> CombinedSurface:
    r"""Combine several scans of one surface into one spectrum and contact law, with intervals from their scatter.

    .. math:: \bar y \pm t_{0.975,\, n-1} \frac{s}{\sqrt n}

    for each number y of the n scans, or its logarithm, with their standard deviation s; an interval of the law is never
    narrower than what the fit of the mean spectrum states.

    Parameters
    ----------
    surfaces : sequence of Surface
        Two scans or more, as of :func:`analyse`, at different places of one surface; all maps or all lines.

    Returns
    -------
    CombinedSurface
        Mean spectrum with its scatter, height parameters, and contact law with intervals.

    Raises
    ------
    InputError
        Where there are fewer than two scans, one is given twice, lines and maps are mixed, gamma differs, or no spectrum fits.

    Notes
    -----
    The places must be independent: scans that overlap scatter less than the surface does.  Two scans have wide intervals
    (t = 12.7), four have t = 3.2.  How often intervals hold the truth is in docs/surfaces.md.

    Source: Student's interval of a mean; [Whittle53] for the fit of all rings.

    Examples
    --------
    >>> import stribeck as sb
    >>> truth = sb.surfaces.SelfAffine(1e-6, 5e4, 3e6, 0.8, 7e5)
    >>> scans = [sb.surfaces.synthetic_topography(truth, (64, 64), 1e-6, seed) for seed in (1, 2, 3)]
    >>> surface = sb.surfaces.combine([sb.surfaces.analyse(scan) for scan in scans])
    >>> sorted(surface.errors)
    ['alpha', 'beta', 'roughness']
    """
    found = tuple(surfaces) if isinstance(surfaces, list | tuple) else ()
    if len(found) < 2 or not all(isinstance(each, Surface) for each in found):
        what = f"{len(found)} surface" if len(found) == 1 else show(surfaces)
        raise InputError(f"surfaces = {what}; give a list of two or more, each as of analyse(scan).")
    heights: dict[bytes, Surface] = {}
    for each in found:
        key = each.topography.heights.tobytes()
        if key in heights:
            raise InputError(
                f"{heights[key].source} and {each.source} have the same heights, which would count as two places; give each "
                "scan once."
            )
        heights[key] = each
    kinds = {each.topography.is_line: each for each in found}
    if len(kinds) == 2:
        raise InputError(
            f"{kinds[True].source} is a profile and {kinds[False].source} a map; their spectra are not the same "
            "quantity: combine either."
        )
    gammas = sorted({each.gamma for each in found})
    if len(gammas) > 1:
        raise InputError(f"gamma is {gammas[0]:g} of one surface and {gammas[-1]:g} of another; analyse all with the same.")
    measured, scatter = _mean_spectrum([each.measured for each in found])
    own = fit_self_affine(measured)
    errors = dict(own.errors)
    for name in own.errors:
        if all(name in each.fit.errors for each in found):
            values = np.array([getattr(each.roughness, name) for each in found])
            half = _half_width(values) if name == "hurst" else getattr(own.roughness, name) * _half_width(np.log(values))
            errors[name] = max(errors[name], half / INTERVAL_95)
    gamma, notes = gammas[0], _notes(found, own)
    numbers = np.log([exponential_limit(each.roughness, gamma) for each in found]).T
    profile = replace(
        own, _admissible_fits=tuple(replace(each, covariance=0 * each.covariance) for each in own._admissible_fits)
    )
    limits = []
    for stated, hidden, logs in zip(own.exponential_limit(gamma), profile.exponential_limit(gamma), numbers, strict=True):
        half = _half_width(logs)
        low, high = (hidden.low * math.exp(-half), hidden.high * math.exp(half))
        limits.append(Estimate(stated.value, min(stated.low, low), max(stated.high, high)))
    alpha, beta = limits
    return CombinedSurface(found, measured, scatter, replace(own, errors=errors), alpha, beta, gamma, notes)


def _mean_spectrum(spectra: Sequence[MeasuredSpectrum]) -> tuple[MeasuredSpectrum, Array]:
    """Return all reliable rings in one spectrum, and the standard error of each that scans share."""
    rows = [(float(each.wavenumber[i]), each, int(i)) for each in spectra for i in np.flatnonzero(each.reliable)]
    rows.sort(key=lambda row: row[0])
    groups: list[list[tuple[float, MeasuredSpectrum, int]]] = []
    for row in rows:
        if groups and row[0] <= groups[-1][0][0] * (1 + SAME_RING):
            groups[-1].append(row)
        else:
            groups.append([row])
    density, modes, scatter = np.empty((3, len(groups)))
    for k, group in enumerate(groups):
        values = np.array([each.density[i] for _, each, i in group])
        weights = np.array([each.modes[i] for _, each, i in group])
        density[k], modes[k] = np.average(values, weights=weights), weights.sum()
        scatter[k] = values.std(ddof=1) / math.sqrt(values.size) if values.size > 1 else math.nan
    longest, shortest = min(spectra, key=lambda each: each.lowest), max(spectra, key=lambda each: each.highest)
    counts = np.array([each.modes[each.reliable].sum() for each in spectra])
    return (
        MeasuredSpectrum(
            wavenumber=np.array([group[0][0] for group in groups]),
            density=density,
            modes=modes,
            inner=np.array([group[0][1].inner[group[0][2]] for group in groups]),
            is_line=spectra[0].is_line,
            lowest=longest.lowest,
            highest=shortest.highest,
            lowest_reason=longest.lowest_reason,
            highest_reason=shortest.highest_reason,
            mean_square=float(np.mean([each.mean_square for each in spectra])),
            texture=complex(np.average([each.texture for each in spectra], weights=counts)),
        ),
        scatter,
    )


def _half_width(values: Array) -> float:
    """Return half of the 95 % interval of the mean of a few numbers."""
    from scipy.stats import t  # here, as it takes a third of a second to import

    return float(t.ppf(0.975, values.size - 1) * values.std(ddof=1) / math.sqrt(values.size))


def _ends(name: str, value: float, error: float) -> tuple[float, float]:
    """Return the 95 % interval of a number with a standard error, in logarithms but of the Hurst exponent."""
    half = INTERVAL_95 * error
    return (
        (value - half, value + half) if name == "hurst" else (value * math.exp(-half / value), value * math.exp(half / value))
    )


def _notes(surfaces: Sequence[Surface], fit: SelfAffineFit) -> tuple[str, ...]:
    """Return what must be known before the numbers are used."""
    notes = []
    sizes = sorted(max(each.topography.size) for each in surfaces)
    if sizes[-1] > 1.5 * sizes[0]:
        notes.append(
            f"The scans are {format_si(sizes[0], 'length')} to {format_si(sizes[-1], 'length')} long: their rms heights differ"
            " by the longest waves that each shows too, and the intervals count that as scatter."
        )
    seen = sum("roll_off" in each.fit.found for each in surfaces)
    if "roll_off" in fit.found and seen < len(surfaces):
        notes.append(f"The mean spectrum shows a roll-off, {seen} of {len(surfaces)} scans alone do.")
    if "roll_off" not in fit.found and "q0" not in fit.found:
        notes.append(
            "No roll-off within the scans: h_rms and beta are for wavelengths up to "
            f"{format_si(2 * math.pi / fit.roughness.q0, 'length')}; measure a larger area."
        )
    own: dict[str, list[str]] = {}
    for each in surfaces:
        for note in each.topography.notes:
            own.setdefault(note, []).append(each.source)
    notes += [note if len(names) == len(surfaces) else f"{', '.join(names)}: {note}" for note, names in own.items()]
    return tuple(notes)


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
        return f"standard error {format_percent(errors[name] / values[name])}" if name in errors else "end of the scan"

    height_error = f" +- {format_percent(errors['h_rms'] / r.h_rms)}" if has_errors else ""
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
