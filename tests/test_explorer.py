"""The explorer without its browser: linked inputs, addresses, answers, charts, numbers and files."""

import asyncio
import csv
import io
import math
import re
import socket
import subprocess
import sys
import time
import tomllib
from contextlib import suppress
from dataclasses import replace
from itertools import product
from pathlib import Path
from types import SimpleNamespace
from urllib.parse import parse_qsl, urlencode
from xml.etree import ElementTree

import numpy as np
import pytest
from command_line import EXAMPLES, case_text
from fit_data import TRUE

import stribeck as sb
from stribeck.cases.law import SOURCES
from stribeck.cases.model_parts import PART_TABLES
from stribeck.cli import main
from stribeck.explorer import charts, curves, server, table
from stribeck.explorer import downloads as files
from stribeck.explorer.answer import Answerer, Pinned
from stribeck.explorer.inputs import choices, inputs, url
from stribeck.explorer.inputs.inputs import History
from stribeck.explorer.page import form_of, parts_of
from stribeck.explorer.server import words_page
from stribeck.explorer.tab import Threads, run
from stribeck.explorer.uploads import (
    fit_measured,
    headers_of,
    read_case,
    read_file,
    read_measured,
    read_scan,
    reading,
    reading_for_fit,
    shown_name,
    with_scan,
)
from stribeck.files.toml import toml_text
from stribeck.plot import style
from stribeck.quantities import units
from stribeck.regimes.margins import regime_margins
from stribeck.solids import Prony
from stribeck.solver.numbers import report_rows
from stribeck.uncertainty import propagate as propagate_module

START = server.example()
BALL = choices.choose(START, "geometry", "point")
EXPLORER = Path(server.__file__).parent
PROFILE = (EXAMPLES / "cylinder_profile.csv").read_bytes()


@pytest.fixture(scope="module")
def answer():
    return Answerer()(START)


@pytest.fixture(scope="module")
def rested():
    """Return the answer of a page that has come to rest."""
    model = Answerer()
    model(START)
    rest(model, START)
    return model(START)


def always(part):
    """Report that lets slow work go on."""


def solve(model, now, number=0):
    """Do the first, coarse part of the work at rest, or another one; return whether there is something new to show."""
    return bool(list(model.at_rest(now)[number](always)))


MARGINS, SPREAD, CHECKS = 3, 4, 5
"""Numbers of the parts that find what errors of the inputs do, and the checks."""


def rest(model, now):
    """Do all the work at rest; return whether there is something new to show."""
    return any([solve(model, now, number) for number in range(len(model.at_rest(now)))])


def saved_case(shown):
    """Return the case file of inputs that are not answered."""
    return files.content("toml", SimpleNamespace(inputs=shown, curve=None))


def reopened(query, start=START):
    return url.decode(parse_qsl(query, keep_blank_values=True), start)


def others(shown):
    """Return the tables of a case beside those that any has."""
    return shown.tables.keys() - {"title", "contact", "solver"}


# --- inputs ---


def test_a_slider_moves_its_quantity_to_a_number_that_can_be_read_and_nothing_else(subtests):
    for name in inputs.FIELDS["line"]:
        with subtests.test(name=name):
            moved = inputs.with_slider(START, name, inputs.position(START, name) + 0.25)
            value = getattr(moved.contact, name)
            assert value / getattr(START.contact, name) == pytest.approx(10**0.25, rel=5e-3)
            assert inputs.with_text(START, name, inputs.number_text(moved, name)).contact == moved.contact
            assert moved.contact.replace(**{name: getattr(START.contact, name)}) == START.contact


def test_a_group_moves_load_speed_and_roughness_so_that_the_other_groups_stay(subtests):
    for start, name in product((START, BALL), inputs.GROUP_FIELDS):
        with subtests.test(geometry=start.table.geometry, name=name):
            moved = inputs.with_slider(start, name, inputs.position(start, name) - 0.5)
            for other in inputs.GROUP_FIELDS:
                wanted = inputs.value_of(start, other) * (10**-0.5 if other == name else 1.0)
                assert inputs.value_of(moved, other) == pytest.approx(wanted, rel=5e-3 if other == name else 1e-12)
            changed = {key for key in start.fields if getattr(moved.contact, key) != getattr(start.contact, key)}
            assert changed <= {"load", "speed", "roughness"}


def test_every_group_that_is_shown_can_be_moved_whatever_the_shape_of_the_body():
    assert [row["name"] for row in form_of(START, {})["groups"]] == list(inputs.GROUP_FIELDS)
    for shape in choices.CHOICES["shape"].options:
        with suppress(sb.InputError):  # what comes from a file
            now = choices.choose(START, "shape", shape)
        for row in form_of(now, {})["groups"]:
            moved = inputs.with_slider(now, row["name"], row["place"] + 0.1)
            assert inputs.value_of(moved, row["name"]) == pytest.approx(10 ** (row["place"] + 0.1), rel=0.01)


def test_a_slider_stops_at_its_ends_and_a_value_beyond_stands_there():
    low, high = inputs.FIELDS["line"]["speed"].usual
    assert inputs.with_slider(START, "speed", 5.0).contact.speed == high
    for text, value, end in (("100 m/s", 100, high), ("0", 0, low)):
        far = inputs.with_text(START, "speed", text)
        assert far.contact.speed == value and inputs.position(far, "speed") == math.log10(end)


def test_a_unit_that_is_typed_becomes_that_of_the_field_and_another_one_keeps_the_value():
    typed = inputs.with_text(START, "load", "1.5 kN/m")
    assert (typed.contact.load, typed.units["load"], inputs.number_text(typed, "load")) == (1500, "kN/m", "1.5")
    assert inputs.with_text(typed, "load", "2").contact.load == 2000
    assert inputs.with_text(START, "roughness", "2 um").units["roughness"] == "µm"
    shown = inputs.in_unit(START, "viscosity", "Pa*s")
    assert shown.contact == START.contact and inputs.number_text(shown, "viscosity") == "0.05"


def test_impossible_inputs_are_refused_with_the_sentence_of_the_command_line(subtests):
    for name, text, sentence in [
        ("load", "1,500", "load = '1,500' may be 1.500 or 1500; write one of them, without a comma."),
        ("load", "1,5,0", "has a comma; write a decimal point"),
        (
            "boundary_friction",
            "70",
            "boundary_friction = 70 is above 10, the largest the explorer takes; write 0.7 for 70 %.",
        ),
        ("radius", "", "radius is empty; type a number, or press Escape for the one before."),
        ("speed_group", " ", "speed_group is empty;"),
        ("speed", "fast", "or a bare number in mm/s."),
        ("beta", "x", "beta = 'x' is not a number; write it as 0.001 or 1e-3."),
        ("speed_group", "-1", "speed = -1.0 must be finite and zero or positive."),
        ("load_group", "lots", "load_group = 'lots' is not a number; write it as 0.001 or 1e-3."),
        ("beta", "1e-300", "leave the range of double precision"),
    ]:
        with subtests.test(name=name, text=text, sentence=sentence):
            with pytest.raises(sb.InputError) as problem:
                inputs.with_text(START, name, text)
            assert sentence in str(problem.value)


def test_a_decimal_comma_is_read_as_in_files(subtests):
    for name, text, value in [
        ("load", "1,5", 1.5),
        ("load", "1,5 kN/m", 1500),
        ("beta", "0,060", 0.06),
        ("load_group", "2,5e-1", 0.25),
        ("alpha", ",75", 0.75),
    ]:
        with subtests.test(name=name, text=text, value=value):
            assert inputs.value_of(inputs.with_text(START, name, text), name) == pytest.approx(value, rel=1e-12)


# --- all that a case can hold ---

ODD_TITLE = 'a & b = ü #1, two\nlines "quoted" \\ \x7f'
GIVEN = {
    "radius": "10.0 mm",
    "load": "31.7 N/m",
    "viscosity": 0.1 / 3,
    "speed": "0 m/s",
    "boundary_friction": 2 / 3,
    "modulus": 3e6,
}
ROUGH = {"roughness": 1e-6 / 3, "alpha": 2, "beta": "0.06 +- 20 %"}
SURFACE = {"h_rms": "1 um", "hurst": 0.8, "longest_wavelength": "150 um", "shortest_wavelength": "1.5 um"}
WAVES = {"h_rms": 8e-7, "hurst": 0.7, "q0": "5e4 1/m", "q1": 5e6, "roll_off": 6e4, "gamma": 0.5}
ASPERITIES = {"density": "1e10 1/m^2", "radius": "10 um", "deviation": "0.5 um"}
FIT = {
    "free": ["roughness", "beta"],
    "robust": True,
    "relative_error": 0.03,
    "header_row": 3,
    "columns": {"friction": ["µ 1", 'the "second"']},
    "units": {"speed": "mm/s"},
    "bounds": {"roughness": ["0.1 um", "9 um"]},
    "priors": {"beta": {"value": 0.06, "factor": 1.5}},
    "curves": {"wet, 20 °C": {"viscosity": "2 mPa*s"}},
}
CURVE = {"over": "load", "range": ["1 N/m", "2 kN/m"], "points": 33}
CHECK = {"loss_tangent": 0.1, "layer_thickness": "3 mm"}

