"""Who carries the load at one speed?
==================================

A state in mixed lubrication: the loads on asperities and fluid, and the film.

Equations: theory.md Eqs. (1)-(5).  Reference: Bertin and Pouliquen, Fig. 8, for its parameters.
Runs in a tenth of a second.
"""

import numpy as np

import stribeck as sb


def main():
    """Return the state at speed 1e-4, load 0.1, roughness 1e-4, and its fields along the contact."""
    state = sb.solve(sb.Groups(speed=1e-4, load=0.1, roughness=1e-4), rtol=1e-8)
    return state, state.profile(np.linspace(-1.5, 1.5, 601))


def plot(data):
    """Draw the gap in roughness heights and the two pressures."""
    from matplotlib.figure import Figure

    state, fields = data
    figure = Figure(figsize=(6, 6), layout="constrained")
    above, below = figure.subplots(2, sharex=True)
    above.semilogy(fields.x, fields.gap / state.groups.relative_roughness)
    above.set_ylabel(r"gap $\alpha h/h_\mathrm{rms}$")
    below.plot(fields.x, fields.contact_pressure, label="contact")
    below.plot(fields.x, fields.fluid_pressure, label="fluid")
    below.set(xlabel="$x/a$", ylabel=r"pressure $p/p_\mathrm{Hz}$")
    below.legend()
    return figure


if __name__ == "__main__":
    state, fields = data = main()
    print(f"{state.outcome.value} Relative error about {state.error_estimate:.0e}.")
    print(f"the fluid carries {state.fluid_load_share:.6f} of the load")
    print(f"central gap {state.central_gap:.8f} u_Hz, minimum gap {state.minimum_gap:.8f} u_Hz")
    print(f"flux gap {state.flux_gap:.8f} u_Hz, offset {state.offset:.8f} u_Hz")
    for definition in ("published", "balanced"):
        print(f"friction ({definition}): {state.friction(boundary_friction=1, beta=1, definition=definition).total:.8f}")
    plot(data).savefig("one_state.png")
