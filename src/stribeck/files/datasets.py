"""Results as xarray datasets with units, names and provenance, and these as NetCDF and CSV files.

xarray and netCDF4 come with the extra ``data`` and are imported on first use.
"""

from __future__ import annotations

import csv
import math
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

import numpy as np

from stribeck._types import LawShape, WithArea
from stribeck.contacts.friction import DEFINITIONS
from stribeck.files.writing import MissingExtraError, PathLike, replacing
from stribeck.quantities.inputs import QUANTITIES
from stribeck.quantities.units import DIMENSIONS, InputError
from stribeck.solver.solution import Solution

if TYPE_CHECKING:
    import xarray

    from stribeck.curves.result import StribeckCurve

__all__ = ["CSV", "DATA", "NETCDF", "curve_dataset", "si_films", "write_csv", "write_data", "write_netcdf"]

NETCDF = (".nc",)
CSV = (".csv",)
DATA = (*NETCDF, *CSV)
"""Endings of the data files."""

INPUTS = (
    "radius",
    "modulus",
    "load",
    "viscosity",
    "speed",
    "roughness",
    "alpha",
    "beta",
    "friction_coefficient",
)
"""What a contact is made of, in the order in which outputs name it."""

GROUPS = ("speed", "load", "roughness")

OBSERVABLES = {
    "contact_load_share": ("1", "part of the load that asperities carry"),
    "fluid_load_share": ("1", "part of the load that the fluid carries"),
    "central_gap": ("1", "gap at the centre, in Hertz indentations"),
    "minimum_gap": ("1", "least gap, in Hertz indentations"),
    "minimum_position": ("1", "position of the least gap, in Hertz half-widths"),
    "flux_gap": ("1", "flux gap: fluid flux over half the speed, in Hertz indentations"),
    "offset": (
        "1",
        "height of the undeformed cylinder over the undeformed surface, in Hertz indentations",
    ),
    "lambda_ratio": ("1", "central gap over h_rms/alpha"),
    "error_estimate": (
        "1",
        "largest estimated relative error of the observables; load shares count absolutely",
    ),
}
"""Attributes of a solution that a dataset holds: unit and name of each."""


AREA = {
    "central_area_fraction": ("1", "real area of contact over the apparent one, at the centre"),
    "central_area_fraction_error": ("1", "estimated absolute error of central_area_fraction"),
}
"""What a solution has besides, of which the contact law knows the spectrum of the surface."""


def curve_dataset(curve: StribeckCurve, title: str = "") -> xarray.Dataset:
    """Return a Stribeck curve as an xarray Dataset.

    Parameters
    ----------
    curve : StribeckCurve
        The curve.
    title : str
        Headline, kept as an attribute.

    Returns
    -------
    xarray.Dataset
        Along one coordinate, which has the name of what varies: the groups, the observables, friction by both
        definitions with its parts and errors, the regime and the outcome of each point; films and Hertz
        scales in SI units where the curve has a contact. Each variable has the attributes ``units`` and
        ``long_name``; those of the dataset hold the inputs, settings, landmarks, notes and the outcome.

    Raises
    ------
    MissingExtraError
        If xarray is not installed.
    """
    try:
        import xarray
    except ImportError:
        raise MissingExtraError("a dataset", "data", "xarray") from None

    over = curve.over
    columns = _columns(curve)
    dataset = xarray.Dataset(
        {name: (over, values, {"units": unit, "long_name": label}) for name, (values, unit, label) in columns.items()},
        coords={over: (over, curve.values, {"units": _unit_over(curve), "long_name": f"{over}, what varies"})},
        attrs=_attributes(curve, title),
    )
    if curve.contact is None:
        dataset[over].attrs["long_name"] = f"{over} group, what varies"
    return dataset


def write_netcdf(dataset: xarray.Dataset, path: PathLike, *, force: bool = False) -> None:
    """Write a dataset as NetCDF-4.

    Parameters
    ----------
    dataset : xarray.Dataset
        What to write.
    path : str or path-like
        The file, ending in ``.nc``.
    force : bool
        Whether an existing file is replaced; otherwise it is kept.

    Raises
    ------
    InputError
        If the file cannot be written, or exists and ``force`` is not given.
    MissingExtraError
        If netCDF4 is not installed.
    """
    try:
        import netCDF4  # noqa: F401
    except ImportError:
        raise MissingExtraError("a NetCDF file", "data", "netCDF4") from None
    with replacing(path, NETCDF, force=force) as temporary:
        try:
            dataset.to_netcdf(temporary, engine="netcdf4", format="NETCDF4")
        except RuntimeError as problem:  # of the HDF5 library, as on a full disk
            raise InputError(f"{path} could not be written ({problem}); it is as it was before.") from None


