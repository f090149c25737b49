"""A published experiment against the model: predicted without a fit from inputs that each have a source and an error."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import numpy as np

from stribeck._types import Array
from stribeck.cases.case import Case
from stribeck.cases.reading import check_case
from stribeck.files.cells import split_header
from stribeck.files.columns import si_factor
from stribeck.files.results import Exported, Labelled
from stribeck.files.table_reading import read_table
from stribeck.files.text_table import TextTable
from stribeck.files.toml import read_toml
from stribeck.files.writing import PathLike, path_of
from stribeck.quantities.formats import format_percent
from stribeck.quantities.results import Card, Told
from stribeck.quantities.units import InputError, checked_word, show, to_si
from stribeck.solver.solve import solve

FILE = "experiment.toml"  # Name of the file in the folder of an experiment
FORCE, FRICTION, ERROR, ROW = "friction_force", "friction", "error", "row"  # Columns of its table that are no inputs
OWN_KEYS = ("title", "source", "licence", "data", "unknown", "relative_to", "length", "models", "reasons")
ROW_RTOL = {"line": 1e-6, "point": 1e-3}  # By geometry: errors of the inputs are far larger
AGREES_WITHIN = 2.0  # Standard errors of the logarithm of measured over predicted

_NUMBER = re.compile(r"\s*([-+]?[0-9.]+(?:[eE][-+]?[0-9]+)?)\s*(.*?)\s*", re.DOTALL)


@dataclass(frozen=True)
class InputStated:
    """An input of an experiment as its file has it."""

    table: str
    key: str
    value: str | float
    error: float | None  # Standard error over the value; None if it is not known
    source: str

    @property
    def name(self) -> str:
        """Where it stands."""
        return f"[{self.table}] {self.key}"


@dataclass(frozen=True)
class Experiment:
    """An experiment with all that is known of it, as its folder holds it."""

    path: Annotated[Path, "its folder"]
    title: Annotated[str, "headline"]
    source: Annotated[str, "where the measurement is from"]
    licence: Annotated[str, "licence of the data"]
    unknown: Annotated[tuple[str, ...], "what is not known of it, a sentence each"]
    relative_to: Annotated[int | None, "row over whose friction all others count; None where friction itself is compared"]
    models: Annotated[dict[str, dict[str, Any]], "tables of a case for each model, plain numbers in them"]
    inputs: Annotated[dict[str, tuple[InputStated, ...]], "inputs of each model with error and source"]
    own: Annotated[dict[str, frozenset[str]], "for each model the inputs of the contact that it sets in every row"]
    reasons: Annotated[dict[str, str], "for each model why it is right or wrong, as its author says"]
    labels: Annotated[tuple[str, ...], "name of each row"]
    varied: Annotated[tuple[dict[str, str | float], ...], "inputs of the contact in each row"]
    measured: Annotated[Array, "measured friction coefficient, or force over length or over one, of each row"]
    measured_error: Annotated[Array, "its standard error"]
    is_force: Annotated[bool, "whether a force was measured, so that the predicted coefficient is multiplied by the load"]


@dataclass(frozen=True, eq=False, repr=False)
class Prediction(Exported, Told):
    """What one model predicts of an experiment without a fit, and measured over predicted."""

    experiment: Annotated[Experiment, "the experiment"]
    model: Annotated[str, "name of the model"]
    predicted: Annotated[Array, "predicted without a fit, over a row where the experiment compares ratios", "1"]
    predicted_error: Annotated[Array, "its relative standard error by the inputs", "1"]
    measured: Annotated[Array, "measured, likewise", "1"]
    measured_error: Annotated[Array, "its relative standard error", "1"]

    @property
    def ratio(self) -> Array:
        """Measured over predicted."""
        return np.asarray(self.measured / self.predicted)

    @property
    def ratio_error(self) -> Array:
        """Relative standard error of measured over predicted."""
        return np.hypot(self.predicted_error, self.measured_error)

    @property
    def agrees(self) -> Array:
        """Whether measured over predicted is one within twice its error."""
        return np.asarray(np.abs(np.log(self.ratio)) <= AGREES_WITHIN * self.ratio_error)

    @property
    def headline(self) -> str:
        """The model's error, then how far it is from what was measured, in a sentence."""
        worst = float(np.max(self.predicted_error))
        compared = self._compared
        low, high = float(self.ratio[compared].min()), float(self.ratio[compared].max())
        count, of = int(self.agrees[compared].sum()), len(compared)
        return (
            f"{self.model}: the errors of its inputs are {format_percent(worst)} of the prediction at most; measured over "
            f"predicted is {low:.3g} to {high:.3g}, within twice the errors in {count} of {of} rows."
        )

    @property
    def _compared(self) -> list[int]:
        reference = self.experiment.relative_to
        return [i for i in range(len(self.ratio)) if reference is None or i != reference - 1]

    def _card(self) -> Card:
        experiment = self.experiment
        what = "friction" if experiment.relative_to is None else f"over row {experiment.relative_to}"
        rows: list[tuple[str, ...]] = [(ROW, f"predicted, {what}", "model's error", "measured", "error", "ratio", "verdict")]
        for i in self._compared:
            numbers = f"{self.predicted[i]:.3g}", format_percent(self.predicted_error[i]), f"{self.measured[i]:.3g}"
            ratio = format_percent(self.measured_error[i]), f"{self.ratio[i]:.3g}"
            rows.append((experiment.labels[i], *numbers, *ratio, "agrees" if self.agrees[i] else "differs"))
        open_ones = [each.name for each in experiment.inputs[self.model] if each.error is None]
        sentences = [experiment.reasons.get(self.model, "")]
        sentences += [f"Not counted, as their errors are not known: {', '.join(open_ones)}."] if open_ones else []
        return Card(self.headline, (), (), table=rows, right=(1, 2, 3, 4, 5), sentences=tuple(filter(None, sentences)))

    def _labelled(self) -> Labelled:
        columns: Any = {name: (ROW, getattr(self, name), "1", each.meaning) for name, each in self._words.items() if each.unit}
        columns["ratio"] = (ROW, self.ratio, "1", "measured over predicted")
        columns["ratio_error"] = (ROW, self.ratio_error, "1", "its relative standard error")
        coordinate: Any = {ROW: (ROW, np.array(self.experiment.labels, dtype=object), "1", "row of the experiment")}
        about = {"title": self.experiment.title, "model": self.model, "source": self.experiment.source}
        return columns, coordinate, about | {"licence": self.experiment.licence}


