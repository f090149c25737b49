"""Random cold starts of other fluids, cavities, flow factors, solids and motions: how many are solved, and how truly.

Usage::

    python benchmarks/fluid_box.py FAMILY [--number 200] [--seed 20261122] [--rtol 1e-6] [--out STATES.jsonl] [--table]
    python benchmarks/fluid_box.py FAMILY --rtol 1e-3 --outcomes --number 500 --out AFTER.jsonl --before BEFORE.jsonl

FAMILY is cavitation, pressure, thinning, flow, layer, motion, combined, wide_thinning or wide_cavitation.  Groups are drawn
evenly in the logarithm over the box of the solver: speed 1e-12 to 1e6, load 1e-8 to 10, relative roughness 1e-6 to 1e3, one
state in eight smooth.  The numbers of the laws are drawn over their ranges; relaxation times so that the Weissenberg number in
the film is 0.01 to 1000, 1e-4 to 1e6 of wide_thinning.

The true error is that against a mesh with each panel halved, four more nodes on each and panels that reach eight times as far,
from which Newton's iteration starts anew.  A state is wrong where that exceeds ten times the stated error.  With --out each
state is a line of that file, and a later run goes on behind the last; --table prints what a file holds, and solves nothing.
With --outcomes the true error is left out: at --rtol 1e-3 five hundred states of a family take one to five minutes.  With
--before the outcomes are counted beside those of another file, that of the code before a change.
"""

from __future__ import annotations

import argparse
import json
import math
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

import stribeck as sb
from stribeck.contacts.with_parts import with_parts
from stribeck.equations.observables import observables
from stribeck.equations.operators import Operators
from stribeck.equations.state import solve_state
from stribeck.numerics.threads import one_blas_thread
from stribeck.quantities.outputs import ALL_NAMES, NAMES
from stribeck.solver.refinement import RefinedState
from stribeck.solver.solve import minimum_estimate, solved_point
from stribeck.solver.solve_error import SolveError

FAMILIES = ("cavitation", "pressure", "thinning", "flow", "layer", "motion", "combined", "wide_thinning", "wide_cavitation")
WRONG = 10.0
"""True over stated error from which a state counts as wrong."""

OUTWARDS = 3
"""How often the reach of the panels is doubled for the true error."""

FRAME = 0.9
"""Length of a cavity on the mesh for the true error over that on the mesh of the state."""

KEPT_VALUES = ("central_gap", "viscous_balanced")
"""Observables of a state that a later run is compared with."""

SAME_STATE_RTOLS = 10.0
"""Difference of an observable over the tolerance above which two runs have found different states."""


def draw(family: str, index: int, seed: int) -> tuple[sb.Groups, dict[str, Any]]:
    """Return groups and parts of one random state; those of one index do not depend on the others."""
    rng = np.random.default_rng([seed, FAMILIES.index(family), index])
    speed, load, kappa = (float(value) for value in 10 ** rng.uniform((-12, -8, -6), (6, 1, 3)))
    kappa = 0.0 if index % 8 == 7 and family != "flow" else kappa
    groups = sb.Groups(speed, load, kappa * load)
    if family != "combined":
        parts = PARTS[family](rng, groups)
        if family not in ("cavitation", "motion", "wide_thinning", "wide_cavitation"):
            parts["cavitation"] = str(rng.choice(["none", "exit"]))
        return groups, parts
    parts = cavitation(rng, groups) | motion_alone(rng)
    thins = rng.random() < 0.5
    parts["fluid"] = sb.fluids.Fluid(
        thinning(rng, groups)["fluid"] if thins else None, viscosity(rng), density(rng) if rng.random() < 0.3 else None
    )
    if not thins and kappa > 0 and rng.random() < 0.5:
        parts |= flow(rng, groups)
    if rng.random() < 0.5:
        parts |= layer(rng, groups)
    return groups, parts


def cavitation(rng: np.random.Generator, groups: sb.Groups, decades: tuple[float, float] = (-4, 0)) -> dict[str, Any]:
    """Return a film that ends, or one that re-forms at a suction within some decades of the Hertz pressure."""
    if rng.random() < 0.5:
        return {"cavitation": "exit"}
    return {"cavitation": "reform", "cavity_pressure": -float(10 ** rng.uniform(*decades))}


