"""Refining a state of the point contact until its estimated error holds a tolerance.

Each state is solved on two meshes, the second finer in radius *and* angle: either alone misleads.  The state is that on the
finer one; the difference of its observables from those on the coarser one gives their errors.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from stribeck._types import Array
from stribeck.contact_laws.law import ContactLaw
from stribeck.contacts.model import Model
from stribeck.equations.point.mesh_choice import (
    EDGE,
    MOST_BYTES,
    MOST_MODES,
    SIDE_LOBES,
    MeshTooLargeError,
    Resolution,
    bytes_of,
    fits,
    layout,
    resolution,
    split_where_poor,
    with_closing,
)
from stribeck.equations.point.minimum import reach_of
from stribeck.equations.point.observables import MINIMA, identity_error, observables
from stribeck.equations.point.system import Unknowns
from stribeck.equations.state import closed_gap
from stribeck.fluids.shear_thinning import ShearThinning
from stribeck.numerics.fourier_panels import PolarMesh
from stribeck.quantities.outcome import Outcome
from stribeck.solver.point.level import Level, band_for, extrapolated, moved, solve_level

WASTE = 0.03
"""Estimated error over the tolerance below which a neighbour's mesh is tested for being finer than necessary."""

SAVED = 0.4
"""Memory of a coarser mesh over that of the neighbour's below which new operators pay off."""

AHEAD = 0.2
"""Speed over that of the state for which panels are made along a path to slower ones."""

PART = 0.35
"""Stated error over the difference between the two meshes: the finer one is better than this."""

TURNED, TURNED_PART, ABOUT_CLOSED = 1.0, 0.25, (0.8, 1.3)
"""The same near where roughness closes the flow, and the smallest error of one observable over the largest; that of the
load over that of the last coefficients of the pressure on panels there; and the gaps that are near, over that at which the
flow closes."""

TURNED_MOMENT = {"J_published": 1.25, "J_pcx": 1.0, "J_poiseuille": 0.3}
"""That of friction integrals over the moment of these coefficients: it is a small difference of two halves."""

TELLING, NARROWEST_TURNED = 0.1, 0.05
"""Part that panels have in these errors from which they are halved, and their width over the scale above which they are."""

COMPANY, THINNED_COMPANY = 0.1, 1.0
"""Smallest error that is stated of one observable over the largest of all, each relative to its scale; where a fluid thins."""

CENTRAL = {"central_gap": 0.5, "central_pressure": 2.0}
"""Stated error of gap and pressure at the centre over the last coefficients of their series on the first panel, where no
node lies at the centre and the equations for the pressure weigh it with the radius."""

UNSEEN, UNSEEN_RADIAL, UNSEEN_SERIES = 5.0, 0.5, 0.4
"""Stated error of the minimum film over the last coefficients of its series in the angle, and in the radius; and over
the sum of the angular one, continued as a geometric series."""

PLACE, LOWER = ("minimum_radius", "minimum_angle"), 0.5
"""Stated error of the place of the minimum film over how far from there the gap rises by the error of that film, at least:
it moved by up to 0.47 of that, and two meshes may agree by chance."""

THINNED_MINIMUM, THINNED, THINNED_DRAG, THINNED_FRICTION = 1.5, 1.5e-3, 3e-2, 2.0
"""Where a fluid thins: stated error of the minimum film over that of other fluids, and the least error of all else over it,
and of friction, as the viscosity has peaks where hardly anything is sheared; and that of friction over the others'."""

NEARLY_ROLLING, MOST_OVER_SLIDE = 0.25, 4.0
"""Half the slide-to-roll ratio below which these errors of friction grow as one over it, and by how much at most."""

CUSP = 4e-3
"""Least stated error of the minimum film, times the number of angles, where the viscosity has a cusp, or no bound, at places
that are not sheared."""

SLOWEST_DECAY = 0.02
"""Smallest rate at which the coefficients are taken to fall."""

MINIMUM_SLACK, PATH_SLACK = 100.0, 1000.0
"""Tolerance of the minimum film over that of the other observables: of a cold state, and along a path."""

PANEL_RATE = 1.49
"""Logarithm by which one degree more reduces the error of a pressure that has a square root at one panel's distance."""

