"""Tables as test rigs write them: forces in place of friction, mean speeds, both surfaces' speeds.

A mean speed is never taken for the sum of the surface speeds, nor the other way round: where a file leaves open which it has,
the reader asks.
"""

import math
import re
from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

from stribeck._types import Array
from stribeck.cases.fit_settings import FitSettings
from stribeck.files.cells import decimal_of, is_named, normalised_header, rows_listed
from stribeck.files.columns import has_dimension, refuse_late_value, refuse_two_values, si_factor, stated_in
from stribeck.files.text_table import TextTable
from stribeck.fits.repeats import FEWEST
from stribeck.fits.values import MADE_FRICTION, dimension_of, is_set, named_in_case, numbers, undeclared, unit_in
from stribeck.quantities.formats import format_si
from stribeck.quantities.units import InputError, listed, show

UNITLESS = ("slide_to_roll", "run")  # Those without a unit, but for per cent

FORCES = frozenset({"friction_force", "torque"})
SPEEDS = frozenset({"entrainment_speed", "sliding_speed", "surface_speeds", "rotation"})  # What friction and speed are made of

_FORCE_OF = r"(?:(?:normal|ball|contact|vertical|applied|nominal|set|target|actual|measured|axial|mean|average|test) )"
_SPEED = r"(?:speed|velocity)"
_BODY = (
    r"(?:(?:ball|disc|disk|roller|ring|pin|wheel|cylinder|specimen|sample|counter ?(?:body|face|part)|kugel|scheibe|rolle|"
    r"probe|gegenkörper)|(?:upper|lower|top|bottom)(?: (?:ball|disc|disk|roller|ring|specimen|sample|body|surface))?) ?\d?"
)
_TURNS = rf"(?:(?:(?:rotation(?:al)?|rotary|angular) )?{_SPEED}|rpm|rotation|drehzahl|rotational frequency)"

# What a column of a rig may be beside those of a friction curve, and the words of its header, in lower case.
PATTERNS = {
    "entrainment_speed": rf"(?:mean|average)(?: (?:entrain\w*|rolling|surface))? {_SPEED}|"
    rf"(?:entrain\w*|rolling)(?: \w+)? {_SPEED}|{_SPEED} (?:mean|rolling)",
    "sliding_speed": rf"(?:(?:mean|average) )?(?:sliding|slip|rubbing) {_SPEED}",
    "surface_speeds": rf"(?:ball|disc|disk|upper|lower|roller|ring) ?\d? {_SPEED}",
    "slide_to_roll": r"srr|slide (to )?roll( ratio)?|slip ratio",
    "friction_force": r"(?:mean |average )?(?:friction(?:al)?|traction|tangential|lateral|shear) force|f ?[xtf]|ft|"
    r"(?:friction force|f ?[xtf]) (?:mean|average|avg)|reib(?:ungs)?kraft|friction",
    "normal_force": rf"(?:{_FORCE_OF}+force|{_FORCE_OF}*load|f ?[zn]|normalkraft)(?: mean| average| avg)?",
    "run": r"run|repeat|repetition|cycle|stroke|pass|step|sweep|test( no)?|lauf",
    "rotation": rf"n|(?:(?:spindle|shaft|motor|drive|set|actual) ?)?{_TURNS}|(?:{_BODY} ?)?{_TURNS}|"
    rf"{_TURNS} (?:(?:of|der) (?:the )?)?{_BODY}|{_BODY}",
    "torque": r"(?:friction(?:al)? |reib|dreh)?(?:torque|moment)",
}

# Names of the radius or diameter of a track, in a header or in text above it.
TRACK = (
    r"(?:(?:ball|disc|disk|wear|sliding|test|friction) )*track (?:radius|diameter|dia|r|d)|"
    r"(?:radius|diameter|dia) of (?:the )?(?:\w+ )?track|(?:reib|lauf|kreis)?(?:spur|bahn)(?:radius|durchmesser)|radius|r"
)

ARM = r"(?:(?:torque|lever|moment|force|friction) )?arm(?: length)?|hebelarm"  # Names of the arm of a torque

BOTH_MOVE = (
    "write a column 'mean speed [mm/s]', half the sum of the surface speeds, or 'sum of speeds [mm/s]', and one of the "
    "slide-to-roll ratio, 'SRR [%]', if it is not that of the case"
)

