"""What checks look at: a contact, what is known of it, and the states that are solved only if a check asks for them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from stribeck.contact_laws.finite_surface import FiniteSurface
from stribeck.contacts.contact import Contact
from stribeck.contacts.friction import Definition
from stribeck.curves.landmarks import Landmark
from stribeck.curves.result import StribeckCurve
from stribeck.curves.stribeck_curve import stribeck_curve
from stribeck.quantities.facts import FACTS
from stribeck.solver.solution import Solution
from stribeck.solver.solve import solve

__all__ = ["Subject"]

PLAIN = ("", "newtonian", "half-plane", "half-space", "none")
"""Names of the parts of the article, of which nothing needs to be said."""

POINTS, RTOL = 21, 1e-4
"""Of the curves on which the minimum and the transitions are looked for, which are then located exactly."""


@dataclass(frozen=True, eq=False)
class Subject:
    """A contact under examination.

    Attributes
    ----------
    contact : Contact
        The contact.
    facts : mapping
        Facts of :data:`stribeck.quantities.facts.ROWS` in SI units.
    definition : {"balanced", "published"}
        Definition of the viscous friction.
    solved : Solution, optional
        Its state, if that is known already.
    traced : StribeckCurve, optional
        Its curve over the speed, likewise.
    """

    contact: Contact
    facts: Mapping[str, float] = field(default_factory=dict)
    definition: Definition = "balanced"
    solved: Solution | None = None
    traced: StribeckCurve | None = None

    @cached_property
    def solution(self) -> Solution:
        """The state."""
        return self.solved if self.solved is not None else solve(self.contact, rtol=RTOL)

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
        return stribeck_curve(contact, points=POINTS, rtol=RTOL, definition=self.definition)

    @property
    def passing_gap(self) -> float:
        """Gap of the film that passes [u_Hz]: h* of a cylinder, the central gap of a ball."""
        return float(getattr(self.solution, "flux_gap", self.solution.central_gap))

    @property
    def is_slow(self) -> bool:
        """Whether a curve would take minutes, as that of a ball does, and is not known yet."""
        return self.contact.groups.geometry == "point" and self.traced is None

    @property
    def minimum(self) -> Landmark | None:
        """The minimum of friction over the speed."""
        return self.curve.minimum

    def fact(self, name: str) -> float | None:
        """Return a fact that was given, or that the contact's own fluid, solid or cavitation holds; else None."""
        if name in self.facts:
            return self.facts[name]
        for path in FACTS[name].models:
            found: Any = self.contact
            for part in path.split("."):
                found = getattr(found, part, None)
            if isinstance(found, int | float) and not isinstance(found, bool) and math.isfinite(found):
                return float(found)
        return None

    def models(self, part: str) -> str:
        """Return the name of the contact's fluid, solid or cavitation beyond the plain ones; empty if it has none."""
        found = getattr(self.contact, part, None)
        name = str(found) if isinstance(found, str) else str(getattr(found, "name", "") or "")
        return "" if name.lower() in PLAIN else name

    def film(self, gap: float) -> float:
        """Return a gap in m."""
        return gap * self.contact.hertz.indentation
