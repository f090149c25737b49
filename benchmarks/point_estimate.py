"""Rules that state the errors of a ball from its two meshes, judged on random states of every kind of film.

Usage::

    python benchmarks/point_estimate.py --solve KIND [--number 60] [--rtols 1e-3 1e-4] [--seed 35] [--out PAIRS.jsonl]
    python benchmarks/point_estimate.py --judge [--out PAIRS.jsonl]

KIND is full, thinning, exit, reform, layer, flow, rolling or closing, the last films that roughness closes.  Groups are
even in the logarithm: speed 10**-5.5 to 10**0.5, load 1e-5 to 1, kappa 1e-3 to 1, one state in six smooth.  Each state is
solved from cold at each tolerance, and every pair of meshes on the way counts.  The true error is that against a finer state:
panels near the contact halved, three degrees and 1.4 times the modes more, or twice the angles where the film breaks.
A line of the file is a pair with the differences of its two meshes, what is stated today, and the true errors, so that
--judge needs no state solved again: it chooses a rule on states of even number and judges it on the others.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from point_parts import better_values, film_of
from point_parts import finer_mesh as finer_full_mesh

import stribeck as sb
from stribeck.contacts.with_parts import with_parts
from stribeck.equations.cavities.system import CavitatedSystem
from stribeck.equations.film import closed_gap
from stribeck.equations.point.mesh_choice import Resolution
from stribeck.equations.point.observables import SMOOTH, observables, reach_of
from stribeck.fluids.fluid import Cavitation
from stribeck.numerics.settings import (
    KINKED_FLOOR,
    KINKED_SAFETY,
    SHARED_FLOOR,
    SHARED_SAFETY,
    SMOOTH_FLOOR,
    SMOOTH_SAFETY,
)
from stribeck.numerics.threads import one_blas_thread
from stribeck.solver.point import refinement
from stribeck.solver.point.estimate import DRAGS, LOOSE_OBSERVABLES, SHEAR_INTEGRALS, Pair
from stribeck.solver.point.level import Level
from stribeck.solver.point.solve import solve_cold
from stribeck.solver.point.state import PointState

ANGLES = (45, 65, 95, 130)
"""Angles of the judge of a film that breaks."""

KINDS = ("full", "thinning", "exit", "reform", "layer", "flow", "rolling", "closing")


RULES = [(safety, floor) for safety in (0.35, 0.5, 0.7, 1.0, 1.5, 2.0, 3.0) for floor in (0.1, 0.3, 1.0)]
"""Safety factors and floors that are tried."""

CHOSEN = ((SMOOTH_SAFETY, SMOOTH_FLOOR), (KINKED_SAFETY, KINKED_FLOOR), (SHARED_SAFETY, SHARED_FLOOR))
COVERED, NEGLIGIBLE = 0.99, 0.01
"""Part of the observables that a rule is to cover, and part of the tolerance below which no error is judged."""


def draw(kind: str, number: int, seed: int) -> tuple[sb.Groups, dict[str, Any]]:
    """Return groups and parts of one state; those of a number do not depend on the others."""
    rng = np.random.default_rng([seed, KINDS.index(kind), number])
    speed, load, kappa = (float(each) for each in 10 ** rng.uniform((-5.5, -5, -3), (0.5, 0, 0)))
    if number % 6 == 5 and kind != "flow":
        speed, kappa = float(10 ** rng.uniform(-3, 0.5)), 0.0
    if kind == "closing":
        speed, load, kappa = (float(each) for each in 10 ** rng.uniform((-6, -2, -2), (-3, 0.5, -0.3)))
    groups = sb.Groups(speed, load, kappa * load ** (2 / 3), geometry="point")
    film, rate, exponent = film_of(speed, kappa), float(10 ** rng.uniform(-1, 1)), float(rng.uniform(0.4, 0.95))
    thinning = (
        sb.fluids.Carreau(rate * film, exponent, float(rng.choice([0.0, 0.01]))),
        sb.fluids.Cross(rate * film, exponent),
        sb.fluids.Eyring(1.0 / (rate * film)),
    )[rng.integers(3)]
    alpha = float(rng.uniform(1, 4))
    slide = {"slide_to_roll": float(rng.choice([rng.uniform(0, 0.3), rng.uniform(0.3, 2.0)]))}
    parts: dict[str, dict[str, Any]] = {
        "full": {},
        "thinning": {"fluid": thinning},
        "exit": {"cavitation": "exit"},
        "reform": {"cavitation": "reform", "cavity_pressure": -float(10 ** rng.uniform(-3, -0.5))},
        "layer": {"solid": sb.solids.Layer(float(10 ** rng.uniform(-0.5, 1.5)), float(rng.choice([0.3, 0.45, 0.5])))},
        "flow": {"flow_factors": (sb.fluids.EffectiveMedium if number % 3 else sb.fluids.PatirCheng)(alpha)},
        "closing": {"flow_factors": sb.fluids.EffectiveMedium(alpha)},
        "rolling": slide | ({"fluid": thinning} if number % 2 else {}),
    }
    return groups, parts[kind]


def finer_mesh(state: PointState) -> Resolution:
    """Return the mesh of the judge."""
    now = state.work.fine.resolution
    if now.model.cavitation is Cavitation.NONE:
        return finer_full_mesh(state)
    return replace(now, degree=now.degree + 4, modes=next((n for n in ANGLES if n >= 2.2 * now.modes), ANGLES[-1]))


def near_minimum(coarse: Level, fine: Level, widest: float) -> float:
    """Return the largest difference of the two gaps where the gap is below a multiple of its minimum."""
    h, rise = fine.unknowns.gap, 0.5 * coarse.mesh.radii**2
    rough = coarse.mesh.transfer(fine.mesh, (coarse.unknowns.gap - rise)[None])[0] + 0.5 * fine.mesh.radii**2
    return float(np.abs(rough - h)[h < widest * h.min()].max())


def measured(pair: Pair) -> dict[str, Any]:
    """Return what a rule may use of a pair."""
    coarse, fine = pair.coarse, pair.fine
    rough = observables(coarse.equations, coarse.unknowns)
    closed = closed_gap(fine.resolution.model.film)
    h = fine.unknowns.gap
    depth = 1e-3 * pair.values["minimum_gap"]
    found = {
        "values": pair.values,
        "difference": {name: abs(value - rough[name]) for name, value in pair.values.items()},
        "scales": pair.scales,
        "today": pair.errors,
        "left": [coarse.iterated.left, fine.iterated.left],
        "modes": [coarse.mesh.modes, fine.mesh.modes],
        "degree": [coarse.mesh.degree, fine.mesh.degree],
        "beyond": fine.equations.friction_error_outside(fine.unknowns),
        "closes": closed is not None and bool(h.min() < 1.3 * closed),
        "gap": {str(widest): near_minimum(coarse, fine, widest) for widest in (1.1, 1.3, 2.0)},
        "reach": reach_of(fine.mesh, h, pair.values["minimum_radius"], pair.values["minimum_angle"], depth),
    }
    if isinstance(fine.equations, CavitatedSystem):
        found["streaks"] = fine.equations.speed / 6.0 * fine.equations.shear_error(fine.unknowns)
    return found


def solved(kind: str, number: int, seed: int, rtols: list[float], largest: float) -> Iterator[dict[str, Any]]:
    """Yield the pairs of a state with their true errors."""
    groups, parts = draw(kind, number, seed)
    here = {"kind": kind, "seed": seed, "number": number}
    pairs: list[tuple[float, Pair]] = []
    original = refinement.pair_of
    start, best, outcome = time.process_time(), None, ""
    for rtol in rtols:

        def kept(coarse: Level, fine: Level, rtol: float = rtol) -> Pair:
            pair = original(coarse, fine)
            pairs.append((rtol, pair))
            return pair

        refinement.pair_of = kept
        try:
            state = solve_cold(with_parts(groups, **parts), rtol)
        except sb.InputError as problem:
            yield here | {"outcome": "REFUSED", "problem": str(problem)}
            return
        finally:
            refinement.pair_of = original
        outcome = state.outcome.name
        if isinstance(state.work, Pair):
            best = state
    here["seconds"] = time.process_time() - start
    if best is None:
        yield here | {"outcome": outcome}
        return
    finer = finer_mesh(best)
    if finer.mesh.rings * finer.modes > largest:
        yield here | {"outcome": "TOO_LARGE"}
        return
    start = time.process_time()
    try:
        exact = better_values(best, finer)
    except ArithmeticError as problem:
        yield here | {"outcome": "NOT_JUDGED", "problem": str(problem)}
        return
    here["judge"] = time.process_time() - start
    for rtol, pair in pairs:
        same = (pair.fine.resolution.model.cavitation is Cavitation.NONE) == (
            best.work.fine.resolution.model.cavitation is Cavitation.NONE
        )
        if same:
            true = {name: abs(value - exact[name]) for name, value in pair.values.items()}
            yield here | {"outcome": "CONVERGED", "rtol": rtol, "true": true} | measured(pair)


def stated(row: dict[str, Any], safety: float, floor: float) -> dict[str, float]:
    """Return the errors that a rule states, relative to the scales, of all but the minima."""
    scales, breaks = row["scales"], "streaks" in row
    differences = {name: row["difference"][name] / scales[name] for name in SMOOTH}
    widest = max(each for name, each in differences.items() if not (breaks and name in LOOSE_OBSERVABLES))
    found = {name: safety * max(each, floor * widest) + row["left"][1] for name, each in differences.items()}
    for name in DRAGS:
        found[name] += row["beyond"] / scales[name]
    for name in SHEAR_INTEGRALS:
        found[name] += row.get("streaks", 0.0) / scales[name]
    return found


def judged(rows: list[dict[str, Any]], *rule: float) -> tuple[float, float, float]:
    """Return which part of the observables a rule covers, the worst true over stated error, and stated ones over today's.

    Without a rule it is today's, and minima count.
    """
    ratios, ours = [], []
    for row in rows:
        today = {name: error / row["scales"][name] for name, error in row["today"].items()}
        for name, error in (stated(row, *rule) if rule else today).items():
            ratios.append(row["true"][name] / row["scales"][name] / max(error, NEGLIGIBLE * row["rtol"]))
            ours.append(error * row["scales"][name] / row["today"][name])
    return float(np.mean(np.array(ratios) <= 1.0)), max(ratios), float(np.median(ours))


def table(rows: list[dict[str, Any]]) -> str:
    """Return for each kind the cheapest rule that covers the states of even number, and what it covers of the others."""
    lines = [
        "| kind | states | pairs | safety, floor | covered, even | odd | worst, odd | over today's |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for kind in KINDS:
        mine = [row for row in rows if row["kind"] == kind and row["outcome"] == "CONVERGED"]
        halves = [[row for row in mine if row["number"] % 2 == part] for part in (0, 1)]
        if not all(halves):
            continue
        covered, worst, _ = judged(mine)
        lines.append(
            f"| {kind} | {len({row['number'] for row in mine})} | {len(mine)} | as stated | | {covered:.1%} | {worst:.2f} | |"
        )
        by_rule = {rule: judged(halves[0], *rule) for rule in RULES}
        enough = [rule for rule in RULES if by_rule[rule][0] >= COVERED] or [max(RULES, key=lambda rule: by_rule[rule][0])]
        for rule in dict.fromkeys((min(enough, key=lambda rule: by_rule[rule][2]), *CHOSEN)):
            covered, worst, median = judged(halves[1], *rule)
            lines.append(
                f"| {kind} | {len({row['number'] for row in mine})} | {len(mine)} | {rule[0]:g}, {rule[1]:g} "
                f"| {by_rule[rule][0]:.1%} | {covered:.1%} | {worst:.2f} | {median:.2f} |"
            )
    return "\n".join(lines)


@one_blas_thread
def main() -> None:
    """Solve states of a kind and write their pairs, or judge rules on the pairs of a file."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--solve", choices=KINDS)
    parser.add_argument("--judge", action="store_true")
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--number", type=int, default=60)
    parser.add_argument("--rtols", type=float, nargs="+", default=[1e-3, 1e-4])
    parser.add_argument("--seed", type=int, default=35)
    parser.add_argument("--largest", type=float, default=12000.0, help="nodes of the finer state")
    parser.add_argument("--out", type=Path, default=Path("build/point_estimate.jsonl"))
    arguments = parser.parse_args()
    if arguments.solve:
        arguments.out.parent.mkdir(parents=True, exist_ok=True)
        with arguments.out.open("a") as file:
            for number in range(arguments.first, arguments.number):
                for row in solved(arguments.solve, number, arguments.seed, arguments.rtols, arguments.largest):
                    print(json.dumps(row), file=file, flush=True)
    if arguments.judge:
        print(table([json.loads(line) for line in arguments.out.read_text().splitlines()]))


if __name__ == "__main__":
    main()
