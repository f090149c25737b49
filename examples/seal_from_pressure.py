"""From the contact pressure of a seal to its films
================================================

A U-cup is no parabola; finite elements give its contact pressure.  From that follow the shape that a half-space would need,
theory.md section 13, and the films of both strokes.  The film of the stroke out is thinner than that of the stroke in, so the
seal takes oil back; the formula of docs/leakage.md says how much, without asperities.  The pressure is synthetic.
Runs in ten seconds.
"""

from pathlib import Path

import numpy as np

import stribeck as sb

PRESSURE = Path(__file__).with_name("rod_seal_pressure.csv")
INPUTS = {"modulus": 10e6, "viscosity": 0.1, "speed": 0.1}


def main():
    """Return the states of both strokes, and the films of the formula."""
    x, p = np.loadtxt(PRESSURE, delimiter=";", comments=("#", "x")).T * np.array([[1e-3], [1e6]])
    inside = np.flatnonzero(p > 0)
    x, p = (each[inside[0] - 1 : inside[-1] + 2] for each in (x, p))
    load = float(np.sum(0.5 * (p[1:] + p[:-1]) * np.diff(x)))
    states = {}
    for stroke, reversed in (("out", False), ("in", True)):
        shape = sb.profiles.from_pressure(x, p, INPUTS["modulus"], reversed=reversed)
        surface = {"roughness": 0.2e-6, "alpha": 2.0, "beta": 0.02, "boundary_friction": 0.3}
        states[stroke] = sb.solve(sb.LineContact(profile=shape, load=load, **surface, **INPUTS), rtol=1e-4)
    return states, sb.asymptotics.film_of_pressure(x, p, **INPUTS)


def film_of(state):
    """Return the gap h* of a state at the highest pressure of its film, through which half of the speed's liquid flows [m]."""
    return state.flux_gap * state.contact.hertz.indentation


def plot(found):
    """Draw the film of both strokes."""
    from matplotlib.figure import Figure

    states, formula = found
    axes = Figure(layout="constrained").subplots()
    for (stroke, state), film in zip(states.items(), (formula.forward, formula.backward), strict=True):
        scales, label = state.contact.hertz, f"stroke {stroke}, friction {state.friction().total:.3f}"
        [line] = axes.plot(1e3 * scales.half_width * state.x, 1e6 * scales.indentation * state.gap, label=label)
        axes.axhline(1e6 * film, color=line.get_color(), linestyle=":")
    axes.set(xlabel="position (mm)", ylabel="film, dotted: h* (um)", yscale="log", xlim=(-1, 1), ylim=(0.1, 100))
    axes.legend()
    return axes.figure


if __name__ == "__main__":
    states, formula = main()
    for stroke, state in states.items():
        print(f"stroke {stroke}: friction {state.friction().total:.4f}, film h* {1e6 * film_of(state):.3f} um")
    print(formula)
    plot((states, formula)).savefig("seal_from_pressure.png")
