"""Cells of tables: what a header says, whether a cell is a number, and which."""

import csv
import re
from collections.abc import Iterable, Sequence

from stribeck.quantities.units import InputError, show

# Cells that hold no value, in lower case.
MISSING_CELLS = frozenset({"", "-", "--", "---", "na", "n/a", "nan", "null", "none", "nv", "?", "bad"})

# What spreadsheets write in the place of a number that a formula does not find
FORMULA_ERROR = re.compile(r"#(?:n/a|nv|div/0!|value!|wert!|num!|zahl!|ref!|bezug!)", re.IGNORECASE)

_MISSING = re.compile(
    rf"[*#-]{{2,}}|[+-]?nan\(?\w*\)?|[+-]?1\.#\w+|[+-]?inf(?:inity)?|void|invalid|nodata|over(?:flow|load|range)|"
    rf"ovr(?:ld)?|ovf|o\.?l\.?|n\.[ad]\.|\(null\)|>{{2,}}|{FORMULA_ERROR.pattern}"
)

# A number whose signs may stand between thousands
THOUSANDS = re.compile(r"[+-]?[1-9][0-9]{0,2}(?:[,.' ][0-9]{3})+(?:[.,][0-9]+)?")

# What the cell beside a statistic of the rows above says
SUMMARY = re.compile(
    r"(?:mean|average|avg|median|sum|total|min(?:imum)?|max(?:imum)?|r?sd|std|st\.? ?dev|std\.? ?dev|standard ?deviation|cv|"
    r"mittel(?:wert)?|mw|summe|standardabweichung|stabw|varianz|variance|range|spannweite|n|count|anzahl|rms|"
    r"[rs](?:a|q|z|t|p|v|ku|sk|sm|max|dq|dr))\.?(?: value)?:?(?: ?[\[(][^\])]*[\])])?",
    re.IGNORECASE,
)

MAX_LISTED_ROWS = 10  # Rows that a sentence lists

# What may stand in the brackets of a header in place of a unit: the letter of the quantity
QUANTITY_LETTERS = frozenset("µ μ mu COF cof u v U F_N Fn FN SRR δ delta ω η τ γ̇ ɣ̇ E' E'' G' G''".split())

# Brackets that say which statistic of the samples a column holds, and no unit.
_STATISTIC = re.compile(
    r"\s*[\[(](mean|average|avg|median|sd|s\.d\.|std|st\.? ?dev\.?|se|sem|err(?:or)?|std\.? ?(?:dev|error)\.?)[\])]",
    re.IGNORECASE,
)

# Brackets that say under which load, say, a column was measured, and no unit
_SETTING = re.compile(r"[0-9]+(?:[.,][0-9]+)? ?(?:[mk]?N|[mk]?g|mm/s|°C|mPa ?s|cSt)")

_BRACKETS = re.compile(r"[\[(]([^\[\]()]*)[\])]")

_LETTER = re.compile(r"(?<=[a-zäöüß]{3}) (?:u|v|mu|[µμ]|f ?[nt]|w)$")

NUMBER_WITH_POINT = re.compile(r"[+-]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]{1,3})?")
NUMBER_WITH_COMMA = re.compile(r"[+-]?[0-9]*,[0-9]+(?:[eE][+-]?[0-9]{1,3})?")
NUMBER_WITH_UNIT = re.compile(r"([+-]?[0-9.,]+(?:[eE][+-]?[0-9]{1,3})?)\s*([A-Za-zµμ%°].*)")
_UNIT = re.compile(
    r"(?:[pnuµμcmkMG]?(?:m|g|s|N|Pas?|J|W|V|A|Hz|C|St|P|Nm|bar)|K|%|‰|°|°C|°F|deg|rad|sec|min|h|hr|hour|rpm|RPM|rev|in|ft|lbf?|"
    r"k?gf|[Nn]ewton|a\.?u\.?|1)(?:\^?[-−]?[0-9]|[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)?"
)
_WITHOUT_BRACKETS = re.compile(r"(.+?)[\s,_]+([pnuµμcmk]?m(?: ?/ ?|_per_|_)(?:s|sec|min|h)|rpm|RPM|%|[uµmk]?N)\s*")
_HEADER = re.compile(r"(.*?)\s*(?:\[(.*)\]|\((.*)\)|(?:\s/\s|\sin\s)(.*))\s*")


def split_header(header: str) -> tuple[str, str]:
    """Return the words of a header and its unit, as of ``speed [mm/s]`` or ``speed / mm/s``; empty where it has none."""
    header = _STATISTIC.sub(r" \1", header)
    brackets = list(_BRACKETS.finditer(header))
    units = (
        [each for each in brackets if each[1].strip() in ("", "-") or looks_like_units(each[1])] if len(brackets) > 1 else []
    )
    if units:  # of several brackets the one that holds a unit
        return f"{header[: units[-1].start()].rstrip()} {header[units[-1].end() :].lstrip()}".strip(), units[-1][1].strip()
    parts = _HEADER.fullmatch(header) or _WITHOUT_BRACKETS.fullmatch(header) or _quotient(header)
    if parts is None or not parts[1]:
        return header.strip(), ""
    unit = next(unit for unit in parts.groups()[1:] if unit is not None).strip()
    if _SETTING.fullmatch(unit):
        return header.strip(), ""
    return parts[1].strip(), "" if unit in QUANTITY_LETTERS else re.sub("_per_|_", "/", unit)


