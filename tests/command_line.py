"""What the tests of the command share: case files to write, and the command called inside this process or outside."""

import json
import math
import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import stribeck as sb
from stribeck.cli import main, progress

progress.LINE_INTERVAL = math.inf  # On a busy machine a command may take long enough for a line of progress on stderr.

EXAMPLES = Path(__file__).parents[1] / "examples"
PDMS = EXAMPLES / "pdms_cylinder.toml"
HEAVY = Path(__file__).parent / "data" / "heavy.toml"
"""A contact at load group 1.6 under the exponential law, out of its range."""

SWEEP = EXAMPLES / "sweep.toml"
SCRIPT = Path(sys.executable).with_name("stribeck")

CONTACT = {
    "radius": '"10 mm"',
    "modulus": '"2.7 MPa"',
    "load": '"30 N/m"',
    "viscosity": '"50 mPa*s"',
    "speed": '"1 mm/s"',
    "roughness": '"1 um"',
    "alpha": "2.0",
    "beta": "0.06",
    "boundary_friction": "0.7",
}

FEW = ("--range", "0.3 mm/s", "0.1 m/s", "--points", "6")
"""A curve of the PDMS cylinder from mixed to hydrodynamic lubrication that is solved in a moment."""


def case_text(contact=None, **tables):
    """Return a case; None takes a key away, and further tables are dictionaries of TOML values."""
    tables = {"contact": CONTACT | (contact or {})} | tables
    parts = ['title = "A case"']
    for table, entries in tables.items():
        parts.append(f"[{table}]")
        parts += [f"{key} = {value}" for key, value in entries.items() if value is not None]
    return "\n".join(parts)


def toml_of(**tables):
    """Return tables of Python values as TOML."""

    def text(value):
        if isinstance(value, dict):
            return f"{{ {', '.join(f'{json.dumps(key)} = {text(each)}' for key, each in value.items())} }}"
        if isinstance(value, (list, tuple)):
            return f"[{', '.join(map(text, value))}]"
        return json.dumps(value).replace("NaN", "nan").replace("Infinity", "inf")

    plain = [f"{name} = {text(value)}" for name, value in tables.items() if not isinstance(value, dict)]
    for name, table in tables.items():
        if isinstance(table, dict):
            plain += [f"[{name}]", *(f"{key} = {text(each)}" for key, each in table.items())]
    return "\n".join(plain)


def fit_settings(table, geometry="line"):
    """Return what the table ``[fit]`` of a case asks for, read from a file."""
    load = "1 N" if geometry == "point" else "30 N/m"
    contact = {name: json.loads(value) for name, value in CONTACT.items()} | {"geometry": geometry, "load": load}
    with TemporaryDirectory() as folder:
        path = Path(folder) / "case.toml"
        path.write_text(toml_of(contact=contact, fit=table))
        return sb.load_case(path).fit


@dataclass(frozen=True)
class Answer:
    """What a call of the command gave."""

    code: int
    out: str
    err: str


def call(capsys, *tokens):
    """Run the command in this process."""
    capsys.readouterr()
    code = main([str(token) for token in tokens])
    return Answer(code, *capsys.readouterr())


def environment(**extra):
    """Return the environment for a process of its own: one BLAS thread, warnings as errors."""
    return os.environ | {"OPENBLAS_NUM_THREADS": "1", "PYTHONWARNINGS": "error"} | extra


def call_outside(*tokens, cwd=None, **extra):
    """Run the installed command in a process of its own."""
    run = subprocess.run(
        [SCRIPT, *map(str, tokens)],
        capture_output=True,
        text=True,
        cwd=cwd,
        env=environment(**extra),
        stdin=subprocess.DEVNULL,
        timeout=120,
    )
    return Answer(run.returncode, run.stdout, run.stderr)


def run_python(code, *tokens, cwd=None, **extra):
    """Run Python code in a process of its own."""
    run = subprocess.run(
        [sys.executable, "-c", code, *map(str, tokens)],
        capture_output=True,
        text=True,
        cwd=cwd,
        env=environment(**extra),
        timeout=120,
    )
    return Answer(run.returncode, run.stdout, run.stderr)
