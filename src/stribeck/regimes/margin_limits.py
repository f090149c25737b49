"""Between which values of an input another regime of a contact is sought."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

from stribeck.contact_laws.law import largest_load
from stribeck.contacts.contact import Contact
from stribeck.contacts.groups import Geometry
from stribeck.contacts.with_parts import exponents_of, known_speeds
from stribeck.curves.coordinate import Over

# Groups between which is searched, where the solver is tested; the load also no further than the contact law holds.
BOX = {"speed": (1e-12, 1e6), "load": (1e-8, 10.0), "relative_roughness": (1e-6, 1e3)}

# What an input can be made at all [SI]: a speed from an atom's width in 100 s to that of sound, a fluid from gas to pitch,
# a roughness from that of atoms.  Roughness ends with the contact itself: see physical_bounds.
PHYSICAL = {"speed": (1e-12, 1e3), "viscosity": (1e-5, 1e8), "roughness": (1e-10, math.inf)}


class Search(NamedTuple):
    """How far and how finely the regimes of one geometry are searched."""

    lightest: float
    heaviest: Callable[[Contact], float]
    roughest: Callable[[Contact], float]
    largest_group: float  # Load group up to which the solver is tested, where the contact law allows it
    rtol: float  # Smallest tolerance of margins: a ball takes a tenth of a second or more for each state
    coarse: float  # Smallest tolerance of the curves on which they are looked for, before they are located


SEARCHES: dict[Geometry, Search] = {
    "line": Search(
        1e-6, lambda each: math.pi / 4 * each.modulus * each.radius, lambda each: each.hertz.half_width, 10.0, 0.0, 0.0
    ),
    "point": Search(
        1e-9, lambda each: 4 / 3 * each.modulus * each.radius**2, lambda each: each.hertz.indentation, 1e4, 3e-3, 1e-2
    ),
}


def scanned_rtol(contact: Contact, rtol: float) -> float:
    """Return the tolerance of margins."""
    return max(rtol, SEARCHES[contact.groups.geometry].rtol)


def physical_bounds(contact: Contact, name: str) -> tuple[float, float]:
    r"""Return between which values an input of a contact can be sought, whatever the model says beyond.

    .. math:: F_N \le \frac{\pi}{4} E^* R \text{ on the line}, \quad \frac43 E^* R^2 \text{ on the ball} \;\;(a \le R),
        \qquad h_\mathrm{rms} \le a \text{ and } u_\mathrm{Hz}
    """
    search = SEARCHES[contact.groups.geometry]
    if name == "load":
        low, high = search.lightest, search.heaviest(contact)
    else:
        low, high = PHYSICAL[name]
    if name == "roughness":
        high = search.roughest(contact)
    if name == "speed":
        slowest, fastest = known_speeds(contact)
        low, high = max(low, slowest), min(high, fastest)
    value = float(getattr(contact, name))
    return (min(low, value), max(high, value)) if value > 0 else (low, high)


def limits(contact: Contact, name: str) -> tuple[float, float]:
    """Return the logarithms of the factors of an input between which it is possible and the groups stay in the box."""
    groups = contact.groups
    highest = min(SEARCHES[groups.geometry].largest_group, largest_load(contact.law))
    box = BOX | {"load": (BOX["load"][0], highest)}
    n_speed, n_load, n_roughness = exponents_of(contact)[name]
    n_roughness -= groups.scaling.roughness_exponent * n_load
    low, high = _possible_factors(contact, name)
    for group, n in (("speed", n_speed), ("load", n_load), ("relative_roughness", n_roughness)):
        value = float(getattr(groups, group))
        if n == 0 or value == 0:
            continue
        ends = sorted(math.log(end / value) / n for end in box[group])
        low, high = max(low, ends[0]), min(high, ends[1])
    return min(low, 0.0), max(high, 0.0)


def _possible_factors(contact: Contact, name: str) -> tuple[float, float]:
    """Return the logarithms of the factors to the bounds of an input, of the speed also to those of the viscosity."""
    is_for_both = name == "speed" and not contact.friction_of_asperities.uses_speed
    names = ("speed", "viscosity") if is_for_both else (name,)
    ends = [(getattr(contact, each), physical_bounds(contact, each)) for each in names]
    return min(math.log(low / value) for value, (low, _) in ends), max(math.log(high / value) for value, (_, high) in ends)


def with_smallest(contact: Contact, name: Over) -> Contact:
    """Return the contact with the minimum speed or roughness of the box instead of zero."""
    groups = contact.replace(**{name: 1.0}).groups
    group = "speed" if name == "speed" else "relative_roughness"
    return contact.replace(**{name: BOX[group][0] / float(getattr(groups, group))})
