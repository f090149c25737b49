"""Fluid, cavitation, flow factors, solid and motion for one call: a contact or groups that have them."""

import math
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import replace
from typing import Any, TypeVar

import numpy as np

from stribeck.contacts.contact import Contact
from stribeck.contacts.groups import Groups, Model
from stribeck.contacts.parts import PART_INPUTS, PART_KEYWORDS, Parts, part_names
from stribeck.fluids.laws import FilmUnits
from stribeck.quantities.keywords import nearest
from stribeck.quantities.units import InputError, show

CENTRAL_STEP = 1e-5  # Change of a logarithm to both sides by which a model is differentiated
ONE_SIDED_STEP = 1e-7  # Change of a logarithm to one side, where the model refuses the other side

Problem = TypeVar("Problem")


def with_parts(problem: Problem, **given: Any) -> Problem:
    """Return a contact or groups with the parts that are given."""
    unknown = next((name for name in given if name not in PART_KEYWORDS), None)
    if unknown is not None:
        near = nearest(unknown, PART_KEYWORDS)
        raise TypeError(f"got an unexpected keyword argument {unknown!r}" + (f"; did you mean {near}?" if near else ""))
    given = {name: value for name, value in given.items() if value is not None}
    if given and isinstance(problem, Contact):
        return problem.replace(**given)
    if given and isinstance(problem, Groups):
        if isinstance(given.get("cavity_pressure"), str):
            raise InputError(
                f"cavity_pressure = {show(given['cavity_pressure'])} is text; with groups it is a plain number, the pressure "
                "over the Hertz pressure, such as -0.05."
            )
        if "asperity_friction" in given:
            raise InputError(
                f"asperity_friction = {show(given['asperity_friction'])} needs a contact in SI units: groups alone hold no "
                "pressure and no speed. Give a LineContact or PointContact, or boundary_friction with groups."
            )
        return replace(problem, model=Parts(**given).model_in(hertz_units(problem)))
    return problem


def _moved(contact: Contact, name: str, step: float) -> Contact:
    """Return a contact with one of its inputs times ``exp(step)``."""
    changes: dict[str, Any] = {name: getattr(contact, name) * math.exp(step)}
    return contact.replace(**changes)


def models_at_both_sides(contact: Contact, name: str) -> tuple[Model, Model, float] | None:
    """Return models at two values of an input and the distance of their logarithms; None if the input changes no model."""
    below, above = steps = _admissible_steps(contact, name)
    models = [_moved(contact, name, step).groups.model for step in steps]
    return None if models[0] == models[1] else (models[0], models[1], above - below)


def _admissible_steps(contact: Contact, name: str) -> tuple[float, float]:
    """Return steps of the logarithm of an input to both sides, or to the only side on which there is a model."""
    for steps in ((-CENTRAL_STEP, CENTRAL_STEP), (-ONE_SIDED_STEP, 0.0)):
        with suppress(InputError):
            for step in steps:
                _ = _moved(contact, name, step).groups.model
            return steps
    _ = _moved(contact, name, ONE_SIDED_STEP).groups.model
    return 0.0, ONE_SIDED_STEP


def exponents_of(contact: Contact) -> Mapping[str, tuple[float, float, float]]:
    """Return the exponents with which inputs enter the groups near a contact, those of a profile by its dry width."""
    known = contact.INPUTS.exponents
    if contact.profile is None:
        return known
    found = dict(known)
    for name in width_inputs(contact):
        below, above = (_moved(contact, name, step).radius for step in (-CENTRAL_STEP, CENTRAL_STEP))
        rate = math.log(above / below) / (2 * CENTRAL_STEP)
        speed, load, roughness = (
            own + rate * by_radius for own, by_radius in zip(known.get(name, (0.0, 0.0, 0.0)), known["radius"], strict=True)
        )
        found[name] = speed, load, roughness
    return found


def known_speeds(contact: Contact) -> tuple[float, float]:
    """Return the speeds between which the friction of asperities is known [m/s]."""
    ratio = abs(contact.slide)
    low, high = (end / ratio if ratio > 0 else end for end in contact.friction_of_asperities.known_speeds)
    return low, high


def factor_exponents(contact: Contact, names: Iterable[str]) -> dict[str, float]:
    """Return the exponents with which inputs enter the factor of the friction of asperities near a contact."""
    friction = contact.friction_of_asperities
    found = {name: float(name == "boundary_friction") for name in names}
    for name in found if not friction.is_constant and friction.factor(contact) else ():
        below, above = steps = _admissible_steps(contact, name)
        less, more = (each.friction_of_asperities.factor(each) for each in (_moved(contact, name, step) for step in steps))
        found[name] = math.log(more / less) / (above - below)
    return found


def width_inputs(contact: Contact) -> tuple[str, ...]:
    """Return the inputs from which the dry width under a profile follows."""
    return ("load", "modulus", *(each for each in part_names(contact) if PART_INPUTS[each].table == "profile"))


def hertz_units(groups: Groups) -> FilmUnits:
    r"""Return the units in which numbers of laws are given with groups.

    Pressures are in :math:`p_\mathrm{Hz}`, lengths in a, gaps in :math:`u_\mathrm{Hz}`, times in :math:`u_\mathrm{Hz}/U`,
    shear stresses in :math:`\eta_0 U/u_\mathrm{Hz}` at the speed group of these groups, and viscosities in :math:`\eta_0`.
    """
    values = []
    for name in ("speed", "relative_roughness"):
        value = np.unique(np.asarray(getattr(groups, name)))
        if len(value) != 1:
            raise InputError(f"the numbers of a fluid are in units of one state; groups with many values of {name} have many.")
        values.append(float(value[0]))
    speed, roughness = values
    return FilmUnits(pressure=1.0, time=speed or 1.0, gap=1.0, viscosity=1.0, decay_length=roughness)


def refuse_fixed_memory(groups: Groups, reason: str) -> None:
    """Refuse a viscoelastic body where its Deborah number would have to change with the speed."""
    solid = groups.model.solid
    if getattr(solid, "uses_speed", False):
        raise InputError(f"solid = {solid.name}: its Deborah number changes with the speed, {reason}")
