r"""Which free inputs the data determine, and which only in combination.

The derivatives of the residuals, in units of the noise, are J = U S V^T: the data determine the combination
:math:`v_k^T \theta` of logarithms with standard error :math:`1/S_k`.  One whose 95 % interval is wider than a factor of
ten counts as not determined.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from stribeck._types import Array
from stribeck.asperity_friction.coulomb import Coulomb
from stribeck.contacts.parts import KINDS
from stribeck.fits.free_inputs import FreeInput
from stribeck.fits.model import Prediction
from stribeck.quantities.docstrings import Described

__all__ = ["Unidentifiable", "undetermined"]

# Standard error of a logarithm from which the 95 % interval is wider than a factor of ten.
WIDEST = math.log(10.0) / (2 * 1.959963984540054)

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
    """Return a basis of the undetermined directions of which each has as few inputs as possible.

    Gauss elimination with the largest element as pivot: where two pairs of inputs are tied, the singular vectors mix them.
    """
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
        ties = [_tie(names[0], names[j], exponents[0], exponents[j]) for j in range(1, len(part))]
        how = "does not change" if exact else "hardly changes"
        reasons = [
            f"{labels[i]}: {_reason(free[i], prediction)}"
            for i in part
            if _weak_alone(jacobian[:, i]) or _off_plateau(free[i], prediction)
        ]
        because = f" ({'; '.join(reasons)})" if reasons else ""
        message = (
            f"{_listed(names)} cannot be determined separately: the predicted friction {how} when {_changed(names, exponents)}"
            f"{because}; the data give only {_listed(ties)}. Fix one of them, or give a prior."
        )
    return Unidentifiable(names, exponents, error, message)


def _weak_alone(column: Array) -> bool:
    return float(np.linalg.norm(column)) * WIDEST < 1


def _off_plateau(free: FreeInput, prediction: Prediction) -> bool:
    """Return whether no row determines the size of the friction of asperities by itself."""
    return free.name in SIZES and float(prediction.contact_share.max()) < 0.5


def _tie(first: str, other: str, a: float, b: float) -> str:
    """Return the combination of two inputs that does not change along the direction (a, b)."""
    power = a / b
    size = "" if abs(abs(power) - 1) < 0.02 else f"^{abs(power):.2g}"
    return f"{first} {'/' if power > 0 else 'x'} {other}{size}"


def _changed(names: Sequence[str], exponents: Sequence[float]) -> str:
    """Return how inputs change along a direction, in words."""
    if all(abs(e - 1) < 0.02 for e in exponents):
        return "all are multiplied by one factor" if len(names) > 2 else "both are multiplied by one factor"
    powers = ["f" if abs(e - 1) < 0.02 else f"f^{e:.2g}" for e in exponents]
    return _listed([f"{name} is multiplied by {power}" for name, power in zip(names, powers, strict=True)])


def _listed(words: Sequence[str]) -> str:
    *others, last = words
    return f"{', '.join(others)} and {last}" if others else last


def _reason(free: FreeInput, prediction: Prediction) -> str:
    """Return why the data do not determine an input, in terms of the fitted curve."""
    error = float((prediction.error / prediction.friction).max())
    # A share below its error is said to be that at most.
    asperities, fluid = (max(float(part.max()), error) for part in (prediction.contact_share, prediction.fluid_share))
    if free.name in SIZES:
        return (
            f"asperities cause at most {_percent(asperities)} of the friction in any row, and a curve without a boundary "
            "plateau cannot give it"
        )
    loads = prediction.load_share
    if free.name in ("roughness", "alpha") and float(loads.min()) > 0.9:
        return (
            f"asperities carry at least {_percent(float(loads.min()))} of the load in every row: the data "
            f"say little about the gap"
        )
    if free.name in ("roughness", "alpha", "beta") and asperities < 0.1:
        return f"asperities cause at most {_percent(asperities)} of the friction in any row"
    if fluid < 0.1 and float(loads.min()) > 0.5:
        return f"the fluid causes at most {_percent(fluid)} of the friction in any row, all of them near the boundary plateau"
    return "no row changes with it by more than the noise"


def _percent(part: float) -> str:
    return f"{100 * part:.2g} %"
