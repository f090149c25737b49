"""What the lines above heights in a text file declare: units of columns, sizes of the scan, steps and codes for no height."""

import math
import re
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path

from stribeck.files.cells import THOUSANDS, decimal_of
from stribeck.quantities.units import InputError, show, to_si

_NAMES = {
    "um": ("micrometer", "micrometre", "mikrometer", "micron"),
    "nm": ("nanometer", "nanometre"),
    "mm": ("millimeter", "millimetre"),
    "Å": ("angstrom", "ångström"),
    "m": ("meter", "metre"),
}
_WORDS = {word: unit for unit, words in _NAMES.items() for word in words}
_LENGTH = r"(?:nm|µm|μm|um|ƒÊm|mm|cm|pm|m|Å|A|(?:" + "|".join(sorted(_WORDS, key=len, reverse=True)) + r")s?)"
_UNIT = re.compile(rf"[\[(]\s*([^\])]+?)\s*[\])]|(?:^|[,/_ ])\s*({_LENGTH})\s*$", re.IGNORECASE)
_NUMBER = rf"(?:{THOUSANDS.pattern}(?!\d)|[+-]?(?:\d+(?:[.,]\d+)?|\.\d+))(?:[eE][+-]?\d+)?"
_PER = r"\s*(?:/|per|pro)\s*(?:pixels?|px|pix|samples?|points?|pts?|punkte?)\b\.?"
_ENTRY = re.compile(
    rf"(?P<key>[^:=;,\t]*?[^\W\d_][^:=;,\t]*?)\s*[:=;,\t]+\s*(?P<first>{_NUMBER})\s*[;,\t]*\s*(?P<unit>{_LENGTH})?(?P<per>{_PER})?"
    rf"(?:\s*[x×*;,\t]\s*(?P<second>{_NUMBER})\s*(?P<other>{_LENGTH})?(?P<per2>{_PER})?)?\s*[;,\t]*\s*",
    re.IGNORECASE,
)
_IN_KEY = re.compile(rf"[\[(]\s*({_LENGTH})({_PER})?\s*[\])]|(?:^|\s)({_LENGTH})({_PER})|[_ ]({_LENGTH})$", re.IGNORECASE)
_UNIT_LINE = re.compile(r"([^:=;,\t]*?)units?\b([^:=;,\t]*?)\s*[:=;,\t]+\s*([^\s;,\t]+)[\s;,\t]*", re.IGNORECASE)
_CODE_LINE = re.compile(
    rf"[^:=;,\t]*(?:no[ _-]?data|missing|invalid|bad|void|fehl)[^:=;,\t]*[:=;,\t\s]+\s*({_NUMBER})\W*", re.IGNORECASE
)
_SCALE_LINE = re.compile(
    r"(?=[^:=;,\t]*(?:s[ck]al|fa[ck]tor|multipl|bit2nm))(?=[^:=;,\t]*(?:(?<![a-z])z(?![a-z])|zscale|height|höhe|data|value|2nm))"
    rf"[^:=;,\t]+[:=;,\t]+\s*(?!1(?:[.,]0*)?\s*$){_NUMBER}(?![\d.,])(?!\s*{_LENGTH}\s*$)[^;,\t]*",
    re.IGNORECASE,
)
_COUNT_LINE = re.compile(
    r"\W*(?:((?:samp(?:le)?s?|points|pixels)\s*(?:/|per)\s*line)|(?:number of |scan )?lines)\s*[:=;,\t]+\s*"
    r"(\d{1,3}(?:[,.' ]\d{3})+|\d+)[\s;,\t]*",
    re.IGNORECASE,
)
_ASPECT_LINE = re.compile(r"\W*aspect ratio\s*[:=;,\t]+\s*([\d.,]+)\s*[:x×/]\s*([\d.,]+)\W*", re.IGNORECASE)
_OTHER = re.compile(
    r"\b(z|values?|speed|time|force|minimum|maximum|min|max|cut ?off|filter|lambda|tip|radius|wavelengths?|offset|position|"
    r"origin|start|end|focus|objective|magnification|rms|s?[rs]aq?|sigma|standard|file|data)\b"
)
_STEP = re.compile(
    r"\b(steps?|spacings?|pitch|sampling|increments?|calibration|interval|delta|d[xy]|(?:pixel|pel|point) ?size|pixelgr\w*|"
    r"schrittweite|abstand|inc|scale)\b"
)
_SIZE = re.compile(
    r"\b(width|height|size|range|length|extent|field|fov|area|real|breite|höhe|länge|dimensions?|rangex|rangey|image|[xy])\b"
)


@dataclass(frozen=True)
class Header:
    """Declarations above the heights."""

    lateral: str | None = None  # Unit of positions and of heights, where a line of its own says it
    vertical: str | None = None  # Unit of positions and of heights, where a line of its own says it
    steps: dict[int, tuple[float, str]] = field(default_factory=dict)
    sizes: dict[int, tuple[float, str]] = field(default_factory=dict)
    codes: tuple[float, ...] = ()  # Numbers that stand for no height
    samples: tuple[int, str] | None = None  # Heights in each line of a scan, and what says so
    lines: tuple[int, str] | None = None  # Lines of a scan, and what says so
    scales: tuple[str, ...] = ()  # Lines that declare a factor of the heights

    def spacing(self, path: Path, shape: tuple[int, ...]) -> tuple[tuple[float, str] | None, ...]:
        """Return the distance between points along each axis and the line it is from, None where the header is silent."""
        found: list[tuple[float, str] | None] = []
        for axis, count in enumerate(shape):
            step, size = self.steps.get(axis), self.sizes.get(axis)
            if size is not None and step is not None and abs(step[0] * count / size[0] - 1) > 2 / count:
                raise InputError(
                    f"{path}: {show(step[1])} and {show(size[1])} contradict each other for {count} points; "
                    "remove the wrong line."
                )
            found.append(step if step is not None else None if size is None else (size[0] / count, size[1]))
        return tuple(found)


