"""Making a table of the atlas from solved states: ``make atlas``, or ``python -m evidence.atlas_build NAME``.

First coarse curves over the speed find where the segments of :mod:`stribeck.atlas.grid` end, as polynomials in load and
roughness.  Then a curve for each node in load and roughness is solved at the nodes of all segments.  Finished parts
are kept in a folder, so that an interrupted build can resume.  The coefficients follow from the values at the nodes.
"""

from __future__ import annotations

import argparse
import ast
import hashlib
import json
import math
import time
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

import stribeck
from evidence.atlas_states import MAX_YIELD_OF_ROUGHNESS, PLANS, SEGMENT_SHARES, Plan, coarse_breaks, law_of, solved
from stribeck._types import Array
from stribeck.atlas.grid import (
    BREAK_TERMS,
    SEGMENTS,
    Grid,
    Region,
    breaks_from,
    chebyshev,
)
from stribeck.atlas.table import COEFFICIENT_UNIT
from stribeck.atlas.tables import TABLES, TableRow

# Modules that make the states of a table; by the hash of these and of all that they import a build knows which lines it kept
# are its own.
SOLVER_MODULES = ("solver.solve", "solver.point.solve")

# Packages whose code changes the numbers
NUMERIC_PACKAGES = {"contact_laws", "contacts", "equations", "fluids", "numerics", "solids", "solver"}

MIN_COEFFICIENT = 2e-8  # Size of coefficients below which a polynomial is left out.

ROWS = {row.name: row for row in TABLES}


def coarse_line(name: str, region: int, i: int) -> Array:
    """Return b_1 .. b_5 at the coarse nodes in load for one in roughness, shape (loads, 5)."""
    row, counts = ROWS[name], PLANS[name].coarse_nodes
    where = row.grid.regions[region]
    kappa = roughness_at(where, float(nodes(counts[0])[i]))
    loads = [log_load_at(where, y, kappa) for y in nodes(counts[1])]
    return np.array([coarse_breaks(row, where, log_load, kappa) for log_load in loads])


def break_polynomials(plan: Plan, values: Array) -> Array:
    """Return the coefficients of b_1 .. b_5, shape (5, terms, terms), of values at the coarse nodes (roughness, load, 5)."""
    K, Y = (to_coefficients(count)[:BREAK_TERMS] for count in plan.coarse_nodes)
    found = np.zeros((values.shape[-1], BREAK_TERMS, BREAK_TERMS))
    found[:, : len(K), : len(Y)] = np.einsum("ai,bj,ijq->qab", K, Y, values)
    return found


# --- the table ---


def roughness_at(where: Region, coordinate: float) -> float:
    """Return the relative roughness at a coordinate in [-1, 1] of a region."""
    low, high = (math.log(end) for end in where.roughness)
    return math.exp(low + 0.5 * (coordinate + 1) * (high - low))


def in_region(piece: int, pieces: int, coordinate: Array) -> Array:
    """Return the coordinate of a region for one of a piece."""
    return np.asarray((2 * piece + 1 + coordinate) / pieces - 1)


def line(name: str, breaks: Array, region: int, i: int, j: int, k: int) -> Array:
    """Return the tabulated functions for one node in roughness of a piece, shape (loads, speeds, functions)."""
    row, grid = ROWS[name], ROWS[name].grid
    where = grid.regions[region]
    x = in_region(i, where.pieces[0], roughness_nodes(where)[k : k + 1])
    kappa = roughness_at(where, float(x[0]))
    found = []
    for y in in_region(j, where.pieces[1], nodes(where.nodes[1])):
        products = np.outer(chebyshev(x, BREAK_TERMS)[:, 0], chebyshev(np.array([y]), BREAK_TERMS)[:, 0])
        ends = breaks_from(np.einsum("qab,ab->q", breaks, products))
        log_load = log_load_at(where, y, kappa)
        speeds = segment_nodes(where, ends, grid.power)
        values = solved(row, speeds, log_load, kappa, PLANS[name].rtol)
        values[: where.speeds[0], 0] -= grid.power * speeds[: where.speeds[0]]
        if not np.isfinite(values).all():
            raise RuntimeError(f"load {grid.load_at(log_load):.6g}, relative roughness {kappa:.6g}: no logarithm")
        found.append(values)
    return np.array(found)


def piece_blocks(where: Region, lines: Sequence[Array]) -> list[Array]:
    """Return the dense coefficients of the segments of a piece, each along speed, roughness, load and function."""
    values = np.stack(lines)  # roughness, load, speed, function
    K, Y = np.linalg.inv(chebyshev(roughness_nodes(where), where.nodes[0]).T), to_coefficients(where.nodes[1])
    found, first = [], 0
    for count in where.speeds:
        part = values[:, :, first : first + count]
        T = to_coefficients(count) if count else np.empty((0, 0))
        dense = np.einsum("ai,bj,ct,ijtf->cabf", K, Y, T, part, optimize=True)
        found.append(np.where(np.abs(dense) > MIN_COEFFICIENT, dense, 0.0))
        first += count
    assert len(found) == SEGMENTS
    return found


