"""Several scans of one surface in one law: the mean spectrum, and intervals that hold the truth."""

import json
import math
import re
import tomllib
from functools import cache

import numpy as np
import pytest
from command_line import call
from scipy.stats import t

import stribeck as sb
from stribeck.surfaces import SelfAffine, Topography, analyse, combine, exponential_limit, synthetic_topography

STEP = 1e-6
FUNDAMENTAL = 2 * math.pi / 64e-6
TRUTH = SelfAffine(1e-6, FUNDAMENTAL / 2, 3e6, 0.8, 7 * FUNDAMENTAL)


@cache
def place(seed, points=(64, 64), factor=1.0):
    scan = synthetic_topography(TRUTH, points, STEP, seed)
    return analyse(Topography(scan.heights * factor, scan.spacing, f"place {seed}"))


def interval(surface, name):
    (number,) = (each for each in surface.numbers if each.name == name)
    return number.value, *number.interval


def misses(sets, spread=0.0):
    """Return how many sets of three scans miss the truth; heights of places differ by ``spread``."""
    alpha, beta = exponential_limit(TRUTH)
    factors = np.exp(spread * np.random.default_rng(3).standard_normal((sets, 3)))
    rms = math.exp(spread**2)  # root of the mean square of the factor
    found = dict.fromkeys(("h_rms", "hurst", "alpha", "beta"), 0)
    for k in range(sets):
        surface = combine([place(3 * k + i, factor=float(factors[k, i])) for i in range(3)])
        height = rms * TRUTH.spectrum.between(TRUTH.q0, surface.roughness.q1).rms_height
        for name, value in (("h_rms", height), ("hurst", 0.8), ("alpha", alpha), ("beta", rms * beta)):
            _, low, high = interval(surface, name)
            found[name] += not low <= value <= high
    return found


@pytest.mark.slow
def test_intervals_of_three_scans_hold_the_true_surface():
    assert max(misses(3, spread=0.3).values()) <= 1


@pytest.mark.slow
def test_intervals_of_three_scans_cover_as_they_say(subtests):
    for spread in (0.0, 0.3):
        with subtests.test(spread=spread):
            assert max(misses(40, spread).values()) <= 4


def test_a_roll_off_that_no_scan_shows_alone_has_a_wavelength():
    scans = [place(21), place(35)]
    assert not any("roll_off" in each.fit.found for each in scans)
    surface = combine(scans)
    assert surface.to_dict()["roll_off_wavelength"] == pytest.approx(2 * math.pi / surface.roughness.roll_off)
    assert surface.to_dict()["units"]["roll_off_wavelength"] == "m"
    assert "roll-off wavelength" in str(surface) and "0 of 2 scans alone do" in str(surface)


@pytest.fixture(scope="module")
def surface():
    return combine([place(seed) for seed in (0, 1, 2)])


def test_the_mean_spectrum_is_that_of_all_scans_with_their_scatter(surface):
    scans = surface.surfaces
    rings = np.array([each.measured.density[each.measured.reliable] for each in scans])
    assert surface.measured.density == pytest.approx(rings.mean(axis=0), rel=1e-12, abs=0)
    assert surface.scatter == pytest.approx(rings.std(axis=0, ddof=1) / math.sqrt(3), rel=1e-12, abs=0)
    assert surface.measured.modes == pytest.approx(3 * scans[0].measured.modes[scans[0].measured.reliable], rel=1e-12, abs=0)
    data = surface.to_dataset()
    assert np.array_equal(data.spectrum, surface.measured.density) and np.array_equal(data.spectrum_error, surface.scatter)


def test_height_parameters_have_the_mean_and_the_interval_of_student(subtests, surface):
    for name in ("scan_rms_height", "mean_deviation", "skewness", "kurtosis", "scan_rms_slope"):
        with subtests.test(name=name):
            values = [each.to_dict()[name] for each in surface.surfaces]
            half = t.ppf(0.975, 2) * np.std(values, ddof=1) / math.sqrt(3)
            expected = np.mean(values), np.mean(values) - half, np.mean(values) + half
            assert interval(surface, name) == pytest.approx(expected, rel=1e-9, abs=0)


def test_places_that_differ_widen_the_intervals_and_not_the_fit(surface):
    apart = combine([place(seed, factor=factor) for seed, factor in ((0, 0.7), (1, 1.0), (2, 1.4))])
    logs = np.log([each.roughness.h_rms for each in apart.surfaces])
    half = t.ppf(0.975, 2) * logs.std(ddof=1) / math.sqrt(3)
    value, low, high = interval(apart, "h_rms")
    assert (math.log(high / value), math.log(value / low)) == pytest.approx((half, half), rel=1e-6, abs=0)
    assert apart.errors["beta"] > 1.5 * surface.errors["beta"]
    with_beta = exponential_limit(apart.roughness)[1]
    assert apart.beta.value == pytest.approx(with_beta, rel=1e-6, abs=0) and apart.beta.low < with_beta < apart.beta.high


