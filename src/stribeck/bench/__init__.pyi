"""The public names with their types; at run time each is imported on first use."""

from stribeck.bench.reading import read

__all__ = ["read"]
