"""What holds for the package as a whole: the direction of imports, silence at import, complete docstrings."""

import ast
import doctest
import functools
import importlib
import importlib.metadata
import inspect
import json
import pydoc
import re
import subprocess
import sys
import textwrap
import types
from enum import Enum
from pathlib import Path

import pytest
from numpydoc.docscrape import get_doc_object
from numpydoc.validate import validate

import stribeck
from stribeck.contact_laws.law import AsperityLaw, WithArea

PACKAGE = Path(stribeck.__file__).parent
EXAMPLE = PACKAGE.parents[1] / "examples" / "pdms_cylinder.toml"

# From the top down: a package imports only packages of lower lines. `_types` is open to all.
#
# The solver never sees an asymptotic formula: one that fed the solver could no longer judge it. `numerics` knows no
# physics, so that problems with known answers can test it.
LAYERS = (
    ("__init__", "__main__", "cli", "results"),
    ("explorer", "figures", "data_sheet"),
    ("plot",),
    ("bench", "experiments"),
    ("fits", "sweeps", "regimes"),
    ("checks", "uncertainty"),
    ("strokes",),
    ("curves", "batches"),
    ("solver", "surfaces"),
    ("equations", "atlas", "asymptotics", "cases"),
    ("contacts",),
    ("asperity_friction",),
    ("solids", "contact_laws", "profiles", "motions"),
    ("fluids",),
    ("files",),
    ("numerics",),
    ("quantities",),
    ("_types",),
)
LEVEL = {package: -line for line, packages in enumerate(LAYERS) for package in packages}
NEVER = {("equations", "asymptotics"), ("solver", "asymptotics")}

FILES = sorted(path for path in PACKAGE.rglob("*.py") if "__pycache__" not in path.parts)
HEAVY = {
    "SurfaceTopography",
    "cyclopts",
    "dask",
    "distributed",
    "emcee",
    "jinja2",
    "matplotlib",
    "netCDF4",
    "nicegui",
    "openpyxl",
    "pandas",
    "pint",
    "pyarrow",
    "pydantic",
    "rich",
    "xarray",
    "zarr",
}


@functools.cache
def tree_of(path):
    """Return the syntax of a file, which several tests walk over."""
    return ast.parse(path.read_text())


def top_of(path):
    """Return the module or subpackage of stribeck that a file belongs to."""
    return path.relative_to(PACKAGE).parts[0].removesuffix(".py")


@functools.cache
def tops_of(folder):
    """Return the modules and subpackages of a folder."""
    return {path.name.removesuffix(".py") for path in folder.iterdir() if path.is_dir() or path.suffix == ".py"}


def imported_tops(path):
    """Return the modules or subpackages of stribeck that a file imports, lazily or not."""
    here = ["stribeck", *path.relative_to(PACKAGE).parent.parts]
    for node in ast.walk(tree_of(path)):
        if isinstance(node, ast.Import):
            targets = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            base = here[: len(here) - node.level + 1] if node.level else []
            module = ".".join([*base, *([node.module] if node.module else [])])
            targets = [f"{module}.{alias.name}" for alias in node.names]
        else:
            continue
        for target in targets:
            package, _, rest = target.partition(".")
            if package == "stribeck":
                top = rest.partition(".")[0]
                yield top if top in tops_of(PACKAGE) else "__init__"


def test_a_package_imports_only_packages_below_it():
    arrows = {(top_of(path), top): path for path in FILES for top in imported_tops(path) if top != top_of(path)}
    against = {arrow for arrow in arrows if LEVEL[arrow[1]] >= LEVEL[arrow[0]]}
    # The command calls what Python calls.
    assert against - {("cli", "__init__"), ("__main__", "cli")} == set()
    assert NEVER & set(arrows) == set()


def test_no_modules_import_one_another_in_a_circle(load_benchmark):
    assert load_benchmark("house").circles(Path(__file__).parents[1]) == 0


def test_the_package_needs_nothing_beside_it():
    """Evidence for the numbers lies beside the package and uses it, not the other way round."""
    imports = {node.module or "" for path in FILES for node in ast.walk(tree_of(path)) if isinstance(node, ast.ImportFrom)}
    assert {name.partition(".")[0] for name in imports} & {"evidence", "tests", "benchmarks", "docs"} == set()
    assert {path.name for path in PACKAGE.glob("*.py")} == {"__init__.py", "__main__.py", "_types.py"}


def test_the_walk_over_imports_sees_every_form(tmp_path, monkeypatch):
    monkeypatch.setattr(sys.modules[__name__], "PACKAGE", tmp_path)
    (tmp_path / "sub").mkdir()
    for name in ("a.py", "b.py", "c.py", "d.py", "e.py", "sub/f.py"):
        (tmp_path / name).touch()
    probe = tmp_path / "probe.py"
    probe.write_text("import os, stribeck.a\nfrom . import b, NAME\nfrom .c import x\ndef f():\n from stribeck.d import y")
    assert set(imported_tops(probe)) == {"a", "b", "c", "d", "__init__"}
    inner = tmp_path / "sub" / "probe.py"
    inner.write_text("from . import f\nfrom .f import x\nfrom ..e import y\nfrom .. import a")
    assert set(imported_tops(inner)) == {"sub", "e", "a"}


