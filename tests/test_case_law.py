"""Contact laws in case and sweep files and on the command line: named, read from their tables, and told in every output."""

import json
import math
import re

import numpy as np
import pytest
from command_line import CONTACT, PDMS, call, case_text
from sweep_files import write

import stribeck as sb
from stribeck.contact_laws import GreenwoodTripp, GreenwoodWilliamson

SURFACE = {"h_rms": '"1 um"', "hurst": "0.8", "longest_wavelength": '"300 um"', "shortest_wavelength": '"0.3 um"'}
ASPERITIES = {"density": '"1e10 1/m^2"', "radius": '"10 um"', "deviation": '"0.5 um"'}
OF_SURFACE = {"alpha": None, "beta": None, "roughness": None}
ROWS = "separation, pressure\n0, 1\n1, 0.4\n2, 0.15\n4, 0.02\n8, 0.0003\n"


@pytest.fixture
def case(tmp_path):
    """Return a function that writes a case under a law and returns its path."""
    (tmp_path / "law.csv").write_text(ROWS)
    (tmp_path / "bad.csv").write_text("wavenumber [1/m], density [m^4]\n1e3, 1e-20\n2e3, 1e-21\n1e3, 1e-22\n")
    (tmp_path / "half.csv").write_text("separation [um], pressure\n0, 162\n0.5, 64.8\n1, 24.3\n2, 3.24\n")
    (tmp_path / "si.csv").write_text("gap [um], pressure [kPa]\n0, 162\n0.5, 64.8\n1, 24.3\n2, 3.24\n4, 0.0486\n")

    def make(law, changes=None, **tables):
        contact = {"law": f'"{law}"'} | (OF_SURFACE if {"surface", "asperities"} & set(tables) else {}) | (changes or {})
        path = tmp_path / "case.toml"
        path.write_text(case_text(contact, **tables))
        return path

    return make


def test_persson_and_its_coefficients_come_from_the_surface(case):
    found = sb.load_case(case("persson", surface=SURFACE))
    law = sb.surfaces.persson_law(
        sb.surfaces.SelfAffine(h_rms=1e-6, q0=2 * math.pi / 300e-6, q1=2 * math.pi / 0.3e-6, hurst=0.8)
    )
    assert found.law == found.contact.law.name == "persson"
    assert (found.contact.alpha, found.contact.beta) == pytest.approx((law.alpha, law.beta), rel=1e-9)
    assert found.contact.roughness == pytest.approx(1e-6, rel=1e-12)


def test_a_measured_spectrum_is_read_beside_its_case(case, tmp_path):
    spectrum = sb.surfaces.SelfAffine(h_rms=1e-6, q0=2e4, q1=2e7, hurst=0.8).spectrum
    rows = zip(spectrum.wavenumber * 1e-3, spectrum.density * 1e12, strict=True)
    numbers = "\n".join(f"{q:.17g}; {c:.17g}" for q, c in rows)
    expected = sb.surfaces.persson_law(spectrum, 0.5)
    for header in ("wavenumber; density", "q; C", "q; C(q)", "Wave number; PSD", "q; Power spectral density"):
        wavenumber, density = header.split("; ")
        (tmp_path / "C.csv").write_text(f"{wavenumber} [1/mm]; {density} [mm^4]\n{numbers}")
        found = sb.load_case(case("persson", surface={"spectrum": '"C.csv"', "gamma": "0.5"})).contact.law
        assert (found.alpha, found.beta, found.rms_slope) == pytest.approx((expected.alpha, expected.beta, expected.rms_slope))


def test_an_exponential_law_takes_its_coefficients_from_the_surface_and_knows_its_area(case):
    found = sb.load_case(case("exponential", surface=SURFACE)).contact
    full = sb.load_case(case("persson", surface=SURFACE)).contact
    assert (found.alpha, found.beta) == (full.alpha, full.beta)
    assert sb.solve(found).law == "exponential"
    assert 0 < sb.solve(found).central_area_fraction < 1


def test_asperities_give_the_coefficients_or_the_contact_does(case):
    for law, kind in (("greenwood-williamson", GreenwoodWilliamson), ("greenwood-tripp", GreenwoodTripp)):
        found = sb.load_case(case(law, asperities=ASPERITIES)).contact
        expected = kind.coefficients(density=1e10, radius=1e-5, deviation=5e-7)
        assert {name: getattr(found, name) for name in expected} == pytest.approx(expected, rel=1e-12)
        bare = sb.load_case(case(law, {"alpha": "1.0"})).contact
        assert found.law == bare.law == kind() and (bare.alpha, bare.beta) == (1.0, 0.06)
        assert sb.load_case(case(law, {"alpha": None})).contact == bare  # it is that of the law
        inputs = {name: getattr(bare, name) for name in bare.INPUTS.names if name != "alpha"}
        assert sb.LineContact(**inputs, law=law) == bare
    assert sb.load_case(case("exponential", {"alpha": "1.0"})).contact.law is None


