r"""The observables of a state of the point contact: load shares, films, pressures, friction.

With p_f ~ -(4/5) lambda cos(theta)/r**3 far away every friction integral diverges as the logarithm of its outer
radius, and its finite part is kept,

.. math::

    J^\mathrm{couette} = \frac\lambda6 \int \frac{1}{h}, \quad J^\mathrm{poiseuille} = \frac12 \int h \, \partial_x p_f, \quad
    J = \lim_{X \to \infty} \Big[ J(r < X) - c \, \lambda \ln X \Big].

Beyond the rim the film is that of :mod:`stribeck.equations.point.far_field`.

The minimum of the gap lies between the nodes: it is sought over the plane, and on its middle line.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from stribeck._types import Array
from stribeck.contacts.cut_off import FULL_FAR_FILM, FarFilm
from stribeck.equations.point.far_field import tails
from stribeck.equations.point.system import LOAD, Equations, Unknowns
from stribeck.numerics.fourier_panels import PolarMesh
from stribeck.numerics.settings import EPSILON, HALF_DIGITS, MAX_STEPS, NEAR_MINIMUM


@dataclass(frozen=True)
class Minimum:
    """Value and place of a minimum of the gap."""

    gap: float
    radius: float
    angle: float


def minimum_gap(mesh: PolarMesh, h: Array) -> Minimum:
    """Return the minimum of the interpolated gap, h being its nodal values of shape (modes, rings)."""
    angle, radius = np.unravel_index(int(np.argmin(h)), h.shape)
    padded = np.pad(h, 1, constant_values=np.inf)
    padded[0], padded[-1] = padded[1], padded[-2]
    neighbours = [padded[1 + i : h.shape[0] + 1 + i, 1 + j : h.shape[1] + 1 + j] for i in (-1, 0, 1) for j in (-1, 0, 1)]
    lowest = (h <= np.min(neighbours, axis=0)) & (h < NEAR_MINIMUM * h[angle, radius])
    coefficients = mesh.to_modes @ h
    found = [_descend(mesh, coefficients, mesh.radii[i], mesh.angles[j], False) for j, i in np.argwhere(lowest)]
    return min([*found, centre(mesh, h)], key=lambda one: one.gap)


def minimum_on_axis(mesh: PolarMesh, h: Array) -> Minimum:
    """Return the minimum of the interpolated gap on the middle line."""
    coefficients = mesh.to_modes @ h
    signs = (-1.0) ** np.arange(mesh.modes)
    sides = [
        (int(np.argmin(profile)), angle, profile)
        for angle, profile in ((0.0, coefficients.sum(axis=0)), (math.pi, signs @ coefficients))
    ]
    # A side that rises from the centre on holds no minimum; the descent from the other side may cross the centre.
    starts = [side for side in sides if side[0] > 0] or [min(sides, key=lambda side: side[2][0])]
    found = [_descend(mesh, coefficients, mesh.radii[node], angle, True) for node, angle, _ in starts]
    return min([centre(mesh, h), *found], key=lambda one: one.gap)


def centre(mesh: PolarMesh, h: Array) -> Minimum:
    """Return the gap at the centre."""
    return Minimum(at_centre(mesh, h), 0.0, 0.0)


def reach_of(mesh: PolarMesh, h: Array, radius: float, angle: float, depth: float) -> tuple[float, float]:
    """Return the distances in radius and angle at which the gap has risen by a depth above a minimum."""
    # By the curvature H there (2 d inv(H)_ii)**0.5, the extent of the ellipse in which the gap is lower; one radius and half a
    # turn at most.
    panel = min(max(int(mesh.edges.searchsorted(radius, side="right")) - 1, 0), mesh.panels - 1)
    orders, fields = np.arange(mesh.modes, dtype=np.float64), _derivatives(mesh, mesh.to_modes @ h, panel)
    eigenvalues, vectors = np.linalg.eigh(_jet(mesh, fields, orders, panel, radius, angle)[2])
    with np.errstate(all="ignore"):  # flat, as any angle is at the centre
        along = vectors**2 * (2.0 * depth / np.maximum(eigenvalues, 0.0))
        extents = np.sqrt(np.where(vectors == 0.0, 0.0, along).sum(axis=1))
    return min(float(extents[0]), 1.0), min(float(extents[1]), math.pi)


def _descend(mesh: PolarMesh, coefficients: Array, radius: float, angle: float, on_axis: bool) -> Minimum:
    """Return the minimum near a node, by Newton steps that may cross into neighbouring panels."""
    orders = np.arange(mesh.modes, dtype=np.float64)
    best, here, fields = Minimum(np.inf, radius, angle), -1, coefficients
    for _ in range(MAX_STEPS):
        panel = min(max(int(mesh.edges.searchsorted(radius, side="right")) - 1, 0), mesh.panels - 1)
        if panel != here:
            here, fields = panel, _derivatives(mesh, coefficients, panel)
        value, slope, curvature = _jet(mesh, fields, orders, panel, radius, angle)
        if value < best.gap:
            best = Minimum(float(value), float(radius), float(angle))
        limits = np.array([0.3 * (mesh.edges[panel + 1] - mesh.edges[panel]), np.pi / mesh.modes])
        if on_axis:
            slope[1], curvature[0, 1], curvature[1, 0], curvature[1, 1] = 0.0, 0.0, 0.0, 1.0
        scaled = limits[:, None] * curvature * limits
        eigenvalues, vectors = np.linalg.eigh(scaled)
        downhill = vectors @ ((vectors.T @ (slope * limits)) / np.maximum(np.abs(eigenvalues), EPSILON * abs(value)))
        length = float(np.abs(downhill).max())
        if length < HALF_DIGITS:
            break
        step = -limits * downhill / max(1.0, length)
        radius = float(radius + step[0])
        angle = float(angle + step[1])
        if radius < 0.0:
            radius, angle = -radius, math.pi - angle
        radius = min(radius, mesh.rim)
        angle = math.acos(math.cos(angle))
    return best


def _derivatives(mesh: PolarMesh, coefficients: Array, panel: int) -> Array:
    """Return a field and its first two derivatives in the coordinate of a panel at its nodes, shape (3, modes, degree + 1)."""
    half, derivative = mesh.spans[1][panel], mesh.rule(panel).derivative.T
    field = coefficients[:, mesh.of_panel[panel]]
    first = field @ derivative / half
    return np.stack([field, first, first @ derivative / half])


def _jet(mesh: PolarMesh, fields: Array, orders: Array, panel: int, radius: float, angle: float) -> tuple[float, Array, Array]:
    """Return value, gradient and Hessian of the interpolated field in radius and angle."""
    middle, half = mesh.spans[0][panel], mesh.spans[1][panel]
    in_log = panel >= mesh.log_from
    t = ((math.log(radius) if in_log else radius) - middle) / half
    f, f_t, f_tt = fields @ mesh.rule(panel).interpolation(np.array([t]))[0]
    if in_log:
        f_t, f_tt = f_t / radius, (f_tt - f_t) / radius**2
    c, s = np.cos(orders * angle), np.sin(orders * angle)
    gradient = np.array([c @ f_t, -(orders * s) @ f])
    mixed = -(orders * s) @ f_t
    return float(c @ f), gradient, np.array([[c @ f_tt, mixed], [mixed, -(orders**2 * c) @ f]])


# Names of the observables. `minimum_radius` [a] and `minimum_angle` [radian, 0 downstream on the middle line, at most pi by
# symmetry] place the minimum of the gap; `minimum_gap_on_axis` is that of the middle line. The J are the finite parts of the
# friction integrals, `lim J(r < X) - (16/15) pi lambda ln X`; J_balanced is the force on the flat, J_published that on the
# ball without the contact pressure along x, which is J_pcx.
OBSERVABLES = (
    "contact_load_share",
    "fluid_load_share",
    "central_gap",
    "minimum_gap",
    "minimum_radius",
    "minimum_angle",
    "minimum_gap_on_axis",
    "central_pressure",
    "offset",
    "J_couette",
    "J_poiseuille",
    "J_balanced",
    "J_published",
    "J_pcx",
)

# Those that are no smooth functions of the unknowns: the place of the minimum jumps.
MINIMA = ("minimum_gap", "minimum_radius", "minimum_angle", "minimum_gap_on_axis")

# Friction integrals of FrictionWithin by name: what a film has up to where the liquid ends.
WITHIN = ("within_couette", "within_poiseuille", "within_edge")


def at_centre(mesh: PolarMesh, field: Array) -> float:
    """Return the value of a nodal field at the centre: that of its axisymmetric mode, the others vanish there."""
    return float(mesh.rule(0).left_end @ field[:, mesh.of_panel[0]].mean(axis=0))


def observables(equations: Equations, y: Unknowns) -> dict[str, float]:
    """Return the observables by name, see :data:`OBSERVABLES`."""
    mesh, h = equations.operators.mesh, y.gap
    contact = equations.law.pressure(h)
    found = {
        "contact_load_share": float((contact @ mesh.area_weights).sum()) / LOAD,
        "fluid_load_share": float(equations.load_row @ y.fluid.mean(axis=0)) / LOAD,
        "central_gap": at_centre(mesh, h),
        "central_pressure": at_centre(mesh, contact + y.fluid),
        "offset": y.offset,
    }
    # At rest the gap is that of rings, whose descent to the centre would end in the rounding of its angle.
    is_central = equations.speed == 0.0 and not h.argmin(axis=1).any()
    lowest: Minimum = centre(mesh, h) if is_central else minimum_gap(mesh, h)
    on_axis = lowest if is_central else minimum_on_axis(mesh, h)
    found |= {"minimum_gap": lowest.gap, "minimum_radius": lowest.radius, "minimum_angle": lowest.angle}
    return found | {"minimum_gap_on_axis": on_axis.gap} | friction(equations, y, contact)


def friction(equations: Equations, y: Unknowns, contact: Array) -> dict[str, float]:
    """Return the finite parts of the friction integrals."""
    mesh, p, speed = equations.operators.mesh, y.fluid, equations.speed
    moment = mesh.area_weights * mesh.radii * np.cos(mesh.angles)[:, None]
    couette, poiseuille = (float((mesh.local_weights * each).sum()) for each in on_rings(equations, y))
    of_fluid, of_contact = float((moment * p).sum()), float((moment * contact).sum())
    at_rim = float(mesh.to_modes[1] @ p[:, -1])
    more, first = equations.outside_film, 0.0
    if more is not None:
        first = more.first
        couette, poiseuille, of_fluid = np.add((couette, poiseuille, of_fluid), more.tails).tolist()
    rest = tails(mesh.rim, y.offset, speed, at_rim - first, equations.far, equations.operators.bulge)
    couette, poiseuille, of_fluid = np.add((couette, poiseuille, of_fluid), rest).tolist()
    return {
        "J_couette": couette,
        "J_poiseuille": poiseuille,
        "J_balanced": couette + poiseuille,
        "J_published": couette - poiseuille - of_fluid,
        "J_pcx": -of_contact,
    }


def on_rings(equations: Equations, y: Unknowns) -> tuple[Array, Array]:
    """Return what a ring adds to both friction integrals, over its width, at the nodes of each panel."""
    mesh, h, p, speed = equations.operators.mesh, y.gap, y.fluid, equations.speed
    cos, sin = np.cos(mesh.angles)[:, None], np.sin(mesh.angles)[:, None]
    turn = 2.0 * np.pi / mesh.modes
    shear = equations.film.shear(mesh, speed, h, p) / h
    couette = speed / 6.0 * (turn * mesh.radii * shear.sum(axis=0) - equations.shear_missing(y))
    along = (mesh.scattered(h * cos) * mesh.radial_derivative(p)).sum(axis=0) * mesh.local_radii
    poiseuille = 0.5 * turn * (along - mesh.scattered((sin * h * (mesh.angular_derivative @ p)).sum(axis=0)))
    return mesh.scattered(couette), poiseuille


@dataclass(frozen=True, eq=False)
class FrictionWithin:
    """The friction integrals of a film up to a radius, less those of a fluid that does not thin far away."""

    mesh: PolarMesh  # The mesh
    running: Array  # At the nodes: both parts up to there, and how much the force on the ball is larger, with `J_pcx`
    finite: tuple[float, float, float]  # The finite parts of both, and what the third is of the far film
    outside_film: Any  # What the film beyond the rim has more than that
    offset: float  # Offset [u_Hz]
    speed: float  # Speed group
    far: FarFilm  # The logarithms

    @classmethod
    def of(cls, equations: Equations, y: Unknowns, values: Mapping[str, float]) -> FrictionWithin:
        """Return the friction integrals of a state with these observables."""
        mesh, speed = equations.operators.mesh, equations.speed
        around = (y.fluid * np.cos(mesh.angles)[:, None]).sum(axis=0)
        moment = 2.0 * np.pi / mesh.modes * mesh.scattered(around) * mesh.local_radii**2
        running = _running(mesh, np.stack([*on_rings(equations, y), moment]))
        running[2] = values["J_pcx"] - 2.0 * running[1] - running[2]
        finite = values["J_couette"], values["J_poiseuille"], equations.far.poiseuille * speed
        return cls(mesh, running, finite, equations.outside_film, y.offset, speed, equations.far)

    def __call__(self, which: int, log_radius: float) -> float:
        """Return one of the three at a radius, less its finite part and logarithm."""
        radius = math.exp(log_radius)
        if radius >= self.mesh.rim:
            if self.outside_film is None:
                return 0.0
            more = self.outside_film.at_radius(radius)
            if which < 2:
                return float(-more.tails[which])
            return float(-0.5 * math.pi * radius * (radius**2 + 2.0 * self.offset) * more.first)
        panel, row = self.mesh.radial_interpolation(np.array([radius]))
        far = self.finite[which] + (self.far.couette, self.far.poiseuille, 0.0)[which] * self.speed * log_radius
        return float(row[0] @ self.running[which, panel[0]]) - far


def _running(mesh: PolarMesh, local: Array) -> Array:
    """Return integrals over r from the centre to the nodes of each panel, of values of shape (..., panels, degree + 1)."""
    found = np.empty_like(local)
    before = np.zeros(local.shape[:-2])
    for panel in range(mesh.panels):
        inside = (local[..., panel, :] * mesh.stretch[panel]) @ mesh.rule(panel).integral.T
        found[..., panel, :] = before[..., None] + inside
        before = found[..., panel, -1]
    return found


def identity_error(values: dict[str, float], speed: float, far: FarFilm = FULL_FAR_FILM) -> float:
    """Return ``J_balanced - J_published - J_pcx + c lambda``, zero for every state; c = 0.4 pi for the full film."""
    return values["J_balanced"] - values["J_published"] - values["J_pcx"] + far.poiseuille * speed
