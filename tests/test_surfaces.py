"""From heights to a contact law: the spectrum's identities, known spectra recovered within their errors, bodies taken away.

Also what a scan is not: isotropic, Gaussian, of a size that instruments measure; and that chance is taken for none of it.
"""

import json
import math
import re
import tomllib
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from command_line import call

import stribeck as sb
from stribeck.surfaces import (
    SelfAffine,
    Spectrum,
    Topography,
    analyse,
    detrended,
    exponential_limit,
    fit_self_affine,
    power_spectrum,
    synthetic_topography,
)

STEP = 1e-6
FUNDAMENTAL = 2 * math.pi / 128e-6
ROLLED = SelfAffine(1e-6, FUNDAMENTAL / 2, 3e6, 0.8, 7 * FUNDAMENTAL)


@cache
def fitted(surface, points, seed, **options):
    flat, _ = detrended(synthetic_topography(surface, points, STEP, seed, **options))
    return fit_self_affine(power_spectrum(flat))


@cache
def analysed(seed, points=(64, 64)):
    return analyse(synthetic_topography(ROLLED, points, STEP, seed))


# --- the spectrum ---


def test_the_spectrum_of_white_noise_is_its_variance_over_the_band(subtests):
    for window in ["hann", "none"]:
        with subtests.test(window=window):
            z = np.random.default_rng(91).standard_normal((200, 160)) * 1e-7
            spectrum = power_spectrum(Topography(z, (1e-6, 2e-6)), window)
            level = np.average(spectrum.density, weights=spectrum.modes)
            assert level == pytest.approx(1e-14 * 1e-6 * 2e-6 / (2 * math.pi) ** 2, rel=0.03, abs=0)
            line = power_spectrum(Topography(z[:, :100].ravel(), (1e-6,)), window)
            assert np.average(line.density, weights=line.modes) == pytest.approx(1e-14 * 1e-6 / (2 * math.pi), rel=0.04, abs=0)


def test_one_wave_has_all_its_power_in_its_ring():
    x = np.arange(256) * 1e-6
    q = 40 * 2 * math.pi / 256e-6
    z = 1e-7 * np.cos(q * x)[:, None] * np.ones(256)
    spectrum = power_spectrum(Topography(z, (1e-6, 1e-6)), "none")
    ring = int(np.argmax(spectrum.density))
    assert spectrum.inner[ring].min() <= q <= spectrum.inner[ring].max() * 1.05
    cell = (2 * math.pi / 256e-6) ** 2
    assert spectrum.density[ring] * 2 * spectrum.modes[ring] * cell == pytest.approx(0.5e-14, rel=1e-9, abs=0)
    assert spectrum.mean_square == pytest.approx(0.5e-14, rel=1e-12, abs=0)


def test_the_spectrum_along_a_line_is_the_integral_across_it():
    wide = replace(fitted(ROLLED, (64, 64), 1), roughness=SelfAffine(1e-6, 1e4, 1e13, 0.2, 3e4))
    k = np.geomspace(1e-2, 1e12, 400_001)
    for q in (3e3, 2e4, 1e5):
        across = np.trapezoid(k * wide.at(np.hypot(q, k), noise=False), np.log(k))
        assert wide.at(q, is_line=True, noise=False) == pytest.approx(2 * across, rel=1e-5, abs=0)


def test_reliable_wavelengths_end_at_the_scan_and_at_the_instrument():
    surface = synthetic_topography(ROLLED, (128, 128), STEP, 93)
    by_grid, by_tip = power_spectrum(surface), power_spectrum(surface, resolution=10e-6)
    assert 2 * math.pi / by_grid.lowest == pytest.approx(128e-6 / 2.5)
    assert 2 * math.pi / by_grid.highest == pytest.approx(4e-6)
    assert 2 * math.pi / by_tip.highest == pytest.approx(10e-6)
    assert by_tip.highest_reason == "resolution of the instrument"
    with pytest.raises(sb.InputError, match="too few for a spectrum"):
        power_spectrum(surface, resolution=50e-6)


# --- the fit ---


def scores(surface, points, seeds, names):
    fits = [fitted(surface, points, seed) for seed in seeds]
    found = [fit for fit in fits if "roll_off" in fit.found]
    assert len(found) >= 0.9 * len(fits)

    def truth(name, fit):  # the height is that of waves that the scan resolves
        whole = surface.spectrum.between(surface.q0, fit.roughness.q1).rms_height
        return whole if name == "h_rms" else getattr(surface, name)

    return np.array(
        [[(getattr(fit.roughness, name) - truth(name, fit)) / fit.errors[name] for name in names] for fit in found]
    )


