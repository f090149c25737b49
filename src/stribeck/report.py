"""Results in words and as JSON: what the commands print. Nothing is computed here but percentages."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ._types import LawShape
from .curve_result import StribeckCurve
from .distances import Crossing, Distance, TransitionDistances
from .friction import DEFINITIONS, Definition, Friction
from .landmarks import Landmark
from .parameters import Groups, LineContact
from .quantities import QUANTITIES
from .regimes import regime_of
from .solution import Solution
from .store import GROUPS, INPUTS, si_films, unit_of
from .units import format_bound, format_share, format_si

if TYPE_CHECKING:
    from rich.console import Console

__all__ = [
    "curve_json",
    "dump",
    "print_curve",
    "print_regimes",
    "print_solution",
    "regimes_json",
    "solution_json",
]

LABELS = {
    "friction_coefficient": "dry friction coefficient",
    "alpha": "alpha of the contact law",
    "beta": "beta of the contact law",
}
"""Names of inputs that are not words by themselves."""

HANDS_ON = ("speed", "load", "viscosity", "modulus", "radius", "roughness", "friction_coefficient")
"""Inputs that one may change; alpha and beta follow from the surface."""

Elasticities = dict[str, float]


def dump(content: dict[str, Any]) -> str:
    """Return content as JSON text; what is not finite becomes null, as JSON knows no nan.

    Parameters
    ----------
    content : dict
        Numbers, text, arrays, sequences and dictionaries of these.

    Returns
    -------
    str
        The text.
    """
    return json.dumps(_plain(content), indent=2, ensure_ascii=False, allow_nan=False)


def _plain(content: Any) -> Any:
    if isinstance(content, dict):
        return {name: _plain(value) for name, value in content.items()}
    if isinstance(content, np.ndarray):
        return _plain(content.tolist())
    if isinstance(content, list | tuple):
        return [_plain(value) for value in content]
    if isinstance(content, float) and not math.isfinite(content):
        return None
    return content


def solution_json(solution: Solution, mu0: float | None = None, beta: float | None = None) -> dict[str, Any]:
    """Return :meth:`Solution.to_dict`, and under ``si`` inputs and films of the contact, if any, in SI units.

    Parameters
    ----------
    solution : Solution
        The state.
    mu0, beta : float, optional
        As in :meth:`Solution.friction`.

    Returns
    -------
    dict
        Ready for :func:`dump`.
    """
    found: dict[str, Any] = solution.to_dict(mu0, beta)
    found["hersey_number"] = _hersey(solution, beta)
    if solution.contact is not None:
        films = si_films(solution)
        found["si"] = {
            **_inputs(solution.contact),
            **{name: value for name, (value, _, _) in films.items()},
            "units": _units() | {name: unit for name, (_, unit, _) in films.items()},
        }
    return found


def curve_json(curve: StribeckCurve, title: str, files: Sequence[str]) -> dict[str, Any]:
    """Return a curve with its settings, landmarks and points.

    Parameters
    ----------
    curve : StribeckCurve
        The curve.
    title : str
        Headline.
    files : sequence of str
        Files that were written.

    Returns
    -------
    dict
        Ready for :func:`dump`.
    """
    names = (
        "contact_load_share",
        "fluid_load_share",
        "central_gap",
        "minimum_gap",
        "flux_gap",
        "lambda_ratio",
    )
    return {
        "title": title,
        "over": curve.over,
        "unit": "1" if curve.contact is None else unit_of(curve.over),
        "definition": curve.definition,
        **law_json(curve.law),
        "rtol": curve.rtol,
        "mu0": curve.mu0,
        "beta": curve.beta,
        "inputs": None if curve.contact is None else _inputs(curve.contact),
        "units": None if curve.contact is None else _units(),
        "minimum": None if curve.minimum is None else _landmark(curve.minimum),
        "transitions": [_landmark(mark) for mark in curve.transitions],
        "regimes": [{"regime": name, "from": low, "to": high} for name, low, high in curve.regime_ranges],
        "points": {
            "value": curve.values,
            **{f"{name}_group": np.asarray(getattr(curve.groups, name)) for name in GROUPS},
            "hersey_number": curve.hersey_number,
            "hydrodynamic_friction": curve.hydrodynamic_friction,
            "friction": curve.friction,
            "friction_contact": curve.friction_contact,
            "friction_viscous": curve.friction_viscous,
            "friction_error": curve.friction_error,
            "regime": curve.regimes,
            **{name: curve.observable(name) for name in names},
        },
        "requested_points": curve.requested,
        "complete": curve.outcome.ok,
        "error_estimate": curve.error_estimate,
        "outcome": curve.outcome.name,
        "message": curve.outcome.value,
        "notes": list(curve.notes),
        "files": list(files),
    }


def regimes_json(
    solution: Solution, elasticities: Elasticities, curve: StribeckCurve, distances: TransitionDistances, title: str = ""
) -> dict[str, Any]:
    """Return the regime of a state, the transitions around it and what moves its friction.

    Parameters
    ----------
    solution : Solution
        The state, of a contact.
    elasticities : dict of str to float
        Those of its friction.
    curve : StribeckCurve
        The curve over the speed through it.
    distances : TransitionDistances
        The way to the next regimes.
    title : str
        Headline.

    Returns
    -------
    dict
        Ready for :func:`dump`.
    """
    assert solution.contact is not None
    friction = solution.friction(definition=curve.definition)
    speed = solution.contact.speed
    return {
        "title": title,
        "regime": _regime(solution, curve.definition),
        "speed": speed,
        "unit": unit_of("speed"),
        "fluid_load_share": solution.fluid_load_share,
        "fluid_load_share_error": solution.errors["fluid_load_share"],
        "contact_friction_share": _contact_part(friction),
        "contact_friction_share_error": _part_error(friction),
        "friction": friction.total,
        "friction_error": friction.error,
        "definition": curve.definition,
        "transitions": [
            {**_landmark(mark), "factor": mark.value / speed if speed > 0 else math.inf} for mark in curve.transitions
        ],
        "regimes": [{"regime": name, "from": low, "to": high} for name, low, high in curve.regime_ranges],
        "distances": {distance.name: _distance(distance) for distance in distances.distances},
        "elasticities": elasticities,
        "moves_friction_most": _strongest(elasticities),
        **law_json(solution.groups.law),
        "inputs": _inputs(solution.contact),
        "units": _units(),
        "error_estimate": max(solution.error_estimate, curve.error_estimate),
        "outcome": curve.outcome.name,
        "message": curve.outcome.value,
        "notes": [*solution.notes, *distances.notes],
    }


def law_json(law: LawShape | None) -> dict[str, Any]:
    """Return name and parameters of a contact law.

    Parameters
    ----------
    law : LawShape or None
        The law; None is the exponential one.

    Returns
    -------
    dict
        ``contact_law`` and ``contact_law_parameters``.
    """
    if law is None:
        return {"contact_law": "exponential", "contact_law_parameters": {}}
    return {"contact_law": law.name, "contact_law_parameters": law.parameters}


def print_solution(
    console: Console, solution: Solution, title: str, mu0: float | None = None, beta: float | None = None
) -> None:
    """Print one state as a table with units and errors.

    Parameters
    ----------
    console : rich.console.Console
        Where to.
    solution : Solution
        The state.
    title : str
        Headline.
    mu0, beta : float, optional
        As in :meth:`Solution.friction`.
    """
    _print_head(console, title, solution.contact, solution.groups)
    columns = (0, 1, 3) if solution.contact is None else (0, 1, 2, 3)
    table = _table(*(("quantity", "value", "in SI", "error")[i] for i in columns))
    for row in _solution_rows(solution, mu0, beta):
        table.add_row(*(row[i] for i in columns))
    console.print(table)
    _print_outcome(console, solution.outcome.value, solution.error_estimate, solution.notes)


def _solution_rows(solution: Solution, mu0: float | None, beta: float | None) -> Iterator[tuple[str, str, str, str]]:
    errors = solution.errors
    for definition in DEFINITIONS:
        f = solution.friction(mu0, beta, definition)
        relative = f.error / f.total if f.total > 0 else 0.0
        yield f"friction coefficient ({definition})", _digits(f.total, relative), "", _error(relative)
        yield "  from asperities", _part(f.contact, f.error), "", ""
        yield "  from the fluid", _part(f.viscous, f.error), "", ""
    for name, label in (
        ("contact_load_share", "load on asperities"),
        ("fluid_load_share", "load on the fluid"),
    ):
        yield label, _part(getattr(solution, name), errors[name]), "", _error(errors[name])
    scales = None if solution.contact is None else solution.contact.hertz
    for name, label in (
        ("central_gap", "central film"),
        ("minimum_gap", "least film"),
        ("flux_gap", "flux film h*"),
        ("offset", "offset z0"),
    ):
        value = getattr(solution, name)
        si = "" if scales is None else _length(value * scales.indentation, errors[name])
        unit = " u_Hz" if math.isfinite(value) else ""
        yield label, f"{_digits(value, errors[name])}{unit}", si, _error(errors[name])
    si = "" if scales is None else _length(solution.minimum_position * scales.half_width, 1e-4)
    yield "place of the least film", f"{solution.minimum_position:.4g} a", si, ""
    yield "Lambda (film over h_rms/alpha)", _digits(solution.lambda_ratio, 1e-4), "", ""
    if not math.isnan(solution.central_area_fraction):
        area, error = solution.central_area_fraction, solution.central_area_fraction_error
        yield "real contact area at x = 0", _part(area, error), "", _error(error / area) if area > 0 else ""
    regime = regime_of(solution.fluid_load_share, _contact_part(solution.friction(mu0, beta)))
    yield "Hersey number", f"{_hersey(solution, beta):.4g}", "", ""
    yield "regime", regime, "", ""


def _hersey(solution: Solution, beta: float | None) -> float:
    if solution.contact is None and beta is not None:
        return float(solution.groups.hersey_number(beta))
    return solution.hersey_number


def print_curve(console: Console, curve: StribeckCurve, title: str, files: Sequence[str]) -> None:
    """Print what a curve holds: inputs, regimes, transitions, error, notes, files.

    Parameters
    ----------
    console : rich.console.Console
        Where to.
    curve : StribeckCurve
        The curve.
    title : str
        Headline.
    files : sequence of str
        Files that were written.
    """
    _print_head(console, title, curve.contact, curve.groups, curve.over)
    low, high = _place(curve, curve.values[0]), _place(curve, curve.values[-1])
    _say(console, f"{len(curve)} point{'s' * (len(curve) > 1)}, {curve.over} {low} to {high}.")
    table = _table("regime", "from", "to", right=(1, 2))
    for regime, first, last in curve.regime_ranges:
        table.add_row(regime, _place(curve, first), _place(curve, last))
    console.print(table)
    if curve.transitions:
        table = _table("where", curve.over, "friction", right=(1, 2))
        for mark in curve.transitions:
            table.add_row(mark.name, _place(curve, mark.value, 7), f"{mark.friction:.7g}")
        console.print(table)
    if curve.minimum is None:
        _say(console, "Friction has no minimum inside this range.")
    _print_outcome(console, curve.outcome.value, curve.error_estimate, curve.notes)
    for name in files:
        _say(console, f"Written: {name}")


def print_regimes(
    console: Console,
    solution: Solution,
    elasticities: Elasticities,
    curve: StribeckCurve,
    distances: TransitionDistances,
    title: str,
) -> None:
    """Print in which regime a contact runs, where the transitions lie, and what moves its friction.

    Parameters
    ----------
    console : rich.console.Console
        Where to.
    solution : Solution
        The state, of a contact.
    elasticities : dict of str to float
        Those of its friction.
    curve : StribeckCurve
        The curve over the speed through it.
    distances : TransitionDistances
        The way to the next regimes.
    title : str
        Headline.
    """
    contact = solution.contact
    assert contact is not None
    _print_head(console, title, contact, solution.groups)
    friction = solution.friction(definition=curve.definition)
    speed = format_si(contact.speed, "speed")
    _say(
        console,
        f"At {speed} lubrication is {_regime(solution, curve.definition)}: the fluid carries "
        f"{format_share(solution.fluid_load_share, solution.errors['fluid_load_share'])} of the load, asperities cause "
        f"{format_share(_contact_part(friction), _part_error(friction))} of the friction coefficient {friction.total:.4g}.",
    )
    for line in _ways(distances):
        _say(console, line)
    if curve.transitions:
        table = _table("where", "speed", "from here", "friction", right=(1, 3))
        for mark in curve.transitions:
            table.add_row(mark.name, _place(curve, mark.value, 4), _way(mark, contact.speed), f"{mark.friction:.4g}")
        console.print(table)
    else:
        _say(
            console,
            "No transition lies between the boundary plateau and the hydrodynamic branch of this contact.",
        )
    table = _table("input", "value", "elasticity", "10 % more gives", right=(1, 2, 3))
    for name in sorted(elasticities, key=lambda name: -abs(elasticities[name])):
        value, slope = getattr(contact, name), elasticities[name]
        text = format_si(value, QUANTITIES[name].dimension)
        table.add_row(LABELS.get(name, name), text, f"{slope:+.3f}", f"{100 * _change(1.1, slope):+.2g} % friction")
    console.print(table)
    strongest = _strongest(elasticities)
    if strongest is not None:
        slope = elasticities[strongest]
        factor = 0.9 if slope > 0 else 1.1
        way, gain = "less" if slope > 0 else "more", f"{-100 * _change(factor, slope):.3g} %"
        name = LABELS.get(strongest, strongest)
        _say(
            console,
            f"The {name} moves friction most: 10 % {way} of it lowers friction by {gain}, all else kept.",
        )
    notes = [*solution.notes, *distances.notes]
    _print_outcome(console, curve.outcome.value, max(solution.error_estimate, curve.error_estimate), notes)


def _ways(distances: TransitionDistances) -> Iterator[str]:
    """Yield a sentence for each regime that is near: what it takes of each input, and what leads nowhere."""
    for regime in distances.targets:
        found = [(distance, distance.towards(regime)) for distance in distances.distances]
        ways = [f"{distance.name} {_step(distance.name, mark)}" for distance, mark in found if mark is not None]
        barren = [_searched(distance) for distance, mark in found if mark is None]
        if not ways:
            yield f"To reach {regime}: nothing within reach, by {', '.join(barren)}."
            continue
        rest = f"; none within reach by {', '.join(barren)}" if barren else ""
        yield f"To reach {regime}: {', or '.join(ways)}{rest}."
    if any(distance.name == "viscosity" and (distance.less or distance.more) for distance in distances.distances):
        yield "Speed and viscosity count as their product, so that their factors are the same."


def _step(name: str, mark: Crossing) -> str:
    """Return how far an input is to be changed, as ``x 3.1 (0.31 m/s)``."""
    if mark.value == 0:
        return "of any size"
    value = format_si(mark.value, QUANTITIES[name].dimension, 4)
    if math.isinf(mark.factor):
        return f"from zero to {value}"
    return f"x {mark.factor:.3g} ({value})" if mark.factor >= 1 else f"/ {1 / mark.factor:.3g} ({value})"


def _searched(distance: Distance) -> str:
    low, high = distance.searched
    if low == high:  # it cannot lead anywhere, and a note says why
        return distance.name
    ends = (format_si(value, QUANTITIES[distance.name].dimension) for value in (low, high))
    return f"{distance.name} (range searched {' to '.join(ends)})"


def _distance(distance: Distance) -> dict[str, Any]:
    return {
        "less": None if distance.less is None else _crossing(distance.less),
        "more": None if distance.more is None else _crossing(distance.more),
        "searched": list(distance.searched),
        "unit": unit_of(distance.name),
    }


def _crossing(mark: Crossing) -> dict[str, Any]:
    return {"regime": mark.regime, "value": mark.value, "factor": mark.factor}


def _print_head(console: Console, title: str, contact: LineContact | None, groups: Groups, over: str | None = None) -> None:
    """Print the headline, the inputs and the groups, without those that vary."""
    if title:
        console.print(title, style="bold", markup=False, highlight=False)
    if contact is not None:
        shown = [
            f"{LABELS.get(name, name)} {format_si(getattr(contact, name), QUANTITIES[name].dimension, 4)}"
            for name in INPUTS
            if name != over
        ]
        _say(console, f"Contact: {', '.join(shown)}.")
    constant = []
    for name in GROUPS:
        values = np.asarray(getattr(groups, name))
        if values.ndim == 0 or (len(values) and np.ptp(values) <= 1e-12 * values[0]):
            constant.append(f"{name} {float(values.flat[0]):.6g}")
    _say(console, f"Groups: {', '.join(constant)}.")
    if groups.law is not None:
        _say(console, law_sentence(groups.law))


def law_sentence(law: LawShape) -> str:
    """Return name and parameters of a contact law as a sentence.

    Parameters
    ----------
    law : LawShape
        The law.

    Returns
    -------
    str
        Such as ``"Contact law: persson (alpha 2.09, beta 0.0143)."``
    """
    numbers = ", ".join(
        f"{name.replace('_', ' ')} {value if isinstance(value, str) else f'{value:.4g}'}"
        for name, value in law.parameters.items()
    )
    return f"Contact law: {law.name}{f' ({numbers})' if numbers else ''}."


def _print_outcome(console: Console, outcome: str, error: float, notes: Sequence[str]) -> None:
    _say(console, f"{outcome} Largest estimated relative error: {error:.1e}.")
    for note in notes:
        console.print(f"Note: {note}", style="yellow", markup=False, highlight=False, soft_wrap=True)


def _say(console: Console, text: str) -> None:
    console.print(text, markup=False, highlight=False, soft_wrap=True)


def _table(*columns: str, right: Sequence[int] = ()) -> Any:
    from rich.box import SIMPLE_HEAD
    from rich.table import Table

    table = Table(box=SIMPLE_HEAD, pad_edge=False)
    for i, name in enumerate(columns):
        table.add_column(name, justify="right" if i in right else "left", no_wrap=True)
    return table


def _digits(value: float, error: float) -> str:
    """Return a number with the digits that its relative error allows."""
    if not math.isfinite(value):
        return "none" if math.isnan(value) else "infinite"
    return f"{value:.{_count(error)}g}"


def _length(value: float, error: float) -> str:
    if not math.isfinite(value):
        return ""
    return format_si(value, "length", _count(error))


def _count(error: float) -> int:
    """Return how many digits a relative error allows, 3 to 9."""
    return 9 if error <= 0 else min(9, max(3, math.ceil(-math.log10(error))))


def _error(relative: float) -> str:
    return f"{relative:.0e}" if math.isfinite(relative) else ""


def _part(value: float, error: float) -> str:
    """Return a part of a sum with the digits that its absolute error allows, or that error as a bound."""
    if 0 < value <= error:
        return format_bound(error)
    return _digits(value, error / value if value > 0 else error)


def _contact_part(friction: Friction) -> float:
    return friction.contact / friction.total if friction.total > 0 else 0.0


def _part_error(friction: Friction) -> float:
    return friction.error / friction.total if friction.total > 0 else 0.0


def _regime(solution: Solution, definition: Definition) -> str:
    return regime_of(solution.fluid_load_share, _contact_part(solution.friction(definition=definition)))


def _change(factor: float, slope: float) -> float:
    """Return the relative change of friction where an input with this elasticity is multiplied."""
    return float(factor**slope - 1)


def _strongest(elasticities: Elasticities) -> str | None:
    found = max(HANDS_ON, key=lambda name: abs(np.nan_to_num(elasticities[name])))
    return found if abs(np.nan_to_num(elasticities[found])) > 0 else None


def _way(mark: Landmark, speed: float) -> str:
    if speed == 0:
        return "from rest"
    factor = mark.value / speed
    return f"{factor:.3g}x faster" if factor >= 1 else f"{1 / factor:.3g}x slower"


def _place(curve: StribeckCurve, value: float, digits: int = 3) -> str:
    if curve.contact is None:
        return f"{value:.{digits}g}"
    return format_si(value, QUANTITIES[curve.over].dimension, digits)


def _landmark(mark: Landmark) -> dict[str, Any]:
    return {"name": mark.name, "value": mark.value, "friction": mark.friction}


def _inputs(contact: LineContact) -> dict[str, float]:
    return {name: getattr(contact, name) for name in INPUTS}


def _units() -> dict[str, str]:
    return {name: unit_of(name) for name in INPUTS}
