"""Docstrings that share their words: what many functions say of an argument, a value or an error is written once.

``speed: Annotated[float, "the sum of both speeds", "m/s"]`` says a field of a result in the docstring and in files.
"""

from __future__ import annotations

import ast
import inspect
import re
from collections.abc import Callable, Mapping
from typing import Any, ClassVar, NamedTuple, TypeVar

Function = TypeVar("Function", bound=Callable[..., Any])


class Words(NamedTuple):
    """What is said of a field."""

    kind: str
    meaning: str
    unit: str | None = None  # None where it is no number


class Described:
    """A class whose fields say what they are; its docstring lists them as attributes."""

    _words: ClassVar[dict[str, Words]] = {}

    def __init_subclass__(cls, title: str = "Attributes") -> None:
        """Put what is said of the fields into the docstring, under ``title``."""
        super().__init_subclass__()
        own: dict[str, Words] = {}
        for name, text in inspect.get_annotations(cls).items():
            if str(text).startswith("Annotated["):
                kind, *words = ast.parse(text, mode="eval").body.slice.elts
                own[name] = Words(ast.unparse(kind), *map(ast.literal_eval, words))
        cls._words = {name: each for base in cls.__mro__[:0:-1] for name, each in vars(base).get("_words", {}).items()} | own
        if own:
            listed = "\n".join(f"{name} : {each.kind}\n    {_sentence(each)}" for name, each in cls._words.items())
            head, *rest = re.split(r"(?m)^(?=(?:Raises|Notes|Examples)\n-)", inspect.getdoc(cls) or "")
            cls.__doc__ = f"{head.strip()}\n\n{title}\n----------\n{listed}\n\n{''.join(rest)}".rstrip() + "\n"


def _sentence(words: Words) -> str:
    bare = " [-]" if words.kind == "float" else ""
    unit = bare if words.unit == "1" else f" [{words.unit}]" if words.unit else ""
    return f"{words.meaning[0].upper()}{words.meaning[1:]}{unit}."


_HEADING = re.compile(r"^(\w+)\n-+\n", re.MULTILINE)


def complete_docstring(
    function: Callable[..., Any], arguments: Mapping[str, str], returns: str = "", raises: str = "", notes: str = ""
) -> str:
    """Return the docstring of a function or class with the sections, and the arguments, that it leaves out."""
    head, *parts = _HEADING.split(inspect.getdoc(function) or "")
    own = {title: text.strip("\n") for title, text in zip(parts[::2], parts[1::2], strict=True)}
    described = dict(re.findall(r"^(\w+) : (.*(?:\n    .*)*)", own.get("Parameters", ""), re.MULTILINE))
    names = [
        f"**{name}" if each.kind is each.VAR_KEYWORD else name
        for name, each in inspect.signature(function).parameters.items()
        if name != "self"
    ]
    sections = {
        "Parameters": "\n".join(f"{name} : {described.get(name) or arguments[name]}" for name in names),
        "Attributes": own.get("Attributes", ""),
        "Returns": own.get("Returns", returns),
        "Raises": own.get("Raises", raises),
        "Notes": "\n\n".join(filter(None, (own.get("Notes", ""), notes))),
        "Examples": own.get("Examples", ""),
    }
    body = "\n\n".join(f"{title}\n{'-' * len(title)}\n{text}" for title, text in sections.items() if text)
    return f"{head.strip()}\n\n{body}\n"


def told(arguments: Mapping[str, str], returns: str = "", raises: str = "") -> Callable[[Function], Function]:
    """Return the decorator that completes the docstring of a function or method by what it shares with others."""

    def complete(function: Function) -> Function:
        function.__doc__ = complete_docstring(function, arguments, returns, raises)
        return function

    return complete
