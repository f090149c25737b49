"""Friction read off the atlas, with its parts and its derivatives."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from stribeck._types import Array
from stribeck.atlas.lookup import Value, contact_share, documented, inputs_for, read_friction, reshape_to_groups, slopes_of
from stribeck.contacts.friction import Definition, check_definition
from stribeck.contacts.friction_rules import RULES
from stribeck.contacts.geometries import LINE
from stribeck.contacts.groups import Groups
from stribeck.contacts.parts import PURE_SLIDING
from stribeck.quantities.keywords import answers_typos
from stribeck.quantities.units import InputError, checked_kind, show


@documented("Friction coefficient [-].")
@answers_typos
def friction(
    groups: Groups,
    boundary_friction: float = 1.0,
    beta: float = 1.0,
    definition: Definition = "balanced",
    *,
    slide_to_roll: float = PURE_SLIDING,
    wetted_radius: float | Array = math.inf,
) -> Value:
    r"""Return the friction coefficient.

    .. math:: \mu = \mu_0 \frac{F_c}{F_N} + \mu_f

    Notes
    -----
    Both parts are positive for surfaces of which one rests, so that its relative error is at most the larger of theirs.
    """
    boundary_friction = LINE.quantities["boundary_friction"].checked(boundary_friction)
    inputs = _inputs(groups, beta, slide_to_roll, wetted_radius)
    contact, viscous = friction_terms(groups, inputs, check_definition(definition))
    return reshape_to_groups(groups, boundary_friction * _sliding_factor(groups, inputs) * contact + viscous)


@documented("Friction coefficient [-]; zero at rest.")
def viscous_friction(
    groups: Groups,
    beta: float = 1.0,
    definition: Definition = "balanced",
    *,
    slide_to_roll: float = PURE_SLIDING,
    wetted_radius: float | Array = math.inf,
) -> Value:
    """Return the part of the friction coefficient that the fluid causes."""
    inputs = _inputs(groups, beta, slide_to_roll, wetted_radius)
    return reshape_to_groups(groups, friction_terms(groups, inputs, check_definition(definition))[1])


@documented(
    "ndarray, shape (3, ...): By ln(speed), ln(load) and ln(roughness), the other two groups held [-]; the last is zero for "
    "smooth contacts."
)
@answers_typos
def friction_derivatives(
    groups: Groups,
    boundary_friction: float = 1.0,
    beta: float = 1.0,
    definition: Definition = "balanced",
    *,
    slide_to_roll: float = PURE_SLIDING,
    wetted_radius: float | Array = math.inf,
) -> Array:
    r"""Return the derivatives of the friction coefficient with respect to the logarithms of the groups.

    .. math:: \frac{\partial \mu}{\partial \ln \lambda}, \quad \frac{\partial \mu}{\partial \ln \bar F_N}, \quad
        \frac{\partial \mu}{\partial \ln \bar h_\mathrm{rms}}

    Notes
    -----
    Exact derivatives of :func:`friction`, at held ``slide_to_roll`` and ``wetted_radius``, shown by ``test_atlas.py``; zero at
    rest.
    """
    boundary_friction = LINE.quantities["boundary_friction"].checked(boundary_friction)
    inputs = _inputs(groups, beta, slide_to_roll, wetted_radius)
    reading = read_friction(groups, check_definition(definition), slopes=3)
    contact, viscous = slopes_of(groups, reading, inputs, definition)
    return (boundary_friction * _sliding_factor(groups, inputs) * contact + viscous).reshape(3, *groups.shape)


@documented(
    "ndarray, shapes (1 + parts, ...) and (1 + parts, 3, ...): Contact load share and the observables that friction takes, "
    "of cylinders the viscous friction for beta = 1 [-]; their derivatives by ln(speed), ln(load) and ln(roughness)."
)
def friction_parts(groups: Groups, definition: Definition = "balanced") -> tuple[Array, Array]:
    """Return what the friction is made of, without the coefficients that it takes beside, and the derivatives of each.

    Notes
    -----
    One reading of the table gives all, for fits in which boundary_friction and beta differ from state to state.
    """
    checked_kind("groups", groups, Groups, "Groups(speed, load, roughness)")
    reading = read_friction(groups, check_definition(definition), slopes=3)
    names = RULES[groups.geometry].parts(definition)
    values = np.stack([reading.contact, *(reading.parts[name] for name in names)])
    slopes = np.stack([reading.contact_slopes, *(reading.part_slopes[name] for name in names)])
    slopes[:, :, reading.speed == 0] = 0.0
    return values.reshape(len(values), *groups.shape), slopes.reshape(len(values), 3, *groups.shape)


def friction_terms(groups: Groups, inputs: Mapping[str, Any], definition: Definition) -> tuple[Array, Array]:
    """Return contact load share and viscous friction of the flattened states, by inputs that may be arrays with derivatives.

    The ``inputs`` are what the friction rule of the geometry takes, by name; they are not checked.
    """
    checked_kind("groups", groups, Groups, "Groups(speed, load, roughness)")
    reading = read_friction(groups, check_definition(definition))
    arrays = inputs_for(groups, inputs)
    return reading.contact, RULES[groups.geometry].viscous(reading.parts, reading.speed, reading.load, arrays, definition)


@documented(
    "ndarray, shape (4, ...): Load shares of fluid and asperities, :func:`viscous_friction`, and the derivative of "
    ":func:`friction` by ln(speed) [-]."
)
@answers_typos
def shares_and_friction(
    groups: Groups,
    boundary_friction: float = 1.0,
    beta: float = 1.0,
    definition: Definition = "balanced",
    *,
    slide_to_roll: float = PURE_SLIDING,
    wetted_radius: float | Array = math.inf,
) -> Array:
    """Return at once what tells the regimes apart, at the cost of one of its parts."""
    boundary_friction = LINE.quantities["boundary_friction"].checked(boundary_friction)
    inputs = _inputs(groups, beta, slide_to_roll, wetted_radius)
    reading = read_friction(groups, check_definition(definition), slopes=1)
    arrays = inputs_for(groups, inputs)
    viscous = RULES[groups.geometry].viscous(reading.parts, reading.speed, reading.load, arrays, definition)
    by_contact, by_viscous = slopes_of(groups, reading, inputs, definition)
    by_speed = boundary_friction * _sliding_factor(groups, inputs) * by_contact[0] + by_viscous[0]
    return np.stack([contact_share(-reading.odds), reading.contact, viscous, by_speed]).reshape(4, *groups.shape)


def _inputs(groups: Groups, beta: float, slide_to_roll: float, wetted_radius: float | Array) -> dict[str, Any]:
    """Return what the friction rule of the geometry takes, checked."""
    if not isinstance(groups, Groups):
        raise InputError(f"groups = {show(groups)}; it must be Groups(speed, load, roughness).")
    wanted = RULES[groups.geometry].inputs
    given = {"beta": LINE.quantities["beta"].checked(beta), "slide_to_roll": slide_to_roll, "wetted_radius": wetted_radius}
    usual = {"beta": beta, "slide_to_roll": PURE_SLIDING, "wetted_radius": math.inf}
    for name, value in given.items():
        if name not in wanted and np.any(np.asarray(value) != usual[name]):
            raise InputError(f"{name} = {show(value)} belongs to a ball, geometry = 'point'; these states are of a cylinder.")
    if not np.all(np.asarray(wetted_radius) > 1):
        raise InputError(f"wetted_radius = {show(wetted_radius)} must be above 1: the liquid reaches beyond the Hertz radius.")
    return {name: given[name] for name in wanted}


def _sliding_factor(groups: Groups, inputs: Mapping[str, Any]) -> float:
    """Return the part of boundary_friction that acts, with the sign of the sliding."""
    return float(RULES[groups.geometry].sliding_factor(groups, inputs))
