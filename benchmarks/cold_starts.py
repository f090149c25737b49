"""Random cold starts: how many are solved, whether the estimate covers the error, and what a start costs.

Usage::

    python benchmarks/cold_starts.py [--number 200] [--seed 20261121]

Groups are drawn evenly in the logarithm from speed 1e-12 to 1e6, load 1e-8 to 10, relative roughness 1e-6 to
1e3; one in twelve has speed zero, one in twelve roughness zero. The true error is that against a mesh with six
more nodes on each panel and panels that reach 32 times as far. Runs for about two minutes; prints the table that
docs/numerics_tables.md shows.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Iterator

import numpy as np

import stribeck as sb
from stribeck.contacts.groups import contact_law
from stribeck.equations.line import Equations
from stribeck.equations.observables import DRAG_ROWS, ROW, drag_scales, observables
from stribeck.equations.operators import Operators
from stribeck.fluids.newtonian import flux_gap
from stribeck.numerics.newton import StepControl, root_find
from stribeck.numerics.panels import Mesh


def draw(number: int, seed: int) -> list[sb.Groups]:
    """Return random groups."""
    rng = np.random.default_rng(seed)
    states = []
    for i in range(number):
        speed, load, kappa = 10 ** rng.uniform((-12, -8, -6), (6, 1, 3))
        speed, kappa = (0.0 if i % 12 == 5 else speed), (0.0 if i % 12 == 9 else kappa)
        states.append(sb.Groups(speed, load, kappa * load))
    return states


def true_error(s: sb.results.Solution) -> float:
    """Return the largest relative error of the observables against a finer and wider mesh."""
    g, coarse = s.groups, s.mesh
    out = coarse.edges[-1] * 2.0 ** np.arange(1, 6)
    mesh = Mesh(np.concatenate([-out[::-1], coarse.edges, out]), coarse.order + 6, coarse.scale)
    light = min(g.load, 1e-2) if g.speed == 0 else g.load  # as the solver does, see "Contact at rest"
    shift = -0.5 * g.relative_roughness * np.log(g.load / light)
    base = sb.Groups(g.speed, light, light * g.relative_roughness)
    gap = np.maximum(s.profile(mesh.nodes).gap - shift, 1e-3 * s.nodal_gap.min())
    flux = flux_gap(gap, mesh.weights)
    equations = Equations(Operators(mesh), base.speed, contact_law(base), flux**2)
    y = np.concatenate([gap, [s.offset - shift, flux]])
    root = root_find(equations, y, StepControl(1e-12))
    found = observables(equations, root.x, light)
    exact = found.array()
    gaps = [ROW["central_gap"], ROW["minimum_gap"]]
    exact[[*gaps, ROW["offset"]]] += shift
    if shift:
        gap = root.x[equations.layout.gap] + shift
        exact[ROW["flux_gap"]] = flux_gap(gap, mesh.weights) if gap.min() > 0 else np.nan
    scales = np.abs(exact)
    scales[[ROW["contact_load_share"], ROW["fluid_load_share"]]] = 1.0
    scales[ROW["offset"]] = max(scales[ROW["offset"]], scales[ROW["central_gap"]])
    if g.speed == 0:
        scales[gaps] = np.maximum(scales[gaps], 1e-3 * g.relative_roughness)
    scales[DRAG_ROWS] = drag_scales(exact[None])[0]  # what cancels is right to the parts, as states say of themselves
    scales[scales == 0] = 1.0
    values = s.observables.array()
    return float(np.nanmax(np.abs(values - exact) / scales))


def coverage(states: list[sb.Groups], rtol: float) -> str:
    """Return the row for one tolerance."""
    ratios, times, outcomes = [], [], []
    for groups in states:
        start = time.perf_counter()
        s = sb.solve(groups, rtol=rtol, on_failure="return")
        times.append(time.perf_counter() - start)
        outcomes.append(s.outcome.name)
        ratios.append(true_error(s) / s.error_estimate)
    covered = np.mean(np.array(ratios) <= 1)
    return (
        f"| {rtol:.0e} | {outcomes.count('CONVERGED')} | {outcomes.count('ROUNDING')} "
        f"| {len(states) - outcomes.count('CONVERGED') - outcomes.count('ROUNDING')} | {covered:.1%} "
        f"| {max(ratios):.1f} | {1e3 * np.median(times):.0f} | {1e3 * max(times):.0f} |"
    )


def document(number: int, seed: int) -> Iterator[str]:
    """Yield the rows of the table."""
    states = draw(number, seed)
    yield ("| rtol | converged | bounded by rounding | failed | error covered | largest error/estimate | ms, median | most |")
    yield "|---|---|---|---|---|---|---|---|"
    for rtol in (1e-4, 1e-6, 1e-9):
        yield coverage(states, rtol)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--number", type=int, default=200)
    parser.add_argument("--seed", type=int, default=20261121)
    arguments = parser.parse_args()
    for line in document(arguments.number, arguments.seed):
        print(line, flush=True)


if __name__ == "__main__":
    main()
