r"""States of many samples of the groups: read off the atlas, or off seven solved states around the middle.

Where the atlas ends, a quadratic along each principal axis of the samples takes its place,

.. math:: y = y_0 + b_k t_k + c_k t_k^2, \qquad t_k = \pm 3^{1/2} \text{ solved},

for the logarithms of films and viscous friction and the log odds of the load share.  The numbers of a fluid or a solid in
Hertz units change with the inputs, so that the three groups do not describe such a state: the axes are then the inputs.
"""

from __future__ import annotations

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
from stribeck.contacts.groups import Geometry, Groups
from stribeck.quantities.formats import format_percent
from stribeck.quantities.outputs import GROUPS, OUTPUT_TABLES
from stribeck.quantities.units import InputError
from stribeck.solver.neighbours import Neighbours
from stribeck.solver.solve_error import SolveError

__all__ = ["FILM_NAMES", "SampledStates", "films_of"]

FILM_NAMES = ("central_gap", "minimum_gap", "flux_gap")

NODE_DEVIATION = 3**0.5  # Where the quadratic is solved, in standard deviations: the outer nodes of Gauss and Hermite

MAX_DEVIATION = 3.5  # Standard deviations beyond which a quadratic is held constant

MIN_LOG_DEVIATION = 1e-9  # Standard deviation of a logarithm below which a direction counts as known

VISCOUS_INDEX = 1  # Place of the viscous friction in the values of a state

# Part of its width within which the ends of the 95 % interval of friction are right: what the pages promise
INTERVAL_END_RTOL = 0.05

MAX_SOLVED_SAMPLES = 120  # Most samples that are solved to hold INTERVAL_END_RTOL

SEED = 20_261_126  # Of the choice of samples that are solved

MIN_SHARE = 1e-290  # Value in place of a share that underflows


def films_of(geometry: Geometry) -> tuple[str, ...]:
    """Return the films that states of a geometry have, of :data:`FILM_NAMES`."""
    return tuple(name for name in FILM_NAMES if name in OUTPUT_TABLES[geometry].names)


@dataclass(frozen=True, eq=False)
class SampledStates:
    """States of samples around a contact: their load share, viscous friction and films."""

    contact: Contact  # The middle of the samples
    definition: Definition  # Of friction
    rtol: float  # Relative tolerance of solved states
    friction: Callable[[dict[str, Array]], Array]  # States of the samples -> friction coefficients

    def by_groups(self, offsets: Array) -> tuple[dict[str, Array], str, tuple[str, ...]]:
        """Return states of samples of the groups, off the atlas where it has them, the method, and notes."""
        groups = self.contact.groups
        table = atlas.for_groups(groups)
        if table is not None:
            samples = _scale_groups(groups, offsets)
            if bool(np.all(atlas.covers(samples))):
                inputs = RULES[groups.geometry].of_contact(self.contact)
                films = [name for name in FILM_NAMES if name != "flux_gap" or name in table.functions]
                found = {name: np.asarray(getattr(atlas, name)(samples)) for name in films}
                share, viscous = atlas.friction_terms(samples, inputs, self.definition)
                found |= {"contact_load_share": share, "viscous": viscous / inputs["beta"]}
                if all(np.isfinite(values).all() for values in found.values()):
                    return {name: np.broadcast_to(values, (len(offsets),)) for name, values in found.items()}, "atlas", ()
        states, notes = self.by_solved_groups(offsets)
        return states, "solver", notes

    def by_solved_groups(self, offsets: Array) -> tuple[dict[str, Array], tuple[str, ...]]:
        """Return states of samples of the groups, by quadratics along their principal axes, and notes."""
        groups, neighbours, middle = self.contact.groups, Neighbours(self.rtol), offsets.mean(axis=0)
        variances, directions = np.linalg.eigh(np.atleast_2d(np.cov(offsets.T)))

        def values(distance: Array) -> Array:
            state = neighbours.solution(_scale_groups(groups, middle + distance))
            return _values(state, self.definition, self.contact)

        axes = []
        for variance, direction in zip(variances, directions.T, strict=True):
            width = float(np.sqrt(max(variance, 0.0)))
            if width >= MIN_LOG_DEVIATION:
                node = NODE_DEVIATION * width * direction
                axes.append(((offsets - middle) @ direction / width, values(node), values(-node)))
        found = _quadratic(values(np.zeros(3)), axes, groups.geometry, len(offsets))
        if not axes:
            return found.values(), ()
        places = np.stack([place for place, *_ in axes], axis=1)
        return _correct_by_solved_states(found, places, lambda i: values(offsets[i] - middle), self.friction)

    def by_inputs(
        self, moves: Sequence[tuple[str, ...]], sigmas: Array, draws: Array
    ) -> tuple[dict[str, Array], tuple[str, ...]]:
        """Return states of samples of the inputs, by quadratics along each, and notes; inputs of one move move together."""
        contact, neighbours = self.contact, Neighbours(self.rtol)

        def at(distances: Mapping[str, float]) -> Array:
            moved = contact.replace(**{name: getattr(contact, name) * math.exp(each) for name, each in distances.items()})
            return _values(neighbours.solution(moved.groups, moved), self.definition, contact)

        def values(inputs: tuple[str, ...] = (), distance: float = 0.0) -> Array:
            return at(dict.fromkeys(inputs, distance))

        def sample(i: int) -> Array:
            distances: dict[str, float] = {}
            for inputs, distance in zip(moves, (draws[i] * sigmas).tolist(), strict=True):
                for name in inputs:
                    distances[name] = distances.get(name, 0.0) + distance
            return at(distances)

        start = values()
        axes = [
            (draws[:, i], values(inputs, NODE_DEVIATION * sigma), values(inputs, -NODE_DEVIATION * sigma))
            for i, (inputs, sigma) in enumerate(zip(moves, sigmas.tolist(), strict=True))
        ]
        found = _quadratic(start, axes, contact.groups.geometry, len(draws))
        return _correct_by_solved_states(found, draws, sample, self.friction)


