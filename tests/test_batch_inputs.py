"""Batches over arrays of any input: broadcast as NumPy does, or by names of dimensions, and told apart by both."""

import pickle

import numpy as np
import pytest
from fit_data import TRUE as CONTACT

import stribeck as sb

SPEEDS = np.geomspace(1e-3, 1e-2, 3)


@pytest.fixture(scope="module")
def found():
    return sb.solve_batch(CONTACT, speed=SPEEDS, viscosity=[["40 mPa*s"], ["50 mPa*s"]], boundary_friction=0.5)


@pytest.mark.quick
def test_arrays_of_inputs_broadcast_and_each_state_is_that_of_its_contact(found):
    assert found.groups.shape == (2, 3) and found.dims == ("viscosity", "speed") and found.ok.all()
    for i, viscosity in enumerate((0.04, 0.05)):
        contact = CONTACT.replace(viscosity=viscosity, speed=SPEEDS[2], boundary_friction=0.5)
        assert found.contacts[i, 2] == contact
        state = sb.solve(contact)
        for arguments in ({}, {"definition": "published"}, {"boundary_friction": 0.9}):
            one, many = state.friction(**arguments), found.friction(**arguments)
            assert many[i, 2] == pytest.approx(one, rel=2e-6)
            assert many.asperities[i, 2] == pytest.approx(one.asperities, rel=2e-6)
        film = state.minimum_gap * contact.hertz.indentation
        assert found.to_si()["minimum_film_thickness"][i, 2] == pytest.approx(film, rel=2e-6)


def test_a_batch_is_a_dataset_along_its_inputs(found):
    pytest.importorskip("xarray")
    data = found.to_dataset()
    assert dict(data.sizes) == {"viscosity": 2, "speed": 3}
    assert data.speed.dims == ("speed",) and data.speed.units == "m/s"
    np.testing.assert_array_equal(data.friction_balanced.sel(viscosity=0.05), np.asarray(found.friction)[1])
    assert (data.outcome == "CONVERGED").all() and data.central_film_thickness.units == "m"
    assert data.attrs["input_load"] == CONTACT.load and data.attrs["contact_law"] == "exponential"
    assert not {"input_speed", "input_viscosity", "speed_group"} & set(data.attrs)  # which vary


def test_a_batch_shows_itself_draws_and_equals_itself(found):
    figures = pytest.importorskip("matplotlib.figure")
    assert "converged: 6 of 6" in repr(found) and "viscosity 2, speed 3" in repr(found) and "<table>" in found._repr_html_()
    assert pickle.loads(pickle.dumps(found)) == found
    ax = figures.Figure().subplots()
    found.plot(ax=ax)
    assert len(ax.lines) == 2 and ax.get_xlabel() == "speed (m/s)"
    np.testing.assert_array_equal(ax.lines[1].get_ydata(), np.asarray(found.friction)[1])


def test_groups_take_arrays_by_name_and_have_no_scales():
    found = sb.solve_batch(sb.Groups(1e-5, 0.1, 1e-4), speed=[1e-5, 2e-5])
    assert found.dims == ("speed",) and found.contacts is None
    assert found.friction[0] == pytest.approx(sb.solve(sb.Groups(1e-5, 0.1, 1e-4)).friction, rel=2e-6)
    with pytest.raises(sb.InputError, match="give solve_batch a contact"):
        found.to_si()


@pytest.mark.quick
def test_names_of_dimensions_join_arrays():
    xarray = pytest.importorskip("xarray")
    runs, both = (
        xarray.DataArray([1e-3, 2e-3, 3e-3], dims="run"),
        xarray.DataArray(np.full((2, 3), 0.06), dims=("surface", "run")),
    )
    found = sb.solve_batch(CONTACT, speed=runs, beta=both, load=30, rtol=1e-3)
    assert found.dims == ("run", "surface") and found.groups.shape == (3, 2)
    assert [contact.speed for contact in found.contacts[:, 1]] == [1e-3, 2e-3, 3e-3]
    speeds, betas = [[1e-3], [2e-3]], np.full((2, 3), 0.06)
    assert sb.solve_batch(CONTACT, speed=speeds, beta=betas, rtol=1e-3).dims == ("dim_0", "dim_1")
    named = sb.solve_batch(CONTACT, speed=speeds, beta=betas[0], dims=("day", "run"), rtol=1e-3)
    assert named.dims == ("day", "run")


@pytest.mark.quick
def test_what_does_not_fit_is_a_sentence(subtests):
    for inputs, said in [
        ({"speeed": [1]}, "speeed = 1 is not an input of LineContact; did you mean speed"),
        ({"speed": [1, 2], "load": [1, 2, 3]}, r"do not broadcast: speed \(2,\), load \(3,\)\."),
        ({"speed": [1, 2], "dims": ("a", "b")}, "must be 1 names"),
        ({"speed": [1, 2], "dims": "a"}, "must be 1 names"),
        ({"speed": [[1, 2]], "dims": ("a", "a")}, "must be different names"),
        ({"speed": ["1 mm/s", "2 MPa"]}, "is a pressure"),
        ({"speed": [[1], [2, 3]]}, "rows have different lengths"),
    ]:
        with subtests.test(said), pytest.raises(sb.InputError, match=said):
            sb.solve_batch(CONTACT, **inputs)
    with pytest.raises(sb.InputError, match="viscosity is no group"):
        sb.solve_batch(sb.Groups(1e-5, 0.1, 1e-4), viscosity=[1, 2])


@pytest.mark.quick
def test_a_quantity_of_pint_may_be_an_array():
    unit = pytest.importorskip("pint").UnitRegistry()
    found = sb.solve_batch(CONTACT, speed=unit.Quantity([1, 2], "mm/s"), rtol=1e-3)
    assert found.dims == ("speed",) and found.contacts[1].speed == 2e-3
