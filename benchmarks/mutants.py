"""How many small faults in the package `make test` catches: one fault at a time in a copy of the sources.

Usage::

    python benchmarks/mutants.py [--number 40] [--seed 1] [--only 3,7] [--list]

A fixed seed draws faults evenly over the lines of ``src`` that hold code: a comparison turned round, an arithmetic sign or a
number changed, a condition negated, what a function returns left out.  For each the script copies the checkout, applies the
fault and runs the tests until one fails: first the modules that name the file's subject, then `make test`.  It prints a row a
fault: the file, the fault, the test that caught it, and what was run.  Only what `make test` lets pass counts as survived.
"""

from __future__ import annotations

import argparse
import ast
import os
import random
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

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
PYTEST = ["-m", "pytest", "-q", "-x", "-p", "no:cacheprovider", "-n", "auto"]


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
        elif isinstance(node, ast.Return) and node.value is not None and node.lineno == node.end_lineno:
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


def tests_of(fault: Fault) -> list[str]:
    """Return the test modules that name the file's subject or what it defines."""
    defined = re.findall(r"^(?:def|class) (\w+)", fault.path.read_text(encoding="utf-8"), re.M)
    names = {fault.path.stem, *defined} - {"__init__"}
    near = re.compile(r"\b(" + "|".join(map(re.escape, sorted(names))) + r")\b")
    modules = sorted((ROOT / "tests").glob("test_*.py"))
    return [str(each.relative_to(ROOT)) for each in modules if near.search(each.read_text(encoding="utf-8"))]


def caught_by(fault: Fault, python: str) -> tuple[str, str]:
    """Return the test that fails with a fault, empty if none does, and what was run."""
    with tempfile.TemporaryDirectory() as scratch:
        copy = Path(scratch) / "checkout"
        shutil.copytree(ROOT, copy, ignore=shutil.ignore_patterns(".git", ".venv", "build", "__pycache__", ".*_cache"))
        (copy / fault.path.relative_to(ROOT)).write_text(fault.applied(), encoding="utf-8")
        threads = {name: "1" for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")}
        environment = {**os.environ, **threads, "PYTHONPATH": os.pathsep.join(map(str, (copy / "src", copy)))}
        for run, tests in (("near tests", tests_of(fault)), ("make test", ["tests"])):
            if not tests:
                continue
            done = subprocess.run([python, *PYTEST, *tests], cwd=copy, env=environment, capture_output=True, text=True)
            if done.returncode not in (0, 5):
                failed = re.search(r"^(?:FAILED|ERROR|SUBFAILED\S*) (\S+)", done.stdout, re.M)
                return failed[1] if failed else "the collection", run
    return "", "make test"


def main() -> None:
    """Print a row a fault, and how many were caught."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n", 1)[0])
    parser.add_argument("--number", type=int, default=40)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", default="", help="numbers of faults, by commas")
    parser.add_argument("--list", action="store_true", help="print the faults and run nothing")
    given = parser.parse_args()
    only = {int(each) for each in given.only.split(",") if each}
    caught = run = 0
    print("| fault | | caught by | in |\n|---|---|---|---|")
    for i, fault in enumerate(drawn(given.number, given.seed)):
        if only and i not in only:
            continue
        test, where = ("", "not run") if given.list else caught_by(fault, sys.executable)
        run, caught = run + 1, caught + bool(test)
        print(f"| {i} | {fault} | {test or ('-' if given.list else '**survived**')} | {where} |", flush=True)
    print(f"\n{caught} of {run} caught" if not given.list else "")


if __name__ == "__main__":
    main()
