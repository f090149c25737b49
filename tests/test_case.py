"""Case files: what is read from them, and what is said about those that cannot be used."""

import re
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stribeck import Case, InputError, LineContact, load_case

EXAMPLES = sorted(
    path for path in (Path(__file__).parents[1] / "examples").glob("*.toml") if "\n[vary]\n" not in path.read_text()
)

BALLS = [path for path in EXAMPLES if 'geometry = "point"' in path.read_text()]
CYLINDERS = [path for path in EXAMPLES if path not in BALLS]

CONTACT = {
    "radius": '"10 mm"',
    "modulus": '"2.7 MPa"',
    "load": '"30 N/m"',
    "viscosity": '"50 mPa*s"',
    "speed": '"1 mm/s"',
    "roughness": '"1 um"',
    "alpha": "2",
    "beta": "0.06",
    "boundary_friction": "0.7",
}


def toml(top="", contact=None, **tables):
    """Return the text of a case; None takes a contact key away."""
    tables = {"contact": CONTACT | (contact or {})} | tables
    parts = [top]
    for table, entries in tables.items():
        parts.append(f"[{table}]")
        parts += [f"{key} = {value}" for key, value in entries.items() if value is not None]
    return "\n".join(parts)


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


def test_a_case_with_a_contact_alone_has_the_defaults(write):
    path = write(toml())
    contact = LineContact(
        radius=0.01,
        modulus=2.7e6,
        load=30.0,
        viscosity=0.05,
        speed=1e-3,
        roughness=1e-6,
        alpha=2.0,
        beta=0.06,
        boundary_friction=0.7,
    )
    assert load_case(path) == Case(path=path, contact=contact)
    curve = load_case(str(path)).curve
    assert (curve.over, curve.range, curve.points) == ("speed", None, 101)


def test_every_key_of_a_case_is_read(write):
    text = toml(
        top='title = "T"\nnotes = "N"',
        contact={
            "modulus": None,
            "youngs_modulus": '"2 MPa"',
            "poisson_ratio": "0.5",
            "law": '"exponential"',
        },
        curve={"over": '"load"', "range": '["1 N/m", 2e3]', "points": "7"},
        solver={"rtol": "1e-9", "definition": '"balanced"'},
    )
    case = load_case(write(text))
    assert case.contact.modulus == pytest.approx(2e6 / 0.75, rel=1e-15)
    assert (case.curve.over, case.curve.range, case.curve.points) == ("load", (1.0, 2e3), 7)
    assert (case.title, case.notes, case.law) == ("T", "N", "exponential")
    assert (case.rtol, case.definition) == (1e-9, "balanced")


def test_the_range_is_in_the_unit_of_what_varies(subtests, write, problems):
    for over, unit in [("speed", "m/s"), ("load", "N/m"), ("roughness", "m")]:
        with subtests.test(over=over, unit=unit):
            curve = {"over": f'"{over}"', "range": f'["1 {unit}", "2 {unit}"]'}
            assert load_case(write(toml(curve=curve))).curve.range == (1.0, 2.0)
            [problem] = problems(toml(curve=curve | {"range": '["1 kg", "2 kg"]'}))
            assert problem.startswith(f"[curve] in range, {over} = '1 kg' is a mass")


def test_a_byte_order_mark_is_read_over(write):
    assert load_case(write(b"\xef\xbb\xbf" + toml().encode())).contact.load == 30.0


def test_a_case_knows_every_quantity(write):
    pair = {"modulus": None, "youngs_modulus": '"2 MPa"', "poisson_ratio": "0.5"}
    second = {"radius_2", "youngs_modulus_2", "poisson_ratio_2"}
    assert set(LineContact.INPUTS.quantities) >= set(CONTACT) | set(pair) | second | {
        "entrainment_speed",
        "shore_a",
        "rq",
        "force",
    }
    assert load_case(write(toml(contact=pair))).contact.modulus > 2e6


# --- one problem, one sentence ---


