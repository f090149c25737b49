"""The inputs of the contacts of a geometry: what they keep, what may stand in its place, usual errors, and their reading."""

import inspect
import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from typing import Any

from stribeck.contacts.forms import Form
from stribeck.contacts.groups import SCALINGS, Geometry
from stribeck.contacts.parts import PART_INPUTS, Parts
from stribeck.quantities.formats import format_percent, format_si
from stribeck.quantities.keywords import known_names
from stribeck.quantities.lazy import cached_property
from stribeck.quantities.schema import Input, numbers_of, split_error
from stribeck.quantities.units import DIMENSIONS, InputError, show

_UNCHANGED = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class InputTable:
    """The inputs of the contacts of one geometry, or of another class that declares some."""

    kind: Any  # The class of the contacts, which declares those that it keeps
    forms: tuple[Form, ...]  # What may be given in the place of some of them
    geometry: Geometry = "line"

    @cached_property
    def kept(self) -> dict[str, Input]:
        """The inputs that a contact keeps, in the order in which outputs name them."""
        rows, classes = numbers_of(self.kind), [each for each in reversed(self.kind.__mro__) if not issubclass(Parts, each)]
        return {name: rows[name] for each in classes for name in inspect.get_annotations(each) if name in rows}

    @cached_property
    def quantities(self) -> dict[str, Input]:
        """All inputs by name."""
        return self.kept | {each.name: each for form in self.forms for each in (*form.inputs, *form.second)}

    @cached_property
    def rows(self) -> dict[str, Input]:
        """All inputs by name, numbers of laws among them."""
        return {**self.quantities, **PART_INPUTS}

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of the inputs that a contact keeps."""
        return tuple(self.kept)

    @cached_property
    def exponents(self) -> dict[str, tuple[float, float, float]]:
        """Exponents with which each input enters the groups of speed, load and roughness."""
        known = SCALINGS[self.geometry].exponents
        return {name: known.get(name, _UNCHANGED) for name in self.kept}

    @cached_property
    def choices(self) -> frozenset[str]:
        """Inputs that need not be given."""
        needed = {name for name, row in self.kept.items() if not row.optional}
        return frozenset(self.quantities.keys() - needed).union(form.of for form in self.forms if form.meaning)

    @cached_property
    def stands_for(self) -> dict[str, str]:
        """The input that a contact keeps, for each that may stand in its place."""
        found: dict[str, str] = {}
        for form in reversed(self.forms):
            found |= dict.fromkeys(form.names, found.get(form.of, form.of))
        return found

    def parameters(self) -> list[inspect.Parameter]:
        """Return the inputs as arguments of a contact."""
        default = {name: self.quantities[name].default for name in self.choices}
        return [
            inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=default.get(name, inspect.Parameter.empty))
            for name in self.quantities
        ]

    def arguments(self) -> dict[str, str]:
        """Return what a docstring says of each of them."""
        found, meanings = {}, {form.of: form.meaning.removeprefix("which is ") for form in self.forms if form.meaning}
        for name, row in self.quantities.items():
            kind = f"{'str or ' if DIMENSIONS[row.dimension].unit else ''}float{', optional' if name in self.choices else ''}"
            means = f"  It is {meanings[name]}." if name in meanings else ""
            follows = f"  ``{self.stands_for[name]}`` follows from it." if name in self.stands_for else ""
            found[name] = f"{kind}\n    {row.description}{means}{follows}"
        return found

    def text(self, name: str, value: float, digits: int = 4) -> str:
        """Return an input with its unit."""
        return format_si(value, self.quantities[name].dimension, digits).replace("*", "·")


@dataclass
class ReadInputs:
    """Inputs as they are read: by name in SI units, with what is known and what is wrong."""

    given: dict[str, float] = field(default_factory=dict)  # Under the names under which they were given
    values: dict[str, float] = field(default_factory=dict)  # Under those that a contact keeps
    errors: dict[str, dict[str, float]] = field(default_factory=dict)  # Over the values, by their independent sources
    sentences: list[str] = field(default_factory=list)  # One for each form whose formula is said
    problems: list[str] = field(default_factory=list)

    def checked(self) -> dict[str, float]:
        """Return the inputs, or refuse what is wrong with them."""
        if self.problems:
            raise InputError("\n".join(self.problems))
        return self.values


def read_inputs(
    given: Mapping[str, Any], table: InputTable, elsewhere: Collection[str] = (), has_errors: bool = False
) -> ReadInputs:
    """Return the inputs that a contact keeps; some may be given ``elsewhere``, and with ``has_errors`` each carry its own."""
    found = ReadInputs()
    for name, value in given.items():
        if name not in table.quantities:
            known = known_names(name, table.quantities)
            found.problems.append(f"{name} = {show(value)} is not an input of {table.kind.__name__}; {known}")
            continue
        if value is None and name in table.choices:
            continue
        row = table.quantities[name]
        try:
            if has_errors:
                value, error = split_error(name, value, row.dimension, row.typical)
                found.errors |= {} if error is None else {name: {name: error}}
            found.values[name] = row.checked(value)
        except InputError as problem:
            found.problems.append(str(problem))
            found.values[name] = row.typical_value  # stands for it, so that nothing else is said of it
    found.given = dict(found.values)
    apply_forms(found, given, table)
    note_missing(found, table, elsewhere)
    return found


def apply_forms(found: ReadInputs, given: Mapping[str, Any], table: InputTable) -> None:
    """Put inputs that a contact keeps in the place of those from which they follow, as ``given`` shows them to people."""
    for form in table.forms:
        if not any(name in found.values for name in form.names):
            continue
        try:
            _apply(form, found, given, table)
        except InputError as problem:
            found.problems.append(str(problem))
            found.values.setdefault(form.of, table.quantities[form.of].typical_value)
            found.values = {name: value for name, value in found.values.items() if name not in form.names}
            found.values |= {name: value for name, value in form.assumed.items() if name not in found.values}


def note_missing(found: ReadInputs, table: InputTable, elsewhere: Collection[str] = ()) -> None:
    """Note those inputs that neither stand there nor follow, nor are given elsewhere."""
    for form in table.forms:
        if form.meaning and form.of not in (*found.values, *elsewhere):
            together = " together" if len(form.inputs) > 1 else ""
            instead = " and ".join(each.name for each in form.inputs)
            found.problems.append(f"{form.of} ({form.meaning}) is missing; give it, or {instead}{together}.")
            found.values[form.of] = table.quantities[form.of].typical_value
    for name, row in table.kept.items():
        if not row.optional and name not in (*found.values, *elsewhere):
            found.problems.append(f"{name} is missing; {row.advice}.")


def check_motion(given: Mapping[str, Any], table: InputTable) -> None:
    """Refuse the speed of one surface where both move."""
    speed, ratio, row = given.get("speed"), given.get("slide_to_roll"), table.kept.get("slide_to_roll")
    if speed is not None and ratio is not None and row is not None and row.checked(ratio) != row.default:
        raise InputError(
            f"speed = {show(speed)} is the sliding speed over a surface at rest, slide_to_roll 2, but slide_to_roll = "
            f"{show(ratio)}; give the mean of both surface speeds as entrainment_speed instead."
        )


def _apply(form: Form, found: ReadInputs, given: Mapping[str, Any], table: InputTable) -> None:
    """Replace the inputs of a form by its result."""
    values, errors = found.values, found.errors
    _check(form, values, given, table)
    names = [*([form.of] if form.joins else []), *(name for name in form.names if name in values)]
    shown = " and ".join(f"{name} = {_shown(name, values, given)}" for name in names)
    numbers = [*(values[name] for name in form.uses), *(values.pop(name) for name in names)]
    own = [*(errors.get(name, {}) for name in form.uses), *(errors.pop(name, {}) for name in names)]
    values[form.of] = form.value(*numbers)
    brought = {form.formula: form.error} if form.error else {}
    for i, sources in enumerate(own):
        slope = _slope(form, numbers, i) if sources else 0.0
        for source, error in sources.items():
            brought[source] = brought.get(source, 0.0) + slope * error
    errors |= {form.of: brought} if brought else {}
    assumed = {name: value for name, value in form.assumed.items() if name not in values}
    values |= assumed
    if form.formula:
        about = f", known to about {100 * form.error:.0f} %" if form.error else ""
        besides = "".join(f", {name} = {value:g} assumed" for name, value in assumed.items())
        made = f"{form.of} = {format_si(values[form.of], table.quantities[form.of].dimension, 4)} from {shown}"
        found.sentences.append(f"{made}: {form.formula} ({form.source}{about}){besides}.")


def _check(form: Form, values: Mapping[str, float], given: Mapping[str, Any], table: InputTable) -> None:
    """Refuse a form that is given in part, or beside the input that follows from it."""
    about = f" ({form.meaning})" if form.meaning else ""
    there = [f"{name} = {_shown(name, values, given)}" for name in form.names if name in values]
    if form.joins and form.of not in values:
        raise InputError(f"{form.names[0]} is given without {form.of}; give both, as a contact keeps only their combination.")
    if form.of in values and not form.joins:
        shown, instead = _shown(form.of, values, given), " and ".join(each.name for each in form.inputs)
        raise InputError(
            f"{form.of} = {shown}{about} and {' and '.join(there)} are both given; give either {form.of}, or {instead}."
        )
    others = form.second if any(each.name in values for each in form.second) else ()
    missing = [each for each in (*form.inputs, *others) if each.name not in values]
    missing += [table.quantities[name] for name in form.uses if name not in values]
    if missing:
        alone = "" if form.joins else f", or give {form.of}{about} alone"
        raise InputError(f"{missing[0].name} is missing beside {' and '.join(there)}; {missing[0].advice}{alone}.")


def _shown(name: str, values: Mapping[str, float], given: Mapping[str, Any]) -> str:
    """Return a value as it was given, ``{ value, error }`` as people write it."""
    value = values[name] if given.get(name) is None else given[name]
    if isinstance(value, Mapping) and value.keys() == {"value", "error"}:
        return show(f"{value['value']} +- {value['error']}")
    return show(value)


def _slope(form: Form, numbers: list[float], i: int) -> float:
    """Return d ln(result)/d ln(input)."""
    step = 1e-4
    ahead, behind = ([each * math.exp(sign * step * (k == i)) for k, each in enumerate(numbers)] for sign in (1, -1))
    return (math.log(form.value(*ahead)) - math.log(form.value(*behind))) / (2 * step)


def follows_surface(contact: Any, errors: Collection[str]) -> bool:
    """Return whether beta moves with an uncertain roughness, as under Persson's law."""
    return "roughness" in errors and "beta" not in errors and contact.law is not None and contact.law.name == "persson"


def typical_errors(contact: Any, known: Collection[str]) -> dict[str, float]:
    """Return the usual standard error over the value of each input that has none."""
    rows = {name: row for name, row in contact.INPUTS.rows.items() if row.typical_error and name not in known}
    found = {name: row.typical_error for name, row in rows.items() if getattr(contact, name, None)}
    if hasattr(contact.law, "fixed_alpha"):
        found.pop("alpha", None)
    if follows_surface(contact, {*known, *found} - {"beta"}):
        found.pop("beta", None)
    return found


def typical_error_text(contact: Any, errors: Mapping[str, float]) -> tuple[str, ...]:
    """Return which errors are usual ones, in a sentence; nothing where none is."""
    rows = contact.INPUTS.rows
    named = ", ".join(f"{rows[name].label} {format_percent(error)}" for name, error in errors.items())
    return (f"usual errors where none is given: {named}.",) if named else ()
