r"""Two elastic bodies that press on each other: their deflections add.

.. math:: w = v \, w_1 + (1 - v) \, w_2, \qquad v = \frac{E^*}{E_1^*}, \quad \frac1{E^*} = \frac1{E_1^*} + \frac1{E_2^*}

Source: [Johnson 1985] section 4.1, for shapes that differ by little from planes.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from stribeck._types import Array
from stribeck.numerics.panels import Mesh
from stribeck.quantities.docstrings import Described
from stribeck.quantities.units import InputError, show, to_si
from stribeck.solids.half_plane import as_solid
from stribeck.solids.solid import Lengths, Solid, lengths_of


@dataclass(frozen=True, init=False)
class TwoBodies(Described, title="Parameters"):
    """Two bodies of different shapes, such as a layer and a half-space.

    Two half-spaces need nothing of this: they are one with the modulus of both.  Either moves as the substrate: give a body
    that remembers only where it passes through the contact with the speed u1.

    Raises
    ------
    InputError
        Where the share is impossible, or a body is none.
    """

    first: Annotated[Solid, "the first body; a half-space by default"]
    second: Annotated[Solid, "the other one, likewise"]
    first_share: Annotated[
        float, "share of the first in the compliance, ``E*/E1*``, 0 to 1, with E* the modulus of the contact", "1"
    ]

    def __init__(self, first: Solid | None = None, second: Solid | None = None, first_share: float = 0.5) -> None:
        share = to_si(first_share, "number", "first_share")
        if not 0 <= share <= 1:
            raise InputError(f"first_share = {show(first_share)} must lie between 0 and 1: E* over the modulus of the first.")
        bodies = {"first": as_solid("first", first), "second": as_solid("second", second)}
        for name, value in {**bodies, "first_share": share}.items():
            object.__setattr__(self, name, value)

    @property
    def name(self) -> str:
        """The names of both."""
        return f"{self.first.name} and {self.second.name}"

    @property
    def parameters(self) -> dict[str, float | str]:
        """Parameters of both bodies, and the share of the first."""
        bodies = {"first": self.first, "second": self.second}
        found = {f"{which}_{name}": value for which, body in bodies.items() for name, value in body.parameters.items()}
        return {**found, "first_share": self.first_share}

    @property
    def uses_speed(self) -> bool:
        """Whether one of them is viscoelastic."""
        return any(getattr(body, "uses_speed", False) for body in (self.first, self.second))

    @property
    def lengths(self) -> Lengths:
        """Lengths of both bodies, for meshes."""
        return lengths_of(self.first).joined(lengths_of(self.second))

    def scaled(self, length: float, speed: float = 1.0) -> Solid:
        """Return both in Hertz units."""
        return TwoBodies(self.first.scaled(length, speed), self.second.scaled(length, speed), self.first_share)

    def deflection(self, mesh: Mesh) -> Array:
        """Return the matrix from nodal pressures to the sum of both deflections at the nodes [u_Hz per p_Hz]."""
        v = self.first_share
        return np.asfortranarray(v * self.first.deflection(mesh) + (1 - v) * self.second.deflection(mesh))

    def far_gap(self, x: Array) -> Array:
        """Return the mean of both, by their shares."""
        v = self.first_share
        return v * self.first.far_gap(x) + (1 - v) * self.second.far_gap(x)
