"""The solved states of the whole box as smooth functions: load shares, films and friction of a million states a second.

What the solver computes in milliseconds is read here from a table of solved states, :mod:`stribeck.atlas.table`, in less
than a microsecond.  Nothing is extrapolated: outside the box of a table every function refuses.  The
error, against states that the table was not made from, is in docs/atlas.md; for single answers the solver remains the default.
"""

import math
from functools import partial
from typing import Any

import numpy as np

from stribeck._types import Array
from stribeck.atlas.lookup import (
    CENTRAL,
    DEFLECTION,
    FLUX,
    MINIMUM,
    ODDS,
    contact_share,
    friction_terms,
    look_up,
    read_friction,
    viscous_of,
)
from stribeck.atlas.tables import TABLES
from stribeck.contacts.friction import Definition, check_definition
from stribeck.contacts.friction_rules import RULES
from stribeck.contacts.geometries import LINE
from stribeck.contacts.groups import Groups
from stribeck.contacts.parts import PURE_SLIDING
from stribeck.numerics.dual import slope_of, value_of
from stribeck.quantities.docstrings import told
from stribeck.quantities.keywords import answers_typos
from stribeck.quantities.units import InputError, checked_kind, show

Value = float | Array

# What docstrings say of the arguments of all functions of states.
ARGUMENTS = {
    "groups": "Groups\n    The states [-]; arrays broadcast.",
    "boundary_friction": "float\n    Friction coefficient of the dry contact [-].",
    "beta": "float\n    Coefficient of the contact law [-].",
    "definition": """{"balanced", "published"}
    Definition of the viscous friction, theory.md, section 6.""",
    "slide_to_roll": "float\n    Slide-to-roll ratio of a ball [-].",
    "wetted_radius": """float or ndarray
    Radius of the disc of liquid around a ball, from 5 on [a]; infinite where the whole ball is immersed.""",
}
RAISES = "InputError\n    If a state is outside the box of its table, or an argument is wrong."

documented = partial(told, ARGUMENTS, raises=RAISES)


@documented("float or ndarray\n    Load share [-], 1 at rest, 0 for smooth contacts and where it is below 1e-13.")
def contact_load_share(groups: Groups) -> Value:
    """Return the part of the load on the asperities."""
    return _shaped(groups, contact_share(look_up(groups, (ODDS,)).values[0]))


@documented("float or ndarray\n    Load share [-], 0 at rest, 1 for smooth contacts.")
def fluid_load_share(groups: Groups) -> Value:
    """Return the part of the load on the fluid, without loss of digits where it is small."""
    return _shaped(groups, contact_share(-look_up(groups, (ODDS,)).values[0]))


@documented("float or ndarray\n    Gap [u_Hz].")
def central_gap(groups: Groups) -> Value:
    """Return the gap at the centre."""
    return _gap(groups, CENTRAL)


@documented("float or ndarray\n    Gap [u_Hz].")
def minimum_gap(groups: Groups) -> Value:
    """Return the minimum gap."""
    return _gap(groups, MINIMUM)


@documented("float or ndarray\n    Gap [u_Hz].")
def flux_gap(groups: Groups) -> Value:
    """Return the gap that carries the flux, h*; a ball, whose film has no one flux, is refused."""
    return _gap(groups, FLUX)


@documented("float or ndarray\n    Offset [u_Hz], of cylinders in the gauge ln(abs(x-y)/a).")
def offset(groups: Groups) -> Value:
    """Return the height of the apex over the undeformed surface."""
    log_gap, deflection = look_up(groups, (CENTRAL, DEFLECTION)).values
    return _shaped(groups, np.exp(log_gap) + deflection)


@documented("float or ndarray\n    Friction coefficient [-].")
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
    inputs = _inputs(groups, beta, slide_to_roll, wetted_radius)
    contact, viscous = friction_terms(groups, inputs, check_definition(definition))
    return _shaped(groups, _rubbing(groups, boundary_friction, inputs) * contact + viscous)


@documented("float or ndarray\n    Friction coefficient [-]; zero at rest.")
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
    return _shaped(groups, friction_terms(groups, inputs, check_definition(definition))[1])