def test_a_problem_is_told_in_one_sentence_with_table_key_and_value(subtests, problems):
    for changes, sentence in [
        (
            {"contact": {"load": "2024-01-01"}},
            "[contact] load = datetime.date(2024, 1, 1) is not a single real",
        ),
        (
            {"contact": {"load": None}},
            '[contact] load is missing; add a load per unit length, for example load = "30 N/m" (as in examples/',
        ),
        (
            {"contact": {"beta": None}},
            "[contact] beta is missing; add a bare number, for example beta = 0.06 (about 1.4 q0 h_rms by Persson's theory",
        ),
        ({"contact": {"modulus": None}}, "[contact] modulus (which is E*) is missing"),
        (
            {"contact": {"poisson_ratio": "0.4"}},
            "[contact] modulus = '2.7 MPa' (which is E*) and poisson_ratio =",
        ),
        ({"contact": {"law": '"greenwood"'}}, "[contact] law = 'greenwood' must be one of 'exponential'"),
        ({"contact": {"spede": "1"}}, "[contact] spede = 1 is not a known key; did you mean speed."),
        ({"contact": {"eta": "1"}}, "[contact] eta = 1 is not a known key; write viscosity."),
        (
            {"contact": {"friction_coefficient": "0.7"}},
            "[contact] friction_coefficient = 0.7 is not a known key; write boundary_friction.",
        ),
        ({"contact": {"Shore_A": "70"}}, "[contact] Shore_A = 70 is not a known key; write shore_a = 70 or shore_d = 50"),
        (
            {"contact": {"roughness": None}},
            '[contact] roughness is missing; add a length, for example roughness = "1 um" (rms height of',
        ),
        (
            {"contact": {"pressure_viscosity": "1e-8"}},
            "[contact] pressure_viscosity = 1e-08 is not a known key; it is pressure_coefficient in the table [fluid]",
        ),
        ({"contact": {"pressure_viscosity_coefficient": "1"}}, "[contact] pressure_viscosity_coefficient = 1 is not a known"),
        (
            {"contact": {"density": "900"}},
            "[contact] viscosity = '50 mPa*s' and density = 900 are both given; give either viscosity, or kinematic_",
        ),
        ({"contact": {"shear_modulus": "1"}}, "[contact] shear_modulus = 1 is not a known key; for the solid give modulus"),
        (
            {"contact": {"normal_force": "1"}},
            "[contact] normal_force = 1 is not a known key; give load: for a cylinder in N/m, or force",
        ),
        ({"contact": {"surface_speed_ratio": "1"}}, "[contact] surface_speed_ratio = 1 is not a known key; known are radius"),
        ({"contact": {"deviation": "1"}}, "[contact] deviation = 1 is not a known key; it belongs in the table [asperities]."),
        ({"contact": {"Ra": "1e-6"}}, "[contact] Ra = 1e-06 is not a known key; heights are root mean squares"),
        (
            {"contact": {"rtol": "1"}},
            "[contact] rtol = 1 is not a known key; it belongs in the table [solver].",
        ),
        ({"contact": {"title": "1"}}, "[contact] title = 1 is not a known key; it belongs at the top"),
        ({"contact": {"zzz": "1"}}, "[contact] zzz = 1 is not a known key; known are radius, modulus, load,"),
        (
            {"contact": {"beta": "1e-200"}},
            "[contact] the dimensionless groups of this contact leave the range",
        ),
        ({"curves": {"points": "5"}}, "curves = {'points': 5} is not a known key; did you mean curve."),
        ({"curve": {"over": '"time"'}}, "[curve] over = 'time' must be 'speed', 'load' or 'roughness'."),
        ({"curve": {"points": "1"}}, "[curve] points = 1 must be a whole number from 2 to 100000."),
        ({"curve": {"points": "100001"}}, "[curve] points = 100001 must be a whole number"),
        ({"curve": {"points": "5.0"}}, "[curve] points = 5.0 must be a whole number"),
        ({"curve": {"points": "true"}}, "[curve] points = True must be a whole number"),
        (
            {"curve": {"range": "[2, 1]"}},
            "[curve] range = [2, 1] must increase; write the lowest speed first.",
        ),
        ({"curve": {"range": "[1, 1]"}}, "[curve] range = [1, 1] must increase"),
        ({"curve": {"range": "[0, 1]"}}, "[curve] in range, speed = 0 must be positive, because"),
        ({"curve": {"range": "[-1, 1]"}}, "[curve] in range, speed = -1 must be zero or positive."),
        ({"curve": {"range": "[1, 2, 3]"}}, "[curve] range = [1, 2, 3] must be a list of two values"),
        ({"curve": {"range": '"1 m/s"'}}, "[curve] range = '1 m/s' must be a list of two values"),
        ({"solver": {"rtol": "0.9e-11"}}, "[solver] rtol = 9e-12 must be a number from 1e-11 to 1e-2"),
        ({"solver": {"rtol": "0.011"}}, "[solver] rtol = 0.011 must be a number from"),
        ({"solver": {"rtol": "nan"}}, "[solver] rtol = nan must be a number from"),
        (
            {"solver": {"rtol": '"1e-6"'}},
            "[solver] rtol = '1e-6' must be a number from 1e-11 to 1e-2, without quotes.",
        ),
        ({"solver": {"definition": '"mine"'}}, "[solver] definition = 'mine' must be 'balanced' or 'published'."),
        ({"top": '"a\\nb" = 3'}, "'a\\nb' = 3 is not a known key; known are contact, curve,"),
        ({"top": "title = 3"}, "title = 3 must be text in quotes."),
        ({"top": "solver = 3"}, "solver = 3 must be a table, [solver]."),
        (
            {"top": 'speed = "1 m/s"'},
            "speed = '1 m/s' is not a known key; it belongs in the table [contact].",
        ),
    ]:
        with subtests.test(changes=changes, sentence=sentence):
            found = problems(toml(**changes))
            assert len(found) == 1
            assert found[0].startswith(sentence)