def test_a_table_is_read_beside_its_case_with_or_without_units(case):
    plain = sb.load_case(case("table", table={"file": '"law.csv"'})).contact.law
    units = sb.load_case(case("table", table={"file": '"si.csv"'})).contact.law
    poisson = {"modulus": None, "youngs_modulus": '"2.025 MPa"', "poisson_ratio": "0.5"}
    other = sb.load_case(case("table", poisson, table={"file": '"si.csv"'})).contact.law
    for law in (units, other):
        assert law.separation == pytest.approx(plain.separation)
        assert law.pressure == pytest.approx(plain.pressure, rel=1e-12)


# Law, changes of the contact, its tables, and what is said; a table `surface` changes SURFACE, one `alone` stands for it.
WRONG = [
    ("persson", OF_SURFACE, {}, "the table [surface] is missing, which law = 'persson' needs; give h_rms"),
    ("persson", {"beta": "0.06"}, {"surface": {}}, "[contact] beta = 0.06 follows from the table [surface]; remove"),
    (
        "persson",
        {"rq": "1e-6"},
        {"surface": {}},
        "[contact] roughness = 1e-06 follows from the table [surface], by its h_rms (ra and rq",
    ),
    ("persson", {}, {"surface": {"hurst": "1.5"}}, "[surface] hurst = 1.5"),
    ("persson", {}, {"surface": {"hurst": None}}, "hurst is missing; add a bare number, for example hurst = 0.8."),
    ("persson", {}, {"surface": {"Hurst": "0.8"}}, "[surface] Hurst = 0.8 is not a known key; did you mean"),
    ("persson", {}, {"surface": {"spectrum": '"C.csv"'}}, "[surface] h_rms = '1 um' follows from the file"),
    ("persson", {}, {"surface": {"density": "[1.0]"}}, "follows from the spectrum; remove one of them"),
    ("persson", {}, {"surface": {"shape_only": '"yes"'}}, "[surface] shape_only = 'yes' must be true or false"),
    ("persson", {}, {"surface": {"shape_only": "true"}}, "[contact] roughness is missing"),
    ("persson", {}, {"alone": {"spectrum": '"law.csv"'}}, "first line must be 'wavenumber [1/m], density [m^4]'"),
    (
        "persson",
        {},
        {"alone": {"spectrum": '"bad.csv"'}},
        "bad.csv: wavenumber in row 4 = 1000 is not above the one before it",
    ),
    ("persson", {}, {"alone": {"spectrum": "3"}}, "[surface] spectrum = 3 must be text in quotes"),
    ("persson", {}, {"alone": {"wavenumber": "[1.0]"}}, "[surface] density is missing"),
    ("persson", {}, {"asperities": ASPERITIES}, "the table [asperities] is not used by law = 'persson'; it belongs to"),
    ("greenwood-tripp", {}, {"asperities": ASPERITIES | {"radius": None}}, "[asperities] radius is missing; add a length"),
    ("greenwood-tripp", {"beta": None}, {}, "[contact] beta is missing; add"),
    ("table", {}, {}, "the table [table] is missing, which law = 'table' needs; give file there."),
    ("table", {}, {"table": {"file": '"none.csv"'}}, "none.csv cannot be read"),
    (
        "table",
        {},
        {"table": {"file": '"half.csv"'}},
        "half.csv: the header is 'separation [um], pressure', in which 'pressure' has no unit",
    ),
    ("table", {}, {"table": {"file": "3"}}, "[table] file = 3 must be text in quotes"),
    ("table", {}, {"table": {}}, "[table] file is missing; add the name of a CSV file"),
    ("table", {}, {"table": {"file": '"law.csv"', "pressure": "[1]"}}, "[table] file = 'law.csv' and pressure are both given"),
    ("table", {}, {"table": {"separation": "[0, 1, 2, 4]"}}, "[table] pressure is missing; add as many numbers"),
    ("table", {}, {"table": {"separation": "[0, 1]", "pressure": "[1]"}}, "separation has 2 numbers and pressure 1"),
    ("table", {}, {"table": {"separation": "[0, true]", "pressure": "[1, 2]"}}, "[0, True] must be a list of numbers"),
    ("linear", {}, {}, "[contact] law = 'linear' must be one of 'exponential', 'persson'"),
]


