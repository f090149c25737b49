"""Refining a state of the point contact until its estimated error holds a tolerance.

Each state is solved on two meshes, the second finer in radius *and* angle: either alone misleads.  The state is that of the
finer one, and by how much its observables differ from those of the coarser one tells their errors.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from stribeck._types import Array
from stribeck.contact_laws.law import ContactLaw
from stribeck.equations.point.mesh_choice import (
    EDGE,
    MOST_BYTES,
    MeshTooLargeError,
    Resolution,
    bytes_of,
    layout,
    split_where_poor,
)
from stribeck.equations.point.observables import identity_error, observables
from stribeck.equations.point.system import Unknowns
from stribeck.numerics.fourier_panels import PolarMesh
from stribeck.quantities.outcome import Outcome
from stribeck.solver.point.level import Level, band_for, moved, solve_level

PART = 0.35
"""Stated error over the difference between the two meshes: the finer one is better by more than that."""

COMPANY = 0.1
"""Smallest error that is stated of one observable, over the largest of all, each relative to its scale."""

CENTRAL = 0.5
"""Stated error of gap and pressure at the centre over the last coefficients of their series on the first panel."""

UNSEEN, UNSEEN_RADIAL = 5.0, 0.5
"""Stated error of the minimum film over the last coefficients of its series in the angle, and in the radius."""

MINIMUM_SLACK = 100.0
"""Tolerance of the minimum film over that of the other observables."""

PANEL_RATE = 1.49
"""Logarithm by which one degree more reduces the error of a pressure that has a square root at one panel's distance."""

SIDE_LOBES = 7.5
"""Number of modes over the width of the edge to the power -0.675 that resolves the minimum film of smooth contacts to 1e-4."""

MOST_DEGREE, MOST_MODES = 18, 160
MOST_ROUNDS = 6

LARGE = 200_000_000
"""Memory of the finer mesh from which the preconditioner of the coarser one is not kept for neighbours."""

BY_NAME_MINIMUM = ("minimum_gap", "minimum_radius", "minimum_angle", "minimum_gap_on_axis")


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

    @property
    def total(self) -> float:
        """Largest error relative to its scale, but for those of the minimum film."""
        return max(self.errors[name] / self.scales[name] for name in self.errors if name not in BY_NAME_MINIMUM)

    @property
    def minimum(self) -> float:
        """Relative error of the minimum film."""
        return self.errors["minimum_gap"] / self.scales["minimum_gap"]


def modal_amplitudes(level: Level) -> Array:
    """Return the largest part that each angular mode has in the gap, within twice the scale of the contact."""
    mesh, h = level.mesh, level.unknowns.gap
    near = mesh.radii < 2.0 * 2.0**level.resolution.doublings
    return np.asarray((np.abs(mesh.to_modes @ h) / h.mean(axis=0))[:, near].max(axis=1))


