"""Files as rigs, rheometers, digitizers and spreadsheets write them: read without a setting, or refused with true advice.

Their numbers follow one curve, so that what is read is compared with it.
"""

import dataclasses
import io
import itertools
import re
import time
import zipfile
from pathlib import Path

import numpy as np
import pytest
from command_line import fit_settings

import stribeck as sb

DATA = Path(__file__).parent / "data"
SPEEDS = np.array([0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0, 300.0])  # [mm/s]


def curve(speed):
    """Return the friction of the files at a speed in mm/s."""
    return 0.55 / (1 + (speed / 8) ** 0.9) + 0.02 + 0.0006 * speed**0.6


def read(path, geometry="point", **table):
    """Return the measurements in a file, or in one of the data of the tests."""
    path = Path(path)
    return sb.read_measurements(path if path.is_absolute() else DATA / path, fit_settings(table, geometry))


@pytest.fixture
def written(tmp_path):
    """Return a function that writes a file and returns its path."""

    def write(content, name="rig.csv"):
        path = tmp_path / name
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return path

    return write


def assert_on_curve(found, *, sum_over_measured=1.0, rtol=2e-3):
    speeds = 1e3 * found.values / sum_over_measured
    assert np.unique(np.round(np.log10(speeds), 2)).size == 8
    assert speeds.min() == pytest.approx(0.1, rel=0.01) and speeds.max() == pytest.approx(300, rel=0.01)
    assert found.friction == pytest.approx(curve(speeds), rel=rtol)


def refusal(path, **table):
    """Return the sentence with which a file is refused."""
    with pytest.raises(sb.InputError) as caught:
        read(path, **table)
    return str(caught.value)


READ_AS_THEY_ARE = {
    "01_rtec_preamble_trailing_comma.csv": ({"load": 3.0}, 8, 1.0, 2e-3),
    "02_umt_units_row_steps_grams.csv": ({"load": 1.96}, 16, 1.0, 2e-3),
    "04_ball_on_disc_duplicate_and_blank_headers.txt": ({"load": 2.0, "slide_to_roll": 1.0}, 16, 2.0, 2e-3),
    "05_rheometer_utf16_intervals.csv": ({"load": 1.0}, 8, 1.0, 2e-3),
    "06_pin_on_disc_max_linear_speed_nominal_load.txt": ({"load": 2.0}, 48, 1.0, 0.011),  # one part in a hundred of run-out
    "10_header_in_comment.txt": ({}, 8, 1.0, 1e-12),
    "12_three_header_rows.txt": ({}, 8, 1.0, 2e-3),
    "13_plus_minus_cells.csv": ({}, 8, 1.0, 2e-3),
}


def test_a_file_of_a_rig_is_read_without_a_setting(subtests):
    for name in READ_AS_THEY_ARE:
        with subtests.test(name=name):
            inputs, rows, sum_over_measured, rtol = READ_AS_THEY_ARE[name]
            found = read(name)
            assert found.abscissa == "speed" and len(found) == rows
            assert_on_curve(found, sum_over_measured=sum_over_measured, rtol=rtol)
            assert found.inputs == ({key: pytest.approx(value) for key, value in inputs.items()},)


def test_a_row_of_units_stays_when_the_header_comes_again(written):
    name = "02_umt_units_row_steps_grams.csv"
    assert "'V1' as speed" in read(name).taken
    made = read(written((DATA / name).read_text().replace(",COF", ",x")))
    assert made.friction == pytest.approx(read(name).friction, rel=1e-4)  # grams over grams
    assert "friction = |'Fx' / 'Fz'|" in made.taken


def test_the_temperature_of_the_rows_is_said():
    [note] = [note for note in read("04_ball_on_disc_duplicate_and_blank_headers.txt").notes if "Temperature" in note]
    assert note.startswith("Temperature by 'Lube Temp (°C)': 25.1 °C; the viscosity of the case must be that")


def test_the_temperature_is_that_of_the_liquid_and_not_of_its_bath(written):
    text = table("speed [mm/s];COF;Pot Temp [°C];Lube Temp [°C]", speed, friction, lambda u, mu: 45, lambda u, mu: 40)
    assert any(note.startswith("Temperature by 'Lube Temp [°C]': 40 °C") for note in read(written(text)).notes)


def test_units_below_the_names_of_a_tabulated_law_count(written):
    rows = "\n".join(f"{s},{p}" for s, p in [(0.1, 9), (0.5, 6), (1, 4), (2, 2), (3, 1)])
    numbers = {"alpha": 2.0, "beta": 0.05, "roughness": 1e-6, "modulus": 2e6}
    in_header = written(f"gap [um],pressure [kPa]\n{rows}\n", "a.csv")
    below = written(f"gap,pressure\num,kPa\n{rows}\n", "b.csv")
    laws = [sb.contact_laws.TableLaw.read(path, **numbers) for path in (in_header, below)]
    assert dataclasses.replace(laws[1], title=laws[0].title) == laws[0]


def test_the_standard_error_after_a_plus_minus_sign_is_that_of_friction():
    found = read("13_plus_minus_cells.csv")
    assert found.error == pytest.approx(0.05 * found.friction, rel=1e-3)


def test_strokes_to_and_fro_leave_rows_at_rest_out_and_count_them():
    name = "07_reciprocating_stops_and_reversals.txt"
    found = read(name, magnitudes=True)
    speeds = 1e3 * found.values
    assert len(found) == 176 and found.friction == pytest.approx(curve(speeds), rel=2e-3)
    assert found.notes[0].startswith("16 rows at rest left out: 2, 14, 26,")
    sentence = refusal(name)
    assert "zero (static friction) in 16 rows" in sentence and "negative in 88 rows" in sentence
    assert "magnitudes = true in [fit]" in sentence and "repeats = true" in sentence


def test_rows_in_which_friction_has_not_turned_round_are_reversals(written):
    rows = [(1, 0.5), (2, 0.4), (3, 0.3), (-0.1, 0.2), (-1, -0.5), (-2, -0.4), (-3, -0.3), (0.1, -0.2), (0, 0.0)]
    text = "\n".join(["speed [mm/s];mu", *(f"{u};{mu}" for u, mu in rows)])
    found = read(written(text), magnitudes=True)
    assert sorted(found.friction) == pytest.approx([0.3, 0.3, 0.4, 0.4, 0.5, 0.5])
    assert "1 row at rest left out: 10." in found.notes
    assert "2 rows in which friction has not turned round with the speed left out: 5, 9." in found.notes
    unsigned = read(written(text.replace("-", "").replace("0;0.0", "4;0.25")), magnitudes=True)
    assert len(unsigned) == 9  # a rig that writes the size of friction shows no reversals


