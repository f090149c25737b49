"""Lubricated rough contacts, cylinder or ball: from a data sheet to a converged Stribeck curve."""

from stribeck.quantities.lazy import lazy_names as _lazy_names

_PACKAGES = ("asymptotics", "atlas", "bench", "contact_laws", "fluids", "motions", "profiles", "results", "solids", "surfaces")
_HOMES = {
    "batches.executors": ("SweepError",),
    "batches.solve_batch": ("solve_batch",),
    "cases.case": ("Case",),
    "cases.reading": ("load_case",),
    "cases.fit_settings": ("FitSettings",),
    "checks.table": ("check",),
    "cli.reports": ("explain",),
    "contacts.geometries": ("LineContact", "PointContact"),
    "contacts.groups": ("Groups",),
    "contacts.regime": ("regime_of",),
    "curves.stribeck_curve": ("stribeck_curve",),
    "data_sheet.new_case": ("new_case",),
    "data_sheet.report": ("write_report",),
    "experiments.compare": ("compare",),
    "experiments.master_curve": ("master_curve",),
    "experiments.next_runs": ("next_runs",),
    "fits.fit": ("fit",),
    "fits.reading": ("read_measurements",),
    "quantities.outcome": ("Outcome",),
    "quantities.units": ("InputError",),
    "regimes.phase_diagram": ("phase_diagram",),
    "solver.solve": ("solve",),
    "solver.solve_error": ("SolveError",),
    "strokes.stroke": ("stroke",),
    "sweeps.dataset": ("open_sweep",),
    "sweeps.design": ("load_sweep",),
    "sweeps.sweep": ("sweep",),
    "uncertainty.propagate": ("propagate",),
}
__all__, _find, __dir__ = _lazy_names(__name__, _HOMES, _PACKAGES)


def __getattr__(name: str) -> object:
    """Import a public name on its first use, and read the version from the installed package when asked for."""
    if name == "__version__":
        from importlib.metadata import version

        return version("stribeck")
    return _find(name)
