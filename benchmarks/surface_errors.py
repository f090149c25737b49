"""How often the true spectrum lies within the errors of the fit: synthetic maps and profiles of known spectra.

Prints the two tables behind the shares in docs/surfaces.md.  The first is for standard errors: for each parameter the share
of surfaces of which the truth lies within one and two standard errors (68 and 95 % if these were normal), and the median
relative error, where a roll-off was found.  The second is for the 95 % intervals of alpha and beta, of all surfaces: the share
that holds the truth, and the median ends over the truth.
Two minutes on one thread for the default number.
"""

import argparse
import math
from dataclasses import replace

import numpy as np

from stribeck.surfaces import (
    SelfAffine,
    detrended,
    exponential_limit,
    fit_self_affine,
    power_spectrum,
    synthetic_topography,
)

STEP = 1e-6
NAMES = ("h_rms", "hurst", "roll_off")


def surface(points, waves, hurst, longest=2.0):
    """Return a surface whose roll-off has so many waves in a scan of so many points; none if ``waves`` is None."""
    fundamental = 2 * math.pi / (points * STEP)
    return SelfAffine(1e-6, fundamental / longest, 3e6, hurst, None if waves is None else waves * fundamental)


CASES = {
    "map, 128 x 128, H = 0.8, 7 waves": (surface(128, 7, 0.8), (128, 128)),
    "map, 128 x 128, H = 0.5, 7 waves": (surface(128, 7, 0.5), (128, 128)),
    "map, 256 x 256, H = 0.8, 8 waves": (surface(256, 8, 0.8), (256, 256)),
    "profile, 1024, H = 0.8, 16 waves": (surface(1024, 16, 0.8), (1024,)),
}


LIMITS = CASES | {
    "map, 128 x 128, H = 0.6, 7 waves": (surface(128, 7, 0.6), (128, 128)),
    "map, 128 x 128, H = 0.8, 7 waves, shortest wave 10 nm": (
        replace(surface(128, 7, 0.8), q1=2 * math.pi / 1e-8),
        (128, 128),
    ),
    "map, 128 x 128, H = 0.8, 7 waves, longest wave as the scan": (surface(128, 7, 0.8, 1.0), (128, 128)),
    "map, 128 x 128, H = 0.8, 7 waves, longest wave 20 scans": (surface(128, 7, 0.8, 20.0), (128, 128)),
    "map, 128 x 128, H = 0.8, 7 waves, longest wave a third of the scan": (surface(128, 7, 0.8, 1 / 3), (128, 128)),
    "profile, 1024, H = 0.8, 16 waves, longest wave a fifth of the scan": (surface(1024, 16, 0.8, 0.2), (1024,)),
    "map, 128 x 128, H = 0.8, 4 waves": (surface(128, 4, 0.8), (128, 128)),
    "map, 128 x 128, H = 0.8, no roll-off, longest wave 4 scans": (surface(128, None, 0.8, 4.0), (128, 128)),
    "map, 128 x 128, H = 0.5, no roll-off, longest wave as the scan": (surface(128, None, 0.5, 1.0), (128, 128)),
    "profile, 1024, H = 0.8, no roll-off, longest wave 4 scans": (surface(1024, None, 0.8, 4.0), (1024,)),
}


def of(truth, name, fit):
    """Return the true value of a parameter; the height is that of waves that the scan resolves."""
    return truth.spectrum.between(truth.q0, fit.roughness.q1).rms_height if name == "h_rms" else getattr(truth, name)


def fits_of(truth, points, number):
    """Return the fits of so many surfaces."""
    fits = []
    for seed in range(number):
        flat, _ = detrended(synthetic_topography(truth, points, STEP, 5000 + seed))
        fits.append(fit_self_affine(power_spectrum(flat)))
    return fits


def errors_row(title, truth, fits):
    """Return a row of the first table."""
    found = [fit for fit in fits if "roll_off" in fit.found]
    cells = []
    for name in NAMES:
        z = np.array([abs(getattr(fit.roughness, name) - of(truth, name, fit)) / fit.errors[name] for fit in found])
        relative = np.median([fit.errors[name] / of(truth, name, fit) for fit in found])
        cells.append(f"{100 * np.mean(z < 1):.0f} %, {100 * np.mean(z < 2):.0f} % ({100 * relative:.0f} %)")
    return f"| {title} | {len(found)} of {len(fits)} | {' | '.join(cells)} |"


def limits_row(title, truth, fits):
    """Return a row of the second table; the truth is that of all waves, seen or not."""
    cells = []
    true_limits, limits = exponential_limit(truth), [fit.exponential_limit() for fit in fits]
    for i in (0, 1):
        pairs = [(limit[i], true_limits[i]) for limit in limits]
        inside = np.mean([found.low < true < found.high for found, true in pairs])
        value, low, high = (
            np.median([getattr(found, end) / true for found, true in pairs]) for end in ("value", "low", "high")
        )
        cells.append(f"{100 * inside:.0f} % ({value:.2f}; {low:.2f} to {high:.2f})")
    found = sum("roll_off" in fit.found for fit in fits)
    return f"| {title} | {found} of {len(fits)} | {' | '.join(cells)} |"


def main():
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--number", type=int, default=60, help="surfaces of each kind")
    number = parser.parse_args().number
    fits = {title: fits_of(*case, number) for title, case in LIMITS.items()}
    print("| scan, waves of the roll-off in it | roll-off found | " + " | ".join(NAMES) + " |")
    print("|---|---|" + "---|" * len(NAMES))
    for title, (truth, _) in CASES.items():
        print(errors_row(title, truth, fits[title]))
    print("\n| scan, waves of the roll-off in it | roll-off found | alpha | beta |\n|---|---|---|---|")
    for title, (truth, _) in LIMITS.items():
        print(limits_row(title, truth, fits[title]))


if __name__ == "__main__":
    main()
