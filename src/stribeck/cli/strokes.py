"""Commands on strokes: friction and films in time, and what a seal leaks by the pressure of its dry contact."""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

import stribeck as sb
from stribeck.cli.arguments import OUTPUTS, Outputs, Quantity, Verbose
from stribeck.cli.exits import answer
from stribeck.cli.progress import interruptible
from stribeck.quantities.formats import format_error, format_percent, format_si
from stribeck.quantities.units import InputError, checked_word, show, to_si

if TYPE_CHECKING:
    from stribeck.asymptotics.pressure_film import Inlet, PressureFilm
    from stribeck.strokes.result import Stroke


ROWS = 12  # Instants of the table of the last cycle
ROUNDING = 1e-9  # Part of a half-width below which a position is the middle

Given = Annotated[float | str, Parameter(allow_leading_hyphen=True)]

HEADER = "write a header with units above the rows, such as 'x [mm];p [MPa]'"

CUBIC_MM = 1e9  # In a cubic metre.
MM, MPA = 1e-3, 1e6  # In SI units.


def stroke_command(
    case: Path,
    /,
    *,
    output: Annotated[list[Path] | None, Parameter(alias="-o")] = None,
    cavitation: str | None = None,
    inlet: str | None = None,
    verbose: Verbose = False,
    outputs: Outputs = OUTPUTS,
) -> int:
    """Solve a stroke, a start or a stop in time: friction beside steady sliding, share of asperities, work of a cycle.

    Example: stribeck stroke examples/reciprocating_cylinder.toml -o stroke.nc --plot loop.png

    The motion is in the table [stroke] of the case: motion = "sine", "ramp", "stop" or "table", with its numbers.

    --cavitation exit ends the film where it would suck, --cavitation none takes it as full; without it the case says which.

    --inlet own-wake lets the contact run into the film that it has left, --inlet flooded gives it liquid enough.

    Ctrl-C ends the work; nothing is written then.
    """
    loaded = sb.load_case(case)
    if loaded.stroke is None:
        raise InputError(
            f'{case}: the table [stroke] is missing; add, for example, [stroke] with motion = "sine", stroke = "50 mm" and '
            'frequency = "1 1/s".'
        )
    outputs.check(data=output or [])
    arguments: dict[str, Any] = {"contact": loaded.contact} | loaded.stroke.arguments
    arguments |= {name: word for name, word in (("cavitation", cavitation), ("inlet", inlet)) if word is not None}
    with interruptible() as progress:
        found = sb.stroke(on_step=progress, **arguments)
        from stribeck.strokes.result import beside_steady

        steady = beside_steady(found, lambda done, total: progress(done, total, "steady sliding, point"))
        progress.writes = True

        def content() -> dict[str, Any]:
            told = found.to_dict()
            units = {name: "1" for name in steady if not name.endswith("_error")} | {"largest_speed": "m/s"}
            return {"title": loaded.title} | told | steady | {"units": told["units"] | units}

        said = partial(_lines, found, steady, loaded.title, verbose)
        return outputs.finish(found, said, loaded.title, content=content, data=output or [], case=loaded)


def _lines(found: Stroke, steady: dict[str, float], title: str, verbose: bool) -> Iterator[str]:
    """Yield the mean friction beside the steady one, a table of both, and what else the stroke says of itself."""
    from stribeck.quantities.results import table_lines

    mean, steady_mean = steady["mean_friction"], steady["steady_mean_friction"]
    doubt = steady["mean_friction_error"] + steady["steady_mean_friction_error"]
    if abs(mean - steady_mean) <= doubt:
        said = "within the errors that of steady sliding at the same speeds"
    else:
        part = mean / steady_mean
        much = (
            f"{part:.2g} times" if abs(part - 1) > 0.5 else f"{100 * abs(part - 1):.2g} % {'above' if part > 1 else 'below'}"
        )
        said = f"{much} that of steady sliding at the same speeds"
    yield f"Mean friction over the path out is {mean:.4g} ± {format_error(steady['mean_friction_error'])}, {said}."
    yield from filter(None, [title])
    speed = format_si(steady["largest_speed"], "speed")
    rows = [
        ("friction on the way out, balanced", "stroke", "error", "steady", "error"),
        _row(f"at the largest speed, {speed}", steady, "friction_at_largest_speed", "steady_friction"),
        _row("mean over the path", steady, "mean_friction", "steady_mean_friction"),
    ]
    yield from table_lines(rows, right=(1, 2, 3, 4))
    headline, *lines = str(found).splitlines()
    yield f"{headline[0].upper()}{headline[1:]}:"
    yield from lines
    if verbose:
        yield from table_lines(_instants(found), right=tuple(range(6)))
    else:
        yield "-v shows instants of the last cycle; -o writes all of them with their errors."


def _row(label: str, steady: dict[str, float], *names: str) -> tuple[str, ...]:
    """Return numbers of the stroke and of steady sliding with their errors."""
    numbers = [(steady[name], steady[f"{name}_error"]) for name in names]
    return (label, *(text for value, error in numbers for text in (f"{value:.4g}", f"± {format_error(error)}")))


def _instants(found: Stroke) -> list[tuple[str, ...]]:
    """Return a table of instants of the last cycle."""
    rows: list[tuple[str, ...]] = [("time", "position", "speed", "friction", "error", "share of asperities", "central film")]
    first, end = found.last_cycle.indices(len(found.time))[:2]
    for k in range(first, end, max((end - first) // ROWS, 1)):
        place = found.position[k] if abs(found.position[k]) > ROUNDING * found.hertz_half_width else 0.0
        where = format_si(found.time[k], "time"), format_si(place, "length"), format_si(found.speed[k], "speed")
        friction, error = f"{found.friction[k]:.4g}", f"± {format_error(found.errors['friction'][k])}"
        film = format_si(found.central_film_thickness[k], "length")
        rows.append((*where, friction, error, f"{found.contact_load_share[k]:.3g}", film))
    return rows


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
    x, p = read_columns(pressure, HEADER, columns).in_si.values()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", OutOfRangeWarning)  # a note says it
        found = film_of_pressure(x, p, modulus=modulus, viscosity=viscosity, speed=speeds if side == "left" else speeds[::-1])
    net = found.net if side == "left" else -found.net
    inlets = dict(zip(("out", "in"), found.inlets if side == "left" else found.inlets[::-1], strict=True))

    def content() -> dict[str, Any]:
        words = {"net": net, "net_error": found.error.net, "decided": abs(net) > found.error.net}
        volume = {"volume": net * swept, "volume_error": found.error.net * swept} if lengths else {}
        ways = {name: {"speed": speed} | vars(each) for (name, each), speed in zip(inlets.items(), speeds, strict=True)}
        units = found.to_dict()["units"] | {"speed": "m/s"} | ({"volume": "m3"} if lengths else {})
        told = {"in_range": found.valid, "range": found.range, "units": units, "notes": list(found.notes)}
        return words | volume | ways | told

    answer(json, content, lambda: _leak_lines(found, net, inlets, swept))
    return 0


def _leak_lines(found: PressureFilm, net: float, inlets: dict[str, Inlet], swept: float) -> Iterator[str]:
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
        place, step = f"{round(each.edge / MM, 3) + 0.0:.3f} mm", format_si(each.spacing, "length", 2)
        edges.append((name, place, f"{k:.3g} MPa/mm^(1/2)", first, f"{rise:.3g} MPa/mm", second, step))
    yield from table_lines(films, right=(1, 2, 3, 4, 5))
    yield from table_lines(edges, right=(1, 2, 3, 4, 5, 6))
    yield from (f"Note: {note}" for note in found.notes)
