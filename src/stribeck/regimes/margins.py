"""How far a contact is from the next lubrication regime, in speed, load, roughness and viscosity, on solved states."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from stribeck.contact_laws.law import largest_load
from stribeck.contacts.contact import Contact
from stribeck.contacts.friction import Definition, check_definition
from stribeck.contacts.geometries import INPUT_TABLES
from stribeck.contacts.groups import Geometry
from stribeck.contacts.regime import Regime
from stribeck.curves.line_source import LineSource
from stribeck.curves.result import StribeckCurve, path_of
from stribeck.files.datasets import Column, listed
from stribeck.files.results import Labelled, Tabled
from stribeck.numerics.threads import one_blas_thread
from stribeck.quantities.units import InputError, show
from stribeck.regimes.margin_scan import SCANNED, Crossing, Margin, Scan, physical_bounds, scanned_rtol
from stribeck.solver.base_solution import regime_of_state
from stribeck.solver.solve import check_rtol, solve

THRESHOLD = 5e-3  # Logarithm of the factor below which a contact is said to stand at the threshold

NEIGHBOURS: dict[Regime, tuple[Regime, ...]] = {
    "boundary": ("mixed",),
    "mixed": ("boundary", "hydrodynamic"),
    "hydrodynamic": ("mixed",),
}


@dataclass(frozen=True)
class RegimeMargins(Tabled):
    """A contact's regime and the way to its neighbours; its dataset has the changes of regime along ``crossing``."""

    regime: Regime  # The present one
    margins: tuple[Margin, ...]  # For speed, load, roughness and viscosity; the last not for a fluid that thins
    notes: tuple[str, ...]  # Why an input leads nowhere, and whether the contact stands at a threshold
    geometry: Geometry = "line"
    counted: str = ""  # Which errors the intervals count and which inputs count as exact; empty without intervals

    def to_dict(self) -> dict[str, Any]:
        """Return the margins by input, ready for JSON."""
        table = INPUT_TABLES[self.geometry]
        return {margin.name: asdict(margin) | {"unit": table.quantities[margin.name].unit} for margin in self.margins}

    def _labelled(self) -> Labelled:
        table = INPUT_TABLES[self.geometry]
        found = [(margin.name, mark) for margin in self.margins for mark in (margin.less, margin.more) if mark is not None]
        marks = [mark for _, mark in found]
        ends = np.array([mark.interval_95 or (math.nan, math.nan) for mark in marks]).reshape(-1, 2)
        columns: dict[str, Column] = {
            "input": ("crossing", listed([name for name, _ in found]), "1", "input that is changed"),
            "next_regime": ("crossing", listed([mark.regime for mark in marks]), "1", "regime that is entered"),
            "value": ("crossing", [mark.value for mark in marks], "see unit", "value of the input there"),
            "unit": ("crossing", listed([table.quantities[name].unit for name, _ in found]), "1", "SI unit of the value"),
            "factor": ("crossing", [mark.factor for mark in marks], "1", "the same over the present value"),
            "factor_low_95": ("crossing", ends[:, 0], "1", "low end of the 95 % interval of factor"),
            "factor_high_95": ("crossing", ends[:, 1], "1", "high end of the 95 % interval of factor"),
        }
        number: dict[str, Column] = {"crossing": ("crossing", np.arange(len(found)), "1", "number of the change of regime")}
        about = {f"searched_{margin.name}": np.array(margin.searched) for margin in self.margins}
        words = {"regime": self.regime, "notes": "\n".join(self.notes), "counted": self.counted}
        return columns, number, {"title": "Margins to the next regimes", **about, **words}

    @property
    def targets(self) -> tuple[Regime, ...]:
        """The regimes beside the present one, and those that an input enters without passing through them."""
        entered = [mark.regime for margin in self.margins for mark in (margin.less, margin.more) if mark is not None]
        return tuple(dict.fromkeys([*NEIGHBOURS[self.regime], *entered]))

    def is_beyond(self, regime: Regime, margin: Margin) -> bool:
        """Return whether a regime may lie beyond the one at which the search along an input ended."""
        return regime not in NEIGHBOURS[self.regime] and (margin.less is not None or margin.more is not None)