MADE_SPEED = "sum of speeds [m/s]"  # Header of the column of the speed that was made of others

# Headers of the columns of what is constant along each curve, made of columns that were measured.
MADE_LOAD, MADE_RATIO, MADE_CURVE = "load", "slide_to_roll", "curve"

_IN_BRACKETS = re.compile(
    r"\s*(?:at )?(?P<name>[A-Za-z ]+?)\s*[=:]?\s*(?P<value>[0-9]+(?:[.,][0-9]+)?)\s*(?P<unit>[A-Za-zµμ]+)\s*"
)

# Zero and size of units of temperatures in degrees Celsius.
TEMPERATURES = dict.fromkeys(("°C", "C", "degC", "deg C", "ºC"), (0.0, 1.0)) | {"K": (273.15, 1.0), "°F": (32.0, 5 / 9)}

TEMPERATURE_TOLERANCE = 0.1  # Difference of temperatures that a sentence does not tell apart

ROLLING_RATIO = 0.005  # Slide-to-roll ratio up to which it is that of pure rolling: what drives hold a ratio within

NEXT_LEVEL = 1.1  # Ratio of neighbouring values from which they belong to two settings, and not to the noise of one


def prepared(
    table: TextTable, settings: FitSettings, known: Callable[[str], bool], *, signed: bool = False
) -> tuple[TextTable, list[str], str, FitSettings, list[str]]:
    """Return the table with friction and speed, what was made of what, the header of runs, the settings, and what there is."""
    table = _with_stated_ratio(table, settings)
    found, source = _rig_columns(table, settings), table
    said, ours = list[str](), set[str]()
    of_forces = partial(_friction, signed=signed)
    for what, parts, make, header in (("friction", FORCES, of_forces, MADE_FRICTION), ("speed", SPEEDS, _speed, MADE_SPEED)):
        if known(what) and (what in settings.columns or not settings.columns.keys() & parts):
            continue
        made = make(table, _declared_first(found, parts, settings), settings)
        if made is not None:
            values, sentence = made
            table = table.with_column(header, _texts(values))
            for name in filter(None, table.written):
                if sentence.endswith(f"of column {show(name)}"):
                    table = table.without(name)  # the radius of a track is not that of the ball
            ours.add(what)
            said.append(sentence)
    for meaning, made_column in (("normal_force", MADE_LOAD), ("slide_to_roll", MADE_RATIO)):
        if meaning in found and not {made_column, "curve"} & settings.columns.keys() and not known("curve"):
            levelled, sentences = _levelled(table, found[meaning][0], meaning, made_column, settings)
            ours |= set() if levelled is table else {made_column}
            table = levelled
            said += sentences
    told = " ".join(said)
    idle = [
        f"{key} of [fit] is not used: no {noun} was needed."
        for key, noun, value in (("track_radius", "rotation", settings.track_radius), ("arm", "torque", settings.arm))
        if value is not None and f"{format_si(value, 'length', 4)} of the case" not in told
    ]
    marked = source.thousands_noted([name for name in source.written if show(name) in told])
    table = replace(table, notes=(*table.notes, *idle, *marked))
    units = {name: unit for name, unit in settings.units.items() if name not in ours}
    return table, said, found.get("run", [""])[0], replace(settings, units=units), [*found]


def _with_stated_ratio(table: TextTable, settings: FitSettings) -> TextTable:
    """Return the table with a slide-to-roll ratio that a line of text gives in a column, where it has none."""
    pattern = PATTERNS["slide_to_roll"]
    if "slide_to_roll" in settings.columns or any(is_named(name, pattern) for name in table.header):
        return table
    stated = [(number, name, f"{value} {unit}".strip()) for number, name, value, unit in stated_in(table, pattern)]
    if not stated:
        return table
    for number, name, text in stated[1:]:
        if text != stated[0][2]:
            refuse_two_values(table, (stated[0][0], number), (stated[0][1], name))
    refuse_late_value(table, *stated[0][:2])
    return table.with_column(stated[0][1], [stated[0][2]] * len(table.rows))


