"""Lubricated rough contacts, cylinder or ball: from a data sheet to a converged Stribeck curve."""

from stribeck.quantities.lazy import lazy_names as _lazy_names

__all__, _find, __dir__ = _lazy_names(__name__)


def __getattr__(name: str) -> object:
    """Import a public name on its first use, and read the version from the installed package when asked for."""
    if name == "__version__":
        from importlib.metadata import version

        return version("stribeck")
    return _find(name)
