"""What the file of golden values holds: cases as plain data, and the numbers that the package gives for them, with errors.

A case is a dictionary of JSON.  Numbers of :class:`stribeck.Groups` or of a contact stand under their names; laws, fluids and
solids are lists, the name of the class and its arguments; ``without`` is how the names begin of what other BLAS kernels give
otherwise.  Only public names are used here, so that the file outlives every change inside the package; where a public name
changes, this module is what follows it.

What was observed is ``{"words": {name: text}, "values": {name: [value, absolute error]}}``.
"""

import math
import tempfile
from pathlib import Path

import numpy as np

import stribeck as sb
from stribeck.regimes.margins import regime_margins

ROUNDING = 1e-11
"""Relative difference that is rounding: values are kept with twelve digits."""

GROWTH = 10.0
"""Factor by which a stated error may grow."""

PLACES = ("minimum_position", "minimum_radius", "minimum_angle")
"""Positions whose stated error may grow by more: minima are flat, and by how much their place is unsure hangs on rounding."""

OWN_SCALE = {"contact_load_share": 1.0, "fluid_load_share": 1.0, "exit_position": 1.0, "reformation_position": 1.0}
"""Least scale of the stated error of an observable, else the observable itself."""

LEAST_OFFSET, LEAST_GAP = 1e-3, 1e-3
"""The same for the offset, and for gaps at rest in units of the roughness."""

NOT_OF_THEMSELVES = "J_pcx"
"""Observable whose stated error is relative to another."""

OF_PLACE = 10.0
"""Error of a crossing along a curve over its tolerance, where none is stated."""

OF_STATISTICS = 0.02
"""Error of a fitted value over its standard error, and of standard errors and intervals relative to themselves."""

CLASSES = {
    **{name: getattr(sb.fluids, name) for name in sb.fluids.__all__ if name[0].isupper() and name != "PRESETS"},
    **{name: getattr(sb.solids, name) for name in sb.solids.__all__ if name[0].isupper()},
    **{
        name: getattr(sb.contact_laws, name) for name in ("FiniteSurface", "GreenwoodTripp", "GreenwoodWilliamson", "TableLaw")
    },
    "Persson": lambda numbers: sb.surfaces.persson_law(sb.surfaces.SelfAffine(**numbers)),
}
PARTS = ("law", "fluid", "cavitation", "cavity_pressure", "flow_factors", "solid", "slide_to_roll")


def made(value):
    """Return the object that a list names, with its arguments; other data as they are."""
    if isinstance(value, list) and value and value[0] in CLASSES:
        return CLASSES[value[0]](*map(made, value[1:]))
    return value


def problem_of(case):
    """Return the groups or the contact of a case, and its other parts as keywords."""
    parts = {name: made(case[name]) for name in PARTS if name in case}
    kind = case.get("geometry", "line")
    if "contact" in case:
        contact = {"line": sb.LineContact, "point": sb.PointContact}[kind]
        return contact(**case["contact"], **parts), {}
    return sb.Groups(case.get("speed", 1.0), case.get("load", 1.0), case.get("roughness", 0.0), geometry=kind), parts


def observables(solution, values):
    """Enter the observables of a solution that have stated errors."""
    kappa = float(solution.groups.relative_roughness)
    for key, error in solution.errors.items():
        if key == NOT_OF_THEMSELVES:
            continue
        value = float(getattr(solution, key))
        least = OWN_SCALE.get(key, LEAST_OFFSET if key == "offset" else 0.0)
        if solution.groups.speed == 0 and key.endswith("gap"):
            least = LEAST_GAP * kappa
        values[key] = [value, float(error) * max(abs(value), least)]
    for definition in ("balanced", "published"):
        friction = solution.friction(1.0, 1.0, definition)
        values[f"friction_{definition}"] = [float(friction.total), float(friction.error)]


