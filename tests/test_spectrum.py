"""Power spectra: moments in closed form, tables checked, shapes that scale."""

import math

import numpy as np
import pytest
from command_line import toml_of
from scipy.integrate import quad

import stribeck as sb
from stribeck.surfaces import SelfAffine, Spectrum, persson_law

SHAPES = [
    SelfAffine(h_rms=1e-6, q0=1e4, q1=1e8, hurst=0.8),
    SelfAffine(h_rms=3e-7, q0=1e4, q1=1e7, hurst=0.5, roll_off=8e4),
    SelfAffine(h_rms=2e-6, q0=5e3, q1=1e6, hurst=1.0, roll_off=6e3),
]


def test_moments_are_the_integrals_of_the_definition(subtests):
    for order in [0, 1, 2, 4]:
        for surface in SHAPES:
            with subtests.test(order=order, surface=surface):
                H, q_r = surface.hurst, surface.roll_off
                ends = [math.log(surface.q0), math.log(q_r), math.log(surface.q1)]

                def density(q):
                    return min(1.0, (q / q_r) ** (-2 * (1 + H)))

                def integral(n):
                    parts = zip(ends[:-1], ends[1:], strict=True)
                    return sum(
                        quad(lambda v: math.exp(v * (n + 1)) * density(math.exp(v)), a, b, epsrel=1e-12)[0] for a, b in parts
                    )

                expected = surface.h_rms**2 * integral(order + 1) / integral(1)
                assert surface.spectrum.moment(order) == pytest.approx(expected, rel=1e-11, abs=0)


def test_height_slope_and_curvature_of_hurst_one():
    # C = A q^-4: h_rms^2 = pi A (q0^-2 - q1^-2), slope^2 = 2 pi A ln(q1/q0), Laplacian^2 = pi A (q1^2 - q0^2).
    spectrum = SelfAffine(h_rms=1.0, q0=1.0, q1=100.0, hurst=1.0).spectrum
    A = 1 / (math.pi * (1 - 1e-4))
    assert spectrum.rms_height == pytest.approx(1.0, rel=1e-14, abs=0)
    assert spectrum.rms_slope == pytest.approx(math.sqrt(2 * math.pi * A * math.log(100)), rel=1e-13, abs=0)
    assert spectrum.rms_curvature == pytest.approx(0.5 * math.sqrt(math.pi * A * (1e4 - 1)), rel=1e-13, abs=0)


def test_a_table_of_a_power_law_has_its_moments():
    surface = SHAPES[1]
    q = np.union1d(np.geomspace(surface.q0, surface.q1, 57), [surface.roll_off])
    table = Spectrum(q, surface.spectrum.at(q))
    assert table.moment(2) == pytest.approx(surface.spectrum.moment(2), rel=1e-11, abs=0)


def test_the_parts_of_a_spectrum_add_up():
    spectrum = SHAPES[1].spectrum
    parts = spectrum.between(1e3, 3e5), spectrum.between(3e5, 1e9)
    assert sum(part.moment(2) for part in parts) == pytest.approx(spectrum.moment(2), rel=1e-12, abs=0)
    assert parts[0].lowest == spectrum.lowest and parts[0].highest == 3e5


def test_the_spectrum_ends_at_its_cut_offs():
    assert SHAPES[0].spectrum.at(np.array([9.9e3, 2e8])).tolist() == [0.0, 0.0]


def test_scaling_keeps_the_shape():
    scaled = SHAPES[1].scaled(5e-6)
    assert scaled.spectrum.rms_height == pytest.approx(5e-6, rel=1e-13, abs=0)
    ratio = scaled.spectrum.density / SHAPES[1].spectrum.density
    assert ratio == pytest.approx((5e-6 / 3e-7) ** 2, rel=1e-12, abs=0)


def test_a_factor_in_place_of_a_height_is_refused(subtests):
    """A surface of 1 µm with waves of up to 628 µm cannot have a roughness of half a metre."""
    rough = SHAPES[0]
    for kind, found in {"self-affine": rough, "spectrum": rough.spectrum, "law": persson_law(rough)}.items():
        with subtests.test(kind=kind):
            with pytest.raises(sb.InputError) as refused:
                found.scaled(0.5)
            assert str(refused.value) == (
                "rms_height = 0.5 would be 500 mm, more than the longest wavelength of the roughness, 628 µm; "
                "give the new rms height in m, such as 1e-6, not a factor."
            )
            assert found.scaled(6.2e-4) is not None
            with pytest.raises(sb.InputError, match="longest wavelength of the roughness, 628 µm"):
                found.scaled(1e-7).scaled(6.3e-4)


