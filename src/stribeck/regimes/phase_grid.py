"""The grid of a phase diagram: its axes from what the user gives, the tables that are filled in on it, and their dataset."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from itertools import product
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from stribeck._types import Array
from stribeck.asperity_friction.coulomb import Coulomb, as_asperity_friction
from stribeck.contact_laws.law import AsperityLaw, law_attributes
from stribeck.contact_laws.scaled import law_of
from stribeck.contacts.contact import Contact, part_attributes
from stribeck.contacts.friction import BOUNDARY_FLUID_SHARE, REGIMES, Definition, check_definition, coefficients
from stribeck.contacts.groups import Groups, Physics
from stribeck.contacts.inputs import InputTable
from stribeck.curves.coordinate import plain_numbers
from stribeck.curves.regime import Transition
from stribeck.curves.speed_range import automatic_speed_range
from stribeck.files.datasets import Column, new_dataset
from stribeck.quantities.outcome import Outcome
from stribeck.quantities.outputs import COLUMNS, GROUPS, LINE
from stribeck.quantities.units import InputError, checked_count, show
from stribeck.solver.numbers import input_attributes
from stribeck.solver.solve import as_groups, with_law

if TYPE_CHECKING:
    import xarray

AXES = ("load", "roughness", "speed")  # The dimensions of a diagram, in their order


class Kind(NamedTuple):
    """How the diagrams of one geometry are made."""

    points: Mapping[str, int]  # Points between the ends of a range, unless asked for otherwise
    density: float  # States per decade that a row has at least, so that its transitions are seen and soon located
    rtol: float  # Relative tolerance of the states of the grid, unless asked for otherwise
    has_formulas: bool  # Whether formulas give transitions, and the branch of falling friction is followed beyond its minimum


# By geometry: a state of a ball takes a tenth of a second or more.
KINDS: dict[str, Kind] = {
    "line": Kind({"load": 2, "roughness": 25, "speed": 61}, 4, 1e-4, True),
    "point": Kind({"load": 2, "roughness": 5, "speed": 13}, 1.5, 1e-3, False),
}

MOST_POINTS = 10_000


class Variable(NamedTuple):
    """A variable of a diagram that is filled in as its rows are solved."""

    label: str
    dims: tuple[str, ...] = AXES
    unit: str = "1"  # Or the axis whose unit it has
    empty: Any = np.nan  # What stands where nothing was reached


ROW = AXES[:2]  # The dimensions of what a row has one of

# Variables of a diagram, by the names that curves give to the same transitions.
MARKS = {
    "speed_at_5_percent_fluid": Transition.BOUNDARY_END,
    "speed_at_half_fluid": Transition.EQUAL_SHARES,
    "speed_at_10_percent_contact_friction": Transition.HYDRODYNAMIC_START,
}

# What is filled in, by name; all that is not reached was interrupted.
VARIABLES: dict[str, Variable] = {
    "regime": Variable(COLUMNS["regime"][1], empty=np.int8(-1)),
    **{name: Variable(COLUMNS[name][1]) for name in ("friction", "friction_error", "contact_friction_share")},
    **{name: Variable(LINE.listed[name][1]) for name in ("fluid_load_share", "central_gap", "lambda_ratio", "error_estimate")},
    "outcome": Variable(COLUMNS["outcome"][1], empty=Outcome.INTERRUPTED.name),
    **{name: Variable(f"speed at which {mark}, on solved states", ROW, "speed") for name, mark in MARKS.items()},
    "speed_at_minimum": Variable("speed of the minimum of friction, on solved states", ROW, "speed"),
    "friction_at_minimum": Variable("friction coefficient there", ROW),
    "velocity_weakening": Variable("whether friction falls with speed somewhere", ROW, empty=np.int8(-1)),
    "message": Variable("why results of the row are missing, if they are", ROW, empty=Outcome.INTERRUPTED.value),
}


@dataclass(eq=False)
class Diagram:
    """What is being filled in: a diagram's axes, settings and results."""

    contact: Contact | None  # The contact, where the axes are in SI units
    axes: dict[str, Array]  # Values of load, roughness and speed, ascending
    boundary_friction: Any  # Friction coefficient of the dry contact [-], or another friction of asperities
    beta: float  # Coefficient of the contact law [-]
    definition: Definition  # Definition of the viscous friction
    rtol: float  # Relative tolerance of the states
    physics: Physics  # Contact law, geometry and model of all states
    outcome: Outcome = Outcome.CONVERGED  # CONVERGED, or INTERRUPTED
    table: dict[str, Any] = field(init=False)
    merging: Array | None = None  # Roughness of each load at which the minimum disappears, where asked for

    def __post_init__(self) -> None:
        """Make the empty table."""
        self.table = {}
        for name, variable in VARIABLES.items():
            kind = object if isinstance(variable.empty, str) else None
            self.table[name] = np.full([len(self.axes[dim]) for dim in variable.dims], variable.empty, kind)

    def unit(self, name: str) -> str:
        """Return the unit of an axis."""
        return "1" if self.contact is None or name == "1" else self.contact.INPUTS.quantities[name].unit

    def problem(self, i: int, j: int) -> tuple[Contact | Groups, Groups, float]:
        """Return contact or groups of a row at speed 1 of its axis, the groups, and the speed group for that speed."""
        load, roughness = float(self.axes["load"][i]), float(self.axes["roughness"][j])
        if self.contact is None:
            groups = Groups(1.0, load, roughness, **self.physics)
            return groups, groups, 1.0
        row = self.contact.replace(load=load, roughness=roughness)
        groups = row.replace(speed=1.0, asperity_friction=Coulomb(1.0)).groups  # a table of stresses may not reach that speed
        return row, groups, float(groups.speed)

    @property
    def kind(self) -> Kind:
        """How the diagrams of this geometry are made."""
        return KINDS[self.physics["geometry"]]

    @property
    def coefficient(self) -> float:
        """Friction coefficient of asperities that touch on a small part of the surface [-]."""
        return as_asperity_friction(self.boundary_friction).coefficient_at_small_area(self.contact)

    def ends(self, i: int, j: int) -> tuple[float, float]:
        """Return the speeds between which a row has its transitions, in the unit of the axis."""
        _, groups, unit = self.problem(i, j)
        low, high = automatic_speed_range(groups, self.coefficient, self.beta, self.definition)
        return low / unit, high / unit


