"""Sweep files: TOML that says what varies becomes a checked design, all states of which are possible."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Annotated, Any

import numpy as np

from stribeck._types import Array
from stribeck.batches.states import States, contacts_at
from stribeck.cases.case import Case
from stribeck.cases.law import KEYS_OF_SURFACES, LAW_KEY, Law, law_of_file
from stribeck.cases.model_parts import PART_TABLES
from stribeck.cases.reading import check_case, geometry_of, keys_of_solver
from stribeck.cases.tables import HEAD, Key, Keys, noted, read_tables
from stribeck.checks.body import unusual
from stribeck.contact_laws.law import AsperityLaw
from stribeck.contacts.contact import Contact
from stribeck.contacts.geometries import INPUT_TABLES
from stribeck.contacts.groups import Geometry, Groups, Physics
from stribeck.files.datasets import Column
from stribeck.files.results import Labelled, Tabled
from stribeck.files.toml import read_toml
from stribeck.files.writing import path_of
from stribeck.quantities.formats import format_si
from stribeck.quantities.lazy import cached_property
from stribeck.quantities.outputs import COLUMNS, GROUPS
from stribeck.quantities.results import Card, Shown
from stribeck.quantities.units import InputError, show
from stribeck.sweeps.axes import (
    COEFFICIENTS,
    GROUP_ROWS,
    NAME,
    TEMPERATURE,
    Axis,
    Kind,
    check_temperature_axis,
    points_of,
    read_axes,
    viscosity_at,
)


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class SweepDesign(Tabled, Shown, States):
    """The states that a sweep is to solve, each checked; its dataset has inputs and groups along ``state``."""

    path: Annotated[Path, "the file that says so"]
    text: Annotated[str, "what stands in it"]
    title: Annotated[str, "headline for outputs; empty where the file has none"]
    kind: Annotated[Kind, "how the states were chosen"]
    shape: Annotated[tuple[int, ...], "points along each axis of a grid; otherwise the number of states"]
    varied: Annotated[tuple[str, ...], "the inputs that vary, in the order of the file"]
    inputs: Annotated[
        dict[str, Array],
        "every input at every state: in SI units, or ``boundary_friction`` and ``beta`` beside the groups",
    ]
    law: Annotated[Law, "name of the contact law"]

    def _labelled(self) -> Labelled:
        columns: dict[str, Column] = {name: ("state", *each) for name, each in self.input_columns.items()}
        number: dict[str, Column] = {"state": ("state", np.arange(len(self)), *COLUMNS["state"])}
        return columns, number, {"title": self.title or "States of a sweep", "rtol": self.rtol, "kind": self.kind}

    def _card(self) -> Card:
        points = " x ".join(map(str, self.shape))
        rows = [(name, self._range(name)) for name in self.varied]
        settings = (("law", self.law), ("friction", self.definition), ("rtol", f"{self.rtol:g}"), ("file", str(self.path)))
        return Card(f"{self.title or 'a sweep'}: {self.kind}, {points} states", [*rows, *settings])

    def _range(self, name: str) -> str:
        """Return how many values an input takes, and between which."""
        values = np.unique(self.inputs[name] if name in self.inputs else self.groups[:, GROUPS.index(name)])
        rows = INPUT_TABLES[self.physics["geometry"]].rows | {NAME: TEMPERATURE}
        dimension = "number" if self.contacts is None else rows[name].dimension
        low, high = (format_si(float(end), dimension) for end in (values[0], values[-1]))
        return f"{len(values)} values, {low} to {high}"

    @property
    def unusual(self) -> tuple[str, ...]:
        """Sentences about inputs that are hardly meant, at the ends of what varies."""
        table = INPUT_TABLES[self.physics["geometry"]]
        inputs = {name: values for name, values in self.inputs.items() if name in table.quantities}
        fixed = {} if self.contacts is None else {"slide_to_roll": self.contacts[0].slide_to_roll}
        fixed |= {name: float(values[0]) for name, values in inputs.items() if name not in self.varied}
        ends = ({name: float(end(inputs[name])) for name in self.varied if name in inputs} for end in (min, max))
        return tuple(filter(None, (unusual(numbers, table) for numbers in (fixed, *ends))))

    @property
    def input_columns(self) -> dict[str, tuple[Array, str, str]]:
        """Inputs and groups of all states: values, unit and meaning of each."""
        rows = INPUT_TABLES[self.physics["geometry"]].rows | {NAME: TEMPERATURE}
        inputs = {name: (values, rows[name].unit, rows[name].label) for name, values in self.inputs.items()}
        return inputs | {f"{name}_group": (self.groups[:, i], "1", f"{name} group") for i, name in enumerate(GROUPS)}

    @property
    def contact_law(self) -> AsperityLaw | None:
        """The contact law itself; None is the exponential one."""
        return self.physics["law"]

    def __len__(self) -> int:
        """Return the number of states."""
        return len(self.groups)

    @cached_property
    def fingerprint(self) -> str:
        """Identity of this design: its states and settings, without comments in its file."""
        # The parts of all contacts are those of the first.
        physics = self.physics if self.contacts is None else self.contacts[0]
        parameters = {} if self.contact_law is None else self.contact_law.parameters
        settings = [
            sorted(self.inputs),
            self.rtol,
            self.definition,
            self.law,
            self.kind,
            self.shape,
            repr(physics),
            parameters,
        ]
        content = [json.dumps(settings).encode(), self.groups.tobytes()]
        content += [self.inputs[name].tobytes() for name in sorted(self.inputs)]
        return hashlib.sha256(b"".join(content)).hexdigest()


def load_sweep(path: str | os.PathLike[str]) -> SweepDesign:
    """Read and check a sweep file.

    Parameters
    ----------
    path : str or path-like
        A TOML file: a case file with a table ``[vary]`` of what does not stay fixed, and where wanted ``[design]``
        (``kind``, ``points``, ``seed``); or ``[groups]`` (``speed``, ``load``, ``roughness``, ``boundary_friction``,
        ``beta``) in the place of ``[contact]``.

    Returns
    -------
    SweepDesign
        The checked design.

    Raises
    ------
    InputError
        Where the file cannot be read, is no TOML, or has unknown, missing or impossible entries: a sentence
        on each line, for all of its problems.
    """
    path = path_of(path)
    tables = read_toml(path, "sweep file", "[vary]")
    own: dict[str, Any] = {name: tables.pop(name) for name in ("design", "vary") if name in tables}
    problems: list[str] = []
    geometry: Geometry = "line"
    with noted(problems, "contact" if "contact" in tables else "groups"):
        geometry, _ = geometry_of(tables)
    si = "groups" not in tables
    vary = own.get("vary")
    if si and isinstance(vary, dict) and NAME in vary:
        with noted(problems, "vary"):
            check_temperature_axis(tables, vary)
    design, axes = read_axes(own, INPUT_TABLES[geometry].rows | {NAME: TEMPERATURE} if si else GROUP_ROWS, problems)
    where = "contact" if si else "groups"
    base: Any = tables.get(where)
    for name in axes.keys() & (base if isinstance(base, dict) else {}):
        problems.append(f"[{where}] {name} = {show(base[name])} also stands in [vary]; keep one of them.")
    read = _read_contact if si else _read_groups
    title, law, solver, make = read(tables, axes, path, problems)
    if problems:
        raise InputError("\n".join(f"{path}: {problem}" for problem in problems))
    varying = points_of(design["kind"], axes, design.get("points", 0), design.get("seed", 0))
    try:
        states = make(varying)
    except InputError as problem:
        raise InputError(f"{path}: {problem}") from None
    return SweepDesign(
        path=path,
        text=path.read_text(encoding="utf-8-sig"),
        title=title,
        kind=design["kind"],
        shape=tuple(map(len, axes.values())) if design["kind"] == "grid" else (len(states["groups"]),),
        varied=tuple(varying),
        law=law,
        **solver,
        **states,
    )


Made = tuple[str, Law, dict[str, Any], Callable[[dict[str, Array]], dict[str, Any]]]
"""Title, law and ``[solver]`` of a file, and what makes its states of what varies."""


def _read_contact(tables: dict[str, Any], axes: dict[str, Axis], path: Path, problems: list[str]) -> Made:
    """Read what stays fixed as the case of the first values of what varies."""
    given = tables.get("contact", {})
    known = INPUT_TABLES["point"].quantities  # numbers of fluids and solids vary from those that their tables have
    first = {name: float(axis.at(np.zeros(1))[0]) for name, axis in axes.items() if name in known}
    fluid = tables.get("fluid", {})
    if NAME in axes and isinstance(fluid, dict):
        tables = tables | {"fluid": fluid | {NAME: float(axes[NAME].at(np.zeros(1))[0])}}
    try:
        case = check_case(tables | {"contact": given | first} if isinstance(given, dict) else tables, path)
    except InputError as problem:
        for line in str(problem).splitlines():
            said = line.removeprefix(f"{path}: ")
            varies = any(said.startswith(f"[contact] {name} ") for name in axes)
            problems.append(said.replace("[contact]", "[vary]", 1) if varies else said)
        return "", "", {}, lambda varying: {}
    forms = {name: value for name, value in given.items() if name in case.contact.INPUTS.stands_for}
    solver = {"rtol": case.rtol, "definition": case.definition}
    return case.title, case.law, solver, partial(_contacts, case.contact, forms, fluid)


def _read_groups(tables: dict[str, Any], axes: dict[str, Axis], path: Path, problems: list[str]) -> Made:
    """Read groups that stay fixed, with the coefficients beside them."""
    if "contact" in tables:
        problems.append("the tables [contact] and [groups] are both given; give SI inputs or groups.")
    parts = [name for name in PART_TABLES if name in tables]
    if parts:
        problems.append(
            f"{', '.join(parts)}: sweeps have other fluids, solids and motions in SI units; give [contact] in the place of "
            "[groups], or leave the table out."
        )
    keys: dict[str, Keys] = {
        "groups": {**{name: Key(lambda name, value: GROUP_ROWS[name].checked(value)) for name in GROUP_ROWS}, "law": LAW_KEY},
        "solver": keys_of_solver(Case.rtol),
        **KEYS_OF_SURFACES,
        "": HEAD,
    }
    geometry, tables = geometry_of(tables)
    rest = {name: each for name, each in tables.items() if name not in ("contact", *parts)}
    checked = read_tables(rest, keys, problems)
    missing = [name for name in GROUPS if name not in axes and name not in tables["groups"]]
    problems += [f"[groups] {name} is missing; add it there or to [vary]." for name in missing]
    fixed, law, shape = dict(checked["groups"]), checked["groups"]["law"], None
    with noted(problems):
        shape = law_of_file(law, {}, {name: checked[name] for name in KEYS_OF_SURFACES if name in checked}, path.parent)[0]
    physics = Groups(1.0, 1.0, 1.0, law=shape, geometry=geometry).physics
    return checked["title"], law, checked["solver"], partial(_groups, physics, fixed)


def _contacts(base: Contact, forms: dict[str, Any], fluid: dict[str, Any], varying: dict[str, Array]) -> dict[str, Any]:
    """Return contacts, each of which is checked, with their inputs and groups."""
    number = len(next(iter(varying.values())))
    fixed = {name: np.full(number, base.INPUTS.quantities[name].checked(value)) for name, value in forms.items()}
    columns = fixed | {name: column for name, column in varying.items() if name != NAME}
    if NAME in varying:
        columns["viscosity"] = viscosity_at(fluid, varying[NAME])
    contacts, groups = contacts_at(base, {name: column.astype(object) for name, column in columns.items()})
    kept = [contact.to_si() for contact in contacts]
    inputs = {name: np.array([each[name] for each in kept]) for name in kept[0]}
    return {"inputs": inputs | fixed | varying, **States.flat(groups, contacts)}


def _groups(physics: Physics, fixed: dict[str, Any], varying: dict[str, Array]) -> dict[str, Any]:
    """Return groups, and the coefficients beside them."""
    number = len(next(iter(varying.values())))
    every = {name: varying.get(name, np.full(number, fixed.get(name, 1.0))) for name in GROUP_ROWS}
    own = {name: every.pop(name) for name in COEFFICIENTS}
    return {"inputs": own, "coefficients": np.stack([*own.values()], axis=1), **States.flat(Groups(**every, **physics), None)}
