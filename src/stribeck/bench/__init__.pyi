"""The public names with their types; at run time each is imported on first use."""

from stribeck.bench.loop_fit import fit_loop
from stribeck.bench.reading import read

__all__ = ["fit_loop", "read"]
