"""Peers, side by side: error and time of our solver, of a textbook one and of two packages for dry contact, in one run.

Usage::

    pip install tamaas ContactMechanics     # optional: without them their rows say so
    python benchmarks/peers.py [--out benchmarks/peers.md] [--quick]

Prints the page that ``benchmarks/peers.md`` holds.  Errors of lubricated states are differences from our solver at
``rtol=1e-9``, errors of the dry contact those from Hertz.  A time is that of the processor for one thread, the best of several
runs; a ratio is to ours for the same state.  Runs for about a minute.
"""

from __future__ import annotations

import argparse
import importlib.metadata
import math
import os
import platform
import statistics
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import textbook
from scipy.integrate import trapezoid
from threadpoolctl import threadpool_limits

import stribeck as sb
from stribeck.asymptotics.constants import FILM_CONSTANT

SPEEDS = (1e-2, 1e-4, 1e-6)
MIXED = sb.Groups(speed=1e-4, load=0.1, roughness=1e-4)
AT_REST = sb.Groups(speed=0.0, load=0.01, roughness=1e-8)
DEFINITION = "published"
"""The definition of friction that is compared: the one which the textbook solver integrates."""
CURVE = (1e-2, 1e-5)
RUNS = 5
PERIODIC = ((16.0, 1024), (64.0, 4096), (256.0, 16384))
"""Periods [a] and nodes of the packages for dry contact."""

OURS = "stribeck, `rtol=1e-6`"


@dataclass(frozen=True)
class Amount:
    """How much is computed: runs of which the best counts, nodes of the textbook grids, points of the curve."""

    runs: int = RUNS
    nodes: int = 401
    finer: tuple[int, ...] = (201, 401, 801)
    points: int = 101

    @property
    def speeds(self) -> np.ndarray:
        """Return the speeds of the curve."""
        return np.geomspace(*CURVE, self.points)


QUICK = Amount(runs=1, nodes=201, finer=(201,), points=11)
"""Enough to see that all tables come out, and not for their numbers."""

GRIDS: dict[str, Callable[[int, float], dict[str, Any]]] = {
    "uniform grid": lambda nodes, speed: {"x": textbook.grid(nodes)},
    "uniform grid, upstream": lambda nodes, speed: {"x": textbook.grid(nodes), "upstream": 1.0},
    "graded grid": lambda nodes, speed: {"x": textbook.grid(nodes, 4.0, speed**0.4)},
}
"""The textbook solver: on [-3, 3], and on [-4, 4] refined to the width of the edge layers."""


@dataclass(frozen=True)
class Smooth:
    """A smooth film: h(0)/lambda**(3/5), or none where the method does not get to its speed, and the time of a cold solve."""

    film: float | None
    seconds: float
    reached: float
    stated: float | None = None


@dataclass(frozen=True)
class Mixed:
    """A mixed state for boundary_friction = beta = 1, printed friction."""

    contact_share: float
    viscous: float
    seconds: float
    stated: float | None = None

    @property
    def friction(self) -> float:
        """Return the friction coefficient."""
        return self.contact_share + self.viscous


@dataclass(frozen=True)
class Dry:
    """A dry contact: pressure in the middle, half-width by its second moment, and the time of a solve."""

    method: str
    pressure: float
    half_width: float
    seconds: float


def best(function: Callable[[], Any], runs: int = RUNS) -> tuple[float, Any]:
    """Return the shortest processor time of several calls, and the result."""
    times = []
    for _ in range(runs):
        start = time.process_time()
        result = function()
        times.append(time.process_time() - start)
    return min(times), result


# --- lubricated states ---


def our_film(speed: float, rtol: float, runs: int) -> Smooth:
    seconds, state = best(lambda: sb.solve(sb.Groups(speed, 0.1, 0.0), rtol=rtol), runs)
    return Smooth(state.central_gap / speed**0.6, seconds, speed, state.errors["central_gap"])