def test_known_spectra_are_recovered_within_their_errors(subtests):
    for points in [(128, 128), (1024,)]:
        with subtests.test(points=points):
            surface = ROLLED if len(points) == 2 else SelfAffine(1e-6, FUNDAMENTAL / 32, 3e6, 0.8, 3 * FUNDAMENTAL)
            z = scores(surface, points, range(400, 404), ("h_rms", "hurst", "roll_off"))
            assert np.all(np.abs(z.mean(axis=0)) < 0.9)
            assert np.all((np.abs(z) < 2).mean(axis=0) >= 0.75)


@pytest.mark.slow
def test_the_errors_of_a_fit_cover_as_they_say():
    z = scores(ROLLED, (128, 128), range(1000, 1200), ("h_rms", "hurst", "roll_off"))
    within = (np.abs(z) < 1).mean(axis=0), (np.abs(z) < 2).mean(axis=0)
    assert np.all(within[0] > 0.6) and np.all(within[1] > 0.92)
    assert np.all(np.abs(z.mean(axis=0)) < 0.5)


def test_sharp_cut_offs_inside_the_scan_are_found():
    surface = SelfAffine(1e-6, 4 * FUNDAMENTAL, 20 * FUNDAMENTAL, 0.8)
    fit = fitted(surface, (256, 256), 1)
    assert {"q0", "q1"} <= set(fit.found)
    for name in ("h_rms", "q0", "q1"):
        assert abs(getattr(fit.roughness, name) - getattr(surface, name)) < 3 * fit.errors[name]


def test_a_plateau_that_ends_inside_the_scan_is_found_whole():
    """Its cut-off was taken to lie where the power law begins, at twice to three times the wave number."""
    surface = SelfAffine(1e-6, 5 * FUNDAMENTAL, 1.5e6, 0.8, 20 * FUNDAMENTAL)
    for fit in [fitted(surface, (128, 128), seed) for seed in (0, 1, 3)]:
        assert {"q0", "roll_off"} <= set(fit.found)
        height = surface.spectrum.between(surface.q0, fit.roughness.q1).rms_height
        assert abs(fit.roughness.h_rms - height) < 3 * fit.errors["h_rms"]
        for name in ("q0", "roll_off"):
            assert abs(getattr(fit.roughness, name) - getattr(surface, name)) < 3 * fit.errors[name]


def test_a_power_law_without_end_is_not_given_a_roll_off():
    fits = [fitted(SelfAffine(1e-6, FUNDAMENTAL / 4, 3e6, 0.6), (128, 128), seed) for seed in range(4)]
    assert sum("roll_off" in fit.found for fit in fits) <= 1
    assert all("q0" not in fit.found and "q1" not in fit.found for fit in fits)


def test_noise_of_the_instrument_is_taken_for_noise():
    clean = synthetic_topography(ROLLED, (128, 128), STEP, 95)
    noise = np.random.default_rng(96).standard_normal((128, 128)) * 5e-7
    fit = fit_self_affine(power_spectrum(Topography(clean.heights + noise, clean.spacing)))
    assert "noise" in fit.found
    # What lies beyond the grid folds back and looks like noise too.
    assert 0.8 < fit.noise / (25e-14 * STEP**2 / (2 * math.pi) ** 2) < 1.4
    assert abs(fit.roughness.hurst - 0.8) < 3 * fit.errors["hurst"]


def test_intervals_of_alpha_and_beta_follow_from_those_of_the_fit():
    fits = [fitted(ROLLED, (128, 128), seed) for seed in range(400, 404)]
    truth = exponential_limit(ROLLED.spectrum.between(ROLLED.q0, math.pi / (2 * STEP)))
    for i, width in ((0, 0.25), (1, 1.2)):
        found = [fit.exponential_limit()[i] for fit in fits]
        assert all(each.low < truth[i] < each.high for each in found)
        assert all(each.low < each.value < each.high and each.high - each.low < width * truth[i] for each in found)


def test_intervals_of_alpha_and_beta_hold_for_any_longest_wave_beyond_the_scan(subtests):
    for longest in [1.0, 0.05]:
        with subtests.test(longest=longest):
            surface = SelfAffine(1e-6, longest * FUNDAMENTAL, 3e6, 0.8, 7 * FUNDAMENTAL)
            inside = []
            for seed in range(520, 524):
                fit = fitted(surface, (128, 128), seed)
                truth = exponential_limit(surface.spectrum.between(surface.q0, fit.roughness.q1))
                inside += [each.low < true < each.high for each, true in zip(fit.exponential_limit(), truth, strict=True)]
            assert sum(inside) >= 7


