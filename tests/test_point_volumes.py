"""A power law under a ball against finite volumes in the plane, with the film's own gap: another grid, another flow across it.

The columns are integrals of the fluidity by Gauss's rule and the law itself [Dowson 1962], the pressure a Picard iteration of
their secants: no table, no weak form, no film beyond the rim.
"""

import math

import numpy as np
import pytest
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import spsolve

import stribeck as sb
from stribeck.equations.point.observables import FrictionWithin
from stribeck.fluids import PowerLaw

INNER, OUTER, RINGS, ANGLES = 0.03, 80.0, 80, 32
Z, WEIGHTS = (0.5 * each[:, None] for each in np.polynomial.legendre.leggauss(24))


def across(exponent, gradient, slip):
    """Return the mean stress, and the integrals of the fluidity times powers of the place across the film."""
    power, mean = 1 / exponent - 1, np.hypot(*slip) ** (exponent - 1) * slip

    def stresses():
        stress = mean[:, None] + gradient[:, None] * Z
        return stress, np.hypot(*stress), WEIGHTS * np.hypot(*stress) ** power

    for _ in range(60):
        stress, size, fluidity = stresses()
        left = slip - (fluidity * stress).sum(axis=1)
        xx, xy, yy = (
            (fluidity * (own + power * stress[i] * stress[j] / size**2)).sum(axis=0)
            for i, j, own in ((0, 0, 1.0), (0, 1, 0.0), (1, 1, 1.0))
        )
        step = np.stack([yy * left[0] - xy * left[1], xx * left[1] - xy * left[0]]) / (xx * yy - xy**2)
        length = np.hypot(*step) / np.maximum(np.hypot(*mean), np.hypot(*gradient))
        mean = mean + step / np.maximum(1.0, length)
        if length.max() < 1e-9:
            break
    fluidity = stresses()[2]
    return mean, *((fluidity * Z**k).sum(axis=0) for k in range(3))


class Faces:
    """Faces of the cells at these radii and angles: what goes with the walls, and with the pressure gradient."""

    def __init__(self, gap, radii, angles):
        self.r, theta = np.meshgrid(radii, angles, indexing="ij")
        self.h, self.along = gap(self.r, theta), np.stack([np.cos(theta), -np.sin(theta)])

    def flow(self, speed, time, exponent, gradient):
        slip, shape = -speed * time / self.h * self.along, gradient.shape
        mean, f0, f1, f2 = across(exponent, (6 * time * self.h * gradient).reshape(2, -1), slip.reshape(2, -1))
        mobility = (12 * (f2 - f1**2 / f0)).reshape(shape[1:]) * self.h**3
        carried = 2 * self.h**2 / time * (f1 / f0).reshape(shape[1:]) * slip - speed * self.h * self.along
        return mobility, carried, mean.reshape(shape)


def volumes(gap, speed, time, exponent):
    """Return radii, angles and the film pressure there, and the drag of the sliding on each ring of faces."""
    high, wide = math.log(OUTER / INNER) / RINGS, math.pi / ANGLES
    faces, centres = INNER * np.exp(np.arange(RINGS + 1) * high), INNER * np.exp((np.arange(RINGS) + 0.5) * high)
    theta = (np.arange(ANGLES) + 0.5) * wide
    rings, rays = Faces(gap, faces, theta), Faces(gap, centres, np.arange(1, ANGLES) * wide)
    falls = math.exp(-(1 + 2 * exponent) * high)  # far away rates fall as 1/r**2
    p, index = np.zeros((RINGS, ANGLES)), np.arange(RINGS * ANGLES).reshape(RINGS, ANGLES)
    for turn in range(40):
        full = np.concatenate([p[:1], p, falls * p[-1:]])
        on_rings, on_rays = (
            np.pad(0.5 * (full[1:] + full[:-1]), ((0, 0), (1, 1)), mode="edge"),
            0.5 * (full[:, 1:] + full[:, :-1]),
        )
        in_rings = np.stack([np.diff(full, axis=0) / high, (on_rings[:, 2:] - on_rings[:, :-2]) / (2 * wide)]) / rings.r
        in_rays = np.stack([(on_rays[2:] - on_rays[:-2]) / (2 * high), np.diff(p, axis=1) / wide]) / rays.r
        eased, moved, stress = rings.flow(speed, time, exponent, in_rings)
        eased_across, moved_across, _ = rays.flow(speed, time, exponent, in_rays)
        moved, moved_across = moved[0] * rings.r * wide, moved_across[1] * rays.r * high
        right = moved[:-1] - moved[1:]
        right[:, :-1] -= moved_across
        right[:, 1:] += moved_across
        rows, columns, values = [index[-1]], [index[-1]], [eased[-1] / high * wide * (falls - 1)]
        for before, after, ease in (
            (index[:-1], index[1:], eased[1:-1] / high * wide),
            (index[:, :-1], index[:, 1:], eased_across / wide * high),
        ):
            for row, column, sign in ((before, after, 1), (before, before, -1), (after, after, -1), (after, before, 1)):
                rows.append(row.ravel()), columns.append(column.ravel()), values.append(sign * ease.ravel())
        places = np.concatenate(rows), np.concatenate(columns)
        change = spsolve(coo_matrix((np.concatenate(values), places)).tocsc(), right.ravel()).reshape(p.shape) - p
        p = p + (0.6 if turn else 1.0) * change
        if np.abs(change).max() < 1e-6 * np.abs(p).max():
            break
    drag = -(stress * rings.along).sum(axis=(0, 2)) * 2 * wide / (6 * time)
    return centres, theta, p, faces, drag


def test_film_and_drag_of_a_power_law_are_those_of_finite_volumes():
    speed, exponent, time = 3.0, 0.5, 1.0 / 3.0
    groups = sb.Groups(speed, 1e-3, 1e-4, geometry="point")
    state = sb.solve(groups, fluid=PowerLaw(speed * time, exponent), rtol=1e-3).state
    level = state.work.fine
    assert level.equations.film.film.law.time == pytest.approx(time)

    def fields(r, theta):
        return state.fields(r * np.cos(theta), r * np.sin(theta))

    radii, theta, p, faces, drag = volumes(lambda *at: fields(*at).gap, speed, time, exponent)
    there = fields(*np.meshgrid(radii, theta, indexing="ij")).fluid_pressure
    assert np.abs(p - there).max() < 1.5e-2 * there.max()
    far = radii > 3.0  # the cells are of second order: 4e-3 to 6e-3 with half as many
    first, known = (each[far] @ np.cos(theta) for each in (p, there))
    np.testing.assert_allclose(first, known, rtol=2.5e-3)
    end = np.searchsorted(faces, 8.0)
    within = FrictionWithin.of(level.equations, level.unknowns, state.values)
    log = math.log(faces[end])
    expected = within(0, log) + state.values["J_couette"] + level.equations.far.couette * speed * log
    per_log = drag * faces**2  # of the radius
    found = math.log(OUTER / INNER) / RINGS * (per_log[: end + 1].sum() - 0.5 * (per_log[0] + per_log[end]))
    assert found == pytest.approx(expected, rel=3e-3)
