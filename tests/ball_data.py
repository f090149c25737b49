"""The ball that tests of batches, fits and regimes share: mixed lubrication, a state in a tenth of a second."""

import stribeck as sb

BALL = sb.PointContact.from_groups(
    sb.Groups(1e-3, 1e-2, 2e-4, geometry="point"),
    radius=0.01,
    modulus=1e6,
    viscosity=0.1,
    alpha=2.0,
    beta=0.1,
    boundary_friction=0.8,
    slide_to_roll=0.5,
)
