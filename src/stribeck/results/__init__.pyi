"""The public names with their types; at run time each is imported on first use."""

from stribeck.asymptotics.pressure_film import Films, Inlet, PressureFilm
from stribeck.batches.result import BatchSolution
from stribeck.bench.loop_fit import LoopFit
from stribeck.bench.result import BenchCurve
from stribeck.checks.check import Check, Checks
from stribeck.cli.reports import Explanation
from stribeck.contacts.contact import HertzScales
from stribeck.contacts.friction import Friction
from stribeck.curves.regime import Landmark
from stribeck.curves.result import StribeckCurve
from stribeck.curves.simulator_model import StribeckModel
from stribeck.experiments.compare import Comparison
from stribeck.experiments.master_curve import MasterCurve
from stribeck.experiments.next_runs import Plan
from stribeck.fits.measurements import Measurements
from stribeck.fits.result import Fit, FitOutcome, FittedInput
from stribeck.quantities.standard_errors import StandardErrors
from stribeck.solver.fields import Field, Profile
from stribeck.solver.point.solution import PointSolution
from stribeck.solver.solution import Solution
from stribeck.strokes.result import Stroke
from stribeck.sweeps.design import SweepDesign
from stribeck.sweeps.sweep import Sweep, SweepProgress
from stribeck.uncertainty.result import Spread, Uncertainty

__all__ = [
    "BatchSolution",
    "BenchCurve",
    "Check",
    "Checks",
    "Comparison",
    "Explanation",
    "Field",
    "Films",
    "Fit",
    "FitOutcome",
    "FittedInput",
    "Friction",
    "HertzScales",
    "Inlet",
    "Landmark",
    "MasterCurve",
    "LoopFit",
    "Measurements",
    "Plan",
    "PointSolution",
    "PressureFilm",
    "Profile",
    "Solution",
    "Spread",
    "StandardErrors",
    "StribeckCurve",
    "StribeckModel",
    "Stroke",
    "Sweep",
    "SweepDesign",
    "SweepProgress",
    "Uncertainty",
]
