"""Make the pictures and the tables of validity.md anew: every formula of the table judged by solved states.

Usage::

    python docs/validity.py [BLOCK ...]

Takes about three minutes on one core; with the names of blocks (``formulas``, ``shares``, ``box``, ``ratios`` or modules of
formulas) only these are made.  What stands in the page between marks is replaced, all other text is kept; a module
of formulas that has no section yet gets one.
"""

from __future__ import annotations

import re
import sys
import time
from collections.abc import Iterable, Sequence
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

import stribeck as sb
from stribeck.asymptotics import FORMULAS, Formula
from stribeck.asymptotics.formula import COEFFICIENTS
from stribeck.asymptotics.rough import load_sharing, transitions, uniform
from stribeck.evidence.coefficients import JUDGED, RATIOS, largest_errors
from stribeck.evidence.formulas import error_map, error_maps, kind_of
from stribeck.evidence.plot import plot_error_maps
from stribeck.numerics.threads import one_blas_thread

if TYPE_CHECKING:
    import xarray

FOLDER = Path(__file__).parent
PAGE = FOLDER / "validity.md"
IMAGES = FOLDER / "images"

ABOUT = {"smooth": "smooth", "rest": "at rest", "mixed": "any state", "located": "a curve"} | {
    kind: kind for kind in ("smooth ball", "ball at rest", "any ball")
}
"""What a formula is about, in the words of the table."""

SHARE_LOADS = (1e-4, 3e-4, 1e-3, 3e-3, 1e-2, 3e-2, 0.1, 0.3, 0.7)
SHARE_KAPPAS = np.logspace(-4, -1, 7)
"""Grid of the speeds at which the fluid carries a share."""

BOX_LOADS = (1e-4, 1e-3, 1e-2, 0.1, 0.4, 0.7)
BOX_KAPPAS = np.logspace(-4, -1, 7)
BOX_SPEEDS = np.logspace(-9, 2, 34)
BETAS = (1.0, 0.1, 0.01)
"""Grid in the box of the uniform laws, and coefficients of the contact law for which the friction is judged."""


RATIO_POINTS = (22, 19)
"""Loads and relative roughnesses at which the errors over beta/mu0 are measured."""


def modules() -> list[str]:
    """Return the modules of formulas, in the order of the table."""
    return list(dict.fromkeys(formula.module for formula in FORMULAS))


def of_module(module: str) -> list[Formula[Any]]:
    """Return the formulas of a module."""
    return [formula for formula in FORMULAS if formula.module == module]


def short(value: float) -> str:
    """Return a number as text, such as ``0.05`` or ``2.154e-3``."""
    text = f"{value:.4g}" if value >= 0.01 else re.sub(r"\.?0+e", "e", f"{value:.3e}")
    return re.sub(r"e([+-])0*(\d)", lambda found: "e" + found[1].replace("+", "") + found[2], text)


def percent(value: float) -> str:
    """Return an error as text with three digits, such as ``0.0213 %``."""
    text = f"{100 * value:.3g}"
    return f"{short(float(text)) if 'e' in text else text} %"


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table in Markdown."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(cells)} |" for cells in lines)


def formula_table() -> str:
    """Return the table of all formulas, from what they say of themselves."""
    rows = []
    for formula in FORMULAS:
        order = Fraction(formula.error_order).limit_denominator(12)
        small = formula.small.replace("_", " ")
        vanishes = f"({small})<sup>{order}</sup>" if formula.small and order != 1 else small or "no small parameter"
        limits = re.sub(r"[0-9.]+e-\d+|\b0\.00\d*", lambda found: short(float(found[0])), formula.range)
        worst = percent(formula.worst)
        rows.append([f"`{formula.name}`", ABOUT[kind_of(formula)], limits, worst, vanishes, formula.source.replace("|", "/")])
    return table(["Formula", "About", "Range", "Worst error there", "Error goes as", "Source"], rows)


def place(data: xarray.Dataset, at: Sequence[int]) -> str:
    """Return in words which state of a map stands at some indices."""
    names = {"load": "load", "relative_roughness": "kappa", "speed": "speed"}
    found = zip(data["error"].dims, at, strict=True)
    return ", ".join(f"{names[str(name)]} {short(float(data[name].values[i]))}" for name, i in found)


def measured(data: xarray.Dataset) -> list[str]:
    """Return states in range, median error, worst error and where that is."""
    size = np.where(data["valid"].values, np.abs(data["error"].values), np.nan)
    known = np.isfinite(size)
    if not known.any():
        return ["0", "", "", ""]
    at = np.unravel_index(int(np.nanargmax(size)), size.shape)
    return [
        str(int(known.sum())),
        percent(float(np.nanmedian(size))),
        percent(float(size[at])),
        place(data, [int(i) for i in at]),
    ]


def measured_table(module: str, maps: dict[str, xarray.Dataset]) -> str:
    """Return the errors of the formulas of a module on the grid of its pictures."""
    rows = [[f"`{formula.name}`", *measured(maps[formula.name])] for formula in of_module(module)]
    return table(["Formula", "States in range", "Median error", "Worst error", "at"], rows)


def share_maps() -> list[tuple[Formula[Any], xarray.Dataset]]:
    """Return our law of load sharing and the criterion of [BP], judged by the speeds at which the fluid carries 50 and 5 %."""
    grid: dict[str, Any] = {"load": SHARE_LOADS, "relative_roughness": SHARE_KAPPAS}
    ours, theirs = load_sharing.speed_at_fluid_share, transitions.speed_boundary_to_mixed
    return [
        (ours, error_map(ours, **grid, share=0.5)),
        (ours, error_map(ours, **grid, share=0.05, predicts="speed_at_5_percent_fluid")),
        (theirs, error_map(theirs, **grid)),
        (theirs, error_map(theirs, **grid, predicts="speed_at_5_percent_fluid")),
    ]