# What a case may hold: its tables, and what else its contact has; None takes something away.
CASES = [
    ({"curve": CURVE, "solver": {"rtol": 3e-7, "definition": "published"}, "fit": FIT, "check": CHECK}, ROUGH),
    ({"fluid": {"preset": "saliva"}, "cavitation": {"model": "exit"}}, ROUGH | {"viscosity": None}),
    ({"fluid": {"preset": "pao-10"}, "solid": {"layer_thickness": "2 mm", "poisson_ratio": 0.4}}, ROUGH | {"viscosity": None}),
    ({"fluid": {"model": "carreau", "relaxation_time": "1 ms", "exponent": 0.6}}, ROUGH | {"slide_to_roll": 0.3}),
    ({"fluid": {"model": "eyring", "eyring_stress": "5 MPa", "density": "dowson-higginson"}}, ROUGH),
    ({"fluid": {"pressure_coefficient": "1.5 1/GPa", "viscosity_law": "roelands"}}, ROUGH | {"slide_to_roll": 0}),
    ({"cavitation": {"model": "reform", "cavity_pressure": "-0.1 MPa"}, "flow_factors": {"model": "effective-medium"}}, ROUGH),
    ({"flow_factors": {"model": "patir-cheng", "gamma": 3}, "solid": {"layer_thickness": 1e-3}}, ROUGH),
    ({"solid": {"relaxation_times": ["1 ms", "10 ms"], "moduli": [1.0, 0.5]}}, ROUGH),
    (
        {},
        ROUGH
        | {"modulus": None, "youngs_modulus": "5.5 MPa", "poisson_ratio": 0.49, "law": "greenwood-williamson", "alpha": 1},
    ),
    ({"asperities": ASPERITIES}, {"law": "greenwood-tripp"}),
    ({"surface": SURFACE | {"alpha_error": "5 %", "beta_error": "20 %"}}, {}),
    (
        {"surface": SURFACE | {"h_rms": "1 um +- 4 %"}, "correlations": {"roughness": {"modulus": -0.9}}},
        {"law": "persson", "modulus": "3 MPa +- 8 %"},
    ),
    ({"surface": WAVES}, {"law": "persson"}),
    ({"surface": {"spectrum": "spectrum.csv", "gamma": 0.42}}, {"law": "persson"}),
    ({"table": {"file": "law.csv"}}, ROUGH | {"law": "table"}),
    ({"table": {"separation": [0, 1, 2, 4.5], "pressure": [1, 0.4, 0.1, 1e-3]}}, ROUGH | {"law": "table"}),
    (
        {},
        ROUGH
        | {"geometry": "point", "load": "0.3 N", "wetted_radius": "40 mm"}
        | {"slide_to_roll": 0.7, "speed": None, "entrainment_speed": "0.3 m/s"},
    ),
]


def same_contact(one, two):
    without = {"law": None, "boundary_friction": 0.5}  # what a stress acts on is known by laws alone
    assert one.replace(**without) == two.replace(**without)
    assert one.asperity_friction == two.asperity_friction
    assert getattr(one, "boundary_friction", None) == getattr(two, "boundary_friction", None)
    assert (one.law is None) == (two.law is None)
    if one.law is not None:
        s = np.geomspace(0.05, 20, 50)
        assert one.law.name == two.law.name
        assert (one.law.log_pressure(s) == two.law.log_pressure(s)).all()
        assert one.law.parameters | {"title": ""} == two.law.parameters | {"title": ""}


def check_kept(shown):
    """Check that a link and the saved case bring inputs back."""
    opened = reopened(url.encode(shown))
    assert (opened.problems, opened.inputs) == ({}, shown)
    saved = inputs.from_case(read_case("saved.toml", saved_case(shown)))
    same_contact(saved.contact, shown.contact)
    for name in ("definition", "rtol", "title"):
        assert getattr(saved.case, name) == getattr(shown.case, name), name


def test_all_that_a_case_holds_goes_through_link_and_saved_case(subtests, tmp_path):
    (tmp_path / "spectrum.csv").write_text("wavenumber [1/m], density [m^4]\n1e4, 1e-20\n1e5, 9e-22\n1e6, 8e-25\n1e7, 1e-28\n")
    (tmp_path / "law.csv").write_text("separation, pressure\n0, 1\n1, 0.4\n2, 0.1\n4.5, 1e-3\n")
    for k, (tables, own) in enumerate(CASES):
        with subtests.test(contact=own, tables=tables):
            contact = {name: value for name, value in (GIVEN | own).items() if value is not None}
            path = tmp_path / f"case {k}.toml"
            path.write_text(toml_text({"title": ODD_TITLE, "contact": contact, **tables}), encoding="utf-8")
            case = sb.load_case(path)
            shown = inputs.from_case(case)
            same_contact(shown.contact, case.contact)
            pins = START.replace(title="kept ~ once", definition="published"), shown.replace(title="law")
            opened = reopened(url.encode(shown, pins))
            assert (opened.problems, opened.inputs, opened.pins) == ({}, shown, pins)
            saved = read_case("saved.toml", saved_case(shown))
            same_contact(saved.contact, case.contact)
            for name in ("law", "curve", "rtol", "definition", "title", "notes", "fit", "facts"):
                assert getattr(saved, name) == getattr(case, name), name
            assert saved.errors == pytest.approx(case.errors) and saved.errors.correlations == case.errors.correlations
            assert inputs.from_case(saved).tables == shown.tables


def test_what_an_address_cannot_mean_is_told(subtests):
    for query, sentence in [
        ("tables=x", "tables = 'x' is not a known key"),
        ("law=table&table.file=/etc/passwd", "a link contains its rows instead"),
        ("law=persson&surface.spectrum=x.csv", "a link contains its rows instead"),
        ("law=hertz", "law = 'hertz' must be one of"),
        ("geometry=triangle", "geometry = 'triangle' must be 'line' or 'point'"),
        ('fit.free=["x"]', "which cannot be fitted"),
        ("curve.points=NaN", "must be a whole number"),
        ("load=3+N/m+%2B-+-1+%25", "load = '3 N/m +- -1 %'"),
        ("colour=red", "colour = 'red' is not a known key"),
        ("solver.definition=mine", "'balanced' or 'published'"),
        ("fluid=[", "fluid = '[' is not a known key"),
        ("solver.rtol=2", "rtol"),
        ("pin=x", "in pin, x = '' is not a known key"),
        ("pin=load%3D-1", "in pin, load = -1 must be positive."),
    ]:
        with subtests.test(query=query, sentence=sentence):
            opened = reopened(query)
            assert opened.inputs == START
            assert any(sentence in said for _, said in opened.problems.values())
    assert reopened("") == url.Opened(START, (), {})
    opened = reopened("load=-1+N/m&speed=2+mm/s&pin=speed%3Dfast&radius=1+mm")  # the rest is taken
    assert opened.inputs.contact == START.contact.replace(speed="2 mm/s", radius="1 mm")
    assert opened.problems["load"] == ("-1 N/m", "load = '-1 N/m' must be positive.")
    assert "in pin, speed = 'fast'" in opened.problems["pin"][1]


def test_what_no_address_can_hold_is_refused_at_load(tmp_path):
    path = tmp_path / "long.toml"
    rows = 3000
    tables = {"separation": [float(i) for i in range(rows)], "pressure": [math.exp(-0.1 * i) for i in range(rows)]}
    contact = {"law": "table", **{name: getattr(START.contact, name) for name in inputs.FIELDS["line"]}}
    path.write_text(toml_text({"contact": contact, "table": tables}))
    with pytest.raises(
        sb.InputError, match=r"would have .* characters, but at most 60000 are possible; most come from the contact law"
    ):
        url.check_length(inputs.from_case(sb.load_case(path)))


def test_an_uploaded_case_that_names_a_file_says_what_to_do(tmp_path):
    with pytest.raises(sb.InputError, match=r"case.toml: \[table\] file = 'law.csv' is a file that the browser did not send"):
        read_case("C:\\data\\case.toml", b'[table]\nfile = "law.csv"\n')


def test_neither_a_link_nor_an_upload_reads_a_file_of_this_machine(tmp_path):
    secret = tmp_path / "secret.csv"
    secret.write_text("the secret;another\n1;2\n")
    laws = {name: source.laws[-1] for name, source in SOURCES.items()}
    tables = {name: source.keys for name, source in SOURCES.items()} | {name: part.keys for name, part in PART_TABLES.items()}
    for name, key in ((name, key) for name, keys in tables.items() for key in keys):
        own = {"law": laws[name]} if name in laws else {"profile.shape": "table"} if name == "profile" else {}
        opened = reopened(urlencode(own | {f"{name}.{key}": str(secret)}))
        assert "the secret" not in str(opened), (name, key)
        case = {"contact": START.tables["contact"] | own, name: {key: str(secret)}}
        with pytest.raises(sb.InputError) as problem:
            read_case("case.toml", toml_text(case).encode())
        assert "the secret" not in str(problem.value), (name, key)


def test_the_report_of_a_scan_says_which_rows_were_left_out():
    spectrum = sb.surfaces.SelfAffine(1e-6, 2e4, 3e6, 0.8, 1e5)
    heights = sb.surfaces.synthetic_topography(spectrum, (64, 64), 1e-6, 5).heights
    rows = [f"{i};{j};{z * 1e9:.4f}" for (i, j), z in np.ndenumerate(heights)]
    text = "\n".join(["x (um);y (um);z (nm)", *rows, "end of data"])
    assert f"1 row below the numbers left out: {len(rows) + 2}." in read_scan("scan.txt", text.encode()).report


def test_odd_names_of_uploads_become_plain_ones(subtests):
    for name, shown in [
        ("..", "file"),
        ("a/..", "file"),
        ("/x/y.toml", "y.toml"),
        ("a\0b.toml", "a_b.toml"),
        ("", "file"),
        ("a\nb", "a_b"),
    ]:
        with subtests.test(name=name, shown=shown):
            assert shown_name(name) == shown
            assert len(shown_name(300 * "x" + ".csv")) <= 80 and shown_name(300 * "x" + ".csv").endswith("xxx.csv")


# --- the parts of the model ---


