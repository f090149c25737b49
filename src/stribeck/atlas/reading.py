r"""The solved states of the whole box as smooth functions: friction, load shares and films of a million states a second.

What the solver computes in milliseconds is read here from a table of solved states, :mod:`stribeck.atlas.table`, in less
than a microsecond, with derivatives.  Nothing is extrapolated: outside the box of a table every function refuses.  The
error, against states that the table was not made from, is in docs/atlas.md; for single answers the solver remains the default.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from stribeck._types import Array
from stribeck.atlas.grid import HEAVY, NEARLY_SMOOTH
from stribeck.atlas.table import TABULATED, Values, solver_hash
from stribeck.atlas.tables import BOX, SLACK, TABLES, covers, for_groups, holds_for, table_for
from stribeck.contacts.friction import Definition, check_definition
from stribeck.contacts.line import Groups, InputError
from stribeck.numerics.threads import one_blas_thread
from stribeck.quantities.inputs import quantity, refuse_former
from stribeck.quantities.units import show
from stribeck.solids import hertz

__all__ = [
    "BOX",
    "info",
    "central_gap",
    "contact_load_share",
    "covers",
    "flux_gap",
    "fluid_load_share",
    "for_groups",
    "friction",
    "friction_derivatives",
    "friction_parts",
    "holds_for",
    "minimum_gap",
    "offset",
    "shares_and_friction",
    "viscous_friction",
]

ODDS, CENTRAL, MINIMUM, FLUX, DEFLECTION = (
    TABULATED.index(name) for name in ("log_odds", "central_gap", "minimum_gap", "flux_gap", "deflection")
)

Value = float | Array


@refuse_former
def friction(groups: Groups, boundary_friction: float = 1.0, beta: float = 1.0, definition: Definition = "balanced") -> Value:
    r"""Return the friction coefficient.

    .. math:: \mu = \mu_0 \frac{F_c}{F_N} + \mu_f

    Parameters
    ----------
    groups : Groups
        The states [-]; arrays broadcast.
    boundary_friction, beta : float
        Friction coefficient of the dry contact and coefficient of the contact law [-].
    definition : {"balanced", "published"}
        Definition of the viscous friction, theory.md, section 6.

    Returns
    -------
    float or ndarray
        Friction coefficient [-].

    Raises
    ------
    InputError
        If a state is outside the box of its table, or an argument is wrong.

    Notes
    -----
    Both parts are positive, so that its relative error is at most the larger of theirs.
    """
    boundary_friction, beta, row = quantity("boundary_friction", boundary_friction), quantity("beta", beta), _row(definition)
    flat, values = _read(groups, (ODDS, row))
    odds, viscous = values.values
    return _shaped(groups, boundary_friction * _contact(odds) + _viscous(flat, viscous, beta))


def viscous_friction(groups: Groups, beta: float = 1.0, definition: Definition = "balanced") -> Value:
    """Return the part of the friction coefficient that the fluid causes.

    Parameters
    ----------
    groups : Groups
        The states [-]; arrays broadcast.
    beta : float
        Coefficient of the contact law [-].
    definition : {"balanced", "published"}
        Definition of the viscous friction, theory.md, section 6.

    Returns
    -------
    float or ndarray
        Friction coefficient [-]; zero at rest.

    Raises
    ------
    InputError
        If a state is outside the box of its table, or an argument is wrong.
    """
    beta, row = quantity("beta", beta), _row(definition)
    flat, values = _read(groups, (row,))
    return _shaped(groups, _viscous(flat, values.values[0], beta))


@refuse_former
def friction_derivatives(
    groups: Groups, boundary_friction: float = 1.0, beta: float = 1.0, definition: Definition = "balanced"
) -> Array:
    r"""Return the derivatives of the friction coefficient with respect to the logarithms of the groups.

    .. math:: \frac{\partial \mu}{\partial \ln \lambda}, \quad \frac{\partial \mu}{\partial \ln \bar F_N}, \quad
        \frac{\partial \mu}{\partial \ln \bar h_\mathrm{rms}}

    Parameters
    ----------
    groups : Groups
        The states [-]; arrays broadcast.
    boundary_friction, beta : float
        Friction coefficient of the dry contact and coefficient of the contact law [-].
    definition : {"balanced", "published"}
        Definition of the viscous friction, theory.md, section 6.

    Returns
    -------
    ndarray, shape (3, ...)
        By ln(speed), ln(load) and ln(roughness), the other two groups held [-]; the last is zero for smooth contacts.

    Raises
    ------
    InputError
        If a state is outside the box of its table, or an argument is wrong.

    Notes
    -----
    Exact derivatives of :func:`friction`, shown by ``test_atlas.py``; zero at rest.
    """
    boundary_friction, beta = quantity("boundary_friction", boundary_friction), quantity("beta", beta)
    _, contact_slopes, viscous_slopes = friction_parts(groups, definition)
    return boundary_friction * contact_slopes + beta * viscous_slopes


def friction_parts(groups: Groups, definition: Definition = "balanced") -> tuple[Array, Array, Array]:
    r"""Return both parts of the friction for boundary_friction = beta = 1, and the derivatives of each.

    .. math:: \mu = \mu_0 \frac{F_c}{F_N} + \beta \, \mu_f(\beta = 1)

    Parameters
    ----------
    groups : Groups
        The states [-]; arrays broadcast.
    definition : {"balanced", "published"}
        Definition of the viscous friction, theory.md, section 6.

    Returns
    -------
    ndarray, shape (2, ...)
        Contact load share, and viscous friction for beta = 1 [-].
    ndarray, shape (3, ...)
        Derivatives of the first by ln(speed), ln(load) and ln(roughness), the other two groups held [-].
    ndarray, shape (3, ...)
        Those of the second.

    Raises
    ------
    InputError
        If a state is outside the box of its table, or the definition unknown.

    Notes
    -----
    One reading of the table gives all, for fits in which boundary_friction and beta differ from state to state.
    """
    flat, values = _read(groups, (ODDS, _row(definition)), slopes=True)
    assert values.slopes is not None
    contact, viscous = _contact(values.values[0]), _viscous(flat, values.values[1], 1.0)
    # By ln(speed), -ln(load), ln(kappa), with kappa = roughness/load.
    of_contact = -contact * (1 - contact) * values.slopes[:, 0]
    of_viscous = viscous * values.slopes[:, 1]
    slopes = []
    for (by_speed, by_log_load, by_kappa), part in ((of_contact, 0.0), (of_viscous, viscous)):
        found = np.stack([by_speed + part, 0.5 * part - by_log_load - by_kappa, by_kappa])
        found[:, flat[0] == 0] = 0.0
        slopes.append(found.reshape(3, *groups.shape))
    return np.stack([contact, viscous]).reshape(2, *groups.shape), slopes[0], slopes[1]


@refuse_former
def shares_and_friction(
    groups: Groups, boundary_friction: float = 1.0, beta: float = 1.0, definition: Definition = "balanced"
) -> Array:
    """Return at once what tells the regimes apart, at the cost of one of its parts.

    Parameters
    ----------
    groups : Groups
        The states [-]; arrays broadcast.
    boundary_friction, beta : float
        Friction coefficient of the dry contact and coefficient of the contact law [-].
    definition : {"balanced", "published"}
        Definition of the viscous friction, theory.md, section 6.

    Returns
    -------
    ndarray, shape (4, ...)
        :func:`fluid_load_share`, :func:`contact_load_share`, :func:`viscous_friction`, and the derivative of :func:`friction`
        by ln(speed) [-].

    Raises
    ------
    InputError
        If a state is outside the box of its table, or an argument is wrong.
    """
    boundary_friction, beta, row = quantity("boundary_friction", boundary_friction), quantity("beta", beta), _row(definition)
    flat, values = _read(groups, (ODDS, row), slopes=True)
    assert values.slopes is not None
    odds = values.values[0]
    contact, viscous = _contact(odds), _viscous(flat, values.values[1], beta)
    by_speed = viscous * (1 + values.slopes[0, 1]) - boundary_friction * contact * (1 - contact) * values.slopes[0, 0]
    by_speed[flat[0] == 0] = 0.0
    return np.stack([_contact(-odds), contact, viscous, by_speed]).reshape(4, *groups.shape)


def contact_load_share(groups: Groups) -> Value:
    """Return the part of the load on the asperities.

    Parameters
    ----------
    groups : Groups
        The states [-]; arrays broadcast.

    Returns
    -------
    float or ndarray
        Load share [-]: 1 at rest, 0 for smooth contacts and where it is below 1e-13.

    Raises
    ------
    InputError
        If a state is outside the box of its table.
    """
    return _shaped(groups, _contact(_read(groups, (ODDS,))[1].values[0]))


def fluid_load_share(groups: Groups) -> Value:
    """Return the part of the load on the fluid, without loss of digits where it is small.

    Parameters
    ----------
    groups : Groups
        The states [-]; arrays broadcast.

    Returns
    -------
    float or ndarray
        Load share [-]: 0 at rest, 1 for smooth contacts.

    Raises
    ------
    InputError
        If a state is outside the box of its table.
    """
    return _shaped(groups, _contact(-_read(groups, (ODDS,))[1].values[0]))


def central_gap(groups: Groups) -> Value:
    """Return the gap at the centre.

    Parameters
    ----------
    groups : Groups
        The states [-]; arrays broadcast.

    Returns
    -------
    float or ndarray
        Gap [u_Hz].

    Raises
    ------
    InputError
        If a state is outside the box of its table.
    """
    return _gap(groups, CENTRAL)


def minimum_gap(groups: Groups) -> Value:
    """Return the minimum gap.

    Parameters
    ----------
    groups : Groups
        The states [-]; arrays broadcast.

    Returns
    -------
    float or ndarray
        Gap [u_Hz].

    Raises
    ------
    InputError
        If a state is outside the box of its table.
    """
    return _gap(groups, MINIMUM)


def flux_gap(groups: Groups) -> Value:
    """Return the gap that carries the flux, h*.

    Parameters
    ----------
    groups : Groups
        The states [-]; arrays broadcast.

    Returns
    -------
    float or ndarray
        Gap [u_Hz].

    Raises
    ------
    InputError
        If a state is outside the box of its table.
    """
    return _gap(groups, FLUX)


def offset(groups: Groups) -> Value:
    """Return the height of the apex over the undeformed surface.

    Parameters
    ----------
    groups : Groups
        The states [-]; arrays broadcast.

    Returns
    -------
    float or ndarray
        Offset [u_Hz], in the gauge ln(abs(x-y)/a).

    Raises
    ------
    InputError
        If a state is outside the box of its table.
    """
    _, values = _read(groups, (CENTRAL, DEFLECTION))
    return _shaped(groups, np.exp(values.values[0]) + values.values[1])


def info(name: str = TABLES[0].name) -> dict[str, Any]:
    """Return where a table comes from, where it holds and how well.

    Parameters
    ----------
    name : str
        Name of the table, one of ``tables`` below.

    Returns
    -------
    dict
        ``version`` and ``solver_hash`` of the solver that made it, whether that is the ``same_solver`` as the installed one,
        number of ``states`` and their tolerance ``rtol``; its ``geometry``, ``law``, ``cavitation`` and ``box``, and the
        relative ``error`` of the friction that is stated; the names of all ``tables``.

    Raises
    ------
    InputError
        If there is no table of this name.

    Notes
    -----
    A solver whose sources changed keeps the table: whether its numbers moved too is for the certificate to say.
    """
    rows = {row.name: row for row in TABLES}
    if name not in rows:
        raise InputError(f"name = {show(name)}; the tables of the atlas are {', '.join(rows)}.")
    row = rows[name]
    made = row.table.about
    about = {key: getattr(row, key) for key in ("geometry", "law", "cavitation", "box", "error")}
    return {**made, "same_solver": made["solver_hash"] == solver_hash(), **about, "tables": tuple(rows)}


Flat = tuple[Array, Array, Array]


@one_blas_thread
def _read(groups: Groups, functions: tuple[int, ...], slopes: bool = False) -> tuple[Flat, Values]:
    """Return speed, load and relative roughness as flat arrays inside the box, and the functions of the table there."""
    held = table_for(groups)
    box, grid = held.box, held.grid
    speed, load, kappa = (
        np.broadcast_to(np.asarray(value, dtype=float), groups.shape).ravel()
        for value in (groups.speed, groups.load, groups.relative_roughness)
    )
    for name, values in (("speed", speed), ("load", load), ("relative_roughness", kappa)):
        _check(name, values, *box[name], zero=name != "load")
    with np.errstate(divide="ignore"):
        log_speed = np.log(speed)
    log_load = grid.log_load(load)
    inside = np.where(kappa > 0, np.clip(kappa, *box["relative_roughness"]), 0.0)
    closing = (speed == 0) & (inside > 0) & ~grid.has_rest[grid.region_at(log_load, inside)]
    if FLUX in functions and closing.any():
        raise InputError(
            f"load has the value {load[closing][0]:g} at speed 0; there, at relative roughness below {NEARLY_SMOOTH:g}, the "
            f"atlas holds the flux gap for loads up to {math.exp(-HEAVY):.4g}. Use solve."
        )
    found = held.table.read(functions, log_speed, np.where(closing, HEAVY, log_load), inside, slopes)
    # At rest the load shifts the gap and does nothing else.
    shift = 0.5 * inside[closing] * (log_load[closing] - HEAVY)
    dry = (speed == 0) & (kappa == 0)
    for row, function in enumerate(functions):
        if function in (CENTRAL, MINIMUM):
            found.values[row, closing] = np.log(np.exp(found.values[row, closing]) + shift)
        found.values[row, dry] = hertz.OFFSET if function == DEFLECTION else -math.inf
    return (speed, load, kappa), found


def _check(name: str, values: Array, low: float, high: float, zero: bool) -> None:
    """Refuse values outside a side of the box."""
    outside = (values < low * (1 - SLACK)) | (values > high * (1 + SLACK))
    if zero:
        outside &= values != 0
    if outside.any():
        also = " and 0" if zero else ""
        raise InputError(
            f"{name} has the value {values[outside][0]:g}; the atlas covers {low:g} to {high:g}{also}. Use solve outside."
        )


def _row(definition: str) -> int:
    return TABULATED.index(f"viscous_{check_definition(definition)}")


def _contact(odds: Array) -> Array:
    """Return the contact share of ln(fluid over contact share); the fluid share of its negative."""
    return np.asarray(1 / (1 + np.exp(odds)))


def _viscous(flat: Flat, logs: Array, beta: float) -> Array:
    speed, load, _ = flat
    return np.asarray(beta * np.sqrt(load) * speed * np.exp(logs))


def _gap(groups: Groups, function: int) -> Value:
    _, values = _read(groups, (function,))
    return _shaped(groups, np.exp(values.values[0]))


def _shaped(groups: Groups, flat: Array) -> Value:
    return float(flat[0]) if groups.shape == () else flat.reshape(groups.shape)
