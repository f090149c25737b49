"""At which film does a rough ball leave mixed lubrication?
========================================================

Bongaerts, Fourtouni and Stokes (2007) slid PDMS balls with roughnesses up to 3.6 um over PDMS discs and found the transition
to full films at 0.7 to 11 times the roughness.  Here such a ball is solved with Persson's law for three heights of one kind of
surface.  Equations: theory.md, section 11.  Runs in about a quarter of a minute.
"""

from pathlib import Path

import stribeck as sb

CASE = Path(__file__).with_name("pdms_ball.toml")
ROUGHNESS = (0.9e-6, 1.8e-6, 3.6e-6)
REPORTED = (0.7, 11.0)


def main():
    """Return, for each roughness, speed and central film over roughness of the minimum and of the transition."""
    found = {}
    for h_rms in ROUGHNESS:
        law = sb.surfaces.persson_law(sb.surfaces.SelfAffine(h_rms=h_rms, q0=3.1e4, q1=6.3e6, hurst=0.8))
        ball = sb.load_case(CASE).contact.replace(roughness=h_rms, alpha=law.alpha, beta=law.beta, law=law)
        curve = sb.stribeck_curve(ball, speed=speeds(ball), points=7, rtol=1e-3)
        found[h_rms] = {mark.name: (mark.value, film_ratio(mark.solution)) for mark in curve.transitions}
    return found


def speeds(ball, ratios=(0.5, 16.0)):
    """Return the speeds at which the film of a smooth ball would be these multiples of the roughness."""
    at_one = ball.replace(speed=1.0).groups.speed
    return tuple((ratio * ball.roughness / ball.hertz.indentation / 0.4248) ** (1 / 0.6) / at_one for ratio in ratios)


def film_ratio(solution):
    """Return the central film over the roughness."""
    return solution.central_film_thickness / solution.contact.roughness


def plot(found):
    """Draw the film ratios over the roughness beside the reported range."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6, 4), layout="constrained")
    axes = figure.subplots()
    axes.axhspan(*REPORTED, color="0.9", label="transitions reported for such balls")
    for name in dict.fromkeys(name for marks in found.values() for name in marks):
        points = [(1e6 * h_rms, marks[name][1]) for h_rms, marks in found.items() if name in marks]
        axes.loglog(*zip(*points, strict=True), "o-", label=name)
    axes.set(xlabel=r"roughness $h_\mathrm{rms}$ (µm)", ylabel="central film over roughness")
    axes.legend(fontsize=8)
    return figure


if __name__ == "__main__":
    found = main()
    for h_rms, marks in found.items():
        for name, (speed, ratio) in marks.items():
            print(f"h_rms {1e6 * h_rms:4.1f} um  {name:38} U = {1e3 * speed:8.3g} mm/s  film/h_rms = {ratio:.2f}")
    plot(found).savefig("transition_of_a_ball.png")
