"""Error of the observables against the number of unknowns: prints the table that docs/convergence.md shows.

Usage::

    python benchmarks/convergence.py [--out docs/convergence.md] [--number 3]

The true error is the largest relative difference of the observables (absolute for the load shares) from a
solution on a mesh with more nodes and with panels farther out; the estimate is what a user would read.  Runs
for about ten seconds.
"""

from __future__ import annotations

import argparse
import platform
import subprocess
from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np
import scipy

import stribeck as sb
from stribeck.equations.error_estimate import FineOperators
from stribeck.equations.mesh_choice import mesh_for
from stribeck.equations.operators import Operators
from stribeck.equations.state import State, solve_state
from stribeck.numerics.panels import Mesh, MeshTooLargeError
from stribeck.quantities.outputs import NAMES
from stribeck.solver.cold_start import cold_start
from stribeck.solver.refinement import verify

STATES = {
    "mixed": (1e-5, 0.1, 1e-4),
    "hydrodynamic": (1.0, 0.1, 1e-4),
    "thin film": (1e-7, 0.1, 1e-6),
}
ORDERS = (8, 12, 16)
TOLERANCES = (1e-2, 1e-4, 1e-6, 1e-7)
NEWTON = 1e-12


def head() -> str:
    """Return the machine, the versions and the commit."""
    try:
        git = ["git", "-C", str(Path(__file__).parent), "describe", "--always", "--dirty"]
        commit = subprocess.run(git, capture_output=True, text=True, check=True).stdout.strip()
    except (OSError, subprocess.CalledProcessError):
        commit = "unknown"
    versions = f"Python {platform.python_version()}, NumPy {np.__version__}, SciPy {scipy.__version__}"
    return f"Made by `benchmarks/convergence.py` on {platform.system()} {platform.machine()}; {versions}; commit {commit}."


def observed(state: State) -> tuple[np.ndarray, float, np.ndarray]:
    """Return the observables of a state, its estimated error and what errors are relative to."""
    point = verify(state, state.groups, FineOperators(state.mesh), 1e-6)
    values = np.array([getattr(point.values, name) for name in NAMES])
    return values, point.estimate.total, point.estimate.scales[: len(NAMES)]


def exact(groups: sb.Groups) -> State:
    """Return the state on 20 nodes a panel and panels that reach 64 times as far as the solver's."""
    guess = cold_start(groups).states[-1]
    mesh = mesh_for(guess, groups, guess.equations.law, 14, 1e-5)
    guess = solve_state(groups, Operators(mesh), guess, NEWTON)
    mesh = mesh_for(guess, groups, guess.equations.law, 14, 1e-6)
    return solve_state(groups, Operators(wider(mesh, 6, 20)), guess, NEWTON)


def wider(mesh: Mesh, doublings: int, order: int) -> Mesh:
    """Return a mesh with panels added that double on both sides."""
    out = mesh.edges[-1] * 2.0 ** np.arange(1, doublings + 1)
    return Mesh(np.concatenate([-out[::-1], mesh.edges, out]), order, mesh.scale)


def cell(groups: sb.Groups, guess: State, mesh: Mesh, truth: np.ndarray) -> str:
    """Return unknowns, true and estimated error on one mesh."""
    values, estimate, scales = observed(solve_state(groups, Operators(mesh), guess, NEWTON))
    return f"{mesh.size}: {float((np.abs(values - truth) / scales).max()):.1e} ({estimate:.1e})"


def by_order(groups: sb.Groups, guess: State, truth: np.ndarray) -> list[str]:
    """Return the cells of one state on fixed panels."""
    panels = wider(mesh_for(guess, groups, guess.equations.law, 10, 1e-4), 3, 10)
    return [cell(groups, guess, panels.refined(order), truth) for order in ORDERS]


def by_tolerance(groups: sb.Groups, guess: State, truth: np.ndarray) -> list[str]:
    """Return the cells of one state on panels chosen for a tolerance."""
    found = []
    for tolerance in TOLERANCES:
        try:
            mesh = mesh_for(guess, groups, guess.equations.law, 14, tolerance, 0.1 * tolerance)
        except MeshTooLargeError:
            found.append("")
        else:
            found.append(cell(groups, guess, mesh, truth))
    return found


def table(first: str, rows: Iterable[str], columns: dict[str, list[str]]) -> Iterator[str]:
    """Yield a table with a column for each state."""
    yield f"| {first} | {' | '.join(columns)} |"
    yield f"|---:|{'---|' * len(columns)}"
    for name, *cells in zip(rows, *columns.values(), strict=True):
        yield f"| {name} | {' | '.join(cells)} |"


def document(number: int = len(STATES)) -> Iterator[str]:
    """Yield the lines of the document, with the tables of the first states."""
    yield "# Convergence"
    yield ""
    yield head()
    yield ""
    yield "A cell holds the unknowns, the error, and in brackets the error that a solution would state: the largest"
    yield "relative one of load shares (absolute), central and minimum gap, flux gap, offset and both frictions."
    chosen = {name: sb.Groups(*numbers) for name, numbers in list(STATES.items())[:number]}
    guesses = {name: exact(groups) for name, groups in chosen.items()}
    truths = {name: observed(guess)[0] for name, guess in guesses.items()}
    yield ""
    for name, groups in chosen.items():
        yield f"- {name}: speed {groups.speed:g}, load {groups.load:g}, roughness {groups.roughness:g}"
    yield ""
    yield "## More nodes on the same panels"
    yield ""
    columns = {name: by_order(groups, guesses[name], truths[name]) for name, groups in chosen.items()}
    yield from table("nodes a panel", map(str, ORDERS), columns)
    yield ""
    yield "## Panels chosen for a tolerance, 14 nodes each"
    yield ""
    columns = {name: by_tolerance(groups, guesses[name], truths[name]) for name, groups in chosen.items()}
    yield from table("tolerance", (f"{each:.0e}" for each in TOLERANCES), columns)


def main() -> None:
    """Print the document, and write it if asked to."""
    parser = argparse.ArgumentParser(description="Error of the observables against the number of unknowns.")
    parser.add_argument("--out", type=Path, help="Markdown file to write")
    parser.add_argument("--number", type=int, default=len(STATES), help="states (default: all)")
    given = parser.parse_args()
    out = given.out
    text = "\n".join(document(given.number)) + "\n"
    print(text, end="")
    if out is not None:
        out.write_text(text)


if __name__ == "__main__":
    main()
