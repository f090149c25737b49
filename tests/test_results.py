"""What results have in common: they show themselves in a screen, are equal by value, draw into axes, have one friction."""

import copy
import json
import pickle

import numpy as np
import pytest
from command_line import EXAMPLES, PDMS, call
from fit_data import TRUE as CONTACT
from fit_data import noisy

import stribeck as sb
from stribeck.asperity_friction import ShearStress


@pytest.fixture(scope="module")
def state():
    return sb.solve(CONTACT)


@pytest.fixture(scope="module")
def curve():
    return sb.stribeck_curve(CONTACT, points=17)


@pytest.mark.quick
def test_a_result_shows_itself_in_a_screen(state, curve):
    for result in (state, curve):
        text = repr(result)
        assert 5 < len(text.splitlines()) < 25 and len(text) < 2500
        assert text.startswith(f"{type(result).__name__}: ")
        assert f"estimated error: {result.error_estimate:.1e}" in text and "(rtol 1e-06)" in text
    text = repr(state)
    assert text.startswith("Solution: mixed lubrication\n") and state.regime == "mixed"
    assert f"friction coefficient, balanced: {state.friction:.4g} ± " in text and "702.2 nm" in text
    assert curve.minimum.name in repr(curve) and f"{curve.minimum.friction:.4g} at speed 27.6 mm/s" in repr(curve)
    assert all(note in repr(curve) for note in curve.notes)


PARTS = {
    "fluid": sb.fluids.Carreau("1 ms", 0.6),
    "cavitation": "reform",
    "cavity_pressure": "-80 kPa",
    "solid": sb.solids.Layer("1 mm", 0.5),
    "slide_to_roll": 0.7,
}


def test_a_contact_a_state_and_a_curve_name_fluid_cavitation_solid_and_motion():
    contact = CONTACT.replace(**PARTS)
    said = (
        "fluid carreau, relaxation time 1 ms, exponent 0.6, infinite viscosity 0 Pa*s, solid bonded layer, "
        "layer thickness 1 mm, poisson ratio 0.5, cavitation reform, cavity pressure -80 kPa, slide to roll 0.7"
    )
    curve = sb.stribeck_curve(contact, speed=(contact.speed, 1.5 * contact.speed), points=3, rtol=1e-3)
    for result in (sb.solve(contact), curve, contact):
        assert f"model</th><td style='text-align:left'>{said}<" in result._repr_html_()
        assert result is contact or f"model: {said}\n" in repr(result)
    names = {"LineContact": sb.LineContact, "Fluid": sb.fluids.Fluid, "Carreau": sb.fluids.Carreau, "Layer": sb.solids.Layer}
    assert eval(repr(contact), names) == contact and eval(repr(CONTACT), names) == CONTACT
    assert "parts" not in repr(CONTACT) and "cavitation" not in repr(CONTACT)


def test_a_state_of_groups_names_its_parts_in_hertz_units():
    found = sb.solve(sb.Groups(speed=3e-4, load=0.1, roughness=1e-3), fluid=sb.fluids.Barus(0.3), cavitation="exit")
    said = "fluid newtonian + barus, pressure coefficient 0.3, solid half-plane, cavitation exit (Hertz units)"
    assert f"model: {said}\n" in repr(found)


def test_a_state_says_the_error_of_its_friction_where_that_is_the_larger():
    state = sb.solve(CONTACT.replace(speed=0.003))
    friction = sb.results.Friction(asperities=0.1, fluid=0.2, total=0.3, error=0.003)
    assert friction.relative_error == pytest.approx(0.01, rel=1e-15) and state.friction.relative_error < state.error_estimate
    assert sb.results.Friction(asperities=-0.1, fluid=-0.2, total=-0.3, error=0.003).relative_error == friction.relative_error
    fast = sb.solve(CONTACT, fluid=PARTS["fluid"])
    assert fast.friction.relative_error > fast.error_estimate
    assert f"of the friction {fast.friction.relative_error:.1e} (rtol 1e-06)" in repr(fast)
    assert "of the friction" not in repr(state)


