"""The solved states of the whole box as smooth functions: load shares and films of a million states a second.

What the solver computes in milliseconds is read here from a table of solved states, :mod:`stribeck.atlas.table`, in less
than a microsecond.  Nothing is extrapolated: outside the box of a table every function refuses.  The
error, against states that the table was not made from, is in docs/atlas.md; for single answers the solver remains the default.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from stribeck.atlas.lookup import (
    CENTRAL,
    DEFLECTION,
    FLUX,
    MINIMUM,
    ODDS,
    Value,
    contact_share,
    documented,
    look_up,
    reshape_to_groups,
)
from stribeck.atlas.tables import TABLES
from stribeck.contacts.groups import Groups
from stribeck.quantities.units import InputError, show


@documented("Load share [-], 1 at rest, 0 for smooth contacts and where it is below 1e-13.")
def contact_load_share(groups: Groups) -> Value:
    """Return the part of the load on the asperities."""
    return reshape_to_groups(groups, contact_share(look_up(groups, (ODDS,)).values.values[0]))


@documented("Load share [-], 0 at rest, 1 for smooth contacts.")
def fluid_load_share(groups: Groups) -> Value:
    """Return the part of the load on the fluid, without loss of digits where it is small."""
    return reshape_to_groups(groups, contact_share(-look_up(groups, (ODDS,)).values.values[0]))


@documented("Gap [u_Hz].")
def central_gap(groups: Groups) -> Value:
    """Return the gap at the centre."""
    return _gap(groups, CENTRAL)


@documented("Gap [u_Hz].")
def minimum_gap(groups: Groups) -> Value:
    """Return the minimum gap."""
    return _gap(groups, MINIMUM)


@documented("Gap [u_Hz].")
def flux_gap(groups: Groups) -> Value:
    """Return the gap that carries the flux, h*; a ball, whose film has no one flux, is refused."""
    return _gap(groups, FLUX)


@documented("Offset [u_Hz], of cylinders in the gauge ln(abs(x-y)/a).")
def offset(groups: Groups) -> Value:
    """Return the height of the apex over the undeformed surface."""
    values = look_up(groups, (CENTRAL, DEFLECTION)).values
    return reshape_to_groups(groups, np.exp(values.values[0]) + values.values[1])


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
    return reshape_to_groups(groups, np.exp(look_up(groups, (name,)).values.values[0]))
