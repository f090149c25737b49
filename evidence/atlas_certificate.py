"""The errors of a table of the atlas, on states solved from cold that were not used to make it.

``make certificate`` (``python -m evidence.atlas_certificate``) prints the errors that docs/atlas.md
sums up, and draws its map.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from evidence.atlas_states import TABLED_OBSERVABLES, groups_of
from stribeck import atlas
from stribeck._types import Array
from stribeck.atlas.tables import TABLES, Box, TableRow
from stribeck.contacts.cut_off import far_film
from stribeck.contacts.friction import DEFINITIONS, Definition
from stribeck.contacts.friction_rules import RULES
from stribeck.contacts.groups import Groups
from stribeck.solver.solve import solve

# Tolerance of the reference states, as far as double precision and time allow; 1e-6 for other tables.
REFERENCE_RTOL = {"line-exponential": 1e-7, "ball-exponential": 1e-5, "ball-persson": 1e-5, "ball-exit": 1e-4}

MIN_CONTACT_SHARE = 1e-9  # Contact share above which its relative error counts; a smaller part of the load affects nothing.

MIN_FLUID_SHARE = 1e-3  # Fluid share above which the solver, which bounds its absolute error, is a reference.

OFFSET_FLOOR = 1.0  # Offset below which its error is absolute, as the offset crosses zero.

MIN_MIXED_SHARE = 0.01  # Smaller load share of states in mixed lubrication, which are judged apart as well.

DRAWS_PER_MIXED_STATE = 20  # States drawn for each one in mixed lubrication; about one in nine is.

# Coefficients of the contact law, of whole balls such that a/R is below 0.3, at friction coefficient 1 of the dry contact; 1
# and 0.01 for cylinders.  The viscous friction itself is judged at the first.
BETAS: dict[str, tuple[float, float]] = {
    "ball-exponential": (0.1, 0.01),
    "ball-persson": (0.02, 0.002),
    "ball-exit": (0.1, 0.01),
}


def betas(row: TableRow) -> tuple[float, float]:
    """Return the coefficients of the contact law that a table is judged at."""
    return BETAS.get(row.name, (1.0, 0.01))


def films_of(row: TableRow) -> tuple[str, ...]:
    """Return the names of the gaps in a table."""
    return tuple(name for name in ("central_gap", "minimum_gap", "flux_gap") if name in row.functions)


def quantities(row: TableRow) -> tuple[str, ...]:
    """Return the quantities of a table that are judged, in the order of the errors."""
    kinds = DEFINITIONS[::-1]
    frictions = (f"friction, {definition}, beta = {beta:g}" for beta in betas(row) for definition in kinds)
    viscous = (f"viscous friction, {definition}" for definition in kinds)
    return (*frictions, *viscous, *films_of(row), "offset", "contact load share", "fluid load share")


FRICTION_COUNT = 4  # Number of frictions that are judged first.


@dataclass(frozen=True, eq=False)
class Certificate:
    """Errors of a table on random states."""

    row: TableRow  # The table
    speed: Array  # The states
    load: Array  # The states
    relative_roughness: Array  # The states
    contact_share: Array  # Solved load share of the asperities
    errors: Array  # Relative errors; nan where a load share is too small to count

    @property
    def box(self) -> Box:
        """The box of the table."""
        return self.row.box

    @property
    def friction(self) -> Array:
        """Largest error of all frictions on each state."""
        return np.asarray(self.errors[:, :FRICTION_COUNT].max(axis=1))

    @property
    def film(self) -> Array:
        """Largest error of the gaps on each state."""
        return np.asarray(self.errors[:, [quantities(self.row).index(name) for name in films_of(self.row)]].max(axis=1))


def random_states(row: TableRow, states: int, seed: int, mixed: bool = False) -> tuple[Array, Array, Array]:
    """Return speeds, loads and relative roughnesses, evenly distributed in their logarithms over the box of a table.

    Where ``mixed``, only states on which by the table fluid and asperities both carry at least :data:`MIN_MIXED_SHARE`.
    """
    rng = np.random.default_rng(seed)
    drawn = DRAWS_PER_MIXED_STATE * states if mixed else states
    speed, load, kappa = (np.exp(rng.uniform(np.log(ends[0]), np.log(ends[1]), drawn)) for ends in row.box.values())
    if mixed:
        share = np.asarray(atlas.contact_load_share(states_of(row, speed, load, kappa)))
        kept = np.nonzero((share > MIN_MIXED_SHARE) & (share < 1 - MIN_MIXED_SHARE))[0][:states]
        speed, load, kappa = speed[kept], load[kept], kappa[kept]
    return speed, load, kappa


def states_of(row: TableRow, speed: Array, load: Array, kappa: Array) -> Groups:
    """Return the groups of many states of a table."""
    like = groups_of(row, 1.0, 1.0, 1.0)
    return Groups(speed, load, kappa * load**like.scaling.roughness_exponent, **like.physics)


def solved(name: str, state: tuple[float, float, float]) -> Array:
    """Return the observables in tables at a speed, load and relative roughness, solved from cold."""
    row = next(row for row in TABLES if row.name == name)
    found = solve(groups_of(row, *state), rtol=REFERENCE_RTOL.get(name, 1e-6), on_failure="return").observables
    return np.array([getattr(found, observable) for observable in TABLED_OBSERVABLES[row.geometry]])


def certify(states: int, seed: int, workers: int = 1, mixed: bool = False, row: TableRow = TABLES[0]) -> Certificate:
    """Solve random states and compare a table with them, see :func:`random_states`."""
    drawn, work = random_states(row, states, seed, mixed), partial(solved, row.name)
    if workers > 1:
        with ProcessPoolExecutor(workers) as pool:
            chunk = max(1, min(20, states // 50))
            observed = _reported(pool.map(work, zip(*drawn, strict=True), chunksize=chunk), drawn[0].size)
    else:
        observed = np.array([work(state) for state in zip(*drawn, strict=True)])
    return compare(*drawn, observed, row)


def _reported(results: Iterable[Array], count: int) -> Array:
    """Return results as rows, with a line of progress on the error stream."""
    found = []
    for result in results:
        found.append(result)
        print(f"\r{len(found)} of {count}", end="\n" if len(found) == count else "", file=sys.stderr, flush=True)
    return np.array(found)


def compare(speed: Array, load: Array, kappa: Array, observed: Array, row: TableRow = TABLES[0]) -> Certificate:
    """Return the errors of a table on solved states."""
    groups, rule = states_of(row, speed, load, kappa), RULES[row.geometry]
    solved_values = dict(zip(TABLED_OBSERVABLES[row.geometry], observed.T, strict=True))
    contact, fluid, offset = (solved_values[name] for name in ("contact_load_share", "fluid_load_share", "offset"))

    usual, film = rule.of_contact(None), far_film(row.model)

    def terms(beta: float, definition: Definition) -> tuple[Any, Any, Any]:
        """Return contact share and viscous friction by the table, and the viscous friction that was solved."""
        inputs = {**usual, "beta": beta}
        parts = {name: solved_values[name] for name in rule.parts(definition)}
        share, viscous = atlas.friction_terms(groups, inputs, definition)
        return share, viscous, rule.viscous(parts, speed, load, {**inputs, "far": film}, definition)

    kinds = DEFINITIONS[::-1]
    all_terms = [terms(beta, definition) for beta in betas(row) for definition in kinds]
    found = [(share + viscous) / (contact + right) for share, viscous, right in all_terms]
    found += [viscous / right for _, viscous, right in all_terms[: len(kinds)]]
    found += [np.asarray(getattr(atlas, name)(groups)) / solved_values[name] for name in films_of(row)]
    found += [1 + (atlas.offset(groups) - offset) / np.maximum(np.abs(offset), OFFSET_FLOOR)]
    contact_counts = np.where(contact > MIN_CONTACT_SHARE, contact, np.nan)
    fluid_counts = np.where(fluid > MIN_FLUID_SHARE, fluid, np.nan)
    found += [atlas.contact_load_share(groups) / contact_counts, atlas.fluid_load_share(groups) / fluid_counts]
    return Certificate(row, speed, load, kappa, contact, np.abs(np.stack(found, axis=1) - 1))


def table(certificate: Certificate) -> str:
    """Return the errors as a table, with the state where each is worst."""
    lines = ["| relative error | median | 99 % within | worst | where: speed, load, kappa |", "|---|---|---|---|---|"]
    for name, errors in zip(quantities(certificate.row), certificate.errors.T, strict=True):
        worst = int(np.nanargmax(errors))
        where = ", ".join(f"{getattr(certificate, axis)[worst]:.2g}" for axis in certificate.box)
        numbers = f"{np.nanmedian(errors):.1e} | {np.nanquantile(errors, 0.99):.1e} | {errors[worst]:.1e}"
        lines.append(f"| {name.replace('_', ' ')} | {numbers} | {where} |")
    return "\n".join(lines)


def draw(certificate: Certificate, path: Path) -> None:
    """Draw the worst errors of friction and film over speed and relative roughness, and over load and relative roughness."""
    from matplotlib.colors import LogNorm
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9, 7), layout="constrained")
    panels = figure.subplots(2, 2, sharey=True)
    kappa = np.log10(certificate.relative_roughness)
    for row, (name, errors) in zip(panels, (("friction", certificate.friction), ("film", certificate.film)), strict=True):
        for axes, across in zip(row, ("speed", "load"), strict=True):
            x = np.log10(getattr(certificate, across))
            bins = [np.log10(np.geomspace(*certificate.box[side], 25)) for side in (across, "relative_roughness")]
            place = tuple(np.clip(np.digitize(v, b) - 1, 0, 23) for v, b in zip((x, kappa), bins, strict=True))
            worst = np.zeros((24, 24))
            np.maximum.at(worst, place, np.maximum(errors, 1e-16))
            shown = np.where(worst > 0, worst, np.nan).T
            image = axes.pcolormesh(*(10**b for b in bins), shown, norm=LogNorm(1e-8, 1e-4), cmap="viridis")
            axes.set(xscale="log", yscale="log", xlabel=across, title=f"{name}: worst relative error")
    for row in panels:
        row[0].set_ylabel("relative roughness")
    figure.colorbar(image, ax=panels, extend="both")
    figure.savefig(path, dpi=110)


def main() -> None:
    """Print the tables and draw the map."""
    rows = {row.name: row for row in TABLES}
    parser = argparse.ArgumentParser(description="Compare a table of the atlas with random states solved from cold.")
    parser.add_argument("name", nargs="?", default=TABLES[0].name, choices=list(rows))
    parser.add_argument("--states", type=int, help="5000 for the first table, 500 for others, whose states take longer")
    parser.add_argument("--seed", type=int, default=271828)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--map", type=Path, help="a picture of the worst errors, as docs/images/atlas_error.png")
    arguments = parser.parse_args()
    if arguments.states is None:
        arguments.states = 5000 if arguments.name == TABLES[0].name else 500
    certificate = certify(arguments.states, arguments.seed, arguments.workers, row=rows[arguments.name])
    print(f"{arguments.states} states\n\n{table(certificate)}", flush=True)
    mixed = certify(arguments.states, arguments.seed + 1, arguments.workers, True, rows[arguments.name])
    print(f"\n{arguments.states} states, both load shares above {MIN_MIXED_SHARE:.0%}\n\n{table(mixed)}")
    if arguments.map is not None:
        draw(certificate, arguments.map)


if __name__ == "__main__":
    main()
