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
    EDGE_WIDTH_RATIO,
    MAX_BYTES,
    MAX_MODES,
    MODES_PER_EDGE_WIDTH,
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
from stribeck.solver.point.level import Level, band_for, extrapolate_levels, solve_level, transfer
from stribeck.solver.refinement import newton_tolerance

COARSEN_BELOW = 0.03  # Stated error over rtol below which a coarser mesh than the neighbour's is looked for
COARSEN_MEMORY_RATIO = 0.4  # A coarser mesh is built only if it needs less than this fraction of the memory
MESH_FOR_SPEED_RATIO = 0.2  # Along a path to lower speeds, the mesh is made for this fraction of the current speed
SAFETY = 0.35  # Stated error over the difference between the two meshes: the finer one is better than their difference
SAFETY_AT_KINK = 1.0  # Replaces SAFETY and the error floor where roughness closes the flow: two meshes share the kink's error
KINK_LOAD_SAFETY = 0.25  # Error floor over the load of the last pressure coefficients on panels at the kink
PERCOLATION_BAND = (0.8, 1.3)  # Gaps over the closing gap between which the mobility turns sharply
# Error of each friction integral over the moment of the last pressure coefficients at the kink: a difference of two halves.
KINK_MOMENT_SAFETY = {"J_published": 1.25, "J_pcx": 1.0, "J_poiseuille": 0.3}
SPLIT_FRACTION = 0.1  # A panel is split if it contributes more than this fraction of the truncation error
MIN_PANEL_AT_KINK = 0.05  # Width over the contact's scale below which panels at the kink are no longer split
# Two meshes may agree by accident in one number, hardly in all: the least error of each observable over the largest of all.
ERROR_FLOOR_RATIO = 0.1  # Newtonian films
ERROR_FLOOR_RATIO_THINNING = 1.0  # Shear-thinning films (test_point_thinning)
# Error over the last radial coefficients on the first panel: no node lies at the centre.
CENTRE_SAFETY = {"central_gap": 0.5, "central_pressure": 2.0}
SAFETY_TRUNCATION_ANGLE = 5.0  # Error of the minimum film over the last two angular coefficients
SAFETY_TRUNCATION_RADIUS = 0.5  # Error of the minimum film over the last two radial coefficients
SAFETY_TRUNCATION_SERIES = 0.4  # Error of the minimum film over the geometric series that continues the angular one
MINIMUM_POSITION = ("minimum_radius", "minimum_angle")
POSITION_SAFETY = 0.5  # Least error of the minimum's position over the distance at which the gap rises by its own error
# Shear-thinning: extra safety, as the viscosity varies sharply where the shear rate vanishes (test_point_thinning).
THINNING_MINIMUM_SAFETY = 1.5  # Truncation error of the minimum film over that of a Newtonian film
THINNING_FLOOR_RATIO = 1.5e-3  # Least error of every observable over the truncation error of the minimum film
THINNING_DRAG_FLOOR_RATIO = 3e-2  # Least error of the friction integrals over the truncation error of the minimum film
THINNING_FRICTION_SAFETY = 2.0  # Least error of the friction integrals over the least error of the other observables
SMALL_SLIP = 0.25  # Half the slide-to-roll ratio below which errors of thinning drag grow as one over the slip
MAX_SLIP_AMPLIFICATION = 4.0  # Largest such growth
# Least error of the minimum film times the modes, where the viscosity has no plateau at low rates and so a cusp at rate zero.
CUSP_ERROR_TIMES_MODES = 4e-3
MIN_DECAY_RATE = 0.02  # Smallest decay of angular coefficients per mode that a fit may give, or the series would not end
MINIMUM_RTOL_FACTOR = 100.0  # Tolerance of the minimum film over rtol, of a cold state
MINIMUM_RTOL_FACTOR_ON_PATH = 1000.0  # Tolerance of the minimum film over rtol, along a path
DEGREE_LOG_GAIN = 1.49  # ln of the error reduction by one degree: a square root at one panel's distance
FINER_DEGREE_STEP = 2  # Degrees by which the finer mesh of a pair exceeds the coarser one
FINER_MODES_RATIO = 1.4  # Modes of the finer mesh of a pair over those of the coarser one
FULL_DEGREE_FILM = 0.05  # Film above which the first degree no longer falls: pressures of thick films are of order one
MAX_DEGREE = 18
MAX_REFINEMENTS = 6
ROUNDING_RTOL_FRACTION = 0.03  # Rounding of friction over rtol above which rounding is the outcome of a missed tolerance
DROP_FACTORS_ABOVE_BYTES = 200_000_000  # Memory of the finer mesh above which factors of coarser meshes are dropped


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

    @property
    def total(self) -> float:
        """Largest error over its scale among all observables but the minimum film."""
        return max(self.errors[name] / self.scales[name] for name in self.errors if name not in MINIMA)

    @property
    def minimum(self) -> float:
        """Relative error of the minimum film."""
        return self.errors["minimum_gap"] / self.scales["minimum_gap"]

    @property
    def is_enclosed(self) -> bool:
        """Whether panel edges enclose the gap at which roughness closes the flow, as degrees alone cannot measure a kink."""
        now = self.fine.resolution
        return with_closing(now, self.fine.mesh, self.fine.unknowns.gap) == now

    def holds(self, rtol: float, slack: float) -> bool:
        """Return whether all errors hold a tolerance, and that of the minimum film ``slack`` times the tolerance."""
        return self.is_enclosed and self.total <= rtol and self.minimum <= slack * rtol


