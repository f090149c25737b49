"""
How does friction change over a stroke?
=======================================

A cylinder moves to and fro on a slow rig, over 53 half-widths of its contact.  The film of the fast phase is trapped where the
motion turns, so friction differs before and after a reversal.  The animation runs through a cycle; the picture below it shows
the whole stroke.  Equations: docs/theory.md and docs/strokes.md.  Runs in ten seconds.
"""

from pathlib import Path

import numpy as np

import stribeck as sb

CASE = Path(__file__).parent / "reciprocating_cylinder.toml"
FRAMES = 48


def main():
    """Return the stroke of the case, whose film ends behind the contact."""
    case = sb.load_case(CASE)
    return sb.stroke(case.contact, case.stroke.motion, cavitation="exit", steps=160)


def plot(found):
    """Draw the whole stroke."""
    return found.plot()


def animation(found):
    """Return the animation of friction over position, and of the film over time."""
    from matplotlib import pyplot as plt
    from matplotlib.animation import FuncAnimation

    last = found.last_cycle
    time, place = found.time[last] - found.time[last][0], 1e3 * found.position[last]
    friction, film = found.friction[last], 1e6 * found.central_film_thickness[last]
    figure, (loop, over_time) = plt.subplots(1, 2, figsize=(8, 3.4), dpi=80, layout="constrained")
    loop.plot(place, friction, color="0.7")
    over_time.plot(time, film, color="0.7")
    loop.set(xlabel="position (mm)", ylabel="friction coefficient")
    over_time.set(xlabel="time (s)", ylabel="film at the centre (um)")
    dots = [axes.plot([], [], "o", color="C3")[0] for axes in (loop, over_time)]

    def show(t):
        at = [np.interp(t, time, values) for values in (place, friction, film)]
        dots[0].set_data([at[0]], [at[1]])
        dots[1].set_data([t], [at[2]])
        return dots

    return FuncAnimation(figure, show, np.linspace(0, time[-1], FRAMES, endpoint=False), interval=80)


if __name__ == "__main__":
    found = main()
    print(found)
    animation(found).save("friction_over_a_stroke.gif", writer="pillow")
    plot(found).savefig("friction_over_a_stroke_loop.png")
