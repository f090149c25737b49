"""Refining a state of a ball until its estimated error holds a tolerance, and following it from neighbour to neighbour.

Each state is solved on two meshes, the second finer in radius *and* angle: either alone misleads.  The state is that on the
finer one; the difference of its observables from those on the coarser one gives their errors.  The next finer mesh is compared
with the finer one of before, unless panels are split first, where their fields are poorly resolved.

A film that re-forms is solved as the full one where its suction stays above the pressure of the cavity.
"""

import math
from dataclasses import replace

import numpy as np

from stribeck._types import Array
from stribeck.contact_laws.law import ContactLaw
from stribeck.contacts.groups import Model
from stribeck.equations.cavities.system import just_above
from stribeck.equations.point.mesh_choice import (
    MeshTooLargeError,
    Resolution,
    bytes_of,
    fits,
    in_tens,
    operators_of,
    resolution,
    rigid_height,
    split_where_poor,
)
from stribeck.equations.point.system import Unknowns
from stribeck.fluids.fluid import Cavitation
from stribeck.numerics.fourier_panels import PolarMesh
from stribeck.numerics.settings import (
    COARSE_RTOL,
    HALF_DIGITS,
    LEAST_DEGREE,
    LEAST_MODES,
    LEGENDRE_DECAY,
    MAX_BYTES,
    MAX_DEGREE,
    MAX_MODES,
    MAX_REFINEMENTS,
    MINIMUM_RTOL_FACTOR,
    MODES_RATIO,
    NEGLIGIBLE,
    SHARE,
)
from stribeck.quantities.outcome import Outcome
from stribeck.solver.point.estimate import Pair, gap_tails, modal_amplitudes, pair_of
from stribeck.solver.point.level import PROBLEMS, Level, solve_level, transfer
from stribeck.solver.refinement import newton_tolerance


def holds(pair: Pair, rtol: float) -> bool:
    """Return whether the errors of a state hold a tolerance, and that of its minimum film a multiple of it."""
    return excess_of(pair, max(rtol, pair.fine.equations.finest)) <= 1.0


def is_cavitated(pair: Pair) -> bool:
    """Return whether a state has cavitated nodes."""
    return bool((pair.fine.unknowns.fluid <= pair.fine.equations.least).any())


def refine(
    speed: float, law: ContactLaw, guess: Level, rtol: float, model: Model, known: Pair | None = None
) -> Pair | Outcome:
    """Return a state that holds a tolerance, or the best found, from a coarse state or from a ``known`` one."""
    rtol = max(rtol, PROBLEMS[model.cavitation][0].finest)
    tolerance = newton_tolerance(rtol)
    best, coarse, failure = known, None, Outcome.REFINEMENT_LIMIT
    try:
        if known is None:
            wanted, start, mesh = first_mesh(speed, law, guess, rtol, model)
        else:
            (wanted, coarse), start, mesh = next_mesh(known, rtol), known.fine.unknowns, known.fine.mesh
        for _ in range(MAX_REFINEMENTS):
            if coarse is None:
                coarse = solve_level(wanted.coarser(), speed, law, start, mesh, tolerance)
                start, mesh = coarse.unknowns, coarse.mesh
            if coarse.outcome.ok and bytes_of(wanted) > NEGLIGIBLE * MAX_BYTES:
                coarse, best = without_preconditioner(coarse), best and best.without_operators()
            fine = coarse
            if coarse.outcome.ok:
                fine = solve_level(wanted, speed, law, start, mesh, tolerance)
            if not fine.outcome.ok:
                if best is not None or failure is not Outcome.REFINEMENT_LIMIT:
                    failure = fine.outcome
                    break
                # On a mesh that hardly resolves the film the equations may have no state: one more try, on finer ones.
                finer = finer_in(fine.resolution, radii=True, angles=True)
                failure, wanted, coarse = fine.outcome, limit_modes(finer_in(finer, radii=True, angles=True)), None
                continue
            pair = pair_of(coarse, fine)
            if best is None or pair.total < best.total or best.total <= rtol:
                best = pair
            if holds(pair, rtol):
                return pair
            before, start, mesh = wanted, fine.unknowns, fine.mesh
            wanted, coarse = next_mesh(pair, rtol)
            if wanted == before:
                break
    except MeshTooLargeError as problem:
        if best is None:
            return problem.outcome
    if best is None:
        return failure
    if best.total <= rtol:
        return best
    lost = float(np.finfo(float).eps) / best.scales["J_pcx"]
    return replace(best, outcome=Outcome.ROUNDING if lost > NEGLIGIBLE * rtol else failure)


