"""What holds for the package as a whole: the direction of imports, silence at import, complete docstrings."""

import ast
import doctest
import functools
import importlib
import importlib.metadata
import inspect
import json
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

PACKAGE = Path(stribeck.__file__).parent

EQUATIONS = {"contact_laws", "elasticity", "equations", "mesh", "parameters", "reynolds"}
ALGORITHMS = {"arclength", "continuation", "newton"}
RESULTS = {"friction", "newton", "parameters", "quantities", "solution", "solve", "threads", "units"}
CURVE = {"curve_coordinate", "curve_result", "landmarks"}
SURFACES = {
    "detrend",
    "persson",
    "rough_surface",
    "spectrum",
    "surface_fit",
    "surface_spectrum",
    "topography",
    "topography_files",
}
SWEEP = ("chain", "dataset", "design", "lock", "order", "store", "workers")

FIT = ("identify", "model", "objective", "profile", "quality", "result", "settings", "states")

# Who may import whom; `_types` is open to all, and a module that is not named here is refused.
#
# The solver never sees an asymptotic formula: one that fed the solver could no longer judge it. `newton`,
# `continuation` and `arclength` know no physics, so that problems with known answers can test them.
MAY_IMPORT = {
    "_types": set(),
    "units": set(),
    "quantities": {"units"},
    "groups": {"quantities", "units"},
    "parameters": {"groups", "quantities", "units"},
    "fit_settings": {"quantities", "units"},
    "case": {"case_law", "fit_settings", "parameters", "quantities", "units"},
    "case_law": {"asperity_laws", "contact_laws", "persson", "rough_surface", "spectrum", "table_law", "two_columns", "units"},
    "two_columns": {"units"},
    "asperity_laws": {"units"},
    "table_law": {"two_columns", "units"},
    "function_law": {"units"},
    "threads": set(),
    "hertz": set(),
    "mesh": set(),
    "newton": set(),
    "continuation": {"newton"},
    "arclength": {"continuation", "newton"},
    "contact_laws": {"asperity_laws", "parameters", "units"},
    "spectrum": {"units"},
    "persson_integral": {"spectrum", "units"},
    "persson": {"persson_integral", "spectrum", "units"},
    "rough_surface": {"persson", "spectrum", "units"},
    "topography": {"spectrum", "units"},
    "topography_text": {"topography", "units"},
    "topography_files": {"output", "topography", "topography_text", "units"},
    "surface_spectrum": {"spectrum", "topography", "units"},
    "detrend": {"spectrum", "surface_spectrum", "topography", "units"},
    "surface_fit": {"persson", "spectrum", "surface_spectrum", "units"},
    "surfaces": SURFACES | {"output", "units"},
    "report_surface": {"surfaces", "units"},
    "plot_surface": {"output", "plot_style", "report_surface", "surfaces", "units"},
    "asymptotics": {"elasticity", "hertz", "mesh", "newton", "parameters", "threads", "units"},
    "elasticity": {"mesh", "parameters"},
    "reynolds": {"mesh", "parameters"},
    "equations": {"contact_laws", "elasticity", "mesh", "parameters", "reynolds"},
    "states": EQUATIONS | ALGORITHMS,
    "start": EQUATIONS | ALGORITHMS | {"states"},
    "observables": EQUATIONS | {"states"},
    "estimate": EQUATIONS | {"observables", "states"},
    "refine": EQUATIONS | ALGORITHMS | {"estimate", "observables", "states"},
    "span": EQUATIONS | ALGORITHMS | {"observables", "start", "states"},
    "together": EQUATIONS | ALGORITHMS | {"estimate", "observables", "refine", "states"},
    "fill": EQUATIONS | ALGORITHMS | {"estimate", "refine", "states", "together"},
    "follower": EQUATIONS | ALGORITHMS | {"estimate", "refine", "start", "states", "together"},
    "follow": ALGORITHMS | {"fill", "follower", "parameters", "refine"},
    "near": RESULTS | {"follower", "refine"},
    "sensitivity": EQUATIONS | {"observables", "states"},
    "friction": {"parameters", "quantities", "units"},
    "solution": {"friction", "mesh", "newton", "observables", "parameters", "units"},
    "notes": {"observables", "parameters"},
    "cavitation": {"parameters"},
    "solve": (RESULTS - {"solve"})
    | {"cavitation", "contact_laws", "hertz", "mesh", "notes", "observables", "refine", "start"},
    "regimes": RESULTS | {"atlas", "refine", "sensitivity", "start"},
    "curve_coordinate": RESULTS | {"sensitivity"},
    "landmarks": RESULTS | {"curve_coordinate", "follower", "refine"},
    "curve_result": RESULTS
    | {"asymptotics", "curve_coordinate", "landmarks", "plotting", "refine", "regimes", "sensitivity", "store"},
    "curve": RESULTS | CURVE | {"atlas_curve", "follow", "refine", "regimes", "span"},
    "validity": RESULTS | {"asymptotics", "curve", "curve_result", "landmarks", "output"},
    "plot_validity": {"asymptotics", "figures", "output", "parameters", "plot_style", "units"},
    "output": {"units"},
    "store": RESULTS | {"curve_result", "output", "regimes"},
    "plot_style": RESULTS | {"output"},
    "plot_profile": RESULTS | {"output", "plot_style"},
    "plotting": RESULTS | {"curve_result", "output", "plot_profile", "plot_style"},
    "figures": RESULTS
    | {"asymptotics", "curve", "curve_result", "hertz", "landmarks", "output", "phase_diagram", "plot_phase", "plot_style"}
    | {"regimes", "store", "validity"},
    "report_words": RESULTS | {"curve_result", "regimes", "store"},
    "report_json": RESULTS | {"curve_result", "distances", "landmarks", "report_words", "store"},
    "report_regimes": RESULTS | {"curve_result", "distances", "landmarks", "report_words"},
    "report": RESULTS | {"curve_result", "regimes", "report_words"},
    "distances": RESULTS | {"curve", "curve_coordinate", "curve_result", "regimes"},
    "merging": RESULTS | {"follower", "refine", "sensitivity", "span"},
    "phase_grid": RESULTS | {"contact_laws", "regimes", "span"},
    "phase_dataset": RESULTS | {"asymptotics", "output", "phase_grid", "regimes", "store"},
    "phase_diagram": RESULTS
    | {"atlas_phase", "curve", "curve_result", "landmarks", "merging", "phase_dataset", "phase_grid", "regimes", "span"},
    "plot_phase": RESULTS | {"output", "plot_style"},
    "sweep_points": set(),
    "sweep_order": set(),
    "sweep_lock": {"units"},
    "sweep_design": {"case", "case_law", "parameters", "quantities", "sweep_points", "units"},
    "sweep_columns": RESULTS | {"observables", "store"},
    "sweep_chain": RESULTS | {"continuation", "follow", "follower", "refine", "sweep_columns", "sweep_order"},
    "sweep_store": {"output", "sweep_columns", "sweep_design", "units"},
    "sweep_dataset": RESULTS | {"output", "regimes", "store", "sweep_columns", "sweep_store"},
    "sweep_workers": RESULTS | {"output", "sweep_chain", "sweep_columns", "sweep_store"},
    "sweep": RESULTS | {"output"} | {f"sweep_{part}" for part in SWEEP},
    "report_sweep": RESULTS | {"sweep", "sweep_columns", "sweep_dataset"},
    "lab_table": {"units"},
    "measurements": {"fit_settings", "lab_table", "quantities", "units"},
    "fit_states": RESULTS | {"atlas", "curve", "observables", "sensitivity"},
    "fit_model": RESULTS | {"fit_settings", "fit_states", "measurements", "regimes"},
    "fit_objective": RESULTS | {"fit_model", "fit_settings", "fit_states"},
    "fit_identify": {"fit_model"},
    "fit_profile": {"fit_objective"},
    "fit_quality": {"fit_objective"},
    "fit_result": RESULTS | {"fit_identify", "fit_quality", "fit_settings", "measurements"},
    "fit": RESULTS | {"case", "fit_file", "measurements"} | {f"fit_{part}" for part in FIT},
    "fit_posterior": RESULTS | {"atlas", "fit_objective", "fit_result", "output"},
    "fit_file": RESULTS | {"case", "fit_result", "output"},
    "report_fit": {"fit_file", "fit_posterior", "fit_result", "parameters", "quantities", "units"},
    "plot_fit": RESULTS | {"fit_file", "fit_result", "output", "plot_style"},
    "batch_device": {"output", "units"},
    "batch_equations": EQUATIONS | {"batch_device"},
    "batch_guess": EQUATIONS | ALGORITHMS | {"states"},
    "batch_path": EQUATIONS
    | {"batch_device", "batch_equations", "batch_guess", "estimate", "newton", "observables", "refine", "start", "states"},
    "batch_plan": {"batch_guess", "parameters", "start"},
    "batch": RESULTS | {"batch_device", "batch_guess", "batch_path", "batch_plan", "observables", "start"},
    "atlas_grid": set(),
    "atlas_table": {"atlas_grid"},
    "atlas": {"atlas_grid", "atlas_table", "friction", "hertz", "parameters", "quantities", "threads", "units"},
    "atlas_curve": {"atlas", "friction", "parameters", "regimes", "units"},
    "atlas_phase": {"atlas", "atlas_curve", "friction", "newton", "parameters", "phase_grid", "regimes", "threads"},
    "atlas_build": {"atlas_grid", "atlas_table", "curve"},
    "atlas_certificate": {"atlas", "parameters", "solve"},
}
OPEN = {"__init__", "__main__", "app", "cli"}

