"""Laws by name, those of others too: every class of a kind in a package, and what is given under ``stribeck.laws``.

A new law is a new file in the package of its kind, or an entry point of another distribution::

    [project.entry-points."stribeck.laws"]
    my-law = "my_package.my_module:MyLaw"
"""

import functools
import inspect
import pkgutil
from collections.abc import Callable, Hashable
from functools import lru_cache
from importlib import import_module
from importlib.metadata import entry_points
from typing import Any

import numpy as np

from stribeck.quantities.units import InputError


@functools.cache
def laws_of(package: str, kind: type) -> dict[str, Any]:
    """Return the classes of a kind by their names, in the order of modules and lines."""
    classes = [*_classes_in(package), *_classes_of_others()]
    named = [(vars(each).get("kind", vars(each).get("name")), each) for each in classes if kind in each.__mro__]
    return {name: each for name, each in named if isinstance(name, str)}


def law_class(package: str, name: str) -> Any:
    """Return the law of a package, or on a base class of it, whose class has this name; None where there is none."""
    inner = [each.name for each in pkgutil.iter_modules(import_module(package).__path__) if each.ispkg]
    classes = [each for home in (package, *(f"{package}.{each}" for each in inner)) for each in _classes_in(home)]
    classes += [
        each for each in _classes_of_others() if any(base.__module__.startswith(f"{package}.") for base in each.__mro__)
    ]
    return next((each for each in classes if each.__name__ == name and not inspect.isabstract(each)), None)


def _classes_in(package: str) -> list[Any]:
    """Return the classes that the modules of a package define, in the order of modules and lines."""
    modules = [f"{package}.{each.name}" for each in pkgutil.iter_modules(import_module(package).__path__)]
    members = [(module, each) for module in modules for each in vars(import_module(module)).values()]
    return [each for module, each in members if inspect.isclass(each) and each.__module__ == module]


@functools.cache
def _classes_of_others() -> list[Any]:
    return [each.load() for each in entry_points(group="stribeck.laws")]


GUIDE = "See Add a fluid in for_developers.md."


def refusal(kind: str, part: Any, sentence: str) -> InputError:
    """Return the error that refuses a part of that kind, with its name."""
    return InputError(f"the {kind} {getattr(part, 'name', None) or type(part).__name__!r}: {sentence} {GUIDE}")


def check_user_part(kind: str, part: Any, check: Callable[[Any], None]) -> None:
    """Refuse a user's part that ``check`` refuses or fails on; parts of the package have tests of their own."""
    if type(part).__module__.startswith("stribeck."):
        return
    if not isinstance(part, Hashable):
        raise refusal(kind, part, "it cannot be hashed; make it a frozen dataclass.")
    _check_once(kind, part, check)


@lru_cache(maxsize=64)
def _check_once(kind: str, part: Any, check: Callable[[Any], None]) -> None:
    try:
        with np.errstate(all="ignore"):
            check(part)
    except InputError:
        raise
    except Exception as error:
        raise refusal(kind, part, f"its check fails with {type(error).__name__}: {error}.") from error