def without_preconditioner(level: Level) -> Level:
    """Return a state without its preconditioner, the largest part of its memory."""
    return replace(level, iterated=replace(level.iterated, preconditioner=None))


def first_mesh(
    speed: float, law: ContactLaw, guess: Level, rtol: float, model: Model
) -> tuple[Resolution, Unknowns, PolarMesh]:
    """Return the first mesh from cold, and a guess with its mesh."""
    guess = solve_on_split_panels(guess, speed, law)
    start, mesh = guess.unknowns, guess.mesh
    if model.cavitation is Cavitation.NONE:
        amplitudes = modal_amplitudes(guess)
        # Pressures at an edge fall by this factor a degree.
        degree = math.ceil(math.log(LEGENDRE_DECAY / rtol) / math.log(LEGENDRE_DECAY))
        of_minimum = min(1.0, MINIMUM_RTOL_FACTOR * rtol)
        modes = max(MODES_RATIO * modes_for(amplitudes, math.sqrt(rtol)), modes_for(amplitudes, NEGLIGIBLE**2 * of_minimum))
        wanted = replace(
            guess.resolution,
            degree=min(MAX_DEGREE, max(LEAST_DEGREE, degree)),
            modes=2 * math.ceil(0.5 * max(modes, LEAST_MODES)),
        )
        return limit_modes(wanted), start, mesh
    wanted = resolution(speed, law, LEAST_DEGREE + 1, in_tens(LEAST_MODES), model)
    if wanted.doublings == guess.resolution.doublings:
        wanted = replace(wanted, splits=guess.resolution.splits)
    if rigid_height(speed) > 1.0 and model.cavitation is Cavitation.EXIT:
        mesh = operators_of(wanted).mesh
        start = guess_from_rigid_ball(mesh, speed)
    return wanted, start, mesh


def guess_from_rigid_ball(mesh: PolarMesh, speed: float) -> Unknowns:
    """Return the guess from a rigid ball, whose film has half the pressure of its full film."""
    offset = rigid_height(speed)
    gap = np.tile(offset + 0.5 * mesh.radii**2, (mesh.modes, 1))
    x = mesh.radii * np.cos(mesh.angles)[:, None]
    return Unknowns(gap, np.maximum(-0.2 * speed * x / gap**2, 0.0), offset)


def solve_on_split_panels(guess: Level, speed: float, law: ContactLaw) -> Level:
    """Return a guess solved again on panels split until they resolve its pressures."""
    for _ in range(MAX_REFINEMENTS):
        better = improved_panels(guess)
        if better == guess.resolution:
            break
        on_more = solve_level(better, speed, law, guess.unknowns, guess.mesh, NEGLIGIBLE * COARSE_RTOL)
        if not on_more.outcome.ok:
            break
        guess = on_more
    return guess


def improved_panels(level: Level) -> Resolution:
    """Return the resolution of a state with its poorly resolved panels split."""
    # The pressure of a film has a kink at its line of rupture, which moves from angle to angle: no panel resolves it.
    breaks = not level.resolution.is_full
    fluid = np.zeros_like(level.unknowns.fluid) if breaks else level.unknowns.fluid
    return split_where_poor(level.resolution, level.mesh, fluid, level.contact_pressure)


def next_mesh(pair: Pair, rtol: float) -> tuple[Resolution, Level | None]:
    """Return the next finer mesh within the limits, and the state on its coarser companion if that is solved already."""
    now = pair.fine.resolution
    needs_radii, needs_angles = needed_directions(pair, rtol)
    wanted = improved_panels(pair.fine) if needs_radii else now
    if wanted != now:
        return wanted, None
    limited = limit_modes(finer_in(now, needs_radii, needs_angles))
    if limited.modes < now.modes:
        return now, None
    return limited, pair.fine if now.is_full and limited == now.finer() else None


def needed_directions(pair: Pair, rtol: float) -> tuple[bool, bool]:
    """Return whether a finer mesh needs more nodes along radii, and more angles."""
    if not pair.fine.resolution.is_full:
        return True, True
    # On a mesh that is finer in one direction alone the errors of the other one are left.
    radial, angular = gap_tails(pair.fine)
    excess = excess_of(pair, rtol)
    return excess * radial > SHARE * angular, excess * angular > SHARE * radial