def test_a_cylinder_becomes_a_ball_of_the_same_pressure_and_back():
    assert isinstance(BALL.contact, sb.PointContact) and set(BALL.fields) == set(sb.PointContact.INPUTS.names)
    assert BALL.contact.hertz.pressure == pytest.approx(START.contact.hertz.pressure, rel=1e-12)
    assert START.case.title and not BALL.case.title  # which may name the geometry before
    back = choices.choose(BALL, "geometry", "line")
    assert back.contact.load == pytest.approx(START.contact.load, rel=1e-12) and others(back) == set()
    assert back.contact.replace(load=START.contact.load) == START.contact


def test_what_a_ball_may_do_without_is_an_empty_field():
    wet = inputs.with_text(BALL, "wetted_radius", "30")
    assert wet.contact.wetted_radius == 0.03 and inputs.number_text(wet, "wetted_radius") == "30"
    dry = inputs.with_text(wet, "wetted_radius", "")
    assert dry.contact.wetted_radius is None and inputs.number_text(dry, "wetted_radius") == ""
    assert reopened(url.encode(dry), wet).inputs == dry


def start_of(name):
    """Return inputs that may have all options of a choice: a stress acts on the area of a law that knows it."""
    return choices.choose(START, "law", "persson") if name == "asperity_friction" else START


def test_every_choice_makes_a_contact_that_link_and_saved_case_keep(subtests):
    for name, choice in choices.CHOICES.items():
        start = start_of(name)
        for value in choice.options:
            if value in ("table", ""):
                continue
            with subtests.test(name=name, value=value):
                shown = choices.choose(start, name, value)
                assert choices.list_of(shown, name)["value"] == ("" if name == "preset" else value)
                check_kept(shown)
                assert others(choices.choose(shown, name, choice.first)) in (set(), others(shown), others(start))


def test_a_law_that_is_chosen_presses_as_the_one_before_at_a_gap_of_one_h_rms():
    tripp = choices.choose(START, "law", "greenwood-tripp")
    before, after = START.contact, tripp.contact
    pressure = after.beta * float(np.exp(after.law.log_pressure(np.array([after.alpha]))[0]))
    assert after.alpha == 1.0 and pressure == pytest.approx(before.beta * math.exp(-before.alpha))
    back = choices.choose(tripp, "law", "exponential").contact
    assert (back.alpha, back.beta) == pytest.approx((before.alpha, before.beta))


def test_what_many_changes_lead_to_goes_through_link_and_saved_case(subtests):
    for first, seed in product((START, BALL), range(3)):
        with subtests.test(geometry=first.table.geometry, seed=seed):
            random, shown = np.random.default_rng([16, seed]), first.replace(abscissa="hersey", definition="published")
            for _ in range(8):
                name = random.choice([each for each in choices.CHOICES if each != "geometry"]).item()
                options = [each for each, _ in choices.list_of(shown, name)["options"] if each]
                with suppress(sb.InputError):  # not with the rest
                    shown = choices.choose(shown, name, random.choice(options).item())
                    slider = random.choice(list(shown.fields)).item()
                    shown = inputs.with_slider(shown, slider, inputs.position(shown, slider) + random.uniform(-0.5, 0.5))
                    for key, *_ in choices.list_of(shown, name)["details"][:1]:
                        shown = choices.with_detail(shown, name, key, f"{random.uniform(0.1, 0.9):.2g}")
            check_kept(shown)


def test_the_examples_of_the_page_load_and_come_with_the_wheel():
    project = tomllib.loads(Path("pyproject.toml").read_text())
    shipped = project["tool"]["hatch"]["build"]["targets"]["wheel"]["force-include"]
    assert {path.name for path in files.examples().values()} == {Path(name).name for name in shipped}
    assert all(shipped[name] == f"stribeck/explorer/{name}" for name in shipped)
    for title, path in files.examples().items():
        assert inputs.from_case(sb.load_case(path)).case.title == title


def test_a_preset_is_a_viscosity_and_a_fluid():
    shown, pao = choices.choose(START, "preset", "pao-10"), sb.fluids.PRESETS["pao-10"]()
    assert (shown.contact.viscosity, shown.contact.fluid) == (pao.viscosity, pao.fluid)
    shown = choices.choose(shown, "preset", "water")
    assert shown.contact.fluid == sb.fluids.Fluid() and others(shown) == set()


def test_numbers_of_a_choice_that_are_a_list_are_typed_with_commas():
    shown = choices.choose(START, "solid", "prony")
    typed = choices.with_detail(shown, "solid", "relaxation_times", "2 ms,20 ms")
    assert typed.contact.solid == Prony(["2 ms", "20 ms"], [1.0, 0.5])
    with pytest.raises(sb.InputError, match="as many of both"):
        choices.with_detail(shown, "solid", "relaxation_times", "1 ms")


def test_an_empty_field_of_a_choice_says_the_number_that_it_stands_for(subtests):
    for name in choices.CHOICES:
        with subtests.test(name=name):
            for value, option in choices.CHOICES[name].options.items():
                optional = option.optional
                if value in ("", "table") or not optional:
                    continue
                shown = choices.choose(start_of(name), name, value)
                if "layer_thickness" in optional:
                    shown = choices.with_detail(shown, name, "layer_thickness", "1 mm")
                for key, _, text, if_empty in choices.list_of(shown, name)["details"]:
                    assert key not in optional or if_empty
                    if not text and if_empty[:1].isdigit():
                        assert choices.with_detail(shown, name, key, if_empty).contact == shown.contact, key


def test_the_axis_of_speeds_says_which_speed_it_is():
    for value, words in (("sliding", "sliding speed U (m/s)"), ("rolling", "sum of the surface speeds U (m/s)")):
        seen = Answerer()(choices.choose(START, "motion", value))
        drawn = charts.all_charts(seen)
        assert drawn["friction"]["x"]["name"] == drawn["diagram"]["x"]["name"] == words


def test_a_model_that_a_ball_cannot_have_is_refused_where_it_is_chosen():
    ball = choices.choose(START, "geometry", "point")
    assert [key for key, _ in choices.list_of(ball, "solid")["options"]] == ["half-space", "layer"]
    assert [name for name in choices.CHOICES if choices.list_of(ball, name).get("hidden")] == ["motion", "shape"]
    with pytest.raises(sb.InputError, match="soft body must be a half-space or a bonded layer"):
        choices.choose(ball, "solid", "standard-linear-solid")
    with pytest.raises(sb.InputError, match="soft body"):
        choices.choose(choices.choose(START, "solid", "prony"), "geometry", "point")


def test_alpha_and_beta_follow_a_surface_whose_numbers_are_typed():
    shown = choices.choose(START, "law", "persson")
    longer = choices.with_detail(shown, "law", "longest_wavelength", "300 um")
    q0, q1 = (2 * math.pi / length for length in (300e-6, 1.5e-6))
    surface = sb.surfaces.persson_law(sb.surfaces.SelfAffine(1e-6, q0, q1, 0.8)).coefficients
    assert longer.contact.beta == pytest.approx(surface["beta"], rel=1e-9) != shown.contact.beta
    assert longer.contact.alpha == pytest.approx(surface["alpha"], rel=1e-9)


def test_an_impossible_detail_is_refused_with_the_sentence_of_a_case(subtests):
    for name, key, text, sentence in [
        ("solid", "layer_thickness", "", "layer_thickness is missing, which this choice needs; add layer_thickness = 2 mm."),
        ("law", "hurst", "3", "hurst"),
    ]:
        with subtests.test(name=name, key=key, text=text, sentence=sentence):
            start = choices.choose(START, name, {"solid": "layer", "law": "persson"}[name])
            with pytest.raises(sb.InputError, match=sentence):
                choices.with_detail(start, name, key, text)


# --- what people type ---

TYPED = [
    ("modulus", "70 Shore A", {"shore_a": 70}),
    ("modulus", "Shore D 50", {"shore_d": 50}),
    ("modulus", "E 2 MPa", {"youngs_modulus": "2 MPa", "poisson_ratio": 0.5}),
    ("modulus", "Young's modulus 2 MPa, nu 0.49", {"youngs_modulus": "2 MPa", "poisson_ratio": 0.49}),
    ("roughness", "Ra 0.4 um", {"ra": "0.4 um"}),
    ("roughness", "0,5 um Rq", {"rq": "0.5 um"}),
    ("roughness", "Ra 0,4 um", {"ra": "0.4 um"}),
    ("modulus", "E = 2 MPa; nu = 0,3", {"youngs_modulus": "2 MPa", "poisson_ratio": 0.3}),
    ("viscosity", "46 cSt", {"kinematic_viscosity": "46 cSt", "density": "870 kg/m^3"}),
    ("viscosity", "46 cSt, 1000 kg/m^3", {"kinematic_viscosity": "46 cSt", "density": "1000 kg/m^3"}),
    ("speed", "1500 rpm, 30 mm", {"rotational_speed": "1500 rpm", "shaft_diameter": "30 mm"}),
    ("speed", "stroke 50 mm, 2 Hz", {"stroke": "50 mm", "frequency": "2 Hz"}),
    ("speed", "mean 0.5 m/s", {"entrainment_speed": "0.5 m/s"}),
    ("load", "50 N, 20 mm", {"force": "50 N", "width": "20 mm"}),
    ("load", "20 N/m, sealed pressure 10 kPa", {"load": "20 N/m", "sealed_pressure": "10 kPa"}),
    ("load", "sealed pressure 10 kPa", {"load": "30 N/m", "sealed_pressure": "10 kPa"}),
    (
        "modulus",
        "E 2 MPa, Young's modulus of the other body 3 MPa, Poisson's ratio of the other body 0.3",
        {"youngs_modulus": "2 MPa", "poisson_ratio": 0.5, "youngs_modulus_2": "3 MPa", "poisson_ratio_2": 0.3},
    ),
]


