"""Advice on an unknown key: a typing error, a symbol, or a quantity that the model does not have."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable, Mapping

from stribeck.contacts.geometries import LETTERS
from stribeck.contacts.parts import LAW_NUMBERS
from stribeck.quantities.units import FROM_HARDNESS

# Input that a symbol or a usual name stands for
MEANT = {
    **{letter: row.name for row in LAW_NUMBERS.values() for letter in row.letters},
    **LETTERS,
    "poisson": "poisson_ratio",
    **dict.fromkeys(("mu", "cof", "friction_coefficient"), "boundary_friction"),
    **dict.fromkeys(("name", "fluid", "liquid"), "preset"),
    **dict.fromkeys(("type", "kind", "law"), "model"),
}

MIN_SIMILARITY = 0.8  # Smallest similarity, 0 to 1, of a typing error and the word meant: 0.8 allows one letter in five

MIN_PREFIX_LETTERS = 4  # Smallest number of letters of a word that stands for the key that begins with it

_RMS_HINT = "heights are root mean squares: rq or ra in [contact], h_rms in [surface]"
_LOAD_HINT = "give load: for a cylinder in N/m, or force in N with its width; for a ball, geometry = 'point', the force in N"

# Whole words of a key, and what the package has instead. The first match answers.
_HINTS = (
    (("shore", "hardness", "irhd"), FROM_HARDNESS),
    (("ra", "rq", "r_a", "r_q", "sq", "sa"), _RMS_HINT),
    (
        ("pressure_viscosity", "piezoviscous", "barus", "roelands"),
        "it is pressure_coefficient in the table [fluid]",
    ),
    (
        ("temperature", "viscosity_index", "thermal"),
        "there is no temperature: give viscosity at that of the contact, or a preset with its temperature in [fluid]",
    ),
    (
        ("relaxation_time", "infinite_viscosity", "shear_thinning"),
        "shear thinning is described in the table [fluid]",
    ),
    (
        ("shear_stress", "shear_strength", "asperity_friction"),
        "it stands in the table [asperity_friction] with model = 'shear-stress', in the place of boundary_friction",
    ),
    (
        ("density", "rho"),
        "density goes with kinematic_viscosity in [contact]; the number of asperities per area is density in [asperities]",
    ),
    (
        ("shear_modulus", "storage_modulus", "loss_modulus", "bulk_modulus"),
        "for the solid give modulus, which is E*, or youngs_modulus and poisson_ratio; for a shear modulus G and a Poisson "
        "ratio nu, E* = 2 G/(1 - nu)",
    ),
    (("force", "normal_force", "weight", "mass"), _LOAD_HINT),
    (("length",), _LOAD_HINT),
    (("diameter",), "give radius, half the diameter; of a shaft that turns, shaft_diameter with rotational_speed"),
    (
        ("ellipticity", "ball", "sphere"),
        "for a ball write geometry = 'point' and its radius; elliptic contacts are not modelled",
    ),
    (
        ("slide_to_roll", "srr", "slip", "motion"),
        "write slide_to_roll in [contact], and the sum of both speeds as speed or their mean as entrainment_speed",
    ),
    (
        ("rpm", "angular_velocity", "rotation"),
        "give rotational_speed, such as '1500 rpm', with shaft_diameter, that of shaft or track",
    ),
)


def advice_on(key: str, known: Iterable[str], file: Mapping[str, Iterable[str]] | None = None) -> str:
    """Return what to write in place of an unknown key, or where in the file it belongs; empty where nothing fits."""
    names = list(known)
    if MEANT.get(key) in names:
        return f"write {MEANT[key]}"
    text = "_" + re.sub(r"[^a-z0-9]+", "_", key.lower()).strip("_") + "_"
    absent = next((hint for words, hint in _HINTS if any(f"_{word}_" in text for word in words)), "")
    if absent:
        return absent
    for table, keys in (file or {}).items():
        if key in keys or MEANT.get(key, key) in keys:
            where = f"in the table [{table}]" if table else "at the top of the file, before the first table"
            return f"it belongs {where}"
    whole = [name for name in names if len(key) >= MIN_PREFIX_LETTERS and name.startswith(key.lower())]
    # Only a slip of the pen is taken for another key: pressure_viscosity is no viscosity.
    near = whole or difflib.get_close_matches(key.lower(), names, n=1, cutoff=MIN_SIMILARITY)
    return f"did you mean {near[0]}" if near else ""
