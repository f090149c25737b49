"""How many small faults in the package `make test` catches: one fault at a time in a copy of the sources.

Usage::

    python benchmarks/mutants.py [--number 40] [--seed 1] [--only 3,7] [--jobs 2] [--list]

A fixed seed draws faults evenly over the lines of ``src`` that hold code: a comparison turned round, an arithmetic sign or a
number changed, a condition negated, what a function returns left out.  First `make test` runs whole and keeps in
``build/mutants.json`` which tests run which line, until a source changes; needs pytest-cov.  For each fault the script
copies the checkout, applies the fault, and runs the tests of that line, the fastest first, until one fails.  Where none does
it runs `make test`.  It prints a row a fault: the file, the fault, the test that caught it, and what was run.  Only what
`make test` lets pass counts as survived.
"""

from __future__ import annotations

import argparse
import ast
import json
import os
import random
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any, NamedTuple
from xml.etree import ElementTree

ROOT = Path(__file__).parents[1]
SWAPS: dict[type, type] = {
    ast.Lt: ast.GtE,
    ast.LtE: ast.Gt,
    ast.Gt: ast.LtE,
    ast.GtE: ast.Lt,
    ast.Eq: ast.NotEq,
    ast.NotEq: ast.Eq,
    ast.Is: ast.IsNot,
    ast.IsNot: ast.Is,
    ast.In: ast.NotIn,
    ast.NotIn: ast.In,
    ast.Add: ast.Sub,
    ast.Sub: ast.Add,
    ast.Mult: ast.Div,
    ast.Div: ast.Mult,
    ast.And: ast.Or,
    ast.Or: ast.And,
}
SIGNS = {
    ast.Lt: "<",
    ast.LtE: "<=",
    ast.Gt: ">",
    ast.GtE: ">=",
    ast.Eq: "==",
    ast.NotEq: "!=",
    ast.Is: "is",
    ast.IsNot: "is not",
    ast.In: "in",
    ast.NotIn: "not in",
    ast.Add: "+",
    ast.Sub: "-",
    ast.Mult: "*",
    ast.Div: "/",
    ast.And: "and",
    ast.Or: "or",
}
FINITE = ["-o", "faulthandler_timeout=240", "-o", "faulthandler_exit_on_timeout=true"]
PYTEST = ["-m", "pytest", "-q", "-p", "no:cacheprovider", *FINITE]
KEPT = ROOT / "build" / "mutants.json"  # Which tests run which lines


class Fault(NamedTuple):
    """A change of a piece of one line."""

    path: Path
    line: int
    start: int
    end: int
    text: str

    def applied(self) -> str:
        """Return the source of the file with the fault."""
        lines = self.path.read_text(encoding="utf-8").splitlines(keepends=True)
        row = lines[self.line - 1].encode()
        lines[self.line - 1] = (row[: self.start] + self.text.encode() + row[self.end :]).decode()
        return "".join(lines)

    def __str__(self) -> str:
        """Return file, line and change in words."""
        row = self.path.read_text(encoding="utf-8").splitlines()[self.line - 1].encode()
        before = row[self.start : self.end].decode()
        return f"{self.path.relative_to(ROOT / 'src' / 'stribeck')}:{self.line} `{before}` to `{self.text}`"


def faults_of(path: Path) -> Iterator[Fault]:
    """Yield the faults that a file may have, each within a line."""
    source = path.read_text(encoding="utf-8")
    rows = [row.encode() for row in source.splitlines()]
    tree = ast.parse(source)
    annotations = {id(each) for node in ast.walk(tree) for name in ("annotation", "returns") for each in _within(node, name)}
    for node in ast.walk(tree):
        if id(node) in annotations:
            continue
        if isinstance(node, ast.BinOp | ast.Compare | ast.BoolOp):
            yield from _swaps(path, rows, node)
        elif isinstance(node, ast.Constant) and type(node.value) in (int, float):
            yield Fault(path, node.lineno, node.col_offset, node.end_col_offset or 0, repr(2 * node.value + 1))
        elif isinstance(node, ast.If | ast.IfExp | ast.While) and node.test.lineno == node.test.end_lineno:
            test = node.test
            part = rows[test.lineno - 1][test.col_offset : test.end_col_offset].decode()
            yield Fault(path, test.lineno, test.col_offset, test.end_col_offset or 0, f"(not ({part}))")
        elif (
            isinstance(node, ast.Return)
            and node.lineno == node.end_lineno
            and ast.unparse(node) not in ("return", "return None")
        ):
            assert node.value is not None
            yield Fault(path, node.lineno, node.value.col_offset, node.value.end_col_offset or 0, "None")


def _within(node: ast.AST, name: str) -> Iterator[ast.AST]:
    """Yield the nodes of an annotation."""
    found = getattr(node, name, None)
    if isinstance(found, ast.AST):
        yield from ast.walk(found)


def _swaps(path: Path, rows: list[bytes], node: ast.BinOp | ast.Compare | ast.BoolOp) -> Iterator[Fault]:
    """Yield the faults of an operator that stands between two parts of one line."""
    if isinstance(node, ast.BinOp):
        parts, operators = [node.left, node.right], [node.op]
    elif isinstance(node, ast.Compare):
        parts, operators = [node.left, *node.comparators], node.ops
    else:
        parts, operators = node.values, [node.op] * (len(node.values) - 1)
    for left, operator, right in zip(parts, operators, parts[1:], strict=False):
        if type(operator) not in SWAPS or left.end_lineno != right.lineno:
            continue
        start, end = left.end_col_offset or 0, right.col_offset
        between, sign = rows[right.lineno - 1][start:end].decode(), SIGNS[type(operator)]
        at = between.find(sign)
        if at >= 0 and between.count(sign) == 1:
            place = start + len(between[:at].encode())
            yield Fault(path, right.lineno, place, place + len(sign), SIGNS[SWAPS[type(operator)]])


