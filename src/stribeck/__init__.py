"""Lubricated rough line contacts: from a data sheet to a converged Stribeck curve."""

from .parameters import Groups, HertzScales, InputError, LineContact
from .newton import Outcome
from .solution import Friction, Profile, Solution
from .solve import SolveError, solve

__all__ = [
    "Friction",
    "Groups",
    "HertzScales",
    "InputError",
    "LineContact",
    "Outcome",
    "Profile",
    "Solution",
    "SolveError",
    "solve",
]
