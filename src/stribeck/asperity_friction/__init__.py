"""Friction of asperities: what turns their load, or their real area of contact, into a force."""

from stribeck.quantities.lazy import lazy_names as _lazy_names

_HOMES = {
    "coulomb": ("Coulomb",),
    "shear_stress": ("ShearStress",),
    "shear_stress_table": ("ShearStressTable",),
}
__all__, __getattr__, __dir__ = _lazy_names(__name__, _HOMES, has_laws=True)
