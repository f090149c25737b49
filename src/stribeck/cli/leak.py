"""The command ``stribeck leak``: a table of the dry pressure of a seal in, films and leakage of a stroke out."""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from stribeck.cli.arguments import Quantity
from stribeck.cli.exits import answer
from stribeck.quantities.formats import format_percent, format_si
from stribeck.quantities.units import InputError, checked_word, show, to_si

if TYPE_CHECKING:
    from stribeck.asymptotics.pressure_film import Inlet, PressureFilm

Given = Annotated[float | str, Parameter(allow_leading_hyphen=True)]

HEADER = "write a header with units above the rows, such as 'x [mm];p [MPa]'"

CUBIC_MM = 1e9  # In a cubic metre.
MM, MPA = 1e-3, 1e6  # In SI units.


def leak_command(
    pressure: Path,
    /,
    *,
    modulus: Given,
    viscosity: Given,
    out_speed: Given,
    in_speed: Given,
    oil: str = "left",
    diameter: Quantity = None,
    stroke: Quantity = None,
    json: bool = False,
) -> int:
    """Report what a stroke of a seal leaks, and the films of both ways, from the pressure of its dry contact.

    Example: stribeck leak examples/rod_seal_pressure.csv --modulus 10e6 --viscosity 0.1 --out-speed 0.1 --in-speed 0.1

    The file has a column of positions and one of pressures, with units, as finite elements export them.  --oil says at which
    end of the positions the oil is: left (default) or right.  --modulus is that of the contact, E/(1 - nu^2).

    With --diameter and --stroke the answer is a volume too.
    """
    from stribeck.asymptotics import OutOfRangeWarning, film_of_pressure
    from stribeck.files.columns import Column, read_columns

    side = checked_word("oil", oil, ("left", "right"))
    speeds = to_si(out_speed, "speed", "out_speed"), to_si(in_speed, "speed", "in_speed")
    sizes = {"diameter": diameter, "stroke": stroke}
    lengths = [to_si(value, "length", name) for name, value in sizes.items() if value is not None]
    if len(lengths) == 1 or any(value <= 0 for value in lengths):
        raise InputError("A volume needs both --diameter and --stroke, above zero.")
    swept = math.pi * math.prod(lengths) if lengths else math.nan
    if min(speeds) <= 0:
        raise InputError(f"out_speed = {show(out_speed)} and in_speed = {show(in_speed)} must be above zero.")
    columns = {"position": Column(".*", "length"), "pressure": Column(".*", "pressure")}  # by their units
    x, p = read_columns(pressure, HEADER, columns)[0].values()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", OutOfRangeWarning)  # a note says it
        found = film_of_pressure(x, p, modulus=modulus, viscosity=viscosity, speed=speeds if side == "left" else speeds[::-1])
    net = found.net if side == "left" else -found.net
    inlets = dict(zip(("out", "in"), found.inlets if side == "left" else found.inlets[::-1], strict=True))

    def content() -> dict[str, Any]:
        words = {"net": net, "net_error": found.error.net, "decided": abs(net) > found.error.net}
        volume = {"volume": net * swept, "volume_error": found.error.net * swept} if lengths else {}
        ways = {name: {"speed": speed} | vars(each) for (name, each), speed in zip(inlets.items(), speeds, strict=True)}
        return words | volume | ways | {"in_range": found.valid, "range": found.range, "notes": list(found.notes)}

    answer(json, content, lambda: _lines(found, net, inlets, swept))
    return 0


def _lines(found: PressureFilm, net: float, inlets: dict[str, Inlet], swept: float) -> Iterator[str]:
    """Yield whether the seal leaks and how much, the films, and what of the pressure makes them."""
    from stribeck.quantities.results import table_lines

    size, error = format_si(abs(net), "length"), format_si(found.error.net, "length", 2)
    volume = "" if math.isnan(swept) else f", {abs(net) * swept * CUBIC_MM:.3g} ± {found.error.net * swept * CUBIC_MM:.2g} mm³"
    if abs(net) <= found.error.net:
        yield f"Whether the seal leaks is not decided: out and in differ by {size} ± {error} on the rod{volume}."
    elif net > 0:
        yield f"The seal leaks: each stroke out and in leaves a layer of {size} ± {error} on the rod{volume}."
    else:
        yield f"The seal does not leak: the way in can take back {size} ± {error} more than the way out leaves{volume}."
    films: list[tuple[str, ...]] = [("stroke", "on the rod", "film h*", "error", "of the law", "of the table", "made by")]
    edges: list[tuple[str, ...]] = [("stroke", "edge at", "k", "error", "steepest rise inside", "error", "rows apart")]
    for name, each in inlets.items():
        errors = map(format_percent, (each.error, each.law_error, each.resolution_error))
        films.append((name, format_si(each.film / 2, "length"), format_si(each.film, "length"), *errors, each.law))
        k, rise = each.edge_coefficient * MM**0.5 / MPA, each.steepest_rise * MM / MPA
        pairs = (each.edge_coefficient_error, each.edge_coefficient), (each.steepest_rise_error, each.steepest_rise)
        first, second = (format_percent(doubt / value) if value else "" for doubt, value in pairs)
        step = format_si(each.spacing, "length", 2)
        edges.append(
            (
                name,
                f"{round(each.edge / MM, 3) + 0.0:.3f} mm",
                f"{k:.3g} MPa/mm^(1/2)",
                first,
                f"{rise:.3g} MPa/mm",
                second,
                step,
            )
        )
    yield from table_lines(films, right=(1, 2, 3, 4, 5))
    yield from table_lines(edges, right=(1, 2, 3, 4, 5, 6))
    yield from (f"Note: {note}" for note in found.notes)
