"""Laws by name: every class of a kind in a package, and those that other packages give under ``stribeck.laws``.

A new law is a new file in the package of its kind, or an entry point of another distribution::

    [project.entry-points."stribeck.laws"]
    my-law = "my_package.my_module:MyLaw"
"""

from __future__ import annotations

import functools
import inspect
import pkgutil
from importlib import import_module
from importlib.metadata import entry_points
from typing import Any

__all__ = ["laws_of"]


@functools.cache
def laws_of(package: str, kind: type) -> dict[str, Any]:
    """Return the classes of a kind by their names, in the order of modules and lines."""
    home = import_module(package)
    classes: list[Any] = []
    for module in pkgutil.iter_modules(home.__path__):
        members = vars(import_module(f"{package}.{module.name}")).values()
        classes += [each for each in members if inspect.isclass(each) and each.__module__ == f"{package}.{module.name}"]
    classes += [each.load() for each in entry_points(group="stribeck.laws")]
    named = [(vars(each).get("kind", vars(each).get("name")), each) for each in classes if kind in each.__mro__]
    return {name: each for name, each in named if isinstance(name, str)}
