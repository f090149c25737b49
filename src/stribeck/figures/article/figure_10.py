"""Figure 10: how the fluid takes load from the asperities at slow speed, and the function phi of the load that rules it."""

from __future__ import annotations

import math

import numpy as np

from stribeck._types import Array
from stribeck.asymptotics import boundary, perturbation
from stribeck.curves.result import StribeckCurve
from stribeck.figures import style
from stribeck.figures.article.stribeck_cases import CASES, drawn_cases, give_cases, solved_cases
from stribeck.figures.job import FigureJob
from stribeck.figures.style import Axes, Dataset, Figure

TITLE = "Boundary-to-mixed lubrication transition"
CLAIM = (
    "friction follows mu_0 (1 - F_f/F_N) remarkably well as the speed falls, F_f/F_N = 1 is where the transition lies, "
    "and (1/2)(-ln F)^5 provides a very good description of phi."
)
SIZE = 11.5, 7.4
STEPS = len(CASES)

SPEED_RANGE = 1e-9, 30.0  # Speed groups of the curves.
LOAD_RANGE = 1e-12, 0.7  # Load groups of panel (b).

FIT_LOAD_RANGE = 1e-5, 0.1  # Load groups over which the power of the paper was fitted.

CASE_IN_PARTS = CASES.index((0.1, 1e-4))  # Case whose friction is taken apart: the blue one of the paper.

# Label, colour and dashes of each law of the load share.
SHARE_LAWS = {
    "share_law": (r"$\lambda^2 \phi/\kappa^4$, $\phi$ with $2/\pi$", style.FLUID, style.DASHED),
    "share_without_factor": (r"$\phi$ without $2/\pi$, as printed", style.CONTACT, style.DASHED),
    "share_printed_groups": (r"and $6\pi\eta Ua$ for $6\eta Ua$, as printed", style.MARK, style.DASHED),
    "share_printed": (r"and $\phi = \frac{1}{2} L^{+5}$, as printed", style.GREY, style.DASHED),
}
# Label, colour and dashes of each law of phi.
PHI_LAWS = {
    "phi": ("quadrature", style.INK, "-"),
    "phi_closed": ("ours, closed form", style.MARK, style.DASHED),
    "phi_power": (r"$0.325\,L^{-5}$", style.FLUID, style.DASHED),
    "phi_asymptote": (r"$(96 - 128 \ln 2)\,L^{-6}$", style.GREEN, style.DOTTED),
    "phi_printed": (r"printed: $\frac{1}{2} L^{+5}$", style.CONTACT, style.DASHED),
}


def compute(work: FigureJob) -> Dataset:
    """Solve the curves, take one apart, and compare the load on the fluid and phi with their laws."""
    curves = solved_cases(work, SPEED_RANGE, points=85)
    friction, _ = give_cases(work, curves)
    share = np.array([curve.observable("contact_load_share") for curve in curves])
    boundary_law = np.array([boundary.friction.function(curve.groups, viscous="neglected") for curve in curves])
    shown = _taken_apart(curves[CASE_IN_PARTS])
    loads = np.geomspace(*LOAD_RANGE, 121)
    phis = {
        "phi": perturbation.phi(loads),
        "phi_closed": perturbation.phi(loads, form="closed"),
        "phi_power": perturbation.phi(loads, form="power"),
        "phi_asymptote": perturbation.phi(loads, form="asymptote"),
        "phi_printed": perturbation.phi(loads, form="printed"),
    }
    fitted = (loads >= FIT_LOAD_RANGE[0]) & (loads <= FIT_LOAD_RANGE[1])
    off = {name: np.abs(values / phis["phi"] - 1) for name, values in phis.items()}
    slope = np.gradient(np.log(phis["phi"]), np.log(-np.log(loads)))
    excess = friction.max(axis=1, where=share > 0.9, initial=0.0) - 1
    fluid = shown["fluid_load_share"]
    slow = int(np.argmin(np.abs(np.log(fluid / 1e-3))))
    ratios = {name: fluid[slow] / shown[name][slow] for name in SHARE_LAWS}
    at_one = float(np.interp(0.0, np.log(shown["share_law"]), fluid))
    at_load, printed = float(perturbation.phi(0.1)), float(perturbation.phi(0.1, form="printed"))
    finding = (
        f"at load {CASES[CASE_IN_PARTS][0]}, roughness {CASES[CASE_IN_PARTS][1]:g} the fluid's part of the load is "
        f"{ratios['share_law']:.2f} "
        f"of the formula where it is 1e-3, {ratios['share_without_factor']:.2f} without 2/pi and "
        f"{ratios['share_printed']:.0e} of all that is printed; where the formula reaches 1 it is {at_one:.2f}. The printed "
        f"friction first rises above mu_0, by {100 * excess[CASE_IN_PARTS]:.2f} %, by a viscous part of first order in "
        "the speed. phi "
        f"at load 0.1 is {at_load:.3e}, printed {printed:.0f}; the power -5 is within "
        f"{100 * off['phi_power'][fitted].max():.0f} % from {FIT_LOAD_RANGE[0]:g} to {FIT_LOAD_RANGE[1]:g}, where the "
        "local power of L is "
        f"{slope[fitted].min():.1f} to {slope[fitted].max():.1f}; our closed form within {100 * off['phi_closed'].max():.2f} "
        "%."
    )
    work.along(phi_load=(loads, "load group"))
    work.give(
        ("case", "speed"),
        contact_load_share=(share, "part of the load on asperities"),
        boundary_friction=(boundary_law, "mu_0 (1 - F_f/F_N) with F_f from phi by quadrature"),
    )
    work.give("case", excess=(excess, "largest friction where asperities carry more than 90 % of the load, less mu_0"))
    work.give("speed", **{name: (values, f"of the blue case: {name.replace('_', ' ')}") for name, values in shown.items()})
    functions = {name: (values, f"the function {name.replace('_', ' ')} of the load") for name, values in phis.items()}
    work.give("phi_load", **functions, power_of_logarithm=(slope, "d ln phi / d ln(-ln load)"))
    near_one = "part of the load on the fluid over {}, where it is near 1e-3"
    work.give(
        (),
        share_at_criterion=(at_one, "part of the load on the fluid where lambda^2 phi/kappa^4 = 1"),
        **{f"{name}_ratio": (ratio, near_one.format(name)) for name, ratio in ratios.items()},
    )
    return work.dataset(finding, shown_case=CASE_IN_PARTS)


