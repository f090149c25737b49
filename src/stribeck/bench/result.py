"""A Stribeck curve made of raw files of a rig: its points with their errors, and what became of each row."""

from __future__ import annotations

import csv
import math
from dataclasses import dataclass, field
from importlib.metadata import version
from typing import Any

import numpy as np

from stribeck._types import Array, Indices
from stribeck.bench.passes import LEFT_OUT
from stribeck.files.datasets import CSV_ENDINGS, Column
from stribeck.files.results import Exported, Labelled
from stribeck.files.writing import PathLike, atomic_write
from stribeck.fits.table.rig import TEMPERATURE_TOLERANCE
from stribeck.quantities.formats import format_percent, format_si
from stribeck.quantities.results import ByValue, Card, Told

__all__ = ["BenchCurve"]

# Headers of inputs in the file; those of others are their names.
HEADERS = {
    "load": "load [N]",
    "load_per_length": "load [N/m]",
    "viscosity": "viscosity [Pa*s]",
    "roughness": "roughness [m]",
    "radius": "radius [m]",
    "modulus": "modulus [Pa]",
}


@dataclass(frozen=True, eq=False, repr=False)
class BenchCurve(Exported, Told, ByValue):
    """Friction over speed from raw files of a rig; its dataset has points along ``point`` and rows of files along ``row``.

    Attributes
    ----------
    paths : tuple of str
        The files.
    curves : tuple of str
        Names of the curves.
    inputs : tuple of dict
        For each curve its inputs in SI units as far as the files say: load [N], viscosity [Pa s] and so on.
    curve : ndarray of int, shape (n,)
        Curve of each point.
    speed : ndarray, shape (n,)
        Sum of the surface speeds [m/s].
    friction : ndarray, shape (n,)
        Mean friction coefficient of both directions [-].
    half_width : ndarray, shape (n,)
        Half of its 95 % interval [-]; NaN where nothing shows the error.
    rows : ndarray of int, shape (n,)
        Rows of the files in each mean.
    independent : ndarray, shape (n,)
        Independent values among them, by their correlation.
    difference : ndarray, shape (n,)
        Friction in the one direction less that in the other [-]; NaN where only one was measured.
    difference_error : ndarray, shape (n,)
        Standard error of the difference [-].
    temperature : ndarray, shape (n,)
        Temperature [degC]; NaN where it is not known.
    viscosity : ndarray, shape (n,)
        Viscosity at that temperature [Pa s]; NaN where it is not known.
    notes : tuple of str
        What was left out, taken off or assumed, and by which rule, one sentence each.
    taken : tuple of str
        For each file what its columns were taken for.
    rolls : bool
        Whether both surfaces move, so that the speed is called the sum of speeds in files.
    file : ndarray of int, shape (m,)
        File of each row.
    row : ndarray of int, shape (m,)
        Row of the file, counted from 1.
    time : ndarray, shape (m,)
        Time of each row [s]; its number where the file has no time.
    row_speed : ndarray, shape (m,)
        Speed of each row with its sign [m/s].
    row_friction : ndarray, shape (m,)
        Friction of each row, positive along the motion [-].
    status : ndarray of int, shape (m,)
        What became of each row: 0 kept, 1 at rest, 2 the speed changes, 3 start of a step, 4 run-in.
    """

    _picture = "stribeck.plot.bench.plot_bench"

    paths: tuple[str, ...]
    curves: tuple[str, ...]
    inputs: tuple[dict[str, float], ...]
    curve: Indices
    speed: Array
    friction: Array
    half_width: Array
    rows: Indices
    independent: Array
    difference: Array
    difference_error: Array
    temperature: Array
    viscosity: Array
    notes: tuple[str, ...] = field(default=())
    taken: tuple[str, ...] = field(default=())
    rolls: bool = False
    file: Indices = field(default_factory=lambda: np.array([], int))
    row: Indices = field(default_factory=lambda: np.array([], int))
    time: Array = field(default_factory=lambda: np.array([]))
    row_speed: Array = field(default_factory=lambda: np.array([]))
    row_friction: Array = field(default_factory=lambda: np.array([]))
    status: Indices = field(default_factory=lambda: np.array([], int))

    @property
    def error(self) -> Array:
        """Standard error of friction [-]: half of the 95 % interval over 1.96, larger where few values are independent."""
        found: Array = self.half_width / 1.959964
        return found

    def __len__(self) -> int:
        """Return the number of points."""
        return len(self.friction)

    def _card(self) -> Card:
        names = len(self.curves) > 1
        heading = (
            *(("curve",) if names else ()),
            "speed",
            "friction",
            "95 %",
            "rows",
            "independent",
            "difference of directions",
        )
        table = [heading]
        for i in range(len(self)):
            known = math.isfinite(self.half_width[i])
            there = math.isfinite(self.difference[i])
            table.append(
                (
                    *((self.curves[self.curve[i]],) if names else ()),
                    format_si(self.speed[i], "speed"),
                    f"{self.friction[i]:.4g}",
                    f"± {self.half_width[i]:.2g}" if known else "not known",
                    str(self.rows[i]),
                    f"{self.independent[i]:.3g}",
                    f"{self.difference[i]:+.2g} ± {self.difference_error[i]:.1g}" if there else "",
                )
            )
        right = range(1, 6) if names else range(5)
        return Card(self._headline(), table=table, right=tuple(right), notes=self.notes)

    def _headline(self) -> str:
        kept = format_percent(float(np.mean(self.status == 0))) if len(self.status) else "all"
        several = f", {len(self.curves)} curves" if len(self.curves) > 1 else ""
        files = f"{len(self.paths)} file{'s' * (len(self.paths) > 1)}"
        relative = self.half_width / np.abs(self.friction)
        known = relative[np.isfinite(relative)]
        doubt = f"; 95 % intervals of ± {format_percent(float(np.median(known)))}" if len(known) else "; errors not known"
        points, rows = (f"{n} {noun}{'s' * (n != 1)}" for n, noun in ((len(self), "point"), (len(self.status), "row")))
        return f"{points}{several} from {rows} of {files}, {kept} of them kept{doubt}."

    def to_dict(self) -> dict[str, Any]:
        """Return points, notes and inputs under their names, ready for JSON.

        Returns
        -------
        dict
            By the names of the attributes.
        """
        names = ("speed", "friction", "error", "half_width", "rows", "independent", "difference", "difference_error")
        columns = {name: getattr(self, name) for name in (*names, "temperature", "viscosity")}
        of = {"files": list(self.paths), "curves": list(self.curves), "inputs": list(self.inputs)}
        return of | {"curve": [self.curves[k] for k in self.curve]} | columns | {"notes": list(self.notes)}

    def _labelled(self) -> Labelled:
        names = np.array(self.curves, dtype=object)
        columns: dict[str, Column] = {
            "curve": ("point", names[self.curve], "1", "name of the curve"),
            "speed": ("point", self.speed, "m s-1", "sum of the surface speeds"),
            "friction": ("point", self.friction, "1", "friction coefficient, mean of both directions"),
            "error": ("point", self.error, "1", "standard error of the friction coefficient"),
            "half_width": ("point", self.half_width, "1", "half of the 95 % interval of the friction coefficient"),
            "rows": ("point", self.rows, "1", "rows of the files"),
            "independent": ("point", self.independent, "1", "independent values among the rows"),
            "difference": ("point", self.difference, "1", "friction in the one direction less that in the other"),
            "difference_error": ("point", self.difference_error, "1", "standard error of the difference"),
            "temperature": ("point", self.temperature, "degC", "temperature"),
            "viscosity": ("point", self.viscosity, "Pa s", "viscosity"),
            "time": ("row", self.time, "s", "time, or number of the row"),
            "row_speed": ("row", self.row_speed, "m s-1", "speed of the row, with its sign"),
            "row_friction": ("row", self.row_friction, "1", "friction coefficient of the row, positive along the motion"),
            "status": ("row", self.status, "1", ", ".join(f"{i} {text}" for i, text in enumerate(LEFT_OUT))),
            "file": ("row", self.file, "1", "number of the file"),
            "file_row": ("row", self.row, "1", "row of the file, counted from 1"),
        }
        about = {"title": "Stribeck curve from raw files of a rig", "files": ", ".join(self.paths)}
        return columns, {}, about | {"notes": "\n".join(self.notes)}

    def to_csv(self, path: PathLike, *, force: bool = False, **sampling: Any) -> None:
        """Write the points as a file of columns that ``stribeck fit`` reads as it is; the notes stand above it as comments.

        Parameters
        ----------
        path : str or path-like
            The file, ending in ``.csv``.
        force : bool
            Whether an existing file is replaced; otherwise it is kept and the call refused.
        **sampling
            Nothing.

        Raises
        ------
        InputError
            If the file cannot be written, or exists and ``force`` is not given.
        """
        columns = self._columns()
        with (
            atomic_write(path, CSV_ENDINGS, force=force) as temporary,
            temporary.open("w", newline="", encoding="utf-8") as file,
        ):
            file.write(f"# stribeck {version('stribeck')}, from {', '.join(self.paths)}\n")
            file.writelines(f"# {line}\n" for note in self.notes for line in note.splitlines())
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(columns)
            writer.writerows(zip(*columns.values(), strict=True))

    def _columns(self) -> dict[str, list[str]]:
        """Return header and cells of the columns of the file."""

        def cells(values: Array, digits: int = 8) -> list[str]:
            return [f"{value:.{digits}g}" if math.isfinite(value) else "" for value in values]

        columns: dict[str, list[str]] = {"curve": [self.curves[k] or "data" for k in self.curve]} if any(self.curves) else {}
        speed, given = (
            ("sum of speeds [m/s]" if self.rolls else "speed [m/s]"),
            {name for each in self.inputs for name in each},
        )
        if "viscosity" not in given and np.isfinite(self.viscosity).all():
            of_curve = np.array([float(np.mean(self.viscosity[self.curve == k])) for k in range(len(self.curves))])
            if self._warms():  # friction depends on viscosity times speed
                columns["eta U [Pa*m]"] = cells(self.viscosity * self.speed)
                columns["rig speed [m/s]"] = cells(self.speed)
                columns["local viscosity [Pa*s]"] = cells(self.viscosity)
            else:
                columns[speed] = cells(self.speed)
            columns["viscosity [Pa*s]"] = cells(of_curve[self.curve])
        else:
            columns[speed] = cells(self.speed)
        columns["friction"] = cells(self.friction)
        if np.isfinite(self.half_width).any():
            columns["error"] = cells(self.error, 4)
        for name in sorted(given):
            header = HEADERS.get(name, name)
            if name == "load" and "load_per_length" in given:
                header = "measured force [N]"
            columns[header] = cells(np.array([self.inputs[k].get(name, math.nan) for k in self.curve]))
        columns["rows"], columns["independent rows"] = list(map(str, self.rows)), cells(self.independent, 4)
        for name, values in (("direction difference", self.difference), ("direction difference SE", self.difference_error)):
            if np.isfinite(values).any():
                columns[name] = cells(values, 4)
        if np.isfinite(self.temperature).any():
            columns["temperature [°C]"] = cells(self.temperature, 5)
        return columns

    def _warms(self) -> bool:
        """Return whether the temperature differs along a curve by more than a thermometer tells."""
        of = [self.temperature[self.curve == k] for k in range(len(self.curves))]
        return any(np.ptp(each) > TEMPERATURE_TOLERANCE for each in of if np.isfinite(each).all() and len(each))
