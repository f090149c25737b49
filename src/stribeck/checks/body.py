"""Checks of the bodies: pressure, stiffness, width, layer, loss."""

import math
from collections.abc import Mapping

import numpy as np

from stribeck.checks.check import MIN_STATED_CHANGE, Check, Verdict, check_against_limits, verdict_of
from stribeck.checks.subject import Subject
from stribeck.contacts.geometries import POINT
from stribeck.contacts.inputs import InputTable
from stribeck.contacts.notes import (
    HARD_PREFIX,
    MAX_CONTACT_SLOPE,
    MAX_PRESSURE_EXPONENT,
    OIL_COEFFICIENT,
    pressure_notes,
    width_notes,
)
from stribeck.fluids.fluid import Cavitation
from stribeck.profiles.dry import dry_contact
from stribeck.quantities.formats import format_percent, format_si
from stribeck.solids.solid import lengths_of

STIFFENING_FINE = 0.1  # Largest pressure coefficient times Hertz pressure whose effect on the film is small

MODULUS_FINE_PA = 1e9  # Largest E* of a soft body [Pa]
MODULUS_OUTSIDE_PA = 1e10  # E* from which a body is metal, glass or ceramic, whose asperities yield [Pa]

WIDTH_RATIO_OUTSIDE = 0.5  # Half-width over the radius beyond which a parabola on a half-space is not valid

# Load that a circle bears beyond the parabola at the same width, over (a/R)^2: see :func:`width`
EXCESS_LOAD_OF_CIRCLE = {"line": 3 / 8, "point": 2 / 5}

SLOPES_CHECKED = 257  # Places in the contact at which the slope of a profile is looked at

LAYER_RATIO_FINE = 0.3  # Half-width over thickness up to which a layer acts as a half-space within about a tenth
LAYER_RATIO_OUTSIDE = 1.0  # Half-width over thickness beyond which a layer is no half-space

LOSS_TANGENT_FINE = 0.1  # Loss tangent up to which hysteresis is small
LOSS_TANGENT_OUTSIDE = 0.3  # Loss tangent beyond which the contact is no longer symmetric


GEL_MODULUS_PA = 1e6  # E* below which adhesion and pores are named as not modelled [Pa]

PULL_OFF_FINE = 0.1  # Largest pull-off force over load that hardly widens the contact
PULL_OFF_OUTSIDE = 1.0  # Pull-off force over load from which adhesion rules

PECLET_FINE = 0.1  # Largest Peclet number U a/D of pores that drain as the contact passes
PECLET_OUTSIDE = 1.0  # Peclet number from which the liquid in the pores carries load

SLIDE_TO_ROLL = POINT.quantities["slide_to_roll"]

INPUTS_IN_PER_CENT = ("slide_to_roll", "boundary_friction")  # Inputs that are often given in per cent

USUAL_RANGE_FACTOR = 3.0  # Factor beyond its usual range that an input may have; a slip of a unit is ten or more


def input_sizes(subject: Subject) -> Check:
    """Return the check of the inputs against what contacts usually have, which finds slips of a unit."""
    contact = subject.contact
    motion = {"slide_to_roll": 2 * float(contact.groups.model.film.slide)}
    return check_sizes(dict(contact.inputs()) | motion, contact.INPUTS)


def check_sizes(values: Mapping[str, float], table: InputTable) -> Check:
    """Return the check of inputs by name, in SI units."""
    worst, odd = 1.0, []
    rows = {"slide_to_roll": SLIDE_TO_ROLL} | dict(table.quantities)
    for name, signed in values.items():
        row, value = rows[name], abs(signed)
        low, high = row.usual
        if not 0 < value < math.inf or name == "slide_to_roll" and value <= high:
            continue
        factor = max(low / value, value / high, USUAL_RANGE_FACTOR * value / row.implausible)
        worst = max(worst, factor)
        if factor > USUAL_RANGE_FACTOR:
            ends = (format_si(end, row.dimension) for end in (low, high))
            about = f" ({value:g} % is {value / 100:g})" if name in INPUTS_IN_PER_CENT and value <= 200 else ""
            odd.append(f"{row.label} {format_si(signed, row.dimension)}{about}, usually {' to '.join(ends)}")
    sentence = f"Unusual: {'; '.join(odd)}. Check the units." if odd else "All inputs are of usual size."
    return Check("inputs", worst, USUAL_RANGE_FACTOR, "doubtful" if odd else "fine", sentence)


def unusual(values: Mapping[str, float | None], table: InputTable) -> str:
    """Return the sentence about inputs that are hardly meant, in SI units by name; empty where there is none."""
    found = check_sizes({name: value for name, value in values.items() if value is not None}, table)
    return "" if found.verdict == "fine" else found.sentence


