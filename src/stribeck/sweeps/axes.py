"""What varies in a sweep: every combination of a grid, the rows of a list, or points spread at random over ranges."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal, get_args

import numpy as np

from stribeck._types import Array
from stribeck.cases.tables import Key, advice_on, noted, one_of, read_tables, rising_pair, whole
from stribeck.contacts.geometries import LINE
from stribeck.contacts.groups import GROUP_INPUTS
from stribeck.fluids.description import celsius
from stribeck.fluids.presets import PRESETS
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
