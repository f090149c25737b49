"""The public names with their types; at run time each is imported on first use."""

from stribeck import asymptotics, atlas, fluids, solids, surfaces
from stribeck.batches.executors import SweepError
from stribeck.batches.result import BatchSolution
from stribeck.batches.solve_batch import solve_batch
from stribeck.cases.case import Case
from stribeck.cases.fit_settings import FitSettings
from stribeck.cases.reading import load_case
from stribeck.checks.check import Check, Checks
from stribeck.checks.table import check
from stribeck.cli.reports.explain import Explanation as Explanation
from stribeck.cli.reports.explain import explain as explain
from stribeck.contact_laws.finite_surface import FiniteSurface
from stribeck.contact_laws.function import FunctionLaw
from stribeck.contact_laws.greenwood import GreenwoodTripp, GreenwoodWilliamson
from stribeck.contact_laws.table import TableLaw
from stribeck.contacts.friction import Friction
from stribeck.contacts.line import Groups, HertzScales, InputError, LineContact
from stribeck.contacts.point import PointContact
from stribeck.contacts.regime import regime_of
from stribeck.curves.landmarks import Landmark
from stribeck.curves.result import StribeckCurve
from stribeck.curves.stribeck_curve import stribeck_curve
from stribeck.data_sheet.new_case import new_case
from stribeck.data_sheet.report import write_report
from stribeck.experiments.compare import Comparison, compare
from stribeck.experiments.next_runs import Plan, next_runs
from stribeck.fits.fit import fit
from stribeck.fits.measurements import Measurements, read_measurements
from stribeck.fits.result import Fit, FitOutcome, FittedInput
from stribeck.quantities.outcome import Outcome
from stribeck.regimes.phase_diagram import phase_diagram
from stribeck.solver.point.solution import Field, PointSolution
from stribeck.solver.solution import Profile, Solution
from stribeck.solver.solve import solve
from stribeck.solver.solve_error import SolveError
from stribeck.sweeps.dataset import Sweep, open_sweep
from stribeck.sweeps.design import SweepDesign, load_sweep
from stribeck.sweeps.sweep import SweepProgress, sweep
from stribeck.uncertainty.propagate import propagate
from stribeck.uncertainty.result import Spread, Uncertainty

__all__ = [
    "BatchSolution",
    "Case",
    "Check",
    "Checks",
    "Explanation",
    "Field",
    "FiniteSurface",
    "Comparison",
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
    "PointContact",
    "PointSolution",
    "Plan",
    "Profile",
    "Solution",
    "SolveError",
    "Spread",
    "StribeckCurve",
    "Sweep",
    "SweepDesign",
    "SweepError",
    "SweepProgress",
    "TableLaw",
    "Uncertainty",
    "asymptotics",
    "atlas",
    "check",
    "explain",
    "compare",
    "fit",
    "fluids",
    "load_case",
    "load_sweep",
    "new_case",
    "next_runs",
    "open_sweep",
    "phase_diagram",
    "propagate",
    "read_measurements",
    "regime_of",
    "solids",
    "solve",
    "solve_batch",
    "stribeck_curve",
    "surfaces",
    "sweep",
    "write_report",
]

__version__: str