def adhesion(subject: Subject) -> Check | None:
    r"""Return the check of the pull-off force of JKR over the load; None for stiffer bodies whose adhesion is not known.

    .. math:: F = \tfrac32 \pi w R \text{ of a ball}, \qquad F = \tfrac34 (4 \pi E^* R w^2)^{1/3} \text{ of a cylinder}

    Source: [JKR]; the second from :math:`F = \pi E^* a^2/(4 R) - (2 \pi E^* w a)^{1/2}` at its minimum.
    """
    contact, w = subject.contact, subject.fact("work_of_adhesion")
    E, R = contact.modulus, contact.radius
    if w is None:
        if E >= GEL_MODULUS_PA:
            return None
        sentence = f"At E* = {format_si(E, 'pressure')} adhesion may matter, which is not modelled; give work_of_adhesion."
        return Check("adhesion", E, GEL_MODULUS_PA, "doubtful", sentence, "Pa", at_least=True, condition="adhesion is small")
    pull_off = 1.5 * math.pi * w * R if contact.groups.geometry == "point" else 0.75 * (4 * math.pi * E * R * w * w) ** (1 / 3)
    ratio = pull_off / contact.load
    meanings: dict[Verdict, str] = {
        "fine": "adhesion hardly widens the contact.",
        "doubtful": "adhesion widens the contact and adds friction, which is not modelled.",
        "outside": "adhesion and not the load holds the bodies together, which is not modelled.",
    }
    begin = f"The pull-off force is {ratio:.2g} of the load: "
    return check_against_limits("adhesion", ratio, PULL_OFF_FINE, PULL_OFF_OUTSIDE, begin, meanings)


def pores(subject: Subject) -> Check | None:
    r"""Return the check of the flow through the pores of the soft body; None for stiffer bodies whose pores are not known.

    .. math:: \mathrm{Pe} = U a/D, \qquad D = k E^*/\eta

    Source: docs/checks.md.
    """
    contact, D, k = subject.contact, subject.fact("diffusivity"), subject.fact("permeability")
    if D is None and k is not None:
        D = k * contact.modulus / contact.viscosity
    if D is None:
        if contact.modulus >= GEL_MODULUS_PA:
            return None
        sentence = (
            f"E* = {format_si(contact.modulus, 'pressure')} is that of gels and tissue, whose pores may carry and pass "
            "liquid, which is not modelled; give diffusivity or permeability."
        )
        value = contact.modulus
        return Check(
            "pores", value, GEL_MODULUS_PA, "doubtful", sentence, "Pa", at_least=True, condition="no liquid flows in pores"
        )
    peclet = contact.speed * contact.hertz.half_width / D if D > 0 else 0.0
    drained = "the liquid in the pores leaves as the contact passes, and the solid carries the load."
    meanings: dict[Verdict, str] = {
        "fine": drained if D > 0 else "the body has no pores.",
        "doubtful": "the liquid in the pores carries some load, which is not modelled.",
        "outside": "the liquid in the pores carries load that the model gives to asperities, and friction is lower.",
    }
    return check_against_limits("pores", peclet, PECLET_FINE, PECLET_OUTSIDE, f"U a/D is {peclet:.2g}: ", meanings)


def pressure(subject: Subject) -> Check:
    """Return the check of the Hertz pressure against the growth of viscosity with pressure."""
    p = subject.contact.hertz.pressure
    given = subject.fact("pressure_coefficient")
    coefficient = OIL_COEFFICIENT if given is None else given
    growth = coefficient * p
    limit, outside = (part / coefficient if coefficient > 0 else math.inf for part in (STIFFENING_FINE, MAX_PRESSURE_EXPONENT))
    modelled = subject.models("fluid")
    uses_pressure = getattr(getattr(subject.contact, "fluid", None), "viscosity", None) is not None
    if uses_pressure:
        return Check(
            "Hertz pressure", p, math.inf, "fine", f"The growth of viscosity with pressure is modelled ({modelled}).", "Pa"
        )
    verdict = verdict_of(p, limit, outside)
    if given is None and verdict == "outside":
        [sentence] = pressure_notes(subject.contact)
    else:
        of_oil = f"of an oil, {OIL_COEFFICIENT * 1e9:g} 1/GPa (give pressure_coefficient)"
        about = of_oil if given is None else f"{given * 1e9:.3g} 1/GPa"
        begin = f"{HARD_PREFIX} at" if verdict == "outside" else "At"
        sentence = (
            f"{begin} the Hertz pressure of {p / 1e6:.3g} MPa viscosity is exp({growth:.2g}) times that at ambient pressure "
            f"by the pressure-viscosity coefficient {about}; the model has one viscosity."
        )
    return Check("Hertz pressure", p, limit, verdict, sentence, "Pa")


def stiffness(subject: Subject) -> Check:
    """Return the check of the modulus: whether the body is soft."""
    E = subject.contact.modulus
    verdict = verdict_of(E, MODULUS_FINE_PA, MODULUS_OUTSIDE_PA)
    if verdict == "fine":
        sentence = "The bodies are soft enough for elastic asperities and moderate pressures."
    else:
        sentence = (
            f"E* = {E / 1e9:.3g} GPa is that of {'metal, glass or ceramic' if verdict == 'outside' else 'a hard plastic'}: "
            "asperities yield, which the contact law does not know, and where they touch a film its viscosity rises with "
            "pressure. The model is for rubber, gels, plastics and tissue."
        )
    return Check("stiffness", E, MODULUS_FINE_PA, verdict, sentence, "Pa")


