"""What the live curve of the front page reads: the packaged atlas as a script that a browser runs, and the explorer's chart.

`make docs` writes both beside docs/_static/live_curve.js. By itself: ``python docs/live_curve.py FOLDER``.
"""

import base64
import json
import math
import sys
import tomllib
import zlib
from dataclasses import asdict
from importlib.resources import files
from pathlib import Path

import numpy as np

from stribeck import atlas
from stribeck.atlas.grid import BREAK_TERMS, MAX_L_OF_HEAVY
from stribeck.atlas.table import COEFFICIENT_UNIT, LINE_FUNCTIONS
from stribeck.atlas.tables import TABLES
from stribeck.contacts.geometries import LINE
from stribeck.quantities.units import DIMENSIONS

FUNCTIONS = ("log_odds", "viscous_balanced", "central_gap", "minimum_gap")
"""What of the table the page shows, in the order in which the script reads it."""

TABLE = TABLES[0]
"""The table of the contacts that the page shows: cylinders of the exponential law."""

EXAMPLE = Path(__file__).parents[1] / "examples" / "pdms_cylinder.toml"

SLIDERS = {
    "radius": (1e-3, 0.1),
    "modulus": (1e5, 1e8),
    "load": (1.0, 1e3),
    "viscosity": (1e-3, 10.0),
    "speed": (1e-6, 10.0),
    "roughness": (1e-8, 1e-5),
    "beta": (5e-3, 1.0),
    "boundary_friction": (0.02, 2.0),
}
"""Ends of sliders that are narrower than what contacts have, so that most places of them lie on the atlas."""

GROUPS = {
    "speed_group": ("speed group", (1e-9, 1e2), 1e-5),
    "load_group": ("load group", atlas.BOX["load"], 0.1),
    "roughness_group": ("roughness group", (1e-8, 1.0), 1e-4),
}
"""Label, ends and first value of the sliders of the groups."""


def text(raw: bytes) -> str:
    """Return bytes, deflated, as text."""
    return base64.b64encode(zlib.compress(raw, 9)).decode()


def planes(whole: np.ndarray) -> bytes:
    """Return whole numbers of 32 bits as four planes of bytes, the lowest first."""
    return np.ascontiguousarray(whole.astype("<i4").view(np.uint8).reshape(-1, 4).T).tobytes()


def table() -> dict:
    """Return all that the script needs, ready for JSON."""
    chosen = [LINE_FUNCTIONS.index(name) for name in FUNCTIONS]
    with files("stribeck.atlas").joinpath(TABLE.file).open("rb") as stream, np.load(stream) as data:
        flat, breaks, film = data["blocks"], data["breaks"], data["film"]
    parts, position = [], 0
    for region in TABLE.grid.regions:
        for _ in range(region.pieces[0] * region.pieces[1]):
            for count in region.speeds:
                size = len(LINE_FUNCTIONS) * count * region.nodes[0] * region.nodes[1]
                parts.append(flat[position : position + size].reshape(len(LINE_FUNCTIONS), -1)[chosen].ravel())
                position += size
    assert position == len(flat)
    film = np.ascontiguousarray(film[:, :, [k - 1 for k in chosen[1:]]])  # smooth films have no odds
    return {
        "functions": FUNCTIONS,
        "regions": [asdict(region) for region in TABLE.grid.regions],
        "step": COEFFICIENT_UNIT,
        "breakTerms": BREAK_TERMS,
        "heavy": MAX_L_OF_HEAVY,
        "filmShape": film.shape,
        "filmRange": [math.log(end) for end in TABLE.grid.films],
        "box": {"speed": atlas.BOX["speed"], "load": atlas.BOX["load"], "kappa": atlas.BOX["relative_roughness"]},
        "coefficients": text(planes(np.concatenate(parts))),
        "breaks": text(breaks.astype("<f8").tobytes()),
        "film": text(film.astype("<f8").tobytes()),
        "inputs": inputs(),
    }


def inputs() -> dict[str, list[dict]]:
    """Return the rows of the sliders, in SI units and as groups: name, label, symbol, unit, ends and value at first."""
    given = tomllib.loads(EXAMPLE.read_text())["contact"]
    si = []
    for name in LINE.names:
        row = LINE.quantities[name]
        kind = DIMENSIONS[row.dimension]
        low, high = SLIDERS.get(name, row.usual)
        steps = {str(power): unit for power, unit in kind.steps.items()}
        value = LINE.rows[name].checked(given[name])
        si.append({"name": name, "label": row.label, "steps": steps, "low": low, "high": high, "value": value})
    by_name = {row["name"]: row for row in si}
    beta, mu0 = by_name["beta"], by_name["boundary_friction"]
    groups = [
        {"name": name, "label": label, "steps": {"0": ""}, "low": low, "high": high, "value": value}
        for name, (label, (low, high), value) in GROUPS.items()
    ]
    return {"si": si, "groups": [*groups, beta, mu0]}


def write(folder: Path) -> None:
    """Write the table as a script, and the chart of the explorer with its colours."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "atlas_table.js").write_text(f"window.stribeckTable = {json.dumps(table(), separators=(',', ':'))};\n")
    for name in ("chart.js", "chart.css"):
        (folder / name).write_bytes(files("stribeck.explorer").joinpath(name).read_bytes())


if __name__ == "__main__":
    write(Path(sys.argv[1]))
