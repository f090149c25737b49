"""Measured friction as laboratories write it: read alike whatever its form, or refused with row and column."""

import time

import numpy as np
import pytest
from command_line import fit_settings
from hypothesis import given
from hypothesis import strategies as st

import stribeck as sb

SPEEDS = (0.001, 0.01, 0.1, 1.0)
FRICTIONS = (0.5, 0.25, 0.0625, 0.125)
PLAIN = "speed [m/s];friction\n" + "\n".join(f"{u};{m}" for u, m in zip(SPEEDS, FRICTIONS, strict=True))


@pytest.fixture
def read(tmp_path):
    """Return a function that reads text as a file, under a ``[fit]`` table."""

    def reader(text, **table):
        path = tmp_path / "lab.csv"
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return sb.read_measurements(path, fit_settings(table))

    return reader


def refused(read, text, **table):
    """Return the sentence with which a file is refused."""
    with pytest.raises(sb.InputError) as caught:
        read(text, **table)
    return str(caught.value)


SAME = {
    "commas": PLAIN.replace(";", ","),
    "tabs": PLAIN.replace(";", "\t"),
    "spaces": PLAIN.replace(";", "   "),
    "bars": PLAIN.replace(";", "|"),
    "decimal commas": PLAIN.replace(".", ","),
    "decimal commas and tabs": PLAIN.replace(".", ",").replace(";", "\t"),
    "decimal commas in quotes": 'speed [m/s],friction\n"0,001","0,5"\n"0,01","0,25"\n"0,1","0,0625"\n"1","0,125"',
    "percent": "speed [m/s];friction [%]\n0.001;50\n0.01;25\n0.1;6.25\n1;12.5",
    "percent in the cells": "speed [m/s];friction\n0.001;50 %\n0.01;25%\n0.1;0.0625\n1;12.5 %",
    "another unit": "speed [mm/s];friction\n1;0.5\n10;0.25\n100;0.0625\n1000;0.125",
    "units in parentheses": "Speed (mm/s);COF (-)\n1;0.5\n10;0.25\n100;0.0625\n1000;0.125",
    "units after a slash": "speed / mm/s;mu / 1\n1;0.5\n10;0.25\n100;0.0625\n1000;0.125",
    "mixed units": "speed [m/s];friction\n1 mm/s;0.5\n0.01;0.25\n10 cm/s;0.0625\n1;0.125",
    "a row of units": "speed;friction\nmm/s;-\n1;0.5\n10;0.25\n100;0.0625\n1000;0.125",
    "unsorted": "speed [m/s];friction\n1;0.125\n0.001;0.5\n0.1;0.0625\n0.01;0.25",
    "comments and empty lines": "# run 12\n\nspeed [m/s];friction\n0.001;0.5\n\n# pause\n0.01;0.25\n0.1;0.0625\n1;0.125\n;\n",
    "missing values": PLAIN + "\n2;\n;0.3\nNaN;0.1\n3;n/a\n#DIV/0!;0.1\n3;inf",
    "a first row without friction": PLAIN.replace("\n", "\n1;\n", 1),
    "other columns": "time;speed [m/s];friction;remark\n" + "9;0.001;0.5;x\n9;0.01;0.25;x\n9;0.1;0.0625;x\n9;1;0.125;x",
    "trailing separators": PLAIN.replace("\n", ";\n", 2).replace("friction;", "friction"),
}


def test_the_form_of_the_file_does_not_matter(subtests, read):
    for text in SAME.values():
        with subtests.test(text=text):
            found = read(text)
            assert found.abscissa == "speed"
            assert found.values == pytest.approx(SPEEDS, rel=1e-15)
            assert found.friction == pytest.approx(FRICTIONS, rel=1e-15)
            assert found.error is None


def test_a_mean_speed_is_not_taken_for_the_sum_of_the_surface_speeds(subtests, read):
    for header in ["mean speed [m/s]", "Entrainment speed (m/s)", "entraining velocity [m/s]", "Rolling speed [m/s]"]:
        with subtests.test(header=header):
            found = read(PLAIN.replace("speed [m/s]", header))
            assert found.values == pytest.approx(2 * np.array(SPEEDS))
            assert "a mean of two surface speeds; the speed of a case is their sum" in found.taken


def test_what_was_left_out_or_assumed_is_said(read):
    assert read(SAME["missing values"]).notes == ("6 rows without a value left out: 6, 7, 8, 9, 10, 11.",)
    assert read(SAME["other columns"]).notes == ("Columns not used: time, remark.",)
    assert read(SAME["decimal commas"]).notes == ("Numbers were read with decimal commas.",)


