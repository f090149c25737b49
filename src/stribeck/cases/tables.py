"""The walk over the tables of a file: which keys they may have, what each may hold, and a sentence for each problem."""

import difflib
import math
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any, NamedTuple

from stribeck.contacts.geometries import LETTERS
from stribeck.contacts.parts import LAW_NUMBERS
from stribeck.quantities.units import FROM_HARDNESS, InputError, checked_word, show

# Input that a symbol or a usual name stands for
MEANT = {
    **{letter: row.name for row in LAW_NUMBERS.values() for letter in row.letters},
    **LETTERS,
    "poisson": "poisson_ratio",
    **dict.fromkeys(("mu", "cof", "friction_coefficient"), "boundary_friction"),
    **dict.fromkeys(("name", "fluid", "liquid"), "preset"),
    **dict.fromkeys(("type", "kind", "law"), "model"),
}

MIN_SIMILARITY = 0.8  # Smallest similarity, 0 to 1, of a typing error and the word meant: 0.8 allows one letter in five

MIN_PREFIX_LETTERS = 4  # Smallest number of letters of a word that stands for the key that begins with it

_RMS_HINT = "heights are root mean squares: rq or ra in [contact], h_rms in [surface]"
_LOAD_HINT = "give load: for a cylinder in N/m, or force in N with its width; for a ball, geometry = 'point', the force in N"

# Whole words of a key, and what the package has instead. The first match answers.
_HINTS = (
    (("shore", "hardness", "irhd"), FROM_HARDNESS),
    (("ra", "rq", "r_a", "r_q", "sq", "sa"), _RMS_HINT),
    (
        ("pressure_viscosity", "piezoviscous", "barus", "roelands"),
        "it is pressure_coefficient in the table [fluid]",
    ),
    (
        ("temperature", "viscosity_index", "thermal"),
        "there is no temperature: give viscosity at that of the contact, or a preset with its temperature in [fluid]",
    ),
    (
        ("relaxation_time", "infinite_viscosity", "shear_thinning"),
        "shear thinning is described in the table [fluid]",
    ),
    (
        ("shear_stress", "shear_strength", "asperity_friction"),
        "it stands in the table [asperity_friction] with model = 'shear-stress', in the place of boundary_friction",
    ),
    (
        ("density", "rho"),
        "density goes with kinematic_viscosity in [contact]; the number of asperities per area is density in [asperities]",
    ),
    (
        ("shear_modulus", "storage_modulus", "loss_modulus", "bulk_modulus"),
        "for the solid give modulus, which is E*, or youngs_modulus and poisson_ratio; for a shear modulus G and a Poisson "
        "ratio nu, E* = 2 G/(1 - nu)",
    ),
    (("force", "normal_force", "weight", "mass"), _LOAD_HINT),
    (("length",), _LOAD_HINT),
    (("diameter",), "give radius, half the diameter; of a shaft that turns, shaft_diameter with rotational_speed"),
    (
        ("ellipticity", "ball", "sphere"),
        "for a ball write geometry = 'point' and its radius; elliptic contacts are not modelled",
    ),
    (
        ("slide_to_roll", "srr", "slip", "motion"),
        "write slide_to_roll in [contact], and the sum of both speeds as speed or their mean as entrainment_speed",
    ),
    (
        ("rpm", "angular_velocity", "rotation"),
        "give rotational_speed, such as '1500 rpm', with shaft_diameter, that of shaft or track",
    ),
)


def advice_on(key: str, known: Iterable[str], file: Mapping[str, Iterable[str]] | None = None) -> str:
    """Return what to write in place of an unknown key, where in the file it belongs, or else all keys that are known."""
    names = list(known)
    if MEANT.get(key) in names:
        return f"write {MEANT[key]}"
    whole = [name for name in names if len(key) >= MIN_PREFIX_LETTERS and name.startswith(key.lower())]
    # Only a slip of the pen is taken for another key: pressure_viscosity is no viscosity.
    near = whole or difflib.get_close_matches(key.lower(), names, n=1, cutoff=MIN_SIMILARITY)
    text = "_" + re.sub(r"[^a-z0-9]+", "_", key.lower()).strip("_") + "_"
    words_here = ((word, hint) for words, hint in _HINTS for word in words if f"_{word}_" in text)
    absent = next((hint for word, hint in words_here if text == f"_{word}_" or not (near and word in near[0])), "")
    if absent:
        return absent
    for table, keys in (file or {}).items():
        if key in keys or MEANT.get(key, key) in keys:
            where = f"in the table [{table}]" if table else "at the top of the file, before the first table"
            return f"it belongs {where}"
    return f"did you mean {near[0]}" if near else f"known are {', '.join(names)}"


