"""What results of every kind do with files: they become a dataset, a table and a picture."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import TYPE_CHECKING, Any, ClassVar

from stribeck.files.datasets import write_csv, write_netcdf, write_parquet, write_zarr
from stribeck.files.writing import PathLike

if TYPE_CHECKING:
    import xarray
    from matplotlib.figure import Figure

__all__ = ["Drawn", "Exported"]


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


class Exported(Drawn):
    """A result that draws itself and writes its ``to_dataset``."""

    to_dataset: Callable[..., xarray.Dataset]

    def to_netcdf(self, path: PathLike, *, force: bool = False, **sampling: Any) -> None:
        """Write the dataset as NetCDF.

        Parameters
        ----------
        path : str or path-like
            The file.
        force : bool
            Whether an existing file is replaced; otherwise it is kept and the call refused.
        **sampling
            What ``to_dataset`` takes, as of a ball ``points`` and ``reach``.

        Raises
        ------
        InputError
            If the file cannot be written, or exists and ``force`` is not given.
        """
        write_netcdf(self.to_dataset(**sampling), path, force=force)

    def to_csv(self, path: PathLike, *, force: bool = False, **sampling: Any) -> None:
        """Write the dataset as a table of values separated by commas, a row for each combination of its coordinates.

        Parameters
        ----------
        path : str or path-like
            The file.
        force : bool
            Whether an existing file is replaced; otherwise it is kept and the call refused.
        **sampling
            What ``to_dataset`` takes.

        Raises
        ------
        InputError
            If the file cannot be written, or exists and ``force`` is not given, or the dataset is no table.
        """
        write_csv(self.to_dataset(**sampling), path, force=force)

    def to_parquet(self, path: PathLike, *, force: bool = False, **sampling: Any) -> None:
        """Write the dataset as Parquet, a row for each combination of its coordinates; needs the extra ``parquet``.

        Parameters
        ----------
        path : str or path-like
            The file.
        force : bool
            Whether an existing file is replaced; otherwise it is kept and the call refused.
        **sampling
            What ``to_dataset`` takes.

        Raises
        ------
        InputError
            If the file cannot be written, or exists and ``force`` is not given, or the dataset is no table.
        """
        write_parquet(self.to_dataset(**sampling), path, force=force)

    def to_zarr(self, path: PathLike, *, force: bool = False, **sampling: Any) -> None:
        """Write the dataset as a folder that ``xarray.open_zarr`` opens.

        Parameters
        ----------
        path : str or path-like
            The folder.
        force : bool
            Whether an existing one is replaced; otherwise it is kept and the call refused.
        **sampling
            What ``to_dataset`` takes.

        Raises
        ------
        InputError
            If the folder cannot be written, or exists and ``force`` is not given.
        """
        write_zarr(self.to_dataset(**sampling), path, force=force)