def write_csv(dataset: xarray.Dataset, path: PathLike, *, force: bool = False) -> None:
    """Write a dataset as text: comments, one line of names with units, one line for each point.

    Parameters
    ----------
    dataset : xarray.Dataset
        What to write; all of it runs along one coordinate.
    path : str or path-like
        The file, ending in ``.csv``; ``pandas.read_csv(path, comment="#")`` reads it.
    force : bool
        Whether an existing file is replaced; otherwise it is kept.

    Raises
    ------
    InputError
        If the file cannot be written, or exists and ``force`` is not given.
    """
    (over,) = dataset.sizes
    columns = [dataset[over], *dataset.data_vars.values()]
    with (
        replacing(path, CSV, force=force) as temporary,
        temporary.open("w", newline="", encoding="utf-8") as file,
    ):
        for name, value in dataset.attrs.items():
            for line in _text(value).splitlines() or [""]:
                file.write(f"# {name}: {line}\n")
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(f"{column.name} [{column.attrs['units']}]" for column in columns)
        writer.writerows(zip(*(column.values.tolist() for column in columns), strict=True))


def write_data(dataset: xarray.Dataset, path: PathLike, *, force: bool = False) -> None:
    """Write a dataset as the ending of ``path`` says: ``.nc`` or ``.csv``.

    Parameters
    ----------
    dataset : xarray.Dataset
        What to write.
    path : str or path-like
        The file.
    force : bool
        Whether an existing file is replaced; otherwise it is kept.
    """
    write = write_csv if str(path).lower().endswith(CSV) else write_netcdf
    write(dataset, path, force=force)


def _unit_over(curve: StribeckCurve) -> str:
    return "1" if curve.contact is None else unit_of(curve.over)


def unit_of(name: str) -> str:
    """Return the SI unit of an input in the spelling of UDUNITS, which files use."""
    return DIMENSIONS[QUANTITIES[name].dimension].unit.replace("*", " ") or "1"


def _columns(curve: StribeckCurve) -> dict[str, tuple[Any, str, str]]:
    """Return values, unit and long name of each variable."""
    columns: dict[str, tuple[Any, str, str]] = {
        "friction": (curve.friction, "1", f"friction coefficient, definition {curve.definition}"),
        "friction_contact": (curve.friction_contact, "1", "part of the friction coefficient from asperities"),
        "friction_viscous": (curve.friction_viscous, "1", "part of the friction coefficient from the fluid"),
        "friction_error": (curve.friction_error, "1", "estimated absolute error of the friction coefficient"),
        "regime": (np.array(curve.regimes, dtype=object), "1", "lubrication regime"),
        "hersey_number": (curve.hersey_number, "1", "Hersey number, viscosity times speed over load"),
        "hydrodynamic_friction": (
            curve.hydrodynamic_friction,
            "1",
            "friction coefficient of smooth surfaces by the law of the hydrodynamic branch",
        ),
    }
    for name, (unit, label) in OBSERVABLES.items():
        columns[name] = (curve.observable(name), unit, label)
    for name in GROUPS:
        columns[f"{name}_group"] = (np.asarray(getattr(curve.groups, name)), "1", f"{name} group")
    for definition in DEFINITIONS:
        found = [s.friction(curve.mu0, curve.beta, definition) for s in curve.solutions]
        name, label = f"friction_{definition}", f"friction coefficient, definition {definition}"
        columns[name] = (np.array([f.total for f in found]), "1", label)
        columns[f"{name}_viscous"] = (
            np.array([f.viscous for f in found]),
            "1",
            f"{label}: part from the fluid",
        )
        columns[f"{name}_error"] = (
            np.array([f.error for f in found]),
            "1",
            f"{label}: estimated absolute error",
        )
    if isinstance(curve.law, WithArea):
        for name, (unit, label) in AREA.items():
            columns[name] = (curve.observable(name), unit, label)
    films = [si_films(solution) for solution in curve.solutions]
    for name, (_, unit, label) in (films[0] if films else {}).items():
        columns[name] = (np.array([film[name][0] for film in films]), unit, label)
    outcomes = np.array([s.outcome.name for s in curve.solutions], dtype=object)
    columns["outcome"] = (outcomes, "1", "how the solve of the point ended")
    return columns