FILES = sorted(path for path in PACKAGE.rglob("*.py") if "__pycache__" not in path.parts)
HEAVY = {
    "SurfaceTopography",
    "array_api_compat",
    "cupy",
    "cyclopts",
    "dask",
    "distributed",
    "emcee",
    "matplotlib",
    "netCDF4",
    "nicegui",
    "pandas",
    "pint",
    "pydantic",
    "rich",
    "torch",
    "xarray",
    "zarr",
}


def top_of(path):
    """Return the module or subpackage of stribeck that a file belongs to."""
    return path.relative_to(PACKAGE).parts[0].removesuffix(".py")


def imported_tops(path):
    """Return the modules or subpackages of stribeck that a file imports, lazily or not."""
    here = ["stribeck", *path.relative_to(PACKAGE).parent.parts]
    for node in ast.walk(ast.parse(path.read_text())):
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
                is_module = (PACKAGE / f"{top}.py").exists() or (PACKAGE / top).is_dir()
                yield top if top and is_module else "__init__"


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(PACKAGE)))
def test_a_module_imports_only_what_stands_before_it(path):
    top = top_of(path)
    if top in OPEN:
        return
    assert top in MAY_IMPORT, f"say in MAY_IMPORT what {top} may import"
    assert set(imported_tops(path)) <= MAY_IMPORT[top] | {"_types", top}


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


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(PACKAGE)))
def test_a_module_runs_nothing_at_import(path):
    allowed = (ast.Import, ast.ImportFrom, ast.Assign, ast.AnnAssign, ast.FunctionDef, ast.ClassDef)
    for node in ast.parse(path.read_text()).body:
        if isinstance(node, ast.If):
            assert ast.unparse(node.test) in {"TYPE_CHECKING", "__name__ == '__main__'"}
        elif isinstance(node, ast.Expr):
            assert isinstance(node.value, ast.Constant), "only docstrings stand free in a module"
        else:
            assert isinstance(node, allowed)


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(PACKAGE)))
def test_a_module_says_what_it_is_for(path):
    assert ast.get_docstring(ast.parse(path.read_text()))


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


