"""Case files: what is read from them, and what is said about those that cannot be used."""

import re
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from command_line import EXAMPLES, case_text, toml_of
from fit_data import TRUE
from hypothesis import given, settings
from hypothesis import strategies as st

import stribeck as sb
from stribeck import Case, InputError, load_case

CASES = sorted(path for path in EXAMPLES.glob("*.toml") if "\n[vary]\n" not in path.read_text())
BALLS = [path for path in CASES if 'geometry = "point"' in path.read_text()]
CYLINDERS = [path for path in CASES if path not in BALLS]


def toml(top="", contact=None, **tables):
    """Return the text of a case; None takes a contact key away."""
    return case_text(contact, **tables).replace('title = "A case"', top)


@pytest.fixture
def write(tmp_path):
    def write(content):
        path = tmp_path / "case.toml"
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return path

    return write


@pytest.fixture
def problems(write):
    """Return the sentences about a case, without its path."""

    def problems(content):
        path = write(content)
        with pytest.raises(InputError) as caught:
            load_case(path)
        lines = str(caught.value).splitlines()
        assert all(line.startswith(str(path)) and line.endswith(".") for line in lines)
        return [line.removeprefix(str(path)).removeprefix(":").strip() for line in lines]

    return problems


# --- what is read ---


def test_a_case_with_a_contact_alone_has_the_defaults_also_behind_a_byte_order_mark(write):
    path = write(b"\xef\xbb\xbf" + toml().encode())
    assert load_case(path) == Case(path=path, contact=TRUE)
    curve = load_case(str(path)).curve
    assert (curve.over, curve.range, curve.points) == ("speed", None, 101)


def test_every_key_of_a_case_is_read(write, problems):
    pair = {"modulus": None, "youngs_modulus": '"2 MPa"', "poisson_ratio": "0.5"}
    text = toml(
        top='title = "T"\nnotes = "N"',
        contact=pair | {"law": '"exponential"', "speed": None, "entrainment_speed": '"5 mm/s"'},
        curve={"over": '"load"', "range": '["1 N/m", 2e3]', "points": "7"},
        solver={"rtol": "1e-9", "definition": '"balanced"'},
    )
    case = load_case(write(text))
    assert (case.contact.modulus, case.contact.speed) == (pytest.approx(2e6 / 0.75, rel=1e-15), 0.01)
    assert (case.curve.over, case.curve.range, case.curve.points) == ("load", (1.0, 2e3), 7)
    assert (case.title, case.notes, case.law) == ("T", "N", "exponential")
    assert (case.rtol, case.definition) == (1e-9, "balanced")
    [both] = problems(toml(contact={"entrainment_speed": '"5 mm/s"'}))
    assert "are both given; give either speed, or entrainment_speed" in both


def test_the_range_is_in_the_unit_of_what_varies(write, problems):
    ball = {"geometry": '"point"', "load": '"1 N"'}
    for over, unit, contact in [("speed", "m/s", {}), ("load", "N/m", {}), ("roughness", "m", {}), ("load", "N", ball)]:
        curve = {"over": f'"{over}"', "range": f'["1 {unit}", "2 {unit}"]'}
        assert load_case(write(toml(contact=contact, curve=curve))).curve.range == (1.0, 2.0)
        [problem] = problems(toml(contact=contact, curve=curve | {"range": '["1 kg", "2 kg"]'}))
        assert problem.startswith(f"[curve] in range, {over} = '1 kg' is a mass")


# --- one problem, one sentence ---