def test_a_data_sheets_words_are_the_input_that_the_package_converts(subtests):
    for name, text, given in TYPED:
        with subtests.test(text):
            found = choices.typed(START, name, text)
            own = {key: value for key, value in START.tables["contact"].items() if key != name}
            assert found.contact == inputs.Inputs.of({"contact": own | given}).contact
            assert inputs.row_of(found, name)["note"]
            assert reopened(url.encode(found)).inputs == found
            plain = choices.typed(found, name, "3")  # a number takes the place of all of it
            assert not inputs.row_of(plain, name)["note"] and plain.tables["contact"].keys() == START.tables["contact"].keys()


def test_a_liquid_is_typed_by_its_grade_and_temperature(subtests):
    liquids = {
        "ISO VG 46 at 60 °C": sb.fluids.PRESETS["iso-vg"](grade=46, temperature=60),
        "vg 68, 40 degC, VI 95": sb.fluids.PRESETS["iso-vg"](grade=68, temperature=40, viscosity_index=95),
        "glycerol 50 % at 20 C": sb.fluids.glycerol_water(0.5, 20),
        "water at 310 K": sb.fluids.water("310 K"),
        "silicone oil 100 cSt": sb.fluids.PRESETS["silicone-oil"](grade=100),
        "PAO 10": sb.fluids.PRESETS["pao-10"](),
        "ISO VG-46 at -10 °C": sb.fluids.PRESETS["iso-vg"](grade=46, temperature=-10),
        "water at 20,5 degrees C": sb.fluids.water(20.5),
        "oil 46 7 at 60": sb.fluids.PRESETS["oil"](viscosity_40=46, viscosity_100=7, temperature=60),
    }
    for text, liquid in liquids.items():
        with subtests.test(text):
            found = choices.typed(START, "viscosity", text).contact
            assert found.viscosity == liquid.viscosity and found.fluid == liquid.fluid


def test_words_that_mean_nothing_or_half_of_it_are_refused_with_what_to_type(subtests):
    refused = {
        ("speed", "1500 rpm"): 'shaft_diameter = "30 mm", or give speed alone. Type both, with a comma between them.',
        (
            "speed",
            "25 Hz, 30 mm",
        ): "speed = '25 Hz, 30 mm' mixes two ways to give it; type one of 1500 rpm, 30 mm; stroke 50 mm, 2",
        ("modulus", "170 Shore A"): "shore_a = 170 must be between 20 and 90",
        ("modulus", "soft"): "modulus = 'soft' does not begin with a number",
        ("viscosity", "ISO VG 46 at 600 C"): "temperature = 600 degC must lie between",
        ("viscosity", "water at 68 °F"): "temperature = '68 degF'; write it as '25 degC' or '298 K'.",
        ("viscosity", "silicone oil 1000 cP"): "grade = '1000 cP'; write a kinematic viscosity",
        ("viscosity", "water 2 mPa s"): "'s' is not understood",
        ("viscosity", "water 50 %"): "weight_fraction is no condition of water",
        ("viscosity", "oil 46 cSt at 40 °C, 7 cSt at 100 °C"): "has two values of temperature",
        ("radius", "10 mm; 20 mm"): "radius = '10 mm; 20 mm' has two values of radius; type one.",
    }
    for (name, text), said in refused.items():
        with subtests.test(text), pytest.raises(sb.InputError, match=re.escape(said)) as problem:
            choices.typed(START, name, text)
        assert ("Type both" in str(problem.value)) == (text == "1500 rpm")


def test_what_to_change_is_told_with_the_smallest_change_marked(answer, rested):
    names = ["speed", "load", "roughness", "viscosity"]
    assert [name for (name, *_), *_ in parts_of(answer)["answer"]["ways"][1:]] == names  # the curve tells the first at once
    (_, *heads), *rows = parts_of(rested)["answer"]["ways"]
    assert [text for text, *_ in heads] == ["to boundary", "to hydrodynamic"] and [name for (name, *_), *_ in rows] == names
    assert rows[1][1][0] == "not reachable"  # by the load, as the command says
    for margin, (_, *cells) in zip(regime_margins(START.contact).margins, rows, strict=True):
        marks = [mark.factor for mark in (margin.less, margin.more) if mark is not None]
        assert sorted(float(factor) for *_, factor, _ in cells if factor) == pytest.approx(sorted(marks), rel=1e-6)
    for column in zip(*(cells for _, *cells in rows), strict=True):
        sizes = {abs(math.log(float(factor))): look for *_, factor, look in column if factor}
        assert [size for size, look in sizes.items() if look == "least"] == [min(sizes)]


def test_every_input_and_number_has_its_words_and_an_anchor_of_the_page_of_words(answer):
    page, parts = words_page(), parts_of(answer)
    for geometry in ("line", "point"):
        for name in (*inputs.FIELDS[geometry], *inputs.GROUP_FIELDS):
            assert len(inputs.help_of(name, geometry)) > 30 and ":math:" not in inputs.help_of(name, geometry), name
            assert f'id="{name}"' in page
    for name in choices.CHOICES:
        assert choices.list_of(START, name)["help"] and f'id="{name}"' in page
    for row in parts["numbers"]:
        assert row["help"] and row["tip"].endswith(".") and f'id="{row["key"]}"' in page, row["key"]
    [load] = re.findall('<dt id="load">.*?</dd>', page)
    assert load.index("[N/m]") < load.index("Of a ball") < load.index("[N]")


# --- whether the model applies ---


def test_what_is_outside_the_model_stands_above_every_number(rested):
    steel = inputs.with_text(inputs.with_text(START, "modulus", "100 GPa"), "load", "100 kN/m")
    shown = Answerer()(steel)
    expected = sb.check(steel.contact)
    assert not expected.applies and shown.checks.verdict == "outside"
    main = parts_of(shown)["answer"]
    assert main["verdict"] == "outside" and main["headline"] == shown.checks.headline
    assert {each.sentence for each in expected.with_verdict("outside")} <= set(main["reasons"])
    assert parts_of(rested)["answer"]["headline"] == sb.check(START.contact).headline


def test_the_verdict_of_the_page_is_that_of_the_check_where_the_curve_leaves_the_range_of_the_law():
    shown = START.replace(boundary_friction=0.001)
    answer = Answerer()(shown)
    assert answer.curve.found.law_in_doubt.any()
    said = {each.name: each.verdict for each in sb.check(shown.contact)}
    assert {each.name: each.verdict for each in answer.checks}.items() <= said.items()


def test_a_picture_has_a_verdict_when_all_checks_are_made(answer, rested):
    said = [[each.get_text() for each in files.figure_of(shown, "curve").texts] for shown in (answer, rested)]
    told = [any("The model applies" in text for text in texts) for texts in said]
    assert told == [False, True] and answer.checks.headline != rested.checks.headline  # which has the minimum too


def test_slow_work_of_a_page_ends_between_its_steps():
    ball = sb.load_case(EXAMPLES / "rubber_ball.toml").contact
    began, pool, ended = time.monotonic(), Threads(), []

    def watch():
        if time.monotonic() - began > 0.3:
            ended.append(time.monotonic())
            raise TimeoutError

    with pytest.raises(TimeoutError):
        asyncio.run(run(pool.slow, sb.propagate, ball, {"load": 0.1, "viscosity": 0.1}, watch=watch))
    pool.close()
    assert len(ended) == 1 and time.monotonic() - began < 2.3


def pinned(name, contact=START.contact, definition="balanced", speeds=(1e-5, 1.0)):
    """Return a pinned contact with its curve."""
    curve = Answerer().curve(contact, definition, speeds)
    return Pinned(name, contact, definition, curve, sb.solve(contact, rtol=1e-4))


def test_pinned_contacts_stand_beside_the_present_one(answer):
    assert table.comparison(answer) == []
    rows = table.comparison(replace(answer, pins=[pinned("half", START.contact.replace(load=15))]))
    assert rows[0] == ["", "present", "half"]
    friction = sb.solve(START.contact.replace(load=15)).friction(definition="balanced").total
    [shown] = [row[2] for row in rows if row[0] == "Friction µ"]
    assert float(shown) == pytest.approx(friction, rel=1e-3)
    ball = pinned("ball", BALL.contact)
    mixed = table.comparison(replace(answer, pins=[ball, pinned("same", START.contact)]))
    hersey = {row[0]: row[1:] for row in mixed if row[0].startswith("Hersey number")}
    own, other = (f"{each.hersey_number:.4g}" for each in (START.contact, BALL.contact))
    assert sorted(hersey.values()) == sorted([[own, "", own], ["", other, ""]])  # each of a cylinder or of a ball


def test_a_fit_takes_the_inputs_that_are_chosen_and_tells_intervals_and_residuals():
    speeds = np.geomspace(1e-4, 1e-1, 12)
    truth = START.contact.replace(boundary_friction=0.4)
    curve = sb.stribeck_curve(truth, speed=speeds, method="atlas")
    noisy = curve.friction.total * np.exp(0.02 * np.random.default_rng(3).standard_normal(len(speeds)))
    rows = "\n".join(f"{speed!r},{mu!r}" for speed, mu in zip(speeds.tolist(), noisy.tolist(), strict=True))
    [measured] = read_measured("m.csv", f"speed [m/s],friction\n{rows}\n".encode(), START.contact)
    fitted = fit_measured(START, measured, lambda *_: None, ["boundary_friction"])
    [only] = fitted.found.inputs
    assert only.name == "boundary_friction" and only.interval_95[0] < 0.4 < only.interval_95[1]
    assert fitted.inputs == START.edited({"boundary_friction": only.value}, errors=fitted.found.errors)
    published = START.replace(definition="published")  # as the curve beside the points, and the command
    [other] = fit_measured(published, measured, lambda *_: None, ["boundary_friction"]).found.inputs
    assert other.value == sb.fit(measured.source, published.case, free=["boundary_friction"]).inputs[0].value != only.value
    assert fitted.report.startswith("Fitted to m.csv: dry friction coefficient 0.")
    chart = charts.residual_chart(fitted.found)
    [points] = [each["data"] for each in chart["series"] if each["type"] == "points"]
    assert [y for _, y in points] == pytest.approx(fitted.found.residuals, rel=1e-4)
    assert chart["x"]["low"] < speeds[0] < speeds[-1] < chart["x"]["high"] and chart["x"]["unit"] == "m/s"


