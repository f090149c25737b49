"""Make the picture and the tables of contact_laws.md anew: Persson's law, that of a simulated surface, the exponential one.

Usage::

    python docs/contact_laws.py          # all, about three minutes on one core
    python docs/contact_laws.py --tail   # the tables about the simulated surface alone, a few seconds

What stands in the page between marks is replaced, all other text is kept.
"""

from __future__ import annotations

import math
import re
import sys
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import stribeck as sb
from stribeck.numerics.threads import one_blas_thread

FOLDER = Path(__file__).parent
PAGE = FOLDER / "contact_laws.md"
PICTURE = FOLDER / "images" / "contact_laws.png"
SIMULATED = FOLDER.parent / "examples" / "gfmd_mean_gap.csv"
DEMO = FOLDER.parent / "examples" / "pdms_cylinder.toml"

KAPPA = 0.01
"""Relative roughness of all states."""

LOADS = (0.1, 0.2, 0.3, 0.5, 0.7, 1.0, 2.0, 3.0, 5.0, 10.0)
SHOWN = (0.1, 1.0, 3.0, 10.0)
TOLD = (0.1, 0.3, 1.0, 3.0, 10.0)
SPEEDS = (1e-11, 1.0)
POINTS = 111

MARKS = {
    "fluid carries 5 % of the load": "boundary",
    "asperities cause 10 % of the friction": "hydrodynamic",
}
"""The two transitions, by the names that curves give them."""

SURFACE = sb.surfaces.SelfAffine(h_rms=6e-6, q0=1e4, q1=1e6, hurst=0.8)
"""The surface of the simulation."""

TAIL_LOADS = (0.1, 1.0)
TAIL_FRICTION = 0.7
TAIL_SPEEDS = (5e-3, 0.5)
GAPS = (0.2644, 0.4398, 0.854, 1.1806, 1.883, 2.629)


@dataclass(frozen=True)
class Pair:
    """One load under one law: the state at rest and the curve over the speed."""

    rest: sb.results.Solution
    curve: sb.results.StribeckCurve

    def speed(self, name: str) -> float:
        """Return the speed group of a landmark, nan where the curve has none."""
        return next((mark.value for mark in self.curve.transitions if mark.name == name), math.nan)


def persson() -> sb.surfaces.PerssonLaw:
    """Return the law of a self-affine surface over three decades of wave numbers, Hurst exponent 0.8."""
    return sb.surfaces.persson_law(sb.surfaces.SelfAffine(h_rms=1e-6, q0=1e4, q1=1e7, hurst=0.8))


def solved(load: float, law: sb.surfaces.PerssonLaw | None, beta: float) -> Pair:
    """Return state at rest and curve at one load."""
    groups = sb.Groups(0.0, load, KAPPA * load, law=law)
    curve = sb.stribeck_curve(groups, speed=SPEEDS, points=POINTS, boundary_friction=1.0, beta=beta)
    if not curve.outcome.ok:
        raise RuntimeError(f"load {load}: {curve.outcome.value}")
    return Pair(sb.solve(groups), curve)


