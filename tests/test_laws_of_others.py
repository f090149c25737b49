"""Laws of another distribution, as for_developers.md shows them: known by name wherever the package names laws."""

import ast
import json
import re
import subprocess
from pathlib import Path

import pytest
from command_line import SCRIPT, environment
from yasuda import Yasuda

import stribeck as sb

PAGE = Path(__file__).parents[1] / "docs" / "for_developers.md"
YASUDA = Path(__file__).with_name("yasuda.py")
CLASSES = ("SpringLayer", "LinearlyStiffening", "Yasuda")
CASE = """
[contact]
radius = "10 mm"
modulus = "2.7 MPa"
load = "30 N/m"
viscosity = "50 mPa*s"
speed = "10 mm/s"
roughness = "1 um"
alpha = 2.0
beta = 0.06
boundary_friction = 0.7
law = "spring-layer"

[fluid]
model = "yasuda"
relaxation_time = "1 ms"
exponent = 0.5
sharpness = "1.5 +- 0.1"
viscosity_law = "linearly-stiffening"
stiffening = "20 1/GPa"

[fit]
free = ["boundary_friction", "sharpness"]
"""
IN_PYTHON = """
import json
from stribeck.explorer.inputs import choices, inputs
import stribeck as sb
from stribeck.explorer.inputs.inputs import from_case
case = sb.load_case("plain.toml")
shown = choices.list_of(from_case(sb.load_case("case.toml")), "fluid")
moved = choices.with_detail(from_case(case), "fluid", "sharpness", "2")
replaced = case.contact.replace(sharpness=1.2).sharpness
speed = [1e-3, 1e-2, 0.1, 1.0]
friction = list(sb.solve_batch(case.contact, speed=speed, rtol=1e-4).friction)
with open("data.csv", "w") as file:
    file.write("speed [m/s],friction\\n" + "".join(f"{u},{m}\\n" for u, m in zip(speed, friction)))
fit = sb.fit("data.csv", case, intervals=False)
assert sb.contact_laws.SpringLayer.name == "spring-layer" and sb.fluids.Yasuda.name == "yasuda"
sb.sweep("sweep.toml", "states")
said = []
for name in ("number", "key", "law"):
    try:
        sb.load_case(f"wrong {name}.toml")
    except sb.InputError as error:
        said.append(str(error))
print(json.dumps([shown["options"], shown["details"], moved.contact.sharpness, replaced, fit["sharpness"].value, said]))
"""
SWEEP = (
    CASE.partition("[fit]")[0].replace('speed = "10 mm/s"\n', "").replace('"1.5 +- 0.1"', "1.5")
    + """
[vary]
speed = ["10 mm/s", "20 mm/s"]
"""
)
WRONG = {
    "number": ('"1.5 +- 0.1"', "50", "sharpness = 50 must be between 0.2 and 10"),
    "key": ("sharpness", "sharpnes", "sharpnes = '1.5 +- 0.1' is not a known key; did you mean sharpness"),
    "law": ("spring-layer", "spring-layr", "law = 'spring-layr' must be one of"),
}


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """Return what runs a command where a distribution with the laws of the page is installed."""
    folder = tmp_path_factory.mktemp("others")
    shown = [text for text in re.findall(r"```python\n(.*?)```", PAGE.read_text(), re.DOTALL) if "class " in text]
    blocks = [ast.parse(text) for text in (*shown, YASUDA.read_text())]
    kept, names = [], []
    for block in blocks:
        classes = [node for node in block.body if isinstance(node, ast.ClassDef) and node.name in CLASSES]
        if classes:
            kept += [node for node in block.body if isinstance(node, ast.Import | ast.ImportFrom)] + classes
            names += [node.name for node in classes]
    assert sorted(names) == sorted(CLASSES)
    (folder / "my_laws.py").write_text("\n".join(map(ast.unparse, kept)))
    about = folder / "my_laws-1.0.dist-info"
    about.mkdir()
    (about / "METADATA").write_text("Metadata-Version: 2.1\nName: my-laws\nVersion: 1.0\n")
    lines = "\n".join(f"{name.lower()} = my_laws:{name}" for name in CLASSES)
    (about / "entry_points.txt").write_text(f"[stribeck.laws]\n{lines}\n")
    (folder / "case.toml").write_text(CASE)
    (folder / "plain.toml").write_text(CASE.replace('"1.5 +- 0.1"', "1.5"))
    (folder / "sweep.toml").write_text(SWEEP)
    for name, (before, after, _) in WRONG.items():
        (folder / f"wrong {name}.toml").write_text(CASE.replace(before, after))

    def command(*words):
        own = {**environment(), "PYTHONPATH": str(folder)}
        found = subprocess.run([*words], cwd=folder, env=own, capture_output=True, text=True, timeout=120, check=False)
        assert found.returncode == 0, found.stderr
        return found

    return command


def test_a_case_file_has_them_and_states_name_their_numbers(run):
    found = run(SCRIPT, "solve", "case.toml", "--json").stdout
    assert json.loads(found)["contact_law"] == "spring-layer"
    assert "sharpness" in found and "yasuda" in found


def test_a_new_case_shows_them(run):
    text = run(SCRIPT, "new").stdout
    assert '"spring-layer"' in text and "sharpness" not in text  # which has a default
    assert 'model = "yasuda"   # with relaxation_time = "1 ms"; exponent = 0.5' in text
    assert 'viscosity_law = "linearly-stiffening"   # with stiffening = "20 1/GPa"' in text


@pytest.mark.slow
def test_the_page_offers_them_a_fit_frees_their_numbers_a_sweep_takes_them_and_wrong_ones_are_refused(run):
    options, details, *numbers, said = json.loads(run(SCRIPT.with_name("python"), "-c", IN_PYTHON).stdout)
    assert ["yasuda", "Carreau and Yasuda"] in options
    assert ["sharpness", "sharpness of thinning", "1.5 +- 0.1", "2"] in details
    assert numbers == [2.0, 1.2, pytest.approx(1.5, rel=1e-2)]
    for sentence, (*_, wanted) in zip(said, WRONG.values(), strict=True):
        assert wanted in sentence


def test_a_law_of_shear_with_the_shape_of_another_has_its_film_and_thins_from_lower_rates_when_blunter():
    contact = sb.load_case(PAGE.parents[1] / "examples" / "pdms_cylinder.toml").contact
    carreau = sb.solve(contact, fluid=sb.fluids.Carreau("1 ms", 0.5)).central_gap
    assert sb.solve(contact, fluid=Yasuda("1 ms", 0.5)).central_gap == pytest.approx(carreau, rel=1e-6)
    assert sb.solve(contact, fluid=Yasuda("1 ms", 0.5, sharpness=1.5)).central_gap < carreau