# What is wrong in which table, and how the sentence begins.  Values that numbers cannot have are in test_schema.py.
WRONG = [
    ("contact", "load", "2024-01-01", " = datetime.date(2024, 1, 1) is not a single real"),
    ("contact", "load", None, ' is missing; add a load per unit length, for example load = "30 N/m" (as in examples/'),
    ("contact", "beta", None, " is missing; add a bare number, for example beta = 0.06 (about 1.4 q0 h_rms by Persson's"),
    ("contact", "modulus", None, " (which is E*) is missing"),
    ("contact", "law", '"greenwood"', " = 'greenwood' must be one of 'exponential'"),
    ("contact", "spede", "1", " = 1 is not a known key; did you mean speed."),
    ("contact", "eta", "1", " = 1 is not a known key; write viscosity."),
    ("contact", "friction_coefficient", "0.7", " = 0.7 is not a known key; write boundary_friction."),
    ("contact", "Shore_A", "70", " = 70 is not a known key; did you mean shore_a."),
    ("contact", "pressure_viscosity", "1e-8", " = 1e-08 is not a known key; it is pressure_coefficient in the table [fluid]"),
    ("contact", "shear_modulus", "1", " = 1 is not a known key; for the solid give modulus"),
    ("contact", "surface_speed_ratio", "1", " = 1 is not a known key; known are radius"),
    ("contact", "deviation", "1", " = 1 is not a known key; it belongs in the table [asperities]."),
    ("contact", "Ra", "1e-6", " = 1e-06 is not a known key; heights are root mean squares"),
    ("contact", "rtol", "1", " = 1 is not a known key; it belongs in the table [solver]."),
    ("contact", "title", "1", " = 1 is not a known key; it belongs at the top"),
    ("curve", "over", '"time"', " = 'time' must be 'speed', 'load' or 'roughness'."),
    ("curve", "points", "1", " = 1 must be a whole number from 2 to 100000."),
    ("curve", "points", "true", " = True must be a whole number"),
    ("curve", "range", "[2, 1]", " = [2, 1] must increase; write the lowest speed first."),
    ("curve", "range", "[1, 2, 3]", " = [1, 2, 3] must be a list of two values"),
    ("solver", "rtol", "0.9e-11", " = 9e-12 must be a number from 1e-11 to 1e-2"),
    ("solver", "rtol", '"1e-6"', " = '1e-6' must be a number from 1e-11 to 1e-2, without quotes."),
    ("solver", "definition", '"mine"', " = 'mine' must be 'balanced' or 'published'."),
]
WRONG_TOP = {
    '"a\\nb" = 3': "'a\\nb' = 3 is not a known key; known are contact, curve,",
    "title = 3": "title = 3 must be text in quotes.",
    "solver = 3": "solver = 3 must be a table, [solver].",
    'speed = "1 m/s"': "speed = '1 m/s' is not a known key; it belongs in the table [contact].",
    "curves = 5": "curves = 5 is not a known key; did you mean curve.",
    "[flud]\nmodel = 'eyring'": "flud = {'model': 'eyring'} is not a known key; did you mean fluid.",
}


def test_a_problem_is_told_in_one_sentence_with_table_key_and_value(subtests, problems):
    cases = [(toml(**{table: {key: value}}), f"[{table}] {key}{said}") for table, key, value, said in WRONG]
    cases += [(toml(top), said) for top, said in WRONG_TOP.items()]
    ends = {"[0, 1]": "0 must be positive, because", "[-1, 1]": "-1 must be zero or positive."}
    cases += [(toml(curve={"range": pair}), f"[curve] in range, speed = {said}") for pair, said in ends.items()]
    cases.append((toml(contact={"poisson_ratio": "0.4"}), "[contact] modulus = '2.7 MPa' (which is E*) and poisson_ratio ="))
    for text, sentence in cases:
        with subtests.test(sentence):
            [found] = problems(text)
            assert found.startswith(sentence)


def test_a_file_that_is_no_case_is_refused_in_one_sentence(subtests, problems):
    for content, sentence in [
        (b"", "is empty; a case file needs at least the table [contact]."),
        (b"# only a comment\n", "is empty; a case file needs"),
        (b"\x89PNG\r\n\x1a\n\x00", "is not text (byte 0 is not UTF-8)"),
        (b"\x00\x01\x02", "is not valid TOML"),
        (b"[contact\nradius = 1", "is not valid TOML: Expected"),
        (b"[contact]\nradius = 1\nradius = 2\n", "is not valid TOML: Cannot overwrite a value (at line 3"),
        (b"[contact]\nradius = 1 mm\n", "is not valid TOML: Expected newline or end of document after a statement"),
        (b"a = " + b"[" * 50_000, "is not valid TOML"),
        (b"a = " + b"9" * 5_000, "is not valid TOML"),
        (b"#" * 1_000_001, "has more than 1000000 bytes"),
        (b"[curve]\npoints = 5", "the table [contact] is missing."),
        (b"contact = 3", "contact = 3 must be a table, [contact]."),
        (b"[[contact]]", "contact = [{}] must be a table, [contact]."),
    ]:
        with subtests.test(content=content, sentence=sentence):
            found = problems(content)
            assert len(found) == 1
            assert found[0].startswith(sentence)


def test_a_path_that_is_no_file_is_refused(tmp_path):
    for name, words in {
        "a.toml": "cannot be read (No such file",
        ".": "is a directory",
        "a\0b": "embedded null",
    }.items():
        with pytest.raises(InputError) as caught:
            load_case(tmp_path / name)
        assert words in str(caught.value)
        assert re.search("; give (the path of a TOML case file|another path)[.]$", str(caught.value))


