"""Lubricated rough line contacts: from a data sheet to a converged Stribeck curve."""

from . import asymptotics, atlas, surfaces
from .asperity_laws import GreenwoodTripp, GreenwoodWilliamson
from .batch import BatchSolution, solve_batch
from .case import Case, load_case
from .curve import stribeck_curve
from .curve_result import StribeckCurve
from .fit import fit
from .fit_result import Fit, FitOutcome, FittedInput
from .fit_settings import FitSettings
from .friction import Friction
from .function_law import FunctionLaw
from .landmarks import Landmark
from .measurements import Measurements, read_measurements
from .newton import Outcome
from .parameters import Groups, HertzScales, InputError, LineContact
from .phase_diagram import phase_diagram
from .regimes import regime_of
from .solution import Profile, Solution
from .solve import SolveError, solve
from .sweep import SweepProgress, sweep
from .sweep_dataset import Sweep, open_sweep
from .sweep_design import SweepDesign, load_sweep
from .sweep_store import SweepError
from .table_law import TableLaw

__all__ = [
    "BatchSolution",
    "Case",
    "Fit",
    "FitOutcome",
    "FitSettings",
    "FittedInput",
    "Friction",
    "FunctionLaw",
    "GreenwoodTripp",
    "GreenwoodWilliamson",
    "Groups",
    "HertzScales",
    "InputError",
    "Landmark",
    "LineContact",
    "Measurements",
    "Outcome",
    "Profile",
    "Solution",
    "SolveError",
    "StribeckCurve",
    "Sweep",
    "SweepDesign",
    "SweepError",
    "SweepProgress",
    "TableLaw",
    "asymptotics",
    "atlas",
    "fit",
    "load_case",
    "load_sweep",
    "open_sweep",
    "phase_diagram",
    "read_measurements",
    "regime_of",
    "solve",
    "solve_batch",
    "stribeck_curve",
    "surfaces",
    "sweep",
]


def __getattr__(name: str) -> str:
    """Return the version, read from the installed package only when asked for."""
    if name == "__version__":
        from importlib.metadata import version

        return version("stribeck")
    raise AttributeError(f"module 'stribeck' has no attribute {name!r}")
