"""What a scan is not: isotropic, Gaussian, of a size that instruments measure; and that chance is not taken for any of it."""

import math

import numpy as np
import pytest
from command_line import call

from stribeck.surfaces import SelfAffine, Topography, analyse, synthetic_topography

STEP = 1e-6
FUNDAMENTAL = 2 * math.pi / 128e-6


def ground(ratio, direction, seed, points=(128, 128), hurst=0.8):
    """Return a surface whose features are longer by ``ratio`` at ``direction`` to the first axis."""
    n = [2 * count for count in points]
    qx, qy = np.meshgrid(*(2 * math.pi * np.fft.fftfreq(count, STEP) for count in n), indexing="ij")
    along, across = qx * math.cos(direction) + qy * math.sin(direction), qy * math.cos(direction) - qx * math.sin(direction)
    q = np.hypot(along * math.sqrt(ratio), across / math.sqrt(ratio))
    power = SelfAffine(1e-6, FUNDAMENTAL / 2, 1e7, hurst, 3 * FUNDAMENTAL).spectrum.at(q)
    z = np.fft.ifft2(np.fft.fft2(np.random.default_rng(seed).standard_normal(n)) * np.sqrt(power)).real
    z = z[: points[0], : points[1]]
    return Topography(z * (1e-6 / z.std()), (STEP, STEP))


def test_chance_is_not_taken_for_texture_or_skewness(subtests):
    for seed in range(3):
        with subtests.test(seed=seed):
            surface = analyse(ground(1.0, 0.0, seed, (96, 160)))
            assert surface.departures.aspect_ratio == 1.0 and surface.departures.direction is None
            assert abs(surface.departures.skewness) < 3 * surface.departures.skewness_error
            assert not any("anisotropic" in note or "Gaussian" in note for note in surface.notes)


def test_a_texture_of_three_to_one_is_found_with_its_direction(subtests):
    for degrees in [0, 135]:
        with subtests.test(degrees=degrees):
            surface = analyse(ground(3.0, math.radians(degrees), 40 + degrees))
            assert surface.departures.aspect_ratio == pytest.approx(3.0, rel=0.25)
            assert abs(math.remainder(surface.departures.direction - math.radians(degrees), math.pi)) < math.radians(6)
            [note] = [note for note in surface.notes if "anisotropic" in note]
            assert "averages over directions" in note


def test_a_profile_does_not_show_a_texture():
    line = ground(3.0, 0.0, 50, (512, 64)).heights[:, 0]
    assert analyse(Topography(line, (STEP,))).departures.aspect_ratio is None


def test_heights_of_peaks_or_valleys_are_found_skewed(subtests):
    for sign in [1, -1]:
        with subtests.test(sign=sign):
            plain = ground(1.0, 0.0, 61)
            skewed = sign * np.exp(0.7 * plain.heights / plain.heights.std()) * 1e-6
            surface = analyse(Topography(skewed, plain.spacing))
            assert surface.departures.skewness * sign > 1
            [note] = [note for note in surface.notes if "not Gaussian" in note]
            assert ("peaks on a plain" if sign > 0 else "plateaus with valleys") in note


def test_the_error_of_the_skewness_is_that_of_gaussian_surfaces():
    scores = []
    for seed in range(12):
        found = analyse(synthetic_topography(SelfAffine(1e-6, FUNDAMENTAL, 3e6, 0.8, 9 * FUNDAMENTAL), (64, 64), STEP, seed))
        scores.append(found.departures.skewness / found.departures.skewness_error)
    assert 0.6 < np.std(scores) < 1.5


def test_a_size_that_no_instrument_measures_is_remarked_upon(subtests):
    for length, height, words in [
        (1e6, 1e3, "The scan is 64 m long, longer than any instrument measures; check the unit of positions."),
        (1.0, 1e4, "The rms height is 10 mm, which is not plausible; check the unit of heights."),
        (1.0, 100.0, "steeper than instruments follow"),
        (1.0, 1e-6, "The rms height is 1 pm"),
    ]:
        with subtests.test(length=length, height=height, words=words):
            plain = ground(1.0, 0.0, 70, (64, 64))
            scan = Topography(plain.heights * height, (STEP * length,) * 2)
            notes = [note for note in analyse(scan, trend="mean").notes if "unit" in note]
            assert any(words in note for note in notes)


def test_the_command_says_what_departs(capsys, tmp_path):
    np.savetxt(tmp_path / "scan.csv", ground(3.0, 0.0, 80, (64, 64)).heights * 1e9, fmt="%.6g", header="z (nm)")
    answer = call(capsys, "surface", tmp_path / "scan.csv", "--unit", "nm", "--spacing", "1 um")
    assert answer.code == 0, answer.err
    assert "longer at " in answer.out and "The surface is anisotropic" in answer.out
    answer = call(capsys, "surface", tmp_path / "scan.csv", "--unit", "nm", "--spacing", "1 m")
    assert "The scan is 64 m long" in answer.out
