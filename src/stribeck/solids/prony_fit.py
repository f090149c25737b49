r"""From a rubber's master curve to the Prony series of a viscoelastic body.

The storage and the loss modulus of a Prony series are linear in the moduli of its terms,

.. math::

    E'(\omega) = E_\infty + \sum_i E_i \frac{\omega^2 \tau_i^2}{1 + \omega^2 \tau_i^2}, \qquad
    E''(\omega) = \sum_i E_i \frac{\omega \tau_i}{1 + \omega^2 \tau_i^2}

so that for given times, even in the logarithm, non-negative least squares of the relative deviations has one answer.  One to
four times per decade are tried; Bayes' criterion decides.
"""

from __future__ import annotations

import math
import os
import re
from dataclasses import dataclass, replace
from typing import Annotated, Any

import numpy as np

from stribeck._types import Array
from stribeck.files.results import Labelled, Tabled
from stribeck.quantities.formats import format_percent, format_si
from stribeck.quantities.lazy import cached_property
from stribeck.quantities.results import Card, Told
from stribeck.quantities.schema import Input
from stribeck.quantities.units import InputError, positive_columns, show
from stribeck.solids.viscoelastic import MAX_TERMS, Prony

MIN_VALUES = 5  # Frequencies from which a series is fitted: with fewer nothing is left to judge it
TIMES_PER_DECADE = (1, 2, 3, 4)  # Densities of relaxation times that are tried; with more, neighbours cannot be told apart
STRONG_EVIDENCE = 6.0  # Difference of the criteria from which the values speak against a series of fewer terms
NO_SCATTER = 1e-6  # Relative scatter below which values are as good as computed
POOR_FIT = 0.1  # Rms deviation above which a note says that the series does not follow the curve
NO_PLATEAU = 1.5  # Storage modulus at the lowest frequency over the relaxed one from which the curve shows no plateau

# Names of moduli in the headers of files: words and primes, and the letter and the words of what they are of.
MODULI = {
    "storage modulus": (r"storage(?: modulus)?|speichermodul", "['′’´`]"),
    "loss modulus": (r"loss(?: modulus)?|verlustmodul", "(?:['′’´`]{2}|[\"″”])"),
}
# Names of the frequency in the headers of files: of several, that of a master curve
_SHIFTED, _SHIFT = "reduced|red|shifted|reduzierte?|verschoben", "a[ _]?t ?[ ·*] ?(?:f|omega|ω)"
REDUCED = rf".*(?:{_SHIFTED}).*|{_SHIFT}"
FREQUENCY = (
    rf"(?:(?:angular|{_SHIFTED}) )*(?:freq(?:uency)?|(?:kreis)?frequenz)(?: (?:{_SHIFTED}))?(?: {_SHIFT})?|omega|ω|f|{_SHIFT}"
)
TEMPERATURE = r"(?:sample |probe[n ]*)?temp(?:erature?|\.)?|t"
ONE_TEMPERATURE = 2.0  # Span of temperatures in a file up to which its moduli count as of one: of control, not of steps
LOSS_TANGENT = r"(?:loss )?tan(?:gent)?(?:[ _]?(?:delta|δ|d))?|loss (?:factor|tangent)|damping factor|verlustfaktor"
TENSION, SHEAR = "tension", "shear"
KINDS = {TENSION: ("e", "tensile|young.?s|zug"), SHEAR: ("g", "shear|schub|scher")}
# What lines above the header say of the deformation
KINDS_ABOVE = {
    TENSION: re.compile(r"\b(?:(?:tension|tensile|compression|bending|cantilever)\b|(?:zug|druck|biege))", re.IGNORECASE),
    SHEAR: re.compile(r"\b(?:shear|torsion|(?:parallel|plate).plate|cone.plate|schub|scher|platte.platte)", re.IGNORECASE),
}
PER_SECOND = {"1/s", "s^-1", "s-1", "s⁻¹"}  # Units of the frequency that do not say whether they are of cycles or radians

POISSON_RATIO = Input(
    name="poisson_ratio", label="Poisson ratio of the rubber", dimension="number", typical="0.5", source="rubber",
    zero=True, highest=0.5,
)  # fmt: skip