@settings(derandomize=True, deadline=None, max_examples=150)
@given(st.data())
def test_a_damaged_case_is_read_or_refused_but_never_breaks(tmp_path_factory, data):
    text = toml(top='title = "T"', curve={"range": '["1 um/s", "1 m/s"]'}, solver={"rtol": "1e-6"}).encode()
    start = data.draw(st.integers(0, len(text)))
    length = data.draw(st.integers(0, 20))
    path = tmp_path_factory.mktemp("damaged") / "case.toml"
    path.write_bytes(text[:start] + data.draw(st.binary(max_size=12)) + text[start + length :])
    try:
        assert isinstance(load_case(path), Case)
    except InputError as refusal:
        assert str(refusal).startswith(str(path))


# --- the examples ---


def number_in_comments(path, name, between=" = "):
    """Return the number that the comments of a case state after a name, with half of its last digit."""
    words = " ".join(line.lstrip("# ") for line in path.read_text().splitlines() if line.startswith("#"))
    stated = re.search(rf"{name}{between}([0-9]+\.[0-9]*[1-9])", words)[1]
    return float(stated), 0.5 * 10.0 ** -len(stated.partition(".")[2])


def test_an_example_states_its_groups_and_has_a_law_that_holds_there(subtests):
    for path in CYLINDERS:
        with subtests.test(path=path):
            groups = load_case(path).contact.groups
            load, load_digit = number_in_comments(path, "load F")
            kappa, kappa_digit = number_in_comments(path, "kappa")
            assert groups.load == pytest.approx(load, abs=load_digit)
            assert groups.relative_roughness == pytest.approx(kappa, abs=kappa_digit)
            assert groups.load < 1 or groups.law.name == "persson"
            assert groups.load < 10


def test_an_example_states_the_suction_that_its_film_would_bear_without_an_end(subtests):
    for path in CYLINDERS:
        contact = load_case(path).contact
        if contact.cavitation != "none":
            with subtests.test(path=path):
                suction, digit = number_in_comments(path, "suction behind the contact", " is ")
                full = sb.solve(contact.replace(cavitation="none"), rtol=1e-3).profile(np.linspace(-2, 4, 1201))
                found = -full.fluid_pressure.min() * contact.hertz.pressure / 1e6
                assert found == pytest.approx(suction, abs=digit)


# --- the tables of fluid, cavitation, flow factors and solid ---

SLIDER = {
    "radius": "10 mm",
    "modulus": "2.1 MPa",
    "load": "50 N/m",
    "viscosity": "1 Pa*s",
    "entrainment_speed": "50 mm/s",
    "roughness": "1 um",
    "alpha": 2.0,
    "beta": 0.05,
    "boundary_friction": 0.8,
}


BALL = {"geometry": "point", "load": "50 mN"}


