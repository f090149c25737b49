"""What moves the friction minimum?
================================

Each quantity of the contact is doubled alone; the minimum is located on solved states.
Equations: theory.md Eqs. (1)-(5).  Reference: Bertin and Pouliquen, Eq. (minimal_friction), by which the
minimum friction goes as h_rms**(2/3) F_N**(-1/6) up to logarithms where the minimum lies at a small speed
group; here it lies at 0.3.  Runs in about four seconds.
"""

import math
from pathlib import Path

import stribeck as sb

CASE = Path(__file__).with_name("pdms_cylinder.toml")
QUANTITIES = ("roughness", "load", "viscosity", "modulus", "radius", "boundary_friction", "beta")


def main():
    """Return, for each quantity, the exponents with which it moves the minimum friction and its speed."""
    contact = sb.load_case(CASE).contact
    base = minimum(contact)
    exponents = {}
    for name in QUANTITIES:
        moved = minimum(contact.replace(**{name: 2 * getattr(contact, name)}))
        exponents[name] = (math.log2(moved.friction / base.friction), math.log2(moved.value / base.value))
    return exponents


def minimum(contact):
    """Return the friction minimum of a contact along the speed."""
    return sb.stribeck_curve(contact, points=41).minimum


def plot(exponents):
    """Draw the exponents as bars."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6, 4), layout="constrained")
    axes = figure.subplots()
    places = range(len(exponents))
    axes.barh([p - 0.2 for p in places], [e[0] for e in exponents.values()], 0.4, label="minimum friction")
    axes.barh([p + 0.2 for p in places], [e[1] for e in exponents.values()], 0.4, label="its speed")
    axes.set_yticks(list(places), [name.replace("_", " ") for name in exponents])
    axes.set_xlabel("exponent")
    axes.legend()
    return figure


if __name__ == "__main__":
    exponents = main()
    print("doubling          minimum friction   its speed    (exponents)")
    for name, (friction, speed) in exponents.items():
        print(f"{name:20} {friction:10.3f} {speed:13.3f}")
    plot(exponents).savefig("what_moves_the_minimum.png")
