"""Size of the house and speed of its core, of one revision beside the working tree.

Usage::

    python benchmarks/house.py [REVISION] [--times] [--rounds 3]

The table counts lines, nouns, constants, ways to a neighbouring state, circles of files and what tests import, all read from
the sources.  With ``--times`` both trees solve the same work in turn, each in a process of its own, and the table shows CPU
seconds over those of an LU factorisation of a 1000 x 1000 matrix: least of the rounds; and the CPU seconds of two commands,
least of ten calls.
"""

from __future__ import annotations

import argparse
import ast
import io
import json
import os
import re
import subprocess
import sys
import tarfile
import tempfile
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parents[1]
START = "7e387e1f"  # the last commit before the house was halved
CORE = ("numerics", "equations", "solver")

# Names of what finds a state from states beside it; those that are gone count no more.
WAYS = {
    "WarmStartSolver": "solver",
    "NeighbourSolver": "solver",
    "next_state": "solver",
    "Corrector": "solver",
    "follow": "",
    "march": "numerics",
    "_Chain": "batches",
    "KeptStates": "batches",
    "Lattice": "batches",
    "solved_parts": "fits",
    "kept_parts": "fits",
    "lattice_parts": "fits",
    "curve_parts": "fits",
    "kept_balls": "fits",
    "Between": "fits",
    "Scattered": "numerics",
    "_Slopes": "regimes",
    "_followed": "uncertainty",
    "_correct_by_solved_states": "uncertainty",
    "interpolate_to": "solver",
    "Neighbours": "solver",
}
# Names of what finds an event on a curve.  What asks the one search of the package does not search itself.
LOCATORS = {
    "Landmarks",
    "_zero",
    "_lowest_of_function",
    "_lowest_of_points",
    "first_zero",
    "least_by_slope",
    "rising_zeros",
    "zero_of_growing",
    "crossing",
    "_passages",
    "_located",
    "_root",
    "grown",
}
EVENTS = "stribeck.numerics.events"
LOCATING = ("curves", "numerics", "regimes")


def files(tree: Path, folder: str) -> list[Path]:
    """Return the Python files of a folder."""
    return sorted(path for path in (tree / folder).rglob("*.py") if "__pycache__" not in path.parts)


def parsed(path: Path) -> ast.Module:
    """Return the syntax tree of a file."""
    return ast.parse(path.read_text())


def numbers(node: ast.expr) -> int:
    """Return how many numbers an expression of literals holds, 0 if it holds anything else."""
    if isinstance(node, ast.Constant):
        return int(isinstance(node.value, int | float) and not isinstance(node.value, bool))
    if isinstance(node, ast.UnaryOp):
        return numbers(node.operand)
    if isinstance(node, ast.BinOp):
        return int(bool(numbers(node.left) and numbers(node.right)))
    if isinstance(node, ast.Tuple):
        parts = [numbers(each) for each in node.elts]
        return sum(parts) if all(parts) else 0
    return 0


def constants(path: Path) -> int:
    """Return the number of numeric constants of a module."""
    values = [node.value for node in parsed(path).body if isinstance(node, ast.Assign | ast.AnnAssign) and node.value]
    return sum(numbers(value) for value in values)


def defined(path: Path) -> Iterator[ast.ClassDef | ast.FunctionDef]:
    """Yield all classes and functions of a file."""
    yield from (node for node in ast.walk(parsed(path)) if isinstance(node, ast.ClassDef | ast.FunctionDef))


def module_name(tree: Path, path: Path) -> str:
    """Return the dotted name of a file of the package."""
    return ".".join(path.relative_to(tree / "src").with_suffix("").parts).removesuffix(".__init__")


def imports(path: Path, known: set[str]) -> set[str]:
    """Return the modules of the package that a file imports, for its types too."""
    body: list[ast.AST] = [parsed(path)]
    found: set[str] = set()
    while body:
        node = body.pop()
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            parts = {f"{node.module}.{alias.name}" for alias in node.names}
            found |= {each if each in known else node.module for each in parts}
        body += ast.iter_child_nodes(node)
    return found & known


def circles(tree: Path) -> int:
    """Return the number of groups of modules that import one another, the package's own list of names left out."""
    paths = {module_name(tree, path): path for path in files(tree, "src/stribeck")}
    paths = {name: path for name, path in paths.items() if path.name not in ("__init__.py", "__main__.py")}
    arrows = {name: imports(path, set(paths)) - {name} for name, path in paths.items()}

    def reached(start: str) -> set[str]:
        seen, todo = set(), [start]
        while todo:
            for other in arrows[todo.pop()] - seen:
                seen.add(other)
                todo.append(other)
        return seen

    reach = {name: reached(name) for name in arrows}
    groups = {frozenset(other for other in reach[name] if name in reach[other]) for name in arrows if name in reach[name]}
    return len(groups)


