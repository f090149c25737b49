"""What outputs say of the contact or groups behind a result: geometry, contact law, model, and inputs with their units."""

from __future__ import annotations

from typing import Any

import numpy as np

from stribeck.contact_laws.law import law_attributes
from stribeck.contacts.contact import Contact, part_attributes
from stribeck.contacts.groups import Groups
from stribeck.quantities.outputs import GROUPS

__all__ = ["about_problem", "constant_groups", "input_attributes", "problem_attributes", "units_of_inputs"]


def about_problem(groups: Groups, contact: Contact | None) -> dict[str, Any]:
    """Return it for JSON: what belongs together under one key, in SI units where there is a contact."""
    law = groups.law
    return {
        "geometry": groups.geometry,
        "contact_law": "exponential" if law is None else law.name,
        "contact_law_parameters": {} if law is None else law.parameters,
        "model": part_attributes(groups, contact),
        "inputs": None if contact is None else contact.to_si(),
        "units": None if contact is None else units_of_inputs(contact),
    }


def problem_attributes(groups: Groups, contact: Contact | None, is_smooth: bool, varied: str = "") -> dict[str, Any]:
    """Return it as attributes of a dataset, which are flat; without the input that varies."""
    return {
        "geometry": groups.geometry,
        **law_attributes(groups.law, is_smooth),
        **part_attributes(groups, contact),
        **{f"{name}_group": value for name, value in constant_groups(groups).items()},
        **input_attributes(contact, varied),
    }


def input_attributes(contact: Contact | None, *varied: str) -> dict[str, float | str]:
    """Return the inputs of a contact with their units as attributes, without those that vary."""
    if contact is None:
        return {}
    inputs = {name: value for name, value in contact.inputs() if name not in varied}
    units = units_of_inputs(contact)
    named = ", ".join(f"{name} {units[name]}" for name in inputs)
    return {f"input_{name}": value for name, value in inputs.items()} | {"input_units": named}


def units_of_inputs(contact: Contact) -> dict[str, str]:
    """Return the SI units of the inputs of a contact."""
    return {name: contact.INPUTS.quantities[name].unit for name, _ in contact.inputs()}


def constant_groups(groups: Groups) -> dict[str, float]:
    """Return the groups that are the same in all states."""
    arrays = {name: np.atleast_1d(getattr(groups, name)) for name in GROUPS}
    return {name: float(each[0]) for name, each in arrays.items() if len(each) and np.ptp(each) <= 1e-12 * each[0]}
