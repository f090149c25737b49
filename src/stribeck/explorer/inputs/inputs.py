"""The inputs of a tab: one case, whose tables are its form, its address, its saved file and each step of undo and redo.

The fields are the rows of the package's tables of inputs. Every change makes new inputs from old ones, or raises the sentence
that the command line prints; nothing is half changed.
"""

from __future__ import annotations

import functools
import json
import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from decimal import Context
from fractions import Fraction
from pathlib import Path
from typing import Any, Literal, Self

from stribeck.cases.case import Case
from stribeck.cases.law import ERRORS_OF_SURFACES, INPUTS_OF_SURFACES, self_contained
from stribeck.cases.model_parts import FILES, SOURCES_OF_VISCOSITY, fluid_table, gives_modulus, take_parts
from stribeck.cases.reading import check_case
from stribeck.contact_laws.scaled import NAMED_LAWS
from stribeck.contacts.contact import Contact
from stribeck.contacts.forms import FORMS
from stribeck.contacts.geometries import CONTACTS, INPUT_TABLES
from stribeck.contacts.groups import GROUP_INPUTS
from stribeck.contacts.inputs import InputTable
from stribeck.contacts.parts import PURE_SLIDING
from stribeck.explorer.inputs.typed import entries_of, examples, with_point
from stribeck.fluids.description import Liquid
from stribeck.quantities.formats import format_si
from stribeck.quantities.schema import Input
from stribeck.quantities.standard_errors import StandardErrors
from stribeck.quantities.units import DIMENSIONS, InputError, read_number, show, to_si

Abscissa = Literal["speed", "hersey"]

FRICTION = "boundary_friction"
MAX_FRICTION = 10.0  # Friction coefficient above which the value is probably in per cent.

FIRST_FIELDS = ("speed", "load", "viscosity", "roughness")  # Inputs that are changed most often, shown first.

FIELDS: dict[str, dict[str, Input]] = {
    geometry: {name: table.quantities[name] for name in dict.fromkeys((*FIRST_FIELDS, *table.names))}
    for geometry, table in INPUT_TABLES.items()
}
"""The inputs of each geometry, those changed most often first."""

GROUP_FIELDS = {f"{name}_group": row for name, row in GROUP_INPUTS.items()}
"""The groups: moving one moves speed, load and roughness so that the other two stay."""

GREEK = {"eta": "η", "alpha": "α", "beta": "β", "mu": "µ"}

SLIDER_DIGITS = 3  # Digits to which a slider rounds, so that its value can be read and typed.

SETTINGS = ("definition", "rtol")  # Keys of the table [solver]

CASE = Path("case")  # What the case of a page is called in sentences
_UNIT = re.compile(r"[-+\N{MINUS SIGN}0-9.]+([eE][-+]?[0-9]+)?\s*([^+±]*?)\s*(?:(?:\+\s*/?\s*-|±).*)?", re.DOTALL)