# What docs/api.rst shows beside the packages.
REFERENCE = ("contact_laws", "plot.phase_diagram", "regimes.margins", "results")


def inward(tree: Path) -> int:
    """Return the number of test files that import modules of the package other than `stribeck` and `stribeck.numerics`."""
    rooms = (
        "asymptotics",
        "asymptotics.point",
        "atlas",
        "fluids",
        "solids",
        "surfaces",
        "asperity_friction",
        "experiments.experiment",
    )
    shown = {"stribeck", *(f"stribeck.{room}" for room in (*rooms, *REFERENCE))}
    count = 0
    for path in (tree / "tests").glob("test_*.py"):
        names = set()
        for node in ast.walk(parsed(path)):
            if isinstance(node, ast.Import):
                names |= {alias.name for alias in node.names}
            elif isinstance(node, ast.ImportFrom) and node.module:
                names.add(node.module)
        ours = {name for name in names if name.split(".")[0] == "stribeck"}
        count += any(name not in shown and not name.startswith("stribeck.numerics") for name in ours)
    return count


def words_of_docstrings(tree: Path) -> int:
    """Return the number of words of all docstrings of the package."""
    total = 0
    for path in files(tree, "src/stribeck"):
        nodes = [parsed(path), *defined(path)]
        total += sum(len(re.findall(r"\w+", ast.get_docstring(node) or "")) for node in nodes)
    return total


def counted(tree: Path) -> dict[str, int]:
    """Return all that is counted in a tree, by what it is."""
    package = tree / "src" / "stribeck"
    lines = {
        folder.name: sum(len(path.read_text().splitlines()) for path in folder.rglob("*.py"))
        for folder in sorted(package.iterdir())
        if folder.is_dir() and folder.name != "__pycache__"
    }
    inside = [path for folder in CORE for path in files(tree, f"src/stribeck/{folder}")]
    names = {(path.relative_to(package).parts[0], node.name) for path in files(tree, "src/stribeck") for node in defined(path)}

    def by_room(wanted: dict[str, str]) -> int:
        every = {name for _, name in names}
        return sum((room, name) in names if room else name in every for name, room in wanted.items())

    def locates(path: Path) -> bool:
        is_named = any(node.name in LOCATORS for node in defined(path))
        return is_named and not imports(path, {EVENTS})

    study = [path for folder in (*CORE, "batches", "curves", "fits/states") for path in files(tree, f"src/stribeck/{folder}")]
    study += (package / "fits").glob("states.py")
    return {
        "lines of the package": sum(lines.values()),
        "files": len(files(tree, "src/stribeck")),
        "classes of numerics, equations, solver, batches, curves, fits/states": sum(
            isinstance(node, ast.ClassDef) for path in study for node in defined(path)
        ),
        "constants of numerics, equations, solver": sum(constants(path) for path in inside),
        "constants of the package": sum(constants(path) for path in files(tree, "src/stribeck")),
        "ways to a neighbouring state": by_room(WAYS),
        "modules that locate events": sum(
            map(locates, (path for room in LOCATING for path in files(tree, f"src/stribeck/{room}")))
        ),
        "circles of modules": circles(tree),
        "tests that import internals": inward(tree),
        "words of docstrings": words_of_docstrings(tree),
        "lines of tests": sum(len(path.read_text().splitlines()) for path in (tree / "tests").glob("*.py")),
        **{f"lines of {name}": count for name, count in lines.items()},
    }


# --- times ---

