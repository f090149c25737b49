"""Making the table of the atlas from solved states: ``make atlas``, or ``python -m stribeck.evidence.atlas_build``.

First coarse curves over the speed find where the segments of :mod:`stribeck.atlas.grid` end, as polynomials in load and
roughness.  Then a curve for each node in load and roughness is solved at the nodes of all segments.  Both are kept in a folder
as they are finished, so that a build that was interrupted goes on.  The coefficients follow from the values at the nodes.
"""

from __future__ import annotations

import argparse
import hashlib
import math
import time
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from stribeck._types import Array
from stribeck.atlas.grid import (
    BREAK_TERMS,
    MIN_SPEED,
    REGIONS,
    SEGMENTS,
    SHARES,
    YIELDING,
    breaks_from,
    chebyshev,
    nodes,
    segment_nodes,
    to_coefficients,
)
from stribeck.atlas.table import FILE, FILM_RANGE, STEP, TABULATED, pack, solver_hash
from stribeck.curves.stribeck_curve import stribeck_curve

RTOL = 1e-6
"""Tolerance of the states of the table."""

COARSE_RTOL = 1e-4
COARSE_NODES = (14, 12)
"""Of the curves that find the ends of the segments: tolerance, and nodes of a region in roughness and load."""

COARSE_STEP = 0.35
"""Their step in the logarithm of the speed."""

FILM_PIECES, FILM_NODES, FILM_RTOL = 8, 20, 1e-7
"""Of the smooth films: pieces of the logarithm of the speed, nodes of a piece, and tolerance."""

NEGLIGIBLE = 2e-8
"""Coefficients up to which a polynomial is left out."""


def solved(log_speeds: Array, log_load: float, kappa: float, rtol: float) -> Array:
    """Return the observables along ascending speeds, shape (speeds, observables)."""
    load = math.exp(-log_load)
    curve = stribeck_curve(load=load, roughness=kappa * load, speed=np.exp(log_speeds), rtol=rtol)
    if len(curve) != len(log_speeds):
        raise RuntimeError(f"load {load:.6g}, relative roughness {kappa:.6g}: {curve.outcome.value}")
    return np.array([s.observables.array() for s in curve.solutions])


def tabulated(observed: Array, log_speeds: Array, log_load: float) -> Array:
    """Return the functions of :data:`TABULATED` on solved states, shape (states, functions)."""
    contact, fluid, central, minimum, flux, offset, published, balanced = observed.T
    scale = log_speeds - 0.5 * log_load
    with np.errstate(divide="ignore"):
        logs = [np.log(fluid) - np.log(contact), np.log(published) - scale, np.log(balanced) - scale]
    return np.stack([*logs, np.log(central), np.log(minimum), np.log(flux), offset - central], axis=1)


# --- where segments end ---


def speed_range(log_load: float, kappa: float) -> tuple[float, float]:
    """Return logarithms of speeds from rest to the film without asperities, roughly, by the scales of wedge and film."""
    gap = 0.5 * log_load + math.log(2) + 0.5 * math.log1p(8 * kappa / math.pi)
    wedge = 2 * math.log(kappa) + math.log(5) + 2.55 * math.log(gap)
    film = math.log((kappa * gap / 0.446) ** (5 / 3) + (2.88 * kappa * gap) ** 1.5)
    half = -float(np.logaddexp(-wedge, -film))
    yielding = 2.5 * max(0.0, -math.log(log_load + 2 * kappa / (1 + kappa)))
    return half - math.log(60) - yielding, film + math.log(300)


def breaks_on(log_speeds: Array, observed: Array, has_rest: bool) -> Array:
    """Return b_1 .. b_5 on a coarse curve; b_1 is the minimum speed where segments do not begin at rest."""
    from scipy.interpolate import PchipInterpolator

    there = observed[:, 0] > 1e-300
    s, contact, fluid, central = log_speeds[there], *observed[there, :3].T
    first = math.log(MIN_SPEED)
    if has_rest:
        yielding = fluid / contact + central / central[0] - 1
        early = np.arange(1, 1 + int(np.argmax(yielding > 8 * YIELDING)))
        first = float(PchipInterpolator(np.log(yielding[early]), s[early])(math.log(YIELDING)))
    logs = np.where(contact > 0.5, -np.log1p(-np.minimum(fluid, 0.9)), -np.log(contact))
    return np.array([first, *PchipInterpolator(logs, s)(SHARES).tolist()])


