"""States of many samples of the inputs of a contact: read off the atlas, or between solved ones with their derivatives.

Logarithms of films and viscous friction and log odds of the load share are nearly linear in the logarithms of the inputs.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from stribeck import atlas
from stribeck._types import Array
from stribeck.contacts.contact import Contact
from stribeck.contacts.cut_off import far_film
from stribeck.contacts.friction import Definition
from stribeck.contacts.friction_rules import RULES
from stribeck.contacts.groups import BASE_MODEL, Geometry, Model
from stribeck.contacts.with_parts import models_at_both_sides
from stribeck.curves.sensitivities import Within, with_slopes
from stribeck.equations.point.observables import WITHIN
from stribeck.numerics.dual import Dual, by_logarithms
from stribeck.numerics.scattered import Scattered, lengths_of
from stribeck.quantities.formats import format_percent
from stribeck.quantities.lazy import cached_property
from stribeck.quantities.outputs import GROUPS, OUTPUT_TABLES
from stribeck.quantities.units import InputError
from stribeck.solver.neighbours import Neighbours
from stribeck.solver.solve_error import SolveError

FILM_NAMES = ("central_gap", "minimum_gap", "flux_gap")

LOG_STEP = 1e-3  # Of inputs in differences that find powers of power laws, and derivatives of films at rest

MIN_LOG_DEVIATION = 1e-9  # Standard deviation of a logarithm below which a direction counts as known

# Part of its width within which the ends of the 95 % interval of friction are right: what the pages promise
INTERVAL_END_RTOL = 0.05

MAX_SOLVED_SAMPLES = 120  # Most samples that are solved to hold INTERVAL_END_RTOL

SEED = 20_261_126  # Of the choice of samples that are solved

MIN_SHARE = 1e-290  # Value in place of a share that underflows

AT_REST = 0.0  # The fluid's share of states at rest, which alone have none

SHARES = ("contact_load_share", "fluid_load_share")

VISCOUS, FLUID = 1, 2  # Places of viscous friction and the fluid's share among the observables of a state


def films_of(geometry: Geometry) -> tuple[str, ...]:
    """Return the films that states of a geometry have, of :data:`FILM_NAMES`."""
    return tuple(name for name in FILM_NAMES if name in OUTPUT_TABLES[geometry].names)


class State(NamedTuple):
    """Logarithm of the asperities' share, viscous friction, the fluid's share and :attr:`SampledStates.logs`."""

    values: Array
    slopes: Array  # Derivatives along the moves, shape (moves, values)


@dataclass(frozen=True, eq=False)
class SampledStates:
    """States of samples around a contact: their load share, viscous friction and films."""

    contact: Contact  # The middle of the samples
    moves: Sequence[Mapping[str, float]]  # How far logarithms of inputs move by each of independent standard normal numbers
    of_groups: Array  # Powers with which the moves enter the three groups
    definition: Definition  # Of friction
    rtol: float  # Relative tolerance of solved states

    @cached_property
    def neighbours(self) -> Neighbours:
        """The states that were solved."""
        return Neighbours(self.rtol)

    @property
    def logs(self) -> tuple[str, ...]:
        """What is read as a logarithm: the films, and what asperities rub by where that is not their load."""
        observable = self.contact.friction_of_asperities.observable
        return (*films_of(self.contact.groups.geometry), *(() if observable == SHARES[0] else (observable,)))

    def log_slopes(self, name: str, state: State) -> Array:
        """Return the derivatives of the logarithm of the asperities' share, or of what is read as one, along the moves."""
        return np.asarray(state.slopes[:, 0 if name == SHARES[0] else FLUID + 1 + self.logs.index(name)])

    @cached_property
    def _ends_near(self) -> bool:
        """Whether friction up to where the liquid ends is that of the film itself."""
        groups = self.contact.groups
        inputs = RULES[groups.geometry].of_contact(self.contact)
        return bool(groups.speed > 0) and not RULES[groups.geometry].is_enough(groups.model, [inputs])

    def off_atlas(self, draws: Array) -> dict[str, Array] | None:
        """Return states of standard normal samples off the atlas, None if it does not have them all."""
        groups = self.contact.groups
        is_held = groups.model == BASE_MODEL and self.logs == films_of(groups.geometry) and not self._ends_near
        if not is_held or atlas.for_groups(groups) is None:
            return None
        moved = {name: np.asarray(getattr(groups, name)) for name in GROUPS}
        factors = np.exp(draws @ self.of_groups).T
        samples = replace(groups, **{name: here * each for (name, here), each in zip(moved.items(), factors, strict=True)})
        if not np.all(atlas.covers(samples)):
            return None
        inputs = RULES[groups.geometry].of_contact(self.contact)
        found = {name: np.asarray(getattr(atlas, name)(samples)) for name in self.logs}
        share, viscous = atlas.friction_terms(samples, inputs, self.definition)
        found |= {"contact_load_share": share, "viscous": viscous / inputs["beta"]}
        if not all(np.isfinite(values).all() for values in found.values()):
            return None
        return {name: np.broadcast_to(values, (len(draws),)) for name, values in found.items()}

    def solved(self, draws: Array, friction: Callable[[dict[str, Array]], Array]) -> tuple[dict[str, Array], tuple[str, ...]]:
        """Return states of standard normal samples, read between solved ones, and notes."""
        directions = self._directions()
        lengths = np.linalg.norm(directions * [size_of(move) for move in self.moves], axis=1)
        units, places = directions / lengths[:, None], draws @ directions.T * lengths

        def solved(place: Array) -> State:
            values, slopes = self.at(place @ units)
            return State(values, units @ slopes)

        return _sampled_until_confirmed(places, solved, friction, self.logs)

    def _directions(self) -> Array:
        """Return the combinations of standard normal numbers that move the state, as orthonormal rows."""
        if self.contact.groups.model == BASE_MODEL:
            combined, deviations, _ = np.linalg.svd(self.of_groups, full_matrices=False)
            return np.asarray(combined.T[deviations > MIN_LOG_DEVIATION])
        changed = [any(models_at_both_sides(self.contact, name) is not None for name in move) for move in self.moves]
        return np.asarray(np.eye(len(self.moves))[np.any(self.of_groups != 0, axis=1) | changed])

    def at(self, draw: Array) -> State:
        """Return the state of a sample."""
        contact = self._moved(draw)
        groups = contact.groups
        if not groups.speed > 0:
            return self._at_rest(draw)
        rule = RULES[groups.geometry]
        inputs, names = rule.of_contact(self.contact), rule.parts(self.definition)
        changed = [
            (k, step, change)
            for k, move in enumerate(self.moves if groups.model != BASE_MODEL else ())
            for name, step in move.items()
            if (change := models_at_both_sides(contact, name)) is not None
        ]
        wanted = (*SHARES, *self.logs, *names, *(WITHIN if self._ends_near else ()))
        observed = self.neighbours.observed(groups, wanted, [change for *_, change in changed], inputs=inputs)
        by = dict(zip(wanted, map(Dual, observed.values, observed.slopes), strict=True))
        speed, load = by_logarithms(map(float, (groups.speed, groups.load)), 3 + len(changed))

        def viscous_of(parts: Mapping[str, Any], speed: Any, load: Any, model: Model, within: Within | None = None) -> Any:
            return rule.viscous(parts, speed, load, {**inputs, "far": far_film(model), "within": within}, self.definition)

        within = None
        if self._ends_near:
            within = with_slopes(self.neighbours.at(groups).within, np.array([by[name].slope for name in WITHIN]))
        viscous = viscous_of({name: by[name] for name in names}, speed, load, groups.model, within)
        parts = {name: by[name].value for name in names}
        through = np.zeros(3 + len(changed))  # the film far away
        for i, (*_, (below, above, width)) in enumerate(changed, 3):
            ends = [float(viscous_of(parts, groups.speed, groups.load, each)) for each in (below, above)]
            through[i] = (ends[1] - ends[0]) / width
        drag = Dual(viscous.value, viscous.slope + through) / inputs["beta"]
        found = [_log(by[SHARES[0]]), drag, by[SHARES[1]], *(_log(by[name]) for name in self.logs)]
        slopes = np.array([each.slope for each in found]).T
        along = self.of_groups @ slopes[:3]
        for row, (k, step, _) in zip(slopes[3:], changed, strict=True):
            along[k] += step * row
        return State(np.array([float(each.value) for each in found]), along)

    def _at_rest(self, draw: Array) -> State:
        """Return the state of a contact at rest, whose films alone move with the inputs."""

        def values(draw: Array) -> Array:
            contact = self._moved(draw)
            state = self.neighbours.solution(contact.groups, contact)
            numbers = {name: float(getattr(state, name)) for name in self.logs}
            read = [each if name in FILM_NAMES else math.log(max(each, MIN_SHARE)) for name, each in numbers.items()]
            return np.array([0.0, 0.0, AT_REST, *read])

        steps = np.diag([LOG_STEP / size_of(move) for move in self.moves])
        slopes = [(values(draw + step) - values(draw - step)) / (2 * step.sum()) for step in steps]
        return State(values(draw), np.array(slopes))

    def _moved(self, draw: Array) -> Contact:
        """Return the contact of a sample."""
        logs: dict[str, float] = {}
        for move, number in zip(self.moves, draw.tolist(), strict=True):
            for name, step in move.items():
                logs[name] = logs.get(name, 0.0) + number * step
        return contact_after_move(self.contact, logs)


