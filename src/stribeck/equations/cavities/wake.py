r"""The wake of a ball: streaks of liquid from wall to wall in the cavity, with the flow at the line of rupture.

Where the film is cavitated the pressure is the same everywhere and the liquid goes with the walls, so that along x

.. math:: \phi \, h = h_\mathrm{e}(y) + s S(h_\mathrm{e}), \qquad \phi \le 1

with the gap :math:`h_\mathrm{e}` at which the film ruptures; :math:`\phi` is the part of the width that is wet.  The
right-hand side is the volume that flows there over the mean speed of the walls, between smooth walls that gap.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import legendre

from stribeck._types import Array, Indices
from stribeck.numerics.fourier_panels import PolarMesh
from stribeck.numerics.settings import MAX_DEGREE

GAUSS_POINTS, GAUSS_WEIGHTS = legendre.leggauss(MAX_DEGREE)  # Of integrals over the angles of the wake


@dataclass(frozen=True, eq=False)
class Rupture:
    """The line at which a film ruptures."""

    rings: Indices  # Rings that it crosses
    angles: Array  # Where it crosses them; nearer to the middle line the film is cavitated
    distances: Array  # Distances from the middle line, ascending from zero [a]
    gaps: Array  # Gap at these distances over one plus their square

    def gap_at(self, across: Array) -> Array:
        """Return the gap at the line by the distance from the middle line [u_Hz]."""
        return np.asarray(np.exp(np.interp(across, self.distances, np.log(self.gaps))) * (1.0 + across**2))


def rupture_line(mesh: PolarMesh, gap: Array, fluid: Array) -> Rupture | None:
    """Return the line at which a film ruptures; None if it does not."""
    cavitated = fluid <= 0.0
    rings = np.flatnonzero(cavitated[0] & ~cavitated[-1] & ~cavitated[-2])
    if not rings.size:
        return None
    last = np.minimum(mesh.modes - 1 - np.argmax(cavitated[::-1, rings], axis=0), mesh.modes - 4)
    first, second, third = (np.sqrt(np.maximum(fluid[last + k, rings], 0.0)) for k in (1, 2, 3))
    with np.errstate(all="ignore"):  # inverse interpolation, in spacings
        bend = (1.0 / (third - second) - 1.0 / (second - first)) / (third - first)
        back = np.clip(first / (second - first) - bend * first * second, 0.0, 1.0)
    back[np.isnan(back)] = 0.5
    angles = mesh.angles[last + 1] - back * (np.pi / mesh.modes)
    coefficients = mesh.to_modes @ np.log(gap[:, rings])
    log_gap = (np.cos(np.outer(np.arange(mesh.modes), angles)) * coefficients).sum(axis=0)
    between, log_between = _between_rings(mesh, gap, fluid)
    distances = np.append(mesh.radii[rings] * np.sin(angles), between)
    order = np.argsort(distances, kind="stable")
    distances = distances[order]
    gaps = np.exp(np.append(log_gap, log_between)[order]) / (1.0 + distances**2)
    return Rupture(rings, angles, np.append(0.0, distances), np.append(gaps[:1], gaps))


def _between_rings(mesh: PolarMesh, gap: Array, fluid: Array) -> tuple[Array, Array]:
    """Return distances from the middle line, and logarithms of gaps, where the line passes from one ring to the next."""
    # Behind a slow contact the line follows its edge, a circle, so that no ring crosses it but at the sides.
    film = fluid > 0.0
    ends = film[:, :-2] & film[:, 1:-1] & ~film[:, 2:]
    columns = np.flatnonzero(ends.any(axis=1))
    last = 1 + np.argmax(ends[columns], axis=1)
    inner, outer = np.sqrt(fluid[columns, last - 1]), np.sqrt(fluid[columns, last])
    width = mesh.radii[last + 1] - mesh.radii[last]
    with np.errstate(all="ignore"):  # the root of the pressure falls evenly to zero
        beyond = outer / (inner - outer) * (mesh.radii[last] - mesh.radii[last - 1]) / width
    part = np.where(inner > outer, np.minimum(beyond, 1.0), 1.0)
    log_gap = (1.0 - part) * np.log(gap[columns, last]) + part * np.log(gap[columns, last + 1])
    return (mesh.radii[last] + part * width) * np.sin(mesh.angles[columns]), log_gap


def shear_missing(
    mesh: PolarMesh,
    gap: Array,
    fluid: Array,
    filled: Callable[[Array], Array] = np.ones_like,
    sheared: Callable[[Array], Array] = np.ones_like,
) -> Array:
    r"""Return the shear missing on each ring in the dry streaks of the wake, :math:`r \oint (1 - \phi) \, \tau/h`."""
    # By the gap, ``filled`` gives the volume that the walls carry in a full gap over the gap, ``sheared`` the sliding drag
    # over a Newtonian fluid's.
    found = np.zeros(mesh.rings)
    line = rupture_line(mesh, gap, fluid)
    if line is None:
        return found
    angle = 0.5 * line.angles[:, None] * (1.0 + GAUSS_POINTS)
    coefficients = mesh.to_modes @ np.log(gap[:, line.rings])
    waves = np.cos(angle[:, :, None] * np.arange(mesh.modes))
    h = np.exp(np.matmul(waves, coefficients.T[:, :, None])[:, :, 0])
    r = mesh.radii[line.rings]
    at_line = line.gap_at(r[:, None] * np.sin(angle))
    wet = np.minimum(1.0, filled(at_line) * at_line / h)
    found[line.rings] = ((1.0 - wet) * sheared(h) / h) @ GAUSS_WEIGHTS * line.angles * r  # both halves of the plane
    return found
