"""The charts of the page as plain data for ``chart.js``: friction, gap, pressures, shape, film of a ball, map of regimes."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from stribeck._types import Array
from stribeck.contacts.friction import DEFINITIONS, Definition
from stribeck.contacts.friction_rules import RULES, speed_words
from stribeck.explorer.answer import Answer
from stribeck.explorer.curves import Curve, decade_of_roughness, hersey_scale, round_down, round_up
from stribeck.fits.measurements import UNITS
from stribeck.fits.result import Fit
from stribeck.plot.style import readable_unit
from stribeck.profiles.profile import Departure
from stribeck.solver.fields import Field

Options = dict[str, Any]

DEFINITION_LABELS: dict[Definition, str] = {"balanced": "balanced", "published": "as published"}


def all_charts(answer: Answer) -> dict[str, Options]:
    """Return the options of all charts."""
    found = {
        "friction": friction_chart(answer),
        "gap": gap_chart(answer),
        "pressure": pressure_chart(answer),
        "diagram": diagram_chart(answer),
    }
    profile = answer.inputs.contact.groups.model.profile
    if isinstance(profile, Departure):
        found["shape"] = shape_chart(profile, answer)
    return found if answer.plane is None else found | {"plane": plane_chart(answer.plane, answer)}


def friction_chart(answer: Answer) -> Options:
    """Return the sizes of friction over the speed or the Hersey number, with the present point, pins and measured curves."""
    inputs, curve, over_speed = answer.inputs, answer.curve, answer.inputs.abscissa == "speed"
    contact, chosen = inputs.contact, inputs.case.definition
    scale = 1.0 if over_speed else hersey_scale(contact)
    ends = answer.speeds[0] * scale, answer.speeds[1] * scale
    friction = abs(answer.solution.friction(definition=chosen).total)
    heights, series = [friction], list[Options]()
    if curve is not None:
        x, size, old = curve.speed * scale, curve.sizes, "curve" in answer.stale
        others = [each for each in DEFINITIONS if each != chosen]
        for definition in (chosen, *others):
            heights += _range(size[definition])
        series += [
            line("friction", DEFINITION_LABELS[chosen], x, size[chosen], "main", old),
            *(line("other", DEFINITION_LABELS[each], x, size[each], faint=old) for each in others),
            line("contact", "from asperities", x, np.abs(curve.friction[chosen].asperities), faint=old),
            line("fluid", "from the fluid", x, np.abs(curve.friction[chosen].fluid), faint=old),
        ]
        if curve.band is not None and not old:
            lower, upper = curve.band.along(curve.speed, size[chosen])
            there = np.isfinite(lower)
            heights += [*_range(lower[lower > 0.1 * size[chosen]]), *_range(upper[there])]
            series.insert(0, area("spread", "95 % by errors of the inputs", (lower[there], upper[there]), x[there], along="y"))
        if not old:
            if curve.found.law_in_doubt.any():
                series.append(_doubtful_stretches(x, curve.found.law_in_doubt))
            series.insert(0, _regime_bands(curve, answer.speeds, scale))  # which would cover the area
    for i, pin in enumerate(answer.pins):
        if pin.curve is not None:
            values = pin.curve.sizes[pin.definition]
            heights += _range(values)
            factor = 1.0 if over_speed else hersey_scale(pin.contact)
            series.append(line(f"pin{i}", pin.name, pin.curve.speed * factor, values))
    for i, found in enumerate(answer.measured):
        heights += _range(found.friction)
        places = found.places(contact, inputs.abscissa) * scale
        series.append(_series(f"measured{i % 3}", found.name, "points", _pairs(places, found.friction)))
    low, high = _friction_limits(heights)
    if curve is not None and "curve" not in answer.stale and "minimum" in curve.marks:
        at = curve.marks["minimum"].value * scale
        series.append(line("minimum", "minimum friction", np.full(2, at), np.array([low, high])))
    series.append(_point(contact.speed * scale if contact.speed > 0 else ends[0], friction))
    symbol = RULES[contact.groups.geometry].hersey_symbol.replace("_N", "")
    across = axis(f"{speed_words(contact)} U", "m/s", *ends) if over_speed else axis(f"Hersey number {symbol}", "", *ends)
    drag = {"name": "speed", "scale": scale}
    return {"x": across, "y": axis("friction coefficient µ", "", low, high), "series": series, "drag": drag}


def gap_chart(answer: Answer) -> Options:
    """Return the gap along the contact, with the roughness."""
    contact, profile, hertz = answer.inputs.contact, answer.profile, answer.inputs.contact.hertz
    x, across = _along(answer)
    factor, unit = readable_unit("length", hertz.indentation * float(np.abs(profile.gap).max()))
    values, rms = factor * hertz.indentation * profile.gap, factor * contact.roughness
    positive = values[values > 0]
    lowest = float(positive.min()) if len(positive) else 1e-6 * factor * hertz.indentation
    series = [line("gap", "gap", x, np.where(values > 0, values, np.nan), "main")]
    shown = [lowest, float(values.max())]
    if rms > 0.03 * lowest:
        shown.append(rms)
        series.append(line("rms", "roughness", x[[0, -1]], np.full(2, rms), "plain"))
    return {"x": across, "y": axis("gap", unit, round_down(0.95 * min(shown)), round_up(max(shown))), "series": series}


def pressure_chart(answer: Answer) -> Options:
    """Return the pressures along the contact, with that of Hertz."""
    hertz, profile = answer.inputs.contact.hertz, answer.profile
    x, across = _along(answer)
    factor, unit = readable_unit("pressure", hertz.pressure)
    total, solid, fluid = (
        factor * hertz.pressure * each for each in (profile.pressure, profile.contact_pressure, profile.fluid_pressure)
    )
    inside = np.linspace(-1, 1, 101)
    series = [
        line("total", "total", x, total, "main"),
        line("contact", "asperities", x, solid),
        line("fluid", "fluid", x, fluid),
        line("hertz", "Hertz", inside * x[-1] / profile.x[-1], factor * hertz.pressure * np.sqrt(1 - inside**2), "other"),
    ]
    most = max(factor * hertz.pressure, float(total.max()), float(fluid.max()))
    lowest = min(0.0, float(fluid.min()), float(total.min()))
    high = round_up(1.02 * most)
    low = 0.0 if lowest > -0.01 * high else -round_up(-1.02 * lowest)
    return {"x": across, "y": axis("pressure", unit, low, high, log=False), "series": series}


def shape_chart(profile: Departure, answer: Answer) -> Options:
    """Return the undeformed shape of a body that is no parabola, above its lowest point, where gap and pressures are drawn."""
    end = float(answer.profile.x[-1])
    x = np.union1d(np.linspace(-end, end, 801), profile.places[np.abs(profile.places) < end])
    height = profile.shape.gap(profile.direction * (profile.origin + profile.length * x))
    height = height - height.min()
    factor, unit = readable_unit("length", float(height.max()))
    _, across = _along(answer)
    scale, high = across["high"] / end, round_up(1.02 * factor * float(height.max()))
    dry = np.full(2, scale)
    series = [
        area("spread", "dry contact", (-dry, dry), np.array([0.0, high])),
        line("shape", "undeformed shape", scale * x, factor * height, "main"),
    ]
    return {"x": across, "y": axis("height", unit, 0.0, high, log=False), "series": series}


def plane_chart(plane: Field, answer: Answer) -> Options:
    """Return the film of a ball on its plane as colours, on a logarithmic scale."""
    hertz = answer.inputs.contact.hertz
    end = float(np.max(plane.x)) * hertz.half_width
    factor, unit = readable_unit("length", end)
    gap = np.maximum(plane.gap, 1e-300) * hertz.indentation
    most = 20 * float(gap[0, gap.shape[1] // 2])
    # The thinnest place lies between those of the map.
    low, high = min(float(gap.min()), answer.solution.minimum_gap * hertz.indentation), min(float(gap.max()), most)
    film = _series("film", "film", "film", np.round(np.log10(np.clip(gap, low, high)), 3).ravel().tolist())
    film |= {"columns": gap.shape[1], "low": math.log10(low), "high": math.log10(high), "beyond": bool(most < gap.max())}
    x, y = (axis(f"position {name}", unit, -factor * end, factor * end, log=False) for name in ("x", "y"))
    return {"x": x | {"name": f"{x['name']}; fluid enters left"}, "y": y, "series": [film]}


def diagram_chart(answer: Answer) -> Options:
    """Return the regimes over speed and roughness at the present load, with the present point and the path of the speed."""
    diagram, contact, old = answer.diagram, answer.inputs.contact, "diagram" in answer.stale
    low, high = answer.speeds
    decade = decade_of_roughness(contact)
    ends, series = (10.0 ** (decade + 6), 10.0 ** (decade + 9)), list[Options]()
    if diagram is not None:
        ends = 1e6 * float(diagram.roughness[0]), 1e6 * float(diagram.roughness[-1])
        known = ~np.isnan(diagram.lines[:2]).any(axis=0)
        rows, (b, h, least) = 1e6 * diagram.roughness[known], diagram.lines[:, known]
        h = np.clip(h, low, high)
        b = np.minimum(np.clip(b, low, high), h)
        edges = (np.full(len(rows), low), b, h, np.full(len(rows), high))
        if len(rows) > 1:
            for name, one, two in zip(("boundary", "mixed", "hydrodynamic"), edges, edges[1:], strict=False):
                series += [area(name, name, (one, two), rows, quiet=True, faint=old), *_region_name(name, one, two, rows)]
            for key, words, speed, look in (
                ("end", "boundary ends", b, "contact"),
                ("begin", "hydrodynamic begins", h, "fluid"),
                ("minimum", "minimum friction", least, ""),
            ):
                inside = (speed > low) & (speed < high)
                series.append(line(key, words, np.where(inside, speed, np.nan), rows, look, old))
    height = min(max(1e6 * contact.roughness, ends[0]), ends[1])
    path = line("path", "changing speed", np.array([low, high]), np.full(2, height), "plain")
    series += [path | {"quiet": True}, _point(min(max(contact.speed, low), high), height)]
    across, drag = axis(f"{speed_words(contact)} U", "m/s", low, high), {"name": "speed", "scale": 1.0}
    return {"x": across, "y": axis("roughness", "µm", *ends), "series": series, "drag": drag}


def residual_chart(found: Fit) -> Options:
    """Return the residuals of a fit over what was measured."""
    data, residuals = found.data, np.asarray(found.residuals)
    x, reach = np.asarray(data.values), round_up(max(3.0, 1.1 * float(np.abs(residuals).max())))
    ends = round_down(0.99 * float(x.min())), round_up(1.01 * float(x.max()))
    series = [line("rms", "zero", np.array(ends), np.zeros(2), "plain") | {"quiet": True}]
    for k, name in enumerate(data.curves):
        mine = data.curve == k
        series.append(_series(f"measured{k % 3}", name, "points", _pairs(x[mine], residuals[mine])))
    unit = UNITS[data.abscissa]
    across = axis(data.abscissa.replace("_", " "), "" if unit == "1" else unit, *ends)
    return {"x": across, "y": axis("residual/error", "", -reach, reach, log=False), "series": series}


def axis(name: str, unit: str, low: float, high: float, log: bool = True) -> Options:
    """Return an axis between two ends."""
    return {"name": f"{name} ({unit or '–'})", "unit": unit, "low": low, "high": high, "log": log}


def _series(key: str, name: str, kind: str, data: Any, look: str = "", faint: bool = False, quiet: bool = False) -> Options:
    """Return a series; without ``look`` it has that of its key."""
    found = {"id": key, "name": name, "type": kind, "data": data} | ({"look": look} if look else {})
    return found | ({"faint": True} if faint else {}) | ({"quiet": True} if quiet else {})


def line(key: str, name: str, x: Array, y: Array, look: str = "", faint: bool = False) -> Options:
    """Return a line through points, as a series."""
    return _series(key, name, "line", _pairs(x, y), look, faint)


def area(key: str, name: str, ends: tuple[Array, Array], at: Array, along: str = "x", **options: Any) -> Options:
    """Return the area between two ends along one axis, at places along the other."""
    points = [*zip(ends[0], at, strict=True), *zip(ends[1][::-1], at[::-1], strict=True)]
    outline = np.array(points).reshape(-1, 2).T
    return _series(key, name, "area", _pairs(*(outline if along == "x" else outline[::-1])), **options)


def _point(x: float, y: float) -> Options:
    """Return the mark of the present point, as a series."""
    return _series("point", "present point", "points", [[x, y]], quiet=True)


def _pairs(x: Array, y: Array) -> list[list[float | None]]:
    """Return points, null where there is none, rounded to what a screen can show."""
    points = np.stack([x, y], axis=1).astype(float)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        unit = 10.0 ** (5 - np.floor(np.log10(np.abs(points))))
        rounded = np.where((points == 0) | ~np.isfinite(unit), points, np.round(points * unit) / unit)
    if np.isfinite(rounded).all():
        return rounded.tolist()  # type: ignore[no-any-return]
    return [[value if math.isfinite(value) else None for value in point] for point in rounded.tolist()]


def _region_name(name: str, one: Array, two: Array, rows: Array) -> list[Options]:
    """Return the label of a regime where its region is widest; none if it is too narrow."""
    width, place = np.log10(two / one), np.arange(len(rows)) / len(rows)
    i = int(np.argmax(np.where((place < 0.1) | (place > 0.8), -1.0, width)))
    if width[i] <= 0.33 * math.log10(two.max() / one.min()):
        return []
    return [_series(f"name-{name}", name, "text", [[math.sqrt(one[i] * two[i]), float(rows[i])]])]


def _regime_bands(curve: Curve, ends: tuple[float, float], scale: float) -> Options:
    """Return the background of the regimes behind a curve."""
    low, high = ends
    first, last = curve.marks.get("boundary"), curve.marks.get("hydrodynamic")
    b = low if first is None else min(max(first.value, low), high)
    h = (high if first is not None else b) if last is None else min(max(last.value, b), high)
    pieces = (("boundary", low, b), ("mixed", b, h), ("hydrodynamic", h, high))
    shown = [[start * scale, end * scale, name] for name, start, end in pieces if end > start * 1.0001]
    return _series("bands", "regimes", "bands", shown)


def _doubtful_stretches(x: Array, doubtful: Array) -> Options:
    """Return the stretches along the axis where the contact law is outside its range."""
    edges = np.concatenate([x[:1], np.sqrt(x[:-1] * x[1:]), x[-1:]])
    turns = np.flatnonzero(np.diff(np.concatenate([[False], doubtful, [False]]).astype(int)))
    return _series("doubtful", "contact law outside its range", "hatch", edges[turns].reshape(-1, 2).tolist())


def _range(values: Array) -> list[float]:
    positive = values[values > 0]
    return [float(positive.min()), float(positive.max())] if len(positive) else []


def _friction_limits(values: Sequence[float]) -> tuple[float, float]:
    """Return ends of the axis of friction at few places, so that it stays still while a slider moves."""
    positive = [value for value in values if value > 0] or [1e-3, 1.0]
    return round_down(min(positive) / 3), round_up(max(positive) * 1.6)  # with room for the names of the regimes


def _along(answer: Answer) -> tuple[Array, Options]:
    """Return positions along the contact in a readable unit, and their axis."""
    a, reach = answer.inputs.contact.hertz.half_width, float(answer.profile.x[-1])
    factor, unit = readable_unit("length", a * reach)
    end = float(f"{factor * a * reach:.6g}")
    found = axis("position x", unit, -end, end, log=False)
    return factor * a * answer.profile.x, found | {"name": f"{found['name']}; fluid enters left"}
