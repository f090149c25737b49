"""Curves as datasets and files: what is in them, and that a file is written whole or not at all."""

import csv
import io
import os
import re
import resource
import sys

import netCDF4
import numpy as np
import pandas as pd
import pytest
import xarray as xr
from command_line import run_python
from fit_data import TRUE as CONTACT

import stribeck as sb
from stribeck.files import writing
from stribeck.files.datasets import write_csv, write_data, write_netcdf
from stribeck.files.writing import MissingExtraError, atomic_write, check_writable

INPUTS = ("radius", "modulus", "load", "viscosity", "roughness", "alpha", "beta", "boundary_friction")
WRITERS = {".nc": write_netcdf, ".csv": write_csv}


@pytest.fixture(scope="module")
def curve():
    return sb.stribeck_curve(CONTACT, speed=("0.3 mm/s", "0.1 m/s"), points=7)


@pytest.fixture(scope="module")
def dataset(curve):
    return curve.to_dataset().assign_attrs(title="A title")


@pytest.fixture(scope="module")
def dimensionless():
    return sb.stribeck_curve(load=0.1, roughness=1e-3, speed=(1e-3, 1.0), points=4, boundary_friction=0.5, beta=0.1)


# --- what a dataset holds ---


def test_every_variable_has_a_unit_and_a_long_name(dataset):
    for variable in dataset.variables.values():
        assert re.fullmatch(r"1|m|m/s|Pa", variable.attrs["units"]) and len(variable.attrs["long_name"]) > 5
    units = {"speed": "m/s", "central_film_thickness": "m", "hertz_pressure": "Pa"}
    assert {name: dataset[name].attrs["units"] for name in units} == units


def test_a_dataset_holds_every_observable_of_every_point(curve, dataset):
    names = set(curve.solutions[0].to_dict()) & set(dataset)
    assert names >= {
        *("contact_load_share", "fluid_load_share", "central_gap", "minimum_gap", "minimum_position", "flux_gap", "offset"),
        *("lambda_ratio", "hersey_number", "error_estimate", "outcome"),
    }
    for name in names - {"outcome", "regime"}:
        np.testing.assert_allclose(dataset[name], [s.to_dict()[name] for s in curve.solutions], rtol=1e-14)
    for definition in ("published", "balanced"):
        found = [s.friction(definition=definition) for s in curve.solutions]
        for part, column in (("total", ""), ("fluid", "_fluid"), ("error", "_error")):
            np.testing.assert_array_equal(dataset[f"friction_{definition}{column}"], [getattr(f, part) for f in found])
    np.testing.assert_array_equal(dataset.friction, dataset.friction_balanced)
    np.testing.assert_allclose(dataset.friction, dataset.friction_asperities + dataset.friction_fluid, rtol=1e-14)
    assert dataset.regime.values.tolist() == list(curve.regimes)
    assert set(dataset.outcome.values.tolist()) == {"CONVERGED"}
    for name in ("speed", "load", "roughness"):
        np.testing.assert_array_equal(dataset[f"{name}_group"], getattr(curve.groups, name))


def test_the_attributes_of_a_file_suffice_to_solve_its_points_again(dataset):
    inputs = {name: dataset.attrs[f"input_{name}"] for name in INPUTS}
    point = dataset.isel(speed=2)
    again = sb.solve(sb.LineContact(speed=float(point.speed), **inputs), rtol=dataset.attrs["rtol"])
    assert again.friction().total == pytest.approx(float(point.friction), abs=2 * float(point.friction_error))
    assert "viscosity Pa s" in dataset.attrs["input_units"]


def test_the_attributes_tell_settings_landmarks_and_outcome(curve, dataset):
    told = {"title": "A title", "outcome": "Converged.", "complete": 1, "points": 7, "requested_points": 7, "beta": 0.06}
    told |= {"contact_law": "exponential", "definition": "balanced", "boundary_friction": 0.7}
    told |= {"minimum_speed": curve.minimum.value, "minimum_friction": curve.minimum.friction}
    told |= {"load_group": curve.groups.load[0]}
    attributes = dataset.attrs
    assert {name: attributes[name] for name in told} == told and "speed_group" not in attributes
    assert re.fullmatch(r"stribeck \d+\.\d+\.\d+", attributes["source"])
    assert attributes["transition_names"].split("; ") == [mark.name for mark in curve.transitions]
    assert attributes["transition_speed"].tolist() == [mark.value for mark in curve.transitions]
    assert "beyond the range of the exponential contact law" in attributes["notes"]