def si_films(solution: Solution) -> dict[str, tuple[float, str, str]]:
    """Return films and Hertz scales of a solution in SI units: value, unit and long name of each.

    Parameters
    ----------
    solution : Solution
        A state; one that comes from groups alone has no scales.

    Returns
    -------
    dict
        By name; empty where there is no contact.
    """
    if solution.contact is None:
        return {}
    scales = solution.contact.hertz
    a, u = scales.half_width, scales.indentation
    return {
        "central_film_thickness": (solution.central_gap * u, "m", "gap at the centre"),
        "minimum_film_thickness": (solution.minimum_gap * u, "m", "least gap"),
        "minimum_film_position": (solution.minimum_position * a, "m", "position of the least gap"),
        "flux_film_thickness": (solution.flux_gap * u, "m", "fluid flux over half the speed"),
        "hertz_half_width": (a, "m", "half-width a of the dry smooth contact"),
        "hertz_indentation": (u, "m", "indentation u_Hz of the dry smooth contact"),
        "hertz_pressure": (scales.pressure, "Pa", "largest pressure p_Hz of the dry smooth contact"),
    }


def _attributes(curve: StribeckCurve, title: str) -> dict[str, Any]:
    """Return what belongs to the whole curve: provenance, inputs, settings, landmarks, outcome."""
    finished = curve.outcome.ok and len(curve) == curve.requested
    found: dict[str, Any] = {
        "title": title or "Stribeck curve of a lubricated rough line contact",
        "source": f"stribeck {version('stribeck')}",
        "outcome": curve.outcome.value,
        "complete": int(finished),
        "points": len(curve),
        "requested_points": curve.requested,
        "over": curve.over,
        "definition": curve.definition,
        **law_attributes(curve.law, bool(len(curve)) and curve.solutions[0].law == "smooth"),
        "rtol": curve.rtol,
        "error_estimate": curve.error_estimate,
        "mu0": curve.mu0,
        "beta": curve.beta,
    }
    if curve.contact is not None:
        names = [name for name in INPUTS if name != curve.over]
        found |= {f"input_{name}": getattr(curve.contact, name) for name in names}
        found["input_units"] = ", ".join(f"{name} {unit_of(name)}" for name in names)
    for name in GROUPS:
        values = np.asarray(getattr(curve.groups, name))
        if len(values) and np.ptp(values) <= 1e-12 * values[0]:
            found[f"{name}_group"] = float(values[0])
    found |= _landmark_attributes(curve)
    found["notes"] = "\n".join(curve.notes)
    return found


def law_attributes(law: LawShape | None, smooth: bool = False) -> dict[str, Any]:
    """Return name and parameters of a contact law as attributes of a dataset.

    Parameters
    ----------
    law : LawShape or None
        The law; None is the exponential one.
    smooth : bool
        Whether the surfaces are smooth and have none.

    Returns
    -------
    dict
        ``contact_law``, and its parameters by their names after ``contact_law_``.
    """
    if smooth or law is None:
        return {"contact_law": "smooth" if smooth else "exponential"}
    return {"contact_law": law.name} | {f"contact_law_{name}": value for name, value in law.parameters.items()}


def _landmark_attributes(curve: StribeckCurve) -> dict[str, Any]:
    """Return where minimum and transitions lie, nan where the curve holds no minimum."""
    minimum, marks = curve.minimum, curve.transitions
    return {
        f"minimum_{curve.over}": minimum.value if minimum else math.nan,
        "minimum_friction": minimum.friction if minimum else math.nan,
        "transition_names": "; ".join(mark.name for mark in marks),
        f"transition_{curve.over}": np.array([mark.value for mark in marks]),
        "transition_friction": np.array([mark.friction for mark in marks]),
    }


def _text(value: Any) -> str:
    """Return an attribute as text."""
    return ", ".join(map(repr, value.tolist())) if isinstance(value, np.ndarray) else str(value)