def test_a_module_runs_nothing_at_import():
    allowed = (ast.Import, ast.ImportFrom, ast.Assign, ast.AnnAssign, ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)
    for path in FILES:
        for node in tree_of(path).body:
            where = f"{path.relative_to(PACKAGE)}:{node.lineno}"
            if isinstance(node, ast.If):
                assert ast.unparse(node.test) in {"TYPE_CHECKING", "__name__ == '__main__'"}, where
            elif isinstance(node, ast.Expr):
                assert isinstance(node.value, ast.Constant), f"{where}: only docstrings stand free in a module"
            else:
                assert isinstance(node, allowed), where


def test_a_module_says_what_it_is_for():
    assert [path for path in FILES if not ast.get_docstring(tree_of(path))] == []


def test_importing_the_package_is_silent_and_leaves_heavy_libraries_alone():
    code = """
        import json, sys, numpy
        before = numpy.geterr()
        import stribeck
        assert numpy.geterr() == before
        print(json.dumps(sorted({name.partition(".")[0] for name in sys.modules})))
    """
    run = subprocess.run(
        [sys.executable, "-W", "error", "-c", textwrap.dedent(code)],
        capture_output=True,
        text=True,
        check=True,
    )
    assert run.stderr == ""
    [line] = run.stdout.splitlines()
    loaded = set(json.loads(line))
    assert "stribeck" in loaded
    assert loaded & HEAVY == set()


LOADED = """
import contextlib, io, json, sys
from stribeck.__main__ import main
sys.argv[1:] = {arguments!r}
with contextlib.redirect_stdout(io.StringIO()):
    assert main() == 0
json.dump(list(sys.modules), sys.stderr)
"""


def test_the_command_loads_what_it_uses(subtests):
    """Half of the time of a short command was the import of what it did not use."""
    never = HEAVY - {"cyclopts", "rich"} | {
        "unittest",
        "stribeck.sweeps",
        "stribeck.explorer",
        "stribeck.fits",
        "stribeck.uncertainty",
    }
    parts = {f"scipy.{name}" for name in ("special", "interpolate", "optimize", "sparse", "fft", "integrate", "stats")}
    for arguments, unloaded in [
        (["--help"], {"numpy", "scipy", "stribeck.solver", "stribeck.curves"}),
        (["curve", "--help"], set()),
        (["solve", str(EXAMPLE)], {"numpy.f2py.crackfortran", "stribeck.regimes.margins"}),
    ]:
        with subtests.test(arguments=arguments, unloaded=unloaded):
            run = subprocess.run([sys.executable, "-c", LOADED.format(arguments=arguments)], capture_output=True, text=True)
            assert run.returncode == 0, run.stderr
            assert (unloaded | never | parts) & set(json.loads(run.stderr)) == set()


def test_public_names_are_loaded_on_first_use_and_alone_are_listed():
    code = """
        import json, sys
        import stribeck
        before = [name for name in sys.modules if name.startswith(("stribeck.", "numpy"))]
        stribeck.Outcome, stribeck.__version__
        print(json.dumps([before, dir(stribeck), "stribeck.quantities.outcome" in sys.modules]))
    """
    run = subprocess.run([sys.executable, "-c", textwrap.dedent(code)], capture_output=True, text=True, check=True)
    lazy = ["stribeck.quantities", "stribeck.quantities.lazy"]  # what finds the others
    assert json.loads(run.stdout) == [lazy, sorted(stribeck.__all__), True]
    text = pydoc.plaintext.document(stribeck)
    assert len(dir(stribeck)) <= 39
    for name in ("solve", "LineContact", "results", "phase_diagram"):
        assert name in text
    for name in ("import_module", "HOMES"):
        assert name not in text
    with pytest.raises(AttributeError, match="has no attribute 'stribek_curve'"):
        stribeck.__getattr__("stribek_curve")


NAMESPACES = [
    *(stribeck, stribeck.bench, stribeck.contact_laws, stribeck.fluids, stribeck.profiles, stribeck.results, stribeck.solids),
    importlib.import_module("stribeck.asperity_friction"),
]


def test_the_stub_of_a_package_has_its_names(subtests):
    for package in NAMESPACES:
        with subtests.test(package=package):
            tree = ast.parse(Path(package.__file__).with_suffix(".pyi").read_text())
            stub = {
                alias.name: getattr(importlib.import_module(node.module), alias.name)
                for node in tree.body
                if isinstance(node, ast.ImportFrom)
                for alias in node.names
                if node.module != "stribeck" or importlib.import_module(f"stribeck.{alias.name}")
            }
            assert stub == {name: getattr(package, name) for name in package.__all__}
            [names] = [ast.literal_eval(node.value) for node in tree.body if isinstance(node, ast.Assign)]
            assert sorted(names) == package.__all__


# --- docstrings ---

