"""Make the pictures and the tables of validity.md anew: every formula of the table judged by solved states.

Usage::

    python docs/validity.py [BLOCK ...]

Takes about three minutes on one core; with the names of blocks (``ratios`` or keys of ``SECTIONS``) only these are
made.  What stands in the page between marks is replaced, all other text is kept.
"""

from __future__ import annotations

import json
import math
import re
import sys
import time
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from PIL import Image

from evidence.coefficients import COEFFICIENT_RATIOS, JUDGED_FORMULAS, largest_errors
from evidence.error_maps import error_maps, kind_of
from evidence.plot import plot_error_maps
from stribeck.asymptotics import FORMULAS, Formula, Limit
from stribeck.asymptotics.formula import COEFFICIENT_RATIO
from stribeck.numerics.threads import one_blas_thread

if TYPE_CHECKING:
    import xarray

FOLDER = Path(__file__).parent
PAGE = FOLDER / "validity.md"
IMAGES = FOLDER / "images"
WORST = FOLDER.parent / "tests" / "data" / "worst_errors.json"
"""The largest error of each formula on its map and the state where it is, which tests solve again."""

ABOUT = {
    "smooth": "smooth",
    "rest": "at rest",
    "mixed": "any state",
    "located": "a curve",
    "smooth ball": "smooth",
    "ball at rest": "at rest",
    "any ball": "any state",
}
"""What a formula is about, in the words of the table."""

SECTIONS = {
    "every_speed": ("uniform", "load_sharing"),
    "smooth": ("hertz", "hydrodynamic", "film_layers"),
    "at_rest": ("rest", "edge_layer"),
    "boundary": ("perturbation", "boundary", "wedge"),
    "mixed": ("mixed", "transitions"),
    "ball": tuple(
        f"point.{each}" for each in ("hertz", "rest", "film", "rigid", "regressions", "boundary", "sharing", "friction")
    ),
}
"""Modules of formulas in each table of the page."""

SYMBOLS = {
    "speed": "λ",
    "load": "F",
    "relative_roughness": "κ",
    "1/speed": "1/λ",
    "1/relative_roughness": "1/κ",
    "fluid_number": "n",
    COEFFICIENT_RATIO: "β/μ<sub>0</sub>",
}
"""Parameters of ranges by their symbols; others have their names."""

RATIO_POINTS = (22, 19)
"""Loads and relative roughnesses at which the errors over beta/mu0 are measured."""


def of_modules(*modules: str) -> list[Formula[Any]]:
    """Return the formulas of some modules."""
    return [formula for module in modules for formula in FORMULAS if formula.module == module]


def short(value: float) -> str:
    """Return a number as text, such as ``0.05`` or ``2.154e-3``."""
    text = f"{value:.4g}" if value >= 0.01 else re.sub(r"\.?0+e", "e", f"{value:.3e}")
    return re.sub(r"e([+-])0*(\d)", lambda found: "e" + found[1].replace("+", "") + found[2], text)


def percent(value: float) -> str:
    """Return an error in per cent as text with three digits, such as ``0.0213``."""
    text = f"{100 * value:.3g}"
    return short(float(text)) if "e" in text else text


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table in Markdown."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(cells)} |" for cells in lines)


def interval(limit: Limit) -> str:
    """Return one limit of a range, such as ``F 1e-4…0.7`` or ``κ ≤ 0.01``."""
    name = SYMBOLS.get(limit.parameter, limit.parameter.replace("_", " "))
    if name.startswith("1/"):
        return f"{name[2:]} ≥ {short(1 / limit.high)}"
    if math.isinf(limit.high):
        return f"{name} ≥ {short(limit.low)}"
    return f"{name} {short(limit.low)}…{short(limit.high)}" if limit.low else f"{name} ≤ {short(limit.high)}"


def in_words(limits: Iterable[Limit]) -> str:
    """Return a range in words."""
    return ", ".join(map(interval, limits))


def measured(data: xarray.Dataset) -> dict[str, Any]:
    """Return the largest error of a map in the range, with the state where it is."""
    size = np.where(data["valid"].values, np.abs(data["error"].values), np.nan)
    if not np.isfinite(size).any():
        return {}
    at = np.unravel_index(int(np.nanargmax(size)), size.shape)
    found = zip(data["error"].dims, at, strict=True)
    place = {str(name): float(short(float(data[name].values[i]))) for name, i in found}
    return {"largest": float(f"{size[at]:.3g}"), "at": place}