def _quotient(header: str) -> re.Match[str] | None:
    """Return name and unit of a header such as ``f/Hz``, a quantity over its unit, which is no unit itself."""
    parts = re.fullmatch(r"([^/]+)/(.+)", header)
    return parts if parts and looks_like_units(parts[2]) and not looks_like_units(parts[1].split(" ")[-1]) else None


def normalised_header(header: str) -> str:
    """Return the words of a header in lower case, without its unit, what stands in brackets, and signs."""
    return _plain_words(split_header(header)[0])


def _plain_words(words: str) -> str:
    words = re.sub(r"\(.*?\)|\[.*?\]", " ", words)
    return " ".join(re.sub(r"[^0-9a-zµμäöüß]+", " ", words.lower().replace("η", "eta ")).split())


def is_named(header: str, pattern: str) -> bool:
    """Return whether the words of a header match a pattern."""
    # A word before a dot, as ``DAQ.``, and the letter of the quantity behind its name, as ``speed, u``, may be left out.
    words = (normalised_header(header), _plain_words(re.split(r"[.:]", split_header(header)[0])[-1]))
    return any(re.fullmatch(pattern, each) for each in (*words, *(_LETTER.sub("", each) for each in words)))


def is_called(header: str, name: str) -> bool:
    """Return whether a name means a header, with or without its unit."""
    return name.strip() in (header, split_header(header)[0])


def number_of(cell: str, decimal: str = ".") -> tuple[float, str] | None:
    """Return the number that a cell holds and its own unit, or None; with ``decimal = ","`` points pass too."""
    text = cell.replace("\N{MINUS SIGN}", "-").strip()
    unit = ""
    bare = NUMBER_WITH_POINT.fullmatch(text) or NUMBER_WITH_COMMA.fullmatch(text)
    with_unit = None if bare else NUMBER_WITH_UNIT.fullmatch(text)
    if with_unit:
        text, unit = with_unit.groups()
    if decimal == "," and NUMBER_WITH_COMMA.fullmatch(text):
        text = text.replace(",", ".")
    return (float(text), unit) if NUMBER_WITH_POINT.fullmatch(text) else None


def cells_of(line: str, separator: str, where: str = "") -> list[str]:
    """Return the cells of a line without quotes and white space around them; an empty ``separator`` is white space.

    Where its quotes are wrong there are none, or of a line that has a place the refusal says so.
    """
    if separator and '"' not in line:
        return [cell.replace("\N{NO-BREAK SPACE}", " ").strip() for cell in line.split(separator)]
    if separator:
        try:
            [cells] = csv.reader([line], delimiter=separator, skipinitialspace=True, strict=True)
        except (csv.Error, ValueError) as problem:
            if not where:
                return []
            raise InputError(f"{where} cannot be split into cells ({problem}); check its quotes.") from None
        return [cell.replace("\N{NO-BREAK SPACE}", " ").strip() for cell in cells]
    words = [word.strip('"') or word for word in line.split()]
    if not any(mark in line for mark in "[("):
        return words
    cells = []
    for word in words:
        # A unit in brackets belongs to the word before it.
        if cells and (word[0] in "[(" or cells[-1].count("[") > cells[-1].count("]")):
            cells[-1] += f" {word}"
        else:
            cells.append(word)
    return cells


def is_missing(cell: str) -> bool:
    """Return whether a cell says that there is no value."""
    text = cell.strip('"').lower()
    return text in MISSING_CELLS or _MISSING.fullmatch(text) is not None


def looks_like_units(cell: str) -> bool:
    """Return whether a cell below a header is a unit, such as ``mm/sec`` or ``[mN m]``, rather than a name."""
    text = cell.strip()
    if text[:1] in "[(" and text[-1:] in "])":
        return True
    parts = re.split(r"[\s*/·⋅.]+", text.removeprefix("U/"))
    return len(text) <= 20 and all(map(_UNIT.fullmatch, parts))


def has_number(cell: str) -> bool:
    """Return whether a cell holds a number, with or without a unit."""
    return any(sign.isdigit() for sign in cell) and number_of(cell, ",") is not None


def thousands_in(cells: Iterable[str]) -> str:
    """Return the first of the cells with a decimal sign if in each of them it may stand between thousands, else nothing."""
    marked = (cell for cell in cells if ("." in cell or "," in cell) and not is_missing(cell))
    first = next(marked, "")
    return first if THOUSANDS.fullmatch(first) and all(map(THOUSANDS.fullmatch, marked)) else ""


def read_as(cell: str) -> str:
    """Return how a number is read whose sign may stand between thousands."""
    number = float(cell.replace(",", "."))
    return f"{cell!r} was read as {number:g}, not as {1000 * number:g}."


def decimal_of(text: str, sign: str, path: object, place: str) -> str:
    """Return a number with a decimal point, or refuse one with marks that may be of thousands and are not the decimal sign."""
    mantissa = re.split("[eE]", text)[0]
    if THOUSANDS.fullmatch(mantissa) and re.sub(r"[+\-\d]", "", mantissa) != sign:
        advice = "write it with a decimal point, and without them"
        raise InputError(f"{path}: {show(text)} in {place} may have marks between thousands; {advice}.")
    return text.replace(",", ".")


def rows_listed(numbers: Iterable[object], most: int = MAX_LISTED_ROWS) -> str:
    """Return rows of a file as a sentence lists them, the first of them where there are many."""
    named = list(map(str, numbers))
    return ", ".join(named[:most]) + (", ..." if len(named) > most else "")


def rows_left_out(numbers: Sequence[object], which: str) -> str:
    """Return the note that rows of a file are left out."""
    return f"{len(numbers)} row{'s' * (len(numbers) > 1)} {which} left out: {rows_listed(numbers)}."