def test_a_torque_needs_its_arm(written):
    name = "08_torque_instead_of_force.csv"
    sentence = refusal(name)
    assert "'Torque [mN m]' is a torque" in sentence and "'Normal Force [N]'" in sentence and "'load" not in sentence
    found = read(name, arm="6 mm")
    assert_on_curve(found)
    assert found.inputs == ({"load": 1.0},) and "arm 6 mm of the case" in found.taken
    text = (DATA / name).read_text()
    lines = text.splitlines()
    column = "\n".join([lines[0] + ";Arm [cm]", *(line + ";0.6" for line in lines[1:])])
    assert_on_curve(read(written(column)))
    assert_on_curve(read(written("Arm length: 6 mm\n\n" + text)))
    assert_on_curve(read(written(text.replace("mN m", "mNm")), arm="6 mm"))


def test_a_logarithm_is_no_speed(written):
    name = "14_log_speed.csv"
    assert "'log speed [mm/s]' is a logarithm, which is no speed" in refusal(name)
    assert "is a logarithm, which is no speed" in refusal(name, columns={"speed": "log speed"})
    text = (DATA / name).read_text()
    for header in ("log10(speed [mm/s])", "lg velocity (mm/s)", "ln u", "log(speed)", "logSpeed [mm/s]", "logU"):
        assert "is a logarithm" in refusal(written(text.replace("log speed [mm/s]", header)))
    assert "is a logarithm, which is no friction" in refusal(written("speed [mm/s];ln(mu)\n1;-0.5\n2;-1\n"))
    beside = "\n".join(f"{a};{b}" for a, b in zip(["speed [mm/s]", *SPEEDS], text.splitlines(), strict=True))
    assert_on_curve(read(written(beside)))


def test_curves_side_by_side_in_a_workbook_have_their_names_and_errors():
    found = read("15_merged_header.xlsx")
    assert found.curves == ("water", "glycerol")
    for k, factor in enumerate((1.0, 0.9)):
        own = found.curve == k
        assert found.friction[own] == pytest.approx(factor * curve(SPEEDS), rel=1e-12)
        assert found.error[own] == pytest.approx(0.05 * curve(SPEEDS), rel=1e-9)


def test_curves_side_by_side_may_be_called_by_their_loads(written):
    rows = "speed [mm/s];friction;speed [mm/s];friction\n1;0.6;1;0.5\n10;0.3;10;0.2\n100;0.05;100;0.04\n"
    for labels in ["1 N;;2 N;", "1 N;;2 N", "dry;;wet;"]:
        found = read(written(f"{labels}\n{rows}"))
        assert found.curves == tuple(label for label in labels.split(";") if label)
        assert not any("skipped" in note for note in found.notes)


def test_a_load_in_a_line_that_is_not_used_is_named(written):
    rows = "speed [mm/s];friction\n1;0.6\n10;0.3\n100;0.05\n"
    for line, load in [("Load: 0.2 kp", 1.96133), ("Normalkraft: 0,2 kp", 1.96133), ("Load: 2 N", 2.0)]:
        assert read(written(f"{line}\n{rows}")).inputs == ({"load": pytest.approx(load, rel=1e-12)},)
    for what, geometry, unit in [("2", "point", "N"), ("2 N", "line", "N/m"), ("2 kN/m", "point", "N")]:
        found = read(written(f"Load: {what}\n{rows}"), geometry)
        assert found.inputs == ({},) and f"The load {what} of row 1 was not used: it is not in {unit} or alike." in found.notes


def test_pairs_of_columns_of_a_digitizer_are_curves_once_their_meaning_is_said(written):
    name = "11_digitizer_pairs_of_columns.csv"
    assert "as in speed = 'X' and friction = 'Y', and the unit of the speed in [fit.units]" in refusal(name)
    said = {"columns": {"speed": "X", "friction": "Y"}, "units": {"speed": "mm/s"}}
    found = read(name, **said)
    assert found.curves == ("PDMS 10 mPas", "PDMS 50 mPas")
    first, second = found.curve == 0, found.curve == 1
    assert 1e3 * found.values[second] == pytest.approx(1.1 * SPEEDS) and 1e3 * found.values[first] == pytest.approx(SPEEDS)
    assert found.friction[second] == pytest.approx(1.1 * curve(SPEEDS), rel=1e-3)
    text = (DATA / name).read_text().replace("X,Y,X,Y", "speed [mm/s],COF,speed [mm/s],COF")
    assert read(written(text)).curves == found.curves
    shorter = "\n".join(text.splitlines()[:-1]) + "\n,,330,0.064547\n"
    assert len(read(written(shorter))) == 15
    names_alone = (DATA / name).read_text().replace("X,Y,X,Y\n", "")
    assert "as in speed = 'X' and friction = 'Y'" in refusal(written(names_alone))
    assert read(written(names_alone), **said).curves == found.curves
    unnamed = "\n".join(text.splitlines()[1:])
    assert read(written(unnamed)).curves == ("1", "2")


ROWS = list(zip(SPEEDS, curve(SPEEDS), strict=True))


def table(header, *columns, separator=";", rows=ROWS):
    """Return a table whose columns are made of speed in mm/s and friction."""
    lines = [separator.join(f"{column(u, mu):.9g}" for column in columns) for u, mu in rows]
    return "\n".join([header, *lines]) + "\n"


def speed(u, mu):
    return u


def friction(u, mu):
    return mu


PLAIN = table("speed [mm/s];COF", speed, friction)
GERMAN = table("Geschwindigkeit [mm/s];Reibwert", speed, friction).replace(".", ",")