def holds(formula: Formula[Any]) -> str:
    """Return what a formula is about and its range, in words."""
    return ", ".join(filter(None, (ABOUT[kind_of(formula)], in_words(formula.limits))))


def error_table(section: str) -> str:
    """Return the formulas of a section with the errors that they state, those of one range in one row."""
    rows: dict[str, list[str]] = {}
    for formula in of_modules(*SECTIONS[section]):
        rows.setdefault(holds(formula), []).append(f"`{formula.name}` {percent(formula.worst)}")
    return table(["Holds for", "Formulas, error [%]"], [[words, ", ".join(found)] for words, found in rows.items()])


def ratio_table() -> str:
    """Return the largest errors of the laws of friction and of its minimum for several beta/mu0; in range bold."""
    rows = []
    for name, (formula, _) in JUDGED_FORMULAS.items():
        [limit] = [limit for limit in formula.limits if limit.parameter == COEFFICIENT_RATIO]
        cells = []
        for ratio, error in zip(COEFFICIENT_RATIOS, largest_errors(name, points=RATIO_POINTS)[0], strict=True):
            cells.append(f"**{percent(error)}**" if limit.low <= ratio <= limit.high else percent(error))
        rows.append([f"`{name.partition(',')[0]}`{name.partition(',')[1]}{name.partition(',')[2]}", *cells])
    return table(["β/μ<sub>0</sub> =", *map(short, COEFFICIENT_RATIOS)], rows)


def blocks_of(text: str) -> dict[str, str]:
    """Return what stands between the marks of a page, by name."""
    return {
        name: body.strip("\n") for name, body in re.findall(r"<!-- begin (.*?) -->\n(.*?)<!-- end \1 -->", text, re.DOTALL)
    }


def filled(text: str, blocks: dict[str, str]) -> str:
    """Return a page with new text between its marks."""
    for name, body in blocks.items():
        block = f"<!-- begin {name} -->\n{body}\n<!-- end {name} -->"
        text, found = re.subn(rf"<!-- begin {name} -->\n.*?<!-- end {name} -->", lambda _: block, text, flags=re.DOTALL)  # noqa: B023
        if not found:
            sys.exit(f"the page has no marks for {name}")
    return text


@one_blas_thread
def main(wanted: Sequence[str] = ()) -> None:
    """Solve, draw, and write the page, or those of its blocks that are named."""
    start = time.perf_counter()
    known = ("ratios", *SECTIONS)
    if unknown := set(wanted) - set(known):
        sys.exit(f"no block is called {', '.join(sorted(unknown))}; there are {', '.join(known)}")
    made = wanted or known

    def say(what: str) -> None:
        print(f"{time.perf_counter() - start:5.0f} s  {what}", flush=True)

    wanted_modules = [module for section in SECTIONS if section in made for module in SECTIONS[section]]
    maps: dict[str, xarray.Dataset] = {}
    for kind in ABOUT:
        if judged := [each for each in of_modules(*wanted_modules) if kind_of(each) == kind]:
            say(f"formulas about {kind}")
            maps |= error_maps(judged)
    for module in wanted_modules:
        say(f"picture of {module}")
        pairs = [(formula, maps[formula.name]) for formula in of_modules(module)]
        path = IMAGES / f"validity_{module.replace('.', '_')}.png"
        plot_error_maps(pairs, path, force=True, title=f"Errors of stribeck.asymptotics.{module}")
        Image.open(path).convert("RGB").quantize(256).save(path, optimize=True)  # a third of the bytes
    found = {name: measured(data) for name, data in maps.items()}
    blocks = {section: error_table(section) for section in SECTIONS if section in made}
    worst = json.loads(WORST.read_text()) | {name: [each["largest"], each["at"]] for name, each in found.items() if each}
    lines = [f"  {json.dumps(name)}: {json.dumps(worst[name])}" for name in sorted(worst)]
    WORST.write_text("{\n" + ",\n".join(lines) + "\n}\n")
    if "ratios" in made:
        say("friction over the ratio of its coefficients")
        blocks["ratios"] = ratio_table()
    PAGE.write_text(filled(PAGE.read_text(), blocks))
    say("done")


if __name__ == "__main__":
    main(sys.argv[1:])