def contact_after_move(contact: Contact, logs: Mapping[str, float], times: float = 1.0) -> Contact:
    """Return a contact whose inputs have moved by their logarithms."""
    return contact.replace(**{name: getattr(contact, name) * math.exp(times * log) for name, log in logs.items()})


def size_of(move: Mapping[str, float]) -> float:
    """Return how far the logarithm moves that moves farthest."""
    return max(map(abs, move.values()))


def _sampled_until_confirmed(
    places: Array, solved: Callable[[Array], State], friction: Callable[[dict[str, Array]], Array], logs: Sequence[str]
) -> tuple[dict[str, Array], tuple[str, ...]]:
    """Return samples that are read between states, as many as confirm the ends of the interval of friction, and notes."""
    # Each round solves samples at both ends and some anywhere, as many each as fix a plane over the inputs, compares them with
    # what was read there, and reads anew.
    middle = np.zeros(places.shape[1])
    start, some = solved(middle), len(middle) + 1
    size = np.ones_like(start.values)
    size[0] = math.inf  # the share of the fluid tells it
    size[VISCOUS] = abs(start.values[VISCOUS]) or 1.0
    lengths = lengths_of(start.slopes / size)
    known, random = [(middle, start)], np.random.default_rng(SEED)
    tried = np.zeros(len(places), dtype=bool)
    while True:
        found = _read(known, places, lengths, logs)
        predicted = friction(found)
        if not len(middle):
            return found, ()
        low, high = np.quantile(predicted, [0.025, 0.975])
        width, wrong = high - low, 0.0
        near = [np.abs(predicted - end) <= INTERVAL_END_RTOL * width for end in (low, high)]
        for pool in (*near, np.ones_like(tried)):
            left = np.flatnonzero(pool & ~tried)
            chosen = random.choice(left, min(some, len(left)), False).tolist()
            tried[chosen] = True
            new: dict[int, State] = {}
            for i in chosen:
                with suppress(InputError, SolveError, ArithmeticError):  # one that cannot be solved tells nothing
                    new[i] = solved(places[i])
            exact = {name: values.copy() for name, values in found.items()}
            for i, state in new.items():
                for name, values in _by_name(state.values[None], 0.0, logs).items():
                    exact[name][i] = values[0]
            differences = np.abs(friction(exact) - predicted)[list(new)]
            wrong = max(wrong, differences.max(initial=0.0 if new else math.inf))
            known += [(places[i], state) for i, state in new.items()]
        if wrong <= INTERVAL_END_RTOL * width or tried.sum() + 3 * some > MAX_SOLVED_SAMPLES:
            # Not as read once more, between all of them: that may be far off, and nothing would tell.
            return found, _interval_notes(wrong / width if width else 0.0, int(tried.sum()), len(known) - 1)