VARIATIONS = {
    "trailing separators everywhere": PLAIN.replace("\n", ";;\n"),
    "cells of two lines in the header": PLAIN.replace("speed [mm/s];COF", '"speed\n[mm/s]";"COF\n[-]"'),
    "no cells for remarks": PLAIN.replace("COF", "COF;Comment"),
    "a dash for no unit": PLAIN.replace("COF", "COF [–]"),
    "no unit in words": PLAIN.replace("COF", "COF (dimensionless)"),
    "trailing separators in the rows": PLAIN.replace("\n", ";;\n").replace("COF;;", "COF"),
    "trailing separators above": "Recipe;Radius;;\na;b;1;2;3\n" + PLAIN.replace("\n", ";\n"),
    "a column without a name": table(";speed [mm/s];COF", lambda u, mu: 7, speed, friction),
    "an empty column": table("speed [mm/s];;COF", speed, friction).replace(";0.", ";;0."),
    "a column twice with other digits": table("COF;speed [mm/s];COF", friction, speed, friction).replace("\n0.3;", "\n0.30;"),
    "a number for each row": table("Sample;speed [mm/s];COF", lambda u, mu: round(2 * np.log10(u) + 3), speed, friction),
    "a column twice": table("COF;speed [mm/s];COF", friction, speed, friction),
    "other columns twice": table("T;speed [mm/s];T;COF", speed, speed, friction, friction),
    "a column called like an input": table("Alpha (°);Radius (s);speed [mm/s];COF", speed, speed, speed, friction),
    "decimal commas of a German export": GERMAN,
    "German words": "Gerät;Tribometer 3\nPrüfer;N.N.\n\n" + GERMAN.replace("Geschwindigkeit", "Gleitgeschwindigkeit"),
    "a unit with an exponent": PLAIN.replace("mm/s", "mm s-1"),
    "a unit with a minus sign": PLAIN.replace("mm/s", "mm s−1"),
    "a unit with a raised exponent": PLAIN.replace("mm/s", "mm·s⁻¹"),
    "a unit without brackets": PLAIN.replace("speed [mm/s]", "Speed, mm/s"),
    "a symbol in brackets": PLAIN.replace("speed [mm/s];COF", "Sliding speed (v) [mm/s];Friction coefficient (µ)"),
    "a header of savetxt": "# " + PLAIN.replace(";", " ").replace("speed [mm/s] COF", "speed [mm/s], COF"),
    "comments above the one that is the header": "# rig 7\n# operator N.N.\n# " + PLAIN,
    "units in a comment": "# " + PLAIN.replace("speed [mm/s];COF", "speed;COF\n# mm/s;-"),
    "units and curves below the names": PLAIN.replace("speed [mm/s];COF", "Speed;Friction\nmm/s;\nPDMS;PDMS on glass"),
    "a footer": PLAIN + "\nTotal time\n00:12:56.57\n",
    "text between steps": PLAIN + "\nStep No. 2\n\n" + PLAIN.partition("\n")[2],
    "a standard deviation of the speed": table("speed [mm/s];SD;COF", speed, lambda u, mu: 0.1 * u, friction),
    "a standard deviation of a force": table("speed [mm/s];COF;SD [N]", speed, friction, lambda u, mu: 3.0),
    "a speed of rotation beside the speed": table("RPM;speed [mm/s];COF", lambda u, mu: 3 * u, speed, friction),
    "two names of one column": table("mu;speed [mm/s];friction", friction, speed, friction),
    "forces in pounds": table("speed [mm/s];Fx [lbf];load [lb]", speed, lambda u, mu: 2 * mu, lambda u, mu: 2),
    "forces in grams": table("speed [mm/s];Fx [g];Fz [g]", speed, lambda u, mu: 200 * mu, lambda u, mu: -200),
    "forces in their own unit": table("speed [mm/s];Fx [mN];Fz [N]", speed, lambda u, mu: 2e3 * mu, lambda u, mu: 2),
    "a prefix of the channel": table("DAQ.Speed (mm/s);DAQ.COF ()", speed, friction),
    "one speed of a surface": table("Disc speed [mm/s];COF", speed, friction),
    "a voltage called V": table("V [V];speed [mm/s];COF", lambda u, mu: 5 + u, speed, friction),
    "a unit behind an underscore": table("speed_mm_s,friction", speed, friction, separator=","),
    "a comment of Matlab": table("% speed [mm/s], friction", speed, friction, separator=","),
    "columns aligned by spaces": table("  Sliding Speed (mm/s)    Friction Coefficient (-)", speed, friction, separator="   "),
    "a line for the separator": "sep=;\n" + PLAIN,
    "an index without a name": table(",speed (mm/s),cof_mean", lambda u, mu: 7, speed, friction, separator=","),
    "pages": table("speed [mm/s];COF", speed, friction, rows=ROWS[:4])
    + "Page 2\n"
    + table("speed [mm/s];COF", speed, friction, rows=ROWS[4:]),
    "a remark with commas and points": table("speed [mm/s];COF;Remark", speed, friction)
    .replace("\n", ";stick-slip, 2.5 N\n")
    .replace("Remark;stick-slip, 2.5 N", "Remark"),
    "a remark with a comma in a number": PLAIN.replace("COF", "COF;Remark")
    .replace("\n", ";2,5 N\n")
    .replace("Remark;2,5 N", "Remark"),
    "a date with a point beside decimal commas": table("T;Geschwindigkeit [mm/s];Reibwert", lambda u, mu: 1, speed, friction)
    .replace(".", ",")
    .replace("\n1;", "\n01.02;"),
    "means of samples": table("Speed mean [mm/s];Speed SD [mm/s];COF mean", speed, lambda u, mu: 0.01 * u, friction),
    "a normal load above": "Normal load;2 N\n\n" + table("Speed [mm/s];Friction force [N]", speed, lambda u, mu: 2 * mu),
    "a stroke in millimetres": table("Stroke (mm);Mean Sliding Speed (m/s);COF", speed, lambda u, mu: u / 1e3, friction),
    "a longer table at one speed": table(
        "Time [s];COF;speed [mm/s]", speed, lambda u, mu: 0.3, lambda u, mu: 50, rows=3 * ROWS
    )
    + PLAIN,
    "letters behind the names": table("Sliding velocity, u (mm/s);Friction coefficient, mu", speed, friction),
    "a letter with an index": table("v_s [mm/s];µ [-]", speed, friction),
    "a set speed beside the measured one": table(
        "Set speed [mm/s];Measured speed [mm/s];COF", lambda u, mu: 1, speed, friction
    ),
    "a Hersey number beside the speed": table("Hersey number;speed [mm/s];COF", lambda u, mu: 7 * u, speed, friction),
    "a shorter table of something else": "stiffness;damping\n3;4\n5;6\n\n" + PLAIN,
}


def test_a_layout_of_another_program_is_read_as_it_is(subtests, written):
    for name in VARIATIONS:
        with subtests.test(name=name):
            found = read(written(VARIATIONS[name]))
            assert found.abscissa == "speed" and found.error is None
            assert set(found.inputs[0]) <= {"load"}
            assert_on_curve(found)
            assert not any("decimal comma" in note for note in found.notes) or "Reibwert" in VARIATIONS[name]


def test_text_of_any_encoding_of_windows_is_read(subtests, written):
    for encoding in ["utf-16", "utf-16-le", "utf-16-be", "utf-8-sig", "cp1252"]:
        with subtests.test(encoding=encoding):
            text = PLAIN.replace("COF", "µ").replace("speed [mm/s]", "speed [µm/s]").replace("\n", "\r\n")
            found = read(written(text.encode(encoding)))
            assert 1e6 * found.values == pytest.approx(SPEEDS)


def test_headers_in_the_codes_of_east_asia_and_of_europe_are_read_as_they_are(subtests, written):
    european = "Größe référence créée"  # pairs that are signs of East Asia in other codes
    for encoding, name in [("cp932", "摩擦係数・ポリマー"), ("gbk", "摩擦系数"), ("cp1252", european)]:
        with subtests.test(encoding=encoding):
            text = PLAIN.replace("COF", name)
            found = read(written(text.encode(encoding)), columns={"friction": name})
            assert_on_curve(found)