def state(case):
    """Return what one state gives."""
    values = {}
    try:
        problem, parts = problem_of(case)
        solution = sb.solve(problem, rtol=case["rtol"], on_failure="return", **parts)
    except (sb.InputError, sb.SolveError) as error:
        kind = type(error).__name__
        return {"words": {"outcome": f"{kind} {error.outcome.name}" if hasattr(error, "outcome") else kind}, "values": values}
    observables(solution, values)
    for name in PLACES:
        if hasattr(solution, f"{name}_error"):
            values[name] = [float(getattr(solution, name)), float(getattr(solution, f"{name}_error"))]
    return {"words": {"outcome": solution.outcome.name}, "values": values}


def curve(case):
    """Return what a curve gives: values at its points, minimum and transitions."""
    problem, parts = problem_of(case)
    along = {case["over"]: np.array(case["at"])}
    try:
        found = sb.stribeck_curve(problem, **along, rtol=case["rtol"], **parts)
    except (sb.InputError, sb.SolveError) as error:
        return {"words": {"outcome": type(error).__name__}, "values": {}}
    values = {}
    for i, solution in enumerate(found.solutions):
        values[f"friction {i}"] = [float(found.friction[i]), float(found.friction.error[i])]
        for name in ("central_gap", "minimum_gap", "fluid_load_share"):
            value = float(found.observable(name)[i])
            values[f"{name} {i}"] = [value, solution.errors[name] * max(abs(value), OWN_SCALE.get(name, 0.0))]
    least = OF_PLACE * case["rtol"]
    marks = {str(mark.name): mark for mark in found.transitions}
    for name, mark in marks.items():
        is_flat = "minimum" in name  # friction does not change along its minimum
        away = mark.error if math.isfinite(mark.error) else math.sqrt(least) if is_flat else least
        values[f"{name}: place"] = [mark.value, away * mark.value]
        there = mark.solution.friction(found.boundary_friction, found.beta, found.definition)
        values[f"{name}: friction"] = [mark.friction, there.error + (0.0 if is_flat else away * abs(mark.friction))]
    words = {"outcome": found.outcome.name, "regimes": " ".join(found.regimes), "marks": "; ".join(marks)}
    return {"words": words, "values": values}


def fit(case):
    """Return what a fit gives: its inputs with standard errors and intervals, and the friction of its rows."""
    start, _ = problem_of(case)
    rows = len(case["speeds"])
    data = sb.results.Measurements(
        abscissa="speed",
        values=np.array(case["speeds"]),
        friction=np.array(case["friction"]),
        error=np.array(case["error"]) if "error" in case else None,
        curve=np.zeros(rows, dtype=int),
        curves=("data",),
        inputs=({},),
        rows=np.arange(2, rows + 2),
    )
    found = sb.fit(data, start, free=case["free"], robust=case.get("robust", False), intervals=case.get("intervals", True))
    values = {}
    for each in found.inputs:
        values[each.label] = [each.value, OF_STATISTICS * each.standard_error * each.value]
        values[f"{each.label}: standard error"] = [each.standard_error, OF_STATISTICS * each.standard_error]
        for side, end in zip(("low", "high"), each.interval_95, strict=True):
            if 0 < end < math.inf:
                values[f"{each.label}: {side}"] = [end, 2 * OF_STATISTICS * each.standard_error * end]
    spread = np.sqrt(np.diag(found.covariance)).max()
    for i in range(0, rows, 5):
        values[f"friction {i}"] = [float(found.friction[i]), OF_STATISTICS * spread * abs(float(found.friction[i]))]
    words = {"outcome": found.outcome.name, "at bound": " ".join(each.label for each in found.inputs if each.at_bound)}
    return {"words": words, "values": values}