def wide_cavitation(rng: np.random.Generator, groups: sb.Groups) -> dict[str, Any]:
    """Return a film that ends or re-forms at any suction, of any fluid whose viscosity is that of its pressure."""
    parts = cavitation(rng, groups, (-7, 1)) | motion_alone(rng)
    return parts | {"fluid": sb.fluids.Fluid(None, viscosity(rng))} if rng.random() < 0.3 else parts


def viscosity(rng: np.random.Generator) -> Any:
    """Return a viscosity under pressure."""
    coefficient = float(10 ** rng.uniform(-2, math.log10(5)))
    if rng.random() < 0.5:
        return sb.fluids.Barus(coefficient)
    return sb.fluids.Roelands(coefficient, float(10 ** rng.uniform(-1, 1)), float(10 ** rng.uniform(-5, -2)))


def density(rng: np.random.Generator) -> Any:
    """Return a density under pressure."""
    return sb.fluids.DowsonHigginson(float(10 ** rng.uniform(-0.3, 2)))


def pressure(rng: np.random.Generator, groups: sb.Groups) -> dict[str, Any]:
    """Return a fluid that stiffens."""
    return {"fluid": sb.fluids.Fluid(None, viscosity(rng), density(rng) if rng.random() < 0.3 else None)}


def film_of(groups: sb.Groups) -> float:
    """Return about the central gap."""
    speed = float(groups.speed)
    roughness = float(groups.relative_roughness)
    return max(min(0.4459 * speed**0.6, (speed**2 / 24) ** (1 / 3)) if speed > 1 else 0.4459 * speed**0.6, roughness)


def wide_thinning(rng: np.random.Generator, groups: sb.Groups) -> dict[str, Any]:
    """Return a fluid that thins over ten decades of its rate, in a full film, one that ends or one that re-forms."""
    parts = thinning(rng, groups, (-4, 6), 0.1)
    return parts | cavitation(rng, groups) if rng.random() < 2 / 3 else parts


def thinning(
    rng: np.random.Generator, groups: sb.Groups, decades: tuple[float, float] = (-2, 3), least_exponent: float = 0.2
) -> dict[str, Any]:
    """Return a fluid that thins, and how the surfaces slide."""
    time = film_of(groups) * float(10 ** rng.uniform(*decades))
    exponent, least = float(rng.uniform(least_exponent, 0.95)), float(10 ** rng.uniform(-4, -1)) * (rng.random() < 0.5)
    laws = (
        lambda: sb.fluids.Carreau(time, exponent, least),
        lambda: sb.fluids.Cross(time, exponent, least),
        lambda: sb.fluids.Eyring(1 / time),
        lambda: sb.fluids.PowerLaw(time, float(rng.uniform(0.65, 0.98))),
    )
    number = 4 if groups.geometry == "line" else 3  # a power law has no ball
    return {"fluid": laws[rng.integers(number)](), **motion_alone(rng)}


def flow(rng: np.random.Generator, groups: sb.Groups) -> dict[str, Any]:
    """Return flow factors."""
    alpha = float(rng.uniform(1, 4))
    if rng.random() < 0.5:
        return {"flow_factors": sb.fluids.EffectiveMedium(alpha)}
    gamma, share = float(rng.choice([1 / 9, 1 / 3, 1.0, 3.0, 9.0])), float(rng.choice([0.0, 0.5, 1.0]))
    return {"flow_factors": sb.fluids.PatirCheng(alpha, gamma, share)}


def layer(rng: np.random.Generator, groups: sb.Groups) -> dict[str, Any]:
    """Return a bonded layer."""
    ratio = 0.5 if rng.random() < 0.4 else float(rng.uniform(0, 0.5))
    return {"solid": sb.solids.Layer(float(10 ** rng.uniform(-0.5, 2)), ratio)}


def motion_alone(rng: np.random.Generator) -> dict[str, Any]:
    """Return how the surfaces slide."""
    return {"slide_to_roll": float(rng.choice([2.0, 0.0, rng.uniform(-4, 4)]))}


