"""Case files of seals, with the numbers of catalogues and where these come from."""

from __future__ import annotations

__all__ = ["SEALS"]

_RUBBER = """# Hardness of the rubber: seals have 60 to 90 Shore A. Young's modulus follows by Gent's relation, to a third.
shore_a = "70 +- 3"
"""

_PRESSURE = """# A pressure that is held back adds to this load, over the width of the contact; the film is solved without it.
# sealed_pressure = "1 MPa"
"""

_SURFACE = """# Stated range of rubber on steel in oil at low speed: 0.2 to 0.5.
boundary_friction = "0.3 +- 0.06"

law = "persson"

# Roughness of rod and seal together. Assumed but for its height: measure it, and put here what
# `stribeck surface FILE --out surface.toml` writes.
[surface]
h_rms = "0.5 um"
hurst = 0.8
longest_wavelength = "150 um"
shortest_wavelength = "2.5 um"

# Oil by its grade, at the temperature of the lip, which is warmer than the sump.
[fluid]
preset = "iso-vg"
grade = 46
temperature = "50 degC"

[cavitation]
# Behind a seal the film breaks at ambient pressure.
model = "exit"

[check]
# stroke = "100 mm"   # then the check says whether a stroke is long enough for a row of steady states
"""

_ROD = f"""# An O-ring that slides along a rod or a bore.
title = "O-ring"

[contact]
# Half of the cord diameter: ISO 3601 has 1.78, 2.62, 3.53, 5.33 and 6.99 mm.
radius = "1.765 mm"

{_RUBBER}
# Squeeze over the cord diameter: 0.08 to 0.16 of moving O-rings. The load follows by Lindley's formula, to a tenth.
squeeze = 0.1
{_PRESSURE}
# Speed of the rod: 0.01 to 1 m/s.
speed = "0.1 m/s"

{_SURFACE}"""

_LIP = f"""# The lip of a U-cup or of a wiper ring on a rod.
title = "U-cup"

[contact]
{_RUBBER}
# Force of the lip over the circumference of the rod, as measured on a split mandrel or from finite elements.
load = "400 N/m"
{_PRESSURE}
# Speed of the rod: 0.01 to 1 m/s.
speed = "0.1 m/s"

{_SURFACE}
# The edge as it stands on the rod: its angles to both sides and the radius of its tip. The oil is ahead; the stroke back is
# that with reversed = true. Of a contact pressure from finite elements sb.profiles.from_pressure makes the shape, and
# `stribeck leak` the leakage.
[profile]
shape = "lip"
angle_oil = "20 deg"
angle_air = "10 deg"
tip_radius = "0.8 mm"
"""

_SHAFT = f"""# A radial shaft seal.
title = "Shaft seal"

[contact]
# Radius of the worn-in edge of the lip: 0.2 to 1 mm.
radius = "0.5 mm"

{_RUBBER}
# Radial force, 0.1 to 0.2 N per millimetre of circumference, and the circumference.
force = "14 N +- 15 %"
width = "94.2 mm"

rotational_speed = "200 rpm"
shaft_diameter = "30 mm"

{_SURFACE}"""

SEALS = {"o-ring": _ROD, "u-cup": _LIP, "shaft": _SHAFT}
"""Text of a case file by the kind of seal."""
