"""The check of a shape that somebody else wrote: its gap and its slope must agree."""

from __future__ import annotations

from typing import Any

import numpy as np

from stribeck.profiles.profile import Profile
from stribeck.quantities.units import InputError, show
from stribeck.quantities.user_part import check_user_part, refusal

__all__ = ["as_profile"]

REQUIRED_MEMBERS = ("gap", "slope", "places", "parameters")

CHECKED_DISTANCES = np.geomspace(1e-6, 1.0, 13)  # Distances from a kink, or from zero, of a shape of unknown size
SLOPE_RTOL = 1e-4  # Difference of the slope from differences of the gap over the largest slope nearby
STEP = 1e-6  # Step of these differences over the distance


def as_profile(profile: Any) -> Profile:
    """Return what users give as a shape; refuse what is none, or contradicts itself."""
    if isinstance(profile, type) or not all(hasattr(profile, member) for member in REQUIRED_MEMBERS):
        raise InputError(
            f"profile = {show(profile)}; give one of sb.profiles such as Land('0.4 mm', '1 mm'), or an object with "
            f"{', '.join(REQUIRED_MEMBERS)}."
        )
    check_user_part("profile", profile, _check_slope)
    found: Profile = profile
    return found


def _check_slope(profile: Profile) -> None:
    """Refuse a shape whose slope is not the derivative of its gap at any distance from the first of its kinks."""
    middle = next(iter(profile.places), 0.0)
    x = middle + np.concatenate([-CHECKED_DISTANCES, CHECKED_DISTANCES])
    step = STEP * np.abs(x - middle)
    gap, slope = (np.asarray(each(x), dtype=float) for each in (profile.gap, profile.slope))
    if gap.shape != x.shape or slope.shape != x.shape:
        raise refusal("profile", profile, "gap and slope must return a number for each place.")
    found = (profile.gap(x + step) - profile.gap(x - step)) / (2 * step)
    rounding = 4 * np.finfo(float).eps * np.abs(gap) / step
    wrong = np.abs(found - slope) - rounding > SLOPE_RTOL * np.maximum(np.abs(slope).max(), np.abs(found).max())
    if wrong.any():
        place = x[np.argmax(wrong)]
        raise refusal("profile", profile, f"its slope is not the derivative of its gap at x = {place:.3g}.")
