"""Random curves against states solved one by one: whether the errors that a curve states cover the true ones.

Usage::

    python benchmarks/curve_bound.py [--geometry line] [--number 50] [--speeds 2001] [--rtol 1e-6] [--seed 17] [--minutes 60]
    python benchmarks/curve_bound.py --parts [--seconds 90] [--number 50] [--speeds 11] [--rtol 1e-6] [--seed 17]

Load 1e-4 to 1 and relative roughness 1e-5 to 10, of balls 1e-6 to 0.5 and 1e-3 to 1, even in the logarithm; speeds from
boundary plateau to hydrodynamic branch.
Contact laws by turns: exponential, Persson's, Greenwood and Williamson's, Greenwood and Tripp's, a table.  The true values are
those of states solved one after the other, to 1e-9 or a tenth of a smaller tolerance; of balls each from cold, to a twentieth.
With --parts curves of the line run over half a decade to two of speed, load or roughness, with random fluids, cavities, flow
factors, layers and motions at once, as fluid_box.py draws them; the true values are those of states solved from cold, to a
hundredth.  A curve that takes more than so many seconds of processor time is judged as far as it came, and says so.
Prints one row a curve: states that it was made of, part of the speeds at which all errors are covered, the worst miss over the
stated error and the observable.
"""

from __future__ import annotations

import argparse
import signal
import time
from dataclasses import replace
from functools import cache

import fluid_box
import numpy as np

import stribeck as sb
from stribeck.contact_laws import GreenwoodTripp, GreenwoodWilliamson
from stribeck.contact_laws.law import AsperityLaw
from stribeck.contacts.groups import SCALINGS
from stribeck.contacts.with_parts import with_parts
from stribeck.equations.point.observables import OBSERVABLES
from stribeck.quantities.outputs import ABSOLUTE, ALL_NAMES, NAMES, RUPTURE_ROWS
from stribeck.solver.solve_error import SolveError

LAWS = ("exponential", "persson", "greenwood-williamson", "greenwood-tripp", "table")

OFFSET_FLOOR = 0.1
"""The error of the offset is relative to it where it exceeds this."""

BOXES = {"line": ((-4, -5), (0, 1)), "point": ((-6, -3), (np.log10(0.5), 0))}
"""Ends of the logarithms of load and relative roughness."""

UNPLACED = tuple(name for name in OBSERVABLES if name not in ("minimum_radius", "minimum_angle"))
"""Observables of a ball but for where its minimum is."""


@cache
def law_of(name: str) -> AsperityLaw | None:
    """Return a contact law; None is the exponential one."""
    if name == "persson":
        return sb.surfaces.persson_law(sb.surfaces.SelfAffine(h_rms=1e-6, q0=1e4, q1=1e9, hurst=0.8))
    if name == "table":
        s = np.linspace(0.05, 6.0, 40)
        return sb.contact_laws.TableLaw(s, np.exp(-s) + 0.3 * np.exp(-3 * s))
    return {
        "greenwood-williamson": GreenwoodWilliamson(),
        "greenwood-tripp": GreenwoodTripp(),
    }.get(name)


def draw(seed: int, number: int, geometry: str = "line") -> tuple[str, float, float]:
    """Return law, load and relative roughness of one curve; that of a number does not depend on the others."""
    load, kappa = 10 ** np.random.default_rng([seed, number]).uniform(*BOXES[geometry])
    return LAWS[number % len(LAWS)], float(load), float(kappa)


def misses(curve: sb.results.StribeckCurve, speeds: np.ndarray) -> tuple[np.ndarray, int]:
    """Return errors over what a curve states at speeds, shape (speeds, observables), and how many states were not solved."""
    fixed = curve.groups
    groups = sb.Groups(speeds, float(fixed.load[0]), float(fixed.roughness[0]), law=curve.law)
    exact = sb.solve_batch(groups, rtol=max(min(1e-9, 0.1 * curve.rtol), 1e-10))
    here = curve.at(speeds)
    found = np.empty((len(speeds), len(NAMES)))
    for i, name in enumerate(NAMES):
        true = np.asarray(getattr(exact, name))
        scale = (
            np.ones_like(true) if name in ABSOLUTE else np.maximum(np.abs(true), OFFSET_FLOOR if name == "offset" else 1e-300)
        )
        found[:, i] = np.abs(here.values[name] - true) / scale / (here.errors[name] + exact.errors[name])
    return found, int(np.isnan(found).all(axis=1).sum())


def misses_of_ball(curve: sb.results.StribeckCurve, speeds: np.ndarray) -> tuple[np.ndarray, int]:
    """Return the same for a curve of a ball."""
    here, found = curve.at(speeds), np.full((len(speeds), len(UNPLACED)), np.nan)
    scales = {name: np.array([s.state.scales[name] for s in map(curve._at, np.log(speeds))]) for name in UNPLACED}
    for i, speed in enumerate(speeds.tolist()):
        exact = sb.solve(replace(curve.solutions[0].groups, speed=speed), rtol=max(1e-8, 0.05 * curve.rtol)).state
        for j, name in enumerate(UNPLACED):
            true = exact.values[name]
            found[i, j] = abs(here.values[name][i] - true) / scales[name][i] / (here.errors[name][i] + exact.errors[name])
    return found, 0