def load_experiment(folder: PathLike) -> Experiment:
    """Read a published experiment from a folder with ``experiment.toml`` and a table (docs/experiments.md).

    Parameters
    ----------
    folder : str or path
        The folder.

    Returns
    -------
    Experiment
        Its inputs with their errors and sources, its rows in SI units, its models.

    Raises
    ------
    InputError
        If a file is missing or wrong; all problems of ``experiment.toml`` are named.
    """
    path = path_of(folder)
    if not path.is_dir():
        raise InputError(f"folder = {show(str(path))} is no folder; give the one that holds {FILE}.")
    tables = read_toml(path / FILE)
    problems = [f"{key} is missing; say it in words." for key in ("title", "source", "licence", "data") if key not in tables]
    base = {name: table for name, table in tables.items() if name not in OWN_KEYS}
    problems += [
        f"{name} = {show(value)} is no table of a case." for name, value in base.items() if not isinstance(value, dict)
    ]
    if not isinstance(tables.get("models", {}), dict):
        problems.append("models must be tables, such as [models.stress.asperity_friction].")
    _refuse(path, problems)
    models, inputs, own = {}, {}, {}
    for name, changes in (tables.get("models") or {"model": {}}).items():
        stated: list[InputStated] = []
        own[name] = frozenset(changes.get("contact", {}))
        merged = {table: {**base.get(table, {}), **changes.get(table, {})} for table in (*base, *changes)}
        models[name] = {table: _plain(table, keys, stated, problems) for table, keys in merged.items()}
        inputs[name] = tuple(stated)
    _refuse(path, problems)
    table = read_table(path / str(tables["data"]), expected="write a header such as 'speed [mm/s];friction;error'")
    labels, varied, measured, errors, is_force = _rows(table)
    length = tables.get("length")
    scale = 1.0 if length is None else to_si(length, "length", "length")
    reference = tables.get("relative_to")
    if reference is not None and not (isinstance(reference, int) and 1 <= reference <= len(labels)):
        raise InputError(f"{path / FILE}: relative_to = {show(reference)} must be the number of a row, 1 to {len(labels)}.")
    return Experiment(
        path=path,
        title=str(tables["title"]),
        source=str(tables["source"]),
        licence=str(tables["licence"]),
        unknown=tuple(map(str, tables.get("unknown", ()))),
        relative_to=reference,
        models=models,
        inputs=inputs,
        own=own,
        reasons={name: str(reason) for name, reason in tables.get("reasons", {}).items()},
        labels=labels,
        varied=varied,
        measured=measured / scale,
        measured_error=errors / measured,
        is_force=is_force,
    )


