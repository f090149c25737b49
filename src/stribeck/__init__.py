"""Lubricated rough contacts, cylinder or ball: from a data sheet to a converged Stribeck curve."""

from stribeck.quantities.lazy import lazy_names as _lazy_names

_PACKAGES = ("asymptotics", "atlas", "fluids", "solids", "surfaces")
_HOMES = {
    "batches.executors": ("SweepError",),
    "batches.result": ("BatchSolution",),
    "batches.solve_batch": ("solve_batch",),
    "cases.case": ("Case",),
    "cases.reading": ("load_case",),
    "cases.fit_settings": ("FitSettings",),
    "checks.check": ("Check", "Checks"),
    "checks.table": ("check",),
    "cli.reports.explain": ("Explanation", "explain"),
    "contact_laws.finite_surface": ("FiniteSurface",),
    "contact_laws.function": ("FunctionLaw",),
    "contact_laws.greenwood": ("GreenwoodTripp", "GreenwoodWilliamson"),
    "contact_laws.table": ("TableLaw",),
    "contacts.friction": ("Friction",),
    "contacts.line": ("Groups", "HertzScales", "InputError", "LineContact"),
    "contacts.point": ("PointContact",),
    "curves.landmarks": ("Landmark",),
    "contacts.regime": ("regime_of",),
    "curves.result": ("StribeckCurve",),
    "curves.stribeck_curve": ("stribeck_curve",),
    "data_sheet.new_case": ("new_case",),
    "data_sheet.report": ("write_report",),
    "experiments.compare": ("Comparison", "compare"),
    "experiments.next_runs": ("Plan", "next_runs"),
    "fits.fit": ("fit",),
    "fits.measurements": ("Measurements", "read_measurements"),
    "fits.result": ("Fit", "FitOutcome", "FittedInput"),
    "quantities.outcome": ("Outcome",),
    "regimes.phase_diagram": ("phase_diagram",),
    "solver.point.solution": ("Field", "PointSolution"),
    "solver.solution": ("Profile", "Solution"),
    "solver.solve": ("solve",),
    "solver.solve_error": ("SolveError",),
    "sweeps.dataset": ("Sweep", "open_sweep"),
    "sweeps.design": ("SweepDesign", "load_sweep"),
    "sweeps.sweep": ("SweepProgress", "sweep"),
    "uncertainty.propagate": ("propagate",),
    "uncertainty.result": ("Spread", "Uncertainty"),
}
__all__, _find, __dir__ = _lazy_names(__name__, _HOMES, _PACKAGES)


def __getattr__(name: str) -> object:
    """Import a public name on its first use, and read the version from the installed package when asked for."""
    if name == "__version__":
        from importlib.metadata import version

        return version("stribeck")
    return _find(name)
