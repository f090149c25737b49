"""A new case runs as it is written; a report is one file with everything in it that asks no server for anything."""

import html
import re
import runpy
from pathlib import Path

import matplotlib as mpl
import pytest
from command_line import EXAMPLES, call, case_text

import stribeck as sb
from stribeck.fluids import presets

FACTS = (
    *("pressure_coefficient", "layer_thickness", "loss_tangent", "supply_film", "thinning_rate", "molecular_size"),
    *("thermal_conductivity", "thermal_thinning", "density", "work_of_adhesion", "diffusivity", "permeability", "rms_slope"),
    "stroke",
)
LAWS = ("exponential", "persson", "greenwood-williamson", "greenwood-tripp", "table")


@pytest.mark.quick
def test_a_new_case_has_every_key_and_is_read_as_it_stands(subtests, tmp_path_factory, capsys):
    for geometry in ["line", "point"]:
        with subtests.test(geometry=geometry):
            tmp_path = tmp_path_factory.mktemp("case")
            path = tmp_path / "new.toml"
            answer = call(capsys, "new", path, "--geometry", geometry)
            assert answer.code == 0 and f"stribeck check {path}" in " ".join(answer.out.split())
            case = sb.load_case(path)
            table = {"line": sb.LineContact, "point": sb.PointContact}[geometry].INPUTS
            assert case.rtol == {"line": 1e-6, "point": 1e-4}[geometry]
            text = path.read_text()
            for name in {*table.quantities, *FACTS}:
                assert re.search(rf"\b{name} = ", text), name
            for row in table.kept.values():
                assert re.search(rf"# {row.label[0].upper()}{re.escape(row.label[1:])} \[", text), row.name
            assert text.count("slide_to_roll = ") == 1
            assert call(capsys, "new", path).code == 2  # kept
            assert call(capsys, "new", "--geometry", geometry).out == text


@pytest.mark.quick
def test_a_new_case_reads_without_its_comment_signs():
    text = sb.new_case()
    facts = text[text.index("[check]") :]
    assert len(re.findall(r"^# \w+ = ", facts, re.M)) == len(FACTS)
    with pytest.raises(sb.InputError, match="geometry"):
        sb.new_case("sphere")


@pytest.mark.quick
def test_the_optional_tables_of_a_new_case_are_read_once_uncommented(tmp_path):
    text = sb.new_case()
    i = text.index("# [cavitation]")
    end = text.index("\n\n", i)
    path = tmp_path / "parts.toml"
    path.write_text(text[:i] + re.sub("^# ", "", text[i:end], flags=re.M) + text[end:])
    contact = sb.load_case(path).contact
    assert str(contact.cavitation) == "exit" and contact.solid.layer_thickness > 0


@pytest.mark.quick
def test_a_new_liquid_is_one_row_and_stands_in_new_cases_and_on_the_page(monkeypatch):
    monkeypatch.setattr(presets, "PRESETS", {**presets.PRESETS, "honey": presets.PRESETS["water"]})
    source = Path(sb.__file__).parent
    text = runpy.run_path(str(source / "data_sheet/new_case.py"))["new_case"]()
    found = runpy.run_path(str(source / "explorer/inputs/choices.py"))["CHOICES"]
    for name in ("cross", "honey", "roelands", "patir-cheng", "retardation_time", *LAWS):
        assert name in text, name
    assert "honey" in found["preset"].options and list(found["law"].options) == list(LAWS)


@pytest.fixture(scope="module")
def content(tmp_path_factory):
    path = tmp_path_factory.mktemp("report") / "seal.html"
    return path, sb.write_report(EXAMPLES / "pdms_fit.toml", path, EXAMPLES / "pdms_measured.csv")


