"""Sweep files: TOML that says what varies becomes a checked design, all states of which are possible."""

from __future__ import annotations

import hashlib
import json
import math
import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Annotated, Any, Literal, get_args

import numpy as np

from stribeck._types import Array
from stribeck.batches.states import States, contacts_at
from stribeck.cases.case import Case
from stribeck.cases.law import KEYS_OF_SURFACES, LAW_KEY, Law, law_of_file
from stribeck.cases.model_parts import PART_TABLES
from stribeck.cases.reading import check_case, geometry_of, keys_of_solver
from stribeck.cases.tables import HEAD, Key, Keys, advice_on, noted, one_of, read_tables, rising_pair, whole
from stribeck.checks.body import unusual
from stribeck.contact_laws.law import AsperityLaw
from stribeck.contacts.contact import Contact
from stribeck.contacts.geometries import INPUT_TABLES, LINE
from stribeck.contacts.groups import GROUP_INPUTS, Groups, Physics
from stribeck.files.datasets import Column
from stribeck.files.results import Labelled, Tabled
from stribeck.files.toml import read_toml
from stribeck.files.writing import path_of
from stribeck.fluids.description import celsius
from stribeck.fluids.presets import PRESETS
from stribeck.quantities.formats import format_si
from stribeck.quantities.lazy import cached_property
from stribeck.quantities.outputs import COLUMNS, GROUPS
from stribeck.quantities.results import Card, Shown
from stribeck.quantities.schema import Input
from stribeck.quantities.units import InputError, checked_word, show

NAME = "temperature"


@dataclass(frozen=True, kw_only=True)
class Temperature(Input):
    """A temperature, which has no SI unit to multiply with and no logarithm."""

    @property
    def unit(self) -> str:
        """Its unit in files."""
        return "degC"

    def checked(self, value: Any) -> float:
        """Return a temperature in degrees Celsius."""
        return celsius(value)


TEMPERATURE = Temperature(name=NAME, label="temperature of the liquid", dimension="number", typical="25")


def check_temperature_axis(tables: Mapping[str, Any], vary: Mapping[str, Any]) -> None:
    """Refuse temperature as an axis without a liquid that knows it, or beside what follows from it."""
    fluid = tables.get("fluid")
    named = fluid.get("preset") if isinstance(fluid, dict) else None
    known = [name for name, preset in PRESETS.items() if NAME in preset.conditions]
    if named not in known:
        raise InputError(
            f"{NAME} varies with a liquid that knows it alone; add [fluid] preset = {' or '.join(map(repr, known))}."
        )
    if "viscosity" in vary:
        raise InputError(f"viscosity follows from {NAME}; leave one of them out.")
    if isinstance(fluid, dict) and NAME in fluid:
        raise InputError(f"{NAME} also stands in [fluid]; keep one of them.")


def viscosity_at(fluid: Mapping[str, Any], temperatures: Array) -> Array:
    """Return the viscosity of the liquid of a table at each temperature; the laws of no liquid move with it."""
    conditions = {key: value for key, value in fluid.items() if key != "preset"}
    different, place = np.unique(temperatures, return_inverse=True)
    liquids = [PRESETS[fluid["preset"]](**conditions, temperature=float(value)) for value in different]
    return np.array([each.viscosity for each in liquids])[place]


Kind = Literal["grid", "list", "random", "latin-hypercube", "sobol"]

KINDS: tuple[Kind, ...] = get_args(Kind)
RANDOM_KINDS: tuple[Kind, ...] = KINDS[2:]  # Kinds of design whose number of points is given

MAX_STATES = 1_000_000

COEFFICIENTS = ("boundary_friction", "beta")  # Inputs of friction beside groups

GROUP_ROWS = GROUP_INPUTS | {name: LINE.quantities[name] for name in COEFFICIENTS}  # What may vary in the place of a contact

KEYS_OF_DESIGN = {
    "kind": Key(one_of(*KINDS), "grid"),
    "points": Key(whole(1, MAX_STATES)),
    "seed": Key(whole(0, 2**63 - 1, "a whole number, zero or positive")),
}


@dataclass(frozen=True)
class Axis:
    """Values of one input in a design: a list or a range."""

    values: tuple[float, ...] = ()  # Values of a list; empty for a range
    low: float = math.nan  # Ends of a range
    high: float = math.nan  # Ends of a range
    points: int = 0  # Values on a range in a grid; 0 where the design draws them
    spacing: Literal["log", "linear"] = "log"  # In what a range is even

    def __len__(self) -> int:
        """Return the number of values in a grid or a list."""
        return len(self.values) or self.points

    def every(self) -> Array:
        """Return the values that a grid or a list takes."""
        if self.values:
            return np.array(self.values)
        return np.asarray((np.geomspace if self.spacing == "log" else np.linspace)(self.low, self.high, self.points))

    def at(self, parts: Array) -> Array:
        """Return the values at given parts of the way, 0 to 1: on a range, or one of the listed."""
        if self.values:
            places = np.minimum((parts * len(self.values)).astype(int), len(self.values) - 1)
            return np.asarray(np.array(self.values)[places])
        if self.spacing == "log":
            return np.asarray(np.exp(math.log(self.low) + parts * (math.log(self.high) - math.log(self.low))))
        return np.asarray(self.low + parts * (self.high - self.low))


