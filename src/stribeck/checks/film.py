"""Checks of the film: suction, shear rate, supply, stroke, molecules, heating, inertia."""

import math

from stribeck.checks.check import Check, Verdict, check_against_limits, number_text, verdict_of
from stribeck.checks.subject import Subject
from stribeck.contacts.cut_off import FAR_FILM_MIN_RADIUS
from stribeck.contacts.friction_rules import slide_to_roll
from stribeck.contacts.notes import (
    ATMOSPHERE,
    FLUID_PREFIX,
    MAX_FILM_SLOPE,
    SUCTION_PREFIX,
    THICK_PREFIX,
    WETTED_PREFIX,
)
from stribeck.quantities.formats import format_percent

OIL_THINNING_RATE = 1e6  # Shear rate up to which oils without improvers keep their viscosity [1/s]
WATER_THINNING_RATE = 1e9  # Shear rate up to which liquids as thin as water keep their viscosity [1/s]

# Viscosity up to which a liquid is one of small molecules, as water and saline are: of what it has of polymers it cannot lose
# more than a third [Pa s]. By kT for each molecule, 1e7 Pa or more, it keeps its viscosity up to 7e9 1/s.
SMALL_MOLECULE_VISCOSITY = 1.5e-3

# Shear rate over the rate at which a fluid begins to thin, beyond which its viscosity is unknown
THINNING_OUTSIDE_RATIO = 10.0

SUPPLY_FINE = 0.5  # Film that passes, h*/2, over the film that arrives, up to which the inlet is flooded
SUPPLY_OUTSIDE = 1.0  # Film that passes over the film that arrives, above which the contact is starved

# Length of a stroke over the half-width from which friction follows the speed as if it were steady: within 4 % at half of the
# top speed and 14 % at a fifth, but 30 % at a twentieth.
STROKE_FINE = 1000.0
# Length of a stroke over the half-width below which the film of the fast phase stays at the ends: on 40 half-widths friction
# there is a sixth of that at a steady speed.
STROKE_OUTSIDE = 100.0

OIL_MOLECULE_SIZE = 1e-9  # Size of the molecules of oils [m]
WATER_MOLECULE_SIZE = 3e-10  # Size of the molecules of water [m]

MOLECULES_FINE = 10.0  # Fewest molecules across a film that is a continuum
MOLECULES_OUTSIDE = 3.0  # Molecules across a film below which a viscosity means little

OIL_CONDUCTIVITY = 0.15  # Thermal conductivity of oils [W/(m K)]
OIL_THERMAL_THINNING = 0.04  # Relative loss of viscosity of oils by temperature [1/K]

HEATING_FINE = 0.1  # Relative loss of viscosity by shear heating that is small
HEATING_OUTSIDE = 1.0  # Relative loss of viscosity beyond which an isothermal film does not apply

WATER_DENSITY = 1000.0  # [kg/m^3]

REYNOLDS_FINE = 0.1  # Largest reduced Reynolds number of a film without inertia
REYNOLDS_OUTSIDE = 1.0  # Reduced Reynolds number beyond which Reynolds' equation does not apply


def suction(subject: Subject) -> Check:
    """Return the check of the suction behind the contact against the pressure of the atmosphere."""
    contact = subject.contact
    note = subject.note(SUCTION_PREFIX)
    if subject.models("cavitation") and not note:
        return Check("suction", 0.0, ATMOSPHERE, "fine", f"Cavitation is modelled ({subject.models('cavitation')}).", "Pa")
    if contact.speed == 0:
        return Check("suction", 0.0, ATMOSPHERE, "fine", "At rest there is no suction.", "Pa")
    value = subject.solution.largest_suction
    sentence = note or (
        f"Suction behind the contact is {number_text(value, 'Pa')}, less than an atmosphere; with air at the outlet the film "
        "may break even so."
    )
    return Check("suction", value, ATMOSPHERE, "doubtful" if note else "fine", sentence, "Pa")