def share_table(maps: list[tuple[Formula[Any], xarray.Dataset]]) -> str:
    """Return the errors over the whole grid of those maps, with their signs."""
    rows = []
    for _, data in maps:
        error = data["error"].values
        ends = [f"{percent(float(end))}" for end in (np.nanmin(error), np.nanmax(error))]
        fluid = "5 %" if "5" in data.attrs["predicts"] else "50 %"
        rows.append([f"`{data.attrs['title']}`", fluid, percent(float(np.nanmedian(np.abs(error)))), *ends])
    return table(["Formula", "Fluid carries", "Median size", "Smallest error", "Largest error"], rows)


@one_blas_thread
def uniform_table() -> str:
    """Return the error of the uniform law of friction over its whole box for several coefficients of the contact law."""
    errors: dict[float, list[tuple[float, float, float, float]]] = {beta: [] for beta in BETAS}
    for load in BOX_LOADS:
        for kappa in BOX_KAPPAS.tolist():
            curve = sb.stribeck_curve(load=load, roughness=kappa * load, speed=BOX_SPEEDS, rtol=1e-7)
            for beta in BETAS:
                right = np.array(
                    [
                        state.friction(boundary_friction=1.0, beta=beta, definition="published").total
                        for state in curve.solutions
                    ]
                )
                off = np.abs(uniform.friction.function(curve.groups, 1.0, beta) / right - 1).tolist()
                errors[beta] += [(e, load, kappa, speed) for e, speed in zip(off, curve.values.tolist(), strict=True)]
    rows = []
    for beta, found in errors.items():
        size = np.array([item[0] for item in found])
        worst, load, kappa, speed = max(found)
        where = f"load {short(load)}, kappa {short(kappa)}, speed {short(speed)}"
        parts = [f"{np.mean(size < limit):.1%}".replace("%", " %") for limit in (0.01, 0.03)]
        rows.append([short(beta), str(len(size)), percent(float(np.median(size))), *parts, percent(worst), where])
    return table(["beta", "States", "Median error", "within 1 %", "within 3 %", "Worst error", "at"], rows)


def ratio_table() -> str:
    """Return the largest errors of the laws of friction and of its minimum for several beta/mu0; in range bold."""
    rows = []
    for name, (formula, _) in JUDGED.items():
        [limit] = [limit for limit in formula.limits if limit.parameter == COEFFICIENTS]
        cells = []
        for ratio, error in zip(RATIOS, largest_errors(name, points=RATIO_POINTS)[0], strict=True):
            cells.append(f"**{percent(error)}**" if limit.low <= ratio <= limit.high else percent(error))
        rows.append([f"`{name.partition(',')[0]}`{name.partition(',')[1]}{name.partition(',')[2]}", *cells])
    return table(["Largest error at beta/mu0 =", *map(short, RATIOS)], rows)


def blocks_of(text: str) -> dict[str, str]:
    """Return what stands between the marks of a page, by name."""
    return {
        name: body.strip("\n") for name, body in re.findall(r"<!-- begin (.*?) -->\n(.*?)<!-- end \1 -->", text, re.DOTALL)
    }


def filled(text: str, blocks: dict[str, str]) -> str:
    """Return a page with new text between its marks; a block without marks is added at the end, with its picture."""
    for name, body in blocks.items():
        block = f"<!-- begin {name} -->\n{body}\n<!-- end {name} -->"
        text, found = re.subn(rf"<!-- begin {name} -->\n.*?<!-- end {name} -->", lambda _: block, text, flags=re.DOTALL)  # noqa: B023
        if not found:
            text = f"{text.rstrip()}\n\n## `{name}`\n\n![Errors of {name}](images/validity_{name}.png)\n\n{block}\n"
    return text


@one_blas_thread
def main(wanted: Sequence[str] = ()) -> None:
    """Solve, draw, and write the page, or those of its blocks that are named."""
    start = time.perf_counter()
    others = ("formulas", "shares", "box", "ratios")
    if unknown := set(wanted) - {*others, *modules()}:
        sys.exit(f"no block is called {', '.join(sorted(unknown))}; there are {', '.join((*others, *modules()))}")
    made = wanted or (*others, *modules())

    def say(what: str) -> None:
        print(f"{time.perf_counter() - start:5.0f} s  {what}", flush=True)

    maps: dict[str, xarray.Dataset] = {}
    for kind in ABOUT:
        if judged := [each for each in FORMULAS if kind_of(each) == kind and each.module in made]:
            say(f"formulas about {ABOUT[kind]}")
            maps |= error_maps(judged)
    blocks = {"formulas": formula_table()} if "formulas" in made else {}
    for module in (each for each in modules() if each in made):
        say(f"picture of {module}")
        pairs = [(formula, maps[formula.name]) for formula in of_module(module)]
        path = IMAGES / f"validity_{module.replace('.', '_')}.png"
        plot_error_maps(pairs, path, force=True, title=f"Errors of stribeck.asymptotics.{module}")
        blocks[module] = measured_table(module, maps)
    if "shares" in made:
        say("speeds at which the fluid carries a share")
        shares = share_maps()
        title = "Speed at which the fluid carries 50 % or 5 % of the load"
        plot_error_maps(shares, IMAGES / "validity_shares.png", force=True, title=title)
        blocks["shares"] = share_table(shares)
    if "box" in made:
        say("friction over the box of the uniform law")
        blocks["box"] = uniform_table()
    if "ratios" in made:
        say("friction over the ratio of its coefficients")
        blocks["ratios"] = ratio_table()
    PAGE.write_text(filled(PAGE.read_text(), blocks))
    say("done")


if __name__ == "__main__":
    main(sys.argv[1:])
