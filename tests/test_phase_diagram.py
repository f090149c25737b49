"""The phase diagram: its states are those of single solves, its transitions lie where they claim to, it says what it lacks."""

import importlib
import math

import numpy as np
import pytest

import stribeck as sb
from stribeck import Outcome
from stribeck.asymptotics import load_sharing, transitions

xarray = pytest.importorskip("xarray")

diagrams = importlib.import_module("stribeck.regimes.phase_diagram")

LOADS, ROUGHNESSES, SPEEDS = (0.02, 0.2), (3e-5, 3e-3), (1e-8, 10.0)
POINTS = {"load": 2, "roughness": 3, "speed": 9}
MU0, BETA = 0.8, 0.7
AXES, REGIMES = ("load", "roughness", "speed"), ("boundary", "mixed", "hydrodynamic")
MARKS = ("speed_at_5_percent_fluid", "speed_at_half_fluid", "speed_at_10_percent_contact_friction")


def made(**changes):
    settings = {"load": LOADS, "roughness": ROUGHNESSES, "speed": SPEEDS, "points": POINTS}
    return sb.phase_diagram(**settings | {"boundary_friction": MU0, "beta": BETA} | changes)


def contact_of(groups):
    return sb.LineContact.from_groups(
        groups, radius="8 mm", modulus="3 MPa", viscosity="20 mPa*s", alpha=1.9, beta=BETA, boundary_friction=MU0
    )


@pytest.fixture(scope="module")
def diagram():
    return made()


@pytest.fixture(scope="module")
def si_diagram():
    """Return the same in SI units; its speeds are those of the groups at the second load."""
    low, high = (contact_of(sb.Groups(1.0, load, rough)) for load, rough in zip(LOADS, ROUGHNESSES, strict=True))
    ends = {name: (getattr(low, name), getattr(high, name)) for name in ("load", "roughness")}
    return sb.phase_diagram(
        high, **ends, speed=tuple(high.speed * speed for speed in SPEEDS), points=POINTS | {"roughness": 2}
    )


def solved(speed, load, roughness):
    state = sb.solve(sb.Groups(float(speed), float(load), float(roughness)), rtol=1e-9)
    return state, state.friction(MU0, BETA)


# --- states ---


def test_points_are_those_of_cold_solves(diagram):
    rng = np.random.default_rng(90211)
    for i, j, k in zip(*(rng.integers(0, n, 3) for n in diagram.regime.shape), strict=True):
        point = diagram.isel(load=i, roughness=j, speed=k)
        state, friction = solved(point["speed"], point["load"], point["roughness"])
        assert float(point["friction"]) == pytest.approx(friction.total, rel=1e-4)
        assert abs(point["fluid_load_share"] - state.fluid_load_share) <= point["error_estimate"]
        assert float(point["central_gap"]) == pytest.approx(state.central_gap, rel=float(point["error_estimate"]))
        assert float(point["lambda_ratio"]) == pytest.approx(state.lambda_ratio, rel=float(point["error_estimate"]))
        regime = sb.regime_of(state.fluid_load_share, friction.asperities / friction.total)
        assert REGIMES[int(point["regime"])] == regime
    assert (diagram.error_estimate <= 1e-4).all()
    assert (diagram.friction_error <= 1e-4 * np.maximum(diagram.friction, MU0)).all()
    assert {0, 1, 2} == set(diagram.regime.values.ravel().tolist())


def test_every_variable_has_unit_and_name_and_the_file_holds_them(diagram, tmp_path):
    assert all(variable.attrs["units"] and variable.attrs["long_name"] for variable in diagram.variables.values())
    assert diagram.attrs["source"].startswith("stribeck ")
    assert (diagram.attrs["boundary_friction"], diagram.attrs["beta"], diagram.attrs["complete"]) == (MU0, BETA, 1)
    assert diagram.regime.attrs["flag_meanings"] == "unknown boundary mixed hydrodynamic"
    diagram.to_netcdf(tmp_path / "phase.nc")
    with xarray.open_dataset(tmp_path / "phase.nc") as read:
        assert read.regime.values.tolist() == diagram.regime.values.tolist()
        assert read.message.values.tolist() == diagram.message.values.tolist()


def test_without_speeds_the_grid_covers_every_transition():
    grid = {"load": 0.1, "roughness": (1e-4, 1e-2), "points": {"roughness": 2, "speed": 7}}
    found = sb.phase_diagram(**grid, method="atlas")
    for name in MARKS:
        assert ((found.speed[0] < found[name]) & (found[name] < found.speed[-1])).all()


