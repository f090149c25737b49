"""What the columns of a laboratory's table are: by their headers, or as the case says."""

import re
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from stribeck.cases.fit_settings import FitSettings
from stribeck.contacts.geometries import LINE
from stribeck.files.cells import is_named, normalised_header, number_of, split_header
from stribeck.files.columns import BARE, has_dimension
from stribeck.files.text_table import TextTable, as_comparable
from stribeck.fits.rig import MADE_RATIO, MADE_SPEED, PATTERNS, is_mean_of_time
from stribeck.fits.values import (
    ABSCISSAS,
    MADE_FRICTION,
    Abscissa,
    dimension_of,
    is_set,
    listed,
    named_in_case,
    undeclared,
    unit_in,
)
from stribeck.quantities.units import InputError, show

# Headers of a speed that say that it is the sum.
SUMS = {"sum of speeds", "sum of the speeds", "sum of the surface speeds", "u1 u2"}

_FRICTION = (
    r"(?:(?:mean|average|avg|median|dynamic|kinetic|sliding|measured) )*"
    r"(?:(?:friction|traction|frictional|fric)(?: (?:coefficient|coeff?|factor))|friction|cof|mue?|[µμ]|"
    r"(?:coefficient|coeff?) of (?:(?:kinetic|dynamic|sliding) )?(?:friction|traction)|"
    r"reib(?:ungs)?(?:wert|zahl|beiwert|koeffizient)|reibung)"
    r"(?: (?:coefficient|cof|mu|[µμ]|mean|average|avg))?"
)
_ERROR = (
    r"(?:err(?:or)?|uncertainty|s ?d|std|sem|st ?dev|std ?(?:dev|deviation|error)|standard (?:deviation|error)|sigma|stabw)"
)

MADE = {"speed": MADE_SPEED, "friction": MADE_FRICTION}  # Headers of columns that were made of others

_HERSEY = r"hersey(?: (?:number|no|parameter))?"
_ETA_U_F = r"eta u(?: r)? (?:f|w|load)(?: n)?"

# What the words of a header mean, in lower case; in other languages [fit.columns] says it.
WORDS = {
    "speed": r"(?:sliding |linear )?(?:speed|velocity)|u|v ?1?|[uv] (?:s|sl|slide|sliding|rel)|(?:gleit)?geschwindigkeit|"
    + "|".join(SUMS),
    "speed_viscosity": rf"eta u|etau|speed viscosity|viscosity speed|viscosity times (?:speed|{'|'.join(SUMS)})",
    "hersey_number": rf"{_HERSEY}|{_HERSEY} {_ETA_U_F}|{_ETA_U_F}",
    "friction": _FRICTION,
    "error": rf"{_ERROR}|{_FRICTION} {_ERROR}|{_ERROR} (?:of )?{_FRICTION}",
    "curve": "curve|series|sample",
    MADE_RATIO: "slide to roll",
} | {
    name: "|".join(re.escape(each.replace("_", " ").lower()) for each in (name, *row.letters) if len(each) > 1)
    for name, row in LINE.kept.items()
    if name not in ("speed", "boundary_friction")
}

# Headers of a speed that is taken where there is none by a plainer name.
OTHER_SPEED = (
    r"(?:(?:mean|average|avg) (?=linear|sliding|tangential))?"
    r"(?:(?:max|maximum|peak|linear|lin|sliding|tangential|circumferential|actual|measured|set|nominal|target|track|test|table|"
    r"stage|stroke) )+(?:speed|velocity|vel)|vel|(?:mean|average|avg) (?:speed|velocity)|"
    r"(?:speed|velocity) (?:mean|average|avg)"
)

PLUS_MINUS = {"±", "+/-", "+-"}

_OF_ERROR = re.compile(rf"{_ERROR}|.* {_ERROR}|{_ERROR} .*")
_LOGARITHM = re.compile(
    r"(?<![a-z])(?:(?:log|lg|ln)(?:10|2|e)?(?![a-z])|log(?:10)?(?=speed|velocity|friction|cof|mu\b|[uv]\b))", re.IGNORECASE
)
_NO_COEFFICIENT = re.compile(
    r"force|kraft|load|torque|moment|speed|veloc|geschw|time|zeit|step|cycle|lap|point|run|no\b|nr\b|id\b|count|distance|temp",
    re.IGNORECASE,
)