def test_without_a_contact_the_coordinate_is_a_group_and_nothing_is_in_metres(dimensionless):
    dataset = dimensionless.to_dataset()
    assert dataset.speed.attrs == {"units": "1", "long_name": "speed group, what varies"}
    assert {variable.attrs["units"] for variable in dataset.data_vars.values()} == {"1"}
    assert not [name for name in dataset.attrs if name.startswith("input_")]
    assert (dataset.attrs["boundary_friction"], dataset.attrs["beta"]) == (0.5, 0.1)
    assert dataset.attrs["roughness_group"] == 1e-3


def test_a_curve_without_minimum_says_so_by_nan_and_a_group_that_varies_is_no_attribute_however_small_it_is():
    curve = sb.stribeck_curve(load=0.1, roughness=1e-3, speed=(1.0, 10.0), points=2)
    assert np.isnan(curve.to_dataset().attrs["minimum_speed"])
    attributes = sb.stribeck_curve(load=0.1, roughness=1e-3, speed=(1e-9, 1e-8), points=2).to_dataset().attrs
    assert "speed_group" not in attributes and attributes["load_group"] == 0.1


def test_an_interrupted_curve_is_marked_incomplete(tmp_path):
    def stop(done, total):
        if done == 3:
            raise KeyboardInterrupt

    curve = sb.stribeck_curve(load=0.1, roughness=1e-3, speed=(1e-3, 1.0), points=9, on_point=stop)
    curve.to_netcdf(tmp_path / "curve.nc")
    with xr.open_dataset(tmp_path / "curve.nc", engine="netcdf4") as found:
        assert found.sizes["speed"] == 3
        assert found.attrs["complete"] == 0
        assert found.attrs["requested_points"] == 9
        assert found.attrs["outcome"].startswith("Interrupted")


# --- files ---


def test_netcdf_gives_back_values_units_and_attributes_also_without_xarray(dataset, tmp_path):
    write_netcdf(dataset, tmp_path / "curve.nc")
    with xr.open_dataset(tmp_path / "curve.nc", engine="netcdf4") as found:
        xr.testing.assert_equal(found, dataset)
        assert all(found[name].attrs == variable.attrs for name, variable in dataset.variables.items())
        assert set(found.attrs) == set(dataset.attrs)
        for name, value in dataset.attrs.items():
            np.testing.assert_array_equal(found.attrs[name], value)
    with netCDF4.Dataset(tmp_path / "curve.nc") as file:
        assert (file.data_model, file["speed"].units) == ("NETCDF4", "m/s")
        assert file["friction"][:].tolist() == dataset.friction.values.tolist()


def test_csv_is_read_by_pandas_with_every_digit_below_inputs_and_outcome(dataset, tmp_path):
    write_csv(dataset, tmp_path / "curve.csv")
    table = pd.read_csv(tmp_path / "curve.csv", comment="#")
    assert list(table)[:2] == ["speed [m/s]", "friction [1]"]
    assert len(table.columns) == len(dataset.variables)
    for column in table:
        name, unit = re.fullmatch(r"(\w+) \[(.+)\]", column).groups()
        assert unit == dataset[name].attrs["units"]
        if dataset[name].dtype == object:
            assert table[column].tolist() == dataset[name].values.tolist()
        else:
            np.testing.assert_allclose(table[column], dataset[name], rtol=1e-14)
    lines = (tmp_path / "curve.csv").read_text().splitlines()
    comments = [line for line in lines if line.startswith("#")]
    assert {"# title: A title", "# outcome: Converged.", "# input_radius: 0.01"} <= set(comments)
    assert len(comments) >= len(dataset.attrs)
    rows = csv.DictReader(line for line in lines if not line.startswith("#"))
    assert [float(row["friction [1]"]) for row in rows] == dataset.friction.values.tolist()


def test_csv_stays_readable_whatever_the_title(subtests, dataset, tmp_path):
    path = tmp_path / "curve.csv"
    titles = "", "a, b", 'the "second"', "two\nlines", "\r\n", "\r1,2", "# no comment", "µ, 20 °C", "\x0b\x0c\x85\u2028", "\0"
    for title in titles:
        with subtests.test(title=title):
            write_csv(dataset.assign_attrs(title=title), path, force=True)
            assert len(pd.read_csv(path, comment="#")) == dataset.sizes["speed"]
            rows = [row for row in csv.reader(io.StringIO(path.read_text())) if row and not row[0].startswith("#")]
            assert rows[0][0] == "speed [m/s]"