def empty_diagram(
    problem: Contact | Groups | None,
    given: dict[str, Any],
    points: int | Mapping[str, int] | None,
    boundary_friction: float | None,
    beta: float | None,
    definition: Definition,
    rtol: float | None,
    law: str | AsperityLaw | None = None,
) -> Diagram:
    """Return the empty diagram that the arguments ask for."""
    problem = problem if problem is None else with_law(problem, law)
    contact = problem if isinstance(problem, Contact) else None
    boundary_friction, beta = coefficients(contact, boundary_friction, beta)
    definition = check_definition(definition)
    groups = Groups(1.0, 1.0, 1.0, law=law_of(law)) if problem is None else as_groups(problem)[0]
    if problem is not None:
        given = {name: getattr(problem, name) if value is None and name != "speed" else value for name, value in given.items()}
    missing = [name for name in ("load", "roughness") if given[name] is None]
    if missing:
        raise InputError(f"{' and '.join(missing)} missing; give numbers or ranges, or a LineContact or PointContact.")
    physics = groups.physics
    kind, table = KINDS[physics["geometry"]], None if contact is None else contact.INPUTS
    counts, rtol = _points(points, kind), kind.rtol if rtol is None else rtol
    axes = {name: _axis(name, given[name], table, counts[name]) for name in ("load", "roughness")}
    diagram = Diagram(contact, axes | {"speed": np.ones(1)}, boundary_friction, beta, definition, rtol, physics)
    if given["speed"] is None:
        # From the lowest plateau to the highest branch of the outermost rows.
        ends = [end for i, j in product((0, -1), repeat=2) for end in diagram.ends(i, j)]
        axes["speed"] = np.geomspace(min(ends), max(ends), counts["speed"])
    else:
        axes["speed"] = _axis("speed", given["speed"], table, counts["speed"])
    return replace(diagram, axes=axes)


