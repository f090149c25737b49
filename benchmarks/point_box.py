"""Random cold states of the ball: how many are solved, and whether the stated errors cover the true ones.

Usage::

    python benchmarks/point_box.py [--number 300] [--rtol 1e-6] [--seed 14] [--largest 1500] [--out build/point_box.jsonl]

Of ten states four have the exponential law, three that of Persson (H = 0.8, q1/q0 = 1000, gamma = 0.45), two are smooth and
one is at rest.  Groups are even in the logarithm: speed 1e-7 to 1e3, load 1e-8 to 10 (Persson to 1e4), kappa 1e-5 to 10,
smooth speeds 1e-5 to 1e4.  Each state is solved once more on a mesh with panels half as wide at the edge and in the middle,
three degrees and 1.4 times the modes more; by how much it differs from that is taken for its error, where that mesh takes no
more MB than ``--largest``, as it costs three times the state.  States that are done are kept in the file and not solved again,
those that are not judged neither as long as their mesh is too large: an interrupted run goes on.  300 states take about an
hour; prints the table that docs/numerics_tables.md shows.
"""

from __future__ import annotations

import argparse
import json
import math
import time
from collections import Counter
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

import stribeck as sb
from stribeck.contact_laws.law import ContactLaw
from stribeck.equations.point.mesh_choice import Resolution, bytes_of
from stribeck.equations.point.observables import MINIMA, observables
from stribeck.numerics.threads import one_blas_thread
from stribeck.solver.point.estimate import Pair
from stribeck.solver.point.level import solve_level
from stribeck.solver.point.solve import _dry_level, solve_cold
from stribeck.solver.point.state import PointState

USUAL = "exponential"
KINDS = (USUAL, "persson", "smooth", USUAL, "persson", "rest", USUAL, "smooth", "persson", USUAL)
FINER_DEGREE, FINER_MODES, MOST_MODES = 3, 1.4, 200
TIGHT = 1e-11
SHIFTED = ("central_gap", "minimum_gap", "minimum_gap_on_axis", "offset")


@cache
def persson() -> ContactLaw:
    """Return Persson's law of the states in ``tests/data/point_states.json``."""
    spectrum = sb.surfaces.SelfAffine(h_rms=1e-6, q0=3e4, q1=3e7, hurst=0.8)
    return sb.surfaces.persson_law(spectrum, 0.45)


def draw(seed: int, number: int) -> tuple[str, sb.Groups]:
    """Return the kind and the groups of one state; that of a number does not depend on the others."""
    rng = np.random.default_rng([seed, number])
    kind = KINDS[number % len(KINDS)]
    speed, load, kappa, smooth = 10 ** rng.uniform((-7, -8, -5, -5), (3, 4 if kind == "persson" else 1, 1, 4))
    if kind == "smooth":
        return kind, sb.Groups(smooth, 1e-3, 0.0, geometry="point")
    law = persson() if kind == "persson" else None
    speed = 0.0 if kind == "rest" else speed
    return kind, sb.Groups(speed, load, kappa * load ** (2 / 3), law=law, geometry="point")


def finer_mesh(state: PointState) -> Resolution:
    """Return the mesh of the judge."""
    fine = state.work.fine
    modes = max(fine.mesh.modes, min(MOST_MODES, round(FINER_MODES * fine.mesh.modes)))
    # Narrower panels at the edge of the contact would leave wider ones elsewhere, where splits are edges then: all are halved.
    now, near = fine.resolution, fine.mesh.edges[: fine.mesh.log_from + 1]
    splits = tuple(sorted({*now.splits, *(0.5 * (near[:-1] + near[1:])).tolist()}))
    return replace(now, degree=now.degree + FINER_DEGREE, modes=modes, splits=splits)


def better_values(state: PointState, finer: Resolution) -> dict[str, float] | None:
    """Return the observables on a finer mesh, None where it has no solution."""
    fine = state.work.fine
    speed, law = fine.equations.speed, fine.equations.law
    if speed == 0:
        level = _dry_level(law, fine.resolution.degree + FINER_DEGREE, TIGHT, state.groups.model)
    else:
        level = solve_level(finer, speed, law, fine.unknowns, fine.mesh, TIGHT)
    if not level.outcome.ok:
        return None
    found = observables(level.equations, level.unknowns)
    shift = state.values["offset"] - observables(fine.equations, fine.unknowns)["offset"]
    return found | {name: found[name] + shift for name in SHIFTED}