def test_a_notebook_gets_a_table_in_which_no_text_is_code(state, curve):
    for result in (state, curve):
        html = result._repr_html_()
        assert html.count("<tr>") == html.count("</tr>") > 5
    named = sb.contact_laws.FunctionLaw(lambda s: -s, lambda s: -np.ones_like(s), name="<script>")
    odd = sb.solve(CONTACT, law=named, rtol=1e-3)._repr_html_()
    assert "<script>" not in odd and "&lt;script&gt;" in odd
    assert "50 mPa·s" in CONTACT._repr_html_() and "effective modulus" in CONTACT._repr_html_()
    assert CONTACT.to_si()["viscosity"] == 0.05 and sb.LineContact(**CONTACT.to_si()) == CONTACT


@pytest.mark.quick
def test_a_result_equals_itself_after_pickling_and_no_other(state, curve):
    law = sb.surfaces.persson_law(sb.surfaces.SelfAffine(h_rms=1e-6, q0=1e4, q1=1e7, hurst=0.8))
    contact, profile = CONTACT.replace(law=law), state.profile([0.0, 0.5])
    for each, another in (
        (state, sb.solve(CONTACT.replace(speed="1.001 mm/s"))),
        (profile, state.profile([0.0, 0.6])),
        (curve, sb.stribeck_curve(CONTACT, points=16)),
        (contact, CONTACT.replace(law=law.scaled(2e-6))),
    ):
        assert pickle.loads(pickle.dumps(each)) == each != another and each != "state"
    assert state == sb.solve(CONTACT) and hash(pickle.loads(pickle.dumps(state))) == hash(state)


@pytest.mark.quick
def test_friction_means_the_same_on_state_and_curve(state, curve):
    on_curve = sb.stribeck_curve(CONTACT, speed=[1e-3, 2e-3]).friction
    assert float(state.friction) == state.friction.total == state.friction.asperities + state.friction.fluid
    assert on_curve[0] == pytest.approx(state.friction, rel=2e-6)
    for arguments in ({}, {"boundary_friction": 0.3}, {"definition": "published"}, {"beta": 0.1}):
        one, many = state.friction(**arguments), on_curve(**arguments)
        for part in ("asperities", "fluid", "total"):
            assert getattr(many, part)[0] == pytest.approx(getattr(one, part), rel=2e-6)
    assert state.friction(0.3)(definition="published").fluid == state.friction(definition="published").fluid
    np.testing.assert_array_equal(curve.friction, curve.friction.asperities + curve.friction.fluid)
    assert type(curve.friction * 2) is type(curve.friction[1:]) is np.ndarray and type(curve.friction.min()) is np.float64
    with pytest.raises(sb.InputError, match="definition"):
        _ = curve.friction(definition="paper")


def test_friction_that_is_copied_or_comes_from_another_process_has_its_parts_and_errors(state, curve):
    for copied in (lambda each: pickle.loads(pickle.dumps(each)), copy.deepcopy, copy.copy):
        for known in (curve.friction, state.friction, copied(curve).friction):
            again = copied(known)
            for part in ("total", "asperities", "fluid", "error"):
                np.testing.assert_array_equal(getattr(again, part), getattr(known, part))
            np.testing.assert_array_equal(again(beta=0.1), known(beta=0.1))
    assert type(pickle.loads(pickle.dumps(curve.friction.copy()))) is np.ndarray


def test_a_state_and_a_curve_are_in_si_units(state, curve):
    pytest.importorskip("xarray")
    data = state.to_dataset()
    np.testing.assert_array_equal(data.gap, state.to_si().gap)
    assert (data.gap.units, data.x.units, data.fluid_pressure.units) == ("m", "m", "Pa")
    assert data.friction_balanced == state.friction.total and data.friction_balanced_error == state.friction.error
    assert sb.solve(state.groups).to_dataset().gap.units == "u_Hz"
    films = curve.observable("central_gap") * CONTACT.hertz.indentation
    np.testing.assert_allclose(curve.to_si()["central_film_thickness"], films, rtol=1e-15)
    places = curve.observable("minimum_position") * CONTACT.hertz.half_width
    np.testing.assert_allclose(curve.to_dataset().minimum_film_position, places, rtol=1e-14)
    with pytest.raises(sb.InputError, match="to_si needs the Hertz scales"):
        sb.stribeck_curve(load=0.1, roughness=1e-4, speed=[1e-4, 2e-4]).to_si()