@dataclass(frozen=True, repr=False)
class PronyFit(Told, Tabled):
    """A rubber's complex modulus over the frequency, and the Prony series through it."""

    frequency: Annotated[Array, "angular frequencies", "rad/s"]
    storage: Annotated[Array, "storage modulus there", "Pa"]
    loss: Annotated[Array, "loss modulus there", "Pa"]
    solid: Annotated[Prony, "the body of :mod:`stribeck.solids`, in SI units"]
    relaxed_modulus: Annotated[float, "Young's modulus at rest, that of the series", "Pa"]
    poisson_ratio: Annotated[float, "Poisson's ratio, which does not relax", "1"]
    misfit: Annotated[float, "root mean square of the relative deviations of storage and loss modulus", "1"]
    largest_misfit: Annotated[float, "largest relative deviation of either", "1"]
    notes: Annotated[tuple[str, ...], "what must be known before the body is used"] = ()

    @cached_property
    def modulus(self) -> float:
        """Effective modulus of the relaxed body on a rigid one, E/(1 - nu^2) [Pa]."""
        return self.relaxed_modulus / (1 - self.poisson_ratio**2)

    @property
    def inputs(self) -> dict[str, Any]:
        """The arguments ``modulus`` and ``solid`` of a contact with a rigid counterface."""
        return {"modulus": self.modulus, "solid": self.solid}

    def at(self, frequency: Any) -> tuple[Array, Array]:
        """Return storage and loss modulus of the series.

        Parameters
        ----------
        frequency : array_like
            Angular frequencies [rad/s].

        Returns
        -------
        tuple of ndarray
            Storage and loss modulus [Pa].
        """
        omega = np.asarray(frequency, dtype=float)
        terms = _terms(omega.ravel(), np.array(self.solid.relaxation_times)) @ np.array([1.0, *self.solid.moduli])
        storage, loss = self.relaxed_modulus * terms.reshape(2, *omega.shape)
        return storage, loss

    def _labelled(self) -> Labelled:
        storage, loss = self.at(self.frequency)
        columns = {
            "storage": ("frequency", self.storage, "Pa", "measured storage modulus"),
            "loss": ("frequency", self.loss, "Pa", "measured loss modulus"),
            "fitted_storage": ("frequency", storage, "Pa", "storage modulus of the series"),
            "fitted_loss": ("frequency", loss, "Pa", "loss modulus of the series"),
            "misfit": ((), self.misfit, "1", "rms relative deviation of the measured values"),
            "relaxed_modulus": ((), self.relaxed_modulus, "Pa", "Young's modulus at rest"),
        }
        about = {"title": "A master curve and the Prony series through it", **self.solid.parameters}
        return columns, {"frequency": ("frequency", self.frequency, "rad s-1", "angular frequency")}, about

    @property
    def headline(self) -> str:
        """What was fitted to what, and how well."""
        low, high = (f"{value:.3g}" for value in (self.frequency[0], self.frequency[-1]))
        return (
            f"Prony series of {len(self.solid.moduli)} terms through {self.frequency.size} frequencies from {low} to {high} "
            f"rad/s, {format_percent(self.misfit)} off in the mean and {format_percent(self.largest_misfit)} at most."
        )

    def _card(self) -> Card:
        pairs = zip(self.solid.relaxation_times, self.solid.moduli, strict=True)
        rows = [(format_si(time, "time"), format_si(g * self.relaxed_modulus, "pressure"), f"{g:.4g}") for time, g in pairs]
        relaxed = format_si(self.relaxed_modulus, "pressure"), format_si(self.modulus, "pressure")
        return Card(
            self.headline,
            rows=[("relaxed modulus", f"{relaxed[0]}; effective {relaxed[1]} with Poisson's ratio {self.poisson_ratio:g}")],
            table=[("relaxation time", "modulus", "over the relaxed one"), *rows],
            sentences=list(self.notes),
        )