def _declared_first(found: dict[str, list[str]], meanings: frozenset[str], settings: FitSettings) -> dict[str, list[str]]:
    """Return the columns of a rig, of some meanings only those that the settings declare if they declare any."""
    declared = settings.columns.keys() & meanings
    return {key: names for key, names in found.items() if not declared or key not in meanings or key in declared}


def temperature_note(table: TextTable) -> tuple[str, ...]:
    """Return a sentence on the measured temperature, for which the viscosity of a case has to be; none without it."""
    found = temperatures(table)
    if found is None:
        return ()
    low, high = (float(end(found[0])) for end in (np.nanmin, np.nanmax))
    said = f"{low:.4g} °C" if high - low < TEMPERATURE_TOLERANCE else f"{low:.4g} to {high:.4g} °C"
    return (f"Temperature by {show(found[1])}: {said}; the viscosity of the case must be that at this temperature.",)


def _levelled(
    table: TextTable, name: str, meaning: str, made: str, settings: FitSettings
) -> tuple[TextTable, tuple[str, ...]]:
    """Return the table with a column of the values to which a measured column was set, and a sentence if there are several."""
    values = numbers(table, name, meaning, settings)
    if name == MADE_RATIO or np.isinf(values).any():
        return table, ()
    # Pure rolling is a setting; a load of zero is no contact.
    sizes = np.abs(values)
    still = sizes <= (ROLLING_RATIO if meaning == "slide_to_roll" else 0.0)
    column = np.where(still, 0.0 if meaning == "slide_to_roll" else np.nan, sizes)
    column[column > 0] = levels_of(column[column > 0])
    apart = (sizes > 0) & np.isnan(column)
    without = ""
    if apart.any():
        numbered = [number for number, each in zip(table.numbers, apart, strict=True) if each]
        without = f", without row{'s' * (len(numbered) > 1)} {rows_listed(numbered)}, near none"
        emptied = tuple(("",) * len(row) if each else row for row, each in zip(table.rows, apart, strict=True))
        table = replace(table, rows=emptied)
    several = np.unique(column[np.isfinite(column)])
    unit = "" if meaning == "slide_to_roll" else " N"
    listed = " and ".join(f"{value:g}{unit}" for value in several) + without
    row = settings.inputs.quantities.get(made)
    if row is None or row.dimension != ("number" if meaning == "slide_to_roll" else "force"):
        labels = [f"{value:g}{unit}" if np.isfinite(value) else "" for value in column]
        advice = f'; give the {made.replace("_", " ")} of each in [fit.curves."{labels[0]}"]'
        if len(several) < 2:
            return table, (f"{show(name)}: {listed}",) if without else ()
        if MADE_CURVE in table.header:
            at = table.header.index(MADE_CURVE)
            labels = [f"{cells[at]}, {label}" for cells, label in zip(table.rows, labels, strict=True)]
            table = table.without(MADE_CURVE)
        return table.with_column(MADE_CURVE, labels), (f"{show(name)}: a curve for each of {listed}{advice}",)
    sentence = f"{show(name)} as {made.replace('_', ' ')} of the curve{'s' * (len(several) > 1)}, {listed}"
    return table.without(name).with_column(f"{made} [N]" if unit else made, _texts(column)), (sentence,)


def levels_of(values: Array) -> Array:
    """Return the setting that each measured value belongs to: the median of those that lie together; NaN near none."""
    ordered = np.sort(values)
    groups = np.split(ordered, np.flatnonzero(ordered[1:] > NEXT_LEVEL * ordered[:-1]) + 1) if len(values) else []
    settings = [group for group in groups if len(group) >= FEWEST]
    # Values without noise were set, each of them; so were those of a table that has few rows at any.
    if not settings or all(np.ptp(group) == 0 for group in groups):
        settings = groups
    found = np.full(len(values), np.nan)
    for group in settings:
        found[(values >= group[0]) & (values <= group[-1])] = _rounded(float(np.median(group)))
    return found