def test_a_report_says_everything_and_asks_no_server(content):
    path, said = content
    page = path.read_text()
    assert page.index(said.headline) < page.index("<h1>") < page.index("friction")
    words = [cell for each in said.sections for row in (*each.table, each.paragraphs) for cell in row]
    assert len(said.sections) >= 6 and len(words) > 50
    for part in (*said.sentences, *words, said.versions):
        assert part in html.unescape(page), part
    for each in said.checks:
        assert each.name in page
    addresses = set(re.findall(r"https?://[^\"'\s)<]+", page))
    assert addresses <= {"http://www.w3.org/2000/svg", "http://www.w3.org/1999/xlink"}  # names, not requests
    assert not re.search(r"<script|<link|@import|url\((?!#)|src=", page)
    assert page.count("<svg") == 1 and "measured" in said.data.path
    [data] = [each.paragraphs for each in said.sections if each.heading == "Data"]
    [read] = [each for each in data if each.startswith("Read: ")]
    assert "as speed" in read and "'friction" in read and "[fit.columns]" not in read
    other = [each for each in data if "measured with" in each]  # of the first fluid the curve is drawn
    assert other == ["glycerol 50 %: measured with viscosity 5 mPa*s instead of 50 mPa*s, which the drawn curve has."]
    [inputs] = [each.table for each in said.sections if each.heading == "Inputs"]
    assert inputs[0][-1].startswith("Source") and any(source for *_, source in inputs[1:])


def test_the_picture_of_a_report_is_hatched_where_the_contact_law_is_outside_its_range(content):
    path, said = content
    assert said.curve.law_in_doubt.any() and not said.curve.law_in_doubt.all()
    assert "contact law outside its range" in path.read_text()


def test_a_lever_lowers_friction_by_a_fifth_when_solved(content):
    _, said = content
    contact = said.curve.contact
    before = sb.solve(contact).friction().total
    named = {row.label: row for row in contact.INPUTS.kept.values()}
    [table] = [each.table for each in said.sections if each.heading == "The two cheapest levers"]
    assert 1 <= len(table) - 1 <= 2
    for label, step, result in table[1:]:
        after, change = re.fullmatch(r"(\S+) \((.*) %\)", result).groups()
        assert float(after) == pytest.approx(0.8 * before, rel=0.15)
        assert float(change) == pytest.approx(100 * (float(after) / before - 1), abs=1)
        sign, factor, value = re.fullmatch(r"([x/]) (\S+) \(to (.*)\)", step).groups()
        name, dimension = named[label].name, named[label].dimension
        assert float(factor) > 1
        changed = getattr(contact, name) * float(factor) ** {"x": 1, "/": -1}[sign]
        given = float(value) if dimension == "number" else value
        assert getattr(contact.replace(**{name: given}), name) == pytest.approx(changed, rel=0.01)


def test_the_pdf_and_a_contact_outside(tmp_path, capsys, monkeypatch):
    from stribeck.regimes.margins import RegimeMargins

    monkeypatch.setattr("stribeck.regimes.overview.regime_margins", lambda *_, **__: RegimeMargins("mixed", (), ()))
    case = tmp_path / "steel.toml"
    text = case_text({"modulus": '"115 GPa"', "load": '"1 kN/m"', "speed": '"1 m/s"', "roughness": '"0.3 +- 0.1 um"'})
    case.write_text(text.replace("A case", "A case with a long title " * 6))
    with mpl.rc_context({"pdf.compression": 0}):
        answer = call(capsys, "report", case, "-o", tmp_path / "steel.pdf")
    assert (answer.code, answer.err) == (0, "")
    page = (tmp_path / "steel.pdf").read_bytes().decode("latin-1")
    lines = ["".join(re.findall(r"\(((?:\\.|[^\\)])*)\)", each)) for each in re.findall(r"\[(.*?)\]\s+TJ", page, re.DOTALL)]
    assert sum("long title" in each for each in lines) == 2 and max(map(len, lines)) < 120  # else it leaves the page
    assert answer.out.startswith("Outside the range of the model: ") and "Probability of each regime" in answer.out
    assert (tmp_path / "steel.pdf").read_bytes().startswith(b"%PDF")
    assert call(capsys, "report", case, "-o", tmp_path / "steel.pdf").code == 2  # kept
    assert "must end in .html or .pdf" in call(capsys, "report", case, "-o", tmp_path / "steel.doc").err
    assert "output is missing" in call(capsys, "report", case).err
    swapped = call(capsys, "report", tmp_path / "data.csv", tmp_path / "none.toml", "-o", tmp_path / "new.html").err
    assert "none.toml cannot be read" in swapped  # the case, in whatever order
