"""From a measured profile to the contact law
==========================================

A profile gives h_rms, alpha and beta, each with its error.

The spectrum and Persson's relation of theory.md, section 8; docs/surfaces.md.  The profile is synthetic, with H = 0.8,
h_rms = 0.6 um and a roll-off at 105 um, on a cylinder of 8 mm.  Runs in two seconds.
"""

from pathlib import Path

import numpy as np

import stribeck as sb

PROFILE = Path(__file__).with_name("cylinder_profile.csv")


def main():
    """Return the surface that the profile shows."""
    return sb.surfaces.analyse(sb.surfaces.read_topography(PROFILE))


def plot(surface):
    """Draw the full law and its exponential limit against the separation."""
    from matplotlib.figure import Figure

    law = surface.law
    u = np.linspace(0.01, 3, 300)  # in h_rms
    axes = Figure(layout="constrained").subplots()
    axes.semilogy(u, law.beta * np.exp(law.log_pressure(law.alpha * u)), label="Persson")
    axes.semilogy(u, law.beta * np.exp(-law.alpha * u), "--", label="exponential limit")
    axes.set(xlabel="separation over rms height", ylabel="contact pressure over modulus")
    axes.legend()
    return axes.figure


if __name__ == "__main__":
    found = main()
    values = found.to_dict()
    for name in ("body_radius", "h_rms", "hurst"):
        print(f"{name}: {values[name]:.4g} +- {values[name + '_error']:.1g}")
    for name in ("alpha", "beta"):
        print(f"{name}: {values[name]:.3g}, 95 % interval {values[name + '_low_95']:.3g} to {values[name + '_high_95']:.3g}")
    plot(found).savefig("contact_law.png")