def known_name(name: str) -> bool:
    """Return whether a header names something that is known, whatever its unit."""
    return any(is_named(name, pattern) for pattern in (*WORDS.values(), OTHER_SPEED, *PATTERNS.values()))


def with_errors_named(table: TextTable) -> TextTable:
    """Return the table with each of several columns of the same name, such as 'SD', named after the column before it."""
    header, of = list(table.header), ""
    for at, name in enumerate(table.header):
        if not is_named(name, _ERROR):
            of = name
        elif table.header.count(name) > 1:
            header[at] = f"{normalised_header(of)} {name}"
    return replace(table, header=tuple(header))


def columns_of(table: TextTable, settings: FitSettings) -> dict[str, list[str]]:
    """Return what is in the file -> headers of its columns."""
    found: dict[str, list[str]] = {}
    for meaning in settings.columns:
        if meaning in PATTERNS:
            continue
        found[meaning] = named_in_case(table, settings, meaning, WORDS["error"])
        for name in found[meaning]:
            _refuse_twice(table, [name], meaning)
            if meaning in (*ABSCISSAS, "friction"):
                _refuse_logarithm(table, name, meaning)
    for meaning in WORDS:
        if meaning in settings.columns or meaning == "error":
            continue
        names = [name for name in candidates(table, settings, meaning) if not any(name in each for each in found.values())]
        if MADE.get(meaning) in table.header:
            names = [MADE[meaning]]
        if not names:
            continue
        _refuse_twice(table, names, meaning)
        found[meaning] = names[:1]
    error = _error_of(table, settings, found)
    if error:
        found["error"] = [error]
    if "friction" not in found or not any(name in found for name in ABSCISSAS):
        _ask_for_columns(table, found)
    if "speed" in found:  # what was set; the others follow from it
        found = {meaning: names for meaning, names in found.items() if meaning not in ABSCISSAS[1:]}
    return found


def candidates(table: TextTable, settings: FitSettings, meaning: str) -> list[str]:
    """Return the columns that may be meant: of the plainest names, and of a fitting unit if there are such."""
    free = undeclared(table, settings)
    if meaning != "error":
        free = [name for name in free if not _LOGARITHM.search(name)]
    for pattern in (WORDS[meaning], *([OTHER_SPEED] if meaning == "speed" else [])):
        names = [name for name in free if is_named(name, pattern) or (meaning == "error" and name.strip() in PLUS_MINUS)]
        if meaning == "curve":
            names = [name for name in names if not _counts_rows(table, name)]
        if meaning == "speed":
            rolling = PATTERNS["entrainment_speed"]
            names = [name for name in names if not is_named(name, rolling) or is_mean_of_time(table, name, settings)]
        fitting = [name for name in names if _fits(table, name, meaning, settings)]
        measured = [name for name in fitting if not is_set(name)]
        fitting = measured or fitting
        # A speed or a friction of another unit is refused by its unit; other columns with one mean something else.
        if names and (fitting or meaning in ("friction", *ABSCISSAS)):
            return fitting or names
    return []


def _counts_rows(table: TextTable, name: str) -> bool:
    """Return whether a column numbers the rows, as one called 'Sample' may."""
    values = [number_of(cell, ",") for cell in table.column(name)]
    if None in values:
        return False
    steps = np.diff([each[0] for each in values if each])
    return bool(2 * (steps == 1).sum() > len(steps))


def _fits(table: TextTable, name: str, meaning: str, settings: FitSettings) -> bool:
    """Return whether a column has a unit of what it may mean, or none."""
    unit = unit_in(table, name, meaning, settings)
    if not unit or meaning == "curve":
        return True
    dimension = dimension_of(meaning, settings)
    if meaning == "hersey_number" and has_dimension(unit, "wavenumber"):
        return True
    return unit in BARE if dimension == "number" else has_dimension(unit, dimension)


def _refuse_twice(table: TextTable, names: Sequence[str], meaning: str) -> None:
    """Refuse columns that may mean the same and hold different cells."""
    first = table.header.index(names[0])
    for at, name in enumerate(table.header):
        if at == first or name not in names or all(as_comparable(row[at]) == as_comparable(row[first]) for row in table.rows):
            continue
        if name == names[0]:
            raise InputError(
                f"{table.path}: the column {show(name)} is there twice, with different numbers, and may be {meaning}; give "
                "each column its own name."
            )
        other = show(name) if name in table.written else "one that the rig measured"
        raise InputError(
            f"{table.path}: the columns {show(names[0])} and {other} both look like {meaning}; "
            f"say which in [fit.columns] of the case, as in {meaning} = {show(names[0])}."
        )