def test_a_state_and_a_curve_are_ready_for_json(state, curve):
    smooth = sb.solve(sb.Groups(1e-3, 0.1, 0))
    seal = sb.load_case(EXAMPLES / "rod_seal.toml").contact.replace(asperity_friction=ShearStress("0.2 MPa"))
    sheared = sb.stribeck_curve(seal, speed=["1 mm/s", "10 mm/s"])
    for each in (state, curve, smooth, sheared):
        assert set(json.loads(json.dumps(each.to_dict(), allow_nan=False))) == set(each.to_dict())
    assert smooth.to_dict()["lambda_ratio"] is sheared.to_dict()["boundary_friction"] is None
    points, units = (json.loads(json.dumps(curve.to_dict()))[name] for name in ("points", "units"))
    numbers = {name for name in points if isinstance(points[name][0], float) and not name.endswith("_error")} - {"value"}
    assert numbers <= set(units) and units["hertz_pressure"] == state.to_dict()["units"]["hertz_pressure"] == "Pa"
    assert points["value"] == curve.values.tolist() and points["friction"] == curve.friction.tolist()


def test_an_error_is_absolute_and_in_the_unit_of_its_number(state, curve):
    pytest.importorskip("xarray")
    for data in (state.to_dataset(), curve.to_dataset()):
        numbers = [name for name in data.data_vars if f"{name}_error" in data]
        assert {"friction_balanced", "contact_load_share", "central_gap", "minimum_film_thickness", "offset"} <= {*numbers}
        for name in numbers:
            error = data[f"{name}_error"]
            assert error.units == data[name].units and error.long_name.startswith("estimated absolute error of ")
        of_gap, of_film = data.central_gap_error * CONTACT.hertz.indentation, data.central_film_thickness_error
        np.testing.assert_allclose(of_gap, of_film, rtol=1e-12)
    batch = sb.solve_batch(CONTACT, speed=[CONTACT.speed, 2 * CONTACT.speed]).to_dataset()
    relative = batch.central_gap_error / batch.central_gap
    assert batch.central_gap_error.units == batch.central_gap.units and (0 < relative).all() and (relative < 1e-6).all()
    assert state.to_dict()["central_gap_error"] == pytest.approx(state.errors["central_gap"] * state.central_gap, rel=1e-12)


@pytest.mark.quick
def test_a_quantity_of_pint_is_an_input():
    pint = pytest.importorskip("pint")
    unit = pint.UnitRegistry()
    given = {
        "radius": unit.Quantity(10, "mm"),
        "modulus": 2.7 * unit.newton / unit.mm**2,
        "viscosity": 50 * unit.mPa * unit.s,
        "alpha": 2 * unit.dimensionless,
        "roughness": 1 * unit.um,
    }
    assert CONTACT.replace(**given) == CONTACT
    ends = sb.stribeck_curve(CONTACT, speed=(1 * unit.mm / unit.s, 2 * unit.mm / unit.s), points=2, rtol=1e-3).values
    assert ends == pytest.approx([1e-3, 2e-3])
    spreads = [
        sb.propagate(CONTACT, {"roughness": error}, transitions=False)["friction"] for error in (0.1 * unit.um, "0.1 um")
    ]
    assert spreads[0] == spreads[1]
    for wrong, said in (
        (50 * unit.N, "is a force"),
        (unit.Quantity([1, 2], "N/m"), "is not a single real number"),
        (float("nan") * unit.N / unit.m, "not a finite number"),
    ):
        with pytest.raises(sb.InputError, match=said):
            CONTACT.replace(load=wrong)


def test_an_attribute_that_is_misspelled_is_answered_with_the_nearest(state):
    with pytest.raises(AttributeError) as caught:
        state.minimum_gpa  # noqa: B018
    assert (caught.value.name, caught.value.obj) == ("minimum_gpa", state)  # of which Python makes "Did you mean"
    for package, name, meant in ((sb, "stribek_curve", "stribeck_curve"), (sb.fluids, "Carreu", "Carreau")):
        with pytest.raises(AttributeError, match=f"no attribute '{name}'; did you mean {meant}"):
            getattr(package, name)
    with pytest.raises(KeyError, match="did you mean glycerol-water"):
        sb.fluids.PRESETS["glycerine"]


