"""Temperature as an axis of a sweep: each state has the viscosity of its liquid there, and the table is read back."""

import csv

import numpy as np
import pytest
from scipy.interpolate import RegularGridInterpolator

import stribeck as sb

CONTACT = (
    '[contact]\nradius = "10 mm"\nmodulus = "2.7 MPa"\nroughness = "1 um"\nalpha = 2.0\nbeta = 0.06\nboundary_friction = 0.7\n'
)
OIL = '[fluid]\npreset = "iso-vg"\ngrade = 46\n'
VARY = '[vary]\nspeed = { range = ["1 mm/s", "10 mm/s"], points = 4 }\nload = ["15 N/m", "22 N/m", "30 N/m", "45 N/m"]\n'


def sweep_file(folder, vary='temperature = ["20 degC", "313.15 K", 60, 80]', fluid=OIL, contact=CONTACT):
    path = folder / "table.toml"
    path.write_text(f"{contact}{fluid}{VARY}{vary}\n[solver]\nrtol = 1e-4\n")
    return path


def test_each_state_is_solved_with_the_liquid_at_its_temperature(tmp_path):
    found = sb.sweep(sweep_file(tmp_path), tmp_path / "s.sqlite")
    data = found.to_dataset()
    assert data.friction_balanced.dims == ("speed", "load", "temperature") and data.temperature.attrs["units"] == "degC"
    assert data.temperature.values == pytest.approx([20, 40, 60, 80], rel=1e-12)
    for T in (20.0, 60.0):
        state = data.sel(load=30.0, temperature=T).isel(speed=2)
        liquid = sb.fluids.iso_vg(46, temperature=T)
        assert state.viscosity == pytest.approx(liquid.viscosity, rel=1e-12, abs=0)
        contact = sb.LineContact(
            radius="10 mm", modulus="2.7 MPa", roughness="1 um", alpha=2.0, beta=0.06, boundary_friction=0.7, load=30.0,
            speed=float(state.speed), **liquid.inputs,
        )  # fmt: skip
        assert state.friction_balanced == pytest.approx(sb.solve(contact).friction().total, rel=2e-4, abs=0)


def test_the_table_as_csv_interpolates_between_its_temperatures(tmp_path):
    vary = 'temperature = { range = ["20 degC", "80 degC"], points = 5 }'
    found = sb.sweep(sweep_file(tmp_path, vary), tmp_path / "s.sqlite")
    found.to_csv(tmp_path / "table.csv")
    with (tmp_path / "table.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    names = "speed [m/s]", "load [N/m]", "temperature [degC]"
    axes = [np.unique([float(row[name]) for row in rows]) for name in names]
    friction = np.reshape([float(row["friction_balanced [1]"]) for row in rows], [axis.size for axis in axes])
    table = RegularGridInterpolator((np.log(axes[0]), np.log(axes[1]), axes[2]), np.log(friction), method="cubic")
    liquid = sb.fluids.iso_vg(46, temperature=50)
    contact = sb.LineContact(
        radius="10 mm", modulus="2.7 MPa", roughness="1 um", alpha=2.0, beta=0.06, boundary_friction=0.7, load=25.0,
        speed=4e-3, **liquid.inputs,
    )  # fmt: skip
    read = np.exp(table((np.log(4e-3), np.log(25.0), 50.0)))
    assert read == pytest.approx(sb.solve(contact).friction().total, rel=1e-2, abs=0)


def test_the_liquids_that_know_their_temperature_have_the_same_laws_at_all(subtests):
    for name, preset in sb.fluids.PRESETS.items():
        if "temperature" in preset.conditions:
            with subtests.test(name=name):
                assert preset(temperature=30).fluid == preset(temperature=60).fluid


def test_a_range_of_temperatures_is_even(tmp_path):
    design = sb.load_sweep(sweep_file(tmp_path, 'temperature = { range = ["-10 degC", "50 degC"], points = 4 }'))
    assert np.unique(design.inputs["temperature"]) == pytest.approx([-10, 10, 30, 50], rel=1e-12)


def test_a_temperature_without_a_liquid_that_knows_it_is_refused(subtests, tmp_path):
    bare = CONTACT + 'viscosity = "50 mPa*s"\n'
    for options, words in (
        ({"fluid": "", "contact": bare}, r"add \[fluid\] preset = .*'iso-vg'"),
        ({"vary": 'temperature = [20, 40]\nviscosity = ["1 mPa*s", "2 mPa*s"]'}, "viscosity follows from temperature"),
        ({"fluid": OIL + 'temperature = "40 degC"\n'}, "also stands in"),
        ({"vary": 'temperature = ["20 bar"]'}, "write it as '25 degC'"),
        ({"vary": "temperature = [500]"}, "must lie between"),
    ):
        with subtests.test(words=words), pytest.raises(sb.InputError, match=words):
            sb.load_sweep(sweep_file(tmp_path, **options))