@documented(
    "ndarray, shape (3, ...)\n    By ln(speed), ln(load) and ln(roughness), the other two groups held [-]; the last is zero "
    "for smooth contacts."
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
    inputs = _inputs(groups, beta, slide_to_roll, wetted_radius)
    contact, viscous = friction_terms(groups, inputs, check_definition(definition), slopes=3)
    found = slope_of(_rubbing(groups, boundary_friction, inputs) * contact + viscous)
    return np.asarray(found.reshape(3, *groups.shape))


@documented(
    "ndarray, shapes (1 + parts, ...) and (1 + parts, 3, ...)\n    Contact load share and the observables that friction "
    "takes, of cylinders the viscous friction for beta = 1 [-]; their derivatives by ln(speed), ln(load) and ln(roughness)."
)
def friction_parts(groups: Groups, definition: Definition = "balanced") -> tuple[Array, Array]:
    """Return what the friction is made of, without the coefficients that it takes beside, and the derivatives of each.

    Notes
    -----
    One reading of the table gives all, for fits in which boundary_friction and beta differ from state to state.
    """
    checked_kind("groups", groups, Groups, "Groups(speed, load, roughness)")
    reading = read_friction(groups, check_definition(definition), slopes=3)
    found = [reading.contact, *(reading.parts[name] for name in RULES[groups.geometry].parts(definition))]
    values, slopes = np.stack([value_of(each) for each in found]), np.stack([slope_of(each) for each in found])
    return values.reshape(len(values), *groups.shape), slopes.reshape(len(values), 3, *groups.shape)


@documented(
    "ndarray, shape (4, ...)\n    Load shares of fluid and asperities, :func:`viscous_friction`, and the derivative of "
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
    inputs = _inputs(groups, beta, slide_to_roll, wetted_radius)
    reading = read_friction(groups, check_definition(definition), slopes=1)
    contact, viscous = reading.contact, viscous_of(groups, reading, inputs, definition)
    by_speed = slope_of(_rubbing(groups, boundary_friction, inputs) * contact + viscous)[0]
    found = contact_share(-value_of(reading.odds)), value_of(contact), value_of(viscous), by_speed
    return np.stack(found).reshape(4, *groups.shape)


def info(name: str = TABLES[0].name) -> dict[str, Any]:
    """Return where a table comes from, where it holds and how well.

    Parameters
    ----------
    name : str
        Name of the table, one of ``tables`` below.

    Returns
    -------
    dict
        ``version`` and ``solver_hash`` of the package and the sources that made it, number of ``states`` and their tolerance
        ``rtol``; its ``geometry``, ``law``, ``cavitation`` and ``box``, and the relative ``error`` of the friction that is
        stated; the names of all ``tables``.

    Raises
    ------
    InputError
        If there is no table of this name.

    Notes
    -----
    Whether the solver of today gives the same numbers no hash can say: the tests solve states beside every table, and the
    certificate many.
    """
    rows = {row.name: row for row in TABLES}
    if not isinstance(name, str) or name not in rows:
        raise InputError(f"name = {show(name)}; the tables of the atlas are {', '.join(rows)}.")
    row = rows[name]
    made = row.table.about
    about = {key: getattr(row, key) for key in ("geometry", "law", "cavitation", "box", "error")}
    return {**made, **about, "tables": tuple(rows)}


def _gap(groups: Groups, name: str) -> Value:
    return _shaped(groups, np.exp(look_up(groups, (name,)).values[0]))


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


def _rubbing(groups: Groups, boundary_friction: float, inputs: dict[str, Any]) -> float:
    """Return the boundary friction, checked, that acts, with the sign of the sliding."""
    given = LINE.quantities["boundary_friction"].checked(boundary_friction)
    return float(given * RULES[groups.geometry].sliding_factor(groups, inputs))


def _shaped(groups: Groups, values: Array) -> Value:
    """Return flat values in the shape of the groups, a number of a single state."""
    return float(values[0]) if groups.shape == () else values.reshape(groups.shape)
