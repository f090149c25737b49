"""A rubber's complex modulus over the frequency becomes a Prony series with its error, or is refused in words."""

import numpy as np
import pytest
from command_line import EXAMPLES, call

import stribeck as sb

OMEGA = np.geomspace(1.0, 1e5, 31)
TRUE = {1e-4: 2.0, 1e-2: 1.0}  # relaxation times and moduli over the relaxed one
RELAXED = 1.5e6


def moduli(omega=OMEGA, terms=TRUE):
    x = {time: omega * time for time in terms}
    storage = RELAXED * (1 + sum(g * x[time] ** 2 / (1 + x[time] ** 2) for time, g in terms.items()))
    return storage, RELAXED * sum(g * x[time] / (1 + x[time] ** 2) for time, g in terms.items())


def broad(omega, scatter=0.0, seed=1):
    """Return the moduli of a rubber whose relaxation covers many decades."""
    x = (1j * omega * 1e-4) ** 0.5
    modulus = 2e6 + 1e8 * x / (1 + x)
    noise = np.exp(scatter * np.random.default_rng(seed).standard_normal((2, omega.size)))
    return modulus.real * noise[0], modulus.imag * noise[1]


def write(path, header="frequency [Hz];E' [MPa];E'' [MPa]", omega=OMEGA, factor=2 * np.pi):
    rows = zip(omega / factor, *(each / 1e6 for each in moduli(omega)), strict=True)
    path.write_text("\n".join([header, *(";".join(f"{value:.9g}" for value in row) for row in rows)]) + "\n")
    return path


def test_a_series_is_found_again_with_its_times_and_moduli():
    found = sb.solids.fit_prony(OMEGA, *moduli())
    assert found.solid.relaxation_times == pytest.approx((1e-4, 1e-2), rel=1e-9, abs=0)
    assert found.solid.moduli == pytest.approx((2.0, 1.0), rel=1e-6, abs=0)
    assert found.relaxed_modulus == pytest.approx(RELAXED, rel=1e-6, abs=0) and found.misfit < 1e-6
    assert found.modulus == pytest.approx(RELAXED / 0.75, rel=1e-6, abs=0)


def test_the_stated_misfit_is_that_of_the_values_and_of_what_lies_between(subtests):
    for scatter in (0.0, 0.03):
        with subtests.test(scatter=scatter):
            omega = np.geomspace(1e-2, 1e6, 49)
            measured = broad(omega, scatter)
            found = sb.solids.fit_prony(omega, *measured)
            deviation = np.array(found.at(omega)) / np.array(measured) - 1
            assert found.misfit == pytest.approx(np.sqrt(np.mean(deviation**2)), rel=1e-9, abs=0)
            assert found.largest_misfit == pytest.approx(np.abs(deviation).max(), rel=1e-9, abs=0)
            between = np.sqrt(omega[1:] * omega[:-1])
            assert np.sqrt(np.mean((np.array(found.at(between)) / np.array(broad(between)) - 1) ** 2)) < max(2 * scatter, 0.01)


def test_a_solved_contact_takes_the_series():
    contact = sb.load_case(EXAMPLES / "pdms_cylinder.toml").contact
    found = sb.solids.fit_prony(OMEGA, *moduli())
    body = sb.solids.Prony([1e-4, 1e-2], [2.0, 1.0])
    contact = contact.replace(modulus=RELAXED / 0.75)
    friction = [sb.solve(contact.replace(solid=solid)).hysteresis_friction for solid in (found.solid, body)]
    assert friction[0] == pytest.approx(friction[1], rel=1e-5, abs=0) and friction[0] > 1e-3


def test_files_have_hertz_or_radians_and_any_unit_of_modulus(subtests, tmp_path):
    for header, factor in (
        ("frequency [Hz];E' [MPa];E'' [MPa]", 2 * np.pi),
        ("Angular frequency (rad/s);Storage modulus (MPa);Loss modulus (MPa)", 1.0),
        ("omega [1/s];E' [MPa];E'' [MPa]", 1.0),
    ):
        with subtests.test(header=header):
            found = sb.solids.from_master_curve(write(tmp_path / "a.csv", header, factor=factor))
            assert found.solid.relaxation_times == pytest.approx((1e-4, 1e-2), rel=1e-6, abs=0)
            assert found.relaxed_modulus == pytest.approx(RELAXED, rel=1e-4, abs=0)