def case_of(contact=None, **tables):
    """Return the case of a file with these tables of Python values."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / "a.toml"
        path.write_text(toml_of(contact=SLIDER if contact is None else contact, **tables))
        return sb.load_case(path)


@pytest.mark.quick
def test_the_tables_become_parts_of_the_contact():
    contact = case_of(
        SLIDER | {"slide_to_roll": 1.0},
        fluid={
            "model": "carreau",
            "relaxation_time": "1 ms",
            "exponent": 0.5,
            "infinite_viscosity": "10 mPa*s",
            "pressure_coefficient": "15 1/GPa",
            "viscosity_law": "roelands",
            "density": "dowson-higginson",
        },
        cavitation={"model": "exit"},
        solid={"layer_thickness": "2 mm", "poisson_ratio": 0.5},
    ).contact
    f = sb.fluids
    assert contact.fluid == f.Fluid(f.Carreau(1e-3, 0.5, 0.01), f.Roelands(1.5e-8), f.DowsonHigginson())
    assert contact.cavitation == "exit"
    assert contact.slide_to_roll == 1.0
    assert contact.speed == 0.1
    assert contact.solid == sb.solids.Layer(2e-3, 0.5)
    assert contact.groups.model.film.name == "carreau + roelands + dowson-higginson"


@pytest.mark.quick
def test_every_model_of_a_fluid_and_every_solid_is_read():
    fluids, solids = sb.fluids, sb.solids
    for table, fluid in [
        ({"model": "eyring", "eyring_stress": "5 MPa"}, fluids.Fluid(fluids.Eyring(5e6))),
        ({"model": "cross", "relaxation_time": 0.1, "exponent": 0.7}, fluids.Fluid(fluids.Cross(0.1, 0.7))),
        ({"model": "power-law", "relaxation_time": "1 s", "exponent": 0.7}, fluids.Fluid(fluids.PowerLaw(1.0, 0.7))),
        ({"pressure_coefficient": "15 1/GPa"}, fluids.Fluid(viscosity=fluids.Barus(1.5e-8))),
        ({}, fluids.Fluid()),
    ]:
        assert case_of(fluid=table).contact.fluid == fluid
    memory, layer = {"retardation_time": "10 ms", "modulus_ratio": 3}, {"layer_thickness": "2 mm", "poisson_ratio": 0.4}
    for table, solid in [
        (memory, solids.StandardLinearSolid(0.01, 3.0)),
        ({"relaxation_times": ["1 ms", 0.01], "moduli": [1.0, 0.5]}, solids.Prony((1e-3, 0.01), (1.0, 0.5))),
        (memory | layer, solids.StandardLinearSolid(0.01, 3.0, solids.Layer(2e-3, 0.4))),
    ]:
        contact = case_of(solid=table).contact
        assert contact.solid == solid and contact.groups.model.solid.uses_speed


@pytest.mark.quick
def test_a_preset_gives_the_viscosity_too():
    contact = {name: value for name, value in SLIDER.items() if name != "viscosity"}
    liquid = {"preset": "glycerol-water", "weight_fraction": 0.8, "temperature": "20 degC"}
    case = case_of(contact, fluid=liquid)
    assert case.contact.viscosity == sb.fluids.glycerol_water(0.8, 20).viscosity
    [said] = case.conversions
    assert said.startswith("viscosity = ") and "weight_fraction = 0.8 and temperature = '20 degC': Cheng 2008" in said
    assert case.facts == {"thinning_rate": pytest.approx(3e7 / case.contact.viscosity)}  # glycerol thins at 3e7 Pa
    assert case_of(contact, fluid=liquid, check={"thinning_rate": "5e4 1/s"}).facts == {"thinning_rate": 5e4}
    thinning = case_of(contact, fluid={"preset": "xanthan"}).contact
    assert case_of(contact, fluid={"preset": "xanthan"}).facts == {}
    assert thinning.fluid == sb.fluids.PRESETS["xanthan"]().fluid
    with pytest.raises(sb.InputError, match=r"\[fluid\] preset = 'water' and viscosity = .* are both given"):
        case_of(fluid={"preset": "water"})
    for wrong in ({"preset": "honey"}, {"preset": "water", "temperature": "2 m"}, {"preset": "water", "model": "cross"}):
        with pytest.raises(sb.InputError, match=r"\[fluid\]") as refused:
            case_of(contact, fluid=wrong)
        assert "viscosity is missing" not in str(refused.value)


@pytest.mark.quick
def test_flow_factors_take_alpha_and_roughness_of_the_contact():
    flow = case_of(flow_factors={"model": "patir-cheng", "gamma": 3}).contact.groups.model.film.flow
    assert flow.gamma == 3
    assert flow.sigma == pytest.approx(1e-6 / case_of().contact.hertz.indentation)
    assert case_of(flow_factors={"model": "effective-medium"}).contact.flow_factors == sb.fluids.EffectiveMedium()
    assert case_of(flow_factors={"model": "none"}).contact == case_of().contact


# Table, what stands in it, and what is said.  Values that numbers cannot have are in test_schema.py.
WRONG_PARTS = [
    ("fluid", {"model": "carreau"}, r"\[fluid\] relaxation_time is missing, which model = 'carreau' needs"),
    ("fluid", {"model": "eyring", "eyring_stress": "5 MPa", "exponent": 1}, r"\[fluid\] exponent = 1 is given, but model"),
    ("fluid", {"modle": "carreau"}, r"\[fluid\] modle = 'carreau' is not a known key; did you mean model"),
    ("fluid", {"model": "eyring", "eyring_stress": "1e-300 Pa"}, r"\[fluid\] eyring_stress = 1e-300: thinning would begin"),
    ("fluid", {"pressure_coeff": 1}, r"\] pressure_coeff = 1 is not .*mean pressure_coefficient"),
    ("fluid", {"model": "eyring", "stress": 1e6}, r"\] stress = 1000000.0 is not a known key; write eyring_stress"),
    ("fluid", {"name": "water"}, r"\[fluid\] name = 'water' is not a known key; write preset"),
    ("fluid", {"model": "bingham"}, r"\[fluid\] model = 'bingham' must be one of"),
    ("fluid", {"viscosity_law": "barus"}, r"\[fluid\] pressure_coefficient is missing"),
    ("fluid", {"viscosity_law": "constant", "pressure_coefficient": 1}, r"\[fluid\] pressure_coefficient = 1 is given, but"),
    ("fluid", {"pressure_coefficient": "15 1/GPa", "reference_pressure": 1}, "but viscosity_law = 'barus' has no such"),
    ("fluid", {"pressure_coefficient": 1}, r"\[fluid\] pressure_coefficient times the Hertz pressure is [\d.e+]+; it must"),
    ("fluid", {"viscosity": 0.05}, r"viscosity = 0.05 is not a known key; it belongs in the table \[contact\]"),
    ("fluid", {"preset": "honey"}, r"\[fluid\] preset = 'honey' must be one of"),
    ("fluid", {"preset": "water", "model": "cross"}, r"\[fluid\] model = 'cross' is given, but a preset"),
    ("fluid", "water", r"fluid = 'water' must be a table, \[fluid\]"),
    ("solid", {"model": "half-space", "layer_thickness": "2 mm"}, r"\] layer_thickness = '2 mm' is given, but"),
    ("solid", {"model": "rubber"}, r"\[solid\] model = 'rubber' must be one of 'half-space', 'layer'"),
    ("solid", {"model": "prony", "layer_thickness": "2 mm"}, r"\[solid\] relaxation_times is missing, which .* needs"),
    ("solid", {"layer_thicknes": "2 mm"}, r"\] layer_thicknes = '2 mm' is not a .* did you mean layer_th"),
    ("solid", {"poisson_ratio": 0.5}, r"\[solid\] layer_thickness is missing"),
    ("check", {"thermal_thining": "0.04 1/K"}, "is not a known key; did you mean thermal_thinning"),
    ("solid", {"modulus_ratio": 3}, r"\[solid\] retardation_time is missing, which .* needs; add .* = \"10 ms\""),
    ("solid", {"retardation_time": "1 s", "moduli": [1]}, r"\[solid\] .* two descriptions"),
    ("solid", {"relaxation_times": "1 s", "moduli": [1]}, r"\[solid\] relaxation_times = '1 s' must be a list"),
    ("asperities", {"exponent": 3}, r"\] exponent = 3 is not a known key; known are density, radius, deviation\."),
    ("cavitation", {}, r"\[cavitation\] model is missing"),
    ("cavitation", {"model": "swift"}, "must be 'none', 'exit'"),
    ("motion", {"slide_to_roll": 1}, r"motion = .* is not a known key; write slide_to_roll in \[contact\]"),
    ("flow_factors", {"gamma": 3}, r"\[flow_factors\] model is missing"),
    ("flow_factors", {"model": "effective-medium", "gamma": 1}, r"\[flow_factors\] gamma = 1 is given"),
]


@pytest.mark.quick
def test_what_is_wrong_in_a_table_is_said_with_its_name(subtests):
    for table, entries, said in WRONG_PARTS:
        with subtests.test(said), pytest.raises(sb.InputError, match=said):
            case_of(**{table: entries})
    with pytest.raises(sb.InputError) as problem:  # all at once
        case_of(fluid={"model": "carreau"}, flow_factors={"slip": 1}, solid={})
    named = [line.split("]")[0].split("[")[1] for line in str(problem.value).split("\n")]
    assert named == ["fluid", "flow_factors", "solid"]


@pytest.mark.quick
def test_slide_to_roll_stands_in_contact_whatever_the_geometry():
    for own in ({"geometry": "line"}, BALL):
        assert case_of(SLIDER | own | {"slide_to_roll": 0.5}).contact.slide_to_roll == 0.5
        with pytest.raises(sb.InputError, match=r"\[contact\] slide_to_roll = 500 must be between"):
            case_of(SLIDER | own | {"slide_to_roll": 500})


@pytest.mark.quick
def test_data_of_a_ball_have_its_units_without_a_table_fit_too(tmp_path):
    case = sb.load_case(EXAMPLES / "tongue_model.toml")
    (tmp_path / "rig.csv").write_text("mean speed [mm/s],friction,load [N]\n10,0.4,2\n20,0.3,2\n50,0.2,2\n")
    assert sb.read_measurements(tmp_path / "rig.csv", case.fit).inputs[0]["load"] == 2.0


def test_a_ball_has_the_tables_of_a_cylinder():
    torn = case_of(SLIDER | BALL, cavitation={"model": "exit"}).contact
    assert torn.cavitation == torn.groups.model.cavitation == torn.replace(load="40 mN").cavitation == "exit"
