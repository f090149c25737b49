r"""States of many samples of the groups: read off the atlas, or off seven solved states around the middle.

Where the atlas ends, a quadratic along each principal axis of the samples takes its place,

.. math:: y = y_0 + b_k t_k + c_k t_k^2, \qquad t_k = \pm 3^{1/2} \text{ solved},

for the logarithms of films and viscous friction and the log odds of the load share.  The numbers of a fluid or a solid in
Hertz units change with the inputs, so that the three groups do not describe such a state: the axes are then the inputs.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from stribeck import atlas
from stribeck._types import Array
from stribeck.contacts.contact import Contact
from stribeck.contacts.cut_off import far_film
from stribeck.contacts.friction import Definition
from stribeck.contacts.friction_rules import RULES
from stribeck.contacts.groups import Geometry
from stribeck.contacts.line import Groups
from stribeck.quantities.outputs import OUTPUT_TABLES
from stribeck.solver.solve import solve

__all__ = ["NAMES", "films_of", "states_by_inputs", "states_of"]

NAMES = ("central_gap", "minimum_gap", "flux_gap")
"""The films of a state."""

NODE = 3**0.5
"""Where the quadratic is solved, in standard deviations: the outer nodes of Gauss and Hermite."""

FARTHEST = 3.5
"""Standard deviations beyond which a quadratic is held."""

NARROW = 1e-9
"""Standard deviation of a logarithm below which a direction counts as known."""

VISCOUS = 1
"""Place of the viscous friction in the values of a state."""

TINY = 1e-290
"""Value in place of a share that underflows."""


def films_of(geometry: Geometry) -> tuple[str, ...]:
    """Return the films that states of a geometry have, of :data:`NAMES`.

    Parameters
    ----------
    geometry : {"line", "point"}
        The geometry.

    Returns
    -------
    tuple of str
        Their names.
    """
    return tuple(name for name in NAMES if name in OUTPUT_TABLES[geometry].names)


def states_of(
    groups: Groups, offsets: Array, definition: Definition, rtol: float, contact: Contact | None = None
) -> tuple[dict[str, Array], str]:
    """Return load share, viscous friction and films of samples.

    Parameters
    ----------
    groups : Groups
        The middle.
    offsets : ndarray, shape (n, 3)
        Logarithms of each sample's groups of speed, load and roughness over those in the middle.
    definition : {"balanced", "published"}
        Definition of the viscous friction.
    rtol : float
        Relative tolerance of solved states.
    contact : Contact, optional
        Whose beta, motion and liquid the viscous friction of a ball takes.

    Returns
    -------
    dict of str to ndarray, shape (n,)
        ``contact_load_share``, ``viscous``, which is over beta, and the films of :func:`films_of`.
    str
        ``"atlas"`` or ``"solver"``.
    """
    table = atlas.for_groups(groups)
    if table is not None:
        samples = _moved(groups, offsets)
        if bool(np.all(atlas.covers(samples))):
            inputs = RULES[groups.geometry].of_contact(contact)
            films = [name for name in NAMES if name != "flux_gap" or name in table.functions]
            found = {name: np.asarray(getattr(atlas, name)(samples)) for name in films}
            share, viscous = atlas.friction_terms(samples, inputs, definition)
            found |= {"contact_load_share": share, "viscous": viscous / inputs["beta"]}
            if all(np.isfinite(values).all() for values in found.values()):
                return {name: np.broadcast_to(values, (len(offsets),)) for name, values in found.items()}, "atlas"
    return _by_quadratics(groups, offsets, definition, rtol, contact), "solver"


def states_by_inputs(
    contact: Contact, moves: Sequence[tuple[str, ...]], sigmas: Array, draws: Array, definition: Definition, rtol: float
) -> dict[str, Array]:
    """Return load share, viscous friction and films of samples of the inputs, from two solved states for each of them.

    Parameters
    ----------
    contact : Contact
        The contact in the middle.
    moves : sequence of tuple of str
        The inputs that move together, for each independent one.
    sigmas : ndarray, shape (m,)
        Standard deviation of the logarithm of each.
    draws : ndarray, shape (n, m)
        The samples, in standard deviations.
    definition : {"balanced", "published"}
        Definition of the viscous friction.
    rtol : float
        Relative tolerance of solved states.

    Returns
    -------
    dict of str to ndarray, shape (n,)
        As :func:`states_of` returns them.
    """

    def values(inputs: tuple[str, ...] = (), distance: float = 0.0) -> Array:
        moved = contact.replace(**{name: getattr(contact, name) * math.exp(distance) for name in inputs})
        return _values(solve(moved, rtol=rtol), definition, contact)

    start = values()
    axes = [
        (draws[:, i], values(inputs, NODE * sigma), values(inputs, -NODE * sigma))
        for i, (inputs, sigma) in enumerate(zip(moves, sigmas.tolist(), strict=True))
    ]
    return _quadratic(start, axes, contact.groups.geometry, len(draws))


def _by_quadratics(
    groups: Groups, offsets: Array, definition: Definition, rtol: float, contact: Contact | None = None
) -> dict[str, Array]:
    middle = offsets.mean(axis=0)
    variances, directions = np.linalg.eigh(np.atleast_2d(np.cov(offsets.T)))

    def values(distance: Array) -> Array:
        return _values(solve(_moved(groups, middle + distance), rtol=rtol), definition, contact)

    axes = []
    for variance, direction in zip(variances, directions.T, strict=True):
        width = float(np.sqrt(max(variance, 0.0)))
        if width >= NARROW:
            node = NODE * width * direction
            axes.append(((offsets - middle) @ direction / width, values(node), values(-node)))
    return _quadratic(values(np.zeros(3)), axes, groups.geometry, len(offsets))


def _quadratic(start: Array, axes: Sequence[tuple[Array, Array, Array]], geometry: Geometry, number: int) -> dict[str, Array]:
    """Return the quadratics through the middle and two states on each axis, at the places of samples along the axes."""
    every = [start, *(each for _, *pair in axes for each in pair)]
    sign = np.sign(start[VISCOUS])
    is_power = all(sign * each[VISCOUS] > 0 for each in every)  # a drag that changes its sign is none
    for each in every if is_power else []:
        each[VISCOUS] = np.log(sign * each[VISCOUS])
    y = np.tile(start, (number, 1))
    for places, ahead, behind in axes:
        t = np.clip(places, -FARTHEST, FARTHEST)[:, None]
        y += (ahead - behind) / (2 * NODE) * t + (ahead + behind - 2 * start) / (2 * NODE**2) * t**2
    odds, viscous, *films = y.T
    return {
        "contact_load_share": 1 / (1 + np.exp(-np.clip(odds, -700, 700))),
        "viscous": sign * np.exp(viscous) if is_power else viscous,
        **{name: np.exp(film) for name, film in zip(films_of(geometry), films, strict=True)},
    }


def _values(state: Any, definition: Definition, of: Contact | None) -> Array:
    """Return the log odds of the load share, the viscous friction and the logarithms of films of a solved state."""
    contact, fluid = max(state.contact_load_share, TINY), max(state.fluid_load_share, TINY)
    rule = RULES[state.groups.geometry]
    inputs = rule.of_contact(of)
    parts = {name: float(getattr(state, name)) for name in rule.parts(definition)}
    given = {**inputs, "far": far_film(state.groups.model)}
    viscous = float(rule.viscous(parts, state.groups.speed, state.groups.load, given, definition)) / inputs["beta"]
    films = [float(getattr(state, name)) for name in films_of(state.groups.geometry)]
    return np.array([np.log(contact / fluid), viscous, *np.log([max(value, TINY) for value in films])])


def _moved(groups: Groups, offsets: Array) -> Groups:
    factors = np.exp(offsets)
    speed, load, roughness = (
        np.asarray(getattr(groups, name)) * factors[..., i] for i, name in enumerate(("speed", "load", "roughness"))
    )
    if np.ndim(factors) == 1:
        return replace(groups, speed=float(speed), load=float(load), roughness=float(roughness))
    return replace(groups, speed=speed, load=load, roughness=roughness)
