"""The Hersey number of line and ball: one definition each, with its unit, wherever it is read, fitted or written."""

from pathlib import Path

import numpy as np
import pytest
from command_line import call

import stribeck as sb

DATA = Path(__file__).parent / "data"
FILE, CASE = DATA / "09_hersey_number_ball.csv", DATA / "09_hersey_number_ball.toml"
BALL = sb.load_case(CASE).contact
LINE = sb.load_case(Path(__file__).parents[1] / "examples" / "pdms_cylinder.toml").contact


@pytest.fixture
def written(tmp_path):
    """Return a function that writes the data of a ball under another header, times a factor, and returns the path."""

    def write(header, factor=1.0):
        rows = [line.split(";") for line in FILE.read_text().split()[2:]]
        path = tmp_path / "data.csv"
        path.write_text("\n".join([f"{header};COF", *(f"{float(x) * factor!r};{mu}" for x, mu in rows)]))
        return path

    return write


def read(path, geometry="point", **units):
    return sb.read_measurements(path, sb.FitSettings(geometry=geometry, units=units))


@pytest.mark.quick
def test_a_file_that_leaves_the_hersey_number_of_a_ball_open_is_asked_about(capsys):
    with pytest.raises(sb.InputError, match="eta U R/F_N, a number, or eta U/F_N, in 1/m"):
        read(FILE)
    refused = call(capsys, "fit", FILE, CASE)
    assert refused.code == 2 and "Hersey number [1/m]" in " ".join(refused.err.split())
    assert read(FILE, "line").abscissa == "hersey_number"  # whose load is per length


@pytest.mark.quick
def test_the_unit_says_which_hersey_number_of_a_ball_a_column_holds(subtests, written):
    for header, factor, units, expected in [
        ("Hersey number [1/m]", 1.0, {}, "hersey_per_length"),
        ("Hersey number (m^-1)", 1.0, {}, "hersey_per_length"),
        ("Hersey number [1/mm]", 1e-3, {}, "hersey_per_length"),
        ("eta U/F_N [1/m]", 1.0, {}, "hersey_per_length"),
        ("Hersey", 1.0, {"hersey_number": "1/m"}, "hersey_per_length"),
        ("Hersey number [-]", 1.0, {}, "hersey_number"),
        ("eta U R/F_N [-]", 1.0, {}, "hersey_number"),
        ("Hersey", 1.0, {"hersey_number": "1"}, "hersey_number"),
    ]:
        with subtests.test(header=header, factor=factor, units=units, expected=expected):
            found = read(written(header, factor), **units)
            assert found.abscissa == expected
            assert found.values[[0, -1]] == pytest.approx([1e-3, 3.0])


@pytest.mark.quick
def test_the_hersey_number_of_a_cylinder_has_no_unit(written):
    with pytest.raises(sb.InputError, match="divide the force by the length of the cylinder"):
        read(written("Hersey number [1/m]"), "line")


def test_the_roughness_of_a_ball_is_recovered_from_friction_over_its_hersey_number(written):
    start = BALL.replace(roughness="15 um")
    found = sb.fit(read(written("Hersey number [-]", BALL.radius)), start, free=["roughness"], intervals=False)
    assert found.converged and found["roughness"].value == pytest.approx(20e-6, rel=1e-3)


@pytest.mark.quick
def test_a_number_that_is_written_says_what_it_is(subtests, capsys):
    for contact, number in [(LINE, "eta U/F_N"), (BALL, "eta U R/F_N")]:
        with subtests.test(contact=contact, number=number):
            pytest.importorskip("xarray")
            curve = sb.stribeck_curve(contact, speed=[0.5 * contact.speed, contact.speed], rtol=1e-3)
            radius = contact.radius if contact is BALL else 1.0
            expected = contact.viscosity * curve.values * radius / contact.load
            assert curve.hersey_number == pytest.approx(expected, rel=1e-12)
            written = curve.to_dataset()["hersey_number"]
            assert f"{number}:" in written.attrs["long_name"] and written.attrs["units"] == "1"
            np.testing.assert_allclose(written, curve.hersey_number, rtol=1e-14)


@pytest.mark.quick
def test_measurements_over_a_number_per_length_have_its_unit(written):
    pytest.importorskip("xarray")
    assert read(written("Hersey number [1/m]")).to_dataset()["hersey_per_length"].attrs["units"] == "1/m"