def judged(seed: int, number: int, rtol: float, largest: float = math.inf) -> dict[str, Any]:
    """Return what came of one state, with its true errors where the finer mesh takes at most ``largest`` MB."""
    kind, groups = draw(seed, number)
    row: dict[str, Any] = {"seed": seed, "number": number, "rtol": rtol, "kind": kind, "speed": float(groups.speed)}
    row |= {"load": float(groups.load), "kappa": float(groups.relative_roughness)}
    start = time.process_time()
    state = solve_cold(groups, rtol)
    row |= {"outcome": state.outcome.name, "seconds": time.process_time() - start}
    if not isinstance(state.work, Pair):
        return row
    friction = abs(state.values["J_balanced"]) or 1.0
    row |= {
        "estimate": state.error_estimate,
        "minimum_estimate": state.minimum_gap_error,
        "rings": state.mesh.rings,
        "modes": state.mesh.modes,
        "load_error": abs(state.load_error),
        "identity": abs(state.identity_error) / friction,
    }
    finer = finer_mesh(state)
    row["needs"] = 1e-6 * bytes_of(finer) if groups.speed else 0.0
    exact = better_values(state, finer) if row["needs"] <= largest else None
    if exact is None:
        row["needs"] = row["needs"] if row["needs"] > largest else math.inf
    else:
        off = {name: abs(state.values[name] - exact[name]) for name in state.absolute_errors}
        ratios = {name: off[name] / error if off[name] else 0.0 for name, error in state.absolute_errors.items()}
        kept = {name: ratio for name, ratio in ratios.items() if name not in MINIMA}
        row["worst"] = max(kept, key=kept.__getitem__)
        row["ratio"] = kept[row["worst"]]
        row["error"] = max(abs(state.values[name] - exact[name]) / state.scales[name] for name in kept)
        row["minimum_ratio"] = ratios["minimum_gap"]
        row["minimum_error"] = abs(state.values["minimum_gap"] - exact["minimum_gap"]) / state.scales["minimum_gap"]
    return row


def table(rows: list[dict[str, Any]]) -> str:
    """Return the counts by kind."""
    lines = [
        "| states | number | solved | judged | error covered | worst error/stated | CPU s, median | most |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for kind in (*dict.fromkeys(KINDS), "all"):
        some = [row for row in rows if kind in (row["kind"], "all")]
        checked = [row for row in some if "ratio" in row]
        if not checked:
            continue
        ratios = np.array([row["ratio"] for row in checked])
        seconds = [row["seconds"] for row in some]
        solved = sum(row["outcome"] == "CONVERGED" for row in some)
        lines.append(
            f"| {kind} | {len(some)} | {solved} | {len(checked)} | {np.mean(ratios <= 1):.1%} | {ratios.max():.1f}"
            f" | {np.median(seconds):.1f} | {max(seconds):.0f} |"
        )
    return "\n".join(lines)


def describe(row: dict[str, Any]) -> str:
    """Return a state in a line."""
    here = f"{row['number']}: {row['kind']}, speed {row['speed']:.3e}, load {row['load']:.3e}, kappa {row['kappa']:.3e}"
    names = ("estimate", "minimum_estimate", "ratio", "minimum_ratio")
    found = ", ".join(f"{name} {row[name]:.2g}" for name in names if name in row)
    return f"{here}: {row['outcome']}, {found} {row.get('worst', '')}"


@one_blas_thread
def main() -> None:
    """Solve the states that the file does not hold, and print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--number", type=int, default=300)
    parser.add_argument("--rtol", type=float, default=1e-6)
    parser.add_argument("--seed", type=int, default=14)
    parser.add_argument("--largest", type=float, default=1500.0, help="mesh up to which a state is judged [MB]")
    parser.add_argument("--out", type=Path, default=Path("build/point_box.jsonl"))
    arguments = parser.parse_args()
    arguments.out.parent.mkdir(parents=True, exist_ok=True)
    old = [json.loads(line) for line in arguments.out.read_text().splitlines()] if arguments.out.exists() else []
    # Of a state that was solved again, judged by a larger mesh, the last row counts.
    latest = {row["number"]: row for row in old if (row["seed"], row["rtol"]) == (arguments.seed, arguments.rtol)}
    rows = [row for row in latest.values() if "ratio" in row or row.get("needs", math.inf) > arguments.largest]
    done = {row["number"] for row in rows}
    rows = [row for row in rows if row["number"] < arguments.number]
    with arguments.out.open("a") as file:
        for number in range(arguments.number):
            if number not in done:
                rows.append(judged(arguments.seed, number, arguments.rtol, arguments.largest))
                print(json.dumps(rows[-1]), file=file, flush=True)
    print(f"{arguments.number} random cold states, rtol {arguments.rtol:g}, seed {arguments.seed}:\n")
    print(table(rows))
    poor = [row for row in rows if row["outcome"] != "CONVERGED" or max(row.get("ratio", 0), row.get("minimum_ratio", 0)) > 1]
    counts = Counter(row["outcome"] for row in rows)
    print(f"\noutcomes: {dict(counts)}; not solved, or not covered:\n")
    print("\n".join(describe(row) for row in poor) or "none")


if __name__ == "__main__":
    main()