def _taken_apart(curve: StribeckCurve) -> dict[str, Array]:
    """Return how far the friction of one case lies below mu_0 by both definitions, the load on the fluid, and its laws."""
    groups = curve.groups
    law = np.asarray(boundary.fluid_load_share.function(groups))
    balanced = np.array([solution.friction(definition="balanced").total for solution in curve.solutions])
    return {
        "fluid_load_share": curve.observable("fluid_load_share"),
        "fall_published": 1 - curve.friction,
        "fall_balanced": 1 - balanced,
        "share_law": law,
        "share_without_factor": math.pi / 2 * law,
        "share_printed_groups": np.asarray(boundary.fluid_load_share.function(groups, printed=True)),
        "share_printed": np.asarray(boundary.fluid_load_share.function(groups, form="printed", printed=True)),
    }


def draw(figure: Figure, data: Dataset) -> None:
    """Draw the fall of friction, the load on the fluid, and phi with its forms."""
    a, shares, b, ratios = style.panels(figure, 2, 2)
    for i, look, label in drawn_cases(data):
        a.semilogx(data.hydrodynamic_friction[i], data.friction[i], markevery=2, label=label, **look)
        a.plot(data.hydrodynamic_friction[i], data.boundary_friction[i], color=look["color"], ls=style.DOTTED, lw=1.5)
    legend = {"loc": "lower left", "title": r"$\bar F_N$,  $\bar h_\mathrm{rms}$", "fontsize": 7.5}
    x, y = r"$\mu_{f,\mathrm{th}}$", r"friction coefficient $\mu$"
    style.panel(a, "a", r"dotted: $\mu_0(1 - F_f/F_N)$", legend, xlabel=x, ylabel=y, ylim=(0, 1.35), xlim=(3e-5, 2))
    _draw_shares(shares, data)
    style.lines(b, data, PHI_LAWS, lw=1.6)
    legend = {"loc": "center left", "bbox_to_anchor": (0.0, 0.62)}
    logarithmic = {"xscale": "log", "yscale": "log", "xlabel": r"load $\bar F_N$", "ylabel": r"$\phi$", "ylim": (1e-9, 1e9)}
    style.panel(b, "b", r"auxiliary function $\phi$, $L = -\ln \bar F_N$", legend, **logarithmic)
    style.lines(ratios, data / data.phi, PHI_LAWS, lw=1.6)
    ratios.axvspan(*FIT_LOAD_RANGE, color="#f4f4f2", lw=0, zorder=0)
    ratios.text(1e-3, 0.15, "range of the fit", size=8, color=style.GREY, ha="center")
    legend = {"loc": "upper left", "handles": ratios.lines[1:]}
    over_quadrature = {"xscale": "log", "xlabel": r"load $\bar F_N$", "ylabel": r"form over quadrature", "ylim": (0, 4)}
    style.panel(ratios, "+", "ratio to the quadrature", legend, **over_quadrature)


def _draw_shares(axes: Axes, data: Dataset) -> None:
    case = int(data.attrs["shown_case"])
    every = slice(None, None, 2)
    for name, marker, face, label in (
        ("fluid_load_share", "o", style.INK, "load on the fluid, solved"),
        ("fall_balanced", "s", "white", r"$1 - \mu/\mu_0$, balance of forces"),
        ("fall_published", "^", "white", r"$1 - \mu/\mu_0$, as published"),
    ):
        axes.loglog(
            data.speed[every], data[name].where(data[name] > 0)[every], marker, color=style.INK, mfc=face, ms=4, label=label
        )
    style.lines(axes, data, SHARE_LAWS)
    load, roughness = (style.power(float(data[name][case])) for name in ("load", "roughness"))
    text = rf"printed and corrected, $\bar F_N$ = {load}, $\bar h_\mathrm{{rms}}$ = {roughness}"
    settings = {"xlabel": r"speed $\lambda$", "ylabel": "share of load or friction", "xlim": (1e-9, 1e-3), "ylim": (1e-8, 1e2)}
    style.panel(axes, "+", text, {"loc": "lower right", "fontsize": 7.5}, **settings)
