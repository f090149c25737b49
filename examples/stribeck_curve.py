"""Where is the friction minimum?
==============================

The Stribeck curve of a PDMS cylinder in glycerol-water, from a data sheet to the minimum of friction.

Equations: theory.md Eqs. (1)-(5).  Reference: Bertin and Pouliquen, Section "Stribeck curve".
Runs in about a second.
"""

import stribeck as sb


def main():
    """Return the curve from the boundary plateau to the hydrodynamic branch."""
    contact = sb.LineContact(
        radius="10 mm",
        modulus="2.7 MPa",
        load="30 N/m",
        viscosity="50 mPa*s",
        speed="1 mm/s",
        roughness="1 um",
        alpha=2.0,
        beta=0.06,
        boundary_friction=0.7,
    )
    return sb.stribeck_curve(contact)


def plot(curve):
    """Draw friction against the Hersey number."""
    return curve.plot()


if __name__ == "__main__":
    curve = main()
    lowest = curve.minimum
    print(f"minimum friction {lowest.friction:.4f} at {lowest.value:.3g} m/s")
    for mark in curve.transitions:
        print(f"{mark.name}: {mark.value:.3g} m/s")
    plot(curve).savefig("stribeck_curve.png")
