"""Figure 10: how the fluid takes load from the asperities at slow speed, and the function phi of the load that rules it."""

import math

import numpy as np

from stribeck.asymptotics import boundary, perturbation
from stribeck.figures import style
from stribeck.figures.article.stribeck_cases import CASES, drawn_cases, solve_cases
from stribeck.figures.job import FigureJob, furthest
from stribeck.figures.style import Dataset, Panels

STEPS = len(CASES)
FIT_LOAD_RANGE = 1e-5, 0.1  # Load groups over which the power of the paper was fitted.
SHOWN = CASES.index((0.1, 1e-4))  # Case whose friction is taken apart: the blue one of the paper.


def compute(work: FigureJob) -> Dataset:
    """Solve the curves, take one apart, and compare the load on the fluid and phi with their laws."""
    curves, data = solve_cases(work, (1e-9, 30.0), points=85)
    data.contact_load_share = np.array([curve.observable("contact_load_share") for curve in curves])
    data.boundary_friction = [boundary.friction.function(curve.groups, viscous="neglected") for curve in curves]
    data.excess = data.friction.max(axis=1, where=data.contact_load_share > 0.9, initial=0.0) - 1
    data.shown_case, shown = SHOWN, curves[SHOWN]
    data.fluid_load_share, data.fall_published = shown.observable("fluid_load_share"), 1 - shown.friction
    data.fall_balanced = [1 - state.friction(definition="balanced").total for state in shown.solutions]
    data.share_law = np.asarray(boundary.fluid_load_share.function(shown.groups))
    data.share_without_factor = math.pi / 2 * data.share_law
    data.share_printed_groups = boundary.fluid_load_share.function(shown.groups, printed=True)
    data.share_printed = boundary.fluid_load_share.function(shown.groups, form="printed", printed=True)
    slow = int(np.argmin(np.abs(np.log(data.fluid_load_share / 1e-3))))
    for law in ("share_law", "share_without_factor", "share_printed_groups", "share_printed"):
        setattr(data, f"{law}_ratio", (data.fluid_load_share / getattr(data, law))[slow])
    data.share_at_criterion = np.interp(0.0, np.log(data.share_law), data.fluid_load_share)
    data.phi_load = loads = np.geomspace(1e-12, 0.7, 121)
    data.phi = perturbation.phi(loads)
    for form in ("closed", "power", "asymptote", "printed"):
        setattr(data, f"phi_{form}", perturbation.phi(loads, form=form))
    data.power_of_logarithm = np.gradient(np.log(data.phi), np.log(-np.log(loads)))
    fitted = (loads >= FIT_LOAD_RANGE[0]) & (loads <= FIT_LOAD_RANGE[1])
    data.least_power, data.largest_power = data.power_of_logarithm[fitted].min(), data.power_of_logarithm[fitted].max()
    data.at_load, data.printed = float(perturbation.phi(0.1)), float(perturbation.phi(0.1, form="printed"))
    data.power_off = furthest((data.phi_power / data.phi - 1)[fitted])
    data.closed_off = furthest(data.phi_closed / data.phi - 1)
    return work.dataset(data)


def draw(panels: Panels, data: Dataset) -> None:
    """Draw the fall of friction, the load on the fluid, and phi with its forms."""
    a, shares, b, ratios = panels.values()
    for row, look in drawn_cases(data):
        a.plot(row.hydrodynamic_friction, row.friction, markevery=2, **look)
        a.plot(row.hydrodynamic_friction, row.boundary_friction, color=look["color"], ls=style.DOTTED, lw=1.5)
    for values, marker, face, label in (
        (data.fluid_load_share, "o", style.INK, "load on the fluid, solved"),
        (data.fall_balanced, "s", "white", r"$1 - \mu/\mu_0$, balance of forces"),
        (data.fall_published, "^", "white", r"$1 - \mu/\mu_0$, as published"),
    ):
        every = values.where(values > 0)[::2]
        shares.loglog(every.speed, every, marker, color=style.INK, mfc=face, ms=4, label=label)
    ratios.axvspan(*FIT_LOAD_RANGE, color="#f4f4f2", lw=0, zorder=0)
    ratios.text(1e-3, 0.15, "range of the fit", size=8, color=style.GREY, ha="center")
