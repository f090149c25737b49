"""What the columns of a laboratory's table are: by their headers, or as the case says."""

from __future__ import annotations

import re
from typing import Literal

import numpy as np

from stribeck.cases.fit_settings import FitSettings
from stribeck.files.cells import header_words, is_called, split_header
from stribeck.files.text_table import TextTable
from stribeck.fits.table.rig import MADE_RATIO, MADE_SPEED, PATTERNS, RIG
from stribeck.quantities.input_rows import ROWS
from stribeck.quantities.units import InputError, show

__all__ = ["ABSCISSAS", "BARE", "Abscissa", "abscissa_of", "columns_of", "declared_for_rig", "has_column"]

Abscissa = Literal["speed", "speed_viscosity", "hersey_number"]

ABSCISSAS: tuple[Abscissa, ...] = ("speed", "speed_viscosity", "hersey_number")

SUMS = {"sum of speeds", "sum of the speeds", "sum of the surface speeds", "u1 u2"}
"""Headers of a speed that say that it is the sum."""

WORDS = {
    "speed": {"speed", "velocity", "sliding speed", "sliding velocity", "u", "v", *SUMS},
    "speed_viscosity": {"eta u", "etau", "speed viscosity", "viscosity speed", "viscosity times speed"},
    "hersey_number": {"hersey", "hersey number"},
    "friction": {
        *("friction", "friction coefficient", "coefficient of friction", "cof", "mu", "µ", "μ"),
        *("friction coeff", "traction coeff", "traction coefficient"),
    },
    "error": {"error", "friction error", "mu error", "uncertainty", "standard error", "standard deviation", "std", "sigma"},
    "curve": {"curve", "series", "sample"},
    MADE_RATIO: {"slide to roll"},
} | {
    row.name: {row.name.replace("_", " "), *row.headers}
    for row in ROWS
    if not row.derived and row.name not in ("speed", "boundary_friction")
}
"""Headers that say what a column is, in lower case; in other languages [fit.columns] says it."""

BARE = {"": 1.0, "-": 1.0, "1": 1.0, "%": 0.01, "percent": 0.01, "‰": 0.001}
"""Units of a friction coefficient."""

_FORCE = re.compile(r"force|kraft|\(m?N\)|\[m?N\]", re.IGNORECASE)


def columns_of(table: TextTable, settings: FitSettings) -> dict[str, list[str]]:
    """Return what is in the file -> headers of its columns."""
    found: dict[str, list[str]] = {}
    for meaning, wanted in settings.columns.items():
        texts = wanted if isinstance(wanted, list) else [wanted]
        if meaning in RIG:
            continue
        for text in texts:
            same = [name for name in table.header if is_called(name, text)]
            if len(same) != 1:
                raise InputError(
                    f"{table.path}: {_listed(table)}, none called {show(text)}, which [fit.columns] has as {meaning}."
                )
            found.setdefault(meaning, []).append(same[0])
    declared = {name for names in found.values() for name in names}
    declared |= {name for name in table.header if declared_for_rig(name, settings)}
    for name in table.header:
        words = header_words(name)
        for meaning, known in WORDS.items():
            if name in declared or words not in known or meaning in settings.columns:
                continue
            if meaning == "speed" and MADE_SPEED in table.header and name != MADE_SPEED:
                continue
            if meaning in found:
                raise InputError(
                    f"{table.path}: the columns {show(found[meaning][0])} and {show(name)} both look like {meaning}; "
                    f"say which in [fit.columns] of the case."
                )
            found[meaning] = [name]
    if "friction" not in found or not any(name in found for name in ABSCISSAS):
        missing = ["speed"] * (not any(name in found for name in ABSCISSAS)) + ["friction"] * ("friction" not in found)
        used = {name for names in found.values() for name in names}
        unknown = [name for name in table.header if name not in used] or [""]
        speeds = [name for name in unknown if re.search(r"/\s*(s|min|h)\b", split_header(name)[1])]
        bare = [name for name in unknown if name not in speeds and split_header(name)[1] in BARE and not _FORCE.search(name)]
        if "friction" in missing and not bare and any(_FORCE.search(name) for name in unknown):
            raise InputError(
                f"{table.path}: {_listed(table)}, none of which is a friction coefficient; a force is none: add a column "
                "friction, the friction force over the normal force."
            )
        examples = {"speed": (speeds or unknown)[0], "friction": (bare or unknown)[-1]}
        raise InputError(
            f"{table.path}: {_listed(table)}, none of which is known as {' or '.join(missing)}; say which in [fit.columns] of "
            f"the case, as in {' and '.join(f'{name} = {show(examples[name])}' for name in missing)}."
        )
    return found


def _listed(table: TextTable) -> str:
    return f"the columns are {', '.join(show(name) for name in table.header if name)} (separated by {table.separator}s)"


def abscissa_of(table: TextTable, columns: dict[str, list[str]], settings: FitSettings) -> Abscissa:
    """Return what friction was measured against; the speed where there are several."""
    there = [name for name in ABSCISSAS if name in columns]
    # Speed is what was set; the others follow from it.
    if len(there) > 1 and "speed" not in there:
        raise InputError(f"{table.path}: the file has {' and '.join(there)}; keep one of them.")
    found = there[0]
    if found not in settings.columns:
        _ask_for_the_sum(table, found, columns[found][0], settings)
    return found


def _ask_for_the_sum(table: TextTable, abscissa: Abscissa, name: str, settings: FitSettings) -> None:
    """Refuse an abscissa of two moving surfaces of which nobody said whether it holds their mean speed or the sum."""
    ratio = any(re.fullmatch(PATTERNS["slide_to_roll"], header_words(each)) for each in table.header)
    if header_words(name) in SUMS or not (ratio or settings.rolls):
        return
    said = " or ".join(f"{each:g}" for each in settings.ratios)
    why = "the file has a slide-to-roll ratio" if ratio else f"both surfaces move (slide-to-roll ratio {said})"
    if abscissa == "speed":
        raise InputError(
            f"{table.path}: {why}, so that {show(name)} may be the mean of both surface speeds or their sum; say which in "
            f"[fit.columns] of the case: entrainment_speed = {show(name)} (the mean) or speed = {show(name)} (the sum), or "
            "call the column 'mean speed' or 'sum of speeds'."
        )
    raise InputError(
        f"{table.path}: {why}, so that {show(name)} may be made with the mean of both surface speeds or with their sum; "
        f"double it where it is the mean, and say {abscissa} = {show(name)} (with the sum) in [fit.columns] of the case."
    )


def has_column(table: TextTable, settings: FitSettings, meaning: str) -> bool:
    """Return whether a table has an unambiguous column of friction, or of an abscissa."""
    wanted = ABSCISSAS if meaning == "speed" else (meaning,)
    if any(each in settings.columns for each in wanted):
        return True
    words = {header_words(name) for name in table.header if not declared_for_rig(name, settings)}
    # Beside these a sliding speed is the difference of the surface speeds, and the speed their sum.
    rolling = [PATTERNS[each] for each in ("slide_to_roll", "entrainment_speed", "surface_speeds")]
    rolls = settings.rolls or any(re.fullmatch(pattern, word) for pattern in rolling for word in words)
    sliding = {"sliding speed", "sliding velocity"} if rolls else set()
    return any(words & (WORDS[each] - sliding) for each in wanted)


def declared_for_rig(name: str, settings: FitSettings) -> bool:
    """Return whether the settings say that a column is one of a rig."""
    texts = [text for meaning in RIG for text in np.atleast_1d(settings.columns.get(meaning, [])).tolist()]
    return any(is_called(name, text) for text in texts)