def motion(rng: np.random.Generator, groups: sb.Groups) -> dict[str, Any]:
    """Return how the surfaces slide, and a body that remembers or two of them."""
    parts = motion_alone(rng)
    deborah, ratio = float(10 ** rng.uniform(-2, 1)), float(rng.uniform(1.2, 10))
    solids = (
        lambda: None,
        lambda: sb.solids.StandardLinearSolid(deborah, ratio),
        lambda: sb.solids.Prony((deborah, 0.1 * deborah), (0.5 * (ratio - 1), 0.5 * (ratio - 1))),
        lambda: sb.solids.TwoBodies(sb.solids.Layer(3.0, 0.5), sb.solids.HalfPlane(), float(rng.uniform(0.05, 0.95))),
    )
    solid = solids[rng.integers(4)]()
    if getattr(solid, "uses_speed", False) and parts["slide_to_roll"] < -2:  # refused: memory moves against the flow
        parts["slide_to_roll"] = -parts["slide_to_roll"]
    return parts if solid is None else {**parts, "solid": solid}


PARTS = {
    "cavitation": cavitation,
    "pressure": pressure,
    "thinning": thinning,
    "flow": flow,
    "layer": layer,
    "motion": motion,
    "wide_thinning": wide_thinning,
    "wide_cavitation": wide_cavitation,
}


def true_errors(point: RefinedState) -> np.ndarray:
    """Return the errors of the observables against a finer and wider mesh, as the estimate means them."""
    state, groups = point.state, point.groups
    assert state is not None and point.values is not None and point.estimate is not None
    coarse = state.mesh
    edges = np.sort(np.append(coarse.edges, 0.5 * (coarse.edges[1:] + coarse.edges[:-1])))
    out = edges[-1] * 2.0 ** np.arange(1, OUTWARDS + 1)
    below = edges[0] * 2.0 ** np.arange(1, OUTWARDS + 1)
    mesh = replace(coarse, edges=np.concatenate([below[::-1], edges, out]), order=coarse.order + 4)
    if mesh.reformation < math.inf:  # in another frame too
        mesh = replace(mesh, edges=FRAME * mesh.edges, reformation=FRAME * mesh.reformation)
    fine = solve_state(state.groups, Operators(mesh, state.groups.model), state, 1e-11)
    if not fine.outcome.ok:
        raise ArithmeticError(f"the finer mesh has no state: {fine.outcome.value}")
    exact = observables(fine.equations, fine.y, float(groups.load)).array()
    return np.abs(point.values.array() - exact) / point.estimate.scales


def measured(groups: sb.Groups, parts: dict[str, Any], rtol: float, is_judged: bool) -> dict[str, Any]:
    """Return what became of one state, with its true error if it is judged."""
    start = time.perf_counter()
    try:
        point = one_blas_thread(solved_point)(with_parts(groups, **parts), rtol)
    except SolveError as error:
        return {"outcome": error.outcome.name, "seconds": time.perf_counter() - start}
    seconds = time.perf_counter() - start
    if point.state is None or point.estimate is None:
        return {"outcome": point.outcome.name, "seconds": seconds}
    found = {"outcome": point.outcome.name, "seconds": seconds, "nodes": point.state.mesh.size}
    found |= {name: float(getattr(point.values, name)) for name in KEPT_VALUES}
    stated = np.maximum(point.estimate.relative, minimum_estimate(rtol, point.groups.model))
    found["stated"] = float(np.nanmax(stated))
    if not is_judged:
        return found
    try:
        errors = one_blas_thread(true_errors)(point)
    except (ArithmeticError, ValueError) as problem:
        return {**found, "problem": str(problem)}
    names = NAMES if len(errors) == len(NAMES) else ALL_NAMES
    worst = int(np.nanargmax(errors))
    return {**found, "error": float(errors[worst]), "of": names[worst], "single": float(np.nanmax(errors / stated))}


def rows_of(family: str, path: Path) -> list[dict[str, Any]]:
    """Return the states of a family that a file holds."""
    rows = [json.loads(line) for line in path.read_text().splitlines()]
    return [row for row in rows if row["family"] == family]