def _rig_columns(table: TextTable, settings: FitSettings) -> dict[str, list[str]]:
    """Return what is in the table -> headers of its columns; those of the settings first, set values after measured ones."""
    found = {meaning: named_in_case(table, settings, meaning) for meaning in settings.columns if meaning in PATTERNS}
    for name in dict.fromkeys(undeclared(table, settings)):
        for meaning, pattern in PATTERNS.items():
            if meaning in settings.columns or not is_named(name, pattern):
                continue
            unit = unit_in(table, name, meaning, settings)
            if meaning not in UNITLESS and unit and not has_dimension(unit, dimension_of(meaning, settings)):
                continue
            if meaning == "run" and table.unit(name):
                continue  # a stroke in mm
            if meaning == "rotation" and is_named(name, _BODY) and not has_dimension(table.unit(name) or "-", "rotation"):
                continue  # what the ball is made of
            if meaning == "entrainment_speed" and is_mean_of_time(table, name, settings):
                continue
            if not unit and meaning in ("rotation", "torque") or (not unit and normalised_header(name) == "friction"):
                continue
            found.setdefault(meaning, []).append(name)
            break
    for names in found.values():
        names.sort(key=is_set)
    return found


def is_mean_of_time(table: TextTable, name: str, settings: FitSettings) -> bool:
    """Return whether a column called mean speed is a mean of samples, as other columns of the table are."""
    if settings.rolls or re.search("entrain|rolling", normalised_header(name)):
        return False
    words = [normalised_header(each) for each in table.header if each != name]
    return not any(re.fullmatch(PATTERNS["slide_to_roll"], each) for each in words) and any(
        re.search(r"\b(?:mean|average|avg)\b", each) and not re.search(_SPEED, each) for each in words
    )


def _rounded(value: float) -> float:
    """Return a value with two digits if that changes it by less than 1 %, else with three."""
    rough = float(f"{value:.2g}")
    return rough if abs(rough / value - 1) < 0.01 else float(f"{value:.3g}")


def column_of(table: TextTable, meaning: str, settings: FitSettings) -> str:
    """Return the header of a column of a rig, such as its normal force; empty where there is none with a unit."""
    names = _rig_columns(table, settings).get(meaning, ())
    return next((name for name in names if unit_in(table, name, meaning, settings)), "")


def measured(table: TextTable, meaning: str, settings: FitSettings) -> Array | None:
    """Return the numbers [SI] of a column of a rig, such as its normal force; None where there is none with a unit."""
    name = column_of(table, meaning, settings)
    return numbers(table, name, meaning, settings) if name else None


def temperatures(table: TextTable) -> tuple[Array, str] | None:
    """Return the temperatures [degC] of a column, that of the liquid if there are several, and its header; None if none."""
    names = [name for name in table.written if name in table.header and table.unit(name) in TEMPERATURES]
    nearest = ("lub|oil|fluid|öl", "pot|bath|sample", "")
    names.sort(key=lambda name: [re.search(each, normalised_header(name)) is None for each in nearest])
    for name in names:
        values = table.values(name)
        if np.isfinite(values).any():
            zero, factor = TEMPERATURES[table.unit(name)]
            return (values - zero) * factor, name
    return None


def _friction(table: TextTable, found: dict[str, list[str]], settings: FitSettings, signed: bool) -> tuple[Array, str] | None:
    """Return friction coefficients and how they were obtained; None if the rig gives none."""
    pressing: Array | float
    if "friction_force" in found and "normal_force" not in found:
        force, stated = found["friction_force"][0], stated_size(table, PATTERNS["normal_force"], "force")
        if stated is None:
            return None
        pressing, number, name = stated
        tangential = numbers(table, force, "friction_force", settings)
        said = f"friction = |{show(force)}| / {pressing:g} N, {show(name)} of row {number}"
    elif "friction_force" in found:
        force, normal = found["friction_force"][0], found["normal_force"][0]
        units = {unit_in(table, force, "friction_force", settings), unit_in(table, normal, "normal_force", settings)}
        if len(units) == 1 and units != {""}:
            tangential, pressing = (table.numbers_of(name, lambda unit, where: 1.0) for name in (force, normal))
        else:
            tangential, pressing = (
                numbers(table, name, meaning, settings)
                for name, meaning in ((force, "friction_force"), (normal, "normal_force"))
            )
        said = f"friction = |{show(force)} / {show(normal)}|"
    elif "torque" in found and "normal_force" in found:
        torque, normal = found["torque"][0], found["normal_force"][0]
        arm = _length(table, ARM, settings.arm)
        if arm is None:
            raise InputError(
                f"{table.path}: {show(torque)} is a torque; its arm makes it a friction force: say arm = '20 mm' in [fit] of "
                f"the case (to stribeck bench also --arm '20 mm'), or add a column 'arm [mm]'{_without_unit(table, ARM)}. "
                f"The columns are {', '.join(map(show, table.written))}."
            )
        lengths, origin = arm
        tangential = _over(numbers(table, torque, "torque", settings), lengths)
        pressing = numbers(table, normal, "normal_force", settings)
        said = f"friction = |{show(torque)} / (arm x {show(normal)})|, arm {origin}"
    else:
        return None
    values = _over(tangential, np.abs(pressing))
    return values if signed else np.abs(values), said