def film_coefficients(name: str) -> Array:
    """Return the coefficients of smooth films, shape (pieces, terms, functions without the first)."""
    row, plan = ROWS[name], PLANS[name]
    pieces, count = plan.films
    low, high = (math.log(end) for end in row.grid.films)
    x = np.concatenate([in_region(piece, pieces, nodes(count)) for piece in range(pieces)])
    speeds = low + 0.5 * (x + 1) * (high - low)
    values = solved(row, speeds, row.grid.log_load(np.asarray(0.1)).item(), 0.0, plan.film_rtol)[:, 1:]
    return np.asarray(np.einsum("ct,ptf->pcf", to_coefficients(count), values.reshape(pieces, count, -1)))


# --- running it ---


def kept(folder: Path, name: str, make: Callable[[], Array]) -> Array:
    """Return the array that a folder keeps under a name; make and keep it if it is missing."""
    path = folder / f"{name}.npy"
    if path.exists():
        return np.asarray(np.load(path))
    made = make()
    partly = path.with_suffix(".part.npy")
    np.save(partly, made)
    partly.replace(path)
    return made


def key_of(name: str, region: int, *more: Any) -> str:
    """Return a name made from all inputs on which the ends of the segments of a region depend, and from further ones."""
    grid, plan = ROWS[name].grid, PLANS[name]
    where = grid.regions[region]
    coordinates = grid.heaviest, grid.load_factor, grid.power, where.roughness, where.logs, where.closing, where.has_rest
    coarse = plan.coarse_nodes, plan.coarse_step, plan.coarse_rtol, SEGMENT_SHARES, MAX_YIELD_OF_ROUGHNESS
    return f"{name}-{hashlib.sha256(repr((coordinates, coarse, *more)).encode()).hexdigest()[:8]}"


def _kept_coarse(folder: Path, name: str, task: tuple[int, int]) -> Array:
    region, i = task
    return kept(folder, f"{key_of(name, region)}-coarse-{i}", partial(coarse_line, name, *task))


def _kept_line(folder: Path, name: str, breaks: tuple[Array, ...], task: tuple[int, int, int, int]) -> Array:
    region, i, j, k = task
    where = ROWS[name].grid.regions[region]
    x = in_region(i, where.pieces[0], roughness_nodes(where)[k : k + 1])
    key = key_of(name, region, where.pieces[1], where.nodes[1], where.speeds, BREAK_TERMS, PLANS[name].rtol)
    return kept(folder, f"{key}-line-{j}-{round(float(x[0]), 9) + 0.0:+.9f}", partial(line, name, breaks[region], *task))


def _run(what: str, pool: ProcessPoolExecutor, work: Callable[[Any], Array], tasks: Sequence[Any]) -> list[Array]:
    """Return the results of all tasks, and report progress."""
    begun, found = time.monotonic(), []
    for result in pool.map(work, tasks):
        found.append(result)
        print(f"\r{what}: {len(found)} of {len(tasks)}, {time.monotonic() - begun:.0f} s", end="", flush=True)
    print()
    return found


def tasks_of_pieces(grid: Grid) -> Iterable[tuple[int, int, int]]:
    """Yield region and piece in roughness and load, in the order of the table."""
    for number, region in enumerate(grid.regions):
        for i in range(region.pieces[0]):
            for j in range(region.pieces[1]):
                yield number, i, j


def build(row: TableRow, target: Path, folder: Path, workers: int) -> None:
    """Make a table and write it."""
    begun, plan, regions = time.monotonic(), PLANS[row.name], row.grid.regions
    folder = folder / solver_hash()[:8]
    folder.mkdir(parents=True, exist_ok=True)
    with ProcessPoolExecutor(workers) as pool:
        coarse = [(number, i) for number in range(len(regions)) for i in range(plan.coarse_nodes[0])]
        values = _run("ends of segments", pool, partial(_kept_coarse, folder, row.name), coarse)
        count = plan.coarse_nodes[0]
        breaks = tuple(break_polynomials(plan, np.stack(values[n * count : (n + 1) * count])) for n in range(len(regions)))
        pieces = list(tasks_of_pieces(row.grid))
        tasks = [(*piece, k) for piece in pieces for k in range(regions[piece[0]].nodes[0])]
        lines = dict(zip(tasks, _run("lines", pool, partial(_kept_line, folder, row.name, breaks), tasks), strict=True))
    films = "-".join(f"{each:g}" for each in (*row.grid.films, *plan.films, plan.film_rtol))
    film = kept(folder, f"{row.name}-film-{films}", partial(film_coefficients, row.name))
    blocks: list[Array] = []
    for piece in pieces:
        where = regions[piece[0]]
        blocks += piece_blocks(where, [lines[*piece, k] for k in range(where.nodes[0])])
    about = {
        "version": version("stribeck"),
        "solver_hash": solver_hash(),
        "states": int(sum(result.shape[0] * result.shape[1] for result in lines.values())),
        "rtol": plan.rtol,
        "functions": list(row.functions),
        "unit": COEFFICIENT_UNIT,
    }
    target.parent.mkdir(exist_ok=True)
    np.savez_compressed(target, **pack(breaks, blocks, film, about, law_of(row)))
    print(f"{target.name}: {target.stat().st_size / 1e6:.2f} MB, {about['states']} states, {time.monotonic() - begun:.0f} s")


