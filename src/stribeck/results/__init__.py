"""What the functions of stribeck return: states, curves, batches, sweeps, fits, checks and their parts."""

from stribeck.quantities.lazy import lazy_names as _lazy_names

_HOMES = {
    "asymptotics.pressure_film": ("Films", "Inlet", "PressureFilm"),
    "batches.result": ("BatchSolution",),
    "bench.loop_fit": ("LoopFit",),
    "bench.result": ("BenchCurve",),
    "checks.check": ("Check", "Checks"),
    "cli.reports": ("Explanation",),
    "contacts.friction": ("Friction",),
    "contacts.contact": ("HertzScales",),
    "curves.regime": ("Landmark",),
    "curves.result": ("StribeckCurve",),
    "curves.simulator_model": ("StribeckModel",),
    "experiments.compare": ("Comparison",),
    "experiments.master_curve": ("MasterCurve",),
    "experiments.next_runs": ("Plan",),
    "fits.measurements": ("Measurements",),
    "fits.result": ("Fit", "FitOutcome", "FittedInput"),
    "solver.fields": ("Field",),
    "solver.point.solution": ("PointSolution",),
    "solver.solution": ("Profile", "Solution"),
    "strokes.result": ("Stroke",),
    "sweeps.dataset": ("Sweep",),
    "sweeps.design": ("SweepDesign",),
    "sweeps.sweep": ("SweepProgress",),
    "uncertainty.result": ("Spread", "Uncertainty"),
}
__all__, __getattr__, __dir__ = _lazy_names(__name__, _HOMES, root="stribeck")