ROTATION = {
    "the case": (table("Speed [rpm];COF", speed, friction), {"track_radius": "9 mm"}),
    "RPM in capitals": (table("Rotational speed (RPM);COF", speed, friction), {"track_radius": "9 mm"}),
    "RPM as a name": (table("RPM;COF", speed, friction), {"track_radius": "9 mm"}),
    "German": (table("Drehzahl [U/min];Reibwert", speed, friction), {"track_radius": "9 mm"}),
    "turns per minute": (table("n [1/min];COF", speed, friction), {"track_radius": "9 mm"}),
    "radians": (table("Angular velocity [rad/s];COF", lambda u, mu: u * 2 * np.pi / 60, friction), {"track_radius": "9 mm"}),
    "turns per second": (table("Speed [1/s];COF", lambda u, mu: u / 60, friction), {"track_radius": "9 mm"}),
    "a column": (table("Speed [rpm];Track radius [mm];COF", speed, lambda u, mu: 9, friction), {}),
    "a column of a plainer name": (table("Speed [rpm];Radius [mm];COF", speed, lambda u, mu: 9, friction), {}),
    "a diameter": (table("Speed [rpm];Wear track diameter [mm];COF", speed, lambda u, mu: 18, friction), {}),
    "a line above": ("Track radius [mm];9\n\n" + table("Speed [rpm];COF", speed, friction), {}),
    "a diameter above": ("Track diameter: 1.8 cm\n\n" + table("Speed [rpm];COF", speed, friction), {}),
    "one of several lengths above": (
        "Ball : 6.00 [mm], Radius : 9.00 [mm], Lin. Speed : 10.00 [cm/s]\n\n" + table("Speed [rpm];COF", speed, friction),
        {},
    ),
    "the header": (table("Rotational speed [rpm] (track radius 9 mm);COF", speed, friction), {}),
    "a diameter in the header": (table("Speed (track diameter = 18 mm) [rpm];COF [-] (dry)", speed, friction), {}),
    "a table above": ("Type;Radius (mm)\nRotary;9\n\n" + table("Rotary.Velocity (rpm);COF", speed, friction), {}),
    "a comment above": ("# track radius = 9 mm\n" + table("Speed [rpm];COF", speed, friction), {}),
}


def test_a_rotation_is_a_speed_by_the_radius_of_its_track(subtests, written):
    for name in ROTATION:
        with subtests.test(name=name):
            text, settings = ROTATION[name]
            found = read(written(text), **settings)
            assert found.values == pytest.approx(SPEEDS * 2 * np.pi / 60 * 9e-3, rel=1e-8)
            assert "x the radius of the track" in found.taken
            assert found.inputs == ({},)  # it is not the radius of the ball


def test_an_angular_velocity_per_second_may_be_of_radians_or_turns(subtests, written):
    for unit in ("1/s", "s^-1", "s⁻¹"):
        with subtests.test(unit=unit):
            path = written(table(f"Angular velocity [{unit}];COF", lambda u, mu: u / 20, friction))
            assert "may be in radians or in turns per second" in refusal(path, track_radius="20 mm")
            assert_on_curve(read(path, track_radius="20 mm", units={"rotation": "rad/s"}))
            turns = written(table(f"Rotational speed [{unit}];COF", lambda u, mu: u / 20 / (2 * np.pi), friction))
            assert_on_curve(read(turns, track_radius="20 mm"))
    for unit, size in (("°/s", 180 / np.pi), ("tr/min", 30 / np.pi)):
        path = written(table(f"Angular velocity [{unit}];COF", lambda u, mu, size=size: u / 20 * size, friction))
        assert_on_curve(read(path, track_radius="20 mm"))


def test_a_rotation_without_a_radius_is_refused_by_what_is_missing(written):
    path = written(table("Ball diameter: 12 mm\nSpeed [rpm];COF", speed, friction))
    assert "'Speed [rpm]' is a rotation" in refusal(path) and "track_radius = '20 mm' in [fit]" in refusal(path)
    assert "track_radius = -1" in str(pytest.raises(sb.InputError, fit_settings, {"track_radius": -1}).value)


def test_the_rotation_of_one_of_two_surfaces_is_no_speed(subtests, written):
    for header in (
        "Ball speed [rpm];Disc speed [rpm];COF",
        "Ball rpm;Speed [rpm];COF",
        "Upper specimen speed [rpm];Lower specimen speed [1/min];COF",
        "Rotational speed [rpm];Counterbody rotation [rpm];COF",
        "Roller 1 speed [rpm];Roller 2 speed [rpm];COF",
        "Drehzahl Kugel [1/min];Drehzahl Scheibe [1/min];Reibwert",
        "Ball speed [rpm];Disc speed [mm/s];COF",
    ):
        with subtests.test(header=header):
            path = written(table(header, speed, lambda u, mu: 2 * u, friction))
            for settings in ({}, {"track_radius": "9 mm"}):
                said = refusal(path, **settings)
                assert "may be of two surfaces" in said and "'mean speed [mm/s]', half the sum" in said and "'SRR [%]'" in said
    both = table("Ball speed [rpm];Disc speed [rpm];COF", lambda u, mu: 7, speed, friction)
    found = read(written(both), columns={"rotation": "Disc speed"}, track_radius="9 mm")
    assert found.values == pytest.approx(SPEEDS * 2 * np.pi / 60 * 9e-3, rel=1e-8)
    numbered = table("Ball;Disc;Drehzahl;COF", lambda u, mu: 6, lambda u, mu: 8, speed, friction)
    assert read(written(numbered), units={"rotation": "rpm"}, track_radius="9 mm").values == pytest.approx(found.values)
    twice = table("Disk speed [rpm];Disc speed [mm/s];COF", lambda u, mu: 7 * u, speed, friction)
    assert_on_curve(read(written(twice)))


def test_declared_columns_come_before_those_that_are_known_by_their_names(written):
    path = written(
        table(
            "speed [mm/s];COF;A [N];Fz [N];B [rpm]",
            lambda u, mu: 1 + u,
            lambda u, mu: 0.1 + mu,
            lambda u, mu: 2 * mu,
            lambda u, mu: 2,
            lambda u, mu: u * 60 / 2 / np.pi / 9,
        )
    )
    found = read(path, columns={"friction_force": "A", "rotation": "B"}, track_radius="9 mm")
    assert_on_curve(found)
    assert "friction = |'A [N]' / 'Fz [N]'|" in found.taken and "'COF'" not in found.taken
    moment = written(table("speed [mm/s];Moment du couple [mN m];Fz [N]", speed, lambda u, mu: 12 * mu, lambda u, mu: 2))
    assert_on_curve(read(moment, columns={"torque": "Moment du couple"}, arm="6 mm"))


def test_a_length_that_is_not_used_is_said(written):
    notes = read(written(PLAIN), track_radius="9 mm", arm="5 mm").notes
    assert "track_radius of [fit] is not used: no rotation was needed." in notes
    assert "arm of [fit] is not used: no torque was needed." in notes


def test_a_radius_without_a_unit_is_named_and_asked_for(written):
    path = written("Disc track radius:\t20.7\n\n" + table("Disc speed [rpm];COF", speed, friction))
    assert "(row 1 gives 'Disc track radius' 20.7 without a unit)" in refusal(path)