def number(value: float, digits: int = 3) -> str:
    """Return a number as text; a dash where there is none."""
    if math.isnan(value):
        return "none"
    text = f"{value:.{digits}g}"
    return re.sub(r"e([+-])0*(\d)", lambda found: "e" + found[1].replace("+", "") + found[2], text)


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table in Markdown."""
    return "\n".join(f"| {' | '.join(cells)} |" for cells in [head, ["---"] * len(head), *rows])


def comparison(pairs: dict[float, tuple[Pair, Pair]]) -> str:
    """Return what both laws make of a state at rest, of the plateau, of both transitions and of the minimum."""
    rows = []
    for load in TOLD:
        one, other = pairs[load]
        cells = [number(load)]
        for pair in (one, other):
            cells += [number(pair.rest.central_separation), number(float(pair.curve.friction[0]), 4)]
            cells += [number(pair.speed(name)) for name in MARKS]
        rows.append(cells)
    head = ["$F$"]
    for law in ("exponential", "Persson"):
        head += [f"{law}: $s$ at rest", "plateau $\\mu/\\mu_0$", "speed at 5 % fluid", "speed at 10 % contact friction"]
    return table(head, rows)


def simulated(alpha: float, beta: float) -> sb.contact_laws.TableLaw:
    """Return the law of the simulated surface for a contact with these coefficients."""
    rows = sb.contact_laws.TableLaw.read(SIMULATED)
    return sb.contact_laws.TableLaw(
        alpha * np.array(rows.separation), np.array(rows.pressure) / beta, title="GFMD, one self-affine surface"
    )


def laws_of_surface() -> tuple[sb.surfaces.PerssonLaw, dict[str, sb.surfaces.PerssonLaw | sb.contact_laws.TableLaw | None]]:
    """Return Persson's law of the simulated surface, and all three laws of it by name."""
    law = sb.surfaces.persson_law(SURFACE)
    return law, {"exponential": None, "Persson": law, "GFMD": simulated(law.alpha, law.beta)}


def pressures() -> str:
    """Return the pressures that hold the simulated surface at some gaps, under all three laws."""
    law, laws = laws_of_surface()
    rows = []
    for gap in GAPS:
        s = np.array([law.alpha * gap])
        told = {"exponential": -s, "Persson": law.log_pressure(s), "GFMD": laws["GFMD"].log_pressure(s)}
        found = {name: law.beta * math.exp(float(value[0])) for name, value in told.items()}
        rows.append(
            [number(gap, 4), number(found["GFMD"])]
            + [f"{number(found[name])}, {found[name] / found['GFMD']:.2f} times" for name in ("Persson", "exponential")]
        )
    return table(["gap over $h_\\mathrm{rms}$", "$p/E^*$, GFMD", "Persson", "exponential"], rows)


def minimum_of(problem: sb.Groups | sb.LineContact, **settings: object) -> tuple[float, float, float, float]:
    """Return speed, friction, gap over h_rms/alpha, and the asperities' share of the friction at the minimum of a curve."""
    curve = sb.stribeck_curve(problem, points=41, definition="balanced", **settings)
    if curve.minimum is None:
        raise RuntimeError("no minimum")
    state = curve.minimum.solution
    friction = state.friction(curve.boundary_friction, curve.beta, "balanced")
    return curve.minimum.speed, curve.minimum.friction, state.central_separation, friction.contact_share


def minima() -> str:
    """Return the minimum of friction under the three laws of the simulated surface, and what each differs from the first."""
    law, laws = laws_of_surface()
    rows = []
    for load in TAIL_LOADS:
        first = None
        for name, shape in laws.items():
            groups = sb.Groups(0.0, load, KAPPA * load, law=shape)
            speed, friction, ratio, share = minimum_of(
                groups, speed=TAIL_SPEEDS, boundary_friction=TAIL_FRICTION, beta=law.beta
            )
            first = first or (speed, friction)
            rows.append(
                [number(load), name, number(speed, 4), _change(speed, first[0]), number(friction, 4)]
                + [_change(friction, first[1]), f"{ratio / law.alpha:.2f}", f"{100 * share:.2g} %"]
            )
    head = ["$F$", "law", "$\\lambda$ at the minimum", "change", "$\\mu$ there", "change", "gap there over $h_\\mathrm{rms}$"]
    return table([*head, "asperities' share of friction"], rows)


def demo() -> str:
    """Return the minimum of the demonstration case under its own law and under that of the simulated surface."""
    contact = sb.load_case(DEMO).contact
    law, _ = laws_of_surface()
    rows = []
    first = None
    for name, shape in (("exponential", None), ("GFMD", simulated(law.alpha, law.beta))):
        other = contact if shape is None else contact.replace(law=shape)
        speed, friction, ratio, share = minimum_of(other, speed=("5 mm/s", "0.3 m/s"))
        first = first or (speed, friction)
        rows.append(
            [name, f"{1e3 * speed:.1f} mm/s", _change(speed, first[0]), number(friction, 4), _change(friction, first[1])]
            + [f"{ratio / contact.alpha:.2f}", f"{100 * share:.2g} %"]
        )
    head = ["law", "speed at the minimum", "change", "$\\mu$ there", "change", "gap there over $h_\\mathrm{rms}$"]
    return table([*head, "asperities' share of friction"], rows)