def test_names_with_the_mark_of_a_comment_keep_their_numbers(tmp_path):
    (tmp_path / "rig.csv").write_text('curve;speed [mm/s];COF\n"run #3";1;0.5\n"#4, wet";2;0.25\n')
    sb.read_measurements(tmp_path / "rig.csv").to_csv(tmp_path / "curves.csv")
    table = pd.read_csv(tmp_path / "curves.csv", comment="#")
    assert table["curve [1]"].tolist() == ["run #3", "#4, wet"]
    assert (table["speed [m/s]"].tolist(), table["friction [1]"].tolist()) == ([0.001, 0.002], [0.5, 0.25])
    assert sb.read_measurements(tmp_path / "curves.csv").curves == ("run #3", "#4, wet")


def test_the_ending_chooses_the_format_and_the_methods_of_a_curve_write_the_same(curve, tmp_path):
    dataset = curve.to_dataset()
    write_data(dataset, tmp_path / "a.NC")
    write_data(dataset, tmp_path / "a.csv")
    curve.to_csv(tmp_path / "one.csv")
    assert (tmp_path / "a.NC").read_bytes()[1:4] == b"HDF"
    assert (tmp_path / "a.csv").read_bytes() == (tmp_path / "one.csv").read_bytes()


# --- whole or not at all ---


def test_an_existing_file_is_kept_unless_forced(subtests, dataset, tmp_path):
    for ending, write in WRITERS.items():
        with subtests.test(ending):
            path = tmp_path / f"curve{ending}"
            path.write_text("precious")
            with pytest.raises(sb.InputError, match=r"curve\.\w+ exists already and is kept; add --force"):
                write(dataset, path)
            assert path.read_text() == "precious"
            write(dataset, path, force=True)
            assert path.stat().st_size > 1000
    assert sorted(os.listdir(tmp_path)) == sorted(f"curve{ending}" for ending in WRITERS)


def test_a_place_that_cannot_be_written_is_refused_beforehand(subtests, tmp_path):
    (tmp_path / "folder.nc").mkdir()
    (tmp_path / "file.nc").touch()
    os.mkfifo(tmp_path / "pipe.nc")
    (tmp_path / "loop.nc").symlink_to(tmp_path / "loop.nc")
    before = sorted(os.listdir(tmp_path))
    for name, words in [
        ("folder.nc", "is a directory"),
        ("missing/curve.nc", "does not exist"),
        ("curve.txt", r"has the ending '\.txt'; the name of this file must end in \.nc or \.csv"),
        ("curve", "has no ending"),
        ("x" * 300 + ".nc", "cannot be looked up"),
        ("pipe.nc", "is not an ordinary file"),
        ("file.nc/curve.nc", "does not exist"),
        ("loop.nc", "cannot be looked up|is not an ordinary file"),
    ]:
        with subtests.test(name=name, words=words):
            with pytest.raises(sb.InputError, match=words):
                check_writable(tmp_path / name, (".nc", ".csv"), force=True)
            assert sorted(os.listdir(tmp_path)) == before


def test_a_folder_without_permission_and_a_protected_file_are_refused_even_when_forced(tmp_path, monkeypatch):
    # Root may write everywhere, so that the refusal of the system is played.
    def refuse(self, exist_ok=True):
        raise PermissionError(13, "Permission denied")

    with monkeypatch.context() as patch:
        patch.setattr("pathlib.Path.touch", refuse)
        with pytest.raises(sb.InputError, match="cannot be written \\(Permission denied\\)"):
            check_writable(tmp_path / "curve.nc", (".nc",))
    (tmp_path / "curve.nc").write_text("precious")
    monkeypatch.setattr("os.access", lambda path, mode: False)
    with pytest.raises(sb.InputError, match="write-protected"):
        check_writable(tmp_path / "curve.nc", (".nc",), force=True)


def test_through_a_link_its_target_is_written_and_the_link_kept(dataset, tmp_path):
    (tmp_path / "data").mkdir()
    (tmp_path / "link.csv").symlink_to(tmp_path / "data" / "curve.csv")
    write_csv(dataset, tmp_path / "link.csv")
    assert (tmp_path / "link.csv").is_symlink()
    assert (tmp_path / "data" / "curve.csv").stat().st_size > 1000