def textbook_film(name: str, nodes: int, speed: float, runs: int = RUNS) -> Smooth:
    options = GRIDS[name](nodes, speed)
    seconds, (h, _, reached) = best(lambda: textbook.solve(speed=speed, **options), runs)
    film = float(np.interp(0, options["x"], h)) / speed**0.6 if reached == speed else None
    return Smooth(film, seconds, reached)


def our_mixed(rtol: float, runs: int) -> Mixed:
    seconds, state = best(lambda: sb.solve(MIXED, rtol=rtol), runs)
    return Mixed(state.contact_load_share, state.friction(definition=DEFINITION).fluid, seconds, state.error_estimate)


def textbook_mixed(name: str, nodes: int, runs: int = RUNS) -> Mixed:
    speed, load, kappa = float(MIXED.speed), float(MIXED.load), float(MIXED.relative_roughness)
    options = GRIDS[name](nodes, speed)
    seconds, (h, y, reached) = best(lambda: textbook.solve(speed=speed, load=load, kappa=kappa, **options), runs)
    assert reached == speed
    x, excess = options["x"], (h - y[-1]) / h
    share = contact_share(x, h)
    viscous = trapezoid((1 - 3 * excess + 3 * excess * x**2 / h) / h, x) * 2 * math.sqrt(load) * speed / (3 * math.pi)
    return Mixed(share, float(viscous), seconds)


def contact_share(x: np.ndarray, h: np.ndarray) -> float:
    """Return the part of the load that asperities carry on a curve of the mixed state."""
    load, kappa = float(MIXED.load), float(MIXED.relative_roughness)
    return float(trapezoid(np.exp(-h / kappa), x)) * 2 / (math.pi * math.sqrt(load))


def our_curve(rtol: float, amount: Amount) -> tuple[float, np.ndarray]:
    """Return the time of a curve and its contact shares."""
    wanted = {"load": MIXED.load, "roughness": MIXED.roughness, "speed": CURVE[::-1], "points": amount.points}
    seconds, curve = best(lambda: sb.stribeck_curve(**wanted, rtol=rtol), amount.runs)
    assert curve.outcome.ok
    return seconds, np.array([state.contact_load_share for state in curve.solutions[::-1]])


def textbook_curve(name: str, amount: Amount) -> tuple[float, np.ndarray]:
    """Return the same of the textbook solver, each state started from the last, on one grid."""
    rest = {"load": float(MIXED.load), "kappa": float(MIXED.relative_roughness)}
    x = GRIDS[name](amount.nodes, CURVE[-1])["x"]

    def march() -> list[float]:
        B, shares = textbook.gap_matrix(x), []
        _, y, reached = textbook.solve(x, CURVE[0], **rest)
        assert reached == CURVE[0]
        for speed in amount.speeds:
            y = textbook.newton(x, B, y, speed, upstream=0.5, tol=1e-6, **rest)
            shares.append(contact_share(x, x**2 / 2 + B @ y))
        return shares

    seconds, shares = best(march, min(3, amount.runs))
    return seconds, np.array(shares)


# --- the dry contact of Hertz, in units where E* = 2, R = 1 and a = p_Hz = 1 ---


def dry(method: str, seconds: float, x: np.ndarray, load: np.ndarray, pressure: float) -> Dry:
    """Return what the nodal loads give: the second moment of Hertz's pressure is a**2/4 of its load."""
    return Dry(method, pressure, 2 * math.sqrt(float(load @ x**2) / float(load.sum())), seconds)


def our_dry(runs: int = RUNS) -> Iterator[Dry]:
    seconds, state = best(lambda: sb.solve(AT_REST), runs)
    mesh, middle = state.mesh, state.profile([0.0]).pressure[0]
    yield dry(
        "stribeck, at rest, relative roughness 1e-6", seconds, mesh.nodes, mesh.weights * state.nodal_pressures()[0], middle
    )
    seconds, _ = best(lambda: sb.solve(sb.Groups(0.0, 0.01, 0.0)), runs)
    yield Dry("stribeck, smooth: the closed form", 1.0, 1.0, seconds)