@pytest.mark.slow
def test_a_fit_on_the_page_takes_the_table_fit_of_its_case_as_the_command_does(tmp_path):
    asked = {"free": ["boundary_friction"], "noise": "absolute", "magnitudes": True, "units": {"speed": "mm/s"}}
    asked |= {"columns": {"speed": "v", "friction": "f"}, "priors": {"boundary_friction": {"value": 0.4, "factor": 1.1}}}
    now = inputs.Inputs.of(START.tables | {"fit": asked})
    rows = ["v;f", "-0.1;-0.58", "0;0", "0.1;0.6", "1;0.47", "3;0.29", "10;0.11", "30;0.04"]
    path, case = tmp_path / "m.csv", tmp_path / "case.toml"
    path.write_text("\n".join(rows))
    case.write_text(toml_text(now.tables))
    [measured] = read_file("measured", path.name, path.read_bytes(), now.contact, asked)
    fitted = fit_measured(now, measured, lambda *_: None)
    found, told = fitted.found["boundary_friction"], sb.fit(path, case)["boundary_friction"]
    assert (found.value, found.interval_95) == (
        told.value,
        told.interval_95,
    ) and fitted.inputs.contact.boundary_friction == found.value
    two = fit_measured(now, measured, lambda *_: None, ["boundary_friction", "roughness"])
    kept = two.inputs.replace(load="50 N/m").case.errors  # with which the page draws its band, and which it saves
    assert kept == pytest.approx(two.found.errors) and kept.correlations == pytest.approx(two.found.errors.correlations)
    assert kept.correlations
    each = inputs.Inputs.of(START.tables | {"fit": {"free": ["roughness"], "per_curve": ["roughness"]}})
    text = "curve;speed [mm/s];friction\n" + "".join(f"{name};{row}\n" for name in "ab" for row in rows[3:])
    measured = read_file("measured", "two.csv", text.encode(), each.contact, each.tables["fit"])
    assert [row[0] for row in fit_measured(each, measured[0], lambda *_: None).shown["rows"]] == [
        "roughness (a)",
        "roughness (b)",
    ]


def test_a_number_of_a_fluid_that_the_page_does_not_fit_is_named():
    fluid = {"model": "carreau", "relaxation_time": "1 ms", "exponent": 0.7}
    now = inputs.Inputs.of(START.tables | {"fluid": fluid, "fit": {"free": ["boundary_friction", "relaxation_time"]}})
    rows = b"speed [mm/s],friction\n0.1,0.65\n3,0.45\n10,0.28\n30,0.12\n100,0.08\n"
    [measured] = read_measured("m.csv", rows, now.contact)
    assert "does not fit relaxation_time, free in [fit]; stribeck fit does." in reading_for_fit(now, measured)
    assert "does not fit" not in reading_for_fit(START, measured)


def test_a_fitted_roughness_scales_a_surface_on_the_page_as_by_the_command(tmp_path):
    surface = {"h_rms": '"1 um"', "hurst": "0.8", "longest_wavelength": '"100 um"', "shortest_wavelength": '"1 um"'}
    own = dict.fromkeys(("roughness", "alpha", "beta"))
    path, case = tmp_path / "m.csv", tmp_path / "case.toml"
    case.write_text(case_text(own | {"law": '"persson"'}, surface=surface))
    path.write_text("speed [mm/s],friction\n0.1,0.65\n3,0.45\n10,0.28\n30,0.12\n100,0.08\n")
    now = inputs.from_case(sb.load_case(case))
    [measured] = read_measured(path.name, path.read_bytes(), now.contact)
    fitted, told = fit_measured(now, measured, lambda *_: None, ["roughness"]), sb.fit(path, case, free=["roughness"])
    assert (fitted.found["roughness"].value, fitted.found.contact.beta) == pytest.approx(
        (told["roughness"].value, told.contact.beta), rel=1e-6
    )
    shown = fitted.inputs.contact
    assert (shown.roughness, shown.beta) == pytest.approx((told.contact.roughness, told.contact.beta), rel=1e-6)


def test_columns_that_no_header_names_are_read_as_the_page_maps_them():
    content = b"A;B;C\n1;0.5;x\n10;0.2;x\n1;0.6;y\n"
    with pytest.raises(sb.InputError, match="none of which is known as speed or friction"):
        read_measured("odd.csv", content, START.contact)
    assert headers_of("odd.csv", content) == ["A", "B", "C"]
    asked = {"columns": {"speed": "A", "friction": "B", "curve": "C"}, "units": {"speed": "mm/s"}}
    one, two = read_file("measured", "odd.csv", content, START.contact, asked)
    assert one.speed.tolist() == [1e-3, 1e-2] and two.friction.tolist() == [0.6] and one.name == "odd.csv: x"
    with pytest.raises(sb.InputError, match="'D'"):
        read_measured("odd.csv", content, START.contact, {"columns": {"speed": "D"}})


def test_the_program_and_the_commands_that_are_copied_solve_what_is_shown(subtests, tmp_path, monkeypatch):
    ball = choices.choose(START, "geometry", "point").replace(definition="published")
    seal = inputs.from_case(sb.load_case(EXAMPLES / "nitrile_seal.toml"))
    monkeypatch.chdir(tmp_path)
    for now, is_short in ((START, True), (ball, True), (seal, False)):
        model = Answerer()
        shown = model(now)
        program = files.CODES["python"](shown)
        with subtests.test(now.case.title):
            assert ("case.toml" not in program) == is_short
            found = {}
            exec(program.partition("sb.stribeck_curve")[0], found)  # noqa: S102 - what a user would run
            assert found["contact"].groups == now.contact.groups and found["state"].rtol == now.case.rtol
            script = files.CODES["command"](shown)
            subprocess.run(["sh", "-c", script.partition("stribeck solve")[0]], check=True)
            assert sb.load_case("case.toml").contact.groups == now.contact.groups


def test_the_axis_of_speeds_holds_all_that_was_measured(answer):
    low, high = answer.speeds
    text = f"curve;speed [m/s];friction\na;{low / 5!r};0.6\na;{high!r};0.1\nb;{low!r};0.5\nb;{3 * high!r};0.2\n"
    measured = read_measured("two.csv", text.encode(), START.contact)
    wider = Answerer()(START, (), measured)
    ends = wider.speeds
    assert ends[0] <= low / 5 and ends[1] >= 3 * high
    assert ends == pytest.approx((wider.curve.speed[0], wider.curve.speed[-1]))


# --- answers ---


def test_dry_friction_changes_no_film_of_a_ball(monkeypatch):
    rubber = inputs.from_case(sb.load_case(EXAMPLES / "rubber_ball.toml"))
    ball = choices.choose(rubber, "cavitation", "none").replace(rtol=1e-4)
    model = Answerer()
    model(ball)
    for name in ("solve_from", "solve_cold"):  # not asked
        monkeypatch.setattr(f"stribeck.solver.neighbours.{name}", None)
    drier = ball.replace(boundary_friction=0.3, speed=ball.contact.speed)
    found = model(drier).solution
    assert found.contact == drier.contact
    assert found.friction().total == pytest.approx(sb.solve(drier.contact, rtol=1e-4).friction().total, rel=1e-4)


def test_the_scale_of_a_films_map_begins_at_the_minimum_film():
    answer = Answerer()(inputs.from_case(sb.load_case(EXAMPLES / "pdms_ball.toml")).replace(speed="0.3 mm/s", rtol=1e-3))
    assert answer.plane is not None
    drawn = charts.plane_chart(answer.plane, answer)
    least = answer.solution.minimum_gap * answer.inputs.contact.hertz.indentation
    [film] = drawn["series"]
    assert film["low"] == math.log10(least) <= min(film["data"]) + 1e-3 and film["high"] >= max(film["data"]) - 1e-3


def test_the_numbers_are_those_of_solve_within_their_errors():
    model = Answerer()
    model(START)
    moved = inputs.with_slider(START, "load_group", inputs.position(START, "load_group") + 0.3)
    rows = {row.key: row for row in table.numbers(model(moved))}
    expected = {number.name: number.value for number in report_rows(sb.solve(moved.contact))}
    for key in ("friction_published", "friction_balanced", "fluid_load_share", "central_film_thickness", "lambda_ratio"):
        assert abs(rows[key].value - expected[key]) <= 2 * rows[key].error, key
    assert rows["hersey_number"].value == expected["hersey_number"] and rows["hersey_number"].error == 0


def test_a_share_of_asperities_below_its_error_is_shown_as_a_bound():
    now = START.edited({"speed": "10 m/s"})
    [row] = [row for row in table.numbers(Answerer()(now)) if row.key == "contact_friction_share"]
    assert 0 < row.value < row.error and re.fullmatch(r"< \de-0[67]", row.text)


