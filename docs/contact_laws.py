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
GAPS = (0.2644, 0.854, 1.883, 2.629)


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


def simulated(alpha: float, beta: float) -> sb.contact_laws.TableLaw:
    """Return the law of the simulated surface for a contact with these coefficients."""
    rows = sb.contact_laws.TableLaw.read(SIMULATED)
    return sb.contact_laws.TableLaw(
        alpha * np.array(rows.separation), np.array(rows.pressure) / beta, title="GFMD, one self-affine surface"
    )


def pressures() -> str:
    """Return the pressures that hold the simulated surface at some gaps, and those of both laws over them."""
    law = sb.surfaces.persson_law(SURFACE)
    rows = []
    for gap in GAPS:
        s = np.array([law.alpha * gap])
        logarithms = {
            "GFMD": simulated(law.alpha, law.beta).log_pressure(s),
            "Persson": law.log_pressure(s),
            "exponential": -s,
        }
        found = {name: law.beta * math.exp(float(value[0])) for name, value in logarithms.items()}
        rows.append([number(gap, 4), number(found["GFMD"])])
        rows[-1] += [f"{found[name] / found['GFMD']:.2f}" for name in ("Persson", "exponential")]
    return table(["gap [$h_\\mathrm{rms}$]", "$p/E^*$, GFMD", "Persson/GFMD", "exponential/GFMD"], rows)


def minimum_of(problem: sb.Groups | sb.LineContact, **settings: object) -> tuple[float, float, float]:
    """Return speed, friction and gap over h_rms/alpha at the minimum of a curve."""
    curve = sb.stribeck_curve(problem, points=41, definition="balanced", **settings)
    if curve.minimum is None:
        raise RuntimeError("no minimum")
    return curve.minimum.speed, curve.minimum.friction, curve.minimum.solution.central_separation


def minima() -> str:
    """Return how far the law of the simulated surface moves the minimum of friction from that of the exponential law."""
    law = sb.surfaces.persson_law(SURFACE)
    shape = simulated(law.alpha, law.beta)
    settings = {"speed": TAIL_SPEEDS, "boundary_friction": TAIL_FRICTION, "beta": law.beta}
    cases = {
        f"load {load:g}": (*(sb.Groups(0.0, load, KAPPA * load, law=each) for each in (None, shape)), law.alpha, settings)
        for load in TAIL_LOADS
    }
    demo = sb.load_case(DEMO).contact
    cases["demonstration case"] = demo, demo.replace(law=shape), demo.alpha, {"speed": ("5 mm/s", "0.3 m/s")}
    rows = []
    for name, (one, other, alpha, given) in cases.items():
        (speed, friction, gap), (new_speed, new_friction, _) = minimum_of(one, **given), minimum_of(other, **given)
        rows.append([name, f"{gap / alpha:.2f}", _change(new_speed, speed), _change(new_friction, friction)])
    return table(["contact", "gap there [$h_\\mathrm{rms}$]", "speed there", "friction there"], rows)


def _change(value: float, reference: float) -> str:
    return f"{100 * (value / reference - 1):+.1f} %"


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
    blocks = {"pressures": pressures(), "minima": minima()}
    if "--tail" not in arguments:
        law = persson()
        pairs = {}
        for load in LOADS:
            pairs[load] = solved(load, None, law.beta), solved(load, law, law.beta)
            print(f"load {load:g} done", flush=True)
        draw(pairs)
    PAGE.write_text(filled(PAGE.read_text(), blocks))


if __name__ == "__main__":
    main(sys.argv[1:])
