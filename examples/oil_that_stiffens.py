"""
What does an oil that stiffens under pressure change?
=====================================================

Barus' law with a pressure coefficient of one over the Hertz pressure, as of an oil at 50 MPa.  Compared with a constant
viscosity the film is an eighth thicker and the friction in it twice as large.  Laws: docs/fluids.md; the plain model:
theory.md.  Runs in two seconds.
"""

import numpy as np

import stribeck as sb

STATE = sb.Groups(speed=1e-3, load=0.1, roughness=1e-4)
FLUIDS = {
    "constant viscosity": {"cavitation": "exit"},
    "Barus, coefficient times pressure 1": {"cavitation": "exit", "fluid": sb.fluids.Barus(1.0)},
}


def main():
    """Return the curve of each over the speed group, the boundary friction being one."""
    speeds = np.geomspace(1e-5, 1, 25)
    return {name: sb.stribeck_curve(STATE, speed=speeds, rtol=1e-4, **parts) for name, parts in FLUIDS.items()}


def plot(curves):
    """Draw friction and minimum gap."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6, 6), layout="constrained")
    above, below = figure.subplots(2, sharex=True)
    for name, curve in curves.items():
        above.loglog(curve.values, np.abs(curve.friction), label=name)
        below.loglog(curve.values, curve.observable("minimum_gap"), label=name)
    above.set(ylabel="friction coefficient")
    below.set(xlabel=r"speed group $\lambda$", ylabel="minimum gap $/u_\\mathrm{Hz}$")
    above.legend()
    return figure


if __name__ == "__main__":
    curves = main()
    for name, curve in curves.items():
        friction, value = curve.friction[12], curve.observable("minimum_gap")[12]
        print(f"{name:36} at speed {curve.values[12]:.0e}: friction {friction:.4f}, minimum gap {value:.5f}")
    plot(curves).savefig("oil_that_stiffens.png")
