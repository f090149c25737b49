"""What the tables of a case file may hold, for pydantic, and the sentences for what it refuses."""

import functools
from types import SimpleNamespace
from typing import Annotated, Any, Literal

from stribeck.cases.case import DEFAULT_POINTS_AND_RTOL, Axis, Case, CurveSettings, curve_range
from stribeck.cases.law import ASPERITY_KEYS, INPUTS_OF_SURFACES, LAWS, SURFACE_KEYS, TABLE_KEYS
from stribeck.contacts.friction import Definition
from stribeck.quantities.conversions import GIVEN
from stribeck.quantities.facts import FACTS
from stribeck.quantities.hints import MEANT, OTHER_SOURCES, advice_on
from stribeck.quantities.inputs import INPUT_TABLES, LINE, InputTable, quantity
from stribeck.quantities.units import DIMENSIONS, show

__all__ = ["error_sentence", "example_of", "file_model", "optional_table", "shared_types"]


@functools.cache
def optional_table(name: str, keys: tuple[str, ...]) -> Any:
    """Return the type and the default of a table with optional keys, which its own reader checks, for a pydantic model."""
    from pydantic import ConfigDict, Field, create_model

    fields: dict[str, Any] = dict.fromkeys(keys, (Any, None))
    table = create_model("_".join(keys), __config__=ConfigDict(extra="forbid"), **fields)
    return Annotated[table, Field(description=f"a table, [{name}]")], None


@functools.cache
def shared_types() -> SimpleNamespace:
    """Return what the pydantic models of cases and sweeps share, made on first use because pydantic is slow to import."""
    from pydantic import BaseModel, ConfigDict, Field

    class Table(BaseModel):
        model_config = ConfigDict(extra="forbid")

    # A description completes the sentence "... must be ..." for what pydantic refuses by itself.
    tolerance = Field(strict=True, ge=1e-11, le=1e-2, description="a number from 1e-11 to 1e-2, without quotes")
    text = Annotated[str, Field(strict=True, description="text in quotes")]
    named: Any = Literal[LAWS]
    return SimpleNamespace(
        Table=Table,
        law=(Annotated[named, Field(description=f"one of {', '.join(map(repr, LAWS))}")], Case.law),
        rtol=(Annotated[float, tolerance], Case.rtol),
        ends={
            "table": optional_table("table", TABLE_KEYS),
            "title": (text, Case.title),
            "notes": (text, Case.notes),
        },
    )


@functools.cache
def file_model(geometry: str) -> Any:
    """Return the pydantic model of a case file of a geometry."""
    from pydantic import BeforeValidator, Field, ValidationInfo, create_model

    def check_quantity(value: Any, info: ValidationInfo) -> float:
        return quantity(str(info.field_name), value, inputs)

    def check_range(value: Any, info: ValidationInfo) -> tuple[float, float] | None:
        return curve_range(value, info.data["over"], inputs) if "over" in info.data else None

    inputs, shared = INPUT_TABLES[geometry], shared_types()
    number = Annotated[float, BeforeValidator(check_quantity)]
    optional = inputs.choices | set(INPUTS_OF_SURFACES)
    keys: dict[str, Any] = {name: (number | None, None) if name in optional else (number, ...) for name in inputs.quantities}
    contact = create_model("Contact", __base__=shared.Table, **keys, law=shared.law)
    over: Any = (Annotated[Axis, Field(description="'speed', 'load' or 'roughness'")], CurveSettings.over)
    points = Field(strict=True, ge=2, le=100_000, description="a whole number from 2 to 100000")
    curve = create_model(
        "Curve",
        __base__=shared.Table,
        over=over,
        range=(Annotated[Any, BeforeValidator(check_range)], None),
        points=(Annotated[int, points], DEFAULT_POINTS_AND_RTOL[geometry][0]),
    )
    definition: Any = (Annotated[Definition, Field(description="'balanced' or 'published'")], Case.definition)
    rtol = shared.rtol[0], DEFAULT_POINTS_AND_RTOL[geometry][1]
    solver = create_model("Solver", __base__=shared.Table, rtol=rtol, definition=definition)
    return create_model(
        "File",
        __base__=shared.Table,
        contact=(contact, Field(description="a table, [contact]")),
        curve=(curve, Field(description="a table, [curve]", default_factory=curve)),
        solver=(solver, Field(description="a table, [solver]", default_factory=solver)),
        surface=optional_table("surface", SURFACE_KEYS),
        asperities=optional_table("asperities", ASPERITY_KEYS),
        check=optional_table("check", tuple(FACTS)),
        **shared.ends,
    )


def error_sentence(file: Any, error: Any, inputs: InputTable = LINE) -> str:
    """Return the sentence for one of pydantic's errors in a ``file`` of tables."""
    *tables, key = [str(part) for part in error["loc"][:2]]
    model = file.model_fields[tables[0]].annotation if tables else file
    where = f"[{tables[0]}] " if tables else ""
    shown = key if key.isprintable() else repr(key)
    if error["type"] == "missing":
        return f"{where}{key} is missing; {example_of(key, inputs)}." if tables else f"the table [{key}] is missing."
    if error["type"] == "extra_forbidden":
        return f"{where}{shown} = {show(error['input'])} is not a known key; {_nearest(file, model, key)}."
    if error["type"] == "value_error":
        return f"{where}{error['ctx']['error']}"
    return f"{where}{key} = {show(error['input'])} must be {model.model_fields[key].description}."


def example_of(key: str, inputs: InputTable = LINE) -> str:
    """Return the advice to add a quantity, with a typical value and where it is from."""
    wanted = inputs.quantities[key]
    value = f'"{wanted.typical}"' if DIMENSIONS[wanted.dimension].unit else wanted.typical
    other = f", {OTHER_SOURCES[key]}" if key in OTHER_SOURCES else ""
    return f"add {DIMENSIONS[wanted.dimension].noun}, for example {key} = {value} ({wanted.source}){other}"


def _nearest(file: Any, model: Any, key: str) -> str:
    known = [*model.model_fields, *(GIVEN if "modulus" in model.model_fields else ())]
    meant = MEANT.get(key, key)
    advice = advice_on(key, known)
    if advice:
        return advice
    for name, info in file.model_fields.items():
        if model is not info.annotation and meant in getattr(info.annotation, "model_fields", {}):
            return f"it belongs in the table [{name}]"
    if meant in file.model_fields:
        return "it belongs at the top of the file, before the first table"
    return f"known are {', '.join(known)}"
