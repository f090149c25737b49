"""Datasets of xarray as NetCDF and CSV_ENDINGS files.

xarray and netCDF4 come with the extra ``data`` and are imported on first use.
"""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

import numpy as np

from stribeck.files.writing import MissingExtraError, PathLike, atomic_write
from stribeck.quantities.units import InputError

if TYPE_CHECKING:
    import xarray

__all__ = [
    "CSV_ENDINGS",
    "DATA_ENDINGS",
    "NETCDF_ENDINGS",
    "import_xarray",
    "listed",
    "new_dataset",
    "write_csv",
    "write_data",
    "write_netcdf",
]

Column = tuple[str | Sequence[str], Any, str, str]  # Dimensions, values, unit and long name of a variable

NETCDF_ENDINGS = (".nc",)
CSV_ENDINGS = (".csv",)
DATA_ENDINGS = (*NETCDF_ENDINGS, *CSV_ENDINGS)


def import_xarray(what: str = "a dataset") -> Any:
    """Return the library xarray, or say which extra ``what`` needs."""
    try:
        import xarray
    except ImportError:
        raise MissingExtraError(what, "data", "xarray") from None
    return xarray


def new_dataset(columns: Mapping[str, Column], coords: Mapping[str, Column], attributes: Mapping[str, Any]) -> xarray.Dataset:
    """Return a dataset whose variables have units and long names."""

    def described(table: Mapping[str, Column]) -> dict[str, Any]:
        return {
            name: (dims, values, {"units": unit, "long_name": label}) for name, (dims, values, unit, label) in table.items()
        }

    source = {"source": f"stribeck {version('stribeck')}"}
    made: xarray.Dataset = import_xarray().Dataset(described(columns), described(coords), source | dict(attributes))
    return made


def listed(values: Sequence[Any]) -> Any:
    """Return values as an array for a dataset: numbers and truth values as such, text as objects, which NetCDF keeps."""
    text = any(isinstance(each, str) for each in values)
    return np.array([str(each) for each in values] if text else values, dtype=object if text else None)


def write_netcdf(dataset: xarray.Dataset, path: PathLike, *, force: bool = False) -> None:
    """Write a dataset as NetCDF-4."""
    try:
        import netCDF4  # noqa: F401
    except ImportError:
        raise MissingExtraError("a NetCDF file", "data", "netCDF4") from None
    with atomic_write(path, NETCDF_ENDINGS, force=force) as temporary:
        try:
            dataset.to_netcdf(temporary, engine="netcdf4", format="NETCDF4")
        except RuntimeError as problem:  # of the HDF5 library, as on a full disk
            raise OSError(str(problem)) from None


def write_csv(dataset: xarray.Dataset, path: PathLike, *, force: bool = False) -> None:
    """Write a dataset as text: comments, one line of names with units, one line for each point."""
    if len(dataset.sizes) != 1:
        dimensions = ", ".join(map(str, dataset.sizes)) or "none"
        raise InputError(
            f"a CSV_ENDINGS file has one dimension and this dataset has {dimensions}; write NetCDF (.nc) instead."
        )
    (over,) = dataset.sizes
    columns = [dataset[over], *dataset.data_vars.values()]
    with (
        atomic_write(path, CSV_ENDINGS, force=force) as temporary,
        temporary.open("w", newline="", encoding="utf-8") as file,
    ):
        for name, value in dataset.attrs.items():
            for line in _text(value).splitlines() or [""]:
                file.write(f"# {name}: {line}\n")
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(f"{column.name} [{column.attrs['units']}]" for column in columns)
        writer.writerows(zip(*(column.values.tolist() for column in columns), strict=True))


def write_data(dataset: xarray.Dataset, path: PathLike, *, force: bool = False) -> None:
    """Write a dataset as the ending of ``path`` says: ``.nc`` or ``.csv``."""
    write = write_csv if str(path).lower().endswith(CSV_ENDINGS) else write_netcdf
    write(dataset, path, force=force)


def _text(value: Any) -> str:
    """Return an attribute as text."""
    return ", ".join(map(repr, value.tolist())) if isinstance(value, np.ndarray) else str(value)