def curve_labels(table: TextTable, columns: dict[str, list[str]]) -> Sequence[str]:
    """Return the name of the curve of each row; refuse a measured row without one where others have it."""
    if "curve" not in columns:
        return ("",) * len(table.rows)
    name = columns["curve"][0]
    labels = table.column(name)
    measured = [any(cells) for cells in zip(*map(table.column, columns["friction"]), strict=True)]
    missing = [number for number, label, each in zip(table.numbers, labels, measured, strict=True) if each and not label]
    if missing and any(labels) and name in table.written:
        raise InputError(
            f"{table.path}: row {missing[0]} has no {show(name)}, which names the curve of other rows; write it in each row."
        )
    return labels


def _refuse_logarithm(table: TextTable, name: str, meaning: str) -> None:
    if _LOGARITHM.search(name):
        noun = meaning.replace("_", " ")
        raise InputError(
            f"{table.path}: {show(name)} is a logarithm, which is no {noun}; add a column with the {noun} itself."
        )


def _error_of(table: TextTable, settings: FitSettings, found: dict[str, list[str]]) -> str:
    """Return the column of the standard error of friction, which is after friction if only called 'SD'; empty if none."""
    if "error" in settings.columns or "friction" not in found:
        return ""
    names = [name for name in candidates(table, settings, "error") if not any(name in each for each in found.values())]
    named = [name for name in names if re.search(_FRICTION, normalised_header(name))]
    if named:
        _refuse_twice(table, named, "error")
        return named[0]
    at = table.header.index(found["friction"][0])
    others = {table.header.index(name) for meaning in ABSCISSAS for name in found.get(meaning, ())}
    places = [i for i, name in enumerate(table.header) if name in names]
    own = [i for i in places if i > at and not any(at < other < i for other in others)]
    if not own and len(places) == 1 and places[0] - 1 not in others:
        own = places
    return table.header[own[0]] if own and table.header[at] in table.written else ""


def _ask_for_columns(table: TextTable, found: dict[str, list[str]]) -> None:
    """Refuse a table without speed or friction, with what is known of its columns."""
    missing = ["speed"] * (not any(name in found for name in ABSCISSAS)) + ["friction"] * ("friction" not in found)
    for name in table.written:
        plain = _LOGARITHM.sub(" ", name).replace("(", " ").replace(")", " ")
        for meaning in missing:
            if _LOGARITHM.search(name) and any(is_named(plain, WORDS[each]) for each in _alike(meaning)):
                _refuse_logarithm(table, name, meaning)
    used = {name for names in found.values() for name in names}
    unknown = [name for name in table.written if name not in used and name in table.header and not _LOGARITHM.search(name)]
    unknown = [name for name in unknown if not _OF_ERROR.fullmatch(normalised_header(name))]
    mean = re.compile("mean|average|entrain|rolling|ball|disc|disk|upper|lower", re.IGNORECASE)  # no sum of speeds
    examples: dict[str, list[str | list[str]]] = {
        "speed": [name for name in unknown if has_dimension(table.unit(name), "speed") and not mean.search(name)],
        "friction": [name for name in unknown if table.unit(name) in BARE and _may_be_friction(table, name)],
    }
    if "friction" in missing and not examples["friction"]:
        of_forces = (
            is_named(name, PATTERNS["friction_force"]) or split_header(name)[1] in ("N", "mN") for name in table.written
        )
        if any(of_forces):
            raise InputError(
                f"{table.path}: {listed(table)}, none of which is a friction coefficient; a force is none: add a column "
                "friction, the friction force over the normal force."
            )
    units = ""
    if [name.lower() for name in unknown] == ["x", "y"]:
        examples = {"speed": [unknown[0]], "friction": [unknown[1]]}  # of a program that reads curves off pictures
        units = ", and the unit of the speed in [fit.units]"
    several = [
        name for name in unknown if re.match(rf"(?:{_FRICTION}) .", normalised_header(name)) and table.unit(name) in BARE
    ]
    if len(several) > 1:
        examples["friction"] = [several]
    sure = [f"{name} = {show(examples[name][0])}" for name in missing if len(examples[name]) == 1]
    raise InputError(
        f"{table.path}: {listed(table)}, none of which is known as {' or '.join(missing)}; say which in [fit.columns] of "
        f"the case{', as in ' if sure else ''}{' and '.join(sure)}{units}."
    )


