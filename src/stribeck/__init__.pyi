"""The public names with their types; at run time each is imported on first use."""

from stribeck import asymptotics, atlas, bench, contact_laws, fluids, motions, profiles, results, solids, surfaces
from stribeck.batches.executors import SweepError
from stribeck.batches.solve_batch import solve_batch
from stribeck.cases.case import Case
from stribeck.cases.fit_settings import FitSettings
from stribeck.cases.reading import load_case
from stribeck.checks.table import check
from stribeck.cli.reports import explain
from stribeck.contacts.friction import regime_of
from stribeck.contacts.geometries import LineContact, PointContact
from stribeck.contacts.groups import Groups
from stribeck.curves.stribeck_curve import stribeck_curve
from stribeck.data_sheet.new_case import new_case
from stribeck.data_sheet.report import write_report
from stribeck.experiments.compare import compare
from stribeck.experiments.master_curve import master_curve
from stribeck.experiments.next_runs import next_runs
from stribeck.fits.fit import fit
from stribeck.fits.measurements import read_measurements
from stribeck.quantities.outcome import Outcome
from stribeck.quantities.units import InputError
from stribeck.regimes.phase_diagram import phase_diagram
from stribeck.solver.solve import solve
from stribeck.solver.solve_error import SolveError
from stribeck.strokes.stroke import stroke
from stribeck.sweeps.design import load_sweep
from stribeck.sweeps.sweep import open_sweep, sweep
from stribeck.uncertainty.propagate import propagate

__all__ = [
    "Case",
    "FitSettings",
    "Groups",
    "InputError",
    "LineContact",
    "Outcome",
    "PointContact",
    "SolveError",
    "SweepError",
    "asymptotics",
    "atlas",
    "bench",
    "check",
    "compare",
    "contact_laws",
    "explain",
    "fit",
    "fluids",
    "load_case",
    "load_sweep",
    "master_curve",
    "motions",
    "new_case",
    "next_runs",
    "open_sweep",
    "phase_diagram",
    "profiles",
    "propagate",
    "read_measurements",
    "regime_of",
    "results",
    "solids",
    "solve",
    "solve_batch",
    "stribeck_curve",
    "stroke",
    "surfaces",
    "sweep",
    "write_report",
]

__version__: str