def _over(values: Array, by: Array | float) -> Array:
    """Return quotients, NaN where they divide by zero."""
    return values / np.where(by == 0, np.nan, by)


def _length(table: TextTable, pattern: str, given: float | None) -> tuple[Array, str] | None:
    """Return a length, of a diameter half, for each row, and the case, column or line that it is from; None if nowhere."""

    def of_all(length: float, origin: str) -> tuple[Array, str]:
        return np.full(len(table.rows), length), f"{format_si(length, 'length', 4)} {origin}"

    if given is not None:
        return of_all(given, "of the case")
    for name in filter(None, table.header):
        if is_named(name, pattern) and has_dimension(table.unit(name) or "-", "length"):
            lengths = table.numbers_of(name, lambda unit, where: si_factor(unit, "length", where))
            return _radius_of(name) * lengths, f"of column {show(name)}"
    for name in filter(None, table.header):
        for inside in re.findall(r"[\[(]([^\[\]()]*)[\])]", name):
            found = _IN_BRACKETS.fullmatch(inside)
            if found and is_named(found["name"], pattern) and has_dimension(found["unit"], "length"):
                value = decimal_of(found["value"], table.decimal_sign, table.path, show(name))
                length = float(value) * si_factor(found["unit"], "length", name)
                return of_all(_radius_of(found["name"]) * length, f"by {show(name)}")
    stated = stated_size(table, pattern, "length")
    if stated is None:
        return None
    return of_all(stated[0], f"by row {stated[1]}")


def stated_size(table: TextTable, pattern: str, dimension: str) -> tuple[float, int, str] | None:
    """Return a length, of a diameter half, or force [SI] that lines beside the rows give, the row and its name; or None."""
    found = [
        (_radius_of(name) * float(value) * si_factor(unit, dimension, name), number, name)
        for number, name, value, unit in stated_in(table, pattern)
        if has_dimension(unit or "-", dimension) and float(value) > 0
    ]
    for size, number, name in found[1:]:
        if not is_same(size, found[0][0], measured=dimension == "force"):
            refuse_two_values(table, (found[0][1], number), (found[0][2], name))
    if found:
        refuse_late_value(table, *found[0][1:])
    return found[0] if found else None


def is_same(one: float, other: float, *, measured: bool) -> bool:
    """Return whether two values that a file gives are one setting; a measured one is near what was set."""
    return max(one, other) <= (NEXT_LEVEL if measured else 1 + 1e-9) * min(one, other)


def _without_unit(table: TextTable, pattern: str) -> str:
    """Return that a line above the header gives a quantity without its unit, if one does."""
    for number, name, value, unit in stated_in(table, pattern):
        if not unit:
            return f" (row {number} gives {show(name)} {value} without a unit)"
    return ""


def _radius_of(name: str) -> float:
    """Return the radius over what a name means: one half of a diameter."""
    return 0.5 if re.search(r"dia(?:meter)?\b|durchmesser|\bd$", name, re.IGNORECASE) else 1.0


