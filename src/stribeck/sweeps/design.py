"""Sweep files: a TOML file that says what varies becomes a checked design, all states of which are possible.

As with case files, everything that is wrong is reported at once, a sentence for each problem that names the key.
"""

from __future__ import annotations

import hashlib
import json
import math
import os
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from stribeck._types import Array
from stribeck.cases.law import INPUTS_OF_SURFACES, Law
from stribeck.cases.model_parts import take_parts
from stribeck.cases.reading import contact_inputs, geometry_of, group_inputs
from stribeck.cases.tables import noted, read_tables
from stribeck.checks.body import unusual
from stribeck.contact_laws.law import AsperityLaw
from stribeck.contacts.geometries import CONTACTS, INPUT_TABLES
from stribeck.contacts.groups import Geometry, Groups, Physics
from stribeck.contacts.model import BASE_MODEL, Model
from stribeck.contacts.parts import BASE_PARTS, Parts
from stribeck.files.datasets import Column
from stribeck.files.results import Labelled, Tabled
from stribeck.files.toml import read_toml
from stribeck.files.writing import path_of
from stribeck.quantities.formats import format_si
from stribeck.quantities.lazy import cached_property
from stribeck.quantities.outputs import COLUMNS, GROUPS
from stribeck.quantities.results import Card, Shown
from stribeck.quantities.units import InputError, show
from stribeck.sweeps.columns import input_columns
from stribeck.sweeps.points import Axis, Kind, points_of
from stribeck.sweeps.tables import COEFFICIENTS, axis_of, design_problems, keys_of_sweep, kind_of, missing

__all__ = ["SweepDesign", "load_sweep"]


@dataclass(frozen=True, eq=False, repr=False)
class SweepDesign(Tabled, Shown):
    """The states that a sweep is to solve, each checked; its dataset has inputs and groups along ``state``.

    Attributes
    ----------
    path : pathlib.Path
        The file that says so.
    text : str
        What stands in it.
    title : str
        Headline for outputs; empty where the file has none.
    kind : {"grid", "list", "random", "latin-hypercube", "sobol"}
        How the states were chosen.
    shape : tuple of int
        Points along each axis of a grid; otherwise the number of states.
    varied : tuple of str
        The inputs that vary, in the order of the file.
    inputs : dict of str to ndarray
        Every input at every state: in SI units, or ``boundary_friction`` and ``beta`` beside the groups.
    groups : ndarray, shape (n, 3)
        Speed, load and roughness group of each state.
    si : bool
        Whether the states are contacts in SI units.
    rtol : float
        Relative tolerance of each state.
    law : {"exponential", "persson", "greenwood-williamson", "greenwood-tripp", "table"}
        Name of the contact law.
    physics : Physics
        What the states have in common beside their groups: the law itself and the geometry; the model is that of the first.
    parts : Parts
        Fluid, cavitation, flow factors, solid and motion of all contacts.
    """

    path: Path
    text: str = field(repr=False)
    title: str
    kind: Kind
    shape: tuple[int, ...]
    varied: tuple[str, ...]
    inputs: dict[str, Array] = field(repr=False)
    groups: Array = field(repr=False)
    si: bool
    rtol: float
    law: Law
    physics: Physics = field(repr=False)
    parts: Parts = field(default=BASE_PARTS, repr=False)

    def _labelled(self) -> Labelled:
        groups = {f"{name}_group": self.groups[:, i] for i, name in enumerate(GROUPS)}
        about = input_columns(self.inputs, self.physics)
        columns: dict[str, Column] = {name: ("state", values, *about[name]) for name, values in (self.inputs | groups).items()}
        number: dict[str, Column] = {"state": ("state", np.arange(len(self)), *COLUMNS["state"])}
        return columns, number, {"title": self.title or "States of a sweep", "rtol": self.rtol, "kind": self.kind}

    def _card(self) -> Card:
        points = " x ".join(map(str, self.shape))
        rows = [(name, self._range(name)) for name in self.varied]
        settings = (("law", self.law), ("rtol", f"{self.rtol:g}"), ("file", str(self.path)))
        return Card(f"{self.title or 'a sweep'}: {self.kind}, {points} states", [*rows, *settings])

    def _range(self, name: str) -> str:
        """Return how many values an input takes, and between which."""
        values = np.unique(self.inputs[name])
        dimension = INPUT_TABLES[self.physics["geometry"]].quantities[name].dimension if self.si else "number"
        low, high = (format_si(float(end), dimension) for end in (values[0], values[-1]))
        return f"{len(values)} values, {low} to {high}"

    @property
    def unusual(self) -> tuple[str, ...]:
        """Sentences about inputs that are hardly meant, at the ends of what varies."""
        table = INPUT_TABLES[self.physics["geometry"]]
        inputs = {name: values for name, values in self.inputs.items() if name in table.quantities}
        fixed = {"slide_to_roll": self.parts.slide_to_roll}
        fixed |= {name: float(values[0]) for name, values in inputs.items() if name not in self.varied}
        ends = ({name: float(end(inputs[name])) for name in self.varied if name in inputs} for end in (min, max))
        return tuple(filter(None, (unusual(numbers, table) for numbers in (fixed, *ends))))

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
        settings: list[Any] = [sorted(self.inputs), self.si, self.rtol, self.law, self.kind, self.shape]
        if self.physics["geometry"] != "line":
            settings.append(self.physics["geometry"])
        if self.contact_law is not None:
            settings += [repr(self.contact_law), self.contact_law.parameters]
        if self.parts != BASE_PARTS:
            settings.append(repr(self.parts))
        content = [json.dumps(settings).encode(), self.groups.tobytes()]
        content += [self.inputs[name].tobytes() for name in sorted(self.inputs)]
        return hashlib.sha256(b"".join(content)).hexdigest()