def test_moduli_of_shear_become_those_of_tension_and_a_header_that_does_not_say_which_draws_a_note(subtests, tmp_path):
    assumed, turned = "taken for those of tension", "multiplied by 2 (1 + nu)"
    for storage, loss, factor, said in (
        ("G'", "G''", 2.6, turned),
        ("Storage modulus G'", "Loss modulus G''", 2.6, turned),
        ("Storage modulus (G')", "Loss modulus (G″)", 2.6, turned),
        ("Shear storage modulus", "Shear loss modulus", 2.6, turned),
        ("Storage modulus, shear", "Loss modulus, shear", 2.6, turned),
        ("Speichermodul G'", "Verlustmodul G''", 2.6, turned),
        ("Schubspeichermodul", "Schubverlustmodul", 2.6, turned),
        ("Speichermodul E'", "Verlustmodul E''", 1.0, ""),
        ("Tensile storage modulus", "Young's loss modulus", 1.0, ""),
        ("E_storage", "E_loss", 1.0, ""),
        ("Storage modulus", "Loss modulus", 1.0, assumed),
        ("E'", "Loss modulus", 1.0, ""),
        ("Storage modulus", "G''", 2.6, turned),
    ):
        with subtests.test(storage=storage, loss=loss):
            path = write(tmp_path / "a.csv", f"frequency [Hz];{storage} [MPa];{loss} [MPa]")
            found = sb.solids.from_master_curve(path, poisson_ratio=0.3)
            assert found.relaxed_modulus == pytest.approx(factor * RELAXED, rel=1e-4, abs=0)
            assert [note for note in found.notes if assumed in note or turned in note] == (
                [note for note in found.notes if said in note] if said else []
            )
            assert not said or any(said in note for note in found.notes)
    with pytest.raises(sb.InputError, match="is a modulus of tension and .* one of shear; keep two of the same"):
        sb.solids.from_master_curve(write(tmp_path / "b.csv", "frequency [Hz];E' [MPa];G'' [MPa]"))


def test_a_line_above_says_of_what_deformation_the_moduli_are(subtests, tmp_path):
    for line, factor, said in (
        ("Mode: shear", 2.6, "by row 1, were multiplied by"),
        ("# Geometry: parallel plate 25 mm", 2.6, "by row 1, were multiplied by"),
        ("Beanspruchung;Scherung;", 2.6, "by row 1, were multiplied by"),
        ("Clamp;Tension: film;", 1.0, ""),
        ("Modus: Dual Cantilever", 1.0, ""),
        ("Pretension: none", 1.0, "taken for those of tension"),
        ("Shear or tension", 1.0, "taken for those of tension"),
    ):
        with subtests.test(line=line):
            path = write(tmp_path / "a.csv", f"{line}\nfrequency [Hz];Storage modulus [MPa];Loss modulus [MPa]")
            found = sb.solids.from_master_curve(path, poisson_ratio=0.3)
            assert found.relaxed_modulus == pytest.approx(factor * RELAXED, rel=1e-4, abs=0)
            assert [said in note for note in found.notes if "tension" in note] == [True] * bool(said)
    path = write(tmp_path / "b.csv", "Mode: shear\nfrequency [Hz];E' [MPa];E'' [MPa]")
    assert sb.solids.from_master_curve(path).relaxed_modulus == pytest.approx(RELAXED, rel=1e-4, abs=0)


def test_a_loss_tangent_and_a_reduced_frequency_stand_for_what_they_are_made_of(subtests, tmp_path):
    storage, loss = moduli()
    for names in (
        "Reduced frequency [Hz];E' [MPa];tan delta",
        "Reduced frequency (aT·f) [Hz];Storage modulus (MPa);Tan(δ)",
        "Red. frequency aT*f [Hz];E' [MPa];Loss factor [-]",
        "aT f [Hz];E' [MPa];tan(delta) [1]",
        "a_T*f [Hz];E' [MPa];tan δ",
        "Frequenz reduziert [Hz];Speichermodul [MPa];Verlustfaktor [-]",
    ):
        with subtests.test(names=names):
            rows = zip(OMEGA / (2 * np.pi), storage / 1e6, loss / storage, strict=True)
            lines = [names + ";Frequency [Hz]", *(";".join(f"{value:.9g}" for value in (*row, 1)) for row in rows)]
            (tmp_path / "a.csv").write_text("\n".join(lines))
            found = sb.solids.from_master_curve(tmp_path / "a.csv")
            assert found.loss == pytest.approx(loss, rel=1e-6) and found.frequency == pytest.approx(OMEGA, rel=1e-6)
            assert "The loss modulus is the storage modulus times the loss tangent." in found.notes
    for name in ("E'' [MPa]", "Verlustmodul [MPa]"):
        text = write(tmp_path / "b.csv", f"omega [s^-1];E' [MPa];{name}", factor=1.0).read_text()
        (tmp_path / "b.csv").write_text(
            "\n".join(f"{line};{k and 9 or 'tan delta'}" for k, line in enumerate(text.splitlines()))
        )
        found = sb.solids.from_master_curve(tmp_path / "b.csv")
        assert found.loss == pytest.approx(loss, rel=1e-6)