def test_what_is_wrong_with_a_law_is_told_in_one_sentence(subtests, case):
    for law, changes, tables, sentence in WRONG:
        with subtests.test(sentence):
            named = {name: SURFACE | entries if name == "surface" else entries for name, entries in tables.items()}
            named |= {"surface": named.pop("alone")} if "alone" in named else {}
            with pytest.raises(sb.InputError) as caught:
                sb.load_case(case(law, changes, **named))
            first, *others = str(caught.value).splitlines()
            assert sentence in first and len(others) == (2 if "roughness is missing" in sentence else 0)


def test_every_output_names_the_law_and_its_parameters(case, capsys, tmp_path):
    path = case("persson", surface=SURFACE, curve={"range": '["1 um/s", "0.1 m/s"]', "points": "5"})
    law = sb.load_case(path).contact.law
    state = call(capsys, "solve", path, "--json").out
    assert json.loads(state)["contact_law"] == "persson"
    assert json.loads(state)["contact_law_parameters"]["beta"] == law.beta
    assert 0 < json.loads(state)["central_area_fraction"] < 1
    said = call(capsys, "solve", path, "-v").out
    assert f"Contact law: persson (alpha {law.alpha:.4g}, beta {law.beta:.4g}" in said
    assert "real contact area at x = 0" in said
    curve = call(capsys, "curve", path, "--json", "-o", tmp_path / "c.csv", "--plot", tmp_path / "c.svg").out
    assert json.loads(curve)["contact_law_parameters"]["gamma"] == 0.45
    text = (tmp_path / "c.csv").read_text()
    assert "# contact_law: persson\n" in text and f"# contact_law_beta: {law.beta}\n" in text
    assert "central_area_fraction [1]" in text
    assert "persson contact law (alpha" in " ".join((tmp_path / "c.svg").read_text().split())


def test_groups_take_the_name_of_a_law_without_parameters(case, capsys):
    tokens = ("solve", "--groups", "1e-5", "0.1", "1e-4", "--json")
    found = json.loads(call(capsys, *tokens, "--law", "greenwood-tripp").out)
    assert found["contact_law"] == "greenwood-tripp"
    assert found["central_gap"] == sb.solve(sb.Groups(1e-5, 0.1, 1e-4), law="greenwood-tripp").central_gap
    refused = call(capsys, *tokens, "--law", "persson")
    assert refused.code == 2 and "law = 'persson'; names are 'exponential'" in refused.err
    few = ("--range", "1e-6", "1", "--points", "5", "--json")
    curve = call(capsys, "curve", "--groups", "0.1", "1e-3", *few, "--law", "greenwood-tripp")
    assert json.loads(curve.out)["contact_law"] == "greenwood-tripp"
    answer = call(capsys, "solve", case("persson", surface=SURFACE), "--law", "exponential")
    assert answer.code == 2 and "--law = exponential goes with --groups only" in answer.err


SWEEP = """
[contact]
{}
[surface]
{}
[vary]
load = ["10 N/m", "100 N/m"]
speed = {{ range = ["1 um/s", "0.1 m/s"], points = 3 }}
"""


def sweep_text(law="persson"):
    contact = {"law": f'"{law}"'} | {
        k: v for k, v in CONTACT.items() if k not in ("load", "speed", "alpha", "beta", "roughness")
    }
    return SWEEP.format(*("\n".join(f"{k} = {v}" for k, v in table.items()) for table in (contact, SURFACE)))


def test_a_sweep_solves_its_states_under_the_law_of_its_file(tmp_path):
    done = sb.sweep(write(tmp_path, sweep_text()), tmp_path / "store")
    assert done.finished == 6 and not done.failed
    design = sb.load_sweep(tmp_path / "sweep.toml")
    data = done.to_dataset()
    assert data.attrs["contact_law"] == "persson"
    assert data.attrs["contact_law_gamma"] == 0.45
    assert ((data["central_area_fraction"] > 0) & (data["central_area_fraction_error"] < 1e-6)).all()
    groups = sb.Groups(*design.groups[1], law=design.contact_law)
    gaps = data["central_gap"].values.ravel()
    assert gaps[1] == pytest.approx(sb.solve(groups, rtol=1e-8).central_gap, rel=1e-5)
    assert np.abs(gaps[1] / sb.solve(sb.Groups(*design.groups[1])).central_gap - 1) > 1e-3