def _read(known: Sequence[tuple[Array, State]], places: Array, lengths: Array, logs: Sequence[str]) -> dict[str, Array]:
    """Return states at places, read between known ones."""
    signs = {float(np.sign(state.values[VISCOUS])) for _, state in known}
    sign = signs.pop() if len(signs) == 1 else 0.0  # a drag that changes its sign has no logarithm
    have_odds = all(state.values[FLUID] > 0 for _, state in known)  # shares have none where the fluid sucks
    scattered = Scattered(lengths)
    for place, (values, slopes) in known:
        y, by = values.copy(), slopes.copy()
        if sign:
            y[VISCOUS] = math.log(abs(values[VISCOUS]))
            by[:, VISCOUS] /= values[VISCOUS]
        if have_odds:
            fluid = _log(Dual(values[FLUID], slopes[:, FLUID]))
            y[0] -= fluid.value
            by[:, 0] -= fluid.slope
        scattered.add(place, y, by)
    found = scattered.values(places)
    if have_odds:
        found[:, 0] = -np.logaddexp(0.0, -found[:, 0])
    return _by_name(found, sign, logs)


def _by_name(y: Array, sign: float, logs: Sequence[str]) -> dict[str, Array]:
    """Return load share, viscous friction and what is read as logarithms."""
    share, viscous, fluid, *films = y.T
    at_rest = np.all(fluid == AT_REST)
    return {
        "contact_load_share": np.exp(share),
        "viscous": sign * np.exp(viscous) if sign else viscous,
        # Films at rest pass through zero.
        **{name: film if at_rest and name in FILM_NAMES else np.exp(film) for name, film in zip(logs, films, strict=True)},
    }


def _interval_notes(wrong: float, tried: int, solved: int) -> tuple[str, ...]:
    """Return notes on an interval with uncertain ends, and on samples that cannot be solved."""
    notes = []
    if wrong > INTERVAL_END_RTOL:
        apart = f"lie up to {format_percent(wrong)} of its width" if math.isfinite(wrong) else "cannot be solved or lie far"
        notes.append(
            f"The interval of friction is not settled: after {solved} solved samples, states {apart} from where they are "
            f"predicted, not within {format_percent(INTERVAL_END_RTOL)}. Its ends are as uncertain; smaller errors of the "
            "inputs, or states solved one by one at their ends, say more."
        )
    if solved < tried:
        notes.append(
            f"{tried - solved} of {tried} samples that were tried cannot be solved: the errors of the inputs reach contacts "
            "beyond what this package solves, and there the intervals rest on those nearby. Smaller errors stay within."
        )
    return tuple(notes)


def _log(value: Dual) -> Dual:
    """Return the logarithm of a positive number, constant where it underflows."""
    return (
        Dual(math.log(value.value), value.slope / value.value)
        if value.value > MIN_SHARE
        else Dual(math.log(MIN_SHARE), 0.0 * value.slope)
    )