def test_advice_is_true_or_absent(written):
    force = refusal(written("Fx (N);Fz (N);V2 [mm/s]\n0.5;1;1\n0.4;1;2\n0.3;1;3\n"))
    assert force.endswith("as in speed = 'V2 [mm/s]'.")
    assert "as in" not in refusal(written("a;b;c\n1;2;3\n4;5;7\n"))
    assert "as in" not in refusal(written("speed_mms;load_kg\n1;2\n4;5\n"))
    ragged = refusal(written("speed [mm/s],COF\n0.1,0.5\n0.3,0.4,0.3\n"))
    assert "row 3 has 3 cells where the header has 2" in ragged and "decimal" not in ragged
    assert "begin decimals" in refusal(written("speed [mm/s],COF\n0,1,0,5\n0,3,0,4\n"))
    columns = refusal(written("speed [mm/s];COF water;COF oil\n1;0.3;0.2\n2;0.2;0.1\n"))
    assert columns.endswith("as in friction = ['COF water', 'COF oil'].")
    assert "without marks between thousands" in refusal(written("speed [mm/s];mu\n1,000.5;0.3\n2,000.5;0.2\n"))
    several = refusal(written("A [mm/s];B [mm/s];COF\n1;2;0.3\n4;5;0.7\n"))
    assert "speed =" not in several and "'A [mm/s]', 'B [mm/s]', 'COF'" in several


def test_a_code_of_missing_friction_leaves_its_row_out_and_is_counted(subtests, written):
    for magnitudes in [False, True]:
        with subtests.test(magnitudes=magnitudes):
            found = read(written(PLAIN + "400;-9999\n500;-9999.0\n"), magnitudes=magnitudes)
            assert found.friction.tolist() == read(written(PLAIN)).friction.tolist()
            assert "2 rows with '-9999' in 'COF', a missing value, left out: 10, 11." in found.notes
            speed = refusal(written(PLAIN + "-9999;0.1\n"), magnitudes=magnitudes)
            assert "has '-9999' in row 10, which programs write where a value is missing" in speed


def test_a_code_in_the_place_of_a_force_is_no_force(subtests, written):
    rows = table("speed [mm/s];Fx [N];Fz [N]", speed, lambda u, mu: 3 * mu, lambda u, mu: 3)
    for code in ("9.9E+37", "-9999", "99999", "Overload", "OVRLD", "O.L", ">>>>", "n.d."):
        with subtests.test(code=code):
            found = read(written(f"{rows}400;0.1;{code}\n"))
            assert found.friction == pytest.approx(curve(SPEEDS), rel=1e-6) and found.inputs == ({"load": 3.0},)
            assert any("left out: 10" in note for note in found.notes)


def test_few_rows_at_a_load_or_ratio_are_not_counted_as_another(subtests, written):
    loads = (1, 2, 5, 10)
    for name, header, wanted in (("load", "Load [N]", loads), ("slide_to_roll", "SRR [%]", [0.01 * each for each in loads])):
        with subtests.test(name=name):
            lines = [f"{load};{u};{curve(u):.6f}" for load in loads for u in (1, 100)]
            found = read(written("\n".join([f"{header};sum of speeds [mm/s];COF", *lines])))
            assert [each[name] for each in found.inputs] == pytest.approx(wanted)
            assert np.bincount(found.curve).tolist() == [2, 2, 2, 2]
    noisy = [f"{load * (1 + 0.003 * i):.4f};{u};{curve(u):.6f}" for load in (1, 4) for i, u in enumerate(SPEEDS)]
    text = "\n".join(["Normal force [N];speed [mm/s];COF", *noisy, "2.0;3;0.5", "2.01;30;0.2"])
    for geometry in ("line", "point"):
        found = read(written(text), geometry)
        assert len(found) == 16 and "without rows 18, 19, near none" in found.taken
    series = sb.bench.read(written(text))
    assert np.bincount(series.curve).tolist() == [8, 8]


def test_a_row_without_the_name_of_its_curve_is_refused(written):
    lines = [f"{'water' * (i == 0)}{'oil' * (i == 8)};{u};{curve(u):.6f}" for i, u in enumerate([*SPEEDS, *SPEEDS])]
    path = written("\n".join(["Sample;speed [mm/s];COF", *lines]))
    said = "row 3 has no 'Sample', which names the curve of other rows"
    assert said in refusal(path)
    with pytest.raises(sb.InputError, match=said):
        sb.bench.read(path)


def test_text_between_the_rows_that_gives_another_value_is_not_passed_over(subtests, written):
    forces = table("speed [mm/s];Friction force [N]", speed, friction)
    turns = table("Speed [rpm];COF", lambda u, mu: u, friction)
    for name, (first, second, block) in {
        "load": ("Load: 1 N", "Load: 2 N", PLAIN),
        "load of a force": ("Load: 1 N", "Load: 2 N", forces),
        "radius": ("Track radius: 10 mm", "Track radius: 20 mm", turns),
        "comments": ("# viscosity: 1 mPas", "# viscosity: 2 mPas", PLAIN),
        "below the header": (PLAIN.split("\n")[0] + "\n# Load: 1 N", "# Load: 2 N", PLAIN.split("\n", 1)[1]),
        "above the header": ("Radius: 3 mm", "Track radius: 20 mm\n" + turns, ""),
    }.items():
        with subtests.test(name=name):
            path = written(f"{first}\n{block}\n{second}\n{block}")
            assert "give two values of" in refusal(path)
            with pytest.raises(sb.InputError, match="give two values of"):
                sb.bench.read(path)
    blocks = written(f"Load: 1 N\n{PLAIN}\nLoad: 2 N\n{PLAIN}")
    assert "give two values of 'Load'" in refusal(blocks, geometry="line")
    assert read(blocks, files={"rig.csv": {"load": "3 N"}}).inputs == ({"load": 3.0},)
    same = written(f"Load: 1 N\nTrack diameter: 40 mm\n{turns}\nLoad: 1.0 N\nTrack radius: 20 mm\n{turns}")
    assert read(same).values.max() == pytest.approx(2 * np.pi * 0.02 * 300 / 60) and read(same).inputs == ({"load": 1.0},)


def test_a_mean_load_below_the_rows_is_the_load_that_was_set(written):
    assert read(written(f"Load: 3 N\n{PLAIN}\nMean load: 2.93 N\n")).inputs == ({"load": 3.0},)
    forces = table("speed [mm/s];Friction force [N]", speed, lambda u, mu: 3 * mu)
    assert_on_curve(read(written(f"Load: 3 N\n{forces}\nMean load: 2.93 N\n")))


def test_units_of_columns_are_units_of_lines_above_them(written):
    found = read(written(f"Load: 0.3 kg\nViscosity: 50 mPas\n{PLAIN}"))
    assert found.inputs[0] == {"load": pytest.approx(0.3 * 9.80665), "viscosity": pytest.approx(0.05)}