FINER_DEGREE, FINER_MODES = 2, 1.4
"""Additional degree of the finer of two meshes, and the ratio of their numbers of modes."""

THICK = 0.05
"""Film above which the degree of a first mesh does not fall: the pressures of thick films are of order one."""

MOST_DEGREE = 18
MOST_ROUNDS = 6

ROUNDING = 0.03
"""Rounding of the friction over the tolerance above which it may keep the error above the tolerance."""

LARGE = 200_000_000
"""Memory of the finer mesh from which the preconditioners of coarser ones are not kept for neighbours."""


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

    def named(self, model: Model) -> Pair:
        """Return the pair as one from which states of a model start."""
        return replace(self, coarse=self.coarse.named(model), fine=self.fine.named(model))

    @property
    def total(self) -> float:
        """Largest error relative to its scale, but for those of the minimum film."""
        return max(self.errors[name] / self.scales[name] for name in self.errors if name not in MINIMA)

    @property
    def minimum(self) -> float:
        """Relative error of the minimum film."""
        return self.errors["minimum_gap"] / self.scales["minimum_gap"]

    @property
    def is_enclosed(self) -> bool:
        """Whether edges of panels enclose where roughness closes the flow: two degrees do not tell the error of a kink."""
        now = self.fine.resolution
        return with_closing(now, self.fine.mesh, self.fine.unknowns.gap) == now

    def holds(self, rtol: float, slack: float) -> bool:
        """Return whether the errors hold a tolerance, that of the minimum film one that is larger by ``slack``."""
        return self.is_enclosed and self.total <= rtol and self.minimum <= slack * rtol


def modal_amplitudes(level: Level) -> Array:
    """Return the largest amplitude of each angular mode of the gap, within twice the scale of the contact."""
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
    rate = min(rate, -SLOWEST_DECAY)
    return int(math.ceil((math.log(amplitude) - level_at) / rate))


