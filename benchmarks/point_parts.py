"""Random cold states of balls whose films break, and of balls with other fluids, flow factors, layers and motions.

Usage::

    python benchmarks/point_parts.py FAMILY [--number 60] [--rtol 1e-4] [--seed 15] [--first 0] [--largest 7000]
        [--out STATES.jsonl] [--table]

FAMILY is cavitated, a film that ends at ambient pressure and nothing else, or combined: each of motion, a fluid that stiffens
or thins, flow factors, a layer and such an end with even odds.  Groups are even in the logarithm: speed 1e-7 to 10, load 1e-4
to 1, kappa 1e-3 to 1; one state in five is smooth, at speed 1e-3 to 10.  Families wide_thinning and wide_cavitation have the
fluids and cavities of fluid_box.py, and groups over all that is solved: speed 1e-7 to 1e3, load 1e-8 to 10, kappa 1e-5 to 10,
one state in eight smooth, at speed 1e-5 to 1e4.

Each state is solved once more on a finer mesh: all panels near the contact halved and three degrees more, with 1.4 times the
modes and a rim farther out where the fluid thins; where the film breaks 1.4 times the angles or more, and four degrees more,
as these limit what is known of the line of rupture.  By how much the state differs from that is taken for its error.  With
--out each state is a line of that file; --table prints what a file holds, and solves nothing.
"""

from __future__ import annotations

import argparse
import json
import math
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import fluid_box
import numpy as np
from point_box import FINER_DEGREE, FINER_MODES, SHIFTED

import stribeck as sb
from stribeck.contacts.with_parts import with_parts
from stribeck.equations.point.mesh_choice import Resolution
from stribeck.equations.point.observables import MINIMA, observables
from stribeck.fluids.fluid import Cavitation
from stribeck.numerics.settings import MAX_REFINEMENTS
from stribeck.numerics.threads import one_blas_thread
from stribeck.solver.point.estimate import Pair
from stribeck.solver.point.level import solve_level
from stribeck.solver.point.solve import solve_cold
from stribeck.solver.point.state import PointState

FAMILIES = ("cavitated", "combined", "wide_thinning", "wide_cavitation")
ANGLES = (15, 30, 45, 65, 95, 130)
"""Angles of the judge of a film that breaks: multiples of five, as those of the states."""

TORN_DEGREE = 4
TIGHT, TIGHT_TORN = 1e-11, 1e-8
MOST_MODES = 200


def draw(family: str, number: int, seed: int) -> tuple[sb.Groups, dict[str, Any]]:
    """Return groups and parts of one state; those of a number do not depend on the others."""
    rng = np.random.default_rng([seed, FAMILIES.index(family), number])
    if family.startswith("wide"):
        return wide(family, number, rng)
    speed, load, kappa, smooth = (float(each) for each in 10 ** rng.uniform((-7, -4, -3, -3), (1, 0, 0, 1)))
    if number % 5 == 4:
        speed, kappa = smooth, 0.0
    groups = sb.Groups(speed, load, kappa * load ** (2 / 3), geometry="point")
    if family == "cavitated":
        return groups, {"cavitation": "exit"}
    parts: dict[str, Any] = {"cavitation": str(rng.choice(["none", "exit"]))}
    if rng.random() < 0.5:
        parts["slide_to_roll"] = float(rng.uniform(0.2, 2.0))
    kind = rng.choice(["none", "Barus", "Roelands", "Carreau", "Eyring"])
    if kind != "none":
        parts["fluid"] = fluid(str(kind), film_of(speed, kappa), rng)
    if rng.random() < 0.5 and kappa > 0 and kind not in ("Carreau", "Eyring"):
        alpha = float(rng.uniform(1.0, 4.0))
        parts["flow_factors"] = sb.fluids.PatirCheng(alpha) if rng.random() < 0.5 else sb.fluids.EffectiveMedium(alpha)
    if rng.random() < 0.5:
        parts["solid"] = sb.solids.Layer(float(10 ** rng.uniform(-0.5, 1.5)), float(rng.choice([0.3, 0.45, 0.5])))
    return groups, parts