def tamaas_dry(runs: int) -> Iterator[Dry]:
    import tamaas  # noqa: PLC0415

    tamaas.set_log_level(tamaas.LogLevel.warning)

    def solve(period: float, nodes: int, x: np.ndarray) -> np.ndarray:
        model = tamaas.ModelFactory.createModel(tamaas.model_type.basic_1d, [period], [nodes])
        model.E, model.nu = 2.0, 0.0
        tamaas.PolonskyKeerRey(model, -(x**2) / 2, 1e-12).solve(math.pi / 2 / period)
        return np.array(model.traction).ravel()

    yield from periodic("tamaas", solve, runs)


def contact_mechanics_dry(runs: int) -> Iterator[Dry]:
    from ContactMechanics import PeriodicFFTElasticHalfSpace, make_system  # noqa: PLC0415
    from SurfaceTopography import UniformLineScan  # noqa: PLC0415

    def solve(period: float, nodes: int, x: np.ndarray) -> np.ndarray:
        surface = UniformLineScan(-(x**2) / 2, period, periodic=True)
        system = make_system(substrate=PeriodicFFTElasticHalfSpace((nodes,), 2.0, (period,)), surface=surface)
        assert system.minimize_proxy(external_force=math.pi / 2, pentol=1e-9, maxiter=10_000).success
        return -np.asarray(system.force).ravel() * nodes / period

    yield from periodic("ContactMechanics", solve, runs)


