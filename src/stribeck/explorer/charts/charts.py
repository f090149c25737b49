"""The four charts of the page: friction, gap, pressure, phase diagram, each as plain data by its own function."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from stribeck._types import Array
from stribeck.contacts.friction import Definition
from stribeck.contacts.friction_rules import RULES, speed_words
from stribeck.explorer.answer import Answer, round_down, round_up
from stribeck.explorer.charts.palette import PIN_DASHES, Palette
from stribeck.explorer.charts.parts import Options, chart, line, linear_axis, log_axis, marker, pairs, points
from stribeck.explorer.curves import Curve, decade_of_roughness, hersey_scale
from stribeck.explorer.measured import Measured, speeds_of
from stribeck.quantities.formats import format_si
from stribeck.quantities.units import DIMENSIONS
from stribeck.solver.point.solution import Field

__all__ = ["DEFINITION_LABELS", "all_charts"]

# Labels of the definitions of friction.
DEFINITION_LABELS: dict[Definition, str] = {"balanced": "balanced", "published": "as published"}


def all_charts(
    answer: Answer, pins: Sequence[tuple[str, Curve, float]], measured: Sequence[Measured], palette: Palette
) -> dict[str, Options]:
    """Return the options of all charts."""
    return {
        "friction": friction_chart(answer, pins, measured, palette),
        "gap": gap_chart(answer, palette),
        "pressure": pressure_chart(answer, palette),
        "diagram": diagram_chart(answer, palette),
    } | ({} if answer.plane is None else {"plane": plane_chart(answer.plane, answer, palette)})


def axis_of(answer: Answer, measured: Sequence[Measured]) -> tuple[float, float]:
    """Return the ends of the axis of speeds, in whole decades farther where something was measured beyond [m/s]."""
    low, high = answer.speeds
    speeds = speeds_of(measured, answer.inputs)
    if speeds:
        low = min(low, 10.0 ** math.floor(math.log10(min(speeds)) + 1e-9))
        high = max(high, 10.0 ** math.ceil(math.log10(max(speeds)) - 1e-9))
    return low, high


def friction_chart(
    answer: Answer, pins: Sequence[tuple[str, Curve, float]], measured: Sequence[Measured], palette: Palette
) -> Options:
    """Return friction over the speed or the Hersey number, with the present point, pins and measured curves."""
    inputs, curve = answer.inputs, answer.curve
    contact = inputs.contact
    hersey, symbol = hersey_scale(contact), RULES[contact.groups.geometry].hersey_symbol.replace("_N", "")
    scale = 1.0 if inputs.abscissa == "speed" else hersey
    ends = axis_of(answer, measured)
    ends = ends[0] * scale, ends[1] * scale
    chosen = inputs.definition
    other: Definition = "balanced" if chosen == "published" else "published"
    names = DEFINITION_LABELS
    series: list[Options] = []
    heights: list[float] = []
    if curve is not None:
        x = curve.speed * scale
        # Sizes: where the cylinder is the faster body the substrate is dragged along.
        solid, viscous = np.abs(curve.contact), np.abs(curve.friction[chosen] - curve.contact)
        size = {kind: np.abs(values) for kind, values in curve.friction.items()}
        heights += [*_range(size[chosen]), *_range(size[other])]
        series += [
            line("other", names[other], x, size[other], palette.grey, 1.2, [3, 3]),
            line("contact", "from asperities", x, solid, palette.contact, 1.4, [7, 3]),
            line("viscous", "from the fluid", x, viscous, palette.fluid, 1.4, [9, 3, 2, 3]),
            line("friction", names[chosen], x, size[chosen], palette.ink, 2.4),
        ]
        if curve.band is not None:
            lower, upper = curve.band.along(curve.speed, size[chosen])
            heights += [*_range(lower[lower > 0.1 * size[chosen]]), *_range(upper)]
            there = np.isfinite(lower)
            floor = np.maximum(lower, 1e-3 * size[chosen])[there]
            outline = [*pairs(x[there], upper[there]), *pairs(x[there][::-1], floor[::-1])]
            band = {"id": "spread", "name": "95 % by errors of the inputs", "type": "area", "data": outline}
            series.insert(0, band | {"color": palette.ink, "opacity": 0.14, "width": 8, "dash": []})
        if curve.doubtful.any() and not curve.stale:
            series.append(_doubtful_stretches(x, curve.doubtful, palette))
        if curve.stale:
            for old in series:
                old["opacity"] = 0.25
        series.append(_regime_bands(curve, answer.speeds, scale, palette))
    for i, (name, pinned, their_hersey) in enumerate(pins):
        factor = 1.0 if inputs.abscissa == "speed" else their_hersey
        values = np.abs(pinned.friction[chosen])
        heights += _range(values)
        series.append(line(f"pin{i}", name, pinned.speed * factor, values, palette.pins[i % 6], 1.8, PIN_DASHES[i % 6]))
    for i, found in enumerate(measured):
        heights += _range(found.friction)
        symbol = ("circle", "diamond", "triangle")[i % 3]
        places = found.places(contact, inputs.abscissa) * scale
        series.append(points(f"measured{i}", found.name, places, found.friction, symbol, palette.ink))
    friction = abs(answer.solution.friction(definition=chosen).total)
    heights += [friction] if friction > 0 else []
    low, high = _friction_limits(heights)
    minimum = None if curve is None else curve.transition("minimum")
    if minimum is not None:
        x = np.full(2, minimum.speed * scale)
        series.append(line("minimum", "minimum friction", x, np.array([low, high]), palette.mark, 1.4, [2, 3]))
    series.append(marker(contact.speed * scale if contact.speed > 0 else ends[0], friction, palette))
    abscissa = f"{speed_words(contact)} U (m/s)" if inputs.abscissa == "speed" else f"Hersey number {symbol} (–)"
    listed = [names[chosen], names[other], "from asperities", "from the fluid"] if curve is not None else []
    listed += [each["name"] for each in series if each["id"].startswith(("pin", "measured", "minimum", "doubtful", "spread"))]
    return chart(palette, log_axis(abscissa, *ends), log_axis("friction coefficient µ", low, high), series, listed)


def gap_chart(answer: Answer, palette: Palette) -> Options:
    """Return the gap along the contact, with the roughness and the formulas in whose range the state is."""
    contact, profile = answer.inputs.contact, answer.profile
    x_scale, x_unit, x_end = _length_axis(answer)
    values = profile.gap
    u, u_unit = _unit(contact.hertz.indentation * float(np.abs(values).max()), "length")
    scale = contact.hertz.indentation / u
    rms = contact.alpha * float(contact.groups.relative_roughness)
    positive = values[values > 0]
    lowest = float(positive.min()) if len(positive) else 1e-6
    shown = [lowest, float(values.max())]
    series = [line("gap", "gap", profile.x * x_scale, np.where(values > 0, values, np.nan) * scale, palette.ink, 2.2)]
    if rms > 0.03 * lowest:
        shown.append(rms)
        series.append(line("rms", "roughness", np.array([-x_end, x_end]), np.full(2, rms * scale), palette.grey, 1.2, [6, 4]))
    series += _thin_series(answer, ("gap",), x_scale, scale, palette)
    low, high = round_down(0.95 * min(shown) * scale), round_up(max(shown) * scale)
    x = linear_axis(f"position x ({x_unit})", -x_end, x_end)
    return chart(palette, x, log_axis(f"gap ({u_unit})", low, high), series, [each["name"] for each in series])


def pressure_chart(answer: Answer, palette: Palette) -> Options:
    """Return the pressures along the contact, with that of Hertz and the formulas in whose range the state is."""
    contact, profile = answer.inputs.contact, answer.profile
    x_scale, x_unit, x_end = _length_axis(answer)
    unit, name = _unit(contact.hertz.pressure, "pressure")
    scale = contact.hertz.pressure / unit
    x = profile.x * x_scale
    hertz_x = np.linspace(-1, 1, 101)
    series = [
        line("total", "total", x, profile.pressure * scale, palette.ink, 2.2),
        line("contact", "asperities", x, profile.contact_pressure * scale, palette.contact, 1.8, [7, 3]),
        line("fluid", "fluid", x, profile.fluid_pressure * scale, palette.fluid, 1.8, [9, 3, 2, 3]),
        line("hertz", "Hertz", hertz_x * x_scale, np.sqrt(1 - hertz_x**2) * scale, palette.grey, 1.2, [2, 3]),
    ]
    series += _thin_series(answer, ("pressure", "contact_pressure", "fluid_pressure"), x_scale, scale, palette)
    most = max(1.0, float(profile.pressure.max()), float(profile.fluid_pressure.max())) * scale
    lowest = min(0.0, float(profile.fluid_pressure.min()), float(profile.pressure.min())) * scale
    high = round_up(1.02 * most)
    low = 0.0 if lowest > -0.01 * high else -round_up(-1.02 * lowest)
    axis = linear_axis(f"position x ({x_unit}); fluid enters left", -x_end, x_end)
    return chart(palette, axis, linear_axis(f"pressure ({name})", low, high), series, [each["name"] for each in series])


def plane_chart(plane: Field, answer: Answer, palette: Palette) -> Options:
    """Return the film of a ball on its plane as colours, on a logarithmic scale."""
    hertz = answer.inputs.contact.hertz
    end = float(np.max(plane.x)) * hertz.half_width
    unit, name = _unit(end, "length")
    gap = np.maximum(plane.gap, 1e-300) * hertz.indentation
    most = 20 * float(gap[0, gap.shape[1] // 2])
    # The thinnest place lies between those of the map.
    low, high = min(float(gap.min()), answer.solution.minimum_gap * hertz.indentation), min(float(gap.max()), most)
    drawn = {"id": "film", "name": "film", "type": "film", "colours": FILM_COLOURS, "columns": gap.shape[1]}
    drawn |= {"low": math.log10(low), "high": math.log10(high)}
    drawn["data"] = np.round(np.log10(np.clip(gap, low, high)), 3).ravel().tolist()
    x = linear_axis(f"position x ({name}); fluid enters left", -end / unit, end / unit)
    made = chart(palette, x, linear_axis(f"position y ({name})", -end / unit, end / unit), [drawn])
    beyond = "≥ " if most < gap.max() else ""
    words = [format_si(low, "length", 3), beyond + format_si(high, "length", 3)]
    scale = {"words": words, "colours": FILM_COLOURS}
    return made | {"scale": scale, "square": True, "margin": {"left": 50, "bottom": 84}}


# Colours of the film of a ball, from thin to thick, as in pictures.
FILM_COLOURS = ["#440154", "#3b528b", "#21918c", "#5ec962", "#fde725"]


def diagram_chart(answer: Answer, palette: Palette) -> Options:
    """Return the regimes over speed and roughness at the present load, with the present point and the path of the speed."""
    diagram, contact = answer.diagram, answer.inputs.contact
    low, high = answer.speeds
    series: list[Options] = []
    decade = decade_of_roughness(contact)
    roughness = np.array([10.0 ** (decade + 6), 10.0 ** (decade + 9)])
    lines = np.empty((3, 0)) if diagram is None else np.stack([diagram.boundary, diagram.hydrodynamic, diagram.minimum])
    known = np.asarray(~np.isnan(lines[:2]).any(axis=0))
    if diagram is not None:
        roughness = 1e6 * diagram.roughness
    begin = np.clip(lines[1], low, high)
    end = np.minimum(np.clip(lines[0], low, high), begin)
    is_there = known.sum() > 1 and diagram is not None
    if not is_there:
        known = np.zeros_like(known)
    rows = roughness[: len(known)][known]
    left, right = np.full(len(rows), low), np.full(len(rows), high)
    b, h = end[known], begin[known]
    if is_there:
        for name, one, two in (("boundary", left, b), ("mixed", b, h), ("hydrodynamic", h, right)):
            outline = [*pairs(one, rows), *pairs(two[::-1], rows[::-1])]
            series.append({"id": f"area-{name}", "name": name, "type": "area", "data": outline, "color": palette.tints[name]})
            series.append(_region_name(name, one, two, rows, palette))
    if is_there and diagram is not None:
        inside = (b > low) & (b < high)
        series.append(line("end", "boundary ends", np.where(inside, b, np.nan), rows, palette.contact, 1.8, [7, 3]))
        inside = (h > low) & (h < high)
        series.append(line("begin", "hydrodynamic begins", np.where(inside, h, np.nan), rows, palette.fluid, 1.8))
        lowest = lines[2, known]
        lowest = np.where((lowest > low) & (lowest < high), lowest, np.nan)
        series.append(line("minimum", "minimum friction", lowest, rows, palette.mark, 1.6, [2, 3]))
        if diagram.stale:
            for old in series:
                old["opacity"] = 0.25
    height = min(max(1e6 * contact.roughness, float(roughness[0])), float(roughness[-1]))
    series.append(line("path", "changing speed", np.array([low, high]), np.full(2, height), palette.grey, 1.0, [4, 4]))
    series.append(marker(min(max(contact.speed, low), high), height, palette))
    listed = ["boundary ends", "hydrodynamic begins", "minimum friction"]
    names = [name for name in listed if any(each["name"] == name for each in series)]
    y = log_axis("roughness (µm)", float(roughness[0]), float(roughness[-1]))
    return chart(palette, log_axis(f"{speed_words(contact)} U (m/s)", low, high), y, series, names)


def _region_name(name: str, one: Array, two: Array, rows: Array, palette: Palette) -> Options:
    """Return the label of a regime where its region is widest; none if it is too narrow."""
    width = np.log10(two / one)
    place = np.arange(len(rows)) / len(rows)
    i = int(np.argmax(np.where((place < 0.1) | (place > 0.8), -1.0, width)))
    wide = width[i] > 0.33 * math.log10(two.max() / one.min())
    data = [[math.sqrt(one[i] * two[i]), float(rows[i])]] if wide else []
    return {"id": f"name-{name}", "name": f"{name} region", "type": "text", "data": data, "words": name, "color": palette.grey}


def _regime_bands(curve: Curve, ends: tuple[float, float], scale: float, palette: Palette) -> Options:
    """Return the background of the regimes behind a curve."""
    low, high = (end * scale for end in ends)
    first, last = curve.transition("boundary"), curve.transition("hydrodynamic")
    b = low if first is None else min(max(first.speed * scale, low), high)
    h = (high if first is not None else b) if last is None else min(max(last.speed * scale, b), high)
    pieces = (("boundary", low, b), ("mixed", b, h), ("hydrodynamic", h, high))
    shown = [
        [start, end, palette.tints[name], name] for name, start, end in pieces if end > start * 1.0001 and not curve.stale
    ]
    return {"id": "bands", "name": "regimes", "type": "bands", "data": shown}


def _doubtful_stretches(x: Array, doubtful: Array, palette: Palette) -> Options:
    """Return the stretches along the axis where the contact law is outside its range."""
    edges = np.sqrt(x[:-1] * x[1:])
    lows, highs = np.append(x[0], edges), np.append(edges, x[-1])
    turns = np.flatnonzero(np.diff(np.concatenate([[False], doubtful, [False]]).astype(int)))
    data = [[float(lows[first]), float(highs[last - 1])] for first, last in zip(turns[::2], turns[1::2], strict=True)]
    look = {"color": palette.contact, "width": 6, "dash": [2, 2]}
    return {"id": "doubtful", "name": "contact law outside its range", "type": "hatch", "data": data, **look}


def _thin_series(answer: Answer, fields: Sequence[str], x_scale: float, scale: float, palette: Palette) -> list[Options]:
    return [
        line(
            f"thin-{found.name}",
            f"{found.name.rpartition('.')[2].replace('_', ' ')} (±{100 * found.worst:.2g} %)",
            found.x * x_scale,
            np.where(found.value > 0, found.value, np.nan) * scale if found.predicts == "gap" else found.value * scale,
            palette.thin,
            1.0,
        )
        for found in answer.thin
        if found.predicts in fields
    ]


def _range(values: Array) -> list[float]:
    positive = values[values > 0]
    return [float(positive.min()), float(positive.max())] if len(positive) else []


def _friction_limits(values: Sequence[float]) -> tuple[float, float]:
    """Return ends of the axis of friction in whole or third decades, so that it stays still while a slider moves."""
    low, high = (min(values), max(values)) if values else (1e-3, 1.0)
    return round_down(low / 3), round_up(high * 1.25)


def _length_axis(answer: Answer) -> tuple[float, str, float]:
    """Return the factor from half-widths to a unit, its name, and the end of the axis in it."""
    a = answer.inputs.contact.hertz.half_width
    unit, name = _unit(a * answer.reach, "length")
    return a / unit, name, float(f"{a * answer.reach / unit:.6g}")


def _unit(value: float, dimension: str) -> tuple[float, str]:
    """Return the unit in which a value reads best, its size and its name."""
    name = format_si(value, dimension).rpartition(" ")[2]
    power = next(power for power, known in DIMENSIONS[dimension].steps.items() if known == name)
    return 10.0**power, name