@dataclass(frozen=True)
class Inputs:
    """What a tab shows: a case, and what its curve is drawn over."""

    text: str  # The tables of the case as JSON, which compares by value
    abscissa: Abscissa = "speed"

    @classmethod
    def of(cls, tables: Mapping[str, Any], abscissa: Abscissa = "speed") -> Self:
        """Return the inputs of tables; what is empty or as without it is left out."""
        kept = {name: table for name, table in tables.items() if table not in ({}, "")}
        usual = {"geometry": "line", "law": "exponential"}
        if isinstance(kept.get("contact"), dict):
            kept["contact"] = {key: value for key, value in kept["contact"].items() if usual.get(key) != value}
        made = cls(json.dumps(kept, sort_keys=True, separators=(",", ":"), ensure_ascii=False), abscissa)
        friction = getattr(made.contact, FRICTION, None) or 0.0  # none where asperities rub by a shear stress
        if friction > MAX_FRICTION:
            raise InputError(
                f"{FRICTION} = {friction:g} is above {MAX_FRICTION:g}, the largest the explorer takes; "
                f"write {friction / 100:g} for {friction:g} %."
            )
        return made

    @property
    def tables(self) -> dict[str, Any]:
        """The tables of the case, those of ``[contact]`` in the order of the fields; the caller may change them."""
        found: dict[str, Any] = json.loads(self.text)
        contact, order = found.pop("contact"), ["geometry", "law", *FIELDS["point"]]
        names = sorted(contact, key=lambda name: order.index(name) if name in order else len(order))
        head = {name: found.pop(name) for name in ("title", "notes") if name in found}
        return head | {"contact": {name: contact[name] for name in names}} | found

    @property
    def case(self) -> Case:
        """The case, checked."""
        return _case_of(self.text)

    @property
    def contact(self) -> Contact:
        """The contact."""
        return self.case.contact

    @property
    def known(self) -> tuple[Any, ...]:
        """What is known beside the contact: errors of inputs with their correlations, and facts."""
        errors = self.case.errors
        return tuple(errors.items()), tuple(errors.correlations.items()), tuple(self.case.facts.items())

    @property
    def table(self) -> InputTable:
        """The table of its inputs."""
        return self.contact.INPUTS

    @property
    def fields(self) -> dict[str, Input]:
        """Its inputs by name."""
        return FIELDS[self.table.geometry]

    @property
    def units(self) -> dict[str, str]:
        """The unit of each field that has one: that in which the case gives it, else the one in which it reads best."""
        return _units_of(self.text)

    def replace(self, **changes: Any) -> Inputs:
        """Return the inputs with another title, abscissa, definition or tolerance, or with other inputs of the contact."""
        tables = self.tables
        abscissa = changes.pop("abscissa", self.abscissa)
        tables |= {name: changes.pop(name) for name in ("title", "notes") if name in changes}
        settings = {name: changes.pop(name) for name in SETTINGS if name in changes}
        tables["solver"] = tables.get("solver", {}) | settings
        return replace(self.edited(changes, tables), abscissa=abscissa)

    def edited(
        self,
        entries: Mapping[str, str | float | None],
        tables: dict[str, Any] | None = None,
        errors: StandardErrors | None = None,
    ) -> Inputs:
        """Return the inputs with other inputs of the contact, which keep their units and errors, and with other tables."""
        tables = self.tables if tables is None else tables
        contact = tables["contact"] = dict(tables["contact"])
        known, errors = INPUT_TABLES[contact.get("geometry", "line")], self.case.errors | (errors or {})
        rolls = False
        if known.geometry == "point":
            ratio = entries.get("slide_to_roll", contact.get("slide_to_roll"))
            rolls = ratio is not None and float(ratio) != PURE_SLIDING
            # Of a ball and a disc that both move a case has the mean of their speeds.
            if "speed" not in entries and rolls == ("speed" in contact):
                entries = {**entries, "speed": float(self.contact.speed)}
        joined = {name for form in known.forms if form.joins for name in form.names}
        for name, entry in entries.items():
            of_same = known.stands_for.get(name, name)
            for key in [key for key in contact if known.stands_for.get(key, key) == of_same and name not in joined]:
                if key == name or key not in entries:
                    del contact[key]
            if entry is None:
                continue
            row = known.quantities[name]
            value = row.checked(entry)
            of = 0.5 if name == "speed" and rolls else 1.0
            if row.units and (of != 1.0 or not isinstance(entry, str)):
                kept = name in self.fields and self.fields[name].dimension == row.dimension
                unit = self.units[name] if kept else _best_unit(value, row)
                entry = exact_text(of * value, row.dimension, unit)
            contact["entrainment_speed" if of != 1.0 else name] = _with_error(entry, errors.get(name) if value else None)
        tables.pop("correlations", None)
        uncertain = StandardErrors(type(self).of(tables).case.errors)
        uncertain.correlations = {pair: each for pair, each in errors.correlations.items() if pair <= uncertain.keys()}
        return type(self).of(tables | {"correlations": uncertain.nested}, self.abscissa)


def _best_unit(value: float, row: Input) -> str:
    """Return the unit in which a value reads best."""
    return format_si(value, row.dimension).partition(" ")[2]


@functools.lru_cache(maxsize=64)
def _case_of(text: str) -> Case:
    """Return the case of tables, or the sentences of the command line about it."""
    try:
        return check_case(json.loads(text), CASE)
    except InputError as problem:
        lines = [line.removeprefix(f"{CASE}: ").removeprefix("[contact] ") for line in str(problem).splitlines()]
        raise InputError("\n".join(lines)) from None


