"""The states of the tables of the atlas: how they are chosen, solved along the speed and tabulated."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache, partial
from typing import Any

import numpy as np

from stribeck._types import Array
from stribeck.atlas.grid import MIN_SPEED, Region
from stribeck.atlas.table import FRICTION_RADIUS
from stribeck.atlas.tables import REFERENCE_SPECTRUM, TableRow
from stribeck.contact_laws.law import AsperityLaw
from stribeck.contact_laws.persson import persson_law
from stribeck.contact_laws.spectrum import SelfAffine
from stribeck.contacts.cut_off import far_film
from stribeck.contacts.groups import Groups
from stribeck.curves.stribeck_curve import stribeck_curve
from stribeck.fluids.fluid import Cavitation
from stribeck.solver.solve import solve
from stribeck.solver.solve_error import SolveError

SEGMENT_SHARES = (1.1, 2.6, 6.5, 30.0)  # Minus the logarithms of the contact shares at which the segments of speed end

# Fluid over contact share plus relative growth of the central gap, up to which the coordinate is the squared speed
MAX_YIELD_OF_ROUGHNESS = 0.2

# Central gaps over the relative roughness at the ends of segments that begin at the smallest speed, where asperities may carry
# any share already; the last ends with their share, as elsewhere.
SEGMENT_GAPS = (0.5, 2.0, 6.5)

COLD_START_SHARE = 1e-6  # Contact share below which films that end are solved from cold.

# Share of the fluid over the tolerance below which it is rounding; its law for slow speeds is taken instead.
ROUNDING_SHARE = 1e-4

MIN_CONTACT_SHARE = 1e-20  # Contact share below all segments.

LAW_SEPARATIONS = np.geomspace(1e-4, 60.0, 600)  # Separations at which the law of a table is kept.


@dataclass(frozen=True)
class Plan:
    """How the states of a table are solved."""

    rtol: float = 1e-6
    coarse_rtol: float = 1e-4
    film_rtol: float = 1e-7
    coarse_nodes: tuple[int, int] = (14, 12)  # Nodes of a region in roughness and load of these curves
    coarse_step: float = 0.35  # Their step in the logarithm of the speed
    films: tuple[int, int] = (8, 20)  # Pieces of the smooth films, and nodes of a piece


# Plans of the tables by their names.
PLANS = {
    "line-exponential": Plan(),
    "line-persson": Plan(1e-5, 1e-3, 1e-6, (5, 4), 0.5, (4, 16)),
    "line-exit": Plan(1e-6, 1e-5, 1e-6, (5, 4), 0.5, (6, 16)),
    "ball-exponential": Plan(1e-4, 1e-3, 1e-5, (5, 4), 0.9, (2, 16)),
    "ball-persson": Plan(1e-4, 1e-3, 1e-5, (5, 4), 0.9, (1, 18)),
    "ball-exit": Plan(1e-4, 1e-3, 1e-4, (5, 4), 0.7, (5, 10)),
}


@lru_cache(maxsize=1)
def reference_law() -> AsperityLaw:
    """Return the law of Persson's tables."""
    return persson_law(SelfAffine(**REFERENCE_SPECTRUM))


def law_of(row: TableRow) -> Array | None:
    """Return separations and logarithms of the pressures of the law of a table; None for the exponential one."""
    return None if row.law == "exponential" else np.stack([LAW_SEPARATIONS, reference_law().log_pressure(LAW_SEPARATIONS)])


def groups_of(row: TableRow, speed: float, load: float, kappa: float) -> Groups:
    """Return the groups of a state of a table."""
    law = None if row.law == "exponential" else reference_law()
    like = Groups(1.0, 1.0, 0.0, law=law, geometry=row.geometry, model=row.model)
    return Groups(speed, load, kappa * load**like.scaling.roughness_exponent, **like.physics)