def drawn(number: int, seed: int) -> list[Fault]:
    """Return faults drawn evenly over the lines that may have one."""
    rng, places = random.Random(seed), list[list[Fault]]()
    for path in sorted((ROOT / "src").rglob("*.py")):
        by_line: dict[int, list[Fault]] = {}
        for fault in faults_of(path):
            by_line.setdefault(fault.line, []).append(fault)
        places += [by_line[line] for line in sorted(by_line)]
    return [rng.choice(each) for each in rng.sample(places, number)]


def run(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Return how pytest ended in a checkout."""
    threads = {name: "1" for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")}
    environment = {**os.environ, **threads, "PYTHONPATH": os.pathsep.join(map(str, (folder / "src", folder)))}
    return subprocess.run([sys.executable, *PYTEST, *arguments], cwd=folder, env=environment, capture_output=True, text=True)


def measured() -> dict[str, Any]:
    """Return the tests, the fastest first, and the numbers of those that run each line of each file, from one run of all."""
    sources = [path.stat().st_mtime for folder in ("src", "tests") for path in (ROOT / folder).rglob("*.py")]
    if KEPT.exists() and KEPT.stat().st_mtime > max(sources):
        return dict(json.loads(KEPT.read_text(encoding="utf-8")))
    from coverage import CoverageData

    with tempfile.TemporaryDirectory() as scratch:
        data, times, settings = (Path(scratch) / name for name in ("data", "times.xml", "settings"))
        settings.write_text(f"[run]\ndata_file = {data}\n", encoding="utf-8")
        cover = ["--cov=stribeck", f"--cov-config={settings}", "--cov-context=test", "--cov-report="]
        done = run(ROOT, *cover, "-n", "auto", f"--junitxml={times}", "tests")
        if done.returncode:
            sys.exit(f"Faults need tests that pass without one:\n{done.stdout[-2000:]}")
        seconds: dict[str, float] = {}
        for case in ElementTree.parse(times).iter("testcase"):
            seconds[f"{str(case.get('classname')).replace('.', '/')}.py::{case.get('name')}"] = float(case.get("time") or 0.0)
        covered = CoverageData(str(data))
        covered.read()
        contexts = {context.rpartition("|")[0] for context in covered.measured_contexts()} - {""}
        tests = sorted(contexts, key=lambda test: (seconds.get(test, 0.0), test))
        number = {test: i for i, test in enumerate(tests)}
        lines: dict[str, dict[str, list[int]]] = {}
        for name in covered.measured_files():
            lines[str(Path(name).relative_to(ROOT))] = {
                str(line): sorted({number[test] for test in (each.rpartition("|")[0] for each in at) if test})
                for line, at in covered.contexts_by_lineno(name).items()
            }
    found = {"tests": tests, "lines": lines}
    KEPT.parent.mkdir(exist_ok=True)
    KEPT.write_text(json.dumps(found), encoding="utf-8")
    return found


def caught_by(fault: Fault, tests: list[str]) -> tuple[str, str]:
    """Return the test that fails with a fault, empty if none does, and what was run; ``tests`` are those of its line."""
    with tempfile.TemporaryDirectory() as scratch:
        copy, listed = Path(scratch) / "checkout", Path(scratch) / "tests"
        shutil.copytree(ROOT, copy, ignore=shutil.ignore_patterns(".git", ".venv*", "build", "__pycache__", ".*_cache"))
        (copy / fault.path.relative_to(ROOT)).write_text(fault.applied(), encoding="utf-8")
        listed.write_text("\n".join(tests), encoding="utf-8")
        for where, arguments in (("tests of the line", [f"@{listed}"]), ("make test", ["-n", "auto", "tests"])):
            if where == "make test" or tests:
                done = run(copy, "-x", *arguments)
                if done.returncode not in (0, 5):
                    failed = re.search(r"^(?:FAILED|ERROR|SUBFAILED\S*) (\S+)", done.stdout, re.M)
                    return failed[1] if failed else "the collection", where
    return "", "make test"


def main() -> None:
    """Print a row a fault, and how many were caught."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n", 1)[0])
    parser.add_argument("--number", type=int, default=40)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", default="", help="numbers of faults, by commas")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="faults tried at a time")
    parser.add_argument("--list", action="store_true", help="print the faults and run nothing")
    given = parser.parse_args()
    only = {int(each) for each in given.only.split(",") if each}
    faults = [(i, fault) for i, fault in enumerate(drawn(given.number, given.seed)) if not only or i in only]
    print("| fault | | caught by | in |\n|---|---|---|---|", flush=True)
    if given.list:
        for i, fault in faults:
            print(f"| {i} | {fault} | - | not run |")
        return
    known = measured()

    def tried(numbered: tuple[int, Fault]) -> bool:
        i, fault = numbered
        at = known["lines"].get(str(fault.path.relative_to(ROOT)), {}).get(str(fault.line), [])
        test, where = caught_by(fault, [known["tests"][k] for k in at])
        print(f"| {i} | {fault} | {test or '**survived**'} | {where} |", flush=True)
        return bool(test)

    with ThreadPoolExecutor(given.jobs) as pool:
        print(f"\n{sum(pool.map(tried, faults))} of {len(faults)} caught")


if __name__ == "__main__":
    main()