def test_zero_speed_is_the_dry_plateau_and_zero_roughness_the_smooth_film():
    found = sb.phase_diagram(load=0.1, roughness=[0.0, 5e-4, 1e-3], speed=[0.0, 1e-3, 1.0])
    rest = found.isel(load=0, speed=0)
    assert rest.contact_friction_share.values.tolist() == [1.0, 1.0, 1.0]
    assert rest.friction.values == pytest.approx(1.0, rel=1e-6)
    smooth = found.isel(load=0, roughness=0)
    assert smooth.regime.values.tolist() == [0, 2, 2]
    assert np.isnan(smooth.speed_at_minimum)
    for name in ("formula_speed_at_minimum", "formula_speed_boundary_to_mixed", "printed_speed_boundary_to_mixed"):
        assert np.isnan(smooth[name])
    assert smooth.velocity_weakening == 0


def test_from_load_one_on_there_is_no_boundary_lubrication_and_progress_counts_points():
    told = []
    grid = {"load": 3.0, "roughness": 0.6, "speed": (1e-6, 10.0), "points": 5}
    found = sb.phase_diagram(**grid, on_point=lambda done, points: told.append((done, points)))
    assert 0 not in found.regime
    assert found.complete == 1
    assert np.isnan(found.speed_at_5_percent_fluid)
    assert told[-1] == (5, 5) and {points for _, points in told} == {5}


# --- transitions ---


def test_transitions_lie_where_their_shares_are_passed(diagram):
    """A mark is solved to 1e-6."""
    for i, j in ((0, 2), (1, 0)):
        row, load = diagram.isel(load=i, roughness=j), LOADS[i]
        for name, share in (("speed_at_5_percent_fluid", 0.05), ("speed_at_half_fluid", 0.5)):
            state, _ = solved(row[name], load, row["roughness"])
            assert state.fluid_load_share == pytest.approx(share, abs=1e-6)
        _, friction = solved(row["speed_at_10_percent_contact_friction"], load, row["roughness"])
        assert friction.asperities / friction.total == pytest.approx(0.1, abs=1e-6)


def test_at_the_minimum_friction_is_stationary_and_minimal_also_outside_the_speeds_of_the_grid(diagram):
    """A mark of a coarse diagram is solved to 1e-6, and has its stated error if the grid does not hold it."""
    step, row = 5e-3, diagram.isel(load=0, roughness=0)
    speed = float(row["speed_at_minimum"])
    low, middle, high = (solved(speed * math.exp(s), LOADS[0], ROUGHNESSES[0])[1].total for s in (-step, 0, step))
    assert middle == pytest.approx(float(row["friction_at_minimum"]), rel=1e-6)
    assert abs(0.5 * step * (low - high) / (low - 2 * middle + high)) < 2e-5
    assert middle < min(low, high)
    assert row["velocity_weakening"] == 1
    narrow = made(load=LOADS[0], roughness=ROUGHNESSES[0], speed=1.0, rtol=1e-7)
    assert middle == pytest.approx(float(narrow["friction_at_minimum"].squeeze()), rel=1e-7)
    marks = sb.stribeck_curve(load=LOADS[0], roughness=ROUGHNESSES[0], boundary_friction=MU0, beta=BETA, rtol=1e-6).transitions
    error = max(mark.error for mark in marks)
    assert error < 2e-5
    for name in (*MARKS, "speed_at_minimum", "friction_at_minimum"):
        assert float(narrow[name].squeeze()) == pytest.approx(float(row[name]), rel=error)


def test_formulas_stand_beside_the_solved_transitions(diagram):
    for i, load in enumerate(LOADS):
        for j in (0, 2):
            row = diagram.isel(load=i, roughness=j)
            groups = sb.Groups(1.0, load, float(row["roughness"]))
            speed = transitions.speed_at_minimum.function(groups, boundary_friction=MU0, beta=BETA)
            assert float(row["formula_speed_at_minimum"]) == pytest.approx(float(speed), rel=1e-12)
            for name, share in (("formula_speed_at_5_percent_fluid", 0.05), ("formula_speed_at_half_fluid", 0.5)):
                speed = load_sharing.speed_at_fluid_share.function(groups, share)
                assert float(row[name]) == pytest.approx(float(speed), rel=1e-12)
                assert float(row[name]) == pytest.approx(float(row[name.removeprefix("formula_")]), rel=0.2)
            right, printed = (transitions.speed_boundary_to_mixed.function(groups, printed=p) for p in (False, True))
            assert float(row["formula_speed_boundary_to_mixed"]) == pytest.approx(float(right), rel=1e-12)
            assert float(row["printed_speed_boundary_to_mixed"]) == pytest.approx(float(printed), rel=1e-12)
            assert printed != pytest.approx(right, rel=0.5)
            printed = transitions.speed_at_minimum.function(groups, MU0, BETA, printed=True)
            assert float(row["printed_speed_at_minimum"]) == pytest.approx(float(printed), rel=1e-12)
            assert float(row["printed_speed_at_minimum"]) != pytest.approx(float(row["formula_speed_at_minimum"]), rel=1e-3)
        found = float(diagram["formula_roughness_without_minimum"][i])
        assert found == pytest.approx(float(transitions.roughness_without_minimum(load, MU0, BETA)), rel=1e-12)
    assert (diagram.formula_velocity_weakening == np.isfinite(diagram.formula_speed_at_minimum)).all()


