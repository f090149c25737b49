"""Which contact law for a heavy load?
===================================

From load group one on the exponential law cannot carry the load at a positive gap; Persson's law, from a power spectrum, can.
The range of the laws is in theory.md, section 8, all of them in docs/contact_laws.md.  Runs in three seconds.
"""

import stribeck as sb

STATE = sb.Groups(speed=1e-6, load=3.0, roughness=0.03)  # relative roughness 0.01


def main():
    """Return the curve of each law over the speed group."""
    spectrum = sb.surfaces.SelfAffine(h_rms=1e-6, q0=1e4, q1=1e7, hurst=0.8)
    laws = {"exponential": None, "Persson": sb.surfaces.persson_law(spectrum)}
    return {name: sb.stribeck_curve(STATE, speed=(1e-11, 1.0), points=45, law=law) for name, law in laws.items()}


def plot(curves):
    """Draw friction and the central separation in decay lengths of the law."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6, 6), layout="constrained")
    above, below = figure.subplots(2, sharex=True)
    for name, curve in curves.items():
        above.loglog(curve.values, curve.friction, label=name)
        below.semilogx(curve.values, [s.central_separation for s in curve.solutions], label=name)
    above.set(ylabel="friction coefficient")
    below.set(xlabel=r"speed group $\lambda$", ylabel=r"$\alpha h(0)/h_\mathrm{rms}$", ylim=(-1, 10))
    above.legend()
    return figure


if __name__ == "__main__":
    curves = main()
    for name, curve in curves.items():
        print(f"{name:12} plateau {curve.friction[0]:.3f}, central separation {curve.solutions[0].central_separation:.2f}")
    plot(curves).savefig("two_laws_at_heavy_load.png")
