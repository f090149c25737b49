"""The documentation is true: its code runs, its links lead somewhere, its names are all there."""

import importlib.util
import pkgutil
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from test_structure import LAYERS

import stribeck as sb

ROOT = Path(__file__).parents[1]
PAGES = [
    ROOT / "README.md",
    ROOT / "CONTRIBUTING.md",
    ROOT / "CHANGELOG.md",
    *sorted((ROOT / "docs").glob("*.md")),
]
TEXT = {page: page.read_text() for page in PAGES}
FENCE = re.compile(r"^```(\w+)\n(.*?)^```$", re.DOTALL | re.MULTILINE)


def blocks(language, slow=()):
    """Return the code blocks of all pages in one language, as parameters of a test, slow ones of some pages."""
    return [
        pytest.param(code, id=f"{page.stem}-{i}", marks=[pytest.mark.slow] * (page.stem in slow))
        for page, text in TEXT.items()
        for i, (found, code) in enumerate(FENCE.findall(text))
        if found == language
    ]


@pytest.fixture
def desk(tmp_path, monkeypatch):
    """Return a folder with examples and published experiments in which the documentation's commands run."""
    shutil.copytree(ROOT / "examples", tmp_path / "examples")
    shutil.copytree(ROOT / "tests" / "data" / "experiments", tmp_path / "tests" / "data" / "experiments")
    monkeypatch.chdir(tmp_path)
    return tmp_path


SOLVING = {"batch", "checks", "cli", "contact_laws", "fitting", "for_engineers", "strokes", "sweep"}
"""Pages whose code takes seconds a block: `make docs` runs it."""


@pytest.mark.parametrize("code", blocks("python", SOLVING))
def test_a_python_block_runs(code, desk):
    exec(compile(code, "block", "exec"), {"__name__": "block"})


def test_a_toml_block_is_a_case_or_sweep_file(subtests, desk):
    """A block without contact is added to that of the demonstration case."""
    contact = Path("examples/pdms_cylinder.toml").read_text().partition("[curve]")[0]
    for block in blocks("toml"):
        with subtests.test(block.id):
            [code] = block.values
            own = re.sub("^radius.*", "", contact, flags=re.MULTILINE) if "[profile]" in code else contact
            Path("case.toml").write_text(code if "[contact]" in code or code.startswith("[bench]") else own + code)
            if "[vary]" in code:
                assert len(sb.load_sweep("case.toml")) > 1
            elif code.startswith("[bench]"):
                assert len(sb.bench.read("examples/rig_raw.csv", "case.toml", name="{fluid}")) > 1
            else:
                assert sb.load_case("case.toml").contact.groups.load > 0


def sessions(code):
    """Yield the commands of a console block, each with the lines of output shown below it."""
    for part in re.split(r"^\$ ", code, flags=re.MULTILINE)[1:]:
        command, *shown = part.rstrip().split("\n")
        yield command, shown


@pytest.mark.slow  # each a process or several; `make docs` runs them
@pytest.mark.parametrize("code", blocks("console"))
def test_a_console_block_does_what_it_shows(code, desk):
    """Each shown line is in the output, in order; ``...`` stands for what is left out, space is space."""
    for command, shown in sessions(code):
        program, *arguments = shlex.split(command, comments=True)
        start = {"stribeck": [sys.executable, "-m", "stribeck"], "python": [sys.executable]}[program]
        run = subprocess.run([*start, *arguments], capture_output=True, text=True, check=False)
        output = " ".join((run.stdout + run.stderr).split())
        assert run.returncode == (2 if "# exit code 2" in command else 0), output
        assert not (missing := first_missing(shown, output)), f"$ {command}\n{missing}\nThe command printed: {output}"


def first_missing(shown, output):
    """Return the first shown line that the output lacks after those before it, with what it has there; empty if none."""
    output, place = f" {output} ", 0
    for line in shown:
        for piece in re.sub(r"\s+", " ", f" {line} ").split("..."):
            found = output.find(piece, place)  # with the spaces around it, so that 0.2 is not found in 0.27
            if found < 0:
                return f"The page shows: {line.strip()}\nNot there after: {output[max(0, place - 60) : place]!r}"
            place = found + len(piece) - piece.endswith(" ")
    return ""