Check = Callable[[str, Any], Any]  # `check(name, value)` returns what is kept, or refuses it


class Key(NamedTuple):
    """A key that a table may have."""

    check: Check
    default: Any = None  # What stands for one that is not given; None for nothing


Keys = Mapping[str, Key]  # The keys of a table by name


@contextmanager
def noted(problems: list[str], table: str = "") -> Iterator[None]:
    """Note what is refused among the problems of a file, a line each, with its table where it has none."""
    try:
        yield
    except InputError as problem:
        problems += [line if not table or line.startswith("[") else f"[{table}] {line}" for line in str(problem).splitlines()]


def read_tables(given: Mapping[str, Any], file: Mapping[str, Keys], problems: list[str]) -> dict[str, Any]:
    """Return the tables of a file, and the keys at its top, which are those of the table without a name."""
    found: dict[str, Any] = {}
    for name, keys in file.items():
        table = given.get(name, {}) if name else {key: value for key, value in given.items() if key not in file}
        if not isinstance(table, dict):
            problems.append(f"{name} = {show(table)} must be a table, [{name}].")
            continue
        read = {key: each.default for key, each in keys.items() if each.default is not None}
        for key, value in table.items():
            with noted(problems, name):
                read[key] = keys[key].check(key, value) if key in keys else unknown(key, value, keys, file)
        if not name:
            found |= read
        elif name in given or read:
            found[name] = read
    return found


def unknown(key: str, value: Any, known: Iterable[str], file: Mapping[str, Iterable[str]] | None = None) -> Any:
    """Refuse a key that a table does not have, with what was probably meant, or where in the file it belongs."""
    tables, names = file or {}, list(known)
    if known is tables.get(""):
        names = [*filter(None, tables), *names]
    shown = key if key.isprintable() else repr(key)
    raise InputError(f"{shown} = {show(value)} is not a known key; {advice_on(key, names, tables)}.")


AS_GIVEN = Key(lambda name, value: value)  # A key that its own reader checks


def must(is_right: Callable[[Any], bool], what: str) -> Check:
    """Return the check of a value that must be ``what``."""

    def check(name: str, value: Any) -> Any:
        if not is_right(value):
            raise InputError(f"{name} = {show(value)} must be {what}.")
        return value

    return check


def one_of(*words: str) -> Check:
    """Return the check of one of several words."""
    return lambda name, value: checked_word(name, value, words)


def whole(low: int, high: int, what: str = "") -> Check:
    """Return the check of a whole number."""
    return must(
        lambda value: isinstance(value, int) and not isinstance(value, bool) and low <= value <= high,
        what or f"a whole number from {low} to {high}",
    )


def is_real(value: Any) -> bool:
    """Return whether a value is a number without quotes."""
    return isinstance(value, int | float) and not isinstance(value, bool)


def is_number(value: Any) -> bool:
    """Return whether a value is a finite number without quotes."""
    return is_real(value) and math.isfinite(value)


TEXT = must(lambda value: isinstance(value, str), "text in quotes")
TRUTH = must(lambda value: isinstance(value, bool), "true or false, without quotes")
NUMBERS = must(lambda value: isinstance(value, list) and all(map(is_real, value)), "a list of numbers, without quotes")


def rising_pair(name: str, value: Any, read: Callable[[Any], float], of: str = "value") -> tuple[float, float]:
    """Return the ends of a range, each of which ``read`` returns, or refuse what is none."""
    if not isinstance(value, list) or len(value) != 2:
        raise InputError(f"{name} = {show(value)} must be a list of two values, the lowest and the highest {of}.")
    low, high = map(read, value)
    if not low < high:
        raise InputError(f"{name} = {show(value)} must increase; write the lowest {of} first.")
    return low, high


def tolerance(default: float) -> Key:
    """Return the key of a relative tolerance."""
    what = "a number from 1e-11 to 1e-2, without quotes"
    return Key(must(lambda value: is_number(value) and 1e-11 <= value <= 1e-2, what), default)


# Keys at the top of a case.
HEAD = {"title": Key(TEXT, ""), "notes": Key(TEXT, ""), "uncertainty": Key(one_of("given", "typical"), "given")}