def test_intervals_of_alpha_and_beta_hold_where_the_longest_wave_is_in_the_scan_and_hardly_shows(subtests):
    for points, longest, roll_off in (((128, 128), 4, 8), ((1024,), 4, 16), ((1024,), 8, 16)):
        with subtests.test(points=points, longest=longest):
            wave = 2 * math.pi / (points[0] * STEP)
            surface = SelfAffine(1e-6, longest * wave, 3e6, 0.8, roll_off * wave)
            limits = [fitted(surface, points, seed).exponential_limit() for seed in (541, 543)]
            truth = exponential_limit(surface)
            assert all(each.low < true < each.high for found in limits for each, true in zip(found, truth, strict=True))


def test_intervals_of_alpha_and_beta_allow_for_waves_shorter_than_the_scan_shows():
    """An octave below the reliable range, and all waves down to 2 nm: the scan cannot tell them apart."""
    surface = SelfAffine(1e-6, FUNDAMENTAL, math.pi / STEP, 0.8, 7 * FUNDAMENTAL)
    endless = SelfAffine(surface.h_rms, surface.q0, math.pi / 1e-9, surface.hurst, surface.roll_off)
    truths = [exponential_limit(surface), exponential_limit(endless)]
    assert truths[1][1] > 1.05 * truths[0][1]
    limits = [fitted(surface, (96, 96), seed).exponential_limit() for seed in range(530, 534)]
    inside = [
        each.low < true < each.high for found in limits for truth in truths for each, true in zip(found, truth, strict=True)
    ]
    assert sum(inside) >= len(inside) - 1
    found = analyse(synthetic_topography(surface, (96, 96), STEP, 530))
    [said] = [note for note in found.notes if "goes on beyond" in note]
    r, shortest = found.roughness, 2 * math.pi / 1e-9
    level = r.spectrum.density[0]
    whole = Spectrum([r.q0, r.roll_off, shortest], [level, level, level * (shortest / r.roll_off) ** (-2 * (1 + r.hurst))])
    height, beta = (float(each) / 100 for each in re.findall(r"rises by ([\d.]+) %.* and beta by ([\d.]+) %", said)[0])
    assert height == pytest.approx(whole.rms_height / r.h_rms - 1, rel=0.06, abs=0)
    assert beta == pytest.approx(exponential_limit(whole)[1] / found.law.beta - 1, rel=0.06, abs=0)


def test_without_a_roll_off_beta_is_bounded_from_above_only():
    surface = SelfAffine(1e-6, FUNDAMENTAL / 4, 3e6, 0.8)
    fit = fitted(surface, (128, 128), 0)
    assert "roll_off" not in fit.found
    alpha, beta = fit.exponential_limit()
    truth = exponential_limit(surface.spectrum.between(surface.q0, fit.roughness.q1))
    assert alpha.low < truth[0] < alpha.high < 1.5 * alpha.low
    assert beta.low == 0 and truth[1] < beta.high and beta.interval.startswith("at most ")
    scan = analyse(synthetic_topography(surface, (128, 128), STEP, 0))
    assert "roll-off wavelength" not in str(scan) and scan.to_dict()["roll_off"] is None


def test_what_is_not_self_affine_is_said_to_be_so():
    noise = np.random.default_rng(105).standard_normal((64, 64)) * 1e-7
    with pytest.raises(sb.InputError, match="only white noise"):
        analyse(Topography(noise, (STEP, STEP)))
    wave = analyse(Topography(1e-6 * np.sin(np.arange(192) / 5) + 1e-2 * noise.ravel()[:192], (STEP,)))
    assert any("The spectrum is not self-affine" in note for note in wave.notes)
    assert any("steeper than that of self-affine" in note for note in wave.notes)
    assert not any("self-affine" in note for note in analysed(97).notes)


# --- the body ---


def on_cylinder(surface, radius, angle=0.0, tilt=0.0):
    x, y = (np.arange(n) * STEP for n in surface.heights.shape)
    across = (x[:, None] - x.mean()) * math.cos(angle) + (y - y.mean()) * math.sin(angle)
    return Topography(surface.heights - across**2 / (2 * radius) + tilt * x[:, None], surface.spacing)