def fluid_laws(subject: Subject) -> Check | None:
    """Return the check of how many laws of the fluid are left by the state; None where no law has a range."""
    if not subject.models("fluid") and not subject.models("flow_factors"):
        return None
    notes = subject.note(FLUID_PREFIX)
    left = notes.count(FLUID_PREFIX)
    sentence = notes or "The film lies inside the range of the laws of its fluid."
    return Check("laws of the fluid left", left, 0.0, "doubtful" if left else "fine", sentence)


def thickness(subject: Subject) -> Check | None:
    """Return the check of the film of a ball over its radius; None of cylinders."""
    contact = subject.contact
    if contact.groups.geometry != "point":
        return None
    ratio = subject.solution.central_gap * contact.slope**2
    note = subject.note(THICK_PREFIX)
    sentence = note or f"The film is {ratio:.2g} radii thick, which is thin."
    return Check("film over radius", ratio, MAX_FILM_SLOPE, "doubtful" if note else "fine", sentence)


def wetted_disc(subject: Subject) -> Check | None:
    """Return the check of the disc of liquid around a ball; None where it has no edge."""
    radius = getattr(subject.contact, "wetted_radius", None)
    if radius is None:
        return None
    ratio = radius / subject.contact.hertz.half_width
    note = subject.note(WETTED_PREFIX)
    sentence = note or f"The liquid ends at {ratio:.2g} Hertz radii, where friction alone feels its edge."
    verdict: Verdict = "doubtful" if note else "fine"
    return Check("edge of the liquid over a", ratio, FAR_FILM_MIN_RADIUS, verdict, sentence, at_least=True)


def shear_rate(subject: Subject) -> Check:
    """Return the check of the shear rate at the minimum film against that at which the fluid thins."""
    contact, film = subject.contact, _minimum_film(subject)
    # Where surfaces roll, the pressure shears the film at a rate of this order.
    rate = max(contact.speed, _sliding_speed(subject)) / film if film > 0 else math.inf
    given = subject.fact("thinning_rate")
    usual = OIL_THINNING_RATE if contact.viscosity > SMALL_MOLECULE_VISCOSITY else WATER_THINNING_RATE
    limit = usual if given is None else given
    if getattr(getattr(contact, "fluid", None), "rheology", None) is not None:
        return Check("shear rate", rate, math.inf, "fine", f"Thinning is modelled ({subject.models('fluid')}).", "1/s")
    outside = math.inf if given is None else THINNING_OUTSIDE_RATIO * limit
    verdict = verdict_of(rate, limit, outside)
    about = f"The shear rate at the minimum film is {rate:.2g} 1/s"
    if verdict == "fine":
        who = (
            "the fluid thins"
            if given is not None
            else "oils may begin to thin"
            if usual < WATER_THINNING_RATE
            else "water thins"
        )
        sentence = f"{about}, below {limit:.2g} 1/s at which {who}."
    else:
        who = "oils with improvers and all polymer solutions are thinner" if given is None else "the fluid is thinner"
        sentence = (
            f"{about}: {who} there than at rest. Give the viscosity at that rate, or a law of shear thinning in [fluid]."
        )
    return Check("shear rate", rate, limit, verdict, sentence, "1/s")


def supply(subject: Subject) -> Check | None:
    """Return the check of the film that passes against the film that arrives; None where that is not known."""
    arriving = subject.fact("supply_film")
    if arriving is None or subject.contact.speed == 0:
        return None
    passing = subject.film(subject.passing_gap) / 2
    ratio = passing / arriving if arriving > 0 else math.inf
    meanings: dict[Verdict, str] = {
        "fine": "the inlet is flooded.",
        "doubtful": "the inlet is close to starvation: the film is thinner than computed.",
        "outside": "more than is supplied. The contact is starved, and the supply sets its film.",
    }
    begin = f"Half of h*, {number_text(passing, 'm')}, passes the contact and {number_text(arriving, 'm')} arrives: "
    return check_against_limits("supply h*/(2 supply)", ratio, SUPPLY_FINE, SUPPLY_OUTSIDE, begin, meanings)