def points_of(kind: Kind, axes: dict[str, Axis], points: int = 0, seed: int = 0) -> dict[str, Array]:
    """Return the value of each axis at each state of a design."""
    if kind == "list":
        return {name: axis.every() for name, axis in axes.items()}
    if kind == "grid":
        meshes = np.meshgrid(*(axis.every() for axis in axes.values()), indexing="ij")
        return {name: mesh.ravel() for name, mesh in zip(axes, meshes, strict=True)}
    parts = _parts(kind, len(axes), points, seed)
    return {name: axis.at(parts[:, i]) for i, (name, axis) in enumerate(axes.items())}


def _parts(kind: Kind, axes: int, points: int, seed: int) -> Array:
    """Return points in the unit cube, shape (points, axes)."""
    if kind == "random":
        return np.random.default_rng(seed).random((points, axes))
    from scipy.stats import qmc  # slow to import

    # The seed by its old name, which SciPy before 1.15 knows too.
    sampler = (qmc.LatinHypercube if kind == "latin-hypercube" else qmc.Sobol)(axes, seed=np.random.default_rng(seed))
    return np.asarray(sampler.random(points))


def read_axes(
    tables: dict[str, Any], rows: Mapping[str, Input], problems: list[str]
) -> tuple[dict[str, Any], dict[str, Axis]]:
    """Return what ``[design]`` says and the axes of ``[vary]``, of inputs in SI units or of groups."""
    design = read_tables({"design": {}} | tables, {"design": KEYS_OF_DESIGN}, problems).get("design", {})
    vary = tables.get("vary")
    if not isinstance(vary, dict):
        problems.append("the table [vary] is missing." if vary is None else f"vary = {show(vary)} must be a table, [vary].")
        return design, {}
    if not vary:
        problems.append("[vary] is empty; list what varies, for example: load = ['10 N/m', '30 N/m'].")
    axes, before = {}, len(problems)
    for name, entry in vary.items():
        with noted(problems, "vary"):
            if name not in rows:
                raise InputError(f"{show(name)} cannot vary; {advice_on(name, rows)}.")
            # This stands for an axis that is refused, so that nothing else is said of it.
            axes[name] = Axis(values=(rows[name].typical_value,))
            axes[name] = _axis_of(name, entry, design.get("kind", "grid"), rows[name])
    if axes and len(problems) == before:
        problems += _design_problems(design, axes)
    return design, axes


def _axis_of(name: str, entry: Any, kind: Kind, row: Input) -> Axis:
    """Return what one entry of ``[vary]`` says."""
    check = row.checked
    if isinstance(entry, list):
        if not entry:
            raise InputError(f"{name} = [] is empty; list its values.")
        return Axis(values=tuple(map(check, entry)))
    if kind == "list" or not isinstance(entry, dict):
        ranges = "" if kind == "list" else ", or a range as in { range = [1, 10], points = 11 }"
        raise InputError(f"{name} = {show(entry)} must be a list of values{ranges}.")
    extra = [key for key in entry if key not in ("range", "points", "spacing")]
    if extra:
        raise InputError(f"{name} has the unknown key {show(extra[0])}; known are range, points and spacing.")
    spacing, points = entry.get("spacing", "linear" if row is TEMPERATURE else "log"), entry.get("points")
    low, high = rising_pair(f"{name}: range", entry.get("range"), check)
    checked_word(f"{name}: spacing", spacing, ("log", "linear"))
    if spacing == "log" and low <= 0:
        where = f"{name}: range = {show(entry['range'])} begins {'below' if low else 'at'} zero"
        raise InputError(f"{where}; add spacing = 'linear', or list the values.")
    if kind in RANDOM_KINDS:
        if points is not None:
            raise InputError(f"{name}: points = {show(points)} is for grids; with kind = '{kind}' it belongs in [design].")
        return Axis(low=low, high=high, spacing=spacing)
    return Axis(low=low, high=high, points=whole(2, MAX_STATES)(f"{name}: points", points), spacing=spacing)


def _design_problems(design: dict[str, Any], axes: dict[str, Axis]) -> list[str]:
    """Return what in ``[design]`` does not go with its kind or with the axes."""
    kind, points = design["kind"], design.get("points")
    if kind in RANDOM_KINDS:
        if points is None:
            return [f"[design] points is missing; set how many states kind = '{kind}' draws, as in points = 256."]
        if kind == "sobol" and points & (points - 1):
            near = 2 ** round(math.log2(points))
            return [f"[design] points = {points} must be a power of two for kind = 'sobol', such as {near}."]
        return []
    problems = [
        f"[design] {key} = {design[key]} is for {', '.join(RANDOM_KINDS)}; kind = '{kind}' does not use it."
        for key in ("points", "seed")
        if key in design
    ]
    sizes = {name: len(axis) for name, axis in axes.items()}
    if kind == "list" and len(set(sizes.values())) > 1:
        counts = ", ".join(f"{name} has {size}" for name, size in sizes.items())
        problems.append(f"[vary] the lists must have the same length with kind = 'list': {counts}.")
    states = math.prod(sizes.values()) if kind == "grid" else max(sizes.values())
    if states > MAX_STATES:
        problems.append(f"[vary] makes {states} states; at most {MAX_STATES} are possible in one sweep.")
    return problems


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
        # The parts of all contacts are those of the first; groups have those of the article.
        physics = (self.contact_law, self.physics["geometry"]) if self.contacts is None else self.contacts[0]
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
    geometry, _ = geometry_of(tables, [])
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
    geometry, tables = geometry_of(tables, problems)
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
