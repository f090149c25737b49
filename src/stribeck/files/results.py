"""What results of every kind do with files: they become a dataset, a table and a picture."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, is_dataclass
from functools import wraps
from importlib import import_module
from typing import TYPE_CHECKING, Any, ClassVar

from stribeck.files.datasets import Column, listed, new_dataset, write_csv, write_netcdf, write_parquet, write_zarr
from stribeck.files.writing import PathLike
from stribeck.quantities.docstrings import Described, complete_docstring, told

if TYPE_CHECKING:
    import xarray
    from matplotlib.figure import Figure

Labelled = tuple[Mapping[str, Column], Mapping[str, Column], Mapping[str, Any]]
"""Variables, coordinates and attributes of a dataset."""


# What methods return, by their names
RETURNED = {
    "to_dict": "dict\n    Numbers, text, lists and dictionaries of these; None where a number does not exist.",
    "to_si": "dict of str to float\n    By name.",
}


def ready_for_json(content: Any) -> Any:
    """Return content for JSON, results by their ``to_dict``; what is not finite becomes None, as JSON knows no nan."""
    if is_dataclass(content) and not isinstance(content, type):
        content = content.to_dict() if isinstance(content, Record) else asdict(content)
    if isinstance(content, dict):
        return {name: ready_for_json(value) for name, value in content.items()}
    if hasattr(content, "tolist"):  # of arrays
        return ready_for_json(content.tolist())
    if isinstance(content, list | tuple):
        return [ready_for_json(value) for value in content]
    if isinstance(content, float) and not math.isfinite(content):
        return None
    return content


def json_of(result: Any, names: str, **others: Any) -> dict[str, Any]:
    """Return attributes of a result and what else there is to say."""
    return {name: getattr(result, name) for name in names.split()} | others


def _prepare_for_json(method: Callable[..., dict[str, Any]]) -> Callable[..., dict[str, Any]]:
    @wraps(method)
    def to_dict(self: Any, *args: Any, **options: Any) -> dict[str, Any]:
        found: dict[str, Any] = ready_for_json(method(self, *args, **options))
        return found

    return to_dict


class Tabled:
    """A result that is a labelled array."""

    def __init_subclass__(cls) -> None:
        """Say of ``to_dict`` and ``to_si`` what they return, the former ready for JSON."""
        super().__init_subclass__()
        for name, returns in RETURNED.items():
            method = vars(cls).get(name)
            if method is not None and "Returns" not in method.__doc__:
                method.__doc__ = complete_docstring(method, {}, returns)
            if name == "to_dict" and method is not None:
                setattr(cls, name, _prepare_for_json(method))

    def _labelled(self) -> Labelled:
        raise NotImplementedError

    def to_dataset(self) -> xarray.Dataset:
        """Return the numbers with units, long names and errors as an xarray Dataset; its attributes hold what belongs to all.

        Returns
        -------
        xarray.Dataset
            Needs the extra ``data``.

        Raises
        ------
        MissingExtraError
            If xarray is not installed.
        """
        return new_dataset(*self._labelled())


class Record(Described, Tabled):
    """A result of a few numbers or words, of which many may stand in one table.

    Outputs hold the fields that have a unit (an empty one is the attribute ``unit``) and the properties that the class lists;
    the ends of ``interval_95`` become ``low_95`` and ``high_95``.
    """

    _properties: ClassVar[dict[str, tuple[str, str]]] = {}
    _labels: ClassVar[Mapping[str, tuple[str, str]]]

    def __init_subclass__(cls) -> None:
        """Take unit and long name of the fields."""
        super().__init_subclass__()
        fields = {name: (each.unit, each.meaning) for name, each in cls._words.items() if each.unit is not None}
        cls._labels = vars(cls).get("_labels", fields | cls._properties)

    def to_dict(self) -> dict[str, Any]:
        """Return the numbers and words under the names of the attributes, ready for JSON."""
        return {name: getattr(self, name) for name in self._labels}

    def _labelled(self) -> Labelled:
        columns = columns_of_records((), [self], self._labels)
        return {name: ((), *each[1:]) for name, each in columns.items()}, {}, {"title": type(self).__name__}


def columns_of_records(
    dims: str | tuple[()], records: Sequence[Any], labels: Mapping[str, tuple[str, str]]
) -> dict[str, Column]:
    """Return attributes of records as columns of a dataset; without a dimension those of the only record."""
    columns: dict[str, Column] = {}
    for name, (unit, label) in labels.items():
        # Text that is missing is empty: files know no None.
        values = ["" if (value := getattr(each, name)) is None else value for each in records]
        units = {unit or each.unit or "1" for each in records}
        common = units.pop() if len(units) == 1 else "see unit"
        ends = {name: (label, values)}
        if any(isinstance(value, tuple) for value in values):
            short = name.removeprefix("interval_")
            ends = {
                f"{end}_{short}": (f"{end} end of the {label}", [value[i] for value in values])
                for i, end in enumerate(("low", "high"))
            }
        for each, (said, found) in ends.items():
            columns[each] = (dims, listed(found) if dims else found[0], common, said)
    return columns


class Drawn:
    """A result that draws itself, by the function that ``_picture`` names."""

    # By name: a picture needs the result, and a result that imported its picture would need matplotlib.
    _picture: ClassVar[str]

    def plot(self, path: PathLike | None = None, *, ax: Any = None, force: bool = False, **options: Any) -> Figure:
        """Draw the result.

        Parameters
        ----------
        path : str or path-like, optional
            Image to write as well, ending in ``.png``, ``.svg`` or ``.pdf``.
        ax : matplotlib.axes.Axes, optional
            Axes to draw the main panel into, in place of a new figure.
        force : bool
            Whether an existing file is replaced; otherwise it is kept and the call refused.
        **options
            What this picture alone takes: ``title`` of most, ``notes=False`` of those with notes below,
            ``abscissa="hersey"`` and ``panel="hydrodynamic"`` of a curve, ``colours="interference"`` of a ball.

        Returns
        -------
        matplotlib.figure.Figure
            The figure; needs the extra ``plot``.

        Raises
        ------
        InputError
            If there is nothing to draw, or the file cannot be written, or exists and ``force`` is not given.
        """
        module, _, name = self._picture.rpartition(".")
        figure: Figure = getattr(import_module(module), name)(self, path, ax=ax, force=force, **options)
        return figure


# What the methods that write a dataset say of their arguments.
WRITTEN = {
    "path": "str or path-like\n    The file, or the folder of Zarr.",
    "force": "bool\n    Whether an existing one is replaced; otherwise it is kept and the call refused.",
    "**sampling": "Any\n    What ``to_dataset`` takes, as of a ball ``points`` and ``reach``.",
}
UNWRITTEN = """InputError
    If it cannot be written, or exists and ``force`` is not given, or a table is asked for of what is none."""


class Exported(Drawn, Tabled):
    """A result that draws itself and writes its ``to_dataset``."""

    def _sampled(self, sampling: Mapping[str, Any]) -> xarray.Dataset:
        dataset_of: Callable[..., xarray.Dataset] = self.to_dataset
        return dataset_of(**sampling)

    @told(WRITTEN, raises=UNWRITTEN)
    def to_netcdf(self, path: PathLike, *, force: bool = False, **sampling: Any) -> None:
        """Write the dataset as NetCDF."""
        write_netcdf(self._sampled(sampling), path, force=force)

    @told(WRITTEN, raises=UNWRITTEN)
    def to_csv(self, path: PathLike, *, force: bool = False, **sampling: Any) -> None:
        """Write the dataset as a table of values separated by commas, a row for each combination of its coordinates."""
        write_csv(self._sampled(sampling), path, force=force)

    @told(WRITTEN, raises=UNWRITTEN)
    def to_parquet(self, path: PathLike, *, force: bool = False, **sampling: Any) -> None:
        """Write the dataset as Parquet, a row for each combination of its coordinates; needs the extra ``parquet``."""
        write_parquet(self._sampled(sampling), path, force=force)

    @told(WRITTEN, raises=UNWRITTEN)
    def to_zarr(self, path: PathLike, *, force: bool = False, **sampling: Any) -> None:
        """Write the dataset as a folder that ``xarray.open_zarr`` opens."""
        write_zarr(self._sampled(sampling), path, force=force)