def stroke(subject: Subject) -> Check | None:
    """Return the check of the stroke against the contact width; None where the speed is steady, or no stroke is known."""
    length = subject.fact("stroke")
    if length is None:
        return None
    ratio = length / subject.contact.hertz.half_width
    meanings: dict[Verdict, str] = {
        "fine": "the film follows the speed, but for the ends of the stroke.",
        "doubtful": "near its ends the film lags behind the speed, and friction is off by tens of per cent.",
        "outside": "the film of the fast phase stays at its ends. A curve at steady speeds is not its friction.",
    }
    begin = f"The stroke is {ratio:.3g} times the {subject.contact.WIDTH}: "
    return check_against_limits("stroke over a", ratio, STROKE_FINE, STROKE_OUTSIDE, begin, meanings)


def molecules(subject: Subject) -> Check:
    """Return the check of the thinnest film against the size of molecules."""
    given = subject.fact("molecular_size")
    usual = OIL_MOLECULE_SIZE if subject.contact.viscosity > SMALL_MOLECULE_VISCOSITY else WATER_MOLECULE_SIZE
    size = usual if given is None else given
    film = _minimum_film(subject)
    meanings: dict[Verdict, str] = {
        "fine": "the fluid is a continuum.",
        "doubtful": "molecular layering begins to matter.",
        "outside": "a viscosity means little there.",
    }
    begin = f"The minimum film is {number_text(film, 'm')}, {film / size:.2g} molecules of {number_text(size, 'm')}: "
    limits = MOLECULES_FINE * size, MOLECULES_OUTSIDE * size
    return check_against_limits("film against molecules", film, *limits, begin, meanings, "m")


def heating(subject: Subject) -> Check:
    r"""Return the check of shear heating: the viscosity lost, :math:`\beta_T \eta (u_1 - u_2)^2/(8 k)`."""
    contact = subject.contact
    k = subject.fact("thermal_conductivity") or OIL_CONDUCTIVITY
    slope = subject.fact("thermal_thinning")
    slope = OIL_THERMAL_THINNING if slope is None else slope
    kelvin = contact.viscosity * _sliding_speed(subject) ** 2 / (8 * k)
    lost = slope * kelvin
    verdict = verdict_of(lost, HEATING_FINE, HEATING_OUTSIDE)
    sentence = f"Shear heats the film by up to {kelvin:.2g} K, which costs {format_percent(lost)} of its viscosity" + (
        "." if verdict == "fine" else "; the model is isothermal: give the viscosity at the temperature of the film."
    )
    return Check("viscous heating", lost, HEATING_FINE, verdict, sentence)


def inertia(subject: Subject) -> Check:
    r"""Return the check of the fluid's inertia: the reduced Reynolds number :math:`\rho U h^{*2}/(\eta a)`."""
    contact = subject.contact
    density = subject.fact("density") or WATER_DENSITY
    film = subject.film(subject.passing_gap)
    number = density * contact.speed * film**2 / (contact.viscosity * contact.hertz.half_width)
    neglected = "Reynolds' equation neglects inertia, which matters here."
    meanings: dict[Verdict, str] = {
        "fine": "the inertia of the fluid is negligible.", "doubtful": neglected, "outside": neglected
    }  # fmt: skip
    begin = f"The reduced Reynolds number is {number:.2g}: "
    return check_against_limits("inertia", number, REYNOLDS_FINE, REYNOLDS_OUTSIDE, begin, meanings)


def _sliding_speed(subject: Subject) -> float:
    return 0.5 * abs(slide_to_roll(subject.contact)) * subject.contact.speed


def _minimum_film(subject: Subject) -> float:
    return subject.film(subject.solution.minimum_gap)