def wide(family: str, number: int, rng: np.random.Generator) -> tuple[sb.Groups, dict[str, Any]]:
    """Return groups over all that is solved, and the parts of a family of random cylinders."""
    speed, load, kappa, smooth = (float(each) for each in 10 ** rng.uniform((-7, -8, -5, -5), (3, 1, 1, 4)))
    if number % 8 == 7:
        speed, load, kappa = smooth, 1e-3, 0.0
    parts = fluid_box.PARTS[family](rng, sb.Groups(speed, load, kappa * load))
    return sb.Groups(speed, load, kappa * load ** (2 / 3), geometry="point"), parts


def film_of(speed: float, kappa: float) -> float:
    """Return about the central gap."""
    return max(0.42 * speed**0.6, kappa)


def fluid(kind: str, film: float, rng: np.random.Generator) -> Any:
    """Return a fluid; Weissenberg numbers in the film are 0.1 to 10."""
    coefficient, rate = float(10 ** rng.uniform(-2, math.log10(3))), float(10 ** rng.uniform(-1, 1))
    if kind == "Barus":
        return sb.fluids.Barus(coefficient)
    if kind == "Roelands":
        return sb.fluids.Roelands(coefficient, float(10 ** rng.uniform(-1, 1)), float(10 ** rng.uniform(-5, -2)))
    if kind == "Eyring":
        return sb.fluids.Eyring(1.0 / (rate * film))
    return sb.fluids.Carreau(rate * film, float(rng.uniform(0.4, 0.95)), float(rng.choice([0.0, 0.01])))


def finer_mesh(state: PointState) -> Resolution:
    """Return the mesh of the judge."""
    fine = state.work.fine
    now, near = fine.resolution, fine.mesh.edges[: fine.mesh.log_from + 1]
    splits = tuple(sorted({*now.splits, *(0.5 * (near[:-1] + near[1:])).tolist()}))
    if now.model.cavitation is Cavitation.EXIT:
        modes = next((n for n in ANGLES if n >= FINER_MODES * now.modes), ANGLES[-1])
        return replace(now, degree=now.degree + TORN_DEGREE, modes=modes)
    degree, farther = now.degree + FINER_DEGREE, now.farther
    if now.model.film.uses_speed:
        farther = min(MAX_REFINEMENTS, farther + 1)
    modes = max(now.modes, min(MOST_MODES, round(FINER_MODES * now.modes)))
    return replace(now, degree=degree, modes=modes, splits=splits, farther=farther)


def better_values(state: PointState, finer: Resolution) -> dict[str, float]:
    """Return the observables on a finer mesh."""
    fine = state.work.fine
    tolerance = TIGHT_TORN if fine.resolution.model.cavitation is Cavitation.EXIT else TIGHT
    speed, law = fine.equations.speed, fine.equations.law
    level = solve_level(finer, speed, law, fine.unknowns, fine.mesh, tolerance)
    if not level.outcome.ok:
        raise ArithmeticError(f"the finer mesh has no state: {level.outcome.name}")
    found = observables(level.equations, level.unknowns)
    shift = state.values["offset"] - observables(fine.equations, fine.unknowns)["offset"]
    return found | {name: found[name] + shift for name in SHIFTED}


def judged(family: str, number: int, seed: int, rtol: float, largest: float = math.inf) -> dict[str, Any]:
    """Return what came of one state, with true over stated errors where the judge has at most ``largest`` nodes."""
    groups, parts = draw(family, number, seed)
    row: dict[str, Any] = {"family": family, "seed": seed, "number": number, "rtol": rtol, "speed": float(groups.speed)}
    row |= {"load": float(groups.load), "kappa": float(groups.relative_roughness)}
    row["parts"] = {name: repr(part) for name, part in parts.items()}
    start = time.process_time()
    try:
        state = solve_cold(with_parts(groups, **parts), rtol)
    except sb.InputError as problem:
        return row | {"outcome": "REFUSED", "problem": str(problem), "seconds": time.process_time() - start}
    row |= {"outcome": state.outcome.name, "seconds": time.process_time() - start}
    if not isinstance(state.work, Pair):
        return row
    row |= {"rings": state.mesh.rings, "modes": state.mesh.modes, "estimate": state.error_estimate}
    row["load_error"] = abs(state.load_error)
    row["judge"] = (finer := finer_mesh(state)).mesh.rings * finer.modes
    if row["judge"] > largest:
        return row
    try:
        exact = better_values(state, finer)
    except ArithmeticError as problem:
        return row | {"problem": str(problem)}
    off = {name: abs(state.values[name] - exact[name]) for name in state.absolute_errors}
    ratios = {name: off[name] / error if off[name] else 0.0 for name, error in state.absolute_errors.items()}
    return row | {"ratios": ratios, "relative": {name: state.errors[name] for name in ratios}}


