"""Inputs of a contact from measured friction curves: values, intervals, and what the data cannot determine.

Least squares on the logarithms of the inputs with analytic derivatives.  With a law that it holds they run on
:mod:`stribeck.atlas` and are then finished on solved states; with other laws, fluids and solids curves are read between the
inputs at which they were solved.
"""

import math
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from stribeck._types import Array
from stribeck.asperity_friction.coulomb import Coulomb
from stribeck.cases.case import Case
from stribeck.cases.fit_settings import DEFAULT_FREE, FitSettings, free_names
from stribeck.checks.subject import Subject
from stribeck.checks.table import checks_of
from stribeck.contacts.contact import Contact
from stribeck.contacts.friction import Definition
from stribeck.fits.case_file import case_of
from stribeck.fits.diagnosis import judge_residuals, undetermined
from stribeck.fits.free_inputs import FreeInput, free_inputs
from stribeck.fits.intervals import covariance_of, ends_beside, ends_of
from stribeck.fits.least_squares import NEAR, Minimum, Objective, effective_parameters, minimise, objective, settle
from stribeck.fits.measurements import Data, read_measurements
from stribeck.fits.model import FrictionModel
from stribeck.fits.result import Fit, fitted_input, notes_of, outcome_of
from stribeck.numerics.threads import one_blas_thread
from stribeck.quantities.units import InputError

# Places tried before the least squares, those followed, and how far from the case they lie.
STARTS, BEST_STARTS, START_FACTOR = 64, 4, 10.0

FIRST_NOISE = 0.1  # Noise with which the search begins where it is not known

ROUNDS = 6  # Minima at which states that are read are solved, before all are solved along the rest of the way

FLAT = 1e-5  # Singular value of the derivatives, over the largest, below which nothing changes along a direction

SAME = 1e-3  # Rise of q up to which two fits are the same

SOLVED_PLACES = 6  # Places at which a fit usually solves its states, for its progress

Step = Callable[[str, int, int], object]


@one_blas_thread
def fit(
    data: Data,
    case: str | os.PathLike[str] | Case | Contact,
    *,
    free: Sequence[str] | None = None,
    per_file: Sequence[str] | None = None,
    robust: bool | None = None,
    intervals: bool = True,
    on_step: Step | None = None,
) -> Fit:
    r"""Fit inputs of a contact to measured friction.

    .. math:: \min_\theta \sum_i \rho\!\left(\frac{\mu(U_i; e^\theta) - \mu_i}{\sigma_i}\right)
        + \sum_k \left(\frac{\theta_k - m_k}{\tau_k}\right)^2

    over the logarithms of the free inputs, within bounds; where no errors are given the residuals are
    :math:`\ln(\mu/\mu_i)`, all with the same error, whose size comes from them.

    Parameters
    ----------
    data : str or path-like or Measurements, or sequence of these
        Measured friction, or the file or files that hold it, see :func:`read_measurements`; several are fitted together.
    case : str or path-like or Case or LineContact
        What is known of the contact, where the fit begins, and in the table ``[fit]`` of a file what is asked.
    free : sequence of str, optional
        Inputs to fit; those of the case, else friction coefficient and roughness.
    per_file : sequence of str, optional
        Those of them that each file has for itself, where there are several; as the case says by default.
    robust : bool, optional
        Whether outliers are kept from steering the fit; as the case says by default.
    intervals : bool
        Whether intervals by profile likelihood are found; else they are those of the covariance.
    on_step : callable, optional
        ``on_step(what, done, total)`` is called as the work goes on: what it does, how many states are solved, and about how
        many will be.

    Returns
    -------
    Fit
        Values and intervals, outcome, tests and notes.

    Raises
    ------
    InputError
        If a value cannot be used, or there are too few rows.
    SolveError
        If the contact cannot be solved as the case has it.

    Notes
    -----
    The fitted friction is solved, each row to the tolerance of the case; that of a ball to a third of the standard error of a
    factor on all rows, from 1e-4 to 1e-3, where that is larger. In 200 synthetic experiments the intervals held the
    truth as often as they should (``test_fit_coverage.py``).
    """
    case = case_of(data, case)
    contact, settings, definition = case.contact, case.fit, case.definition
    data = read_measurements(data, settings)
    names = names_to_fit(free, settings, contact)
    if robust is not None:
        settings = replace(settings, robust=robust)
    settings = _with_owners(settings, names, per_file)
    wanted = free_inputs(contact, data, names, settings)
    model = FrictionModel(contact, data, wanted)
    if len(data) <= max(2, len(wanted)):
        raise InputError(
            f"{data.path or 'the data'}: {len(data)} rows with speed and friction are too few to fit {len(wanted)} "
            f"input{'s' * (len(wanted) != 1)} ({', '.join(each.name for each in wanted)}); at least {max(3, len(wanted) + 1)} "
            "are needed, and ten times as many rows as inputs are advisable."
        )
    report = _Progress(model, on_step)
    rtol = report.rtol = model.rtol_of_states(case.rtol)
    states = model.states(definition, rtol, report.count_state)
    goal = objective(model, states, settings)

    found = _search(goal, definition, report)
    wanted_rtol = model.rtol_of_states(case.rtol, found.relative_noise)
    if wanted_rtol < rtol:  # the data are better than the states so far
        report.rtol = wanted_rtol
        states = model.states(definition, wanted_rtol, report.count_state)
        found = replace(found, objective=replace(found.objective, states=states))
    fine = _solved(found, report)
    if not states.uses_atlas:  # what was solved is read from now on
        found = replace(fine, objective=replace(fine.objective, states=states))
    covariance, quantiles, inflation = covariance_of(fine)
    before = found
    ends, found = ends_of(found, covariance, quantiles, inflation, intervals, report)
    if found is not before:  # a profile led to a better fit, to which the ends belong
        fine = _solved(found, report)
        covariance, quantiles, inflation = covariance_of(fine)
    if not states.uses_atlas:
        return _result(fine, ends, covariance, quantiles, case, None)
    shift = fine.theta - found.theta
    # Where nothing changes beside the fit, solved states may lead it anywhere: its ends do not go along.
    ends = ends_beside(ends, found.theta, fine.theta, np.sqrt(np.outer(np.diag(covariance), quantiles)))
    return _result(fine, ends, covariance, quantiles, case, shift)