def test_the_radius_of_the_cylinder_comes_out_within_its_error():
    scores, thin = [], ROLLED.scaled(1e-7)
    for seed in range(5):
        rough = synthetic_topography(thin, (128, 128), STEP, 700 + seed)
        flat, shape = detrended(on_cylinder(rough, 2e-3, angle=0.5, tilt=0.03))
        scores.append((shape.radius - 2e-3) / shape.radius_error(thin, flat))
        assert shape.curvatures[0] < 0
        assert abs(shape.direction - 0.5) < 0.2
        assert shape.tilt[0] == pytest.approx(0.03, abs=3e-3)
    assert np.mean(np.abs(scores) < 2) >= 0.8
    assert 0.5 < np.std(scores) < 1.6


def test_a_tilted_scan_has_the_roughness_of_a_level_one():
    found, level = analysed(97), synthetic_topography(ROLLED, (64, 64), STEP, 97)
    tilted = on_cylinder(level, math.inf, tilt=0.2)
    assert analyse(tilted).roughness.h_rms == pytest.approx(found.roughness.h_rms, rel=1e-6, abs=0)
    curved = analyse(on_cylinder(level, 1e-3, angle=1.0))
    assert curved.roughness.hurst == pytest.approx(found.roughness.hurst, rel=1e-5, abs=0)
    assert found.notes[-1].endswith("the surface is flat.")


def test_a_profile_across_the_cylinder_gives_its_radius():
    line = synthetic_topography(SelfAffine(1e-7, 1e3, 3e6, 0.8, 1e5), (1024,), STEP, 98)
    x = (np.arange(1024) - 511.5) * STEP
    surface = analyse(Topography(line.heights + x**2 / (2 * 5e-3), line.spacing))
    error = surface.shape.radius_error(surface.roughness, surface.topography)
    assert abs(surface.shape.radius - 5e-3) < 3 * error < 1e-4
    assert surface.shape.curvatures[0] > 0


def test_dead_points_change_the_roughness_by_less_than_its_error():
    whole = synthetic_topography(ROLLED, (128, 128), STEP, 99)
    z = whole.heights.copy()
    dead = np.random.default_rng(100).random(z.shape) < 0.02
    z[dead] = np.nan
    z[64, 70] = 1.0
    fits = [analyse(Topography(heights, whole.spacing)) for heights in (whole.heights, z)]
    for name in ("h_rms", "hurst", "roll_off"):
        values = [getattr(fit.roughness, name) for fit in fits]
        assert abs(values[1] - values[0]) < 0.5 * fits[0].fit.errors[name]
    assert any("without a height" in note for note in fits[1].notes)
    assert any("1 point is a spike" in note for note in fits[1].notes)
    assert fits[1].spikes == 1 and fits[1].height_with_spikes > 1e-3 > 100 * fits[1].rms_height
    assert any("with its spikes and" in note for note in fits[1].notes)
    assert any("changed the rms height by" in note and "--keep-spikes" in note for note in fits[1].notes)
    assert (fits[0].spikes, fits[0].height_with_spikes) == (0, fits[0].rms_height)


def test_a_line_and_the_map_that_it_was_cut_from_agree():
    surface = SelfAffine(1e-6, FUNDAMENTAL / 8, 3e6, 0.8, 7 * FUNDAMENTAL)
    whole = synthetic_topography(surface, (512, 128), STEP, 101)
    of_map = analyse(whole).to_dict()
    of_lines = [analyse(Topography(whole.heights[:, j], (STEP,))).to_dict() for j in (10, 60, 110)]
    units = of_map["units"]
    assert {name for name, value in of_map.items() if isinstance(value, float)} <= set(units)
    assert [units[name] for name in ("h_rms", "size", "q0", "noise_density")] == ["m", "m", "m-1", "m4"]
    for name in ("hurst", "h_rms"):
        mean = np.mean([line[name] for line in of_lines])
        error = math.hypot(of_map[f"{name}_error"], np.mean([line[f"{name}_error"] for line in of_lines]))
        assert abs(mean - of_map[name]) < 2 * error
    for low, high in ((line["beta_low_95"], line["beta_high_95"]) for line in of_lines):
        assert low < of_map["beta"] < high


# --- bad arguments ---


