"""TOML files: written, and read within bounds of size and depth, with sentences for what is wrong."""

import json
import re
import tomllib
from pathlib import Path
from typing import Any

from stribeck.files.reading import content_of
from stribeck.quantities.units import InputError

MAX_TOML_BYTES = 1_000_000

_MAX_DEPTH = 16  # Tables and lists in one another
_MAX_KEY_PARTS = 64  # For 20 000 parts Python's parser takes half a minute

# Such keys are looked for before the parser sees the text. Texts may hold a few that look alike.
_PART = r"""(?:[A-Za-z0-9_-]++|"(?:[^"\\\n]|\\.)*+"|'[^'\n]*+')"""
_DEEP_KEY = re.compile(rf"(?<![A-Za-z0-9_-]){_PART}(?:[ \t]*+\.[ \t]*+{_PART}){{{_MAX_KEY_PARTS}}}")

# What Python's parser says of slips that are frequent, and what to do about them.
_SLIPS = {
    "Expected newline or end of document after a statement": 'a value with a unit needs quotes, as in radius = "10 mm"',
    "Cannot overwrite a value": "a key may occur only once in its table",
}


def read_toml(path: Path, kind: str = "case file", needed: str = "[contact]") -> dict[str, Any]:
    """Return the tables of a TOML file."""
    return parse_toml(content_of(path, MAX_TOML_BYTES, f"a TOML {kind}"), path, kind, needed)


def parse_toml(content: bytes, path: Path, kind: str = "case file", needed: str = "[contact]") -> dict[str, Any]:
    """Return the tables of the content of a TOML file that comes from ``path``, as :func:`read_toml` does."""
    if len(content) > MAX_TOML_BYTES:
        raise InputError(f"{path} has more than {MAX_TOML_BYTES} bytes; a {kind} is a short TOML file.")
    try:
        # Some editors write a byte-order mark, which TOML does not know.
        text = content.decode("utf-8-sig")
        if _DEEP_KEY.search(text):
            raise ValueError(f"a key has more than {_MAX_KEY_PARTS} parts")
        table = tomllib.loads(text)
        if _depth(table) > _MAX_DEPTH:
            raise ValueError(f"tables or lists are nested more than {_MAX_DEPTH} deep")
    except UnicodeDecodeError as problem:
        raise InputError(
            f"{path} is not text (byte {problem.start} is not UTF-8); a {kind} is a short TOML file, saved as UTF-8."
        ) from None
    except (ValueError, RecursionError) as problem:
        message = " ".join(str(problem).split())
        advice = "".join(f"; {advice}" for slip, advice in _SLIPS.items() if message.startswith(slip))
        raise InputError(f"{path} is not valid TOML: {message}{advice}.") from None
    if not table:
        raise InputError(f"{path} is empty; a {kind} needs at least the table {needed}.")
    return table


def _depth(table: Any) -> int:
    """Return how deep tables and lists lie in each other."""
    depth, level = 0, [table]
    while level:
        depth += 1
        inner = [value.values() if isinstance(value, dict) else value for value in level]
        level = [value for values in inner for value in values if isinstance(value, dict | list)]
    return depth


_BARE_KEY = re.compile(r"[A-Za-z0-9_-]+")


def toml_text(tables: dict[str, Any], path: tuple[str, ...] = ()) -> str:
    """Return tables as TOML."""
    values = {key: value for key, value in tables.items() if not isinstance(value, dict)}
    lines = [f"\n[{'.'.join(map(_key, path))}]\n"] if path and (values or not tables) else []
    lines += [f"{_key(key)} = {_value(value)}\n" for key, value in values.items()]
    lines += [toml_text(value, (*path, key)) for key, value in tables.items() if isinstance(value, dict)]
    return "".join(lines)


def _key(name: str) -> str:
    return name if _BARE_KEY.fullmatch(name) else _value(name)


def _value(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, list):
        return f"[{', '.join(map(_value, value))}]"
    if isinstance(value, dict):
        return f"{{ {', '.join(f'{_key(key)} = {_value(each)}' for key, each in value.items())} }}"
    return repr(value)