def width(subject: Subject) -> Check | None:
    r"""Return the check of the half-width over the radius, with what the parabola costs.

    .. math:: F = \frac{\pi E^* a^2}{4 R} \Bigl(1 + \frac38 \frac{a^2}{R^2} + \dots\Bigr)

    for a cylinder, 1 + (2/5) (a/R)^2 for a ball.  Source: the next term of the circle in Hertz's integral and in Sneddon's.
    """
    contact = subject.contact
    if contact.profile is not None:  # see :func:`shape`
        return None
    slope = contact.slope
    verdict = verdict_of(slope, MAX_CONTACT_SLOPE, WIDTH_RATIO_OUTSIDE)
    error = EXCESS_LOAD_OF_CIRCLE[contact.groups.geometry] * slope**2
    notes = width_notes(contact)
    about = (
        f"a/R is {slope:.2g}: at this width a circle bears {format_percent(error)} more load than the parabola in "
        "its place; finite bodies and large strains count in the same order."
    )
    sentence = notes[0] if notes else about
    return Check(
        "contact width a/R", slope, MAX_CONTACT_SLOPE, verdict, sentence, error=error, notable=error >= MIN_STATED_CHANGE
    )


def shape(subject: Subject) -> Check | None:
    """Return the check of a profile: its steepest slope in the dry contact, and the end of its film; None of a cylinder."""
    contact, profile = subject.contact, subject.contact.profile
    if profile is None:
        return None
    dry = dry_contact(profile, contact.load, contact.modulus)
    turned = -1.0 if getattr(profile, "reversed", False) else 1.0
    x = turned * (dry.centre + dry.half_width * np.linspace(-1, 1, SLOPES_CHECKED))
    steepest = float(np.abs(profile.slope(x)).max())
    verdict = verdict_of(steepest, MAX_CONTACT_SLOPE, WIDTH_RATIO_OUTSIDE)
    about = (
        f"The steepest slope of the profile in its dry contact, {format_si(2 * dry.half_width, 'length')} wide, is "
        f"{steepest:.2g}; the half-space is accurate up to about 0.1 and coarse at {MAX_CONTACT_SLOPE}. "
    )
    if contact.cavitation is Cavitation.NONE:
        verdict = "doubtful" if verdict == "fine" else verdict
        end = "The film does not end: its suction behind the edge adds to the load on asperities; take cavitation = 'exit'."
    else:
        end = (
            "The film ends at the exit, by default of a profile: a full film would suck behind the edge and load asperities "
            "by more than the whole load. Where it breaks inside the contact too, that is not modelled."
        )
    return Check("shape", steepest, MAX_CONTACT_SLOPE, verdict, about + end)


def layer(subject: Subject) -> Check | None:
    """Return the check of the layer: half-width over its thickness; None where the thickness is not known."""
    modelled = lengths_of(subject.contact.solid).thickness
    thickness = modelled if math.isfinite(modelled) else subject.fact("layer_thickness")
    if thickness is None or thickness == 0:
        return None
    ratio = subject.contact.hertz.half_width / thickness
    if thickness == modelled:
        return Check("layer a/thickness", ratio, math.inf, "fine", "The finite thickness of the layer is part of the model.")
    meanings: dict[Verdict, str] = {
        "fine": "The layer is as good as a half-space.",
        "doubtful": "The layer feels its substrate: the contact is narrower and stiffer than computed.",
        "outside": "The layer is thinner than the contact is wide: the half-space does not apply, and films differ.",
    }
    begin = f"The contact is {ratio:.2g} of the thickness wide to each side. "
    return check_against_limits("layer a/thickness", ratio, LAYER_RATIO_FINE, LAYER_RATIO_OUTSIDE, begin, meanings)


def loss(subject: Subject) -> Check | None:
    """Return the check of the loss tangent; None where it is not known."""
    tangent = subject.fact("loss_tangent")
    if tangent is None:
        return None
    contact = subject.contact
    frequency = contact.speed / contact.hertz.half_width
    if subject.models("solid") and getattr(getattr(contact, "solid", None), "uses_speed", False):
        return Check("loss tangent", tangent, LOSS_TANGENT_FINE, "fine", "The viscoelasticity of the solid is modelled.")
    meanings: dict[Verdict, str] = {
        "fine": "hysteresis is small.",
        "doubtful": "hysteresis adds friction that is not modelled.",
        "outside": "hysteresis adds friction and shifts the contact, which is not modelled; the solid is not elastic.",
    }
    begin = f"The loss tangent is {tangent:.2g} (take it at U/a = {frequency:.2g} 1/s): "
    return check_against_limits("loss tangent", tangent, LOSS_TANGENT_FINE, LOSS_TANGENT_OUTSIDE, begin, meanings)