def _change(value: float, reference: float) -> str:
    return "" if value == reference else f"{100 * (value / reference - 1):+.1f} %"


def draw(pairs: dict[float, tuple[Pair, Pair]]) -> None:
    """Draw curves, separation at rest and transitions."""
    import matplotlib.pyplot as plt

    colours = dict(zip(SHOWN, ("#0072b2", "#d55e00", "#cc79a7", "#1d2129"), strict=True))
    figure, (left, middle, right) = plt.subplots(1, 3, figsize=(13, 4.4), layout="constrained")
    for load, colour in colours.items():
        one, other = pairs[load]
        left.loglog(other.curve.values, other.curve.friction, color=colour, lw=1.8, label=f"load {load:g}")
        left.loglog(one.curve.values, one.curve.friction, color=colour, lw=1.2, ls=(0, (5, 2)))
    left.set(xlabel=r"speed group $\lambda$", ylabel=r"friction $\mu/\mu_0$", title="Stribeck curves")
    left.legend(frameon=False, loc="lower left")
    loads = np.array(LOADS)
    for k, style in (
        (1, {"color": "#1d2129", "lw": 1.8, "label": "Persson"}),
        (0, {"color": "#d55e00", "lw": 1.2, "ls": (0, (5, 2))}),
    ):
        label = style.get("label", "exponential")
        middle.semilogx(loads, [pairs[load][k].rest.central_separation for load in LOADS], **(style | {"label": label}))
        for name, colour in zip(MARKS, ("#0072b2", "#cc79a7"), strict=True):
            speeds = [pairs[load][k].speed(name) for load in LOADS]
            shown = {"color": colour, "lw": style["lw"], "ls": style.get("ls", "-")}
            right.loglog(loads, speeds, **shown, label=name.replace("%", " %") if k else None)
    middle.axhline(0, color="#6b7280", lw=0.8)
    middle.set(xlabel="load group $F$", ylabel=r"separation $\alpha h(0)/h_\mathrm{rms}$", title="At rest")
    middle.legend(frameon=False)
    right.set(xlabel="load group $F$", ylabel=r"speed group $\lambda$", title="Both transitions")
    right.legend(frameon=False, loc="lower left")
    figure.text(
        0.5,
        -0.03,
        f"Relative roughness {KAPPA:g}; solid lines law of Persson (H = 0.8, three decades), broken lines exponential law.",
        ha="center",
        color="#6b7280",
        size=9,
    )
    figure.savefig(PICTURE, dpi=130, bbox_inches="tight")
    plt.close(figure)


def filled(text: str, blocks: dict[str, str]) -> str:
    """Return a page with new text between its marks."""
    for name, body in blocks.items():
        block = f"<!-- begin {name} -->\n{body}\n<!-- end {name} -->"
        text = re.sub(rf"<!-- begin {name} -->\n.*?<!-- end {name} -->", lambda _: block, text, flags=re.DOTALL)  # noqa: B023
    return text


@one_blas_thread
def main(arguments: Sequence[str] = ()) -> None:
    """Solve, draw, and write the page."""
    blocks = {"pressures": pressures(), "minima": minima(), "demo": demo()}
    if "--tail" not in arguments:
        law = persson()
        pairs = {}
        for load in LOADS:
            pairs[load] = solved(load, None, law.beta), solved(load, law, law.beta)
            print(f"load {load:g} done", flush=True)
        draw(pairs)
        blocks |= {"comparison": comparison(pairs)}
    PAGE.write_text(filled(PAGE.read_text(), blocks))


if __name__ == "__main__":
    main(sys.argv[1:])