# --- docstrings ---

# Of numpydoc's checks: missing or mismatched parts, not matters of taste.
FAULTS = {"GL08", "SS01", "SS03", "PR02", "PR03", "PR04", "PR07", "RT01", "RT03", "YD01"}
MEMBERS = (types.FunctionType, classmethod, staticmethod, property, functools.cached_property)


def public(*kinds):
    """Return the public functions and classes of the wanted kinds, with those of ``stribeck.surfaces``."""
    things = [getattr(stribeck, name) for name in stribeck.__all__]
    things += [getattr(stribeck.surfaces, name) for name in stribeck.surfaces.__all__]
    return [thing for thing in things if isinstance(thing, kinds)]


def described_objects():
    """Yield name and checks of each public function and class, and of what a public class defines."""
    for thing in public(type, types.FunctionType):
        name = f"{thing.__module__}.{thing.__qualname__}"
        yield pytest.param(name, FAULTS if isinstance(thing, type) else FAULTS | {"PR01"}, id=name)
        if isinstance(thing, type):
            for member, value in vars(thing).items():
                if isinstance(value, MEMBERS) and not member.startswith("_"):
                    name_of_member = f"{name}.{member}"
                    yield pytest.param(name_of_member, FAULTS | {"PR01"}, id=name_of_member)


@pytest.mark.parametrize(("name", "checks"), list(described_objects()))
def test_a_public_docstring_is_complete(name, checks):
    assert [fault for fault in validate(name)["errors"] if fault[0] in checks] == []


@pytest.mark.parametrize("thing", [thing for thing in public(type) if not issubclass(thing, Enum)])
def test_every_field_of_a_public_class_is_described(thing):
    # Results, which nobody constructs, describe their fields as attributes; inputs as parameters.
    document = get_doc_object(thing)
    entries = [*document["Parameters"], *document["Attributes"]]
    described = {name.strip() for entry in entries for name in entry.name.split(",")}
    fields = set(inspect.signature(thing).parameters) if "__init__" in vars(thing) else set()
    assert {field for field in fields if not field.startswith("_")} <= described


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


@pytest.mark.parametrize("thing", list(raisers()), ids=lambda thing: thing.__qualname__)
def test_what_raises_says_so(thing):
    assert get_doc_object(thing)["Raises"]


def test_the_examples_in_docstrings_are_right():
    names = [".".join(path.relative_to(PACKAGE.parent).with_suffix("").parts) for path in FILES]
    modules = [importlib.import_module(name.removesuffix(".__init__")) for name in names if "__main__" not in name]
    results = [doctest.testmod(module) for module in modules]
    assert sum(result.failed for result in results) == 0
    assert sum(result.attempted for result in results) > 0


def test_the_public_names_exist_once_and_in_a_list():
    assert isinstance(stribeck.__all__, list)
    assert len(set(stribeck.__all__)) == len(stribeck.__all__)
    assert all(hasattr(stribeck, name) for name in stribeck.__all__)


def test_the_version_is_the_same_wherever_it_is_written():
    citation = (Path(__file__).parents[1] / "CITATION.cff").read_text()
    changelog = (Path(__file__).parents[1] / "CHANGELOG.md").read_text()
    version = importlib.metadata.version("stribeck")
    assert f"\nversion: {version}\n" in citation
    assert f"\n## {version} " in changelog