def test_the_curve_and_its_transitions_are_those_of_the_solver(answer):
    curve = sb.stribeck_curve(START.contact, speed=answer.speeds, points=31)
    for definition in ("published", "balanced"):
        found = np.exp(np.interp(np.log(curve.values), np.log(answer.curve.speed), np.log(answer.curve.friction[definition])))
        solved = [s.friction(definition=definition).total for s in curve.solutions]
        assert np.allclose(found, solved, rtol=2e-3)
    marks = {mark.name: mark.value for mark in curve.transitions}
    for name, words in (
        ("boundary", "fluid carries 5 % of the load"),
        ("hydrodynamic", "asperities cause 10 % of the friction"),
    ):
        mark = answer.curve.marks[name]
        assert abs(math.log(mark.value / marks[words])) < mark.error


def test_gap_and_pressure_are_drawn_as_they_are_within_their_axes(subtests, answer):
    hertz, profile = START.contact.hertz, answer.profile
    pressures = {"total": profile.pressure, "contact": profile.contact_pressure, "fluid": profile.fluid_pressure}
    expected = {
        "gap": {"gap": hertz.indentation * profile.gap, "rms": np.full(2, START.contact.roughness)},
        "pressure": {key: hertz.pressure * each for key, each in pressures.items()},
    }
    unit = {"nm": 1e-9, "µm": 1e-6, "Pa": 1.0, "kPa": 1e3, "MPa": 1e6, "mm": 1e-3}
    drawn = charts.all_charts(answer)
    for name, lines in expected.items():
        along, up = drawn[name]["x"], drawn[name]["y"]
        for series in drawn[name]["series"]:
            x, y = np.array(series["data"], float).T
            with subtests.test(chart=name, series=series["id"]):
                assert along["low"] <= x.min() and x.max() <= along["high"] and up["low"] <= y.min() and y.max() <= up["high"]
                if series["id"] in lines:
                    assert np.allclose(unit[up["unit"]] * y, lines[series["id"]], rtol=1e-5)
                    ends = unit[along["unit"]] * x[[0, -1]]
                    assert np.allclose(ends, hertz.half_width * profile.x[[0, -1]], rtol=1e-5)


def test_outside_the_atlas_the_curve_is_solved_at_rest_and_the_last_one_is_marked_stale():
    heavy = inputs.from_case(sb.load_case(EXAMPLES / "nitrile_seal.toml"))
    model = Answerer()
    first = model(heavy)
    assert first.curve is None and first.diagram is None
    assert solve(model, heavy) and not solve(model, heavy)
    now = model(heavy)
    assert "curve" not in now.stale and "solved" in now.curve.source
    steps = np.diff(np.log(now.curve.friction[heavy.case.definition]))
    bottom = int(np.argmin(now.curve.friction[heavy.case.definition]))
    assert np.abs(steps[bottom - 1 : bottom + 1]).max() < 0.03  # no kink where friction turns
    default = np.log(now.curve.friction[heavy.case.definition])
    friction = np.exp(np.interp(np.log(heavy.contact.speed), np.log(now.curve.speed), default))
    assert friction == pytest.approx(sb.solve(heavy.contact).friction(definition=heavy.case.definition).total, rel=0.02)
    heavier = model(inputs.with_slider(heavy, "load", inputs.position(heavy, "load") + 0.1))
    assert "curve" in heavier.stale and not heavier.curve.marks
    light = model(START)
    layered = model(choices.choose(START, "solid", "layer"))  # no table: what was read before stays too
    assert {"curve", "diagram"} <= layered.stale and "curve" not in light.stale
    assert np.array_equal(layered.curve.speed, light.curve.speed)
    assert charts.friction_chart(heavier)["series"][0]["faint"]


def test_the_first_solved_curve_is_coarse_and_says_so_and_at_rest_a_finer_one_replaces_it():
    rolling = choices.choose(START, "motion", "rolling")
    model = Answerer()
    assert solve(model, rolling)
    coarse = model(rolling).curve
    assert solve(model, rolling, 1) and not solve(model, rolling, 1)
    fine = model(rolling).curve
    assert not solve(model, rolling)
    assert coarse.found.rtol > fine.found.rtol and coarse.found.error_estimate <= coarse.found.rtol
    for name in ("boundary", "minimum", "hydrodynamic"):
        first, then = coarse.marks[name], fine.marks[name]
        assert abs(math.log(first.value / then.value)) < first.error + then.error


def test_the_curve_of_a_pinned_contact_that_a_link_brings_is_solved_at_rest():
    rolling, model = choices.choose(START, "motion", "rolling"), Answerer()
    opened = url.decode(parse_qsl(url.encode(START, [rolling])), START)
    assert opened.pins == (rolling,) and model(opened.inputs, opened.pins).pins[0].curve is None  # there is no table of it
    list(model.at_rest(opened.inputs, opened.pins)[-1](always))
    found = model(opened.inputs, opened.pins).pins[0].curve.found
    assert found.at([1e-2]).friction == pytest.approx(sb.solve(rolling.replace(speed=1e-2).contact).friction().total, rel=1e-3)


def test_a_contact_at_the_end_of_double_precision_has_no_curve_and_says_why():
    now = inputs.with_text(START, "load_group", "1e-300")  # at 1 m/s its groups would leave that range
    model = Answerer()
    assert solve(model, now)
    with pytest.raises((sb.InputError, sb.SolveError)):
        curves.solved_curve(now.contact, "balanced", always)
    assert curves.hersey_scale(now.contact) > 0


@pytest.mark.slow
def test_the_solved_curve_of_a_ball_is_within_a_per_cent_of_its_states_between_its_points():
    ball = sb.load_case(EXAMPLES / "rubber_ball.toml").contact.replace(cavitation="none", cavity_pressure=0.0)
    shown = curves.solved_curve(ball, "balanced", always)
    for i in (20, 58, 71, 84):
        exact = sb.solve(ball.replace(speed=float(shown.speed[i])), rtol=1e-4).friction().total
        assert shown.friction["balanced"][i] == pytest.approx(exact, rel=1e-2)


def test_rest_smooth_and_frictionless_contacts_are_shown(subtests):
    for change in [{"speed": 0.0}, {"roughness": 0.0}, {"boundary_friction": 0.0}]:
        with subtests.test(change=change):
            shown = Answerer()(START.replace(**change))
            rows = {row.key: row for row in table.numbers(shown)}
            assert rows["friction_balanced"].value == pytest.approx(sb.solve(shown.inputs.contact).friction().total, rel=1e-6)
            assert set(charts.all_charts(shown)) == {"friction", "gap", "pressure", "diagram"}


# --- charts ---


def shape_drawn(shown):
    """Return the title of the drawing of the shape, and its chart, None for a cylinder."""
    parts = parts_of(Answerer()(shown))
    return parts["shape"], parts["charts"].get("shape")


def test_the_shape_of_a_body_that_is_no_parabola_is_drawn_in_its_own_measures():
    lip = choices.choose(START, "shape", "lip")
    now = lip.edited({}, lip.tables | {"profile": lip.tables["profile"] | {"reversed": True}})
    words, chart = shape_drawn(now)
    dry = sb.profiles.dry_contact(now.contact.profile, now.contact.load, now.contact.modulus)
    x, height = np.array(next(each["data"] for each in chart["series"] if each["id"] == "shape")).T
    metres = [units.to_si(f"1 {chart[axis]['unit']}", "length", axis) for axis in "xy"]
    expected = now.contact.profile.gap(-(x * metres[0] + dry.centre))
    assert words == "Shape of the body: lip with two sides"
    assert height * metres[1] == pytest.approx(expected - expected.min(), abs=2e-5 * np.ptp(expected))
    assert chart["x"]["low"] < -dry.half_width / metres[0] and dry.half_width / metres[0] < chart["x"]["high"]
    touched = next(each["data"] for each in chart["series"] if each["name"] == "dry contact")
    assert np.ptp(np.array(touched)[:, 0]) * metres[0] == pytest.approx(2 * dry.half_width, rel=1e-5)


def test_a_case_whose_shape_stands_in_a_file_is_shown_and_its_shape_drawn_from_anywhere(tmp_path):
    rows = "".join(f"{x},{x**2 / 20 * 1e3 + 7}\n" for x in np.linspace(-2, 2, 21))
    (tmp_path / "edge.csv").write_text("x (mm),z (um)\n" + rows)
    tables = choices.choose(START, "shape", "land").tables | {"profile": {"shape": "table", "x": "edge.csv"}}
    (tmp_path / "case.toml").write_text(toml_text(tables))
    shown = inputs.from_case(sb.load_case(tmp_path / "case.toml"))
    words, chart = shape_drawn(shown)
    x, height = np.array(next(each["data"] for each in chart["series"] if each["id"] == "shape")).T
    assert shape_drawn(START) == ("", None)
    assert words == "Shape of the body: measured shape" and (chart["x"]["unit"], chart["y"]["unit"]) == ("µm", "µm")
    assert height == pytest.approx(x**2 / 20e3, abs=2e-4)
    check_kept(shown)
    assert "profile" not in others(choices.choose(shown, "shape", "cylinder"))


def test_a_case_whose_rubber_stands_in_a_file_is_shown_with_the_series_that_was_fitted(tmp_path):
    omega = np.geomspace(1.0, 1e4, 25)
    stiffness = 2.0 * (1 + 1.5 * 1j * omega * 1e-2 / (1 + 1j * omega * 1e-2))
    rows = "".join(f"{w};{e.real};{e.imag}\n" for w, e in zip(omega / (2 * np.pi), stiffness, strict=True))
    (tmp_path / "rubber.csv").write_text("frequency [Hz];E' [MPa];E'' [MPa]\n" + rows)
    tables = {**START.tables, "solid": {"master_curve": "rubber.csv"}}
    tables["contact"] = {name: value for name, value in tables["contact"].items() if name != "modulus"}
    (tmp_path / "case.toml").write_text(toml_text(tables))
    case = sb.load_case(tmp_path / "case.toml")
    shown = inputs.from_case(case)  # the page has no files
    assert shown.contact.modulus == case.contact.modulus == pytest.approx(2e6 / 0.75, rel=1e-3)
    assert shown.contact.solid == case.contact.solid
    check_kept(shown)