def test_rows_keep_their_number_in_the_file_and_all_of_a_speed_are_kept(read):
    assert read(SAME["unsorted"]).rows.tolist() == [3, 5, 4, 2]
    assert read(SAME["comments and empty lines"]).rows.tolist() == [4, 7, 8, 9]
    twice = read(PLAIN + "\n0.1;0.07")
    assert (twice.values[2:4].tolist(), twice.friction[2:4].tolist()) == ([0.1, 0.1], [0.0625, 0.07])


def test_a_header_in_another_language_is_declared(read):
    text = "Vitesse [mm/s];Frottement;Erreur\n1;50;1\n10;25;1\n100;6,25;1\n1000;12,5;1"
    sentence = refused(read, text)
    assert "none of which is known as speed or friction" in sentence
    assert sentence.endswith("as in speed = 'Vitesse [mm/s]' and friction = 'Frottement'.")
    undecided = refused(read, text.replace("12,5;1", "12,5;2"))
    assert undecided.endswith("as in speed = 'Vitesse [mm/s]'.")  # either column could be friction
    assert "as in speed = 'Tempo [mm/s]' and" in refused(read, "Kurve;Tempo [mm/s];Frottement\na;1;0.5")
    columns = {"speed": "Vitesse", "friction": "Frottement", "error": "Erreur"}
    found = read(text, columns=columns, units={"friction": "%", "error": "%"})
    assert found.values == pytest.approx(SPEEDS)
    assert found.friction == pytest.approx(FRICTIONS)
    assert found.error.tolist() == [0.01] * 4


def test_a_header_may_stand_below_other_text(read):
    text = "Tribometer 7;;\nOperator: N.N.;;\n" + PLAIN
    assert read(text, header_row=3).values == pytest.approx(SPEEDS)
    assert "row 2" in refused(read, "a;b\n# c\n" + PLAIN, header_row=2)


PREAMBLE = "Tribometer 7\nOperator; N.N.\nSample;PDMS\nLoad;30;N\nDate;2024-01-05;12:30\n\n"


def test_the_only_header_below_a_preamble_is_found(subtests, read):
    for units in ["", "\nm/s;-"]:
        with subtests.test(units=units):
            header, rows = PLAIN.split("\n", 1)
            found = read(PREAMBLE + header + units + "\n" + rows)
            assert found.values == pytest.approx(SPEEDS) and found.friction == pytest.approx(FRICTIONS)
            assert found.notes[0] == "5 rows of other text above the header skipped."
            assert found.rows.min() == 8 + bool(units)


def test_where_two_rows_may_be_the_header_the_error_names_header_row(read):
    text = PREAMBLE + "speed [mm/s];COF\n3;0.4\n4;0.3\n5;0.2\n\n" + PLAIN
    assert "header_row = 7 or header_row = 12 in [fit]" in refused(read, text)
    assert read(text, header_row=12).values == pytest.approx(SPEEDS)
    first = read(text, header_row=7)
    assert first.values == pytest.approx([0.003, 0.004, 0.005])
    assert any("A table of 4 rows under another header, in row 12, left out" in note for note in first.notes)


def test_rows_of_spaces_below_a_header_of_tabs_are_read(read):
    lines = PLAIN.replace(";", "\t").split("\n")
    lines[2:4] = [line.replace("\t", "   ") for line in lines[2:4]]
    assert read("\n".join(lines)).values == pytest.approx(SPEEDS)


def test_a_force_is_not_taken_for_a_friction_coefficient(read):
    sentence = refused(read, "Speed (mm/s);Traction Force (N)\n1;0.5\n2;0.4")
    assert "none of which is a friction coefficient" in sentence and "over the normal force" in sentence
    assert "as in friction = 'Traktion'" in refused(read, "Speed (mm/s);Traktion;Traction Force (N)\n1;0.5;3")


def test_other_abscissas_are_read_in_si(read):
    found = read("eta U [mPa*s*m/s];mu\n1;0.5\n2;0.4\n3;0.3")
    assert (found.abscissa, found.values.tolist()) == ("speed_viscosity", [0.001, 0.002, 0.003])
    found = read("Hersey number;mu\n1e-5;0.5\n2e-5;0.4\n3e-5;0.3")
    assert (found.abscissa, found.values.tolist()) == ("hersey_number", [1e-5, 2e-5, 3e-5])


