"""Errors of the inputs, propagated to friction, films, transitions and the probability of each regime."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from stribeck._types import Array
from stribeck.contacts.contact import Contact
from stribeck.contacts.cut_off import far_film
from stribeck.contacts.friction import REGIMES, Definition, check_definition, friction_share, regime_numbers
from stribeck.contacts.friction_rules import RULES
from stribeck.contacts.inputs import follows_surface, typical_errors
from stribeck.contacts.parts import PART_INPUTS
from stribeck.curves.coordinate import Over
from stribeck.curves.regime import Transition
from stribeck.curves.sensitivities import with_slopes
from stribeck.curves.stribeck_curve import stribeck_curve
from stribeck.equations.point.observables import WITHIN
from stribeck.numerics.dual import by_logarithms
from stribeck.numerics.threads import one_blas_thread
from stribeck.quantities.formats import format_si
from stribeck.quantities.keywords import known_names
from stribeck.quantities.outcome import Outcome
from stribeck.quantities.outputs import GROUPS
from stribeck.quantities.schema import Input, relative_error
from stribeck.quantities.standard_errors import INTERVAL_95, StandardErrors
from stribeck.quantities.units import InputError, checked_kind, show
from stribeck.solver.solve_error import SolveError
from stribeck.uncertainty.result import Spread, Uncertainty
from stribeck.uncertainty.states import LOG_STEP, VISCOUS, SampledStates, contact_after_move, films_of, size_of

SAMPLES = 20_000  # Random samples of the inputs
SEED = 20261122  # Fixed, so that results repeat

STATE_RTOL = {"line": 1e-5, "point": 1e-4}  # By geometry: a ball takes a tenth of a second or more for each state

CURVE_POINTS = 21  # Points of the curve on which transitions lie

LINEAR_CHANGE = math.log(2.0)  # Change of the logarithm of a speed up to which it is as large to the other side


@one_blas_thread
def propagate(
    contact: Contact,
    errors: Mapping[str, Any] | Literal["typical"],
    *,
    definition: Definition = "balanced",
    transitions: bool = True,
) -> Uncertainty:
    r"""Propagate errors of the inputs of a contact to its state.

    .. math:: \ln X_k \sim \mathcal N(\ln x_k, \sigma_k^2), \qquad \sigma_k^2 = \ln(1 + \epsilon_k^2)

    for each input of value x and standard error :math:`\epsilon x`; independent of one another but for the correlations of
    their logarithms that errors of a case or a fit bring (:class:`stribeck.results.StandardErrors`).

    Parameters
    ----------
    contact : Contact
        The contact.
    errors : mapping or "typical"
        Standard error of each uncertain input: a number over the value (0.2 is 20 %), or text, ``"20 %"`` or ``"0.2 um"``.
        Numbers of the fluid and the solid are among the inputs, as ``relaxation_time`` or ``layer_thickness``.
        ``case.errors`` and ``fit.errors`` are such mappings.
        ``"typical"`` takes the usual ones of inputs that nobody measured on the contact itself (docs/data_sheet.md).
    definition : {"balanced", "published"}
        Definition of the viscous friction.
    transitions : bool
        Whether minimum and transitions are looked for too, a curve for each uncertain input; never of a ball.

    Returns
    -------
    Uncertainty
        Medians, intervals, the probability of each regime, and the share of each input in the variance of friction.

    Raises
    ------
    InputError
        If an input is unknown, its error no positive number, or so large that the input leaves its range.
    SolveError
        If a state cannot be solved.

    Notes
    -----
    20 000 samples, the same in every call, are read off the atlas, or between up to 120 solved states with derivatives, at
    both ends of the interval of friction and anywhere, until further ones lie within 5 % of its width of where they are read
    (``test_data_sheet.py``); ``notes`` say where they do not.  Transitions move to either side as far as by one standard
    error of each input alone, and are left out where that loses them or their interval leaves the speeds that were searched.
    With Persson's law ``beta`` follows the roughness unless it has an error.

    Examples
    --------
    >>> import stribeck as sb
    >>> contact = sb.LineContact(radius=0.01, modulus=2.7e6, load=30, viscosity=0.05, speed=0.02, roughness=1e-6, alpha=2,
    ...                          beta=0.06, boundary_friction=0.7)
    >>> low, high = sb.propagate(contact, {"roughness": "20 %", "beta": 0.3}, transitions=False)["friction"].interval_95
    >>> print(f"{low:.2f} to {high:.2f}")
    0.03 to 0.10
    """
    definition = check_definition(definition)
    checked_kind("contact", contact, Contact, "a LineContact or PointContact")
    checked_kind("transitions", transitions, (bool, np.bool_), "True or False")
    sigmas = errors_of_kept_inputs(contact, errors)
    if not sigmas:
        raise InputError("errors is empty; name the inputs that are not exact, such as {'load': 0.05}.")
    draws = np.random.default_rng(SEED).standard_normal((SAMPLES, len(sigmas)))
    moves = moves_of(contact, sigmas)

    def power(function: Any) -> Array:
        """Return the powers with which the moves enter a power law."""
        return np.array([_power(contact, function, move) for move in moves.values()]).reshape(len(moves), -1)

    groups = contact.groups
    of_groups = power(lambda each: [float(getattr(each.groups, name)) for name in GROUPS])
    sampled = SampledStates(contact, tuple(moves.values()), of_groups, definition, STATE_RTOL[groups.geometry])
    solution = sampled.neighbours.solution(groups, contact)
    rule = RULES[groups.geometry]
    inputs = rule.of_contact(contact)

    def scale(function: Any) -> Array:
        return np.asarray(function(contact) * np.exp(draws @ power(lambda each: [function(each)])[:, 0]))

    asperities = contact.friction_of_asperities
    of_rubbing = power(lambda each: [each.friction_of_asperities.factor(each)])[:, 0]
    of_shearing = np.zeros(len(moves))
    for name, exponent in _exponents(solution, inputs, definition).items():
        of_shearing += exponent * power(lambda each, name=name: [rule.inputs[name](each)])[:, 0]
    rub = rule.sliding_factor(groups, inputs) * asperities.factor(contact)
    rubbing, shearing = rub * np.exp(draws @ of_rubbing), contact.beta * np.exp(draws @ of_shearing)

    def friction_of(states: dict[str, Array]) -> Array:
        return np.asarray(rubbing * states[asperities.observable] + shearing * states["viscous"])

    notes: tuple[str, ...] = ()
    states, method = sampled.off_atlas(draws), "atlas"
    if states is None:
        method = "solver"
        states, notes = sampled.solved(draws, friction_of)
    share = states["contact_load_share"]
    dry, viscous, friction = rubbing * states[asperities.observable], shearing * states["viscous"], friction_of(states)
    given = solution.friction(definition=definition)
    labels = {row.name: row.label for row in solution.outputs.rows}
    films = {row.name: row.film for row in solution.outputs.rows}
    spreads = [
        _spread("friction", f"friction coefficient, {definition}", given.total, friction),
        _spread("contact_load_share", labels["contact_load_share"], solution.contact_load_share, share),
        _spread("fluid_load_share", labels["fluid_load_share"], solution.fluid_load_share, 1 - share),
    ]
    height = scale(lambda each: each.hertz.indentation)
    for name in films_of(groups.geometry):
        value = float(getattr(solution, name)) * contact.hertz.indentation
        spreads.append(_spread(films[name], labels[name], value, states[name] * height, "length"))
    if contact.roughness > 0:
        ratio = states["minimum_gap"] * height / scale(lambda each: each.roughness)
        spreads.append(_spread("lambda_ratio", labels["lambda_ratio"], solution.lambda_ratio, ratio))
    if transitions and contact.speed > 0 and groups.geometry == "line":
        spreads += _transitions(contact, sigmas, definition)
    middle = sampled.at(np.zeros(len(moves)))
    amount, by_drag = asperities.amount(solution)[0], middle.slopes[:, VISCOUS]
    slopes = rub * amount * (sampled.log_slopes(asperities.observable, middle) + of_rubbing)
    slopes += contact.beta * (by_drag + middle.values[VISCOUS] * of_shearing)
    parts = dict(zip(moves, (slopes**2).tolist(), strict=True))
    total = sum(parts.values()) or 1.0
    regime_of_samples = regime_numbers(1 - share, friction_share(dry, viscous))
    return Uncertainty(
        contact=contact,
        errors=StandardErrors({name: math.sqrt(math.expm1(sigma**2)) for name, sigma in sigmas.items()}, sigmas.nested),
        spreads=tuple(spreads),
        regimes={name: float((regime_of_samples == number).mean()) for number, name in enumerate(REGIMES)},
        contributions={name: part / total for name, part in sorted(parts.items(), key=lambda pair: -pair[1])},
        method=method,
        notes=notes,
        definition=definition,
    )


def errors_of_kept_inputs(contact: Contact, errors: Mapping[str, Any] | Literal["typical"]) -> StandardErrors:
    """Return the standard error of the logarithm of each uncertain input that a contact keeps."""
    if errors == "typical":
        errors = typical_errors(contact, ())
    checked_kind("errors", errors, Mapping, "a mapping of inputs to their errors, such as {'load': 0.05}, or 'typical'")
    rows = contact.INPUTS.rows
    found: dict[str, float] = {}
    for name, error in errors.items():
        value = getattr(contact, name, None) if name in rows else None
        if name in contact.INPUTS.stands_for:
            instead = contact.INPUTS.stands_for[name]
            raise InputError(f"errors has {name}, which no contact keeps; give the error of {instead}, which follows from it.")
        if value is None and name in PART_INPUTS:
            raise InputError(f"errors has {name}, but this contact has none: it belongs to {PART_INPUTS[name].of}.")
        if value is None:
            raise InputError(f"errors has {show(name)}, which is no input of a contact; {known_names(name, rows)}")
        if value == 0:
            raise InputError(f"errors has {name}, which is zero: a relative error of zero has no meaning.")
        if isinstance(error, str) or hasattr(error, "magnitude"):
            relative = relative_error(name, value, error, rows[name].dimension)
        elif isinstance(error, bool) or not isinstance(error, int | float) or not 0 < error < 3:
            raise InputError(f"the error of {name} = {show(error)} must be a number such as 0.2, which is 20 %, or text.")
        else:
            relative = float(error)
        found[name] = math.sqrt(math.log1p(relative**2))
    for name in found.keys() & PART_INPUTS.keys():
        _check_range(PART_INPUTS[name], getattr(contact, name), found[name])
    return StandardErrors({name: found[name] for name in rows if name in found}, getattr(errors, "nested", None))


def _check_range(row: Input, value: float, sigma: float) -> None:
    """Refuse an error with which the 95 % interval of a number leaves its range."""
    low, high = row.range
    for end, bound in ((value * math.exp(-INTERVAL_95 * sigma), low), (value * math.exp(INTERVAL_95 * sigma), high)):
        if not low <= end <= high:
            raise InputError(
                f"the error of {row.name} = {format_si(value, row.dimension, 3)} is too large: its 95 % interval reaches "
                f"{end:.3g}, past its bound {bound:g}; give a smaller one."
            )


def moves_of(contact: Contact, sigmas: StandardErrors) -> dict[str, dict[str, float]]:
    """Return the independent moves of the logarithms of uncertain inputs, each by the first input that it moves."""
    names, steps = list(sigmas), np.array([*sigmas.values()])[:, None] * np.linalg.cholesky(sigmas.matrix)
    moves = {name: dict(zip(names[k:], steps[k:, k].tolist(), strict=True)) for k, name in enumerate(names)}
    if follows_surface(contact, sigmas):
        for move in moves.values():
            if "roughness" in move:
                move["beta"] = move["roughness"]
    return {name: {each: step for each, step in move.items() if step != 0} for name, move in moves.items()}


def _exponents(solution: Any, inputs: Mapping[str, float], definition: Definition) -> dict[str, float]:
    """Return the powers with which beta, motion and liquid enter the viscous friction of a state beside its groups."""
    groups, rule = solution.groups, RULES[solution.groups.geometry]
    parts = {name: float(getattr(solution, name)) for name in rule.parts(definition)}
    own = getattr(solution.observables, "_within", None)
    if not groups.speed > 0:
        return {}
    finite = {name: value for name, value in inputs.items() if 0 < value < math.inf}
    moved = dict(zip(finite, by_logarithms(finite.values(), len(finite)), strict=True))
    within = None if own is None else with_slopes(own, np.zeros((len(WITHIN), len(finite))))
    given = {**inputs, **moved, "far": far_film(groups.model), "within": within}
    here = rule.viscous(parts, groups.speed, groups.load, given, definition)
    return dict(zip(finite, (here.slope / here.value).tolist(), strict=True))


def _power(contact: Contact, function: Any, move: Mapping[str, float]) -> list[float]:
    """Return the derivatives of logarithms of functions that are power laws along a move, zero where they are zero."""
    step = LOG_STEP / size_of(move)
    pairs = zip(function(contact), function(contact_after_move(contact, move, step)), strict=True)
    return [math.log(after / before) / step if before > 0 else 0.0 for before, after in pairs]


def _spread(name: str, label: str, value: float, samples: Array, dimension: str = "number") -> Spread:
    low_95, low_68, median, high_68, high_95 = np.quantile(samples, [0.025, 0.16, 0.5, 0.84, 0.975]).tolist()
    return Spread(name, label, float(value), median, (low_68, high_68), (low_95, high_95), dimension)


def _transitions(contact: Contact, sigmas: StandardErrors, definition: Definition) -> list[Spread]:
    """Return the speeds of minimum and transitions, moved to either side as far as by each input alone."""

    def marks(each: Contact) -> tuple[dict[str, float], Array]:
        curve = stribeck_curve(each, points=CURVE_POINTS, rtol=1e-3, definition=definition)
        if curve.outcome is Outcome.INTERRUPTED:
            raise KeyboardInterrupt
        return {mark.name: mark.value for mark in curve.transitions}, curve.values[[0, -1]]

    start, searched = marks(contact)
    falls, rises = dict.fromkeys(start, 0.0), dict.fromkeys(start, 0.0)  # Variances of the logarithm to either side

    def changes(move: Mapping[str, float], steps: float) -> list[float]:
        """Return the changes of the logarithms, nan where a mark is lost."""
        there, _ = marks(contact_after_move(contact, move, steps))
        return [math.log(there[mark] / value) if mark in there else math.nan for mark, value in start.items()]

    for move in moves_of(contact, sigmas).values():
        if move.keys() == {"speed"}:
            continue
        more = changes(move, 1.0)
        less = [-each for each in more] if all(abs(each) < LINEAR_CHANGE for each in more) else changes(move, -1.0)
        for mark, change in zip((*start, *start), (*more, *less), strict=True):
            falls[mark] += change**2 if change < 0 else 0.0 if change >= 0 else math.inf
            rises[mark] += change**2 if change > 0 else 0.0
    found = []
    for mark, value in start.items():
        below, above = math.sqrt(falls[mark]), math.sqrt(rises[mark])
        (low, high), (lowest, highest) = (
            (value * math.exp(-z * below), value * math.exp(z * above)) for z in (1.0, INTERVAL_95)
        )
        if not searched[0] <= lowest <= highest <= searched[1]:
            continue  # it may lie anywhere beyond the speeds that were searched
        label = f"speed of the {mark}" if mark == Transition.MINIMUM else f"speed where {mark}"
        found.append(Spread(mark, label, value, value, (low, high), (lowest, highest), "speed"))
    return found


# Points at which errors are propagated, by geometry: between them the ends of intervals are smooth in the logarithm
BAND_POINTS = {"line": 13, "point": 7}


@dataclass(frozen=True, eq=False)
class Band:
    """The 95 % interval of the friction along a curve."""

    values: Array  # Speeds, loads or roughnesses at which errors were propagated, in SI units
    low: Array  # Lower end of the interval over the friction for the inputs as given [-]; nan where it is not settled
    high: Array  # Upper end of the same

    def along(self, values: Array, friction: Array) -> tuple[Array, Array]:
        """Return the ends of the interval of friction at other places."""
        at, known = np.log(values), np.log(self.values)
        low, high = (friction * np.interp(at, known, part, left=np.nan, right=np.nan) for part in (self.low, self.high))
        return low, high


def friction_band(
    contact: Contact,
    errors: Mapping[str, Any],
    ends: Sequence[float] | Array,
    definition: Definition = "balanced",
    over: Over = "speed",
    *,
    on_point: Callable[[int, int], object] | None = None,
) -> Band | None:
    """Return the 95 % interval of friction between two speeds, loads or roughnesses, as ``propagate`` has it."""
    count = BAND_POINTS[contact.groups.geometry]
    found = []
    for i, value in enumerate(np.geomspace(ends[0], ends[1], count).tolist()):
        try:
            state = propagate(contact.replace(**{over: value}), errors, definition=definition, transitions=False)
        except (InputError, SolveError):
            continue
        finally:
            if on_point is not None:
                on_point(i + 1, count)
        spread = state["friction"]
        if state.notes:  # a picture has no place to say by how much its ends are wrong
            found.append((value, math.nan, math.nan))
        elif spread.value != 0:
            low, high = sorted(end / spread.value for end in spread.interval_95)
            found.append((value, max(low, 0.0), high))
    return Band(*np.array(found).T) if sum(not math.isnan(low) for _, low, _ in found) > 1 else None