WORK = """
import json, sys, tempfile, time
from pathlib import Path
import numpy as np
from scipy.linalg import lapack
import stribeck as sb

matrix = np.random.default_rng(1).normal(size=(1000, 1000))

def seconds(call):
    start = time.process_time()
    call()
    return time.process_time() - start

unit = min(seconds(lambda: lapack.dgetrf(matrix)) for _ in range(5))
speeds = np.geomspace(1e-5, 1e-1, 12)
ball = sb.Groups(1.0, 1e-3, 1e-3 * 1e-3 ** (2 / 3), geometry="point")
line = sb.LineContact.from_toml(sys.argv[1]) if hasattr(sb.LineContact, "from_toml") else sb.load_case(sys.argv[1]).contact

def curve_of_a_line():
    sb.stribeck_curve(load=0.1, roughness=1e-4, speed=(1e-9, 10.0), points=101).transitions

def curve_of_a_ball():
    sb.stribeck_curve(ball, speed=(1e-7, 10.0), points=25, rtol=1e-5).transitions

def margins_of_a_line():
    sb.explain(line)

def regimes_of_a_ball():
    sb.explain(sb.load_case(sys.argv[2]).contact, rtol=1e-3)

def fit_of_a_ball():
    contact = sb.load_case(sys.argv[2]).contact
    found = sb.stribeck_curve(contact, speed=(0.1 * contact.speed, 10 * contact.speed), points=9, rtol=1e-3)
    noise = np.exp(0.02 * np.random.default_rng(3).standard_normal(9))
    rows = zip(found.values.tolist(), (found.friction * noise).tolist())
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "measured.csv"
        file.write_text("sum of speeds [m/s],friction\\n" + "".join(f"{speed},{friction}\\n" for speed, friction in rows))
        sb.fit(file, contact)

found = {}
for work in (curve_of_a_line, curve_of_a_ball, margins_of_a_line, regimes_of_a_ball, fit_of_a_ball):
    try:
        found[work.__name__.replace("_", " ")] = seconds(work) / unit
    except Exception as failure:
        print(f"{work.__name__}: {type(failure).__name__}: {failure}", file=sys.stderr)
json.dump(found, sys.stdout)
"""


def times(tree: Path) -> dict[str, float]:
    """Return the times of all work in a tree, in units of an LU factorisation."""
    examples = ROOT / "examples"
    environment = {**os.environ, "PYTHONPATH": str(tree / "src"), "OPENBLAS_NUM_THREADS": "1"}
    command = [sys.executable, "-c", WORK, str(examples / "pdms_cylinder.toml"), str(examples / "tongue_model.toml")]
    run = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    sys.stderr.write(run.stderr)
    return json.loads(run.stdout)


# What a user waits for at every call.
COMMANDS = {"stribeck --help": ("--help",), "stribeck solve": ("solve", str(ROOT / "examples" / "pdms_cylinder.toml"))}
CALLS = 10  # of each command, of which the fastest counts


def starts(tree: Path) -> dict[str, float]:
    """Return the CPU seconds of commands, each in a process of its own; the first call compiles what the others load."""
    left_out = ("PYTHONDONTWRITEBYTECODE",)
    environment = {name: value for name, value in os.environ.items() if name not in left_out}
    environment |= {"PYTHONPATH": str(tree / "src"), "OPENBLAS_NUM_THREADS": "1"}

    def seconds(words: tuple[str, ...]) -> float:
        before = os.times()
        subprocess.run([sys.executable, "-m", "stribeck", *words], env=environment, stdout=subprocess.DEVNULL, check=True)
        after = os.times()
        return after.children_user - before.children_user + after.children_system - before.children_system

    return {name: min(seconds(words) for _ in range(CALLS)) for name, words in COMMANDS.items()}


def checked_out(revision: str, folder: str) -> Path:
    """Write a revision into a folder and return it."""
    archive = subprocess.run(["git", "archive", revision], cwd=ROOT, capture_output=True, check=True).stdout
    with tarfile.open(fileobj=io.BytesIO(archive)) as tar:
        tar.extractall(folder, filter="data")
    return Path(folder)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("revision", nargs="?", default=START)
    parser.add_argument("--times", action="store_true", help="compare times too (minutes)")
    parser.add_argument("--rounds", type=int, default=3)
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        before = checked_out(asked.revision, folder)
        old, new = counted(before), counted(ROOT)
        print(f"| | {asked.revision} | now |\n|---|---|---|")
        for name in {**old, **new}:
            print(f"| {name} | {old.get(name, 0)} | {new.get(name, 0)} |")
        if asked.times:
            begun = starts(before), starts(ROOT)
            print(f"\n| CPU time [s] | {asked.revision} | now |\n|---|---|---|")
            for name in COMMANDS:
                print(f"| {name} | {begun[0][name]:.2f} | {begun[1][name]:.2f} |")
            pairs = [(times(before), times(ROOT)) for _ in range(asked.rounds)]
            print(f"\n| CPU time [LU(1000)] | {asked.revision} | now | ratio |\n|---|---|---|---|")
            for name in pairs[0][0]:
                least = [min(each[side][name] for each in pairs) for side in (0, 1)]
                print(f"| {name} | {least[0]:.1f} | {least[1]:.1f} | {least[1] / least[0]:.2f} |")


if __name__ == "__main__":
    main()
