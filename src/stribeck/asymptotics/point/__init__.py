"""Asymptotic laws of the ball, each with range and source, and published regressions beside them.

All take groups of ``geometry="point"``, whose lengths are in Hertz radii a and gaps in u = a**2/R.
"""

from stribeck.asymptotics.point import boundary, film, friction, hertz, regressions, rest, rigid, sharing

__all__ = ["boundary", "film", "friction", "hertz", "regressions", "rest", "rigid", "sharing"]