def test_what_fails_in_a_property_of_a_result_is_not_hidden_as_an_unknown_name(state, curve, monkeypatch):
    many = sb.solve_batch(CONTACT, speed=["1 mm/s", "2 mm/s"], rtol=1e-3)
    results = (state, "regime"), (curve.solutions[3], "regime"), (curve.at(CONTACT.speed), "errors"), (many, "ok")
    for result, name in (*results, (CONTACT, "hertz")):
        with pytest.raises(AttributeError, match=f"{type(result).__name__}.* has no attribute 'no_such_thing'"):
            result.no_such_thing  # noqa: B018
        monkeypatch.setattr(type(result), name, property(lambda self: self.a_number.no_such_thing))
        monkeypatch.setattr(type(result), "a_number", 1.0, raising=False)
        with pytest.raises(AttributeError, match="'float' object has no attribute 'no_such_thing'"):
            getattr(result, name)


def test_the_words_of_the_regimes_command_are_there_in_python(capsys):
    answer = call(capsys, "regimes", PDMS, "-v")
    found = sb.explain(sb.load_case(PDMS))
    assert answer.code == 0 and str(found).split() == answer.out.split()
    assert repr(found) == str(found) and "<pre" in found._repr_html_()
    assert "Mixed lubrication at 1 mm/s" in sb.explain(CONTACT)
    with pytest.raises(sb.InputError, match="give a contact"):
        sb.explain("pdms_cylinder.toml")


@pytest.mark.quick
def test_a_keyword_that_is_misspelled_is_answered_with_the_nearest(state):
    for ask, said in (
        (lambda: sb.solve(CONTACT, rtoll=1e-6), "did you mean rtol"),
        (lambda: sb.stribeck_curve(CONTACT, pionts=5), "did you mean points"),
        (lambda: state.friction(bta=1), "[dD]id you mean '?beta"),  # from Python 3.13 on in its own words
        (lambda: CONTACT.replace(viscositty=1), "did you mean viscosity"),
        (lambda: sb.sweep("sweep.toml", "store", worker=2), "did you mean workers"),
        (lambda: sb.compare(noisy(seed=1), CONTACT, lawss={}), "did you mean laws"),
        (lambda: sb.explain(CONTACT, defintion="balanced"), "did you mean definition"),
        (lambda: sb.new_case(geometri="line"), "did you mean geometry"),
        (lambda: sb.propagate(CONTACT, {"rougness": 0.1}), "did you mean roughness"),
        (lambda: sb.solve(CONTACT, zzz=1), "it takes problem, rtol, law, on_failure"),
    ):
        with pytest.raises((TypeError, sb.InputError), match=said):
            ask()


def test_what_is_measured_or_checked_shows_itself_in_a_screen():
    surface = sb.surfaces.analyse(sb.surfaces.read_topography(EXAMPLES / "cylinder_profile.csv"))
    measured = sb.read_measurements(EXAMPLES / "pdms_measured.csv")
    profile, spread = (
        sb.solve(CONTACT).profile(np.linspace(-3, 3, 500)),
        sb.propagate(CONTACT, {"roughness": 0.1}, transitions=False),
    )
    checks = sb.check(CONTACT.replace(roughness=0))
    for each in (surface, surface.measured, measured, checks, profile, spread):
        assert len(repr(each).splitlines()) < 25 and len(repr(each)) < 2500 and "<table" in each._repr_html_()
    assert "friction: 42 values, 0." in repr(measured) and "wavenumber: " in repr(surface.measured)
    ax = pytest.importorskip("matplotlib.figure").Figure().subplots()
    surface.plot(ax=ax)
    assert ax.lines and "height" in ax.get_ylabel()
    assert checks["shear rate"].texts[1] != "inf 1/s"


def table(path):
    """Return the names of the columns of a CSV file, without their units, and its rows."""
    names, *rows = [line.split(",") for line in path.read_text().splitlines() if not line.startswith("#")]
    return [name.partition(" ")[0] for name in names], rows


def test_results_write_a_table_with_a_row_for_each_state(state, tmp_path):
    batch = sb.solve_batch(sb.Groups(1e-5, 0.1, 1e-4), speed=[[1e-5], [2e-5]], load=[0.1, 0.2])
    state.to_csv(tmp_path / "state.csv")
    names, rows = table(tmp_path / "state.csv")
    assert names[:2] == ["x", "gap"]
    np.testing.assert_array_equal([float(row[1]) for row in rows], state.to_si().gap)
    batch.to_csv(tmp_path / "batch.csv")
    names, rows = table(tmp_path / "batch.csv")
    assert names[:2] == list(batch.dims) and len(rows) == 4
    sb.solve_batch(sb.Groups(1e-5, 0.1, 1e-4), speed=[1e-5, 2e-5], load=[0.1, 0.2]).to_csv(tmp_path / "row.csv")
    names, rows = table(tmp_path / "row.csv")
    inputs = [[float(row[names.index(name)]) for name in ("speed", "load")] for row in rows]
    assert inputs == [[1e-5, 0.1], [2e-5, 0.2]]


