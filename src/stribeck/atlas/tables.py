"""Which tables the atlas has, and which of them holds for given groups: one row a table."""

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from stribeck._types import Array, Flags
from stribeck.atlas.grid import (
    BALL_EXIT,
    BALL_EXPONENTIAL,
    BALL_PERSSON,
    LINE_EXIT,
    LINE_EXPONENTIAL,
    LINE_PERSSON,
    MIN_LOAD,
    MIN_SPEED,
    Grid,
)
from stribeck.atlas.table import FUNCTIONS, Table, load_table
from stribeck.contact_laws.law import AsperityLaw, is_exponential
from stribeck.contacts.groups import BASE_MODEL, Geometry, Groups, Model
from stribeck.fluids.fluid import Cavitation
from stribeck.quantities.units import InputError, checked_kind

Box = dict[str, tuple[float, float]]

# Smallest and largest groups of the first table, beside speed 0, at rest, and roughness 0, smooth
BOX: Box = {"speed": (MIN_SPEED, 1e6), "load": (MIN_LOAD, 1.0), "relative_roughness": (1e-6, 1e2)}

REFERENCE_SPECTRUM = {"h_rms": 1e-6, "q0": 1e4, "q1": 1e6, "hurst": 0.8}  # The surface of the tables of Persson's law

LAW_ATOL = 1e-4  # Largest difference of ln Phi of a law from that of its table: about so much of the friction

BOX_RTOL = 1e-12  # Relative excess over an end of a box that is rounding


@dataclass(frozen=True, eq=False)
class TableRow:
    """One table of the atlas: for which contacts it holds, between which groups, and how well."""

    name: str  # Name of the table
    geometry: Geometry  # A cylinder or a ball
    law: str  # Name of the contact law
    cavitation: Cavitation  # Cavitation of the film
    box: Box  # Smallest and largest `speed`, `load` and `relative_roughness` [-]
    error: float  # Relative error of the friction that is stated, above the largest of its certificate in docs/atlas.md
    file: str  # Name of the file
    grid: Grid  # Coordinates and blocks

    @property
    def model(self) -> Model:
        """Fluid, cavitation and solid."""
        return replace(BASE_MODEL, cavitation=self.cavitation)

    @property
    def functions(self) -> tuple[str, ...]:
        """Names of the tabulated functions."""
        return FUNCTIONS[self.geometry]

    @property
    def table(self) -> Table:
        """The table, read on first use."""
        return load_table(self.file, self.grid)

    def is_of_model(self, groups: Groups) -> bool:
        """Return whether geometry, fluid, cavitation and solid of groups are those of the table."""
        return groups.geometry == self.geometry and groups.model == self.model

    def is_of_law(self, law: AsperityLaw | None) -> bool:
        """Return whether a contact law is that of the table, of Persson's within :data:`LAW_ATOL`."""
        if self.law == "exponential":
            return is_exponential(law)
        return law is not None and law.name == self.law and _law_difference(self.file, self.grid, law) < LAW_ATOL  # type: ignore[arg-type]

    def speeds(self, groups: Groups) -> tuple[float, float]:
        """Return the smallest and largest speed of groups, of which none or all are smooth, beside zero [-]."""
        (low, high), (first, last) = self.box["speed"], self.grid.films
        return (low, high) if np.any(groups.roughness) else (max(low, first), min(high, last))

    def covers(self, groups: Groups) -> Flags:
        """Return which states lie in the box, whatever their law and model."""
        found = np.ones(groups.shape, dtype=bool)
        for name, ends in self.box.items():
            found &= within(np.asarray(getattr(groups, name)), ends, has_zero=name != "load")
        is_smooth = np.asarray(groups.roughness) == 0
        return np.asarray(found & (~is_smooth | within(np.asarray(groups.speed), self.grid.films, has_zero=True)))


def within(values: Array, ends: tuple[float, float], has_zero: bool) -> Flags:
    """Return which values lie on a side of a box, but for rounding, or are zero where it has that too."""
    low, high = ends
    found: Flags = (low * (1 - BOX_RTOL) <= values) & (values <= high * (1 + BOX_RTOL))
    return found | (values == 0) if has_zero else found