def predict_experiment(experiment: Experiment, model: str, on_state: Callable[[int, int], object] | None = None) -> Prediction:
    r"""Predict what an experiment measured, by one of its models and without a fit.

    Parameters
    ----------
    experiment : Experiment
        The experiment, by :func:`load_experiment`.
    model : str
        A name of ``experiment.models``.
    on_state : callable, optional
        Called with the number of states solved and that of all.

    Returns
    -------
    Prediction
        Prediction, measurement and their ratio for each row, each with its relative standard error.

    Raises
    ------
    InputError
        If the experiment has no such model, or a state of it is no contact.
    SolveError
        If a state cannot be solved.

    Notes
    -----
    .. math:: \sigma^2 = \sigma_0^2 + \sum_k \big(\ln y(x_k (1 + \epsilon_k)) - \ln y(x)\big)^2

    with :math:`\sigma_0` the tolerance of the solver and each input changed by its standard error.
    """
    checked_word("model", model, experiment.models)
    inputs = [each for each in experiment.inputs[model] if each.error]
    varied = {key for row in experiment.varied for key in row} - experiment.own[model]
    inputs = [each for each in inputs if not (each.table == "contact" and each.key in varied)]
    count, done = (1 + len(inputs)) * len(experiment.labels), 0
    found = []
    for changed in (None, *inputs):
        row = []
        for given in experiment.varied:
            row.append(_friction(experiment, model, given, changed))
            done += 1
            if on_state is not None:
                on_state(done, count)
        found.append(row)
    values, measured, errors = np.array(found), experiment.measured, experiment.measured_error
    if experiment.relative_to is not None:
        k = experiment.relative_to - 1
        values, measured, errors = values / values[:, k : k + 1], measured / measured[k], np.hypot(errors, errors[k])
        errors[k] = 0.0
    apart = np.log(values[1:] / values[0])
    solver = ROW_RTOL[str(experiment.models[model]["contact"].get("geometry", "line"))]
    return Prediction(experiment, model, values[0], np.sqrt((apart**2).sum(axis=0) + solver**2), measured, errors)


def _friction(experiment: Experiment, model: str, given: Mapping[str, Any], changed: InputStated | None) -> float:
    """Return the friction of a row, with one input changed by its error."""
    own = {name: dict(keys) for name, keys in experiment.models[model].items()}
    if changed is not None and changed.error is not None:
        own[changed.table][changed.key] = _times(changed.value, 1 + changed.error)
    own["contact"] |= {name: value for name, value in given.items() if name not in experiment.own[model]}
    case: Case = check_case(own, experiment.path / FILE)
    state = solve(case.contact, rtol=ROW_RTOL[case.contact.groups.geometry])
    return float(state.friction(definition=case.definition)) * (case.contact.load if experiment.is_force else 1.0)