def diagram(case):
    """Return what a phase diagram gives."""
    problem, parts = problem_of(case)
    axes = {name: case["axes"][name] for name in case["axes"]}
    found = sb.phase_diagram(problem, **axes, rtol=case["rtol"], **parts)
    values = {}
    for i, (friction, error) in enumerate(zip(found.friction.values.flat, found.friction_error.values.flat, strict=True)):
        values[f"friction {i}"] = [float(friction), float(error)]
    least = OF_PLACE * case["rtol"]
    places = {
        "speed_at_5_percent_fluid": least,
        "speed_at_half_fluid": least,
        "speed_at_10_percent_contact_friction": least,
        "speed_at_minimum": math.sqrt(least),
        "friction_at_minimum": least,
    }
    for name, relative in places.items():
        if name in found:
            for i, value in enumerate(found[name].values.flat):
                values[f"{name} {i}"] = [float(value), relative * abs(float(value))]
    words = {
        "regimes": " ".join(map(str, found.regime.values.flat)),
        "outcomes": " ".join(sorted(set(found.outcome.values.flat))),
    }
    return {"words": words, "values": values}


def margins(case):
    """Return by which factors the regime of a contact changes."""
    contact, _ = problem_of(case)
    found = regime_margins(contact, rtol=case["rtol"])
    values, words = {}, {"regime": found.regime}
    for margin in found.margins:
        for side in ("less", "more"):
            mark = getattr(margin, side)
            words[f"{margin.name} {side}"] = "none" if mark is None else mark.regime
            if mark is not None:
                values[f"{margin.name} {side}"] = [mark.factor, OF_PLACE * case["rtol"] * abs(mark.factor)]
    return {"words": words, "values": values}


def sweep(case):
    """Return what a small sweep gives."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "sweep.toml"
        file.write_text(case["toml"])
        found = sb.sweep(file, Path(folder) / "store").to_dataset().load()
    values = {}
    for i in range(found.outcome.size):
        for name in ("central_gap", "minimum_gap", "contact_load_share", "friction_balanced", "friction_published"):
            values[f"{name} {i}"] = [float(found[name].values.flat[i]), float(found[f"{name}_error"].values.flat[i])]
    return {"words": {"outcomes": " ".join(found.outcome.values.flat)}, "values": values}


KINDS = {"state": state, "curve": curve, "fit": fit, "diagram": diagram, "margins": margins, "sweep": sweep}


def observed(case):
    """Return what the package gives for a case today, but for what is known not to be the same on all processors."""
    left_out = tuple(case.get("without", ()))
    found = KINDS[case["kind"]](case)
    return {part: {name: each for name, each in found[part].items() if not name.startswith(left_out)} for part in found}


def finite(number):
    """Return a number, nan for None and infinity, of which the file holds neither."""
    return math.nan if number is None or math.isinf(number) else float(number)


def faults(case, old, new):
    """Return in sentences where what was observed differs by more than both stated errors, or states a far larger error."""
    found = []
    # Errors that rounding leaves are those of a processor: one and a thousand times as much are stated of the same state.
    unjudged = PLACES if old["words"].get("outcome") != "ROUNDING" else old["values"].keys()
    for name in sorted(old["words"].keys() | new["words"].keys()):
        was, now = old["words"].get(name), new["words"].get(name)
        if was != now:
            found.append(f"{name} was {was!r} and is {now!r}")
    for name in sorted(old["values"].keys() | new["values"].keys()):
        if name not in old["values"] or name not in new["values"]:
            found.append(f"{name} is {'new' if name in new['values'] else 'missing'}")
            continue
        was, wide, now, width = (finite(each) for each in (*old["values"][name], *new["values"][name]))
        if math.isnan(was) and math.isnan(now):
            continue
        allowed = sum(each for each in (wide, width) if math.isfinite(each)) + ROUNDING * abs(was)
        if not abs(now - was) <= allowed:
            found.append(f"{name} was {was:.12g} and is {now:.12g}, {abs(now - was):.2g} away; the errors allow {allowed:.2g}")
        if name not in unjudged and math.isfinite(wide) and not width <= GROWTH * wide + ROUNDING * abs(was):
            found.append(f"the stated error of {name} was {wide:.2g} and is {width:.2g}")
    return [f"{sentence}: {case}" for sentence in found]