def worst(row: dict[str, Any], minima: bool = False) -> tuple[float, str]:
    """Return the largest true over stated error and the name of the observable, minima of the gap apart."""
    return max((ratio, name) for name, ratio in row["ratios"].items() if (name in MINIMA) == minima)


def table(rows: list[dict[str, Any]]) -> str:
    """Return what docs/numerics_tables.md shows."""
    asked = [row for row in rows if row["outcome"] != "REFUSED"]
    compared = [row for row in asked if "ratios" in row]
    if not compared:
        return f"none of {len(rows)} states is judged"
    single = np.array([ratio for row in compared for ratio in row["ratios"].values()])
    whole, minima = (np.array([worst(row, apart)[0] for row in compared]) for apart in (False, True))
    seconds = [row["seconds"] for row in asked]
    solved = sum(row["outcome"] == "CONVERGED" for row in asked)
    return (
        "| states | refused | solved | judged | observables covered | states wholly covered | worst error/stated "
        "| minima covered | worst | CPU s, median | most |\n|---|---|---|---|---|---|---|---|---|---|---|\n"
        f"| {len(rows)} | {len(rows) - len(asked)} | {solved} | {len(compared)} | {np.mean(single <= 1):.1%} "
        f"| {np.mean(whole <= 1):.1%} | {whole.max():.2f} | {np.mean(minima <= 1):.1%} | {minima.max():.2f} "
        f"| {np.median(seconds):.1f} | {max(seconds):.0f} |"
    )


def describe(row: dict[str, Any]) -> str:
    """Return a state in a line."""
    found = f"{row['number']}: {row['outcome']}, speed {row['speed']:.2e}, load {row['load']:.2e}, kappa {row['kappa']:.2e}, "
    found += ", ".join(f"{name} {part}" for name, part in row["parts"].items())
    if "problem" in row:
        found += f"; {row['problem']}"
    missed = {name: ratio for name, ratio in row.get("ratios", {}).items() if not ratio <= 1}
    return found + "".join(f"; {name} {ratio:.2f} of {row['relative'][name]:.1e}" for name, ratio in missed.items())


@one_blas_thread
def main() -> None:
    """Solve the states that the file does not hold, and print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("family", choices=FAMILIES)
    parser.add_argument("--number", type=int, default=60)
    parser.add_argument("--rtol", type=float, default=1e-4)
    parser.add_argument("--seed", type=int, default=15)
    parser.add_argument("--largest", type=float, default=7000.0, help="nodes of the judge up to which a state is judged")
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--out", type=Path)
    parser.add_argument("--table", action="store_true")
    arguments = parser.parse_args()
    known = []
    if arguments.out is not None and arguments.out.exists():
        known = [json.loads(line) for line in arguments.out.read_text().splitlines()]
    here = (arguments.family, arguments.seed, arguments.rtol)
    rows = [row for row in known if (row["family"], row["seed"], row["rtol"]) == here]
    done = {row["number"] for row in rows}
    for number in range(arguments.first, 0 if arguments.table else arguments.number):
        if number not in done:
            rows.append(judged(arguments.family, number, arguments.seed, arguments.rtol, arguments.largest))
            if arguments.out is not None:
                with arguments.out.open("a") as file:
                    print(json.dumps(rows[-1]), file=file)
    print(table(rows))
    poor = [row for row in rows if row["outcome"] != "CONVERGED" or "ratios" not in row or max(row["ratios"].values()) > 1]
    print("\nnot solved, not judged or not covered:\n\n" + ("\n".join(describe(row) for row in poor) or "none"))


if __name__ == "__main__":
    main()
