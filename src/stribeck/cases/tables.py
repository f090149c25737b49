"""The walk over the tables of a file: which keys they may have, what each may hold, and a sentence for each problem."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any, NamedTuple

from stribeck.cases.hints import advice_on
from stribeck.quantities.units import InputError, checked_word, show

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
    advice = advice_on(key, names, tables) or f"known are {', '.join(names)}"
    raise InputError(f"{key if key.isprintable() else repr(key)} = {show(value)} is not a known key; {advice}.")


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