def test_a_setting_in_brackets_is_no_unit_of_friction(written):
    names = ["COF (1 N)", "COF (5 mN)"]
    path = written(table("speed [mm/s];" + ";".join(names), speed, friction, lambda u, mu: 0.9 * mu))
    assert read(path, columns={"friction": names}).curves == tuple(names)
    assert "has the unit '100 x'" in refusal(written(PLAIN.replace("COF", "COF (100 x)")))


def test_a_second_load_is_asked_for_by_its_own_name(written):
    path = written(table("Normal force [N];Load [N];speed [mm/s];COF", lambda u, mu: 2, lambda u, mu: 3, speed, friction))
    assert "'Load [N]' and one that the rig measured both look like load" in refusal(path)
    assert read(path, columns={"load": "Load [N]"}).inputs == ({"load": 3.0},)


def test_two_units_of_one_column_are_refused(written):
    text = table("speed [mm/s];COF\nm/s;-", speed, friction)
    assert "column 'speed [mm/s]' has the unit 'm/s' in the row below" in refusal(written(text))
    assert_on_curve(read(written(text.replace("\nm/s", "\nmm s-1"))))


def test_per_cent_of_an_error_is_of_friction_where_friction_has_none(written):
    text = "\n".join(["speed [mm/s];COF", *(f"{u};{mu:.6f} ± 2 %" for u, mu in ROWS)])
    found = read(written(text))
    assert found.error == pytest.approx(0.02 * found.friction)
    for form in ("{:.4f} % ± 2", "{:.4f} % ± 2 %"):
        text = "\n".join(["speed [mm/s];COF", *(f"{u};{form.format(100 * mu)}" for u, mu in ROWS)])
        assert read(written(text)).error == pytest.approx(0.02)
    bare = table("speed [mm/s];COF [%];SD", speed, lambda u, mu: 100 * mu, lambda u, mu: 2)
    assert "'SD' has no unit beside friction in %" in refusal(written(bare))
    assert read(written(bare), units={"error": "%"}).error == pytest.approx(0.02)


def test_eta_in_greek_is_a_viscosity_and_no_speed(written):
    found = read(written(table("ηU [mPa·s·m/s];COF", lambda u, mu: u / 1000, friction)))
    assert found.abscissa == "speed_viscosity" and found.values.max() == pytest.approx(3e-4)
    assert read(written(table("ηU/W [1/m];COF", speed, friction))).abscissa == "hersey_per_length"  # W is no unit there


def test_a_line_that_cannot_be_split_is_named_with_its_file(written):
    assert refusal(written('["speed":1,"cof":0.5}')).startswith(str(written("x").parent))


def test_a_name_twice_stops_the_reading_only_where_it_is_needed(written):
    twice = "T;mu;speed [mm/s];T;mu\n20;0.5;1;21;0.5\n20;0.4;2;22;0.4\n"
    assert read(written(twice)).friction.tolist() == [0.5, 0.4]
    other = twice.replace("22;0.4", "22;0.3")
    assert "'mu' is there twice, with different numbers" in refusal(written(other))


def test_the_standard_deviation_beside_friction_is_its_error(written):
    text = table("speed [mm/s];SD;COF;SD", speed, lambda u, mu: 0.2 * u, friction, lambda u, mu: 0.03 * mu)
    found = read(written(text))
    assert found.error == pytest.approx(0.03 * found.friction, rel=1e-6)
    assert read(written(text), columns={"error": "SD"}).error == pytest.approx(found.error)
    for header in ("COF (mean);COF (SD)", "COF;±", "COF;+/-", "COF [-];COF (SD) [-]", "µ;s.d.", "COF mean;COF std"):
        path = written(table(f"speed [mm/s];{header}", speed, friction, lambda u, mu: 0.03 * mu))
        assert read(path).error == pytest.approx(0.03 * found.friction, rel=1e-6), header
    text = table("speed [mm/s];COF (%);Std. Dev. (%)", speed, lambda u, mu: 100 * mu, lambda u, mu: 3 * mu)
    assert read(written(text)).error == pytest.approx(0.03 * found.friction, rel=1e-6)
    relative = read(written(table("speed [mm/s];COF;SD [%]", speed, friction, lambda u, mu: 3.0)))
    assert relative.error == pytest.approx(0.03 * found.friction, rel=1e-6)
    assert "'SD [%]' is of the friction in each row." in relative.notes


def test_a_first_row_with_one_number_is_a_row(subtests, written):
    for header in ("speed [mm/s];COF", "speed;COF\nmm/s;-", "speed;COF\n[mm/s];[1]"):
        for first, notes in (("7;", True), ("7;NaN", True), ("7;-\n8;NaN", True), ("", False)):
            with subtests.test(header=header, first=first):
                rows = table("", speed, friction).strip()
                found = read(written("\n".join(filter(None, (header, first, rows)))))
                assert_on_curve(found)
                assert any("without a value left out" in note for note in found.notes) == notes


def test_means_and_deviations_below_the_rows_are_no_rows(subtests, written):
    rows = table("Nr.;speed [mm/s];COF", lambda u, mu: 7, speed, friction)
    for footer in ("Mittelwert;37;0.3\nStandardabweichung;54;0.2", "Mean;;0.3\nMax.;300;0.5", "Std. Dev.:;54;0.2"):
        with subtests.test(footer=footer):
            found = read(written(f"{rows.strip()}\n{footer}\n"))
            assert_on_curve(found)
            assert any("below the numbers left out: 10" in note for note in found.notes)
    header, *lines = rows.strip().splitlines()
    for between in ("Mean;{};0.9", "Std;0.01;0.02"):
        with subtests.test(between=between):
            steps = [f"{line}\n{between.format(line.split(';')[1])}" for line in lines]
            found = read(written("\n".join([header, *steps])))
            assert_on_curve(found)
            assert any("of other text between the numbers left out: 3, 5, 7" in note for note in found.notes)
    behind = "speed [mm/s];COF;\n1;0.5;\n3;0.4;\n2;0.9;mean\n10;0.3;\n30;0.2;\n20;0.9;mean\n"
    assert read(written(behind)).friction.tolist() == [0.5, 0.4, 0.3, 0.2]
    assert len(read(written(behind.replace("COF;", "COF;remark")))) == 5
    alone = "speed [mm/s];what;COF\n1;mean;0.5\n10;mean;0.3\n100;mean;0.1\n"
    assert len(read(written(alone))) == 3