def run(
    family: str, number: int, seed: int, out: Path | None, rtol: float = 1e-6, is_judged: bool = True
) -> Iterator[dict[str, Any]]:
    """Yield the states of a family, those that are in the file first."""
    known = rows_of(family, out) if out is not None and out.exists() else []
    known = [row for row in known if row["seed"] == seed and row["rtol"] == rtol]
    yield from known[:number]
    for index in range(len(known), number):
        groups, parts = draw(family, index, seed)
        row = {"family": family, "seed": seed, "index": index, "rtol": rtol, "speed": groups.speed, "load": groups.load}
        row |= {"relative_roughness": groups.relative_roughness, "parts": {name: repr(part) for name, part in parts.items()}}
        row |= measured(groups, parts, rtol, is_judged)
        if out is not None:
            with out.open("a") as file:
                file.write(json.dumps(row) + "\n")
        yield row


def table_row(family: str, rows: list[dict[str, Any]]) -> str:
    """Return what docs/numerics_tables.md shows of a family."""
    solved = [row for row in rows if row["outcome"] == "CONVERGED"]
    rounding = sum(row["outcome"] == "ROUNDING" for row in rows)
    compared = [row for row in rows if "error" in row]
    ratios = np.array([row["error"] / row["stated"] for row in compared]) if compared else np.array([math.nan])
    seconds = [row["seconds"] for row in rows]
    return (
        f"| {family} | {len(rows)} | {len(solved)} | {rounding} | {len(rows) - len(solved) - rounding} "
        f"| {np.mean(ratios <= 1):.1%} | {np.sum(ratios > WRONG)} | {ratios.max():.1f} "
        f"| {np.median(seconds):.2f} | {max(seconds):.1f} |"
    )


def before_and_after(family: str, before: list[dict[str, Any]], after: list[dict[str, Any]]) -> str:
    """Return how many states of a family were solved by two runs, and how many of these are different states."""
    other = {(row["seed"], row["index"], row["rtol"]): row for row in before}
    pairs = [(other[key], row) for row in after if (key := (row["seed"], row["index"], row["rtol"])) in other]
    solved = [sum(row["outcome"] == "CONVERGED" for row in rows) for rows in zip(*pairs, strict=True)]
    differ = sum(
        any(abs(new[name] / old[name] - 1) > SAME_STATE_RTOLS * new["rtol"] for name in KEPT_VALUES)
        for old, new in pairs
        if old["outcome"] == new["outcome"] == "CONVERGED"
    )
    seconds = [sum(row["seconds"] for row in rows) for rows in zip(*pairs, strict=True)]
    return f"| {family} | {len(pairs)} | {solved[0]} | {solved[1]} | {differ} | {seconds[0]:.0f} | {seconds[1]:.0f} |"


def main() -> None:
    """Print the table of a family."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("family", choices=FAMILIES)
    parser.add_argument("--number", type=int, default=200)
    parser.add_argument("--seed", type=int, default=20261122)
    parser.add_argument("--rtol", type=float, default=1e-6)
    parser.add_argument("--outcomes", action="store_true", help="leave out the true errors")
    parser.add_argument("--before", type=Path, help="states of the code before a change, to count beside these")
    parser.add_argument("--out", type=Path)
    parser.add_argument("--table", action="store_true")
    arguments = parser.parse_args()
    if arguments.table:
        rows = rows_of(arguments.family, arguments.out)
    else:
        asked = arguments.family, arguments.number, arguments.seed, arguments.out, arguments.rtol
        rows = list(run(*asked, is_judged=not arguments.outcomes))
    if arguments.before is not None:
        print("| family | states | solved before | solved after | other states | s before | s after |")
        print("|---|---|---|---|---|---|---|")
        print(before_and_after(arguments.family, rows_of(arguments.family, arguments.before), rows))
        return
    print(
        "| family | states | converged | bounded by rounding | failed | error covered | wrong | largest error/estimate "
        "| s, median | most |"
    )
    print("|---|---|---|---|---|---|---|---|---|---|")
    print(table_row(arguments.family, rows))


if __name__ == "__main__":
    main()
