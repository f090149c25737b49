"""What the tables ``[fit]`` and ``[bench]`` of a case ask for, as far as it can be checked without the data."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, fields, replace
from functools import partial
from typing import Any, Literal

from stribeck.cases.model_parts import take_parts
from stribeck.cases.tables import (
    AS_GIVEN,
    TRUTH,
    Check,
    Key,
    Keys,
    advice_on,
    must,
    noted,
    one_of,
    read_tables,
    rising_pair,
    unknown,
    whole,
)
from stribeck.contacts.contact import Contact
from stribeck.contacts.geometries import INPUT_TABLES, LINE
from stribeck.contacts.inputs import InputTable
from stribeck.contacts.parts import PART_INPUTS, PURE_SLIDING, Parts
from stribeck.fluids.presets import PRESETS
from stribeck.quantities.docstrings import complete_docstring
from stribeck.quantities.schema import Input, numbers_of
from stribeck.quantities.units import DIMENSIONS, InputError, checked_kind, checked_word, number_or_text, show

Noise = Literal["relative", "absolute"]

Entry = Callable[[str, str, Any, InputTable], tuple[str, Any]]  # Returns the name that is meant by a key, and its value

# Inputs of all contacts that may be fitted, from what a fit is mostly after to what is mostly known.
CONTACT_INPUTS = tuple(sorted((name for name in LINE.names if name != "speed"), key=lambda name: LINE.kept[name].known))

FREE_INPUTS = (*CONTACT_INPUTS, *PART_INPUTS)  # Inputs of all contacts and numbers of fluids and solids, which a fit may free

DEFAULT_FREE = ("boundary_friction", "roughness")

# Kinds of columns of the data, beside the inputs of :data:`CONTACT_INPUTS`, which distinguish curves.
COLUMNS = (
    *("speed", "speed_viscosity", "hersey_number", "friction", "error", "curve"),
    *("entrainment_speed", "sliding_speed", "surface_speeds", "slide_to_roll", "rotation"),
    *("friction_force", "normal_force", "torque", "run"),
)

MAX_PRIOR_FACTOR = 1e6  # A wider prior knows nothing


@dataclass(frozen=True)
class Prior:
    """Knowledge of an input before the data: normal in its logarithm."""

    value: float  # Median, in SI units
    factor: float  # Factor > 1: value/factor to value*factor holds the input with 68 % probability


def free_names(names: Iterable[Any], where: str = "free") -> tuple[str, ...]:
    """Return names of inputs to fit, checked, in the order of :data:`FREE_INPUTS`."""
    if isinstance(names, str) or not isinstance(names, Iterable):
        raise InputError(f"{where} = {show(names)} must be a list of inputs, such as ['boundary_friction', 'roughness'].")
    found = []
    for name in names:
        if name in ("speed", "U"):
            raise InputError(f"{where} has {show(name)}, which is measured; a common factor on it is that of the viscosity.")
        if name not in FREE_INPUTS:
            raise InputError(f"{where} has {show(name)}, which cannot be fitted; {advice_on(str(name), FREE_INPUTS)}.")
        if name in found:
            raise InputError(f"{where} has {name} twice; name each input once.")
        found.append(name)
    return tuple(sorted(found, key=FREE_INPUTS.index))


def _names(key: str, value: Any) -> tuple[str, ...]:
    if not isinstance(value, list) or (key == "free" and not value):
        raise InputError(f'{key} = {show(value)} must be a list of inputs, such as ["boundary_friction", "roughness"].')
    return free_names(value, key)


def _entries(key: str, value: Any, read: Entry, inputs: InputTable, above: str) -> Any:
    """Return the entries of a table below another, under the names that are meant."""
    if not isinstance(value, dict):
        raise InputError(f"{key} = {show(value)} must be a table, [{above}.{key}].")
    problems: list[str] = []
    found = {}
    for name, entry in value.items():
        with noted(problems, f"{above}.{key}"):
            meant, found[meant] = read(key, name, entry, inputs)
    if problems:
        raise InputError("\n".join(problems))
    return found


def _column(table: str, name: str, value: Any, inputs: InputTable) -> tuple[str, Any]:
    columns = (each for each in COLUMNS if table == "columns" or each not in ("curve", "run"))
    known = (*columns, *(each for each in CONTACT_INPUTS if each != "boundary_friction"))
    if name not in known:
        unknown(name, value, known)
    texts = value if table == "columns" and name in ("friction", "surface_speeds") and isinstance(value, list) else [value]
    if not texts or not all(isinstance(text, str) and text.strip() for text in texts):
        wanted = "the header of a column" if table == "columns" else "a unit"
        raise InputError(f"{name} = {show(value)} must be {wanted}, as text in quotes.")
    return name, value


def _positive_input(name: str, value: Any, inputs: InputTable) -> float:
    found = inputs.rows[name].checked(value)
    if found <= 0:
        raise InputError(f"{name} = {show(value)} must be positive.")
    return found


def _bounds(table: str, name: str, value: Any, inputs: InputTable) -> tuple[str, tuple[float, float]]:
    [meant] = free_names([name], f"[fit.{table}]")
    return meant, rising_pair(meant, value, lambda each: _positive_input(meant, each, inputs))


def _prior(table: str, name: str, value: Any, inputs: InputTable) -> tuple[str, Prior]:
    [meant] = free_names([name], f"[fit.{table}]")
    if not isinstance(value, dict) or set(value) != {"value", "factor"}:
        raise InputError(f"{meant} = {show(value)} must be a table such as {{ value = ..., factor = 1.2 }}.")
    factor, median = value["factor"], _positive_input(meant, value["value"], inputs)
    if isinstance(factor, bool) or not isinstance(factor, int | float) or not 1 < factor <= MAX_PRIOR_FACTOR:
        raise InputError(f"{meant} has factor = {show(factor)}, which must be a number above 1: 1.2 is 'known within 20 %'.")
    return meant, Prior(median, float(factor))


def _curve(table: str, name: str, entry: Any, inputs: InputTable) -> tuple[str, dict[str, Any]]:
    """Return the inputs of a curve, and its own fluid, solid and so on as the tables of its name have them."""
    if not isinstance(entry, dict):
        raise InputError(f"{name} = {show(entry)} must be a table of inputs, [fit.curves.{name}].")
    model = take_parts({**entry, "contact": {}})
    rest, problems = model.rest, model.problems
    found: dict[str, Any] = {**rest.pop("contact"), **model.parts}
    rows = numbers_of(Parts) | inputs.rows
    known = (*(each for each in inputs.names if each != "speed"), *PART_INPUTS, "slide_to_roll")
    for key, value in rest.items():
        with noted(problems):
            if key not in known:
                unknown(key, value, known)
            if key in found:
                raise InputError(f"{key} = {show(value)} is given beside a preset, which has its own; remove one.")
            found[key] = rows[key].checked(value)
    if problems:
        raise InputError("\n".join(f"{name}: {each}" for each in problems))
    return name, found


def _key(words: str, check: Check | None = None, default: Any = None, *, entry: Entry | None = None) -> Any:
    """Return a field of the settings: what docstrings say of it, and what reads its key, or the entries of its table."""
    made: dict[str, Any] = {"default": default} if entry is None else {"default_factory": dict}
    return field(**made, metadata={"words": words, "check": check, "entry": entry})


def _number(name: str, dimension: str, typical: str) -> Check:
    row = Input(name=name, label=name.replace("_", " "), dimension=dimension, typical=typical)
    return lambda name, value: row.checked(value)


def _file(table: str, name: str, entry: Any, inputs: InputTable) -> tuple[str, dict[str, Any]]:
    """Return what a file or a glob of files has for itself as it is written; :func:`inputs_of_file` reads it."""
    if not isinstance(entry, dict):
        raise InputError(f'{name} = {show(entry)} must be a table of inputs, [fit.files."{name}"].')
    return name, entry


def inputs_of_file(name: str, entry: dict[str, Any], inputs: InputTable, liquid: dict[str, Any]) -> dict[str, Any]:
    """Return the inputs of a file as :func:`_curve` does those of a curve; a temperature gives the viscosity of its liquid."""
    entry = dict(entry)
    if "temperature" in entry:
        fluid = entry.get("fluid", {})
        if "viscosity" in entry:
            raise InputError(f"{name}: viscosity and temperature are both given; remove one of them.")
        known = fluid if isinstance(fluid, dict) and "preset" in fluid else liquid
        if "temperature" not in getattr(PRESETS.get(known.get("preset", "")), "conditions", ()):
            raise InputError(
                f"{name}: temperature = {show(entry['temperature'])} needs a liquid of known viscosity over temperature; "
                'give it as preset in [fluid] of the case, as in preset = "water", or give the viscosity itself.'
            )
        entry["fluid"] = known | {"temperature": entry.pop("temperature")}
    return _curve("files", name, entry, inputs)[1]


def read_pattern(key: str, text: Any) -> FileNames:
    """Return the pattern of file names that a key has, such as ``"{load}_{temperature [degC]}_*.csv"``."""
    if not isinstance(text, str) or not text.strip():
        raise InputError(f'{key} = {show(text)} must be text such as "{{load}}_{{temperature}}_*.csv".')
    names = (*(each for each in LINE.names if each != "speed"), *PART_INPUTS, "slide_to_roll", "temperature", *LABELS)
    parts: list[str] = []
    units: dict[str, str] = {}
    pieces = re.split(r"(\{[^{}]*\}|\*|\?)", text)
    for piece, following in zip(pieces, [*pieces[1:], ""], strict=True):
        found = _PLACEHOLDER.fullmatch(piece)
        if found is None:
            parts.append({"*": ".*?", "?": "."}.get(piece, re.escape(piece)))
            continue
        if found[1] not in names:
            unknown(found[1], piece, names)
        if found[1] in units:
            raise InputError(f"{key} = {show(text)} has {found[1]} twice; name each input once, and write * for the rest.")
        behind = None if found[2] or found[1] in LABELS else _UNIT_IN_NAME.match(following)  # as in {load}N
        units[found[1]] = found[2] or (behind[0] if behind else "")
        parts.append(rf"(?P<{found[1]}>{_NUMBER_IN_NAME if units[found[1]] else '.+?'})")
    if not units:
        raise InputError(f'{key} = {show(text)} names no input; write, for example, "{{load}}_{{temperature}}_*.csv".')
    return FileNames(text, "".join(parts), units)


_PLACEHOLDER = re.compile(r"\{\s*(\w+)\s*(?:\[(.+)\])?\s*\}")

_UNIT_IN_NAME = re.compile(r"[A-Za-zµμ°%]+(?![0-9])")

LABELS = ("fluid", "run")  # What names of files may say beside inputs: names of liquids and repeats

_NUMBER_IN_NAME = r"[-+]?[0-9]+(?:[.,][0-9]+)?"


@dataclass(frozen=True)
class FileNames:
    """What the names of files say: inputs between braces, with the unit where the name leaves it out."""

    text: str  # The pattern as it is written
    regex: str  # The same as a regular expression with a group for each input
    units: dict[str, str]  # Input -> its unit; empty where the name has it

    def values(self, name: str) -> dict[str, Any]:
        """Return the inputs in the name of a file, as text with units or bare numbers."""
        found: dict[str, Any] = {key: text for key, text in self._texts(name).items() if key not in LABELS}
        rows = numbers_of(Parts) | LINE.rows
        bare = {key for key in found if key in rows and not DIMENSIONS[rows[key].dimension].unit}
        return {key: number_or_text(text) if key in bare else text for key, text in found.items()}

    def labels(self, name: str) -> dict[str, str]:
        """Return fluid and run in the name of a file, as far as the pattern has them."""
        return {key: text for key, text in self._texts(name).items() if key in LABELS}

    def _texts(self, name: str) -> dict[str, str]:
        stem = name.rpartition(".")[0] or name
        found = re.fullmatch(self.regex, stem) or re.fullmatch(self.regex, name)
        if found is None:
            raise InputError(f"the name does not follow file_names = {show(self.text)} of [fit]; rename it, or change that.")
        texts = {key: value.replace(",", ".").replace("_", " ").strip() for key, value in found.groupdict().items()}
        return {key: f"{text} {self.units[key]}".strip() for key, text in texts.items()}


@dataclass(frozen=True)
class FitSettings:
    """What the ``[fit]`` table of a case asks for."""

    free: tuple[str, ...] = _key("Inputs to fit; empty for the default, friction coefficient and roughness.", _names, ())
    per_curve: tuple[str, ...] = _key("Those of them that each curve has for itself; the others are shared.", _names, ())
    noise: Noise = _key(
        "Which error of the friction coefficient is alike in all rows, where no errors are given.",
        one_of("relative", "absolute"),
        "relative",
    )
    relative_error: float | None = _key(
        "Known relative standard error of the friction coefficient [-].", _number("relative_error", "number", "0.02")
    )
    absolute_error: float | None = _key(
        "Known absolute standard error of the friction coefficient [-].", _number("absolute_error", "number", "0.01")
    )
    robust: bool = _key("Whether outliers are kept from steering the fit.", TRUTH, False)
    magnitudes: bool = _key(
        "Whether signs of speed and friction are directions of strokes: they are dropped, with rows at rest and reversals.",
        TRUTH,
        False,
    )
    repeats: bool | None = _key(
        "Whether rows at the same speed of a curve are put together, their scatter becoming the error of the mean; by default "
        "where the file numbers its runs.",
        TRUTH,
    )
    run_in: Literal["leave", "keep"] = _key(
        "Whether a first run that differs from the later ones is left out of the means.", one_of("leave", "keep"), "leave"
    )
    header_row: int | None = _key(
        "Row of the data file that holds the names of the columns; the first that is no comment by default.",
        whole(1, 100_000, "the number of a row, counted from 1"),
    )
    sheet: str | None = _key(
        "Sheet of a workbook that holds the data; by default the one with known columns, of several that with most numbers.",
        must(lambda value: isinstance(value, str) and bool(value), "the name of a sheet, as text in quotes"),
    )
    track_radius: float | None = _key(
        "Radius [m] of the track on which a speed of rotation is that of sliding.", _number("track_radius", "length", "20 mm")
    )
    arm: float | None = _key("Arm [m] over which a torque is the friction force.", _number("arm", "length", "20 mm"))
    columns: dict[str, str | list[str]] = _key(
        "What a column is -> its header, or a list of headers for several friction columns.", entry=_column
    )
    units: dict[str, str] = _key("What a column is -> its unit.", entry=_column)
    bounds: dict[str, tuple[float, float]] = _key("Input -> lowest and highest value in SI units.", entry=_bounds)
    priors: dict[str, Prior] = _key("Input -> :class:`Prior`.", entry=_prior)
    per_file: tuple[str, ...] = _key(
        "Inputs that each file has for itself, one for all of its curves, where several files are fitted.", _names, ()
    )
    file_names: FileNames | None = _key(
        'What the names of the data files say, such as ``"{load}_{temperature [degC]}_*.csv"``.', read_pattern
    )
    files: dict[str, dict[str, Any]] = _key(
        "Name of a file, or glob of several -> inputs in which they differ from the case, as they are written.", entry=_file
    )
    curves: dict[str, dict[str, Any]] = _key(
        "Name of a curve -> inputs in SI units in which it differs from the case, and its own fluid or solid.", entry=_curve
    )
    per_decade: float = _key(
        "Bins for a decade of a speed that never rests, of ``[bench]``: friction is nearly straight within a factor of 1.26.",
        default=10.0,
    )
    geometry: str = _key("What was measured: a cylinder, ``line``, or a ball, ``point``.", default="line")
    slide_to_roll: float = _key(
        "Slide-to-roll ratio of the contact: but at 2 and -2 both surfaces move, and a speed may be their mean or their sum.",
        default=PURE_SLIDING,
    )
    liquid: dict[str, Any] = field(
        default_factory=dict,
        compare=False,
        metadata={"words": "The table ``[fluid]`` of a case with a preset, whose viscosity a temperature of a file gives."},
    )
    scales_surface: bool = field(
        default=False,
        compare=False,
        metadata={"words": "Whether a fitted roughness scales a surface as a whole, so that beta follows, as with [surface]."},
    )

    @property
    def ratios(self) -> tuple[float, ...]:
        """The slide-to-roll ratios of the contact and of curves that have their own."""
        entries = (*self.curves.values(), *self.files.values())
        own = [float(each["slide_to_roll"]) for each in entries if each and "slide_to_roll" in each]
        return tuple(dict.fromkeys([self.slide_to_roll, *own]))

    @property
    def rolls(self) -> bool:
        """Whether both surfaces of a curve move."""
        return self.names_have_ratio or any(abs(ratio) != PURE_SLIDING for ratio in self.ratios)

    @property
    def names_have_ratio(self) -> bool:
        """Whether the names of the files say a slide-to-roll ratio."""
        return self.file_names is not None and "slide_to_roll" in self.file_names.units

    @property
    def inputs(self) -> InputTable:
        """The inputs of the contact that was measured, with their units."""
        return INPUT_TABLES[self.geometry]


FitSettings.__doc__ = complete_docstring(
    FitSettings, {each.name: f"{each.type}\n    {each.metadata['words']}" for each in fields(FitSettings)}
)


def settings_of(contact: Contact) -> FitSettings:
    """Return the settings of a fit that asks for nothing, with geometry and motion of what was measured."""
    return FitSettings(geometry=contact.groups.geometry, slide_to_roll=contact.slide_to_roll)


def keys_of_fit(geometry: str, table: str = "fit") -> dict[str, Key]:
    """Return the keys of a ``[fit]`` table, under the name that the table has."""
    keys: dict[str, Key] = {}
    for each in fields(FitSettings):
        if (entry := each.metadata.get("entry")) is not None:
            keys[each.name] = Key(partial(_entries, read=entry, inputs=INPUT_TABLES[geometry], above=table))
        elif (read := each.metadata.get("check")) is not None:
            keys[each.name] = Key(read)
    return keys


def check_fit_table(table: Any, geometry: str = "line", liquid: Any = None) -> FitSettings:
    """Return the settings that a ``[fit]`` table asks for, in a case with a table ``[fluid]``."""
    problems: list[str] = []
    found = read_tables({"fit": table}, {"fit": keys_of_fit(geometry)}, problems).get("fit", {})
    if problems:
        raise InputError("\n".join(problems))
    known = liquid if isinstance(liquid, dict) and "preset" in liquid else {}
    settings = FitSettings(geometry=geometry, liquid=known, **found)
    for key in ("per_curve", "per_file"):
        extra = [name for name in getattr(settings, key) if name not in (settings.free or DEFAULT_FREE)]
        if extra:
            raise InputError(f"[fit] {key} has {extra[0]}, which is not in free; add it there.")
    both = [name for name in settings.per_file if name in settings.per_curve]
    if both:
        raise InputError(f"[fit] has {both[0]} in per_curve and in per_file; choose one.")
    for name, entry in settings.files.items():
        with noted(problems, "fit.files"):
            inputs_of_file(name, entry, settings.inputs, known)
    if problems:
        raise InputError("\n".join(problems))
    return settings


# What both tables say of data files, under the same name.
SHARED = ("columns", "units", "header_row", "sheet", "track_radius", "arm", "run_in", "files")

PER_DECADE = Input(
    name="per_decade", label="bins per decade", dimension="number", typical="10", lowest=1, highest=1000, zero=True
)


def with_bench_keys(settings: FitSettings, given: Mapping[str, Any], table: str = "") -> FitSettings:
    """Return what ``[fit]`` says of data files, with the keys of ``[bench]`` that are given, or its table, in their place."""
    of_fit, problems = keys_of_fit(settings.geometry, "bench"), list[str]()
    keys: Keys = {
        **{name: of_fit[name] for name in SHARED},
        "name": of_fit["file_names"],
        "per_decade": Key(lambda name, value: PER_DECADE.checked(value)),
        "fluid": Key(lambda name, value: _liquid(value)),
        "temperature": AS_GIVEN,
    }
    read = read_tables({table: given.get(table, {})} if table else given, {table: keys}, problems)
    if problems:
        raise InputError("\n".join(problems))
    found = read.get(table, {}) if table else read
    liquid = found.pop("fluid", settings.liquid)
    if "temperature" in found:
        liquid = liquid | {"temperature": found.pop("temperature")}
    if "name" in found:
        found["file_names"] = found.pop("name")
    return replace(settings, liquid=liquid, **found)


def _liquid(fluid: Any) -> dict[str, Any]:
    """Return a liquid and its conditions, as ``iso-vg grade=46`` or a table gives them, as the table ``[fluid]``."""
    if isinstance(fluid, str):
        word, *rest = fluid.split() or [""]
        keys = [each.split("=", 1)[0] for each in rest]
        if not all("=" in each for each in rest) or len({*keys}) < len(keys):
            raise InputError(f"fluid = {show(fluid)}; write a liquid and its conditions, each once, as 'iso-vg grade=46'.")
        given: dict[str, Any] = {
            "preset": word,
            **{key: number_or_text(text) for key, text in (each.split("=", 1) for each in rest)},
        }
    else:
        given = dict(checked_kind("fluid", fluid, Mapping, "text as 'iso-vg grade=46', or a mapping"))
    preset = PRESETS[checked_word("fluid", given.get("preset", ""), tuple(PRESETS))]
    if "temperature" not in preset.conditions:
        raise InputError(
            f"fluid = {show(fluid)} has its viscosity at one temperature only; take a liquid of which more is known."
        )
    preset(**{key: value for key, value in given.items() if key != "preset"})  # refuses what it does not know
    return given