def _points(points: int | Mapping[str, int] | None, kind: Kind) -> dict[str, int]:
    wanted = {} if points is None else points if isinstance(points, Mapping) else dict.fromkeys(AXES, points)
    unknown = [name for name in wanted if name not in AXES]
    if unknown:
        raise InputError(f"points has the unknown name {show(unknown[0])}; it may have load, roughness and speed.")
    for name, count in wanted.items():
        checked_count(f"points of {name}", count, 2, MOST_POINTS)
    return {**kind.points, **wanted}


def _axis(name: str, value: Any, table: InputTable | None, points: int) -> Array:
    """Return the values of one axis, ascending."""
    items = [value] if isinstance(value, str) or np.ndim(value) == 0 else list(value)
    advice = "groups are plain numbers, for units give a LineContact or PointContact."
    found = plain_numbers(name, value, items, table, advice)
    lowest = "positive" if name == "load" or len(found) == 2 else "zero or positive"
    too_low = (found <= 0).any() if lowest == "positive" else (found < 0).any()
    if not len(found) or found.ndim != 1 or not np.isfinite(found).all() or too_low or (np.diff(found) <= 0).any():
        raise InputError(
            f"{name} = {show(value)}; give one number, a range (low, high), or increasing points, all finite and {lowest}."
        )
    return np.geomspace(found[0], found[1], points) if len(found) == 2 else found


# Meanings of the variables that are codes.
FLAGS = {
    "regime": {-1: "unknown", **dict(enumerate(REGIMES))},
    "velocity_weakening": {-1: "unknown", 0: "absent", 1: "present"},
    "formula_velocity_weakening": {0: "absent", 1: "present"},
}

# Transitions by formulas, with their long names.
FORMULA_SPEEDS = {
    "formula_speed_at_5_percent_fluid": f"speed at which {MARKS['speed_at_5_percent_fluid']}, by the law of load sharing",
    "formula_speed_at_half_fluid": f"speed at which {MARKS['speed_at_half_fluid']}, by the law of load sharing",
    "formula_speed_boundary_to_mixed": "speed at which the law of [BP] for low speed, corrected, gives all load to the fluid",
    "formula_speed_at_minimum": "speed of the minimum of friction by the law of mixed friction",
    "printed_speed_boundary_to_mixed": "the same as [BP] print it",
    "printed_speed_at_minimum": "the speed of the minimum as [BP] print it",
}


MERGING = "roughness at which the minimum of friction disappears"


def diagram_dataset(diagram: Diagram) -> xarray.Dataset:
    """Return a diagram with units, long names and provenance."""
    groups, speed_groups = _row_groups(diagram)
    columns: dict[str, Column] = {
        name: (each.dims, diagram.table[name], diagram.unit(each.unit), each.label) for name, each in VARIABLES.items()
    }
    columns |= _formula_columns(diagram, groups, speed_groups)
    if diagram.merging is not None:
        label = f"{MERGING}, on solved states"
        columns["roughness_without_minimum"] = ("load", diagram.merging, diagram.unit("roughness"), label)
    if diagram.contact is not None:
        columns["load_group"] = ("load", np.asarray(groups.load)[:, 0], "1", "load group")
        columns["roughness_group"] = ("roughness", np.asarray(groups.roughness)[0], "1", "roughness group")
        columns["speed_group"] = (("load", "speed"), speed_groups[:, :1] * diagram.axes["speed"], "1", "speed group")
    coords: dict[str, Column] = {}
    for name, values in diagram.axes.items():
        coords[name] = (name, values, diagram.unit(name), f"{name} group" if diagram.contact is None else name)
    complete = diagram.outcome.ok and bool((diagram.table["outcome"] == Outcome.CONVERGED.name).all())
    about = {
        "title": f"Phase diagram of a lubricated rough {groups.geometry} contact",
        "outcome": diagram.outcome.value,
        "complete": int(complete),
        "definition": diagram.definition,
        **law_attributes(groups.law),
        "rtol": diagram.rtol,
        "boundary_friction": getattr(as_asperity_friction(diagram.boundary_friction), "boundary_friction", math.nan),
        "beta": diagram.beta,
        **input_attributes(diagram.contact, *AXES),
        **part_attributes(groups, diagram.contact),
    }
    dataset = new_dataset(columns, coords, about)
    for name, meanings in FLAGS.items():
        values = np.array(sorted(meanings), dtype=np.int8)
        words = " ".join(meanings[int(value)] for value in values)
        dataset[name].attrs |= {"flag_values": values, "flag_meanings": words}
    return dataset