def names_to_fit(free: Sequence[str] | None, settings: FitSettings, contact: Contact) -> tuple[str, ...]:
    """Return the inputs to fit: those that are named, else those of the settings, else dry friction and roughness."""
    own = contact.friction_of_asperities.size
    usual = tuple(own if name == Coulomb.size else name for name in DEFAULT_FREE)
    names = free_names(free) if free is not None else settings.free or tuple(filter(None, usual))
    if not names:
        raise InputError("free is empty; name at least one input to fit, such as boundary_friction.")
    return names


def _with_owners(settings: FitSettings, names: Sequence[str], per_file: Sequence[str] | None) -> FitSettings:
    """Return the settings with the inputs that curves and files have for themselves, of those that are fitted."""
    if per_file is None:
        of_files = tuple(name for name in settings.per_file if name in names)
    else:
        of_files = free_names(per_file, "per_file")
        extra = [name for name in of_files if name not in names]
        if extra:
            raise InputError(f"per_file has {extra[0]}, which is not fitted; add it to free.")
    of_curves = tuple(name for name in settings.per_curve if name in names and name not in of_files)
    return replace(settings, per_curve=of_curves, per_file=of_files)


@dataclass
class _Progress:
    """Says what a fit does, and how many states are solved of those that it will need."""

    model: FrictionModel
    on_step: Step | None
    rtol: float = 0.0
    what: str = "searching"
    done: int = 0

    def count_state(self) -> None:
        """Count a solved state."""
        self.done += 1
        self(self.what)

    def __call__(self, what: str) -> None:
        """Say what is done."""
        self.what = what
        if self.on_step is not None:
            of_place = self.model.count_states(self.rtol)
            total = of_place * max(SOLVED_PLACES, self.done // of_place + 1)
            self.on_step(self.what, self.done, total)


def _search(goal: Objective, definition: Definition, report: _Progress) -> Minimum:
    """Return the best minimum found from the case, and with the atlas from places around it, with the noise settled."""
    first = replace(goal, scale=FIRST_NOISE if goal.sigma is None else 1.0)
    starts = [np.zeros(len(goal.model.free))]
    if goal.states.uses_atlas:
        starts += _best(first, _places(goal), definition)
    found = (minimise(first, start, on_step=lambda: report("searching")) for start in starts)
    best = min(found, key=lambda each: each.value)
    return _brought_back(settle(best.objective, best.theta, lambda: report("fitting")))


def _solved(found: Minimum, report: _Progress) -> Minimum:
    """Return the minimum on solved states, from that on states that were read, which is found anew until both agree."""
    solved = found.objective.states.solved()
    for _ in () if solved.uses_atlas else range(ROUNDS):
        fine = minimise(replace(found.objective, states=solved), found.theta, near=math.inf)
        report("solving")
        if fine.converged:
            return fine
        found = _brought_back(settle(found.objective, found.theta))
    return _brought_back(settle(replace(found.objective, states=solved), found.theta, lambda: report("solving")))


def _brought_back(found: Minimum) -> Minimum:
    """Return the minimum, with undetermined inputs moved as near to the case as the data allow."""
    near = _nearest(found)
    if np.allclose(near, found.theta, rtol=0, atol=1e-9):
        return found
    for _ in range(ROUNDS):
        moved = minimise(found.objective, near, flat=FLAT, near=NEAR)
        if moved.value < found.value + SAME and np.linalg.norm(moved.theta) < np.linalg.norm(found.theta):
            return moved
        near = (near + found.theta) / 2  # nothing changes near the fit, but it does at the case
    return found


def _best(goal: Objective, places: Array, definition: Definition) -> list[Array]:
    """Return the places where the residuals are smallest, of those inside the atlas."""
    residuals = goal.misfit(goal.model.read(places, definition))
    values = np.array([goal.value(place, r) for place, r in zip(places, residuals, strict=True)])
    best = np.argsort(values)[:BEST_STARTS]
    return list(places[best[np.isfinite(values[best])]])


def _places(goal: Objective) -> Array:
    """Return places within a factor of ten of the case, spread evenly, the same each time."""
    from scipy.stats import qmc

    low, high = goal.bounds
    reach = math.log(START_FACTOR)
    low, high = np.maximum(low, -reach), np.minimum(high, reach)
    unit = qmc.Sobol(len(low), seed=20_261_121).random(STARTS)
    return np.asarray(low + (high - low) * unit)


def _nearest(at: Minimum) -> Array:
    """Return the inputs nearest to the case, as any others with the same residuals are an accident of the iteration."""
    rows, _ = at.objective.priors
    _, S, V = np.linalg.svd(np.concatenate([at.jacobian, rows]), full_matrices=True)
    tied = V[np.append(S, np.zeros(len(V)))[: len(V)] <= FLAT * S[0]]
    low, high = at.objective.bounds
    return np.asarray(np.clip(at.theta - tied.T @ (tied @ at.theta), low, high))


def _result(
    at: Minimum,
    ends: Array,
    covariance: Array,
    quantiles: list[float],
    case: Case,
    shift: Array | None,
) -> Fit:
    contact = case.contact
    model, data = at.objective.model, at.objective.model.data
    width = np.sqrt(np.diag(covariance))
    numbers = (each.tolist() for each in (at.theta, width, ends, at.at_bound))
    inputs = tuple(fitted_input(contact.INPUTS, *each) for each in zip(model.free, *numbers, strict=True))
    outcome = outcome_of(at, inputs)
    freedom = max(len(data) - effective_parameters(at), 1.0)
    labels = [each.label for each in inputs]
    weak = undetermined(model.free, labels, at.jacobian, at.prediction)
    with np.errstate(invalid="ignore", divide="ignore"):
        correlation = covariance / np.outer(width, width)
        moved = np.abs(shift) / width if shift is not None else np.array([math.nan])
    contacts = tuple(model.contact_of(k, at.theta) for k in range(len(data.curves)))
    there = (name for free in model.free for name in free.names if getattr(contact, name, None) is not None)
    fitted = {name: value for name in there if (value := getattr(contacts[0], name, None)) is not None}
    errors = at.prediction.error / at.prediction.friction
    return Fit(
        inputs=inputs,
        outcome=outcome,
        contact=contact.replace(**fitted),
        contacts=contacts,
        data=data,
        definition=case.definition,
        law="exponential" if contact.law is None else contact.law.name,
        friction=at.prediction.friction,
        residuals=at.residuals,
        covariance=covariance,
        correlation=correlation,
        noise=at.objective.scale if at.objective.sigma is None else math.nan,
        logarithmic=at.objective.logarithmic,
        robust=at.objective.robust,
        quality=judge_residuals(at, data.curve, freedom),
        undetermined=weak,
        checks=checks_of(Subject(max(contacts, key=lambda each: each.hertz.pressure), case.facts, case.definition), "contact"),
        notes=(
            *data.notes,
            *_scaled(model.free, contact, contacts),
            *notes_of(at, inputs, correlation, covariance, weak, contacts),
        ),
        solver_shift=float(np.nanmax(moved)) if np.isfinite(moved).any() else math.nan,
        model_error=float(errors.max()),
        evaluations=at.evaluations,
        _minimum=at,
        _threshold=quantiles[1],
    )


def _scaled(free: Sequence[FreeInput], contact: Contact, contacts: Sequence[Contact]) -> list[str]:
    """Return the sentence on a surface that was scaled as a whole."""
    if not any(each.also for each in free):
        return []
    fitted = ", ".join(dict.fromkeys(f"{each.beta:.4g}" for each in contacts))
    return [
        f"The roughness scales the surface as a whole, so that beta follows: {contact.beta:.4g} in the case, {fitted} fitted."
    ]
