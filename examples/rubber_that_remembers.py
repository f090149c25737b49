"""
What does viscoelastic rubber cost in friction?
===============================================

A standard linear solid, three times stiffer at once than at rest, slides over the cylinder.  It enters the contact stiff and
leaves it before it has recovered; that lag costs friction.  Smooth lubricated contacts at three Deborah numbers (speed times
retardation time over half-width).  Laws: docs/fluids.md; the plain model: theory.md.  Runs in three
seconds.
"""

import numpy as np

import stribeck as sb

STATE = sb.Groups(speed=1e-3, load=0.1, roughness=0.0)
DEBORAH = (None, 0.1, 1.0)


def main():
    """Return the state of each, and the hysteresis friction over the slope a/R."""
    found = {}
    for number in DEBORAH:
        solid = None if number is None else sb.solids.StandardLinearSolid(number, modulus_ratio=3.0)
        state = sb.solve(STATE, solid=solid, rtol=1e-3)
        pressure = sum(state.nodal_pressures())
        lost = sb.solids.hysteresis_friction(state.mesh, state.groups.model.solid, pressure)
        found["elastic" if number is None else f"Deborah number {number:g}"] = state, lost
    return found


def plot(found):
    """Draw gap and pressure."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6, 6), layout="constrained")
    above, below = figure.subplots(2, sharex=True)
    x = np.linspace(-2, 2, 401)
    for name, (state, _) in found.items():
        fields = state.profile(x)
        above.plot(x, fields.fluid_pressure, label=name)
        below.plot(x, fields.gap)
    above.set(ylabel=r"pressure $/p_\mathrm{Hz}$")
    below.set(xlabel="$x/a$", ylabel=r"gap $/u_\mathrm{Hz}$", ylim=(0, 0.1))
    above.legend()
    return figure


if __name__ == "__main__":
    found = main()
    for name, (state, lost) in found.items():
        print(f"{name:20} minimum gap {state.minimum_gap:.5f}, hysteresis friction {abs(lost):.4f} a/R")
    plot(found).savefig("rubber_that_remembers.png")