def fit_prony(frequency: Any, storage: Any, loss: Any, *, poisson_ratio: float = 0.5) -> PronyFit:
    r"""Fit a Prony series to a complex modulus over the frequency.

    .. math:: E(t) = E_\infty \Big[1 + \sum_i g_i e^{-t/\tau_i}\Big], \qquad g_i \ge 0

    Parameters
    ----------
    frequency : array_like, shape (n,)
        Angular frequencies, positive, at least five that differ [rad/s].
    storage, loss : array_like, shape (n,)
        Storage and loss modulus there, of tension, positive [Pa].
    poisson_ratio : float
        Poisson's ratio, 0 to 0.5 [-].

    Returns
    -------
    PronyFit
        The series, how far the values lie from it, and what must be known of it.

    Raises
    ------
    InputError
        Where values are impossible or too few, or the curve shows no relaxed modulus.

    Notes
    -----
    Relaxation times lie from one over the largest to one over the smallest frequency. The series errs by ``misfit`` between
    these frequencies; beyond them it is elastic, and its error is not known. A rubber has three times the moduli of its shear.
    Source: Baumgaertel and Winter (1989), Rheol. Acta 28, 511, for the fit of both moduli in relative deviations.

    Examples
    --------
    >>> import numpy as np
    >>> import stribeck as sb
    >>> w = np.geomspace(0.1, 1e4, 26)
    >>> x = w * 1e-2
    >>> found = sb.solids.fit_prony(w, 1e6 * (1 + 2 * x**2 / (1 + x**2)), 1e6 * 2 * x / (1 + x**2))
    >>> found.misfit < 0.05, round(found.relaxed_modulus / 1e6, 2)
    (True, 1.0)
    """
    omega, moduli = _checked(frequency, storage, loss)
    nu = POISSON_RATIO.checked(poisson_ratio)
    fits = []
    for density in TIMES_PER_DECADE:
        count = max(2, math.ceil(density * math.log10(omega[-1] / omega[0])) + 1)
        times = np.geomspace(1 / omega[-1], 1 / omega[0], count)
        values = _fitted(omega, moduli, times)
        # A term that no value sees is rounding.
        seen = (_terms(omega, times) * values / moduli.ravel()[:, None]).max(axis=0)
        used = np.flatnonzero(seen[1:] > NO_SCATTER)
        if values[0] <= NO_SCATTER * moduli[0, 0] or not used.size or used.size > MAX_TERMS:
            continue
        deviation = (_terms(omega, times) @ values) / moduli.ravel() - 1
        squares = max(float(deviation @ deviation) / deviation.size, NO_SCATTER**2)
        criterion = deviation.size * math.log(squares) + (used.size + 1) * math.log(deviation.size)
        fits.append((criterion, used.size, times[used], np.append(values[0], values[1 + used]), deviation))
    if not fits:
        raise InputError(
            "the curve shows no relaxed modulus: the storage modulus falls to the lowest frequency. Measure at lower "
            "frequencies or higher temperatures, down to a plateau."
        )
    least = min(fit[0] for fit in fits)
    best = min((fit for fit in fits if fit[0] <= least + STRONG_EVIDENCE), key=lambda fit: fit[1])
    _, _, times, values, deviation = best
    relaxed, misfit = float(values[0]), float(np.sqrt(np.mean(deviation**2)))
    solid = Prony(times.tolist(), (values[1:] / relaxed).tolist())
    band = f"{omega[0]:.3g} to {omega[-1]:.3g} rad/s"
    notes = [f"Beyond {band} the series is elastic; a contact asks for u/a, speed over half-width."]
    if moduli[0, 0] > NO_PLATEAU * relaxed:
        notes.append(
            f"The storage modulus at the lowest frequency is {moduli[0, 0] / relaxed:.2g} times the relaxed modulus: the "
            "curve has no plateau there, and the relaxed modulus is what the series continues; measure at lower frequencies."
        )
    if misfit > POOR_FIT:
        limit = format_percent(POOR_FIT)
        notes.append(
            f"No series follows these values within {limit}: check that storage and loss belong together, "
            "and that all were measured at one temperature or shifted to it."
        )
    return PronyFit(omega, moduli[0], moduli[1], solid, relaxed, nu, misfit, float(np.abs(deviation).max()), tuple(notes))


