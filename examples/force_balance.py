"""Which friction force balances?
==============================

And where does the printed one depart from it?  The identities of theory.md, section 6, on solved states: int p w' dx = 0,
int p_c h' dx = 0, and the difference of the viscous frictions.  Slopes are differences.  Runs in half a second.
"""

import numpy as np

import stribeck as sb

LOAD, ROUGHNESS = 0.1, 1e-4


def main():
    """Return, for each speed, both identities and both viscous frictions for beta = 1."""
    return {s: balance(sb.solve(sb.Groups(s, LOAD, ROUGHNESS), rtol=1e-9)) for s in np.geomspace(1e-8, 1e-3, 6)}


def balance(state):
    """Return the identities, relative to the integrals of their absolute values, and the frictions."""
    x, weights = state.mesh.nodes, state.mesh.weights
    here = state.profile(x)
    step = 1e-6 * np.maximum(1.0, np.abs(x))
    gap_slope = (state.profile(x + step).gap - state.profile(x - step).gap) / (2 * step)
    published, balanced = (state.friction(boundary_friction=1, beta=1, definition=d) for d in ("published", "balanced"))
    return {
        "int p w'": relative(weights * here.pressure * (gap_slope - x)),
        "int p_c h'": relative(weights * here.contact_pressure * gap_slope),
        "published": published.fluid,
        "balanced": balanced.fluid,
        "difference": published.fluid - balanced.fluid,
        "4 F^(1/2)/pi int p_c x": 4 * LOAD**0.5 / np.pi * (weights @ (here.contact_pressure * x)),
        "published, total": published.total,
        "balanced, total": balanced.total,
    }


def relative(terms):
    """Return the sum of terms over the sum of their absolute values."""
    return float(terms.sum() / np.abs(terms).sum())


def plot(rows):
    """Draw the two viscous frictions against the speed group."""
    from matplotlib.figure import Figure

    axes = Figure(layout="constrained").subplots()
    for name in ("published", "balanced"):
        axes.loglog(list(rows), [row[name] for row in rows.values()], "o-", label=name)
    axes.set(xlabel=r"speed group $\lambda$", ylabel="viscous friction for beta = 1")
    return axes.legend().figure


if __name__ == "__main__":
    rows = main()
    print(f"{'speed group':24}", *(f"{speed:12.0e}" for speed in rows))
    for name in rows[min(rows)]:
        print(f"{name:24}", *(f"{row[name]:12.4e}" for row in rows.values()))
    plot(rows).savefig("force_balance.png")