def test_quantities_over_their_units_and_two_columns_of_the_frequency_are_read(subtests, tmp_path):
    for header, more in (
        ("f/Hz;E'/MPa;E''/MPa", ""),
        ("Frequency/Hz;Storage modulus/MPa;Loss modulus/MPa", ""),
        ("Frequency [Hz];E' [MPa];E'' [MPa];Angular frequency [rad/s]", "9"),
        ("aT f [Hz];E' [MPa];E'' [MPa];aT omega [rad/s];omega [rad/s]", "9;8"),
    ):
        with subtests.test(header=header):
            first, *lines = write(tmp_path / "a.csv", header).read_text().splitlines()
            omega = [f"{float(line.split(';')[0]) * 2 * np.pi:.9g}" for line in lines]
            tails = [f";{w}{more[1:]}" if more else "" for w in omega]
            (tmp_path / "a.csv").write_text("\n".join([first, *(a + b for a, b in zip(lines, tails, strict=True))]))
            found = sb.solids.from_master_curve(tmp_path / "a.csv")
            assert found.frequency == pytest.approx(OMEGA, rel=1e-6)
            assert found.relaxed_modulus == pytest.approx(RELAXED, rel=1e-4, abs=0)
    for unit in ("rpm", "furl"):
        with pytest.raises(sb.InputError, match=r"b\.csv: column .* unit"):
            sb.solids.from_master_curve(write(tmp_path / "b.csv", f"frequency [Hz];E' [{unit}];E'' [MPa]"))


def test_a_frequency_per_second_says_that_it_was_taken_for_the_angular_one(tmp_path):
    for unit, factor in (("1/s", 1.0), ("rad/s", 1.0), ("Hz", 2 * np.pi)):
        path = write(tmp_path / "a.csv", f"Frequency [{unit}];E' [MPa];E'' [MPa]", factor=factor)
        found = sb.solids.from_master_curve(path)
        assert found.frequency == pytest.approx(OMEGA)
        assert any("taken for the angular one" in note for note in found.notes) == (unit == "1/s")


def test_moduli_at_several_temperatures_are_no_curve_before_they_are_shifted(tmp_path):
    head, *rows = write(tmp_path / "a.csv").read_text().splitlines()
    for name, step in (("Temperature [°C]", 20), ("T [K]", 20), ("Temp.", 20), ("temperature [°C]", 0.01)):
        for frequency in (head, f"reduced {head}"):
            lines = [f"{frequency};{name}", *(f"{row};{25 + step * (k % 3)}" for k, row in enumerate(rows))]
            (tmp_path / "b.csv").write_text("\n".join(lines))
            if step > 1 and frequency == head:
                with pytest.raises(sb.InputError, match=r"b\.csv: .* goes from 25 to 65, .*'reduced frequency"):
                    sb.solids.from_master_curve(tmp_path / "b.csv")
            else:
                assert sb.solids.from_master_curve(tmp_path / "b.csv").relaxed_modulus == pytest.approx(RELAXED, rel=1e-4)


def test_several_tables_of_moduli_are_said_to_count_as_of_one_temperature(tmp_path):
    one = write(tmp_path / "a.csv").read_text()
    for tables in (1, 3):
        (tmp_path / "b.csv").write_text("\n".join(f"Temperature: {20 + 10 * k} °C\n{one}" for k in range(tables)))
        found = sb.solids.from_master_curve(tmp_path / "b.csv")
        assert any("keep the table of one temperature" in note for note in found.notes) == (tables > 1)