def test_marks_between_thousands_are_refused_by_the_sign_of_other_columns_or_named(written):
    text = "speed [µm/s]\tCOF\n1,000\t0.5\n10,000\t0.3\n100,000\t0.1\n"
    assert "'1,000' with a comma" in refusal(written(text)) and "no thousands separator" in refusal(written(text))
    with pytest.raises(sb.InputError, match="'-2.000' with a point"):
        sb.profiles.Table(str(written("x [µm];z [nm]\n-2.000;200,5\n-1.000;50,2\n0;0\n1.000;50,1\n2.000;200,4\n")))
    found = read(written("speed [µm/s];COF [%]\n1.000;50\n10.000;30\n100.000;10\n"))
    assert "'speed [µm/s]': '1.000' was read as 1, not as 1000." in found.notes
    assert not any("was read as" in note for note in read(written(table("speed [mm/s];COF", speed, friction))).notes)


def test_marks_that_may_be_of_thousands_are_noted_wherever_a_column_goes(subtests, written):
    plain = "speed [um/s];COF\n100;0.560\n1.000;0.497\n3.000;0.41\n10.000;0.270\n"
    made = "mean speed [um/s];Fx [uN];Fz [mN]\n100;560;1.000\n1.000;497;1.000\n3.000;410;1.000\n10.000;270;1.000\n"
    for text, columns in ((plain, ["speed [um/s]"]), (made, ["mean speed [um/s]", "Fz [mN]"])):
        for reader in (read, sb.bench.read):
            with subtests.test(text=text, reader=reader.__name__):
                notes = reader(written(text)).notes
                assert all(f"'{column}': '1.000' was read as 1, not as 1000." in notes for column in columns)


def test_forces_with_three_digits_behind_a_decimal_comma_are_read(subtests, written):
    """Friction and speed that are made of columns have points, which say nothing of the signs in the file."""
    header = "Mittlere Geschwindigkeit [mm/s];Reibkraft [N];Normalkraft [N]"
    rows = table(header, speed, lambda u, mu: 2 * mu, lambda u, mu: 2).replace(".", ",").replace(";2\n", ";2,000\n")
    settings = fit_settings({"columns": {"entrainment_speed": "Mittlere Geschwindigkeit [mm/s]"}}, "point")
    for reader in (sb.read_measurements, sb.bench.read):
        with subtests.test(reader=reader.__name__):
            found = reader(written(rows), settings)
            speeds = 500 * (found.values if reader is sb.read_measurements else found.speed)
            assert found.friction == pytest.approx(curve(speeds), rel=2e-3)


def test_a_line_above_the_header_says_an_input_in_any_usual_form(subtests, written):
    rows = table("speed [mm/s];COF", speed, friction)
    for line in ("Viscosity:;50 mPa*s", '"Viscosity";"50 mPa*s"', "Viscosity [mPa*s]:;50", "viscosity = 0,05 Pa*s"):
        with subtests.test(line=line):
            assert read(written(f"{line}\n{rows}")).inputs[0]["viscosity"] == pytest.approx(0.05)


def test_a_line_gives_an_input_with_its_error_or_is_noted_as_not_used(subtests, written):
    rows = table("speed [mm/s];COF", speed, friction)
    for line in ("Load: 2 ± 0.1 N", "Load: 2 N +/- 0.1 N", "Load (N): 2 +- 0.1"):
        with subtests.test(line=line):
            assert read(written(f"{line}\n{rows}")).inputs == ({"load": 2.0},)
    for line, what in (("Load: approx. 2 N", "approx. 2 N"), ("Load = 2-3 N", "2-3 N")):
        with subtests.test(line=line):
            found = read(written(f"{line}\n{rows}"))
            assert found.inputs == ({},)
            assert f"The load {what!r} of row 1 was not used: it is no number with a unit." in found.notes


def test_a_line_below_the_header_says_an_input(subtests, written):
    head, *rows = table("speed [mm/s];COF", speed, friction).splitlines()
    for lines in (["Load: 2 N"], ["Step 1", "Load: 2 N"], ["mm/s;-", "Load: 2 N;"]):
        with subtests.test(lines=lines):
            assert read(written("\n".join([head, *lines, *rows]))).inputs == ({"load": 2.0},)


def test_a_line_between_the_rows_is_not_of_those_above_it(subtests, written):
    head, *rows = table("speed [mm/s];COF", speed, friction).splitlines()
    force = head.replace("COF", "Fx [N]")
    for first, line in ((head, "# load: 5 N"), (head, "SRR: 50 %"), (force, "Normal force: 5 N")):
        text = "\n".join([first, *rows[:4], line, *rows[4:]])
        for reader in (read, sb.bench.read):
            with subtests.test(line=line, reader=reader.__name__):
                with pytest.raises(sb.InputError, match=r"row 6 gives '.*' between the rows of numbers"):
                    reader(written(text))


def test_a_line_above_the_header_with_marks_between_thousands_is_refused(subtests, written):
    rows = table("speed [mm/s];COF", speed, friction)
    for line in ("Viscosity: 1,050 mPa*s", "Viscosity [mPa*s];Load\n1,050;3", "Viscosity: 1.050,0 mPa*s"):
        with subtests.test(line=line):
            text = f"{line}\n{rows}"
            assert "may have marks between thousands; write it with a decimal point" in refusal(written(text))
    commas = written("Viscosity: 1,050 Pa*s\nSampled: 1.000 points\n" + rows.replace(".", ","))
    assert read(commas).inputs[0]["viscosity"] == pytest.approx(1.05)
    turns = table("Speed [rpm];COF", lambda u, mu: u * 3 / np.pi, friction)
    assert "'10,000' in row 1 may have" in refusal(written(f"Track radius: 10,000 µm\n{turns}"))


def test_a_line_of_many_words_above_a_header_between_tabs_is_not_the_header(written):
    rows = table("Time [s]\tspeed [mm/s]\tµ", lambda u, mu: u, speed, friction).replace(";", "\t")
    assert_on_curve(read(written(f"Tribometer\nLin. Speed : 10 [cm/s] of the disc\nRadius : 5 [mm]\n{rows}")))


def workbook(tmp_path, **sheets):
    """Return the path of a workbook of sheets of rows."""
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    book.remove(book.active)
    for title, rows in sheets.items():
        sheet = book.create_sheet(title)
        for row in rows:
            sheet.append(row)
    path = tmp_path / "rig.xlsx"
    book.save(path)
    return path


def test_the_sheet_of_a_workbook_is_named_and_chosen(tmp_path):
    water = [["speed [mm/s]", "COF"], *([u, mu] for u, mu in ROWS)]
    oil = [["speed [mm/s]", "COF"], *([u, 0.5 * mu] for u, mu in ROWS[:-1])]
    path = workbook(tmp_path, water=water, oil=oil, notes=[["none"]])
    found = read(path)
    assert_on_curve(found)
    assert "Sheet 'water' read, not 'oil'; sheet = ... in [fit] chooses another." in found.notes
    assert read(path, sheet="oil").friction == pytest.approx(0.5 * curve(SPEEDS[:-1]))
    assert "has no sheet 'glycerol'; its sheets are 'water', 'oil', 'notes'" in refusal(path, sheet="glycerol")
    assert "is no workbook" in refusal("12_three_header_rows.txt", sheet="oil")
    assert "sheet = 3" in str(pytest.raises(sb.InputError, fit_settings, {"sheet": 3}).value)