def coarse_line(region: int, i: int) -> Array:
    """Return b_1 .. b_5 at the coarse nodes in load for one in roughness, shape (loads, 5)."""
    where = REGIONS[region]
    kappa = roughness_at(region, float(nodes(COARSE_NODES[0])[i]))
    found = []
    for y in nodes(COARSE_NODES[1]):
        log_load = float(where.log_load(y, np.asarray(kappa)))
        low, high = speed_range(log_load, kappa)
        low = low if where.has_rest else math.log(MIN_SPEED)
        speeds = np.linspace(low, high, max(30, int((high - low) / COARSE_STEP)))
        found.append(breaks_on(speeds, solved(speeds, log_load, kappa, COARSE_RTOL), where.has_rest))
    return np.array(found)


def break_polynomials(values: Array) -> Array:
    """Return the coefficients of b_1 .. b_5, shape (5, terms, terms), of values at the coarse nodes (roughness, load, 5)."""
    K, Y = (to_coefficients(count)[:BREAK_TERMS] for count in COARSE_NODES)
    return np.asarray(np.einsum("ai,bj,ijq->qab", K, Y, values))


# --- the table ---


def roughness_at(region: int, coordinate: float) -> float:
    """Return the relative roughness at a coordinate in [-1, 1] of a region."""
    low, high = (math.log(end) for end in REGIONS[region].roughness)
    return math.exp(low + 0.5 * (coordinate + 1) * (high - low))


def in_region(piece: int, pieces: int, coordinate: Array) -> Array:
    """Return the coordinate of a region for one of a piece."""
    return np.asarray((2 * piece + 1 + coordinate) / pieces - 1)


def line(breaks: Array, region: int, i: int, j: int, k: int) -> Array:
    """Return the tabulated functions for one node in roughness of a piece, shape (loads, speeds, functions)."""
    where = REGIONS[region]
    x = in_region(i, where.pieces[0], nodes(where.nodes[0])[k : k + 1])
    kappa = roughness_at(region, float(x[0]))
    found = []
    for y in in_region(j, where.pieces[1], nodes(where.nodes[1])):
        products = np.outer(chebyshev(x, BREAK_TERMS)[:, 0], chebyshev(np.array([y]), BREAK_TERMS)[:, 0])
        ends = breaks_from(np.einsum("qab,ab->q", breaks, products))
        log_load = float(where.log_load(y, np.asarray(kappa)))
        speeds = segment_nodes(where, ends)
        values = tabulated(solved(speeds, log_load, kappa, RTOL), speeds, log_load)
        values[: where.speeds[0], 0] -= 2 * speeds[: where.speeds[0]]
        if not np.isfinite(values).all():
            raise RuntimeError(f"load {math.exp(-log_load):.6g}, relative roughness {kappa:.6g}: no logarithm")
        found.append(values)
    return np.array(found)


def piece_blocks(region: int, lines: Sequence[Array]) -> list[Array]:
    """Return the dense coefficients of the segments of a piece, each along speed, roughness, load and function."""
    where = REGIONS[region]
    values = np.stack(lines)  # roughness, load, speed, function
    K, Y = (to_coefficients(count) for count in where.nodes)
    found, first = [], 0
    for count in where.speeds:
        part = values[:, :, first : first + count]
        T = to_coefficients(count) if count else np.empty((0, 0))
        dense = np.einsum("ai,bj,ct,ijtf->cabf", K, Y, T, part, optimize=True)
        found.append(np.where(np.abs(dense) > NEGLIGIBLE, dense, 0.0))
        first += count
    assert len(found) == SEGMENTS
    return found


def film_coefficients() -> Array:
    """Return the coefficients of smooth films, shape (pieces, terms, functions without the first)."""
    low, high = FILM_RANGE
    x = np.concatenate([in_region(piece, FILM_PIECES, nodes(FILM_NODES)) for piece in range(FILM_PIECES)])
    speeds = low + 0.5 * (x + 1) * (high - low)
    values = tabulated(solved(speeds, math.log(10), 0.0, FILM_RTOL), speeds, math.log(10))[:, 1:]
    values = values.reshape(FILM_PIECES, FILM_NODES, -1)
    return np.asarray(np.einsum("ct,ptf->pcf", to_coefficients(FILM_NODES), values))


