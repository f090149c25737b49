r"""The dry contact of a smooth rigid shape on an elastic half-space, by one quadrature.

With centre c, half-width l and :math:`t = \cos\theta` over the contact, means being those over :math:`\theta`,

.. math::

    \langle h_0'(c + l t) \rangle = 0, \qquad F_N = \frac{\pi}{2} E^* l \, \langle t \, h_0'(c + l t) \rangle

and the pressure rises from an edge as :math:`k d^{1/2}` with the distance d, where of the left edge

.. math:: k = \frac{E^*}{2} \left(\frac2l\right)^{1/2} \left\langle \frac{h_0'(c + l t) - h_0'(c - l)}{1 + t} \right\rangle

and likewise of the right one.  Kinks of the slope end panels of the quadrature.
"""

import math
from dataclasses import dataclass

import numpy as np

from stribeck._types import Array
from stribeck.numerics.newton import root_between
from stribeck.numerics.panels import reference
from stribeck.numerics.settings import EPSILON
from stribeck.profiles.profile import Profile
from stribeck.quantities.units import InputError

PANELS = 64  # Panels of the quadrature between kinks: a tip of a hundredth of the contact is seen to ten digits
NODES = 16  # Nodes on each
MAX_DOUBLINGS = 200  # Doublings and halvings by which the half-width is bracketed: lengths of 1e60 to each side


@dataclass(frozen=True)
class DryContact:
    """Where a smooth shape touches a half-space under a load, and how the pressure begins at both edges."""

    centre: float  # [m]
    half_width: float  # [m]
    left_edge: float  # Pressure over the square root of the distance from the left edge [Pa/m^(1/2)]
    right_edge: float  # The same of the right edge [Pa/m^(1/2)]


def dry_contact(profile: Profile, load: float, modulus: float) -> DryContact:
    """Return the dry contact of a shape.

    Parameters
    ----------
    profile : Profile
        The shape, one of ``sb.profiles`` or an object with the same four members.
    load : float
        Load per unit length [N/m].
    modulus : float
        Effective modulus E* [Pa].

    Returns
    -------
    DryContact
        Centre, half-width, and edge coefficients.

    Raises
    ------
    InputError
        If the shape bears no such load: its slope rises on neither side.

    Notes
    -----
    The contact is taken for one piece.  Where the shape has valleys the pressure in them may come out below zero.
    """
    turned = -1.0 if getattr(profile, "reversed", False) else 1.0
    kinks = turned * np.asarray(profile.places, dtype=float)

    def slope(x: Array) -> Array:
        return np.asarray(turned * profile.slope(turned * x))

    def means(centre: float, half: float) -> tuple[float, float]:
        angles, weights = _rule(kinks, centre, half)
        t = np.cos(angles)
        found = slope(centre + half * t)
        return float(weights @ found), float(weights @ (t * found))

    def centre_of(half: float) -> float:
        reach = half
        for _ in range(MAX_DOUBLINGS):
            found = root_between(lambda centre: means(centre, half)[0], -reach, reach, EPSILON * reach)
            if found is not None:
                return found
            reach *= 2
        raise InputError(f"the profile {_name(profile)} rises on one side alone, so that it bears no load.")

    def excess(log_half: float) -> float:
        half = math.exp(log_half)
        borne = 0.5 * math.pi * modulus * half * means(centre_of(half), half)[1]
        return math.log(borne / load) if borne > 0 else -math.inf

    low = high = math.log(load / modulus)
    for _ in range(MAX_DOUBLINGS):
        if excess(high) > 0:
            break
        low, high = high, high + math.log(2)
    for _ in range(MAX_DOUBLINGS):
        if excess(low) < 0:
            break
        low, high = low - math.log(2), low
    log_half = root_between(lambda each: max(excess(each), -1.0), low, high, EPSILON)
    if log_half is None:
        raise InputError(f"the profile {_name(profile)} bears no load of {load:g} N/m: its slope does not rise outwards.")
    half = math.exp(log_half)
    centre = centre_of(half)
    angles, weights = _rule(kinks, centre, half)
    t = np.cos(angles)
    inside, ends = slope(centre + half * t), slope(centre + half * np.array([-1.0, 1.0]))
    left = weights @ ((inside - ends[0]) / (2 * np.cos(0.5 * angles) ** 2))
    right = weights @ ((ends[1] - inside) / (2 * np.sin(0.5 * angles) ** 2))
    scale = 0.5 * modulus * math.sqrt(2 / half)
    return DryContact(centre, half, float(scale * left), float(scale * right))


def _rule(kinks: Array, centre: float, half: float) -> tuple[Array, Array]:
    """Return angles and weights of the mean over the angle, on panels that end at kinks."""
    at = (kinks - centre) / half
    edges = np.sort(np.concatenate([np.linspace(0.0, math.pi, PANELS + 1), np.arccos(at[np.abs(at) < 1])]))
    middle, width = 0.5 * (edges[1:] + edges[:-1]), 0.5 * np.diff(edges)
    rule = reference(NODES)
    angles = (middle[:, None] + width[:, None] * rule.nodes).ravel()
    return angles, np.outer(width, rule.weights).ravel() / math.pi


def _name(profile: Profile) -> str:
    return str(getattr(profile, "name", type(profile).__name__))
