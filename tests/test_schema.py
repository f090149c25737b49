"""Every number that users give, and every value that it cannot have: the sentence names key, value and what is allowed."""

import functools
import inspect
import json
import math
import re
from pathlib import Path
from typing import Any, NamedTuple

import pytest
from command_line import call
from numpydoc.docscrape import get_doc_object

import stribeck as sb
from stribeck.cases.case import FACTS
from stribeck.cases.law import INPUTS_OF_SURFACES, SURFACE
from stribeck.cases.reading import check_case
from stribeck.contact_laws.greenwood import SUMMITS, GreenwoodTripp
from stribeck.contact_laws.scaled import NAMED_LAWS
from stribeck.contacts.geometries import CONTACTS, INPUT_TABLES
from stribeck.contacts.inputs import read_inputs
from stribeck.contacts.parts import KINDS, Parts
from stribeck.explorer.inputs import choices, inputs
from stribeck.quantities.schema import Series, needed_of, numbers_of
from stribeck.quantities.units import DIMENSIONS

pytestmark = pytest.mark.quick


class Place(NamedTuple):
    """A number where it is given."""

    row: Any
    make: Any  # What takes it in Python
    tables: dict[str, Any]  # Tables of a case without it
    table: str  # That of the number
    field: Any = None  # What the page calls with what is typed


def typical(row):
    return json.loads(row.example)


def needed(law):
    return {name: typical(numbers_of(law)[name]) for name in needed_of(law)}


def kept(geometry):
    """Return a typical contact as Python and case files have it."""
    return {name: typical(row) for name, row in INPUT_TABLES[geometry].kept.items() if not row.optional}


@functools.cache
def choose(choice, value):
    # A stress needs a law that knows the real area.
    shown = choices.choose(start(), "law", "persson") if choice == "asperity_friction" else start()
    return choices.choose(shown, choice, value)


@functools.cache
def start(geometry="line"):
    return inputs.from_case(check_case({"contact": {"geometry": geometry} | kept(geometry)}, Path("a.toml")))


def field(choice, value, key):
    """Return what the page calls for a key of a choice, None where it has no field, or no such choice."""
    if choice not in choices.CHOICES:
        return None
    shown = choose(choice, value)
    fields = [name for name, *_ in choices.list_of(shown, choice)["details"]]
    return functools.partial(choices.with_detail, shown, choice, key) if key in fields else None


def of_contacts():
    for geometry, table in INPUT_TABLES.items():
        for name, row in table.quantities.items():
            given = kept(geometry)
            form = next((form for form in table.forms if name in form.names), None)
            if form is not None:
                others = () if form.joins else {form.of, table.stands_for[name]}
                more = form.second if row in form.second else ()
                given = {key: value for key, value in given.items() if key not in others}
                given |= {each.name: typical(each) for each in (*form.inputs, *more)}
            of_page = functools.partial(inputs.with_text, start(geometry), name) if name in inputs.FIELDS[geometry] else None
            make = functools.partial(
                lambda kind, given, name, value: kind(**given | {name: value}), CONTACTS[geometry], given, name
            )
            yield Place(row, make, {"contact": {"geometry": geometry} | given}, "contact", of_page)


def of_laws():
    for argument, kind in KINDS.items():
        choice = kind.key if kind.key != "model" else {"rheology": "fluid"}.get(argument, argument)
        for name, law in kind.laws.items():
            for key, row in numbers_of(law).items():
                make = functools.partial(lambda law, key, value: law(**needed(law) | {key: value}), law, key)
                tables = {"contact": kept("line"), kind.table: {kind.key: name} | needed(law)}
                yield Place(row, make, tables, kind.table, field(choice, name, key))
    for name, law in NAMED_LAWS.items():
        for key, row in numbers_of(law).items():
            make = functools.partial(lambda law, key, value: law(**needed(law) | {key: value}), law, key)
            yield Place(row, make, {"contact": kept("line") | {"law": name}, "asperities": needed(law)}, "asperities")

    for key, row in SUMMITS.items():
        surface = {name: typical(each) for name, each in SUMMITS.items()}
        make = functools.partial(
            lambda surface, key, value: GreenwoodTripp.coefficients(**surface | {key: value}), surface, key
        )
        contact = {name: value for name, value in kept("line").items() if name not in INPUTS_OF_SURFACES}
        yield Place(row, make, {"contact": contact | {"law": "greenwood-tripp"}, "asperities": surface}, "asperities")


def of_surfaces():
    table = SURFACE
    surface = {"h_rms": "1 um", "hurst": 0.8, "longest_wavelength": "150 um", "shortest_wavelength": "1.5 um"}
    contact = {key: value for key, value in kept("line").items() if key not in INPUTS_OF_SURFACES}
    for key, row in table.quantities.items():
        given = {name: value for name, value in surface.items() if table.stands_for.get(name) != key}
        make = functools.partial(lambda given, key, value: read_inputs(given | {key: value}, SURFACE).checked(), given, key)
        yield Place(
            row, make, {"contact": contact | {"law": "persson"}, "surface": given}, "surface", field("law", "persson", key)
        )