# --- running it ---


def kept(folder: Path, name: str, make: Callable[[], Array]) -> Array:
    """Return what is kept in a folder under a name, made and kept where it is not there."""
    path = folder / f"{name}.npy"
    if path.exists():
        return np.asarray(np.load(path))
    made = make()
    partly = path.with_suffix(".part.npy")
    np.save(partly, made)
    partly.replace(path)
    return made


def _kept_coarse(folder: Path, task: tuple[int, int]) -> Array:
    return kept(folder, "coarse_{}_{}".format(*task), partial(coarse_line, *task))


def _kept_line(folder: Path, breaks: tuple[Array, ...], task: tuple[int, int, int, int]) -> Array:
    return kept(folder, "line_{}_{}_{}_{}".format(*task), partial(line, breaks[task[0]], *task))


def _run(what: str, pool: ProcessPoolExecutor, work: Callable[[Any], Array], tasks: Sequence[Any]) -> list[Array]:
    """Return the results of all tasks, telling how far they are."""
    begun, found = time.monotonic(), []
    for result in pool.map(work, tasks):
        found.append(result)
        print(f"\r{what}: {len(found)} of {len(tasks)}, {time.monotonic() - begun:.0f} s", end="", flush=True)
    print()
    return found


def tasks_of_pieces() -> Iterable[tuple[int, int, int]]:
    """Yield region and piece in roughness and load, in the order of the table."""
    for number, region in enumerate(REGIONS):
        for i in range(region.pieces[0]):
            for j in range(region.pieces[1]):
                yield number, i, j


def build(target: Path, folder: Path, workers: int) -> None:
    """Make the table and write it.

    Parameters
    ----------
    target : Path
        The file.
    folder : Path
        Where finished lines are kept; one folder for each solver and grid.
    workers : int
        Processes.
    """
    begun = time.monotonic()
    plan = hashlib.sha256(repr((REGIONS, SHARES, YIELDING, BREAK_TERMS, RTOL)).encode()).hexdigest()
    folder = folder / f"{solver_hash()[:8]}-{plan[:8]}"
    folder.mkdir(parents=True, exist_ok=True)
    with ProcessPoolExecutor(workers) as pool:
        coarse = [(number, i) for number in range(len(REGIONS)) for i in range(COARSE_NODES[0])]
        values = _run("ends of segments", pool, partial(_kept_coarse, folder), coarse)
        count = COARSE_NODES[0]
        breaks = tuple(break_polynomials(np.stack(values[n * count : (n + 1) * count])) for n in range(len(REGIONS)))
        pieces = list(tasks_of_pieces())
        tasks = [(*piece, k) for piece in pieces for k in range(REGIONS[piece[0]].nodes[0])]
        lines = dict(zip(tasks, _run("lines", pool, partial(_kept_line, folder, breaks), tasks), strict=True))
    film = kept(folder, f"film_{FILM_PIECES}_{FILM_NODES}", film_coefficients)
    blocks: list[Array] = []
    for piece in pieces:
        blocks += piece_blocks(piece[0], [lines[*piece, k] for k in range(REGIONS[piece[0]].nodes[0])])
    about = {
        "version": version("stribeck"),
        "solver_hash": solver_hash(),
        "states": int(sum(result.shape[0] * result.shape[1] for result in lines.values())),
        "rtol": RTOL,
        "functions": list(TABULATED),
        "unit": STEP,
    }
    target.parent.mkdir(exist_ok=True)
    np.savez_compressed(target, **pack(breaks, blocks, film, about))
    print(f"{target.name}: {target.stat().st_size / 1e6:.2f} MB, {about['states']} states, {time.monotonic() - begun:.0f} s")


def main() -> None:
    """Build the table from the command line."""
    parser = argparse.ArgumentParser(description="Make the table of stribeck.atlas from solved states.")
    parser.add_argument("--target", type=Path, default=Path(__file__).parents[1] / "atlas" / FILE, help="the file to write")
    parser.add_argument("--folder", type=Path, default=Path("build") / "atlas", help="where finished lines are kept")
    parser.add_argument("--workers", type=int, default=2, help="processes")
    arguments = parser.parse_args()
    build(arguments.target, arguments.folder, arguments.workers)


if __name__ == "__main__":
    main()
