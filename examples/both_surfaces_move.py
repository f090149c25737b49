"""
Does rolling change the friction?
=================================

At the same sum of the surface speeds the film of a Newtonian fluid does not depend on sliding. Asperities carry the same
load; the friction in the film falls with the sliding speed, down to that of rolling.  Laws: docs/fluids.md; the
plain model: theory.md.  Runs in a second.
"""

import numpy as np

import stribeck as sb

STATE = sb.Groups(speed=1e-3, load=0.1, roughness=1e-4)
MOTIONS = {
    "pure sliding": {"slide_to_roll": 2.0},
    "slide-to-roll ratio 0.2": {"slide_to_roll": 0.2},
}


def main():
    """Return the curve of each over the speed group, the boundary friction being one."""
    speeds = np.geomspace(1e-5, 1, 25)
    return {name: sb.stribeck_curve(STATE, speed=speeds, rtol=1e-4, **parts) for name, parts in MOTIONS.items()}


def plot(curves):
    """Draw friction and the load on asperities."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6, 6), layout="constrained")
    above, below = figure.subplots(2, sharex=True)
    for name, curve in curves.items():
        above.loglog(curve.values, np.abs(curve.friction), label=name)
        below.semilogx(curve.values, curve.observable("contact_load_share"), label=name)
    above.set(ylabel="friction coefficient")
    below.set(xlabel=r"speed group $\lambda$", ylabel="load on asperities")
    above.legend()
    return figure


if __name__ == "__main__":
    curves = main()
    for name, curve in curves.items():
        friction, value = curve.friction[12], curve.observable("contact_load_share")[12]
        print(f"{name:36} at speed {curve.values[12]:.0e}: friction {friction:.4f}, asperities carry {value:.5f}")
    plot(curves).savefig("both_surfaces_move.png")