def load_sweep(path: str | os.PathLike[str]) -> SweepDesign:
    """Read and check a sweep file.

    Parameters
    ----------
    path : str or path-like
        A TOML file: a table ``[contact]`` (as in a case file) or ``[groups]`` (``speed``, ``load``, ``roughness``,
        ``boundary_friction``, ``beta``) with what stays fixed, a table ``[vary]`` with what does not, and where wanted
        ``[design]`` (``kind``, ``points``, ``seed``), ``[solver]`` (``rtol``), ``title`` and ``notes``; beside ``[contact]``
        the tables of fluid, cavitation, motion, flow factors and solid of case files.

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
    table = read_toml(path, "sweep file", "[vary]")
    problems: list[str] = []
    geometry: Geometry = "line"
    with noted(problems, "contact" if "contact" in table else "groups"):
        geometry, table = geometry_of(table)
    known = INPUT_TABLES[geometry]
    table, parts, wrong = take_parts(table, geometry)
    problems += wrong
    si, vary, kind = "groups" not in table, table.get("vary"), kind_of(table)
    if parts and not si:
        problems.append(
            f"{', '.join(parts)}: sweeps have other fluids, solids and motions in SI units; give [contact] in the place of "
            "[groups], or leave the table out."
        )
    if "contact" in table and not si:
        problems.append("the tables [contact] and [groups] are both given; give SI inputs or groups.")
    checked = read_tables({name: each for name, each in table.items() if name != "vary"}, keys_of_sweep(known), problems)
    if not isinstance(vary, dict):
        problems.append("the table [vary] is missing." if vary is None else f"vary = {show(vary)} must be a table, [vary].")
    axes: list[Axis] = []
    if isinstance(vary, dict) and kind is not None:
        for name, entry in vary.items():
            with noted(problems, "vary"):
                axes.append(axis_of(name, entry, kind, si, known))
        if not vary:
            problems.append("[vary] is empty; list what varies, for example: load = ['10 N/m', '30 N/m'].")
        base = table.get("contact" if si else "groups", {})
        given = INPUTS_OF_SURFACES if si and ("surface" in table or "asperities" in table) else ()
        problems += missing(base if isinstance(base, dict) else {}, vary, si, given, known)
    _refuse(path, problems)
    design, law = checked["design"], checked["contact" if si else "groups"]["law"]
    _refuse(path, design_problems(design, axes))
    varying = points_of(design["kind"], axes, design.get("points", 0), design.get("seed", 0))
    with noted(problems):
        source = next((name for name in ("surface", "asperities") if name in checked), "")
        for axis in axes:  # what varies is not also said by a table of the surface
            if si and axis.name in INPUTS_OF_SURFACES and source:
                raise InputError(f"[vary] {axis.name} follows from the table [{source}]; remove one of them.")
        fixed = contact_inputs(checked, path.parent, known) if si else group_inputs(checked, path.parent)
        shape: AsperityLaw | None = fixed.pop("law")
        inputs, groups, of_first = _contacts(fixed, varying, geometry, parts) if si else (*_groups(fixed, varying), BASE_MODEL)
    _refuse(path, problems)
    return SweepDesign(
        path=path,
        text=path.read_text(encoding="utf-8-sig"),
        title=checked["title"],
        kind=design["kind"],
        shape=tuple(map(len, axes)) if kind == "grid" else (len(groups),),
        varied=tuple(varying),
        inputs=inputs,
        groups=groups,
        si=si,
        rtol=checked["solver"]["rtol"],
        law=law,
        physics=Groups(1.0, 1.0, 1.0, law=shape, geometry=geometry, model=of_first).physics,
        parts=Parts(**parts) if parts else BASE_PARTS,
    )


def _refuse(path: Path, problems: list[str]) -> None:
    if problems:
        raise InputError("\n".join(f"{path}: {problem}" for problem in problems))


def _contacts(
    fixed: dict[str, Any], varying: dict[str, Array], geometry: Geometry, parts: dict[str, Any]
) -> tuple[dict[str, Array], Array, Model]:
    """Return inputs and groups of contacts, each of which is checked, and the model of the first."""
    contacts = []
    for i, values in enumerate(zip(*(column.tolist() for column in varying.values()), strict=True)):
        try:
            contacts.append(CONTACTS[geometry](**fixed, **dict(zip(varying, values, strict=True)), **parts))
        except InputError as problem:
            raise InputError(f"state {i}: {problem}") from None
    kept = [contact.to_si() for contact in contacts]
    inputs = {name: np.array([each[name] for each in kept]) for name in kept[0]}
    for name in INPUT_TABLES[geometry].stands_for:
        if name in varying or name in fixed:
            inputs[name] = varying.get(name, np.full(len(contacts), fixed.get(name, math.nan)))
    groups = [contact.groups for contact in contacts]
    return inputs, np.array([[getattr(each, name) for name in GROUPS] for each in groups]), groups[0].model


def _groups(fixed: dict[str, float], varying: dict[str, Array]) -> tuple[dict[str, Array], Array]:
    """Return coefficients and groups."""
    number = len(next(iter(varying.values())))
    every = {name: varying.get(name, np.full(number, fixed.get(name, 1.0))) for name in (*GROUPS, *COEFFICIENTS)}
    return {name: every[name] for name in COEFFICIENTS}, np.stack([every[name] for name in GROUPS], axis=1)