def main() -> None:
    """Build tables from the command line."""
    parser = argparse.ArgumentParser(description="Make tables of stribeck.atlas from solved states.")
    parser.add_argument("names", nargs="*", default=[TABLES[0].name], help=f"of {', '.join(ROWS)}")
    parser.add_argument(
        "--target", type=Path, default=Path(stribeck.__file__).parent / "atlas", help="the folder to write into"
    )
    parser.add_argument("--folder", type=Path, default=Path("build") / "atlas", help="where finished lines are kept")
    parser.add_argument("--workers", type=int, default=2, help="processes")
    arguments = parser.parse_args()
    for name in arguments.names:
        build(ROWS[name], arguments.target / ROWS[name].file, arguments.folder, arguments.workers)


def nodes(count: int) -> Array:
    """Return the zeros of a Chebyshev polynomial, ascending."""
    return np.asarray(-np.cos(math.pi * (np.arange(count) + 0.5) / count))


def roughness_nodes(region: Region) -> Array:
    """Return the nodes of a piece in roughness, ascending in [-1, 1]."""
    count = region.nodes[0]
    return np.asarray(-np.cos(math.pi * np.arange(count) / (count - 1))) if region.nested else nodes(count)


def to_coefficients(count: int) -> Array:
    """Return the matrix from values at :func:`nodes` to Chebyshev coefficients."""
    matrix = chebyshev(nodes(count), count) * (2 / count)
    matrix[0] /= 2
    return matrix


def log_load_at(region: Region, coordinate: float, kappa: float) -> float:
    """Return L at a coordinate, the inverse of :meth:`Region.load_coordinate`."""
    delta = region.delta(np.asarray(kappa))
    low, high = (np.log(end + delta) for end in region.logs)
    return float(np.maximum(np.exp(low + 0.5 * (coordinate + 1) * (high - low)) - delta, 0.0))


def segment_nodes(region: Region, ends: Array, power: int = 2) -> Array:
    """Return the logarithms of the speeds at the nodes of all segments that end at ``ends``."""
    squared = np.empty(0) if not region.has_rest else ends[0] + 1 / power * np.log(0.5 * (nodes(region.speeds[0]) + 1))
    others = [
        low + 0.5 * (nodes(count) + 1) * (high - low)
        for low, high, count in zip(ends[:-1], ends[1:], region.speeds[1:], strict=True)
    ]
    return np.concatenate([squared, *others])


def pack(
    breaks: tuple[Array, ...], blocks: list[Array], film: Array, about: dict[str, Any], law: Array | None = None
) -> dict[str, Any]:
    """Return the arrays of the file for dense blocks, in whole units of :data:`COEFFICIENT_UNIT`."""
    joined = np.concatenate([np.ascontiguousarray(np.moveaxis(block, 3, 0)).ravel() for block in blocks])
    return {
        "breaks": np.stack(breaks),
        "blocks": np.round(joined / COEFFICIENT_UNIT).astype(np.int32),
        "film": film,
        "about": np.array(json.dumps(about)),
        "law": np.empty((2, 0)) if law is None else law,
    }


def solver_sources() -> list[str]:
    """Return the modules of the solver: :data:`SOLVER_MODULES` and all that these import, at once or on first use, sorted."""
    found: set[str] = set()
    waiting = list(SOLVER_MODULES)
    while waiting:
        name = waiting.pop()
        if name in found:
            continue
        found.add(name)
        for node in ast.walk(ast.parse(_source(name))):
            if isinstance(node, ast.ImportFrom) and node.module and node.module.startswith("stribeck."):
                module = node.module.removeprefix("stribeck.")
                inner = [f"{module}.{alias.name}" for alias in node.names]
                waiting += [each for each in (module, *inner) if each.split(".")[0] in NUMERIC_PACKAGES and _source(each)]
    return sorted(found)


def _source(name: str) -> str:
    """Return the source of a module of the package, nothing if there is none of this name."""
    place = Path(stribeck.__file__).parent.joinpath(*name.split("."))
    return next((path.read_text("utf-8") for path in (place.with_suffix(".py"), place / "__init__.py") if path.exists()), "")


def solver_hash() -> str:
    """Return the SHA-256 of the sources of the solver."""
    found = hashlib.sha256()
    for name in solver_sources():
        found.update(_source(name).encode())
    return found.hexdigest()


if __name__ == "__main__":
    main()