def draw_parts(seed: int, number: int) -> tuple[sb.Groups, str, float]:
    """Return the middle of one curve with parts, what it runs over, and the factor to both ends."""
    rng = np.random.default_rng([seed, number])
    speed, load, kappa = (float(value) for value in 10 ** rng.uniform((-6, -3, -4), (-1, 0, 0)))
    groups = sb.Groups(speed, load, kappa * load, law=law_of(LAWS[number % len(LAWS)]))
    parts = fluid_box.motion_alone(rng) | (fluid_box.cavitation(rng, groups) if rng.random() < 0.7 else {})
    thins = rng.random() < 0.4
    parts["fluid"] = sb.fluids.Fluid(
        fluid_box.thinning(rng, groups)["fluid"] if thins else None,
        fluid_box.viscosity(rng) if rng.random() < 0.5 else None,
        fluid_box.density(rng) if rng.random() < 0.3 else None,
    )
    if not thins and rng.random() < 0.5:
        parts |= fluid_box.flow(rng, groups)
    if rng.random() < 0.5:
        parts |= fluid_box.layer(rng, groups)
    return with_parts(groups, **parts), str(rng.choice(["speed", "load", "roughness"])), float(10 ** rng.uniform(0.25, 1))


def judge_with_parts(seed: int, number: int, places: int, rtol: float, seconds: float) -> str:
    """Return the row of one curve with parts."""
    groups, over, factor = draw_parts(seed, number)
    middle, model = float(getattr(groups, over)), groups.model
    name = f"{model.film.name or 'newtonian'}, {model.solid.name}, {model.cavitation.value}, "
    name += f"{LAWS[number % len(LAWS)]}, over {over}"
    row = f"| {number} | {name} | {groups.load:.2g} | {groups.relative_roughness:.2g} "
    began = time.process_time()
    try:
        signal.setitimer(signal.ITIMER_PROF, seconds)
        curve = sb.stribeck_curve(groups, points=2, rtol=rtol, **{over: (middle / factor, middle * factor)})
    except (KeyboardInterrupt, SolveError) as error:
        return f"{row}| none: {type(error).__name__} | | | | |"
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
    took = f"{curve.states} in {time.process_time() - began:.1f} s" + ("" if curve.outcome.ok else f", {curve.outcome.name}")
    values = np.geomspace(*curve.values[[0, -1]], places + 2)[1:-1]
    here, found = curve.at(values), np.full((places, len(ALL_NAMES)), np.nan)
    for i, value in enumerate(values.tolist()):
        try:
            exact = sb.solve(replace(groups, **{over: value}), rtol=max(1e-10, 0.01 * rtol), on_failure="return")
        except SolveError:
            continue
        for j, each in enumerate(ALL_NAMES):
            true = float(getattr(exact.observables, each))
            least = OFFSET_FLOOR if each == "offset" else 1e-300
            scale = 1.0 if each in ABSOLUTE or each in {row.name for row in RUPTURE_ROWS} else max(abs(true), least)
            found[i, j] = abs(here.values[each][i] - true) / scale / (here.errors[each][i] + exact.errors.get(each, np.nan))
    judged = np.isfinite(found).any(axis=1)
    if not judged.any():
        return f"{row}| {took} | | | | |"
    where = np.unravel_index(np.nanargmax(found), found.shape)
    covered = np.mean(np.nanmax(found[judged], axis=1) <= 1)
    stated = float(np.nanmax(here.relative_errors))
    return f"{row}| {took} | {stated:.1e} | {covered:.4f} | {found[where]:.2g} | {ALL_NAMES[where[1]]} |"


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--geometry", choices=sorted(BOXES), default="line")
    parser.add_argument("--number", type=int, default=50)
    parser.add_argument("--speeds", type=int, default=2001)
    parser.add_argument("--rtol", type=float, default=1e-6)
    parser.add_argument("--seed", type=int, default=17)
    parser.add_argument("--minutes", type=float, default=60.0, help="no curve is begun after so long")
    parser.add_argument("--parts", action="store_true", help="random fluids, cavities, flow factors, layers and motions")
    parser.add_argument("--seconds", type=float, default=90.0, help="processor time of a curve with parts")
    arguments = parser.parse_args()
    if arguments.parts:
        signal.signal(signal.SIGPROF, signal.default_int_handler)
    print("| curve | law | load | kappa | states | largest stated | covered | worst | observable |")
    print("|---|---|---|---|---|---|---|---|---|", flush=True)
    start = time.monotonic()
    for number in range(arguments.number):
        if time.monotonic() - start > 60 * arguments.minutes:
            break
        if arguments.parts:
            settings = (arguments.speeds, arguments.rtol, arguments.seconds)
            print(judge_with_parts(arguments.seed, number, *settings), flush=True)
            continue
        name, load, kappa = draw(arguments.seed, number, arguments.geometry)
        law, of = law_of(name), arguments.geometry
        roughness = kappa * load ** SCALINGS[of].roughness_exponent
        base = sb.Groups(1.0, load, roughness, geometry=of, **({} if law is None else {"law": law}))
        curve = sb.stribeck_curve(base, points=2, rtol=arguments.rtol)
        speeds = np.geomspace(*curve.values[[0, -1]], arguments.speeds)
        speeds[[0, -1]] = curve.values[[0, -1]]
        found, lost = (misses if of == "line" else misses_of_ball)(curve, speeds)
        worst = np.nanmax(found, axis=1)
        where = np.unravel_index(np.nanargmax(found), found.shape)
        stated = float(np.nanmax(curve.at(speeds).relative_errors[:, : len(NAMES)]))
        covered = float((worst <= 1).sum() / max(1, len(speeds) - lost))
        print(
            f"| {number} | {name} | {load:.2g} | {kappa:.2g} | {curve.states} | {stated:.1e} | {covered:.4f} "
            f"| {worst[where[0]]:.2g} | {(NAMES if of == 'line' else UNPLACED)[where[1]]} |",
            flush=True,
        )


if __name__ == "__main__":
    main()
