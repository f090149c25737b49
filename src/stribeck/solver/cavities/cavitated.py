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
from stribeck.equations.cavities.cavitated import TornEquations, just_above
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
from stribeck.solver.point.level import PROBLEMS, Level, extrapolated, moved, solve_level
from stribeck.solver.point.refinement import (
    CENTRAL,
    TURNED,
    TURNED_MOMENT,
    TURNED_PART,
    Pair,
    angle_error,
    centre_tails,
    halved_near_closing,
    near_closing,
    scales_of,
)
from stribeck.solver.point.state import LOOSE_WHERE_TORN, WITHOUT_TOLERANCE

LADDER = ((5, 10, 8), (10, 20, 8), (15, 30, 8), (20, 45, 10), (30, 65, 10), (45, 95, 10))
"""Numbers of angles of the two meshes whose difference gives the error, and the degree of the first, that of the other being
two higher: on many angles the nodes of the radius leave most of the error."""

ROUGH_FRICTION = 10.0
"""Stated error of friction over the tolerance above which the first of these do not serve: it falls slower than others."""

WASTE, WASTE_ANEW, REGULAR = 0.25, 0.35, 30
"""Stated error over the tolerance below which a state moves to the pair of meshes before the neighbour's; and the same if it
needs other meshes anyway, when it may move to the first, or if that pair has this many angles, with which errors fall
regularly."""

SAFELY = 0.9
"""Error that is expected on fewer angles over the tolerance, at most."""

COMPANY, FRONT = 0.6, 0.04
"""Smallest error that is stated of one observable over the largest, and that of the largest times the square of the number of
angles: as the line of rupture walks from node to node, errors change sign by chance."""

WALK, MOST_WALK = 0.58, 0.142
"""The same over the share of the fluid times the central film, and at most: in thick films both meshes of a pair may err by
the same.  Offsets erred by up to 0.35 times the film over that square, and by up to 0.09."""

DRAG, THIN = ("J_couette", "J_balanced", "J_published"), 0.45
"""Integrals that have the shear, and with it the same error; and the smallest that is stated, times the square of the number
of angles: in thin films with little in the wake they erred by up to 0.39."""

THINNED = 1.6
"""Stated error of friction over that of other fluids, where a fluid thins: drag is smaller, what moves the load is not."""

ALONE = 10.0
"""Smallest error of the minimum film and its place over the largest of all; the tolerance does not limit them."""

NO_GAIN, WIDE = 0.7, 0.2
"""Error over that on fewer angles from which panels are halved that the line of rupture crosses in the contact, as it lies
too far between their nodes; and the width from which they are [a]."""

COARSER = -1.0
"""Binary logarithm of the width of the smallest panel, over the one for the state, down to which panels go on serving along a
path to slower ones: between the nodes the line of rupture leaves more of the error."""

RIGID = 2.0
"""Speed from which a rigid ball is nearer to the state than that of the full film."""

FROM_FAR = 80
"""Steps for a state on other meshes than its neighbour's, or from cold; heavy loads took up to 43."""

TOLERANCE, ROUGH = 1e-6, 1e-5
"""Relative error of the gap that an iteration may leave, a hundredth of the smallest tolerance; and on the coarser of two
meshes, which tells the error of the finer."""


