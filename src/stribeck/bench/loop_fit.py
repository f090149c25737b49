"""Inputs of a contact from a measured friction loop: strokes solved in time, least squares, intervals."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated, Any

import numpy as np

from stribeck._types import Array, Flags
from stribeck.cases.case import Case
from stribeck.cases.fit_settings import FitSettings
from stribeck.contacts.geometries import LineContact
from stribeck.files.columns import Column, read_columns
from stribeck.files.datasets import Column as DataColumn
from stribeck.files.datasets import units_of
from stribeck.files.results import Exported, Labelled, json_of
from stribeck.files.writing import PathLike, path_of
from stribeck.fits.case_file import case_of
from stribeck.fits.columns import WORDS
from stribeck.fits.diagnosis import WIDEST, Unidentifiable, undetermined
from stribeck.fits.fit import names_to_fit
from stribeck.fits.free_inputs import FreeInput, free_inputs
from stribeck.fits.intervals import LEVELS, covariance_of
from stribeck.fits.least_squares import Minimum, Objective, settle
from stribeck.fits.measurements import Measurements
from stribeck.fits.model import Prediction
from stribeck.fits.repeats import CLEAR, memory
from stribeck.fits.result import (
    FitOutcome,
    FittedInput,
    WithFittedInputs,
    columns_of_inputs,
    fitted_input,
    notes_of_inputs,
    outcome_of_inputs,
)
from stribeck.motions.motion import Motion
from stribeck.quantities.formats import format_percent
from stribeck.quantities.results import ByValue, Card, Told
from stribeck.quantities.units import InputError, show
from stribeck.strokes.result import Stroke
from stribeck.strokes.stroke import Inlet, stroke

FRICTION = Column(WORDS["friction"], "number")

# What friction may be measured over, the first that is there
OVER = {
    "time": Column(r"(?:(?:elapsed|test|total|cycle) )?(?:time|zeit)|t", "time", is_bare=True),
    "position": Column(r"position|displacement|path|stroke position|weg|hub|x", "length", is_bare=True),
}

ADVICE = "a loop has a column 'friction', with the sign of the force against the motion, and one 'position [mm]' or 'time [s]'"


@dataclass(frozen=True, eq=False)
class Loop:
    """The rows of a measured friction loop."""

    path: str
    over: str  # "position" or "time", what friction was measured over
    values: Array  # [m or s]
    friction: Array  # With the sign of the force against the motion [-]
    notes: tuple[str, ...] = ()  # On rows of the file that were left out

    def __len__(self) -> int:
        """Return the number of rows."""
        return len(self.friction)


def read_loop(path: PathLike) -> Loop:
    """Read a friction loop: a column of position or time, and one of the friction coefficient with its sign."""
    path = path_of(path)
    if not Path(path).is_file():
        raise InputError(f"{path}: there is no such file.")
    found = read_columns(path, ADVICE, *({name: over, "friction": FRICTION} for name, over in OVER.items()), gaps=True)
    (over, values), (_, friction) = found.in_si.items()
    if not (np.any(friction > 0) and np.any(friction < 0)):
        raise InputError(f"{path}: friction has one sign; a loop has friction of the way back below zero.")
    return Loop(str(path), over, values, friction, found.notes)


SLOW = 0.1  # Speed over the largest below which a row is left out: at a reversal the rig gives way before the surfaces slide
SIDE_BY_SIDE = 10  # Rows at about one position, among which are some of both ways
SAME_LENGTH = 0.05  # Part by which the measured path may be longer or shorter than the motion
STEP = 0.01  # Change of the logarithm of an input for its derivative; with less, the mesh of a stroke makes noise of it
STEPS = 120  # Steps of a cycle, unless the case says otherwise


@dataclass(frozen=True, eq=False, repr=False)
class LoopFit(WithFittedInputs, Exported, Told, ByValue):
    """Inputs of a contact fitted to a friction loop, with their intervals."""

    _picture = "stribeck.plot.in_time.plot_loop_fit"

    inputs: Annotated[tuple[FittedInput, ...], "the fitted inputs; their intervals are those of the covariance"]
    outcome: Annotated[FitOutcome, "how the fit ended"]
    stroke: Annotated[Stroke, "the stroke with the fitted inputs"] = field(repr=False)
    over: Annotated[str, "what friction was measured over, 'position' or 'time'"]
    values: Annotated[Array, "position or time of the rows that were used", "m or s"]
    measured: Annotated[Array, "measured friction coefficient, less the zero of the force where that is off or drifts", "1"]
    friction: Annotated[Array, "fitted friction coefficient", "1"]
    friction_error: Annotated[Array, "error of the latter by steps and mesh", "1"]
    noise: Annotated[float, "standard deviation of the residuals", "1"]
    autocorrelation: Annotated[float, "correlation of neighbouring residuals, which widens the intervals", "1"]
    undetermined: Annotated[tuple[Unidentifiable, ...], "combinations of inputs that the loop does not determine"] = ()
    notes: Annotated[tuple[str, ...], "what to know before using the numbers"] = ()

    def to_dict(self) -> dict[str, Any]:
        """Return values, intervals, rows and outcome, ready for JSON."""
        return json_of(
            self,
            "inputs noise autocorrelation over undetermined notes",
            outcome=self.outcome.name,
            message=self.outcome.value,
            definition=self.stroke.definition,
            rows={name: values for name, (_, values, _, _) in self._rows.items()},
            units=units_of(self._rows),
        )

    @property
    def _rows(self) -> dict[str, DataColumn]:
        """What stands along the rows of the loop."""
        unit = "m" if self.over == "position" else "s"
        return {
            self.over: ("row", self.values, unit, f"{self.over} of the row"),
            "friction": ("row", self.measured, "1", "measured friction coefficient"),
            "fitted_friction": ("row", self.friction, "1", "fitted friction coefficient, balanced"),
            "fitted_friction_error": ("row", self.friction_error, "1", "estimated absolute error of fitted_friction"),
        }

    def _card(self) -> Card:
        table = [("input", "value", "error", "68 % interval", "95 % interval")]
        table += [(each.label, *each.texts) for each in self.inputs]
        largest = float(np.abs(self.measured).max())
        alike = f"correlated by {self.autocorrelation:.2f}" if self.autocorrelation >= 0.005 else "uncorrelated"
        rows = [
            ("noise", f"{self.noise:.2g}, {format_percent(self.noise / largest)} of the largest friction"),
            ("rows", f"{len(self.measured)}, neighbours {alike}"),
            ("friction", self.stroke.definition),
            ("error of the stroke", f"{float(self.friction_error.max()):.1g} at most"),
        ]
        warnings = [f"Warning: {each.message}" for each in self.undetermined]
        return Card(self.outcome.value, rows, self.notes, table, right=(1, 2), sentences=warnings)

    def _labelled(self) -> Labelled:
        columns, coords = columns_of_inputs(self.inputs)
        said = {"outcome": self.outcome.value, "definition": self.stroke.definition, "notes": "\n".join(self.notes)}
        return self._rows | columns, coords, {"title": "Inputs fitted to a friction loop", **said}


def fit_loop(
    data: PathLike | Loop,
    case: PathLike | Case | LineContact,
    motion: Motion | None = None,
    *,
    free: Sequence[str] | None = None,
    steps: int | None = None,
    inlet: Inlet | None = None,
    on_step: Callable[[int], object] | None = None,
) -> LoopFit:
    r"""Fit inputs of a line contact to a friction loop of a motion to and fro.

    .. math:: \min_\theta \sum_i \left(\mu(x_i; e^\theta) - \mu_i\right)^2

    over the logarithms of the free inputs, with friction of the last cycle of :func:`stribeck.stroke`.  A zero of the force
    that is off, or drifts from the first row to the last, by more than three standard errors is found with the inputs.

    Parameters
    ----------
    data : str or path-like or Loop
        A file with a column ``position [mm]`` or ``time [s]`` and one ``friction``, the coefficient with the sign of the force
        against the motion, so below zero on the way back.  Positions count from any place, either way, in the order in which
        they were passed; time counts as that of the motion.
    case : str or path-like or Case or LineContact
        What is known of the contact, and where the fit begins; a case has the motion in its table ``[stroke]``.
    motion : Motion, optional
        The motion, in the place of that of the case; it must repeat.
    free : sequence of str, optional
        Inputs to fit; those of the case, else boundary friction, or the shear stress in its place, and roughness.
    steps : int, optional
        Steps of a cycle; those of the case, else 120.
    inlet : {"flooded", "own-wake"}, optional
        What is before the contact, see :func:`stribeck.stroke`; that of the case, else flooded.
    on_step : callable, optional
        ``on_step(strokes)`` is called after each stroke that was solved.

    Returns
    -------
    LoopFit
        Values, intervals, the fitted stroke, notes.

    Raises
    ------
    InputError
        If the file is no loop, its path is not that of the motion, or the case has no motion that repeats.
    SolveError
        If the first stroke fails.

    Notes
    -----
    Rows slower than a tenth of the largest speed are left out: there the rig gives way before the surfaces slide.  Intervals
    are those of the covariance; residuals along a loop are alike, and their correlation widens the intervals.  At the end the
    stroke is solved with twice the steps: the inputs follow, and the intervals hold by how much.

    Source: fitting.md; strokes.md.

    Examples
    --------
    >>> import stribeck as sb
    >>> found = sb.bench.fit_loop("loop.csv", "examples/reciprocating_cylinder.toml")  # doctest: +SKIP
    >>> print(found)  # doctest: +SKIP
    """
    loop = data if isinstance(data, Loop) else read_loop(data)
    contact, settings, arguments = _problem(case, {"motion": motion, "steps": steps, "inlet": inlet})
    names = names_to_fit(free, settings, contact)
    of_free = Measurements("speed", np.ones(1), np.ones(1), None, np.zeros(1, int), ("",), ({},), np.ones(1, int))
    model = _LoopModel(contact, arguments, free_inputs(contact, of_free, names, settings), loop, on_step)
    if len(model.data) <= 3 * len(model.free):
        raise InputError(f"{loop.path}: {len(model.data)} rows are too few to fit {len(model.free)} inputs.")
    goal = Objective(model, None, None, False, False)  # type: ignore[arg-type]
    found = settle(goal, np.zeros(len(model.free)))
    said = model.settle_zero(found)
    return _result(model, settle(goal, found.theta), said)


def _middle(loop: Loop) -> float:
    """Return the friction about which a loop lies, which is the zero of the force, however far that is off."""
    rows = loop.friction[np.argsort(loop.values)]
    ends = [(each.min(), each.max()) for each in np.array_split(rows, max(len(rows) // SIDE_BY_SIDE, 1))]
    return float(np.median(np.mean(ends, axis=1)))


def _problem(case: PathLike | Case | LineContact, given: dict[str, Any]) -> tuple[LineContact, FitSettings, dict[str, Any]]:
    """Return contact, settings of the fit, and arguments of the stroke."""
    known = case_of(None, case)
    if not isinstance(known.contact, LineContact):
        raise InputError(
            f"contact = {show(known.contact)}; loops are fitted with a LineContact, as strokes are solved of one."
        )
    arguments: dict[str, Any] = {"steps": STEPS} | ({} if known.stroke is None else known.stroke.arguments)
    arguments |= {name: value for name, value in given.items() if value is not None}
    if "motion" not in arguments:
        raise InputError("the motion is missing; give a table [stroke] in the case, or motion=sb.motions.Sine(...).")
    motion = arguments["motion"]
    if not motion.repeats:
        raise InputError(f"motion = {show(motion)} does not repeat; a loop is one of a motion to and fro.")
    return known.contact, known.fit, arguments


class _LoopModel:
    """Friction of the rows of a loop, by free inputs."""

    def __init__(
        self,
        contact: LineContact,
        arguments: dict[str, Any],
        free: tuple[FreeInput, ...],
        loop: Loop,
        on_step: Callable[[int], object] | None,
    ) -> None:
        self.contact, self.arguments, self.free, self.on_step = contact, arguments, free, on_step
        self.motion, self.steps = arguments["motion"], arguments["steps"]
        self.rubs = np.array([each.name == contact.friction_of_asperities.size for each in free])
        self.strokes = 0
        self.is_mirrored = False  # Whether positions fall where friction is above zero
        self._known: dict[bytes, Array] = {}
        self.phase, sliding = self._phases(loop)
        self.left_out = int((~sliding).sum())
        self.data = replace(loop, values=loop.values[sliding], friction=loop.friction[sliding])
        self.phase = self.phase[sliding]
        later = np.flatnonzero(sliding) / len(sliding)
        self.zeros = np.column_stack([np.ones(len(later)), later - later.mean()])  # of the force, and its drift; fitted along

    def _phases(self, loop: Loop) -> tuple[Array, Flags]:
        """Return the time in the cycle of each row, and whether it slides."""
        time = self.motion.times(64 * self.steps)
        speed, path = self.motion.speed(time), self.motion.position(time)
        if loop.over == "time":
            phase = np.mod(loop.values, self.motion.duration)
        else:
            length, measured = float(np.ptp(path)), float(np.ptp(loop.values))
            if abs(measured / length - 1) > SAME_LENGTH:
                raise InputError(
                    f"{loop.path}: positions span {measured:.4g} m and the motion {length:.4g} m; they must be those of one "
                    "stroke. Check the unit of the column, and [stroke]."
                )
            phase, above = np.empty(len(loop)), loop.friction - _middle(loop)
            # In the order of the file; of rows in the order of positions it is a stroke, either way.
            self.is_mirrored = bool(np.diff(loop.values) @ np.sign(above[1:]) < -1.5 * measured)
            values = -loop.values if self.is_mirrored else loop.values
            place = values - values.min() - 0.5 * (measured - length) + path.min()
            for sign in (1.0, -1.0):
                own, rows = sign * speed > 0, sign * above >= 0
                order = np.argsort(path[own])
                phase[rows] = np.interp(place[rows], path[own][order], time[own][order])
        return phase, np.abs(self.motion.speed(phase)) >= SLOW * np.abs(speed).max()

    def at(self, theta: Array, steps: int | None = None) -> Stroke:
        """Return the stroke at a set of free inputs."""
        factors = {name: math.exp(t) for free, t in zip(self.free, theta.tolist(), strict=True) for name in free.names}
        moved = {name: getattr(self.contact, name) * factor for name, factor in factors.items()}
        found = stroke(self.contact.replace(**moved), **self.arguments | {"steps": steps or self.steps})
        self.strokes += 1
        if self.on_step is not None:
            self.on_step(self.strokes)
        return found

    def _parts(self, theta: Array) -> Array:
        """Return friction by asperities and by the fluid at the rows, as asperities of the case rub, and errors."""
        # Friction by asperities goes with its size, and nothing else of the stroke does.
        others = np.where(self.rubs, 0.0, theta)
        key = others.tobytes()
        if key not in self._known:
            self._known[key] = self.at_rows(self.at(others))
        return self._known[key]

    def at_rows(self, found: Stroke) -> Array:
        """Return both parts of friction and their errors at the rows, shape (4, n)."""
        errors = found.errors["friction_asperities"], found.errors["friction_fluid"]
        return np.array([self.along(found, each) for each in (found.friction_asperities, found.friction_fluid, *errors)])

    def along(self, found: Stroke, values: Array) -> Array:
        """Return what a stroke has at its instants at the rows."""
        last = found.last_cycle
        return np.interp(self.phase, found.time[last] - found.time[last][0], values[last])

    def predict(self, theta: Array, states: object, at: object = None) -> Prediction:
        """Return the friction of the rows, with its derivatives."""
        rubbing = math.exp(float(theta @ self.rubs))
        asperities, fluid, *errors = self._parts(theta)
        columns = []
        for k, rubs in enumerate(self.rubs):
            if rubs:
                columns.append(rubbing * asperities)
                continue
            beside = self._parts(theta + STEP * np.eye(len(theta))[k])
            columns.append((rubbing * (beside[0] - asperities) + beside[1] - fluid) / STEP)
        share, friction, jacobian = np.ones_like(fluid), rubbing * asperities + fluid, np.column_stack(columns)
        friction, jacobian = friction + self.zero_of(self.data.friction - friction), jacobian - self.zero_of(jacobian)
        return Prediction(friction, jacobian, share, share, rubbing * errors[0] + errors[1])

    def zero_of(self, friction: Array) -> Array:
        """Return the part of friction that a zero of the force and its drift make."""
        return np.asarray(self.zeros @ np.linalg.lstsq(self.zeros, friction, rcond=None)[0])

    def settle_zero(self, at: Minimum) -> str:
        """Fit the zero of the force and its drift only where they are clear, and return what is to be said of them."""
        misfit = at.prediction.friction - self.data.friction
        _, correlation = memory([misfit])
        freedom = max(len(misfit) - len(self.free) - 2, 1)
        variance = float(misfit @ misfit) / freedom * (1 + correlation) / (1 - correlation)
        zeros, self.zeros = self.zeros, np.empty((len(misfit), 0))
        plain = self.predict(at.theta, None)
        for count in (2, 1):
            own = zeros[:, :count]  # and what the inputs cannot do of it
            alone = own - plain.jacobian @ np.linalg.lstsq(plain.jacobian, own, rcond=None)[0]
            found = np.linalg.lstsq(own, self.data.friction - plain.friction, rcond=None)[0]
            errors = np.sqrt(variance * np.diag(np.linalg.pinv(alone.T @ alone)))
            if abs(found[-1]) > CLEAR * errors[-1]:
                self.zeros = own
                said = [f"{each:.2g} ± {error:.1g}" for each, error in zip(found, errors, strict=True)]
                drift = "" if count == 1 else f", and drifts by {said[1]} from the first row to the last"
                return f"Out and back: the zero of the force is off by {said[0]} of friction{drift}; taken off."
        return ""


def _result(model: _LoopModel, at: Minimum, zero: str) -> LoopFit:
    """Return the fit, with intervals of the covariance widened by the correlation of the residuals."""
    from scipy.stats import t

    misfit = at.residuals * at.objective.size
    n, p = len(misfit), len(model.free) + model.zeros.shape[1]
    _, correlation = memory([misfit])
    widened = (1 + correlation) / (1 - correlation)
    noise = math.sqrt(float(misfit @ misfit) / max(n - p, 1))
    # Residuals that are alike say as much as fewer ones.
    at = replace(at, jacobian=at.jacobian / math.sqrt(widened))
    covariance, _, _ = covariance_of(at)
    scatter = np.sqrt(np.diag(covariance))
    # Time steps err alike from row to row, which is no noise: the inputs follow what half of the steps change, but not along
    # directions that the loop does not determine.
    coarse, finer = (np.add(*model.at_rows(model.at(at.theta, steps))[:2]) for steps in (model.steps, 2 * model.steps))
    least = 1 / WIDEST / max(float(np.linalg.norm(at.jacobian, 2)), 1e-300)
    changed = coarse - finer - model.zero_of(coarse - finer)
    moved = np.linalg.pinv(at.prediction.jacobian, rcond=min(least, 1.0)) @ changed
    low, high = at.objective.bounds
    places = np.clip(at.theta + moved, low, high)
    errors = np.hypot(scatter, moved)
    freedom = max(n / widened - p, 1.0)
    quantiles = [float(t.ppf(0.5 + level / 2, freedom)) for level in LEVELS]
    half = np.outer(errors, quantiles)
    ends = np.stack([places[:, None] - half, places[:, None] + half], axis=-1)
    numbers = (each.tolist() for each in (places, errors, ends, at.at_bound))
    inputs = [fitted_input(model.contact.INPUTS, *each) for each in zip(model.free, *numbers, strict=True)]
    notes = [*notes_of_inputs(inputs), *model.data.notes, *filter(None, [zero])]
    if model.left_out:
        notes.append(f"{model.left_out} rows slower than a tenth of the largest speed left out.")
    if model.is_mirrored:
        notes.append("Positions fall where friction is above zero: they were counted from the other end.")
    if np.any(np.abs(moved) > scatter):
        notes.append("Half of the time steps move the inputs by more than the noise does: ask for more steps.")
    outcome = outcome_of_inputs(inputs) if at.ended else FitOutcome.STEP_LIMIT
    found = model.at(places, 2 * model.steps)
    by_asperities, by_fluid, *of_parts = model.at_rows(found)
    friction, error_of_rows = by_asperities + by_fluid, of_parts[0] + of_parts[1]
    measured = model.data.friction - model.zero_of(model.data.friction - friction)
    against = int((model.motion.speed(model.phase) * measured < 0).sum())
    if against and model.data.over == "time":
        notes.append(f"In {against} of {n} rows friction has the sign of the other way: does time begin with the motion?")
    size, loads = np.abs(by_asperities) + np.abs(by_fluid), model.along(found, found.contact_load_share)
    of_rows = Prediction(size, at.prediction.jacobian, np.abs(by_asperities) / size, loads, error_of_rows)
    with np.errstate(invalid="ignore"):  # nothing may change with any input
        weak = undetermined(model.free, [each.label for each in inputs], at.jacobian, of_rows)
    return LoopFit(
        tuple(inputs),
        outcome,
        found,
        model.data.over,
        model.data.values,
        measured,
        friction,
        error_of_rows,
        noise,
        correlation,
        weak,
        (*notes, *found.notes),
    )