def test_all_problems_are_told_at_once(problems):
    text = toml(
        top="title = 3",
        contact={"radius": "-1", "load": None, "lod": '"30 N/m"', "poisson_ratio": "0.6"},
        curve={"points": "0"},
        solver={"rtol": "1"},
    )
    found = problems(text)
    assert len(found) == 8
    for key in (
        "title",
        "radius",
        "load is missing",
        "lod",
        "poisson_ratio = 0.6",
        "modulus",
        "points",
        "rtol",
    ):
        assert any(key in sentence for sentence in found)


def test_a_file_that_is_no_case_is_refused_in_one_sentence(subtests, problems):
    for content, sentence in [
        (b"", "is empty; a case file needs at least the table [contact]."),
        (b"# only a comment\n", "is empty; a case file needs"),
        (b"\x89PNG\r\n\x1a\n\x00", "is not text (byte 0 is not UTF-8)"),
        (b"\x00\x01\x02", "is not valid TOML"),
        (b"[contact\nradius = 1", "is not valid TOML: Expected"),
        (b"[contact]\nradius = 1\nradius = 2\n", "is not valid TOML: Cannot overwrite a value (at line 3"),
        (
            b"[contact]\nradius = 1 mm\n",
            "is not valid TOML: Expected newline or end of document after a statement (at line 2, column 12); "
            "a value with a unit needs quotes",
        ),
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


def test_a_path_that_is_no_file_is_refused(subtests, tmp_path_factory):
    for name, words in [
        ("missing.toml", "cannot be read (No such file"),
        (".", "is a directory"),
        ("a\0b", "cannot be looked up (embedded"),
    ]:
        with subtests.test(name=name, words=words):
            tmp_path = tmp_path_factory.mktemp("case")
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


def number_in_comments(path, name):
    """Return the number that the comments of a case state for a group, with half of its last digit."""
    words = " ".join(line.lstrip("# ") for line in path.read_text().splitlines() if line.startswith("#"))
    stated = re.search(rf"{name} = ([0-9]+\.[0-9]*[1-9])", words)[1]
    return float(stated), 0.5 * 10.0 ** -len(stated.partition(".")[2])


def test_the_examples_are_there():
    cylinders = ["lip_seal", "nitrile_seal", "pdms_cylinder", "pdms_fit", "reciprocating_cylinder", "rod_seal"]
    assert [path.stem for path in CYLINDERS] == [*cylinders, "wiper_blade", "wiper_edge", "worn_rod_seal"]
    assert {"pdms_ball", "contact_lens"} <= {path.stem for path in BALLS}


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


def test_the_demo_case_lies_well_inside_the_range_of_the_law():
    case = load_case(CYLINDERS[2])
    assert 0.05 < case.contact.groups.load < 0.3
    assert case.contact.radius == 0.01
    assert case.contact.modulus == 2.7e6


def test_every_quantity_of_an_example_has_a_comment_above(subtests):
    for path in CYLINDERS:
        with subtests.test(path=path):
            lines = path.read_text().splitlines()
            contact = lines[lines.index("[contact]") + 1 :]
            above = ""
            for line in contact[: next((i for i, line in enumerate(contact) if line.startswith("[")), None)]:
                if "=" in line and line.split(" =")[0] in LineContact.INPUTS.quantities and "poisson" not in line:
                    assert above.startswith("#"), line
                above = line


def test_a_case_takes_the_entrainment_speed_in_place_of_the_speed(write, problems):
    mean = toml(contact={"speed": None, "entrainment_speed": '"5 mm/s"'})
    assert load_case(write(mean)).contact.speed == 0.01
    [both] = problems(toml(contact={"entrainment_speed": '"5 mm/s"'}))
    assert "are both given; give either speed, or entrainment_speed" in both