class _Samples(NamedTuple):
    """Logarithms and log odds of states, which are nearly quadratic in the inputs."""

    y: Array
    sign: float
    is_power: bool
    geometry: Geometry

    def of_state(self, values: Array) -> Array:
        """Return the row of a solved state."""
        row = values.copy()
        if self.is_power:
            row[VISCOUS_INDEX] = np.log(max(self.sign * row[VISCOUS_INDEX], MIN_SHARE))
        return row

    def values(self) -> dict[str, Array]:
        """Return load share, viscous friction and films."""
        odds, viscous, *films = self.y.T
        return {
            "contact_load_share": 1 / (1 + np.exp(-np.clip(odds, -700, 700))),
            "viscous": self.sign * np.exp(viscous) if self.is_power else viscous,
            **{name: np.exp(film) for name, film in zip(films_of(self.geometry), films, strict=True)},
        }


def _correct_by_solved_states(
    base: _Samples, places: Array, solved: Callable[[int], Array], friction: Callable[[dict[str, Array]], Array]
) -> tuple[dict[str, Array], tuple[str, ...]]:
    """Return samples corrected until solved states confirm the ends of the interval of friction, and notes where none do."""
    # Each round solves samples at both ends and some anywhere, as many each as fix a plane over the inputs. A sample that
    # is not as predicted joins the states through which a smooth function corrects the quadratics.
    from scipy.interpolate import RBFInterpolator

    found, known, random = base, dict[int, Array](), np.random.default_rng(SEED)
    some = places.shape[1] + 1
    tried = np.zeros(len(places), dtype=bool)
    while True:
        predicted = friction(found.values())
        low, high = np.quantile(predicted, [0.025, 0.975])
        width, wrong = high - low, 0.0
        near = [np.abs(predicted - end) <= INTERVAL_END_RTOL * width for end in (low, high)]
        for pool in (*near, np.ones_like(tried)):
            left = np.flatnonzero(pool & ~tried)
            chosen = random.choice(left, min(some, len(left)), False).tolist()
            tried[chosen] = True
            new: dict[int, Array] = {}
            for i in chosen:
                with suppress(InputError, SolveError):  # one that cannot be solved tells nothing
                    new[i] = base.of_state(solved(i))
            exact = found.y.copy()
            exact[list(new)] = np.array(list(new.values())).reshape(-1, exact.shape[1])
            differences = np.abs(friction(found._replace(y=exact).values()) - predicted)[list(new)]
            wrong = max(wrong, differences.max(initial=0.0 if new else math.inf))
            known |= new
        if wrong <= INTERVAL_END_RTOL * width or tried.sum() + 3 * some > MAX_SOLVED_SAMPLES:
            return found.values(), _interval_notes(wrong / width if width else 0.0, int(tried.sum()), len(known))
        rows = list(known)
        rest = np.array([known[i] - base.y[i] for i in rows]).reshape(-1, base.y.shape[1])
        # The middle is known too; the smooth function leaves it where it is.
        centres = np.vstack([np.zeros(places.shape[1]), places[rows]])
        smooth = RBFInterpolator(centres, np.vstack([np.zeros(rest.shape[1]), rest]), kernel="linear", degree=0)
        found = base._replace(y=base.y + smooth(places))


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


def _quadratic(start: Array, axes: Sequence[tuple[Array, Array, Array]], geometry: Geometry, number: int) -> _Samples:
    """Return the quadratics through the middle and two states on each axis, at the places of samples along the axes."""
    every = [start, *(each for _, *pair in axes for each in pair)]
    sign = np.sign(start[VISCOUS_INDEX])
    is_power = all(sign * each[VISCOUS_INDEX] > 0 for each in every)  # a drag that changes its sign is none
    for each in every if is_power else []:
        each[VISCOUS_INDEX] = np.log(sign * each[VISCOUS_INDEX])
    y = np.tile(start, (number, 1))
    for places, ahead, behind in axes:
        t = np.clip(places, -MAX_DEVIATION, MAX_DEVIATION)[:, None]
        y += (ahead - behind) / (2 * NODE_DEVIATION) * t + (ahead + behind - 2 * start) / (2 * NODE_DEVIATION**2) * t**2
    return _Samples(y, float(sign), is_power, geometry)


def _values(state: Any, definition: Definition, of: Contact | None) -> Array:
    """Return the log odds of the load share, the viscous friction and the logarithms of films of a solved state."""
    contact, fluid = max(state.contact_load_share, MIN_SHARE), max(state.fluid_load_share, MIN_SHARE)
    rule = RULES[state.groups.geometry]
    inputs = rule.of_contact(of)
    parts = {name: float(getattr(state, name)) for name in rule.parts(definition)}
    given = {**inputs, "far": far_film(state.groups.model)}
    viscous = float(rule.viscous(parts, state.groups.speed, state.groups.load, given, definition)) / inputs["beta"]
    films = [float(getattr(state, name)) for name in films_of(state.groups.geometry)]
    return np.array([np.log(contact / fluid), viscous, *np.log([max(value, MIN_SHARE) for value in films])])


def _scale_groups(groups: Groups, offsets: Array) -> Groups:
    factors = np.exp(offsets)
    speed, load, roughness = (np.asarray(getattr(groups, name)) * factors[..., i] for i, name in enumerate(GROUPS))
    if np.ndim(factors) == 1:
        return replace(groups, speed=float(speed), load=float(load), roughness=float(roughness))
    return replace(groups, speed=speed, load=load, roughness=roughness)