def _times(value: str | float, factor: float) -> str | float:
    if not isinstance(value, str):
        return value * factor
    found = _NUMBER.fullmatch(value)
    assert found is not None
    return f"{float(found[1]) * factor!r} {found[2]}"


def _plain(table: str, keys: Mapping[str, Any], stated: list[InputStated], problems: list[str]) -> dict[str, Any]:
    """Return a table of a case without errors and sources, which are noted, and what lacks them."""
    found = {}
    for key, value in keys.items():
        found[key] = value
        if isinstance(value, str) and _NUMBER.fullmatch(value) is None or isinstance(value, bool):
            continue
        where = f"[{table}] {key} = {show(value)}"
        if not (isinstance(value, dict) and set(value) == {"value", "error", "source"} and str(value["source"]).strip()):
            problems.append(
                f"{where} must have a value, an error and a source, {{ value = ..., error = '20 %', source = ... }}."
            )
            continue
        found[key], error = value["value"], value["error"]
        part = re.fullmatch(r"\s*([0-9.]+)\s*%\s*", str(error))
        if part is None and error != "unknown":
            problems.append(f"{where}: its error must be a part of the value, such as '20 %', or 'unknown'.")
            continue
        number = found[key]
        if isinstance(number, bool) or not isinstance(number, int | float | str) or _NUMBER.fullmatch(str(number)) is None:
            problems.append(f"{where}: its value must be a number, with its unit in quotes.")
            continue
        stated.append(InputStated(table, key, number, None if part is None else float(part[1]) / 100, str(value["source"])))
    return found


def _rows(table: TextTable) -> tuple[tuple[str, ...], tuple[dict[str, Any], ...], Array, Array, bool]:
    """Return label and inputs of each row, what was measured and its error, and whether that is a force."""
    names = {split_header(each)[0]: each for each in table.header}
    measured = [name for name in (FORCE, FRICTION) if name in names]
    missing = f"{FRICTION} or {FORCE} [N]" if len(measured) != 1 else ERROR if ERROR not in names else ""
    if missing:
        raise InputError(f"{table.path} needs one column {missing} among {show(', '.join(table.header))}.")
    columns = {name: column for name, column in names.items() if name != ROW}
    read = {name: table.numbers_of(column, gaps=False) for name, column in columns.items()}
    units = {name: table.unit(column) for name, column in columns.items()}
    inputs = [name for name in columns if name not in (*measured, ERROR)]
    varied = tuple(
        {name: f"{float(read[name][i])!r} {units[name]}" if units[name] else float(read[name][i]) for name in inputs}
        for i in range(len(table.rows))
    )
    for name in (*measured, ERROR):
        if not (np.isfinite(read[name]).all() and (read[name] > 0).all()):
            raise InputError(f"{table.path}: {name} must be positive in every row.")
    labels = tuple(table.column(names[ROW])) if ROW in names else tuple(map(str, range(1, len(table.rows) + 1)))
    is_force = measured[0] == FORCE
    factor, of_error = (si_factor(units[each], "force" if is_force else "number", each) for each in (*measured, ERROR))
    if factor != of_error:
        raise InputError(
            f"{table.path}: {measured[0]} [{units[measured[0]]}] and {ERROR} [{units[ERROR]}] must have the same unit."
        )
    return labels, varied, read[measured[0]] * factor, read[ERROR] * factor, is_force


def _refuse(path: Path, problems: list[str]) -> None:
    if problems:
        raise InputError("\n".join(f"{path / FILE}: {problem}" for problem in dict.fromkeys(problems)))