def test_the_code_of_a_page_runs_in_one_folder(subtests):
    """A file that is there is kept, so that no two commands or blocks of a page may write the same."""
    written = {"console": r"(?:-o|--out|--plot|--export) (\S+)", "python": r'\.(?:to_\w+|plot)\("([^"]+)"'}
    for page in PAGES:
        with subtests.test(page=page.name):
            code = [part for kind, text in FENCE.findall(TEXT[page]) for part in re.findall(written.get(kind, "$^"), text)]
            assert [name for name in code if code.count(name) > 1 and not name.endswith(".sqlite")] == []


def test_links_lead_somewhere(subtests):
    for page in PAGES:
        with subtests.test(page=page):
            prose = FENCE.sub("", TEXT[page])
            for target in re.findall(r"\]\((?!https?:)([^)\s]+)\)", prose):
                name, _, anchor = target.partition("#")
                other = (page.parent / name).resolve() if name else page
                assert other.exists(), target
                if anchor:
                    assert anchor in {anchor_of(title) for title in re.findall(r"^#+ (.*)$", other.read_text(), re.M)}


def anchor_of(title):
    """Return the anchor that GitHub gives a heading."""
    return re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-")


@pytest.mark.parametrize(("script", "page"), [("limits", "checks"), ("commands", "cli")])
def test_a_table_is_that_of_the_package(script, page):
    """``python docs/limits.py`` and ``python docs/commands.py`` write them."""
    spec = importlib.util.spec_from_file_location(script, ROOT / "docs" / f"{script}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    text = TEXT[ROOT / "docs" / f"{page}.md"]
    assert module.with_table(text) == text


# What people type into the search of the site, and the page that answers it.
SEARCHED = {
    "O-ring": "data_sheet",
    "Ra": "data_sheet",
    "Young's modulus": "data_sheet",
    "viscosity": "fluids",
    "alpha": "alpha_beta",
    "cavitation": "fluids",
    "leakage": "leakage",
    "no minimum": "troubleshooting",
    "gels": "when_not_to_use",
}


def test_a_page_is_found_by_the_words_in_its_headings(subtests):
    """The search of the site ranks words in titles and headings first."""
    for words, page in SEARCHED.items():
        with subtests.test(words=words):
            headings = re.findall(r"^#+ (.*)$", FENCE.sub("", TEXT[ROOT / "docs" / f"{page}.md"]), re.M)
            assert any(re.search(rf"(?<!\w){re.escape(words)}(?!\w)", heading, re.I) for heading in headings)


def test_no_page_stands_alone():
    reached, queue = set(), [ROOT / "README.md"]
    while queue:
        page = queue.pop()
        reached.add(page)
        names = re.findall(r"\]\(([^)#\s]+\.md)", page.read_text())
        queue += [other for name in names if (other := (page.parent / name).resolve()) not in reached]
    assert set(PAGES) <= reached


def test_every_public_name_is_documented():
    code = " ".join(re.findall(r"`[^`\n]+`", " ".join(TEXT.values()))) + " ".join(
        found for text in TEXT.values() for _, found in FENCE.findall(text)
    )
    assert [name for name in sb.__all__ if not re.search(rf"\b{name}\b", code)] == []


def test_the_reference_has_every_name_that_a_page_takes_from_a_module_of_the_package():
    reference = (ROOT / "docs" / "api.rst").read_text()
    named = {
        name.rstrip(".")
        for page in PAGES
        if page.stem not in ("for_developers", "numerics")  # those who extend the package read its sources
        for name in re.findall(r"(?<!from )\b(?:sb|stribeck)\.(\w+\.[\w.]+)", TEXT[page])
    }
    assert len(named) > 30
    listed = set(re.findall(r"^   ([\w.]+)$", reference, re.M))
    known = {id(pkgutil.resolve_name(f"stribeck.{name}")) for name in listed}
    rest = {name for name in named if id(pkgutil.resolve_name(f"stribeck.{name}")) not in known}
    assert {name for name in rest if name.rpartition(".")[0] not in listed} == set()  # the page of a module has its members


def names_in_tables():
    """Return the names in code type of the tables of symbols.md, without their class, and those of their errors."""
    lines = [line for line in TEXT[ROOT / "docs" / "symbols.md"].splitlines() if line.startswith("|")]
    names = [name.rpartition(".")[2] for name in re.findall(r"`([A-Za-z_.0-9]+)`", "\n".join(lines))]
    return [*names, *(f"{name}_error" for name in names)]


def test_the_table_of_symbols_names_every_variable_of_a_data_file():
    pytest.importorskip("xarray")
    case = sb.load_case(ROOT / "examples" / "pdms_cylinder.toml")
    curve = sb.stribeck_curve(case.contact, speed=(1e-3, 1e-2), points=3)
    assert set(curve.to_dataset().variables) - set(names_in_tables()) <= {"speed"}


def test_the_table_of_symbols_names_every_variable_of_a_sweep(tmp_path):
    (tmp_path / "sweep.toml").write_text("[groups]\nload = 0.1\nroughness = 0\n[vary]\nspeed = [0, 0]\n")
    groups = sb.sweep(tmp_path / "sweep.toml", tmp_path / "groups").to_dataset()
    (tmp_path / "sweep.toml").write_text((ROOT / "examples" / "sweep.toml").read_text().replace("26", "2"))
    contacts = sb.sweep(tmp_path / "sweep.toml", tmp_path / "contacts").to_dataset(grid=False)
    assert {*groups.variables, *contacts.variables} - set(names_in_tables()) == set()


def test_the_table_of_symbols_names_every_observable():
    state = sb.solve(sb.Groups(speed=0.0, load=0.1, roughness=0.0))
    inputs = {"message", "nodes"}
    assert set(state.to_dict()) - inputs - set(names_in_tables()) == set()


def test_the_code_of_a_page_imports_what_the_reference_has():
    """Those who extend the package import more."""
    reference = (ROOT / "docs" / "api.rst").read_text()
    imports = [
        f"{module}.{name.split()[0]}"
        for page in PAGES
        if page.stem != "for_developers"
        for module, names in re.findall(r"^from stribeck\.(\S+) import (.+)$", TEXT[page], re.M)
        for name in names.split(",")
    ]
    assert imports
    assert [name for name in imports if not re.search(rf"^   {re.escape(name)}$", reference, re.M)] == []


def test_the_shown_formulas_are_numbered_as_docstrings_cite_them():
    theory = TEXT[ROOT / "docs" / "theory.md"]
    numbers = [int(number) for number in re.findall(r"\\tag\{(\d+)\}", theory)]
    assert numbers and numbers == list(range(1, len(numbers) + 1))
    cited = {
        int(number)
        for path in (ROOT / "src").rglob("*.py")
        for number in re.findall(r"theory\.md,? section (\d+)", path.read_text())
    }
    assert cited <= set(map(int, re.findall(r"^## (\d+)\.", theory, re.M)))


def test_the_picture_for_developers_is_the_order_of_imports():
    """A package that is new, gone or moved: enter it in the picture of docs/for_developers.md too."""
    (picture,) = re.findall(r"^src/stribeck/\n(.*?)^```", TEXT[ROOT / "docs" / "for_developers.md"], re.DOTALL | re.MULTILINE)
    shown = [set(re.split(r" {2,}", line.strip())[0].split(", ")) for line in picture.splitlines()]
    assert shown == [found for line in LAYERS if (found := {name for name in line if name[0] != "_"})]


def test_a_page_names_files_and_folders_that_exist(subtests):
    folders = (ROOT, ROOT / "docs", ROOT / "src" / "stribeck")
    for page in PAGES:
        with subtests.test(page=page):
            named = set(re.findall(r"\b(?:\w+/)+\w+\.py\b|(?<=`)(?:\w+/)+(?=`)", TEXT[page]))
            assert {name for name in named if not any((folder / name).exists() for folder in folders)} == set()


def test_every_name_of_the_reference_exists():
    module, missing = "stribeck", []
    for line in (ROOT / "docs" / "api.rst").read_text().splitlines():
        if line.startswith(".. currentmodule:: "):
            module = line.split()[-1]
        elif re.fullmatch(r"   [a-zA-Z_][\w.]*", line):
            try:
                pkgutil.resolve_name(f"{module}.{line.strip()}")
            except (AttributeError, ImportError):
                missing.append(line.strip())
    assert missing == []