def of_others():
    ready = CONTACTS["line"](**kept("line"))
    for name, row in FACTS.items():
        yield Place(row, lambda value, name=name: sb.check(ready, **{name: value}), {"contact": kept("line")}, "check")
    for name, table, beside, parts, choice in (
        ("cavity_pressure", "cavitation", {"model": "reform"}, {"cavitation": "reform"}, ("cavitation", "reform")),
        ("slide_to_roll", "contact", {}, {}, ("motion", "rolling")),
    ):
        make = functools.partial(lambda name, parts, value: ready.replace(**parts | {name: value}), name, parts)
        tables = {"contact": kept("line")} | ({} if table == "contact" else {table: beside})
        yield Place(numbers_of(Parts)[name], make, tables, table, field(*choice, name))


def wrong(row):
    """Yield values that a number cannot have, each with words of its refusal."""
    low, high = row.range
    if high < math.inf:
        yield high + 1 + abs(high), f"{high:g}" if high else "zero or below"
    if low > -math.inf:
        bound = f"{low:g}" if low or high < math.inf else "positive"
        yield low - 1 - abs(low), bound
        if not row.zero:
            yield low, bound
    yield math.nan, "finite|begin with a number"
    yield True, "single real number"
    yield {"a": 1}, "single real number|table of value and error"
    if DIMENSIONS[row.dimension].unit:
        yield "lots", "does not begin with a number"
        yield "7 K", "expected .* such as|mean turns or radians"
        yield "7", "has no unit; add one"
    else:
        yield "lots", "a number"


@functools.cache
def places():
    return (*of_contacts(), *of_laws(), *of_surfaces(), *of_others())


def faults(say):
    """Return what a face says without key, value or what is allowed; ``say(place, value)`` is None where it cannot ask."""
    found = []
    for place in places():
        for value, allowed in wrong(place.row):
            said = say(place, value)
            shown = f"{value:g}"[:5] if type(value) in (int, float) else repr(value).strip("'{}")
            if said is not None and not (place.row.name in said and shown in said and re.search(allowed, said)):
                found.append(f"[{place.table}] {place.row.name} = {value!r}: {said}")
    return "\n".join(found)


def refusal(call, *given):
    try:
        call(*given)
    except sb.InputError as problem:
        return str(problem)
    return "was taken"


def test_python_refuses_what_a_number_cannot_be():
    assert faults(lambda place, value: refusal(place.make, [value] if isinstance(place.row, Series) else value)) == ""


def test_a_file_and_the_command_refuse_what_a_number_cannot_be(tmp_path, capsys):
    path, called = tmp_path / "case.toml", set()

    def text(value):
        if isinstance(value, list):
            return f"[{', '.join(map(text, value))}]"
        if isinstance(value, dict):
            return f"{{ {', '.join(f'{key} = {text(each)}' for key, each in value.items())} }}"
        return json.dumps(value).replace("NaN", "nan")

    def say(place, value):
        tables = place.tables | {place.table: place.tables.get(place.table, {}) | {place.row.name: value}}
        if isinstance(place.row, Series):
            tables[place.table][place.row.name] = [value]
        lines = [
            f"[{name}]\n" + "\n".join(f"{key} = {text(each)}" for key, each in table.items()) for name, table in tables.items()
        ]
        path.write_text("\n".join(lines))
        said = refusal(sb.load_case, path)
        if value is True and place.table not in called:  # the command says what the file does
            called.add(place.table)
            answer = call(capsys, "solve", path)
            assert (answer.code, answer.out) == (2, "")
            assert answer.err == "".join(f"stribeck: {line}\n" for line in said.splitlines())
        return said if f"[{place.table}] " in said else f"not in its table: {said}"

    assert faults(say) == ""


def test_the_page_refuses_what_a_number_cannot_be():
    def say(place, value):
        if place.field is None or isinstance(value, bool | dict) or value == "7":  # which has the unit of its field
            return None
        return refusal(place.field, str(value))

    assert faults(say) == ""


def test_the_docstring_of_a_law_says_each_of_its_arguments():
    laws = {law for kind in KINDS.values() for law in kind.laws.values()} | set(NAMED_LAWS.values())
    laws = [law for law in laws if numbers_of(law)]
    assert len(laws) >= 15
    for law in laws:
        said = get_doc_object(law)
        assert [each.name for each in said["Parameters"]] == list(inspect.signature(law).parameters), law
        assert all("".join(each.desc) for each in said["Parameters"]) and said["Raises"], law