def _speed(table: TextTable, found: dict[str, list[str]], settings: FitSettings) -> tuple[Array, str] | None:
    """Return the sum of the surface speeds and how it was obtained; None if the rig gives no speed."""

    def of(meaning: str, which: int = 0) -> Array:
        return numbers(table, found[meaning][which], meaning, settings)

    if "entrainment_speed" in found:
        name = found["entrainment_speed"][0]
        said = f"speed = 2 x {show(name)}, a mean of two surface speeds; the speed of a case is their sum"
        return 2 * of("entrainment_speed"), said
    surfaces = found.get("surface_speeds", [])
    if len(surfaces) == 2:
        return np.abs(of("surface_speeds") + of("surface_speeds", 1)), f"speed = {' + '.join(map(show, surfaces))}"
    other = [name for name in found.get("rotation", []) if surfaces and _bodies([name]) - _bodies(surfaces)]
    if len(surfaces) == 1 and other:
        raise InputError(_of_two(table, "surface_speeds", surfaces[0], *other))
    if len(surfaces) == 1 and not settings.rolls and "slide_to_roll" not in found:
        return np.abs(of("surface_speeds")), f"speed = {show(surfaces[0])}, with the other surface at rest"
    if "sliding_speed" in found and "slide_to_roll" in found:
        name, ratio = found["sliding_speed"][0], found["slide_to_roll"][0]
        ratios = numbers(table, ratio, "slide_to_roll", settings)
        if (np.abs(ratios) <= ROLLING_RATIO).any():
            raise InputError(
                f"{table.path}: {show(name)} does not give the sum of the surface speeds where {show(ratio)} is zero; write a "
                "column 'mean speed' or 'sum of speeds', or take these rows out."
            )
        said = f"speed = 2 x {show(name)} / {show(ratio)}, the sum of the surface speeds"
        return np.abs(2 * of("sliding_speed") / ratios), said
    if "sliding_speed" in found:
        name = found["sliding_speed"][0]
        if len(settings.ratios) != 1 or 0 in settings.ratios:
            ratios_said = " and ".join(f"{ratio:g}" for ratio in settings.ratios)
            raise InputError(
                f"{table.path}: {show(name)} does not give the sum of the surface speeds at the slide-to-roll ratio "
                f"{ratios_said}; write a column 'mean speed' or 'sum of speeds'."
            )
        said = f"speed = 2 x {show(name)} / {settings.ratios[0]:g}, the slide-to-roll ratio; the sum of the surface speeds"
        return abs(2 / settings.ratios[0]) * of("sliding_speed"), said
    return _speed_of_rotation(table, found, settings) if "rotation" in found else None


def _speed_of_rotation(table: TextTable, found: dict[str, list[str]], settings: FitSettings) -> tuple[Array, str]:
    """Return the speed on a track that turns, and how it was obtained."""
    name, *others = found["rotation"]
    if others:
        raise InputError(_of_two(table, "rotation", name, *others))
    if settings.rolls or "slide_to_roll" in found:
        raise InputError(f"{table.path}: {show(name)} is the rotation of one surface where both move; {BOTH_MOVE}.")
    unit = unit_in(table, name, "rotation", settings)
    if re.search("angular|winkel", normalised_header(name)) and re.fullmatch(r"1 ?/ ?s|s ?\^?[-−]1|s⁻¹", unit):
        raise InputError(
            f"{table.path}: {show(name)} may be in radians or in turns per second, 6.3 times as fast; say rotation = 'rad/s' "
            "or 'rev/s' in [fit.units], or in the header."
        )
    radius = _length(table, TRACK, settings.track_radius)
    if radius is None:
        raise InputError(
            f"{table.path}: {show(name)} is a rotation; the radius of its track makes it a speed: say track_radius = '20 mm' "
            f"in [fit] of the case (to stribeck bench also --track-radius '20 mm'), or add a column 'track radius [mm]'"
            f"{_without_unit(table, TRACK)}."
        )
    lengths, origin = radius
    said = f"speed = {show(name)} x the radius of the track, {origin}"
    return numbers(table, name, "rotation", settings) * lengths, said


def _of_two(table: TextTable, meaning: str, *names: str) -> str:
    """Return the sentence that refuses speeds of two surfaces of which no sum is known."""
    return (
        f"{table.path}: {listed(map(show, names))} may be of two surfaces; where one is at rest, say that of the other, as in "
        f"{meaning} = {show(names[0])} in [fit.columns]; where both move, {BOTH_MOVE}."
    )


def _bodies(names: list[str]) -> set[str]:
    """Return the bodies that headers name."""
    words = (normalised_header(name).replace("disk", "disc") for name in names)
    return {found[0].strip() for each in words if (found := re.search(rf"\b{_BODY}", each))}


def _texts(values: Array) -> list[str]:
    """Return the cells of a column of numbers."""
    return [repr(value) if math.isfinite(value) else "" for value in values.tolist()]