def test_curves_are_told_apart_by_name_or_input(read):
    rows = "\n".join(f"{name};{eta};{u};0.{u}" for name, eta in (("oil", 50), ("water", 1)) for u in (3, 1, 2))
    found = read("curve;viscosity [mPa*s];speed [m/s];friction\n" + rows)
    assert found.curves == ("oil", "water")
    assert found.inputs == ({"viscosity": 0.05}, {"viscosity": 0.001})
    assert found.curve.tolist() == [0, 0, 0, 1, 1, 1]
    assert found.values.tolist() == [1, 2, 3, 1, 2, 3]
    unnamed = "\n".join(row.partition(";")[2] for row in rows.splitlines())
    found = read("viscosity [mPa*s];speed [m/s];friction\n" + unnamed)
    assert found.curves == ("viscosity 50 mPa*s", "viscosity 1 mPa*s")


def test_curves_may_stand_side_by_side(read):
    text = "speed [m/s];mu dry [%];mu wet\n1;50;0.2\n2;40;0.1\n3;;0.3"
    found = read(text, columns={"friction": ["mu dry", "mu wet"]}, curves={"mu wet": {"roughness": "2 um"}})
    assert found.curves == ("mu dry", "mu wet")
    assert found.friction.tolist() == [0.5, 0.4, 0.2, 0.1, 0.3]
    assert found.inputs == ({}, {"roughness": pytest.approx(2e-6)})
    assert "no curve is called 'b'" in refused(read, PLAIN, curves={"b": {"roughness": 1e-6}})


def test_signs_of_strokes_are_dropped_on_demand(read):
    text = "speed [m/s];friction\n-1;-0.5\n1;0.4\n2;0.3"
    sentence = refused(read, text)
    assert "row 2, column 'speed [m/s]': '-1' is negative" in sentence and "magnitudes = true" in sentence
    assert read(text, magnitudes=True).friction.tolist() == [0.5, 0.4, 0.3]


REFUSED = {
    "negative speed": (PLAIN + "\n-2;0.1", "row 6, column 'speed [m/s]'", "negative"),
    "speed zero": (PLAIN + "\n0;0.1", "row 6, column 'speed [m/s]'", "static friction"),
    "negative friction": (PLAIN + "\n2;-0.1", "row 6, column 'friction'", "positive"),
    "percent unsaid": (PLAIN + "\n2;35", "row 6, column 'friction'", "percent"),
    "text": (PLAIN + "\n2;stick", "row 6, column 'friction'", "'stick' is not a number"),
    "too many cells": (PLAIN + "\n2;0.1;7", "row 6", "3 cells where the header has 2"),
    "too few cells": (PLAIN + "\n2", "row 6", "1 cell where the header has 2"),
    "decimal commas between commas": ("speed [m/s],friction\n0,001,0,5", "row 2", "commas cannot both"),
    "another separator below": ("speed [m/s],friction\n1;0.5\n2;0.4", "row 2", "semicolon"),
    "both decimal signs": (PLAIN + "\n2;0,125", "row 6, column 'friction'", "row 2, column 'friction'"),
    "a decimal sign for each column": (
        "speed [m/s];mu\n0.5;0,2\n1.5;0,1",
        "row 2, column 'mu'",
        "row 2, column 'speed [m/s]'",
    ),
    "thousands": ("speed [m/s];friction\n1.234,5;0,5", "row 2, column 'speed [m/s]'", "not a number"),
    "no unit": ("speed;friction\n1;0.5\n2;0.4", "column 'speed'", "no unit"),
    "a unit of something else": ("speed [mm];friction\n1;0.5\n2;0.4", "column 'speed [mm]'", "a length"),
    "a cell of something else": (PLAIN + "\n2 s;0.1", "row 6, column 'speed [m/s]'", "a time"),
    "an angle": ("speed [rad];friction\n1;0.5\n2;0.4", "column 'speed [rad]'", "is an angle; expected a speed"),
    "an unknown unit": ("speed [furl];friction\n1;0.5\n2;0.4", "column 'speed [furl]'", "unknown unit 'furl'"),
    "friction in newton": ("speed [m/s];friction [N]\n1;0.5\n2;0.4", "column 'friction [N]'", "bare number"),
    "no header": ("1;0.5\n2;0.4", "row 1", "not names of columns"),
    "one column": ("speed\n1\n2", "row 1", "one column"),
    "the same column twice": ("speed [m/s];mu;mu\n1;0.5;0.4", "'mu'", "twice, with different numbers"),
    "two frictions": ("speed [m/s];mu;friction\n1;0.5;0.4", "'mu' and 'friction'", "[fit.columns]"),
    "no friction": ("speed [m/s];torque\n1;0.5", "'torque'", "none of which is known as friction"),
    "one speed": ("speed [m/s];friction\n1;0.5\n1;0.4", "rows 2 to 3", "same speed"),
    "a constant curve": ("speed [m/s];friction\n1;0.5\n2;0.5\n3;0.5", "column 'friction'", "constant"),
    "only missing values": ("speed [m/s];friction\n1;\n2;", "no row holds both", "friction"),
    "no rows": ("speed [m/s];friction\n", "row 1", "no rows"),
    "nothing": ("", "no data", "header"),
    "a zero error": ("speed [m/s];friction;error\n1;0.5;0", "row 2, column 'error'", "positive"),
    "a spreadsheet": (b"PK\x03\x04\x00\x00", "not text", "CSV"),
    "an open quote": ('speed [m/s];friction\n"1;0.5', "row 2", "quotes"),
    "a curve of two viscosities": (
        "curve;viscosity [Pa*s];speed [m/s];mu\na;1;1;0.5\na;2;2;0.4",
        "row 3 has viscosity 2",
        "row 2 of the same curve",
    ),
    "an impossible input": ("roughness [um];speed [m/s];mu\n-1;1;0.5", "row 2, column 'roughness [um]'", "must be"),
}