def from_master_curve(path: str | os.PathLike[str], *, poisson_ratio: float = 0.5) -> PronyFit:
    """Read a complex modulus over the frequency from a table and fit a Prony series.

    Parameters
    ----------
    path : str or path-like
        A text file or spreadsheet with columns of frequency, storage and loss modulus, with units, such as
        ``frequency [Hz]; E' [MPa]; E'' [MPa]``, or a loss tangent in place of the latter; other columns are left out.
        ``rad/s`` and ``1/s`` are of an angular frequency. Moduli of shear, by their names or a line above the header, are
        multiplied by 2 (1 + nu); where nothing says what they are of they are taken for those of tension.
    poisson_ratio : float
        Poisson's ratio nu, 0 to 0.5 [-].

    Returns
    -------
    PronyFit
        See :func:`fit_prony`.

    Raises
    ------
    InputError
        Where the file cannot be read or has no such columns, holds several temperatures over a frequency that is not called
        reduced or shifted, or its values allow no fit.
    """
    # Slow to import, and most solids have no file
    from stribeck.files.columns import Column, is_called_or_signed, read_columns
    from stribeck.files.table_reading import STEP_HEADER

    advice = (
        "name the columns 'frequency [Hz]', E' [MPa] and E'' [MPa] of tension or G' [MPa] and G'' [MPa] of shear, or "
        "'tan delta' in place of the second modulus, with the units of the file"
    )
    units = {"Hz": 2 * math.pi, "kHz": 2e3 * math.pi, "MHz": 2e6 * math.pi, "rad/s": 1.0} | dict.fromkeys(PER_SECOND, 1.0)
    frequency = Column(FREQUENCY, "rotation", units, preferred=(REDUCED, ".*(?:angular|omega|ω|kreis).*"))
    signed = {name: {of: _named(*words, *said) for of, said in KINDS.items()} for name, words in MODULI.items()}
    storage, loss = (
        Column("|".join((words, *of.values())), "pressure", preferred=(of[TENSION],))
        for (words, _), of in zip(MODULI.values(), signed.values(), strict=True)
    )
    measured = {"frequency": frequency, "storage modulus": storage}
    choices = {"loss modulus": loss}, {"loss tangent": Column(LOSS_TANGENT, "number")}
    columns = read_columns(path, advice, *(measured | each for each in choices), gaps=True)
    notes, (omega, *moduli) = columns.notes, columns.in_si.values()
    if PER_SECOND & columns.units["frequency"]:
        notes += ("Frequency in 1/s was taken for the angular one, in rad/s; write Hz where it counts cycles.",)
    if not is_called_or_signed(columns.headers["frequency"], REDUCED):
        if STEP_HEADER in columns.table.header:
            notes += (
                "All tables count as measured at one temperature; keep the table of one temperature, or shift the others.",
            )
        for header in Column(TEMPERATURE, "number").names_in(columns.table):
            low, high = (float(end(columns.table.values(header), initial=np.nan)) for end in (np.fmin.reduce, np.fmax.reduce))
            if high - low > ONE_TEMPERATURE:
                raise InputError(
                    f"{path}: {show(header)} goes from {low:g} to {high:g}, and moduli of several temperatures lie on no one "
                    "curve; shift their frequencies to one temperature and call them 'reduced frequency [Hz]', or keep the "
                    "rows of one temperature."
                )
    if "loss tangent" in columns.in_si:
        moduli[1] *= moduli[0]
        notes += ("The loss modulus is the storage modulus times the loss tangent.",)
    named = {
        of: show(header)
        for name, header in columns.headers.items()
        for of, pattern in signed.get(name, {}).items()
        if is_called_or_signed(header, pattern)
    }
    above = [
        (of, f"row {row}") for of, words in KINDS_ABOVE.items() for row, text in columns.table.above if words.search(text)
    ]
    stated = named or (dict(above) if len(dict(above)) == 1 else {})
    if len(stated) > 1:
        raise InputError(
            f"{path}: {named[TENSION]} is a modulus of tension and {named[SHEAR]} one of shear; keep two of the same."
        )
    factor = 2 * (1 + POISSON_RATIO.checked(poisson_ratio)) if SHEAR in stated else 1.0
    if SHEAR in stated:
        by = f"Moduli of shear, by {stated[SHEAR]}, were multiplied by 2 (1 + nu) = {factor:g}"
        notes += (f"{by} to become those of tension.",)
    elif not stated:
        notes += ("Moduli were taken for those of tension, E' and E''; call moduli of shear G' and G'' in the header.",)
    with columns.named():
        found = fit_prony(omega, *(factor * each for each in moduli), poisson_ratio=poisson_ratio)
    return replace(found, notes=(*notes, *found.notes))


def _named(words: str, sign: str, letter: str, kind: str) -> str:
    """Return the pattern of the headers that say of what the modulus is that they name by its words or its sign."""
    signed = rf"\(?{letter}{sign}\)?"
    return (
        rf"(?:{kind}) ?(?:{words})(?:[ ,]*{signed})?|(?:(?:{words})[ ,]*)?{signed}|(?:{words})[ ,]+\(?(?:{kind})\)?|"
        rf"{letter} (?:{words})|{signed}[ ,]+\(?(?:{words})\)?"
    )


def _terms(omega: Array, times: Array) -> Array:
    """Return the matrix from the relaxed modulus and those of the terms to storage and loss, one after the other."""
    x = omega[:, None] * times
    rest = np.concatenate((x**2 / (1 + x**2), x / (1 + x**2)))
    return np.concatenate((np.repeat([1.0, 0.0], omega.size)[:, None], rest), axis=1)


def _fitted(omega: Array, moduli: Array, times: Array) -> Array:
    """Return the relaxed modulus and those of the terms, none negative."""
    from scipy.optimize import nnls  # slow to import

    scale = float(moduli[0, 0])
    values, _ = nnls(_terms(omega, times) * (scale / moduli.ravel())[:, None], np.ones(moduli.size))
    return np.asarray(scale * values)


def _checked(frequency: Any, storage: Any, loss: Any) -> tuple[Array, Array]:
    """Return frequencies, rising, and both moduli in rows."""
    advice = {"frequency": " Is it a logarithm? Give the frequency itself."}
    omega, *moduli = positive_columns({"frequency": frequency, "storage modulus": storage, "loss modulus": loss}, advice)
    if np.unique(omega).size < MIN_VALUES:
        raise InputError(f"moduli at {np.unique(omega).size} different frequencies; a series needs {MIN_VALUES} or more.")
    return omega, np.array(moduli)
