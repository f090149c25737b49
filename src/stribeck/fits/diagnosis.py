r"""What is to be seen on a fit: which free inputs the data determine, and whether the residuals are noise.

The derivatives of the residuals, in units of the noise, are J = U S V^T: the data determine the combination
:math:`v_k^T \theta` of logarithms with standard error :math:`1/S_k`.  One whose 95 % interval is wider than a factor of
ten counts as not determined.

Residuals are judged by their size where errors are known, and by their order along the curves always.  Both statistics of
order are judged by drawing: white noise, made a residual by the same linearised fit, :math:`(I - J J^+) \epsilon`, so that
what the fit takes out of the noise is counted.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from stribeck._types import Array, Indices
from stribeck.asperity_friction.coulomb import Coulomb
from stribeck.contacts.parts import KINDS
from stribeck.fits.free_inputs import FreeInput
from stribeck.fits.least_squares import MAD, NEAR, Minimum
from stribeck.fits.model import Prediction
from stribeck.quantities.docstrings import Described
from stribeck.quantities.formats import format_percent
from stribeck.quantities.standard_errors import INTERVAL_95
from stribeck.quantities.units import listed

# Standard error of a logarithm from which the 95 % interval is wider than a factor of ten.
WIDEST = math.log(10.0) / (2 * INTERVAL_95)

SIZES = (Coulomb.size, *(law.size for law in KINDS["asperity_friction"].laws.values() if law is not None))

PART_OF = 0.1  # Component of a direction, the largest being one, from which an input has a part in it

EXACT = 1e-6  # Singular value, over the largest, below which no measurement of the kind could tell the inputs apart


@dataclass(frozen=True)
class Unidentifiable(Described):
    """A combination of free inputs that the data do not determine."""

    names: Annotated[tuple[str, ...], "the inputs that have a part in it"]
    exponents: Annotated[tuple[float, ...], "powers with which they may change together, the largest being one"]
    standard_error: Annotated[
        float, "standard error of the logarithm of the combination by the data alone; infinite where nothing bounds it"
    ]
    message: Annotated[str, "which, and why"]


def undetermined(
    free: Sequence[FreeInput], labels: Sequence[str], jacobian: Array, prediction: Prediction
) -> tuple[Unidentifiable, ...]:
    """Return the combinations of free inputs that the data do not determine."""
    _, S, V = np.linalg.svd(jacobian, full_matrices=True)
    S = np.append(S, np.zeros(len(free) - len(S)))
    weak = [k for k in range(len(free)) if S[k] * WIDEST < 1]
    if not weak:
        return ()
    return tuple(
        _described(free, labels, direction, error, bool(error * S[0] > 1 / EXACT), jacobian, prediction)
        for direction, error in _sparse(V[weak], S[weak])
    )


def _sparse(directions: Array, S: Array) -> list[tuple[Array, float]]:
    """Return a basis of the undetermined directions of which each has as few inputs as possible."""
    # Gauss elimination with the largest element as pivot: where two pairs of inputs are tied, the singular vectors mix them.
    rows = directions.copy()
    errors = np.divide(1.0, S, out=np.full_like(S, np.inf), where=S > 0)
    used: list[int] = []
    for k in range(len(rows)):
        free = [j for j in range(rows.shape[1]) if j not in used]
        pivot = max(free, key=lambda j: abs(rows[k, j]))
        used.append(pivot)
        for other in range(len(rows)):
            if other != k and rows[k, pivot] != 0:
                rows[other] -= rows[k] * (rows[other, pivot] / rows[k, pivot])
    found = []
    for row, error in zip(rows, errors, strict=True):
        size = float(np.abs(row).max())
        if size > 0:
            found.append((row / row[int(np.argmax(np.abs(row)))], float(error)))
    return sorted(found, key=lambda pair: -pair[1])


def _described(
    free: Sequence[FreeInput],
    labels: Sequence[str],
    direction: Array,
    error: float,
    exact: bool,
    jacobian: Array,
    prediction: Prediction,
) -> Unidentifiable:
    part = [i for i in range(len(free)) if abs(direction[i]) >= PART_OF]
    names = tuple(labels[i] for i in part)
    exponents = tuple(float(direction[i]) for i in part)
    if len(part) == 1:
        message = f"{names[0]} cannot be determined from these data: {_reason(free[part[0]], prediction)}."
    else:
        ties = [product_text(names[0], names[j], -exponents[0] / exponents[j]) for j in range(1, len(part))]
        how = "does not change" if exact else "hardly changes"
        # Those that no row determines by itself: the size of the friction of asperities needs a boundary plateau.
        is_off_plateau = float(prediction.contact_share.max()) < 0.5
        alone = [i for i in part if np.linalg.norm(jacobian[:, i]) * WIDEST < 1 or (free[i].name in SIZES and is_off_plateau)]
        reasons = [f"{labels[i]}: {_reason(free[i], prediction)}" for i in alone]
        because = f" ({'; '.join(reasons)})" if reasons else ""
        message = (
            f"{listed(names)} cannot be determined separately: the predicted friction {how} when {_changed(names, exponents)}"
            f"{because}; the data give only {listed(ties)}. Fix one of them, or give a prior."
        )
    return Unidentifiable(names, exponents, error, message)


def product_text(first: str, other: str, power: float) -> str:
    """Return the product of an input and a power of another in words."""
    size = "" if abs(abs(power) - 1) < 0.02 else f"^{abs(power):.2g}"
    return f"{first} {'x' if power > 0 else '/'} {other}{size}"


def _changed(names: Sequence[str], exponents: Sequence[float]) -> str:
    """Return how inputs change along a direction, in words."""
    if all(abs(e - 1) < 0.02 for e in exponents):
        return "all are multiplied by one factor" if len(names) > 2 else "both are multiplied by one factor"
    powers = ["f" if abs(e - 1) < 0.02 else f"f^{e:.2g}" for e in exponents]
    return listed([f"{name} is multiplied by {power}" for name, power in zip(names, powers, strict=True)])


def _reason(free: FreeInput, prediction: Prediction) -> str:
    """Return why the data do not determine an input, in terms of the fitted curve."""
    error = float((prediction.error / prediction.friction).max())
    # A share below its error is said to be that at most.
    asperities, fluid = (max(float(part.max()), error) for part in (prediction.contact_share, 1 - prediction.contact_share))
    if free.name in SIZES:
        return (
            f"asperities cause at most {format_percent(asperities)} of the friction in any row, and a curve without a "
            "boundary plateau cannot give it"
        )
    loads = prediction.load_share
    if free.name in ("roughness", "alpha") and float(loads.min()) > 0.9:
        return (
            f"asperities carry at least {format_percent(float(loads.min()))} of the load in every row: the data "
            f"say little about the gap"
        )
    if free.name in ("roughness", "alpha", "beta") and asperities < 0.1:
        return f"asperities cause at most {format_percent(asperities)} of the friction in any row"
    if fluid < 0.1 and float(loads.min()) > 0.5:
        most = f"at most {format_percent(fluid)} of the friction"
        return f"the fluid causes {most} in any row, all of them near the boundary plateau"
    return "no row changes with it by more than the noise"


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
        of_scatter = "Intervals of a robust fit follow from the scatter of the residuals, not from the errors given."
        wider, narrower = "Intervals are wider by this factor.", "Intervals are too wide by this factor."
        if at.objective.robust:
            wider = narrower = of_scatter
        if probability < SIGNIFICANT:
            messages.append(
                f"Residuals are larger than the errors given (chi squared {total:.3g} for {degrees_of_freedom:.3g} degrees "
                f"of freedom, p = {probability:.1g}): the errors are too small by a factor {math.sqrt(ratio):.2g}, there "
                f"are outliers, or the model misses something. {wider}"
            )
        elif probability > 1 - SIGNIFICANT / 10:
            messages.append(
                f"Residuals are smaller than the errors given (chi squared {total:.3g} for {degrees_of_freedom:.3g} degrees "
                f"of freedom): the errors are too large by a factor {1 / math.sqrt(ratio):.2g}. {narrower}"
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
    # With one degree of freedom all draws are alike but for what the iteration left of the way to the optimum.
    alike = NEAR / max(float(np.linalg.norm(at.residuals)), NEAR)
    tails = [float((1 + (each[1:] >= each[0] - alike).sum()) / (1 + DRAWS)) for each in (correlation, slow)]
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