def solved(row: TableRow, log_speeds: Array, log_load: float, kappa: float, rtol: float) -> Array:
    """Return the tabulated functions along ascending speeds, shape (speeds, functions)."""
    load = row.grid.load_at(log_load)
    curve = _at_least(partial(stribeck_curve, groups_of(row, 1.0, load, kappa), speed=np.exp(log_speeds)), rtol)
    states = dict(zip(np.log(curve.values).round(9).tolist(), curve.solutions, strict=True))
    for s in log_speeds.tolist():
        if round(s, 9) not in states:  # not reached from its neighbours: from cold, and finer
            states[round(s, 9)] = solve(groups_of(row, math.exp(s), load, kappa), rtol=0.1 * rtol)
    found = [states[round(s, 9)].observables for s in log_speeds.tolist()]
    if row.geometry == "line" and row.cavitation is not Cavitation.NONE:
        _resolve_small_contact_shares(row, found, log_speeds, load, kappa, rtol)
    return tabulated(row, found, log_speeds, load)


def _at_least(solving: Callable[..., Any], rtol: float) -> Any:
    """Return a solution to a tolerance, or to three times that if double precision allows no more."""
    try:
        return solving(rtol=rtol)
    except SolveError:
        return solving(rtol=3 * rtol)


def _resolve_small_contact_shares(
    row: TableRow, found: list[Any], log_speeds: Array, load: float, kappa: float, rtol: float
) -> None:
    """Solve states whose asperities carry hardly any load from cold, in place."""
    # Along a curve of films that end the error of their share is bounded against the whole load, not against the share.
    for i, s in enumerate(log_speeds.tolist()):
        if found[i].contact_load_share < COLD_START_SHARE:
            groups = groups_of(row, math.exp(s), load, kappa)
            found[i] = _at_least(partial(solve, groups), rtol).observables
            if found[i].contact_load_share < MIN_CONTACT_SHARE:
                return


def tabulated(row: TableRow, observed: list[Any], log_speeds: Array, load: float) -> Array:
    """Return the functions of a table on solved states, shape (states, functions)."""
    names = TABLED_OBSERVABLES[row.geometry]
    values = dict(zip(names, np.array([[getattr(o, name) for name in names] for o in observed]).T, strict=True))
    with np.errstate(divide="ignore"):
        odds = np.log(values["fluid_load_share"]) - np.log(values["contact_load_share"])
    slow = values["fluid_load_share"] < ROUNDING_SHARE * PLANS[row.name].rtol
    if slow.any() and not slow.all():
        first = int(np.argmin(slow))
        odds[:first] = odds[first] + row.grid.power * (log_speeds[:first] - log_speeds[first])
    central, minimum = np.log(values["central_gap"]), np.log(values["minimum_gap"])
    deflection = values["offset"] - values["central_gap"]
    if row.geometry == "line":
        scale = log_speeds + 0.5 * math.log(load)
        published, balanced = (np.log(values[f"viscous_{name}"]) - scale for name in ("published", "balanced"))
        return np.stack([odds, published, balanced, central, minimum, np.log(values["flux_gap"]), deflection], axis=1)
    speed, far = np.exp(log_speeds), math.log(FRICTION_RADIUS)
    ends = far_film(row.model)
    couette = values["J_couette"] / speed + ends.couette * far
    poiseuille = values["J_poiseuille"] / speed + ends.poiseuille * far
    published = couette + poiseuille - values["J_pcx"] / speed
    drag = [np.log(couette), np.log(poiseuille), np.log(published)]
    return np.stack([odds, *drag, central, minimum, deflection], axis=1)


_SHARED = ("contact_load_share", "fluid_load_share", "central_gap", "minimum_gap", "offset")
# Observables that tables are made from, by geometry.
TABLED_OBSERVABLES = {
    "line": (*_SHARED, "flux_gap", "viscous_published", "viscous_balanced"),
    "point": (*_SHARED, "J_couette", "J_poiseuille", "J_pcx"),
}


# --- where segments end ---


