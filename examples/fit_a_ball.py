"""Fit a ball: roughness and boundary friction
===========================================

Friction of a rubber ball on a disc at two loads, made up with 3 % of noise, is fitted jointly: boundary friction and roughness
come back with their intervals.  Equations: theory.md, section 11; docs/fitting.md.  Runs in about a minute.
"""

import numpy as np

import stribeck as sb

BALL = sb.PointContact(
    radius="10 mm",
    modulus="1 MPa",
    load="0.5 mN",
    viscosity="0.1 Pa*s",
    entrainment_speed="0.2 mm/s",
    slide_to_roll=0.5,
    roughness="0.1 um",
    alpha=2.0,
    beta=0.1,
    boundary_friction=0.8,
)
SPEEDS = BALL.speed * np.geomspace(0.1, 6.0, 8)
LOADS = (BALL.load, 2 * BALL.load)


def measured():
    """Return solved friction at both loads with noise, in place of a file: see sb.read_measurements."""
    curves = [sb.stribeck_curve(BALL.replace(load=load), speed=SPEEDS, rtol=1e-4).friction for load in LOADS]
    friction = np.concatenate([np.asarray(curve) for curve in curves])
    return sb.results.Measurements(
        abscissa="speed",
        values=np.tile(SPEEDS, 2),
        friction=friction * np.exp(0.03 * np.random.default_rng(8).standard_normal(len(friction))),
        error=None,
        curve=np.repeat([0, 1], len(SPEEDS)),
        curves=("light", "heavy"),
        inputs=tuple({"load": load} for load in LOADS),
        rows=np.arange(2, 2 + len(friction)),
    )


def main():
    """Return the fit, which begins from other values than the true ones."""
    start = BALL.replace(boundary_friction=0.5, roughness="0.12 um")
    return sb.fit(measured(), start, free=["boundary_friction", "roughness"])


def plot(fit):
    """Draw data, fitted curves and residuals."""
    return fit.plot()


if __name__ == "__main__":
    found = main()
    print(found)
    plot(found).savefig("fit_a_ball.png")
