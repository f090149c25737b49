"""Sweeps over cylinders and balls with another fluid, cavitation, solid and motion."""

import re

import numpy as np
import pytest
from sweep_files import write

import stribeck as sb

TEXT = """
[contact]
radius = "10 mm"
modulus = "2.1 MPa"
viscosity = "50 mPa*s"
roughness = "1 um"
alpha = 2.0
beta = 0.06
boundary_friction = 0.8
slide_to_roll = 1.0

[vary]
load = ["20 N/m", "50 N/m"]
speed = ["5 mm/s", "20 mm/s"]

[fluid]
model = "carreau"
relaxation_time = "1 ms"
exponent = 0.5

[cavitation]
model = "exit"

[solid]
layer_thickness = "5 mm"
"""


def case_of(text, **fixed):
    """Return a sweep file as a case file, with numbers in the place of what varies."""
    numbers = "".join(f"{name} = {value}\n" for name, value in fixed.items())
    return re.sub(r"\[vary\]\n(?:.+\n)+", "", text).replace("[contact]\n", f"[contact]\n{numbers}", 1)


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    """Return the dataset of the sweep, and its store."""
    folder = tmp_path_factory.mktemp("sweep")
    sweep = sb.sweep(write(folder, TEXT), folder / "store")
    write(folder, case_of(TEXT, load='"20 N/m"', entrainment_speed='"1 mm/s"'), "case.toml")
    assert sweep.outcomes == {"CONVERGED": 4}
    return sweep.to_dataset(grid=False), folder


def test_each_state_is_that_of_a_contact_with_the_same_parts(found):
    table, folder = found
    base = sb.load_case(folder / "case.toml").contact
    for i in (0, 3):
        contact = base.replace(load=float(table["load"][i]), speed=float(table["speed"][i]))
        assert (contact.cavitation, contact.slide_to_roll, contact.solid) == ("exit", 1.0, sb.solids.Layer("5 mm"))
        alone = sb.solve(contact)
        for name in ("central_gap", "contact_load_share", "exit_position"):
            assert float(table[name][i]) == pytest.approx(getattr(alone, name), rel=3e-6)
        assert float(table["film_exit_position"][i]) == pytest.approx(alone.exit_position * contact.hertz.half_width, rel=3e-6)
        assert float(table["friction_balanced"][i]) == pytest.approx(alone.friction().total, rel=3e-6)


@pytest.mark.quick
def test_another_fluid_is_another_sweep(found):
    _, folder = found
    with pytest.raises(sb.InputError, match="contains a different sweep"):
        sb.sweep(write(folder, TEXT.replace('"1 ms"', '"2 ms"'), "other.toml"), folder / "store")


@pytest.mark.quick
def test_what_is_wrong_with_a_table_is_told_with_its_name(tmp_path):
    text = "[groups]\nload = 0.1\nroughness = 1e-3\n[vary]\nspeed = [1e-3, 1e-4]\n[cavitation]\nmodel = 'exit'\n"
    for wrong, said in (
        (text, r"other fluids, solids and motions in SI units; give \[contact\]"),
        (TEXT.replace("exponent = 0.5", "exponent = 2.5"), r"\[fluid\] exponent"),
    ):
        with pytest.raises(sb.InputError, match=said):
            sb.load_sweep(write(tmp_path, wrong))


def test_films_that_form_anew_have_the_columns_of_both_ends(tmp_path):
    text = TEXT.replace('model = "exit"', 'model = "reform"\ncavity_pressure = "-1 kPa"').replace('"5 mm/s", ', "")
    table = sb.sweep(write(tmp_path, text), tmp_path / "store").to_dataset(grid=False)
    assert np.isfinite(table["exit_position"].values).all()
    assert (table["reformation_position"].values > table["exit_position"].values).all()


BALL = """
[contact]
geometry = "point"
radius = "9.5 mm"
modulus = "1.6 MPa"
viscosity = "50 mPa*s"
entrainment_speed = "10 mm/s"
roughness = "0.4 um"
alpha = 2.0
beta = 0.05
boundary_friction = 0.7
slide_to_roll = 0.5

[vary]
load = ["0.5 N", "1.3 N"]

[fluid]
model = "carreau"
relaxation_time = "1 ms"
exponent = 0.5

[solver]
rtol = 1e-2
"""


@pytest.mark.slow
def test_balls_have_the_fluid_of_their_load(tmp_path):
    """In Hertz units a relaxation time is another at each load."""
    table = sb.sweep(write(tmp_path, BALL), tmp_path / "store").to_dataset(grid=False)
    contact = sb.load_case(write(tmp_path, case_of(BALL, load='"1 N"'), "case.toml")).contact
    for i in range(2):
        alone = sb.solve(contact.replace(load=float(table["load"][i])), rtol=1e-2)
        for name in ("central_gap", "contact_load_share"):
            assert float(table[name][i]) == pytest.approx(getattr(alone, name), rel=2e-2)
        assert float(table["friction_balanced"][i]) == pytest.approx(alone.friction.total, rel=2e-2)
