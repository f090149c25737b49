r"""Whether the residuals of a fit are noise: their size where errors are known, their order along the curves always.

Both statistics of order are judged by drawing: white noise, made a residual by the same linearised fit,
:math:`(I - J J^+) \epsilon`, so that what the fit takes out of the noise is counted.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from stribeck._types import Array, Indices
from stribeck.fits.least_squares import MAD, Minimum
from stribeck.quantities.docstrings import Described

__all__ = ["Quality", "excess_of", "judge_residuals"]

DRAWS = 4000
SEED = 20_261_121
WAVES = 6  # Slowest waves along each curve whose part of the residuals is judged

SIGNIFICANT = 0.01  # Probability below which a test speaks

CLIP = 3.0  # Residual, in standard deviations, at which it is cut for the tests of order, so that an outlier is no structure


@dataclass(frozen=True)
class Quality(Described):
    """What the residuals say about a fit."""

    chi_squared: Annotated[float, "sum of squared residuals over their known errors; nan where the errors are not known"]
    degrees_of_freedom: Annotated[float, "rows less free inputs that the data determine"]
    chi_squared_probability: Annotated[float, "probability of a larger sum by chance; nan where the errors are not known"]
    autocorrelation: Annotated[float, "correlation of residuals with the next along the curves [-]"]
    structure_probability: Annotated[float, "probability of residuals as ordered as these by chance"]
    messages: Annotated[tuple[str, ...], "what a test found, one sentence each; empty where residuals look like noise"]


def excess_of(chi_squared: float, degrees_of_freedom: float) -> float:
    """Return by how much the variance of residuals exceeds that of the errors given; 1 where chance may make it so."""
    from scipy.stats import chi2

    if chi2.sf(chi_squared, degrees_of_freedom) >= SIGNIFICANT:
        return 1.0
    return chi_squared / degrees_of_freedom


def judge_residuals(at: Minimum, curve: Indices, degrees_of_freedom: float) -> Quality:
    """Return what the residuals of a fit say about it."""
    from scipy.stats import chi2

    r, known = at.residuals, at.objective.sigma is not None
    messages = []
    total, probability = math.nan, math.nan
    if known:
        total = float(r @ r)
        probability = float(chi2.sf(total, degrees_of_freedom))
        ratio = total / degrees_of_freedom
        if probability < SIGNIFICANT:
            messages.append(
                f"Residuals are larger than the errors given (chi squared {total:.3g} for {degrees_of_freedom:.3g} degrees "
                f"of freedom, p = {probability:.1g}): the errors are too small by a factor {math.sqrt(ratio):.2g}, there "
                "are outliers, or the model misses something. Intervals are wider by this factor."
            )
        elif probability > 1 - SIGNIFICANT / 10:
            messages.append(
                f"Residuals are smaller than the errors given (chi squared {total:.3g} for {degrees_of_freedom:.3g} degrees "
                f"of freedom): the errors are too large by a factor {1 / math.sqrt(ratio):.2g}, and so are the intervals."
            )
    autocorrelation, structure = _structure(at, curve)
    if structure < SIGNIFICANT:
        shown = f"p < {2 / DRAWS:.1g}" if structure < 2 / DRAWS else f"p = {structure:.1g}"
        messages.append(
            f"Residuals have structure along the speed ({shown}, autocorrelation {autocorrelation:.2f}): these data do not "
            "follow the model with the inputs that are free, and neither the values nor their intervals hold the misfit."
        )
    return Quality(total, degrees_of_freedom, probability, autocorrelation, structure, tuple(messages))


def _structure(at: Minimum, curve: Indices) -> tuple[float, float]:
    """Return the autocorrelation and the probability of the order of the residuals by chance."""
    n = len(at.residuals)
    _, weights = at.objective.influence(at.residuals)
    rows, _ = at.objective.priors
    J = at.jacobian * np.sqrt(np.clip(weights, 0.0, 1.0))[:, None]
    U, S, _ = np.linalg.svd(np.concatenate([J, rows]), full_matrices=False)
    U = U[:n, S > 1e-10 * S[0]]
    noise = np.random.default_rng(SEED).standard_normal((DRAWS, n))
    drawn = np.concatenate([at.residuals[None], noise - noise @ U @ U.T])
    spread = np.maximum(MAD * np.median(np.abs(drawn), axis=1, keepdims=True), 1e-300)
    drawn = np.clip(drawn / spread, -CLIP, CLIP)
    power = (drawn**2).sum(axis=1)
    following = curve[1:] == curve[:-1]
    correlation = (drawn[:, 1:] * drawn[:, :-1])[:, following].sum(axis=1) / power
    slow = ((drawn @ _waves(curve)) ** 2).sum(axis=1) / power
    tails = [float((1 + (each[1:] >= each[0]).sum()) / (1 + DRAWS)) for each in (correlation, slow)]
    return float(correlation[0]), min(1.0, 2 * min(tails))


def _waves(curve: Indices) -> Array:
    """Return orthonormal cosines along each curve, shape (n, waves)."""
    columns = []
    for k in np.unique(curve):
        rows = np.nonzero(curve == k)[0]
        m = len(rows)
        for order in range(min(WAVES, max(1, m // 4))):
            column = np.zeros(len(curve))
            column[rows] = np.cos(math.pi * order * (np.arange(m) + 0.5) / m)
            columns.append(column / np.linalg.norm(column))
    return np.array(columns).T