def test_an_impossible_argument_is_refused(subtests):
    for options, words in [
        ({"trend": "cubic"}, "detrend = 'cubic' is not known"),
        ({"window": "kaiser"}, "window = 'kaiser' is not known"),
        ({"gamma": 2.0}, "gamma = 2.0 must be between 0.01 and 1"),
        ({"resolution": "1 kg"}, "a length such as"),
        ({"resolution": 0.0}, "not above zero"),
    ]:
        with subtests.test(options=options, words=words), pytest.raises(sb.InputError, match=words):
            analyse(synthetic_topography(ROLLED, (64, 64), STEP, 1), **options)


def test_an_array_of_heights_with_its_spacing_is_a_scan(subtests):
    scan = synthetic_topography(ROLLED, (64, 64), STEP, 1)
    alpha = analysed(1).to_dict()["alpha"]
    for spacing in (f"{1e6 * STEP} um", (STEP, STEP)):
        assert analyse(scan.heights, spacing=spacing).to_dict()["alpha"] == alpha
    assert Topography(scan.heights, STEP).size == pytest.approx(scan.size)
    for made, words in [
        (lambda: analyse(scan.heights), "spacing is missing"),
        (lambda: analyse("scan.csv"), "read_topography"),
        (lambda: analyse(scan, spacing=1e-6), "leave spacing out"),
        (lambda: analyse(scan.heights, spacing="5 kg"), "a length"),
        (lambda: analyse(scan.heights, spacing=-1e-6), "spacing = "),
        (lambda: analyse(scan.heights, spacing=(1e-6, 1e-6, 1e-6)), "3 spacings"),
    ]:
        with subtests.test(words=words), pytest.raises(sb.InputError, match=words):
            made()


def test_parameters_of_heights_are_those_of_the_standards():
    x = np.arange(128) * STEP
    wave = 16 * STEP
    sine = np.sin(2 * np.pi * x / wave)
    line = analyse(Topography(1e-6 * sine + 1e-4, STEP), trend="none").to_dict()
    assert line["scan_rms_height"] == pytest.approx(0.5**0.5 * 1e-6, rel=1e-9)
    assert line["mean_deviation"] == pytest.approx(2e-6 / np.pi, rel=0.02)
    assert line["kurtosis"] == pytest.approx(1.5, rel=1e-3)
    assert line["scan_rms_slope"] == pytest.approx(1e-6 * 2 * np.pi / wave / np.sqrt(2), rel=0.02)
    grooves = analyse(Topography(np.tile(1e-6 * sine[:64], (64, 1)), STEP), trend="mean").to_dict()
    assert grooves["scan_rms_slope"] == pytest.approx(line["scan_rms_slope"], rel=0.01)
    for seed in (1, 97):  # of 160 such surfaces the scores scatter by 0.9
        found = analysed(seed).to_dict()
        assert 0 < found["kurtosis_error"] < 0.5 and abs(found["kurtosis"] - 3) < 3 * found["kurtosis_error"]
        assert found["mean_deviation"] / found["scan_rms_height"] == pytest.approx((2 / np.pi) ** 0.5, rel=0.05)


def test_a_plane_has_no_roughness():
    plane = np.arange(64.0)[:, None] + np.zeros(64)
    with pytest.raises(sb.InputError, match="nothing is left after removing the tilt"):
        detrended(Topography(plane, (1.0, 1.0)), "tilt")


# --- the command, the table and the picture ---


@pytest.fixture(scope="module")
def scan(tmp_path_factory):
    path = tmp_path_factory.mktemp("scan") / "scan.csv"
    rough = on_cylinder(synthetic_topography(ROLLED, (96, 64), STEP, 102), 5e-3)
    x, y = np.meshgrid(*(np.arange(n) * 1.0 for n in rough.heights.shape), indexing="ij")
    table = np.stack((x.ravel(), y.ravel(), rough.heights.ravel() * 1e9), axis=1)
    np.savetxt(path, table, fmt="%.6g", delimiter=",", header="x (um),y (um),z (nm)")
    return path