@functools.lru_cache(maxsize=64)
def _units_of(text: str) -> dict[str, str]:
    contact = _case_of(text).contact
    table, found = contact.INPUTS, {}
    for name, row in FIELDS[table.geometry].items():
        if row.units:
            value = getattr(contact, name)
            found[name] = row.units[0] if value is None else _best_unit(value, row)
    for key, entry in json.loads(text)["contact"].items():
        name = table.stands_for.get(key, key)
        if name in found and table.quantities[key].dimension == table.quantities[name].dimension:
            given = _UNIT.fullmatch(entry.strip()) if isinstance(entry, str) else None
            if given is not None and given[2]:
                found[name] = _known_unit(table.quantities[name], given[2])
    return found


def _known_unit(row: Input, unit: str) -> str:
    return next((known for known in row.units if known.replace("µ", "u") == unit), unit)


def from_case(case: Case) -> Inputs:
    """Return the inputs of a case, with the numbers of files, surfaces and presets that it names."""
    tables = {name: dict(table) if isinstance(table, dict) else table for name, table in case.tables.items()}
    contact = tables["contact"]
    tables |= self_contained(case.law, case.tables, case.path.parent, case.contact.law)
    own: list[str] = []
    if "surface" in tables or hasattr(NAMED_LAWS.get(case.law), "coefficients"):
        tables.pop("asperities", None)
        stands_for = case.contact.INPUTS.stands_for
        own += [name for name in INPUTS_OF_SURFACES if all(stands_for.get(key, key) != name for key in contact)]
    if "surface" in tables:
        rough = {} if "wavenumber" in tables["surface"] else {"h_rms": exact_text(case.contact.roughness, "length", "um")}
        shape = {key: value for key, value in tables["surface"].items() if key not in ERRORS_OF_SURFACES}
        tables["surface"] = rough | shape | {"shape_only": True}
        tables["correlations"] = case.errors.nested  # with those of beta, which follows the height of a whole surface alone
    if not SOURCES_OF_VISCOSITY.keys().isdisjoint(tables.get("fluid", {})):
        tables["fluid"] = fluid_table(case.contact.fluid)
        tables["check"] = {**take_parts(case.tables).facts, **tables.get("check", {})}
        own.append("viscosity")
    if "master_curve" in tables.get("solid", {}):
        series = {name: list(getattr(case.contact.solid, name)) for name in ("relaxation_times", "moduli")}
        tables["solid"] = {key: value for key, value in tables["solid"].items() if key != "master_curve"} | series
        own += [] if gives_modulus(contact) else ["modulus"]
    if isinstance(tables.get("profile", {}).get("x"), str):
        tables["profile"] |= {name: list(getattr(case.contact.profile, name)) for name in ("x", "z")}
    for name in own:
        row, value = case.contact.INPUTS.quantities[name], float(getattr(case.contact, name))
        entry = exact_text(value, row.dimension, _best_unit(value, row)) if row.units else value
        contact[name] = _with_error(entry, case.errors.get(name))
    return Inputs.of(tables)


def _with_error(entry: str | float, error: float | None) -> str | float:
    """Return an entry of a case with the standard error over its value."""
    return entry if error is None else f"{entry} +- {100 * error!r} %"


def with_liquid(inputs: Inputs, liquid: Liquid) -> Inputs:
    """Return the inputs with a liquid: its viscosity, and how that changes."""
    return inputs.edited({"viscosity": liquid.viscosity}, inputs.tables | {"fluid": fluid_table(liquid.fluid)})


def refuse_files(tables: Mapping[str, Any], instead: str) -> None:
    """Refuse tables that name files, which did not come with them; ``instead`` is what to do."""
    for name, key in FILES:
        table = tables.get(name)
        if isinstance(table, dict) and isinstance(table.get(key), str):
            raise InputError(f"[{name}] {key} = {show(table[key])} is a file that the browser did not send; {instead}.")


def value_of(inputs: Inputs, name: str) -> float:
    """Return a quantity in SI units, or a group; infinite if the contact does without it."""
    if name in GROUP_FIELDS:
        return float(getattr(inputs.contact.groups, name.removesuffix("_group")))
    value = getattr(inputs.contact, name, None)
    return math.inf if value is None else float(value)


