"""Asymptotic laws of the model, each with range and source; the solver, which they judge, imports none."""

from . import hydrodynamic

__all__ = ["hydrodynamic"]