def test_a_table_that_is_no_spectrum_is_refused_by_row(subtests):
    for wavenumber, density, words in [
        ([1, 2, 2], [1, 1, 1], "wavenumber in row 3 = 2 is not above the one before it"),
        ([1, 2, 3], [1, 0, 1], "density in row 2 of the spectrum = 0"),
        ([1, 2, 3], [1, np.nan, 1], "gaps"),
        ([1, -2, 3], [1, 1, 1], "wavenumber in row 2"),
        ([1], [1], "fewer than two points"),
        ([1, 2], [1], "2 wave numbers and 1 densities"),
        (["a", "b"], [1, 1], "not a column of numbers"),
        ([[1, 2]], [1, 2], r"shape \(1, 2\)"),
    ]:
        with subtests.test(wavenumber=wavenumber, density=density, words=words):
            with pytest.raises(sb.InputError, match=words):
                Spectrum(wavenumber, density)


def test_an_impossible_self_affine_surface_is_refused(subtests):
    for change, words in [
        ({"hurst": 1.2}, "hurst = 1.2 must be between 0 and 1"),
        ({"hurst": 0.0}, "hurst = 0.0 must be between 0 and 1"),
        ({"q1": 10.0}, "q1 = 10 is not above q0 = 100"),
        ({"roll_off": 50.0}, "roll_off = 50 lies outside"),
        ({"h_rms": -1.0}, "h_rms = -1.0"),
        ({"q0": float("nan")}, "q0 = nan"),
    ]:
        with subtests.test(change=change, words=words), pytest.raises(sb.InputError, match=words):
            SelfAffine(**{"h_rms": 1.0, "q0": 100.0, "q1": 1e4, "hurst": 0.8} | change)


# --- the table [surface] of a case ---


def law_of(folder, **surface):
    """Return Persson's law of a case with these numbers in the table [surface]."""
    contact = dict(radius="10 mm", modulus="2 MPa", load="30 N/m", viscosity="50 mPa*s", speed="1 mm/s", law="persson")
    path = folder / "case.toml"
    path.write_text(toml_of(contact=contact | {"boundary_friction": 0.7}, surface=surface))
    return sb.load_case(path).contact.law


def test_wavelengths_and_wave_numbers_say_the_same(tmp_path):
    lengths = {"longest_wavelength": "100 um", "roll_off_wavelength": "20 um", "shortest_wavelength": "50 nm"}
    by_length = law_of(tmp_path, h_rms="1 um", hurst=0.8, **lengths)
    q0, q1, q_r = (2 * math.pi / length for length in (1e-4, 5e-8, 2e-5))
    by_number = law_of(tmp_path, h_rms=1e-6, hurst=0.8, q0=q0, q1=f"{q1!r} 1/m", roll_off=f"{q_r / 1e6!r} um^-1")
    assert by_length.parameters == pytest.approx(by_number.parameters, rel=1e-12, abs=0)
    numbers = SelfAffine("1 um", f"{q0!r} 1/m", q1, 0.8, q_r)
    assert persson_law(numbers).alpha == pytest.approx(by_number.alpha, rel=1e-12, abs=0)


def test_an_impossible_table_surface_is_refused(subtests, tmp_path):
    for change, words in [
        ({"q0": None}, "q0 .* is missing; give it, or longest_wavelength"),
        ({"q1": None}, "q1 .* is missing; give it, or shortest_wavelength"),
        ({"longest_wavelength": "1 mm"}, "are both given; give either q0, or longest_wavelength"),
    ]:
        with subtests.test(change=change, words=words):
            surface = {"h_rms": "1 um", "hurst": 0.8, "q0": "1e5 1/m", "q1": "1e8 1/m"} | change
            with pytest.raises(sb.InputError, match=words):
                law_of(tmp_path, **{name: value for name, value in surface.items() if value is not None})