def test_a_moved_speed_moves_the_point_and_no_curve(answer):
    model = Answerer()
    before = charts.all_charts(model(START))
    moved = inputs.with_slider(START, "speed", inputs.position(START, "speed") + 0.05)
    after = charts.all_charts(model(moved))
    for name in ("friction", "diagram"):
        pairs = zip(before[name]["series"], after[name]["series"], strict=True)
        assert [new["id"] for old, new in pairs if old != new] == ["point"]
        assert all(before[name][key] == after[name][key] for key in before[name] if key != "series")


def test_a_pin_and_a_measured_curve_are_drawn_over_the_chosen_abscissa(answer):
    contact = START.contact
    [measured] = read_measured("m.csv", b"speed [mm/s], friction\n1, 0.5\n10, 0.2\n", answer.inputs.contact)
    pin = pinned("twice", contact.replace(viscosity=2 * contact.viscosity), speeds=answer.speeds)
    over = replace(answer, inputs=replace(answer.inputs, abscissa="hersey"), pins=[pin], measured=[measured])
    series = {s["name"]: s["data"] for s in charts.friction_chart(over)["series"]}
    hersey = contact.viscosity / contact.load
    assert series["m.csv"] == [
        [pytest.approx(1e-3 * hersey, rel=1e-5), 0.5],
        [pytest.approx(1e-2 * hersey, rel=1e-5), 0.2],
    ]
    assert series["twice"][0][0] == pytest.approx(2 * hersey * answer.curve.speed[0], rel=1e-5)
    kept = pinned("kept", contact, "published", answer.speeds)  # whatever is chosen for the present one
    [drawn] = [s["data"] for s in charts.friction_chart(replace(answer, pins=[kept]))["series"] if s["name"] == "kept"]
    assert drawn[60][1] == pytest.approx(kept.curve.found.at(kept.curve.speed[60]).friction, rel=1e-5)
    assert drawn[60][1] != pytest.approx(answer.curve.sizes["balanced"][60], rel=1e-3)
    assert series["present point"][0][0] == pytest.approx(contact.hersey_number, rel=1e-5)


def colours(theme):
    """Return the colours of charts in the light or the dark theme by name."""
    light, dark = re.findall(r"\{(.*?)\}", (EXPLORER / "chart.css").read_text(), re.DOTALL)[:2]
    return dict(re.findall(r"--(\w+): (#\w{6});", dark if theme == "dark" else light))


def test_every_colour_is_there_by_light_and_by_dark_and_pictures_have_the_light_ones():
    light, dark = colours("light"), colours("dark")
    assert light.keys() == dark.keys() and all(light[name] != dark[name] for name in light)
    assert (light["ink"], light["contact"], light["fluid"], light["mark"]) == (
        style.INK,
        style.CONTACT,
        style.FLUID,
        style.MARK,
    )
    assert {name: light[name] for name in style.TINTS} == style.TINTS and light["grey"] == style.GREY
    named = set(re.findall(r'(?:colour|fill): "(\w+)"', (EXPLORER / "chart.js").read_text())) - {"none"}
    assert named <= light.keys() and {"mark", "point", "contact"} <= named


# --- files ---


def test_the_case_that_is_downloaded_reproduces_what_is_shown(tmp_path, answer):
    odd = inputs.with_slider(START, "load_group", -1.37).replace(definition="balanced", title='a "quoted" \\ title')
    shown = Answerer()(odd)
    path = tmp_path / "case.toml"
    path.write_bytes(files.content("toml", shown))
    case = sb.load_case(path)
    assert case.contact == odd.contact
    assert (case.definition, case.title, case.curve.points) == ("balanced", odd.case.title, 121)
    assert case.curve.range == (shown.curve.speed[0], shown.curve.speed[-1])
    assert read_case("case.toml", path.read_bytes()).contact == odd.contact


def rows_of(content):
    lines = [line for line in content.decode().splitlines() if not line.startswith("#")]
    return list(csv.DictReader(io.StringIO("\n".join(lines))))


def test_the_csv_holds_the_curve_and_the_pins_at_the_same_speeds(answer):
    pin = pinned("pinned, once", START.contact.replace(load=15), speeds=answer.speeds)
    content = files.content("csv", replace(answer, pins=[pin]))
    rows = rows_of(content)
    assert len(rows) == 121
    assert float(rows[60]["friction_balanced [1]"]) == answer.curve.friction["balanced"][60]
    speed = float(rows[60]["speed [m/s]"])
    there = pin.curve.found.at(speed).friction
    assert float(rows[60]["friction_pin_1 [1]"]) == pytest.approx(there, rel=1e-9)
    text = content.decode()
    assert "# pin_1: pinned, once\n" in text and f"# input_load: {START.contact.load}\n" in text
    assert text.startswith("# source: stribeck") or f"# title: {START.case.title}\n" in text


def test_the_profile_is_downloaded_in_si_units(answer):
    rows = rows_of(files.content("profile.csv", answer))
    x = np.array([float(row["x [m]"]) for row in rows])
    total = np.array([float(row["contact_pressure [Pa]"]) + float(row["fluid_pressure [Pa]"]) for row in rows])
    solved = sb.solve(START.contact).to_si(x)
    assert np.allclose(total, solved.pressure, atol=1e-4 * solved.pressure.max())
    assert np.allclose([float(row["gap [m]"]) for row in rows], solved.gap, rtol=1e-3)


def test_pictures_are_whole_and_hold_pinned_and_measured_curves(answer):
    measured = read_measured("m.csv", b"speed [m/s],friction\n0.001,0.5\n", answer.inputs.contact)
    shown = replace(answer, pins=[pinned("pinned")], measured=measured)
    assert files.content("curve.png", shown).startswith(b"\x89PNG")
    assert ElementTree.fromstring(files.content("state.svg", shown)).tag.endswith("svg")
    figure = files.figure_of(shown, "curve")
    [legend] = figure.legends
    assert {"pinned", "m.csv", "from the fluid"} <= {text.get_text() for text in legend.get_texts()}


def test_a_pin_is_named_after_what_differs_from_the_start():
    assert files.pin_name(START, START, []) == "start"
    other = inputs.with_text(inputs.with_text(START, "load", "50"), "roughness", "2 um")
    assert files.pin_name(other, START, []) == "load 50 N/m, roughness 2 µm"
    assert files.pin_name(START, START, ["start"]) == "start (2)"


def test_a_measured_curve_is_read(subtests):
    for text, speed, friction in [
        ("speed [m/s],friction\n0.1,0.3\n0.01,0.5\n", [0.01, 0.1], [0.5, 0.3]),
        ("# from the lab\nspeed [mm/s];friction\n\n10;0,5\n20;0,25\n", [0.01, 0.02], [0.5, 0.25]),
        ("\ufefffriction\tSpeed (um/s)\n0.5\t1e4\n", [0.01], [0.5]),
        ("Hersey number,friction [%]\n1e-5,50\n2e-5,40\n", [0.006, 0.012], [0.5, 0.4]),
        ("Hersey number,friction,viscosity [mPa*s]\n1e-5,0.5,100\n2e-5,0.4,100\n", [0.003, 0.006], [0.5, 0.4]),
        ("eta U [mPa*m],friction\n1,0.5\n2,0.4\n", [0.02, 0.04], [0.5, 0.4]),
    ]:
        with subtests.test(text=text, speed=speed, friction=friction):
            [found] = read_measured("m.csv", text.encode(), START.contact)
            assert found.name == "m.csv"
            assert np.allclose(found.speed, speed, rtol=1e-12) and np.allclose(found.friction, friction, rtol=1e-12)


def test_a_page_says_how_a_measured_file_was_read_and_what_it_means():
    rows = b"mean speed [um/s];COF\n100;0.560\n1.000;0.497\n3.000;\n10.000;0.270\n"
    [found] = read_measured("m.csv", rows, START.contact)
    said = reading(found)
    assert "speed = 2 x 'mean speed [um/s]'" in said and "'1.000' was read as 1, not as 1000." in said
    assert "1 row without a value left out: 4." in said and "[fit.columns]" not in said
    assert reading_for_fit(START, found).startswith(said)


def test_measured_points_stand_at_their_own_hersey_number_also_after_a_change(subtests):
    for contact in [START.contact, BALL.contact]:
        with subtests.test(contact=contact):
            text = "curve;speed [m/s];viscosity [mPa*s];friction\na;0.01;50;0.6\nb;0.02;10;0.5\n"
            later = contact.replace(viscosity=0.2)  # what the file does not say follows the page
            for found, viscosity in zip(read_measured("two.csv", text.encode(), contact), (0.05, 0.01), strict=True):
                own = later.replace(speed=float(found.speed[0]), viscosity=viscosity).hersey_number
                assert found.places(later, "hersey") * curves.hersey_scale(later) == pytest.approx(own, rel=1e-12)
                assert found.places(later, "speed") == found.speed
            [found] = read_measured("h.csv", b"Hersey number [-],friction\n1e-5,0.5\n", contact)
            for abscissa in ("hersey", "speed"):  # also over the speed, where the curve moves with viscosity and load
                assert found.places(later, abscissa) * curves.hersey_scale(later) == pytest.approx(1e-5, rel=1e-12)
            [found] = read_measured("e.csv", b"eta U [mPa*m],friction\n1,0.5\n", contact)
            assert found.places(later, "speed") * later.viscosity == pytest.approx(1e-3, rel=1e-12)


