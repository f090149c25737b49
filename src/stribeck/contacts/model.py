"""The parts of the model that groups carry beside their contact law: fluid, cavitation, solid, profile."""

from __future__ import annotations

from dataclasses import dataclass

from stribeck.fluids.fluid import Cavitation, Film
from stribeck.fluids.newtonian import Newtonian
from stribeck.profiles.profile import Parabola, Undeformed
from stribeck.quantities.units import InputError, checked_word, show
from stribeck.solids.half_plane import HalfPlane, as_solid
from stribeck.solids.solid import Solid


@dataclass(frozen=True)
class Model:
    """Film, cavitation, bodies and their shape, by default of the article."""

    film: Film = Newtonian()  # The fluid, in Hertz units
    cavitation: Cavitation = Cavitation.NONE  # How the film ends behind the contact
    solid: Solid = HalfPlane()  # The soft body, in Hertz units
    cavity_pressure: float = 0.0  # Rupture pressure of a film that reforms, above the ambient one, at most zero [p_Hz]
    profile: Undeformed = Parabola()  # The undeformed gap, in Hertz units

    def __post_init__(self) -> None:
        """Refuse films and cavitation of other types, and bodies that contradict themselves."""
        if not type(self.film).__module__.startswith("stribeck."):
            raise InputError(
                f"film = {show(self.film)}; films are those of the package. A fluid of your own is a law of shear, viscosity "
                "or density, given as fluid = ... to a contact or to solve: see Add a fluid in for_developers.md."
            )
        checked_word("cavitation", self.cavitation, Cavitation)
        as_solid("solid", self.solid)
        if self.cavitation is Cavitation.REFORM and not self.profile.is_parabola:
            raise InputError(
                f"cavitation = 'reform' with profile = {self.profile.name}: a film that re-forms is solved on a cylinder "
                "alone; take cavitation = 'exit', whose film ends behind the contact, or 'none'."
            )


BASE_MODEL = Model()  # A Newtonian fluid that never cavitates, on a half-plane
