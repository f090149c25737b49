"""In which regime is my contact?
==============================

At which speed does lubrication change, and how does that depend on roughness?  The PDMS cylinder again, its transitions on
solved states; the criteria are in theory.md, section 9.  Runs in five seconds.
"""

from pathlib import Path

import stribeck as sb

CASE = Path(__file__).with_name("pdms_cylinder.toml")


def main():
    """Return the diagram over speed and roughness, in SI units."""
    contact = sb.load_case(CASE).contact
    return sb.phase_diagram(contact, roughness=("0.1 um", "10 um"), points={"roughness": 5, "speed": 21})


def plot(diagram):
    """Draw the regimes and the lines between them."""
    from stribeck.plot.phase_diagram import plot_phase_diagram

    return plot_phase_diagram(diagram)


if __name__ == "__main__":
    diagram = main()
    print("roughness (um)   boundary ends (mm/s)   minimum friction at (mm/s)")
    for i, roughness in enumerate(diagram.roughness.values):
        ends, lowest = (float(diagram[name].values.ravel()[i]) for name in ("speed_at_5_percent_fluid", "speed_at_minimum"))
        print(f"{1e6 * roughness:10.2f} {1e3 * ends:20.3g} {1e3 * lowest:24.3g}")
    plot(diagram).savefig("regimes_of_a_contact.png")