def _alike(meaning: str) -> tuple[str, ...]:
    return ABSCISSAS if meaning == "speed" else (meaning,)


def _may_be_friction(table: TextTable, name: str) -> bool:
    """Return whether a column could hold friction coefficients: positive numbers, not all alike, that count nothing."""
    if _NO_COEFFICIENT.search(name):
        return False
    values = table.values(name)
    there = values[~np.isnan(values)]
    several = len(values) == 1 or np.unique(there).size > 1
    return bool(2 * there.size > len(values) and several and (there > 0).any())


def abscissa_of(table: TextTable, columns: dict[str, list[str]], settings: FitSettings) -> Abscissa:
    """Return what friction was measured against; the speed where there are several."""
    there = [name for name in ABSCISSAS if name in columns]
    # Speed is what was set; the others follow from it.
    if len(there) > 1 and "speed" not in there:
        raise InputError(f"{table.path}: the file has {' and '.join(there)}; keep one of them.")
    found = there[0]
    if found not in settings.columns:
        _ask_for_the_sum(table, found, columns[found][0], settings)
    return _hersey(table, columns[found][0], settings) if found == "hersey_number" else found


def _hersey(table: TextTable, name: str, settings: FitSettings) -> Abscissa:
    """Return which Hersey number a column holds: that of a ball without the radius is per length."""
    unit = unit_in(table, name, "hersey_number", settings)
    ball = settings.geometry == "point"
    if has_dimension(unit or "-", "wavenumber"):
        if ball:
            return "hersey_per_length"
        raise InputError(
            f"{table.path}: {show(name)} is in {unit}; the load of a cylinder is per length, so that its Hersey number "
            "eta U/F_N is a bare number: divide the force by the length of the cylinder."
        )
    if ball and not unit and not re.search(r"\bu r\b", normalised_header(name)):
        raise InputError(
            f"{table.path}: {show(name)} of a ball may be eta U R/F_N, a number, or eta U/F_N, in 1/m; write the unit in the "
            "header, as in 'Hersey number [-]' or 'Hersey number [1/m]', or hersey_number = \"1\" or \"1/m\" in "
            "[fit.units] of the case."
        )
    return "hersey_number"


def _ask_for_the_sum(table: TextTable, abscissa: Abscissa, name: str, settings: FitSettings) -> None:
    """Refuse an abscissa of two moving surfaces of which nobody said whether it holds their mean speed or the sum."""
    ratio = settings.names_have_ratio or any(is_named(each, PATTERNS["slide_to_roll"]) for each in table.header)
    if normalised_header(name).removeprefix("viscosity times ") in SUMS or not (ratio or settings.rolls):
        return
    said = " or ".join(f"{each:g}" for each in settings.ratios)
    why = "the file has a slide-to-roll ratio" if ratio else f"both surfaces move (slide-to-roll ratio {said})"
    if abscissa == "speed":
        at_rest = "" if ratio else " If one surface is at rest, write slide_to_roll = 2 in the case."
        raise InputError(
            f"{table.path}: {why}, so that {show(name)} may be the mean of both surface speeds or their sum; say which in "
            f"[fit.columns] of the case: entrainment_speed = {show(name)} (the mean) or speed = {show(name)} (the sum), or "
            f"call the column 'mean speed' or 'sum of speeds'.{at_rest}"
        )
    raise InputError(
        f"{table.path}: {why}, so that {show(name)} may be made with the mean of both surface speeds or with their sum; "
        f"double it where it is the mean, and say {abscissa} = {show(name)} (with the sum) in [fit.columns] of the case."
    )


def has_column(table: TextTable, settings: FitSettings, meaning: str) -> bool:
    """Return whether a table has a column of friction, or of an abscissa, in a unit of it."""
    wanted = _alike(meaning)
    if any(each in settings.columns for each in wanted):
        return True
    # Beside these a sliding speed is the difference of the surface speeds, and the speed their sum.
    rolling = [PATTERNS[each] for each in ("slide_to_roll", "entrainment_speed", "surface_speeds")]
    rolls = settings.rolls or any(is_named(name, pattern) for pattern in rolling for name in table.header)
    return any(
        _fits(table, name, each, settings)
        for each in wanted
        for name in candidates(table, settings, each)
        if not (rolls and is_named(name, PATTERNS["sliding_speed"]))
    )
