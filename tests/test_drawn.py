"""What every result does alike: it draws itself, into axes too, and becomes a dataset that files keep."""

import numpy as np
import pytest
from command_line import EXAMPLES
from fit_data import noisy
from matplotlib.figure import Figure

import stribeck as sb

ALONG = np.linspace(-2.0, 2.0, 41)


@pytest.fixture(scope="module")
def results():
    contact = sb.load_case(EXAMPLES / "pdms_cylinder.toml").contact
    ball = sb.solve(sb.load_case(EXAMPLES / "rubber_ball.toml").contact, rtol=1e-2)
    data = noisy(7, rows=8)
    fit = sb.fit(data, contact, free=("boundary_friction",), intervals=False)
    state, rows = sb.solve(contact), np.linspace(0.05, 12.0, 60)
    return {
        "solution": state,
        "profile in SI units": state.to_si(),
        "profile in Hertz units": state.profile(ALONG),
        "ball": ball,
        "field in Hertz units": ball.field(ALONG, ALONG[:, None]),
        "field in SI units": ball.to_si(1e-3 * ALONG, 1e-3 * ALONG[:30, None]),
        "curve": sb.stribeck_curve(contact, points=5, rtol=1e-4),
        "batch": sb.solve_batch(contact, speed=[1e-4, 1e-2, 1.0]),
        "checks": sb.check(contact),
        "uncertainty": sb.propagate(contact, {"roughness": 0.2}, transitions=False),
        "measurements": data,
        "fit": fit,
        "comparison": sb.compare(
            data,
            fit.contact,
            free=("boundary_friction",),
            laws={"one": None, "two": sb.contact_laws.TableLaw(rows, np.exp(-rows) + 0.1 * np.exp(-2 * rows))},
        ),
        "plan": sb.next_runs(fit, 1, speeds=["1 mm/s", "10 mm/s", "0.1 m/s"], loads=["30 N/m"]),
    }


def test_every_result_draws_itself_also_into_given_axes(subtests, results, tmp_path):
    results["solution"].plot(tmp_path / "solution.svg")
    assert b"<svg" in (tmp_path / "solution.svg").read_bytes()
    for kind, found in results.items():
        with subtests.test(kind=kind):
            assert found.plot().axes
            axes = Figure().subplots()
            assert found.plot(ax=axes) is axes.figure
            assert axes.has_data() and axes.get_xlabel()
            with pytest.raises(sb.InputError, match="is no axes of matplotlib"):
                found.plot(ax="here")


RATE = np.geomspace(0.1, 1000, 13)


def film_of_a_parabola():
    x = np.linspace(-1.0, 1.0, 201)
    pressure = np.sqrt(np.maximum(1 - x**2, 0))
    return sb.asymptotics.film_of_pressure(1e-3 * x, 1e6 * pressure, modulus=7e6, viscosity=0.05, speed=0.1)


def loop_fit(contact, path):
    motion = sb.motions.Sine(0.02, 0.5)
    found = sb.stroke(contact, motion, steps=16)
    last = found.last_cycle
    rows = zip(found.time[last] - found.time[last][0], found.friction[last], strict=True)
    path.write_text("time [s],friction\n" + "".join(f"{t},{friction}\n" for t, friction in rows))
    return sb.bench.fit_loop(path, contact, motion, free=["boundary_friction"], steps=16)


@pytest.fixture(scope="module")
def parts(results, tmp_path_factory):
    """Return what results are made of, and what belongs to no contact alone."""
    path, told = tmp_path_factory.mktemp("sweep") / "sweep.toml", []
    path.write_text("[groups]\nload = 0.1\nroughness = 0\n[vary]\nspeed = [0, 0]\n")
    done = sb.sweep(path, path.with_suffix(".sqlite"), on_progress=told.append)
    scan = sb.surfaces.read_topography(EXAMPLES / "cylinder_profile.csv")
    return results | {
        "check": results["checks"].checks[0],
        "spread": results["uncertainty"]["friction"],
        "fitted input": results["fit"].inputs[0],
        "friction": results["solution"].friction,
        "Hertz scales": results["solution"].contact.hertz,
        "landmark": results["curve"].minimum,
        "surface": sb.surfaces.analyse(scan),
        "design": sb.load_sweep(path),
        "sweep": done,
        "progress": told[-1],
        "model of a simulator": results["curve"].to_stribeck_model(),
        "film of a pressure": film_of_a_parabola(),
        "raw curve": sb.bench.read(EXAMPLES / "rig_raw.csv"),
        "master curve": sb.master_curve(sorted(EXAMPLES.glob("joint/oil_*.csv")), EXAMPLES / "joint" / "case.toml"),
        "stroke": sb.stroke(results["solution"].contact, sb.motions.Sine(0.05, 1.0), steps=16, cycles=1),
        "loop fit": loop_fit(results["solution"].contact, path.with_name("loop.csv")),
        "flow curve": sb.fluids.flow_curve(RATE, 2.0 * (1 + (5 * RATE) ** 2) ** -0.3),
    }


def test_every_number_of_every_result_has_a_unit_a_name_and_its_error_beside_it(subtests, parts, tmp_path):
    xarray = pytest.importorskip("xarray")
    for kind, each in parts.items():
        with subtests.test(kind=kind):
            found = each.to_dataset()
            assert found.data_vars and found.attrs["title"]
            for name, values in found.variables.items():
                assert values.attrs["units"] and len(values.attrs["long_name"]) > 2, name
                if name.endswith("_error") and name.removesuffix("_error") in found:
                    assert values.dims == found[name.removesuffix("_error")].dims
                    assert "error" in values.attrs["long_name"]
            found.to_netcdf(tmp_path / f"{kind}.nc")
            with xarray.open_dataset(tmp_path / f"{kind}.nc") as kept:
                assert dict(kept.sizes) == dict(found.sizes)
                for name, values in found.data_vars.items():
                    np.testing.assert_array_equal(kept[name].values, values.values)


def test_the_results_above_are_all_that_have_numbers(parts):
    kinds = {type(each) for each in parts.values()}
    names = {name for name in dir(sb.results) if getattr(sb.results, name) not in kinds}
    # Words, the parts of a film of a pressure, which its dataset holds, and errors of inputs, which are a dictionary.
    assert names == {"Explanation", "FitOutcome", "Films", "Inlet", "StandardErrors"}


def test_a_field_over_other_points_than_an_even_grid_is_not_drawn_and_keeps_its_places(results):
    field = results["ball"].field([0.0, 0.5, 2.0], [[0.0], [1.0]])
    with pytest.raises(sb.InputError, match="evenly spaced grid"):
        field.plot()
    assert dict(field.to_dataset().sizes) == {"y": 2, "x": 3}
    scattered = results["ball"].field([0.5, 0.1], [0.3, 0.2])
    found = scattered.to_dataset()
    assert list(found["x"].values) == [0.5, 0.1] and found["gap"].dims == found["y"].dims == ("dim_0",)
    with pytest.raises(sb.InputError, match="evenly spaced grid"):
        scattered.plot()


def test_a_batch_tells_the_regime_of_each_state_as_single_solves_do(results):
    batch = results["batch"]
    assert batch.regime.tolist() == [sb.solve(contact).regime for contact in batch.contacts]
    assert set(batch.regime.tolist()) == {"boundary", "mixed", "hydrodynamic"}