def test_a_case_names_the_file_and_says_how_well_it_was_followed(capsys, tmp_path):
    write(tmp_path / "rubber.csv")
    text = (
        '[contact]\nradius = "10 mm"\nload = "30 N/m"\nviscosity = "50 mPa*s"\nspeed = "1 mm/s"\nroughness = "1 um"\n'
        'alpha = 2.0\nbeta = 0.06\nboundary_friction = 0.5\n[solid]\nmaster_curve = "rubber.csv"\n'
    )
    (tmp_path / "case.toml").write_text(text)
    case = sb.load_case(tmp_path / "case.toml")
    assert case.contact.modulus == pytest.approx(RELAXED / 0.75, rel=1e-4, abs=0)
    assert case.contact.solid.moduli == pytest.approx((2.0, 1.0), rel=1e-3, abs=0)
    said = call(capsys, "solve", tmp_path / "case.toml", "-v").out
    assert "Prony series of 2 terms" in said and "modulus = 2 MPa" in said
    (tmp_path / "own.toml").write_text(text.replace("[contact]", '[contact]\nmodulus = "3 MPa"'))
    assert sb.load_case(tmp_path / "own.toml").contact.modulus == 3e6
    (tmp_path / "layer.toml").write_text(text + 'layer_thickness = "2 mm"\n')
    assert sb.load_case(tmp_path / "layer.toml").contact.layer_thickness == 2e-3
    (tmp_path / "both.toml").write_text(text + "moduli = [1.0]\n")
    with pytest.raises(sb.InputError, match="master_curve and moduli are two descriptions"):
        sb.load_case(tmp_path / "both.toml")


def test_a_curve_without_a_plateau_says_so():
    found = sb.solids.fit_prony(np.geomspace(1e4, 1e6, 20), *broad(np.geomspace(1e4, 1e6, 20)))
    assert any("has no plateau" in note for note in found.notes)
    assert not any("has no plateau" in note for note in sb.solids.fit_prony(OMEGA, *moduli()).notes)


def test_impossible_curves_are_refused(subtests, tmp_path):
    storage, loss = moduli()
    fluid = OMEGA * 1e-3
    for arguments, words in (
        ((np.log10(OMEGA), storage, loss), "Is it a logarithm"),
        ((OMEGA, storage, -loss), "loss modulus holds -.*, value 1 of 31"),
        ((OMEGA[:4], storage[:4], loss[:4]), "4 different frequencies"),
        ((OMEGA, storage[1:], loss), "shape"),
        (("a", "b", "c"), "not made of real numbers"),
        ((OMEGA, fluid**2 / (1 + fluid**2), fluid / (1 + fluid**2)), "no relaxed modulus"),
    ):
        with subtests.test(words=words), pytest.raises(sb.InputError, match=words):
            sb.solids.fit_prony(*arguments)
    with pytest.raises(sb.InputError, match="no unit"):
        sb.solids.from_master_curve(write(tmp_path / "a.csv", "frequency;E' [MPa];E'' [MPa]"))
    with pytest.raises(sb.InputError, match="none of"):
        sb.solids.from_master_curve(write(tmp_path / "b.csv", "frequency [Hz];x [MPa];y [MPa]"))
    with pytest.raises(sb.InputError, match="Hz, kHz"):
        sb.solids.from_master_curve(write(tmp_path / "c.csv", "frequency [rpm];E' [MPa];E'' [MPa]"))
    with pytest.raises(sb.InputError, match="poisson_ratio"):
        sb.solids.fit_prony(OMEGA, storage, loss, poisson_ratio=0.7)
    text = write(tmp_path / "d.csv").read_text()
    (tmp_path / "d.csv").write_text(f"A rubber\n{text}1;2;-3\n")
    with pytest.raises(sb.InputError, match="d.csv: loss modulus holds -3e\\+06, row 34; all values must be"):
        sb.solids.from_master_curve(tmp_path / "d.csv")


def test_a_series_shows_its_terms_and_its_dataset_has_the_measured_values_beside_it():
    found = sb.solids.fit_prony(OMEGA, *moduli())
    text = str(found)
    for said in ("2 terms through 31 frequencies from 1 to 1e+05 rad/s", "1.5 MPa; effective 2 MPa with Poisson's ratio 0.5"):
        assert said in text
    rows = [line.split() for line in text.splitlines()]
    assert ["100", "µs", "3", "MPa", "2"] in rows and ["10", "ms", "1.5", "MPa", "1"] in rows
    kept = found.to_dataset()
    for name, values in zip(("storage", "loss"), moduli(), strict=True):
        assert kept[name].values == pytest.approx(values, rel=1e-12) and kept[f"fitted_{name}"].values == pytest.approx(
            values, rel=1e-6
        )
    assert kept["frequency"].values == pytest.approx(OMEGA) and float(kept["relaxed_modulus"]) == found.relaxed_modulus
    assert found.inputs == {"modulus": found.modulus, "solid": found.solid}
    rng = np.random.default_rng(2)
    scattered = [each * np.exp(rng.standard_normal(8)) for each in moduli(OMEGA[::4])]
    assert any("No series follows these values within" in note for note in sb.solids.fit_prony(OMEGA[::4], *scattered).notes)