def modal_amplitudes(level: Level) -> Array:
    """Return the largest amplitude of each angular mode of the gap, within twice the scale of the contact."""
    mesh, h = level.mesh, level.unknowns.gap
    near = mesh.radii < 2.0 * 2.0**level.resolution.doublings
    return np.asarray((np.abs(mesh.to_modes @ h) / h.mean(axis=0))[:, near].max(axis=1))


def modes_for(level: Level, amplitude: float) -> int:
    """Return the number of modes whose geometrically decaying amplitudes exceed a bound."""
    found = modal_amplitudes(level)
    below = np.flatnonzero(found > amplitude)
    last = int(below[-1]) + 1 if below.size else 1
    if last < found.size - 2:
        return last
    half = slice(max(2, found.size // 2), found.size - 1)
    m = np.arange(found.size)[half]
    rate, level_at = np.polyfit(m, np.log(np.maximum(found[half], 1e-300)), 1)
    rate = min(rate, -MIN_DECAY_RATE)
    return int(math.ceil((math.log(amplitude) - level_at) / rate))


def angular_truncation_error(level: Level) -> float:
    """Return the relative truncation error of the minimum film by the end of its angular series."""
    mesh, h = level.mesh, level.unknowns.gap
    near = mesh.radii < 2.0 * 2.0**level.resolution.doublings
    found = (np.abs(mesh.to_modes @ h) / h.min(axis=0))[:, near].max(axis=1)
    half = slice(max(2, found.size // 2), found.size - 1)
    m = np.arange(found.size)[half]
    rate = -np.polyfit(m, np.log(np.maximum(found[half], 1e-300)), 1)[0] if m.size > 1 else 1.0
    # In thin films coefficients fall so slowly that the series beyond the last one counts.
    beyond = float(found[-2:].max()) / -math.expm1(-max(rate, MIN_DECAY_RATE))
    return max(SAFETY_TRUNCATION_ANGLE * float(modal_amplitudes(level)[-2:].max()), SAFETY_TRUNCATION_SERIES * beyond)


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


def kink_tails(level: Level) -> Array:
    """Return load and moment of the last pressure coefficients on panels where roughness closes the flow, shape (2, n)."""
    mesh, closed_at = level.mesh, closed_gap(level.resolution.model.film)
    found = np.zeros((2, mesh.panels))
    if closed_at is None:
        return found
    # The mobility turns sharply there, so that two meshes may share their error.
    low, high = PERCOLATION_BAND
    gap = mesh.scattered(level.unknowns.gap) / closed_at
    near = (gap.min(axis=(0, 2)) < high) & (gap.max(axis=(0, 2)) > low)
    first_two = mesh.to_modes[:2] @ (level.unknowns.fluid + level.contact_pressure)
    tails = np.abs(mesh.legendre(first_two)[..., -2:]).max(axis=-1)
    radii, widths = 0.5 * (mesh.edges[1:] + mesh.edges[:-1]), np.diff(mesh.edges)
    found[:, near] = (tails * radii * widths * [1.5 * np.ones(mesh.panels), 0.5 * math.pi * radii])[:, near]
    return found


def split_at_kink(found: Resolution, mesh: PolarMesh, parts: Array) -> Resolution:
    """Return a resolution with the wide panels split that contribute most to an error with ``parts`` on the panels."""
    wide = np.diff(mesh.edges) > MIN_PANEL_AT_KINK * 2.0**found.doublings
    middles = 0.5 * (mesh.edges[1:] + mesh.edges[:-1])[wide & (parts > SPLIT_FRACTION * parts.sum())]
    return replace(found, splits=tuple(sorted({*found.splits, *middles.tolist()})))


def scales_of(values: dict[str, float], speed: float, drag: float = 0.0) -> dict[str, float]:
    """Return the scales of errors: one for shares, a radius or an angle, at least ``drag`` for friction, else the value."""
    friction = max(abs(values["J_balanced"]), abs(values["J_published"]), speed, drag) if speed > 0 else 1.0
    found = {}
    for name, value in values.items():
        if name.endswith("share") or name in MINIMUM_POSITION:
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
    kinked = float(kink_tails(fine)[1].sum())
    part = SAFETY_AT_KINK if kinked > 0.0 else SAFETY
    errors = {name: part * abs(value - rough[name]) + fine.iterated.left * scales[name] for name, value in values.items()}
    # Interpolated minima of two meshes may agree by chance: the truncation of the series bounds their error from below.
    balance = 0.3 * abs(identity_error(values, fine.equations.speed))
    for name in ("J_balanced", "J_published", "J_pcx"):
        errors[name] = max(errors[name], balance)
    for name, factor in KINK_MOMENT_SAFETY.items():
        errors[name] = max(errors[name], factor * kinked)
    beyond = fine.equations.friction_error_outside(fine.unknowns)
    for name in ("J_couette", "J_poiseuille", "J_balanced", "J_published"):
        errors[name] += beyond
    for (name, factor), tail in zip(CENTRE_SAFETY.items(), centre_tails(fine), strict=True):
        errors[name] = max(errors[name], factor * float(tail))
    unseen = SAFETY_TRUNCATION_RADIUS * legendre_tail(fine)
    if fine.equations.speed > 0:
        unseen += angular_truncation_error(fine)
    # Two meshes may agree by chance in one number, hardly in all.
    widest = max(errors[name] / scales[name] for name in errors if name not in MINIMA)
    least = (SAFETY_AT_KINK if kinked > 0.0 else ERROR_FLOOR_RATIO) * widest
    if fine.resolution.model.film.uses_speed:
        unseen *= THINNING_MINIMUM_SAFETY
        least = max(ERROR_FLOOR_RATIO_THINNING * widest, THINNING_FLOOR_RATIO * unseen)
        widest = max(widest, THINNING_FLOOR_RATIO * unseen / ERROR_FLOOR_RATIO)
    errors = {name: max(error, least * scales[name]) for name, error in errors.items()}
    # Differences of the terms of a sum may cancel by chance where their errors do not.
    errors["J_balanced"] = max(errors["J_balanced"], math.hypot(errors["J_couette"], errors["J_poiseuille"]))
    errors["J_published"] = max(errors["J_published"], math.hypot(errors["J_balanced"], errors["J_pcx"]))
    film = fine.resolution.model.film
    if film.uses_speed:
        # By the identity of the integrals the moment of the contact pressure is the difference of both drags.
        drag = max(THINNING_FRICTION_SAFETY * least, THINNING_DRAG_FLOOR_RATIO * unseen)
        errors["J_pcx"] = max(errors["J_pcx"], drag * scales["J_pcx"])
        # Drag is the stress over the slide.
        drag *= min(MAX_SLIP_AMPLIFICATION, max(1.0, SMALL_SLIP / abs(film.slide))) if film.slide else 1.0
        for name in ("J_couette", "J_poiseuille", "J_balanced", "J_published"):
            errors[name] = max(errors[name], drag * scales[name])
    # The series of the side lobes falls from one mesh to the other as the error of the minimum does.
    last, before = (float(modal_amplitudes(level)[-2:].max()) for level in (fine, coarse))
    gained = 2.0 * min(SAFETY, max(0.05, last / max(before, 1e-300)))
    for name in ("minimum_gap", "minimum_gap_on_axis"):
        errors[name] = max(gained * abs(values[name] - rough[name]), max(unseen, ERROR_FLOOR_RATIO * widest) * scales[name])
    if isinstance(film, ShearThinning) and film.law.plateau < 1:
        for name in ("minimum_gap", "minimum_gap_on_axis", "minimum_radius"):
            errors[name] = max(errors[name], CUSP_ERROR_TIMES_MODES / fine.mesh.modes * scales[name])
    for name in MINIMUM_POSITION:
        errors[name] = max(4.0 * errors[name], unseen * (2.0 if fine.resolution.model.film.uses_speed else 1.0))
    place = values["minimum_radius"], values["minimum_angle"]
    rises = reach_of(fine.mesh, fine.unknowns.gap, *place, errors["minimum_gap"])
    for name, reach in zip(MINIMUM_POSITION, rises, strict=True):
        errors[name] = max(errors[name], POSITION_SAFETY * reach)
    errors["minimum_angle"] = angle_error(values, errors)
    ok = coarse.outcome.ok and fine.outcome.ok
    outcome = Outcome.CONVERGED if ok else (fine.outcome if coarse.outcome.ok else coarse.outcome)
    steps = coarse.iterated.steps + fine.iterated.steps
    return Pair(
        coarse, fine, values, errors, scales, outcome, steps, coarse.iterated.krylov_steps + fine.iterated.krylov_steps
    )


def angle_error(values: dict[str, float], errors: dict[str, float]) -> float:
    """Return the error of the minimum's angle, at least the error of its radius as seen from the centre."""
    seen = errors["minimum_radius"] / max(values["minimum_radius"], errors["minimum_radius"] / math.pi, 1e-300)
    return min(math.pi, max(errors["minimum_angle"], seen))


def first_resolution(level: Level, rtol: float, band: int, slack: float, ahead: float = 1.0) -> Resolution:
    """Return the finer of the first two meshes, for speeds down to ``ahead`` times that of the level."""
    film = float(level.unknowns.gap[:, 0].mean())
    carried = min(1.0, float(level.contact_pressure[:, 0].mean()))
    scale = min(FULL_DEGREE_FILM, film + 0.3 * carried)
    degree = math.ceil(math.log(0.25 / (rtol * scale)) / DEGREE_LOG_GAIN)
    for_minimum = modes_for(level, 0.5 * slack * rtol / SAFETY_TRUNCATION_ANGLE)
    modes = max(1.4 * modes_for(level, 0.7 * math.sqrt(rtol)), for_minimum, 8)
    if level.contact_pressure.max() < 1e-3:
        width = layout(ahead * level.equations.speed, level.equations.law, level.resolution.model)[0] / EDGE_WIDTH_RATIO
        modes = max(modes, MODES_PER_EDGE_WIDTH * width**-0.675 * math.log(slack * rtol) / math.log(1e-4))
    degree = min(MAX_DEGREE, max(7, degree))
    return limit_modes(replace(level.resolution, degree=degree, modes=2 * math.ceil(0.5 * modes)), band)


def refine(speed: float, law: ContactLaw, guess: Level, rtol: float, known: Pair | None = None) -> Pair | Outcome:
    """Return a state on two meshes that holds a tolerance, or the best found, from a guess or a ``known`` pair on a path."""
    slack = MINIMUM_RTOL_FACTOR if known is None else MINIMUM_RTOL_FACTOR_ON_PATH
    band = band_for(speed, law, guess.resolution.model)
    tolerance = newton_tolerance(rtol)
    best = known
    coarse: Level | None = None
    try:
        if known is None:
            guess = solve_on_split_panels(guess, speed, law)
            wanted = first_resolution(guess, rtol, band, slack)
        else:
            # An edge within the contact may have moved to a wide panel, where more of all else would be needed.
            wanted, guess = improved_panels(known.fine), known.fine
            if wanted == known.fine.resolution:
                wanted, coarse = choose_next_meshes(known, rtol, band, slack)
        for _ in range(MAX_REFINEMENTS):
            if coarse is None:
                coarse = solve_level(wanted.coarser(), speed, law, guess.unknowns, guess.mesh, tolerance)
                guess = coarse if best is None else guess
            if not coarse.outcome.ok:
                return coarse.outcome if best is None else best
            if bytes_of(wanted, band) > DROP_FACTORS_ABOVE_BYTES:
                coarse, guess = without_preconditioner(coarse), without_preconditioner(guess)
                if best is not None:
                    levels = without_preconditioner(best.coarse), without_preconditioner(best.fine)
                    best = replace(best, coarse=levels[0], fine=levels[1])
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
                wanted, coarse = improved_panels(fine), None
                continue
            wanted, coarse = choose_next_meshes(pair, rtol, band, slack)
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
    return replace(best, outcome=Outcome.ROUNDING if lost > ROUNDING_RTOL_FRACTION * rtol else Outcome.REFINEMENT_LIMIT)


def without_preconditioner(level: Level) -> Level:
    """Return a state without its preconditioner, the largest part of its memory."""
    return replace(level, iterated=replace(level.iterated, preconditioner=None))


def improved_panels(level: Level) -> Resolution:
    """Return the resolution of a state with panel edges where the flow closes, else with poorly resolved panels split."""
    placed = with_closing(level.resolution, level.mesh, level.unknowns.gap)
    if placed != level.resolution:
        return placed
    return split_where_poor(level.resolution, level.mesh, level.unknowns.fluid, level.contact_pressure)


def solve_on_split_panels(guess: Level, speed: float, law: ContactLaw) -> Level:
    """Return a guess solved again on panels split until they resolve its pressures."""
    for _ in range(MAX_REFINEMENTS):
        better = improved_panels(guess)
        if better == guess.resolution:
            break
        on_more = solve_level(better, speed, law, guess.unknowns, guess.mesh, 1e-4)
        if not on_more.outcome.ok:
            break
        guess = on_more
    return guess


def choose_next_meshes(pair: Pair, rtol: float, band: int, slack: float) -> tuple[Resolution, Level | None]:
    """Return the next finer mesh, and the state on its coarser companion if that is solved already."""
    now, wanted = pair.fine.resolution, next_resolution(pair, rtol, band, slack)
    if wanted.splits != now.splits:
        return wanted, None
    nested = replace(now, degree=now.degree + FINER_DEGREE_STEP, modes=2 * math.ceil(0.5 * FINER_MODES_RATIO * now.modes))
    enough = wanted.degree <= nested.degree <= MAX_DEGREE and wanted.modes <= 1.1 * nested.modes <= 1.1 * MAX_MODES
    if wanted != now and enough and bytes_of(nested, band) <= MAX_BYTES:
        return nested, pair.fine
    return wanted, None


def next_resolution(pair: Pair, rtol: float, band: int, slack: float) -> Resolution:
    """Return the next mesh, with more modes if their amplitudes explain the error, else a higher degree."""
    now, fine = pair.fine.resolution, pair.fine
    modes, degree = now.modes, now.degree
    turning = kink_tails(fine)[1]
    if KINK_MOMENT_SAFETY["J_published"] * turning.sum() > rtol * pair.scales["J_published"]:
        halved = split_at_kink(now, fine.mesh, turning)
        if halved != now:
            return halved
    if pair.total > rtol:
        more = math.log(2.0 * pair.total / rtol)
        amplitude = float(modal_amplitudes(pair.coarse)[-2:].max())
        if amplitude**1.5 > rtol:
            modes = max(math.ceil(1.2 * modes), modes_for(fine, 0.3 * rtol**0.5))
        if amplitude**2 < 0.3 * pair.total:
            degree += max(1, min(4, math.ceil(more / DEGREE_LOG_GAIN)))
        if now.model.film.uses_speed:  # the angles at which hardly anything is sheared show in the viscosity, not in the gap
            modes, degree = max(modes, math.ceil(FINER_MODES_RATIO * now.modes)), min(degree, now.degree + FINER_DEGREE_STEP)
    allowed = slack * rtol
    if pair.minimum > allowed:
        if SAFETY_TRUNCATION_RADIUS * legendre_tail(fine) > 0.3 * allowed:
            degree += 2
        if angular_truncation_error(fine) > 0.3 * allowed or degree == now.degree:
            modes = max(math.ceil(1.2 * modes), modes_for(fine, 0.3 * allowed / SAFETY_TRUNCATION_ANGLE))
    modes = min(modes, 2 * now.modes)
    return limit_modes(replace(now, degree=min(MAX_DEGREE, degree), modes=2 * math.ceil(0.5 * modes)), band)


def limit_modes(wanted: Resolution, band: int) -> Resolution:
    """Return a resolution with at most as many modes as memory and :data:`MAX_MODES` allow."""
    wanted = replace(wanted, modes=min(wanted.modes, MAX_MODES))
    while bytes_of(wanted, band) > MAX_BYTES and wanted.modes > 16:
        wanted = replace(wanted, modes=2 * ((wanted.modes - 1) // 2))
    return wanted


def holds_along_path(pair: Pair, rtol: float) -> bool:
    """Return whether the errors of a state along a path hold a tolerance."""
    return pair.holds(rtol, MINIMUM_RTOL_FACTOR_ON_PATH)


def follow(
    speed: float,
    law: ContactLaw,
    neighbour: Pair,
    rtol: float,
    line: Sequence[tuple[float, Pair]] = (),
    predicted: Unknowns | None = None,
) -> Pair | None:
    """Return the state of other groups from a neighbour, on its meshes where they fit; None if the iteration fails.

    ``line`` holds weights and states whose sum predicts this one, ``predicted`` a prediction on the neighbour's finer mesh.
    """
    tolerance = newton_tolerance(rtol)
    # With series, a path takes steps of more than that factor.
    wanted, keeps = mesh_for_neighbour(speed, law, neighbour, rtol, MESH_FOR_SPEED_RATIO if predicted is None else 1.0)
    kept_coarse, kept_fine = (
        (level.iterated.preconditioner if keeps else None) for level in (neighbour.coarse, neighbour.fine)
    )
    known = neighbour.coarse if keeps else neighbour.fine
    rough = neighbour.coarse.resolution if keeps else wanted.coarser()
    start, start_mesh, summed = known.unknowns, known.mesh, None
    if predicted is not None:
        start, start_mesh = predicted, neighbour.fine.mesh
    elif line and keeps:
        summed = extrapolate_levels([w for w, _ in line], [pair.coarse for _, pair in line], known.mesh)
    coarse = solve_level(rough, speed, law, start, start_mesh, tolerance, kept_coarse, 12, predicted=summed)
    if not coarse.outcome.ok:
        return None
    guess, mesh = coarse.unknowns, coarse.mesh
    if keeps:  # the difference of the finer mesh from the coarser one is that of the neighbour
        mesh = neighbour.fine.mesh
        carried, at_fine = transfer(guess, coarse.mesh, mesh), neighbour.fine.unknowns
        before = transfer(known.unknowns, known.mesh, mesh)
        guess = Unknowns(
            carried.gap * (at_fine.gap / before.gap),
            carried.fluid + (at_fine.fluid - before.fluid),
            carried.offset + (at_fine.offset - before.offset),
        )
    if predicted is not None:  # from afar, and the state is to be expanded with the factors of its own Jacobian
        kept_fine = None
    fine = solve_level(wanted, speed, law, guess, mesh, tolerance, kept_fine, max_steps=12)
    return pair_of(coarse, fine) if fine.outcome.ok else None


def mesh_for_neighbour(
    speed: float, law: ContactLaw, neighbour: Pair, rtol: float, part: float = MESH_FOR_SPEED_RATIO
) -> tuple[Resolution, bool]:
    """Return the finer mesh for a state from a neighbour, good to ``part`` of the speed, and whether it is the old one."""
    now, fine = neighbour.fine.resolution, neighbour.fine
    band = band_for(speed, law, now.model)
    ahead = part * speed if speed < fine.equations.speed else speed
    wasteful = (
        neighbour.total < COARSEN_BELOW * rtol and neighbour.minimum < COARSEN_BELOW * MINIMUM_RTOL_FACTOR_ON_PATH * rtol
    )
    if fits(now, speed, law) and not wasteful:
        return now, True
    leaner = first_resolution(fine, rtol, band, MINIMUM_RTOL_FACTOR_ON_PATH, ahead / fine.equations.speed)
    if fits(now, speed, law):
        saved = bytes_of(leaner, band) < COARSEN_MEMORY_RATIO * bytes_of(now, band)
        return (leaner, False) if saved else (now, True)
    found = resolution(ahead, law, leaner.degree, leaner.modes, now.model)
    if found.doublings == now.doublings:
        found = replace(found, splits=now.splits)
    return with_closing(found, fine.mesh, fine.unknowns.gap), False
