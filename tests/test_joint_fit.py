"""Fits over several files: what differs between them is read from lines, names and the case, and what each has for itself."""

import dataclasses
import json

import numpy as np
import pytest
from command_line import CONTACT, EXAMPLES, call, toml_of
from fit_data import TRUE, exact, measured

import stribeck as sb

NOISE = 0.02
VALUES = {name: json.loads(value) for name, value in CONTACT.items()}


def write(path, contact, seed, above="", header="speed [m/s];friction", rows=9):
    """Write noisy friction of a contact."""
    speeds, friction = exact(contact, rows=rows)
    friction = friction * np.exp(NOISE * np.random.default_rng(seed).standard_normal(rows))
    lines = [f"{u};{mu}" for u, mu in zip(speeds.tolist(), friction.tolist(), strict=True)]
    path.write_text("\n".join([*filter(None, [above]), header, *lines]))
    return path


def write_case(folder, fit, **tables):
    """Write a case whose table [fit] is given."""
    path = folder / "case.toml"
    path.write_text(toml_of(contact=VALUES, fit=fit, **tables))
    return path


def inputs_of(folder, fit, files, **tables):
    """Return the inputs of the curves of files, by curve."""
    case = sb.load_case(write_case(folder, fit, **tables))
    found = sb.read_measurements([folder / name for name in files], case.fit)
    return dict(zip(found.curves, found.inputs, strict=True))


def test_a_joint_fit_shares_some_inputs_and_each_file_has_others_for_itself(tmp_path, capsys):
    write(tmp_path / "smooth.csv", TRUE.replace(roughness="1 um"), 1)
    write(tmp_path / "rough 60.csv", TRUE.replace(roughness="2 um", load=60.0), 2, "Load: 60 N/m")
    case = write_case(tmp_path, {"free": ["boundary_friction", "roughness"]})
    out, tokens = tmp_path / "fitted.toml", (tmp_path / "*.csv", case, "--per-file", "roughness")
    answer = call(capsys, "fit", *tokens, "--out", out, "--json")
    assert answer.code == 0, answer.err
    found = {(each["name"], each["curve"]): each for each in json.loads(answer.out)["inputs"]}
    assert set(found) == {("boundary_friction", None), ("roughness", "smooth"), ("roughness", "rough 60")}
    true = {("boundary_friction", None): 0.7, ("roughness", "smooth"): 1e-6, ("roughness", "rough 60"): 2e-6}
    for key, value in true.items():
        assert found[key]["value"] == pytest.approx(value, rel=5 * found[key]["standard_error"])
    assert sb.load_case(out).contact.boundary_friction == pytest.approx(found["boundary_friction", None]["value"])
    assert "rough 60" in out.read_text()

    files = [tmp_path / "smooth.csv", tmp_path / "rough 60.csv"]
    data = sb.read_measurements(files, sb.load_case(case).fit)
    assert set(data.to_dataset()["file"].values) == {"rough 60", "smooth"} and "load 60 N/m by row 1" in data.taken


def test_curves_of_one_file_share_what_their_file_has_for_itself(tmp_path):
    twice = measured([1e-3, 1e-2] * 4, [0.5, 0.3] * 4, curve=[0, 0, 1, 1] * 2, curves=("a", "b"), inputs=({}, {"load": 60.0}))
    other = write(tmp_path / "other.csv", TRUE, 3)
    case = sb.load_case(write_case(tmp_path, {"free": ["boundary_friction", "roughness"], "per_file": ["roughness"]}))
    joint = sb.fit([twice, other], case, intervals=False)
    assert joint.data.curves == ("data 1: a", "data 1: b", "other")
    assert [each.label for each in joint.inputs] == ["boundary_friction", "roughness (data 1)", "roughness (other)"]
    assert joint.contacts[0].roughness == joint.contacts[1].roughness != joint.contacts[2].roughness
    known = [each.name for each in joint.inputs[:2] if each.standard_error < 0.5]
    assert known and [*joint.errors] == known  # those of the first curve, whose values the contact has


def test_names_of_files_and_the_case_say_what_differs_and_the_case_counts_most(tmp_path):
    for name in ("a_30_25C.csv", "b_60_40C.csv"):
        write(tmp_path / name, TRUE, 1, "# viscosity = 7 mPa*s")
    tables = {"fluid": {"preset": "water", "temperature": "20 degC"}}
    contact = {name: value for name, value in VALUES.items() if name != "viscosity"}

    def read(fit, tables=tables):
        path = tmp_path / "case.toml"
        path.write_text(toml_of(contact=contact, fit=fit, **tables))
        found = sb.read_measurements(str(tmp_path / "*.csv"), sb.load_case(path).fit)
        return dict(zip(found.curves, found.inputs, strict=True))

    by_name = read({"file_names": "*_{load [N/m]}_{temperature}.csv"})
    assert by_name["a_30_25C"]["load"] == 30.0 and by_name["b_60_40C"]["load"] == 60.0
    assert by_name["a_30_25C"]["viscosity"] == pytest.approx(0.89e-3, rel=0.02)  # of water at 25 degC
    assert by_name["b_60_40C"]["viscosity"] == pytest.approx(0.653e-3, rel=0.02)  # and at 40 degC
    fit = {
        "file_names": "*_{load [N/m]}_{temperature}",
        "files": {"b_60_40C.csv": {"load": 50.0}, "b_*": {"viscosity": "3 mPa*s", "load": 40.0}},
    }
    by_case = read(fit)
    assert by_case["b_60_40C"] == {"load": 50.0, "viscosity": 3e-3}
    assert by_case["a_30_25C"] == by_name["a_30_25C"]
    assert read({})["a_30_25C"] == {"viscosity": 7e-3}  # as its first line says