# --- the merging ---


@pytest.mark.slow
def test_the_merging_roughness_parts_curves_with_a_minimum_and_takes_the_quotient_of_the_friction_coefficients():
    contact = contact_of(sb.Groups(1.0, 0.1, 1e-3)).replace(boundary_friction=BETA)
    line = sb.phase_diagram(contact, speed="1 mm/s", merging=True).roughness_without_minimum
    found = contact.replace(roughness=float(line.squeeze())).groups.roughness
    assert found == pytest.approx(0.0174919, rel=1e-5)
    for factor, present in ((0.98, True), (1.02, False)):
        curve = sb.stribeck_curve(load=0.1, roughness=factor * found, rtol=1e-7, points=101)
        assert bool(np.diff(curve.friction.total).min() < 0) == present
    without = sb.phase_diagram(load=0.1, roughness=1e-3, speed=1e-3, merging=True, boundary_friction=0.0)
    assert without.roughness_without_minimum.squeeze() == 0


# --- units ---


@pytest.mark.slow
def test_diagrams_in_si_and_in_groups_agree(diagram, si_diagram):
    groups, row = diagram.isel(load=1, roughness=[0, 2]), si_diagram.isel(load=1)
    np.testing.assert_allclose(si_diagram.load_group, LOADS)
    np.testing.assert_allclose(row["speed_group"], groups.speed, rtol=1e-12)
    np.testing.assert_array_equal(groups.regime, row["regime"])
    np.testing.assert_allclose(groups.friction, row["friction"], rtol=1e-6)
    unit = float((row["speed_group"] / row["speed"])[0])
    for name in (*MARKS, "speed_at_minimum", "formula_speed_at_minimum", "printed_speed_boundary_to_mixed"):
        np.testing.assert_allclose(groups[name], row[name] * unit, rtol=1e-6)
    assert [si_diagram[name].attrs["units"] for name in AXES] == ["N/m", "m", "m/s"]
    assert si_diagram.speed_at_minimum.attrs["units"] == si_diagram.speed.attrs["units"]
    assert si_diagram.attrs["input_radius"] == 8e-3
    assert "roughness_without_minimum" not in si_diagram


# --- what is missing ---


@pytest.fixture(scope="module")
def interrupted():
    """Return what is left of a diagram after Ctrl-C, and how many of its points were told to be done."""
    calls = []

    def stop(done, points):
        calls.append(done)
        if done >= 12:
            raise KeyboardInterrupt

    return made(on_point=stop), calls


def test_after_an_interruption_what_is_finished_stays(interrupted):
    found, calls = interrupted
    assert found.complete == 0
    assert found.outcome[0, 0].values.tolist() == ["CONVERGED"] * 9
    assert np.isfinite(found.speed_at_minimum[0, 0])
    missing = found.outcome == Outcome.INTERRUPTED.name
    assert int(missing.sum()) > 20
    assert (found.regime.where(missing, -1) == -1).all()
    assert np.isnan(found.friction.where(missing)).all()
    assert np.isfinite(found.friction.values[~missing.values]).all()
    assert found.message[1, 1] == Outcome.INTERRUPTED.value
    assert found.velocity_weakening[1, 1] == -1
    assert calls == sorted(calls)


def test_a_row_that_fails_keeps_its_reason_and_leaves_the_others(monkeypatch):
    right = sb.stribeck_curve

    def sometimes(problem, **settings):
        if problem.roughness == 1e-3:
            raise sb.SolveError(Outcome.STEP_LIMIT, None, "this one does not converge")
        return right(problem, **settings)

    monkeypatch.setattr(diagrams, "stribeck_curve", sometimes)
    found = sb.phase_diagram(load=0.1, roughness=[5e-4, 1e-3, 2e-3], speed=(1e-5, 1e-3), points=2)
    assert found.outcome[0, 1].values.tolist() == ["STEP_LIMIT"] * 2
    assert found.message.values.tolist() == [["", "this one does not converge", ""]]
    assert np.isnan(found.friction[0, 1]).all()
    assert (found.outcome[0, ::2] == "CONVERGED").all()
    assert found.complete == 0


# --- bad input ---