def test_a_batch_of_no_states_is_not_written(tmp_path):
    empty = sb.solve_batch(sb.Groups(1e-5, 0.1, 1e-4), speed=np.array([]))
    assert empty.central_gap.shape == (0,)
    with pytest.raises(sb.InputError, match="There are no states, as an array of speed is empty"):
        empty.to_csv(tmp_path / "batch.csv")
    assert list(tmp_path.iterdir()) == []


def test_a_fit_shows_itself_and_is_a_dataset():
    xarray = pytest.importorskip("xarray")
    found = sb.fit(noisy(seed=5_417, rows=8), CONTACT, free=["boundary_friction", "viscosity"], intervals=False)
    assert repr(found).startswith("Fit: The fit converged.") and len(repr(found).splitlines()) < 20
    assert "boundary_friction" in found._repr_html_() and found.to_si()["viscosity"] == found["viscosity"].value
    data = found.to_dataset()
    assert isinstance(data, xarray.Dataset) and data.speed.units == "m/s"
    assert data.attrs["definition"] == "balanced" and data.attrs["notes"] == "\n".join(found.notes)
    assert found["viscosity"].unit == sb.solve(CONTACT).to_dict()["units"]["viscosity"] == "Pa s"
    np.testing.assert_array_equal(data.fitted_friction, found.friction)


def test_a_sweep_shows_itself_and_draws(tmp_path):
    figures = pytest.importorskip("matplotlib.figure")
    (tmp_path / "sweep.toml").write_text("[groups]\nload = 0.1\nroughness = 1e-4\n[vary]\nspeed = [1e-5, 1e-4]\n")
    found = sb.sweep(tmp_path / "sweep.toml", tmp_path / "store")
    assert "2 of 2 states are finished" in repr(found) and sb.open_sweep(tmp_path / "store") != "store"
    ax = figures.Figure().subplots()
    found.plot(ax=ax)
    assert ax.lines[0].get_xdata().tolist() == pytest.approx([1e-5, 1e-4]) and ax.get_xlabel().startswith("speed")


def test_films_and_the_largest_pressure_of_a_contact_are_in_si_units():
    for name in ("pdms_cylinder", "pdms_ball"):
        contact = sb.load_case(EXAMPLES / f"{name}.toml").contact
        state, groups = (sb.solve(each, rtol=1e-3) for each in (contact, contact.groups))
        assert state.central_film_thickness == pytest.approx(state.central_gap * contact.hertz.indentation)
        assert state.minimum_film_thickness == pytest.approx(state.minimum_gap * contact.hertz.indentation)
        assert 0 < state.minimum_film_thickness <= state.central_film_thickness
        # Hertz's pressure is that of a dry smooth contact, to which films add and from which they take a little.
        assert 0.5 < state.maximum_pressure / contact.hertz.pressure < 1.5
        for attribute in ("central_film_thickness", "minimum_film_thickness", "maximum_pressure"):
            with pytest.raises(sb.InputError, match=f"{attribute} is in SI units, but this state was solved from groups"):
                getattr(groups, attribute)


def test_a_curve_and_its_minimum_have_the_inputs_by_name():
    for method in ("atlas", "solver"):
        curve = sb.stribeck_curve(CONTACT, speed=("1 mm/s", "1 m/s"), points=7, method=method)
        np.testing.assert_array_equal(curve.speed, curve.values)
        assert set(curve.load) == {CONTACT.load} and set(curve.roughness) == {CONTACT.roughness}
        assert curve.minimum.speed == curve.minimum.value
        with pytest.raises(AttributeError, match="over speed"):
            _ = curve.minimum.load
        over = sb.stribeck_curve(CONTACT, roughness=("0.3 um", "3 um"), points=3, method=method)
        np.testing.assert_array_equal(over.roughness, over.values)