def test_a_sweep_of_another_law_or_table_is_another_sweep(tmp_path):
    surfaces = sweep_text(), sweep_text("exponential"), sweep_text().replace("hurst = 0.8", "hurst = 0.7")
    assert len({sb.load_sweep(write(tmp_path, text)).fingerprint for text in surfaces}) == 3
    text = '[groups]\nlaw = "table"\nload = 0.3\nroughness = 0.003\n[table]\nfile = "law.csv"\n[vary]\nspeed = [0, 1e-5]\n'
    prints = set()
    for last in ("0.0003", "0.0004"):
        (tmp_path / "law.csv").write_text(ROWS.replace("0.0003", last))
        prints.add(sb.load_sweep(write(tmp_path, text)).fingerprint)
    assert len(prints) == 2


def test_what_varies_in_a_sweep_is_not_also_said_by_its_surface(tmp_path):
    text = sweep_text().replace("[vary]", '[vary]\nroughness = ["1 um", "2 um"]')
    with pytest.raises(sb.InputError, match=r"\[vary\] roughness = 1e-06 follows from the table \[surface\]"):
        sb.load_sweep(write(tmp_path, text))


# --- one file that needs no other ---


def test_lists_of_numbers_stand_for_the_file_of_a_law_or_a_spectrum(case):
    in_file = sb.load_case(case("table", table={"file": '"law.csv"'})).contact
    lists = {"separation": "[0, 1, 2, 4, 8]", "pressure": "[1, 0.4, 0.15, 0.02, 0.0003]"}
    in_case = sb.load_case(case("table", table=lists)).contact
    assert (in_case.law.separation, in_case.law.pressure) == (in_file.law.separation, in_file.law.pressure)
    spectrum = sb.surfaces.SelfAffine(h_rms=1e-6, q0=2e4, q1=2e7, hurst=0.8).spectrum
    lists = {"wavenumber": str(spectrum.wavenumber.tolist()), "density": str(spectrum.density.tolist())}
    found, expected = sb.load_case(case("persson", surface=lists)).contact.law, sb.surfaces.persson_law(spectrum)
    assert (found.alpha, found.beta, found.rms_slope) == (expected.alpha, expected.beta, expected.rms_slope)


def test_a_surface_may_give_the_shape_of_its_law_alone(case):
    own = {"alpha": "1.5", "beta": "0.02", "roughness": '"2 um"'}
    found = sb.load_case(case("persson", own, surface=SURFACE | {"shape_only": "true"})).contact
    whole = sb.load_case(case("persson", surface=SURFACE)).contact
    assert (found.alpha, found.beta, found.roughness) == (1.5, 0.02, 2e-6)
    s = np.geomspace(0.1, 10, 7)
    assert (found.law.log_pressure(s) == whole.law.log_pressure(s)).all()


# --- one word ---


def test_a_law_refuses_the_alpha_of_another_and_says_what_its_own_numbers_are(capsys, case):
    for law in ("greenwood-williamson", "greenwood-tripp"):
        answer = call(capsys, "solve", case(law))
        assert answer.code == 2 and answer.out == ""
        assert "alpha = 2 is of another contact law" in answer.err and "[asperities]" in answer.err


def test_a_contact_takes_the_name_of_a_law_as_solve_does():
    contact = sb.load_case(PDMS).contact.replace(alpha=1.0)
    named = contact.replace(law="greenwood-tripp")
    assert named == contact.replace(law=GreenwoodTripp())
    assert sb.LineContact(**dict(contact.inputs()), law="greenwood-tripp") == named
    assert sb.Groups(1e-3, 0.1, 1e-3, law="greenwood-tripp") == sb.Groups(1e-3, 0.1, 1e-3, law=GreenwoodTripp())
    assert contact.replace(law="exponential").law is None
    for make in (contact.replace, lambda law: sb.solve(contact, law=law), lambda law: sb.Groups(1, 1, 1, law=law)):
        with pytest.raises(sb.InputError, match="law = 'greenwod'; names are 'exponential', "):
            make(law="greenwod")
    with pytest.raises(sb.InputError, match="alpha = 2 is of another contact law"):
        sb.solve(contact.replace(alpha=2.0), law="greenwood-williamson")


def test_a_check_says_what_two_laws_have_in_common(case):
    found = sb.load_case(case("greenwood-williamson", {"alpha": "1.0"})).contact
    [said] = [each.sentence for each in sb.check(found) if each.name == "contact law at the centre"]
    gap = float(re.search(r"central gap is ([0-9.]+) h_rms", said)[1])
    beta = float(re.search(r"alpha = 2 and beta = ([0-9.e-]+) does", said)[1])
    same = found.beta * float(np.exp(GreenwoodWilliamson().log_pressure(np.array([gap]))[0]))
    assert beta * math.exp(-2 * gap) == pytest.approx(same, rel=2e-2)
