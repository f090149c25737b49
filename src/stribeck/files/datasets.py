"""Datasets of xarray as files, NetCDF, Zarr, Parquet and CSV; the libraries are imported on first use."""

from __future__ import annotations

import csv
import os
import secrets
import shutil
from collections.abc import Hashable, Iterable, Mapping, Sequence
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from stribeck.files.writing import MissingExtraError, PathLike, atomic_write, check_writable, need_extra, path_of, reason_of
from stribeck.quantities.formats import Number
from stribeck.quantities.units import InputError

if TYPE_CHECKING:
    import xarray

Column = tuple[str | Sequence[str], Any, str, str]  # Dimensions, values, unit and long name of a variable

NETCDF_ENDINGS = (".nc",)
CSV_ENDINGS = (".csv",)

# What needs a library besides that of datasets, by ending: purpose, extra and library.
LIBRARIES = {
    ".nc": ("a NetCDF file", "data", "netCDF4"),
    ".zarr": ("a Zarr folder", "data", "zarr"),
    ".parquet": ("a Parquet file", "parquet", "pyarrow"),
}

EXPORT_ENDINGS = (".nc", ".csv", ".zarr", ".parquet")


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


def number_columns(numbers: Sequence[Number]) -> dict[str, Column]:
    """Return numbers as columns of a dataset, each with its error or interval behind it where there is one."""
    return {name: ((), *stated) for each in numbers for name, stated in each.stated.items()}


def units_of(columns: Mapping[str, Column]) -> dict[str, str]:
    """Return the unit of each column."""
    return {name: unit for name, (_, _, unit, _) in columns.items()}


def listed(values: Sequence[Any]) -> Any:
    """Return values as an array for a dataset: numbers and truth values as such, text as objects, which NetCDF keeps."""
    text = any(isinstance(each, str) for each in values)
    return np.array([str(each) for each in values] if text else values, dtype=object if text else None)


def write_netcdf(dataset: xarray.Dataset, path: PathLike, *, force: bool = False) -> None:
    """Write a dataset as NetCDF-4."""
    need_extra(*LIBRARIES[".nc"])
    with atomic_write(path, NETCDF_ENDINGS, force=force) as temporary:
        try:
            dataset.to_netcdf(temporary, engine="netcdf4", format="NETCDF4")
        except RuntimeError as problem:  # of the HDF5 library, as on a full disk
            raise OSError(str(problem)) from None


def write_csv(dataset: xarray.Dataset, path: PathLike, *, force: bool = False) -> None:
    """Write a dataset as text: comments, one line of names with units, one line for each point."""
    above = [f"{name}: {line}" for name, value in _about(dataset).items() for line in value.splitlines() or [""]]
    columns = {f"{name} [{dataset[name].attrs.get('units', '1')}]": each.tolist() for name, each in _table(dataset).items()}
    write_columns(path, above, columns, force=force)


def write_columns(path: PathLike, above: Iterable[str], columns: Mapping[str, Sequence[Any]], *, force: bool = False) -> None:
    """Write columns as text below lines of comments."""
    with (
        atomic_write(path, CSV_ENDINGS, force=force) as temporary,
        temporary.open("w", newline="", encoding="utf-8") as file,
    ):
        file.writelines(f"# {line}\n" for line in above)
        marked = any("#" in cell for column in columns.values() for cell in column if isinstance(cell, str))
        # Outside quotes readers of comments, pandas among them, leave out what follows such a mark in a name.
        writer = csv.writer(file, lineterminator="\n", quoting=csv.QUOTE_NONNUMERIC if marked else csv.QUOTE_MINIMAL)
        writer.writerow(columns)
        writer.writerows(zip(*columns.values(), strict=True))


def write_parquet(dataset: xarray.Dataset, path: PathLike, *, force: bool = False) -> None:
    """Write a dataset as a table of Parquet, a row for each point; units and long names are metadata of its columns."""
    need_extra(*LIBRARIES[".parquet"])
    import pyarrow
    from pyarrow import parquet

    columns = _table(dataset)
    about = [pyarrow.array(column) for column in columns.values()]
    fields = [
        pyarrow.field(name, column.type, metadata={key: str(value) for key, value in dataset[name].attrs.items()})
        for name, column in zip(columns, about, strict=True)
    ]
    schema = pyarrow.schema(fields, metadata=_about(dataset))
    with atomic_write(path, (".parquet",), force=force) as temporary:
        parquet.write_table(pyarrow.table(about, schema=schema), temporary)


