"""
Does roughness hinder the flow?
===============================

Between rough surfaces a pressure gradient drives less fluid; below a mean gap of 0.4 roughnesses no path is left.  With
the flow factor of an effective medium less fluid leaks out, and asperities carry less.  Laws: docs/fluids.md; the plain
model: theory.md.  Runs in two seconds.
"""

import numpy as np

import stribeck as sb

STATE = sb.Groups(speed=1e-3, load=0.1, roughness=1e-4)
FLOWS = {
    "flow as between smooth surfaces": {"cavitation": "exit"},
    "effective medium": {"cavitation": "exit", "flow_factors": sb.fluids.EffectiveMedium(alpha=2.0)},
}


def main():
    """Return the curve of each over the speed group, the boundary friction being one."""
    speeds = np.geomspace(1e-6, 1e-2, 25)
    return {name: sb.stribeck_curve(STATE, speed=speeds, rtol=1e-4, **parts) for name, parts in FLOWS.items()}


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
    plot(curves).savefig("flow_between_asperities.png")
