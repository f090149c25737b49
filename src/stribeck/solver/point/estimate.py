"""Errors of a state of a ball, by the difference of two meshes."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from stribeck._types import Array
from stribeck.contacts.groups import Model
from stribeck.equations.film import closed_gap
from stribeck.equations.point.observables import MINIMA, identity_error, observables, reach_of
from stribeck.numerics.settings import (
    NEAR_MINIMUM,
    NEGLIGIBLE,
    SAFETY,
    SMOOTH_SAFETY,
)
from stribeck.quantities.outcome import Outcome
from stribeck.solver.point.level import Level

# Observables that rtol does not limit in cavitated films: streaks of the wake, and the moment of a thin contact whose panels
# the rupture line crosses, are less accurate than the film.
LOOSE_OBSERVABLES = ("J_couette", "J_balanced", "J_published", "J_pcx", "central_pressure")
DRAGS = ("J_couette", "J_poiseuille", "J_balanced", "J_published")  # Integrals of the film, which reach beyond the rim
SHEAR_INTEGRALS = ("J_couette", "J_balanced", "J_published")  # Integrals that contain the shear


@dataclass(frozen=True, eq=False)
class Pair:
    """A state on two meshes, the observables of the finer one and their errors."""

    coarse: Level
    fine: Level
    values: dict[str, float]
    errors: dict[str, float]
    scales: dict[str, float]
    outcome: Outcome
    steps: int
    krylov_steps: int

    def relabelled(self, model: Model) -> Pair:
        """Return the pair relabelled with a model whose states start from it."""
        return replace(self, coarse=self.coarse.relabelled(model), fine=self.fine.relabelled(model))

    def without_operators(self) -> Pair:
        """Return the pair without the operators and factors that fill the memory."""
        return replace(self, coarse=self.coarse.without_operators(), fine=self.fine.without_operators())

    def with_factors_of(self, other: Pair) -> Pair:
        """Return the pair with the factors of another one if this lies on the same meshes."""
        levels = [(self.coarse, other.coarse), (self.fine, other.fine)]
        if any(a.resolution != replace(b.resolution, model=a.resolution.model) for a, b in levels):
            return self
        coarse, fine = (replace(a, iterated=replace(a.iterated, preconditioner=b.iterated.preconditioner)) for a, b in levels)
        return replace(self, coarse=coarse, fine=fine)

    @property
    def total(self) -> float:
        """Largest error over its scale among the observables that a tolerance limits."""
        apart = without_tolerance(self.fine.breaks)
        return max(error / self.scales[name] for name, error in self.errors.items() if name not in apart)

    @property
    def minimum(self) -> float:
        """Relative error of the minimum film."""
        return self.errors["minimum_gap"] / self.scales["minimum_gap"]


def without_tolerance(breaks: bool) -> tuple[str, ...]:
    """Return the observables of a state, whose film perhaps breaks, that no tolerance limits."""
    return (*MINIMA, *LOOSE_OBSERVABLES) if breaks else MINIMA


def safety_of(level: Level) -> tuple[float, float]:
    """Return the stated error over the difference of two meshes, and the least such difference over the largest of all."""
    film, equations = level.resolution.model.film, level.equations
    closed_at = closed_gap(film)
    # Errors of a smooth flow fall exponentially, so that the finer mesh has hardly any; of one that thins or ends as a power.
    # Where roughness closes the flow, or gas goes by differences of first order, both meshes err by nearly the same.
    if equations.order < 2.0 or (closed_at is not None and level.unknowns.gap.min() < NEAR_MINIMUM * closed_at):
        return SAFETY, 1.0
    # Before the last coefficients of the gap are as small as first meshes are chosen for, errors do not fall yet: either mesh
    # may be the nearer one, by chance.
    falls = max(gap_tails(level)) <= NEGLIGIBLE**2
    if level.breaks or film.uses_speed:
        return 1.0 if falls else SAFETY, 1.0
    return SMOOTH_SAFETY if falls else SAFETY, NEGLIGIBLE


def gap_tails(level: Level) -> tuple[float, float]:
    """Return the last coefficients of the gap in radius and angle over the gap, within twice the scale of the contact."""
    mesh, log_gap = level.mesh, np.log(level.unknowns.gap)
    near = mesh.edges[1:] <= 2.0 * 2.0**level.resolution.doublings * (1.0 + 1e-9)
    return float(np.abs(mesh.legendre(log_gap)[:, near, -2:]).max()), float(modal_amplitudes(level)[-2:].max())


def modal_amplitudes(level: Level) -> Array:
    """Return the largest amplitude of each angular mode of the gap, within twice the scale of the contact."""
    mesh, h = level.mesh, level.unknowns.gap
    near = mesh.radii < 2.0 * 2.0**level.resolution.doublings
    return np.asarray((np.abs(mesh.to_modes @ h) / h.mean(axis=0))[:, near].max(axis=1))


def scales_of(values: dict[str, float], speed: float) -> dict[str, float]:
    """Return the scales of errors: one for shares and angles, else about the value."""
    friction = max(abs(values["J_balanced"]), abs(values["J_published"]), speed) if speed > 0 else 1.0
    found = {}
    for name, value in values.items():
        if name.endswith("share") or name in ("minimum_radius", "minimum_angle"):
            found[name] = 1.0
        elif name.startswith("J_"):
            found[name] = friction
        else:
            found[name] = max(abs(value), values["central_gap"] if name == "offset" else 1e-300)
    return found


def pair_of(coarse: Level, fine: Level) -> Pair:
    """Return the pair of two levels of one state."""
    equations, y = fine.equations, fine.unknowns
    values, rough = observables(equations, y), observables(coarse.equations, coarse.unknowns)
    scales = scales_of(values, equations.speed)
    safety, floor = safety_of(fine)
    differences = {name: abs(value - rough[name]) / scales[name] for name, value in values.items()}
    # Two meshes may agree by chance in one number, hardly in all.
    apart = without_tolerance(fine.breaks)
    widest = max(differences[name] for name in values if name not in apart)
    errors = {
        name: (safety * max(differences[name], floor * widest) + fine.iterated.left) * scale for name, scale in scales.items()
    }
    # What lies beyond the rim, or begins at a line of rupture that is known to a spacing of the nodes, no mesh tells.
    outside, streaks = equations.friction_error_outside(y), equations.speed / 6.0 * equations.shear_error(y)
    for name in DRAGS:
        errors[name] += outside
    for name in SHEAR_INTEGRALS:
        errors[name] += streaks
    # What the identity of three integrals misses, by rounding where friction is slight, is theirs in equal parts.
    missing = abs(identity_error(values, equations.speed, equations.far)) / 3.0
    for name in ("J_balanced", "J_published", "J_pcx"):
        errors[name] = max(errors[name], missing)
    errors |= gap_errors(coarse, fine, values, errors)
    ok = coarse.outcome.ok and fine.outcome.ok
    outcome = Outcome.CONVERGED if ok else (fine.outcome if coarse.outcome.ok else coarse.outcome)
    steps, krylov = (getattr(coarse.iterated, name) + getattr(fine.iterated, name) for name in ("steps", "krylov_steps"))
    return Pair(coarse, fine, values, errors, scales, outcome, steps, krylov)


def gap_errors(coarse: Level, fine: Level, values: dict[str, float], errors: dict[str, float]) -> dict[str, float]:
    """Return the errors of the central and the minimum gap and its place, by the difference of the two gaps around these."""
    # Gaps of two meshes may agree by chance at one place, all around hardly; the place is known as far as the gap is.
    gap = fine.unknowns.gap
    ours, theirs = (level.unknowns.gap - 0.5 * level.mesh.radii**2 for level in (fine, coarse))
    apart = coarse.mesh.transfer(fine.mesh, theirs[None])[0] - ours
    near = float(np.abs(apart)[gap < NEAR_MINIMUM * gap.min()].max())
    found = {name: max(errors[name], near) for name in ("minimum_gap", "minimum_gap_on_axis")}
    # In the middle the gap is that of its mean over the angles.
    middle = np.abs(apart[:, fine.mesh.of_panel[0]].mean(axis=0))
    found["central_gap"] = max(errors["central_gap"], float(middle.max()))
    place = values["minimum_radius"], values["minimum_angle"]
    radius, angle = reach_of(fine.mesh, gap, *place, found["minimum_gap"])
    radius = max(errors["minimum_radius"], radius)
    seen = radius / max(place[0], radius / math.pi, 1e-300)  # from the centre
    return found | {"minimum_radius": radius, "minimum_angle": min(math.pi, max(errors["minimum_angle"], angle, seen))}
