"""What lowers the friction of a seal?
===================================

Half the roughness, or oil twice as viscous?  A seal under Persson's contact law, theory.md section 8, over the speeds of its
stroke; docs/for_engineers.md walks through it.  Runs in five seconds.
"""

import dataclasses
from pathlib import Path

import stribeck as sb

CASE = Path(__file__).with_name("rod_seal.toml")


def main():
    """Return a curve for each lever: friction over the speeds of a stroke."""
    contact = sb.load_case(CASE).contact
    smoother = contact.law.scaled(contact.roughness / 2)  # heights halved, wavelengths kept: beta follows
    levers = {
        "as it is": contact,
        "oil twice as viscous": dataclasses.replace(contact, viscosity=2 * contact.viscosity),
        "half the roughness": dataclasses.replace(contact, law=smoother, **smoother.coefficients),
    }
    return {name: sb.stribeck_curve(one, speed=("1 mm/s", "1 m/s"), points=31) for name, one in levers.items()}


def plot(curves):
    """Draw friction against speed."""
    from matplotlib.figure import Figure

    axes = Figure(layout="constrained").subplots()
    for name, curve in curves.items():
        axes.loglog(curve.values, curve.friction, label=name)
    axes.set(xlabel="speed (m/s)", ylabel="friction coefficient")
    axes.legend()
    return axes.figure


if __name__ == "__main__":
    curves = main()
    for name, curve in curves.items():
        lowest = curve.minimum
        print(f"{name:22} minimum friction {lowest.friction:.4f} at {1e3 * lowest.value:.0f} mm/s")
    plot(curves).savefig("levers_of_a_seal.png")
