"""Check that the extras can be installed at the lower bounds of pyproject.toml: that these are the lowest that go together.

Needs uv, whose path is the argument, and packaging.
"""

import subprocess
import sys
import tomllib
from pathlib import Path

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name
from packaging.version import Version

ROOT = Path(__file__).parents[1]
CHECKED = ("plot", "data", "fit", "cluster", "surface", "app", "report", "quick", "test")


def bounds(project: dict, extra: str) -> dict[str, Version]:
    """Return the highest of the lower bounds that the package and an extra state, by distribution."""
    found: dict[str, Version] = {}
    waiting = [*project["dependencies"], *project["optional-dependencies"][extra]]
    while waiting:
        needed = Requirement(waiting.pop())
        name = canonicalize_name(needed.name)
        if name == project["name"]:
            waiting += [line for each in needed.extras for line in project["optional-dependencies"][each]]
            continue
        [bound] = [each.version for each in needed.specifier if each.operator == ">="]
        found[name] = max(found.get(name, Version("0")), Version(bound))
    return found


def lowest(uv: str, extra: str) -> dict[str, Version]:
    """Return the lowest versions that go together."""
    command = [
        uv,
        "pip",
        "compile",
        "--quiet",
        "--resolution",
        "lowest-direct",
        "--extra",
        extra,
        "--no-header",
        "--no-annotate",
    ]
    done = subprocess.run([*command, "--python", sys.executable, str(ROOT / "pyproject.toml")], capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"The extra {extra} cannot be resolved at its lower bounds:\n{done.stderr}")
    pinned = [Requirement(line) for line in done.stdout.splitlines() if "==" in line]
    return {canonicalize_name(each.name): Version(next(iter(each.specifier)).version) for each in pinned}


def main() -> None:
    """Compare, and end with the lines that are wrong."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    wrong = []
    for extra in CHECKED:
        found = lowest(sys.argv[1], extra)
        for name, bound in bounds(project, extra).items():
            if found[name] != bound:
                wrong.append(f"{extra}: {name}>={bound} is stated, and {found[name]} is the lowest that goes with the others")
    if wrong:
        sys.exit("\n".join(wrong))
    print(f"Every extra can be installed at its lower bounds: {', '.join(CHECKED)}.")


if __name__ == "__main__":
    main()
