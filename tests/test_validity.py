"""Maps of the errors of formulas: they are the errors at their states, and the page that shows them is up to date."""

import importlib.util
import json
import math
import re
import struct
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import stribeck as sb
from evidence.ball import OBSERVED
from evidence.coefficients import COEFFICIENT_RATIOS, JUDGED_FORMULAS, largest_errors
from evidence.error_maps import AXES, error_map, error_maps, kind_of
from evidence.formulas import CURVE_QUANTITIES, MEASURED, STATE_QUANTITIES, relative_error
from stribeck.asymptotics import FORMULAS, Limit, hertz, hydrodynamic, load_sharing, rest, transitions, uniform

pytest.importorskip("xarray")

DOCS = Path(__file__).parents[1] / "docs"
PAGE = (DOCS / "validity.md").read_text()
WORST = json.loads((Path(__file__).parent / "data" / "worst_errors.json").read_text())
"""What ``make validity`` found: the largest error of each formula on its map, and where."""


@pytest.fixture(scope="module")
def script():
    """Return the script that makes the page, as a module."""
    spec = importlib.util.spec_from_file_location("validity_script", DOCS / "validity.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def blocks(script):
    """Return what the script wrote into the page."""
    return script.blocks_of(PAGE)


def rows(block):
    """Return the cells of a table by the name in its first column."""
    table = [line for line in block.splitlines() if line.startswith("|")]
    lines = [[cell.strip() for cell in line.strip("|").split(" | ")] for line in table[2:]]
    return {cells[0].strip("` "): cells[1:] for cells in lines}


# --- the maps ---

GRID = {"load": [1e-3, 0.3], "relative_roughness": [1e-4, 3e-3], "speed": [1e-8, 1e-5, 1e-2]}


@pytest.fixture(scope="module")
def maps():
    return error_maps([hertz.pressure, hydrodynamic.friction, rest.gap, uniform.friction], **GRID)


def test_a_map_holds_the_signed_error_of_every_state(maps):
    data = maps[uniform.friction.name]
    assert data["error"].dims == ("load", "relative_roughness", "speed")
    for i, j, k in ((0, 0, 0), (0, 1, 2), (1, 0, 1), (1, 1, 0)):
        load, kappa, speed = GRID["load"][i], GRID["relative_roughness"][j], GRID["speed"][k]
        right = relative_error(uniform.friction, sb.Groups(speed, load, kappa * load))
        assert math.isclose(data["error"].values[i, j, k], right, rel_tol=1e-4, abs_tol=1e-6)


def test_the_ends_of_a_range_are_in_it_though_the_relative_roughness_is_rounded():
    low = np.nextafter(1e-5, 0.0)  # as powers of ten come out on some processors
    formula = replace(rest.central_gap, limits=(Limit("relative_roughness", 1e-5, 1e-3),))
    data = error_map(formula, load=0.1, relative_roughness=[9e-6, low, 1e-3, 1.1e-3])
    assert data["valid"].values.tolist() == [[False, True, True, False]]


def test_coefficients_given_to_a_formula_hold_for_the_solver_too():
    grid = {"load": 0.1, "relative_roughness": 0.01, "speed": [1e-6, 1e-4, 1e-2]}
    data = error_map(uniform.friction, **grid, boundary_friction=0.3, beta=0.02, definition="balanced")
    for speed, error in zip(grid["speed"], data["error"].values.ravel(), strict=True):
        groups = sb.Groups(speed, 0.1, 1e-3)
        right = sb.solve(groups).friction(boundary_friction=0.3, beta=0.02, definition="balanced").total
        found = uniform.friction(groups, boundary_friction=0.3, beta=0.02, definition="balanced")
        assert math.isclose(error, found / right - 1, rel_tol=1e-3, abs_tol=1e-6)
    assert data.attrs["title"] == "uniform.friction(boundary_friction=0.3, beta=0.02, definition='balanced')"
    lowest = error_map(transitions.friction_at_minimum, load=0.1, relative_roughness=1e-3, beta=0.02)
    assert abs(float(lowest["error"].values[0, 0])) < 0.01


def test_a_map_of_coefficients_outside_the_range_has_no_state_in_it():
    grid = {"load": 0.1, "relative_roughness": 0.01, "speed": [1e-6, 1e-4]}
    assert error_map(uniform.friction, **grid, beta=0.1)["valid"].values.all()
    assert not error_map(uniform.friction, **grid, boundary_friction=0.1, beta=0.7)["valid"].values.any()


def test_the_errors_over_the_coefficients_are_those_on_the_page(script, blocks):
    name = "mixed.friction"
    limit = next(limit for limit in JUDGED_FORMULAS[name][0].limits if limit.parameter == "beta/mu0")
    shown = rows(blocks["ratios"])[name]
    inside = [limit.low <= ratio <= limit.high for ratio in COEFFICIENT_RATIOS]
    assert [cell.startswith("**") for cell in shown] == inside
    found = largest_errors(name, points=script.RATIO_POINTS)[0]
    assert [float(cell.strip("*")) / 100 for cell in shown] == pytest.approx(found, rel=0.02)


def test_a_formula_that_options_turn_to_another_quantity_is_judged_by_that():
    law = load_sharing.speed_at_fluid_share
    data = error_map(law, load=0.01, relative_roughness=1e-3, share=0.05, predicts="speed_at_5_percent_fluid")
    curve = sb.stribeck_curve(load=0.01, roughness=1e-5)
    [speed] = [mark.value for mark in curve.transitions if mark.name == "fluid carries 5 % of the load"]
    found = law(sb.Groups(1.0, 0.01, 1e-5), share=0.05)
    assert math.isclose(data["error"].values[0, 0], found / speed - 1, rel_tol=1e-3)
    assert abs(float(error_map(law, load=0.01, relative_roughness=1e-3, share=0.05)["error"].values[0, 0])) > 0.5


def test_where_a_formula_has_no_value_the_map_has_none():
    data = error_map(transitions.speed_boundary_to_mixed, load=[0.5, 2.0], relative_roughness=1e-2)
    assert np.isnan(data["error"].values).ravel().tolist() == [False, True]


def test_an_unknown_quantity_is_refused_with_the_known_ones():
    with pytest.raises(sb.InputError, match="'speed_at_rest'; it must be one of central_gap, .*speed_at_half_fluid"):
        error_map(uniform.friction, **GRID, predicts="speed_at_rest")


# --- the picture ---


def test_a_picture_has_a_panel_for_each_load_of_a_map_and_one_for_each_line(maps, tmp_path):
    from evidence.plot import plot_error_maps

    pairs = [(formula, maps[formula.name]) for formula in (uniform.friction, hydrodynamic.friction, rest.gap)]
    figure = plot_error_maps(pairs, tmp_path / "a.png", title="Errors")
    assert (tmp_path / "a.png").stat().st_size > 10_000
    titles = [axes.get_title(loc="left") for axes in figure.axes]
    assert titles[:4] == ["uniform.friction\nload 0.001", "\nload 0.3", "hydrodynamic.friction", "rest.gap"]
    drawn = figure.axes[0].collections[0].get_array()
    np.testing.assert_allclose(np.ravel(drawn), np.maximum(np.abs(maps["uniform.friction"]["error"].values[0]), 1e-7).ravel())
    smooth = next(line for line in figure.axes[2].lines if len(line.get_xdata()) == 3)
    np.testing.assert_allclose(smooth.get_ydata(), np.abs(maps["hydrodynamic.friction"]["error"].values))


# --- the page ---


def test_every_table_states_range_and_error_of_its_formulas_and_every_module_has_a_picture(script, blocks):
    shown = [module for section in script.SECTIONS.values() for module in section]
    assert sorted(shown) == sorted({formula.module for formula in FORMULAS})
    assert set(blocks) == {"ratios", *script.SECTIONS}
    for section, modules in script.SECTIONS.items():
        formulas = script.of_modules(*modules)
        shown = {}
        for words, (found,) in rows(blocks[section]).items():
            shown |= {name: (words, error) for name, error in re.findall(r"`([\w.]+)` ([\w.-]+)", found)}
        formulas = script.of_modules(*modules)
        assert shown == {formula.name: (script.holds(formula), script.percent(formula.worst)) for formula in formulas}
        for module in modules:
            assert f"](images/validity_{module.replace('.', '_')}.png)" in PAGE


def test_the_pictures_of_the_page_are_small_and_no_others_are_left():
    named = set(re.findall(r"images/(validity_\w+\.png)", PAGE))
    assert named == {path.name for path in (DOCS / "images").glob("validity_*.png")}
    for name in named:
        data = (DOCS / "images" / name).read_bytes()
        width, height = struct.unpack(">II", data[16:24])
        assert len(data) < 200_000 and 500 < width <= 1000 and 200 < height <= 1200


def test_every_kind_of_formula_is_explained(script):
    assert {kind_of(formula) for formula in FORMULAS} <= set(script.ABOUT) == set(AXES)
    for word in script.ABOUT.values():
        assert f"\n| {word} | " in PAGE.split("## The laws")[0]


def of_geometry(geometry):
    return [formula for formula in FORMULAS if formula.geometry == geometry]


@pytest.mark.parametrize("formulas", [of_geometry("line"), pytest.param(of_geometry("point"), marks=pytest.mark.slow)])
def test_the_largest_error_of_a_map_is_the_one_there_and_within_the_stated_one(subtests, formulas):
    for formula in formulas:
        with subtests.test(formula.name):
            largest, at = WORST[formula.name]
            load, exponent = at.get("load", 0.1), {"line": 1.0, "point": 2 / 3}[formula.geometry]
            roughness = at.get("relative_roughness", 0.0) * load**exponent
            groups = sb.Groups(at.get("speed", 1.0), load, roughness, geometry=formula.geometry)
            assert math.isclose(abs(relative_error(formula, groups)), largest, rel_tol=0.02)
            assert largest <= 1.02 * formula.worst


@pytest.mark.slow
def test_a_coarser_map_finds_no_worse_error_than_the_finer_one():
    # Along the speed every state is kept, as long steps cost more than what lies between.
    for kind, rough in (("smooth", slice(None)), ("rest", slice(1, None, 5)), ("mixed", slice(3, None, 16))):
        formulas = [formula for formula in FORMULAS if kind_of(formula) == kind]
        grid = {}
        for name, default in AXES[kind].items():
            low, high, each = default
            points = np.logspace(low, high, round((high - low) * each) + 1)
            grid[name] = {"load": [low, high], "relative_roughness": points[rough], "speed": points}[name]
        for name, data in error_maps(formulas, **grid).items():
            errors = np.abs(data["error"].values)[data["valid"].values]
            assert errors.size and errors.max() <= 1.01 * WORST[name][0], name


def test_new_text_replaces_what_stands_between_marks(script):
    page = "a\n<!-- begin x -->\nold\n<!-- end x -->\nb\n"
    text = script.filled(page, {"x": r"new \1"})
    assert text == "a\n<!-- begin x -->\nnew \\1\n<!-- end x -->\nb\n"
    assert script.blocks_of(text) == {"x": r"new \1"}


def test_every_quantity_that_a_formula_predicts_is_measured():
    line, ball = sb.Groups(1e-4, 0.1, 1e-4), sb.Groups(1e-2, 1e-3, 1e-4, geometry="point")
    assert all(math.isfinite(MEASURED[name](line)) for name in (*STATE_QUANTITIES, *CURVE_QUANTITIES))
    assert all(math.isfinite(MEASURED[name](ball)) for name in OBSERVED)
    assert {*STATE_QUANTITIES, *CURVE_QUANTITIES, *OBSERVED} == MEASURED.keys()