def with_text(inputs: Inputs, name: str, text: str) -> Inputs:
    """Return the inputs after ``text`` was typed into a field."""
    text = with_point(name, text.strip())
    if name in GROUP_FIELDS:
        return _with_group(inputs, name, read_number(name, _present(name, text)))
    row = inputs.fields[name]
    if not text and row.optional:
        return inputs.edited({name: None})
    _present(name, text)
    if not row.units:
        return inputs.edited({name: read_number(name, text)})
    unit = inputs.units[name]
    try:
        float(text)
        text = f"{text} {unit}"
    except ValueError:
        found = entries_of(inputs.table, name, text)
        if found is not None:
            try:
                return inputs.edited(found)
            except InputError as problem:
                missing = str(problem).partition(" is missing")[0]
                together = any(missing in form.names and form.names[0] in found for form in FORMS)
                raise InputError(f"{problem}{' Type both, with a comma between them.' if together else ''}") from None
    try:
        row.checked(text)
    except InputError as problem:
        bare = "or a bare number in {}.".format
        raise InputError(str(problem).replace(bare(DIMENSIONS[row.dimension].unit), bare(unit))) from None
    given = _UNIT.fullmatch(text)
    typed = text if given is None else text.removesuffix(given[2]) + _known_unit(row, given[2])
    return inputs.edited({name: typed})


def with_slider(inputs: Inputs, name: str, place: float) -> Inputs:
    """Return the inputs after a slider was moved to ``place``, the logarithm to base ten of its value in SI units."""
    low, high = _row(inputs, name).usual
    value = float(f"{min(max(10.0**place, low), high) / _factor(inputs, name):.{SLIDER_DIGITS}g}")
    return with_text(inputs, name, repr(value))


def in_unit(inputs: Inputs, name: str, unit: str) -> Inputs:
    """Return the inputs with a field shown in another unit, its value kept."""
    value = getattr(inputs.contact, name, None)
    return inputs if value is None else inputs.edited({name: exact_text(value, inputs.fields[name].dimension, unit)})


def position(inputs: Inputs, name: str) -> float:
    """Return where the slider of a quantity stands: the logarithm to base ten of its value, at the ends where it is beyond."""
    low, high = _row(inputs, name).usual
    return math.log10(min(max(value_of(inputs, name), low), high))


def number_text(inputs: Inputs, name: str) -> str:
    """Return the number that stands in a field, in its unit."""
    value = value_of(inputs, name)
    return "" if math.isinf(value) else f"{value / _factor(inputs, name):.4g}"


def row_of(inputs: Inputs, name: str) -> dict[str, Any]:
    """Return what field, unit and slider of a quantity show."""
    row, unit = _row(inputs, name), inputs.units.get(name, "")
    symbol = re.sub(r"\\(eta|alpha|beta|mu)", lambda found: GREEK[found[1]], row.symbol.strip("$"))
    letter, _, index = re.sub(r"\\mathrm|[{}]", "", symbol).replace("^*", "*").partition("_")
    return {
        "name": name,
        "label": row.label[0].upper() + row.label[1:],
        "help": help_of(name, inputs.table.geometry),
        "note": " ".join(_conversions(inputs, name)).replace("*", "·"),
        "symbol": letter + (f"<sub>{index}</sub>" if index else ""),
        "ends": [math.log10(end) for end in row.usual],
        "text": number_text(inputs, name),
        "unit": unit,
        "units": list(dict.fromkeys((*row.units, unit))) if unit else [],
        "place": round(position(inputs, name), 4),
    }


# What inputs do whose names say little.
ROLES = {
    "alpha": "At a gap h asperities press with beta E* exp(-alpha h/h_rms): alpha says how fast they lose touch as it opens.",
    "beta": "At a gap h asperities press with beta E* exp(-alpha h/h_rms): beta says how hard, the least certain input.",
    "boundary_friction": "The friction where asperities carry the whole load.",
    "roughness": "The rms height Rq of both surfaces together.",
    "speed_group": "The thicker the film beside the Hertz indentation, the larger.",
    "load_group": "Above 1 the Hertz pressure exceeds beta E*, the pressure of asperities at zero gap.",
    "roughness_group": "At a given load group, the rougher the surfaces beside the Hertz indentation, the larger.",
}