def periodic(name: str, solve: Callable[[float, int, np.ndarray], np.ndarray], runs: int) -> Iterator[Dry]:
    """Yield the states of a package that solves periodic contacts only."""
    for period, nodes in PERIODIC:
        x = (np.arange(nodes) - nodes // 2) * period / nodes
        seconds, pressure = best(lambda period=period, nodes=nodes, x=x: solve(period, nodes, x), runs)
        pressure = pressure * np.sign(pressure.sum())
        yield dry(f"{name}, period {period:g} a, {nodes} nodes", seconds, x, pressure, float(pressure[nodes // 2]))


PEERS = {"tamaas": tamaas_dry, "ContactMechanics": contact_mechanics_dry}


def peer_states(name: str, runs: int = RUNS) -> list[Dry] | str:
    """Return the states of a peer, or the sentence that says how to install it."""
    try:
        return list(PEERS[name](runs))
    except ImportError:
        return f"{name} is not installed: `pip install {name}`"


# --- the page ---


def head() -> str:
    """Return machine and versions."""
    names = ["stribeck", "numpy", "scipy", *PEERS]
    found = []
    for name in names:
        try:
            found.append(f"{name} {importlib.metadata.version(name)}")
        except importlib.metadata.PackageNotFoundError:
            found.append(f"{name} not installed")
    return (
        f"Made by `python benchmarks/peers.py --out benchmarks/peers.md` on {platform.system()}\n"
        f"{platform.machine()}, one thread of {os.cpu_count()} cores; Python {platform.python_version()}, {', '.join(found)}."
    )


def short(number: float) -> str:
    """Return a number with one digit, 1e-6 rather than 1e-06."""
    return f"{number:.0e}".replace("e-0", "e-").replace("e+0", "e+")


def error(value: float | None, truth: float, stated: float = 0.0, digits: int = 1) -> str:
    """Return a relative error; below what the reference states of itself, that."""
    if value is None:
        return "none"
    relative = value / truth - 1
    if abs(relative) < stated:
        return f"< {short(stated)}"
    return (f"{relative:+.{digits}e}" if digits else f"{abs(relative):.0e}").replace("e-0", "e-")


def timing(state: Smooth | Mixed, our: Smooth | Mixed) -> str:
    return f"{1e3 * state.seconds:.0f} ({state.seconds / our.seconds:.1f})"


def summary(ours: dict, theirs: dict, dry_states: dict) -> Iterator[str]:
    """Yield the short table, which the README shows too."""
    films, mixed, reference, true_mixed = ours["films"], ours["mixed"], ours["reference"], ours["true mixed"]
    errors = "film thickness, worst of three speeds", "load on the asperities", "half-width of a dry contact"
    yield f"| relative error of | {' | '.join(errors)} | time for one state | time for a state of a curve |"
    yield "|" + "---|" * (len(errors) + 3)
    rest = dry_states["stribeck"][0]
    rows = {OURS: (films, mixed)}
    rows |= {f"textbook solver, {name}": theirs[name] for name in ("uniform grid", "graded grid")}
    for name, (found, state) in rows.items():
        reached = [(f, t, our) for f, t, our in zip(found, reference, films, strict=True) if f.film is not None]
        worst = short(max(abs(f.film / t.film - 1) for f, t, _ in reached))
        cells = [worst + ", the slowest not reached" * (len(reached) < len(found))]
        cells.append(error(state.contact_share, true_mixed.contact_share, true_mixed.stated, 0))
        cells.append(short(abs(rest.half_width - 1)) if found is films else "")
        ratio = statistics.median(a.seconds / b.seconds for a, b in [*((f, our) for f, _, our in reached), (state, mixed)])
        cells += [f"{ratio:.1f}", f"{ours['curves'][name][0] / ours['curves'][OURS][0]:.1f}"]
        yield f"| {name} | {' | '.join(cells)} |".replace("|  |", "| |")
    for name in PEERS:
        states = dry_states[name]
        if isinstance(states, str):
            yield f"| {name} | | | not installed | | |"
        else:
            last = states[-1]
            yield f"| {name}, dry only | | | {short(abs(last.half_width - 1))} | {last.seconds / rest.seconds:.1f} | |"


def film_table(ours: dict, theirs: dict) -> Iterator[str]:
    yield "| | " + " | ".join(f"speed {short(speed)} | error | ms (over ours)" for speed in SPEEDS) + " |"
    yield "|---|" + "---:|---:|---:|" * len(SPEEDS)
    rows = {OURS: ours["films"], "stribeck, `rtol=1e-9`": ours["reference"]}
    rows |= {f"textbook solver, {name}": found for name, (found, _) in theirs.items()}
    for name, found in rows.items():
        cells = []
        for state, our, truth in zip(found, ours["films"], ours["reference"], strict=True):
            film = f"stops at {short(state.reached)}" if state.film is None else f"{state.film:.{8 if state.stated else 4}f}"
            cells += [film, "" if state is truth else error(state.film, truth.film, truth.stated)]
            cells[-1] = f"{cells[-1]} (states {short(state.stated)})".strip() if state.stated else cells[-1]
            cells.append(timing(state, our))
        yield f"| {name} | {' | '.join(cells)} |"


def mixed_table(ours: dict, theirs: dict) -> Iterator[str]:
    truth, our = ours["true mixed"], ours["mixed"]
    yield "| | friction | error | contact share | error | viscous friction | error | ms (over ours) |"
    yield "|---|---:|---:|---:|---:|---:|---:|---:|"
    rows = {OURS: our, "stribeck, `rtol=1e-9`": truth}
    rows |= {f"textbook solver, {name}": state for name, (_, state) in theirs.items()}
    for name, state in rows.items():
        cells = []
        for key in ("friction", "contact_share", "viscous"):
            value, true = getattr(state, key), getattr(truth, key)
            cells += [f"{value:.{8 if state.stated else 5}f}", "" if state is truth else error(value, true, truth.stated)]
            cells[-1] = f"{cells[-1]} (states {short(state.stated)})".strip() if state.stated else cells[-1]
        yield f"| {name} | {' | '.join(cells)} | {timing(state, our)} |"


def curve_table(ours: dict, points: int) -> Iterator[str]:
    yield "| | largest absolute error of the contact share | ms a state | over ours |"
    yield "|---|---:|---:|---:|"
    truth, our = ours["true curve"][1], ours["curves"][OURS][0]
    for name, (seconds, shares) in ours["curves"].items():
        cells = [short(float(np.abs(shares - truth).max())), f"{1e3 * seconds / points:.1f}", f"{seconds / our:.1f}"]
        yield f"| {name} | {' | '.join(cells)} |"


def nodes_table(ours: dict, sizes: tuple[int, ...]) -> Iterator[str]:
    columns = [f"film, {short(speed)}" for speed in SPEEDS] + ["mixed: share", "mixed: viscous", "mixed: ms"]
    yield "| grid | N | " + " | ".join(columns) + " |"
    yield "|---|---:|" + "---:|" * len(columns)
    true_mixed = ours["true mixed"]
    for name in GRIDS:
        for nodes in sizes:
            cells = []
            for speed, true in zip(SPEEDS, ours["reference"], strict=True):
                state = textbook_film(name, nodes, speed, runs=1)
                cells.append(error(state.film, true.film) if state.film else f"stops at {short(state.reached)}")
            mixed = textbook_mixed(name, nodes, runs=2)
            cells += [error(mixed.contact_share, true_mixed.contact_share), error(mixed.viscous, true_mixed.viscous)]
            yield f"| {name} | {nodes} | {' | '.join(cells)} | {1e3 * mixed.seconds:.0f} |"


def dry_table(dry_states: dict) -> Iterator[str]:
    yield "| | pressure in the middle, error | half-width, error | ms | over ours |"
    yield "|---|---:|---:|---:|---:|"
    rest = dry_states["stribeck"][0]
    for states in dry_states.values():
        for s in [] if isinstance(states, str) else states:
            errors = [error(value, 1.0) if value != 1 else "exact" for value in (s.pressure, s.half_width)]
            yield f"| {s.method} | {' | '.join(errors)} | {1e3 * s.seconds:.1f} | {s.seconds / rest.seconds:.2f} |"


def document(amount: Amount) -> Iterator[str]:
    """Yield the lines of the page."""
    runs, nodes = amount.runs, amount.nodes
    ours = {
        "reference": [our_film(speed, 1e-9, runs) for speed in SPEEDS],
        "films": [our_film(speed, 1e-6, runs) for speed in SPEEDS],
        "true mixed": our_mixed(1e-9, runs),
        "mixed": our_mixed(1e-6, runs),
        "true curve": our_curve(1e-9, amount),
        "curves": {OURS: our_curve(1e-6, amount)}
        | {f"textbook solver, {name}": textbook_curve(name, amount) for name in ("uniform grid", "graded grid")},
    }
    theirs = {
        name: ([textbook_film(name, nodes, s, runs) for s in SPEEDS], textbook_mixed(name, nodes, runs)) for name in GRIDS
    }
    dry_states = {"stribeck": list(our_dry(runs))} | {name: peer_states(name, runs) for name in PEERS}
    values = {"head": head(), "constant": f"{FILM_CONSTANT:.8f}", "next": f"{FILM_CONSTANT * (1 + 0.245 * 1e-6**0.4):.5f}"}
    values["lines"] = str(len(Path(textbook.__file__).read_text().splitlines()))
    values |= {
        "runs": runs,
        "points": amount.points,
        "nodes": nodes,
        "step": f"{6 / (nodes - 1):g}",
        "width": f"{1e-6**0.4:.3f}",
    }
    values["missing"] = "".join(f"\n{states}.\n" for states in dry_states.values() if isinstance(states, str))
    tables = {
        "summary": summary(ours, theirs, dry_states),
        "films": film_table(ours, theirs),
        "mixed": mixed_table(ours, theirs),
        "curve": curve_table(ours, amount.points),
        "sizes": nodes_table(ours, amount.finer),
        "dry": dry_table(dry_states),
    }
    yield PAGE.format(**values, **{name: "\n".join(lines) for name, lines in tables.items()})


PAGE = """# Peers, side by side

{head}

{summary}
{missing}
Errors are relative, each at the same state; "<" is what the reference states of itself. The film is compared at the speeds
1e-2, 1e-4 and 1e-6. Times are in units of ours: of a state from cold, the median over the states reached, and of a state along
a curve. Neither package solves for a fluid, so that there are two comparisons: lubrication with a solver as textbooks have it,
elasticity by the dry, smooth contact.

- **Textbook solver** ([textbook.py](textbook.py), {lines} lines): finite differences for the pressure of the fluid,
  piecewise-linear pressure with the logarithm integrated exactly, Newton with `numpy.linalg.solve`, continuation in speed
  from a rigid film; N = {nodes}.
- **tamaas** (AGPL-3.0): dry contact of rough surfaces, with plasticity, friction or adhesion. It is run where it is installed,
  and is no dependency.
- **ContactMechanics** (MIT): dry and adhesive contact of measured and generated topographies.

The two packages are made for two-dimensional rough surfaces resolved point by point, which stribeck does not do at all.

## Smooth film

$h(0)/\\lambda^{{3/5}}$ of smooth surfaces; the load does not matter. Errors are differences from `rtol=1e-9`, times processor
milliseconds of a solve from cold, best of {runs}. As the speed goes to zero it tends to {constant}, from a similarity problem
solved apart; with the next term of Eq. (10) of [theory.md](../docs/theory.md#7-limits) that is {next} at speed 1e-6.

{films}

A uniform grid with central differences loses the state where inlet and outlet are as narrow as its cells: their width
$\\lambda^{{2/5}}$ is {width} at speed 1e-6, the step {step}. Upstream differences get farther, with errors of tenths, and
where theirs is smaller it is by chance. Whoever knows where the edges are, and how wide, can grade the grid to them and has
three to four digits. The textbook solver states no error; ours does, and finds the edges itself.

## Mixed state

Speed 1e-4, load 0.1, roughness 1e-4, $\\mu_0 = \\beta = 1$, friction as published.

{mixed}

On the uniform grid the error of the friction is small only because those of its two parts cancel.

## A curve

{points} speeds from 1e-2 to 1e-5 at the same load and roughness, each state started from the last; the textbook solver keeps
one grid, and its Newton iteration ends at 1e-6. The reference is the curve at `rtol=1e-9`.

{curve}

## The textbook solver as its grid is refined

{sizes}

With central differences the errors fall by about four for each doubling of N, until what the ends of the box cut off is
left (film at speed 1e-2, viscous friction on the graded grid). That another discretisation tends to our numbers is evidence
for both. Three digits from cold are cheaper at home, on a graded grid with N = 201; ours is for more of them, a stated error,
any state without a grid chosen by hand, and curves.

## Dry contact

Hertz's largest pressure and half-width are one in these units; the half-width is read off the second moment of the pressure.

{dry}

The first row differs from Hertz by its roughness: by Eqs. (7) and (8) of [theory.md](../docs/theory.md#7-limits) the
pressure is lower by 1e-6 and the half-width larger by 2e-6. Both packages solve a line contact as one of a periodic array.
Their errors are mostly those of the period, going as its inverse square, and not of their solvers, which agree with each
other; tamaas, compiled, is the fastest wherever three digits will do.
"""


def main() -> None:
    """Print the page, and write it if asked to."""
    parser = argparse.ArgumentParser(description="Error and time of our solver, a textbook one and packages for dry contact.")
    parser.add_argument("--out", type=Path, help="Markdown file to write")
    parser.add_argument("--quick", action="store_true", help="a tenth of the work, to see that the tables come out")
    given = parser.parse_args()
    out = given.out
    with threadpool_limits(1):
        text = "\n".join(document(QUICK if given.quick else Amount()))
    print(text, end="")
    if out is not None:
        out.write_text(text)


if __name__ == "__main__":
    main()