def pair_of(coarse: Level, fine: Level) -> Pair:
    """Return the pair of two levels of one state."""
    assert isinstance(fine.equations, TornEquations)
    speed, slack, order = fine.equations.speed, fine.equations.slack, fine.equations.order
    finer = fine.mesh.modes / coarse.mesh.modes
    part, loose = slack / (finer**order - 1.0), slack / (finer - 1.0)
    values, rough = observables(fine.equations, fine.unknowns), observables(coarse.equations, coarse.unknowns)
    scales = scales_of(values, speed)
    scales["offset"] = max(abs(values["offset"]), values["central_gap"])  # it crosses zero
    parts = (
        dict.fromkeys(values, part) | dict.fromkeys(LOOSE_WHERE_TORN, loose) | dict.fromkeys(WITHOUT_TOLERANCE, 2.0 * loose)
    )
    errors = {
        n: parts[n] * (abs(value - rough[n]) + coarse.iterated.left * scales[n]) + fine.iterated.left * scales[n]
        for n, value in values.items()
    }
    balance = 0.3 * abs(identity_error(values, speed, fine.equations.far))
    for name in ("J_balanced", "J_published", "J_pcx"):
        errors[name] = max(errors[name], balance)
    beyond, doubt = fine.equations.doubt_beyond(fine.unknowns), speed / 6.0 * fine.equations.shear_doubt(fine.unknowns)
    of_load, of_moment = near_closing(fine).sum(axis=1).tolist()
    for name, factor in TURNED_MOMENT.items():
        errors[name] = max(errors[name], factor * of_moment)
    errors["J_poiseuille"] += beyond
    # By the balance of forces and the sum of both parts these three differ by what is known better.
    least = THIN / fine.mesh.modes**2 * scales["J_balanced"]
    errors |= dict.fromkeys(DRAG, max(least, max(errors[name] for name in DRAG) + beyond + doubt))
    for (name, factor), tail in zip(CENTRAL.items(), centre_tails(fine), strict=True):
        errors[name] = max(errors[name], factor * float(tail))
    # Two meshes may agree by chance in one number, hardly in all.
    widest = max(errors[name] / scales[name] for name in errors if name not in (*WITHOUT_TOLERANCE, *LOOSE_WHERE_TORN))
    widest = max(widest, front(values, fine.mesh.modes), TURNED_PART * of_load)
    widest = max(widest, speed / 6.0 * fine.equations.gas_doubt(fine.unknowns) / scales["J_balanced"])  # the film follows it
    company = dict.fromkeys(values, COMPANY if of_load == 0.0 else TURNED) | dict.fromkeys(WITHOUT_TOLERANCE, ALONE)
    errors = {name: max(error, company[name] * widest * scales[name]) for name, error in errors.items()}
    if fine.resolution.model.film.uses_speed:
        errors |= {name: THINNED * errors[name] for name in errors if name.startswith("J_")}
    errors["minimum_angle"] = angle_error(values, errors)
    ok = coarse.outcome.ok and fine.outcome.ok
    outcome = Outcome.CONVERGED if ok else (fine.outcome if coarse.outcome.ok else coarse.outcome)
    steps, krylov = (getattr(coarse.iterated, name) + getattr(fine.iterated, name) for name in ("steps", "krylov_steps"))
    return Pair(coarse, fine, values, errors, scales, outcome, steps, krylov)


def front(values: dict[str, float], angles: int) -> float:
    """Return the smallest error of all that is stated where the line of rupture lies between so many angles."""
    return max(FRONT, min(WALK * values["fluid_load_share"] * values["central_gap"], MOST_WALK)) / angles**2


def held(pair: Pair) -> float:
    """Return the largest of the errors that the tolerance limits."""
    return max(
        pair.errors[name] / pair.scales[name] for name in pair.errors if name not in (*WITHOUT_TOLERANCE, *LOOSE_WHERE_TORN)
    )


def refine_cavitated(
    speed: float, law: ContactLaw, guess: Level, rtol: float, model: Model, known: Pair | None = None
) -> Pair | Outcome:
    """Return a state whose estimated error holds a tolerance from that of a full film, or the best that was found.

    Where that is the film of another fluid it breaks before the fluid changes.  ``known`` is the state with a larger error.
    """
    rtol = max(rtol, PROBLEMS[model.cavitation][0].finest)
    best = known
    try:
        if known is not None:
            now, start, mesh = known.fine.resolution, known.fine.unknowns, known.fine.mesh
            base = _halved(now, known, rtol) if fits(now, speed, law) else _base(speed, law, known.fine, model)
            same = (base.halvings, base.splits, base.closing) == (now.halvings, now.splits, now.closing)
            rung = _rung(known) + same
        else:
            base, rung = _base(speed, law, guess, model), _first_rung(rtol, speed, law, model)
            start, mesh = guess.unknowns, guess.mesh
            if speed >= RIGID and model.cavitation is Cavitation.EXIT:
                mesh = operators_of(base).mesh
                start = rigid(mesh, speed)
            if guess.resolution.model.film != model.film:
                few, _, degree = LADDER[rung]
                other = replace(base, modes=few, degree=degree, model=replace(model, film=guess.resolution.model.film))
                torn = solve_level(other, speed, law, start, mesh, ROUGH, max_steps=FROM_FAR)
                start, mesh = (torn.unknowns, torn.mesh) if torn.outcome.ok else (start, mesh)
        while rung < len(LADDER):
            found = _pair(base, LADDER[rung], speed, law, start, mesh)
            if isinstance(found, Outcome):
                if best is None and rung == 0:
                    rung = 1
                    continue
                return found if best is None else replace(best, outcome=found)
            left = math.inf if best is None else held(best)
            if known is not None and best is not None and _rung(found) > _rung(best) and held(found) >= left > rtol:
                break  # a cold start has panels of its own
            gained = held(found) <= NO_GAIN * left
            best, start, mesh = found, found.fine.unknowns, found.fine.mesh
            if holds_torn(found, rtol):
                return found
            before, base = base, _halved(base, found, rtol if gained else 0.0)
            rung += base.splits == before.splits
    except MeshTooLargeError:
        pass
    return Outcome.REFINEMENT_LIMIT if best is None else replace(best, outcome=Outcome.REFINEMENT_LIMIT)