def test_bad_input_is_refused_with_a_sentence(subtests):
    for changes, words in [
        ({"load": None}, "load missing"),
        ({"load": None, "roughness": None}, "load and roughness missing"),
        ({"load": (0.0, 0.1)}, "load = (0.0, 0.1)"),
        ({"speed": (10.0, 1.0)}, "increasing points"),
        ({"roughness": [1e-3, 1e-3, 1e-2]}, "increasing points"),
        ({"roughness": []}, "roughness = []"),
        ({"speed": "1 mm/s"}, "for units give a LineContact"),
        ({"speed": math.nan}, "finite"),
        ({"points": 1}, "points of load = 1"),
        ({"points": True}, "points of load = True"),
        ({"points": {"sped": 3}}, "'sped'"),
        ({"rtol": 1.0}, "rtol"),
        ({"definition": "mine"}, "definition"),
        ({"beta": 0.0}, "beta"),
        ({"problem": 7}, "problem = 7"),
    ]:
        with subtests.test(changes=changes, words=words):
            with pytest.raises(sb.InputError) as caught:
                made(**changes)
            assert words in str(caught.value)
            assert str(caught.value).endswith(".")


# --- pictures ---


@pytest.fixture
def plot():
    pytest.importorskip("matplotlib")
    return importlib.import_module("stribeck.plot.phase_diagram")


def texts(figure):
    return [text.get_text() for text in figure.legends[0].get_texts()]


def test_the_plane_shows_regions_solved_lines_and_formulas(subtests, plot, diagram, si_diagram, tmp_path):
    cases = (diagram, r"speed group $\lambda$", 1), (si_diagram, "speed $U$ (m/s)", 1e6)
    for dataset, label, unit in cases:
        with subtests.test(label):
            figure = plot.plot_phase_diagram(dataset, tmp_path / f"{unit}.png", load=float(dataset["load"][1]))
            assert (tmp_path / f"{unit}.png").stat().st_size > 20_000
            (axes,) = figure.axes
            assert set(texts(figure)) == {style[0] for style in (plot.SOLVED | plot.FORMULAS).values()}
            assert {text.get_text() for text in axes.texts} == (set(REGIMES) if len(dataset.roughness) > 2 else set())
            assert axes.get_xlabel() == label
            drawn = {line.get_label(): line for line in axes.lines}
            x, y = drawn["minimum of friction"].get_data()
            np.testing.assert_allclose(x, dataset.speed_at_minimum[1])
            np.testing.assert_allclose(y, dataset.roughness * unit)
            assert drawn["minimum of friction"].get_linestyle() == "-"
            assert drawn["our formulas"].get_linestyle() == "--"
    ax = type(figure)().subplots()
    plot.plot_phase_diagram(si_diagram, ax=ax, load=float(si_diagram["load"][1]))
    assert len(ax.lines) == len(axes.lines) and ax.get_xlabel() == label


def test_the_regions_are_those_of_the_states_and_rows_without_states_stay_white(plot, diagram, interrupted):
    plane = diagram.isel(load=0)
    for name, (left, right) in plot._regions(plane).items():
        inside = (left[:, None] <= plane.speed.values) & (plane.speed.values < right[:, None])
        assert (inside == (plane.regime.values == REGIMES.index(name))).all()
    found, _ = interrupted
    figure = plot.plot_phase_diagram(found, load=LOADS[1])
    assert found.attrs["outcome"] in [text.get_text() for text in figure.texts]
    (_, (left, right), _) = plot._regions(found.isel(load=1)).values()
    assert not np.isfinite(left * right).any()


def test_the_merging_is_drawn_where_it_lies_in_the_picture(plot, diagram):
    label = "above: no minimum of friction"
    for height, seen in ((1e-3, True), (0.5, False)):
        figure = plot.plot_phase_diagram(diagram.assign(roughness_without_minimum=("load", [height, height])))
        assert (label in texts(figure)) == seen
        lines = [line for line in figure.axes[0].lines if line.get_label() == label]
        assert {y for line in lines for y in line.get_ydata()} == ({height} if seen else set())


def test_the_space_shows_planes_surfaces_and_lines(plot, si_diagram, tmp_path):
    figure = plot.plot_phase_space(si_diagram, tmp_path / "space.svg")
    assert (tmp_path / "space.svg").stat().st_size > 20_000
    (axes,) = figure.axes
    assert set(texts(figure)) == {style[0] for style in plot.IN_SPACE.values()}
    assert len(axes.collections) == 2 + 6
    assert axes.get_ylim() == pytest.approx(np.log10(si_diagram["load"].values[::-1]))
    assert "roughness" in axes.get_zlabel()


def test_pictures_that_cannot_be_are_refused(plot, diagram, tmp_path):
    for draw, few in ((plot.plot_phase_space, {"load": [0]}), (plot.plot_phase_diagram, {"speed": [0]})):
        with pytest.raises(sb.InputError, match="two or more"):
            draw(diagram.isel(**few))
    (tmp_path / "there.png").touch()
    with pytest.raises(sb.InputError, match="exists already"):
        plot.plot_phase_diagram(diagram, tmp_path / "there.png")
