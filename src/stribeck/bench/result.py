"""A Stribeck curve made of raw files of a rig: its points with their errors, and what became of each row."""

from __future__ import annotations

import math
from dataclasses import dataclass
from importlib.metadata import version
from typing import Annotated, Any

import numpy as np

from stribeck._types import Array, Indices
from stribeck.contacts.geometries import LINE, POINT
from stribeck.contacts.parts import LAW_NUMBERS
from stribeck.files.datasets import Column, write_columns
from stribeck.files.results import UNWRITTEN, WRITTEN, Exported, Labelled, json_of
from stribeck.files.writing import PathLike
from stribeck.fits.rig import TEMPERATURE_TOLERANCE
from stribeck.quantities.docstrings import told
from stribeck.quantities.formats import format_percent, format_si
from stribeck.quantities.results import ByValue, Card, Told
from stribeck.quantities.standard_errors import INTERVAL_95
from stribeck.quantities.units import DIMENSIONS

# What files may say of the contact: a rig measures forces, and a case may have a load per length
INPUTS = LAW_NUMBERS | POINT.rows | {"load_per_length": LINE.rows["load"]}


# What each point has beside its curve; the other numbers are of rows.
POINTS = (
    *("speed", "friction", "half_width", "rows", "independent", "difference", "difference_error"),
    *("temperature", "viscosity"),
)


