"""How often the true spectrum lies within the errors of the fit: synthetic maps and profiles of known spectra.

Prints the table of docs/surfaces.md: for each parameter the share of surfaces of which the truth lies within one and two
standard errors (68 and 95 % if these were normal), and the median relative error.
Three minutes on one thread for the default number.
"""

import argparse
import math

import numpy as np

from stribeck.surfaces import SelfAffine, detrended, fit_self_affine, power_spectrum, synthetic_topography

STEP = 1e-6
NAMES = ("h_rms", "hurst", "roll_off")


def surface(points, waves, hurst):
    """Return a surface whose roll-off has so many waves in a scan of so many points."""
    fundamental = 2 * math.pi / (points * STEP)
    return SelfAffine(1e-6, fundamental / 2, 3e6, hurst, waves * fundamental)


CASES = {
    "map, 128 x 128, H = 0.8, 7 waves": (surface(128, 7, 0.8), (128, 128)),
    "map, 128 x 128, H = 0.5, 7 waves": (surface(128, 7, 0.5), (128, 128)),
    "map, 256 x 256, H = 0.8, 8 waves": (surface(256, 8, 0.8), (256, 256)),
    "profile, 1024, H = 0.8, 16 waves": (surface(1024, 16, 0.8), (1024,)),
}


def of(truth, name, fit):
    """Return the true value of a parameter; the height is that of waves that the scan resolves."""
    return truth.spectrum.between(truth.q0, fit.roughness.q1).rms_height if name == "h_rms" else getattr(truth, name)


def main():
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--number", type=int, default=60, help="surfaces of each kind")
    number = parser.parse_args().number
    print("| scan, waves of the roll-off in it | roll-off found | " + " | ".join(NAMES) + " |")
    print("|---|---|" + "---|" * len(NAMES))
    for title, (truth, points) in CASES.items():
        fits = []
        for seed in range(number):
            flat, _ = detrended(synthetic_topography(truth, points, STEP, 5000 + seed))
            fits.append(fit_self_affine(power_spectrum(flat)))
        found = [fit for fit in fits if "roll_off" in fit.found]
        cells = []
        for name in NAMES:
            z = np.array([abs(getattr(fit.roughness, name) - of(truth, name, fit)) / fit.errors[name] for fit in found])
            relative = np.median([fit.errors[name] / of(truth, name, fit) for fit in found])
            cells.append(f"{100 * np.mean(z < 1):.0f} %, {100 * np.mean(z < 2):.0f} % ({100 * relative:.0f} %)")
        print(f"| {title} | {len(found)} of {number} | {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    main()
