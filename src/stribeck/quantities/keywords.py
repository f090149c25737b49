"""A typing error in a name, answered with the nearest one that is known."""

import difflib
import inspect
import re
from collections.abc import Callable, Iterable
from functools import wraps
from typing import Any, ParamSpec, TypeVar

P = ParamSpec("P")
R = TypeVar("R")


def nearest(name: object, names: Iterable[str]) -> str:
    """Return the known name that was probably meant; empty where none is near."""
    return next(iter(difflib.get_close_matches(str(name), list(names), n=1)), "")


def known_names(name: object, names: Iterable[str], others: str = "known are") -> str:
    """Return the end of a sentence on an unknown name: what was probably meant, or all that are known."""
    near = nearest(name, names := list(names))
    return f"did you mean {near}?" if near else f"{others} {', '.join(names)}."


def answers_typos(function: Callable[P, R]) -> Callable[P, R]:
    """Return a function that answers a misspelled argument with the nearest name."""

    @wraps(function)
    def called(*args: P.args, **kwargs: P.kwargs) -> R:
        try:
            return function(*args, **kwargs)
        except TypeError as problem:
            raise with_nearest(problem, function) from None

    return called


def with_nearest(problem: TypeError, function: Callable[..., Any]) -> TypeError:
    """Return the error with the name that was probably meant, if it says that ``function`` has no such argument."""
    match = re.fullmatch(r"(?:(\S+)\(\) )?got an unexpected keyword argument '(\w+)'", str(problem))
    if match is None or (match[1] or function.__name__).rpartition(".")[2] != function.__name__:
        return problem
    parameters = inspect.signature(function).parameters.values()
    names = [each.name for each in parameters if each.kind is not each.VAR_KEYWORD and each.name != "self"]
    return TypeError(f"{'' if match[1] else f'{function.__name__}() '}{problem}; {known_names(match[2], names, 'it takes')}")