def test_the_command_prints_and_writes_what_analyse_finds(capsys, scan, tmp_path):
    out, plot = tmp_path / "surface.toml", tmp_path / "surface.png"
    words = call(capsys, "surface", scan, "--out", out, "--plot", plot)
    assert words.code == 0, words.err
    numbers = json.loads(call(capsys, "surface", scan, "--json").out)
    found = analyse(sb.surfaces.read_topography(scan))
    expected = found.to_dict()
    assert (
        numbers["alpha"] == expected["alpha"]
        and numbers["beta_low_95"] == expected["beta_low_95"]
        and numbers["hurst_error"] == expected["hurst_error"]
    )
    for text in (
        "radius of the convex body",
        "Hurst exponent",
        "skewness Ssk of the heights",
        "kurtosis Sku",
        "aspect ratio of features",
        "(95 %)",
    ):
        assert text in words.out
    assert re.search(rf"alpha by Persson's theory +{expected['alpha']:.4g} ", words.out)
    table = tomllib.loads(out.read_text())["surface"]
    alpha, beta = found.limits
    assert table.pop("alpha_error") == f"{100 * alpha.relative_error:.2g} %"
    assert beta.low == 0 and beta.relative_error is None and "beta_error" not in table  # it is bounded from above only
    height, _, error = table.pop("h_rms").partition(" +- ")
    assert error == f"{100 * expected['h_rms_error'] / expected['h_rms']:.2g} %"
    again = SelfAffine(height, **{name: value for name, value in table.items() if name != "gamma"})
    assert exponential_limit(again) == pytest.approx((expected["alpha"], expected["beta"]), rel=1e-5, abs=0)
    assert plot.read_bytes()[:4] == b"\x89PNG"
    refused = call(capsys, "surface", scan, "--out", out)
    assert refused.code == 2 and "--force" in refused.err


def test_the_command_refuses_nonsense_in_one_line(subtests, capsys, scan):
    for tokens, words in [
        ((), "FILE is missing"),
        (("none.csv",), "none.csv is not a file"),
        (("SCAN", "--unit", "mm"), "declares its"),
        (("SCAN", "--trend", "cubic"), "detrend = 'cubic'"),
        (("SCAN", "--gamma", "x"), "gamma = 'x' is not a number"),
        (("SCAN", "--out", "a.txt"), "must end in .toml"),
    ]:
        with subtests.test(tokens=tokens, words=words):
            answer = call(capsys, "surface", *(scan if token == "SCAN" else token for token in tokens))
            assert answer.code == 2
            assert words in answer.err and len(answer.err.splitlines()) == 1


def test_the_picture_shows_heights_spectrum_and_law(subtests):
    for points in [(64, 64), (512,)]:
        with subtests.test(points=points):
            surface = analysed(97, points)
            figure = surface.plot(title="A surface")
            heights, spectrum, law = figure.axes[:3]
            assert heights.images or heights.lines
            assert figure.legends[0].get_window_extent().y1 < law.get_window_extent().y0  # over no curve
            fit = next(line for line in spectrum.lines if line.get_label().startswith("fit"))
            q, density = fit.get_data()
            assert density == pytest.approx(surface.fit.at(q, is_line=surface.topography.is_line), rel=1e-9, abs=0)
            persson, exponential = law.lines[:2]
            u, p = persson.get_data()
            expected = surface.law.beta * np.exp(surface.law.log_pressure(surface.law.alpha * u))
            assert p == pytest.approx(expected, rel=1e-9, abs=0)
            assert p[0] > exponential.get_data()[1][0]


def test_jumps_between_the_lines_of_a_map_end_in_an_answer():
    """As of an atomic force microscope: a fit between cut-offs was sought beyond the upper one."""
    for seed in [2, 3]:
        heights = analysed(seed, (80, 80)).topography.heights
        jumps = 1e-5 * np.random.default_rng(seed).standard_normal(80)
        assert any("anisotropic" in note for note in analyse(heights + jumps, spacing=STEP).notes)


def test_a_line_of_any_length_has_a_spectrum(subtests):
    for points in [67, 255]:  # its last ring holds no wave
        with subtests.test(points=points):
            assert power_spectrum(Topography(np.random.default_rng(3).standard_normal(points), (1e-6,))).density.min() > 0


def test_a_steep_line_is_fitted_in_a_bounded_number_of_steps(monkeypatch):
    """Its exponent is at its bound, towards which one of the fits crept for 164 steps."""
    from scipy import optimize

    steps, least_squares = [], optimize.least_squares

    def counted(*arguments, **settings):
        found = least_squares(*arguments, **settings)
        steps.append(found.nfev)
        return found

    monkeypatch.setattr(optimize, "least_squares", counted)
    x, heights = 1e-6 * np.arange(4096), np.random.default_rng(1).normal(size=(3, 4096))[2]
    for _ in range(3):
        heights = np.cumsum(heights)
        heights -= np.polyval(np.polyfit(x, heights, 1), x)
    surface = analyse(Topography(1e-7 * heights / heights.std(), (1e-6,)))
    assert len(steps) == 12
    assert max(steps) <= 60
    assert surface.roughness.hurst > 0.99


# --- what departs from the theory's surface ---


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