def test_a_table_that_would_take_minutes_is_refused(written):
    assert "more than 500000 rows" in refusal(written("speed [mm/s];mu\n" + 500_000 * "1;1\n"))
    assert "more than 4000000 cells" in refusal(written("speed [mm/s];mu\n1" + 4_000_000 * ";1"))
    path = written("speed [mm/s];mu\n")
    with path.open("r+b") as file:
        file.truncate(10**10)  # sparse: it takes no room on the disk
    assert "more than 20000000 bytes" in refusal(path)


def test_the_sheet_with_speed_and_friction_is_read_before_longer_ones(tmp_path):
    raw = [["time [s]", "voltage [V]", "x", "y"], *([i, 1 + i, 2, 3] for i in range(40))]
    path = workbook(tmp_path, raw=raw, means=[["speed [mm/s]", "COF"], *([u, mu] for u, mu in ROWS)])
    found = read(path)
    assert_on_curve(found)
    assert "Sheet 'means' read, not 'raw'; sheet = ... in [fit] chooses another." in found.notes
    assert "rig.xlsx: the columns are 'time [s]'" in refusal(path, sheet="raw")


def test_steps_in_other_units_are_not_read_in_those_of_the_first(written):
    first, second = (f"speed;COF\n{unit};-\n" + PLAIN.partition("\n")[2] for unit in ("mm/s", "m/s"))
    assert "rows 1 and 12 are headers of two tables of 8 and 8 rows" in refusal(written(f"{first}\n{second}"))
    assert_on_curve(read(written(f"{first}\n{second}"), header_row=1))
    assert_on_curve(read(written(f"{first}\n{first}")))


def test_a_workbook_with_gaps_texts_and_units_is_read(tmp_path):
    rows = [['Disc 5"', None, True], [], ["Speed", None, "COF", "remark"], ["mm/s", None, "-"]]
    rows += [[u, None, mu, "ok"] if u < 100 else [u, None, mu] for u, mu in ROWS]
    found = read(workbook(tmp_path, data=rows))
    assert_on_curve(found)
    assert found.rows[0] == 5


def test_a_cell_of_a_workbook_counts_in_the_unit_that_its_format_shows(tmp_path):
    openpyxl = pytest.importorskip("openpyxl")
    rows = [[second / 86400, 10.0 if second < 30 else 100.0, 0.3 if second < 30 else 0.2] for second in range(60)]
    path = workbook(tmp_path, data=[["Zeit", "speed [mm/s]", "COF [%]"], *rows])
    book = openpyxl.load_workbook(path)
    for clock, _, mu in book["data"].iter_rows(min_row=2):
        clock.number_format, mu.number_format = "[h]:mm:ss", '0.0%_"!"'
    book.save(path)
    assert set(read(path).friction) == {0.2, 0.3}
    assert sb.bench.read(path).time[-1] == pytest.approx(59.0)


SHEET = "xl/worksheets/sheet1.xml"


def changed(path, change, **more):
    """Change the text of the first sheet of a workbook, and add parts to it."""
    with zipfile.ZipFile(path) as book:
        parts = {name: book.read(name) for name in book.namelist()}
    parts[SHEET] = change(parts[SHEET].decode()).encode()
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w", zipfile.ZIP_DEFLATED) as book:
        for name, part in (parts | {f"xl/{name}.xml": part for name, part in more.items()}).items():
            book.writestr(name, part)
    path.write_bytes(content.getvalue())
    return path


def with_shared_strings(path, strings):
    """Change the texts of a workbook to references, as Excel writes them."""
    items = "".join(f"<si>{text}</si>" for text in strings)
    table = f'<sst xmlns="http://schemas.openxmlformats.org/spreadsheetml/2006/main">{items}</sst>'

    def refer(text):
        count = itertools.count()
        found = re.sub(r't="inlineStr"><is><t>[^<]*</t></is>', lambda _: f't="s"><v>{next(count) % len(strings)}</v>', text)
        return re.sub(r'(<c) r="[A-Z]+[0-9]+"', r"\1", found)  # nor need cells say where they are

    return changed(path, refer, sharedStrings=table)


def test_a_workbook_of_excel_refers_to_its_texts(tmp_path):
    water = [["a", "b"], *([u, mu] for u, mu in ROWS)]
    rich = ["<r><t>speed</t></r><r><t> [mm/s]</t></r><rPh><t>x</t></rPh>", "<t>COF</t>"]
    found = read(with_shared_strings(workbook(tmp_path, data=water), rich))
    assert_on_curve(found)
    assert "'speed [mm/s]' as speed; 'COF' as friction" in found.taken


def test_many_cells_that_refer_to_one_long_text_do_not_fill_the_memory(tmp_path):
    path = with_shared_strings(workbook(tmp_path, data=1000 * [["a", 1]]), [f"<t>{1_000_000 * 'x'}</t>"])
    assert path.stat().st_size < 100_000
    assert "holds more than 20000000 letters" in refusal(path)


def test_a_workbook_that_unpacks_to_anything_is_read_or_refused_at_once(tmp_path):
    water = [["speed [mm/s]", "COF"], *([u, mu] for u, mu in ROWS)]
    last = '<row r="1048576"><c r="XFD1048576" s="0"/></row></sheetData>'
    far = "".join(f'<row r="{i}"><c r="XFD{i}"><v>1</v></c></row>' for i in range(20, 200))
    hostile = {
        "numbers far to the right": lambda text: text.replace("</sheetData>", f"{far}</sheetData>"),
        "a blank in the last cell": lambda text: text.replace("</sheetData>", last).replace("A1:B9", "A1:XFD1048576"),
        "a number in the last cell": lambda text: text.replace("</sheetData>", last.replace('s="0"/>', "><v>1</v></c>")),
        "no such cell": lambda text: text.replace("</sheetData>", '<row r="2"><c r="ZZZZZZ2"><v>1</v></c></row></sheetData>'),
        "no such row": lambda text: text.replace("</sheetData>", '<row r="99999999999"/></sheetData>'),
        "a bomb": lambda text: text.replace("</sheetData>", 120_000_000 * " " + "</sheetData>"),
        "entities": lambda text: '<!DOCTYPE a [<!ENTITY b "c">]>' + text.partition("?>")[2],
        "nested": lambda text: text.replace("</sheetData>", 100_000 * "<a>" + "</sheetData>"),
    }
    for name, change in hostile.items():
        path = changed(workbook(tmp_path, data=water), change)
        assert path.stat().st_size < 1_000_000
        began = time.process_time()
        if "blank" in name:
            assert_on_curve(read(path))
        else:
            said = refusal(path)
            assert "rig.xlsx" in said, name
            assert "far" not in name or "has more than 2000000 cells" in said
        assert time.process_time() - began < 2, name
