"""What one would write at home: finite differences, piecewise-linear pressure, Newton's method with numpy.linalg.solve.

Equations (1)-(5) of docs/theory.md on a box with p = 0 at its ends.  The logarithm is integrated exactly over hat functions;
Reynolds' equation is dp_f/dx = speed (h - h*)/h**3 between neighbours, h central (upstream=0.5) or upstream (upstream=1).
"""

import numpy as np


def grid(nodes, box=3.0, width=None):
    """Return a uniform grid on [-box, box], or one refined to ``width`` at the edges of the contact."""
    x = np.linspace(-box, box, nodes if width is None else 100_001)
    if width is None:
        return x
    count = np.arcsinh((x - 1) / width) + np.arcsinh((x + 1) / width) + x / 2
    return np.interp(np.linspace(count[0], count[-1], nodes), count, x)


def gap_matrix(x):
    """Return B = dh/dy from the unknowns y = (inner pressures, z0, h*) to the gap at the nodes."""
    r = x[:, None] - np.concatenate([[2 * x[0] - x[1]], x, [2 * x[-1] - x[-2]]])
    twice_integrated_log = r**2 * (0.5 * np.log(np.where(r == 0, 1, np.abs(r))) - 0.75)
    deflection = np.diff(np.diff(twice_integrated_log, axis=1) / np.diff(r[0]), axis=1) / np.pi
    return np.column_stack([deflection[:, 1:-1], np.ones(len(x)), np.zeros(len(x))])


def newton(x, B, y, speed, load, kappa, upstream, tol):
    """Return the unknowns that solve the equations, or None."""
    dx, weights = np.diff(x), np.append((x[2:] - x[:-2]) / 2, [0, 0])
    for _ in range(30):
        h = x**2 / 2 + B @ y
        if h.min() < 1e-12:
            return None
        p_c = np.exp(-h / kappa) / np.sqrt(load)
        dp_f = B * (p_c / kappa)[:, None] + np.eye(len(x), k=-1)
        dp_f[-1, -2] -= 1  # the last pressure is zero, not z0
        m, dm = (h[:-1] + h[1:]) / 2, (B[:-1] + B[1:]) / 2
        u, du = upstream * h[:-1] + (1 - upstream) * h[1:] - y[-1], upstream * B[:-1] + (1 - upstream) * B[1:]
        du[:, -1] -= 1
        R = np.append(np.diff(np.pad(y[:-2], 1) - p_c) / dx - speed * u / m**3, weights @ y - np.pi / 2)
        J = np.diff(dp_f, axis=0) / dx[:, None] - speed * (du / m[:, None] ** 3 - dm * (3 * u / m**4)[:, None])
        dy = np.linalg.solve(np.vstack([J, weights]), -R)
        dh = B @ dy
        in_contact = np.abs(dh[p_c > 1e-6]).max(initial=0)
        y = y + dy / max(1, (-dh / h).max() / 0.7, in_contact / (3 * kappa))
        if np.abs(dh / h).max() < tol:
            return y
    return None


def solve(x, speed, load=1.0, kappa=1e-30, upstream=0.5):
    """Return h, y and the speed reached, ``speed`` (< 1) if all is well: continuation from a rigid film at speed 1."""
    B = gap_matrix(x)
    y = np.append(-x[1:-1] / (3 * (0.35 + x[1:-1] ** 2 / 2) ** 2), [0.35, 0.46])
    reached, target, ratio = np.inf, 1.0, 0.1
    while reached > speed and ratio < 0.97:
        found = newton(x, B, y, target, load, kappa, upstream, 1e-9 if target == speed else 1e-2)
        reached, y, ratio = (reached, y, ratio**0.5) if found is None else (target, found, ratio)
        target = max(speed, min(reached, 1.0) * ratio)
    return x**2 / 2 + B @ y, y, reached
