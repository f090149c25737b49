"""
What does shear thinning do to the film?
========================================

A Carreau fluid (relaxation time 0.057 of the indentation over the speed, at speed group 0.001) has a film a third as thick as
a Newtonian one, and mixed lubrication reaches to higher speeds.  Laws: docs/fluids.md; the plain model:
theory.md.  Runs in five seconds.
"""

import numpy as np

import stribeck as sb

STATE = sb.Groups(speed=1e-3, load=0.1, roughness=1e-4)
FLUIDS = {
    "Newtonian": {"cavitation": "exit"},
    "Carreau, n = 1/2": {"cavitation": "exit", "fluid": sb.fluids.Carreau(0.057, 0.5)},
}


def main():
    """Return the curve of each over the speed group, the boundary friction being one."""
    speeds = np.geomspace(1e-4, 1e-1, 25)
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
    plot(curves).savefig("fluid_that_thins.png")