@functools.cache
def help_of(name: str, geometry: str) -> str:
    """Return what an input is, what it does, and how else it may be typed."""
    row, table = GROUP_FIELDS.get(name) or FIELDS[geometry][name], INPUT_TABLES[geometry]
    role = next(
        (f"It is {form.meaning.removeprefix('which is ')}." for form in table.forms if form.meaning and form.of == name), ""
    )
    also = "" if name in GROUP_FIELDS else "; ".join(examples(table, name))
    return " ".join(filter(None, (plain_words(row), role or ROLES.get(name), also and f"It may also be typed as {also}.")))


def plain_words(row: Input) -> str:
    """Return what a row says of itself, without formulas."""
    return re.sub(r", :math:`[^`]*`| \[-\]", "", row.description)


def _conversions(inputs: Inputs, name: str) -> list[str]:
    """Return the sentences on what an input was converted from."""
    table, given = inputs.table, inputs.tables["contact"]
    said = [each for each in inputs.case.conversions if table.stands_for.get(first := each.partition(" ")[0], first) == name]
    others = [f"{table.quantities[key].label} {given[key]}" for key in given if table.stands_for.get(key) == name]
    return said or ([f"From {', '.join(others)}."] if others else [])


def exact_text(value: float, dimension: str, unit: str = "") -> str:
    """Return the shortest text in a unit that gives back the very value in SI units."""
    if unit:
        # Through exact numbers, because the quotient of two doubles may not lead back in any number of digits.
        quotient = Fraction(value) / Fraction(repr(_unit_factor(dimension, unit)))
        for digits in range(3, 30):
            number = Context(prec=digits).divide(quotient.numerator, quotient.denominator).normalize()
            text = f"{number:f} {unit}" if -6 < number.adjusted() < 16 else f"{number} {unit}"
            if to_si(text, dimension, dimension) == value:
                return text
    return f"{value!r} {DIMENSIONS[dimension].unit}".rstrip()


def _row(inputs: Inputs, name: str) -> Input:
    """Return the row of a quantity or a group."""
    return GROUP_FIELDS.get(name) or inputs.fields[name]


def _with_group(inputs: Inputs, name: str, value: float) -> Inputs:
    contact, moved = inputs.contact, ("load", "speed", "roughness")
    change: dict[str, Any] = {name.removesuffix("_group"): value}
    groups = replace(contact.groups, **change)
    kept = {key: each for key, each in contact.inputs() if key not in moved}
    found = CONTACTS[inputs.table.geometry].from_groups(groups, **kept, asperity_friction=contact.asperity_friction)
    return inputs.edited({key: getattr(found, key) for key in moved})


def _present(name: str, text: str) -> str:
    """Return the text of a field that must hold a number."""
    if not text:
        raise InputError(f"{name} is empty; type a number, or press Escape for the one before.")
    return text


def _factor(inputs: Inputs, name: str) -> float:
    unit = inputs.units.get(name)
    return 1.0 if unit is None else _unit_factor(inputs.fields[name].dimension, unit)


@functools.lru_cache(maxsize=1000)
def _unit_factor(dimension: str, unit: str) -> float:
    return to_si(f"1 {unit}", dimension, "unit")


MAX_STEPS = 100  # Steps of undo that are kept.


class History:
    """What a page has shown at rest, and where in it the page is."""

    def __init__(self, start: Inputs) -> None:
        self.states = [start]
        self.place = 0

    def rest(self, now: Inputs) -> None:
        """Take inputs that have come to rest; what was undone before is then gone, unless these are the same."""
        if now == self.states[self.place]:
            return
        self.states = [*self.states[: self.place + 1], now][-MAX_STEPS:]
        self.place = len(self.states) - 1

    def step(self, way: int, now: Inputs) -> Inputs | None:
        """Return the inputs one step back or forth, or None if there are none."""
        self.rest(now)
        if not 0 <= self.place + way < len(self.states):
            return None
        self.place += way
        return self.states[self.place]

    @property
    def steps(self) -> dict[str, bool]:
        """Whether there is something to undo and to redo."""
        return {"undo": self.place > 0, "redo": self.place < len(self.states) - 1}