def unit_symbol(text: str) -> str:
    """Return a unit as the package spells it: ``um`` for ``Micrometer``."""
    word = "angstrom" if text.strip() == "A" else text.strip().lower()  # no current
    return _WORDS.get(word, _WORDS.get(word.removesuffix("s"), text.strip().replace("ƒÊ", "u")))


def unit_of(cell: str) -> str | None:
    """Return the unit that the header of a column declares, as in ``x (um)``, ``Raw Micrometer`` or ``um``."""
    match = _UNIT.search(cell.strip().strip('"').strip())
    if match is None or (match[2] and re.search(r"\d\s*$", cell.strip('" ')[: match.start()])):
        return None
    return unit_symbol(match[1] or match[2])


def header_of(path: Path, lines: Iterable[str], sign: str = ".") -> Header:
    """Return what lines above heights of a decimal sign declare of their units, sizes, steps and codes."""
    lateral = vertical = None
    samples = in_scan = aspect = None
    steps, sizes = dict[int, tuple[float, str]](), dict[int, tuple[float, str]]()
    heights: list[tuple[float, str]] = []
    codes, scales = [], []
    for raw in lines:
        line = re.sub(r'"\s*([,;\t])\s*"', r"\1", raw).strip('"').strip()
        code = _CODE_LINE.fullmatch(line)
        if code:
            codes.append(float(decimal_of(code[1], sign, path, show(raw.strip()))))
            continue
        if _SCALE_LINE.fullmatch(line):
            scales.append(raw.strip())
        ratio = _ASPECT_LINE.fullmatch(line)
        if ratio and ratio[1] != ratio[2]:
            aspect = raw.strip()
        count = _COUNT_LINE.fullmatch(line)
        if count:
            declared = int(re.sub(r"\D", "", count[2])), raw.strip()
            samples, in_scan = (declared, in_scan) if count[1] else (samples, declared)
            continue
        unit = _UNIT_LINE.fullmatch(line)
        if unit and not re.fullmatch(_NUMBER, unit[3]):
            words = _normalised(unit[1] + " " + unit[2])
            symbol = unit_symbol(unit[3].strip("[]()\"'"))
            of_positions = re.search(r"\b(x|y|xy|lateral|horizontal|position\w*|distance)\b", words) is not None
            of_heights = re.search(r"\b(z|value|height|vertical|data|höhe)\b", words) is not None
            lateral = symbol if not of_heights or of_positions else lateral
            vertical = symbol if not of_positions or of_heights else vertical
            continue
        _size_or_step(path, line, raw.strip(), steps, sizes, heights, sign)
    if heights and 0 in sizes:  # the height of a map beside its width, as Gwyddion writes them
        sizes.setdefault(1, heights[0])
    if aspect and 0 in sizes and sizes.get(1) == sizes[0]:
        raise InputError(
            f"{path}: {show(sizes[0][1])} gives one size and {show(aspect)} two; give both, as in 'Scan size: 40 um x 10 um'."
        )
    return Header(lateral, vertical, steps, sizes, tuple(codes), samples, in_scan, tuple(scales))


def _normalised(text: str) -> str:
    return " ".join(re.sub(r"[^0-9a-zäöüßµμ]+", " ", text.lower()).split())


def _size_or_step(
    path: Path,
    line: str,
    original: str,
    steps: dict[int, tuple[float, str]],
    sizes: dict[int, tuple[float, str]],
    heights: list[tuple[float, str]],
    sign: str,
) -> None:
    """Enter the lengths that a line such as ``Width: 48.00 um`` or ``XY calibration,1000.000,nm`` declares."""
    entry = _ENTRY.fullmatch(line)
    if entry is None:
        return
    in_key = _IN_KEY.search(entry["key"])
    own = (in_key[1] or in_key[3] or in_key[5]) if in_key else None
    unit = entry["unit"] or entry["other"] or own
    if unit is None:
        return
    per = bool(entry["per"] or entry["per2"] or (in_key and (in_key[2] or in_key[4])))
    words = _normalised(_IN_KEY.sub(" ", entry["key"]) if own else entry["key"])
    is_step = per or _STEP.search(words) is not None
    if _OTHER.search(words) or not (is_step or _SIZE.search(words)):
        return
    numbers = [entry["first"], *([entry["second"]] if entry["second"] else [])]
    units = [entry["unit"] or unit, entry["other"] or unit]
    lengths = [
        float(decimal_of(number, sign, path, show(original)))
        * to_si(f"1 {unit_symbol(each)}", "length", f"{path}: {original}")
        for number, each in zip(numbers, units, strict=False)
    ]
    if not all(length > 0 and math.isfinite(length) for length in lengths):
        return
    on_x = re.search(r"\b(x|dx|rangex|width|horizontal|breite|columns?)\b", words) is not None
    on_y = re.search(r"\b(y|dy|rangey|vertical|rows?)\b", words) is not None
    target = steps if is_step else sizes
    if len(lengths) == 1 and not is_step and not on_y and words in ("height", "höhe", "scan height", "image height"):
        heights.append((lengths[0], original))
        return
    axes = [0, 1] if on_x == on_y else [0] if on_x else [1]
    for axis in axes:
        length = lengths[axis] if len(lengths) == 2 else lengths[0]
        if axis in target and not math.isclose(target[axis][0], length, rel_tol=1e-3):
            raise InputError(
                f"{path}: {show(target[axis][1])} and {show(original)} contradict each other; remove the wrong line."
            )
        target.setdefault(axis, (length, original))
