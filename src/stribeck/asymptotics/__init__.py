"""Asymptotic laws of the model, each with its range and source; never imported by the solver, which they judge."""

from . import hydrodynamic

__all__ = ["hydrodynamic"]
