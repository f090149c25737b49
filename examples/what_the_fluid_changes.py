"""Fluid, cavity, solid: how much does each change?
================================================

The same contact (load group 0.1, relative roughness 0.001) with one change at a time: the film ends behind the contact, the
fluid stiffens or thins, roughness hinders its flow, the rubber is a layer on a rigid base, both surfaces roll.  The laws
are in docs/fluids.md, the plain model in theory.md.  Runs in half a minute.
"""

import numpy as np

import stribeck as sb

STATE = sb.Groups(speed=1e-3, load=0.1, roughness=1e-4)
CHANGES = {
    "as in the article": {"cavitation": "none"},
    "free exit": {},
    "viscosity grows with pressure": {"fluid": sb.fluids.Barus(1.0)},
    "viscosity falls with shear": {"fluid": sb.fluids.Carreau(0.057, 0.5)},
    "rough flow": {"flow_factors": sb.fluids.EffectiveMedium(alpha=2.0)},
    "layer as thick as the half-width": {"solid": sb.solids.Layer(1.0, 0.5)},
    "slide-to-roll ratio 0.2": {"slide_to_roll": 0.2},
}


def main():
    """Return the curve of each over the speed group, the boundary friction being one."""
    speeds = np.geomspace(1e-5, 1e-1, 9)
    return {
        name: sb.stribeck_curve(STATE, speed=speeds, rtol=1e-4, **{"cavitation": "exit", **change})
        for name, change in CHANGES.items()
    }


def plot(curves):
    """Draw friction and minimum gap."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6, 7), layout="constrained")
    above, below = figure.subplots(2, sharex=True)
    for name, curve in curves.items():
        above.loglog(curve.values, curve.friction, label=name)
        below.loglog(curve.values, [s.minimum_gap for s in curve.solutions])
    above.set(ylabel="friction coefficient")
    below.set(xlabel=r"speed group $\lambda$", ylabel=r"minimum gap $/u_\mathrm{Hz}$")
    above.legend(fontsize="small")
    return figure


if __name__ == "__main__":
    curves = main()
    for name, curve in curves.items():
        middle = curve.solutions[4]
        print(f"{name:34} at speed 1e-3: friction {curve.friction[4]:.4f}, minimum gap {middle.minimum_gap:.5f}")
    plot(curves).savefig("what_the_fluid_changes.png")