def write_zarr(dataset: xarray.Dataset, path: PathLike, *, force: bool = False) -> None:
    """Write a dataset as a folder of Zarr 2, which keeps text in a way that every reader knows."""
    target = check_folder(path, force=force)
    temporary = target.with_name(f".stribeck-{secrets.token_hex(6)}")
    try:
        dataset.to_zarr(temporary, mode="w-", zarr_format=2, consolidated=True)
        if check_folder(path, force=force).exists():
            shutil.rmtree(target)
        os.rename(temporary, target)
    except OSError as problem:
        raise InputError(f"{path} could not be written ({reason_of(problem, target)}); choose another place.") from None
    finally:
        shutil.rmtree(temporary, ignore_errors=True)


def check_folder(path: PathLike, *, force: bool = False) -> Path:
    """Return where a folder of Zarr shall be written, or refuse a place where it cannot."""
    need_extra(*LIBRARIES[".zarr"])
    target = path_of(path)
    if not target.is_dir():
        return check_writable(path, (".zarr",), force=False)
    if not (force and (target / ".zgroup").is_file()):
        raise InputError(
            f"{target} exists already and is kept; add --force (in Python force=True) to replace it if it is Zarr, "
            "or choose another name."
        )
    return target


def check_export(path: PathLike, *, force: bool = False) -> None:
    """Refuse a file that :func:`write_data` could not write, before the work whose results it is for."""
    ending = path_of(path).suffix.lower()
    if ending == ".zarr":
        check_folder(path, force=force)
        return
    check_writable(path, EXPORT_ENDINGS, force=force)
    for needed in (("a data file", "data", "xarray"), LIBRARIES.get(ending)):
        if needed is not None:
            need_extra(*needed)


def write_data(dataset: xarray.Dataset, path: PathLike, *, force: bool = False) -> None:
    """Write a dataset as the ending of ``path`` says."""
    others = {".csv": write_csv, ".zarr": write_zarr, ".parquet": write_parquet}
    others.get(path_of(path).suffix.lower(), write_netcdf)(dataset, path, force=force)


def _table(dataset: xarray.Dataset) -> dict[str, Any]:
    """Return coordinates and variables as columns, a row for each combination of the coordinates."""
    dims = _dims_of_table(dataset)
    empty = import_xarray("a table").DataArray(np.empty([dataset.sizes[dim] for dim in dims]), dims=dims)
    above = _above_table(dataset)
    # With coordinates that are no dimension: the inputs of states in a row.
    names = dict.fromkeys(str(name) for name in [*dims, *dataset.coords, *dataset.data_vars] if name not in above)
    return {name: dataset[name].broadcast_like(empty).transpose(*dims).values.ravel() for name in names}


def _dims_of_table(dataset: xarray.Dataset) -> list[Hashable]:
    """Return along what the rows of a table run: the dimensions of the first of the variables that have most of them."""
    along = [list(each.dims) for each in dataset.data_vars.values()]
    return max(along, key=len, default=[])


def _above_table(dataset: xarray.Dataset) -> dict[Hashable, Any]:
    """Return the variables that are no columns of the table, as they are the same in all rows or along something else."""
    dims = set(_dims_of_table(dataset))
    others = {name: each for name, each in dataset.variables.items() if not set(each.dims) <= dims}
    return others | ({name: each for name, each in dataset.variables.items() if not each.dims} if dims else {})


def _about(dataset: xarray.Dataset) -> dict[str, str]:
    """Return as text what stands above a table: its attributes, and the numbers that all its rows share."""
    shared = {f"{name} [{each.attrs['units']}]": _text(each.values) for name, each in _above_table(dataset).items()}
    return {str(name): _text(value) for name, value in dataset.attrs.items()} | shared


def _text(value: Any) -> str:
    """Return an attribute or a variable as text."""
    values = np.ravel(value).tolist() if isinstance(value, np.ndarray) else [value]
    return str(values[0]) if len(values) == 1 else ", ".join(map(repr, values))
