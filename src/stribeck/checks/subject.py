"""Subject of the checks: a contact, what is known about it, and the states, solved only if a check needs them."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from stribeck.contact_laws.finite_surface import FiniteSurface
from stribeck.contacts.contact import Contact
from stribeck.contacts.friction import Definition
from stribeck.contacts.parts import PART_INPUTS
from stribeck.fluids.shear_thinning import ShearThinning
from stribeck.quantities.lazy import cached_property
from stribeck.quantities.outcome import Outcome
from stribeck.solver.solution import Solution
from stribeck.solver.solve import solve

if TYPE_CHECKING:
    from stribeck.curves.regime import Landmark
    from stribeck.curves.result import StribeckCurve

# Names of the article's own parts, which need no mention
BASE_MODEL_NAMES = ("", "newtonian", "half-plane", "half-space", "none")

STATE_RTOL = 1e-4  # Tolerance of the states that checks solve

# From the speed of a Newtonian film to that of a thinning one: each step leaves one less the exponent of the error
MAX_FIXED_POINT_STEPS = 60


class Tracing(NamedTuple):
    """How the curve of one geometry is traced, on which the minimum and the transitions are looked for and then located."""

    points: int  # Points of the curve
    rtol: float  # Tolerance of the states
    films: tuple[float, float] | None


# By geometry: a ball takes a tenth of a second or more for each state, and its minimum lies where films are a few h_rms.
TRACING = {"line": Tracing(21, STATE_RTOL, None), "point": Tracing(8, 3e-3, (0.3, 16.0))}


@dataclass(frozen=True, eq=False)
class Subject:
    """A contact under examination."""

    contact: Contact  # The contact
    facts: Mapping[str, float] = field(default_factory=dict)  # Facts of :data:`stribeck.cases.case.FACTS` in SI units
    definition: Definition = "balanced"  # Definition of the viscous friction
    solved: Solution | None = None  # State of the contact, if already solved
    traced: StribeckCurve | None = None  # Curve of the contact over the speed, if already solved
    on_point: Callable[[int, int], object] | None = None

    @cached_property
    def solution(self) -> Solution:
        """The state."""
        return self.solved if self.solved is not None else solve(self.contact, rtol=STATE_RTOL)

    @cached_property
    def curve(self) -> StribeckCurve:
        """The curve over the speed."""
        return self.traced if self.traced is not None else self._curve_of(self.contact)

    @cached_property
    def cut_curve(self) -> StribeckCurve:
        """The curve of the same contact whose law ends as that of a finite surface."""
        law = self.contact.law if self.contact.law is not None and self.contact.law.name == "persson" else None
        return self._curve_of(self.contact.replace(law=FiniteSurface(self.contact.alpha, law)))

    def _curve_of(self, contact: Contact) -> StribeckCurve:
        from stribeck.curves.stribeck_curve import stribeck_curve  # a fifth of the time of a single solve

        tracing = TRACING[contact.groups.geometry]
        speeds = None if tracing.films is None else tuple(speed_of_film(contact, film) for film in tracing.films)
        found = stribeck_curve(
            contact,
            speed=speeds,
            points=tracing.points,
            rtol=tracing.rtol,
            definition=self.definition,
            on_point=self.on_point,
        )
        if found.outcome is Outcome.INTERRUPTED:
            raise KeyboardInterrupt
        return found

    @property
    def passing_gap(self) -> float:
        """Gap of the film that passes [u_Hz]: h* of a cylinder, the central gap of a ball."""
        return float(getattr(self.solution, "flux_gap", self.solution.central_gap))

    @property
    def minimum(self) -> Landmark | None:
        """The minimum of friction over the speed."""
        return self.curve.minimum

    def fact(self, name: str) -> float | None:
        """Return a fact that was given, or that the contact's own fluid, solid or cavitation holds; else None."""
        if name in self.facts:
            return self.facts[name]
        found = getattr(self.contact, name, None) if name in PART_INPUTS else None
        return float(found) if found is not None and math.isfinite(found) else None

    def note(self, beginning: str) -> str:
        """Return the notes of the state that begin in one way, as one text; empty if there are none."""
        return " ".join(note for note in self.solution.notes if note.startswith(beginning))

    def models(self, part: str) -> str:
        """Return the name of the contact's fluid, solid or cavitation, empty for that of the base model."""
        found = getattr(self.contact, part, None)
        name = str(found) if isinstance(found, str) else str(getattr(found, "name", "") or "")
        return "" if name.lower() in BASE_MODEL_NAMES else name

    def film(self, gap: float) -> float:
        """Return a gap in m."""
        return gap * self.contact.hertz.indentation


def speed_of_film(contact: Contact, film: float) -> float:
    """Return the speed at which the central film of the smooth ball is a multiple of its roughness [m/s]."""
    groups, gap = contact.replace(speed=1.0).groups, film * contact.roughness / contact.hertz.indentation
    newtonian = speed = float((gap / 0.42480) ** (1 / 0.6) / groups.speed)
    fluid = groups.model.film
    if isinstance(fluid, ShearThinning):
        for _ in range(MAX_FIXED_POINT_STEPS):
            rate = np.array([fluid.law.time * float(groups.speed) * speed / gap])
            speed = newtonian * float(rate[0] / fluid.law.stress(rate)[0])
    return speed