def speed_range(row: TableRow, log_load: float, kappa: float, has_rest: bool = True) -> tuple[float, float]:
    """Return logarithms of speeds from rest to the film without asperities, roughly, by the scales of wedge and film."""
    if row.law == "exponential":
        rest = 0.5 * log_load
        gap = math.log(2) + 0.5 * math.log1p(8 * kappa / math.pi) + rest
    elif not has_rest:
        gap = rest = 1.0
    else:
        rest = float(solve(groups_of(row, 0.0, row.grid.load_at(log_load), kappa), rtol=1e-3).central_gap) / kappa
        gap = rest
    wedge = 2 * math.log(kappa) + math.log(5) + 2.55 * math.log(gap)
    if row.geometry == "point" and row.cavitation is not Cavitation.NONE:
        film, last = (_log_speed_of_cavitated_film(kappa * s) for s in (gap, gap + SEGMENT_SHARES[-1]))
    else:
        film, last = (math.log((kappa * s / 0.446) ** (5 / 3) + (2.88 * kappa * s) ** 1.5) for s in (gap, max(gap, 1.0)))
    half = -float(np.logaddexp(-wedge, -film))
    yielding = 2.5 * max(0.0, -math.log(rest * 2 + 2 * kappa / (1 + kappa))) if row.law == "exponential" else 0.0
    slower = 2 / row.grid.power
    return half - slower * math.log(60) - yielding, last + math.log(300)


def _log_speed_of_cavitated_film(gap: float) -> float:
    """Return the logarithm of a hundredth of the speed at which a cavitated film has a central gap."""
    # A rigid ball has 0.2249 speed**2, so that speeds differ less than in full films, and so do the margins of a curve.
    return math.log(0.01 / ((gap / 0.446) ** (-5 / 3) + (gap / 0.2249) ** -0.5))


def breaks_on(row: TableRow, log_speeds: Array, found: Array, kappa: float, has_rest: bool) -> Array:
    """Return b_1 .. b_5 on a coarse curve; b_1 is the minimum speed where segments do not begin at rest."""
    from scipy.interpolate import PchipInterpolator

    odds, central = found[:, 0], np.exp(found[:, row.functions.index("central_gap")])
    there = np.isfinite(odds) & (odds < 600)
    there[there] &= np.append(True, odds[there][1:] > np.maximum.accumulate(odds[there])[:-1])  # the rest is rounding
    s, odds, central = log_speeds[there], odds[there], central[there]
    if not has_rest and row.law != "exponential":
        ends = PchipInterpolator(np.log(central), s)(np.log(kappa * np.array(SEGMENT_GAPS)))
        last = PchipInterpolator(odds, s)(SEGMENT_SHARES[-1])
        return np.array([math.log(row.box["speed"][0]), *ends.tolist(), float(last)])
    first = math.log(MIN_SPEED)
    if has_rest:
        yielding = np.exp(odds) + central / central[0] - 1
        early = np.arange(1, 1 + int(np.argmax(yielding > 8 * MAX_YIELD_OF_ROUGHNESS)))
        early = early[yielding[early] > 0.02]  # below is the tolerance of the states
        first = float(PchipInterpolator(np.log(yielding[early]), s[early])(math.log(MAX_YIELD_OF_ROUGHNESS)))
    return np.array([first, *PchipInterpolator(np.logaddexp(0, odds), s)(SEGMENT_SHARES).tolist()])


def coarse_breaks(row: TableRow, region: Region, log_load: float, kappa: float) -> Array:
    """Return b_1 .. b_5 of one load and roughness."""
    plan = PLANS[row.name]
    low, high = speed_range(row, log_load, kappa, region.has_rest)
    if not region.has_rest:
        low = math.log(row.box["speed"][0])
    speeds = np.linspace(low, high, max(12, int((high - low) / plan.coarse_step)))
    return breaks_on(row, speeds, solved(row, speeds, log_load, kappa, plan.coarse_rtol), kappa, region.has_rest)