def _base(speed: float, law: ContactLaw, guess: Level, model: Model) -> Resolution:
    """Return the first resolution of a state of which a level is a guess."""
    few, _, degree = LADDER[0]
    base = resolution(speed, law, degree, few, model)
    if isinstance(guess.equations, TornEquations):  # its line of rupture is no edge of the contact
        mesh = base.mesh
        gap = moved(guess.unknowns, guess.mesh, mesh, guess.equations.least).gap
        contact = law.pressure(gap)
        return with_closing(split_where_poor(base, mesh, np.zeros_like(contact), contact), mesh, gap)
    found = split_where_poor(guess.resolution, guess.mesh, guess.unknowns.fluid, guess.contact_pressure)
    base = replace(base, splits=found.splits if base.doublings == found.doublings else ())
    return with_closing(base, guess.mesh, guess.unknowns.gap)


def _halved(base: Resolution, pair: Pair, rtol: float) -> Resolution:
    """Return a resolution with the panels halved that the line of rupture crosses, where the centre misses a tolerance.

    More angles would not help its series.  Edges enclose where roughness closes the flow, and panels near it are halved where
    they leave more than that.
    """
    tail = CENTRAL["central_gap"] * float(centre_tails(pair.fine)[0])
    crossed = _crossed(pair.fine) if tail > rtol * pair.scales["central_gap"] else []
    turning, mesh = near_closing(pair.fine)[0], pair.fine.mesh
    found = replace(base, splits=tuple(sorted({*base.splits, *crossed})))
    if TURNED_PART * turning.sum() > rtol:
        found = halved_near_closing(found, mesh, turning)
    return with_closing(found, mesh, pair.fine.unknowns.gap)


def _crossed(level: Level) -> list[float]:
    """Return the middles of wide panels in the contact that the line of rupture crosses."""
    mesh, radii = level.mesh, level.mesh.edges[: level.mesh.log_from + 1]
    torn = (level.unknowns.fluid <= level.equations.least)[:, mesh.of_panel[: radii.size - 1]]
    crossed = torn.any(axis=(0, 2)) & ~torn.all(axis=(0, 2)) & (np.diff(radii) > WIDE)
    return [0.5 * (a + b) for a, b, wide in zip(radii, radii[1:], crossed, strict=False) if wide and b < 1.0]


def rigid(mesh: PolarMesh, speed: float) -> Unknowns:
    """Return a guess from a rigid ball: half of the pressure of its full film."""
    offset = RIGID_CAVITATED * speed**2
    gap = np.tile(offset + 0.5 * mesh.radii**2, (mesh.modes, 1))
    x = mesh.radii * np.cos(mesh.angles)[:, None]
    return Unknowns(gap, np.maximum(-0.2 * speed * x / gap**2, 0.0), offset)


def _first_rung(rtol: float, speed: float, law: ContactLaw, model: Model) -> int:
    """Return the place on the ladder of the first pair that may hold a tolerance.

    Ten angles are too few where gas moves, and for thin films: five tell nothing of their errors.
    """
    few, many, _ = LADDER[0]
    moves = model.cavitation is not Cavitation.EXIT
    return int(moves or FRONT / many**2 > rtol or fewest_modes(speed, law, model) > few)


def _rung(pair: Pair) -> int:
    """Return the place on the ladder of a pair."""
    return [many for _, many, _ in LADDER].index(pair.fine.mesh.modes)


def _pair(
    base: Resolution, rung: tuple[int, int, int], speed: float, law: ContactLaw, start: Unknowns, mesh: PolarMesh
) -> Pair | Outcome:
    """Return a state on two meshes of a resolution, with few and with many angles, or the outcome of the failure."""
    few, many, degree = rung
    coarse = solve_level(replace(base, modes=few, degree=degree), speed, law, start, mesh, ROUGH, max_steps=FROM_FAR)
    if not coarse.outcome.ok:
        return coarse.outcome
    finer = replace(base, modes=many, degree=degree + 2)
    fine = solve_level(finer, speed, law, coarse.unknowns, coarse.mesh, TOLERANCE, max_steps=FROM_FAR)
    return pair_of(coarse, fine) if fine.outcome.ok else fine.outcome


