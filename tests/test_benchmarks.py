"""Every script of benchmarks/ on a load so small that its numbers mean nothing: its tables come out, filled and finite."""

import ast
import importlib
import pkgutil
import re
import sys
from collections import Counter
from pathlib import Path

import pytest

ARGUMENTS = {
    "atlas_rate": ["--number", "100"],
    "batch_rate": ["--number", "4"],
    "cold_starts": ["--number", "2"],
    "convergence": ["--number", "1"],
    "cost": ["--runs", "1"],
    "curve_bound": ["--number", "2", "--speeds", "3"],
    "curve_speed": [],
    "explorer_curves": ["--number", "1", "--contacts", "1"],
    "mutants": ["--list", "--number", "3"],
    "fluid_box": ["motion", "--number", "2"],
    "peers": ["--quick"],
    "point_speed": ["--runs", "1", "--speeds", "2", "--memory-rtol", "1e-2", "--states", "2"],
    "surface_errors": ["--number", "1"],
    "sweep_rate": ["--number", "4", "--workers", "1"],
}
"""Scripts, and what makes them small; those apart need a browser, valgrind or minutes."""

LONG = {"batch_rate", "cost", "curve_bound", "explorer_curves", "mutants", "peers", "point_speed", "surface_errors"}
"""Those that take a while even so."""

APART = {
    "fluid_speed",
    "point_box",
    "point_exit_speed",
    "point_parts",
    "walk",
    "explorer_latency",
    "explorer_memory",
    "house",
    "instructions",
    "profiles",
    "strokes",
}
NO_SCRIPTS = {"textbook"}
NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?![\w.])")


def tables(text):
    """Return the tables of a text in Markdown, each as its rows of cells, the head first."""
    found = re.findall(r"(?:^\|.*\|\n)+", text, re.M)
    return [[[cell.strip() for cell in line.strip("|").split("|")] for line in each.splitlines()] for each in found]


def check(text):
    """Check that each table of a text has rows, cells under all heads, and finite numbers in each row."""
    found = tables(text)
    assert found
    for head, rule, *rows in found:
        assert all(re.fullmatch("-+:?", cell) for cell in rule), rule
        assert rows, head
        for row in rows:
            assert len(row) == len(head), row
            cells = row[1:]
            code_left_out = re.sub(r"`[^`]*`", "", " ".join(cells))
            assert not re.search(r"\b(nan|inf)\b", code_left_out, re.I), row
            assert any(NUMBER.search(cell) for cell in cells) or "not installed" in cells, row
    return found


def test_no_script_is_forgotten():
    folder = Path(__file__).parents[1] / "benchmarks"
    assert {path.stem for path in folder.glob("*.py")} == set(ARGUMENTS) | APART | NO_SCRIPTS


def test_what_scripts_import_of_the_package_is_there():
    """A script of an hour is not run here: one asked for constants that were gone."""
    root = Path(__file__).parents[1]
    paths = [path for folder in ("benchmarks", "evidence") for path in sorted((root / folder).glob("*.py"))]
    missing = []
    for path in paths:
        nodes = [node for node in ast.walk(ast.parse(path.read_text())) if isinstance(node, ast.ImportFrom)]
        for node in [node for node in nodes if (node.module or "").startswith("stribeck")]:
            module = importlib.import_module(node.module)
            modules = {each.name for each in pkgutil.iter_modules(getattr(module, "__path__", []))}
            names = {alias.name for alias in node.names} - modules
            missing += [f"{path.name}: {node.module}.{name}" for name in sorted(names) if not hasattr(module, name)]
    assert not missing, "\n".join(missing)


@pytest.mark.parametrize("name", [pytest.param(name, marks=[pytest.mark.slow] * (name in LONG)) for name in ARGUMENTS])
def test_its_tables_come_out(load_benchmark, monkeypatch, capsys, name):
    script = load_benchmark(name)
    if name == "curve_speed":
        monkeypatch.setattr(script, "RUNS", 1)
    if name == "peers":
        for peer in script.PEERS:
            monkeypatch.setitem(sys.modules, peer, None)
    monkeypatch.setattr(sys, "argv", [f"{name}.py", *ARGUMENTS[name]])
    script.main()
    text = capsys.readouterr().out
    check(text)
    if name == "peers":
        assert all(f"pip install {peer}" in text for peer in script.PEERS)


def test_a_call_reaches_the_first_residual_through_few_files(subtests, load_benchmark):
    for walk, files in [("in_python", 12), ("on_the_command_line", 16)]:
        with subtests.test(walk=walk, files=files):
            found = getattr(load_benchmark("walk"), walk)()
            assert found[-1] == "equations/line.py"
            assert len(set(found)) <= files
            assert max(Counter(found).values()) <= 8  # a path asks its corrector, and this one the rigid guess, in turns
