"""The table of checks, and the function that makes them: a new check is one function and one row."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Literal

from stribeck.cases.case import fact_values
from stribeck.checks import body, film, law
from stribeck.checks.check import Check, Checks
from stribeck.checks.subject import Subject
from stribeck.contacts.contact import Contact
from stribeck.contacts.friction import Definition, check_definition
from stribeck.contacts.groups import Geometry
from stribeck.numerics.threads import one_blas_thread
from stribeck.quantities.units import InputError, show
from stribeck.solver.solution import Solution
from stribeck.solver.solve_error import SolveError

if TYPE_CHECKING:
    from stribeck.curves.result import StribeckCurve

Effort = Literal["contact", "state", "curve", "tail"]

EFFORTS: tuple[Effort, ...] = ("contact", "state", "curve", "tail")  # What a check needs solved, cheapest first


@dataclass(frozen=True)
class Row:
    """One check."""

    name: str  # Name of the check
    check: Callable[[Subject], Check | None]  # Returns the check of a :class:`Subject`, or None if it does not apply
    effort: Effort  # States that must be solved for the check
    missing: str = ""  # Fact that the check needs; empty if none


# All checks, cheapest first.
ROWS = (
    Row("inputs", body.input_sizes, "contact"),
    Row("Hertz pressure", body.pressure, "contact"),
    Row("stiffness", body.stiffness, "contact"),
    Row("contact width", body.width, "contact"),
    Row("shape", body.shape, "contact"),
    Row("adhesion", body.adhesion, "contact", "work_of_adhesion"),
    Row("pores", body.pores, "contact", "diffusivity"),
    Row("layer", body.layer, "contact", "layer_thickness"),
    Row("loss tangent", body.loss, "contact", "loss_tangent"),
    Row("rms slope", law.roughness_slope, "contact", "rms_slope"),
    Row("stroke", film.stroke, "contact", "stroke"),
    Row("viscous heating", film.heating, "contact"),
    Row("contact law at the centre", law.range_at_centre, "state"),
    Row("suction", film.suction, "state"),
    Row("laws of the fluid", film.fluid_laws, "state"),
    Row("film over radius", film.thickness, "state"),
    Row("edge of the liquid", film.wetted_disc, "state"),
    Row("shear rate", film.shear_rate, "state"),
    Row("supply", film.supply, "state", "supply_film"),
    Row("film against molecules", film.molecules, "state"),
    Row("inertia", film.inertia, "state"),
    Row("contact law at the minimum", law.range_at_minimum, "curve"),
    Row("tail of the contact law", law.tail, "tail"),
)


@dataclass(frozen=True)
class Instead:
    """What helps where a check is not fine: what this package has for it, or a public tool for what the model leaves out."""

    sentence: str
    here: bool = False  # Whether this package solves it, so that a doubtful check says so too
    geometry: Geometry | None = None  # The geometry for which it helps; None for both


FINITE_ELEMENTS = Instead("FEBio (finite elements) solves contact at large strain, without a film.")

# By the name of a check in :data:`ROWS`. A check that says by itself what to do has no row.
INSTEAD = {
    "Hertz pressure": (
        Instead(
            "Up to five times the limit a law of pressure in [fluid] (Barus, Roelands) solves it; beyond, slippy computes "
            "such films of hard bodies."
        ),
    ),
    "stiffness": (
        Instead(
            "Tamaas solves dry contact of rough bodies that yield; slippy adds a film whose viscosity grows with pressure."
        ),
    ),
    "contact width": (FINITE_ELEMENTS,),
    "shape": (FINITE_ELEMENTS,),
    "adhesion": (
        Instead("Tamaas and Adhesion (of ContactEngineering) solve adhesive contact of rough bodies, without a film."),
    ),
    "pores": (Instead("FEBio solves the contact of porous bodies with the liquid in them (biphasic materials)."),),
    "layer": (Instead("Give layer_thickness in [solid]: the layer is then solved.", here=True),),
    "loss tangent": (
        Instead("Give E' and E'' over the frequency as [solid] master_curve: it is then solved.", here=True, geometry="line"),
        Instead("FEBio (finite elements) solves contact of viscoelastic bodies, without a film.", geometry="point"),
    ),
    "rms slope": (
        Instead("FEBio (finite elements) follows single steep asperities; OpenFOAM solves the flow in the gap between them."),
    ),
    "stroke": (
        Instead("stribeck stroke solves the film over the stroke.", here=True, geometry="line"),
        Instead("GaPFlow solves films between smooth elastic bodies in time.", geometry="point"),
    ),
    "viscous heating": (Instead("OpenFOAM solves flow and temperature together in a given gap."),),
    "supply": (Instead("OpenFOAM (interFoam) solves the surface of the liquid in front of the contact, in a given gap."),),
    "film against molecules": (Instead("LAMMPS moves the molecules; GaPFlow puts its results into films."),),
    "inertia": (
        Instead("GaPFlow keeps inertia in flow averaged over the gap; OpenFOAM solves all of the flow, turbulence too."),
    ),
}


@one_blas_thread
def check(contact: Contact, *, definition: Definition = "balanced", **facts: Any) -> Checks:
    """Check whether the model applies to a contact.

    Parameters
    ----------
    contact : LineContact or PointContact
        The contact.
    definition : {"balanced", "published"}
        Definition of the viscous friction, on which the minimum depends.
    **facts : str or float
        Further facts about the contact: ``pressure_coefficient``, ``layer_thickness``, ``loss_tangent``, ``supply_film``,
        ``stroke``, ``thinning_rate``, ``molecular_size``, ``thermal_conductivity``, ``thermal_thinning``, ``density``,
        ``rms_slope``, ``work_of_adhesion``, ``diffusivity``, ``permeability``;
        text with units, or numbers in SI units.

    Returns
    -------
    Checks
        A :class:`~stribeck.results.Check` for each row of the table: value, limit, verdict and sentence; printed, a table.

    Raises
    ------
    InputError
        If the contact is none, or a fact is unknown or impossible.

    Notes
    -----
    It solves the state, and its curve over the speed twice, once with the tail of a finite surface: about two seconds, and
    2 to 15 of a ball.
    What cannot be solved is named among :attr:`stribeck.results.Checks.unchecked`.
    Source of the limits: docs/checks.md.

    Examples
    --------
    >>> import stribeck as sb
    >>> contact = sb.LineContact(radius=0.01, modulus=2.7e6, load=30, viscosity=0.05, speed=0.02, roughness=1e-6, alpha=2,
    ...                          beta=0.06, boundary_friction=0.7)
    >>> found = sb.check(contact, work_of_adhesion="1 mJ/m^2")
    >>> found.applies, found["contact law at the minimum"].verdict
    (True, 'doubtful')
    """
    if not hasattr(contact, "hertz"):
        raise InputError(f"contact = {show(contact)}; give a LineContact or PointContact, whose inputs are in SI units.")
    return checks_of(Subject(contact, fact_values(facts), check_definition(definition)))


def checks_of(subject: Subject, effort: Effort = "tail") -> Checks:
    """Return the checks of a subject up to a given effort."""
    found, unsolved, missing = [], [], {}
    for row in ROWS:
        if EFFORTS.index(row.effort) > EFFORTS.index(effort):
            continue
        try:
            made = row.check(subject)
        except (SolveError, InputError) as problem:
            unsolved.append(f"{row.name}: {problem}")
            continue
        if made is not None:
            found.append(_with_what_helps(made, row.name, subject.contact.groups.geometry))
        elif row.missing:
            missing[row.name] = row.missing
    return Checks(tuple(found), tuple(unsolved), missing)


def _with_what_helps(check: Check, row: str, geometry: Geometry) -> Check:
    """Return the check of a row, whose sentence ends with what helps if it is outside, or doubtful and solved here."""
    said = [
        each.sentence
        for each in INSTEAD.get(row, ())
        if each.geometry in (None, geometry) and (check.verdict == "outside" or each.here and check.verdict == "doubtful")
    ]
    return replace(check, sentence=" ".join([check.sentence, *said]))


def checks_of_solution(
    solution: Solution, facts: dict[str, float] | None = None, definition: Definition = "balanced"
) -> Checks | None:
    """Return the checks of a solved state; None of groups alone."""
    if solution.contact is None:
        return None
    return checks_of(Subject(solution.contact, facts or {}, definition, solution), "state")


def checks_of_curve(
    curve: StribeckCurve,
    facts: dict[str, float] | None = None,
    *,
    is_whole: bool = False,
    on_point: Callable[[int, int], object] | None = None,
) -> Checks | None:
    """Return the checks of a solved curve, at the last of its points over a load; None of groups alone."""
    if curve.contact is None or not len(curve):
        return None
    over_speed = curve.over == "speed"
    contact = curve.contact if over_speed else curve.solutions[-1].contact
    assert contact is not None
    if is_whole:  # on a curve of its own: this one need not hold the minimum
        found = checks_of(Subject(contact, facts or {}, curve.definition, on_point=on_point))
        return law.add_range_along_curve(found, curve.law_in_doubt)
    subject = Subject(contact, facts or {}, curve.definition, traced=curve if over_speed else None)
    found = checks_of(subject, "contact")
    minimum = law.range_at_minimum(subject) if over_speed else None
    found = replace(found, checks=(*found.checks, *([minimum] if minimum is not None else [])))
    return law.add_range_along_curve(found, curve.law_in_doubt)