def follow_cavitated(
    speed: float, law: ContactLaw, neighbour: Pair, rtol: float, line: Sequence[tuple[float, Pair]] = ()
) -> Pair | None:
    """Return the state of a neighbour's meshes at other groups, or None where it does not come from there.

    If these meshes do not serve, or are finer than necessary, the state is found on others.  ``line`` has neighbours, and the
    weights with which they predict the state, its line of rupture too.
    """
    rtol = max(rtol, neighbour.fine.equations.finest)
    now, weights = neighbour.fine.resolution, [weight for weight, _ in line]

    def predicted(name: str, mesh: PolarMesh) -> Unknowns:
        return extrapolated(weights, [getattr(pair, name) for _, pair in line], mesh)

    serves, rung = fits(now, speed, law, COARSER), _rung(neighbour)
    lowest, fewer = 1 if serves else _first_rung(rtol, speed, law, now.model), LADDER[rung - 1][1]
    is_waste = rung > lowest and _within(neighbour, _waste(neighbour, rtol, fewer, serves), fewer)
    if not serves or is_waste:
        fine = neighbour.fine
        base = _base(speed, law, fine, now.model)
        start = predicted("fine", fine.mesh) if line else fine.unknowns
        found = _pair(base, LADDER[rung - is_waste], speed, law, start, fine.mesh)
        return found if isinstance(found, Pair) else None
    levels: list[Level] = []
    for name, tolerance in (("coarse", ROUGH), ("fine", TOLERANCE)):
        old: Level = getattr(neighbour, name)
        guess = old.unknowns
        if line:
            guess = predicted(name, old.mesh)
        elif levels:
            guess = _carried(levels[0], neighbour)
        kept = old.iterated.preconditioner
        level = solve_level(old.resolution, speed, law, guess, old.mesh, tolerance, kept, max_steps=15)
        if not level.outcome.ok:
            return None
        levels.append(level)
    return pair_of(*levels)


def _carried(coarse: Level, neighbour: Pair) -> Unknowns:
    """Return a guess on the finer mesh: its difference from the coarser one is that of the neighbour."""
    old, mesh, least = neighbour.fine.unknowns, neighbour.fine.mesh, coarse.equations.least
    carried = moved(coarse.unknowns, coarse.mesh, mesh, least)
    known = moved(neighbour.coarse.unknowns, neighbour.coarse.mesh, mesh, least)
    fluid = np.maximum(carried.fluid + old.fluid - known.fluid, just_above(least))
    return Unknowns(
        carried.gap * (old.gap / known.gap),
        np.where(carried.fluid <= least, least, fluid),
        carried.offset + (old.offset - known.offset),
    )


def holds_torn(pair: Pair, rtol: float) -> bool:
    """Return whether the errors of a state hold a tolerance, or the smallest that is aimed at."""
    return pair.is_enclosed and _within(pair, max(rtol, pair.fine.equations.finest), pair.fine.mesh.modes)


def _waste(pair: Pair, rtol: float, fewer: int, serves: bool) -> float:
    """Return the stated error up to which a state moves to fewer angles, where its panels serve or not.

    Where it is the smallest that is stated of all it grows with the square of the angles.
    """
    if fewer < REGULAR:
        return rtol * (WASTE if serves else WASTE_ANEW)
    if held(pair) <= 1.001 * COMPANY * front(pair.values, pair.fine.mesh.modes):
        return SAFELY * rtol * (fewer / pair.fine.mesh.modes) ** 2
    return rtol * WASTE_ANEW


def _within(pair: Pair, rtol: float, angles: int) -> bool:
    """Return whether the errors of a state would be within a tolerance on a mesh of this many angles."""
    loose = max(pair.errors[name] / pair.scales[name] for name in LOOSE_WHERE_TORN)
    return held(pair) <= rtol and (angles > LADDER[0][1] or loose <= ROUGH_FRICTION * rtol)


def is_torn(pair: Pair) -> bool:
    """Return whether the film of a state breaks."""
    fine = pair.fine
    return isinstance(fine.equations, TornEquations) and bool((fine.unknowns.fluid <= fine.equations.least).any())


__all__ = ["follow_cavitated", "held", "holds_torn", "is_torn", "refine_cavitated"]
