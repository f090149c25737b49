"""What the ``[fit]`` table of a case asks for: free quantities, bounds, priors, noise, and the columns of the data.

Only what can be said without the data is checked here; what a column holds is for :mod:`stribeck.fits.measurements`.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any, Literal, Self

from stribeck.cases.model_parts import take_parts
from stribeck.contacts.contact import Contact
from stribeck.contacts.part_inputs import PART_INPUTS, PART_LETTERS
from stribeck.contacts.parts import PURE_SLIDING
from stribeck.quantities.hints import advice_on
from stribeck.quantities.input_rows import ROWS
from stribeck.quantities.inputs import INPUT_TABLES, LETTERS, LINE, InputTable, quantity
from stribeck.quantities.units import InputError, show, to_si

__all__ = ["FREE_INPUTS", "FitSettings", "Prior", "check_fit_table", "free_names"]

Noise = Literal["relative", "absolute"]

# Inputs of all contacts that may be fitted, from what a fit is mostly after to what is mostly known.
CONTACT_INPUTS = tuple(row.name for row in sorted(ROWS, key=lambda row: row.known) if not row.derived and row.name != "speed")

FREE_INPUTS = (*CONTACT_INPUTS, *PART_INPUTS)  # Inputs of all contacts and numbers of fluids and solids, which a fit may free

INPUT_OF_LETTER = {**PART_LETTERS, **LETTERS}  # Other names of what may be fitted

DEFAULT_FREE = ("boundary_friction", "roughness")

# Kinds of columns of the data, beside the inputs of :data:`CONTACT_INPUTS`, which distinguish curves.
COLUMNS = (
    *("speed", "speed_viscosity", "hersey_number", "friction", "error", "curve"),
    *("entrainment_speed", "sliding_speed", "surface_speeds", "slide_to_roll", "rotation"),
    *("friction_force", "normal_force", "torque", "run"),
)

KEYS = (
    *("free", "per_curve", "noise", "relative_error", "absolute_error", "robust", "magnitudes", "header_row"),
    *("repeats", "run_in", "sheet", "track_radius", "arm"),
)
TABLES = ("columns", "units", "bounds", "priors", "curves")

MAX_PRIOR_FACTOR = 1e6  # A wider prior knows nothing


@dataclass(frozen=True)
class Prior:
    """Knowledge of an input before the data: normal in its logarithm."""

    value: float  # Median, in SI units
    factor: float  # Factor > 1: value/factor to value*factor holds the input with 68 % probability


@dataclass(frozen=True)
class FitSettings:
    """What the ``[fit]`` table of a case asks for.

    Parameters
    ----------
    free : tuple of str
        Inputs to fit; empty for the default, friction coefficient and roughness.
    per_curve : tuple of str
        Those of them that each curve has for itself; the others are shared.
    noise : {"relative", "absolute"}
        Which error of the friction coefficient is alike in all rows, where no errors are given.
    relative_error, absolute_error : float, optional
        Known standard error of the friction coefficient, relative and absolute [-].
    robust : bool
        Whether outliers are kept from steering the fit.
    magnitudes : bool
        Whether signs of speed and friction are directions of strokes: they are dropped, with rows at rest and reversals.
    repeats : bool, optional
        Whether rows at the same speed of a curve are put together, their scatter becoming the error of the mean; by default
        where the file numbers its runs.
    run_in : {"leave", "keep"}
        Whether a first run that differs from the later ones is left out of the means.
    header_row : int, optional
        Row of the data file that holds the names of the columns; the first that is no comment by default.
    sheet : str, optional
        Sheet of a workbook that holds the data; by default the one with known columns, of several that with most numbers.
    track_radius : float, optional
        Radius [m] of the track on which a speed of rotation is that of sliding.
    arm : float, optional
        Arm [m] over which a torque is the friction force.
    columns : dict
        What a column is -> its header, or a list of headers for several friction columns.
    units : dict
        What a column is -> its unit.
    bounds : dict
        Input -> lowest and highest value in SI units.
    priors : dict
        Input -> :class:`Prior`.
    curves : dict
        Name of a curve -> inputs in SI units in which it differs from the case, and its own fluid or solid.
    geometry : {"line", "point"}
        What was measured: a cylinder or a ball.
    slide_to_roll : float
        Slide-to-roll ratio of the contact: but at 2 and -2 both surfaces move, and a speed may be their mean or their sum.
    scales_surface : bool
        Whether a fitted roughness scales a surface as a whole, so that beta follows, as with a table ``[surface]``.
    """

    free: tuple[str, ...] = ()
    per_curve: tuple[str, ...] = ()
    noise: Noise = "relative"
    relative_error: float | None = None
    absolute_error: float | None = None
    robust: bool = False
    magnitudes: bool = False
    repeats: bool | None = None
    run_in: Literal["leave", "keep"] = "leave"
    header_row: int | None = None
    sheet: str | None = None
    track_radius: float | None = None
    arm: float | None = None
    columns: dict[str, str | list[str]] = field(default_factory=dict)
    units: dict[str, str] = field(default_factory=dict)
    bounds: dict[str, tuple[float, float]] = field(default_factory=dict)
    priors: dict[str, Prior] = field(default_factory=dict)
    curves: dict[str, dict[str, Any]] = field(default_factory=dict)
    geometry: str = "line"
    slide_to_roll: float = PURE_SLIDING
    scales_surface: bool = field(default=False, compare=False)

    @classmethod
    def of(cls, contact: Contact) -> Self:
        """Return the settings of a fit that asks for nothing.

        Parameters
        ----------
        contact : Contact
            What was measured.

        Returns
        -------
        FitSettings
            With its geometry and motion.
        """
        return cls(geometry=contact.groups.geometry, slide_to_roll=contact.slide_to_roll)

    @property
    def ratios(self) -> tuple[float, ...]:
        """The slide-to-roll ratios of the contact and of curves that have their own."""
        own = [float(curve["slide_to_roll"]) for curve in self.curves.values() if curve and "slide_to_roll" in curve]
        return tuple(dict.fromkeys([self.slide_to_roll, *own]))

    @property
    def rolls(self) -> bool:
        """Whether both surfaces of a curve move."""
        return any(abs(ratio) != PURE_SLIDING for ratio in self.ratios)

    @property
    def inputs(self) -> InputTable:
        """The inputs of the contact that was measured, with their units."""
        return INPUT_TABLES[self.geometry]


def check_fit_table(table: Any, geometry: str = "line") -> FitSettings:
    """Return the settings that a ``[fit]`` table asks for."""
    if not isinstance(table, dict):
        raise InputError(f"fit = {show(table)} must be a table, [fit].")
    problems: list[str] = []
    found: dict[str, Any] = {"geometry": geometry}
    inputs = INPUT_TABLES[geometry]

    def attempt(where: str, key: str, check: Any, *arguments: Any) -> Any:
        try:
            return check(*arguments)
        except InputError as problem:
            problems.append(f"[{where}] {problem}")
            return None

    for key, value in table.items():
        if key in KEYS:
            found[key] = attempt("fit", key, _setting, key, value)
        elif key in TABLES:
            found[key] = {}
            if not isinstance(value, dict):
                problems.append(f"[fit] {key} = {show(value)} must be a table, [fit.{key}].")
                continue
            for name, entry in value.items():
                if key == "curves":
                    found[key][name] = attempt("fit.curves", name, _curve, name, entry, inputs)
                else:
                    pair = attempt(f"fit.{key}", name, _entry, key, name, entry, inputs)
                    if pair is not None:
                        found[key][pair[0]] = pair[1]
        else:
            problems.append(f"[fit] {_unknown(key, value, (*KEYS, *TABLES))}")
    if problems:
        raise InputError("\n".join(problems))
    settings = FitSettings(**found)
    extra = [name for name in settings.per_curve if name not in (settings.free or DEFAULT_FREE)]
    if extra:
        raise InputError(f"[fit] per_curve has {extra[0]}, which is not in free; add it there.")
    return settings


def free_names(names: Iterable[Any], where: str = "free") -> tuple[str, ...]:
    """Return names of inputs to fit, checked, in the order of :data:`FREE_INPUTS`."""
    if isinstance(names, str) or not isinstance(names, Iterable):
        raise InputError(f"{where} = {show(names)} must be a list of inputs, such as ['boundary_friction', 'roughness'].")
    found = []
    for name in names:
        meant = INPUT_OF_LETTER.get(name, name) if isinstance(name, str) else name
        if meant in ("speed", "U"):
            raise InputError(f"{where} has {show(name)}, which is measured; a common factor on it is that of the viscosity.")
        if meant not in FREE_INPUTS:
            hint = advice_on(str(name), FREE_INPUTS) or f"known are {', '.join(FREE_INPUTS)}"
            raise InputError(f"{where} has {show(name)}, which cannot be fitted; {hint}.")
        if meant in found:
            raise InputError(f"{where} has {meant} twice; name each input once.")
        found.append(meant)
    return tuple(sorted(found, key=FREE_INPUTS.index))


def _setting(key: str, value: Any) -> Any:
    if key in ("free", "per_curve"):
        if not isinstance(value, list) or (key == "free" and not value):
            raise InputError(f'{key} = {show(value)} must be a list of inputs, such as ["boundary_friction", "roughness"].')
        return free_names(value, key)
    if key == "noise":
        if value not in ("relative", "absolute"):
            raise InputError(f"noise = {show(value)} must be 'relative' or 'absolute'.")
        return value
    if key == "run_in":
        if value not in ("leave", "keep"):
            raise InputError(f"run_in = {show(value)} must be 'leave' (out of the means) or 'keep'.")
        return value
    if key in ("robust", "magnitudes", "repeats"):
        if not isinstance(value, bool):
            raise InputError(f"{key} = {show(value)} must be true or false, without quotes.")
        return value
    if key == "header_row":
        if isinstance(value, bool) or not isinstance(value, int) or not 1 <= value <= 100_000:
            raise InputError(f"header_row = {show(value)} must be the number of a row, counted from 1.")
        return value
    if key == "sheet":
        if not isinstance(value, str) or not value:
            raise InputError(f"{key} = {show(value)} must be the name of a sheet, as text in quotes.")
        return value
    if key in ("track_radius", "arm"):
        length = to_si(value, "length", key, "20 mm")
        if length <= 0:
            raise InputError(f"{key} = {show(value)} must be positive, such as '20 mm'.")
        return length
    number = isinstance(value, int | float) and not isinstance(value, bool)
    if not number or not 0 < value < math.inf:
        raise InputError(f"{key} = {show(value)} must be a positive number, such as 0.02.")
    return float(value)


def _entry(table: str, name: str, value: Any, inputs: InputTable = LINE) -> tuple[str, Any]:
    if table in ("bounds", "priors"):
        [meant] = free_names([name], f"[fit.{table}]")
        return meant, _bounds(meant, value, inputs) if table == "bounds" else _prior(meant, value, inputs)
    columns = (each for each in COLUMNS if table == "columns" or each not in ("curve", "run"))
    known = (*columns, *(each for each in CONTACT_INPUTS if each != "boundary_friction"))
    meant = LETTERS.get(name, name)
    if meant not in known:
        raise InputError(_unknown(name, value, known))
    texts = value if table == "columns" and name in ("friction", "surface_speeds") and isinstance(value, list) else [value]
    if not texts or not all(isinstance(text, str) and text.strip() for text in texts):
        wanted = "the header of a column" if table == "columns" else "a unit"
        raise InputError(f"{name} = {show(value)} must be {wanted}, as text in quotes.")
    return meant, value


def _bounds(name: str, value: Any, inputs: InputTable) -> tuple[float, float]:
    if not isinstance(value, list) or len(value) != 2:
        raise InputError(f"{name} = {show(value)} must be a list of two values, the lowest and the highest.")
    low, high = (_value(name, each, inputs) for each in value)
    if not 0 < low < high:
        raise InputError(f"{name} = {show(value)} must be two positive values, the lowest first.")
    return low, high


def _prior(name: str, value: Any, inputs: InputTable) -> Prior:
    if not isinstance(value, dict) or set(value) != {"value", "factor"}:
        raise InputError(f"{name} = {show(value)} must be a table such as {{ value = ..., factor = 1.2 }}.")
    factor, median = value["factor"], _value(name, value["value"], inputs)
    if isinstance(factor, bool) or not isinstance(factor, int | float) or not 1 < factor <= MAX_PRIOR_FACTOR:
        raise InputError(f"{name} has factor = {show(factor)}, which must be a number above 1: 1.2 is 'known within 20 %'.")
    if median == 0:
        raise InputError(f"{name} has value = {show(value['value'])}, which must be positive.")
    return Prior(median, float(factor))


def _value(name: str, value: Any, inputs: InputTable) -> float:
    """Return what may be fitted in SI units."""
    if name not in PART_INPUTS:
        return quantity(name, value, inputs)
    found = to_si(value, PART_INPUTS[name].dimension, name, PART_INPUTS[name].typical)
    if found <= 0:
        raise InputError(f"{name} = {show(value)} must be positive.")
    return found


def _curve(name: str, entry: Any, inputs: InputTable) -> dict[str, Any]:
    """Return the inputs of a curve, and its own fluid, solid and so on as the tables of its name have them."""
    if not isinstance(entry, dict):
        raise InputError(f"{name} = {show(entry)} must be a table of inputs, [fit.curves.{name}].")
    rest, parts, wrong = take_parts({**entry, "contact": {}}, inputs.geometry)
    if wrong:
        raise InputError("\n".join(f"{name}: {each}" for each in wrong))
    found: dict[str, Any] = {**rest.pop("contact"), **parts}
    known = (*(each for each in inputs.names if each != "speed"), *PART_INPUTS)
    for key, value in rest.items():
        meant = INPUT_OF_LETTER.get(key, key)
        if meant not in known:
            raise InputError(f"{name}: {_unknown(key, value, known)}")
        if meant in found:
            raise InputError(f"{name}: {meant} = {show(value)} is given beside a preset, which has its own; remove one.")
        found[meant] = _value(meant, value, inputs)
    return found


def _unknown(key: str, value: Any, known: tuple[str, ...]) -> str:
    hint = advice_on(key, known) or f"known are {', '.join(known)}"
    return f"{key} = {show(value)} is not a known key; {hint}."
