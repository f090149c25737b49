r"""What a user reads off a state of the point contact: load shares, films, pressures, friction.

With p_f ~ -(4/5) lambda cos(theta)/r**3 far away every friction integral diverges as the logarithm of the radius at which it
ends, and its finite part is kept,

.. math::

    J^\mathrm{couette} = \frac\lambda6 \int \frac{1}{h}, \quad J^\mathrm{poiseuille} = \frac12 \int h \, \partial_x p_f, \quad
    J = \lim_{X \to \infty} \Big[ J(r < X) - c \, \lambda \ln X \Big].

Beyond the rim the film is that of :mod:`stribeck.equations.point.far_field`.
"""

from __future__ import annotations

import numpy as np

from stribeck._types import Array
from stribeck.contacts.cut_off import FULL, FarFilm
from stribeck.equations.point.far_field import tails
from stribeck.equations.point.minimum import Minimum, minimum_gap, minimum_on_axis
from stribeck.equations.point.system import LOAD, Equations, Unknowns
from stribeck.numerics.fourier_panels import PolarMesh, radau


def at_centre(mesh: PolarMesh, field: Array) -> float:
    """Return the value of a nodal field at the centre: that of its axisymmetric mode, the others vanish there."""
    row = radau(mesh.degree).interpolation(np.array([-1.0]))[0]
    return float(row @ field[:, mesh.of_panel[0]].mean(axis=0))


def observables(equations: Equations, y: Unknowns) -> dict[str, float]:
    """Return the observables by name, see :data:`stribeck.solver.point.state.OBSERVABLES`."""
    mesh, h = equations.operators.mesh, y.gap
    contact = equations.law.pressure(h)
    row = mesh.area_weights
    lowest: Minimum = minimum_gap(mesh, h)
    found = {
        "contact_load_share": float((contact @ row).sum()) / LOAD,
        "fluid_load_share": float(equations.load_row @ y.fluid.mean(axis=0)) / LOAD,
        "central_gap": at_centre(mesh, h),
        "minimum_gap": lowest.gap,
        "minimum_radius": lowest.radius,
        "minimum_angle": lowest.angle,
        "minimum_gap_on_axis": minimum_on_axis(mesh, h).gap,
        "central_pressure": at_centre(mesh, contact + y.fluid),
        "offset": y.offset,
    }
    return found | friction(equations, y, contact)


def friction(equations: Equations, y: Unknowns, contact: Array) -> dict[str, float]:
    """Return the finite parts of the friction integrals."""
    mesh, h, p, speed = equations.operators.mesh, y.gap, y.fluid, equations.speed
    cos, sin = np.cos(mesh.angles)[:, None], np.sin(mesh.angles)[:, None]
    moment = mesh.area_weights * mesh.radii * cos
    turn = 2.0 * np.pi / mesh.modes
    radial = turn * mesh.local_weights * mesh.local_radii * mesh.scattered(h * cos) * mesh.radial_derivative(p)
    tangential = turn * mesh.ring_weights * sin * h * (mesh.angular_derivative @ p)
    shear = equations.film.shear(mesh, speed, h, p) / h
    couette = speed / 6.0 * (float((shear @ mesh.area_weights).sum()) - equations.shear_missing(y))
    poiseuille = 0.5 * float(radial.sum() - tangential.sum())
    of_fluid, of_contact = float((moment * p).sum()), float((moment * contact).sum())
    at_rim = float(mesh.to_modes[1] @ p[:, -1])
    beyond = tails(mesh.rim, y.offset, speed, at_rim, equations.far, equations.operators.bulge)
    couette, poiseuille, of_fluid = couette + beyond[0], poiseuille + beyond[1], of_fluid + beyond[2]
    return {
        "J_couette": couette,
        "J_poiseuille": poiseuille,
        "J_balanced": couette + poiseuille,
        "J_published": couette - poiseuille - of_fluid,
        "J_pcx": -of_contact,
    }


def identity_error(values: dict[str, float], speed: float, far: FarFilm = FULL) -> float:
    """Return ``J_balanced - J_published - J_pcx + c lambda``, zero for every state; c = 0.4 pi for the full film."""
    return values["J_balanced"] - values["J_published"] - values["J_pcx"] + far.poiseuille * speed
