"""Refining a state of a ball whose film ends at ambient pressure until its estimated error holds a tolerance.

The line of rupture lies between nodes, so that errors fall as the number of angles to the power -2, not faster.  Each state is
solved on coarse angles first, as on many at once the line moves a node a step; the last two meshes differ in the radius too.
Numbers of angles are multiples of five: the rays along which the film ruptures far away lie midway between nodes then.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from stribeck.contact_laws.law import ContactLaw
from stribeck.contacts.model import Model
from stribeck.equations.cavities.system import CavitatedSystem, just_above
from stribeck.equations.point.mesh_choice import (
    RIGID_CAVITATED,
    MeshTooLargeError,
    Resolution,
    fewest_modes,
    fits,
    operators_of,
    resolution,
    split_where_poor,
    with_closing,
)
from stribeck.equations.point.observables import identity_error, observables
from stribeck.equations.point.system import Unknowns
from stribeck.fluids.cavitation import Cavitation
from stribeck.numerics.fourier_panels import PolarMesh
from stribeck.quantities.outcome import Outcome
from stribeck.solver.point.level import PROBLEMS, Level, extrapolate_levels, solve_level, transfer
from stribeck.solver.point.refinement import (
    CENTRE_SAFETY,
    KINK_LOAD_SAFETY,
    KINK_MOMENT_SAFETY,
    SAFETY_AT_KINK,
    Pair,
    angle_error,
    centre_tails,
    kink_tails,
    scales_of,
    split_at_kink,
)
from stribeck.solver.point.state import LOOSE_OBSERVABLES, WITHOUT_TOLERANCE

# Angles of the two meshes whose difference gives the error, and the degree of the first (that of the second is two higher).
MESH_LEVELS = ((5, 10, 8), (10, 20, 8), (15, 30, 8), (20, 45, 10), (30, 65, 10), (45, 95, 10))
MAX_LOOSE_RTOL_RATIO = 10.0  # Error of LOOSE_OBSERVABLES over rtol above which the first mesh level does not serve
COARSEN_BELOW_SAME_PANELS = 0.25  # Stated error over rtol below which a state moves one mesh level down
COARSEN_BELOW_NEW_PANELS = 0.35  # The fraction of rtol where the panels change anyway, or the errors are asymptotic
ASYMPTOTIC_FROM_ANGLES = 30  # Angles from which errors fall regularly with their number
COARSEN_EXPECTED_BELOW = 0.9  # Largest error over rtol expected on fewer angles
# The coarse-fine difference may vanish by accident as the rupture line crosses a node: floors bound the errors from below.
ERROR_FLOOR_RATIO = 0.6  # Least error of an observable over the largest of all
RUPTURE_ERROR_TIMES_ANGLES2 = 0.04  # Least of the largest error times the angles squared
RUPTURE_ERROR_PER_FILM = 0.58  # The floor over fluid share times central film: in thick films both meshes share the error
MAX_RUPTURE_ERROR = 0.142  # Largest floor times the angles squared
SHEAR_INTEGRALS = ("J_couette", "J_balanced", "J_published")  # They contain the shear, and so the same error
SHEAR_ERROR_TIMES_ANGLES2 = 0.45  # Least error of the shear integrals times the angles squared (thin films, dry wakes)
THINNING_FRICTION_SAFETY = 1.6  # Error of friction over that of a Newtonian film: thinning lowers drag but not the error
MINIMUM_ERROR_FLOOR = 10.0  # Least error of the minimum film and its position over the largest of the others
SPLIT_ERROR_RATIO = 0.7  # Error over that on fewer angles above which panels that the rupture line crosses are split
SPLIT_WIDTH = 0.2  # Width above which such panels are split [a]
MIN_PANEL_LOG2 = -1.0  # log2 of the smallest panel over the best one down to which panels serve along a path to lower speeds
RIGID_START_SPEED = 2.0  # Above this speed the start is the rigid-ball solution instead of the full film
MAX_STEPS_NEW_MESH = 80  # Newton steps on a mesh other than the neighbour's, or from cold
ITERATION_RTOL = 1e-6  # Relative error of the gap that the iteration leaves on the finer mesh
COARSE_RTOL = 1e-5  # Relative error of the gap that the iteration leaves on the coarser mesh


def pair_of(coarse: Level, fine: Level) -> Pair:
    """Return the pair of two levels of one state."""
    assert isinstance(fine.equations, CavitatedSystem)
    speed, slack, order = fine.equations.speed, fine.equations.slack, fine.equations.order
    finer = fine.mesh.modes / coarse.mesh.modes
    part, loose = slack / (finer**order - 1.0), slack / (finer - 1.0)
    values, rough = observables(fine.equations, fine.unknowns), observables(coarse.equations, coarse.unknowns)
    scales = scales_of(values, speed)
    scales["offset"] = max(abs(values["offset"]), values["central_gap"])  # it crosses zero
    parts = (
        dict.fromkeys(values, part) | dict.fromkeys(LOOSE_OBSERVABLES, loose) | dict.fromkeys(WITHOUT_TOLERANCE, 2.0 * loose)
    )
    errors = {
        n: parts[n] * (abs(value - rough[n]) + coarse.iterated.left * scales[n]) + fine.iterated.left * scales[n]
        for n, value in values.items()
    }
    balance = 0.3 * abs(identity_error(values, speed, fine.equations.far))
    for name in ("J_balanced", "J_published", "J_pcx"):
        errors[name] = max(errors[name], balance)
    outside = fine.equations.friction_error_outside(fine.unknowns)
    streaks = speed / 6.0 * fine.equations.shear_error(fine.unknowns)
    of_load, of_moment = kink_tails(fine).sum(axis=1).tolist()
    for name, factor in KINK_MOMENT_SAFETY.items():
        errors[name] = max(errors[name], factor * of_moment)
    errors["J_poiseuille"] += outside
    # By the balance of forces and the sum of both parts these three differ by what is known better.
    least = SHEAR_ERROR_TIMES_ANGLES2 / fine.mesh.modes**2 * scales["J_balanced"]
    errors |= dict.fromkeys(SHEAR_INTEGRALS, max(least, max(errors[name] for name in SHEAR_INTEGRALS) + outside + streaks))
    for (name, factor), tail in zip(CENTRE_SAFETY.items(), centre_tails(fine), strict=True):
        errors[name] = max(errors[name], factor * float(tail))
    # Two meshes may agree by chance in one number, hardly in all.
    widest = max(errors[name] / scales[name] for name in errors if name not in (*WITHOUT_TOLERANCE, *LOOSE_OBSERVABLES))
    widest = max(widest, rupture_error_floor(values, fine.mesh.modes), KINK_LOAD_SAFETY * of_load)
    widest = max(widest, speed / 6.0 * fine.equations.gas_error(fine.unknowns) / scales["J_balanced"])  # the film follows it
    floors = dict.fromkeys(values, ERROR_FLOOR_RATIO if of_load == 0.0 else SAFETY_AT_KINK)
    floors |= dict.fromkeys(WITHOUT_TOLERANCE, MINIMUM_ERROR_FLOOR)
    errors = {name: max(error, floors[name] * widest * scales[name]) for name, error in errors.items()}
    if fine.resolution.model.film.uses_speed:
        errors |= {name: THINNING_FRICTION_SAFETY * errors[name] for name in errors if name.startswith("J_")}
    errors["minimum_angle"] = angle_error(values, errors)
    ok = coarse.outcome.ok and fine.outcome.ok
    outcome = Outcome.CONVERGED if ok else (fine.outcome if coarse.outcome.ok else coarse.outcome)
    steps, krylov = (getattr(coarse.iterated, name) + getattr(fine.iterated, name) for name in ("steps", "krylov_steps"))
    return Pair(coarse, fine, values, errors, scales, outcome, steps, krylov)


def rupture_error_floor(values: dict[str, float], angles: int) -> float:
    """Return the smallest error of any observable, as the rupture line lies between the angles."""
    of_film = RUPTURE_ERROR_PER_FILM * values["fluid_load_share"] * values["central_gap"]
    return max(RUPTURE_ERROR_TIMES_ANGLES2, min(of_film, MAX_RUPTURE_ERROR)) / angles**2


def limited_error(pair: Pair) -> float:
    """Return the largest relative error among observables that the tolerance limits."""
    return max(
        pair.errors[name] / pair.scales[name] for name in pair.errors if name not in (*WITHOUT_TOLERANCE, *LOOSE_OBSERVABLES)
    )


def refine_cavitated(
    speed: float, law: ContactLaw, guess: Level, rtol: float, model: Model, known: Pair | None = None
) -> Pair | Outcome:
    """Return a cavitated state that holds a tolerance, from a full film or a ``known`` state with a larger error."""
    rtol = max(rtol, PROBLEMS[model.cavitation][0].finest)
    best = known
    try:
        if known is not None:
            now, start, mesh = known.fine.resolution, known.fine.unknowns, known.fine.mesh
            serves = fits(now, speed, law)
            base = _split_where_needed(now, known, rtol) if serves else _first_panels(speed, law, known.fine, model)
            same = (base.halvings, base.splits, base.closing) == (now.halvings, now.splits, now.closing)
            mesh_level = _mesh_level(known) + same
        else:
            base, mesh_level = _first_panels(speed, law, guess, model), _first_mesh_level(rtol, speed, law, model)
            start, mesh = guess.unknowns, guess.mesh
            if speed >= RIGID_START_SPEED and model.cavitation is Cavitation.EXIT:
                mesh = operators_of(base).mesh
                start = guess_from_rigid_ball(mesh, speed)
            if guess.resolution.model.film != model.film:  # the film ruptures first, then the fluid changes
                few, _, degree = MESH_LEVELS[mesh_level]
                other = replace(base, modes=few, degree=degree, model=replace(model, film=guess.resolution.model.film))
                cavitated = solve_level(other, speed, law, start, mesh, COARSE_RTOL, max_steps=MAX_STEPS_NEW_MESH)
                start, mesh = (cavitated.unknowns, cavitated.mesh) if cavitated.outcome.ok else (start, mesh)
        while mesh_level < len(MESH_LEVELS):
            found = _pair(base, MESH_LEVELS[mesh_level], speed, law, start, mesh)
            if isinstance(found, Outcome):
                if best is None and mesh_level == 0:
                    mesh_level = 1
                    continue
                return found if best is None else replace(best, outcome=found)
            left = math.inf if best is None else limited_error(best)
            error = limited_error(found)
            if known is not None and best is not None and _mesh_level(found) > _mesh_level(best) and error >= left > rtol:
                break  # a cold start has panels of its own
            gained = error <= SPLIT_ERROR_RATIO * left
            best, start, mesh = found, found.fine.unknowns, found.fine.mesh
            if holds_cavitated(found, rtol):
                return found
            before, base = base, _split_where_needed(base, found, rtol if gained else 0.0)
            mesh_level += base.splits == before.splits
    except MeshTooLargeError:
        pass
    return Outcome.REFINEMENT_LIMIT if best is None else replace(best, outcome=Outcome.REFINEMENT_LIMIT)


def _first_panels(speed: float, law: ContactLaw, guess: Level, model: Model) -> Resolution:
    """Return the first resolution of a state, with panels split where its guess is poorly resolved."""
    few, _, degree = MESH_LEVELS[0]
    base = resolution(speed, law, degree, few, model)
    if isinstance(guess.equations, CavitatedSystem):  # its line of rupture is no edge of the contact
        mesh = base.mesh
        gap = transfer(guess.unknowns, guess.mesh, mesh, guess.equations.least).gap
        contact = law.pressure(gap)
        return with_closing(split_where_poor(base, mesh, np.zeros_like(contact), contact), mesh, gap)
    found = split_where_poor(guess.resolution, guess.mesh, guess.unknowns.fluid, guess.contact_pressure)
    base = replace(base, splits=found.splits if base.doublings == found.doublings else ())
    return with_closing(base, guess.mesh, guess.unknowns.gap)


def _split_where_needed(base: Resolution, pair: Pair, rtol: float) -> Resolution:
    """Return a resolution with panels split at the rupture line and where roughness closes the flow."""
    # The radial series at the centre gains nothing from more angles.
    tail = CENTRE_SAFETY["central_gap"] * float(centre_tails(pair.fine)[0])
    crossed = _panels_at_rupture(pair.fine) if tail > rtol * pair.scales["central_gap"] else []
    turning, mesh = kink_tails(pair.fine)[0], pair.fine.mesh
    found = replace(base, splits=tuple(sorted({*base.splits, *crossed})))
    if KINK_LOAD_SAFETY * turning.sum() > rtol:
        found = split_at_kink(found, mesh, turning)
    return with_closing(found, mesh, pair.fine.unknowns.gap)


def _panels_at_rupture(level: Level) -> list[float]:
    """Return the middles of wide panels within the contact that the rupture line crosses."""
    mesh, radii = level.mesh, level.mesh.edges[: level.mesh.log_from + 1]
    cavitated = (level.unknowns.fluid <= level.equations.least)[:, mesh.of_panel[: radii.size - 1]]
    crossed = cavitated.any(axis=(0, 2)) & ~cavitated.all(axis=(0, 2)) & (np.diff(radii) > SPLIT_WIDTH)
    return [0.5 * (a + b) for a, b, wide in zip(radii, radii[1:], crossed, strict=False) if wide and b < 1.0]


def guess_from_rigid_ball(mesh: PolarMesh, speed: float) -> Unknowns:
    """Return the guess from a rigid ball, whose film has half the pressure of its full film."""
    offset = RIGID_CAVITATED * speed**2
    gap = np.tile(offset + 0.5 * mesh.radii**2, (mesh.modes, 1))
    x = mesh.radii * np.cos(mesh.angles)[:, None]
    return Unknowns(gap, np.maximum(-0.2 * speed * x / gap**2, 0.0), offset)


def _first_mesh_level(rtol: float, speed: float, law: ContactLaw, model: Model) -> int:
    """Return the index of the first of the mesh levels that may hold a tolerance."""
    # Ten angles are too few where gas moves and for thin films: five do not measure their error.
    few, many, _ = MESH_LEVELS[0]
    moves = model.cavitation is not Cavitation.EXIT
    return int(moves or RUPTURE_ERROR_TIMES_ANGLES2 / many**2 > rtol or fewest_modes(speed, law, model) > few)


def _mesh_level(pair: Pair) -> int:
    """Return the index of a pair in the mesh levels."""
    return [many for _, many, _ in MESH_LEVELS].index(pair.fine.mesh.modes)


def _pair(
    base: Resolution, mesh_level: tuple[int, int, int], speed: float, law: ContactLaw, start: Unknowns, mesh: PolarMesh
) -> Pair | Outcome:
    """Return a state on the two meshes of a mesh level, or the outcome of the failure."""
    few, many, degree = mesh_level
    coarse = solve_level(
        replace(base, modes=few, degree=degree), speed, law, start, mesh, COARSE_RTOL, max_steps=MAX_STEPS_NEW_MESH
    )
    if not coarse.outcome.ok:
        return coarse.outcome
    finer = replace(base, modes=many, degree=degree + 2)
    fine = solve_level(finer, speed, law, coarse.unknowns, coarse.mesh, ITERATION_RTOL, max_steps=MAX_STEPS_NEW_MESH)
    return pair_of(coarse, fine) if fine.outcome.ok else fine.outcome


def follow_cavitated(
    speed: float, law: ContactLaw, neighbour: Pair, rtol: float, line: Sequence[tuple[float, Pair]] = ()
) -> Pair | None:
    """Return the state from a neighbour, on its meshes if they serve and are not wasteful; None if the iteration fails.

    ``line`` holds states and the weights with which they predict this one and its rupture line.
    """
    rtol = max(rtol, neighbour.fine.equations.finest)
    now, weights = neighbour.fine.resolution, [weight for weight, _ in line]

    def predicted(name: str, mesh: PolarMesh) -> Unknowns:
        return extrapolate_levels(weights, [getattr(pair, name) for _, pair in line], mesh)

    serves, mesh_level = fits(now, speed, law, MIN_PANEL_LOG2), _mesh_level(neighbour)
    lowest, fewer = 1 if serves else _first_mesh_level(rtol, speed, law, now.model), MESH_LEVELS[mesh_level - 1][1]
    is_waste = mesh_level > lowest and _would_hold(neighbour, _coarsening_error(neighbour, rtol, fewer, serves), fewer)
    if not serves or is_waste:
        fine = neighbour.fine
        base = _first_panels(speed, law, fine, now.model)
        start = predicted("fine", fine.mesh) if line else fine.unknowns
        found = _pair(base, MESH_LEVELS[mesh_level - is_waste], speed, law, start, fine.mesh)
        return found if isinstance(found, Pair) else None
    levels: list[Level] = []
    for name, tolerance in (("coarse", COARSE_RTOL), ("fine", ITERATION_RTOL)):
        old: Level = getattr(neighbour, name)
        guess = old.unknowns
        if line:
            guess = predicted(name, old.mesh)
        elif levels:
            guess = _guess_from_coarse(levels[0], neighbour)
        kept = old.iterated.preconditioner
        level = solve_level(old.resolution, speed, law, guess, old.mesh, tolerance, kept, max_steps=15)
        if not level.outcome.ok:
            return None
        levels.append(level)
    return pair_of(*levels)


def _guess_from_coarse(coarse: Level, neighbour: Pair) -> Unknowns:
    """Return the guess on the finer mesh from the coarse state plus the neighbour's coarse-fine difference."""
    old, mesh, least = neighbour.fine.unknowns, neighbour.fine.mesh, coarse.equations.least
    carried = transfer(coarse.unknowns, coarse.mesh, mesh, least)
    known = transfer(neighbour.coarse.unknowns, neighbour.coarse.mesh, mesh, least)
    fluid = np.maximum(carried.fluid + old.fluid - known.fluid, just_above(least))
    return Unknowns(
        carried.gap * (old.gap / known.gap),
        np.where(carried.fluid <= least, least, fluid),
        carried.offset + (old.offset - known.offset),
    )