def unseen_in_angle(level: Level) -> float:
    """Return an estimate of the truncation error of the minimum film's series in the angle, relative to the film.

    It is the last coefficients, or the geometric series that continues them; in thin films these fall slowly.
    """
    mesh, h = level.mesh, level.unknowns.gap
    near = mesh.radii < 2.0 * 2.0**level.resolution.doublings
    found = (np.abs(mesh.to_modes @ h) / h.min(axis=0))[:, near].max(axis=1)
    half = slice(max(2, found.size // 2), found.size - 1)
    m = np.arange(found.size)[half]
    rate = -np.polyfit(m, np.log(np.maximum(found[half], 1e-300)), 1)[0] if m.size > 1 else 1.0
    beyond = float(found[-2:].max()) / -math.expm1(-max(rate, SLOWEST_DECAY))
    return max(UNSEEN * float(modal_amplitudes(level)[-2:].max()), UNSEEN_SERIES * beyond)


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


def near_closing(level: Level) -> Array:
    """Return load and moment of the last Legendre coefficients of the pressure on panels, where roughness closes the flow.

    There the mobility turns sharply, and two meshes may err by the same.  Of shape (2, panels), the load over that of the
    contact; zero elsewhere.
    """
    mesh, closed_at = level.mesh, closed_gap(level.resolution.model.film)
    found = np.zeros((2, mesh.panels))
    if closed_at is None:
        return found
    low, high = ABOUT_CLOSED
    gap = mesh.scattered(level.unknowns.gap) / closed_at
    near = (gap.min(axis=(0, 2)) < high) & (gap.max(axis=(0, 2)) > low)
    first_two = mesh.to_modes[:2] @ (level.unknowns.fluid + level.contact_pressure)
    tails = np.abs(mesh.legendre(first_two)[..., -2:]).max(axis=-1)
    radii, widths = 0.5 * (mesh.edges[1:] + mesh.edges[:-1]), np.diff(mesh.edges)
    found[:, near] = (tails * radii * widths * [1.5 * np.ones(mesh.panels), 0.5 * math.pi * radii])[:, near]
    return found


def halved_near_closing(found: Resolution, mesh: PolarMesh, parts: Array) -> Resolution:
    """Return a resolution with the wide panels halved that leave most of an error, by ``parts`` of it on the panels."""
    wide = np.diff(mesh.edges) > NARROWEST_TURNED * 2.0**found.doublings
    middles = 0.5 * (mesh.edges[1:] + mesh.edges[:-1])[wide & (parts > TELLING * parts.sum())]
    return replace(found, splits=tuple(sorted({*found.splits, *middles.tolist()})))


def scales_of(values: dict[str, float], speed: float, drag: float = 0.0) -> dict[str, float]:
    """Return the scales of errors: one for shares, a radius or an angle, else about the observable itself.

    That of friction is ``drag`` at least.
    """
    friction = max(abs(values["J_balanced"]), abs(values["J_published"]), speed, drag) if speed > 0 else 1.0
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
    scales = scales_of(values, fine.equations.speed, fine.equations.drag_beyond)
    kinked = float(near_closing(fine)[1].sum())
    part = TURNED if kinked > 0.0 else PART
    errors = {name: part * abs(value - rough[name]) + fine.iterated.left * scales[name] for name, value in values.items()}
    # Interpolated minima of two meshes may agree by chance: the truncation of the series bounds their error from below.
    balance = 0.3 * abs(identity_error(values, fine.equations.speed))
    for name in ("J_balanced", "J_published", "J_pcx"):
        errors[name] = max(errors[name], balance)
    for name, factor in TURNED_MOMENT.items():
        errors[name] = max(errors[name], factor * kinked)
    beyond = fine.equations.doubt_beyond(fine.unknowns)
    for name in ("J_couette", "J_poiseuille", "J_balanced", "J_published"):
        errors[name] += beyond
    for (name, factor), tail in zip(CENTRAL.items(), centre_tails(fine), strict=True):
        errors[name] = max(errors[name], factor * float(tail))
    unseen = UNSEEN_RADIAL * legendre_tail(fine)
    if fine.equations.speed > 0:
        unseen += unseen_in_angle(fine)
    # Two meshes may agree by chance in one number, hardly in all.
    widest = max(errors[name] / scales[name] for name in errors if name not in MINIMA)
    least = (TURNED if kinked > 0.0 else COMPANY) * widest
    if fine.resolution.model.film.uses_speed:
        unseen *= THINNED_MINIMUM
        least = max(THINNED_COMPANY * widest, THINNED * unseen)
        widest = max(widest, THINNED * unseen / COMPANY)
    errors = {name: max(error, least * scales[name]) for name, error in errors.items()}
    # Differences of the terms of a sum may cancel by chance where their errors do not.
    errors["J_balanced"] = max(errors["J_balanced"], math.hypot(errors["J_couette"], errors["J_poiseuille"]))
    errors["J_published"] = max(errors["J_published"], math.hypot(errors["J_balanced"], errors["J_pcx"]))
    film = fine.resolution.model.film
    if film.uses_speed:
        # By the identity of the integrals the moment of the contact pressure is the difference of both drags.
        errors["J_pcx"] = max(errors["J_pcx"], max(THINNED_FRICTION * least, THINNED_DRAG * unseen) * scales["J_pcx"])
        # Drag is the stress over the slide.
        drag = max(THINNED_FRICTION * least, THINNED_DRAG * unseen)
        drag *= min(MOST_OVER_SLIDE, max(1.0, NEARLY_ROLLING / abs(film.slide))) if film.slide else 1.0
        for name in ("J_couette", "J_poiseuille", "J_balanced", "J_published"):
            errors[name] = max(errors[name], drag * scales[name])
    # The series of the side lobes falls from one mesh to the other as the error of the minimum does.
    last, before = (float(modal_amplitudes(level)[-2:].max()) for level in (fine, coarse))
    gained = 2.0 * min(PART, max(0.05, last / max(before, 1e-300)))
    for name in ("minimum_gap", "minimum_gap_on_axis"):
        errors[name] = max(gained * abs(values[name] - rough[name]), max(unseen, COMPANY * widest) * scales[name])
    if isinstance(film, ShearThinning) and film.law.plateau < 1:
        for name in ("minimum_gap", "minimum_gap_on_axis", "minimum_radius"):
            errors[name] = max(errors[name], CUSP / fine.mesh.modes * scales[name])
    for name in ("minimum_radius", "minimum_angle"):
        errors[name] = max(4.0 * errors[name], unseen * (2.0 if fine.resolution.model.film.uses_speed else 1.0))
    place = values["minimum_radius"], values["minimum_angle"]
    for name, reach in zip(PLACE, reach_of(fine.mesh, fine.unknowns.gap, *place, errors["minimum_gap"]), strict=True):
        errors[name] = max(errors[name], LOWER * reach)
    errors["minimum_angle"] = angle_error(values, errors)
    ok = coarse.outcome.ok and fine.outcome.ok
    outcome = Outcome.CONVERGED if ok else (fine.outcome if coarse.outcome.ok else coarse.outcome)
    steps = coarse.iterated.steps + fine.iterated.steps
    return Pair(
        coarse, fine, values, errors, scales, outcome, steps, coarse.iterated.krylov_steps + fine.iterated.krylov_steps
    )


def angle_error(values: dict[str, float], errors: dict[str, float]) -> float:
    """Return the error of the angle of the minimum: at least that of its place as seen from the centre; there any angle is."""
    seen = errors["minimum_radius"] / max(values["minimum_radius"], errors["minimum_radius"] / math.pi, 1e-300)
    return min(math.pi, max(errors["minimum_angle"], seen))


def first_resolution(level: Level, rtol: float, band: int, slack: float, ahead: float = 1.0) -> Resolution:
    """Return the finer of the two meshes to begin with, for speeds down to ``ahead`` times that of the level."""
    film = float(level.unknowns.gap[:, 0].mean())
    carried = min(1.0, float(level.contact_pressure[:, 0].mean()))
    scale = min(THICK, film + 0.3 * carried)
    degree = math.ceil(math.log(0.25 / (rtol * scale)) / PANEL_RATE)
    modes = max(1.4 * modes_for(level, 0.7 * math.sqrt(rtol)), modes_for(level, 0.5 * slack * rtol / UNSEEN), 8)
    if level.contact_pressure.max() < 1e-3:
        width = layout(ahead * level.equations.speed, level.equations.law, level.resolution.model)[0] / EDGE
        modes = max(modes, SIDE_LOBES * width**-0.675 * math.log(slack * rtol) / math.log(1e-4))
    degree = min(MOST_DEGREE, max(7, degree))
    return affordable(replace(level.resolution, degree=degree, modes=2 * math.ceil(0.5 * modes)), band)


def refine(speed: float, law: ContactLaw, guess: Level, rtol: float, known: Pair | None = None) -> Pair | Outcome:
    """Return a state on two meshes whose estimated error holds a tolerance, or the best that was found.

    ``known`` is the state with a larger error, as found along a path.
    """
    slack = MINIMUM_SLACK if known is None else PATH_SLACK
    band = band_for(speed, law, guess.resolution.model)
    tolerance = newton_tolerance(rtol)
    best = known
    coarse: Level | None = None
    try:
        if known is None:
            guess = split(guess, speed, law)
            wanted = first_resolution(guess, rtol, band, slack)
        else:
            # An edge within the contact may have moved to a wide panel, where more of all else would be needed.
            wanted, guess = better_split(known.fine), known.fine
            if wanted == known.fine.resolution:
                wanted, coarse = next_meshes(known, rtol, band, slack)
        for _ in range(MOST_ROUNDS):
            if coarse is None:
                coarse = solve_level(wanted.coarser(), speed, law, guess.unknowns, guess.mesh, tolerance)
                guess = coarse if best is None else guess
            if not coarse.outcome.ok:
                return coarse.outcome if best is None else best
            if bytes_of(wanted, band) > LARGE:
                coarse, guess = bare(coarse), bare(guess)
                best = None if best is None else replace(best, coarse=bare(best.coarse), fine=bare(best.fine))
            fine = solve_level(wanted, speed, law, guess.unknowns, guess.mesh, tolerance)
            if not fine.outcome.ok:
                return fine.outcome if best is None else best
            pair = pair_of(coarse, fine)
            if best is None or pair.total < best.total or best.total <= rtol:
                best = pair
            if pair.holds(rtol, slack):
                return pair
            before, guess = wanted, fine
            if not pair.is_enclosed:
                wanted, coarse = better_split(fine), None
                continue
            wanted, coarse = next_meshes(pair, rtol, band, slack)
            if wanted.splits == before.splits and wanted.degree <= before.degree and wanted.modes <= before.modes:
                break
    except MeshTooLargeError as problem:
        if best is None:
            return problem.outcome
    if best is None:
        return Outcome.REFINEMENT_LIMIT
    if best.total <= rtol:
        return best
    # The moment of the contact pressure is a small difference of two halves, each of order one.
    lost = float(np.finfo(float).eps) / best.scales["J_pcx"]
    return replace(best, outcome=Outcome.ROUNDING if lost > ROUNDING * rtol else Outcome.REFINEMENT_LIMIT)


def bare(level: Level) -> Level:
    """Return a state without its preconditioner, which is most of its memory."""
    return replace(level, iterated=replace(level.iterated, preconditioner=None))


def better_split(level: Level) -> Resolution:
    """Return the resolution of a state with edges where the flow closes, or the panels halved that resolve it poorly."""
    placed = with_closing(level.resolution, level.mesh, level.unknowns.gap)
    if placed != level.resolution:
        return placed
    return split_where_poor(level.resolution, level.mesh, level.unknowns.fluid, level.contact_pressure)


def split(guess: Level, speed: float, law: ContactLaw) -> Level:
    """Return a state on panels, halved where they resolve its pressures poorly."""
    for _ in range(MOST_ROUNDS):
        better = better_split(guess)
        if better == guess.resolution:
            break
        on_more = solve_level(better, speed, law, guess.unknowns, guess.mesh, 1e-4)
        if not on_more.outcome.ok:
            break
        guess = on_more
    return guess


def next_meshes(pair: Pair, rtol: float, band: int, slack: float) -> tuple[Resolution, Level | None]:
    """Return the next mesh, and the state on the one that it is compared with, if that is solved already."""
    now, wanted = pair.fine.resolution, finer(pair, rtol, band, slack)
    if wanted.splits != now.splits:
        return wanted, None
    nested = replace(now, degree=now.degree + FINER_DEGREE, modes=2 * math.ceil(0.5 * FINER_MODES * now.modes))
    enough = wanted.degree <= nested.degree <= MOST_DEGREE and wanted.modes <= 1.1 * nested.modes <= 1.1 * MOST_MODES
    if wanted != now and enough and bytes_of(nested, band) <= MOST_BYTES:
        return nested, pair.fine
    return wanted, None


def newton_tolerance(rtol: float) -> float:
    """Return the relative error of the gap that Newton's iteration may leave."""
    return max(1e-11, 1e-2 * rtol)


def finer(pair: Pair, rtol: float, band: int, slack: float) -> Resolution:
    """Return the next mesh: more modes if their amplitudes explain the error, else a higher degree."""
    now, fine = pair.fine.resolution, pair.fine
    modes, degree = now.modes, now.degree
    turning = near_closing(fine)[1]
    if TURNED_MOMENT["J_published"] * turning.sum() > rtol * pair.scales["J_published"]:
        halved = halved_near_closing(now, fine.mesh, turning)
        if halved != now:
            return halved
    if pair.total > rtol:
        more = math.log(2.0 * pair.total / rtol)
        amplitude = float(modal_amplitudes(pair.coarse)[-2:].max())
        if amplitude**1.5 > rtol:
            modes = max(math.ceil(1.2 * modes), modes_for(fine, 0.3 * rtol**0.5))
        if amplitude**2 < 0.3 * pair.total:
            degree += max(1, min(4, math.ceil(more / PANEL_RATE)))
        if now.model.film.uses_speed:  # the angles at which hardly anything is sheared show in the viscosity, not in the gap
            modes, degree = max(modes, math.ceil(FINER_MODES * now.modes)), min(degree, now.degree + FINER_DEGREE)
    allowed = slack * rtol
    if pair.minimum > allowed:
        if UNSEEN_RADIAL * legendre_tail(fine) > 0.3 * allowed:
            degree += 2
        if unseen_in_angle(fine) > 0.3 * allowed or degree == now.degree:
            modes = max(math.ceil(1.2 * modes), modes_for(fine, 0.3 * allowed / UNSEEN))
    modes = min(modes, 2 * now.modes)
    return affordable(replace(now, degree=min(MOST_DEGREE, degree), modes=2 * math.ceil(0.5 * modes)), band)


def affordable(wanted: Resolution, band: int) -> Resolution:
    """Return a resolution with as many of its modes as memory and :data:`MOST_MODES` allow."""
    wanted = replace(wanted, modes=min(wanted.modes, MOST_MODES))
    while bytes_of(wanted, band) > MOST_BYTES and wanted.modes > 16:
        wanted = replace(wanted, modes=2 * ((wanted.modes - 1) // 2))
    return wanted


def holds_along_path(pair: Pair, rtol: float) -> bool:
    """Return whether the errors of a state along a path hold a tolerance."""
    return pair.holds(rtol, PATH_SLACK)


def follow(
    speed: float,
    law: ContactLaw,
    neighbour: Pair,
    rtol: float,
    line: Sequence[tuple[float, Pair]] = (),
    predicted: Unknowns | None = None,
) -> Pair | None:
    """Return the state of a neighbour's meshes at other groups, or None if it is not reached from there.

    ``line`` holds the neighbours and weights whose sum predicts the state, ``predicted`` is a prediction on the finer mesh of
    the neighbour; the meshes change where those of the neighbour do not fit.
    """
    tolerance = newton_tolerance(rtol)
    # With series, a path takes steps of more than that factor.
    wanted, keeps = meshes_for(speed, law, neighbour, rtol, AHEAD if predicted is None else 1.0)
    kept_coarse, kept_fine = (
        (level.iterated.preconditioner if keeps else None) for level in (neighbour.coarse, neighbour.fine)
    )
    known = neighbour.coarse if keeps else neighbour.fine
    rough = neighbour.coarse.resolution if keeps else wanted.coarser()
    start, start_mesh, summed = known.unknowns, known.mesh, None
    if predicted is not None:
        start, start_mesh = predicted, neighbour.fine.mesh
    elif line and keeps:
        summed = extrapolated([w for w, _ in line], [pair.coarse for _, pair in line], known.mesh)
    coarse = solve_level(rough, speed, law, start, start_mesh, tolerance, kept_coarse, 12, predicted=summed)
    if not coarse.outcome.ok:
        return None
    guess, mesh = coarse.unknowns, coarse.mesh
    if keeps:  # the difference of the finer mesh from the coarser one is that of the neighbour
        mesh = neighbour.fine.mesh
        carried, at_fine = moved(guess, coarse.mesh, mesh), neighbour.fine.unknowns
        before = moved(known.unknowns, known.mesh, mesh)
        guess = Unknowns(
            carried.gap * (at_fine.gap / before.gap),
            carried.fluid + (at_fine.fluid - before.fluid),
            carried.offset + (at_fine.offset - before.offset),
        )
    if predicted is not None:  # from afar, and the state is to be expanded with the factors of its own Jacobian
        kept_fine = None
    fine = solve_level(wanted, speed, law, guess, mesh, tolerance, kept_fine, max_steps=12)
    return pair_of(coarse, fine) if fine.outcome.ok else None


def meshes_for(speed: float, law: ContactLaw, neighbour: Pair, rtol: float, part: float = AHEAD) -> tuple[Resolution, bool]:
    """Return the finer mesh for a state beside a neighbour, and whether it is that of the neighbour.

    On the way to slower speeds a new mesh serves down to ``part`` of the speed.
    """
    now, fine = neighbour.fine.resolution, neighbour.fine
    band = band_for(speed, law, now.model)
    ahead = part * speed if speed < fine.equations.speed else speed
    wasteful = neighbour.total < WASTE * rtol and neighbour.minimum < WASTE * PATH_SLACK * rtol
    if fits(now, speed, law) and not wasteful:
        return now, True
    leaner = first_resolution(fine, rtol, band, PATH_SLACK, ahead / fine.equations.speed)
    if fits(now, speed, law):
        saved = bytes_of(leaner, band) < SAVED * bytes_of(now, band)
        return (leaner, False) if saved else (now, True)
    found = resolution(ahead, law, leaner.degree, leaner.modes, now.model)
    if found.doublings == now.doublings:
        found = replace(found, splits=now.splits)
    return with_closing(found, fine.mesh, fine.unknowns.gap), False