def test_scans_of_two_sizes_make_one_spectrum_and_say_so():
    small, large = place(0), place(1, points=(128, 128))
    surface = combine([small, large])
    assert surface.measured.lowest == large.measured.lowest and surface.measured.highest == small.measured.highest
    assert surface.measured.wavenumber.size > large.measured.reliable.sum()
    assert any("64 µm to 128 µm long" in note for note in surface.notes)


def test_propagation_takes_the_errors_of_a_surface_from_python_and_from_its_table(tmp_path, surface):
    sb.surfaces.write_surface_table(surface, tmp_path / "surface.toml")
    text = (tmp_path / "surface.toml").read_text()
    contact = '[contact]\nradius = "10 mm"\nmodulus = "2.7 MPa"\nload = "30 N/m"\nviscosity = "50 mPa*s"\nspeed = "1 mm/s"\n'
    for law in ("exponential", "persson"):
        path = tmp_path / f"{law}.toml"
        path.write_text(f'{contact}boundary_friction = 0.5\nlaw = "{law}"\n{text}')
        case = sb.load_case(path)
        assert case.errors == pytest.approx(surface.errors, rel=0.05, abs=0)
        assert case.contact.beta == pytest.approx(surface.beta.value, rel=1e-4, abs=0)
    inputs = {name: value for name, value in tomllib.loads(contact)["contact"].items()} | surface.inputs
    made = sb.LineContact(**inputs, boundary_friction=0.5)
    low, high = sb.propagate(made, surface.errors, transitions=False)["friction"].interval_95
    assert low < sb.solve(made).friction().total < high
    (tmp_path / "bad.toml").write_text(
        f"{contact}boundary_friction = 0.5\n{text}".replace('beta_error = "', 'beta_error = "-')
    )
    with pytest.raises(sb.InputError, match=r"\[surface\] beta_error"):
        sb.load_case(tmp_path / "bad.toml")


def test_the_command_combines_its_files(capsys, tmp_path):
    names = []
    for seed in (0, 1):
        z = place(seed).topography.heights
        x, y = np.meshgrid(np.arange(64.0), np.arange(64.0), indexing="ij")
        table = np.stack((x.ravel(), y.ravel(), 1e9 * z.ravel()), axis=1)
        names.append(tmp_path / f"place_{seed}.csv")
        np.savetxt(names[-1], table, fmt="%.6g", delimiter=",", header="x (um),y (um),z (nm)")
    words = call(capsys, "surface", *names, "--out", tmp_path / "s.toml", "--plot", tmp_path / "s.png")
    assert words.code == 0, words.err
    assert words.out.startswith("2 scans of one surface: place_0.csv, place_1.csv.")
    numbers = json.loads(call(capsys, "surface", *names, "--json").out)
    assert len(numbers["scans"]) == 2 and numbers["beta_low_95"] < numbers["beta"] < numbers["beta_high_95"]
    assert re.search(rf"beta by Persson's theory +{numbers['beta']:.4g} ", words.out)
    assert tomllib.loads((tmp_path / "s.toml").read_text())["surface"]["beta_error"].endswith("%")
    assert (tmp_path / "s.png").read_bytes()[:4] == b"\x89PNG"


def test_what_cannot_be_combined_is_refused(subtests):
    line = place(5, points=(512,))
    other = analyse(synthetic_topography(TRUTH, (64, 64), STEP, 6), gamma=0.4)
    for surfaces, words in (
        ([], "two or more"),
        ([place(0)], "1 surface"),
        ("scan.csv", "two or more"),
        ([place(0), place(0).topography], "two or more"),
        ([place(0), place(1), place(0)], "place 0 and place 0 have the same heights"),
        ([place(0), line], "is a profile and place 0 a map"),
        ([place(0), other], "gamma is 0.4"),
    ):
        with subtests.test(words=words), pytest.raises(sb.InputError, match=words):
            combine(surfaces)


def test_the_picture_has_each_scan_the_mean_and_the_law(surface):
    spectrum, law = surface.plot().axes[:2]
    drawn = [line for line in spectrum.lines if np.size(line.get_xdata()) == surface.measured.wavenumber.size]
    for each in surface.surfaces:
        expected = each.measured.density[each.measured.reliable]
        assert any(np.array_equal(line.get_ydata(), expected) for line in drawn)
    assert any(np.array_equal(line.get_ydata(), surface.measured.density) for line in drawn)
    assert law.get_xlabel().startswith("mean separation")
