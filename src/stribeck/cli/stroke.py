"""The command ``stribeck stroke``: a case with a motion in, friction and films in time out."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

import stribeck as sb
from stribeck.cli.arguments import OUTPUTS, Outputs, Verbose
from stribeck.cli.progress import interruptible
from stribeck.quantities.formats import format_si
from stribeck.quantities.units import InputError

if TYPE_CHECKING:
    from stribeck.strokes.beside_steady import BesideSteady
    from stribeck.strokes.result import Stroke

ROWS = 12  # Instants of the table of the last cycle
ROUNDING = 1e-9  # Part of a half-width below which a position is the middle


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
        from stribeck.strokes.beside_steady import beside_steady

        steady = beside_steady(found, lambda done, total: progress(done, total, "steady sliding, point"))
        progress.writes = True

        def content() -> dict[str, Any]:
            return {"title": loaded.title} | found.to_dict() | vars(steady)

        said = partial(_lines, found, steady, loaded.title, verbose)
        return outputs.finish(found, said, loaded.title, content=content, data=output or [], case=loaded)


def _lines(found: Stroke, steady: BesideSteady, title: str, verbose: bool) -> Iterator[str]:
    """Yield the mean friction beside the steady one, a table of both, and what else the stroke says of itself."""
    from stribeck.quantities.results import table_lines

    mean, steady_mean = steady.mean_friction, steady.steady_mean_friction
    doubt = steady.mean_friction_error + steady.steady_mean_friction_error
    if abs(mean - steady_mean) <= doubt:
        said = "within the errors that of steady sliding at the same speeds"
    else:
        part = mean / steady_mean
        much = (
            f"{part:.2g} times" if abs(part - 1) > 0.5 else f"{100 * abs(part - 1):.2g} % {'above' if part > 1 else 'below'}"
        )
        said = f"{much} that of steady sliding at the same speeds"
    yield f"Mean friction over the path out is {mean:.3g} ± {steady.mean_friction_error:.1g}, {said}."
    yield from filter(None, [title])
    speed = format_si(steady.largest_speed, "speed")
    rows = [
        ("friction on the way out", "stroke", "error", "steady", "error"),
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


def _row(label: str, steady: BesideSteady, *names: str) -> tuple[str, ...]:
    """Return numbers of the stroke and of steady sliding with their errors."""
    numbers = [(getattr(steady, name), getattr(steady, f"{name}_error")) for name in names]
    return (label, *(text for value, error in numbers for text in (f"{value:.4g}", f"± {error:.1g}")))


def _instants(found: Stroke) -> list[tuple[str, ...]]:
    """Return a table of instants of the last cycle."""
    rows: list[tuple[str, ...]] = [("time", "position", "speed", "friction", "error", "share of asperities", "central film")]
    first, end = found.last_cycle.indices(len(found.time))[:2]
    for k in range(first, end, max((end - first) // ROWS, 1)):
        place = float(found.position[k])
        numbers = f"{found.friction[k]:.4g}", f"± {found.errors['friction'][k]:.1g}", f"{found.contact_load_share[k]:.3g}"
        where = (
            format_si(found.time[k], "time"),
            format_si(place if abs(place) > ROUNDING * found.half_width else 0.0, "length"),
            format_si(found.speed[k], "speed"),
        )
        rows.append((*where, *numbers, format_si(found.central_gap[k], "length")))
    return rows
