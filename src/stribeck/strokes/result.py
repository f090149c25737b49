"""What a stroke gives: friction and films over time, each with its error, and steady sliding beside it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Annotated, Any, ClassVar

import numpy as np

from stribeck._types import Array
from stribeck.contacts.contact import Contact, input_texts
from stribeck.contacts.friction import Definition
from stribeck.files.datasets import Column
from stribeck.files.results import Exported, Labelled, json_of
from stribeck.motions.motion import Motion
from stribeck.numerics.settings import COARSE_RTOL, HALF_DIGITS, NEGLIGIBLE
from stribeck.quantities.formats import format_error, format_si
from stribeck.quantities.results import ByValue, Card, Told


@dataclass(frozen=True, eq=False, repr=False)
class Stroke(Exported, Told, ByValue):
    """Friction and films of a line contact over time, in SI units."""

    _picture = "stribeck.plot.in_time.plot_stroke"

    contact: Annotated[Contact, "the contact; its speed is the largest of the motion"]
    motion: Annotated[Motion, "the motion"] = field(repr=False)
    cycles: Annotated[int, "times that it was repeated"]
    hertz_half_width: Annotated[float, "half-width of the dry contact", "m"]
    time: Annotated[Array, "instants", "s"]
    speed: Annotated[Array, "sliding speed, negative on the way back", "m/s"]
    position: Annotated[Array, "position of the moving surface", "m"]
    friction: Annotated[Array, "friction coefficient, balanced, with the sign of the force against the motion", "1"]
    friction_asperities: Annotated[Array, "contribution of asperities, zero at the instant of a reversal", "1"]
    friction_fluid: Annotated[Array, "contribution of the fluid", "1"]
    contact_load_share: Annotated[Array, "share of the load on asperities", "1"]
    central_film_thickness: Annotated[Array, "gap at the centre", "m"]
    minimum_film_thickness: Annotated[Array, "minimum gap", "m"]
    left_flow: Annotated[Array, "liquid that passes the left edge of the dry contact, to the right", "m2/s"]
    right_flow: Annotated[Array, "liquid that passes the right edge of the dry contact, to the right", "m2/s"]
    errors: Annotated[dict[str, Array], "estimated absolute errors of the eight before it, by name, in their units"]
    work: Annotated[float, "work of friction per length of the contact in the last cycle, or in the whole motion", "J/m"]
    work_error: Annotated[float, "its estimated error", "J/m"]
    notes: Annotated[tuple[str, ...], "what to know before using the numbers"] = ()

    definition: ClassVar[Definition] = "balanced"

    @property
    def last_cycle(self) -> slice:
        """The instants of the last cycle, its first instant among them."""
        steps = (len(self.time) - 1) // self.cycles
        return slice(len(self.time) - 1 - steps, None)

    @property
    def largest_contact_load_share(self) -> float:
        """Largest share of the load on asperities in the last cycle [-]."""
        return float(self.contact_load_share[self._where_largest])

    @property
    def _where_largest(self) -> int:
        return int(np.argmax(self.contact_load_share[self.last_cycle])) + int(self.last_cycle.start)

    @property
    def half_widths(self) -> float:
        """Length of the stroke, from end to end, in half-widths; below 1000 it is no row of steady states."""
        return float(np.ptp(self.position) / self.hertz_half_width)

    def to_dict(self) -> dict[str, Any]:
        """Return the numbers over time, and those of the last cycle, with their errors, ready for JSON."""
        names = "definition cycles hertz_half_width half_widths largest_contact_load_share work work_error time speed position"
        share_error = self.errors["contact_load_share"][self._where_largest]
        found = json_of(self, names, largest_contact_load_share_error=share_error)
        for name, error in self.errors.items():
            found |= {name: getattr(self, name), f"{name}_error": error}
        units = {name: each.unit for name, each in self._words.items() if each.unit is not None and name in found}
        return found | {"units": units, "notes": self.notes}

    def _card(self) -> Card:
        last, largest = self.last_cycle, self._where_largest
        peak = int(np.argmax(np.abs(self.friction[last]))) + last.start
        thinnest = int(np.argmin(self.minimum_film_thickness[last])) + last.start
        rows = [
            ("stroke", f"{format_si(float(np.ptp(self.position)), 'length')}, {self.half_widths:.3g} half-widths"),
            (
                "largest share of asperities",
                f"{self.contact_load_share[largest]:.3g} ± {format_error(self.errors['contact_load_share'][largest])}",
            ),
            ("largest friction, balanced", f"{abs(self.friction[peak]):.3g} ± {format_error(self.errors['friction'][peak])}"),
            (
                "thinnest film",
                f"{format_si(self.minimum_film_thickness[thinnest], 'length')} ± "
                f"{format_error(self.errors['minimum_film_thickness'][thinnest], 'length')}",
            ),
            ("work of friction per length", f"{self.work:.4g} ± {format_error(self.work_error)} J/m"),
        ]
        of = "the last cycle" if self.motion.repeats else "the motion"
        return Card(f"friction and films of {of}, {len(self.time[last]) - 1} steps", rows, self.notes)

    def _labelled(self) -> Labelled:
        names = (*self.errors, "speed", "position")
        said = {name: (self._words[name].unit or "1", self._words[name].meaning) for name in names}
        columns: dict[str, Column] = {name: ("time", getattr(self, name), *words) for name, words in said.items()}
        columns |= {
            f"{name}_error": ("time", error, said[name][0], f"estimated absolute error of {name}")
            for name, error in self.errors.items()
        }
        columns |= {
            "work": ((), self.work, "J/m", "work of friction per length in the last cycle"),
            "work_error": ((), self.work_error, "J/m", "estimated absolute error of work"),
        }
        attributes = {
            "title": "A stroke of a lubricated rough line contact",
            "motion": type(self.motion).__name__,
            "cycles": self.cycles,
            "half_widths": self.half_widths,
            "definition": self.definition,
            "inputs": "; ".join(input_texts(self.contact)),
            "notes": " ".join(self.notes),
        }
        return columns, {"time": ("time", self.time, "s", "time since the start")}, attributes


SLOWEST = NEGLIGIBLE**2  # Speed over the largest from which on steady friction is solved


def beside_steady(stroke: Stroke, on_point: Callable[[int, int], None] | None = None) -> dict[str, float]:
    """Return friction on the way out of the last cycle, beside steady sliding at the same speeds, and each error.

    It is friction at the largest speed [m/s], at the last instant that has it, and its mean over the path.
    """
    from stribeck.curves.stribeck_curve import stribeck_curve  # slow to import, and a stroke by itself needs none

    # On the way back a body that is not symmetric has other steady states.
    last = stroke.last_cycle
    time, speed, friction, doubt = (
        each[last] for each in (stroke.time, stroke.speed, stroke.friction, stroke.errors["friction"])
    )
    largest = float(speed.max())
    top = int(np.flatnonzero(np.isclose(speed, largest, rtol=HALF_DIGITS, atol=0.0))[-1])  # of a plateau its end
    contact, asperities = stroke.contact, stroke.contact.friction_of_asperities
    known = asperities.known_speeds
    slowest = max(SLOWEST * largest, known[0])
    curve = stribeck_curve(
        contact,
        speed=(max(0.99 * slowest, known[0]), min(1.01 * largest, known[1])),
        points=2,
        rtol=NEGLIGIBLE * COARSE_RTOL,
        on_point=on_point,
    )
    steady = curve.at(np.clip(speed, slowest, largest)).friction
    total, error = np.asarray(steady), np.asarray(steady.error)
    # Slower than the curve, friction is between that of its slow end and that of asperities with all of the load.
    dry = asperities.coefficient_at_small_area(contact.replace(speed=slowest))
    slow = np.where((speed > 0) & (speed < slowest), dry, 0.0)
    found = {
        "friction_at_largest_speed": (friction[top], doubt[top]),
        "steady_friction": (total[top], error[top]),
        "mean_friction": _mean(time, speed, friction, doubt),
        "steady_mean_friction": _mean(time, speed, total, error + slow),
    }
    numbers = {
        f"{name}{end}": float(each) for name, pair in found.items() for end, each in zip(("", "_error"), pair, strict=True)
    }
    return {"largest_speed": largest} | numbers


def _mean(time: Array, speed: Array, values: Array, doubt: Array) -> tuple[float, float]:
    """Return the mean over the path out, and its error: that of the values, and the difference from every second of them."""
    path = np.maximum(speed, 0.0)

    def mean(numbers: Array, step: int = 1) -> float:
        t, v = time[::step], path[::step]
        return float(np.trapezoid(numbers[::step] * v, t) / np.trapezoid(v, t))

    found = mean(values)
    return found, mean(doubt) + abs(found - mean(values, 2))