@lru_cache(maxsize=128)
def _law_difference(file: str, grid: Grid, law: AsperityLaw) -> float:
    """Return the largest difference of ln Phi between a law and that of a table."""
    separation, log_pressure = load_table(file, grid).law
    return float(np.abs(law.log_pressure(separation) - log_pressure).max())


# The tables; the first that holds answers.
TABLES = (
    TableRow("line-exponential", "line", "exponential", Cavitation.NONE, BOX, 1e-4, "atlas.npz", LINE_EXPONENTIAL),
    TableRow(
        "line-persson",
        "line",
        "persson",
        Cavitation.NONE,
        {"speed": (MIN_SPEED, 1e6), "load": (1e-2, 20.0), "relative_roughness": (1e-3, 1.0)},
        3e-3,
        "line_persson.npz",
        LINE_PERSSON,
    ),
    TableRow(
        "line-exit",
        "line",
        "exponential",
        Cavitation.EXIT,
        {"speed": (MIN_SPEED, 1e4), "load": (MIN_LOAD, 0.9), "relative_roughness": (1e-3, 10.0)},
        3e-3,
        "line_exit.npz",
        LINE_EXIT,
    ),
    TableRow(
        "ball-exponential",
        "point",
        "exponential",
        Cavitation.NONE,
        {"speed": (1e-8, 1e2), "load": (1e-7, 0.5), "relative_roughness": (5e-5, 1.0)},
        2e-3,
        "ball_exponential.npz",
        BALL_EXPONENTIAL,
    ),
    TableRow(
        "ball-persson",
        "point",
        "persson",
        Cavitation.NONE,
        {"speed": (1e-8, 1e2), "load": (1e-3, 1e4), "relative_roughness": (5e-4, 0.05)},
        2e-3,
        "ball_persson.npz",
        BALL_PERSSON,
    ),
    TableRow(
        "ball-exit",
        "point",
        "exponential",
        Cavitation.EXIT,
        {"speed": (1e-8, 10.0), "load": (1e-4, 0.5), "relative_roughness": (5e-3, 1.0)},
        3e-3,
        "ball_exit.npz",
        BALL_EXIT,
    ),
)


def for_groups(groups: Groups) -> TableRow | None:
    """Return the table that holds for the geometry, model and contact law of groups, wherever in its box they lie, or None.

    It has a name, a box and a stated error.  Smooth contacts have no law; :func:`covers` tells which states lie in the box.
    """
    checked_kind("groups", groups, Groups, "Groups(speed, load, roughness)")
    for row in TABLES:
        if row.is_of_model(groups) and (row.is_of_law(groups.law) or not np.any(groups.roughness)):
            return row
    return None


def table_for(groups: Groups) -> TableRow:
    """Return the table that holds for groups."""
    row = for_groups(groups)
    if row is not None:
        return row
    of_model = [row for row in TABLES if row.is_of_model(groups)]
    if not of_model:
        raise InputError(
            "the atlas covers a Newtonian fluid in a full film or in one that ends at ambient pressure (cavitation 'exit'), "
            "on a half-space, and these states have another model; use the solver."
        )
    laws = " and ".join(row.law for row in of_model)
    assert groups.law is not None
    if any(row.law == groups.law.name for row in of_model):
        raise InputError(
            f"the atlas covers the contact law {groups.law.name} of one shape of the spectrum, self-affine with a Hurst "
            "exponent of 0.8 over two decades, and this law is of another; use the solver."
        )
    raise InputError(
        f"of this model (cavitation = {groups.model.cavitation.value!r}) the atlas covers states of the {laws} contact law, "
        f"not of {groups.law.name}; use the solver."
    )


def covers(groups: Groups) -> Flags:
    """Return of each state whether the atlas covers it: a table for its geometry, model and contact law, with it in its box.

    The flux gap of heavy, nearly smooth contacts at rest is missing nevertheless.
    """
    row = for_groups(groups)
    if row is not None:
        return row.covers(groups)
    # Of several states those that are smooth have no law.
    smooth = for_groups(replace(groups, roughness=0.0))
    if smooth is None:
        return np.zeros(groups.shape, dtype=bool)
    return np.asarray(smooth.covers(groups) & (np.asarray(groups.roughness) == 0))


def holds_for(law: AsperityLaw | None) -> bool:
    """Return whether the first table, of cylinders in a full film, holds for rough states of a law: the exponential one."""
    return is_exponential(law)
