"""Docstrings that share their words: what many functions say of an argument, a value or an error is written once."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Mapping
from typing import Any

_HEADING = re.compile(r"^(\w+)\n-+\n", re.MULTILINE)


def complete_docstring(function: Callable[..., Any], arguments: Mapping[str, str], returns: str = "", raises: str = "") -> str:
    """Return the docstring of a function or class with the sections, and the arguments, that it leaves out."""
    head, *parts = _HEADING.split(inspect.getdoc(function) or "")
    own = {title: text.strip("\n") for title, text in zip(parts[::2], parts[1::2], strict=True)}
    described = dict(re.findall(r"^(\w+) : (.*(?:\n    .*)*)", own.get("Parameters", ""), re.MULTILINE))
    names = inspect.signature(function).parameters
    sections = {
        "Parameters": "\n".join(f"{name} : {described.get(name) or arguments[name]}" for name in names),
        "Attributes": own.get("Attributes", ""),
        "Returns": own.get("Returns", returns),
        "Raises": own.get("Raises", raises),
        "Notes": own.get("Notes", ""),
        "Examples": own.get("Examples", ""),
    }
    body = "\n\n".join(f"{title}\n{'-' * len(title)}\n{text}" for title, text in sections.items() if text)
    return f"{head.strip()}\n\n{body}\n"