@dataclass(frozen=True, eq=False, repr=False)
class BenchCurve(Exported, Told, ByValue):
    """Friction over speed from raw files of a rig; its dataset has points along ``point`` and rows of files along ``row``."""

    _picture = "stribeck.plot.in_time.plot_bench"

    paths: Annotated[tuple[str, ...], "the files"]
    curves: Annotated[tuple[str, ...], "names of the curves"]
    inputs: Annotated[tuple[dict[str, float], ...], "inputs of each curve in SI units, as far as the files say them"]
    curve: Annotated[Indices, "curve of each point"]
    speed: Annotated[Array, "sum of the surface speeds", "m/s"]
    friction: Annotated[Array, "friction coefficient, mean of both directions", "1"]
    half_width: Annotated[Array, "half of the 95 % interval of the friction coefficient; NaN where nothing shows it", "1"]
    rows: Annotated[Indices, "rows of the files", "1"]
    independent: Annotated[Array, "independent values among the rows, by their correlation", "1"]
    difference: Annotated[Array, "friction in the one direction less that in the other; NaN where only one is known", "1"]
    difference_error: Annotated[Array, "standard error of the difference", "1"]
    temperature: Annotated[Array, "temperature; NaN where it is not known", "degC"]
    viscosity: Annotated[Array, "viscosity at that temperature; NaN where it is not known", "Pa s"]
    notes: Annotated[tuple[str, ...], "what was left out, taken off or assumed, and by which rule, one sentence each"]
    taken: Annotated[tuple[str, ...], "for each file what its columns were taken for"]
    rolls: Annotated[bool, "whether both surfaces move, so that files call the speed the sum of speeds"]
    file: Annotated[Indices, "number of the file of each row", "1"]
    row: Annotated[Indices, "row of the file, counted from 1", "1"]
    time: Annotated[Array, "time of each row, or its number", "s"]
    row_speed: Annotated[Array, "speed of the row, with its sign", "m/s"]
    row_friction: Annotated[Array, "friction coefficient of the row, positive along the motion", "1"]
    status: Annotated[Indices, "0 kept, 1 at rest, 2 the speed changes, 3 start of a step, 4 run-in", "1"]

    @property
    def error(self) -> Array:
        """Standard error of friction [-]: half of the 95 % interval over 1.96, larger where few values are independent."""
        found: Array = self.half_width / INTERVAL_95
        return found

    def __len__(self) -> int:
        """Return the number of points."""
        return len(self.friction)

    def _card(self) -> Card:
        names = len(self.curves) > 1
        table = [(*["curve"] * names, "speed", "friction", "95 %", "rows", "independent", "difference of directions")]
        for i in range(len(self)):
            known = math.isfinite(self.half_width[i])
            there = math.isfinite(self.difference[i])
            table.append(
                (
                    *[self.curves[self.curve[i]]] * names,
                    format_si(self.speed[i], "speed"),
                    f"{self.friction[i]:.4g}",
                    f"± {self.half_width[i]:.2g}" if known else "not known",
                    str(self.rows[i]),
                    f"{self.independent[i]:.3g}",
                    f"{self.difference[i]:+.2g} ± {self.difference_error[i]:.1g}" if there else "",
                )
            )
        right = range(1, 6) if names else range(5)
        read = [f"Read: {each}." for each in dict.fromkeys(self.taken)]
        return Card(self._headline(), table=table, right=tuple(right), notes=self.notes, sentences=read)

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
        """Return points, inputs, notes and how columns were read, ready for JSON."""
        units = {name: INPUTS[name].unit for each in self.inputs for name in each} | {"error": "1"}
        units |= {name: each.unit for name, each in self._words.items() if name in POINTS and each.unit is not None}
        names = ("paths", "curves", "inputs", *POINTS, "error", "taken", "notes")
        return json_of(self, " ".join(names), curve=[self.curves[k] for k in self.curve], units=units)

    def _labelled(self) -> Labelled:
        names = np.array(self.curves, dtype=object)
        columns: dict[str, Column] = {
            name: ("point" if name in POINTS else "row", getattr(self, name), each.unit, each.meaning)
            for name, each in self._words.items()
            if each.unit is not None
        }
        columns["curve"] = ("point", names[self.curve], "1", "name of the curve")
        columns["error"] = ("point", self.error, "1", "standard error of the friction coefficient")
        columns["file_row"] = columns.pop("row")
        about = {"title": "Stribeck curve from raw files of a rig", "files": ", ".join(self.paths)}
        return columns, {}, about | {"notes": "\n".join(self.notes)}

    @told(WRITTEN, raises=UNWRITTEN)
    def to_csv(self, path: PathLike, *, force: bool = False, **sampling: Any) -> None:
        """Write the points as a file of columns that ``stribeck fit`` reads as it is; the notes stand above it as comments."""
        above = [f"stribeck {version('stribeck')}, from {', '.join(self.paths)}"]
        write_columns(path, above + [line for note in self.notes for line in note.splitlines()], self._columns(), force=force)

    def _columns(self) -> dict[str, list[str]]:
        """Return header and cells of the columns of the file."""

        def cells(values: Array, digits: int = 8) -> list[str]:
            return [f"{value:.{digits}g}" if math.isfinite(value) else "" for value in values]

        columns: dict[str, list[str]] = {"curve": [self.curves[k] or "data" for k in self.curve]} if any(self.curves) else {}
        given = {name for each in self.inputs for name in each}
        finds_viscosity = "viscosity" not in given and np.isfinite(self.viscosity).all()
        if finds_viscosity and self._warms():  # friction depends on viscosity times speed
            product = "viscosity times sum of speeds [Pa*m]" if self.rolls else "eta U [Pa*m]"
            columns[product] = cells(self.viscosity * self.speed)
            columns["rig speed [m/s]"] = cells(self.speed)
            columns["local viscosity [Pa*s]"] = cells(self.viscosity)
        else:
            columns["sum of speeds [m/s]" if self.rolls else "speed [m/s]"] = cells(self.speed)
        if finds_viscosity:
            of_curve = np.array([float(np.mean(self.viscosity[self.curve == k])) for k in range(len(self.curves))])
            columns["viscosity [Pa*s]"] = cells(of_curve[self.curve])
        columns["friction"] = cells(self.friction)
        if np.isfinite(self.half_width).any():
            columns["error"] = cells(self.error, 4)
        for name in sorted(given):
            unit = DIMENSIONS[INPUTS[name].dimension].unit
            header = f"{INPUTS[name].name} [{unit}]" if unit else name
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
