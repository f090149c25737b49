"""Fields of a state: along a contact, and on the plane of a ball."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, ClassVar, Literal, Self

import numpy as np

from stribeck._types import Array
from stribeck.contacts.contact import HertzScales
from stribeck.files.datasets import Column, new_dataset
from stribeck.files.results import Exported
from stribeck.quantities.lazy import cached_property
from stribeck.quantities.results import ByValue, Shown

if TYPE_CHECKING:
    import xarray

UNITS = {"Hertz": ("a", "u_Hz", "p_Hz"), "SI": ("m", "m", "Pa")}  # Of positions, gaps and pressures


class Fields(Exported, Shown, ByValue):
    """Gap and pressures at positions, in Hertz units or in SI."""

    _coordinates: ClassVar[tuple[str, ...]] = ("x",)
    gap: Array
    contact_pressure: Array
    fluid_pressure: Array
    unit: Literal["Hertz", "SI"]

    @property
    def pressure(self) -> Array:
        """Total pressure, contact and fluid."""
        return self.contact_pressure + self.fluid_pressure

    def in_si(self, scales: HertzScales) -> Self:
        """Return fields in Hertz units in SI units."""
        places = {name: getattr(self, name) * scales.half_width for name in self._coordinates}
        pressures = {name: getattr(self, name) * scales.pressure for name in ("contact_pressure", "fluid_pressure")}
        return replace(self, **places, gap=self.gap * scales.indentation, **pressures, unit="SI")  # type: ignore[type-var]


@dataclass(frozen=True, eq=False, repr=False)
class Profile(Fields):
    """Fields along the contact.

    Attributes
    ----------
    x : ndarray, shape (n,)
        Positions [a or m].
    gap : ndarray, shape (n,)
        Gap [u_Hz or m].
    contact_pressure, fluid_pressure : ndarray, shape (n,)
        The two parts of the pressure [p_Hz or Pa].
    unit : {"Hertz", "SI"}
        Which of the two units hold.
    """

    _picture = "stribeck.plot.state.plot_fields"

    x: Array
    gap: Array
    contact_pressure: Array
    fluid_pressure: Array
    unit: Literal["Hertz", "SI"] = "Hertz"

    def to_dataset(self) -> xarray.Dataset:
        """Return the fields as an xarray Dataset.

        Returns
        -------
        xarray.Dataset
            Along ``x``: gap, contact pressure and fluid pressure, in the units of the profile; needs the extra ``data``.

        Raises
        ------
        MissingExtraError
            If xarray is not installed.
        """
        x: dict[str, Column] = {
            "x": ("x", self.x, UNITS[self.unit][0], "position along the contact; fluid enters from the left")
        }
        return new_dataset(columns_of(self, "x"), x, {"title": "Fields along a lubricated rough contact"})


def columns_of(fields: Any, dims: str | Sequence[str]) -> dict[str, Column]:
    """Return gap and pressures of a profile, or of a field, as columns of a dataset."""
    _, gap, pressure = UNITS[fields.unit]
    return {
        "gap": (dims, fields.gap, gap, "gap"),
        "contact_pressure": (dims, fields.contact_pressure, pressure, "pressure of the asperities"),
        "fluid_pressure": (dims, fields.fluid_pressure, pressure, "pressure of the fluid"),
    }


@dataclass(frozen=True, eq=False, repr=False)
class Field(Fields):
    """Fields on the plane of the contact.

    Attributes
    ----------
    x, y : ndarray
        Positions along and across the motion, of any shapes that broadcast [a or m].
    gap : ndarray
        Gap, of the broadcast shape [u_Hz or m].
    contact_pressure, fluid_pressure : ndarray
        The two parts of the pressure [p_Hz or Pa].
    unit : {"Hertz", "SI"}
        Which of the two units hold.
    """

    _picture = "stribeck.plot.state.plot_field"
    _coordinates = "x", "y"

    x: Array
    y: Array
    gap: Array
    contact_pressure: Array
    fluid_pressure: Array
    unit: Literal["Hertz", "SI"] = "Hertz"

    @cached_property
    def grid(self) -> tuple[Array, Array] | None:
        """Ascending positions along and across the motion if the points are a grid, gap[i, j] at y[i] and x[j]; else None."""
        if self.gap.ndim != 2 or not self.gap.size:
            return None
        x, y = (np.broadcast_to(each, self.gap.shape) for each in (self.x, self.y))
        is_grid = (x == x[0]).all() and (y.T == y[:, 0]).all() and (np.diff(x[0]) > 0).all() and (np.diff(y[:, 0]) > 0).all()
        return (x[0], y[:, 0]) if is_grid else None

    def to_dataset(self) -> xarray.Dataset:
        """Return the fields as an xarray Dataset.

        Returns
        -------
        xarray.Dataset
            Gap, contact pressure and fluid pressure over ``y`` and ``x`` if the points are a grid, else over the dimensions
            of the arrays, in the units of the field; needs the extra ``data``.

        Raises
        ------
        MissingExtraError
            If xarray is not installed.
        """
        dims = ("y", "x") if self.grid is not None else tuple(f"dim_{i}" for i in range(self.gap.ndim))
        places = self.grid or np.broadcast_arrays(self.x, self.y)
        words = "position along the motion; fluid enters from the left", "position across the motion"
        coords: dict[str, Column] = {
            name: (name if self.grid else dims, place, UNITS[self.unit][0], said)
            for name, place, said in zip("xy", places, words, strict=True)
        }
        return new_dataset(columns_of(self, dims), coords, {"title": "Fields on the plane of a lubricated rough contact"})