def _row_groups(diagram: Diagram) -> tuple[Groups, Array]:
    """Return the groups of all rows at speed 1 of the axis, and the speed groups for that speed."""
    rows, columns = (len(diagram.axes[name]) for name in AXES[:2])
    states = [[diagram.problem(i, j)[1] for j in range(columns)] for i in range(rows)]
    speed, load, roughness = (np.array([[getattr(g, name) for g in row] for row in states], dtype=float) for name in GROUPS)
    return Groups(speed, load, roughness, **states[0][0].physics), speed


def _formula_columns(diagram: Diagram, groups: Groups, unit: Array) -> dict[str, Column]:
    """Return what the formulas give, in the units of the axes; nan where they have none."""
    from stribeck.asymptotics import load_sharing, transitions

    boundary_friction, beta, loads = diagram.coefficient, diagram.beta, np.asarray(groups.load)[:, 0]
    speeds = dict.fromkeys(FORMULA_SPEEDS, np.full(unit.shape, np.nan))
    merging = np.full(len(loads), np.nan)
    if diagram.kind.has_formulas:
        holds = transitions.speed_at_minimum.holds_for(groups.law)
        with np.errstate(all="ignore"):
            shares, minimum = load_sharing.speed_at_fluid_share.function, transitions.speed_at_minimum.function
            found = {
                "formula_speed_at_5_percent_fluid": shares(groups, BOUNDARY_FLUID_SHARE),
                "formula_speed_at_half_fluid": shares(groups, 0.5),
                "formula_speed_boundary_to_mixed": transitions.speed_boundary_to_mixed.function(groups),
                "formula_speed_at_minimum": minimum(groups, boundary_friction, beta),
                "printed_speed_boundary_to_mixed": transitions.speed_boundary_to_mixed.function(groups, printed=True),
                "printed_speed_at_minimum": minimum(groups, boundary_friction, beta, printed=True),
            }
            smooth = (np.asarray(groups.roughness) == 0) | (not holds)
            speeds = {name: np.where(smooth, np.nan, np.broadcast_to(each, unit.shape) / unit) for name, each in found.items()}
        if holds:
            group = 1.0 if diagram.contact is None else float(diagram.contact.replace(roughness=1.0).groups.roughness)
            merging = np.asarray(transitions.roughness_without_minimum(loads, boundary_friction, beta)) / group
    columns: dict[str, Column] = {
        name: (ROW, speeds[name], diagram.unit("speed"), label) for name, label in FORMULA_SPEEDS.items()
    }
    weakens = np.isfinite(speeds["formula_speed_at_minimum"]).astype(np.int8)
    columns["formula_velocity_weakening"] = (ROW, weakens, "1", "whether friction falls with speed somewhere, by the formula")
    label = f"{MERGING}, by the law of mixed friction"
    return columns | {"formula_roughness_without_minimum": ("load", merging, diagram.unit("roughness"), label)}
