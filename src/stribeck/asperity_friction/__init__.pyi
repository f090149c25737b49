"""The public names with their types; at run time each is imported on first use."""

from stribeck.asperity_friction.coulomb import Coulomb
from stribeck.asperity_friction.shear_stress import ShearStress
from stribeck.asperity_friction.shear_stress_table import ShearStressTable

__all__ = ["Coulomb", "ShearStress", "ShearStressTable"]
