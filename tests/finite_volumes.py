"""A film that ends, by finite volumes that conserve mass: another discretisation of the same contact, and of no cavity's edge.

Unknowns are gap, fluid pressure and void fraction of each cell.  Where the film is full the void is zero, where it is torn the
pressure is, by the function of Fischer and Burmeister.  Couette flow goes upwind, the flow by pressure between neighbouring
cells; the deflection is that of pressures constant on each cell.  First order in the width of a cell, so that two widths
extrapolate to the second.
"""

import numpy as np

import stribeck as sb
from stribeck.contacts.groups import contact_law
from stribeck.numerics.dual import with_slope

REACH = 2.0
"""Half of the width that is covered [a]; pressures beyond are zero."""


def influence(x, dx):
    """Return the matrix from cell pressures to the deflection at the middles [u_Hz per p_Hz], as of the half-plane."""
    distance = x[:, None] - x
    ahead, behind = (end * (np.log(np.abs(end)) - 1) for end in (distance + 0.5 * dx, distance - 0.5 * dx))
    return -(ahead - behind) / np.pi


def film(groups, cells, start, most_steps=60):
    """Return gap, fluid pressure and void fraction of the cells, and the flux gap.

    ``start`` is a solution whose gap Newton's method starts from; its film need not end.
    """
    dx = 2 * REACH / cells
    x = -REACH + dx * (np.arange(cells) + 0.5)
    profile = start.profile(x)
    p = np.maximum(profile.fluid_pressure, 0.0)
    c = np.where((p > 0) | (x < 0), 0.0, np.maximum(1 - start.flux_gap / profile.gap, 0.0))
    y = np.concatenate([profile.gap, p, c, [start.offset]])
    D, law = influence(x, dx), contact_law(groups)
    for _ in range(most_steps):
        residual, jacobian = system(y, x, dx, D, float(groups.speed), law)
        step = np.linalg.solve(jacobian, -residual)
        relative = np.abs(step[:cells] / y[:cells]).max()
        y += min(1.0, 0.3 / relative) * step
        if relative < 1e-8:
            h, p, c = y[:-1].reshape(3, cells)
            return x, h, p, c
    raise ArithmeticError("the finite volumes found no film")


def system(y, x, dx, D, speed, law):
    """Return the residual and its derivative: gap, mass, Fischer and Burmeister's function, load."""
    n = len(x)
    h, p, c = y[:-1].reshape(3, n)
    contact = law.pressure(h)
    slope = with_slope(law.pressure, h)[1]
    residual, jacobian = np.zeros_like(y), np.zeros((3 * n + 1, 3 * n + 1))
    gap, mass, void = (slice(k * n, (k + 1) * n) for k in range(3))
    residual[gap] = h - y[-1] - 0.5 * x**2 - D @ (p + contact)
    jacobian[gap, gap] = np.eye(n) - D * slope
    jacobian[gap, mass] = -D
    jacobian[gap, -1] = -1.0
    of_h, of_p, of_c, flux = fluxes(h, p, c, speed * dx)
    residual[mass] = np.diff(flux)
    for block, of in ((gap, of_h), (mass, of_p), (void, of_c)):
        jacobian[mass, block] = np.diff(of, axis=0)
    length = np.hypot(p, c) + 1e-300
    residual[void] = p + c - length
    jacobian[void, mass] = np.diag(1 - p / length)
    jacobian[void, void] = np.diag(1 - c / length)
    residual[-1] = (p + contact).sum() * dx - 0.5 * np.pi
    jacobian[-1, gap] = slope * dx
    jacobian[-1, mass] = dx
    return residual, jacobian


def fluxes(h, p, c, width):
    """Return the derivatives of the flux gaps through the faces by gap, pressure and void, and the flux gaps."""
    n = len(h)
    faces, cells = np.arange(n + 1), np.arange(n)
    left, right = np.maximum(faces - 1, 0), np.minimum(faces, n - 1)
    known = np.concatenate([[0.0], p, [0.0]])
    face = 0.5 * (h[left] + h[right])
    drop = (known[1:] - known[:-1]) / width
    flux = (1 - c[left]) * h[left] - face**3 * drop
    of_h, of_p, of_c = (np.zeros((n + 1, n)) for _ in range(3))
    of_h[faces, left] += 1 - c[left]
    for side in (left, right):
        of_h[faces, side] -= 1.5 * face**2 * drop
    of_p[cells, cells] -= face[:-1] ** 3 / width
    of_p[cells + 1, cells] += face[1:] ** 3 / width
    of_c[faces, left] -= h[left]
    return of_h, of_p, of_c, flux


def extrapolated(groups, cells):
    """Return central and minimum gap and load share of the asperities, from ``cells`` and half as many."""
    start = sb.solve(sb.Groups(groups.speed, groups.load, groups.roughness), rtol=1e-4)
    found = []
    for number in (cells // 2, cells):
        x, h, p, _ = film(groups, number, start)
        near = np.abs(x) < 0.3
        central = np.polynomial.Polynomial.fit(x[near], h[near], 6)(0.0)
        found.append([central, h.min(), 1 - p.sum() * (x[1] - x[0]) / (0.5 * np.pi)])
    return 2 * np.array(found[1]) - np.array(found[0])