def test_what_cannot_be_used_is_refused_with_one_sentence_that_says_where(subtests, read):
    for text, where, what in REFUSED.values():
        with subtests.test(text=text, where=where, what=what):
            sentence = refused(read, text)
            assert where in sentence and what in sentence
            assert sentence.startswith(("/", str(read))) or "lab.csv" in sentence
            assert "\n" not in sentence


def test_a_file_that_is_not_there_is_one_sentence(tmp_path):
    for path in (tmp_path, tmp_path / "none.csv"):
        with pytest.raises(sb.InputError, match="cannot be read|directory"):
            sb.read_measurements(path)


@given(st.text(max_size=60))
def test_any_text_is_read_or_refused_with_a_sentence(tmp_path_factory, text):
    path = tmp_path_factory.mktemp("any") / "lab.csv"
    for content in (text, "speed [m/s];friction\n" + text, PLAIN + "\n" + text):
        path.write_text(content, encoding="utf-8", errors="replace", newline="")
        try:
            found = sb.read_measurements(path)
        except sb.InputError as problem:
            assert str(problem).endswith(".")
        else:
            assert np.isfinite(found.values).all() and (found.friction > 0).all()


TABLES = {
    "unknown key": ({"fre": ["boundary_friction"]}, "fre", "did you mean free."),
    "unknown input": ({"free": ["stiffness"]}, "'stiffness'", "known are"),
    "symbol": ({"free": ["mu0"]}, "'mu0'", "write boundary_friction."),
    "speed": ({"free": ["speed"]}, "'speed'", "measured"),
    "twice": ({"free": ["boundary_friction", "boundary_friction"]}, "boundary_friction", "twice"),
    "none": ({"free": []}, "free = []", "list"),
    "per_curve only": ({"free": ["boundary_friction"], "per_curve": ["beta"]}, "beta", "not in free"),
    "noise": ({"noise": "white"}, "'white'", "'relative' or 'absolute'"),
    "error": ({"relative_error": -1}, "-1", "positive"),
    "robust": ({"robust": "yes"}, "'yes'", "true or false"),
    "bounds": ({"bounds": {"roughness": ["2 um", "1 um"]}}, "roughness", "write the lowest value first"),
    "bound unit": ({"bounds": {"roughness": ["2 MPa", "1 um"]}}, "roughness", "a pressure"),
    "prior": ({"priors": {"modulus": "2 MPa"}}, "modulus", "factor"),
    "prior width": ({"priors": {"modulus": {"value": "2 MPa", "factor": 0.5}}}, "0.5", "above 1"),
    "column": ({"columns": {"wear": "M"}}, "wear", "not a known key"),
    "column text": ({"columns": {"speed": 3}}, "3", "header"),
    "curve": ({"curves": {"a": {"colour": 1}}}, "colour", "not a known key"),
    "header row": ({"header_row": 0}, "header_row = 0", "counted from 1"),
}


def test_a_wrong_fit_table_is_refused_by_the_case_file(subtests, tmp_path):
    for table, where, what in TABLES.values():
        with subtests.test(table=table, where=where, what=what):
            with pytest.raises(sb.InputError) as caught:
                fit_settings(table)
            assert where in str(caught.value) and what in str(caught.value)


def test_a_hostile_file_is_read_in_time_that_grows_with_its_length(subtests, tmp_path):
    for text in [",".join(f"c{i}" for i in range(60_000)), "a,b\n" + 60_000 * "1" + "x,2\n"]:
        with subtests.test(text=text):
            path = tmp_path / "hostile.csv"
            path.write_text(text + "\n")
            began = time.process_time()
            with pytest.raises(sb.InputError):
                sb.read_measurements(path)
            assert time.process_time() - began < 3  # a tenth of a second; with the square of the length, half a minute
