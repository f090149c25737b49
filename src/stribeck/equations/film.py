"""The film at the nodes of a mesh: its pressure gradient where it is full, zero in the cavity."""

from __future__ import annotations

import numpy as np

from stribeck._types import Array, Indices, Numbers
from stribeck.fluids.fluid import Film, Slopes
from stribeck.numerics.running_integral import RunningIntegral

__all__ = ["by_pressure_of", "gradient_in_film", "slopes_in_film"]


def gradient_in_film(film: Film, integral: RunningIntegral, h: Array, p: Array | None, flux_gap: Numbers) -> Array:
    """Return G at the nodes where the film is full, zero in the cavity."""
    if integral.reformation == 0.0:
        return film.gradient(h, p, flux_gap)
    wet = integral.filled
    return scattered(film.gradient(h[..., wet], None if p is None else p[..., wet], flux_gap), wet, h)


def slopes_in_film(film: Film, integral: RunningIntegral, h: Array, p: Array | None, flux_gap: Numbers) -> Slopes:
    """Return the derivatives of G at the nodes where the film is full, zero in the cavity."""
    if integral.reformation == 0.0:
        return film.slopes(h, p, flux_gap)
    wet = integral.filled
    by_gap, by_pressure, by_flux, by_speed = film.slopes(h[..., wet], None if p is None else p[..., wet], flux_gap)
    return Slopes(
        scattered(by_gap, wet, h),
        None if by_pressure is None else scattered(by_pressure, wet, h),
        scattered(by_flux, wet, h),
        None if by_speed is None else scattered(by_speed, wet, h),
    )


def by_pressure_of(slopes: Slopes) -> Array:
    """Return the derivative by pressure of a film that has one."""
    assert slopes.by_pressure is not None
    return slopes.by_pressure


def scattered(values: Array, where: Indices, like: Array) -> Array:
    """Return nodal values that are ``values`` at some nodes and zero at the others."""
    found = np.zeros(like.shape)
    found[..., where] = values
    return found