# Of numpydoc's checks: missing or mismatched parts, not matters of taste.
FAULTS = {"GL08", "SS01", "SS03", "PR02", "PR03", "PR04", "PR07", "RT01", "RT03", "YD01"}
# What the protocol of a contact law says of a member holds for each law.
TOLD_BY_PROTOCOL = {*vars(AsperityLaw), *vars(WithArea)}
MEMBERS = (types.FunctionType, classmethod, staticmethod, property, functools.cached_property)


def public(*kinds):
    """Return the public functions and classes of the wanted kinds, with those of ``stribeck.results`` and its like."""
    packages = stribeck, stribeck.results, stribeck.contact_laws, stribeck.surfaces
    things = [getattr(package, name) for package in packages for name in package.__all__]
    return [thing for thing in things if isinstance(thing, kinds)]


def described_objects():
    """Yield name and checks of each public function and class, and of what a public class defines."""
    for thing in public(type, types.FunctionType):
        name = f"{thing.__module__}.{thing.__qualname__}"
        yield name, FAULTS if isinstance(thing, type) else FAULTS | {"PR01"}
        if isinstance(thing, type):
            for member, value in vars(thing).items():
                if isinstance(value, MEMBERS) and not member.startswith("_"):
                    yield f"{name}.{member}", {"GL08"} if member in TOLD_BY_PROTOCOL else FAULTS | {"PR01"}


def test_every_public_docstring_is_complete():
    wrong = {name: [fault for fault in validate(name)["errors"] if fault[0] in checks] for name, checks in described_objects()}
    assert len(wrong) > 200
    assert {name: found for name, found in wrong.items() if found} == {}


def test_every_field_of_a_public_class_is_described():
    # Results, which nobody constructs, describe their fields as attributes; inputs as parameters.
    bare = {}
    for thing in public(type):
        if not issubclass(thing, Enum):
            document = get_doc_object(thing)
            entries = [*document["Parameters"], *document["Attributes"]]
            described = {name.strip() for entry in entries for name in entry.name.split(",")}
            fields = set(inspect.signature(thing).parameters) if "__init__" in vars(thing) else set()
            bare[thing.__name__] = {field for field in fields if not field.startswith("_")} - described
    assert {name: fields for name, fields in bare.items() if fields} == {}


def raises(function):
    """Tell whether the body of a function written in the package has a raise."""
    function = inspect.unwrap(getattr(function, "__func__", function))
    ours = isinstance(function, types.FunctionType) and str(PACKAGE) in function.__code__.co_filename
    tree = ast.parse(textwrap.dedent(inspect.getsource(function)) if ours else "")
    return any(isinstance(node, ast.Raise) for node in ast.walk(tree))


def raisers():
    """Yield the public functions, methods and classes that raise."""
    for thing in public(type, types.FunctionType):
        members = vars(thing) if isinstance(thing, type) else {}
        if any(raises(body) for body in (thing, members.get("__init__"), members.get("__post_init__"))):
            yield thing
        for member, value in members.items():
            if not member.startswith("_") and raises(value):
                yield getattr(thing, member)


def test_what_raises_says_so():
    assert [thing.__qualname__ for thing in raisers() if not get_doc_object(thing)["Raises"]] == []


def test_the_examples_in_docstrings_are_right():
    names = [".".join(path.relative_to(PACKAGE.parent).with_suffix("").parts) for path in FILES]
    modules = [importlib.import_module(name.removesuffix(".__init__")) for name in names if "__main__" not in name]
    tests = [test for module in modules for test in doctest.DocTestFinder().find(module) if test.examples]
    assert len(tests) > 10 and sum(doctest.DocTestRunner().run(test).failed for test in tests) == 0


def test_the_tests_that_docstrings_name_are_there():
    tests = {path.name for path in Path(__file__).parent.glob("*.py")}
    named = {name for path in FILES for name in re.findall(r"test_\w+\.py", path.read_text())}
    assert len(named) > 5 and named <= tests, named - tests


def test_a_public_name_hides_no_module():
    for name in stribeck.__all__:
        found = getattr(stribeck, name)
        assert isinstance(found, types.ModuleType) == (PACKAGE / name).exists(), name
        if isinstance(found, types.ModuleType):
            assert found is importlib.import_module(f"stribeck.{name}")
            assert all(hasattr(found, public) for public in found.__all__)


def test_the_version_is_the_same_wherever_it_is_written():
    citation = (Path(__file__).parents[1] / "CITATION.cff").read_text()
    changelog = (Path(__file__).parents[1] / "CHANGELOG.md").read_text()
    version = importlib.metadata.version("stribeck")
    assert f"\nversion: {version}\n" in citation
    assert f"\n## {version} " in changelog
    assert f"version = {{{version}}}" in (PACKAGE.parents[1] / "docs" / "citing.md").read_text()


def test_numbers_of_the_numerical_core_stand_in_its_settings(load_benchmark):
    """A number of the core is a row of numerics/settings.py: nowhere else, and these may only become fewer."""
    house, root = load_benchmark("house"), Path(__file__).parents[1]
    inside = {path: house.constants(path) for folder in house.CORE for path in house.files(root, f"src/stribeck/{folder}")}
    assert {path.name for path, count in inside.items() if count} == {"settings.py"}
    assert sum(inside.values()) <= 40