def test_a_line_counts_only_with_a_unit_and_no_other_line_may_disagree(tmp_path):
    write(tmp_path / "bare.csv", TRUE, 1, "Load: 5")
    write(tmp_path / "two.csv", TRUE, 2, "Load: 5 N/m\nLoad: 6 N/m")
    with pytest.raises(sb.InputError, match="two.csv: rows 1 and 2 give two values of 'load'"):
        inputs_of(tmp_path, {}, ["two.csv"])
    write(tmp_path / "force.csv", TRUE, 3, "Load: 5 N")  # of a cylinder it is per length
    write(tmp_path / "one.csv", TRUE, 4, "Load [N/m]: 5\nTemperature: 25 °C")
    found = inputs_of(tmp_path, {"files": {"two.csv": {"load": 7.0}}}, ["bare.csv", "two.csv", "force.csv", "one.csv"])
    assert found == {"bare": {}, "two": {"load": 7.0}, "force": {}, "one": {"load": 5.0}}


REFUSED = {
    "key of no file": ({"files": {"watr.csv": {"load": 5.0}}}, ("no file is called 'watr.csv'", "'water.csv' has no entry")),
    "name off the pattern": ({"file_names": "{load}_*.csv"}, ("water.csv: the name does not follow file_names",)),
    "name without a unit": ({"file_names": "{load}.csv"}, ("water.csv: ", "load = 'water'")),
    "unknown input": ({"file_names": "{lode}.csv"}, ("lode", "load")),
    "no input": ({"file_names": "*.csv"}, ("names no input",)),
    "temperature of no liquid": ({"files": {"*": {"temperature": "25 degC"}}}, ("temperature = '25 degC' needs a liquid",)),
    "two viscosities": (
        {"files": {"*": {"temperature": "25 degC", "viscosity": "1 mPa*s"}}},
        ("viscosity and temperature are both given",),
    ),
    "unit of another kind": ({"files": {"water.csv": {"load": "5 mm"}}}, ("[fit.files]", "load = '5 mm'")),
    "not free": ({"free": ["beta"], "per_file": ["load"]}, ("per_file has load, which is not in free",)),
    "twice": ({"free": ["beta"], "per_file": ["beta"], "per_curve": ["beta"]}, ("beta in per_curve and in per_file",)),
}


def test_what_cannot_be_meant_is_refused_with_the_file(subtests, tmp_path):
    write(tmp_path / "water.csv", TRUE, 1)
    for name, (fit, said) in REFUSED.items():
        with subtests.test(name), pytest.raises(sb.InputError) as refused:
            inputs_of(tmp_path, fit, ["water.csv"])
        assert all(each in str(refused.value) for each in said), str(refused.value)


def test_files_that_do_not_go_together_are_refused(tmp_path):
    plain = write(tmp_path / "plain.csv", TRUE, 1)
    hersey = write(tmp_path / "hersey.csv", TRUE, 2, header="Hersey number;friction")
    known = measured(*exact(rows=8), error=0.01)
    with pytest.raises(sb.InputError, match="over speed, and .*hersey.csv over hersey number"):
        sb.read_measurements([plain, hersey])
    with pytest.raises(sb.InputError, match="plain.csv has no errors of friction"):
        sb.fit([plain, known], TRUE)
    with pytest.raises(sb.InputError, match="data is empty"):
        sb.fit([], TRUE)


def test_a_file_counts_once_and_a_copy_of_it_is_named(tmp_path):
    plain = write(tmp_path / "plain.csv", TRUE, 1)
    assert len(sb.read_measurements([plain, str(tmp_path / "*.csv")])) == 9
    copy = tmp_path / "copy.csv"
    copy.write_text(plain.read_text())
    both = sb.read_measurements([plain, copy])
    assert len(both) == 18 and any("copy holds the same rows as plain" in note for note in both.notes)


def test_files_without_errors_take_those_of_the_case_beside_files_with_them():
    with_errors, without = (measured([1e-3, 1e-2], [0.5, 0.3], error) for error in (0.02, None))
    settings = sb.load_case(EXAMPLES / "pdms_cylinder.toml").fit
    with pytest.raises(sb.InputError, match="has no errors of friction, and .* has; give relative_error or absolute_error"):
        sb.read_measurements([with_errors, without], settings)
    both = sb.read_measurements([with_errors, without], dataclasses.replace(settings, relative_error=0.1, absolute_error=0.04))
    assert both.error == pytest.approx([0.02, 0.02, np.hypot(0.05, 0.04), np.hypot(0.03, 0.04)])
    assert both.to_dataset()["error"].values == pytest.approx(both.error)
