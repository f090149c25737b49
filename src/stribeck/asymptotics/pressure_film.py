r"""Film under any smooth soft profile, from the pressure of its dry contact: made by its edge, or by its steepest rise.

A dry pressure begins as :math:`p = k d^{1/2}` at a distance d from its edge, where an inlet of the length
:math:`\ell = (6 \eta U {E^*}^2/k^3)^{2/5}` lets in the film of a parabola with the same edge.

Source: ours, and the inverse theory of Blok; theory.md, section 13.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, NamedTuple

import numpy as np

from stribeck.asymptotics.constants import FILM_CONSTANT
from stribeck.asymptotics.dry_pressure import DryPressure, rows_of
from stribeck.asymptotics.formula import OutOfRangeWarning
from stribeck.files.datasets import Column
from stribeck.files.results import Labelled, Tabled
from stribeck.quantities.formats import format_percent, format_si
from stribeck.quantities.results import ByValue, Card, Shown, Told
from stribeck.quantities.units import InputError, show, to_si

EDGE_CONSTANT = FILM_CONSTANT * 2**0.2  # h* over (6 eta U)^(3/5) E*^(1/5) k^(-4/5)

# Errors of both laws against solved parabolas, lands and lips (test_film_of_pressure.py), bounded by these multiples.
EDGE_ERROR_FACTOR = 0.2  # of the inlet length over the way from the edge to nine tenths of the peak
INTERIOR_ERROR_FACTOR = 3.5  # of E* h* p'max over the square of the highest pressure
JOINT_ERROR = 0.05  # Where both laws give nearly the same film it is thinner than either by up to this.
NEARLY_EQUAL = 0.85  # Ratio of both films from which they are nearly the same.
NEGLIGIBLE = 0.01  # Part of its error below which a net film is zero.
MAX_LAW_ERROR = 0.07  # Largest error of the laws in their range.

EDGE_ZONE = 2.0  # Inlet lengths from the edge within which a rise belongs to the edge.
MAX_EDGE_ZONE = 0.5  # Largest part of the way to the peak that this zone takes.
MAX_RESOLUTION_ERROR = 0.25  # Largest relative error of a film that a table may leave.


INLET_NUMBERS = (
    "edge",
    "edge_coefficient",
    "edge_coefficient_error",
    "steepest_rise",
    "steepest_rise_error",
    "inlet_length",
)  # What a dataset holds of an inlet
NUMBERS = {
    "forward": "gap at the highest pressure as the surface goes towards larger x",
    "backward": "gap at the highest pressure as the surface goes towards smaller x",
    "net": "what a stroke to and fro leaves, per length of the stroke and of the seal",
}


class Films(NamedTuple):
    """Both films, and what a stroke leaves."""

    forward: float
    backward: float
    net: float


@dataclass(frozen=True, eq=False, repr=False)
class Inlet(ByValue, Shown):
    """One direction: what of the pressure makes the film, and how well the table tells it."""

    film: Annotated[float, "h*", "m"]
    error: Annotated[float, "its relative error, of the law and of the table"]
    law_error: Annotated[float, "the part of the law in this error"]
    resolution_error: Annotated[float, "the part of the table in this error"]
    law: Annotated[str, "what governs: ``edge``, ``interior``, or ``edge and interior`` where both are nearly equal"]
    edge: Annotated[float, "where the contact begins", "m"]
    edge_coefficient: Annotated[float, "pressure over the root of the distance from the edge", "Pa m-1/2"]
    edge_coefficient_error: Annotated[float, "estimated absolute error of edge_coefficient", "Pa m-1/2"]
    steepest_rise: Annotated[float, "steepest rise of the pressure inside the contact, zero if there is none", "Pa m-1"]
    steepest_rise_error: Annotated[float, "estimated absolute error of steepest_rise", "Pa m-1"]
    inlet_length: Annotated[float, "length over which the edge makes the film", "m"]
    spacing: Annotated[float, "step of the table at the edge", "m"]


INLET_UNITS = {name: each.unit or "1" for name, each in Inlet._words.items() if name != "law"}


@dataclass(frozen=True, eq=False, repr=False)
class PressureFilm(ByValue, Told, Tabled):
    """Films of both directions and what a stroke leaves outside."""

    forward: Annotated[float, "gap at the highest pressure as the surface goes towards larger x", "m"]
    backward: Annotated[float, "gap at the highest pressure as the surface goes towards smaller x", "m"]
    net: Annotated[
        float,
        "(forward - backward)/2, what a stroke to and fro leaves per length of the stroke and of the seal; a gap h* lets pass "
        "the flux U h*/2, and where net is negative, the way back could return more than came out",
        "m",
    ]
    error: Annotated[Films, "absolute errors of the three", "m"]
    inlets: Annotated[tuple[Inlet, Inlet], "both directions, forward first"]

    def _labelled(self) -> Labelled:
        columns: dict[str, Column] = {}
        for name, meaning in NUMBERS.items():
            columns[name] = ((), getattr(self, name), "m", meaning)
            columns[f"{name}_error"] = ((), getattr(self.error, name), "m", f"estimated absolute error of {name}")
        for name in INLET_NUMBERS:
            words = Inlet._words[name]
            columns[name] = ("direction", [getattr(each, name) for each in self.inlets], str(words.unit), words.meaning)
        directions = {"direction": ("direction", ["forward", "backward"], "1", "direction in which the surface moves")}
        return columns, directions, {"title": "Film of a dry pressure", "notes": "\n".join(self.notes)}

    @property
    def range(self) -> str:
        """The range in words."""
        length = MAX_LAW_ERROR / EDGE_ERROR_FACTOR
        rise = MAX_LAW_ERROR / INTERIOR_ERROR_FACTOR
        return (
            f"edge: inlet length up to {length:g} of the way to nine tenths of the peak; interior: E* h* p'max up to {rise:g} "
            "of the peak squared; film thicker than the roughness"
        )

    @property
    def valid(self) -> bool:
        """Whether both films lie in this range."""
        return all(each.law_error <= MAX_LAW_ERROR for each in self.inlets)

    @property
    def notes(self) -> tuple[str, ...]:
        """What limits the answer, in sentences."""
        found = []
        for side, each in zip(("left", "right"), self.inlets, strict=True):
            if each.law_error > MAX_LAW_ERROR:
                found.append(
                    f"The film from the {side} is out of range, too fast or too viscous for this pressure: its law errs by up "
                    f"to {format_percent(each.law_error)}."
                )
            if each.spacing > each.inlet_length and each.law != "interior":
                near, step = format_si(each.inlet_length, "length", 2), format_si(each.spacing, "length", 2)
                found.append(
                    f"The film from the {side} is made within {near} of the edge, where rows are {step} apart: an edge that "
                    "is rounder or sharper in between is not seen."
                )
        return (*found, "Asperities are left out: where they carry a few per cent of the load, films are up to 10 % thicker.")

    def to_dict(self) -> dict[str, Any]:
        """Return films in m by name with their errors, the inlets as dictionaries, range and notes, ready for JSON."""
        found: dict[str, Any] = {name: getattr(self, name) for name in Films._fields}
        found |= {f"{name}_error": value for name, value in self.error._asdict().items()}
        found |= {name: vars(each).copy() for name, each in zip(("forward_inlet", "backward_inlet"), self.inlets, strict=True)}
        units = dict.fromkeys(Films._fields, "m") | INLET_UNITS
        return found | {"in_range": self.valid, "range": self.range, "units": units, "notes": self.notes}

    def _card(self) -> Card:
        is_zero = abs(self.net) < NEGLIGIBLE * self.error.net
        net, doubt = format_si(0.0 if is_zero else self.net, "length"), format_si(self.error.net, "length", 2)
        headline = f"Half the difference of both films, which a stroke to and fro leaves behind, is {net} ± {doubt}."
        table: list[tuple[str, ...]] = [("direction", "film h*", "error", "of the law", "of the table", "made by")]
        for name, each in zip(Films._fields, self.inlets, strict=False):
            errors = (each.error, each.law_error, each.resolution_error)
            table.append((name, format_si(each.film, "length", 3), *map(format_percent, errors), each.law))
        return Card(headline, notes=self.notes, table=table, right=(1, 2, 3, 4))


def film_of_pressure(
    x: Iterable[float | str],
    p: Iterable[float | str],
    *,
    modulus: float | str,
    viscosity: float | str,
    speed: float | str | Sequence[float | str],
) -> PressureFilm:
    r"""Return the films that a smooth soft profile drags in both ways, from the pressure of its dry contact.

    .. math::

        h^* = \min\left[0.5121 \, (6 \eta U)^{3/5} {E^*}^{1/5} k^{-4/5},
              \left(\frac{8 \eta U}{9 p'_\mathrm{max}}\right)^{1/2}\right]

    Parameters
    ----------
    x : array_like, shape (n,)
        Positions, in any order and unevenly spaced [m].
    p : array_like, shape (n,)
        Pressure of the dry contact there, of finite elements or measured; zero outside of the contact [Pa].
    modulus : float or str
        E* [Pa].
    viscosity : float or str
        Viscosity of the fluid [Pa s].
    speed : float or str, or two of them
        Speed of the surface that moves [m/s]; of two the first is towards larger x, the second back.

    Returns
    -------
    PressureFilm
        Both films and what a stroke leaves, with errors.

    Raises
    ------
    InputError
        If an input is no such number, or the table does not tell the film: too few rows, negative pressure, no edge, several
        contacts, or an error of the film beyond 25 %.

    Notes
    -----
    k is fitted to the square of the pressure, which is smooth at the edge, over the number of rows whose error is the least;
    p'max likewise, beyond two inlet lengths from the edge.  The error of the table is that of these fits, by their residuals
    and by what two smaller fits give, with a safety factor of 1.5.  The error of the edge law falls as the inlet length, as
    :math:`\lambda^{2/5}`; with an exit, a parabola's film is thicker by 1.6 % at speed group 1e-3.  Its range ends there at
    0.012.

    Source: ours, and Blok's inverse theory; ``test_film_of_pressure.py``.
    """
    xs, ps = rows_of(x, p)
    numbers = {"modulus": to_si(modulus, "pressure", "modulus"), "viscosity": to_si(viscosity, "viscosity", "viscosity")}
    pair = [speed, speed] if isinstance(speed, str) or not isinstance(speed, Sequence | np.ndarray) else list(speed)
    if len(pair) != 2:
        raise InputError(f"speed = {show(speed)}; give one speed, or two: towards larger x, and back.")
    speeds = [to_si(each, "speed", "speed") for each in pair]
    for name, value in (*numbers.items(), *(("speed", each) for each in speeds)):
        if value <= 0:
            raise InputError(f"{name} = {show(value)}; it must be above zero.")
    E, eta = numbers.values()
    tables = (xs, ps, "left"), (-xs[::-1], ps[::-1], "right")
    forward, backward = (_inlet(DryPressure.of(*each), E, eta * U) for each, U in zip(tables, speeds, strict=True))
    there, back = forward.film * forward.error, backward.film * backward.error
    net = (forward.film - backward.film) / 2
    error = Films(there, back, (there + back) / 2)
    found = PressureFilm(forward.film, backward.film, net, error, (forward, backward))
    if not found.valid:
        warnings.warn(f"film_of_pressure is used outside its range: {found.range}.", OutOfRangeWarning, stacklevel=2)
    return found


def _inlet(pressure: DryPressure, E: float, drag: float) -> Inlet:
    """Return the film that moves towards larger x, of E* and viscosity times speed."""
    edge = pressure.edge()
    k, k_error = edge.coefficient
    length = (6 * drag) ** 0.4 * E**0.8 * k**-1.2 if k > 0 else math.inf
    rise, rise_error = pressure.steepest_rise(edge.place + min(EDGE_ZONE * length, MAX_EDGE_ZONE * edge.flank))

    def films(k: float, rise: float) -> tuple[float, float]:
        at_edge = EDGE_CONSTANT * (6 * drag) ** 0.6 * E**0.2 * k**-0.8 if k > 0 else math.inf
        return at_edge, math.sqrt(8 * drag / (9 * rise)) if rise > 0 else math.inf

    at_edge, inside = films(k, rise)
    film = min(at_edge, inside)
    thickest, thinnest = min(films(k - k_error, rise - rise_error)), min(films(k + k_error, rise + rise_error))
    resolution = max(thickest / film - 1, 1 - thinnest / film) if math.isfinite(film) else math.inf
    if resolution > MAX_RESOLUTION_ERROR:
        raise InputError(
            f"The table does not tell the film at the {pressure.side} edge within {format_percent(MAX_RESOLUTION_ERROR)}: its "
            "rows are too few or too noisy there. Give more rows near the edge, or smoother ones."
        )
    of_edge = EDGE_ERROR_FACTOR * length / edge.flank
    of_inside = INTERIOR_ERROR_FACTOR * E * film * rise / pressure.highest**2
    law, error = ("edge", of_edge) if at_edge < inside else ("interior", of_inside)
    if film > NEARLY_EQUAL * max(at_edge, inside):
        law = "edge and interior"
        error = max(JOINT_ERROR, min(of_edge + at_edge / film, of_inside + inside / film) - 1)
    at = edge.place if pressure.side == "left" else -edge.place
    return Inlet(film, error + resolution, error, resolution, law, at, k, k_error, rise, rise_error, length, edge.spacing)