def holds_cavitated(pair: Pair, rtol: float) -> bool:
    """Return whether the errors of a cavitated state hold a tolerance, or the smallest that its equations allow."""
    return pair.is_enclosed and _would_hold(pair, max(rtol, pair.fine.equations.finest), pair.fine.mesh.modes)


def _coarsening_error(pair: Pair, rtol: float, fewer: int, serves: bool) -> float:
    """Return the stated error up to which a state moves to ``fewer`` angles."""
    if fewer < ASYMPTOTIC_FROM_ANGLES:
        return rtol * (COARSEN_BELOW_SAME_PANELS if serves else COARSEN_BELOW_NEW_PANELS)
    if limited_error(pair) <= 1.001 * ERROR_FLOOR_RATIO * rupture_error_floor(pair.values, pair.fine.mesh.modes):
        # An error at its floor grows as the inverse square of the angles.
        return COARSEN_EXPECTED_BELOW * rtol * (fewer / pair.fine.mesh.modes) ** 2
    return rtol * COARSEN_BELOW_NEW_PANELS


def _would_hold(pair: Pair, rtol: float, angles: int) -> bool:
    """Return whether the errors of a state would hold a tolerance on a mesh of so many angles."""
    loose = max(pair.errors[name] / pair.scales[name] for name in LOOSE_OBSERVABLES)
    return limited_error(pair) <= rtol and (angles > MESH_LEVELS[0][1] or loose <= MAX_LOOSE_RTOL_RATIO * rtol)


def is_cavitated(pair: Pair) -> bool:
    """Return whether a state has cavitated nodes."""
    fine = pair.fine
    return isinstance(fine.equations, CavitatedSystem) and bool((fine.unknowns.fluid <= fine.equations.least).any())


__all__ = ["follow_cavitated", "holds_cavitated", "is_cavitated", "limited_error", "refine_cavitated"]