def modes_for(level: Level, amplitude: float) -> int:
    """Return the number of modes from which on their amplitudes are below a bound, by their geometric decay."""
    found = modal_amplitudes(level)
    below = np.flatnonzero(found > amplitude)
    last = int(below[-1]) + 1 if below.size else 1
    if last < found.size - 2:
        return last
    half = slice(max(2, found.size // 2), found.size - 1)
    m = np.arange(found.size)[half]
    rate, level_at = np.polyfit(m, np.log(np.maximum(found[half], 1e-300)), 1)
    rate = min(rate, -0.02)
    return int(math.ceil((math.log(amplitude) - level_at) / rate))


def legendre_tail(level: Level) -> float:
    """Return the largest of the last two Legendre coefficients of the logarithm of the gap, within twice the scale."""
    mesh, h = level.mesh, level.unknowns.gap
    near = mesh.edges[1:] <= 2.0 * 2.0**level.resolution.doublings * (1.0 + 1e-9)
    return float(np.abs(mesh.legendre(np.log(h))[:, near, -2:]).max())


def centre_tails(level: Level) -> Array:
    """Return the larger of the last two Legendre coefficients of gap and pressure on the first panel, axisymmetric part."""
    mesh = level.mesh
    fields = np.stack([level.unknowns.gap, level.unknowns.fluid + level.contact_pressure]).mean(axis=1)
    return np.asarray(np.abs(mesh.legendre(fields)[:, 0, -2:]).max(axis=1))


def scales_of(values: dict[str, float], speed: float) -> dict[str, float]:
    """Return what errors are relative to: one for shares, a radius or an angle, else about the observable itself."""
    friction = max(abs(values["J_balanced"]), abs(values["J_published"]), speed) if speed > 0 else 1.0
    found = {}
    for name, value in values.items():
        if name.endswith("share") or name in ("minimum_radius", "minimum_angle"):
            found[name] = 1.0
        elif name.startswith("J_"):
            found[name] = friction
        elif name == "offset":
            found[name] = max(abs(value), 1e-3)
        else:
            found[name] = max(abs(value), 1e-300)
    return found


def pair_of(coarse: Level, fine: Level) -> Pair:
    """Return the pair of two levels of one state."""
    values, rough = observables(fine.equations, fine.unknowns), observables(coarse.equations, coarse.unknowns)
    scales = scales_of(values, fine.equations.speed)
    errors = {name: PART * abs(value - rough[name]) + fine.iterated.left * scales[name] for name, value in values.items()}
    # Interpolated minima of two meshes may agree by chance: what the series leave out bounds them from below.
    balance = 0.3 * abs(identity_error(values, fine.equations.speed))
    for name in ("J_balanced", "J_published", "J_pcx"):
        errors[name] = max(errors[name], balance)
    at_centre = CENTRAL * centre_tails(fine)
    for name, tail in zip(("central_gap", "central_pressure"), at_centre, strict=True):
        errors[name] = max(errors[name], float(tail))
    # Two meshes may agree by chance in one number, hardly in all.
    widest = max(errors[name] / scales[name] for name in errors if name not in BY_NAME_MINIMUM)
    errors = {name: max(error, COMPANY * widest * scales[name]) for name, error in errors.items()}
    unseen = UNSEEN_RADIAL * legendre_tail(fine)
    if fine.equations.speed > 0:
        unseen += UNSEEN * float(modal_amplitudes(fine)[-2:].max())
    # The series of the side lobes falls from one mesh to the other as the error of the minimum does.
    last, before = (float(modal_amplitudes(level)[-2:].max()) for level in (fine, coarse))
    gained = 2.0 * min(PART, max(0.05, last / max(before, 1e-300)))
    for name in ("minimum_gap", "minimum_gap_on_axis"):
        errors[name] = max(gained * abs(values[name] - rough[name]), unseen * scales[name])
    for name in ("minimum_radius", "minimum_angle"):
        errors[name] = max(4.0 * errors[name], unseen)
    ok = coarse.outcome.ok and fine.outcome.ok
    outcome = Outcome.CONVERGED if ok else (fine.outcome if coarse.outcome.ok else coarse.outcome)
    steps = coarse.iterated.steps + fine.iterated.steps
    return Pair(
        coarse, fine, values, errors, scales, outcome, steps, coarse.iterated.krylov_steps + fine.iterated.krylov_steps
    )


def first_resolution(level: Level, rtol: float, band: int) -> Resolution:
    """Return the finer of the two meshes to begin with."""
    film = float(level.unknowns.gap[:, 0].mean())
    carried = min(1.0, float(level.contact_pressure[:, 0].mean()))
    scale = min(1.0, film + 0.3 * carried)
    degree = 1 + math.ceil(math.log(0.25 / (rtol * scale)) / PANEL_RATE)
    modes = max(1.4 * modes_for(level, 0.7 * math.sqrt(rtol)), modes_for(level, 0.5 * MINIMUM_SLACK * rtol / UNSEEN), 8)
    if level.contact_pressure.max() < 1e-3:
        width = layout(level.equations.speed, level.equations.law)[0] / EDGE
        modes = max(modes, SIDE_LOBES * width**-0.675 * math.log(MINIMUM_SLACK * rtol) / math.log(1e-4))
    degree = min(MOST_DEGREE, max(7, degree))
    return affordable(replace(level.resolution, degree=degree, modes=2 * math.ceil(0.5 * modes)), band)


def refine(speed: float, law: ContactLaw, guess: Level, rtol: float) -> Pair | Outcome:
    """Return a state on two meshes whose estimated error holds a tolerance, or the best that was found."""
    band = band_for(speed, law)
    tolerance = newton_tolerance(rtol)
    best: Pair | None = None
    try:
        for _ in range(MOST_ROUNDS):
            better = split_where_poor(guess.resolution, guess.mesh, guess.unknowns.fluid, guess.contact_pressure)
            if better == guess.resolution:
                break
            on_more = solve_level(better, speed, law, guess.unknowns, guess.mesh, 1e-4)
            if not on_more.outcome.ok:
                break
            guess = on_more
        wanted = first_resolution(guess, rtol, band)
        for _ in range(MOST_ROUNDS):
            coarse = solve_level(wanted.coarser(), speed, law, guess.unknowns, guess.mesh, tolerance)
            if not coarse.outcome.ok:
                return coarse.outcome if best is None else best
            if bytes_of(wanted, band) > LARGE:
                coarse = replace(coarse, iterated=replace(coarse.iterated, preconditioner=None))
            closer = coarse if best is None else guess
            fine = solve_level(wanted, speed, law, closer.unknowns, closer.mesh, tolerance)
            if not fine.outcome.ok:
                return fine.outcome if best is None else best
            pair = pair_of(coarse, fine)
            if best is None or pair.total < best.total or best.total <= rtol:
                best = pair
            if pair.total <= rtol and pair.minimum <= MINIMUM_SLACK * rtol:
                return pair
            following = finer(pair, rtol, band)
            if following == wanted:
                break
            guess, wanted = fine, following
    except MeshTooLargeError:
        pass
    if best is None:
        return Outcome.REFINEMENT_LIMIT
    return best if best.total <= rtol else replace(best, outcome=Outcome.REFINEMENT_LIMIT)


def newton_tolerance(rtol: float) -> float:
    """Return the relative error of the gap that Newton's iteration may leave."""
    return max(1e-11, 1e-2 * rtol)


def finer(pair: Pair, rtol: float, band: int) -> Resolution:
    """Return the next mesh: more modes where their amplitudes tell the error, else a higher degree."""
    now, fine = pair.fine.resolution, pair.fine
    modes, degree = now.modes, now.degree
    if pair.total > rtol:
        more = math.log(2.0 * pair.total / rtol)
        amplitude = float(modal_amplitudes(pair.coarse)[-2:].max())
        if amplitude**1.5 > rtol:
            modes = max(math.ceil(1.2 * modes), modes_for(fine, 0.3 * rtol**0.5))
        if amplitude**2 < 0.3 * pair.total:
            degree += max(1, min(4, math.ceil(more / PANEL_RATE)))
    if pair.minimum > MINIMUM_SLACK * rtol:
        allowed = MINIMUM_SLACK * rtol
        if UNSEEN_RADIAL * legendre_tail(fine) > 0.3 * allowed:
            degree += 2
        if UNSEEN * float(modal_amplitudes(fine)[-2:].max()) > 0.3 * allowed or degree == now.degree:
            modes = max(math.ceil(1.2 * modes), modes_for(fine, 0.3 * allowed / UNSEEN))
    modes = min(modes, 2 * now.modes)
    return affordable(replace(now, degree=min(MOST_DEGREE, degree), modes=2 * math.ceil(0.5 * modes)), band)


def affordable(wanted: Resolution, band: int) -> Resolution:
    """Return a resolution with as many of its modes as memory and :data:`MOST_MODES` allow."""
    wanted = replace(wanted, modes=min(wanted.modes, MOST_MODES))
    while bytes_of(wanted, band) > MOST_BYTES and wanted.modes > 16:
        wanted = replace(wanted, modes=2 * (wanted.modes * 9 // 20))
    return wanted


def follow(
    speed: float,
    law: ContactLaw,
    neighbour: Pair,
    rtol: float,
    start: Unknowns | None = None,
    start_mesh: PolarMesh | None = None,
) -> Pair | None:
    """Return the state of a neighbour's meshes at other groups, or None where it does not come from there."""
    tolerance = newton_tolerance(rtol)
    old_coarse, old_fine = neighbour.coarse, neighbour.fine
    first = old_coarse.unknowns if start is None else start
    mesh = old_coarse.mesh if start_mesh is None else start_mesh
    coarse = solve_level(
        old_coarse.resolution, speed, law, first, mesh, tolerance, old_coarse.iterated.preconditioner, max_steps=12
    )
    if not coarse.outcome.ok:
        return None
    # What the finer mesh had beyond the coarser one, the neighbour tells.
    carried = moved(coarse.unknowns, coarse.mesh, old_fine.mesh)
    known = moved(old_coarse.unknowns, old_coarse.mesh, old_fine.mesh)
    guess = Unknowns(
        carried.gap * (old_fine.unknowns.gap / known.gap),
        carried.fluid + (old_fine.unknowns.fluid - known.fluid),
        carried.offset + (old_fine.unknowns.offset - known.offset),
    )
    kept = old_fine.iterated.preconditioner
    fine = solve_level(old_fine.resolution, speed, law, guess, old_fine.mesh, tolerance, kept, max_steps=12)
    return pair_of(coarse, fine) if fine.outcome.ok else None