def test_a_failed_write_leaves_the_old_file_and_nothing_else(tmp_path):
    path = tmp_path / "curve.csv"
    path.write_text("precious")
    said = r"could not be written \(No space left on device\); it is unchanged"
    for failure, seen in ((OSError(28, "No space left on device"), sb.InputError), (KeyboardInterrupt(), KeyboardInterrupt)):
        with (
            pytest.raises(seen, match=said if seen is sb.InputError else None),
            atomic_write(path, (".csv",), force=True) as temporary,
        ):
            temporary.write_text("half")
            raise failure
        assert path.read_text() == "precious" and os.listdir(tmp_path) == ["curve.csv"]


def test_a_file_that_appears_meanwhile_is_kept(tmp_path):
    path = tmp_path / "curve.csv"
    with pytest.raises(sb.InputError, match="exists already"), atomic_write(path, (".csv",)) as temporary:
        temporary.write_text("ours")
        path.write_text("theirs")
    assert path.read_text() == "theirs"


def test_a_full_disk_is_not_called_a_lack_of_permission(dataset, tmp_path, monkeypatch):
    """HDF5 says "Permission denied" where a disk takes no more."""

    def denied(self, path, **options):
        monkeypatch.setattr(writing.os, "fsync", full)
        raise PermissionError(13, "Permission denied")

    def full(number):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(xr.Dataset, "to_netcdf", denied)
    with pytest.raises(sb.InputError, match=r"curve\.nc could not be written \(No space left on device\)"):
        write_data(dataset, tmp_path / "curve.nc")
    assert os.listdir(tmp_path) == []
    monkeypatch.undo()
    monkeypatch.setattr(xr.Dataset, "to_netcdf", lambda self, path, **options: os.open("/no/such/file", os.O_RDONLY))
    with pytest.raises(sb.InputError, match=r"curve\.nc could not be written \(No such file or directory\)"):
        write_data(dataset, tmp_path / "curve.nc")
    assert os.listdir(tmp_path) == []


def test_a_pdf_for_which_the_disk_has_no_room_is_refused_in_words(curve, tmp_path):
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (8192, limits[1]))
    try:
        with pytest.raises(sb.InputError, match=r"could not be written \(File too large\); it is unchanged"):
            curve.plot(tmp_path / "curve.pdf")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert os.listdir(tmp_path) == []


@pytest.mark.quick
def test_a_file_is_on_the_disk_before_it_has_its_name_and_its_folder_after(tmp_path, monkeypatch):
    done, fsync, replace = [], os.fsync, os.replace

    def noted_fsync(descriptor):
        done.append(("on the disk", os.fstat(descriptor).st_ino))
        fsync(descriptor)

    def noted_replace(source, target):
        done.append(("named", os.stat(source).st_ino))
        replace(source, target)

    monkeypatch.setattr(os, "fsync", noted_fsync)
    monkeypatch.setattr(os, "replace", noted_replace)
    with atomic_write(tmp_path / "curve.csv", (".csv",)) as temporary:
        temporary.write_text("ours")
    file, folder = (tmp_path / "curve.csv").stat().st_ino, tmp_path.stat().st_ino
    assert done == [("on the disk", file), ("named", file), ("on the disk", folder)]  # else a power cut may lose the name
    assert (tmp_path / "curve.csv").read_text() == "ours"


KILLED = """
import os, signal, sys
import xarray as xr
whole = xr.Dataset.to_netcdf
def half(self, path, **options):
    whole(self, path, **options)
    os.truncate(path, 1000)
    os.kill(os.getpid(), signal.SIGKILL)
xr.Dataset.to_netcdf = half
from stribeck.cli import main
main(sys.argv[1:])
"""


def test_a_kill_while_writing_leaves_no_half_file(tmp_path):
    path = tmp_path / "curve.nc"
    path.write_text("precious")
    tokens = ["curve", "--groups", "0.1", "1e-3", "--range", "0.1", "1", "--points", "2", "-o", path, "--force"]
    assert run_python(KILLED, *tokens).code == -9
    assert path.read_text() == "precious"
    # What the killed process could not take away is hidden and not taken for a result.
    assert all(name == "curve.nc" or name.startswith(".stribeck-") for name in os.listdir(tmp_path))


def test_a_missing_extra_is_one_sentence_with_the_remedy(curve, tmp_path, monkeypatch):
    for library, ask in (("xarray", curve.to_dataset), ("netCDF4", lambda: curve.to_netcdf(tmp_path / "curve.nc"))):
        with monkeypatch.context() as patch:
            patch.setitem(sys.modules, library, None)
            with pytest.raises(ImportError, match=rf"needs {library}; install it with: pip install 'stribeck\[data\]'\.") as e:
                ask()
        assert isinstance(e.value, MissingExtraError) and isinstance(e.value, sb.InputError)