def excess_of(pair: Pair, rtol: float) -> float:
    """Return the error of a state over what its tolerance allows."""
    return max(pair.total, pair.minimum / MINIMUM_RTOL_FACTOR) / rtol


def finer_in(now: Resolution, radii: bool, angles: bool) -> Resolution:
    """Return a mesh that is finer along radii, in angles, or both."""
    finer = now.finer()
    if not now.is_full:
        return finer
    degree = max(now.degree, min(finer.degree, MAX_DEGREE)) if radii else now.degree
    return replace(finer, degree=degree, modes=finer.modes if angles else now.modes)


def limit_modes(wanted: Resolution) -> Resolution:
    """Return a resolution with at most as many modes as memory and :data:`MAX_MODES` allow."""
    wanted = replace(wanted, modes=min(wanted.modes, MAX_MODES))
    while bytes_of(wanted) > MAX_BYTES and wanted.modes > LEAST_MODES:
        wanted = replace(wanted, modes=2 * ((wanted.modes - 1) // 2))
    return wanted


def modes_for(found: Array, amplitude: float) -> int:
    """Return the number of modes whose geometrically decaying amplitudes exceed a bound."""
    below = np.flatnonzero(found > amplitude)
    last = int(below[-1]) + 1 if below.size else 1
    if last < found.size - 2:
        return last
    half = slice(max(2, found.size // 2), found.size - 1)
    m = np.arange(found.size)[half]
    rate, level_at = np.polyfit(m, np.log(np.maximum(found[half], 1e-300)), 1)
    return min(MAX_MODES, math.ceil(float((math.log(amplitude) - level_at) / min(rate, -1e-3))))


def follow(
    speed: float,
    law: ContactLaw,
    neighbour: Pair,
    rtol: float,
    prediction: Unknowns | None = None,
) -> Pair | None:
    """Return the state of other groups from a neighbour, on its meshes where they fit; None if the iteration fails.

    The prediction, on the neighbour's finer mesh, is the neighbour itself by default.
    """
    rtol = max(rtol, neighbour.fine.equations.finest)
    now, old = neighbour.fine.resolution, neighbour.coarse
    tolerance, wanted = newton_tolerance(rtol), mesh_for_neighbour(speed, law, neighbour, rtol)
    mesh = neighbour.fine.mesh
    start = neighbour.fine.unknowns if prediction is None else prediction
    # From a guess that needs much shorter steps a film is not found sooner than from cold, if at all.
    least_part = NEGLIGIBLE if now.is_full else HALF_DIGITS
    if wanted != now:
        coarse = solve_level(wanted.coarser(), speed, law, start, mesh, tolerance, least_part=least_part)
        if not coarse.outcome.ok:
            return None
        fine = solve_level(wanted, speed, law, coarse.unknowns, coarse.mesh, tolerance)
        return pair_of(coarse, fine) if fine.outcome.ok else None
    guess = old.unknowns if prediction is None else on_other_mesh(prediction, mesh, neighbour.fine, old)
    coarse = solve_level(old.resolution, speed, law, guess, old.mesh, tolerance, old.iterated.preconditioner, least_part)
    if not coarse.outcome.ok:
        return None
    if prediction is None or now.is_full:
        start = on_other_mesh(coarse.unknowns, coarse.mesh, old, neighbour.fine)
    fine = solve_level(now, speed, law, start, mesh, tolerance, neighbour.fine.iterated.preconditioner)
    return pair_of(coarse, fine) if fine.outcome.ok else None


def on_other_mesh(y: Unknowns, mesh: PolarMesh, here: Level, there: Level) -> Unknowns:
    """Return unknowns on the mesh of one level of a neighbour, by how that differs from its other, of about their mesh."""
    least, other = here.equations.least, there.unknowns
    carried, known = (transfer(each, on, there.mesh, least) for each, on in ((y, mesh), (here.unknowns, here.mesh)))
    fluid = np.maximum(carried.fluid + other.fluid - known.fluid, just_above(least))
    return Unknowns(
        carried.gap * (other.gap / known.gap),
        np.where(carried.fluid <= least, least, fluid),
        carried.offset + (other.offset - known.offset),
    )


def mesh_for_neighbour(speed: float, law: ContactLaw, neighbour: Pair, rtol: float) -> Resolution:
    """Return the finer mesh for a state beside a neighbour: that one, a coarser one where it is far better than needed."""
    now, fine = neighbour.fine.resolution, neighbour.fine
    breaks = not now.is_full
    if breaks:  # errors fall as a power of the angles
        is_waste = neighbour.total < 0.5 * 0.5**fine.equations.order * rtol
    else:  # errors fall geometrically
        allowed = min(1.0, MINIMUM_RTOL_FACTOR * rtol)
        is_waste = neighbour.total < rtol**MODES_RATIO and neighbour.minimum < allowed**MODES_RATIO
    leaner = now.leaner()
    fewer_radii = fewer_angles = is_waste
    excess = excess_of(neighbour, rtol)
    if now.is_full and excess <= SHARE:  # or one direction is resolved far better than the other
        radial, angular = gap_tails(neighbour.coarse)
        fewer_radii, fewer_angles = is_waste or radial < angular**MODES_RATIO, is_waste or angular < radial**MODES_RATIO
    wanted = replace(
        now,
        degree=min(now.degree, max(leaner.degree, LEAST_DEGREE + breaks)) if fewer_radii else now.degree,
        modes=min(now.modes, max(leaner.modes, LEAST_MODES)) if fewer_angles else now.modes,
    )
    if fits(now, speed, law):
        return wanted
    if now.is_full and excess > SHARE and needed_directions(neighbour, rtol)[1]:
        wanted = limit_modes(replace(wanted, modes=now.finer().modes))  # as many angles would hardly do there
    found = resolution(speed, law, wanted.degree, wanted.modes, now.model)
    if found.halvings > now.halvings:  # for the next neighbours too, which will be as much thinner
        found = replace(found, halvings=found.halvings + 1)
    return improved_panels(fine.on(found))


def full_model(model: Model) -> Model:
    """Return a model without cavitation."""
    return replace(model, cavitation=Cavitation.NONE, cavity_pressure=0.0)


def refine_reforming(
    speed: float, law: ContactLaw, guess: Level, rtol: float, model: Model, known: Pair | None = None
) -> Pair | Outcome:
    """Return a state that holds a tolerance, from a coarse one or a ``known`` one with a larger error, or the best found."""
    full = guess.relabelled(full_model(model))
    if known is not None and not known.fine.breaks:
        return _refine_full_film(speed, law, full, rtol, model, known) or refine(speed, law, guess, rtol, model)
    if known is None and guess.unknowns.fluid.min() >= model.cavity_pressure:
        found = _refine_full_film(speed, law, full, rtol, model)
        if found is not None:
            return found
    cavitated = refine(speed, law, guess, rtol, model, known)
    if not isinstance(cavitated, Pair):
        return cavitated
    if cavitated.outcome.ok and not is_cavitated(cavitated):
        return _refine_full_film(speed, law, cavitated.fine.relabelled(full.resolution.model), rtol, model) or cavitated
    reaches_rim = bool((cavitated.fine.unknowns.fluid[:, -1] <= model.cavity_pressure).any())
    return replace(cavitated, outcome=Outcome.MESH_LIMIT) if reaches_rim else cavitated


def follow_reforming(
    speed: float, law: ContactLaw, neighbour: Pair, rtol: float, prediction: Unknowns | None = None
) -> Pair | None:
    """Return the state of other groups from a neighbour, on its meshes if they serve; None if the iteration fails."""
    model = neighbour.fine.resolution.model
    if neighbour.fine.breaks:
        found = follow(speed, law, neighbour, rtol, prediction)
        if found is None or is_cavitated(found):
            return found
        return _refine_full_film(speed, law, found.fine.relabelled(full_model(model)), rtol, model)
    full = full_model(model)
    found = follow(speed, law, neighbour.relabelled(full), rtol, prediction)
    if found is None or not found.outcome.ok:
        return None
    if found.fine.unknowns.fluid.min() >= model.cavity_pressure:
        return found.relabelled(model)
    cavitated = refine(speed, law, found.fine, rtol, model)
    return cavitated if isinstance(cavitated, Pair) and cavitated.outcome.ok else None


def _refine_full_film(
    speed: float, law: ContactLaw, guess: Level, rtol: float, model: Model, known: Pair | None = None
) -> Pair | None:
    """Return the full film relabelled with the model, or None if its suction exceeds the cavity's or none is found."""
    full = guess.resolution.model
    found = refine(speed, law, guess, rtol, full, None if known is None else known.relabelled(full))
    if not isinstance(found, Pair) or not found.fine.unknowns.fluid.min() >= model.cavity_pressure:
        return None
    return found.relabelled(model)
