"""Attributes and public names that are made on their first use."""

import functools
import re
import sys
from collections.abc import Callable
from importlib import import_module
from typing import TypeVar

T = TypeVar("T")


class cached_property(functools.cached_property[T]):  # noqa: N801
    """An attribute that is made on its first use, without the lock that Python 3.11 holds meanwhile."""

    # A process that is forked while a thread makes an attribute would find that lock taken for good.

    def __get__(self, instance: object, owner: type | None = None) -> T:  # type: ignore[override]
        """Return the attribute."""
        if instance is None:
            return self  # type: ignore[return-value]
        assert self.attrname is not None
        known = vars(instance)
        if self.attrname not in known:
            known[self.attrname] = self.func(instance)
        found: T = known[self.attrname]
        return found


def lazy_names(package: str, *, has_laws: bool = False) -> tuple[list[str], Callable[[str], object], Callable[[], list[str]]]:
    """Return ``__all__``, ``__getattr__`` and ``__dir__`` of a package, whose stub says where each of its names is."""
    [folder] = sys.modules[package].__path__
    with open(f"{folder}/__init__.pyi", encoding="utf-8") as stub:
        imports = re.findall(r"^from (\S+) import (\([^)]*\)|.*)", stub.read(), re.MULTILINE)
    homes = {name: home for home, names in imports for name in re.findall(r"\w+", names)}
    public = sorted(homes)

    def find(name: str) -> object:
        """Import a public name on its first use."""
        if name not in homes and has_laws and name[:1].isupper():
            law = import_module("stribeck.quantities.registry").law_class(package, name)
            if law is not None:
                return law
        if name not in homes:
            # Of names that Python itself asks for nothing is near.
            near = "" if name.startswith("_") else import_module("stribeck.quantities.keywords").nearest(name, public)
            raise AttributeError(f"module {package!r} has no attribute {name!r}{f'; did you mean {near}?' if near else ''}")
        if homes[name] == package:
            return import_module(f"{package}.{name}")
        found = getattr(import_module(homes[name]), name)
        setattr(sys.modules[package], name, found)
        return found

    return public, find, lambda: public