# --- server ---


def test_a_port_in_use_is_refused_and_another_is_found():
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        with pytest.raises(sb.InputError, match="is not free or not allowed; choose another with --port"):
            server.listen(taken.getsockname()[1])
    with server.listen(None) as first, server.listen(None) as second:
        assert first.getsockname()[1] < second.getsockname()[1]
        assert {first.getsockname()[1], second.getsockname()[1]} <= set(server.DEFAULT_PORTS)
    with pytest.raises(sb.InputError, match="port = 70000 must be a whole number from 1 to 65535"):
        server.listen(70000)


# --- the command ---


def test_a_wrong_argument_is_refused_with_exit_code_2(subtests, capsys):
    for arguments, sentence in [
        (["nowhere.toml"], "nowhere.toml"),
        (["--port", "eighty"], "port = 'eighty' is not a whole number"),
        (["--port", "0"], "port = 0 must be a whole number from 1 to 65535."),
    ]:
        with subtests.test(arguments=arguments, sentence=sentence):
            assert main(["explore", "--no-browser", *arguments]) == 2
            assert sentence in capsys.readouterr().err


def test_without_nicegui_it_says_how_to_install_it(monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "nicegui", None)
    assert main(["explore", "--no-browser"]) == 2
    assert "the explorer needs nicegui; install it with: pip install 'stribeck[app]'." in capsys.readouterr().err


def test_ctrl_c_ends_it_with_exit_code_0(monkeypatch, capsys):
    def interrupted(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr("stribeck.explorer.server.serve", interrupted)
    assert main(["explore"]) == 0
    assert capsys.readouterr().err == ""


@pytest.mark.slow
def test_the_map_of_a_ball_is_solved_row_by_row(monkeypatch):
    monkeypatch.setitem(curves.SOLVED_ROWS, "point", curves.SolvedRows(33, 5, 1e-2))
    contact = sb.load_case(EXAMPLES / "pdms_ball.toml").contact
    told = []
    [found] = curves.solved_diagram(contact, "balanced", (1e-2, 10.0), -5, told.append)
    assert found.part == 1 and told[-1] == 1
    row = contact.replace(roughness=float(found.roughness[0]))
    boundary, hydrodynamic, _ = found.lines[:, 0]
    friction = sb.solve(row.replace(speed=hydrodynamic), rtol=1e-3).friction()
    assert friction.asperities / friction.total == pytest.approx(0.1, rel=0.05)
    assert boundary == 0  # the fluid carries more than a twentieth at the slowest speed


def test_rows_of_a_map_have_the_transitions_of_their_own(monkeypatch):
    monkeypatch.setitem(curves.SOLVED_ROWS, "line", curves.SOLVED_ROWS["line"]._replace(step=8))
    contact = choices.choose(START, "motion", "rolling").contact
    *_, found = curves.solved_diagram(contact, "balanced", (1e-7, 1.0), -7, lambda _: None)
    assert len(found.roughness) == 33
    for roughness, boundary, hydrodynamic in zip(found.roughness[::8], *found.lines[:2, ::8], strict=True):
        row = contact.replace(roughness=float(roughness))
        if 1e-7 < boundary < 1.0:
            assert sb.solve(row.replace(speed=boundary)).fluid_load_share == pytest.approx(0.05, rel=1e-2)
        if 1e-7 < hydrodynamic < 1.0:
            friction = sb.solve(row.replace(speed=hydrodynamic)).friction()
            assert friction.asperities / friction.total == pytest.approx(0.1, rel=1e-2)
    between = contact.replace(roughness=float(found.roughness[12]), speed=float(found.lines[0, 12]))
    assert sb.solve(between).fluid_load_share == pytest.approx(0.05, rel=0.15)
    assert found.lines[0, -1] > 1.0 and np.isfinite(found.lines[0]).all()  # beyond the axis too, up to a decade


def test_a_file_of_heights_becomes_the_surface_of_the_contact():
    found = read_scan("../profile.csv", PROFILE)
    assert found.report.startswith("Surface of profile.csv: rms height 611 nm, alpha 1.81 (1.7 to 2.22), beta 0.0197 (")
    after = with_scan(START, found)
    surface = sb.surfaces.analyse(sb.surfaces.read_topography(EXAMPLES / "cylinder_profile.csv"))
    law = surface.law
    assert after.contact.roughness == pytest.approx(surface.roughness.h_rms, rel=1e-6)
    assert after.contact.law.name == "persson" and after.contact.beta == pytest.approx(law.beta, rel=1e-5)
    separation = np.array([0.1, 1.0, 3.0])
    np.testing.assert_allclose(after.contact.law.log_pressure(separation), law.log_pressure(separation), rtol=1e-5)
    assert url.decode(parse_qsl(url.encode(after)), START).inputs.contact == after.contact


def test_a_file_that_holds_nothing_of_use_is_refused_under_its_name(subtests):
    heights = "\n".join(f"{x} {y} {(x * y) % 7}" for x in range(8) for y in range(8))
    for name, content, words in [
        ("s.xyz", heights.encode(), "^s.xyz.* write it in the header as in (?!.*--)"),
        ("a.csv", b"x, y\nno, numbers\n", "^a.csv.* As a file of heights: a.csv"),
        ("a.x3p", b"no zip", "a.x3p is damaged|a.x3p does not start like"),
        ("m.csv", b"speed [m/s],friction\n1,0.5\n2,-1\n", "^m.csv.*row 3, column 'friction'"),
        ("g.xyz", b"x (um) y (um) z (um)\n" + heights.encode(), "heights: g.xyz: 8 x 8 points"),
    ]:
        with subtests.test(name), pytest.raises(sb.InputError, match=f"(?s){words}"):
            read_file("measured", name, content, START.contact)
    curve = b"speed [m/s];friction\n0.001;0.5\n0.01;0.3\n0.1;0.2\n"
    for name in ("a." + 300 * "x", "a.\0csv", "../../a.csv"):
        with subtests.test(name):
            assert len(read_file("measured", name, curve, START.contact)) == 1
            assert read_file("headers", name, curve, START.contact) == ["speed [m/s]", "friction"]


def test_history_goes_back_and_forth_and_forgets_what_was_undone_before_a_change():
    states = [server.example()]
    for speed in (2e-3, 3e-3, 4e-3):
        states.append(states[0].replace(speed=speed))
    past = History(states[0])
    assert past.steps == {"undo": False, "redo": False} and past.step(-1, states[0]) is None
    past.rest(states[1])
    past.rest(states[1])
    assert past.step(-1, states[2]) == states[1]  # what has not come to rest is a step too
    assert past.step(-1, states[1]) == states[0] and past.steps == {"undo": False, "redo": True}
    assert past.step(1, states[0]) == states[1]
    past.rest(states[3])
    assert past.step(1, states[3]) is None and past.step(-1, states[3]) == states[1]
    for k in range(300):
        past.rest(states[k % 2])
    assert len(past.states) == 100


# --- what errors leave open ---


@pytest.fixture(scope="module")
def uncertain(tmp_path_factory):
    """Return the case with errors, and the answer of a page that knows what they do."""
    path = tmp_path_factory.mktemp("case") / "case.toml"
    text = (EXAMPLES / "pdms_cylinder.toml").read_text()
    path.write_text(re.sub(r'^(load = "30 N/m)"', r'\1 +- 10 %"', text, flags=re.MULTILINE))
    case = sb.load_case(path)
    assert case.errors
    shown, model = inputs.from_case(case), Answerer()
    model(shown)
    assert solve(model, shown, SPREAD) and not solve(model, shown, SPREAD) and solve(model, shown, CHECKS)
    assert solve(model, shown, MARGINS)
    return case, model(shown)


def test_the_numbers_have_the_intervals_of_the_command_and_the_curve_has_their_band(uncertain):
    case, answer = uncertain
    rows = {row.key: row for row in table.numbers(answer)}
    low, high = sb.propagate(case.contact, case.errors)["friction"].interval_95
    assert rows[f"friction_{case.definition}"].interval == f"{low:.3g} to {high:.3g}"
    assert sum("count as exact" in each for each in parts_of(answer)["remarks"]) == 1
    assert not any(each["interval"] for each in parts_of(Answerer()(START))["numbers"])
    assert answer.checks.headline.split(":")[0] in str(sb.check(case.contact, **case.facts)).split("\n")[0]
    band = answer.curve.band
    at = len(band.values) // 2
    found = sb.propagate(case.contact.replace(speed=float(band.values[at])), case.errors, transitions=False)["friction"]
    assert (band.low[at], band.high[at]) == pytest.approx([end / found.value for end in found.interval_95], rel=1e-9)
    assert (band.low < 1).all() and (band.high > 1).all()
    kinds = [each["type"] for each in charts.friction_chart(answer)["series"]]
    assert kinds[:2] == ["bands", "area"]  # what comes first is painted first, and the colours of regimes cover what is there


def test_a_picture_has_no_band_where_the_interval_is_not_settled(monkeypatch):
    unsettled = {"friction": SimpleNamespace(value=1.0, interval_95=(0.1, 2.0))}
    states = iter([(), ("not settled",), (), *[()] * 10])

    def propagated(*_, **__):
        return type("State", (dict,), {"notes": next(states)})(unsettled)

    monkeypatch.setattr(propagate_module, "propagate", propagated)
    band = propagate_module.friction_band(TRUE, {"load": 0.1}, (1e-3, 1.0))
    low, high = band.along(band.values, np.ones(13))
    assert np.isnan(low[1]) and np.isnan(high[1]) and np.delete(low, 1) == pytest.approx(0.1)
