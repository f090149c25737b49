"""The parts of the model that groups carry beside their contact law: fluid, cavitation, solid."""

from __future__ import annotations

from dataclasses import dataclass

from stribeck.fluids.cavitation import Cavitation
from stribeck.fluids.fluid import Film
from stribeck.fluids.newtonian import Newtonian
from stribeck.solids.half_plane import HalfPlane
from stribeck.solids.solid import Solid

__all__ = ["ARTICLE", "Model"]


@dataclass(frozen=True)
class Model:
    """What the film and the bodies are; by default those of the article.

    Attributes
    ----------
    film : Film
        The fluid, in Hertz units.
    cavitation : Cavitation
        How the film ends behind the contact.
    cavity_pressure : float
        Pressure above the ambient at which a film that forms anew ruptures, at most zero [p_Hz].
    solid : Solid
        The soft body, in Hertz units.
    """

    film: Film = Newtonian()
    cavitation: Cavitation = Cavitation.NONE
    solid: Solid = HalfPlane()
    cavity_pressure: float = 0.0


ARTICLE = Model()
"""A Newtonian fluid that never cavitates, on a half-plane."""
