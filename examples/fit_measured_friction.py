"""Fit a cylinder: boundary friction, roughness and modulus
========================================================

Two fluids, one contact: friction coefficient, roughness and modulus with their intervals.  The data are synthetic, solved with
the model of theory.md and 4 % of noise, so that the answer is known; docs/fitting.md.  Runs in ten seconds.
"""

from pathlib import Path

import stribeck as sb

HERE = Path(__file__).parent
TRUTH = {"boundary_friction": 0.62, "roughness": 1.3e-6, "modulus": 2.3e6}


def main():
    """Return the fit."""
    return sb.fit(HERE / "pdms_measured.csv", HERE / "pdms_fit.toml")


def plot(fit):
    """Draw data, fitted curves and residuals."""
    from stribeck.plot.fit import plot_fit

    return plot_fit(fit)


if __name__ == "__main__":
    found = main()
    for name, truth in TRUTH.items():
        low, high = found[name].interval_95
        print(f"{name:22} {found[name].value:.4g}, 95 % {low:.4g} to {high:.4g}; made with {truth:g}")
    print(*found.notes, sep="\n")
    plot(found).savefig("fit_measured_friction.png")