@one_blas_thread
def regime_margins(
    contact: Contact,
    *,
    rtol: float = 1e-6,
    definition: Definition = "balanced",
    on_point: Callable[[int, int], object] | None = None,
    curve: StribeckCurve | None = None,
) -> RegimeMargins:
    """Return by which factors of speed, load, roughness and viscosity the lubrication regime of a contact changes."""
    rtol = check_rtol(rtol)
    definition = check_definition(definition)
    if not isinstance(contact, Contact):
        raise InputError(f"contact = {show(contact)}; it must be a LineContact or PointContact, as margins are in SI units.")
    rtol = scanned_rtol(contact, rtol)
    path = None if curve is None else path_of(curve)
    scan = Scan(contact, "mixed", rtol, definition, on_point, path)
    if curve is not None and curve.values[0] <= contact.speed <= curve.values[-1]:
        there = curve.solve_at(contact.speed)
        if path is not None and isinstance(path.source, LineSource) and curve.rtol <= rtol:
            scan.state = path.source.state_at(math.log(contact.speed))
    else:
        there = solve(contact, rtol=rtol)
    scan.present = present = regime_of_state(there, definition)
    notes = []
    if contact.speed == 0 and contact.roughness > 0:
        notes.append("At zero speed, load, roughness and viscosity do not change the regime.")
    if contact.roughness == 0 and contact.speed > 0:
        notes.append("Smooth surfaces never touch: there is no boundary or mixed lubrication.")
    if contact.friction_of_asperities.is_frictionless:
        notes.append("Without dry friction, all friction is viscous and every state counts as hydrodynamic.")
    if contact.groups.load >= largest_load(contact.law) and contact.roughness > 0:
        notes.append(
            "At load groups of 1 or more, the fluid carries part of the load at every speed; there may be no "
            "boundary lubrication."
        )
    found = [scan.along(name) for name in SCANNED]
    if contact.friction_of_asperities.uses_speed:
        notes.append("Viscosity has no margins: the stress of the asperities follows the speed, which does not stand for it.")
    elif contact.replace(viscosity=2 * contact.viscosity).groups.model == contact.groups.model:
        found.append(_within(_of_viscosity(contact, found[0]), physical_bounds(contact, "viscosity")))
    else:
        notes.append("Viscosity has no margins: this fluid thins with the shear rate, so that speed does not stand for it.")
    if contact.speed > 0:
        found[0] = _within(found[0], physical_bounds(contact, "speed"))
    marks = [mark for margin in found for mark in (margin.less, margin.more) if mark is not None]
    close = [mark for mark in marks if 0 < mark.factor < math.inf and abs(math.log(mark.factor)) < THRESHOLD]
    if close:
        notes.append(f"The contact is at the threshold to {close[0].regime} lubrication.")
    return RegimeMargins(present, tuple(found), tuple(notes), contact.groups.geometry)


def _within(margin: Margin, bounds: tuple[float, float]) -> Margin:
    """Return a margin without what lies beyond the bounds of its input."""
    low, high = bounds
    ends = max(margin.searched[0], low), min(margin.searched[1], high)
    less, more = (mark if mark is not None and low <= mark.value <= high else None for mark in (margin.less, margin.more))
    return Margin(margin.name, less, more, ends)


def _of_viscosity(contact: Contact, speed: Margin) -> Margin:
    """Return the margins in viscosity that those in speed are; a resting contact has none."""
    eta = contact.viscosity
    if contact.speed == 0:
        return Margin("viscosity", None, None, (eta, eta))
    less, more = (
        None if mark is None else Crossing(mark.regime, eta * mark.factor, mark.factor) for mark in (speed.less, speed.more)
    )
    low, high = (eta * (end / contact.speed) for end in speed.searched)
    return Margin("viscosity", less, more, (low, high))
